//! Files that appear whole or not at all: written beside their target, flushed, then renamed over it, and the folder is flushed.
//! Folders that are missing are made. Devices, and pipes that a shell opened (`/dev/stdout`), stay what they are and are written straight.
//!
//! - A symbolic link stays, and the file that it leads to is written, whether it exists or not.
//! - A new file has the mode that the umask leaves of 0666. A replaced file keeps its mode, and its owner and group where the system allows.
//! - No other user can read a temporary file that replaces a private one.

use crate::storage::input;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{path}: cannot write: {reason}", path = path.display(), reason = reason(source))]
pub struct WriteError {
    /// The file that was asked for.
    pub path: PathBuf,
    /// What the system said.
    pub source: std::io::Error,
}

/// Why something cannot be written or started: what the system says, in words alone, and what to do where that is known.
#[must_use]
pub fn reason(error: &std::io::Error) -> String {
    use std::io::ErrorKind;
    let advice = match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "; make room there, or name another place",
        ErrorKind::FileTooLarge => "; the shell (ulimit -f) or the file system limits the size of files",
        ErrorKind::WouldBlock => {
            "; the limit of processes and threads is reached (ulimit -u, or that of a container)"
        }
        ErrorKind::ReadOnlyFilesystem => "; name a place on another one",
        _ => "",
    };
    said(error) + advice
}

/// What the system says, without its number.
#[must_use]
pub fn said(error: &std::io::Error) -> String {
    let text = error.to_string();
    match error.raw_os_error() {
        Some(code) => text.replace(&format!(" (os error {code})"), ""),
        None => text,
    }
}

/// Lets `fill` write a new file and puts it at `path` only if all of it reached the disk.
///
/// # Errors
/// [`WriteError`] naming `path`; whatever stood there before is then untouched.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    let attempt = || -> std::io::Result<()> {
        if is_device(path) {
            is_open(path)?;
            let mut device = std::io::BufWriter::new(open(path)?);
            fill(&mut device)?;
            return device.flush();
        }
        let path = &target(path)?;
        let replaced = Replaced::at(path);
        make_folders(folder(path))?;
        let (temporary, _unfinished) = begin(|| {
            let mut builder = tempfile::Builder::new();
            builder.prefix(".edof-").suffix(".partial");
            replaced.begin(&mut builder);
            let file = builder.tempfile_in(folder(path))?;
            let name = file.path().to_owned();
            Ok((file, name))
        })?;
        // Past the temporary file's own writer, whose errors hold the temporary name.
        let mut buffered = std::io::BufWriter::new(temporary.as_file());
        fill(&mut buffered)?;
        buffered.flush()?;
        drop(buffered);
        replaced.hand_on(temporary.as_file())?;
        temporary.as_file().sync_all()?;
        temporary.persist(path).map_err(|e| e.error)?;
        sync(folder(path))
    };
    attempt().map_err(|error| WriteError { path: path.to_owned(), source: without_name(error) })
}

/// A folder for files that are to be renamed into `parent` or below it. It goes away with the value, and when [`abandon`] is
/// called.
///
/// # Errors
/// What the system says of a folder that cannot be made there.
pub fn work_folder(parent: &Path) -> std::io::Result<WorkFolder> {
    let made = begin(|| {
        let folder = tempfile::Builder::new().prefix(".edof-").suffix(".partial").tempdir_in(parent)?;
        let name = folder.path().to_owned();
        Ok((folder, name))
    });
    made.map(|(folder, _unfinished)| WorkFolder { folder, _unfinished }).map_err(without_name)
}

/// See [`work_folder`].
#[derive(Debug)]
pub struct WorkFolder {
    folder: tempfile::TempDir,
    _unfinished: Unfinished,
}

impl WorkFolder {
    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes what is being written, and lets nobody begin anew: for a program that is about to be ended in the middle of its work.
pub fn abandon() {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        let _ = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    }
    // Anybody who waits for the list waits until the end.
    std::mem::forget(unfinished);
}

/// Temporary files and folders that exist now.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(vec![]);

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes a path off the list when it is dropped.
#[derive(Debug)]
struct Unfinished(PathBuf);

