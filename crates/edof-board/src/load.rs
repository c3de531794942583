//! Networks onto a board, and whether they are there.
//!
//! A load writes a bank that is not in use, has the circuit make a CRC of every part of it, writes what is wrong once more, and has frames
//! made with it only when all is right. What is in use is looked at before and after: a reset of the board, or a word that went
//! astray, is seen, and what it changed is put back.

use crate::board::{Board, SKIP_ROW, bank_of, control_bit};
use crate::contents::{Part, frames, letter, other, parts};
use crate::error::Error;
use crate::line::Line;
use crate::protocol::MOST_WORDS;
use edof_golden::Display;
use edof_spec::design::memory::Set;
use edof_spec::display::LUMA_ENTRIES;
use edof_spec::registers::identity::weights_hash;
use edof_spec::registers::map::{CONTROL, DISPLAY_TABLES, FLUSH, RUN, SCRATCH, WEIGHT_SET, WEIGHTS_HASH};
use edof_spec::{Design, FixedNetwork};
use serde::Serialize;

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

/// Told how many words of how many are there; whether to go on.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64) -> bool;

/// What a load did.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Loaded {
    /// The bank that was written.
    pub bank: char,
    /// The bank that is in use.
    pub in_use: char,
    /// Parts of the bank.
    pub parts: usize,
    /// Of these, how many were not there yet.
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
struct Kept {
    bank: Set,
    control: u32,
    hash: u32,
    /// Shifts of the bank in use, and what is skipped, of each stage.
    shifts: Vec<u32>,
    skips: Vec<u32>,
    /// Parts of the bank in use (their contents are another network's), and their CRCs.
    parts: Vec<Part>,
    crcs: Vec<u32>,
}

/// What stands in `scratch` during a load: a reset clears it.
fn mark(hash: u32) -> u32 {
    hash | 1
}

impl<L: Line> Board<L> {
    /// Loads a network.
    ///
    /// # Errors
    /// A network that does not fit, before anything is written; a line that fails; [`Error::NotLoaded`]; [`Error::Interrupted`] when
    /// `progress` says so. What was in use then still is.
    pub fn load(&mut self, job: &Job<'_>, progress: Progress<'_>) -> Result<Loaded, Error> {
        job.network.check()?;
        job.design.check_network(job.network)?;
        self.check_design(job.design)?;
        let registers = self.link.read(WEIGHTS_HASH, 3)?;
        let in_use = bank_of(registers[1]);
        let target = job.bank.unwrap_or(other(in_use));
        let hash = weights_hash(job.design, job.network);
        if target == in_use {
            // The other bank's pictures until this one's are right.
            self.change_control(WEIGHT_SET, control_bit(other(in_use)))?;
        }
        let kept = self.keep(job, other(target))?;
        self.link.set(SCRATCH, mark(hash))?;
        let switches = job.bank.is_none() || target == in_use;
        let mut recovered = false;
        for _ in 0..ROUNDS {
            let written = self.fill(job, target, &kept, hash, progress);
            if written.is_err() && target == in_use {
                // As far as it still can be: the error tells of the rest.
                let _ = self.change_control(WEIGHT_SET, control_bit(in_use));
            }
            let mut loaded = written?;
            if switches {
                self.switch(target, hash)?;
            }
            if self.link.read(SCRATCH, 1)? == [mark(hash)] {
                loaded.in_use = letter(if switches { target } else { in_use });
                loaded.recovered |= recovered;
                return Ok(loaded);
            }
            // A reset at the last moment.
            recovered |= self.recover(&kept, hash)?;
        }
        let (bank, active) = (letter(target), letter(kept.bank));
        Err(Error::NotLoaded { port: self.port(), bank, active, wrong: 0, rounds: ROUNDS })
    }

