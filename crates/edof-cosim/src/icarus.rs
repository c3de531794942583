//! The same stimulus through Icarus Verilog, which shares no code with Verilator and knows four states.

use crate::error::{Error, at};
use crate::rows::{Layout, Rows, Slot, mask};
use crate::{Source, mutant, tool, work};
use edof_core::storage::atomic::WorkFolder;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// What the outputs were in every cycle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Observed {
    /// Rows as of [`Layout::outputs`]; 0 where not known.
    pub values: Rows,
    /// Ones where a bit is unknown or undriven.
    pub unknown: Rows,
}

impl Observed {
    /// The first cycle from which on everything is known; the number of cycles if the last one is not.
    #[must_use]
    pub fn known_from(&self) -> usize {
        let last = (0..self.unknown.len()).rev().find(|&i| self.unknown.row(i).iter().any(|&word| word != 0));
        last.map_or(0, |cycle| cycle + 1)
    }

    /// The first place where a known bit is not that of `expected`.
    #[must_use]
    pub fn first_difference(&self, source: &Source, expected: &Rows) -> Option<Difference> {
        let layout = Layout::outputs(source);
        let cycles = self.values.len().min(expected.len());
        (0..cycles).find_map(|cycle| {
            let slot = layout.slots().iter().find(|slot| self.differs(cycle, slot, expected))?;
            let hex = |rows: &Rows| hex(&rows.row(cycle)[slot.range()]);
            let port = source.ports[slot.port].name.clone();
            Some(Difference { cycle, port, expected: hex(expected), got: hex(&self.values) })
        })
    }

    fn differs(&self, cycle: usize, slot: &Slot, expected: &Rows) -> bool {
        slot.range().any(|word| {
            let known = !self.unknown.row(cycle)[word];
            (self.values.row(cycle)[word] ^ expected.row(cycle)[word]) & known != 0
        })
    }
}

/// One output that differs.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("cycle {cycle}, {port}: expected {expected}, got {got}")]
pub struct Difference {
    /// Number of the cycle, from 0.
    pub cycle: usize,
    /// Name of the port.
    pub port: String,
    /// In hexadecimal.
    pub expected: String,
    /// In hexadecimal, unknown bits as 0.
    pub got: String,
}

/// For each row of inputs (as of [`Layout::inputs`]): apply, sample, let all clocks rise. Relative paths of `$readmemh` start
/// in `memory_dir`, or else in the working directory of the process.
///
/// # Errors
/// Icarus is missing or rejects the design, a memory image is missing, or a row has another width.
pub fn run(source: &Source, stimulus: &Rows, memory_dir: Option<&Path>) -> Result<Observed, Error> {
    let (inputs, outputs) = (Layout::inputs(source), Layout::outputs(source));
    if stimulus.width() != inputs.words() {
        let (found, expected) = (stimulus.width(), inputs.words());
        return Err(Error::Port(format!("a row of {found} words, where the design has {expected}")));
    }
    let work = work::folder()?;
    compile(source, &bench(source, &inputs, &outputs, work.path())?, &work)?;
    let path = work.path().join("stimulus");
    fs::write(&path, stimulus_text(stimulus)).map_err(at(&path))?;
    simulate(work.path(), memory_dir.unwrap_or(Path::new(".")))?;
    let path = work.path().join("outputs");
    let text = fs::read_to_string(&path).map_err(at(&path))?;
    observed(&text, &outputs, stimulus.len())
}

fn compile(source: &Source, bench: &str, work: &WorkFolder) -> Result<(), Error> {
    mutant::simulated(source)?.write(work.path())?;
    let path = work.path().join("edof_bench.v");
    fs::write(&path, bench).map_err(at(&path))?;
    let is_system = source.file_names().any(|name| name.ends_with(".sv"));
    let mut command = tool::command("iverilog", work.path());
    command.arg(if is_system { "-g2005-sv" } else { "-g2005" });
    command.args(["-o", "bench.vvp", "-s", "edof_bench", "edof_bench.v"]);
    tool::run(command.args(source.file_names().filter(|name| !name.ends_with(".vh")))).map(drop)
}

/// Icarus continues without a memory image; here that is an error.
fn simulate(work: &Path, dir: &Path) -> Result<(), Error> {
    let output = tool::run(tool::command("vvp", dir).arg("-n").arg(work.join("bench.vvp")))?;
    let is_error = |line: &&str| line.contains("ERROR:") || line.contains("Unable to open");
    match output.lines().find(is_error) {
        Some(line) => Err(Error::Stopped(line.into())),
        None => Ok(()),
    }
}

