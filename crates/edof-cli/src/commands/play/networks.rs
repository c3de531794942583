//! Networks of the page: those that come with the program, for a lens and a noise, with fewer layers and any stride.

use crate::error::Error;
use crate::said;
use crate::weights::{self, Catalogue};
use edof_core::camera::Camera;
use edof_core::overlap::Overlap;
use edof_core::{Noise, Reconstructor, Tone};
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_network::network::Origin;
use edof_study::live::Recent;
use serde::Serialize;
use std::sync::Arc;

/// Which network, and how it is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Name.
    pub name: String,
    /// Layers; all where none are given.
    pub layers: Option<usize>,
    /// Pixels from patch to patch.
    pub stride: usize,
}

/// A network that is ready.
#[derive(Debug)]
pub struct Ready {
    pub method: FloatReconstructor,
    origin: Origin,
    layers: [usize; 2],
}

/// A network as the page shows it.
#[derive(Serialize)]
pub struct Summary {
    name: String,
    method: String,
    /// Those that are used, and those that it was trained with.
    layers: [usize; 2],
    /// The camera that it was trained for.
    camera: String,
    /// What of its lens differs from this one.
    differs: Vec<String>,
    /// Whether it was trained for so much noise; none where it was trained for other pictures.
    is_noise_known: Option<bool>,
}

/// Networks that come with the program, and those that were used last.
pub struct Networks {
    pub catalogue: Catalogue,
    ready: Recent<Choice, Ready>,
}

impl Networks {
    /// Reads what all were trained for.
    pub fn new() -> Self {
        Self { catalogue: Catalogue::read(), ready: Recent::new(8) }
    }

    /// Returns the name of the network that suits a lens and a noise; where none was trained for the lens, one for clear or coded lenses, whichever it is.
    pub fn name_for(&self, camera: &Camera, noise: Noise) -> String {
        let tone = Tone::Srgb;
        let usual = if camera.is_clear() { weights::clear_for(tone) } else { weights::default_for(tone) };
        let name = self.catalogue.trained_on(camera, &[tone]).unwrap_or(usual);
        let known = self.catalogue.networks().find(|(known, ..)| *known == name);
        known.map_or(name, |usual| self.catalogue.for_noise(usual, tone, noise)).to_owned()
    }

    /// Returns a network that is ready.
    ///
    /// # Errors
    /// No such network, layers that it has not, a stride that there is not.
    pub fn ready(&mut self, choice: Choice) -> Result<Arc<Ready>, Error> {
        self.ready.get(choice, |choice| {
            if !weights::names().contains(&choice.name.as_str()) {
                let names = weights::names().join(", ");
                return Err(Error::message(format!("network '{}': expected one of {names}", choice.name)));
            }
            let network = weights::float(&choice.name)?;
            let (trained, origin) = (network.form.layers, network.origin.clone());
            let layers = choice.layers.unwrap_or(trained);
            let stride = said::stride(choice.stride)?;
            let method =
                FloatReconstructor::new(network.with_layers(layers)?, stride, Overlap::Hann, Output::Rgb)?;
            Ok(Ready { method, origin, layers: [layers, trained] })
        })
    }
}

impl Ready {
    /// Returns the network as the page shows it behind a lens in a noise.
    pub fn summary(&self, camera: &Camera, noise: Noise) -> Summary {
        let Self { method, origin, layers } = self;
        Summary {
            name: origin.name.clone(),
            method: method.name().to_owned(),
            layers: *layers,
            camera: origin.camera.name.clone(),
            differs: origin.camera.differences(camera),
            is_noise_known: origin.fit(Tone::Srgb, noise).map(edof_network::fit::Fit::is_inside),
        }
    }
}
