//! Rows of an experiment in a file of JSON lines: added as they come, resumed where they end, shared out among machines and put
//! together again.
//!
//! A line says what the rows below it have in common ([`Header`]): the study, the program's revision and the machine. A row has a key ([`Key`]): contents of photographs, weights and cameras and all settings by their hashes ([`Proof`]). So it does
//! not matter which run made it. A row is on the disk before the next one is measured; a finished file holds its rows in the order of
//! their keys. Runs that were interrupted, shared out or not give the same file, times aside.

mod cells;
mod file;
mod header;
mod proof;

pub use cells::{Ordered, Progress, Shard, ShardError};
pub use header::{Header, Maker, Program, RowsFile, UNKNOWN};
pub use proof::{Proof, settings};

use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::digest::sha256;
use edof_core::storage::json::reason;
use file::{Locked, Text};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A row.
pub trait Line: Clone + Serialize + DeserializeOwned {
    /// Name of the study.
    const STUDY: &'static str;
    /// Version of the rows' layout.
    const LAYOUT: u32;
    /// What a page calls a row, in the order in which finished files hold rows. Of rows that a page could not tell apart only the last is
    /// kept.
    type Subject: Clone + std::fmt::Debug + Ord;

    /// What a page calls this one.
    fn subject(&self) -> Self::Subject;

    /// What it was measured from.
    fn proof(&self) -> &Proof;

    /// Both.
    fn key(&self) -> Key<Self> {
        Key { subject: self.subject(), proof: self.proof().clone() }
    }

    /// The row without its times and its memory, which no two runs agree about.
    fn timeless(&self) -> Self;
}

/// What a row is of: what a page calls it, and hashes of all that it was measured from.
#[derive(Debug, Clone)]
pub struct Key<L: Line> {
    /// What a page calls it.
    pub subject: L::Subject,
    /// What it was measured from.
    pub proof: Proof,
}

impl<L: Line> Ord for Key<L> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (&self.subject, &self.proof).cmp(&(&other.subject, &other.proof))
    }
}

impl<L: Line> PartialOrd for Key<L> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<L: Line> PartialEq for Key<L> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<L: Line> Eq for Key<L> {}

