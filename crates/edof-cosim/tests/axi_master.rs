//! A master that holds a memory behind AXI4 to the history of each of its words: bursts of any length, every channel stalled at random, AXI4's
//! rules for what a memory offers.

use edof_core::draw::Draw;
use edof_cosim::bench::{Actor, ClockId, Throttle};
use edof_cosim::verilator::Model;
use edof_cosim::{Error, Source};

/// Bytes of a word.
const BYTES: u64 = 16;
/// Strobes of a whole word.
const ALL: u64 = (1 << BYTES) - 1;

/// What is used of the memory.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Words that are used, in areas with gaps between: how many areas, words of each, and from one to the next.
    pub areas: [u64; 3],
    /// Words of the longest burst.
    pub longest: u64,
}

/// A word of a row: when it was accepted, and when its burst was answered.
struct Written {
    word: u128,
    accepted: u64,
    answered: Option<u64>,
}

/// A burst: who asks, its first row, its words with their strobes; and the cycle of its address.
#[derive(Clone)]
struct Burst {
    id: u64,
    row: u64,
    words: Vec<(u128, u64)>,
    asked: u64,
}

/// An offer of the memory's that stands until it is taken.
#[derive(Default)]
struct Standing(Option<(u64, u128, u64)>);

impl Standing {
    fn see(&mut self, valid: bool, ready: bool, what: (u64, u128, u64)) {
        if let Some(before) = self.0 {
            assert!(valid && before == what, "an offer was taken back: {before:x?}");
        }
        self.0 = (valid && !ready).then_some(what);
    }
}

pub struct Master {
    shape: Shape,
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
    stalls: bool,
    /// Bursts that were answered and that were read, and the most cycles of one from its offer to its end.
    pub done: [u64; 2],
    pub latest: [u64; 2],
    /// Words that were written in part.
    pub partial_words: u64,
}

impl Master {
    pub fn new(source: &Source, clock: ClockId, shape: Shape, seed: u64, stalls: bool) -> Self {
        let write = [
            "aw_id", "aw_addr", "aw_valid", "aw_ready", "w_data", "w_strb", "w_last", "w_valid", "w_ready",
            "b_valid", "b_ready",
        ];
        let read = [
            "ar_id", "ar_addr", "ar_len", "ar_valid", "ar_ready", "r_id", "r_data", "r_last", "r_valid",
            "r_ready",
        ];
        Self {
            shape,
            clock,
            write: write.map(|name| source.signal("write", name).unwrap()),
            read: read.map(|name| source.signal("read", name).unwrap()),
            response: source.signal("write", "b_resp").unwrap(),
            draw: Draw::new(seed),
            paces: std::array::from_fn(|i| Throttle::drawn(seed + i as u64)),
            cycle: 0,
            rows: (0..shape.areas[0] * shape.areas[1]).map(|_| vec![]).collect(),
            writing: None,
            addressed: false,
            sent: 0,
            offers: [false; 3],
            reading: None,
            asked: false,
            came: 0,
            standing: Default::default(),
            stalls,
            done: [0; 2],
            latest: [0; 2],
            partial_words: 0,
        }
    }

    fn whole(&mut self, least: u64, most: u64) -> u64 {
        self.draw.whole(least as i64, most as i64) as u64
    }

    /// A burst inside of an area, of words of which one in many is written in part or not at all.
    fn burst(&mut self) -> Burst {
        let [areas, words, _] = self.shape.areas;
        let count = self.whole(1, self.shape.longest.min(words));
        let row = words * self.whole(0, areas - 1) + self.whole(0, words - count);
        let is_whole = self.whole(0, 7) > 0;
        let words = (row..row + count).map(|row| {
            // What lay there at first nobody knows.
            let strobes = if is_whole || self.rows[row as usize].is_empty() {
                ALL
            } else {
                [ALL, 0, 0x3c, 0x8001][self.whole(0, 3) as usize]
            };
            (u128::from(self.draw.bits()) << 64 | u128::from(self.draw.bits()), strobes)
        });
        let words = words.collect();
        Burst { id: self.whole(0, 1), row, words, asked: self.cycle }
    }