impl Drop for Unfinished {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

/// Makes something temporary and puts it on the list, without a moment in which it is there and not on it.
fn begin<T>(make: impl FnOnce() -> std::io::Result<(T, PathBuf)>) -> std::io::Result<(T, Unfinished)> {
    let mut list = unfinished();
    let (made, path) = make()?;
    list.push(path.clone());
    Ok((made, Unfinished(path)))
}

/// Whether a file could be written now, for anybody who has long work to do first. Nothing is made yet, no folder either.
///
/// # Errors
/// [`WriteError`] naming `path`, as writing it would give.
pub fn check(path: &Path) -> Result<(), WriteError> {
    let attempt = || -> std::io::Result<()> {
        if is_device(path) {
            return is_open(path);
        }
        let path = &target(path)?;
        if path.is_dir() {
            return Err(std::io::ErrorKind::IsADirectory.into());
        }
        let there = folder(path).ancestors().map(or_here).find(|folder| folder.exists());
        tempfile::tempfile_in(there.unwrap_or(Path::new("/"))).map(drop)
    };
    attempt().map_err(|error| WriteError { path: path.to_owned(), source: without_name(error) })
}

fn folder(path: &Path) -> &Path {
    path.parent().map_or(Path::new("."), or_here)
}

fn or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// Whether a path leads to a device, a pipe, or a file that this process has open already (`/dev/stdout > file`).
#[must_use]
pub fn is_device(path: &Path) -> bool {
    descriptor(path).is_some() || std::fs::metadata(path).is_ok_and(|what| !what.is_file() && !what.is_dir())
}

/// Name of the open file that a path leads to by the system's links to open files.
fn descriptor(path: &Path) -> Option<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MAX_LINKS {
        if place.parent().is_some_and(|folder| folder.ends_with("self/fd") || folder == Path::new("/dev/fd"))
        {
            return place.file_name().map(PathBuf::from);
        }
        place = folder(&place).join(fs::read_link(&place).ok()?);
    }
    None
}

/// Opens a device. Standard output and error are continued where they are, so that what is printed besides follows.
fn open(path: &Path) -> std::io::Result<File> {
    #[cfg(unix)]
    {
        use std::os::fd::AsFd;
        let number = descriptor(path);
        if number.as_deref() == Some(Path::new("1")) {
            return std::io::stdout().as_fd().try_clone_to_owned().map(File::from);
        }
        if number.as_deref() == Some(Path::new("2")) {
            return std::io::stderr().as_fd().try_clone_to_owned().map(File::from);
        }
    }
    fs::OpenOptions::new().append(true).open(path)
}

/// Rejects a named pipe: opening it waits until somebody reads from it, maybe for ever.
fn is_open(path: &Path) -> std::io::Result<()> {
    match input::is_named_pipe(path) {
        true => Err(std::io::Error::other("a named pipe, expected a regular file; name one, or /dev/stdout")),
        false => Ok(()),
    }
}

/// What the system said, without the temporary file's name that is wrapped around it.
fn without_name(error: std::io::Error) -> std::io::Error {
    let inner = error.get_ref().and_then(|wrapped| wrapped.source());
    let code = inner.and_then(|e| e.downcast_ref::<std::io::Error>()).and_then(std::io::Error::raw_os_error);
    code.map_or(error, std::io::Error::from_raw_os_error)
}

/// [`write_with`] for bytes available.
///
/// # Errors
/// As [`write_with`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_with(path, |w| w.write_all(bytes))
}

/// Most links from one to the next, as on Linux.
const MAX_LINKS: usize = 40;

/// Returns the file that writing to `path` writes: where its symbolic links lead, whether there is a file or not.
///
/// # Errors
/// Links that lead in a circle.
pub fn target(path: &Path) -> std::io::Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&place) {
            Ok(next) => place = folder(&place).join(next),
            Err(_) => return Ok(place),
        }
    }
    Err(std::io::Error::other("a symbolic link that leads in a circle; delete it, or name another file"))
}

/// Makes a folder and whatever is missing above it, and flushes the folders that contain them.
///
/// # Errors
/// What the system reports.
pub(crate) fn make_folders(path: &Path) -> std::io::Result<()> {
    let missing: Vec<&Path> = path.ancestors().map(or_here).take_while(|folder| !folder.exists()).collect();
    fs::create_dir_all(path)?;
    missing.into_iter().try_for_each(|made| sync(folder(made)))
}

/// Flushes a folder, so that names in it survive a power failure. File systems that cannot do so, and folders that may be
/// written but not read, are passed over.
///
/// # Errors
/// A folder that the disk fails to keep.
pub fn sync(folder: &Path) -> std::io::Result<()> {
    use std::io::ErrorKind::{InvalidInput, Unsupported};
    #[cfg(test)]
    tests::SYNCED.with_borrow_mut(|all| all.push(folder.to_owned()));
    match File::open(folder).map(|folder| folder.sync_all()) {
        Ok(Err(error)) if !matches!(error.kind(), InvalidInput | Unsupported) => Err(error),
        _ => Ok(()),
    }
}

/// Writes a file that will be renamed over `replaced`, with what such a file keeps, and flushes it.
///
/// # Errors
/// What the system reports.
pub(crate) fn write_for(replaced: &Path, place: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let replaced = Replaced::at(replaced);
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    replaced.open(&mut options);
    let mut file = options.open(place)?;
    file.write_all(bytes)?;
    replaced.hand_on(&file)?;
    file.sync_all()
}

/// What a file in the place of another keeps of it: mode, owner and group.
#[derive(Debug)]
struct Replaced(Option<fs::Metadata>);

