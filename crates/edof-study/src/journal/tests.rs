use super::*;
use crate::made::machines;
use serde::Deserialize;
use serde_json::json;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Measured {
    name: String,
    #[serde(with = "crate::metrics::number")]
    db: f64,
    seconds: f64,
    #[serde(flatten)]
    proof: Proof,
}

impl Line for Measured {
    const STUDY: &'static str = "test";
    const LAYOUT: u32 = 1;
    type Subject = String;

    fn subject(&self) -> String {
        self.name.clone()
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        Self { seconds: 0.0, ..self.clone() }
    }
}

fn row(name: &str, db: f64, seconds: f64) -> Measured {
    Measured { name: name.into(), db, seconds, proof: of_settings("s") }
}

/// Measured with these settings.
fn of_settings(settings: &str) -> Proof {
    Proof { settings: Some(settings.into()), ..Proof::default() }
}

/// A header of a program of revision r on a machine.
fn header(machine: &str) -> Header {
    Header::of::<Measured>(Program::stub("r", machine))
}

fn key(name: &str) -> Key<Measured> {
    Key { subject: name.into(), proof: of_settings("s") }
}

fn open(path: &Path, header: Header) -> Result<Journal<Measured>, JournalError> {
    Journal::open(path, header, Mixing::default())
}

fn merged(out: &Path, files: &[PathBuf]) -> Result<Journal<Measured>, JournalError> {
    Journal::merged(out, files, Mixing::default())
}

/// A file of rows, as a run leaves it that was stopped.
fn file(folder: &Path, name: &str, machine: &str, rows: &[Measured]) -> PathBuf {
    let path = folder.join(name);
    let mut journal = open(&path, header(machine)).unwrap();
    rows.iter().for_each(|row| journal.push(row.clone()).unwrap());
    path
}

#[test]
fn a_file_that_is_gone_on_with_keeps_its_lines_and_ends_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "rows", "m", &[row("b", 2.0, 0.1)]);
    let first = std::fs::read_to_string(&path).unwrap();
    let mut journal = open(&path, header("m")).unwrap();
    assert!(journal.holds(&key("b")) && !journal.holds(&key("a")));
    journal.push(row("a", 1.0, 0.3)).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().starts_with(&first));
    journal.finish().unwrap();
    let names: Vec<String> = journal.rows().into_iter().map(|r| r.name).collect();
    assert_eq!(names, ["a", "b"]);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(first.lines().all(|line| text.lines().any(|other| other == line)), "{text}");
    let again = open(&path, header("m")).unwrap();
    assert_eq!(again.rows(), journal.rows());
}

#[test]
fn numbers_come_back_to_the_last_bit() {
    // What a hasty reader of decimals takes for a neighbour.
    let numbers = [3.9634806967355276, 2.3182529167238846, 0.9671196784464513, 1.3627935748454505];
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<Measured> = numbers.map(|n| row(&n.to_string(), n, n)).to_vec();
    let path = file(folder.path(), "rows", "m", &rows);
    assert_eq!(open(&path, header("m")).unwrap().rows(), rows);
}

#[test]
fn shards_share_all_rows_out_and_merged_they_are_the_whole_file() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<Measured> = ["e", "b", "a", "d", "c", "b"].map(|n| row(n, 1.0, 0.1)).to_vec();
    let cells = || rows.iter().map(|r| (r.key(), r.clone())).collect::<Vec<_>>();
    let whole = folder.path().join("whole");
    let mut journal = open(&whole, header("m")).unwrap();
    Shard::WHOLE.own(cells()).into_iter().for_each(|(_, row)| journal.push(row).unwrap());
    let files: Vec<PathBuf> = ["1/2", "2/2"]
        .map(|shard| {
            let mut own = shard.parse::<Shard>().unwrap().own(cells());
            own.reverse();
            let own: Vec<Measured> = own.into_iter().map(|cell| cell.1).collect();
            file(folder.path(), &shard.replace('/', "-"), "m", &own)
        })
        .to_vec();
    let together = folder.path().join("together");
    merged(&together, &files).unwrap().finish().unwrap();
    assert_eq!(std::fs::read(&together).unwrap(), std::fs::read(&whole).unwrap());
}

