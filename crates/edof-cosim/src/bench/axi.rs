//! A memory behind AXI4 ports, as hard to please as the standard allows, and the standard's rules (ARM IHI 0022, A3 and A5).
//!
//! A burst is written when its answer is sent, not before; a word is read when it is sent, not before. So a reader that goes
//! ahead of an answer sees the old words, as it may in a real memory.

mod ports;

use super::{Actor, Behaviour, ClockId, Coupling, StabilityCheck, rule_broken};
use crate::verilator::Model;
use crate::{Error, Source};
use edof_core::draw::Draw;
use ports::{Address, Burst, ReadPorts, WritePorts};
use std::collections::{BTreeMap, VecDeque};

/// What passed through one side of a memory.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Bursts announced: address and words of each.
    pub bursts: Vec<(u64, u64)>,
    /// Answers with an error response.
    pub errors: usize,
    /// Most bursts that were not answered at a time.
    pub max_outstanding: usize,
    /// Most cycles from the offer of a burst's address to its last word.
    pub max_late: u64,
}

/// What a faulty memory makes of a word that is read: the word's number, and the word in parts of 32 bits, the lowest first.
pub type WordFault = fn(u64, &mut [u32]);

/// A word, and which of its bytes are written.
type Strobed = (Vec<u32>, u64);

struct Writing {
    name: String,
    ports: WritePorts,
    standing: [StabilityCheck; 2],
    offered: Option<u64>,
    announced: VecDeque<Burst>,
    words: VecDeque<(Vec<u32>, u64, bool)>,
    complete: VecDeque<(Burst, Vec<Strobed>)>,
    answers: bool,
}

struct Reading {
    name: String,
    ports: ReadPorts,
    standing: StabilityCheck,
    offered: Option<u64>,
    asked: VecDeque<Burst>,
    answers: bool,
}

/// A memory: any of a write bundle and a read bundle of the block.
pub struct Memory {
    clock: ClockId,
    /// The port, and its value while the memory is in reset.
    reset: (usize, u64),
    width: usize,
    writing: Option<Writing>,
    reading: Option<Reading>,
    words: BTreeMap<u64, Vec<u32>>,
    draw: Draw,
    cycle: u64,
    /// The cycle in which a pause ends.
    starves_until: u64,
    /// How it behaves.
    pub behaviour: Behaviour,
    /// A fault of its cells or of its data lines, for tests.
    pub fault: Option<WordFault>,
    /// What was written.
    pub written: Traffic,
    /// What was read.
    pub read: Traffic,
}

impl Memory {
    /// For the write bundle and the read bundle of those names; while the port `reset` has that value the memory itself is in reset, and
    /// forgets what is in flight. A reset of those who use it is nothing to a memory.
    ///
    /// # Errors
    /// There are no such ports.
    pub fn new(
        source: &Source,
        bundles: (Option<&str>, Option<&str>),
        clock: ClockId,
        reset: (&str, u64),
        behaviour: Behaviour,
        seed: u64,
    ) -> Result<Self, Error> {
        let writing = bundles.0.map(|name| Writing::new(source, name)).transpose()?;
        let reading = bundles.1.map(|name| Reading::new(source, name)).transpose()?;
        let data = writing.as_ref().map(|side| side.ports.w_data);
        let data = data.or(reading.as_ref().map(|side| side.ports.r_data));
        let width = data.map_or(0, |port| source.ports[port].bits);
        Ok(Self {
            clock,
            reset: (source.port(reset.0)?, reset.1),
            width,
            writing,
            reading,
            words: BTreeMap::new(),
            draw: Draw::new(seed),
            cycle: 0,
            starves_until: 0,
            behaviour,
            fault: None,
            written: Traffic::default(),
            read: Traffic::default(),
        })
    }

    /// Bytes in a word.
    #[must_use]
    pub const fn word_bytes(&self) -> u64 {
        self.width as u64 / 8
    }

