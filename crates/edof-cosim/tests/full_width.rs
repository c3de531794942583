//! The committed designs at full width, with a trained network in one set and an extreme one in the other.

use crate::common::traffic::{Traffic, cycle, reset, write};
use crate::common::{Setup, committed, expect_clean, patches, root};
use edof_core::draw::Draw;
use edof_cosim::chain::{Drive, Inputs};
use edof_device::design::StagePlan;
use edof_device::design::memory::{self, Space};
use edof_device::design::reading::{READ_REGISTER, ReadBack, crc, read_back_address, read_command};
use edof_device::design::timing::{READ_LATENCY, READ_PERIOD};
use edof_golden::cycle::Stalls;
use edof_network::weight_file;
use std::collections::BTreeSet;

/// The design with a trained network in one set and an extreme one in the other: one setup of each, whose simulation takes a minute to compile.
fn setup(name: &str, weights: &str) -> Setup {
    let design = committed(name);
    let file = root().join(format!("weights/{weights}.fixed.safetensors"));
    let extreme = edof_device::random::for_design(&design, 1);
    Setup::new_with(design, [weight_file::load_fixed(&file).unwrap(), extreme])
}

/// 2,000 patches, natural and extreme, zeros skipped and not, with and without stalls.
fn agrees_in_every_word_and_cycle(name: &str, weights: &str) {
    let setup = setup(name, weights);
    for (seed, skip, stalled, count) in
        [(1, true, 0, 800), (2, false, 0, 600), (3, true, 60, 400), (4, false, 160, 200)]
    {
        let stalls = Some(Stalls::drawn(seed, stalled));
        let drive = Drive { skip_zeros: Some(skip), stalls, ..Drive::default() };
        let outcome = setup.run(&drive, patches(&setup.design, count, seed), seed);
        expect_clean(&outcome);
        assert_eq!(outcome.summary.counts.patches, count as u64);
        if name == "paper" && !skip && stalled == 0 {
            assert!(outcome.summary.max_cycles <= 200, "{}", outcome.summary.max_cycles);
            assert_eq!(outcome.summary.max_cycles, outcome.summary.min_cycles, "constant");
        }
    }
}

/// Banks and rows of weights of a stage whose numbers between them have every bit 0 and 1: the ends, and all powers of two.
fn places(stage: &StagePlan) -> Vec<Space> {
    let numbers = |count: usize| {
        let powers = (0..12).map(|bit| 1 << bit).filter(move |number| number + 1 < count);
        [0, count - 1].into_iter().chain(powers).collect::<BTreeSet<usize>>()
    };
    let row = |row: usize| row << memory::row_bits(stage) | (row % stage.row_words());
    let (first, last) = (numbers(stage.banks()), stage.banks() - 1);
    let of_first_row = first.into_iter().map(|bank| (bank, row(0)));
    let of_last_bank = numbers(stage.weight_depth()).into_iter().map(|number| (last, row(number)));
    let all: BTreeSet<(usize, usize)> = of_first_row.chain(of_last_bank).collect();
    all.into_iter().map(|(bank, row)| Space::Weights { bank, row, half: 0 }).collect()
}

/// What is written to far corners of all memories stays there, and is read back from there.
#[test]
fn every_bit_of_an_address_of_kc705_is_looked_at_in_writing_and_in_reading() {
    let setup = setup("kc705", "edof-t4w12-outer");
    let (mut device, draw) = (setup.start(1), &mut Draw::new(1));
    reset(&mut device);
    let stages: Vec<StagePlan> = setup.design.stages().collect();
    let mut words: Vec<Vec<(Space, u64)>> = stages
        .iter()
        .map(|stage| places(stage).into_iter().map(|place| (place, draw.bits())).collect())
        .collect();
    for (stage, words) in words.iter().enumerate() {
        for (place, word) in words {
            let Space::Weights { bank, row, .. } = *place else { panic!("{place:?}") };
            for half in 0..2 {
                write(&mut device, stage, Space::Weights { bank, row, half }, (word >> (32 * half)) as u32);
            }
        }
    }
    assert!(words.iter().all(|words| words.len() > 12));
    // All stages read at once.
    while words.iter().any(|words| !words.is_empty()) {
        let now: Vec<Option<(Space, u64)>> = words.iter_mut().map(Vec::pop).collect();
        for (stage, (place, _)) in now.iter().enumerate().filter_map(|(stage, one)| Some((stage, (*one)?))) {
            write(&mut device, stage, Space::Register { row: READ_REGISTER }, read_command(place, 1));
        }
        (0..READ_LATENCY + READ_PERIOD).for_each(|_| drop(cycle(&mut device, &Inputs::default())));
        for (stage, (place, word)) in
            now.into_iter().enumerate().filter_map(|(stage, one)| Some((stage, one?)))
        {
            let mut shown = |part| Traffic::none().shown(&mut device, draw, read_back_address(stage, part));
            assert_eq!(shown(ReadBack::Busy), 0);
            let found = u64::from(shown(ReadBack::Low)) | u64::from(shown(ReadBack::High)) << 32;
            assert_eq!(found, word, "stage {stage}: {place:?}");
            assert_eq!(shown(ReadBack::Crc), crc([word]));
        }
    }
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn paper_agrees_in_every_word_and_cycle() {
    agrees_in_every_word_and_cycle("paper", "paper-t4");
}

#[test]
fn kc705_agrees_in_every_word_and_cycle() {
    agrees_in_every_word_and_cycle("kc705", "edof-t4w12-outer");
}
