//! Differential tests of rust-hdl circuits: rust-hdl's simulation, Verilator and Icarus on one random stimulus.
//!
//! | step | file | gives |
//! |---|---|---|
//! | drive | `drive` | a circuit's clock and inputs by name, values for them |
//! | Rust | `rust` | what rust-hdl's own simulation says |
//! | Verilog | `simulator` | the same from the printed text in Verilator and Icarus |
//! | compare | `compare` | the first port that differs |
//! | shrink | `shrink` | a shorter stimulus on which it still does |
//! | draw | [`random`] | random circuits: registers, memories, hierarchies |
//!
//! `README.md` has an example.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

mod compare;
mod drive;
mod failure;
pub mod random;
mod rust;
mod shrink;
mod simulator;

pub use compare::{Agreement, Check, check};
pub use drive::{ClockOf, Harness, Input, Random, Word};
pub use failure::{Difference, Failure, Known, Simulator};
pub use simulator::Bench;

/// The README's example is compiled.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
