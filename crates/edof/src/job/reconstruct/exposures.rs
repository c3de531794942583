//! The raw frames of one scene: their order, and what all of them have in common.

use super::ReconstructJob;
use super::frame::{FrameSource, Taken};
use crate::job::{FrameNote, JobError};
use edof_io::raw::Size;
use edof_io::record::Exposure;
use serde::Serialize;

impl ReconstructJob {
    /// Returns the raw frames of the scene, one at least.
    pub(super) fn open(&self, note: &dyn Fn(FrameNote)) -> Result<Vec<Taken>, JobError> {
        let sources: Vec<&FrameSource> = std::iter::once(&self.source).chain(&self.further).collect();
        let exposures = sources.iter().map(|source| source.open(note)).collect::<Result<Vec<_>, _>>()?;
        for (place, taken) in exposures.iter().enumerate() {
            if !self.accepts_any_lens {
                taken.check_place(Exposure { number: place + 1, of: exposures.len() })?;
            }
            self.check_like(taken, &exposures[0])?;
        }
        Ok(exposures)
    }

    /// Rejects a frame that differs from the first of its scene in more than focus and noise.
    fn check_like(&self, taken: &Taken, first: &Taken) -> Result<(), JobError> {
        let mut fields = self.common(taken).into_iter().zip(self.common(first));
        match fields.find(|(found, expected)| found != expected) {
            Some(((field, found), (_, expected))) => {
                let (path, first) = (taken.path.clone(), first.path.clone());
                Err(JobError::UnlikeExposures { path, field, found, expected, first })
            }
            None => Ok(()),
        }
    }

    /// What all exposures of a scene have in common.
    fn common(&self, taken: &Taken) -> [(&'static str, String); 6] {
        [
            ("size", Size::of(&taken.frame).to_string()),
            ("phase", taken.frame.phase().to_string()),
            ("bit depth", taken.depth.to_string()),
            ("tone", self.tone(taken).to_string()),
            ("white balance", numbers(taken.rendering.white_balance)),
            ("colour matrix", numbers(taken.rendering.matrix)),
        ]
    }
}

fn numbers(value: Option<impl Serialize>) -> String {
    value.map_or_else(|| "none".to_owned(), |value| serde_json::json!(value).to_string())
}

impl Taken {
    /// Rejects a frame whose record states another place.
    fn check_place(&self, given: Exposure) -> Result<(), JobError> {
        let recorded = self.record.as_ref().and_then(|record| record.exposure);
        match recorded.filter(|recorded| *recorded != given) {
            Some(recorded) => Err(JobError::OtherExposure { path: self.path.clone(), recorded, given }),
            None => Ok(()),
        }
    }
}
