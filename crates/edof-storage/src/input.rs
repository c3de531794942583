//! Files that are read: regular ones only. Opening a named pipe waits until somebody writes into it, maybe for ever, and a device may
//! never end.

use std::fs::{File, FileType};
use std::io::{Error, ErrorKind};
use std::path::Path;

/// Opens a regular file.
///
/// # Errors
/// What the system says, or what the path leads to in place of a file, and what to do.
pub fn open(path: &Path) -> Result<File, Error> {
    // Before it is opened: a pipe waits there already.
    check(path)?;
    File::open(path)
}

/// The bytes of a regular file.
///
/// # Errors
/// As [`open`].
pub fn read(path: &Path) -> Result<Vec<u8>, Error> {
    check(path)?;
    std::fs::read(path)
}

/// Whether a path leads to a regular file.
///
/// # Errors
/// As [`open`].
pub fn check(path: &Path) -> Result<(), Error> {
    if path.as_os_str().is_empty() {
        return Err(Error::new(ErrorKind::InvalidInput, "an empty name, expected that of a file"));
    }
    let found = std::fs::metadata(path)?.file_type();
    match words(found) {
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
