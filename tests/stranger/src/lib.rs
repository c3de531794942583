//! A UART of a stranger: eight bits, no parity, one stop bit, N cycles a bit. It knows nothing of this project but the packaged backend.

use edof_verilog::describe::{Circuit, kernel};
use rust_hdl::prelude::*;

/// What the line does.
#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
pub enum Line {
    Idle,
    Start,
    Data,
    Stop,
}

/// Sends bytes over a line, the lowest bit first.
#[derive(Circuit)]
pub struct Sender {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The line becomes idle.
    pub reset: Signal<In, Bit>,
    /// A byte is to be sent.
    pub valid: Signal<In, Bit>,
    /// The word is accepted in this cycle.
    pub ready: Signal<Out, Bit>,
    /// The byte.
    pub data: Signal<In, Bits<8>>,
    /// The line.
    pub line: Signal<Out, Bit>,
    last_cycle: Constant<Bits<8>>,
    state: DFF<Line>,
    cycle: DFF<Bits<8>>,
    count: DFF<Bits<3>>,
    shift: DFF<Bits<8>>,
    ends: Signal<Local, Bit>,
}

impl Sender {
    /// A sender with N cycles a bit, at most 256.
    #[must_use]
    pub fn new(cycles: u64) -> Self {
        Self::from_parts(SenderParts { last_cycle: Constant::new((cycles - 1).into()) })
    }
}

impl Logic for Sender {
    #[kernel]
    fn update(&mut self) {
        dff_setup!(self, clock, state, cycle, count, shift);
        self.ends.next = self.cycle.q.val() == self.last_cycle.val();
        self.ready.next = self.state.q.val() == Line::Idle;
        self.line.next = true;

        // A bit lasts its cycles.
        self.cycle.d.next = self.cycle.q.val() + 1;
        if self.ends.val() {
            self.cycle.d.next = 0.into();
        }
        match self.state.q.val() {
            Line::Idle => {
                self.cycle.d.next = 0.into();
                if self.valid.val() {
                    self.shift.d.next = self.data.val();
                    self.state.d.next = Line::Start;
                }
            }
            Line::Start => {
                self.line.next = false;
                if self.ends.val() {
                    self.count.d.next = 0.into();
                    self.state.d.next = Line::Data;
                }
            }
            Line::Data => {
                self.line.next = self.shift.q.val().get_bit(0);
                if self.ends.val() {
                    self.shift.d.next = self.shift.q.val() >> 1;
                    self.count.d.next = self.count.q.val() + 1;
                    if self.count.q.val() == 7 {
                        self.state.d.next = Line::Stop;
                    }
                }
            }
            Line::Stop => {
                if self.ends.val() {
                    self.state.d.next = Line::Idle;
                }
            }
        }
        if self.reset.val() {
            self.state.d.next = Line::Idle;
            self.cycle.d.next = 0.into();
            self.count.d.next = 0.into();
            self.shift.d.next = 0.into();
        }
    }
}

/// Receives bytes from a line, looking at the middle of each bit.
#[derive(Circuit)]
pub struct Receiver {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets the byte available.
    pub reset: Signal<In, Bit>,
    /// The line, of this clock.
    pub line: Signal<In, Bit>,
    /// A byte has come.
    pub valid: Signal<Out, Bit>,
    /// The byte.
    pub data: Signal<Out, Bits<8>>,
    last_cycle: Constant<Bits<8>>,
    half: Constant<Bits<8>>,
    state: DFF<Line>,
    cycle: DFF<Bits<8>>,
    count: DFF<Bits<3>>,
    shift: DFF<Bits<8>>,
    done: DFF<Bit>,
}

impl Receiver {
    /// A receiver with N cycles a bit, 4 to 256.
    #[must_use]
    pub fn new(cycles: u64) -> Self {
        let (last_cycle, half) = (Constant::new((cycles - 1).into()), Constant::new((cycles / 2).into()));
        Self::from_parts(ReceiverParts { last_cycle, half })
    }
}

impl Logic for Receiver {
    #[kernel]
    fn update(&mut self) {
        dff_setup!(self, clock, state, cycle, count, shift, done);
        self.valid.next = self.done.q.val();
        self.data.next = self.shift.q.val();
        self.done.d.next = false;
        self.cycle.d.next = self.cycle.q.val() + 1;
        match self.state.q.val() {
            Line::Idle => {
                self.cycle.d.next = 0.into();
                if !self.line.val() {
                    self.state.d.next = Line::Start;
                }
            }
            Line::Start => {
                if self.cycle.q.val() == self.half.val() {
                    self.cycle.d.next = 0.into();
                    self.count.d.next = 0.into();
                    self.state.d.next = Line::Data;
                }
            }
            Line::Data => {
                if self.cycle.q.val() == self.last_cycle.val() {
                    self.cycle.d.next = 0.into();
                    self.count.d.next = self.count.q.val() + 1;
                    self.shift.d.next = (self.shift.q.val() >> 1).replace_bit(7, self.line.val());
                    if self.count.q.val() == 7 {
                        self.state.d.next = Line::Stop;
                    }
                }
            }
            Line::Stop => {
                if self.cycle.q.val() == self.last_cycle.val() {
                    self.done.d.next = self.line.val();
                    self.state.d.next = Line::Idle;
                }
            }
        }
        if self.reset.val() {
            self.state.d.next = Line::Idle;
            self.cycle.d.next = 0.into();
            self.count.d.next = 0.into();
            self.shift.d.next = 0.into();
            self.done.d.next = false;
        }
    }
}

/// A sender and a receiver on one line.
#[derive(Circuit)]
pub struct Loopback {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Both start anew.
    pub reset: Signal<In, Bit>,
    /// A byte is to be sent.
    pub valid: Signal<In, Bit>,
    /// The word is accepted in this cycle.
    pub ready: Signal<Out, Bit>,
    /// The byte.
    pub data: Signal<In, Bits<8>>,
    /// A byte has come.
    pub came: Signal<Out, Bit>,
    /// The byte.
    pub received: Signal<Out, Bits<8>>,
    sender: Sender,
    receiver: Receiver,
}

impl Loopback {
    /// Both with N cycles a bit.
    #[must_use]
    pub fn new(cycles: u64) -> Self {
        Self::from_parts(LoopbackParts { sender: Sender::new(cycles), receiver: Receiver::new(cycles) })
    }
}

impl Logic for Loopback {
    #[kernel]
    fn update(&mut self) {
        self.sender.clock.next = self.clock.val();
        self.sender.reset.next = self.reset.val();
        self.sender.valid.next = self.valid.val();
        self.sender.data.next = self.data.val();
        self.ready.next = self.sender.ready.val();
        self.receiver.clock.next = self.clock.val();
        self.receiver.reset.next = self.reset.val();
        self.receiver.line.next = self.sender.line.val();
        self.came.next = self.receiver.valid.val();
        self.received.next = self.receiver.data.val();
    }
}
