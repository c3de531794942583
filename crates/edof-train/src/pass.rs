//! A batch through the network and back: forward, and the hand-written gradient (network.md, "Function").

use crate::format::Format;
use crate::matmul::{Into, Mat, product};
use crate::parameters::Layout;
use edof_spec::colour::RGB_OUTPUTS;
use edof_spec::network::{Form, Recurrence, Shrinkage};

/// What a batch's loss is made of.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Loss {
    /// Weighted sum of squared errors over 192 outputs, halved.
    pub squared: f64,
    /// λ times the sum of |z|, each weighted by the norm of the next layer's column.
    pub sparsity: f64,
}

/// Buffers for batches of up to `capacity` windows: every b_t, z_t and the outputs. Row-major, one window a row.
#[derive(Debug)]
pub struct Pass {
    form: Form,
    layout: Layout,
    /// What b_t and z_t are rounded to, t = 1…T−1.
    formats: Vec<Format>,
    /// b_t, t = 1…T−1.
    b: Vec<Vec<f32>>,
    /// z_t, t = 1…T−1.
    z: Vec<Vec<f32>>,
    /// Difference form: z_t − z_{t−1} for each M layer.
    change: Vec<Vec<f32>>,
    outputs: Vec<f32>,
    gradient_z: Vec<Vec<f32>>,
    gradient_b: Vec<f32>,
    gradient_b1: Vec<f32>,
}

impl Pass {
    /// Buffers for `capacity` windows through a network that gives RGB.
    #[must_use]
    pub fn new(form: Form, capacity: usize) -> Self {
        Self::with(form, Layout::new(&form), vec![Format::EXACT; form.shrinkages()], capacity)
    }

    /// Buffers for `capacity` windows through a network with so many outputs whose codes are rounded to these formats. The
    /// gradient looks through the rounding, except where a code is at the end of its range.
    #[must_use]
    pub fn rounding(form: Form, outputs: usize, formats: &[Format], capacity: usize) -> Self {
        Self::with(form, Layout::giving(&form, outputs), formats.to_vec(), capacity)
    }

    fn with(form: Form, layout: Layout, formats: Vec<Format>, capacity: usize) -> Self {
        let codes = || vec![0.0; capacity * form.codes];
        Self {
            form,
            formats,
            b: (0..form.shrinkages()).map(|_| codes()).collect(),
            z: (0..form.shrinkages()).map(|_| codes()).collect(),
            change: (0..form.middle_layers()).map(|_| codes()).collect(),
            outputs: vec![0.0; capacity * layout.outputs],
            layout,
            gradient_z: (0..form.shrinkages()).map(|_| codes()).collect(),
            gradient_b: codes(),
            gradient_b1: codes(),
        }
    }

    /// b_t (0 first), `windows` × codes, as the last [`Pass::forward`] left it.
    #[must_use]
    pub fn b(&self, t: usize) -> &[f32] {
        &self.b[t]
    }

    /// z_t (0 first), `windows` × codes.
    #[must_use]
    pub fn z(&self, t: usize) -> &[f32] {
        &self.z[t]
    }

    /// The outputs; before [`Pass::backward`], the loss's gradient for them.
    pub fn outputs_mut(&mut self) -> &mut [f32] {
        &mut self.outputs
    }

    /// Runs `windows` windows of `inputs` (windows × pixels, row-major) and returns the outputs (windows × outputs).
    pub fn forward(&mut self, weights: &[f32], inputs: &[f32], windows: usize) -> &[f32] {
        let (form, layout) = (self.form, &self.layout);
        let (codes, pixels) = (form.codes, form.window.pixels());
        let y = Mat::new(inputs, windows, pixels);
        let used = windows * codes;
        product(
            &mut self.b[0],
            Into::Replace,
            y,
            Mat::new(&weights[layout.analysis.clone()], codes, pixels).t(),
        );
        for t in 0..form.shrinkages() {
            let theta = &weights[layout.thresholds[t].clone()];
            let format = self.formats[t];
            format.round_all(&mut self.b[t][..used]);
            shrink(form.shrinkage, &self.b[t][..used], theta, &mut self.z[t]);
            format.round_all(&mut self.z[t][..used]);
            if t == form.middle_layers() {
                break;
            }
            let s = Mat::new(&weights[layout.recurrent[form.recurrent_index(t)].clone()], codes, codes);
            let (before, after) = self.b.split_at_mut(t + 1);
            let next = &mut after[0][..used];
            match form.recurrence {
                Recurrence::Direct => {
                    next.copy_from_slice(&before[0][..used]);
                    product(next, Into::Add, Mat::new(&self.z[t], windows, codes), s.t());
                }
                Recurrence::Difference => {
                    next.copy_from_slice(&before[t][..used]);
                    subtract_previous(&self.z, t, &mut self.change[t][..used]);
                    format.round_all(&mut self.change[t][..used]);
                    product(next, Into::Add, Mat::new(&self.change[t], windows, codes), s.t());
                }
            }
        }
        let outputs = layout.outputs;
        let d = Mat::new(&weights[layout.dictionary.clone()], outputs, codes);
        let last = Mat::new(&self.z[form.middle_layers()], windows, codes);
        product(&mut self.outputs, Into::Replace, last, d.t());
        if form.linear_path {
            let r = Mat::new(&weights[layout.linear_path.clone()], outputs, pixels);
            product(&mut self.outputs, Into::Add, y, r.t());
        }
        &self.outputs[..windows * outputs]
    }

