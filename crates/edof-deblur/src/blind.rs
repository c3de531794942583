//! Deconvolution of a picture with an unknown kernel: D. Krishnan, T. Tay, R. Fergus, "Blind deconvolution using a normalized
//! sparsity measure", CVPR 2011, written from that description.
//!
//! Blur makes differences of neighbours smaller, but ‖x‖₂ of them falls faster than ‖x‖₁: their quotient is least for the sharp picture.
//! With y the differences of the picture, along rows and along columns, x and the kernel k are found in turn by
//!
//! min λ‖k∗x − y‖² + ‖x‖₁/‖x‖₂ + ψ‖k‖₁, k ≥ 0, Σk = 1,
//!
//! from coarse to fine, each scale √2 larger than the one before. The picture itself then comes from [`hyper_laplacian`].

use crate::fourier::{Fourier, Sample, Spectrum, correlation, fast_length};
use crate::hyper_laplacian::{Prior, hyper_laplacian};
use crate::resize::resized;
use ndarray::{Array2, ArrayView2, Zip, s};

/// The method's numbers. Turns, steps and the last deconvolution are those that were published with it. The published λ = 100 and δ = 0.001
/// say nothing without a scale of y, and one that stays fixed while x grows sharper and the scales finer fits some of them only: here
/// both follow x ([`Settings::sparsity`], [`Settings::step`]). docs/decisions/0019-blind-deconvolution.md measures the effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Side of the kernel, odd: larger than the blur.
    pub side: usize,
    /// How large differences of the sharp picture must be, in units of their root mean square: λ = √n/(sparsity·‖x‖₂²) for n of them.
    pub sparsity: f32,
    /// ψ/λ, how much ‖k‖₁ counts, where ‖y‖₂ = 1.
    pub kernel_weight: f32,
    /// Turns of x and k at each scale.
    pub turns: usize,
    /// How often, in each turn of x, ‖x‖₂ is taken anew, and steps in between.
    pub outer: usize,
    /// Shrinkage steps for one ‖x‖₂.
    pub inner: usize,
    /// The steps' length δ·λ·‖x‖₂, up to 1; halved where the cost explodes.
    pub step: f32,
    /// After each turn, entries of the kernel below this share of its largest are nothing.
    pub turn_floor: f32,
    /// The same at the end of each scale.
    pub floor: f32,
    /// At the end of each scale, parts of the kernel that hang together but hold less than this share of it are nothing.
    pub min_part: f32,
    /// The final deconvolution's prior.
    pub prior: Prior,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            side: 25,
            sparsity: 0.8,
            kernel_weight: 4e-5,
            turns: 21,
            outer: 2,
            inner: 2,
            step: 0.3,
            turn_floor: 0.03,
            floor: 0.05,
            min_part: 0.2,
            prior: Prior::default(),
        }
    }
}

/// What blind deconvolution found.
#[derive(Debug, Clone, PartialEq)]
pub struct BlindResult {
    /// The sharp picture.
    pub picture: Array2<f32>,
    /// The kernel: odd sides, nowhere negative, sum 1.
    pub kernel: Array2<f32>,
    /// How often δ was halved, over all scales.
    pub halvings: usize,
    /// Shrinkage steps, over all scales.
    pub steps: usize,
}

/// A kernel, and what it took to find it.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Odd sides, nowhere negative, sum 1.
    pub kernel: Array2<f32>,
    /// How often δ was halved, over all scales.
    pub halvings: usize,
    /// Shrinkage steps, over all scales.
    pub steps: usize,
}

/// The smallest kernel side, at the coarsest scale.
const COARSEST: usize = 3;
/// A cost that grows by this in a turn of x has exploded; and the shortest step that is still tried.
const EXPLOSION: f32 = 3.0;
const SHORTEST: f32 = 0.003;
/// Steps of conjugate gradients for a kernel, and the share of the residual at which they end.
const CONJUGATE_STEPS: usize = 25;
const CONJUGATE_REST: f32 = 1e-4;
/// Weights of ‖k‖₁ are 1/k, for k above this share of the largest entry.
const MIN_ENTRY: f32 = 1e-3;

/// Deconvolves a plane of 0…1 blind. Planes smaller than twice the kernel get a smaller one.
#[must_use]
pub fn deconvolve(plane: ArrayView2<'_, f32>, settings: &Settings) -> BlindResult {
    let Estimate { kernel, halvings, steps } = estimate(plane, settings);
    BlindResult { picture: hyper_laplacian(plane, kernel.view(), settings.prior), kernel, halvings, steps }
}

