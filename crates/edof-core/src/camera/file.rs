//! Camera files: the JSON keys of a [`Camera`]. Rings, one profile and one height map have keys of their own, which are older than the
//! list `mask`.

use super::mask::{Aberration, HeightMap, Profile, Ring, Term, Zernike};
use super::psf_bank::PsfBank;
use super::{Camera, Sign, Spectrum};
use serde::{Deserialize, Serialize};

/// The keys of a camera file, in order; [`Camera`] has what they mean.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename = "Camera")]
pub(super) struct CameraFile {
    name: String,
    focal_length_mm: f64,
    aperture_radius_mm: f64,
    pixel_pitch_um: f64,
    spectra: [Spectrum; 3],
    reference_wavelength_nm: f64,
    defocus_sign: Sign,
    focus_psi: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    nominal_m: Option<f64>,
    psi_range: [f64; 2],
    rings: Vec<Ring>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    profile: Option<Profile>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    height_map: Option<HeightMap>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    mask: Vec<Term>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    aberrations: Vec<Aberration>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    psf_bank: Option<PsfBank>,
    source: String,
}

impl From<CameraFile> for Camera {
    fn from(file: CameraFile) -> Self {
        let rings = file.rings.into_iter().map(Term::from);
        let smooth = file.profile.map(Term::from).into_iter().chain(file.height_map.map(Term::from));
        Self {
            name: file.name,
            focal_length_mm: file.focal_length_mm,
            aperture_radius_mm: file.aperture_radius_mm,
            pixel_pitch_um: file.pixel_pitch_um,
            spectra: file.spectra,
            reference_wavelength_nm: file.reference_wavelength_nm,
            defocus_sign: file.defocus_sign,
            focus_psi: file.focus_psi,
            nominal_m: file.nominal_m,
            psi_range: file.psi_range,
            mask: rings.chain(smooth).chain(file.mask).collect(),
            aberrations: Zernike(file.aberrations),
            psf_bank: file.psf_bank,
            source: file.source,
        }
    }
}

impl From<Camera> for CameraFile {
    fn from(camera: Camera) -> Self {
        let (mut rings, mut profile, mut height_map, mut mask) = (vec![], None, None, vec![]);
        for term in camera.mask.into_terms() {
            match term {
                Term::Ring(ring) => rings.push(ring),
                Term::Profile(first) if profile.is_none() => profile = Some(first),
                Term::HeightMap(first) if height_map.is_none() => height_map = Some(first),
                other => mask.push(other),
            }
        }
        Self {
            name: camera.name,
            focal_length_mm: camera.focal_length_mm,
            aperture_radius_mm: camera.aperture_radius_mm,
            pixel_pitch_um: camera.pixel_pitch_um,
            spectra: camera.spectra,
            reference_wavelength_nm: camera.reference_wavelength_nm,
            defocus_sign: camera.defocus_sign,
            focus_psi: camera.focus_psi,
            nominal_m: camera.nominal_m,
            psi_range: camera.psi_range,
            rings,
            profile,
            height_map,
            mask,
            aberrations: camera.aberrations.0,
            psf_bank: camera.psf_bank,
            source: camera.source,
        }
    }
}
