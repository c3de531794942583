//! Pursuits in dictionaries that they do not like, in `f32` and `f64`.
//!
//! OMP's code is compared with the best fit, in `f64`, of the very atoms that it chose: what it leaves of a signal more than that, as a
//! share of the signal. ISTA and FISTA are judged by their duality gap as a share of ½‖x‖²: no code whatever has an objective less than that
//! below theirs (S. Boyd, L. Vandenberghe, "Convex optimization", section 5.5.1); without a penalty, by what is left of the normal equations.

use crate::stability::case::{Atoms, Promise, Signals};
use crate::stability::outcome::{Measurement, TrialResult};
use edof_core::draw::Draw;
use edof_numerics::Cholesky;
use edof_numerics::sparse::ksvd::{Settings, ksvd};
use edof_numerics::sparse::lasso::{Effort, Lasso};
use edof_numerics::sparse::omp::{Omp, Stop};
use ndarray::{Array1, Array2, ArrayView1, Axis, NdFloat};

const LENGTH: usize = 16;
const ATOMS: usize = 24;
const SIGNALS: usize = 24;
/// Atoms that OMP may choose.
const MAX: usize = 8;

/// The three solvers in both precisions.
pub(crate) fn pursuit(
    dictionary: Atoms,
    signals: Signals,
    penalty: f64,
    steps: usize,
    promise: &Promise,
) -> TrialResult {
    let dictionary = atoms(dictionary);
    let signals = drawn(signals, &dictionary);
    let mut seen = vec![];
    solved::<f64>("f64", &dictionary, &signals, penalty, steps, promise, &mut seen);
    solved::<f32>("f32", &dictionary, &signals, penalty, steps, promise, &mut seen);
    TrialResult::of(seen)
}

fn number<F: NdFloat>(value: f64) -> F {
    F::from(value).unwrap_or_else(F::nan)
}

fn wide<F: NdFloat>(values: &Array2<F>) -> Array2<f64> {
    values.mapv(|v| v.to_f64().unwrap_or(f64::NAN))
}

fn solved<F: NdFloat>(
    precision: &str,
    dictionary: &Array2<f64>,
    signals: &Array2<f64>,
    penalty: f64,
    steps: usize,
    promise: &Promise,
    seen: &mut Vec<Measurement>,
) {
    let (d, x) = (dictionary.mapv(number::<F>), signals.mapv(number::<F>));
    // What is compared is of the rounded ones: rounding the problem is no fault of the solver.
    let (dictionary, signals) = (wide(&d), wide(&x));
    let mut judge = |solver: &str, what: &str, codes: &Array2<f64>, worst: f64| {
        let name = format!("{solver}.{precision}");
        seen.push(Measurement::fact(
            &name,
            "every code is a finite number",
            codes.iter().all(|v| v.is_finite()),
        ));
        if let Some(limit) = promise.limit(&name) {
            seen.push(Measurement::new(name, what, worst, limit));
        }
    };
    let codes = Omp::new(d.view(), 0).codes(x.view(), Stop::at_atoms(MAX));
    let dense = wide(&codes.to_dense(d.ncols()));
    let max = rows(&dictionary, &signals, &dense, |x, z| {
        let support: Vec<usize> = (0..z.len()).filter(|i| z[*i] != 0.0).collect();
        let rest = norm(&(&x - &dictionary.dot(&z)));
        (rest - best_fit(&dictionary, &support, x)) / norm(&x.to_owned()).max(f64::MIN_POSITIVE)
    });
    judge("omp", "left of a signal more than the best fit leaves, of the signal", &dense, max);
    let correlation = signals.dot(&dictionary).iter().fold(0.0f64, |max, v| max.max(v.abs()));
    let mu = penalty * correlation;
    let penalties = Array1::from_elem(d.ncols(), number::<F>(mu));
    let mu = penalties.first().and_then(|mu| mu.to_f64()).unwrap_or(f64::NAN);
    let lasso = Lasso::new(d.view(), penalties.view(), 0);
    let effort = Effort { steps, tolerance: F::zero() };
    for (solver, codes) in [("ista", lasso.ista(x.view(), effort)), ("fista", lasso.fista(x.view(), effort))]
    {
        let dense = wide(&codes.codes);
        let max = rows(&dictionary, &signals, &dense, |x, z| gap(&dictionary, x, z, mu));
        judge(solver, "duality gap, of half the signal's energy", &dense, max);
    }
}

