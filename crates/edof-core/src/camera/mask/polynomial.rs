//! A polynomial of the place in the aperture: cubic masks and their kin.

use super::glass::{etched_rad, is_glass};
use super::phase::{Change, Function, MAX_RAD, Parameter, PhaseTerm, Place, Symmetry, WAVELENGTH_NM, Wrong};
use crate::words::{number, numbers};
use serde::{Deserialize, Serialize};

/// The highest order, and the least difference of a glass's index from air's.
const MAX_ORDER: u32 = 5;
const MIN_CONTRAST: f64 = 1e-3;

/// Phase of a mask whose surface is a polynomial: Σ `rad`·x^`x`·y^`y`, the place in units of the aperture's radius, to the right and upward.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polynomial {
    /// Wavelength in nanometres for which the phase is stated.
    pub at_nm: f64,
    /// Glass of the surface: n(λ) = `cauchy[0]` + `cauchy[1]`/λ² with λ in micrometres. A height h delays light by 2π·h·(n(λ) − 1)/λ, so the
    /// phase at λ is that of `at_nm` times (n(λ) − 1)/λ over the same at `at_nm`. Without it n is constant: the phase is `at_nm`/λ of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cauchy: Option<[f64; 2]>,
    /// The products of powers.
    pub terms: Vec<Monomial>,
}

/// A product of powers of the place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Monomial {
    /// Power of the distance to the right.
    pub x: u32,
    /// Power of the distance upward.
    pub y: u32,
    /// Coefficient in radians.
    pub rad: f64,
}

impl Monomial {
    fn at(self, Place { x, y, .. }: Place) -> f64 {
        x.powi(self.x as i32) * y.powi(self.y as i32)
    }

    /// Derivatives to the right and upward.
    fn gradient(self, Place { x, y, .. }: Place) -> [f64; 2] {
        let power =
            |v: f64, power: u32| if power == 0 { 0.0 } else { f64::from(power) * v.powi(power as i32 - 1) };
        [power(x, self.x) * y.powi(self.y as i32), x.powi(self.x as i32) * power(y, self.y)]
    }

    /// A bound of the gradient's magnitude inside of the aperture, where no coordinate exceeds 1.
    fn steepest(self) -> f64 {
        f64::from(self.x).hypot(self.y.into())
    }
}

impl Polynomial {
    /// Phase at a wavelength for each radian that is stated.
    fn factor(&self, nm: f64) -> f64 {
        match self.cauchy {
            None => self.at_nm / nm,
            Some(cauchy) => etched_rad(1.0, cauchy, nm) / etched_rad(1.0, cauchy, self.at_nm),
        }
    }

    fn check_glass(&self) -> Result<(), Wrong> {
        let Some(cauchy) = self.cauchy else { return Ok(()) };
        let waves = etched_rad(1.0, cauchy, self.at_nm) * self.at_nm * 1e-3 / std::f64::consts::TAU;
        if is_glass(cauchy) && waves.abs() >= MIN_CONTRAST {
            return Ok(());
        }
        Err(Wrong {
            field: "mask.polynomial.cauchy",
            value: format!("[{}]", numbers(&cauchy)),
            expected: "[0.1 to 10, -10 to 10], with an index at at_nm that differs from 1 by 0.001 or more",
        })
    }
}

