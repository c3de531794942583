//! One read or write on an I2C bus.

use crate::crossing::Sync;
use crate::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// Where a transfer is.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// There is none.
    Idle,
    /// Both lines must be high.
    Free,
    /// One of nine clocks that bring a chip out of step to its end.
    Clear,
    /// Data falls while the clock is high.
    Start,
    /// A bit, or the acknowledgement of a byte.
    Bit,
    /// Data rises while the clock is high.
    Stop,
    /// Hands over how it ended.
    Done,
}

/// The byte that is on the bus.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Byte {
    /// Device and write bit.
    ToWrite,
    /// Register.
    Register,
    /// Value to write.
    Value,
    /// Device and read bit.
    ToRead,
    /// Value that comes.
    Answer,
}

/// One transfer at a time on an I2C bus, 100 kHz: a write of a register, a read of one (with a repeated start), or the same without a register.
///
/// While `start` is high and `busy` low a transfer begins; its inputs must be stable while it is busy. `done` is high for the cycle in which
/// `cause` (the numbers of the registers `i2c_board` and `i2c_card`) and `value` are valid. Each acknowledgement and each bit that is let rise is checked. A data line that is low before a transfer is
/// freed by nine clocks and a stop; a line that stays low ends the transfer with its cause. Lines are driven low or left alone, and are left
/// alone when a transfer has ended, which takes at most 4.7 ms: 0.7 ms of clocks, 4 ms for which chips may hold the clock line.
#[derive(Circuit)]
#[circuit(default(Sync), registers(clock, reset))]
pub struct I2cMaster {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Lets the lines go.
    pub reset: Signal<In, Bit>,
    /// Begins a transfer.
    pub start: Signal<In, Bit>,
    /// Read, else write.
    pub read: Signal<In, Bit>,
    /// The device has no registers.
    pub bare: Signal<In, Bit>,
    /// 7-bit address.
    pub device: Signal<In, Bits<7>>,
    /// Register.
    pub register: Signal<In, Bits<8>>,
    /// Byte to write.
    pub write_value: Signal<In, Bits<8>>,
    /// The clock line as it is, of no clock.
    pub scl: Signal<In, Bit>,
    /// The data line as it is, of no clock.
    pub sda: Signal<In, Bit>,
    /// Pulls the clock line down.
    pub scl_low: Signal<Out, Bit>,
    /// Pulls the data line down.
    pub sda_low: Signal<Out, Bit>,
    /// A transfer is in flight.
    pub busy: Signal<Out, Bit>,
    /// The transfer ends in this cycle.
    pub done: Signal<Out, Bit>,
    /// How.
    pub cause: Signal<Out, Bits<3>>,
    /// Byte that was read.
    pub value: Signal<Out, Bits<8>>,
    clock_hz: Constant<Bits<32>>,
    #[is(clock_hz / 400_000 - 2)]
    quarter: Constant<Bits<16>>,
    /// Chips may hold the clock line down so long in one transfer, all together: 4 ms.
    #[is(clock_hz / 250)]
    hold: Constant<Bits<24>>,
    lines: Sync<2>,
    // Stands long before a bit needs it: what chooses a transfer is no part of the path to the phase.
    reads: DFF<Bit>,
    #[reset(Phase::Idle)]
    phase: DFF<Phase>,
    byte: DFF<Byte>,
    cycle: DFF<Bits<16>>,
    steps_q: DFF<Bit>,
    part: DFF<Bits<2>>,
    bit_number: DFF<Bits<4>>,
    shift: DFF<Bits<8>>,
    held_cycles: DFF<Bits<24>>,
    #[reset(false)]
    timed_out: DFF<Bit>,
    cleared: DFF<Bit>,
    is_clearing: DFF<Bit>,
    cause_q: DFF<Bits<3>>,
    #[reset(false)]
    scl_low_q: DFF<Bit>,
    #[reset(false)]
    sda_low_q: DFF<Bit>,
    levels: Signal<Local, Bits<2>>,
    held: Signal<Local, Bit>,
    is_reading: Signal<Local, Bit>,
    is_answer: Signal<Local, Bit>,
    sda_high: Signal<Local, Bit>,
}

