//! The controller of an SDRAM between a master that stalls at random and a chip of its data sheet: every word is what was written, and no rule of the chip is broken.

use crate::axi_master::{Master, Shape};
use crate::support;
use edof_cosim::bench::Bench;
use edof_cosim::system::SdramChip;
use edof_cosim::verilator::{Library, Start};
use edof_cosim::{Error, Source};
use edof_device::board::ULX3S;
use edof_hdl::board::AxiSdram;

/// Three areas around ends of rows, in other banks and rows: 64 words are a row of a bank.
const SHAPE: Shape = Shape { areas: [3, 80, 64 * 4 * 5 + 40], longest: 64 };

/// The controller at a clock in kHz; its text may have been edited.
fn library(khz: u64, edit: impl Fn(String) -> String) -> Library {
    let mut source = Source::circuit(&mut AxiSdram::new(khz)).unwrap();
    let (_, text) = source.files.iter_mut().find(|(name, _)| name == "axi_sdram.v").unwrap();
    *text = edit(std::mem::take(text));
    Library::build(&source, &support::options()).unwrap()
}

/// So many cycles of it with a master and the chip.
fn run(
    library: &Library,
    khz: u64,
    seed: u64,
    (shape, stalls): (Shape, bool),
    cycles: usize,
) -> Result<(Master, SdramChip), Error> {
    let source = library.source();
    let model = library.start(&Start { seed, ..Start::default() }).unwrap();
    let mut bench = Bench::new(model, seed);
    let period = 1_000_000_000 / khz;
    let clock = bench.clock("clock_i", period).unwrap();
    let mut chip = SdramChip::new(source, "", clock, period).unwrap();
    bench.set("reset_i", 1).unwrap();
    bench.steps(16, &mut [&mut chip]).unwrap();
    bench.set("reset_i", 0).unwrap();
    // The chip powers up.
    while bench.get("ready_o").unwrap() == 0 {
        assert!(bench.time_ps() < 210_000_000, "not ready after 210 µs");
        bench.steps(100, &mut [&mut chip])?;
    }
    let mut master = Master::new(source, clock, shape, seed, stalls);
    bench.steps(cycles, &mut [&mut master, &mut chip])?;
    Ok((master, chip))
}

#[test]
fn words_are_read_as_they_were_answered_and_the_chips_rules_hold() {
    for (khz, seed) in [(50_000, 1), (100_000, 2), (133_000, 3)] {
        let library = library(khz, |text| text);
        let (master, chip) = run(&library, khz, seed, (SHAPE, true), 100_000).unwrap();
        assert!(master.done.iter().all(|bursts| *bursts > 100), "{khz} kHz: {:?}", master.done);
        assert!(master.partial_words > 100, "{} words in part", master.partial_words);
        let intervals = 100_000 * 128 / khz as usize;
        assert!(chip.refreshes() >= intervals, "{} refreshes, {intervals} expected", chip.refreshes());
    }
}

#[test]
fn a_burst_takes_at_most_what_the_boards_agents_allow_and_the_chip_is_rarely_idle() {
    let khz = ULX3S.core_khz.into();
    let shape = Shape { longest: ULX3S.memory.burst_words as u64, ..SHAPE };
    let (master, _) = run(&library(khz, |text| text), khz, 1, (shape, false), 60_000).unwrap();
    assert!(
        master.latest.iter().all(|cycles| *cycles <= ULX3S.memory.max_burst_cycles),
        "{:?}",
        master.latest
    );
    // Eight cycles a word, of bursts of 8 on average.
    let busy = 8 * 8 * master.done.iter().sum::<u64>();
    assert!(busy > 36_000, "{busy} of 60,000 cycles: {:?}", master.done);
}

#[test]
fn mistakes_in_the_controller_are_found() {
    const KHZ: u64 = 133_000;
    for (right, wrong) in [
        ("AFTER_ACTIVE = 5'd5", "AFTER_ACTIVE = 5'd0"),
        ("AFTER_PRECHARGE = 5'd2", "AFTER_PRECHARGE = 5'd1"),
        ("AFTER_REFRESH = 5'd8", "AFTER_REFRESH = 5'd7"),
        ("AFTER_WRITE = 5'd8", "AFTER_WRITE = 5'd7"),
        ("quiet_q <= 5'd11;", "quiet_q <= 5'd10;"),
        ("due_q <= 1'b1;", "due_q <= 1'b0;"),
        ("address_q <= 13'd51;", "address_q <= 13'd35;"),
        ("mask_q <= masks_q[1:0];", "mask_q <= 2'd0;"),
        ("open_q && (row == open_row_q)", "open_q"),
        ("(|to_ask_q) && queue_space", "(|to_ask_q)"),
    ] {
        let library = library(KHZ, |text| {
            assert!(text.contains(right), "{right}: {text}");
            text.replace(right, wrong)
        });
        let tried = || run(&library, KHZ, 1, (SHAPE, true), 60_000);
        let found = std::panic::catch_unwind(std::panic::AssertUnwindSafe(tried));
        assert!(found.map_or(true, |result| result.is_err()), "{wrong} is not found");
    }
}
