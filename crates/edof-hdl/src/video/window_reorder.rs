//! From raw lines to windows (docs/contract.md, section 2).

use super::memory::Memory;
use super::queue::Queue;
use super::{Coordinate, Place};
use crate::blocks::delay::Delay;
use crate::blocks::{Pair, Word};
use crate::describe::{Circuit, kernel};
use edof_core::geometry::Geometry;
use edof_device::Design;
use rust_hdl::prelude::*;

/// From the lines of red-first raw frames to windows, row by row, mirrored at the frame's borders, two pixels a beat.
/// Each pixel comes once, one a cycle. Lines lie in block RAM, 16 or 32 of them, and are freed as no window needs them any more, so that the next
/// frame's may follow at once. A window begins once the last line that it needs has come; then one beat per cycle, eleven cycles from
/// address to output. Between rows of windows it pauses for 12 cycles. `set` is looked at with each frame's first window.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock, reset))]
pub struct WindowReorder {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets all lines.
    pub reset: Signal<In, Bit>,
    /// The input pixel is valid.
    pub pixels_valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub pixels_ready: Signal<Out, Bit>,
    /// The raw pixel word.
    pub pixels_data: Signal<In, Word>,
    /// The set of weights for the next frame.
    pub set: Signal<In, Bit>,
    /// Two output pixels of a window are valid.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub out_ready: Signal<In, Bit>,
    /// Two pixels of a window, as the network's input words.
    pub out_pixels: Signal<Out, Pair>,
    /// The beat is the last of its window.
    pub out_last: Signal<Out, Bit>,
    /// The set of weights for this window.
    pub out_set: Signal<Out, Bit>,
    slot_bits: Constant<Bits<3>>,
    slot_mask: Constant<Place>,
    max_lines: Constant<Bits<6>>,
    last_in: Constant<Coordinate>,
    height: Constant<Coordinate>,
    first_top: Constant<Coordinate>,
    first_end_line: Constant<Coordinate>,
    kept_end: Constant<Coordinate>,
    window: Constant<Coordinate>,
    stride: Constant<Coordinate>,
    last_patch_row: Constant<Coordinate>,
    last_patch_column: Constant<Coordinate>,
    first_left: Constant<Coordinate>,
    pair_step: Constant<Coordinate>,
    last_window_pair: Constant<Bits<3>>,
    last_window_row: Constant<Bits<4>>,
    last_line: Constant<Coordinate>,
    twice_last_line: Constant<Coordinate>,
    last_pair: Constant<Coordinate>,
    even_mirror: Constant<Coordinate>,
    odd_mirror: Constant<Coordinate>,
    #[reset(false)]
    writing: DFF<Bit>,
    #[reset(0)]
    in_column: DFF<Coordinate>,
    #[reset(0)]
    in_slot: DFF<Bits<5>>,
    #[reset(false)]
    write_even_1: DFF<Bit>,
    #[reset(false)]
    write_odd_1: DFF<Bit>,
    write_place_1: DFF<Place>,
    pixel_1: DFF<Bits<15>>,
    #[reset(false)]
    line_done: DFF<Bit>,
    #[reset(0)]
    held: DFF<Bits<6>>,
    #[reset(0)]
    age: DFF<Bits<4>>,
    #[reset(true)]
    fresh: DFF<Bit>,
    #[reset(false)]
    frame_pending: DFF<Bit>,
    #[reset(0)]
    frame_slot: DFF<Bits<5>>,
    set_q: DFF<Bit>,
    #[reset(0)]
    patch_row: DFF<Coordinate>,
    in_last_row: DFF<Bit>,
    in_last_column: DFF<Bit>,
    #[reset(first_top)]
    top: DFF<Coordinate>,
    next_top: DFF<Coordinate>,
    base: DFF<Coordinate>,
    next_base: DFF<Coordinate>,
    end_base: DFF<Coordinate>,
    bottom: DFF<Coordinate>,
    end_line: DFF<Coordinate>,
    needed_lines: DFF<Coordinate>,
    freed: DFF<Coordinate>,
    #[reset(0)]
    release: DFF<Bits<6>>,
    has_lines: DFF<Bit>,
    #[reset(0)]
    pair: DFF<Bits<3>>,
    #[reset(0)]
    row: DFF<Bits<4>>,
    #[reset(0)]
    patch_column: DFF<Coordinate>,
    #[reset(first_left)]
    remaining: DFF<Coordinate>,
    #[reset(0)]
    marks_1: DFF<Bits<3>>,
    line_1: DFF<Coordinate>,
    column_1: DFF<Coordinate>,
    line_2: DFF<Coordinate>,
    line_back_2: DFF<Coordinate>,
    line_out_2: DFF<Bit>,
    column_2: DFF<Coordinate>,
    even_back_2: DFF<Coordinate>,
    odd_back_2: DFF<Coordinate>,
    column_out_2: DFF<Bit>,
    slot_3: DFF<Bits<5>>,
    even_3: DFF<Coordinate>,
    odd_3: DFF<Coordinate>,
    even_place_4: DFF<Place>,
    odd_place_4: DFF<Place>,
    marks_to_6: Delay<3, 5>,
    even_pixels: Memory<15>,
    odd_pixels: Memory<15>,
    queue: Queue<34>,
    accept: Signal<Local, Bit>,
    line_ends: Signal<Local, Bit>,
    steps: Signal<Local, Bit>,
    row_ends: Signal<Local, Bit>,
    window_ends: Signal<Local, Bit>,
    stripe_ends: Signal<Local, Bit>,
    frame_ends: Signal<Local, Bit>,
    commit: Signal<Local, Bit>,
    lines_in: Signal<Local, Bits<6>>,
    lines_out: Signal<Local, Bits<6>>,
    marks: Signal<Local, Bits<3>>,
    line_from: Signal<Local, Coordinate>,
    even_from: Signal<Local, Coordinate>,
    odd_from: Signal<Local, Coordinate>,
    line_3: Signal<Local, Coordinate>,
}

