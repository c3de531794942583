//! From sums to output words.

use super::base_ring::BaseRing;
use super::delay::{Delay, DelayOf};
use super::difference::Difference;
use super::ram::{Ram, Shape};
use super::requantize::Requantize;
use super::shrink::Shrink;
use super::{Pair, Row, Sum, Whole, Word, whole};
use crate::describe::{Circuit, kernel};
use crate::verilog::Optional;
use edof_device::design::{Design, StagePlan, memory};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// From sums to output words, two elements per cycle. Counted from `take`: 7 sums and base stand here, 8 to 17 base, rounding,
/// shift and saturation, 18 to 20 threshold, 21 to 23 difference or wait. Nothing in here ever stalls.
/// A memory of depth 0 and a delay of 0 cycles are absent: what only other stages need costs nothing.
#[derive(Circuit)]
#[circuit(default(Delay), role(_role), registers(clock))]
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
    outputs: Constant<Whole>,
    /// 1 where a base is added (M).
    has_base: Constant<Whole>,
    /// 1 where the next stage is an M, so that base words are sent.
    feeds_m: Constant<Whole>,
    /// 1 where the difference to the codes before is sent.
    differs: Constant<Whole>,
    #[is(outputs / 2)]
    set_rows: Constant<Row>,
    /// Codes are sent (I, M), not results (F).
    shrinks: Constant<Bit>,
    /// Base words for the next stage are those that came in.
    #[is(has_base > differs)]
    passes_base: Constant<Bit>,
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
    base_ring: BaseRing,
    #[is(DEPTH = if shrinks { outputs } else { 0 })]
    thresholds: Ram<32>,
    shrink_even: Shrink,
    shrink_odd: Shrink,
    #[is(CYCLES = if shrinks { 3 } else { 0 })]
    code_flags: DelayOf<2>,
    #[is(CYCLES = if shrinks { 3 - 3 * differs } else { 0 })]
    codes_to_23: DelayOf<32>,
    #[is(CYCLES = if shrinks { 0 } else { 6 })]
    result_to_23: DelayOf<32>,
    #[is(CYCLES = if passes_base { 0 } else { 6 * feeds_m })]
    base_to_23: DelayOf<32>,
    base_mark: DFF<Bit>,
    base_to_17: Optional<Delay<32, 10>>,
    previous_thresholds: Optional<Ram<32>>,
    previous_even: Optional<Shrink>,
    previous_odd: Optional<Shrink>,
    difference_even: Optional<Difference>,
    difference_odd: Optional<Difference>,
    marks: Signal<Local, Bits<3>>,
    place: Signal<Local, Bits<10>>,
    result: Signal<Local, Pair>,
    code: Signal<Local, Pair>,
    change_even: Signal<Local, Word>,
    change_odd: Signal<Local, Word>,
    change: Signal<Local, Pair>,
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
        let thresholds = |before: bool, depth: usize| {
            let image = (depth > 0).then(|| memory::threshold_image(stage, before));
            let words =
                sets.iter().filter(|_| depth > 0).flat_map(|n| memory::threshold_words(n, stage, before));
            Ram::new(Shape { image, ..Shape::distributed(depth) }, &words.map(u64::from).collect::<Vec<_>>())
        };
        let shrink = || Shrink::new(shrinkage, design.code_bits);
        let delay = |is_there: bool, cycles: usize| if is_there { cycles } else { 0 };
        let passes_base = has_base && !differs;
        Self::from_parts(ResultsParts {
            outputs: whole(stage.outputs),
            has_base: whole(has_base.into()),
            feeds_m: whole(stage.feeds_m.into()),
            differs: whole(differs.into()),
            shrinks: Constant::new(shrinks),
            requantize_even: Requantize::new(bits, has_base),
            requantize_odd: Requantize::new(bits, has_base),
            base_ring: BaseRing::new(stage),
            thresholds: thresholds(false, if shrinks { stage.outputs } else { 0 }),
            shrink_even: shrink(),
            shrink_odd: shrink(),
            code_flags: DelayOf::new(delay(shrinks, 3)),
            codes_to_23: DelayOf::new(delay(shrinks && !differs, 3)),
            result_to_23: DelayOf::new(delay(!shrinks, 6)),
            base_to_23: DelayOf::new(delay(stage.feeds_m && !passes_base, 6)),
            base_to_17: Optional::when(differs, Delay::default),
            previous_thresholds: Optional::when(differs, || thresholds(true, stage.outputs)),
            previous_even: Optional::when(differs, shrink),
            previous_odd: Optional::when(differs, shrink),
            difference_even: Optional::when(differs, || Difference::new(bits)),
            difference_odd: Optional::when(differs, || Difference::new(bits)),
            _role: if differs { "difference".into() } else { String::new() },
        })
    }
}

