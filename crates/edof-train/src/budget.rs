//! Sparsity by budget: λ of each shrinkage moves until as many of its codes are non-zero as the board has room for.
//!
//! A budget is judged on the busiest quarter of validation's sets (photographs, ψ) with noise: a board has to keep its rate on busy
//! scenes, and gains nothing by idle ones. Between validations each step counts the non-zeros of the batch's windows at the noise where networks are judged, and
//! multiplies each λ by 1 + rate·(counted − aim)/aim, the fraction cut to ±1. The aim is the budget times counted/validated of
//! the last validation, since training windows (other looks, other exposures) leave other numbers than validation's. The rate
//! falls with the schedule's, so that what the last steps settle is not pulled away again.

use edof_network::network::Form;
use serde::{Deserialize, Serialize};

/// A limit for each shrinkage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// Mean non-zeros of z_t, t = 1…T−1, on busy validation windows ([`crate::validation::Validation::busy_non_zeros`]).
    pub non_zeros: Vec<f32>,
    /// How fast λ moves: at most this share of itself a step.
    pub rate: f32,
}

/// λ moved by a budget stays in this range. A long training leaves fewer codes than the budget for most of its steps, and without a
/// floor λ sank to 1e-7: too far to return within the last steps, which leave more codes than the budget. Budgets of the default
/// board are met at some 5e-5 and above.
const RANGE: [f32; 2] = [2e-5, 0.1];
/// A validated network keeps a budget that it exceeds by no more than this share.
const TOLERANCE: f64 = 0.03;
/// Share of the newest batch in the running mean of what batches leave.
const NEWEST: f32 = 0.01;
/// Training windows leave at most N times as much as validation's, or as little.
const UNLIKE: f32 = 8.0;

/// What the default board (`designs/kc705.json`) has time for at 60 frames per second, with some room to spare, as shares of the codes:
/// 62 of 192 after every shrinkage but the last, and 54 after that.
const BOARD: [f32; 2] = [62.0 / 192.0, 54.0 / 192.0];

/// What moves λ while training runs.
#[derive(Debug, Clone, PartialEq)]
pub struct SparsityController {
    /// λ of each shrinkage.
    pub lambdas: Vec<f32>,
    /// Running mean of the non-zeros of training windows; 0 before the first.
    pub counted: Vec<f32>,
    /// What training windows should leave.
    pub aims: Vec<f32>,
}

impl SparsityController {
    /// Starts from `lambdas`; without a budget they stay.
    #[must_use]
    pub fn new(lambdas: Vec<f32>, budget: Option<&Budget>) -> Self {
        let shrinkages = lambdas.len();
        let aims = budget.map_or_else(|| vec![0.0; shrinkages], |b| b.non_zeros.clone());
        Self { lambdas, counted: vec![0.0; shrinkages], aims }
    }

    /// Moves each λ toward its aim; `found` are a batch's mean non-zeros, `share` is the schedule's.
    pub fn step(&mut self, budget: &Budget, found: &[f32], share: f32) {
        for (t, &found) in found.iter().enumerate() {
            let counted = &mut self.counted[t];
            *counted = if *counted == 0.0 { found } else { *counted + NEWEST * (found - *counted) };
            let excess = ((found - self.aims[t]) / self.aims[t]).clamp(-1.0, 1.0);
            let lambda = &mut self.lambdas[t];
            *lambda = (*lambda * (1.0 + budget.rate * share * excess)).clamp(RANGE[0], RANGE[1]);
        }
    }

    /// Corrects the aims by what validation windows leave.
    pub fn correct(&mut self, budget: &Budget, validated: &[f64]) {
        for (t, &validated) in validated.iter().enumerate() {
            let ratio = self.counted[t] / (validated as f32).max(f32::MIN_POSITIVE);
            self.aims[t] = budget.non_zeros[t] * ratio.clamp(1.0 / UNLIKE, UNLIKE);
        }
    }
}

impl Budget {
    /// A rate that settles within some thousand steps.
    pub const RATE: f32 = 2e-3;