    /// [`Pass::forward`], then adds the loss's gradient to `gradient`.
    ///
    /// The loss is Σ_p ½·`importance[p]`·‖x̂_p − x_p‖² + `lambda`·Σ_p Σ_t Σ_i |z_t,i|·‖column i of the next layer‖; `targets` is
    /// windows × 192. `squared_errors[p]` becomes ‖x̂_p − x_p‖².
    #[expect(clippy::too_many_arguments, reason = "slices of one batch, each named at the call")]
    pub fn gradient(
        &mut self,
        weights: &[f32],
        inputs: &[f32],
        targets: &[f32],
        importance: &[f32],
        lambda: f32,
        squared_errors: &mut [f32],
        gradient: &mut [f32],
    ) -> Loss {
        let windows = importance.len();
        self.forward(weights, inputs, windows);
        let squared = weighted_errors(&mut self.outputs, targets, importance, squared_errors);
        Loss { squared, sparsity: self.backward(weights, inputs, windows, lambda, gradient) }
    }

    /// Adds to `gradient` what [`Pass::outputs_mut`], now the loss's gradient for the outputs of the last [`Pass::forward`],
    /// and λ give; returns λ's part of the loss.
    pub fn backward(
        &mut self,
        weights: &[f32],
        inputs: &[f32],
        windows: usize,
        lambda: f32,
        gradient: &mut [f32],
    ) -> f64 {
        let form = self.form;
        let (codes, pixels) = (form.codes, form.window.pixels());
        let used = windows * codes;
        let y = Mat::new(inputs, windows, pixels);
        let outputs = self.layout.outputs;
        let errors = Mat::new(&self.outputs, windows, outputs);
        let last = form.middle_layers();
        let layout = &self.layout;
        let dictionary = &weights[layout.dictionary.clone()];
        product(
            &mut gradient[layout.dictionary.clone()],
            Into::Add,
            errors.t(),
            Mat::new(&self.z[last], windows, codes),
        );
        if form.linear_path {
            product(&mut gradient[layout.linear_path.clone()], Into::Add, errors.t(), y);
        }
        self.gradient_z.iter_mut().for_each(|g| g[..used].fill(0.0));
        product(&mut self.gradient_z[last], Into::Replace, errors, Mat::new(dictionary, outputs, codes));
        let mut loss = sparsity(
            lambda,
            codes,
            &self.z[last][..used],
            dictionary,
            &mut self.gradient_z[last],
            &mut gradient[layout.dictionary.clone()],
        );
        self.gradient_b1[..used].fill(0.0);
        for t in (0..form.shrinkages()).rev() {
            let theta = &mut gradient[layout.thresholds[t].clone()];
            let carried = form.recurrence == Recurrence::Difference && t < last;
            if !carried {
                self.gradient_b[..used].fill(0.0);
            }
            unshrink(form.shrinkage, &self.z[t][..used], &self.gradient_z[t], &mut self.gradient_b, theta);
            self.formats[t].stop_clipped(&mut self.gradient_b[..used], &self.b[t][..used]);
            if form.recurrence == Recurrence::Direct || t == 0 {
                add(&mut self.gradient_b1[..used], &self.gradient_b);
            }
            if t == 0 {
                break;
            }
            let range = layout.recurrent[form.recurrent_index(t - 1)].clone();
            let s = Mat::new(&weights[range.clone()], codes, codes);
            let into_b = Mat::new(&self.gradient_b, windows, codes);
            let source = match form.recurrence {
                Recurrence::Direct => &self.z[t - 1],
                Recurrence::Difference => &self.change[t - 1],
            };
            product(&mut gradient[range.clone()], Into::Add, into_b.t(), Mat::new(source, windows, codes));
            let (earlier, later) = self.gradient_z.split_at_mut(t);
            let g = &mut earlier[t - 1];
            if form.recurrence == Recurrence::Difference && t >= 2 {
                // later[0] is free from here on: it carries S's part to both codes whose difference S multiplied.
                product(&mut later[0], Into::Replace, into_b, s);
                add(&mut g[..used], &later[0]);
                subtract(&mut earlier[t - 2][..used], &later[0]);
            } else {
                product(g, Into::Add, into_b, s);
            }
            loss += sparsity(
                lambda,
                codes,
                &self.z[t - 1][..used],
                &weights[range.clone()],
                &mut self.gradient_z[t - 1],
                &mut gradient[range],
            );
        }
        product(
            &mut gradient[layout.analysis.clone()],
            Into::Add,
            Mat::new(&self.gradient_b1, windows, codes).t(),
            y,
        );
        loss
    }
}

