//! What the user sees: results on standard output (text, or JSON where asked), progress and remarks on standard error.

use crate::error::Error;
use edof_storage::provenance::{Input, Provenance};
use edof_study::journal::Maker;
use edof_study::made::Made;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

/// In a pipe, a plain line of progress comes this often.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// A result and how it came to be, side by side.
#[derive(Serialize)]
struct Recorded<'a, T> {
    #[serde(flatten)]
    result: &'a T,
    provenance: Provenance,
}

/// The way to the user's eyes.
pub struct Ui {
    json: Option<PathBuf>,
    quiet: bool,
    provenance: Mutex<Provenance>,
    /// The command in full.
    command: String,
}

impl Ui {
    /// `json` is the value of `--json`: a file, or `-` for standard output.
    pub const fn new(json: Option<PathBuf>, quiet: bool, provenance: Provenance, command: String) -> Self {
        Self { json, quiet, provenance: Mutex::new(provenance), command }
    }

    /// The file that results go to as data, if they go to one.
    pub fn json_file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|_| !self.json_on_stdout())
    }

    /// Notes something that the results are made from.
    pub fn used(&self, input: Input) {
        let mut provenance = self.provenance.lock().unwrap_or_else(PoisonError::into_inner);
        if !provenance.inputs.contains(&input) {
            provenance.inputs.push(input);
        }
    }

    /// How the results came to be, with all inputs noted so far.
    pub fn provenance(&self) -> Provenance {
        self.provenance.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// How a page of this run was made, with the programs that measured its rows.
    pub fn made(&self, makers: Vec<Maker>) -> Made {
        Made { command: self.command.clone(), makers }
    }

    /// How a page was made whose every number this run measured itself.
    pub fn made_here(&self) -> Made {
        self.made(vec![Maker::Program(crate::provenance::program())])
    }

    /// A command as reports state it: with the program that ran it, where and on which day, as a shell's remark.
    pub fn signed(&self, command: &str) -> String {
        let Provenance { version, revision, host, .. } = self.provenance();
        let revision = revision.unwrap_or_else(|| "unknown".to_owned());
        format!("{command}  # edof {version}, revision {revision}, {}, {}", host.cpu, today())
    }

    /// Whether standard output belongs to JSON alone.
    fn json_on_stdout(&self) -> bool {
        self.json.as_deref() == Some(Path::new("-"))
    }

    /// A line of result for people; not shown where `--json` has standard output.
    ///
    /// # Errors
    /// When standard output cannot be written (a closed pipe ends the program quietly).
    pub fn say(&self, line: impl Display) -> Result<(), Error> {
        if !self.json_on_stdout() {
            let mut out = std::io::stdout().lock();
            writeln!(out, "{line}")?;
            out.flush()?;
        }
        Ok(())
    }

    /// A remark that is no result, such as a photograph skipped; on standard error.
    pub fn note(&self, line: impl Display) {
        last_line(&line.to_string());
    }

    /// The result as data, with its provenance: printed or written if `--json` was given, else nothing. Call it once a command.
    ///
    /// # Errors
    /// When the file or standard output cannot be written.
    pub fn json(&self, result: &impl Serialize) -> Result<(), Error> {
        let Some(path) = &self.json else { return Ok(()) };
        let text = serde_json::to_string_pretty(&Recorded { result, provenance: self.provenance() })? + "\n";
        if self.json_on_stdout() {
            let mut out = std::io::stdout().lock();
            out.write_all(text.as_bytes())?;
            out.flush()?;
        } else {
            edof_storage::atomic::write(path, text.as_bytes())?;
        }
        Ok(())
    }

    /// Progress of `total` steps: a bar on a terminal, a plain line now and then in a pipe.
    pub fn progress(&self, total: u64, what: impl Into<String>) -> Progress {
        let what = what.into();
        let terminal = std::io::stderr().is_terminal();
        let bar = if terminal && !self.quiet {
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
            let template = "{prefix} {wide_bar} {pos}/{len} {eta} {msg}";
            bar.set_style(
                ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
            );
            bar.set_prefix(what.clone());
            bar
        } else {
            ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden())
        };
        let plain =
            (!terminal && !self.quiet).then(|| Mutex::new(Plain { last: Instant::now(), first: None }));
        Progress { bar, what, plain }
    }
}

