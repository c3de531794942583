use super::*;
use crate::experiment::{RunError, run};
use crate::journal::{Header, Journal, Program, Shard};
use crate::made::Made;
use crate::methods::dictionary::Dictionary;
use crate::study_report::StudyReport;
use edof_core::Stride;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

fn plan() -> Plan {
    let dictionary = Arc::new(Dictionary::load(None).unwrap());
    let spec = |name: &str| MethodSpec::named(name, &[Stride::PATCH], &dictionary).unwrap().remove(0);
    let lens = |title, camera: &str, methods: &[(&str, &str)]| Lens {
        title,
        camera: Camera::resolve(camera).unwrap(),
        methods: methods.iter().map(|&(title, name)| (title.to_owned(), spec(name))).collect(),
    };
    let drawn = |scene: &str| Drawn {
        scene: scene.into(),
        height: 96,
        width: 128,
        psi: vec![0.0, 8.0 / 3.0, 5.0, 8.0],
        seed: 1,
    };
    Plan {
        scenes: vec![drawn("leaves-4"), drawn("chart-4")],
        depth: 12,
        noise: Noise::None,
        tone: Tone::Linear,
        lenses: vec![
            lens(BEHIND, "clear", &[(DEMOSAICED, "malvar"), (BLIND, "wiener")]),
            lens(MIDDLE, "clear-mid", &[(BLIND, "wiener")]),
            lens(
                CODED,
                "ring-2018",
                &[
                    (DEMOSAICED, "malvar"),
                    (OMP, "omp"),
                    ("n.fixed", "directional"),
                    ("paper-t4.float", "wiener"),
                ],
            ),
        ],
        optics: Settings { energy: 0.9, ..Settings::default() },
    }
}

fn header() -> Header {
    Header::of::<Row>(Program::stub("r", "a machine"))
}

fn in_memory(shard: &str) -> Journal<Row> {
    let (plan, mut journal) = (plan(), Journal::in_memory(header()));
    let mut scenes = Scenes::new(&plan).unwrap();
    run(&mut scenes, shard.parse::<Shard>().unwrap(), &mut journal, |_| ControlFlow::Continue(())).unwrap();
    journal
}

fn go(shard: &str, path: &Path, max: usize) -> Journal<Row> {
    let mut journal = Journal::open(path, header(), Default::default()).unwrap();
    let mut told = 0;
    let tell = |_| {
        told += 1;
        if told == max { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    match run(&mut Scenes::new(&plan()).unwrap(), shard.parse().unwrap(), &mut journal, tell) {
        Ok(()) | Err(RunError::Stopped) => journal,
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn the_papers_columns_stand_beside_ours_and_every_depth_has_its_part() {
    let journal = in_memory("1/1");
    let study = MultiDepth::new(&journal.rows(), "a machine".into()).unwrap();
    let page = study.to_markdown(&Made::by("edof study multi-depth"));
    let papers = [
        ("clear lens, focused on the background, demosaiced", "–"),
        ("clear lens, focused on the background, blind deconvolution", "17.95"),
        ("clear lens, focused mid-range, blind deconvolution", "–"),
        ("coded lens, demosaiced", "–"),
        ("coded lens, OMP", "24.78"),
        ("coded lens, n.fixed", "–"),
        ("coded lens, paper-t4.float", "24.83"),
    ];
    let columns: Vec<&str> =
        page.lines().skip_while(|line| !line.contains("| paper |")).skip(2).take(papers.len()).collect();
    for ((column, paper), line) in papers.into_iter().zip(columns) {
        assert!(line.starts_with(&format!("| {column} | {paper} | ")), "{column}\n{page}");
    }
    assert_eq!(journal.rows().len(), 2 * papers.len());
    assert!(page.contains("| PSNR in dB | paper | leaves-4 | chart-4 |"), "{page}");
    let html = study.report("edof study multi-depth").to_html();
    let parts: usize = study.scenes.iter().map(|shown| shown.parts.len()).sum();
    // A depth may have no room for a part.
    assert!(parts >= 6 && html.matches("three times as large").count() == parts);
    assert_eq!(html.matches("dB at this depth").count(), parts * papers.len());
    assert!(html.contains("17.95") && html.contains("edof study multi-depth"));
    let csv = MultiDepth::csv(&journal.rows());
    assert!(csv.starts_with("scene,tone,noise,paper_db,lens,") && !csv.contains("shown"), "{csv}");
}

#[test]
fn a_study_that_was_stopped_and_shared_out_is_the_one_of_a_whole_run() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two, both, whole] = ["one", "two", "both", "whole"].map(|name| folder.path().join(name));
    assert_eq!(go("1/2", &one, 2).rows().len(), 2);
    let first = std::fs::read_to_string(&one).unwrap();
    assert_eq!(go("1/2", &one, usize::MAX).rows().len(), 7);
    let last = std::fs::read_to_string(&one).unwrap();
    assert!(first.lines().all(|line| last.lines().any(|l| l == line)), "what is there stays");
    go("2/2", &two, usize::MAX);
    Journal::<Row>::merged(&both, &[two, one], Default::default()).unwrap().finish().unwrap();
    go("1/1", &whole, usize::MAX);
    let rows =
        |path: &Path| Journal::<Row>::open(path, header(), Default::default()).unwrap().rows().to_vec();
    let timeless = |path: &Path| -> Vec<Row> { rows(path).iter().map(Line::timeless).collect() };
    assert_eq!(timeless(&both), timeless(&whole));
    let columns = |path: &Path| MultiDepth::new(&rows(path), "m".into()).unwrap().columns();
    assert_eq!(columns(&both), columns(&whole));
}

#[test]
fn rows_of_a_scene_that_nothing_draws_are_rejected() {
    let journal = in_memory("1/14");
    let mut rows = journal.rows().to_vec();
    rows[0].drawn.scene = "sea".into();
    let error = MultiDepth::new(&rows, "m".into()).unwrap_err().to_string();
    assert_eq!(error, "rows of scene 'sea': must be chart, chart-4, leaves or leaves-4");
}