impl I2cMaster {
    /// A master with the given cycles per quarter of a bit, at least 4.
    #[must_use]
    pub fn new(quarter: u32) -> Self {
        let clock_hz = 400_000 * u64::from(quarter.max(4));
        Self::from_parts(I2cMasterParts { clock_hz: Constant::new(clock_hz.into()) })
    }
}

impl Logic for I2cMaster {
    #[kernel]
    fn update(&mut self) {
        self.lines.clock.next = self.clock.val();
        self.reads.d.next = self.read.val();
        self.levels.next = 0.into();
        if self.scl.val() {
            self.levels.next = self.levels.val() | 1;
        }
        if self.sda.val() {
            self.levels.next = self.levels.val() | 2;
        }
        self.lines.from.next = self.levels.val();
        self.sda_high.next = self.lines.to.val().get_bit(1);
        self.is_reading.next = self.byte.q.val() == Byte::Answer;
        self.is_answer.next = self.bit_number.q.val() == 8;

        // A quarter of a bit is over, unless the clock line is held down by a chip.
        self.held.next = !self.scl_low_q.q.val() && !self.lines.to.val().get_bit(0);
        self.steps_q.d.next = false;
        if self.steps_q.q.val() {
            self.cycle.d.next = 0.into();
            self.part.d.next = self.part.q.val() + 1;
        } else if !self.held.val() {
            self.cycle.d.next = self.cycle.q.val() + 1;
            self.steps_q.d.next = self.cycle.q.val() == self.quarter.val();
        } else {
            self.held_cycles.d.next = self.held_cycles.q.val() + 1;
        }
        self.timed_out.d.next = self.held_cycles.q.val() == self.hold.val();

        match self.phase.q.val() {
            Phase::Idle => {
                self.cycle.d.next = 0.into();
                self.steps_q.d.next = false;
                self.part.d.next = 0.into();
                self.held_cycles.d.next = 0.into();
                self.bit_number.d.next = 0.into();
                self.cleared.d.next = false;
                self.is_clearing.d.next = false;
                self.cause_q.d.next = 0.into();
                self.byte.d.next = Byte::ToWrite;
                if self.read.val() && self.bare.val() {
                    self.byte.d.next = Byte::ToRead;
                }
                if self.start.val() {
                    self.phase.d.next = Phase::Free;
                }
            }
            Phase::Free => {
                // A whole bit's time with both lines let go.
                if self.steps_q.q.val() && (self.part.q.val() == 3) {
                    self.phase.d.next = Phase::Start;
                    if !self.sda_high.val() {
                        self.phase.d.next = Phase::Clear;
                        if self.cleared.q.val() {
                            self.cause_q.d.next = 3.into();
                            self.phase.d.next = Phase::Done;
                        }
                    }
                }
            }
            Phase::Clear => {
                // A chip in the midst of a byte sees ones, and at last none that acknowledges.
                if self.steps_q.q.val() {
                    if self.part.q.val() == 0 {
                        self.scl_low_q.d.next = true;
                    } else if self.part.q.val() == 2 {
                        self.scl_low_q.d.next = false;
                    } else if self.part.q.val() == 3 {
                        self.bit_number.d.next = self.bit_number.q.val() + 1;
                        if self.is_answer.val() {
                            self.bit_number.d.next = 0.into();
                            self.phase.d.next = Phase::Stop;
                            self.scl_low_q.d.next = true;
                            self.cleared.d.next = true;
                            self.is_clearing.d.next = true;
                        }
                    }
                }
            }
            Phase::Start => {
                // Data is let rise while the clock is low, the clock rises, data falls, the clock falls.
                if self.steps_q.q.val() {
                    if self.part.q.val() == 0 {
                        self.scl_low_q.d.next = false;
                    } else if self.part.q.val() == 1 {
                        self.sda_low_q.d.next = true;
                        if !self.sda_high.val() {
                            self.sda_low_q.d.next = false;
                            self.cause_q.d.next = 2.into();
                            self.phase.d.next = Phase::Done;
                        }
                    } else if self.part.q.val() == 2 {
                        self.scl_low_q.d.next = true;
                    } else {
                        self.shift.d.next = bit_cast::<8, 7>(self.device.val()) << 1;
                        if self.byte.q.val() == Byte::ToRead {
                            self.shift.d.next = (bit_cast::<8, 7>(self.device.val()) << 1) | 1;
                        }
                        self.phase.d.next = Phase::Bit;
                    }
                }
            }
            Phase::Bit => {
                // Clock low: data changes; then it is high for two quarters, and low again.
                if self.steps_q.q.val() {
                    if self.part.q.val() == 0 {
                        self.sda_low_q.d.next =
                            !self.shift.q.val().get_bit(7) && !self.is_answer.val() && !self.is_reading.val();
                    } else if self.part.q.val() == 1 {
                        self.scl_low_q.d.next = false;
                    } else if self.part.q.val() == 2 {
                        if self.is_answer.val() && !self.is_reading.val() {
                            if self.sda_high.val() {
                                self.cause_q.d.next = 1.into();
                            }
                        } else if (self.is_answer.val() || !self.is_reading.val())
                            && !self.sda_low_q.q.val()
                            && !self.sda_high.val()
                        {
                            self.cause_q.d.next = 2.into();
                        }
                        if !self.is_answer.val() {
                            self.shift.d.next = self.shift.q.val() << 1;
                            if self.sda_high.val() {
                                self.shift.d.next = (self.shift.q.val() << 1) | 1;
                            }
                        }
                    } else {
                        self.scl_low_q.d.next = true;
                        self.bit_number.d.next = self.bit_number.q.val() + 1;
                        if self.cause_q.q.val() == 2 {
                            // The bus is someone else's.
                            self.scl_low_q.d.next = false;
                            self.sda_low_q.d.next = false;
                            self.phase.d.next = Phase::Done;
                        } else if self.is_answer.val() {
                            self.bit_number.d.next = 0.into();
                            if self.cause_q.q.val().any() {
                                self.phase.d.next = Phase::Stop;
                            } else {
                                match self.byte.q.val() {
                                    Byte::ToWrite => {
                                        self.byte.d.next = Byte::Register;
                                        self.shift.d.next = self.register.val();
                                        if self.bare.val() {
                                            self.byte.d.next = Byte::Value;
                                            self.shift.d.next = self.write_value.val();
                                        }
                                    }
                                    Byte::Register => {
                                        self.byte.d.next = Byte::Value;
                                        self.shift.d.next = self.write_value.val();
                                        if self.reads.q.val() {
                                            self.byte.d.next = Byte::ToRead;
                                            self.phase.d.next = Phase::Start;
                                            self.sda_low_q.d.next = false;
                                        }
                                    }
                                    Byte::Value => {
                                        self.phase.d.next = Phase::Stop;
                                    }
                                    Byte::ToRead => {
                                        self.byte.d.next = Byte::Answer;
                                    }
                                    Byte::Answer => {
                                        self.phase.d.next = Phase::Stop;
                                    }
                                }
                            }
                        }
                    }
                }
            }
            Phase::Stop => {
                // Data low, clock rises, data rises and is high.
                if self.steps_q.q.val() {
                    if self.part.q.val() == 0 {
                        self.sda_low_q.d.next = true;
                    } else if self.part.q.val() == 1 {
                        self.scl_low_q.d.next = false;
                    } else if self.part.q.val() == 2 {
                        self.sda_low_q.d.next = false;
                    } else {
                        self.phase.d.next = Phase::Done;
                        if !self.sda_high.val() {
                            self.cause_q.d.next = 3.into();
                        } else if self.is_clearing.q.val() {
                            self.is_clearing.d.next = false;
                            self.phase.d.next = Phase::Free;
                        }
                    }
                }
            }
            Phase::Done => {
                self.phase.d.next = Phase::Idle;
            }
        }
        // A clock line that is held for too long is broken.
        if self.timed_out.q.val() && (self.phase.q.val() != Phase::Idle) {
            self.held_cycles.d.next = 0.into();
            self.timed_out.d.next = false;
            self.scl_low_q.d.next = false;
            self.sda_low_q.d.next = false;
            self.cause_q.d.next = 4.into();
            self.phase.d.next = Phase::Done;
        }

        self.scl_low.next = self.scl_low_q.q.val();
        self.sda_low.next = self.sda_low_q.q.val();
        self.busy.next = self.phase.q.val() != Phase::Idle;
        self.done.next = self.phase.q.val() == Phase::Done;
        self.cause.next = self.cause_q.q.val();
        self.value.next = self.shift.q.val();
    }
}
