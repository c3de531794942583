//! What tests blur, and blurring by its definition.

use crate::cosine::mirror_index;
use crate::psf::Psf;
use ndarray::Array2;

/// A kernel of side 2·half + 1: even along both axes and of no other symmetry, or of none at all.
pub fn kernel(half: usize, even: bool) -> Psf {
    let side = 2 * half + 1;
    let weight = |r: usize, c: usize| {
        let lean = if even { 1.0 } else { 1.0 + ((r * 5 + c * 3) % 7) as f32 };
        lean / (1.0 + r.abs_diff(half) as f32 + 2.5 * (c.abs_diff(half) as f32).powi(2))
    };
    let raw = Array2::from_shape_fn((side, side), |(r, c)| weight(r, c));
    let sum = raw.sum();
    Psf::new(raw / sum).unwrap()
}

/// A pattern from 0 to 1 that repeats nowhere near.
pub fn picture(height: usize, width: usize, seed: u32) -> Array2<f32> {
    Array2::from_shape_fn((height, width), |(r, c)| {
        ((r as u32 * 7919 + c as u32 * 104_729).wrapping_mul(seed | 1) >> 8) as f32 / (1 << 24) as f32
    })
}

/// The sum over all of the kernel, borders mirrored.
pub fn direct(plane: &Array2<f32>, psf: &Psf) -> Array2<f32> {
    let half = (psf.kernel().nrows() / 2) as isize;
    let (height, width) = plane.dim();
    Array2::from_shape_fn((height, width), |(r, c)| {
        let terms = psf.kernel().indexed_iter().map(|((i, j), &k)| {
            let row = mirror_index(r as isize - (i as isize - half), height);
            k * plane[(row, mirror_index(c as isize - (j as isize - half), width))]
        });
        terms.sum()
    })
}
