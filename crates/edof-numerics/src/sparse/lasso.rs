//! Sparse codes by convex optimisation: for each signal x the z that minimises ½‖x − D·z‖² + Σᵢ μᵢ·|zᵢ|, by gradient steps of
//! length 1/L, each followed by a soft threshold.
//!
//! [`Lasso::ista`] is plain (I. Daubechies, M. Defrise, C. De Mol 2004); [`Lasso::fista`] steps from a point beyond the last one
//! (A. Beck, M. Teboulle 2009, eq. 4.1 to 4.3) and needs the square root of as many steps.

use crate::largest_eigenvalue;
use crate::sparse::free::{Free, number};
use ndarray::{
    Array1, Array2, ArrayView1, ArrayView2, ArrayViewMut2, NdFloat, Zip, linalg::general_mat_mul, s,
};
use rayon::prelude::*;

/// How much larger than what is found for the largest eigenvalue of DᵀD L is taken: ten times as much as the search may miss it by, and as
/// sums of `f32` may make a step too long.
const MARGIN: f64 = 1.01;
/// Signals that one thread takes at a time.
const CHUNK: usize = 64;

/// L, above the eigenvalues of a symmetric matrix by a margin: what is found for the largest one comes from below, within a thousandth
/// ([`largest_eigenvalue`] states what holds), and is taken 1.01 times. A step of 1/L then goes down; up to 2/L none diverges.
#[must_use]
pub fn step_bound<F: NdFloat>(gram: ArrayView2<'_, F>) -> F {
    number(largest_eigenvalue(gram.mapv(|v| v.to_f64().unwrap_or(f64::NAN)).view()) * MARGIN)
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort<F> {
    /// The most steps.
    pub steps: usize,
    /// Enough once no code of the signals that are taken together moves by more than this in a step.
    pub tolerance: F,
}

/// Codes, and how many steps they took.
#[derive(Debug, Clone, PartialEq)]
pub struct Descent<F> {
    /// Signals × atoms.
    pub codes: Array2<F>,
    /// Steps, added up over signals.
    pub steps: u64,
}

/// A dictionary and penalties, ready for signals.
///
/// ```
/// use edof_numerics::sparse::lasso::{Effort, Lasso};
/// use ndarray::array;
/// let lasso = Lasso::new(array![[1.0, 0.0], [0.0, 1.0]].view(), array![1.0, 1.0].view(), 0);
/// let codes = lasso.fista(array![[3.0, 0.5]].view(), Effort { steps: 100, tolerance: 1e-9 }).codes;
/// assert!((codes[(0, 0)] - 2.0_f64).abs() < 1e-6 && codes[(0, 1)] == 0.0);
/// ```
#[derive(Debug, Clone)]
pub struct Lasso<F> {
    free: Free<F>,
    /// Length × atoms, free ones left out.
    atoms: Array2<F>,
    /// DᵀD where it is the shorter way from codes to correlations.
    gram: Option<Array2<F>>,
    penalties: Array1<F>,
    /// 1/L.
    step: F,
}

impl<F: NdFloat> Lasso<F> {
    /// For a dictionary (length × atoms) and μ, one an atom; an atom of penalty 0 costs nothing. The first `free` atoms cost nothing
    /// whatever their μ, and are eliminated rather than pursued: the same minimum in fewer steps, because such atoms (the mean,
    /// above all) are what makes L large.
    ///
    /// # Panics
    /// If there are not as many penalties as atoms, or fewer atoms than free ones: mistakes of the caller.
    #[must_use]
    pub fn new(dictionary: ArrayView2<'_, F>, penalties: ArrayView1<'_, F>, free: usize) -> Self {
        assert_eq!(dictionary.ncols(), penalties.len(), "one penalty an atom");
        let penalties = penalties.slice(s![free..]).to_owned();
        let free = Free::new(dictionary, free);
        let atoms = free.others(dictionary);
        let gram = atoms.t().dot(&atoms);
        // λmax(DᵀD) = λmax(D·Dᵀ); the smaller of the two is as good.
        let (length, count) = atoms.dim();
        let bound =
            if count <= length { step_bound(gram.view()) } else { step_bound(atoms.dot(&atoms.t()).view()) };
        let step = F::one() / bound.max(F::min_positive_value());
        Self { free, gram: (count <= 2 * length).then_some(gram), atoms, penalties, step }
    }

    /// Iterative shrinkage and thresholding, from 0.
    #[must_use]
    pub fn ista(&self, signals: ArrayView2<'_, F>, effort: Effort<F>) -> Descent<F> {
        self.descend(signals, effort, false)
    }

    /// Fast iterative shrinkage and thresholding, from 0.
    #[must_use]
    pub fn fista(&self, signals: ArrayView2<'_, F>, effort: Effort<F>) -> Descent<F> {
        self.descend(signals, effort, true)
    }

    fn descend(&self, signals: ArrayView2<'_, F>, effort: Effort<F>, fast: bool) -> Descent<F> {
        let free = self.free.len();
        let columns = free + self.atoms.ncols();
        let mut codes = Array2::zeros((signals.nrows(), columns));
        let steps = codes.as_slice_mut().filter(|all| !all.is_empty()).map_or(0, |all| {
            all.par_chunks_mut(CHUNK * columns)
                .enumerate()
                .map_init(
                    || Workspace::new(self),
                    |room, (chunk, codes)| {
                        let count = codes.len() / columns;
                        let signals = signals.slice(s![chunk * CHUNK..chunk * CHUNK + count, ..]);
                        let steps = room.descend(self, signals, effort, fast);
                        room.write(self, codes);
                        (steps * count) as u64
                    },
                )
                .sum()
        });
        Descent { codes, steps }
    }
}

/// σ_θ: toward zero by θ.
pub(crate) fn shrink<F: NdFloat>(value: F, theta: F) -> F {
    (value - theta).max(F::zero()) + (value + theta).min(F::zero())
}

/// Workspace of one thread, allocated once.
struct Workspace<F> {
    count: usize,
    rest: Array2<F>,
    free_codes: Array2<F>,
    /// Dᵀx.
    correlations: Array2<F>,
    /// D·y, where DᵀD is not available.
    synthesis: Array2<F>,
    /// DᵀD·y.
    toward: Array2<F>,
    z: Array2<F>,
    /// Where the gradient is taken; beyond z, or z itself.
    y: Array2<F>,
}

impl<F: NdFloat> Workspace<F> {
    fn new(lasso: &Lasso<F>) -> Self {
        let (length, atoms) = lasso.atoms.dim();
        let wide = || Array2::zeros((CHUNK, atoms));
        let rest = Array2::zeros((CHUNK, length));
        let free_codes = Array2::zeros((CHUNK, lasso.free.len()));
        let synthesis = rest.clone();
        Self {
            count: 0,
            rest,
            free_codes,
            correlations: wide(),
            synthesis,
            toward: wide(),
            z: wide(),
            y: wide(),
        }
    }

    /// Codes of a chunk of signals; how many steps that took.
    fn descend(
        &mut self,
        lasso: &Lasso<F>,
        signals: ArrayView2<'_, F>,
        effort: Effort<F>,
        fast: bool,
    ) -> usize {
        self.count = signals.nrows();
        let part = s![..self.count, ..];
        let mut rest: ArrayViewMut2<'_, F> = self.rest.slice_mut(part);
        rest.assign(&signals);
        lasso.free.take_out(&mut rest, &mut self.free_codes.slice_mut(part));
        general_mat_mul(F::one(), &rest, &lasso.atoms, F::zero(), &mut self.correlations.slice_mut(part));
        self.z.fill(F::zero());
        self.y.fill(F::zero());
        let mut momentum = F::one();
        for step in 1..=effort.steps {
            self.look(lasso);
            let next = (F::one() + (F::one() + number::<F>(4.0) * momentum * momentum).sqrt()) / number(2.0);
            let beyond = if fast { (momentum - F::one()) / next } else { F::zero() };
            momentum = next;
            if self.step(lasso, beyond) <= effort.tolerance {
                return step;
            }
        }
        effort.steps
    }

    /// DᵀD·y by the shorter way.
    fn look(&mut self, lasso: &Lasso<F>) {
        let part = s![..self.count, ..];
        let (y, mut toward) = (self.y.slice(part), self.toward.slice_mut(part));
        if let Some(gram) = &lasso.gram {
            general_mat_mul(F::one(), &y, gram, F::zero(), &mut toward);
        } else {
            let mut synthesis = self.synthesis.slice_mut(part);
            general_mat_mul(F::one(), &y, &lasso.atoms.t(), F::zero(), &mut synthesis);
            general_mat_mul(F::one(), &synthesis, &lasso.atoms, F::zero(), &mut toward);
        }
    }

    /// z ← σ(y + (1/L)·Dᵀ(x − D·y)), y ← z + `beyond`·(z − z before); the largest change of a code.
    fn step(&mut self, lasso: &Lasso<F>, beyond: F) -> F {
        let mut max = F::zero();
        let step = lasso.step;
        let rows = self.z.outer_iter_mut().zip(self.y.outer_iter_mut());
        let seen = self.toward.outer_iter().zip(self.correlations.outer_iter());
        for ((mut z, mut y), (toward, correlations)) in rows.zip(seen).take(self.count) {
            Zip::from(&mut z).and(&mut y).and(&toward).and(&correlations).and(&lasso.penalties).for_each(
                |z, y, &g, &b, &mu| {
                    let next = shrink(*y + step * (b - g), step * mu);
                    let change = next - *z;
                    max = max.max(change.abs());
                    *y = next + beyond * change;
                    *z = next;
                },
            );
        }
        max
    }

    /// Writes a chunk's codes, the free ones fitted to what is left.
    fn write(&self, lasso: &Lasso<F>, codes: &mut [F]) {
        let free = lasso.free.len();
        for (i, code) in codes.chunks_exact_mut(free + lasso.atoms.ncols()).enumerate() {
            let (own, others) = code.split_at_mut(free);
            own.iter_mut().zip(self.free_codes.row(i)).for_each(|(code, &value)| *code = value);
            for (atom, (code, &value)) in others.iter_mut().zip(self.z.row(i)).enumerate() {
                *code = value;
                let shares = lasso.free.shares_of(free + atom);
                own.iter_mut().zip(shares).for_each(|(code, &share)| *code -= value * share);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LENGTH: usize = 8;

    /// Dictionaries of few atoms (pursued by DᵀD) and of many (pursued by D and Dᵀ), none of them nearly singular.
    fn dictionary() -> impl Strategy<Value = Array2<f64>> {
        prop::sample::select(vec![5usize, 20]).prop_flat_map(|atoms| {
            prop::collection::vec(-1.0f64..1.0, LENGTH * atoms).prop_map(move |v| {
                let noise = Array2::from_shape_vec((LENGTH, atoms), v).unwrap();
                noise
                    + Array2::from_shape_fn((LENGTH, atoms), |(r, c)| if r == c % LENGTH { 1.0 } else { 0.0 })
            })
        })
    }

    fn signals() -> impl Strategy<Value = Array2<f64>> {
        prop::collection::vec(-1.0f64..1.0, 3 * LENGTH)
            .prop_map(|v| Array2::from_shape_vec((3, LENGTH), v).unwrap())
    }

    fn penalties(dictionary: &Array2<f64>, free: usize) -> Array1<f64> {
        Array1::from_shape_fn(
            dictionary.ncols(),
            |i| if i < free { 0.0 } else { 0.05 + 0.03 * (i % 7) as f64 },
        )
    }

    fn objective(d: &Array2<f64>, x: &Array2<f64>, mu: &Array1<f64>, z: &Array2<f64>) -> f64 {
        let rest = x - &z.dot(&d.t());
        0.5 * (&rest * &rest).sum() + (z.mapv(f64::abs) * mu).sum()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Karush, Kuhn, Tucker: with r = Dᵀ(x − D·z), every rᵢ is within ±μᵢ, and it is μᵢ·sign(zᵢ) where zᵢ is not 0. For both
        /// methods, with free atoms pursued and eliminated.
        #[test]
        fn codes_meet_the_conditions_of_the_minimum(
            dictionary in dictionary(), signals in signals(), free in 0usize..3, fast: bool, eliminated: bool
        ) {
            let mu = penalties(&dictionary, free);
            let lasso = Lasso::new(dictionary.view(), mu.view(), if eliminated { free } else { 0 });
            let effort = Effort { steps: 6000, tolerance: 1e-11 };
            let (z, near) = if fast {
                (lasso.fista(signals.view(), effort).codes, 1e-4)
            } else {
                (lasso.ista(signals.view(), effort).codes, 3e-3)
            };
            let r = (&signals - &z.dot(&dictionary.t())).dot(&dictionary);
            for ((_, atom), (&z, &r)) in z.indexed_iter().map(|(at, z)| (at, (z, &r[at]))) {
                let mu = mu[atom];
                prop_assert!(r.abs() <= mu + near, "atom {atom}: {r} beyond {mu}");
                prop_assert!(z == 0.0 || (r - mu * z.signum()).abs() < near, "atom {atom}: z {z}, {r} for {mu}");
            }
        }

        /// Theorem 3.1 of Beck and Teboulle for ISTA, 4.4 for FISTA: after k steps the objective is within L‖z*‖²/2k, and
        /// 2L‖z*‖²/(k + 1)², of its minimum.
        #[test]
        fn the_published_rates_hold(dictionary in dictionary(), signals in signals(), steps in 1usize..200) {
            let mu = penalties(&dictionary, 0);
            let lasso = Lasso::new(dictionary.view(), mu.view(), 0);
            let best = lasso.fista(signals.view(), Effort { steps: 6000, tolerance: 1e-12 }).codes;
            let effort = Effort { steps, tolerance: 0.0 };
            let over = |z: &Array2<f64>| objective(&dictionary, &signals, &mu, z) - objective(&dictionary, &signals, &mu, &best);
            let size = (&best * &best).sum() / lasso.step;
            let k = steps as f64;
            prop_assert!(over(&lasso.ista(signals.view(), effort).codes) <= size / (2.0 * k) + 1e-7);
            prop_assert!(over(&lasso.fista(signals.view(), effort).codes) <= 2.0 * size / (k + 1.0).powi(2) + 1e-7);
        }

        #[test]
        fn eliminating_free_atoms_changes_no_code(dictionary in dictionary(), signals in signals()) {
            let mu = penalties(&dictionary, 2);
            let effort = Effort { steps: 6000, tolerance: 1e-11 };
            // Codes may be ambiguous where atoms outnumber the length; what they stand for is not.
            let [pursued, eliminated] = [0, 2].map(|free| {
                Lasso::new(dictionary.view(), mu.view(), free).fista(signals.view(), effort).codes.dot(&dictionary.t())
            });
            prop_assert!((&pursued - &eliminated).iter().all(|e| e.abs() < 1e-4));
        }
    }

    #[test]
    fn fista_is_nearer_after_as_many_steps() {
        let d = Array2::from_shape_fn((16, 24), |(r, c)| ((r * 7 + c * 5 + r * c) % 13) as f64 / 6.0 - 1.0);
        let x = Array2::from_shape_fn((9, 16), |(r, c)| ((r * 11 + c * 3) % 17) as f64 / 8.0 - 1.0);
        let mu = Array1::from_elem(24, 0.02);
        let lasso = Lasso::new(d.view(), mu.view(), 0);
        let effort = Effort { steps: 60, tolerance: 0.0 };
        let [slow, fast] = [lasso.ista(x.view(), effort), lasso.fista(x.view(), effort)]
            .map(|r| objective(&d, &x, &mu, &r.codes));
        let min =
            objective(&d, &x, &mu, &lasso.fista(x.view(), Effort { steps: 20_000, tolerance: 0.0 }).codes);
        assert!(fast - min < 0.3 * (slow - min), "{fast} {slow} {min}");
    }

    #[test]
    fn it_stops_once_codes_stand_still_and_says_when() {
        let d: Array2<f32> = Array2::eye(6);
        let x = Array2::from_elem((130, 6), 0.7);
        let descent = Lasso::new(d.view(), Array1::from_elem(6, 0.1).view(), 0)
            .ista(x.view(), Effort { steps: 1000, tolerance: 1e-4 });
        assert!(descent.steps >= 2 * 130 && descent.steps < 10 * 130, "{}", descent.steps);
    }

    #[test]
    fn a_larger_penalty_leaves_fewer_codes() {
        let d = Array2::from_shape_fn((6, 6), |(r, c)| if r == c { 1.0f32 } else { 0.1 });
        let x = Array2::from_shape_fn((4, 6), |(r, c)| (r * 5 + c * 3) as f32 % 7.0 / 7.0);
        let used = |mu: f32| {
            let lasso = Lasso::new(d.view(), Array1::from_elem(6, mu).view(), 0);
            let z = lasso.ista(x.view(), Effort { steps: 500, tolerance: 0.0 }).codes;
            z.iter().filter(|z| **z != 0.0).count()
        };
        assert!(used(0.3) < used(0.01));
    }
}
