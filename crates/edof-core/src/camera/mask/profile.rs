//! A phase that changes smoothly with the radius.

use super::phase::{Function, MAX_RAD, PhaseTerm, Symmetry, WAVELENGTH_NM, Wrong};
use crate::words::number;
use serde::{Deserialize, Serialize};

/// Most points of a profile.
const MAX_POINTS: usize = 4096;

/// Phase of a rotationally symmetric mask over the normalised pupil radius, linear between its points and constant beyond them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Wavelength in nanometres for which the phase is stated; at λ it is `at_nm`/λ of it.
    pub at_nm: f64,
    /// Pairs of radius 0…1, ascending, and radians.
    pub points: Vec<[f64; 2]>,
}

impl Profile {
    /// The points before and after a radius.
    fn around(&self, rho: f64) -> (Option<[f64; 2]>, Option<[f64; 2]>) {
        let after = self.points.partition_point(|point| point[0] < rho);
        (after.checked_sub(1).map(|i| self.points[i]), self.points.get(after).copied())
    }

    /// Returns the phase in radians at a radius and a wavelength.
    #[must_use]
    pub fn phase_rad(&self, rho: f64, nm: f64) -> f64 {
        let rad = match self.around(rho) {
            (Some([r0, a]), Some([r1, b])) => a + (b - a) * (rho - r0) / (r1 - r0),
            (Some([_, end]), None) | (None, Some([_, end])) => end,
            (None, None) => 0.0,
        };
        rad * self.at_nm / nm
    }
}

impl PhaseTerm for Profile {
    fn what(&self) -> &'static str {
        "a profile"
    }

    fn weaker(&self) -> Option<&'static str> {
        Some("a weaker profile")
    }

    fn check(&self) -> Result<(), Wrong> {
        let Self { at_nm, points } = self;
        let is_possible = points.iter().all(|point| point[1].abs() <= MAX_RAD);
        let is_inside = points.iter().all(|point| (0.0..=1.0).contains(&point[0]));
        let is_ascending = points.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        let is_sized = (1..=MAX_POINTS).contains(&points.len()) && WAVELENGTH_NM.contains(at_nm);
        if is_possible && is_inside && is_ascending && is_sized {
            return Ok(());
        }
        Err(Wrong {
            field: "profile",
            value: format!("{} points at {} nm", points.len(), number(*at_nm)),
            expected: "1 to 4096 [radius 0 to 1, radians] pairs of ascending radius and at most 10000 rad, at 100 to 30000 nm",
        })
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Round
    }

    fn phase_at(&self, nm: f64) -> Function<'_, f64> {
        Box::new(move |at| self.phase_rad(at.rho, nm))
    }

    fn slope_at(&self, nm: f64) -> Function<'_, [f64; 2]> {
        Box::new(move |at| match self.around(at.rho) {
            (Some([r0, a]), Some([r1, b])) => [(b - a) / (r1 - r0) * self.at_nm / nm, 0.0],
            _ => [0.0; 2],
        })
    }

    fn largest_slope(&self, nm: f64) -> Option<f64> {
        let slopes = self.points.windows(2).map(|p| ((p[1][1] - p[0][1]) / (p[1][0] - p[0][0])).abs());
        Some(slopes.fold(0.0, f64::max) * self.at_nm / nm)
    }

    fn kinks(&self) -> Vec<f64> {
        self.points.iter().map(|point| point[0]).collect()
    }

    fn scale(&mut self, factor: f64) {
        self.points.iter_mut().for_each(|point| point[1] *= factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_is_linear_between_its_points_and_scales_with_the_wavelength() {
        let profile = Profile { at_nm: 500.0, points: vec![[0.2, 1.0], [0.6, 3.0]] };
        let phases = [0.0, 0.2, 0.4, 0.6, 1.0].map(|rho| profile.phase_rad(rho, 500.0));
        assert!(
            phases.iter().zip([1.0, 1.0, 2.0, 3.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-12),
            "{phases:?}"
        );
        assert!((profile.phase_rad(0.4, 1000.0) - 1.0).abs() < 1e-12);
    }
}
