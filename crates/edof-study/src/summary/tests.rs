use super::*;

/// A row that says little but its PSNR.
pub(crate) fn row(method: &Method, image: &str, psi: f64, noise: Noise, psnr_db: f64) -> Measured {
    let quality = |db: f64| Quality::of_psnr(db).with("ssim", 0.9);
    Measured {
        method: method.to_string(),
        identity: method.clone(),
        camera: "clear".into(),
        image: image.into(),
        psi,
        noise,
        tone: Tone::Srgb,
        picture: quality(psnr_db),
        light: quality(psnr_db + 2.0),
        seconds_per_megapixel: 1.0,
        work: Work::default(),
    }
}

pub(crate) fn net(format: Format) -> Method {
    Method::network("n", format, 8, 4)
}

#[test]
fn averages_run_over_photos_then_depths() {
    let method = Method::demosaic();
    let at = |image, psi, db| row(&method, image, psi, Noise::None, db);
    let rows = vec![at("p1", 0.0, 30.0), at("p2", 0.0, 34.0), at("p1", 8.0, 28.0), at("p2", 8.0, 30.0)];
    let study = Study::of(rows);
    let m = &study.summary.methods[0];
    assert_eq!(m.picture.psi_db, [[0.0, 32.0], [8.0, 29.0]]);
    assert_eq!((m.picture.average_db, m.picture.worst_db, m.picture.worst_psi), (30.5, 29.0, 8.0));
    assert_eq!((m.light.average_db, m.light.farthest()), (32.5, [8.0, 31.0]));
}

#[test]
fn one_method_behind_two_cameras_has_two_summaries() {
    let mut rows = vec![row(&Method::demosaic(), "p", 0.0, Noise::None, 30.0); 2];
    rows[1].camera = "ring-outer".into();
    let study = Study::of(rows);
    assert_eq!(study.summary.methods.len(), 2);
    assert_eq!(study.summary.subjects()[1].1, "ring-outer");
}

#[test]
fn the_largest_loss_of_fixed_point_is_that_of_a_single_row() {
    let noise = Noise::gaussian(0.01);
    let mut rows = vec![];
    for (image, loss) in [("p1", 0.001), ("p2", 0.015), ("p3", -0.002)] {
        rows.push(row(&net(Format::Float), image, 8.0, noise, 34.0));
        rows.push(row(&net(Format::Float422), image, 8.0, noise, 33.5));
        let work = Work {
            nonzeros_a_patch: Some(vec![60.0, 50.0 + 300.0 * loss]),
            saturations: Some(2),
            ..Work::default()
        };
        rows.push(Measured { work, ..row(&net(Format::Fixed), image, 8.0, noise, 33.5 - loss) });
    }
    let n = &Study::of(rows).summary.nets[0];
    let fixed = n.fixed.as_ref().unwrap();
    assert!((fixed.largest_loss_db - 0.015).abs() < 1e-9);
    assert_eq!((fixed.largest_loss_image.as_str(), fixed.largest_loss_psi), ("p2", 8.0));
    assert!((n.mean_cost_of_422_db - 0.5).abs() < 1e-9);
    assert_eq!(fixed.work.saturations, Some(6));
    let nonzeros = fixed.work.nonzeros_a_patch.as_ref().unwrap();
    assert!((nonzeros[0] - 60.0).abs() < 1e-9 && (nonzeros[1] - 51.4).abs() < 1e-9, "{nonzeros:?}");
}

#[test]
fn two_networks_are_compared_photograph_by_photograph() {
    let other = Method::network("m", Format::Float, 8, 4);
    let mut rows = vec![];
    for (image, gain) in [("p1", 1.0), ("p2", 2.0), ("p3", 3.0)] {
        for (psi, further) in [(0.0, 0.0), (8.0, 1.0)] {
            rows.push(row(&net(Format::Float), image, psi, Noise::None, 30.0 + gain + further));
            rows.push(row(&other, image, psi, Noise::None, 30.0));
        }
    }
    let differences = Study::of(rows).summary.differences;
    let [one] = &differences[..] else { panic!("{differences:?}") };
    assert_eq!((one.first.as_str(), one.second.as_str()), ("n.float", "m.float"));
    // 1, 2 and 3 have a standard deviation of 1, their mean one of 1/√3.
    assert_eq!(
        (one.average.to_string(), one.farthest.to_string()),
        ("+2.50 ± 0.58".into(), "+3.00 ± 0.58".into())
    );
}

#[test]
fn a_net_without_fixed_rows_has_no_cost_of_fixed_point() {
    let rows = [Format::Float, Format::Float422].map(|f| row(&net(f), "p", 0.0, Noise::None, 34.0));
    let study = Study::of(rows.to_vec());
    assert_eq!(study.summary.nets[0].fixed, None);
    let note = "NO n.fixed ROWS: it has no integers made from these weights for this stride";
    assert_eq!(study.summary.notes, [note]);
}

#[test]
fn the_json_is_an_object_with_rows_that_reads_back() {
    let study = Study::of(vec![row(&net(Format::Fixed), "p", 0.0, Noise::sensor(8.0), 30.0)]);
    let text = serde_json::to_string(&study).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let fields = [
        "method",
        "family",
        "network",
        "format",
        "stride",
        "layers",
        "camera",
        "image",
        "psi",
        "noise",
        "tone",
        "psnr_db",
        "ssim",
        "light",
        "seconds_per_megapixel",
    ];
    for field in fields {
        assert!(value["rows"][0].get(field).is_some(), "{field}");
    }
    assert_eq!(value["rows"][0]["noise"], "sensor:gain=8");
    assert_eq!(value["summary"]["methods"][0]["ssim"], 0.9);
    assert_eq!(serde_json::from_value::<Vec<Measured>>(value["rows"].clone()).unwrap(), study.rows);
}