    /// Returns the budget of networks for the default board, for the shrinkages that have one
    /// ([`edof_network::shrinkage::TrainingDefaults`]).
    #[must_use]
    pub fn of_the_board(form: &Form) -> Option<Self> {
        let last = form.shrinkages().checked_sub(1)?;
        let share = |t| if t == last { BOARD[1] } else { BOARD[0] };
        let non_zeros = (0..=last).map(|t| (share(t) * form.codes as f32).max(1.0)).collect();
        form.shrinkage.training().has_budget.then_some(Self { non_zeros, rate: Self::RATE })
    }

    /// What a validated network's non-zeros over the budget cost it when the best is chosen: 0.02 dB a percent.
    #[must_use]
    pub fn price_db(&self, validated: &[f64]) -> f64 {
        let over = validated.iter().zip(&self.non_zeros).map(|(v, b)| (v / f64::from(*b) - 1.0).max(0.0));
        2.0 * over.sum::<f64>()
    }

    /// Whether a validated network's mean non-zeros keep to the budget.
    #[must_use]
    pub fn keeps(&self, validated: &[f64]) -> bool {
        validated.iter().zip(&self.non_zeros).all(|(v, b)| *v <= f64::from(*b) * (1.0 + TOLERANCE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steering(budget: &Budget) -> SparsityController {
        SparsityController::new(vec![1e-3; budget.non_zeros.len()], Some(budget))
    }

    #[test]
    fn lambda_rises_where_too_many_are_left_and_falls_where_too_few() {
        let budget = Budget { non_zeros: vec![50.0, 50.0, 50.0], rate: 0.1 };
        let mut steering = steering(&budget);
        steering.step(&budget, &[60.0, 50.0, 500.0], 0.5);
        for (lambda, expected) in steering.lambdas.iter().zip([1.01e-3, 1e-3, 1.05e-3]) {
            assert!((lambda - expected).abs() < 1e-8, "{steering:?}");
        }
        steering.step(&budget, &[0.0; 3], 1.0);
        assert!(steering.lambdas.iter().all(|l| *l < 1e-3));
        (0..1000).for_each(|_| steering.step(&budget, &[0.0; 3], 1.0));
        assert_eq!(steering.lambdas, [RANGE[0]; 3]);
    }

    #[test]
    fn lambda_returns_within_a_short_training_from_the_floor_that_a_long_one_sank_to() {
        let budget = Budget { non_zeros: vec![50.0], rate: Budget::RATE };
        let mut steering = steering(&budget);
        (0..20_000).for_each(|_| steering.step(&budget, &[40.0], 1.0));
        assert_eq!(steering.lambdas, [RANGE[0]]);
        (0..2_000).for_each(|_| steering.step(&budget, &[75.0], 1.0));
        assert!(steering.lambdas[0] > 1e-4, "{steering:?}");
    }

    #[test]
    fn training_windows_are_held_to_what_makes_validation_windows_keep_the_budget() {
        let budget = Budget { non_zeros: vec![50.0, 40.0], rate: 0.1 };
        let mut steering = steering(&budget);
        steering.step(&budget, &[60.0, 60.0], 1.0);
        steering.correct(&budget, &[30.0, 90.0]);
        let expected = [50.0 * 60.0 / 30.0, 40.0 * 60.0 / 90.0];
        assert!(steering.aims.iter().zip(expected).all(|(a, e): (&f32, f32)| (a - e).abs() < 1e-3));
        steering.correct(&budget, &[0.0, 1e9]);
        assert_eq!(steering.aims, [50.0 * UNLIKE, 40.0 / UNLIKE]);
    }

    #[test]
    fn a_budget_is_kept_by_fewer_and_by_hardly_more() {
        let budget = Budget { non_zeros: vec![50.0, 40.0], rate: 0.1 };
        assert!(
            (budget.price_db(&[51.0, 10.0]) - 0.04).abs() < 1e-9,
            "2 % over, and nothing for what is saved"
        );
        assert!(budget.keeps(&[51.0, 10.0]) && !budget.keeps(&[52.0, 10.0]) && !budget.keeps(&[10.0, 60.0]));
    }
}
