//! Frames through memory: two writers and two readers on one AXI4 port, random streams, stalls, latency, errors and resets.
//!
//! The transaction model: what comes out are whole frames that went in, in order, none older than one that came before; what was
//! broken or answered by an error never comes out; the counters say how many there were of each. The memory lives through every reset.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::bench::{Actor, Beat, Behaviour, Bench, Coupling, Mark, Memory, Receiver, Sender, Throttle};
use edof_cosim::verilator::{Library, Start};
use edof_cosim::{Error, Source, lint};
use edof_device::fifos::agent_words;
use edof_hdl::board::{AxiPair, Frames, ReadAgent, WriteAgent};
use edof_hdl::ports::{AxiReadMaster, AxiWriteMaster, StreamIn, StreamOut};
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;
use std::path::Path;

/// Two sets of buffers on one memory. Set 0 waits for new frames, set 1 repeats late ones.
#[derive(Circuit)]
struct Agents {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub memory_reset: Signal<In, Bit>,
    pub from_0: StreamIn<16>,
    pub from_1: StreamIn<16>,
    pub to_0: StreamOut<16>,
    pub to_1: StreamOut<16>,
    pub dram_write: AxiWriteMaster<64, 8>,
    pub dram_read: AxiReadMaster<64>,
    pub written_0: Signal<Out, Bits<32>>,
    pub written_1: Signal<Out, Bits<32>>,
    pub broken_0: Signal<Out, Bits<32>>,
    pub broken_1: Signal<Out, Bits<32>>,
    pub write_errors: Signal<Out, Bits<32>>,
    pub read_0: Signal<Out, Bits<32>>,
    pub read_1: Signal<Out, Bits<32>>,
    pub late_0: Signal<Out, Bits<32>>,
    pub late_1: Signal<Out, Bits<32>>,
    pub read_errors: Signal<Out, Bits<32>>,
    writers: [WriteAgent<64, 8>; 2],
    readers: [ReadAgent<64>; 2],
    pair: AxiPair<64, 8>,
}

impl Logic for Agents {
    #[hdl_gen]
    fn update(&mut self) {
        self.pair.clock.next = self.clock.val();
        self.pair.reset.next = self.reset.val();
        self.pair.memory_reset.next = self.memory_reset.val();
        // As in the core: what set 1 writes is made of what set 0 reads.
        self.writers[0].corrupted.next = false;
        self.writers[1].corrupted.next = self.readers[0].corrupted.val();
        for i in 0..2 {
            self.writers[i].clock.next = self.clock.val();
            self.writers[i].reset.next = self.reset.val();
            self.readers[i].clock.next = self.clock.val();
            self.readers[i].reset.next = self.reset.val();
            self.writers[i].reading.next = self.readers[i].reading.val();
            self.readers[i].newest.next = self.writers[i].newest.val();
        }
        self.readers[0].repeats.next = false;
        self.readers[1].repeats.next = true;
        StreamIn::<16>::link(&mut self.from_0, &mut self.writers[0].pixels);
        StreamIn::<16>::link(&mut self.from_1, &mut self.writers[1].pixels);
        StreamOut::<16>::link(&mut self.to_0, &mut self.readers[0].pixels);
        StreamOut::<16>::link(&mut self.to_1, &mut self.readers[1].pixels);
        AxiWriteMaster::<64, 8>::join(&mut self.writers[0].dram, &mut self.pair.write_0);
        AxiWriteMaster::<64, 8>::join(&mut self.writers[1].dram, &mut self.pair.write_1);
        AxiReadMaster::<64>::join(&mut self.readers[0].dram, &mut self.pair.read_0);
        AxiReadMaster::<64>::join(&mut self.readers[1].dram, &mut self.pair.read_1);
        AxiWriteMaster::<64, 8>::link(&mut self.dram_write, &mut self.pair.dram_write);
        AxiReadMaster::<64>::link(&mut self.dram_read, &mut self.pair.dram_read);
        self.written_0.next = self.writers[0].frames.val();
        self.written_1.next = self.writers[1].frames.val();
        self.broken_0.next = self.writers[0].broken.val();
        self.broken_1.next = self.writers[1].broken.val();
        self.write_errors.next = self.writers[0].errors.val() + self.writers[1].errors.val();
        self.read_0.next = self.readers[0].frames.val();
        self.read_1.next = self.readers[1].frames.val();
        self.late_0.next = self.readers[0].late.val();
        self.late_1.next = self.readers[1].late.val();
        self.read_errors.next = self.readers[0].errors.val() + self.readers[1].errors.val();
    }
}

