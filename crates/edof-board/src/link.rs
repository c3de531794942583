//! Words read and written over a line that may lose, double or change bytes.
//!
//! The board answers no write, and no frame has a checksum. So every frame that writes is followed by one that reads `uart_broken` and
//! `writes_refused`, the board's counts of frames that it gave up and of words that it kept out, and the host waits for that answer.
//! What is wrong shows there: a byte too few, and the board takes the question for the rest of the words and does not answer; a byte
//! too many, and it counts one more; a word that went astray to where it could do harm, and that is counted. Whatever the question is
//! taken for, it writes nothing. A word that was changed on its way shows in the checks afterwards (`crate::load`).

use crate::error::Error;
use crate::line::{Line, line_time};
use crate::protocol;
use edof_device::board::UART_TIME_OUT_MS;
use edof_device::registers::map::{UART_BROKEN, WRITES_REFUSED, checked};
use std::time::Duration;

/// Attempts before a line is given up.
pub(crate) const ATTEMPTS: u32 = 6;
/// After so long without a byte the board has given up a frame that was cut off, and nothing is on its way any more.
const QUIET: Duration = Duration::from_millis(UART_TIME_OUT_MS as u64 * 5 / 4);
/// Longer than a bridge holds bytes back: FTDI's do for up to 16 ms.
const IN_FLIGHT: Duration = Duration::from_millis(20);
/// The two counters after a write, one behind the other.
const COUNTS: usize = 2;
const _: () = assert!(WRITES_REFUSED == UART_BROKEN + 4);
/// Bytes that are thrown away before a line that never rests is taken as it is: four of the longest answers. What is left of a frame after a reset
/// may ask for one.
const UNREST: usize = 4 * 4 * protocol::MAX_WORDS;
/// Bytes that are taken at once where they are thrown away.
const THROWN_AWAY: usize = 4096;
/// How long an answer may take beyond its time on the line, where the user says nothing else.
pub const PATIENCE: Duration = Duration::from_millis(250);

/// How much longer than as fast as ever an answer may take: what simulates a circuit shares its machine with others.
const SLACK: u32 = 4;
/// A line, and what is known of the board's side.
pub struct Link<L> {
    line: L,
    patience: Duration,
    /// The shortest time that a byte took until now, there or back, with all that lay between question and answer.
    byte: Option<Duration>,
    /// Answers that did not come since the last one that did.
    missed: u32,
    /// How long the last answer was waited for at most.
    waited: Duration,
    /// What `uart_broken` and `writes_refused` were last.
    counts: Option<Vec<u32>>,
    /// Frames that were sent again.
    pub repeats: u64,
}

impl<L: Line> Link<L> {
    /// Over a line whose other end answers within `patience` and the time that bytes take: on the line, or as they have been seen to take
    /// where the other end is slower than its line, as a simulated circuit is.
    pub const fn new(line: L, patience: Duration) -> Self {
        Self { line, patience, byte: None, missed: 0, waited: patience, counts: None, repeats: 0 }
    }

    /// What the line is called in messages.
    pub fn name(&self) -> String {
        self.line.name().to_owned()
    }

    /// The line.
    pub const fn line(&mut self) -> &mut L {
        &mut self.line
    }

    fn failed(&self) -> impl Fn(std::io::Error) -> Error + use<L> {
        let port = self.name();
        move |source| Error::Port { port: port.clone(), source }
    }

    /// Sends frames; the last is answered by N words. Returns nothing unless all N arrive.
    fn exchange(&mut self, frames: &[u8], words: usize) -> Result<Option<Vec<u32>>, Error> {
        let failed = self.failed();
        self.throw_away(Duration::ZERO)?;
        let begun = self.line.time();
        self.line.send(frames).map_err(&failed)?;
        let wanted = 4 * words;
        self.waited = self.patience + self.time_of(frames.len() + wanted);
        let mut bytes = Vec::with_capacity(wanted);
        while bytes.len() < wanted {
            let some = self.line.receive(wanted - bytes.len(), self.waited).map_err(&failed)?;
            if some.is_empty() {
                self.missed += 1;
                return Ok(None);
            }
            bytes.extend(some);
        }
        let took = self.line.time().saturating_sub(begun) / (frames.len() + wanted).max(1) as u32;
        self.byte = Some(self.byte.map_or(took, |byte| byte.min(took)));
        self.missed = 0;
        Ok(Some(protocol::words(&bytes)))
    }

    /// How long N bytes may take: twice as long after each answer that did not come.
    fn time_of(&self, bytes: usize) -> Duration {
        let seen = self.byte.unwrap_or_default() * bytes as u32 * SLACK;
        line_time(bytes, self.line.baud()).max(seen) * (1 << self.missed.min(ATTEMPTS))
    }

