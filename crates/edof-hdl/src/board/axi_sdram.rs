//! A controller of an SDRAM behind an AXI4 port.

use crate::describe::{Circuit, kernel};
use crate::ports::{AxiReadSlave, AxiWriteSlave};
use crate::video::queue::Queue;
use rust_hdl::prelude::*;

/// Words that may follow into the queue after it has no more space: two bursts in flight, one chosen, one of the queue's own.
const SLACK: usize = 4;

/// Where the set-up is.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// The power rises.
    PowerUp,
    /// All rows are closed.
    Precharge,
    /// Eight refreshes.
    Refresh,
    /// The mode is loaded.
    Mode,
    /// Words are written and read.
    Run,
}

/// Times of a chip in nanoseconds, the longest of the makers' 256 Mbit chips (Micron MT48LC16M16A2-75; power-up as ISSI and Winbond want it).
#[derive(Debug, Clone, Copy)]
struct Times {
    power_up: u64,
    refresh_interval: u64,
    refresh: u64,
    precharge: u64,
    row_open: u64,
    write_recovery: u64,
}

const TIMES: Times = Times {
    power_up: 200_000,
    refresh_interval: 7_800,
    refresh: 66,
    precharge: 22,
    row_open: 44,
    write_recovery: 15,
};

/// An SDRAM of 256 Mbit (8192 rows of 512 columns of 16 bits in each of 4 banks) behind an AXI4 port of 128 bits: a burst of writes and one of reads at a
/// time, whose addresses grow by a word.
///
/// A word is a burst of eight columns, so that an open row takes or gives one every 8 cycles. A row is open until another one is needed or a refresh is
/// due. Bursts of both directions take turns. What was answered is read. Bytes that are not enabled are masked. Bits of an address above
/// the memory are ignored.
///
/// The chip's clock is this clock inverted, its chip select and clock enable are constant, its CAS latency is 3. The board has a register at each pin, so that a
/// decision reaches the chip two and a half cycles later; but none for `drive`, which is there a cycle before the first column.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct AxiSdram {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Sets the chip up anew; words may be lost.
    pub reset: Signal<In, Bit>,
    /// Writes.
    pub write: AxiWriteSlave<128, 16>,
    /// Reads.
    pub read: AxiReadSlave<128>,
    /// The chip is set up.
    pub ready: Signal<Out, Bit>,
    /// RAS#, CAS# and WE#.
    pub command: Signal<Out, Bits<3>>,
    /// Bank.
    pub bank: Signal<Out, Bits<2>>,
    /// Row, column or mode.
    pub address: Signal<Out, Bits<13>>,
    /// Masks of both bytes.
    pub mask: Signal<Out, Bits<2>>,
    /// Data to the chip.
    pub data_out: Signal<Out, Bits<16>>,
    /// The data lines are driven.
    pub drive: Signal<Out, Bit>,
    /// Data from the chip.
    pub data_in: Signal<In, Bits<16>>,
    cmd_mode: Constant<Bits<3>>,
    cmd_refresh: Constant<Bits<3>>,
    cmd_precharge: Constant<Bits<3>>,
    cmd_active: Constant<Bits<3>>,
    cmd_write: Constant<Bits<3>>,
    cmd_read: Constant<Bits<3>>,
    cmd_nop: Constant<Bits<3>>,
    // Cycles, less one, as counters count down to 0.
    power_up: Constant<Bits<16>>,
    refresh_interval: Constant<Bits<12>>,
    after_refresh: Constant<Bits<5>>,
    after_precharge: Constant<Bits<5>>,
    after_active: Constant<Bits<5>>,
    after_write: Constant<Bits<5>>,
    #[reset(Phase::PowerUp)]
    phase: DFF<Phase>,
    #[reset(0)]
    powered: DFF<Bits<16>>,
    refreshes: DFF<Bits<3>>,
    // Cycles until the next command: one that goes on as the last one did, and any other one.
    #[reset(0)]
    gap: DFF<Bits<5>>,
    #[reset(0)]
    quiet: DFF<Bits<5>>,
    until_refresh: DFF<Bits<12>>,
    #[reset(false)]
    due: DFF<Bit>,
    #[reset(false)]
    open: DFF<Bit>,
    open_row: DFF<Bits<15>>,
    last_is_write: DFF<Bit>,
    // A burst whose words are still to come, and one that is to be answered.
    #[reset(false)]
    is_writing: DFF<Bit>,
    #[reset(false)]
    answer: DFF<Bit>,
    write_id: DFF<Bits<1>>,
    write_place: DFF<Bits<21>>,
    // A burst whose words have not all left; words to ask the chip for, and words that follow the next one that leaves.
    #[reset(false)]
    is_reading: DFF<Bit>,
    read_id: DFF<Bits<1>>,
    read_place: DFF<Bits<21>>,
    #[reset(0)]
    to_ask: DFF<Bits<9>>,
    to_follow: DFF<Bits<8>>,
    // The word that is next, and, a cycle later, whether its row is open.
    #[reset(false)]
    chosen: DFF<Bit>,
    #[reset(false)]
    compared: DFF<Bit>,
    is_hit: DFF<Bit>,
    chosen_is_write: DFF<Bit>,
    chosen_place: DFF<Bits<21>>,
    // Whose burst goes first where both could.
    #[reset(false)]
    turn_of_writes: DFF<Bit>,
    // Columns that are still to be written, and columns that were read, the last one in the highest bits.
    #[reset(0)]
    columns_left: DFF<Bits<3>>,
    columns: DFF<Bits<112>>,
    masks: DFF<Bits<14>>,
    #[reset(0)]
    asked: DFF<Bits<13>>,
    came: DFF<Bits<128>>,
    #[reset(7)]
    command_q: DFF<Bits<3>>,
    bank_q: DFF<Bits<2>>,
    address_q: DFF<Bits<13>>,
    mask_q: DFF<Bits<2>>,
    data_q: DFF<Bits<16>>,
    #[reset(false)]
    is_driven: DFF<Bit>,
    #[reset(false)]
    drive_q: DFF<Bit>,
    queue: Queue<128>,
    can_write: Signal<Local, Bit>,
    can_read: Signal<Local, Bit>,
    write_is_next: Signal<Local, Bit>,
    may: Signal<Local, Bit>,
    may_change: Signal<Local, Bit>,
    access: Signal<Local, Bit>,
    writes: Signal<Local, Bit>,
    reads: Signal<Local, Bit>,
    drives: Signal<Local, Bit>,
    row: Signal<Local, Bits<15>>,
}

