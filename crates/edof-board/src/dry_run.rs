//! Predicts the load time by running the same load, byte by byte, on a simulated board.

use crate::board::{Board, control_bit};
use crate::contents::{Part, frames, letter, other, parts, table_parts};
use crate::error::Error;
use crate::line::{Line, line_time};
use crate::link::PATIENCE;
use crate::load::Job;
use crate::protocol::{self, MAX_WORDS};
use crate::simulated::Simulated;
use edof_core::{CfaPhase, RawFrame};
use edof_device::design::memory::Set;
use edof_device::design::timing::READ_PERIOD;
use edof_device::registers::map::CONTROL;
use edof_golden::Display;
use edof_network::FixedNetwork;
use serde::Serialize;
use std::ops::ControlFlow;
use std::time::Duration;

/// What a load would do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plan {
    /// The bank that would be written.
    pub bank: char,
    /// Parts that would be written.
    pub written_parts: usize,
    /// Number of all parts.
    pub parts: usize,
    /// Words that would be sent.
    pub words: u64,
    /// Bits per second.
    pub baud: u32,
    /// Bytes to the board and from it, those of all checks too.
    pub bytes: [u64; 2],
    /// Frames after which the host waits for an answer: each costs a turn-round of the line's bridge besides.
    pub turns: u64,
    /// Seconds on the line.
    pub seconds: f64,
}

/// A line that counts questions.
struct Counted {
    board: Simulated,
    turns: u64,
}

impl Line for Counted {
    fn name(&self) -> &str {
        self.board.name()
    }

    fn baud(&self) -> u32 {
        self.board.baud()
    }

    fn time(&self) -> Duration {
        self.board.time()
    }

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.turns += 1;
        self.board.send(bytes)
    }

    fn receive(&mut self, max: usize, patience: Duration) -> std::io::Result<Vec<u8>> {
        self.board.receive(max, patience)
    }
}

/// What a load would do at that speed, to a bank with the present CRC `held` of each part; of the design alone without that CRC.
///
/// # Errors
/// A network that does not fit.
pub fn plan(job: &Job<'_>, bank: Set, held: Option<&[u32]>, baud: u32) -> Result<Plan, Error> {
    job.network.check()?;
    job.design.check_network(job.network)?;
    let wanted = parts(job.design, job.network, bank);
    let mut line = Counted { board: stand_in(job, bank, &wanted, held, baud)?, turns: 0 };
    let mut board = Board::open(&mut line, PATIENCE)?;
    let opened = board.line();
    let (bytes, before) = (opened.board.bytes, opened.board.now());
    opened.turns = 0;
    let full = job.full || held.is_none();
    let loaded = board.load(&Job { full, ..*job }, &mut |_, _| ControlFlow::Continue(()))?;
    let now = line.board.bytes;
    Ok(Plan {
        bank: letter(bank),
        written_parts: loaded.written_parts,
        parts: loaded.parts,
        words: loaded.words,
        baud,
        bytes: [now[0] - bytes[0], now[1] - bytes[1]],
        turns: line.turns,
        seconds: (line.board.now() - before) as f64 * 1e-9,
    })
}

/// A board whose bank has what the real one has, as far as anybody knows: parts that are right, parts of a known network, and others.
fn stand_in(
    job: &Job<'_>,
    bank: Set,
    wanted: &[Part],
    held: Option<&[u32]>,
    baud: u32,
) -> Result<Simulated, Error> {
    let (width, height) = (job.design.frame.width, job.design.frame.height);
    let grey = ndarray::Array2::from_elem((height, width), 1 << 14);
    let raw = RawFrame::from_values(grey, 16, CfaPhase::Rggb)
        .map_err(|error| Error::Simulation(Box::new(error)))?;
    let mut board = Simulated::new(job.design, [job.network; 2], &Display::default(), raw, baud)?;
    // The pictures stand still, since nobody looks at them, and the other bank is in use.
    protocol::write(CONTROL, &[control_bit(other(bank))]).into_iter().for_each(|byte| board.byte(byte));
    let bases: Vec<Part> =
        job.known.iter().flat_map(|network: &FixedNetwork| parts(job.design, network, bank)).collect();
    for (part, crc) in wanted.iter().zip(held.unwrap_or(&[])) {
        let base = bases.iter().find(|base| base.is_at(part) && base.crc == *crc);
        let words = match base {
            _ if *crc == part.crc => vec![],
            Some(base) => base.words(),
            None => part.words().into_iter().take(1).map(|(address, word)| (address, !word)).collect(),
        };
        for (address, some) in frames(&words, MAX_WORDS) {
            protocol::write(address, &some).into_iter().for_each(|byte| board.byte(byte));
        }
    }
    Ok(board)
}

/// Words of the display's tables that are sent besides, all if nobody knows what is `held`, and their seconds, with the circuit's CRCs of
/// them before and after at the calculator's clock.
#[must_use]
pub fn tables(display: &Display, held: Option<&Display>, clock_mhz: f64, baud: u32) -> (u64, f64) {
    let parts = table_parts(display);
    let held = held.map_or_else(Vec::new, table_parts);
    let is_sent = |(index, part): &(usize, &Part)| held.get(*index).is_none_or(|held| held.crc != part.crc);
    let sent = parts.iter().enumerate().filter(is_sent);
    let words: Vec<(u32, u32)> = sent.flat_map(|(_, part)| part.words()).collect();
    let frames = frames(&words, MAX_WORDS).len();
    let bytes = 4 * words.len() + frames * (2 * protocol::HEADER + 8);
    let rows: usize = parts.iter().map(|part| part.rows.len()).sum();
    let reading = 2.0 * (rows as u64 * READ_PERIOD) as f64 / (1e6 * clock_mhz);
    (words.len() as u64, line_time(bytes, baud).as_secs_f64() + reading)
}
