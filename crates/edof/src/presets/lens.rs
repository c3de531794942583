//! A camera by name or file, with every file that it names, an optional PSF bank in place of its computed PSFs, and object depths as ψ or
//! metres.

use crate::presets::PresetError;
use edof_core::camera::Camera;
use edof_core::camera::PsfBank;
use edof_core::words::number;
use edof_io::photo;
use edof_optics::bank;
use edof_optics::psf::{self, NoPsf};
use edof_optics::psi_at;
use std::fmt;
use std::path::{Path, PathBuf};

/// The camera that is meant where none is named: the lens that `edof optics advise` names for photographs in the light of a sensor, which has no mask.
pub const DEFAULT: &str = "clear-closed";

/// A camera and the files that it was read from.
#[derive(Debug, Clone)]
pub struct Lens {
    /// The camera, its bank and its mask's picture read.
    pub camera: Camera,
    /// Files of the camera, of its mask and of its PSFs.
    pub files: Vec<PathBuf>,
}

/// A file of PSFs that takes the place of a camera's.
#[derive(Debug, Clone, Copy)]
pub struct BankFile<'a> {
    /// The file.
    pub path: &'a Path,
    /// Whether its kernels are shifted to the middle pixel (`edof_core::camera::Kernels::centred`).
    pub centre: bool,
}

/// A camera by name or file; `bank` takes the place of the PSFs that it has. Its range of ψ ends where its bank does.
///
/// # Errors
/// No such camera, or PSFs that cannot be used.
pub fn resolve(name: &str, bank: Option<BankFile>) -> Result<Lens, PresetError> {
    let mut files = vec![PathBuf::from(name)];
    let mut camera = self::camera(name)?;
    files.extend(camera.mask.height_maps().map(|map| folder(Path::new(name)).join(&map.file)));
    if let Some(own) = &camera.psf_bank {
        files.push(folder(Path::new(name)).join(&own.file));
    }
    if let Some(BankFile { path, centre }) = bank {
        files.push(path.to_owned());
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut own = PsfBank { file, sha256: String::new(), centre, kernels: None };
        own.read(folder(path), &camera.name, camera.pixel_pitch_um)?;
        camera.psf_bank = Some(own);
    }
    if let Some(own) = camera.psf_bank.take() {
        camera = with_bank(camera, own);
    }
    Ok(Lens { camera, files })
}

/// A camera with a bank in place of its PSFs. Its range of ψ ends where the bank does.
#[must_use]
pub fn with_bank(mut camera: Camera, own: PsfBank) -> Camera {
    if let Some(kernels) = &own.kernels {
        let [low, high] = bank::ends(kernels);
        camera.psi_range = camera.psi_range.map(|psi| psi.clamp(low, high));
    }
    camera.psf_bank = Some(own);
    camera
}

/// A camera by name or file, with its PSF bank and the picture of its mask.
///
/// # Errors
/// No such camera, or a file that it names and that cannot be used.
pub fn camera(name: &str) -> Result<Camera, PresetError> {
    let mut camera = Camera::resolve(name)?;
    let of_file = |e| PresetError::File { file: name.to_owned(), source: Box::new(e) };
    read_mask(&mut camera, folder(Path::new(name))).map_err(of_file)?;
    Ok(camera)
}

/// Reads the pictures of a camera's mask, if it has any, from a folder.
///
/// # Errors
/// No picture, or none that the camera means.
pub fn read_mask(camera: &mut Camera, folder: &Path) -> Result<(), PresetError> {
    for map in camera.mask.height_maps_mut() {
        let path = folder.join(&map.file);
        map.take(photo::load_grey(&path)?, path, &camera.name)?;
    }
    Ok(())
}

/// How to come by a network for a camera.
#[must_use]
pub fn how_to_train(camera: &Camera) -> String {
    let bank = camera.psf_bank.as_ref().map_or_else(String::new, |bank| {
        format!(" --psf-bank {}{}", bank.file, if bank.centre { " --centre" } else { "" })
    });
    let plain = Camera { psf_bank: None, ..camera.clone() };
    let focus_psi = camera.focus_psi;
    match Camera::resolve(&camera.name) {
        Ok(preset) if preset.same_lens(&plain) => {
            format!("train one by 'edof train --camera {}{bank}'", camera.name)
        }
        Ok(preset) if (Camera { focus_psi, ..preset.clone() }).same_lens(&plain) => {
            format!("train one by 'edof train --camera {} --focus {focus_psi}'", camera.name)
        }
        _ => format!("train one by 'edof train --camera FILE' with the file of the camera {}", camera.name),
    }
}

fn folder(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// Distance of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Depth {
    /// The defocus parameter in radians.
    Psi(f64),
    /// A distance.
    Metres(f64),
}

