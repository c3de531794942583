//! Options that studies share, and what they lead to.

use crate::error::Error;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::ui::Ui;
use edof_core::storage::input;
use edof_core::storage::provenance::Input;
use edof_core::words::count;
use edof_io::photos::{self, Photo, Selection};
use edof_optics::psf::Settings;
use edof_study::experiment::{self, Experiment, RunError};
use edof_study::journal::{Header, Journal, Line, Maker, Mixing, Progress, Shard};
use edof_study::made::{Made, machines};
use edof_study::methods::spec::MethodSpec;
use edof_study::report::Report;
use edof_study::study_report::StudyReport;
use std::path::PathBuf;

/// Where photographs lie.
#[derive(clap::Args)]
pub struct Folder {
    /// Folder of numbered photographs [default: $EDOF_KODAK, else shared/data/kodak beside the project]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
}

impl Folder {
    /// The folder.
    ///
    /// # Errors
    /// None given and none found.
    pub fn path(&self) -> Result<PathBuf, Error> {
        Ok(self.images.clone().map_or_else(photos::default_folder, Ok)?)
    }

    /// Photographs of a selection, and a line for each that was skipped.
    ///
    /// # Errors
    /// A text that selects nothing, a folder that cannot be read, nothing in it.
    pub fn load(&self, selection: &str, ui: &Ui) -> Result<(Vec<Photo>, Vec<String>), Error> {
        let (mut selection, folder): (Selection, _) = (selection.parse()?, self.path()?);
        let mut notes = vec![];
        if selection == Selection::Test && photos::has_no_numbers(&folder) {
            notes.push(format!(
                "{}: no file has a number, by which photographs for tests are chosen; all are taken, as by --photos all",
                folder.display()
            ));
            selection = Selection::All;
        }
        let photos::Chosen { photos, skipped, remarks } = photos::load(&folder, &selection)?;
        photos.iter().for_each(|photo| ui.used(Input::photograph(&photo.name, &photo.frame)));
        notes.extend(remarks);
        notes.extend(skipped.iter().map(|why| format!("photo skipped: {why}")));
        if !skipped.is_empty() {
            notes.push(format!(
                "{} of {} skipped",
                skipped.len(),
                count(skipped.len() + photos.len(), "photo")
            ));
        }
        Ok((photos, notes))
    }
}

/// Which photographs a study is of.
#[derive(clap::Args)]
pub struct Photographs {
    #[command(flatten)]
    pub folder: Folder,

    /// Photographs: test (every third number; all, if no file has a number), train (the others), all, or numbers as in 3,6
    #[arg(long, default_value = "test")]
    pub photos: String,
}

impl Photographs {
    /// As [`Folder::load`].
    ///
    /// # Errors
    /// As [`Folder::load`].
    pub fn load(&self, ui: &Ui) -> Result<(Vec<Photo>, Vec<String>), Error> {
        self.folder.load(&self.photos, ui)
    }
}

/// How exactly kernels are computed.
#[derive(clap::Args)]
pub struct Kernels {
    /// Whole kernels: no cut by energy
    #[arg(long)]
    pub exact: bool,
}

impl Kernels {
    /// The same as settings.
    pub fn settings(&self) -> Settings {
        if self.exact { Settings::exact() } else { Settings::default() }
    }
}

/// Anybody's programs among the methods.
#[derive(clap::Args)]
pub struct Externals {
    /// Your program as a further method with its own rows; repeatable. {raw} is a 16-bit PNG of Bayer values, {out}
    /// the PNG to write: linear light, 8 or 16 bits per colour, as large as the raw frame; {psi} and {noise} may tell
    /// it depth and noise. With {list} instead, one process makes all pictures (docs/external.md). NAME= names it
    #[arg(long, value_name = "'[NAME=]CMD {raw} {out}'")]
    external: Vec<String>,

    /// Seconds after which a run of this program is ended
    #[arg(long, default_value_t = 600, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..))]
    external_seconds: u64,
}

impl Externals {
    /// Each as a method.
    ///
    /// # Errors
    /// A command that does not say where its files are, or one that is given twice.
    pub fn methods(&self) -> Result<Vec<MethodSpec>, Error> {
        let all = self.external.iter().map(|command| MethodSpec::external(command, self.external_seconds));
        let all = all.collect::<Result<Vec<_>, _>>()?;
        for (place, method) in all.iter().enumerate() {
            if all[..place].iter().any(|other| other.method() == method.method()) {
                return Err(Error::message(format!(
                    "--external: two programs are called {}, which tables cannot distinguish; write NAME= before one",
                    method.method()
                )));
            }
        }
        Ok(all)
    }
}

/// Where rows are kept, and which of them are measured.
#[derive(clap::Args)]
pub struct Rows {
    /// Result file (JSON Lines); an existing file is resumed
    #[arg(long, value_name = "FILE")]
    pub rows: PathBuf,

    #[command(flatten)]
    pub part: Part,
}

impl Rows {
    /// Rejects a file of something else, before anything is computed.
    ///
    /// # Errors
    /// As [`rows_of`].
    pub fn check<R: Line>(&self) -> Result<(), Error> {
        rows_of::<R>(Some(&self.rows))
    }
}