/// The bench reads a row, waits, writes a row, and lets the clocks rise, until there are no more rows.
fn bench(source: &Source, inputs: &Layout, outputs: &Layout, work: &Path) -> Result<String, Error> {
    let mut connections = vec![];
    for port in source.ports.iter().filter(|port| port.is_clock) {
        connections.push(format!(".{}(clock)", port.name));
    }
    for (layout, vector) in [(inputs, "inputs"), (outputs, "outputs")] {
        for slot in layout.slots() {
            let (low, high) = (32 * slot.at, 32 * slot.at + slot.bits - 1);
            connections.push(format!(".{}({vector}[{high}:{low}])", source.ports[slot.port].name));
        }
    }
    let template = include_str!("../../../sim/icarus/bench.v");
    Ok(template
        .replace("@stimulus@", &quoted(&work.join("stimulus"))?)
        .replace("@outputs@", &quoted(&work.join("outputs"))?)
        .replace("@input_high@", &(32 * inputs.words().max(1) - 1).to_string())
        .replace("@output_high@", &(32 * outputs.words().max(1) - 1).to_string())
        .replace("@top@", &source.top)
        .replace("@connections@", &connections.join(",\n        ")))
}

/// A path inside the quotes of a Verilog string.
fn quoted(path: &Path) -> Result<String, Error> {
    let text = path.to_str().ok_or_else(|| Error::Port(format!("{}: is no UTF-8", path.display())))?;
    Ok(text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A line of hexadecimal for each row.
fn stimulus_text(stimulus: &Rows) -> String {
    let mut text = String::new();
    for row in stimulus.iter() {
        let _ = writeln!(text, "{}", if row.is_empty() { "0".into() } else { hex(row) });
    }
    text
}

/// The most significant word first.
fn hex(words: &[u32]) -> String {
    words.iter().rev().map(|word| format!("{word:08x}")).collect()
}

/// Reads lines of binary.
fn observed(text: &str, layout: &Layout, cycles: usize) -> Result<Observed, Error> {
    let unexpected = |problem| Error::Output { tool: "vvp".into(), problem };
    let mut all = Observed { values: Rows::new(layout.words()), unknown: Rows::new(layout.words()) };
    for line in text.lines() {
        if line.len() != 32 * layout.words().max(1) {
            return Err(unexpected(format!("a line of {} bits", line.len())));
        }
        let (values, unknown) = (all.values.push_zeros(), all.unknown.push_zeros());
        for (word, bits) in line.as_bytes().rchunks(32).enumerate().take(layout.words()) {
            values[word] = bits.iter().fold(0, |word, &bit| word << 1 | u32::from(bit == b'1'));
            unknown[word] = bits.iter().fold(0, |word, bit| word << 1 | u32::from(!b"01".contains(bit)));
        }
        for slot in layout.slots() {
            mask(&mut unknown[slot.range()], slot.bits);
        }
    }
    let found = all.values.len();
    let stopped = || unexpected(format!("{found} cycles, where the stimulus has {cycles}"));
    (found == cycles).then_some(all).ok_or_else(stopped)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Port;

    fn layout() -> Layout {
        let ports = vec![Port::output("a", 2), Port::output("b", 33)];
        Layout::outputs(&Source { top: "t".into(), files: vec![], ports })
    }

    #[test]
    fn unknown_bits_inside_the_ports_are_marked() {
        let line =
            format!("{}{}{}", "z".repeat(31) + "1", "x".repeat(16) + &"1".repeat(16), "z".repeat(30) + "x1");
        let seen = observed(&line, &layout(), 1).unwrap();
        assert_eq!(seen.values.row(0), [1, 0xffff, 1]);
        assert_eq!(seen.unknown.row(0), [2, 0xffff_0000, 0]);
        assert_eq!(seen.known_from(), 1);
    }

    #[test]
    fn output_that_ends_early_is_an_error() {
        let text = |lines: &str| observed(lines, &layout(), 1).unwrap_err().to_string();
        assert_eq!(text(""), "vvp gave something unexpected: 0 cycles, where the stimulus has 1");
        assert_eq!(text("01"), "vvp gave something unexpected: a line of 2 bits");
    }
}
