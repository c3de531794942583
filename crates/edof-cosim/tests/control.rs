//! What the host may do to a chain: drop what is under way, read memories back, send windows that are too short or too long.

mod common;
mod support;

use common::{Setup, committed, expect_clean, moderate, patches};
use edof_cosim::chain::device::status_address;
use edof_cosim::chain::drive::SNAPSHOT;
use edof_cosim::chain::{Beat, Device, Drive, Inputs, Outputs};
use edof_golden::cycle::Stalls;
use edof_golden::scalar;
use edof_spec::Design;
use edof_spec::design::StagePlan;
use edof_spec::design::memory::{self, Set, Space};
use edof_spec::draw::Draw;
use edof_spec::network::Recurrence;

/// Both forms of recurrence: the second knows the thresholds of the stage before.
fn designs() -> [Design; 2] {
    let mut difference = committed("tiny");
    difference.form.recurrence = Recurrence::Difference;
    [committed("tiny"), difference]
}

fn cycle(device: &mut impl Device, inputs: &Inputs) -> Outputs {
    let mut outputs = Outputs::default();
    device.cycle(inputs, &mut outputs).unwrap();
    outputs
}

/// What a stage shows.
fn status(device: &mut impl Device, stage: usize, what: usize) -> u32 {
    let inputs = Inputs { status_address: status_address(stage, what), ..Inputs::default() };
    cycle(device, &inputs);
    cycle(device, &inputs).status
}

fn write(device: &mut impl Device, stage: usize, space: Space, word: u32) {
    cycle(device, &Inputs { write: Some((memory::address(stage, space), word)), ..Inputs::default() });
}

/// Has a stage read rows and waits: CRC, and the last row.
fn read(device: &mut impl Device, stage: usize, from: Space, rows: usize) -> (u32, u64) {
    write(device, stage, Space::Register { row: memory::READ_REGISTER }, memory::read_command(from, rows));
    for _ in 0..8 {
        cycle(device, &Inputs::default());
    }
    let mut cycles = 0;
    while status(device, stage, 7) == 1 {
        cycles += 2;
        assert!(cycles <= memory::READ_PERIOD * rows as u64 + 8, "it takes longer than it may");
    }
    let word = u64::from(status(device, stage, 5)) | u64::from(status(device, stage, 6)) << 32;
    (status(device, stage, 4), word)
}

/// Windows of beats that are drawn, for some hundred cycles.
fn disturb(device: &mut impl Device, design: &Design, draw: &mut Draw) {
    let pixels = design.form.window.pixels();
    let (mut beat, mut pending) = (0, None);
    for _ in 0..draw.whole(20, 900) {
        if pending.is_none() && draw.whole(0, 3) > 0 {
            let last = beat % (pixels / 2) == pixels / 2 - 1;
            let word = draw.whole(0, 0x7fff) as i16;
            pending = Some(Beat { words: [word, !word & 0x7fff], base: [0; 2], last, set: Set::First });
        }
        let ready = draw.whole(0, 2) > 0;
        let outputs = cycle(device, &Inputs { window: pending, patch_ready: ready, ..Inputs::default() });
        if pending.is_some() && outputs.window_ready {
            pending = None;
            beat += 1;
        }
    }
}

#[test]
fn a_flush_in_mid_stream_drops_vectors_and_keeps_everything_that_was_written() {
    let setup = Setup::new(committed("tiny"), 1);
    let second = moderate(&setup.design, 9);
    let mut device = setup.start(1);
    let draw = &mut Draw::new(1);
    let writes = memory::writes(&setup.design, &second, Set::Second);
    let drive = Drive { writes, skip_zeros: Some(false), ..Drive::default() };
    let model = || setup.model_of([&setup.networks[0], &second]);
    expect_clean(&drive.run(model(), patches(&setup.design, 5, 1), &mut device, &mut |_| ()).unwrap());
    for seed in 0..30 {
        disturb(&mut device, &setup.design, draw);
        // Skip was written, and neither it nor a weight or shift of set 1 is written again.
        let stalls = Some(Stalls::drawn(seed, 100));
        let drive = Drive { flush: true, stalls, ..Drive::default() };
        let model = model().skip_zeros(false);
        let patches = patches(&setup.design, 5, seed);
        expect_clean(&drive.run(model, patches, &mut device, &mut |_| ()).unwrap());
    }
}

