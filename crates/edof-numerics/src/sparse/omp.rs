//! Orthogonal matching pursuit: one atom after the other, the best fit of all chosen so far in between.
//!
//! Batch-OMP with progressive Cholesky factors (R. Rubinstein, M. Zibulevsky, M. Elad, "Efficient implementation of the K-SVD
//! algorithm using batch orthogonal matching pursuit", Technion CS-2008-08): signals share DᵀD, and after Dᵀx no signal is looked
//! at again.

use crate::sparse::codes::SparseCodes;
use crate::sparse::free::{Free, dot};
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, NdFloat, linalg::general_mat_mul, s};
use rayon::prelude::*;

/// Signals that one thread takes at a time.
const CHUNK: usize = 64;

/// When a pursuit has done enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop<F> {
    /// The most atoms for a signal, free ones not counted.
    pub atoms: usize,
    /// The norm of what is left of a signal. It is followed by subtraction: below √ε of the signal's own norm it is noise, which
    /// is 3·10⁻⁴ for `f32`.
    pub residual: F,
}

impl<F: NdFloat> Stop<F> {
    /// After N atoms.
    #[must_use]
    pub fn at_atoms(atoms: usize) -> Self {
        Self { atoms, residual: F::zero() }
    }
}

/// A dictionary ready for pursuits.
///
/// ```
/// use edof_numerics::sparse::omp::{Omp, Stop};
/// use ndarray::array;
/// let dictionary = array![[1.0, 0.0, 0.6], [0.0, 1.0, 0.8]];
/// let codes = Omp::new(dictionary.view(), 0).codes(array![[1.2, 1.6]].view(), Stop::at_atoms(1));
/// assert_eq!(codes.of(0), (&[2][..], &[2.0][..]));
/// ```
#[derive(Debug, Clone)]
pub struct Omp<F> {
    free: Free<F>,
    /// Length × atoms, free ones left out, of norm 1; an atom of nothing stays one.
    atoms: Array2<F>,
    gram: Array2<F>,
    /// What each atom was divided by.
    norms: Vec<F>,
}

impl<F: NdFloat> Omp<F> {
    /// For a dictionary (length × atoms) whose first `free` atoms belong to every code.
    ///
    /// # Panics
    /// If there are fewer atoms than free ones, or the free ones are not finite: mistakes of the caller.
    #[must_use]
    pub fn new(dictionary: ArrayView2<'_, F>, free: usize) -> Self {
        let free = Free::new(dictionary, free);
        let mut atoms = free.others(dictionary);
        let norms = atoms.axis_iter_mut(Axis(1)).zip(dictionary.axis_iter(Axis(1)).skip(free.len())).map(
            |(mut atom, whole)| {
                let norm = atom.dot(&atom).sqrt();
                // What is left of an atom that the free ones explain is rounding.
                if norm > F::epsilon().sqrt() * whole.dot(&whole).sqrt() {
                    atom.mapv_inplace(|v| v / norm);
                } else {
                    atom.fill(F::zero());
                }
                norm
            },
        );
        let norms = norms.collect();
        let gram = atoms.t().dot(&atoms);
        Self { free, atoms, gram, norms }
    }

    /// Sparse codes of signals (signals × length), on all threads; each depends on its own signal alone.
    ///
    /// # Panics
    /// If signals and atoms differ in length: a mistake of the caller.
    #[must_use]
    pub fn codes(&self, signals: ArrayView2<'_, F>, stop: Stop<F>) -> SparseCodes<F> {
        assert_eq!(signals.ncols(), self.atoms.nrows(), "signals and atoms differ in length");
        let free = self.free.len();
        // No more than the length can be independent.
        let max = free + stop.atoms.min(self.atoms.nrows()).min(self.atoms.ncols());
        let mut codes = SparseCodes::zeros(signals.nrows(), max);
        if max == 0 {
            return codes;
        }
        let parts = codes
            .counts
            .par_chunks_mut(CHUNK)
            .zip(codes.atoms.par_chunks_mut(CHUNK * max))
            .zip(codes.values.par_chunks_mut(CHUNK * max))
            .enumerate();
        parts.for_each_init(
            || Workspace::new(self, max - free),
            |room, (chunk, ((counts, atoms), values))| {
                let signals = signals.slice(s![chunk * CHUNK..chunk * CHUNK + counts.len(), ..]);
                room.correlate(self, signals);
                let places = atoms.chunks_exact_mut(max).zip(values.chunks_exact_mut(max));
                for (i, (count, (atoms, values))) in counts.iter_mut().zip(places).enumerate() {
                    room.pursue(self, i, stop);
                    *count = room.write(self, i, atoms, values);
                }
            },
        );
        codes
    }
}

