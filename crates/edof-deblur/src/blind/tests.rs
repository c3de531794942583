use super::*;
use crate::test_pictures::{blurred, cards_of, db, disc, likeness, noise, with_noise};

fn settings(side: usize) -> Settings {
    Settings { side, ..Settings::default() }
}

/// A stroke of N pixels, along rows or falling.
fn stroke(length: usize, falling: bool) -> Array2<f32> {
    let middle = length / 2;
    Array2::from_shape_fn((length, length), |(r, c)| {
        if r == if falling { c } else { middle } { 1.0 / length as f32 } else { 0.0 }
    })
}

#[test]
fn an_unknown_kernel_is_found_and_the_blur_undone() {
    let sharp = cards_of((160, 192));
    let mut gains = 0.0;
    for (name, kernel) in
        [("disc", disc(2.5)), ("stroke", stroke(9, false)), ("falling stroke", stroke(7, true))]
    {
        let seen = with_noise(&blurred(&sharp, &kernel), 0.001);
        let found = deconvolve(seen.view(), &settings(13));
        let like = likeness(found.kernel.view(), kernel.view());
        let gain = db(&sharp, &found.picture) - db(&sharp, &seen);
        assert!(like > 0.8, "{name}: kernels differ, {like}; {gain} dB");
        assert!(gain > 1.0, "{name}: {gain} dB");
        gains += gain;
        assert!((found.kernel.sum() - 1.0).abs() < 1e-4 && found.kernel.iter().all(|&v| v >= 0.0));
    }
    assert!(gains > 3.0 * 2.0, "{gains} dB over three kernels");
}

#[test]
fn a_picture_of_one_grey_stays_one() {
    let grey = Array2::from_elem((40, 50), 0.4);
    let found = deconvolve(grey.view(), &settings(7));
    assert!((&found.picture - &grey).iter().all(|e| e.abs() < 1e-3));
    assert!(found.kernel.iter().all(|v| v.is_finite()));
}

#[test]
fn a_step_that_is_too_long_is_halved_and_nothing_explodes() {
    let sharp = cards_of((96, 96));
    let seen = blurred(&sharp, &disc(1.5));
    let found = deconvolve(seen.view(), &Settings { step: 4.0, ..settings(7) });
    assert!(found.halvings > 0);
    assert!(found.picture.iter().all(|v| v.abs() < 3.0));
}

#[test]
fn a_kernel_larger_than_the_blur_is_found_too() {
    let sharp = cards_of((160, 192));
    let kernel = disc(2.5);
    let seen = with_noise(&blurred(&sharp, &kernel), 0.001);
    let found = estimate(seen.view(), &settings(25)).kernel;
    let like = likeness(found.view(), kernel.view());
    assert!(like > 0.8, "kernels differ, {like}");
}

#[test]
fn small_parts_of_a_kernel_are_dropped_and_the_largest_never() {
    let mut kernel = Array2::zeros((5, 7));
    for (at, value) in [((0, 0), 0.3), ((1, 1), 0.3), ((4, 6), 0.1), ((2, 5), 0.3)] {
        kernel[at] = value;
    }
    let kept = joined(&kernel, 0.2);
    assert_eq!((kept[(4, 6)], kept.iter().filter(|v| **v > 0.0).count()), (0.0, 3));
    assert!((kept.sum() - 1.0).abs() < 1e-6);
    assert_eq!(joined(&kernel, 1.0).iter().filter(|v| **v > 0.0).count(), 2);
}

#[test]
fn a_tiny_picture_gets_a_tiny_kernel() {
    let found = deconvolve(noise((10, 12), 3).view(), &settings(31));
    assert_eq!((found.kernel.dim(), found.picture.dim()), ((5, 5), (10, 12)));
}

#[test]
fn scales_end_at_the_whole_kernel() {
    let all = scales(31);
    assert_eq!((all[0].0, all.last().copied()), (3, Some((31, 1.0))));
    assert!(all.windows(2).all(|p| p[0].0 <= p[1].0 && (p[1].1 / p[0].1 - 2f32.sqrt()).abs() < 1e-4));
}

#[test]
fn the_short_way_multiplies_by_the_autocorrelation() {
    // Xᵀ·X·k for x on a plane that the kernel does not leave.
    let plane = (24, 24);
    let mut x = Array2::zeros(plane);
    x.slice_mut(s![8..16, 8..16]).assign(&noise((8, 8), 5));
    let k = noise((5, 5), 6);
    let plan = Fourier::new(plane);
    let spectrum = plan.forward_real(x.view());
    let scale = Scale {
        size: plane,
        side: 5,
        seen: spectrum.clone(),
        sharp: spectrum.clone(),
        sharp_sum: 0.0,
        step: 1.0,
        halvings: 0,
        steps: 0,
        plan: Fourier::new(plane),
    };
    let lags = scale.lags(&correlation(&spectrum, &spectrum), 4);
    let there = crate::fourier::product(&spectrum, &plan.kernel(k.view()));
    let back = scale.lags(&correlation(&there, &spectrum), 2);
    assert!((&autocorrelated(&lags, &k) - &back).iter().all(|e| e.abs() < 1e-4));
}

#[test]
fn conjugate_gradients_solve() {
    let a = |x: &Array2<f32>| Array2::from_shape_fn((2, 1), |(r, _)| 3.0 * x[(r, 0)] + x[(1 - r, 0)]);
    let x = conjugate_gradients(a, &ndarray::array![[1.0], [5.0]], Array2::zeros((2, 1)));
    assert!((x[(0, 0)] + 0.25).abs() < 1e-4 && (x[(1, 0)] - 1.75).abs() < 1e-4, "{x}");
}
