//! Windows that wait for F's linear path.

use super::ram::{Ram, Shape};
use super::{Pair, Whole, whole};
use crate::describe::{Circuit, kernel};
use edof_device::design::{BEAT, StagePlan};
use rust_hdl::prelude::*;

/// Windows that wait for F's linear path: a ring of whole windows in block RAM, each from a power of two of rows on.
/// Ready while there is room for one more. Two pixels are read two cycles after read_pair, from the oldest window.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct WindowRing {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Empties the memory.
    pub reset: Signal<In, Bit>,
    /// The input beat is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Two pixels of the beat, the left one low.
    pub pixels: Signal<In, Pair>,
    /// The beat is the last of its window.
    pub last: Signal<In, Bit>,
    /// Which two pixels of the oldest window to read.
    pub read_pair: Signal<In, Bits<7>>,
    /// Two pixels, two cycles after their address.
    pub read_pixels: Signal<Out, Pair>,
    /// Frees the oldest window.
    pub finished: Signal<In, Bit>,
    #[is(DEPTH = windows * if large { 128 } else { 32 })]
    ram: Ram<32>,
    /// Pixels of a window.
    window_pixels: Constant<Whole>,
    /// Windows that are kept.
    windows: Constant<Whole>,
    /// Its pixels are more than those of a window of side 8: one of side 12 has 144, and takes four times as many rows.
    #[is(window_pixels > 64)]
    large: Constant<Bit>,
    #[is(if windows > 0 { windows - 1 } else { 0 })]
    last_window: Constant<Bits<6>>,
    #[is(windows)]
    max_windows: Constant<Bits<7>>,
    #[is(if windows > 0 { 2 * windows - 1 } else { 0 })]
    count_bits: Constant<Bits<7>>,
    #[reset(false)]
    write_q: DFF<Bit>,
    pixels_q: DFF<Pair>,
    last_q: DFF<Bit>,
    #[reset(0)]
    write_beat: DFF<Bits<7>>,
    #[reset(0)]
    write_window: DFF<Bits<6>>,
    /// Windows that came, one more, and those that were freed: their difference is never taken, as the way behind it would be too long.
    #[reset(0)]
    came: DFF<Bits<7>>,
    #[reset(1)]
    with_next: DFF<Bits<7>>,
    #[reset(0)]
    freed: DFF<Bits<7>>,
    #[reset(false)]
    ready_q: DFF<Bit>,
    accept: Signal<Local, Bit>,
    arrived: Signal<Local, Bit>,
    oldest: Signal<Local, Bits<6>>,
    is_full: Signal<Local, Bit>,
    would_be_full: Signal<Local, Bit>,
}

impl WindowRing {
    /// The ring of a stage; it has no memory where there is no linear path.
    #[must_use]
    pub fn new(stage: &StagePlan) -> Self {
        let rows = (stage.linear / BEAT).next_power_of_two();
        let windows = stage.kept_windows;
        Self::from_parts(WindowRingParts {
            ram: Ram::new(Shape::registered(rows * windows), &[]),
            window_pixels: whole(stage.linear),
            windows: whole(windows),
        })
    }
}

impl Logic for WindowRing {
    #[kernel]
    fn update(&mut self) {
        self.ram.clock.next = self.clock.val();

        self.ready.next = self.ready_q.q.val();
        self.accept.next = self.valid.val() && self.ready_q.q.val();
        self.arrived.next = self.accept.val() && self.last.val();
        self.is_full.next =
            ((self.came.q.val() ^ self.freed.q.val()) & self.count_bits.val()) == self.max_windows.val();
        self.would_be_full.next =
            ((self.with_next.q.val() ^ self.freed.q.val()) & self.count_bits.val()) == self.max_windows.val();
        self.ready_q.d.next = !self.is_full.val();
        if self.arrived.val() && !self.finished.val() {
            self.ready_q.d.next = !self.would_be_full.val();
        }
        if self.finished.val() && !self.arrived.val() {
            self.ready_q.d.next = true;
        }
        if self.arrived.val() {
            self.came.d.next = self.with_next.q.val();
            self.with_next.d.next = self.with_next.q.val() + 1;
        }
        if self.finished.val() {
            self.freed.d.next = self.freed.q.val() + 1;
        }

        self.write_q.d.next = self.accept.val();
        self.pixels_q.d.next = self.pixels.val();
        self.last_q.d.next = self.last.val();
        self.ram.write_enable.next = self.write_q.q.val();
        self.ram.write_data.next = self.pixels_q.q.val();
        self.oldest.next = bit_cast::<6, 7>(self.freed.q.val()) & self.last_window.val();
        self.ram.write_address.next =
            (bit_cast::<12, 6>(self.write_window.q.val()) << 5) | bit_cast::<12, 7>(self.write_beat.q.val());
        self.ram.read_address.next =
            (bit_cast::<12, 6>(self.oldest.val()) << 5) | bit_cast::<12, 7>(self.read_pair.val());
        if self.large.val() {
            self.ram.write_address.next = (bit_cast::<12, 6>(self.write_window.q.val()) << 7)
                | bit_cast::<12, 7>(self.write_beat.q.val());
            self.ram.read_address.next =
                (bit_cast::<12, 6>(self.oldest.val()) << 7) | bit_cast::<12, 7>(self.read_pair.val());
        }
        self.read_pixels.next = self.ram.read_data.val();

        if self.write_q.q.val() {
            self.write_beat.d.next = self.write_beat.q.val() + 1;
            if self.last_q.q.val() {
                self.write_beat.d.next = 0.into();
                self.write_window.d.next = (self.write_window.q.val() + 1) & self.last_window.val();
            }
        }
    }
}
