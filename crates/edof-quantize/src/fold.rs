//! What is folded into the matrices before rounding: the colour map, the averaging window, equal ranges. The function stays
//! the same; only its numbers become fit for integers.

use crate::{Calibration, QuantizeOptions};
use edof_core::Stride;
use edof_core::colour::{OUTPUTS_422, patch_422_from_rgb};
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_core::number::CHROMA_GAIN;
use edof_core::overlap::Overlap;
use edof_network::fixed_network::FixedMatrix;
use edof_network::float::parameters::Layout;
use edof_network::network::Form;
use edof_network::{FixedNetwork, Network};
use ndarray::{Array1, Array2};
use std::ops::Range;

/// A network in the board's units, still in floating point: codes of −1…1, outputs in units of 1 (luma) and
/// 1/[`CHROMA_GAIN`] (chroma), weighted for the overlap.
#[derive(Debug, Clone, PartialEq)]
pub struct Folded {
    /// A: codes × pixels.
    pub analysis: Array2<f64>,
    /// θ_t.
    pub thresholds: Vec<Array1<f64>>,
    /// S_t.
    pub recurrent: Vec<Array2<f64>>,
    /// D: 128 × codes.
    pub dictionary: Array2<f64>,
    /// R: 128 × pixels.
    pub linear_path: Option<Array2<f64>>,
}

impl Folded {
    /// The values that a fixed network's words stand for.
    #[must_use]
    pub fn of(fixed: &FixedNetwork) -> Self {
        let unit = |fraction: u32| (-f64::from(fraction)).exp2();
        let values = |m: &FixedMatrix| m.weights.mapv(|w| f64::from(w) * unit(m.fraction));
        let thetas = fixed.thresholds.iter().zip(&fixed.code_fractions);
        Self {
            analysis: values(&fixed.analysis),
            thresholds: thetas.map(|(theta, f)| theta.mapv(|t| f64::from(t) * unit(*f))).collect(),
            recurrent: fixed.recurrent.iter().map(values).collect(),
            dictionary: values(&fixed.dictionary),
            linear_path: fixed.linear_path.as_ref().map(values),
        }
    }

    /// All values as one vector, in the order of [`Layout`]; the inverse of [`Folded::unflatten`].
    #[must_use]
    pub fn flatten(&self) -> Vec<f32> {
        let matrices = self.recurrent.iter().chain([&self.dictionary]).chain(&self.linear_path);
        let first = self.analysis.iter().chain(self.thresholds.iter().flatten());
        first.chain(matrices.flatten()).map(|v| *v as f32).collect()
    }

    /// What a flat vector of its form describes.
    #[must_use]
    pub fn unflatten(form: &Form, flat: &[f32]) -> Self {
        let layout = Layout::giving(form, OUTPUTS_422);
        let (codes, pixels) = (form.codes, form.window.pixels());
        let matrix = |range: &Range<usize>, columns: usize| {
            let flat = &flat[range.clone()];
            let at = |(r, c)| f64::from(flat[r * columns + c]);
            Array2::from_shape_fn((flat.len() / columns, columns), at)
        };
        let vector = |range: &Range<usize>| flat[range.clone()].iter().map(|v| f64::from(*v)).collect();
        Self {
            analysis: matrix(&layout.analysis, pixels),
            thresholds: layout.thresholds.iter().map(vector).collect(),
            recurrent: layout.recurrent.iter().map(|s| matrix(s, codes)).collect(),
            dictionary: matrix(&layout.dictionary, codes),
            linear_path: form.linear_path.then(|| matrix(&layout.linear_path, pixels)),
        }
    }
}

/// The 128×192 map from an RGB patch to what F gives: 4:2:2, chroma times [`CHROMA_GAIN`], each output times the averaging
/// window's weight at its pixel (for chroma, at its site).
#[must_use]
pub fn output_map(stride: Stride, overlap: Overlap) -> Array2<f64> {
    let mut map = patch_422_from_rgb();
    map.outer_iter_mut().zip(output_weights(stride, overlap)).for_each(|(mut row, weight)| row *= weight);
    map
}

/// Averaging weight times gain of each of the 128 outputs.
#[must_use]
pub fn output_weights(stride: Stride, overlap: Overlap) -> Vec<f64> {
    let window = overlap.weights(stride);
    (0..OUTPUTS_422).map(|output| output_weight(&window, output)).collect()
}

fn output_weight(window: &Array2<f64>, output: usize) -> f64 {
    if output < PATCH_PIXELS {
        return window[(output / PATCH, output % PATCH)];
    }
    let site = (output - PATCH_PIXELS) % (PATCH_PIXELS / 2);
    let (row, column) = (site / (PATCH / 2), site % (PATCH / 2) * 2);
    window[(row, column)] * CHROMA_GAIN
}

/// A coefficient's range is taken to be at least this share of what b₁ could reach for any window: one that is (almost)
/// never used must not ask for enormous weights.
const MIN_SHARE: f64 = 0.01;

