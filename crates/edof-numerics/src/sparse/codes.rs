//! Sparse codes in little room: places and values of what is not zero.

use ndarray::{Array2, ArrayView2, ArrayViewMut1, Axis, NdFloat};
use rayon::prelude::*;

/// Sparse codes of many signals, each of N non-zeros at most.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseCodes<F> {
    pub(crate) max: usize,
    pub(crate) counts: Vec<usize>,
    /// `max` places a signal, of which its count is in use.
    pub(crate) atoms: Vec<u32>,
    pub(crate) values: Vec<F>,
}

impl<F: NdFloat> SparseCodes<F> {
    pub(crate) fn zeros(signals: usize, max: usize) -> Self {
        Self {
            max,
            counts: vec![0; signals],
            atoms: vec![0; signals * max],
            values: vec![F::zero(); signals * max],
        }
    }

    /// How many signals there are.
    #[must_use]
    pub const fn signals(&self) -> usize {
        self.counts.len()
    }

    /// Atoms of one signal and what each is multiplied by, in the order in which they were chosen.
    #[must_use]
    pub fn of(&self, signal: usize) -> (&[u32], &[F]) {
        let used = signal * self.max..signal * self.max + self.counts[signal];
        (&self.atoms[used.clone()], &self.values[used])
    }

    /// Atoms in use, all signals together.
    #[must_use]
    pub fn nonzeros(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Signals × `atoms`, zeros and all.
    #[must_use]
    pub fn to_dense(&self, atoms: usize) -> Array2<F> {
        let mut dense = Array2::zeros((self.signals(), atoms));
        for (signal, mut row) in dense.axis_iter_mut(Axis(0)).enumerate() {
            let (atoms, values) = self.of(signal);
            atoms.iter().zip(values).for_each(|(&atom, &value)| row[atom as usize] = value);
        }
        dense
    }

    /// The signals (signals × length) that the codes stand for in a dictionary whose atoms are rows (atoms × length).
    #[must_use]
    pub fn synthesis(&self, atoms: ArrayView2<'_, F>) -> Array2<F> {
        let length = atoms.ncols();
        let mut signals = Array2::zeros((self.signals(), length));
        if let Some(values) = signals.as_slice_mut().filter(|values| !values.is_empty()) {
            values.par_chunks_mut(length).enumerate().for_each(|(signal, row)| {
                self.add_to(signal, atoms, ArrayViewMut1::from(row));
            });
        }
        signals
    }

    /// Adds what one signal's codes stand for.
    pub(crate) fn add_to(&self, signal: usize, atoms: ArrayView2<'_, F>, mut sum: ArrayViewMut1<'_, F>) {
        let (chosen, values) = self.of(signal);
        chosen
            .iter()
            .zip(values)
            .for_each(|(&atom, &value)| sum.scaled_add(value, &atoms.row(atom as usize)));
    }
}
