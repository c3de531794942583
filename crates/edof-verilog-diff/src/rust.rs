//! A circuit in rust-hdl's own simulation.

use crate::drive::Harness;
use crate::failure::Failure;
use edof_verilog::Port;
use rust_hdl::core::atom::Atom;
use rust_hdl::core::probe::Probe;
use rust_hdl::prelude::{Block, Clock, simulate};
use std::collections::HashMap;

/// Rounds in which every circuit without a loop settles.
const ROUNDS: usize = 200;

/// Outputs for each row of inputs, before the clock's edge that ends the row.
pub fn run<C: Block>(
    mut circuit: C,
    harness: &Harness<C>,
    outputs: &[&Port],
    rows: &[Vec<u128>],
) -> Result<Vec<Vec<u128>>, Failure> {
    let mut found = vec![];
    for (cycle, row) in rows.iter().enumerate() {
        for (input, bits) in harness.inputs.iter().zip(row) {
            (input.set)(&mut circuit, *bits);
        }
        settle(&mut circuit, cycle)?;
        let values = values(&circuit);
        let value =
            |port: &&Port| values.get(&port.field).copied().ok_or_else(|| Failure::Port(port.field.clone()));
        found.push(outputs.iter().map(value).collect::<Result<_, _>>()?);
        if let Some(clock) = harness.clock {
            for clk in [true, false] {
                clock(&mut circuit).next = Clock { clk };
                settle(&mut circuit, cycle)?;
            }
        }
    }
    Ok(found)
}

fn settle<C: Block>(circuit: &mut C, cycle: usize) -> Result<(), Failure> {
    if simulate(circuit, ROUNDS) { Ok(()) } else { Err(Failure::NeverSettles { cycle }) }
}

/// The ports of a block: signals one level below it.
#[derive(Default)]
struct Ports {
    depth: usize,
    namespace: Vec<String>,
    values: HashMap<String, u128>,
}

impl Probe for Ports {
    fn visit_start_scope(&mut self, _: &str, _: &dyn Block) {
        self.depth += 1;
    }

    fn visit_end_scope(&mut self, _: &str, _: &dyn Block) {
        self.depth -= 1;
    }

    fn visit_start_namespace(&mut self, name: &str, _: &dyn Block) {
        self.namespace.push(name.into());
    }

    fn visit_end_namespace(&mut self, _: &str, _: &dyn Block) {
        self.namespace.pop();
    }

    fn visit_atom(&mut self, name: &str, signal: &dyn Atom) {
        if self.depth == 1 && signal.kind().is_parameter() {
            let literal = format!("{:x}", signal.verilog());
            let digits = literal.rsplit("'h").next().unwrap_or_default();
            let words: Vec<&str> = self.namespace.iter().map(String::as_str).chain([name]).collect();
            if let Ok(value) = u128::from_str_radix(digits, 16) {
                self.values.insert(edof_verilog::rust_path(&words.join("$")), value);
            }
        }
    }
}

fn values(circuit: &dyn Block) -> HashMap<String, u128> {
    let mut ports = Ports::default();
    circuit.accept("top", &mut ports);
    ports.values
}
