//! The set-up of chips on an I2C bus: what they got is what the table says, whatever they refuse at first.

use crate::support;
use edof_cosim::bench::{Actor, Bench, ClockId};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_hdl::board::I2cInit;
use edof_spec::draw::Draw;
use edof_spec::i2c::{self, Action, Entry};
use std::collections::BTreeSet;

/// A slow clock makes a short simulation: 8 cycles a quarter of a bit.
const KILOHERTZ: u32 = 3_200;

/// Chips on the bus, as a wired-and: acknowledge their addresses, sometimes not, and note what they got.
struct Chips {
    clock: ClockId,
    /// `scl`, `sda`, `scl_low`, `sda_low`.
    ports: [usize; 4],
    addresses: BTreeSet<u8>,
    /// Of a hundred bytes, how many are refused.
    refuses: i64,
    /// Holds the clock down: for so many cycles after a byte.
    stretch: u32,
    draw: Draw,
    before: (bool, bool),
    bits: Option<Vec<bool>>,
    bytes: Vec<u8>,
    acknowledges: bool,
    answering: bool,
    held: u32,
    /// Transfers that were acknowledged to their end.
    got: Vec<Vec<u8>>,
    refused: usize,
}

impl Chips {
    fn new(source: &Source, clock: ClockId, addresses: &[u8], refuses: i64, seed: u64) -> Self {
        Self {
            clock,
            ports: ["scl_i", "sda_i", "scl_low_o", "sda_low_o"].map(|port| source.port(port).unwrap()),
            addresses: addresses.iter().copied().collect(),
            refuses,
            stretch: 0,
            draw: Draw::new(seed),
            before: (true, true),
            bits: None,
            bytes: vec![],
            acknowledges: false,
            answering: false,
            held: 0,
            got: vec![],
            refused: 0,
        }
    }

    /// The lines moved.
    fn moved(&mut self, scl: bool, sda: bool) {
        let (scl_before, sda_before) = self.before;
        if scl && scl_before && sda != sda_before {
            if sda {
                // Stop.
                if self.acknowledges && !self.bytes.is_empty() {
                    self.got.push(std::mem::take(&mut self.bytes));
                }
                self.bits = None;
            } else {
                self.bits = Some(vec![]);
            }
            self.bytes.clear();
            self.answering = false;
        } else if scl && !scl_before {
            if let Some(bits) = self.bits.as_mut().filter(|_| !self.answering) {
                bits.push(sda);
            }
        } else if !scl && scl_before {
            self.fell();
        }
    }

    /// The clock fell: after eight bits comes the answer, after the answer the next byte.
    fn fell(&mut self) {
        let Some(bits) = &mut self.bits else { return };
        if self.answering {
            self.answering = false;
            if !self.acknowledges {
                self.bits = None;
            }
        } else if bits.len() == 8 {
            let byte = bits.drain(..).fold(0, |byte, bit| byte << 1 | u8::from(bit));
            let is_known = !self.bytes.is_empty() || (byte & 1 == 0 && self.addresses.contains(&(byte >> 1)));
            self.acknowledges = is_known && self.draw.whole(0, 99) >= self.refuses;
            self.refused += usize::from(!self.acknowledges);
            self.bytes.push(byte);
            self.answering = true;
            self.held = self.stretch;
        }
    }
}

impl Actor for Chips {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        self.held = self.held.saturating_sub(1);
        let scl = model.peek(self.ports[2])? == 0 && self.held == 0;
        let sda = model.peek(self.ports[3])? == 0 && !(self.answering && self.acknowledges);
        self.moved(scl, sda);
        self.before = (scl, sda);
        model.poke(self.ports[0], scl.into())?;
        model.poke(self.ports[1], sda.into())
    }
}

/// What the chips get of a table.
fn transfers(table: &[Entry]) -> Vec<Vec<u8>> {
    let transfer = |entry: &Entry| match entry.action {
        Action::Byte { device, value } => Some(vec![device << 1, value]),
        Action::Register { device, register, value } => Some(vec![device << 1, register, value]),
        Action::Wait(_) => None,
    };
    table.iter().filter_map(transfer).collect()
}