const WIDTH: usize = 24;
const HEIGHT: usize = 10;
const BURST: usize = 16;

pub fn frames(set: u32) -> Frames {
    let buffers = [0, 1, 2].map(|buffer| 0x1000 * (4 * set + buffer));
    Frames { width: WIDTH, height: HEIGHT, buffers, burst: BURST, depth: DEPTH }
}

/// Words that each of them may hold.
const DEPTH: usize = 32;

/// The agents, and how full each ever was.
pub fn source() -> Source {
    let mark = |i: usize| {
        let agent = |kind: &str, taken: &str| {
            let counts = ["write_ptr", taken].map(|count| format!("{kind}s_{i}.{count}_q"));
            Mark::between(&format!("{kind}_{i}"), "clock_i", [&counts[0], &counts[1]], 12)
        };
        [agent("writer", "sent"), agent("reader", "read_ptr")]
    };
    plain().watched("reset_i", &[mark(0), mark(1)].concat())
}

pub fn plain() -> Source {
    let sets = [0, 1];
    let mut agents = Agents::from_parts(AgentsParts {
        writers: sets.map(|set| WriteAgent::new(&frames(set))),
        readers: sets.map(|set| ReadAgent::new(&frames(set))),
        pair: AxiPair::default(),
    });
    Source::circuit(&mut agents).unwrap()
}

/// Frame `number`: its number first, then what nobody guesses.
pub fn frame(number: u64) -> Vec<Beat> {
    let pixel = |i: u64| if i == 0 { number } else { Draw::nth(number, i) & 0xffff };
    let line =
        |row: usize| Beat::line((0..WIDTH).map(move |column| pixel((row * WIDTH + column) as u64)), row == 0);
    (0..HEIGHT).flat_map(line).collect()
}

/// A frame with too few pixels in a line, too many, as many too few in one as too many in the next, or too few lines.
fn broken(number: u64, draw: &mut Draw) -> Vec<Beat> {
    let mut beats = frame(number);
    let place = draw.whole(1, (WIDTH * HEIGHT) as i64 - 2) as usize;
    let more = Beat { data: 7, user: false, last: false };
    match draw.whole(0, 3) {
        0 => drop(beats.remove(place)),
        1 => beats.insert(place, more),
        2 => {
            beats.insert(draw.whole(WIDTH as i64 + 1, 2 * WIDTH as i64 - 2) as usize, more);
            beats.remove(draw.whole(1, WIDTH as i64 - 2) as usize);
        }
        _ => beats.truncate(place),
    }
    beats
}

/// Everything around the agents.
pub struct Rig {
    bench: Bench,
    pub senders: [Sender; 2],
    pub receivers: [Receiver; 2],
    pub memory: Memory,
}

impl Rig {
    pub fn new(source: &Source, behaviour: Behaviour, seed: u64) -> Result<Self, Error> {
        let library = Library::build(source, &support::options())?;
        let mut bench = Bench::new(library.start(&Start { seed, ..Start::default() })?, seed);
        let clock = bench.clock("clock_i", 5_000)?;
        let pace = |i: u64| Throttle::drawn(seed + i);
        let sender = |i| Sender::new(source, ["from_0", "from_1"][i], clock, "reset_i", pace(i as u64));
        let receiver = |i| Receiver::new(source, ["to_0", "to_1"][i], clock, "reset_i", pace(2 + i as u64));
        let bundles = (Some("dram_write"), Some("dram_read"));
        let memory = Memory::new(source, bundles, clock, ("memory_reset_i", 1), behaviour, seed)?;
        let (senders, receivers) = ([sender(0)?, sender(1)?], [receiver(0)?, receiver(1)?]);
        let mut rig = Self { bench, senders, receivers, memory };
        rig.reset_all(20)?;
        Ok(rig)
    }

    /// A reset of the memory, and of the agents with it.
    pub fn reset_all(&mut self, cycles: usize) -> Result<(), Error> {
        self.bench.set("memory_reset_i", 1)?;
        self.reset(cycles)?;
        self.bench.set("memory_reset_i", 0)
    }

    pub fn reset(&mut self, cycles: usize) -> Result<(), Error> {
        self.bench.set("reset_i", 1)?;
        self.steps(cycles)?;
        self.bench.set("reset_i", 0)
    }

