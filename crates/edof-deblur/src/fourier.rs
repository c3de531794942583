//! Transforms of complex planes and of kernels on them: everything here that deconvolves stands on circular convolution.

use edof_numerics::fft::{Complex, Fft, Real};
use ndarray::{Array2, ArrayView2, Zip};
use std::sync::Arc;

/// A complex sample of a plane.
pub(crate) type Sample = Complex<f32>;

/// Plans for planes of one size.
pub(crate) struct Fourier {
    height: usize,
    width: usize,
    along_rows: Arc<dyn Fft<f32>>,
    along_columns: Arc<dyn Fft<f32>>,
}

/// A plane's transform, columns first: (width, height).
pub(crate) type Spectrum = Array2<Sample>;

impl Fourier {
    pub(crate) fn new((height, width): (usize, usize)) -> Self {
        Self { height, width, along_rows: f32::forward(width), along_columns: f32::forward(height) }
    }

    /// Transform of a complex plane.
    pub(crate) fn forward(&self, plane: &Array2<Sample>) -> Spectrum {
        let mut rows = plane.clone();
        transform_rows(&mut rows, self.along_rows.as_ref());
        let mut columns = transposed(&rows);
        transform_rows(&mut columns, self.along_columns.as_ref());
        columns
    }

    /// The plane whose transform is given.
    pub(crate) fn inverse(&self, spectrum: &Spectrum) -> Array2<Sample> {
        let mut columns = spectrum.mapv(|v| v.conj());
        transform_rows(&mut columns, self.along_columns.as_ref());
        let mut rows = transposed(&columns);
        transform_rows(&mut rows, self.along_rows.as_ref());
        let scale = 1.0 / (self.height * self.width) as f32;
        rows.mapv_inplace(|v| v.conj() * scale);
        rows
    }

    pub(crate) fn forward_real(&self, plane: ArrayView2<'_, f32>) -> Spectrum {
        self.forward(&plane.mapv(|v| Sample::new(v, 0.0)))
    }

    pub(crate) fn inverse_real(&self, spectrum: &Spectrum) -> Array2<f32> {
        self.inverse(spectrum).mapv(|v| v.re)
    }

    /// Transform of a kernel of odd sides whose middle stands on the plane's first pixel. What reaches beyond the plane wraps.
    pub(crate) fn kernel(&self, kernel: ArrayView2<'_, f32>) -> Spectrum {
        let mut plane = Array2::from_elem((self.height, self.width), Sample::default());
        let (middle_row, middle_column) = (kernel.nrows() / 2, kernel.ncols() / 2);
        for ((r, c), &value) in kernel.indexed_iter() {
            let wrap = |i: usize, middle: usize, n: usize| (i + n * middle.div_ceil(n) - middle) % n;
            let at = (wrap(r, middle_row, self.height), wrap(c, middle_column, self.width));
            plane[at] += Sample::new(value, 0.0);
        }
        self.forward(&plane)
    }
}

/// The products of two spectra.
pub(crate) fn product(a: &Spectrum, b: &Spectrum) -> Spectrum {
    Zip::from(a).and(b).map_collect(|a, b| a * b)
}

/// The products of one spectrum and the conjugate of another: correlation.
pub(crate) fn correlation(a: &Spectrum, conjugated: &Spectrum) -> Spectrum {
    Zip::from(a).and(conjugated).map_collect(|a, b| a * b.conj())
}

fn transform_rows(rows: &mut Array2<Sample>, fft: &dyn Fft<f32>) {
    let mut scratch = vec![Sample::default(); fft.get_inplace_scratch_len()];
    if let Some(all) = rows.as_slice_mut() {
        fft.process_with_scratch(all, &mut scratch);
    }
}

/// Side of the blocks in which planes are turned over, so that both stay in the cache.
const BLOCK: usize = 32;

fn transposed(plane: &Array2<Sample>) -> Array2<Sample> {
    let (height, width) = plane.dim();
    let mut out = Array2::from_elem((width, height), Sample::default());
    let (Some(from), Some(to)) = (plane.as_slice(), out.as_slice_mut()) else {
        unreachable!("planes of ours are in row order")
    };
    for top in (0..height).step_by(BLOCK) {
        for left in (0..width).step_by(BLOCK) {
            for c in left..width.min(left + BLOCK) {
                for r in top..height.min(top + BLOCK) {
                    to[c * height + r] = from[r * width + c];
                }
            }
        }
    }
    out
}

/// The least number of at least `n` whose only prime factors are 2, 3 and 5: transforms of such lengths are fast.
pub(crate) fn fast_length(n: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (n.max(1)..).find(|&n| smooth(n)).unwrap_or(n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_pictures::noise;

    #[test]
    fn a_plane_comes_back_from_its_transform() {
        for size in [(12, 20), (7, 5), (1, 9), (40, 36)] {
            let plan = Fourier::new(size);
            let plane = noise(size, 1);
            let back = plan.inverse_real(&plan.forward_real(plane.view()));
            assert!((&back - &plane).iter().all(|e| e.abs() < 1e-6), "{size:?}");
        }
    }

    #[test]
    fn a_product_with_a_kernel_is_circular_convolution() {
        let (plane, kernel) = (noise((9, 11), 2), noise((5, 3), 3));
        let plan = Fourier::new((9, 11));
        let fast = plan.inverse_real(&product(&plan.forward_real(plane.view()), &plan.kernel(kernel.view())));
        for ((r, c), &value) in fast.indexed_iter() {
            let terms = kernel
                .indexed_iter()
                .map(|((i, j), k)| k * plane[((r + 9 + 2 - i) % 9, (c + 11 + 1 - j) % 11)]);
            assert!((terms.sum::<f32>() - value).abs() < 1e-5);
        }
    }

    #[test]
    fn fast_lengths_are_products_of_small_primes() {
        assert_eq!([1, 7, 31, 97, 121, 768].map(fast_length), [1, 8, 32, 100, 125, 768]);
    }
}