fn devices(table: &[Entry]) -> Vec<u8> {
    transfers(table).iter().map(|bytes| bytes[0] >> 1).collect()
}

/// The table without its pauses, which would only take time here, and one short one.
fn shortened(table: &[Entry]) -> Vec<Entry> {
    let short = |entry: &Entry| match entry.action {
        Action::Wait(_) => Entry { action: Action::Wait(2), ..*entry },
        _ => *entry,
    };
    table.iter().map(short).collect()
}

struct Rig {
    bench: Bench,
    chips: Chips,
    _images: tempfile::TempDir,
}

impl Rig {
    fn new(table: &[Entry], addresses: &[u8], refuses: i64, seed: u64) -> Self {
        let source = Source::circuit(&mut I2cInit::new(KILOHERTZ, table, "mem/i2c.hex")).unwrap();
        let images = tempfile::tempdir().unwrap();
        std::fs::create_dir(images.path().join("mem")).unwrap();
        std::fs::write(images.path().join("mem/i2c.hex"), i2c::image(table)).unwrap();
        let library = Library::build(&source, &support::options()).unwrap();
        let start = Start { seed, memory_dir: Some(images.path().into()) };
        let mut bench = Bench::new(library.start(&start).unwrap(), seed);
        let clock = bench.clock("clock_i", 5_000).unwrap();
        let chips = Chips::new(&source, clock, addresses, refuses, seed);
        let mut rig = Self { bench, chips, _images: images };
        for level in [1, 0] {
            rig.bench.set("reset_i", level).unwrap();
            rig.steps(20);
        }
        rig
    }

    fn steps(&mut self, count: usize) {
        self.bench.steps(count, &mut [&mut self.chips]).unwrap();
    }

    fn finish(&mut self) {
        for _ in 0..2_000 {
            if self.get("done_o") + self.get("failed_o") > 0 {
                return;
            }
            self.steps(1_000);
        }
        panic!("the set-up does not end");
    }

    fn get(&mut self, port: &str) -> u64 {
        self.bench.get(port).unwrap()
    }
}

#[test]
fn chips_get_every_register_in_order() {
    for table in [i2c::KC705, i2c::IMAGEON] {
        let mut rig = Rig::new(&shortened(table), &devices(table), 0, 1);
        rig.finish();
        assert_eq!((rig.get("done_o"), rig.get("failed_o"), rig.get("retries_o")), (1, 0, 0));
        assert_eq!(rig.chips.got, transfers(table));
    }
}

#[test]
fn what_is_refused_is_repeated() {
    let table = shortened(i2c::KC705);
    let mut rig = Rig::new(&table, &devices(&table), 10, 2);
    rig.chips.stretch = 100;
    rig.finish();
    assert_eq!((rig.get("done_o"), rig.get("failed_o")), (1, 0));
    assert_eq!(rig.chips.got, transfers(&table));
    assert!(rig.chips.refused > 0);
    assert_eq!(rig.get("retries_o"), rig.chips.refused as u64);
}

#[test]
fn a_chip_that_is_not_there_is_reported_and_a_restart_tries_again() {
    let table = shortened(i2c::KC705);
    let mut rig = Rig::new(&table, &[0x74], 0, 3);
    rig.finish();
    assert_eq!((rig.get("done_o"), rig.get("failed_o")), (0, 1));
    assert_eq!((rig.get("entry_o"), rig.get("device_o"), rig.get("retries_o")), (2, 0x39, 7));
    rig.chips.addresses = devices(&table).into_iter().collect();
    rig.chips.got.clear();
    rig.bench.set("restart_i", 1).unwrap();
    rig.steps(10);
    rig.finish();
    assert_eq!((rig.get("done_o"), rig.get("failed_o")), (1, 0));
    assert_eq!(rig.chips.got, transfers(&table));
}

#[test]
fn a_clock_line_that_is_held_down_is_a_failure() {
    let table = shortened(i2c::KC705);
    let mut rig = Rig::new(&table, &devices(&table), 0, 4);
    rig.chips.stretch = u32::MAX;
    rig.finish();
    assert_eq!((rig.get("done_o"), rig.get("failed_o"), rig.get("scl_low_o")), (0, 1, 0));
}
