//! `edof reconstruct --demosaic`: the plain picture of a frame, with the levels and colours of a network's picture.

use crate::support::Place;
use edof_core::{CfaPhase, ColourFrame};
use edof_deblur::Demosaicing;
use edof_golden::Curve;
use edof_io::levels::Levels;
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use edof_io::rendering::Rendering;
use serde_json::Value;

const BALANCE: &str = "1.5,1,1.25";

/// What a method makes of a frame of 12 bits, balanced and encoded.
fn expected(place: &Place, name: &str, phase: CfaPhase, black: &str, method: Demosaicing) -> ColourFrame {
    let options = RawOptions { phase, depth: Some(12), ..RawOptions::default() };
    let frame = raw::load(&place.path(name), &options).unwrap();
    let light = Levels { black: black.parse().unwrap(), white: None }.light(&frame).unwrap();
    let mut picture = method.reconstructor().reconstruct(&light).unwrap().frame;
    Rendering { white_balance: Some(BALANCE.parse().unwrap()), matrix: None }.apply(&mut picture);
    Curve::Srgb.encoded(picture)
}

#[track_caller]
fn assert_alike(place: &Place, name: &str, expected: &ColourFrame) {
    let found = photo::load(&place.path(name)).unwrap();
    assert_eq!(found.size(), expected.size());
    let far = found.planes.iter().zip(&expected.planes).map(|(a, b)| (a - b.clamp(0.0, 1.0)).abs());
    assert!(far.fold(0.0, f32::max) < 2e-5, "{name}");
}

#[test]
fn a_plain_picture_is_the_demosaicing_of_the_frames_light() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let sensor = "--bit-depth 12 --phase gbrg --black-level 64 --noise sensor:gain=2";
    place.edof(&format!("capture photo.png --psi 2 --no-measure {sensor} --out taken.png")).done();
    place.raw("bare.pgm", 48, 32);
    for method in Demosaicing::ALL {
        let name = method.name();
        let line = format!("reconstruct taken.png bare.pgm --demosaic {name} --white-balance {BALANCE}");
        let run = place.edof(&format!("{line} --bits 16 --out plain/ --json plain.json")).done();
        assert_alike(&place, "plain/taken.png", &expected(&place, "taken.png", CfaPhase::Gbrg, "64", method));
        assert_alike(&place, "plain/bare.png", &expected(&place, "bare.pgm", CfaPhase::Rggb, "0", method));
        assert!(run.out.contains(&format!("by demosaic-{name} in ")), "{}", run.out);
        let made: Value = serde_json::from_slice(&std::fs::read(place.path("plain.json")).unwrap()).unwrap();
        assert_eq!(made["frames"][1]["method"], format!("demosaic-{name}"));
        assert_eq!(made["provenance"]["inputs"].as_array().unwrap().len(), 2, "frames, and no network");
    }
}

#[test]
fn options_of_networks_have_no_effect_on_a_plain_picture() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    let line = "reconstruct raw.png --demosaic malvar --out o.png";
    for option in
        ["--weights edof-t4w12", "--float", "--fixed", "--stride 4", "--board", "--words w", "--gain 8"]
    {
        let run = place.edof(&format!("{line} {option}"));
        assert!(run.code == Some(2) && run.err.contains("cannot be used with"), "{option}: {}", run.err);
    }
    place
        .edof(&format!("{line} --device gpu"))
        .refused(&["--device gpu: has no effect with --demosaic; leave --device out"]);
    place.edof(&format!("{line} --display luma")).refused(&["--display luma: has no effect with --demosaic"]);
    let run = place.edof("reconstruct raw.png --demosaic bilinear --out o.png");
    assert!(run.err.contains("method 'bilinear': must be malvar or directional"), "{}", run.err);
    assert_eq!(place.files(), ["raw.png"]);
}
