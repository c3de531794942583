use super::*;
use crate::experiment::run;
use crate::journal::{Header, Journal, Program, Shard};
use crate::made::Made;
use crate::study_report::StudyReport;
use std::ops::ControlFlow;

fn plan() -> Plan {
    Plan {
        coded: Camera::resolve("ring-outer").unwrap(),
        ranges: vec![8.0],
        stops: vec![0.0, 1.0, 2.0],
        electrons: vec![10_000.0, 100.0],
        read_noise_e: 2.5,
        mean_light: 0.4,
        window: Window::new(8).unwrap(),
        statistics: Statistics::natural(),
    }
}

fn rows(plan: &Plan) -> Vec<Row> {
    let mut journal = Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")));
    run(&mut Comparing::new(plan), Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(())).unwrap();
    journal.rows()
}

fn find(rows: &[Row], lens: Lens, stops: f64, electrons: f64) -> Row {
    let own = |row: &&Row| (row.lens, row.stops, row.electrons) == (lens, stops, electrons);
    rows.iter().find(own).unwrap().clone()
}

#[test]
fn a_stop_halves_light_and_defocus_and_widens_the_f_number() {
    let plan = plan();
    let closed = plan.closed(Lens::Clear, 2.0);
    assert!((closed.f_number() / plan.coded.f_number() - 2.0).abs() < 1e-12);
    assert!(closed.is_clear() && !plan.closed(Lens::Coded, 0.0).is_clear());
    // Photons alone: four times fewer of them are twice the noise.
    let silent = Plan { read_noise_e: 0.0, ..plan.clone() };
    assert!((silent.sigma(1e4, 2.0) / silent.sigma(1e4, 0.0) - 2.0).abs() < 1e-12);
    assert!((silent.sigma(1e4, 0.0) - (0.4f64 / 1e4).sqrt()).abs() < 1e-12);
    // Read noise alone: four times.
    let dark = Plan { mean_light: 0.0, ..plan };
    assert!((dark.sigma(1e4, 2.0) / dark.sigma(1e4, 0.0) - 4.0).abs() < 1e-12);
}

#[test]
fn a_closed_lens_is_more_even_in_bright_light_and_worse_in_the_dark() {
    let rows = rows(&plan());
    assert_eq!(rows.len(), 8);
    let [open, closed] = [0.0, 2.0].map(|stops| find(&rows, Lens::Clear, stops, 1e4));
    assert!(
        open.average_db - open.worst_db > 2.0 * (closed.average_db - closed.worst_db),
        "{open:?} {closed:?}"
    );
    let [open, closed] = [0.0, 2.0].map(|stops| find(&rows, Lens::Clear, stops, 100.0));
    assert!(open.average_db > closed.average_db + 1.0, "{open:?} {closed:?}");
    // Focused between the ends.
    assert!(rows.iter().all(|row| row.focus_psi > 0.0 && row.focus_psi < 8.0), "{rows:?}");
}

#[test]
fn the_page_compares_with_the_best_aperture_and_says_who_wins() {
    let mut rows = rows(&plan());
    let told = Aperture::new(&rows, String::new()).unwrap();
    assert_eq!(told.comparisons.len(), 2);
    for comparison in &told.comparisons {
        let peers =
            rows.iter().filter(|row| row.lens == Lens::Clear && row.electrons == comparison.electrons);
        let best = peers.map(|row| row.average_db + row.worst_db).fold(0.0, f64::max);
        assert_eq!(comparison.clear.average_db + comparison.clear.worst_db, best);
    }
    for row in &mut rows {
        (row.average_db, row.worst_db) = match (row.lens, row.electrons > 1e3) {
            (Lens::Coded, true) => (30.0, 29.0),
            (Lens::Coded, false) => (20.0, 20.0),
            (Lens::Clear, true) => (31.0 - row.stops, 28.0),
            (Lens::Clear, false) => (20.0, 20.0),
        };
    }
    let told = Aperture::new(&rows, String::new()).unwrap();
    assert!(
        told.to_text().contains(
            "ψ 0 to 8: at the worst depth the coded lens wins up to 1.0 dB at 10000 electrons; on average it loses up to 1.0 dB at 10000 electrons."
        ),
        "{}",
        told.to_text()
    );
    let page = told.to_markdown(&Made::by("edof study aperture"));
    assert!(
        page.contains("| 0 to 8 | 10000 | 30.00 | 29.00 | F/3.5 | 31.00 | 28.00 | -1.00 | +1.00 |"),
        "{page}"
    );
    let html = told.report("edof study aperture").to_html();
    assert_eq!(html.matches("class=\"plot\"").count(), 1);
}

#[test]
fn another_mean_light_makes_other_rows() {
    let keys =
        |plan: &Plan| Comparing::new(plan).cells().into_iter().map(|(key, _)| key.proof).collect::<Vec<_>>();
    let darker = Plan { mean_light: 0.3, ..plan() };
    assert_eq!(keys(&plan()), keys(&plan()));
    assert_ne!(keys(&plan()), keys(&darker));
}
