//! Clock-domain crossings: unrelated clocks, changes seen one edge later at random, resets at any time.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::bench::{Actor, Beat, Bench, ClockId, Receiver, Sender, Throttle};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_hdl::crossing::reset_sync::RESET_CYCLES;
use edof_hdl::crossing::{BusSync, PixelFifo, PulseSync, ResetSync, Sync};
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;

/// Periods in picoseconds: the board's own, nearly equal ones, and far apart ones.
pub const PERIODS: [(u64, u64); 4] = [(6_734, 5_000), (5_000, 6_734), (5_000, 5_001), (21_000, 3_000)];

fn source(mut block: impl Circuit) -> Source {
    Source::circuit(&mut block).unwrap()
}

fn bench(source: &Source, seed: u64) -> Bench {
    let library = Library::build(source, &support::options()).unwrap();
    Bench::new(library.start(&Start { seed, ..Start::default() }).unwrap(), seed)
}

/// Beats with random words and marks.
fn beats(count: usize, seed: u64) -> Vec<Beat> {
    let draw = &mut Draw::new(seed);
    let beat =
        |_| Beat { data: draw.bits() & 0xffff, user: draw.whole(0, 9) == 0, last: draw.whole(0, 9) == 0 };
    (0..count).map(beat).collect()
}

/// Sends beats through the FIFO of `source`, with a reset before and, if `again`, one in between; gives what was sent after the last
/// reset, and what came then.
fn through_fifo(
    source: &Source,
    periods: (u64, u64),
    seed: u64,
    resets: bool,
) -> Result<(Vec<Beat>, Vec<Beat>), Error> {
    let mut bench = bench(source, seed);
    let from = bench.clock("from_clock_i", periods.0)?;
    let to = bench.clock("to_clock_i", periods.1)?;
    let mut sender = Sender::new(source, "from", from, "from_reset_i", Throttle::drawn(seed))?;
    let mut receiver = Receiver::new(source, "to", to, "to_reset_i", Throttle::drawn(seed + 1))?;
    let reset = |bench: &mut Bench, sender: &mut Sender, receiver: &mut Receiver| {
        for level in [1, 0] {
            bench.set("from_reset_i", level)?;
            bench.set("to_reset_i", level)?;
            bench.steps(150, &mut [sender, receiver])?;
        }
        Ok::<(), Error>(())
    };
    reset(&mut bench, &mut sender, &mut receiver)?;
    if resets {
        sender.beats = beats(500, seed).into();
        bench.steps(200 + seed as usize % 300, &mut [&mut sender, &mut receiver])?;
        sender.beats.clear();
        reset(&mut bench, &mut sender, &mut receiver)?;
        receiver.beats.clear();
    }
    let sent = beats(1_500, seed + 2);
    sender.beats = sent.clone().into();
    for _ in 0..200_000 {
        if receiver.beats.len() >= sent.len() {
            break;
        }
        bench.step(&mut [&mut sender, &mut receiver])?;
    }
    bench.steps(100, &mut [&mut sender, &mut receiver])?;
    Ok((sent, receiver.beats))
}

#[test]
fn a_fifo_hands_on_every_word_once_and_in_order() {
    for log_depth in [2, 4] {
        let source = source(PixelFifo::new(log_depth)).metastable();
        for (seed, periods) in (0..).zip(PERIODS) {
            let (sent, came) = through_fifo(&source, periods, seed, false).unwrap();
            assert_eq!(came, sent, "2^{log_depth} words, {periods:?}");
        }
    }
}

#[test]
fn a_fifo_works_anew_after_a_reset_at_any_moment() {
    let source = source(PixelFifo::new(3)).metastable();
    for seed in 0..12 {
        let (sent, came) = through_fifo(&source, PERIODS[seed as usize % 4], seed, true).unwrap();
        assert_eq!(came, sent, "seed {seed}");
    }
}

/// The same design with text of a leaf replaced that is there exactly once.
pub fn altered(mut source: Source, file: &str, replace: &[(&str, &str)]) -> Source {
    let (_, text) = source.files.iter_mut().find(|(name, _)| name == file).unwrap();
    for (from, to) in replace {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        *text = text.replace(from, to);
    }
    source
}

