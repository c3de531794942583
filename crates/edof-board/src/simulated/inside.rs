//! What lies behind the line of a simulated board: registers, stages, tables, chips, and the picture in progress.

mod checks;

pub(super) use checks::Checks;

use super::chips::Chips;
use super::faults::Faults;
use super::host_frame::HostFrame;
use super::memory::{self, Stage};
use super::uart::Bus;
use super::video::{self, Made, Pixels, Tables};
use edof_core::{DisplayMode, RawFrame};
use edof_device::Design;
use edof_device::design::StagePlan;
use edof_device::design::memory::{self as memory_map, Space, TABLES, WHOLE_CHAIN};
use edof_device::design::reading::{READ_REGISTER, ReadBack, crc};
use edof_device::design::timing::{READ_LATENCY, READ_PERIOD};
use edof_device::host_frame::HOST;
use edof_device::pattern::TILE;
use edof_device::registers::identity::design_hash;
use edof_device::registers::map::{self, DISPLAY_TABLES, REGISTERS, STAGE_COUNTERS, STAGE_READS, WEIGHTS};
use edof_device::registers::{Access, Window};
use edof_golden::cycle::estimate;
use edof_network::FixedNetwork;
use std::collections::BTreeMap;

/// Nanoseconds.
pub(super) type Time = u64;

/// Pictures that are remembered.
const REMEMBERED: usize = 64;

/// What lies behind the line.
pub(super) struct Inside {
    pub(super) design: Design,
    pub(super) like: FixedNetwork,
    pub(super) start_hash: u32,
    pub(super) stages: Vec<Stage>,
    /// When each stage, and the tables after them, have completed their read command.
    pub(super) reads_until: Vec<Time>,
    /// What was last read of the tables: CRC, row.
    pub(super) table_read: (u32, u64),
    pub(super) refused: u32,
    pub(super) tables: Tables,
    pub(super) controls: BTreeMap<u32, u32>,
    pub(super) counts: BTreeMap<&'static str, u32>,
    pub(super) stage_counts: [Vec<[u32; 4]>; 2],
    pub(super) now: Time,
    /// The video chips.
    pub(super) chips: Chips,
    pub(super) raw: RawFrame,
    /// Changes with every word of a set, or of a table.
    pub(super) versions: [u64; 3],
    pub(super) cached: Option<(Key, Option<Made>)>,
    /// The frame in progress, and when its picture is done.
    pub(super) begun: Option<(Key, Time)>,
    pub(super) load: Load,
    /// The camera has sent a frame that was not begun.
    pub(super) frame_waits: bool,
    /// A picture was made that was not shown.
    pub(super) picture_waits: bool,
    pub(super) last_set: usize,
    /// The calculator's clock was lost since `weights_hash` was written.
    pub(super) weights_unchecked: bool,
    pub(super) uart_broken: u32,
    pub(super) shown: Vec<Shown>,
    pub(super) mixed: u64,
    pub(super) checks: Checks,
    pub(super) faults: Faults,
    /// The tile that the host writes, and how often it did.
    pub(super) tile: Vec<u16>,
    pub(super) tile_version: u32,
    /// The frame that the host writes, its last whole one, and where the frame in the memory came from when `pattern.host` was set, or since.
    pub(super) host: HostFrame,
    pub(super) host_frame: Vec<u16>,
    pub(super) kept: Source,
}

/// Where the raw frames in the memory come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    Camera,
    Pattern(u32),
    /// The tile, and how often it was written.
    Tile(u32),
    /// The host's frame, and its check.
    Host(u32),
}

/// What a picture depends on: set, version of it, mode, version of the tables, raw frames.
pub(super) type Key = (usize, u64, bool, u64, Source);

/// Cycles that the calculator takes for a picture, and what of: without a picture yet, all values count.
pub(super) struct Load {
    of: Option<(Key, Vec<bool>)>,
    cycles: f64,
}

impl Load {
    /// For a design, and mean numbers of pairs that its stages multiply.
    pub(super) fn new(design: &Design, pairs: Option<&[f64]>) -> Self {
        let ahead = estimate(design, pairs);
        Self { of: None, cycles: ahead.cycles_per_patch * ahead.patches_per_frame as f64 }
    }
}

/// A picture that came out of a simulated board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Shown {
    /// All of it with the same words.
    Whole(Pixels),
    /// Words changed while it was made, or they make no picture.
    Mixed,
}

fn word_of(window: &Window, address: u32) -> Option<usize> {
    (window.address..window.address + window.bytes)
        .contains(&address)
        .then(|| (address - window.address) as usize / 4)
}

