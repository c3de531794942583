//! The size of a design's pictures.

use edof_core::geometry::Stride;
use serde::{Deserialize, Serialize};

/// Size of a picture and the stride of its patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameSize {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Stride between patches.
    pub stride: Stride,
}
