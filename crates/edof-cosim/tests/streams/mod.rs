//! A block in Verilator, its streams fed and emptied with random pauses, and every stream checked against its rule: valid never falls, nor do
//! the words change, without a transfer.
use crate::support;
use edof_core::draw::Draw;
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Source, yosys};
use edof_hdl::describe::Circuit;
use edof_hdl::project;
use std::collections::VecDeque;

/// Cycles of reset at the start of every run.
pub const RESET: u64 = 64;

/// The values of a stream's fields in one transfer.
pub type Beat = Vec<u64>;

/// Cycles of 16 in which a side pauses.
#[derive(Debug, Clone, Copy)]
pub struct Pauses(pub i64);

impl Pauses {
    pub const NEVER: Self = Self(0);
    /// Every kind of traffic, from a free way to a nearly closed one.
    pub const KINDS: [(Self, Self); 5] =
        [(Self(0), Self(0)), (Self(6), Self(0)), (Self(0), Self(8)), (Self(9), Self(9)), (Self(14), Self(2))];

    fn goes(self, draw: &mut Draw) -> bool {
        draw.whole(0, 15) >= self.0
    }
}

struct Feed {
    valid: usize,
    ready: usize,
    fields: Vec<usize>,
    beats: VecDeque<Beat>,
    pauses: Pauses,
    stands: bool,
}

struct Drain {
    name: String,
    valid: usize,
    ready: usize,
    fields: Vec<usize>,
    pauses: Pauses,
    /// What stood there and was not taken.
    waits: Option<Beat>,
    /// What was taken, and when.
    taken: Vec<(u64, Beat)>,
}

/// A running block.
pub struct Bench {
    pub model: Model,
    source: Source,
    feeds: Vec<Feed>,
    drains: Vec<Drain>,
    draw: Draw,
    /// Cycles since reset.
    pub cycle: u64,
    _images: tempfile::TempDir,
}

/// A block, compiled.
pub struct Compiled {
    library: Library,
    source: Source,
    images: Vec<(String, String)>,
}

impl Compiled {
    /// The block as Yosys maps it to the cells of an FPGA.
    pub fn mapped(mut block: impl Circuit) -> Self {
        let source = Source::from(&project::of_circuit(&mut block, vec![]).unwrap());
        let source = yosys::mapped(&source, &yosys::Options::default()).unwrap();
        Self { library: Library::build(&source, &support::options()).unwrap(), source, images: vec![] }
    }

    pub fn new(mut block: impl Circuit, images: Vec<(String, String)>) -> Self {
        let project = project::of_circuit(&mut block, images).unwrap();
        let source = Source::from(&project);
        Self {
            library: Library::build(&source, &support::options()).unwrap(),
            source,
            images: project.memory,
        }
    }

    /// A fresh instance; registers and memories without an image hold what `seed` draws.
    pub fn start(&self, seed: u64) -> Bench {
        let dir = tempfile::tempdir().unwrap();
        for (name, text) in &self.images {
            let path = dir.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let start = Start { seed, memory_dir: Some(dir.path().into()) };
        Bench {
            model: self.library.start(&start).unwrap(),
            source: self.source.clone(),
            feeds: vec![],
            drains: vec![],
            draw: Draw::new(seed),
            cycle: 0,
            _images: dir,
        }
    }
}

impl Bench {
    pub fn poke(&mut self, name: &str, value: u64) {
        let port = self.source.port(name).unwrap();
        self.model.poke(port, value).unwrap();
    }

    pub fn peek(&mut self, name: &str) -> u64 {
        let port = self.source.port(name).unwrap();
        self.model.peek(port).unwrap()
    }

    pub fn reset(&mut self) {
        self.poke("reset_i", 1);
        (0..RESET).for_each(|_| self.model.tick().unwrap());
        self.poke("reset_i", 0);
    }

