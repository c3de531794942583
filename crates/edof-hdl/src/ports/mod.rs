//! What a block's ports are called and how they behave: streams, memory, registers.
//!
//! | bundle | carries |
//! |---|---|
//! | [`stream`] | pixels, windows and patches: AXI4-Stream video |
//! | [`axi`] | frames to and from DRAM: AXI4 |
//! | [`axi_lite`] | registers: AXI4-Lite |
//!
//! [`stream_cut`] puts registers into a stream.
//!
//! A bundle is a field of a block, of the type that ends in `Out` or `Master` where the block offers and in `In` or `Slave` where
//! it is served; its signals are ports named after field and signal, as in `pixels_valid_o`. Two parts are joined by one line,
//! `StreamOut::<16>::join(&mut self.one.to, &mut self.other.from)`, and a part's bundle is the block's own by `link`.
//!
//! The rules are ARM's (IHI 0022, IHI 0051), and co-simulation watches them on every port: what is offered stands until it is taken;
//! nobody waits for `ready` before offering; nothing is offered during reset.

pub mod axi;
pub mod axi_lite;
pub mod stream;
pub mod stream_cut;

pub use axi::{AxiReadMaster, AxiReadSlave, AxiWriteMaster, AxiWriteSlave};
pub use axi_lite::{AxiLiteMaster, AxiLiteSlave};
pub use stream::{StreamIn, StreamOut};
pub use stream_cut::StreamCut;