/// The largest over signals; no number where one is none.
fn rows(
    dictionary: &Array2<f64>,
    signals: &Array2<f64>,
    codes: &Array2<f64>,
    each: impl Fn(ArrayView1<'_, f64>, ArrayView1<'_, f64>) -> f64,
) -> f64 {
    debug_assert_eq!(dictionary.ncols(), codes.ncols());
    let all = signals.outer_iter().zip(codes.outer_iter()).map(|(x, z)| each(x, z));
    all.fold(0.0, |max, v| if v <= max { max } else { v })
}

fn norm(v: &Array1<f64>) -> f64 {
    v.dot(v).sqrt()
}

/// What the best fit of some atoms leaves.
fn best_fit(dictionary: &Array2<f64>, support: &[usize], x: ArrayView1<'_, f64>) -> f64 {
    // Gram and Schmidt, twice, so that nearly parallel atoms do no harm.
    let mut axes: Vec<Array1<f64>> = vec![];
    for &atom in support {
        let mut axis = dictionary.column(atom).to_owned();
        let size = norm(&axis);
        for _ in 0..2 {
            axes.iter().for_each(|other| {
                let along = axis.dot(other);
                axis.scaled_add(-along, other);
            });
        }
        let own = norm(&axis);
        if own > 1e-12 * size {
            axes.push(axis / own);
        }
    }
    let mut rest = x.to_owned();
    axes.iter().for_each(|axis| {
        let along = rest.dot(axis);
        rest.scaled_add(-along, axis);
    });
    norm(&rest)
}

fn gap(dictionary: &Array2<f64>, x: ArrayView1<'_, f64>, z: ArrayView1<'_, f64>, mu: f64) -> f64 {
    let energy = 0.5 * x.dot(&x);
    if energy == 0.0 {
        return z.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
    }
    let rest = &x - &dictionary.dot(&z);
    let correlations = dictionary.t().dot(&rest).iter().fold(0.0f64, |max, v| max.max(v.abs()));
    if mu == 0.0 {
        let first = dictionary.t().dot(&x).iter().fold(0.0f64, |max, v| max.max(v.abs()));
        return correlations / first.max(f64::MIN_POSITIVE);
    }
    let dual = &rest * (mu / correlations.max(mu));
    let beside = &x - &dual;
    let primal = 0.5 * rest.dot(&rest) + mu * z.iter().map(|v| v.abs()).sum::<f64>();
    (primal - (energy - 0.5 * beside.dot(&beside))) / energy
}

/// k-SVD from a dictionary that nobody would start from.
pub(crate) fn learning(dictionary: Atoms, promise: &Promise) -> TrialResult {
    let start = atoms(dictionary).mapv(|v| v as f32);
    let signals = drawn(Signals::Exact, &atoms(Atoms::Drawn)).mapv(|v| v as f32);
    let before = (signals.mapv(|v| v * v).mean().unwrap_or(0.0)).sqrt();
    let fitted = ksvd(signals.view(), start, Settings { atoms: 3, rounds: 12, free: 0 });
    let finite = fitted.dictionary.iter().all(|v| v.is_finite());
    let mut seen = vec![Measurement::fact("k-svd.f32", "every atom is of finite numbers", finite)];
    if let (Some(last), Some(limit)) = (fitted.errors.last(), promise.limit("k-svd.f32")) {
        let left = last / f64::from(before);
        let note = format!("{} atoms replaced", fitted.replaced);
        seen.push(Measurement::new("k-svd.f32", "left of the signals", left, limit).noted(note));
    }
    TrialResult::of(seen)
}

fn uniform(draw: &mut Draw) -> f64 {
    draw.whole(-1_000_000, 1_000_000) as f64 * 1e-6
}

