//! What a source learns from an EDID (VESA E-EDID 1.3, CEA-861 extension version 3).

/// An EDID of two blocks.
pub type Edid = [u8; 256];

/// What a sink says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sink {
    /// The EDID has an HDMI vendor block; else a source treats the screen as DVI.
    pub is_hdmi: bool,
    /// The screen accepts YCbCr 4:2:2.
    pub takes_422: bool,
    /// The screen accepts YCbCr 4:4:4.
    pub takes_444: bool,
    /// Video formats of CEA-861 that it takes.
    pub formats: Vec<u8>,
    /// The preferred mode: columns, rows, pixel clock in kilohertz.
    pub preferred: (usize, usize, u32),
}

/// Why bytes are no EDID.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EdidError {
    /// The first eight bytes.
    #[error("the EDID does not begin with 00 FF FF FF FF FF FF 00")]
    Header,
    /// A block's bytes do not add up to 0.
    #[error("the checksum of the EDID's block {0} is wrong")]
    Checksum(usize),
    /// The extension block is not CEA-861's.
    #[error("the EDID's extension is not that of CEA-861 version 3")]
    Extension,
}

const HEADER: [u8; 8] = [0, 255, 255, 255, 255, 255, 255, 0];
/// Identifier of HDMI Licensing, lowest byte first.
const HDMI: [u8; 3] = [0x03, 0x0c, 0x00];
/// Data block collections: tags.
const VIDEO: u8 = 2;
const VENDOR: u8 = 3;

/// Reads an EDID as a source does.
///
/// # Errors
/// [`EdidError`]: a source that reads such bytes stays dark.
pub fn read(edid: &Edid) -> Result<Sink, EdidError> {
    if edid[..8] != HEADER {
        return Err(EdidError::Header);
    }
    for (number, block) in edid.chunks(128).enumerate() {
        if block.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte)) != 0 {
            return Err(EdidError::Checksum(number));
        }
    }
    if edid[126] != 1 || edid[128] != 2 || edid[129] != 3 {
        return Err(EdidError::Extension);
    }
    let mut sink = Sink {
        is_hdmi: false,
        takes_422: edid[131] >> 4 & 1 == 1,
        takes_444: edid[131] >> 5 & 1 == 1,
        formats: vec![],
        preferred: preferred(&edid[54..72]),
    };
    let end = usize::from(edid[130]).clamp(4, 127);
    let mut blocks = &edid[132..128 + end];
    while let Some((head, rest)) = blocks.split_first() {
        let (block, next) = rest.split_at(usize::from(head & 31).min(rest.len()));
        match head >> 5 {
            VIDEO => sink.formats.extend(block.iter().map(|format| format & 0x7f)),
            VENDOR if block.starts_with(&HDMI) => sink.is_hdmi = true,
            _ => {}
        }
        blocks = next;
    }
    Ok(sink)
}

/// The first detailed timing.
fn preferred(timing: &[u8]) -> (usize, usize, u32) {
    let twelve = |low: u8, high: u8| usize::from(low) | usize::from(high >> 4) << 8;
    let khz = 10 * u32::from(u16::from_le_bytes([timing[0], timing[1]]));
    (twelve(timing[2], timing[4]), twelve(timing[5], timing[7]), khz)
}

/// An EDID of a screen for 1920×1080 at 60 Hz: HDMI with all codings, or DVI.
#[must_use]
pub fn screen(is_hdmi: bool) -> Edid {
    let mut edid = [0; 256];
    edid[..8].copy_from_slice(&HEADER);
    edid[18..20].copy_from_slice(&[1, 3]);
    edid[54..72].copy_from_slice(&[
        0x02, 0x3a, 0x80, 0x18, 0x71, 0x38, 0x2d, 0x40, 0x58, 0x2c, 0x45, 0, 0, 0, 0, 0, 0, 0x1e,
    ]);
    edid[126] = 1;
    edid[128..132].copy_from_slice(&[2, 3, 4, if is_hdmi { 0x30 } else { 0 }]);
    if is_hdmi {
        edid[130] = 12;
        edid[132..140].copy_from_slice(&[VIDEO << 5 | 1, 16, VENDOR << 5 | 5, 3, 12, 0, 0x10, 0]);
    }
    with_checksums(edid)
}

/// The same with the last byte of each block such that it adds up to 0.
#[must_use]
pub fn with_checksums(mut edid: Edid) -> Edid {
    for block in edid.chunks_mut(128) {
        let sum = block[..127].iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
        block[127] = sum.wrapping_neg();
    }
    edid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screen_says_what_it_takes() {
        let sink = read(&screen(true)).unwrap();
        assert!(sink.is_hdmi && sink.takes_422 && sink.takes_444);
        assert_eq!((sink.formats, sink.preferred), (vec![16], (1920, 1080, 148_500)));
        let sink = read(&screen(false)).unwrap();
        assert!(!sink.is_hdmi && !sink.takes_422);
    }

    #[test]
    fn bytes_that_are_no_edid_are_named() {
        assert_eq!(read(&[0; 256]), Err(EdidError::Header));
        let mut edid = screen(true);
        edid[200] ^= 1;
        assert_eq!(read(&edid), Err(EdidError::Checksum(1)));
        edid = screen(true);
        edid[126] = 0;
        assert_eq!(read(&with_checksums(edid)), Err(EdidError::Extension));
    }
}
