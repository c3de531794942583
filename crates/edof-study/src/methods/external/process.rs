//! Processes of a user's program: one for a frame, or one that gets a line for every frame.

use crate::methods::external::LIST;
use edof_core::storage::atomic::reason;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, Write};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// A process with all that it starts, ended when this goes.
#[derive(Debug)]
struct Process {
    child: Child,
    stderr: File,
}

impl Process {
    /// `sh` with a command, whose error output is kept.
    fn start(text: &str, stdin: Stdio, stdout: Stdio) -> Result<Self, String> {
        let stderr = tempfile::tempfile().map_err(|e| reason(&e))?;
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(text).stdin(stdin).stdout(stdout);
        shell.stderr(stderr.try_clone().map_err(|e| reason(&e))?);
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut shell, 0);
        let child = shell.spawn().map_err(|e| format!("cannot run sh: {}", reason(&e)))?;
        Ok(Self { child, stderr })
    }

    /// The status of a process that ended in time.
    fn wait(&mut self, limit: Duration) -> std::io::Result<Option<ExitStatus>> {
        let start = Instant::now();
        let mut pause = Duration::from_millis(1);
        loop {
            if let Some(status) = self.child.try_wait()? {
                return Ok(Some(status));
            }
            if start.elapsed() >= limit {
                return Ok(None);
            }
            std::thread::sleep(pause);
            pause = (2 * pause).min(Duration::from_millis(50));
        }
    }

    /// Returns why a process that has ended failed: its status, and the last line of its error output.
    fn failure(&mut self, command: &str, status: ExitStatus) -> String {
        let mut text = Vec::new();
        let read = self.stderr.rewind().and_then(|()| self.stderr.read_to_end(&mut text));
        let text = read.map(|_| String::from_utf8_lossy(&text).into_owned()).unwrap_or_default();
        let last = text.lines().rev().find(|line| !line.trim().is_empty());
        let last = last.map(|line| format!(": {}", line.trim())).unwrap_or_default();
        format!("'{command}' ended with {status}{last}")
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(Some(_))) {
            return;
        }
        #[cfg(unix)]
        let _ = Command::new("sh").arg("-c").arg(format!("kill -KILL -{}", self.child.id())).status();
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// `N seconds`.
fn count(limit: Duration) -> String {
    edof_core::words::count(limit.as_secs() as usize, "second")
}

/// Runs a command to its end; `text` is the command with its files.
pub(super) fn run_once(command: &str, text: &str, limit: Duration) -> Result<(), String> {
    let mut process = Process::start(text, Stdio::null(), Stdio::null())?;
    match process.wait(limit).map_err(|e| reason(&e))? {
        Some(status) if status.success() => Ok(()),
        Some(status) => Err(process.failure(command, status)),
        None => Err(format!("'{command}' took more than {}; --external-seconds allows more", count(limit))),
    }
}

/// A process that reads a line for every frame and prints one for every picture.
#[derive(Debug)]
pub(super) struct Served {
    command: String,
    // Closed before the process is ended.
    frames: ChildStdin,
    lines: Receiver<String>,
    process: Process,
}

impl Served {
    /// Starts a command with [`LIST`] and waits until it prints `ready`.
    pub(super) fn start(command: &str, limit: Duration) -> Result<Self, String> {
        let mut process =
            Process::start(&command.replace(LIST, "/dev/stdin"), Stdio::piped(), Stdio::piped())?;
        let (Some(frames), Some(stdout)) = (process.child.stdin.take(), process.child.stdout.take()) else {
            return Err(format!("'{command}' has no pipes"));
        };
        let (sender, lines) = channel();
        // Ends with the process, whose end of the pipe it reads.
        std::thread::spawn(move || {
            BufReader::new(stdout)
                .lines()
                .map_while(Result::ok)
                .take_while(|line| sender.send(line.clone()).is_ok())
                .for_each(drop)
        });
        let mut served = Self { command: command.to_owned(), frames, lines, process };
        served.expect("ready", "'ready'", limit)?;
        Ok(served)
    }

    /// Sends a frame's line, its fields separated by tabs: raw frame, picture to write, ψ, noise. Seconds until the picture's name comes back.
    pub(super) fn picture(&mut self, fields: [&str; 4], limit: Duration) -> Result<f64, String> {
        let start = Instant::now();
        // A process that has gone is named below, with its last words.
        let _ = writeln!(self.frames, "{}", fields.join("\t")).and_then(|()| self.frames.flush());
        self.expect(fields[1], "the name of the picture", limit)?;
        Ok(start.elapsed().as_secs_f64())
    }

    /// Waits for a line; others that come before it are passed over.
    fn expect(&mut self, line: &str, what: &str, limit: Duration) -> Result<(), String> {
        let end = Instant::now() + limit;
        loop {
            match self.lines.recv_timeout(end.saturating_duration_since(Instant::now())) {
                Ok(own) if own.trim_end() == line => return Ok(()),
                Ok(_) => {}
                Err(RecvTimeoutError::Timeout) => {
                    let (command, limit) = (&self.command, count(limit));
                    return Err(format!(
                        "'{command}' did not print {what} within {limit}; --external-seconds allows more"
                    ));
                }
                Err(RecvTimeoutError::Disconnected) => {
                    let status = self.process.wait(Duration::from_secs(1)).map_err(|e| reason(&e))?;
                    return Err(status.map_or_else(
                        || format!("'{}' has closed its output before it printed {what}", self.command),
                        |status| self.process.failure(&self.command, status),
                    ));
                }
            }
        }
    }
}
