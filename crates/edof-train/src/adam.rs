//! Adam (Kingma and Ba, 2015) on a flat vector of weights.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

const BETA1: f32 = 0.9;
const BETA2: f32 = 0.999;
const EPSILON: f32 = 1e-8;
/// Weights that one thread moves at a time.
const PIECE: usize = 8192;

/// The running moments; part of every checkpoint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    /// Steps taken.
    pub steps: u64,
    /// First moment.
    pub mean: Vec<f32>,
    /// Second moment.
    pub square: Vec<f32>,
}

impl Adam {
    /// Moments for `length` weights, none seen.
    #[must_use]
    pub fn new(length: usize) -> Self {
        Self { steps: 0, mean: vec![0.0; length], square: vec![0.0; length] }
    }

    /// One step down `gradient`; weight i moves by about `rate`·`scale[i]`.
    pub fn step(&mut self, weights: &mut [f32], gradient: &[f32], rate: f32, scale: &[f32]) {
        self.steps += 1;
        let correction = |beta: f32| (1.0 - f64::from(beta).powf(self.steps as f64)) as f32;
        let rate = rate / correction(BETA1);
        let root = 1.0 / correction(BETA2).sqrt();
        let moments = self.mean.par_chunks_mut(PIECE).zip(self.square.par_chunks_mut(PIECE));
        let given = gradient.par_chunks(PIECE).zip(scale.par_chunks(PIECE));
        moments.zip(weights.par_chunks_mut(PIECE)).zip(given).for_each(|(((m, v), w), (g, s))| {
            for ((((m, v), w), &g), &s) in m.iter_mut().zip(v).zip(w).zip(g).zip(s) {
                *m += (1.0 - BETA1) * (g - *m);
                *v += (1.0 - BETA2) * (g * g - *v);
                *w -= rate * s * *m / ((*v).sqrt() * root + EPSILON);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_step_has_the_length_of_the_rate() {
        let mut weights = [1.0, 1.0];
        Adam::new(2).step(&mut weights, &[5.0, -0.01], 0.1, &[1.0, 0.5]);
        assert!((weights[0] - 0.9).abs() < 1e-5 && (weights[1] - 1.05).abs() < 1e-5);
    }

    #[test]
    fn it_finds_the_bottom_of_a_bowl() {
        let (mut weights, mut adam) = ([3.0, -2.0], Adam::new(2));
        for step in 0..2000 {
            let gradient = [2.0 * (weights[0] - 1.0), 20.0 * weights[1]];
            adam.step(&mut weights, &gradient, 0.05 * (1.0 - step as f32 / 2000.0), &[1.0, 1.0]);
        }
        assert!((weights[0] - 1.0).abs() < 1e-3 && weights[1].abs() < 1e-3);
    }
}
