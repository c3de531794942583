//! Ranges of all codes, measured by the float network on real raw frames.

use crate::QuantizeError;
use edof_float::matmul::{Destination, Mat, product};
use edof_float::parameters::flatten;
use edof_float::pass::Pass;
use edof_golden::windows::Mirrored;
use edof_image::geometry::GeometryError;
use edof_image::number::INPUT_FRACTION;
use edof_image::{Geometry, RawFrame, Stride};
use edof_network::Network;
use edof_network::network::{Form, Recurrence};
use ndarray::Array2;
use rayon::prelude::*;
use std::ops::ControlFlow;

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
    /// [`GeometryError`] for a frame too small for the network's window.
    pub fn measure<'a>(
        network: &Network,
        frames: impl IntoIterator<Item = &'a RawFrame>,
    ) -> Result<Self, GeometryError> {
        Self::measure_while(network, frames, || ControlFlow::Continue(()))
    }

    /// [`Calibration::measure`], cut short where `flow` breaks; it is asked every few hundred windows.
    ///
    /// # Errors
    /// As [`Calibration::measure`].
    pub fn measure_while<'a>(
        network: &Network,
        frames: impl IntoIterator<Item = &'a RawFrame>,
        flow: impl Fn() -> ControlFlow<()> + Sync,
    ) -> Result<Self, GeometryError> {
        let weights = flatten(network);
        let geometry = Geometry::new(network.form.window, Stride::FINEST);
        let frames: Vec<&RawFrame> = frames.into_iter().collect();
        // In order, a few at a time: the same frames give the same sums.
        let mut all = Self::new(&network.form);
        for some in frames.chunks(FRAMES_AT_ONCE) {
            let seen: Result<Vec<Self>, GeometryError> =
                some.par_iter().map(|raw| Self::of_frame(network, &weights, geometry, raw, &flow)).collect();
            all = seen?.iter().fold(all, Self::merged);
        }
        Ok(all)
    }

    fn of_frame(
        network: &Network,
        weights: &[f32],
        geometry: Geometry,
        raw: &RawFrame,
        flow: &(impl Fn() -> ControlFlow<()> + Sync),
    ) -> Result<Self, GeometryError> {
        geometry.check_frame(raw.size())?;
        let (raw, _) = raw.to_rggb();
        let (height, width) = raw.size();
        let mirrored = Mirrored::new(&raw, geometry);
        let (rows, columns) = geometry.patches(height, width);
        let patches: Vec<_> = (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))).collect();
        let mut seen = Self::new(&network.form);
        let mut pass = Pass::new(network.form, BATCH);
        let pixels = network.form.window.pixels();
        let mut words = vec![0; pixels];
        for (index, some) in patches.chunks(BATCH).enumerate().take_while(|_| flow().is_continue()) {
            let mut inputs = Vec::with_capacity(some.len() * pixels);
            for &(row, column) in some {
                mirrored.copy_window(row, column, &mut words);
                inputs.extend(words.iter().map(|w| f32::from(*w) / (1 << INPUT_FRACTION) as f32));
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
