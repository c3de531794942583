//! Sets up the chips on an I2C bus.

use crate::blocks::ram::{Ram, Shape};
use crate::crossing::Sync;
use crate::describe::Circuit;
use edof_spec::i2c::{Entry, TABLE_DEPTH};
use rust_hdl::prelude::*;

/// Attempts for an entry, after which the set-up has failed.
const ATTEMPTS: u64 = 8;

/// What is done on the bus.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// Reads the entry: its word stands two cycles after its address.
    Fetch,
    /// Looks at it.
    Decode,
    /// Data falls while the clock is high.
    Start,
    /// A bit, or the answer to a byte.
    Bit,
    /// Data rises while the clock is high.
    Stop,
    /// Waits some milliseconds.
    Wait,
    /// All is done, or has failed.
    Rest,
}

/// Writes a table of registers to the chips on an I2C bus (`edof_spec::i2c`), as the only master.
///
/// A transfer that is not acknowledged is repeated, eight times with a pause of a millisecond; then the set-up has failed, and tells at
/// which entry. A rise of `restart` begins anew. A chip may hold the clock down for less than a millisecond; longer is a failure, too.
/// Lines are driven low or left alone.
#[derive(Circuit)]
#[circuit(default(Sync))]
pub struct I2cInit {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Begins anew.
    pub reset: Signal<In, Bit>,
    /// Its rise begins anew.
    pub restart: Signal<In, Bit>,
    /// The clock line as it is, of no clock.
    pub scl: Signal<In, Bit>,
    /// The data line as it is, of no clock.
    pub sda: Signal<In, Bit>,
    /// Pulls the clock line down.
    pub scl_low: Signal<Out, Bit>,
    /// Pulls the data line down.
    pub sda_low: Signal<Out, Bit>,
    /// The whole table is written.
    pub done: Signal<Out, Bit>,
    /// An entry could not be written.
    pub failed: Signal<Out, Bit>,
    /// The entry at which it is, or failed.
    pub entry: Signal<Out, Bits<8>>,
    /// The entry's device.
    pub device: Signal<Out, Bits<8>>,
    /// Attempts that were repeated.
    pub retries: Signal<Out, Bits<16>>,
    quarter: Constant<Bits<16>>,
    millisecond: Constant<Bits<24>>,
    attempts: Constant<Bits<4>>,
    table: Ram<32>,
    lines: Sync<2>,
    phase: DFF<Phase>,
    settles: DFF<Bits<2>>,
    entry_q: DFF<Bits<8>>,
    word: DFF<Bits<32>>,
    cycle: DFF<Bits<16>>,
    part: DFF<Bits<2>>,
    bit_number: DFF<Bits<4>>,
    bytes_left: DFF<Bits<2>>,
    shift: DFF<Bits<32>>,
    refused: DFF<Bit>,
    attempt: DFF<Bits<4>>,
    retries_q: DFF<Bits<16>>,
    milliseconds: DFF<Bits<8>>,
    wait_cycle: DFF<Bits<24>>,
    failed_q: DFF<Bit>,
    scl_low_q: DFF<Bit>,
    sda_low_q: DFF<Bit>,
    restart_q: DFF<Bit>,
    levels: Signal<Local, Bits<2>>,
    held: Signal<Local, Bit>,
    steps: Signal<Local, Bit>,
    kind: Signal<Local, Bits<2>>,
}

impl I2cInit {
    /// For a clock of so many kilohertz, the bus at 100 kHz. The table's image is the file of that path.
    #[must_use]
    pub fn new(kilohertz: u32, table: &[Entry], image: &str) -> Self {
        let words: Vec<u64> = table.iter().map(|entry| entry.action.word().into()).collect();
        // Block RAM: a memory that nobody writes is no LUT RAM to Yosys.
        let shape = Shape { image: Some(image.into()), ..Shape::block(TABLE_DEPTH) };
        Self::from_parts(I2cInitParts {
            quarter: Constant::new((u64::from(kilohertz) / 400).into()),
            millisecond: Constant::new((u64::from(kilohertz) - 1).into()),
            attempts: Constant::new((ATTEMPTS - 1).into()),
            table: Ram::new(shape, &words),
        })
    }
}

