//! Random numbers that a seed, a step and a share of the batch decide alone, with equal values on every machine: no library's logarithm or cosine is used.

use rand::Rng;
use rand_pcg::Pcg64Mcg;
use std::sync::LazyLock;

/// A stream of random numbers; a resumed run opens the same ones.
#[derive(Debug)]
pub struct Random(Pcg64Mcg);

impl Random {
    /// The stream of one share of the batch at one step.
    #[must_use]
    pub fn new(seed: u64, step: u64, share: u64) -> Self {
        let mixed = (u128::from(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15)) << 64)
            | u128::from(
                step.wrapping_mul(0xD134_2543_DE82_EF95) ^ share.wrapping_mul(0xA24B_AED4_963E_E407),
            );
        let mut stream = Self(Pcg64Mcg::new(mixed));
        for _ in 0..4 {
            stream.word();
        }
        stream
    }

    fn word(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A whole number below `bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.word()) * bound as u128) >> 64) as usize
    }

    /// A number in 0…1, 1 excluded.
    pub fn unit(&mut self) -> f32 {
        (self.word() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A number between two others, uniformly.
    pub fn between(&mut self, [low, high]: [f32; 2]) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A normal number.
    pub fn normal(&mut self) -> f32 {
        NORMAL.of((self.word() >> 32) as u32)
    }

    /// Gives each of `values` a normal number of its own, by `add(value, normal)`.
    #[inline]
    pub fn normals(&mut self, values: &mut [f32], mut add: impl FnMut(&mut f32, f32)) {
        let table: &Quantiles = &NORMAL;
        for pair in values.chunks_mut(2) {
            let word = self.word();
            for (value, bits) in pair.iter_mut().zip([word as u32, (word >> 32) as u32]) {
                add(value, table.of(bits));
            }
        }
    }
}

/// Parts of equal probability that the half normal distribution is cut into.
const PARTS: usize = 1024;

static NORMAL: LazyLock<Quantiles> = LazyLock::new(Quantiles::new);

/// |x| of a normal number, uniform within each part: where the part begins and how wide it is.
struct Quantiles([[f32; 2]; PARTS]);

impl Quantiles {
    /// Steps of the integral in one unit.
    const FINE: f64 = 4096.0;

    fn new() -> Self {
        let mut ends = half_normal_quantiles();
        // The last part ends where all of them together have a mean square of 1.
        let square = |[a, b]: [f64; 2]| (a * a + a * b + b * b) / 3.0;
        let others: f64 = ends.windows(2).map(|e| square([e[0], e[1]])).sum();
        let (from, rest) = (ends[PARTS - 1], PARTS as f64 - others);
        ends.push(0.5 * ((12.0 * rest - 3.0 * from * from).sqrt() - from));
        Self(std::array::from_fn(|i| [ends[i] as f32, (ends[i + 1] - ends[i]) as f32]))
    }

    /// The normal number that 32 random bits stand for: a sign, a part, a place in it.
    #[inline]
    fn of(&self, bits: u32) -> f32 {
        const PLACES: u32 = 1 << 21;
        let [from, wide] = self.0[(bits >> 22) as usize];
        let place = ((bits >> 1) % PLACES) as f32 * (1.0 / PLACES as f32);
        f32::from_bits((from + wide * place).to_bits() | (bits << 31))
    }
}

/// x for which |normal| < x with probability 0, 1/1024 … 1023/1024: e^(−x²/2) summed in small steps, and where the sum passes
/// each multiple of its 1024th part.
fn half_normal_quantiles() -> Vec<f64> {
    let step = 1.0 / Quantiles::FINE;
    // Each value of e^(−x²/2), at the middles of the steps, is the one before times a factor that itself falls by e^(−step²).
    let exponential = |x: f64| 1.0 + x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0)));
    let fall = exponential(-step * step);
    let (mut height, mut factor) = (exponential(-step * step / 8.0), fall);
    let density: Vec<f64> = (0..8 * Quantiles::FINE as usize)
        .map(|_| {
            let now = height;
            height *= factor;
            factor *= fall;
            now
        })
        .collect();
    let part = density.iter().sum::<f64>() / PARTS as f64;
    let (mut sum, mut ends) = (0.0, Vec::with_capacity(PARTS + 1));
    for (i, height) in density.iter().enumerate() {
        while ends.len() < PARTS && sum + height > part * ends.len() as f64 {
            ends.push((i as f64 + (part * ends.len() as f64 - sum) / height) * step);
        }
        sum += height;
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(seed: u64, count: usize) -> Vec<f64> {
        let mut values = vec![0.0; count];
        Random::new(seed, 0, 0).normals(&mut values, |v, n| *v = n);
        values.into_iter().map(f64::from).collect()
    }

    #[test]
    fn normal_numbers_have_the_moments_and_tails_of_the_normal_distribution() {
        let values = drawn(1, 4_000_000);
        let moment = |n: i32| values.iter().map(|v| v.powi(n)).sum::<f64>() / values.len() as f64;
        let beyond = |x: f64| values.iter().filter(|v| v.abs() > x).count() as f64 / values.len() as f64;
        assert!(moment(1).abs() < 2e-3 && moment(3).abs() < 8e-3, "{} {}", moment(1), moment(3));
        assert!((moment(2) - 1.0).abs() < 3e-3 && (moment(4) - 3.0).abs() < 0.03, "{}", moment(4));
        // 2(1 − Φ(x)) at x = 1, 2, 3.
        for (x, share) in [(1.0, 0.31731), (2.0, 0.04550), (3.0, 0.002_700)] {
            assert!((beyond(x) / share - 1.0).abs() < 0.03, "{} beyond {x}", beyond(x));
        }
    }

    #[test]
    fn numbers_random_one_after_the_other_know_nothing_of_each_other() {
        let values = drawn(2, 1_000_000);
        for lag in [1, 2, 3, 12, 64, 144, 256] {
            let pairs = values.iter().zip(&values[lag..]).map(|(a, b)| a * b);
            let correlation = pairs.sum::<f64>() / (values.len() - lag) as f64;
            assert!(correlation.abs() < 5e-3, "{correlation} at {lag}");
        }
    }

    #[test]
    fn streams_of_other_seeds_steps_and_shares_differ() {
        let first = |seed, step, share| Random::new(seed, step, share).word();
        let all = [first(1, 1, 1), first(2, 1, 1), first(1, 2, 1), first(1, 1, 2)];
        assert!((0..4).all(|i| (0..i).all(|j| all[i] != all[j])), "{all:?}");
    }
}
