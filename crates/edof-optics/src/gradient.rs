//! Derivatives of PSFs by what a designer of a lens may change: radii and phases of the mask's rings, and the focus.
//!
//! The pupil is sampled on a grid whose samples see soft edges ([`Pupil::sample`]). A radius that moves changes the samples that its edge
//! crosses, in proportion; so these are the derivatives of the sums that are computed, not of the integrals that the sums stand for.
//! Each parameter's change of the pupil is transformed as the pupil itself is (forward mode).

use crate::cosine::{EvenTransform, fold_rows, period};
use crate::psf::{NoPsf, Psf, Settings, channel_psfs, wave_um};
use crate::pupil::Pupil;
use edof_core::camera::Camera;
use edof_core::camera::{Delay, Ring};
use edof_numerics::fft::Complex64;
use edof_numerics::sinc;
use ndarray::Array2;
use rayon::prelude::*;

/// A number of a camera that a PSF depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Inner radius of a ring, as a share of the aperture's.
    Inner(usize),
    /// Outer radius of a ring. At the aperture's rim this is the derivative for a radius that shrinks.
    Outer(usize),
    /// Phase of a ring in radians at the camera's reference wavelength; with it changes the ring's depth, and its phase at every wavelength.
    Phase(usize),
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
    /// PSFs that do not follow from rings and focus.
    #[error("camera {camera}: has {found}; derivatives are those of rings and focus alone, so leave it out")]
    Shape { camera: String, found: &'static str },
}

/// The parameters of a camera: inner radius, outer radius and phase of each ring, then the focus.
#[must_use]
pub fn parameters(camera: &Camera) -> Vec<Parameter> {
    let of_ring = |ring| [Parameter::Inner(ring), Parameter::Outer(ring), Parameter::Phase(ring)];
    (0..camera.rings.len()).flat_map(of_ring).chain([Parameter::Focus]).collect()
}

/// Checks that the PSFs of a camera follow from its rings and focus.
///
/// # Errors
/// [`GradientError::Shape`].
pub fn check(camera: &Camera) -> Result<(), GradientError> {
    let found = if camera.psf_bank.is_some() {
        "a PSF bank"
    } else if camera.height_map.is_some() {
        "a height map"
    } else if !camera.is_round() {
        "aberrations"
    } else if camera.rings.iter().any(|ring| is_air(ring.delay, camera.reference_wavelength_nm)) {
        "an etched ring of index 1, whose height changes no phase"
    } else {
        return Ok(());
    };
    Err(GradientError::Shape { camera: camera.name.clone(), found })
}

