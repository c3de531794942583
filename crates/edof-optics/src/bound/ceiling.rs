//! What no lens passes over a range of depths in a light, in dB.
//!
//! The contrast limit of [`super::pupil`], folded as pixels fold it, is turned into decibels. The error of an estimate from three full planes is a
//! log-convex function of the squared contrasts, so by Jensen's inequality neither the average in dB nor the worst depth passes that of a lens
//! with the limit's contrast at every depth: that is proven for Gaussian pictures. Behind a mosaic [`super::relaxed`] has the number. A lens whose
//! contrast is the same at every depth needs no depth, so the limits hold for blind estimates, too.

use super::lenses::closed;
use super::relaxed::{self, Limits};
use super::transfer::channel_wavelengths;
use super::wiener::{Bayer, Planes, View, spectra};
use super::{GRID, Light, decibels, pupil};
use crate::statistics::Statistics;
use edof_core::Channel;
use edof_core::camera::Camera;
use edof_numerics::fft::Complex64;
use edof_numerics::sinc;
use ndarray::{Array1, Array2};
use rayon::prelude::*;

/// Frequencies of the table of the limit: to half of the cut-off, and beyond.
const TABLE: [usize; 2] = [35, 20];
/// Aliases that fold onto a frequency, either way.
const ALIASES: isize = 2;

/// What no lens passes, in dB: limits of the average over depths and of the worst depth alike.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Ceiling {
    /// From three full planes of colour: proven for Gaussian pictures.
    pub planes_db: f64,
    /// Behind a Bayer mosaic: the relaxed problem, solved numerically.
    pub bayer_db: f64,
}

/// Returns the limits for each light behind the camera's aperture closed by `stops`. Its mask and focus do not count. Closing an aperture further takes
/// light and contrast away, so that smaller ones have lower limits.
#[must_use]
pub fn ceilings(camera: &Camera, lights: &[Light], stops: f64, statistics: &Statistics) -> Vec<Ceiling> {
    let spectra = spectra(statistics);
    let limits = limits(&closed(camera, stops));
    let flat = std::slice::from_ref(&limits.mean);
    let planes = View::new::<Planes>(&spectra, flat, true);
    let bayer = View::new::<Bayer>(&spectra, flat, true);
    let ceiling = |light: &Light| {
        let noise = light.variance(stops);
        let [planes_db, flat_db] = [planes.errors(noise), bayer.errors(noise)].map(|e| decibels(e.known[0]));
        Ceiling { planes_db, bayer_db: flat_db.max(relaxed::average_db(&limits, &spectra, noise)) }
    };
    lights.iter().map(ceiling).collect()
}

/// Returns the limits of the transfer of lens and pixel, with the camera's range and aperture.
#[must_use]
pub fn limits(camera: &Camera) -> Limits {
    let width = camera.psi_range[1] - camera.psi_range[0];
    let planes = |width: f64| Channel::ALL.map(|channel| folded(camera, channel, width));
    Limits { mean: planes(width), each: planes(0.0) }
}

/// Root of the limit of a channel's mean squared transfer over a range of ψ of that width: the triangle inequality over aliases and wavelengths.
fn folded(camera: &Camera, channel: Channel, width: f64) -> Array2<Complex64> {
    let lines = channel_wavelengths(camera, channel);
    let share = 1.0 / lines.len() as f64;
    let mut sum = Array2::<f64>::zeros((GRID, GRID));
    for nm in lines {
        let table = Table::new(width * camera.reference_wavelength_nm / nm);
        let per_cycle = 2.0 * camera.wave_um(nm) / camera.pixel_pitch_um;
        sum += &(Array2::from_shape_fn((GRID, GRID), |(r, c)| table.folded(r, c, per_cycle)) * share);
    }
    sum.mapv(|v| Complex64::new(v.min(1.0), 0.0))
}

/// Root of the limit over the spatial frequency, for one width of range.
struct Table {
    s: Array1<f64>,
    root: Vec<f64>,
}

impl Table {
    fn new(width: f64) -> Self {
        let [low, high] = TABLE;
        let s =
            |i: usize| if i <= low { i as f64 / low as f64 } else { 1.0 + (i - low) as f64 / high as f64 };
        let s: Array1<f64> = (0..=low + high).map(s).collect();
        let root = |&s: &f64| {
            let square =
                if width > 0.0 { pupil::mean_square(s, width) } else { pupil::diffraction(s).powi(2) };
            square.sqrt()
        };
        let root = s.as_slice().unwrap_or(&[]).par_iter().map(root).collect();
        Self { s, root }
    }

    fn at(&self, s: f64) -> f64 {
        let after = self.s.iter().position(|known| *known > s).unwrap_or(0);
        if after == 0 {
            return 0.0;
        }
        let part = (s - self.s[after - 1]) / (self.s[after] - self.s[after - 1]);
        self.root[after - 1] + part * (self.root[after] - self.root[after - 1])
    }

    fn folded(&self, r: usize, c: usize, per_cycle: f64) -> f64 {
        let frequency = |i: usize| if 2 * i < GRID { i as f64 } else { i as f64 - GRID as f64 } / GRID as f64;
        let (down, across) = (frequency(r), frequency(c));
        let aliases =
            (-ALIASES..=ALIASES).flat_map(|i| (-ALIASES..=ALIASES).map(move |j| (i as f64, j as f64)));
        aliases
            .map(|(i, j)| {
                let (down, across) = (down + i, across + j);
                (sinc(down) * sinc(across)).abs() * self.at(down.hypot(across) * per_cycle)
            })
            .sum()
    }
}
