//! The one generator of everything random in tests: networks, windows, stalls. Not for noise or training.

/// SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Debug, Clone)]
pub struct Draw(u64);

impl Draw {
    /// A generator that starts from `seed`.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GAMMA);
        mixed(self.0)
    }

    /// Output `index` (0 first) of the generator that starts from `seed`.
    #[must_use]
    pub const fn nth(seed: u64, index: u64) -> u64 {
        mixed(seed.wrapping_add(index.wrapping_add(1).wrapping_mul(GAMMA)))
    }

    /// A whole number from `min` to `max`, both included.
    pub fn whole(&mut self, min: i64, max: i64) -> i64 {
        min + (self.bits() % (max - min + 1) as u64) as i64
    }

    /// A word of `bits` bits that is often at or near the ends of its range, or zero.
    pub fn extreme(&mut self, bits: u32) -> i16 {
        let max = (1i64 << (bits - 1)) - 1;
        (match self.whole(0, 7) {
            0 | 1 => max,
            2 | 3 => -max - 1,
            4 => self.whole(-3, 3),
            5 => 0,
            _ => self.whole(-max - 1, max),
        }) as i16
    }
}

/// What SplitMix64 adds to its state for each output.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's output for a state.
const fn mixed(state: u64) -> u64 {
    let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_output_of_a_generator_can_be_had_without_those_before() {
        let draw = &mut Draw::new(9);
        assert!((0..100).all(|index| draw.bits() == Draw::nth(9, index)));
    }
}
