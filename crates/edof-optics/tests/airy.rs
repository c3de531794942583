//! The PSF against what the textbooks know in closed form.

use edof_optics::psf::{SUPPORT, Settings, psf, quarter_otf, quarter_psf, wave_um};
use edof_spec::{Camera, Channel};

#[test]
fn a_clear_pupil_in_focus_has_the_known_mtf() {
    let camera = Camera::resolve("clear").unwrap();
    for nm in [460.0, 535.0, 610.0] {
        let otf = quarter_otf(&camera, nm, 0.0, SUPPORT);
        let cutoff = SUPPORT as f64 * camera.pixel_pitch_um / wave_um(&camera, nm);
        for q in 0..otf.ncols() {
            let s = (q as f64 / cutoff).min(1.0);
            let known = std::f64::consts::FRAC_2_PI * (s.acos() - s * (1.0 - s * s).sqrt());
            assert!((otf[(0, q)] - known).abs() < 2e-3, "{nm} nm, s = {s}: {} not {known}", otf[(0, q)]);
        }
    }
}

/// J₁ by its integral.
fn j1(x: f64) -> f64 {
    let n = 400;
    let term = |i: usize| {
        let t = (i as f64 + 0.5) / n as f64 * std::f64::consts::PI;
        (t - x * t.sin()).cos()
    };
    (0..n).map(term).sum::<f64>() / n as f64
}

/// With pixels far smaller than the Airy disk the PSF is the pattern itself.
#[test]
fn fine_pixels_see_the_airy_pattern_and_its_first_zero() {
    let mut camera = Camera::resolve("clear").unwrap();
    camera.pixel_pitch_um = 0.1;
    let pattern = quarter_psf(&camera, 535.0, 0.0);
    let wave = wave_um(&camera, 535.0);
    for i in 1..60 {
        let v = std::f64::consts::PI * i as f64 * camera.pixel_pitch_um / wave;
        let airy = (2.0 * j1(v) / v).powi(2);
        let seen = pattern[(0, i)] / pattern[(0, 0)];
        assert!((seen - airy).abs() < 3e-3, "pixel {i}: {seen} not {airy}");
    }
    let darkest = (10..30).min_by(|&a, &b| pattern[(0, a)].total_cmp(&pattern[(0, b)])).unwrap();
    let zero = 1.219_67 * wave / camera.pixel_pitch_um;
    assert!((darkest as f64 - zero).abs() <= 0.5, "first zero at {darkest} pixels, not {zero}");
}

#[test]
fn every_kernel_sums_to_one_and_keeps_the_energy_it_was_asked_to() {
    for name in ["clear", "ring-2018", "ring-outer"] {
        let camera = Camera::resolve(name).unwrap();
        for energy in [0.9, 0.99, 0.999] {
            let cut = psf(&camera, Channel::Green, 5.0, &Settings { energy, ..Settings::default() });
            let whole = psf(&camera, Channel::Green, 5.0, &Settings::exact());
            assert!((cut.kernel.sum() - 1.0).abs() < 1e-5);
            assert!(cut.energy_kept >= energy);
            assert!((whole.energy_within(cut.side()) - cut.energy_kept).abs() < 1e-4);
            assert!(whole.energy_within(cut.side() - 2) < energy, "{name}: a smaller square would do");
        }
    }
}