impl WindowReorder {
    /// Returns the bits of a line's number among those that are kept: the lines of one row of windows, and those that the next one adds.
    fn slot_bits(design: &Design) -> u64 {
        if design.form.window.side() + design.frame.stride.pixels() <= 16 { 4 } else { 5 }
    }

    /// Returns the rows that each of the two memories needs: pairs of pixels of the lines that are kept.
    pub(crate) fn rows(design: &Design) -> usize {
        (design.frame.width / 2) << Self::slot_bits(design)
    }

    /// For the window, the frame and the stride of a design.
    #[must_use]
    pub fn of(design: &Design) -> Self {
        let (frame, window) = (design.frame, design.form.window);
        let geometry = Geometry::new(window, frame.stride);
        let (rows, columns) = geometry.patches(frame.height, frame.width);
        let (side, stride, height) = (window.side(), frame.stride.pixels(), frame.height);
        let signed = |value: isize| Constant::new((value as u64 & 0x1fff).into());
        let number = |value: usize| Constant::new((value as u64).into());
        let slot_bits = Self::slot_bits(design);
        let lines = 1u64 << slot_bits;
        let start = geometry.window_start(0);
        let memory = || Memory::open(&design.board.part.memory, Self::rows(design));
        Self::from_parts(WindowReorderParts {
            slot_bits: Constant::new(slot_bits.into()),
            slot_mask: Constant::new((lines - 1).into()),
            max_lines: Constant::new(lines.into()),
            last_in: number(frame.width - 1),
            height: number(height),
            first_top: signed(start),
            first_end_line: signed((side as isize + start).max(1 - start)),
            // The lowest windows reach so far back by their mirrored rows that of the last lines none is freed before the end.
            kept_end: number(height + 1 + window.margin() - side),
            window: number(side),
            stride: number(stride),
            last_patch_row: number(rows - 1),
            last_patch_column: number(columns - 1),
            first_left: signed(start / 2),
            pair_step: number(stride / 2),
            last_window_pair: Constant::new((side as u64 / 2 - 1).into()),
            last_window_row: Constant::new((side as u64 - 1).into()),
            last_line: number(height - 1),
            twice_last_line: number(2 * (height - 1)),
            last_pair: number(frame.width / 2 - 1),
            even_mirror: number(frame.width - 1),
            odd_mirror: number(frame.width - 2),
            even_pixels: memory(),
            odd_pixels: memory(),
            queue: Queue::new(12),
        })
    }
}

