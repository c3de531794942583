//! What the host sees of a stage.

use crate::describe::Circuit;
use rust_hdl::prelude::*;

/// What the host sees of a stage: non-zero words sent (0), saturated results (1), codes (2) and differences (3).
#[derive(Circuit)]
pub struct Counters {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Back to zero.
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
    /// Which counter to show: 0 non-zeros, 1 results, 2 codes, 3 differences.
    pub select: Signal<In, Bits<2>>,
    /// It.
    pub value: Signal<Out, Bits<32>>,
    nonzero_q: DFF<Bits<32>>,
    results_q: DFF<Bits<32>>,
    codes_q: DFF<Bits<32>>,
    differences_q: DFF<Bits<32>>,
}

impl Logic for Counters {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, nonzero_q, results_q, codes_q, differences_q);
        if self.enable.val() {
            self.nonzero_q.d.next = self.nonzero_q.q.val()
                + (bit_cast::<32, 1>(self.nonzero.val().get_bits::<1>(0))
                    + bit_cast::<32, 1>(self.nonzero.val().get_bits::<1>(1)));
            self.results_q.d.next = self.results_q.q.val()
                + (bit_cast::<32, 1>(self.results.val().get_bits::<1>(0))
                    + bit_cast::<32, 1>(self.results.val().get_bits::<1>(1)));
            self.codes_q.d.next = self.codes_q.q.val()
                + (bit_cast::<32, 1>(self.codes.val().get_bits::<1>(0))
                    + bit_cast::<32, 1>(self.codes.val().get_bits::<1>(1)));
            self.differences_q.d.next = self.differences_q.q.val()
                + (bit_cast::<32, 1>(self.differences.val().get_bits::<1>(0))
                    + bit_cast::<32, 1>(self.differences.val().get_bits::<1>(1)));
        }
        self.value.next = self.nonzero_q.q.val();
        if self.select.val() == 1 {
            self.value.next = self.results_q.q.val();
        } else if self.select.val() == 2 {
            self.value.next = self.codes_q.q.val();
        } else if self.select.val() == 3 {
            self.value.next = self.differences_q.q.val();
        }
        if self.reset.val() {
            self.nonzero_q.d.next = 0.into();
            self.results_q.d.next = 0.into();
            self.codes_q.d.next = 0.into();
            self.differences_q.d.next = 0.into();
        }
    }
}
