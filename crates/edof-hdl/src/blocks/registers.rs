//! What the host sets in a stage.

use super::Row;
use super::start::Start;
use crate::describe::{Circuit, kernel};
use edof_device::design::memory::{CONTROL_SKIP, Shifts};
use rust_hdl::prelude::*;

/// What the host sets in a stage: shifts of both sets (result 6 bits, base 6, code 4, linear path 4), and control.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct Registers {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Back to the values of the generated design; held for two cycles or more.
    pub reset: Signal<In, Bit>,
    /// Writes a register.
    pub write_enable: Signal<In, Bit>,
    /// Which: 0 and 1 are the shifts of each set, 2 is control.
    pub write_row: Signal<In, Row>,
    /// New value of the register.
    pub write_data: Signal<In, Bits<32>>,
    /// Shifts of set 0 (`edof_device::design::memory::Shifts::word`).
    pub shifts_0: Signal<Out, Bits<20>>,
    /// Shifts of set 1.
    pub shifts_1: Signal<Out, Bits<20>>,
    /// Whether zeros are left out.
    pub skip_zeros: Signal<Out, Bit>,
    start: Start<20>,
    start_skip: Constant<Bit>,
    #[reset(self.start.first.val())]
    shifts_0_q: DFF<Bits<20>>,
    #[reset(self.start.second.val())]
    shifts_1_q: DFF<Bits<20>>,
    #[reset(start_skip)]
    skip_q: DFF<Bit>,
}

impl Registers {
    /// Registers that start with these shifts, which the image holds, and this skip bit.
    #[must_use]
    pub fn new(image: String, shifts: [Shifts; 2], skip_zeros: bool) -> Self {
        Self::from_parts(RegistersParts {
            start: Start::new(image, shifts.map(|shifts| shifts.word().into())),
            start_skip: Constant::new(skip_zeros),
        })
    }

    /// Bit of the control register that leaves zeros out.
    pub const SKIP_BIT: usize = CONTROL_SKIP.trailing_zeros() as usize;
}

impl Logic for Registers {
    #[kernel]
    fn update(&mut self) {
        self.start.clock.next = self.clock.val();
        if self.write_enable.val() {
            if self.write_row.val() == 0 {
                self.shifts_0_q.d.next = self.write_data.val().get_bits::<20>(0);
            } else if self.write_row.val() == 1 {
                self.shifts_1_q.d.next = self.write_data.val().get_bits::<20>(0);
            } else if self.write_row.val() == 2 {
                self.skip_q.d.next = self.write_data.val().get_bit(0);
            }
        }
        self.shifts_0.next = self.shifts_0_q.q.val();
        self.shifts_1.next = self.shifts_1_q.q.val();
        self.skip_zeros.next = self.skip_q.q.val();
    }
}
