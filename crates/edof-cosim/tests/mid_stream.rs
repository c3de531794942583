//! What may happen to a chain in mid-stream: flush, reset, windows of the wrong length, a look at its counters.

use crate::common::traffic::{Traffic, cycle, reset, write};
use crate::common::{Setup, committed, expect_clean, misfits, moderate, patches};
use edof_core::draw::Draw;
use edof_cosim::chain::device::status_address;
use edof_cosim::chain::{Device, Drive, Inputs};
use edof_device::Design;
use edof_device::design::memory::{self, SNAPSHOT, Set, Space, WHOLE_CHAIN};
use edof_golden::cycle::{Stalls, Summary};

/// Windows of any length for some hundred cycles, at any pace: an end that leaves anything in any place.
fn disturb(device: &mut impl Device, design: &Design, draw: &mut Draw) {
    let patches = misfits(patches(design, 40, draw.bits()), draw.bits());
    let mut traffic = Traffic::new(&patches, draw.whole(0, 7));
    for _ in 0..draw.whole(20, 900) {
        traffic.cycle(device, draw, None, 0);
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
    let model = || setup.model_of([&setup.networks[0], &second]).skip_zeros(false);
    expect_clean(&drive.run(model(), patches(&setup.design, 5, 1), &mut device, &mut |_| ()).unwrap());
    for seed in 0..60 {
        disturb(&mut device, &setup.design, draw);
        // Neither skip nor a weight, a threshold or a shift of set 1 is written again.
        let stalls = Some(Stalls::drawn(seed, [0, 100, 200][seed as usize % 3]));
        let drive = Drive { flush: true, stalls, ..Drive::default() };
        let patches = patches(&setup.design, 6, seed);
        expect_clean(&drive.run(model(), patches, &mut device, &mut |_| ()).unwrap());
    }
}

#[test]
fn what_is_written_in_a_flush_is_written() {
    let setup = Setup::new(committed("tiny"), 1);
    let (mut device, draw) = (setup.start(1), &mut Draw::new(2));
    let drive = Drive::default();
    expect_clean(&drive.run(setup.model(), patches(&setup.design, 3, 1), &mut device, &mut |_| ()).unwrap());
    disturb(&mut device, &setup.design, draw);
    let second = moderate(&setup.design, 9);
    for write in memory::writes(&setup.design, &second, Set::Second) {
        cycle(&mut device, &Inputs { flush: true, write: Some(write), ..Inputs::default() });
    }
    let drive = Drive { flush: true, ..Drive::default() };
    let model = setup.model_of([&setup.networks[0], &second]);
    expect_clean(&drive.run(model, patches(&setup.design, 5, 1), &mut device, &mut |_| ()).unwrap());
}

#[test]
fn a_reset_in_mid_stream_restores_shifts_and_skip_too() {
    let setup = Setup::new(committed("tiny"), 1);
    let mut device = setup.start(1);
    (0..48).for_each(|_| drop(cycle(&mut device, &Inputs { reset: true, ..Inputs::default() })));
    let draw = &mut Draw::new(2);
    for seed in 0..30 {
        write(&mut device, 1, Space::Register { row: 0 }, 5);
        write(&mut device, 2, Space::Register { row: 2 }, 0);
        disturb(&mut device, &setup.design, draw);
        let drive = Drive { stalls: Some(Stalls::drawn(seed, 100)), ..Drive::default() };
        let patches = patches(&setup.design, 5, seed);
        expect_clean(&drive.run(setup.model(), patches, &mut device, &mut |_| ()).unwrap());
    }
}

#[test]
fn windows_of_the_wrong_length_are_counted_and_the_next_one_is_right() {
    let setup = Setup::new(committed("tiny"), 1);
    for (seed, stalled) in [(1, 0), (2, 60), (3, 200)] {
        let drive = Drive { stalls: Some(Stalls::drawn(seed, stalled)), ..Drive::default() };
        let outcome = setup.run(&drive, misfits(patches(&setup.design, 200, seed), seed), seed);
        expect_clean(&outcome);
        assert!(outcome.summary.too_short > 20 && outcome.summary.too_long > 20, "{:?}", outcome.summary);
    }
}

/// What all counters show.
fn shown(device: &mut impl Device, traffic: &mut Traffic, draw: &mut Draw, stages: usize) -> Vec<u64> {
    let of_stages = (0..stages).flat_map(|stage| (0..4).map(move |counter| (stage, counter)));
    let addresses = of_stages.chain([(WHOLE_CHAIN, 0), (WHOLE_CHAIN, 1)]);
    let show = |(stage, counter)| traffic.shown(device, draw, status_address(stage, counter)).into();
    addresses.map(show).collect()
}

/// Snapshots at any time in a stream: each event is in one of them and in no other, whatever the pace at which they are read.
#[test]
fn counters_are_read_and_cleared_as_one_set_and_lose_nothing() {
    let setup = Setup::new(committed("tiny"), 1);
    let stages = setup.design.stages.len();
    let patches = misfits(patches(&setup.design, 300, 4), 4);
    let mut summary = Summary::new(&setup.design);
    setup.model().run(patches.clone()).for_each(|run| summary.add(&run));
    let (draw, mut traffic) = (&mut Draw::new(4), Traffic::new(&patches, 2));
    let mut device = setup.start(1);
    reset(&mut device);
    let (mut sums, mut snapshots, mut faults) = (vec![0; 4 * stages + 2], 0, 0);
    let mut quiet = 0;
    while quiet < 3000 {
        for _ in 0..draw.whole(0, 300) {
            faults += u64::from(traffic.cycle(&mut device, draw, None, 0).window_fault);
        }
        traffic.cycle(&mut device, draw, Some((SNAPSHOT, snapshots)), 0);
        (0..6).for_each(|_| drop(traffic.cycle(&mut device, draw, None, 0)));
        let first = shown(&mut device, &mut traffic, draw, stages);
        // The counters are held while the stream continues.
        assert_eq!(shown(&mut device, &mut traffic, draw, stages), first);
        sums.iter_mut().zip(&first).for_each(|(sum, count)| *sum += count);
        snapshots += 1;
        quiet = if traffic.is_over() { quiet + 100 } else { 0 };
    }
    assert!(snapshots > 50 && faults > 0);
    let of_stages = summary.counts.stages.iter().flat_map(|counts| {
        [counts.nonzeros, counts.saturated_results, counts.saturated_codes, counts.saturated_differences]
    });
    let mut expected: Vec<u64> = of_stages.chain([summary.too_short, summary.too_long]).collect();
    // What F sends is not counted by the model.
    expected[4 * (stages - 1)] = sums[4 * (stages - 1)];
    assert_eq!(sums, expected);
    assert!(expected[4] > 0 && summary.too_short > 0 && summary.too_long > 0);
    // The last snapshots saw no fault: the flag is down.
    assert!(!cycle(&mut device, &Inputs::default()).window_fault);
}
