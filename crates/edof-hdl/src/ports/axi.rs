//! AXI4 (ARM IHI 0022): bursts of words of `W` bits, `S` = `W`/8 bytes each. Writes and reads are bundles of their own, since each
//! agent does only one of the two.
//!
//! Not among the ports, and set to 0 where a memory is connected: lock, cache, prot, qos and region.

#![allow(missing_docs, reason = "rust-hdl's derive writes `join` without documentation")]

use crate::describe::Circuit;
use rust_hdl::prelude::*;

/// Writes that a block asks for.
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "AxiWriteSlave"]
pub struct AxiWriteMaster<const W: usize, const S: usize> {
    /// Who asks.
    pub aw_id: Signal<Out, Bits<1>>,
    /// Byte address of the first word of the burst.
    pub aw_addr: Signal<Out, Bits<32>>,
    /// Words of the burst, less one.
    pub aw_len: Signal<Out, Bits<8>>,
    /// Logarithm of the bytes in a word.
    pub aw_size: Signal<Out, Bits<3>>,
    /// 1: the address grows.
    pub aw_burst: Signal<Out, Bits<2>>,
    /// The address of a burst is valid.
    pub aw_valid: Signal<Out, Bit>,
    /// The address is accepted in this cycle.
    pub aw_ready: Signal<In, Bit>,
    /// A word.
    pub w_data: Signal<Out, Bits<W>>,
    /// Which of its bytes are to be written.
    pub w_strb: Signal<Out, Bits<S>>,
    /// The word is the last of its burst.
    pub w_last: Signal<Out, Bit>,
    /// The word is valid.
    pub w_valid: Signal<Out, Bit>,
    /// The word is accepted in this cycle.
    pub w_ready: Signal<In, Bit>,
    /// Whose burst is written.
    pub b_id: Signal<In, Bits<1>>,
    /// 0: all went well.
    pub b_resp: Signal<In, Bits<2>>,
    /// The response to a written burst is valid.
    pub b_valid: Signal<In, Bit>,
    /// The response is accepted in this cycle.
    pub b_ready: Signal<Out, Bit>,
}

impl<const W: usize, const S: usize> Circuit for AxiWriteMaster<W, S> {}

/// Writes that a block serves: the other end of [`AxiWriteMaster`].
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "AxiWriteMaster"]
pub struct AxiWriteSlave<const W: usize, const S: usize> {
    /// Who asks.
    pub aw_id: Signal<In, Bits<1>>,
    /// Byte address of the first word of the burst.
    pub aw_addr: Signal<In, Bits<32>>,
    /// Words of the burst, less one.
    pub aw_len: Signal<In, Bits<8>>,
    /// Logarithm of the bytes in a word.
    pub aw_size: Signal<In, Bits<3>>,
    /// 1: the address grows.
    pub aw_burst: Signal<In, Bits<2>>,
    /// The address of a burst is valid.
    pub aw_valid: Signal<In, Bit>,
    /// The address is accepted in this cycle.
    pub aw_ready: Signal<Out, Bit>,
    /// A word.
    pub w_data: Signal<In, Bits<W>>,
    /// Which of its bytes are to be written.
    pub w_strb: Signal<In, Bits<S>>,
    /// The word is the last of its burst.
    pub w_last: Signal<In, Bit>,
    /// The word is valid.
    pub w_valid: Signal<In, Bit>,
    /// The word is accepted in this cycle.
    pub w_ready: Signal<Out, Bit>,
    /// Whose burst is written.
    pub b_id: Signal<Out, Bits<1>>,
    /// 0: all went well.
    pub b_resp: Signal<Out, Bits<2>>,
    /// The response to a written burst is valid.
    pub b_valid: Signal<Out, Bit>,
    /// The response is accepted in this cycle.
    pub b_ready: Signal<In, Bit>,
}

impl<const W: usize, const S: usize> Circuit for AxiWriteSlave<W, S> {}

/// Reads that a block asks for.
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "AxiReadSlave"]
pub struct AxiReadMaster<const W: usize> {
    /// Who asks.
    pub ar_id: Signal<Out, Bits<1>>,
    /// Byte address of the first word of the burst.
    pub ar_addr: Signal<Out, Bits<32>>,
    /// Words of the burst, less one.
    pub ar_len: Signal<Out, Bits<8>>,
    /// Logarithm of the bytes in a word.
    pub ar_size: Signal<Out, Bits<3>>,
    /// 1: the address grows.
    pub ar_burst: Signal<Out, Bits<2>>,
    /// The address of a burst is valid.
    pub ar_valid: Signal<Out, Bit>,
    /// The address is accepted in this cycle.
    pub ar_ready: Signal<In, Bit>,
    /// Whose word it is.
    pub r_id: Signal<In, Bits<1>>,
    /// A word.
    pub r_data: Signal<In, Bits<W>>,
    /// 0: it is right.
    pub r_resp: Signal<In, Bits<2>>,
    /// The word is the last of its burst.
    pub r_last: Signal<In, Bit>,
    /// The word is valid.
    pub r_valid: Signal<In, Bit>,
    /// The word is accepted in this cycle.
    pub r_ready: Signal<Out, Bit>,
}

impl<const W: usize> Circuit for AxiReadMaster<W> {}

/// Reads that a block serves: the other end of [`AxiReadMaster`].
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "AxiReadMaster"]
pub struct AxiReadSlave<const W: usize> {
    /// Who asks.
    pub ar_id: Signal<In, Bits<1>>,
    /// Byte address of the first word of the burst.
    pub ar_addr: Signal<In, Bits<32>>,
    /// Words of the burst, less one.
    pub ar_len: Signal<In, Bits<8>>,
    /// Logarithm of the bytes in a word.
    pub ar_size: Signal<In, Bits<3>>,
    /// 1: the address grows.
    pub ar_burst: Signal<In, Bits<2>>,
    /// The address of a burst is valid.
    pub ar_valid: Signal<In, Bit>,
    /// The address is accepted in this cycle.
    pub ar_ready: Signal<Out, Bit>,
    /// Whose word it is.
    pub r_id: Signal<Out, Bits<1>>,
    /// A word.
    pub r_data: Signal<Out, Bits<W>>,
    /// 0: it is right.
    pub r_resp: Signal<Out, Bits<2>>,
    /// The word is the last of its burst.
    pub r_last: Signal<Out, Bit>,
    /// The word is valid.
    pub r_valid: Signal<Out, Bit>,
    /// The word is accepted in this cycle.
    pub r_ready: Signal<In, Bit>,
}

impl<const W: usize> Circuit for AxiReadSlave<W> {}
