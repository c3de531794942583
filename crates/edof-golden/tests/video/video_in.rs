//! The receiver's bus, driven by a camera.

use edof_core::draw::Draw;
use edof_core::{Stride, cable};
use edof_device::design::FrameSize;
use edof_device::video::Axis;
use edof_golden::video::video_in::{Beat, Measured};
use edof_golden::video::{Pins, VideoIn};

const FRAME: FrameSize = FrameSize { width: 6, height: 4, stride: Stride::PATCH };
const PATIENCE: u32 = 2_000;
/// Largest number that is measured, and the most cycles between horizontal syncs.
const MAX: usize = 8191;
/// Cycles from the pins to the output.
const DELAY: usize = 4;
/// Cycles from the pins to what is measured.
const MEASURED_DELAY: usize = 3;

const fn axis(front: usize, sync: usize, back: usize) -> Axis {
    Axis { active: 0, front, sync, back }
}

/// What a camera sends: a frame's lines may have any width. The syncs come first, then the picture.
#[derive(Debug, Clone)]
struct Camera {
    /// Blanking of a line and of a frame.
    blank: [Axis; 2],
    /// Syncs are low when they are on.
    is_negative: bool,
    has_hs: bool,
    /// Where in a line the vertical sync changes.
    vs_column: usize,
    draw: Draw,
}

/// Pins of some cycles, and the pixels among them: cycle, row, column, word.
#[derive(Debug, Default)]
struct Film {
    pins: Vec<Pins>,
    pixels: Vec<(usize, usize, usize, Option<u16>)>,
}

impl Camera {
    fn new(is_negative: bool) -> Self {
        let blank = [axis(2, 4, 5), axis(2, 2, 3)];
        Self { blank, is_negative, has_hs: true, vs_column: 0, draw: Draw::new(1) }
    }

    /// Codes that carry a word.
    fn codes(&mut self) -> u16 {
        u16::from_le_bytes(cable::codes(self.draw.bits() as u16))
    }

    /// A frame whose lines have these widths, each of its lines as long as the longest.
    fn frame(&mut self, widths: &[usize]) -> Film {
        let [line, frame] = self.blank;
        let blank = line.front + line.sync + line.back;
        let total = blank + widths.iter().copied().max().unwrap_or(FRAME.width);
        let first = frame.sync + frame.back;
        let mut film = Film::default();
        for row in 0..first + widths.len() + frame.front {
            for column in 0..total {
                let width = row.checked_sub(first).and_then(|row| widths.get(row)).copied().unwrap_or(0);
                let at = column.checked_sub(line.sync + line.back);
                let de = at.is_some_and(|at| at < width);
                // Between pixels anything may be on the bus.
                let data = if de { self.codes() } else { self.draw.bits() as u16 };
                if de {
                    let word = cable::word(data.to_le_bytes());
                    film.pixels.push((film.pins.len(), row - first, column - line.sync - line.back, word));
                }
                let since = (row * total + column).checked_sub(self.vs_column);
                let vs = since.is_some_and(|since| since < frame.sync * total);
                let hs = self.has_hs && column < line.sync;
                film.pins.push(Pins { hs: hs != self.is_negative, vs: vs != self.is_negative, de, data });
            }
        }
        film
    }

    /// The pins of a cable whose camera is between frames.
    const fn idle(&self) -> Pins {
        Pins { hs: self.is_negative, vs: self.is_negative, de: false, data: 0 }
    }
}

impl Film {
    /// Gives a pixel codes that carry no word.
    fn spoil(&mut self, pixel: usize, data: u16) {
        assert_eq!(cable::word(data.to_le_bytes()), None);
        let (cycle, .., word) = &mut self.pixels[pixel];
        (self.pins[*cycle].data, *word) = (data, None);
    }

    /// What the receiver passes on of it, with its cycles: all pixels up to the first that shows that the frame is none.
    fn beats(&self, widths: &[usize]) -> Vec<(usize, Beat)> {
        let is_good = |&&(_, row, column, word): &&(usize, usize, usize, Option<u16>)| {
            let ends_too_late = column + 1 == FRAME.width && widths[row] > FRAME.width;
            widths[..row].iter().all(|width| *width == FRAME.width) && !ends_too_late && word.is_some()
        };
        let good = self.pixels.iter().take_while(is_good).filter(|(_, row, ..)| *row < FRAME.height);
        good.map(|&(cycle, row, column, word)| {
            let (first, last) = (row + column == 0, column + 1 == FRAME.width);
            (cycle, Beat { pixel: word.unwrap(), first, last })
        })
        .collect()
    }
}

/// The model and what was taken of its output, with the cycle.
struct Receiver {
    model: VideoIn,
    cycle: usize,
    taken: Vec<(usize, Beat)>,
}