/// Progress of one piece of work; may be shared between threads. The bar goes away when it is dropped.
pub struct Progress {
    bar: ProgressBar,
    what: String,
    plain: Option<Mutex<Plain>>,
}

/// Progress in lines.
struct Plain {
    /// When the last one was written.
    last: Instant,
    /// When the first step was told of, and which it was: a job that goes on did those before it another time.
    first: Option<(Instant, u64)>,
}

impl Progress {
    /// Steps done in all.
    pub fn set(&self, position: u64) {
        self.bar.set_position(position);
        let Some(plain) = &self.plain else { return };
        let Ok(mut plain) = plain.lock() else { return };
        let (begun, first) = *plain.first.get_or_insert_with(|| (Instant::now(), position));
        if plain.last.elapsed() >= PLAIN_EVERY {
            plain.last = Instant::now();
            let message = self.bar.message();
            let gap = if message.is_empty() { "" } else { " " };
            let total = self.bar.length().unwrap_or(0);
            let left = left(begun.elapsed(), position.saturating_sub(first), total.saturating_sub(position));
            crate::ui::last_line(&format!("{}: {position}/{total}{left}{gap}{message}", self.what));
        }
    }

    /// Steps done of all, where nobody knew before how many there are.
    pub fn of(&self, position: u64, total: u64) {
        self.bar.set_length(total);
        self.set(position);
    }

    /// What is being done, or how well, beside the bar.
    pub fn message(&self, text: impl Into<String>) {
        self.bar.set_message(text.into());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// What is left of a job of equal steps, in words.
fn left(elapsed: Duration, done: u64, to_do: u64) -> String {
    if done == 0 || to_do == 0 {
        return String::new();
    }
    let seconds = elapsed.as_secs_f64() * to_do as f64 / done as f64;
    match seconds {
        0.0..90.0 => format!(", {seconds:.0} s left"),
        90.0..5400.0 => format!(", {:.0} min left", seconds / 60.0),
        _ => format!(", {:.1} h left", seconds / 3600.0),
    }
}

/// The day in UTC, as 2026-11-22.
fn today() -> String {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let [year, month, day] = civil(since.as_secs() / 86_400);
    format!("{year}-{month:02}-{day:02}")
}

/// Year, month and day of a number of days since 1970 (Hinnant, "chrono-compatible low-level date algorithms").
const fn civil(days: u64) -> [u64; 3] {
    // Years that begin in March have their leap day last.
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let march = (5 * of_year + 2) / 153;
    let month = if march < 10 { march + 3 } else { march - 9 };
    let next = if month <= 2 { 1 } else { 0 };
    [400 * era + year + next, month, of_year - (153 * march + 2) / 5 + 1]
}

/// A line on standard error; if nobody reads it, nothing is lost.
pub fn last_line(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_from_what_was_done() {
        let left = |seconds, done, to_do| left(Duration::from_secs(seconds), done, to_do);
        assert_eq!(left(10, 5, 20), ", 40 s left");
        assert_eq!(left(60, 1, 9), ", 9 min left");
        assert_eq!(left(600, 1, 12), ", 2.0 h left");
        assert_eq!((left(10, 0, 5), left(10, 5, 0)), (String::new(), String::new()));
    }

    #[test]
    fn days_have_their_dates() {
        let dates = [0, 59, 11_016, 19_782, 20_779].map(civil);
        assert_eq!(dates, [[1970, 1, 1], [1970, 3, 1], [2000, 2, 29], [2024, 2, 29], [2026, 11, 22]]);
    }
}
