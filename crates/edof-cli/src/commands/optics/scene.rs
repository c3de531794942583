//! A lens, ranges of depth and a light, as options that `edof optics bound` and `edof optics advise` share.

use super::statistics;
use crate::error::Error;
use crate::files::Files;
use crate::lens::{self, Depth, DepthRange, Lens};
use crate::limits::all_within;
use crate::ui::Ui;
use edof_core::camera::{Camera, Spectrum};
use edof_optics::Statistics;
use edof_optics::bound::Light;
use edof_optics::psi_at;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct Scene {
    /// Camera: a preset (clear, clear-mid, clear-closed, ring-2015, ring-2018, ring-depth-2018, ring-outer) or a JSON file; its mask is judged, too [default:
    /// clear-mid, a lens without a mask]
    #[arg(value_name = "CAMERA")]
    camera: Option<String>,

    /// The camera, as other commands name it
    #[arg(long = "camera", value_name = "CAMERA", conflicts_with = "camera")]
    camera_option: Option<String>,

    /// Diameter of the open aperture in millimetres [default: the camera's]
    #[arg(long, value_name = "MM")]
    aperture_mm: Option<f64>,

    /// Focal length divided by the diameter of the open aperture, in place of --aperture-mm
    #[arg(long, value_name = "N", conflicts_with = "aperture_mm")]
    f_number: Option<f64>,

    /// Focal length in millimetres [default: the camera's]
    #[arg(long, value_name = "MM")]
    focal_mm: Option<f64>,

    /// Distance between pixels in micrometres [default: the camera's]
    #[arg(long, value_name = "UM")]
    pixel_um: Option<f64>,

    /// Wavelengths of red, green and blue in nanometres [default: the camera's spectra]
    #[arg(long, value_delimiter = ',', num_args = 1, value_name = "R,G,B")]
    wavelengths: Vec<f64>,

    /// Read noise of the sensor in electrons, standard deviation
    #[arg(long, default_value_t = 2.5, value_name = "E")]
    read_noise: f64,

    /// Mean light of the scene, at which photon noise is taken; 1 is white
    #[arg(long, default_value_t = Light::MEAN, value_name = "LIGHT")]
    mean_light: f64,

    /// Folder of photographs to take statistics from [default: a built-in model of natural pictures]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
}

impl Scene {
    /// The camera's preset or file.
    fn named(&self) -> &str {
        self.camera.as_deref().or(self.camera_option.as_deref()).unwrap_or("clear-mid")
    }

    /// Files that are read.
    pub fn reads(&self, files: Files) -> Files {
        let files = files.reads(self.named());
        self.images.iter().fold(files, Files::reads_pictures_of)
    }

    /// The camera with the stated lens and sensor. Its range of ψ stays as it is.
    ///
    /// # Errors
    /// An unknown camera, or a number out of range.
    pub fn camera(&self, ui: &Ui) -> Result<Camera, Error> {
        let Lens { mut camera, .. } = lens::resolve(self.named(), None)?;
        ui.used(camera.input());
        for (option, value) in [
            ("--aperture-mm", self.aperture_mm),
            ("--f-number", self.f_number),
            ("--focal-mm", self.focal_mm),
            ("--pixel-um", self.pixel_um),
        ] {
            all_within(option, &value.into_iter().collect::<Vec<_>>(), 1e-3, 1e4)?;
        }
        camera.aperture_radius_mm = self.aperture_mm.map_or(camera.aperture_radius_mm, |mm| 0.5 * mm);
        camera.focal_length_mm = self.focal_mm.unwrap_or(camera.focal_length_mm);
        if let Some(number) = self.f_number {
            camera.aperture_radius_mm = 0.5 * camera.focal_length_mm / number;
        }
        camera.pixel_pitch_um = self.pixel_um.unwrap_or(camera.pixel_pitch_um);
        match self.wavelengths[..] {
            [] => {}
            [r, g, b] => camera.spectra = [r, g, b].map(Spectrum::Line),
            _ => {
                return Err(Error::message(format!(
                    "--wavelengths: {} given, expected three, as in 610,535,460",
                    self.wavelengths.len()
                )));
            }
        }
        camera.check()?;
        Ok(camera)
    }

    /// A light of the scene.
    ///
    /// # Errors
    /// A number out of range.
    pub fn light(&self, electrons: f64) -> Result<Light, Error> {
        all_within("--electrons", &[electrons], 1.0, 1e9)?;
        all_within("--read-noise", &[self.read_noise], 0.0, 1e6)?;
        all_within("--mean-light", &[self.mean_light], 0.0, 1.0)?;
        Ok(Light { electrons, read_noise_e: self.read_noise, mean: self.mean_light })
    }

    /// Statistics of the photographs.
    ///
    /// # Errors
    /// A folder without any.
    pub fn statistics(&self, ui: &Ui) -> Result<Statistics, Error> {
        self.images.as_ref().map_or_else(|| Ok(Statistics::natural()), |folder| statistics(folder, ui))
    }
}

/// The camera with a range of depths of its own. The far end of a range in metres has ψ = 0, unless the camera states where that is.
///
/// # Errors
/// A range without a width, or of ψ and metres.
pub fn with_range(camera: &Camera, range: Option<DepthRange>) -> Result<Camera, Error> {
    let mut camera = camera.clone();
    if let Some(DepthRange { near, far }) = range {
        let given = format!("--range {}:{}", near.in_words(), far.in_words());
        let [a, b] = match [near, far] {
            [Depth::Metres(a), Depth::Metres(b)] => {
                let nominal = camera.nominal_m.unwrap_or(a.max(b));
                camera.nominal_m = Some(nominal).filter(|m| m.is_finite());
                [a, b].map(|m| psi_at(&camera, m, nominal))
            }
            [Depth::Psi(a), Depth::Psi(b)] => [a, b],
            _ => {
                return Err(Error::message(format!("{given}: a psi and a distance, expected two of a kind")));
            }
        };
        camera.psi_range = [a.min(b), a.max(b)];
        if camera.psi_range[1] - camera.psi_range[0] < 0.01 {
            return Err(Error::message(format!("{given}: has no width, expected two different depths")));
        }
        camera.check().map_err(|e| Error::message(format!("{given}: {e}")))?;
    }
    Ok(camera)
}
