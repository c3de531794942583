//! Files that are read: regular ones, and pipes that a shell opened for this program (`/dev/stdin`, `<(…)`). Opening a named pipe waits
//! until somebody writes into it, maybe for ever, and a device may never end.

use std::collections::BTreeMap;
use std::fs::{File, FileType};
use std::io::{Error, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Most bytes that are read from a pipe.
const MAX_PIPED: u64 = 1 << 30;

/// Opens a regular file, or what came through a pipe.
///
/// # Errors
/// What the system says, or what the path leads to in place of a file, and what to do.
pub fn open(path: &Path) -> Result<File, Error> {
    // Before it is opened: a named pipe waits there already.
    check(path)?;
    if is_pipe_of_ours(path) { piped(path) } else { File::open(path) }
}

/// The bytes of a regular file.
///
/// # Errors
/// As [`open`].
pub fn read(path: &Path) -> Result<Vec<u8>, Error> {
    let mut bytes = vec![];
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Whether a path leads to what [`open`] opens.
#[must_use]
pub fn is_file(path: &Path) -> bool {
    path.is_file() || is_pipe_of_ours(path)
}

/// Whether a path leads to a pipe that this program already has open: its other end is a running program's.
fn is_pipe_of_ours(path: &Path) -> bool {
    is_descriptor(path) && leads_to_pipe(path)
}

/// Whether a path leads to a pipe of which this program knows nothing.
#[must_use]
pub fn is_named_pipe(path: &Path) -> bool {
    !is_descriptor(path) && leads_to_pipe(path)
}

fn is_descriptor(path: &Path) -> bool {
    let streams = ["/dev/stdin", "/dev/stdout", "/dev/stderr"];
    let folders = ["/dev/fd", "/proc/self/fd"];
    streams.iter().any(|stream| path == Path::new(stream))
        || folders.iter().any(|folder| path.parent() == Some(Path::new(folder)))
}

fn leads_to_pipe(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|found| is_pipe(found.file_type()))
}

/// What comes through a pipe, as a file that can be read again: what was read once is gone from the pipe.
fn piped(path: &Path) -> Result<File, Error> {
    static KEPT: Mutex<BTreeMap<PathBuf, File>> = Mutex::new(BTreeMap::new());
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if !kept.contains_key(path) {
        // A file without a name is gone with the process.
        let mut file = tempfile::tempfile()?;
        let mut pipe = File::open(path)?.take(MAX_PIPED + 1);
        if std::io::copy(&mut pipe, &mut file)? > MAX_PIPED {
            let limit =
                "larger than 1 GiB, expected less from a pipe; save its content to a file and name that one";
            return Err(Error::new(ErrorKind::InvalidInput, limit));
        }
        kept.insert(path.to_owned(), file);
    }
    kept.get(path).map_or_else(|| Err(ErrorKind::NotFound.into()), again)
}

/// Whether a path leads to what [`open`] opens, in words if not.
///
/// # Errors
/// As [`open`].
pub fn check(path: &Path) -> Result<(), Error> {
    if path.as_os_str().is_empty() {
        return Err(Error::new(ErrorKind::InvalidInput, "an empty name, expected that of a file"));
    }
    let found = std::fs::metadata(path)?.file_type();
    match words(found).filter(|_| !is_pipe_of_ours(path)) {
        None => Ok(()),
        Some((what, advice)) => {
            let kind = if found.is_dir() { ErrorKind::IsADirectory } else { ErrorKind::InvalidInput };
            Err(Error::new(kind, format!("{what}, expected a regular file{advice}")))
        }
    }
}

/// What is no regular file, and what to do.
fn words(found: FileType) -> Option<(&'static str, &'static str)> {
    const SAVE: &str = "; save its content to a file and name that one";
    match found {
        found if found.is_file() => None,
        found if found.is_dir() => Some(("a folder", "; name a file in it")),
        found => Some((special(found), SAVE)),
    }
}

/// The same file from its beginning, with a position of its own.
#[cfg(unix)]
fn again(file: &File) -> Result<File, Error> {
    use std::os::fd::AsRawFd;
    File::open(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

#[cfg(not(unix))]
fn again(file: &File) -> Result<File, Error> {
    file.try_clone()
}

#[cfg(unix)]
fn is_pipe(found: FileType) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&found)
}

#[cfg(not(unix))]
fn is_pipe(_: FileType) -> bool {
    false
}

#[cfg(unix)]
fn special(found: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    match found {
        found if found.is_fifo() => "a named pipe",
        found if found.is_socket() => "a socket",
        _ => "a device",
    }
}

#[cfg(not(unix))]
fn special(_: FileType) -> &'static str {
    "a device"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        std::fs::write(&path, "content").unwrap();
        assert_eq!(read(&path).unwrap(), b"content");
        open(&path).unwrap();
        assert_eq!(open(&folder.path().join("y")).unwrap_err().kind(), ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn whatever_is_no_file_is_named_and_rejected_before_it_is_opened() {
        let folder = tempfile::tempdir().unwrap();
        let (pipe, socket) = (folder.path().join("pipe"), folder.path().join("socket"));
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for (path, what) in [
            (folder.path(), "a folder, expected a regular file; name a file in it"),
            (&pipe, "a named pipe, expected a regular file; save its content to a file and name that one"),
            (&socket, "a socket, expected a regular file; save its content to a file and name that one"),
            (
                Path::new("/dev/zero"),
                "a device, expected a regular file; save its content to a file and name that one",
            ),
        ] {
            assert_eq!(read(path).unwrap_err().to_string(), what);
            assert_eq!(open(path).unwrap_err().to_string(), what);
        }
    }
}
