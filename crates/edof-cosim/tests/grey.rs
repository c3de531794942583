//! Raw frames in grey: the block that joins them is its model in every cycle, and the whole core shows their pictures.

use crate::edof_core::{Setup, design};
use crate::streams::{Bench, Compiled};
use edof_core::draw::Draw;
use edof_core::{CfaPhase, DisplayMode, RawFrame, Stride};
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::system::{Rig, drawn, longest_run};
use edof_device::design::FrameSize;
use edof_device::pattern::TILE_SIDE;
use edof_device::registers::map::{self, PICTURE_PIXELS};
use edof_golden::video::grey::{carried, halves};
use edof_golden::video::video_in::Beat;
use edof_golden::video::{GreyJoin as Model, greys};
use edof_hdl::video::grey_join::GreyJoin;
use ndarray::Array2;

const FRAME: FrameSize = FrameSize { width: 36, height: 4, stride: Stride::PATCH };

/// The block and its model, cycle by cycle.
struct Both {
    bench: Bench,
    model: Model,
    draw: Draw,
    taken: Vec<Beat>,
}

impl Both {
    fn new(compiled: &Compiled, seed: u64) -> Self {
        let mut bench = compiled.start(seed);
        bench.poke("grey_i", 0);
        bench.poke("source_valid_i", 0);
        bench.reset();
        Self { bench, model: Model::new(FRAME.height), draw: Draw::new(seed), taken: vec![] }
    }

    /// One cycle; whether the pixel was taken.
    fn cycle(&mut self, grey: bool, source: Option<Beat>, ready: bool) -> bool {
        let beat = source.unwrap_or(Beat {
            pixel: self.draw.bits() as u16,
            first: self.draw.whole(0, 1) == 0,
            last: true,
        });
        let inputs = [
            ("grey_i", grey.into()),
            ("source_valid_i", source.is_some().into()),
            ("source_data_i", u64::from(beat.pixel)),
            ("source_user_i", beat.first.into()),
            ("source_last_i", beat.last.into()),
            ("pixels_ready_i", ready.into()),
        ];
        inputs.into_iter().for_each(|(port, value)| self.bench.poke(port, value));
        let expected = self.model.beat(source);
        assert_eq!(self.bench.peek("pixels_valid_o") == 1, expected.is_some());
        if let Some(beat) = expected {
            let found = ["pixels_data_o", "pixels_user_o", "pixels_last_o"].map(|port| self.bench.peek(port));
            let expected: [u64; 3] = [beat.pixel.into(), beat.first.into(), beat.last.into()];
            assert_eq!(found, expected);
            self.taken.extend(ready.then_some(beat));
        }
        let takes = self.model.takes(source, ready);
        if source.is_some() {
            assert_eq!(self.bench.peek("source_ready_o") == 1, takes);
        }
        self.model.step(grey, source, ready);
        self.bench.model.tick().unwrap();
        takes
    }

    /// Sends pixels with random pauses on both sides, one cycle of 16 each as `pauses` says.
    fn send(&mut self, grey: bool, beats: &[Beat], pauses: i64) {
        for beat in beats {
            while self.draw.whole(0, 15) < pauses {
                self.cycle(grey, None, true);
            }
            loop {
                let ready = self.draw.whole(0, 15) >= pauses;
                if self.cycle(grey, Some(*beat), ready) {
                    break;
                }
            }
        }
    }
}

fn random(draw: &mut Draw) -> RawFrame {
    let words = Array2::from_shape_simple_fn((FRAME.height, FRAME.width), || draw.bits() as u16);
    RawFrame::from_values(words, 16, CfaPhase::Rggb).unwrap()
}

/// A half as the receiver's bus passes it on; chroma is near its middle.
fn beats(draw: &mut Draw, codes: &Array2<u8>) -> Vec<Beat> {
    let width = codes.ncols();
    let beat = |((row, column), code): ((usize, usize), &u8)| Beat {
        pixel: (u16::from(*code) - 64) << 9 | (draw.whole(60, 68) as u16) << 2,
        first: (row, column) == (0, 0),
        last: column + 1 == width,
    };
    codes.indexed_iter().map(beat).collect()
}

