//! One stage of the calculator: I, M or F.

use super::counters::Counters;
use super::delay::{Delay, DelayOf};
use super::dense_operands::DenseOperands;
use super::dense_store::DenseStore;
use super::drain::Drain;
use super::fifo::Fifo;
use super::frame_check::FrameCheck;
use super::macc_array::MaccArray;
use super::pair_operands::PairOperands;
use super::pair_store::PairStore;
use super::reader::Reader;
use super::registers::Registers;
use super::results::Results;
use super::sequencer::Sequencer;
use super::window_ring::WindowRing;
use super::{Pair, Row, Whole, role, whole};
use crate::describe::{Circuit, kernel};
use edof_device::design::memory::{CONTROL_SKIP, Shifts, WHOLE_CHAIN, shift_image};
use edof_device::design::reading::READ_REGISTER;
use edof_device::design::{Design, StagePlan};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;

/// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has its cycles.
/// Values are multiplied as they come out of the store; sums are copied, drained, rounded, shrunk and sent on.
#[derive(Circuit)]
#[circuit(default(Counters, Delay, Reader), role(_role), registers(clock))]
pub struct Stage {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets every vector and what was written to registers; held for 48 cycles or more, and two more pass until something can be taken.
    pub reset: Signal<In, Bit>,
    /// Drops every vector and nothing else; held for as long as `reset`.
    pub flush: Signal<In, Bit>,
    /// The input beat is valid.
    pub valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub ready: Signal<Out, Bit>,
    /// Two words of the beat, the even one low.
    pub data: Signal<In, Pair>,
    /// Base words of the same two elements (M).
    pub base: Signal<In, Pair>,
    /// The beat is the last of its vector.
    pub last: Signal<In, Bit>,
    /// The vector's set.
    pub set: Signal<In, Bit>,
    /// Two pixels on the window input are valid (F with a linear path).
    pub window_valid: Signal<In, Bit>,
    /// The block accepts a valid input in this cycle.
    pub window_ready: Signal<Out, Bit>,
    /// Two pixels of the window, the left one low.
    pub window_data: Signal<In, Pair>,
    /// The beat is the last of its window.
    pub window_last: Signal<In, Bit>,
    /// The output beat is valid.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver accepts the output in this cycle.
    pub out_ready: Signal<In, Bit>,
    /// Two words of the beat, the even one low.
    pub out_data: Signal<Out, Pair>,
    /// Base words of the same two elements.
    pub out_base: Signal<Out, Pair>,
    /// The beat is the last of its vector.
    pub out_last: Signal<Out, Bit>,
    /// The vector's set.
    pub out_set: Signal<Out, Bit>,
    /// The word to write is valid (`edof_device::design::memory::address`).
    pub write_valid: Signal<In, Bit>,
    /// Address of the word to write.
    pub write_address: Signal<In, Bits<25>>,
    /// Word to write.
    pub write_data: Signal<In, Bits<32>>,
    /// What to show: bit 6 counters or what was read back, then stage (4 bits), then which (2 bits).
    pub status_address: Signal<In, Bits<7>>,
    /// Word that `status_address` selected, one cycle later; 0 from all other stages.
    pub status: Signal<Out, Bits<32>>,
    id: Constant<Bits<4>>,
    inputs: Constant<Whole>,
    /// Pixels of the linear path (F).
    window_pixels: Constant<Whole>,
    /// Parts of a vector that are read in step (I).
    parts: Constant<Whole>,
    /// Outputs that are computed at a time.
    lanes: Constant<Whole>,
    outputs: Constant<Whole>,
    /// Sets of weights.
    sets: Constant<Whole>,
    /// 1 where the next stage is an M, so that base words are sent.
    feeds_m: Constant<Whole>,
    whole_chain: Constant<Bits<4>>,
    /// Both ports of a bank's memory read two rows a step (M, F).
    two_rows: Constant<Bit>,
    /// 1 where dense vectors come in (I), 0 where pairs are made of them (M, F).
    dense: Constant<Whole>,
    #[is(dense > 0)]
    is_dense: Constant<Bit>,
    /// A linear path: windows come in, too (F).
    #[is(window_pixels > 0)]
    has_linear: Constant<Bit>,
    read_register: Constant<Row>,
    skip_bit: Constant<Bits<32>>,
    reset_parts: Delay<8, 1>,
    reset_registers: Delay<1, 1>,
    // A stage uses the store and the operands of dense vectors (I), or those of pairs (M, F). The others are absent.
    pairs: PairStore,
    pair_operands: PairOperands,
    vectors: DenseStore,
    dense_operands: DenseOperands,
    ring: WindowRing,
    sequencer: Sequencer,
    #[is(BANKS = lanes / 4)]
    #[is(DEPTH = sets * (outputs / lanes) * (inputs / parts + window_pixels))]
    macc: MaccArray,
    drain: Drain,
    #[is(CYCLES = (lanes + 31) / 32)]
    marks_to_groups: DelayOf<11>,
    results: Results,
    fifo: Fifo<34>,
    #[is(DEPTH = 128 * feeds_m)]
    base_fifo: Fifo<32>,
    registers: Registers,
    counters: Counters,
    check: FrameCheck,
    reader: Reader,
    status_q: DFF<Bits<32>>,
    write_1: DFF<Bit>,
    address_1: DFF<Bits<25>>,
    data_1: DFF<Bits<32>>,
    weights_2: DFF<Bit>,
    thresholds_2: DFF<Bit>,
    previous_2: DFF<Bit>,
    registers_2: DFF<Bit>,
    command_2: DFF<Bit>,
    address_2: DFF<Bits<19>>,
    data_2: DFF<Bits<32>>,
    snapshot_2: DFF<Bit>,
    read_2: DFF<Bit>,
    weights_to_5: Delay<53, 3>,
    resets: Signal<Local, Bits<8>>,
    marks: Signal<Local, Bits<11>>,
    ready_in: Signal<Local, Bit>,
    finished_word: Signal<Local, Bits<34>>,
    selected: Signal<Local, Bit>,
    reads: Signal<Local, Bit>,
    weights_word: Signal<Local, Bits<53>>,
    weights_marks: Signal<Local, Bits<53>>,
    read_word: Signal<Local, Bits<32>>,
    _role: String,
}