/// What b and z of each coefficient are multiplied by so that all use their range: 1/(largest value seen × headroom).
#[must_use]
pub fn scales(network: &Network, calibration: &Calibration, options: &QuantizeOptions) -> Vec<f64> {
    // The largest code is 2^(bits−1) − 1, a little less than one.
    let full = 1.0 - (1.0 - f64::from(options.bits)).exp2();
    (0..network.form.codes)
        .map(|i| {
            let reachable: f64 = network.analysis.row(i).iter().map(|w| f64::from(w.abs())).sum();
            let seen = calibration.codes.iter().chain(&calibration.changes).map(|layer| f64::from(layer[i]));
            // θ < 0 is itself a value of z.
            let passed = network.thresholds.iter().map(|theta| f64::from(-theta[i]));
            let largest = seen.chain(passed).fold(MIN_SHARE * reachable, f64::max);
            if largest > 0.0 { full / (largest * options.headroom) } else { 1.0 }
        })
        .collect()
}

/// Folds everything: b′ = c∘b, z′ = c∘z, and outputs through [`output_map`].
#[must_use]
pub fn fold(network: &Network, scales: &[f64], stride: Stride, overlap: Overlap) -> Folded {
    let map = output_map(stride, overlap);
    let wide = |m: &Array2<f32>| m.mapv(f64::from);
    let rows = |mut m: Array2<f64>| {
        m.outer_iter_mut().zip(scales).for_each(|(mut row, c)| row *= *c);
        m
    };
    let columns = |mut m: Array2<f64>| {
        m.columns_mut().into_iter().zip(scales).for_each(|(mut column, c)| column /= *c);
        m
    };
    Folded {
        analysis: rows(wide(&network.analysis)),
        thresholds: network
            .thresholds
            .iter()
            .map(|theta| theta.iter().zip(scales).map(|(t, c)| f64::from(*t) * c).collect())
            .collect(),
        recurrent: network.recurrent.iter().map(|s| columns(rows(wide(s)))).collect(),
        dictionary: columns(map.dot(&wide(&network.dictionary))),
        linear_path: network.linear_path.as_ref().map(|r| map.dot(&wide(r))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grey_patch_gives_overlap_weighted_luma_and_no_chroma() {
        for step in [2, 4, 8] {
            let stride = Stride::new(step).unwrap();
            let out = output_map(stride, Overlap::Hann).dot(&edof_core::colour::grey_patch(1.0));
            let weights = Overlap::Hann.weights(stride);
            out.iter().take(64).zip(&weights).for_each(|(a, b)| assert!((a - b).abs() < 1e-12));
            assert!(out.iter().skip(64).all(|v| v.abs() < 1e-12));
        }
    }

    #[test]
    fn chroma_carries_its_gain_and_the_weight_of_its_site() {
        let stride = Stride::new(4).unwrap();
        let map = output_map(stride, Overlap::Hann);
        let weights = Overlap::Hann.weights(stride);
        // Blue light has Cb = 0.5 everywhere. Row 3, site 1 lies at pixel (3, 2).
        let blue = Array1::from_shape_fn(192, |i| if i >= 128 { 1.0 } else { 0.0 });
        let cb = map.row(64 + 3 * 4 + 1).dot(&blue);
        assert!((cb - 0.5 * CHROMA_GAIN * weights[(3, 2)]).abs() < 1e-12);
    }

    fn form(flags: [bool; 2]) -> Form {
        Form {
            window: edof_core::Window::new(8).unwrap(),
            codes: 2,
            layers: 4,
            shrinkage: edof_network::network::Shrinkage::OneSided,
            recurrence: edof_network::network::Recurrence::Direct,
            linear_path: flags[0],
            tied: flags[1],
            exposures: 1,
        }
    }

    /// A network whose every number is different.
    fn network(flags: [bool; 2]) -> Network {
        let form = form(flags);
        let flat: Vec<f32> = (0..Layout::new(&form).len()).map(|i| (i + 1) as f32 / 1024.0).collect();
        edof_network::float::parameters::unflatten(form, &flat, edof_device::random::natural(8, 8, 1).origin)
    }

    #[test]
    fn a_flat_vector_is_row_by_row_in_the_order_of_its_layout() {
        for flags in [[false, false], [true, false], [false, true], [true, true]] {
            let layout = Layout::giving(&form(flags), OUTPUTS_422);
            let flat: Vec<f32> = (0..layout.len()).map(|i| i as f32).collect();
            let folded = Folded::unflatten(&form(flags), &flat);
            assert_eq!(folded.flatten(), flat);
            let at = |range: &Range<usize>, offset: usize| (range.start + offset) as f64;
            assert_eq!((folded.analysis.dim(), folded.dictionary.dim()), ((2, 64), (128, 2)));
            assert_eq!(folded.analysis[(1, 5)], at(&layout.analysis, 69));
            assert_eq!(folded.thresholds[2][1], at(&layout.thresholds[2], 1));
            assert_eq!(folded.recurrent.len(), layout.recurrent.len());
            assert_eq!(folded.recurrent[0][(1, 0)], at(&layout.recurrent[0], 2));
            assert_eq!(folded.dictionary[(100, 1)], at(&layout.dictionary, 201));
            let r = folded.linear_path.as_ref().map(|r| r[(3, 7)]);
            assert_eq!(r, flags[0].then(|| at(&layout.linear_path, 3 * 64 + 7)));
        }
    }

    #[test]
    fn words_stand_for_multiples_of_their_last_bit() {
        let mut fixed = edof_device::random::extreme(form([true, false]), 8, Stride::PATCH, false, 4);
        fixed.code_fractions = vec![3, 4, 5];
        let folded = Folded::of(&fixed);
        let last_bit = |fraction: u32| 0.5f64.powi(fraction as i32);
        let value = |m: &FixedMatrix| f64::from(m.weights[(1, 1)]) * last_bit(m.fraction);
        assert_eq!(folded.analysis[(1, 1)], value(&fixed.analysis));
        assert_eq!(folded.recurrent[1][(1, 1)], value(&fixed.recurrent[1]));
        assert_eq!(folded.dictionary[(1, 1)], value(&fixed.dictionary));
        assert_eq!(folded.linear_path.unwrap()[(1, 1)], value(fixed.linear_path.as_ref().unwrap()));
        for (t, theta) in folded.thresholds.iter().enumerate() {
            assert_eq!(*theta, fixed.thresholds[t].mapv(|w| f64::from(w) * last_bit(3 + t as u32)));
        }
    }

    #[test]
    fn every_output_has_the_weight_of_the_pixel_where_it_lies() {
        let stride = Stride::new(2).unwrap();
        let window = Overlap::Hann.weights(stride);
        let found = output_weights(stride, Overlap::Hann);
        let luma = (0..8).flat_map(|r| (0..8).map(move |c| (r, c, 1.0)));
        let chroma = (0..8).flat_map(|r| (0..4).map(move |site| (r, 2 * site, CHROMA_GAIN)));
        let all: Vec<_> = luma.chain(chroma.clone()).chain(chroma).collect();
        assert_eq!(found.len(), all.len());
        for (weight, (row, column, gain)) in found.iter().zip(all) {
            assert_eq!(*weight, window[(row, column)] * gain);
        }
    }

    #[test]
    fn scales_make_the_largest_value_seen_times_headroom_the_largest_code() {
        let options = QuantizeOptions { bits: 8, headroom: 2.0, ..QuantizeOptions::default() };
        let mut network = network([false, false]);
        network.analysis.row_mut(0).fill(-0.5);
        network.analysis.row_mut(1).fill(0.0);
        network.thresholds.iter_mut().for_each(|theta| theta.fill(0.0));
        let mut seen = Calibration::new(&network.form);
        let full = 127.0 / 128.0;
        let check = |network: &Network, seen: &Calibration, largest: [f64; 2]| {
            for (scale, largest) in scales(network, seen, &options).iter().zip(largest) {
                let expected = if largest == 0.0 { 1.0 } else { full / (2.0 * largest) };
                assert!((scale - expected).abs() < 1e-9 * expected, "{scale} {expected}");
            }
        };
        // No window makes more of the first than 64·0.5; a hundredth of that counts as seen.
        check(&network, &seen, [0.32, 0.0]);
        seen.codes[1] = vec![0.25, 4.0];
        check(&network, &seen, [0.32, 4.0]);
        seen.changes[2] = vec![0.5, 3.0];
        check(&network, &seen, [0.5, 4.0]);
        network.thresholds[2] = ndarray::array![7.0, -6.0];
        check(&network, &seen, [0.5, 6.0]);
    }

    #[test]
    fn scaled_codes_leave_every_product_what_it_was() {
        let stride = Stride::new(4).unwrap();
        for flags in [[false, false], [true, true]] {
            let network = network(flags);
            let scales = [2.0, 0.25];
            let folded = fold(&network, &scales, stride, Overlap::Hann);
            let map = output_map(stride, Overlap::Hann);
            let wide = |m: &Array2<f32>| m.mapv(f64::from);
            let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} {b}");
            for ((r, c), w) in folded.analysis.indexed_iter() {
                near(*w, f64::from(network.analysis[(r, c)]) * scales[r]);
            }
            for ((t, theta), i) in folded.thresholds.iter().enumerate().flat_map(|t| [(t, 0), (t, 1)]) {
                near(theta[i], f64::from(network.thresholds[t][i]) * scales[i]);
            }
            for (s, float) in folded.recurrent.iter().zip(&network.recurrent) {
                s.indexed_iter()
                    .for_each(|((r, c), w)| near(*w, f64::from(float[(r, c)]) * scales[r] / scales[c]));
            }
            let dictionary = map.dot(&wide(&network.dictionary));
            folded.dictionary.indexed_iter().for_each(|((r, c), w)| near(*w, dictionary[(r, c)] / scales[c]));
            assert_eq!(folded.linear_path, network.linear_path.as_ref().map(|r| map.dot(&wide(r))));
        }
    }
}
