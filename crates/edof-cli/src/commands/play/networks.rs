//! Networks of the page: those that come with the program and those that it trained, for a lens and a noise, with fewer layers and any stride.

use crate::error::Error;
use crate::said;
use crate::weights::{self, Catalogue};
use edof_core::camera::Camera;
use edof_core::overlap::Overlap;
use edof_core::{Noise, Reconstructor, Tone};
use edof_network::fit::{Fit, best_fit};
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_network::network::{Form, Network, Origin};
use edof_network::weight_file;
use edof_study::live::Recent;
use serde::Serialize;
use std::path::Path;
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
    weights: String,
}

/// A network as the page shows it.
#[derive(Serialize)]
pub struct Summary {
    name: String,
    /// What `--weights` of the commands is given: its name, or the file that the page saves.
    weights: String,
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

/// Networks that come with the program, those that the page trained, and those that were used last.
pub struct Networks {
    catalogue: Catalogue,
    trained: Vec<Network>,
    ready: Recent<Choice, Ready>,
}

/// What an own network's file is called.
pub fn file_name(name: &str) -> String {
    format!("{name}.safetensors")
}

impl Networks {
    /// Reads what all were trained for.
    pub fn new() -> Self {
        Self { catalogue: Catalogue::read(), trained: vec![], ready: Recent::new(8) }
    }

    /// What all networks are, those that the page trained last.
    pub fn all<'a>(&'a self) -> impl Iterator<Item = (&'a str, &'a Form, &'a Origin)> {
        let own = |own: &'a Network| (own.origin.name.as_str(), &own.form, &own.origin);
        let program = self.catalogue.networks().map(|(name, form, origin)| {
            let name: &'a str = name;
            (name, form, origin)
        });
        program.chain(self.trained.iter().map(own))
    }

    /// Takes a network that the page trained; its name is a new one.
    pub fn take(&mut self, network: Network) {
        self.trained.push(network);
    }

    /// Returns a network that the page trained.
    fn own(&self, name: &str) -> Option<&Network> {
        self.trained.iter().find(|own| own.origin.name == name)
    }

    /// Returns the file of a network that the page trained.
    ///
    /// # Errors
    /// No such network.
    pub fn file(&self, file: &str) -> Result<Vec<u8>, Error> {
        let own = self.trained.iter().find(|own| file_name(&own.origin.name) == file);
        let own = own.ok_or_else(|| Error::message(format!("{file}: no network that this page trained")))?;
        Ok(weight_file::network_bytes(Path::new(file), own)?)
    }

    /// Returns the network of the program from which a training for a lens begins: the one that is looked through, if it takes such pictures.
    ///
    /// # Errors
    /// A network that cannot be read.
    pub fn beginning(&self, chosen: Option<&str>, camera: &Camera, noise: Noise) -> Result<Network, Error> {
        let is_fit = |name: &&str| {
            let found = self.catalogue.networks().find(|(known, ..)| known == name);
            found.is_some_and(|(_, form, origin)| origin.values == Tone::Srgb && form.exposures == 1)
        };
        let usual = || self.of_program(camera, noise);
        Ok(weights::float(chosen.filter(is_fit).unwrap_or_else(usual))?)
    }

    /// Returns the name of the network that suits a lens and a noise: the page's own one for the lens if there is one, for other noise only where the program
    /// has none for the lens.
    pub fn name_for(&self, camera: &Camera, noise: Noise) -> String {
        let own = self.trained.iter().rev().filter(|own| own.origin.camera.same_lens(camera));
        let own = own.filter_map(|own| Some((own.origin.name.as_str(), own.origin.fit(Tone::Srgb, noise)?)));
        let is_first = |(_, fit): &(&str, Fit)| {
            fit.is_inside() || self.catalogue.trained_on(camera, &[Tone::Srgb]).is_none()
        };
        let own = best_fit(own).filter(is_first);
        own.map_or_else(|| self.of_program(camera, noise), |(name, _)| name).to_owned()
    }

    /// Of the program's networks; where none was trained for the lens, one for clear or coded lenses, whichever it is.
    fn of_program(&self, camera: &Camera, noise: Noise) -> &str {
        let tone = Tone::Srgb;
        let usual = if camera.is_clear() { weights::clear_for(tone) } else { weights::default_for(tone) };
        let name = self.catalogue.trained_on(camera, &[tone]).unwrap_or(usual);
        let known = self.catalogue.networks().find(|(known, ..)| *known == name);
        known.map_or(name, |usual| self.catalogue.for_noise(usual, tone, noise))
    }

    /// Returns a network that is ready.
    ///
    /// # Errors
    /// No such network, layers that it has not, a stride that there is not.
    pub fn ready(&mut self, choice: Choice) -> Result<Arc<Ready>, Error> {
        if let Some(ready) = self.ready.find(&choice) {
            return Ok(ready);
        }
        let (network, weights) = match self.own(&choice.name) {
            Some(own) => (own.clone(), file_name(&choice.name)),
            None if weights::names().contains(&choice.name.as_str()) => {
                (weights::float(&choice.name)?, choice.name.clone())
            }
            None => {
                let names: Vec<&str> = self.all().map(|(name, ..)| name).collect();
                let names = names.join(", ");
                return Err(Error::message(format!("network '{}': expected one of {names}", choice.name)));
            }
        };
        let (trained, origin) = (network.form.layers, network.origin.clone());
        let layers = choice.layers.unwrap_or(trained);
        let stride = said::stride(choice.stride)?;
        let method =
            FloatReconstructor::new(network.with_layers(layers)?, stride, Overlap::Hann, Output::Rgb)?;
        Ok(self.ready.keep(choice, Ready { method, origin, layers: [layers, trained], weights }))
    }
}

impl Ready {
    /// Returns the network as the page shows it behind a lens in a noise.
    pub fn summary(&self, camera: &Camera, noise: Noise) -> Summary {
        let Self { method, origin, layers, weights } = self;
        Summary {
            name: origin.name.clone(),
            weights: weights.clone(),
            method: method.name().to_owned(),
            layers: *layers,
            camera: origin.camera.name.clone(),
            differs: origin.camera.differences(camera),
            is_noise_known: origin.fit(Tone::Srgb, noise).map(Fit::is_inside),
        }
    }
}
