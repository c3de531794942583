//! From patches as F gives them to pairs of pixels.

use super::queue::Queue;
use crate::blocks::Pair;
use crate::blocks::ram::{Ram, Shape};
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// From patches of 64 beats (luma row by row, then Cb, then Cr, two words a beat) to the 32 pairs of pixels of each, row by row.
/// Two patches are held: one fills while the other is read, a pair a cycle, the first on the output six cycles after its patch's
/// last beat. The set of a patch is not kept: what it was made with is in its words.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct PatchPairs {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets both patches.
    pub reset: Signal<In, Bit>,
    /// Two input words of a patch are valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Two words of a patch, the even one low.
    pub data: Signal<In, Pair>,
    /// A pair of pixels stands on the output.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub out_ready: Signal<In, Bit>,
    /// Luma words of the pair, the left pixel low.
    pub out_luma: Signal<Out, Pair>,
    /// Chroma words of the pair, Cb low.
    pub out_chroma: Signal<Out, Pair>,
    luma_words: Ram<32>,
    cb_words: Ram<32>,
    cr_words: Ram<32>,
    #[reset(0)]
    beat: DFF<Bits<6>>,
    #[reset(false)]
    write_slot: DFF<Bit>,
    #[reset(0)]
    step: DFF<Bits<5>>,
    #[reset(false)]
    read_slot: DFF<Bit>,
    #[reset(0)]
    full: DFF<Bits<2>>,
    #[reset(false)]
    step_1: DFF<Bit>,
    half_1: DFF<Bit>,
    #[reset(false)]
    step_2: DFF<Bit>,
    luma_2: DFF<Pair>,
    chroma_2: DFF<Pair>,
    queue: Queue<64>,
    accept: Signal<Local, Bit>,
    arrived: Signal<Local, Bit>,
    steps: Signal<Local, Bit>,
    finished: Signal<Local, Bit>,
    write_bit: Signal<Local, Bits<1>>,
    read_bit: Signal<Local, Bits<1>>,
}

impl Default for PatchPairs {
    fn default() -> Self {
        Self::from_parts(PatchPairsParts {
            luma_words: Ram::new(Shape::distributed(64), &[]),
            cb_words: Ram::new(Shape::distributed(32), &[]),
            cr_words: Ram::new(Shape::distributed(32), &[]),
            queue: Queue::new(8),
        })
    }
}

impl Logic for PatchPairs {
    #[kernel]
    fn update(&mut self) {
        self.luma_words.clock.next = self.clock.val();
        self.cb_words.clock.next = self.clock.val();
        self.cr_words.clock.next = self.clock.val();
        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();

        // In: 32 beats of luma, 16 of Cb, 16 of Cr.
        self.ready.next = self.full.q.val() != 2;
        self.accept.next = self.valid.val() && (self.full.q.val() != 2);
        self.arrived.next = self.accept.val() && (self.beat.q.val() == 63);
        self.write_bit.next = self.write_slot.q.val().into();
        self.luma_words.write_enable.next = self.accept.val() && !self.beat.q.val().get_bit(5);
        self.luma_words.write_address.next = (bit_cast::<12, 1>(self.write_bit.val()) << 5)
            | bit_cast::<12, 5>(self.beat.q.val().get_bits::<5>(0));
        self.luma_words.write_data.next = self.data.val();
        self.cb_words.write_enable.next =
            self.accept.val() && self.beat.q.val().get_bit(5) && !self.beat.q.val().get_bit(4);
        self.cb_words.write_address.next = (bit_cast::<12, 1>(self.write_bit.val()) << 4)
            | bit_cast::<12, 4>(self.beat.q.val().get_bits::<4>(0));
        self.cb_words.write_data.next = self.data.val();
        self.cr_words.write_enable.next =
            self.accept.val() && self.beat.q.val().get_bit(5) && self.beat.q.val().get_bit(4);
        self.cr_words.write_address.next = (bit_cast::<12, 1>(self.write_bit.val()) << 4)
            | bit_cast::<12, 4>(self.beat.q.val().get_bits::<4>(0));
        self.cr_words.write_data.next = self.data.val();
        if self.accept.val() {
            self.beat.d.next = self.beat.q.val() + 1;
        }
        if self.arrived.val() {
            self.write_slot.d.next = !self.write_slot.q.val();
        }

        // Out: the chroma of two pairs lies in one row.
        self.steps.next = self.full.q.val().any() && self.queue.space.val();
        self.finished.next = self.steps.val() && (self.step.q.val() == 31);
        self.read_bit.next = self.read_slot.q.val().into();
        self.luma_words.read_address.next =
            (bit_cast::<12, 1>(self.read_bit.val()) << 5) | bit_cast::<12, 5>(self.step.q.val());
        self.cb_words.read_address.next = (bit_cast::<12, 1>(self.read_bit.val()) << 4)
            | bit_cast::<12, 4>(self.step.q.val().get_bits::<4>(1));
        self.cr_words.read_address.next = (bit_cast::<12, 1>(self.read_bit.val()) << 4)
            | bit_cast::<12, 4>(self.step.q.val().get_bits::<4>(1));
        if self.steps.val() {
            self.step.d.next = self.step.q.val() + 1;
        }
        if self.finished.val() {
            self.read_slot.d.next = !self.read_slot.q.val();
        }
        self.step_1.d.next = self.steps.val();
        self.half_1.d.next = self.step.q.val().get_bit(0);
        self.step_2.d.next = self.step_1.q.val();
        self.luma_2.d.next = self.luma_words.read_data.val();
        self.chroma_2.d.next = (bit_cast::<32, 16>(self.cr_words.read_data.val().get_bits::<16>(0)) << 16)
            | bit_cast::<32, 16>(self.cb_words.read_data.val().get_bits::<16>(0));
        if self.half_1.q.val() {
            self.chroma_2.d.next = (bit_cast::<32, 16>(self.cr_words.read_data.val().get_bits::<16>(16))
                << 16)
                | bit_cast::<32, 16>(self.cb_words.read_data.val().get_bits::<16>(16));
        }
        self.queue.push.next = self.step_2.q.val();
        self.queue.data.next =
            (bit_cast::<64, 32>(self.chroma_2.q.val()) << 32) | bit_cast::<64, 32>(self.luma_2.q.val());
        self.queue.front_ready.next = self.out_ready.val();
        self.out_valid.next = self.queue.front_valid.val();
        self.out_luma.next = self.queue.front_data.val().get_bits::<32>(0);
        self.out_chroma.next = self.queue.front_data.val().get_bits::<32>(32);

        if self.arrived.val() && !self.finished.val() {
            self.full.d.next = self.full.q.val() + 1;
        } else if self.finished.val() && !self.arrived.val() {
            self.full.d.next = self.full.q.val() - 1;
        }
    }
}
