//! A photograph with a depth for each pixel as a scene of layers.
//!
//! Each layer holds its own pixels and, where nearer ones hide it, what its own suggest: the average of those around, from near by
//! where there are any. So blur at the edge of a near thing mixes it with what could be behind, as [`crate::Scene`] composes it.

use crate::scene::{Layer, Scene};
use edof_core::ColourFrame;
use ndarray::{Array2, Array3, Axis};
use rayon::prelude::*;

/// Most layers that a photograph is cut into.
pub const MAX_LAYERS: usize = 64;

/// Layers that a photograph is cut into unless another number is asked for.
pub const USUAL: usize = 16;

/// Depths that make no layers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum LayersError {
    /// Of another size than the picture.
    #[error("depth map {width}x{height}: expected {expected_width}x{expected_height} as the photograph")]
    Size { width: usize, height: usize, expected_width: usize, expected_height: usize },
    /// No depth.
    #[error("depth map: psi at row {row}, column {column} is {psi}, expected a finite number")]
    Psi { row: usize, column: usize, psi: f32 },
    /// None, or more than anyone needs.
    #[error("layers {0}: must be 1 to {MAX_LAYERS}")]
    Count(usize),
}

/// A scene of at most `max` layers: one for each value of `psi` (radians, rows × columns) where there are no more, else as many
/// steps of equal width. Light in; nearer things have larger ψ.
///
/// # Errors
/// [`LayersError`].
pub fn from_depths(
    name: &str,
    light: &ColourFrame,
    psi: &Array2<f32>,
    max: usize,
) -> Result<Scene, LayersError> {
    fits(light, psi, max)?;
    let depths = depths(psi, max);
    let last = depths.len() - 1;
    let nearest = |v: f32| {
        let after = depths.partition_point(|d| *d < v).min(last);
        let before = after.saturating_sub(1);
        if (v - depths[before]).abs() <= (depths[after] - v).abs() { before } else { after }
    };
    let index = psi.mapv(nearest);
    let layer = |depth: usize| {
        let own = index.mapv(|i| f32::from(u8::from(i == depth)));
        // What is nearer lies in front of this layer, not beside it.
        let matte = index.mapv(|i| f32::from(u8::from(i >= depth)));
        let planes = filled(&light.planes, &own) * &matte;
        Layer {
            light: ColourFrame { planes },
            matte: (depth > 0).then_some(matte),
            psi: f64::from(depths[depth]),
        }
    };
    // A step in which no pixel lies is no layer; the first and the last have some.
    let used: Vec<usize> = (0..=last).filter(|depth| index.iter().any(|i| i == depth)).collect();
    let layers = used.into_par_iter().map(layer).collect();
    Ok(Scene { name: name.to_owned(), layers })
}

/// Whether a photograph may be cut into at most `max` layers.
///
/// # Errors
/// [`LayersError::Count`].
pub fn check(max: usize) -> Result<(), LayersError> {
    match (1..=MAX_LAYERS).contains(&max) {
        true => Ok(()),
        false => Err(LayersError::Count(max)),
    }
}

fn fits(light: &ColourFrame, psi: &Array2<f32>, max: usize) -> Result<(), LayersError> {
    check(max)?;
    let ((height, width), (expected_height, expected_width)) = (psi.dim(), light.size());
    if psi.dim() != light.size() {
        return Err(LayersError::Size { width, height, expected_width, expected_height });
    }
    match psi.indexed_iter().find(|(_, v)| !v.is_finite()) {
        Some(((row, column), &psi)) => Err(LayersError::Psi { row, column, psi }),
        None => Ok(()),
    }
}

/// Depths of the layers, ascending: from back to front.
fn depths(psi: &Array2<f32>, max: usize) -> Vec<f32> {
    let mut values: Vec<f32> = psi.iter().copied().collect();
    values.sort_by(f32::total_cmp);
    values.dedup();
    let [low, high] = [values.first(), values.last()].map(|end| end.copied().unwrap_or(0.0));
    match max {
        _ if values.len() <= max => values,
        1 => vec![0.5 * (low + high)],
        _ => (0..max).map(|i| low + (high - low) * i as f32 / (max - 1) as f32).collect(),
    }
}

