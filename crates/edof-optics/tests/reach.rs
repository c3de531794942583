//! Light that a profile, aberrations, defocus or a mask throw far: it has room, or there is no PSF.

use edof_core::Channel;
use edof_core::camera::Camera;
use edof_core::camera::{Aberration, Profile, Zernike};
use edof_optics::psf::{Psf, PsfError, Settings, psf, quarter_psf};
use edof_optics::{Footprint, otf, sampled_otf};
use ndarray::{Array2, arr2};

fn clear() -> Camera {
    Camera::resolve("clear").unwrap()
}

/// A clear lens with a cone of phase: rays leave `pixels` from the centre, all of them.
fn cone(pixels: f64) -> Camera {
    let slope = std::f64::consts::PI * pixels * clear().pixel_pitch_um / (0.535 * clear().f_number());
    Camera {
        mask: [Profile { at_nm: 535.0, points: vec![[0.0, 0.0], [1.0, slope]] }].into_iter().collect(),
        ..clear()
    }
}

/// A clear lens tilted so that the point moves to the right, through as many terms as the limit of one needs.
fn tilted(pixels: f64) -> Camera {
    let rms_nm = 1e3 * pixels * clear().pixel_pitch_um / (4.0 * clear().f_number()) / 4.0;
    Camera { aberrations: Zernike(vec![Aberration { noll: 2, rms_nm }; 4]), ..clear() }
}

/// With a kernel cut so early that the edge of the aperture alone would need a support of 256 pixels.
fn green(camera: &Camera, psi: f64) -> Psf {
    psf(camera, Channel::Green, psi, &Settings { energy: 0.99, ..Settings::default() }).unwrap()
}

/// Light within a square of half a side.
fn within(psf: &Psf, half: usize) -> f64 {
    psf.energy_within(2 * half + 1)
}

#[test]
fn light_of_a_steep_profile_falls_where_its_rays_go() {
    for pixels in [60.0, 150.0, 220.0] {
        let camera = cone(pixels);
        let green = green(&camera, 0.0);
        // Within a square are all points that are within its radius: the cone's ring of light has none of them.
        assert!(within(&green, (0.65 * pixels) as usize) < 0.02, "{pixels}: {}", within(&green, 90));
        // A grid of four times the area gives the same light.
        let larger = quarter_psf(&camera, 535.0, 0.0, 2048);
        let half = green.side() / 2;
        let kernel = green.kernel();
        let furthest = kernel.indexed_iter().fold(0.0f64, |furthest, ((r, c), v)| {
            furthest.max((f64::from(*v) - larger[(r.abs_diff(half), c.abs_diff(half))]).abs())
        });
        let peak = larger.iter().copied().fold(0.0, f64::max);
        assert!(furthest < 0.02 * peak, "{pixels}: {furthest} of {peak}");
    }
}

#[test]
fn a_point_that_aberrations_move_far_is_where_they_move_it() {
    for pixels in [40.0, 150.0, 200.0] {
        let green = green(&tilted(pixels), 0.0);
        let half = green.side() / 2;
        let (_, at) = green
            .kernel()
            .indexed_iter()
            .fold((0.0, (0, 0)), |best, (at, v)| if *v > best.0 { (*v, at) } else { best });
        assert!(at.0 == half && at.1.abs_diff(half + pixels as usize) <= 1, "{pixels}: {at:?} of {half}");
    }
}

#[test]
fn light_that_no_support_has_room_for_is_refused_with_what_helps() {
    let refused = |camera: &Camera, psi: f64| {
        psf(camera, Channel::Green, psi, &Settings::default()).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&cone(700.0), 3.0),
        "psi 3: camera clear throws 100 % of the light more than 512 pixels from the centre, the farthest that is computed; \
         use less defocus or larger pixels, a weaker profile"
    );
    let coma = Camera { aberrations: Zernike(vec![Aberration { noll: 8, rms_nm: 10_000.0 }; 2]), ..clear() };
    assert!(refused(&coma, 0.0).ends_with("larger pixels, weaker aberrations"), "{}", refused(&coma, 0.0));
    // Defocus alone: a disk of 1700 pixels across.
    let fine = Camera { pixel_pitch_um: 0.24, ..clear() };
    assert!(
        refused(&fine, 200.0).ends_with("use less defocus or larger pixels"),
        "{}",
        refused(&fine, 200.0)
    );
    assert!(psf(&fine, Channel::Green, 100.0, &Settings::default()).is_ok());
    // A steep wall is an edge: it diffracts, and next to no ray goes through it.
    let wall = Profile { at_nm: 535.0, points: vec![[0.5, 0.0], [0.5001, 3.0]] };
    assert!(
        psf(
            &Camera { mask: [wall].into_iter().collect(), ..clear() },
            Channel::Green,
            3.0,
            &Settings::default()
        )
        .is_ok()
    );
}

#[test]
fn contrast_far_from_focus_is_that_of_the_psf() {
    let fine = Camera { pixel_pitch_um: 0.5, ..clear() };
    let whole = psf(&fine, Channel::Green, 120.0, &Settings::exact()).unwrap();
    let contrast = otf(&fine, Channel::Green, 120.0, Footprint::LensAndPixel).unwrap();
    let frequencies = [0.001, 0.003, 0.004, 0.006, 0.01, 0.02];
    for (cycles, [along, _]) in frequencies.into_iter().zip(sampled_otf(&whole, &frequencies)) {
        let found = contrast.at(cycles * 1e3 / fine.pixel_pitch_um);
        assert!((found - along.re).abs() < 0.02, "{cycles}: {found} {}", along.re);
    }
}

#[test]
fn weights_of_a_kernel_are_light() {
    let kernel =
        |corner: f32, middle: f32| Psf::new(arr2(&[[corner, 0.0, 0.0], [0.0, middle, 0.0], [0.0, 0.0, 0.0]]));
    assert!(kernel(0.25, 0.75).is_ok());
    let light = |value| Err(PsfError::Light { row: 0, column: 0, value });
    assert_eq!(kernel(-0.25, 1.25), light(-0.25));
    assert_eq!(kernel(f32::INFINITY, 1.0), light(f32::INFINITY));
    assert_eq!(
        kernel(f32::NAN, 1.0).unwrap_err().to_string(),
        "kernel: row 0, column 0 is NaN, light is finite and never negative; set noise below 0 to 0"
    );
    assert_eq!(Psf::new(Array2::zeros((3, 3))), Err(PsfError::Sum(0.0)));
}
