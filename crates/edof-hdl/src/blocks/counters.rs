//! What the host sees of a stage.

use super::delay::Delay;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Counts up to two events per cycle. `count` is the value at the last snapshot. Reset and snapshot pass through registers.
#[derive(Circuit)]
#[circuit(default, registers(clock))]
pub struct Counter {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Sets the count to zero.
    pub reset: Signal<In, Bit>,
    /// Events are counted in this cycle.
    pub enable: Signal<In, Bit>,
    /// Number of events in this cycle: the count of set bits.
    pub events: Signal<In, Bits<2>>,
    /// Copies the count to `count` and restarts from zero.
    pub snapshot: Signal<In, Bit>,
    /// Events between the last two snapshots; before the second snapshot, events since reset.
    pub count: Signal<Out, Bits<32>>,
    marks_q: Delay<4, 1>,
    increment: DFF<Bits<2>>,
    count_q: DFF<Bits<32>>,
    latched: DFF<Bits<32>>,
    marks: Signal<Local, Bits<4>>,
    base_count: Signal<Local, Bits<32>>,
}

impl Logic for Counter {
    #[kernel]
    fn update(&mut self) {
        // Bits 0 and 2 reset, 1 and 3 snapshot: a register for what counts, one for what is shown.
        self.marks_q.clock.next = self.clock.val();
        self.marks.next = (bit_cast::<4, 1>(self.snapshot.val().into()) << 3)
            | (bit_cast::<4, 1>(self.reset.val().into()) << 2)
            | (bit_cast::<4, 1>(self.snapshot.val().into()) << 1)
            | bit_cast::<4, 1>(self.reset.val().into());
        self.marks_q.data.next = self.marks.val();
        self.increment.d.next = 0.into();
        if self.enable.val() {
            self.increment.d.next = bit_cast::<2, 1>(self.events.val().get_bits::<1>(0))
                + bit_cast::<2, 1>(self.events.val().get_bits::<1>(1));
        }
        self.base_count.next = self.count_q.q.val();
        if self.marks_q.delayed.val().get_bit(1) {
            self.base_count.next = 0.into();
        }
        self.count_q.d.next = self.base_count.val() + bit_cast::<32, 2>(self.increment.q.val());
        if self.marks_q.delayed.val().get_bit(0) {
            self.count_q.d.next = 0.into();
        }
        if self.marks_q.delayed.val().get_bit(3) {
            self.latched.d.next = self.count_q.q.val();
        }
        if self.marks_q.delayed.val().get_bit(2) {
            self.latched.d.next = 0.into();
        }
        self.count.next = self.latched.q.val();
    }
}

/// What the host sees of a stage: non-zero words sent (0), saturated results (1), codes (2) and differences (3).
#[derive(Circuit)]
#[circuit(default)]
pub struct Counters {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Sets the count to zero.
    pub reset: Signal<In, Bit>,
    /// A beat enters the FIFO.
    pub enable: Signal<In, Bit>,
    /// Which of its two words are not zero.
    pub nonzero: Signal<In, Bits<2>>,
    /// Which results did not fit.
    pub results: Signal<In, Bits<2>>,
    /// Which thresholded codes did not fit.
    pub codes: Signal<In, Bits<2>>,
    /// Which differences did not fit.
    pub differences: Signal<In, Bits<2>>,
    /// Copies all counters to be shown and starts them anew.
    pub snapshot: Signal<In, Bit>,
    /// Which counter to show: 0 non-zeros, 1 results, 2 codes, 3 differences.
    pub select: Signal<In, Bits<2>>,
    /// Value of the selected counter.
    pub value: Signal<Out, Bits<32>>,
    count_nonzero: Counter,
    count_results: Counter,
    count_codes: Counter,
    count_differences: Counter,
}

impl Logic for Counters {
    #[kernel]
    fn update(&mut self) {
        self.count_nonzero.clock.next = self.clock.val();
        self.count_nonzero.reset.next = self.reset.val();
        self.count_nonzero.snapshot.next = self.snapshot.val();
        self.count_nonzero.enable.next = self.enable.val();
        self.count_nonzero.events.next = self.nonzero.val();
        self.count_results.clock.next = self.clock.val();
        self.count_results.reset.next = self.reset.val();
        self.count_results.snapshot.next = self.snapshot.val();
        self.count_results.enable.next = self.enable.val();
        self.count_results.events.next = self.results.val();
        self.count_codes.clock.next = self.clock.val();
        self.count_codes.reset.next = self.reset.val();
        self.count_codes.snapshot.next = self.snapshot.val();
        self.count_codes.enable.next = self.enable.val();
        self.count_codes.events.next = self.codes.val();
        self.count_differences.clock.next = self.clock.val();
        self.count_differences.reset.next = self.reset.val();
        self.count_differences.snapshot.next = self.snapshot.val();
        self.count_differences.enable.next = self.enable.val();
        self.count_differences.events.next = self.differences.val();
        self.value.next = self.count_nonzero.count.val();
        if self.select.val() == 1 {
            self.value.next = self.count_results.count.val();
        } else if self.select.val() == 2 {
            self.value.next = self.count_codes.count.val();
        } else if self.select.val() == 3 {
            self.value.next = self.count_differences.count.val();
        }
    }
}
