//! Resets of clock-domain crossings while a clock stands still: of either domain or of both, in any order, and never a phantom word.

use crate::crossing::{Listener, PERIODS, PulseSource, altered};
use crate::support;
use edof_core::draw::Draw;
use edof_cosim::Source;
use edof_cosim::bench::{Actor, Beat, Bench, ClockId, Receiver, Sender, Throttle};
use edof_cosim::verilator::{Library, Start};
use edof_hdl::crossing::{BusSync, PixelFifo, PulseSync, ResetSync};
use edof_hdl::ports::{StreamIn, StreamOut};
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;

/// A crossing of each kind between two domains, each with its own request for a reset.
#[derive(Circuit)]
#[circuit(default(ResetSync, BusSync, PulseSync))]
struct Crossings {
    pub from_clock: Signal<In, Clock>,
    pub to_clock: Signal<In, Clock>,
    pub from_request: Signal<In, Bit>,
    pub to_request: Signal<In, Bit>,
    pub from_reset: Signal<Out, Bit>,
    pub to_reset: Signal<Out, Bit>,
    pub from: StreamIn<16>,
    pub to: StreamOut<16>,
    pub word_valid: Signal<In, Bit>,
    pub word_ready: Signal<Out, Bit>,
    pub word: Signal<In, Bits<24>>,
    pub word_arrives: Signal<Out, Bit>,
    pub arrived: Signal<Out, Bits<24>>,
    pub pulse: Signal<In, Bit>,
    pub pulse_ready: Signal<Out, Bit>,
    pub pulse_arrives: Signal<Out, Bit>,
    from_domain: ResetSync,
    to_domain: ResetSync,
    fifo: PixelFifo,
    bus: BusSync<24>,
    pulses: PulseSync,
}

impl Logic for Crossings {
    #[hdl_gen]
    fn update(&mut self) {
        self.from_domain.clock.next = self.from_clock.val();
        self.from_domain.reset.next = self.from_request.val();
        self.from_reset.next = self.from_domain.domain_reset.val();
        self.to_domain.clock.next = self.to_clock.val();
        self.to_domain.reset.next = self.to_request.val();
        self.to_reset.next = self.to_domain.domain_reset.val();

        self.fifo.from_clock.next = self.from_clock.val();
        self.fifo.from_reset.next = self.from_domain.domain_reset.val();
        self.fifo.to_clock.next = self.to_clock.val();
        self.fifo.to_reset.next = self.to_domain.domain_reset.val();
        StreamIn::<16>::link(&mut self.from, &mut self.fifo.from);
        StreamOut::<16>::link(&mut self.to, &mut self.fifo.to);

        self.bus.from_clock.next = self.from_clock.val();
        self.bus.from_reset.next = self.from_domain.domain_reset.val();
        self.bus.valid.next = self.word_valid.val();
        self.bus.word.next = self.word.val();
        self.word_ready.next = self.bus.ready.val();
        self.bus.to_clock.next = self.to_clock.val();
        self.bus.to_reset.next = self.to_domain.domain_reset.val();
        self.word_arrives.next = self.bus.arrives.val();
        self.arrived.next = self.bus.arrived.val();

        self.pulses.from_clock.next = self.from_clock.val();
        self.pulses.from_reset.next = self.from_domain.domain_reset.val();
        self.pulses.pulse.next = self.pulse.val();
        self.pulse_ready.next = self.pulses.ready.val();
        self.pulses.to_clock.next = self.to_clock.val();
        self.pulses.to_reset.next = self.to_domain.domain_reset.val();
        self.pulse_arrives.next = self.pulses.arrives.val();
    }
}

fn source() -> Source {
    let mut block = Crossings::from_parts(CrossingsParts { fifo: PixelFifo::new(3) });
    Source::circuit(&mut block).unwrap().metastable()
}

/// How many were taken, and how many arrived, on each of the three crossings.
type Counts = [(usize, usize); 3];

