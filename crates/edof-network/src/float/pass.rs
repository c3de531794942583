//! A batch through the network and back: forward, and the hand-written gradient (docs/contract.md is its integer form), in either precision.

use crate::float::format::Format;
use crate::float::matmul::{Destination, Mat, product};
use crate::float::parameters::Layout;
use crate::float::real::Real;
use crate::network::{Form, Recurrence};
use edof_core::colour::RGB_OUTPUTS;
use std::ops::Range;

/// What a batch's loss is made of.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Loss {
    /// Weighted sum of squared errors over 192 outputs, halved.
    pub squared: f64,
    /// Sum over layers of λ_t times the sum of |z_t|, each weighted by the norm of the next layer's column.
    pub sparsity: f64,
}

/// Windows and what the network should make of them.
#[derive(Debug, Clone, Copy)]
pub struct Examples<'a, T = f32> {
    /// Windows × [`Form::inputs`].
    pub inputs: &'a [T],
    /// Windows × 192.
    pub targets: &'a [T],
    /// What each window's squared error weighs.
    pub importance: &'a [T],
}

/// Buffers for batches of up to `capacity` windows: every b_t, z_t and the outputs. Row-major, one window a row.
#[derive(Debug)]
pub struct Pass<T = f32> {
    form: Form,
    layout: Layout,
    /// What b_t and z_t are rounded to, t = 1…T−1.
    formats: Vec<Format>,
    /// The most that may stay of each z_t: the largest.
    budget: Option<usize>,
    /// b_t, t = 1…T−1.
    b: Vec<Vec<T>>,
    /// z_t, t = 1…T−1.
    z: Vec<Vec<T>>,
    /// Difference form: z_t − z_{t−1} for each M layer.
    change: Vec<Vec<T>>,
    outputs: Vec<T>,
    gradient_z: Vec<Vec<T>>,
    gradient_b: Vec<T>,
    gradient_b1: Vec<T>,
}

impl<T: Real> Pass<T> {
    /// Buffers for `capacity` windows through a network that gives RGB.
    #[must_use]
    pub fn new(form: Form, capacity: usize) -> Self {
        Self::with(form, Layout::new(&form), vec![Format::EXACT; form.shrinkages()], capacity)
    }

    /// Buffers for `capacity` windows through a network with N outputs whose codes are rounded to these formats. The
    /// gradient looks through the rounding, except where a code is at the end of its range.
    #[must_use]
    pub fn rounding(form: Form, outputs: usize, formats: &[Format], capacity: usize) -> Self {
        Self::with(form, Layout::giving(&form, outputs), formats.to_vec(), capacity)
    }

    /// Leaves at most N of each z_t, the largest: [`Pass::forward`] alone, the gradient knows nothing of it.
    #[must_use]
    pub const fn within(mut self, budget: Option<usize>) -> Self {
        self.budget = budget;
        self
    }

    fn with(form: Form, layout: Layout, formats: Vec<Format>, capacity: usize) -> Self {
        let codes = || vec![T::zero(); capacity * form.codes];
        Self {
            form,
            formats,
            budget: None,
            b: (0..form.shrinkages()).map(|_| codes()).collect(),
            z: (0..form.shrinkages()).map(|_| codes()).collect(),
            change: (0..form.middle_layers()).map(|_| codes()).collect(),
            outputs: vec![T::zero(); capacity * layout.outputs],
            layout,
            gradient_z: (0..form.shrinkages()).map(|_| codes()).collect(),
            gradient_b: codes(),
            gradient_b1: codes(),
        }
    }

    /// b_t (0 first), `windows` × codes, as the last [`Pass::forward`] left it.
    #[must_use]
    pub fn b(&self, t: usize) -> &[T] {
        &self.b[t]
    }

    /// z_t (0 first), `windows` × codes.
    #[must_use]
    pub fn z(&self, t: usize) -> &[T] {
        &self.z[t]
    }

    /// The outputs; before [`Pass::backward`], the loss's gradient for them.
    pub fn outputs_mut(&mut self) -> &mut [T] {
        &mut self.outputs
    }

