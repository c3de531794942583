//! Networks onto a board, and whether they are there.
//!
//! A load writes a bank that is not in use, has the circuit make a CRC of every part of it, writes what is wrong once more, and has frames
//! made with it only when all is right. What is in use takes no words meanwhile (`protection`), nor does the new bank while it is checked. What is
//! in use is looked at before and after. A reset of the board, or a word that went astray, is seen, and what it changed is put back. A design with one
//! set of weights has no other bank: it makes no frames until its own is right.

use crate::board::{Board, SKIP_ROW, bank_of, control_bit};
use crate::contents::{Part, frames, letter, other, parts, table_parts};
use crate::error::Error;
use crate::line::Line;
use crate::protocol::MAX_WORDS;
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::registers::identity::weights_hash;
use edof_device::registers::map::{
    CONTROL, FLUSH, PROTECT_BANK, PROTECT_CONTROL, PROTECT_OTHER, PROTECTION, RUN, SCRATCH, WEIGHT_SET,
    WEIGHTS_HASH,
};
use edof_golden::Display;
use edof_network::FixedNetwork;
use serde::Serialize;
use std::ops::ControlFlow;

/// Times that a bank is written and looked at before the load is given up.
const ROUNDS: u32 = 6;

/// What is to be loaded.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    /// The board's design.
    pub design: &'a Design,
    /// The network.
    pub network: &'a FixedNetwork,
    /// Into this bank, and what is in use stays in use; else into the idle one, which is then in use.
    pub bank: Option<Set>,
    /// All words, whatever is there.
    pub full: bool,
    /// Compare every word besides, not the CRCs alone.
    pub read_back: bool,
    /// Networks that the board may hold: of those only words that differ are sent.
    pub known: &'a [FixedNetwork],
}

/// Receives how much is done and of how much, in words, rows or steps; may end the work.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64) -> ControlFlow<()>;

/// The progress of work that nobody watches.
pub const fn unwatched(_: u64, _: u64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// What a load did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Loaded {
    /// The bank that was written.
    pub bank: char,
    /// The bank that is in use.
    pub in_use: char,
    /// Parts of the bank.
    pub parts: usize,
    /// Number of words that differed before.
    pub written_parts: usize,
    /// Words that were sent, those that were sent again too.
    pub words: u64,
    /// Words that the network has.
    pub words_of_network: u64,
    /// Times that the bank was written: more than one where something was wrong.
    pub rounds: u32,
    /// Whether the board was reset meanwhile, or a word went astray, and what it changed was put back.
    pub recovered: bool,
    /// Hash of the network.
    pub weights_hash: u32,
}

/// A part that is not as it should be.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Which.
    pub part: String,
    /// What the circuit's CRC of it is.
    pub crc: u32,
    /// What it should be.
    pub expected: u32,
    /// The first row that differs, where rows were read back.
    pub row: Option<usize>,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} (CRC {:08x}, expected {:08x}", self.part, self.crc, self.expected)?;
        self.row.map_or(Ok(()), |row| write!(f, ", row {row}"))?;
        write!(f, ")")
    }
}

/// What must be the same after a load as before.
#[derive(PartialEq)]
struct Kept {
    bank: Set,
    control: u32,
    hash: u32,
    /// What is skipped, of each stage.
    skips: Vec<u32>,
}

/// What stands in `protection` from a load on.
const PROTECTED: u32 = PROTECT_BANK | PROTECT_CONTROL;

/// What stands there from the first check of a bank until it is in use, but while it is written. Every question of a check is a written word, and one
/// that goes astray could change what was checked.
const SEALED: u32 = PROTECTED | PROTECT_OTHER;

/// What stands in `scratch` during a load: a reset clears it.
fn mark(hash: u32) -> u32 {
    hash | 1
}

/// Returns the bank that a load writes: the given one, else the one that is not in use; of a design with one set the first.
#[must_use]
pub fn target(design: &Design, given: Option<Set>, in_use: Set) -> Set {
    match design.sets() {
        [only] => *only,
        _ => given.unwrap_or(other(in_use)),
    }
}

