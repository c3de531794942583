//! Base words that wait for their sums (M).

use super::ram::{Ram, Shape};
use super::{Pair, Row};
use crate::describe::Circuit;
use edof_spec::design::{StagePlan, timing};
use rust_hdl::prelude::*;

/// Base words that wait for their sums: a ring of whole vectors, written as they arrive, read as their sums are taken.
/// It never overflows: a stage holds at most two vectors in its pair buffer and one in its multipliers and drain.
#[derive(Circuit)]
pub struct BaseRing {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties it.
    pub reset: Signal<In, Bit>,
    /// A beat arrives.
    pub write: Signal<In, Bit>,
    /// Its two base words.
    pub words: Signal<In, Pair>,
    /// Moves on to the next two.
    pub read: Signal<In, Bit>,
    /// The two that stood first a cycle ago.
    pub front: Signal<Out, Pair>,
    ram: Ram<32>,
    last_row: Constant<Row>,
    write_row: DFF<Row>,
    read_row: DFF<Row>,
}

impl BaseRing {
    /// The ring of an M stage.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let depth = stage.beats_in() * timing::BASE_VECTORS;
        Self::from_parts(BaseRingParts {
            ram: Ram::new(Shape::distributed(depth), &[]),
            last_row: Constant::new((depth as u64 - 1).into()),
        })
    }
}

impl Logic for BaseRing {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, write_row, read_row);
        self.ram.clock.next = self.clock.val();
        self.ram.write_enable.next = self.write.val();
        self.ram.write_address.next = self.write_row.q.val();
        self.ram.write_data.next = self.words.val();
        self.ram.read_address.next = self.read_row.q.val();
        self.front.next = self.ram.read_data.val();

        if self.write.val() {
            self.write_row.d.next = self.write_row.q.val() + 1;
            if self.write_row.q.val() == self.last_row.val() {
                self.write_row.d.next = 0.into();
            }
        }
        if self.read.val() {
            self.read_row.d.next = self.read_row.q.val() + 1;
            if self.read_row.q.val() == self.last_row.val() {
                self.read_row.d.next = 0.into();
            }
        }
        if self.reset.val() {
            self.write_row.d.next = 0.into();
            self.read_row.d.next = 0.into();
        }
    }
}
