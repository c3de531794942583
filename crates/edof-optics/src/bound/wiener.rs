//! The error of the best linear estimate of a colour picture from a sensor's samples, frequency by frequency.
//!
//! With x the sharp picture's spectra and y = A·x + noise the measured ones, the map of least mean square error is W = C_xy·(C_yy + v)⁻¹. Its
//! error is tr(C_xx) − 2·tr(W·C_yx) + tr(W·(C_yy + v)·Wᴴ). An estimate that knows the depth has a map for each; a blind one has a single map,
//! of the covariances' means over the depths.
//!
//! A Bayer mosaic folds four frequencies of each colour onto each other: four measured numbers, one for each place of the mosaic, of twelve
//! unknown ones. Three full planes measure three numbers of three. Both are exact; nothing is said of windows.

use super::GRID;
use super::transfer::Transfer;
use crate::statistics::{SIDE, Statistics, pair};
use edof_core::camera::{Camera, Symmetry};
use edof_numerics::fft::Complex64;
use ndarray::Array2;
use rayon::prelude::*;

const ZERO: Complex64 = Complex64::new(0.0, 0.0);
/// Aliases of a base frequency in halves of the sampling frequency, and offsets of the mosaic's places in pixels: down, across.
const PLACES: [(usize, usize); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];
/// Plane that each place of the mosaic measures.
const COLOURS: [usize; 4] = [0, 1, 1, 2];

/// Returns the spectra of the pairs of channels on the torus of [`GRID`] pixels, its upper left quarter: finer frequencies are summed about each.
#[must_use]
pub fn spectra(statistics: &Statistics) -> [Array2<f64>; 6] {
    let step = SIDE / GRID;
    let reach = (step / 2) as isize;
    let weight = |d: isize| if d.abs() == reach { 0.5 } else { 1.0 } / step as f64;
    let at = |i: usize, d: isize| {
        let index = (i * step) as isize + d;
        let index = index.unsigned_abs();
        index.min(SIDE - index)
    };
    statistics.spectra.each_ref().map(|fine| {
        Array2::from_shape_fn((GRID / 2 + 1, GRID / 2 + 1), |(r, c)| {
            let terms = (-reach..=reach).flat_map(|down| (-reach..=reach).map(move |across| (down, across)));
            terms.map(|(d, a)| weight(d) * weight(a) * fine[(at(r, d), at(c, a))]).sum()
        })
    })
}

/// A spectrum at any index of the torus.
pub(super) fn spectrum_at(quarter: &Array2<f64>, (r, c): (usize, usize)) -> f64 {
    quarter[(r.min(GRID - r), c.min(GRID - c))]
}

/// Covariances at one frequency and depth: Q measured numbers, N unknown ones.
#[derive(Debug, Clone)]
pub(super) struct Seen<const Q: usize, const N: usize> {
    pub yy: [[Complex64; Q]; Q],
    pub xy: [[Complex64; Q]; N],
}

/// A frequency of the torus, or a group of those that the mosaic folds onto each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Base {
    pub row: usize,
    pub column: usize,
    /// How many others have the same error, itself among them.
    pub count: f64,
}

/// Returns one of each set of frequencies that have the same error by symmetry, of a torus of `side`²: those of either sign, and those of a round
/// lens's mirror images.
pub(super) fn bases(side: usize, is_round: bool) -> Vec<Base> {
    let count = |i: usize| if i == 0 || 2 * i == side { 1.0 } else { 2.0 };
    let rows = if is_round { side / 2 + 1 } else { side };
    let base = |row: usize, column: usize| Base {
        row,
        column,
        count: count(column) * if is_round { count(row) } else { 1.0 },
    };
    (0..rows)
        .flat_map(|row| (0..=side / 2).map(move |column| (row, column)))
        .map(|(r, c)| base(r, c))
        .collect()
}

/// What a sensor measures of a colour picture.
pub(super) trait Sensor<const Q: usize, const N: usize> {
    /// Side of the torus of base frequencies.
    const SIDE: usize;

    /// Covariances at a base frequency.
    fn seen(spectra: &[Array2<f64>; 6], transfer: &Transfer, at: (usize, usize)) -> Seen<Q, N>;
}

/// A Bayer mosaic, red first.
pub(super) enum Bayer {}
/// A sensor with red, green and blue at every pixel.
pub(super) enum Planes {}

/// Index of the alias `k` of a base frequency.
pub(super) const fn alias((r, c): (usize, usize), k: usize) -> (usize, usize) {
    let (down, across) = PLACES[k];
    (r + down * GRID / 2, c + across * GRID / 2)
}

