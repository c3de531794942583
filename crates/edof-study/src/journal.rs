//! Rows of an experiment in a file of JSON lines: added as they come, gone on with where they end, shared out among machines and put
//! together again.
//!
//! The first line says what all rows have in common ([`Header`]). A row is known by what it is of ([`Line::Key`]): contents of
//! photographs, weights and cameras by their hashes, settings by their values. So it does not matter which run made it. A finished file
//! holds its rows in the order of their keys; runs that were interrupted, shared out or not give the same file, times aside.

use edof_spec::Noise;
use edof_spec::atomic::{self, WriteError};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A row.
pub trait Line: Clone + PartialEq + Serialize + DeserializeOwned {
    /// Name of the study.
    const STUDY: &'static str;
    /// Version of the rows' layout.
    const LAYOUT: u32;
    /// What a row is of, in the order in which finished files hold rows.
    type Key: Ord + Clone;

    /// What this one is of.
    fn key(&self) -> Self::Key;

    /// The row without its times and its memory, which no two runs agree about.
    fn timeless(&self) -> Self;
}

/// What all rows of a file have in common: its first line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// As in `single-depth`.
    pub study: String,
    /// Version of the rows' layout.
    pub layout: u32,
    /// Whole kernels.
    pub exact: bool,
    /// CPU and threads, without which times say nothing.
    pub machine: String,
}

impl Header {
    /// The first line of a study of such rows on this machine.
    #[must_use]
    pub fn of<L: Line>(exact: bool, machine: String) -> Self {
        Self { study: L::STUDY.into(), layout: L::LAYOUT, exact, machine }
    }

    /// The first line of a file.
    ///
    /// # Errors
    /// [`JournalError::Read`], [`JournalError::Empty`] or [`JournalError::Line`].
    pub fn read(path: &Path) -> Result<Self, JournalError> {
        let text = read(path)?.unwrap_or_default();
        let first = text.lines().next().ok_or_else(|| JournalError::Empty(path.to_owned()))?;
        parsed(path, 1, first)
    }
}

impl std::fmt::Display for Header {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kernels = if self.exact { "exact" } else { "cut kernels" };
        write!(f, "{} {} ({kernels}, {})", self.study, self.layout, self.machine)
    }
}

/// A file of rows that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum JournalError {
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It cannot be read.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Nothing in it, where rows were asked for.
    #[error("{path}: holds no rows of a study", path = .0.display())]
    Empty(PathBuf),
    /// Another file.
    #[error("{path}: line {line}: {reason}", path = path.display())]
    Line { path: PathBuf, line: usize, reason: String },
    /// The same row twice.
    #[error("{path}: line {line}: is of the same as an earlier line, which says otherwise", path = path.display())]
    Twice { path: PathBuf, line: usize },
    /// Rows that cannot stand beside new ones.
    #[error("{path}: its rows are of {found}, this study is of {wanted}: name another file", path = path.display())]
    Other { path: PathBuf, found: Box<Header>, wanted: Box<Header> },
    /// Rows of different studies.
    #[error("{path}: its rows are of {found}, those of {first} are of {wanted}{hint}", path = path.display(), first = first.display())]
    Mixed { path: PathBuf, found: Box<Header>, first: PathBuf, wanted: Box<Header>, hint: &'static str },
}

/// More than any file of rows has.
const MOST_BYTES: u64 = 256 << 20;

/// The rows that there are, in their file.
#[derive(Debug)]
pub struct Journal<L: Line> {
    /// None: rows are kept in memory alone.
    path: Option<PathBuf>,
    header: Header,
    /// Each row, and the line that holds it: one that is there stays as it is, to the last digit.
    rows: Vec<L>,
    lines: Vec<String>,
    /// Places of rows.
    places: BTreeMap<L::Key, usize>,
}

impl<L: Line> Journal<L> {
    /// Opens a file of rows, or begins one.
    ///
    /// # Errors
    /// [`JournalError`]: another file, or rows of another study.
    pub fn open(path: &Path, header: Header) -> Result<Self, JournalError> {
        let mut journal = Self::begun(Some(path.to_owned()), header);
        let Some(text) = read(path)?.filter(|text| !text.is_empty()) else { return Ok(journal) };
        let found: Header = parsed(path, 1, text.lines().next().unwrap_or_default())?;
        if found != journal.header {
            let (found, wanted) = (Box::new(found), Box::new(journal.header));
            return Err(JournalError::Other { path: path.to_owned(), found, wanted });
        }
        journal.take(path, &text)?;
        Ok(journal)
    }

