//! Second-order statistics of photographs: how a pixel's colour varies with that of its neighbours. All that a linear estimator
//! knows of the world.

use edof_core::ColourFrame;
use edof_numerics::fft::{Complex64, Real};
use ndarray::{Array2, Axis, s};

/// Side in pixels of the torus on which the statistics live.
pub const SIDE: usize = 128;
const N: usize = SIDE / 2 + 1;

/// Pairs of channels, each once, in the order in which [`Statistics`] holds them.
pub const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Index in [`PAIRS`] of two channels.
#[must_use]
pub const fn pair(a: usize, b: usize) -> usize {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    [0, 2, 3][low] + high
}

/// Power and cross spectra of red, green and blue, even along both axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// For each of `PAIRS` the quarter spectrum, (`SIDE`/2 + 1)²; entry (r, c) at (r, c)/`SIDE` cycles a pixel. The sum over
    /// the whole plane divided by `SIDE`² is the covariance of the two channels at one pixel.
    pub spectra: [Array2<f64>; 6],
}

/// Photographs that tell too little.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("statistics: no photograph of at least {SIDE}x{SIDE} pixels among {0}")]
pub struct TooSmall(usize);

impl Statistics {
    /// The model that needs no files: spectra (f₀ + f)^(−e) for brightness and for two colour differences, where f is the frequency
    /// in a measure whose contours are crosses, because edges are more often level or upright than not. Variances, exponents and
    /// the measure were fitted by eye to 16 training photographs (Kodak's without every third).
    #[must_use]
    pub fn natural() -> Self {
        // Each component's share of red, green and blue, to be scaled to length 1; its variance and exponent.
        let components =
            [([1.0, 1.0, 1.0], NATURAL[0]), ([1.0, 0.0, -1.0], NATURAL[1]), ([1.0, -2.0, 1.0], NATURAL[2])];
        let whole = |plane: &Array2<f64>| -> f64 {
            plane.indexed_iter().map(|((r, c), v)| v * count(r) * count(c)).sum()
        };
        let shapes = components.map(|(axis, (variance, exponent))| {
            let fall = |(r, c): (usize, usize)| {
                let axis = |i: usize| (i as f64 / SIDE as f64).powf(CROSS);
                (LOWEST + (axis(r) + axis(c)).powf(1.0 / CROSS)).powf(-exponent)
            };
            let shape = Array2::from_shape_fn((N, N), fall);
            let sum = whole(&shape);
            let squared: f64 = axis.iter().map(|a| a * a).sum();
            (axis, shape * (variance * (SIDE * SIDE) as f64 / (sum * squared)))
        });
        let spectra = PAIRS.map(|(a, b)| {
            let terms =
                shapes.iter().map(|(axis, shape): &([f64; 3], Array2<f64>)| shape * (axis[a] * axis[b]));
            terms.fold(Array2::zeros((N, N)), |sum, term| sum + term)
        });
        Self { spectra }
    }

    /// The model of black print on white: random square modules of that side in pixels, as in a QR code, of the same light in red, green and blue. A
    /// pixel sees the mean over its square, at any place of the modules' grid.
    ///
    /// # Panics
    /// A side that is not above 0.
    #[must_use]
    pub fn print(module_px: f64) -> Self {
        assert!(module_px > 0.0, "modules of {module_px} pixels");
        let axis: Vec<f64> = (0..N).map(|i| print_power(module_px, i)).collect();
        let variance = (0.5 * (PAPER - INK)).powi(2);
        Self { spectra: PAIRS.map(|_| Array2::from_shape_fn((N, N), |(r, c)| variance * axis[r] * axis[c])) }
    }

