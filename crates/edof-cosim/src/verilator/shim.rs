//! The part of the C++ shim that depends on the ports.

use crate::{Direction, Layout, Port, Source};
use std::fmt::Write;

/// The part that does not.
pub const SHIM: &str = include_str!("../../../../sim/verilator/shim.cpp");

/// Text of `ports.inc`.
pub fn ports_inc(source: &Source) -> String {
    let (inputs, outputs) = (Layout::inputs(source), Layout::outputs(source));
    let zeros = vec!["0"; widest(source)].join(", ");
    [
        format!("static constexpr std::size_t INPUT_WORDS = {};\n", inputs.words()),
        format!("static constexpr std::size_t OUTPUT_WORDS = {};\n", outputs.words()),
        function("set_clocks(Vdut& top, uint8_t level)", &clocks(source)),
        function("set_clock(Vdut& top, uint32_t port, uint8_t level)", &clock(source)),
        function(
            "zero_inputs(Vdut& top)",
            &format!("    const uint32_t zeros[] = {{{zeros}}};\n{}", zero(source)),
        ),
        function("poke_port(Vdut& top, uint32_t port, const uint32_t* words)", &poke(source)),
        function("peek_port(const Vdut& top, uint32_t port, uint32_t* words)", &peek(source)),
        function("apply_row(Vdut& top, const uint32_t* row)", &row(source, &inputs, "put")),
        function("sample_row(const Vdut& top, uint32_t* row)", &row(source, &outputs, "get")),
    ]
    .concat()
}

fn function(head: &str, body: &str) -> String {
    format!("static void {head} {{\n{body}}}\n")
}

fn widest(source: &Source) -> usize {
    source.ports.iter().map(Port::words).max().unwrap_or(1)
}

fn clocks(source: &Source) -> String {
    let clocks = source.ports.iter().filter(|port| port.is_clock);
    clocks.map(|port| format!("    top.{} = level;\n", member(&port.name))).collect()
}

fn clock(source: &Source) -> String {
    let clocks = source.ports.iter().enumerate().filter(|(_, port)| port.is_clock);
    let case = |(index, port): (usize, &Port)| {
        format!("    case {index}: top.{} = level; break;\n", member(&port.name))
    };
    format!("    switch (port) {{\n{}    }}\n", clocks.map(case).collect::<String>())
}

fn zero(source: &Source) -> String {
    let inputs = source.ports.iter().filter(|port| port.direction == Direction::In && !port.is_clock);
    inputs.map(|port| format!("    {}\n", call("put", port, "zeros"))).collect()
}

/// Clocks are poked by nobody but `tick`.
fn poke(source: &Source) -> String {
    cases(source, "put", |port| port.direction == Direction::In && !port.is_clock)
}

fn peek(source: &Source) -> String {
    cases(source, "get", |_| true)
}

fn cases(source: &Source, verb: &str, belongs: impl Fn(&Port) -> bool) -> String {
    let mut text = String::from("    switch (port) {\n");
    for (index, port) in source.ports.iter().enumerate().filter(|(_, port)| belongs(port)) {
        let _ = writeln!(text, "    case {index}: {} break;", call(verb, port, "words"));
    }
    text + "    }\n"
}

fn row(source: &Source, layout: &Layout, verb: &str) -> String {
    let line = |slot: &crate::rows::Slot| {
        format!("    {}\n", call(verb, &source.ports[slot.port], &format!("row + {}", slot.at)))
    };
    layout.slots().iter().map(line).collect()
}

fn call(verb: &str, port: &Port, words: &str) -> String {
    format!("{verb}<{}>(top.{}, {words});", port.bits, member(&port.name))
}

/// Verilator's name of a port in C++: it keeps double underscores for itself.
pub fn member(name: &str) -> String {
    name.replace("__", "___05F")
}
