//! TIFF and BigTIFF.

pub mod directory;