impl Inside {
    pub(super) fn power_on(&mut self) {
        self.controls = REGISTERS
            .iter()
            .filter(|register| register.access == Access::Control)
            .map(|register| (register.address, register.reset))
            .collect();
        self.controls.insert(map::WEIGHTS_HASH, self.start_hash);
        self.refused = 0;
        self.host.restart();
        self.counts.clear();
        self.chips.reset(self.now);
        self.forget();
    }

    /// All begins anew but the bank in use, the hash of its network, and what the calculator and the tables hold.
    pub(super) fn reset(&mut self) {
        let (hash, bank) = (self.controls.get(&map::WEIGHTS_HASH).copied(), self.control() & map::WEIGHT_SET);
        self.power_on();
        self.controls.extend(hash.map(|hash| (map::WEIGHTS_HASH, hash)));
        self.controls.insert(map::CONTROL, self.control() | bank);
    }

    /// The frame in progress, and what is being read.
    pub(super) fn forget(&mut self) {
        self.checks = Checks::default();
        self.begun = None;
        self.stages.iter_mut().for_each(Stage::forget);
        self.table_read = (0, 0);
        self.reads_until.fill(0);
    }

    /// Whether `protection` keeps a word out.
    pub(super) fn keeps_out(&self, address: u32, word: u32) -> bool {
        let protection = self.controls.get(&map::PROTECTION).copied().unwrap_or(0);
        let set = crate::board::bank_of(self.control());
        let both = protection & map::PROTECT_OTHER != 0;
        let of_bank = word_of(&WEIGHTS, address)
            .and_then(|index| memory_map::set_of(&self.design, index as u32))
            .is_some_and(|own| both || own == set);
        let of_table = word_of(&DISPLAY_TABLES, address).is_some() && self.control() & map::RUN != 0;
        let wants_check =
            address == map::PROTECTION || (address == map::CONTROL && protection & map::PROTECT_CONTROL != 0);
        (protection & map::PROTECT_BANK != 0 && (of_bank || of_table))
            || (wants_check && !map::is_checked(word))
    }

    pub(super) fn set_control(&mut self, address: u32, word: u32) {
        if address == map::PATTERN {
            self.kept = self.source();
            if word & HOST == 0 {
                self.host.restart();
            }
        }
        let register = REGISTERS.iter().find(|register| register.address == address);
        let mask = register.map_or(0, edof_device::registers::Register::mask);
        self.controls.insert(address, word & mask);
        if self.control() & map::FLUSH != 0 {
            self.checks = Checks::default();
            self.begun = None;
            self.stages.iter_mut().for_each(Stage::forget);
            let stages = self.stages.len();
            self.reads_until[..stages].fill(0);
        }
    }

    pub(super) fn control(&self) -> u32 {
        self.controls.get(&map::CONTROL).copied().unwrap_or(0)
    }

    pub(super) fn count(&mut self, name: &'static str, more: u64) {
        let count = self.counts.entry(name).or_default();
        *count = count.wrapping_add(more as u32);
    }

    pub(super) fn key(&self, set: usize) -> Key {
        let colour = self.control() & map::COLOUR != 0;
        (set, self.versions[set], colour, self.versions[2], self.source())
    }

    /// Where the raw frames in the memory come from.
    fn source(&self) -> Source {
        match self.controls.get(&map::PATTERN).copied().unwrap_or(0) {
            0 => Source::Camera,
            TILE => Source::Tile(self.tile_version),
            pattern if pattern & HOST != 0 => self.kept,
            pattern => Source::Pattern(pattern),
        }
    }

    /// Takes a word of the host's frame; when the frame is whole it is the one in the memory.
    fn write_frame(&mut self, index: u32, word: u32) {
        let is_chosen = self.controls.get(&map::PATTERN).is_some_and(|pattern| pattern & HOST != 0);
        if is_chosen && !self.host.write(index, word).is_empty() && self.host.is_whole() {
            self.host_frame = self.host.pixels().to_vec();
            self.kept = Source::Host(self.host.check());
        }
    }

    pub(super) fn network(&self, set: usize) -> Option<FixedNetwork> {
        memory::network(&self.design, &self.stages, set, &self.like)
    }

    /// When the picture in progress is done; without `run` it stands still.
    pub(super) fn done_at(&self) -> Option<Time> {
        self.begun.filter(|_| self.control() & map::RUN != 0).map(|(_, done)| done)
    }

    /// The end of a frame of the camera, and of one of the screen.
    pub(super) fn frame(&mut self) {
        let comes = self.chips.has_source();
        self.count("input_frames", comes.into());
        self.count("output_frames", 1);
        if !std::mem::take(&mut self.picture_waits) {
            self.count("output_late", 1);
        }
        self.frame_waits = true;
        self.begin();
    }

