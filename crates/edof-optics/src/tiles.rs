//! Large planes blurred tile by tile (overlap-save): what is transformed at a time stays in a processor's caches.
//!
//! A tile and all that its blur depends on, mirrored where the picture ends, lie in one period; what wraps round in there falls outside
//! the tile. Rows are real, so two ride in one complex transform, and half of the spectrum says everything. It is kept column by
//! column: a column is transformed, multiplied and transformed back while it is in the first cache.

use crate::cosine::mirror_index;
use crate::psf::Psf;
use edof_numerics::fft::{Complex, Fft, Real, is_smooth};
use ndarray::{Array2, ArrayView2, ArrayViewMut1, s};
use std::ops::Range;
use std::sync::Arc;

/// Rows transformed at a time: with 8 complex `f32` a written cache line is filled at once.
const BLOCK: usize = 8;
/// Pixels from which on a picture is cut into tiles. Smaller ones stay whole, and what was measured with them keeps every bit.
const LARGE: usize = 4_000_000;
/// The longest period where kernels reach no farther than 128 pixels: half a plane of it takes 2.4 MB. Longer ones cost less arithmetic,
/// and more time.
const LONG: usize = 768;
/// The longest of all.
const LONGEST: usize = 2048;

const ZERO: Complex<f32> = Complex::new(0.0, 0.0);

/// How planes of one size are cut, and plans for blurring the tiles with kernels that reach a number of pixels to each side.
pub struct Tiles {
    size: (usize, usize),
    reach: usize,
    down: Cut,
    across: Cut,
}

/// How one side is cut: pieces of `step` pixels, each transformed with what is around it as one period.
struct Cut {
    step: usize,
    period: usize,
    forward: Arc<dyn Fft<f32>>,
    inverse: Arc<dyn Fft<f32>>,
}

/// Pixels of a tile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tile {
    pub rows: Range<usize>,
    pub columns: Range<usize>,
}

/// What a PSF does to each frequency of half a spectrum, column by column, scaled for the way back.
pub enum Transfer {
    /// Of a kernel that is its own image through its middle.
    Even(Vec<f32>),
    /// Of any other.
    Any(Vec<Complex<f32>>),
}

impl Tiles {
    /// The cheapest way to cut planes of `size` (rows, columns) for some PSFs; none where planes are small or kernels reach too far.
    pub fn of_large<'a>(size: (usize, usize), psfs: impl IntoIterator<Item = &'a Psf>) -> Option<Self> {
        if size.0 * size.1 < LARGE {
            return None;
        }
        let reach = psfs.into_iter().map(|psf| psf.side() / 2).max()?;
        Some(Self::with_periods(size, reach, (cheapest(size.0, reach)?, cheapest(size.1, reach)?)))
    }

    /// Tiles that are transformed in periods of N rows and columns.
    pub fn with_periods(size: (usize, usize), reach: usize, periods: (usize, usize)) -> Self {
        let (down, across) = (Cut::new(size.0, reach, periods.0), Cut::new(size.1, reach, periods.1));
        Self { size, reach, down, across }
    }

    /// Rows and columns of the planes.
    pub const fn size(&self) -> (usize, usize) {
        self.size
    }

    /// Rows and columns of a tile; the last ones may have fewer.
    pub const fn step(&self) -> (usize, usize) {
        (self.down.step, self.across.step)
    }

    /// All pixels that a tile's blur depends on.
    pub fn around(&self, tile: &Tile) -> Tile {
        // Those beyond a border are images of some that are near it.
        let wider = |pixels: &Range<usize>, length: usize| {
            pixels.start.saturating_sub(self.reach)..(pixels.end + self.reach).min(length)
        };
        Tile { rows: wider(&tile.rows, self.size.0), columns: wider(&tile.columns, self.size.1) }
    }

    /// The transfer function of a PSF.
    pub fn transfer(&self, psf: &Psf) -> Transfer {
        let (kernel, half) = (psf.kernel(), psf.side() / 2);
        assert!(half <= self.reach, "a kernel that reaches {half} pixels in tiles for {}", self.reach);
        let (rows, columns) = (self.down.period, self.across.period);
        let mut wrapped = Array2::zeros((rows, columns));
        for ((r, c), value) in kernel.indexed_iter() {
            wrapped[((r + rows - half) % rows, (c + columns - half) % columns)] = *value;
        }
        let mut space = Workspace::new(self, 1);
        space.rows_forth(self, |row, mut line| line.assign(&wrapped.row(row)));
        // Rows come out doubled, here and of a plane.
        let scale = 0.25 / (rows * columns) as f32;
        let mut values = Vec::with_capacity(self.half() * rows);
        for column in space.spectra[0].chunks_exact_mut(self.stride()) {
            let column = &mut column[..rows];
            self.down.forward.process_with_scratch(column, &mut space.scratch);
            values.extend(column.iter().map(|v| v * scale));
        }
        let even = kernel == kernel.slice(s![..;-1, ..;-1]);
        if even { Transfer::Even(values.iter().map(|v| v.re).collect()) } else { Transfer::Any(values) }
    }

    /// Columns of half a spectrum.
    const fn half(&self) -> usize {
        self.across.period / 2 + 1
    }

    /// From one column of half a spectrum to the next: at least a cache line more than its length, lest a row's values share a cache set.
    const fn stride(&self) -> usize {
        self.down.period.next_multiple_of(BLOCK) + BLOCK
    }
}

