//! From dense vectors to (index, value) pairs.

use super::ram::{Ram, Shape};
use super::{Index, IndexedValue, Row, Word};
use crate::describe::Circuit;
use edof_spec::design::{BEAT, StagePlan};
use rust_hdl::prelude::*;

/// From dense vectors to (index, value) pairs: two slots, one fills while the other is read, as often as there are passes.
/// Ready while fewer than two slots are full. With skip_zeros only non-zero elements are kept. A pair is read a cycle
/// after read_pair; pair 2r lies at row r of the even memory, pair 2r + 1 at row r of the odd one.
#[derive(Circuit)]
pub struct PairBuffer {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties both slots.
    pub reset: Signal<In, Bit>,
    /// Whether zeros are left out.
    pub skip_zeros: Signal<In, Bit>,
    /// A beat stands on the input.
    pub valid: Signal<In, Bit>,
    /// It is taken in this cycle, if there is one.
    pub ready: Signal<Out, Bit>,
    /// Element of even index.
    pub even: Signal<In, Word>,
    /// Element of odd index.
    pub odd: Signal<In, Word>,
    /// Whether the beat is its vector's last.
    pub last: Signal<In, Bit>,
    /// The vector's set.
    pub set: Signal<In, Bit>,
    /// A vector waits to be read.
    pub available: Signal<Out, Bit>,
    /// Its pairs.
    pub count: Signal<Out, Index>,
    /// Its set.
    pub front_set: Signal<Out, Bit>,
    /// Which pair to read, divided by two.
    pub read_pair: Signal<In, Bits<8>>,
    /// The even one of the two read, a cycle later.
    pub even_pair: Signal<Out, IndexedValue>,
    /// The odd one.
    pub odd_pair: Signal<Out, IndexedValue>,
    /// Frees the slot that is read.
    pub finished: Signal<In, Bit>,
    even_pairs: Ram<25>,
    odd_pairs: Ram<25>,
    slot_rows: Constant<Row>,
    beat: DFF<Bits<8>>,
    stored: DFF<Index>,
    write_slot: DFF<Bit>,
    read_slot: DFF<Bit>,
    full: DFF<Bits<2>>,
    count_0: DFF<Index>,
    count_1: DFF<Index>,
    set_0: DFF<Bit>,
    set_1: DFF<Bit>,
    accept: Signal<Local, Bit>,
    arrived: Signal<Local, Bit>,
    keep_even: Signal<Local, Bit>,
    keep_odd: Signal<Local, Bit>,
    keep_one: Signal<Local, Bit>,
    keep_both: Signal<Local, Bit>,
    arrived_even: Signal<Local, IndexedValue>,
    arrived_odd: Signal<Local, IndexedValue>,
    arrived_first: Signal<Local, IndexedValue>,
    stored_next: Signal<Local, Index>,
    write_row: Signal<Local, Row>,
    read_row: Signal<Local, Row>,
}

impl PairBuffer {
    /// The pair buffer of a stage.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let shape = Shape::distributed(stage.inputs);
        Self::from_parts(PairBufferParts {
            even_pairs: Ram::new(shape.clone(), &[]),
            odd_pairs: Ram::new(shape, &[]),
            slot_rows: Constant::new(((stage.inputs / BEAT) as u64).into()),
        })
    }
}

