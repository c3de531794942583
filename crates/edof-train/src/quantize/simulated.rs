//! The integer network in floating point: every weight and code rounded to the words it will be, and a gradient that looks
//! through the rounding (straight-through estimator: Bengio, Léonard, Courville 2013).

use super::fold::Folded;
use crate::matmul::{Into, Mat, product};
use edof_spec::FixedNetwork;
use edof_spec::colour::{OUTPUTS_422, RGB_OUTPUTS, rgb_from_ycbcr};
use edof_spec::geometry::{PATCH, PATCH_PIXELS};
use edof_spec::network::{Form, Recurrence, Shrinkage};
use ndarray::Array2;
use std::ops::Range;

/// A number format: multiples of `step` from −(`most` + 1)·`step` to `most`·`step`. A step of 0 rounds nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Format {
    /// The smallest difference.
    pub step: f32,
    /// The largest word.
    pub most: f32,
}

impl Format {
    /// Words of `bits` bits, `fraction` of them fraction bits.
    #[must_use]
    pub fn new(bits: u32, fraction: u32) -> Self {
        Self { step: (-(fraction as f32)).exp2(), most: ((1u32 << (bits - 1)) - 1) as f32 }
    }

    /// The nearest word, ties toward +∞, as the board rounds.
    fn round(self, value: f32) -> f32 {
        if self.step == 0.0 {
            return value;
        }
        (value / self.step + 0.5).floor().clamp(-self.most - 1.0, self.most) * self.step
    }

    /// Whether a rounded value stands at the end of its range, so that nothing passes back through it.
    fn is_clipped(self, rounded: f32) -> bool {
        self.step != 0.0 && !(-self.most * self.step..self.most * self.step).contains(&rounded)
    }
}

/// Where each matrix of a folded network lies in one flat vector; all row-major.
#[derive(Debug, Clone)]
pub struct Places {
    /// A.
    pub analysis: Range<usize>,
    /// θ_t.
    pub thresholds: Vec<Range<usize>>,
    /// S_t.
    pub recurrent: Vec<Range<usize>>,
    /// D: 128 × codes.
    pub dictionary: Range<usize>,
    /// R: 128 × pixels; empty where there is none.
    pub linear_path: Range<usize>,
}

impl Places {
    /// The layout of a form.
    #[must_use]
    pub fn new(form: &Form) -> Self {
        let mut end = 0;
        let mut take = |length: usize| {
            end += length;
            end - length..end
        };
        let (codes, pixels) = (form.codes, form.window.pixels());
        Self {
            analysis: take(codes * pixels),
            thresholds: (0..form.shrinkages()).map(|_| take(codes)).collect(),
            recurrent: (0..form.recurrent_matrices()).map(|_| take(codes * codes)).collect(),
            dictionary: take(OUTPUTS_422 * codes),
            linear_path: take(if form.linear_path { OUTPUTS_422 * pixels } else { 0 }),
        }
    }

    /// The flat vector of a folded network.
    #[must_use]
    pub fn flatten(folded: &Folded) -> Vec<f32> {
        let matrices = folded.recurrent.iter().chain([&folded.dictionary]).chain(&folded.linear_path);
        let first = folded.analysis.iter().chain(folded.thresholds.iter().flatten());
        first.chain(matrices.flatten()).map(|v| *v as f32).collect()
    }

    /// The folded network of a flat vector.
    #[must_use]
    pub fn unflatten(&self, form: &Form, flat: &[f32]) -> Folded {
        let matrix = |range: &Range<usize>, columns: usize| {
            Array2::from_shape_fn((range.len() / columns, columns), |(r, c)| {
                f64::from(flat[range.start + r * columns + c])
            })
        };
        let (codes, pixels) = (form.codes, form.window.pixels());
        let vector = |range: &Range<usize>| flat[range.clone()].iter().map(|v| f64::from(*v)).collect();
        Folded {
            analysis: matrix(&self.analysis, pixels),
            thresholds: self.thresholds.iter().map(vector).collect(),
            recurrent: self.recurrent.iter().map(|s| matrix(s, codes)).collect(),
            dictionary: matrix(&self.dictionary, codes),
            linear_path: form.linear_path.then(|| matrix(&self.linear_path, pixels)),
        }
    }
}

