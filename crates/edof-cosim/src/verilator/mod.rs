//! Verilog compiled by Verilator to a shared library, and driven from Rust.
//!
//! [`Library::build`] compiles (seconds; see [`Options::cache`]), [`Library::start`] makes an instance (microseconds).
//! Any number of libraries and instances live side by side, each instance on whichever thread has it.
//!
//! A cycle is: change inputs ([`Model::poke`]), read outputs as they are before the edge ([`Model::peek`]), let the clocks
//! rise ([`Model::tick`], or [`Model::rise`] where there are several). [`Model::run`] does that for a whole stimulus in C++.

mod build;
mod interface;
mod library;
mod model;
mod ports;
mod shim;

pub use build::{Options, Unknowns, Waveform};
pub use library::Library;
pub use model::{Model, Start};