impl Receiver {
    /// After a frame of a camera, so that it knows where frames begin.
    fn new(camera: &mut Camera) -> Self {
        let mut receiver = Self { model: VideoIn::new(FRAME, PATIENCE), cycle: 0, taken: vec![] };
        receiver.send(&[camera.idle(); 20]);
        receiver.send(&camera.frame(&[FRAME.width; FRAME.height]).pins);
        receiver.send(&camera.frame(&[]).pins);
        receiver.taken.clear();
        receiver
    }

    fn cycle(&mut self, pins: Pins, ready: bool) {
        if let (Some(beat), true) = (self.model.beat(), ready) {
            self.taken.push((self.cycle, beat));
        }
        self.model.step(pins, ready);
        self.cycle += 1;
    }

    fn send(&mut self, pins: &[Pins]) {
        pins.iter().for_each(|pins| self.cycle(*pins, true));
    }

    /// Sends a frame, then blanking; gives what was taken, in cycles of the frame, and what was measured of it.
    fn frame(&mut self, camera: &mut Camera, film: &Film) -> (Vec<(usize, Beat)>, Measured) {
        let start = self.cycle;
        self.send(&film.pins);
        self.send(&camera.frame(&[]).pins);
        let taken = self.taken.drain(..).map(|(cycle, beat)| (cycle - start - DELAY, beat)).collect();
        (taken, self.model.measured())
    }
}

/// All cameras: either polarity, the vertical sync at any place of a line.
fn cameras() -> impl Iterator<Item = Camera> {
    [false, true].into_iter().flat_map(|is_negative| {
        [0, 2, 4, 9, 16].map(|vs_column| Camera { vs_column, ..Camera::new(is_negative) })
    })
}

#[test]
fn right_frames_come_whole_four_cycles_after_the_pins_and_are_measured() {
    for mut camera in cameras() {
        let mut receiver = Receiver::new(&mut camera);
        let before = receiver.model.measured();
        let widths = [FRAME.width; FRAME.height];
        for frames in 1..4 {
            let film = camera.frame(&widths);
            let (taken, measured) = receiver.frame(&mut camera, &film);
            assert_eq!(taken, film.beats(&widths));
            assert_eq!(taken.len(), FRAME.width * FRAME.height);
            // Blanking came before the frame: seven lines more.
            let expected = Measured {
                width: 6,
                height: 4,
                line_cycles: 6 + 2 + 4 + 5,
                lines: 7 + 2 + 3 + 4 + 2,
                present: true,
                fits: true,
                right_frames: before.right_frames + frames,
                ..before
            };
            assert_eq!(measured, expected);
        }
    }
}

/// Frames without pauses: a frame's lines are those from its first vertical sync to the next frame's.
#[test]
fn lines_are_counted_from_one_frame_to_the_next_and_so_are_its_right_frames() {
    for mut camera in cameras() {
        let mut receiver = Receiver::new(&mut camera);
        for _ in 0..3 {
            receiver.send(&camera.frame(&[FRAME.width; FRAME.height]).pins);
        }
        let frames = receiver.model.measured().right_frames;
        let film = camera.frame(&[FRAME.width; FRAME.height]);
        // The next frame's first edge ends this one.
        let (before, after) = film.pins.split_at(camera.vs_column + MEASURED_DELAY);
        receiver.send(&before[..before.len() - 1]);
        assert_eq!(receiver.model.measured().right_frames, frames);
        receiver.send(&before[before.len() - 1..]);
        let measured = receiver.model.measured();
        assert_eq!((measured.right_frames, measured.lines), (frames + 1, 2 + 3 + 4 + 2));
        receiver.send(after);
        assert_eq!(receiver.model.measured(), measured);
    }
}

#[test]
fn frames_of_any_shape_are_passed_on_until_they_are_wrong_and_judged_at_their_end() {
    for mut camera in cameras() {
        let mut receiver = Receiver::new(&mut camera);
        let mut expected = receiver.model.measured();
        let draw = &mut Draw::new(5);
        for _ in 0..300 {
            let mut lines = |min: i64, max: i64| draw.whole(min, max) as usize;
            let mut widths = vec![FRAME.width; if lines(0, 3) == 0 { lines(1, 7) } else { FRAME.height }];
            if lines(0, 1) == 0 {
                let row = lines(0, widths.len() as i64 - 1);
                widths[row] = lines(1, 9);
            }
            let mut film = camera.frame(&widths);
            let is_spoilt = lines(0, 4) == 0;
            if is_spoilt {
                let pixel = lines(0, film.pixels.len() as i64 - 1);
                film.spoil(pixel, [64 << 8 | 63, 192 << 8 | 64, 63 << 8 | 191, 191 << 8 | 192][lines(0, 3)]);
            }
            let (taken, measured) = receiver.frame(&mut camera, &film);
            assert_eq!(taken, film.beats(&widths), "{widths:?}");
            let fits = widths == [FRAME.width; FRAME.height];
            expected.right_frames += u64::from(fits);
            expected.wrong_frames += u64::from(!fits);
            expected.range_frames += u64::from(is_spoilt);
            let (width, height) = (widths[widths.len() - 1], widths.len());
            expected = Measured { width, height, line_cycles: 17, lines: 14 + height, fits, ..expected };
            assert_eq!(measured, expected, "{widths:?}");
        }
        assert!(expected.right_frames > 50 && expected.wrong_frames > 50 && expected.range_frames > 30);
    }
}

