//! Set-up and polling of chips on an I2C bus: what they get is what the model gives, whatever they reject; stuck lines, other masters and missing chips are distinguished from success, and the host gets at every register.

use crate::support;
use edof_board::simulated::setup::{ChipBus, Setup};
use edof_core::draw::Draw;
use edof_cosim::bench::{Actor, Bench, ClockId};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_device::i2c::{self, Action, Cause, Entry};
use edof_device::video::VideoTiming;
use edof_hdl::board::{ChipSetup, Pace};
use std::collections::BTreeMap;

/// Short bits and milliseconds make a short simulation.
const PACE: Pace =
    Pace { cycles_per_bit: 16, uart_time_out: 0, i2c_quarter: 8, millisecond: 40, screen: None };
/// Cycles that a transfer takes at most: 60 bits with nine clocks before them, and 1,600 quarters for which the clock line is held.
const TRANSFER: usize = (70 * 4 + 1600) * 8 + 2_000;
/// Entries of the memory in all of these tests, so that one model serves them.
const DEPTH: usize = 512;

/// Chips as memories, and what was written to them and read of them: device, register, value, whether it was read.
#[derive(Clone, Default)]
pub struct Chips {
    pub registers: BTreeMap<(u8, u8), u8>,
    pub missing: Vec<u8>,
    pointer: u8,
    pub log: Vec<(u8, u8, u8, bool)>,
}

impl Chips {
    /// Switches have no registers.
    const fn is_bare(device: u8) -> bool {
        matches!(device, 0x70 | 0x74)
    }

    fn knows(&self, device: u8) -> bool {
        !self.missing.contains(&device)
    }

    /// The byte of that place in a write.
    fn take(&mut self, device: u8, place: usize, byte: u8) {
        let register = if Self::is_bare(device) { 0 } else { self.pointer };
        if place == 0 && !Self::is_bare(device) {
            self.pointer = byte;
            return;
        }
        self.log.push((device, register, byte, false));
        // Written ones clear what has happened; all else is a memory.
        let held = self.registers.entry((device, register)).or_default();
        *held = if (device, register) == (0x39, 0x96) { *held & !byte } else { byte };
    }

    fn give(&mut self, device: u8) -> u8 {
        let register = if Self::is_bare(device) { 0 } else { self.pointer };
        // The receiver says that its EDID answers once it shall.
        let from = if (device, register) == (0x32, 0x76) { 0x74 } else { register };
        let value = self.registers.get(&(device, from)).copied().unwrap_or(0);
        self.log.push((device, register, value, true));
        value
    }

    /// How often a register was written.
    fn writes(&self, device: u8, register: u8) -> usize {
        self.log.iter().filter(|(d, r, _, read)| (*d, *r, *read) == (device, register, false)).count()
    }
}

impl ChipBus for Chips {
    fn write(&mut self, device: u8, bytes: &[u8]) -> Result<(), Cause> {
        if !self.knows(device) {
            return Err(Cause::Refused);
        }
        bytes.iter().enumerate().for_each(|(place, byte)| self.take(device, place, *byte));
        Ok(())
    }

