//! The blocks at the pins, cycle by cycle against their models, and what their users rely on: frames arrive whole or are marked as broken, whatever happens to the cable.

use crate::streams::{Bench, Compiled};
use edof_core::Stride;
use edof_core::draw::Draw;
use edof_device::design::FrameSize;
use edof_device::video::{Axis, VideoTiming};
use edof_golden::video::{Pins, VideoIn as InModel, VideoOut as OutModel};
use edof_hdl::video::video_in::VideoIn;
use edof_hdl::video::video_out::VideoOut;

const FRAME: FrameSize = FrameSize { width: 18, height: 12, stride: Stride::PATCH };
const PATIENCE: u32 = 3_000;

/// A timing whose syncs are shorter than any screen's.
fn timing(width: usize, height: usize) -> VideoTiming {
    VideoTiming {
        line: Axis { active: width, front: 3, sync: 4, back: 5 },
        frame: Axis { active: height, front: 2, sync: 2, back: 3 },
        pixel_khz: 1000,
    }
}

/// Codes of luma (below) and chroma that carry a word's upper and lower seven bits, and the word: docs/contract.md, 1.1.
fn carrier(draw: &mut Draw) -> (u16, u16) {
    let [luma, chroma] = [(); 2].map(|()| draw.whole(0, 127) as u16);
    ((chroma + 64) * 256 + luma + 64, luma * 512 + chroma * 4)
}

/// A frame of random pixels as a transmitter sends it, its syncs positive or negative pulses.
fn sent(draw: &mut Draw, timing: VideoTiming, negative: bool) -> (Vec<Pins>, Vec<u16>) {
    let (line, frame) = (timing.line, timing.frame);
    let (mut pins, mut pixels) = (vec![], vec![]);
    for row in 0..frame.total() {
        for column in 0..line.total() {
            let de = row < frame.active && column < line.active;
            let mut data = draw.bits() as u16;
            if de {
                let (codes, word) = carrier(draw);
                data = codes;
                pixels.push(word);
            }
            // A vertical sync begins with a horizontal one.
            let vertical = if column < line.active + line.front { row.wrapping_sub(1) } else { row };
            let (hs, vs) = (line.in_sync(column), frame.in_sync(vertical));
            pins.push(Pins { hs: hs != negative, vs: vs != negative, de, data });
        }
    }
    (pins, pixels)
}

/// What a receiver of pixels that keeps to the rule of `VideoIn` takes for frames: one that begins anew was no frame.
#[derive(Default)]
struct Frames {
    open: Option<Vec<u16>>,
    whole: Vec<Vec<u16>>,
}

impl Frames {
    fn take(&mut self, pixel: u16, first: bool) {
        if first {
            self.open = Some(vec![]);
        }
        if let Some(open) = &mut self.open {
            open.push(pixel);
            if open.len() == FRAME.width * FRAME.height {
                self.whole.extend(self.open.take());
            }
        }
    }
}

/// Both, cycle by cycle; gives what came whole.
struct Receiver {
    bench: Bench,
    model: InModel,
    frames: Frames,
    draw: Draw,
    /// Cycles of 16 in which the pixels are accepted.
    takes: i64,
}

impl Receiver {
    fn new(seed: u64, takes: i64) -> Self {
        Self::of(&Compiled::new(VideoIn::new(FRAME, PATIENCE), vec![]), seed, takes)
    }

    fn of(compiled: &Compiled, seed: u64, takes: i64) -> Self {
        let mut bench = compiled.start(seed);
        bench.poke("plain_i", 0);
        bench.reset();
        let model = InModel::new(FRAME, PATIENCE);
        Self { bench, model, frames: Frames::default(), draw: Draw::new(seed), takes }
    }

    fn cycle(&mut self, pins: Pins) {
        let bench = &mut self.bench;
        for (port, value) in [("hs_i", pins.hs.into()), ("vs_i", pins.vs.into()), ("de_i", pins.de.into())] {
            bench.poke(port, value);
        }
        bench.poke("data_i", pins.data.into());
        let ready = self.draw.whole(0, 15) < self.takes;
        bench.poke("pixels_ready_i", ready.into());
        let beat = self.model.beat();
        assert_eq!(bench.peek("pixels_valid_o") == 1, beat.is_some());
        if let Some(beat) = beat {
            let found = ["pixels_data_o", "pixels_user_o", "pixels_last_o"].map(|port| bench.peek(port));
            let expected = [u64::from(beat.pixel), beat.first.into(), beat.last.into()];
            assert_eq!(found, expected);
            if ready {
                self.frames.take(beat.pixel, beat.first);
            }
        }
        self.model.step(pins, ready);
        bench.model.tick().unwrap();
    }