    /// Begins the newest frame, if the calculator is free and there is one.
    pub(super) fn begin(&mut self) {
        let control = self.control();
        let is_free = self.begun.is_none() && control & map::RUN != 0 && control & map::FLUSH == 0;
        if is_free && std::mem::take(&mut self.frame_waits) {
            self.count("raw_frames", 1);
            let key = self.key(usize::from(control & map::WEIGHT_SET != 0));
            let nanoseconds = self.load.cycles * 1e3 / self.design.clock_mhz;
            self.begun = Some((key, self.now + nanoseconds as Time));
        }
    }

    /// What a picture with these counters takes; the next one is taken to take as long.
    pub(super) fn measure(&mut self, key: Key, made: &Made) {
        let of = (key, self.stages.iter().map(Stage::skips).collect());
        if self.load.of.as_ref() == Some(&of) {
            return;
        }
        let counts = &made.counts;
        let pairs = |(index, stage): (usize, StagePlan)| match self.stages[index].skips() && index > 0 {
            true => counts.stages[index - 1].nonzeros as f64 / counts.patches.max(1) as f64,
            false => stage.inputs as f64,
        };
        let pairs: Vec<f64> = self.design.stages().enumerate().map(pairs).collect();
        self.load = Load { of: Some(of), ..Load::new(&self.design, Some(&pairs)) };
    }

    /// The picture in progress is done.
    pub(super) fn end(&mut self) {
        let Some((key, _)) = self.begun.take() else { return };
        let (set, ..) = key;
        self.last_set = set;
        // The mode counts with the frame's first codes; all else must stand still.
        let now = self.key(set);
        let whole = (now.1, now.3) == (key.1, key.3);
        let made = if whole { self.made(key) } else { None };
        self.count("picture_frames", 1);
        self.picture_waits = true;
        self.mixed += u64::from(made.is_none());
        let shown = made.as_ref().map_or(Shown::Mixed, |made| Shown::Whole(made.pixels.clone()));
        if self.shown.last() != Some(&shown) {
            self.shown.push(shown);
            if self.shown.len() > REMEMBERED {
                self.shown.remove(0);
            }
        }
        self.checks.frame(key);
        if let Some(made) = &made {
            self.measure(key, made);
            self.add(made);
        }
        self.begin();
    }

