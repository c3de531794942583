//! What the board makes of the words of a host's raw frame.

use edof_device::design::FrameSize;
use edof_device::host_frame::{MAX_BLOCK_PIXELS, RESTART, SEND, block_lines, check};

/// The host's frame so far, and the block that is being written.
#[derive(Debug, Clone)]
pub struct HostFrame {
    block_pixels: usize,
    frame_pixels: usize,
    block: Vec<u16>,
    check: u32,
    /// Pixels of the blocks that were accepted, row by row.
    pixels: Vec<u16>,
}

impl HostFrame {
    /// A frame without a block.
    #[must_use]
    pub fn new(frame: FrameSize) -> Self {
        let FrameSize { width, height, .. } = frame;
        Self {
            block_pixels: block_lines(width, height) * width,
            frame_pixels: width * height,
            block: vec![0; MAX_BLOCK_PIXELS],
            check: 0,
            pixels: vec![],
        }
    }

    /// Begins anew; the words of the block stay.
    pub fn restart(&mut self) {
        (self.check, self.pixels) = (0, vec![]);
    }

    /// Takes a word of the window `frame`; returns the pixels of the block that left.
    pub fn write(&mut self, index: u32, word: u32) -> &[u16] {
        let before = self.pixels.len();
        if index < SEND {
            let pixel = 2 * index as usize;
            self.block[pixel..pixel + 2].copy_from_slice(&[word as u16, (word >> 16) as u16]);
        } else if index & 1 == RESTART & 1 {
            self.restart();
            return &[];
        } else if !self.is_whole() {
            let block = &self.block[..self.block_pixels];
            if check(self.check, block) == word {
                self.check = word;
                self.pixels.extend(block);
            }
        }
        &self.pixels[before..]
    }

    /// Blocks that were accepted.
    #[must_use]
    pub fn blocks(&self) -> u32 {
        (self.pixels.len() / self.block_pixels) as u32
    }

    /// Check of the frame so far.
    #[must_use]
    pub const fn check(&self) -> u32 {
        self.check
    }

    /// Pixels of the blocks that were accepted, row by row.
    #[must_use]
    pub fn pixels(&self) -> &[u16] {
        &self.pixels
    }

    /// Whether all blocks are there.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.pixels.len() == self.frame_pixels
    }
}
