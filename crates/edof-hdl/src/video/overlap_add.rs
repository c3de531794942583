//! The sum of overlapping patches (docs/contract.md, section 4).

use super::memory::Memory;
use super::queue::Queue;
use super::{Coordinate, Place};
use crate::blocks::Pair;
use crate::blocks::delay::Delay;
use crate::describe::{Circuit, kernel};
use edof_core::geometry::{Geometry, PATCH};
use edof_device::Design;
use rust_hdl::prelude::*;

/// The sum of overlapping patches, at stride 4 or 2: the 32 pairs of pixels of each patch in, patch by patch; out go those whose sum
/// is complete, the first `stride` rows and columns of each patch that does not start before the frame.
/// A pair a cycle in; what is complete stands on the output nine cycles after the last that was added to it. Sums of 20 bits lie in
/// block RAM, eight rows of them, and saturate once.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock, reset))]
pub struct OverlapAdd {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the picture.
    pub reset: Signal<In, Bit>,
    /// The input pair is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Luma words of the pair, the left pixel low.
    pub luma: Signal<In, Pair>,
    /// Chroma words of the pair, Cb low.
    pub chroma: Signal<In, Pair>,
    /// The output pair is valid.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub out_ready: Signal<In, Bit>,
    /// Luma words of the pair.
    pub out_luma: Signal<Out, Pair>,
    /// Chroma words of the pair.
    pub out_chroma: Signal<Out, Pair>,
    /// Sets the counter to zero.
    pub clear: Signal<In, Bit>,
    /// Sums within the frame that did not fit 16 bits.
    pub saturated_sums: Signal<Out, Bits<32>>,
    last_row: Constant<Coordinate>,
    last_column: Constant<Coordinate>,
    hidden: Constant<Coordinate>,
    stride: Constant<Bits<4>>,
    pairs: Constant<Bits<3>>,
    kept_rows: Constant<Bits<4>>,
    kept_pairs: Constant<Bits<3>>,
    frame_pairs: Constant<Coordinate>,
    frame_rows: Constant<Coordinate>,
    #[reset(0)]
    step: DFF<Bits<5>>,
    #[reset(0)]
    row: DFF<Coordinate>,
    #[reset(0)]
    column: DFF<Coordinate>,
    #[reset(0)]
    top: DFF<Coordinate>,
    #[reset(0)]
    remaining: DFF<Coordinate>,
    #[reset(false)]
    valid_1: DFF<Bit>,
    fresh_1: DFF<Bit>,
    done_1: DFF<Bit>,
    pair_1: DFF<Coordinate>,
    line_1: DFF<Coordinate>,
    words_1: DFF<Bits<64>>,
    valid_2: DFF<Bit>,
    place_2: DFF<Place>,
    visible_2: DFF<Bit>,
    fresh_to_4: Delay<1, 3>,
    done_to_4: Delay<1, 3>,
    visible_to_4: Delay<1, 2>,
    valid_to_4: Delay<1, 2>,
    place_to_4: Delay<16, 2>,
    words_to_3: Delay<64, 2>,
    // With a reset it is a register of its own, faster than the shift registers before it.
    #[reset(0)]
    words_4: DFF<Bits<64>>,
    luma_sums: Memory<40>,
    chroma_sums: Memory<40>,
    place_5: DFF<Place>,
    valid_5: DFF<Bit>,
    done_5: DFF<Bit>,
    visible_5: DFF<Bit>,
    sums_5: [DFF<Bits<20>>; 4],
    push_6: DFF<Bit>,
    words_6: [DFF<Bits<16>>; 4],
    over_6: [DFF<Bit>; 4],
    over_7: [DFF<Bits<2>>; 2],
    over_8: DFF<Bits<3>>,
    queue: Queue<64>,
    #[reset(0)]
    saturated_q: DFF<Bits<32>>,
    accept: Signal<Local, Bit>,
    patch_ends: Signal<Local, Bit>,
    fresh_row: Signal<Local, Bit>,
    fresh_column: Signal<Local, Bit>,
    complete: Signal<Local, Bit>,
    fresh: Signal<Local, Bits<1>>,
    done: Signal<Local, Bits<1>>,
    visible: Signal<Local, Bits<1>>,
    in_2: Signal<Local, Bits<1>>,
    word: [Signal<Local, Bits<20>>; 4],
    old: [Signal<Local, Bits<20>>; 4],
}

impl OverlapAdd {
    /// Returns the rows that each of the two memories needs: the pairs of eight lines of patches.
    pub(crate) fn rows(design: &Design) -> usize {
        let (frame, stride) = (design.frame, design.frame.stride.pixels());
        let (_, columns) = Geometry::new(design.form.window, frame.stride).patches(frame.height, frame.width);
        PATCH * (columns * stride / 2 + (PATCH - stride) / 2)
    }

