use super::*;

#[test]
fn every_preset_reads_and_round_trips() {
    for (name, text) in PRESETS {
        let camera = Camera::resolve(name).unwrap();
        assert_eq!(camera.name, *name);
        assert_eq!(Camera::from_json(&camera.to_json(), name).unwrap(), camera);
        assert_eq!(&camera.to_json(), text, "a file written again has the same bytes");
    }
}

#[test]
fn a_mask_keeps_one_order_and_the_keys_of_a_file() {
    let profile = |at_nm| Profile { at_nm, points: vec![[0.0, 1.0]] };
    let zernike = Zernike(vec![Aberration { noll: 7, rms_nm: 20.0 }]);
    let mut camera = Camera::resolve("ring-2018").unwrap();
    let ring = camera.mask.terms()[0].clone();
    camera.mask = [zernike.clone().into(), profile(500.0).into(), ring.clone(), profile(600.0).into()]
        .into_iter()
        .collect();
    let ordered = [ring, profile(500.0).into(), profile(600.0).into(), zernike.into()];
    assert_eq!(camera.mask.terms(), ordered);
    let text = camera.to_json();
    assert_eq!(Camera::from_json(&text, "file").unwrap(), camera);
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["profile"]["at_nm"], 500.0);
    assert_eq!(value["mask"][0]["profile"]["at_nm"], 600.0);
    assert_eq!(value["mask"][1]["zernike"][0]["noll"], 7);
    assert!(!camera.is_clear() && camera.without_mask().is_clear());
    assert_eq!(Camera::resolve("clear").unwrap().symmetry(), Symmetry::Round);
    assert_eq!(camera.symmetry(), Symmetry::None);
}

#[test]
fn an_unknown_camera_is_told_the_presets() {
    let error = Camera::resolve("ring-1999").unwrap_err().to_string();
    assert!(error.starts_with("camera 'ring-1999': no such file") && error.contains("ring-2018"));
}

#[test]
fn a_ring_outside_the_pupil_is_rejected() {
    let mut camera = Camera::resolve("ring-2018").unwrap();
    camera.mask.rings_mut().for_each(|ring| ring.outer = 1.2);
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
    assert!(
        refused(|c| c.mask = vec![c.mask.terms()[0].clone(); 65].into_iter().collect())
            .contains("65 of them, expected 64 at most")
    );
}

#[test]
fn profiles_and_aberrations_that_cannot_be_are_rejected() {
    let refused = |change: &dyn Fn(&mut Camera)| {
        let mut camera = Camera::resolve("clear").unwrap();
        change(&mut camera);
        Camera::from_json(&camera.to_json(), "file").unwrap_err().to_string()
    };
    for points in [vec![], vec![[0.5, 0.0], [0.5, 1.0]], vec![[0.0, 1.0], [1.1, 0.0]]] {
        let error = refused(&|c| c.mask.add(Profile { at_nm: 500.0, points: points.clone() }));
        assert!(error.contains("profile is") && error.contains("ascending radius"), "{error}");
    }
    for (noll, rms_nm) in [(1, 10.0), (67, 10.0), (8, 1e9)] {
        let error = refused(&|c| c.aberrations = Zernike(vec![Aberration { noll, rms_nm }]));
        assert!(error.contains(&format!("aberrations is noll {noll}")), "{error}");
    }
}
