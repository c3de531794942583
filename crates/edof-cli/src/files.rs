//! The files that a command reads and writes, held against each other before the work begins: no output may replace an
//! input, another output of the same command or a file of another kind, each must be writable, and what an earlier run took minutes
//! for stays unless the user says otherwise.

use crate::error::Error;
use crate::kind::Kind;
use crate::ui::Ui;
use crate::weights;
use edof_core::storage::atomic;
use edof_io::picture::{self, Format};
use std::path::{Path, PathBuf};

/// Whether results of an earlier run may be replaced: an option of every command that takes minutes.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Force {
    /// Replace results that are there already
    #[arg(long)]
    pub force: bool,
}

/// Everything that a command is going to read and write.
pub struct Files {
    read: Vec<PathBuf>,
    written: Vec<(String, PathBuf, Kind)>,
    /// How many of these must not be there yet.
    new: usize,
    /// How many of these may replace whatever is there.
    forced: usize,
    /// Folders of results.
    folders: Vec<(String, PathBuf)>,
}

impl Files {
    /// Begins with what every command may write: the file of `--json`.
    pub fn new(ui: &Ui) -> Self {
        let files = Self { read: vec![], written: vec![], new: 0, forced: 0, folders: vec![] };
        files.may_write("--json", ui.json_file())
    }

    /// A file that is read. What names no file, such as a preset, is no danger.
    pub fn reads(mut self, file: impl AsRef<Path>) -> Self {
        self.read.push(file.as_ref().to_owned());
        self
    }

    /// Files that are read.
    pub fn reads_all(self, files: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        files.into_iter().fold(self, Self::reads)
    }

    /// A folder whose pictures are read.
    pub fn reads_pictures_of(self, folder: impl AsRef<Path>) -> Self {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        self.reads_all(entries.map(|entry| entry.path()).filter(|file| Format::of_ending(file).is_some()))
    }

    /// A file that is written; `option` names it to the user.
    pub fn writes(self, option: &str, file: impl AsRef<Path>) -> Self {
        let kind = Kind::of(option, file.as_ref());
        self.writes_as(kind, option, file)
    }

    /// The same for a file of a kind that neither its option nor its name states.
    pub fn writes_as(mut self, kind: Kind, option: &str, file: impl AsRef<Path>) -> Self {
        self.written.push((option.to_owned(), file.as_ref().to_owned(), kind));
        self
    }

    /// A picture that is written: its ending must stand for a format.
    ///
    /// # Errors
    /// An ending that stands for none.
    pub fn writes_picture(self, option: &str, file: impl AsRef<Path>) -> Result<Self, Error> {
        picture::format_of(file.as_ref())?;
        Ok(self.writes(option, file))
    }

    /// A file that is written if it was asked for.
    pub fn may_write(self, option: &str, file: Option<impl AsRef<Path>>) -> Self {
        match file {
            Some(file) => self.writes(option, file),
            None => self,
        }
    }

    /// Files that are written into a folder, which is made if it does not exist.
    pub fn writes_into(
        mut self,
        option: &str,
        folder: &Path,
        names: impl IntoIterator<Item = impl AsRef<Path>>,
    ) -> Self {
        self.folders.push((option.to_owned(), folder.to_owned()));
        names.into_iter().fold(self, |files, name| files.writes(option, folder.join(name)))
    }

    /// Whatever was named to be written until now takes minutes to make: what an earlier run left there stays, unless `force`.
    pub const fn keeps(mut self, force: Force) -> Self {
        (self.new, self.forced) = if force.force { (0, self.written.len()) } else { (self.written.len(), 0) };
        self
    }

    /// To be called before anything is computed.
    ///
    /// # Errors
    /// An output that is also read, or that is two outputs at once, or that cannot be written, a result that is there already, or a file
    /// of another kind.
    pub fn check(self) -> Result<(), Error> {
        if let Some((option, folder)) = self.folders.iter().find(|(_, folder)| folder.is_file()) {
            return Err(Error::message(format!(
                "{option} {}: is a file, expected a folder",
                folder.display()
            )));
        }
        if let Some((option, file, _)) = self.written.iter().find(|(_, file, _)| is_named_as_folder(file)) {
            return Err(Error::message(format!(
                "{option} {}: is the name of a folder, expected a file's",
                file.display()
            )));
        }
        let read: Vec<(&PathBuf, PathBuf)> = self.read.iter().map(|file| (file, canonical(file))).collect();
        let mut seen: Vec<(&str, PathBuf)> = vec![];
        for (option, file, _) in &self.written {
            if atomic::is_device(file) {
                continue;
            }
            let shown = file.display();
            let place = canonical(file);
            if let Some((input, _)) = read.iter().find(|(_, other)| *other == place) {
                return Err(Error::message(format!(
                    "{option} {shown}: would replace {}, which the same command reads",
                    input.display()
                )));
            }
            if let Some((other, _)) = seen.iter().find(|(_, other)| *other == place) {
                return Err(Error::message(format!(
                    "{option} {shown}: is written by {other} too; each output needs a file of its own"
                )));
            }
            seen.push((option, place));
        }
        self.written[..self.new].iter().try_for_each(|(option, file, kind)| is_new(*kind, option, file))?;
        self.written[self.forced..].iter().try_for_each(|(option, file, kind)| is_of(*kind, option, file))?;
        self.written.iter().try_for_each(|(option, file, _)| {
            atomic::check(file).map_err(|e| Error::message(format!("{option} {e}")))
        })
    }
}

