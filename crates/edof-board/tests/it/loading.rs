//! Networks onto a board on a line that carries every byte.

use crate::common::{board, frames, job, load, network, open, picture, retrained, same_words, small, tiny};
use edof_board::contents::{display_of, network_of, parts, table_parts};
use edof_board::load::{Job, unwatched};
use edof_board::simulated::Shown;
use edof_board::{Board, Error};
use edof_core::DisplayMode;
use edof_core::draw::Draw;
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::registers::identity::weights_hash;
use edof_device::registers::map;
use edof_golden::{Curve, Display};
use edof_network::{FixedNetwork, weight_file};
use std::ops::ControlFlow;
use std::path::Path;

fn get(board: &mut Board<&mut edof_board::Simulated>, name: &str) -> u32 {
    board.get(name.parse().unwrap()).unwrap()
}

#[test]
fn a_load_goes_into_the_idle_bank_which_is_then_in_use() {
    let design = tiny();
    let [first, second, third] = [1, 2, 3].map(|seed| network(&design, seed));
    let mut simulated = board(&design, &first);
    for (new, bank) in [(&second, 'b'), (&third, 'a')] {
        let loaded = load(&mut simulated, &job(&design, new)).unwrap();
        assert_eq!((loaded.bank, loaded.in_use, loaded.rounds, loaded.recovered), (bank, bank, 1, false));
        let mut board = open(&mut simulated);
        assert_eq!(get(&mut board, "weights_hash"), weights_hash(&design, new));
        let set = board.bank().unwrap();
        assert_eq!(
            board.verify(&design, new, set, false, &mut |_, _| ControlFlow::Continue(())).unwrap(),
            []
        );
    }
    assert!(same_words(&design, &simulated.network(0).unwrap(), &third));
    assert!(same_words(&design, &simulated.network(1).unwrap(), &second));
}

#[test]
fn whenever_a_load_comes_every_frame_is_of_the_old_network_or_of_the_new() {
    let design = tiny();
    let [old, new] = [1, 2].map(|seed| network(&design, seed));
    let pictures = [picture(&design, &old), picture(&design, &new)];
    assert_ne!(pictures[0], pictures[1]);
    for seed in 0..25 {
        let mut simulated = board(&design, &old);
        let moment = Draw::new(seed).whole(30_000_000, 80_000_000) as u64;
        simulated.pass_to(moment);
        load(&mut simulated, &job(&design, &new)).unwrap();
        frames(&mut simulated, 3);
        assert_eq!(simulated.shown(), pictures, "seed {seed}");
    }
}

/// The network of the default design as it comes with the program.
fn trained(name: &str) -> FixedNetwork {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../weights");
    weight_file::load_fixed(&root.join(format!("{name}.fixed.safetensors"))).unwrap()
}

#[test]
fn a_trained_network_of_the_default_design_is_loaded_whole_whenever_it_comes() {
    let design = small(Design::from_json(include_str!("../../../../designs/kc705.json")).unwrap());
    let [old, new] = ["edof-t4w12-outer", "edof-t4w12-outer-light"].map(trained);
    let pictures = [picture(&design, &old), picture(&design, &new)];
    for seed in 0..5 {
        let mut simulated = board(&design, &old);
        let moment = Draw::new(seed).whole(30_000_000, 80_000_000) as u64;
        simulated.pass_to(moment);
        let loaded = load(&mut simulated, &job(&design, &new)).unwrap();
        frames(&mut simulated, 3);
        assert!(loaded.words > 70_000 && loaded.rounds == 1, "{loaded:?}");
        assert_eq!(simulated.shown(), pictures, "seed {seed}");
        assert!(same_words(&design, &simulated.network(1).unwrap(), &new));
    }
}

#[test]
fn only_words_that_differ_are_sent() {
    let design = tiny();
    let old = network(&design, 1);
    let new = retrained(&old);
    let known = [old.clone()];
    let words = |bank: &Job<'_>| {
        let mut simulated = board(&design, &old);
        let loaded = load(&mut simulated, bank).unwrap();
        frames(&mut simulated, 3);
        assert_eq!(simulated.shown().last(), Some(&picture(&design, &new)));
        loaded.words
    };
    // A few thresholds of each of three stages: their parts, or where the network is known, their words.
    assert_eq!(words(&job(&design, &new)), 3 * 8);
    assert_eq!(words(&Job { known: &known, ..job(&design, &new) }), 3 * 2);
    let all = words(&Job { full: true, known: &known, ..job(&design, &new) });
    assert!(all > 5_000, "{all}");
    let mut simulated = board(&design, &old);
    assert_eq!(load(&mut simulated, &job(&design, &old)).unwrap().words, 0);
}

