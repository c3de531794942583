//! Halves of raw frames in grey, in any order and damaged: what comes out is a raw frame that was sent, or no whole one.

use edof_core::draw::Draw;
use edof_core::{CfaPhase, RawFrame};
use edof_golden::video::GreyJoin;
use edof_golden::video::grey::{carried, halves};
use edof_golden::video::video_in::Beat;
use ndarray::Array2;

const SIZE: (usize, usize) = (4, 36);

fn raw(draw: &mut Draw) -> RawFrame {
    let words = Array2::from_shape_simple_fn(SIZE, || draw.bits() as u16);
    RawFrame::from_values(words, 16, CfaPhase::Rggb).unwrap()
}

/// What the receiver's bus makes of a half on the cable.
fn beats(codes: &Array2<u8>) -> Vec<Beat> {
    let beat = |((row, column), code): ((usize, usize), &u8)| Beat {
        pixel: (u16::from(*code) - 64) << 9 | 64 << 2,
        first: (row, column) == (0, 0),
        last: column + 1 == SIZE.1,
    };
    codes.indexed_iter().map(beat).collect()
}

/// Frames as the memory's writer takes them: whole ones, and how many were begun and not completed.
#[derive(Debug, Default)]
struct Writer {
    open: Vec<Beat>,
    whole: Vec<Array2<u16>>,
    broken: usize,
}

impl Writer {
    fn take(&mut self, beat: Beat) {
        if beat.first {
            self.broken += usize::from(!self.open.is_empty());
            self.open.clear();
        } else if self.open.is_empty() {
            return;
        }
        self.open.push(beat);
        assert_eq!(beat.last, self.open.len().is_multiple_of(SIZE.1));
        if self.open.len() == SIZE.0 * SIZE.1 {
            let words = self.open.drain(..).map(|beat| beat.pixel).collect();
            self.whole.push(Array2::from_shape_vec(SIZE, words).unwrap());
        }
    }
}

/// What the writer gets of halves that come one after the other, each beat taken in `takes` cycles of 16.
fn joined(halves: &[Vec<Beat>], takes: i64) -> Writer {
    let (mut model, mut writer) = (GreyJoin::new(SIZE.0), Writer::default());
    let draw = &mut Draw::new(3);
    model.step(true, None, false);
    let mut cycle = |source: Option<Beat>| {
        let ready = draw.whole(0, 15) < takes;
        let is_taken = model.takes(source, ready);
        model.beat(source).filter(|_| ready).into_iter().for_each(|beat| writer.take(beat));
        model.step(true, source, ready);
        is_taken
    };
    for beat in halves.iter().flatten() {
        while !cycle(Some(*beat)) {}
    }
    while !cycle(None) {}
    writer
}

/// Both halves of three frames, and what the memory gets of each frame.
fn frames() -> (Vec<Vec<Beat>>, Vec<Array2<u16>>) {
    let draw = &mut Draw::new(1);
    let frames: Vec<RawFrame> = (0..3).map(|_| raw(draw)).collect();
    let sent = frames.iter().flat_map(halves).map(|half| beats(&half)).collect();
    (sent, frames.iter().map(|frame| carried(frame).pixels().clone()).collect())
}

#[test]
fn halves_that_follow_one_another_are_frames_whenever_they_are_taken() {
    let (sent, frames) = frames();
    for takes in [16, 9, 2] {
        let writer = joined(&sent, takes);
        assert_eq!((writer.whole, writer.broken), (frames.clone(), 0));
    }
}

#[test]
fn whatever_halves_are_lost_or_shown_again_no_two_frames_are_joined() {
    let (sent, frames) = frames();
    let draw = &mut Draw::new(2);
    for _ in 0..500 {
        let mut order: Vec<usize> = (0..2 * frames.len()).collect();
        for _ in 0..draw.whole(1, 3) {
            let place = draw.whole(0, order.len() as i64 - 1) as usize;
            if draw.whole(0, 1) == 0 {
                order.remove(place);
            } else {
                order.insert(place, order[place]);
            }
        }
        // A frame is begun by an upper half, or by a lower one with no upper one before it; the last one is still open.
        let is_frame = |two: &[usize]| two[0].is_multiple_of(2) && two[1] == two[0] + 1;
        let pairs: Vec<usize> = order.windows(2).filter(|two| is_frame(two)).map(|two| two[0]).collect();
        let is_begun =
            |place: &usize| order[*place].is_multiple_of(2) || *place == 0 || order[place - 1] % 2 == 1;
        let is_open = order.len() < 2 || !is_frame(&order[order.len() - 2..]);
        let broken = (0..order.len()).filter(is_begun).count() - pairs.len() - usize::from(is_open);
        let halves: Vec<Vec<Beat>> = order.iter().map(|half| sent[*half].clone()).collect();
        let writer = joined(&halves, 16);
        let expected: Vec<_> = pairs.into_iter().map(|half| frames[half / 2].clone()).collect();
        assert_eq!((writer.whole, writer.broken), (expected, broken), "{order:?}");
    }
}

#[test]
fn a_half_that_is_cut_off_or_changes_on_its_way_makes_no_frame() {
    let (sent, frames) = frames();
    let line = SIZE.1;
    for (half, at) in (0..2).flat_map(|half| (1..SIZE.0).map(move |row| (half, row * line + 7))) {
        let mut cut = sent.clone();
        cut[half].truncate(at);
        let writer = joined(&cut, 16);
        assert_eq!(writer.whole, frames[1..], "half {half} cut at {at}");
        // From here on the half of another frame, as a graphics card shows it that changes its picture while it sends.
        let mut torn = sent.clone();
        torn[half].truncate(at);
        torn[half].extend_from_slice(&sent[half + 2][at..]);
        let writer = joined(&torn, 16);
        assert_eq!(writer.whole, frames[1..], "half {half} torn at {at}");
    }
    // Another frame between the halves, of however few pixels.
    for pixels in 1..4 {
        let mut between = sent.clone();
        between.insert(1, sent[1][..pixels].to_vec());
        assert_eq!(joined(&between, 16).whole, frames[1..], "{pixels} pixels");
    }
}

#[test]
fn without_grey_words_pass_as_they_are_from_a_first_one_on() {
    let (sent, _) = frames();
    let mut model = GreyJoin::new(SIZE.0);
    for beat in &sent[0][5..] {
        assert_eq!((model.beat(Some(*beat)), model.takes(Some(*beat), false)), (None, true));
        model.step(false, Some(*beat), false);
    }
    for beat in sent.iter().flatten() {
        assert_eq!((model.beat(Some(*beat)), model.takes(Some(*beat), false)), (Some(*beat), false));
        model.step(false, Some(*beat), true);
    }
    // A change in the middle of a frame throws the rest of it away.
    model.step(true, Some(sent[0][0]), true);
    model.step(false, Some(sent[0][1]), true);
    assert_eq!(model.beat(Some(sent[0][2])), None);
}
