//! AXI4-Stream, as AXI4-Stream video uses it (Xilinx UG934).

#![allow(missing_docs, reason = "rust-hdl's derive writes `join` without documentation")]

use crate::describe::Circuit;
use rust_hdl::prelude::*;

/// A stream out of a block: one beat of `W` bits a cycle in which both `valid` and `ready` are high.
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "StreamIn"]
pub struct StreamOut<const W: usize> {
    /// A beat is offered. It and the beat stand until `ready`.
    pub valid: Signal<Out, Bit>,
    /// The beat.
    pub data: Signal<Out, Bits<W>>,
    /// The beat is the first of a frame.
    pub user: Signal<Out, Bit>,
    /// The beat is the last of a line, of a window or of a patch.
    pub last: Signal<Out, Bit>,
    /// The receiver takes what is offered.
    pub ready: Signal<In, Bit>,
}

/// A stream into a block: the other end of [`StreamOut`].
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "StreamOut"]
pub struct StreamIn<const W: usize> {
    /// A beat is offered. It and the beat stand until `ready`.
    pub valid: Signal<In, Bit>,
    /// The beat.
    pub data: Signal<In, Bits<W>>,
    /// The beat is the first of a frame.
    pub user: Signal<In, Bit>,
    /// The beat is the last of a line, of a window or of a patch.
    pub last: Signal<In, Bit>,
    /// The block takes what is offered.
    pub ready: Signal<Out, Bit>,
}

impl<const W: usize> Circuit for StreamOut<W> {}
impl<const W: usize> Circuit for StreamIn<W> {}
