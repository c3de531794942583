//! Which cameras can be computed.

use super::mask::phase::WAVELENGTH_NM;
use super::{CUT_OFF_PIXELS, Camera, CameraError, FASTEST, MAX_PSI, MAX_TERMS, PhaseTerm, Spectrum, Wrong};
use crate::storage::name;
use crate::words::{number, numbers};
use std::ops::RangeInclusive;

/// Sizes of lenses and pixels that are computed: from micro-optics to telescopes.
const LENGTH_MM: RangeInclusive<f64> = 0.01..=1e5;
const RADIUS_MM: RangeInclusive<f64> = 0.001..=5e4;
const PITCH_UM: RangeInclusive<f64> = 0.01..=1000.0;
const OF_LIGHT: &str = "a wavelength of 100 to 30000 nm";
/// Distances of objects.
const DISTANCE_M: RangeInclusive<f64> = 1e-4..=1e9;
/// Weights of wavelengths, whatever their unit.
const WEIGHT: RangeInclusive<f64> = 0.0..=1e9;
const LEAST_WEIGHT: f64 = 1e-9;
impl Spectrum {
    /// As a camera file has it.
    fn in_words(&self) -> String {
        match self {
            Self::Line(nm) => number(*nm),
            Self::Sampled(pairs) if pairs.is_empty() => "an empty list".to_owned(),
            Self::Sampled(pairs) => {
                let shown: Vec<String> =
                    pairs.iter().take(4).map(|pair| format!("[{}]", numbers(pair))).collect();
                format!("[{}{}]", shown.join(", "), if pairs.len() > 4 { ", …" } else { "" })
            }
        }
    }

    fn is_of_light(&self) -> bool {
        match self {
            Self::Line(nm) => WAVELENGTH_NM.contains(nm),
            Self::Sampled(pairs) => {
                pairs.iter().all(|[nm, weight]| WAVELENGTH_NM.contains(nm) && WEIGHT.contains(weight))
                    && pairs.windows(2).all(|pair| pair[0][0] < pair[1][0])
                    && pairs.iter().any(|[_, weight]| *weight >= LEAST_WEIGHT)
            }
        }
    }
}

impl Camera {
    /// # Errors
    /// [`CameraError::Name`], or [`CameraError::Value`] for the first number that no camera can have.
    pub fn check(&self) -> Result<(), CameraError> {
        if !name::is_title(&self.name) {
            return Err(CameraError::Name(name::quoted(&self.name)));
        }
        let refuse = |field, value: String, expected| {
            Err(CameraError::Value { camera: self.name.clone(), field, value, expected })
        };
        let sizes = [
            ("focal_length_mm", self.focal_length_mm, LENGTH_MM, "0.01 to 100000 mm (10 um to 100 m)"),
            ("aperture_radius_mm", self.aperture_radius_mm, RADIUS_MM, "0.001 to 50000 mm (1 um to 50 m)"),
            ("pixel_pitch_um", self.pixel_pitch_um, PITCH_UM, "0.01 to 1000 um (10 nm to 1 mm)"),
            ("reference_wavelength_nm", self.reference_wavelength_nm, WAVELENGTH_NM, OF_LIGHT),
        ];
        for (field, value, range, expected) in sizes {
            if !range.contains(&value) {
                return refuse(field, number(value), expected);
            }
        }
        let is_far = |metres: f64| DISTANCE_M.contains(&metres) || metres == f64::INFINITY;
        if let Some(metres) = self.nominal_m.filter(|metres| !is_far(*metres)) {
            return refuse("nominal_m", number(metres), "a distance of 0.0001 to 1e9 m");
        }
        let [low, high] = self.psi_range;
        if !(low.abs() <= MAX_PSI && high.abs() <= MAX_PSI && low <= high) {
            return refuse(
                "psi_range",
                format!("[{}, {}]", number(low), number(high)),
                "two numbers of at most 10000 either way, the smaller first",
            );
        }
        if !self.focus_psi.is_finite() || self.focus_psi.abs() > MAX_PSI {
            return refuse("focus_psi", number(self.focus_psi), "at most 10000 either way");
        }
        if let Some(spectrum) = self.spectra.iter().find(|spectrum| !spectrum.is_of_light()) {
            let expected = "a wavelength of 100 to 30000 nm, or ascending [nm, weight] pairs of weights 0 to 1e9, one of them 1e-9 or more";
            return refuse("spectra", spectrum.in_words(), expected);
        }
        self.check_sampling()?;
        self.check_mask()
    }

    /// Whether mask, aberrations and PSF bank are such as can be computed.
    fn check_mask(&self) -> Result<(), CameraError> {
        let wrong = |Wrong { field, value, expected }| CameraError::Value {
            camera: self.name.clone(),
            field,
            value,
            expected,
        };
        let terms = self.mask.terms().len();
        if terms > MAX_TERMS {
            let field = if self.mask.rings().count() > MAX_TERMS { "rings" } else { "mask" };
            return Err(wrong(Wrong { field, value: format!("{terms} of them"), expected: "64 at most" }));
        }
        self.mask.terms().iter().try_for_each(|term| term.check()).map_err(wrong)?;
        self.aberrations.check().map_err(|error| wrong(Wrong { field: "aberrations", ..error }))?;
        if self.psf_bank.as_ref().is_some_and(|bank| bank.file.is_empty()) {
            let expected = "the name of a file, as seen from the camera file";
            return Err(wrong(Wrong { field: "psf_bank.file", value: "empty".to_owned(), expected }));
        }
        Ok(())
    }

    /// Whether pixels and the lens's cut-off suit each other: a grid that holds both must be neither endless nor too coarse for
    /// the pupil.
    fn check_sampling(&self) -> Result<(), CameraError> {
        let refuse = |field, value: f64, expected| {
            let value = number(value);
            Err(CameraError::Value { camera: self.name.clone(), field, value, expected })
        };
        if self.f_number() < FASTEST {
            return refuse("aperture_radius_mm", self.aperture_radius_mm, "at most the focal length (F/0.5)");
        }
        // λF# in pixels, the reciprocal of the cut-off in cycles a pixel.
        let pixels = |nm: f64| nm * 1e-3 * self.f_number() / self.pixel_pitch_um;
        let ends = self.spectra.iter().flat_map(Spectrum::ends).map(pixels);
        let (min, max) = ends.fold((f64::INFINITY, 0.0f64), |(a, b), p| (a.min(p), b.max(p)));
        let [finest, coarsest] = CUT_OFF_PIXELS;
        if min < finest {
            let expected = "at most 8 wavelengths times the F-number, or the lens's cut-off is far above what pixels see";
            return refuse("pixel_pitch_um", self.pixel_pitch_um, expected);
        }
        if max > coarsest {
            let expected = "at least 1/64 of a wavelength times the F-number, or a point is a blur of hundreds of pixels";
            return refuse("pixel_pitch_um", self.pixel_pitch_um, expected);
        }
        Ok(())
    }
}
