//! The integer network in floating point: every weight and code rounded to the words it will be, and a gradient that looks
//! through the rounding (straight-through estimator: Bengio, Léonard, Courville 2013).

use edof_core::colour::{OUTPUTS_422, RGB_OUTPUTS, rgb_from_ycbcr};
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_network::FixedNetwork;
use edof_network::float::format::Format;
use edof_network::float::matmul::{Destination, Mat, product};
use edof_network::float::pass::{Examples, Pass, weighted_errors};
use edof_network::network::Form;

/// Formats of a fixed network's b_t and z_t.
#[must_use]
pub fn code_formats(fixed: &FixedNetwork) -> Vec<Format> {
    fixed.code_fractions.iter().map(|fraction| Format::new(fixed.code_bits, *fraction)).collect()
}

/// The 192×128 map from F's outputs back to red, green and blue of the patch: undoes chroma gain and averaging weight, and puts
/// chroma between its sites as [`edof_core::colour::rgb_from_422`] does (at the last column, its neighbour).
#[must_use]
pub fn rgb_map(output_weights: &[f64]) -> Vec<f32> {
    let mut map = vec![0.0f32; RGB_OUTPUTS * OUTPUTS_422];
    let mut put = |rgb: [f64; 3], pixel: usize, output: usize, share: f64| {
        for (plane, value) in rgb.into_iter().enumerate() {
            map[(plane * PATCH_PIXELS + pixel) * OUTPUTS_422 + output] +=
                (value * share / output_weights[output]) as f32;
        }
    };
    for pixel in 0..PATCH_PIXELS {
        let (row, column) = (pixel / PATCH, pixel % PATCH);
        put(rgb_from_ycbcr(1.0, 0.0, 0.0), pixel, pixel, 1.0);
        let site = column / 2;
        let next = if column % 2 == 0 { site } else { (site + 1).min(PATCH / 2 - 1) };
        for site in [site, next] {
            let cb = PATCH_PIXELS + row * PATCH / 2 + site;
            put(rgb_from_ycbcr(0.0, 1.0, 0.0), pixel, cb, 0.5);
            put(rgb_from_ycbcr(0.0, 0.0, 1.0), pixel, cb + PATCH_PIXELS / 2, 0.5);
        }
    }
    map
}

/// The float network's pass over 4:2:2 outputs with rounded codes, and from there to red, green and blue.
#[derive(Debug)]
pub struct Simulated {
    /// The pass; holds what each layer sends.
    pub pass: Pass,
    to_rgb: Vec<f32>,
    rgb: Vec<f32>,
}

impl Simulated {
    /// Buffers for up to `capacity` windows; codes have these formats, `to_rgb` is [`rgb_map`].
    #[must_use]
    pub fn new(form: Form, codes: &[Format], to_rgb: &[f32], capacity: usize) -> Self {
        Self {
            pass: Pass::rounding(form, OUTPUTS_422, codes, capacity),
            to_rgb: to_rgb.to_vec(),
            rgb: vec![0.0; capacity * RGB_OUTPUTS],
        }
    }

    /// Runs `windows` windows with weights that are rounded already; gives red, green and blue (windows × 192).
    pub fn forward(&mut self, weights: &[f32], inputs: &[f32], windows: usize) -> &[f32] {
        let outputs = Mat::new(self.pass.forward(weights, inputs, windows), windows, OUTPUTS_422);
        let to_rgb = Mat::new(&self.to_rgb, RGB_OUTPUTS, OUTPUTS_422);
        product(&mut self.rgb, Destination::Replace, outputs, to_rgb.t());
        &self.rgb[..windows * RGB_OUTPUTS]
    }

