//! Pictures end, and circular convolution does not: planes are continued by their mirror image and faded into each other at the seam.

use crate::fourier::{Fourier, fast_length, product};
use ndarray::{Array1, Array2, ArrayView2, Axis, s};

/// A plane continued on all sides so that it may be taken for a circle.
pub(crate) struct Continued {
    /// Larger than the plane by more than the kernel on all sides, of sides that transform fast.
    pub(crate) plane: Array2<f32>,
    /// Where the plane itself begins.
    corner: (usize, usize),
    size: (usize, usize),
}

impl Continued {
    /// Continues a plane by mirroring it about its edge pixels, and fades opposite ends into each other for a kernel ([`edge_taper`]).
    pub(crate) fn new(plane: ArrayView2<'_, f32>, kernel: ArrayView2<'_, f32>) -> Self {
        let size = plane.dim();
        let reach = (kernel.nrows(), kernel.ncols());
        let whole = (fast_length(size.0 + 2 * reach.0), fast_length(size.1 + 2 * reach.1));
        let corner = ((whole.0 - size.0) / 2, (whole.1 - size.1) / 2);
        let at = |i: usize, corner: usize, n: usize| fold(i as isize - corner as isize, n);
        let wide =
            Array2::from_shape_fn(whole, |(r, c)| plane[(at(r, corner.0, size.0), at(c, corner.1, size.1))]);
        Self { plane: edge_taper(&wide, kernel), corner, size }
    }

    /// The part of a plane of the continued size that lies on the plane itself.
    pub(crate) fn cut(&self, whole: &Array2<f32>) -> Array2<f32> {
        let ((top, left), (height, width)) = (self.corner, self.size);
        whole.slice(s![top..top + height, left..left + width]).to_owned()
    }
}

/// Index inside 0..n that stands for `index` when a plane is mirrored about its edge pixels, as often as need be.
pub(crate) fn fold(index: isize, n: usize) -> usize {
    let period = (2 * n as isize - 2).max(1);
    let inside = index.rem_euclid(period) as usize;
    if inside < n { inside } else { period as usize - inside }
}

/// Fades a plane towards its own circular blur where a kernel reaches over the edge, by the kernel's autocorrelation (the edge taper
/// of S. J. Reeves, "Fast image restoration without boundary artifacts", IEEE Trans. Image Processing 14 (2005), as MATLAB has it).
pub(crate) fn edge_taper(plane: &Array2<f32>, kernel: ArrayView2<'_, f32>) -> Array2<f32> {
    let plan = Fourier::new(plane.dim());
    let transfer = plan.kernel(kernel);
    let rows = fading(&kernel.sum_axis(Axis(1)), plane.nrows());
    let columns = fading(&kernel.sum_axis(Axis(0)), plane.ncols());
    let mut out = plane.clone();
    // Each turn blurs what the last one left at the seam.
    for _ in 0..3 {
        let blurred = plan.inverse_real(&product(&plan.forward_real(out.view()), &transfer));
        out.indexed_iter_mut().for_each(|((r, c), v)| {
            let own = rows[r] * columns[c];
            *v = own * *v + (1.0 - own) * blurred[(r, c)];
        });
    }
    out
}

/// How much of itself a line keeps along its length: 1 less the autocorrelation of the kernel's projection, at the distance from the
/// nearer end.
fn fading(projection: &Array1<f32>, n: usize) -> Vec<f32> {
    let energy = projection.dot(projection).max(f32::MIN_POSITIVE);
    let correlation = |lag: usize| -> f32 {
        projection.iter().zip(projection.iter().skip(lag)).map(|(a, b)| a * b).sum::<f32>() / energy
    };
    (0..n).map(|i| 1.0 - correlation(i.min(n - 1 - i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_pictures::{disc, noise};

    #[test]
    fn a_plane_of_one_grey_stays_as_it_is() {
        let grey = Array2::from_elem((30, 40), 0.3);
        let continued = Continued::new(grey.view(), disc(3.0).view());
        assert!(continued.plane.iter().all(|v| (v - 0.3).abs() < 1e-5));
    }

    #[test]
    fn the_middle_is_kept_and_the_seam_is_smooth() {
        // Black left, white right: circularly the largest step there is.
        let ramp = Array2::from_shape_fn((48, 64), |(_, c)| c as f32 / 63.0);
        let kernel = disc(4.0);
        let tapered = edge_taper(&ramp, kernel.view());
        let step = |p: &Array2<f32>| (p[(24, 0)] - p[(24, 63)]).abs();
        assert!(step(&tapered) < 0.3 * step(&ramp), "{}", step(&tapered));
        let middle = s![12..36, 12..52];
        assert!((&tapered.slice(middle) - &ramp.slice(middle)).iter().all(|e| e.abs() < 1e-5));
    }

    #[test]
    fn what_is_cut_out_is_the_plane() {
        let plane = noise((17, 23), 5);
        let continued = Continued::new(plane.view(), Array2::from_elem((1, 1), 1.0).view());
        assert!((&continued.cut(&continued.plane) - &plane).iter().all(|e| e.abs() < 1e-5));
        assert_eq!([-3, -1, 0, 4, 5, 9].map(|i| fold(i, 5)), [3, 1, 0, 4, 3, 1]);
        assert_eq!(fold(-7, 1), 0);
    }
}
