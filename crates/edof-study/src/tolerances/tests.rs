use super::*;
use crate::experiment::run;
use crate::journal::{Header, Journal, Program, Shard};
use crate::made::Made;
use crate::study_report::StudyReport;
use edof_core::ColourFrame;
use std::ops::ControlFlow;

fn plan() -> Plan {
    Plan {
        camera: Camera::resolve("ring-outer").unwrap(),
        method: MethodSpec::Malvar,
        tone: Tone::Linear,
        psi: vec![4.0],
        noise: vec![Noise::None, Noise::gaussian(0.02)],
        kinds: vec![Kind::Focus],
        optics: Settings::default(),
    }
}

fn photo(name: &str) -> Photo {
    let mut frame = ColourFrame::zeros(48, 64);
    frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
        *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 3) as f32).cos();
    });
    Photo { name: name.into(), frame }
}

#[test]
fn every_error_is_measured_beside_the_lens_without_and_the_page_has_a_limit_for_each() {
    let (plan, photos) = (plan(), [photo("p1"), photo("p2")]);
    let errors = 2 * Kind::Focus.amounts().len();
    let mut journal = Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")));
    let mut all = Tolerating::new(&plan, &photos);
    run(&mut all, Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(())).unwrap();
    let rows = journal.rows();
    assert_eq!(rows.len(), (1 + errors) * 2 * 2);
    run(&mut all, Shard::WHOLE, &mut journal, |_| panic!("nothing is measured twice")).unwrap();

    let study = Tolerances::new(&rows, String::new()).unwrap();
    assert_eq!(study.curves.len(), 2);
    for curve in &study.curves {
        let zero = curve.losses.iter().find(|loss| loss.amount == 0.0).unwrap();
        assert_eq!((zero.average.mean, zero.worst_db), (0.0, 0.0));
        assert_eq!(curve.losses.len(), 1 + 2 * curve.kind.amounts().len());
    }
    // Out of focus, what is only demosaiced is less sharp.
    let focus = study.curves.iter().find(|c| (c.kind, c.noise) == (Kind::Focus, Noise::None)).unwrap();
    let losses: Vec<f64> = focus.losses.iter().map(|loss| loss.average.mean).collect();
    assert!(losses.iter().any(|loss| loss.abs() > 0.01), "{losses:?}");
    let made = Made { command: "edof study tolerances".into(), makers: vec![], rows: None };
    let page = study.to_markdown(&made);
    assert!(page.contains("| tilt of the sensor, ψ at its edges |"), "{page}");
    assert!(page.contains("| focus +0.1 ψ |"), "{page}");
    assert!(!study.to_text().is_empty());
    study.report("edof study tolerances");
}