#[test]
fn what_is_on_the_bus_between_pixels_spoils_no_frame() {
    let mut camera = Camera::new(false);
    let mut receiver = Receiver::new(&mut camera);
    let mut film = camera.frame(&[FRAME.width; FRAME.height]);
    film.pins.iter_mut().filter(|pins| !pins.de).for_each(|pins| pins.data = 0xffff);
    let (taken, measured) = receiver.frame(&mut camera, &film);
    assert_eq!((taken.len(), measured.range_frames), (FRAME.width * FRAME.height, 0));
}

#[test]
fn the_width_of_a_line_is_known_when_it_ends() {
    let mut camera = Camera::new(true);
    let mut receiver = Receiver::new(&mut camera);
    let film = camera.frame(&[3, 9, 5]);
    for (cycle, pins) in film.pins.iter().enumerate() {
        receiver.cycle(*pins, true);
        let seen = (cycle + 1).saturating_sub(MEASURED_DELAY);
        let ended = (1..=seen).filter(|at| film.pins[at - 1].de && !film.pins[*at].de).count();
        assert_eq!(receiver.model.measured().width, [6, 3, 9, 5][ended], "cycle {cycle}");
    }
}

#[test]
fn a_pixel_that_is_not_taken_in_time_ends_its_frame_and_no_other() {
    let widths = [FRAME.width; FRAME.height];
    let blanking = 2 + 4 + 5;
    for pixel in 0..FRAME.width * FRAME.height - 1 {
        let is_last = pixel % FRAME.width == FRAME.width - 1;
        // A line's last pixel may stand until the next line's first one needs its place.
        let least = if is_last { blanking + 1 } else { 1 };
        for pause in [1, least - 1, least, least + 1] {
            let mut camera = Camera::new(false);
            let mut receiver = Receiver::new(&mut camera);
            let film = camera.frame(&widths);
            let stands = film.pixels[pixel].0 + DELAY;
            let start = receiver.cycle;
            for (cycle, pins) in film.pins.iter().enumerate() {
                receiver.cycle(*pins, !(stands..stands + pause).contains(&cycle));
            }
            receiver.send(&camera.frame(&[]).pins);
            let mut expected = film.beats(&widths);
            expected[pixel].0 += pause;
            let is_lost = pause >= least;
            if is_lost {
                expected.truncate(pixel + 1);
            }
            let taken: Vec<_> =
                receiver.taken.drain(..).map(|(cycle, beat)| (cycle - start - DELAY, beat)).collect();
            assert_eq!(taken, expected, "pixel {pixel}, {pause} cycles");
            let measured = receiver.model.measured();
            assert_eq!(measured.overruns, u64::from(is_lost), "pixel {pixel}, {pause} cycles");
            // The size of the frame was right.
            assert!(measured.fits);
            let film = camera.frame(&widths);
            assert_eq!(receiver.frame(&mut camera, &film).0, film.beats(&widths));
            assert_eq!(receiver.model.measured().overruns, u64::from(is_lost));
        }
    }
}

#[test]
fn the_first_frame_is_the_one_after_a_vertical_sync() {
    let widths = [FRAME.width; FRAME.height];
    let mut camera = Camera::new(false);
    let film = camera.frame(&widths);
    let mut receiver = Receiver { model: VideoIn::new(FRAME, PATIENCE), cycle: 0, taken: vec![] };
    // A camera that was put in as its first line came.
    receiver.send(&film.pins[film.pixels[0].0..]);
    assert_eq!(receiver.taken, []);
    let measured = receiver.model.measured();
    assert_eq!((measured.present, measured.right_frames, measured.wrong_frames), (false, 0, 0));
    for frames in 1..3 {
        let (taken, measured) = receiver.frame(&mut camera, &film);
        assert_eq!(taken, film.beats(&widths));
        assert_eq!((measured.present, measured.right_frames, measured.wrong_frames), (true, frames, 0));
    }
}