    /// Runs `windows` windows of `inputs` (windows × [`Form::inputs`], row-major) and returns the outputs (windows × outputs).
    pub fn forward(&mut self, weights: &[T], inputs: &[T], windows: usize) -> &[T] {
        let (form, outputs) = (self.form, self.layout.outputs);
        let (codes, width) = (form.codes, form.inputs());
        let y = Mat::new(inputs, windows, width);
        let analysis = Mat::new(&weights[self.layout.analysis.clone()], codes, width);
        product(&mut self.b[0], Destination::Replace, y, analysis.t());
        for t in 0..form.shrinkages() {
            self.shrink(weights, t, windows * codes);
            if t < form.middle_layers() {
                self.middle_layer(weights, t, windows);
            }
        }
        let dictionary = Mat::new(&weights[self.layout.dictionary.clone()], outputs, codes);
        let last = Mat::new(&self.z[form.middle_layers()], windows, codes);
        product(&mut self.outputs, Destination::Replace, last, dictionary.t());
        if form.linear_path {
            let linear = Mat::new(&weights[self.layout.linear_path.clone()], outputs, width);
            product(&mut self.outputs, Destination::Accumulate, y, linear.t());
        }
        &self.outputs[..windows * outputs]
    }

    /// z_t from b_t; the first `used` numbers of each.
    fn shrink(&mut self, weights: &[T], t: usize, used: usize) {
        let (b, z) = (&mut self.b[t][..used], &mut self.z[t][..used]);
        self.formats[t].round_all(b);
        self.form.shrinkage.apply(b, &weights[self.layout.thresholds[t].clone()], z);
        self.formats[t].round_all(z);
        if let Some(budget) = self.budget {
            z.chunks_exact_mut(self.form.codes).for_each(|one| keep_largest(one, budget));
        }
    }

    /// M layer `t`: b_{t+1} from z_t and what the recurrence adds its product to.
    fn middle_layer(&mut self, weights: &[T], t: usize, windows: usize) {
        let codes = self.form.codes;
        let used = windows * codes;
        let s = Mat::new(&weights[self.recurrent(t)], codes, codes);
        let (before, after) = self.b.split_at_mut(t + 1);
        let next = &mut after[0][..used];
        let source = match self.form.recurrence {
            Recurrence::Direct => {
                next.copy_from_slice(&before[0][..used]);
                &self.z[t]
            }
            Recurrence::Difference => {
                next.copy_from_slice(&before[t][..used]);
                let change = &mut self.change[t][..used];
                subtract_previous(&self.z, t, change);
                self.formats[t].round_all(change);
                &self.change[t]
            }
        };
        product(next, Destination::Accumulate, Mat::new(source, windows, codes), s.t());
    }

    /// Where the S of M layer `t` lies.
    fn recurrent(&self, t: usize) -> Range<usize> {
        self.layout.recurrent[self.form.recurrent_index(t)].clone()
    }

    /// [`Pass::forward`], then adds the loss's gradient to `gradient`.
    ///
    /// The loss is Σ_p ½·`importance[p]`·‖e_p‖² + Σ_t `lambdas[t]`·Σ_p Σ_i |z_t,i|·‖column i of the next layer‖, e_p the window's
    /// error as [`weighted_errors`] has it; `squared_errors[p]` becomes ‖e_p‖². `lambdas` holds one for each shrinkage, or
    /// nothing where sparsity is free.
    pub fn gradient(
        &mut self,
        weights: &[T],
        examples: &Examples<'_, T>,
        lambdas: &[T],
        squared_errors: &mut [T],
        gradient: &mut [T],
    ) -> Loss {
        let windows = examples.importance.len();
        self.forward(weights, examples.inputs, windows);
        let squared = weighted_errors(&mut self.outputs, examples, squared_errors);
        Loss { squared, sparsity: self.backward(weights, examples.inputs, windows, lambdas, gradient) }
    }

    /// Adds to `gradient` what [`Pass::outputs_mut`], now the loss's gradient for the outputs of the last [`Pass::forward`],
    /// and `lambdas` (as in [`Pass::gradient`]) give; returns their part of the loss.
    pub fn backward(
        &mut self,
        weights: &[T],
        inputs: &[T],
        windows: usize,
        lambdas: &[T],
        gradient: &mut [T],
    ) -> f64 {
        let (codes, width) = (self.form.codes, self.form.inputs());
        let used = windows * codes;
        self.gradient_z.iter_mut().for_each(|g| g[..used].fill(T::zero()));
        self.gradient_b1[..used].fill(T::zero());
        let y = Mat::new(inputs, windows, width);
        self.final_layer_back(weights, y, gradient);
        let mut loss = 0.0;
        for t in (0..self.form.shrinkages()).rev() {
            let lambda = lambdas.get(t).copied().unwrap_or(T::zero());
            loss += self.sparsity_back(weights, lambda, t, used, gradient);
            self.shrink_back(weights, t, used, gradient);
            if t > 0 {
                self.middle_layer_back(weights, t - 1, windows, gradient);
            }
        }
        let into_b1 = Mat::new(&self.gradient_b1, windows, codes);
        product(&mut gradient[self.layout.analysis.clone()], Destination::Accumulate, into_b1.t(), y);
        loss
    }

