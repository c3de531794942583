//! An ideal lens behind a Bayer sensor: every frequency, colour and depth has a complex transfer of its own, free but for the limits that bind
//! every pupil: its mean square over the depths, and the clear pupil's contrast in focus at each.
//!
//! No such lens need exist, so what it reaches limits every lens. Because frequencies alias, the problem is not convex: it is solved by gradient
//! steps from several starts, and the best is a limit that is believed, not proven. For three full planes [`super::ceiling`] has a proof.

use super::transfer::Transfer;
use super::wiener::{Base, Seen, alias, bases, colour, share, spectrum_at, variance, wiener_map};
use super::{GRID, decibels};
use crate::statistics::pair;
use edof_numerics::fft::Complex64;
use ndarray::Array2;
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;

/// Depths of the ideal lens.
const DEPTHS: usize = 5;
/// Steps from each start, and the length of each.
const STEPS: usize = 90;
const STEP: f64 = 0.04;
/// Starts: all depths alike but for a little noise; each colour sharp at a depth of its own.
const STARTS: [Start; 2] = [Start { spread: 0.05, apart: false }, Start { spread: 0.2, apart: true }];

#[derive(Debug, Clone, Copy)]
struct Start {
    spread: f64,
    apart: bool,
}

/// Limits of the transfer: root mean square over depths, and at any depth; red, green and blue.
#[derive(Debug, Clone)]
pub struct Limits {
    /// Root of the limit of the mean square.
    pub mean: Transfer,
    /// In focus.
    pub each: Transfer,
}

/// Transfers of the twelve unknown numbers of a base frequency: colour by alias.
type Row = [[Complex64; 4]; 3];

/// One base frequency of the ideal lens.
struct Ideal {
    base: Base,
    mean: [[f64; 4]; 3],
    each: [[f64; 4]; 3],
    /// Spectra of the pairs of colours at each alias.
    spectra: [[[f64; 4]; 3]; 3],
    transfer: [Row; DEPTHS],
    /// Running means of Adam.
    slope: [Row; DEPTHS],
    power: [[[f64; 4]; 3]; DEPTHS],
}

/// Returns the PSNR in dB, averaged over depths, of the ideal lens that knows the depth.
#[must_use]
pub fn average_db(limits: &Limits, spectra: &[Array2<f64>; 6], noise: f64) -> f64 {
    let solved =
        STARTS.iter().enumerate().map(|(seed, start)| solve(limits, spectra, noise, *start, seed as u64));
    solved.fold(f64::NEG_INFINITY, f64::max)
}

fn solve(limits: &Limits, spectra: &[Array2<f64>; 6], noise: f64, start: Start, seed: u64) -> f64 {
    let mut ideal = ideal(limits, spectra, start, seed);
    let (variance, scale) = (variance(spectra), 1.0 / (3 * GRID * GRID) as f64);
    let mut best = f64::NEG_INFINITY;
    let mut weights = [1.0; DEPTHS];
    for step in 1..=STEPS {
        let explained: Vec<[f64; DEPTHS]> =
            ideal.par_iter_mut().map(|one| one.step(noise, &weights, step)).collect();
        let errors: [f64; DEPTHS] =
            std::array::from_fn(|d| variance - scale * explained.iter().map(|e| e[d]).sum::<f64>());
        best = best.max(errors.iter().map(|e| decibels(*e)).sum::<f64>() / DEPTHS as f64);
        // The derivative of decibels by an error: smaller errors count more.
        let mean = errors.iter().sum::<f64>() / DEPTHS as f64;
        weights = errors.map(|e| mean / e);
    }
    best
}

fn ideal(limits: &Limits, spectra: &[Array2<f64>; 6], start: Start, seed: u64) -> Vec<Ideal> {
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    let sharp_at = |c: usize, d: usize| match start.apart {
        true if d == c * (DEPTHS - 1) / 2 => 2.0,
        true => 0.3,
        false => 1.0,
    };
    let ideal = |base: Base| {
        let at = |k| alias((base.row, base.column), k);
        let limit = |plane: &Transfer| [0, 1, 2].map(|c| [0, 1, 2, 3].map(|k| plane[c][at(k)].re));
        let (mean, each) = (limit(&limits.mean), limit(&limits.each));
        let spectra = [0, 1, 2]
            .map(|a| [0, 1, 2].map(|b| [0, 1, 2, 3].map(|k| spectrum_at(&spectra[pair(a, b)], at(k)))));
        let mut noise = || start.spread * 2.0 * (random.random::<f64>() - 0.5) * 3.0f64.sqrt();
        let transfer = std::array::from_fn(|d| {
            [0, 1, 2].map(|c| mean[c].map(|mean| Complex64::new(sharp_at(c, d) + noise(), noise()) * mean))
        });
        let zero = [[[Complex64::default(); 4]; 3]; DEPTHS];
        let mut one =
            Ideal { base, mean, each, spectra, transfer, slope: zero, power: [[[0.0; 4]; 3]; DEPTHS] };
        one.project(true);
        one
    };
    bases(GRID / 2, true).into_iter().map(ideal).collect()
}