    /// Measured on photographs: windowed tiles' cross spectra about the mean colour, averaged.
    ///
    /// # Errors
    /// [`TooSmall`] if no photograph holds a tile.
    pub fn of_photos<'a>(photos: impl Iterator<Item = &'a ColourFrame> + Clone) -> Result<Self, TooSmall> {
        let mut mean = [0.0; 3];
        let mut pixels = 0.0;
        for photo in photos.clone() {
            for (plane, sum) in photo.planes.axis_iter(Axis(0)).zip(&mut mean) {
                *sum += plane.iter().map(|&v| f64::from(v)).sum::<f64>();
            }
            pixels += (photo.size().0 * photo.size().1) as f64;
        }
        let mean = mean.map(|m| m / pixels);
        let hann = |i: usize| (std::f64::consts::PI * (i as f64 + 0.5) / SIDE as f64).sin().powi(2);
        let window = Array2::from_shape_fn((SIDE, SIDE), |(r, c)| hann(r) * hann(c));
        let power = window.iter().map(|w| w * w).sum::<f64>() / (SIDE * SIDE) as f64;
        let mut spectra = PAIRS.map(|_| Array2::<f64>::zeros((N, N)));
        let mut tiles = 0.0;
        for photo in photos.clone() {
            let (height, width) = photo.size();
            for top in (0..(height + 1).saturating_sub(SIDE)).step_by(SIDE / 2) {
                for left in (0..(width + 1).saturating_sub(SIDE)).step_by(SIDE / 2) {
                    let tile = photo.planes.slice(s![.., top..top + SIDE, left..left + SIDE]);
                    let transformed = [0, 1, 2].map(|p| {
                        let plane = tile.index_axis(Axis(0), p);
                        transform(Array2::from_shape_fn((SIDE, SIDE), |at| {
                            (f64::from(plane[at]) - mean[p]) * window[at]
                        }))
                    });
                    for (sum, (a, b)) in spectra.iter_mut().zip(PAIRS) {
                        add_even_part(sum, &transformed[a], &transformed[b]);
                    }
                    tiles += 1.0;
                }
            }
        }
        if tiles == 0.0 {
            return Err(TooSmall(photos.count()));
        }
        let scale = 1.0 / (tiles * power * (SIDE * SIDE) as f64);
        Ok(Self { spectra: spectra.map(|sum| sum * scale) })
    }

    /// Covariance of two channels at one pixel.
    #[must_use]
    pub fn covariance(&self, a: usize, b: usize) -> f64 {
        let plane = &self.spectra[pair(a, b)];
        plane.indexed_iter().map(|((r, c), v)| v * count(r) * count(c)).sum::<f64>() / (SIDE * SIDE) as f64
    }
}

/// Lowest frequency, in cycles a pixel, up to which power rises: photographs are of finite size.
const LOWEST: f64 = 1.0 / 256.0;
/// f is (|f_x|^p + |f_y|^p)^(1/p) with this p.
const CROSS: f64 = 0.7;
/// Variance (full scale 1) and exponent of the spectrum of brightness·√3, red − blue and green − magenta.
const NATURAL: [(f64, f64); 3] = [(0.126, 2.4), (0.0125, 2.8), (0.004, 2.8)];

/// Linear light of white paper.
pub const PAPER: f64 = 0.8;
/// Linear light of black ink.
pub const INK: f64 = 0.04;

/// Power of random modules along one axis at an index of the torus, variance 1 before pixels are seen. Two points covary by the share of places of the grid at
/// which one module holds both; a pixel's square weighs their distances.
fn print_power(module_px: f64, index: usize) -> f64 {
    const FINE: i32 = 32;
    let triangle = |distance: f64, half: f64| (1.0 - distance.abs() / half).max(0.0);
    let covariance = |lag: i32| -> f64 {
        let within = (-FINE..=FINE).map(|i| f64::from(i) / f64::from(FINE));
        let weighed = within.map(|d| triangle(d, 1.0) * triangle(f64::from(lag) + d, module_px));
        weighed.sum::<f64>() / f64::from(FINE)
    };
    let far = (module_px + 1.0).ceil().min((SIDE / 2) as f64) as i32;
    let turn = |lag: i32| (std::f64::consts::TAU * index as f64 * f64::from(lag) / SIDE as f64).cos();
    (-far..=far).map(|lag| covariance(lag) * turn(lag)).sum()
}

/// How often a quarter's entry stands in the whole plane, along one axis.
const fn count(index: usize) -> f64 {
    if index == 0 || index == N - 1 { 1.0 } else { 2.0 }
}

fn transform(plane: Array2<f64>) -> Array2<Complex64> {
    let fft = f64::forward(SIDE);
    let mut data: Vec<Complex64> = plane.iter().map(|&v| Complex64::new(v, 0.0)).collect();
    fft.process(&mut data);
    let half_way = Array2::from_shape_fn((SIDE, SIDE), |(r, c)| data[c * SIDE + r]);
    let mut data: Vec<Complex64> = half_way.iter().copied().collect();
    fft.process(&mut data);
    Array2::from_shape_fn((SIDE, SIDE), |(r, c)| data[c * SIDE + r])
}

