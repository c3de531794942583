//! The receiver's bus: the position of a pixel, whether it is passed on, what is measured.

use super::Pins;
use edof_core::cable;
use edof_device::design::FrameSize;
use std::collections::VecDeque;

/// Largest place and count, where counting stops.
const MAX: usize = (1 << 13) - 1;
/// Cycles from the pins to where a pixel's place is known.
const KNOWN: usize = 2;

/// A pixel on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Beat {
    /// Raw pixel word.
    pub pixel: u16,
    /// The pixel is the first of its frame.
    pub first: bool,
    /// The pixel is the last of its line.
    pub last: bool,
}

/// What was measured and counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Measured {
    /// Pixels of the last line.
    pub width: usize,
    /// Lines of the last frame that had pixels.
    pub height: usize,
    /// Cycles between the last two horizontal syncs.
    pub line_cycles: usize,
    /// Horizontal syncs of the last frame.
    pub lines: usize,
    /// Frames come.
    pub present: bool,
    /// The last frame had the wanted width and height.
    pub fits: bool,
    /// Frames that had them.
    pub right_frames: u64,
    /// Frames that had others.
    pub wrong_frames: u64,
    /// Frames with a code outside of those that carry a word, of whatever size.
    pub range_frames: u64,
    /// Frames given up because a pixel was not taken in time.
    pub overruns: u64,
}

/// The receiver's bus since reset.
#[derive(Debug, Clone)]
pub struct VideoIn {
    frame: FrameSize,
    patience: u32,
    /// Any bytes are pixels, Y above C. Change it while no pixel is on its way.
    pub is_plain: bool,
    /// The pins of the last cycles, the latest first.
    past: VecDeque<Pins>,
    /// Where the next pixel lies: column, row.
    place: (usize, usize),
    /// No line of the frame has come yet.
    between: bool,
    /// A line had another width, or the syncs stopped.
    crooked: bool,
    /// A code of the frame lay outside of those that carry a word.
    strays: bool,
    /// The frame before was seen whole, so that the one that ends can be judged.
    known: bool,
    sending: bool,
    /// Found in the cycle before.
    found: Option<Beat>,
    stands: Option<Beat>,
    since_sync: usize,
    syncs: usize,
    waited: u32,
    measured: Measured,
}

impl VideoIn {
    /// The bus of frames of one size; there is no signal after `patience` cycles without an edge of the vertical sync.
    #[must_use]
    pub fn new(frame: FrameSize, patience: u32) -> Self {
        Self {
            frame,
            patience,
            is_plain: false,
            past: VecDeque::from(vec![Pins::default(); KNOWN + 1]),
            place: (0, 0),
            between: false,
            crooked: true,
            strays: false,
            known: false,
            sending: false,
            found: None,
            stands: None,
            since_sync: 0,
            syncs: 0,
            waited: patience,
            measured: Measured::default(),
        }
    }

    /// What stands on the output.
    #[must_use]
    pub const fn beat(&self) -> Option<Beat> {
        self.stands
    }

    /// What was measured.
    #[must_use]
    pub const fn measured(&self) -> Measured {
        self.measured
    }

    /// One cycle: the pins in it, and whether the receiver of the pixels takes one.
    pub fn step(&mut self, pins: Pins, ready: bool) {
        let late = self.stands.is_some() && !ready;
        let lost = late && self.found.is_some();
        if !late {
            self.stands = self.found;
        }
        let (now, before) = (self.past[KNOWN - 1], self.past[KNOWN]);
        let ended = Ended {
            between: self.between,
            known: self.known,
            strays: self.strays,
            right: !self.crooked && self.place.1 == self.frame.height,
            height: self.place.1,
            lines: self.syncs,
        };
        let syncs_stopped = self.since_sync == MAX;
        self.count(now, before);
        self.found = self.pixel(now, before, self.past[KNOWN - 2].de);
        if syncs_stopped {
            (self.crooked, self.sending) = (true, false);
        }
        if lost {
            (self.found, self.sending) = (None, false);
            self.measured.overruns += 1;
        }
        self.vertical_sync(now, before, ended);
        self.past.push_front(pins);
        self.past.pop_back();
    }

    /// The pixel of this cycle, if it is passed on; and the position of the next one, which may be on the bus already.
    fn pixel(&mut self, now: Pins, before: Pins, more: bool) -> Option<Beat> {
        if now.de && !before.de {
            self.place.0 = 0;
            if self.between {
                (self.between, self.sending, self.place.1) = (false, true, 0);
            }
        }
        let (column, row) = self.place;
        if now.de {
            self.place.0 = (column + 1).min(MAX);
        }
        if !now.de && before.de {
            self.measured.width = column;
            self.place.1 = (row + 1).min(MAX);
            if column != self.frame.width {
                (self.crooked, self.sending) = (true, false);
            }
        }
        let plain = self.is_plain.then(|| now.data.swap_bytes());
        let word = plain.or_else(|| cable::word(now.data.to_le_bytes()));
        if now.de && word.is_none() {
            (self.strays, self.sending) = (true, false);
        }
        let last = column + 1 == self.frame.width;
        let inside = column < self.frame.width && row < self.frame.height;
        let goes_on = now.de && self.sending && inside && !(last && more);
        let beat = Beat { pixel: word?, first: (column, row) == (0, 0), last };
        goes_on.then_some(beat)
    }

    fn count(&mut self, now: Pins, before: Pins) {
        let since_sync = self.since_sync;
        self.since_sync = (since_sync + 1).min(MAX);
        if now.hs && !before.hs {
            self.measured.line_cycles = since_sync;
            self.since_sync = 1;
            self.syncs = (self.syncs + 1).min(MAX);
        }
    }

    /// Judges a frame as the vertical sync changes for the first time after it.
    fn vertical_sync(&mut self, now: Pins, before: Pins, ended: Ended) {
        let changed = now.vs != before.vs;
        if self.waited == self.patience {
            self.known = false;
            (self.measured.present, self.measured.fits) = (false, false);
        }
        self.waited = if changed { 0 } else { self.waited.saturating_add(1).min(self.patience) };
        if !changed || ended.between {
            return;
        }
        if ended.known {
            let measured = &mut self.measured;
            (measured.present, measured.fits) = (true, ended.right);
            (measured.height, measured.lines) = (ended.height, ended.lines);
            measured.right_frames += u64::from(ended.right);
            measured.wrong_frames += u64::from(!ended.right);
            measured.range_frames += u64::from(ended.strays);
        }
        (self.between, self.crooked, self.strays, self.known, self.sending) =
            (true, false, false, true, false);
        self.syncs = usize::from(now.hs && !before.hs);
    }
}

/// A frame as it stood before the cycle in which it ends.
#[derive(Debug, Clone, Copy)]
struct Ended {
    between: bool,
    known: bool,
    strays: bool,
    right: bool,
    height: usize,
    lines: usize,
}
