//! Dictionaries and pursuits: signals as sums of few atoms, slowly and exactly.
//!
//! | step | module | gives |
//! |---|---|---|
//! | pursue | [`pursuit`] | sparse codes of signals in a dictionary |
//! | learn | [`dictionary`] | a dictionary in which signals have sparse codes |
//!
//! Signals are rows (signals × length), a dictionary's atoms are columns (length × atoms), codes are rows (signals × atoms).
//!
//! ```
//! use edof_sparse::pursuit::ista;
//! use ndarray::array;
//! let dictionary = array![[1.0, 0.0], [0.0, 1.0]];
//! let codes = ista(array![[3.0, 0.5]].view(), dictionary.view(), array![1.0, 1.0].view(), 200);
//! assert!((codes[(0, 0)] - 2.0).abs() < 1e-3 && codes[(0, 1)] == 0.0);
//! ```

pub mod dictionary;
pub mod pursuit;