#[test]
fn halves_are_joined_as_the_model_says_whatever_comes() {
    let compiled = Compiled::new(GreyJoin::new(FRAME), vec![]);
    for seed in 0..12 {
        let mut both = Both::new(&compiled, seed);
        let draw = &mut Draw::new(seed);
        let pauses = [0, 3, 9][seed as usize % 3];
        let frames = [random(draw), random(draw)];
        for _ in 0..30 {
            let frame = draw.whole(0, 1) as usize;
            let sent = halves(&frames[frame]).map(|half| beats(draw, &half));
            for mut half in sent {
                match draw.whole(0, 9) {
                    0 => half.truncate(draw.whole(0, half.len() as i64) as usize),
                    1 => half.clear(),
                    2 => half[draw.whole(0, 143) as usize].pixel ^= 1 << draw.whole(9, 15),
                    3 => half[draw.whole(0, 143) as usize].last ^= true,
                    4 => half[draw.whole(0, 143) as usize].first ^= true,
                    5 => both.send(false, &half.clone()[..draw.whole(0, 143) as usize], pauses),
                    _ => {}
                }
                both.send(true, &half, pauses);
            }
        }
        // Whole ones at the end come whole.
        both.taken.clear();
        let frame = random(draw);
        for half in halves(&frame) {
            both.send(true, &beats(draw, &half), pauses);
        }
        for _ in 0..3 {
            both.cycle(true, None, true);
        }
        let taken: Vec<&Beat> = both.taken.iter().skip_while(|beat| !beat.first).collect();
        let words: Vec<u16> = taken.iter().map(|beat| beat.pixel).collect();
        assert_eq!(words, carried(&frame).pixels().iter().copied().collect::<Vec<_>>(), "seed {seed}");
        assert_eq!(taken.iter().filter(|beat| beat.last).count(), FRAME.height);
    }
}

/// Words that the rig's camera sends as such luma and chroma.
fn words(luma: &Array2<u8>) -> Vec<u16> {
    luma.iter().map(|code| (u16::from(*code) - 64) << 9 | 64 << 2).collect()
}

fn set(rig: &mut Rig, video_setup: u32) {
    rig.access(Access::Write(map::VIDEO_SETUP, map::VIDEO_SETUP_RESET | video_setup)).unwrap();
}

#[test]
fn the_core_shows_frames_in_grey_and_counts_halves_alone() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let frames = drawn(setup.design.frame, 4, 5).unwrap();
    let cable: Vec<Vec<u16>> = frames.iter().flat_map(halves).map(|half| words(&half)).collect();
    // The first half comes before the first vertical sync; then a lower one alone, a frame, a lower and an upper one alone, and frames.
    let order = [0, 1, 0, 1, 3, 4, 2, 3, 4, 5, 6, 7];
    let mut rig = setup.start_with(order.iter().map(|half| cable[*half].clone()).collect(), 5);
    set(&mut rig, map::GREY);
    rig.control(DisplayMode::Colour, 0).unwrap();
    rig.send(order.len() - 1).unwrap();
    rig.show(3).unwrap();
    let arrive: Vec<RawFrame> = frames.iter().map(carried).collect();
    let shown = setup.shown(&rig, &setup.pictures(&arrive, 0, DisplayMode::Colour));
    assert!(longest_run(&shown) >= 3, "{shown:?}");
    assert_eq!(shown.last(), Some(&Some(3)), "{shown:?}");
    // The lone lower half and the lone upper half, and those that the camera repeats at its end.
    assert!(rig.register("input_broken").unwrap() >= 2);
    for name in ["input_wrong", "input_range", "input_overruns"] {
        assert_eq!(rig.register(name).unwrap(), 0, "{name}");
    }
}

#[test]
fn the_host_reads_a_chart_pixel_by_pixel() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let FrameSize { width, height, .. } = setup.design.frame;
    // The rig's camera sends codes of 64 to 191 alone.
    let codes = greys::chart(height, width).mapv(|grey| 64 + grey % 128);
    let mut rig = setup.start_with(vec![words(&codes)], 6);
    set(&mut rig, map::PLAIN);
    rig.control(DisplayMode::Colour, 0).unwrap();
    let (row, column) = (2, 6);
    rig.access(Access::Write(map::PICTURE_CORNER, map::RAW_WORDS | row << 16 | column)).unwrap();
    rig.show(6).unwrap();
    for (r, c) in (row as usize..height).flat_map(|r| (column as usize..width).map(move |c| (r, c))) {
        let address = PICTURE_PIXELS.word(((r - row as usize) * TILE_SIDE + c - column as usize) as u32);
        let expected = u32::from(codes[(r, c)]) << 8 | 128;
        assert_eq!(rig.access(Access::Read(address)).unwrap(), expected, "row {r}, column {c}");
    }
}
