//! AXI4-Lite (ARM IHI 0022, part B): single 32-bit words.

#![allow(missing_docs, reason = "rust-hdl's derive writes `join` without documentation")]

use crate::describe::Circuit;
use rust_hdl::prelude::*;

/// Registers that a block writes and reads.
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "AxiLiteSlave"]
pub struct AxiLiteMaster {
    /// Byte address to write, a multiple of four.
    pub aw_addr: Signal<Out, Bits<32>>,
    /// The address is valid.
    pub aw_valid: Signal<Out, Bit>,
    /// The address is accepted in this cycle.
    pub aw_ready: Signal<In, Bit>,
    /// The word for it.
    pub w_data: Signal<Out, Bits<32>>,
    /// Which of its bytes are to be written.
    pub w_strb: Signal<Out, Bits<4>>,
    /// The word is valid.
    pub w_valid: Signal<Out, Bit>,
    /// The word is accepted in this cycle.
    pub w_ready: Signal<In, Bit>,
    /// 0: it is written; 2: it cannot be written.
    pub b_resp: Signal<In, Bits<2>>,
    /// The response to the write is valid.
    pub b_valid: Signal<In, Bit>,
    /// The response is accepted in this cycle.
    pub b_ready: Signal<Out, Bit>,
    /// Byte address to read, a multiple of four.
    pub ar_addr: Signal<Out, Bits<32>>,
    /// The address is valid.
    pub ar_valid: Signal<Out, Bit>,
    /// The address is accepted in this cycle.
    pub ar_ready: Signal<In, Bit>,
    /// What stands there.
    pub r_data: Signal<In, Bits<32>>,
    /// 0: it is right; 2: nothing is there.
    pub r_resp: Signal<In, Bits<2>>,
    /// The word is valid.
    pub r_valid: Signal<In, Bit>,
    /// The word is accepted in this cycle.
    pub r_ready: Signal<Out, Bit>,
}

impl Circuit for AxiLiteMaster {}

/// Registers that a block has: the other end of [`AxiLiteMaster`].
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "AxiLiteMaster"]
pub struct AxiLiteSlave {
    /// Byte address to write, a multiple of four.
    pub aw_addr: Signal<In, Bits<32>>,
    /// The address is valid.
    pub aw_valid: Signal<In, Bit>,
    /// The address is accepted in this cycle.
    pub aw_ready: Signal<Out, Bit>,
    /// The word for it.
    pub w_data: Signal<In, Bits<32>>,
    /// Which of its bytes are to be written.
    pub w_strb: Signal<In, Bits<4>>,
    /// The word is valid.
    pub w_valid: Signal<In, Bit>,
    /// The word is accepted in this cycle.
    pub w_ready: Signal<Out, Bit>,
    /// 0: it is written; 2: it cannot be written.
    pub b_resp: Signal<Out, Bits<2>>,
    /// The response to the write is valid.
    pub b_valid: Signal<Out, Bit>,
    /// The response is accepted in this cycle.
    pub b_ready: Signal<In, Bit>,
    /// Byte address to read, a multiple of four.
    pub ar_addr: Signal<In, Bits<32>>,
    /// The address is valid.
    pub ar_valid: Signal<In, Bit>,
    /// The address is accepted in this cycle.
    pub ar_ready: Signal<Out, Bit>,
    /// What stands there.
    pub r_data: Signal<Out, Bits<32>>,
    /// 0: it is right; 2: nothing is there.
    pub r_resp: Signal<Out, Bits<2>>,
    /// The word is valid.
    pub r_valid: Signal<Out, Bit>,
    /// The word is accepted in this cycle.
    pub r_ready: Signal<In, Bit>,
}

impl Circuit for AxiLiteSlave {}
