//! A stage's memories, read back, and a CRC-32 of what is read.

use super::Row;
use super::delay::Delay;
use crate::describe::{Circuit, kernel};
use edof_device::design::timing::READ_PERIOD;
use rust_hdl::prelude::*;

/// Reads rows of a memory of the stage one after the other, each in 256 cycles, and makes a CRC-32 (of IEEE 802.3) of them: a row is 64
/// bits, the lowest first. The last row stays to be looked at. A row of weights is asked for until it is `taken`, which costs the
/// multipliers a step; thresholds until there is a pause in which they are not used; a register is there at once. A command ends the
/// one before, and begins 64 cycles later, when nothing of that is on its way any more.
#[derive(Circuit)]
#[circuit(default(Delay), registers(clock, reset))]
pub struct Reader {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Stops and forgets.
    pub reset: Signal<In, Bit>,
    /// A command comes (`edof_device::design::reading::read_command`).
    pub starts: Signal<In, Bit>,
    /// The command: space (2 bits), bank (6), first row (12), rows after it (12).
    pub command: Signal<In, Bits<32>>,
    /// A row of weights is requested.
    pub request_weights: Signal<Out, Bit>,
    /// The requested row of weights will be read.
    pub grant: Signal<In, Bit>,
    /// Bank of the requested row.
    pub bank: Signal<Out, Bits<6>>,
    /// Row of weights or thresholds, or register.
    pub row: Signal<Out, Row>,
    /// The requested row of weights; 0 in other cycles.
    pub weights: Signal<In, Bits<64>>,
    /// Two thresholds are requested.
    pub request_thresholds: Signal<Out, Bit>,
    /// The two thresholds are valid.
    pub thresholds_valid: Signal<In, Bit>,
    /// The two thresholds.
    pub thresholds: Signal<In, Bits<32>>,
    /// Thresholds of the stage before.
    pub previous: Signal<In, Bits<32>>,
    /// The register of that row.
    pub register: Signal<In, Bits<32>>,
    /// What to show: 0 CRC-32 of all rows, 1 and 2 the halves of the row that was read last, 3 whether it still reads.
    pub select: Signal<In, Bits<2>>,
    /// Word that `select` selects.
    pub value: Signal<Out, Bits<32>>,
    polynomial: Constant<Bits<32>>,
    ones: Constant<Bits<32>>,
    top: Constant<Bits<64>>,
    #[reset(false)]
    is_active: DFF<Bit>,
    fresh: DFF<Bit>,
    #[reset(false)]
    request: DFF<Bit>,
    space: DFF<Bits<2>>,
    bank_q: DFF<Bits<6>>,
    row_q: DFF<Row>,
    remaining: DFF<Row>,
    #[reset(0)]
    cycle: DFF<Bits<8>>,
    #[reset(false)]
    at_end: DFF<Bit>,
    clear_word: DFF<Bit>,
    clear_crc: DFF<Bit>,
    shifts: Delay<2, 1>,
    read_word: DFF<Bits<32>>,
    word: DFF<Bits<64>>,
    crc: DFF<Bits<32>>,
    advance: Signal<Local, Bit>,
    restart: Signal<Local, Bit>,
    rotated: Signal<Local, Bits<64>>,
    status_word: Signal<Local, Bits<32>>,
}

impl Reader {
    /// The reader of any stage.
    #[must_use]
    pub fn new() -> Self {
        const { assert!(READ_PERIOD == 256, "the counter goes round in 8 bits") };
        Self::from_parts(ReaderParts {
            polynomial: Constant::new(0xedb8_8320.into()),
            ones: Constant::new(0xffff_ffff.into()),
            top: Constant::new((1u64 << 63).into()),
        })
    }
}

impl Default for Reader {
    fn default() -> Self {
        Self::new()
    }
}

