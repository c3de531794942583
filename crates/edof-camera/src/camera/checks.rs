//! Which cameras can be computed.

use super::{
    Aberration, CUT_OFF_PIXELS, Camera, CameraError, Delay, FASTEST, HeightMap, MAX_HEIGHT_UM, MAX_NOLL,
    MAX_POINTS, MAX_PSI, MAX_RINGS, MAX_RMS_NM, Profile, Spectrum,
};
use edof_image::words::{number, numbers};
use edof_storage::name;

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
        let positive = [
            ("focal_length_mm", self.focal_length_mm),
            ("aperture_radius_mm", self.aperture_radius_mm),
            ("pixel_pitch_um", self.pixel_pitch_um),
            ("reference_wavelength_nm", self.reference_wavelength_nm),
        ];
        for (field, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return refuse(field, number(value), "a positive number");
            }
        }
        if let Some(metres) = self.nominal_m.filter(|metres| metres.is_nan() || *metres <= 0.0) {
            return refuse("nominal_m", number(metres), "a distance of more than 0 m");
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
        for spectrum in &self.spectra {
            let good = match spectrum {
                Spectrum::Line(nm) => nm.is_finite() && *nm > 0.0,
                Spectrum::Sampled(pairs) => {
                    pairs.iter().all(|[nm, w]| *nm > 0.0 && *w >= 0.0 && nm.is_finite() && w.is_finite())
                        && pairs.windows(2).all(|p| p[0][0] < p[1][0])
                        && pairs.iter().any(|[_, w]| *w > 0.0)
                }
            };
            if !good {
                let expected = "a wavelength in nm, or ascending [nm, weight] pairs of some positive weight";
                return refuse("spectra", spectrum.in_words(), expected);
            }
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
            let finite = match ring.delay {
                Delay::Phase { rad, at_nm } => rad.is_finite() && at_nm.is_finite() && at_nm > 0.0,
                Delay::Etched { height_um, cauchy } => {
                    [height_um, cauchy[0], cauchy[1]].iter().all(|v| v.is_finite())
                }
            };
            if !finite {
                return refuse("rings", ring.delay.in_words(), "finite numbers, a positive wavelength");
            }
        }
        if let Some(Profile { at_nm, points }) = &self.profile {
            let finite = points.iter().flatten().all(|v| v.is_finite());
            let inside = points.iter().all(|point| (0.0..=1.0).contains(&point[0]));
            let ascending = points.windows(2).all(|pair| pair[0][0] < pair[1][0]);
            let sized = (1..=MAX_POINTS).contains(&points.len()) && *at_nm > 0.0 && at_nm.is_finite();
            if !(finite && inside && ascending && sized) {
                let found = format!("{} points at {} nm", points.len(), number(*at_nm));
                return refuse(
                    "profile",
                    found,
                    "1 to 4096 [radius 0 to 1, radians] pairs of ascending radius",
                );
            }
        }
        if let Some(HeightMap { white_um, cauchy, .. }) = &self.height_map {
            let glass = cauchy.iter().all(|v| v.is_finite());
            if !(*white_um > 0.0 && *white_um <= MAX_HEIGHT_UM && glass) {
                let found = format!("{} um of {}", number(*white_um), numbers(cauchy));
                return refuse("height_map", found, "more than 0 and at most 100 um, of two finite numbers");
            }
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