    fn send(&mut self, pins: &[Pins]) {
        pins.iter().for_each(|pins| self.cycle(*pins));
        self.compare_measured();
    }

    fn compare_measured(&mut self) {
        let measured = self.model.measured();
        let found = [
            "width_o",
            "height_o",
            "line_cycles_o",
            "lines_o",
            "present_o",
            "fits_o",
            "right_frames_o",
            "wrong_frames_o",
            "range_frames_o",
            "overruns_o",
        ]
        .map(|port| self.bench.peek(port));
        let expected = [
            measured.width as u64,
            measured.height as u64,
            measured.line_cycles as u64,
            measured.lines as u64,
            measured.present.into(),
            measured.fits.into(),
            measured.right_frames,
            measured.wrong_frames,
            measured.range_frames,
            measured.overruns,
        ];
        assert_eq!(found, expected);
    }
}

#[test]
fn frames_of_either_polarity_come_whole_and_are_measured() {
    come_whole_and_are_measured(&Compiled::new(VideoIn::new(FRAME, PATIENCE), vec![]));
}

#[test]
#[ignore = "a minute: scripts/soak.sh"]
fn frames_come_whole_through_the_netlist_of_the_receiver_as_well() {
    come_whole_and_are_measured(&Compiled::mapped(VideoIn::new(FRAME, PATIENCE)));
}

fn come_whole_and_are_measured(compiled: &Compiled) {
    for negative in [false, true] {
        let mut receiver = Receiver::of(compiled, 1, 16);
        let draw = &mut Draw::new(2);
        let mut expected = vec![];
        for _ in 0..4 {
            let (pins, pixels) = sent(draw, timing(18, 12), negative);
            receiver.send(&pins);
            expected.push(pixels);
        }
        // What came before the first vertical sync is no frame's begin.
        assert_eq!(receiver.frames.whole, expected[1..]);
        let measured = receiver.model.measured();
        assert!(measured.present && measured.fits);
        assert_eq!((measured.width, measured.height), (18, 12));
        assert_eq!((measured.line_cycles, measured.lines), (30, 19));
        // A cable that is put in changes a negative sync at once: what follows is taken for a frame, and is none.
        let wrong = u64::from(negative);
        assert_eq!((measured.right_frames, measured.wrong_frames, measured.overruns), (3, wrong, 0));
    }
}

#[test]
fn another_resolution_is_reported_and_gives_no_frame() {
    for (width, height) in [(16, 12), (20, 12), (18, 10), (12, 8)] {
        let mut receiver = Receiver::new(3, 16);
        let draw = &mut Draw::new(4);
        let right = |receiver: &mut Receiver, draw: &mut Draw| {
            let (pins, pixels) = sent(draw, timing(18, 12), false);
            receiver.send(&pins);
            pixels
        };
        right(&mut receiver, draw);
        let before = right(&mut receiver, draw);
        let (wrong, _) = sent(draw, timing(width, height), false);
        receiver.send(&wrong);
        assert!(!receiver.model.measured().fits, "{width}x{height}");
        assert_eq!(receiver.model.measured().wrong_frames, 1);
        let after = right(&mut receiver, draw);
        assert_eq!(receiver.frames.whole, [before, after], "{width}x{height}");
        assert!(receiver.model.measured().fits);
    }
}