    pub fn steps(&mut self, cycles: usize) -> Result<(), Error> {
        let ([one, two], [three, four]) = (&mut self.senders, &mut self.receivers);
        let actors: &mut [&mut dyn Actor] = &mut [one, two, three, four, &mut self.memory];
        self.bench.steps(cycles, actors)
    }

    /// Until all was sent, and some while after.
    pub fn finish(&mut self) -> Result<(), Error> {
        for _ in 0..400 {
            if self.senders.iter().all(|sender| sender.beats.is_empty()) {
                return self.steps(6_000);
            }
            self.steps(1_000)?;
        }
        panic!("the senders hang");
    }

    pub fn count(&mut self, port: &str) -> u64 {
        self.bench.get(port).unwrap()
    }

    /// The numbers of the frames that a receiver got, each whole.
    pub fn received(&self, set: usize) -> Vec<u64> {
        self.numbers(set).unwrap_or_else(|number| panic!("frame {number} is torn"))
    }

    /// The numbers of the frames that a receiver got, or that of one that is not whole; what begins without a first pixel is left
    /// out, as is the last one where it has not ended.
    pub fn numbers(&self, set: usize) -> Result<Vec<u64>, u64> {
        let beats = &self.receivers[set].beats;
        let starts: Vec<usize> = (0..beats.len()).filter(|at| beats[*at].user).collect();
        let ends = starts.iter().skip(1).copied().chain([beats.len()]);
        let whole = starts
            .iter()
            .zip(ends)
            .filter(|(start, end)| *end < beats.len() || end - *start == WIDTH * HEIGHT);
        let number = |(start, end): (&usize, usize)| {
            let number = beats[*start].data;
            if beats[*start..end] == frame(number) { Ok(number) } else { Err(number) }
        };
        whole.map(number).collect()
    }
}

#[test]
fn what_comes_out_are_whole_frames_in_order_and_counters_are_right() {
    whole_frames_come_out_in_order(&source(), 0..4);
}

/// Frames through the agents, some of them broken; and what the counters say of them.
pub fn whole_frames_come_out_in_order(source: &Source, seeds: std::ops::Range<u64>) {
    for seed in seeds {
        let mut rig = Rig::new(source, Behaviour::hard(seed), seed).unwrap();
        let draw = &mut Draw::new(seed);
        let mut good = [vec![], vec![]];
        let mut bad = [0, 0];
        for set in 0..2 {
            for number in 1..40 {
                if draw.whole(0, 4) == 0 {
                    rig.senders[set].beats.extend(broken(number, draw));
                    bad[set] += 1;
                } else {
                    rig.senders[set].beats.extend(frame(number));
                    good[set].push(number);
                }
            }
            // A frame that lacks its end is found broken when the next one begins.
            rig.senders[set].beats.extend(frame(100));
            good[set].push(100);
        }
        rig.finish().unwrap();
        for set in 0..2 {
            let received = rig.received(set);
            assert!(
                received.iter().all(|number| good[set].contains(number)),
                "a broken frame came out: {received:?}"
            );
            assert!(received.is_sorted(), "{received:?}");
            assert_eq!(received.last(), Some(&100), "the newest frame is not there: {received:?}");
            let repeated = received.windows(2).filter(|pair| pair[0] == pair[1]).count() as u64;
            let names = [
                ["written_0_o", "broken_0_o", "late_0_o", "read_0_o"],
                ["written_1_o", "broken_1_o", "late_1_o", "read_1_o"],
            ];
            let [written, broken, late, read] = names[set].map(|port| rig.count(port));
            assert_eq!((written, broken), (good[set].len() as u64, bad[set]));
            // The frame that is being sent may be one more.
            assert!(read - received.len() as u64 <= 1, "{read} frames begun, {} received", received.len());
            assert!(late - repeated <= 1, "{late} late, {repeated} repeated");
            assert!(set == 1 || late == 0);
        }
        assert_eq!((rig.count("write_errors_o"), rig.count("read_errors_o")), (0, 0));
        let words = WIDTH * HEIGHT / 4;
        let lengths = [BURST as u64, (words % BURST) as u64];
        assert!(
            rig.memory
                .written
                .bursts
                .iter()
                .chain(&rig.memory.read.bursts)
                .all(|(_, len)| lengths.contains(len))
        );
        assert!(rig.memory.written.max_outstanding >= 3 && rig.memory.read.max_outstanding >= 4);
    }
}

