//! Ranges of all codes, measured by the float network on real raw frames.

use crate::QuantizeError;
use edof_core::geometry::GeometryError;
use edof_core::number::{InputWord, input_value};
use edof_core::{Geometry, RawFrame, Stride};
use edof_golden::windows::Mirrored;
use edof_network::Network;
use edof_network::float::matmul::{Destination, Mat, product};
use edof_network::float::parameters::flatten;
use edof_network::float::pass::Pass;
use edof_network::network::{Form, Recurrence};
use ndarray::Array2;
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Windows that go through the float network at once.
const BATCH: usize = 256;
/// One batch in N is asked how its inputs go together.
const MOMENTS_EVERY: usize = 64;
/// Frames that are measured side by side.
const FRAMES_AT_ONCE: usize = 16;

/// The largest values that calibration saw, one a coefficient and layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Windows seen.
    pub windows: u64,
    /// max(|b_t|, |z_t|), t = 1…T−1, each of length codes.
    pub codes: Vec<Vec<f32>>,
    /// max |z_t − z_{t−1}| of what the difference form sends; zeros in the direct form.
    pub changes: Vec<Vec<f32>>,
    /// Σ v vᵀ over a share of the windows, v what each M layer multiplies; codes × codes.
    pub sent: Vec<Array2<f64>>,
    /// Σ v vᵀ with v = (z_{T−1}, y), the input of F.
    pub outputs: Array2<f64>,
}

impl Calibration {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(form: &Form) -> Self {
        let zeros = vec![vec![0.0; form.codes]; form.shrinkages()];
        let n = form.codes + form.window.pixels();
        let moments = Array2::zeros((form.codes, form.codes));
        Self {
            windows: 0,
            codes: zeros.clone(),
            changes: zeros,
            sent: vec![moments; form.middle_layers()],
            outputs: Array2::zeros((n, n)),
        }
    }

