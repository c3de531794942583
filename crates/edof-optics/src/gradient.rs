//! Derivatives of PSFs by what a designer of a lens may change: the parameters of the mask's terms, and the focus.
//!
//! The pupil is sampled on a grid whose samples see soft edges ([`Pupil::sample`]). A radius that moves changes the samples that its edge
//! crosses, in proportion; so these are the derivatives of the sums that are computed, not of the integrals that the sums stand for.
//! Each parameter's change of the pupil is transformed as the pupil itself is (forward mode).

use crate::psf::grid::Grid;
use crate::psf::{NoPsf, Psf, Settings, channel_psfs, round, wavefront};
use crate::pupil::Pupil;
use edof_core::Camera;
use edof_core::camera::{Place, Symmetry, Term};
use edof_numerics::fft::Complex64;
use ndarray::Array2;
use rayon::prelude::*;

/// A number of a camera that a PSF depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// A parameter of a term of the mask, both by their index. Phases are those at the camera's reference wavelength.
    Mask {
        /// Index of the term.
        term: usize,
        /// Index of the parameter.
        parameter: usize,
    },
    /// ψ at which the lens is focused.
    Focus,
}

/// A camera whose PSFs have no such derivatives.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum GradientError {
    /// A depth that the camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
    /// PSFs that do not follow from mask and focus.
    #[error("camera {camera}: has {found}; derivatives are those of mask and focus alone, so leave it out")]
    Shape { camera: String, found: &'static str },
}

/// The parameters of a camera: those of each term of the mask, then the focus.
#[must_use]
pub fn parameters(camera: &Camera) -> Vec<Parameter> {
    let nm = camera.reference_wavelength_nm;
    let of_term = |(term, own): (usize, &Term)| {
        (0..own.parameters(nm).len()).map(move |parameter| Parameter::Mask { term, parameter })
    };
    camera.mask.terms().iter().enumerate().flat_map(of_term).chain([Parameter::Focus]).collect()
}

/// Checks that the PSFs of a camera follow from its mask and focus.
///
/// # Errors
/// [`GradientError::Shape`].
pub fn check(camera: &Camera) -> Result<(), GradientError> {
    let objection = || camera.terms().find_map(|term| term.objection(camera.reference_wavelength_nm));
    let found = if camera.psf_bank.is_some() { Some("a PSF bank") } else { objection() };
    match found {
        Some(found) => Err(GradientError::Shape { camera: camera.name.clone(), found }),
        None => Ok(()),
    }
}

/// Derivatives of the kernels that [`channel_psfs`] gives, one for each of [`parameters`] and channel, of the kernels' sides. A kernel keeps
/// its side and its sum of 1, so every derivative sums to 0.
///
/// # Errors
/// [`GradientError`].
pub fn psf_gradient(
    camera: &Camera,
    psi: f64,
    settings: &Settings,
) -> Result<Vec<[Array2<f64>; 3]>, GradientError> {
    check(camera)?;
    let psfs = channel_psfs(camera, psi, settings)?;
    let jobs: Vec<(usize, Parameter)> =
        parameters(camera).into_iter().flat_map(|p| (0..3).map(move |channel| (channel, p))).collect();
    let fields: Vec<Vec<Field>> = psfs
        .par_iter()
        .map(|psf| psf.wavelengths_nm.iter().map(|&nm| Field::new(camera, nm, psi, psf)).collect())
        .collect();
    let planes: Vec<Array2<f64>> =
        jobs.par_iter().map(|&(channel, parameter)| derivative(&fields[channel], parameter)).collect();
    let mut planes = planes.into_iter();
    let mut next = || planes.next().unwrap_or_default();
    Ok(parameters(camera).iter().map(|_| [next(), next(), next()]).collect())
}

/// Derivative of a kernel that is the mean over wavelengths, cut and scaled to a sum of 1.
fn derivative(fields: &[Field], parameter: Parameter) -> Array2<f64> {
    let (mut kernel, mut change) = (fields[0].kernel.clone(), fields[0].change(parameter));
    for field in &fields[1..] {
        kernel += &field.kernel;
        change += &field.change(parameter);
    }
    let sum = kernel.sum();
    let growth = change.sum() / sum;
    (change - kernel * growth) / sum
}