#[test]
fn a_fifo_that_overruns_is_found_out() {
    let full = ("write_gray_q != (read_gray_seen ^ TOP_TWO)", "1'b1");
    let source = altered(source(PixelFifo::new(3)), "edof_async_fifo.v", &[full]);
    let (sent, came) = through_fifo(&source, PERIODS[1], 1, false).unwrap();
    assert_ne!(came, sent);
}

/// The leaf `edof_pulse_sync` in a module of its own.
#[derive(Circuit)]
#[circuit(default(PulseSync))]
struct PulseTop {
    pub from_clock: Signal<In, Clock>,
    pub to_clock: Signal<In, Clock>,
    pub from_reset: Signal<In, Bit>,
    pub to_reset: Signal<In, Bit>,
    pub pulse: Signal<In, Bit>,
    pub ready: Signal<Out, Bit>,
    pub arrives: Signal<Out, Bit>,
    leaf: PulseSync,
}

impl Logic for PulseTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.leaf.from_clock.next = self.from_clock.val();
        self.leaf.from_reset.next = self.from_reset.val();
        self.leaf.pulse.next = self.pulse.val();
        self.ready.next = self.leaf.ready.val();
        self.leaf.to_clock.next = self.to_clock.val();
        self.leaf.to_reset.next = self.to_reset.val();
        self.arrives.next = self.leaf.arrives.val();
    }
}

/// The leaf `edof_bus_sync` in a module of its own.
#[derive(Circuit)]
#[circuit(default(BusSync))]
struct BusTop {
    pub from_clock: Signal<In, Clock>,
    pub to_clock: Signal<In, Clock>,
    pub from_reset: Signal<In, Bit>,
    pub to_reset: Signal<In, Bit>,
    pub valid: Signal<In, Bit>,
    pub ready: Signal<Out, Bit>,
    pub word: Signal<In, Bits<24>>,
    pub arrives: Signal<Out, Bit>,
    pub arrived: Signal<Out, Bits<24>>,
    leaf: BusSync<24>,
}

impl Logic for BusTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.leaf.from_clock.next = self.from_clock.val();
        self.leaf.from_reset.next = self.from_reset.val();
        self.leaf.valid.next = self.valid.val();
        self.leaf.word.next = self.word.val();
        self.ready.next = self.leaf.ready.val();
        self.leaf.to_clock.next = self.to_clock.val();
        self.leaf.to_reset.next = self.to_reset.val();
        self.arrives.next = self.leaf.arrives.val();
        self.arrived.next = self.leaf.arrived.val();
    }
}

/// The leaves `edof_sync` and `edof_reset_sync` in a module of their own.
#[derive(Circuit)]
#[circuit(default(Sync, ResetSync))]
struct LevelTop {
    pub clock: Signal<In, Clock>,
    pub from: Signal<In, Bits<3>>,
    pub to: Signal<Out, Bits<3>>,
    pub reset: Signal<In, Bit>,
    pub domain_reset: Signal<Out, Bit>,
    sync: Sync<3>,
    reset_sync: ResetSync,
}

impl Logic for LevelTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.sync.clock.next = self.clock.val();
        self.sync.from.next = self.from.val();
        self.to.next = self.sync.to.val();
        self.reset_sync.clock.next = self.clock.val();
        self.reset_sync.reset.next = self.reset.val();
        self.domain_reset.next = self.reset_sync.domain_reset.val();
    }
}

/// Gives pulses, with a word where the leaf takes one, when it likes; a word that nobody takes changes in the next cycle.
pub struct PulseSource {
    clock: ClockId,
    /// Valid, ready, reset.
    ports: [usize; 3],
    word: Option<usize>,
    draw: Draw,
    /// How many words were offered.
    offered: u64,
    /// Whether the source still sends.
    pub talks: bool,
    /// What was taken.
    pub taken: Vec<u64>,
}

impl PulseSource {
    pub fn new(clock: ClockId, ports: [usize; 3], word: Option<usize>, seed: u64) -> Self {
        Self { clock, ports, word, draw: Draw::new(seed), offered: 0, talks: true, taken: vec![] }
    }
}

impl Actor for PulseSource {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let [valid, ready, reset] = self.ports;
        if model.peek(valid)? == 1 && model.peek(ready)? == 1 && model.peek(reset)? == 0 {
            let word = self.word.map_or(Ok(0), |word| model.peek(word))?;
            self.taken.push(word);
        }
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let offers = self.talks && self.draw.whole(0, 3) > 0;
        model.poke(self.ports[0], offers.into())?;
        // The multiplier is odd, so no two of 2^24 words are the same.
        self.offered += 1;
        self.word.map_or(Ok(()), |word| model.poke(word, (self.offered * 0x9e_3779) & 0xff_ffff))
    }
}