#[test]
fn a_signal_is_gone_when_its_vertical_sync_rests_and_the_first_frame_after_it_is_not_judged() {
    let widths = [FRAME.width; FRAME.height];
    for mut camera in cameras() {
        let mut receiver = Receiver::new(&mut camera);
        let film = camera.frame(&widths);
        receiver.frame(&mut camera, &film);
        let blank = camera.frame(&[]);
        receiver.send(&blank.pins);
        let edge = blank.pins.windows(2).rposition(|two| two[0].vs != two[1].vs).unwrap() + 1;
        let rested = blank.pins.len() - edge;
        let rests = PATIENCE as usize + MEASURED_DELAY - rested;
        receiver.send(&vec![camera.idle(); rests]);
        let before = receiver.model.measured();
        assert!(before.present && before.fits);
        receiver.send(&[camera.idle()]);
        let gone = Measured { present: false, fits: false, ..before };
        assert_eq!(receiver.model.measured(), gone);
        receiver.send(&vec![camera.idle(); 10_000]);
        assert_eq!(receiver.model.measured(), gone);
        let (taken, measured) = receiver.frame(&mut camera, &film);
        assert_eq!(taken, film.beats(&widths));
        assert_eq!((measured.present, measured.right_frames), (false, before.right_frames));
        let (_, measured) = receiver.frame(&mut camera, &film);
        assert_eq!((measured.present, measured.fits), (true, true));
        assert_eq!(measured.right_frames, before.right_frames + 1);
    }
}

#[test]
fn lines_of_as_many_cycles_as_can_be_counted_are_none() {
    let widths = [FRAME.width; FRAME.height];
    for (cycles, fits) in [(MAX - 1, true), (MAX, false), (MAX + 1, false), (MAX + 500, false)] {
        let front = cycles - 4 - 5 - FRAME.width;
        let mut camera = Camera { blank: [axis(front, 4, 5), axis(1, 1, 1)], ..Camera::new(false) };
        let mut receiver =
            Receiver { model: VideoIn::new(FRAME, 1_000_000), ..Receiver::new(&mut Camera::new(false)) };
        receiver.send(&camera.frame(&widths).pins);
        receiver.taken.clear();
        let film = camera.frame(&widths);
        let (taken, measured) = receiver.frame(&mut camera, &film);
        assert_eq!(measured.line_cycles, cycles.min(MAX));
        assert_eq!((measured.fits, measured.present), (fits, true), "{cycles}");
        assert_eq!(taken.len() == FRAME.width * FRAME.height, fits, "{cycles}");
    }
}

#[test]
fn a_frame_without_horizontal_syncs_ends_when_counting_does() {
    let mut camera = Camera { blank: [axis(4, 4, 1011), axis(2, 2, 3)], ..Camera::new(false) };
    let widths = [FRAME.width; FRAME.height];
    let mut receiver =
        Receiver { model: VideoIn::new(FRAME, 1_000_000), ..Receiver::new(&mut Camera::new(false)) };
    receiver.send(&camera.frame(&widths).pins);
    receiver.taken.clear();
    camera.has_hs = false;
    let film = camera.frame(&widths);
    // The last horizontal sync was a line of 1025 cycles before: it is too long ago in the second line.
    let expected: Vec<_> =
        film.beats(&widths).into_iter().filter(|(cycle, _)| *cycle + 1025 <= MAX).collect();
    let (taken, measured) = receiver.frame(&mut camera, &film);
    assert_eq!(expected.len(), FRAME.width + 2);
    assert_eq!(taken, expected);
    assert_eq!((measured.fits, measured.lines, measured.present), (false, 0, true));
    let (taken, measured) = receiver.frame(&mut camera, &film);
    // A frame's first pixel comes before it is seen that nothing is counted.
    assert_eq!((taken, measured.wrong_frames), (film.beats(&widths)[..1].to_vec(), 2));
    // The syncs come again: the pause reached into the frame that begins after it, but not into the next.
    camera.has_hs = true;
    for fits in [false, true] {
        let film = camera.frame(&widths);
        let (taken, measured) = receiver.frame(&mut camera, &film);
        assert_eq!((taken, measured.fits), (film.beats(&widths), fits));
    }
}

#[test]
fn sizes_beyond_what_can_be_counted_stand_at_its_end() {
    let mut receiver =
        Receiver { model: VideoIn::new(FRAME, 1_000_000), ..Receiver::new(&mut Camera::new(false)) };
    let mut camera = Camera::new(true);
    let film = camera.frame(&[9000]);
    receiver.send(&camera.frame(&[FRAME.width]).pins);
    receiver.taken.clear();
    let (_, measured) = receiver.frame(&mut camera, &film);
    assert_eq!((measured.width, measured.height, measured.fits), (MAX, 1, false));
    let film = camera.frame(&vec![FRAME.width; 9000]);
    let (_, measured) = receiver.frame(&mut camera, &film);
    assert_eq!((measured.height, measured.lines, measured.fits), (MAX, MAX, false));
}
