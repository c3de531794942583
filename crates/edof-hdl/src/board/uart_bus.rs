//! A serial line as a master of registers.

use super::uart_receiver::UartReceiver;
use super::uart_sender::UartSender;
use crate::describe::{Circuit, kernel};
use crate::ports::AxiLiteMaster;
use rust_hdl::prelude::*;

/// Where a frame stands.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// Waits for a command.
    Command,
    /// Waits for the number of words.
    Length,
    /// Waits for the four bytes of the address.
    Address,
    /// Waits for the four bytes of a word to write.
    Data,
    /// Writes it.
    Write,
    /// Asks for a word.
    Ask,
    /// Waits for it.
    Read,
    /// Sends its four bytes.
    Send,
    /// Waits for a pause: the frame went on before its word was written.
    Skip,
}

/// A serial line as a master of registers, in the frames of LiteX's UARTBone.
///
/// A frame: command (1 write, 2 read, 3 and 4 the same at a fixed address), number of words, address of the first *word* (four bytes,
/// the most significant first), and for a write the words in the same order. A read is answered by its words; one that the
/// registers answer with an error reads 0. Faults are counted. A byte that is not a command is skipped. A frame that pauses
/// longer than the time-out is dropped, and the next byte is a command. If a frame continues before its word is written, the rest of the
/// frame is skipped, up to a pause of the time-out.
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct UartBus {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Gives up the frame.
    pub reset: Signal<In, Bit>,
    /// From the host, of no clock.
    pub receive: Signal<In, Bit>,
    /// To the host.
    pub transmit: Signal<Out, Bit>,
    /// The registers.
    pub bus: AxiLiteMaster,
    /// Frames that were given up.
    pub broken: Signal<Out, Bits<32>>,
    clock_hz: Constant<Bits<32>>,
    #[is(clock_hz / 10)]
    time_out: Constant<Bits<32>>,
    receiver: UartReceiver,
    sender: UartSender,
    #[reset(Phase::Command)]
    phase: DFF<Phase>,
    writes: DFF<Bit>,
    is_fixed: DFF<Bit>,
    remaining: DFF<Bits<8>>,
    address: DFF<Bits<32>>,
    word: DFF<Bits<32>>,
    byte_number: DFF<Bits<2>>,
    #[reset(0)]
    pause: DFF<Bits<32>>,
    #[reset(false)]
    address_valid: DFF<Bit>,
    #[reset(false)]
    word_valid: DFF<Bit>,
    is_late: DFF<Bit>,
    #[reset(0)]
    broken_q: DFF<Bits<32>>,
    has_byte: Signal<Local, Bit>,
    byte: Signal<Local, Bits<8>>,
    stall: Signal<Local, Bit>,
    abort: Signal<Local, Bit>,
    word_ends: Signal<Local, Bit>,
}

impl UartBus {
    /// A block for a line with the given cycles per bit; a frame is dropped after a pause of `time_out` cycles.
    #[must_use]
    pub fn new(cycles_per_bit: u16, time_out: u32) -> Self {
        Self::from_parts(UartBusParts {
            clock_hz: Constant::new((10 * u64::from(time_out)).into()),
            receiver: UartReceiver::new(cycles_per_bit),
            sender: UartSender::new(cycles_per_bit),
        })
    }
}

