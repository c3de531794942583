//! PSFs of lenses whose wavefront is not round: the pupil with all its terms, transformed whole.
//!
//! The steps are those of the round case ([`super::round`]). The only symmetry left is that light is real.

use super::grid::Grid;
use super::support::{OUTSIDE, SUPPORT};
use crate::pupil::{Pupil, squared_change};
use edof_core::camera::{Camera, Place};
use edof_numerics::fft::{Complex64, Fft, Real};
use edof_numerics::sinc;
use ndarray::{Array2, ArrayView1};
use std::sync::Arc;

const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// Columns computed before any is written: with 4 a written cache line is filled at once. Every period is a multiple.
const BLOCK: usize = 4;

/// Most points along a side of the finest grid.
const MAX_POINTS: usize = 4096;

/// The largest support that a grid has room for, in pixels a side.
pub fn room(camera: &Camera, wavelength_nm: f64) -> usize {
    let room = MAX_POINTS / steps_a_pixel(camera, wavelength_nm);
    let room = if room.is_power_of_two() { room } else { room.next_power_of_two() / 2 };
    room.min(SUPPORT)
}

/// The support that a grid has room for, at most `wanted` pixels a side. A term whose slope is not known may throw light farther than its
/// lens: then it is larger, as far as there is room. With it comes the share of light that still falls near the edges of the largest support, and so
/// beyond it; 0 where that is less than [`OUTSIDE`].
pub fn support(camera: &Camera, wavelength_nm: f64, psi: f64, wanted: usize) -> (usize, f64) {
    let room = room(camera, wavelength_nm);
    let mut support = wanted.min(room);
    if camera.terms().all(|term| term.largest_slope(wavelength_nm).is_some()) {
        return (support, 0.0);
    }
    loop {
        let sums = square_sums(&whole_psf(camera, wavelength_nm, psi, support));
        // With room left the middle half of the sides must hold the light, else three quarters.
        let within = if support < room { support / 4 } else { 3 * support / 8 };
        let outside = 1.0 - sums[within];
        match (outside <= OUTSIDE, support < room) {
            (true, _) => return (support, 0.0),
            (false, true) => support *= 2,
            (false, false) => return (support, outside),
        }
    }
}