impl Logic for Results {
    #[kernel]
    fn update(&mut self) {
        self.marks_to_5.clock.next = self.clock.val();
        self.marks_to_6.clock.next = self.clock.val();
        self.marks_to_23.clock.next = self.clock.val();
        self.place_to_15.clock.next = self.clock.val();
        self.requantize_even.clock.next = self.clock.val();
        self.requantize_odd.clock.next = self.clock.val();
        self.result_flags.clock.next = self.clock.val();
        self.base_ring.clock.next = self.clock.val();
        self.thresholds.clock.next = self.clock.val();
        self.shrink_even.clock.next = self.clock.val();
        self.shrink_odd.clock.next = self.clock.val();
        self.code_flags.clock.next = self.clock.val();
        self.codes_to_23.clock.next = self.clock.val();
        self.result_to_23.clock.next = self.clock.val();
        self.base_to_23.clock.next = self.clock.val();

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
        self.base_ring.reset.next = self.reset.val();
        self.base_ring.write.next = self.base_write.val();
        self.base_ring.words.next = self.base_words.val();
        self.base_ring.read.next = self.marks_to_5.delayed.val().get_bit(0);
        self.shifts.d.next = self.shifts_0.val().get_bits::<12>(0);
        if self.marks_to_6.delayed.val().get_bit(2) {
            self.shifts.d.next = self.shifts_1.val().get_bits::<12>(0);
        }
        self.requantize_even.sum.next = self.sum_even.val();
        self.requantize_even.base.next = self.base_ring.front.val().get_bits::<16>(0);
        self.requantize_even.base_shift.next = self.shifts.q.val().get_bits::<6>(6);
        self.requantize_even.result_shift.next = self.shifts.q.val().get_bits::<6>(0);
        self.requantize_odd.sum.next = self.sum_odd.val();
        self.requantize_odd.base.next = self.base_ring.front.val().get_bits::<16>(16);
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
        self.read_previous.next = 0.into();
        self.thresholds.read_address.next = self.threshold_row.q.val();
        self.thresholds.write_enable.next = self.write_thresholds.val();
        self.thresholds.write_address.next = self.write_row.val();
        self.thresholds.write_data.next = self.write_data.val();
        self.read_thresholds.next = self.thresholds.read_data.val();
        self.shrink_even.code.next = self.requantize_even.result.val();
        self.shrink_even.threshold.next = self.thresholds.read_data.val().get_bits::<16>(0);
        self.shrink_odd.code.next = self.requantize_odd.result.val();
        self.shrink_odd.threshold.next = self.thresholds.read_data.val().get_bits::<16>(16);
        self.code_flags.data.next = (bit_cast::<2, 1>(self.shrink_odd.saturated.val()) << 1)
            | bit_cast::<2, 1>(self.shrink_even.saturated.val());
        self.code_saturated.next = self.code_flags.delayed.val();
        self.code.next = (bit_cast::<32, 16>(self.shrink_odd.result.val()) << 16)
            | bit_cast::<32, 16>(self.shrink_even.result.val());
        self.codes_to_23.data.next = self.code.val();
        self.result_to_23.data.next = self.result.val();
        self.sent.next = self.result_to_23.delayed.val();
        if self.shrinks.val() {
            self.sent.next = self.codes_to_23.delayed.val();
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
            self.base_to_17[i].data.next = self.base_ring.front.val();
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
            self.difference_even[i].current.next = self.shrink_even.result.val();
            self.difference_even[i].previous.next = self.previous_even[i].result.val();
            self.difference_odd[i].clock.next = self.clock.val();
            self.difference_odd[i].current.next = self.shrink_odd.result.val();
            self.difference_odd[i].previous.next = self.previous_odd[i].result.val();
            self.sent.next = self.change.val();
        }

        // Output words. Base words that only pass through wait where all do, in the FIFO behind.
        self.base_to_23.data.next = self.result.val();
        self.base_mark.d.next = self.marks_to_6.delayed.val().get_bit(0);
        self.base_push.next = self.marks_to_23.delayed.val().get_bit(0);
        self.base.next = self.base_to_23.delayed.val();
        if self.passes_base.val() {
            self.base_push.next = self.base_mark.q.val();
            self.base.next = self.base_ring.front.val();
        }
        self.data.next = self.sent.val();
        self.push.next = self.marks_to_23.delayed.val().get_bit(0);
        self.done.next = self.marks_to_23.delayed.val().get_bits::<2>(1);
        self.nonzero.next = (bit_cast::<2, 1>(self.sent.val().get_bits::<16>(16).any().into()) << 1)
            | bit_cast::<2, 1>(self.sent.val().get_bits::<16>(0).any().into());
    }
}