/// A file of rows that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum JournalError {
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file cannot be read.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Another process has it.
    #[error("{path}: another process is adding rows to this file: wait for it, or name another file", path = .0.display())]
    Busy(PathBuf),
    /// Nothing in it, where rows were asked for.
    #[error("{path}: contains no rows of a study; name a file that --rows wrote", path = .0.display())]
    Empty(PathBuf),
    /// Another file.
    #[error("{path}: line {line}: {reason}", path = path.display())]
    Line { path: PathBuf, line: usize, reason: String },
    /// The same row twice.
    #[error("{path}: line {line}: contradicts an earlier line with the same key; delete one of both", path = path.display())]
    Twice { path: PathBuf, line: usize },
    /// Rows that cannot be mixed with new ones.
    #[error("{path}: its rows are of {found}, this study is of {wanted}: {hint}", path = path.display())]
    Other { path: PathBuf, found: Box<Header>, wanted: Box<Header>, hint: &'static str },
    /// Rows of different studies.
    #[error("{path}: its rows are of {found}, those of {first} are of {wanted}{hint}", path = path.display(), first = first.display())]
    Mixed { path: PathBuf, found: Box<Header>, first: PathBuf, wanted: Box<Header>, hint: &'static str },
    /// A row that its own line does not give back.
    #[error("a row of {study} cannot be written so that it is read back: {line}")]
    Unreadable { study: &'static str, line: String },
}

/// Which rows of different programs or machines may be merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mixing {
    /// Of any revision and compiler.
    pub any_revision: bool,
    /// Of any machine.
    pub any_machine: bool,
}

/// A row and the text that holds it: one that is there stays as it is, to the last digit.
#[derive(Debug)]
struct Held<L> {
    row: L,
    text: String,
    /// Place of its header.
    header: usize,
}

/// The rows that there are, in their file.
#[derive(Debug)]
pub struct Journal<L: Line> {
    /// None: rows are kept in memory alone.
    path: Option<PathBuf>,
    /// Open from the first row to the last.
    file: Option<Locked>,
    /// Those of all rows; where rows are measured, that of new ones is the last.
    headers: Vec<Header>,
    /// By what a page calls them.
    held: BTreeMap<L::Subject, Held<L>>,
    /// Which of them in the order in which they came.
    order: Vec<L::Subject>,
    notes: Vec<String>,
    /// The header of new rows, until the first of them is written.
    pending: String,
}

impl<L: Line> Journal<L> {
    /// Opens a file of rows, or begins one. Until it is finished or dropped no other process can open it. Rows that are there stay; of
    /// another revision they may be only where `mixing` says so.
    ///
    /// # Errors
    /// [`JournalError`]: another file, rows of another study or program, or a file that another process has open.
    pub fn open(path: &Path, header: Header, mixing: Mixing) -> Result<Self, JournalError> {
        let mut journal = Self { path: Some(path.to_owned()), ..Self::in_memory(header) };
        let mut file = Locked::open(path)?;
        let text = file.read()?;
        let wanted = journal.headers.clone();
        for found in headers(path, &text)? {
            let hint = match (&found.maker, &wanted[0].maker) {
                _ if (&found.study, found.layout) != (&wanted[0].study, wanted[0].layout) => {
                    Some("name another file")
                }
                (Maker::Program(found), Maker::Program(new)) if found.is_on_the_machine_of(new) => {
                    let kept = mixing.any_revision || found.is_built_as(new);
                    (!kept).then_some("name another file, or keep rows of other revisions by --any-revision")
                }
                _ => Some("name another file"),
            };
            if let Some(hint) = hint {
                let (found, wanted) = (Box::new(found), Box::new(wanted[0].clone()));
                return Err(JournalError::Other { path: path.to_owned(), found, wanted, hint });
            }
        }
        journal.take(path, &text, Newer::Replaces)?;
        file.cut(&text)?;
        journal.file = Some(file);
        // New rows go below the last header of the file.
        let own = journal.headers.remove(0);
        journal.held.values_mut().for_each(|held| held.header -= 1);
        if journal.headers.last() != Some(&own) {
            // Written with the first row: a study that is rejected leaves no file.
            journal.pending = line(&own) + "\n";
            journal.headers.push(own);
        }
        Ok(journal)
    }

    /// Puts files of one study together. Of a row that several hold the first stays; all must agree about everything but times. Of
    /// different machines or revisions they may be where `mixing` says so.
    ///
    /// # Errors
    /// [`JournalError`]: a file of another kind, a file that differs, or an answer that differs.
    pub fn merged(path: &Path, files: &[PathBuf], mixing: Mixing) -> Result<Self, JournalError> {
        let mut all = Self { path: Some(path.to_owned()), ..Self::in_memory_of(vec![]) };
        let mut first: Option<(Header, &PathBuf)> = None;
        for path in files {
            let text = file::read(path)?.unwrap_or_default();
            let own = headers(path, &text)?;
            if own.is_empty() {
                return Err(JournalError::Empty(path.clone()));
            }
            for found in own {
                let (wanted, file) = first.get_or_insert_with(|| (found.clone(), path));
                if let Some(hint) = apart::<L>(&found, wanted, mixing) {
                    let (found, wanted) = (Box::new(found), Box::new(wanted.clone()));
                    let (path, first) = (path.clone(), file.clone());
                    return Err(JournalError::Mixed { path, found, first, wanted, hint });
                }
            }
            all.take(path, &text, Newer::MustAgree)?;
        }
        if first.is_none() {
            return Err(JournalError::Empty(path.to_owned()));
        }
        all.sort();
        Ok(all)
    }

    /// Rows without a file: what is measured lasts as long as the program.
    #[must_use]
    pub fn in_memory(header: Header) -> Self {
        Self::in_memory_of(vec![header])
    }

    fn in_memory_of(headers: Vec<Header>) -> Self {
        Self {
            path: None,
            file: None,
            headers,
            held: BTreeMap::new(),
            order: vec![],
            notes: vec![],
            pending: String::new(),
        }
    }

    /// Takes the rows of a file's text over.
    fn take(&mut self, path: &Path, text: &Text, newer: Newer) -> Result<(), JournalError> {
        if !text.torn.is_empty() {
            let (bytes, path) = (text.torn.len(), path.display());
            self.notes
                .push(format!("{path}: dropped the last {bytes} bytes, a line that was never finished"));
        }
        for (index, text) in text.lines.iter().enumerate() {
            if Header::is_at(text) {
                self.headers.push(parsed(path, index + 1, text)?);
                continue;
            }
            let row: L = parsed(path, index + 1, text)?;
            let header = self.headers.len() - 1;
            let there = self.held.get(&row.subject());
            let is_same = there.map(|held| held.row.proof() == row.proof());
            let agrees = there.is_some_and(|held| agree(&json(&held.row.timeless()), &json(&row.timeless())));
            match (is_same, newer) {
                (Some(true), _) if agrees => {}
                (Some(true), _) | (Some(false), Newer::MustAgree) => {
                    return Err(JournalError::Twice { path: path.to_owned(), line: index + 1 });
                }
                (Some(false), Newer::Replaces) | (None, _) => self.add(row, text.clone(), header),
            }
        }
        Ok(())
    }

    fn add(&mut self, row: L, text: String, header: usize) {
        let subject = row.subject();
        if self.held.insert(subject.clone(), Held { row, text, header }).is_none() {
            self.order.push(subject);
        }
    }

    /// All rows, in the order in which they came, or in that of their keys in a finished file.
    #[must_use]
    pub fn rows(&self) -> Vec<L> {
        self.order.iter().map(|subject| self.held[subject].row.clone()).collect()
    }

    /// What measured the rows that there are, each once.
    #[must_use]
    pub fn makers(&self) -> Vec<Maker> {
        let mut makers: Vec<Maker> = vec![];
        for held in self.held.values() {
            let maker = &self.headers[held.header].maker;
            if !makers.contains(maker) {
                makers.push(maker.clone());
            }
        }
        makers.sort_by_cached_key(line);
        makers
    }

    /// What was wrong with the file and was put right, one line each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Whether a row is there, of these very inputs and settings.
    #[must_use]
    pub fn holds(&self, key: &Key<L>) -> bool {
        self.held.get(&key.subject).is_some_and(|held| *held.row.proof() == key.proof)
    }

    /// Adds a row, in the place of one of other inputs or settings that pages would call the same. The file holds it when this returns.
    ///
    /// # Errors
    /// [`JournalError::Write`]; [`JournalError::Unreadable`] for a row that holds a number which its layout has no form for.
    pub fn push(&mut self, row: L) -> Result<(), JournalError> {
        let text = line(&row);
        let back = serde_json::from_str::<L>(&text).ok().map(|back| line(&back));
        if back.as_ref() != Some(&text) {
            return Err(JournalError::Unreadable { study: L::STUDY, line: text });
        }
        let lines = self.pending.clone() + &text + "\n";
        self.append(&lines)?;
        self.pending.clear();
        self.add(row, text, self.headers.len() - 1);
        Ok(())
    }

    fn append(&mut self, lines: &str) -> Result<(), JournalError> {
        let Some(path) = &self.path else { return Ok(()) };
        let file = match &mut self.file {
            Some(file) => file,
            none => none.insert(Locked::open(path)?),
        };
        Ok(file.append(lines)?)
    }

    /// Puts the rows into their order, in the file too, and leaves the file to others.
    ///
    /// # Errors
    /// [`JournalError::Write`].
    pub fn finish(&mut self) -> Result<(), JournalError> {
        self.sort();
        if let Some(path) = &self.path {
            atomic::write(path, self.text().as_bytes())?;
        }
        self.pending.clear();
        self.file = None;
        Ok(())
    }

    /// Returns the number of rows of a finished file and its SHA-256; nothing of rows without a file.
    #[must_use]
    pub fn file(&self) -> Option<RowsFile> {
        self.path.as_ref()?;
        let sha256 = sha256(self.text().as_bytes());
        Some(RowsFile { rows: self.order.len(), sha256, git: None })
    }

    fn sort(&mut self) {
        self.order = self.held.keys().cloned().collect();
    }

    /// Every header above its rows. A header is there once, and where it has rows.
    fn text(&self) -> String {
        let mut parts: BTreeMap<String, String> = BTreeMap::new();
        for held in self.order.iter().map(|subject| &self.held[subject]) {
            *parts.entry(line(&self.headers[held.header])).or_default() += &(held.text.clone() + "\n");
        }
        if parts.is_empty() {
            parts.extend(self.headers.last().map(|header| (line(header), String::new())));
        }
        parts.into_iter().map(|(header, rows)| header + "\n" + &rows).collect()
    }
}

/// What becomes of a row of what an earlier one is of, measured from other inputs or with other settings.
#[derive(Debug, Clone, Copy)]
enum Newer {
    /// In one file: it was measured later.
    Replaces,
    /// In different ones: it is unknown which is right.
    MustAgree,
}

/// Why rows may not be merged with those of the first file, and what to do about it.
fn apart<L: Line>(found: &Header, first: &Header, mixing: Mixing) -> Option<&'static str> {
    if found.study != L::STUDY || (&found.study, found.layout) != (&first.study, first.layout) {
        return Some("");
    }
    match (&found.maker, &first.maker) {
        (found, first) if found == first => None,
        (Maker::Program(a), Maker::Program(b)) => {
            if !(mixing.any_machine || a.is_on_the_machine_of(b)) {
                Some("; --any-machine takes both, and says so")
            } else if !(mixing.any_revision || a.is_built_as(b)) {
                Some("; --any-revision takes both, and says so")
            } else {
                None
            }
        }
        (Maker::Old { exact: a, .. }, Maker::Old { exact: b, .. }) if a == b => {
            (!mixing.any_machine).then_some("; --any-machine takes both, and says so")
        }
        _ => Some(""),
    }
}