    /// Puts bytes into the memory, from an address on.
    pub fn put(&mut self, address: u64, bytes: &[u8]) {
        for (at, byte) in (address..).zip(bytes) {
            let bit = 8 * (at % self.word_bytes()) as usize;
            let word = self.word(at / self.word_bytes());
            let slot = &mut word[bit / 32];
            *slot = *slot & !(0xff << (bit % 32)) | u32::from(*byte) << (bit % 32);
        }
    }

    /// Bytes of the memory, from an address on.
    pub fn get(&mut self, address: u64, count: usize) -> Vec<u8> {
        let bytes = (address..).take(count);
        bytes
            .map(|at| {
                let bit = 8 * (at % self.word_bytes()) as usize;
                (self.word(at / self.word_bytes())[bit / 32] >> (bit % 32)) as u8
            })
            .collect()
    }

    /// A word, which is random before anything was written.
    fn word(&mut self, index: u64) -> &mut Vec<u32> {
        let width = self.width / 32;
        self.words
            .entry(index)
            .or_insert_with(|| (0..width as u64).map(|i| Draw::nth(index, i) as u32).collect())
    }

    fn due(&mut self) -> u64 {
        let (min, max) = self.behaviour.latency;
        self.cycle + self.draw.whole(min, max) as u64
    }

    fn errs(&mut self, of_a_thousand: i64) -> bool {
        self.draw.whole(0, 999) < of_a_thousand
    }

    /// Whether a channel moves in this cycle.
    fn goes(&mut self) -> bool {
        self.cycle >= self.starves_until && self.behaviour.pace.goes()
    }

    /// A pause begins now and then.
    fn starve(&mut self) {
        let (min, max) = self.behaviour.starves;
        if max > 0 && self.cycle >= self.starves_until && self.draw.whole(0, 1_999) == 0 {
            self.starves_until = self.cycle + self.draw.whole(min, max) as u64;
        }
    }

    fn reset(&mut self) {
        if let Some(side) = &mut self.writing {
            side.standing.iter_mut().for_each(StabilityCheck::forget);
            side.offered = None;
            side.announced.clear();
            side.words.clear();
            side.complete.clear();
            side.answers = false;
        }
        if let Some(side) = &mut self.reading {
            side.standing.forget();
            side.offered = None;
            side.asked.clear();
            side.answers = false;
        }
    }
}

impl Writing {
    fn new(source: &Source, name: &str) -> Result<Self, Error> {
        Ok(Self {
            name: name.into(),
            ports: WritePorts::of(source, name)?,
            standing: Default::default(),
            offered: None,
            announced: VecDeque::new(),
            words: VecDeque::new(),
            complete: VecDeque::new(),
            answers: false,
        })
    }

    /// Whether the coupling lets an address and a word be accepted in the next cycle.
    fn coupled(&self, model: &mut Model, coupling: Coupling) -> Result<(bool, bool), Error> {
        let announced: u64 = self.announced.iter().map(|burst| burst.words).sum();
        let ahead = self.words.len() as i64 - announced as i64;
        Ok(match coupling {
            Coupling::Free => (true, true),
            Coupling::AddressWaits => {
                (ahead > 0 || (ahead == 0 && model.peek(self.ports.w_valid)? == 1), true)
            }
            Coupling::DataWaits => (true, ahead < 0),
        })
    }
}

impl Reading {
    fn new(source: &Source, name: &str) -> Result<Self, Error> {
        let ports = ReadPorts::of(source, name)?;
        Ok(Self {
            name: name.into(),
            ports,
            standing: StabilityCheck::default(),
            offered: None,
            asked: VecDeque::new(),
            answers: false,
        })
    }
}

/// Since when an address is offered, which is forgotten once it is taken.
fn since(begun: &mut Option<u64>, offered: bool, taken: bool, now: u64) -> u64 {
    let since = begun.unwrap_or(now);
    *begun = (offered && !taken).then_some(since);
    since
}

