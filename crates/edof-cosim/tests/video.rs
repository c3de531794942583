//! The video side, block by block, against the golden pipeline: random pictures, random pauses on every stream, random contents of all
//! registers and memories at the start.

use crate::common::committed;
use crate::streams;
use crate::streams::{Beat, Compiled, Pauses, assert_beats};
use edof_core::display::{TO_LUMA, ToLuma};
use edof_core::draw::Draw;
use edof_core::number::{Fixed, InputWord, OutputWord};
use edof_core::{CfaPhase, DisplayMode, Frame422, Geometry, RawFrame, Stride, Window};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_golden::gamma::{ColourTable, LumaTable};
use edof_golden::overlap_add::overlap_add;
use edof_golden::trace::Counts;
use edof_golden::windows::window;
use edof_golden::{Curve, Display as GoldenDisplay};
use edof_hdl::video::display::{Display, TABLE_IMAGES};
use edof_hdl::video::lines::Lines;
use edof_hdl::video::window_reorder::WindowReorder;
use ndarray::Array2;

/// Two 16-bit words as a port has them, the first low.
fn pair(words: [impl Fixed<Bits = i16>; 2]) -> u64 {
    let [low, high] = words.map(|word| u64::from(word.to_bits().cast_unsigned()));
    low | high << 16
}

/// A design of `tiny`'s kind for another picture.
fn design(window: usize, stride: usize, (height, width): (usize, usize)) -> Design {
    let mut design = committed("tiny");
    design.form.window = Window::new(window).unwrap();
    design.frame = FrameSize { width, height, stride: Stride::new(stride).unwrap() };
    design.check().unwrap();
    design
}

fn words(draw: &mut Draw, size: (usize, usize)) -> Array2<OutputWord> {
    Array2::from_shape_simple_fn(size, || OutputWord::from_bits(draw.extreme(16)))
}

fn random_frame(draw: &mut Draw, (height, width): (usize, usize)) -> Frame422 {
    let chroma = [words(draw, (height, width / 2)), words(draw, (height, width / 2))];
    Frame422 { luma: words(draw, (height, width)), chroma }
}

/// A frame whose colours mostly can be shown.
fn moderate_frame(draw: &mut Draw, (height, width): (usize, usize)) -> Frame422 {
    let mut some = |min, max, size| {
        Array2::from_shape_simple_fn(size, || OutputWord::from_bits(draw.whole(min, max) as i16))
    };
    let luma = some(-500, 17000, (height, width));
    let chroma = [some(-3000, 3000, (height, width / 2)), some(-3000, 3000, (height, width / 2))];
    Frame422 { luma, chroma }
}

/// The pairs of pixels of a frame, as lines: luma, chroma, first, last.
fn raster(frame: &Frame422) -> Vec<Beat> {
    let (height, width) = frame.luma.dim();
    let beat = |row: usize, k: usize| {
        vec![
            pair([frame.luma[(row, 2 * k)], frame.luma[(row, 2 * k + 1)]]),
            pair([frame.chroma[0][(row, k)], frame.chroma[1][(row, k)]]),
            u64::from(row == 0 && k == 0),
            u64::from(k == width / 2 - 1),
        ]
    };
    (0..height).flat_map(|row| (0..width / 2).map(move |k| (row, k))).map(|(row, k)| beat(row, k)).collect()
}

/// A `$readmemh` image.
fn image(words: &[u64]) -> String {
    words.iter().map(|word| format!("{word:x}\n")).collect()
}

fn tables(display: &GoldenDisplay) -> (Vec<u64>, [Vec<u64>; 3]) {
    let luma = display.luma.entries().iter().map(|code| u64::from(*code)).collect();
    let colours = display
        .colours
        .each_ref()
        .map(|table| table.entries().iter().map(|entry| u64::from(*entry)).collect::<Vec<_>>());
    (luma, colours)
}

fn compiled_display(golden: &GoldenDisplay) -> Compiled {
    let (luma, colours) = tables(golden);
    let images = [&luma, &colours[0], &colours[1], &colours[2]].map(|words| image(words));
    let images = TABLE_IMAGES.map(String::from).into_iter().zip(images).collect();
    Compiled::new(Display::new(&luma, colours.each_ref().map(Vec::as_slice)), images)
}

