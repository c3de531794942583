//! A testbench that both simulators run: inputs row by row from a file, outputs printed row by row.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use edof_hdl::describe::Circuit;
use edof_hdl::verilog::{Direction, Emitted, Port};

/// The simulators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simulator {
    Icarus,
    Verilator,
}

pub const BOTH: [Simulator; 2] = [Simulator::Icarus, Simulator::Verilator];

/// Emits a circuit, and fails the test where it is refused.
pub fn emit(top: &mut dyn Circuit) -> Emitted {
    top.connect_all();
    edof_hdl::verilog::emit(top).unwrap_or_else(|error| panic!("{error}"))
}

/// The inputs that a row sets: all but clocks.
pub fn inputs(emitted: &Emitted) -> Vec<&Port> {
    emitted.ports.iter().filter(|port| port.direction == Direction::Input && !port.is_clock).collect()
}

/// The outputs that a row gives.
pub fn outputs(emitted: &Emitted) -> Vec<&Port> {
    emitted.ports.iter().filter(|port| port.direction == Direction::Output).collect()
}

/// Outputs for each row of inputs, taken before the clock edge that ends the row.
pub fn run(emitted: &Emitted, simulator: Simulator, rows: &[Vec<u128>]) -> Vec<Vec<u128>> {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    emitted
        .modules
        .iter()
        .for_each(|module| fs::write(at.join(module.name.clone() + ".v"), &module.text).unwrap());
    fs::write(at.join("bench.v"), testbench(emitted, rows.len())).unwrap();
    fs::write(at.join("rows.hex"), hex_rows(&inputs(emitted), rows)).unwrap();
    let files: Vec<String> = emitted.modules.iter().map(|module| module.name.clone() + ".v").collect();
    match simulator {
        Simulator::Icarus => {
            command(at, "iverilog", &["-g2005", "-o", "bench", "-s", "bench", "bench.v"], &files)
        }
        Simulator::Verilator => {
            let quiet = ["--binary", "--timing", "-Wno-lint", "-Wno-style", "-Wno-fatal", "-Wno-UNOPTFLAT"];
            let fast = ["-O1", "-CFLAGS", "-O0", "-j", "2", "--x-initial", "unique", "--x-assign", "unique"];
            let out = ["--Mdir", ".", "-o", "bench", "--top-module", "bench", "bench.v"];
            command(at, "verilator", &[&quiet[..], &fast[..], &out[..]].concat(), &files)
        }
    };
    let printed = command(at, "./bench", &[], &[]);
    let lines: Vec<_> = printed.lines().filter(|line| line.starts_with('=')).collect();
    assert_eq!(lines.len(), rows.len(), "{simulator:?} stopped early:\n{printed}");
    lines.into_iter().map(|line| parse(&outputs(emitted), &line[1..])).collect()
}

fn command(at: &Path, program: &str, arguments: &[&str], files: &[String]) -> String {
    let path = if program.starts_with("./") { at.join(program) } else { program.into() };
    let output = Command::new(path).current_dir(at).args(arguments).args(files).output().unwrap();
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{program}:\n{stdout}\n{stderr}");
    stdout.into_owned()
}

fn testbench(emitted: &Emitted, rows: usize) -> String {
    let mut text =
        String::from("`timescale 1ns/1ns\nmodule bench;\n    reg clock = 1'b0;\n    integer row;\n");
    let (inputs, outputs) = (inputs(emitted), outputs(emitted));
    let width: usize = inputs.iter().map(|port| port.bits).sum();
    writeln!(text, "    reg [{}:0] rows [0:{}];", width.max(1) - 1, rows - 1).unwrap();
    inputs.iter().for_each(|port| writeln!(text, "    reg [{}:0] {};", port.bits - 1, port.name).unwrap());
    outputs.iter().for_each(|port| writeln!(text, "    wire [{}:0] {};", port.bits - 1, port.name).unwrap());
    let pin = |port: &Port| format!(".{}({})", port.name, if port.is_clock { "clock" } else { &port.name });
    let pins: Vec<_> = emitted.ports.iter().map(pin).collect();
    writeln!(text, "    {} dut (\n        {});", emitted.top, pins.join(",\n        ")).unwrap();
    text += "    initial begin\n        $readmemh(\"rows.hex\", rows);\n";
    writeln!(text, "        for (row = 0; row < {rows}; row = row + 1) begin").unwrap();
    if !inputs.is_empty() {
        let names: Vec<_> = inputs.iter().map(|port| port.name.as_str()).collect();
        writeln!(text, "            {{{}}} = rows[row];", names.join(", ")).unwrap();
    }
    text += "            #1 $write(\"=\");\n";
    for some in outputs.chunks(20) {
        let aligned = |port: &&Port| format!("{{{}'d0, {}}}", 4 - port.bits % 4, port.name);
        let values: Vec<_> = some.iter().map(aligned).collect();
        writeln!(text, "            $write(\"%h\", {{{}}});", values.join(", ")).unwrap();
    }
    text += "            $write(\"\\n\");\n            clock = 1'b1;\n            #1 clock = 1'b0;\n            #1;\n";
    text + "        end\n        $finish;\n    end\nendmodule\n"
}

fn hex_rows(inputs: &[&Port], rows: &[Vec<u128>]) -> String {
    let line = |row: &Vec<u128>| {
        let bits: String = inputs
            .iter()
            .zip(row)
            .map(|(port, value)| format!("{:0width$b}", value, width = port.bits))
            .collect();
        let padded = "0".repeat((4 - bits.len() % 4) % 4) + &bits;
        let nibbles =
            (0..padded.len()).step_by(4).map(|at| u8::from_str_radix(&padded[at..at + 4], 2).unwrap());
        nibbles.map(|nibble| format!("{nibble:x}")).collect::<String>() + "\n"
    };
    rows.iter().map(line).collect()
}

fn parse(outputs: &[&Port], line: &str) -> Vec<u128> {
    let mut rest = line;
    let value = |port: &&Port| {
        let (digits, after) = rest.split_at(port.bits / 4 + 1);
        rest = after;
        // What Icarus does not know yet is no value that a port could have.
        u128::from_str_radix(digits, 16).unwrap_or(u128::MAX)
    };
    outputs.iter().map(value).collect()
}

/// A small generator of random numbers (xorshift), the same in every run.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self, bits: usize) -> u128 {
        let mut next = || {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            u128::from(self.0)
        };
        let mask = if bits >= 128 { u128::MAX } else { (1 << bits) - 1 };
        // Extremes and small numbers are where the meanings part.
        match next() % 8 {
            0 => 0,
            1 => mask,
            2 => ((mask >> 1) + 1) & mask,
            3 => mask >> 1,
            4 => (next() % 8) & mask,
            _ => ((next() << 64) | next()) & mask,
        }
    }

    /// Rows of values for the inputs of a circuit.
    pub fn rows(&mut self, emitted: &Emitted, count: usize) -> Vec<Vec<u128>> {
        let inputs = inputs(emitted);
        (0..count).map(|_| inputs.iter().map(|port| self.bits(port.bits)).collect()).collect()
    }
}