#[test]
fn answers_that_differ_are_rejected_and_times_may() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let first = file(folder.path(), "1", "m", &[row("a", 1.0, 0.1)]);
    let same = file(folder.path(), "2", "m", &[row("a", 1.0, 0.7)]);
    let both = merged(&out, &[first.clone(), same]).unwrap();
    assert_eq!(both.rows(), [row("a", 1.0, 0.1)]);
    let other = file(folder.path(), "3", "m", &[row("a", 1.5, 0.1)]);
    let error = merged(&out, &[first, other]).unwrap_err().to_string();
    assert!(
        error.ends_with("3: line 2: contradicts an earlier line with the same key; delete one of both"),
        "{error}"
    );
    assert!(!out.exists());
}

#[test]
fn a_metric_that_one_row_does_not_hold_is_no_contradiction() {
    let [old, new, other] = [
        json!({"image": "p", "light": {"psnr_db": 30.5}}),
        json!({"image": "p", "light": {"psnr_db": 30.5, "ms_ssim": 0.5}}),
        json!({"image": "p", "light": {"psnr_db": 30.25, "ms_ssim": 0.5}}),
    ];
    assert!(agree(&old, &new) && agree(&new, &old) && agree(&old, &old));
    assert!(!agree(&old, &other) && !agree(&other, &new));
}

#[test]
fn machines_are_mixed_only_where_asked() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let files = [
        file(folder.path(), "1", "slow", &[row("a", 1.0, 0.1)]),
        file(folder.path(), "2", "fast", &[row("b", 1.0, 0.1)]),
    ];
    let error = merged(&out, &files).unwrap_err().to_string();
    assert!(
        error.contains("2: its rows are of test 1 (fast, 2 threads; revision r; rustc; ), those of ")
            && error.ends_with(
                "are of test 1 (slow, 2 threads; revision r; rustc; ); --any-machine takes both, and says so"
            ),
        "{error}"
    );
    let any_machine = Mixing { any_machine: true, ..Mixing::default() };
    let mut merged = Journal::<Measured>::merged(&out, &files, any_machine).unwrap();
    assert_eq!(
        (machines(&merged.makers()).as_str(), merged.rows().len()),
        ("fast, 2 threads; slow, 2 threads", 2)
    );
    merged.finish().unwrap();
    // Each row stays below the machine that measured it, and the file can be merged again.
    let text = std::fs::read_to_string(&out).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].contains("\"fast\"") && lines[1].contains("\"b\""), "{text}");
    assert!(lines[2].contains("\"slow\"") && lines[3].contains("\"a\""), "{text}");
    let again = Journal::<Measured>::merged(&out, std::slice::from_ref(&out), any_machine).unwrap();
    assert_eq!((again.makers(), again.rows()), (merged.makers(), merged.rows()));
}

/// A file of one row that a program of a revision measured.
fn of_revision(folder: &Path, name: &str, revision: &str, row: Measured) -> PathBuf {
    let path = folder.join(name);
    let header = Header::of::<Measured>(Program::stub(revision, "m"));
    let mut journal = open(&path, header).unwrap();
    journal.push(row).unwrap();
    path
}

