//! The averaging window of overlapping patches. It is folded into F's weights, so that the overlap needs only addition.

use crate::geometry::{PATCH, Stride};
use ndarray::Array2;
use serde::{Deserialize, Serialize};

/// How overlapping patches are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Overlap {
    /// Raised cosine: a patch counts most at its centre.
    #[default]
    Hann,
    /// Plain average.
    Flat,
}

impl Overlap {
    /// Weight of each of a patch's 8×8 pixels. At every pixel of the frame the weights of all its patches add up to 1.
    #[must_use]
    pub fn weights(self, stride: Stride) -> Array2<f64> {
        let along = self.along_axis(stride);
        Array2::from_shape_fn((PATCH, PATCH), |(r, c)| along[r] * along[c])
    }

    fn along_axis(self, stride: Stride) -> [f64; PATCH] {
        let patches = (PATCH / stride.pixels()) as f64;
        std::array::from_fn(|i| match self {
            Self::Hann if stride != Stride::PATCH => {
                let phase = std::f64::consts::PI * (i as f64 + 0.5) / PATCH as f64;
                phase.sin().powi(2) * 2.0 / patches
            }
            _ => 1.0 / patches,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_all_patches_over_a_pixel_add_up_to_one() {
        for overlap in [Overlap::Hann, Overlap::Flat] {
            for step in [2, 4, 8] {
                let w = overlap.weights(Stride::new(step).unwrap());
                for (r, c) in (0..step).flat_map(|r| (0..step).map(move |c| (r, c))) {
                    let sum: f64 = (r..PATCH)
                        .step_by(step)
                        .flat_map(|y| (c..PATCH).step_by(step).map(move |x| (y, x)))
                        .map(|at| w[at])
                        .sum();
                    assert!((sum - 1.0).abs() < 1e-12, "{overlap:?} stride {step}: {sum}");
                }
            }
        }
    }
}
