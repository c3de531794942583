//! The board's circuits, written in rust-hdl; `edof_verilog` prints them as Verilog.
//!
//! | step | module | gives |
//! |---|---|---|
//! | name | [`describe`] | the name, source, header and comments of a block |
//! | leaf | [`leaf`], [`leaves`] | an instance of a hand-written Verilog leaf, and those of `rtl/` |
//! | bundle | [`ports`] | streams, memory and registers as ports |
//! | cross | [`crossing`] | the clock-domain crossings |
//! | block | [`blocks`] | the circuits of the calculator |
//! | block | [`video`] | the circuits around it, from pixels to pixels |
//! | block | [`board`] | memory, host, and all of it together |
//! | print | [`verilog`] | Verilog-2001 that means exactly what the Rust means |
//! | all | [`project`], [`board_project`] | the files of a calculator, and of a design for its board |
//! | board | [`boards`] | the circuits of each board |
//! | find | [`places`] | the Rust behind a line of the Verilog |
//! | try | [`benches`] | what a generated design tries itself with, in Verilog alone |
//! | place | [`floorplan`] | where the stages may be on a Xilinx part |
//! | ahead | [`resources`] | what it takes of an FPGA, before any tool runs |

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![allow(
    clippy::too_many_lines,
    reason = "rust-hdl translates the body of one function, the kernel of a block"
)]

pub mod benches;
pub mod blocks;
pub mod board;
pub mod board_project;
pub mod boards;
pub mod crossing;
pub mod floorplan;
pub mod leaves;
pub mod places;
pub mod ports;
pub mod project;
pub mod resources;
pub mod video;

pub use edof_verilog::{self as verilog, describe, leaf};