#[test]
fn rows_of_another_revision_are_kept_only_where_asked_and_the_file_says_which() {
    let folder = tempfile::tempdir().unwrap();
    let path = of_revision(folder.path(), "rows", "r", row("a", 1.0, 0.1));
    let new = || Header::of::<Measured>(Program::stub("s", "m"));
    let error = open(&path, new()).unwrap_err().to_string();
    assert!(
        error.contains("its rows are of test 1 (m, 2 threads; revision r; rustc; ), this study is of test 1")
            && error.ends_with("name another file, or keep rows of other revisions by --any-revision"),
        "{error}"
    );
    let any_revision = Mixing { any_revision: true, ..Mixing::default() };
    let mut journal = Journal::open(&path, new(), any_revision).unwrap();
    assert!(journal.holds(&key("a")));
    journal.push(row("b", 2.0, 0.1)).unwrap();
    journal.finish().unwrap();
    let revision = |maker: &Maker| match maker {
        Maker::Program(program) => program.revision.clone(),
        Maker::Old { .. } => panic!("{maker:?}"),
    };
    assert_eq!(journal.makers().iter().map(revision).collect::<Vec<_>>(), ["r", "s"]);
    let text = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].contains("\"r\"") && lines[1].contains("\"a\""), "{text}");
    assert!(lines[2].contains("\"s\"") && lines[3].contains("\"b\""), "{text}");
    let other = of_revision(folder.path(), "other", "t", row("c", 1.0, 0.1));
    let error = merged(&path, &[other.clone(), path.clone()]).unwrap_err().to_string();
    assert!(error.ends_with("; --any-revision takes both, and says so"), "{error}");
    assert_eq!(
        Journal::<Measured>::merged(&path, &[other, path.clone()], any_revision).unwrap().rows().len(),
        3
    );
}

#[test]
fn a_program_from_outside_of_git_keeps_no_rows_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let path = of_revision(folder.path(), "rows", UNKNOWN, row("a", 1.0, 0.1));
    assert!(matches!(
        open(&path, Header::of::<Measured>(Program::stub(UNKNOWN, "m"))),
        Err(JournalError::Other { .. })
    ));
}

#[test]
fn rows_of_an_old_format_are_read_and_never_added_to() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows");
    let old = r#"{"study":"test","layout":1,"exact":false,"machine":"a CPU, 2 threads"}"#;
    std::fs::write(&path, format!("{old}\n{}\n", line(&row("a", 1.0, 0.1)))).unwrap();
    let error = open(&path, header("m")).unwrap_err().to_string();
    assert!(
        error.contains("of test 1 (a CPU, 2 threads; cut kernels; revision not stated), this"),
        "{error}"
    );
    let read = merged(&path, std::slice::from_ref(&path)).unwrap();
    assert_eq!((machines(&read.makers()).as_str(), read.rows().len()), ("a CPU, 2 threads", 1));
    assert_eq!(read.text().lines().next(), Some(old), "a header is written as it was read");
}

#[test]
fn a_row_of_other_settings_takes_the_place_of_the_old_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "rows", "m", &[row("a", 1.0, 0.1), row("b", 2.0, 0.1)]);
    let changed = Measured { proof: of_settings("t"), ..row("a", 3.0, 0.1) };
    let mut journal = open(&path, header("m")).unwrap();
    assert!(journal.holds(&key("a")) && !journal.holds(&changed.key()));
    journal.push(changed.clone()).unwrap();
    assert!(!journal.holds(&key("a")) && journal.holds(&changed.key()));
    // Stopped here, the later line counts; finished, it is the only one.
    drop(journal);
    let mut journal = open(&path, header("m")).unwrap();
    assert_eq!(journal.rows(), [changed.clone(), row("b", 2.0, 0.1)]);
    journal.finish().unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap().lines().count(), 3);
    let old = file(folder.path(), "old", "m", &[row("a", 1.0, 0.1)]);
    let error = merged(&path, &[path.clone(), old]).unwrap_err().to_string();
    assert!(
        error.ends_with("old: line 2: contradicts an earlier line with the same key; delete one of both"),
        "{error}"
    );
}

#[test]
fn a_torn_last_line_is_reported_and_dropped_and_the_file_continues() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [row("a", 1.0, 0.1), row("b", 2.0, 0.1)];
    let path = file(folder.path(), "rows", "m", &rows);
    let whole = std::fs::read(&path).unwrap();
    // Wherever the machine stopped within the last line, or within the first.
    let last = whole.len() - line(&rows[1]).len() - 1;
    for cut in (last + 1..whole.len()).chain(1..20) {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let mut journal = open(&path, header("m")).unwrap();
        let kept = usize::from(cut > last);
        assert_eq!(journal.rows(), rows[..kept], "{cut}");
        assert_eq!(journal.notes().len(), 1, "{cut}");
        assert!(
            journal.notes()[0].ends_with(" bytes, a line that was never finished"),
            "{:?}",
            journal.notes()
        );
        rows[kept..].iter().for_each(|row| journal.push(row.clone()).unwrap());
        drop(journal);
        assert_eq!(std::fs::read(&path).unwrap(), whole, "{cut}");
    }
}