impl Logic for PairBuffer {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, beat, stored, write_slot, read_slot, full, count_0, count_1, set_0, set_1);
        self.even_pairs.clock.next = self.clock.val();
        self.odd_pairs.clock.next = self.clock.val();

        self.ready.next = self.full.q.val() != 2;
        self.accept.next = self.valid.val() && (self.full.q.val() != 2);
        self.arrived.next = self.accept.val() && self.last.val();
        self.keep_even.next = self.accept.val() && (!self.skip_zeros.val() || self.even.val().any());
        self.keep_odd.next = self.accept.val() && (!self.skip_zeros.val() || self.odd.val().any());
        self.keep_one.next = self.keep_even.val() || self.keep_odd.val();
        self.keep_both.next = self.keep_even.val() && self.keep_odd.val();

        self.arrived_even.next =
            (bit_cast::<25, 8>(self.beat.q.val()) << 17) | bit_cast::<25, 16>(self.even.val());
        self.arrived_odd.next =
            (bit_cast::<25, 8>(self.beat.q.val()) << 17) | bit_cast::<25, 16>(self.odd.val()) | 0x1_0000;
        self.arrived_first.next = self.arrived_odd.val();
        if self.keep_even.val() {
            self.arrived_first.next = self.arrived_even.val();
        }

        self.write_row.next = bit_cast::<12, 9>(self.stored.q.val()) >> 1;
        if self.write_slot.q.val() {
            self.write_row.next = (bit_cast::<12, 9>(self.stored.q.val()) >> 1) + self.slot_rows.val();
        }
        self.even_pairs.write_enable.next = self.keep_one.val();
        self.even_pairs.write_address.next = self.write_row.val();
        self.even_pairs.write_data.next = self.arrived_first.val();
        self.odd_pairs.write_enable.next = self.keep_both.val();
        self.odd_pairs.write_address.next = self.write_row.val();
        self.odd_pairs.write_data.next = self.arrived_odd.val();
        if self.stored.q.val().get_bit(0) {
            self.even_pairs.write_enable.next = self.keep_both.val();
            self.even_pairs.write_address.next = self.write_row.val() + 1;
            self.even_pairs.write_data.next = self.arrived_odd.val();
            self.odd_pairs.write_enable.next = self.keep_one.val();
            self.odd_pairs.write_data.next = self.arrived_first.val();
        }

        self.stored_next.next = self.stored.q.val();
        if self.keep_both.val() {
            self.stored_next.next = self.stored.q.val() + 2;
        } else if self.keep_one.val() {
            self.stored_next.next = self.stored.q.val() + 1;
        }
        if self.accept.val() {
            self.beat.d.next = self.beat.q.val() + 1;
            self.stored.d.next = self.stored_next.val();
        }
        if self.arrived.val() {
            self.beat.d.next = 0.into();
            self.stored.d.next = 0.into();
            self.write_slot.d.next = !self.write_slot.q.val();
            if self.write_slot.q.val() {
                self.count_1.d.next = self.stored_next.val();
                self.set_1.d.next = self.set.val();
            } else {
                self.count_0.d.next = self.stored_next.val();
                self.set_0.d.next = self.set.val();
            }
        }

        self.available.next = self.full.q.val().any();
        self.count.next = self.count_0.q.val();
        self.front_set.next = self.set_0.q.val();
        if self.read_slot.q.val() {
            self.count.next = self.count_1.q.val();
            self.front_set.next = self.set_1.q.val();
        }
        // Apart from the count, on which read_pair depends: together they would be one process, and never come to rest.
        self.read_row.next = bit_cast::<12, 8>(self.read_pair.val());
        if self.read_slot.q.val() {
            self.read_row.next = bit_cast::<12, 8>(self.read_pair.val()) + self.slot_rows.val();
        }
        self.even_pairs.read_address.next = self.read_row.val();
        self.odd_pairs.read_address.next = self.read_row.val();
        self.even_pair.next = self.even_pairs.read_data.val();
        self.odd_pair.next = self.odd_pairs.read_data.val();

        if self.finished.val() {
            self.read_slot.d.next = !self.read_slot.q.val();
        }
        if self.arrived.val() && !self.finished.val() {
            self.full.d.next = self.full.q.val() + 1;
        } else if self.finished.val() && !self.arrived.val() {
            self.full.d.next = self.full.q.val() - 1;
        }
        if self.reset.val() {
            self.beat.d.next = 0.into();
            self.stored.d.next = 0.into();
            self.write_slot.d.next = false;
            self.read_slot.d.next = false;
            self.full.d.next = 0.into();
        }
    }
}
