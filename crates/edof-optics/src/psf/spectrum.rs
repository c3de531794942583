//! The wavelengths that a colour's spectrum is sampled at, and the sum of what they give.

use super::settings::Settings;
use edof_core::camera::Spectrum;
use ndarray::Array2;

/// The most wavelengths a channel is sampled at.
const MAX_WAVELENGTHS: usize = 27;

/// PSF of a spectrum: as many wavelengths as the tolerance needs, tripled until the PSF no longer moves. `at` gives that of one
/// wavelength, `light` the sum over a plane.
pub fn summed(
    spectrum: &Spectrum,
    settings: &Settings,
    at: impl Fn(f64) -> Array2<f64>,
    light: impl Fn(&Array2<f64>) -> f64,
) -> (Array2<f64>, Vec<f64>, f64) {
    let (mut nodes, mut error) = (wavelengths(spectrum, 1), 0.0);
    let mut mean = at(nodes[0]);
    if !has_width(spectrum) {
        return (mean, nodes, error);
    }
    while nodes.len() < MAX_WAVELENGTHS {
        // The nodes of a third of the count are every third of these from the second on, so their sum is not done again.
        let finer = wavelengths(spectrum, 3 * nodes.len());
        let mut sum = &mean * nodes.len() as f64;
        finer.iter().enumerate().filter(|(i, _)| i % 3 != 1).for_each(|(_, &nm)| sum += &at(nm));
        let next = sum / finer.len() as f64;
        error = light(&(&next - &mean).mapv(f64::abs)) / 2.0;
        (nodes, mean) = (finer, next);
        if settings.cuts_wavelengths() && error <= settings.wavelength_tolerance {
            break;
        }
    }
    (mean, nodes, error)
}

fn has_width(spectrum: &Spectrum) -> bool {
    matches!(spectrum, Spectrum::Sampled(pairs) if pairs.iter().filter(|[_, w]| *w > 0.0).count() > 0 && pairs.len() > 1)
}

/// `count` wavelengths (nm), each standing for an equal part of the spectrum's light: the middles of its quantiles.
#[must_use]
pub fn wavelengths(spectrum: &Spectrum, count: usize) -> Vec<f64> {
    let pairs = match spectrum {
        Spectrum::Line(nm) => return vec![*nm; count],
        Spectrum::Sampled(pairs) if pairs.len() < 2 => {
            return vec![pairs.first().map_or(550.0, |p| p[0]); count];
        }
        Spectrum::Sampled(pairs) => pairs,
    };
    let areas: Vec<f64> = pairs.windows(2).map(|p| 0.5 * (p[0][1] + p[1][1]) * (p[1][0] - p[0][0])).collect();
    let total: f64 = areas.iter().sum();
    let quantile = |share: f64| {
        let mut left = share * total;
        let last = areas.len() - 1;
        let segment = areas.iter().position(|area| {
            let inside = left <= *area;
            if !inside {
                left -= area;
            }
            inside
        });
        let [[from, a], [to, b]] = [pairs[segment.unwrap_or(last)], pairs[segment.unwrap_or(last) + 1]];
        // The light up to a part t of the segment is (to − from)·(a·t + (b − a)·t²/2); solved for t without dividing by b − a.
        let light = left / (to - from);
        let root = (a * a + 2.0 * (b - a) * light).max(0.0).sqrt();
        let t = if a + root > 0.0 { 2.0 * light / (a + root) } else { 0.5 };
        from + t.clamp(0.0, 1.0) * (to - from)
    };
    (0..count).map(|i| quantile((i as f64 + 0.5) / count as f64)).collect()
}
