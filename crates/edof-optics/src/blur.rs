//! Blurring pictures with PSFs: mirrored borders, kernels of any size, and the adjoint.

use crate::composite;
use crate::cosine::{EvenTransform, Parity, fold_rows_as, period};
use crate::psf::Psf;
use crate::tiles::Tiles;
use edof_core::ColourFrame;
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;

/// Plans for blurring planes of one size. A plane's spectrum can be blurred by many PSFs, a PSF's transfer can blur many planes;
/// each further pair then costs one multiplication and one transform.
///
/// ```
/// use edof_optics::{Blur, psf::{Settings, channel_psfs}};
/// let psfs = channel_psfs(&edof_core::camera::Camera::resolve("ring-2018")?, 4.0, &Settings::default())?;
/// let plan = Blur::new(20, 30);
/// let spectrum = plan.spectrum(ndarray::Array2::from_elem((20, 30), 0.5).view());
/// let blurred = plan.apply(&spectrum, &plan.transfer(&psfs[0]));
/// assert!((blurred[(3, 3)] - 0.5).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Blur {
    along_rows: EvenTransform<f32>,
    along_columns: EvenTransform<f32>,
}

/// Spectrum of a mirrored plane, as [`Blur::spectrum`] gives it.
#[derive(Debug, Clone)]
pub struct Spectrum(Array2<f32>);

/// What a PSF does to each frequency of a mirrored plane of one size, scaled for the way back. An even PSF is one part; any other
/// is the sum of up to four, each even or odd along each axis.
#[derive(Debug, Clone)]
pub struct Transfer(Vec<Part>);

/// What a kernel of one parity along each axis does to each frequency.
#[derive(Debug, Clone)]
struct Part {
    down: Parity,
    across: Parity,
    values: Array2<f32>,
}

impl Blur {
    /// Plans for planes of `height`×`width` pixels, one pixel at least.
    #[must_use]
    pub fn new(height: usize, width: usize) -> Self {
        Self { along_rows: EvenTransform::new(width), along_columns: EvenTransform::new(height) }
    }

    /// Rows and columns of the planes.
    #[must_use]
    pub const fn size(&self) -> (usize, usize) {
        (self.along_columns.len(), self.along_rows.len())
    }

    /// Spectrum of a plane, mirrored without end about its edge pixels.
    #[must_use]
    pub fn spectrum(&self, plane: ArrayView2<f32>) -> Spectrum {
        assert_eq!(plane.dim(), self.size(), "the plan is for another size");
        Spectrum(self.transform(plane, Parity::Even, Parity::Even))
    }

    /// The transfer function of a PSF on planes of this size.
    #[must_use]
    pub fn transfer(&self, psf: &Psf) -> Transfer {
        let (height, width) = self.size();
        let scale = 1.0 / (period(height) * period(width)) as f32;
        let part = |(down, across, quarter): (Parity, Parity, Array2<f32>)| {
            let wide = fold_rows_as(quarter.view(), width, across);
            let wrapped = fold_rows_as(wide.t(), height, down);
            Part { down, across, values: self.transform(wrapped.t(), down, across) * scale }
        };
        Transfer(parts(psf.kernel()).into_iter().map(part).collect())
    }

    /// The plane of `spectrum` blurred by the PSF of `transfer`.
    #[must_use]
    pub fn apply(&self, spectrum: &Spectrum, transfer: &Transfer) -> Array2<f32> {
        let blurred =
            |part: &Part| self.transform((&spectrum.0 * &part.values).view(), part.down, part.across);
        sum(self.size(), transfer.0.iter().map(blurred))
    }

    /// Transform of a plane of which one quarter is given, of one parity down the columns and one across the rows.
    fn transform(&self, plane: ArrayView2<f32>, down: Parity, across: Parity) -> Array2<f32> {
        let (height, width) = self.size();
        let half_way = self.along_rows.rows_transposed_as(plane, width, across);
        self.along_columns.rows_transposed_as(half_way.view(), height, down)
    }
}

fn sum(size: (usize, usize), planes: impl Iterator<Item = Array2<f32>>) -> Array2<f32> {
    planes.reduce(|sum, plane| sum + plane).unwrap_or_else(|| Array2::zeros(size))
}

/// The parts of a kernel that are even or odd along each axis, as quarters with the axes; those that are zero are left out.
fn parts(kernel: &Array2<f32>) -> Vec<(Parity, Parity, Array2<f32>)> {
    let (half, last) = (kernel.nrows() / 2, kernel.nrows() - 1);
    let quarter = |down: Parity, across: Parity| {
        let (d, a): (f32, f32) = (down.sign(), across.sign());
        Array2::from_shape_fn((half + 1, half + 1), |(i, j)| {
            let (r, c) = (half + i, half + j);
            let here = kernel[(r, c)] + d * kernel[(last - r, c)];
            let there = kernel[(r, last - c)] + d * kernel[(last - r, last - c)];
            0.25 * (here + a * there)
        })
    };
    let kinds = Parity::ALL.into_iter().flat_map(|down| Parity::ALL.map(|across| (down, across)));
    let all = kinds.map(|(down, across)| (down, across, quarter(down, across)));
    all.filter(|(.., values)| values.iter().any(|v| *v != 0.0)).collect()
}