/// The kernel alone.
#[must_use]
pub fn estimate(plane: ArrayView2<'_, f32>, settings: &Settings) -> Estimate {
    let (height, width) = plane.dim();
    let side = settings.side.min(height.min(width) / 2).max(COARSEST) | 1;
    let scales = scales(side);
    let mut kernel = first_kernel();
    let (mut halvings, mut steps) = (0, 0);
    let mut sharp: Option<[Array2<f32>; 2]> = None;
    for &(side, factor) in &scales {
        let size = [height, width].map(|n| ((n as f32 * factor).round() as usize).max(COARSEST));
        let seen = if factor < 1.0 { resized(plane, (size[0], size[1])) } else { plane.to_owned() };
        kernel = normalised(resized(kernel.view(), (side, side)));
        let mut scale = Scale::new(&seen, side, sharp.as_ref(), settings);
        for _ in 0..settings.turns {
            scale.update_picture(&kernel, settings);
            kernel = above(&scale.update_kernel(&kernel, settings), settings.turn_floor);
        }
        kernel = joined(&above(&kernel, settings.floor), settings.min_part);
        let shift = middle_shift(&kernel);
        kernel = shifted(&kernel, shift);
        sharp = Some(scale.picture(shift));
        halvings += scale.halvings;
        steps += scale.steps;
    }
    Estimate { kernel, halvings, steps }
}

/// A kernel without entries below a share of its largest.
fn above(kernel: &Array2<f32>, share: f32) -> Array2<f32> {
    let min = share * kernel.iter().copied().fold(0.0, f32::max);
    normalised(kernel.mapv(|v| if v < min { 0.0 } else { v }))
}

/// A kernel without its small parts: pixels that touch each other, corners included, and hold less than a share of all; the largest
/// stays in any case.
fn joined(kernel: &Array2<f32>, share: f32) -> Array2<f32> {
    let mut parts = Array2::<usize>::zeros(kernel.dim());
    // What lies in no part is part 0.
    let mut masses = vec![0.0f32];
    for (at, &value) in kernel.indexed_iter() {
        if value > 0.0 && parts[at] == 0 {
            parts[at] = masses.len();
            let mut open = vec![at];
            let mut mass = 0.0;
            while let Some((row, column)) = open.pop() {
                mass += kernel[(row, column)];
                for (r, c) in (row.saturating_sub(1)..=row + 1)
                    .flat_map(|r| (column.saturating_sub(1)..=column + 1).map(move |c| (r, c)))
                {
                    if kernel.get((r, c)).is_some_and(|v| *v > 0.0) && parts[(r, c)] == 0 {
                        parts[(r, c)] = masses.len();
                        open.push((r, c));
                    }
                }
            }
            masses.push(mass);
        }
    }
    let max = masses.iter().copied().fold(0.0, f32::max);
    let min = max.min(share * masses.iter().sum::<f32>());
    normalised(Array2::from_shape_fn(
        kernel.dim(),
        |at| if masses[parts[at]] < min { 0.0 } else { kernel[at] },
    ))
}

/// Sides of the kernel and factors of the picture from coarse to fine.
fn scales(side: usize) -> Vec<(usize, f32)> {
    let mut scales = vec![];
    let mut factor = 1.0f32;
    loop {
        let own = ((side as f32 * factor).ceil() as usize | 1).max(COARSEST);
        scales.push((own, factor));
        if own == COARSEST {
            break;
        }
        factor *= std::f32::consts::FRAC_1_SQRT_2;
    }
    scales.reverse();
    scales
}

/// A point with a little of its four neighbours.
fn first_kernel() -> Array2<f32> {
    ndarray::array![[0.0, 0.1, 0.0], [0.1, 0.6, 0.1], [0.0, 0.1, 0.0]]
}

/// Sum 1, nothing negative.
fn normalised(kernel: Array2<f32>) -> Array2<f32> {
    let positive = kernel.mapv_into(|v| v.max(0.0));
    let sum = positive.sum();
    positive / sum.max(f32::MIN_POSITIVE)
}

/// Rows and columns by which the centroid lies beside the middle, rounded.
fn middle_shift(kernel: &Array2<f32>) -> (isize, isize) {
    let moment =
        |f: fn((usize, usize)) -> usize| kernel.indexed_iter().map(|(at, v)| f(at) as f32 * v).sum::<f32>();
    let sum = kernel.sum();
    let off = |moment: f32, n: usize| (moment / sum - (n / 2) as f32).round() as isize;
    (off(moment(|at| at.0), kernel.nrows()), off(moment(|at| at.1), kernel.ncols()))
}

/// The kernel moved back by `shift`; what leaves it is lost.
fn shifted(kernel: &Array2<f32>, shift: (isize, isize)) -> Array2<f32> {
    let at = |i: usize, by: isize| usize::try_from(i as isize + by).ok();
    normalised(Array2::from_shape_fn(kernel.dim(), |(r, c)| {
        at(r, shift.0).zip(at(c, shift.1)).and_then(|at| kernel.get(at)).copied().unwrap_or(0.0)
    }))
}

