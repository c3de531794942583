//! Block RAM behind AXI4 against the history of each of its rows: bursts of any length, every channel stalled at random, AXI4's rules for what a
//! memory offers, and no burst later than the board's agents are made for.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::bench::{Actor, Bench, ClockId, Throttle};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_device::board::ULX3S;
use edof_hdl::board::AxiRam;

/// Rows of 64 bits, and words of the longest burst.
const ROWS: u64 = 64;
const LONGEST: u64 = 32;
const WHOLE: u64 = 0xff;

/// A word of a row: when it was accepted, and when its burst was answered.
struct Written {
    word: u64,
    accepted: u64,
    answered: Option<u64>,
}

/// A burst: who asks, its first row, its words; and the cycle of its address.
#[derive(Clone)]
struct Burst {
    id: u64,
    row: u64,
    words: Vec<(u64, u64)>,
    asked: u64,
}

/// An offer of the memory's that stands until it is taken.
#[derive(Default)]
struct Standing(Option<Vec<u64>>);

impl Standing {
    fn see(&mut self, valid: bool, ready: bool, what: Vec<u64>) {
        if let Some(before) = &self.0 {
            assert!(valid && *before == what, "an offer was taken back: {before:?}");
        }
        self.0 = (valid && !ready).then_some(what);
    }
}

struct Master {
    clock: ClockId,
    write: [usize; 11],
    read: [usize; 10],
    response: usize,
    draw: Draw,
    paces: [Throttle; 5],
    cycle: u64,
    rows: Vec<Vec<Written>>,
    // Writes: offered, words to send, bursts whose words are accepted.
    writing: Option<Burst>,
    addressed: bool,
    sent: usize,
    offers: [bool; 3],
    // Reads: asked for, words that came.
    reading: Option<Burst>,
    asked: bool,
    came: u64,
    standing: [Standing; 2],
    partial: bool,
    stalls: bool,
    /// Bursts that were answered and that were read, and the most cycles of one from its offer to its end.
    done: [u64; 2],
    latest: [u64; 2],
    errors: u64,
}

impl Master {
    fn new(source: &Source, clock: ClockId, seed: u64, stalls: bool) -> Self {
        let write = [
            "aw_id", "aw_addr", "aw_valid", "aw_ready", "w_data", "w_strb", "w_last", "w_valid", "w_ready",
            "b_valid", "b_ready",
        ];
        let read = [
            "ar_id", "ar_addr", "ar_len", "ar_valid", "ar_ready", "r_id", "r_data", "r_last", "r_valid",
            "r_ready",
        ];
        Self {
            clock,
            write: write.map(|name| source.signal("write", name).unwrap()),
            read: read.map(|name| source.signal("read", name).unwrap()),
            response: source.signal("write", "b_resp").unwrap(),
            draw: Draw::new(seed),
            paces: std::array::from_fn(|i| Throttle::drawn(seed + i as u64)),
            cycle: 0,
            rows: (0..ROWS).map(|_| vec![]).collect(),
            writing: None,
            addressed: false,
            sent: 0,
            offers: [false; 3],
            reading: None,
            asked: false,
            came: 0,
            standing: Default::default(),
            partial: false,
            stalls,
            done: [0; 2],
            latest: [0; 2],
            errors: 0,
        }
    }

    fn whole(&mut self, least: u64, most: u64) -> u64 {
        self.draw.whole(least as i64, most as i64) as u64
    }

    /// A burst inside of the memory, of words of which one in many is written in part or not at all.
    fn burst(&mut self) -> Burst {
        let count = self.whole(1, LONGEST);
        let row = self.whole(0, ROWS - count);
        let is_whole = self.whole(0, 7) > 0;
        let words = (0..count).map(|_| {
            let strobes = if is_whole { WHOLE } else { [WHOLE, 0, 0x3c][self.whole(0, 2) as usize] };
            (self.draw.bits(), strobes)
        });
        let words = words.collect();
        Burst { id: self.whole(0, 1), row, words, asked: self.cycle }
    }

    fn goes(&mut self, channel: usize) -> bool {
        !self.stalls || self.paces[channel].goes()
    }

    fn accepted_word(&mut self) {
        let Some(burst) = &self.writing else { panic!("a word of no burst") };
        let (word, strobes) = burst.words[self.sent];
        let row = burst.row as usize + self.sent;
        self.partial |= strobes != WHOLE && strobes != 0;
        if strobes == WHOLE {
            self.rows[row].push(Written { word, accepted: self.cycle, answered: None });
        }
        self.sent += 1;
    }

    fn answered(&mut self, model: &mut Model, response: u64) -> Result<(), Error> {
        let burst = self.writing.take().unwrap();
        assert!(self.addressed && self.sent == burst.words.len(), "an answer before the last word");
        assert_eq!(response, if self.partial { 2 } else { 0 }, "the answer");
        self.errors += u64::from(self.partial);
        for written in self.rows.iter_mut().flatten().filter(|written| written.answered.is_none()) {
            written.answered = Some(self.cycle);
        }
        self.latest[0] = self.latest[0].max(self.cycle - burst.asked);
        self.done[0] += 1;
        (self.addressed, self.sent, self.partial) = (false, 0, false);
        model.poke(self.write[2], 0)
    }

