//! Programs of the system: run, and their complaints shortened to what a person needs.

use crate::Error;
use std::io::ErrorKind;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Lines of a program's error output that are kept.
const KEPT_LINES: usize = 6;

/// A command that runs in `dir` and speaks English, whatever the environment says.
pub fn command(tool: &str, dir: &Path) -> Command {
    let mut command = Command::new(tool);
    command.current_dir(dir).env("LC_ALL", "C").env_remove("MAKEFLAGS").env_remove("MFLAGS");
    command
}

/// Runs to the end; an exit status other than zero is no error yet.
pub fn output(command: &mut Command) -> Result<Output, Error> {
    let tool = command.get_program().to_string_lossy().into_owned();
    if let Some(dir) = command.get_current_dir().filter(|dir| !dir.is_dir()) {
        return Err(Error::File { path: dir.into(), source: ErrorKind::NotFound.into() });
    }
    to_the_end(command).map_err(|error| match error.kind() {
        ErrorKind::NotFound => Error::ToolMissing { tool },
        _ => Error::NotStarted { tool, source: error },
    })
}

/// Whether a program can be run at all.
///
/// # Errors
/// [`Error::ToolMissing`].
pub fn require(tool: &str) -> Result<(), Error> {
    output(command(tool, Path::new(".")).arg("--version")).map(drop)
}

/// Runs in a process group of its own, so that [`stop_all`] reaches what the program starts itself, too.
fn to_the_end(command: &mut Command) -> std::io::Result<Output> {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
    let mut running = running();
    let child = command.spawn()?;
    let group = child.id();
    running.push(group);
    drop(running);
    let output = child.wait_with_output();
    self::running().retain(|other| *other != group);
    output
}

/// Process groups that run now.
static RUNNING: Mutex<Vec<u32>> = Mutex::new(vec![]);

fn running() -> MutexGuard<'static, Vec<u32>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends all programs that run and lets nobody start another: for a process that is about to end in the middle of its work.
pub fn stop_all() {
    let running = running();
    for group in running.iter() {
        // The standard library cannot signal a group; a group that has ended already is no failure.
        let _ =
            Command::new("sh").args(["-c", &format!("kill -KILL -{group}")]).stderr(Stdio::null()).status();
    }
    std::mem::forget(running);
}

/// Runs to the end and returns standard output; an exit status other than zero is an error with the reason.
pub fn run(command: &mut Command) -> Result<String, Error> {
    let tool = command.get_program().to_string_lossy().into_owned();
    let output = output(command)?;
    let standard = String::from_utf8_lossy(&output.stdout).into_owned();
    if output.status.success() {
        return Ok(standard);
    }
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned() + &standard;
    Err(Error::ToolFailed { tool, lines: reasons(&complaint, &output.status.to_string()) })
}

/// The lines that name an error, or the last ones where none does, or the exit status.
fn reasons(complaint: &str, status: &str) -> Vec<String> {
    let lines: Vec<&str> = complaint.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let is_error = |line: &&&str| {
        let line = line.to_lowercase();
        line.contains("error") && !line.contains("exiting due to") && !line.starts_with("make")
    };
    let errors: Vec<String> = lines.iter().filter(is_error).take(KEPT_LINES).map(|&s| s.into()).collect();
    match (errors.is_empty(), lines.is_empty()) {
        (false, _) => errors,
        (true, false) => lines[lines.len().saturating_sub(KEPT_LINES)..].iter().map(|&s| s.into()).collect(),
        (true, true) => vec![status.into()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_program_is_named_with_what_installs_it() {
        let error = run(&mut command("edof-no-such-program", Path::new("."))).unwrap_err();
        let text = "edof-no-such-program not found: install it by 'apt-get install edof-no-such-program', or all tools by \
                    `source scripts/prepare.sh; need_simulators`";
        assert_eq!(error.to_string(), text);
        assert_eq!(require("edof-no-such-program").unwrap_err().to_string(), text);
        require("sh").unwrap();
    }

    #[test]
    fn a_missing_directory_is_not_taken_for_a_missing_program() {
        let error = run(&mut command("true", Path::new("/no/such/place"))).unwrap_err();
        assert!(error.to_string().starts_with("/no/such/place: "), "{error}");
    }

    #[test]
    fn errors_are_picked_out_of_a_long_complaint() {
        let text = "a\n%Error: top.v:3:1: syntax error\nb\n%Error: Exiting due to 1 error(s)\n";
        assert_eq!(reasons(text, "exit status: 1"), ["%Error: top.v:3:1: syntax error"]);
        assert_eq!(reasons("only this\n", ""), ["only this"]);
        assert_eq!(reasons("", "signal: 9"), ["signal: 9"]);
    }
}
