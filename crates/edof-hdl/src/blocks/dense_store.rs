//! Dense vectors that wait for their multipliers (I).

use super::ram::{Ram, Shape};
use super::{Descriptor, Pair, Row};
use crate::describe::{Circuit, kernel};
use edof_device::design::{BEAT, StagePlan, timing};
use rust_hdl::prelude::*;

/// Dense vectors that wait for their multipliers: four slots, in as many memories as the stage takes values at once. Each holds a
/// part of every vector, two elements a row, slot s from row 128 s on. Ready while fewer than four slots are full. Row read_row of
/// all parts is read two cycles later. A vector's descriptor comes three cycles after its last beat.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct DenseStore {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties all slots.
    pub reset: Signal<In, Bit>,
    /// The input beat is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Two elements of the beat, the even one low.
    pub data: Signal<In, Pair>,
    /// Whether the beat is its vector's last.
    pub last: Signal<In, Bit>,
    /// The vector's set.
    pub set: Signal<In, Bit>,
    /// A vector is whole.
    pub arrived: Signal<Out, Bit>,
    /// What the sequencer must know of it.
    pub descriptor: Signal<Out, Descriptor>,
    /// Which two elements of each part to read.
    pub read_row: Signal<In, Bits<9>>,
    /// Two elements of the first part, two cycles after their address.
    pub pair_a: Signal<Out, Pair>,
    /// Of the second.
    pub pair_b: Signal<Out, Pair>,
    /// Of the third.
    pub pair_c: Signal<Out, Pair>,
    /// Of the fourth.
    pub pair_d: Signal<Out, Pair>,
    /// Frees the slot that is read.
    pub finished: Signal<In, Bit>,
    /// 1 in the stage that is dense (I); in others the memories are absent.
    dense: Constant<Bit>,
    #[is(DEPTH = if dense { 512 } else { 0 })]
    parts: Vec<Ram<32>>,
    part_ids: Vec<Constant<Bits<2>>>,
    last_row: Constant<Bits<7>>,
    descriptor_of_set_0: Constant<Descriptor>,
    all_slots: Constant<Bits<3>>,
    #[reset(0)]
    full: DFF<Bits<3>>,
    #[reset(false)]
    ready_q: DFF<Bit>,
    #[reset(false)]
    valid_1: DFF<Bit>,
    data_1: DFF<Pair>,
    last_1: DFF<Bit>,
    set_1: DFF<Bit>,
    #[reset(false)]
    arrived_2: DFF<Bit>,
    set_2: DFF<Bit>,
    #[reset(false)]
    arrived_3: DFF<Bit>,
    set_3: DFF<Bit>,
    #[reset(0)]
    part: DFF<Bits<2>>,
    #[reset(0)]
    row: DFF<Bits<7>>,
    #[reset(0)]
    write_slot: DFF<Bits<2>>,
    accept: Signal<Local, Bit>,
    full_next: Signal<Local, Bits<3>>,
    write_row: Signal<Local, Row>,
    _rows: usize,
    _has_b: usize,
    _has_c: usize,
    _has_d: usize,
}

impl DenseStore {
    /// The store of stage `stage`, an I. Without `is_dense` it is that of another stage of the design, which has no memory.
    #[must_use]
    pub fn new(stage: &StagePlan, is_dense: bool) -> Self {
        let shape = Shape::registered(if is_dense { timing::SLOTS * super::SLOT_ROWS } else { 0 });
        let steps = stage.segment() as u64;
        let single = if steps == 1 { 8 } else { 0 };
        Self::from_parts(DenseStoreParts {
            dense: Constant::new(is_dense),
            parts: (0..stage.rows).map(|_| Ram::new(shape.clone(), &[])).collect(),
            part_ids: (0..stage.rows as u64).map(|part| Constant::new(part.into())).collect(),
            last_row: Constant::new(((stage.segment() / BEAT) as u64 - 1).into()),
            descriptor_of_set_0: Constant::new(((steps - 1) << 4 | single).into()),
            all_slots: Constant::new((timing::SLOTS as u64).into()),
            _rows: stage.rows,
            _has_b: usize::from(stage.rows > 1),
            _has_c: usize::from(stage.rows > 2),
            _has_d: usize::from(stage.rows > 3),
        })
    }
}

impl Logic for DenseStore {
    #[kernel]
    fn update(&mut self) {
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

        // Where a beat goes: one part after the other.
        self.valid_1.d.next = self.accept.val();
        self.data_1.d.next = self.data.val();
        self.last_1.d.next = self.last.val();
        self.set_1.d.next = self.set.val();
        if self.valid_1.q.val() {
            self.row.d.next = self.row.q.val() + 1;
            if self.row.q.val() == self.last_row.val() {
                self.row.d.next = 0.into();
                self.part.d.next = self.part.q.val() + 1;
            }
            if self.last_1.q.val() {
                self.row.d.next = 0.into();
                self.part.d.next = 0.into();
                self.write_slot.d.next = self.write_slot.q.val() + 1;
            }
        }
        self.write_row.next =
            (bit_cast::<12, 2>(self.write_slot.q.val()) << 7) | bit_cast::<12, 7>(self.row.q.val());
        for i in 0..self._rows {
            self.parts[i].clock.next = self.clock.val();
            self.parts[i].write_enable.next =
                self.valid_1.q.val() && (self.part.q.val() == self.part_ids[i].val());
            self.parts[i].write_address.next = self.write_row.val();
            self.parts[i].write_data.next = self.data_1.q.val();
            self.parts[i].read_address.next = bit_cast::<12, 9>(self.read_row.val());
        }
        self.arrived_2.d.next = self.valid_1.q.val() && self.last_1.q.val();
        self.set_2.d.next = self.set_1.q.val();
        self.arrived_3.d.next = self.arrived_2.q.val();
        self.set_3.d.next = self.set_2.q.val();
        self.arrived.next = self.arrived_3.q.val();
        self.descriptor.next = self.descriptor_of_set_0.val();
        if self.set_3.q.val() {
            self.descriptor.next = self.descriptor_of_set_0.val() | 1;
        }

        // Read.
        self.pair_a.next = self.parts[0].read_data.val();
        self.pair_b.next = 0.into();
        self.pair_c.next = 0.into();
        self.pair_d.next = 0.into();
        for i in 0..self._has_b {
            self.pair_b.next = self.parts[i + 1].read_data.val();
        }
        for i in 0..self._has_c {
            self.pair_c.next = self.parts[i + 2].read_data.val();
        }
        for i in 0..self._has_d {
            self.pair_d.next = self.parts[i + 3].read_data.val();
        }
    }
}
