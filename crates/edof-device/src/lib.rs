//! The hardware as data: what circuit, golden model and host must agree on.
//!
//! | what | module |
//! |---|---|
//! | stages, memories, addresses and cycles of the calculator for one network architecture | [`design`] |
//! | registers that the host sees | [`registers`] |
//! | boards: FPGA, clocks, memory, host, video | [`board`] |
//! | video timing | [`video`] |
//! | set-up of the video chips | [`i2c`] |
//! | depths of FIFOs | [`fifos`] |
//! | raw frames that the board makes itself | [`pattern`] |
//! | a raw frame that the host writes | [`host_frame`] |
//! | CRC of frames | [`crc`] |
//! | random networks and windows (feature `random`) | `random` |

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod board;
pub mod crc;
pub mod design;
pub mod fifos;
pub mod host_frame;
pub mod i2c;
pub mod input_timing;
pub mod pattern;
#[cfg(feature = "random")]
pub mod random;
pub mod registers;
pub mod video;

pub use design::Design;