/// Half of exp(iπ k·δ): what the place `p` of the mosaic has of the alias `k`.
pub(super) const fn share(p: usize, k: usize) -> f64 {
    let turns = PLACES[p].0 * PLACES[k].0 + PLACES[p].1 * PLACES[k].1;
    if turns & 1 == 0 { 0.5 } else { -0.5 }
}

/// Plane of each place of the mosaic.
pub(super) const fn colour(p: usize) -> usize {
    COLOURS[p]
}

impl Sensor<4, 12> for Bayer {
    const SIDE: usize = GRID / 2;

    fn seen(spectra: &[Array2<f64>; 6], transfer: &Transfer, at: (usize, usize)) -> Seen<4, 12> {
        let mut seen = Seen { yy: [[ZERO; 4]; 4], xy: [[ZERO; 4]; 12] };
        for k in 0..4 {
            let at = alias(at, k);
            let s = |a: usize, b: usize| spectrum_at(&spectra[pair(a, b)], at);
            let a = [0, 1, 2, 3].map(|p| transfer[colour(p)][at] * share(p, k));
            for p in 0..4 {
                for q in 0..4 {
                    seen.yy[p][q] += a[p] * a[q].conj() * s(colour(p), colour(q));
                }
                for c in 0..3 {
                    seen.xy[4 * c + k][p] = a[p].conj() * s(c, colour(p));
                }
            }
        }
        seen
    }
}

impl Sensor<3, 3> for Planes {
    const SIDE: usize = GRID;

    fn seen(spectra: &[Array2<f64>; 6], transfer: &Transfer, at: (usize, usize)) -> Seen<3, 3> {
        let s = |a: usize, b: usize| spectrum_at(&spectra[pair(a, b)], at);
        let h = transfer.each_ref().map(|plane| plane[at]);
        let each = |f: &dyn Fn(usize, usize) -> Complex64| [0, 1, 2].map(|a| [0, 1, 2].map(|b| f(a, b)));
        Seen { yy: each(&|a, b| h[a] * h[b].conj() * s(a, b)), xy: each(&|a, b| h[b].conj() * s(a, b)) }
    }
}

/// Mean square errors at each depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors {
    /// Of one map for all depths.
    pub blind: Vec<f64>,
    /// Of a map for each depth.
    pub known: Vec<f64>,
}

/// A lens as its sensor's samples show it, ready to be judged in any light.
pub(super) struct View<const Q: usize, const N: usize> {
    bases: Vec<(Base, Vec<Seen<Q, N>>)>,
    depths: usize,
    /// Mean square of the picture about its mean colour.
    variance: f64,
}

impl<const Q: usize, const N: usize> View<Q, N> {
    pub fn new<S: Sensor<Q, N>>(spectra: &[Array2<f64>; 6], transfers: &[Transfer], is_round: bool) -> Self {
        let bases = bases(S::SIDE, is_round).into_par_iter().map(|base| {
            let seen = |transfer: &Transfer| S::seen(spectra, transfer, (base.row, base.column));
            (base, transfers.iter().map(seen).collect())
        });
        Self { bases: bases.collect(), depths: transfers.len(), variance: variance(spectra) }
    }

    /// Returns the errors with that noise variance.
    pub fn errors(&self, noise: f64) -> Errors {
        let zero = || vec![0.0; self.depths];
        let add = |mut sums: [Vec<f64>; 2], terms: [Vec<f64>; 2]| {
            sums.iter_mut().flatten().zip(terms.iter().flatten()).for_each(|(sum, term)| *sum += term);
            sums
        };
        let explained = self.bases.par_iter().map(|(base, seen)| {
            explained(seen, noise).map(|terms| terms.into_iter().map(|e| e * base.count).collect())
        });
        let scale = 1.0 / (3 * GRID * GRID) as f64;
        let [blind, known] = explained
            .collect::<Vec<_>>()
            .into_iter()
            .fold([zero(), zero()], add)
            .map(|sums| sums.into_iter().map(|sum| self.variance - sum * scale).collect());
        Errors { blind, known }
    }
}

/// Mean square of the picture about its mean colour, averaged over its channels.
pub(super) fn variance(spectra: &[Array2<f64>; 6]) -> f64 {
    let sum: f64 = bases(GRID, true)
        .iter()
        .map(|base| base.count * (0..3).map(|c| spectra[pair(c, c)][(base.row, base.column)]).sum::<f64>())
        .sum();
    sum / (3 * GRID * GRID) as f64
}

