//! What the user sees: results on standard output (text, or JSON where asked), progress and remarks on standard error.

use crate::error::Error;
use edof_core::storage::provenance::{Input, Provenance};
use edof_study::journal::{Maker, RowsFile};
use edof_study::made::Made;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde::Serialize;
use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

/// In a pipe, a plain line of progress comes this often; the first one, from which the time that is left is known, comes sooner.
const PLAIN_EVERY: Duration = Duration::from_secs(10);
const FIRST_PLAIN: Duration = Duration::from_secs(2);
/// Lines of JSON come this often, besides the first and the last of a piece of work.
const DATA_EVERY: Duration = Duration::from_secs(1);

/// Format of progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum ProgressAs {
    /// A bar on a terminal, a line now and then in a pipe
    Text,
    /// A line of JSON at each second, and remarks and a failure as such lines, too
    Json,
}

/// Whether standard error has lines of JSON alone.
static DATA: AtomicBool = AtomicBool::new(false);

/// A result and how it was made, side by side.
#[derive(Serialize)]
struct Recorded<'a, T> {
    #[serde(flatten)]
    result: &'a T,
    provenance: Provenance,
}

/// Prints a text at once; a closed pipe is known by the kind of the error.
fn print(text: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let printed = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    printed.map_err(|e| std::io::Error::new(e.kind(), format!("standard output: cannot write: {e}")))
}

/// The way to the user's eyes.
pub struct Ui {
    json: Option<PathBuf>,
    quiet: bool,
    provenance: Mutex<Provenance>,
    /// The command in full.
    command: String,
    /// Whether results went out as data.
    told: AtomicBool,
    /// The file that lines of data go to, if they go to one.
    lines: Mutex<Option<std::fs::File>>,
    begun: Instant,
}

impl Ui {
    /// `json` is the value of `--json`: a file, or `-` for standard output.
    pub fn new(
        json: Option<PathBuf>,
        quiet: bool,
        progress: ProgressAs,
        provenance: Provenance,
        command: String,
    ) -> Self {
        DATA.store(progress == ProgressAs::Json, Ordering::Relaxed);
        let (told, lines) = (AtomicBool::new(false), Mutex::new(None));
        Self { json, quiet, provenance: Mutex::new(provenance), command, told, lines, begun: Instant::now() }
    }

