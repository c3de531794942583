//! The CRC of every frame that passes a boundary.

use super::crc::Crc;
use super::delay::Delay;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// The CRC (`edof_device::crc`) of every frame of beats that passes a boundary, and how many frames there were. It only looks: nothing waits for it.
/// A snapshot copies the last whole frame's CRC and number to where they are shown, so that those of several boundaries belong together.
#[derive(Circuit)]
#[circuit(default(Crc, Delay))]
pub struct FrameCheck<const W: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The next beat is a frame's first, and the first frame's.
    pub reset: Signal<In, Bit>,
    /// A beat passes in this cycle.
    pub valid: Signal<In, Bit>,
    /// It.
    pub data: Signal<In, Bits<W>>,
    /// Copies CRC and number.
    pub snapshot: Signal<In, Bit>,
    /// CRC of the last frame that was whole when the snapshot was taken; 0 before.
    pub crc: Signal<Out, Bits<32>>,
    /// Frames that were whole by then, modulo 256.
    pub frames: Signal<Out, Bits<8>>,
    last_beat: Constant<Bits<28>>,
    // Two registers of their own, a cycle after the reset: it leads to few registers each time.
    resets: Delay<2, 1>,
    made: Crc<W>,
    valid_q: DFF<Bit>,
    fresh: DFF<Bit>,
    left: DFF<Bits<28>>,
    at_end: DFF<Bit>,
    ends: DFF<Bit>,
    whole: DFF<Bits<32>>,
    frames_q: DFF<Bits<8>>,
    shown: DFF<Bits<32>>,
    shown_frames: DFF<Bits<8>>,
}

impl<const W: usize> FrameCheck<W> {
    /// Of frames of so many beats, two or more.
    #[must_use]
    pub fn new(beats: usize) -> Self {
        Self::from_parts(FrameCheckParts { last_beat: Constant::new((beats as u64 - 1).into()) })
    }
}

impl<const W: usize> Logic for FrameCheck<W> {
    #[kernel]
    fn update(&mut self) {
        dff_setup!(self, clock, valid_q, fresh, left, at_end, ends, whole, frames_q, shown, shown_frames);
        self.made.clock.next = self.clock.val();
        self.resets.clock.next = self.clock.val();
        self.resets.now.next = 0.into();
        if self.reset.val() {
            self.resets.now.next = 3.into();
        }
        self.valid_q.d.next = self.valid.val();
        self.made.valid.next = self.valid_q.q.val();
        self.made.first.next = self.fresh.q.val();
        self.made.data.next = self.data.val();

        // Which beat it is; the CRC is made a cycle after its last one.
        self.ends.d.next = self.valid_q.q.val() && self.at_end.q.val();
        if self.valid_q.q.val() {
            self.fresh.d.next = self.at_end.q.val();
            self.left.d.next = self.left.q.val() - 1;
            self.at_end.d.next = self.left.q.val() == 1;
            if self.at_end.q.val() {
                self.left.d.next = self.last_beat.val();
            }
        }
        if self.ends.q.val() {
            self.whole.d.next = self.made.crc.val();
            self.frames_q.d.next = self.frames_q.q.val() + 1;
        }
        if self.snapshot.val() {
            self.shown.d.next = self.whole.q.val();
            self.shown_frames.d.next = self.frames_q.q.val();
        }
        self.crc.next = self.shown.q.val();
        self.frames.next = self.shown_frames.q.val();

        if self.reset.val() {
            self.valid_q.d.next = false;
            self.fresh.d.next = true;
            self.left.d.next = self.last_beat.val();
            self.at_end.d.next = false;
            self.ends.d.next = false;
        }
        if self.resets.later.val().get_bit(0) {
            self.whole.d.next = 0.into();
            self.frames_q.d.next = 0.into();
        }
        if self.resets.later.val().get_bit(1) {
            self.shown.d.next = 0.into();
            self.shown_frames.d.next = 0.into();
        }
    }
}