/// Notes what arrives.
pub struct Listener {
    clock: ClockId,
    /// Arrives, reset.
    ports: [usize; 2],
    word: Option<usize>,
    /// What arrived.
    pub came: Vec<u64>,
}

impl Listener {
    pub fn new(clock: ClockId, ports: [usize; 2], word: Option<usize>) -> Self {
        Self { clock, ports, word, came: vec![] }
    }
}

impl Actor for Listener {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let [arrives, reset] = self.ports;
        if model.peek(arrives)? == 1 && model.peek(reset)? == 0 {
            let word = self.word.map_or(Ok(0), |word| model.peek(word))?;
            self.came.push(word);
        }
        Ok(())
    }

    fn after(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }
}

/// What a handshake took, and what arrived.
fn through_handshake(source: &Source, offer: &str, periods: (u64, u64), seed: u64) -> (Vec<u64>, Vec<u64>) {
    let mut bench = bench(source, seed);
    let port = |name: &str| source.port(name).unwrap();
    let from = bench.clock("from_clock_i", periods.0).unwrap();
    let to = bench.clock("to_clock_i", periods.1).unwrap();
    let ports = [port(offer), port("ready_o"), port("from_reset_i")];
    let word = source.port("word_i").ok();
    let mut talker = PulseSource::new(from, ports, word, seed);
    let (ports, word) = ([port("arrives_o"), port("to_reset_i")], source.port("arrived_o").ok());
    let mut listener = Listener::new(to, ports, word);
    for (reset, talks, edges) in [(1, true, 200), (0, true, 20_000), (0, false, 300)] {
        bench.set("from_reset_i", reset).unwrap();
        bench.set("to_reset_i", reset).unwrap();
        talker.talks = talks;
        bench.steps(edges, &mut [&mut talker, &mut listener]).unwrap();
    }
    (talker.taken, listener.came)
}

#[test]
fn pulses_arrive_one_for_one() {
    let source = source(PulseTop::default()).metastable();
    for (seed, periods) in (0..).zip(PERIODS) {
        let (taken, came) = through_handshake(&source, "pulse_i", periods, seed);
        assert!(taken.len() > 100, "{periods:?}: only {} pulses", taken.len());
        assert_eq!(came.len(), taken.len(), "{periods:?}");
    }
}

#[test]
fn words_arrive_whole_and_once() {
    let source = source(BusTop::default()).metastable();
    for (seed, periods) in (0..).zip(PERIODS) {
        let (taken, came) = through_handshake(&source, "valid_i", periods, seed);
        assert!(taken.len() > 100, "{periods:?}: only {} words", taken.len());
        assert_eq!(came, taken, "{periods:?}");
    }
}

#[test]
fn a_word_that_is_not_held_is_found_out() {
    let held = [("if (arrival) word_q <= held_q;", "if (arrival) word_q <= word_i;")];
    let source = altered(source(BusTop::default()), "edof_bus_sync.v", &held);
    let (taken, came) = through_handshake(&source, "valid_i", PERIODS[0], 1);
    assert_ne!(came, taken);
}

#[test]
fn a_word_that_is_synchronised_bit_by_bit_is_found_out_at_random_alone() {
    let seen = "wire [WIDTH-1:0] word_seen;
    edof_sync #(.WIDTH(WIDTH)) words (.clock_i(to_clock_i), .from_i(held_q), .to_o(word_seen));
    assign word_o = word_q;";
    let replace = [
        ("if (arrival) word_q <= held_q;", "if (arrival) word_q <= word_seen;"),
        ("assign word_o = word_q;", seen),
    ];
    let source = altered(source(BusTop::default()), "edof_bus_sync.v", &replace);
    let is_right = |source: &Source| {
        PERIODS.iter().all(|periods| {
            let (taken, came) = through_handshake(source, "valid_i", *periods, 1);
            taken == came
        })
    };
    assert!(is_right(&source), "two-state simulation sees nothing wrong");
    assert!(!is_right(&source.metastable()));
}

