//! Zernike polynomials: aberrations of a lens, or a mask that is stated by them.

use super::phase::{Function, PhaseTerm, Place, Symmetry, Wrong};
use crate::words::number;
use serde::{Deserialize, Serialize};
use std::f64::consts::{SQRT_2, TAU};

/// The largest of Noll's indices that is taken, and the largest path in nanometres.
const MAX_NOLL: u32 = 66;
const MAX_RMS_NM: f64 = 10_000.0;

/// A sum of Zernike polynomials.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Zernike(pub Vec<Aberration>);

/// A Zernike polynomial of the wavefront in Noll's order and normalisation (Noll 1976), over the aperture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aberration {
    /// Noll's index: 2 and 3 tilt, 4 defocus, 5 and 6 astigmatism, 7 and 8 coma, 9 and 10 trefoil, 11 spherical, ….
    pub noll: u32,
    /// Root mean square of the optical path in nanometres; its sign is the term's.
    pub rms_nm: f64,
}

impl Zernike {
    /// Whether there is no polynomial.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn polynomials(&self) -> Vec<Polynomial> {
        self.0.iter().map(Polynomial::new).collect()
    }
}

impl PhaseTerm for Zernike {
    fn what(&self) -> &'static str {
        "aberrations"
    }

    fn weaker(&self) -> Option<&'static str> {
        Some("weaker aberrations")
    }

    fn check(&self) -> Result<(), Wrong> {
        let is_wrong = |a: &&Aberration| {
            !((2..=MAX_NOLL).contains(&a.noll) && a.rms_nm.is_finite() && a.rms_nm.abs() <= MAX_RMS_NM)
        };
        self.0.iter().find(is_wrong).map_or(Ok(()), |Aberration { noll, rms_nm }| {
            Err(Wrong {
                field: "mask",
                value: format!("noll {noll} of {} nm", number(*rms_nm)),
                expected: "Noll's indices 2 to 66, and at most 10000 nm either way",
            })
        })
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::None
    }

    fn phase_at(&self, nm: f64) -> Function<'_, f64> {
        let polynomials = self.polynomials();
        Box::new(move |at| {
            let angle = at.y.atan2(at.x);
            let path_nm: f64 = polynomials.iter().map(|polynomial| polynomial.at(at.rho, angle)).sum();
            TAU * path_nm / nm
        })
    }

    fn slope_at(&self, nm: f64) -> Function<'_, [f64; 2]> {
        let polynomials = self.polynomials();
        Box::new(move |Place { x, y, rho }| {
            let angle = y.atan2(x);
            polynomials.iter().fold([0.0; 2], |sum, polynomial| {
                let [outward, around] = polynomial.slope(rho, angle);
                [sum[0] + TAU * outward / nm, sum[1] + TAU * around / nm]
            })
        })
    }

    fn largest_slope(&self, nm: f64) -> Option<f64> {
        Some(self.polynomials().iter().map(Polynomial::largest_slope).sum::<f64>() * TAU / nm)
    }

    fn scale(&mut self, factor: f64) {
        self.0.iter_mut().for_each(|aberration| aberration.rms_nm *= factor);
    }
}

/// One polynomial, ready to be evaluated.
struct Polynomial {
    rms_nm: f64,
    /// Azimuthal order; of sines where it is below zero.
    m: i32,
    /// Coefficient of each power of the radius.
    radial: Vec<(f64, i32)>,
}

impl Polynomial {
    /// Noll's Z_j = √(n + 1)·R(ρ)·(1, √2·cos mθ for even j, √2·sin mθ for odd j).
    fn new(Aberration { noll, rms_nm }: &Aberration) -> Self {
        let (mut n, mut rest) = (0i32, *noll as i32 - 1);
        while rest > n {
            n += 1;
            rest -= n;
        }
        let order = n % 2 + 2 * ((rest + (n + 1) % 2) / 2);
        let factorial = |k: i32| (1..=k).map(f64::from).product::<f64>();
        let norm = f64::from(n + 1).sqrt() * if order == 0 { 1.0 } else { SQRT_2 };
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

    /// Slope of the path in nanometres per radius of the aperture, outward and around.
    fn slope(&self, rho: f64, angle: f64) -> [f64; 2] {
        let m = f64::from(self.m);
        let (sine, cosine) = (m * angle).sin_cos();
        let (wave, turned) = if self.m < 0 { (-sine, -cosine) } else { (cosine, -sine) };
        let [mut outward, mut around] = [0.0; 2];
        for &(factor, power) in self.radial.iter().filter(|(_, power)| *power > 0) {
            let value = factor * rho.powi(power - 1);
            outward += f64::from(power) * value * wave;
            around += m * value * turned;
        }
        [self.rms_nm * outward, self.rms_nm * around]
    }

    /// A bound of the slope's magnitude: every power of the radius at its steepest.
    fn largest_slope(&self) -> f64 {
        let steepest = |&(factor, power): &(f64, i32)| factor.abs() * f64::from(power);
        self.rms_nm.abs() * self.radial.iter().map(steepest).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_nolls() {
        let value = |noll, rho: f64, angle: f64| {
            Zernike(vec![Aberration { noll, rms_nm: 1.0 }]).phase_at(TAU)(Place::polar(rho, angle))
        };
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
}
