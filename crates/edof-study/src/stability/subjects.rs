//! What the suite tries: the product's own functions, as values. A test that injects a fault passes a faulty version of one of them, and
//! the suite must name the case that finds it.

use crate::metrics::MetricError;
use edof_core::ColourFrame;
use edof_core::number::{InputWord, OutputSum};
use edof_golden::fast::Fast;
use edof_golden::{ColourTable, Trace};
use ndarray::{Array2, ArrayView2};

/// Functions under trial that somebody might break by a slip.
#[derive(Debug, Clone, Copy)]
pub struct Subjects {
    /// Every boundary of windows through a fixed network.
    pub words: fn(&Fast, &[InputWord]) -> Vec<Trace>,
    /// Rounding and saturation of an accumulator: shift, bits.
    pub requantize: fn(i64, u32, u32) -> (i16, bool),
    /// The encoded value of light.
    pub encoded: fn(&ColourTable, OutputSum) -> u16,
    /// The linear map that best explains samples.
    pub least_squares: fn(ArrayView2<'_, f32>, ArrayView2<'_, f32>, f64) -> Array2<f32>,
    /// PSNR inside a border.
    pub psnr: fn(&ColourFrame, &ColourFrame, usize) -> Result<f64, MetricError>,
}

impl Default for Subjects {
    /// The product's.
    fn default() -> Self {
        Self {
            words: Fast::traces,
            requantize: edof_core::number::requantize,
            encoded: ColourTable::encoded,
            least_squares: edof_numerics::least_squares,
            psnr: crate::metrics::psnr,
        }
    }
}