impl AxiSdram {
    /// A controller at a clock in kHz.
    ///
    /// # Panics
    /// A clock above 133 MHz, which the chips with a CAS latency of 3 do not all have.
    #[must_use]
    pub fn new(clock_khz: u64) -> Self {
        assert!(clock_khz <= 133_000, "{clock_khz} kHz: at most 133 MHz");
        let cycles = |ns: u64| (ns * clock_khz).div_ceil(1_000_000).max(2);
        let command = |code: u64| Constant::new(code.into());
        let count = |cycles: u64| Constant::new((cycles - 1).into());
        Self::from_parts(AxiSdramParts {
            cmd_mode: command(0),
            cmd_refresh: command(1),
            cmd_precharge: command(2),
            cmd_active: command(3),
            cmd_write: command(4),
            cmd_read: command(5),
            cmd_nop: command(7),
            power_up: Constant::new(cycles(TIMES.power_up).into()),
            refresh_interval: Constant::new((TIMES.refresh_interval * clock_khz / 1_000_000 - 1).into()),
            after_refresh: count(cycles(TIMES.refresh)),
            after_precharge: count(cycles(TIMES.precharge)),
            // So long that a row may be closed as soon as a command is legal.
            after_active: count(cycles(TIMES.row_open)),
            after_write: count(7 + cycles(TIMES.write_recovery)),
            queue: Queue::new(SLACK),
        })
    }
}

