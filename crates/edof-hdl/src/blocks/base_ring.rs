//! Base words that wait for their sums (M).

use super::ram::{Ram, Shape};
use super::{Pair, Whole, whole};
use crate::describe::{Circuit, kernel};
use edof_device::design::{StagePlan, timing};
use rust_hdl::prelude::*;

/// Base words that wait for their sums: a ring of eight vectors in block RAM, written as they arrive, read as their sums are taken.
/// The ring never overflows: a stage holds at most four vectors in its store and three in its multipliers and drain. Vector v lies from row
/// 128 v on.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct BaseRing {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties the memory.
    pub reset: Signal<In, Bit>,
    /// A beat arrives.
    pub write: Signal<In, Bit>,
    /// Two base words of the beat.
    pub words: Signal<In, Pair>,
    /// Moves on to the next two.
    pub read: Signal<In, Bit>,
    /// The two that stood first two cycles ago.
    pub front: Signal<Out, Pair>,
    /// 1 where a base is added (M).
    has_base: Constant<Whole>,
    #[is(DEPTH = has_base * 1024)]
    ram: Ram<32>,
    inputs: Constant<Whole>,
    #[is(inputs / 2 - 1)]
    last_beat: Constant<Bits<7>>,
    #[reset(false)]
    write_q: DFF<Bit>,
    words_q: DFF<Pair>,
    #[reset(0)]
    write_beat: DFF<Bits<7>>,
    #[reset(0)]
    write_vector: DFF<Bits<3>>,
    #[reset(0)]
    read_beat: DFF<Bits<7>>,
    #[reset(0)]
    read_vector: DFF<Bits<3>>,
}

impl BaseRing {
    /// The ring of a stage; it has no memory where no base is added.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let depth = if stage.has_base() { timing::BASE_VECTORS * super::SLOT_ROWS } else { 0 };
        Self::from_parts(BaseRingParts {
            ram: Ram::new(Shape::registered(depth), &[]),
            inputs: whole(stage.inputs),
            has_base: whole(stage.has_base().into()),
        })
    }
}

impl Logic for BaseRing {
    #[kernel]
    fn update(&mut self) {
        self.ram.clock.next = self.clock.val();
        self.write_q.d.next = self.write.val();
        self.words_q.d.next = self.words.val();
        self.ram.write_enable.next = self.write_q.q.val();
        self.ram.write_address.next =
            (bit_cast::<12, 3>(self.write_vector.q.val()) << 7) | bit_cast::<12, 7>(self.write_beat.q.val());
        self.ram.write_data.next = self.words_q.q.val();
        self.ram.read_address.next =
            (bit_cast::<12, 3>(self.read_vector.q.val()) << 7) | bit_cast::<12, 7>(self.read_beat.q.val());
        self.front.next = self.ram.read_data.val();

        if self.write_q.q.val() {
            self.write_beat.d.next = self.write_beat.q.val() + 1;
            if self.write_beat.q.val() == self.last_beat.val() {
                self.write_beat.d.next = 0.into();
                self.write_vector.d.next = self.write_vector.q.val() + 1;
            }
        }
        if self.read.val() {
            self.read_beat.d.next = self.read_beat.q.val() + 1;
            if self.read_beat.q.val() == self.last_beat.val() {
                self.read_beat.d.next = 0.into();
                self.read_vector.d.next = self.read_vector.q.val() + 1;
            }
        }
    }
}