/// The sampled pupil of one wavelength, and what of its light the pixels of a kernel collect.
struct Field<'a> {
    pupil: Pupil<'a>,
    symmetry: Symmetry,
    grid: Grid,
    support: usize,
    /// Largest offset of the kernel in pixels.
    half: usize,
    samples: Array2<Complex64>,
    light: f64,
    /// The kernel, as a share of all light.
    kernel: Array2<f64>,
}

impl<'a> Field<'a> {
    fn new(camera: &'a Camera, wavelength_nm: f64, psi: f64, psf: &Psf) -> Self {
        let mut field = Self {
            pupil: Pupil::new(camera, wavelength_nm, psi),
            symmetry: camera.symmetry(),
            grid: Grid::new(camera, wavelength_nm, psf.support),
            support: psf.support,
            half: psf.side() / 2,
            samples: Array2::default((0, 0)),
            light: 1.0,
            kernel: Array2::default((0, 0)),
        };
        field.samples = field.sampled(|at, width| field.pupil.sample_at(at, width));
        field.light = field.light(None);
        field.kernel = field.pixels(None);
        field
    }

    /// The pupil or its change on the grid; `sample` takes a place and a sample's width.
    fn sampled(&self, sample: impl Fn(Place, f64) -> Complex64) -> Array2<Complex64> {
        let sample = |at| sample(at, 1.0 / self.grid.radius);
        match self.symmetry {
            Symmetry::Round => round::samples(self.grid, sample),
            Symmetry::None => wavefront::samples(self.grid, sample),
        }
    }

    /// All light, or its change.
    fn light(&self, change: Option<&Array2<Complex64>>) -> f64 {
        match self.symmetry {
            Symmetry::Round => round::light(&self.samples, change),
            Symmetry::None => wavefront::light(&self.samples, change),
        }
    }

    /// What the pixels of the kernel collect, or its change, as a share of all light.
    fn pixels(&self, change: Option<&Array2<Complex64>>) -> Array2<f64> {
        let Self { samples, grid, support, half, light, .. } = self;
        let side = 2 * half + 1;
        match self.symmetry {
            Symmetry::Round => {
                let quarter = round::pixels(samples, change, *grid, *support, *light);
                Array2::from_shape_fn((side, side), |(r, c)| quarter[(r.abs_diff(*half), c.abs_diff(*half))])
            }
            Symmetry::None => {
                let whole = wavefront::pixels(samples, change, *grid, *support, *light);
                let offset = |i: usize| (i + support - half) % support;
                Array2::from_shape_fn((side, side), |(r, c)| whole[(offset(r), offset(c))])
            }
        }
    }

