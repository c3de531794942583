//! The longest path of logic of the blocks around the calculator, and what they take, as Yosys maps them for `kc705`.

mod common;
mod support;

use common::committed;
use edof_cosim::yosys::timing::{self, StageTiming};
use edof_hdl::describe::Circuit;
use edof_hdl::project;
use edof_hdl::video::display::Display;
use edof_hdl::video::overlap_add::OverlapAdd;
use edof_hdl::video::patch_pairs::PatchPairs;
use edof_hdl::video::raster_reorder::RasterReorder;
use edof_hdl::video::video_in::VideoIn;
use edof_hdl::video::video_out::VideoOut;
use edof_hdl::video::window_reorder::WindowReorder;
use edof_spec::Stride;
use edof_spec::design::Design;
use edof_spec::video::VideoTiming;
use std::path::Path;

/// Half of a period at 200 MHz: wires get the rest.
const CORE_PS: u64 = 2500;
/// About half of a period at 148.5 MHz.
const PIXEL_PS: u64 = 3300;

fn timed(mut block: impl Circuit) -> StageTiming {
    let mut project = project::of_circuit(&mut block, vec![]).unwrap();
    // Contents of memories are no matter of timing, and reading them is.
    for (_, text) in &mut project.verilog {
        let line = |line: &str| match line.trim_start().starts_with(".INIT(\"") {
            true => "        .INIT(\"\")\n".to_string(),
            false => format!("{line}\n"),
        };
        *text = text.lines().map(line).collect();
    }
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR")).join("timing");
    timing::whole(&project, Some(&cache)).unwrap()
}

#[track_caller]
fn keeps(found: &StageTiming, limit: u64) {
    assert!(found.delay_ps <= limit, "{found:#?}");
    assert!(found.levels > 0);
}

fn with_stride(stride: usize) -> Design {
    let mut design = committed("kc705");
    design.frame.stride = Stride::new(stride).unwrap();
    design
}

#[test]
fn window_reorder_keeps_half_of_its_period() {
    keeps(&timed(WindowReorder::of(&committed("kc705"))), CORE_PS);
}

#[test]
fn patch_pairs_keep_half_of_their_period() {
    keeps(&timed(PatchPairs::default()), CORE_PS);
}

#[test]
fn overlap_add_keeps_half_of_its_period() {
    for stride in [4, 2] {
        keeps(&timed(OverlapAdd::of(&with_stride(stride)).unwrap()), CORE_PS);
    }
}

#[test]
fn raster_reorder_keeps_half_of_its_period() {
    keeps(&timed(RasterReorder::of(&committed("kc705"))), CORE_PS);
}

#[test]
fn display_keeps_half_of_its_period_with_ten_multipliers_all_registered() {
    let (luma, colour) = (vec![0; 1 << 15], vec![0; 1 << 14]);
    let found = timed(Display::new(&luma, [&colour, &colour, &colour]));
    keeps(&found, CORE_PS);
    assert_eq!(found.dsps, 10);
}

#[test]
fn the_pins_keep_half_of_the_pixel_clocks_period() {
    let frame = committed("kc705").frame;
    keeps(&timed(VideoIn::new(frame, 1 << 23)), PIXEL_PS);
    keeps(&timed(VideoOut::new(VideoTiming::of_frame(frame))), PIXEL_PS);
}
