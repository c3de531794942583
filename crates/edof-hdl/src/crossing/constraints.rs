//! Timing constraints of each clock-domain crossing, for Vivado.

use crate::verilog::Crossing;
use std::fmt::Write;

/// A clock of the top module: its port, and its period in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period {
    /// The port's field.
    pub clock: &'static str,
    /// The period.
    pub nanoseconds: f64,
}

/// The lines of `crossings.xdc` for the crossings of a module that is the instance `instance` of the design's top.
///
/// What goes through two flip-flops must only arrive within a period of the faster clock, whatever the phase: a maximal delay of the data
/// path alone, which takes the path out of the timing of either clock. The flip-flops' `ASYNC_REG` is in the leaves' text.
#[must_use]
pub fn lines(crossings: &[Crossing], instance: &str, periods: &[Period]) -> String {
    let mut text = String::from(
        "# Ways between clock domains, made from the design: every synchroniser by its path. No asynchronous groups are declared between clocks\n\
         # that have such ways, since they would switch these limits off; a way that is not here is timed, and fails.\n",
    );
    for crossing in crossings {
        let path = format!("{instance}/{}", crossing.path.join("/"));
        let fastest = crossing.clocks.iter().filter_map(|(_, clock)| {
            periods.iter().find(|period| period.clock == clock).map(|period| period.nanoseconds)
        });
        let fastest = fastest.fold(f64::INFINITY, f64::min);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\n# {path}: {}", crossing.leaf);
        for line in of_leaf(&crossing.leaf, &path, fastest) {
            text += &line;
            text.push('\n');
        }
    }
    text
}

fn of_leaf(leaf: &str, path: &str, period: f64) -> Vec<String> {
    let cells = |name: &str| format!("[get_cells {{{path}/{name}}}]");
    let limit = |from: &str, to: &str| {
        format!("set_max_delay -datapath_only -from {} -to {} {period:.3}", cells(from), cells(to))
    };
    let synchronised = |register: &str, sync: &str| limit(register, &format!("{sync}/first_q_reg[*]"));
    let limits = match leaf {
        "edof_sync" => vec![format!("set_false_path -to [get_pins {{{path}/first_q_reg[*]/D}}]")],
        "edof_reset_sync" => {
            vec![format!("set_false_path -to [get_pins {{{path}/first_q_reg/PRE {path}/second_q_reg/PRE}}]")]
        }
        "edof_async_fifo" => vec![
            synchronised("write_gray_q_reg[*]", "to_reader"),
            synchronised("read_gray_q_reg[*]", "to_writer"),
            format!(
                "set_bus_skew -from {} -to {} {period:.3}",
                cells("write_gray_q_reg[*]"),
                cells("to_reader/first_q_reg[*]")
            ),
            format!(
                "set_bus_skew -from {} -to {} {period:.3}",
                cells("read_gray_q_reg[*]"),
                cells("to_writer/first_q_reg[*]")
            ),
            // A word is read no sooner than two edges after it was written.
            limit("words_reg*", "word_q_reg[*]"),
        ],
        "edof_pulse_sync" => {
            vec![
                synchronised("req_toggle_q_reg", "to_receiver"),
                synchronised("ack_toggle_q_reg", "to_sender"),
            ]
        }
        "edof_bus_sync" => vec![
            synchronised("req_toggle_q_reg", "to_receiver"),
            synchronised("ack_toggle_q_reg", "to_sender"),
            limit("held_q_reg[*]", "word_q_reg[*]"),
        ],
        "edof_serialiser" => {
            vec![synchronised("toggle_q_reg", "to_bits"), limit("word_q_reg[*]", "bits_q_reg[*]")]
        }
        _ => vec![],
    };
    // Those that carry words are cleared from either side (`edof_clear`).
    let clears = match leaf {
        "edof_async_fifo" | "edof_pulse_sync" | "edof_bus_sync" => vec![
            synchronised("clear/clear_q_reg", "clear/to_receiver"),
            synchronised("clear/request_q_reg", "clear/request_sync"),
            synchronised("clear/ack_q_reg", "clear/ack_sync"),
        ],
        _ => vec![],
    };
    [limits, clears].concat()
}
