//! The printed text in Verilator and Icarus: built once, run on as many stimuli as one likes.

use crate::failure::{Failure, Known, Simulator};
use edof_verilog::{Direction, Emitted, Port};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A design in a simulator.
pub struct Bench {
    simulator: Simulator,
    folder: TempDir,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
}

/// After which a compilation or a simulation has failed: a simulator does not come to rest where a text has a loop.
const LIMIT: Duration = Duration::from_secs(600);
const POLL: Duration = Duration::from_millis(5);

/// Rows that a bench takes at most.
const MAX_ROWS: usize = 1 << 16;

impl Bench {
    /// Compiles a design.
    ///
    /// # Errors
    /// [`Failure::Tool`] with what the simulator says.
    pub fn new(emitted: &Emitted, simulator: Simulator) -> Result<Self, Failure> {
        let folder = tempfile::tempdir().map_err(|error| Failure::tool(simulator, &error.to_string()))?;
        let modules = emitted.modules.iter().map(|module| (module.name.clone(), module.text.clone()));
        let mut files: Vec<String> = vec![];
        for (name, text) in modules.chain(leaves(emitted)) {
            files.push(format!("{name}.v"));
            write(folder.path(), &format!("{name}.v"), &text, simulator)?;
        }
        let named = |direction| -> Vec<Port> {
            let is_one = |port: &&Port| port.direction == direction && !port.is_clock;
            emitted.ports.iter().filter(is_one).cloned().collect()
        };
        let bench =
            Self { simulator, inputs: named(Direction::Input), outputs: named(Direction::Output), folder };
        write(bench.folder.path(), "bench.v", &bench.text(emitted), simulator)?;
        let (program, arguments): (_, &[&str]) = match simulator {
            Simulator::Icarus => ("iverilog", &["-g2005", "-o", "bench", "-s", "bench", "bench.v"]),
            Simulator::Verilator => ("verilator", &VERILATOR),
        };
        bench.command(Command::new(program).args(arguments).args(&files))?;
        Ok(bench)
    }

    /// Outputs for each row of inputs, before the clock's edge that ends the row.
    ///
    /// # Errors
    /// [`Failure::Tool`] where the simulation ends early.
    pub fn run(&self, rows: &[Vec<u128>]) -> Result<Vec<Vec<Known>>, Failure> {
        let text: String = rows.iter().map(|row| self.hexadecimal(row)).collect();
        write(self.folder.path(), "rows.hex", &text, self.simulator)?;
        let program = self.folder.path().join("bench");
        let printed = self.command(Command::new(program).arg(format!("+rows={}", rows.len())))?;
        let lines: Vec<&str> = printed.lines().filter_map(|line| line.strip_prefix('=')).collect();
        if lines.len() != rows.len() {
            return Err(Failure::tool(self.simulator, &printed));
        }
        Ok(lines.into_iter().map(|line| self.parse(line)).collect())
    }