impl<L: Line> Board<L> {
    /// Loads a network.
    ///
    /// # Errors
    /// A network that does not fit, before anything is written; a line that fails; [`Error::NotLoaded`]; [`Error::Interrupted`] when
    /// `progress` says so. What was in use then still is; where that was the bank to be written, the other one.
    pub fn load(&mut self, job: &Job<'_>, progress: Progress<'_>) -> Result<Loaded, Error> {
        job.network.check()?;
        job.design.check_network(job.network)?;
        self.check_design(job.design)?;
        self.link.set_checked(PROTECTION, PROTECTED)?;
        let registers = self.link.read(WEIGHTS_HASH, 3)?;
        let in_use = bank_of(registers[1]);
        let is_alone = job.design.sets().len() == 1;
        let target = target(job.design, job.bank, in_use);
        let hash = weights_hash(job.design, job.network);
        if is_alone {
            // No frame is made until its words are right, and they are those of no bank in use.
            self.change_control(WEIGHT_SET | RUN, control_bit(other(target)))?;
        } else if target == in_use {
            // The other bank's pictures until this one's are right.
            self.change_control(WEIGHT_SET, control_bit(other(in_use)))?;
        }
        self.wait_for(other(target))?;
        let kept = self.keep(job, other(target))?;
        // A load of the only bank that was interrupted left the other one in use.
        let runs = if is_alone && in_use != target { RUN } else { registers[1] & RUN };
        let then = if is_alone { kept.control | runs } else { kept.control };
        self.link.set(SCRATCH, mark(hash))?;
        let switches = is_alone || job.bank.is_none() || target == in_use;
        let mut recovered = false;
        for _ in 0..ROUNDS {
            let mut loaded = self.fill(job, target, &kept, hash, progress)?;
            if switches {
                self.switch_from(then, target, hash)?;
            }
            if self.link.read(SCRATCH, 1)? == [mark(hash)] {
                self.link.set_checked(PROTECTION, PROTECTED)?;
                loaded.in_use = letter(if switches { target } else { in_use });
                loaded.recovered |= recovered;
                return Ok(loaded);
            }
            // A reset at the last moment.
            recovered |= self.recover(&kept, hash, SEALED)?;
        }
        let (bank, active) = (letter(target), letter(kept.bank));
        Err(Error::NotLoaded { port: self.port(), bank, active, wrong: 0, rounds: ROUNDS })
    }

    /// Writes a bank that is not in use until all of it is right. It takes no words then.
    fn fill(
        &mut self,
        job: &Job<'_>,
        target: Set,
        kept: &Kept,
        hash: u32,
        progress: Progress<'_>,
    ) -> Result<Loaded, Error> {
        let wanted = parts(job.design, job.network, target);
        let all: Vec<&Part> = wanted.iter().collect();
        let mut loaded = Loaded {
            bank: letter(target),
            in_use: letter(kept.bank),
            parts: wanted.len(),
            written_parts: 0,
            words: 0,
            words_of_network: wanted.iter().map(|part| part.words().len() as u64).sum(),
            rounds: 0,
            recovered: false,
            weights_hash: hash,
        };
        self.link.set_checked(PROTECTION, SEALED)?;
        let of_network = loaded.words_of_network;
        let mut found: Vec<Option<u32>> = match job.full {
            true => vec![None; all.len()],
            false => self.found(&all, &mut || progress(0, of_network))?,
        };
        let bases: Vec<Vec<Part>> = match job.full {
            true => vec![],
            false => job.known.iter().map(|network| parts(job.design, network, target)).collect(),
        };
        let (port, bank, active) = (self.port(), letter(target), letter(kept.bank));
        let not_loaded = |wrong| Error::NotLoaded { port: port.clone(), bank, active, wrong, rounds: ROUNDS };
        let mut restored = 0;
        loop {
            let missing: Vec<Vec<(u32, u32)>> =
                wanted.iter().zip(&found).map(|(part, crc)| missing(part, *crc, &bases)).collect();
            let wrong = missing.iter().filter(|words| !words.is_empty()).count();
            if wrong == 0 {
                // What asked for the CRCs may have gone astray itself, into registers of the stages.
                let astray = self.restore_stages(kept, &wanted)? | self.recover(kept, hash, SEALED)?;
                if !astray {
                    break;
                }
                loaded.recovered = true;
                restored += 1;
                if restored == ROUNDS {
                    return Err(not_loaded(wrong));
                }
                found = self.found(&all, &mut || progress(loaded.words, loaded.words))?;
                continue;
            }
            if loaded.rounds == ROUNDS {
                return Err(not_loaded(wrong));
            }
            loaded.rounds += 1;
            loaded.written_parts = loaded.written_parts.max(wrong);
            loaded.recovered |= self.send(&missing, kept, hash, progress)?;
            let total = missing.iter().map(|words| words.len() as u64).sum();
            loaded.words += total;
            found = self.found(&all, &mut || progress(total, total))?;
            loaded.recovered |= self.recover(kept, hash, SEALED)?;
            if job.read_back && found.iter().zip(&all).all(|(crc, part)| *crc == Some(part.crc)) {
                let differences = self.rows_unlike(&all, &mut |_, _| progress(total, total))?;
                for (index, _) in differences {
                    found[index] = None;
                }
            }
        }
        Ok(loaded)
    }

