use super::*;

#[test]
fn every_preset_reads_and_round_trips() {
    for (name, _) in PRESETS {
        let camera = Camera::resolve(name).unwrap();
        assert_eq!(camera.name, *name);
        assert_eq!(Camera::from_json(&camera.to_json(), name).unwrap(), camera);
    }
}

#[test]
fn an_unknown_camera_is_told_the_presets() {
    let error = Camera::resolve("ring-1999").unwrap_err().to_string();
    assert!(error.starts_with("camera 'ring-1999': no such file") && error.contains("ring-2018"));
}

#[test]
fn a_ring_outside_the_pupil_is_rejected() {
    let mut camera = Camera::resolve("ring-2018").unwrap();
    camera.rings[0].outer = 1.2;
    let error = Camera::from_json(&camera.to_json(), "file").unwrap_err().to_string();
    assert_eq!(error, "file: camera ring-2018: rings is 0.68 to 1.2, expected 0 <= inner < outer <= 1");
}

#[test]
fn a_lens_and_pixels_that_no_grid_holds_are_rejected() {
    let refused = |change: fn(&mut Camera)| {
        let mut camera = Camera::resolve("ring-2018").unwrap();
        change(&mut camera);
        camera.check().unwrap_err().to_string()
    };
    assert!(refused(|c| c.aperture_radius_mm = 1e9).contains("aperture_radius_mm is 1000000000"));
    assert!(refused(|c| c.aperture_radius_mm = 0.01).contains("at least 1/64 of a wavelength"));
    assert!(refused(|c| c.pixel_pitch_um = 100.0).contains("at most 8 wavelengths"));
    assert!(refused(|c| c.pixel_pitch_um = 0.01).contains("at least 1/64 of a wavelength"));
    assert!(refused(|c| c.rings = vec![c.rings[0]; 65]).contains("65 of them, expected 64 at most"));
}

#[test]
fn a_profile_is_linear_between_its_points_and_scales_with_the_wavelength() {
    let profile = Profile { at_nm: 500.0, points: vec![[0.2, 1.0], [0.6, 3.0]] };
    let phases = [0.0, 0.2, 0.4, 0.6, 1.0].map(|rho| profile.phase_rad(rho, 500.0));
    assert!(phases.iter().zip([1.0, 1.0, 2.0, 3.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{phases:?}");
    assert!((profile.phase_rad(0.4, 1000.0) - 1.0).abs() < 1e-12);
}

#[test]
fn profiles_and_aberrations_that_cannot_be_are_rejected() {
    let refused = |change: &dyn Fn(&mut Camera)| {
        let mut camera = Camera::resolve("clear").unwrap();
        change(&mut camera);
        Camera::from_json(&camera.to_json(), "file").unwrap_err().to_string()
    };
    for points in [vec![], vec![[0.5, 0.0], [0.5, 1.0]], vec![[0.0, 1.0], [1.1, 0.0]]] {
        let error = refused(&|c| c.profile = Some(Profile { at_nm: 500.0, points: points.clone() }));
        assert!(error.contains("profile is") && error.contains("ascending radius"), "{error}");
    }
    for (noll, rms_nm) in [(1, 10.0), (67, 10.0), (8, 1e9)] {
        let error = refused(&|c| c.aberrations = vec![Aberration { noll, rms_nm }]);
        assert!(error.contains(&format!("aberrations is noll {noll}")), "{error}");
    }
}

#[test]
fn an_etched_ring_has_the_phase_of_its_height() {
    let delay = Delay::Etched { height_um: 0.46, cauchy: [1.5, 0.0] };
    assert!((delay.phase_rad(460.0) - std::f64::consts::PI).abs() < 1e-9);
}
