//! Frames in memory: its port, its buffers, and how many words agents hold.
//!
//! Frames are stored in sets of three buffers of 16-bit pixels: raw frames, and pictures in the codes of the wire.

use crate::fifos;

/// Bytes of a buffer.
const BUFFER_BYTES: u32 = 1 << 22;

/// The memory that frames are stored in, behind one AXI4 port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// Bits of a word of the port.
    pub word_bits: usize,
    /// Words of a burst, at most 4 KiB in all.
    pub burst_words: usize,
    /// Cycles that the memory may take for a burst, from the offer of its address to its last word, so that no pixel is late.
    pub max_burst_cycles: u64,
    /// Bytes of a frame buffer.
    pub buffer_bytes: u32,
    /// Byte addresses of the buffers of raw frames.
    pub raw_buffers: [u32; 3],
    /// Byte addresses of the buffers of pictures.
    pub picture_buffers: [u32; 3],
}

impl Memory {
    /// Returns a memory of 28 MiB whose port has words of so many bits and takes bursts of 4 KiB.
    #[must_use]
    pub const fn of_port(word_bits: usize, max_burst_cycles: u64) -> Self {
        Self {
            word_bits,
            burst_words: 4096 * 8 / word_bits,
            max_burst_cycles,
            buffer_bytes: BUFFER_BYTES,
            raw_buffers: [0, BUFFER_BYTES, 2 * BUFFER_BYTES],
            picture_buffers: [4 * BUFFER_BYTES, 5 * BUFFER_BYTES, 6 * BUFFER_BYTES],
        }
    }

    /// Returns the pixels in a word.
    #[must_use]
    pub const fn word_pixels(&self) -> usize {
        self.word_bits / 16
    }

    /// Returns the words from address 0 to the end of the last buffer.
    #[must_use]
    pub const fn words(&self) -> usize {
        (self.picture_buffers[2] + self.buffer_bytes) as usize / (self.word_bits / 8)
    }

    /// Returns the words that an agent holds, in LUT RAM: a pixel a cycle at most.
    #[must_use]
    pub const fn agent_words(&self) -> usize {
        fifos::agent_words(self.burst_words, self.max_burst_cycles, self.word_pixels() as u64)
            .next_power_of_two()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_is_four_kibibytes_and_an_agent_holds_two() {
        for bits in [128, 256, 512] {
            let memory = Memory::of_port(bits, 512);
            assert_eq!(memory.burst_words * bits, 8 * 4096);
            assert!(memory.agent_words() >= 2 * memory.burst_words);
        }
    }
}
