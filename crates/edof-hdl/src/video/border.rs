//! Where a screen is, seen by its syncs.

use super::Coordinate;
use crate::describe::{Circuit, kernel};
use edof_device::video::VideoTiming;
use rust_hdl::prelude::*;

/// The places of a screen that pixels are sent for, from positive syncs: a picture that is smaller than the screen has a border in its porches.
/// All a cycle later; no pixel before the first vertical sync.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct Border {
    /// The pixel clock.
    pub clock: Signal<In, Clock>,
    /// No pixels until the next vertical sync.
    pub reset: Signal<In, Bit>,
    /// Horizontal sync.
    pub hs: Signal<In, Bit>,
    /// Vertical sync, whose edges are those of a horizontal sync.
    pub vs: Signal<In, Bit>,
    /// Horizontal sync, a cycle later.
    pub hs_later: Signal<Out, Bit>,
    /// Vertical sync, a cycle later.
    pub vs_later: Signal<Out, Bit>,
    /// A pixel is sent.
    pub de: Signal<Out, Bit>,
    first_column: Constant<Coordinate>,
    end_column: Constant<Coordinate>,
    first_row: Constant<Coordinate>,
    end_row: Constant<Coordinate>,
    hs_q: DFF<Bit>,
    vs_q: DFF<Bit>,
    #[reset(true)]
    vs_of_line: DFF<Bit>,
    column: DFF<Coordinate>,
    #[reset(end_row)]
    row: DFF<Coordinate>,
    #[reset(false)]
    in_rows: DFF<Bit>,
    #[reset(false)]
    de_q: DFF<Bit>,
    begins: Signal<Local, Bit>,
}

impl Border {
    /// For a screen's timing.
    #[must_use]
    pub fn new(timing: VideoTiming) -> Self {
        let number = |value: usize| Constant::new((value as u64).into());
        let (line, frame) = (timing.line, timing.frame);
        Self::from_parts(BorderParts {
            first_column: number(line.sync + line.back),
            end_column: number(line.sync + line.back + line.active),
            first_row: number(frame.sync + frame.back),
            end_row: number(frame.sync + frame.back + frame.active),
        })
    }
}

impl Logic for Border {
    #[kernel]
    fn update(&mut self) {
        // Columns are counted from the edge of the horizontal sync, rows from that of the vertical one.
        self.begins.next = self.hs.val() && !self.hs_q.q.val();
        self.hs_q.d.next = self.hs.val();
        self.vs_q.d.next = self.vs.val();
        self.column.d.next = self.column.q.val() + 1;
        if self.begins.val() {
            self.column.d.next = 1.into();
            self.vs_of_line.d.next = self.vs.val();
            self.row.d.next = self.row.q.val() + 1;
            if self.row.q.val() == self.first_row.val() {
                self.in_rows.d.next = true;
            }
            if self.row.q.val() == self.end_row.val() {
                self.in_rows.d.next = false;
            }
            if self.vs.val() && !self.vs_of_line.q.val() {
                self.row.d.next = 1.into();
                self.in_rows.d.next = false;
            }
        }
        if self.column.q.val() == self.first_column.val() {
            self.de_q.d.next = self.in_rows.q.val();
        }
        if self.column.q.val() == self.end_column.val() {
            self.de_q.d.next = false;
        }
        self.hs_later.next = self.hs_q.q.val();
        self.vs_later.next = self.vs_q.q.val();
        self.de.next = self.de_q.q.val();
    }
}