/// Outputs become errors times their window's importance; returns half the weighted sum of their squares. `squared_errors[p]`
/// becomes ‖x̂_p − x_p‖².
pub fn weighted_errors(
    outputs: &mut [f32],
    targets: &[f32],
    importance: &[f32],
    squared_errors: &mut [f32],
) -> f64 {
    let rows = outputs.chunks_exact_mut(RGB_OUTPUTS).zip(targets.chunks_exact(RGB_OUTPUTS));
    let mut loss = 0.0;
    for (((out, target), &weight), squared) in rows.zip(importance).zip(squared_errors) {
        let mut sum = 0.0;
        for (o, &x) in out.iter_mut().zip(target) {
            let error = *o - x;
            sum += error * error;
            *o = error * weight;
        }
        *squared = sum;
        loss += 0.5 * f64::from(weight * sum);
    }
    loss
}

/// z = σ_θ(b).
fn shrink(kind: Shrinkage, b: &[f32], theta: &[f32], z: &mut [f32]) {
    for (b, z) in b.chunks_exact(theta.len()).zip(z.chunks_exact_mut(theta.len())) {
        match kind {
            Shrinkage::OneSided => {
                for ((z, &b), &t) in z.iter_mut().zip(b).zip(theta) {
                    *z = (b - t).max(0.0);
                }
            }
            Shrinkage::TwoSided => {
                for ((z, &b), &t) in z.iter_mut().zip(b).zip(theta) {
                    *z = (b - t).max(0.0) + (b + t).min(0.0);
                }
            }
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
            let passed = if z == 0.0 { 0.0 } else { gz };
            *gb += passed;
            *theta -= match kind {
                Shrinkage::OneSided => passed,
                Shrinkage::TwoSided => passed.copysign(passed * z),
            };
        }
    }
}

/// λ Σ |z_i|·‖column i‖ of the next layer's `matrix` (rows × codes), and its gradient for z and for the matrix.
fn sparsity(
    lambda: f32,
    codes: usize,
    z: &[f32],
    matrix: &[f32],
    gradient_z: &mut [f32],
    gradient: &mut [f32],
) -> f64 {
    if lambda == 0.0 {
        return 0.0;
    }
    let mut norms = vec![0.0f32; codes];
    for row in matrix.chunks_exact(codes) {
        norms.iter_mut().zip(row).for_each(|(n, w)| *n += w * w);
    }
    norms.iter_mut().for_each(|n| *n = n.sqrt());
    let mut sums = vec![0.0f32; codes];
    for (z, g) in z.chunks_exact(codes).zip(gradient_z.chunks_exact_mut(codes)) {
        for (((&z, g), sum), &norm) in z.iter().zip(g).zip(&mut sums).zip(&norms) {
            *sum += z.abs();
            *g += if z == 0.0 { 0.0 } else { (lambda * norm).copysign(z) };
        }
    }
    let pull: Vec<f32> = sums.iter().zip(&norms).map(|(s, n)| lambda * s / n.max(1e-12)).collect();
    for (row, g) in matrix.chunks_exact(codes).zip(gradient.chunks_exact_mut(codes)) {
        g.iter_mut().zip(row).zip(&pull).for_each(|((g, w), p)| *g += w * p);
    }
    f64::from(lambda) * sums.iter().zip(&norms).map(|(s, n)| f64::from(s * n)).sum::<f64>()
}

/// z_t − z_{t−1} with z_0 = 0; `t` counts from 0.
fn subtract_previous(z: &[Vec<f32>], t: usize, change: &mut [f32]) {
    change.copy_from_slice(&z[t][..change.len()]);
    if t > 0 {
        subtract(change, &z[t - 1]);
    }
}

fn add(sum: &mut [f32], more: &[f32]) {
    sum.iter_mut().zip(more).for_each(|(s, m)| *s += m);
}

