//! A raw frame from the host: the blocks of lines that it is cut into, and the check of each (docs/host.md).

use crate::crc::of_words;

/// In the register `pattern`: the frame that the host wrote, again and again.
pub const HOST: u32 = 8;
/// Pixels of a block at most.
pub const MAX_BLOCK_PIXELS: usize = 4096;
/// Word of the window `frame` that takes the check of the block before it, and so sends the block into the memory.
pub const SEND: u32 = MAX_BLOCK_PIXELS as u32 / 2;
/// Word of the window `frame` that begins the frame anew.
pub const RESTART: u32 = SEND + 1;

/// Returns the lines of a block of a frame: the most that fit and divide the frame's lines.
///
/// ```
/// use edof_device::host_frame::block_lines;
/// assert_eq!([block_lines(1920, 1080), block_lines(1280, 720), block_lines(32, 24)], [2, 3, 24]);
/// ```
#[must_use]
pub fn block_lines(width: usize, height: usize) -> usize {
    let fits = |lines: &usize| height.is_multiple_of(*lines) && lines * width <= MAX_BLOCK_PIXELS;
    (1..=height).rev().find(fits).unwrap_or(1)
}

/// Returns the check of a frame up to a block: the CRC-32 of the check before the block (0 before the first one, the lower half first) and of
/// its pixels. So it stands for all pixels so far, and for how many they are.
///
/// ```
/// use edof_device::host_frame::check;
/// let first = check(0, &[1, 2]);
/// assert_ne!(check(first, &[1, 2]), first);
/// ```
#[must_use]
pub fn check(before: u32, pixels: &[u16]) -> u32 {
    let halves = [before as u16, (before >> 16) as u16];
    of_words(halves.into_iter().chain(pixels.iter().copied()))
}

/// Returns the words of a block as the host writes them: two pixels each, the left one in the lower half.
pub fn words(pixels: &[u16]) -> impl Iterator<Item = u32> {
    pixels.as_chunks::<2>().0.iter().map(|[left, right]| u32::from(*left) | u32::from(*right) << 16)
}
