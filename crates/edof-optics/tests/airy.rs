//! The PSF against what the textbooks know in closed form.

use edof_core::Channel;
use edof_core::camera::{Camera, Sign, Spectrum};
use edof_optics::psf::{Settings, channel_psfs, otf_along_row, psf, quarter_otf, quarter_psf};
use edof_optics::{Footprint, otf};

#[test]
fn a_clear_pupil_in_focus_has_the_known_mtf() {
    let camera = Camera::resolve("clear").unwrap();
    for nm in [460.0, 535.0, 610.0] {
        let otf = quarter_otf(&camera, nm, 0.0, 512);
        let cutoff = 512.0 * camera.pixel_pitch_um / camera.wave_um(nm);
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
    let pattern = quarter_psf(&camera, 535.0, 0.0, 512);
    let wave = camera.wave_um(535.0);
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
            let cut = psf(&camera, Channel::Green, 5.0, &Settings { energy, ..Settings::default() }).unwrap();
            let whole = psf(&camera, Channel::Green, 5.0, &Settings::exact()).unwrap();
            assert!((cut.kernel().sum() - 1.0).abs() < 1e-5);
            assert!(cut.energy_kept >= energy);
            let share = whole.energy_within(cut.side());
            assert!(
                (share - cut.energy_kept).abs() < cut.energy_beyond + 3e-3,
                "{name} {energy}: {share} {}",
                cut.energy_kept
            );
            assert!(cut.energy_beyond < (1.0 - energy).max(2.5e-3), "{name}: {} beyond", cut.energy_beyond);
            assert!(
                cut.energy_within(cut.side() - 2) * cut.energy_kept < energy,
                "{name}: a smaller square would do"
            );
        }
    }
}

#[test]
fn a_slice_of_the_otf_is_the_transform_of_the_line_spread() {
    let camera = Camera::resolve("ring-2018").unwrap();
    let plane = quarter_otf(&camera, 460.0, 5.0, 128);
    let slice = otf_along_row(&camera, 460.0, 5.0, 128);
    assert_eq!(plane.ncols(), slice.len());
    assert!(plane.row(0).iter().zip(&slice).all(|(a, b)| (a - b).abs() < 1e-9));
}

/// The sampled PSF's own transform is the OTF times the pixel's footprint, aliased.
#[test]
fn the_kernel_has_the_otf_of_lens_and_pixel() {
    let camera = Camera::resolve("ring-outer").unwrap();
    let kernel = psf(&camera, Channel::Red, 6.0, &Settings::exact()).unwrap().into_kernel();
    let half = (kernel.nrows() / 2) as f64;
    let lens = otf(&camera, Channel::Red, 6.0, Footprint::LensAndPixel).unwrap();
    for per_pixel in [0.02, 0.1, 0.2, 0.3] {
        let cosine = |c: usize| (std::f64::consts::TAU * per_pixel * (c as f64 - half)).cos();
        let seen: f64 = kernel.indexed_iter().map(|((_, c), &v)| f64::from(v) * cosine(c)).sum();
        let at = |f: f64| lens.at(f * 1e3 / camera.pixel_pitch_um);
        let expected = at(per_pixel) + at(1.0 - per_pixel) + at(1.0 + per_pixel);
        // Row frequencies only: aliases of the columns' sampling fall on multiples of 1/pitch, where the pixel sees nothing.
        assert!((seen - expected).abs() < 8e-3, "{per_pixel}: {seen} not {expected}");
    }
}

#[test]
fn ring_outer_keeps_ninety_six_percent_within_31_pixels() {
    let camera = Camera::resolve("ring-outer").unwrap();
    let share = |psi: f64, channel| psf(&camera, channel, psi, &Settings::exact()).unwrap().energy_within(31);
    let worst = [0.0, 4.0, 8.0].map(|psi| share(psi, Channel::Red)).into_iter().fold(1.0, f64::min);
    assert!((worst - 0.964).abs() < 0.004, "{worst}");
}

#[test]
fn conjugating_the_pupil_leaves_the_psf() {
    let camera = Camera::resolve("ring-2018").unwrap();
    let mut conjugate = camera.clone();
    conjugate.defocus_sign = Sign::Plus;
    conjugate.mask.terms_mut()[0].scale(-1.0);
    let [a, b] = [&camera, &conjugate].map(|c| quarter_psf(c, 535.0, 3.0, 256));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn a_wide_spectrum_takes_more_wavelengths_for_a_smaller_tolerance() {
    let mut camera = Camera::resolve("ring-2018").unwrap();
    camera.spectra[1] = Spectrum::Sampled(vec![[480.0, 0.0], [535.0, 1.0], [600.0, 0.0]]);
    let count = |wavelength_tolerance| {
        let psf =
            psf(&camera, Channel::Green, 2.0, &Settings { wavelength_tolerance, ..Settings::default() })
                .unwrap();
        assert!(psf.wavelength_error <= wavelength_tolerance);
        psf.wavelengths_nm.len()
    };
    let (coarse, fine) = (count(0.2), count(0.005));
    assert!(coarse == 3 && fine > coarse, "{coarse} {fine}");
}

#[test]
fn one_channel_is_checked_as_all_three_are() {
    let camera = Camera::resolve("ring-2018").unwrap();
    let settings = Settings::default();
    for psi in [f64::NAN, 900.0] {
        let one = psf(&camera, Channel::Red, psi, &settings).unwrap_err().to_string();
        assert_eq!(one, channel_psfs(&camera, psi, &settings).unwrap_err().to_string());
    }
    let all = channel_psfs(&camera, 2.0, &settings).unwrap();
    assert_eq!(psf(&camera, Channel::Green, 2.0, &settings).unwrap(), all[Channel::Green.plane()]);
}