/// Workspace of one thread, allocated once.
struct Workspace<F> {
    max: usize,
    /// Signals without their free part, and the codes of that.
    rest: Array2<F>,
    free_codes: Array2<F>,
    /// Dᵀx of the signals of a chunk.
    first: Array2<F>,
    /// Dᵀ of what is left of the signal at work.
    now: Vec<F>,
    support: Vec<usize>,
    /// L of L·Lᵀ = DᵀD on the support, rows of `max`.
    factor: Vec<F>,
    /// L⁻¹·Dᵀx on the support: only its last entry is new after each atom.
    half_way: Vec<F>,
    /// Codes on the support.
    solution: Vec<F>,
}

impl<F: NdFloat> Workspace<F> {
    fn new(omp: &Omp<F>, max: usize) -> Self {
        let (length, atoms) = omp.atoms.dim();
        Self {
            max,
            rest: Array2::zeros((CHUNK, length)),
            free_codes: Array2::zeros((CHUNK, omp.free.len())),
            first: Array2::zeros((CHUNK, atoms)),
            now: vec![F::zero(); atoms],
            support: Vec::with_capacity(max),
            factor: vec![F::zero(); max * max],
            half_way: vec![F::zero(); max],
            solution: vec![F::zero(); max],
        }
    }

    /// Free part and correlations of a chunk's signals.
    fn correlate(&mut self, omp: &Omp<F>, signals: ArrayView2<'_, F>) {
        let count = signals.nrows();
        let mut rest: ArrayViewMut2<'_, F> = self.rest.slice_mut(s![..count, ..]);
        rest.assign(&signals);
        omp.free.take_out(&mut rest, &mut self.free_codes.slice_mut(s![..count, ..]));
        general_mat_mul(F::one(), &rest, &omp.atoms, F::zero(), &mut self.first.slice_mut(s![..count, ..]));
    }

    /// Support and solution of one signal of the chunk.
    fn pursue(&mut self, omp: &Omp<F>, signal: usize, stop: Stop<F>) {
        self.support.clear();
        let rest = self.rest.row(signal);
        let energy = rest.dot(&rest);
        let enough = stop.residual * stop.residual;
        let mut left = energy;
        let first = self.first.row(signal);
        let Some(first) = first.as_slice() else { return };
        self.now.copy_from_slice(first);
        while self.support.len() < self.max && left > enough {
            let Some(atom) = strongest(&self.now) else { return };
            if !extend(&mut self.factor, self.max, &self.support, omp, atom) {
                return;
            }
            let n = self.support.len();
            self.support.push(atom);
            let row = &self.factor[n * self.max..];
            self.half_way[n] = (first[atom] - dot(&row[..n], &self.half_way[..n])) / row[n];
            solve_upper(&self.factor, self.max, &self.half_way[..=n], &mut self.solution);
            self.now.copy_from_slice(first);
            for (&chosen, &value) in self.support.iter().zip(&self.solution) {
                let gram = omp.gram.row(chosen);
                self.now.iter_mut().zip(gram).for_each(|(now, &g)| *now -= value * g);
            }
            // ‖D·z‖² = ‖L⁻¹·Dᵀx‖².
            left = energy - dot(&self.half_way[..=n], &self.half_way[..=n]);
        }
    }

    /// Writes the code of a signal; how many places it takes.
    fn write(&self, omp: &Omp<F>, signal: usize, atoms: &mut [u32], values: &mut [F]) -> usize {
        let free = omp.free.len();
        for i in 0..free {
            (atoms[i], values[i]) = (i as u32, self.free_codes[(signal, i)]);
        }
        for (place, (&atom, &value)) in self.support.iter().zip(&self.solution).enumerate() {
            let value = value / omp.norms[atom];
            (atoms[free + place], values[free + place]) = ((free + atom) as u32, value);
            let shares = omp.free.shares_of(free + atom);
            values[..free].iter_mut().zip(shares).for_each(|(code, &share)| *code -= value * share);
        }
        free + self.support.len()
    }
}

/// Where the largest magnitude stands, the first of equals; nowhere if all are zero or one is NaN.
fn strongest<F: NdFloat>(values: &[F]) -> Option<usize> {
    // Lanes, so that the compiler may take them at once.
    let mut peaks = [F::zero(); 16];
    let lanes = values.chunks_exact(16);
    let rest = lanes.remainder().iter().fold(F::zero(), |m, v| m.max(v.abs()));
    for lane in lanes {
        for (peak, value) in peaks.iter_mut().zip(lane) {
            let size = value.abs();
            *peak = if size > *peak { size } else { *peak };
        }
    }
    let peak = peaks.into_iter().fold(rest, F::max);
    if peak > F::zero() { values.iter().position(|v| v.abs() == peak) } else { None }
}

