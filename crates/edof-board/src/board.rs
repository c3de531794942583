//! A board at the other end of a line: who it is, its registers by name, its calculator's stages.

use crate::contents::Part;
use crate::error::Error;
use crate::line::Line;
use crate::link::{ATTEMPTS, Link};
use crate::load::{Progress, unwatched};
use crate::names::Place;
use edof_device::design::memory::{self, CONTROL_SKIP, Set, Space};
use edof_device::design::reading::{READ_REGISTER, ReadBack, rows_of};
use edof_device::design::{Design, FrameSize};
use edof_device::registers::identity::design_hash;
use edof_device::registers::map::{self, STAGE_READS, WEIGHTS};
use serde::Serialize;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::time::Duration;

/// Who a board is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Identity {
    /// Version of its register map.
    pub version: u32,
    /// Of the design (`edof_device::registers::identity`).
    pub design_hash: u32,
    /// Columns of its frame.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Of the network in use.
    pub weights_hash: u32,
}

impl Identity {
    /// Which of some designs it is, if any, with the size of frames that the board has.
    pub fn design(&self, known: impl IntoIterator<Item = Design>) -> Option<Design> {
        let (width, height) = (self.width as usize, self.height as usize);
        let sized = |design: Design| Design { frame: FrameSize { width, height, ..design.frame }, ..design };
        known.into_iter().map(sized).find(|design| design_hash(design) == self.design_hash)
    }
}

/// What a stage read back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Answer {
    /// CRC of all rows.
    pub crc: u32,
    /// The last one.
    pub row: u64,
}

/// Times that what answers with another id is asked again.
const STALE: usize = 2;
/// Looks at a stage that reads before it is given up.
const MAX_LOOKS: usize = 2_000;
/// After N failures the line is left idle.
const LOOKS: usize = 50;

/// Looks at the patches that were made, one after the other the same, after which none are made.
const STILL: usize = 20;
const PATCHES: u32 = 0x64;

/// A board at the other end of a line.
pub struct Board<L> {
    pub(crate) link: Link<L>,
    /// Who it was when it was opened.
    pub identity: Identity,
}

impl<L: Line> Board<L> {
    /// The board at the other end, which answers within `patience` and the time that bytes are on the line.
    ///
    /// # Errors
    /// Nothing answers, no board of ours, or one whose registers this program does not know.
    pub fn open(line: L, patience: Duration) -> Result<Self, Error> {
        let mut link = Link::new(line, patience);
        let port = link.name();
        link.wait_out()?;
        let mut words = link.read(0, 5)?;
        for _ in 0..STALE {
            if words[0] == map::ID {
                break;
            }
            // Perhaps the answers to a host before, which has ended.
            link.settle()?;
            words = link.read(0, 5)?;
        }
        let [id, version, design_hash, size, weights_hash] = [0, 1, 2, 3, 4].map(|word| words[word]);
        if id != map::ID {
            return Err(Error::Stranger { port, found: id });
        }
        if version >> 16 != map::VERSION >> 16 || version < map::VERSION {
            return Err(Error::Version { port, found: version });
        }
        let (width, height) = (size & 0xffff, size >> 16);
        Ok(Self { link, identity: Identity { version, design_hash, width, height, weights_hash } })
    }

    /// What its line is called in messages.
    pub fn port(&self) -> String {
        self.link.name()
    }

    /// The line to it.
    pub const fn line(&mut self) -> &mut L {
        self.link.line()
    }

    /// Frames that had to be sent again so far.
    pub const fn repeats(&self) -> u64 {
        self.link.repeats
    }

    /// Of some designs, the one that this board has.
    ///
    /// # Errors
    /// [`Error::UnknownDesign`]: none of them.
    pub fn design(&self, known: impl IntoIterator<Item = Design>) -> Result<Design, Error> {
        let Identity { design_hash: hash, width, height, .. } = self.identity;
        let unknown = || Error::UnknownDesign { port: self.port(), hash, width, height };
        self.identity.design(known).ok_or_else(unknown)
    }

