//! The only clock-domain crossings: the backend rejects every other connection of two domains.
//!
//! | leaf | carries |
//! |---|---|
//! | [`sync`] | levels, each by itself, or a Gray code |
//! | [`reset_sync`] | a reset into a domain |
//! | [`pulse_sync`] | pulses, one for one |
//! | [`bus_sync`] | a word now and then |
//! | [`async_fifo`] | a word a cycle |
//! | [`serialiser`] | a word a cycle into a clock five times as fast, bit by bit |
//! | [`pixel_fifo`] | the same as a block: a stream of pixels |
//!
//! [`constraints`] writes the constraints of each.
//!
//! Each side of a crossing takes the reset of its own domain and nothing more: resets need no overlap, no order, and no second clock. Those
//! that carry words or pulses are empty after a reset of either side, and closed until both clocks have run (`rtl/edof_clear.v`).
//!
//! The serialiser has no reset: it has nothing to forget, and finds its place anew.
//!
//! Each but the last is a leaf of `rtl/`, and here as its model. A model sees every change at the first edge after it; in Verilog, with
//! `EDOF_METASTABLE` defined, each bit is seen then or an edge later, at random, as on a real chip. Of
//! several changes between two edges only the last is in doubt.

pub mod async_fifo;
pub mod bus_sync;
mod clear;
pub(crate) mod clocks;
pub mod constraints;
pub mod pixel_fifo;
pub mod pulse_sync;
pub mod reset_sync;
pub mod serialiser;
pub mod sync;

pub use async_fifo::AsyncFifo;
pub use bus_sync::BusSync;
pub use pixel_fifo::PixelFifo;
pub use pulse_sync::PulseSync;
pub use reset_sync::ResetSync;
pub use serialiser::Serialiser;
pub use sync::Sync;