impl Actor for Memory {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        self.cycle += 1;
        self.starve();
        if model.peek(self.reset.0)? == self.reset.1 {
            self.reset();
            return Ok(());
        }
        if let Some(mut side) = self.writing.take() {
            let checked = self.before_write(model, &mut side);
            self.writing = Some(side);
            checked?;
        }
        if let Some(mut side) = self.reading.take() {
            let checked = self.before_read(model, &mut side);
            self.reading = Some(side);
            checked?;
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        if let Some(mut side) = self.writing.take() {
            let driven = self.after_write(model, &mut side);
            self.writing = Some(side);
            driven?;
        }
        if let Some(mut side) = self.reading.take() {
            let driven = self.after_read(model, &mut side);
            self.reading = Some(side);
            driven?;
        }
        Ok(())
    }
}

impl Memory {
    fn before_write(&mut self, model: &mut Model, side: &mut Writing) -> Result<(), Error> {
        let p = &side.ports;
        let fields = [p.aw_id, p.aw_addr, p.aw_len, p.aw_size, p.aw_burst];
        let offered = model.peek(p.aw_valid)? == 1;
        let taken = offered && model.peek(p.aw_ready)? == 1;
        let address = Address::offered(model, offered, fields)?;
        side.standing[0].check(model, &side.name, address.as_ref().map(Address::words).as_deref(), taken)?;
        let since = since(&mut side.offered, offered, taken, self.cycle);
        if let Some(address) = address.filter(|_| taken) {
            let burst = address.burst(model, &side.name, self.word_bytes())?;
            self.written.bursts.push((burst.address, burst.words));
            side.announced.push_back(Burst { offered: since, ..burst });
        }

        let offered = model.peek(p.w_valid)? == 1;
        let taken = offered && model.peek(p.w_ready)? == 1;
        if offered {
            let mut word = vec![0; self.width / 32];
            model.peek_words(p.w_data, &mut word)?;
            let (strobe, last) = (model.peek(p.w_strb)?, model.peek(p.w_last)? == 1);
            let whole = word.iter().copied().chain([strobe as u32, (strobe >> 32) as u32, last.into()]);
            let whole: Vec<u32> = whole.collect();
            side.standing[1].check(model, &side.name, Some(&whole), taken)?;
            if taken {
                side.words.push_back((word, strobe, last));
            }
        } else {
            side.standing[1].check(model, &side.name, None, false)?;
        }

        if side.answers && model.peek(p.b_ready)? == 1 {
            side.answers = false;
        }
        self.complete(model, side)?;
        let outstanding = side.announced.len() + side.complete.len() + usize::from(side.answers);
        self.written.max_outstanding = self.written.max_outstanding.max(outstanding);
        Ok(())
    }

    /// Bursts all of whose words have come.
    fn complete(&mut self, model: &Model, side: &mut Writing) -> Result<(), Error> {
        while let Some(burst) = side.announced.front() {
            let count = burst.words as usize;
            let marked = side.words.iter().take(count).position(|(_, _, last)| *last);
            if marked.is_some_and(|at| at + 1 != count) || (side.words.len() >= count && marked.is_none()) {
                return Err(rule_broken(
                    model,
                    &side.name,
                    "the last word of a burst is not the one that is marked",
                ));
            }
            if side.words.len() < count {
                break;
            }
            self.written.max_late = self.written.max_late.max(self.cycle - burst.offered);
            let words = side.words.drain(..count).map(|(word, strobe, _)| (word, strobe)).collect();
            let due = self.due();
            if let Some(burst) = side.announced.pop_front() {
                side.complete.push_back((Burst { due, ..burst }, words));
            }
        }
        Ok(())
    }

