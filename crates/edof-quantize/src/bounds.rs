//! How far integers, or `f32`, can be from the network in real numbers, stage by stage, before any window is seen.
//!
//! With Ŵ the words' matrices, W the real ones and v̂, v what they multiply, Ŵv̂ − Wv = Ŵ(v̂ − v) + (Ŵ − W)v. Each row's bound is
//! Σ|Ŵ|·(bound of v) for the first term, the most that (Ŵ − W)v can be for any v that occurs (interval arithmetic over all windows) for
//! the second, and half of the result's last bit for rounding. Shrinkage brings two numbers apart by its gain at most, and saturation by nothing, so the bound
//! holds for every window, those that saturate too, against a network clamped to the same ranges ([`crate::float_reference`]); where none of its
//! values reaches an end of its range, that is the float network.
//!
//! The statistical figure takes roundings for independent, uniform and without mean, and every code for open: each rounding then
//! reaches a result by one path of matrices whose squares add up. Rounding of weights is not in it.

use crate::float_reference::all_ends;
use crate::fold::Folded;
use edof_core::number::{INPUT_FRACTION, OUTPUT_FRACTION};
use edof_network::fixed_network::layer_names;
use edof_network::network::Recurrence;
use edof_network::{FixedNetwork, Network};
use ndarray::{Array1, Array2, ArrayView1};
use serde::Serialize;

/// How far one stage's results can be off, in values (light of 1 is 1; chroma with its gain).
#[derive(Debug, Clone, PartialEq)]
pub struct StageBound {
    /// I, M1, M2, …, F.
    pub name: String,
    /// The value of the result's last bit.
    pub unit: f64,
    /// For each result, the most that any window can bring about.
    pub worst: Vec<f64>,
    /// For each result, the standard deviation of what rounding its way here brings about.
    pub deviation: Vec<f64>,
}

/// A stage's bound in units of the result's last bit, as commands tell it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoundSummary {
    /// Largest of all results' worst cases.
    pub worst_bits: f64,
    /// Largest standard deviation.
    pub deviation_bits: f64,
}

impl StageBound {
    /// The largest of each.
    #[must_use]
    pub fn summary(&self) -> BoundSummary {
        let max = |values: &[f64]| values.iter().copied().fold(0.0, f64::max) / self.unit;
        BoundSummary { worst_bits: max(&self.worst), deviation_bits: max(&self.deviation) }
    }
}

/// The arithmetic whose distance from real numbers is bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arithmetic {
    /// The fixed network's words.
    Words,
    /// The real network's own weights in `f32`, summed in any order.
    Single,
}

/// Bounds of every stage of `fixed` against the network with the real weights `reference`, which may be those of its own words
/// ([`Folded::of`]): then what is bounded is rounding in flight alone.
#[must_use]
pub fn bounds(fixed: &FixedNetwork, reference: &Folded, arithmetic: Arithmetic) -> Vec<StageBound> {
    let own = Folded::of(fixed);
    let computed = match arithmetic {
        Arithmetic::Words => &own,
        Arithmetic::Single => reference,
    };
    let work = Work { fixed, reference, computed, arithmetic };
    let deviations = match arithmetic {
        Arithmetic::Words => work.deviations(),
        Arithmetic::Single => vec![],
    };
    let fractions = fixed.code_fractions.iter().chain([&OUTPUT_FRACTION]);
    let names = layer_names(fixed.form.layers).enumerate();
    work.worst()
        .into_iter()
        .zip(fractions)
        .zip(names)
        .enumerate()
        .map(|(stage, ((worst, fraction), (index, name)))| StageBound {
            name: if name == "M" { format!("M{index}") } else { name.to_owned() },
            unit: unit(*fraction),
            deviation: deviations.get(stage).cloned().unwrap_or_else(|| vec![0.0; worst.len()]),
            worst,
        })
        .collect()
}

/// Both bounds of a stage: against the same words in real numbers, and against the float network that they were made from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageError {
    /// I, M1, M2, …, F.
    pub stage: String,
    /// Rounding in flight alone.
    pub rounding: BoundSummary,
    /// Rounding of weights and in flight; none where the float network is not available.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weights: Option<BoundSummary>,
}

/// What integers can cost at every stage, in units of its last bit.
#[must_use]
pub fn stage_errors(fixed: &FixedNetwork, float: Option<&Network>) -> Vec<StageError> {
    let rounding = bounds(fixed, &Folded::of(fixed), Arithmetic::Words);
    let real = float.and_then(|float| reference(fixed, float));
    let weights = real.map(|real| bounds(fixed, &real, Arithmetic::Words));
    let summary = |stage: usize| weights.as_ref().map(|weights| weights[stage].summary());
    let each = rounding.iter().enumerate();
    each.map(|(i, bound)| StageError {
        stage: bound.name.clone(),
        rounding: bound.summary(),
        weights: summary(i),
    })
    .collect()
}

