//! Whether a board's pictures are right: the CRCs that it makes of every frame at its boundaries, beside those of the golden pipeline.

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use crate::names::Place;
use edof_device::design::reading::{CHECK_FRAME_REGISTER, CHECK_REGISTER};
use edof_device::pattern::Pattern;
use edof_device::registers::map;
use edof_golden::FrameChecks;
use edof_network::fixed_network::layer_names;
use serde::Serialize;
use std::fmt;
use std::ops::ControlFlow;

/// Where words pass that are checked, in the order in which data pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Boundary {
    /// Raw pixel words, out of the memory.
    Raw,
    /// Words of windows, into the calculator.
    Windows,
    /// What a stage sends, and its name.
    Stage(usize, &'static str),
    /// Codes, into the memory.
    Codes,
    /// Codes, out of the memory to the screen.
    Sent,
}

impl fmt::Display for Boundary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Raw => f.write_str("raw frames that come out of the memory"),
            Self::Windows => f.write_str("windows that go into the calculator"),
            Self::Stage(index, layer) => write!(f, "what stage {index} ({layer}) sends"),
            Self::Codes => f.write_str("codes that go into the memory"),
            Self::Sent => f.write_str("codes that come out of the memory"),
        }
    }
}

impl Serialize for Boundary {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Raw => serializer.serialize_str("raw"),
            Self::Windows => serializer.serialize_str("windows"),
            Self::Stage(index, _) => serializer.serialize_str(&format!("stage{index}")),
            Self::Codes => serializer.serialize_str("codes"),
            Self::Sent => serializer.serialize_str("sent"),
        }
    }
}

/// What a board shows of one frame.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Shown {
    /// Number of the frame at each boundary but the last, modulo 256.
    frames: Vec<u32>,
    /// CRC at each boundary.
    crcs: Vec<u32>,
}

/// A boundary at which words are not the golden pipeline's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// The first one.
    pub boundary: Boundary,
    /// CRC-32 of the golden pipeline's words.
    pub expected: u32,
    /// Of the board's.
    pub found: u32,
}

/// Frames that were compared.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Checked {
    /// How many were, all boundaries of each.
    pub frames: u32,
    /// The first boundary of the first frame that differs.
    pub difference: Option<Difference>,
}

/// Frames after a change of what comes in until every boundary has seen it: three buffers each way, and those in flight.
const SETTLE: u32 = 12;
/// Looks after one that differs. The boundaries of one look may show different frames, of which only those of one buffer may be wrong.
const LOOKS_UPSTREAM: u32 = 12;
/// Looks that find no new frame at a boundary before it is given up.
const MAX_LOOKS: usize = 3_000;

/// The golden CRCs in the order of the boundaries.
fn expected(golden: &FrameChecks) -> Vec<(Boundary, u32)> {
    let layers = layer_names(golden.stages.len());
    let stages = golden.stages.iter().zip(layers).enumerate();
    let stages = stages.map(|(index, (crc, layer))| (Boundary::Stage(index, layer), *crc));
    [(Boundary::Raw, golden.raw), (Boundary::Windows, golden.windows)]
        .into_iter()
        .chain(stages)
        .chain([(Boundary::Codes, golden.codes), (Boundary::Sent, golden.codes)])
        .collect()
}

impl<L: Line> Board<L> {
    /// Has the board make raw frames of a pattern itself, or take the source's again.
    ///
    /// # Errors
    /// The line fails.
    pub fn set_pattern(&mut self, pattern: Option<Pattern>) -> Result<(), Error> {
        self.link.set(map::PATTERN, pattern.map_or(0, Pattern::code))
    }

    /// One snapshot of all CRCs.
    fn checks_shown(&mut self, stages: usize) -> Result<Shown, Error> {
        self.snapshot()?;
        let words = self.link.read(map::CHECK_RAW, 5)?;
        let crcs = self.stage_register(stages, CHECK_REGISTER)?;
        let frames = self.stage_register(stages, CHECK_FRAME_REGISTER)?;
        let number = |boundary: u32| words[4] >> (8 * boundary) & 0xff;
        let join = |first: [u32; 2], stages: Vec<u32>, last: Vec<u32>| {
            first.into_iter().chain(stages).chain(last).collect()
        };
        Ok(Shown {
            frames: join([number(0), number(1)], frames, vec![number(2)]),
            crcs: join([words[0], words[1]], crcs, vec![words[2], words[3]]),
        })
    }

    /// The CRCs of frames that every boundary saw after those of `last`. Where frames are small several are in flight, so that numbers differ.
    fn next_frames(&mut self, stages: usize, last: Option<&Shown>) -> Result<Shown, Error> {
        for _ in 0..MAX_LOOKS {
            let shown = self.checks_shown(stages)?;
            let is_new = match last {
                Some(last) => shown.frames.iter().zip(&last.frames).all(|(now, then)| now != then),
                None => shown.frames.iter().all(|number| *number > 0),
            };
            if is_new {
                return Ok(shown);
            }
        }
        Err(Error::NoFrame { port: self.port() })
    }

    /// Compares `frames` snapshots, each of new frames, with the golden CRCs of what comes in, which must be the same frame again and again. The counters of the stages
    /// start anew with every look.
    ///
    /// # Errors
    /// No frame passes, or the line fails.
    pub fn check_frames(
        &mut self,
        golden: &FrameChecks,
        frames: u32,
        step: &mut dyn FnMut(u32, u32) -> ControlFlow<()>,
    ) -> Result<Checked, Error> {
        let expected = expected(golden);
        let stages = golden.stages.len();
        // The place of the first boundary that differs.
        let differs =
            |shown: &Shown| expected.iter().zip(&shown.crcs).position(|((_, crc), found)| crc != found);
        let difference = |shown: &Shown, place: usize| Difference {
            boundary: expected[place].0,
            expected: expected[place].1,
            found: shown.crcs[place],
        };
        // Counters of frames at zero; what is in flight is dropped.
        self.flush()?;
        let (mut last, mut settled, mut compared) = (None::<Shown>, 0, 0);
        while compared < frames {
            if step(compared, frames).is_break() {
                return Err(Error::Interrupted);
            }
            let shown = self.next_frames(stages, last.as_ref())?;
            match differs(&shown) {
                Some(_) if compared == 0 && settled < SETTLE => settled += 1,
                None => compared += 1,
                Some(place) => {
                    let (mut first, mut at) = (place, shown.clone());
                    let mut last = shown;
                    for _ in 0..LOOKS_UPSTREAM {
                        if first == 0 {
                            break;
                        }
                        last = self.next_frames(stages, Some(&last))?;
                        if let Some(place) = differs(&last).filter(|place| *place < first) {
                            (first, at) = (place, last.clone());
                        }
                    }
                    return Ok(Checked { frames: compared + 1, difference: Some(difference(&at, first)) });
                }
            }
            last = Some(shown);
        }
        Ok(Checked { frames, difference: None })
    }

    /// Reads a register by its name.
    pub(crate) fn named(&mut self, name: &str) -> Result<u32, Error> {
        let place: Place = name.parse()?;
        self.get(place)
    }
}
