//! Emitted circuits in the simulators of `edof-verilog-diff`.

use edof_hdl::describe::Circuit;
use edof_hdl::verilog::{Direction, Emitted, Port};
use edof_verilog_diff::Bench;
pub use edof_verilog_diff::Simulator;

pub const BOTH: [Simulator; 2] = [Simulator::Icarus, Simulator::Verilator];

/// Emits a circuit, and fails the test if the circuit is rejected.
pub fn emit(top: &mut dyn Circuit) -> Emitted {
    top.connect_all();
    edof_hdl::verilog::emit(top).unwrap_or_else(|error| panic!("{error}"))
}

/// The inputs that a row sets: all but clocks.
pub fn inputs(emitted: &Emitted) -> Vec<&Port> {
    emitted.ports.iter().filter(|port| port.direction == Direction::Input && !port.is_clock).collect()
}

/// Outputs for each row of inputs, taken before the clock edge that ends the row. What Icarus does not know yet is no value that a port
/// could have.
pub fn run(emitted: &Emitted, simulator: Simulator, rows: &[Vec<u128>]) -> Vec<Vec<u128>> {
    let found = Bench::new(emitted, simulator).and_then(|bench| bench.run(rows));
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    found.into_iter().map(|row| row.into_iter().map(|value| value.unwrap_or(u128::MAX)).collect()).collect()
}

/// Random rows, the same in every run.
pub struct Random(pub u64);

impl Random {
    /// Rows of values for the inputs of a circuit.
    pub fn rows(&mut self, emitted: &Emitted, count: usize) -> Vec<Vec<u128>> {
        let mut random = edof_verilog_diff::Random::new(self.0);
        let inputs = inputs(emitted);
        (0..count).map(|_| inputs.iter().map(|port| random.word(port.bits)).collect()).collect()
    }
}