#[test]
fn two_noise_classes_lie_in_two_banks_and_the_switch_takes_effect_between_frames() {
    let design = tiny();
    let [first, low, high] = [1, 2, 3].map(|seed| network(&design, seed));
    let mut simulated = board(&design, &first);
    let into = |bank, network| Job { bank: Some(bank), ..job(&design, network) };
    let loaded = load(&mut simulated, &into(Set::First, &low)).unwrap();
    assert_eq!((loaded.bank, loaded.in_use), ('a', 'a'));
    let loaded = load(&mut simulated, &into(Set::Second, &high)).unwrap();
    assert_eq!((loaded.bank, loaded.in_use), ('b', 'a'));
    let mut board = open(&mut simulated);
    let known = [first.clone(), low.clone(), high.clone()];
    for (bank, index) in [(Set::First, 1), (Set::Second, 2)] {
        let wanted = parts(&design, &first, bank);
        let crcs = board.crcs(&wanted.iter().collect::<Vec<_>>(), &mut unwatched).unwrap();
        assert_eq!(network_of(&design, &known, bank, &crcs), Some(index));
    }
    frames(&mut simulated, 3);
    simulated.forget_shown();
    for bank in [Set::Second, Set::First, Set::Second] {
        open(&mut simulated).switch(bank, 7).unwrap();
        frames(&mut simulated, 2);
        assert!(open(&mut simulated).is_in_use(bank).unwrap());
    }
    let [low, high] = [&low, &high].map(|network| picture(&design, network));
    // The frame that was in progress comes first.
    assert_eq!(simulated.shown(), [low.clone(), high.clone(), low, high]);
}

#[test]
fn what_does_not_fit_is_rejected_before_a_word_is_written() {
    let design = tiny();
    let old = network(&design, 1);
    let mut simulated = board(&design, &old);
    let mut other_window = design.clone();
    other_window.form.window = edof_core::Window::new(12).unwrap();
    let mut other_format = old.clone();
    other_format.code_bits = 12;
    let other_hash = Design { name: "another".into(), ..design.clone() };
    for (design, wrong, words) in [
        (&design, network(&other_window, 1), "windows of 12x12"),
        (&design, other_format, "12 bits cannot hold"),
        (&other_hash, old.clone(), "that of --design another is"),
    ] {
        let mut board = open(&mut simulated);
        let before = board.line().bytes;
        let error = board.load(&job(design, &wrong), &mut |_, _| ControlFlow::Continue(())).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        assert_eq!(board.line().bytes, before);
    }
}