#[test]
fn a_frame_with_a_code_that_carries_nothing_is_counted_and_never_comes_whole() {
    let mut receiver = Receiver::new(11, 16);
    let draw = &mut Draw::new(12);
    let mut whole = vec![];
    let pixels: Vec<usize> = sent(draw, timing(18, 12), false)
        .0
        .iter()
        .enumerate()
        .filter(|(_, pins)| pins.de)
        .map(|(i, _)| i)
        .collect();
    // The first pixel, the last one, and some between; on luma and on chroma; just outside of the range, and at the ends of a byte.
    let strays =
        [(0, 63, 0), (pixels.len() - 1, 192, 8), (17, 0, 0), (18, 255, 8), (100, 16, 8), (215, 235, 0)];
    receiver.send(&sent(draw, timing(18, 12), false).0);
    for (count, (place, code, shift)) in strays.into_iter().enumerate() {
        let (mut pins, _) = sent(draw, timing(18, 12), false);
        let data = &mut pins[pixels[place]].data;
        *data = *data & !(0xff << shift) | code << shift;
        receiver.send(&pins);
        let measured = receiver.model.measured();
        // The size is correct nevertheless.
        assert_eq!(
            (measured.range_frames, measured.fits, measured.wrong_frames),
            (count as u64 + 1, true, 0)
        );
        let (pins, frame) = sent(draw, timing(18, 12), false);
        receiver.send(&pins);
        whole.push(frame);
    }
    assert_eq!(receiver.frames.whole, whole);
}

#[test]
fn bytes_of_any_kind_are_pixels_where_they_are_to_be_plain() {
    let mut receiver = Receiver::new(13, 16);
    let draw = &mut Draw::new(14);
    receiver.send(&sent(draw, timing(18, 12), false).0);
    for is_plain in [true, false, true] {
        receiver.model.is_plain = is_plain;
        receiver.bench.poke("plain_i", is_plain.into());
        let (mut pins, _) = sent(draw, timing(18, 12), false);
        let mut words = vec![];
        for pins in pins.iter_mut().filter(|pins| pins.de) {
            pins.data = draw.bits() as u16;
            words.push(pins.data.swap_bytes());
        }
        receiver.frames.whole.clear();
        receiver.send(&pins);
        assert_eq!(receiver.frames.whole, if is_plain { vec![words] } else { vec![] });
    }
    assert_eq!(receiver.model.measured().range_frames, 1);
}

#[test]
fn a_cable_that_is_pulled_and_put_back_at_any_moment_leaves_no_torn_frame() {
    let draw = &mut Draw::new(5);
    let one = timing(18, 12).line.total() * timing(18, 12).frame.total();
    for round in 0..40 {
        let mut receiver = Receiver::new(round, 16);
        let (mut pins, mut pixels) = (vec![], vec![]);
        for _ in 0..6 {
            let (more, frame) = sent(draw, timing(18, 12), false);
            pins.extend(more);
            pixels.push(frame);
        }
        let pulled = draw.whole(one as i64, 2 * one as i64) as usize;
        let back = draw.whole(3 * one as i64, 4 * one as i64) as usize;
        receiver.send(&pins[..pulled]);
        // Longer than any line.
        let held = Pins { de: draw.whole(0, 3) == 0, ..Pins::default() };
        receiver.send(&vec![held; 9_000]);
        assert!(!receiver.model.measured().present);
        receiver.send(&pins[back..]);
        for frame in &receiver.frames.whole {
            assert!(pixels.contains(frame), "a torn frame in round {round}");
        }
        // The frame after the next vertical sync is there again, at most two after the cable was put back.
        assert_eq!(receiver.frames.whole.last(), pixels.last(), "round {round}");
    }
}

#[test]
fn a_frame_that_is_not_taken_in_time_is_given_up_and_counted() {
    for takes in [15, 12, 3] {
        let mut receiver = Receiver::new(6, takes);
        let draw = &mut Draw::new(7);
        let mut sent_frames = vec![];
        for _ in 0..12 {
            let (pins, pixels) = sent(draw, timing(18, 12), false);
            receiver.send(&pins);
            sent_frames.push(pixels);
        }
        assert!(receiver.frames.whole.iter().all(|frame| sent_frames.contains(frame)));
        assert!(receiver.model.measured().overruns > 0);
    }
}

/// A source of pixels for `VideoOut`, frame by frame.
struct Source {
    pixels: Vec<(u16, bool)>,
    next: usize,
}