/// Headers of a file; the first line must be one, whole or torn.
fn headers(path: &Path, text: &Text) -> Result<Vec<Header>, JournalError> {
    if text.lines.is_empty() && !Header::may_begin(&text.torn) {
        parsed::<Header>(path, 1, &String::from_utf8_lossy(&text.torn))?;
    }
    let all = text.lines.iter().enumerate().filter(|(index, line)| *index == 0 || Header::is_at(line));
    all.map(|(index, line)| parsed(path, index + 1, line)).collect()
}

fn parsed<T: DeserializeOwned>(path: &Path, line: usize, text: &str) -> Result<T, JournalError> {
    serde_json::from_str(text).map_err(|error| JournalError::Line {
        path: path.to_owned(),
        line,
        reason: format!(
            "not a row of a study: {}; expected what --rows wrote; name another file, or delete the line: its row is measured again",
            reason(&error)
        ),
    })
}

/// Whether two rows are equal wherever both have a field: a metric that only the newer one holds is no contradiction.
fn agree(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            a.iter().all(|(field, value)| b.get(field).is_none_or(|other| agree(value, other)))
        }
        _ => a == b,
    }
}

fn json(value: &impl Serialize) -> Value {
    serde_json::to_value(value).unwrap_or_else(|e| unreachable!("rows are plain data: {e}"))
}

fn line(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_else(|e| unreachable!("rows are plain data: {e}"))
}

#[cfg(test)]
mod tests;