#[test]
fn a_frame_that_failed_to_be_written_never_comes_out_and_errors_are_counted() {
    let source = source();
    let behaviour = Behaviour { errors: 60, ..Behaviour::hard(5) };
    let mut rig = Rig::new(&source, behaviour, 5).unwrap();
    for number in 1..60 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
    }
    rig.finish().unwrap();
    for set in 0..2 {
        assert!(rig.received(set).is_sorted());
    }
    let [good, bad] = [["written_0_o", "written_1_o"], ["broken_0_o", "broken_1_o"]]
        .map(|ports| ports.map(|port| rig.count(port)));
    assert!(bad[0] > 0 && bad[1] > 0);
    assert_eq!([good[0] + bad[0], good[1] + bad[1]], [59, 59]);
    assert_eq!(rig.count("write_errors_o"), rig.memory.written.errors as u64);
}

/// What a reader makes of words that came with an error.
const BLACK: u64 = 0x8010;

#[test]
fn a_word_that_was_read_with_an_error_is_not_shown_and_what_is_made_of_it_is_held_back() {
    let source = source();
    let behaviour = Behaviour { read_errors: [8, 8], ..Behaviour::hard(8) };
    let mut rig = Rig::new(&source, behaviour, 8).unwrap();
    for number in 1..80 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
    }
    rig.finish().unwrap();
    let mut cut = 0;
    for receiver in &rig.receivers {
        for shown in receiver.beats.chunks_exact(WIDTH * HEIGHT) {
            assert!(shown[0].user, "a frame of another length");
            let good = shown.iter().take_while(|beat| beat.data != BLACK).count();
            assert!(shown[good..].iter().all(|beat| beat.data == BLACK), "words after an error are shown");
            assert!(
                good == 0 || shown[..good] == frame(shown[0].data)[..good],
                "a word with an error is shown"
            );
            cut += usize::from(good < shown.len());
        }
    }
    assert!(cut > 3, "{cut} frames with errors");
    // A word may be in flight.
    assert!(rig.memory.read.errors as u64 - rig.count("read_errors_o") <= 1);
    // Set 1 is not connected to set 0 here, so all of its frames were good: some are held back none the less.
    assert_eq!(rig.count("broken_0_o"), 0);
    let [written, held] = ["written_1_o", "broken_1_o"].map(|port| rig.count(port));
    assert!(held >= 2 && written > 2 && written + held == 79, "{written} written, {held} held back");
}

#[test]
fn after_a_word_with_an_error_two_frames_are_held_back_and_no_more() {
    let source = source();
    let mut rig = Rig::new(&source, Behaviour { read_errors: [1, 0], ..Behaviour::hard(11) }, 11).unwrap();
    for number in 1..200 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
    }
    rig.finish().unwrap();
    let [errors, held] = ["read_errors_o", "broken_1_o"].map(|port| rig.count(port));
    assert!(errors > 1 && errors < held && held <= 2 * errors, "{errors} errors, {held} held back");
}

#[test]
fn a_reader_that_is_faster_repeats_and_one_that_waits_does_not() {
    let source = source();
    let mut rig = Rig::new(&source, Behaviour::ideal(), 6).unwrap();
    for number in 1..5 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
        rig.steps(4_000).unwrap();
    }
    assert_eq!(rig.received(0), [1, 2, 3, 4]);
    let received = rig.received(1);
    let mut once = received.clone();
    once.dedup();
    assert_eq!(once, [1, 2, 3, 4]);
    assert!(received.len() > 16);
}

#[test]
fn a_late_memory_repeats_frames_and_tears_none() {
    let source = source();
    let mut rig = Rig::new(&source, Behaviour::ideal(), 7).unwrap();
    for number in 1..30 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
        rig.memory.behaviour = match number % 3 {
            0 => Behaviour { latency: (900, 2_500), ..Behaviour::ideal() },
            1 => Behaviour { pace: Throttle::percent(4, number), ..Behaviour::hard(number) },
            _ => Behaviour::ideal(),
        };
        rig.steps(2_000).unwrap();
    }
    rig.memory.behaviour = Behaviour::ideal();
    rig.finish().unwrap();
    for set in 0..2 {
        let received = rig.received(set);
        assert!(received.is_sorted() && received.last() == Some(&29), "{received:?}");
    }
}

