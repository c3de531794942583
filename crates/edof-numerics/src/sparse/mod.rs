//! Dictionaries and pursuits: signals as sums of few atoms, slowly and exactly.
//!
//! | step | module | gives |
//! |---|---|---|
//! | pursue | [`omp`] | sparse codes by greedy choice: N atoms, or until so little is left |
//! | | [`lasso`] | sparse codes by ISTA and FISTA: the minimum of a convex objective |
//! | | [`codes`] | what is not zero of them, and the signals that they stand for |
//! | learn | [`ksvd`](mod@ksvd) | a dictionary in which signals have codes of N atoms |
//! | | [`dictionary`] | one in which they have small codes, by least squares |
//!
//! Signals are rows (signals × length), a dictionary's atoms are columns (length × atoms), codes are rows (signals × atoms). Pursuits
//! run on all threads, for `f32` and `f64`; a signal's code depends on that signal alone.
//!
//! ```
//! use edof_numerics::sparse::{ksvd::{Settings, ksvd}, omp::{Omp, Stop}};
//! use ndarray::{Array2, array};
//! // Signals along two directions, and a dictionary that starts a little beside them.
//! let signals = Array2::from_shape_fn((40, 2), |(i, r)| (1 + i) as f32 * [[1.0, 0.5], [-0.5, 1.0]][i % 2][r]);
//! let learned = ksvd(signals.view(), array![[1.0, 0.0], [0.0, 1.0]], Settings { atoms: 1, rounds: 5, free: 0 });
//! let codes = Omp::new(learned.dictionary.view(), 0).codes(signals.view(), Stop::at_atoms(1));
//! let rest = &signals - &codes.synthesis(learned.dictionary.t());
//! assert!(rest.iter().all(|e| e.abs() < 1e-3));
//! ```

pub mod codes;
pub mod dictionary;
mod free;
pub mod ksvd;
pub mod lasso;
pub mod omp;
