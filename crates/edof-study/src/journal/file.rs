//! A file of lines to which one process at a time adds: each line is on the disk before the next is measured.

use super::JournalError;
use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::input;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// Whole lines of a file, and what was left of one that was being written when the machine stopped.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Text {
    /// Without their ends.
    pub lines: Vec<String>,
    /// A last line without an end.
    pub torn: Vec<u8>,
    /// Bytes of the whole lines.
    pub whole: u64,
}

/// The longest line that is read: a row of a study with its pictures has a few megabytes.
const MAX_LINE: u64 = 256 << 20;

/// Lines of a file; none where there is no file.
pub(super) fn read(path: &Path) -> Result<Option<Text>, JournalError> {
    let cannot = |source| JournalError::Read { path: path.to_owned(), source };
    let file = match input::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(cannot(error)),
    };
    lines(file, MAX_LINE).map(Some).map_err(cannot)
}

fn lines(file: impl Read, max_line: u64) -> std::io::Result<Text> {
    let mut reader = BufReader::new(file);
    let mut text = Text::default();
    loop {
        let mut bytes = vec![];
        reader.by_ref().take(max_line + 1).read_until(b'\n', &mut bytes)?;
        if bytes.pop_if(|last| *last == b'\n').is_none() {
            if bytes.len() as u64 > max_line {
                let line = text.lines.len() + 1;
                let why = format!("line {line} is longer than {max_line} bytes: expected rows of a study");
                return Err(std::io::Error::new(ErrorKind::InvalidData, why));
            }
            text.torn = bytes;
            return Ok(text);
        }
        text.whole += bytes.len() as u64 + 1;
        let line = String::from_utf8(bytes).map_err(|_| {
            let why = format!("line {} is no text: expected rows of a study", text.lines.len() + 1);
            std::io::Error::new(ErrorKind::InvalidData, why)
        })?;
        text.lines.push(line);
    }
}

/// A file that this process alone adds to.
#[derive(Debug)]
pub(super) struct Locked {
    path: PathBuf,
    file: File,
    length: u64,
    /// Whether there was no such file before.
    is_new: bool,
}

impl Locked {
    /// Opens a file or makes one, and whatever folder is missing; another process that has it open here is an error, not a wait.
    pub fn open(path: &Path) -> Result<Self, JournalError> {
        let failed = |source| WriteError { path: path.to_owned(), source };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        folder.map_or(Ok(()), std::fs::create_dir_all).map_err(failed)?;
        loop {
            let is_new = !path.exists();
            if !is_new {
                input::check(path).map_err(failed)?;
            }
            let file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(failed)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(JournalError::Busy(path.to_owned())),
                Err(TryLockError::Error(error)) => return Err(failed(error).into()),
            }
            // Anybody who had it may have put a finished file in its place meanwhile.
            if is_at(&file, path).map_err(failed)? {
                if is_new {
                    atomic::sync(folder.unwrap_or(Path::new("."))).map_err(failed)?;
                }
                let length = file.metadata().map_err(failed)?.len();
                return Ok(Self { path: path.to_owned(), file, length, is_new });
            }
        }
    }

    /// Reads the lines of the file.
    pub fn read(&self) -> Result<Text, JournalError> {
        Ok(read(&self.path)?.unwrap_or_default())
    }

    /// Cuts off what follows its whole lines.
    pub fn cut(&mut self, text: &Text) -> Result<(), WriteError> {
        if self.length > text.whole {
            let cut = self.file.set_len(text.whole).and_then(|()| self.file.sync_data());
            cut.map_err(|source| WriteError { path: self.path.clone(), source })?;
            self.length = text.whole;
        }
        Ok(())
    }

    /// Adds lines and waits until they are on the disk; where that fails the file is as it was.
    pub fn append(&mut self, lines: &str) -> Result<(), WriteError> {
        let added = self.file.write_all(lines.as_bytes()).and_then(|()| self.file.sync_data());
        if let Err(source) = added {
            // Anybody who reads a torn line drops it, should this fail too.
            let _ = self.file.set_len(self.length);
            return Err(WriteError { path: self.path.clone(), source });
        }
        self.length += lines.len() as u64;
        Ok(())
    }
}

/// A new file without a line is taken away again: a study that is rejected leaves nothing.
impl Drop for Locked {
    fn drop(&mut self) {
        if self.is_new && self.length == 0 && is_at(&self.file, &self.path).unwrap_or(false) {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Whether the file that is open is the one at the path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> std::io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let open = file.metadata()?;
    match std::fs::metadata(path) {
        Ok(there) => Ok((there.dev(), there.ino()) == (open.dev(), open.ino())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// An open file cannot be replaced.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> std::io::Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_without_an_end_is_torn_whatever_is_in_it() {
        let text = lines(&b"one\ntwo\nth\xff\0"[..], 100).unwrap();
        assert_eq!(
            text,
            Text { lines: vec!["one".into(), "two".into()], torn: b"th\xff\0".to_vec(), whole: 8 }
        );
        assert_eq!(lines(&b""[..], 100).unwrap(), Text::default());
    }

    #[test]
    fn a_line_that_is_too_long_is_an_error_and_never_a_shorter_one() {
        assert_eq!(lines(&b"123456\n"[..], 6).unwrap().lines, ["123456"]);
        for long in [&b"1\n1234567\n"[..], b"1\n1234567"] {
            let error = lines(long, 6).unwrap_err().to_string();
            assert_eq!(error, "line 2 is longer than 6 bytes: expected rows of a study");
        }
    }

    #[test]
    fn a_second_writer_is_rejected_until_the_first_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("some/rows");
        let first = Locked::open(&path).unwrap();
        let error = Locked::open(&path).unwrap_err().to_string();
        assert!(
            error.ends_with(
                "rows: another process is adding rows to this file: wait for it, or name another file"
            ),
            "{error}"
        );
        drop(first);
        Locked::open(&path).unwrap();
    }

    #[test]
    fn a_file_that_was_replaced_is_opened_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows");
        let old = Locked::open(&path).unwrap();
        edof_core::storage::atomic::write(&path, b"new\n").unwrap();
        assert!(!is_at(&old.file, &path).unwrap());
        assert_eq!(Locked::open(&path).unwrap().read().unwrap().lines, ["new"]);
    }
}