/// One scale: differences of the picture as it is seen and as it would be without blur. Those along rows ride as real parts, those
/// along columns as imaginary ones, on a plane that is larger by a kernel and circular.
struct Scale {
    plan: Fourier,
    size: (usize, usize),
    side: usize,
    seen: Spectrum,
    sharp: Spectrum,
    /// Σ|x| of both kinds.
    sharp_sum: f32,
    step: f32,
    halvings: usize,
    steps: usize,
}

impl Scale {
    fn new(seen: &Array2<f32>, side: usize, sharp: Option<&[Array2<f32>; 2]>, settings: &Settings) -> Self {
        let size = seen.dim();
        let whole = (fast_length(size.0 + side), fast_length(size.1 + side));
        let plan = Fourier::new(whole);
        let mut plane = Array2::from_elem(whole, Sample::default());
        for r in 0..size.0 - 1 {
            for c in 0..size.1 - 1 {
                let here = seen[(r, c)];
                plane[(r, c)] = Sample::new(seen[(r, c + 1)] - here, seen[(r + 1, c)] - here);
            }
        }
        to_unit(&mut plane);
        let transformed = plan.forward(&plane);
        if let Some(coarse) = sharp {
            let [along_rows, along_columns] = coarse.each_ref().map(|plane| resized(plane.view(), size));
            plane.fill(Sample::default());
            Zip::from(plane.slice_mut(s![..size.0, ..size.1]))
                .and(&along_rows)
                .and(&along_columns)
                .for_each(|v, &re, &im| *v = Sample::new(re, im));
            to_unit(&mut plane);
        }
        let sharp_sum = sum_of_sizes(&plane);
        let sharp = plan.forward(&plane);
        let step = settings.step;
        Self { plan, size, side, seen: transformed, sharp, sharp_sum, step, halvings: 0, steps: 0 }
    }

    /// ‖·‖₂² of the plane of a spectrum (Parseval).
    fn energy(&self, spectrum: &Spectrum) -> f32 {
        spectrum.iter().map(|v| f64::from(v.norm_sqr())).sum::<f64>() as f32 / spectrum.len() as f32
    }

    /// λ of the picture as it is.
    fn lambda(&self, settings: &Settings) -> f32 {
        let count = (2 * self.size.0 * self.size.1) as f32;
        count.sqrt() / (settings.sparsity * self.energy(&self.sharp)).max(f32::MIN_POSITIVE)
    }

    /// λ‖k∗x − y‖² + ‖x‖₁/‖x‖₂.
    fn cost(&self, transfer: &Spectrum, lambda: f32) -> f32 {
        let rest = Zip::from(&self.sharp).and(transfer).and(&self.seen).map_collect(|x, k, y| x * k - y);
        lambda * self.energy(&rest) + self.sharp_sum / self.energy(&self.sharp).sqrt().max(f32::MIN_POSITIVE)
    }

    /// A turn of x (algorithm 3): shrinkage steps on λ‖x‖₂·‖k∗x − y‖²/2 + ‖x‖₁ with λ and ‖x‖₂ held, taken anew `outer` times. Where that
    /// explodes it is undone, and tried with half the step.
    fn update_picture(&mut self, kernel: &Array2<f32>, settings: &Settings) {
        let transfer = self.plan.kernel(kernel.view());
        let lambda = self.lambda(settings);
        let before = self.cost(&transfer, lambda);
        let (sharp, sum) = (self.sharp.clone(), self.sharp_sum);
        loop {
            for _ in 0..settings.outer {
                let weight = self.lambda(settings) * self.energy(&self.sharp).sqrt();
                for _ in 0..settings.inner {
                    self.shrink(&transfer, self.step / weight);
                }
            }
            let after = self.cost(&transfer, lambda);
            if after <= EXPLOSION * before || self.step <= SHORTEST {
                return;
            }
            self.step /= 2.0;
            self.halvings += 1;
            (self.sharp, self.sharp_sum) = (sharp.clone(), sum);
        }
    }

    /// One shrinkage step: x ← σ_δ(x − step·kᵀ∗(k∗x − y)).
    fn shrink(&mut self, transfer: &Spectrum, delta: f32) {
        let length = self.step;
        Zip::from(&mut self.sharp).and(transfer).and(&self.seen).for_each(|x, k, y| {
            *x -= k.conj() * (*x * k - y) * length;
        });
        let mut plane = self.plan.inverse(&self.sharp);
        let shrink = |v: f32| (v - delta).max(0.0) + (v + delta).min(0.0);
        plane.mapv_inplace(|v| Sample::new(shrink(v.re), shrink(v.im)));
        self.sharp_sum = sum_of_sizes(&plane);
        self.sharp = self.plan.forward(&plane);
        self.steps += 1;
    }

