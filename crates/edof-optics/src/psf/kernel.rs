//! A PSF on the sensor's grid, as a value that is always light: odd side, nothing negative, sum 1.

use ndarray::{Array2, s};

/// Light that a point gives to the pixels around its own. Those of a lens and its mask are even about their centre along rows and
/// along columns; others ([`crate::bank`]) need not be.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Psf {
    /// Odd side, sum 1: no other is given out, and nobody can change it.
    pub(super) kernel: Array2<f32>,
    /// Share of the computed energy that the kernel held before it was scaled to sum 1.
    pub energy_kept: f64,
    /// Side of the computed support in pixels.
    pub support: usize,
    /// Estimated share of the energy that falls beyond the support, from where diffraction at the mask's edges and rays throw it;
    /// the computation folds it back in.
    pub energy_beyond: f64,
    /// Wavelengths in nanometres that were summed, equally weighted.
    pub wavelengths_nm: Vec<f64>,
    /// Share of the energy that the last refinement of the wavelengths moved; 0 for a single line.
    pub wavelength_error: f64,
}

/// A kernel that is not a PSF.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PsfError {
    /// No centre pixel.
    #[error("kernel {height}x{width}: must be square with an odd side")]
    Shape { height: usize, width: usize },
    /// Light that cannot be.
    #[error(
        "kernel: row {row}, column {column} is {value}, light is finite and never negative; set noise below 0 to 0"
    )]
    Light { row: usize, column: usize, value: f32 },
    /// Creates or loses light.
    #[error("kernel: sums to {0}, must sum to 1")]
    Sum(f32),
}

impl Psf {
    /// A PSF from a kernel of the user.
    ///
    /// # Errors
    /// [`PsfError`] if the kernel has no centre, has a weight that is negative or not finite, or does not sum to 1 within 10⁻³.
    pub fn new(kernel: Array2<f32>) -> Result<Self, PsfError> {
        let (height, width) = kernel.dim();
        if height != width || height % 2 == 0 {
            return Err(PsfError::Shape { height, width });
        }
        let light = |value: f32| value.is_finite() && value >= 0.0;
        if let Some(((row, column), &value)) = kernel.indexed_iter().find(|(_, value)| !light(**value)) {
            return Err(PsfError::Light { row, column, value });
        }
        let sum = kernel.sum();
        if (sum - 1.0).abs() > 1e-3 {
            return Err(PsfError::Sum(sum));
        }
        Ok(Self::given(kernel))
    }

    /// The kernel: of odd side, summing to 1, the point on the centre of the middle pixel.
    #[must_use]
    pub const fn kernel(&self) -> &Array2<f32> {
        &self.kernel
    }

    /// The same to keep.
    #[must_use]
    pub fn into_kernel(self) -> Array2<f32> {
        self.kernel
    }

    /// Pixels along one side of the kernel.
    #[must_use]
    pub fn side(&self) -> usize {
        self.kernel.nrows()
    }

    /// Share of this kernel's energy inside the centred square of `side` pixels, odd.
    #[must_use]
    pub fn energy_within(&self, side: usize) -> f64 {
        let half = self.side() / 2;
        let reach = (side / 2).min(half);
        let part = self.kernel.slice(s![half - reach..=half + reach, half - reach..=half + reach]);
        part.iter().map(|&v| f64::from(v)).sum::<f64>()
            / self.kernel.iter().map(|&v| f64::from(v)).sum::<f64>()
    }

    /// A kernel that sums to 1, of odd side: it is what it is.
    pub(super) fn given(kernel: Array2<f32>) -> Self {
        Self {
            support: kernel.nrows(),
            kernel,
            energy_kept: 1.0,
            energy_beyond: 0.0,
            wavelengths_nm: vec![],
            wavelength_error: 0.0,
        }
    }

    /// Whether the kernel is its own mirror image upside down, left to right, and about the diagonal, to 10⁻⁴ of its peak.
    #[must_use]
    pub fn symmetries(&self) -> [bool; 3] {
        let (kernel, last) = (&self.kernel, self.side() - 1);
        let peak = kernel.iter().fold(0.0f32, |peak, v| peak.max(*v));
        let same = |other: &dyn Fn(usize, usize) -> (usize, usize)| {
            kernel.indexed_iter().all(|((r, c), v)| (kernel[other(r, c)] - v).abs() <= 1e-4 * peak)
        };
        [same(&|r, c| (last - r, c)), same(&|r, c| (r, last - c)), same(&|r, c| (c, r))]
    }
}
