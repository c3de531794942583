//! A circuit in three simulations on one stimulus.

use crate::drive::{Harness, Random};
use crate::simulator::{Bench, Known, Simulator};
use crate::{rust, shrink};
use edof_verilog::describe::Circuit;
use edof_verilog::{Direction, EmitError, Port};
use std::fmt;

/// How a circuit is checked.
#[derive(Debug, Clone)]
pub struct Check {
    /// Cycles in all.
    pub cycles: usize,
    /// Seed of the stimulus.
    pub seed: u64,
    /// The field that resets the circuit: 1 in the first cycles, then now and then.
    pub reset: Option<&'static str>,
    /// Cycles before outputs are compared; the reset holds in them.
    pub reset_cycles: usize,
    /// Where the Verilog runs.
    pub simulators: Vec<Simulator>,
}

impl Default for Check {
    fn default() -> Self {
        Self {
            cycles: 1_000,
            seed: 1,
            reset: None,
            reset_cycles: 4,
            simulators: vec![Simulator::Icarus, Simulator::Verilator],
        }
    }
}

/// What agreed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Agreement {
    /// Cycles that were compared.
    pub cycles: usize,
    /// Outputs in each.
    pub outputs: usize,
}

/// Why a circuit does not pass.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The circuit has no exact Verilog.
    #[error(transparent)]
    Emit(#[from] EmitError),
    /// An input without a value, or an output without one in Rust: wider than 128 bits.
    #[error("port `{0}`: not in the harness, or wider than 128 bits")]
    Port(String),
    /// A simulator is missing, or does not take the text.
    #[error("{simulator:?}: {text}")]
    Tool {
        /// The simulator.
        simulator: Simulator,
        /// The last lines of what it says.
        text: String,
    },
    /// rust-hdl's simulation finds no stable state.
    #[error("the circuit never settles in cycle {cycle}")]
    NeverSettles {
        /// Cycle of the stimulus, from 0.
        cycle: usize,
    },
    /// The simulations differ.
    #[error("{0}")]
    Difference(Box<Difference>),
}

impl Failure {
    pub(crate) fn tool(simulator: Simulator, text: &str) -> Self {
        let lines: Vec<&str> = text.lines().collect();
        Self::Tool { simulator, text: lines[lines.len().saturating_sub(8)..].join("\n") }
    }
}

/// The first port that differs on the shortest stimulus that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// Where Verilog differs from Rust.
    pub simulator: Simulator,
    /// The output's field.
    pub port: String,
    /// Row of the stimulus, from 0.
    pub cycle: usize,
    /// What rust-hdl says.
    pub rust: u128,
    /// What the simulator says; none where bits are unknown.
    pub verilog: Known,
    /// Fields of the inputs.
    pub inputs: Vec<String>,
    /// Their values in each cycle.
    pub stimulus: Vec<Vec<u128>>,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { simulator, port, cycle, rust, .. } = self;
        let verilog = self.verilog.map_or("unknown".into(), |value| format!("{value:#x}"));
        writeln!(f, "{port} in cycle {cycle}: {rust:#x} in Rust, {verilog} in {simulator:?}")?;
        writeln!(f, "  {}", self.inputs.join(" "))?;
        self.stimulus.iter().try_for_each(|row| {
            writeln!(f, "  {}", row.iter().map(|value| format!("{value:x}")).collect::<Vec<_>>().join(" "))
        })
    }
}

/// Runs a circuit in rust-hdl's simulation and in Verilog simulators, on one random stimulus.
///
/// # Errors
/// What does not pass, see [`Failure`]; a difference comes with a stimulus that was made as short as it can be.
pub fn check<C: Circuit>(
    make: &dyn Fn() -> C,
    harness: &Harness<C>,
    check: &Check,
) -> Result<Agreement, Failure> {
    let mut circuit = make();
    circuit.connect_all();
    let emitted = edof_verilog::emit(&circuit)?;
    let inputs: Vec<&Port> = ports(&emitted.ports, Direction::Input);
    let outputs: Vec<&Port> = ports(&emitted.ports, Direction::Output);
    let order = inputs.iter().map(|port| {
        let place = harness.inputs.iter().position(|input| input.field == port.field);
        place.ok_or_else(|| Failure::Port(port.field.clone()))
    });
    let order: Vec<usize> = order.collect::<Result<_, _>>()?;
    let rows = stimulus(&inputs, check);
    // The harness has its own order.
    let in_rust = |rows: &[Vec<u128>]| {
        let row = |row: &Vec<u128>| {
            let mut all = vec![0; harness.inputs.len()];
            order.iter().zip(row).for_each(|(place, value)| all[*place] = *value);
            all
        };
        let rows: Vec<Vec<u128>> = rows.iter().map(row).collect();
        let mut circuit = make();
        circuit.connect_all();
        rust::run(circuit, harness, &outputs, &rows)
    };
    for &simulator in &check.simulators {
        let bench = Bench::new(&emitted, simulator)?;
        let differ = |rows: &[Vec<u128>]| -> Result<Option<Place>, Failure> {
            Ok(first(&in_rust(rows)?, &bench.run(rows)?, check.reset_cycles))
        };
        if differ(&rows)?.is_some() {
            let (stimulus, place) = shrink::shrink(rows, check.reset_cycles, &differ)?;
            return Err(Failure::Difference(Box::new(Difference {
                simulator,
                port: outputs[place.output].field.clone(),
                cycle: place.cycle,
                rust: place.rust,
                verilog: place.verilog,
                inputs: inputs.iter().map(|port| port.field.clone()).collect(),
                stimulus,
            })));
        }
    }
    Ok(Agreement { cycles: rows.len().saturating_sub(check.reset_cycles), outputs: outputs.len() })
}

fn ports(ports: &[Port], direction: Direction) -> Vec<&Port> {
    ports.iter().filter(|port| port.direction == direction && !port.is_clock).collect()
}

fn stimulus(inputs: &[&Port], check: &Check) -> Vec<Vec<u128>> {
    let mut random = Random::new(check.seed);
    let mut value = |cycle: usize, port: &&Port| match check.reset {
        Some(reset) if reset == port.field => u128::from(cycle < check.reset_cycles || random.chance(4)),
        _ => random.word(port.bits),
    };
    (0..check.cycles).map(|cycle| inputs.iter().map(|port| value(cycle, port)).collect()).collect()
}

/// Where two simulations differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub cycle: usize,
    pub output: usize,
    pub rust: u128,
    pub verilog: Known,
}

/// The first difference from a cycle on.
fn first(rust: &[Vec<u128>], verilog: &[Vec<Known>], from: usize) -> Option<Place> {
    let rows = rust.iter().zip(verilog).enumerate().skip(from);
    rows.flat_map(|(cycle, (rust, verilog))| {
        let pairs = rust.iter().zip(verilog).enumerate();
        pairs.map(move |(output, (rust, verilog))| Place { cycle, output, rust: *rust, verilog: *verilog })
    })
    .find(|place| place.verilog != Some(place.rust))
}
