//! The transfer of lens and pixel on the torus of [`GRID`] pixels: what the sensor's samples keep of each spatial frequency, aliases folded in.

use super::GRID;
use crate::psf::{pixel_transfer, wavelengths, whole_psf};
use edof_core::Channel;
use edof_core::camera::{Camera, Spectrum, Symmetry};
use edof_numerics::fft::{Complex64, Real};
use ndarray::{Array2, Axis, s};
use rayon::prelude::*;

/// Wavelengths that stand for a channel with a spectrum.
const WAVELENGTHS: usize = 3;

/// Returns the wavelengths by which a channel is judged, each with an equal share.
#[must_use]
pub fn channel_wavelengths(camera: &Camera, channel: Channel) -> Vec<f64> {
    match camera.spectrum(channel) {
        Spectrum::Line(nm) => vec![*nm],
        spectrum @ Spectrum::Sampled(_) => wavelengths(spectrum, WAVELENGTHS),
    }
}

/// Complex transfer of red, green and blue at one depth: [`GRID`]², entry (r, c) at (r, c)/[`GRID`] cycles per pixel.
pub type Transfer = [Array2<Complex64>; 3];

/// Fineness of the sampled pupil: the side in pixels of the support on the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// For searches; a quarter of the time.
    Coarse,
    /// For results.
    Fine,
}

impl Sampling {
    const fn support(self) -> usize {
        match self {
            Self::Coarse => GRID,
            Self::Fine => 2 * GRID,
        }
    }
}

/// Returns the transfers of a camera without PSFs of its own at each depth.
#[must_use]
pub fn transfers(camera: &Camera, psis: &[f64], sampling: Sampling) -> Vec<Transfer> {
    let transfer = |&psi: &f64| Channel::ALL.map(|channel| of_channel(camera, channel, psi, sampling));
    psis.par_iter().map(transfer).collect()
}

fn of_channel(camera: &Camera, channel: Channel, psi: f64, sampling: Sampling) -> Array2<Complex64> {
    let lines = channel_wavelengths(camera, channel);
    let share = 1.0 / lines.len() as f64;
    let planes = lines.iter().map(|&nm| of_line(camera, nm, psi, sampling.support()).mapv(|v| v * share));
    planes.reduce(|sum, plane| sum + plane).unwrap_or_default()
}

fn of_line(camera: &Camera, nm: f64, psi: f64, support: usize) -> Array2<Complex64> {
    if camera.symmetry() == Symmetry::Round {
        let step = (support / GRID) as isize;
        let quarter = pixel_transfer(camera, nm, psi, support);
        let at = |i: usize| i.min(GRID - i) * step as usize;
        return Array2::from_shape_fn((GRID, GRID), |(r, c)| Complex64::new(quarter[(at(r), at(c))], 0.0));
    }
    let psf = whole_psf(camera, nm, psi, support);
    let mut folded = Array2::from_elem((GRID, GRID), Complex64::default());
    for rows in psf.axis_chunks_iter(Axis(0), GRID) {
        for first in (0..support).step_by(GRID) {
            folded.zip_mut_with(&rows.slice(s![.., first..first + GRID]), |sum, v| sum.re += v);
        }
    }
    transformed(folded)
}

/// Returns the Fourier transform of a plane of [`GRID`]² numbers.
pub(super) fn transformed(mut plane: Array2<Complex64>) -> Array2<Complex64> {
    let side = plane.nrows();
    let fft = f64::forward(side);
    for _ in 0..2 {
        let mut lines: Vec<Complex64> = plane.t().iter().copied().collect();
        fft.process(&mut lines);
        plane = Array2::from_shape_fn((side, side), |(r, c)| lines[r * side + c]);
    }
    plane
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::{Aberration, Zernike};

    #[test]
    fn a_lens_has_one_transfer_whether_or_not_it_is_taken_for_round() {
        let round = Camera::resolve("ring-outer").unwrap();
        let none = Zernike(vec![Aberration { noll: 5, rms_nm: 0.0 }]);
        let whole = Camera { aberrations: none, ..round.clone() };
        assert_eq!(whole.symmetry(), Symmetry::None);
        for sampling in [Sampling::Coarse, Sampling::Fine] {
            let [a, b] = [&round, &whole].map(|camera| transfers(camera, &[1.0, 6.0], sampling));
            for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-9));
            }
        }
    }

    #[test]
    fn light_that_leans_to_the_right_has_the_phase_of_its_place() {
        let coma = Camera {
            aberrations: Zernike(vec![Aberration { noll: 2, rms_nm: 120.0 }]),
            ..Camera::resolve("clear-mid").unwrap()
        };
        let [_, green, _] = &transfers(&coma, &[4.0], Sampling::Fine)[0];
        // A tilt moves the PSF along a row: the phase is linear in the frequency along it and absent across.
        let (one, two) = (green[(0, 1)].arg(), green[(0, 2)].arg());
        assert!(one.abs() > 0.05 && (two - 2.0 * one).abs() < 0.01, "{one} {two}");
        assert!(green[(1, 0)].arg().abs() < 1e-6 && (green[(0, 0)] - 1.0).norm() < 1e-9);
    }
}
