//! What knobs give, on pictures of a few pixels.

use super::list::keep_bits;
use super::*;
use crate::experiment::run;
use crate::journal::{Header, Journal, Program, Shard};
use crate::methods::dictionary::Dictionary;
use crate::study_report::StudyReport;
use edof_core::camera::Camera;
use edof_network::FixedNetwork;
use edof_network::fixed_network::FixedMatrix;
use std::ops::ControlFlow;
use std::sync::Arc;

fn photo() -> Photo {
    let mut frame = ColourFrame::zeros(32, 32);
    frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
        *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 4) as f32).cos();
    });
    Photo { name: "p".into(), frame }
}

fn plan(knobs: &[&'static Knob], fixed: &FixedNetwork) -> Plan {
    Plan {
        camera: Camera::resolve("ring-2018").unwrap(),
        psi: 4.0,
        noise: Noise::gaussian(0.01),
        network: Arc::new(edof_device::random::silent(Camera::resolve("ring-2018").unwrap())),
        network_sha256: "n".into(),
        fixed: vec![fixed.clone()],
        dictionary: Arc::new(Dictionary::load(None).unwrap()),
        knobs: knobs.to_vec(),
    }
}

fn rows(knobs: &[&'static Knob]) -> Vec<Row> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows");
    let header = || Header::of::<Row>(Program::stub("r", "m"));
    let mut journal = Journal::open(&path, header(), Default::default()).unwrap();
    let plan = plan(knobs, &edof_device::random::natural(8, 8, 7));
    run(&mut Turning::new(&plan, &[photo()]), Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(()))
        .unwrap();
    // What was written is read again: nothing in it is NaN.
    let keys = |journal: &Journal<Row>| journal.rows().iter().map(Line::key).collect::<Vec<_>>();
    let again = Journal::open(&path, header(), Default::default()).unwrap();
    assert_eq!(keys(&again), keys(&journal));
    journal.rows()
}

#[test]
fn cutting_less_of_a_capture_is_nearer_to_the_exact_one() {
    let plan = plan(&[], &edof_device::random::natural(8, 8, 7));
    let mut captures = Captures::default();
    let mut db = |knob: &'static Knob, value: f64| match (knob.apply)(&plan, value) {
        Work::Capture(how) => plan.captured(knob, &how, &photo(), &mut captures).unwrap().psnr_db,
        Work::Method(_) => panic!("{knob:?} captures"),
    };
    // The coarsest and a fine value, and what lies between them at least.
    for (knob, coarse, fine, min) in
        [("kernel-energy", 0.9, 0.9999, 5.0), ("wavelengths", 0.3, 0.003, -0.1), ("depths", 2.0, 16.0, 2.0)]
    {
        let knob: &Knob = knob.parse().unwrap();
        let (coarse, fine) = (db(knob, coarse), db(knob, fine));
        assert!(coarse + min < fine, "{}: {coarse} dB, {fine} dB", knob.name);
    }
}

#[test]
fn every_knob_of_reconstruction_has_a_row_for_each_value_and_one_default() {
    let plan = plan(&[], &edof_device::random::natural(8, 8, 7));
    // The plan's network is there in 16 bits alone.
    let knobs: Vec<&Knob> = KNOBS.iter().filter(|knob| knob.name != "bits").collect();
    let knobs: Vec<&Knob> =
        knobs.into_iter().filter(|knob| matches!((knob.apply)(&plan, 8.0), Work::Method(_))).collect();
    let rows = rows(&knobs);
    for &knob in &knobs {
        let own: Vec<&Row> = rows.iter().filter(|row| row.knob == knob).collect();
        assert_eq!(own.len(), knob.values(&plan).len());
        assert_eq!(own.iter().filter(|row| row.is_default).count(), 1, "{}", knob.name);
    }
    let study = Knobs::new(&rows, "m".into()).unwrap();
    assert_eq!(study.points.len(), rows.len());
    let html = study.report("edof study knobs").to_html();
    // Where the pointer rests on the dot.
    assert_eq!(html.matches("<title>").count() - 1, rows.len());
    assert_eq!(html.matches("(default): ").count(), knobs.len());
}

#[test]
fn words_keep_their_first_bits_and_their_sign() {
    let weights = ndarray::array![[0x7fff, 0x1234, -0x1234, -0x8000]];
    let mut matrix = FixedMatrix { weights, fraction: 15 };
    keep_bits(&mut matrix, 8);
    assert_eq!(matrix.weights, ndarray::array![[0x7f00, 0x1200, -0x1200, -0x8000]]);
    let before = matrix.clone();
    keep_bits(&mut matrix, 16);
    assert_eq!(matrix, before);
}

#[test]
fn a_verdict_knows_the_knobs_of_capturing() {
    let plan = plan(&[], &edof_device::random::natural(8, 8, 7));
    let captures = KNOBS.iter().filter(|knob| knob.name.ends_with("bits") || knob.name == "budget");
    let of_fixed: Vec<&str> = captures.map(|knob| knob.name).collect();
    for knob in KNOBS.iter().filter(|knob| !of_fixed.contains(&knob.name)) {
        let is_capture = matches!((knob.apply)(&plan, (knob.default)(&plan)), Work::Capture(_));
        assert_eq!(verdict::CAPTURING.contains(&knob.name), is_capture, "{}", knob.name);
    }
}

#[test]
fn knobs_are_known_by_name() {
    for knob in &KNOBS {
        assert_eq!(knob.name.parse::<&Knob>().unwrap(), knob);
        let text = serde_json::to_string(knob).unwrap();
        assert_eq!(serde_json::from_str::<&Knob>(&text).unwrap(), knob);
    }
    assert!(KNOBS.is_sorted());
    let error = "gain".parse::<&Knob>().unwrap_err().to_string();
    assert!(error.starts_with("knob 'gain': must be one of kernel-energy, wavelengths, "), "{error}");
}

#[test]
fn the_page_tells_how_large_kernels_are_that_were_measured() {
    let knob: &Knob = "kernel-energy".parse().unwrap();
    let study = Knobs::new(&rows(&[knob]), "m".into()).unwrap();
    let settings = edof_optics::psf::Settings::default();
    let camera = Camera::resolve("ring-2018").unwrap();
    let sides =
        edof_optics::psf::channel_psfs(&camera, 4.0, &settings).unwrap().map(|psf| psf.side().to_string());
    let page = study.to_markdown(&crate::made::Made::by("edof study knobs"));
    let [red, _, blue] = sides;
    assert!(page.contains(&format!(" | 1 | {red} to {blue} |")), "{page}");
    // Where nothing is captured there is no such column.
    let others = Knobs::new(&rows(&["noise-class".parse().unwrap()]), "m".into()).unwrap();
    assert!(!others.to_markdown(&crate::made::Made::by("edof study knobs")).contains("kernels, pixels"));
}

#[test]
fn a_curve_is_random_against_time_where_the_knob_changes_it_and_there_are_photographs_enough() {
    let twice = |name: &str| {
        let rows = rows(&[name.parse().unwrap()]);
        let others = rows.iter().map(|row| Row { image: "q".into(), ..row.clone() });
        let all: Vec<Row> = rows.iter().cloned().chain(others).collect();
        let of = |rows: &[Row]| Knobs::new(rows, "m".into()).unwrap().report("edof").to_html();
        [of(&rows), of(&all)].map(|html| html.contains(">seconds per megapixel</text>"))
    };
    assert_eq!(twice("atoms"), [false, true]);
    assert_eq!(twice("noise-class"), [false, false]);
}
