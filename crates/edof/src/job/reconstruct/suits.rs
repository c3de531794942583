//! Whether a network suits a frame: its lens, its tone, its noise.

use super::ReconstructJob;
use super::frame::Taken;
use crate::job::note::{OtherLens, largest_defocus};
use crate::job::{FrameNote, JobError};
use crate::presets::weights;
use edof_core::ReconstructError;
use edof_core::camera::Camera;
use edof_network::Fit;
use edof_network::network::Origin;

/// Largest defocus of a lens as part of that which a network was trained for.
const MAX_DEFOCUS: f64 = 1.25;

/// Whether both lenses have no mask, and the second has no more defocus than a network for the first was trained for: they differ in the size of their blur
/// alone.
fn is_similar(trained: &Camera, camera: &Camera) -> bool {
    let is_plain = |camera: &Camera| camera.is_clear() && camera.psf_bank.is_none();
    is_plain(trained) && is_plain(camera) && largest_defocus(camera) <= MAX_DEFOCUS * largest_defocus(trained)
}

impl ReconstructJob {
    /// Rejects a network for another lens or another number of exposures; remarks where it was trained for another tone or noise.
    pub(super) fn check_suits(
        &self,
        origin: &Origin,
        exposures: &[Taken],
        note: &dyn Fn(FrameNote),
    ) -> Result<(), JobError> {
        let cameras = origin.cameras();
        if exposures.len() != cameras.len() {
            return Err(self.failed(ReconstructError::exposures(
                &origin.name,
                exposures.len(),
                cameras.len(),
            )));
        }
        exposures
            .iter()
            .zip(&cameras)
            .try_for_each(|(taken, camera)| self.check_lens(camera, taken, note))?;
        for taken in exposures {
            self.remark_on_tone(origin, taken, note);
            self.remark_on_noise(origin, taken, note);
        }
        Ok(())
    }

    /// The network must have been trained for the lens that took the frame, as its record or the user states.
    fn check_lens(&self, trained: &Camera, taken: &Taken, note: &dyn Fn(FrameNote)) -> Result<(), JobError> {
        let Some(camera) = taken.camera.as_ref().filter(|camera| !trained.same_lens(camera)) else {
            return Ok(());
        };
        let other = Box::new(OtherLens {
            path: taken.path.clone(),
            network: self.network(taken).to_owned(),
            trained: trained.clone(),
            camera: camera.clone(),
            is_recorded: taken.record.is_some(),
            tone: self.tone(taken),
        });
        if is_similar(trained, camera) && self.further.is_empty() {
            note(FrameNote::OtherClearLens(other));
        } else if self.accepts_any_lens {
            note(FrameNote::OtherLens(other));
        } else {
            return Err(JobError::OtherLens(other));
        }
        Ok(())
    }

    fn remark_on_tone(&self, origin: &Origin, taken: &Taken, note: &dyn Fn(FrameNote)) {
        let tone = self.tone(taken);
        let is_known = taken.record.is_some() || self.source.stated.tone.is_some();
        let Some(trained) = origin.conditions.first().map(|condition| condition.tone) else { return };
        if !is_known || origin.conditions.iter().any(|condition| condition.tone == tone) {
            return;
        }
        note(FrameNote::OtherTone {
            path: taken.path.clone(),
            network: self.network(taken).to_owned(),
            camera: Box::new(origin.camera.clone()),
            trained,
            tone,
        });
    }

    /// Remarks on noise, as the frame's record or the user states it, outside of the range that the network was trained for.
    fn remark_on_noise(&self, origin: &Origin, taken: &Taken, note: &dyn Fn(FrameNote)) {
        let (name, tone) = (self.network(taken), self.tone(taken));
        let Some(noise) = self.noise(taken) else { return };
        if origin.fit(tone, noise).is_none_or(Fit::is_inside) {
            return;
        }
        let better = weights::for_noise(name, tone, noise);
        note(FrameNote::OtherNoise {
            path: taken.path.clone(),
            network: name.to_owned(),
            trained: origin.conditions.iter().filter(|condition| condition.tone == tone).cloned().collect(),
            noise,
            better: (better != name).then(|| better.to_owned()),
        });
    }
}
