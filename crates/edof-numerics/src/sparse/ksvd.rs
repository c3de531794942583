//! k-SVD: dictionaries fitted to signals, atom by atom.
//!
//! M. Aharon, M. Elad, A. Bruckstein, "K-SVD: an algorithm for designing overcomplete dictionaries for sparse representation", IEEE
//! Trans. Signal Processing 54 (2006). In turn all signals are coded by [`Omp`], and each atom and its codes become the best rank-one
//! fit of what the signals that use it leave without it; its singular vectors come from a few power steps, as in Rubinstein,
//! Zibulevsky and Elad 2008. Atoms that nothing uses, and copies of others, are replaced by the signals that fare worst.

use crate::sparse::codes::SparseCodes;
use crate::sparse::omp::{Omp, Stop};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, ArrayViewMut1, Axis};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Atoms whose cosine is beyond this are copies of each other.
const COPY: f32 = 0.99;
/// An atom that fewer signals use than this is not used.
const MIN_USERS: usize = 2;
/// Power steps an atom and round; they continue from the end of the last round.
const POWER_STEPS: usize = 2;
/// Users whose share of a sum is one partial sum, so that a sum does not depend on how many threads there are.
const CHUNK: usize = 512;

/// How to learn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Atoms that a signal's code may have, free ones not counted.
    pub atoms: usize,
    /// Turns of codes and dictionary.
    pub rounds: usize,
    /// The first N atoms are fixed, and every signal uses them at no cost: the mean, say.
    pub free: usize,
}

/// A dictionary and how it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// Length × atoms, of norm 1 except for the free ones, to which all others are orthogonal.
    pub dictionary: Array2<f32>,
    /// Root mean square of what the codes leave of a signal's entry, after each round.
    pub errors: Vec<f64>,
    /// Atoms that were replaced, all rounds together.
    pub replaced: usize,
}

/// Fits the dictionary `start` (length × atoms) to signals (rows). The same signals and start give the same bytes on any number of
/// threads.
///
/// ```
/// use edof_numerics::sparse::ksvd::{Settings, ksvd};
/// use ndarray::array;
/// let signals = array![[1.0, 1.0], [2.0, 2.0], [3.0, -3.0], [0.5, -0.5]];
/// let start = array![[1.0, 0.0], [0.1, 1.0]];
/// let fitted = ksvd(signals.view(), start, Settings { atoms: 1, rounds: 10, free: 0 });
/// assert!(fitted.errors[9] < 1e-3);
/// ```
///
/// # Panics
/// If signals and atoms differ in length or are not finite: mistakes of the caller.
#[must_use]
pub fn ksvd(signals: ArrayView2<'_, f32>, start: Array2<f32>, settings: Settings) -> Fitted {
    ksvd_with(signals, start, settings, |_, _| ControlFlow::Continue(()))
}

/// The same with a call after each round, which gets its number and error and may end the work: then the dictionary of the rounds until then.
///
/// # Panics
/// As [`ksvd`].
pub fn ksvd_with(
    signals: ArrayView2<'_, f32>,
    start: Array2<f32>,
    settings: Settings,
    mut each: impl FnMut(usize, f64) -> ControlFlow<()>,
) -> Fitted {
    // Signals without the free atoms' part: then whatever is made of them is orthogonal to those as well.
    let bare = Omp::new(start.view(), settings.free).codes(signals, Stop::at_atoms(0));
    let signals = &signals - &bare.synthesis(start.t());
    let mut work = Work::new(signals, &start, settings.free);
    let (mut errors, mut replaced) = (vec![], 0);
    for round in 1..=settings.rounds {
        work.code(settings.atoms);
        work.update();
        let error = work.error();
        errors.push(error);
        if each(round, error).is_break() {
            break;
        }
        if round < settings.rounds {
            replaced += work.replace();
        }
    }
    let mut dictionary = start;
    dictionary
        .axis_iter_mut(Axis(1))
        .skip(settings.free)
        .zip(work.atoms.outer_iter())
        .for_each(|(mut to, atom)| to.assign(&atom));
    Fitted { dictionary, errors, replaced }
}

struct Work {
    /// Without free parts.
    signals: Array2<f32>,
    /// Atoms × length, free ones left out.
    atoms: Array2<f32>,
    codes: SparseCodes<f32>,
    /// Signals less what their codes stand for.
    rest: Array2<f32>,
    /// Who uses each atom: signal and place in its code.
    users: Vec<Vec<(usize, usize)>>,
}

impl Work {
    fn new(signals: Array2<f32>, start: &Array2<f32>, free: usize) -> Self {
        // The share of the free atoms in a start atom is taken out as it is from signals.
        let whole = start.t().to_owned();
        let shares =
            Omp::new(start.view(), free).codes(whole.view(), Stop::at_atoms(0)).synthesis(whole.view());
        let mut atoms = (&whole - &shares).slice_move(ndarray::s![free.., ..]);
        atoms.outer_iter_mut().for_each(|mut atom| normalise(&mut atom));
        let users = vec![vec![]; atoms.nrows()];
        let codes = SparseCodes::zeros(signals.nrows(), 0);
        Self { rest: signals.clone(), signals, atoms, codes, users }
    }

