//! Photographs and raw Bayer frames in files.
