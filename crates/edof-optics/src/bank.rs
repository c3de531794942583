//! PSFs from a camera's own bank ([`Kernels`]) in place of those that follow from its lens.

use edof_core::camera::Kernels;
use ndarray::{Array2, Array4, s};

/// The least and the greatest ψ of a bank.
#[must_use]
pub fn ends(kernels: &Kernels) -> [f64; 2] {
    let psis = kernels.psis();
    [psis.first(), psis.last()].map(|end| end.copied().unwrap_or(f64::NAN))
}

/// Red, green and blue at `psi`: the bank's own kernels at its own depths, between two of them their mean, each weighted by how near
/// it is; beyond its ends the last ones. A mean of two blurs is not the blur between them: depths should be close.
#[must_use]
pub fn at(kernels: &Kernels, psi: f64) -> [Array2<f32>; 3] {
    let psis = kernels.psis();
    let after = psis.iter().position(|depth| *depth >= psi).unwrap_or(psis.len() - 1);
    let before = after.saturating_sub(1);
    let gap = psis[after] - psis[before];
    let share = if gap > 0.0 { ((psi - psis[before]) / gap).clamp(0.0, 1.0) as f32 } else { 1.0 };
    let between = |channel: usize| {
        let (far, near) = (&kernels.at(before)[channel], &kernels.at(after)[channel]);
        // Not by arithmetic, so that a bank's own kernels come back bit for bit.
        match share {
            1.0 => near.clone(),
            0.0 => far.clone(),
            _ => mean(far, near, share),
        }
    };
    [0, 1, 2].map(between)
}

/// Kernels of several depths as the array that a bank's file holds, each about the middle of the largest: depths × 3 × side × side.
#[must_use]
pub fn stacked(depths: &[[&Array2<f32>; 3]]) -> Array4<f32> {
    let side = depths.iter().flatten().map(|kernel| kernel.nrows()).max().unwrap_or(1);
    let mut stack = Array4::zeros((depths.len(), 3, side, side));
    for (depth, kernels) in depths.iter().enumerate() {
        for (channel, kernel) in kernels.iter().enumerate() {
            let inner = inside(side, kernel);
            stack.slice_mut(s![depth, channel, inner.clone(), inner]).assign(kernel);
        }
    }
    stack
}

/// Where a kernel's rows and columns lie about the middle of `side`.
fn inside(side: usize, kernel: &Array2<f32>) -> std::ops::Range<usize> {
    let margin = (side - kernel.nrows()) / 2;
    margin..side - margin
}

/// (1 − share)·a + share·b about their common middle.
fn mean(a: &Array2<f32>, b: &Array2<f32>, share: f32) -> Array2<f32> {
    let side = a.nrows().max(b.nrows());
    let mut sum = Array2::zeros((side, side));
    for (kernel, weight) in [(a, 1.0 - share), (b, share)] {
        let inner = inside(side, kernel);
        sum.slice_mut(s![inner.clone(), inner]).scaled_add(weight, kernel);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point at ψ = 0; at ψ = 4 a point as many pixels lower as the channel says, and one.
    fn kernels() -> Kernels {
        let psf = Array4::from_shape_fn((2, 3, 9, 9), |(depth, channel, r, c)| {
            f64::from(u8::from((r, c) == (4 + depth * (channel + 1), 4)))
        });
        Kernels::new(vec![0.0, 4.0], psf.view(), None).unwrap()
    }

    #[test]
    fn a_banks_own_depths_come_back_as_they_are_and_others_as_means() {
        let bank = kernels();
        assert_eq!(at(&bank, 0.0).map(|k| k.nrows()), [1, 1, 1]);
        assert_eq!(at(&bank, 4.0).map(|k| k[(k.nrows() - 1, k.nrows() / 2)]), [1.0; 3]);
        let [red, _, blue] = at(&bank, 1.0);
        assert_eq!((red.nrows(), red[(1, 1)], red[(2, 1)]), (3, 0.75, 0.25));
        assert_eq!((blue.nrows(), blue[(3, 3)], blue[(6, 3)]), (7, 0.75, 0.25));
        assert_eq!(ends(&bank), [0.0, 4.0]);
    }

    #[test]
    fn a_stack_makes_the_same_bank() {
        let bank = kernels();
        let stack = stacked(&[bank.at(0).each_ref(), bank.at(1).each_ref()]);
        assert_eq!(stack.dim(), (2, 3, 7, 7));
        assert_eq!(Kernels::new(vec![0.0, 4.0], stack.mapv(f64::from).view(), None).unwrap(), bank);
    }
}