    /// Writes a bank that is not in use until all of it is right.
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
        let mut found: Vec<Option<u32>> = match job.full {
            true => vec![None; all.len()],
            false => self.crcs(&all)?.into_iter().map(Some).collect(),
        };
        let bases: Vec<Vec<Part>> = match job.full {
            true => vec![],
            false => job.known.iter().map(|network| parts(job.design, network, target)).collect(),
        };
        loop {
            let missing: Vec<Vec<(u32, u32)>> =
                wanted.iter().zip(&found).map(|(part, crc)| missing(part, *crc, &bases)).collect();
            let wrong = missing.iter().filter(|words| !words.is_empty()).count();
            if wrong == 0 {
                loaded.recovered |= self.mend(kept, job)?;
                // What asked for the CRCs may have gone astray itself, into registers of the stages.
                let astray = self.restore_stages(kept, &wanted)? | self.recover(kept, hash)?;
                if !astray {
                    break;
                }
                loaded.recovered = true;
                found = self.crcs(&all)?.into_iter().map(Some).collect();
                continue;
            }
            if loaded.rounds == ROUNDS {
                let (bank, active) = (letter(target), letter(kept.bank));
                return Err(Error::NotLoaded { port: self.port(), bank, active, wrong, rounds: ROUNDS });
            }
            loaded.rounds += 1;
            loaded.written_parts = loaded.written_parts.max(wrong);
            let total = missing.iter().map(|words| words.len() as u64).sum();
            let mut done = 0;
            for words in missing.iter().filter(|words| !words.is_empty()) {
                for (address, some) in frames(words, MOST_WORDS) {
                    if !progress(done, total) {
                        return Err(Error::Interrupted);
                    }
                    self.link.write(address, &some)?;
                    done += some.len() as u64;
                }
                loaded.recovered |= self.recover(kept, hash)?;
            }
            loaded.words += done;
            found = self.crcs(&all)?.into_iter().map(Some).collect();
            loaded.recovered |= self.recover(kept, hash)?;
            if job.read_back && found.iter().zip(&all).all(|(crc, part)| *crc == Some(part.crc)) {
                let differences = self.rows_unlike(&all, &mut |_, _| progress(total, total))?;
                for (index, _) in differences {
                    found[index] = None;
                }
            }
        }
        Ok(loaded)
    }

    /// Puts shifts of both banks and what is skipped right where they are not; whether there were any. Its own commands lie in no other
    /// register, even where a byte of their address is lost.
    fn restore_stages(&mut self, kept: &Kept, wanted: &[Part]) -> Result<bool, Error> {
        let stages = kept.shifts.len();
        let shifts = wanted.iter().filter(|part| part.is_shifts()).map(|part| part.rows[0] as u32).collect();
        let expected = [
            (kept.bank as usize, kept.shifts.clone()),
            (other(kept.bank) as usize, shifts),
            (SKIP_ROW, kept.skips.clone()),
        ];
        let mut changed = false;
        for (row, words) in expected {
            let found = self.stage_register(stages, row)?;
            for (stage, word) in words.into_iter().enumerate().filter(|(stage, word)| found[*stage] != *word)
            {
                self.set_stage_register(stage, row, word)?;
                changed = true;
            }
        }
        Ok(changed)
    }

    /// Notes what must stay as it is.
    fn keep(&mut self, job: &Job<'_>, bank: Set) -> Result<Kept, Error> {
        let registers = self.link.read(WEIGHTS_HASH, 2)?;
        let stages = job.design.stages.len();
        let (shifts, skips) =
            (self.stage_register(stages, bank as usize)?, self.stage_register(stages, SKIP_ROW)?);
        let parts = parts(job.design, job.network, bank);
        let crcs = self.crcs(&parts.iter().collect::<Vec<_>>())?;
        Ok(Kept { bank, control: registers[1], hash: registers[0], shifts, skips, parts, crcs })
    }

    /// Puts registers back that a reset or a word that went astray has changed; whether there were any.
    fn recover(&mut self, kept: &Kept, hash: u32) -> Result<bool, Error> {
        let expected = [kept.hash, kept.control, mark(hash)];
        if self.link.glance(WEIGHTS_HASH, 3)? == expected || self.link.read(WEIGHTS_HASH, 3)? == expected {
            return Ok(false);
        }
        // What was in use first, then that it is in use again.
        for (stage, (shifts, skip)) in kept.shifts.iter().zip(&kept.skips).enumerate() {
            self.set_stage_register(stage, kept.bank as usize, *shifts)?;
            self.set_stage_register(stage, SKIP_ROW, *skip)?;
        }
        for (address, word) in [WEIGHTS_HASH, CONTROL, SCRATCH].into_iter().zip(expected) {
            self.link.set(address, word)?;
        }
        Ok(true)
    }

    /// Puts parts of the bank in use back that a word went astray into, as far as their network is known; whether there were any.
    fn mend(&mut self, kept: &Kept, job: &Job<'_>) -> Result<bool, Error> {
        let found = self.crcs(&kept.parts.iter().collect::<Vec<_>>())?;
        let spoilt: Vec<usize> = (0..found.len()).filter(|i| found[*i] != kept.crcs[*i]).collect();
        if spoilt.is_empty() {
            return Ok(false);
        }
        let networks = job.known.iter().chain([job.network]);
        let known: Vec<Part> = networks.flat_map(|network| parts(job.design, network, kept.bank)).collect();
        let mut wrong = 0;
        for index in spoilt {
            let right =
                known.iter().find(|part| part.is_at(&kept.parts[index]) && part.crc == kept.crcs[index]);
            wrong += usize::from(right.is_none());
            for (address, some) in frames(&right.map_or(vec![], Part::words), MOST_WORDS) {
                self.link.write(address, &some)?;
            }
        }
        // Where the other bank comes into use now, nobody needs this one any more.
        if wrong > 0 && job.bank.is_some() {
            return Err(Error::Spoilt { port: self.port(), bank: letter(kept.bank), wrong });
        }
        Ok(true)
    }

    /// What of a bank is not as a network wants it; with `read_back` every word is compared, too.
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
        let crcs = self.crcs(&all)?;
        let rows = if read_back { self.rows_unlike(&all, progress)? } else { vec![] };
        let difference = |(index, (part, crc)): (usize, (&Part, &u32))| {
            let row = rows.iter().find(|(other, _)| *other == index).map(|(_, row)| *row);
            let wrong = *crc != part.crc || row.is_some();
            wrong.then(|| Difference { part: part.to_string(), crc: *crc, expected: part.crc, row })
        };
        Ok(wanted.iter().zip(&crcs).enumerate().filter_map(difference).collect())
    }

    /// Reads every row of some parts: those parts with a row that differs, and the first such row.
    fn rows_unlike(&mut self, parts: &[&Part], progress: Progress<'_>) -> Result<Vec<(usize, usize)>, Error> {
        let total = parts.iter().map(|part| part.rows.len() as u64).sum();
        let (mut done, mut unlike) = (0, vec![]);
        for (index, part) in parts.iter().enumerate() {
            let mut first = None;
            for (number, row) in part.rows.iter().enumerate() {
                if !progress(done, total) {
                    return Err(Error::Interrupted);
                }
                let answer = self.read_back(&[(part.stage, part.row_command(number))])?;
                if first.is_none() && answer[0].row != *row {
                    first = Some(number);
                }
                done += 1;
            }
            unlike.extend(first.map(|row| (index, row)));
        }
        Ok(unlike)
    }

    /// Writes the tables of the display step. There is one of each, so the picture stands still meanwhile, and no frame is made with parts
    /// of two; they cannot be read back.
    ///
    /// # Errors
    /// A line that fails, or [`Error::Interrupted`]: the picture then stands still until the tables are loaded.
    pub fn load_tables(&mut self, display: &Display, progress: Progress<'_>) -> Result<u64, Error> {
        let words = table_words(display);
        let control = self.control()?;
        self.link.set(CONTROL, (control & !RUN) | FLUSH)?;
        let (mut done, total) = (0, words.len() as u64);
        for (address, some) in frames(&words, MOST_WORDS) {
            if !progress(done, total) {
                return Err(Error::Interrupted);
            }
            self.link.write(address, &some)?;
            done += some.len() as u64;
        }
        self.link.set(CONTROL, (control | RUN) & !FLUSH)?;
        Ok(total)
    }
}

/// Byte addresses and words of a display's tables.
#[must_use]
pub fn table_words(display: &Display) -> Vec<(u32, u32)> {
    let luma = display.luma.entries().iter().map(|code| u32::from(*code)).collect::<Vec<_>>();
    let colours = display.colours.iter().map(|t| t.entries().iter().map(|e| u32::from(*e)).collect());
    let words = |(table, entries): (usize, Vec<u32>)| {
        let at = move |entry: usize| DISPLAY_TABLES.word((table * LUMA_ENTRIES + entry) as u32);
        entries.into_iter().enumerate().map(move |(entry, word)| (at(entry), word))
    };
    [luma].into_iter().chain(colours).enumerate().flat_map(words).collect()
}

/// Words of a part that the board does not have yet, as far as the CRC of what it has tells.
fn missing(part: &Part, found: Option<u32>, bases: &[Vec<Part>]) -> Vec<(u32, u32)> {
    if found == Some(part.crc) {
        return vec![];
    }
    let base = bases.iter().flatten().find(|base| base.is_at(part) && Some(base.crc) == found);
    base.map_or_else(|| part.words(), |base| part.words_unlike(base))
}