impl Stage {
    /// Stage `stage` of a design. Set 0 and set 1 start with the weights, thresholds and shifts of these networks, which fit the design.
    #[must_use]
    pub fn new(design: &Design, stage: &StagePlan, sets: [&FixedNetwork; 2]) -> Self {
        let is_dense = stage.is_dense();
        let sums = design.accumulator_bits;
        let first = &design.stage(0);
        Self::from_parts(StageParts {
            id: Constant::new((stage.index as u64).into()),
            inputs: whole(stage.inputs),
            window_pixels: whole(stage.linear),
            parts: whole(if is_dense { stage.rows } else { 1 }),
            lanes: whole(stage.lanes),
            outputs: whole(stage.outputs),
            sets: whole(stage.sets),
            feeds_m: whole(stage.feeds_m.into()),
            whole_chain: Constant::new((WHOLE_CHAIN as u64).into()),
            read_register: Constant::new((READ_REGISTER as u64).into()),
            skip_bit: Constant::new(u64::from(CONTROL_SKIP).into()),
            two_rows: Constant::new(stage.reads_both_ports()),
            dense: whole(is_dense.into()),
            pairs: PairStore::new(stage),
            pair_operands: PairOperands::new(stage),
            vectors: DenseStore::new(first, is_dense),
            dense_operands: DenseOperands::new(is_dense),
            ring: WindowRing::new(stage),
            sequencer: Sequencer::new(stage),
            macc: MaccArray::new(stage, sums, sets),
            drain: Drain::new(stage),
            check: FrameCheck::new(32, design.patches_per_frame() * stage.beats_out()),
            marks_to_groups: DelayOf::new(stage.groups()),
            results: Results::new(design, stage, sets),
            fifo: Fifo::new(true),
            base_fifo: Fifo::new(stage.feeds_m),
            registers: Registers::new(
                shift_image(stage),
                sets.map(|n| Shifts::of(n, stage)),
                design.skip_zeros,
            ),
            _role: role(stage),
        })
    }
}

