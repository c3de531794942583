//! Where frames lie in memory, and how they are cut into bursts.

/// A set of three frame buffers of 16-bit pixels, and how agents go about them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frames {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Byte address of each buffer, at a multiple of 4 KiB.
    pub buffers: [u32; 3],
    /// Words of a burst, a power of two: a burst stays inside of 4 KiB and 256 words.
    pub burst: usize,
    /// Words that an agent holds, a power of two, two bursts or more, and four at least.
    pub depth: usize,
}

impl Frames {
    /// # Panics
    /// For what the agents cannot do: the check of a design excludes it (`edof_device::board`).
    pub(super) fn check(&self, word_bits: usize) {
        let pixels = word_bits / 16;
        assert!(
            (self.width * self.height).is_multiple_of(pixels),
            "a frame of {}×{} is not whole words of {pixels} pixels",
            self.width,
            self.height
        );
        assert!(self.burst.is_power_of_two() && self.burst <= 256 && self.burst * word_bits <= 8 * 4096);
        assert!(
            self.depth.is_power_of_two() && (4..=2048).contains(&self.depth) && self.depth >= 2 * self.burst
        );
        assert!(self.buffers.iter().all(|address| address % 4096 == 0));
        assert!(word_bits.is_power_of_two() && (32..=1024).contains(&word_bits));
    }
}
