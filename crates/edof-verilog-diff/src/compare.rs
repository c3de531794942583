//! A circuit in three simulations on one stimulus.

use crate::drive::{Harness, Random};
use crate::failure::{Difference, Failure, Known, Place, Simulator};
use crate::simulator::Bench;
use crate::{rust, shrink};
use edof_verilog::describe::Circuit;
use edof_verilog::{Direction, Port};

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

/// The first difference from a cycle on.
fn first(rust: &[Vec<u128>], verilog: &[Vec<Known>], from: usize) -> Option<Place> {
    let rows = rust.iter().zip(verilog).enumerate().skip(from);
    rows.flat_map(|(cycle, (rust, verilog))| {
        let pairs = rust.iter().zip(verilog).enumerate();
        pairs.map(move |(output, (rust, verilog))| Place { cycle, output, rust: *rust, verilog: *verilog })
    })
    .find(|place| place.verilog != Some(place.rust))
}
