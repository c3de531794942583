//! PSFs of lenses whose wavefront is not round: the pupil with its Zernike terms and the surface of its mask, transformed whole.
//!
//! The steps are those of the round case ([`super`]), on grids that have no symmetry to save by.

use super::wave_um;
use crate::pupil::Pupil;
use edof_camera::camera::{Aberration, Camera};
use edof_numerics::fft::{Complex64, Real};
use edof_numerics::sinc;
use ndarray::Array2;

/// Most points along a side of the finest grid.
const MAX_POINTS: usize = 4096;

/// Most of the light of a mask that may fall beyond the middle half of the support's sides; where more does, some is beyond the support.
const OUTSIDE: f64 = 0.02;

/// The support that a grid has room for, at most `wanted` pixels a side. A mask of any shape may throw light farther than its lens: then
/// it is larger, as far as there is room.
pub fn support(camera: &Camera, wavelength_nm: f64, psi: f64, wanted: usize) -> usize {
    let room = MAX_POINTS / steps_a_pixel(camera, wavelength_nm);
    let room = if room.is_power_of_two() { room } else { room.next_power_of_two() / 2 };
    let mut support = wanted.min(room);
    while camera.height_map.is_some() && support < room.min(super::SUPPORT) {
        let sums = square_sums(&whole_psf(camera, wavelength_nm, psi, support));
        if sums[support / 4] >= 1.0 - OUTSIDE {
            break;
        }
        support *= 2;
    }
    support
}

