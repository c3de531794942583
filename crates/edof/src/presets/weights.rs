//! Networks by name or by file. `edof-t4w12` stands for `edof-t4w12.safetensors` (float) and
//! `edof-t4w12.fixed.safetensors` (fixed).
//!
//! Looked for in this order: a file of exactly that path; `weights/` in the working directory; the networks that were
//! under `weights/` when the program was built and travel inside it. So the networks that come with the program are found
//! from every directory, and a newly trained one takes precedence where it lies.

use crate::presets::{PresetError, lens};
use edof_core::camera::Camera;
use edof_core::colour::OUTPUTS_422;
use edof_core::storage::input;
use edof_core::storage::provenance::{Input, InputKind};
use edof_core::{Noise, Tone};
use edof_network::fit::best_fit;
use edof_network::network::{Form, Origin};
use edof_network::{FixedNetwork, Network, form, weight_file};
use std::path::{Path, PathBuf};

/// File name and bytes of the networks inside the program.
const EMBEDDED: &[(&str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/embedded.rs"));

/// Loads a float network by name or file.
///
/// # Errors
/// Nothing of that name, or a file that holds no usable float network.
pub fn float(name_or_path: &str) -> Result<Network, PresetError> {
    let (origin, bytes) = find(name_or_path, ".safetensors")?;
    let mut network = weight_file::parse_network(bytes, &origin)?;
    find_bank(&mut network.origin.camera, &origin);
    Ok(network)
}

/// Loads a fixed network by name or file.
///
/// # Errors
/// Nothing of that name, or a file that holds no usable fixed network.
pub fn fixed(name_or_path: &str) -> Result<FixedNetwork, PresetError> {
    let (origin, bytes) = find(name_or_path, ".fixed.safetensors")?;
    let mut network = weight_file::parse_fixed(bytes, &origin)?;
    find_bank(&mut network.origin.camera, &origin);
    Ok(network)
}

/// Reads the PSFs or the mask's surface of a network's camera, from beside the network or from the working directory. If they are in neither, the error names both places ([`edof_optics::psf::NoPsf`]); a network can be run without.
fn find_bank(camera: &mut Camera, network: &Path) {
    let folders = [network.parent().unwrap_or(Path::new("")), Path::new("")];
    let _ = folders.into_iter().find(|folder| camera.read_bank(folder).is_ok());
    let _ = folders.into_iter().find(|folder| lens::read_mask(camera, folder).is_ok());
}

/// A float network's file as an input, with the hash that [`FixedNetwork::float_hash`] states.
///
/// # Errors
/// As [`float`].
pub fn float_input(name_or_path: &str) -> Result<Input, PresetError> {
    input(name_or_path, ".safetensors")
}

/// A fixed network's file as an input.
///
/// # Errors
/// As [`fixed`].
pub fn fixed_input(name_or_path: &str) -> Result<Input, PresetError> {
    input(name_or_path, ".fixed.safetensors")
}

fn input(name_or_path: &str, suffix: &str) -> Result<Input, PresetError> {
    let (origin, bytes) = find(name_or_path, suffix)?;
    let sha256 = weight_file::parse_hash(bytes, &origin)?;
    let name = origin.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Input { kind: InputKind::Weights, name, sha256 })
}

/// The default network, behind the coded lens: one serves photographs taken for light, one light that is looked at encoded
/// (docs/decisions/0005-training.md: no network serves both).
#[must_use]
pub const fn default_for(tone: Tone) -> &'static str {
    match tone {
        Tone::Linear => "edof-t4w12-outer",
        Tone::Srgb => "edof-t4w12-outer-light",
    }
}

/// The network behind the clear lens focused mid-range, by the recipe of [`default_for`]'s.
#[must_use]
pub const fn clear_for(tone: Tone) -> &'static str {
    match tone {
        Tone::Linear => "edof-t4w12-clear",
        Tone::Srgb => "edof-t4w12-clear-light",
    }
}

/// The network behind the clear lens at the stop that is advised for photographs in the light of a sensor; where a tone has none, that of [`clear_for`].
#[must_use]
pub const fn best_clear_for(tone: Tone) -> &'static str {
    match tone {
        Tone::Linear => clear_for(tone),
        Tone::Srgb => "edof-t4w12-closed-light",
    }
}

/// Of the networks that come with the program for the same lens, tone and form as `name`, the one whose range of noise suits a noise best:
/// `name` itself unless another suits it better ([`edof_network::Fit`]).
#[must_use]
pub fn for_noise(name: &str, tone: Tone, noise: Noise) -> &str {
    let Ok(usual) = float(name) else { return name };
    Catalogue::read().for_noise((name, &usual.form, &usual.origin), tone, noise)
}

/// A network that comes with the program and was trained for a camera's lens, for `tone` if there is one; of several, the one for most
/// noises, of those the largest.
#[must_use]
pub fn trained_for(camera: &Camera, tone: Tone) -> Option<&'static str> {
    let catalogue = Catalogue::read();
    catalogue.trained_on(camera, &[tone]).or_else(|| catalogue.trained_on(camera, &Tone::ALL))
}

/// A network that comes with the program and was trained for a camera's lens on pictures of a tone.
#[must_use]
pub fn trained_on(camera: &Camera, tone: Tone) -> Option<&'static str> {
    Catalogue::read().trained_on(camera, &[tone])
}