    /// Feeds the input stream whose ports begin with `prefix`.
    pub fn feed(&mut self, prefix: &str, fields: &[&str], beats: Vec<Beat>, pauses: Pauses) {
        let port = |name: String| self.source.port(&name).unwrap();
        self.feeds.push(Feed {
            valid: port(format!("{prefix}valid_i")),
            ready: port(format!("{prefix}ready_o")),
            fields: fields.iter().map(|field| port(format!("{prefix}{field}_i"))).collect(),
            beats: beats.into(),
            pauses,
            stands: false,
        });
    }

    /// Empties the output stream whose ports begin with `prefix`.
    pub fn drain(&mut self, prefix: &str, fields: &[&str], pauses: Pauses) {
        let port = |name: String| self.source.port(&name).unwrap();
        self.drains.push(Drain {
            name: prefix.into(),
            valid: port(format!("{prefix}valid_o")),
            ready: port(format!("{prefix}ready_i")),
            fields: fields.iter().map(|field| port(format!("{prefix}{field}_o"))).collect(),
            pauses,
            waits: None,
            taken: vec![],
        });
    }

    /// Lets go of all streams, which are empty.
    pub fn unbind(&mut self) {
        for feed in self.feeds.drain(..) {
            self.model.poke(feed.valid, 0).unwrap();
        }
        self.drains.clear();
    }

    /// One cycle.
    pub fn step(&mut self) {
        for feed in &mut self.feeds {
            feed.stands = feed.stands || (!feed.beats.is_empty() && feed.pauses.goes(&mut self.draw));
            self.model.poke(feed.valid, feed.stands.into()).unwrap();
            for (i, field) in feed.fields.iter().enumerate() {
                // What is not valid is anything.
                let value = if feed.stands { feed.beats[0][i] } else { self.draw.bits() };
                self.model.poke(*field, value).unwrap();
            }
        }
        for drain in &mut self.drains {
            let ready = drain.pauses.goes(&mut self.draw);
            self.model.poke(drain.ready, ready.into()).unwrap();
        }
        for feed in &mut self.feeds {
            if feed.stands && self.model.peek(feed.ready).unwrap() == 1 {
                feed.beats.pop_front();
                feed.stands = false;
            }
        }
        for drain in &mut self.drains {
            let stands = self.model.peek(drain.valid).unwrap() == 1;
            let beat: Beat = drain.fields.iter().map(|field| self.model.peek(*field).unwrap()).collect();
            if let Some(before) = drain.waits.take() {
                assert!(stands, "{}valid fell without a transfer in cycle {}", drain.name, self.cycle);
                assert_eq!(beat, before, "{}words changed in cycle {}", drain.name, self.cycle);
            }
            if stands && self.model.peek(drain.ready).unwrap() == 1 {
                drain.taken.push((self.cycle, beat));
            } else if stands {
                drain.waits = Some(beat);
            }
        }
        self.model.tick().unwrap();
        self.cycle += 1;
    }

    /// Runs until the given number of beats has left the first output, and a while longer, in which nothing may arrive; returns the beats.
    pub fn run(&mut self, beats: usize) -> Vec<Beat> {
        self.run_timed(beats).into_iter().map(|(_, beat)| beat).collect()
    }

    /// [`Bench::run`] with the cycle of each beat.
    pub fn run_timed(&mut self, beats: usize) -> Vec<(u64, Beat)> {
        let mut idle = 0;
        while self.drains[0].taken.len() < beats {
            let before = self.drains[0].taken.len();
            self.step();
            idle = if self.drains[0].taken.len() == before { idle + 1 } else { 0 };
            assert!(idle < 200_000, "nothing came for {idle} cycles: {before} of {beats} beats");
        }
        (0..300).for_each(|_| self.step());
        let taken = std::mem::take(&mut self.drains[0].taken);
        assert_eq!(taken.len(), beats, "more came than was asked for");
        assert!(self.feeds.iter().all(|feed| feed.beats.is_empty()), "not all was taken");
        taken
    }
}

/// The first unexpected beat is reported with its place.
#[track_caller]
pub fn assert_beats(what: &str, found: &[Beat], expected: &[Beat]) {
    assert_eq!(found.len(), expected.len(), "{what}: beats");
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(found, expected, "{what}: beat {i}");
    }
}
