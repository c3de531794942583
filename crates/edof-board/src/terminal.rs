//! A simulated board behind a pseudo-terminal, so that any program that knows a serial port can talk to it.

use crate::error::Error;
use crate::line::line_time;
use crate::simulated::{Shown, Simulated};
use serialport::{SerialPort, TTYPort};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Bytes that are taken at once.
const AT_ONCE: usize = 4096;
/// How long a look for bytes waits where the board has nothing to do of its own.
const WAITS: Duration = Duration::from_millis(2);

/// What stands behind a pseudo-terminal.
pub trait Device {
    /// Takes bytes of the host, if any, lets some time pass, and gives bytes.
    ///
    /// # Errors
    /// The device failed.
    fn exchange(&mut self, came: &[u8]) -> Result<Vec<u8>, Error>;

    /// The newest picture on the screen: a word a pixel, Y′ low, Cb′ or Cr′ high; none before the first.
    fn picture(&self) -> Option<Vec<u16>>;

    /// Pictures of words of two networks so far; none from who cannot tell.
    fn mixed(&self) -> Option<u64>;

    /// Bytes from the host and to it so far, and the seconds that a byte was on the line.
    fn carried(&self) -> ([u64; 2], f64);

    /// Whether the board needs the time between bytes; the terminal then does not wait for bytes.
    fn is_busy(&self) -> bool;
}

/// The board in Rust: its time passes with that of the wall, and besides with every byte on the line.
pub struct InRust {
    board: Simulated,
    last: Instant,
    baud: u32,
}

impl InRust {
    /// Begins.
    #[must_use]
    pub fn new(board: Simulated, baud: u32) -> Self {
        Self { board, last: Instant::now(), baud }
    }
}

impl Device for InRust {
    fn exchange(&mut self, came: &[u8]) -> Result<Vec<u8>, Error> {
        let now = Instant::now();
        self.board.pass_to(self.board.now() + (now - self.last).as_nanos() as u64);
        self.last = now;
        came.iter().for_each(|byte| self.board.byte(*byte));
        Ok(self.board.take_all())
    }

    fn picture(&self) -> Option<Vec<u16>> {
        self.board.shown().iter().rev().find_map(|shown| match shown {
            Shown::Whole(pixels) => Some(pixels.to_vec()),
            Shown::Mixed => None,
        })
    }

    fn mixed(&self) -> Option<u64> {
        Some(self.board.mixed())
    }

    fn carried(&self) -> ([u64; 2], f64) {
        let bytes = self.board.bytes;
        (bytes, line_time((bytes[0] + bytes[1]) as usize, self.baud).as_secs_f64())
    }

    fn is_busy(&self) -> bool {
        false
    }
}

/// A pseudo-terminal with a device behind it.
pub struct Terminal {
    ours: TTYPort,
    /// Kept open, so that the terminal outlives its clients.
    _theirs: TTYPort,
    path: PathBuf,
    link: Option<PathBuf>,
}

fn failed(error: impl ToString) -> Error {
    Error::Terminal(error.to_string())
}

impl Terminal {
    /// Opens one, and makes a link to it if a path is given, in place of one that leads nowhere.
    ///
    /// # Errors
    /// The system has none, or something else stands at the path, such as the link of another board.
    pub fn open(link: Option<&Path>) -> Result<Self, Error> {
        let (ours, theirs) = TTYPort::pair().map_err(failed)?;
        let path = PathBuf::from(theirs.name().ok_or_else(|| failed("it has no name"))?);
        if let Some(link) = link {
            let named = |error: std::io::Error| failed(format!("{}: {error}", link.display()));
            match std::fs::read_link(link) {
                // Left behind: its terminal is gone, or is the one that is ours now.
                Ok(to) if to == path || !link.exists() => std::fs::remove_file(link).map_err(named)?,
                Ok(to) => {
                    let (link, to) = (link.display(), to.display());
                    return Err(failed(format!(
                        "{link}: leads to {to}, where another board may answer; end that one, remove the link, or name another path"
                    )));
                }
                Err(_) if link.exists() => {
                    let link = link.display();
                    return Err(failed(format!(
                        "{link}: is there already, and no link of a board; name another path, or delete it"
                    )));
                }
                Err(_) => {}
            }
            std::os::unix::fs::symlink(&path, link).map_err(named)?;
        }
        Ok(Self { ours, _theirs: theirs, path, link: link.map(Path::to_owned) })
    }

    /// How clients open it.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.link.as_deref().unwrap_or(&self.path)
    }

    /// Carries what came to the device and what it says back, once.
    ///
    /// # Errors
    /// The terminal is gone, or the device failed.
    pub fn serve(&mut self, device: &mut dyn Device) -> Result<(), Error> {
        let mut came = [0; AT_ONCE];
        let waits = if device.is_busy() { Duration::ZERO } else { WAITS };
        self.ours.set_timeout(waits).map_err(failed)?;
        let count = match self.ours.read(&mut came) {
            Ok(count) => count,
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => 0,
            Err(error) => return Err(failed(error)),
        };
        let answer = device.exchange(&came[..count])?;
        self.ours.set_timeout(WAITS).map_err(failed)?;
        match self.ours.write_all(&answer) {
            // Nobody reads, and the system has no room for more: lost, as on a line.
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => Ok(()),
            result => result.map_err(failed),
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // Anybody who put something else there meanwhile keeps it.
        if let Some(link) = &self.link
            && std::fs::read_link(link).is_ok_and(|to| to == self.path)
        {
            let _ = std::fs::remove_file(link);
        }
    }
}