/// What the networks that come with the program were trained for, read once: for anybody who asks often.
#[derive(Debug)]
pub struct Catalogue(Vec<(&'static str, Form, Origin)>);

impl Catalogue {
    /// Reads all networks.
    #[must_use]
    pub fn read() -> Self {
        let read = |name| float(name).ok().map(|network| (name, network.form, network.origin));
        Self(names().into_iter().filter_map(read).collect())
    }

    /// As [`for_noise`], of a network that may be another one's.
    #[must_use]
    pub fn for_noise<'a>(
        &self,
        (name, form, usual): (&'a str, &Form, &Origin),
        tone: Tone,
        noise: Noise,
    ) -> &'a str {
        let others = self.0.iter().filter_map(|(other, own, origin)| {
            let fits = own == form && origin.camera.same_lens(&usual.camera);
            fits.then(|| origin.fit(tone, noise)).flatten().map(|fit| (*other, fit))
        });
        let own = usual.fit(tone, noise).map(|fit| (name, fit));
        best_fit(own.into_iter().chain(others)).map_or(name, |(name, _)| name)
    }

    /// A network that was trained for a camera's lens on pictures of one of these tones; of several, the one for most noises, of those the largest.
    #[must_use]
    pub fn trained_on(&self, camera: &Camera, tones: &[Tone]) -> Option<&'static str> {
        let fitting = self.0.iter().filter_map(|(name, form, origin)| {
            let condition = origin.conditions.iter().find(|condition| tones.contains(&condition.tone))?;
            let rank = (condition.width(), form.dense_multiplications(OUTPUTS_422));
            origin.camera.same_lens(camera).then_some((*name, rank))
        });
        fitting.reduce(|best, other| if other.1 > best.1 { other } else { best }).map(|(name, _)| name)
    }

    /// Name, form and origin of each network.
    pub fn networks(&self) -> impl Iterator<Item = (&'static str, &Form, &Origin)> {
        self.0.iter().map(|(name, form, origin)| (*name, form, origin))
    }
}

/// The file that [`float`] reads, where the network is not inside the program.
#[must_use]
pub fn float_file(name_or_path: &str) -> Option<PathBuf> {
    places(name_or_path, ".safetensors").into_iter().find(|path| input::is_file(path))
}

/// The file that [`fixed`] reads, where the network is not inside the program.
#[must_use]
pub fn fixed_file(name_or_path: &str) -> Option<PathBuf> {
    places(name_or_path, ".fixed.safetensors").into_iter().find(|path| input::is_file(path))
}

/// What network a file holds, for anybody who must not lose it.
#[must_use]
pub fn in_words(file: &Path) -> Option<String> {
    let bytes = input::read(file).ok()?;
    let float = weight_file::parse_network(bytes.clone(), file).map(|network| (network.form, network.origin));
    let fixed = || weight_file::parse_fixed(bytes, file).map(|network| (network.form, network.origin));
    let (form, origin) = float.or_else(|_| fixed()).ok()?;
    let trained = match origin.patches {
        0 => "untrained".to_owned(),
        _ => format!("{:.2} dB on validation", origin.validation_db),
    };
    Some(format!("the network {} ({}), {trained}", origin.name, form::words(&form)))
}

/// Where a network may lie: a file of that name, or one under `weights/`, where a name without an ending gets one.
fn places(name_or_path: &str, suffix: &str) -> [PathBuf; 2] {
    let ending = if name_or_path.ends_with(".safetensors") { "" } else { suffix };
    [name_or_path.into(), Path::new("weights").join(format!("{name_or_path}{ending}"))]
}

fn find(name_or_path: &str, suffix: &str) -> Result<(PathBuf, Vec<u8>), PresetError> {
    let places = places(name_or_path, suffix);
    if let Some(path) = places.iter().find(|path| input::is_file(path)) {
        let bytes = input::read(path)
            .map_err(|source| weight_file::WeightFileError::Read { path: path.clone(), source })?;
        return Ok((path.clone(), bytes));
    }
    let file = format!("{name_or_path}{suffix}");
    if let Some((name, bytes)) = EMBEDDED.iter().find(|(name, _)| *name == file) {
        return Ok((PathBuf::from(name), bytes.to_vec()));
    }
    let [named, under] = places;
    // A pipe, a device or the like.
    if named.exists() && !named.is_dir() {
        input::check(&named)
            .map_err(|source| weight_file::WeightFileError::Read { path: named.clone(), source })?;
    }
    Err(PresetError::NoWeights { name: name_or_path.into(), under, own: in_short() })
}

/// Names of the networks inside the program, without those for one class of noise.
fn in_short() -> String {
    let is_class = |name: &str| ["-low", "-mid", "-high", "-dark"].iter().any(|class| name.ends_with(class));
    let general: Vec<&str> = names().into_iter().filter(|name| !is_class(name)).collect();
    format!("{}, and their classes of noise", general.join(", "))
}

/// Names of the networks inside the program.
#[must_use]
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = EMBEDDED.iter().filter_map(|(file, _)| file.split('.').next()).collect();
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_networks_are_kept_at_the_noise_that_no_narrower_range_holds() {
        for tone in Tone::ALL {
            let usual = default_for(tone);
            let own = float(usual).unwrap().origin;
            for noise in [Noise::None, Noise::gaussian(0.01), Noise::sensor(1.0), Noise::sensor(4.0)] {
                let chosen = for_noise(usual, tone, noise);
                let fit = float(chosen).unwrap().origin.fit(tone, noise).unwrap();
                assert!(fit.is_inside() && fit <= own.fit(tone, noise).unwrap(), "{tone} {noise}: {chosen}");
                assert!(
                    chosen == usual || chosen.starts_with(&format!("{usual}-")),
                    "{tone} {noise}: {chosen}"
                );
            }
        }
    }

    #[test]
    fn what_is_suggested_for_a_lens_is_no_network_of_one_class_of_noise() {
        for tone in Tone::ALL {
            for name in [default_for(tone), clear_for(tone)] {
                let camera = float(name).unwrap().origin.camera;
                assert_eq!(trained_for(&camera, tone), Some(name));
            }
        }
    }
}