/// Both domains, who sends, and who receives.
struct Rig {
    bench: Bench,
    clocks: [ClockId; 2],
    sender: Sender,
    receiver: Receiver,
    talkers: [PulseSource; 2],
    listeners: [Listener; 2],
    /// At each rise of the receiver's reset: what had been taken and what had arrived by then.
    marks: Vec<Counts>,
}

impl Rig {
    fn new(library: &Library, seed: u64) -> Self {
        let source = library.source();
        let mut bench = Bench::new(library.start(&Start { seed, ..Start::default() }).unwrap(), seed);
        let periods = PERIODS[seed as usize % PERIODS.len()];
        let from = bench.clock("from_clock_i", periods.0).unwrap();
        let to = bench.clock("to_clock_i", periods.1).unwrap();
        let mut sender = Sender::new(source, "from", from, "from_reset_o", Throttle::drawn(seed)).unwrap();
        sender.beats = (0..60_000).map(|data| Beat { data, user: false, last: false }).collect();
        let receiver = Receiver::new(source, "to", to, "to_reset_o", Throttle::drawn(seed + 1)).unwrap();
        let port = |name: &str| source.port(name).unwrap();
        let talker = |names: [&str; 2], word: Option<&str>| {
            PulseSource::new(
                from,
                [port(names[0]), port(names[1]), port("from_reset_o")],
                word.map(port),
                seed,
            )
        };
        let listener = |name: &str, word: Option<&str>| {
            Listener::new(to, [port(name), port("to_reset_o")], word.map(port))
        };
        let talkers = [
            talker(["word_valid_i", "word_ready_o"], Some("word_i")),
            talker(["pulse_i", "pulse_ready_o"], None),
        ];
        let listeners = [listener("word_arrives_o", Some("arrived_o")), listener("pulse_arrives_o", None)];
        let clocks = [from, to];
        Self { bench, clocks, sender, receiver, talkers, listeners, marks: vec![] }
    }

    fn counts(&self) -> Counts {
        let ([words, pulses], [came, rang]) = (&self.talkers, &self.listeners);
        [
            (self.sender.sent, self.receiver.beats.len()),
            (words.taken.len(), came.came.len()),
            (pulses.taken.len(), rang.came.len()),
        ]
    }

    fn steps(&mut self, edges: usize) {
        for _ in 0..edges {
            let before = (self.bench.get("to_reset_o").unwrap(), self.counts());
            let ([words, pulses], [came, rang]) = (&mut self.talkers, &mut self.listeners);
            let actors: &mut [&mut dyn Actor] =
                &mut [&mut self.sender, &mut self.receiver, words, pulses, came, rang];
            self.bench.step(actors).unwrap();
            if before.0 == 0 && self.bench.get("to_reset_o").unwrap() == 1 {
                // What was taken before the edge, and what arrived with it.
                let after = self.counts();
                self.marks.push(std::array::from_fn(|i| (before.1[i].0, after[i].1)));
            }
        }
    }

    fn request(&mut self, domains: [bool; 2], level: u64) {
        for (port, _) in ["from_request_i", "to_request_i"].iter().zip(domains).filter(|(_, is)| *is) {
            self.bench.set(port, level).unwrap();
            // Seen at once: no clock is needed.
            self.bench.get("to_reset_o").unwrap();
        }
    }

    /// Traffic, a reset of one domain or both while none, one or (for a moment) both clocks stand still, then traffic again.
    fn disturb(&mut self, draw: &mut Draw) {
        let domains = [[true, true], [true, false], [false, true]][draw.whole(0, 2) as usize];
        let stands = [[false, false], [true, false], [false, true]][draw.whole(0, 2) as usize];
        self.steps(draw.whole(1, 300) as usize);
        for (clock, _) in self.clocks.into_iter().zip(stands).filter(|(_, stands)| *stands) {
            self.bench.run_clock(clock, false);
        }
        self.steps(draw.whole(0, 60) as usize);
        self.request(domains, 1);
        self.steps(draw.whole(0, 40) as usize);
        self.request(domains, 0);
        self.steps(draw.whole(0, 200) as usize);
        self.clocks.into_iter().for_each(|clock| self.bench.run_clock(clock, true));
        self.steps(draw.whole(0, 300) as usize);
    }

