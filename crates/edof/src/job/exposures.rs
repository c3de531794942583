//! Several exposures of a static scene in the time of one, each with its own focus.

use super::capture::{CaptureJob, CaptureOutputs};
use edof_core::Noise;
use edof_core::camera::Camera;
use edof_core::noise::NoiseError;
use edof_io::record::Exposure;
use edof_network::network::MAX_EXPOSURES;
use edof_optics::Sensor;
use std::path::{Path, PathBuf};

/// Exposures that a capture cannot have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum ExposuresError {
    /// No focus, or more than a network takes.
    #[error("{0} foci: must be 1 to {MAX_EXPOSURES}, one for each exposure")]
    Count(usize),
    /// PSFs that are not computed.
    #[error("the camera's PSFs are those of a bank, which has one focus; leave the foci or the bank out")]
    Bank,
    /// A board takes one frame.
    #[error("the board takes one raw frame, so there is no video of several exposures; leave the video out")]
    Video,
    /// No electrons to share.
    #[error(
        "noise {0}: Gaussian noise states no electrons that exposures could share; expected none or sensor, as in sensor:gain=4"
    )]
    Gaussian(Noise),
    /// Less than an electron for each.
    #[error("the share of each exposure: {0}")]
    Noise(#[from] NoiseError),
}

impl CaptureJob {
    /// Returns the captures that share the exposure time of this one in equal parts, one for each focus in ψ. Each has its share of the electrons,
    /// noise of its own (the seed of the first is this capture's, each further one is 1 more), and files with its number. With one focus there is
    /// one capture of the whole time.
    ///
    /// # Errors
    /// [`ExposuresError`].
    pub fn exposures(&self, foci: &[f64]) -> Result<Vec<Self>, ExposuresError> {
        let of = foci.len();
        if !(1..=MAX_EXPOSURES).contains(&of) {
            return Err(ExposuresError::Count(of));
        }
        if self.camera.psf_bank.is_some() {
            return Err(ExposuresError::Bank);
        }
        if of > 1 && self.outputs.video.is_some() {
            return Err(ExposuresError::Video);
        }
        let whole = self.sensor.noise;
        let noise = whole.of_share(of).ok_or(ExposuresError::Gaussian(whole))?;
        noise.check()?;
        let exposure = |(place, &focus_psi): (usize, &f64)| Self {
            camera: Camera { focus_psi, ..self.camera.clone() },
            sensor: Sensor {
                noise,
                seed: self.sensor.seed.wrapping_add(place as u64),
                ..self.sensor.clone()
            },
            exposure: (of > 1).then_some(Exposure { number: place + 1, of }),
            outputs: self.outputs.of_exposure(place + 1, of),
            ..self.clone()
        };
        Ok(foci.iter().enumerate().map(exposure).collect())
    }
}

impl CaptureOutputs {
    /// Returns the files of an exposure, 1 first: those of what it sees have its number, as in `raw-2.png`. The sharp ground truth is of all, and
    /// the first writes it.
    #[must_use]
    pub fn of_exposure(&self, number: usize, of: usize) -> Self {
        if of == 1 {
            return self.clone();
        }
        Self {
            raw: numbered(&self.raw, number),
            video: None,
            sharp: self.sharp.clone().filter(|_| number == 1),
            light: self.light.as_deref().map(|light| numbered(light, number)),
        }
    }
}

/// The name of a file with a number before its ending.
fn numbered(file: &Path, number: usize) -> PathBuf {
    let mut name = file.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{number}"));
    if let Some(ending) = file.extension() {
        name.push(".");
        name.push(ending);
    }
    file.with_file_name(name)
}

#[cfg(test)]
mod tests;
