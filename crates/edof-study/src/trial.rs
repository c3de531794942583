//! One photograph at one depth behind one camera: what the sensor gives, and what a reconstruction of it is worth.

use crate::methods::method::Method;
use crate::methods::spec::PrepareError;
use crate::metrics::{BORDER, MetricError, Quality, luma, psnr, shown};
use crate::pictures::busiest_part;
use crate::report::picture::{Encoded, jpeg};
use edof_core::camera::Camera;
use edof_core::reconstructor::Multiplications;
use edof_core::{ColourFrame, Noise, RawFrame, ReconstructError, Reconstruction, Tone};
use edof_io::photos::Photo;
use edof_optics::blur_frame;
use edof_optics::psf::{NoPsf, Psf};
use edof_optics::{Sensor, SensorError, expose};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Side in pixels of the parts that are shown.
const CROP: usize = 96;
/// Bits of the simulated sensor.
const DEPTH: u32 = 16;

/// The three noise levels that tables show under a tone, if none are asked for.
#[must_use]
pub fn usual_noise(tone: Tone) -> [Noise; 3] {
    match tone {
        Tone::Linear => [Noise::None, Noise::gaussian(0.01), Noise::gaussian(0.02)],
        Tone::Srgb => [Noise::None, Noise::sensor(1.0), Noise::sensor(8.0)],
    }
}

/// What one method made of one photograph at one depth and noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Short name of the method, made from its identity.
    pub method: String,
    /// The method.
    #[serde(flatten)]
    pub identity: Method,
    /// Name of the camera.
    pub camera: String,
    /// Name of the photograph.
    pub image: String,
    /// Depth.
    pub psi: f64,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What the photograph's numbers were taken for.
    pub tone: Tone,
    /// Quality of the picture as it is looked at.
    #[serde(flatten)]
    pub picture: Quality,
    /// Quality of the light; the same where picture and light are the same numbers.
    pub light: Quality,
    /// Wall-clock seconds per megapixel.
    pub seconds_per_megapixel: f64,
    /// What it took.
    #[serde(flatten)]
    pub work: Work,
}

/// What a method counted; nothing where it does not count.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Work {
    /// Multiplications for each pixel if every weight is multiplied.
    pub dense_multiplications_a_pixel: Option<f64>,
    /// Multiplications for each pixel that were carried out.
    pub executed_multiplications_a_pixel: Option<f64>,
    /// Words that were not zero after each shrinkage, mean over patches.
    pub nonzeros_a_patch: Option<Vec<f64>>,
    /// Words of all stages and sums that did not fit.
    pub saturations: Option<u64>,
}

/// A trial that cannot be made.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum TrialError {
    /// A method rejected a frame.
    #[error("{image}: {source}")]
    Reconstruct { image: String, source: ReconstructError },
    /// The photograph cannot be exposed, or the noise is impossible.
    #[error("{image}: {source}")]
    Sensor { image: String, source: SensorError },
    /// A depth that a camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
    /// A method that cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// A part that cannot be encoded.
    #[error("{image}: picture: {source}")]
    Picture { image: String, source: image::ImageError },
    /// A photograph too small to measure.
    #[error("{image}: {source}")]
    Metric { image: String, source: MetricError },
}

/// One photograph at one depth behind one camera.
pub struct Trial<'a> {
    camera: &'a Camera,
    photo: &'a Photo,
    psi: f64,
    tone: Tone,
    /// The photograph's light.
    light: ColourFrame,
}

impl<'a> Trial<'a> {
    /// A photograph whose numbers are what the tone says.
    #[must_use]
    pub fn new(camera: &'a Camera, photo: &'a Photo, psi: f64, tone: Tone) -> Self {
        Self { camera, photo, psi, tone, light: tone.decoded(&photo.frame) }
    }

    /// What the sensor gives at each noise level.
    ///
    /// # Errors
    /// [`TrialError::Sensor`].
    pub fn shots(&self, psfs: &[Psf; 3], noise: &[Noise]) -> Result<Vec<(Noise, RawFrame)>, TrialError> {
        let shots = self.exposures(std::slice::from_ref(psfs), noise)?.into_iter().flatten();
        Ok(noise.iter().copied().zip(shots).collect())
    }