    /// Codes of all signals in the dictionary as it is.
    fn code(&mut self, atoms: usize) {
        self.codes = Omp::new(self.atoms.t(), 0).codes(self.signals.view(), Stop::at_atoms(atoms));
        self.rest = &self.signals - &self.codes.synthesis(self.atoms.view());
        self.users.iter_mut().for_each(Vec::clear);
        for signal in 0..self.codes.signals() {
            let (chosen, _) = self.codes.of(signal);
            for (place, &atom) in chosen.iter().enumerate() {
                self.users[atom as usize].push((signal, signal * self.codes.max + place));
            }
        }
    }

    /// Each atom and its codes in turn.
    fn update(&mut self) {
        for atom in 0..self.atoms.nrows() {
            let users = std::mem::take(&mut self.users[atom]);
            if users.len() >= MIN_USERS {
                self.update_atom(atom, &users);
            }
            self.users[atom] = users;
        }
    }

    /// With E = rest + γ·dᵀ of the users: d ← Eᵀγ of norm 1, γ ← E·d, which leaves no larger a rest whatever d was.
    fn update_atom(&mut self, atom: usize, users: &[(usize, usize)]) {
        for _ in 0..POWER_STEPS {
            let mut next = self.weighted_sum(atom, users);
            normalise(&mut next.view_mut());
            if next.dot(&next) < 0.5 {
                return;
            }
            let before = self.atoms.row(atom).to_owned();
            let overlap = before.dot(&next);
            for &(signal, place) in users {
                let mut rest = self.rest.row_mut(signal);
                let value = self.codes.values[place];
                let new = rest.dot(&next) + value * overlap;
                rest.scaled_add(value, &before);
                rest.scaled_add(-new, &next);
                self.codes.values[place] = new;
            }
            self.atoms.row_mut(atom).assign(&next);
        }
    }

    /// Eᵀγ = Σ γᵢ·restᵢ + (Σ γᵢ²)·d.
    fn weighted_sum(&self, atom: usize, users: &[(usize, usize)]) -> Array1<f32> {
        let partial: Vec<(Array1<f32>, f32)> = users
            .par_chunks(CHUNK)
            .map(|users| {
                let (mut sum, mut squares) = (Array1::zeros(self.atoms.ncols()), 0.0);
                for &(signal, place) in users {
                    let value = self.codes.values[place];
                    sum.scaled_add(value, &self.rest.row(signal));
                    squares += value * value;
                }
                (sum, squares)
            })
            .collect();
        let mut total = Array1::zeros(self.atoms.ncols());
        for (sum, squares) in &partial {
            total += sum;
            total.scaled_add(*squares, &self.atoms.row(atom));
        }
        total
    }

    /// Root mean square of the rest.
    fn error(&self) -> f64 {
        let energy: f64 = self.energies().into_iter().map(f64::from).sum();
        (energy / self.rest.len().max(1) as f64).sqrt()
    }

    fn energies(&self) -> Vec<f32> {
        self.rest.outer_iter().map(|r| r.dot(&r)).collect()
    }

    /// Puts the worst signals, each unlike all atoms, in the place of atoms that are not used or copies; how many.
    fn replace(&mut self) -> usize {
        let superfluous = self.superfluous();
        let energies = self.energies();
        let mut worst: Vec<usize> = (0..energies.len()).filter(|&i| energies[i] > 0.0).collect();
        worst.sort_by(|&a, &b| energies[b].total_cmp(&energies[a]).then(a.cmp(&b)));
        let mut candidates = worst.into_iter();
        let mut replaced = 0;
        for atom in superfluous {
            self.atoms.row_mut(atom).fill(0.0);
            for signal in candidates.by_ref() {
                let mut candidate = self.signals.row(signal).to_owned();
                normalise(&mut candidate.view_mut());
                if !self.holds(candidate.view()) {
                    self.atoms.row_mut(atom).assign(&candidate);
                    replaced += 1;
                    break;
                }
            }
        }
        replaced
    }

    fn holds(&self, candidate: ArrayView1<'_, f32>) -> bool {
        self.atoms.outer_iter().any(|atom| atom.dot(&candidate).abs() > COPY)
    }

    /// Atoms that hardly anything uses, and of two copies the one that fewer use.
    fn superfluous(&self) -> Vec<usize> {
        let users = |atom: usize| self.users[atom].len();
        let gram = self.atoms.dot(&self.atoms.t());
        let count = self.atoms.nrows();
        let is_copy = |a: usize| {
            (0..count)
                .any(|b| a != b && gram[(a, b)].abs() > COPY && (users(b), count - b) > (users(a), count - a))
        };
        (0..count).filter(|&atom| users(atom) < MIN_USERS || is_copy(atom)).collect()
    }
}

