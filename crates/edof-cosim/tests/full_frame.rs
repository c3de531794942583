//! A frame of 1920 × 1080 through the files that the bitstream is made of: bursts, FIFOs, lines, counters and clocks are those of `kc705`.
//! The calculator alone is a small one of two stages, so that a simulation ends; it keeps up with the camera as that of `kc705` does.

use crate::common::{committed, networks};
use edof_core::DisplayMode;
use edof_cosim::bench::Behaviour;
use edof_cosim::system::{self, Compiled, Rig, RigConfig, compare, drawn, sent};
use edof_cosim::verilator::Options;
use edof_device::Design;
use edof_device::design::StageSize;
use edof_device::video::VideoTiming;
use edof_golden::video::figures::Periods;
use edof_golden::{Curve, Display, Golden};
use edof_hdl::project::{self, Project};
use edof_network::network::Form;
use std::collections::BTreeSet;
use std::time::Instant;

/// `kc705` with a small calculator, which takes about as many cycles per patch.
fn stand_in() -> Design {
    let kc705 = committed("kc705");
    let form = Form { codes: 16, layers: 2, linear_path: false, ..kc705.form };
    let stages = vec![StageSize { lanes: 8, rows: 4 }, StageSize { lanes: 16, rows: 2 }];
    let design = Design { form, stages, ..kc705 };
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

/// Frames on the screen until the picture of the camera's first frame is there: one is received, one computed, one waited for.
const SHOWN: usize = 5;

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_frame_of_1080p_passes_the_files_of_the_bitstream_bit_for_bit() {
    let design = stand_in();
    let golden = Golden::new(networks(&design, 7)[1].clone()).unwrap();
    let frame = drawn(design.frame, 1, 3).unwrap().remove(0);
    let picture = system::picture(&golden, &display(), &frame).unwrap();
    let different: BTreeSet<u16> = picture.iter().copied().collect();
    assert!(different.len() > 200, "a picture of {} words shows no exchanged pixels", different.len());
    // A run of minutes: the compiler's time is won back.
    let options = Options { optimize: 2, ..crate::support::options() };
    let compiled = Compiled::new(&core(&design), &options).unwrap();
    let (timing, periods) = (VideoTiming::of_frame(design.frame), Periods::of_board(&design));
    let begin =
        RigConfig { timing, periods, behaviour: Behaviour::hard(1), ..RigConfig::leisurely(&design, 1) };
    let mut rig = Rig::start(&compiled, &begin, vec![sent(&frame)]).unwrap();
    rig.control(DisplayMode::Colour, 1).unwrap();
    let is_picture = |rig: &Rig| {
        let shown = compare(&rig.screen.frames, std::slice::from_ref(&picture), design.frame.width);
        shown.unwrap_or_else(|torn| panic!("{torn}")).iter().any(Option::is_some)
    };
    let start = Instant::now();
    for frames in 1.. {
        rig.show(1).unwrap();
        let (simulated, took) = (rig.bench.time_ps() as f64 * 1e-9, start.elapsed().as_secs_f64());
        println!("{frames} frames on the screen, {simulated:.1} ms, simulated in {took:.0} s");
        if is_picture(&rig) {
            break;
        }
        assert!(frames < SHOWN, "no picture after {frames} frames");
    }
    for name in ["input_broken", "input_wrong", "input_overruns", "raw_read_errors", "output_underruns"] {
        assert_eq!(rig.register(name).unwrap(), 0, "{name}");
    }
    for fifo in rig.fifos(&begin).unwrap() {
        assert!(fifo.max > 0 && fifo.max <= fifo.limit && fifo.limit <= fifo.depth, "{fifo:?}");
    }
}