/// Rejects a result that is there already. An empty file holds nothing that could be lost.
fn is_new(kind: Kind, option: &str, file: &Path) -> Result<(), Error> {
    if atomic::is_device(file) || !std::fs::metadata(file).is_ok_and(|what| what.is_file() && what.len() > 0)
    {
        return Ok(());
    }
    let of_earlier_run = || match kind.refusal(file) {
        None => "a result of an earlier run".to_owned(),
        Some(content) => format!("{content} and not {kind}"),
    };
    let what = weights::in_words(file).unwrap_or_else(of_earlier_run);
    let shown = file.display();
    Err(Error::message(format!(
        "{option} {shown}: is there already, {what}; name another file, or --force replaces it"
    )))
}

/// Rejects a file that is there and is of another kind than what would replace it.
fn is_of(kind: Kind, option: &str, file: &Path) -> Result<(), Error> {
    let refusal = if atomic::is_device(file) { None } else { kind.refusal(file) };
    let Some(content) = refusal else { return Ok(()) };
    let shown = file.display();
    Err(Error::message(format!(
        "{option} {shown}: would replace {content}, and writes {kind}; name another file, or move this one away first"
    )))
}

/// One name for a file, whatever links lead to it; the file need not be there yet.
fn canonical(file: &Path) -> PathBuf {
    let file = &atomic::target(file).unwrap_or_else(|_| file.to_owned());
    file.canonicalize().unwrap_or_else(|_| match (file.parent(), file.file_name()) {
        (Some(folder), Some(name)) if folder.as_os_str().is_empty() => canonical(Path::new(".")).join(name),
        (Some(folder), Some(name)) => canonical(folder).join(name),
        _ => file.to_owned(),
    })
}

/// Whether a name that no folder has ends as those of folders do.
fn is_named_as_folder(file: &Path) -> bool {
    file.as_os_str().as_encoded_bytes().ends_with(b"/") && !file.is_dir()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files() -> Files {
        Files { read: vec![], written: vec![], new: 0, forced: 0, folders: vec![] }
    }

    #[test]
    fn an_output_is_known_by_any_of_its_names() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        std::fs::create_dir(at("folder")).unwrap();
        std::fs::write(at("input"), "kept").unwrap();
        std::os::unix::fs::symlink(at("input"), at("link")).unwrap();
        std::os::unix::fs::symlink(place.path(), at("folder/up")).unwrap();
        for name in ["input", "./input", "link", "folder/../input", "folder/up/input"] {
            let error = files().reads(at("input")).writes("--out", at(name)).check().unwrap_err().to_string();
            assert!(error.contains("would replace"), "{name}: {error}");
        }
        files().reads(at("input")).writes("--out", at("folder/input")).check().unwrap();
        let two = files().writes("--out", at("new")).writes("--json", at("folder/up/new"));
        assert!(two.check().unwrap_err().to_string().contains("is written by --out too"));
    }

    #[test]
    fn every_command_tells_what_it_reads_and_writes() {
        // A folder has the parts of one command: one of them names the files of all.
        fn sources(path: &Path) -> String {
            let within =
                |folder| std::fs::read_dir(folder).unwrap().map(|entry| sources(&entry.unwrap().path()));
            if path.is_dir() { within(path).collect() } else { std::fs::read_to_string(path).unwrap() }
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/commands");
        for entry in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
            let tells = sources(&entry).contains("Files::new(ui)");
            assert!(tells || entry == folder.join("mod.rs"), "{}", entry.display());
        }
    }

    #[test]
    fn a_file_may_not_have_the_name_of_a_folder() {
        let error = files().writes("--out", "nothere/").check().unwrap_err().to_string();
        assert_eq!(error, "--out nothere/: is the name of a folder, expected a file's");
    }

    #[test]
    fn a_device_may_be_written_twice() {
        files().writes("--out", "/dev/null").writes("--json", "/dev/null").check().unwrap();
    }
}
