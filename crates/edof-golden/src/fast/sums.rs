//! Sums of 40 bits, as two numbers of 32 that vectors can hold.

/// Bits of a sum's low part.
pub const LOW_BITS: u32 = 8;

/// Bits that a sum may have, its sign included: more than 512 products of 16-bit words need.
pub const SUM_BITS: u32 = 32 + LOW_BITS;

/// The low part's bits.
pub const LOW: i32 = (1 << LOW_BITS) - 1;

/// Sums one after the other, each `high · 2^8 + low` with `low` in 0…255. What is shifted right by more than eight bits and rounded
/// does not depend on `low`.
#[derive(Debug, Clone)]
pub struct Sums {
    /// ⌊sum / 2^8⌋.
    pub high: Vec<i32>,
    /// What is left.
    pub low: Vec<i32>,
}

impl Sums {
    /// `length` zeros.
    #[must_use]
    pub fn new(length: usize) -> Self {
        Self { high: vec![0; length], low: vec![0; length] }
    }

    /// The sums as they are.
    pub fn exact(&self, from: usize, count: usize) -> impl Iterator<Item = i64> {
        let parts = self.high[from..from + count].iter().zip(&self.low[from..from + count]);
        parts.map(|(high, low)| (i64::from(*high) << LOW_BITS) + i64::from(*low))
    }
}

/// A sum's two parts.
#[must_use]
pub const fn split(sum: i64) -> (i32, i32) {
    ((sum >> LOW_BITS) as i32, sum as i32 & LOW)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_parts_make_the_sum_again() {
        for sum in [0, 1, -1, 255, 256, -256, -257, (1 << 39) - 1, -1 << 39] {
            let (high, low) = split(sum);
            let sums = Sums { high: vec![0, high], low: vec![0, low] };
            assert_eq!(sums.exact(1, 1).collect::<Vec<_>>(), [sum]);
            assert!((0..256).contains(&low));
        }
    }
}
