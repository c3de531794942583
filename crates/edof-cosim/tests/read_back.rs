//! What the host wrote, read back from a chain that works or does not, and the CRC of its banks.

use crate::common::traffic::{Traffic, cycle, reset, write};
use crate::common::{Setup, committed, expect_clean, for_set, moderate, patches};
use edof_core::draw::Draw;
use edof_cosim::chain::verilated::Verilated;
use edof_cosim::chain::{Drive, Inputs};
use edof_device::Design;
use edof_device::design::StagePlan;
use edof_device::design::memory::{self, Set, Shifts, Space};
use edof_device::design::reading::{self, ReadBack, read_back_address, read_command};
use edof_device::design::timing::{READ_LATENCY, READ_PERIOD};
use edof_golden::cycle::Stalls;
use edof_network::network::Recurrence;

/// A chain, what else happens in it, and chance.
struct Host {
    device: Verilated,
    traffic: Traffic,
    draw: Draw,
}

impl Host {
    fn cycle(&mut self, write: Option<(u32, u32)>) {
        if self.traffic.is_over() {
            self.traffic.again();
        }
        self.traffic.cycle(&mut self.device, &mut self.draw, write, 0);
    }

    fn shown(&mut self, stage: usize, part: ReadBack) -> u32 {
        self.traffic.shown(&mut self.device, &mut self.draw, read_back_address(stage, part))
    }

    fn write(&mut self, stage: usize, space: Space, word: u32) {
        self.cycle(Some((memory::address(stage, space), word)));
    }

    fn command(&mut self, stage: usize, from: Space, rows: usize) {
        self.write(stage, Space::Register { row: reading::READ_REGISTER }, read_command(from, rows));
        (0..4).for_each(|_| self.cycle(None));
    }

    /// Has a stage read rows, and waits, for so long at most as the contract says: CRC, and the last row.
    fn read(&mut self, stage: usize, from: Space, rows: usize) -> (u32, u64) {
        self.command(stage, from, rows);
        let waits_for_pauses = matches!(from, Space::Thresholds { .. } | Space::PreviousThresholds { .. });
        let max = READ_LATENCY + rows as u64 * READ_PERIOD + if waits_for_pauses { 2000 } else { 0 };
        let mut cycles = 4;
        while self.shown(stage, ReadBack::Busy) == 1 {
            cycles += 2;
            assert!(cycles <= max, "stage {stage}: {from:?} takes longer than it may");
        }
        let word =
            u64::from(self.shown(stage, ReadBack::Low)) | u64::from(self.shown(stage, ReadBack::High)) << 32;
        (self.shown(stage, ReadBack::Crc), word)
    }
}

/// Both forms of recurrence: the second knows the thresholds of the stage before.
fn designs() -> [Design; 2] {
    let mut difference = committed("tiny");
    difference.form.recurrence = Recurrence::Difference;
    [committed("tiny"), difference]
}

fn host(setup: &Setup, traffic: Traffic, seed: u64) -> Host {
    let mut device = setup.start(seed);
    reset(&mut device);
    Host { device, traffic, draw: Draw::new(seed) }
}

/// The number of a row of weights: the last of set 1, or any.
fn any_row(draw: &mut Draw, stage: &StagePlan) -> usize {
    let last = stage.weight_depth() as i64 - 1;
    let row = if draw.whole(0, 3) == 0 { last } else { draw.whole(0, last) };
    ((row as usize) << memory::row_bits(stage)) | draw.whole(0, stage.row_words() as i64 - 1) as usize
}

/// Weights, thresholds and registers with random words, each read back at once: with nothing else to do, and in windows that
/// never pause.
#[test]
fn every_word_that_can_be_written_can_be_read_back() {
    for design in designs() {
        let setup = Setup::new(design, 1);
        for traffic in [Traffic::none(), Traffic::new(&patches(&setup.design, 50, 1), 0)] {
            let mut host = host(&setup, traffic, 1);
            for stage in setup.design.stages() {
                let at = stage.index;
                for _ in 0..12 {
                    let (bank, row) = (
                        host.draw.whole(0, stage.banks() as i64 - 1) as usize,
                        any_row(&mut host.draw, &stage),
                    );
                    let word = host.draw.bits();
                    for half in 0..2 {
                        host.write(at, Space::Weights { bank, row, half }, (word >> (32 * half)) as u32);
                    }
                    let read = host.read(at, Space::Weights { bank, row, half: 0 }, 1);
                    assert_eq!(read, (reading::crc([word]), word), "{stage:?}: bank {bank}, row {row}");
                }
                for (before, there) in [(false, stage.shrinks()), (true, stage.sends_difference)] {
                    for row in (0..2 * stage.beats_out()).filter(|row| there && row % 3 == 0) {
                        let space = if before {
                            Space::PreviousThresholds { row }
                        } else {
                            Space::Thresholds { row }
                        };
                        let word = host.draw.bits() as u32;
                        host.write(at, space, word);
                        let read = host.read(at, space, 1);
                        assert_eq!(read, (reading::crc([word.into()]), word.into()), "{stage:?}: {space:?}");
                    }
                }
                for (row, mask) in [(0, (1 << 20) - 1), (1, (1 << 20) - 1), (2, memory::CONTROL_SKIP)] {
                    let word = host.draw.bits() as u32 & mask;
                    host.write(at, Space::Register { row }, word);
                    assert_eq!(
                        host.read(at, Space::Register { row }, 1).1,
                        u64::from(word),
                        "{stage:?}: register {row}"
                    );
                }
            }
        }
    }
}