#[test]
fn a_level_arrives_in_the_second_or_third_cycle() {
    let source = source(LevelTop::default()).metastable();
    let mut bench = bench(&source, 5);
    bench.clock("clock_i", 5_000).unwrap();
    let (mut seen, draw) = ([0; 5], &mut Draw::new(5));
    // What the synchroniser held at the start passes through.
    bench.steps(3, &mut []).unwrap();
    for _ in 0..300 {
        let before = bench.get("to_o").unwrap();
        let level = before ^ draw.whole(1, 7) as u64;
        bench.set("from_i", level).unwrap();
        let (mut cycles, mut values) = (0, vec![]);
        while bench.get("to_o").unwrap() != level {
            bench.step(&mut []).unwrap();
            values.push(bench.get("to_o").unwrap());
            cycles += 1;
            assert!(cycles <= 3, "still {values:?}, not {level}");
        }
        assert!(
            values.iter().all(|value| (value ^ before) & !(level ^ before) == 0),
            "a bit that did not change did"
        );
        seen[cycles] += 1;
        bench.steps(3, &mut []).unwrap();
    }
    assert!(seen[2] > 20 && seen[3] > 20, "after so many cycles: {seen:?}");
}

/// Whether a counter that goes up by two or fewer in a cycle of its reader is seen as one of the numbers that it had in the last three cycles.
fn is_seen_as_it_was(code: impl Fn(u64) -> u64, decode: impl Fn(u64) -> u64) -> bool {
    let source = source(LevelTop::default()).metastable();
    let (mut bench, draw) = (bench(&source, 7), &mut Draw::new(7));
    bench.clock("clock_i", 5_000).unwrap();
    bench.set("from_i", 0).unwrap();
    bench.steps(4, &mut []).unwrap();
    let (mut number, mut steps) = (0, [0; 3]);
    (0..2_000).all(|cycle| {
        steps[cycle % 3] = draw.whole(0, 2) as u64;
        for _ in 0..steps[cycle % 3] {
            number = (number + 1) % 8;
            bench.set("from_i", code(number)).unwrap();
            bench.get("to_o").unwrap();
        }
        bench.step(&mut []).unwrap();
        let behind = (number + 8 - decode(bench.get("to_o").unwrap())) % 8;
        behind <= steps.iter().sum::<u64>()
    })
}

#[test]
fn a_gray_code_that_outruns_its_reader_is_seen_as_it_was_and_a_binary_one_is_not() {
    let gray = |number: u64| number ^ number >> 1;
    assert!(is_seen_as_it_was(gray, |code| code ^ code >> 1 ^ code >> 2));
    assert!(!is_seen_as_it_was(|number| number, |code| code));
}

#[test]
fn a_reset_is_caught_while_the_clock_stands_and_lasts_long_enough() {
    let source = source(LevelTop::default());
    let mut bench = bench(&source, 6);
    let clock = bench.clock("clock_i", 5_000).unwrap();
    let release = |bench: &mut Bench| {
        let mut cycles = 0;
        while bench.get("domain_reset_o").unwrap() == 1 {
            bench.step(&mut []).unwrap();
            cycles += 1;
            assert!(cycles < 100, "the reset does not end");
        }
        cycles
    };
    assert!(release(&mut bench) >= RESET_CYCLES, "the reset at power-up is too short");
    bench.run_clock(clock, false);
    for level in [1, 0] {
        bench.set("reset_i", level).unwrap();
        bench.get("domain_reset_o").unwrap();
    }
    bench.run_clock(clock, true);
    bench.steps(2, &mut []).unwrap();
    assert!(release(&mut bench) >= RESET_CYCLES - 2, "the reset was not caught, or is too short");
}

/// A block of two clocks, for comparison with its model.
trait TwoClocks: Circuit {
    fn clocks(&mut self) -> [&mut Signal<In, Clock>; 2];
    fn drive(&mut self, draw: &mut Draw, resets: bool);
    /// Outputs, and whether the last one means something.
    fn outputs(&self) -> (Vec<u64>, bool);
}

impl TwoClocks for PixelFifo {
    fn clocks(&mut self) -> [&mut Signal<In, Clock>; 2] {
        [&mut self.from_clock, &mut self.to_clock]
    }

    fn drive(&mut self, draw: &mut Draw, resets: bool) {
        self.from_reset.next = resets;
        self.to_reset.next = resets;
        self.from.valid.next = draw.whole(0, 1) == 1;
        self.from.data.next = (draw.bits() & 0xffff).into();
        self.to.ready.next = draw.whole(0, 1) == 1;
    }

