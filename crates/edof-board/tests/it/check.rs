//! The check of frames: exact where the board is right, and every fault named by the boundary at which it shows first.

use crate::common::{BAUD, board, network, open, raw, tiny};
use edof_board::check::{Boundary, Checked};
use edof_board::self_test::SelfTest;
use edof_board::simulated::faults::Faults;
use edof_board::{Error, Simulated};
use edof_core::RawFrame;
use edof_core::cable::carried;
use edof_device::pattern::Pattern;
use edof_golden::video::pattern;
use edof_golden::{Display, Golden};
use edof_network::FixedNetwork;
use std::ops::ControlFlow;

fn checked(faults: Faults, pattern: Pattern) -> Checked {
    let (design, network) = (tiny(), network(&tiny(), 3));
    let mut line = board(&design, &network);
    line.plant(faults);
    let mut board = open(line);
    let raw = pattern::frame(pattern, design.frame).unwrap();
    let golden = Golden::new(network).unwrap().checks(&Display::default(), &raw).unwrap();
    board.set_pattern(Some(pattern)).unwrap();
    board.check_frames(&golden, 3, &mut |_, _| ControlFlow::Continue(())).unwrap()
}

fn first(faults: Faults) -> Boundary {
    checked(faults, Pattern::Noise).difference.unwrap().boundary
}

#[test]
fn a_board_that_is_right_is_exact_with_every_pattern() {
    for pattern in Pattern::ALL {
        assert_eq!(checked(Faults::default(), pattern), Checked { frames: 3, difference: None });
    }
}

