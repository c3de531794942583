//! A block driven in rust-hdl's simulation, and the same stimulus through its Verilog.
use crate::support;
use edof_core::draw::Draw;
use edof_cosim::chain::second::with_random_memories;
use edof_cosim::verilator::{Library, Start};
use edof_cosim::{Layout, Rows, Source, icarus};
use edof_hdl::describe::Circuit;
use edof_hdl::leaves::LEAVES;
use edof_hdl::verilog::{self, Direction, Emitted};
use rust_hdl::core::atom::Atom;
use rust_hdl::core::probe::Probe;
use rust_hdl::prelude::*;
use std::collections::HashMap;

/// Cycles of each run.
const CYCLES: u64 = 3_000;

/// A block with a clock.
pub trait Clocked: Circuit {
    fn clock(&mut self) -> &mut Signal<In, Clock>;
}

/// Blocks whose clock is `clock`.
macro_rules! ported {
    ($($block:ty),*) => { $(impl $crate::differential::Clocked for $block {
        fn clock(&mut self) -> &mut Signal<In, Clock> {
            &mut self.clock
        }
    })* };
}
pub(crate) use ported;

/// A random word.
pub fn word<const N: usize>(draw: &mut Draw) -> Bits<N> {
    (draw.bits() >> (64 - N)).into()
}

/// Cycles of reset at the start of every stimulus.
pub const RESET: u64 = 64;

/// Whether a cycle is one of reset: all of the start, and later single ones.
pub fn resets(last: &Last, draw: &mut Draw) -> bool {
    last.cycle < RESET || last.cycle > CYCLES / 2 && draw.whole(0, 149) == 0
}

/// A random bit.
pub fn bit(draw: &mut Draw) -> bool {
    draw.whole(0, 1) == 1
}

/// What a driver may know: all ports as they were at the end of the cycle before, and what it counts.
#[derive(Default)]
pub struct Last {
    /// The cycle that is to be driven.
    pub cycle: u64,
    ports: HashMap<String, u64>,
    counts: HashMap<&'static str, u64>,
}

impl Last {
    /// Whether a port was high.
    pub fn is(&self, port: &str) -> bool {
        self.cycle > 0 && self.ports[port] == 1
    }

    /// What a port was.
    pub fn port(&self, port: &str) -> u64 {
        self.ports[port]
    }

    /// Whether these all were.
    pub fn all(&self, ports: &[&str]) -> bool {
        ports.iter().all(|port| self.is(port))
    }

    /// In how many cycles since the last reset something held. Each driver may count under several names, once a cycle each.
    pub fn count_of(&mut self, name: &'static str, holds: impl Fn(&Self) -> bool) -> u64 {
        let more = u64::from(self.cycle > 0 && holds(self));
        let resets = self.ports.get("reset") == Some(&1);
        let count = self.counts.entry(name).or_default();
        *count = if resets { 0 } else { *count + more };
        *count
    }

    /// [`Last::count_of`] under a first name.
    pub fn count(&mut self, holds: impl Fn(&Self) -> bool) -> u64 {
        self.count_of("first", holds)
    }

    /// [`Last::count_of`] under a second name.
    pub fn count_too(&mut self, holds: impl Fn(&Self) -> bool) -> u64 {
        self.count_of("second", holds)
    }
}

/// The ports of a block: signals one level below it, and those of bundles there, `bundle.signal`.
#[derive(Default)]
struct Ports {
    depth: usize,
    bundle: String,
    values: HashMap<String, u64>,
}

impl Probe for Ports {
    fn visit_start_scope(&mut self, _: &str, _: &dyn Block) {
        self.depth += 1;
    }

    fn visit_atom(&mut self, name: &str, signal: &dyn Atom) {
        if self.depth == 1 && signal.kind().is_parameter() {
            let literal = format!("{:x}", signal.verilog());
            let digits = literal.rsplit("'h").next().unwrap();
            self.values.insert(format!("{}{name}", self.bundle), u64::from_str_radix(digits, 16).unwrap());
        }
    }

    fn visit_start_namespace(&mut self, name: &str, _: &dyn Block) {
        self.bundle = format!("{name}.");
    }

    fn visit_end_namespace(&mut self, _: &str, _: &dyn Block) {
        self.bundle.clear();
    }

