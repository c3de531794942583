//! Why a circuit does not pass, and where simulations differ.

use edof_verilog::EmitError;
use std::fmt;

/// A Verilog simulator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simulator {
    /// `iverilog`: registers start unknown.
    Icarus,
    /// `verilator`: registers start at random.
    Verilator,
}

/// A value, or none where some of its bits are unknown.
pub type Known = Option<u128>;

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
    /// Values of the inputs in each cycle.
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

/// Where two simulations differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub cycle: usize,
    pub output: usize,
    pub rust: u128,
    pub verilog: Known,
}