    /// A turn of k: (XᵀX + ψ/2λ·diag(1/k))·k' = Xᵀy, one re-weighting, by conjugate gradients from k; then k' ≥ 0 and Σk' = 1. A
    /// picture without differences has no information about its kernel, which then stays.
    fn update_kernel(&self, kernel: &Array2<f32>, settings: &Settings) -> Array2<f32> {
        let lags = self.lags(&correlation(&self.sharp, &self.sharp), self.side - 1);
        let wanted = self.lags(&correlation(&self.seen, &self.sharp), self.side / 2);
        let min = MIN_ENTRY * kernel.iter().copied().fold(0.0, f32::max);
        let price = settings.kernel_weight / 2.0;
        let weights = kernel.mapv(|v| price / v.max(min).max(f32::MIN_POSITIVE));
        let solved =
            conjugate_gradients(|k| &autocorrelated(&lags, k) + &(&weights * k), &wanted, kernel.clone());
        let positive = solved.mapv(|v| v.max(0.0));
        let sum = positive.sum();
        if sum.is_finite() && sum > 1e-6 { positive / sum } else { kernel.clone() }
    }

    /// The middle of a correlation: lags of ±`reach`, both kinds of differences together.
    fn lags(&self, spectrum: &Spectrum, reach: usize) -> Array2<f32> {
        let whole = self.plan.inverse(spectrum);
        let (rows, columns) = whole.dim();
        Array2::from_shape_fn((2 * reach + 1, 2 * reach + 1), |(r, c)| {
            whole[((r + reach * rows - reach) % rows, (c + reach * columns - reach) % columns)].re
        })
    }

    /// x of both kinds, moved with the kernel.
    fn picture(&self, (dr, dc): (isize, isize)) -> [Array2<f32>; 2] {
        let whole = self.plan.inverse(&self.sharp);
        let (rows, columns) = whole.dim();
        let at = |i: usize, by: isize, n: usize| (i as isize - by).rem_euclid(n as isize) as usize;
        let part = |f: fn(&Sample) -> f32| {
            Array2::from_shape_fn(self.size, |(r, c)| f(&whole[(at(r, dr, rows), at(c, dc, columns))]))
        };
        [part(|v| v.re), part(|v| v.im)]
    }
}

/// Scales differences to ‖·‖₂ = 1; where there are none they stay.
fn to_unit(plane: &mut Array2<Sample>) {
    let energy = plane.iter().map(|v| f64::from(v.norm_sqr())).sum::<f64>() as f32;
    if energy > 0.0 {
        let scale = 1.0 / energy.sqrt();
        plane.mapv_inplace(|v| v * scale);
    }
}

fn sum_of_sizes(plane: &Array2<Sample>) -> f32 {
    plane.iter().map(|v| f64::from(v.re.abs() + v.im.abs())).sum::<f64>() as f32
}

/// XᵀX·k from the lags of x's autocorrelation.
fn autocorrelated(lags: &Array2<f32>, k: &Array2<f32>) -> Array2<f32> {
    let (rows, columns) = k.dim();
    Array2::from_shape_fn((rows, columns), |(r, c)| {
        let terms = k.outer_iter().enumerate().map(|(i, line)| {
            let lag = r + rows - 1 - i;
            // k at column j meets lag c − j, which stands at c + columns − 1 − j: the other way round.
            line.iter().rev().zip(lags.slice(s![lag, c..c + columns])).map(|(k, a)| k * a).sum::<f32>()
        });
        terms.sum()
    })
}

/// x of A·x = b for a symmetric positive definite A, from a first guess (Hestenes and Stiefel 1952).
fn conjugate_gradients(
    a: impl Fn(&Array2<f32>) -> Array2<f32>,
    b: &Array2<f32>,
    mut x: Array2<f32>,
) -> Array2<f32> {
    let dot = |u: &Array2<f32>, v: &Array2<f32>| u.iter().zip(v).map(|(u, v)| u * v).sum::<f32>();
    let mut rest = b - &a(&x);
    let mut direction = rest.clone();
    let mut energy = dot(&rest, &rest);
    let enough = CONJUGATE_REST * CONJUGATE_REST * dot(b, b);
    for _ in 0..CONJUGATE_STEPS {
        if energy <= enough {
            break;
        }
        let along = a(&direction);
        let length = energy / dot(&direction, &along);
        x.scaled_add(length, &direction);
        rest.scaled_add(-length, &along);
        let next = dot(&rest, &rest);
        direction = &rest + &(&direction * (next / energy));
        energy = next;
    }
    x
}

#[cfg(test)]
mod tests;
