use super::kernels::SIDE;
use super::*;
use crate::experiment::{RunError, run};
use crate::journal::{Header, Journal, Program};
use crate::made::Made;
use crate::study_report::StudyReport;
use std::ops::ControlFlow;

/// Cards of many greys on top of each other.
fn cards() -> Photo {
    let scene = edof_optics::draw::draw(edof_optics::draw::Builtin::Leaves, 160, 192, &[0.0], 3);
    Photo { name: "leaves".into(), frame: scene.unwrap().sharp() }
}

#[test]
fn a_random_blur_is_found_and_undone_and_no_row_is_measured_twice() {
    let settings = Settings { side: 15, ..Settings::default() };
    let folder = tempfile::tempdir().unwrap();
    let header = Header::of::<Row>(Program::stub("r", "a machine"));
    let go = |file: &str, shard: &str, max: usize| {
        let mut journal =
            Journal::open(&folder.path().join(file), header.clone(), Default::default()).unwrap();
        let mut told = 0;
        let tell = |_| {
            told += 1;
            if told == max { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let photos = [cards()];
        match run(&mut DrawnBlurs::new(&photos, settings), shard.parse().unwrap(), &mut journal, tell) {
            Ok(()) | Err(RunError::Stopped) => journal,
            Err(error) => panic!("{error}"),
        }
    };
    assert_eq!(go("parts", "1/2", 1).rows().len(), 1);
    let first = std::fs::read_to_string(folder.path().join("parts")).unwrap();
    go("parts", "1/2", usize::MAX);
    let journal = go("parts", "1/1", usize::MAX);
    let last = std::fs::read_to_string(folder.path().join("parts")).unwrap();
    assert!(first.lines().all(|line| last.lines().any(|l| l == line)), "what is there stays");
    let rows = journal.rows();
    assert_eq!(rows.iter().map(|row| row.blur.as_str()).collect::<Vec<_>>(), ["bow", "disc", "stroke"]);
    for row in &rows {
        assert!(row.known_db > row.blurred_db + 2.0, "the kernel is the blur's own: {row:?}");
    }
    let study = KnownBlurs::new(&rows, "a machine".into()).unwrap();
    assert!(study.mean_gain_db > 1.0 && study.mean_correlation > 0.7, "{}", study.to_text());
    assert!(study.to_markdown(&Made::by("edof study blind")).contains("| leaves | bow | "));
}

#[test]
fn what_has_diverged_is_counted() {
    let row = |restored_db| Row {
        image: "a".into(),
        blur: "bow".into(),
        side: 15,
        blurred_db: 25.0,
        restored_db,
        known_db: 30.0,
        correlation: 0.9,
        halvings: 0,
        steps: 1,
        seconds_per_megapixel: 1.0,
        cpu_seconds_per_megapixel: None,
        proof: Proof::default(),
    };
    let told = |db: &[f64]| {
        KnownBlurs::new(&db.iter().map(|&db| row(db)).collect::<Vec<_>>(), "m".into()).unwrap().to_text()
    };
    assert!(told(&[24.5, 26.0]).contains("Lost more than 1 dB: none."), "{}", told(&[24.5, 26.0]));
    assert!(told(&[23.5, 26.0]).contains("Lost more than 1 dB: 1."));
}

#[test]
fn random_kernels_are_light_that_stays_inside() {
    for Blur { name, psf } in drawn() {
        let rim =
            psf.kernel().indexed_iter().filter(|((r, c), _)| [*r, *c].iter().any(|i| i % (SIDE - 1) == 0));
        assert_eq!(rim.map(|(_, v)| *v).sum::<f32>(), 0.0, "{name}");
        assert!((psf.kernel().sum() - 1.0).abs() < 1e-5, "{name}");
    }
}

#[test]
fn a_shift_of_kernels_is_found_and_undone() {
    let truth = drawn()[2].psf.kernel().clone();
    let found = Array2::from_shape_fn((15, 15), |(r, c)| {
        // One row down and two columns to the left, in a kernel larger by a pixel all around.
        truth.get((r.wrapping_sub(2), c.wrapping_add(1))).copied().unwrap_or(0.0)
    });
    let (shift, correlation) = best_shift(found.view(), truth.view());
    assert_eq!(shift, (1, -2));
    assert!(correlation > 0.999, "{correlation}");
}
