//! The transmitter's bus, cycle by cycle.

use edof_device::video::{Axis, VideoTiming};
use edof_golden::video::video_out::BLACK_PIXEL;
use edof_golden::video::{Pins, VideoOut};
use std::collections::VecDeque;

/// A small screen's timing: no two numbers are the same.
const TIMING: VideoTiming = VideoTiming {
    line: Axis { active: 7, front: 3, sync: 4, back: 5 },
    frame: Axis { active: 6, front: 1, sync: 2, back: 3 },
    pixel_khz: 1000,
};
const LINE: usize = 19;
const PIXELS: usize = 7 * 6;
/// Cycles of a frame.
const PERIOD: usize = LINE * 12;
/// Cycles from reset to the first frame: it begins a line below the picture, right of it.
const PAUSE: usize = PERIOD - 6 * LINE - 7;

/// What comes to the transmitter: of each pixel the cycle in which it is there, its word, and if it is the first of its picture.
#[derive(Default)]
struct Pictures {
    waiting: VecDeque<(usize, u16, bool)>,
    next: u16,
}

impl Pictures {
    /// Adds `count` pixels that are there from a cycle on; gives their words.
    fn add(&mut self, from: usize, count: usize, has_first: bool) -> Vec<u16> {
        let start = self.next;
        self.next += count as u16;
        self.waiting.extend((start..self.next).map(|word| (from, word, has_first && word == start)));
        (start..self.next).collect()
    }
}

/// Cycle of frame `frame`'s pixel `pixel`, counted from reset.
const fn cycle_of(frame: usize, pixel: usize) -> usize {
    PAUSE + frame * PERIOD + pixel / 7 * LINE + pixel % 7
}

/// Runs some frames and checks every pin of every cycle, and that a picture's pixels are taken as they are shown. `shown` are each frame's pixels until
/// it is black. Gives the transmitter as it stands then.
fn show(pictures: &mut Pictures, shown: &[Vec<u16>]) -> VideoOut {
    let mut model = VideoOut::new(TIMING);
    assert_eq!(model.pins(), Pins::default());
    for cycle in 0..PAUSE + shown.len() * PERIOD {
        // As seen from the first frame's first pixel.
        let at = (cycle + PERIOD - PAUSE) % PERIOD;
        let (row, column) = (at / LINE, at % LINE);
        let front = pictures.waiting.front().filter(|(from, ..)| *from <= cycle);
        let front = front.map(|(_, word, first)| (*word, *first));
        let is_taken = model.step(front);
        let de = row < 6 && column < 7;
        let frame = cycle.checked_sub(PAUSE).map(|since| &shown[since / PERIOD]);
        let pixel = frame.filter(|_| de).and_then(|frame| frame.get(7 * row + column));
        if let Some(pixel) = pixel {
            assert_eq!((front.map(|(word, _)| word), is_taken), (Some(*pixel), true), "cycle {cycle}");
        }
        // The sync begins with that of the line after the front porch: lines begin with their syncs, and the porch's first one is right of the last row.
        let since_vs = at.checked_sub(6 * LINE + 7 + 3);
        let expected = Pins {
            hs: (10..14).contains(&column),
            vs: since_vs.is_some_and(|since| since < 2 * LINE),
            de,
            data: pixel.copied().unwrap_or(BLACK_PIXEL),
        };
        if is_taken {
            pictures.waiting.pop_front();
        }
        // A cycle later it is on the pins.
        let mut later = model.clone();
        later.step(None);
        assert_eq!(later.pins(), expected, "cycle {cycle}");
    }
    model
}

#[test]
fn whole_pictures_are_shown_one_after_the_other() {
    let mut pictures = Pictures::default();
    let shown: Vec<Vec<u16>> = (0..4).map(|_| pictures.add(0, PIXELS, true)).collect();
    let model = show(&mut pictures, &shown);
    assert_eq!((model.shown_frames, model.late_pixels), (4, 0));
    assert!(pictures.waiting.is_empty());
}

#[test]
fn a_screen_without_a_picture_is_black_and_a_picture_waits_for_the_next_frame() {
    let mut pictures = Pictures::default();
    // The pixel comes one cycle after the second frame began.
    let late = pictures.add(cycle_of(1, 1), PIXELS, true);
    let next = pictures.add(0, PIXELS, true);
    let model = show(&mut pictures, &[vec![], vec![], late, next, vec![]]);
    assert_eq!((model.shown_frames, model.late_pixels), (2, 0));
}

#[test]
fn a_picture_with_a_late_pixel_is_black_from_there_to_its_end_and_counted_once() {
    for late in 1..PIXELS {
        for cycles in [1, 3, LINE] {
            let mut pictures = Pictures::default();
            let before = pictures.add(0, PIXELS, true);
            let whole = pictures.add(0, late, true);
            pictures.add(cycle_of(1, late) + cycles, PIXELS - late, false);
            let after = pictures.add(0, PIXELS, true);
            let model = show(&mut pictures, &[before, whole, after]);
            assert_eq!((model.shown_frames, model.late_pixels), (3, 1), "pixel {late}");
            assert!(pictures.waiting.is_empty());
        }
    }
}

#[test]
fn a_picture_that_is_too_short_is_black_at_its_end_and_the_next_one_waits() {
    for length in 1..PIXELS {
        let mut pictures = Pictures::default();
        let (short, next) = (pictures.add(0, length, true), pictures.add(0, PIXELS, true));
        let model = show(&mut pictures, &[short, next, vec![]]);
        assert_eq!((model.shown_frames, model.late_pixels), (2, 1), "{length} pixels");
    }
}

#[test]
fn pixels_that_belong_to_no_picture_are_dropped_one_a_cycle() {
    for strays in [1, 2, PAUSE, PAUSE + 1, PAUSE + 5, PERIOD] {
        let mut pictures = Pictures::default();
        pictures.add(0, strays, false);
        let picture = pictures.add(0, PIXELS, true);
        // All that come before the first frame are gone by then.
        let shown = if strays <= PAUSE { [picture, vec![]] } else { [vec![], picture] };
        let model = show(&mut pictures, &shown);
        assert_eq!((model.shown_frames, model.late_pixels), (1, 0), "{strays} pixels");
    }
}

#[test]
fn what_a_picture_has_too_much_costs_the_next_frame() {
    let mut pictures = Pictures::default();
    let first = pictures.add(0, PIXELS, true);
    pictures.add(0, 3, false);
    let second = pictures.add(0, PIXELS, true);
    let model = show(&mut pictures, &[first, vec![], second]);
    assert_eq!((model.shown_frames, model.late_pixels), (2, 0));
}