/// Formats of everything that is rounded.
#[derive(Debug, Clone)]
pub struct Formats {
    /// Each run of weights that shares a format.
    pub weights: Vec<(Range<usize>, Format)>,
    /// b_t, z_t.
    pub codes: Vec<Format>,
}

impl Formats {
    /// Those of a fixed network.
    #[must_use]
    pub fn of(fixed: &FixedNetwork, places: &Places) -> Self {
        let format = |fraction: u32| Format::new(fixed.code_bits, fraction);
        let mut weights = vec![(places.analysis.clone(), format(fixed.analysis.fraction))];
        let thetas = places.thresholds.iter().zip(&fixed.code_fractions);
        weights.extend(thetas.map(|(range, f)| (range.clone(), format(*f))));
        let matrices = places.recurrent.iter().zip(&fixed.recurrent);
        weights.extend(matrices.map(|(range, s)| (range.clone(), format(s.fraction))));
        weights.push((places.dictionary.clone(), format(fixed.dictionary.fraction)));
        weights.extend(fixed.linear_path.iter().map(|r| (places.linear_path.clone(), format(r.fraction))));
        Self { weights, codes: fixed.code_fractions.iter().map(|f| format(*f)).collect() }
    }

    /// All weights rounded to their words; two-sided thresholds are kept from going below zero.
    #[must_use]
    pub fn rounded(&self, weights: &[f32]) -> Vec<f32> {
        let mut rounded = weights.to_vec();
        for (range, format) in &self.weights {
            rounded[range.clone()].iter_mut().for_each(|w| *w = format.round(*w));
        }
        rounded
    }

    /// The step of each weight.
    #[must_use]
    pub fn steps(&self, length: usize) -> Vec<f32> {
        let mut steps = vec![0.0; length];
        self.weights.iter().for_each(|(range, format)| steps[range.clone()].fill(format.step));
        steps
    }
}

/// The 192×128 map from F's outputs back to red, green and blue of the patch: undoes chroma gain and averaging weight, and puts
/// chroma between its sites as [`edof_spec::colour::rgb_from_422`] does (at the last column, its neighbour).
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

/// Buffers for batches of up to `capacity` windows, one window a row.
#[derive(Debug)]
pub struct Simulated {
    form: Form,
    places: Places,
    codes: Vec<Format>,
    to_rgb: Vec<f32>,
    b: Vec<Vec<f32>>,
    z: Vec<Vec<f32>>,
    change: Vec<Vec<f32>>,
    outputs: Vec<f32>,
    rgb: Vec<f32>,
    gradient_z: Vec<Vec<f32>>,
    gradient_b: Vec<f32>,
    gradient_b1: Vec<f32>,
    back: Vec<f32>,
}

impl Simulated {
    /// Buffers for a form whose codes have these formats; `to_rgb` is [`rgb_map`].
    #[must_use]
    pub fn new(form: Form, codes: &[Format], to_rgb: &[f32], capacity: usize) -> Self {
        let room = || vec![0.0; capacity * form.codes];
        let rooms = |count| (0..count).map(|_| room()).collect::<Vec<_>>();
        Self {
            form,
            places: Places::new(&form),
            codes: codes.to_vec(),
            to_rgb: to_rgb.to_vec(),
            b: rooms(form.shrinkages()),
            z: rooms(form.shrinkages()),
            change: rooms(form.middle_layers()),
            outputs: vec![0.0; capacity * OUTPUTS_422],
            rgb: vec![0.0; capacity * RGB_OUTPUTS],
            gradient_z: rooms(form.shrinkages()),
            gradient_b: room(),
            gradient_b1: room(),
            back: room(),
        }
    }

