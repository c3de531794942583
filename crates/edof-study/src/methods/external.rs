//! Anybody's program as a method: a command that reads a raw frame from a file and writes a picture to another.

use edof_core::storage::atomic::reason;
use edof_core::storage::digest::sha256;
use edof_core::{ColourFrame, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use edof_io::{photo, raw};
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Where a command has the raw frame's file, and where the picture's.
pub const PLACES: [&str; 2] = ["{raw}", "{out}"];

/// A command and how long it may take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExternalSettings {
    /// The command, for `sh`. `{raw}` is a 16-bit PNG of Bayer values, `{out}` the file to write: a PNG of light, 8 or 16 bits a colour, as
    /// large as the raw frame.
    pub command: String,
    /// Seconds after which a run is ended.
    pub seconds: u64,
}

/// A command that cannot be a method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExternalError {
    /// The command line names no file.
    #[error("external command '{command}': contains no {place}; write it as in 'CMD {{raw}} {{out}}'")]
    Place {
        /// The command.
        command: String,
        /// Missing items.
        place: &'static str,
    },
    /// The command line names no program.
    #[error("external command '{0}': names no program; give it as in 'CMD {{raw}} {{out}}'")]
    Program(String),
}

impl ExternalSettings {
    /// A command that has both of [`PLACES`].
    ///
    /// # Errors
    /// [`ExternalError`].
    pub fn new(command: &str, seconds: u64) -> Result<Self, ExternalError> {
        let command = command.to_owned();
        match PLACES.into_iter().find(|place| !command.contains(place)) {
            Some(place) => Err(ExternalError::Place { command, place }),
            None if PLACES.contains(&command.split_whitespace().next().unwrap_or(PLACES[0])) => {
                Err(ExternalError::Program(command))
            }
            None => Ok(Self { command, seconds }),
        }
    }

    /// Name of the method: that of the program's file.
    #[must_use]
    pub fn name(&self) -> String {
        let program = self.command.split_whitespace().next().unwrap_or_default();
        let file = Path::new(program).file_name().map(|name| name.to_string_lossy().into_owned());
        format!("external-{}", file.unwrap_or_default())
    }

    /// SHA-256 of the command and of all files that it names.
    #[must_use]
    pub fn sha256(&self) -> String {
        let files = self.command.split_whitespace().filter_map(|word| {
            let path = Path::new(word.trim_matches(['\'', '"']));
            // Anybody who opens a pipe may wait for ever.
            if path.is_file() { std::fs::read(path).ok() } else { None }
        });
        let mut all = vec![sha256(self.command.as_bytes())];
        all.extend(files.map(|bytes| sha256(&bytes)));
        sha256(all.join("\n").as_bytes())
    }
}

/// A program that is run on every frame.
pub struct ExternalReconstructor {
    name: String,
    settings: ExternalSettings,
}

impl ExternalReconstructor {
    /// Under its own name.
    #[must_use]
    pub fn new(settings: ExternalSettings) -> Self {
        Self { name: settings.name(), settings }
    }

    fn refuse(&self, reason: impl std::fmt::Display) -> ReconstructError {
        ReconstructError::Method { method: self.name.clone(), reason: reason.to_string() }
    }

    /// Runs the command in a folder of its own.
    fn run(&self, folder: &Path, raw: &Path, out: &Path) -> Result<(), ReconstructError> {
        let Some((raw, out)) = raw.to_str().zip(out.to_str()) else {
            return Err(self.refuse("the folder of temporary files has a name that is no text; set TMPDIR"));
        };
        let command = self.settings.command.replace(PLACES[0], raw).replace(PLACES[1], out);
        let told = folder.join("stderr");
        let file = File::create(&told).map_err(|e| self.refuse(e))?;
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(&command).stdin(Stdio::null()).stdout(Stdio::null()).stderr(file);
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut shell, 0);
        let mut child = shell.spawn().map_err(|e| self.refuse(format!("cannot run sh: {}", reason(&e))))?;
        let status =
            wait(&mut child, Duration::from_secs(self.settings.seconds)).map_err(|e| self.refuse(e))?;
        match status {
            Some(status) if status.success() => Ok(()),
            Some(status) => {
                let said = std::fs::read_to_string(&told).unwrap_or_default();
                let last = said.lines().rev().find(|line| !line.trim().is_empty());
                let last = last.map(|line| format!(": {}", line.trim())).unwrap_or_default();
                Err(self.refuse(format!("'{}' ended with {status}{last}", self.settings.command)))
            }
            None => Err(self.refuse(format!(
                "'{}' took more than {} seconds; --external-seconds allows more",
                self.settings.command, self.settings.seconds
            ))),
        }
    }

    fn picture(&self, out: &Path, size: (usize, usize)) -> Result<ColourFrame, ReconstructError> {
        if !out.exists() {
            return Err(self.refuse(format!("'{}' wrote no {}", self.settings.command, PLACES[1])));
        }
        let frame = photo::load_found(out).map_err(|e| self.refuse(e))?;
        if frame.size() == size {
            return Ok(frame);
        }
        let ((height, width), (own_height, own_width)) = (size, frame.size());
        Err(self.refuse(format!(
            "wrote a picture of {own_width}x{own_height} pixels: must be {width}x{height} as the raw frame"
        )))
    }
}

