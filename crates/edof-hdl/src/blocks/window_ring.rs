//! Windows that wait for F's linear path.

use super::ram::{Ram, Shape};
use super::{Pair, Row};
use crate::describe::Circuit;
use edof_spec::design::{BEAT, StagePlan};
use rust_hdl::prelude::*;

/// Windows that wait for F's linear path: a ring of whole windows in block RAM.
/// Ready while there is room for one more. Two pixels are read a cycle after read_pair, from the oldest window.
#[derive(Circuit)]
pub struct WindowRing {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties it.
    pub reset: Signal<In, Bit>,
    /// A beat stands on the input.
    pub valid: Signal<In, Bit>,
    /// It is taken in this cycle, if there is one.
    pub ready: Signal<Out, Bit>,
    /// Its two pixels.
    pub pixels: Signal<In, Pair>,
    /// Whether it is its window's last.
    pub last: Signal<In, Bit>,
    /// Which two pixels of the oldest window to read.
    pub read_pair: Signal<In, Bits<8>>,
    /// They, a cycle later.
    pub read_pixels: Signal<Out, Pair>,
    /// Frees the oldest window.
    pub finished: Signal<In, Bit>,
    ram: Ram<32>,
    window_rows: Constant<Row>,
    last_row: Constant<Row>,
    last_window: Constant<Row>,
    most: Constant<Bits<6>>,
    write_row: DFF<Row>,
    oldest_row: DFF<Row>,
    held: DFF<Bits<6>>,
    accept: Signal<Local, Bit>,
    arrived: Signal<Local, Bit>,
}

impl WindowRing {
    /// The ring of an F stage with a linear path.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let window = (stage.linear / BEAT) as u64;
        let depth = window * stage.kept_windows as u64;
        Self::from_parts(WindowRingParts {
            ram: Ram::new(Shape::block(depth as usize), &[]),
            window_rows: Constant::new(window.into()),
            last_row: Constant::new((depth - 1).into()),
            last_window: Constant::new((depth - window).into()),
            most: Constant::new((stage.kept_windows as u64).into()),
        })
    }
}

impl Logic for WindowRing {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, write_row, oldest_row, held);
        self.ram.clock.next = self.clock.val();

        self.ready.next = self.held.q.val() != self.most.val();
        self.accept.next = self.valid.val() && (self.held.q.val() != self.most.val());
        self.arrived.next = self.accept.val() && self.last.val();
        self.ram.write_enable.next = self.accept.val();
        self.ram.write_address.next = self.write_row.q.val();
        self.ram.write_data.next = self.pixels.val();
        self.ram.read_address.next = self.oldest_row.q.val() + bit_cast::<12, 8>(self.read_pair.val());
        self.read_pixels.next = self.ram.read_data.val();

        if self.accept.val() {
            self.write_row.d.next = self.write_row.q.val() + 1;
            if self.write_row.q.val() == self.last_row.val() {
                self.write_row.d.next = 0.into();
            }
        }
        if self.finished.val() {
            self.oldest_row.d.next = self.oldest_row.q.val() + self.window_rows.val();
            if self.oldest_row.q.val() == self.last_window.val() {
                self.oldest_row.d.next = 0.into();
            }
        }
        if self.arrived.val() && !self.finished.val() {
            self.held.d.next = self.held.q.val() + 1;
        } else if self.finished.val() && !self.arrived.val() {
            self.held.d.next = self.held.q.val() - 1;
        }
        if self.reset.val() {
            self.write_row.d.next = 0.into();
            self.oldest_row.d.next = 0.into();
            self.held.d.next = 0.into();
        }
    }
}