    /// Throws away what comes, until nothing comes for so long.
    fn throw_away(&mut self, quiet: Duration) -> Result<(), Error> {
        let mut thrown = 0;
        while thrown < UNREST {
            let some = self.line.receive(THROWN_AWAY, quiet).map_err(self.failed())?;
            if some.is_empty() {
                break;
            }
            thrown += some.len();
        }
        Ok(())
    }

    /// Waits until the board has surely given up what was cut off.
    ///
    /// # Errors
    /// The line is gone.
    pub fn settle(&mut self) -> Result<(), Error> {
        self.counts = None;
        self.repeats += 1;
        self.throw_away(QUIET.max(self.waited))
    }

    /// Waits until the board has given up what another host may have begun.
    ///
    /// # Errors
    /// The line is gone.
    pub fn wait_out(&mut self) -> Result<(), Error> {
        self.throw_away(QUIET)
    }

    /// Waits until no byte is in flight, and throws away what came.
    ///
    /// # Errors
    /// The line is gone.
    pub fn come_to_rest(&mut self) -> Result<(), Error> {
        self.throw_away(IN_FLIGHT)
    }

    /// Reads words from a byte address on, for what may be another word at any time.
    ///
    /// # Errors
    /// No answer.
    pub fn glance(&mut self, address: u32, words: usize) -> Result<Vec<u32>, Error> {
        for _ in 0..ATTEMPTS {
            if let Some(found) = self.exchange(&protocol::read(address, words), words)? {
                return Ok(found);
            }
            self.settle()?;
        }
        Err(self.silent())
    }

    /// Reads words from a byte address on that stand still: until two answers one after the other agree.
    ///
    /// # Errors
    /// No answer, or never the same one.
    pub fn read(&mut self, address: u32, words: usize) -> Result<Vec<u32>, Error> {
        let mut last = self.glance(address, words)?;
        for _ in 0..ATTEMPTS {
            let found = self.glance(address, words)?;
            if found == last {
                return Ok(found);
            }
            self.settle()?;
            last = found;
        }
        Err(self.noisy(&format!("the word at 0x{address:x}")))
    }

    /// Writes words, 255 at most, from a byte address on, and makes sure that the board took as many bytes as were sent, and every word.
    ///
    /// # Errors
    /// No answer, or never the right one; [`Error::Refused`]: the board keeps them out.
    pub fn write(&mut self, address: u32, words: &[u32]) -> Result<(), Error> {
        let (mut answered, mut refused) = (false, 0);
        for _ in 0..ATTEMPTS {
            let before = match self.counts.take() {
                Some(counts) => counts,
                None => self.read(UART_BROKEN, COUNTS)?,
            };
            let question = protocol::read(UART_BROKEN, COUNTS);
            let answer = self.exchange(&[protocol::write(address, words), question].concat(), COUNTS)?;
            if answer.as_ref() == Some(&before) {
                self.counts = answer;
                return Ok(());
            }
            answered |= answer.is_some();
            refused += u32::from(answer.is_some_and(|now| now[0] == before[0] && now[1] != before[1]));
            self.settle()?;
        }
        if refused == ATTEMPTS {
            Err(Error::Refused { port: self.name(), address })
        } else if answered {
            Err(self.noisy(&format!("words for 0x{address:x}")))
        } else {
            Err(self.silent())
        }
    }

    /// Writes a word and reads it back.
    ///
    /// # Errors
    /// As [`Link::read`] and [`Link::write`].
    pub fn set(&mut self, address: u32, word: u32) -> Result<(), Error> {
        self.set_as(address, word, word)
    }

    /// Writes a word of 16 bits with its complement above it, and reads it back.
    ///
    /// # Errors
    /// As [`Link::set`].
    pub fn set_checked(&mut self, address: u32, word: u32) -> Result<(), Error> {
        self.set_as(address, checked(word), word)
    }

    fn set_as(&mut self, address: u32, sent: u32, held: u32) -> Result<(), Error> {
        for _ in 0..ATTEMPTS {
            self.write(address, &[sent])?;
            if self.read(address, 1)? == [held] {
                return Ok(());
            }
            self.settle()?;
        }
        Err(self.noisy(&format!("a word for 0x{address:x}")))
    }

    fn silent(&self) -> Error {
        Error::Silent { port: self.name(), baud: self.line.baud(), asked: ATTEMPTS }
    }

    fn noisy(&self, what: &str) -> Error {
        Error::Noisy { port: self.name(), what: what.into(), tried: ATTEMPTS }
    }
}
