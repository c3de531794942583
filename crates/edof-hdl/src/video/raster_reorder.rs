//! From patches to lines.

use super::memory::Memory;
use super::queue::Queue;
use super::{Coordinate, Place};
use crate::blocks::Pair;
use crate::blocks::delay::Delay;
use crate::describe::{Circuit, kernel};
use edof_device::Design;
use rust_hdl::prelude::*;

/// From square blocks of pairs of pixels, `stride` rows and columns each, to lines: blocks lie in rows from the frame's corner on, and
/// what reaches beyond its right and lower border is left out. Two rows of blocks lie in block RAM: one fills while the other is read.
/// A pair a cycle; a row's first pair stands on the output seven cycles after its last block's last pair.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock, reset))]
pub struct RasterReorder {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the picture.
    pub reset: Signal<In, Bit>,
    /// The input pair of a block is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Luma words of the pair, the left pixel low.
    pub luma: Signal<In, Pair>,
    /// Chroma words of the pair, Cb low.
    pub chroma: Signal<In, Pair>,
    /// A pair of a line stands on the output.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub out_ready: Signal<In, Bit>,
    /// Luma words of the pair.
    pub out_luma: Signal<Out, Pair>,
    /// Chroma words of the pair.
    pub out_chroma: Signal<Out, Pair>,
    /// The pair is the first of its frame.
    pub out_first: Signal<Out, Bit>,
    /// The pair is the last of its line.
    pub out_last: Signal<Out, Bit>,
    last_pair_of_block: Constant<Bits<2>>,
    last_row_of_block: Constant<Bits<3>>,
    block_pairs: Constant<Coordinate>,
    last_block: Constant<Coordinate>,
    frame_pairs: Constant<Coordinate>,
    pair_before_last: Constant<Coordinate>,
    last_row: Constant<Coordinate>,
    luma_words: Memory<32>,
    chroma_words: Memory<32>,
    #[reset(0)]
    in_pair: DFF<Bits<2>>,
    #[reset(0)]
    in_row: DFF<Bits<3>>,
    #[reset(0)]
    block_column: DFF<Coordinate>,
    #[reset(false)]
    write_slot: DFF<Bit>,
    #[reset(false)]
    write_1: DFF<Bit>,
    pair_1: DFF<Coordinate>,
    row_1: DFF<Bits<4>>,
    words_1: DFF<Bits<64>>,
    inside_2: DFF<Bit>,
    place_2: DFF<Place>,
    words_2: DFF<Bits<64>>,
    #[reset(0)]
    full: DFF<Bits<2>>,
    #[reset(0)]
    pair: DFF<Coordinate>,
    // The pair is its line's last: known a pair before, as all that ends with a line follows from it.
    #[reset(false)]
    pair_is_last: DFF<Bit>,
    // And its frame's first.
    #[reset(true)]
    is_first: DFF<Bit>,
    #[reset(0)]
    row: DFF<Coordinate>,
    #[reset(0)]
    row_in_slot: DFF<Bits<3>>,
    // Of the row, which stands for a whole line: known before the line ends.
    row_is_last: DFF<Bit>,
    slot_ends: DFF<Bit>,
    #[reset(false)]
    read_slot: DFF<Bit>,
    read_place_1: DFF<Place>,
    #[reset(0)]
    marks_1: DFF<Bits<3>>,
    marks_to_3: Delay<3, 2>,
    queue: Queue<66>,
    accept: Signal<Local, Bit>,
    row_ends: Signal<Local, Bit>,
    block_ends: Signal<Local, Bit>,
    arrives: Signal<Local, Bit>,
    steps: Signal<Local, Bit>,
    line_ends: Signal<Local, Bit>,
    frame_ends: Signal<Local, Bit>,
    finished: Signal<Local, Bit>,
    write_bit: Signal<Local, Bits<1>>,
    read_bit: Signal<Local, Bits<1>>,
    marks: Signal<Local, Bits<3>>,
}

impl RasterReorder {
    /// Returns the rows that each of the two memories needs: for each column of pairs 16, two slots of up to 8.
    pub(crate) const fn rows(design: &Design) -> usize {
        16 * design.frame.width / 2
    }

    /// For the frame and the stride of a design.
    #[must_use]
    pub fn of(design: &Design) -> Self {
        let (frame, stride) = (design.frame, design.frame.stride.pixels());
        let number = |value: usize| Constant::new((value as u64).into());
        let memory = || Memory::open(&design.board.part.memory, Self::rows(design));
        Self::from_parts(RasterReorderParts {
            last_pair_of_block: Constant::new((stride as u64 / 2 - 1).into()),
            last_row_of_block: Constant::new((stride as u64 - 1).into()),
            block_pairs: number(stride / 2),
            last_block: number((frame.width.div_ceil(stride) - 1) * stride / 2),
            frame_pairs: number(frame.width / 2),
            pair_before_last: number(frame.width / 2 - 2),
            last_row: number(frame.height - 1),
            luma_words: memory(),
            chroma_words: memory(),
            queue: Queue::new(8),
        })
    }
}

