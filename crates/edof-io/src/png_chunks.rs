//! Chunks of a PNG, for what its decoder does not give.

use edof_core::storage::digest::crc32;

/// Bytes of a PNG's signature and header.
const HEADER: usize = 33;

/// Inserts a chunk behind the header of a PNG.
pub fn insert(png: &mut Vec<u8>, name: [u8; 4], content: &[u8]) {
    let named = [&name[..], content].concat();
    let chunk = [&(content.len() as u32).to_be_bytes(), &named[..], &crc32(&named).to_be_bytes()].concat();
    png.splice(HEADER..HEADER, chunk);
}

/// Returns the name and content of each chunk of a file, as far as the file is whole.
pub fn chunks(png: &[u8]) -> impl Iterator<Item = (&[u8], &[u8])> {
    let mut rest = png.get(8..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (length, more) = rest.split_first_chunk::<4>()?;
        let length = u32::from_be_bytes(*length) as usize;
        let (name, more) = more.split_at_checked(4)?;
        let (content, more) = more.split_at_checked(length)?;
        rest = more.get(4..).unwrap_or_default();
        Some((name, content))
    })
}
