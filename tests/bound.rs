//! `edof optics bound` and `edof optics advise` by the real binary.

use crate::support::Place;
use edof_core::camera::Camera;
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn bound_states_limit_and_lenses_and_draws_both_figures() {
    let place = Place::new();
    let line = "optics bound ring-outer --range 8:0 --electrons 1000 --out figures --markdown pages/bound.md --report r.html --json";
    let told = json(&place.edof(line).done().out);
    let row = &told["rows"][0];
    let (clear, limit) = (&row["clear"]["known"], number(&row["ceiling"]["bayer_db"]));
    assert!((number(&clear["average_db"]) - 30.52).abs() < 0.1 && (limit - 31.2).abs() < 0.1, "{row}");
    assert!(number(&row["ceiling"]["planes_db"]) > limit, "three planes know more");
    assert!(number(&row["lens"]["known"]["average_db"]) < number(&clear["average_db"]));
    let page = std::fs::read_to_string(place.path("pages/bound.md")).unwrap();
    assert!(
        page.contains("](../figures/frequency.svg)") && page.contains("**Verdict.** ψ 0 to 8: any mask"),
        "{page}"
    );
    for file in ["figures/frequency.svg", "figures/light.svg", "r.html"] {
        assert!(std::fs::read_to_string(place.path(file)).unwrap().contains("no lens passes"), "{file}");
    }
}

#[test]
fn advise_needs_no_mask_for_a_narrow_range_in_little_light_and_writes_the_lens() {
    let place = Place::new();
    let run = place.edof("optics advise ring-outer --range 8:0 --electrons 1000 --out lens.json").done();
    for words in
        ["Advice: no mask; leave the lens open", "the mask of ring-outer", "a cubic mask of", "The limit:"]
    {
        assert!(run.out.contains(words), "{words} in {}", run.out);
    }
    assert!(
        run.out.contains("edof train --form edof-t4w12 --camera lens.json --tone srgb --gain 5:20"),
        "{}",
        run.out
    );
    assert!(run.out.contains("White has 1000 electrons behind that aperture"), "{}", run.out);
    // A stop leaves half of the light.
    let closed =
        place.edof("optics advise ring-outer --range 8:0 --electrons 10000 --out closed.json").done().out;
    assert!(closed.contains("White has 7071 electrons") && closed.contains("gain=1.414;"), "{closed}");
    let camera = Camera::resolve(place.path("lens.json").to_str().unwrap()).unwrap();
    assert!(camera.is_clear() && camera.focus_psi == 4.0 && camera.name == "lens");
    place.photo("photo.png", 64, 48);
    place.edof("capture photo.png --camera lens.json --psi 1 --no-measure --out raw.png").done();
}

#[test]
fn advise_takes_metres_and_closes_the_lens_where_the_range_is_wide() {
    let place = Place::new();
    let line =
        "optics advise clear --range 0.4m:10m --aperture-mm 2 --electrons 10000 --out lens.json --json";
    let told = json(&place.edof(line).done().out);
    // Without a camera it is a lens without a mask.
    assert!(place.edof("optics advise --electrons 1000").done().out.starts_with("clear-mid, F/"));
    // The same by the number on the lens.
    let focal = Camera::resolve("clear").unwrap().focal_length_mm;
    let by_number = line.replace("advise clear", "advise --camera clear");
    let by_number = by_number.replace("--aperture-mm 2", &format!("--f-number {}", focal / 2.0));
    assert_eq!(json(&place.edof(&by_number).done().out)["advised"], told["advised"]);
    let (advised, [low, high]) = (&told["advised"], [0, 1].map(|i| number(&told["psi_range"][i])));
    // psi = (pi R^2/lambda)(1/z - 1/z_0), R = 1 mm, 460 nm, 0.4 m and 10 m.
    assert!(low.abs() < 1e-9 && (high - 16.39).abs() < 0.01, "{low} {high}");
    assert!(number(&advised["stops"]) >= 0.5, "{advised}");
    let focus = number(&advised["focus_m"]);
    assert!((0.4..10.0).contains(&focus), "{focus}");
    let camera = Camera::resolve(place.path("lens.json").to_str().unwrap()).unwrap();
    let closed = (-number(&advised["stops"])).exp2();
    assert!((camera.psi_range[1] - high * closed).abs() < 1e-6 && camera.nominal_m == Some(10.0));
    let costs = told["others"]
        .as_array()
        .unwrap()
        .iter()
        .map(|other| number(&other["cost"]["average_db"]) + number(&other["cost"]["worst_db"]));
    assert!(costs.clone().all(|cost| cost > -0.6) && costs.is_sorted(), "{told}");
}

#[test]
fn the_default_lens_is_the_one_that_is_advised_for_photographs() {
    let place = Place::new();
    let default = Camera::resolve(edof::presets::lens::DEFAULT).unwrap();
    for electrons in [1500, 10_000] {
        place.edof(&format!("optics advise --electrons {electrons} --out advised.json")).done();
        let advised = Camera::resolve(place.path("advised.json").to_str().unwrap()).unwrap();
        assert!(advised.is_clear() && default.is_clear());
        let fields = |camera: &Camera| [camera.aperture_radius_mm, camera.focus_psi, camera.psi_range[1]];
        for (own, advised) in fields(&default).into_iter().zip(fields(&advised)) {
            assert!((own - advised).abs() < 1e-3, "{electrons} electrons: {own}, advised is {advised}");
        }
    }
}

#[test]
fn codes_close_the_lens_farther_than_photographs_and_have_no_decibels_of_networks() {
    let place = Place::new();
    let line = "optics advise ring-outer --electrons 10000 --out lens.json --json";
    let [photographs, codes] =
        ["", " --task codes"].map(|task| json(&place.edof(&format!("{line}{task}")).done().out));
    assert!(number(&codes["advised"]["stops"]) > number(&photographs["advised"]["stops"]));
    assert_eq!((&codes["task"], &codes["module_px"]), (&"codes".into(), &2.0.into()));
    assert!(codes["advised"].get("expected").is_none() && photographs["advised"]["expected"].is_object());
    let told = place.edof("optics advise --task codes --module-px 1.5 --out lens.json").done().out;
    assert!(
        told.contains("modules of 1.5 pixels") && !told.contains("trained network is expected"),
        "{told}"
    );
    place
        .edof("optics advise --module-px 2 --out lens.json")
        .refused(&["--module-px 2: is for --task codes"]);
    assert_eq!(place.edof("optics advise --task codes --images photos --out lens.json").code, Some(2));
}
