//! The CRCs that a simulated board makes of its frames.

use super::{Inside, Key, Source};
use edof_core::cable::carried;
use edof_core::{CfaPhase, DisplayMode, RawFrame};
use edof_device::crc::of_words;
use edof_device::design::FrameSize;
use edof_device::pattern::{Pattern, TILE_SIDE};
use edof_device::registers::map;
use edof_device::video::VideoTiming;
use edof_golden::video::pattern;
use edof_golden::{FrameChecks, Golden};
use edof_network::FixedNetwork;
use ndarray::Array2;

/// What passed, and what was copied of it.
#[derive(Default)]
pub(in crate::simulated) struct Checks {
    /// Of what the last frame was made.
    last: Option<Key>,
    frames: u32,
    /// Those of a frame that was looked at before.
    known: Option<(Key, FrameChecks, u32)>,
    shown: Option<(FrameChecks, u32)>,
    shown_frames: u32,
}

impl Checks {
    /// A frame was made.
    pub(in crate::simulated) fn frame(&mut self, key: Key) {
        self.last = Some(key);
        self.frames = self.frames.wrapping_add(1);
    }

    /// A register by its name.
    pub(in crate::simulated) fn register(&self, name: &str) -> u32 {
        let Some((checks, sent)) = &self.shown else { return 0 };
        match name {
            "check_raw" => checks.raw,
            "check_windows" => checks.windows,
            "check_codes" => checks.codes,
            "check_sent" => *sent,
            _ => (self.shown_frames & 0xff) * 0x0101_0101,
        }
    }

    /// What a stage shows: the CRC of what it sent, and of which frame.
    pub(in crate::simulated) fn stage(&self, stage: usize) -> [u32; 2] {
        let crc = self.shown.as_ref().and_then(|(checks, _)| checks.stages.get(stage)).copied();
        [crc.unwrap_or(0), self.shown_frames & 0xff]
    }
}

impl Inside {
    /// The network and the raw frame behind a picture, with their faults.
    pub(in crate::simulated) fn computed(&self, network: FixedNetwork, key: Key) -> (FixedNetwork, RawFrame) {
        let raw = self.raw_frame(key.4);
        (self.faults.spoil_network(network), self.faults.spoil_raw(raw))
    }

    /// The raw frame in the memory. The camera stands behind its cable, so that only `video_setup.plain` leaves all bits of it.
    fn raw_frame(&self, source: Source) -> RawFrame {
        let frame = self.design.frame;
        let made = match source {
            Source::Camera => None,
            Source::Pattern(code) => {
                let of_code = Pattern::ALL.into_iter().find(|pattern| pattern.code() == code);
                of_code.and_then(|pattern| pattern::frame(pattern, frame).ok())
            }
            Source::Tile(_) => {
                let word = |(r, c)| self.tile[TILE_SIDE * r + c];
                pattern::tiled(&Array2::from_shape_fn((TILE_SIDE, TILE_SIDE), word), frame).ok()
            }
            Source::Host(_) => Array2::from_shape_vec((frame.height, frame.width), self.host_frame.clone())
                .ok()
                .and_then(|words| RawFrame::from_values(words, 16, CfaPhase::Rggb).ok()),
        };
        let is_plain = self.controls.get(&map::VIDEO_SETUP).is_some_and(|setup| setup & map::PLAIN != 0);
        made.unwrap_or_else(|| if is_plain { self.raw.clone() } else { carried(&self.raw) })
    }

    /// A word of the host's window to the codes of the last picture.
    pub(in crate::simulated) fn picture_word(&mut self, index: usize) -> u32 {
        let corner = self.controls.get(&map::PICTURE_CORNER).copied().unwrap_or(0);
        let FrameSize { width, height, .. } = self.design.frame;
        let [row, column] = [corner >> 16, corner].map(|place| (place & 0x1fff) as usize);
        let (row, column) = (row + index / TILE_SIDE, column + index % TILE_SIDE);
        let key = self.checks.last.filter(|_| row < height && column < width);
        if corner & map::RAW_WORDS != 0 {
            return key.map_or(0, |key| self.raw_frame(key.4).pixels()[(row, column)].into());
        }
        let made = key.and_then(|key| self.made(key));
        made.map_or(0, |made| u32::from(made.pixels[row * width + column]))
    }

    /// Cycles of a clock since the board was made, modulo 2^32.
    pub(in crate::simulated) const fn cycles(&self, kilohertz: u64) -> u32 {
        (self.now as u128 * kilohertz as u128 / 1_000_000) as u32
    }

    pub(in crate::simulated) fn pixel_kilohertz(&self) -> u64 {
        VideoTiming::of_frame(self.design.frame).pixel_khz as u64
    }

    /// Copies the CRCs of the last frame to where they are shown.
    pub(in crate::simulated) fn copy_checks(&mut self) {
        self.checks.shown_frames = self.checks.frames;
        let Some(key) = self.checks.last else { return };
        let known = self.checks.known.as_ref().is_some_and(|(of, ..)| *of == key);
        if !known {
            let Some((checks, sent)) = self.checks_of(key) else { return };
            self.checks.known = Some((key, checks, sent));
        }
        self.checks.shown = self.checks.known.as_ref().map(|(_, checks, sent)| (checks.clone(), *sent));
        for (index, stage) in self.stages.iter_mut().enumerate() {
            stage.show_check(self.checks.stage(index));
        }
    }

    fn checks_of(&mut self, key: Key) -> Option<(FrameChecks, u32)> {
        let mode = if key.2 { DisplayMode::Colour } else { DisplayMode::Luma };
        let display = self.tables.display(mode)?;
        let (network, raw) = self.computed(self.network(key.0)?, key);
        let checks = Golden::new(network).ok()?.checks(&display, &raw).ok()?;
        let made = self.made(key)?;
        Some((checks, of_words(made.pixels.iter().copied())))
    }
}
