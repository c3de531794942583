//! Hard cases: the acceptance limit of each, and whether it holds.
//!
//! | what | module | gives |
//! |---|---|---|
//! | data | [`case`] | cases as in their files: intent, trial, danger, limit (`promise`) |
//! | | [`scenes`] | the pictures that they are about |
//! | under trial | [`subjects`] | the product's functions as values, so that a test may pass a faulty one |
//! | trials | `frames` | every method on a raw frame; fixed point and `f32` against `f64` |
//! | | `sizes` | frames of the least sizes and of a hundred megapixels |
//! | | `words` | networks of words whose sums and saturations are driven to their ends |
//! | | `bounds` | a-priori bounds of error on random and climbing windows |
//! | | `pursuits`, `solves` | dictionaries and systems that are nearly singular |
//! | | `fitting` | maps that meet more noise than they were fitted for |
//! | | `lenses`, `deblurring` | PSFs at the edge of what can be computed; deconvolution with little to go by |
//! | | `numbers`, `refusals` | sums, tables and steps at the ends of numbers; what must be rejected |
//! | run | [`mod@bench`] | what they are run with; `methods` prepares those that need no weights |
//! | | [`suite`] | all of them, one after the other; a panic is a failure |
//! | beside | [`bits`] | which layer's bits matter, and the fewest that do |
//! | elsewhere | [`inputs`] | its windows for any network, for the circuit |
//! | tell | [`outcome`], [`report`] | what was seen against its limit; a card a case |
//!
//! ```
//! use edof_study::stability::{case, bench::Bench, suite::Suite};
//! use std::ops::ControlFlow;
//! let cases: Vec<_> = case::own()?.into_iter().filter(|case| case.id == "gamma-index").collect();
//! let suite = Suite::run(&Bench::new(vec![], 0), &cases, |_, _| ControlFlow::Continue(())).unwrap();
//! assert_eq!((suite.cases.len(), suite.broken), (1, 0));
//! # Ok::<(), case::CasesError>(())
//! ```

pub mod bench;
pub mod bits;
mod bounds;
pub mod case;
mod deblurring;
mod fitting;
mod frames;
pub mod inputs;
mod lenses;
mod methods;
mod numbers;
pub mod outcome;
#[cfg(test)]
mod planted;
mod pursuits;
mod refusals;
pub mod report;
pub mod scenes;
mod sizes;
mod solves;
pub mod subjects;
pub mod suite;
mod words;
