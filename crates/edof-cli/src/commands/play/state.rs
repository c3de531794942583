//! What a page asks for, as JSON: the positions of its sliders. Nothing else decides what it is answered.

use crate::error::Error;
use crate::limits::all_within;
use edof_core::camera::Camera;
use edof_core::noise::{Noise, SensorNoise};
use edof_core::storage::json;
use edof_optics::bound::Light;
use edof_optics::bound::lenses::closed;
use edof_optics::psf;
use edof_study::live::View;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Most stops by which a lens is closed.
pub const MAX_STOPS: f64 = 5.0;

/// A lens that is closed and focused, an object at a depth, and the light.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Name of the picture.
    pub scene: String,
    /// The open lens, as in a camera file.
    pub camera: Camera,
    /// ψ of the object, before the open lens.
    pub psi: f64,
    /// Stops by which the lens is closed.
    pub stops: f64,
    /// The light.
    #[serde(flatten)]
    pub light: PageLight,
    /// Seed of the noise.
    pub seed: u64,
    /// Name of the network; by default one for the lens and the noise.
    pub network: Option<String>,
    /// Layers of the network; by default all.
    pub layers: Option<usize>,
    /// Pixels from patch to patch.
    pub stride: usize,
    /// The clear lens beside it.
    pub clear: ClearLens,
}

/// The light, as [`Light`] has it.
#[derive(Clone, Copy, Deserialize)]
pub struct PageLight {
    /// Electrons of a white pixel behind the open lens.
    pub electrons: f64,
    /// Read noise in electrons.
    pub read_noise_e: f64,
}

/// A clear lens, as the advice has it.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClearLens {
    /// Stops by which it is closed.
    pub stops: f64,
    /// Focus as ψ of the open lens.
    pub focus_psi: f64,
}

/// What the plots of a lens are asked for.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LensState {
    /// The open lens.
    pub camera: Camera,
    /// ψ of the object, before the open lens.
    pub psi: f64,
    /// Stops by which the lens is closed.
    pub stops: f64,
}

/// What advice is asked for.
#[derive(Deserialize)]
pub struct AdviceState {
    /// The open lens; its range of ψ is the scene's.
    pub camera: Camera,
    /// The light.
    #[serde(flatten)]
    pub light: PageLight,
}

/// Reads a state of the page.
///
/// # Errors
/// Text that is none; the field that is wrong.
pub fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Error> {
    let text = std::str::from_utf8(bytes).map_err(|_| Error::message("the request is not UTF-8 text"))?;
    Ok(json::parse(text)?)
}

/// Returns the lens closed by stops, with an object at its ψ of the open lens.
///
/// # Errors
/// A camera that could not be built, stops or a depth out of range.
pub fn view(open: &Camera, stops: f64, psi: f64) -> Result<View, Error> {
    open.check()?;
    all_within("stops", &[stops], 0.0, MAX_STOPS)?;
    let view = View { camera: closed(open, stops), psi: psi * (-stops).exp2() };
    psf::check(&view.camera, view.psi)?;
    Ok(view)
}

impl PageLight {
    /// Returns the light of a scene of mean brightness.
    ///
    /// # Errors
    /// A number out of range.
    pub fn light(self) -> Result<Light, Error> {
        all_within("electrons", &[self.electrons], 1.0, 1e9)?;
        all_within("read_noise_e", &[self.read_noise_e], 0.0, 1e6)?;
        Ok(Light { electrons: self.electrons, read_noise_e: self.read_noise_e, mean: Light::MEAN })
    }

    /// Returns the noise behind a lens closed by stops: the gain is raised until white fills the scale again.
    ///
    /// # Errors
    /// A number out of range.
    pub fn noise(self, stops: f64) -> Result<Noise, Error> {
        let Light { electrons, read_noise_e, .. } = self.light()?;
        let noise =
            Noise::Sensor(SensorNoise { full_well_e: electrons * (-stops).exp2(), read_noise_e, gain: 1.0 });
        noise.check()?;
        Ok(noise)
    }
}