#[test]
fn a_load_that_is_stopped_leaves_what_was_in_use() {
    let design = tiny();
    let [old, new] = [1, 2].map(|seed| network(&design, seed));
    for bank in [None, Some(Set::First), Some(Set::Second)] {
        let mut simulated = board(&design, &old);
        frames(&mut simulated, 3);
        let mut board = open(&mut simulated);
        let stopped = board.load(&Job { bank, ..job(&design, &new) }, &mut |done, _| {
            if done < 900 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        assert!(matches!(stopped, Err(Error::Interrupted)));
        // Never the bank that is half written.
        let whole = if bank == Some(Set::First) { Set::Second } else { Set::First };
        assert_eq!(board.bank().unwrap(), whole);
        frames(&mut simulated, 3);
        assert_eq!(simulated.shown(), [picture(&design, &old)]);
    }
}

#[test]
fn one_wrong_bit_is_found_and_told_where() {
    let design = tiny();
    let old = network(&design, 1);
    let mut simulated = board(&design, &old);
    let mut board = open(&mut simulated);
    // Stage 1, bank 1, row 5 of bank a, the low half; bank a is in use.
    let word = (1 << 21) | (1 << 13) | (5 << 1);
    board.set("protection.bank".parse().unwrap(), 0).unwrap();
    board.set(format!("weights[{word}]").parse().unwrap(), 0x1234_5678).unwrap();
    let found =
        board.verify(&design, &old, Set::First, false, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].part.as_str(), found[0].row), ("weights of M1, lanes 4 to 7", None));
    let found = board.verify(&design, &old, Set::First, true, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(found[0].row, Some(5));
    assert_eq!(
        board.verify(&design, &old, Set::Second, true, &mut |_, _| ControlFlow::Continue(())).unwrap(),
        []
    );
}

#[test]
fn a_load_that_reads_back_every_word_comes_to_its_end() {
    let design = tiny();
    let [old, new] = [1, 2].map(|seed| network(&design, seed));
    let mut simulated = board(&design, &old);
    let loaded = load(&mut simulated, &Job { read_back: true, ..job(&design, &new) }).unwrap();
    assert_eq!((loaded.rounds, loaded.in_use), (1, 'b'));
}

#[test]
fn words_for_the_bank_in_use_and_for_tables_in_use_are_rejected() {
    let design = tiny();
    let old = network(&design, 1);
    let mut simulated = board(&design, &old);
    let mut board = open(&mut simulated);
    let word = |board: &mut Board<_>, name: &str| board.set(name.parse().unwrap(), 0x1234_5678);
    // Words of the first set of stage 1: a weight, thresholds, shifts.
    let of_bank_a = ["weights[0x200000]", "weights[0x280000]", "weights[0x380000]"];
    for name in of_bank_a.into_iter().chain(["display_tables[5]"]) {
        let error = word(&mut board, name).unwrap_err();
        assert!(matches!(error, Error::Refused { .. }), "{name}: {error}");
    }
    assert!(get(&mut board, "writes_refused") > 0);
    assert_eq!(
        board.verify(&design, &old, Set::First, true, &mut |_, _| ControlFlow::Continue(())).unwrap(),
        []
    );
    // Nor is control changed by a word that does not carry its complement, once it is protected.
    board.set("protection.control".parse().unwrap(), 1).unwrap();
    edof_board::protocol::write(map::CONTROL, &[0]).into_iter().for_each(|byte| board.line().byte(byte));
    assert_eq!(get(&mut board, "control"), map::register("control").unwrap().reset);
    board.switch(Set::Second, 0).unwrap();
    word(&mut board, of_bank_a[0]).unwrap();
    assert_eq!(
        board.verify(&design, &old, Set::First, false, &mut |_, _| ControlFlow::Continue(())).unwrap().len(),
        1
    );
    board.set("control.run".parse().unwrap(), 0).unwrap();
    word(&mut board, "display_tables[5]").unwrap();
}

#[test]
fn a_reset_leaves_the_bank_in_use_and_all_that_was_written() {
    let design = tiny();
    let [first, second, third] = [1, 2, 3].map(|seed| network(&design, seed));
    let mut simulated = board(&design, &first);
    for (new, control) in [(&second, 0b111), (&third, 0b011)] {
        load(&mut simulated, &job(&design, new)).unwrap();
        frames(&mut simulated, 3);
        simulated.forget_shown();
        simulated.reset();
        frames(&mut simulated, 3);
        assert_eq!(simulated.shown(), [picture(&design, new)]);
        let mut board = open(&mut simulated);
        assert_eq!([get(&mut board, "control"), get(&mut board, "scratch")], [control, 0]);
        assert_eq!(get(&mut board, "weights_hash"), weights_hash(&design, new));
    }
}

#[test]
fn tables_of_the_display_change_while_the_picture_stands_still() {
    let design = tiny();
    let network = network(&design, 1);
    let mut simulated = board(&design, &network);
    frames(&mut simulated, 3);
    let old = picture(&design, &network);
    let display = Display::new(DisplayMode::Colour, Curve::Bt709);
    let mut board = open(&mut simulated);
    // Above 1 all curves of luma are the same.
    assert_eq!(board.load_tables(&display, &mut |_, _| ControlFlow::Continue(())).unwrap(), 4 * 16384);
    assert_eq!(board.control().unwrap(), map::register("control").unwrap().reset);
    frames(&mut simulated, 3);
    assert_eq!(simulated.shown().len(), 2);
    assert_eq!(simulated.shown()[0], old);
    assert!(matches!(&simulated.shown()[1], Shown::Whole(_)), "of neither table");
}

#[test]
fn tables_are_verified_by_the_circuits_crcs_and_only_what_differs_is_sent() {
    let design = tiny();
    let mut simulated = board(&design, &network(&design, 1));
    let mut board = open(&mut simulated);
    let known =
        [Curve::Linear, Curve::Srgb, Curve::Bt709].map(|curve| Display::new(DisplayMode::Colour, curve));
    let old = Display::default();
    assert_eq!(board.verify_tables(&old, &mut unwatched).unwrap(), []);
    assert_eq!(board.verify_tables(&known[2], &mut unwatched).unwrap().len(), 4);
    assert_eq!(board.load_tables(&old, &mut |_, _| ControlFlow::Continue(())).unwrap(), 0);
    board.load_tables(&known[2], &mut |_, _| ControlFlow::Continue(())).unwrap();
    let crcs = board.crcs(&table_parts(&old).iter().collect::<Vec<_>>(), &mut unwatched).unwrap();
    assert_eq!(display_of(&known, &crcs), Some(2));
    // One entry of the red table, in its last row.
    board.set("control.run".parse().unwrap(), 0).unwrap();
    board.set(format!("display_tables[{}]", 32768 + 16383).parse().unwrap(), 5).unwrap();
    let found = board.verify_tables(&known[2], &mut unwatched).unwrap();
    assert_eq!(found.iter().map(|d| d.part.as_str()).collect::<Vec<_>>(), ["table of red"]);
    assert_eq!(board.load_tables(&known[2], &mut |_, _| ControlFlow::Continue(())).unwrap(), 16384);
}