    /// Puts files of one study together. Of a row that several hold the first stays; all must agree about everything but times. With
    /// `any_machine` the files may be of different ones, and the header then names all.
    ///
    /// # Errors
    /// [`JournalError`]: a file that is no such file, that differs, or an answer that does.
    pub fn merged(path: &Path, files: &[PathBuf], any_machine: bool) -> Result<Self, JournalError> {
        let mut journal: Option<(Self, &PathBuf)> = None;
        let mut machines: Vec<String> = vec![];
        for file in files {
            let header = Header::read(file)?;
            let (all, first) =
                journal.get_or_insert_with(|| (Self::begun(Some(path.to_owned()), header.clone()), file));
            let alike = Header { machine: all.header.machine.clone(), ..header.clone() } == all.header;
            if !alike || !(any_machine || header.machine == all.header.machine) || header.study != L::STUDY {
                let hint = if alike { "; --any-machine takes both, and says so" } else { "" };
                let (found, wanted) = (Box::new(header), Box::new(all.header.clone()));
                let (path, first) = (file.clone(), first.clone());
                return Err(JournalError::Mixed { path, found, first, wanted, hint });
            }
            if !machines.contains(&header.machine) {
                machines.push(header.machine);
            }
            all.take(file, &read(file)?.unwrap_or_default())?;
        }
        let (mut all, _) = journal.ok_or_else(|| JournalError::Empty(path.to_owned()))?;
        machines.sort();
        all.header.machine = machines.join("; ");
        all.sort();
        Ok(all)
    }

    /// Rows without a file: what is measured lasts as long as the program.
    #[must_use]
    pub fn in_memory(header: Header) -> Self {
        Self::begun(None, header)
    }

    fn begun(path: Option<PathBuf>, header: Header) -> Self {
        Self { path, header, rows: vec![], lines: vec![], places: BTreeMap::new() }
    }

    /// Takes the rows of a file's text over.
    fn take(&mut self, path: &Path, text: &str) -> Result<(), JournalError> {
        for (index, text) in text.lines().enumerate().skip(1) {
            let row: L = parsed(path, index + 1, text)?;
            match self.places.get(&row.key()) {
                Some(&place) if self.rows[place].timeless() == row.timeless() => {}
                Some(_) => return Err(JournalError::Twice { path: path.to_owned(), line: index + 1 }),
                None => self.add(row, text.to_owned()),
            }
        }
        Ok(())
    }

    fn add(&mut self, row: L, line: String) {
        self.places.insert(row.key(), self.rows.len());
        self.rows.push(row);
        self.lines.push(line);
    }

    /// All rows, in the file's order.
    #[must_use]
    pub fn rows(&self) -> &[L] {
        &self.rows
    }

    /// What all rows have in common.
    #[must_use]
    pub const fn header(&self) -> &Header {
        &self.header
    }

    /// Whether a row is there.
    #[must_use]
    pub fn holds(&self, key: &L::Key) -> bool {
        self.places.contains_key(key)
    }

    /// Adds a row. The file holds it, or is as it was.
    ///
    /// # Errors
    /// [`JournalError::Write`].
    pub fn push(&mut self, row: L) -> Result<(), JournalError> {
        let text = line(&row);
        self.add(row, text);
        self.write()
    }

    /// Puts the rows into their order, in the file too.
    ///
    /// # Errors
    /// [`JournalError::Write`].
    pub fn finish(&mut self) -> Result<(), JournalError> {
        self.sort();
        self.write()
    }

    fn sort(&mut self) {
        let order: Vec<usize> = self.places.values().copied().collect();
        self.rows = order.iter().map(|&place| self.rows[place].clone()).collect();
        self.lines = order.iter().map(|&place| std::mem::take(&mut self.lines[place])).collect();
        self.places.values_mut().enumerate().for_each(|(place, old)| *old = place);
    }

    fn write(&self) -> Result<(), JournalError> {
        let Some(path) = &self.path else { return Ok(()) };
        let lines = std::iter::once(line(&self.header)).chain(self.lines.iter().cloned());
        let text: String = lines.map(|line| line + "\n").collect();
        Ok(atomic::write(path, text.as_bytes())?)
    }
}