#[test]
fn frames_of_a_source_are_checked_as_well() {
    let (design, network) = (tiny(), network(&tiny(), 3));
    let mut board = open(board(&design, &network));
    let golden = Golden::new(network).unwrap().checks(&Display::default(), &carried(&raw(&design))).unwrap();
    let found = board.check_frames(&golden, 2, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(found.difference, None);
    board.set_pattern(Some(Pattern::Ramp)).unwrap();
    let found = board.check_frames(&golden, 2, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(found.difference.unwrap().boundary, Boundary::Raw);
}

fn each_word(raw: RawFrame, change: fn(u16) -> u16) -> RawFrame {
    RawFrame::from_values(raw.pixels().mapv(change), 16, raw.phase()).unwrap()
}

#[test]
fn a_stuck_bit_of_the_memory_shows_in_raw_frames() {
    let stuck = |raw: RawFrame| each_word(raw, |word| word | 0x0100);
    assert_eq!(first(Faults { raw: Some(stuck), ..Faults::default() }), Boundary::Raw);
}

#[test]
fn exchanged_bytes_show_where_they_are_exchanged() {
    let exchanged = |raw: RawFrame| each_word(raw, u16::swap_bytes);
    assert_eq!(first(Faults { raw: Some(exchanged), ..Faults::default() }), Boundary::Raw);
    assert_eq!(first(Faults { codes: Some(u16::swap_bytes), ..Faults::default() }), Boundary::Sent);
}

#[test]
fn a_multiplier_that_ignores_its_weights_shows_in_its_stage() {
    let of_first = |mut network: FixedNetwork| {
        network.analysis.weights.row_mut(5).fill(1);
        network
    };
    assert_eq!(first(Faults { calculator: Some(of_first), ..Faults::default() }), Boundary::Stage(0, "I"));
    let of_last = |mut network: FixedNetwork| {
        network.dictionary.weights.row_mut(100).fill(1);
        network
    };
    let last = tiny().stages.len() - 1;
    assert_eq!(first(Faults { calculator: Some(of_last), ..Faults::default() }), Boundary::Stage(last, "F"));
}

#[test]
fn a_stage_that_is_a_bit_off_is_named() {
    let off = |mut network: FixedNetwork| {
        network.thresholds[1].iter_mut().for_each(|threshold| *threshold ^= 1);
        network
    };
    assert_eq!(first(Faults { calculator: Some(off), ..Faults::default() }), Boundary::Stage(1, "M"));
}

#[test]
fn a_board_whose_calculator_stands_still_is_rejected() {
    let (design, network) = (tiny(), network(&tiny(), 3));
    let line =
        Simulated::new(&design, [&network, &network], &Display::default(), raw(&design), BAUD).unwrap();
    let mut board = open(line);
    board.change_control(edof_device::registers::map::RUN, 0).unwrap();
    let golden = Golden::new(network).unwrap().checks(&Display::default(), &raw(&design)).unwrap();
    let error =
        board.check_frames(&golden, 1, &mut |_, _| ControlFlow::Continue(())).unwrap_err().to_string();
    assert!(error.contains("no whole frame passes the calculator"), "{error}");
}

/// Parts that a self-test finds at fault, and what is said of the first.
fn failing(faults: Faults) -> (Vec<&'static str>, String) {
    let (design, network) = (tiny(), network(&tiny(), 3));
    let mut line = board(&design, &network);
    line.plant(faults);
    // The receiver and the transmitter are set up by then.
    crate::common::frames(&mut line, 200);
    let (golden, display) = (Golden::new(network).unwrap(), Display::default());
    let test = SelfTest { design: &design, golden: &golden, display: &display, clocks: true };
    let items = open(line).self_test(&test, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let failed: Vec<_> = items.into_iter().filter(|item| !item.passed).collect();
    let first = failed.first().map_or(String::new(), |item| item.detail.clone());
    (failed.iter().map(|item| item.part).collect(), first)
}

#[test]
fn a_self_test_passes_where_the_board_is_right() {
    assert_eq!(failing(Faults::default()), (vec![], String::new()));
}

#[test]
fn a_self_test_tells_how_far_it_is_and_stops_when_asked() {
    let (design, network) = (tiny(), network(&tiny(), 3));
    let mut line = board(&design, &network);
    let (golden, display) = (Golden::new(network).unwrap(), Display::default());
    let test = SelfTest { design: &design, golden: &golden, display: &display, clocks: true };
    let mut steps = vec![];
    let mut progress = |done, total| {
        steps.push((done, total));
        ControlFlow::Continue(())
    };
    open(&mut line).self_test(&test, &mut progress).unwrap();
    let total = steps[0].1;
    assert!(steps.is_sorted() && steps.iter().all(|(done, of)| done < of && *of == total), "{steps:?}");
    // Bus and weights have steps, too.
    assert!(steps[0].0 == 0 && steps.iter().filter(|(done, _)| *done < 12).count() > 8, "{steps:?}");
    let mut stop = |done, _| if done < 9 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    assert!(matches!(open(line).self_test(&test, &mut stop), Err(Error::Interrupted)));
}

#[test]
fn a_self_test_names_the_cell_that_is_stuck() {
    let stuck = |raw: RawFrame| {
        let mut values = raw.pixels().clone();
        values[(7, 11)] |= 0x0200;
        RawFrame::from_values(values, 16, raw.phase()).unwrap()
    };
    let (parts, first) = failing(Faults { raw: Some(stuck), ..Faults::default() });
    assert_eq!(parts, ["raw memory"]);
    assert!(first.ends_with("; one bit is wrong: bit 9 of row 7, column 11"), "{first}");
}

#[test]
fn a_self_test_names_multipliers_and_memory_of_pictures() {
    let off = |mut network: FixedNetwork| {
        network.analysis.weights.row_mut(5).fill(1);
        network
    };
    let (parts, first) = failing(Faults { calculator: Some(off), ..Faults::default() });
    assert_eq!(parts, ["multipliers"]);
    assert!(first.contains("what stage 0 (I) sends differ first"), "{first}");
    let (parts, _) = failing(Faults { codes: Some(u16::swap_bytes), ..Faults::default() });
    assert_eq!(parts, ["picture memory"]);
}
