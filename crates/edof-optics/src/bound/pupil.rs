//! The most contrast that any pupil keeps on average over a range of depths.
//!
//! The OTF at a spatial frequency s (the cut-off is 2) and a defocus ψ is ∫ P(x + s/2)·P*(x − s/2)·exp(2iψ s·x) dx over the pupil's overlap with
//! itself, divided by its area. Summed across s it is ∫ g(t)·exp(2iψst) dt, and |g(t)| is at most the overlap's width w(t), whatever the mask.
//! Three limits of the mean of |OTF|² over a range of ψ of width Ψ follow, and the least of them counts (cf. Levin et al. 2009):
//!
//! - none: the contrast of the clear pupil in focus, squared ([`diffraction`]);
//! - Parseval: the sum over all ψ is ∫ w², so the mean is at most π·∫ w² dt/(s·Ψ·π²) ([`parseval`]);
//! - duality: the mean is g*·K·g with K the kernel of the range. For any weights d > 0 let c be the largest eigenvalue of d^−½·K·d^−½;
//!   then c·diag(d) − K has no negative one, so g*·K·g ≤ c·Σ d·w² ([`dual`]).

use ndarray::{Array1, Array2};

/// Points along half of the overlap.
const POINTS: usize = 30;
/// Doublings of the power by which the largest eigenvalue is bounded.
const DOUBLINGS: usize = 10;

/// Returns the OTF of the clear pupil in focus.
#[must_use]
pub fn diffraction(s: f64) -> f64 {
    let half = (0.5 * s).clamp(0.0, 1.0);
    std::f64::consts::FRAC_2_PI * (half.acos() - half * (1.0 - half * half).sqrt())
}

/// Returns the limit by Parseval's theorem: all light's contrast inside the range.
#[must_use]
pub fn parseval(s: f64, width: f64) -> f64 {
    let half = 0.5 * s;
    if half >= 1.0 {
        return 0.0;
    }
    let squared_widths = 8.0 * ((1.0 - half) - (1.0 - half.powi(3)) / 3.0);
    squared_widths / (std::f64::consts::PI * s * width)
}

/// Returns the least known limit of the mean of |OTF|² over a range of ψ of that width, for any pupil. ψ and `s` are those of the aperture
/// and wavelength in use.
#[must_use]
pub fn mean_square(s: f64, width: f64) -> f64 {
    if s <= 0.0 {
        return 1.0;
    }
    diffraction(s).powi(2).min(parseval(s, width)).min(dual(s, width))
}

/// Returns the limit by duality, with weights found by a few multiplicative steps. Every set of weights gives a limit; better ones a lower one.
#[must_use]
pub fn dual(s: f64, width: f64) -> f64 {
    if s >= 2.0 {
        return 0.0;
    }
    let problem = Dual::new(s, width);
    let w = &problem.widths;
    let mut starts: Vec<Array1<f64>> =
        [0.0, 0.25, 0.5, 0.75, 1.0].map(|power| w.mapv(|w| w.powf(-power))).to_vec();
    starts.extend([0.0, 0.5, 1.0].map(|power| problem.kernel_over(&w.mapv(|w| w.powf(power)))));
    let solved = starts.into_iter().map(|d| (problem.limit(&d), d));
    let Some((mut best, mut d)) = solved.min_by(|a, b| a.0.value.total_cmp(&b.0.value)) else {
        return f64::INFINITY;
    };
    for step in [0.3, 0.15, 0.08] {
        for _ in 0..6 {
            // At the optimum the worst g reaches its width everywhere: weights grow where it is beyond.
            let reach = &best.worst / w;
            let mean = reach.sum() / reach.len() as f64;
            let next = &d * &reach.mapv(|v| (v / mean).max(1e-3).powf(step));
            let found = problem.limit(&next);
            if found.value >= best.value {
                break;
            }
            (best, d) = (found, next);
        }
    }
    best.value
}