    /// The overlap add of a design; none at stride 8, where patches do not overlap.
    #[must_use]
    pub fn of(design: &Design) -> Option<Self> {
        let (frame, stride) = (design.frame, design.frame.stride.pixels());
        if stride == PATCH {
            return None;
        }
        let (rows, columns) =
            Geometry::new(design.form.window, frame.stride).patches(frame.height, frame.width);
        let memory = || Memory::open(&design.board.part.memory, Self::rows(design));
        let number = |value: usize| Constant::new((value as u64).into());
        let small = |value: usize| Constant::new((value as u64).into());
        let pairs = |value: usize| Constant::new((value as u64).into());
        Some(Self::from_parts(OverlapAddParts {
            last_row: number(rows - 1),
            last_column: number(columns - 1),
            hidden: number(PATCH / stride - 1),
            stride: small(stride),
            pairs: pairs(stride / 2),
            kept_rows: small(PATCH - stride),
            kept_pairs: pairs((PATCH - stride) / 2),
            frame_pairs: number((PATCH - stride + frame.width) / 2),
            frame_rows: number(PATCH - stride + frame.height),
            luma_sums: memory(),
            chroma_sums: memory(),
            queue: Queue::new(12),
        }))
    }
}

impl Logic for OverlapAdd {
    #[kernel]
    fn update(&mut self) {
        self.fresh_to_4.clock.next = self.clock.val();
        self.done_to_4.clock.next = self.clock.val();
        self.visible_to_4.clock.next = self.clock.val();
        self.valid_to_4.clock.next = self.clock.val();
        self.place_to_4.clock.next = self.clock.val();
        self.words_to_3.clock.next = self.clock.val();
        self.luma_sums.clock.next = self.clock.val();
        self.chroma_sums.clock.next = self.clock.val();
        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();

        // Which pair of which patch comes. Lines and pairs are counted from where the first patch starts.
        self.ready.next = self.queue.space.val();
        self.accept.next = self.valid.val() && self.queue.space.val();
        self.patch_ends.next = self.accept.val() && (self.step.q.val() == 31);
        if self.accept.val() {
            self.step.d.next = self.step.q.val() + 1;
        }
        if self.patch_ends.val() {
            self.column.d.next = self.column.q.val() + 1;
            self.remaining.d.next = self.remaining.q.val() + bit_cast::<13, 3>(self.pairs.val());
            if self.column.q.val() == self.last_column.val() {
                self.column.d.next = 0.into();
                self.remaining.d.next = 0.into();
                self.row.d.next = self.row.q.val() + 1;
                self.top.d.next = self.top.q.val() + bit_cast::<13, 4>(self.stride.val());
                if self.row.q.val() == self.last_row.val() {
                    self.row.d.next = 0.into();
                    self.top.d.next = 0.into();
                }
            }
        }
        // Whether nothing was added at this place before, and whether nothing will be.
        self.fresh_row.next = !self.row.q.val().any()
            || (bit_cast::<4, 3>(self.step.q.val().get_bits::<3>(2)) >= self.kept_rows.val());
        self.fresh_column.next = !self.column.q.val().any()
            || (bit_cast::<3, 2>(self.step.q.val().get_bits::<2>(0)) >= self.kept_pairs.val());
        self.complete.next = (bit_cast::<4, 3>(self.step.q.val().get_bits::<3>(2)) < self.stride.val())
            && (bit_cast::<3, 2>(self.step.q.val().get_bits::<2>(0)) < self.pairs.val())
            && (self.row.q.val() >= self.hidden.val())
            && (self.column.q.val() >= self.hidden.val());
        self.valid_1.d.next = self.accept.val();
        self.fresh_1.d.next = self.fresh_row.val() && self.fresh_column.val();
        self.done_1.d.next = self.complete.val();
        self.pair_1.d.next = self.remaining.q.val() + bit_cast::<13, 2>(self.step.q.val().get_bits::<2>(0));
        self.line_1.d.next = self.top.q.val() + bit_cast::<13, 3>(self.step.q.val().get_bits::<3>(2));
        self.words_1.d.next =
            (bit_cast::<64, 32>(self.chroma.val()) << 32) | bit_cast::<64, 32>(self.luma.val());

        // Cycle 2: where its sum lies; whether it is seen.
        self.place_2.d.next = (bit_cast::<16, 13>(self.pair_1.q.val()) << 3)
            | bit_cast::<16, 3>(self.line_1.q.val().get_bits::<3>(0));
        self.valid_2.d.next = self.valid_1.q.val();
        self.visible_2.d.next =
            (self.pair_1.q.val() < self.frame_pairs.val()) && (self.line_1.q.val() < self.frame_rows.val());
        self.luma_sums.read_address.next = self.place_2.q.val();
        self.chroma_sums.read_address.next = self.place_2.q.val();
        self.fresh.next = self.fresh_1.q.val().into();
        self.done.next = self.done_1.q.val().into();
        self.visible.next = self.visible_2.q.val().into();
        self.in_2.next = self.valid_2.q.val().into();
        self.fresh_to_4.data.next = self.fresh.val();
        self.done_to_4.data.next = self.done.val();
        self.visible_to_4.data.next = self.visible.val();
        self.valid_to_4.data.next = self.in_2.val();
        self.place_to_4.data.next = self.place_2.q.val();
        self.words_to_3.data.next = self.words_1.q.val();
        self.words_4.d.next = self.words_to_3.delayed.val();

        // Cycle 4: added; cycle 5: written; cycle 6: saturated.
        self.old[0].next = self.luma_sums.read_data.val().get_bits::<20>(0);
        self.old[1].next = self.luma_sums.read_data.val().get_bits::<20>(20);
        self.old[2].next = self.chroma_sums.read_data.val().get_bits::<20>(0);
        self.old[3].next = self.chroma_sums.read_data.val().get_bits::<20>(20);
        self.word[0].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(0));
        if self.words_4.q.val().get_bit(15) {
            self.word[0].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(0)) | 0xf_0000;
        }
        self.word[1].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(16));
        if self.words_4.q.val().get_bit(31) {
            self.word[1].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(16)) | 0xf_0000;
        }
        self.word[2].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(32));
        if self.words_4.q.val().get_bit(47) {
            self.word[2].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(32)) | 0xf_0000;
        }
        self.word[3].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(48));
        if self.words_4.q.val().get_bit(63) {
            self.word[3].next = bit_cast::<20, 16>(self.words_4.q.val().get_bits::<16>(48)) | 0xf_0000;
        }
        for i in 0..4 {
            self.sums_5[i].clock.next = self.clock.val();
            self.sums_5[i].d.next = self.old[i].val() + self.word[i].val();
            if self.fresh_to_4.delayed.val().any() {
                self.sums_5[i].d.next = self.word[i].val();
            }
            self.words_6[i].clock.next = self.clock.val();
            self.over_6[i].clock.next = self.clock.val();
            self.words_6[i].d.next = self.sums_5[i].q.val().get_bits::<16>(0);
            self.over_6[i].d.next = false;
            if self.sums_5[i].q.val().get_bit(19) {
                if !self.sums_5[i].q.val().get_bits::<4>(15).all() {
                    self.words_6[i].d.next = 0x8000.into();
                    self.over_6[i].d.next = self.done_5.q.val() && self.visible_5.q.val();
                }
            } else if self.sums_5[i].q.val().get_bits::<4>(15).any() {
                self.words_6[i].d.next = 0x7fff.into();
                self.over_6[i].d.next = self.done_5.q.val() && self.visible_5.q.val();
            }
        }
        self.place_5.d.next = self.place_to_4.delayed.val();
        self.valid_5.d.next = self.valid_to_4.delayed.val().any();
        self.done_5.d.next = self.valid_to_4.delayed.val().any() && self.done_to_4.delayed.val().any();
        self.visible_5.d.next = self.visible_to_4.delayed.val().any();
        self.luma_sums.write_enable.next = self.valid_5.q.val();
        self.luma_sums.write_address.next = self.place_5.q.val();
        self.luma_sums.write_data.next =
            (bit_cast::<40, 20>(self.sums_5[1].q.val()) << 20) | bit_cast::<40, 20>(self.sums_5[0].q.val());
        self.chroma_sums.write_enable.next = self.valid_5.q.val();
        self.chroma_sums.write_address.next = self.place_5.q.val();
        self.chroma_sums.write_data.next =
            (bit_cast::<40, 20>(self.sums_5[3].q.val()) << 20) | bit_cast::<40, 20>(self.sums_5[2].q.val());
        self.push_6.d.next = self.done_5.q.val();

        // Out.
        self.queue.push.next = self.push_6.q.val();
        self.queue.data.next = (bit_cast::<64, 16>(self.words_6[3].q.val()) << 48)
            | (bit_cast::<64, 16>(self.words_6[2].q.val()) << 32)
            | (bit_cast::<64, 16>(self.words_6[1].q.val()) << 16)
            | bit_cast::<64, 16>(self.words_6[0].q.val());
        self.queue.front_ready.next = self.out_ready.val();
        self.out_valid.next = self.queue.front_valid.val();
        self.out_luma.next = self.queue.front_data.val().get_bits::<32>(0);
        self.out_chroma.next = self.queue.front_data.val().get_bits::<32>(32);
        for i in 0..2 {
            self.over_7[i].clock.next = self.clock.val();
            self.over_7[i].d.next = 0.into();
            if self.over_6[2 * i].q.val() && self.over_6[2 * i + 1].q.val() {
                self.over_7[i].d.next = 2.into();
            } else if self.over_6[2 * i].q.val() || self.over_6[2 * i + 1].q.val() {
                self.over_7[i].d.next = 1.into();
            }
        }
        self.over_8.d.next =
            bit_cast::<3, 2>(self.over_7[0].q.val()) + bit_cast::<3, 2>(self.over_7[1].q.val());
        self.saturated_q.d.next = self.saturated_q.q.val() + bit_cast::<32, 3>(self.over_8.q.val());
        self.saturated_sums.next = self.saturated_q.q.val();
        if self.clear.val() {
            self.saturated_q.d.next = 0.into();
        }
    }
}
