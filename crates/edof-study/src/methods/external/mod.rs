//! Anybody's program as a method: a command that reads a raw frame from a file and writes a picture to another.

mod process;

use edof_core::storage::digest::sha256;
use edof_core::{ColourFrame, Noise, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use edof_io::{photo, raw};
use process::{Served, run_once};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Where a command that is run for every frame has the raw frame's file, and where the picture's.
pub const PLACES: [&str; 2] = ["{raw}", "{out}"];
/// Where such a command may have the frame's depth, ψ in radians, and its noise as `--noise` takes it.
pub const CASE: [&str; 2] = ["{psi}", "{noise}"];
/// Where a command that is started once has the file from which it reads a line for every frame.
pub const LIST: &str = "{list}";
/// How a command is written.
pub const FORMS: &str = "[NAME=]CMD {raw} {out} [{psi}] [{noise}], or [NAME=]CMD {list}";

/// A command and how long it may take.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExternalSettings {
    /// Name of the method, without `external-`.
    label: String,
    /// The command, for `sh`. `{raw}` is a 16-bit PNG of Bayer values, `{out}` the file to write: a PNG of light, 8 or 16 bits a colour, as
    /// large as the raw frame.
    pub command: String,
    /// Seconds after which a run is ended: a frame's, or the start's of a command with `{list}`.
    pub seconds: u64,
}

/// A command that cannot be a method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExternalError {
    /// The command line names no file.
    #[error("external command '{command}': contains no {place}; write it as in '{FORMS}'")]
    Place {
        /// The command.
        command: String,
        /// Missing items.
        place: &'static str,
    },
    /// The command names the files of one frame, and the list of all.
    #[error(
        "external command '{command}': {place} does not go with {LIST}, whose lines have it; write it as in '{FORMS}'"
    )]
    Both {
        /// The command.
        command: String,
        /// What the lines of the list have.
        place: &'static str,
    },
    /// The command line names no program.
    #[error("external command '{0}': names no program; write it as in '{FORMS}'")]
    Program(String),
}

/// `NAME=CMD` as name and command.
fn labelled(text: &str) -> Option<(&str, &str)> {
    let (name, command) = text.split_once('=')?;
    let is_name = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    (!name.is_empty() && name.chars().all(is_name)).then_some((name, command))
}

impl ExternalSettings {
    /// A command that has both of [`PLACES`], or [`LIST`]; before it may stand a name and `=`. Without one the program's file names it.
    ///
    /// # Errors
    /// [`ExternalError`].
    pub fn new(text: &str, seconds: u64) -> Result<Self, ExternalError> {
        let (label, command) = labelled(text).unzip();
        let command = command.unwrap_or(text).to_owned();
        if command.contains(LIST) {
            if let Some(place) = PLACES.into_iter().chain(CASE).find(|place| command.contains(place)) {
                return Err(ExternalError::Both { command, place });
            }
        } else if let Some(place) = PLACES.into_iter().find(|place| !command.contains(place)) {
            return Err(ExternalError::Place { command, place });
        }
        let program = command.split_whitespace().next().unwrap_or(LIST);
        if PLACES.into_iter().chain(CASE).chain([LIST]).any(|place| place == program) {
            return Err(ExternalError::Program(command));
        }
        let file = || Path::new(program).file_name().unwrap_or_default().to_string_lossy().into_owned();
        let label = label.map_or_else(file, str::to_owned);
        Ok(Self { label, command, seconds })
    }

