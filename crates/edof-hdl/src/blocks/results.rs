//! From sums to output words.

use super::base_ring::BaseRing;
use super::delay::Delay;
use super::difference::Difference;
use super::ram::{Ram, Shape};
use super::requantize::Requantize;
use super::shrink::Shrink;
use super::{Pair, Row, Sum, Word, role};
use crate::describe::{Circuit, kernel};
use crate::verilog::Optional;
use edof_device::design::{Design, StagePlan, memory};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// From sums to output words, two elements per cycle. Counted from `take`: 7 sums and base stand here, 8 to 17 base, rounding,
/// shift and saturation, 18 to 20 threshold, 21 to 23 difference or wait. Nothing in here ever stalls.
#[derive(Circuit)]
#[circuit(default(Delay), role(_role))]
pub struct Results {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets everything.
    pub reset: Signal<In, Bit>,
    /// Two sums are taken, and stand on the inputs seven cycles later.
    pub take: Signal<In, Bit>,
    /// Which two of their vector.
    pub beat: Signal<In, Bits<8>>,
    /// The two sums are the last of their vector.
    pub last: Signal<In, Bit>,
    /// Set of the vector of the two sums.
    pub set: Signal<In, Bit>,
    /// The even sum, seven cycles after `take`.
    pub sum_even: Signal<In, Sum>,
    /// The odd one.
    pub sum_odd: Signal<In, Sum>,
    /// Shifts of set 0.
    pub shifts_0: Signal<In, Bits<20>>,
    /// Shifts of set 1.
    pub shifts_1: Signal<In, Bits<20>>,
    /// A beat with base words arrives at the stage.
    pub base_write: Signal<In, Bit>,
    /// Two base words of the beat.
    pub base_words: Signal<In, Pair>,
    /// Writes two thresholds.
    pub write_thresholds: Signal<In, Bit>,
    /// Writes two thresholds of the stage before.
    pub write_previous: Signal<In, Bit>,
    /// Address of the word to write.
    pub write_row: Signal<In, Row>,
    /// Word to write.
    pub write_data: Signal<In, Bits<32>>,
    /// Two thresholds are to be read back in a cycle in which no beat needs any.
    pub read_wanted: Signal<In, Bit>,
    /// Row of the two thresholds to read.
    pub read_row: Signal<In, Row>,
    /// The two thresholds that were read are valid.
    pub read_valid: Signal<Out, Bit>,
    /// The two thresholds that were read.
    pub read_thresholds: Signal<Out, Bits<32>>,
    /// Thresholds of the stage before.
    pub read_previous: Signal<Out, Bits<32>>,
    /// A beat is done, 23 cycles after `take`.
    pub push: Signal<Out, Bit>,
    /// Two words of the beat, the even one low.
    pub data: Signal<Out, Pair>,
    /// Bit 0 whether it is its vector's last, bit 1 its set.
    pub done: Signal<Out, Bits<2>>,
    /// Base words for the next stage are done, no later than their beat.
    pub base_push: Signal<Out, Bit>,
    /// Base words for the next stage.
    pub base: Signal<Out, Pair>,
    /// Which words are not zero.
    pub nonzero: Signal<Out, Bits<2>>,
    /// Which results did not fit.
    pub result_saturated: Signal<Out, Bits<2>>,
    /// Which thresholded codes did not fit.
    pub code_saturated: Signal<Out, Bits<2>>,
    /// Which differences did not fit.
    pub difference_saturated: Signal<Out, Bits<2>>,
    set_rows: Constant<Row>,
    marks_to_5: Delay<3, 5>,
    marks_to_6: Delay<3, 1>,
    marks_to_23: Delay<3, 17>,
    place_to_15: Delay<10, 15>,
    read_16: DFF<Bit>,
    read_17: DFF<Bit>,
    threshold_row: DFF<Row>,
    shifts: DFF<Bits<12>>,
    requantize_even: Requantize,
    requantize_odd: Requantize,
    result_flags: Delay<2, 6>,
    base_ring: Optional<BaseRing>,
    thresholds: Optional<Ram<32>>,
    shrink_even: Optional<Shrink>,
    shrink_odd: Optional<Shrink>,
    code_flags: Optional<Delay<2, 3>>,
    codes_to_23: Optional<Delay<32, 3>>,
    base_to_17: Optional<Delay<32, 10>>,
    previous_thresholds: Optional<Ram<32>>,
    previous_even: Optional<Shrink>,
    previous_odd: Optional<Shrink>,
    difference_even: Optional<Difference>,
    difference_odd: Optional<Difference>,
    result_to_23: Optional<Delay<32, 6>>,
    base_to_23: Optional<Delay<32, 6>>,
    base_mark: Optional<Delay<1, 1>>,
    marks: Signal<Local, Bits<3>>,
    place: Signal<Local, Bits<10>>,
    base_word: Signal<Local, Pair>,
    result: Signal<Local, Pair>,
    code_even: Signal<Local, Word>,
    code_odd: Signal<Local, Word>,
    code: Signal<Local, Pair>,
    change_even: Signal<Local, Word>,
    change_odd: Signal<Local, Word>,
    change: Signal<Local, Pair>,
    code_flag_even: Signal<Local, Bits<1>>,
    code_flag_odd: Signal<Local, Bits<1>>,
    code_flag: Signal<Local, Bits<2>>,
    change_flag_even: Signal<Local, Bits<1>>,
    change_flag_odd: Signal<Local, Bits<1>>,
    sent: Signal<Local, Pair>,
    _role: String,
}

