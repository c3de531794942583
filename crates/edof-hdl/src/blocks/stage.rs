//! One stage of the calculator: I, M or F.

use super::counters::Counters;
use super::drain::Drain;
use super::fifo::Fifo;
use super::macc_array::MaccArray;
use super::pair_buffer::PairBuffer;
use super::registers::Registers;
use super::results::Results;
use super::sequencer::Sequencer;
use super::window_ring::WindowRing;
use super::{Pair, role};
use crate::describe::Circuit;
use edof_spec::FixedNetwork;
use edof_spec::design::memory::Shifts;
use edof_spec::design::{Design, StagePlan};
use rust_hdl::prelude::*;

/// One stage of the calculator, I, M or F: vectors in, vectors out, two elements a beat; docs/calculator.md has its cycles.
/// Pairs are multiplied as they come out of the pair buffer; sums are copied, drained, rounded, shrunk and sent on.
#[derive(Circuit)]
#[circuit(default(Counters), role(_role))]
pub struct Stage {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets every vector; held for 16 cycles or more.
    pub reset: Signal<In, Bit>,
    /// A beat stands on the input.
    pub valid: Signal<In, Bit>,
    /// It is taken in this cycle, if there is one.
    pub ready: Signal<Out, Bit>,
    /// Its two words.
    pub data: Signal<In, Pair>,
    /// Their base words (M).
    pub base: Signal<In, Pair>,
    /// Whether it is its vector's last.
    pub last: Signal<In, Bit>,
    /// The vector's set.
    pub set: Signal<In, Bit>,
    /// Two pixels stand on the window input (F with a linear path).
    pub window_valid: Signal<In, Bit>,
    /// They are taken in this cycle, if there are any.
    pub window_ready: Signal<Out, Bit>,
    /// They.
    pub window_data: Signal<In, Pair>,
    /// Whether they are their window's last.
    pub window_last: Signal<In, Bit>,
    /// A beat stands on the output.
    pub out_valid: Signal<Out, Bit>,
    /// The receiver takes it.
    pub out_ready: Signal<In, Bit>,
    /// Its two words.
    pub out_data: Signal<Out, Pair>,
    /// Their base words.
    pub out_base: Signal<Out, Pair>,
    /// Whether it is its vector's last.
    pub out_last: Signal<Out, Bit>,
    /// The vector's set.
    pub out_set: Signal<Out, Bit>,
    /// A word is to be written (`edof_spec::design::memory::address`).
    pub write_valid: Signal<In, Bit>,
    /// It can be, in this cycle.
    pub write_ready: Signal<Out, Bit>,
    /// Where.
    pub write_address: Signal<In, Bits<25>>,
    /// What.
    pub write_data: Signal<In, Bits<32>>,
    /// Stage and counter to show.
    pub status_address: Signal<In, Bits<6>>,
    /// The counter, 0 from all other stages.
    pub status: Signal<Out, Bits<32>>,
    id: Constant<Bits<4>>,
    two_rows: Constant<Bit>,
    pairs: PairBuffer,
    ring: Vec<WindowRing>,
    sequencer: Sequencer,
    macc: MaccArray,
    drain: Drain,
    results: Results,
    fifo: Fifo,
    registers: Registers,
    counters: Counters,
    accept: Signal<Local, Bit>,
    leaves: Signal<Local, Bit>,
    selected: Signal<Local, Bit>,
    blocked: Signal<Local, Bit>,
    shifts: Signal<Local, Bits<20>>,
    _linear: usize,
    _role: String,
}

impl Stage {
    /// Stage `stage` of a design. Set 0 and set 1 start with the weights, thresholds and shifts of these networks, which fit the design.
    #[must_use]
    pub fn new(design: &Design, stage: &StagePlan, sets: [&FixedNetwork; 2]) -> Self {
        let linear = usize::from(stage.linear > 0);
        let sums = design.accumulator_bits;
        Self::from_parts(StageParts {
            id: Constant::new((stage.index as u64).into()),
            two_rows: Constant::new(stage.rows == 2),
            pairs: PairBuffer::new(stage),
            ring: (0..linear).map(|_| WindowRing::new(stage)).collect(),
            sequencer: Sequencer::new(stage),
            macc: MaccArray::new(stage, sums, sets),
            drain: Drain::new(stage),
            results: Results::new(design, stage, sets),
            fifo: Fifo::new(stage.feeds_m),
            registers: Registers::new(sets.map(|n| Shifts::of(n, stage)), design.skip_zeros),
            _linear: linear,
            _role: role(stage),
        })
    }
}