/// The codes of a picture, as beats: pixel, first, last.
fn codes(golden: &GoldenDisplay, frame: &Frame422) -> (Vec<Beat>, [u64; 2]) {
    let size = frame.luma.dim();
    let (picture, counts) = golden.picture(frame, (0, 0), size);
    let bytes = picture.yuyv();
    let beats = bytes.chunks_exact(2).enumerate().map(|(i, bytes)| {
        let ends = [i == 0, i % size.1 == size.1 - 1].map(u64::from);
        vec![u16::from_le_bytes([bytes[0], bytes[1]]).into(), ends[0], ends[1]]
    });
    (beats.collect(), [counts.clamped_chroma, counts.out_of_gamut])
}

#[test]
fn display_gives_the_golden_codes_in_both_modes_with_any_tables() {
    let start = GoldenDisplay::new(DisplayMode::Colour, Curve::Srgb);
    let compiled = compiled_display(&start);
    for (round, (source, sink)) in (0..).zip(Pauses::KINDS) {
        let draw = &mut Draw::new(round);
        let mut golden = start.clone();
        let mut bench = compiled.start(round);
        bench.poke("clear_i", 0);
        bench.poke("table_write_i", 0);
        bench.reset();
        if round == 1 {
            load_random_tables(&mut golden, &mut bench, draw);
        }
        let size = (5, 2 * draw.whole(5, 40) as usize);
        for mode in [DisplayMode::Colour, DisplayMode::Luma, DisplayMode::Colour] {
            golden.mode = mode;
            let frames = [random_frame(draw, size), moderate_frame(draw, size)];
            let mut expected = (vec![], [0, 0]);
            for frame in &frames {
                let (beats, counts) = codes(&golden, frame);
                expected.0.extend(beats);
                expected.1 = [expected.1[0] + counts[0], expected.1[1] + counts[1]];
            }
            bench.poke("colour_i", (mode == DisplayMode::Colour).into());
            bench.poke("clear_i", 1);
            bench.step();
            bench.poke("clear_i", 0);
            bench.unbind();
            bench.feed(
                "",
                &["luma", "chroma", "first", "last"],
                frames.iter().flat_map(raster).collect(),
                source,
            );
            bench.drain("pixels_", &["data", "user", "last"], sink);
            let found = bench.run(expected.0.len());
            assert_beats(&format!("{mode} in round {round}"), &found, &expected.0);
            let counts = [bench.peek("clamped_chroma_o"), bench.peek("out_of_gamut_o")];
            assert_eq!(counts, expected.1, "{mode} in round {round}");
        }
    }
}

/// Replaces all entries of all tables, in the circuit by its port.
fn load_random_tables(golden: &mut GoldenDisplay, bench: &mut streams::Bench, draw: &mut Draw) {
    let luma: Vec<u8> = (0..1 << 15).map(|_| draw.whole(1, 254) as u8).collect();
    let mut colour = || (0..1 << 14).map(|_| draw.whole(0, 4095) as u16).collect::<Vec<_>>();
    let colours = [colour(), colour(), colour()];
    golden.luma = LumaTable::from_entries(luma).unwrap();
    golden.colours = colours.map(|entries| ColourTable::from_entries(entries).unwrap());
    load_tables(golden, bench);
}

/// Writes all tables by the circuit's port.
fn load_tables(golden: &GoldenDisplay, bench: &mut streams::Bench) {
    let (luma, colours) = tables(golden);
    bench.poke("table_write_i", 1);
    for (select, entries) in std::iter::once(&luma).chain(&colours).enumerate() {
        bench.poke("table_select_i", select as u64);
        for (address, entry) in entries.iter().enumerate() {
            bench.poke("table_address_i", address as u64);
            bench.poke("table_data_i", *entry);
            bench.step();
        }
    }
    bench.poke("table_write_i", 0);
}