    fn read(&mut self, device: u8, pointer: &[u8]) -> Result<u8, Cause> {
        self.write(device, pointer)?;
        Ok(self.give(device))
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Talk {
    /// Until the next start.
    Deaf,
    Hears,
    Acknowledges,
    Speaks,
    /// Waits for the master's acknowledgement.
    Asks,
}

/// The same chips on two wires.
pub struct Wire {
    clock: ClockId,
    /// `scl`, `sda`, `scl_low`, `sda_low`.
    ports: [usize; 4],
    pub chips: Chips,
    draw: Draw,
    /// Rejected bytes, in percent.
    refuses: i64,
    refused: usize,
    /// Cycles for which the clock is held low after a byte.
    stretch: u32,
    held: u32,
    /// Clocks for which the data line is held low.
    stuck: u32,
    /// Of a hundred thousand cycles, in how many another master pulls the data line down for a bit.
    disturbs: i64,
    disturbed: u32,
    talk: Talk,
    before: (bool, bool),
    device: Option<u8>,
    place: usize,
    bits: usize,
    byte: u8,
    low: bool,
    goes_on: bool,
}

impl Wire {
    fn new(source: &Source, clock: ClockId, chips: Chips, seed: u64) -> Self {
        Self {
            clock,
            ports: ["scl_i", "sda_i", "scl_low_o", "sda_low_o"].map(|port| source.port(port).unwrap()),
            chips,
            draw: Draw::new(seed),
            refuses: 0,
            refused: 0,
            stretch: 0,
            held: 0,
            stuck: 0,
            disturbs: 0,
            disturbed: 0,
            talk: Talk::Deaf,
            before: (true, true),
            device: None,
            place: 0,
            bits: 0,
            byte: 0,
            low: false,
            goes_on: false,
        }
    }

    fn moved(&mut self, scl: bool, sda: bool) {
        let (scl_before, sda_before) = self.before;
        if scl && scl_before && sda != sda_before {
            self.talk = if sda { Talk::Deaf } else { Talk::Hears };
            (self.device, self.place, self.bits, self.low) = (None, 0, 0, false);
        } else if scl && !scl_before {
            self.stuck = self.stuck.saturating_sub(1);
            self.goes_on = !sda;
            if matches!(self.talk, Talk::Hears | Talk::Speaks) {
                self.bits += 1;
                self.byte = self.byte << 1 | u8::from(sda);
            }
        } else if !scl && scl_before {
            self.fell();
        }
    }

    fn fell(&mut self) {
        match self.talk {
            Talk::Hears if self.bits == 8 => {
                let goes = self.draw.whole(0, 99) >= self.refuses;
                let known = self.device.is_some() || self.chips.knows(self.byte >> 1);
                self.refused += usize::from(known && !goes);
                self.talk = if known && goes { Talk::Acknowledges } else { Talk::Deaf };
                self.low = known && goes;
                self.held = self.stretch;
            }
            Talk::Acknowledges => {
                (self.low, self.bits) = (false, 0);
                self.talk = Talk::Hears;
                match self.device {
                    Some(device) => {
                        self.chips.take(device, self.place, self.byte);
                        self.place += 1;
                    }
                    None => {
                        self.device = Some(self.byte >> 1);
                        if self.byte & 1 == 1 {
                            self.speak();
                        }
                    }
                }
            }
            Talk::Speaks if self.bits < 8 => self.low = self.byte >> 7 == 0,
            Talk::Speaks => (self.talk, self.low) = (Talk::Asks, false),
            Talk::Asks if self.goes_on => self.speak(),
            Talk::Asks => self.talk = Talk::Deaf,
            _ => {}
        }
    }

    fn speak(&mut self) {
        self.byte = self.chips.give(self.device.unwrap());
        (self.talk, self.bits, self.low) = (Talk::Speaks, 0, self.byte >> 7 == 0);
    }
}

impl Actor for Wire {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        self.held = self.held.saturating_sub(1);
        self.disturbed = self.disturbed.saturating_sub(1);
        if self.disturbs > 0 && self.draw.whole(0, 99_999) < self.disturbs {
            self.disturbed = 40;
        }
        let scl = model.peek(self.ports[2])? == 0 && self.held == 0;
        let low = self.low || self.stuck > 0 || self.disturbed > 0;
        let sda = model.peek(self.ports[3])? == 0 && !low;
        self.moved(scl, sda);
        self.before = (scl, sda);
        model.poke(self.ports[0], scl.into())?;
        model.poke(self.ports[1], sda.into())
    }
}

pub struct Rig {
    bench: Bench,
    pub wire: Wire,
    _images: tempfile::TempDir,
}

impl Rig {
    pub fn new(program: &[Entry], chips: Chips, seed: u64) -> Self {
        let any = vec![Entry { action: Action::End, doc: "" }; DEPTH - 1];
        let source = Source::circuit(&mut ChipSetup::new(&PACE, &any, "mem/i2c.mem", false)).unwrap();
        let images = tempfile::tempdir().unwrap();
        std::fs::create_dir(images.path().join("mem")).unwrap();
        let padded: Vec<Entry> = program.iter().chain(&any).take(DEPTH - 1).copied().collect();
        std::fs::write(images.path().join("mem/i2c.mem"), i2c::image(&padded)).unwrap();
        let library = Library::build(&source, &support::options()).unwrap();
        let start = Start { seed, memory_dir: Some(images.path().into()) };
        let mut bench = Bench::new(library.start(&start).unwrap(), seed);
        let clock = bench.clock("clock_i", 5_000).unwrap();
        let mut wire = Wire::new(&source, clock, chips, seed);
        bench.set("settings_i", SETTINGS.into()).unwrap();
        for level in [1, 0] {
            bench.set("reset_i", level).unwrap();
            bench.steps(20, &mut [&mut wire]).unwrap();
        }
        Self { bench, wire, _images: images }
    }

