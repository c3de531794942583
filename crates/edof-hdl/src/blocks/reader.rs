//! What reads a stage's memories back, and makes a CRC-32 of what it reads.

use super::Row;
use crate::describe::Circuit;
use edof_spec::design::memory::READ_PERIOD;
use rust_hdl::prelude::*;

/// Reads rows of a memory of the stage one after the other, each in 256 cycles, and makes a CRC-32 (of IEEE 802.3) of them: a row is 64
/// bits, the lowest first. A row of weights takes one step from the multipliers. The last row stays to be looked at.
#[derive(Circuit)]
pub struct Reader {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Stops.
    pub reset: Signal<In, Bit>,
    /// A command comes (`edof_spec::design::memory::read_command`).
    pub starts: Signal<In, Bit>,
    /// It: space (2 bits), bank (6), first row (12), rows after it (12).
    pub command: Signal<In, Bits<32>>,
    /// A row of weights is read: no step in this cycle.
    pub steal: Signal<Out, Bit>,
    /// Its bank.
    pub bank: Signal<Out, Bits<6>>,
    /// Row of weights or thresholds.
    pub row: Signal<Out, Row>,
    /// A row of weights on its way back; 0 where there is none.
    pub weights: Signal<In, Bits<64>>,
    /// Two thresholds are to be read when nothing else reads any.
    pub wants_thresholds: Signal<Out, Bit>,
    /// They are here.
    pub thresholds_valid: Signal<In, Bit>,
    /// They.
    pub thresholds: Signal<In, Bits<32>>,
    /// Those of the stage before.
    pub previous: Signal<In, Bits<32>>,
    /// The register of that row.
    pub register: Signal<In, Bits<20>>,
    /// The row that was read last.
    pub word: Signal<Out, Bits<64>>,
    /// CRC-32 of all rows.
    pub crc: Signal<Out, Bits<32>>,
    /// Whether it still reads.
    pub busy: Signal<Out, Bit>,
    polynomial: Constant<Bits<32>>,
    ones: Constant<Bits<32>>,
    top: Constant<Bits<64>>,
    on: DFF<Bit>,
    space: DFF<Bits<2>>,
    bank_q: DFF<Bits<6>>,
    row_q: DFF<Row>,
    left: DFF<Row>,
    cycle: DFF<Bits<8>>,
    clears: DFF<Bit>,
    steal_q: DFF<Bit>,
    collects: DFF<Bit>,
    shifts: DFF<Bit>,
    at_end: DFF<Bit>,
    word_q: DFF<Bits<64>>,
    crc_q: DFF<Bits<32>>,
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
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(
            self, clock, on, space, bank_q, row_q, left, cycle, clears, steal_q, collects, shifts, at_end,
            word_q, crc_q
        );

        // A row takes 256 cycles: it is asked for in the first, is here before the 192nd, and goes through the CRC in the last 64.
        self.clears.d.next = self.on.q.val() && !self.cycle.q.val().any();
        self.steal_q.d.next = self.on.q.val() && !self.cycle.q.val().any() && (self.space.q.val() == 0);
        self.collects.d.next = self.on.q.val() && (self.cycle.q.val().get_bits::<2>(6) != 3);
        self.shifts.d.next = self.on.q.val() && (self.cycle.q.val().get_bits::<2>(6) == 3);
        self.at_end.d.next = self.on.q.val() && (self.cycle.q.val() == 254);
        if self.on.q.val() {
            self.cycle.d.next = self.cycle.q.val() + 1;
        }
        if self.at_end.q.val() {
            self.row_q.d.next = self.row_q.q.val() + 1;
            self.left.d.next = self.left.q.val() - 1;
            if !self.left.q.val().any() {
                self.on.d.next = false;
            }
        }
        if self.starts.val() && !self.on.q.val() {
            self.on.d.next = true;
            self.cycle.d.next = 0.into();
            self.space.d.next = self.command.val().get_bits::<2>(30);
            self.bank_q.d.next = self.command.val().get_bits::<6>(24);
            self.row_q.d.next = self.command.val().get_bits::<12>(12);
            self.left.d.next = self.command.val().get_bits::<12>(0);
        }

        // What came is gathered by or; 64 turns later it is as it was.
        self.word_q.d.next = self.word_q.q.val() | self.weights.val();
        if self.thresholds_valid.val() && self.collects.q.val() && (self.space.q.val() == 1) {
            self.word_q.d.next = self.word_q.q.val() | bit_cast::<64, 32>(self.thresholds.val());
        } else if self.thresholds_valid.val() && self.collects.q.val() && (self.space.q.val() == 2) {
            self.word_q.d.next = self.word_q.q.val() | bit_cast::<64, 32>(self.previous.val());
        } else if self.collects.q.val() && (self.space.q.val() == 3) {
            self.word_q.d.next = bit_cast::<64, 20>(self.register.val());
        }
        if self.shifts.q.val() {
            self.word_q.d.next = self.word_q.q.val() >> 1;
            if self.word_q.q.val().get_bit(0) {
                self.word_q.d.next = (self.word_q.q.val() >> 1) | self.top.val();
            }
        }
        if self.clears.q.val() {
            self.word_q.d.next = 0.into();
        }
        if self.shifts.q.val() {
            self.crc_q.d.next = self.crc_q.q.val() >> 1;
            if self.crc_q.q.val().get_bit(0) != self.word_q.q.val().get_bit(0) {
                self.crc_q.d.next = (self.crc_q.q.val() >> 1) ^ self.polynomial.val();
            }
        }
        if self.starts.val() && !self.on.q.val() {
            self.crc_q.d.next = self.ones.val();
        }

        self.steal.next = self.steal_q.q.val();
        self.bank.next = self.bank_q.q.val();
        self.row.next = self.row_q.q.val();
        self.wants_thresholds.next =
            self.collects.q.val() && ((self.space.q.val() == 1) || (self.space.q.val() == 2));
        self.word.next = self.word_q.q.val();
        self.crc.next = !self.crc_q.q.val();
        self.busy.next = self.on.q.val() || self.shifts.q.val();

        if self.reset.val() {
            self.on.d.next = false;
        }
    }
}