/// The real network in the units of `fixed`: its coefficients scaled as the words of A say they were.
///
/// Shrinkage commutes with positive scales, so any would do; these make the two comparable. `None` if the forms differ.
#[must_use]
pub fn reference(fixed: &FixedNetwork, float: &Network) -> Option<Folded> {
    if fixed.form != float.form {
        return None;
    }
    let words = Folded::of(fixed).analysis;
    let scale = |(words, real): (ArrayView1<'_, f64>, ArrayView1<'_, f32>)| {
        let (mut cross, mut own) = (0.0, 0.0);
        words.iter().zip(real).for_each(|(w, r)| {
            cross += w * f64::from(*r);
            own += f64::from(*r).powi(2);
        });
        if cross > 0.0 { cross / own } else { 1.0 }
    };
    let scales: Vec<f64> = words.outer_iter().zip(float.analysis.outer_iter()).map(scale).collect();
    Some(crate::fold::fold(float, &scales, fixed.stride, fixed.overlap))
}

fn unit(fraction: u32) -> f64 {
    (-f64::from(fraction)).exp2()
}

/// Values between which something lies for every window, one pair a coefficient.
#[derive(Debug, Clone)]
struct Interval {
    min: Array1<f64>,
    max: Array1<f64>,
}

impl Interval {
    fn map(&self, each: impl Fn(f64, usize) -> f64) -> Self {
        let all = |ends: &Array1<f64>| ends.iter().enumerate().map(|(i, v)| each(*v, i)).collect();
        Self { min: all(&self.min), max: all(&self.max) }
    }

    fn held(&self, [min, max]: [f64; 2]) -> Self {
        self.map(|v, _| v.clamp(min, max))
    }

    fn plus(&self, other: &Self) -> Self {
        Self { min: &self.min + &other.min, max: &self.max + &other.max }
    }

    fn minus(&self, other: &Self) -> Self {
        Self { min: &self.min - &other.max, max: &self.max - &other.min }
    }

    /// Largest magnitudes.
    fn size(&self) -> Array1<f64> {
        self.min.iter().zip(&self.max).map(|(a, b)| a.abs().max(b.abs())).collect()
    }

    /// What a matrix can make of it.
    fn through(&self, matrix: &Array2<f64>) -> Self {
        let positive = matrix.mapv(|w| w.max(0.0));
        let negative = matrix.mapv(|w| w.min(0.0));
        Self {
            min: positive.dot(&self.min) + negative.dot(&self.max),
            max: positive.dot(&self.max) + negative.dot(&self.min),
        }
    }
}

struct Work<'a> {
    fixed: &'a FixedNetwork,
    reference: &'a Folded,
    /// The weights of what is bounded.
    computed: &'a Folded,
    arithmetic: Arithmetic,
}

/// Half of `f32`'s relative spacing.
const SINGLE: f64 = 1.0 / (1u64 << 24) as f64;

/// A value's interval in the real network, and how far off what is computed can be.
#[derive(Clone)]
struct Known {
    real: Interval,
    off: Array1<f64>,
}