/// Blurs one colour plane with a PSF (paper §2, image formation). Linear light in, linear light out; borders mirrored about the
/// edge pixel, as often as the kernel reaches.
#[must_use]
pub fn blur(plane: ArrayView2<f32>, psf: &Psf) -> Array2<f32> {
    if let Some(tiles) = Tiles::of_large(plane.dim(), [psf]) {
        let light = plane.insert_axis(Axis(0));
        return composite::blurred(&tiles, light, std::slice::from_ref(psf)).index_axis_move(Axis(0), 0);
    }
    let plan = Blur::new(plane.nrows(), plane.ncols());
    plan.apply(&plan.spectrum(plane), &plan.transfer(psf))
}

/// Adjoint of [`blur`]: ⟨blur(x), y⟩ = ⟨x, blur_adjoint(y)⟩.
///
/// Pixels inside the picture stand in the mirrored plane twice along each axis and those of its border once. With W the diagonal
/// of these counts the adjoint is W·B·W⁻¹, where B goes through the transforms of [`Blur::apply`] in the other order: for an even
/// kernel it is the blur itself.
#[must_use]
pub fn blur_adjoint(plane: ArrayView2<f32>, psf: &Psf) -> Array2<f32> {
    let (height, width) = plane.dim();
    let plan = Blur::new(height, width);
    let count = |index: usize, n: usize| if index == 0 || index + 1 == n { 1.0 } else { 2.0 };
    let weights = Array2::from_shape_fn((height, width), |(r, c)| count(r, height) * count(c, width));
    let shared = &plane / &weights;
    let back = |part: &Part| {
        let spectrum = plan.transform(shared.view(), part.down, part.across);
        plan.transform((spectrum * &part.values).view(), Parity::Even, Parity::Even)
    };
    sum((height, width), plan.transfer(psf).0.iter().map(back)) * weights
}

/// Blurs each plane of a frame with the PSF of its channel.
#[must_use]
pub fn blur_frame(frame: &ColourFrame, psfs: &[Psf; 3]) -> ColourFrame {
    if let Some(tiles) = Tiles::of_large(frame.size(), psfs) {
        return ColourFrame { planes: composite::blurred(&tiles, frame.planes.view(), psfs) };
    }
    let (height, width) = frame.size();
    let plan = Blur::new(height, width);
    let channels: Vec<_> = frame.planes.axis_iter(Axis(0)).zip(psfs).collect();
    let blurred: Vec<_> = channels
        .into_par_iter()
        .map(|(plane, psf)| plan.apply(&plan.spectrum(plane), &plan.transfer(psf)))
        .collect();
    let mut out = ColourFrame::zeros(height, width);
    out.planes.axis_iter_mut(Axis(0)).zip(&blurred).for_each(|(mut plane, b)| plane.assign(b));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::{direct, kernel, picture};
    use proptest::prelude::*;

    #[test]
    fn light_goes_where_the_kernel_says_and_an_even_kernel_is_one_part() {
        let mut spot = Array2::zeros((9, 11));
        spot[(4, 5)] = 1.0;
        let mut ghost = Array2::zeros((5, 5));
        (ghost[(2, 2)], ghost[(1, 4)]) = (0.75, 0.25);
        let blurred = blur(spot.view(), &Psf::new(ghost.clone()).unwrap());
        assert!((blurred[(4, 5)] - 0.75).abs() < 1e-6 && (blurred[(3, 7)] - 0.25).abs() < 1e-6);
        // A coma that points up is even from left to right.
        let coma = Array2::from_shape_fn((3, 3), |(r, _)| [0.1f32, 0.2, 0.0][r]);
        let count = |kernel: &Array2<f32>| parts(kernel).len();
        assert_eq!((count(&ghost), count(&coma), count(kernel(3, true).kernel())), (4, 2, 1));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn blurring_is_convolution_with_mirrored_borders(
            height in 1usize..14, width in 1usize..14, half in 0usize..20, even in any::<bool>(), seed in any::<u32>()
        ) {
            let (plane, psf) = (picture(height, width, seed), kernel(half, even));
            let (fast, slow) = (blur(plane.view(), &psf), direct(&plane, &psf));
            for (a, b) in fast.iter().zip(&slow) { prop_assert!((a - b).abs() < 1e-5); }
        }

        #[test]
        fn the_adjoint_passes_the_dot_product_test(
            height in 1usize..40, width in 1usize..40, half in 0usize..30, even in any::<bool>(), seed in any::<u32>()
        ) {
            let (x, y, psf) = (picture(height, width, seed), picture(height, width, !seed), kernel(half, even));
            let dot = |a: &Array2<f32>, b: &Array2<f32>| -> f64 {
                a.iter().zip(b).map(|(&u, &v)| f64::from(u) * f64::from(v)).sum()
            };
            let left = dot(&blur(x.view(), &psf), &y);
            let right = dot(&x, &blur_adjoint(y.view(), &psf));
            prop_assert!((left - right).abs() <= 1e-5 * left.abs().max(1.0), "{left} {right}");
        }
    }
}