    /// The file that results go to as data, if they go to one.
    pub fn json_file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|_| !self.json_has_stdout())
    }

    /// Notes something that the results are made from.
    pub fn used(&self, input: Input) {
        let mut provenance = self.provenance.lock().unwrap_or_else(PoisonError::into_inner);
        if !provenance.inputs.contains(&input) {
            provenance.inputs.push(input);
        }
    }

    /// How the results was made, with all inputs noted so far.
    pub fn provenance(&self) -> Provenance {
        self.provenance.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// How a page of this run was made, with the programs that measured its rows and the file that holds them.
    pub fn made(&self, makers: Vec<Maker>, rows: Option<RowsFile>) -> Made {
        Made { command: self.command.clone(), makers, rows }
    }

    /// How a page was made whose every number this run measured itself.
    pub fn made_here(&self) -> Made {
        self.made(vec![Maker::Program(crate::provenance::program())], None)
    }

    /// A command as reports state it: with the program that ran it, where and on which day, as a shell's remark.
    pub fn signed(&self, command: &str) -> String {
        let Provenance { version, revision, host, .. } = self.provenance();
        let revision = revision.unwrap_or_else(|| "unknown".to_owned());
        format!("{command}  # edof {version}, revision {revision}, {}, {}", host.cpu, today())
    }

    /// Whether standard output belongs to JSON alone.
    pub fn json_has_stdout(&self) -> bool {
        self.json.as_deref() == Some(Path::new("-"))
    }

    /// A line of result for people; not shown where `--json` has standard output.
    ///
    /// # Errors
    /// When standard output cannot be written (a closed pipe ends the program quietly).
    pub fn say(&self, line: impl Display) -> Result<(), Error> {
        if !self.json_has_stdout() {
            print(&format!("{line}\n"))?;
        }
        Ok(())
    }

    /// A remark besides the results, for example a skipped photograph; on standard error.
    pub fn note(&self, line: impl Display) {
        note(&line.to_string());
    }

    /// How work goes on that nobody knows the end of: a line for people, or data; on standard error.
    pub fn status(&self, line: impl Display, data: &serde_json::Value) {
        match in_data() {
            true => data_line(data),
            false if self.quiet => {}
            false => last_line(&line.to_string()),
        }
    }

    /// The result as data, with its provenance: printed or written if `--json` was given, else nothing. Call it once a command.
    ///
    /// # Errors
    /// When the file or standard output cannot be written.
    pub fn json(&self, result: &impl Serialize) -> Result<(), Error> {
        let Some(path) = &self.json else { return Ok(()) };
        self.told.store(true, Ordering::Relaxed);
        let text = serde_json::to_string_pretty(&Recorded { result, provenance: self.provenance() })? + "\n";
        if self.json_has_stdout() {
            print(&text)?;
        } else {
            edof_core::storage::atomic::write(path, text.as_bytes())?;
        }
        Ok(())
    }

    /// Whether results went out as data already.
    pub fn has_told(&self) -> bool {
        self.told.load(Ordering::Relaxed)
    }

    /// One of many results as a line of data with the time, if `--json` was given: the file of `--json` grows by it.
    ///
    /// # Errors
    /// When the file or standard output cannot be written.
    pub fn json_line(&self, result: &impl Serialize) -> Result<(), Error> {
        let Some(path) = &self.json else { return Ok(()) };
        let text = serde_json::to_string(&Timed {
            time: now(),
            seconds: self.begun.elapsed().as_secs_f64(),
            result,
        })? + "\n";
        let first = !self.told.swap(true, Ordering::Relaxed);
        if self.json_has_stdout() {
            print(&text)?;
            return Ok(());
        }
        let failed = |source| edof_core::storage::atomic::WriteError { path: path.clone(), source };
        let mut file = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        if first || file.is_none() {
            *file = Some(std::fs::File::create(path).map_err(failed)?);
        }
        match file.as_mut() {
            Some(file) => Ok(file.write_all(text.as_bytes()).map_err(failed)?),
            None => Ok(()),
        }
    }

    /// Progress of `total` steps: a bar on a terminal, a plain line now and then in a pipe.
    pub fn progress(&self, total: u64, what: impl Into<String>) -> Progress {
        self.progress_within(None, total, what)
    }

    /// The same of work that ends after `limit` at the latest, however many steps are left then.
    pub fn progress_within(&self, limit: Option<Duration>, total: u64, what: impl Into<String>) -> Progress {
        let what = what.into();
        let ends = limit.and_then(|limit| Instant::now().checked_add(limit));
        let terminal = std::io::stderr().is_terminal() && !in_data();
        let bar = if terminal && !self.quiet {
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
            let template = "{prefix} {wide_bar} {pos}/{len} {left} {msg}";
            let style =
                ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
            bar.set_style(style.with_key(
                "left",
                move |state: &ProgressState, to: &mut dyn std::fmt::Write| {
                    let _ = to.write_str(&span(sooner(state.eta().as_secs_f64(), ends)));
                },
            ));
            bar.set_prefix(what.clone());
            bar
        } else {
            ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden())
        };
        let plain = (!terminal && !self.quiet).then(|| {
            let now = Instant::now();
            Mutex::new(Plain { begun: now, last: now, has_estimate: false, told: None, first: None })
        });
        if plain.is_some() && in_data() {
            data_line(&serde_json::json!({ "progress": what, "done": 0, "total": total }));
        }
        Progress { bar, what, plain, ends }
    }
}

/// Progress of one piece of work; may be shared between threads. The bar goes away when it is dropped.
pub struct Progress {
    bar: ProgressBar,
    what: String,
    plain: Option<Mutex<Plain>>,
    /// When the work ends, however many steps are left then.
    ends: Option<Instant>,
}

/// Progress in lines.
struct Plain {
    /// When the work began.
    begun: Instant,
    /// When the last one was written.
    last: Instant,
    /// Whether one stated the time that is left.
    has_estimate: bool,
    /// Last step that was reported to a program.
    told: Option<u64>,
    /// Time and number of the first reported step: a resumed job did the steps before it in an earlier run.
    first: Option<(Instant, u64)>,
}

impl Progress {
    /// Steps done in all.
    pub fn set(&self, position: u64) {
        self.bar.set_position(position);
        let Some(plain) = &self.plain else { return };
        let Ok(mut plain) = plain.lock() else { return };
        let (begun, first) = *plain.first.get_or_insert_with(|| (Instant::now(), position));
        if in_data() {
            return self.tell(&mut plain, position, (begun, first));
        }
        let since = plain.last.elapsed();
        let is_first_estimate = !plain.has_estimate && position > first && since >= FIRST_PLAIN;
        if since >= PLAIN_EVERY || is_first_estimate {
            (plain.last, plain.has_estimate) = (Instant::now(), position > first);
            let message = self.bar.message();
            let gap = if message.is_empty() { "" } else { " " };
            let total = self.bar.length().unwrap_or(0);
            let (done, to_do) = (position.saturating_sub(first), total.saturating_sub(position));
            let left = left(begun.elapsed(), (done, to_do), self.ends);
            crate::ui::last_line(&format!("{}: {position}/{total}{left}{gap}{message}", self.what));
        }
    }

