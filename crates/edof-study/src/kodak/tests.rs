use super::*;
use crate::experiment::{RunError, run};
use crate::journal::{Header, Journal, Program, Shard};
use crate::lens_networks::tests::copying;
use crate::methods::spec::MethodSpec;
use crate::metrics::shown;
use crate::setup::setups;
use edof_core::camera::Camera;
use edof_core::{ColourFrame, Stride};
use std::ops::ControlFlow;

fn setup(camera: &str) -> Setup {
    let camera = Camera::resolve(camera).unwrap();
    Setup { camera, further_foci: vec![], methods: vec![MethodSpec::Malvar] }
}

fn photo(name: &str) -> Photo {
    let mut frame = ColourFrame::zeros(64, 80);
    frame
        .planes
        .indexed_iter_mut()
        .for_each(|((p, r, c), v)| *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 4) as f32).cos());
    Photo { name: name.into(), frame }
}

fn conditions(psi: &[f64], noise: &[f64]) -> Conditions {
    let noise = noise.iter().map(|&sigma| Noise::gaussian(sigma)).collect();
    Conditions { tone: Tone::Linear, psi: psi.to_vec(), noise, optics: Settings::default() }
}

fn journal() -> Journal<Row> {
    Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")))
}

fn plan(cameras: &[&str], conditions: Conditions) -> Plan {
    Plan { setups: cameras.iter().map(|camera| setup(camera)).collect(), conditions }
}

fn go(camera: &str, photos: &[Photo], conditions: Conditions) -> Result<Vec<Measured>, RunError<TrialError>> {
    let mut journal = journal();
    let plan = plan(&[camera], conditions);
    run(&mut Kodak::new(&plan, photos), Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(()))?;
    Ok(journal.rows().into_iter().map(|row| row.measured).collect())
}

#[test]
fn every_photo_depth_noise_and_method_has_one_row_and_a_place() {
    let plan = plan(&["clear", "ring-outer"], conditions(&[0.0, 8.0], &[0.0, 0.01]));
    let photos = [photo("p1"), photo("p2")];
    let (mut told, mut journal) = (vec![], journal());
    run(&mut Kodak::new(&plan, &photos), Shard::WHOLE, &mut journal, |p| {
        told.push((p.done, p.of));
        ControlFlow::Continue(())
    })
    .unwrap();
    let rows = journal.rows();
    assert_eq!(rows.len(), 2 * 2 * 2 * 2);
    assert_eq!(told.last(), Some(&(16, 16)));
    let settings: std::collections::BTreeSet<_> = rows.iter().map(|r| r.proof.settings.clone()).collect();
    assert_eq!(settings.len(), 8, "noise and its seed are settings of photograph, depth and level");
    assert!(rows.iter().all(|r| r.place == usize::from(r.measured.camera == "ring-outer")));
    // Nothing is measured twice.
    run(&mut Kodak::new(&plan, &photos), Shard::WHOLE, &mut journal, |_| {
        panic!("there is nothing to measure")
    })
    .unwrap();
}

#[test]
fn the_same_experiment_gives_the_same_numbers() {
    let once = || {
        let rows = go("ring-2018", &[photo("p")], conditions(&[3.0], &[0.02])).unwrap();
        (rows[0].picture, rows[0].light)
    };
    assert_eq!(once(), once());
}

#[test]
fn noise_and_defocus_cost_quality() {
    let rows = go("clear", &[photo("p")], conditions(&[0.0, 8.0], &[0.0, 0.05])).unwrap();
    let db = |psi: f64, noise: f64| {
        let row = rows.iter().find(|r| r.psi == psi && r.noise == Noise::gaussian(noise)).unwrap();
        row.picture.psnr_db()
    };
    let sharp = db(0.0, 0.0);
    assert!(sharp > db(0.0, 0.05) + 1.0 && sharp > db(8.0, 0.0) + 1.0, "{rows:?}");
}

#[test]
fn the_papers_convention_measures_one_picture_and_srgb_two() {
    let mut grey = photo("grey");
    grey.frame.planes.fill(0.2);
    let measured = |tone| {
        let conditions = Conditions { tone, ..conditions(&[0.0], &[0.001]) };
        let row = go("clear", std::slice::from_ref(&grey), conditions).unwrap().remove(0);
        assert_eq!(row.tone, tone);
        (row.picture, row.light)
    };
    let (picture, light) = measured(Tone::Linear);
    assert_eq!(picture, light);
    let (picture, light) = measured(Tone::Srgb);
    // Small noise on light is as many times larger on the picture as the curve is steep there.
    let (above, below) = (Tone::Srgb.decode(0.21), Tone::Srgb.decode(0.19));
    let steep = 0.02 / f64::from(above - below);
    let lost = light.psnr_db() - picture.psnr_db();
    assert!((lost - 20.0 * steep.log10()).abs() < 0.1 && lost > 9.0, "{lost} dB");
    assert_eq!(
        Some(picture.psnr_db()),
        picture.number("psnr_clipped_db"),
        "sRGB codes end at black and white"
    );
}

#[test]
fn what_is_encoded_as_it_was_decoded_is_the_photograph_itself() {
    let photo = photo("p");
    let light = Tone::Srgb.decoded(&photo.frame);
    let back = shown(&light, Tone::Srgb);
    assert!(crate::metrics::psnr(&photo.frame, &back, BORDER).unwrap() > 130.0);
}

