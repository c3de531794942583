//! What a run of a core reached.

use super::rig::{Rig, RigConfig};
use crate::Error;
use serde::Serialize;

/// The state of a run at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moment {
    picoseconds: u64,
    written: u64,
    read: u64,
    made: u32,
}

/// Figures of a run, as `edof_golden::video::figures` states them ahead.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// New pictures a second.
    pub frames_per_second: f64,
    /// Bytes a second that were written to the memory.
    pub written: f64,
    /// Bytes a second that were read.
    pub read: f64,
    /// Seconds from a frame's first pixel at the receiver to its picture's first pixel at the transmitter, picture by picture.
    pub latency: Vec<f64>,
}

impl Rig {
    /// Where the run stands.
    ///
    /// # Errors
    /// As [`Rig::register`].
    pub fn moment(&mut self) -> Result<Moment, Error> {
        let made = self.register("picture_frames")?;
        let words = |bursts: &[(u64, u64)]| bursts.iter().map(|(_, words)| words).sum::<u64>();
        let bytes = self.memory.word_bytes();
        let (written, read) = (words(&self.memory.written.bursts), words(&self.memory.read.bursts));
        Ok(Moment { picoseconds: self.bench.time_ps(), written: bytes * written, read: bytes * read, made })
    }

    /// What was reached since then; `shown` says which picture each frame on the screen was (`super::compare`).
    ///
    /// # Errors
    /// As [`Rig::register`].
    pub fn measured(
        &mut self,
        since: &Moment,
        begin: &RigConfig,
        shown: &[Option<usize>],
    ) -> Result<Measured, Error> {
        let now = self.moment()?;
        let seconds = (now.picoseconds - since.picoseconds) as f64 * 1e-12;
        let rate = |before: u64, after: u64| (after - before) as f64 / seconds;
        Ok(Measured {
            frames_per_second: rate(since.made.into(), now.made.into()),
            written: rate(since.written, now.written),
            read: rate(since.read, now.read),
            latency: self.latencies(begin, shown),
        })
    }

    /// A frame on the screen is complete with the sync after it.
    fn latencies(&self, begin: &RigConfig, shown: &[Option<usize>]) -> Vec<f64> {
        let (line, frame) = (begin.timing.line, begin.timing.frame);
        let picture = ((frame.active + frame.front) * line.total()) as u64 * begin.periods.output;
        let first = |(number, sent): (usize, &u64)| {
            let at = shown.iter().position(|picture| *picture == Some(number))?;
            self.shown_at.get(at)?.checked_sub(picture + sent).map(|ps| ps as f64 * 1e-12)
        };
        // The last frame is sent again and again.
        let once = self.sent_at.len().saturating_sub(1);
        self.sent_at[..once].iter().enumerate().filter_map(first).collect()
    }
}