impl Work<'_> {
    /// The worst case of every b_t and of the outputs.
    fn worst(&self) -> Vec<Vec<f64>> {
        let (form, ends) = (self.fixed.form, all_ends(self.fixed));
        let pixels = form.window.pixels();
        let light = 1.0 - unit(INPUT_FRACTION);
        let y = Known {
            real: Interval { min: Array1::zeros(pixels), max: Array1::from_elem(pixels, light) },
            off: Array1::zeros(pixels),
        };
        let (own, real) = (self.computed, self.reference);
        let nothing = Known {
            real: Interval { min: Array1::zeros(form.codes), max: Array1::zeros(form.codes) },
            off: Array1::zeros(form.codes),
        };
        let shift = self.fixed.analysis_shift();
        let first = self.product(&[(&own.analysis, &real.analysis, &y)], &nothing, self.step(shift, 0));
        let mut b = vec![held(first, ends[0])];
        let mut before: Option<Known> = None;
        for t in 0..form.shrinkages() {
            let z = self.shrunk(t, &b[t], ends[t]);
            if t < form.middle_layers() {
                let index = form.recurrent_index(t);
                let (base, sent) = match (form.recurrence, &before) {
                    (Recurrence::Direct, _) => (&b[0], z.clone()),
                    (Recurrence::Difference, None) => (&b[t], z.clone()),
                    (Recurrence::Difference, Some(before)) => {
                        let real = z.real.minus(&before.real);
                        let rounding = self.single() * &real.size();
                        (&b[t], held(Known { real, off: &z.off + &before.off + rounding }, ends[t]))
                    }
                };
                let s = [(&own.recurrent[index], &real.recurrent[index], &sent)];
                let next = self.product(&s, base, self.step(self.fixed.middle_shifts(t).result, t + 1));
                b.push(held(next, ends[t + 1]));
            } else {
                let outputs = real.dictionary.nrows();
                let zero = Array1::zeros(outputs);
                let nothing = Known { real: Interval { min: zero.clone(), max: zero.clone() }, off: zero };
                let mut both = vec![(&own.dictionary, &real.dictionary, &z)];
                if let (Some(computed), Some(exact)) = (&own.linear_path, &real.linear_path) {
                    both.push((computed, exact, &y));
                }
                let out = self.product(&both, &nothing, self.step(self.fixed.final_shifts().result, t + 1));
                b.push(held(out, ends[t + 1]));
            }
            before = Some(z);
        }
        b.into_iter().map(|known| known.off.to_vec()).collect()
    }

    /// Half of a result's last bit, where the shift rounds.
    fn step(&self, shift: u32, stage: usize) -> f64 {
        let fraction = self.fixed.code_fractions.get(stage).copied().unwrap_or(OUTPUT_FRACTION);
        if self.arithmetic == Arithmetic::Single || shift == 0 { 0.0 } else { 0.5 * unit(fraction) }
    }

    /// Relative rounding of one operation.
    const fn single(&self) -> f64 {
        match self.arithmetic {
            Arithmetic::Words => 0.0,
            Arithmetic::Single => SINGLE,
        }
    }

    /// Base plus products of (computed matrix, real matrix, what they multiply), rounded by at most `step`.
    fn product(&self, products: &[(&Array2<f64>, &Array2<f64>, &Known)], base: &Known, step: f64) -> Known {
        let mut real = base.real.clone();
        let mut off = &base.off + step;
        let mut size = base.real.size() + &base.off;
        let mut terms = 1;
        for (computed, exact, v) in products {
            real = real.plus(&v.real.through(exact));
            let moved = computed.mapv(f64::abs).dot(&v.off);
            let differ = v.real.through(&(*computed - *exact)).size();
            size = size + computed.mapv(f64::abs).dot(&(v.real.size() + &v.off));
            off = off + moved + differ;
            terms += computed.ncols();
        }
        // Every weight is rounded to f32 once, every product and every sum once more, in any order (Higham 2002, section 3.1).
        let many = (terms + 3) as f64 * self.single();
        Known { real, off: off + size * (many / (1.0 - many)) }
    }

    fn shrunk(&self, t: usize, b: &Known, ends: [f64; 2]) -> Known {
        let (own, exact) = (&self.computed.thresholds[t], &self.reference.thresholds[t]);
        let shrinkage = self.fixed.form.shrinkage;
        let real = b.real.map(|v, i| shrinkage.value(v, exact[i]));
        let size = b.real.size();
        let off = Array1::from_shape_fn(own.len(), |i| {
            let rounding = 3.0 * self.single() * (size[i] + b.off[i] + exact[i].abs());
            let off = b.off[i] + (own[i] - exact[i]).abs() + rounding;
            // Closed for every window, whatever the error: nothing passes.
            let closing = shrinkage.closing_threshold(b.real.min[i], b.real.max[i]);
            if closing + off <= exact[i] { 0.0 } else { shrinkage.gain() * off }
        });
        held(Known { real, off }, ends)
    }

    /// Standard deviations of every b_t and of the outputs.
    fn deviations(&self) -> Vec<Vec<f64>> {
        let (form, own) = (self.fixed.form, self.computed);
        let codes = form.codes;
        let variance = |shift: u32, stage: usize| (2.0 * self.step(shift, stage)).powi(2) / 12.0;
        // For each rounding so far: its variance, and by what matrix it reaches b_t.
        let mut paths: Vec<Vec<Array2<f64>>> = vec![vec![Array2::eye(codes)]];
        let mut variances = vec![variance(self.fixed.analysis_shift(), 0)];
        for t in 0..form.middle_layers() {
            let s = &own.recurrent[form.recurrent_index(t)];
            let zero = || Array2::zeros((codes, codes));
            let part = |t: usize, source: usize| paths[t].get(source).cloned().unwrap_or_else(zero);
            let mut next: Vec<Array2<f64>> = (0..=t)
                .map(|source| match form.recurrence {
                    Recurrence::Direct => part(0, source) + s.dot(&part(t, source)),
                    Recurrence::Difference => {
                        let before = if t == 0 { zero() } else { part(t - 1, source) };
                        part(t, source) + s.dot(&(part(t, source) - before))
                    }
                })
                .collect();
            next.push(Array2::eye(codes));
            paths.push(next);
            variances.push(variance(self.fixed.middle_shifts(t).result, t + 1));
        }
        let spread = |paths: &[Array2<f64>], rows: usize, more: f64| -> Vec<f64> {
            (0..rows)
                .map(|row| {
                    let each = paths.iter().zip(&variances);
                    let sum: f64 = each.map(|(path, v)| v * path.row(row).dot(&path.row(row))).sum();
                    (sum + more).sqrt()
                })
                .collect()
        };
        let mut all: Vec<Vec<f64>> = paths.iter().map(|paths| spread(paths, codes, 0.0)).collect();
        let last: Vec<Array2<f64>> =
            paths[form.middle_layers()].iter().map(|path| own.dictionary.dot(path)).collect();
        let own = variance(self.fixed.final_shifts().result, form.shrinkages());
        all.push(spread(&last, self.reference.dictionary.nrows(), own));
        all
    }
}

/// Saturation: it brings no two numbers further apart.
fn held(known: Known, ends: [f64; 2]) -> Known {
    let width = ends[1] - ends[0];
    Known { real: known.real.held(ends), off: known.off.mapv(|e| e.min(width)) }
}

#[cfg(test)]
mod tests;
