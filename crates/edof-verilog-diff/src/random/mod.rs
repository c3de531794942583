//! Random circuits: registers, memories, parts in parts, and logic between them.
//!
//! A random circuit is made as a [`Plan`]; [`Circuit`] runs the plan in rust-hdl's simulation and says it as the syntax tree that
//! `#[hdl_gen]` would make. Words have 8 bits, which is enough for everything but widths: those are for random expressions. A plan may have a loop
//! without a register, through its parts too; the backend must reject exactly these, see [`Plan::loops`].

mod circuit;
mod draw;
mod plan;
mod source;

pub use circuit::Circuit;
pub use plan::Plan;