impl Logic for I2cInit {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(
            self,
            clock,
            phase,
            settles,
            entry_q,
            word,
            cycle,
            part,
            bit_number,
            bytes_left,
            shift,
            refused,
            attempt,
            retries_q,
            milliseconds,
            wait_cycle,
            failed_q,
            scl_low_q,
            sda_low_q,
            restart_q
        );
        self.table.clock.next = self.clock.val();
        self.table.read_address.next = bit_cast::<12, 8>(self.entry_q.q.val());
        self.table.write_enable.next = false;
        self.table.write_address.next = 0.into();
        self.table.write_data.next = 0.into();
        self.lines.clock.next = self.clock.val();
        self.levels.next = 0.into();
        if self.scl.val() {
            self.levels.next = self.levels.val() | 1;
        }
        if self.sda.val() {
            self.levels.next = self.levels.val() | 2;
        }
        self.lines.from.next = self.levels.val();

        // A quarter of a bit is over, unless the clock line is held down by someone else.
        self.held.next = !self.scl_low_q.q.val() && !self.lines.to.val().get_bit(0);
        self.steps.next = self.cycle.q.val() == self.quarter.val();
        if self.steps.val() {
            self.cycle.d.next = 0.into();
            self.part.d.next = self.part.q.val() + 1;
        } else if !self.held.val() {
            self.cycle.d.next = self.cycle.q.val() + 1;
        }

