//! A frame of 1920 × 1080 through the files that the bitstream is made of: bursts, FIFOs, lines and counters are those of `kc705`. Its
//! calculator alone is a small one, so that a simulation ends.

use crate::common::{committed, networks};
use edof_cosim::system::{self, Compiled, Rig, RigConfig, compare, drawn, sent};
use edof_cosim::verilator::Options;
use edof_device::Design;
use edof_golden::{Curve, Display, Golden};
use edof_hdl::project::{self, Project};
use edof_image::DisplayMode;
use std::collections::BTreeSet;

/// `kc705` with the calculator of `tiny`.
fn stand_in() -> Design {
    let (kc705, mut design) = (committed("kc705"), committed("tiny"));
    (design.form.window, design.frame) = (kc705.form.window, kc705.frame);
    design.check().unwrap();
    design
}

fn display() -> Display {
    Display::new(DisplayMode::Colour, Curve::Srgb)
}

fn core(design: &Design) -> Project {
    let sets = networks(design, 7);
    system::project(design, sets.each_ref(), &display()).unwrap()
}

/// A module without the comments that name lines of its source.
fn code<'a>(project: &'a Project, file: &str) -> Vec<&'a str> {
    let text = project.verilog.iter().find(|(name, _)| name == file).map_or("", |(_, text)| text.as_str());
    text.lines().filter(|line| !line.trim_start().starts_with("//")).collect()
}

/// What connects the calculator, states the design's hash, and knows how many rows the stages have.
const AROUND_THE_CALCULATOR: [&str; 4] =
    ["bank_guard.v", "board_registers.v", "edof_core.v", "stream_core.v"];

#[test]
fn around_the_calculator_the_stand_in_has_the_files_of_kc705() {
    let (kc705, small) = (core(&committed("kc705")), core(&stand_in()));
    let design = stand_in();
    let sets = networks(&design, 7);
    let calculator = project::calculator(&design, sets.each_ref()).unwrap().verilog;
    let calculator: BTreeSet<String> = calculator.into_iter().map(|(name, _)| name).collect();
    let files: Vec<&String> = small.verilog.iter().map(|(name, _)| name).collect();
    let is_around =
        |name: &&&String| !calculator.contains(**name) && !AROUND_THE_CALCULATOR.contains(&name.as_str());
    let around: Vec<&&String> = files.iter().filter(is_around).collect();
    let differ: Vec<&&&String> =
        around.iter().filter(|file| code(&small, file) != code(&kc705, file)).collect();
    assert!(differ.is_empty(), "{differ:?}");
    for module in [
        "write_agent",
        "read_agent",
        "axi_pair",
        "video_in",
        "video_out",
        "window_reorder",
        "lines",
        "display",
    ] {
        assert!(around.iter().any(|file| file.starts_with(module)), "{module} is not compared");
    }
}

#[test]
#[ignore = "a quarter of an hour: scripts/soak.sh"]
fn a_frame_of_1080p_passes_the_files_of_the_bitstream_bit_for_bit() {
    let design = stand_in();
    let golden = Golden::new(networks(&design, 7)[0].clone()).unwrap();
    let frame = drawn(design.frame, 1, 3).unwrap().remove(0);
    let picture = system::picture(&golden, &display(), &frame).unwrap();
    // A run of minutes: the compiler's time is won back.
    let options = Options { optimize: 2, ..crate::support::options() };
    let compiled = Compiled::new(&core(&design), &options).unwrap();
    let begin = RigConfig::leisurely(&design, 1);
    let mut rig = Rig::start(&compiled, &begin, vec![sent(&frame)]).unwrap();
    rig.control(DisplayMode::Colour, 0).unwrap();
    let is_picture = |rig: &Rig| {
        let shown = compare(&rig.screen.frames, std::slice::from_ref(&picture), design.frame.width);
        shown.unwrap_or_else(|torn| panic!("{torn}")).iter().any(Option::is_some)
    };
    for frames in 1.. {
        rig.show(1).unwrap();
        println!("{frames} frames on the screen, {:.1} ms", rig.bench.time_ps() as f64 * 1e-9);
        if is_picture(&rig) {
            break;
        }
        assert!(frames < 8, "no picture after {frames} frames");
    }
    for name in ["input_broken", "input_wrong", "input_overruns", "raw_read_errors", "output_underruns"] {
        assert_eq!(rig.register(name).unwrap(), 0, "{name}");
    }
    for fifo in rig.fifos(&begin).unwrap() {
        assert!(fifo.max > 0 && fifo.max <= fifo.limit && fifo.limit <= fifo.depth, "{fifo:?}");
    }
}