    fn after_write(&mut self, model: &mut Model, side: &mut Writing) -> Result<(), Error> {
        let p = &side.ports;
        let (address_goes, word_goes) = side.coupled(model, self.behaviour.coupling)?;
        model.poke(p.aw_ready, (address_goes && self.goes()).into())?;
        model.poke(p.w_ready, (word_goes && self.goes()).into())?;
        let chosen = if side.answers || !self.goes() {
            None
        } else {
            self.choose(side.complete.iter().map(|(burst, _)| burst))
        };
        if let Some((burst, words)) = chosen.and_then(|at| side.complete.remove(at)) {
            let fails = self.errs(self.behaviour.errors);
            self.written.errors += usize::from(fails);
            let first = burst.address / self.word_bytes();
            for (index, (word, strobe)) in (first..).zip(words).filter(|_| !fails) {
                self.store(index, &word, strobe);
            }
            side.answers = true;
            model.poke(p.b_id, burst.id)?;
            model.poke(p.b_resp, if fails { 2 } else { 0 })?;
        }
        model.poke(p.b_valid, side.answers.into())
    }

    fn store(&mut self, index: u64, word: &[u32], strobe: u64) {
        let held = self.word(index);
        for byte in (0..4 * word.len()).filter(|byte| strobe >> byte & 1 == 1) {
            let mask = 0xff << (8 * (byte % 4));
            held[byte / 4] = held[byte / 4] & !mask | word[byte / 4] & mask;
        }
    }

    fn before_read(&mut self, model: &mut Model, side: &mut Reading) -> Result<(), Error> {
        let p = &side.ports;
        let fields = [p.ar_id, p.ar_addr, p.ar_len, p.ar_size, p.ar_burst];
        let offered = model.peek(p.ar_valid)? == 1;
        let taken = offered && model.peek(p.ar_ready)? == 1;
        let address = Address::offered(model, offered, fields)?;
        side.standing.check(model, &side.name, address.as_ref().map(Address::words).as_deref(), taken)?;
        if side.answers && model.peek(p.r_ready)? == 1 {
            side.answers = false;
        }
        let offered = since(&mut side.offered, offered, taken, self.cycle);
        if let Some(address) = address.filter(|_| taken) {
            let burst = address.burst(model, &side.name, self.word_bytes())?;
            self.read.bursts.push((burst.address, burst.words));
            let due = self.due();
            side.asked.push_back(Burst { due, offered, ..burst });
        }
        self.read.max_outstanding = self.read.max_outstanding.max(side.asked.len());
        Ok(())
    }

    fn after_read(&mut self, model: &mut Model, side: &mut Reading) -> Result<(), Error> {
        let p = &side.ports;
        model.poke(p.ar_ready, self.goes().into())?;
        let chosen = if side.answers || !self.goes() { None } else { self.choose(side.asked.iter()) };
        if let Some(at) = chosen {
            let id = side.asked[at].id;
            let fails = self.errs(self.behaviour.read_errors[id as usize % 2]);
            self.read.errors += usize::from(fails);
            let bytes = self.word_bytes();
            let burst = &mut side.asked[at];
            let flip = if fails { u32::MAX } else { 0 };
            let index = burst.address / bytes;
            let mut word: Vec<u32> = self.word(index).iter().map(|part| part ^ flip).collect();
            if let Some(fault) = self.fault {
                fault(index, &mut word);
            }
            burst.address += bytes;
            burst.words -= 1;
            side.answers = true;
            model.poke(p.r_id, burst.id)?;
            model.poke(p.r_last, (burst.words == 0).into())?;
            if burst.words == 0 {
                self.read.max_late = self.read.max_late.max(self.cycle - burst.offered);
                side.asked.remove(at);
            }
            model.poke(p.r_resp, if fails { 2 } else { 0 })?;
            model.poke_words(p.r_data, &word)?;
        }
        model.poke(p.r_valid, side.answers.into())
    }

    /// The burst that continues: the oldest one of any id; without reordering, the oldest of all.
    fn choose<'a>(&mut self, bursts: impl Iterator<Item = &'a Burst>) -> Option<usize> {
        let mut ids = vec![];
        let mut open = vec![];
        for (at, burst) in bursts.enumerate() {
            let first_of_id = !ids.contains(&burst.id);
            ids.push(burst.id);
            if first_of_id && (self.behaviour.reorders || at == 0) && burst.due <= self.cycle {
                open.push(at);
            }
        }
        (!open.is_empty()).then(|| open[self.draw.whole(0, open.len() as i64 - 1) as usize])
    }
}