#[test]
fn two_processes_never_add_to_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows");
    let mut first = open(&path, header("m")).unwrap();
    first.push(row("a", 1.0, 0.1)).unwrap();
    assert!(matches!(open(&path, header("m")), Err(JournalError::Busy(_))));
    first.push(row("b", 1.0, 0.1)).unwrap();
    first.finish().unwrap();
    // A finished file is free although its writer lives on.
    assert_eq!(open(&path, header("m")).unwrap().rows().len(), 2);
}

#[test]
fn a_file_without_a_row_is_gone_with_its_journal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows");
    drop(open(&path, header("m")).unwrap());
    assert!(!path.exists());
    open(&path, header("m")).unwrap().push(row("a", 1.0, 0.1)).unwrap();
    drop(open(&path, header("m")).unwrap());
    assert_eq!(open(&path, header("m")).unwrap().rows().len(), 1);
}

#[test]
fn a_row_is_on_the_disk_when_push_returns_and_the_file_is_never_written_anew() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows");
    let mut journal = open(&path, header("m")).unwrap();
    // The header comes with the first row.
    assert_eq!(std::fs::read(&path).unwrap(), b"");
    journal.push(row("d", 1.0, 0.1)).unwrap();
    let mut before = std::fs::read(&path).unwrap();
    for name in ["c", "b", "a"] {
        journal.push(row(name, 1.0, 0.1)).unwrap();
        let after = std::fs::read(&path).unwrap();
        assert_eq!(after, [&before[..], (line(&row(name, 1.0, 0.1)) + "\n").as_bytes()].concat());
        before = after;
    }
}

#[test]
fn infinite_decibels_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [row("black", f64::INFINITY, 0.1)];
    let path = file(folder.path(), "rows", "m", &rows);
    assert_eq!(open(&path, header("m")).unwrap().rows(), rows);
    // What has no form is rejected before it makes the file unreadable.
    let mut journal = open(&path, header("m")).unwrap();
    let error = journal.push(row("lost", 1.0, f64::NAN)).unwrap_err().to_string();
    assert!(error.starts_with("a row of test cannot be written so that it is read back: {"), "{error}");
    drop(journal);
    assert_eq!(open(&path, header("m")).unwrap().rows(), rows);
}

#[test]
fn files_of_something_else_are_named_with_their_line_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "rows", "m", &[row("a", 1.0, 0.1)]);
    let refused = |header| open(&path, header).unwrap_err().to_string();
    let error = refused(Header { layout: 2, ..header("m") });
    assert!(
        error.contains("its rows are of test 1 (m, ") && error.ends_with(": name another file"),
        "{error}"
    );
    for (text, words) in [
        (line(&header("m")) + "\n{\"name\":\n", "rows: line 2: "),
        ("a text".into(), "rows: line 1: "),
        ("a text\nof two lines".into(), "rows: line 1: "),
    ] {
        std::fs::write(&path, &text).unwrap();
        assert!(refused(header("m")).contains(words), "{}", refused(header("m")));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    }
    assert!(matches!(open(folder.path(), header("m")), Err(JournalError::Write { .. })));
    let none = folder.path().join("none");
    let error = merged(&path, &[none]).unwrap_err().to_string();
    assert!(error.ends_with("none: contains no rows of a study; name a file that --rows wrote"), "{error}");
}

#[test]
fn a_shard_is_one_of_so_many() {
    assert_eq!("3/8".parse::<Shard>().unwrap().to_string(), "3/8");
    for wrong in ["", "1", "0/4", "5/4", "1/0", "a/b", "1/2/3", "-1/2"] {
        let error = wrong.parse::<Shard>().unwrap_err().to_string();
        assert_eq!(error, format!("shard '{wrong}': must be I/N such as 2/8, I from 1 to N"));
    }
}