    /// What a program prints, if it ends well and in time.
    fn command(&self, command: &mut Command) -> Result<String, Failure> {
        let failed = |error: std::io::Error| Failure::tool(self.simulator, &error.to_string());
        let [out, err] = ["out.txt", "err.txt"].map(|name| self.folder.path().join(name));
        command.current_dir(self.folder.path()).stdin(Stdio::null());
        command.stdout(File::create(&out).map_err(failed)?).stderr(File::create(&err).map_err(failed)?);
        let mut child = command.spawn().map_err(failed)?;
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().map_err(failed)? {
                break status;
            }
            if begun.elapsed() > LIMIT {
                child.kill().and_then(|()| child.wait()).map_err(failed)?;
                let seconds = LIMIT.as_secs();
                let why = format!("no end after {seconds} s; values may change for ever within one moment");
                return Err(Failure::tool(self.simulator, &why));
            }
            sleep(POLL);
        };
        let read = |path| fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        let printed = read(&out).map_err(failed)?;
        if status.success() {
            return Ok(printed);
        }
        Err(Failure::tool(self.simulator, &(printed + &read(&err).map_err(failed)?)))
    }

    /// The bench: rows from a file, outputs printed before each edge.
    fn text(&self, emitted: &Emitted) -> String {
        let width: usize = self.inputs.iter().map(|port| port.bits).sum();
        let mut text = format!(
            "`timescale 1ns/1ns\nmodule bench;\n  reg clock = 1'b0;\n  integer row, last;\n  \
             reg [{}:0] rows [0:{}];\n",
            width.max(1) - 1,
            MAX_ROWS - 1
        );
        for (word, ports) in [("reg", &self.inputs), ("wire", &self.outputs)] {
            ports.iter().for_each(|port| text += &format!("  {word} [{}:0] {};\n", port.bits - 1, port.name));
        }
        let pin =
            |port: &Port| format!(".{}({})", port.name, if port.is_clock { "clock" } else { &port.name });
        let pins: Vec<String> = emitted.ports.iter().map(pin).collect();
        text += &format!("  {} dut (\n    {});\n  initial begin\n", emitted.top, pins.join(",\n    "));
        text += "    if (!$value$plusargs(\"rows=%d\", last)) last = 0;\n    $readmemh(\"rows.hex\", rows, 0, last - 1);\n";
        text += "    for (row = 0; row < last; row = row + 1) begin\n";
        if !self.inputs.is_empty() {
            let names: Vec<&str> = self.inputs.iter().map(|port| port.name.as_str()).collect();
            text += &format!("      {{{}}} = rows[row];\n", names.join(", "));
        }
        text += "      #1 $write(\"=\");\n";
        for port in &self.outputs {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "      $write(\"%h \", {});", port.name);
        }
        text += "      $write(\"\\n\");\n      clock = 1'b1;\n      #1 clock = 1'b0;\n      #1;\n    end\n";
        text + "    $finish;\n  end\nendmodule\n"
    }

    fn hexadecimal(&self, row: &[u128]) -> String {
        let bits: String = self
            .inputs
            .iter()
            .zip(row)
            .map(|(port, value)| format!("{value:0width$b}", width = port.bits))
            .collect();
        let padded = "0".repeat((4 - bits.len() % 4) % 4) + &bits;
        let digit = |four: &[u8]| {
            let value = four.iter().fold(0, |value, bit| value * 2 + u32::from(*bit == b'1'));
            char::from_digit(value, 16).unwrap_or('0')
        };
        padded.as_bytes().chunks(4).map(digit).chain(['\n']).collect()
    }

    fn parse(&self, line: &str) -> Vec<Known> {
        line.split_whitespace().map(|digits| u128::from_str_radix(digits, 16).ok()).collect()
    }
}

const VERILATOR: [&str; 22] = [
    "--binary",
    "--timing",
    "-Wno-lint",
    "-Wno-style",
    "-Wno-fatal",
    "-Wno-UNOPTFLAT",
    "-O1",
    "-CFLAGS",
    "-O0",
    "-j",
    "2",
    "--x-initial",
    "unique",
    "--x-assign",
    "unique",
    "--Mdir",
    ".",
    "-o",
    "bench",
    "--top-module",
    "bench",
    "bench.v",
];

/// The modules of all leaves, each once: several leaves may stand on one.
fn leaves(emitted: &Emitted) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for text in emitted.leaf_texts.values().flat_map(|text| text.split_inclusive("endmodule")) {
        let head = text.lines().find_map(|line| line.trim_start().strip_prefix("module "));
        let name =
            head.map(|head| head.split(|letter: char| !letter.is_alphanumeric() && letter != '_').next());
        if let Some(Some(name)) = name {
            found.entry(name.to_string()).or_insert_with(|| format!("{text}\n"));
        }
    }
    found
}

fn write(folder: &Path, name: &str, text: &str, simulator: Simulator) -> Result<(), Failure> {
    fs::write(folder.join(name), text).map_err(|error| Failure::tool(simulator, &error.to_string()))
}
