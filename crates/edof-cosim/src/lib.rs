//! The generated Verilog, run by Verilator and Icarus, and compared with the golden model bit for bit and cycle for cycle.
//!
//! | step | module | gives |
//! |---|---|---|
//! | design | [`source`] | Verilog files and the ports of their top |
//! | stimulus | [`rows`] | what the inputs are in every cycle, and what the outputs were |
//! | check | [`lint`] | Verilator's [`finding`]s in the text, `-Wall` |
//! | run | [`verilator`] | the design compiled to a shared library and driven from Rust |
//! | run again | [`icarus`] | the same stimulus through a second, unrelated simulator |
//! | map | [`yosys`] | the cells of a 7-series FPGA that the design becomes |
//! | compare | [`chain`] | the calculator against the cycle model, at every boundary |
//! | surround | [`bench`](mod@bench) | any block with streams and AXI ports, in several clock domains |
//! | everything | [`system`] | the whole core, from the receiver's pins to the transmitter's |
//! | foresee | [`estimate`] | cycles, frames per second and cells of a design |
//! | | [`explore`] | the foldings of a network that fit a device |
//! | | [`promise`] | the same before any network or picture |
//! | build | [`bitstream`] | every file that a board's bitstream is made from |
//! | tell | [`junit`], [`error`] | a report for CI, and what can go wrong |
//!
//! A counter, driven by hand:
//!
//! ```no_run
//! use edof_cosim::{Port, Source, verilator::{Library, Options, Start}};
//! # let text = String::new();
//! let source = Source {
//!     top: "counter".into(),
//!     files: vec![("counter.v".into(), text)],
//!     ports: vec![Port::clock("clock_i"), Port::input("reset_i", 1), Port::output("count_o", 8)],
//! };
//! let library = Library::build(&source, &Options::default())?;
//! let mut model = library.start(&Start { seed: 7, ..Start::default() })?;
//! model.poke(1, 1)?;
//! model.tick()?;
//! model.poke(1, 0)?;
//! model.tick()?;
//! assert_eq!(model.peek(2)?, 1);
//! # Ok::<(), edof_cosim::Error>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod bench;
pub mod bitstream;
mod cache;
pub mod chain;
mod emitted;
pub mod error;
pub mod estimate;
pub mod explore;
pub mod finding;
pub mod icarus;
pub mod junit;
pub mod lint;
mod mutant;
pub mod promise;
pub mod rows;
pub mod source;
pub mod system;
pub mod tool;
pub mod verilator;
mod work;
pub mod yosys;

pub use cache::of_user as user_cache;
pub use error::Error;
pub use rows::{Layout, Rows};
pub use source::{Direction, Port, Source};