fn atoms(kind: Atoms) -> Array2<f64> {
    let draw = &mut Draw::new(11);
    let mut all = Array2::from_shape_fn((LENGTH, ATOMS), |_| uniform(draw));
    let third = |i: usize| i % 3 == 1;
    match kind {
        Atoms::Drawn | Atoms::Zeros | Atoms::NearZeros | Atoms::Scales => {}
        Atoms::Coherent => {
            let axis = all.column(0).to_owned();
            all.axis_iter_mut(Axis(1)).for_each(|mut atom| {
                let own = &atom * 1e-3 + &axis;
                atom.assign(&own);
            });
        }
        Atoms::Duplicates => {
            (0..ATOMS / 2).for_each(|i| {
                let twin = all.column(2 * i).to_owned();
                all.column_mut(2 * i + 1).assign(&twin);
            });
        }
        Atoms::RankDeficient => {
            let few = all.slice(ndarray::s![.., ..5]).to_owned();
            let mix = Array2::from_shape_fn((5, ATOMS), |_| uniform(draw));
            all = few.dot(&mix);
        }
        Atoms::HiddenEigenvalue => return hidden(),
    }
    all.axis_iter_mut(Axis(1)).for_each(|mut atom| {
        let size = atom.dot(&atom).sqrt();
        atom /= size;
    });
    for (i, mut atom) in all.axis_iter_mut(Axis(1)).enumerate() {
        match kind {
            Atoms::Zeros if third(i) => atom.fill(0.0),
            Atoms::NearZeros if third(i) => atom *= 1e-30,
            Atoms::Scales => atom *= 10f64.powi((i % 13) as i32 - 6),
            _ => {}
        }
    }
    all
}

/// D with DᵀD = I + 0.15·u·uᵀ, u at right angles to where the power iteration starts: it cannot see 1.15 before rounding shows it.
fn hidden() -> Array2<f64> {
    let start = Array1::from_shape_fn(LENGTH, |i| 1.0 + ((i * 7919) % 1013) as f64 / 1013.0);
    let mut axis = Array1::from_shape_fn(LENGTH, |i| if i % 2 == 0 { 1.0 } else { -1.0 });
    for _ in 0..2 {
        let along = axis.dot(&start) / start.dot(&start);
        axis.scaled_add(-along, &start);
    }
    let size = norm(&axis);
    axis /= size;
    let lift = 1.15f64.sqrt() - 1.0;
    Array2::from_shape_fn((LENGTH, LENGTH), |(r, c)| f64::from(u8::from(r == c)) + lift * axis[r] * axis[c])
}

fn drawn(kind: Signals, dictionary: &Array2<f64>) -> Array2<f64> {
    let draw = &mut Draw::new(13);
    let any = Array2::from_shape_fn((SIGNALS, dictionary.nrows()), |_| uniform(draw));
    match kind {
        Signals::Drawn => any,
        Signals::Zero => any * 0.0,
        Signals::Huge => any * 1e12,
        Signals::Tiny => any * 1e-12,
        Signals::Exact => {
            Array2::from_shape_fn((SIGNALS, 3), |_| draw.whole(0, dictionary.ncols() as i64 - 1) as usize)
                .outer_iter()
                .map(|chosen| {
                    let each = chosen.iter().enumerate();
                    each.fold(Array1::zeros(dictionary.nrows()), |sum: Array1<f64>, (i, atom)| {
                        sum + &dictionary.column(*atom) * (1.0 + i as f64)
                    })
                })
                .enumerate()
                .fold(Array2::zeros((SIGNALS, dictionary.nrows())), |mut all, (i, signal)| {
                    all.row_mut(i).assign(&signal);
                    all
                })
        }
    }
}

/// The condition number of DᵀD, lifted pivots and all, for remarks.
pub(crate) fn condition(moments: &Array2<f64>) -> f64 {
    let inverse = Cholesky::of_moments(moments.view()).solve(Array2::eye(moments.nrows()).view());
    let largest = |matrix: &Array2<f64>| edof_numerics::largest_eigenvalue(matrix.view());
    largest(moments) * largest(&inverse)
}