    /// Runs `windows` windows with weights that are rounded already; gives red, green and blue (windows × 192).
    pub fn forward(&mut self, weights: &[f32], inputs: &[f32], windows: usize) -> &[f32] {
        let (form, places) = (self.form, &self.places);
        let (codes, pixels) = (form.codes, form.window.pixels());
        let used = windows * codes;
        let y = Mat::new(inputs, windows, pixels);
        let a = Mat::new(&weights[places.analysis.clone()], codes, pixels);
        product(&mut self.b[0], Into::Replace, y, a.t());
        for t in 0..form.shrinkages() {
            let format = self.codes[t];
            self.b[t][..used].iter_mut().for_each(|b| *b = format.round(*b));
            shrink(
                form.shrinkage,
                format,
                &self.b[t][..used],
                &weights[places.thresholds[t].clone()],
                &mut self.z[t],
            );
            if t == form.middle_layers() {
                break;
            }
            let s = Mat::new(&weights[places.recurrent[form.recurrent_index(t)].clone()], codes, codes);
            let (before, after) = self.b.split_at_mut(t + 1);
            let next = &mut after[0][..used];
            let (base, sent) = match form.recurrence {
                Recurrence::Direct => (&before[0], &self.z[t]),
                Recurrence::Difference => {
                    let change = &mut self.change[t][..used];
                    change.copy_from_slice(&self.z[t][..used]);
                    if t > 0 {
                        change.iter_mut().zip(&self.z[t - 1]).for_each(|(c, z)| *c = format.round(*c - z));
                    }
                    (&before[t], &self.change[t])
                }
            };
            next.copy_from_slice(&base[..used]);
            product(next, Into::Add, Mat::new(sent, windows, codes), s.t());
        }
        let d = Mat::new(&weights[places.dictionary.clone()], OUTPUTS_422, codes);
        let last = Mat::new(&self.z[form.middle_layers()], windows, codes);
        product(&mut self.outputs, Into::Replace, last, d.t());
        if form.linear_path {
            let r = Mat::new(&weights[places.linear_path.clone()], OUTPUTS_422, pixels);
            product(&mut self.outputs, Into::Add, y, r.t());
        }
        let to_rgb = Mat::new(&self.to_rgb, RGB_OUTPUTS, OUTPUTS_422);
        product(&mut self.rgb, Into::Replace, Mat::new(&self.outputs, windows, OUTPUTS_422), to_rgb.t());
        &self.rgb[..windows * RGB_OUTPUTS]
    }

    /// [`Simulated::forward`], then adds the gradient of Σ_p ½·`importance[p]`·‖x̂_p − x_p‖² to `gradient`;
    /// `squared_errors[p]` becomes ‖x̂_p − x_p‖².
    pub fn gradient(
        &mut self,
        weights: &[f32],
        inputs: &[f32],
        targets: &[f32],
        importance: &[f32],
        squared_errors: &mut [f32],
        gradient: &mut [f32],
    ) {
        let windows = importance.len();
        self.forward(weights, inputs, windows);
        let rows = self.rgb.chunks_exact_mut(RGB_OUTPUTS).zip(targets.chunks_exact(RGB_OUTPUTS));
        for (((out, target), &importance), squared) in rows.zip(importance).zip(squared_errors) {
            out.iter_mut().zip(target).for_each(|(o, x)| *o -= x);
            *squared = out.iter().map(|e| e * e).sum();
            out.iter_mut().for_each(|e| *e *= importance);
        }
        let to_rgb = Mat::new(&self.to_rgb, RGB_OUTPUTS, OUTPUTS_422);
        product(&mut self.outputs, Into::Replace, Mat::new(&self.rgb, windows, RGB_OUTPUTS), to_rgb);
        let (form, places) = (self.form, &self.places);
        let (codes, pixels) = (form.codes, form.window.pixels());
        let used = windows * codes;
        let (y, errors) = (Mat::new(inputs, windows, pixels), Mat::new(&self.outputs, windows, OUTPUTS_422));
        let last = form.middle_layers();
        let z = Mat::new(&self.z[last], windows, codes);
        product(&mut gradient[places.dictionary.clone()], Into::Add, errors.t(), z);
        if form.linear_path {
            product(&mut gradient[places.linear_path.clone()], Into::Add, errors.t(), y);
        }
        self.gradient_z.iter_mut().for_each(|g| g[..used].fill(0.0));
        let d = Mat::new(&weights[places.dictionary.clone()], OUTPUTS_422, codes);
        product(&mut self.gradient_z[last], Into::Replace, errors, d);
        self.gradient_b[..used].fill(0.0);
        self.gradient_b1[..used].fill(0.0);
        for t in (0..form.shrinkages()).rev() {
            if form.recurrence == Recurrence::Direct {
                self.gradient_b[..used].fill(0.0);
            }
            let theta = &mut gradient[places.thresholds[t].clone()];
            unshrink(form.shrinkage, &self.z[t][..used], &self.gradient_z[t], &mut self.gradient_b, theta);
            let format = self.codes[t];
            let clipped =
                self.gradient_b.iter_mut().zip(&self.b[t][..used]).filter(|(_, b)| format.is_clipped(**b));
            clipped.for_each(|(g, _)| *g = 0.0);
            if form.recurrence == Recurrence::Direct || t == 0 {
                self.gradient_b1[..used].iter_mut().zip(&self.gradient_b).for_each(|(sum, g)| *sum += g);
            }
            if t == 0 {
                break;
            }
            let range = places.recurrent[form.recurrent_index(t - 1)].clone();
            let into_b = Mat::new(&self.gradient_b, windows, codes);
            let sent = match form.recurrence {
                Recurrence::Direct => &self.z[t - 1],
                Recurrence::Difference => &self.change[t - 1],
            };
            product(&mut gradient[range.clone()], Into::Add, into_b.t(), Mat::new(sent, windows, codes));
            product(&mut self.back, Into::Replace, into_b, Mat::new(&weights[range], codes, codes));
            let back = &self.back[..used];
            self.gradient_z[t - 1].iter_mut().zip(back).for_each(|(g, b)| *g += b);
            if form.recurrence == Recurrence::Difference && t >= 2 {
                self.gradient_z[t - 2].iter_mut().zip(back).for_each(|(g, b)| *g -= b);
            }
        }
        let b1 = Mat::new(&self.gradient_b1, windows, codes);
        product(&mut gradient[places.analysis.clone()], Into::Add, b1.t(), y);
    }
}