    /// A line for programs: the first step, the last, and one in each second between them.
    fn tell(&self, plain: &mut Plain, position: u64, (begun, first): (Instant, u64)) {
        let total = self.bar.length().unwrap_or(0);
        let due = plain.told.is_none() || position >= total || plain.last.elapsed() >= DATA_EVERY;
        if !due || plain.told == Some(position) {
            return;
        }
        (plain.last, plain.told) = (Instant::now(), Some(position));
        let (done, to_do) = (position.saturating_sub(first), total.saturating_sub(position));
        let left = seconds_left(begun.elapsed(), (done, to_do), self.ends);
        data_line(&serde_json::json!({
            "progress": self.what,
            "done": position,
            "total": total,
            "seconds": plain.begun.elapsed().as_secs_f64(),
            "seconds_left": left,
            "message": self.bar.message(),
        }));
    }

    /// Steps done of all, where nobody knew before how many there are.
    pub fn of(&self, position: u64, total: u64) {
        self.bar.set_length(total);
        self.set(position);
    }

    /// All of it is done.
    pub fn finish(self) {
        let total = self.bar.length().unwrap_or(0);
        self.message("");
        self.set(total);
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
fn left(elapsed: Duration, steps: (u64, u64), ends: Option<Instant>) -> String {
    seconds_left(elapsed, steps, ends).map_or_else(String::new, |seconds| format!(", {} left", span(seconds)))
}

/// Seconds in words, as in `40 s`, `9 min` or `2.0 h`.
pub fn span(seconds: f64) -> String {
    match seconds {
        0.0..90.0 => format!("{seconds:.0} s"),
        90.0..5400.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.1} h", seconds / 3600.0),
    }
}

/// Seconds that a job of equal steps, done and to do, still takes, if known; it ends at `ends` at the latest.
fn seconds_left(elapsed: Duration, (done, to_do): (u64, u64), ends: Option<Instant>) -> Option<f64> {
    (done > 0 && to_do > 0).then(|| sooner(elapsed.as_secs_f64() * to_do as f64 / done as f64, ends))
}

/// Seconds until the steps or the time are over.
fn sooner(seconds: f64, ends: Option<Instant>) -> f64 {
    ends.map_or(seconds, |ends| ends.saturating_duration_since(Instant::now()).as_secs_f64().min(seconds))
}

/// The time in UTC, as 2026-11-22T07:05:09.250Z.
fn now() -> String {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let (second, millis) = (since.as_secs() % 86_400, since.subsec_millis());
    let [hour, minute, second] = [second / 3600, second / 60 % 60, second % 60];
    format!("{}T{hour:02}:{minute:02}:{second:02}.{millis:03}Z", today())
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

/// One of many results, with the time at which it was so and the seconds since the program began.
#[derive(Serialize)]
struct Timed<'a, T> {
    time: String,
    seconds: f64,
    #[serde(flatten)]
    result: &'a T,
}

/// Whether standard error has lines of JSON alone.
fn in_data() -> bool {
    DATA.load(Ordering::Relaxed)
}

/// A line of JSON with the time on standard error.
fn data_line(what: &serde_json::Value) {
    let mut line = serde_json::json!({ "time": now() });
    if let (serde_json::Value::Object(line), serde_json::Value::Object(what)) = (&mut line, what) {
        line.extend(what.clone());
    }
    last_line(&line.to_string());
}

/// The line of wrong usage, for a program that reads lines of data.
pub fn wrong_usage(text: &str) {
    data_line(&serde_json::json!({ "error": text }));
}

/// The line of a failure.
pub fn failure(error: &Error) {
    match in_data() {
        true => data_line(&serde_json::json!({ "error": error.to_string() })),
        false => last_line(&format!("edof: {error}")),
    }
}

/// A remark besides the results; on standard error.
pub fn note(line: &str) {
    match in_data() {
        true => data_line(&serde_json::json!({ "note": line })),
        false => last_line(line),
    }
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
        let left = |seconds, done, to_do| left(Duration::from_secs(seconds), (done, to_do), None);
        assert_eq!(left(10, 5, 20), ", 40 s left");
        assert_eq!(left(60, 1, 9), ", 9 min left");
        assert_eq!(left(600, 1, 12), ", 2.0 h left");
        assert_eq!((left(10, 0, 5), left(10, 5, 0)), (String::new(), String::new()));
    }

    #[test]
    fn work_with_a_limit_ends_no_later_than_that() {
        let ends = |seconds| Instant::now().checked_add(Duration::from_secs(seconds));
        let left = |to_do, limit| seconds_left(Duration::from_secs(10), (10, to_do), ends(limit)).unwrap();
        assert!((29.0..=30.0).contains(&left(1000, 30)), "the limit comes first");
        assert!((left(20, 30) - 20.0).abs() < 1e-9, "the steps end first");
        assert!(left(20, 0).abs() < 1e-9);
    }

    #[test]
    fn a_time_is_of_today() {
        let time = now();
        assert!(time.starts_with(&today()) && time.ends_with('Z') && time.len() == 24, "{time}");
    }

    #[test]
    fn days_have_their_dates() {
        let dates = [0, 59, 11_016, 19_782, 20_779].map(civil);
        assert_eq!(dates, [[1970, 1, 1], [1970, 3, 1], [2000, 2, 29], [2024, 2, 29], [2026, 11, 22]]);
    }
}