    /// Adds a picture's counters to those of the board.
    pub(super) fn add(&mut self, made: &Made) {
        let counts = &made.counts;
        self.count("patches", counts.patches);
        self.count("busy_cycles", self.load.cycles as u64);
        self.count("saturated_sums", counts.saturated_sums);
        self.count("clamped_chroma", made.shown.clamped_chroma);
        self.count("out_of_gamut", made.shown.out_of_gamut);
        for (sum, stage) in self.stage_counts[0].iter_mut().zip(&counts.stages) {
            let more =
                [stage.nonzeros, stage.saturated_results, stage.saturated_codes, stage.saturated_differences];
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum = sum.wrapping_add(more as u32));
        }
    }

    pub(super) fn made(&mut self, key: Key) -> Option<Made> {
        if let Some((known, made)) = &self.cached
            && *known == key
        {
            return made.clone();
        }
        let mode = if key.2 { DisplayMode::Colour } else { DisplayMode::Luma };
        let display = self.tables.display(mode);
        let network = self.network(key.0);
        let made = display.zip(network).and_then(|(display, n)| {
            let (network, raw) = self.computed(n, key);
            let mut made = video::made(network, &display, &raw)?;
            self.faults.spoil_codes(&mut made.pixels);
            Some(made)
        });
        self.cached = Some((key, made.clone()));
        made
    }

    pub(super) fn status(&self) -> u32 {
        // The memory is ready, a signal is there and fits, pictures leave, the video chips are set up.
        let pictures = u32::from(self.counts.get("picture_frames").is_some_and(|count| *count > 0));
        let source = 0b110 * u32::from(self.chips.has_source());
        let [done, failed] = self.chips.state().map(u32::from);
        // The calculator's clock runs.
        let unchecked = u32::from(self.weights_unchecked);
        1 | source
            | pictures << 3
            | done << 4
            | failed << 5
            | (self.last_set as u32) << 6
            | 1 << 8
            | unchecked << 9
    }

    /// The chips as they are by now, where one of their registers is looked at.
    pub(super) fn follow_chips(&mut self) {
        let word = |address: u32| self.controls.get(&address).copied().unwrap_or(0);
        let (settings, access) = (word(map::VIDEO_SETUP), word(map::CHIP_ACCESS));
        self.chips.pass_to(self.now, settings, access);
    }

    pub(super) fn register(&self, name: &str) -> u32 {
        let size = self.design.frame.width as u32 | (self.design.frame.height as u32) << 16;
        match name {
            "design_hash" => design_hash(&self.design),
            "frame_size" | "input_size" => size,
            "status" => self.status(),
            "uart_broken" => self.uart_broken,
            "frame_blocks" => self.host.blocks(),
            "frame_check" => self.host.check(),
            name if Chips::has(name) => self.chips.register(name),
            "writes_refused" => self.refused,
            "core_cycles" => self.cycles(u64::from(self.design.board.core_khz)),
            "screen_cycles" => self.cycles(self.pixel_kilohertz()),
            name if name.starts_with("check_") => self.checks.register(name),
            _ => self.counts.get(name).copied().unwrap_or(0),
        }
    }

    pub(super) fn stage_word(&self, index: usize) -> u32 {
        let (stage, counter) = (index / 4, index % 4);
        self.stage_counts[1].get(stage).map_or(0, |counts| counts[counter])
    }

    pub(super) fn read_word(&self, index: usize) -> u32 {
        let (stage, part) = (index / 4, (index % 4) as u32);
        let place = if stage == TABLES { self.stages.len() } else { stage };
        if part == ReadBack::Busy as u32 {
            return self.reads_until.get(place).map_or(0, |until| u32::from(self.now < *until));
        }
        let read =
            if stage == TABLES { Some(self.table_read) } else { self.stages.get(stage).map(Stage::read) };
        let Some((crc, row)) = read else { return 0 };
        match part {
            p if p == ReadBack::Crc as u32 => crc,
            p if p == ReadBack::Low as u32 => row as u32,
            _ => (row >> 32) as u32,
        }
    }

    /// A command to read tables.
    pub(super) fn read_tables(&mut self, command: u32) -> usize {
        let (bank, first) = ((command >> 24 & 0x3f) as usize, (command >> 12 & 0xfff) as usize);
        let count = (command & 0xfff) as usize + 1;
        let row = |row: usize| if command >> 30 == 0 { self.tables.row(bank, row % 4096) } else { 0 };
        let rows: Vec<u64> = (first..first + count).map(row).collect();
        self.table_read = (crc(rows.iter().copied()), rows[count - 1]);
        count
    }

    pub(super) fn write_stage(&mut self, index: u32, word: u32) {
        let stage = (index >> 21) as usize;
        if stage == WHOLE_CHAIN && index >> 19 & 3 == 3 {
            let counted = std::mem::take(&mut self.stage_counts[0]);
            self.stage_counts[0] = vec![[0; 4]; counted.len()];
            self.stage_counts[1] = counted;
            self.copy_checks();
            return;
        }
        let is_command = index & 0x1f_ffff == memory_map::address(0, Space::Register { row: READ_REGISTER });
        let (place, rows) = if stage == TABLES && is_command {
            (self.stages.len(), self.read_tables(word))
        } else {
            let Some(found) = self.stages.get_mut(stage) else { return };
            let (set, rows) = found.write(index & 0x1f_ffff, word);
            if let Some(set) = set {
                self.versions[set & 1] += 1;
            }
            (stage, rows)
        };
        if rows > 0 {
            let cycles = READ_LATENCY + rows as u64 * READ_PERIOD;
            let nanoseconds = cycles as f64 * 1e3 / self.design.clock_mhz;
            self.reads_until[place] = self.now + nanoseconds as Time;
        }
    }
}

impl Bus for Inside {
    fn write(&mut self, address: u32, word: u32) {
        if self.keeps_out(address, word) {
            self.refused = self.refused.wrapping_add(1);
        } else if let Some(index) = word_of(&WEIGHTS, address) {
            self.write_stage(index as u32, word);
        } else if let Some(index) = word_of(&DISPLAY_TABLES, address) {
            self.tables.write(index, word);
            self.versions[2] += 1;
        } else if let Some(index) = word_of(&map::TILE_PIXELS, address) {
            self.tile[index] = word as u16;
            self.tile_version += 1;
        } else if let Some(index) = word_of(&map::FRAME, address) {
            self.write_frame(index as u32, word);
        } else if self.controls.contains_key(&address) {
            self.follow_chips();
            let before = self.control();
            self.weights_unchecked &= address != map::WEIGHTS_HASH;
            self.set_control(address, word);
            if self.control() & !before & map::I2C_RESTART != 0 {
                self.chips.restart(self.now);
            }
        }
    }

    fn read(&mut self, address: u32) -> u32 {
        if let Some(index) = word_of(&STAGE_COUNTERS, address) {
            return self.stage_word(index);
        }
        if let Some(index) = word_of(&STAGE_READS, address) {
            return self.read_word(index);
        }
        if let Some(index) = word_of(&map::PICTURE_PIXELS, address) {
            return self.picture_word(index);
        }
        if let Some(word) = self.controls.get(&address) {
            return *word;
        }
        let Some(found) = REGISTERS.iter().find(|register| register.address == address) else { return 0 };
        if found.name == "status" || Chips::has(found.name) {
            self.follow_chips();
        }
        let start = if found.access == Access::Constant { found.reset } else { 0 };
        start | self.register(found.name)
    }
}
