//! When data is valid at the FPGA, relative to its clock.
//!
//! Source: ADV7619 Rev. B page 6 (data changes around the clock's falling edge), EngineerZone 536332 and 12208 (32 taps of 0.21 ns; sweep them and
//! take the middle of the window; it has 6 to 8 taps). Where the window is depends on the board and on the FPGA's clock buffer: random here.

use super::Adv7611;
use super::maps::Map;
use super::output::Word;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Taps of the delay line; together they are a period of 148.5 MHz.
pub const TAPS: usize = 32;

/// The window in which the FPGA samples well.
#[derive(Debug, Clone)]
pub struct Eye {
    /// The window's first place, in taps after the clock's own edge.
    pub first: usize,
    /// How many taps it has; 32 is all.
    pub taps: usize,
    noise: Pcg64,
}

impl Eye {
    /// Every setting samples well.
    #[must_use]
    pub fn wide() -> Self {
        Self { first: 0, taps: TAPS, noise: Pcg64::seed_from_u64(0) }
    }

    /// A window of 6 to 12 taps anywhere in the period.
    #[must_use]
    pub fn drawn(seed: u64) -> Self {
        let mut noise = Pcg64::seed_from_u64(seed);
        Self { first: noise.random_range(0..TAPS), taps: noise.random_range(6..=12), noise }
    }

    /// Whether a clock with this polarity and tap samples well. The other polarity is half a period away.
    #[must_use]
    pub const fn is_open(&self, inverted: bool, tap: usize) -> bool {
        let place = tap + if inverted { TAPS / 2 } else { 0 };
        (place + TAPS - self.first) % TAPS < self.taps
    }

    /// A word as it is sampled: outside of the window each bit is by chance that of the word before.
    pub(crate) fn sample(&mut self, is_open: bool, before: Word, word: Word) -> Word {
        if is_open {
            return word;
        }
        let stale: u16 = self.noise.random();
        (word & !stale) | (before & stale)
    }
}

impl Adv7611 {
    /// Polarity and tap of its clock: IO 06 bit 0; IO 19 bits 4..0 where the delay line is on (bit 7) and in the path (IO 33 bit 6).
    #[must_use]
    pub const fn clock_phase(&self) -> (bool, usize) {
        let io = self.page(Map::Io);
        let tap = if io.bit(0x19, 7) && io.bit(0x33, 6) { io.bits(0x19, 4, 0) } else { 0 };
        (io.bit(0x06, 0), tap as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_half_a_period_further_for_the_other_polarity() {
        let eye = Eye { first: 30, taps: 6, ..Eye::wide() };
        let open = |inverted| (0..TAPS).filter(|tap| eye.is_open(inverted, *tap)).collect::<Vec<_>>();
        assert_eq!(open(false), [0, 1, 2, 3, 30, 31]);
        assert_eq!(open(true), [14, 15, 16, 17, 18, 19]);
        for seed in 0..50 {
            let eye = Eye::drawn(seed);
            let count = (0..TAPS).filter(|tap| eye.is_open(false, *tap)).count();
            assert_eq!(count, eye.taps);
        }
    }
}