fn subtract(difference: &mut [f32], less: &[f32]) {
    difference.iter_mut().zip(less).for_each(|(d, l)| *d -= l);
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_spec::Window;
    use proptest::prelude::*;

    fn noise(length: usize, seed: u32, scale: f32) -> Vec<f32> {
        let mut state = u64::from(seed) * 2 + 1;
        (0..length)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                ((state >> 33) as f32 / (1u64 << 30) as f32 - 1.0) * scale
            })
            .collect()
    }

    /// The loss, and the sign of every code: where one changes, the loss has a kink.
    fn loss_at(
        form: Form,
        weights: &[f32],
        y: &[f32],
        x: &[f32],
        importance: &[f32],
        lambda: f32,
    ) -> (f64, Vec<i8>) {
        let mut pass = Pass::new(form, importance.len());
        let (mut errors, mut gradient) = (vec![0.0; importance.len()], vec![0.0; weights.len()]);
        let loss = pass.gradient(weights, y, x, importance, lambda, &mut errors, &mut gradient);
        let signs = pass.z.iter().flatten().map(|z| i8::from(*z > 0.0) - i8::from(*z < 0.0)).collect();
        (loss.squared + loss.sparsity, signs)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]
        #[test]
        fn the_gradient_equals_finite_differences(
            layers in 2usize..=10, one_sided: bool, difference: bool, linear_path: bool, tied: bool, seed in 0u32..9999
        ) {
            let form = Form {
                window: Window::new(8).unwrap(),
                codes: 6,
                layers,
                shrinkage: if one_sided { Shrinkage::OneSided } else { Shrinkage::TwoSided },
                recurrence: if difference { Recurrence::Difference } else { Recurrence::Direct },
                linear_path,
                tied,
            };
            let layout = Layout::new(&form);
            let mut weights = noise(layout.len(), seed, 0.3);
            for theta in &layout.thresholds {
                weights[theta.clone()].iter_mut().for_each(|t| *t = 0.02 + t.abs() * 0.2);
            }
            let (y, x) = (noise(3 * 64, seed + 1, 1.0), noise(3 * RGB_OUTPUTS, seed + 2, 1.0));
            let importance = [1.0, 0.5, 2.0];
            let mut pass = Pass::new(form, 3);
            let (mut errors, mut gradient) = ([0.0; 3], vec![0.0; layout.len()]);
            pass.gradient(&weights, &y, &x, &importance, 0.01, &mut errors, &mut gradient);
            // Along a random direction of each matrix the slope must be the gradient's.
            let groups = std::iter::once(&layout.analysis)
                .chain(&layout.thresholds)
                .chain(&layout.recurrent)
                .chain([&layout.dictionary, &layout.linear_path]);
            for (i, range) in groups.filter(|r| !r.is_empty()).enumerate() {
                let direction = noise(range.len(), seed + 10 + i as u32, 1.0);
                let slope: f64 = direction.iter().zip(&gradient[range.clone()]).map(|(d, g)| f64::from(d * g)).sum();
                let step = 1e-3 / direction.iter().map(|d| d * d).sum::<f32>().sqrt();
                let at = |sign: f32| {
                    let mut moved = weights.clone();
                    moved[range.clone()].iter_mut().zip(&direction).for_each(|(w, d)| *w += sign * step * d);
                    loss_at(form, &moved, &y, &x, &importance, 0.01)
                };
                let ((above, signs_above), (below, signs_below)) = (at(1.0), at(-1.0));
                if signs_above != signs_below {
                    continue;
                }
                let measured = (above - below) / f64::from(2.0 * step);
                // What f32 sums of this size leave open.
                let tolerance = 0.03 * slope.abs().max(measured.abs()) + 4e-6 * above / f64::from(step);
                prop_assert!((slope - measured).abs() <= tolerance, "{} {} {:?}", slope, measured, range);
            }
        }
    }

    #[test]
    fn two_sided_shrinkage_moves_toward_zero_and_stops_there() {
        let mut z = [0.0; 4];
        shrink(Shrinkage::TwoSided, &[3.0, -3.0, 0.5, -0.5], &[1.0; 4], &mut z);
        assert_eq!(z, [2.0, -2.0, 0.0, 0.0]);
    }

    #[test]
    fn one_sided_thresholds_of_any_sign_cut_at_zero() {
        let mut z = [0.0; 4];
        shrink(Shrinkage::OneSided, &[3.0, -3.0, -0.5, 0.5], &[1.0, 1.0, -1.0, 1.0], &mut z);
        assert_eq!(z, [2.0, 0.0, 0.5, 0.0]);
    }
}