impl std::str::FromStr for Depth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let depth = match text.strip_suffix('m') {
            Some(metres) => metres.parse().ok().filter(|m| *m > 0.0).map(Self::Metres),
            None => text.parse().ok().filter(|psi: &f64| psi.is_finite()).map(Self::Psi),
        };
        depth.ok_or_else(|| {
            format!("depth '{text}': must be a psi such as 4, or a distance such as 1.5m or infm")
        })
    }
}

impl fmt::Display for Depth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Psi(psi) => write!(f, "{psi}"),
            Self::Metres(metres) => write!(f, "{metres}m"),
        }
    }
}

impl Depth {
    /// As it was given, in few digits.
    pub fn in_words(self) -> String {
        match self {
            Self::Psi(psi) => number(psi),
            Self::Metres(metres) => format!("{}m", number(metres)),
        }
    }

    /// ψ before a camera.
    ///
    /// # Errors
    /// A distance before a camera that does not know where ψ is zero.
    pub fn psi(self, camera: &Camera) -> Result<f64, PresetError> {
        match (self, camera.nominal_m) {
            (Self::Psi(psi), _) => Ok(psi),
            (Self::Metres(metres), Some(nominal)) => Ok(psi_at(camera, metres, nominal)),
            (Self::Metres(metres), None) => {
                Err(PresetError::NoNominal { metres, camera: camera.name.clone() })
            }
        }
    }
}

/// ψ of several depths before a camera.
///
/// # Errors
/// As [`Depth::psi`].
pub fn psis(depths: &[Depth], camera: &Camera) -> Result<Vec<f64>, PresetError> {
    depths.iter().map(|depth| depth.psi(camera)).collect()
}

/// Two depths, as in `8:0` or `0.7m:3m`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthRange {
    /// As the first is given.
    pub near: Depth,
    /// As the second is given.
    pub far: Depth,
}

impl std::str::FromStr for DepthRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (near, far) = text.split_once(':').ok_or_else(|| {
            format!("range '{text}': must be two depths with a colon between, as in 8:0 or 0.7m:3m")
        })?;
        Ok(Self { near: near.parse()?, far: far.parse()? })
    }
}

impl fmt::Display for DepthRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.near, self.far)
    }
}

impl DepthRange {
    /// Least and greatest ψ before a camera.
    ///
    /// # Errors
    /// As [`Depth::psi`].
    pub fn psi(self, camera: &Camera) -> Result<[f64; 2], PresetError> {
        let [near, far] = self.ends(camera)?;
        Ok([near.min(far), near.max(far)])
    }

    /// ψ of its nearer and its farther end before a camera that has PSFs there.
    ///
    /// # Errors
    /// As [`Depth::psi`], or an end where the camera has no PSFs.
    pub fn ends(self, camera: &Camera) -> Result<[f64; 2], PresetError> {
        let given = || format!("{}:{}", self.near.in_words(), self.far.in_words());
        let ends = [self.near.psi(camera)?, self.far.psi(camera)?];
        let check = |psi: f64| psf::check(camera, psi);
        ends.into_iter().try_for_each(check).map_err(|e| match e {
            NoPsf::Missing { .. } | NoPsf::NoMask { .. } => e.into(),
            source => PresetError::Range { range: given(), source },
        })?;
        Ok(ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_psi_or_metres() {
        assert_eq!("4".parse(), Ok(Depth::Psi(4.0)));
        assert_eq!("-0.5".parse(), Ok(Depth::Psi(-0.5)));
        assert_eq!("1.5m".parse(), Ok(Depth::Metres(1.5)));
        assert_eq!("infm".parse(), Ok(Depth::Metres(f64::INFINITY)));
        for text in ["", "m", "-1m", "0m", "nanm", "nan", "inf", "near", "4 m"] {
            assert!(text.parse::<Depth>().unwrap_err().contains("must be a psi such as 4"), "{text}");
        }
        assert_eq!("8:0".parse(), Ok(DepthRange { near: Depth::Psi(8.0), far: Depth::Psi(0.0) }));
        assert!("8".parse::<DepthRange>().is_err() && "8:x".parse::<DepthRange>().is_err());
    }

    #[test]
    fn a_distance_needs_to_know_where_psi_is_zero() {
        let mut camera = Camera::resolve("ring-2018").unwrap();
        assert!(Depth::Metres(1.5).psi(&camera).unwrap_err().to_string().contains("--nominal"));
        camera.nominal_m = Some(10.0);
        assert!(Depth::Metres(10.0).psi(&camera).unwrap().abs() < 1e-12);
        assert!((Depth::Metres(3.1109).psi(&camera).unwrap() - 8.0).abs() < 1e-3);
        let range: DepthRange = "3.1109m:infm".parse().unwrap();
        assert_eq!(range.to_string(), "3.1109m:infm");
        let [low, high] = range.psi(&camera).unwrap();
        assert!(low < 0.0 && (high - 8.0).abs() < 1e-3, "{low} to {high}");
    }
}
