//! PSFs of round lenses: pupil, field and PSF are even along rows and columns, so a quarter of each is enough.
//!
//! The OTF is the pupil's correlation with itself, found by way of the field's squared magnitude. Only the pupil's half-way transform
//! is kept. Each row of the field is squared, transformed and folded to the sensor's frequencies at once.

use super::grid::Grid;
use crate::cosine::{EvenTransform, period};
use crate::pupil::{Pupil, squared_change};
use edof_core::camera::{Camera, Place};
use edof_numerics::fft::{Complex64, Fft, Real};
use edof_numerics::sinc;
use ndarray::{Array1, Array2, ArrayView1};
use std::sync::Arc;

/// Rows transformed before any is written: with 8 a written cache line is filled at once.
const BLOCK: usize = 8;

/// The PSF at one wavelength, integrated over pixels, for pixel offsets 0…`support`/2 along rows and columns (it is even). It
/// sums to 1 over the whole support, whose side in pixels is even.
#[must_use]
pub fn quarter_psf(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> Array2<f64> {
    let spectrum = pixel_transfer(camera, wavelength_nm, psi, support);
    pixels_of(&spectrum).mapv(|v| v.max(0.0))
}

/// What pixels collect behind a sampled pupil, as a share of `light`, laid out as [`quarter_psf`]'s; or how it changes with the pupil.
pub(crate) fn pixels(
    pupil: &Array2<Complex64>,
    change: Option<&Array2<Complex64>>,
    grid: Grid,
    support: usize,
    light: f64,
) -> Array2<f64> {
    pixels_of(&transfer(pupil, change, light, grid, &folded(grid.band(), support), support / 2 + 1))
}

/// From frequencies back to pixels.
fn pixels_of(spectrum: &Array2<f64>) -> Array2<f64> {
    let n = spectrum.nrows();
    let transform = EvenTransform::new(n);
    let half_way = transform.rows_transposed(spectrum.view(), n);
    let scale = 1.0 / (period(n) * period(n)) as f64;
    transform.rows_transposed(half_way.view(), n).mapv(|v| v * scale)
}

/// Fourier transform of the sampled PSF, [`quarter_psf`]: the OTF times the pixel's footprint, folded at the sensor's sampling
/// frequency. Entry (r, c) of the `support`/2 + 1 squared is at (r, c)/`support` cycles a pixel.
#[must_use]
pub fn pixel_transfer(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> Array2<f64> {
    let grid = Grid::new(camera, wavelength_nm, support);
    let pupil = pupil(camera, wavelength_nm, psi, grid);
    transfer(&pupil, None, light(&pupil, None), grid, &folded(grid.band(), support), support / 2 + 1)
}

/// The optical transfer function at one wavelength, without the pixel's footprint: entry (r, c) is at the frequency
/// (r, c)/(`support`·pitch), up to the cut-off. It is real and even, and 1 at zero.
#[must_use]
pub fn quarter_otf(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> Array2<f64> {
    let grid = Grid::new(camera, wavelength_nm, support);
    let pupil = pupil(camera, wavelength_nm, psi, grid);
    transfer(&pupil, None, light(&pupil, None), grid, &unfolded(grid.band()), grid.band())
}

/// The first row of [`quarter_otf`], at a small part of its cost: the transform of the PSF's projection (the line spread function),
/// which is the sum over the squared transforms of the pupil's rows.
#[must_use]
pub fn otf_along_row(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> Array1<f64> {
    let grid = Grid::new(camera, wavelength_nm, support);
    let mut cosines = Cosines::new(grid.period / 2);
    let mut field = vec![Complex64::default(); cosines.len()];
    let mut spread = field.clone();
    for (r, row) in pupil(camera, wavelength_nm, psi, grid).outer_iter().enumerate() {
        cosines.of(row.iter().copied(), &mut field);
        let count = if r == 0 { 1.0 } else { 2.0 };
        spread.iter_mut().zip(&field).for_each(|(sum, v)| sum.re += count * v.norm_sqr());
    }
    cosines.of(spread.iter().copied(), &mut field);
    let light = field[0].re;
    field.iter().take(grid.band()).map(|v| v.re / light).collect()
}

/// Where the frequencies 0, 1, 2 … of a spectrum go: an index of the result, and a factor.
type Places = Vec<(usize, f64)>;

/// Every frequency of the band at its own index, as it is.
fn unfolded(band: usize) -> Places {
    (0..band).map(|q| (q, 1.0)).collect()
}

/// Frequencies of the band weighted by a pixel's footprint and folded at the sampling frequency, `support`. An index 0…`support`/2
/// stands for both signs of a frequency; where both fold onto one index of the sensor's period, the factor counts both.
fn folded(band: usize, support: usize) -> Places {
    let place = |q: usize| {
        let index = (q % support).min(support - q % support);
        let both = q > 0 && (index == 0 || 2 * index == support);
        (index, sinc(q as f64 / support as f64) * if both { 2.0 } else { 1.0 })
    };
    (0..band).map(place).collect()
}

/// A quarter of the sampled pupil, with the axes.
fn pupil(camera: &Camera, wavelength_nm: f64, psi: f64, grid: Grid) -> Array2<Complex64> {
    let pupil = Pupil::new(camera, wavelength_nm, psi);
    samples(grid, |at| pupil.sample(at.rho, 1.0 / grid.radius))
}

/// A quarter of a round pupil, or of its change, with the axes. It is its own mirror image about the diagonal.
pub(crate) fn samples(grid: Grid, pupil: impl Fn(Place) -> Complex64) -> Array2<Complex64> {
    let mut plane = Array2::from_elem((grid.samples, grid.samples), Complex64::default());
    for r in 0..grid.samples {
        for c in r..grid.samples {
            let (rho, inside) = grid.at(r as f64, c as f64);
            if !inside {
                break;
            }
            let sample = pupil(Place { x: rho, y: 0.0, rho });
            (plane[(r, c)], plane[(c, r)]) = (sample, sample);
        }
    }
    plane
}

/// Light behind a sampled pupil, or how it changes with the pupil.
pub(crate) fn light(pupil: &Array2<Complex64>, change: Option<&Array2<Complex64>>) -> f64 {
    let count = |i: usize| if i == 0 { 1.0 } else { 2.0 };
    let share = |((r, c), v): ((usize, usize), &Complex64)| {
        count(r) * count(c) * change.map_or_else(|| v.norm_sqr(), |change| squared_change(*v, change[(r, c)]))
    };
    pupil.indexed_iter().map(share).sum()
}

/// The OTF, its frequencies put in their `places` along rows and columns, `side` squared; or how it changes with the pupil.
fn transfer(
    pupil: &Array2<Complex64>,
    change: Option<&Array2<Complex64>>,
    light: f64,
    grid: Grid,
    places: &[(usize, f64)],
    side: usize,
) -> Array2<f64> {
    // The transforms give a period squared times the pupil's correlation with itself.
    let scale = 1.0 / (light * (grid.period * grid.period) as f64);
    let mut cosines = Cosines::new(grid.period / 2);
    let field = half_way(&mut cosines, pupil);
    let change = change.map(|change| half_way(&mut cosines, change));
    let along_rows = squared_field(&mut cosines, &field, change.as_ref(), places, side);
    let mut out = Array2::from_elem((side, side), 0.0);
    let mut spectrum = vec![Complex64::default(); cosines.len()];
    for first in (0..side).step_by(2) {
        let second = (first + 1).min(side - 1);
        let (a, b) = (along_rows.row(first), along_rows.row(second));
        cosines.of(a.iter().zip(b).map(|(&a, &b)| Complex64::new(a, b)), &mut spectrum);
        for (&(index, factor), v) in places.iter().zip(&spectrum) {
            out[(first, index)] += v.re * factor * scale;
            if second > first {
                out[(second, index)] += v.im * factor * scale;
            }
        }
    }
    out
}

/// The transform of the pupil's rows, as columns: points of the period × samples.
fn half_way(cosines: &mut Cosines, pupil: &Array2<Complex64>) -> Array2<Complex64> {
    let samples = pupil.nrows();
    let mut out = Array2::from_elem((cosines.len(), samples), Complex64::default());
    let mut block = vec![vec![Complex64::default(); cosines.len()]; BLOCK];
    for first in (0..samples).step_by(BLOCK) {
        let rows = BLOCK.min(samples - first);
        for (r, row) in block.iter_mut().take(rows).enumerate() {
            cosines.of(pupil.row(first + r).iter().copied(), row);
        }
        for (i, mut line) in out.outer_iter_mut().enumerate() {
            for (r, row) in block.iter().take(rows).enumerate() {
                line[first + r] = row[i];
            }
        }
    }
    out
}

/// The field's squared magnitude along one of its rows, or how it changes with the field.
fn squared(
    cosines: &mut Cosines,
    field: ArrayView1<Complex64>,
    change: Option<ArrayView1<Complex64>>,
) -> Vec<f64> {
    let mut one = vec![Complex64::default(); cosines.len()];
    cosines.of(field.iter().copied(), &mut one);
    let Some(change) = change else { return one.iter().map(Complex64::norm_sqr).collect() };
    let mut other = one.clone();
    cosines.of(change.iter().copied(), &mut other);
    one.iter().zip(&other).map(|(v, change)| squared_change(*v, *change)).collect()
}

/// Spectra of [`squared`] along all rows, their frequencies in their places, as columns: `side` × points of the period.
fn squared_field(
    cosines: &mut Cosines,
    field: &Array2<Complex64>,
    change: Option<&Array2<Complex64>>,
    places: &[(usize, f64)],
    side: usize,
) -> Array2<f64> {
    let points = cosines.len();
    let mut out = Array2::from_elem((side, points), 0.0);
    let mut block = vec![vec![Complex64::default(); side]; BLOCK / 2];
    let mut spectrum = vec![Complex64::default(); points];
    for first in (0..points).step_by(BLOCK) {
        let rows = BLOCK.min(points - first);
        // Two real rows share a complex one.
        for (pair, folded) in block.iter_mut().take(rows.div_ceil(2)).enumerate() {
            let [one, other] = [0, 1].map(|i| {
                let row = (first + 2 * pair + i).min(points - 1);
                squared(cosines, field.row(row), change.map(|change| change.row(row)))
            });
            cosines.of(one.iter().zip(&other).map(|(&a, &b)| Complex64::new(a, b)), &mut spectrum);
            folded.fill(Complex64::default());
            for (&(index, factor), v) in places.iter().zip(&spectrum) {
                folded[index] += v * factor;
            }
        }
        for (index, mut line) in out.outer_iter_mut().enumerate() {
            for r in 0..rows {
                let value = block[r / 2][index];
                line[first + r] = if r % 2 == 0 { value.re } else { value.im };
            }
        }
    }
    out
}

/// Sums of cosines of even sequences with a period of 2·`half`, by a transform of `half` points.
struct Cosines {
    half: usize,
    fft: Arc<dyn Fft<f64>>,
    /// 2·sin(πi/half) and cos(πi/half).
    waves: Vec<(f64, f64)>,
    buffer: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Cosines {
    /// A plan; `half` is even.
    fn new(half: usize) -> Self {
        let fft = f64::forward(half);
        let angle = |i: usize| std::f64::consts::PI * i as f64 / half as f64;
        let zero = Complex64::default();
        Self {
            half,
            waves: (0..half).map(|i| (2.0 * angle(i).sin(), angle(i).cos())).collect(),
            buffer: vec![zero; half],
            scratch: vec![zero; fft.get_inplace_scratch_len()],
            fft,
        }
    }

    /// Samples 0…`half` of a sequence, and as many of its transform.
    const fn len(&self) -> usize {
        self.half + 1
    }

    /// `out`\[k\] = Σ over a period of x\[i\]·cos(πik/half), of the real and of the imaginary part. Samples that `x` lacks are 0.
    fn of(&mut self, x: impl Iterator<Item = Complex64>, out: &mut [Complex64]) {
        let half = self.half;
        // The part of the sequence that is even about half/2, less twice the sine times the odd part: its transform has the even
        // frequencies of the result, and differences of the odd ones.
        let mut first = Complex64::default();
        self.buffer.fill(first);
        for (i, v) in x.enumerate() {
            if i == 0 {
                self.buffer[0] += v;
                first += v;
            } else if i == half {
                self.buffer[0] += v;
                first -= v;
            } else {
                let (sine, cosine) = self.waves[i];
                first += v * (2.0 * cosine);
                let odd = v * sine;
                self.buffer[i] += v - odd;
                self.buffer[half - i] += v + odd;
            }
        }
        self.fft.process_with_scratch(&mut self.buffer, &mut self.scratch);
        let (mut odd, i) = (first, Complex64::i());
        out[0] = self.buffer[0];
        out[1] = odd;
        for k in 1..half / 2 {
            let (low, high) = (self.buffer[k], self.buffer[half - k]);
            out[2 * k] = 0.5 * (low + high);
            odd += 0.5 * i * (low - high);
            out[2 * k + 1] = odd;
        }
        out[half] = self.buffer[half / 2];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_are_those_of_the_sum() {
        for half in [2, 16, 48, 70] {
            for given in [1, half / 2, half + 1] {
                let x: Vec<Complex64> = (0..given)
                    .map(|i| Complex64::new((i * 7 % 11) as f64, (i * 5 % 13) as f64 - 6.0))
                    .collect();
                let mut out = vec![Complex64::default(); half + 1];
                Cosines::new(half).of(x.iter().copied(), &mut out);
                for (k, v) in out.iter().enumerate() {
                    let term = |i: usize| {
                        let at = i.min(2 * half - i);
                        let angle = std::f64::consts::PI * (i * k) as f64 / half as f64;
                        x.get(at).copied().unwrap_or_default() * angle.cos()
                    };
                    let sum: Complex64 = (0..2 * half).map(term).sum();
                    assert!((v - sum).norm() < 1e-10, "half {half}, given {given}, frequency {k}: {v} {sum}");
                }
            }
        }
    }

    #[test]
    fn a_folded_frequency_counts_both_of_its_signs() {
        let places = folded(9, 4);
        assert_eq!(places.iter().map(|(index, _)| *index).collect::<Vec<_>>(), [0, 1, 2, 1, 0, 1, 2, 1, 0]);
        let factor = |q: usize| sinc(q as f64 / 4.0);
        assert_eq!(places[0].1, 1.0);
        assert_eq!((places[1].1, places[3].1), (factor(1), factor(3)));
        assert_eq!(places[2].1, 2.0 * factor(2));
    }
}
