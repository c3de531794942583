use super::*;
use crate::experiment::run;
use crate::journal::{Header, Journal, Program, Shard};
use crate::methods::spec::MethodSpec;
use crate::study_report::StudyReport;
use edof_core::Camera;
use std::ops::ControlFlow;

fn plan(cameras: Vec<Camera>, psi: Vec<f64>, noise: Vec<Noise>) -> Plan {
    let setups = cameras
        .into_iter()
        .map(|camera| Setup { camera, further_foci: vec![], methods: vec![MethodSpec::Malvar] })
        .collect();
    let sheets = Symbology::ALL.map(|kind| Sheet::new(kind, 3.0, 4, 5).unwrap());
    let (readers, optics) = (vec![Reader::Rxing], Settings::default());
    Plan { setups, sheets: sheets.into(), psi, noise, readers, optics }
}

fn rows(plan: &Plan) -> Vec<Row> {
    let mut journal = Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")));
    run(&mut Reading::new(plan), Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(())).unwrap();
    journal.rows()
}

#[test]
fn every_code_of_a_sharp_sheet_is_read_and_none_says_anything_else() {
    for kind in Symbology::ALL {
        let sheet = Sheet::new(kind, 3.0, 6, 9).unwrap();
        let luma = codes_of_luma(&sheet.photo.frame);
        assert_eq!(Reader::Rxing.count(&luma, kind, &sheet.cards).unwrap(), 6, "{kind}");
        let others: Vec<Card> =
            sheet.cards.iter().map(|card| Card { text: "0".into(), ..card.clone() }).collect();
        assert_eq!(Reader::Rxing.count(&luma, kind, &others).unwrap(), 0, "{kind}");
    }
}

#[test]
fn a_lens_in_focus_keeps_codes_readable_and_one_far_out_of_focus_does_not() {
    let plan = plan(vec![Camera::resolve("clear").unwrap()], vec![0.0, 16.0], vec![Noise::None]);
    let rows = rows(&plan);
    let read = |psi: f64| rows.iter().filter(|row| row.psi == psi).map(|row| row.read).sum::<usize>();
    assert_eq!((read(0.0), rows.len()), (16, 8));
    assert!(read(16.0) < 4, "{}", read(16.0));
    let page = Codes::new(&rows, String::new()).unwrap();
    assert!(page.reached.iter().all(|reached| reached.psi_range == Some([0.0, 0.0])), "{page:?}");
}

#[test]
fn the_readable_range_is_the_widest_run_of_depths_and_its_error_is_binomial() {
    let all = rows(&plan(vec![Camera::resolve("clear").unwrap()], vec![0.0], vec![Noise::None]));
    let read = [20, 19, 20, 5, 20, 20, 0];
    let rows: Vec<Row> = read
        .iter()
        .enumerate()
        .map(|(psi, read)| Row { psi: psi as f64, read: *read, of: 20, ..all[0].clone() })
        .collect();
    let page = Codes::new(&rows, String::new()).unwrap();
    assert_eq!(page.reached.len(), 1);
    assert_eq!(page.reached[0].psi_range, Some([0.0, 2.0]));
    let rate = 104.0 / 140.0;
    assert!((page.reached[0].rate_error - f64::sqrt(rate * (1.0 - rate) / 140.0)).abs() < 1e-12);
    assert!(page.to_text().contains("ψ 0 to 2; 74 ± 4 %"), "{}", page.to_text());
}

#[test]
fn zbarimg_is_asked_for_no_data_matrix() {
    assert!(!Reader::Zbarimg.reads(Symbology::DataMatrix) && Reader::Zbarimg.reads(Symbology::Qr));
}
