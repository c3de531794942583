//! The CRC of every frame that passes a boundary.

use super::crc::Crc;
use super::delay::Delay;
use super::{Whole, whole};
use crate::describe::{Circuit, kernel};
use edof_device::design::MAX_FRAME_BEATS;
use rust_hdl::prelude::*;

/// The CRC (`edof_device::crc`) of every frame of beats that passes a boundary, and how many frames there were. It only looks: nothing waits for it.
/// A snapshot copies the last whole frame's CRC and number to where they are shown, so that those of several boundaries belong together.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock, reset))]
pub struct FrameCheck {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The next beat is a frame's first, and the first frame's.
    pub reset: Signal<In, Bit>,
    /// A beat passes in this cycle.
    pub valid: Signal<In, Bit>,
    /// The beat, in the low bits.
    pub data: Signal<In, Bits<32>>,
    /// Copies CRC and number.
    pub snapshot: Signal<In, Bit>,
    /// CRC of the last frame that was whole when the snapshot was taken; 0 before.
    pub crc: Signal<Out, Bits<32>>,
    /// Frames that were whole by then, modulo 256.
    pub frames: Signal<Out, Bits<8>>,
    last_beat: Constant<Bits<28>>,
    // Two registers of their own, a cycle after the reset: it leads to few registers each time.
    resets: Delay<2, 1>,
    /// Bits of a beat.
    width: Constant<Whole>,
    #[is(WIDTH = width)]
    frame_crc: Crc,
    #[reset(false)]
    valid_q: DFF<Bit>,
    #[reset(true)]
    is_first: DFF<Bit>,
    #[reset(last_beat)]
    remaining: DFF<Bits<28>>,
    #[reset(false)]
    at_end: DFF<Bit>,
    #[reset(false)]
    ends: DFF<Bit>,
    whole: DFF<Bits<32>>,
    frames_q: DFF<Bits<8>>,
    latched: DFF<Bits<32>>,
    latched_frames: DFF<Bits<8>>,
}

impl FrameCheck {
    /// A check of frames with the given number of beats, two or more, of `width` bits each.
    #[must_use]
    pub fn new(width: usize, beats: usize) -> Self {
        const { assert!(MAX_FRAME_BEATS == 1 << 28, "the beats that remain are counted in 28 bits") };
        Self::from_parts(FrameCheckParts {
            last_beat: Constant::new((beats as u64 - 1).into()),
            width: whole(width),
            frame_crc: Crc::new(width),
        })
    }
}

impl Logic for FrameCheck {
    #[kernel]
    fn update(&mut self) {
        self.frame_crc.clock.next = self.clock.val();
        self.resets.clock.next = self.clock.val();
        self.resets.data.next = 0.into();
        if self.reset.val() {
            self.resets.data.next = 3.into();
        }
        self.valid_q.d.next = self.valid.val();
        self.frame_crc.valid.next = self.valid_q.q.val();
        self.frame_crc.first.next = self.is_first.q.val();
        self.frame_crc.data.next = self.data.val();

        // Which beat it is; the CRC is made a cycle after its last one.
        self.ends.d.next = self.valid_q.q.val() && self.at_end.q.val();
        if self.valid_q.q.val() {
            self.is_first.d.next = self.at_end.q.val();
            self.remaining.d.next = self.remaining.q.val() - 1;
            self.at_end.d.next = self.remaining.q.val() == 1;
            if self.at_end.q.val() {
                self.remaining.d.next = self.last_beat.val();
            }
        }
        if self.ends.q.val() {
            self.whole.d.next = self.frame_crc.crc.val();
            self.frames_q.d.next = self.frames_q.q.val() + 1;
        }
        if self.snapshot.val() {
            self.latched.d.next = self.whole.q.val();
            self.latched_frames.d.next = self.frames_q.q.val();
        }
        self.crc.next = self.latched.q.val();
        self.frames.next = self.latched_frames.q.val();

        if self.resets.delayed.val().get_bit(0) {
            self.whole.d.next = 0.into();
            self.frames_q.d.next = 0.into();
        }
        if self.resets.delayed.val().get_bit(1) {
            self.latched.d.next = 0.into();
            self.latched_frames.d.next = 0.into();
        }
    }
}