/// Red, green and blue after their tables, whose sum lies so that a unit more or less gives another luma code.
fn decided_by_a_unit(draw: &mut Draw, remainder: i64) -> [u16; 3] {
    let unit = 1i64 << ToLuma::FRAC_NBITS;
    let sum = |colours: [u16; 3]| {
        TO_LUMA
            .iter()
            .zip(colours)
            .map(|(factor, colour)| i64::from(factor.to_bits()) * i64::from(colour))
            .sum::<i64>()
    };
    let mut all = std::iter::repeat_with(|| [0; 3].map(|_: u16| draw.whole(0, 4095) as u16));
    all.find(|colours| (sum(*colours) + unit / 2).rem_euclid(unit) == remainder.rem_euclid(unit)).unwrap()
}

#[test]
fn luma_is_rounded_as_the_contract_says_where_a_unit_decides() {
    let mut golden = GoldenDisplay::new(DisplayMode::Colour, Curve::Linear);
    let compiled = compiled_display(&golden);
    for (seed, remainder) in [(1, 0), (2, -1)] {
        let colours = decided_by_a_unit(&mut Draw::new(seed), remainder);
        golden.colours = colours.map(|colour| ColourTable::from_entries(vec![colour; 1 << 14]).unwrap());
        let mut bench = compiled.start(seed);
        for (port, value) in [("clear_i", 0), ("table_write_i", 0), ("colour_i", 1)] {
            bench.poke(port, value);
        }
        bench.reset();
        load_tables(&golden, &mut bench);
        let frame = moderate_frame(&mut Draw::new(seed), (2, 8));
        bench.feed("", &["luma", "chroma", "first", "last"], raster(&frame), Pauses::NEVER);
        bench.drain("pixels_", &["data", "user", "last"], Pauses::NEVER);
        let expected = codes(&golden, &frame).0;
        assert_beats(&format!("{colours:?}"), &bench.run(expected.len()), &expected);
    }
}

#[test]
fn display_gives_a_pixel_a_cycle_and_takes_no_longer_than_it_says() {
    let golden = GoldenDisplay::new(DisplayMode::Colour, Curve::Linear);
    let mut bench = compiled_display(&golden).start(1);
    bench.poke("clear_i", 0);
    bench.poke("table_write_i", 0);
    bench.poke("colour_i", 1);
    bench.reset();
    let frame = moderate_frame(&mut Draw::new(2), (4, 40));
    bench.feed("", &["luma", "chroma", "first", "last"], raster(&frame), Pauses::NEVER);
    bench.drain("pixels_", &["data", "user", "last"], Pauses::NEVER);
    let times: Vec<u64> = bench.run_timed(4 * 40).into_iter().map(|(cycle, _)| cycle).collect();
    assert!(times.windows(2).all(|two| two[1] == two[0] + 1), "{times:?}");
    assert!(times[0] < 32, "{}", times[0]);
}

/// Patches of random words, those of each frame in order, as beats and as the frame that they add up to.
fn patches(draw: &mut Draw, design: &Design, extreme: bool) -> (Vec<Beat>, Frame422, u64) {
    let geometry = Geometry::new(design.form.window, design.frame.stride);
    let size = (design.frame.height, design.frame.width);
    let mut beats = vec![];
    let mut counts = Counts::new(2);
    let patch = |_, _| {
        let words: Vec<OutputWord> = (0..128)
            .map(|_| if extreme { draw.extreme(16) } else { draw.whole(-2000, 2000) as i16 })
            .map(OutputWord::from_bits)
            .collect();
        beats.extend(words.chunks_exact(2).map(|two| vec![pair([two[0], two[1]])]));
        words
    };
    let frame = overlap_add(geometry, size, patch, &mut counts);
    (beats, frame, counts.saturated_sums)
}