    /// The loss's gradient for the inputs (windows × [`Form::inputs`]) of the last [`Pass::backward`], written to `into`.
    pub fn input_gradient(&self, weights: &[T], windows: usize, into: &mut [T]) {
        let (codes, width, outputs) = (self.form.codes, self.form.inputs(), self.layout.outputs);
        let analysis = Mat::new(&weights[self.layout.analysis.clone()], codes, width);
        product(into, Destination::Replace, Mat::new(&self.gradient_b1, windows, codes), analysis);
        if self.form.linear_path {
            let linear = Mat::new(&weights[self.layout.linear_path.clone()], outputs, width);
            product(into, Destination::Accumulate, Mat::new(&self.outputs, windows, outputs), linear);
        }
    }

    /// Back through D and R.
    fn final_layer_back(&mut self, weights: &[T], y: Mat<'_, T>, gradient: &mut [T]) {
        let (layout, last) = (&self.layout, self.form.middle_layers());
        let (windows, codes) = (y.rows(), self.form.codes);
        let errors = Mat::new(&self.outputs, windows, layout.outputs);
        let into_dictionary = &mut gradient[layout.dictionary.clone()];
        product(
            into_dictionary,
            Destination::Accumulate,
            errors.t(),
            Mat::new(&self.z[last], windows, codes),
        );
        if self.form.linear_path {
            product(&mut gradient[layout.linear_path.clone()], Destination::Accumulate, errors.t(), y);
        }
        let dictionary = Mat::new(&weights[layout.dictionary.clone()], layout.outputs, codes);
        product(&mut self.gradient_z[last], Destination::Replace, errors, dictionary);
    }

    /// λ's part at z_t: to z_t and to the matrix that multiplies it next.
    fn sparsity_back(&mut self, weights: &[T], lambda: T, t: usize, used: usize, gradient: &mut [T]) -> f64 {
        let last = t == self.form.middle_layers();
        let next = if last { self.layout.dictionary.clone() } else { self.recurrent(t) };
        let (matrix, into_matrix) = (&weights[next.clone()], &mut gradient[next]);
        sparsity(lambda, self.form.codes, &self.z[t][..used], matrix, &mut self.gradient_z[t], into_matrix)
    }

    /// Back through the shrinkage of b_t: to b_t, to θ_t and, where b_t was summed with it, to b₁.
    fn shrink_back(&mut self, weights: &[T], t: usize, used: usize, gradient: &mut [T]) {
        let carried = self.form.recurrence == Recurrence::Difference && t < self.form.middle_layers();
        if !carried {
            self.gradient_b[..used].fill(T::zero());
        }
        let thresholds = self.layout.thresholds[t].clone();
        self.form.shrinkage.pull_back(
            &self.z[t][..used],
            &weights[thresholds.clone()],
            &self.gradient_z[t][..used],
            &mut self.gradient_b,
            &mut gradient[thresholds],
        );
        self.formats[t].stop_clipped(&mut self.gradient_b[..used], &self.b[t][..used]);
        if self.form.recurrence == Recurrence::Direct || t == 0 {
            add(&mut self.gradient_b1[..used], &self.gradient_b);
        }
    }

    /// Back through M layer `t`: from b_{t+1} to S and to what S multiplied.
    fn middle_layer_back(&mut self, weights: &[T], t: usize, windows: usize, gradient: &mut [T]) {
        let codes = self.form.codes;
        let used = windows * codes;
        let range = self.recurrent(t);
        let s = Mat::new(&weights[range.clone()], codes, codes);
        let into_b = Mat::new(&self.gradient_b, windows, codes);
        let difference = self.form.recurrence == Recurrence::Difference;
        let source = if difference { &self.change[t] } else { &self.z[t] };
        product(&mut gradient[range], Destination::Accumulate, into_b.t(), Mat::new(source, windows, codes));
        let (earlier, later) = self.gradient_z.split_at_mut(t + 1);
        if difference && t > 0 {
            // later[0] is free from here on: it carries S's part to both codes whose difference S multiplied.
            product(&mut later[0], Destination::Replace, into_b, s);
            add(&mut earlier[t][..used], &later[0]);
            subtract(&mut earlier[t - 1][..used], &later[0]);
        } else {
            product(&mut earlier[t], Destination::Accumulate, into_b, s);
        }
    }
}