/// Adds an atom's row to the factor; false if the support explains the atom, which then cannot make anything better.
fn extend<F: NdFloat>(factor: &mut [F], max: usize, support: &[usize], omp: &Omp<F>, atom: usize) -> bool {
    let n = support.len();
    let (known, row) = factor.split_at_mut(n * max);
    for (j, &other) in support.iter().enumerate() {
        let line = &known[j * max..];
        row[j] = (omp.gram[(other, atom)] - dot(&line[..j], &row[..j])) / line[j];
    }
    let pivot = F::one() - dot(&row[..n], &row[..n]);
    if pivot.is_nan() || pivot <= F::epsilon().sqrt() {
        return false;
    }
    row[n] = pivot.sqrt();
    true
}

/// z of Lᵀ·z = `half_way`.
fn solve_upper<F: NdFloat>(factor: &[F], max: usize, half_way: &[F], z: &mut [F]) {
    for i in (0..half_way.len()).rev() {
        let below = (i + 1..half_way.len()).fold(F::zero(), |sum, j| sum + factor[j * max + i] * z[j]);
        z[i] = (half_way[i] - below) / factor[i * max + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cholesky;
    use proptest::prelude::*;

    const LENGTH: usize = 9;
    const ATOMS: usize = 14;

    fn matrix(rows: usize, columns: usize) -> impl Strategy<Value = Array2<f64>> {
        prop::collection::vec(-1.0f64..1.0, rows * columns)
            .prop_map(move |v| Array2::from_shape_vec((rows, columns), v).unwrap())
    }

    /// The pursuit as textbooks have it: all chosen atoms fitted anew to the signal after each choice.
    fn slow(dictionary: &Array2<f64>, signal: &[f64], atoms: usize) -> Array2<f64> {
        let x = Array2::from_shape_vec((LENGTH, 1), signal.to_vec()).unwrap();
        let (mut support, mut rest) = (vec![], x.clone());
        let mut code = Array2::zeros((1, dictionary.ncols()));
        for _ in 0..atoms {
            let gain = |j: usize| {
                let atom = dictionary.column(j);
                (atom.dot(&rest.column(0)) / atom.dot(&atom).sqrt()).abs()
            };
            support.push((0..dictionary.ncols()).max_by(|&a, &b| gain(a).total_cmp(&gain(b))).unwrap());
            let chosen = dictionary.select(Axis(1), &support);
            let z = Cholesky::of_moments(chosen.t().dot(&chosen).view()).solve(chosen.t().dot(&x).view());
            rest = &x - &chosen.dot(&z);
            code.fill(0.0);
            support.iter().zip(&z).for_each(|(&j, &v)| code[(0, j)] = v);
        }
        code
    }

    proptest! {
        #[test]
        fn it_chooses_and_fits_as_the_textbook_does(
            dictionary in matrix(LENGTH, ATOMS), signals in matrix(3, LENGTH), atoms in 1usize..6
        ) {
            let fast = Omp::new(dictionary.view(), 0).codes(signals.view(), Stop::at_atoms(atoms)).to_dense(ATOMS);
            for (row, signal) in signals.outer_iter().enumerate() {
                let slow = slow(&dictionary, signal.as_slice().unwrap(), atoms);
                let error = (&fast.row(row) - &slow.row(0)).fold(0.0f64, |m, v| m.max(v.abs()));
                let largest = slow.fold(1.0f64, |m, v| m.max(v.abs()));
                prop_assert!(error < 1e-6 * largest, "{error}");
            }
        }

        /// With free atoms and without: no chosen or free atom correlates with what is left.
        #[test]
        fn what_is_left_is_orthogonal_to_the_support(
            dictionary in matrix(LENGTH, ATOMS), signals in matrix(70, LENGTH), free in 0usize..3
        ) {
            let codes = Omp::new(dictionary.view(), free).codes(signals.view(), Stop::at_atoms(3));
            let rest = &signals - &codes.synthesis(dictionary.t());
            for (signal, rest) in rest.outer_iter().enumerate() {
                let (atoms, values) = codes.of(signal);
                prop_assert_eq!(atoms.len(), free + 3);
                let size = values.iter().fold(1.0f64, |m, v| m.max(v.abs()));
                for &atom in atoms {
                    let along = rest.dot(&dictionary.column(atom as usize));
                    prop_assert!(along.abs() < 1e-7 * size, "{along} of atom {atom}");
                }
            }
        }

        #[test]
        fn it_continues_until_little_enough_is_left(
            dictionary in matrix(LENGTH, ATOMS), signals in matrix(5, LENGTH), residual in 0.01f64..1.5
        ) {
            let left = |atoms| {
                let codes = Omp::new(dictionary.view(), 0).codes(signals.view(), Stop { atoms, residual });
                let rest = &signals - &codes.synthesis(dictionary.t());
                let norms: Vec<f64> = rest.outer_iter().map(|r| r.dot(&r).sqrt()).collect();
                (codes, norms)
            };
            let (codes, norms) = left(ATOMS);
            for (signal, norm) in norms.iter().enumerate() {
                prop_assert!(*norm <= residual + 1e-6, "{norm}");
                let used = codes.of(signal).0.len();
                if used > 0 {
                    prop_assert!(left(used - 1).1[signal] > residual - 1e-6, "one atom fewer would have done");
                }
            }
        }

        #[test]
        fn a_free_atom_in_a_signal_changes_its_own_code_alone(
            dictionary in matrix(LENGTH, ATOMS), signals in matrix(4, LENGTH), more in -3.0f64..3.0
        ) {
            let omp = Omp::new(dictionary.view(), 2);
            let lifted = &signals + &(&dictionary.column(1) * more);
            let [before, after] = [&signals, &lifted].map(|s| omp.codes(s.view(), Stop::at_atoms(4)).to_dense(ATOMS));
            let mut change = &after - &before;
            change.column_mut(1).mapv_inplace(|v| v - more);
            let largest = before.fold(1.0f64, |m, v| m.max(v.abs()));
            prop_assert!(change.iter().all(|v| v.abs() < 1e-6 * largest), "{change}");
        }

        #[test]
        fn longer_atoms_have_smaller_codes(
            dictionary in matrix(LENGTH, ATOMS), signals in matrix(4, LENGTH), power in -3i32..4
        ) {
            let codes = |d: &Array2<f64>| Omp::new(d.view(), 1).codes(signals.view(), Stop::at_atoms(3)).to_dense(ATOMS);
            let scale = 2f64.powi(power);
            let error = codes(&dictionary) - codes(&(&dictionary * scale)) * scale;
            prop_assert!(error.iter().all(|e| e.abs() < 1e-6));
        }
    }

    #[test]
    fn single_precision_chooses_the_same_atoms() {
        // Numbers without a pattern: no two atoms fit equally well.
        let noise = |rows: usize, columns: usize, seed: f64| {
            Array2::from_shape_fn((rows, columns), |(r, c)| {
                ((r * columns + c) as f64 * 12.9898 + seed).sin() * 43_758.545_3 % 1.0
            })
        };
        let (dictionary, signals) = (noise(16, 40, 1.0), noise(20, 16, 2.0));
        let wide = Omp::new(dictionary.view(), 0).codes(signals.view(), Stop::at_atoms(5));
        let narrow = Omp::new(dictionary.mapv(|v| v as f32).view(), 0)
            .codes(signals.mapv(|v| v as f32).view(), Stop::at_atoms(5));
        assert_eq!(wide.atoms, narrow.atoms);
        assert!(wide.values.iter().zip(&narrow.values).all(|(a, b)| (a - f64::from(*b)).abs() < 1e-3));
    }

    #[test]
    fn atoms_of_nothing_and_copies_are_never_chosen() {
        let dictionary = ndarray::array![[1.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]];
        let codes =
            Omp::new(dictionary.view(), 0).codes(ndarray::array![[2.0, 1.0, 0.0]].view(), Stop::at_atoms(4));
        assert_eq!(codes.of(0).0, [0, 3]);
        let black = Omp::new(dictionary.view(), 0).codes(Array2::zeros((1, 3)).view(), Stop::at_atoms(4));
        assert_eq!(black.nonzeros(), 0);
    }

    #[test]
    fn a_signal_has_the_same_code_in_any_company() {
        let dictionary =
            Array2::from_shape_fn((LENGTH, ATOMS), |(r, c)| ((r * 7 + c * 5 + r * c) % 11) as f64 - 5.0);
        let signals =
            Array2::from_shape_fn((200, LENGTH), |(r, c)| ((r * 3 + c * 7 + r * c) % 13) as f64 - 6.0);
        let omp = Omp::new(dictionary.view(), 1);
        let all = omp.codes(signals.view(), Stop::at_atoms(3));
        let later = omp.codes(signals.slice(s![70.., ..]), Stop::at_atoms(3));
        assert!((70..200).all(|i| all.of(i) == later.of(i - 70)));
    }
}
