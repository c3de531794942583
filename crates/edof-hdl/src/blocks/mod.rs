//! The circuits, in the order in which data passes (docs/calculator.md).
//!
//! | block | does |
//! |---|---|
//! | [`pair_buffer`] | vectors in, (index, value) pairs out |
//! | [`base_ring`] | base words that wait for their sums (M) |
//! | [`window_ring`] | windows that wait for F |
//! | [`sequencer`] | addresses and values for the multipliers, pass by pass |
//! | [`macc_array`] | all banks of a stage in a chain |
//! | [`drain`] | when sums are copied and taken |
//! | [`requantize`], [`shrink`], [`difference`] | from a sum to the words that go on |
//! | [`results`] | the pipeline of these, with bases and thresholds |
//! | [`counters`], [`registers`] | what the host sees and sets |
//! | [`stage`] | all of the above: I, M or F |
//! | [`chain`] | the stages of a design |
//!
//! Leaves, each in `rtl/` and here as its model: [`ram`], [`fifo`], [`macc_bank`]. [`delay`] is a row of registers.

pub mod base_ring;
pub mod chain;
pub mod counters;
pub mod delay;
pub mod difference;
pub mod drain;
pub mod fifo;
pub mod macc_array;
pub mod macc_bank;
pub mod pair_buffer;
pub mod ram;
pub mod registers;
pub mod requantize;
pub mod results;
pub mod sequencer;
pub mod shrink;
pub mod stage;
pub mod window_ring;

use edof_spec::design::{Kind, StagePlan};
use rust_hdl::prelude::Bits;

/// A 16-bit word of a vector, in two's complement.
pub type Word = Bits<16>;
/// Two words, the even one low.
pub type Pair = Bits<32>;
/// A sum on its way out of the DSPs, in two's complement.
pub type Sum = Bits<48>;
/// A row of a memory; each memory uses as many bits as it has rows.
pub type Row = Bits<12>;
/// Position of an element among the inputs of a stage.
pub type Index = Bits<9>;
/// An element's index above its value.
pub type IndexedValue = Bits<25>;

/// What tells stages apart, in the names of their modules.
fn role(stage: &StagePlan) -> String {
    match stage.kind {
        Kind::I => "i",
        Kind::M if stage.feeds_m => "m",
        Kind::M => "m_last",
        Kind::F => "f",
    }
    .into()
}
