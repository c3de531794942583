//! A ring of constant phase.

use super::glass::{etched_rad, is_glass};
use super::phase::{
    Change, Function, MAX_HEIGHT_UM, MAX_RAD, Parameter, PhaseTerm, Symmetry, WAVELENGTH_NM, Wrong,
};
use crate::words::{number, numbers};
use serde::{Deserialize, Serialize};

/// A ring of the mask between two normalised pupil radii.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Inner radius, 0…1.
    pub inner: f64,
    /// Outer radius, 0…1.
    pub outer: f64,
    /// What the ring does to the phase.
    pub delay: Delay,
}

/// Phase delay of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delay {
    /// Stated as a phase: at λ it is `rad`·`at_nm`/λ.
    Phase {
        /// Radians.
        rad: f64,
        /// Wavelength in nanometres for which they are stated.
        at_nm: f64,
    },
    /// Etched height: the phase is 2π·height·(n(λ) − 1)/λ.
    Etched {
        /// Height in micrometres.
        height_um: f64,
        /// n(λ) = `cauchy[0]` + `cauchy[1]`/λ² with λ in micrometres.
        cauchy: [f64; 2],
    },
}

impl Delay {
    /// Returns the phase in radians at a wavelength.
    #[must_use]
    pub fn phase_rad(self, nm: f64) -> f64 {
        match self {
            Self::Phase { rad, at_nm } => rad * at_nm / nm,
            Self::Etched { height_um, cauchy } => etched_rad(height_um, cauchy, nm),
        }
    }

    /// Returns the delay of a phase at a wavelength, of the same kind: an etched ring keeps its glass and changes its height.
    fn with_phase(self, rad: f64, at_nm: f64) -> Self {
        match self {
            Self::Phase { .. } => Self::Phase { rad, at_nm },
            Self::Etched { cauchy, .. } => {
                let height_um = rad / etched_rad(1.0, cauchy, at_nm);
                Self::Etched { height_um: height_um.clamp(-MAX_HEIGHT_UM, MAX_HEIGHT_UM), cauchy }
            }
        }
    }

    fn check(self) -> Result<(), Wrong> {
        let (is_possible, value, expected) = match self {
            Self::Phase { rad, at_nm } => (
                rad.abs() <= MAX_RAD && WAVELENGTH_NM.contains(&at_nm),
                format!("a phase of {} rad at {} nm", number(rad), number(at_nm)),
                "at most 10000 rad either way, at 100 to 30000 nm",
            ),
            Self::Etched { height_um, cauchy } => (
                height_um.abs() <= MAX_HEIGHT_UM && is_glass(cauchy),
                format!("etched {} um deep in glass of {}", number(height_um), numbers(&cauchy)),
                "at most 100 um either way, in glass of [0.1 to 10, -10 to 10]",
            ),
        };
        if is_possible { Ok(()) } else { Err(Wrong { field: "rings", value, expected }) }
    }
}

impl PhaseTerm for Ring {
    fn what(&self) -> &'static str {
        "rings"
    }

    fn weaker(&self) -> Option<&'static str> {
        None
    }

    fn check(&self) -> Result<(), Wrong> {
        if !(0.0 <= self.inner && self.inner < self.outer && self.outer <= 1.0) {
            let value = format!("{} to {}", number(self.inner), number(self.outer));
            return Err(Wrong { field: "rings", value, expected: "0 <= inner < outer <= 1" });
        }
        self.delay.check()
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::Round
    }

    fn phase_at(&self, nm: f64) -> Function<'_, f64> {
        let rad = self.delay.phase_rad(nm);
        Box::new(move |at| if self.inner < at.rho && at.rho < self.outer { rad } else { 0.0 })
    }

    fn slope_at(&self, _: f64) -> Function<'_, [f64; 2]> {
        Box::new(|_| [0.0; 2])
    }

    fn largest_slope(&self, _: f64) -> Option<f64> {
        Some(0.0)
    }

    fn jumps(&self) -> Vec<f64> {
        vec![self.inner, self.outer]
    }

    /// Inner radius, outer radius, phase. At the aperture's rim the derivative is that for a radius that shrinks.
    fn parameters(&self, nm: f64) -> Vec<Parameter> {
        let [inner, outer] = [self.inner, self.outer].map(Parameter::Radius);
        vec![inner, outer, Parameter::Phase(self.delay.phase_rad(nm))]
    }

    fn change(&self, parameter: usize, nm: f64, stated_nm: f64) -> Change<'_> {
        let Self { inner, outer, delay } = *self;
        match parameter {
            0 => Change::Edge { radius: inner, is_inside: false },
            1 => Change::Edge { radius: outer, is_inside: true },
            _ => {
                let rad = match delay {
                    Delay::Phase { .. } => stated_nm / nm,
                    Delay::Etched { cauchy, .. } => {
                        etched_rad(1.0, cauchy, nm) / etched_rad(1.0, cauchy, stated_nm)
                    }
                };
                Change::Zone { inner, outer, rad }
            }
        }
    }

    fn set(&mut self, values: &[f64], nm: f64) {
        (self.inner, self.outer) = (values[0], values[1]);
        self.delay = self.delay.with_phase(values[2], nm);
    }

    fn objection(&self, nm: f64) -> Option<&'static str> {
        match self.delay {
            Delay::Etched { cauchy, .. } if etched_rad(1.0, cauchy, nm) == 0.0 => {
                Some("an etched ring of index 1, whose height changes no phase")
            }
            _ => None,
        }
    }

    fn summary(&self, nm: f64) -> String {
        format!("ring {:.4} to {:.4} of {:.3} rad", self.inner, self.outer, self.delay.phase_rad(nm))
    }

    fn scale(&mut self, factor: f64) {
        match &mut self.delay {
            Delay::Phase { rad: depth, .. } | Delay::Etched { height_um: depth, .. } => *depth *= factor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_etched_ring_has_the_phase_of_its_height() {
        let delay = Delay::Etched { height_um: 0.46, cauchy: [1.5, 0.0] };
        assert!((delay.phase_rad(460.0) - std::f64::consts::PI).abs() < 1e-9);
    }
}