    /// What the sensor gives in each exposure at each noise level. An exposure has the kernels of its focus, and noise of its own.
    ///
    /// # Errors
    /// [`TrialError::Sensor`].
    pub fn exposures(&self, kernels: &[[Psf; 3]], noise: &[Noise]) -> Result<Vec<Vec<RawFrame>>, TrialError> {
        let blurred: Vec<ColourFrame> = kernels.iter().map(|psfs| blur_frame(&self.light, psfs)).collect();
        let scene = |&noise: &Noise| -> Result<Vec<RawFrame>, SensorError> {
            let first = sensor(&self.photo.name, self.psi, noise);
            let of = |(exposure, light)| {
                expose(light, &Sensor { seed: first.seed.wrapping_add(exposure), ..first.clone() })
            };
            (0..).zip(&blurred).map(of).collect()
        };
        noise
            .par_iter()
            .map(scene)
            .collect::<Result<_, _>>()
            .map_err(|source| TrialError::Sensor { image: self.image(), source })
    }

    /// What a reconstruction is worth.
    ///
    /// # Errors
    /// [`TrialError::Metric`].
    pub fn row(
        &self,
        noise: Noise,
        method: &Method,
        result: &Reconstruction,
    ) -> Result<Measured, TrialError> {
        let tone = self.tone;
        let compared = |truth: &ColourFrame, estimate: &ColourFrame, tone: Tone| {
            Quality::of(truth, estimate, BORDER, tone)
                .map_err(|source| TrialError::Metric { image: self.image(), source })
        };
        let light = compared(&self.light, &result.frame, Tone::light())?;
        let picture = match tone {
            Tone::Linear => light,
            Tone::Srgb => compared(&self.photo.frame, &shown(&result.frame, tone), tone)?,
        };
        let (height, width) = self.light.size();
        let pixels = (height * width) as f64;
        Ok(Measured {
            method: method.to_string(),
            identity: method.clone(),
            camera: self.camera.name.clone(),
            image: self.image(),
            psi: self.psi,
            noise,
            tone,
            picture,
            light,
            seconds_per_megapixel: result.seconds / (pixels * 1e-6),
            work: Work::of(result, pixels),
        })
    }

    /// Returns PSNR in dB of the picture that a reconstruction shows.
    ///
    /// # Errors
    /// [`TrialError::Metric`].
    pub fn psnr_db(&self, result: &Reconstruction) -> Result<f64, TrialError> {
        psnr(&self.photo.frame, &shown(&result.frame, self.tone), BORDER)
            .map_err(|source| TrialError::Metric { image: self.image(), source })
    }

    /// Row and column of the busiest part of the photograph, where it has room for one.
    #[must_use]
    pub fn busiest_part(&self) -> Option<(usize, usize)> {
        busiest_part(&luma(&self.photo.frame), CROP)
    }

    /// A part of a reconstruction as it is looked at.
    ///
    /// # Errors
    /// [`TrialError::Picture`].
    pub fn crop(&self, frame: &ColourFrame, at: (usize, usize)) -> Result<Encoded, TrialError> {
        self.encoded(&shown(frame, self.tone), at)
    }

    /// The same part of the photograph.
    ///
    /// # Errors
    /// [`TrialError::Picture`].
    pub fn crop_of_photograph(&self, at: (usize, usize)) -> Result<Encoded, TrialError> {
        self.encoded(&self.photo.frame, at)
    }

    fn encoded(&self, shown: &ColourFrame, (row, column): (usize, usize)) -> Result<Encoded, TrialError> {
        jpeg(&shown.crop(row, column, CROP, CROP), Tone::Linear)
            .map(Encoded)
            .map_err(|source| TrialError::Picture { image: self.image(), source })
    }

    /// Name of the photograph.
    #[must_use]
    pub fn image(&self) -> String {
        self.photo.name.clone()
    }
}

impl Work {
    fn of(result: &Reconstruction, pixels: f64) -> Self {
        let multiplications = |count: fn(&Multiplications) -> u64| {
            result.multiplications.as_ref().map(|m| count(m) as f64 / pixels)
        };
        let counters = result.counters.as_ref();
        Self {
            dense_multiplications_a_pixel: multiplications(|m| m.dense),
            executed_multiplications_a_pixel: multiplications(|m| m.executed),
            nonzeros_a_patch: counters
                .map(|c| c.nonzeros.iter().map(|&n| n as f64 / c.patches as f64).collect()),
            saturations: counters.map(|c| c.saturations),
        }
    }
}

/// The sensor for one photograph, ψ and noise: its seed depends on these three and nothing else.
#[must_use]
pub fn sensor(image: &str, psi: f64, noise: Noise) -> Sensor {
    let level = match noise {
        Noise::None => vec![0.0],
        Noise::Gaussian { sigma } => vec![sigma],
        Noise::Sensor(s) => vec![s.full_well_e, s.read_noise_e, s.gain],
    };
    let words = image.bytes().map(u64::from).chain([psi.to_bits()]).chain(level.iter().map(|v| v.to_bits()));
    // FNV-1a over whole words.
    let seed = words
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, word| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3));
    Sensor { depth: DEPTH, noise, seed, ..Sensor::default() }
}