/// What a blind estimate and one that knows the depth explain of the unknown numbers' variance at one frequency, at each depth.
fn explained<const Q: usize, const N: usize>(seen: &[Seen<Q, N>], noise: f64) -> [Vec<f64>; 2] {
    let share = 1.0 / seen.len() as f64;
    let mut mean = Seen { yy: [[ZERO; Q]; Q], xy: [[ZERO; Q]; N] };
    for s in seen {
        mean.yy.iter_mut().flatten().zip(s.yy.iter().flatten()).for_each(|(sum, v)| *sum += v * share);
        mean.xy.iter_mut().flatten().zip(s.xy.iter().flatten()).for_each(|(sum, v)| *sum += v * share);
    }
    let map = wiener_map(&mean, noise);
    // WᴴW, by which an error of the measured numbers counts.
    let gram: [[Complex64; Q]; Q] =
        std::array::from_fn(|p| std::array::from_fn(|q| map.iter().map(|row| row[p].conj() * row[q]).sum()));
    let product = |map: &[[Complex64; Q]; N], xy: &[[Complex64; Q]; N]| -> f64 {
        map.iter().flatten().zip(xy.iter().flatten()).map(|(w, x)| (w * x.conj()).re).sum()
    };
    let pairs = || (0..Q).flat_map(|p| (0..Q).map(move |q| (p, q)));
    let noise_power = noise * (0..Q).map(|p| gram[p][p].re).sum::<f64>();
    let blind = |s: &Seen<Q, N>| {
        let power: f64 = pairs().map(|(p, q)| (gram[p][q] * s.yy[q][p]).re).sum();
        2.0 * product(&map, &s.xy) - power - noise_power
    };
    let known = |s: &Seen<Q, N>| product(&wiener_map(s, noise), &s.xy);
    [seen.iter().map(blind).collect(), seen.iter().map(known).collect()]
}

/// W = C_xy·(C_yy + noise)⁻¹, by a Cholesky factor.
pub(super) fn wiener_map<const Q: usize, const N: usize>(
    seen: &Seen<Q, N>,
    noise: f64,
) -> [[Complex64; Q]; N] {
    let mut lower = seen.yy;
    let mut inverse = [0.0; Q];
    for j in 0..Q {
        let used: f64 = (0..j).map(|k| lower[j][k].norm_sqr()).sum();
        inverse[j] = 1.0 / (lower[j][j].re + noise - used).max(f64::MIN_POSITIVE).sqrt();
        for i in j + 1..Q {
            let used: Complex64 = (0..j).map(|k| lower[i][k] * lower[j][k].conj()).sum();
            lower[i][j] = (seen.yy[i][j] - used) * inverse[j];
        }
    }
    // Each row w of W solves w·L·Lᴴ = x: first (w·L)·Lᴴ = x from the left, then w·L from the right.
    seen.xy.map(|mut row| {
        for j in 0..Q {
            let used: Complex64 = (0..j).map(|k| row[k] * lower[j][k].conj()).sum();
            row[j] = (row[j] - used) * inverse[j];
        }
        for j in (0..Q).rev() {
            let used: Complex64 = (j + 1..Q).map(|k| row[k] * lower[k][j]).sum();
            row[j] = (row[j] - used) * inverse[j];
        }
        row
    })
}

/// Returns the errors behind a camera's transfers, one for each depth, with a Bayer mosaic.
#[must_use]
pub fn bayer_errors(camera: &Camera, transfers: &[Transfer], statistics: &Statistics, noise: f64) -> Errors {
    View::new::<Bayer>(&spectra(statistics), transfers, camera.symmetry() == Symmetry::Round).errors(noise)
}

#[cfg(test)]
mod tests {
    use super::super::transfer::{Sampling, transfers, transformed};
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn natural() -> [Array2<f64>; 6] {
        spectra(&Statistics::natural())
    }

    #[test]
    fn the_coarse_spectra_have_the_variance_of_the_fine_ones() {
        let statistics = Statistics::natural();
        let fine = (0..3).map(|c| statistics.covariance(c, c)).sum::<f64>() / 3.0;
        assert!((variance(&spectra(&statistics)) - fine).abs() < 1e-12);
    }

    #[test]
    fn bases_stand_for_every_frequency() {
        for (side, is_round) in [(16, true), (16, false), (32, true), (32, false)] {
            assert_eq!(bases(side, is_round).iter().map(|b| b.count).sum::<f64>(), (side * side) as f64);
        }
    }

