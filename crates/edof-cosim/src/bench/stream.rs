//! AXI4-Stream beside a block: who sends beats into it, and who takes its beats.

use super::{Actor, ClockId, StabilityCheck, Throttle};
use crate::verilator::Model;
use crate::{Error, Source};
use std::collections::VecDeque;

/// One beat. Streams wider than 64 bits are for other benches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Beat {
    /// The word.
    pub data: u64,
    /// First of a frame.
    pub user: bool,
    /// Last of a line, window or patch.
    pub last: bool,
}

impl Beat {
    /// A line of words, its last one marked; `first` marks its first one as the first of a frame.
    pub fn line(words: impl IntoIterator<Item = u64>, first: bool) -> Vec<Self> {
        let word = |(i, data)| Self { data, user: first && i == 0, last: false };
        let mut beats: Vec<Self> = words.into_iter().enumerate().map(word).collect();
        if let Some(beat) = beats.last_mut() {
            beat.last = true;
        }
        beats
    }
}

struct Ports {
    name: String,
    valid: usize,
    ready: usize,
    data: usize,
    user: usize,
    last: usize,
    reset: usize,
}

impl Ports {
    fn of(source: &Source, name: &str, reset: &str) -> Result<Self, Error> {
        let port = |signal| source.signal(name, signal);
        Ok(Self {
            name: name.into(),
            valid: port("valid")?,
            ready: port("ready")?,
            data: port("data")?,
            user: port("user")?,
            last: port("last")?,
            reset: source.port(reset)?,
        })
    }
}

/// Sends beats into a block, in order.
pub struct Sender {
    clock: ClockId,
    ports: Ports,
    pace: Throttle,
    offers: bool,
    /// Beats that were not taken yet.
    pub beats: VecDeque<Beat>,
    /// Beats that were.
    pub sent: usize,
}

impl Sender {
    /// For the stream of that name; while the port `reset` is high nothing is offered.
    ///
    /// # Errors
    /// There are no such ports.
    pub fn new(
        source: &Source,
        name: &str,
        clock: ClockId,
        reset: &str,
        pace: Throttle,
    ) -> Result<Self, Error> {
        let ports = Ports::of(source, name, reset)?;
        Ok(Self { clock, ports, pace, offers: false, beats: VecDeque::new(), sent: 0 })
    }
}

impl Actor for Sender {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        if model.peek(self.ports.reset)? == 1 {
            self.offers = false;
        } else if self.offers && model.peek(self.ports.ready)? == 1 {
            self.offers = false;
            self.beats.pop_front();
            self.sent += 1;
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let resets = model.peek(self.ports.reset)? == 1;
        self.offers = !resets && !self.beats.is_empty() && (self.offers || self.pace.goes());
        // A beat that nobody offers means nothing, and is something else.
        let nothing = Beat { data: u64::MAX ^ self.sent as u64, user: true, last: true };
        let beat = self.beats.front().filter(|_| self.offers).copied().unwrap_or(nothing);
        model.poke(self.ports.valid, self.offers.into())?;
        model.poke(self.ports.data, beat.data)?;
        model.poke(self.ports.user, beat.user.into())?;
        model.poke(self.ports.last, beat.last.into())
    }
}

/// Takes the beats of a block, and sees that the stream keeps its rules.
pub struct Receiver {
    clock: ClockId,
    ports: Ports,
    /// When it takes.
    pub pace: Throttle,
    standing: StabilityCheck,
    resets: bool,
    /// Beats that were taken.
    pub beats: Vec<Beat>,
}

impl Receiver {
    /// For the stream of that name; the port `reset` ends all offers.
    ///
    /// # Errors
    /// There are no such ports.
    pub fn new(
        source: &Source,
        name: &str,
        clock: ClockId,
        reset: &str,
        pace: Throttle,
    ) -> Result<Self, Error> {
        let ports = Ports::of(source, name, reset)?;
        Ok(Self { clock, ports, pace, standing: StabilityCheck::default(), resets: false, beats: vec![] })
    }
}

impl Actor for Receiver {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let offered = model.peek(self.ports.valid)? == 1;
        if model.peek(self.ports.reset)? == 1 {
            self.standing.forget();
            // In the first cycle of a reset the block does not know of it.
            let late = self.resets && offered;
            self.resets = true;
            return if late {
                Err(super::rule_broken(model, &self.ports.name, "offers during reset"))
            } else {
                Ok(())
            };
        }
        self.resets = false;
        let taken = offered && model.peek(self.ports.ready)? == 1;
        let data = model.peek(self.ports.data)?;
        let [user, last] = [model.peek(self.ports.user)? == 1, model.peek(self.ports.last)? == 1];
        let now = [data as u32, (data >> 32) as u32, user.into(), last.into()];
        self.standing.check(model, &self.ports.name, offered.then_some(&now[..]), taken)?;
        if taken {
            self.beats.push(Beat { data, user, last });
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let goes = self.pace.goes();
        model.poke(self.ports.ready, goes.into())
    }
}
