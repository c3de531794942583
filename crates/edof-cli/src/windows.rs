//! Windows of a picture as a network's own camera sees it: what the hardware is fed with in trials and estimates.

use crate::error::Error;
use crate::lens::Depth;
use crate::pictures::{self, Tones};
use crate::said;
use crate::ui::Ui;
use edof_core::storage::provenance::Input;
use edof_core::{Noise, RawFrame, Tone};
use edof_network::FixedNetwork;
use edof_optics::Scene;
use edof_optics::Sensor;
use edof_optics::capture::{Approximation, capture};
use edof_optics::draw::{Builtin, draw};
use std::path::PathBuf;

/// Size of the built-in scene: 1536 patches at stride 8.
const SCENE_SIZE: (usize, usize) = (256, 384);

/// A picture behind a network's own camera.
#[derive(Debug, Clone, Default)]
pub struct Shot {
    /// A photograph; without it, a built-in scene of dead leaves.
    pub photo: Option<PathBuf>,
    /// Depth of the scene; without it, the far end of the network's range, where blur is hardest.
    pub psi: Option<Depth>,
    /// Noise; without it, the most of the first condition that the network was trained for.
    pub noise: Option<Noise>,
    pub seed: u64,
}

impl Shot {
    /// Every photograph (or the built-in scene) at every depth (or the usual one).
    pub fn all(photos: &[PathBuf], psis: &[Depth], noise: Option<Noise>) -> Vec<Self> {
        let or_usual = |depths: Vec<Option<Depth>>| if depths.is_empty() { vec![None] } else { depths };
        let psis = or_usual(psis.iter().copied().map(Some).collect());
        let at_depths = |photo: Option<&PathBuf>| {
            let shot = |psi: &Option<Depth>| Self { photo: photo.cloned(), psi: *psi, noise, seed: 0 };
            psis.iter().map(shot).collect::<Vec<_>>()
        };
        if photos.is_empty() {
            at_depths(None)
        } else {
            photos.iter().map(Some).flat_map(at_depths).collect()
        }
    }

    /// What results call it, at the depth where it is.
    ///
    /// # Errors
    /// As [`Depth::psi`].
    pub fn name(&self, network: &FixedNetwork) -> Result<String, Error> {
        let photo =
            self.photo.as_ref().map_or_else(|| "dead leaves".into(), |path| path.display().to_string());
        Ok(format!("{photo} at psi {}", self.depth(network)?))
    }

    fn depth(&self, network: &FixedNetwork) -> Result<f64, Error> {
        let camera = &network.origin.camera;
        self.psi.map_or(Ok(camera.psi_range[1]), |depth| Ok(said::psis(&[depth], camera)?[0]))
    }

    /// A failure of the picture, by its file's name where it has one.
    pub fn failed(&self, error: impl std::fmt::Display) -> Error {
        match &self.photo {
            Some(photo) => said::of_file(photo, error),
            None => Error::message(error.to_string()),
        }
    }

    /// The raw frame, in the network's values, as a camera sends it to the board.
    ///
    /// # Errors
    /// As [`Shot::taken`].
    pub fn frame(&self, network: &FixedNetwork, ui: &Ui) -> Result<RawFrame, Error> {
        Ok(self.taken(network, ui)?.1.encoded(network.origin.values).into_owned())
    }

    /// What is seen, with the [`tone`] of the network, and the raw frame of it.
    ///
    /// # Errors
    /// A photograph that cannot be read or used, a depth that is out of the lens model's reach or of no known ψ.
    pub fn taken(&self, network: &FixedNetwork, ui: &Ui) -> Result<(Scene, RawFrame), Error> {
        let (camera, psi) = (&network.origin.camera, self.depth(network)?);
        let scene = match &self.photo {
            Some(path) => {
                let tones = Tones { given: None, usual: tone(network) };
                let (photograph, tone) = pictures::load(path, tones, ui)?;
                let name = path.display().to_string();
                ui.used(Input::photograph(&name, &photograph));
                Scene::flat(name, tone.into_decoded(photograph), psi)
            }
            None => draw(Builtin::Leaves, SCENE_SIZE.0, SCENE_SIZE.1, &[psi], self.seed)?,
        };
        let noise = self.noise.unwrap_or_else(|| network.origin.max_noise());
        let sensor = Sensor { noise, seed: self.seed, ..Sensor::default() };
        let taken = capture(&scene, camera, &sensor, &Approximation::default());
        let raw = taken.map_err(|e| self.failed(e))?.raw;
        Ok((scene, raw))
    }
}

/// The tone of the first condition that a network was trained for.
pub fn tone(network: &FixedNetwork) -> Tone {
    network.origin.conditions.first().map_or(Tone::Linear, |condition| condition.tone)
}