/// The status of a process that ended in time. One that did not is ended, and so is all that it started.
fn wait(child: &mut Child, limit: Duration) -> std::io::Result<Option<ExitStatus>> {
    let start = Instant::now();
    let mut pause = Duration::from_millis(1);
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed() >= limit {
            #[cfg(unix)]
            let _ = Command::new("sh").arg("-c").arg(format!("kill -KILL -{}", child.id())).status();
            let _ = child.kill();
            child.wait()?;
            return Ok(None);
        }
        std::thread::sleep(pause);
        pause = (2 * pause).min(Duration::from_millis(50));
    }
}

impl Reconstructor for ExternalReconstructor {
    fn name(&self) -> &str {
        &self.name
    }

    /// `seconds` are those of the command, its start and its files included.
    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let folder = tempfile::tempdir().map_err(|e| self.refuse(e))?;
        let [input, output] = ["raw.png", "out.png"].map(|name| folder.path().join(name));
        raw::save(&input, raw).map_err(|e| self.refuse(e))?;
        let start = Instant::now();
        self.run(folder.path(), &input, &output)?;
        let seconds = start.elapsed().as_secs_f64();
        let frame = self.picture(&output, raw.size())?;
        Ok(Reconstruction { frame, seconds, multiplications: None, counters: None, iterations: None })
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use edof_core::CfaPhase;

    fn raw() -> RawFrame {
        RawFrame::from_values(ndarray::Array2::from_elem((16, 24), 900), 12, CfaPhase::Rggb).unwrap()
    }

    fn run(command: &str, seconds: u64) -> Result<Reconstruction, ReconstructError> {
        ExternalReconstructor::new(ExternalSettings::new(command, seconds).unwrap()).reconstruct(&raw())
    }

    #[test]
    fn a_program_gets_the_frame_and_its_picture_is_the_result() {
        // The raw frame is a grey picture of its size.
        let done = run("cp {raw} {out}", 60).unwrap();
        assert_eq!(done.frame.size(), (16, 24));
        assert!(
            done.frame.planes.iter().all(|v| (v - 900.0 / 4095.0).abs() < 1e-3),
            "{:?}",
            done.frame.planes[(0, 0, 0)]
        );
        assert!(done.seconds > 0.0);
    }

    #[test]
    fn what_goes_wrong_says_which_command_and_why() {
        let error = |command, seconds| run(command, seconds).unwrap_err().to_string();
        assert_eq!(
            error("echo of no use >&2; false {raw} {out}", 60),
            "external-echo: 'echo of no use >&2; false {raw} {out}' ended with exit status: 1: of no use"
        );
        assert_eq!(error("true {raw} {out}", 60), "external-true: 'true {raw} {out}' wrote no {out}");
        let slow = Instant::now();
        assert_eq!(
            error("sleep 60 | cat; : {raw} {out}", 1),
            "external-sleep: 'sleep 60 | cat; : {raw} {out}' took more than 1 seconds; --external-seconds allows more"
        );
        assert!(slow.elapsed() < Duration::from_secs(20), "what it started has ended, too");
        assert!(error("echo {raw} > {out}", 60).contains("out.png"), "{}", error("echo {raw} > {out}", 60));
        let folder = tempfile::tempdir().unwrap();
        let other = folder.path().join("other.png");
        photo::save(&other, &ColourFrame::zeros(8, 8), 8).unwrap();
        assert_eq!(
            error(&format!("cp {} {{out}}; : {{raw}}", other.display()), 60),
            "external-cp: wrote a picture of 8x8 pixels: must be 24x16 as the raw frame"
        );
    }

    #[test]
    fn a_command_that_names_no_files_or_no_program_is_rejected() {
        let error = |command| ExternalSettings::new(command, 1).unwrap_err().to_string();
        assert_eq!(
            error("mine {raw}"),
            "external command 'mine {raw}': contains no {out}; write it as in 'CMD {raw} {out}'"
        );
        assert!(error("{raw} {out}").contains("names no program"));
    }

    #[test]
    fn another_program_of_the_same_name_has_another_hash() {
        let folder = tempfile::tempdir().unwrap();
        let script = folder.path().join("mine.sh");
        let settings = ExternalSettings::new(&format!("sh {} {{raw}} {{out}}", script.display()), 1).unwrap();
        let before = settings.sha256();
        std::fs::write(&script, "cp $1 $2").unwrap();
        assert_ne!(settings.sha256(), before);
    }
}