#[test]
fn patches_become_the_lines_of_the_golden_frame_at_all_strides() {
    for (stride, size) in [(8, (20, 26)), (4, (18, 22)), (2, (14, 18))] {
        let design = design(8, stride, size);
        let compiled = Compiled::new(Lines::of(&design), vec![]);
        for (round, (source, sink)) in (0..).zip(Pauses::KINDS) {
            let draw = &mut Draw::new(round);
            let mut bench = compiled.start(round);
            bench.poke("clear_i", 0);
            bench.reset();
            let (mut beats, mut expected, mut saturated) = (vec![], vec![], 0);
            for frame in 0..3 {
                let (more, frame, count) = patches(draw, &design, frame == 1);
                beats.extend(more);
                expected.extend(raster(&frame));
                saturated += count;
            }
            bench.feed("", &["data"], beats, source);
            bench.drain("out_", &["luma", "chroma", "first", "last"], sink);
            let found = bench.run(expected.len());
            assert_beats(&format!("stride {stride}, {size:?}, round {round}"), &found, &expected);
            assert_eq!(bench.peek("saturated_sums_o"), if stride == 8 { 0 } else { saturated });
            assert!(stride == 8 || saturated > 0);
        }
    }
}

/// A raw frame of random sensor values.
fn random_raw(draw: &mut Draw, (height, width): (usize, usize)) -> RawFrame {
    let values = Array2::from_shape_simple_fn((height, width), || draw.bits() as u16);
    RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap()
}

/// A raw frame as lines.
fn raw_beats(raw: &RawFrame) -> Vec<Beat> {
    raw.pixels().iter().map(|pixel| vec![u64::from(*pixel)]).collect()
}

/// All windows of a frame, two words a beat: pixels, last, set.
fn window_beats(raw: &RawFrame, design: &Design, set: u64) -> Vec<Beat> {
    let geometry = Geometry::new(design.form.window, design.frame.stride);
    let (rows, columns) = geometry.patches(design.frame.height, design.frame.width);
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let beats = places.flat_map(|(row, column)| {
        let words = window(raw, geometry, row, column);
        let last = words.len() / 2 - 1;
        let beat = |(i, two): (usize, &[InputWord])| vec![pair([two[0], two[1]]), u64::from(i == last), set];
        words.chunks_exact(2).enumerate().map(beat).collect::<Vec<_>>()
    });
    beats.collect()
}

#[test]
fn lines_become_the_golden_windows_at_all_sides_and_strides() {
    let cases = [
        (8, 8, (10, 10)),
        (8, 4, (18, 22)),
        (12, 8, (26, 30)),
        (12, 2, (14, 12)),
        (16, 8, (34, 20)),
        (16, 2, (14, 14)),
    ];
    for (side, stride, size) in cases {
        let design = design(side, stride, size);
        let compiled = Compiled::new(WindowReorder::of(&design), vec![]);
        for (round, (source, sink)) in (0..).zip(Pauses::KINDS) {
            let draw = &mut Draw::new(round);
            let mut bench = compiled.start(round);
            let set = round % 2;
            bench.poke("set_i", set);
            bench.reset();
            let frames: Vec<RawFrame> = (0..3).map(|_| random_raw(draw, size)).collect();
            bench.feed("pixels_", &["data"], frames.iter().flat_map(raw_beats).collect(), source);
            bench.drain("out_", &["pixels", "last", "set"], sink);
            let expected: Vec<Beat> =
                frames.iter().flat_map(|frame| window_beats(frame, &design, set)).collect();
            let found = bench.run(expected.len());
            let what = format!("window {side}, stride {stride}, {size:?}, round {round}");
            assert_beats(&what, &found, &expected);
        }
    }
}

#[test]
fn windows_follow_one_another_without_a_pause_and_frames_too() {
    let design = design(12, 8, (40, 64));
    let compiled = Compiled::new(WindowReorder::of(&design), vec![]);
    let mut bench = compiled.start(3);
    bench.poke("set_i", 0);
    bench.reset();
    let draw = &mut Draw::new(4);
    let frames: Vec<RawFrame> = (0..3).map(|_| random_raw(draw, (40, 64))).collect();
    bench.feed("pixels_", &["data"], frames.iter().flat_map(raw_beats).collect(), Pauses::NEVER);
    bench.drain("out_", &["pixels", "last", "set"], Pauses::NEVER);
    let (beats, rows) = (3 * 5 * 8 * 72, 3 * 5);
    let times = bench.run_timed(beats);
    let spent = times[beats - 1].0 - times[0].0;
    // Between rows of windows it pauses as long as its header says; never for lines, which come faster than they are needed.
    assert!(spent <= (beats + 13 * rows) as u64, "{spent} cycles for {beats} beats");
}
