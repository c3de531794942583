//! Glass: what a height of it does to light.

/// Returns the phase in radians that glass of a height in micrometres adds to air at a wavelength: 2π·height·(n(λ) − 1)/λ, with
/// n(λ) = `cauchy[0]` + `cauchy[1]`/λ², λ in micrometres.
#[must_use]
pub fn etched_rad(height_um: f64, [a, b]: [f64; 2], nm: f64) -> f64 {
    let um = nm * 1e-3;
    std::f64::consts::TAU * height_um * (a + b / (um * um) - 1.0) / um
}

/// Whether n(λ) can be a material's.
pub fn is_glass([constant, slope]: [f64; 2]) -> bool {
    (0.1..=10.0).contains(&constant) && slope.abs() <= 10.0
}
