//! How much something inside of a design ever was: the high-water marks of its FIFOs.

use crate::{Direction, Port, Source};
use std::fmt::Write;

/// Something to watch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// What it is called: the output of the watched design is `max_NAME_o`.
    pub name: String,
    /// The port of the clock at whose edges it is looked at.
    pub clock: &'static str,
    /// What it is in Verilog, the design's top being `dut`: a number of [`BITS`] bits.
    pub value: String,
}

/// Bits of a mark.
pub const BITS: usize = 16;

impl Mark {
    /// Fill of a FIFO, from its two counters of `bits` bits.
    #[must_use]
    pub fn between(name: &str, clock: &'static str, [put, taken]: [&str; 2], bits: usize) -> Self {
        let value = format!("(dut.{put} - dut.{taken}) & {BITS}'d{}", (1_u64 << bits) - 1);
        Self { name: name.into(), clock, value }
    }

    /// The same, 0 unless all these signals are high.
    #[must_use]
    pub fn only_while(mut self, signals: &[String]) -> Self {
        let all: Vec<String> = signals.iter().map(|signal| format!("dut.{signal}")).collect();
        self.value = format!("({}) ? {} : {BITS}'d0", all.join(" && "), self.value);
        self
    }

    /// Name of the output port of the mark.
    #[must_use]
    pub fn port(&self) -> String {
        format!("max_{}_o", self.name)
    }
}

impl Source {
    /// The same design with an output for each mark: the most that it was since the port `reset` was high.
    #[must_use]
    pub fn watched(mut self, reset: &str, marks: &[Mark]) -> Self {
        let top = format!("{}_watched", self.top);
        let mut text = format!("module {top} (\n");
        let outputs = marks.iter().map(|mark| Port::output(&mark.port(), BITS));
        let pins: Vec<String> = self.ports.iter().map(|port| format!(".{0}({0})", port.name)).collect();
        self.ports.extend(outputs);
        let ports = self.ports.iter().map(|port| {
            let way = if port.direction == Direction::In { "input wire" } else { "output wire" };
            let range = if port.bits == 1 { String::new() } else { format!(" [{}:0]", port.bits - 1) };
            format!("    {way}{range} {}", port.name)
        });
        let ports: Vec<String> = ports.collect();
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{}\n);\n    {} dut (\n        {}\n    );",
            ports.join(",\n"),
            self.top,
            pins.join(",\n        ")
        );
        for Mark { name, clock, value } in marks {
            let _ = writeln!(
                text,
                "    wire [{0}:0] is_{name} = {value};\n    reg [{0}:0] max_{name};\n    \
                 always @(posedge {clock}) max_{name} <= {reset} ? {BITS}'d0 : is_{name} > max_{name} ? is_{name} : max_{name};\n    \
                 assign max_{name}_o = max_{name};",
                BITS - 1
            );
        }
        text += "endmodule\n";
        self.files.push((format!("{top}.v"), text));
        self.top = top;
        self
    }
}