/// Whether a ring is etched into what delays no light of a wavelength.
fn is_air(delay: Delay, nm: f64) -> bool {
    match delay {
        Delay::Phase { .. } => false,
        Delay::Etched { cauchy, .. } => Delay::Etched { height_um: 1.0, cauchy }.phase_rad(nm) == 0.0,
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
    let planes: Vec<Array2<f64>> = jobs
        .par_iter()
        .map(|&(channel, parameter)| derivative(&fields[channel], camera, parameter))
        .collect();
    let mut planes = planes.into_iter();
    let mut next = || planes.next().unwrap_or_default();
    Ok(parameters(camera).iter().map(|_| [next(), next(), next()]).collect())
}

/// Derivative of a kernel that is the mean over wavelengths, cut and scaled to a sum of 1.
fn derivative(fields: &[Field], camera: &Camera, parameter: Parameter) -> Array2<f64> {
    let (mut kernel, mut change) = (fields[0].kernel.clone(), fields[0].change(camera, parameter));
    for field in &fields[1..] {
        kernel += &field.kernel;
        change += &field.change(camera, parameter);
    }
    let sum = kernel.sum();
    let growth = change.sum() / sum;
    (change - kernel * growth) / sum
}

/// The field of one wavelength on the fine grid of [`crate::psf::quarter_psf`], and what of its light the pixels of a kernel collect.
struct Field {
    wavelength_nm: f64,
    psi: f64,
    support: usize,
    /// Largest offset of the kernel in pixels.
    half: usize,
    /// Samples of the pupil from its middle to its edge.
    radius: f64,
    samples: usize,
    transform: EvenTransform<f64>,
    n: usize,
    /// Real and imaginary part.
    parts: [Array2<f64>; 2],
    /// All light on the grid.
    light: f64,
    /// The kernel, as a share of all light.
    kernel: Array2<f64>,
}

impl Field {
    fn new(camera: &Camera, wavelength_nm: f64, psi: f64, psf: &Psf) -> Self {
        let (support, half) = (psf.support, psf.side() / 2);
        let wave = wave_um(camera, wavelength_nm) / camera.pixel_pitch_um;
        let steps = (2.0 / wave).ceil().max(1.0) as usize;
        let n = support * steps / 2 + 1;
        let radius = support as f64 / (2.0 * wave);
        let samples = (radius.ceil() as usize + 1).min(n);
        let transform = EvenTransform::new(n);
        let mut field = Self {
            wavelength_nm,
            psi,
            support,
            half,
            radius,
            samples,
            transform,
            n,
            parts: Default::default(),
            light: 0.0,
            kernel: Array2::default((0, 0)),
        };
        let pupil = Pupil::new(camera, wavelength_nm, psi);
        field.parts = field.of_pupil(|rho, width| pupil.sample(rho, width));
        let [re, im] = &field.parts;
        let (light, kernel) = field.collected(&(re * re + im * im));
        (field.light, field.kernel) = (light, kernel / light);
        field
    }

    /// Real and imaginary part of the field of a pupil, or of its change.
    fn of_pupil(&self, sample: impl Fn(f64, f64) -> Complex64) -> [Array2<f64>; 2] {
        let sampled = Array2::from_shape_fn((self.samples, self.samples), |(r, c)| {
            sample((r as f64).hypot(c as f64) / self.radius, 1.0 / self.radius)
        });
        [sampled.mapv(|p| p.re), sampled.mapv(|p| p.im)].map(|part| {
            let half_way = self.transform.rows_transposed(part.view(), self.n);
            self.transform.rows_transposed(half_way.view(), self.n)
        })
    }

    /// Derivative of [`Field::kernel`].
    fn change(&self, camera: &Camera, parameter: Parameter) -> Array2<f64> {
        let [re, im] = &self.parts;
        let pupil = PupilChange::new(camera, self.wavelength_nm, self.psi, parameter);
        let [re_change, im_change] = self.of_pupil(|rho, width| pupil.sample(rho, width));
        let (more_light, change) = self.collected(&(2.0 * (re * &re_change + im * &im_change)));
        (change - &self.kernel * more_light) / self.light
    }

    /// All light of an intensity on the fine grid, and what the pixels of the kernel collect of it.
    fn collected(&self, intensity: &Array2<f64>) -> (f64, Array2<f64>) {
        let band = (2 * self.samples).min(self.n);
        let half_way = self.transform.rows_transposed(intensity.view(), band);
        let mut otf = self.transform.rows_transposed(half_way.view(), band);
        let light = otf[(0, 0)];
        let footprint: Vec<f64> = (0..band).map(|q| sinc(q as f64 / self.support as f64)).collect();
        for ((r, c), v) in otf.indexed_iter_mut() {
            *v *= footprint[r] * footprint[c];
        }
        let pixels = self.support / 2 + 1;
        let folded = fold_rows(fold_rows(otf.view(), pixels).t(), pixels);
        let back = EvenTransform::new(pixels);
        let half_way = back.rows_transposed(folded.view(), self.half + 1);
        let quarter = back.rows_transposed(half_way.view(), self.half + 1);
        let scale = 1.0 / (period(pixels) * period(pixels)) as f64;
        let side = 2 * self.half + 1;
        let at = |i: usize| i.abs_diff(self.half);
        (light, Array2::from_shape_fn((side, side), |(r, c)| quarter[(at(r), at(c))] * scale))
    }
}

/// Derivative of the pupil by one parameter.
struct PupilChange<'a> {
    camera: &'a Camera,
    wavelength_nm: f64,
    parameter: Parameter,
    pupil: Pupil,
    /// Edges of the zones of constant phase, from 0 to 1.
    edges: Vec<f64>,
}

