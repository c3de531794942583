//! The board's circuits, written in rust-hdl, and the backend that prints them as Verilog.
//!
//! | step | module | gives |
//! |---|---|---|
//! | name | [`describe`] | the name, source and header of a block |
//! | leaf | [`leaf`] | an instance of a hand-written Verilog leaf of `rtl/` |
//! | block | [`blocks`] | the circuits |
//! | print | [`verilog`] | Verilog-2001 that means exactly what the Rust means |
//! | all | [`project`] | the files of a generated design |

pub mod blocks;
pub mod describe;
pub mod leaf;
pub mod project;
pub mod verilog;
