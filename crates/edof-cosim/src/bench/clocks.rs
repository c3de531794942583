//! Independent clocks with random phase, drift and jitter.

use super::Actor;
use crate::Error;
use crate::verilator::Model;
use edof_core::draw::Draw;

/// A clock of a [`Bench`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClockId(usize);

/// Largest deviation of a period from its nominal value, in millionths: two crystals of 100 ppm each, and room.
const DRIFT_PPM: i64 = 300;
/// Largest deviation of an edge from its place, as a fraction of the period.
const JITTER: i64 = 50;

struct Clock {
    port: usize,
    /// Femtoseconds.
    period: i64,
    drift_ppm: i64,
    /// The period now.
    now: i64,
    /// The clock that it is a fraction of, which fraction, and what division has left over so far: without that the phase would run away.
    of: Option<(usize, i64)>,
    rest: i64,
    /// Where the next edge belongs, and where it is.
    place: i64,
    next: i64,
    runs: bool,
}

/// A model whose clocks rise one by one, and sometimes together.
pub struct Bench {
    model: Model,
    clocks: Vec<Clock>,
    draw: Draw,
    now: i64,
}

impl Bench {
    /// A model without clocks yet; the seed decides drift, jitter and phases.
    #[must_use]
    pub const fn new(model: Model, seed: u64) -> Self {
        Self { model, clocks: vec![], draw: Draw::new(seed), now: 0 }
    }

    /// Adds the clock of a port, with a period in picoseconds. It starts at a random phase.
    ///
    /// # Errors
    /// There is no such port.
    pub fn clock(&mut self, port: &str, period_ps: u64) -> Result<ClockId, Error> {
        let port = self.model.library().source().port(port)?;
        let period = 1000 * period_ps as i64;
        let place = self.now + self.draw.whole(1, period);
        let (now, of, rest) = (period, None, 0);
        self.clocks.push(Clock { port, period, drift_ppm: 0, now, of, rest, place, next: place, runs: true });
        Ok(ClockId(self.clocks.len() - 1))
    }

    /// Adds the clock of a port that runs as many times as fast as another one, whose drift it shares. It starts at a random phase.
    ///
    /// # Errors
    /// There is no such port.
    pub fn multiple(&mut self, port: &str, times: u32, of: ClockId) -> Result<ClockId, Error> {
        let times = i64::from(times);
        let id = self.clock(port, (self.clocks[of.0].period / times / 1000) as u64)?;
        self.clocks[id.0].of = Some((of.0, times));
        Ok(id)
    }

    /// The model.
    pub const fn model(&mut self) -> &mut Model {
        &mut self.model
    }

    /// Stops a clock, or lets it run again from a random phase on.
    pub fn run_clock(&mut self, clock: ClockId, runs: bool) {
        let clock = &mut self.clocks[clock.0];
        if runs && !clock.runs {
            clock.place = self.now + self.draw.whole(1, clock.period);
            clock.next = clock.place;
        }
        clock.runs = runs;
    }

    /// Gives a clock another period in picoseconds, from its next edge on.
    pub fn set_period(&mut self, clock: ClockId, period_ps: u64) {
        self.clocks[clock.0].period = 1000 * period_ps as i64;
    }

    /// Picoseconds since the start.
    #[must_use]
    pub const fn time_ps(&self) -> u64 {
        self.now as u64 / 1000
    }

    /// Gives an input a value by its name.
    ///
    /// # Errors
    /// There is no such input.
    pub fn set(&mut self, port: &str, value: u64) -> Result<(), Error> {
        let port = self.model.library().source().port(port)?;
        self.model.poke(port, value)
    }

    /// The settled value of a port.
    ///
    /// # Errors
    /// There is no such port, or the simulation stops.
    pub fn get(&mut self, port: &str) -> Result<u64, Error> {
        let port = self.model.library().source().port(port)?;
        self.model.peek(port)
    }

    /// To the next edge: whichever clock comes first rises, with all that rise at the same moment.
    ///
    /// # Errors
    /// A rule was broken, or the simulation stops.
    pub fn step(&mut self, actors: &mut [&mut dyn Actor]) -> Result<(), Error> {
        let Some(next) = self.clocks.iter().filter(|clock| clock.runs).map(|clock| clock.next).min() else {
            return Err(Error::Stopped("no clock runs".into()));
        };
        self.now = next;
        let rising: Vec<usize> = (0..self.clocks.len()).filter(|i| self.rises(*i)).collect();
        let ports: Vec<usize> = rising.iter().map(|i| self.clocks[*i].port).collect();
        for actor in actors.iter_mut().filter(|actor| rising.contains(&actor.clock().0)) {
            actor.before(&mut self.model)?;
        }
        self.model.rise(&ports)?;
        for actor in actors.iter_mut().filter(|actor| rising.contains(&actor.clock().0)) {
            actor.after(&mut self.model)?;
        }
        rising.into_iter().for_each(|i| self.plan(i));
        Ok(())
    }

    /// [`Bench::step`], that many times.
    ///
    /// # Errors
    /// As [`Bench::step`].
    pub fn steps(&mut self, count: usize, actors: &mut [&mut dyn Actor]) -> Result<(), Error> {
        (0..count).try_for_each(|_| self.step(actors))
    }

    fn rises(&self, clock: usize) -> bool {
        self.clocks[clock].runs && self.clocks[clock].next == self.now
    }

    /// The edge after the one that was.
    fn plan(&mut self, clock: usize) {
        let source = self.clocks[clock].of.map(|(of, times)| (self.clocks[of].now, times));
        let clock = &mut self.clocks[clock];
        clock.drift_ppm = (clock.drift_ppm + self.draw.whole(-2, 2)).clamp(-DRIFT_PPM, DRIFT_PPM);
        clock.now = clock.period + clock.period * clock.drift_ppm / 1_000_000;
        if let Some((period, times)) = source {
            clock.now = (period + clock.rest) / times;
            clock.rest = (period + clock.rest) % times;
        }
        clock.place += clock.now;
        let jitter = clock.period / JITTER;
        clock.next = clock.place + self.draw.whole(-jitter, jitter);
    }
}
