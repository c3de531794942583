//! What everything else asks of a term of a mask: phase, symmetry, slope, parameters and derivatives.

use std::ops::RangeInclusive;

/// Wavelengths of light in nanometres, from ultraviolet to thermal infrared.
pub const WAVELENGTH_NM: RangeInclusive<f64> = 100.0..=30_000.0;
/// Most phase of a mask either way, in radians.
pub const MAX_RAD: f64 = 10_000.0;
/// Most height of a mask either way, in micrometres.
pub const MAX_HEIGHT_UM: f64 = 100.0;

/// A place in the aperture, in units of the aperture's radius, seen as the raw frame is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Distance to the right of the centre.
    pub x: f64,
    /// Distance above the centre.
    pub y: f64,
    /// Distance from the centre.
    pub rho: f64,
}

impl Place {
    /// The place at a distance to the right and upward.
    #[must_use]
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, y, rho: x.hypot(y) }
    }

    /// The place at a distance from the centre, in the direction of an angle from the right, upward.
    #[must_use]
    pub fn polar(rho: f64, angle: f64) -> Self {
        Self { x: rho * angle.cos(), y: rho * angle.sin(), rho }
    }
}

/// What leaves a phase as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// Any turn: the phase depends on the radius alone, so that PSFs are round.
    Round,
    /// Nothing that could be relied on: PSFs may have any shape.
    None,
}

/// A number at each place of the aperture.
pub type Function<'a, T> = Box<dyn Fn(Place) -> T + Send + Sync + 'a>;

/// A number of a term that a search may change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Parameter {
    /// A radius, as a share of the aperture's.
    Radius(f64),
    /// A phase in radians.
    Phase(f64),
}

impl Parameter {
    /// The number.
    #[must_use]
    pub const fn value(self) -> f64 {
        match self {
            Self::Radius(value) | Self::Phase(value) => value,
        }
    }
}

/// How a term's phase changes with one of its parameters.
pub enum Change<'a> {
    /// The derivative at each place, of a phase without jumps.
    Smooth(Function<'a, f64>),
    /// The derivative is `rad` between two radii and 0 elsewhere.
    Zone {
        /// Inner radius.
        inner: f64,
        /// Outer radius.
        outer: f64,
        /// The derivative.
        rad: f64,
    },
    /// An edge at which the phase jumps moves outward.
    Edge {
        /// Radius of the edge.
        radius: f64,
        /// Whether the term has its phase on the edge's inner side; else on its outer side.
        is_inside: bool,
    },
}

/// A number of a term that is out of range: the field of the camera file, what it is and what was expected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wrong {
    /// The field.
    pub field: &'static str,
    /// What the file has.
    pub value: String,
    /// What it could have.
    pub expected: &'static str,
}

/// A term of a mask or of a lens's wavefront. Phases of terms add. Wavelengths are in nanometres, phases in radians.
pub trait PhaseTerm {
    /// What a camera with this term has, as in "a height map".
    fn what(&self) -> &'static str;

    /// What would throw light less far, as in "a smoother height map"; none for a term that diffracts only.
    fn weaker(&self) -> Option<&'static str>;

    /// # Errors
    /// The first number that is out of range.
    fn check(&self) -> Result<(), Wrong>;

    /// Returns what leaves the phase as it is.
    fn symmetry(&self) -> Symmetry;

    /// Returns the phase at a wavelength.
    fn phase_at(&self, nm: f64) -> Function<'_, f64>;

    /// Returns the phase's slope at a wavelength in radians per radius of the aperture, outward and around; 0 where
    /// [`PhaseTerm::largest_slope`] is none. Jumps have no slope.
    fn slope_at(&self, nm: f64) -> Function<'_, [f64; 2]>;

    /// Returns a bound of the slope's magnitude at a wavelength; it bounds how far light is thrown. None where only a measurement tells.
    fn largest_slope(&self, nm: f64) -> Option<f64>;

    /// Returns radii at which the phase jumps; between them it is constant. Only round terms have any.
    fn jumps(&self) -> Vec<f64> {
        vec![]
    }

    /// Returns radii, ascending, at which the slope of a round term jumps.
    fn kinks(&self) -> Vec<f64> {
        vec![]
    }

    /// Returns the numbers that a search may change, phases at a wavelength.
    fn parameters(&self, _nm: f64) -> Vec<Parameter> {
        vec![]
    }

    /// Returns how the phase at `nm` changes with one of [`PhaseTerm::parameters`], which are stated at `stated_nm`.
    fn change(&self, _parameter: usize, _nm: f64, _stated_nm: f64) -> Change<'_> {
        Change::Smooth(Box::new(|_| 0.0))
    }

    /// Sets all of [`PhaseTerm::parameters`].
    fn set(&mut self, _values: &[f64], _nm: f64) {}

    /// Returns why the parameters cannot change the phase at a wavelength, as in "an etched ring of index 1, …".
    fn objection(&self, _nm: f64) -> Option<&'static str> {
        None
    }

    /// Returns the term with its parameters in a few words.
    fn summary(&self, _nm: f64) -> String {
        self.what().to_owned()
    }

    /// Multiplies the phase, as too deep an etch does.
    fn scale(&mut self, factor: f64);
}