    fn visit_end_scope(&mut self, _: &str, _: &dyn Block) {
        self.depth -= 1;
    }
}

fn ports(block: &dyn Block) -> HashMap<String, u64> {
    let mut ports = Ports::default();
    block.accept("top", &mut ports);
    ports.values
}

fn settle(block: &mut impl Clocked) {
    assert!(simulate(block, 100), "the circuit does not settle");
}

/// Drives a block for some thousand cycles; from `compared_from` on all outputs must agree, those of `qualified` where the other
/// port named there is high.
pub fn agree<B: Clocked>(
    block: B,
    compared_from: usize,
    qualified: &[(&str, &str)],
    drive: impl FnMut(&mut B, &mut Draw, &mut Last),
) {
    agree_with_images(block, compared_from, qualified, &[], drive);
}

/// [`agree`] for a block with memory images.
pub fn agree_with_images<B: Clocked>(
    mut block: B,
    compared_from: usize,
    qualified: &[(&str, &str)],
    images: &[(String, String)],
    mut drive: impl FnMut(&mut B, &mut Draw, &mut Last),
) {
    block.connect_all();
    let emitted = verilog::emit(&block).unwrap();
    let leaf =
        |name: &str| LEAVES.iter().find(|(leaf, _)| *leaf == name).map(|(_, text)| (*text).to_string());
    let source = Source::emitted(&emitted, leaf).unwrap();
    let (inputs, outputs) = (Layout::inputs(&source), Layout::outputs(&source));
    let (mut stimulus, mut expected) = (Rows::new(inputs.words()), Rows::new(outputs.words()));
    let (mut last, draw) = (Last::default(), &mut Draw::new(1));
    for cycle in 0..CYCLES {
        last.cycle = cycle;
        drive(&mut block, draw, &mut last);
        settle(&mut block);
        last.ports = ports(&block);
        record(&emitted, &source, &last.ports, &mut stimulus, &mut expected);
        block.clock().next = Clock { clk: true };
        settle(&mut block);
        block.clock().next = Clock { clk: false };
        settle(&mut block);
    }

    let dir = tempfile::tempdir().unwrap();
    for (name, text) in images {
        let path = dir.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let library = Library::build(&source, &support::options()).unwrap();
    let start = Start { seed: 3, memory_dir: Some(dir.path().into()) };
    let verilator = library.start(&start).unwrap().run(&stimulus).unwrap();
    let icarus = icarus::run(&with_random_memories(source.clone()), &stimulus, Some(dir.path())).unwrap();
    for cycle in compared_from..stimulus.len() {
        for port in emitted.ports.iter().filter(|port| port.direction == Direction::Output) {
            let at = |rows: &Rows, field: &str| {
                let name = &emitted.ports.iter().find(|port| port.field == field).unwrap().name;
                outputs.get(rows.row(cycle), source.port(name).unwrap()).unwrap()
            };
            let qualifier = qualified.iter().find(|(name, _)| *name == port.field);
            if qualifier.is_some_and(|(_, valid)| at(&expected, valid) == 0) {
                continue;
            }
            let [rust, verilator, icarus, unknown] =
                [&expected, &verilator, &icarus.values, &icarus.unknown].map(|rows| at(rows, &port.field));
            let name = format!("{}.{} in cycle {cycle}", emitted.top, port.field);
            assert_eq!(
                (verilator, icarus, unknown),
                (rust, rust, 0),
                "{name}: Verilator, Icarus, unknown bits"
            );
        }
    }
}

/// A row of inputs and one of outputs.
fn record(
    emitted: &Emitted,
    source: &Source,
    values: &HashMap<String, u64>,
    stimulus: &mut Rows,
    expected: &mut Rows,
) {
    let (inputs, outputs) = (Layout::inputs(source), Layout::outputs(source));
    let (given, seen) = (stimulus.push_zeros(), expected.push_zeros());
    for (index, port) in emitted.ports.iter().enumerate().filter(|(_, port)| !port.is_clock) {
        let value = values[&port.field];
        match port.direction {
            Direction::Input => inputs.put(given, index, value).unwrap(),
            Direction::Output => outputs.put(seen, index, value).unwrap(),
        }
    }
}
