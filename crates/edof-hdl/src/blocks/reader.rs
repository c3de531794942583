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
#[circuit(default(Delay))]
pub struct Reader {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Stops and forgets.
    pub reset: Signal<In, Bit>,
    /// A command comes (`edof_device::design::reading::read_command`).
    pub starts: Signal<In, Bit>,
    /// It: space (2 bits), bank (6), first row (12), rows after it (12).
    pub command: Signal<In, Bits<32>>,
    /// A row of weights is asked for.
    pub wants_weights: Signal<Out, Bit>,
    /// It will be read.
    pub taken: Signal<In, Bit>,
    /// Its bank.
    pub bank: Signal<Out, Bits<6>>,
    /// Row of weights or thresholds, or register.
    pub row: Signal<Out, Row>,
    /// A row of weights is back; 0 where none is.
    pub weights: Signal<In, Bits<64>>,
    /// Two thresholds are asked for.
    pub wants_thresholds: Signal<Out, Bit>,
    /// They are here.
    pub thresholds_valid: Signal<In, Bit>,
    /// They.
    pub thresholds: Signal<In, Bits<32>>,
    /// Those of the stage before.
    pub previous: Signal<In, Bits<32>>,
    /// The register of that row.
    pub register: Signal<In, Bits<32>>,
    /// What to show: 0 CRC-32 of all rows, 1 and 2 the halves of the row that was read last, 3 whether it still reads.
    pub select: Signal<In, Bits<2>>,
    /// It.
    pub value: Signal<Out, Bits<32>>,
    polynomial: Constant<Bits<32>>,
    ones: Constant<Bits<32>>,
    top: Constant<Bits<64>>,
    on: DFF<Bit>,
    fresh: DFF<Bit>,
    request: DFF<Bit>,
    space: DFF<Bits<2>>,
    bank_q: DFF<Bits<6>>,
    row_q: DFF<Row>,
    remaining: DFF<Row>,
    cycle: DFF<Bits<8>>,
    at_end: DFF<Bit>,
    clears_word: DFF<Bit>,
    clears_crc: DFF<Bit>,
    shifts: Delay<2, 1>,
    came: DFF<Bits<32>>,
    word: DFF<Bits<64>>,
    crc: DFF<Bits<32>>,
    advance: Signal<Local, Bit>,
    again: Signal<Local, Bit>,
    turned: Signal<Local, Bits<64>>,
    shown: Signal<Local, Bits<32>>,
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
        dff_setup!(
            self,
            clock,
            on,
            fresh,
            request,
            space,
            bank_q,
            row_q,
            remaining,
            cycle,
            at_end,
            clears_word,
            clears_crc,
            came,
            word,
            crc
        );
        self.shifts.clock.next = self.clock.val();

        // A row is asked for in cycle 0, as long as it takes; it is here before the 192nd, and goes through the CRC in the last 64.
        self.advance.next = self.request.q.val()
            && (self.taken.val()
                || (self.thresholds_valid.val() && self.space.q.val().any())
                || (self.space.q.val() == 3));
        if self.on.q.val() && (!self.request.q.val() || self.advance.val()) {
            self.cycle.d.next = self.cycle.q.val() + 1;
        }
        self.at_end.d.next = self.on.q.val() && (self.cycle.q.val() == 254);
        self.shifts.now.next = 0.into();
        if self.on.q.val() && (self.cycle.q.val().get_bits::<2>(6) == 3) {
            self.shifts.now.next = 3.into();
        }
        self.again.next = self.at_end.q.val() && (self.fresh.q.val() || self.remaining.q.val().any());
        if self.advance.val() {
            self.request.d.next = false;
        }
        if self.again.val() {
            self.request.d.next = true;
        }
        if self.at_end.q.val() && !self.fresh.q.val() {
            self.row_q.d.next = self.row_q.q.val() + 1;
            self.remaining.d.next = self.remaining.q.val() - 1;
        }
        if self.at_end.q.val() {
            self.fresh.d.next = false;
            self.on.d.next = self.again.val();
        }
        if self.starts.val() {
            self.on.d.next = true;
            self.fresh.d.next = true;
            self.request.d.next = false;
            self.at_end.d.next = false;
            self.cycle.d.next = 192.into();
            self.space.d.next = self.command.val().get_bits::<2>(30);
            self.bank_q.d.next = self.command.val().get_bits::<6>(24);
            self.row_q.d.next = self.command.val().get_bits::<12>(12);
            self.remaining.d.next = self.command.val().get_bits::<12>(0);
        }
        self.clears_word.d.next = self.again.val() || self.reset.val();
        self.clears_crc.d.next = (self.at_end.q.val() && self.fresh.q.val()) || self.reset.val();

        // What comes is gathered by or; 64 turns later the row is as it was.
        self.came.d.next = 0.into();
        if self.advance.val() && (self.space.q.val() == 1) {
            self.came.d.next = self.thresholds.val();
        } else if self.advance.val() && (self.space.q.val() == 2) {
            self.came.d.next = self.previous.val();
        } else if self.advance.val() && (self.space.q.val() == 3) {
            self.came.d.next = self.register.val();
        }
        self.turned.next = self.word.q.val() >> 1;
        if self.word.q.val().get_bit(0) {
            self.turned.next = (self.word.q.val() >> 1) | self.top.val();
        }
        self.word.d.next = self.word.q.val() | self.weights.val() | bit_cast::<64, 32>(self.came.q.val());
        if self.shifts.later.val().get_bit(0) {
            self.word.d.next = self.turned.val();
        }
        if self.clears_word.q.val() {
            self.word.d.next = 0.into();
        }
        if self.shifts.later.val().get_bit(1) {
            self.crc.d.next = self.crc.q.val() >> 1;
            if self.crc.q.val().get_bit(0) != self.word.q.val().get_bit(0) {
                self.crc.d.next = (self.crc.q.val() >> 1) ^ self.polynomial.val();
            }
        }
        if self.clears_crc.q.val() {
            self.crc.d.next = self.ones.val();
        }

        self.wants_weights.next = self.request.q.val() && (self.space.q.val() == 0);
        self.wants_thresholds.next =
            self.request.q.val() && ((self.space.q.val() == 1) || (self.space.q.val() == 2));
        self.bank.next = self.bank_q.q.val();
        self.row.next = self.row_q.q.val();
        self.shown.next = !self.crc.q.val();
        if self.select.val() == 1 {
            self.shown.next = self.word.q.val().get_bits::<32>(0);
        } else if self.select.val() == 2 {
            self.shown.next = self.word.q.val().get_bits::<32>(32);
        } else if self.select.val() == 3 {
            self.shown.next = 0.into();
            if self.on.q.val() {
                self.shown.next = 1.into();
            }
        }
        self.value.next = self.shown.val();

        if self.reset.val() {
            self.on.d.next = false;
            self.request.d.next = false;
            self.at_end.d.next = false;
            self.cycle.d.next = 0.into();
        }
    }
}
