//! The circuits, in the order in which data passes (docs/calculator.md).
//!
//! | block | does |
//! |---|---|
//! | [`pair_store`], [`dense_store`] | vectors in, (index, value) pairs out (M, F); or all elements (I) |
//! | [`base_ring`] | base words that wait for their sums (M) |
//! | [`window_ring`] | windows that wait for F |
//! | [`sequencer`] | which step of which pass is next |
//! | [`pair_operands`], [`dense_operands`] | addresses and values for the multipliers |
//! | [`drain`] | when sums are copied and taken |
//! | [`requantize`], [`shrink`], [`difference`] | from a sum to the output words |
//! | [`results`] | the pipeline of these, with bases and thresholds |
//! | [`counters`], [`registers`] | what the host sees and sets |
//! | [`reader`] | what the host reads back, and its CRC |
//! | [`window_guard`] | whole windows, whatever comes |
//! | [`stage`] | all of the above: I, M or F |
//! | [`chain`] | the stages of a design |
//!
//! Leaves, each in `rtl/` and here as its model: [`macc_array`], all banks of a stage; [`ram`], [`fifo`], [`add`], [`delay`].

pub mod add;
pub mod base_ring;
pub mod chain;
pub mod counters;
pub mod crc;
pub mod delay;
pub mod dense_operands;
pub mod dense_store;
pub mod difference;
pub mod drain;
pub mod fifo;
pub mod frame_check;
pub mod macc_array;
pub mod pair_operands;
pub mod pair_store;
pub mod ram;
pub mod reader;
pub mod registers;
pub mod requantize;
pub mod results;
pub mod sequencer;
pub mod shrink;
pub mod stage;
pub mod start;
pub mod window_guard;
pub mod window_ring;

use edof_device::design::StagePlan;
use rust_hdl::prelude::{Bits, Constant};

/// A 16-bit word of a vector, in two's complement.
pub type Word = Bits<16>;
/// Two words, the even one low.
pub type Pair = Bits<32>;
/// A sum on its way out of the DSPs, in two's complement.
pub type Sum = Bits<48>;
/// A row of a memory; each memory uses as many bits as it has rows.
pub type Row = Bits<12>;
/// What the sequencer must know of a vector: steps before the last one in bits 11 to 4, one step only, no pairs, an odd number, set.
pub type Descriptor = Bits<12>;
/// Rows of two elements that a slot of a store has.
pub(crate) const SLOT_ROWS: usize = 128;
/// A number of things that other constants follow from.
pub type Whole = Bits<16>;
/// Position of an element among the inputs of a stage.
pub type Index = Bits<9>;
/// An element's index above its value.
pub type IndexedValue = Bits<25>;

/// A number of things.
fn whole(number: usize) -> Constant<Whole> {
    Constant::new((number as u64).into())
}

/// Suffix of a stage's module name: one that sends differences is another module.
fn role(stage: &StagePlan) -> String {
    if stage.sends_difference { "difference".into() } else { String::new() }
}
