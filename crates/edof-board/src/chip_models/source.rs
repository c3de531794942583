//! An HDMI source: a player that reads the EDID when hot plug rises and sends what the sink takes.

use crate::chip_models::edid::{self, Edid, EdidError};
use crate::chip_models::hdmi::{Avi, Coding, Link, Pixel, Timing, rgb_of};

/// A picture to be sent: luma and chroma (Cb and Cr by turns) of each pixel, as a file in 2vuy has them.
pub type Picture = Vec<[u8; 2]>;

/// What a source is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum State {
    /// Hot plug is low.
    #[error("the source sees no hot plug")]
    NoHotPlug,
    /// Hot plug rose, but nobody answered at 0x50 of the cable's I2C.
    #[error("the source found no EDID and stays dark")]
    NoEdid,
    /// What answered was no EDID.
    #[error("{0}; the source stays dark")]
    BadEdid(EdidError),
    /// The sink takes no mode that the source has.
    #[error("the sink does not prefer the source's mode; the source stays dark")]
    NoMode,
    /// The source sends.
    #[error("the source sends {0:?}")]
    Sends(Coding),
}

/// Place in a frame, porches and syncs included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub row: usize,
    /// Pixel of the line.
    pub column: usize,
}

/// A source with a cable.
#[derive(Debug, Clone)]
pub struct Source {
    /// The mode that the source asks the sink for.
    pub mode: Timing,
    timing: Timing,
    pictures: Vec<Picture>,
    /// The source declares values of full range.
    pub declares_full: bool,
    /// The coding whatever the EDID says.
    pub coding: Option<Coding>,
    state: State,
    is_hdmi: bool,
    place: Place,
    /// Number of the picture that is being sent; the last one is sent again and again.
    pub picture: usize,
    /// Whole frames that were sent since hot plug.
    pub frames: usize,
}

impl Source {
    /// A source that sends these pictures one after the other. It asks the sink for 1920×1080 at 60 Hz, or another `mode`; what it sends then
    /// has this timing, which may be a smaller one in a short simulation.
    #[must_use]
    pub const fn new(timing: Timing, pictures: Vec<Picture>) -> Self {
        Self {
            mode: Timing::P1080_60,
            timing,
            pictures,
            declares_full: false,
            coding: None,
            state: State::NoHotPlug,
            is_hdmi: false,
            place: Place { row: 0, column: 0 },
            picture: 0,
            frames: 0,
        }
    }

    /// What it is doing.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// Whether its clock and its channels run.
    #[must_use]
    pub const fn sends(&self) -> bool {
        matches!(self.state, State::Sends(_))
    }

    /// Timing of what it sends.
    #[must_use]
    pub const fn timing(&self) -> Timing {
        self.timing
    }

    /// How it runs the link.
    #[must_use]
    pub fn link(&self) -> Option<Link> {
        let State::Sends(coding) = self.state else { return None };
        let avi = Avi { coding, is_full: self.declares_full };
        Some(Link { is_hdmi: self.is_hdmi, avi: self.is_hdmi.then_some(avi) })
    }

    /// The level of hot plug, and what the cable's I2C answers at 0x50. The EDID is read once, when hot plug rises.
    pub fn see(&mut self, hot_plug: bool, edid: impl FnOnce() -> Option<Edid>) {
        if !hot_plug {
            self.state = State::NoHotPlug;
        } else if self.state == State::NoHotPlug {
            (self.place, self.frames) = (Place { row: 0, column: 0 }, 0);
            self.state = edid().map_or(State::NoEdid, |edid| self.choose(&edid));
        }
    }

    fn choose(&mut self, edid: &Edid) -> State {
        let sink = match edid::read(edid) {
            Ok(sink) => sink,
            Err(error) => return State::BadEdid(error),
        };
        let wanted = self.mode;
        if sink.preferred != (wanted.line.active, wanted.frame.active, wanted.khz) {
            return State::NoMode;
        }
        self.is_hdmi = sink.is_hdmi;
        let by_edid = if sink.is_hdmi && sink.takes_422 { Coding::Ycc422 } else { Coding::Rgb };
        State::Sends(self.coding.unwrap_or(by_edid))
    }

    /// Where it is; then one clock passes.
    pub fn advance(&mut self) -> Place {
        let place = self.place;
        self.place.column += 1;
        if self.place.column == self.timing.line.total() {
            self.place = Place { row: place.row + 1, column: 0 };
        }
        if self.place.row == self.timing.frame.total() {
            self.place.row = 0;
            self.frames += 1;
            self.picture = (self.picture + 1).min(self.pictures.len().saturating_sub(1));
        }
        place
    }

    /// The channels of a line of the picture.
    #[must_use]
    pub fn line(&self, row: usize) -> Vec<Pixel> {
        let width = self.timing.line.active;
        let picture =
            self.pictures.get(self.picture).and_then(|picture| picture.get(row * width..(row + 1) * width));
        let State::Sends(coding) = self.state else { return vec![] };
        let pairs = picture.unwrap_or_default().chunks(2);
        let chroma = |pair: &[[u8; 2]]| (pair[0][1], pair.last().map_or(128, |pixel| pixel[1]));
        pairs
            .flat_map(|pair| {
                let (cb, cr) = chroma(pair);
                pair.iter().map(move |[y, c]| match coding {
                    Coding::Ycc422 => [0, *y, *c],
                    Coding::Ycc444 => [cb, *y, cr],
                    Coding::Rgb => {
                        let [r, g, b] = rgb_of(*y, cb, cr);
                        [b, g, r]
                    }
                })
            })
            .collect()
    }
}