impl Logic for WindowReorder {
    #[kernel]
    fn update(&mut self) {
        self.marks_to_6.clock.next = self.clock.val();
        self.even_pixels.clock.next = self.clock.val();
        self.odd_pixels.clock.next = self.clock.val();
        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();

        // In: a line begins once there is room for all of it.
        self.pixels_ready.next = self.writing.q.val();
        self.accept.next = self.pixels_valid.val() && self.writing.q.val();
        self.line_ends.next = self.accept.val() && (self.in_column.q.val() == self.last_in.val());
        if !self.writing.q.val() && !self.line_done.q.val() && (self.held.q.val() < self.max_lines.val()) {
            self.writing.d.next = true;
        }
        if self.accept.val() {
            self.in_column.d.next = self.in_column.q.val() + 1;
        }
        if self.line_ends.val() {
            self.writing.d.next = false;
            self.in_column.d.next = 0.into();
            self.in_slot.d.next = self.in_slot.q.val() + 1;
        }
        self.line_done.d.next = self.line_ends.val();
        self.write_even_1.d.next = self.accept.val() && !self.in_column.q.val().get_bit(0);
        self.write_odd_1.d.next = self.accept.val() && self.in_column.q.val().get_bit(0);
        self.write_place_1.d.next = (bit_cast::<16, 12>(self.in_column.q.val().get_bits::<12>(1))
            << self.slot_bits.val())
            | (bit_cast::<16, 5>(self.in_slot.q.val()) & self.slot_mask.val());
        self.pixel_1.d.next = self.pixels_data.val().get_bits::<15>(1);
        self.even_pixels.write_enable.next = self.write_even_1.q.val();
        self.even_pixels.write_address.next = self.write_place_1.q.val();
        self.even_pixels.write_data.next = self.pixel_1.q.val();
        self.odd_pixels.write_enable.next = self.write_odd_1.q.val();
        self.odd_pixels.write_address.next = self.write_place_1.q.val();
        self.odd_pixels.write_data.next = self.pixel_1.q.val();

        // Which lines a row of windows needs, worked out in the pause before it: all from `base`, which no later one reaches behind,
        // to `need`. Those before the next row's base are freed once the last reads of this one are over.
        self.bottom.d.next = self.top.q.val() + self.window.val();
        self.next_top.d.next = self.top.q.val() + self.stride.val();
        self.base.d.next = self.top.q.val();
        if self.top.q.val().get_bit(12) {
            self.base.d.next = 0.into();
        } else if self.top.q.val() > self.kept_end.val() {
            self.base.d.next = self.kept_end.val();
        }
        self.end_line.d.next = self.bottom.q.val();
        if self.bottom.q.val() < self.first_end_line.val() {
            self.end_line.d.next = self.first_end_line.val();
        } else if self.bottom.q.val() > self.height.val() {
            self.end_line.d.next = self.height.val();
        }
        self.next_base.d.next = self.next_top.q.val();
        if self.next_top.q.val().get_bit(12) {
            self.next_base.d.next = 0.into();
        } else if self.next_top.q.val() > self.kept_end.val() {
            self.next_base.d.next = self.kept_end.val();
        }
        self.end_base.d.next = self.next_base.q.val();
        if self.in_last_row.q.val() {
            self.end_base.d.next = self.height.val();
        }
        self.needed_lines.d.next = self.end_line.q.val() - self.base.q.val();
        self.freed.d.next = self.end_base.q.val() - self.base.q.val();
        self.has_lines.d.next = self.held.q.val() >= self.needed_lines.q.val().get_bits::<6>(0);
        self.commit.next = self.age.q.val() == 8;
        self.lines_in.next = 0.into();
        if self.line_done.q.val() {
            self.lines_in.next = 1.into();
        }
        self.lines_out.next = 0.into();
        if self.commit.val() {
            self.lines_out.next = self.release.q.val();
        }
        self.held.d.next = (self.held.q.val() + self.lines_in.val()) - self.lines_out.val();
        if self.commit.val() && self.frame_pending.q.val() {
            self.frame_pending.d.next = false;
            self.frame_slot.d.next = self.frame_slot.q.val() + self.height.val().get_bits::<5>(0);
        }
        if self.age.q.val() != 12 {
            self.age.d.next = self.age.q.val() + 1;
        }

        // Which pair of which window is next.
        self.steps.next = (self.age.q.val() == 12) && self.has_lines.q.val() && self.queue.space.val();
        self.row_ends.next = self.steps.val() && (self.pair.q.val() == self.last_window_pair.val());
        self.window_ends.next = self.row_ends.val() && (self.row.q.val() == self.last_window_row.val());
        // Both change many cycles before they are asked for.
        self.in_last_row.d.next = self.patch_row.q.val() == self.last_patch_row.val();
        self.in_last_column.d.next = self.patch_column.q.val() == self.last_patch_column.val();
        self.stripe_ends.next = self.window_ends.val() && self.in_last_column.q.val();
        self.frame_ends.next = self.stripe_ends.val() && self.in_last_row.q.val();
        // From the frame's first pair on the set stands.
        if self.fresh.q.val() && !self.steps.val() {
            self.set_q.d.next = self.set.val();
        }
        if self.steps.val() {
            self.fresh.d.next = false;
            self.pair.d.next = self.pair.q.val() + 1;
        }
        if self.row_ends.val() {
            self.pair.d.next = 0.into();
            self.row.d.next = self.row.q.val() + 1;
        }
        if self.window_ends.val() {
            self.row.d.next = 0.into();
            self.patch_column.d.next = self.patch_column.q.val() + 1;
            self.remaining.d.next = self.remaining.q.val() + self.pair_step.val();
        }
        if self.stripe_ends.val() {
            self.patch_column.d.next = 0.into();
            self.remaining.d.next = self.first_left.val();
            self.patch_row.d.next = self.patch_row.q.val() + 1;
            self.top.d.next = self.top.q.val() + self.stride.val();
            self.release.d.next = self.freed.q.val().get_bits::<6>(0);
            self.age.d.next = 0.into();
        }
        if self.frame_ends.val() {
            self.patch_row.d.next = 0.into();
            self.top.d.next = self.first_top.val();
            self.frame_pending.d.next = true;
            self.fresh.d.next = true;
        }

        // Cycle 1: line and pair; they may lie outside. Bit 0: a pair is read, 1: its window's last, 2: set.
        self.marks.next = 0.into();
        if self.steps.val() {
            self.marks.next = 1.into();
            if self.window_ends.val() {
                self.marks.next = 3.into();
            }
        }
        self.marks_1.d.next = self.marks.val();
        if self.set_q.q.val() {
            self.marks_1.d.next = self.marks.val() | 4;
        }
        self.line_1.d.next = self.top.q.val() + bit_cast::<13, 4>(self.row.q.val());
        self.column_1.d.next = self.remaining.q.val() + bit_cast::<13, 3>(self.pair.q.val());

        // Cycle 2: what stands for them outside: mirrored about the edge pixel, even pixels stay even.
        self.line_from.next = self.twice_last_line.val();
        if self.line_1.q.val().get_bit(12) {
            self.line_from.next = 0.into();
        }
        self.even_from.next = self.even_mirror.val();
        self.odd_from.next = self.odd_mirror.val();
        if self.column_1.q.val().get_bit(12) {
            self.even_from.next = 0.into();
            self.odd_from.next = 0x1fff.into();
        }
        self.line_2.d.next = self.line_1.q.val();
        self.line_back_2.d.next = self.line_from.val() - self.line_1.q.val();
        self.line_out_2.d.next = self.line_1.q.val() > self.last_line.val();
        self.column_2.d.next = self.column_1.q.val();
        self.even_back_2.d.next = self.even_from.val() - self.column_1.q.val();
        self.odd_back_2.d.next = self.odd_from.val() - self.column_1.q.val();
        self.column_out_2.d.next = self.column_1.q.val() > self.last_pair.val();

        // Cycle 3: one of both; cycle 4: addresses; cycle 6: pixels.
        self.line_3.next = self.line_2.q.val();
        if self.line_out_2.q.val() {
            self.line_3.next = self.line_back_2.q.val();
        }
        self.slot_3.d.next = self.line_3.val().get_bits::<5>(0) + self.frame_slot.q.val();
        self.even_3.d.next = self.column_2.q.val();
        self.odd_3.d.next = self.column_2.q.val();
        if self.column_out_2.q.val() {
            self.even_3.d.next = self.even_back_2.q.val();
            self.odd_3.d.next = self.odd_back_2.q.val();
        }
        self.even_place_4.d.next = (bit_cast::<16, 13>(self.even_3.q.val()) << self.slot_bits.val())
            | (bit_cast::<16, 5>(self.slot_3.q.val()) & self.slot_mask.val());
        self.odd_place_4.d.next = (bit_cast::<16, 13>(self.odd_3.q.val()) << self.slot_bits.val())
            | (bit_cast::<16, 5>(self.slot_3.q.val()) & self.slot_mask.val());
        self.even_pixels.read_address.next = self.even_place_4.q.val();
        self.odd_pixels.read_address.next = self.odd_place_4.q.val();
        self.marks_to_6.data.next = self.marks_1.q.val();

        // Out.
        self.queue.push.next = self.marks_to_6.delayed.val().get_bit(0);
        self.queue.data.next = (bit_cast::<34, 2>(self.marks_to_6.delayed.val().get_bits::<2>(1)) << 32)
            | (bit_cast::<34, 15>(self.odd_pixels.read_data.val()) << 16)
            | bit_cast::<34, 15>(self.even_pixels.read_data.val());
        self.queue.front_ready.next = self.out_ready.val();
        self.out_valid.next = self.queue.front_valid.val();
        self.out_pixels.next = self.queue.front_data.val().get_bits::<32>(0);
        self.out_last.next = self.queue.front_data.val().get_bit(32);
        self.out_set.next = self.queue.front_data.val().get_bit(33);
    }
}