/// The PSF at one wavelength, integrated over pixels: offset (r, c) from the middle at index (r, c) modulo `support`. Sums to 1.
pub fn whole_psf(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> Array2<f64> {
    let n = support * steps_a_pixel(camera, wavelength_nm);
    let field = transform(pupil(camera, wavelength_nm, psi, support, n));
    let otf = transform(field.mapv(|v| Complex64::new(v.norm_sqr(), 0.0)));
    let light = otf[(0, 0)].re;
    // Indices of both signs of frequency, up to the cut-off's.
    let frequency = |q: usize| if 2 * q < n { q as isize } else { q as isize - n as isize };
    let mut folded = Array2::from_elem((support, support), Complex64::new(0.0, 0.0));
    for ((r, c), value) in otf.indexed_iter() {
        let (down, across) = (frequency(r), frequency(c));
        let footprint = sinc(down as f64 / support as f64) * sinc(across as f64 / support as f64);
        let at = (down.rem_euclid(support as isize) as usize, across.rem_euclid(support as isize) as usize);
        // Conjugate, for the way back by the same transform.
        folded[at] += value.conj() * (footprint / light);
    }
    let scale = 1.0 / (support * support) as f64;
    transform(folded).mapv(|v| (v.re * scale).max(0.0))
}

/// Sums over the centred squares of sides 1, 3, 5 … of a plane that is laid out as [`whole_psf`]'s.
pub fn square_sums(plane: &Array2<f64>) -> Vec<f64> {
    let side = plane.nrows();
    let half = side / 2;
    let mut rings = vec![0.0; half];
    for ((r, c), v) in plane.indexed_iter() {
        let reach = |i: usize| i.min(side - i);
        if let Some(ring) = rings.get_mut(reach(r).max(reach(c))) {
            *ring += v;
        }
    }
    rings
        .iter()
        .scan(0.0, |sum, ring| {
            *sum += ring;
            Some(*sum)
        })
        .collect()
}

/// Grid steps a pixel: the spacing is at most half of λF#, so that the PSF's band, ±1/(λF#), fits.
fn steps_a_pixel(camera: &Camera, wavelength_nm: f64) -> usize {
    (2.0 * camera.pixel_pitch_um / wave_um(camera, wavelength_nm)).ceil().max(1.0) as usize
}

/// The pupil on a grid of n×n frequencies, those below zero at the end.
fn pupil(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize, n: usize) -> Array2<Complex64> {
    let radius = support as f64 * camera.pixel_pitch_um / (2.0 * wave_um(camera, wavelength_nm));
    let round = Pupil::new(camera, wavelength_nm, psi);
    let terms: Vec<Term> = camera.aberrations.iter().map(Term::new).collect();
    let white_rad = camera.height_map.as_ref().map_or(0.0, |map| map.white_rad(wavelength_nm));
    let reach = (radius.ceil() as isize + 1).min(n as isize / 2 - 1);
    let mut plane = Array2::from_elem((n, n), Complex64::new(0.0, 0.0));
    let index = |q: isize| q.rem_euclid(n as isize) as usize;
    for down in -reach..=reach {
        for across in -reach..=reach {
            let (x, y) = (across as f64 / radius, -down as f64 / radius);
            let (rho, angle) = (x.hypot(y), y.atan2(x));
            let sample = round.sample(rho, 1.0 / radius);
            if sample.norm_sqr() > 0.0 {
                let path_nm: f64 = terms.iter().map(|term| term.at(rho, angle)).sum();
                let surface = camera.height_map.as_ref().map_or(0.0, |map| map.at(x, y)) * white_rad;
                let phase = std::f64::consts::TAU * path_nm / wavelength_nm + surface;
                plane[(index(down), index(across))] = sample * Complex64::cis(phase);
            }
        }
    }
    plane
}

/// One Zernike term, ready to be evaluated.
struct Term {
    rms_nm: f64,
    /// Azimuthal order; of sines where it is below zero.
    m: i32,
    /// Coefficient of each power of the radius.
    radial: Vec<(f64, i32)>,
}

impl Term {
    /// Noll's Z_j = √(n + 1)·R(ρ)·(1, √2·cos mθ for even j, √2·sin mθ for odd j).
    fn new(Aberration { noll, rms_nm }: &Aberration) -> Self {
        let (mut n, mut rest) = (0i32, *noll as i32 - 1);
        while rest > n {
            n += 1;
            rest -= n;
        }
        let order = n % 2 + 2 * ((rest + (n + 1) % 2) / 2);
        let factorial = |k: i32| (1..=k).map(f64::from).product::<f64>();
        let norm = f64::from(n + 1).sqrt() * if order == 0 { 1.0 } else { std::f64::consts::SQRT_2 };
        let coefficient = |k: i32| {
            let below = factorial(k) * factorial((n + order) / 2 - k) * factorial((n - order) / 2 - k);
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            (norm * sign * factorial(n - k) / below, n - 2 * k)
        };
        let m = if noll % 2 == 0 { order } else { -order };
        Self { rms_nm: *rms_nm, m, radial: (0..=(n - order) / 2).map(coefficient).collect() }
    }

    /// Optical path in nanometres; the angle is from the right, upward.
    fn at(&self, rho: f64, angle: f64) -> f64 {
        let radial: f64 = self.radial.iter().map(|&(factor, power)| factor * rho.powi(power)).sum();
        let turn = f64::from(self.m) * angle;
        self.rms_nm * radial * if self.m < 0 { -turn.sin() } else { turn.cos() }
    }
}

/// The forward transform in two dimensions of a square plane.
fn transform(plane: Array2<Complex64>) -> Array2<Complex64> {
    let n = plane.nrows();
    let fft = f64::forward(n);
    let rows = |plane: Array2<Complex64>| {
        let mut data: Vec<Complex64> = plane.iter().copied().collect();
        fft.process(&mut data);
        Array2::from_shape_fn((n, n), |(r, c)| data[c * n + r])
    };
    rows(rows(plane))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::psf::quarter_psf;
    use edof_camera::height_map::HeightMap;

    fn aberrated(noll: u32, rms_nm: f64) -> Camera {
        Camera { aberrations: vec![Aberration { noll, rms_nm }], ..Camera::resolve("clear").unwrap() }
    }

    /// Middle of the light in pixels, down and across.
    fn centroid(psf: &Array2<f64>) -> (f64, f64) {
        let n = psf.nrows() as isize;
        let offset = |i: usize| if 2 * (i as isize) < n { i as f64 } else { i as f64 - n as f64 };
        psf.indexed_iter().fold((0.0, 0.0), |(d, a), ((r, c), v)| (d + v * offset(r), a + v * offset(c)))
    }

    #[test]
    fn without_aberrations_it_is_the_round_lens() {
        for (name, psi) in [("clear", 0.0), ("ring-2018", 5.0)] {
            let camera = Camera::resolve(name).unwrap();
            let (whole, quarter) =
                (whole_psf(&camera, 535.0, psi, 128), quarter_psf(&camera, 535.0, psi, 128));
            assert!((whole.sum() - 1.0).abs() < 1e-9);
            for ((r, c), v) in quarter.indexed_iter() {
                assert!((whole[(r, c)] - v).abs() < 1e-9 && (whole[((128 - r) % 128, c)] - v).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn terms_are_nolls() {
        let value = |noll, rho: f64, angle: f64| Term::new(&Aberration { noll, rms_nm: 1.0 }).at(rho, angle);
        let (rho, angle) = (0.7f64, 0.4f64);
        let known = [
            (2, 2.0 * rho * angle.cos()),
            (3, 2.0 * rho * angle.sin()),
            (4, 3f64.sqrt() * (2.0 * rho.powi(2) - 1.0)),
            (5, 6f64.sqrt() * rho.powi(2) * (2.0 * angle).sin()),
            (6, 6f64.sqrt() * rho.powi(2) * (2.0 * angle).cos()),
            (7, 8f64.sqrt() * (3.0 * rho.powi(3) - 2.0 * rho) * angle.sin()),
            (8, 8f64.sqrt() * (3.0 * rho.powi(3) - 2.0 * rho) * angle.cos()),
            (9, 8f64.sqrt() * rho.powi(3) * (3.0 * angle).sin()),
            (10, 8f64.sqrt() * rho.powi(3) * (3.0 * angle).cos()),
            (11, 5f64.sqrt() * (6.0 * rho.powi(4) - 6.0 * rho.powi(2) + 1.0)),
        ];
        for (noll, expected) in known {
            assert!((value(noll, rho, angle) - expected).abs() < 1e-12, "{noll}");
        }
    }

    #[test]
    fn tilt_moves_the_point_and_coma_smears_it_to_one_side() {
        let (down, across) = centroid(&whole_psf(&aberrated(2, 200.0), 535.0, 0.0, 128));
        assert!(across > 0.5 && down.abs() < 1e-2, "to the right: {down} {across}");
        let (down, across) = centroid(&whole_psf(&aberrated(3, 200.0), 535.0, 0.0, 128));
        assert!(down < -0.5 && across.abs() < 1e-2, "up: {down} {across}");
        let coma = whole_psf(&aberrated(8, 80.0), 535.0, 0.0, 128);
        let lean: f64 = (1..8).map(|c| coma[(0, c)] - coma[(0, 128 - c)]).sum();
        assert!(lean < -0.01, "its tail points to the left: {lean}");
        assert!((1..8).all(|r| (coma[(r, 3)] - coma[(128 - r, 3)]).abs() < 1e-9));
    }

    /// A clear lens with a mask of a surface, heights by place in the aperture, of one wave of 535 nm where it is white.
    fn masked(height: impl Fn(f64, f64) -> f64) -> Camera {
        let side = 512;
        let place = |i: usize| (i as f64 + 0.5) / f64::from(side as u32) * 2.0 - 1.0;
        let heights = Array2::from_shape_fn((side, side), |(r, c)| height(place(c), -place(r)) as f32);
        let mut map = HeightMap {
            file: "mask.png".into(),
            white_um: 1.07,
            cauchy: [1.5, 0.0],
            sha256: String::new(),
            heights: None,
        };
        map.take(heights, "mask.png".into(), "masked").unwrap();
        Camera { height_map: Some(map), ..Camera::resolve("clear").unwrap() }
    }

    fn furthest(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
        let peak = b.iter().fold(0.0f64, |max, v| max.max(*v));
        a.iter().zip(b).fold(0.0f64, |max, (a, b)| max.max((a - b).abs())) / peak
    }

    #[test]
    fn a_surface_of_glass_is_the_wavefront_that_it_makes() {
        let clear = Camera::resolve("clear").unwrap();
        let psf = |camera: &Camera, nm: f64, psi: f64| whole_psf(camera, nm, psi, 128);
        let flat = masked(|_, _| 0.7);
        assert!(furthest(&psf(&flat, 535.0, 3.0), &psf(&clear, 535.0, 3.0)) < 1e-9);
        // A bowl of half a wave at its edge is a defocus of pi there, at every wavelength.
        let bowl = masked(|x, y| 0.5 * (x * x + y * y));
        let psi = std::f64::consts::PI * 535.0 / clear.reference_wavelength_nm * clear.defocus_sign.factor();
        for nm in [460.0, 610.0] {
            assert!(furthest(&psf(&bowl, nm, 1.0), &psf(&clear, nm, 1.0 + psi)) < 1e-2);
        }
        // A wedge of a wave from edge to edge is a tilt of a quarter of that, root mean square.
        let (right, up) = (masked(|x, _| 0.5 * (x + 1.0)), masked(|_, y| 0.5 * (y + 1.0)));
        for (wedge, noll) in [(right, 2), (up, 3)] {
            let expected = psf(&aberrated(noll, 535.0 / 4.0), 535.0, 0.0);
            assert!(furthest(&psf(&wedge, 535.0, 0.0), &expected) < 1e-2, "{noll}");
        }
    }

    #[test]
    fn light_that_a_mask_throws_far_has_room() {
        let support = |camera: &Camera| support(camera, 535.0, 0.0, 256);
        assert_eq!(support(&masked(|x, y| 0.5 * (x * x + y * y))), 256);
        let mut far = masked(|x, _| 0.5 + 0.5 * (6.0 * std::f64::consts::PI * x).cos());
        far.height_map.as_mut().unwrap().white_um = 20.0;
        assert!(support(&far) > 256);
    }

    #[test]
    fn defocus_is_the_same_by_either_name() {
        // Z4 = √3(2ρ² − 1): ψ of phase at the edge is 2√3·2π·rms/λ.
        let rms_nm = 3.0 * 460.0 / (2.0 * 3f64.sqrt() * std::f64::consts::TAU);
        let (a, b) = (
            whole_psf(&aberrated(4, -rms_nm), 460.0, 0.0, 128),
            whole_psf(&Camera::resolve("clear").unwrap(), 460.0, 3.0, 128),
        );
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn squares_hold_what_lies_in_them() {
        let mut plane = Array2::zeros((8, 8));
        (plane[(0, 0)], plane[(7, 1)], plane[(2, 6)], plane[(4, 0)]) = (1.0, 2.0, 4.0, 8.0);
        assert_eq!(square_sums(&plane), [1.0, 3.0, 7.0, 7.0]);
    }
}