impl Results {
    /// The results of a stage. The models of its memories hold the thresholds of both sets.
    #[must_use]
    pub fn new(design: &Design, stage: &StagePlan, sets: [&FixedNetwork; 2]) -> Self {
        let bits = if stage.shrinks() { design.code_bits } else { 16 };
        let shrinkage = design.form.shrinkage;
        let (has_base, shrinks, differs) = (stage.has_base(), stage.shrinks(), stage.sends_difference);
        let thresholds = |before: bool| {
            let image = Some(memory::threshold_image(stage, before));
            let words = sets.iter().flat_map(|n| memory::threshold_words(n, stage, before)).map(u64::from);
            let shape = Shape { image, ..Shape::distributed(stage.outputs) };
            Ram::new(shape, &words.collect::<Vec<_>>())
        };
        let shrink = || Shrink::new(shrinkage, bits);
        Self::from_parts(ResultsParts {
            set_rows: Constant::new((stage.beats_out() as u64).into()),
            requantize_even: Requantize::new(bits, has_base),
            requantize_odd: Requantize::new(bits, has_base),
            base_ring: Optional::when(has_base, || BaseRing::new(stage)),
            thresholds: Optional::when(shrinks, || thresholds(false)),
            shrink_even: Optional::when(shrinks, shrink),
            shrink_odd: Optional::when(shrinks, shrink),
            code_flags: Optional::when(shrinks, Delay::default),
            codes_to_23: Optional::when(shrinks && !differs, Delay::default),
            base_to_17: Optional::when(differs, Delay::default),
            previous_thresholds: Optional::when(differs, || thresholds(true)),
            previous_even: Optional::when(differs, shrink),
            previous_odd: Optional::when(differs, shrink),
            difference_even: Optional::when(differs, || Difference::new(bits)),
            difference_odd: Optional::when(differs, || Difference::new(bits)),
            result_to_23: Optional::when(!shrinks, Delay::default),
            base_to_23: Optional::when(stage.feeds_m && (differs || !has_base), Delay::default),
            base_mark: Optional::when(has_base && !differs, Delay::default),
            _role: role(stage),
        })
    }
}