#[test]
fn a_reset_in_mid_stream_restores_shifts_and_skip_too() {
    let setup = Setup::new(committed("tiny"), 1);
    let mut device = setup.start(1);
    let draw = &mut Draw::new(2);
    for seed in 0..10 {
        write(&mut device, 1, Space::Register { row: 0 }, 5);
        write(&mut device, 2, Space::Register { row: 2 }, 0);
        disturb(&mut device, &setup.design, draw);
        let drive = Drive { stalls: Some(Stalls::drawn(seed, 100)), ..Drive::default() };
        let patches = patches(&setup.design, 5, seed);
        expect_clean(&drive.run(setup.model(), patches, &mut device, &mut |_| ()).unwrap());
    }
}

#[test]
fn every_word_that_can_be_written_can_be_read_back() {
    for design in designs() {
        let second = moderate(&design, 9);
        let setup = Setup::new(design, 1);
        let mut device = setup.start(1);
        let drive = Drive { writes: memory::writes(&setup.design, &second, Set::Second), ..Drive::default() };
        let model = setup.model_of([&setup.networks[0], &second]);
        expect_clean(&drive.run(model, patches(&setup.design, 3, 1), &mut device, &mut |_| ()).unwrap());
        for stage in setup.design.stages() {
            let rows = memory::bank_rows(&second, &stage, 1);
            let first = stage.weight_rows() << memory::row_bits(&stage);
            for k in [0, 1, 5, rows.len() - 1] {
                let from = Space::Weights { bank: 1, row: first + k, half: 0 };
                assert_eq!(
                    read(&mut device, stage.index, from, 1),
                    (memory::crc([rows[k]]), rows[k]),
                    "{stage:?}"
                );
            }
            for (before, there) in [(false, stage.shrinks()), (true, stage.sends_difference)] {
                let words = if there { memory::threshold_words(&second, &stage, before) } else { vec![] };
                for (k, word) in words.into_iter().enumerate() {
                    let row = stage.beats_out() + k;
                    let from =
                        if before { Space::PreviousThresholds { row } } else { Space::Thresholds { row } };
                    let read = read(&mut device, stage.index, from, 1);
                    assert_eq!(read, (memory::crc([word.into()]), word.into()), "{stage:?} {row}");
                }
            }
            let registers = [
                memory::Shifts::of(&setup.networks[0], &stage).word(),
                memory::Shifts::of(&second, &stage).word(),
                memory::CONTROL_SKIP,
            ];
            for (row, word) in registers.into_iter().enumerate() {
                assert_eq!(read(&mut device, stage.index, Space::Register { row }, 1).1, u64::from(word));
            }
        }
    }
}

/// Every bank of a stage, one after the other, in a stream of windows that never pauses: the cycles that reading takes are those of the
/// model, and each CRC is the bank's.
#[test]
fn a_bank_has_its_crc_at_full_load() {
    let setup = Setup::new(committed("tiny"), 1);
    let of = |stage: &StagePlan, bank: usize| memory::bank_rows(&setup.networks[1], stage, bank);
    for bank in 0..2 {
        let stages: Vec<StagePlan> = setup.design.stages().collect();
        let command = |stage: &StagePlan| {
            let row = stage.weight_rows() << memory::row_bits(stage);
            let command = memory::read_command(Space::Weights { bank, row, half: 0 }, of(stage, bank).len());
            (memory::address(stage.index, Space::Register { row: memory::READ_REGISTER }), command)
        };
        let mut device = setup.start(1);
        let drive = Drive { writes_while_running: stages.iter().map(command).collect(), ..Drive::default() };
        // So many that every stage is read while they run.
        let most = stages.iter().map(|stage| of(stage, bank).len()).max().unwrap();
        let patches = patches(&setup.design, most * 256 / 60, 1);
        let outcome = drive.run(setup.model(), patches, &mut device, &mut |_| ()).unwrap();
        expect_clean(&outcome);
        assert!(outcome.cycles > most as u64 * memory::READ_PERIOD);
        for stage in &stages {
            assert_eq!(status(&mut device, stage.index, 7), 0);
            assert_eq!(status(&mut device, stage.index, 4), memory::crc(of(stage, bank)), "{stage:?}");
        }
    }
}