    /// Name of the method.
    #[must_use]
    pub fn name(&self) -> String {
        format!("external-{}", self.label)
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

/// A program with its process, if it has one for all frames.
#[derive(Debug, Clone)]
pub struct Program {
    /// The command.
    pub settings: ExternalSettings,
    /// Started with the first frame.
    served: Arc<Mutex<Option<Served>>>,
}

impl Program {
    /// A program that has not been started.
    #[must_use]
    pub fn new(settings: ExternalSettings) -> Self {
        Self { settings, served: Arc::default() }
    }
}

/// A program behind a lens at a depth under a noise.
pub struct ExternalReconstructor {
    name: String,
    program: Program,
    psi: f64,
    noise: Noise,
}

impl ExternalReconstructor {
    /// Tells the program the depth ψ, in radians, and the noise of every frame.
    #[must_use]
    pub fn new(program: Program, psi: f64, noise: Noise) -> Self {
        Self { name: program.settings.name(), program, psi, noise }
    }

    fn error(&self, reason: impl std::fmt::Display) -> ReconstructError {
        ReconstructError::Method { method: self.name.clone(), reason: reason.to_string() }
    }

    /// Has the picture of a raw frame written; seconds that it took.
    fn run(&self, raw: &str, out: &str) -> Result<f64, String> {
        let ExternalSettings { command, seconds, .. } = &self.program.settings;
        let limit = Duration::from_secs(*seconds);
        let [psi, noise] = [self.psi.to_string(), self.noise.to_string()];
        if command.contains(LIST) {
            // A process that another thread's panic left is as good as any.
            let mut served = self.program.served.lock().unwrap_or_else(PoisonError::into_inner);
            let mut process = match served.take() {
                Some(process) => process,
                None => Served::start(command, limit)?,
            };
            // One that failed is not kept.
            let took = process.picture([raw, out, &psi, &noise], limit)?;
            *served = Some(process);
            return Ok(took);
        }
        let texts = [(PLACES[0], raw), (PLACES[1], out), (CASE[0], &psi), (CASE[1], &noise)];
        let text = texts.into_iter().fold(command.clone(), |text, (place, value)| text.replace(place, value));
        let start = Instant::now();
        run_once(command, &text, limit)?;
        Ok(start.elapsed().as_secs_f64())
    }

    fn picture(&self, out: &Path, size: (usize, usize)) -> Result<ColourFrame, ReconstructError> {
        if !out.exists() {
            let place = if self.program.settings.command.contains(LIST) { "picture" } else { PLACES[1] };
            return Err(self.error(format!("'{}' wrote no {place}", self.program.settings.command)));
        }
        let frame = photo::load_found(out).map_err(|e| self.error(e))?;
        if frame.size() == size {
            return Ok(frame);
        }
        let ((height, width), (own_height, own_width)) = (size, frame.size());
        Err(self.error(format!(
            "wrote a picture of {own_width}x{own_height} pixels: must be {width}x{height} as the raw frame"
        )))
    }
}

impl Reconstructor for ExternalReconstructor {
    fn name(&self) -> &str {
        &self.name
    }

    /// `seconds` are those of the command with its files; its start is counted where it is started for every frame.
    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let folder = tempfile::tempdir().map_err(|e| self.error(e))?;
        let [input, output] = ["raw.png", "out.png"].map(|name| folder.path().join(name));
        let Some((from, to)) = input.to_str().zip(output.to_str()) else {
            return Err(self.error("the folder of temporary files has a name that is no text; set TMPDIR"));
        };
        raw::save(&input, raw).map_err(|e| self.error(e))?;
        let seconds = self.run(from, to).map_err(|e| self.error(e))?;
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

    fn program(command: &str, seconds: u64) -> ExternalReconstructor {
        let program = Program::new(ExternalSettings::new(command, seconds).unwrap());
        ExternalReconstructor::new(program, 2.5, Noise::Gaussian { sigma: 0.01 })
    }

    fn run(command: &str, seconds: u64) -> Result<Reconstruction, ReconstructError> {
        program(command, seconds).reconstruct(&raw())
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
            "external-sleep: 'sleep 60 | cat; : {raw} {out}' took more than 1 second; --external-seconds allows more"
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
            format!("external command 'mine {{raw}}': contains no {{out}}; write it as in '{FORMS}'")
        );
        assert!(error("{raw} {out}").contains("names no program"));
        assert!(error("{list}").contains("names no program"));
        assert!(error("mine {list} {psi}").contains("{psi} does not go with {list}"));
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

    #[test]
    fn a_name_before_the_command_is_that_of_the_method() {
        let name = |text| ExternalSettings::new(text, 1).unwrap().name();
        assert_eq!(name("unet-2=python mine.py {raw} {out}"), "external-unet-2");
        assert_eq!(name("a/mine --level=2 {raw} {out}"), "external-mine");
    }

    #[test]
    fn a_command_is_told_depth_and_noise() {
        let folder = tempfile::tempdir().unwrap();
        let notes = folder.path().join("notes");
        run(&format!("echo {{psi}} {{noise}} > {}; cp {{raw}} {{out}}", notes.display()), 60).unwrap();
        assert_eq!(std::fs::read_to_string(notes).unwrap(), "2.5 0.01\n");
    }

    /// A program that copies each frame, notes its start and its lines, and fails on the third frame where it is told to.
    fn copies(folder: &Path, third: &str) -> String {
        let (script, notes) = (folder.join("mine.sh"), folder.join("notes"));
        let text = format!(
            "echo start >> {0}; echo loading; echo ready; count=0\nwhile IFS='\t' read -r raw out psi noise; do\n\
             count=$((count + 1)); [ $count != 3 ] || {third}\n\
             echo $psi $noise >> {0}; cp $raw $out; echo progress; echo $out\ndone < $1\n",
            notes.display()
        );
        std::fs::write(&script, text).unwrap();
        format!("mine=sh {} {{list}}", script.display())
    }

    #[test]
    fn a_program_with_a_list_is_started_once_for_all_frames() {
        let folder = tempfile::tempdir().unwrap();
        let one = program(&copies(folder.path(), ":"), 60);
        let other = ExternalReconstructor::new(one.program.clone(), 0.0, Noise::None);
        for reconstructor in [&one, &one, &other, &one] {
            assert_eq!(reconstructor.reconstruct(&raw()).unwrap().frame.size(), (16, 24));
        }
        let notes = std::fs::read_to_string(folder.path().join("notes")).unwrap();
        assert_eq!(notes, "start\n2.5 0.01\n2.5 0.01\n0 none\n2.5 0.01\n");
    }

    #[test]
    fn a_program_with_a_list_that_ends_or_waits_is_named() {
        let error = |third, seconds| {
            let folder = tempfile::tempdir().unwrap();
            let program = program(&copies(folder.path(), third), seconds);
            (0..3).find_map(|_| program.reconstruct(&raw()).err()).unwrap().to_string()
        };
        let ends = error("{ echo no memory >&2; exit 4; }", 60);
        assert!(ends.ends_with("{list}' ended with exit status: 4: no memory"), "{ends}");
        let waits = error("sleep 60", 1);
        assert!(waits.contains("did not print the name of the picture within 1 second"), "{waits}");
        let silent = run("sleep 60 < {list}", 1).unwrap_err().to_string();
        assert!(silent.contains("did not print 'ready' within 1 second"), "{silent}");
    }
}