/// Runs the transmitter for some cycles, pixels there as `there` says; gives the frames that were on the pins.
fn transmitted(
    seed: u64,
    mut source: Source,
    cycles: usize,
    there: impl Fn(usize, &mut Draw) -> bool,
) -> Vec<Vec<u16>> {
    let timing = timing(18, 12);
    let mut bench = Compiled::new(VideoOut::new(timing), vec![]).start(seed);
    bench.reset();
    let mut model = OutModel::new(timing);
    let draw = &mut Draw::new(seed);
    let (mut frames, mut open, mut vs_before, mut stands) = (vec![], vec![], false, false);
    for cycle in 0..cycles {
        stands = source.next < source.pixels.len() && (stands || there(cycle, draw));
        let front = source.pixels.get(source.next).copied().filter(|_| stands);
        bench.poke("pixels_valid_i", front.is_some().into());
        let (pixel, first) = front.unwrap_or((draw.bits() as u16, draw.whole(0, 1) == 1));
        bench.poke("pixels_data_i", pixel.into());
        bench.poke("pixels_user_i", first.into());
        let pins = model.pins();
        let found = ["hs_o", "vs_o", "de_o"].map(|port| bench.peek(port) == 1);
        assert_eq!(found, [pins.hs, pins.vs, pins.de], "cycle {cycle}");
        if pins.de {
            assert_eq!(bench.peek("data_o"), u64::from(pins.data), "cycle {cycle}");
            open.push(pins.data);
        }
        if pins.vs && !vs_before && !open.is_empty() {
            frames.push(std::mem::take(&mut open));
        }
        vs_before = pins.vs;
        let ready = bench.peek("pixels_ready_o") == 1;
        let taken = model.step(front);
        assert_eq!(front.is_some() && ready, taken, "cycle {cycle}");
        if taken {
            (source.next, stands) = (source.next + 1, false);
        }
        bench.model.tick().unwrap();
    }
    assert_eq!(bench.peek("shown_frames_o"), model.shown_frames);
    assert_eq!(bench.peek("late_pixels_o"), model.late_pixels);
    frames
}

fn pictures(draw: &mut Draw, count: usize) -> (Source, Vec<Vec<u16>>) {
    let frames: Vec<Vec<u16>> =
        (0..count).map(|_| (0..18 * 12).map(|_| draw.bits() as u16).collect()).collect();
    let pixels = frames.iter().flat_map(|frame| frame.iter().enumerate().map(|(i, pixel)| (*pixel, i == 0)));
    (Source { pixels: pixels.collect(), next: 0 }, frames)
}

const BLACK: u16 = 0x8010;

#[test]
fn the_screen_is_black_until_the_first_picture_and_then_shows_each_whole() {
    let (source, frames) = pictures(&mut Draw::new(8), 3);
    let one = 30 * 19;
    let shown = transmitted(9, source, 8 * one, |cycle, _| cycle > 5 * one / 2);
    assert!(shown[..3].iter().flatten().all(|pixel| *pixel == BLACK));
    assert_eq!(shown[3..6], frames);
    assert!(shown[6..].iter().flatten().all(|pixel| *pixel == BLACK));
}

#[test]
fn a_picture_whose_pixels_come_late_ends_in_black_and_the_next_is_whole() {
    let one = 30 * 19;
    for seed in 0..10 {
        let (source, frames) = pictures(&mut Draw::new(seed), 8);
        let gap = one + 40 + 37 * seed as usize;
        let shown = transmitted(seed, source, 12 * one, |cycle, _| !(gap..gap + 25).contains(&cycle));
        for picture in &shown {
            let seen = frames
                .iter()
                .map(|frame| picture.iter().zip(frame).take_while(|(a, b)| a == b).count())
                .max();
            let seen = seen.unwrap();
            assert!(picture[seen..].iter().all(|pixel| *pixel == BLACK), "a torn picture");
        }
        assert_eq!(shown.iter().rev().find(|picture| picture[0] != BLACK), frames.last());
    }
}

#[test]
fn the_transmitter_keeps_to_its_model_whatever_comes() {
    for seed in 0..5 {
        let draw = &mut Draw::new(seed);
        // Frames of the wrong length, too.
        let lengths = [216, 200, 230, 1, 216, 300, 216];
        let pixels = lengths.into_iter().flat_map(|length| (0..length).map(|i| i == 0).collect::<Vec<_>>());
        let pixels = pixels.map(|first| (draw.bits() as u16, first)).collect();
        transmitted(seed, Source { pixels, next: 0 }, 12 * 30 * 19, |_, draw| draw.whole(0, 31) > 0);
    }
}
