//! From dense vectors to (index, value) pairs (M, F).

use super::ram::{Ram, Shape};
use super::{Descriptor, Index, IndexedValue, Row, Word};
use crate::describe::{Circuit, kernel};
use edof_device::design::{StagePlan, timing};
use rust_hdl::prelude::*;

/// From dense vectors to (index, value) pairs: four slots, one fills while others wait and one is read, as often as there are passes.
/// Ready while fewer than four are full. With skip_zeros only non-zero elements are kept. Pair 2r of slot s lies at row 128 s + r of
/// the even memory, pair 2r + 1 at the same row of the odd one; both are read two cycles after read_row. A vector's descriptor comes three
/// cycles after its last beat.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct PairStore {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties all slots.
    pub reset: Signal<In, Bit>,
    /// Whether zeros are left out.
    pub skip_zeros: Signal<In, Bit>,
    /// The input beat is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Element of even index.
    pub even: Signal<In, Word>,
    /// Element of odd index.
    pub odd: Signal<In, Word>,
    /// Whether the beat is its vector's last.
    pub last: Signal<In, Bit>,
    /// The vector's set.
    pub set: Signal<In, Bit>,
    /// A vector is whole.
    pub arrived: Signal<Out, Bit>,
    /// What the sequencer must know of it.
    pub descriptor: Signal<Out, Descriptor>,
    /// Which two pairs to read.
    pub read_row: Signal<In, Bits<9>>,
    /// The even one of the two, two cycles later.
    pub even_pair: Signal<Out, IndexedValue>,
    /// The odd one.
    pub odd_pair: Signal<Out, IndexedValue>,
    /// Frees the slot that is read.
    pub finished: Signal<In, Bit>,
    /// 1 in the stage that is dense (I), where the memories are absent.
    dense: Constant<Bit>,
    #[is(DEPTH = if dense { 0 } else { 512 })]
    even_pairs: Ram<25>,
    #[is(DEPTH = if dense { 0 } else { 512 })]
    odd_pairs: Ram<25>,
    two_rows: Constant<Bit>,
    all_slots: Constant<Bits<3>>,
    #[reset(0)]
    full: DFF<Bits<3>>,
    #[reset(false)]
    ready_q: DFF<Bit>,
    full_next: Signal<Local, Bits<3>>,
    accept: Signal<Local, Bit>,
    // A cycle after a beat came.
    #[reset(false)]
    valid_1: DFF<Bit>,
    even_1: DFF<Word>,
    odd_1: DFF<Word>,
    last_1: DFF<Bit>,
    set_1: DFF<Bit>,
    // Two cycles after.
    #[reset(false)]
    valid_2: DFF<Bit>,
    #[reset(false)]
    store_even_2: DFF<Bit>,
    #[reset(false)]
    store_odd_2: DFF<Bit>,
    even_2: DFF<Word>,
    odd_2: DFF<Word>,
    last_2: DFF<Bit>,
    set_2: DFF<Bit>,
    #[reset(0)]
    beat: DFF<Bits<8>>,
    #[reset(0)]
    stored: DFF<Index>,
    #[reset(0)]
    write_slot: DFF<Bits<2>>,
    // Three cycles after.
    #[reset(false)]
    even_write_3: DFF<Bit>,
    #[reset(false)]
    odd_write_3: DFF<Bit>,
    even_row_3: DFF<Row>,
    odd_row_3: DFF<Row>,
    even_data_3: DFF<IndexedValue>,
    odd_data_3: DFF<IndexedValue>,
    #[reset(false)]
    arrived_3: DFF<Bit>,
    count_3: DFF<Index>,
    set_3: DFF<Bit>,
    store_one: Signal<Local, Bit>,
    store_both: Signal<Local, Bit>,
    arrived_even: Signal<Local, IndexedValue>,
    arrived_odd: Signal<Local, IndexedValue>,
    arrived_first: Signal<Local, IndexedValue>,
    stored_next: Signal<Local, Index>,
    row: Signal<Local, Row>,
    before_last: Signal<Local, Index>,
    steps: Signal<Local, Bits<8>>,
    flags: Signal<Local, Bits<4>>,
}

impl PairStore {
    /// The store of an M or F stage; that of an I has no memory.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let shape = Shape::registered(if stage.is_dense() { 0 } else { timing::SLOTS * super::SLOT_ROWS });
        Self::from_parts(PairStoreParts {
            dense: Constant::new(stage.is_dense()),
            even_pairs: Ram::new(shape.clone(), &[]),
            odd_pairs: Ram::new(shape, &[]),
            two_rows: Constant::new(stage.reads_both_ports()),
            all_slots: Constant::new((timing::SLOTS as u64).into()),
        })
    }
}