    fn read_word(&mut self, id: u64, word: u64, last: bool) {
        let Some(burst) = &self.reading else { panic!("a word that nobody asked for") };
        assert!(self.asked && id == burst.id, "whose word");
        let row = (burst.row + self.came) as usize;
        let history = &self.rows[row];
        // What was answered when the address was offered, or anything later.
        let known = history.iter().rposition(|w| w.answered.is_some_and(|at| at < burst.asked));
        let possible = &history[known.unwrap_or(0)..];
        let is_right = possible.iter().any(|w| w.word == word && w.accepted < self.cycle);
        assert!(is_right || known.is_none(), "row {row}: {word:016x}");
        self.came += 1;
        assert_eq!(last, self.came == burst.words.len() as u64, "the mark of the last word");
        if last {
            self.latest[1] = self.latest[1].max(self.cycle - burst.asked);
            self.done[1] += 1;
            (self.reading, self.asked, self.came) = (None, false, 0);
        }
    }
}

impl Actor for Master {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        self.cycle += 1;
        let write = self.write.map(|port| model.peek(port).unwrap());
        let [.., aw_valid, aw_ready, _, _, _, w_valid, w_ready, b_valid, b_ready] = write;
        let read = self.read.map(|port| model.peek(port).unwrap());
        let [_, _, _, ar_valid, ar_ready, r_id, r_data, r_last, r_valid, r_ready] = read;
        self.standing[0].see(b_valid == 1, b_ready == 1, vec![]);
        self.standing[1].see(r_valid == 1, r_ready == 1, vec![r_id, r_data, r_last]);
        if w_valid == 1 && w_ready == 1 {
            self.offers[1] = false;
            self.accepted_word();
        }
        if aw_valid == 1 && aw_ready == 1 {
            (self.addressed, self.offers[0]) = (true, false);
        }
        if b_valid == 1 && b_ready == 1 {
            let response = model.peek(self.response)?;
            self.answered(model, response)?;
        }
        if ar_valid == 1 && ar_ready == 1 {
            (self.asked, self.offers[2]) = (true, false);
        }
        if r_valid == 1 && r_ready == 1 {
            self.read_word(r_id, r_data, r_last == 1);
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        if self.writing.is_none() && self.goes(0) {
            let burst = self.burst();
            model.poke(self.write[0], burst.id)?;
            model.poke(self.write[1], 8 * burst.row)?;
            self.writing = Some(burst);
            self.offers[0] = true;
        }
        model.poke(self.write[2], self.offers[0].into())?;
        if !self.offers[1]
            && let Some(burst) = self.writing.clone().filter(|burst| self.sent < burst.words.len())
            && self.goes(1)
        {
            let (word, strobes) = burst.words[self.sent];
            model.poke(self.write[4], word)?;
            model.poke(self.write[5], strobes)?;
            model.poke(self.write[6], u64::from(self.sent + 1 == burst.words.len()))?;
            self.offers[1] = true;
        }
        model.poke(self.write[7], self.offers[1].into())?;
        let goes = self.goes(2);
        model.poke(self.write[10], goes.into())?;
        if self.reading.is_none() && self.goes(3) {
            let burst = self.burst();
            model.poke(self.read[0], burst.id)?;
            model.poke(self.read[1], 8 * burst.row)?;
            model.poke(self.read[2], burst.words.len() as u64 - 1)?;
            self.reading = Some(burst);
            self.offers[2] = true;
        }
        model.poke(self.read[3], self.offers[2].into())?;
        let goes = self.goes(4);
        model.poke(self.read[9], goes.into())
    }
}

/// So many cycles with a master; the circuit's text may have been edited.
fn run(seed: u64, stalls: bool, edit: impl Fn(String) -> String) -> Master {
    let mut source = Source::circuit(&mut AxiRam::<64, 8>::new(ROWS as usize)).unwrap();
    for (name, text) in &mut source.files {
        if name.starts_with("axi_ram") {
            *text = edit(std::mem::take(text));
        }
    }
    let library = Library::build(&source, &support::options()).unwrap();
    let model = library.start(&Start { seed, ..Start::default() }).unwrap();
    let mut bench = Bench::new(model, seed);
    let clock = bench.clock("clock_i", 5_000).unwrap();
    bench.set("reset_i", 1).unwrap();
    bench.steps(16, &mut []).unwrap();
    bench.set("reset_i", 0).unwrap();
    let mut master = Master::new(&source, clock, seed, stalls);
    bench.steps(60_000, &mut [&mut master]).unwrap();
    master
}

#[test]
fn words_are_read_as_they_were_answered_whatever_stalls() {
    for seed in 1..4 {
        let master = run(seed, true, |text| text);
        assert!(master.done.iter().all(|bursts| *bursts > 300), "{:?}", master.done);
        assert!(master.errors > 10, "{} answers with an error", master.errors);
    }
}

#[test]
fn a_burst_takes_at_most_what_the_boards_agents_allow() {
    let master = run(1, false, |text| text);
    assert_eq!(master.latest, [LONGEST + 2, LONGEST + 5]);
    assert!(master.latest.iter().all(|cycles| *cycles <= ULX3S.memory.max_burst_cycles));
    assert_eq!(ULX3S.memory.burst_words as u64, LONGEST);
}

#[test]
fn mistakes_in_the_memory_are_found() {
    for (right, wrong) in [
        ("store_q <= is_whole;", "store_q <= 1'b1;"),
        ("if (write_w_last_i) begin", "if (1'b1) begin"),
        ("assign read_r_last_o = !(|to_follow_q);", "assign read_r_last_o = !(|to_ask_q);"),
        ("asked_2_q <= asked_1_q;", "asked_2_q <= ask;"),
        ("if (answer_q && write_b_ready_i) answer_q", "if (answer_q) answer_q"),
    ] {
        let edit = |text: String| {
            assert!(text.contains(right), "{right}: {text}");
            text.replace(right, wrong)
        };
        let found = std::panic::catch_unwind(|| run(1, true, edit));
        assert!(found.is_err(), "{wrong} is not found");
    }
}