    /// # Errors
    /// [`Error::OtherDesign`]: the board has another one.
    pub fn check_design(&self, design: &Design) -> Result<(), Error> {
        let (found, expected) = (self.identity.design_hash, design_hash(design));
        let other = || Error::OtherDesign { port: self.port(), name: design.name.clone(), found, expected };
        if found == expected { Ok(()) } else { Err(other()) }
    }

    /// The value of what stands under a name.
    ///
    /// # Errors
    /// The register can only be written, or the line fails.
    pub fn get(&mut self, place: Place) -> Result<u32, Error> {
        place.check_read()?;
        Ok(place.of_word(self.link.glance(place.address(), 1)?[0]))
    }

    /// Gives what stands under a name a value, and makes sure that it has it where it can be read.
    ///
    /// # Errors
    /// The register can only be read, the value does not fit, or the line fails.
    pub fn set(&mut self, place: Place, value: u32) -> Result<(), Error> {
        let reads_back = place.reads_back();
        let before = if reads_back { self.link.read(place.address(), 1)?[0] } else { 0 };
        let word = place.into_word(value, before)?;
        if [map::CONTROL, map::PROTECTION].contains(&place.address()) {
            self.link.set_checked(place.address(), word)
        } else if reads_back {
            self.link.set(place.address(), word)
        } else {
            self.link.write(place.address(), &[word])
        }
    }

    /// The register `control`.
    ///
    /// # Errors
    /// The line fails.
    pub fn control(&mut self) -> Result<u32, Error> {
        Ok(self.link.read(map::CONTROL, 1)?[0])
    }

    /// Gives some bits of `control` the value that they have in `bits`; the rest stays.
    ///
    /// # Errors
    /// The line fails.
    pub fn change_control(&mut self, mask: u32, bits: u32) -> Result<(), Error> {
        let before = self.agreed("control", Self::control)?;
        self.link.set_checked(map::CONTROL, (before & !mask) | (bits & mask))
    }

    /// What two looks agree on with a pause between: a byte too many in flight stands before each later answer until the line rests, and all of them
    /// agree.
    pub(crate) fn agreed<T: PartialEq>(
        &mut self,
        what: &str,
        mut look: impl FnMut(&mut Self) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let mut last = look(self)?;
        for _ in 0..ATTEMPTS {
            self.link.come_to_rest()?;
            let found = look(self)?;
            if found == last {
                return Ok(found);
            }
            last = found;
        }
        Err(Error::Noisy { port: self.port(), what: what.to_owned(), tried: ATTEMPTS })
    }

    /// The bank for frames that begin now.
    ///
    /// # Errors
    /// The line fails.
    pub fn bank(&mut self) -> Result<Set, Error> {
        Ok(bank_of(self.control()?))
    }

    /// Has frames from the next one on made with a bank; `hash` is that of its network.
    ///
    /// # Errors
    /// The line fails.
    pub fn switch(&mut self, bank: Set, hash: u32) -> Result<(), Error> {
        let control = self.agreed("control", Self::control)?;
        self.switch_from(control, bank, hash)
    }

    /// [`Board::switch`] where it is known what `control` holds.
    pub(crate) fn switch_from(&mut self, control: u32, bank: Set, hash: u32) -> Result<(), Error> {
        // Before the switch: after it a load writes `protection` alone, and both banks are shut until then.
        self.link.set(map::WEIGHTS_HASH, hash)?;
        self.link.set_checked(map::CONTROL, (control & !map::WEIGHT_SET) | control_bit(bank))
    }