/// Outputs become the gradient for them of Σ_p ½·`importance[p]`·‖e_p‖², which is returned; `squared_errors[p]` becomes ‖e_p‖². A
/// window's error e is outputs minus targets.
pub fn weighted_errors<T: Real>(
    outputs: &mut [T],
    examples: &Examples<'_, T>,
    squared_errors: &mut [T],
) -> f64 {
    let rows = outputs.chunks_exact_mut(RGB_OUTPUTS).zip(examples.targets.chunks_exact(RGB_OUTPUTS));
    let windows = examples.importance.iter().zip(squared_errors);
    let mut loss = 0.0;
    for ((out, target), (&weight, squared)) in rows.zip(windows) {
        *squared = errors(out, target, weight);
        loss += 0.5 * (weight * *squared).wide();
    }
    loss
}

fn errors<T: Real>(out: &mut [T], target: &[T], weight: T) -> T {
    let mut sum = T::zero();
    for (o, &x) in out.iter_mut().zip(target) {
        let error = *o - x;
        sum += error * error;
        *o = error * weight;
    }
    sum
}

/// λ Σ |z_i|·‖column i‖ of the next layer's `matrix` (rows × codes), and its gradient for z and for the matrix.
fn sparsity<T: Real>(
    lambda: T,
    codes: usize,
    z: &[T],
    matrix: &[T],
    gradient_z: &mut [T],
    gradient: &mut [T],
) -> f64 {
    if lambda == T::zero() {
        return 0.0;
    }
    let mut norms = vec![T::zero(); codes];
    for row in matrix.chunks_exact(codes) {
        norms.iter_mut().zip(row).for_each(|(n, &w)| *n += w * w);
    }
    norms.iter_mut().for_each(|n| *n = n.sqrt());
    let mut sums = vec![T::zero(); codes];
    for (z, g) in z.chunks_exact(codes).zip(gradient_z.chunks_exact_mut(codes)) {
        for (((&z, g), sum), &norm) in z.iter().zip(g).zip(&mut sums).zip(&norms) {
            *sum += z.abs();
            *g += if z == T::zero() { T::zero() } else { (lambda * norm).copysign(z) };
        }
    }
    let min = T::of(1e-12);
    let pull: Vec<T> = sums.iter().zip(&norms).map(|(&s, &n)| lambda * s / n.max(min)).collect();
    for (row, g) in matrix.chunks_exact(codes).zip(gradient.chunks_exact_mut(codes)) {
        g.iter_mut().zip(row).zip(&pull).for_each(|((g, &w), &p)| *g += w * p);
    }
    lambda.wide() * sums.iter().zip(&norms).map(|(&s, &n)| (s * n).wide()).sum::<f64>()
}

/// z_t − z_{t−1} with z_0 = 0; `t` counts from 0.
fn subtract_previous<T: Real>(z: &[Vec<T>], t: usize, change: &mut [T]) {
    change.copy_from_slice(&z[t][..change.len()]);
    if t > 0 {
        subtract(change, &z[t - 1]);
    }
}

fn add<T: Real>(sum: &mut [T], more: &[T]) {
    sum.iter_mut().zip(more).for_each(|(s, &m)| *s += m);
}

fn subtract<T: Real>(difference: &mut [T], less: &[T]) {
    difference.iter_mut().zip(less).for_each(|(d, &l)| *d -= l);
}

/// Makes all but the `budget` largest numbers 0; among equals the first stay.
fn keep_largest<T: Real>(numbers: &mut [T], budget: usize) {
    let Some(dropped) = numbers.len().checked_sub(budget).filter(|dropped| *dropped > 0) else { return };
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    let larger = |&a: &usize, &b: &usize| {
        let sizes = numbers[b].abs().partial_cmp(&numbers[a].abs());
        sizes.unwrap_or(std::cmp::Ordering::Equal).then(a.cmp(&b))
    };
    order.sort_unstable_by(larger);
    order[numbers.len() - dropped..].iter().for_each(|&place| numbers[place] = T::zero());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_keeps_the_largest_and_all_of_few() {
        let mut numbers = [0.5f32, -3.0, 0.0, 2.0, -2.0];
        keep_largest(&mut numbers, 2);
        assert_eq!(numbers, [0.0, -3.0, 0.0, 2.0, 0.0]);
        keep_largest(&mut numbers, 5);
        keep_largest(&mut numbers, 9);
        assert_eq!(numbers, [0.0, -3.0, 0.0, 2.0, 0.0]);
    }
}