impl Logic for PairStore {
    #[kernel]
    fn update(&mut self) {
        self.even_pairs.clock.next = self.clock.val();
        self.odd_pairs.clock.next = self.clock.val();

        // Room for a vector.
        self.ready.next = self.ready_q.q.val();
        self.accept.next = self.valid.val() && self.ready_q.q.val();
        self.full_next.next = self.full.q.val();
        if self.accept.val() && self.last.val() && !self.finished.val() {
            self.full_next.next = self.full.q.val() + 1;
        } else if self.finished.val() && !(self.accept.val() && self.last.val()) {
            self.full_next.next = self.full.q.val() - 1;
        }
        self.full.d.next = self.full_next.val();
        self.ready_q.d.next = self.full_next.val() != self.all_slots.val();

        // Which elements are kept.
        self.valid_1.d.next = self.accept.val();
        self.even_1.d.next = self.even.val();
        self.odd_1.d.next = self.odd.val();
        self.last_1.d.next = self.last.val();
        self.set_1.d.next = self.set.val();
        self.valid_2.d.next = self.valid_1.q.val();
        self.store_even_2.d.next =
            self.valid_1.q.val() && (!self.skip_zeros.val() || self.even_1.q.val().any());
        self.store_odd_2.d.next =
            self.valid_1.q.val() && (!self.skip_zeros.val() || self.odd_1.q.val().any());
        self.even_2.d.next = self.even_1.q.val();
        self.odd_2.d.next = self.odd_1.q.val();
        self.last_2.d.next = self.last_1.q.val();
        self.set_2.d.next = self.set_1.q.val();

        // Where they go.
        self.store_one.next = self.store_even_2.q.val() || self.store_odd_2.q.val();
        self.store_both.next = self.store_even_2.q.val() && self.store_odd_2.q.val();
        self.arrived_even.next =
            (bit_cast::<25, 8>(self.beat.q.val()) << 17) | bit_cast::<25, 16>(self.even_2.q.val());
        self.arrived_odd.next =
            (bit_cast::<25, 8>(self.beat.q.val()) << 17) | bit_cast::<25, 16>(self.odd_2.q.val()) | 0x1_0000;
        self.arrived_first.next = self.arrived_odd.val();
        if self.store_even_2.q.val() {
            self.arrived_first.next = self.arrived_even.val();
        }
        self.row.next = (bit_cast::<12, 2>(self.write_slot.q.val()) << 7)
            | (bit_cast::<12, 8>(self.stored.q.val().get_bits::<8>(1)));
        self.even_write_3.d.next = self.store_one.val();
        self.even_row_3.d.next = self.row.val();
        self.even_data_3.d.next = self.arrived_first.val();
        self.odd_write_3.d.next = self.store_both.val();
        self.odd_row_3.d.next = self.row.val();
        self.odd_data_3.d.next = self.arrived_odd.val();
        if self.stored.q.val().get_bit(0) {
            self.even_write_3.d.next = self.store_both.val();
            self.even_row_3.d.next = self.row.val() + 1;
            self.even_data_3.d.next = self.arrived_odd.val();
            self.odd_write_3.d.next = self.store_one.val();
            self.odd_data_3.d.next = self.arrived_first.val();
        }
        self.stored_next.next = self.stored.q.val();
        if self.store_both.val() {
            self.stored_next.next = self.stored.q.val() + 2;
        } else if self.store_one.val() {
            self.stored_next.next = self.stored.q.val() + 1;
        }
        if self.valid_2.q.val() {
            self.beat.d.next = self.beat.q.val() + 1;
            self.stored.d.next = self.stored_next.val();
            if self.last_2.q.val() {
                self.beat.d.next = 0.into();
                self.stored.d.next = 0.into();
                self.write_slot.d.next = self.write_slot.q.val() + 1;
            }
        }
        self.arrived_3.d.next = self.valid_2.q.val() && self.last_2.q.val();
        self.count_3.d.next = self.stored_next.val();
        self.set_3.d.next = self.set_2.q.val();

        // Written; and what the sequencer must know: steps before the last, and whether the last one lacks a second pair.
        self.even_pairs.write_enable.next = self.even_write_3.q.val();
        self.even_pairs.write_address.next = self.even_row_3.q.val();
        self.even_pairs.write_data.next = self.even_data_3.q.val();
        self.odd_pairs.write_enable.next = self.odd_write_3.q.val();
        self.odd_pairs.write_address.next = self.odd_row_3.q.val();
        self.odd_pairs.write_data.next = self.odd_data_3.q.val();
        self.before_last.next = self.count_3.q.val() - 1;
        self.steps.next = self.before_last.val().get_bits::<8>(0);
        self.flags.next = 0.into();
        if self.set_3.q.val() {
            self.flags.next = 1.into();
        }
        if self.count_3.q.val().get_bit(0) {
            self.flags.next = self.flags.val() | 2;
        }
        if self.count_3.q.val() == 1 {
            self.flags.next = self.flags.val() | 8;
        }
        if self.two_rows.val() {
            self.steps.next = bit_cast::<8, 9>(self.before_last.val() >> 1);
            if self.count_3.q.val() == 2 {
                self.flags.next = self.flags.val() | 8;
            }
        }
        if !self.count_3.q.val().any() {
            self.steps.next = 0.into();
            self.flags.next = self.flags.val() | 14;
        }
        self.arrived.next = self.arrived_3.q.val();
        self.descriptor.next =
            (bit_cast::<12, 8>(self.steps.val()) << 4) | bit_cast::<12, 4>(self.flags.val());

        // Read.
        self.even_pairs.read_address.next = bit_cast::<12, 9>(self.read_row.val());
        self.odd_pairs.read_address.next = bit_cast::<12, 9>(self.read_row.val());
        self.even_pair.next = self.even_pairs.read_data.val();
        self.odd_pair.next = self.odd_pairs.read_data.val();
    }
}
