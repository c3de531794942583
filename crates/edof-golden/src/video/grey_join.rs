//! Between the receiver's bus and the memory: pixels of grey become raw pixel words, two frames of video one raw frame.

use super::grey::MARKS;
use super::video_in::Beat;

/// The part of a raw frame that is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sends {
    /// Nothing: what comes belongs to no frame.
    Nothing,
    /// Its upper half.
    Upper,
    /// Its lower half.
    Lower,
}

/// The block since reset.
#[derive(Debug, Clone)]
pub struct GreyJoin {
    height: usize,
    /// Pixels are grey; else they are words already.
    is_grey: bool,
    /// A frame's first pixel came since the mode changed.
    has_begun: bool,
    sends: Sends,
    /// The first pixel of a word whose second one has not come.
    first: Option<Beat>,
    /// Words of the line, lines of the frame so far.
    place: (usize, usize),
    /// Marks of the upper half's first line.
    tag: [bool; MARKS],
    stands: Option<Beat>,
}

impl GreyJoin {
    /// For frames of so many lines.
    #[must_use]
    pub const fn new(height: usize) -> Self {
        Self {
            height,
            is_grey: false,
            has_begun: false,
            sends: Sends::Nothing,
            first: None,
            place: (0, 0),
            tag: [false; MARKS],
            stands: None,
        }
    }

    /// Returns the beat on the output while `source` stands on the input.
    #[must_use]
    pub fn beat(&self, source: Option<Beat>) -> Option<Beat> {
        if self.is_grey { self.stands } else { source.filter(|beat| self.has_begun || beat.first) }
    }

    /// Whether a pixel on the input is taken.
    #[must_use]
    pub fn takes(&self, source: Option<Beat>, ready: bool) -> bool {
        ready || self.beat(source).is_none()
    }

    /// One cycle: whether pixels are to be grey, the pixel on the input, and whether the receiver of the words takes one.
    pub fn step(&mut self, grey: bool, source: Option<Beat>, ready: bool) {
        let taken = source.filter(|_| self.takes(source, ready));
        if self.is_grey != grey {
            *self = Self { is_grey: grey, ..Self::new(self.height) };
            return;
        }
        if !self.is_grey {
            self.has_begun |= taken.is_some_and(|beat| beat.first);
            return;
        }
        if ready {
            self.stands = None;
        }
        if let Some(pixel) = taken {
            match self.first.take() {
                Some(first) if !pixel.first => self.stands = self.word(first, pixel),
                cut_off => {
                    if cut_off.is_some() {
                        self.sends = Sends::Nothing;
                    }
                    self.first = Some(pixel);
                }
            }
        }
    }

    fn word(&mut self, first: Beat, second: Beat) -> Option<Beat> {
        let mark = second.pixel >> 9 & 1 == 1;
        let continues = self.sends == Sends::Upper && self.place.1 == self.height;
        if first.first {
            (self.place, self.tag) = ((0, 0), if mark { self.tag } else { [false; MARKS] });
            self.sends = match (mark, continues) {
                (false, _) => Sends::Upper,
                (true, true) => Sends::Lower,
                (true, false) => Sends::Nothing,
            };
        } else {
            self.compare(mark);
        }
        let (place, line) = self.place;
        self.place = if second.last { (0, line + 1) } else { (place + 1, line) };
        let pixel = first.pixel & 0xfe00 | second.pixel >> 7 & 0x01f8;
        // A lower half alone is a frame that is begun and not completed, so that it is counted as one.
        let begins = first.first && self.sends != Sends::Lower;
        let is_sent = first.first || self.sends != Sends::Nothing;
        is_sent.then_some(Beat { pixel, first: begins, last: second.last && line % 2 == 1 })
    }

    fn compare(&mut self, mark: bool) {
        let (place, line) = self.place;
        let bit = place % MARKS;
        if line == 0 && place < MARKS && self.sends == Sends::Upper {
            self.tag[bit] = mark;
            return;
        }
        let expected = if bit == 0 { self.sends == Sends::Lower } else { self.tag[bit] };
        if mark != expected {
            self.sends = Sends::Nothing;
        }
    }
}
