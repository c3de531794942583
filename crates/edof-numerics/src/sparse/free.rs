//! Atoms that every signal may use for nothing, such as its mean: taken out of signals and dictionary before a pursuit and fitted
//! after it. What is left is another pursuit, orthogonal to them, with the same minimum (Frisch, Waugh and Lovell's theorem).

use crate::Cholesky;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, NdFloat, linalg::general_mat_mul, s};

/// The first atoms of a dictionary, free of charge.
#[derive(Debug, Clone)]
pub(crate) struct Free<F> {
    /// Free atoms as rows: free × length.
    atoms: Array2<F>,
    /// Least-squares codes of the free atoms of a signal: length × free.
    fit: Array2<F>,
    /// What each atom of the whole dictionary takes from them: all atoms × free.
    shares: Array2<F>,
}

/// A number of `f64` in `F`.
pub(crate) fn number<F: NdFloat>(value: f64) -> F {
    F::from(value).unwrap_or_else(|| unreachable!("every float holds an f64, rounded"))
}

/// Σ uᵢ·vᵢ. Slices that lie side by side are summed as vectors.
pub(crate) fn dot<F: NdFloat>(u: &[F], v: &[F]) -> F {
    ndarray::ArrayView1::from(u).dot(&ndarray::ArrayView1::from(v))
}

impl<F: NdFloat> Free<F> {
    /// The first `free` atoms of a dictionary (length × atoms). Atoms that say the same share their code.
    pub(crate) fn new(dictionary: ArrayView2<'_, F>, free: usize) -> Self {
        let own = dictionary.slice(s![.., ..free]);
        let wide = own.mapv(|v| v.to_f64().unwrap_or(f64::NAN));
        let mut gram = wide.t().dot(&wide);
        let lift = 1e-12 * gram.diag().iter().copied().fold(0.0, f64::max);
        gram.diag_mut().mapv_inplace(|v| v + lift);
        let fit = Cholesky::of_moments(gram.view()).solve(wide.t().view()).t().mapv(number::<F>);
        let shares = dictionary.t().dot(&fit);
        Self { atoms: own.t().to_owned(), fit, shares }
    }

    pub(crate) fn len(&self) -> usize {
        self.atoms.nrows()
    }

    /// The dictionary's other atoms (length × rest) without their share of these.
    pub(crate) fn others(&self, dictionary: ArrayView2<'_, F>) -> Array2<F> {
        let free = self.len();
        let mut others = dictionary.slice(s![.., free..]).to_owned();
        if free > 0 {
            let shares = self.shares.slice(s![free.., ..]);
            general_mat_mul(-F::one(), &self.atoms.t(), &shares.t(), F::one(), &mut others);
        }
        others
    }

    /// Takes the free atoms out of signals (rows); their codes (signals × free) go to `codes`.
    pub(crate) fn take_out(&self, signals: &mut ArrayViewMut2<'_, F>, codes: &mut ArrayViewMut2<'_, F>) {
        if self.len() > 0 {
            general_mat_mul(F::one(), signals, &self.fit, F::zero(), codes);
            general_mat_mul(-F::one(), codes, &self.atoms, F::one(), signals);
        }
    }

    /// What each of the free atoms changes by where atom `other` (counted among all) is used once: the share that [`Self::others`]
    /// took from it.
    pub(crate) fn shares_of(&self, other: usize) -> &[F] {
        let free = self.len();
        self.shares.as_slice().map_or(&[], |all| &all[other * free..(other + 1) * free])
    }
}