impl Logic for UartBus {
    #[kernel]
    fn update(&mut self) {
        self.receiver.clock.next = self.clock.val();
        self.receiver.reset.next = self.reset.val();
        self.receiver.line.next = self.receive.val();
        self.sender.clock.next = self.clock.val();
        self.sender.reset.next = self.reset.val();
        self.transmit.next = self.sender.line.val();
        self.has_byte.next = self.receiver.valid.val();
        self.byte.next = self.receiver.byte.val();

        self.stall.next = (self.phase.q.val() == Phase::Length)
            || (self.phase.q.val() == Phase::Address)
            || (self.phase.q.val() == Phase::Data)
            || (self.phase.q.val() == Phase::Skip);
        self.abort.next =
            self.stall.val() && !self.has_byte.val() && (self.pause.q.val() == self.time_out.val());
        self.pause.d.next = self.pause.q.val() + 1;
        if self.has_byte.val() || !self.stall.val() {
            self.pause.d.next = 0.into();
        }
        // A word is done: the next one, or the end of the frame.
        self.word_ends.next = false;
        self.sender.valid.next = false;
        match self.phase.q.val() {
            Phase::Command => {
                self.byte_number.d.next = 0.into();
                if self.has_byte.val() {
                    self.writes.d.next = self.byte.val().get_bit(0);
                    self.is_fixed.d.next = self.byte.val() > 2;
                    if (self.byte.val() > 0) && (self.byte.val() < 5) {
                        self.phase.d.next = Phase::Length;
                    } else {
                        self.broken_q.d.next = self.broken_q.q.val() + 1;
                    }
                }
            }
            Phase::Length => {
                if self.has_byte.val() {
                    self.remaining.d.next = self.byte.val();
                    self.phase.d.next = Phase::Address;
                }
            }
            Phase::Address => {
                if self.has_byte.val() {
                    self.address.d.next = (self.address.q.val() << 8) | bit_cast::<32, 8>(self.byte.val());
                    self.byte_number.d.next = self.byte_number.q.val() + 1;
                    if self.byte_number.q.val() == 3 {
                        self.phase.d.next = Phase::Ask;
                        if self.writes.q.val() {
                            self.phase.d.next = Phase::Data;
                        }
                        if self.remaining.q.val() == 0 {
                            self.phase.d.next = Phase::Command;
                        }
                    }
                }
            }
            Phase::Data => {
                if self.has_byte.val() {
                    self.word.d.next = (self.word.q.val() << 8) | bit_cast::<32, 8>(self.byte.val());
                    self.byte_number.d.next = self.byte_number.q.val() + 1;
                    if self.byte_number.q.val() == 3 {
                        self.phase.d.next = Phase::Write;
                        self.address_valid.d.next = true;
                        self.word_valid.d.next = true;
                        self.is_late.d.next = false;
                    }
                }
            }
            Phase::Write => {
                if self.bus.aw_ready.val() {
                    self.address_valid.d.next = false;
                }
                if self.bus.w_ready.val() {
                    self.word_valid.d.next = false;
                }
                self.is_late.d.next = self.is_late.q.val() || self.has_byte.val();
                self.word_ends.next = self.bus.b_valid.val();
            }
            Phase::Ask => {
                self.address_valid.d.next = true;
                if self.address_valid.q.val() && self.bus.ar_ready.val() {
                    self.address_valid.d.next = false;
                    self.phase.d.next = Phase::Read;
                }
            }
            Phase::Read => {
                if self.bus.r_valid.val() {
                    self.word.d.next = self.bus.r_data.val();
                    self.byte_number.d.next = 0.into();
                    self.phase.d.next = Phase::Send;
                }
            }
            Phase::Send => {
                self.sender.valid.next = true;
                if self.sender.ready.val() {
                    self.word.d.next = self.word.q.val() << 8;
                    self.byte_number.d.next = self.byte_number.q.val() + 1;
                    self.word_ends.next = self.byte_number.q.val() == 3;
                }
            }
            Phase::Skip => {}
        }
        if self.word_ends.val() {
            self.remaining.d.next = self.remaining.q.val() - 1;
            if !self.is_fixed.q.val() {
                self.address.d.next = self.address.q.val() + 1;
            }
            self.phase.d.next = Phase::Ask;
            if self.writes.q.val() {
                self.phase.d.next = Phase::Data;
            }
            if self.remaining.q.val() == 1 {
                self.phase.d.next = Phase::Command;
            } else if self.writes.q.val() && (self.is_late.q.val() || self.has_byte.val()) {
                self.phase.d.next = Phase::Skip;
                self.broken_q.d.next = self.broken_q.q.val() + 1;
            }
        }
        if self.abort.val() {
            self.phase.d.next = Phase::Command;
            if self.phase.q.val() != Phase::Skip {
                self.broken_q.d.next = self.broken_q.q.val() + 1;
            }
        }

        self.sender.byte.next = self.word.q.val().get_bits::<8>(24);
        self.bus.aw_addr.next = self.address.q.val() << 2;
        self.bus.aw_valid.next = self.address_valid.q.val() && (self.phase.q.val() == Phase::Write);
        self.bus.w_data.next = self.word.q.val();
        self.bus.w_strb.next = 15.into();
        self.bus.w_valid.next = self.word_valid.q.val() && (self.phase.q.val() == Phase::Write);
        self.bus.b_ready.next = self.phase.q.val() == Phase::Write;
        self.bus.ar_addr.next = self.address.q.val() << 2;
        self.bus.ar_valid.next = self.address_valid.q.val() && (self.phase.q.val() == Phase::Ask);
        self.bus.r_ready.next = self.phase.q.val() == Phase::Read;
        self.broken.next = self.broken_q.q.val();
    }
}