impl PhaseTerm for Polynomial {
    fn what(&self) -> &'static str {
        "a polynomial mask"
    }

    fn weaker(&self) -> Option<&'static str> {
        Some("a weaker polynomial")
    }

    fn check(&self) -> Result<(), Wrong> {
        if !WAVELENGTH_NM.contains(&self.at_nm) {
            let (value, expected) = (number(self.at_nm), "a wavelength of 100 to 30000 nm");
            return Err(Wrong { field: "mask.polynomial.at_nm", value, expected });
        }
        self.check_glass()?;
        if self.terms.is_empty() {
            let (value, expected) = (
                "empty".to_owned(),
                "one product of powers at least, as in {\"x\": 3, \"y\": 0, \"rad\": 2.3}",
            );
            return Err(Wrong { field: "mask.polynomial.terms", value, expected });
        }
        for (index, &Monomial { x, y, rad }) in self.terms.iter().enumerate() {
            let is_new = self.terms[..index].iter().all(|earlier| (earlier.x, earlier.y) != (x, y));
            let is_order = x.checked_add(y).is_some_and(|order| (1..=MAX_ORDER).contains(&order));
            if !(is_new && is_order && rad.abs() <= MAX_RAD) {
                return Err(Wrong {
                    field: "mask.polynomial.terms",
                    value: format!("x^{x} y^{y} of {} rad", number(rad)),
                    expected: "each pair of powers once, 1 to 5 in sum, of at most 10000 rad either way",
                });
            }
        }
        Ok(())
    }

    fn symmetry(&self) -> Symmetry {
        Symmetry::None
    }

    fn phase_at(&self, nm: f64) -> Function<'_, f64> {
        let factor = self.factor(nm);
        Box::new(move |at| factor * self.terms.iter().map(|term| term.rad * term.at(at)).sum::<f64>())
    }

    fn slope_at(&self, nm: f64) -> Function<'_, [f64; 2]> {
        let factor = self.factor(nm);
        Box::new(move |at| {
            let [right, up] = self.terms.iter().fold([0.0; 2], |sum, term| {
                let [right, up] = term.gradient(at).map(|slope| factor * term.rad * slope);
                [sum[0] + right, sum[1] + up]
            });
            match at.rho {
                0.0 => [right, up],
                rho => [(at.x * right + at.y * up) / rho, (at.x * up - at.y * right) / rho],
            }
        })
    }

    fn largest_slope(&self, nm: f64) -> Option<f64> {
        let steepest = self.terms.iter().map(|term| term.rad.abs() * term.steepest());
        Some(steepest.sum::<f64>() * self.factor(nm).abs())
    }

    fn parameters(&self, nm: f64) -> Vec<Parameter> {
        self.terms.iter().map(|term| Parameter::Phase(term.rad * self.factor(nm))).collect()
    }

    fn change(&self, parameter: usize, nm: f64, stated_nm: f64) -> Change<'_> {
        let (term, factor) = (self.terms[parameter], self.factor(nm) / self.factor(stated_nm));
        Change::Smooth(Box::new(move |at| factor * term.at(at)))
    }

    fn set(&mut self, values: &[f64], nm: f64) {
        let factor = self.factor(nm);
        self.terms.iter_mut().zip(values).for_each(|(term, value)| term.rad = value / factor);
    }

    fn objection(&self, nm: f64) -> Option<&'static str> {
        (self.factor(nm) == 0.0).then_some("a polynomial mask of index 1, whose height changes no phase")
    }

    fn summary(&self, nm: f64) -> String {
        let factor = self.factor(nm);
        let term = |t: &Monomial| format!("{:.3} x^{} y^{}", t.rad * factor, t.x, t.y);
        format!("polynomial {} rad", self.terms.iter().map(term).collect::<Vec<_>>().join(" + "))
    }

    fn scale(&mut self, factor: f64) {
        self.terms.iter_mut().for_each(|term| term.rad *= factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The weak cubic of the design notes, and one of order 5.
    fn polynomial(cauchy: Option<[f64; 2]>) -> Polynomial {
        let terms = [(3, 0, 2.3), (0, 3, 2.3), (2, 1, 0.2), (1, 2, 0.2), (4, 1, -2.2), (2, 3, 3.3)];
        let terms = terms.into_iter().map(|(x, y, rad)| Monomial { x, y, rad }).collect();
        Polynomial { at_nm: 460.0, cauchy, terms }
    }

    #[test]
    fn the_phase_is_that_of_a_thin_glass_of_its_height() {
        let cauchy = [1.458, 0.00354];
        let at = Place::new(0.6, -0.3);
        let stated = polynomial(Some(cauchy)).phase_at(460.0)(at);
        assert!(
            (stated - (2.3 * (0.216 - 0.027) + 0.2 * (-0.108 + 0.054) - 2.2 * -0.03888 + 3.3 * -0.00972))
                .abs()
                < 1e-9
        );
        // 2π(n − 1)h/λ, with the height from the phase at 460 nm.
        let n = |nm: f64| cauchy[0] + cauchy[1] * 1e6 / (nm * nm);
        let height_nm = stated * 460.0 / (std::f64::consts::TAU * (n(460.0) - 1.0));
        let expected = std::f64::consts::TAU * (n(610.0) - 1.0) * height_nm / 610.0;
        assert!((polynomial(Some(cauchy)).phase_at(610.0)(at) - expected).abs() < 1e-9);
        assert!((polynomial(None).phase_at(610.0)(at) - stated * 460.0 / 610.0).abs() < 1e-9);
    }

    #[test]
    fn slopes_are_those_of_the_phase_and_never_beyond_the_bound() {
        let polynomial = polynomial(None);
        let (phase, slope) = (polynomial.phase_at(535.0), polynomial.slope_at(535.0));
        let bound = polynomial.largest_slope(535.0).unwrap();
        for step in 0..400 {
            let (rho, angle) = (f64::from(step % 20 + 1) / 20.0, f64::from(step / 20) * 0.33);
            let [outward, around] = slope(Place::polar(rho, angle));
            let at = |rho: f64, angle: f64| phase(Place::polar(rho, angle));
            assert!(((at(rho + 1e-6, angle) - at(rho - 1e-6, angle)) / 2e-6 - outward).abs() < 1e-6);
            assert!(((at(rho, angle + 1e-6) - at(rho, angle - 1e-6)) / 2e-6 - around * rho).abs() < 1e-6);
            assert!(outward.hypot(around) <= bound);
        }
        let [right, up] = slope(Place::new(0.0, 0.0));
        assert_eq!((right, up), (0.0, 0.0));
    }

    #[test]
    fn what_cannot_be_computed_is_rejected_with_its_field() {
        let wrong = |change: fn(&mut Polynomial)| {
            let mut polynomial = polynomial(Some([1.458, 0.00354]));
            change(&mut polynomial);
            let Wrong { field, value, expected } = polynomial.check().unwrap_err();
            format!("{field} is {value}, expected {expected}")
        };
        assert!(polynomial(None).check().is_ok() && polynomial(Some([1.458, 0.00354])).check().is_ok());
        assert_eq!(
            wrong(|p| p.at_nm = 5.0),
            "mask.polynomial.at_nm is 5, expected a wavelength of 100 to 30000 nm"
        );
        assert!(
            wrong(|p| p.cauchy = Some([1.0, 0.0])).starts_with("mask.polynomial.cauchy is [1, 0], expected")
        );
        assert!(wrong(|p| p.terms.clear()).starts_with("mask.polynomial.terms is empty"));
        let terms: [fn(&mut Polynomial); 5] = [
            |p| p.terms[0].x = 6,
            |p| (p.terms[0].x, p.terms[0].y) = (0, 0),
            |p| p.terms[0].x = u32::MAX,
            |p| p.terms[0].rad = f64::NAN,
            |p| p.terms[1] = p.terms[0],
        ];
        for change in terms {
            assert!(
                wrong(change).contains("expected each pair of powers once, 1 to 5 in sum"),
                "{}",
                wrong(change)
            );
        }
        assert!(
            wrong(|p| p.terms[0].rad = 1e5).starts_with("mask.polynomial.terms is x^3 y^0 of 100000 rad")
        );
    }
}
