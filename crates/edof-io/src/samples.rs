//! Pixels as a file holds them, before a meaning is given to them.

use ndarray::Array3;

/// Integer samples of a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Samples {
    /// Shape (1 or 3, rows, columns). Alpha is dropped.
    pub planes: Array3<u16>,
    /// Value of full scale: 255, 65535, or what a PGM or PPM states.
    pub full_scale: u16,
}
