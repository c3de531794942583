//! Pictures and kernels of which tests know everything.

use crate::border::fold;
use ndarray::{Array2, ArrayView2, s};

/// Numbers of −1…1 without a pattern.
pub(crate) fn noise(size: (usize, usize), seed: u64) -> Array2<f32> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    Array2::from_shape_simple_fn(size, || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    })
}

/// Cards of many sizes and greys on top of each other: edges as photographs have them.
pub(crate) fn cards() -> Array2<f32> {
    cards_of((128, 160))
}

pub(crate) fn cards_of(size: (usize, usize)) -> Array2<f32> {
    let draw = noise((90, 5), 77).mapv(|v| 0.5 + 0.5 * v);
    let mut picture = Array2::from_elem(size, 0.45);
    for (i, card) in draw.outer_iter().enumerate() {
        let side = 40.0 / (1.0 + i as f32 / 8.0) + 4.0;
        let (y, x) = (card[0] * size.0 as f32, card[1] * size.1 as f32);
        let (height, width) = (side * (0.5 + card[2]), side * (0.5 + card[3]));
        let lean = card[2] - 0.5;
        for ((r, c), v) in picture.indexed_iter_mut() {
            let (dy, dx) = (r as f32 - y, c as f32 - x);
            if (dy + lean * dx).abs() < height / 2.0 && (dx - lean * dy).abs() < width / 2.0 {
                *v = 0.05 + 0.9 * card[4];
            }
        }
    }
    picture
}

/// A disc of a radius in pixels, edges smoothed by four times four samples a pixel.
pub(crate) fn disc(radius: f32) -> Array2<f32> {
    let half = radius.ceil() as usize;
    let side = 2 * half + 1;
    let inside = |r: usize, c: usize| {
        let offset = |i: usize, sub: usize| i as f32 - half as f32 + (sub as f32 - 1.5) / 4.0;
        (0..16).filter(|s| offset(r, s / 4).hypot(offset(c, s % 4)) <= radius).count() as f32
    };
    let kernel = Array2::from_shape_fn((side, side), |(r, c)| inside(r, c));
    let sum = kernel.sum();
    kernel / sum
}

/// Convolution with mirrored borders.
pub(crate) fn blurred(plane: &Array2<f32>, kernel: &Array2<f32>) -> Array2<f32> {
    let (height, width) = plane.dim();
    let (half_r, half_c) = (kernel.nrows() as isize / 2, kernel.ncols() as isize / 2);
    Array2::from_shape_fn((height, width), |(r, c)| {
        let terms = kernel.indexed_iter().map(|((i, j), k)| {
            let at = |p: usize, i: usize, half: isize, n| fold(p as isize + half - i as isize, n);
            k * plane[(at(r, i, half_r, height), at(c, j, half_c, width))]
        });
        terms.sum()
    })
}

pub(crate) fn with_noise(plane: &Array2<f32>, sigma: f32) -> Array2<f32> {
    // Uniform noise of that standard deviation.
    plane + &(noise(plane.dim(), 9) * (sigma * 3f32.sqrt()))
}

/// PSNR with peak 1, 12 pixels of border left out.
pub(crate) fn db(truth: &Array2<f32>, estimate: &Array2<f32>) -> f64 {
    let inner = |p: &Array2<f32>| p.slice(s![12..p.nrows() - 12, 12..p.ncols() - 12]).to_owned();
    let error = (&inner(truth) - &inner(estimate)).mapv(|e| f64::from(e * e)).mean().unwrap_or(f64::NAN);
    -10.0 * error.log10()
}

/// The cosine of two kernels of the same or different odd sides, at the best shift of up to three pixels.
pub(crate) fn likeness(a: ArrayView2<'_, f32>, b: ArrayView2<'_, f32>) -> f32 {
    let at = |k: &ArrayView2<'_, f32>, r: isize, c: isize| {
        let (row, column) = (r + k.nrows() as isize / 2, c + k.ncols() as isize / 2);
        usize::try_from(row)
            .ok()
            .zip(usize::try_from(column).ok())
            .and_then(|at| k.get(at))
            .copied()
            .unwrap_or(0.0)
    };
    let norm = |k: &ArrayView2<'_, f32>| k.iter().map(|v| v * v).sum::<f32>().sqrt();
    let reach = (a.nrows().max(b.nrows()) / 2 + 3) as isize;
    let cosine = |dr: isize, dc: isize| {
        let both = (-reach..=reach).flat_map(|r| (-reach..=reach).map(move |c| (r, c)));
        both.map(|(r, c)| at(&a, r, c) * at(&b, r + dr, c + dc)).sum::<f32>() / (norm(&a) * norm(&b))
    };
    (-3..=3).flat_map(|dr| (-3..=3).map(move |dc| cosine(dr, dc))).fold(0.0, f32::max)
}