#[test]
fn a_bank_with_one_wrong_bit_has_another_crc() {
    let rows = [1, 2, 3];
    for bit in 0..64 {
        assert_ne!(memory::crc(rows), memory::crc([1, 2 ^ (1 << bit), 3]));
    }
}

#[test]
fn a_window_that_is_too_short_or_too_long_is_counted_and_the_next_one_is_right() {
    let setup = Setup::new(committed("tiny"), 1);
    let pixels = setup.design.form.window.pixels();
    let draw = &mut Draw::new(3);
    // Lengths in beats: too short, right, too long, and each after each.
    let lengths: Vec<usize> = (0..60)
        .map(|k| match k % 5 {
            0 | 3 => pixels / 2,
            1 => draw.whole(1, pixels as i64 / 2 - 1) as usize,
            2 => draw.whole(pixels as i64 / 2 + 1, pixels as i64) as usize,
            _ => [1, pixels / 2 - 1, pixels / 2 + 1][k % 3],
        })
        .collect();
    let windows: Vec<Vec<i16>> =
        lengths.iter().map(|beats| (0..2 * beats).map(|_| draw.whole(0, 0x7fff) as i16).collect()).collect();
    let expected: Vec<i16> = windows
        .iter()
        .flat_map(|window| {
            let mut window = window.clone();
            window.resize(pixels, 0);
            scalar::run(&setup.networks[0], &window).output
        })
        .collect();
    let mut device = setup.start(1);
    expect_clean(
        &Drive::default().run(setup.model(), patches(&setup.design, 1, 1), &mut device, &mut |_| ()).unwrap(),
    );

    let mut beats = windows
        .iter()
        .flat_map(|window| {
            let count = window.len() / 2;
            window.chunks(2).enumerate().map(move |(k, words)| Beat {
                words: [words[0], words[1]],
                base: [0; 2],
                last: k + 1 == count,
                set: Set::First,
            })
        })
        .peekable();
    let (mut got, mut idle, mut flagged) = (vec![], 0, false);
    while idle < 2000 {
        let patch_ready = draw.whole(0, 3) > 0;
        let window = beats.peek().copied();
        let outputs = cycle(&mut device, &Inputs { window, patch_ready, ..Inputs::default() });
        if window.is_some() && outputs.window_ready {
            beats.next();
        }
        let patch = outputs.patch.filter(|_| patch_ready);
        got.extend(patch.iter().flat_map(|beat| beat.words));
        idle = if patch.is_some() || window.is_some() { 0 } else { idle + 1 };
        flagged = outputs.window_fault;
    }
    assert_eq!(got.len(), expected.len());
    assert_eq!(got, expected);
    assert!(flagged);
    cycle(&mut device, &Inputs { write: Some(SNAPSHOT), ..Inputs::default() });
    (0..8).for_each(|_| drop(cycle(&mut device, &Inputs::default())));
    let count = |holds: &dyn Fn(usize) -> bool| lengths.iter().filter(|beats| holds(**beats)).count() as u32;
    assert_eq!(status(&mut device, memory::ALL_STAGES, 0), count(&|beats| beats < pixels / 2));
    assert_eq!(status(&mut device, memory::ALL_STAGES, 1), count(&|beats| beats > pixels / 2));
    assert!(!cycle(&mut device, &Inputs::default()).window_fault);
}