    #[test]
    fn mirror_images_of_a_round_lens_have_the_same_error() {
        let camera = Camera::resolve("ring-outer").unwrap();
        let seen = transfers(&camera, &[1.0, 6.0], Sampling::Coarse);
        let [quarter, half] =
            [true, false].map(|is_round| View::new::<Bayer>(&natural(), &seen, is_round).errors(1e-3));
        for (a, b) in quarter.blind.iter().chain(&quarter.known).zip(half.blind.iter().chain(&half.known)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn knowing_the_depth_never_costs_and_one_depth_is_known() {
        let camera = Camera::resolve("clear-mid").unwrap();
        let seen = transfers(&camera, &[0.0, 2.0, 8.0], Sampling::Coarse);
        let errors = bayer_errors(&camera, &seen, &Statistics::natural(), 1e-4);
        assert!(errors.blind.iter().zip(&errors.known).all(|(blind, known)| known <= blind), "{errors:?}");
        let one = bayer_errors(&camera, &seen[..1], &Statistics::natural(), 1e-4);
        assert!((one.blind[0] - one.known[0]).abs() < 1e-12);
    }

    /// A Gaussian field with the spectra of photographs: its three planes' transforms.
    fn field(spectra: &[Array2<f64>; 6], random: &mut rand_pcg::Pcg64) -> Transfer {
        let white = [0, 1, 2].map(|_| {
            let mut value = || Complex64::new(StandardNormal.sample(random), 0.0);
            transformed(Array2::from_shape_simple_fn((GRID, GRID), &mut value))
        });
        let mut out = white.clone();
        for r in 0..GRID {
            for c in 0..GRID {
                let s = |a: usize, b: usize| spectrum_at(&spectra[pair(a, b)], (r, c));
                // Cholesky factor of a 3x3 covariance.
                let l00 = s(0, 0).sqrt();
                let (l10, l20) = (s(0, 1) / l00, s(0, 2) / l00);
                let l11 = (s(1, 1) - l10 * l10).sqrt();
                let l21 = (s(1, 2) - l20 * l10) / l11;
                let l22 = (s(2, 2) - l20 * l20 - l21 * l21).max(0.0).sqrt();
                let [w0, w1, w2] = white.each_ref().map(|plane| plane[(r, c)]);
                out[0][(r, c)] = w0 * l00;
                out[1][(r, c)] = w0 * l10 + w1 * l11;
                out[2][(r, c)] = w0 * l20 + w1 * l21 + w2 * l22;
            }
        }
        out
    }

    /// The formula against pictures: random fields, blurred, sampled through the mosaic pixel by pixel, noise added, estimated.
    #[test]
    fn the_error_behind_a_mosaic_is_that_of_random_pictures() {
        let camera = Camera::resolve("ring-outer").unwrap();
        let camera = Camera { focus_psi: 4.44, ..camera };
        let (spectra, noise) = (natural(), 1e-3);
        let lens = transfers(&camera, &[6.0], Sampling::Fine);
        let formula = View::new::<Bayer>(&spectra, &lens, true).errors(noise).known[0];
        let bases = bases(GRID / 2, false);
        let maps: Vec<_> = bases
            .iter()
            .map(|b| wiener_map(&Bayer::seen(&spectra, &lens[0], (b.row, b.column)), noise))
            .collect();
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let draws = 250;
        let mut sum = 0.0;
        for _ in 0..draws {
            let sharp = field(&spectra, &mut random);
            let measured = mosaic(&sharp, &lens[0], noise, &mut random);
            for (base, map) in bases.iter().zip(&maps) {
                let at = (base.row, base.column);
                // The transform of a place's samples, set on the full grid with zeros between, is the sum over the aliases.
                let y = measured.each_ref().map(|place| place[at] * 2.0);
                for (i, row) in map.iter().enumerate() {
                    let estimate: Complex64 = row.iter().zip(&y).map(|(w, y)| w * y).sum();
                    sum += base.count * (estimate - sharp[i / 4][alias(at, i % 4)]).norm_sqr();
                }
            }
        }
        let found = sum / (f64::from(draws) * (3 * GRID * GRID * GRID * GRID) as f64);
        assert!((found / formula - 1.0).abs() < 0.005, "{found} by pictures, {formula} by the formula");
    }

    /// Transforms of the samples of each place of the mosaic, zeros elsewhere.
    fn mosaic(
        sharp: &Transfer,
        lens: &Transfer,
        noise: f64,
        random: &mut rand_pcg::Pcg64,
    ) -> [Array2<Complex64>; 4] {
        let scale = 1.0 / (GRID * GRID) as f64;
        // The inverse transform by the forward one: of the conjugate, conjugated.
        let blurred = [0, 1, 2].map(|c| {
            let spectrum = (&sharp[c] * &lens[c]).mapv(|v| v.conj());
            transformed(spectrum).mapv(|v| v.re * scale)
        });
        [0, 1, 2, 3].map(|p| {
            let (down, across) = PLACES[p];
            let sampled = Array2::from_shape_fn((GRID, GRID), |(r, c)| {
                if r % 2 != down || c % 2 != across {
                    return ZERO;
                }
                let error: f64 = StandardNormal.sample(random);
                Complex64::new(blurred[colour(p)][(r, c)] + noise.sqrt() * error, 0.0)
            });
            transformed(sampled)
        })
    }
}
