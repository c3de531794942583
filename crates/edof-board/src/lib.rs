//! The link to a board, real or simulated: bytes on a serial line in, registers, weights and counters out.
//!
//! | step | module | gives |
//! |---|---|---|
//! | bytes | [`mod@line`] | a serial port of this machine, or anything else that carries bytes ([`Line`]) |
//! | frames | [`protocol`] | LiteX's UARTBone: words written and read |
//! | words that arrive | [`link`] | repeated where the line lost, doubled or changed a byte |
//! | registers by name | [`names`] | `control.colour`, `stage_counters[4]` |
//! | the board | [`board`] | who it is, its control, its stages ([`Board`]) |
//! | what a bank must hold | [`contents`] | a network in parts that the circuit makes a CRC of |
//! | load, verify | [`load`] | a network in the idle bank, all of it right, then in use |
//! | load time | [`dry_run`] | the same load, on a simulated board |
//! | counters | [`status`] | frames per second, late ones, saturations |
//! | is every picture right | [`check`] | CRCs of frames at each boundary, beside those of the golden pipeline |
//! | does every part work | [`self_test`] | bus, memories, multipliers, chips, clocks, each with what was found |
//! | pictures over the line | [`picture`], [`host_frame`] | a tile of raw pixels or a whole raw frame in, codes out |
//! | video chips | [`chips`], [`diagnosis`], [`align`] | their registers, what they miss in words, the receiver's clock where it works |
//! | a PC's graphics card as source | [`mod@calibrate`] | which grey becomes which code |
//! | a board in Rust | [`simulated`] | the same registers and memories, pictures of the golden pipeline ([`Simulated`]) |
//! | what may go wrong | [`faulty`] | a line that loses, doubles or changes a byte, a host that ends, a board that is reset |
//! | models of the chips around the FPGA, which judge set-ups | [`chip_models`] |
//! | as a device | [`terminal`] | a simulated board behind a pseudo-terminal |
//!
//! ```
//! use edof_board::load::Job;
//! use edof_board::{Board, Simulated, link};
//! use edof_golden::Display;
//! use edof_device::Design;
//! use edof_core::{CfaPhase, RawFrame};
//!
//! let design = Design::from_json(include_str!("../../../designs/tiny.json"))?;
//! let [old, new] = [1, 2].map(|seed| edof_device::random::for_design(&design, seed));
//! let raw = RawFrame::from_values(ndarray::Array2::from_elem((48, 64), 700), 12, CfaPhase::Rggb)?;
//! let line = Simulated::new(&design, [&old, &old], &Display::default(), raw, 921_600)?;
//! // On a bench: edof_board::line::Serial::open("/dev/ttyUSB0", 921_600)?
//! let mut board = Board::open(line, link::PATIENCE)?;
//! let job = Job { design: &design, network: &new, bank: None, full: false, read_back: false, known: &[] };
//! let loaded = board.load(&job, &mut |_, _| std::ops::ControlFlow::Continue(()))?;
//! assert_eq!((loaded.bank, loaded.in_use), ('b', 'b'));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Stability
//!
//! Stable: register names, addresses and frames on the line of register map 2.x (docs/host.md). Signatures may change between minor versions until 1.0;
//! `examples/load_a_network.rs` is kept compiling.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod align;
pub mod board;
pub mod calibrate;
pub mod check;
pub mod chip_models;
pub mod chips;
pub mod clocks;
pub mod contents;
pub mod diagnosis;
pub mod dry_run;
pub mod error;
pub mod faulty;
pub mod host_frame;
pub mod line;
pub mod link;
pub mod load;
pub mod names;
pub mod picture;
pub mod protocol;
pub mod self_test;
pub mod simulated;
pub mod status;
#[cfg(unix)]
pub mod terminal;

pub use board::Board;
pub use error::Error;
pub use line::{Line, Serial};
pub use simulated::Simulated;