impl<'a> PupilChange<'a> {
    fn new(camera: &'a Camera, wavelength_nm: f64, psi: f64, parameter: Parameter) -> Self {
        let mut edges: Vec<f64> =
            camera.rings.iter().flat_map(|r| [r.inner, r.outer]).chain([0.0, 1.0]).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        Self { camera, wavelength_nm, parameter, pupil: Pupil::new(camera, wavelength_nm, psi), edges }
    }

    fn sample(&self, rho: f64, width: f64) -> Complex64 {
        let (low, high) = (rho - 0.5 * width, rho + 0.5 * width);
        let i = Complex64::new(0.0, 1.0);
        let mask = match self.parameter {
            Parameter::Focus => {
                let camera = self.camera;
                let scale =
                    camera.defocus_sign.factor() * camera.reference_wavelength_nm / self.wavelength_nm;
                return self.pupil.sample(rho, width) * i * (-scale * rho * rho);
            }
            Parameter::Inner(ring) => -self.edge(ring, self.camera.rings[ring].inner, [low, high], 1.0),
            Parameter::Outer(ring) => self.edge(ring, self.camera.rings[ring].outer, [low, high], -1.0),
            Parameter::Phase(ring) => i * self.slope(ring) * self.light(ring, [low, high]),
        };
        mask / width * self.carrier(rho)
    }

    /// What a sample gains for each unit by which an edge of a ring moves outward, the ring on the edge's inner side; `side` is where the
    /// other rings' phases are taken, outside or inside of the edge.
    fn edge(&self, ring: usize, edge: f64, [low, high]: [f64; 2], side: f64) -> Complex64 {
        if !(low < edge && edge <= high) {
            return Complex64::new(0.0, 0.0);
        }
        let others = self.phases(edge + side * 1e-9, Some(ring));
        Complex64::cis(others) * (Complex64::cis(self.phase(&self.camera.rings[ring])) - 1.0)
    }

    /// Integral of the mask over that part of a sample which a ring covers.
    fn light(&self, ring: usize, [low, high]: [f64; 2]) -> Complex64 {
        let Ring { inner, outer, .. } = self.camera.rings[ring];
        let zones = self.edges.windows(2).filter(|zone| inner <= zone[0] && zone[1] <= outer);
        let part = |zone: &[f64]| {
            let length = (high.min(zone[1]) - low.max(zone[0])).max(0.0);
            Complex64::cis(self.phases(0.5 * (zone[0] + zone[1]), None)) * length
        };
        zones.map(part).sum()
    }

    /// Sum of the phases of all rings at a radius, but one.
    fn phases(&self, rho: f64, without: Option<usize>) -> f64 {
        let rings = self.camera.rings.iter().enumerate();
        let inside = rings.filter(|(i, ring)| Some(*i) != without && ring.inner < rho && rho < ring.outer);
        inside.map(|(_, ring)| self.phase(ring)).sum()
    }

    fn phase(&self, ring: &Ring) -> f64 {
        ring.delay.phase_rad(self.wavelength_nm)
    }

    /// Phase at this wavelength for each radian at the reference wavelength.
    fn slope(&self, ring: usize) -> f64 {
        let reference = self.camera.reference_wavelength_nm;
        match self.camera.rings[ring].delay {
            Delay::Phase { .. } => reference / self.wavelength_nm,
            Delay::Etched { cauchy, .. } => {
                let of_a_micrometre = |nm: f64| Delay::Etched { height_um: 1.0, cauchy }.phase_rad(nm);
                of_a_micrometre(self.wavelength_nm) / of_a_micrometre(reference)
            }
        }
    }