/// What a design is generated with, many rows at once.
#[test]
fn memories_start_with_the_networks_and_registers_with_their_shifts() {
    for design in designs() {
        let setup = Setup::new(design, 1);
        let mut host = host(&setup, Traffic::none(), 1);
        for stage in setup.design.stages().take(3) {
            for (set, network) in setup.networks.iter().enumerate() {
                let row = (set * stage.weight_rows()) << memory::row_bits(&stage);
                let rows = reading::bank_rows(network, &stage, 1);
                let read = host.read(stage.index, Space::Weights { bank: 1, row, half: 0 }, rows.len());
                assert_eq!(read, (reading::crc(rows.iter().copied()), rows[rows.len() - 1]), "{stage:?}");
                let words: Vec<u64> =
                    memory::threshold_words(network, &stage, false).into_iter().map(u64::from).collect();
                let first = Space::Thresholds { row: set * stage.beats_out() };
                let read = host.read(stage.index, first, words.len());
                assert_eq!(read, (reading::crc(words.iter().copied()), words[words.len() - 1]), "{stage:?}");
                let shifts = host.read(stage.index, Space::Register { row: set }, 1).1;
                assert_eq!(shifts, u64::from(Shifts::of(network, &stage).word()));
            }
        }
    }
}

/// A bank of every stage, in a stream of windows that never pauses, while the host writes the other set: the cycles that this takes
/// are those of the model, and each CRC is the bank's.
#[test]
fn a_bank_has_its_crc_at_full_load() {
    let setup = Setup::new(committed("tiny"), 1);
    let stages: Vec<StagePlan> = setup.design.stages().collect();
    let rows = |stage: &StagePlan| reading::bank_rows(&setup.networks[0], stage, 1);
    let register = |stage| memory::address(stage, Space::Register { row: reading::READ_REGISTER });
    let command = |stage: &StagePlan| {
        let from = Space::Weights { bank: 1, row: 0, half: 0 };
        (register(stage.index), read_command(from, rows(stage).len()))
    };
    let second = moderate(&setup.design, 9);
    // The first command is cut short by the second.
    let commands = stages.iter().chain(&stages).map(command);
    let writes = memory::writes(&setup.design, &second, Set::Second);
    let drive = Drive { writes_while_running: commands.chain(writes).collect(), ..Drive::default() };
    let max = stages.iter().map(|stage| rows(stage).len()).max().unwrap() as u64 * READ_PERIOD;
    let mut device = setup.start(1);
    let patches = for_set(Set::First, patches(&setup.design, max as usize / 70, 1));
    let outcome = drive.run(setup.model(), patches, &mut device, &mut |_| ()).unwrap();
    expect_clean(&outcome);
    assert!(outcome.cycles > max + READ_LATENCY, "{} cycles", outcome.cycles);
    let mut host = Host { device, traffic: Traffic::none(), draw: Draw::new(1) };
    for stage in &stages {
        assert_eq!(host.shown(stage.index, ReadBack::Busy), 0);
        assert_eq!(host.shown(stage.index, ReadBack::Crc), reading::crc(rows(stage)), "{stage:?}");
    }
}

#[test]
fn one_wrong_bit_in_a_bank_is_found_by_its_crc() {
    let setup = Setup::new(committed("tiny"), 1);
    let mut host = host(&setup, Traffic::none(), 1);
    for stage in setup.design.stages().take(2) {
        let mut rows = reading::bank_rows(&setup.networks[0], &stage, 1);
        let right = reading::crc(rows.iter().copied());
        let from = Space::Weights { bank: 1, row: 0, half: 0 };
        assert_eq!(host.read(stage.index, from, rows.len()).0, right);
        for _ in 0..3 {
            let (row, bit) =
                (host.draw.whole(0, rows.len() as i64 - 1) as usize, host.draw.whole(0, 63) as usize);
            let put = |host: &mut Host, word: u64| {
                let half = bit / 32;
                host.write(stage.index, Space::Weights { bank: 1, row, half }, (word >> (32 * half)) as u32);
            };
            let kept = rows[row];
            rows[row] ^= 1 << bit;
            put(&mut host, rows[row]);
            let found = host.read(stage.index, from, rows.len()).0;
            assert!(found != right && found == reading::crc(rows.iter().copied()), "{stage:?}: {found:x}");
            rows[row] = kept;
            put(&mut host, kept);
        }
        assert_eq!(host.read(stage.index, from, rows.len()).0, right);
    }
}

#[test]
fn a_flush_ends_a_read_and_the_next_one_is_right() {
    let setup = Setup::new(committed("tiny"), 1);
    let mut host = host(&setup, Traffic::none(), 1);
    let stage = setup.design.stage(1);
    let rows = reading::bank_rows(&setup.networks[0], &stage, 0);
    let from = Space::Weights { bank: 0, row: 0, half: 0 };
    for _ in 0..10 {
        host.command(1, from, 9);
        (0..host.draw.whole(0, 1500)).for_each(|_| host.cycle(None));
        (0..48).for_each(|_| drop(cycle(&mut host.device, &Inputs { flush: true, ..Inputs::default() })));
        assert_eq!(host.shown(1, ReadBack::Busy), 0);
        assert_eq!(host.read(1, from, 2), (reading::crc(rows[..2].iter().copied()), rows[1]));
        // And one command ends another.
        host.command(1, from, 9);
        (0..host.draw.whole(0, 700)).for_each(|_| host.cycle(None));
        assert_eq!(
            host.read(1, Space::Weights { bank: 0, row: 1, half: 0 }, 1),
            (reading::crc([rows[1]]), rows[1])
        );
    }
    write(&mut host.device, 1, Space::Register { row: 0 }, 0);
    let drive = Drive { stalls: Some(Stalls::drawn(1, 50)), ..Drive::default() };
    expect_clean(
        &drive.run(setup.model(), patches(&setup.design, 5, 1), &mut host.device, &mut |_| ()).unwrap(),
    );
}
