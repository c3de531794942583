//! Deconvolution with a known kernel: linear ([`wiener`]), and the most likely light ([`richardson_lucy`]).

use crate::border::Continued;
use crate::fourier::{Fourier, Sample, Spectrum, correlation, product};
use ndarray::{Array2, ArrayView2, Zip, array};

/// The filter of least mean square error (N. Wiener) for pictures whose power falls with the square of the frequency, as natural ones'
/// does (D. J. Field 1987): X = K*·Y / (|K|² + μ·|∇|²) with ∇ the differences of neighbours. `noise_to_contrast` is μ, the variance of
/// the noise over that of a difference of neighbouring pixels.
#[must_use]
pub fn wiener(
    plane: ArrayView2<'_, f32>,
    kernel: ArrayView2<'_, f32>,
    noise_to_contrast: f32,
) -> Array2<f32> {
    let continued = Continued::new(plane, kernel);
    let plan = Fourier::new(continued.plane.dim());
    let transfer = plan.kernel(kernel);
    let gradient = gradient_power(&plan);
    let mut spectrum = correlation(&plan.forward_real(continued.plane.view()), &transfer);
    Zip::from(&mut spectrum).and(&transfer).and(&gradient).for_each(|x, k, &g| {
        *x /= (k.norm_sqr() + noise_to_contrast * g).max(f32::MIN_POSITIVE);
    });
    continued.cut(&plan.inverse_real(&spectrum))
}

/// Differences of neighbours along rows and along columns, as kernels.
pub(crate) fn differences(plan: &Fourier) -> [Spectrum; 2] {
    [plan.kernel(array![[0.0, 1.0, -1.0]].view()), plan.kernel(array![[0.0], [1.0], [-1.0]].view())]
}

/// |∇|² of each frequency.
pub(crate) fn gradient_power(plan: &Fourier) -> Array2<f32> {
    let [rows, columns] = differences(plan);
    Zip::from(&rows).and(&columns).map_collect(|a, b| a.norm_sqr() + b.norm_sqr())
}

/// Light below this is taken for this, so that ratios stay finite.
const DARK: f32 = 1e-4;

/// `steps` steps toward the light that most likely gave a picture of counted photons (W. H. Richardson 1972, L. B. Lucy 1974):
/// x ← x · Kᵀ(y / K·x), from the picture itself. It is nowhere negative, and more steps sharpen noise as well.
#[must_use]
pub fn richardson_lucy(plane: ArrayView2<'_, f32>, kernel: ArrayView2<'_, f32>, steps: usize) -> Array2<f32> {
    let mut continued = Continued::new(plane, kernel);
    continued.plane.mapv_inplace(|v| v.max(DARK));
    let plan = Fourier::new(continued.plane.dim());
    let transfer = plan.kernel(kernel);
    let mut light = continued.plane.clone();
    for _ in 0..steps {
        let seen = plan.inverse_real(&product(&plan.forward_real(light.view()), &transfer));
        let ratio = Zip::from(&continued.plane)
            .and(&seen)
            .map_collect(|y, seen| Sample::new(y / seen.max(DARK), 0.0));
        let back = plan.inverse_real(&correlation(&plan.forward(&ratio), &transfer));
        Zip::from(&mut light).and(&back).for_each(|x, &factor| *x *= factor.max(0.0));
    }
    continued.cut(&light)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_pictures::{blurred, cards, db, disc, noise, with_noise};

    #[test]
    fn no_blur_and_no_noise_change_nothing() {
        let picture = noise((24, 30), 4).mapv(|v| 0.6 + 0.3 * v);
        let point = array![[1.0f32]];
        for out in
            [wiener(picture.view(), point.view(), 0.0), richardson_lucy(picture.view(), point.view(), 5)]
        {
            assert!((&out - &picture).iter().all(|e| e.abs() < 1e-4));
        }
    }

    #[test]
    fn a_known_blur_is_undone_by_many_decibels() {
        let (sharp, kernel) = (cards(), disc(2.5));
        let seen = with_noise(&blurred(&sharp, &kernel), 0.002);
        let before = db(&sharp, &seen);
        let linear = db(&sharp, &wiener(seen.view(), kernel.view(), 2e-3));
        let likely = db(&sharp, &richardson_lucy(seen.view(), kernel.view(), 40));
        assert!(linear > before + 3.0, "Wiener: {before} to {linear}");
        assert!(likely > before + 3.0, "Richardson and Lucy: {before} to {likely}");
    }

    #[test]
    fn noise_wants_a_stronger_prior() {
        let (sharp, kernel) = (cards(), disc(2.5));
        let seen = with_noise(&blurred(&sharp, &kernel), 0.03);
        let db = |mu| db(&sharp, &wiener(seen.view(), kernel.view(), mu));
        assert!(db(0.05) > db(1e-4) + 3.0, "{} {}", db(0.05), db(1e-4));
    }

    #[test]
    fn the_most_likely_light_keeps_its_amount_and_is_never_negative() {
        let seen = with_noise(&blurred(&cards(), &disc(2.0)), 0.05).mapv(|v| v.max(0.0));
        let light = richardson_lucy(seen.view(), disc(2.0).view(), 20);
        assert!(light.iter().all(|&v| v >= 0.0));
        assert!((light.sum() / seen.sum() - 1.0).abs() < 0.01);
    }
}