    /// The CRC of each part, where words are counted and not rows.
    fn found(
        &mut self,
        parts: &[&Part],
        goes_on: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Vec<Option<u32>>, Error> {
        Ok(self.crcs(parts, &mut |_, _| goes_on())?.into_iter().map(Some).collect())
    }

    /// Writes the missing words of each part into the bank, which takes words meanwhile; whether what must stay as it is had to be put back.
    fn send(
        &mut self,
        missing: &[Vec<(u32, u32)>],
        kept: &Kept,
        hash: u32,
        progress: Progress<'_>,
    ) -> Result<bool, Error> {
        let total = missing.iter().map(|words| words.len() as u64).sum();
        let (mut done, mut recovered) = (0, false);
        self.link.set_checked(PROTECTION, PROTECTED)?;
        for words in missing.iter().filter(|words| !words.is_empty()) {
            for (address, some) in frames(words, MAX_WORDS) {
                if progress(done, total).is_break() {
                    return Err(Error::Interrupted);
                }
                self.link.write(address, &some)?;
                done += some.len() as u64;
            }
            recovered |= self.recover(kept, hash, PROTECTED)?;
        }
        self.link.set_checked(PROTECTION, SEALED)?;
        Ok(recovered)
    }

    /// Puts shifts of the bank that was written and what is skipped right where they are not; whether there were any. Its own commands lie in
    /// no other register, even where a byte of their address is lost.
    fn restore_stages(&mut self, kept: &Kept, wanted: &[Part]) -> Result<bool, Error> {
        let shifts = wanted.iter().filter(|part| part.is_shifts()).map(|part| part.rows[0] as u32).collect();
        let expected: [(usize, Vec<u32>); 2] =
            [(other(kept.bank) as usize, shifts), (SKIP_ROW, kept.skips.clone())];
        let mut wrong = vec![];
        for (row, words) in expected {
            let found = self.stage_register(kept.skips.len(), row)?;
            let differs = |(stage, word): &(usize, u32)| found[*stage] != *word;
            wrong.extend(
                words.into_iter().enumerate().filter(differs).map(|(stage, word)| (stage, row, word)),
            );
        }
        if wrong.is_empty() {
            return Ok(false);
        }
        self.link.set_checked(PROTECTION, PROTECTED)?;
        for (stage, row, word) in wrong {
            self.set_stage_register(stage, row, word)?;
        }
        self.link.set_checked(PROTECTION, SEALED)?;
        Ok(true)
    }

    /// Notes what must stay as it is. The bank in use needs no note: it takes no words.
    fn keep(&mut self, job: &Job<'_>, bank: Set) -> Result<Kept, Error> {
        self.agreed("what must stay as it is", |board| board.note(job, bank))
    }

    fn note(&mut self, job: &Job<'_>, bank: Set) -> Result<Kept, Error> {
        let registers = self.link.read(WEIGHTS_HASH, 2)?;
        let skips = self.stage_register(job.design.stages.len(), SKIP_ROW)?;
        Ok(Kept { bank, control: registers[1], hash: registers[0], skips })
    }

    /// Puts registers back that a reset or a word that went astray has changed, with what `protection` should be; whether there were any. A reset
    /// leaves the bank in use, and what the stages hold.
    fn recover(&mut self, kept: &Kept, hash: u32, protection: u32) -> Result<bool, Error> {
        let expected = [kept.hash, kept.control, mark(hash), protection];
        if self.link.glance(WEIGHTS_HASH, 4)? == expected || self.link.read(WEIGHTS_HASH, 4)? == expected {
            return Ok(false);
        }
        self.link.set_checked(PROTECTION, protection)?;
        self.link.set_checked(CONTROL, kept.control)?;
        self.link.set(WEIGHTS_HASH, kept.hash)?;
        self.link.set(SCRATCH, mark(hash))?;
        Ok(true)
    }

    /// What of a bank is not as a network wants it; with `read_back` every word is compared, too. `progress` receives rows.
    ///
    /// # Errors
    /// A network that does not fit, a line that fails, or [`Error::Interrupted`].
    pub fn verify(
        &mut self,
        design: &Design,
        network: &FixedNetwork,
        bank: Set,
        read_back: bool,
        progress: Progress<'_>,
    ) -> Result<Vec<Difference>, Error> {
        network.check()?;
        design.check_network(network)?;
        self.check_design(design)?;
        let wanted = parts(design, network, bank);
        let all: Vec<&Part> = wanted.iter().collect();
        let more = if read_back { rows_in(&all) } else { 0 };
        let mut of_crcs = 0;
        let crcs = self.crcs(&all, &mut |done, total| {
            of_crcs = total;
            progress(done, total + more)
        })?;
        let mut of_rows = |done, total| progress(of_crcs + done, of_crcs + total);
        let rows = if read_back { self.rows_unlike(&all, &mut of_rows)? } else { vec![] };
        let difference = |(index, (part, crc)): (usize, (&Part, &u32))| {
            let row = rows.iter().find(|(other, _)| *other == index).map(|(_, row)| *row);
            let wrong = *crc != part.crc || row.is_some();
            wrong.then(|| Difference { part: part.to_string(), crc: *crc, expected: part.crc, row })
        };
        Ok(wanted.iter().zip(&crcs).enumerate().filter_map(difference).collect())
    }

    /// Writes the hash of the network in the bank in use, which was seen to be there: what a lost clock put in doubt is checked. Nothing is
    /// written for the other bank.
    ///
    /// # Errors
    /// A line that fails.
    pub fn confirm(&mut self, design: &Design, network: &FixedNetwork, bank: Set) -> Result<(), Error> {
        if bank == self.bank()? {
            self.link.set(WEIGHTS_HASH, weights_hash(design, network))?;
        }
        Ok(())
    }

    /// Reads every row of some parts: those parts with a row that differs, and the first such row.
    fn rows_unlike(&mut self, parts: &[&Part], progress: Progress<'_>) -> Result<Vec<(usize, usize)>, Error> {
        let total = rows_in(parts);
        let (mut done, mut unlike) = (0, vec![]);
        for (index, part) in parts.iter().enumerate() {
            let mut first = None;
            for (number, row) in part.rows.iter().enumerate() {
                if progress(done, total).is_break() {
                    return Err(Error::Interrupted);
                }
                let answer = self.read_back(&[(part.stage, part.row_command(number))], &mut unwatched)?;
                if first.is_none() && answer[0].row != *row {
                    first = Some(number);
                }
                done += 1;
            }
            unlike.extend(first.map(|row| (index, row)));
        }
        Ok(unlike)
    }

    /// What of the display's tables is not as a display wants it.
    ///
    /// # Errors
    /// As [`Board::crcs`].
    pub fn verify_tables(
        &mut self,
        display: &Display,
        progress: Progress<'_>,
    ) -> Result<Vec<Difference>, Error> {
        let wanted = table_parts(display);
        let crcs = self.crcs(&wanted.iter().collect::<Vec<_>>(), progress)?;
        let differs = |(part, crc): (&Part, &u32)| {
            let told = Difference { part: part.to_string(), crc: *crc, expected: part.crc, row: None };
            (*crc != part.crc).then_some(told)
        };
        Ok(wanted.iter().zip(&crcs).filter_map(differs).collect())
    }

    /// Writes what the board does not have of the tables of the display step, until the circuit's CRCs say that all is there; how many
    /// words. There is one of each table, so the picture stands still meanwhile, and no frame is made with parts of two.
    ///
    /// # Errors
    /// A line that fails, [`Error::TablesNotLoaded`], or [`Error::Interrupted`]: the picture then stands still until the tables are loaded.
    pub fn load_tables(&mut self, display: &Display, progress: Progress<'_>) -> Result<u64, Error> {
        let wanted = table_parts(display);
        let all: Vec<&Part> = wanted.iter().collect();
        let control = self.control()?;
        let in_all: u64 = all.iter().map(|part| part.words().len() as u64).sum();
        let mut sent = 0;
        for round in 0..=ROUNDS {
            let found = self.crcs(&all, &mut |_, _| progress(sent.min(in_all), in_all))?;
            let missing: Vec<(u32, u32)> = all
                .iter()
                .zip(found)
                .filter(|(part, crc)| part.crc != *crc)
                .flat_map(|(part, _)| part.words())
                .collect();
            if missing.is_empty() {
                if round > 0 {
                    self.link.set_checked(CONTROL, (control | RUN) & !FLUSH)?;
                }
                return Ok(sent);
            }
            // The frame in progress is dropped, and none is begun.
            self.link.set_checked(CONTROL, (control & !RUN) | FLUSH)?;
            let total = missing.len() as u64;
            let mut done = 0;
            for (address, some) in frames(&missing, MAX_WORDS) {
                if progress(done, total).is_break() {
                    return Err(Error::Interrupted);
                }
                self.link.write(address, &some)?;
                done += some.len() as u64;
            }
            sent += done;
        }
        Err(Error::TablesNotLoaded { port: self.port(), rounds: ROUNDS })
    }
}

/// All rows of some parts.
fn rows_in(parts: &[&Part]) -> u64 {
    parts.iter().map(|part| part.rows.len() as u64).sum()
}

/// Words of a part that the board does not have yet, as far as the CRC of its words shows.
fn missing(part: &Part, found: Option<u32>, bases: &[Vec<Part>]) -> Vec<(u32, u32)> {
    if found == Some(part.crc) {
        return vec![];
    }
    let base = bases.iter().flatten().find(|base| base.is_at(part) && Some(base.crc) == found);
    base.map_or_else(|| part.words(), |base| part.words_unlike(base))
}
