//! The tables that README.md quotes are those of docs/results, and those are what their JSON files say.

use edof_study::journal::Journal;
use edof_study::knobs::Knobs;
use edof_study::known_blurs::KnownBlurs;
use edof_study::speed::Speed;
use edof_study::summary::Study;
use edof_study::told::Told;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).to_owned()
}

fn read(file: &str) -> String {
    let path = project().join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// What stands between two texts.
fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let rest = text.split_once(start).unwrap_or_else(|| panic!("no '{start}'")).1;
    rest.split_once(end).unwrap_or_else(|| panic!("no '{end}'")).0
}

/// One table each.
const TONES: [&str; 2] = ["linear", "srgb"];

#[test]
fn the_markdown_pages_say_what_the_rows_say() {
    for tone in TONES {
        let page = read(&format!("docs/results/kodak-{tone}.md"));
        let stored: Study = serde_json::from_str(&read(&format!("docs/results/kodak-{tone}.json"))).unwrap();
        assert_eq!(stored.measure.tone.to_string(), tone);
        let again = Study::new(stored.measure.tone, stored.rows, stored.summary.notes);
        assert!(again.to_markdown(between(&page, "Made by `", "`")) == page, "run scripts/tables.sh {tone}");
    }
}

/// A study from the rows that are kept of it; its page must be theirs.
fn told<T: Told>(name: &str) -> T {
    let page = read(&format!("docs/results/{name}.md"));
    let rows = project().join(format!("docs/results/{name}.jsonl"));
    let journal = Journal::<T::Row>::merged(Path::new("nowhere"), &[rows], false).unwrap();
    let study = T::new(journal.rows(), journal.header().machine.clone()).unwrap();
    assert!(study.to_markdown(between(&page, "Made by `", "`")) == page, "run scripts/comparison.sh: {name}");
    study
}

#[test]
fn the_comparison_says_what_its_rows_say() {
    told::<Knobs>("knobs");
    told::<Speed>("overlap");
    let speed: Speed = told("single-depth");
    assert!(read("docs/figures/speed.svg") == speed.diagrams(), "run scripts/comparison.sh speed");
}

/// Three blurs of every photograph.
fn diverges_on_none(name: &str, photographs: usize) {
    let study: KnownBlurs = told(name);
    assert_eq!((study.rows.len(), study.diverged), (3 * photographs, 0), "{name}");
}

#[test]
fn blind_deconvolution_diverges_on_no_photograph() {
    diverges_on_none("blind", 8);
    diverges_on_none("blind-train", 16);
}

#[test]
fn the_readme_quotes_the_first_table_of_each_page() {
    let readme = read("README.md");
    for tone in TONES {
        let file = format!("docs/results/kodak-{tone}.md");
        let page = read(&file);
        let table: Vec<&str> =
            page.lines().skip_while(|l| !l.starts_with('|')).take_while(|l| l.starts_with('|')).collect();
        assert!(table.len() > 4, "{file}");
        let quoted = between(&readme, &format!("<!-- table: {file} -->\n"), "<!-- end -->");
        assert_eq!(quoted.lines().collect::<Vec<_>>(), table, "run scripts/tables.sh {tone}");
    }
}