    /// Measures a network on all windows of raw frames of any CFA phase at the finest stride. Those of larger strides are among
    /// them, so nothing seen here saturates at any stride.
    ///
    /// # Errors
    /// [`QuantizeError`] for a network of several exposures, or a frame too small for the network's window.
    pub fn measure<'a>(
        network: &Network,
        frames: impl IntoIterator<Item = &'a RawFrame>,
    ) -> Result<Self, QuantizeError> {
        Self::measure_while(network, frames, |_| ControlFlow::Continue(()))
    }

    /// [`Calibration::measure`], cut short where `flow` breaks; it is told the number of frames done every few hundred windows.
    ///
    /// # Errors
    /// As [`Calibration::measure`].
    pub fn measure_while<'a>(
        network: &Network,
        frames: impl IntoIterator<Item = &'a RawFrame>,
        flow: impl Fn(usize) -> ControlFlow<()> + Sync,
    ) -> Result<Self, QuantizeError> {
        network.form.check_single()?;
        let done = AtomicUsize::new(0);
        let flow = || flow(done.load(Ordering::Relaxed));
        let weights = flatten(network);
        let geometry = Geometry::new(network.form.window, Stride::FINEST);
        let frames: Vec<&RawFrame> = frames.into_iter().collect();
        // In order, a few at a time: the same frames give the same sums.
        let mut all = Self::new(&network.form);
        for some in frames.chunks(FRAMES_AT_ONCE) {
            let measured = |raw: &&RawFrame| {
                let seen = Self::of_frame(network, &weights, geometry, raw, &flow);
                done.fetch_add(1, Ordering::Relaxed);
                seen
            };
            let seen: Result<Vec<Self>, GeometryError> = some.par_iter().map(measured).collect();
            all = seen?.iter().fold(all, Self::merged);
        }
        Ok(all)
    }

    /// Returns about how long [`Calibration::measure`] takes for N frames of a size (height, width) on all threads, by the time of one batch of
    /// windows.
    ///
    /// # Errors
    /// As [`Calibration::measure`].
    pub fn expected_time(
        network: &Network,
        frames: usize,
        (height, width): (usize, usize),
    ) -> Result<Duration, QuantizeError> {
        network.form.check_single()?;
        let geometry = Geometry::new(network.form.window, Stride::FINEST);
        geometry.check_frame((height, width))?;
        let (rows, columns) = geometry.patches(height, width);
        let (weights, mut seen) = (flatten(network), Self::new(&network.form));
        let mut pass = Pass::new(network.form, BATCH);
        let inputs = vec![0.5; BATCH * network.form.window.pixels()];
        let mut timed = || {
            let begun = Instant::now();
            seen.observe(&mut pass, &weights, &inputs, network.form);
            begun.elapsed()
        };
        // The first time meets cold memory.
        let one = timed().min(timed());
        let batches = frames * (rows * columns).div_ceil(BATCH);
        Ok(one.mul_f64(batches as f64 / rayon::current_num_threads().min(frames.max(1)) as f64))
    }

    fn of_frame(
        network: &Network,
        weights: &[f32],
        geometry: Geometry,
        raw: &RawFrame,
        flow: &(impl Fn() -> ControlFlow<()> + Sync),
    ) -> Result<Self, GeometryError> {
        geometry.check_frame(raw.size())?;
        let raw = raw.encoded(network.origin.values);
        let (raw, _) = raw.to_rggb();
        let (height, width) = raw.size();
        let mirrored = Mirrored::new(&raw, geometry);
        let (rows, columns) = geometry.patches(height, width);
        let patches: Vec<_> = (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))).collect();
        let mut seen = Self::new(&network.form);
        let mut pass = Pass::new(network.form, BATCH);
        let pixels = network.form.window.pixels();
        let mut words = vec![InputWord::ZERO; pixels];
        for (index, some) in patches.chunks(BATCH).enumerate().take_while(|_| flow().is_continue()) {
            let mut inputs = Vec::with_capacity(some.len() * pixels);
            for &(row, column) in some {
                mirrored.copy_window(row, column, &mut words);
                inputs.extend(words.iter().map(|word| input_value(*word)));
            }
            seen.observe(&mut pass, weights, &inputs, network.form);
            if index % MOMENTS_EVERY == 0 {
                seen.observe_moments(&pass, &inputs, network.form);
            }
        }
        Ok(seen)
    }

    /// Takes in how the inputs of the batch that `pass` has just run go together.
    pub(crate) fn observe_moments(&mut self, pass: &Pass, inputs: &[f32], form: Form) {
        let (codes, pixels) = (form.codes, form.window.pixels());
        let windows = inputs.len() / pixels;
        let mut sums = vec![0.0; (codes + pixels).pow(2)];
        let mut add = |moments: &mut Array2<f64>, vectors: &[f32], n: usize| {
            let v = Mat::new(vectors, windows, n);
            product(&mut sums, Destination::Replace, v.t(), v);
            moments.iter_mut().zip(&sums).for_each(|(m, s)| *m += f64::from(*s));
        };
        for (t, moments) in self.sent.iter_mut().enumerate() {
            let mut sent = pass.z(t)[..windows * codes].to_vec();
            if form.recurrence == Recurrence::Difference && t > 0 {
                sent.iter_mut().zip(pass.z(t - 1)).for_each(|(z, before)| *z -= before);
            }
            add(moments, &sent, codes);
        }
        let last = pass.z(form.middle_layers()).chunks_exact(codes).zip(inputs.chunks_exact(pixels));
        let both: Vec<f32> = last.flat_map(|(z, y)| z.iter().chain(y).copied()).collect();
        add(&mut self.outputs, &both, codes + pixels);
    }

    /// Takes in a batch of windows (0…1, one after the other).
    pub fn observe(&mut self, pass: &mut Pass, weights: &[f32], inputs: &[f32], form: Form) {
        let windows = inputs.len() / form.window.pixels();
        pass.forward(weights, inputs, windows);
        self.windows += windows as u64;
        for t in 0..form.shrinkages() {
            let of = |values: &[f32], max: &mut [f32]| {
                for row in values[..windows * form.codes].chunks_exact(form.codes) {
                    max.iter_mut().zip(row).for_each(|(m, v)| *m = m.max(v.abs()));
                }
            };
            of(pass.b(t), &mut self.codes[t]);
            of(pass.z(t), &mut self.codes[t]);
            if form.recurrence == Recurrence::Difference && t > 0 {
                let (z, before) = (pass.z(t), pass.z(t - 1));
                for (row, before) in
                    z.chunks_exact(form.codes).zip(before.chunks_exact(form.codes)).take(windows)
                {
                    for ((m, z), b) in self.changes[t].iter_mut().zip(row).zip(before) {
                        *m = m.max((z - b).abs());
                    }
                }
            }
        }
    }

    /// What either saw.
    #[must_use]
    pub fn merged(mut self, other: &Self) -> Self {
        self.windows += other.windows;
        let larger = |a: &mut [Vec<f32>], b: &[Vec<f32>]| {
            a.iter_mut().flatten().zip(b.iter().flatten()).for_each(|(a, b)| *a = a.max(*b));
        };
        larger(&mut self.codes, &other.codes);
        larger(&mut self.changes, &other.changes);
        self.sent.iter_mut().zip(&other.sent).for_each(|(sum, more)| *sum += more);
        self.outputs += &other.outputs;
        self
    }

    /// # Errors
    /// [`QuantizeError::Calibration`] if nothing was seen, or a network of another form.
    pub(crate) fn check(&self, form: &Form) -> Result<(), QuantizeError> {
        if self.windows == 0 {
            return Err(QuantizeError::Calibration("no windows seen, expected at least one raw frame"));
        }
        let fits = |layers: &[Vec<f32>]| {
            layers.len() == form.shrinkages() && layers.iter().all(|l| l.len() == form.codes)
        };
        let n = form.codes + form.window.pixels();
        let moments_fit = self.outputs.dim() == (n, n) && self.sent.len() == form.middle_layers();
        if !(fits(&self.codes) && fits(&self.changes) && moments_fit) {
            return Err(QuantizeError::Calibration("measured on a network of another form"));
        }
        let mut moments = self.sent.iter().chain([&self.outputs]).flatten();
        if !moments.all(|m| m.is_finite()) {
            return Err(QuantizeError::Calibration("the network's codes are too large to be squared"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::draw::Draw;
    use edof_core::{CfaPhase, Window};
    use edof_network::network::Shrinkage;

    const CODES: usize = 3;

    fn form(layers: usize, recurrence: Recurrence) -> Form {
        Form {
            window: Window::new(8).unwrap(),
            codes: CODES,
            layers,
            shrinkage: Shrinkage::OneSided,
            recurrence,
            linear_path: false,
            tied: false,
            exposures: 1,
        }
    }

    fn noise(seed: u64, length: usize) -> Vec<f32> {
        let mut draw = Draw::new(seed);
        (0..length).map(|_| draw.whole(-1000, 1000) as f32 * 1e-3).collect()
    }

    fn network(layers: usize) -> Network {
        let form = form(layers, Recurrence::Direct);
        let origin = edof_device::random::natural(8, 8, 1).origin;
        let length = edof_network::float::parameters::Layout::new(&form).len();
        edof_network::float::parameters::unflatten(form, &noise(5, length), origin)
    }

    fn raw(height: usize, width: usize) -> RawFrame {
        let mut draw = Draw::new(9);
        let values = Array2::from_shape_fn((height, width), |_| draw.whole(0, 4095) as u16);
        RawFrame::from_values(values, 12, CfaPhase::Rggb).unwrap()
    }

    /// Two batches, of eight windows and of five: what is left of the first must not count in the second.
    fn two_batches(recurrence: Recurrence) -> (Form, Vec<f32>, [Vec<f32>; 2]) {
        let form = form(4, recurrence);
        let weights = noise(1, edof_network::float::parameters::Layout::new(&form).len());
        let large = noise(2, 8 * 64).iter().map(|v| 3.0 * v).collect();
        (form, weights, [large, noise(3, 5 * 64)])
    }

    /// All b_t and all z_t of one window.
    type Codes = [Vec<Vec<f32>>; 2];

    /// Those of single windows.
    fn codes(form: Form, weights: &[f32], inputs: &[f32]) -> Vec<Codes> {
        let mut pass = Pass::new(form, 1);
        let each = inputs.chunks_exact(64).map(|y| {
            pass.forward(weights, y, 1);
            let all = |of: fn(&Pass, usize) -> &[f32]| {
                (0..form.shrinkages()).map(|t| of(&pass, t).to_vec()).collect()
            };
            [all(|pass, t| pass.b(t)), all(|pass, t| pass.z(t))]
        });
        each.collect()
    }

    fn assert_near(found: f64, expected: f64, what: &str) {
        assert!((found - expected).abs() <= 1e-4 * expected.abs().max(1e-2), "{what}: {found} {expected}");
    }

    #[test]
    fn the_largest_codes_and_changes_of_all_windows_are_kept() {
        for recurrence in [Recurrence::Direct, Recurrence::Difference] {
            let (form, weights, batches) = two_batches(recurrence);
            for order in [[0, 1], [1, 0]] {
                let (mut seen, mut pass) = (Calibration::new(&form), Pass::new(form, 8));
                // The pass still holds large codes of eight windows that this calibration has not seen.
                pass.forward(&weights, &batches[0], 8);
                let mut windows = vec![];
                for (i, batch) in order.into_iter().enumerate() {
                    seen.observe(&mut pass, &weights, &batches[batch], form);
                    windows.extend(codes(form, &weights, &batches[batch]));
                    assert_eq!(seen.windows, if i == 1 { 13 } else { [8, 5][batch] });
                    for (t, c) in (0..3).flat_map(|t| (0..CODES).map(move |c| (t, c))) {
                        let most = |of: &dyn Fn(&Codes) -> f32| {
                            f64::from(windows.iter().map(of).fold(0.0, f32::max))
                        };
                        let code = most(&|[b, z]| b[t][c].abs().max(z[t][c].abs()));
                        assert_near(seen.codes[t][c].into(), code, "codes");
                        let change = match recurrence {
                            Recurrence::Difference if t > 0 => most(&|[_, z]| (z[t][c] - z[t - 1][c]).abs()),
                            _ => 0.0,
                        };
                        assert_near(seen.changes[t][c].into(), change, "changes");
                    }
                }
            }
        }
    }

    #[test]
    fn moments_are_sums_of_products_of_what_each_layer_multiplies() {
        for recurrence in [Recurrence::Direct, Recurrence::Difference] {
            let (form, weights, batches) = two_batches(recurrence);
            let (mut seen, mut pass) = (Calibration::new(&form), Pass::new(form, 8));
            let mut vectors: Vec<[Vec<f32>; 3]> = vec![];
            for batch in &batches {
                seen.observe(&mut pass, &weights, batch, form);
                seen.observe_moments(&pass, batch, form);
                for ([_, z], y) in codes(form, &weights, batch).iter().zip(batch.chunks_exact(64)) {
                    let change = z[1].iter().zip(&z[0]).map(|(z, before)| z - before).collect();
                    let second = if recurrence == Recurrence::Difference { change } else { z[1].clone() };
                    vectors.push([z[0].clone(), second, [&z[2], y].concat()]);
                }
            }
            for (which, moments) in seen.sent.iter().chain([&seen.outputs]).enumerate() {
                for ((i, j), sum) in moments.indexed_iter() {
                    let products = vectors.iter().map(|v| f64::from(v[which][i]) * f64::from(v[which][j]));
                    assert!((sum - products.sum::<f64>()).abs() < 1e-2, "{which} {i} {j}");
                }
            }
        }
    }

    #[test]
    fn a_frame_is_all_windows_at_the_finest_stride_and_moments_are_those_of_its_first_batch() {
        let (network, raw) = (network(3), raw(48, 64));
        let geometry = Geometry::new(network.form.window, Stride::FINEST);
        let (rows, columns) = geometry.patches(48, 64);
        let inputs: Vec<f32> = (0..rows * columns)
            .flat_map(|i| edof_golden::windows::window(&raw, geometry, i / columns, i % columns))
            .map(|word| f32::from(word.to_bits()) / 32768.0)
            .collect();
        assert!(rows * columns > 2 * BATCH);
        let seen = Calibration::measure(&network, [&raw]).unwrap();
        assert_eq!(seen.windows, (rows * columns) as u64);
        for (i, j) in [(0, 0), (3, 3), (0, 63), (17, 40)] {
            let sum: f64 = inputs.chunks_exact(64).take(BATCH).map(|y| f64::from(y[i] * y[j])).sum();
            assert_near(seen.outputs[(CODES + i, CODES + j)], sum, "outputs");
        }
        let windows = codes(network.form, &flatten(&network), &inputs);
        for (t, c) in (0..2).flat_map(|t| (0..CODES).map(move |c| (t, c))) {
            let most = windows.iter().map(|[b, z]| b[t][c].abs().max(z[t][c].abs())).fold(0.0, f32::max);
            assert_near(seen.codes[t][c].into(), most.into(), "codes");
        }
        let twice = Calibration::measure(&network, [&raw, &raw]).unwrap();
        assert_eq!(twice, seen.clone().merged(&seen));
        let [one, many] = [1, 5000]
            .map(|frames| Calibration::expected_time(&network, frames, raw.size()).unwrap().as_secs_f64());
        assert!(0.0 < one && 50.0 * one < many, "{one} {many}");
        let none = Calibration::measure_while(&network, [&raw], |_| ControlFlow::Break(())).unwrap();
        assert_eq!(none, Calibration::new(&network.form));
    }

    #[test]
    fn two_calibrations_merge_to_the_larger_codes_and_the_sums_of_all_else() {
        let form = form(3, Recurrence::Direct);
        let of = |windows: u64, code: f32, change: f32, moment: f64| {
            let mut seen = Calibration::new(&form);
            seen.windows = windows;
            seen.codes[1] = vec![code, 1.0, -code];
            seen.changes[1] = vec![change; CODES];
            seen.sent[0].fill(moment);
            seen.outputs.fill(2.0 * moment);
            seen
        };
        let both = of(3, 5.0, 0.5, 1.5).merged(&of(4, 2.0, 0.75, 2.5));
        assert_eq!(both.windows, 7);
        assert_eq!(both.codes, [vec![0.0; CODES], vec![5.0, 1.0, -2.0]]);
        assert_eq!(both.changes, [vec![0.0; CODES], vec![0.75; CODES]]);
        assert!(both.sent[0].iter().all(|m| *m == 4.0) && both.outputs.iter().all(|m| *m == 8.0));
    }

    #[test]
    fn a_calibration_is_refused_for_each_thing_that_does_not_fit() {
        let form = form(3, Recurrence::Direct);
        let after = |change: fn(&mut Calibration)| {
            let mut seen = Calibration::new(&form);
            seen.windows = 1;
            change(&mut seen);
            seen.check(&form).map_err(|error| error.to_string())
        };
        assert_eq!(after(|_| ()), Ok(()));
        let refused = |change, part: &str| assert!(after(change).unwrap_err().contains(part), "{part}");
        refused(|seen| seen.windows = 0, "no windows seen");
        refused(|seen| seen.codes.truncate(1), "another form");
        refused(|seen| seen.codes[1].push(0.0), "another form");
        refused(|seen| seen.changes.truncate(1), "another form");
        refused(|seen| seen.changes[0].truncate(2), "another form");
        refused(|seen| seen.sent.truncate(0), "another form");
        refused(|seen| seen.outputs = Array2::zeros((67, 66)), "another form");
        refused(|seen| seen.sent[0][(1, 2)] = f64::INFINITY, "too large to be squared");
        refused(|seen| seen.outputs[(66, 0)] = f64::NAN, "too large to be squared");
    }
}