impl Logic for Reader {
    #[kernel]
    fn update(&mut self) {
        self.shifts.clock.next = self.clock.val();

        // A row is asked for in cycle 0, as long as it takes; it is here before the 192nd, and goes through the CRC in the last 64.
        self.advance.next = self.request.q.val()
            && (self.grant.val()
                || (self.thresholds_valid.val() && self.space.q.val().any())
                || (self.space.q.val() == 3));
        if self.is_active.q.val() && (!self.request.q.val() || self.advance.val()) {
            self.cycle.d.next = self.cycle.q.val() + 1;
        }
        self.at_end.d.next = self.is_active.q.val() && (self.cycle.q.val() == 254);
        self.shifts.data.next = 0.into();
        if self.is_active.q.val() && (self.cycle.q.val().get_bits::<2>(6) == 3) {
            self.shifts.data.next = 3.into();
        }
        self.restart.next = self.at_end.q.val() && (self.fresh.q.val() || self.remaining.q.val().any());
        if self.advance.val() {
            self.request.d.next = false;
        }
        if self.restart.val() {
            self.request.d.next = true;
        }
        if self.at_end.q.val() && !self.fresh.q.val() {
            self.row_q.d.next = self.row_q.q.val() + 1;
            self.remaining.d.next = self.remaining.q.val() - 1;
        }
        if self.at_end.q.val() {
            self.fresh.d.next = false;
            self.is_active.d.next = self.restart.val();
        }
        if self.starts.val() {
            self.is_active.d.next = true;
            self.fresh.d.next = true;
            self.request.d.next = false;
            self.at_end.d.next = false;
            self.cycle.d.next = 192.into();
            self.space.d.next = self.command.val().get_bits::<2>(30);
            self.bank_q.d.next = self.command.val().get_bits::<6>(24);
            self.row_q.d.next = self.command.val().get_bits::<12>(12);
            self.remaining.d.next = self.command.val().get_bits::<12>(0);
        }
        self.clear_word.d.next = self.restart.val() || self.reset.val();
        self.clear_crc.d.next = (self.at_end.q.val() && self.fresh.q.val()) || self.reset.val();

        // What comes is gathered by or; 64 turns later the row is as it was.
        self.read_word.d.next = 0.into();
        if self.advance.val() && (self.space.q.val() == 1) {
            self.read_word.d.next = self.thresholds.val();
        } else if self.advance.val() && (self.space.q.val() == 2) {
            self.read_word.d.next = self.previous.val();
        } else if self.advance.val() && (self.space.q.val() == 3) {
            self.read_word.d.next = self.register.val();
        }
        self.rotated.next = self.word.q.val() >> 1;
        if self.word.q.val().get_bit(0) {
            self.rotated.next = (self.word.q.val() >> 1) | self.top.val();
        }
        self.word.d.next =
            self.word.q.val() | self.weights.val() | bit_cast::<64, 32>(self.read_word.q.val());
        if self.shifts.delayed.val().get_bit(0) {
            self.word.d.next = self.rotated.val();
        }
        if self.clear_word.q.val() {
            self.word.d.next = 0.into();
        }
        if self.shifts.delayed.val().get_bit(1) {
            self.crc.d.next = self.crc.q.val() >> 1;
            if self.crc.q.val().get_bit(0) != self.word.q.val().get_bit(0) {
                self.crc.d.next = (self.crc.q.val() >> 1) ^ self.polynomial.val();
            }
        }
        if self.clear_crc.q.val() {
            self.crc.d.next = self.ones.val();
        }

        self.request_weights.next = self.request.q.val() && (self.space.q.val() == 0);
        self.request_thresholds.next =
            self.request.q.val() && ((self.space.q.val() == 1) || (self.space.q.val() == 2));
        self.bank.next = self.bank_q.q.val();
        self.row.next = self.row_q.q.val();
        self.status_word.next = !self.crc.q.val();
        if self.select.val() == 1 {
            self.status_word.next = self.word.q.val().get_bits::<32>(0);
        } else if self.select.val() == 2 {
            self.status_word.next = self.word.q.val().get_bits::<32>(32);
        } else if self.select.val() == 3 {
            self.status_word.next = 0.into();
            if self.is_active.q.val() {
                self.status_word.next = 1.into();
            }
        }
        self.value.next = self.status_word.val();
    }
}
