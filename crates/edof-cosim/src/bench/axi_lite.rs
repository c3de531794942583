//! A host behind an AXI4-Lite port: writes and reads words, one after the other.

use super::{Actor, ClockId, StabilityCheck, Throttle, rule_broken};
use crate::verilator::Model;
use crate::{Error, Source};
use std::collections::VecDeque;

/// What a host wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// A word to an address.
    Write(u32, u32),
    /// The word at an address.
    Read(u32),
}

/// How it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Answer {
    /// What was wanted.
    pub access: Access,
    /// The word that was read; 0 for a write.
    pub word: u32,
    /// Whether the block said that all went well.
    pub is_good: bool,
}

/// A master of the AXI4-Lite bundle that a block serves.
pub struct Host {
    clock: ClockId,
    name: String,
    ports: Ports,
    pace: Throttle,
    standing: [StabilityCheck; 2],
    /// Address and word are offered, or not yet, or taken.
    offers: [Offer; 2],
    /// What it still wants.
    pub wanted: VecDeque<Access>,
    /// What it got.
    pub answers: Vec<Answer>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Offer {
    NotYet,
    Stands,
    Taken,
}

struct Ports {
    reset: usize,
    aw: [usize; 3],
    w: [usize; 4],
    b: [usize; 3],
    ar: [usize; 3],
    r: [usize; 4],
}

impl Host {
    /// For the bundle of that name; while the port `reset` is high nothing is offered.
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
        let port = |signal| source.signal(name, signal);
        let ports = Ports {
            reset: source.port(reset)?,
            aw: [port("aw_valid")?, port("aw_ready")?, port("aw_addr")?],
            w: [port("w_valid")?, port("w_ready")?, port("w_data")?, port("w_strb")?],
            b: [port("b_valid")?, port("b_ready")?, port("b_resp")?],
            ar: [port("ar_valid")?, port("ar_ready")?, port("ar_addr")?],
            r: [port("r_valid")?, port("r_ready")?, port("r_resp")?, port("r_data")?],
        };
        Ok(Self {
            clock,
            name: name.into(),
            ports,
            pace,
            standing: Default::default(),
            offers: [Offer::NotYet; 2],
            wanted: VecDeque::new(),
            answers: vec![],
        })
    }

    fn finish(&mut self, word: u32, response: u64) {
        if let Some(access) = self.wanted.pop_front() {
            self.answers.push(Answer { access, word, is_good: response == 0 });
        }
        self.offers = [Offer::NotYet; 2];
    }
}

/// Whether an offer of ours is taken in this cycle.
fn taken(model: &mut Model, offer: &mut Offer, ready: usize) -> Result<(), Error> {
    if *offer == Offer::Stands && model.peek(ready)? == 1 {
        *offer = Offer::Taken;
    }
    Ok(())
}

impl Actor for Host {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        if model.peek(self.ports.reset)? == 1 {
            self.offers = [Offer::NotYet; 2];
            self.standing.iter_mut().for_each(StabilityCheck::forget);
            return Ok(());
        }
        let (b, r) = (self.ports.b, self.ports.r);
        let (written, read) = (model.peek(b[0])? == 1, model.peek(r[0])? == 1);
        let response = [model.peek(b[2])?, model.peek(r[2])?];
        let word = model.peek(r[3])? as u32;
        let [b_taken, r_taken] = [written && model.peek(b[1])? == 1, read && model.peek(r[1])? == 1];
        self.standing[0].check(model, &self.name, written.then_some(&[response[0] as u32][..]), b_taken)?;
        self.standing[1].check(
            model,
            &self.name,
            read.then_some(&[response[1] as u32, word][..]),
            r_taken,
        )?;
        let is_write = matches!(self.wanted.front(), Some(Access::Write(..)));
        let whole = self.offers == [Offer::Taken; 2];
        if (written && !(is_write && whole)) || (read && (is_write || self.offers[0] != Offer::Taken)) {
            return Err(rule_broken(model, &self.name, "answers what was not asked"));
        }
        if is_write {
            taken(model, &mut self.offers[0], self.ports.aw[1])?;
            taken(model, &mut self.offers[1], self.ports.w[1])?;
        } else {
            taken(model, &mut self.offers[0], self.ports.ar[1])?;
        }
        if b_taken {
            self.finish(0, response[0]);
        } else if r_taken {
            self.finish(word, response[1]);
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let resets = model.peek(self.ports.reset)? == 1;
        let wanted = self.wanted.front().copied().filter(|_| !resets);
        let is_write = matches!(wanted, Some(Access::Write(..)));
        for (channel, offer) in self.offers.iter_mut().enumerate() {
            let concerns = wanted.is_some() && (is_write || channel == 0);
            if concerns && *offer == Offer::NotYet && self.pace.goes() {
                *offer = Offer::Stands;
            }
        }
        let stands = |offer: Offer| u64::from(offer == Offer::Stands && wanted.is_some());
        let (address, word) = match wanted {
            Some(Access::Write(address, word)) => (address, word),
            Some(Access::Read(address)) => (address, 0),
            None => (0, 0),
        };
        let p = &self.ports;
        model.poke(p.aw[0], if is_write { stands(self.offers[0]) } else { 0 })?;
        model.poke(p.aw[2], address.into())?;
        model.poke(p.w[0], if is_write { stands(self.offers[1]) } else { 0 })?;
        model.poke(p.w[2], word.into())?;
        model.poke(p.w[3], 15)?;
        model.poke(p.ar[0], if is_write { 0 } else { stands(self.offers[0]) })?;
        model.poke(p.ar[2], address.into())?;
        let [b_ready, r_ready] = [self.pace.goes(), self.pace.goes()];
        model.poke(p.b[1], b_ready.into())?;
        model.poke(p.r[1], r_ready.into())
    }
}