    /// The byte address of a row.
    const fn address(&self, row: u64) -> u64 {
        let [_, words, apart] = self.shape.areas;
        BYTES * (row / words * apart + row % words)
    }

    /// The part of a word that these strobes enable.
    fn lines(strobes: u64) -> u128 {
        (0..BYTES).filter(|byte| strobes >> byte & 1 == 1).map(|byte| 0xff << (8 * byte)).sum()
    }

    fn goes(&mut self, channel: usize) -> bool {
        !self.stalls || self.paces[channel].goes()
    }

    fn accepted_word(&mut self) {
        let Some(burst) = &self.writing else { panic!("a word of no burst") };
        let (word, strobes) = burst.words[self.sent];
        let row = burst.row as usize + self.sent;
        let is_partial = strobes != ALL && strobes != 0;
        self.partial_words += u64::from(is_partial);
        if strobes != 0 {
            let before = self.rows[row].last().map_or(0, |written| written.word);
            let lines = Self::lines(strobes);
            let word = word & lines | before & !lines;
            self.rows[row].push(Written { word, accepted: self.cycle, answered: None });
        }
        self.sent += 1;
    }

    fn answered(&mut self, model: &mut Model, response: u64) -> Result<(), Error> {
        let burst = self.writing.take().unwrap();
        assert!(self.addressed && self.sent == burst.words.len(), "an answer before the last word");
        assert_eq!(response, 0, "the answer");
        for written in self.rows.iter_mut().flatten().filter(|written| written.answered.is_none()) {
            written.answered = Some(self.cycle);
        }
        self.latest[0] = self.latest[0].max(self.cycle - burst.asked);
        self.done[0] += 1;
        (self.addressed, self.sent) = (false, 0);
        model.poke(self.write[2], 0)
    }

    fn read_word(&mut self, id: u64, word: u128, last: bool) {
        let Some(burst) = &self.reading else { panic!("a word that nobody asked for") };
        assert!(self.asked && id == burst.id, "whose word");
        let row = (burst.row + self.came) as usize;
        let history = &self.rows[row];
        // What was answered when the address was offered, or anything later.
        let known = history.iter().rposition(|w| w.answered.is_some_and(|at| at < burst.asked));
        let possible = &history[known.unwrap_or(0)..];
        let is_right = possible.iter().any(|w| w.word == word && w.accepted < self.cycle);
        assert!(is_right || known.is_none(), "row {row}: {word:032x}");
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
        let [_, _, _, ar_valid, ar_ready, r_id, _, r_last, r_valid, r_ready] = read;
        let mut words = vec![0; BYTES as usize / 4];
        model.peek_words(self.read[6], &mut words)?;
        let r_data = words.iter().rev().fold(0, |word, next| word << 32 | u128::from(*next));
        self.standing[0].see(b_valid == 1, b_ready == 1, (0, 0, 0));
        self.standing[1].see(r_valid == 1, r_ready == 1, (r_id, r_data, r_last));
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
            model.poke(self.write[1], self.address(burst.row))?;
            self.writing = Some(burst);
            self.offers[0] = true;
        }
        model.poke(self.write[2], self.offers[0].into())?;
        if !self.offers[1]
            && let Some(burst) = self.writing.clone().filter(|burst| self.sent < burst.words.len())
            && self.goes(1)
        {
            let (word, strobes) = burst.words[self.sent];
            let words: Vec<u32> = (0..BYTES / 4).map(|i| (word >> (32 * i)) as u32).collect();
            model.poke_words(self.write[4], &words)?;
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
            model.poke(self.read[1], self.address(burst.row))?;
            model.poke(self.read[2], burst.words.len() as u64 - 1)?;
            self.reading = Some(burst);
            self.offers[2] = true;
        }
        model.poke(self.read[3], self.offers[2].into())?;
        // Now and then it takes no word for 2,048 cycles.
        let is_deaf = self.stalls && self.cycle & 0x1800 == 0x1800;
        let goes = self.goes(4) && !is_deaf;
        model.poke(self.read[9], goes.into())
    }
}