impl Logic for Stage {
    #[hdl_gen]
    fn update(&mut self) {
        self.pairs.clock.next = self.clock.val();
        self.sequencer.clock.next = self.clock.val();
        self.macc.clock.next = self.clock.val();
        self.drain.clock.next = self.clock.val();
        self.results.clock.next = self.clock.val();
        self.fifo.clock.next = self.clock.val();
        self.registers.clock.next = self.clock.val();
        self.counters.clock.next = self.clock.val();
        self.pairs.reset.next = self.reset.val();
        self.sequencer.reset.next = self.reset.val();
        self.drain.reset.next = self.reset.val();
        self.results.reset.next = self.reset.val();
        self.fifo.reset.next = self.reset.val();
        self.registers.reset.next = self.reset.val();
        self.counters.reset.next = self.reset.val();

        // In: pairs, bases, windows.
        self.pairs.skip_zeros.next = self.registers.skip_zeros.val();
        self.pairs.valid.next = self.valid.val();
        self.pairs.even.next = self.data.val().get_bits::<16>(0);
        self.pairs.odd.next = self.data.val().get_bits::<16>(16);
        self.pairs.last.next = self.last.val();
        self.pairs.set.next = self.set.val();
        self.ready.next = self.pairs.ready.val();
        self.accept.next = self.valid.val() && self.pairs.ready.val();
        self.results.base_write.next = self.accept.val();
        self.results.base_words.next = self.base.val();
        self.window_ready.next = true;
        self.sequencer.pixels.next = 0.into();
        for i in 0..self._linear {
            self.ring[i].clock.next = self.clock.val();
            self.ring[i].reset.next = self.reset.val();
            self.ring[i].valid.next = self.window_valid.val();
            self.ring[i].pixels.next = self.window_data.val();
            self.ring[i].last.next = self.window_last.val();
            self.ring[i].read_pair.next = self.sequencer.read_pixel.val();
            self.ring[i].finished.next = self.sequencer.finished.val();
            self.sequencer.pixels.next = self.ring[i].read_pixels.val();
            self.window_ready.next = self.ring[i].ready.val();
        }

        // Multiply.
        self.sequencer.available.next = self.pairs.available.val();
        self.sequencer.count.next = self.pairs.count.val();
        self.sequencer.set.next = self.pairs.front_set.val();
        self.sequencer.may_start.next = self.drain.may_start.val();
        self.pairs.read_pair.next = self.sequencer.read_pair.val();
        self.pairs.finished.next = self.sequencer.finished.val();
        self.sequencer.even_pair.next = self.pairs.even_pair.val();
        self.sequencer.odd_pair.next = self.pairs.odd_pair.val();
        self.shifts.next = self.registers.shifts_0.val();
        if self.sequencer.shift_set.val() {
            self.shifts.next = self.registers.shifts_1.val();
        }
        self.sequencer.code_shift.next = self.shifts.val().get_bits::<4>(12);
        self.sequencer.linear_shift.next = self.shifts.val().get_bits::<4>(16);
        self.macc.first.next = self.sequencer.first.val();
        self.macc.address_a.next = self.sequencer.address_a.val();
        self.macc.value_a.next = self.sequencer.value_a.val();
        self.macc.address_b.next = self.sequencer.address_b.val();
        self.macc.value_b.next = self.sequencer.value_b.val();

        // Drain.
        self.drain.pass_issued.next = self.sequencer.pass_issued.val();
        self.drain.set.next = self.pairs.front_set.val();
        self.macc.copy.next = self.drain.copy.val();
        self.macc.shift.next = self.drain.take.val();
        self.results.take.next = self.drain.take.val();
        self.results.beat.next = self.drain.beat.val();
        self.results.last.next = self.drain.last.val();
        self.results.set.next = self.drain.taken_set.val();
        self.results.sum_even.next = self.macc.drain_even.val();
        self.results.sum_odd.next = self.macc.drain_odd.val();
        self.results.shifts_0.next = self.registers.shifts_0.val();
        self.results.shifts_1.next = self.registers.shifts_1.val();

        // Out.
        self.fifo.push.next = self.results.push.val();
        self.fifo.data.next = self.results.data.val();
        self.fifo.base.next = self.results.base.val();
        self.fifo.last.next = self.results.done_last.val();
        self.fifo.set.next = self.results.done_set.val();
        self.fifo.front_ready.next = self.out_ready.val();
        self.leaves.next = self.fifo.front_valid.val() && self.out_ready.val();
        self.drain.returned.next = self.leaves.val();
        self.out_valid.next = self.fifo.front_valid.val();
        self.out_data.next = self.fifo.front_data.val();
        self.out_base.next = self.fifo.front_base.val();
        self.out_last.next = self.fifo.front_last.val();
        self.out_set.next = self.fifo.front_set.val();
        self.counters.enable.next = self.results.push.val();
        self.counters.nonzero.next = self.results.nonzero.val();
        self.counters.results.next = self.results.result_saturated.val();
        self.counters.codes.next = self.results.code_saturated.val();
        self.counters.differences.next = self.results.difference_saturated.val();

        // The host: weights wait for a cycle in which none are read where both ports of their memory read.
        self.selected.next =
            self.write_valid.val() && (self.write_address.val().get_bits::<4>(21) == self.id.val());
        self.blocked.next = self.two_rows.val()
            && self.sequencer.busy.val()
            && (self.write_address.val().get_bits::<2>(19) == 0);
        self.write_ready.next = !(self.selected.val() && self.blocked.val());
        self.macc.write_enable.next =
            self.selected.val() && !self.blocked.val() && (self.write_address.val().get_bits::<2>(19) == 0);
        self.macc.write_bank.next = self.write_address.val().get_bits::<6>(13);
        self.macc.write_half.next = self.write_address.val().get_bit(0);
        self.macc.write_row.next = self.write_address.val().get_bits::<12>(1);
        self.macc.write_data.next = self.write_data.val();
        self.results.write_thresholds.next =
            self.selected.val() && (self.write_address.val().get_bits::<2>(19) == 1);
        self.results.write_previous.next =
            self.selected.val() && (self.write_address.val().get_bits::<2>(19) == 2);
        self.results.write_row.next = self.write_address.val().get_bits::<12>(1);
        self.results.write_data.next = self.write_data.val();
        self.registers.write_enable.next =
            self.selected.val() && (self.write_address.val().get_bits::<2>(19) == 3);
        self.registers.write_row.next = self.write_address.val().get_bits::<12>(1);
        self.registers.write_data.next = self.write_data.val();
        self.counters.select.next = self.status_address.val().get_bits::<2>(0);
        self.status.next = 0.into();
        if self.status_address.val().get_bits::<4>(2) == self.id.val() {
            self.status.next = self.counters.value.val();
        }
    }
}