#[cfg(unix)]
impl Replaced {
    /// What is there now; nothing where there is no regular file.
    fn at(path: &Path) -> Self {
        Self(fs::symlink_metadata(path).ok().filter(fs::Metadata::is_file))
    }

    /// Mode of the file while it is written. The umask still takes bits away. Group and others may not read what replaces a file
    /// before owner and group are right.
    fn first_mode(&self) -> u32 {
        use std::os::unix::fs::PermissionsExt;
        self.0.as_ref().map_or(0o666, |old| old.permissions().mode() & 0o600 | 0o200)
    }

    fn begin(&self, builder: &mut tempfile::Builder<'_, '_>) {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(self.first_mode()));
    }

    fn open(&self, options: &mut fs::OpenOptions) {
        use std::os::unix::fs::OpenOptionsExt;
        options.mode(self.first_mode());
    }

    /// Gives a finished file what the replaced one has. If its group cannot be kept, the group of the new file may do no more than all others.
    fn hand_on(&self, file: &File) -> std::io::Result<()> {
        use std::os::unix::fs::{MetadataExt, PermissionsExt, fchown};
        let Some(old) = &self.0 else { return Ok(()) };
        let new = file.metadata()?;
        let mut mode = old.permissions().mode() & 0o777;
        let owner = (old.uid() != new.uid()).then(|| old.uid());
        let is_same_group = old.gid() == new.gid() || fchown(file, None, Some(old.gid())).is_ok();
        if !is_same_group {
            mode = mode & !0o070 | (mode & 0o070 & ((mode & 0o007) << 3));
        }
        // Only root can give a file away; others keep what they write.
        let _ = owner.map(|owner| fchown(file, Some(owner), None));
        file.set_permissions(fs::Permissions::from_mode(mode))
    }
}

#[cfg(not(unix))]
impl Replaced {
    fn at(_: &Path) -> Self {
        Self(None)
    }

    fn begin(&self, _: &mut tempfile::Builder<'_, '_>) {}

    fn open(&self, _: &mut fs::OpenOptions) {}

    fn hand_on(&self, _: &File) -> std::io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    thread_local! {
        /// Folders that were flushed.
        pub static SYNCED: RefCell<Vec<PathBuf>> = const { RefCell::new(vec![]) };
    }

    #[test]
    fn a_folder_is_flushed_after_its_file_and_a_new_one_in_the_one_above() {
        let dir = tempfile::tempdir().unwrap();
        let synced = |path: &Path| {
            SYNCED.take();
            write(path, b"x").unwrap();
            SYNCED.take()
        };
        let at = |name: &str| dir.path().join(name);
        assert_eq!(synced(&at("x")), [dir.path()]);
        let mut made = synced(&at("a/b/x"));
        assert_eq!(made.pop().unwrap(), at("a/b"));
        assert_eq!(made, [at("a"), dir.path().to_owned()]);
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("result");
        write(&path, b"old").unwrap();
        let failed = write_with(&path, |w| {
            w.write_all(b"half of the new")?;
            Err(std::io::Error::other("disk full"))
        });
        assert!(failed.unwrap_err().to_string().contains("disk full"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_failed_write_is_told_in_words_without_the_temporary_name() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("result");
        // The disk is full in the middle of the file.
        let failed = write_with(&path, |w| {
            w.write_all(&[0; 1 << 16])?;
            Err(std::io::Error::from_raw_os_error(28))
        });
        let said = format!(
            "{}: cannot write: No space left on device; make room there, or name another place",
            path.display()
        );
        assert_eq!(failed.unwrap_err().to_string(), said);
        assert_eq!(reason(&std::io::Error::from_raw_os_error(13)), "Permission denied");
        assert!(
            reason(&std::io::Error::from_raw_os_error(27))
                .starts_with("File too large; the shell (ulimit -f)")
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_written_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        write(Path::new("/dev/null"), b"gone").unwrap();
        let error = write(Path::new("/dev/full"), b"too much").unwrap_err().to_string();
        assert!(error.starts_with("/dev/full: cannot write: No space left"), "{error}");
        for device in ["/dev/null", "/dev/full"] {
            assert!(std::fs::metadata(device).unwrap().file_type().is_char_device());
        }
    }

    #[test]
    fn missing_folders_are_made_but_not_by_asking() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("some/folder/x");
        check(&path).unwrap();
        assert!(!dir.path().join("some").exists());
        write(&path, b"there").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"there");
    }

    #[test]
    fn what_cannot_be_written_is_named_beforehand_in_the_same_words() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("file"), "").unwrap();
        let below = dir.path().join("file/x");
        let said = format!("{}: cannot write: Not a directory", below.display());
        assert_eq!(check(&below).unwrap_err().to_string(), said);
        assert!(
            write(&below, b"")
                .unwrap_err()
                .to_string()
                .starts_with(&format!("{}: cannot write: ", below.display()))
        );
        assert!(check(dir.path()).unwrap_err().to_string().contains("is a directory"));
    }
}