/// The period at which a side costs least, among sides with fast transforms and with surroundings of less than half.
fn cheapest(length: usize, reach: usize) -> Option<usize> {
    let cost = |n: &usize| length.div_ceil(n - 2 * reach) as f64 * *n as f64 * (*n as f64).log2();
    let longest = LONG.max(6 * reach).min(LONGEST);
    let periods = (256..=longest).step_by(32).filter(|n| is_smooth(*n) && 4 * reach <= *n);
    periods.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

impl Cut {
    fn new(length: usize, reach: usize, period: usize) -> Self {
        assert!(
            period > 2 * reach,
            "a period of {period} holds nothing but the surroundings, {reach} a side"
        );
        // All pieces have one size, no sliver at the end.
        let step = length.div_ceil(length.div_ceil(period - 2 * reach));
        Self { step, period, forward: f32::forward(period), inverse: f32::inverse(period) }
    }
}

impl Transfer {
    /// Multiplies a column of half a spectrum.
    fn apply(&self, index: usize, column: &mut [Complex<f32>]) {
        let part = index * column.len()..(index + 1) * column.len();
        match self {
            Self::Even(values) => column.iter_mut().zip(&values[part]).for_each(|(c, v)| *c *= *v),
            Self::Any(values) => column.iter_mut().zip(&values[part]).for_each(|(c, v)| *c *= *v),
        }
    }
}

/// Memory in which one tile after another is blurred.
pub struct Workspace {
    /// Two rows, before or after they ride together.
    lines: [Vec<f32>; 2],
    /// Rows in pairs.
    block: Vec<Complex<f32>>,
    /// Half a spectrum for each PSF, column by column.
    spectra: Vec<Vec<Complex<f32>>>,
    scratch: Vec<Complex<f32>>,
}

impl Workspace {
    /// For blurring with at most N PSFs at a time.
    pub fn new(tiles: &Tiles, psfs: usize) -> Self {
        let plans = [&tiles.down, &tiles.across].into_iter().flat_map(|cut| [&cut.forward, &cut.inverse]);
        let scratch = plans.map(|plan| plan.get_inplace_scratch_len()).max().unwrap_or(0);
        let period = tiles.across.period;
        Self {
            lines: [vec![0.0; period], vec![0.0; period]],
            block: vec![ZERO; BLOCK / 2 * period],
            spectra: vec![vec![ZERO; tiles.half() * tiles.stride()]; psfs],
            scratch: vec![ZERO; scratch],
        }
    }

    /// Blurs a tile of a plane with each of `transfers` and hands over its rows: `seen(transfer, row, values)`, both from 0 on.
    pub fn blur(
        &mut self,
        tiles: &Tiles,
        plane: ArrayView2<f32>,
        tile: &Tile,
        transfers: &[&Transfer],
        mut seen: impl FnMut(usize, usize, &[f32]),
    ) {
        let (height, width) = tiles.size;
        let first = |pixels: &Range<usize>| pixels.start as isize - tiles.reach as isize;
        let (top, left) = (first(&tile.rows), first(&tile.columns));
        let inside = tiles.around(tile).columns;
        let start = (inside.start as isize - left) as usize;
        let (rows, columns) = (tile.rows.len() + 2 * tiles.reach, tile.columns.len() + 2 * tiles.reach);
        self.rows_forth(tiles, |row, mut line| {
            if row >= rows {
                return;
            }
            let source = plane.row(mirror_index(top + row as isize, height));
            line.slice_mut(s![start..start + inside.len()]).assign(&source.slice(s![inside.clone()]));
            for at in (0..start).chain(start + inside.len()..columns) {
                line[at] = source[mirror_index(left + at as isize, width)];
            }
        });
        self.filter_columns(tiles, transfers);
        for psf in 0..transfers.len() {
            self.rows_back(tiles, psf, tile, |row, values| seen(psf, row, values));
        }
    }

    /// Transforms all rows of a period into the first half spectrum, doubled; `fill(row, line)` writes one into zeros.
    fn rows_forth(&mut self, tiles: &Tiles, fill: impl Fn(usize, ArrayViewMut1<f32>)) {
        let (period, stride) = (tiles.across.period, tiles.stride());
        let Self { lines: [a, b], block, spectra, scratch } = self;
        for first in (0..tiles.down.period).step_by(BLOCK) {
            for (row, both) in (first..).step_by(2).zip(block.chunks_exact_mut(period)) {
                for (row, line) in (row..).zip([&mut *a, &mut *b]) {
                    line.fill(0.0);
                    if row < tiles.down.period {
                        fill(row, ArrayViewMut1::from(line));
                    }
                }
                both.iter_mut().zip(a.iter().zip(b.iter())).for_each(|(z, (&a, &b))| *z = Complex::new(a, b));
            }
            if block.iter().any(|z| *z != ZERO) {
                tiles.across.forward.process_with_scratch(block, scratch);
            }
            let pairs = pairs(block, period);
            for k in 0..tiles.half() {
                let mirror = if k == 0 { 0 } else { period - k };
                let mut apart = [ZERO; BLOCK];
                for (two, pair) in apart.chunks_exact_mut(2).zip(&pairs) {
                    let (z, w) = (pair[k], pair[mirror]);
                    two[0] = Complex::new(z.re + w.re, z.im - w.im);
                    two[1] = Complex::new(z.im + w.im, w.re - z.re);
                }
                spectra[0][k * stride + first..][..BLOCK].copy_from_slice(&apart);
            }
        }
    }

    /// From the first half spectrum of a plane, its rows transformed, those of the plane blurred by each PSF.
    fn filter_columns(&mut self, tiles: &Tiles, transfers: &[&Transfer]) {
        let Cut { period, forward, inverse, .. } = &tiles.down;
        let Self { spectra, scratch, .. } = self;
        let (Some((spectrum, others)), Some((transfer, more))) =
            (spectra.split_first_mut(), transfers.split_first())
        else {
            return;
        };
        for k in 0..tiles.half() {
            let place = k * tiles.stride()..k * tiles.stride() + period;
            let column = &mut spectrum[place.clone()];
            forward.process_with_scratch(column, scratch);
            for (other, transfer) in others.iter_mut().zip(more) {
                let other = &mut other[place.clone()];
                other.copy_from_slice(column);
                transfer.apply(k, other);
                inverse.process_with_scratch(other, scratch);
            }
            transfer.apply(k, column);
            inverse.process_with_scratch(column, scratch);
        }
    }

    /// Transforms a tile's rows back from one of the half spectra.
    fn rows_back(&mut self, tiles: &Tiles, psf: usize, tile: &Tile, mut seen: impl FnMut(usize, &[f32])) {
        let (period, stride, reach) = (tiles.across.period, tiles.stride(), tiles.reach);
        let Self { lines: [line, _], block, spectra, scratch } = self;
        let line = &mut line[..tile.columns.len()];
        for first in (0..tile.rows.len()).step_by(BLOCK) {
            let mut pairs = pairs(block, period);
            for k in 0..tiles.half() {
                let mut apart = [ZERO; BLOCK];
                apart.copy_from_slice(&spectra[psf][k * stride + reach + first..][..BLOCK]);
                let mirror = if k == 0 { 0 } else { period - k };
                for (two, pair) in apart.chunks_exact(2).zip(&mut pairs) {
                    let (a, b) = (two[0], two[1]);
                    pair[mirror] = Complex::new(a.re + b.im, b.re - a.im);
                    pair[k] = Complex::new(a.re - b.im, a.im + b.re);
                }
            }
            tiles.across.inverse.process_with_scratch(block, scratch);
            for row in 0..BLOCK.min(tile.rows.len() - first) {
                let both = &block[row / 2 * period + reach..];
                if row % 2 == 0 {
                    line.iter_mut().zip(both).for_each(|(v, z)| *v = z.re);
                } else {
                    line.iter_mut().zip(both).for_each(|(v, z)| *v = z.im);
                }
                seen(first + row, line);
            }
        }
    }
}

/// The pairs of rows of a block.
fn pairs(block: &mut [Complex<f32>], period: usize) -> [&mut [Complex<f32>]; BLOCK / 2] {
    let mut rows = block.chunks_exact_mut(period);
    std::array::from_fn(|_| rows.next().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::kernel;

    fn periods(size: (usize, usize), half: usize) -> Option<(usize, usize)> {
        Tiles::of_large(size, [&kernel(half, true)]).map(|tiles| (tiles.down.period, tiles.across.period))
    }

    #[test]
    fn large_pictures_are_cut_where_kernels_are_small_beside_a_tile() {
        assert_eq!(periods((1080, 1920), 100), None);
        assert_eq!(periods((4000, 6000), 513), None);
        for half in [0, 1, 122, 512] {
            let (down, across) = periods((4000, 6000), half).unwrap();
            assert!(
                [down, across].iter().all(|n| (256..=2048).contains(n) && is_smooth(*n) && *n >= 4 * half)
            );
        }
        assert_eq!(periods((4000, 6000), 122), Some((768, 768)));
    }

    #[test]
    fn the_tiles_of_a_side_are_alike() {
        let tiles = Tiles::with_periods((1000, 101), 10, (320, 120));
        assert_eq!(tiles.step(), (250, 51));
    }
}