fn shrink(kind: Shrinkage, format: Format, b: &[f32], theta: &[f32], z: &mut [f32]) {
    for (b, z) in b.chunks_exact(theta.len()).zip(z.chunks_exact_mut(theta.len())) {
        for ((z, &b), &theta) in z.iter_mut().zip(b).zip(theta) {
            *z = match kind {
                Shrinkage::OneSided => format.round((b - theta).max(0.0)),
                Shrinkage::TwoSided => ((b.abs() - theta.max(0.0)).max(0.0)).copysign(b),
            };
        }
    }
}

/// Adjoint of [`shrink`]'s derivative: adds to `gradient_b` where z is not zero, and to θ's gradient.
fn unshrink(kind: Shrinkage, z: &[f32], gradient_z: &[f32], gradient_b: &mut [f32], theta: &mut [f32]) {
    let codes = theta.len();
    let rows =
        z.chunks_exact(codes).zip(gradient_z.chunks_exact(codes)).zip(gradient_b.chunks_exact_mut(codes));
    for ((z, gz), gb) in rows {
        for (((&z, &gz), gb), theta) in z.iter().zip(gz).zip(gb).zip(theta.iter_mut()) {
            if z != 0.0 {
                *gb += gz;
                *theta -= match kind {
                    Shrinkage::OneSided => gz,
                    Shrinkage::TwoSided => gz * z.signum(),
                };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_golden::sample::{self, Draw};
    use edof_golden::scalar;
    use edof_spec::{Stride, Window};
    use proptest::prelude::*;

    fn form(layers: usize, flags: [bool; 4]) -> Form {
        Form {
            window: Window::new(8).unwrap(),
            codes: 7,
            layers,
            shrinkage: if flags[0] { Shrinkage::OneSided } else { Shrinkage::TwoSided },
            recurrence: if flags[1] { Recurrence::Difference } else { Recurrence::Direct },
            linear_path: flags[2],
            tied: flags[3],
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
        flags: [bool; 4],
        seed: u64,
    ) -> Result<(), TestCaseError> {
        let form = form(layers, flags);
        let fixed = with_exact_sums(sample::extreme(form, 8, Stride::PATCH, false, seed));
        let places = Places::new(&form);
        let formats = Formats::of(&fixed, &places);
        let weights = Places::flatten(&Folded::of(&fixed));
        prop_assert_eq!(&formats.rounded(&weights), &weights);
        // Eight bits of input, so that I's sums are exact too: 64 products of 8 by 8 bits.
        let y: Vec<i16> =
            sample::extreme_window(&mut Draw::new(seed), 64).iter().map(|w| w & 0x7f80).collect();
        let inputs: Vec<f32> = y.iter().map(|w| f32::from(*w) / 32768.0).collect();
        let mut pass = Simulated::new(form, &formats.codes, &rgb_map(&[1.0; 128]), 1);
        pass.forward(&weights, &inputs, 1);
        let trace = scalar::run(&fixed, &y);
        for (t, codes) in trace.codes.iter().enumerate() {
            let unit = (-(fixed.code_fractions[t] as f32)).exp2();
            let words = |values: &[f32]| values.iter().map(|v| (v / unit) as i16).collect::<Vec<_>>();
            prop_assert_eq!(words(&pass.b[t]), codes.b.clone(), "b of layer {}", t);
            prop_assert_eq!(words(&pass.z[t]), codes.z.clone(), "z of layer {}", t);
        }
        Ok(())
    }

    #[test]
    fn the_simulation_is_exact_where_as_drawn_the_base_would_pass_24_bits() {
        simulation_computes_the_words(9, [true, false, false, false], 1_954_824_249_627_160_057).unwrap();
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_simulation_computes_the_words_of_the_board(layers in 2usize..=10, flags: [bool; 4], seed: u64) {
            simulation_computes_the_words(layers, flags, seed)?;
        }

        #[test]
        fn without_rounding_the_gradient_equals_finite_differences(
            layers in 2usize..=6, flags: [bool; 4], seed: u64
        ) {
            let form = form(layers, flags);
            let places = Places::new(&form);
            let mut draw = Draw::new(seed);
            let mut noise = |length: usize, scale: f32| -> Vec<f32> {
                (0..length).map(|_| draw.whole(-1000, 1000) as f32 * 1e-3 * scale).collect()
            };
            let mut weights = noise(places.linear_path.end, 0.3);
            for theta in &places.thresholds {
                // Far enough from 0 that no step makes a two-sided threshold negative.
                weights[theta.clone()].iter_mut().for_each(|t| *t = 0.02 + t.abs() * 0.2);
            }
            let (y, x) = (noise(3 * 64, 1.0), noise(3 * 192, 1.0));
            let importance = [1.0, 0.5, 2.0];
            let exact = Format { step: 0.0, most: 1.0 };
            let to_rgb = rgb_map(&[1.0; 128]);
            let mut pass = Simulated::new(form, &vec![exact; form.shrinkages()], &to_rgb, 3);
            let (mut errors, mut gradient) = ([0.0; 3], vec![0.0; weights.len()]);
            pass.gradient(&weights, &y, &x, &importance, &mut errors, &mut gradient);
            let mut loss = |weights: &[f32]| {
                let (mut errors, mut unused) = ([0.0; 3], vec![0.0; weights.len()]);
                pass.gradient(weights, &y, &x, &importance, &mut errors, &mut unused);
                let open: Vec<i8> = pass.z.iter().flatten().map(|z| i8::from(*z > 0.0) - i8::from(*z < 0.0)).collect();
                (errors.iter().zip(importance).map(|(e, i)| 0.5 * f64::from(e * i)).sum::<f64>(), open)
            };
            let groups = [&places.analysis, &places.dictionary, &places.linear_path];
            for range in groups.into_iter().chain(&places.thresholds).chain(&places.recurrent).filter(|r| !r.is_empty()) {
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
        let overlap = edof_spec::overlap::Overlap::Hann;
        let map = super::super::fold::output_map(stride, overlap);
        let weights = super::super::fold::output_weights(stride, overlap);
        let colour: Vec<f64> = (0..192).map(|i| [0.2, 0.5, 0.7][i / 64]).collect();
        let outputs = map.dot(&ndarray::aview1(&colour));
        let back = rgb_map(&weights);
        for (row, colour) in back.chunks_exact(128).zip(&colour) {
            let value: f64 = row.iter().zip(&outputs).map(|(m, o)| f64::from(*m) * o).sum();
            assert!((value - colour).abs() < 1e-5);
        }
    }
}