/// Planes that are known where `known` is 1, and elsewhere filled from coarser and coarser averages of what is (push and pull).
fn filled(planes: &Array3<f32>, known: &Array2<f32>) -> Array3<f32> {
    let (height, width) = known.dim();
    if known.iter().all(|w| *w >= 1.0) || (height, width) == (1, 1) {
        return planes.clone();
    }
    let half = (height.div_ceil(2), width.div_ceil(2));
    let (mut sums, mut weights) =
        (Array3::<f32>::zeros((planes.dim().0, half.0, half.1)), Array2::<f32>::zeros(half));
    for ((r, c), &weight) in known.indexed_iter().filter(|(_, w)| **w > 0.0) {
        weights[(r / 2, c / 2)] += weight;
        for plane in 0..planes.dim().0 {
            sums[(plane, r / 2, c / 2)] += weight * planes[(plane, r, c)];
        }
    }
    for mut plane in sums.axis_iter_mut(Axis(0)) {
        plane.zip_mut_with(&weights, |sum, &weight| *sum /= weight.max(f32::MIN_POSITIVE));
    }
    let coarse = filled(&sums, &weights.mapv(|w| w.min(1.0)));
    let between = |at: usize, n: usize| {
        // Where a fine pixel's middle lies among the coarse ones'.
        let position = (0.5 * (at as f32 + 0.5) - 0.5).clamp(0.0, (n - 1) as f32);
        let first = position as usize;
        (first, (first + 1).min(n - 1), position - first as f32)
    };
    Array3::from_shape_fn(planes.dim(), |(p, r, c)| {
        let weight = known[(r, c)];
        if weight >= 1.0 {
            return planes[(p, r, c)];
        }
        let ((top, bottom, down), (left, right, across)) = (between(r, half.0), between(c, half.1));
        let line = |row| (1.0 - across) * coarse[(p, row, left)] + across * coarse[(p, row, right)];
        let around = (1.0 - down) * line(top) + down * line(bottom);
        weight * planes[(p, r, c)] + (1.0 - weight) * around
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn picture(height: usize, width: usize) -> ColourFrame {
        let value = |(p, r, c): (usize, usize, usize)| ((p * 7 + r * 3 + c * 5) % 11) as f32 / 11.0;
        ColourFrame { planes: Array3::from_shape_fn((3, height, width), value) }
    }

    #[test]
    fn the_back_continues_behind_what_is_in_front() {
        let mut light = ColourFrame::zeros(16, 24);
        light.planes.fill(0.25);
        let psi = Array2::from_shape_fn((16, 24), |(_, c)| if c < 12 { 6.0 } else { 1.0 });
        light.planes.slice_mut(ndarray::s![.., .., ..12]).fill(0.75);
        let scene = from_depths("two", &light, &psi, 16).unwrap();
        assert_eq!(scene.layers.iter().map(|l| l.psi).collect::<Vec<_>>(), [1.0, 6.0]);
        assert!(
            scene.layers[0].matte.is_none()
                && scene.layers[0].light.planes.iter().all(|v| (v - 0.25).abs() < 1e-6)
        );
        let front = &scene.layers[1];
        assert_eq!((front.light.planes[(0, 3, 11)], front.light.planes[(0, 3, 12)]), (0.75, 0.0));
    }

    #[test]
    fn many_depths_become_as_many_layers_as_asked_for() {
        let psi = Array2::from_shape_fn((20, 30), |(r, c)| (r * 30 + c) as f32 / 75.0);
        let scene = from_depths("slope", &picture(20, 30), &psi, 9).unwrap();
        let psis: Vec<f64> = scene.layers.iter().map(|l| l.psi).collect();
        assert_eq!((psis.len(), psis[0]), (9, 0.0));
        assert!((psis[8] - 599.0 / 75.0).abs() < 1e-5 && psis.is_sorted());
        assert_eq!(from_depths("one", &picture(20, 30), &psi, 1).unwrap().layers.len(), 1);
    }

    #[test]
    fn what_makes_no_layers_is_rejected() {
        let refused =
            |psi: &Array2<f32>, max| from_depths("x", &picture(4, 6), psi, max).unwrap_err().to_string();
        assert_eq!(refused(&Array2::zeros((6, 4)), 8), "depth map 4x6: expected 6x4 as the photograph");
        assert_eq!(refused(&Array2::zeros((4, 6)), 0), "layers 0: must be 1 to 64");
        let mut psi = Array2::zeros((4, 6));
        psi[(2, 5)] = f32::NAN;
        assert!(refused(&psi, 8).contains("row 2, column 5 is NaN"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn without_blur_the_photograph_comes_back(
            height in 1usize..20, width in 1usize..20, max in 1usize..9, seed in any::<u32>()
        ) {
            let light = picture(height, width);
            let psi = Array2::from_shape_fn((height, width), |(r, c)| {
                ((r as u32 / 3 * 31 + c as u32 / 4 * 17).wrapping_mul(seed | 1) >> 20) as f32 / 512.0
            });
            let scene = from_depths("p", &light, &psi, max).unwrap();
            scene.check().unwrap();
            prop_assert_eq!(scene.sharp(), light);
            let range = psi.iter().copied().fold(0.0f32, f32::max);
            let step = if max == 1 { range } else { range / max as f32 };
            let far = scene.psi_map().iter().zip(&psi).any(|(a, b)| (a - b).abs() > step + 1e-4);
            prop_assert!(!far);
        }
    }
}