impl Ideal {
    /// What is explained at each depth; then a step of Adam along its gradient, and back within the limits.
    fn step(&mut self, noise: f64, weights: &[f64; DEPTHS], step: usize) -> [f64; DEPTHS] {
        let (a, b) = (0.9f64, 0.99f64);
        let done = [1.0 - a.powi(step as i32), 1.0 - b.powi(step as i32)];
        let mut explained = [0.0; DEPTHS];
        for d in 0..DEPTHS {
            let (value, slope) = self.gradient(&self.transfer[d], noise);
            explained[d] = value * self.base.count;
            for c in 0..3 {
                for k in 0..4 {
                    let slope = slope[c][k] * weights[d];
                    let (mean, power) = (&mut self.slope[d][c][k], &mut self.power[d][c][k]);
                    *mean = *mean * a + slope * (1.0 - a);
                    *power = *power * b + slope.norm_sqr() * (1.0 - b);
                    let length = (*power / done[1]).sqrt() + 1e-30;
                    self.transfer[d][c][k] += *mean / done[0] / length * (STEP * self.mean[c][k]);
                }
            }
        }
        self.project(false);
        explained
    }

    /// Scales transfers that are beyond their mean square back to it (`fully`: also those below it up), then cuts those beyond the contrast in focus.
    fn project(&mut self, fully: bool) {
        for c in 0..3 {
            for k in 0..4 {
                let power =
                    (0..DEPTHS).map(|d| self.transfer[d][c][k].norm_sqr()).sum::<f64>() / DEPTHS as f64;
                let scale = self.mean[c][k] / power.sqrt().max(1e-30);
                let scale = if fully { scale } else { scale.min(1.0) };
                for d in 0..DEPTHS {
                    let v = &mut self.transfer[d][c][k];
                    *v *= scale;
                    *v *= (self.each[c][k] / v.norm().max(1e-30)).min(1.0);
                }
            }
        }
    }

    /// What an estimate explains of this frequency's variance, and its gradient by the transfers: with the map W held, the error's derivative by
    /// A is −2·Wᴴ·(1 − W·A)·S.
    #[allow(clippy::needless_range_loop, reason = "indices are those of the formulas")]
    fn gradient(&self, transfer: &Row, noise: f64) -> (f64, Row) {
        let seen = self.seen(transfer);
        let map = wiener_map(&seen, noise);
        let explained =
            map.iter().flatten().zip(seen.xy.iter().flatten()).map(|(w, x)| (w * x.conj()).re).sum();
        // (1 − W·A)·S is Σ − W·C_yx, with rows (colour, alias) and columns alike; of its columns only those of one alias meet.
        let slope_at = |c: usize, k: usize| -> Complex64 {
            let column = 4 * c + k;
            let of_place = |p: usize| -> Complex64 {
                let term = |(row, w): (usize, &[Complex64; 4])| {
                    let sharp = if row % 4 == k { self.spectra[row / 4][c][k] } else { 0.0 };
                    let estimated: Complex64 = (0..4).map(|q| w[q] * seen.xy[column][q].conj()).sum();
                    w[p].conj() * (sharp - estimated)
                };
                map.iter().enumerate().map(term).sum::<Complex64>() * share(p, k)
            };
            (0..4).filter(|p| colour(*p) == c).map(of_place).sum()
        };
        let slope = [0, 1, 2].map(|c| [0, 1, 2, 3].map(|k| slope_at(c, k)));
        (explained, slope)
    }

    #[allow(clippy::needless_range_loop, reason = "indices are those of the formulas")]
    fn seen(&self, transfer: &Row) -> Seen<4, 12> {
        let zero = Complex64::default();
        let mut seen = Seen { yy: [[zero; 4]; 4], xy: [[zero; 4]; 12] };
        for k in [0, 1, 2, 3] {
            let a = [0, 1, 2, 3].map(|p| transfer[colour(p)][k] * share(p, k));
            for p in 0..4 {
                for q in 0..4 {
                    seen.yy[p][q] += a[p] * a[q].conj() * self.spectra[colour(p)][colour(q)][k];
                }
                for c in 0..3 {
                    seen.xy[4 * c + k][p] = a[p].conj() * self.spectra[c][colour(p)][k];
                }
            }
        }
        seen
    }
}