/// The dual problem at one frequency. The kernel is the mean over depths of outer products of waves; those even about the middle of the overlap
/// and the odd ones do not mix, so that each half is a small matrix: depths × depths.
struct Dual {
    /// Overlap's width at points t > 0.
    widths: Array1<f64>,
    /// Even and odd waves: depths × points, scaled so that the kernel of either is AᵀA.
    waves: [Array2<f64>; 2],
}

/// A limit, and |g| of the worst pupil by it.
struct Limit {
    value: f64,
    worst: Array1<f64>,
}

impl Dual {
    fn new(s: f64, width: f64) -> Self {
        let half = 1.0 - 0.5 * s;
        let step = half / POINTS as f64;
        let t = Array1::from_shape_fn(POINTS, |i| (i as f64 + 0.5) * step);
        let widths = t.mapv(|t| 2.0 * (1.0 - (t + 0.5 * s).powi(2)).max(1e-12).sqrt());
        // Over t + t' the phase turns by at most Ψ·s·(2 − s).
        let (nodes, weights) = gauss_legendre(8 + (0.25 * width * s * (2.0 - s)).ceil() as usize);
        let wave = |shape: fn(f64) -> f64| {
            Array2::from_shape_fn((nodes.len(), POINTS), |(j, i)| {
                (2.0 * weights[j]).sqrt() * step / std::f64::consts::PI * shape(width * nodes[j] * s * t[i])
            })
        };
        Self { widths, waves: [wave(f64::cos), wave(f64::sin)] }
    }

    /// Weights |K|·v/v of the even kernel, at least a thousandth of their largest.
    fn kernel_over(&self, v: &Array1<f64>) -> Array1<f64> {
        let even = &self.waves[0];
        let d = even.t().dot(&even.dot(v)).mapv(f64::abs) / v;
        let least = 1e-3 * d.iter().copied().fold(0.0, f64::max);
        d.mapv(|d| d.max(least))
    }

    fn limit(&self, d: &Array1<f64>) -> Limit {
        let halves = self.waves.each_ref().map(|waves| {
            let scaled = waves / &d.mapv(f64::sqrt);
            let (eigenvalue, vector) = largest(&scaled.dot(&scaled.t()));
            (eigenvalue, scaled.t().dot(&vector) / d.mapv(f64::sqrt))
        });
        let [even, odd] = halves;
        let (eigenvalue, worst) = if even.0 >= odd.0 { even } else { odd };
        let weighted = 2.0 * (d * &self.widths * &self.widths).sum();
        Limit { value: eigenvalue * weighted, worst: worst.mapv(f64::abs) }
    }
}

/// Returns an upper bound of the largest eigenvalue λ of a matrix without negative ones, less than 0.4 % above it, and its vector:
/// λ^p ≤ tr(Aᵖ) with p = 2^[`DOUBLINGS`].
fn largest(matrix: &Array2<f64>) -> (f64, Array1<f64>) {
    let mut power = matrix.clone();
    // ln of the factor that was taken out of the power.
    let mut log = 0.0;
    for _ in 0..DOUBLINGS {
        let trace = power.diag().sum().max(f64::MIN_POSITIVE);
        power /= trace;
        log = 2.0 * (log + trace.ln());
        power = power.dot(&power);
    }
    let exponent = (1_u32 << DOUBLINGS) as f64;
    let diagonal = power.diag();
    let value = ((log + diagonal.sum().max(f64::MIN_POSITIVE).ln()) / exponent).exp();
    let column = (0..diagonal.len()).max_by(|&a, &b| diagonal[a].total_cmp(&diagonal[b])).unwrap_or(0);
    (value, power.column(column).to_owned())
}