    fn outputs(&self) -> (Vec<u64>, bool) {
        let (ready, valid, data) = (self.from.ready.val(), self.to.valid.val(), self.to.data.val());
        (vec![ready.into(), valid.into(), data.to_u64()], valid)
    }
}

impl TwoClocks for PulseTop {
    fn clocks(&mut self) -> [&mut Signal<In, Clock>; 2] {
        [&mut self.from_clock, &mut self.to_clock]
    }

    fn drive(&mut self, draw: &mut Draw, resets: bool) {
        self.from_reset.next = resets;
        self.to_reset.next = resets;
        self.pulse.next = draw.whole(0, 3) > 0;
    }

    fn outputs(&self) -> (Vec<u64>, bool) {
        (vec![self.ready.val().into(), self.arrives.val().into()], true)
    }
}

impl TwoClocks for BusTop {
    fn clocks(&mut self) -> [&mut Signal<In, Clock>; 2] {
        [&mut self.from_clock, &mut self.to_clock]
    }

    fn drive(&mut self, draw: &mut Draw, resets: bool) {
        self.from_reset.next = resets;
        self.to_reset.next = resets;
        self.valid.next = draw.whole(0, 3) > 0;
        self.word.next = (draw.bits() & 0xff_ffff).into();
    }

    fn outputs(&self) -> (Vec<u64>, bool) {
        let word = self.arrived.val().to_u64();
        (vec![self.ready.val().into(), self.arrives.val().into(), word], true)
    }
}

/// The same inputs and edges through the model and through Verilog: the same outputs.
fn model_agrees<B: TwoClocks>(mut block: B, inputs: fn(&B) -> Vec<(&'static str, u64)>, outputs: &[&str]) {
    let source = Source::circuit(&mut block).unwrap();
    let library = Library::build(&source, &support::options()).unwrap();
    let mut model = library.start(&Start { seed: 11, ..Start::default() }).unwrap();
    let clocks = ["from_clock_i", "to_clock_i"].map(|port| source.port(port).unwrap());
    let ports: Vec<usize> = outputs.iter().map(|port| source.port(port).unwrap()).collect();
    let draw = &mut Draw::new(11);
    for edge in 0..4_000 {
        block.drive(draw, edge < 60);
        assert!(simulate(&mut block, 100));
        inputs(&block)
            .iter()
            .for_each(|(port, value)| model.poke(source.port(port).unwrap(), *value).unwrap());
        let (expected, is_whole) = block.outputs();
        if edge >= 60 {
            let compared = ports.len() - usize::from(!is_whole);
            let found: Vec<u64> = ports.iter().map(|port| model.peek(*port).unwrap()).collect();
            assert_eq!(found[..compared], expected[..compared], "edge {edge}");
        }
        let rising = [vec![0], vec![1], vec![0, 1]][draw.whole(0, 2) as usize].clone();
        for level in [true, false] {
            rising.iter().for_each(|i| block.clocks()[*i].next = Clock { clk: level });
            assert!(simulate(&mut block, 100));
        }
        model.rise(&rising.iter().map(|i| clocks[*i]).collect::<Vec<_>>()).unwrap();
    }
}

#[test]
fn models_and_leaves_agree_in_every_cycle() {
    model_agrees(
        PixelFifo::new(2),
        |b| {
            vec![
                ("from_reset_i", b.from_reset.val().into()),
                ("to_reset_i", b.to_reset.val().into()),
                ("from_valid_i", b.from.valid.val().into()),
                ("from_data_i", b.from.data.val().to_u64()),
                ("to_ready_i", b.to.ready.val().into()),
            ]
        },
        &["from_ready_o", "to_valid_o", "to_data_o"],
    );
    model_agrees(
        PulseTop::default(),
        |b| {
            let reset = u64::from(b.from_reset.val());
            vec![("from_reset_i", reset), ("to_reset_i", reset), ("pulse_i", b.pulse.val().into())]
        },
        &["ready_o", "arrives_o"],
    );
    model_agrees(
        BusTop::default(),
        |b| {
            let (reset, word) = (u64::from(b.from_reset.val()), b.word.val().to_u64());
            let valid = b.valid.val().into();
            vec![("from_reset_i", reset), ("to_reset_i", reset), ("valid_i", valid), ("word_i", word)]
        },
        &["ready_o", "arrives_o", "arrived_o"],
    );
}
