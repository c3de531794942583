//! Sets up the chips on an I2C bus and asks them how they are.

use super::i2c_master::I2cMaster;
use super::pace::Pace;
use crate::blocks::ram::{Ram, Shape};
use crate::describe::{Circuit, kernel};
use edof_device::i2c::{Entry, KINDS, depth};
use rust_hdl::prelude::*;

/// Attempts for a transfer, after which the set-up has failed.
const ATTEMPTS: u64 = 8;
/// Milliseconds between two attempts.
const PAUSE_MS: u64 = 1;
/// Milliseconds between two reads of a poll.
const POLL_MS: u64 = 10;
/// Milliseconds from a set-up that failed to the next.
const REST_MS: u64 = 1000;

/// What is done.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    /// Reads the entry: its word is valid two cycles after its address.
    Fetch,
    /// Looks at its kind.
    Decode,
    /// Does what needs no transfer.
    Execute,
    /// Begins a transfer.
    Begin,
    /// Waits for its end.
    Transfer,
    /// Judges it.
    Judge,
    /// Waits some milliseconds.
    Wait,
    /// Begins the host's transfer.
    HostBegin,
    /// Waits for its end.
    HostTransfer,
}

/// Runs a program (`edof_device::i2c`) on an I2C bus: set-up of its chips, then polling. Its slots are what it found out.
///
/// A transfer that fails is repeated, eight times with a pause of a millisecond; then the set-up has failed: `word` says where and why until
/// it has been done, all slots are 0, and it begins anew after a second. A rise of `restart` begins anew at once. Between two entries, and in
/// every millisecond of a wait, the host's access is carried out: a number in its bits 28 to 31 that was not there before, with the bit of this
/// bus in bit 25. The program's own transfers are at most 4.7 ms each ([`I2cMaster`]).
#[derive(Circuit)]
#[circuit(registers(clock, reset))]
pub struct ChipSetup {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Begins anew.
    pub reset: Signal<In, Bit>,
    /// A rising edge starts the set-up again.
    pub restart: Signal<In, Bit>,
    /// Slots 12 to 15: register `video_setup`.
    pub settings: Signal<In, Bits<32>>,
    /// Register `chip_access`.
    pub access: Signal<In, Bits<32>>,
    /// The clock line as it is, of no clock.
    pub scl: Signal<In, Bit>,
    /// The data line as it is, of no clock.
    pub sda: Signal<In, Bit>,
    /// Pulls the clock line down.
    pub scl_low: Signal<Out, Bit>,
    /// Pulls the data line down.
    pub sda_low: Signal<Out, Bit>,
    /// All is set up.
    pub done: Signal<Out, Bit>,
    /// The last set-up failed.
    pub failed: Signal<Out, Bit>,
    /// Registers `i2c_board`, `i2c_card`.
    pub word: Signal<Out, Bits<32>>,
    /// Slots 0 to 11.
    pub slots: [Signal<Out, Bits<32>>; 3],
    /// Register `chip_answer`.
    pub answer: Signal<Out, Bits<32>>,
    clock_hz: Constant<Bits<32>>,
    #[is(clock_hz / 1000 - 2)]
    millisecond: Constant<Bits<24>>,
    attempts: Constant<Bits<4>>,
    pause: Constant<Bits<16>>,
    poll: Constant<Bits<16>>,
    idle_ms: Constant<Bits<16>>,
    is_card: Constant<Bits<1>>,
    #[names(_kinds)]
    op: [Constant<Bits<4>>; 15],
    slot_mask: Constant<Bits<96>>,
    program: Ram<32>,
    master: I2cMaster,
    #[reset(Phase::Fetch)]
    phase: DFF<Phase>,
    #[reset(0)]
    settle_count: DFF<Bits<2>>,
    #[reset(0)]
    entry: DFF<Bits<10>>,
    // The entries around it, known before they are chosen from.
    next_entry: DFF<Bits<10>>,
    beyond: DFF<Bits<10>>,
    previous: DFF<Bits<10>>,
    instruction: DFF<Bits<32>>,
    // What it is, from the phase after its decoding on: no choice of the next entry begins with a comparison.
    is_read: DFF<Bit>,
    is_until: DFF<Bit>,
    is_if: DFF<Bit>,
    is_goto: DFF<Bit>,
    is_load: DFF<Bit>,
    is_store: DFF<Bit>,
    is_done: DFF<Bit>,
    is_index: DFF<Bit>,
    is_read_next: DFF<Bit>,
    is_more: DFF<Bit>,
    accumulator: DFF<Bits<8>>,
    index: DFF<Bits<8>>,
    #[reset(0)]
    try_count: DFF<Bits<8>>,
    spent: DFF<Bit>,
    matches: DFF<Bit>,
    has_more: DFF<Bit>,
    // Slots 0 to 11.
    file: DFF<Bits<96>>,
    loaded: DFF<Bits<8>>,
    #[reset(0)]
    attempt: DFF<Bits<4>>,
    #[reset(0)]
    retries: DFF<Bits<10>>,
    milliseconds: DFF<Bits<16>>,
    wait_cycle: DFF<Bits<24>>,
    tick: DFF<Bit>,
    stall: DFF<Bit>,
    advance: DFF<Bit>,
    #[reset(0)]
    device: DFF<Bits<7>>,
    cause: DFF<Bits<3>>,
    #[reset(false)]
    done_q: DFF<Bit>,
    #[reset(false)]
    failed_q: DFF<Bit>,
    failure: DFF<Bits<20>>,
    word_q: DFF<Bits<32>>,
    #[reset(true)]
    restart_q: DFF<Bit>,
    #[reset(false)]
    restart_pending: DFF<Bit>,
    #[reset(0)]
    sequence: DFF<Bits<4>>,
    #[reset(0)]
    access_q: DFF<Bits<32>>,
    access_pending: DFF<Bit>,
    #[reset(0)]
    answer_q: DFF<Bits<32>>,
    kind: Signal<Local, Bits<4>>,
    first: Signal<Local, Bits<8>>,
    second: Signal<Local, Bits<8>>,
    third: Signal<Local, Bits<8>>,
    slot_at: Signal<Local, Bits<7>>,
    slots_from: Signal<Local, Bits<128>>,
    store: Signal<Local, Bit>,
    store_value: Signal<Local, Bits<8>>,
    fail: Signal<Local, Bit>,
    fail_cause: Signal<Local, Bits<3>>,
    is_host_access: Signal<Local, Bit>,
    status_word: Signal<Local, Bits<32>>,
    _kinds: [&'static str; 15],
}

impl ChipSetup {
    /// At that pace. The image of the program is the file of that path; `is_card` is the value of the host's
    /// bit 25 that names this bus.
    #[must_use]
    pub fn new(pace: &Pace, program: &[Entry], image: &str, is_card: bool) -> Self {
        let words: Vec<u64> = program.iter().map(|entry| entry.action.word().into()).collect();
        // Block RAM: a memory that nobody writes is no LUT RAM to Yosys.
        let shape = Shape { image: Some(image.into()), ..Shape::block(depth(program)) };
        let constant = |value: u64| Constant::new(value.into());
        Self::from_parts(ChipSetupParts {
            clock_hz: Constant::new((1000 * u64::from(pace.millisecond)).into()),
            attempts: Constant::new((ATTEMPTS - 1).into()),
            pause: constant(PAUSE_MS),
            poll: constant(POLL_MS),
            idle_ms: constant(REST_MS),
            is_card: Constant::new(u64::from(is_card).into()),
            op: std::array::from_fn(|kind| Constant::new((kind as u64).into())),
            slot_mask: Constant::new(0xff.into()),
            program: Ram::new(shape, &words),
            master: I2cMaster::new(pace.i2c_quarter),
            _kinds: KINDS,
        })
    }
}

impl Logic for ChipSetup {
    #[kernel]
    fn update(&mut self) {
        self.program.clock.next = self.clock.val();
        self.program.read_address.next = bit_cast::<12, 10>(self.entry.q.val());
        self.program.write_enable.next = false;
        self.program.write_address.next = 0.into();
        self.program.write_data.next = 0.into();
        self.kind.next = self.instruction.q.val().get_bits::<4>(24);
        self.first.next = self.instruction.q.val().get_bits::<8>(16);
        self.second.next = self.instruction.q.val().get_bits::<8>(8);
        self.third.next = self.instruction.q.val().get_bits::<8>(0);

        self.is_read.d.next = self.kind.val() == self.op[4].val();
        self.is_until.d.next = self.kind.val() == self.op[5].val();
        self.is_if.d.next = self.kind.val() == self.op[6].val();
        self.is_goto.d.next = self.kind.val() == self.op[7].val();
        self.is_load.d.next = self.kind.val() == self.op[9].val();
        self.is_store.d.next = self.kind.val() == self.op[10].val();
        self.is_done.d.next = self.kind.val() == self.op[11].val();
        self.is_index.d.next = self.kind.val() == self.op[12].val();
        self.is_read_next.d.next = self.kind.val() == self.op[13].val();
        self.is_more.d.next = self.kind.val() == self.op[14].val();
        self.spent.d.next = self.try_count.q.val() == self.first.val();
        self.next_entry.d.next = self.entry.q.val() + 1;
        self.beyond.d.next = self.entry.q.val() + 2;
        self.previous.d.next = self.entry.q.val() - 1;

        // The bus: the program's transfer, or the host's.
        self.is_host_access.next =
            (self.phase.q.val() == Phase::HostBegin) || (self.phase.q.val() == Phase::HostTransfer);
        self.master.clock.next = self.clock.val();
        self.master.reset.next = self.reset.val();
        self.master.scl.next = self.scl.val();
        self.master.sda.next = self.sda.val();
        self.scl_low.next = self.master.scl_low.val();
        self.sda_low.next = self.master.sda_low.val();
        self.master.start.next =
            (self.phase.q.val() == Phase::Begin) || (self.phase.q.val() == Phase::HostBegin);
        self.master.device.next = self.instruction.q.val().get_bits::<7>(16);
        self.master.register.next = self.second.val();
        self.master.write_value.next = self.third.val();
        self.master.read.next =
            (self.kind.val() == self.op[4].val()) || (self.kind.val() == self.op[13].val());
        self.master.bare.next = self.kind.val() == self.op[1].val();
        if self.kind.val() == self.op[8].val() {
            self.master.write_value.next = self.loaded.q.val();
        }
        if self.kind.val() == self.op[13].val() {
            self.master.register.next = self.index.q.val();
        }
        if self.is_host_access.val() {
            self.master.device.next = self.access_q.q.val().get_bits::<7>(16);
            self.master.register.next = self.access_q.q.val().get_bits::<8>(8);
            self.master.write_value.next = self.access_q.q.val().get_bits::<8>(0);
            self.master.read.next = self.access_q.q.val().get_bit(23);
            self.master.bare.next = self.access_q.q.val().get_bit(24);
        }

        // What the host wants: a number that is new; that of another bus is only noted.
        if !self.is_host_access.val() {
            self.access_q.d.next = self.access.val();
        }
        self.access_pending.d.next = false;
        if self.access_q.q.val().get_bits::<4>(28) != self.sequence.q.val() {
            if self.access_q.q.val().get_bits::<1>(25) == self.is_card.val() {
                self.access_pending.d.next = true;
            } else {
                self.sequence.d.next = self.access_q.q.val().get_bits::<4>(28);
            }
        }
        self.restart_q.d.next = self.restart.val();
        if self.restart.val() && !self.restart_q.q.val() {
            self.restart_pending.d.next = true;
        }

        // Slots: the program's, and the host's settings after them.
        self.slot_at.next = bit_cast::<7, 4>(self.third.val().get_bits::<4>(0)) << 3;
        self.slots_from.next = ((bit_cast::<128, 32>(self.settings.val()) << 96)
            | bit_cast::<128, 96>(self.file.q.val()))
            >> self.slot_at.val();

        // A millisecond is over.
        self.tick.d.next = false;
        if self.tick.q.val() || (self.phase.q.val() != Phase::Wait) {
            self.wait_cycle.d.next = 0.into();
        } else {
            self.wait_cycle.d.next = self.wait_cycle.q.val() + 1;
            self.tick.d.next = self.wait_cycle.q.val() == self.millisecond.val();
        }

        self.store.next = false;
        self.store_value.next = self.loaded.q.val();
        self.fail.next = false;
        self.fail_cause.next = self.cause.q.val();
        match self.phase.q.val() {
            Phase::Fetch => {
                self.settle_count.d.next = self.settle_count.q.val() + 1;
                self.stall.d.next = false;
                if self.restart_pending.q.val() {
                    self.restart_pending.d.next = false;
                    self.settle_count.d.next = 0.into();
                    self.entry.d.next = 0.into();
                    self.attempt.d.next = 0.into();
                    self.try_count.d.next = 0.into();
                    self.done_q.d.next = false;
                } else if (self.settle_count.q.val() == 2) && self.access_pending.q.val() {
                    self.settle_count.d.next = 0.into();
                    self.phase.d.next = Phase::HostBegin;
                } else if self.settle_count.q.val() == 3 {
                    self.instruction.d.next = self.program.read_data.val();
                    self.phase.d.next = Phase::Decode;
                }
            }
            Phase::Decode => {
                self.loaded.d.next = self.slots_from.val().get_bits::<8>(0);
                self.matches.d.next = (self.accumulator.q.val() & self.second.val()) == self.third.val();
                self.has_more.d.next = self.index.q.val().any();
                self.milliseconds.d.next = self.instruction.q.val().get_bits::<16>(0);
                self.advance.d.next = true;
                self.phase.d.next = Phase::Execute;
                if (self.kind.val() == self.op[1].val())
                    || (self.kind.val() == self.op[2].val())
                    || (self.kind.val() == self.op[4].val())
                    || (self.kind.val() == self.op[8].val())
                    || (self.kind.val() == self.op[13].val())
                {
                    self.device.d.next = self.instruction.q.val().get_bits::<7>(16);
                    self.phase.d.next = Phase::Begin;
                } else if self.kind.val() == self.op[3].val() {
                    self.phase.d.next = Phase::Wait;
                }
            }
            Phase::Execute => {
                self.phase.d.next = Phase::Fetch;
                self.entry.d.next = self.next_entry.q.val();
                if self.is_until.q.val() {
                    self.try_count.d.next = 0.into();
                    if !self.matches.q.val() {
                        if self.spent.q.val() {
                            self.fail.next = true;
                            self.fail_cause.next = 5.into();
                        } else {
                            self.try_count.d.next = self.try_count.q.val() + 1;
                            self.entry.d.next = self.previous.q.val();
                            self.advance.d.next = false;
                            self.milliseconds.d.next = self.poll.val();
                            self.phase.d.next = Phase::Wait;
                        }
                    }
                } else if self.is_if.q.val() {
                    if !self.matches.q.val() {
                        self.entry.d.next = self.beyond.q.val();
                    }
                } else if self.is_goto.q.val() {
                    self.entry.d.next = self.instruction.q.val().get_bits::<10>(0);
                } else if self.is_load.q.val() {
                    self.accumulator.d.next = self.loaded.q.val();
                } else if self.is_store.q.val() {
                    self.store.next = true;
                    self.store_value.next = self.second.val();
                } else if self.is_done.q.val() {
                    self.done_q.d.next = true;
                    self.failed_q.d.next = false;
                } else if self.is_index.q.val() {
                    self.index.d.next = self.third.val();
                } else if self.is_more.q.val() {
                    if !self.has_more.q.val() {
                        self.entry.d.next = self.beyond.q.val();
                    }
                } else {
                    self.entry.d.next = self.entry.q.val();
                }
            }
            Phase::Begin => {
                self.phase.d.next = Phase::Transfer;
            }
            Phase::Transfer => {
                if self.master.done.val() {
                    self.cause.d.next = self.master.cause.val();
                    self.loaded.d.next = self.master.value.val();
                    self.phase.d.next = Phase::Judge;
                }
            }
            Phase::Judge => {
                self.attempt.d.next = 0.into();
                self.phase.d.next = Phase::Fetch;
                self.entry.d.next = self.next_entry.q.val();
                if self.is_read_next.q.val() {
                    // What nobody answers is 0.
                    self.index.d.next = self.index.q.val() + 1;
                    self.accumulator.d.next = 0.into();
                    if !self.cause.q.val().any() {
                        self.accumulator.d.next = self.loaded.q.val();
                    }
                } else if !self.cause.q.val().any() {
                    if self.is_read.q.val() {
                        self.accumulator.d.next = self.loaded.q.val();
                        self.store.next = true;
                    }
                } else if self.attempt.q.val() == self.attempts.val() {
                    self.fail.next = true;
                } else {
                    self.attempt.d.next = self.attempt.q.val() + 1;
                    self.retries.d.next = self.retries.q.val() + 1;
                    self.entry.d.next = self.entry.q.val();
                    self.milliseconds.d.next = self.pause.val();
                    self.advance.d.next = false;
                    self.phase.d.next = Phase::Wait;
                }
            }
            Phase::Wait => {
                if self.restart_pending.q.val() {
                    self.phase.d.next = Phase::Fetch;
                } else if self.tick.q.val() {
                    self.milliseconds.d.next = self.milliseconds.q.val() - 1;
                    if self.milliseconds.q.val() == 1 {
                        self.phase.d.next = Phase::Fetch;
                        if self.advance.q.val() {
                            self.entry.d.next = self.next_entry.q.val();
                        }
                    } else if self.access_pending.q.val() {
                        self.stall.d.next = true;
                        self.phase.d.next = Phase::HostBegin;
                    }
                }
            }
            Phase::HostBegin => {
                self.phase.d.next = Phase::HostTransfer;
            }
            Phase::HostTransfer => {
                if self.master.done.val() {
                    self.sequence.d.next = self.access_q.q.val().get_bits::<4>(28);
                    self.answer_q.d.next = bit_cast::<32, 8>(self.master.value.val())
                        | (bit_cast::<32, 3>(self.master.cause.val()) << 8)
                        | (bit_cast::<32, 4>(self.access_q.q.val().get_bits::<4>(28)) << 28);
                    self.phase.d.next = Phase::Fetch;
                    if self.stall.q.val() {
                        self.phase.d.next = Phase::Wait;
                    }
                }
            }
        }
        if self.store.val() {
            self.file.d.next = (self.file.q.val() & !(self.slot_mask.val() << self.slot_at.val()))
                | (bit_cast::<96, 8>(self.store_value.val()) << self.slot_at.val());
        }
        if self.fail.val() {
            self.failure.d.next = bit_cast::<20, 10>(self.entry.q.val())
                | (bit_cast::<20, 7>(self.device.q.val()) << 10)
                | (bit_cast::<20, 3>(self.fail_cause.val()) << 17);
            self.failed_q.d.next = true;
            self.done_q.d.next = false;
            self.entry.d.next = 0.into();
            self.attempt.d.next = 0.into();
            self.try_count.d.next = 0.into();
            self.milliseconds.d.next = self.idle_ms.val();
            self.advance.d.next = false;
            self.phase.d.next = Phase::Wait;
        }
        if self.fail.val() || self.restart_pending.q.val() || self.reset.val() {
            self.file.d.next = 0.into();
        }

        // What the host reads.
        self.status_word.next =
            bit_cast::<32, 10>(self.entry.q.val()) | (bit_cast::<32, 7>(self.device.q.val()) << 10);
        if self.failed_q.q.val() {
            self.status_word.next = bit_cast::<32, 20>(self.failure.q.val()) | 0x20_0000;
        }
        if self.done_q.q.val() {
            self.status_word.next = self.status_word.val() | 0x10_0000;
        }
        self.word_q.d.next = self.status_word.val() | (bit_cast::<32, 10>(self.retries.q.val()) << 22);
        self.word.next = self.word_q.q.val();
        self.done.next = self.done_q.q.val();
        self.failed.next = self.failed_q.q.val();
        self.answer.next = self.answer_q.q.val();
        self.slots[0].next = self.file.q.val().get_bits::<32>(0);
        self.slots[1].next = self.file.q.val().get_bits::<32>(32);
        self.slots[2].next = self.file.q.val().get_bits::<32>(64);
    }
}
