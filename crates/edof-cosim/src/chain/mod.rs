//! The whole calculator compared with the cycle model: every word and every cycle at every boundary.
//!
//! | step | module | gives |
//! |---|---|---|
//! | circuit | [`device`] | outputs and inputs of a chain in one cycle, for every simulator |
//! | | [`simulated`] | the chain in rust-hdl's own simulator |
//! | | [`verilated`] | the chain as Verilog, in Verilator |
//! | | [`folder`] | the Verilog of a folder in place of what is generated |
//! | compare | [`check`] | the first difference: stage, patch, element, cycle, expected, got |
//! | | [`second`] | what was run, once more in Icarus |
//! | run | [`drive`] | patches through a circuit, with stalls, checked as they pass |

pub mod check;
pub mod device;
pub mod drive;
pub mod folder;
pub mod second;
pub mod simulated;
pub mod verilated;

pub use check::{Difference, Fault};
pub use device::{Beat, Device, Inputs, Offer, Outputs};
pub use drive::{Drive, Outcome};