    /// What the pupil has besides its rings.
    fn carrier(&self, rho: f64) -> Complex64 {
        let smooth =
            self.camera.profile.as_ref().map_or(0.0, |profile| profile.phase_rad(rho, self.wavelength_nm));
        Complex64::cis(self.pupil.defocus_rad() * rho * rho + smooth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::Spectrum;

    /// A lens of two rings, one of them etched, with a spectrum.
    fn two_rings() -> Camera {
        let etched = Delay::Etched { height_um: 0.7, cauchy: [1.5, 0.004] };
        let phase = Delay::Phase { rad: -3.1, at_nm: 455.0 };
        let band = Spectrum::Sampled(vec![[580.0, 0.0], [610.0, 1.0], [650.0, 0.0]]);
        let mut camera = Camera::resolve("ring-2018").unwrap();
        camera.rings = vec![
            Ring { inner: 0.31, outer: 0.522, delay: etched },
            Ring { inner: 0.733, outer: 0.955, delay: phase },
        ];
        camera.spectra[0] = band;
        camera
    }

    fn moved(camera: &Camera, parameter: Parameter, by: f64) -> Camera {
        let mut moved = camera.clone();
        match parameter {
            Parameter::Inner(ring) => moved.rings[ring].inner += by,
            Parameter::Outer(ring) => moved.rings[ring].outer += by,
            Parameter::Focus => moved.focus_psi += by,
            Parameter::Phase(ring) => match &mut moved.rings[ring].delay {
                Delay::Phase { rad, at_nm } => *rad += by * camera.reference_wavelength_nm / *at_nm,
                delay @ Delay::Etched { .. } => {
                    let all = delay.phase_rad(camera.reference_wavelength_nm);
                    if let Delay::Etched { height_um, .. } = delay {
                        *height_um *= (all + by) / all;
                    }
                }
            },
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
        for camera in [two_rings(), Camera::resolve("ring-outer").unwrap()] {
            for psf in channel_psfs(&camera, 2.5, &settings).unwrap() {
                let own = kernel(&camera, 2.5, &psf);
                let difference = own - psf.kernel().mapv(f64::from);
                assert!(largest(&difference) < 1e-6, "{}: {}", camera.name, largest(&difference));
            }
        }
    }

    #[test]
    fn derivatives_agree_with_finite_differences_in_double_precision() {
        let settings = Settings { energy: 0.98, ..Settings::default() };
        for (camera, psi) in [(two_rings(), 2.5), (Camera::resolve("ring-outer").unwrap(), 7.0)] {
            let psfs = channel_psfs(&camera, psi, &settings).unwrap();
            let gradient = psf_gradient(&camera, psi, &settings).unwrap();
            assert_eq!(gradient.len(), 3 * camera.rings.len() + 1);
            for (parameter, planes) in parameters(&camera).into_iter().zip(&gradient) {
                // The rim's own ring can only shrink.
                let rim = matches!(parameter, Parameter::Outer(i) if camera.rings[i].outer == 1.0);
                let (low, high) = (-1e-8, if rim { 0.0 } else { 1e-8 });
                for (psf, plane) in psfs.iter().zip(planes) {
                    let [a, b] = [low, high].map(|by| kernel(&moved(&camera, parameter, by), psi, psf));
                    let expected = (b - a) / (high - low);
                    let error = largest(&(plane - &expected)) / largest(&expected);
                    assert!(error < 1e-4, "{} {parameter:?}: {error}", camera.name);
                    assert!(plane.sum().abs() < 1e-9 && plane.dim() == psf.kernel().dim());
                }
            }
        }
    }

    #[test]
    fn lenses_that_rings_do_not_describe_are_rejected() {
        let mut camera = Camera::resolve("ring-outer").unwrap();
        camera.aberrations = vec![edof_core::camera::Aberration { noll: 8, rms_nm: 20.0 }];
        let error = psf_gradient(&camera, 0.0, &Settings::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "camera ring-outer: has aberrations; derivatives are those of rings and focus alone, so leave it out"
        );
    }
}