impl Logic for Results {
    #[kernel]
    fn update(&mut self) {
        dff_setup!(self, clock, threshold_row, shifts, read_16, read_17);
        self.marks_to_5.clock.next = self.clock.val();
        self.marks_to_6.clock.next = self.clock.val();
        self.marks_to_23.clock.next = self.clock.val();
        self.place_to_15.clock.next = self.clock.val();
        self.requantize_even.clock.next = self.clock.val();
        self.requantize_odd.clock.next = self.clock.val();
        self.result_flags.clock.next = self.clock.val();

        // What travels with a beat: bit 0 it is one, bit 1 last, bit 2 set.
        self.marks.next = (bit_cast::<3, 1>(self.set.val().into()) << 2)
            | (bit_cast::<3, 1>(self.last.val().into()) << 1)
            | bit_cast::<3, 1>(self.take.val().into());
        self.marks_to_5.data.next = self.marks.val();
        self.marks_to_6.data.next = self.marks_to_5.delayed.val();
        self.marks_to_23.data.next = self.marks_to_6.delayed.val();
        self.place.next = (bit_cast::<10, 1>(self.take.val().into()) << 9)
            | (bit_cast::<10, 1>(self.set.val().into()) << 8)
            | bit_cast::<10, 8>(self.beat.val());
        self.place_to_15.data.next = self.place.val();

        // Cycles 7 to 17: base and rounding.
        self.base_word.next = 0.into();
        for i in 0..self.base_ring.count() {
            self.base_ring[i].clock.next = self.clock.val();
            self.base_ring[i].reset.next = self.reset.val();
            self.base_ring[i].write.next = self.base_write.val();
            self.base_ring[i].words.next = self.base_words.val();
            self.base_ring[i].read.next = self.marks_to_5.delayed.val().get_bit(0);
            self.base_word.next = self.base_ring[i].front.val();
        }
        self.shifts.d.next = self.shifts_0.val().get_bits::<12>(0);
        if self.marks_to_6.delayed.val().get_bit(2) {
            self.shifts.d.next = self.shifts_1.val().get_bits::<12>(0);
        }
        self.requantize_even.sum.next = self.sum_even.val();
        self.requantize_even.base.next = self.base_word.val().get_bits::<16>(0);
        self.requantize_even.base_shift.next = self.shifts.q.val().get_bits::<6>(6);
        self.requantize_even.result_shift.next = self.shifts.q.val().get_bits::<6>(0);
        self.requantize_odd.sum.next = self.sum_odd.val();
        self.requantize_odd.base.next = self.base_word.val().get_bits::<16>(16);
        self.requantize_odd.base_shift.next = self.shifts.q.val().get_bits::<6>(6);
        self.requantize_odd.result_shift.next = self.shifts.q.val().get_bits::<6>(0);
        self.result.next = (bit_cast::<32, 16>(self.requantize_odd.result.val()) << 16)
            | bit_cast::<32, 16>(self.requantize_even.result.val());
        self.result_flags.data.next = (bit_cast::<2, 1>(self.requantize_odd.saturated.val().into()) << 1)
            | bit_cast::<2, 1>(self.requantize_even.saturated.val().into());
        self.result_saturated.next = self.result_flags.delayed.val();

        // Cycles 18 to 20: thresholds, read in cycle 17.
        self.threshold_row.d.next = bit_cast::<12, 8>(self.place_to_15.delayed.val().get_bits::<8>(0));
        if self.place_to_15.delayed.val().get_bit(8) {
            self.threshold_row.d.next =
                bit_cast::<12, 8>(self.place_to_15.delayed.val().get_bits::<8>(0)) + self.set_rows.val();
        }
        self.read_16.d.next = self.read_wanted.val();
        if self.place_to_15.delayed.val().get_bit(9) {
            self.read_16.d.next = false;
        } else {
            self.threshold_row.d.next = self.read_row.val();
        }
        self.read_17.d.next = self.read_16.q.val();
        self.read_valid.next = self.read_17.q.val();
        self.read_thresholds.next = 0.into();
        self.read_previous.next = 0.into();
        self.code_flag_even.next = 0.into();
        self.code_flag_odd.next = 0.into();
        self.code_even.next = 0.into();
        self.code_odd.next = 0.into();
        self.code_saturated.next = 0.into();
        for i in 0..self.thresholds.count() {
            self.thresholds[i].clock.next = self.clock.val();
            self.thresholds[i].read_address.next = self.threshold_row.q.val();
            self.read_thresholds.next = self.thresholds[i].read_data.val();
            self.thresholds[i].write_enable.next = self.write_thresholds.val();
            self.thresholds[i].write_address.next = self.write_row.val();
            self.thresholds[i].write_data.next = self.write_data.val();
            self.shrink_even[i].clock.next = self.clock.val();
            self.shrink_even[i].code.next = self.requantize_even.result.val();
            self.shrink_even[i].threshold.next = self.thresholds[i].read_data.val().get_bits::<16>(0);
            self.shrink_odd[i].clock.next = self.clock.val();
            self.shrink_odd[i].code.next = self.requantize_odd.result.val();
            self.shrink_odd[i].threshold.next = self.thresholds[i].read_data.val().get_bits::<16>(16);
            self.code_even.next = self.shrink_even[i].result.val();
            self.code_odd.next = self.shrink_odd[i].result.val();
            self.code_flags[i].clock.next = self.clock.val();
            self.code_flag_even.next = self.shrink_even[i].saturated.val();
            self.code_flag_odd.next = self.shrink_odd[i].saturated.val();
        }
        self.code_flag.next =
            (bit_cast::<2, 1>(self.code_flag_odd.val()) << 1) | bit_cast::<2, 1>(self.code_flag_even.val());
        self.code.next =
            (bit_cast::<32, 16>(self.code_odd.val()) << 16) | bit_cast::<32, 16>(self.code_even.val());
        for i in 0..self.thresholds.count() {
            self.code_flags[i].data.next = self.code_flag.val();
            self.code_saturated.next = self.code_flags[i].delayed.val();
        }
        self.sent.next = 0.into();
        for i in 0..self.codes_to_23.count() {
            self.codes_to_23[i].clock.next = self.clock.val();
            self.codes_to_23[i].data.next = self.code.val();
            self.sent.next = self.codes_to_23[i].delayed.val();
        }

        // Cycles 21 to 23: the difference to the z before, made again from the base and the thresholds before.
        self.change_flag_even.next = 0.into();
        self.change_flag_odd.next = 0.into();
        self.change_even.next = 0.into();
        self.change_odd.next = 0.into();
        for i in 0..self.difference_even.count() {
            self.change_even.next = self.difference_even[i].result.val();
            self.change_odd.next = self.difference_odd[i].result.val();
            self.change_flag_even.next = self.difference_even[i].saturated.val();
            self.change_flag_odd.next = self.difference_odd[i].saturated.val();
        }
        self.difference_saturated.next = (bit_cast::<2, 1>(self.change_flag_odd.val()) << 1)
            | bit_cast::<2, 1>(self.change_flag_even.val());
        self.change.next =
            (bit_cast::<32, 16>(self.change_odd.val()) << 16) | bit_cast::<32, 16>(self.change_even.val());
        for i in 0..self.difference_even.count() {
            self.base_to_17[i].clock.next = self.clock.val();
            self.base_to_17[i].data.next = self.base_word.val();
            self.previous_thresholds[i].clock.next = self.clock.val();
            self.previous_thresholds[i].read_address.next = self.threshold_row.q.val();
            self.read_previous.next = self.previous_thresholds[i].read_data.val();
            self.previous_thresholds[i].write_enable.next = self.write_previous.val();
            self.previous_thresholds[i].write_address.next = self.write_row.val();
            self.previous_thresholds[i].write_data.next = self.write_data.val();
            self.previous_even[i].clock.next = self.clock.val();
            self.previous_even[i].code.next = self.base_to_17[i].delayed.val().get_bits::<16>(0);
            self.previous_even[i].threshold.next =
                self.previous_thresholds[i].read_data.val().get_bits::<16>(0);
            self.previous_odd[i].clock.next = self.clock.val();
            self.previous_odd[i].code.next = self.base_to_17[i].delayed.val().get_bits::<16>(16);
            self.previous_odd[i].threshold.next =
                self.previous_thresholds[i].read_data.val().get_bits::<16>(16);
            self.difference_even[i].clock.next = self.clock.val();
            self.difference_even[i].current.next = self.code_even.val();
            self.difference_even[i].previous.next = self.previous_even[i].result.val();
            self.difference_odd[i].clock.next = self.clock.val();
            self.difference_odd[i].current.next = self.code_odd.val();
            self.difference_odd[i].previous.next = self.previous_odd[i].result.val();
            self.sent.next = self.change.val();
        }

        // Output words.
        self.base_push.next = self.marks_to_23.delayed.val().get_bit(0);
        self.base.next = 0.into();
        for i in 0..self.result_to_23.count() {
            self.result_to_23[i].clock.next = self.clock.val();
            self.result_to_23[i].data.next = self.result.val();
            self.sent.next = self.result_to_23[i].delayed.val();
        }
        for i in 0..self.base_to_23.count() {
            self.base_to_23[i].clock.next = self.clock.val();
            self.base_to_23[i].data.next = self.result.val();
            self.base.next = self.base_to_23[i].delayed.val();
        }
        // Base words that only pass through wait where all do, in the FIFO behind.
        for i in 0..self.base_mark.count() {
            self.base_mark[i].clock.next = self.clock.val();
            self.base_mark[i].data.next = self.marks_to_6.delayed.val().get_bits::<1>(0);
            self.base_push.next = self.base_mark[i].delayed.val().get_bit(0);
            self.base.next = self.base_word.val();
        }
        self.data.next = self.sent.val();
        self.push.next = self.marks_to_23.delayed.val().get_bit(0);
        self.done.next = self.marks_to_23.delayed.val().get_bits::<2>(1);
        self.nonzero.next = (bit_cast::<2, 1>(self.sent.val().get_bits::<16>(16).any().into()) << 1)
            | bit_cast::<2, 1>(self.sent.val().get_bits::<16>(0).any().into());
    }
}