/// Rejects an existing file without rows of a study.
///
/// # Errors
/// A file that cannot be read, or that is of something else.
fn rows_of<R: Line>(file: Option<&PathBuf>) -> Result<(), Error> {
    if let Some(file) = file.filter(|file| file.exists()) {
        input::check(file).map_err(|e| Error::message(format!("--rows {}: {e}", file.display())))?;
    }
    let Some(file) = file.filter(|file| std::fs::metadata(file).is_ok_and(|what| what.len() > 0)) else {
        return Ok(());
    };
    let found = Header::read(file)?.study;
    if found == R::STUDY {
        return Ok(());
    }
    Err(Error::message(format!(
        "--rows {}: holds rows of edof study {found}, not of {}; name another file",
        file.display(),
        R::STUDY
    )))
}

/// The same for studies that are short enough to do without a file.
#[derive(clap::Args)]
pub struct MayKeepRows {
    /// Result file (JSON Lines); an existing file is resumed [default: none]
    #[arg(long, value_name = "FILE")]
    pub rows: Option<PathBuf>,

    #[command(flatten)]
    pub part: Part,

    #[command(flatten)]
    force: Force,
}

impl MayKeepRows {
    /// Rejects a file of something else, before anything is computed.
    ///
    /// # Errors
    /// As [`rows_of`].
    pub fn check<R: Line>(&self) -> Result<(), Error> {
        rows_of::<R>(self.rows.as_ref())
    }

    /// Adds the rows to what a command writes. Where they are kept, all other outputs are made of them in a moment and may be replaced.
    pub fn of(&self, files: Files) -> Files {
        match &self.rows {
            Some(rows) => files.writes("--rows", rows),
            None => files.keeps(self.force),
        }
    }
}

/// Which of a study's rows, and which rows that are there stay.
#[derive(clap::Args)]
pub struct Part {
    /// Part of the study, as in 2/8 for the second of eight; edof study merge merges the files of all parts
    #[arg(long, default_value_t = Shard::WHOLE, requires = "rows", value_name = "I/N")]
    pub shard: Shard,

    /// Keep rows that a program of another revision or compiler measured; the tables name every revision
    #[arg(long, requires = "rows")]
    any_revision: bool,
}

impl Part {
    fn mixing(&self) -> Mixing {
        Mixing { any_revision: self.any_revision, any_machine: false }
    }
}

/// Measures what a file of rows does not hold yet, shows how far it is, and stops at Ctrl-C; without a file rows last as long as the
/// program.
///
/// # Errors
/// A file of something else, rows of another machine or revision, or a file that another process adds to; those of the experiment; or
/// that it was interrupted.
pub fn measured<E: Experiment>(
    experiment: &mut E,
    rows: Option<&PathBuf>,
    part: &Part,
    ui: &Ui,
) -> Result<Journal<E::Row>, Error>
where
    E::Error: std::error::Error + Send + Sync + 'static,
{
    let header = Header::of::<E::Row>(crate::provenance::program());
    let mut journal = match rows {
        Some(path) => Journal::open(path, header, part.mixing())?,
        None => Journal::in_memory(header),
    };
    journal.notes().iter().for_each(|note| ui.note(note));
    let bar = ui.progress(1, "rows");
    let kept = |p: &Progress| {
        let file = rows?.display();
        Some(format!("{file}: {} of {} rows are kept; the same command continues", p.done, p.of))
    };
    let done = experiment::run(experiment, part.shard, &mut journal, |p: Progress| {
        interrupt::keeps(kept(&p));
        bar.message(p.last);
        bar.of(p.done as u64, p.of as u64);
        interrupt::flow()
    });
    interrupt::check()?;
    interrupt::keeps(None);
    match done {
        Ok(()) => Ok(journal),
        Err(RunError::Experiment(error)) => Err(error.into()),
        Err(RunError::Journal(error)) => Err(error.into()),
        Err(RunError::Stopped) => Err(Error::Interrupted),
    }
}

/// Tables, reports and data of a file of rows.
///
/// # Errors
/// Rows that no study gave, a file that cannot be written.
pub fn tell<T: StudyReport>(journal: &Journal<T::Row>, outputs: &Outputs, ui: &Ui) -> Result<(), Error> {
    let (rows, makers) = (journal.rows(), journal.makers());
    let told = T::new(&rows, machines(&makers))?;
    let remarks = Made::remarks(&makers, &Maker::Program(crate::provenance::program()));
    let made = ui.made(makers, journal.file());
    let report = || Ok(told.report(&(ui.signed(&ui.provenance().command) + &remarks)));
    outputs.write(|| told.to_markdown(&made), report, || T::csv(&rows))?;
    ui.say(told.to_text())?;
    ui.json(&told)
}

/// What a study is written to besides the terminal and `--json`.
#[derive(clap::Args)]
pub struct Outputs {
    /// Also write the tables as Markdown
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,

    /// Also write an HTML report with plots
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Also write every row as comma-separated values
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

impl Outputs {
    /// Adds these to what a command writes.
    pub fn of(&self, files: Files) -> Files {
        let files = files.may_write("--report", self.report.as_ref());
        files.may_write("--markdown", self.markdown.as_ref()).may_write("--csv", self.csv.as_ref())
    }

    /// Writes what was asked for.
    ///
    /// # Errors
    /// A report whose pictures cannot be encoded, a file that cannot be written.
    pub fn write(
        &self,
        markdown: impl FnOnce() -> String,
        report: impl FnOnce() -> Result<Report, Error>,
        csv: impl FnOnce() -> String,
    ) -> Result<(), Error> {
        if let Some(path) = &self.markdown {
            edof_core::storage::atomic::write(path, markdown().as_bytes())?;
        }
        if let Some(path) = &self.report {
            report()?.save(path)?;
        }
        if let Some(path) = &self.csv {
            edof_core::storage::atomic::write(path, csv().as_bytes())?;
        }
        Ok(())
    }
}