#[test]
fn other_photos_depths_and_noises_have_other_noise() {
    let (low, high) = (Noise::gaussian(0.01), Noise::gaussian(0.02));
    let (base, fast) = (Noise::sensor(1.0), Noise::sensor(8.0));
    let seeds = [
        ("a", 0.0, low),
        ("b", 0.0, low),
        ("a", 2.0, low),
        ("a", 0.0, high),
        ("a", 0.0, base),
        ("a", 0.0, fast),
    ]
    .map(|(image, psi, noise)| sensor(image, psi, noise).seed);
    for (i, seed) in seeds.iter().enumerate() {
        assert!(!seeds[..i].contains(seed));
    }
}

#[test]
fn an_experiment_stops_when_asked() {
    let (photos, mut journal) = ([photo("p1"), photo("p2")], journal());
    let plan = plan(&["clear"], conditions(&[0.0], &[0.0]));
    let stopped =
        run(&mut Kodak::new(&plan, &photos), Shard::WHOLE, &mut journal, |_| ControlFlow::Break(()));
    assert!(matches!(stopped, Err(RunError::Stopped)));
    assert_eq!(journal.rows().len(), 1, "what was measured stays");
}

#[test]
fn a_black_photograph_has_a_row_that_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows");
    let header = || Header::of::<Row>(Program::stub("r", "m"));
    let mut black = photo("black");
    black.frame.planes.fill(0.0);
    let plan = plan(&["clear"], conditions(&[0.0], &[0.0]));
    let mut rows = Journal::open(&path, header(), Default::default()).unwrap();
    run(&mut Kodak::new(&plan, &[black]), Shard::WHOLE, &mut rows, |_| ControlFlow::Continue(())).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().contains("\"psnr_db\":\"inf\""));
    let again = Journal::<Row>::open(&path, header(), Default::default()).unwrap();
    assert_eq!(again.rows(), rows.rows());
    assert_eq!(again.rows()[0].measured.picture.psnr_db(), f64::INFINITY);
}

#[test]
fn depths_and_noises_that_cannot_be_are_rejected() {
    let refused =
        |psi, noise| go("clear", &[photo("p")], conditions(&[psi], &[noise])).unwrap_err().to_string();
    assert_eq!(refused(f64::NAN, 0.0), "psi NaN: must lie within 200 of the focus of camera clear, at 0");
    assert_eq!(
        refused(0.0, -1.0),
        "p: noise: the standard deviation is -1, expected 0 to 1, where full scale is 1"
    );
}

#[test]
fn a_photo_too_small_to_measure_is_named() {
    let small = Photo { name: "tiny".into(), frame: ColourFrame::zeros(20, 20) };
    let error = go("clear", &[small], conditions(&[0.0], &[0.0])).unwrap_err();
    assert!(error.to_string().starts_with("tiny: frame of 20x20 pixels: must be at least 27x27"), "{error}");
}

#[test]
fn a_network_of_two_exposures_is_a_method_like_the_others() {
    let entry = |foci: &[f64], exposure, seed| copying(foci, exposure, seed).entry(Stride::PATCH);
    // One looks at each exposure of two, the others see that focus alone.
    let nets =
        vec![entry(&[2.0, 6.0], 0, 1), entry(&[2.0, 6.0], 1, 2), entry(&[2.0], 0, 3), entry(&[6.0], 0, 4)];
    let noise = vec![Noise::None, Noise::gaussian(0.01), Noise::sensor(2.0), Noise::sensor(4.0)];
    let conditions = Conditions { noise, tone: Tone::Srgb, ..conditions(&[2.0, 6.0], &[]) };
    let plan = Plan { setups: setups(nets).unwrap(), conditions };
    let (photos, mut journal) = ([photo("p")], journal());
    run(&mut Kodak::new(&plan, &photos), Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(())).unwrap();
    let rows: Vec<Measured> = journal.rows().into_iter().map(|row| row.measured).collect();
    let found = |net: &str, noise: Noise, psi: f64| {
        let mut own = rows.iter().filter(|r| (r.method.as_str(), r.noise, r.psi) == (net, noise, psi));
        own.next().map(|row| row.picture.psnr_db())
    };
    for psi in [2.0, 6.0] {
        let db = |net, noise| found(net, noise, psi).unwrap();
        for [own, alone] in [["n1.float", "n3.float"], ["n2.float", "n4.float"]] {
            assert_eq!(db(own, Noise::None), db(alone, Noise::None), "{own}, psi {psi}");
            // Half of the time is twice the gain.
            let apart = db(own, Noise::sensor(2.0)) - db(alone, Noise::sensor(4.0));
            assert!(apart.abs() < 0.1, "{own}, psi {psi}: {apart}");
            assert!(own == "n2.float" || apart == 0.0, "the first exposure has the noise of one frame");
            assert_eq!(found(own, Noise::gaussian(0.01), psi), None);
            assert!(found(alone, Noise::gaussian(0.01), psi).is_some());
        }
    }
    assert!(rows.iter().any(|row| row.method == "n2.float" && row.camera.ends_with(" at foci 2, 6")));
}
