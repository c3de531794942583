//! Whole frames from raw pixels to codes, in Verilator, against the golden pipeline: what `edof reconstruct --board` writes.

use crate::common::{committed, networks};
use crate::streams::{Beat, Compiled, Pauses, assert_beats};
use edof_core::draw::Draw;
use edof_core::{CfaPhase, DisplayMode, RawFrame, Stride, Window};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_golden::{Curve, Display, Golden};
use edof_hdl::project;
use edof_hdl::video::display::TABLE_IMAGES;
use edof_hdl::video::stream_core::StreamCore;
use edof_network::FixedNetwork;
use ndarray::Array2;

fn design(window: usize, stride: usize, (height, width): (usize, usize)) -> Design {
    let mut design = committed("tiny");
    design.form.window = Window::new(window).unwrap();
    design.frame = FrameSize { width, height, stride: Stride::new(stride).unwrap() };
    design.check().unwrap();
    design
}

fn image(words: &[u64]) -> String {
    words.iter().map(|word| format!("{word:x}\n")).collect()
}

/// The core with its images.
fn compiled(design: &Design, sets: &[FixedNetwork; 2], display: &Display) -> Compiled {
    let luma: Vec<u64> = display.luma.entries().iter().map(|code| u64::from(*code)).collect();
    let colours = display
        .colours
        .each_ref()
        .map(|table| table.entries().iter().map(|entry| u64::from(*entry)).collect::<Vec<_>>());
    let mut images = project::images(design, [&sets[0], &sets[1]]);
    let contents = [&luma, &colours[0], &colours[1], &colours[2]].map(|words| image(words));
    images.extend(TABLE_IMAGES.map(String::from).into_iter().zip(contents));
    let core =
        StreamCore::new(design, [&sets[0], &sets[1]], &luma, colours.each_ref().map(Vec::as_slice)).unwrap();
    Compiled::new(core, images)
}

/// Smooth slopes with noise and an edge, so that codes are neither all the same nor all clipped.
fn raw(draw: &mut Draw, (height, width): (usize, usize)) -> RawFrame {
    let (right, down) = (draw.whole(-900, 900), draw.whole(-900, 900));
    let values = Array2::from_shape_fn((height, width), |(r, c)| {
        let edge = if c > width / 2 { 9000 } else { 0 };
        (20_000 + edge + right * c as i64 + down * r as i64 + draw.whole(-400, 400)).clamp(0, 65_535) as u16
    });
    RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap()
}

/// What leaves the board for a frame: pixel, first, last.
fn expected(golden: &Golden, display: &Display, raw: &RawFrame) -> Vec<Beat> {
    let width = raw.size().1;
    let bytes = golden.frame(raw).unwrap().picture(display).0.yuyv();
    let beat = |(i, bytes): (usize, &[u8])| {
        let ends = [i == 0, i % width == width - 1].map(u64::from);
        vec![u16::from_le_bytes([bytes[0], bytes[1]]).into(), ends[0], ends[1]]
    };
    bytes.chunks_exact(2).enumerate().map(beat).collect()
}

/// Five frames one after the other, of both sets of weights, in both modes, with pauses at both ends.
fn frames_are_as_golden(window: usize, stride: usize, size: (usize, usize)) {
    let design = design(window, stride, size);
    let sets = networks(&design, 7);
    let goldens = sets.clone().map(|network| Golden::new(network).unwrap());
    let start = Display::new(DisplayMode::Colour, Curve::Srgb);
    let core = compiled(&design, &sets, &start);
    for (mode, set, seed) in
        [(DisplayMode::Colour, 1, 1), (DisplayMode::Luma, 1, 2), (DisplayMode::Colour, 0, 3)]
    {
        let display = Display { mode, ..start.clone() };
        let draw = &mut Draw::new(seed);
        let mut bench = core.start(seed);
        for port in ["write_valid_i", "table_write_i", "clear_i", "flush_i"] {
            bench.poke(port, 0);
        }
        bench.poke("set_i", set as u64);
        bench.poke("colour_i", (mode == DisplayMode::Colour).into());
        bench.reset();
        let frames: Vec<RawFrame> = (0..5).map(|_| raw(draw, size)).collect();
        let pixels = frames.iter().flat_map(|raw| raw.pixels().iter().map(|pixel| vec![u64::from(*pixel)]));
        let (source, sink) = Pauses::KINDS[seed as usize % 4];
        bench.feed("pixels_", &["data"], pixels.collect(), source);
        bench.drain("picture_", &["data", "user", "last"], sink);
        let beats: Vec<Beat> = frames.iter().flat_map(|raw| expected(&goldens[set], &display, raw)).collect();
        let found = bench.run(beats.len());
        assert_beats(&format!("window {window}, stride {stride}, {mode}, set {set}"), &found, &beats);
        assert!(
            set == 0
                || beats.iter().map(|beat| beat[0]).collect::<std::collections::BTreeSet<_>>().len() > 50
        );
    }
}

#[test]
#[ignore = "edof_core has this form: scripts/soak.sh"]
fn window_8_stride_8() {
    frames_are_as_golden(8, 8, (26, 38));
}

#[test]
fn window_8_stride_2() {
    frames_are_as_golden(8, 2, (14, 16));
}

#[test]
fn window_12_stride_8() {
    frames_are_as_golden(12, 8, (26, 30));
}

#[test]
#[ignore = "edof_core has this form: scripts/soak.sh"]
fn window_12_stride_4() {
    frames_are_as_golden(12, 4, (18, 20));
}