    /// [`Simulated::forward`], then adds the gradient of Σ_p ½·`importance[p]`·‖e_p‖² to `gradient`, e_p the window's error as
    /// [`weighted_errors`] has it; `squared_errors[p]` becomes ‖e_p‖².
    pub fn gradient(
        &mut self,
        weights: &[f32],
        examples: &Examples<'_>,
        squared_errors: &mut [f32],
        gradient: &mut [f32],
    ) {
        let windows = examples.importance.len();
        self.forward(weights, examples.inputs, windows);
        weighted_errors(&mut self.rgb, examples, squared_errors);
        let to_rgb = Mat::new(&self.to_rgb, RGB_OUTPUTS, OUTPUTS_422);
        let errors = Mat::new(&self.rgb, windows, RGB_OUTPUTS);
        product(self.pass.outputs_mut(), Destination::Replace, errors, to_rgb);
        self.pass.backward(weights, examples.inputs, windows, &[], gradient);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fold::Folded;
    use edof_core::draw::Draw;
    use edof_core::number::InputWord;
    use edof_core::{Stride, Window};
    use edof_golden::scalar;
    use edof_network::float::parameters::Layout;
    use edof_network::network::{Recurrence, Shrinkage};
    use proptest::prelude::*;

    fn form(layers: usize, shrinkage: Shrinkage, flags: [bool; 3]) -> Form {
        Form {
            window: Window::new(8).unwrap(),
            codes: 7,
            layers,
            shrinkage,
            recurrence: if flags[0] { Recurrence::Difference } else { Recurrence::Direct },
            linear_path: flags[1],
            tied: flags[2],
            exposures: 1,
        }
    }

    /// Takes fraction bits from S until all sums of M fit the 24 bits of a float's mantissa, whatever the input; so does the
    /// rounding term. The base is what needs them: it is shifted up by nearly all of S's fraction bits.
    fn with_exact_sums(mut fixed: FixedNetwork) -> FixedNetwork {
        const SIGN_AND_MANTISSA: u32 = 25;
        for layer in 0..fixed.form.middle_layers() {
            while fixed.accumulator_bits()[layer + 1] > SIGN_AND_MANTISSA {
                fixed.recurrent[fixed.form.recurrent_index(layer)].fraction -= 1;
            }
        }
        fixed.check().unwrap();
        fixed
    }

    /// Where every sum fits a float exactly, the simulation must equal the specification.
    fn simulation_computes_the_words(
        layers: usize,
        shrinkage: Shrinkage,
        flags: [bool; 3],
        seed: u64,
    ) -> Result<(), TestCaseError> {
        let form = form(layers, shrinkage, flags);
        let fixed = with_exact_sums(edof_device::random::extreme(form, 8, Stride::PATCH, false, seed));
        let weights = Folded::of(&fixed).flatten();
        // Eight bits of input, so that I's sums are exact too: 64 products of 8 by 8 bits.
        let y: Vec<InputWord> = edof_device::random::extreme_window(&mut Draw::new(seed), 64)
            .iter()
            .map(|w| InputWord::from_bits(w.to_bits() & 0x7f80))
            .collect();
        let inputs: Vec<f32> = y.iter().map(|w| w.to_num()).collect();
        let mut pass = Simulated::new(form, &code_formats(&fixed), &rgb_map(&[1.0; 128]), 1);
        pass.forward(&weights, &inputs, 1);
        let trace = scalar::run(&fixed, &y);
        for (t, codes) in trace.layers.iter().enumerate() {
            let unit = (-(fixed.code_fractions[t] as f32)).exp2();
            let words = |values: &[f32]| values.iter().map(|v| (v / unit) as i16).collect::<Vec<_>>();
            prop_assert_eq!(words(pass.pass.b(t)), codes.b.clone(), "b of layer {}", t);
            prop_assert_eq!(words(pass.pass.z(t)), codes.z.clone(), "z of layer {}", t);
        }
        Ok(())
    }

    #[test]
    fn the_simulation_is_exact_where_as_random_the_base_would_pass_24_bits() {
        simulation_computes_the_words(9, Shrinkage::OneSided, [false; 3], 1_954_824_249_627_160_057).unwrap();
    }

    /// The branch of each code: its sign, and whether it is beyond 2θ, where firm thresholding has another slope.
    fn branches(codes: &[f32], theta: &[f32]) -> Vec<i8> {
        let branch = |(z, theta): (&f32, &f32)| {
            z.signum() as i8 * (i8::from(*z != 0.0) + i8::from(z.abs() > 2.0 * theta))
        };
        codes.iter().zip(theta.iter().cycle()).map(branch).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_simulation_computes_the_words_of_the_board(layers in 2usize..=10, shrinkage in prop::sample::select(&Shrinkage::ALL[..]), flags: [bool; 3], seed: u64) {
            simulation_computes_the_words(layers, shrinkage, flags, seed)?;
        }

        #[test]
        fn without_rounding_the_gradient_equals_finite_differences(
            layers in 2usize..=6, shrinkage in prop::sample::select(&Shrinkage::ALL[..]), flags: [bool; 3], seed: u64
        ) {
            let form = form(layers, shrinkage, flags);
            let layout = Layout::giving(&form, OUTPUTS_422);
            let mut draw = Draw::new(seed);
            let mut noise = |length: usize, scale: f32| -> Vec<f32> {
                (0..length).map(|_| draw.whole(-1000, 1000) as f32 * 1e-3 * scale).collect()
            };
            let mut weights = noise(layout.linear_path.end, 0.3);
            for theta in &layout.thresholds {
                // Far enough from 0 that no step makes a two-sided threshold negative.
                weights[theta.clone()].iter_mut().for_each(|t| *t = 0.02 + t.abs() * 0.2);
            }
            let (y, x) = (noise(3 * 64, 1.0), noise(3 * 192, 1.0));
            let importance = [1.0, 0.5, 2.0];
            let to_rgb = rgb_map(&[1.0; 128]);
            let mut pass = Simulated::new(form, &vec![Format::EXACT; form.shrinkages()], &to_rgb, 3);
            let (mut errors, mut gradient) = ([0.0; 3], vec![0.0; weights.len()]);
            let examples = Examples { inputs: &y, targets: &x, importance: &importance };
            pass.gradient(&weights, &examples, &mut errors, &mut gradient);
            let mut loss = |weights: &[f32]| {
                let (mut errors, mut unused) = ([0.0; 3], vec![0.0; weights.len()]);
                pass.gradient(weights, &examples, &mut errors, &mut unused);
                let open = (0..form.shrinkages()).map(|t| branches(pass.pass.z(t), &weights[layout.thresholds[t].clone()])).collect::<Vec<_>>();
                (errors.iter().zip(importance).map(|(e, i)| 0.5 * f64::from(e * i)).sum::<f64>(), open)
            };
            let groups = [&layout.analysis, &layout.dictionary, &layout.linear_path];
            for range in groups.into_iter().chain(&layout.thresholds).chain(&layout.recurrent).filter(|r| !r.is_empty()) {
                let direction = noise(range.len(), 1.0);
                let slope: f64 = direction.iter().zip(&gradient[range.clone()]).map(|(d, g)| f64::from(d * g)).sum();
                let step = 1e-3 / direction.iter().map(|d| d * d).sum::<f32>().sqrt();
                let mut at = |sign: f32| {
                    let mut moved = weights.clone();
                    moved[range.clone()].iter_mut().zip(&direction).for_each(|(w, d)| *w += sign * step * d);
                    loss(&moved)
                };
                let ((above, open_above), (below, open_below)) = (at(1.0), at(-1.0));
                if open_above != open_below {
                    continue; // A threshold lies between: the loss has no slope there.
                }
                let measured = (above - below) / f64::from(2.0 * step);
                let tolerance = 0.03 * slope.abs().max(measured.abs()) + 4e-6 * above / f64::from(step);
                prop_assert!((slope - measured).abs() <= tolerance, "{slope} {measured} {range:?}");
            }
        }
    }

    #[test]
    fn outputs_go_back_to_the_colours_they_came_from() {
        let stride = Stride::new(4).unwrap();
        let overlap = edof_core::overlap::Overlap::Hann;
        let map = crate::fold::output_map(stride, overlap);
        let weights = crate::fold::output_weights(stride, overlap);
        let colour: Vec<f64> = (0..192).map(|i| [0.2, 0.5, 0.7][i / 64]).collect();
        let outputs = map.dot(&ndarray::aview1(&colour));
        let back = rgb_map(&weights);
        for (row, colour) in back.chunks_exact(128).zip(&colour) {
            let value: f64 = row.iter().zip(&outputs).map(|(m, o)| f64::from(*m) * o).sum();
            assert!((value - colour).abs() < 1e-5);
        }
    }

    #[test]
    fn codes_are_rounded_in_the_formats_of_the_words() {
        let mut fixed = edof_device::random::extreme(
            form(4, Shrinkage::OneSided, [true; 3]),
            12,
            Stride::PATCH,
            false,
            1,
        );
        fixed.code_fractions = vec![3, 5, 4];
        let formats = code_formats(&fixed);
        assert_eq!(formats.iter().map(|f| f.step).collect::<Vec<_>>(), [0.125, 0.031_25, 0.0625]);
        assert!(formats.iter().all(|f| f.max == 2047.0));
    }

    #[test]
    fn chroma_lies_between_its_sites_and_gain_and_weight_are_undone() {
        let mut draw = Draw::new(2);
        let weights: Vec<f64> = (0..128).map(|_| draw.whole(50, 200) as f64 * 0.01).collect();
        let outputs: Vec<f64> = (0..128).map(|_| draw.whole(-100, 100) as f64 * 0.01).collect();
        let value = |output: usize| outputs[output] / weights[output];
        let map = rgb_map(&weights);
        assert_eq!(map.len(), 192 * 128);
        for (row, column) in (0..8).flat_map(|row| (0..8).map(move |column| (row, column))) {
            let chroma = |first: usize| {
                let at = |site: usize| value(first + 4 * row + site.min(3));
                0.5 * (at(column / 2) + at(column.div_ceil(2)))
            };
            let expected = rgb_from_ycbcr(value(8 * row + column), chroma(64), chroma(96));
            for (plane, expected) in expected.into_iter().enumerate() {
                let line = &map[(64 * plane + 8 * row + column) * 128..][..128];
                let found: f64 = line.iter().zip(&outputs).map(|(m, o)| f64::from(*m) * o).sum();
                assert!((found - expected).abs() < 1e-5, "{row} {column}: {found} {expected}");
            }
        }
    }

    #[test]
    fn windows_side_by_side_are_as_single_ones_and_errors_are_squares_of_what_is_off() {
        let form = form(3, Shrinkage::OneSided, [false, true, false]);
        let mut draw = Draw::new(3);
        let mut noise =
            |length: usize| (0..length).map(|_| draw.whole(-1000, 1000) as f32 * 2e-4).collect::<Vec<f32>>();
        let weights = noise(Layout::giving(&form, OUTPUTS_422).len());
        let (y, x) = (noise(2 * 64), noise(2 * 192));
        let to_rgb = rgb_map(&[0.5; 128]);
        let mut pass = Simulated::new(form, &[Format::EXACT; 2], &to_rgb, 3);
        let both = pass.forward(&weights, &y, 2).to_vec();
        assert_eq!(both.len(), 2 * 192);
        let single: Vec<f32> = y.chunks(64).flat_map(|y| pass.forward(&weights, y, 1).to_vec()).collect();
        assert!(both.iter().zip(&single).all(|(a, b)| (a - b).abs() < 1e-5));
        let examples = Examples { inputs: &y, targets: &x, importance: &[1.0; 2] };
        let mut errors = [0.0; 2];
        pass.gradient(&weights, &examples, &mut errors, &mut vec![0.0; weights.len()]);
        for (w, error) in errors.iter().enumerate() {
            let pairs = both[192 * w..].iter().zip(&x[192 * w..]).take(192);
            let expected: f32 = pairs.map(|(o, x)| (o - x).powi(2)).sum();
            assert!((error - expected).abs() < 1e-4 * expected, "{error} {expected}");
        }
    }
}