/// A file's text; nothing where there is no file.
fn read(path: &Path) -> Result<Option<String>, JournalError> {
    let mut text = String::new();
    // Devices may never end.
    match std::fs::File::open(path).and_then(|file| file.take(MOST_BYTES).read_to_string(&mut text)) {
        Ok(_) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(source) => Err(JournalError::Read { path: path.to_owned(), source }),
    }
}

fn parsed<T: DeserializeOwned>(path: &Path, line: usize, text: &str) -> Result<T, JournalError> {
    serde_json::from_str(text).map_err(|error| JournalError::Line {
        path: path.to_owned(),
        line,
        reason: error.to_string(),
    })
}

fn line(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_else(|e| unreachable!("rows are plain data: {e}"))
}

/// How far a study is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Progress {
    /// Rows done, those that were there included.
    pub done: usize,
    /// How many there will be.
    pub of: usize,
    /// What was measured last.
    pub last: String,
}

/// A number that has its place among all others.
#[derive(Debug, Clone, Copy)]
pub struct Ordered(pub f64);

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ordered {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ordered {}

impl Ordered {
    /// Numbers of a noise; none for none, which comes first.
    #[must_use]
    pub fn of_noise(noise: Noise) -> Vec<Self> {
        match noise {
            Noise::None => vec![],
            Noise::Gaussian { sigma } => vec![Self(sigma)],
            Noise::Sensor(s) => [s.gain, s.full_well_e, s.read_noise_e].map(Self).to_vec(),
        }
    }
}

/// A part of a study: every `of`-th of its rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which one, from 0.
    index: usize,
    of: usize,
}

/// A text that names no shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("shard '{0}': must be I/N such as 2/8, I from 1 to N")]
pub struct ShardError(String);