    /// Places of the words that arrived among those that were taken, on the two crossings that carry words.
    fn places(&self) -> [Vec<usize>; 2] {
        let numbers = self.receiver.beats.iter().map(|beat| beat.data as usize).collect();
        let taken = &self.talkers[0].taken;
        let place = |word: &u64| taken.iter().position(|taken| taken == word).unwrap_or(usize::MAX);
        [numbers, self.listeners[0].came.iter().map(place).collect()]
    }

    /// What is wrong with what arrived.
    fn fault(&mut self) -> Option<String> {
        // Both clocks run and no domain is in reset: from here on nothing is lost.
        self.steps(1_500);
        let quiet = self.counts();
        self.steps(1_500);
        self.sender.beats.clear();
        self.talkers.iter_mut().for_each(|talker| talker.talks = false);
        self.steps(600);
        for (crossing, places) in self.places().iter().enumerate() {
            if !places.windows(2).all(|pair| pair[0] < pair[1]) {
                return Some(format!("crossing {crossing}: a word came twice, or none that was sent"));
            }
            let (taken, _) = quiet[crossing];
            let last = places.iter().filter(|place| **place >= taken).count();
            if last != self.counts()[crossing].0 - taken || last == 0 {
                return Some(format!("crossing {crossing}: words are lost after the resets, {last} came"));
            }
            for mark in &self.marks {
                let (taken, came) = mark[crossing];
                if places[came..].iter().any(|place| *place < taken) {
                    return Some(format!(
                        "crossing {crossing}: a word from before the receiver's reset came"
                    ));
                }
            }
        }
        let (taken, came) = self.counts()[2];
        let early = self.marks.iter().any(|mark| came - mark[2].1 > taken - mark[2].0);
        early.then(|| "pulses: more came after the receiver's reset than were given".to_string())
    }
}

/// The first fault of a number of runs, each with its own seed.
fn first_fault(source: &Source, runs: u64) -> Option<String> {
    let library = Library::build(source, &support::options()).unwrap();
    (0..runs).find_map(|seed| {
        let (mut rig, draw) = (Rig::new(&library, seed), &mut Draw::new(seed));
        rig.steps(400);
        (0..3).for_each(|_| rig.disturb(draw));
        rig.fault().map(|fault| format!("seed {seed}: {fault}"))
    })
}

#[test]
fn a_reset_of_any_domain_while_a_clock_stands_gives_no_phantom_word() {
    assert_eq!(first_fault(&source(), 150), None);
}

#[test]
fn a_crossing_stays_closed_while_the_other_clock_stands_after_a_reset() {
    let library = Library::build(&source(), &support::options()).unwrap();
    for (seed, stopped) in (0..8).zip([0, 1].into_iter().cycle()) {
        let mut rig = Rig::new(&library, seed);
        rig.steps(500);
        rig.bench.run_clock(rig.clocks[stopped], false);
        rig.request([true; 2], 1);
        rig.steps(10);
        rig.request([true; 2], 0);
        rig.steps(100);
        let before = rig.counts();
        rig.steps(2_000);
        assert_eq!(rig.counts(), before, "clock {stopped} stands");
        rig.bench.run_clock(rig.clocks[stopped], true);
        assert_eq!(rig.fault(), None, "clock {stopped} stood");
    }
}

#[test]
fn a_crossing_that_clears_before_the_other_side_is_closed_is_found_out() {
    for (from, to) in [
        ("assign from_clear_o = cleared_q[0];", "assign from_clear_o = from_reset_i;"),
        ("assign to_clear_o = ack_q;", "assign to_clear_o = to_reset_i;"),
        ("(restart || !ack_seen) ? 4'd0", "restart ? 4'd0"),
    ] {
        let broken = altered(source(), "edof_clear.v", &[(from, to)]);
        let fault = first_fault(&broken, 400);
        assert!(fault.is_some(), "{to}");
    }
}
