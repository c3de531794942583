//! Sparsity by budget: λ of each shrinkage moves until as many of its codes are non-zero as the board has room for.
//!
//! Each step counts the non-zeros of the batch's windows at the noise where networks are judged, and multiplies each λ by
//! 1 + rate·(measured − target)/target, the fraction cut to ±1. The rate falls with the schedule's, so that what the last steps
//! settle is not pulled away again.

use serde::{Deserialize, Serialize};

/// A target for each shrinkage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// Mean non-zeros of z_t, t = 1…T−1, at the noise where networks are judged.
    pub non_zeros: Vec<f32>,
    /// How fast λ moves: at most this share of itself a step.
    pub rate: f32,
}

/// λ stays in this range.
const RANGE: [f32; 2] = [1e-7, 0.1];
/// A validated network keeps a budget that it exceeds by no more than this share.
const TOLERANCE: f64 = 0.03;

impl Budget {
    /// A rate that settles within some thousand steps.
    pub const RATE: f32 = 2e-3;

    /// Moves each λ toward its target; `measured` are a batch's mean non-zeros, `share` is the schedule's.
    pub fn steer(&self, lambdas: &mut [f32], measured: &[f32], share: f32) {
        for ((lambda, &found), &target) in lambdas.iter_mut().zip(measured).zip(&self.non_zeros) {
            let excess = ((found - target) / target).clamp(-1.0, 1.0);
            *lambda = (*lambda * (1.0 + self.rate * share * excess)).clamp(RANGE[0], RANGE[1]);
        }
    }

    /// Whether a validated network's mean non-zeros keep to the budget.
    #[must_use]
    pub fn keeps(&self, measured: &[f64]) -> bool {
        measured.iter().zip(&self.non_zeros).all(|(m, t)| *m <= f64::from(*t) * (1.0 + TOLERANCE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lambda_rises_where_too_many_are_left_and_falls_where_too_few() {
        let budget = Budget { non_zeros: vec![50.0, 50.0, 50.0], rate: 0.1 };
        let mut lambdas = [1e-3; 3];
        budget.steer(&mut lambdas, &[60.0, 50.0, 500.0], 0.5);
        for (lambda, expected) in lambdas.iter().zip([1.01e-3, 1e-3, 1.05e-3]) {
            assert!((lambda - expected).abs() < 1e-8, "{lambdas:?}");
        }
        budget.steer(&mut lambdas, &[0.0; 3], 1.0);
        assert!(lambdas.iter().all(|l| *l < 1e-3));
        (0..1000).for_each(|_| budget.steer(&mut lambdas, &[0.0; 3], 1.0));
        assert_eq!(lambdas, [RANGE[0]; 3]);
    }

    #[test]
    fn a_budget_is_kept_by_fewer_and_by_hardly_more() {
        let budget = Budget { non_zeros: vec![50.0, 40.0], rate: 0.1 };
        assert!(budget.keeps(&[51.0, 10.0]) && !budget.keeps(&[52.0, 10.0]) && !budget.keeps(&[10.0, 60.0]));
    }
}