impl std::str::FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let number = |word: &str| word.parse::<usize>().ok();
        match text.split_once('/').and_then(|(i, n)| number(i).zip(number(n))) {
            Some((i, of)) if 1 <= i && i <= of => Ok(Self { index: i - 1, of }),
            _ => Err(ShardError(text.to_owned())),
        }
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.of)
    }
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { index: 0, of: 1 };

    /// Its own of a study's rows, each named by its key: every `of`-th in the keys' order, whatever the order they are given in. What
    /// is named twice counts once.
    #[must_use]
    pub fn own<K: Ord, T>(self, mut cells: Vec<(K, T)>) -> Vec<(K, T)> {
        cells.sort_by(|a, b| a.0.cmp(&b.0));
        cells.dedup_by(|a, b| a.0 == b.0);
        cells.into_iter().skip(self.index).step_by(self.of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
    struct Measured {
        name: String,
        db: f64,
        seconds: f64,
    }

    impl Line for Measured {
        const STUDY: &'static str = "test";
        const LAYOUT: u32 = 1;
        type Key = String;

        fn key(&self) -> String {
            self.name.clone()
        }

        fn timeless(&self) -> Self {
            Self { seconds: 0.0, ..self.clone() }
        }
    }

    fn row(name: &str, db: f64, seconds: f64) -> Measured {
        Measured { name: name.into(), db, seconds }
    }

    fn header(machine: &str) -> Header {
        Header::of::<Measured>(false, machine.into())
    }

    /// A file of rows, as a run leaves it that was stopped.
    fn file(folder: &Path, name: &str, machine: &str, rows: &[Measured]) -> PathBuf {
        let path = folder.join(name);
        let mut journal = Journal::open(&path, header(machine)).unwrap();
        rows.iter().for_each(|row| journal.push(row.clone()).unwrap());
        path
    }

    #[test]
    fn a_file_that_is_gone_on_with_keeps_its_lines_and_ends_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path(), "rows", "m", &[row("b", 2.0, 0.1)]);
        let first = std::fs::read_to_string(&path).unwrap();
        let mut journal = Journal::open(&path, header("m")).unwrap();
        assert!(journal.holds(&"b".into()) && !journal.holds(&"a".into()));
        journal.push(row("a", 1.0, 0.3)).unwrap();
        assert!(std::fs::read_to_string(&path).unwrap().starts_with(&first));
        journal.finish().unwrap();
        let names: Vec<&str> = journal.rows().iter().map(|r| r.name.as_str()).collect();
        assert_eq!(names, ["a", "b"]);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(first.lines().all(|line| text.lines().any(|other| other == line)), "{text}");
        let again = Journal::<Measured>::open(&path, header("m")).unwrap();
        assert_eq!(again.rows(), journal.rows());
    }

    #[test]
    fn numbers_come_back_to_the_last_bit() {
        // What a hasty reader of decimals takes for a neighbour.
        let numbers = [3.9634806967355276, 2.3182529167238846, 0.9671196784464513, 1.3627935748454505];
        let folder = tempfile::tempdir().unwrap();
        let rows: Vec<Measured> = numbers.map(|n| row(&n.to_string(), n, n)).to_vec();
        let path = file(folder.path(), "rows", "m", &rows);
        assert_eq!(Journal::<Measured>::open(&path, header("m")).unwrap().rows(), rows);
    }

    #[test]
    fn shards_share_all_rows_out_and_merged_they_are_the_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        let rows: Vec<Measured> = ["e", "b", "a", "d", "c", "b"].map(|n| row(n, 1.0, 0.1)).to_vec();
        let cells = || rows.iter().map(|r| (r.key(), r.clone())).collect::<Vec<_>>();
        let whole = folder.path().join("whole");
        let mut journal = Journal::open(&whole, header("m")).unwrap();
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
        Journal::<Measured>::merged(&together, &files, false).unwrap().finish().unwrap();
        assert_eq!(std::fs::read(&together).unwrap(), std::fs::read(&whole).unwrap());
    }

    #[test]
    fn answers_that_differ_are_refused_and_times_may() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let first = file(folder.path(), "1", "m", &[row("a", 1.0, 0.1)]);
        let same = file(folder.path(), "2", "m", &[row("a", 1.0, 0.7)]);
        let merged = Journal::<Measured>::merged(&out, &[first.clone(), same], false).unwrap();
        assert_eq!(merged.rows(), [row("a", 1.0, 0.1)]);
        let other = file(folder.path(), "3", "m", &[row("a", 1.5, 0.1)]);
        let error = Journal::<Measured>::merged(&out, &[first, other], false).unwrap_err().to_string();
        assert!(
            error.ends_with("3: line 2: is of the same as an earlier line, which says otherwise"),
            "{error}"
        );
        assert!(!out.exists());
    }

    #[test]
    fn machines_are_mixed_only_where_asked() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let files = [
            file(folder.path(), "1", "slow", &[row("a", 1.0, 0.1)]),
            file(folder.path(), "2", "fast", &[row("b", 1.0, 0.1)]),
        ];
        let error = Journal::<Measured>::merged(&out, &files, false).unwrap_err().to_string();
        assert!(
            error.contains("2: its rows are of test 1 (cut kernels, fast), those of ")
                && error
                    .ends_with("are of test 1 (cut kernels, slow); --any-machine takes both, and says so"),
            "{error}"
        );
        let merged = Journal::<Measured>::merged(&out, &files, true).unwrap();
        assert_eq!((merged.header().machine.as_str(), merged.rows().len()), ("fast; slow", 2));
    }

    #[test]
    fn files_of_something_else_are_named_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path(), "rows", "m", &[row("a", 1.0, 0.1)]);
        let open = |header| Journal::<Measured>::open(&path, header).unwrap_err().to_string();
        let error = open(Header { exact: true, ..header("m") });
        assert!(
            error.ends_with(
                "its rows are of test 1 (cut kernels, m), this study is of test 1 (exact, m): name another file"
            ),
            "{error}"
        );
        std::fs::write(&path, line(&header("m")) + "\n{\"name\":").unwrap();
        assert!(open(header("m")).contains("rows: line 2: "));
        std::fs::write(&path, "a text").unwrap();
        assert!(open(header("m")).contains("rows: line 1: "));
        assert!(matches!(
            Journal::<Measured>::open(folder.path(), header("m")),
            Err(JournalError::Read { .. })
        ));
        let none = folder.path().join("none");
        let error = Journal::<Measured>::merged(&path, &[none], false).unwrap_err().to_string();
        assert!(error.ends_with("none: holds no rows of a study"), "{error}");
    }

    #[test]
    fn a_shard_is_one_of_so_many() {
        assert_eq!("3/8".parse::<Shard>().unwrap().to_string(), "3/8");
        for wrong in ["", "1", "0/4", "5/4", "1/0", "a/b", "1/2/3", "-1/2"] {
            let error = wrong.parse::<Shard>().unwrap_err().to_string();
            assert_eq!(error, format!("shard '{wrong}': must be I/N such as 2/8, I from 1 to N"));
        }
    }
}