    /// Waits until no frame is made with the other bank any more, or none at all: nobody has to wait where no frames come.
    ///
    /// # Errors
    /// The line fails.
    pub(crate) fn wait_for(&mut self, bank: Set) -> Result<(), Error> {
        let (mut patches, mut still) = (None, 0);
        while still < STILL && !self.is_in_use(bank)? {
            let now = self.link.glance(PATCHES, 1)?[0];
            still = if patches == Some(now) { still + 1 } else { 0 };
            patches = Some(now);
        }
        Ok(())
    }

    /// Whether the last patch was made with that bank.
    ///
    /// # Errors
    /// The line fails.
    pub fn is_in_use(&mut self, bank: Set) -> Result<bool, Error> {
        let status = self.link.read(map::STATUS, 1)?[0];
        let of_last_patch = map::register("status").and_then(|register| register.field("weight_set"));
        Ok(of_last_patch.is_some_and(|field| (status & field.mask() != 0) == (bank == Set::Second)))
    }

    /// Drops the frame in progress; all that was written stays.
    ///
    /// # Errors
    /// The line fails.
    pub fn flush(&mut self) -> Result<(), Error> {
        // The line is so slow that the bit stands for long enough.
        self.change_control(map::FLUSH, map::FLUSH)?;
        self.change_control(map::FLUSH, 0)
    }

    /// Begins anew with the bank that is in use: drops the frame in progress, lets frames run, in colour, zeros skipped as the design says,
    /// sets up the video chips once more and starts the stages' counters anew. Weights, thresholds and shifts stay.
    ///
    /// # Errors
    /// The line fails.
    pub fn reset(&mut self, design: &Design) -> Result<(), Error> {
        let bank = self.control()? & map::WEIGHT_SET;
        let start = map::register("control").map_or(0, |register| register.reset) & !map::WEIGHT_SET;
        self.skip(design, design.skip_zeros)?;
        self.link.set(map::SCRATCH, 0)?;
        for word in [map::FLUSH, start | map::I2C_RESTART, start] {
            self.link.set_checked(map::CONTROL, bank | word)?;
        }
        self.snapshot()
    }

    /// Has all stages leave out zeros, or not.
    ///
    /// # Errors
    /// The line fails.
    pub fn skip(&mut self, design: &Design, on: bool) -> Result<(), Error> {
        let word = if on { CONTROL_SKIP } else { 0 };
        for stage in 0..design.stages.len() {
            self.set_stage_register(stage, SKIP_ROW, word)?;
        }
        Ok(())
    }

    /// Copies all counters of the stages to where they are shown, and starts them anew.
    ///
    /// # Errors
    /// The line fails.
    pub fn snapshot(&mut self) -> Result<(), Error> {
        self.link.write(WEIGHTS.word(memory::SNAPSHOT), &[0])
    }

    /// A register of a stage: shifts of set 0 and 1, and what is skipped (2).
    ///
    /// # Errors
    /// The line fails.
    pub fn stage_register(&mut self, stages: usize, row: usize) -> Result<Vec<u32>, Error> {
        let command = edof_device::design::reading::read_command(Space::Register { row }, 1);
        let commands: Vec<(usize, u32)> = (0..stages).map(|stage| (stage, command)).collect();
        Ok(self.read_back(&commands, &mut unwatched)?.into_iter().map(|answer| answer.row as u32).collect())
    }

    /// Writes a register of a stage.
    ///
    /// # Errors
    /// The line fails.
    pub fn set_stage_register(&mut self, stage: usize, row: usize, word: u32) -> Result<(), Error> {
        self.link.write(WEIGHTS.word(memory::address(stage, Space::Register { row })), &[word])
    }

    /// Has the circuit make a CRC of each part. `progress` receives the rows that were read and all rows, where stages that read at the same time count once.
    ///
    /// # Errors
    /// The line fails, a stage never comes to its end, or [`Error::Interrupted`].
    pub fn crcs(&mut self, parts: &[&Part], progress: Progress<'_>) -> Result<Vec<u32>, Error> {
        let commands: Vec<(usize, u32)> = parts.iter().map(|part| (part.stage, part.command())).collect();
        Ok(self.read_back(&commands, progress)?.into_iter().map(|answer| answer.crc).collect())
    }