impl Logic for Stage {
    #[kernel]
    fn update(&mut self) {
        self.sequencer.clock.next = self.clock.val();
        self.macc.clock.next = self.clock.val();
        self.drain.clock.next = self.clock.val();
        self.results.clock.next = self.clock.val();
        self.fifo.clock.next = self.clock.val();
        self.base_fifo.clock.next = self.clock.val();
        self.registers.clock.next = self.clock.val();
        self.counters.clock.next = self.clock.val();
        self.check.clock.next = self.clock.val();
        self.check.reset.next = self.reset_parts.delayed.val().get_bit(7);
        self.weights_to_5.clock.next = self.clock.val();
        self.reader.clock.next = self.clock.val();

        // Each part has a register for its reset.
        self.resets.next = 0.into();
        if self.reset.val() || self.flush.val() {
            self.resets.next = 0xff.into();
        }
        self.reset_parts.clock.next = self.clock.val();
        self.reset_parts.data.next = self.resets.val();
        self.reset_registers.clock.next = self.clock.val();
        self.reset_registers.data.next = self.reset.val().into();
        self.reader.reset.next = self.reset_parts.delayed.val().get_bit(6);
        self.sequencer.reset.next = self.reset_parts.delayed.val().get_bit(2);
        self.drain.reset.next = self.reset_parts.delayed.val().get_bit(3);
        self.results.reset.next = self.reset_parts.delayed.val().get_bit(4);
        self.fifo.reset.next = self.reset_parts.delayed.val().get_bit(5);
        self.base_fifo.reset.next = self.reset_parts.delayed.val().get_bit(5);
        self.registers.reset.next = self.reset_registers.delayed.val().get_bit(0);
        self.counters.reset.next = self.reset_registers.delayed.val().get_bit(0);

        // In: vectors, bases, windows.
        self.pairs.clock.next = self.clock.val();
        self.pairs.reset.next = self.reset_parts.delayed.val().get_bit(0);
        self.pairs.skip_zeros.next = self.registers.skip_zeros.val();
        self.pairs.valid.next = self.valid.val();
        self.pairs.even.next = self.data.val().get_bits::<16>(0);
        self.pairs.odd.next = self.data.val().get_bits::<16>(16);
        self.pairs.last.next = self.last.val();
        self.pairs.set.next = self.set.val();
        self.pairs.read_row.next = self.sequencer.read_row.val();
        self.pairs.finished.next = self.sequencer.finished.val();
        self.vectors.clock.next = self.clock.val();
        self.vectors.reset.next = self.reset_parts.delayed.val().get_bit(0);
        self.vectors.valid.next = self.valid.val();
        self.vectors.data.next = self.data.val();
        self.vectors.last.next = self.last.val();
        self.vectors.set.next = self.set.val();
        self.vectors.read_row.next = self.sequencer.read_row.val();
        self.vectors.finished.next = self.sequencer.finished.val();
        self.ready_in.next = self.pairs.ready.val();
        self.sequencer.arrived.next = self.pairs.arrived.val();
        self.sequencer.descriptor.next = self.pairs.descriptor.val();
        if self.is_dense.val() {
            self.ready_in.next = self.vectors.ready.val();
            self.sequencer.arrived.next = self.vectors.arrived.val();
            self.sequencer.descriptor.next = self.vectors.descriptor.val();
        }
        self.ready.next = self.ready_in.val();
        self.results.base_write.next = self.valid.val() && self.ready_in.val();
        self.results.base_words.next = self.base.val();
        self.ring.clock.next = self.clock.val();
        self.ring.reset.next = self.reset_parts.delayed.val().get_bit(1);
        self.ring.valid.next = self.window_valid.val();
        self.ring.pixels.next = self.window_data.val();
        self.ring.last.next = self.window_last.val();
        self.ring.read_pair.next = self.sequencer.read_pixels.val();
        self.ring.finished.next = self.sequencer.finished.val();
        self.window_ready.next = !self.has_linear.val() || self.ring.ready.val();

        // Multiply.
        self.sequencer.release.next = self.drain.release.val();
        self.pair_operands.clock.next = self.clock.val();
        self.pair_operands.valid_a.next = self.sequencer.valid_a.val();
        self.pair_operands.valid_b.next = self.sequencer.valid_b.val();
        self.pair_operands.first.next = self.sequencer.first.val();
        self.pair_operands.linear.next = self.sequencer.linear.val();
        self.pair_operands.odd.next = self.sequencer.odd.val();
        self.pair_operands.set.next = self.sequencer.set.val();
        self.pair_operands.base.next = self.sequencer.base.val();
        self.pair_operands.offset.next = self.sequencer.offset.val();
        self.pair_operands.even_pair.next = self.pairs.even_pair.val();
        self.pair_operands.odd_pair.next = self.pairs.odd_pair.val();
        self.pair_operands.pixels.next = self.ring.read_pixels.val();
        self.pair_operands.shifts_0.next = self.registers.shifts_0.val().get_bits::<8>(12);
        self.pair_operands.shifts_1.next = self.registers.shifts_1.val().get_bits::<8>(12);
        self.dense_operands.clock.next = self.clock.val();
        self.dense_operands.valid.next = self.sequencer.valid_a.val();
        self.dense_operands.first.next = self.sequencer.first.val();
        self.dense_operands.odd.next = self.sequencer.odd.val();
        self.dense_operands.base.next = self.sequencer.base.val();
        self.dense_operands.offset.next = self.sequencer.offset.val();
        self.dense_operands.pair_a.next = self.vectors.pair_a.val();
        self.dense_operands.pair_b.next = self.vectors.pair_b.val();
        self.dense_operands.pair_c.next = self.vectors.pair_c.val();
        self.dense_operands.pair_d.next = self.vectors.pair_d.val();
        self.macc.first.next = self.pair_operands.step_first.val();
        self.macc.address_a.next = self.pair_operands.address_a.val();
        self.macc.address_b.next = self.pair_operands.address_b.val();
        self.macc.value_a.next = self.pair_operands.value_a.val();
        self.macc.value_b.next = self.pair_operands.value_b.val();
        self.macc.value_c.next = self.dense_operands.value_c.val();
        self.macc.value_d.next = self.dense_operands.value_d.val();
        if self.is_dense.val() {
            self.macc.first.next = self.dense_operands.step_first.val();
            self.macc.address_a.next = self.dense_operands.address.val();
            self.macc.value_a.next = self.dense_operands.value_a.val();
            self.macc.value_b.next = self.dense_operands.value_b.val();
        }

        // Drain.
        self.drain.pass_issued.next = self.sequencer.pass_issued.val();
        self.drain.set.next = self.sequencer.set.val();
        self.macc.copy.next = self.drain.copy.val();
        self.macc.shift.next = self.drain.take.val();
        // What belongs to two sums waits while these pass the groups of banks: bit 0 taken, 1 last, 2 set, then which.
        self.marks.next = (bit_cast::<11, 8>(self.drain.beat.val()) << 3)
            | (bit_cast::<11, 1>(self.drain.take_set.val().into()) << 2)
            | (bit_cast::<11, 1>(self.drain.last.val().into()) << 1)
            | bit_cast::<11, 1>(self.drain.take.val().into());
        self.marks_to_groups.clock.next = self.clock.val();
        self.marks_to_groups.data.next = self.marks.val();
        self.results.take.next = self.marks_to_groups.delayed.val().get_bit(0);
        self.results.last.next = self.marks_to_groups.delayed.val().get_bit(1);
        self.results.set.next = self.marks_to_groups.delayed.val().get_bit(2);
        self.results.beat.next = self.marks_to_groups.delayed.val().get_bits::<8>(3);
        self.results.sum_even.next = self.macc.sum_even.val();
        self.results.sum_odd.next = self.macc.sum_odd.val();
        self.results.shifts_0.next = self.registers.shifts_0.val();
        self.results.shifts_1.next = self.registers.shifts_1.val();

        // Out.
        self.finished_word.next =
            (bit_cast::<34, 32>(self.results.data.val()) << 2) | bit_cast::<34, 2>(self.results.done.val());
        self.fifo.push.next = self.results.push.val();
        self.fifo.data.next = self.finished_word.val();
        self.fifo.front_ready.next = self.out_ready.val();
        self.drain.credit_return.next = self.fifo.front_valid.val() && self.out_ready.val();
        self.out_valid.next = self.fifo.front_valid.val();
        self.check.valid.next = self.fifo.front_valid.val() && self.out_ready.val();
        self.check.data.next = self.fifo.front_data.val().get_bits::<32>(2);
        self.out_data.next = self.fifo.front_data.val().get_bits::<32>(2);
        self.out_last.next = self.fifo.front_data.val().get_bit(0);
        self.out_set.next = self.fifo.front_data.val().get_bit(1);
        self.base_fifo.push.next = self.results.base_push.val();
        self.base_fifo.data.next = self.results.base.val();
        self.base_fifo.front_ready.next = self.fifo.front_valid.val() && self.out_ready.val();
        self.out_base.next = self.base_fifo.front_data.val();
        self.counters.enable.next = self.results.push.val();
        self.counters.nonzero.next = self.results.nonzero.val();
        self.counters.results.next = self.results.result_saturated.val();
        self.counters.codes.next = self.results.code_saturated.val();
        self.counters.differences.next = self.results.difference_saturated.val();

        // The host. A weight that both ports read, or a row that is read back, takes the place of a step, four cycles after that was due.
        self.write_1.d.next = self.write_valid.val();
        self.address_1.d.next = self.write_address.val();
        self.data_1.d.next = self.write_data.val();
        self.selected.next =
            self.write_1.q.val() && (self.address_1.q.val().get_bits::<4>(21) == self.id.val());
        self.weights_2.d.next = self.selected.val() && (self.address_1.q.val().get_bits::<2>(19) == 0);
        self.thresholds_2.d.next = self.selected.val() && (self.address_1.q.val().get_bits::<2>(19) == 1);
        self.previous_2.d.next = self.selected.val() && (self.address_1.q.val().get_bits::<2>(19) == 2);
        self.registers_2.d.next = self.selected.val() && (self.address_1.q.val().get_bits::<2>(19) == 3);
        self.command_2.d.next = self.selected.val()
            && (self.address_1.q.val().get_bits::<2>(19) == 3)
            && (self.address_1.q.val().get_bits::<12>(1) == self.read_register.val());
        self.address_2.d.next = self.address_1.q.val().get_bits::<19>(0);
        self.data_2.d.next = self.data_1.q.val();
        // A row is read back in a cycle without a write, whatever that would write.
        self.reads.next = self.reader.request_weights.val() && !self.write_1.q.val();
        self.read_2.d.next = self.reads.val();
        self.sequencer.steal_next.next = self.reads.val()
            || (self.two_rows.val()
                && self.selected.val()
                && (self.address_1.q.val().get_bits::<2>(19) == 0));
        if self.reads.val() {
            self.address_2.d.next = (bit_cast::<19, 6>(self.reader.bank.val()) << 13)
                | (bit_cast::<19, 12>(self.reader.row.val()) << 1);
        }
        self.snapshot_2.d.next = self.write_1.q.val()
            && (self.address_1.q.val().get_bits::<4>(21) == self.whole_chain.val())
            && (self.address_1.q.val().get_bits::<2>(19) == 3);
        // Bit 0 writes, bit 1 reads.
        self.weights_word.next = (bit_cast::<53, 19>(self.address_2.q.val()) << 34)
            | (bit_cast::<53, 32>(self.data_2.q.val()) << 2);
        self.weights_marks.next = 0.into();
        if self.weights_2.q.val() {
            self.weights_marks.next = 1.into();
        } else if self.read_2.q.val() {
            self.weights_marks.next = 2.into();
        }
        self.weights_to_5.data.next = self.weights_word.val() | self.weights_marks.val();
        // What registers hold at first is nothing that was written.
        self.macc.write_enable.next = self.weights_to_5.delayed.val().get_bit(0) && !self.reset.val();
        self.macc.read_enable.next = self.weights_to_5.delayed.val().get_bit(1);
        self.macc.write_bank.next = self.weights_to_5.delayed.val().get_bits::<6>(47);
        self.macc.write_row.next = self.weights_to_5.delayed.val().get_bits::<12>(35);
        self.macc.write_half.next = self.weights_to_5.delayed.val().get_bit(34);
        self.macc.write_data.next = self.weights_to_5.delayed.val().get_bits::<32>(2);
        self.results.write_thresholds.next = self.thresholds_2.q.val() && !self.reset.val();
        self.results.write_previous.next = self.previous_2.q.val() && !self.reset.val();
        self.results.write_row.next = self.address_2.q.val().get_bits::<12>(1);
        self.results.write_data.next = self.data_2.q.val();
        self.registers.write_enable.next = self.registers_2.q.val();
        self.registers.write_row.next = self.address_2.q.val().get_bits::<12>(1);
        self.registers.write_data.next = self.data_2.q.val();
        self.counters.snapshot.next = self.snapshot_2.q.val();
        self.check.snapshot.next = self.snapshot_2.q.val();

        // Reads back.
        self.reader.starts.next = self.command_2.q.val();
        self.reader.command.next = self.data_2.q.val();
        self.reader.grant.next = self.reads.val();
        self.reader.weights.next = self.macc.read_data.val();
        self.results.read_wanted.next = self.reader.request_thresholds.val();
        self.results.read_row.next = self.reader.row.val();
        self.reader.thresholds_valid.next = self.results.read_valid.val();
        self.reader.thresholds.next = self.results.read_thresholds.val();
        self.reader.previous.next = self.results.read_previous.val();
        // Rows 0 and 1 shifts, 2 control, 4 and 5 what the check of frames shows.
        self.reader.register.next = bit_cast::<32, 20>(self.registers.shifts_0.val());
        if self.reader.row.val().get_bit(2) {
            self.reader.register.next = self.check.crc.val();
            if self.reader.row.val().get_bit(0) {
                self.reader.register.next = bit_cast::<32, 8>(self.check.frames.val());
            }
        } else if self.reader.row.val().get_bit(1) {
            self.reader.register.next = 0.into();
            if self.registers.skip_zeros.val() {
                self.reader.register.next = self.skip_bit.val();
            }
        } else if self.reader.row.val().get_bit(0) {
            self.reader.register.next = bit_cast::<32, 20>(self.registers.shifts_1.val());
        }
        self.reader.select.next = self.status_address.val().get_bits::<2>(0);
        self.counters.select.next = self.status_address.val().get_bits::<2>(0);
        self.read_word.next = self.counters.value.val();
        if self.status_address.val().get_bit(6) {
            self.read_word.next = self.reader.value.val();
        }
        self.status_q.d.next = 0.into();
        if self.status_address.val().get_bits::<4>(2) == self.id.val() {
            self.status_q.d.next = self.read_word.val();
        }
        self.status.next = self.status_q.q.val();
    }
}