        self.kind.next = self.word.q.val().get_bits::<2>(24);
        match self.phase.q.val() {
            Phase::Fetch => {
                self.settles.d.next = self.settles.q.val() + 1;
                if self.settles.q.val() == 3 {
                    self.word.d.next = self.table.read_data.val();
                    self.phase.d.next = Phase::Decode;
                }
            }
            Phase::Decode => {
                self.cycle.d.next = 0.into();
                self.part.d.next = 0.into();
                self.refused.d.next = false;
                self.bit_number.d.next = 0.into();
                // Address with the write bit, register, value; without a register, address and value.
                self.shift.d.next = (bit_cast::<32, 7>(self.word.q.val().get_bits::<7>(16)) << 25)
                    | (bit_cast::<32, 16>(self.word.q.val().get_bits::<16>(0)) << 8);
                self.bytes_left.d.next = 2.into();
                self.milliseconds.d.next = self.word.q.val().get_bits::<8>(0);
                self.wait_cycle.d.next = 0.into();
                self.phase.d.next = Phase::Start;
                if self.kind.val() == 0 {
                    self.phase.d.next = Phase::Rest;
                } else if self.kind.val() == 1 {
                    self.bytes_left.d.next = 1.into();
                } else if self.kind.val() == 3 {
                    self.phase.d.next = Phase::Wait;
                }
            }
            Phase::Start => {
                // Both lines high, data falls, clock falls.
                if self.steps.val() {
                    if self.part.q.val() == 1 {
                        self.sda_low_q.d.next = true;
                    } else if self.part.q.val() == 2 {
                        self.scl_low_q.d.next = true;
                    } else if self.part.q.val() == 3 {
                        self.phase.d.next = Phase::Bit;
                    }
                }
            }
            Phase::Bit => {
                // Clock low: data changes; then it is high for two quarters, and low again. Bit 8 is the answer.
                if self.steps.val() {
                    if self.part.q.val() == 0 {
                        self.sda_low_q.d.next =
                            !self.shift.q.val().get_bit(31) && (self.bit_number.q.val() != 8);
                    } else if self.part.q.val() == 1 {
                        self.scl_low_q.d.next = false;
                    } else if self.part.q.val() == 2 {
                        if (self.bit_number.q.val() == 8) && self.lines.to.val().get_bit(1) {
                            self.refused.d.next = true;
                        }
                    } else {
                        self.scl_low_q.d.next = true;
                        self.bit_number.d.next = self.bit_number.q.val() + 1;
                        if self.bit_number.q.val() != 8 {
                            self.shift.d.next = self.shift.q.val() << 1;
                        } else {
                            self.bit_number.d.next = 0.into();
                            self.bytes_left.d.next = self.bytes_left.q.val() - 1;
                            if self.kind.val() == 1 {
                                self.shift.d.next = self.word.q.val() << 24;
                            }
                            if self.refused.q.val() || (self.bytes_left.q.val() == 0) {
                                self.phase.d.next = Phase::Stop;
                            }
                        }
                    }
                }
            }
            Phase::Stop => {
                // Data low, clock rises, data rises.
                if self.steps.val() {
                    if self.part.q.val() == 0 {
                        self.sda_low_q.d.next = true;
                    } else if self.part.q.val() == 1 {
                        self.scl_low_q.d.next = false;
                    } else if self.part.q.val() == 2 {
                        self.sda_low_q.d.next = false;
                    } else if !self.refused.q.val() {
                        self.attempt.d.next = 0.into();
                        self.entry_q.d.next = self.entry_q.q.val() + 1;
                        self.phase.d.next = Phase::Fetch;
                    } else if self.attempt.q.val() == self.attempts.val() {
                        self.failed_q.d.next = true;
                        self.phase.d.next = Phase::Rest;
                    } else {
                        self.attempt.d.next = self.attempt.q.val() + 1;
                        self.retries_q.d.next = self.retries_q.q.val() + 1;
                        self.milliseconds.d.next = 1.into();
                        self.phase.d.next = Phase::Wait;
                    }
                }
            }
            Phase::Wait => {
                self.wait_cycle.d.next = self.wait_cycle.q.val() + 1;
                if self.wait_cycle.q.val() == self.millisecond.val() {
                    self.wait_cycle.d.next = 0.into();
                    self.milliseconds.d.next = self.milliseconds.q.val() - 1;
                    if self.milliseconds.q.val() == 1 {
                        self.phase.d.next = Phase::Fetch;
                        if self.kind.val() == 3 {
                            self.entry_q.d.next = self.entry_q.q.val() + 1;
                        }
                    }
                }
            }
            Phase::Rest => {}
        }
        if self.phase.q.val() != Phase::Fetch {
            self.settles.d.next = 0.into();
        }
        // A clock line that someone holds down for a millisecond is broken.
        if (self.phase.q.val() == Phase::Start)
            || (self.phase.q.val() == Phase::Bit)
            || (self.phase.q.val() == Phase::Stop)
        {
            self.wait_cycle.d.next = 0.into();
            if self.held.val() {
                self.wait_cycle.d.next = self.wait_cycle.q.val() + 1;
                if self.wait_cycle.q.val() == self.millisecond.val() {
                    self.failed_q.d.next = true;
                    self.sda_low_q.d.next = false;
                    self.phase.d.next = Phase::Rest;
                }
            }
        }
        self.restart_q.d.next = self.restart.val();
        if self.reset.val()
            || (self.restart.val() && !self.restart_q.q.val() && (self.phase.q.val() == Phase::Rest))
        {
            self.phase.d.next = Phase::Fetch;
            self.entry_q.d.next = 0.into();
            self.attempt.d.next = 0.into();
            self.failed_q.d.next = false;
            self.scl_low_q.d.next = false;
            self.sda_low_q.d.next = false;
            self.settles.d.next = 0.into();
            self.cycle.d.next = 0.into();
        }
        if self.reset.val() {
            self.retries_q.d.next = 0.into();
        }

        self.scl_low.next = self.scl_low_q.q.val();
        self.sda_low.next = self.sda_low_q.q.val();
        self.done.next = (self.phase.q.val() == Phase::Rest) && !self.failed_q.q.val();
        self.failed.next = self.failed_q.q.val();
        self.entry.next = self.entry_q.q.val();
        self.device.next = self.word.q.val().get_bits::<8>(16);
        self.retries.next = self.retries_q.q.val();
    }
}
