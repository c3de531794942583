//! Which cameras can be computed.

use super::{
    Aberration, CUT_OFF_PIXELS, Camera, CameraError, Delay, FASTEST, HeightMap, MAX_HEIGHT_UM, MAX_NOLL,
    MAX_POINTS, MAX_PSI, MAX_RINGS, MAX_RMS_NM, Profile, Spectrum,
};
use crate::storage::name;
use crate::words::{number, numbers};
use std::ops::RangeInclusive;

/// Sizes of lenses and pixels that are computed: from micro-optics to telescopes.
const LENGTH_MM: RangeInclusive<f64> = 0.01..=1e5;
const RADIUS_MM: RangeInclusive<f64> = 0.001..=5e4;
const PITCH_UM: RangeInclusive<f64> = 0.01..=1000.0;
/// From ultraviolet to thermal infrared.
const WAVELENGTH_NM: RangeInclusive<f64> = 100.0..=30_000.0;
const OF_LIGHT: &str = "a wavelength of 100 to 30000 nm";
/// Distances of objects.
const DISTANCE_M: RangeInclusive<f64> = 1e-4..=1e9;
/// Weights of wavelengths, whatever their unit.
const WEIGHT: RangeInclusive<f64> = 0.0..=1e9;
const LEAST_WEIGHT: f64 = 1e-9;
/// Most phase of a mask either way.
const MAX_RAD: f64 = 10_000.0;

/// Whether n(λ) can be a material's: [`Delay::Etched`].
fn is_glass([constant, slope]: [f64; 2]) -> bool {
    (0.1..=10.0).contains(&constant) && slope.abs() <= 10.0
}

impl Spectrum {
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

    /// Whether rings, profile, height map and aberrations are such as can be computed.
    fn check_mask(&self) -> Result<(), CameraError> {
        let refuse = |field, value: String, expected| {
            Err(CameraError::Value { camera: self.name.clone(), field, value, expected })
        };
        if self.rings.len() > MAX_RINGS {
            return refuse("rings", format!("{} of them", self.rings.len()), "64 at most");
        }
        for ring in &self.rings {
            if !(0.0 <= ring.inner && ring.inner < ring.outer && ring.outer <= 1.0) {
                let found = format!("{} to {}", number(ring.inner), number(ring.outer));
                return refuse("rings", found, "0 <= inner < outer <= 1");
            }
            let (is_possible, expected) = match ring.delay {
                Delay::Phase { rad, at_nm } => (
                    rad.abs() <= MAX_RAD && WAVELENGTH_NM.contains(&at_nm),
                    "at most 10000 rad either way, at 100 to 30000 nm",
                ),
                Delay::Etched { height_um, cauchy } => (
                    height_um.abs() <= MAX_HEIGHT_UM && is_glass(cauchy),
                    "at most 100 um either way, in glass of [0.1 to 10, -10 to 10]",
                ),
            };
            if !is_possible {
                return refuse("rings", ring.delay.in_words(), expected);
            }
        }
        if let Some(Profile { at_nm, points }) = &self.profile {
            let possible = points.iter().all(|point| point[1].abs() <= MAX_RAD);
            let inside = points.iter().all(|point| (0.0..=1.0).contains(&point[0]));
            let ascending = points.windows(2).all(|pair| pair[0][0] < pair[1][0]);
            let sized = (1..=MAX_POINTS).contains(&points.len()) && WAVELENGTH_NM.contains(at_nm);
            if !(possible && inside && ascending && sized) {
                let found = format!("{} points at {} nm", points.len(), number(*at_nm));
                return refuse(
                    "profile",
                    found,
                    "1 to 4096 [radius 0 to 1, radians] pairs of ascending radius and at most 10000 rad, at 100 to 30000 nm",
                );
            }
        }
        if let Some(HeightMap { white_um, cauchy, .. }) = &self.height_map
            && !((1e-4..=MAX_HEIGHT_UM).contains(white_um) && is_glass(*cauchy))
        {
            let found = format!("{} um of {}", number(*white_um), numbers(cauchy));
            return refuse(
                "height_map",
                found,
                "more than 0: 0.0001 to 100 um, in glass of [0.1 to 10, -10 to 10]",
            );
        }
        for (field, file) in [
            ("psf_bank.file", self.psf_bank.as_ref().map(|bank| &bank.file)),
            ("height_map.file", self.height_map.as_ref().map(|map| &map.file)),
        ] {
            if file.is_some_and(String::is_empty) {
                return refuse(field, "empty".to_owned(), "the name of a file, as seen from the camera file");
            }
        }
        let wrong = |a: &&Aberration| {
            !((2..=MAX_NOLL).contains(&a.noll) && a.rms_nm.is_finite() && a.rms_nm.abs() <= MAX_RMS_NM)
        };
        if let Some(Aberration { noll, rms_nm }) = self.aberrations.iter().find(wrong) {
            let found = format!("noll {noll} of {} nm", number(*rms_nm));
            return refuse("aberrations", found, "Noll's indices 2 to 66, and at most 10000 nm either way");
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