/// Returns nodes in 0…1 and weights, which sum to 1, of Gauss and Legendre's quadrature.
fn gauss_legendre(count: usize) -> (Vec<f64>, Vec<f64>) {
    let node = |index: usize| {
        let mut x = (std::f64::consts::PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=count {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = count as f64 * (x * value - before) / (x * x - 1.0);
            let step = value / slope;
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(node).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::psf::otf_along_row;
    use edof_core::camera::Camera;

    /// The clear pupil's squared OTF by Hopkins' integral, the mean of 201 depths over a range about focus, both ends among them.
    fn clear(s: f64, width: f64) -> f64 {
        let (depths, points) = (201, 2001);
        let half = 1.0 - 0.5 * s;
        let otf = |psi: f64| {
            let term = |i: usize| {
                let t = half * (2.0 * (i as f64 + 0.5) / points as f64 - 1.0);
                2.0 * (1.0 - (t.abs() + 0.5 * s).powi(2)).max(0.0).sqrt() * (2.0 * psi * s * t).cos()
            };
            (0..points).map(term).sum::<f64>() * 2.0 * half / points as f64 / std::f64::consts::PI
        };
        let psi = |i: usize| width * (i as f64 / (depths - 1) as f64 - 0.5);
        (0..depths).map(|i| otf(psi(i)).powi(2)).sum::<f64>() / depths as f64
    }

    #[test]
    fn the_clear_lens_has_nearly_all_of_the_limit_in_every_range() {
        // Blue at the Nyquist frequency; the numbers are those of docs/results/bound.md.
        assert!((clear(0.533, 8.0) - 0.2358).abs() < 5e-4, "{}", clear(0.533, 8.0));
        assert!((mean_square(0.533, 8.0) - 0.2370).abs() < 5e-4, "{}", mean_square(0.533, 8.0));
        for width in [4.0, 8.0, 16.0] {
            for s in [0.2, 0.533, 0.75] {
                let (clear, limit) = (clear(s, width), mean_square(s, width));
                assert!(clear <= limit && clear > 0.985 * limit, "s {s}, width {width}: {clear} of {limit}");
            }
        }
    }

    #[test]
    fn no_mask_of_the_program_keeps_more_than_the_limit() {
        for name in ["clear-mid", "ring-outer", "ring-2018", "ring-2015", "ring-depth-2018"] {
            let camera = Camera::resolve(name).unwrap();
            let support = 256;
            let cutoff = camera.pixel_pitch_um / camera.wave_um(460.0);
            let otfs: Vec<_> =
                (0..=40).map(|i| otf_along_row(&camera, 460.0, 0.2 * f64::from(i), support)).collect();
            for q in [16, 48, 80, 128, 192] {
                // The trapezoidal rule over the range.
                let squared =
                    |i: usize| otfs[i][q] * otfs[i][q] * if i.is_multiple_of(40) { 0.5 } else { 1.0 };
                let mean = (0..=40).map(squared).sum::<f64>() / 40.0;
                let limit = mean_square(2.0 * q as f64 / support as f64 / cutoff, 8.0);
                // The sampled pupil's OTF is off by half a percent.
                assert!(mean < 1.01 * limit, "{name} at {q}: {mean} of {limit}");
            }
        }
    }

    #[test]
    fn a_narrow_range_is_limited_by_diffraction_and_a_wide_one_by_parseval() {
        assert!((mean_square(0.5, 1e-3) - diffraction(0.5).powi(2)).abs() < 1e-3);
        assert!(mean_square(0.5, 80.0) <= parseval(0.5, 80.0));
        assert!(mean_square(0.5, 80.0) > 0.95 * parseval(0.5, 80.0));
        assert_eq!((mean_square(0.0, 8.0), mean_square(2.0, 8.0)), (1.0, 0.0));
    }

    #[test]
    fn the_largest_eigenvalue_is_never_below_and_hardly_above() {
        let matrix = ndarray::array![[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
        let (value, _) = largest(&matrix);
        assert!((3.0..3.0 * 1.001).contains(&value), "{value}");
        let (nodes, weights) = gauss_legendre(9);
        let integral: f64 = nodes.iter().zip(&weights).map(|(x, w)| w * (20.0 * x).cos()).sum();
        assert!((integral - 20.0f64.sin() / 20.0).abs() < 1e-3, "{integral}");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
