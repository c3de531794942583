//! A line to a board: bytes there, bytes back.

use crate::error::Error;
use edof_device::board::BOARDS;
use serialport::{ClearBuffer, SerialPort, SerialPortType};
use std::io::{self, IsTerminal, Read, Write};
use std::time::{Duration, Instant};

/// Bits on the line for a byte: start, eight, stop.
pub const BITS_PER_BYTE: u32 = 10;

/// Bytes to a board and from it.
pub trait Line {
    /// What it is called in messages.
    fn name(&self) -> &str;

    /// Bits per second.
    fn baud(&self) -> u32;

    /// Time on the line's own clock: the wall's, or a simulation's.
    fn time(&self) -> Duration;

    /// Sends bytes.
    ///
    /// # Errors
    /// The line is gone.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Some of the bytes that come, `max` at most; none if none comes for so long.
    ///
    /// # Errors
    /// The line is gone.
    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>>;
}

/// How long bytes are on a line of that speed.
#[must_use]
pub fn line_time(bytes: usize, baud: u32) -> Duration {
    Duration::from_secs_f64(bytes as f64 * f64::from(BITS_PER_BYTE) / f64::from(baud.max(1)))
}

impl<L: Line + ?Sized> Line for Box<L> {
    fn name(&self) -> &str {
        (**self).name()
    }

    fn baud(&self) -> u32 {
        (**self).baud()
    }

    fn time(&self) -> Duration {
        (**self).time()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).send(bytes)
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        (**self).receive(max, patience)
    }
}

impl<L: Line + ?Sized> Line for &mut L {
    fn name(&self) -> &str {
        (**self).name()
    }

    fn baud(&self) -> u32 {
        (**self).baud()
    }

    fn time(&self) -> Duration {
        (**self).time()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).send(bytes)
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        (**self).receive(max, patience)
    }
}

/// A serial port of this machine, eight bits, no parity, one stop bit.
pub struct Serial {
    port: Box<dyn SerialPort>,
    name: String,
    baud: u32,
    opened: Instant,
}

/// How long sending may take beyond the time that bytes are on the line.
const SENDING: Duration = Duration::from_secs(5);

impl Serial {
    /// Opens a port, or a pseudo-terminal, at N bits per second. What it has received until now is thrown away.
    ///
    /// # Errors
    /// [`Error::NoPort`]: something else stands at that path, or nothing. [`Error::Port`]: somebody else has it, or it does not have that
    /// speed.
    pub fn open(name: &str, baud: u32) -> Result<Self, Error> {
        let failed = |error: serialport::Error| Error::Port { port: name.into(), source: error.into() };
        if let Some(problem) = what_is(name) {
            return Err(Error::NoPort { port: name.into(), problem: problem.into() });
        }
        let port = serialport::new(name, baud).open().map_err(failed)?;
        port.clear(ClearBuffer::Input).map_err(failed)?;
        Ok(Self { port, name: name.into(), baud, opened: Instant::now() })
    }
}

impl Serial {
    /// Whether a program is at the other end, whose line has a speed of its own.
    #[must_use]
    pub fn is_pseudo_terminal(&self) -> bool {
        std::fs::canonicalize(&self.name).is_ok_and(|path| path.starts_with("/dev/pts"))
    }
}

/// What stands at a path in place of a serial port, none where it may be one.
fn what_is(path: &str) -> Option<&'static str> {
    match std::fs::metadata(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => None,
        Err(_) if std::path::Path::new(path).is_symlink() => {
            Some("leads nowhere: the simulated board that made this link has ended")
        }
        Err(_) => Some("there is no such path"),
        Ok(found) if found.is_dir() => Some("is a folder"),
        Ok(found) if found.is_file() => Some("is a file"),
        Ok(found) if !is_character_device(&found) => Some("is a pipe, a socket or a disk"),
        Ok(_) => {
            let other = std::fs::File::open(path).is_ok_and(|device| !device.is_terminal());
            other.then_some("is another device")
        }
    }
}

/// A pipe is not opened to see: opening one waits for its other end.
#[cfg(unix)]
fn is_character_device(found: &std::fs::Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_char_device(&found.file_type())
}

#[cfg(not(unix))]
const fn is_character_device(_: &std::fs::Metadata) -> bool {
    true
}

impl Line for Serial {
    fn name(&self) -> &str {
        &self.name
    }

    fn baud(&self) -> u32 {
        self.baud
    }

    fn time(&self) -> Duration {
        self.opened.elapsed()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.set_timeout(SENDING + line_time(bytes.len(), self.baud))?;
        self.port.write_all(bytes)
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        self.port.set_timeout(patience)?;
        let mut bytes = vec![0; max];
        loop {
            match self.port.read(&mut bytes) {
                Ok(count) => {
                    bytes.truncate(count);
                    return Ok(bytes);
                }
                Err(error) if error.kind() == io::ErrorKind::TimedOut => return Ok(vec![]),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }
}

/// A serial port of this machine at which a board may be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Port {
    /// How it is opened.
    pub name: String,
    /// What the system says of it.
    pub about: String,
}

/// The serial ports of this machine, those with a USB bridge first: the KC705 has a CP2103.
#[must_use]
pub fn ports() -> Vec<Port> {
    // Where the system has no list there are none.
    if cfg!(target_os = "linux") && !std::path::Path::new("/sys/class/tty").is_dir() {
        return vec![];
    }
    let mut found: Vec<(bool, Port)> = serialport::available_ports()
        .unwrap_or_default()
        .into_iter()
        .map(|port| {
            let usb = match port.port_type {
                SerialPortType::UsbPort(usb) => Some(usb),
                _ => None,
            };
            let about = usb.as_ref().map_or("serial port".to_owned(), |usb| {
                let product = usb.product.as_deref().unwrap_or("USB");
                format!("{product} ({:04x}:{:04x})", usb.vid, usb.pid)
            });
            (usb.is_none(), Port { name: port.port_name, about })
        })
        .collect();
    found.sort_by(|(a, one), (b, other)| (a, &one.name).cmp(&(b, &other.name)));
    found.into_iter().map(|(_, port)| port).collect()
}

/// Returns the speeds of the boards' lines, the default board's first, each once.
#[must_use]
pub fn bauds() -> Vec<u32> {
    let mut speeds: Vec<u32> = vec![];
    for board in BOARDS {
        if !speeds.contains(&board.baud) {
            speeds.push(board.baud);
        }
    }
    speeds
}
