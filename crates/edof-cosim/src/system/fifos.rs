//! The FIFOs of a core: how full each may get, ahead of a run, and how full it was.

use crate::bench::Mark;
use edof_device::board::Memory;
use edof_device::fifos::{CROSSING_PIXELS, agent_words, crossing_words};
use edof_golden::video::figures::Periods;
use edof_hdl::project::Project;
use edof_hdl::video::queue;

/// A FIFO of a core and how full it got.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fifo {
    /// What it is called here.
    pub name: String,
    /// Most words that were in it.
    pub max: usize,
    /// Most that the model says.
    pub limit: usize,
    /// Words that it has.
    pub depth: usize,
}

const CROSSINGS: [&str; 4] = ["input_fifo", "raw_fifo", "picture_fifo", "output_fifo"];
const WRITERS: [&str; 2] = ["raw_writer", "picture_writer"];
const READERS: [&str; 2] = ["raw_reader", "picture_reader"];
/// Queues at the ends of pipelines; not all designs have the third.
const QUEUES: [(&str, &str); 5] = [
    ("windows", "core.windows.queue"),
    ("pairs", "core.lines.pairs.queue"),
    ("overlap", "core.lines.overlap.queue"),
    ("raster", "core.lines.raster.queue"),
    ("display", "core.display.queue"),
];

/// What to watch in a core.
pub(super) fn marks(core: &Project) -> Vec<Mark> {
    let (clock, calculator) = ("clock_i", "calculator_clock_i");
    let crossing = |name: &&str| {
        let [put, taken] = ["write", "read"].map(|side| format!("{name}.fifo.{side}"));
        let mark = Mark::between(name, clock, [&put, &taken], CROSSING_PIXELS.ilog2() as usize + 1);
        // While it is being emptied its pointers mean nothing.
        mark.only_while(&[format!("{put}_open"), format!("{taken}_open")])
    };
    let agent = |taken: &'static str| {
        move |name: &&str| {
            let [put, taken] = ["write_ptr", taken].map(|count| format!("{name}.{count}_q"));
            Mark::between(name, clock, [&put, &taken], 12)
        }
    };
    let overlaps = core.verilog.iter().any(|(name, _)| name.starts_with("overlap_add"));
    let there = |(name, _): &&(&str, &str)| *name != "overlap" || overlaps;
    let queue = |(name, path): &(&str, &str)| {
        let [put, taken] = ["pushed", "popped"].map(|count| format!("{path}.{count}_q"));
        Mark::between(name, calculator, [&put, &taken], queue::DEPTH.ilog2() as usize + 1)
    };
    let crossings = CROSSINGS.iter().map(crossing);
    let agents = WRITERS.iter().map(agent("sent")).chain(READERS.iter().map(agent("read_ptr")));
    crossings.chain(agents).chain(QUEUES.iter().filter(there).map(queue)).collect()
}

/// Largest fill of a FIFO by the model, and its capacity, with this memory (`late` cycles late) and these clocks.
pub(super) fn limit(name: &str, memory: &Memory, periods: Periods, late: u64) -> (usize, usize) {
    let pixel_cycles = |period: u64| (period / periods.core).max(1);
    let capacity = memory.agent_words();
    let word = |pixel_cycles: u64| memory.word_pixels() as u64 * pixel_cycles;
    let writer = |cycles: u64| agent_words(memory.burst_words, late, word(cycles)).min(capacity);
    match name {
        "input_fifo" => (crossing_words(periods.input, periods.core), CROSSING_PIXELS),
        // Full whenever the reader is slower.
        "output_fifo" | "raw_fifo" | "picture_fifo" => (CROSSING_PIXELS, CROSSING_PIXELS),
        "raw_writer" => (writer(pixel_cycles(periods.input)), capacity),
        "picture_writer" => (writer(1), capacity),
        // Readers request as much as they have space for.
        "raw_reader" | "picture_reader" => (capacity, capacity),
        _ => (queue::DEPTH, queue::DEPTH),
    }
}