/// Words of four pixels one cycle apart, in memories that are more and more often late.
#[test]
fn agents_hold_no_more_than_the_model_says_for_a_memory_that_late() {
    let (source, mut beyond_a_burst) = (source(), false);
    for (seed, percent, latency) in [(1, 100, (1, 1)), (2, 90, (1, 10)), (3, 80, (5, 20))] {
        let pace = Throttle::percent(percent, seed);
        let mut rig = Rig::new(&source, Behaviour { pace, latency, ..Behaviour::hard(seed) }, seed).unwrap();
        for number in 1..30 {
            rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
        }
        rig.finish().unwrap();
        let late = rig.memory.written.max_late;
        let limit = agent_words(BURST, late, 4);
        for i in 0..2 {
            let max = rig.count(&format!("max_writer_{i}_o")) as usize;
            assert!(max >= BURST && max <= limit.min(DEPTH), "{max} of {limit}, {late} cycles late");
            beyond_a_burst |= max > agent_words(BURST, 0, 4);
            let max = rig.count(&format!("max_reader_{i}_o")) as usize;
            assert!(max > BURST && max <= DEPTH, "{max}");
        }
    }
    assert!(beyond_a_burst, "how late the memory is made no difference");
}

#[test]
fn every_slave_that_the_standard_allows_is_served() {
    let source = source();
    for (seed, coupling) in (0..).zip([Coupling::Free, Coupling::AddressWaits, Coupling::DataWaits]) {
        for behaviour in [Behaviour::ideal(), Behaviour::hard(seed), Behaviour::starving(seed)] {
            let behaviour = Behaviour { coupling, ..behaviour };
            let mut rig = Rig::new(&source, behaviour, seed).unwrap();
            for number in 1..12 {
                rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
            }
            rig.finish().unwrap();
            // Words that are thousands of cycles late.
            rig.steps(40_000).unwrap();
            for set in 0..2 {
                let received = rig.received(set);
                assert!(received.is_sorted() && received.last() == Some(&11), "{coupling:?}: {received:?}");
            }
        }
    }
}

/// The design with what agents of a kind give out on a port changed.
fn broken_agents(kind: &str, port: &str, change: impl Fn(&str) -> String) -> Source {
    let (mut source, mut found) = (source(), 0);
    let is_one = |name: &str| name == format!("{kind}.v") || name.starts_with(&format!("{kind}_"));
    for (_, text) in source.files.iter_mut().filter(|(name, _)| is_one(name)) {
        let start = format!(" {port} = ");
        let at = text.find(&start).unwrap() + start.len();
        // Names that are given to outputs stand side by side.
        let value = text[at..].split(';').next().unwrap();
        let end = at + value.split(", ").next().filter(|_| value.contains(" = ")).unwrap_or(value).len();
        let changed = change(&text[at..end]);
        text.replace_range(at..end, &changed);
        found += 1;
    }
    assert!(found > 0, "no {kind}");
    source
}

/// Sends frames through it until a rule is broken.
fn fault(source: &Source) -> String {
    let mut rig = Rig::new(source, Behaviour::hard(3), 3).unwrap();
    for number in 1..10 {
        rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
    }
    rig.finish().unwrap_err().to_string()
}

#[test]
fn broken_agents_are_found_out_by_the_rules_of_their_ports() {
    let cases = [
        ("write_agent", "dram_aw_addr_o", "+ 32'd4032", "crosses a 4 KiB boundary"),
        ("read_agent", "dram_ar_addr_o", "+ 32'd4", "inside of a word"),
        ("write_agent", "dram_w_last_o", "&& 1'b0", "the last word of a burst"),
        ("write_agent", "dram_aw_valid_o", "|| push_q", "dram_write, edge"),
    ];
    for (kind, port, change, rule) in cases {
        let found = fault(&broken_agents(kind, port, |value| format!("({value}) {change}")));
        assert!(found.contains(rule), "{kind} {port}: {found}");
    }
}

#[test]
fn a_writer_that_shows_what_it_still_writes_tears_frames() {
    let source = broken_agents("write_agent", "newest_o", |_| "target_q".into());
    let torn = (0..4).any(|seed| {
        let mut rig = Rig::new(&source, Behaviour::hard(seed), seed).unwrap();
        for number in 1..20 {
            rig.senders.iter_mut().for_each(|sender| sender.beats.extend(frame(number)));
        }
        rig.finish().unwrap();
        rig.numbers(0).is_err() || rig.numbers(1).is_err()
    });
    assert!(torn);
}

#[test]
fn the_agents_are_clean() {
    let waivers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../rtl/waivers.vlt");
    lint::clean(&plain(), Some(&waivers)).unwrap();
}
