use super::*;
use crate::experiment::{RunError, run};
use crate::journal::{Header, Journal, Program, Shard};
use crate::methods::dictionary::Dictionary;
use crate::methods::method::Family;
use crate::methods::settings::Pursuit;
use edof_core::{ColourFrame, Stride};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn photos() -> Vec<Photo> {
    let photo = |name: &str, step: usize| {
        let mut frame = ColourFrame::zeros(40, 48);
        frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
            *v = 0.5 + 0.3 * ((r / (step + p)) as f32).sin() * ((c / 4) as f32).cos();
        });
        Photo { name: name.into(), frame }
    };
    vec![photo("p1", 3), photo("p2", 5)]
}

fn plan(names: &[&str]) -> Plan {
    let dictionary = Arc::new(Dictionary::load(None).unwrap());
    let methods =
        names.iter().flat_map(|name| MethodSpec::named(name, &[Stride::PATCH], &dictionary).unwrap());
    Plan {
        camera: Camera::resolve("ring-2018").unwrap(),
        psi: vec![8.0],
        noise: vec![Noise::None, Noise::gaussian(0.01)],
        methods: methods.collect(),
        optics: Settings { energy: 0.95, ..Settings::default() },
        tone: Tone::Linear,
    }
}

fn header() -> Header {
    Header::of::<Row>(Program::stub("r", "a machine"))
}

fn go(plan: &Plan, path: &Path, rows: usize) -> Result<Journal<Row>, RunError<TrialError>> {
    part(plan, Shard::WHOLE, path, rows)
}

fn part(plan: &Plan, shard: Shard, path: &Path, rows: usize) -> Result<Journal<Row>, RunError<TrialError>> {
    let mut journal = Journal::open(path, header(), Default::default())?;
    let mut left = rows;
    let result = run(&mut SingleDepth::new(plan, &photos()), shard, &mut journal, |_| {
        left -= 1;
        if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    match result {
        Err(RunError::Stopped) | Ok(()) => Ok(journal),
        Err(error) => Err(error),
    }
}

/// The file without its times.
fn timeless(path: &Path) -> Vec<Row> {
    Journal::<Row>::open(path, header(), Default::default())
        .unwrap()
        .rows()
        .iter()
        .map(Line::timeless)
        .collect()
}

#[test]
fn an_interrupted_study_continues_where_it_was_and_gives_the_same_rows() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(&["malvar", "wiener", "omp"]);
    let all = folder.path().join("whole.jsonl");
    assert_eq!(go(&plan, &all, usize::MAX).unwrap().rows().len(), 2 * 2 * 3);
    let parts = folder.path().join("parts.jsonl");
    assert_eq!(go(&plan, &parts, 5).unwrap().rows().len(), 5);
    let first = std::fs::read_to_string(&parts).unwrap();
    go(&plan, &parts, usize::MAX).unwrap();
    let last = std::fs::read_to_string(&parts).unwrap();
    assert!(first.lines().all(|line| last.lines().any(|l| l == line)), "what is there stays");
    assert_eq!(timeless(&parts), timeless(&all));
}

#[test]
fn shards_of_a_study_have_equal_shares_of_every_method_and_make_it_whole() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.jsonl");
    go(&plan(&["malvar", "wiener"]), &whole, usize::MAX).unwrap();
    let files: Vec<PathBuf> = ["1/2", "2/2"]
        .map(|shard| {
            let path = folder.path().join(shard.replace('/', "-"));
            let plan = plan(&["wiener", "malvar"]);
            let rows = part(&plan, shard.parse().unwrap(), &path, usize::MAX).unwrap();
            let wiener = rows.rows().iter().filter(|r| r.measured.method == "wiener").count();
            assert_eq!((wiener, rows.rows().len()), (2, 4));
            path
        })
        .to_vec();
    let merged = folder.path().join("merged.jsonl");
    Journal::<Row>::merged(&merged, &files, Default::default()).unwrap().finish().unwrap();
    assert_eq!(timeless(&merged), timeless(&whole));
}

#[test]
fn another_method_or_depth_adds_rows_and_measures_no_other_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.jsonl");
    go(&plan(&["malvar"]), &path, usize::MAX).unwrap();
    let first = std::fs::read_to_string(&path).unwrap();
    let more = go(&plan(&["malvar", "directional"]), &path, usize::MAX).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().starts_with(&first));
    assert_eq!(more.rows().len(), 8);
}

#[test]
fn a_changed_constant_of_omp_makes_its_rows_be_measured_anew_and_no_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.jsonl");
    let mut plan = Plan { noise: vec![Noise::None], ..plan(&["malvar", "omp-known"]) };
    let before = go(&plan, &path, usize::MAX).unwrap().rows();
    let MethodSpec::Pursuit { settings, .. } = &mut plan.methods[1] else { panic!("a pursuit") };
    assert_eq!(settings.pursuit, Pursuit::OMP);
    settings.pursuit = Pursuit::Omp { atoms: 15 };
    let mut measured = 0;
    let mut journal = Journal::open(&path, header(), Default::default()).unwrap();
    run(&mut SingleDepth::new(&plan, &photos()), Shard::WHOLE, &mut journal, |_| {
        measured += 1;
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(measured, 2, "one for each photograph");
    let after = Journal::<Row>::open(&path, header(), Default::default()).unwrap().rows();
    // Pages use one name for both, so the old ones are gone.
    assert_eq!(after.len(), before.len());
    for (old, new) in before.iter().zip(&after) {
        let is_omp = old.measured.identity.family == Family::OmpKnownDepth;
        assert_eq!(old == new, !is_omp, "{}", old.measured.method);
        assert_eq!(old.proof.settings == new.proof.settings, !is_omp);
    }
}

#[test]
fn every_method_reconstructs_a_frame_of_its_size() {
    let mut plan = Plan { noise: vec![Noise::gaussian(0.01)], ..plan(&MethodSpec::names()) };
    plan.methods.retain(|m| m.method().layers.is_none_or(|t| t == 10));
    let folder = tempfile::tempdir().unwrap();
    let journal = go(&plan, &folder.path().join("rows.jsonl"), usize::MAX).unwrap();
    assert_eq!(journal.rows().len(), 2 * MethodSpec::names().len());
    for row in journal.rows() {
        let range = row.seconds_range.unwrap();
        let median = row.measured.seconds_per_megapixel;
        assert!(range.min <= median && median <= range.max && range.min > 0.0, "{range:?} {median}");
        let Measured { method, identity, picture, .. } = &row.measured;
        // Nine steps do not reach the mean where it is one atom among all.
        let min = if identity.family == Family::Untrained { 5.0 } else { 10.0 };
        assert!(picture.psnr_db() > min, "{method}: {}", picture.psnr_db());
    }
}

#[test]
fn a_method_that_nobody_knows_is_named() {
    let dictionary = Arc::new(Dictionary::load(None).unwrap());
    let error = MethodSpec::named("magic", &[], &dictionary).unwrap_err().to_string();
    assert!(error.starts_with("method 'magic': must be one of malvar, directional, "), "{error}");
}
