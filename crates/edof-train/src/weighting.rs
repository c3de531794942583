//! How much windows of easy and of hard cells weigh: by the running mean error of the cell (photograph, tone, ψ, noise class)
//! that they come from.

use edof_core::colour::RGB_OUTPUTS;
use serde::{Deserialize, Serialize};

/// How much windows of easy and of hard cells weigh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weighting {
    /// By 1 over the cell's mean error: the sum falls as the mean of log MSE does, so the mean PSNR is what is trained, and the
    /// hard cells (largest ψ, with noise) pay for easy ones.
    Psnr,
    /// By 1 over the root of it: between the two.
    Root,
    /// Equal weights: busy photographs at the far end of the range outweigh all else.
    Mse,
}

/// Mean square error (36 dB) of a cell that weighs the same in all three.
const REFERENCE_ERROR: f32 = 2.5e-4;
/// Mean square error (60 dB) below which no cell counts as still easier.
const MIN_ERROR: f32 = 1e-6;
/// How much of a cell's running error one window replaces.
const CELL_RATE: f32 = 0.02;

impl Weighting {
    /// Weight of a window whose cell has that running squared error; 0 where none was seen yet. A cell at the reference weighs
    /// the same in all three, which gives λ its unit.
    #[must_use]
    pub fn importance(self, running: f32) -> f32 {
        let (min, reference) = (RGB_OUTPUTS as f32 * MIN_ERROR, RGB_OUTPUTS as f32 * REFERENCE_ERROR);
        let error = running.max(min);
        match self {
            _ if running == 0.0 => 1.0,
            Self::Psnr => 1.0 / error,
            Self::Root => 1.0 / (error * reference).sqrt(),
            Self::Mse => 1.0 / reference,
        }
    }
}

/// Takes the squared errors of windows into the running means of their cells.
pub fn remember(running: &mut [f32], cells: &[u32], errors: &[f32]) {
    for (&cell, &error) in cells.iter().zip(errors) {
        let mean = &mut running[cell as usize];
        *mean = if *mean == 0.0 { error } else { *mean + CELL_RATE * (error - *mean) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_at_the_reference_weighs_the_same_in_all_three_and_hard_ones_less_or_alike() {
        let reference = RGB_OUTPUTS as f32 * REFERENCE_ERROR;
        let at = |error| [Weighting::Psnr, Weighting::Root, Weighting::Mse].map(|w| w.importance(error));
        assert!(at(reference).iter().all(|w| (w * reference - 1.0).abs() < 1e-6));
        let [psnr, root, mse] = at(4.0 * reference).map(|w| w * reference);
        assert!((psnr - 0.25).abs() < 1e-6 && (root - 0.5).abs() < 1e-6 && (mse - 1.0).abs() < 1e-6);
        assert_eq!(at(0.0), [1.0; 3]);
        assert_eq!(Weighting::Psnr.importance(1e-30), Weighting::Psnr.importance(1e-20));
    }

    #[test]
    fn a_cells_first_error_is_its_mean_and_later_ones_move_it_slowly() {
        let mut running = [0.0, 5.0];
        remember(&mut running, &[0, 0], &[1.0, 2.0]);
        assert!((running[0] - 1.02).abs() < 1e-6 && running[1] == 5.0);
    }
}
