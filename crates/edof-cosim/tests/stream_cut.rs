//! Registers in a stream: every beat once and in order, and what the bench says of a stream that takes its offers back.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::bench::{Beat, Bench, Receiver, Sender, Throttle};
use edof_cosim::verilator::{Library, Start};
use edof_cosim::{Error, Source};
use edof_hdl::ports::StreamCut;

fn source() -> Source {
    Source::circuit(&mut StreamCut::<16>::default()).unwrap()
}

fn beats(seed: u64) -> Vec<Beat> {
    let draw = &mut Draw::new(seed);
    let beat =
        |_| Beat { data: draw.bits() & 0xffff, user: draw.whole(0, 9) == 0, last: draw.whole(0, 9) == 0 };
    (0..2_000).map(beat).collect()
}

fn through(source: &Source, seed: u64) -> Result<Vec<Beat>, Error> {
    let library = Library::build(source, &support::options())?;
    let mut bench = Bench::new(library.start(&Start { seed, ..Start::default() })?, seed);
    let clock = bench.clock("clock_i", 5_000)?;
    let mut sender = Sender::new(source, "from", clock, "reset_i", Throttle::drawn(seed))?;
    let mut receiver = Receiver::new(source, "to", clock, "reset_i", Throttle::drawn(seed + 1))?;
    sender.beats = beats(seed).into();
    for (level, steps) in [(1, 5), (0, 20_000)] {
        bench.set("reset_i", level)?;
        bench.steps(steps, &mut [&mut sender, &mut receiver])?;
    }
    Ok(receiver.beats)
}

#[test]
fn every_beat_passes_once_and_in_order() {
    for seed in 0..4 {
        assert_eq!(through(&source(), seed).unwrap(), beats(seed));
    }
}

/// Changes what is assigned to an output, alone or beside others.
fn change(text: &mut String, output: &str, by: &str) {
    let start = text.find(&format!(" {output} = ")).unwrap() + output.len() + 4;
    let end = start + text[start..].find([',', ';']).unwrap();
    text.insert_str(end, by);
}

#[test]
fn a_stream_that_takes_its_offers_back_is_found_out() {
    let mut source = source();
    let (_, text) = source.files.iter_mut().find(|(name, _)| name.starts_with("stream_cut")).unwrap();
    change(text, "to_valid_o", " && from_valid_i");
    let error = through(&source, 1).unwrap_err().to_string();
    assert!(error.starts_with("to, edge ") && error.contains("no longer offered"), "{error}");
}

#[test]
fn a_beat_that_changes_while_it_stands_is_found_out() {
    let mut source = source();
    let (_, text) = source.files.iter_mut().find(|(name, _)| name.starts_with("stream_cut")).unwrap();
    change(text, "to_data_o", " ^ from_data_i");
    let error = through(&source, 1).unwrap_err().to_string();
    assert!(error.contains("changed before it was taken"), "{error}");
}