/// Adds the mean of Re(a·b*) over the four mirror images of each frequency.
fn add_even_part(sum: &mut Array2<f64>, a: &Array2<Complex64>, b: &Array2<Complex64>) {
    let product = |r: usize, c: usize| (a[(r, c)] * b[(r, c)].conj()).re;
    for ((r, c), v) in sum.indexed_iter_mut() {
        // Those two of the four that are not conjugates of the others.
        *v += 0.5 * (product(r, c) + product(r, (SIDE - c) % SIDE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_found_in_either_order() {
        for (i, (a, b)) in PAIRS.into_iter().enumerate() {
            assert_eq!((pair(a, b), pair(b, a)), (i, i));
        }
    }

    #[test]
    fn white_noise_has_a_flat_spectrum_of_its_variance() {
        use rand::{RngExt, SeedableRng};
        let mut generator = rand_pcg::Pcg64::seed_from_u64(1);
        let mut noise = ColourFrame::zeros(512, 512);
        noise.planes.mapv_inplace(|_| generator.random::<f32>());
        let statistics = Statistics::of_photos([&noise].into_iter()).unwrap();
        assert!((statistics.covariance(1, 1) * 12.0 - 1.0).abs() < 0.02);
        assert!(statistics.covariance(0, 2).abs() < 0.002);
        let low = statistics.spectra[0].slice(s![2..30, 2..30]).mean().unwrap();
        let high = statistics.spectra[0].slice(s![30..60, 30..60]).mean().unwrap();
        assert!((low / high - 1.0).abs() < 0.05, "{low} {high}");
    }

    /// The 16 training photographs' red and green correlate by 0.83, red and blue by 0.73, green's variance is 0.050.
    #[test]
    fn the_natural_model_varies_as_photographs_do_and_falls_with_frequency() {
        let model = Statistics::natural();
        let correlation =
            |a, b| model.covariance(a, b) / (model.covariance(a, a) * model.covariance(b, b)).sqrt();
        assert!((correlation(0, 1) - 0.83).abs() < 0.06, "{}", correlation(0, 1));
        assert!((correlation(0, 2) - 0.73).abs() < 0.05, "{}", correlation(0, 2));
        assert!((model.covariance(1, 1) - 0.050).abs() < 0.01, "{}", model.covariance(1, 1));
        assert!(model.spectra[0][(0, 40)] < 0.1 * model.spectra[0][(0, 10)]);
    }

    #[test]
    fn print_varies_as_random_modules_do() {
        use rand::{RngExt, SeedableRng};
        // Modules of 2.625 pixels, which lie at many places of the grid of pixels; eight samples along each side of a pixel.
        let (side, fine, module) = (512, 8, 21);
        let mut generator = rand_pcg::Pcg64::seed_from_u64(1);
        let modules =
            Array2::from_shape_simple_fn((side * fine / module + 1, side * fine / module + 1), || {
                if generator.random::<bool>() { PAPER } else { INK }
            });
        let mut print = ColourFrame::zeros(side, side);
        for ((_, r, c), v) in print.planes.indexed_iter_mut() {
            let samples = (0..fine * fine).map(|i| {
                let (row, column) = (fine * r + i / fine, fine * c + i % fine);
                modules[(row / module, column / module)]
            });
            *v = (samples.sum::<f64>() / (fine * fine) as f64) as f32;
        }
        let (model, measured) =
            (Statistics::print(2.625), Statistics::of_photos([&print].into_iter()).unwrap());
        let ratio = measured.covariance(0, 0) / model.covariance(0, 0);
        assert!((ratio - 1.0).abs() < 0.03 && model.covariance(0, 2) == model.covariance(0, 0), "{ratio}");
        // Of bands of frequencies, since single ones are random.
        for (low, high) in [(2, 12), (12, 25), (25, 40), (40, 64)] {
            let band = |of: &Statistics| of.spectra[0].slice(s![low..high, low..high]).sum();
            let ratio = band(&measured) / band(&model);
            assert!((ratio - 1.0).abs() < 0.1, "{low} to {high}: {ratio}");
        }
    }

    #[test]
    fn photographs_smaller_than_a_tile_are_rejected() {
        let small = ColourFrame::zeros(100, 200);
        let error = Statistics::of_photos([&small].into_iter()).unwrap_err();
        assert_eq!(error.to_string(), "statistics: no photograph of at least 128x128 pixels among 1");
    }
}
