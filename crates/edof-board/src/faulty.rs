//! A line on which one thing goes wrong at one byte: to see what a host makes of it.

use crate::line::Line;
use edof_core::draw::Draw;
use std::io;
use std::time::Duration;

/// What goes wrong, at a byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The byte is lost.
    Drop,
    /// The byte arrives twice.
    Double,
    /// These bits of it are changed.
    Flip(u8),
    /// The host ends.
    Kill,
    /// The board is reset.
    Reset,
    /// Nothing comes through any more, both ways.
    Silence,
}

/// A fault: what, and at which byte of one direction, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fault {
    /// What goes wrong.
    pub kind: Kind,
    /// Of the bytes from the host, or of those from the board.
    pub to_board: bool,
    /// Number of the byte.
    pub at: u64,
}

/// Bytes of a load's last question and answer, and more than loads differ in length.
const LAST: i64 = 100;
/// Bytes at the begin and the end of a load, where its frames of few words are.
const BEGIN: i64 = 600;
const END: i64 = 1500;

impl Fault {
    /// A random fault, within N bytes from the host and to it.
    pub fn drawn(draw: &mut Draw, bytes: [u64; 2]) -> Self {
        let kind = match draw.whole(0, 9) {
            0 | 1 => Kind::Drop,
            2 | 3 => Kind::Double,
            4..=6 => Kind::Flip(1 << draw.whole(0, 7)),
            7 => Kind::Kill,
            8 => Kind::Reset,
            _ => Kind::Silence,
        };
        let to_board = draw.whole(0, 3) > 0;
        let max = bytes[usize::from(!to_board)] as i64;
        let at = match draw.whole(0, 3) {
            0 => draw.whole(1, max.min(BEGIN)),
            1 => draw.whole((max - END).max(1), max),
            _ => draw.whole(1, max),
        };
        // A reset after the answer to a load's last question is one of another time.
        let last = if kind == Kind::Reset { LAST } else { 0 };
        Self { kind, to_board, at: (at - last).max(1) as u64 }
    }

    /// Whether a host that meets it may end before its work is done; any other one recovers.
    #[must_use]
    pub const fn may_end_the_host(&self) -> bool {
        matches!(self.kind, Kind::Kill | Kind::Silence)
    }
}

/// A board whose reset can be pressed.
pub trait Resettable: Line {
    /// Presses it.
    ///
    /// # Errors
    /// The board is gone.
    fn press_reset(&mut self) -> io::Result<()>;
}

/// A line to a board, with a fault.
pub struct Faulty<'a, B> {
    board: &'a mut B,
    fault: Fault,
    /// Bytes so far, to the host and from it.
    bytes: [u64; 2],
    is_dead: bool,
}

impl<'a, B: Resettable> Faulty<'a, B> {
    /// A line to a board on which that goes wrong.
    pub const fn new(board: &'a mut B, fault: Fault) -> Self {
        Self { board, fault, bytes: [0; 2], is_dead: false }
    }

    /// What becomes of a byte.
    fn passed(&mut self, byte: u8, to_board: bool) -> io::Result<Vec<u8>> {
        let count = &mut self.bytes[usize::from(to_board)];
        *count += 1;
        let now = self.fault.to_board == to_board && *count == self.fault.at;
        match self.fault.kind {
            Kind::Drop if now => return Ok(vec![]),
            Kind::Double if now => return Ok(vec![byte; 2]),
            Kind::Flip(mask) if now => return Ok(vec![byte ^ mask]),
            Kind::Kill if now => return Err(io::Error::other("killed")),
            Kind::Reset if now => self.board.press_reset()?,
            Kind::Silence if now => self.is_dead = true,
            _ => {}
        }
        Ok(if self.is_dead { vec![] } else { vec![byte] })
    }
}

impl<B: Resettable> Line for Faulty<'_, B> {
    fn name(&self) -> &str {
        "faulty"
    }

    fn baud(&self) -> u32 {
        self.board.baud()
    }

    fn time(&self) -> Duration {
        self.board.time()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        // All up to the fault at once: a line that is simulated bit by bit takes its time for each piece.
        let mut piece = vec![];
        for byte in bytes {
            let before = self.bytes[1] + 1 == self.fault.at && self.fault.to_board;
            if before {
                self.board.send(&std::mem::take(&mut piece))?;
            }
            piece.extend(self.passed(*byte, true)?);
        }
        self.board.send(&piece)
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        let came = self.board.receive(max, patience)?;
        let mut passed = vec![];
        for byte in came {
            passed.extend(self.passed(byte, false)?);
        }
        Ok(passed)
    }
}