/// To norm 1; what has none stays.
fn normalise(atom: &mut ArrayViewMut1<'_, f32>) {
    let norm = atom.dot(atom).sqrt();
    if norm > 1e-6 {
        atom.mapv_inplace(|v| v / norm);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of −1…1 without a pattern.
    fn noise(rows: usize, columns: usize, seed: u64) -> Array2<f32> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        Array2::from_shape_simple_fn((rows, columns), || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 23) as f32 - 1.0
        })
    }

    const ATOMS: usize = 24;
    const LENGTH: usize = 16;

    /// Signals of three atoms each of a random dictionary, which comes with them (length × atoms).
    fn signals_of_three(count: usize) -> (Array2<f32>, Array2<f32>) {
        let mut truth = noise(ATOMS, LENGTH, 3);
        truth.outer_iter_mut().for_each(|mut atom| normalise(&mut atom));
        let weights = noise(count, 3, 5);
        let mut codes = Array2::<f32>::zeros((count, ATOMS));
        for i in 0..count {
            for j in 0..3 {
                codes[(i, (i * 7 + j * (1 + i / ATOMS % 7) + i / 5 * j) % ATOMS)] +=
                    weights[(i, j)] + weights[(i, j)].signum() * 0.3;
            }
        }
        (codes.dot(&truth), truth.reversed_axes())
    }

    fn fit(signals: &Array2<f32>, start: Array2<f32>, rounds: usize, free: usize) -> Fitted {
        ksvd(signals.view(), start, Settings { atoms: 3, rounds, free })
    }

    #[test]
    fn the_dictionary_that_made_the_signals_is_found() {
        let (signals, truth) = signals_of_three(1500);
        let start = signals.slice(ndarray::s![..ATOMS, ..]).t().to_owned();
        let fitted = fit(&signals, start, 60, 0);
        let cosines = truth.t().dot(&fitted.dictionary).mapv(f32::abs);
        let found = cosines.outer_iter().filter(|row| row.iter().any(|&c| c > COPY)).count();
        assert!(found >= ATOMS * 9 / 10, "{found} of {ATOMS}, errors {:?}", fitted.errors);
    }

    #[test]
    fn an_atoms_update_never_makes_the_rest_larger() {
        let signals = noise(300, LENGTH, 8);
        let mut work = Work::new(signals.clone(), &noise(LENGTH, ATOMS, 9), 0);
        work.code(4);
        let mut before = work.error();
        for atom in 0..ATOMS {
            let users = work.users[atom].clone();
            work.update_atom(atom, &users);
            let after = work.error();
            assert!(after <= before + 1e-7, "atom {atom}: {before} to {after}");
            before = after;
        }
        let made = &signals - &work.codes.synthesis(work.atoms.view());
        assert!((&made - &work.rest).iter().all(|e| e.abs() < 1e-4), "the rest is what the codes leave");
    }

    #[test]
    fn unused_atoms_and_copies_are_replaced() {
        let (signals, _) = signals_of_three(600);
        let mut start = signals.slice(ndarray::s![..ATOMS, ..]).t().to_owned();
        let copy = start.column(0).to_owned();
        start.column_mut(1).assign(&copy);
        start.column_mut(2).fill(0.0);
        let fitted = fit(&signals, start, 12, 0);
        assert!(fitted.replaced >= 2, "{}", fitted.replaced);
        let gram = fitted.dictionary.t().dot(&fitted.dictionary);
        for ((a, b), &cosine) in gram.indexed_iter() {
            if a == b {
                assert!((cosine - 1.0).abs() < 1e-4, "atom {a}: {cosine}");
            } else if a < 3 {
                assert!(cosine.abs() <= COPY, "atoms {a} and {b} are copies");
            }
        }
    }

    #[test]
    fn a_fixed_mean_stays_and_all_else_is_orthogonal_to_it() {
        let signals = noise(400, LENGTH, 4) + 0.8;
        let mut start = noise(LENGTH, ATOMS, 6);
        start.column_mut(0).fill(0.25);
        let fitted = fit(&signals, start, 5, 1);
        assert!(fitted.dictionary.column(0).iter().all(|&v| v == 0.25));
        for atom in fitted.dictionary.axis_iter(Axis(1)).skip(1) {
            assert!(atom.sum().abs() < 1e-4 && (atom.dot(&atom) - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn the_same_bytes_come_from_any_number_of_threads() {
        let (signals, _) = signals_of_three(1200);
        let start = noise(LENGTH, ATOMS, 2);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| fit(&signals, start.clone(), 4, 0))
        };
        assert_eq!(on(1), on(3));
    }
}