impl Logic for RasterReorder {
    #[kernel]
    fn update(&mut self) {
        self.luma_words.clock.next = self.clock.val();
        self.chroma_words.clock.next = self.clock.val();
        self.marks_to_3.clock.next = self.clock.val();
        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();

        // In: a slot takes a row of blocks.
        self.ready.next = !self.full.q.val().get_bit(1);
        self.accept.next = self.valid.val() && !self.full.q.val().get_bit(1);
        self.row_ends.next = self.accept.val() && (self.in_pair.q.val() == self.last_pair_of_block.val());
        self.block_ends.next = self.row_ends.val() && (self.in_row.q.val() == self.last_row_of_block.val());
        self.arrives.next = self.block_ends.val() && (self.block_column.q.val() == self.last_block.val());
        if self.accept.val() {
            self.in_pair.d.next = self.in_pair.q.val() + 1;
        }
        if self.row_ends.val() {
            self.in_pair.d.next = 0.into();
            self.in_row.d.next = self.in_row.q.val() + 1;
        }
        if self.block_ends.val() {
            self.in_row.d.next = 0.into();
            self.block_column.d.next = self.block_column.q.val() + self.block_pairs.val();
        }
        if self.arrives.val() {
            self.block_column.d.next = 0.into();
            self.write_slot.d.next = !self.write_slot.q.val();
        }
        self.write_bit.next = self.write_slot.q.val().into();
        self.write_1.d.next = self.accept.val();
        self.pair_1.d.next = self.block_column.q.val() + bit_cast::<13, 2>(self.in_pair.q.val());
        self.row_1.d.next =
            (bit_cast::<4, 1>(self.write_bit.val()) << 3) | bit_cast::<4, 3>(self.in_row.q.val());
        self.words_1.d.next =
            (bit_cast::<64, 32>(self.chroma.val()) << 32) | bit_cast::<64, 32>(self.luma.val());
        self.inside_2.d.next = self.write_1.q.val() && (self.pair_1.q.val() < self.frame_pairs.val());
        self.place_2.d.next =
            (bit_cast::<16, 13>(self.pair_1.q.val()) << 4) | bit_cast::<16, 4>(self.row_1.q.val());
        self.words_2.d.next = self.words_1.q.val();
        self.luma_words.write_enable.next = self.inside_2.q.val();
        self.luma_words.write_address.next = self.place_2.q.val();
        self.luma_words.write_data.next = self.words_2.q.val().get_bits::<32>(0);
        self.chroma_words.write_enable.next = self.inside_2.q.val();
        self.chroma_words.write_address.next = self.place_2.q.val();
        self.chroma_words.write_data.next = self.words_2.q.val().get_bits::<32>(32);

        // Out: line by line, up to the frame's last.
        self.steps.next = self.full.q.val().any() && self.queue.space.val();
        self.line_ends.next = self.steps.val() && self.pair_is_last.q.val();
        self.row_is_last.d.next = self.row.q.val() == self.last_row.val();
        self.slot_ends.d.next = self.row_in_slot.q.val() == self.last_row_of_block.val();
        self.frame_ends.next = self.line_ends.val() && self.row_is_last.q.val();
        self.finished.next = self.frame_ends.val() || (self.line_ends.val() && self.slot_ends.q.val());
        if self.steps.val() {
            self.pair.d.next = self.pair.q.val() + 1;
            self.pair_is_last.d.next = self.pair.q.val() == self.pair_before_last.val();
            self.is_first.d.next = self.frame_ends.val();
        }
        if self.line_ends.val() {
            self.pair.d.next = 0.into();
            self.pair_is_last.d.next = false;
            self.row.d.next = self.row.q.val() + 1;
            self.row_in_slot.d.next = self.row_in_slot.q.val() + 1;
        }
        if self.finished.val() {
            self.row_in_slot.d.next = 0.into();
            self.read_slot.d.next = !self.read_slot.q.val();
        }
        if self.frame_ends.val() {
            self.row.d.next = 0.into();
        }
        self.read_bit.next = self.read_slot.q.val().into();
        self.read_place_1.d.next = (bit_cast::<16, 13>(self.pair.q.val()) << 4)
            | (bit_cast::<16, 1>(self.read_bit.val()) << 3)
            | bit_cast::<16, 3>(self.row_in_slot.q.val());
        self.luma_words.read_address.next = self.read_place_1.q.val();
        self.chroma_words.read_address.next = self.read_place_1.q.val();
        // Bit 0: a pair is read, 1: its frame's first, 2: its line's last.
        self.marks.next = 0.into();
        if self.steps.val() {
            self.marks.next = 1.into();
            if self.line_ends.val() {
                self.marks.next = 5.into();
            }
            if self.is_first.q.val() {
                self.marks.next = 3.into();
            }
        }
        self.marks_1.d.next = self.marks.val();
        self.marks_to_3.data.next = self.marks_1.q.val();
        self.queue.push.next = self.marks_to_3.delayed.val().get_bit(0);
        self.queue.data.next = (bit_cast::<66, 2>(self.marks_to_3.delayed.val().get_bits::<2>(1)) << 64)
            | (bit_cast::<66, 32>(self.chroma_words.read_data.val()) << 32)
            | bit_cast::<66, 32>(self.luma_words.read_data.val());
        self.queue.front_ready.next = self.out_ready.val();
        self.out_valid.next = self.queue.front_valid.val();
        self.out_luma.next = self.queue.front_data.val().get_bits::<32>(0);
        self.out_chroma.next = self.queue.front_data.val().get_bits::<32>(32);
        self.out_first.next = self.queue.front_data.val().get_bit(64);
        self.out_last.next = self.queue.front_data.val().get_bit(65);

        // Whole slots. The last pair of a row of blocks is written two cycles after it is counted, and read many later.
        if self.arrives.val() && !self.finished.val() {
            self.full.d.next = self.full.q.val() + 1;
        } else if self.finished.val() && !self.arrives.val() {
            self.full.d.next = self.full.q.val() - 1;
        }
    }
}