    /// Derivative of [`Field::kernel`].
    fn change(&self, parameter: Parameter) -> Array2<f64> {
        let change = match parameter {
            Parameter::Focus => self.sampled(self.pupil.focus_change()),
            Parameter::Mask { term, parameter } => self.sampled(self.pupil.term_change(term, parameter)),
        };
        self.pixels(Some(&change)) - &self.kernel * (self.light(Some(&change)) / self.light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::{Aberration, Delay, HeightMap, Ring, Spectrum, Zernike};

    /// A lens of two rings, one of them etched, with a spectrum.
    fn two_rings() -> Camera {
        let etched = Delay::Etched { height_um: 0.7, cauchy: [1.5, 0.004] };
        let phase = Delay::Phase { rad: -3.1, at_nm: 455.0 };
        let band = Spectrum::Sampled(vec![[580.0, 0.0], [610.0, 1.0], [650.0, 0.0]]);
        let mut camera = Camera::resolve("ring-2018").unwrap();
        let rings = [
            Ring { inner: 0.31, outer: 0.522, delay: etched },
            Ring { inner: 0.733, outer: 0.955, delay: phase },
        ];
        camera.mask = rings.into_iter().collect();
        camera.spectra[0] = band;
        camera
    }

    /// A ring on a lens with coma, and with a surface in its pupil.
    fn shaped() -> Camera {
        let mut camera = Camera::resolve("ring-outer").unwrap();
        camera.mask.rings_mut().for_each(|ring| ring.outer = 0.97);
        camera.aberrations = Zernike(vec![Aberration { noll: 8, rms_nm: 70.0 }]);
        let cauchy = [1.5, 0.0];
        let mut map =
            HeightMap { file: "m.png".into(), white_um: 0.6, cauchy, sha256: String::new(), heights: None };
        let heights = Array2::from_shape_fn((16, 16), |(r, c)| (r * c) as f32 / 225.0);
        map.take(heights, "m.png".into(), "mine").unwrap();
        camera.mask.add(map);
        camera
    }

    fn moved(camera: &Camera, parameter: Parameter, by: f64) -> Camera {
        let mut moved = camera.clone();
        match parameter {
            Parameter::Focus => moved.focus_psi += by,
            Parameter::Mask { term, parameter } => {
                let nm = camera.reference_wavelength_nm;
                let term = &mut moved.mask.terms_mut()[term];
                let mut values: Vec<f64> = term.parameters(nm).iter().map(|p| p.value()).collect();
                values[parameter] += by;
                term.set(&values, nm);
            }
        }
        moved
    }

    /// The kernel in f64, of the side and wavelengths of `psf`.
    fn kernel(camera: &Camera, psi: f64, psf: &Psf) -> Array2<f64> {
        let fields = psf.wavelengths_nm.iter().map(|&nm| Field::new(camera, nm, psi, psf).kernel);
        let sum = fields.reduce(|sum, kernel| sum + kernel).unwrap();
        let light = sum.sum();
        sum / light
    }

    fn largest(plane: &Array2<f64>) -> f64 {
        plane.iter().fold(0.0, |max, v| max.max(v.abs()))
    }

    #[test]
    fn kernels_that_are_differentiated_are_those_that_are_computed() {
        let settings = Settings { energy: 0.98, ..Settings::default() };
        for camera in [two_rings(), Camera::resolve("ring-outer").unwrap(), shaped()] {
            for psf in channel_psfs(&camera, 2.5, &settings).unwrap() {
                let own = kernel(&camera, 2.5, &psf);
                let difference = own - psf.kernel().mapv(f64::from);
                assert!(largest(&difference) < 1e-6, "{}: {}", camera.name, largest(&difference));
            }
        }
    }

    /// Compares all derivatives with finite differences.
    fn check_derivatives(camera: &Camera, psi: f64) {
        let settings = Settings { energy: 0.98, ..Settings::default() };
        let psfs = channel_psfs(camera, psi, &settings).unwrap();
        let gradient = psf_gradient(camera, psi, &settings).unwrap();
        let rim = camera.mask.rings().any(|ring| ring.outer == 1.0);
        for (parameter, planes) in parameters(camera).into_iter().zip(&gradient) {
            // The rim's own ring can only shrink.
            let is_rim = rim && matches!(parameter, Parameter::Mask { parameter: 1, .. });
            let (low, high) = (-1e-8, if is_rim { 0.0 } else { 1e-8 });
            for (psf, plane) in psfs.iter().zip(planes) {
                let [a, b] = [low, high].map(|by| kernel(&moved(camera, parameter, by), psi, psf));
                let expected = (b - a) / (high - low);
                let error = largest(&(plane - &expected)) / largest(&expected);
                assert!(error < 1e-4, "{} {parameter:?}: {error}", camera.name);
                assert!(plane.sum().abs() < 1e-9 && plane.dim() == psf.kernel().dim());
            }
        }
    }

    #[test]
    fn derivatives_agree_with_finite_differences_in_double_precision() {
        check_derivatives(&two_rings(), 2.5);
        check_derivatives(&Camera::resolve("ring-outer").unwrap(), 7.0);
        check_derivatives(&shaped(), 2.5);
        assert_eq!((parameters(&two_rings()).len(), parameters(&shaped()).len()), (7, 4));
    }

    #[test]
    fn psfs_that_no_mask_describes_are_rejected() {
        let mut camera = Camera::resolve("ring-outer").unwrap();
        let own = edof_core::camera::PsfBank {
            file: "own.npz".into(),
            sha256: String::new(),
            centre: false,
            kernels: None,
        };
        camera.psf_bank = Some(own);
        let error = psf_gradient(&camera, 0.0, &Settings::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "camera ring-outer: has a PSF bank; derivatives are those of mask and focus alone, so leave it out"
        );
    }
}