impl Logic for AxiSdram {
    #[kernel]
    fn update(&mut self) {
        // A column of the open row, where commands are legal.
        self.may.next = !self.gap.q.val().any();
        self.may_change.next = !self.quiet.q.val().any();
        self.access.next = (self.phase.q.val() == Phase::Run)
            && !self.due.q.val()
            && self.compared.q.val()
            && self.is_hit.q.val()
            && self.may.val()
            && (self.may_change.val() || (self.chosen_is_write.q.val() == self.last_is_write.q.val()));
        self.writes.next = self.access.val() && self.chosen_is_write.q.val();
        self.reads.next = self.access.val() && !self.chosen_is_write.q.val();

        // Writes: an address, its words as they reach the chip, the answer.
        self.write.aw_ready.next = !self.is_writing.q.val() && !self.answer.q.val();
        if self.write.aw_valid.val() && !self.is_writing.q.val() && !self.answer.q.val() {
            self.is_writing.d.next = true;
            self.write_id.d.next = self.write.aw_id.val();
            self.write_place.d.next = self.write.aw_addr.val().get_bits::<21>(4);
        }
        self.write.w_ready.next = self.writes.val();
        self.write.b_valid.next = self.answer.q.val();
        self.write.b_id.next = self.write_id.q.val();
        self.write.b_resp.next = 0.into();
        if self.answer.q.val() && self.write.b_ready.val() {
            self.answer.d.next = false;
        }

        // Reads: an address, then its words by way of the queue.
        self.read.ar_ready.next = !self.is_reading.q.val();
        if self.read.ar_valid.val() && !self.is_reading.q.val() {
            self.is_reading.d.next = true;
            self.read_id.d.next = self.read.ar_id.val();
            self.read_place.d.next = self.read.ar_addr.val().get_bits::<21>(4);
            self.to_ask.d.next = bit_cast::<9, 8>(self.read.ar_len.val()) + 1;
            self.to_follow.d.next = self.read.ar_len.val();
        }
        self.read.r_valid.next = self.queue.front_valid.val();
        self.read.r_id.next = self.read_id.q.val();
        self.read.r_data.next = self.queue.front_data.val();
        self.read.r_resp.next = 0.into();
        self.read.r_last.next = !self.to_follow.q.val().any();
        if self.queue.front_valid.val() && self.read.r_ready.val() {
            self.to_follow.d.next = self.to_follow.q.val() - 1;
            if !self.to_follow.q.val().any() {
                self.is_reading.d.next = false;
            }
        }

        // The word that is next.
        self.can_write.next = self.is_writing.q.val() && self.write.w_valid.val();
        self.can_read.next = self.to_ask.q.val().any() && self.queue.space.val();
        self.write_is_next.next =
            self.can_write.val() && (self.turn_of_writes.q.val() || !self.can_read.val());
        if !self.chosen.q.val() {
            self.chosen.d.next = self.can_write.val() || self.can_read.val();
            self.chosen_is_write.d.next = self.write_is_next.val();
            self.chosen_place.d.next = self.read_place.q.val();
            if self.write_is_next.val() {
                self.chosen_place.d.next = self.write_place.q.val();
            }
        }
        self.row.next = self.chosen_place.q.val().get_bits::<15>(6);
        self.compared.d.next = self.chosen.q.val();
        self.is_hit.d.next = self.open.q.val() && (self.row.val() == self.open_row.q.val());

        // When refreshes are due, and how long commands have to wait.
        self.until_refresh.d.next = self.until_refresh.q.val() - 1;
        if !self.until_refresh.q.val().any() {
            self.until_refresh.d.next = self.refresh_interval.val();
        }
        if self.gap.q.val().any() {
            self.gap.d.next = self.gap.q.val() - 1;
        }
        if self.quiet.q.val().any() {
            self.quiet.d.next = self.quiet.q.val() - 1;
        }

        // Commands.
        self.command_q.d.next = self.cmd_nop.val();
        self.bank_q.d.next = self.chosen_place.q.val().get_bits::<2>(6);
        self.address_q.d.next = bit_cast::<13, 6>(self.chosen_place.q.val().get_bits::<6>(0)) << 3;
        match self.phase.q.val() {
            Phase::PowerUp => {
                self.powered.d.next = self.powered.q.val() + 1;
                if self.powered.q.val() == self.power_up.val() {
                    self.phase.d.next = Phase::Precharge;
                }
            }
            Phase::Precharge => {
                self.command_q.d.next = self.cmd_precharge.val();
                self.address_q.d.next = 0x400.into();
                self.quiet.d.next = self.after_precharge.val();
                self.refreshes.d.next = 7.into();
                self.phase.d.next = Phase::Refresh;
            }
            Phase::Refresh => {
                if self.may_change.val() {
                    self.command_q.d.next = self.cmd_refresh.val();
                    self.quiet.d.next = self.after_refresh.val();
                    self.refreshes.d.next = self.refreshes.q.val() - 1;
                    if !self.refreshes.q.val().any() {
                        self.phase.d.next = Phase::Mode;
                    }
                }
            }
            Phase::Mode => {
                // Bursts of eight columns in their order, CAS latency 3.
                self.bank_q.d.next = 0.into();
                self.address_q.d.next = 0x33.into();
                self.until_refresh.d.next = self.refresh_interval.val();
                if self.may_change.val() {
                    self.command_q.d.next = self.cmd_mode.val();
                    self.quiet.d.next = 2.into();
                    self.phase.d.next = Phase::Run;
                }
            }
            Phase::Run => {
                if self.access.val() {
                    self.gap.d.next = 7.into();
                    self.last_is_write.d.next = self.chosen_is_write.q.val();
                    self.chosen.d.next = false;
                    self.compared.d.next = false;
                    if self.writes.val() {
                        self.command_q.d.next = self.cmd_write.val();
                        self.quiet.d.next = self.after_write.val();
                    } else {
                        // Until the chip's last column, and a cycle in which nobody drives the lines.
                        self.command_q.d.next = self.cmd_read.val();
                        self.quiet.d.next = 11.into();
                    }
                } else if self.may_change.val() {
                    if self.open.q.val()
                        && (self.due.q.val() || (self.compared.q.val() && !self.is_hit.q.val()))
                    {
                        self.command_q.d.next = self.cmd_precharge.val();
                        self.address_q.d.next = 0x400.into();
                        self.open.d.next = false;
                        self.quiet.d.next = self.after_precharge.val();
                    } else if self.due.q.val() {
                        self.command_q.d.next = self.cmd_refresh.val();
                        self.due.d.next = false;
                        self.quiet.d.next = self.after_refresh.val();
                    } else if self.compared.q.val() && !self.is_hit.q.val() {
                        self.command_q.d.next = self.cmd_active.val();
                        self.address_q.d.next = self.chosen_place.q.val().get_bits::<13>(8);
                        self.open.d.next = true;
                        self.open_row.d.next = self.row.val();
                        self.gap.d.next = self.after_active.val();
                        self.quiet.d.next = self.after_active.val();
                    }
                }
            }
        }
        if !self.until_refresh.q.val().any() {
            self.due.d.next = true;
        }

        // Columns to the chip.
        self.mask_q.d.next = 0.into();
        self.drives.next = self.writes.val() || self.columns_left.q.val().any();
        self.is_driven.d.next = self.drives.val();
        self.drive_q.d.next = self.drives.val() || self.is_driven.q.val();
        self.data_q.d.next = self.columns.q.val().get_bits::<16>(0);
        self.columns.d.next = self.columns.q.val() >> 16;
        self.masks.d.next = self.masks.q.val() >> 2;
        if self.columns_left.q.val().any() {
            self.columns_left.d.next = self.columns_left.q.val() - 1;
            self.mask_q.d.next = self.masks.q.val().get_bits::<2>(0);
        }
        if self.writes.val() {
            self.data_q.d.next = self.write.w_data.val().get_bits::<16>(0);
            self.mask_q.d.next = !self.write.w_strb.val().get_bits::<2>(0);
            self.columns.d.next = self.write.w_data.val().get_bits::<112>(16);
            self.masks.d.next = !self.write.w_strb.val().get_bits::<14>(2);
            self.columns_left.d.next = 7.into();
            self.write_place.d.next = self.write_place.q.val() + 1;
            if self.write.w_last.val() {
                self.is_writing.d.next = false;
                self.answer.d.next = true;
                self.turn_of_writes.d.next = false;
            }
        }

        // Columns from the chip.
        self.asked.d.next = self.asked.q.val() << 1;
        if self.reads.val() {
            self.asked.d.next = (self.asked.q.val() << 1) | 1;
            self.read_place.d.next = self.read_place.q.val() + 1;
            self.to_ask.d.next = self.to_ask.q.val() - 1;
            if self.to_ask.q.val() == 1 {
                self.turn_of_writes.d.next = true;
            }
        }
        self.came.d.next = (self.came.q.val() >> 16) | (bit_cast::<128, 16>(self.data_in.val()) << 112);

        self.queue.clock.next = self.clock.val();
        self.queue.reset.next = self.reset.val();
        self.queue.push.next = self.asked.q.val().get_bit(12);
        self.queue.data.next = self.came.q.val();
        self.queue.front_ready.next = self.read.r_ready.val();

        self.ready.next = self.phase.q.val() == Phase::Run;
        self.command.next = self.command_q.q.val();
        self.bank.next = self.bank_q.q.val();
        self.address.next = self.address_q.q.val();
        self.mask.next = self.mask_q.q.val();
        self.data_out.next = self.data_q.q.val();
        self.drive.next = self.drive_q.q.val();
    }
}