/// The PSF at one wavelength, integrated over pixels: offset (r, c) from the middle at index (r, c) modulo `support`. Sums to 1.
pub fn whole_psf(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> Array2<f64> {
    let grid = Grid::new(camera, wavelength_nm, support);
    let pupil = Pupil::new(camera, wavelength_nm, psi);
    let samples = samples(grid, |at| pupil.sample_at(at, 1.0 / grid.radius));
    let mut psf = pixels(&samples, None, grid, support, light(&samples, None));
    psf.mapv_inplace(|v| v.max(0.0));
    psf
}

/// The optical transfer function at one wavelength, without the pixel's footprint, along a row of pixels and along a column: entry q is at
/// q/(`support`·pitch), up to the cut-off, and 1 at zero. It is the pupil's autocorrelation, by the sum over the squared transforms of its rows or columns.
pub fn otf_along_axes(camera: &Camera, wavelength_nm: f64, psi: f64, support: usize) -> [Vec<Complex64>; 2] {
    let grid = Grid::new(camera, wavelength_nm, support);
    let pupil = Pupil::new(camera, wavelength_nm, psi);
    let samples = samples(grid, |at| pupil.sample_at(at, 1.0 / grid.radius));
    let mut forward = Lines::new(grid.period);
    [samples.view(), samples.t()].map(|pupil| {
        let field = half_way(&mut forward, &pupil.as_standard_layout().into_owned(), grid);
        let spread = field.outer_iter().map(|at| at.iter().map(Complex64::norm_sqr).sum::<f64>());
        let response = forward.of(|line| line.iter_mut().zip(spread).for_each(|(to, v)| to.re = v));
        response.iter().take(grid.band()).map(|v| v / response[0].re).collect()
    })
}

/// Light behind a sampled pupil, or how it changes with the pupil.
pub fn light(pupil: &Array2<Complex64>, change: Option<&Array2<Complex64>>) -> f64 {
    match change {
        None => pupil.iter().map(Complex64::norm_sqr).sum(),
        Some(change) => pupil.iter().zip(change).map(|(v, change)| squared_change(*v, *change)).sum(),
    }
}

/// What pixels collect behind a sampled pupil, as a share of `light`, laid out as [`whole_psf`]'s; or how it changes with the pupil.
pub fn pixels(
    pupil: &Array2<Complex64>,
    change: Option<&Array2<Complex64>>,
    grid: Grid,
    support: usize,
    light: f64,
) -> Array2<f64> {
    let scale = 1.0 / (light * (grid.period * grid.period) as f64 * (support * support) as f64);
    let frequencies = frequencies(grid, support);
    let (mut forward, mut back) = (Lines::new(grid.period), Lines::new(support));
    let field = half_way(&mut forward, pupil, grid);
    let change = change.map(|change| half_way(&mut forward, change, grid));
    let down = squared_field(&mut forward, &field, change.as_ref(), &frequencies, support);
    // The other axis, folded, and the first step of the way back: by the same transform, since spectra are conjugated.
    let mut half = Array2::from_elem((support / 2 + 1, support), ZERO);
    for (column, mut out) in down.outer_iter().zip(half.outer_iter_mut()) {
        let spectrum = forward.of(|line| line.iter_mut().zip(column).for_each(|(to, from)| *to = *from));
        let folded = back.of(|line| {
            for &(q, index, footprint) in &frequencies {
                line[index] += spectrum[q].conj() * (footprint * scale);
            }
        });
        out.iter_mut().zip(folded).for_each(|(to, from)| *to = *from);
    }
    rows_of_light(&mut back, &half)
}

/// The frequencies, of both signs, at which the field's squared magnitude is not 0: index in its period, index in the sensor's, and
/// the transform of a pixel's footprint.
fn frequencies(grid: Grid, support: usize) -> Vec<(usize, usize, f64)> {
    let last = grid.band() as isize - 1;
    let index = |q: isize, period: usize| q.rem_euclid(period as isize) as usize;
    (-last..=last)
        .map(|q| (index(q, grid.period), index(q, support), sinc(q as f64 / support as f64)))
        .collect()
}

/// The transform of the pupil's rows, as columns: points of the period × rows of the pupil.
fn half_way(forward: &mut Lines, pupil: &Array2<Complex64>, grid: Grid) -> Array2<Complex64> {
    let reach = grid.samples - 1;
    let mut out = Array2::from_elem((grid.period, pupil.nrows()), ZERO);
    let mut block = vec![vec![ZERO; grid.period]; BLOCK];
    for first in (0..pupil.nrows()).step_by(BLOCK) {
        let rows = BLOCK.min(pupil.nrows() - first);
        for (r, kept) in block.iter_mut().take(rows).enumerate() {
            kept.copy_from_slice(forward.of(|line| wrap(line, pupil.row(first + r), reach)));
        }
        for (i, mut line) in out.outer_iter_mut().enumerate() {
            block.iter().take(rows).enumerate().for_each(|(r, row)| line[first + r] = row[i]);
        }
    }
    out
}

/// Puts values about a middle, `reach` to either side of it, about index 0 of a period.
fn wrap(line: &mut [Complex64], values: ArrayView1<Complex64>, reach: usize) {
    let period = line.len();
    for (i, v) in values.iter().enumerate() {
        line[(i + period - reach) % period] = *v;
    }
}

/// The field's squared magnitude down one of its columns, or how it changes with the field.
fn squared(
    forward: &mut Lines,
    field: ArrayView1<Complex64>,
    change: Option<ArrayView1<Complex64>>,
) -> Vec<f64> {
    let reach = field.len() / 2;
    let field = forward.of(|line| wrap(line, field, reach));
    let Some(change) = change else { return field.iter().map(Complex64::norm_sqr).collect() };
    let field = field.to_vec();
    let change = forward.of(|line| wrap(line, change, reach));
    field.iter().zip(change).map(|(v, change)| squared_change(*v, *change)).collect()
}

/// Spectra of [`squared`] down all columns, folded: frequencies 0…`support`/2 × points of the period.
fn squared_field(
    forward: &mut Lines,
    field: &Array2<Complex64>,
    change: Option<&Array2<Complex64>>,
    frequencies: &[(usize, usize, f64)],
    support: usize,
) -> Array2<Complex64> {
    let period = field.nrows();
    let mut out = Array2::from_elem((support / 2 + 1, period), ZERO);
    let mut light = vec![ZERO; period];
    let mut block = vec![vec![ZERO; support / 2 + 1]; BLOCK];
    for first in (0..period).step_by(BLOCK) {
        for (pair, two) in block.chunks_exact_mut(2).enumerate() {
            let [one, other] = [0, 1].map(|i| {
                let column = first + 2 * pair + i;
                squared(forward, field.row(column), change.map(|change| change.row(column)))
            });
            light
                .iter_mut()
                .zip(one.iter().zip(&other))
                .for_each(|(to, (&a, &b))| *to = Complex64::new(a, b));
            // Two real columns share a complex one: the transform of each is its own mirror image, conjugated.
            let both = forward.of(|line| line.copy_from_slice(&light));
            two.iter_mut().for_each(|folded| folded.fill(ZERO));
            for &(q, index, footprint) in frequencies.iter().filter(|(_, index, _)| 2 * index <= support) {
                let (low, high) = (both[q], both[(period - q) % period].conj());
                two[0][index] += (low + high) * (0.5 * footprint);
                two[1][index] += Complex64::new(0.0, -0.5) * (low - high) * footprint;
            }
        }
        for (index, mut line) in out.outer_iter_mut().enumerate() {
            block.iter().enumerate().for_each(|(i, folded)| line[first + i] = folded[index]);
        }
    }
    out
}

/// The last step of the way back, to real light, two columns at a time: rows 0…`support`/2 are given, the others are their mirror
/// images, conjugated.
fn rows_of_light(back: &mut Lines, half: &Array2<Complex64>) -> Array2<f64> {
    let support = half.ncols();
    let mut out = Array2::from_elem((support, support), 0.0);
    for first in (0..support).step_by(2) {
        let columns = back.of(|line| {
            for (j, v) in line.iter_mut().enumerate() {
                let at =
                    |c: usize| if 2 * j <= support { half[(j, c)] } else { half[(support - j, c)].conj() };
                *v = at(first) + Complex64::i() * at(first + 1);
            }
        });
        for (mut row, v) in out.outer_iter_mut().zip(columns) {
            (row[first], row[first + 1]) = (v.re, v.im);
        }
    }
    out
}

/// Sums over the centred squares of sides 1, 3, 5 … of a plane that is laid out as [`whole_psf`]'s.
pub fn square_sums(plane: &Array2<f64>) -> Vec<f64> {
    let side = plane.nrows();
    let half = side / 2;
    let mut rings = vec![0.0; half];
    for ((r, c), v) in plane.indexed_iter() {
        let reach = |i: usize| i.min(side - i);
        if let Some(ring) = rings.get_mut(reach(r).max(reach(c))) {
            *ring += v;
        }
    }
    rings
        .iter()
        .scan(0.0, |sum, ring| {
            *sum += ring;
            Some(*sum)
        })
        .collect()
}

/// Grid steps a pixel: the spacing is at most half of λF#, so that the PSF's band, ±1/(λF#), fits.
fn steps_a_pixel(camera: &Camera, wavelength_nm: f64) -> usize {
    (2.0 * camera.pixel_pitch_um / camera.wave_um(wavelength_nm)).ceil().max(1.0) as usize
}

/// A pupil, or its change, sampled whole, zero frequency in the middle.
pub fn samples(grid: Grid, pupil: impl Fn(Place) -> Complex64) -> Array2<Complex64> {
    let reach = grid.samples as isize - 1;
    Array2::from_shape_fn((2 * grid.samples - 1, 2 * grid.samples - 1), |(r, c)| {
        let (up, right) = ((reach - r as isize) as f64, (c as isize - reach) as f64);
        let (rho, inside) = grid.at(up, right);
        if inside { pupil(Place { x: right / grid.radius, y: up / grid.radius, rho }) } else { ZERO }
    })
}

/// Forward transforms of one length, each in the same buffer.
struct Lines {
    fft: Arc<dyn Fft<f64>>,
    buffer: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Lines {
    fn new(length: usize) -> Self {
        let fft = f64::forward(length);
        Self { buffer: vec![ZERO; length], scratch: vec![ZERO; fft.get_inplace_scratch_len()], fft }
    }

    /// The transform of what `fill` puts into a line of zeros.
    fn of(&mut self, fill: impl FnOnce(&mut [Complex64])) -> &[Complex64] {
        self.buffer.fill(ZERO);
        fill(&mut self.buffer);
        self.fft.process_with_scratch(&mut self.buffer, &mut self.scratch);
        &self.buffer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::psf::round::quarter_psf;
    use edof_core::camera::{Aberration, HeightMap, Mask, Zernike};

    fn aberrated(noll: u32, rms_nm: f64) -> Camera {
        Camera {
            aberrations: Zernike(vec![Aberration { noll, rms_nm }]),
            ..Camera::resolve("clear").unwrap()
        }
    }

    /// Middle of the light in pixels, down and across.
    fn centroid(psf: &Array2<f64>) -> (f64, f64) {
        let n = psf.nrows() as isize;
        let offset = |i: usize| if 2 * (i as isize) < n { i as f64 } else { i as f64 - n as f64 };
        psf.indexed_iter().fold((0.0, 0.0), |(d, a), ((r, c), v)| (d + v * offset(r), a + v * offset(c)))
    }

    #[test]
    fn without_aberrations_it_is_the_round_lens() {
        for (name, psi) in [("clear", 0.0), ("ring-2018", 5.0)] {
            let camera = Camera::resolve(name).unwrap();
            let (whole, quarter) =
                (whole_psf(&camera, 535.0, psi, 128), quarter_psf(&camera, 535.0, psi, 128));
            assert!((whole.sum() - 1.0).abs() < 1e-9);
            for ((r, c), v) in quarter.indexed_iter() {
                assert!((whole[(r, c)] - v).abs() < 1e-9 && (whole[((128 - r) % 128, c)] - v).abs() < 1e-9);
            }
        }
    }

    /// The PSF by its definition: the pupil's correlation with itself times the pixel's footprint, wave by wave.
    fn by_definition(camera: &Camera, nm: f64, psi: f64, support: usize) -> Array2<f64> {
        let grid = Grid::new(camera, nm, support);
        let lens = Pupil::new(camera, nm, psi);
        let pupil = samples(grid, |at| lens.sample_at(at, 1.0 / grid.radius));
        let (side, band) = (pupil.nrows() as isize, 2 * grid.samples as isize - 2);
        let correlation = |down: isize, across: isize| -> Complex64 {
            let at = |i: isize, by: isize| (0..side).contains(&(i - by)).then(|| (i - by) as usize);
            let product = |((r, c), v): ((usize, usize), &Complex64)| {
                Some(v * pupil[(at(r as isize, down)?, at(c as isize, across)?)].conj())
            };
            pupil.indexed_iter().filter_map(product).sum()
        };
        let light = correlation(0, 0).re * (support * support) as f64;
        let mut psf = Array2::zeros((support, support));
        for (down, across) in (-band..=band).flat_map(|r| (-band..=band).map(move |c| (r, c))) {
            let cycles = [down, across].map(|q| q as f64 / support as f64);
            let wave = correlation(down, across) * (sinc(cycles[0]) * sinc(cycles[1]) / light);
            for ((r, c), v) in psf.indexed_iter_mut() {
                let turns = cycles[0] * r as f64 + cycles[1] * c as f64;
                *v += (wave * Complex64::cis(-std::f64::consts::TAU * turns)).re;
            }
        }
        psf
    }

    #[test]
    fn psfs_are_the_sums_that_define_them() {
        let ring = Camera::resolve("ring-outer").unwrap();
        let coma =
            Camera { aberrations: Zernike(vec![Aberration { noll: 8, rms_nm: 60.0 }]), ..ring.clone() };
        // Pixels of other sizes fold other frequencies over each other.
        for (pitch, nm, psi) in [(3.0, 460.0, 7.0), (3.0, 610.0, 0.0), (5.0, 535.0, 2.0), (1.1, 535.0, 2.0)] {
            let of = |camera: &Camera| Camera { pixel_pitch_um: pitch, ..camera.clone() };
            let expected = by_definition(&of(&ring), nm, psi, 16);
            for ((r, c), v) in quarter_psf(&of(&ring), nm, psi, 16).indexed_iter() {
                assert!((v - expected[(r % 16, c % 16)]).abs() < 1e-12, "{pitch} {nm} {psi}: ({r}, {c})");
            }
            let expected = by_definition(&of(&coma), nm, psi, 16);
            let whole = whole_psf(&of(&coma), nm, psi, 16);
            assert!(whole.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{pitch} {nm} {psi}");
        }
    }

    #[test]
    fn tilt_moves_the_point_and_coma_smears_it_to_one_side() {
        let (down, across) = centroid(&whole_psf(&aberrated(2, 200.0), 535.0, 0.0, 128));
        assert!(across > 0.5 && down.abs() < 1e-2, "to the right: {down} {across}");
        let (down, across) = centroid(&whole_psf(&aberrated(3, 200.0), 535.0, 0.0, 128));
        assert!(down < -0.5 && across.abs() < 1e-2, "up: {down} {across}");
        let coma = whole_psf(&aberrated(8, 80.0), 535.0, 0.0, 128);
        let lean: f64 = (1..8).map(|c| coma[(0, c)] - coma[(0, 128 - c)]).sum();
        assert!(lean < -0.01, "its tail points to the left: {lean}");
        assert!((1..8).all(|r| (coma[(r, 3)] - coma[(128 - r, 3)]).abs() < 1e-9));
    }

    /// A clear lens with a mask of a surface, heights by place in the aperture, of one wave of 535 nm where it is white.
    fn masked(height: impl Fn(f64, f64) -> f64) -> Camera {
        surfaced(1.07, height)
    }

    fn surfaced(white_um: f64, height: impl Fn(f64, f64) -> f64) -> Camera {
        let side = 512;
        let place = |i: usize| (i as f64 + 0.5) / f64::from(side as u32) * 2.0 - 1.0;
        let heights = Array2::from_shape_fn((side, side), |(r, c)| height(place(c), -place(r)) as f32);
        let mut map = HeightMap {
            file: "mask.png".into(),
            white_um,
            cauchy: [1.5, 0.0],
            sha256: String::new(),
            heights: None,
        };
        map.take(heights, "mask.png".into(), "masked").unwrap();
        Camera { mask: Mask::from_iter([map]), ..Camera::resolve("clear").unwrap() }
    }

    fn furthest(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
        let peak = b.iter().fold(0.0f64, |max, v| max.max(*v));
        a.iter().zip(b).fold(0.0f64, |max, (a, b)| max.max((a - b).abs())) / peak
    }

    #[test]
    fn a_surface_of_glass_is_the_wavefront_that_it_makes() {
        let clear = Camera::resolve("clear").unwrap();
        let psf = |camera: &Camera, nm: f64, psi: f64| whole_psf(camera, nm, psi, 128);
        let flat = masked(|_, _| 0.7);
        assert!(furthest(&psf(&flat, 535.0, 3.0), &psf(&clear, 535.0, 3.0)) < 1e-9);
        // A bowl of half a wave at its edge is a defocus of pi there, at every wavelength.
        let bowl = masked(|x, y| 0.5 * (x * x + y * y));
        let psi = std::f64::consts::PI * 535.0 / clear.reference_wavelength_nm * clear.defocus_sign.factor();
        for nm in [460.0, 610.0] {
            assert!(furthest(&psf(&bowl, nm, 1.0), &psf(&clear, nm, 1.0 + psi)) < 1e-2);
        }
        // A wedge of a wave from edge to edge is a tilt of a quarter of that, root mean square.
        let (right, up) = (masked(|x, _| 0.5 * (x + 1.0)), masked(|_, y| 0.5 * (y + 1.0)));
        for (wedge, noll) in [(right, 2), (up, 3)] {
            let expected = psf(&aberrated(noll, 535.0 / 4.0), 535.0, 0.0);
            assert!(furthest(&psf(&wedge, 535.0, 0.0), &expected) < 1e-2, "{noll}");
        }
    }

    #[test]
    fn light_that_a_mask_throws_far_has_room() {
        let support = |camera: &Camera| support(camera, 535.0, 0.0, 256).0;
        assert_eq!(support(&masked(|x, y| 0.5 * (x * x + y * y))), 256);
        let far = surfaced(20.0, |x, _| 0.5 + 0.5 * (6.0 * std::f64::consts::PI * x).cos());
        assert!(support(&far) > 256);
    }

    #[test]
    fn defocus_is_the_same_by_either_name() {
        // Z4 = √3(2ρ² − 1): ψ of phase at the edge is 2√3·2π·rms/λ.
        let rms_nm = 3.0 * 460.0 / (2.0 * 3f64.sqrt() * std::f64::consts::TAU);
        let (a, b) = (
            whole_psf(&aberrated(4, -rms_nm), 460.0, 0.0, 128),
            whole_psf(&Camera::resolve("clear").unwrap(), 460.0, 3.0, 128),
        );
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn squares_hold_what_lies_in_them() {
        let mut plane = Array2::zeros((8, 8));
        (plane[(0, 0)], plane[(7, 1)], plane[(2, 6)], plane[(4, 0)]) = (1.0, 2.0, 4.0, 8.0);
        assert_eq!(square_sums(&plane), [1.0, 3.0, 7.0, 7.0]);
    }
}