    fn steps(&mut self, count: usize) {
        self.bench.steps(count, &mut [&mut self.wire]).unwrap();
    }

    fn until(&mut self, what: &str, is_so: impl Fn(&mut Self) -> bool) {
        for _ in 0..4_000 {
            if is_so(self) {
                return;
            }
            self.steps(1_000);
        }
        panic!("{what}: it does not come; word {:08x}", self.get("word_o"));
    }

    pub fn get(&mut self, port: &str) -> u64 {
        self.bench.get(port).unwrap()
    }

    pub fn done(&mut self) {
        self.until("done", |rig| rig.get("done_o") + rig.get("failed_o") > 0);
        assert_eq!((self.get("done_o"), self.get("failed_o")), (1, 0), "{:08x}", self.get("word_o"));
    }

    /// Fields of the word: entry, device, cause.
    fn failure(&mut self) -> (u64, u64, u64) {
        let word = self.get("word_o");
        assert_eq!(word >> 20 & 3, 2, "failed, and not done");
        (word & 0x3ff, word >> 10 & 0x7f, word >> 17 & 7)
    }

    /// The host's access of that number; value and cause.
    fn access(&mut self, word: u32, sequence: u32) -> (u32, u32) {
        self.bench.set("access_i", (word | sequence << 28).into()).unwrap();
        self.until("an answer", |rig| rig.get("answer_o") >> 28 == u64::from(sequence));
        let answer = self.get("answer_o") as u32;
        (answer & 0xff, answer >> 8 & 7)
    }
}

/// Bytes of the register `video_setup` that are like no others.
const SETTINGS: u32 = 0x5a_a1_9b_00;

/// A screen that is plugged in, whose EDID has the HDMI vendor block after false begins of it.
fn with_screen() -> Chips {
    let mut chips = Chips::default();
    chips.registers.extend([((0x39, 0x42), 0x60), ((0x39, 0x96), 0x84), ((0x3f, 0x80), 0x02)]);
    for (at, byte) in (0x84..).zip([0x41, 0x90, 0x03, 0x0c, 0x07, 0x65, 0x03, 0x0c, 0x00, 0x10]) {
        chips.registers.insert((0x3f, at), byte);
    }
    chips
}

/// A few polls of a program in the model.
pub fn modelled(program: &[Entry], chips: Chips, entries: usize) -> Setup<Chips> {
    let mut setup = Setup::new(chips, program.to_vec(), false);
    while setup.bus.log.len() < entries {
        setup.step(SETTINGS);
        assert!(!setup.has_failed(), "{:08x}", setup.word());
    }
    setup
}

#[test]
fn chips_get_what_the_model_gives_whatever_they_reject() {
    for (seed, program) in (0..).zip(i2c::programs(VideoTiming::P1080_60)) {
        let mut rig = Rig::new(&program, with_screen(), seed);
        (rig.wire.refuses, rig.wire.stretch) = (3, 50);
        rig.done();
        let entries = rig.wire.chips.log.len() + 200;
        rig.until("more polls", |rig| rig.wire.chips.log.len() >= entries);
        let model = modelled(&program, with_screen(), entries);
        assert!(rig.wire.refused > 5);
        // Reads of the screen's EDID are not repeated; all else is.
        assert!(rig.get("word_o") >> 22 > 5);
        let ours = |log: &[(u8, u8, u8, bool)]| -> Vec<(u8, u8, u8, bool)> {
            log.iter().filter(|(device, ..)| *device != 0x3f).copied().collect()
        };
        let (found, expected) = (ours(&rig.wire.chips.log), ours(&model.bus.log));
        let both = found.len().min(expected.len());
        // A rejected byte of the EDID may hide that the screen accepts HDMI.
        let differs = (0..both).find(|at| found[*at] != expected[*at]);
        assert!(
            differs.is_none_or(|at| found[at].1 == 0xaf),
            "{differs:?}: {:02x?}, not {:02x?}",
            differs.map(|at| found[at]),
            differs.map(|at| expected[at])
        );
    }
}

#[test]
fn without_refusals_slots_and_word_are_the_models() {
    for (seed, program) in (10..).zip(i2c::programs(VideoTiming::P1080_60)) {
        let mut chips = with_screen();
        let draw = &mut Draw::new(seed);
        for (device, register) in [(0x4c, 0x6a), (0x4c, 0x6f), (0x34, 0x05), (0x34, 0x08), (0x22, 0xff)] {
            chips.registers.insert((device, register), draw.bits() as u8);
        }
        let mut rig = Rig::new(&program, chips.clone(), seed);
        rig.done();
        let entries = rig.wire.chips.log.len() + 250;
        rig.until("more polls", |rig| rig.wire.chips.log.len() >= entries);
        let model = modelled(&program, chips, rig.wire.chips.log.len());
        assert_eq!(rig.wire.chips.log, model.bus.log[..rig.wire.chips.log.len()]);
        let slots = [0, 1, 2].map(|i| rig.get(&format!("slots_{i}_o")) as u32);
        assert_eq!(slots, [0, 4, 8].map(|first| model.slots(first)));
        assert_eq!(rig.get("word_o") >> 20, 1);
        if seed == 10 {
            // HDMI, since the screen says so; RGB.
            let kept = |register| rig.wire.chips.registers[&(0x39, register)];
            assert_eq!((kept(0xaf), kept(0x16), kept(0x96)), (0x06, 0x38, 0));
        }
    }
}

#[test]
fn a_screen_that_is_plugged_in_gets_the_whole_table_again() {
    let [program, _] = i2c::programs(VideoTiming::P1080_60);
    let mut rig = Rig::new(&program, Chips::default(), 3);
    rig.done();
    assert_eq!(rig.wire.chips.writes(0x39, 0xd6), 1);
    assert_eq!(rig.wire.chips.log.iter().find(|entry| entry.0 == 0x39).unwrap().1, 0xd6, "it comes first");
    for count in 2..4 {
        rig.wire.chips.registers.insert((0x39, 0x42), 0x40);
        rig.until("the table", |rig| rig.wire.chips.writes(0x39, 0xd6) == count);
        rig.steps(50_000);
        assert_eq!(rig.wire.chips.writes(0x39, 0xd6), count, "once");
        rig.wire.chips.registers.insert((0x39, 0x42), 0x00);
        rig.steps(50_000);
    }
    // A chip that has lost its power-up, and one whose hot plug was low between two looks.
    rig.wire.chips.registers.insert((0x39, 0x41), 0x50);
    rig.until("the table", |rig| rig.wire.chips.writes(0x39, 0xd6) == 4);
    rig.wire.chips.registers.insert((0x39, 0x42), 0x40);
    rig.until("the table", |rig| rig.wire.chips.writes(0x39, 0xd6) == 5);
    rig.wire.chips.registers.insert((0x39, 0x96), 0x80);
    rig.until("the table", |rig| rig.wire.chips.writes(0x39, 0xd6) == 6);
}

#[test]
fn a_receiver_that_was_reset_is_set_up_again_with_its_hot_plug_low() {
    let [_, program] = i2c::programs(VideoTiming::P1080_60);
    let mut rig = Rig::new(&program, Chips::default(), 4);
    rig.done();
    let log = &rig.wire.chips.log;
    let at = |entry: (u8, u8, u8, bool)| log.iter().position(|found| *found == entry).unwrap();
    // Reset is let go before anything is written to it, and hot plug rises after its EDID.
    assert!(at((0x20, 1, 0x01, false)) < at((0x4c, 0xf4, 0x80, false)));
    assert!(
        at((0x36, 0xff, i2c::edid::edid(VideoTiming::P1080_60)[255], false)) < at((0x32, 0x74, 0x01, false))
    );
    assert!(at((0x32, 0x74, 0x01, false)) < at((0x20, 1, 0x05, false)));
    let kept = |register| rig.wire.chips.registers[&(0x4c, register)];
    assert_eq!((kept(0x19), kept(0x06)), (0x9b, 0xa1), "as the host has it");
    rig.wire.chips.log.clear();
    rig.wire.chips.registers.insert((0x4c, 0x0c), 0x62);
    rig.until("hot plug", |rig| rig.wire.chips.log.contains(&(0x20, 1, 0x05, false)));
    assert!(rig.wire.chips.log.contains(&(0x20, 1, 0x01, false)));
}

#[test]
fn a_data_line_that_is_stuck_is_freed_by_clocks_or_told() {
    let [program, _] = i2c::programs(VideoTiming::P1080_60);
    let mut rig = Rig::new(&program, Chips::default(), 5);
    rig.done();
    let before = rig.get("word_o") >> 22;
    for clocks in [1, 5, 9] {
        rig.wire.stuck = clocks;
        rig.wire.talk = Talk::Deaf;
        let entries = rig.wire.chips.log.len() + 10;
        rig.until("more polls", |rig| rig.wire.chips.log.len() >= entries);
        assert_eq!(rig.get("failed_o"), 0);
    }
    // At most the transfer that was in flight was repeated.
    assert!(rig.get("word_o") >> 22 <= before + 3);
    rig.wire.stuck = u32::MAX;
    let entries = rig.wire.chips.log.len();
    // Eight attempts, each with its pause.
    rig.steps(8 * (TRANSFER + 100));
    let (_, device, cause) = rig.failure();
    assert!(device == 0x74 || device == 0x39);
    assert_eq!(cause, Cause::DataLow as u64);
    assert_eq!((rig.get("scl_low_o"), rig.get("sda_low_o"), rig.get("slots_0_o")), (0, 0, 0), "at rest");
    // A chip that listens sees zeros: a write to device 0.
    let heard = rig.wire.chips.log[entries..].iter().filter(|entry| entry.0 != 0).count();
    assert!(heard <= 1, "nothing succeeds on a line that is stuck");
    rig.wire.stuck = 0;
    rig.until("done", |rig| rig.get("done_o") == 1);
    assert_eq!(rig.get("failed_o"), 0);
}

#[test]
fn a_clock_line_that_is_held_is_reported_within_the_time_that_is_stated() {
    let [program, _] = i2c::programs(VideoTiming::P1080_60);
    let mut rig = Rig::new(&program, Chips::default(), 6);
    rig.done();
    rig.wire.held = u32::MAX;
    rig.steps(50 * 40 + 8 * (TRANSFER + 100));
    assert_eq!(rig.failure().2, Cause::ClockLow as u64);
    assert_eq!((rig.get("scl_low_o"), rig.get("sda_low_o")), (0, 0), "at rest");
    rig.wire.held = 0;
    rig.until("done", |rig| rig.get("done_o") == 1);
}

#[test]
fn another_master_only_delays() {
    let [program, _] = i2c::programs(VideoTiming::P1080_60);
    let mut rig = Rig::new(&program, Chips::default(), 7);
    rig.wire.disturbs = 60;
    rig.until("done", |rig| rig.get("done_o") == 1);
    rig.wire.disturbs = 0;
    let mut calm = Rig::new(&program, Chips::default(), 7);
    calm.done();
    let registers = |rig: &Rig| -> BTreeMap<(u8, u8), u8> {
        rig.wire.chips.registers.clone().into_iter().filter(|((device, _), _)| *device == 0x39).collect()
    };
    let expected = registers(&calm);
    assert!(expected.iter().all(|(register, value)| registers(&rig).get(register) == Some(value)));
    assert!(rig.get("word_o") >> 22 > 3, "it was never disturbed");
}

#[test]
fn a_chip_that_is_missing_is_reported_and_taken_up_when_it_comes() {
    let [_, program] = i2c::programs(VideoTiming::P1080_60);
    let missing = Chips { missing: vec![0x4c], ..Chips::default() };
    let mut rig = Rig::new(&program, missing, 8);
    rig.until("failed", |rig| rig.get("failed_o") == 1);
    let (entry, device, cause) = rig.failure();
    assert_eq!((program[entry as usize].action.device(), device), (Some(0x4c), 0x4c));
    assert_eq!((cause, rig.get("word_o") >> 22), (Cause::Refused as u64, 7));
    rig.wire.chips.missing.clear();
    rig.until("done", |rig| rig.get("done_o") == 1);
    assert_eq!(rig.get("failed_o"), 0);
    // An expander that does not keep the words written to it.
    let entries = rig.wire.chips.writes(0x20, 1);
    rig.bench.set("restart_i", 1).unwrap();
    rig.until("a restart", |rig| rig.wire.chips.writes(0x20, 1) > entries);
    assert_eq!(rig.get("done_o"), 0);
}

#[test]
fn a_register_that_reads_back_another_value_is_a_failure() {
    let step = |action| Entry { action, doc: "try" };
    let program = [
        step(Action::Read { device: 0x20, register: 9, slot: 3 }),
        step(Action::Until { tries: 2, mask: 0xf0, value: 0x50 }),
        step(Action::Done),
    ];
    let mut rig = Rig::new(&program, Chips::default(), 9);
    rig.until("failed", |rig| rig.get("failed_o") == 1);
    assert_eq!(rig.failure(), (1, 0x20, Cause::OtherValue as u64));
    assert_eq!(rig.wire.chips.log, [(0x20, 9, 0, true); 3], "one read and two more");
    rig.wire.chips.registers.insert((0x20, 9), 0x5f);
    rig.until("done", |rig| rig.get("done_o") == 1);
    assert_eq!(rig.get("slots_0_o"), 0x5f00_0000);
}

#[test]
fn the_host_reads_and_writes_between_the_programs_steps() {
    let [program, _] = i2c::programs(VideoTiming::P1080_60);
    let mut rig = Rig::new(&program, Chips::default(), 11);
    let place = |device: u32, register: u32| device << 16 | register << 8;
    let (read, bare, card) = (1 << 23, 1 << 24, 1 << 25);
    assert_eq!(rig.get("answer_o"), 0, "an answer before an access");
    // In the midst of the set-up, too.
    for (sequence, value) in (1..).zip([0x12u8, 0xff, 0x00, 0x80]) {
        assert_eq!(rig.access(place(0x5a, 0x33) | u32::from(value), 2 * sequence), (u32::from(value), 0));
        assert_eq!(rig.access(read | place(0x5a, 0x33), 2 * sequence + 1), (u32::from(value), 0));
    }
    rig.done();
    assert_eq!(rig.access(bare | 0x74 << 16 | 0x05, 12).1, 0);
    assert_eq!(rig.access(read | bare | 0x74 << 16, 13), (0x05, 0));
    rig.wire.chips.missing = vec![0x5b];
    assert_eq!(rig.access(read | place(0x5b, 0), 14).1, Cause::Refused as u32);
    // That of the other bus is not done here, and its number is not taken for a new one afterwards.
    let entries = rig.wire.chips.writes(0x5a, 0x33);
    rig.bench.set("access_i", u64::from(card | place(0x5a, 0x33) | 3 << 28)).unwrap();
    rig.steps(5_000);
    assert_eq!(rig.access(read | place(0x5a, 0x33), 4), (0x80, 0));
    assert_eq!(rig.wire.chips.writes(0x5a, 0x33), entries);
}