    /// Gives commands to read to stages, one to each at a time, and waits for all answers; `progress` is as for [`Board::crcs`].
    pub(crate) fn read_back(
        &mut self,
        commands: &[(usize, u32)],
        progress: Progress<'_>,
    ) -> Result<Vec<Answer>, Error> {
        let stages = commands.iter().map(|(stage, _)| stage + 1).max().unwrap_or(0);
        let rounds = rounds(commands, stages);
        let rows =
            |round: &[usize]| round.iter().map(|index| rows_of(commands[*index].1) as u64).max().unwrap_or(0);
        let total = rounds.iter().map(|round| rows(round)).sum();
        let mut done = 0;
        let mut answers = vec![Answer::default(); commands.len()];
        for round in rounds {
            for index in &round {
                let (stage, command) = commands[*index];
                // Twice: where one is lost, no older answer is taken for this one's.
                for _ in 0..2 {
                    self.set_stage_register(stage, READ_REGISTER, command)?;
                }
            }
            let shown = self.shown(stages, &mut || progress(done, total))?;
            let word = |stage: usize, part: ReadBack| shown[4 * stage + part as usize];
            done += rows(&round);
            for index in round {
                let stage = commands[index].0;
                let row =
                    u64::from(word(stage, ReadBack::Low)) | u64::from(word(stage, ReadBack::High)) << 32;
                answers[index] = Answer { crc: word(stage, ReadBack::Crc), row };
            }
        }
        match progress(done, total) {
            ControlFlow::Continue(()) => Ok(answers),
            ControlFlow::Break(()) => Err(Error::Interrupted),
        }
    }

    /// What the stages show once none of them reads any more; each look asks whether to go on.
    fn shown(
        &mut self,
        stages: usize,
        goes_on: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Vec<u32>, Error> {
        let rest = |words: &[u32]| (0..stages).all(|stage| words[4 * stage + ReadBack::Busy as usize] == 0);
        for look in 1..=MAX_LOOKS {
            if goes_on().is_break() {
                return Err(Error::Interrupted);
            }
            // A byte too many in the first answer may hide a stage that still reads, so the second one must say it, too.
            if rest(&self.link.glance(STAGE_READS.address, 4 * stages)?) {
                let words = self.link.read(STAGE_READS.address, 4 * stages)?;
                if rest(&words) {
                    return Ok(words);
                }
            }
            // A byte too many would move all answers after it.
            if look % LOOKS == 0 {
                self.link.settle()?;
            }
        }
        let what = "what the stages read back".to_owned();
        Err(Error::Noisy { port: self.port(), what, tried: MAX_LOOKS as u32 })
    }
}

/// Commands of one stage each that are carried out at the same time, by their indices, in order.
fn rounds(commands: &[(usize, u32)], stages: usize) -> Vec<Vec<usize>> {
    let mut queues = vec![VecDeque::new(); stages];
    commands.iter().enumerate().for_each(|(index, (stage, _))| queues[*stage].push_back(index));
    std::iter::from_fn(|| {
        let round: Vec<usize> = queues.iter_mut().filter_map(VecDeque::pop_front).collect();
        (!round.is_empty()).then_some(round)
    })
    .collect()
}

/// Register of a stage that says what is skipped.
pub(crate) const SKIP_ROW: usize = 2;

/// The bank that `control` asks for.
pub(crate) const fn bank_of(control: u32) -> Set {
    if control & map::WEIGHT_SET == 0 { Set::First } else { Set::Second }
}

/// The bit of `control` that asks for a bank.
pub(crate) const fn control_bit(bank: Set) -> u32 {
    match bank {
        Set::First => 0,
        Set::Second => map::WEIGHT_SET,
    }
}
