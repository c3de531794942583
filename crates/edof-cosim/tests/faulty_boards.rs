//! Faults of the circuit's board, in its memory and in its files: the check of frames and the self-test find each, and name its place.

use crate::planted_faults::replaced;
use crate::simulated_board::Setup;
use edof_board::Board;
use edof_board::check::Boundary;
use edof_board::link::PATIENCE;
use edof_board::self_test::SelfTest;
use edof_cosim::bench::axi::WordFault;
use edof_cosim::system::VerilogBoard;
use edof_device::board::KC705;
use edof_device::pattern::Pattern;
use edof_golden::Golden;
use edof_golden::video::pattern;
use edof_hdl::project::Project;
use std::ops::ControlFlow;

/// As in `checking`.
const FAST: u32 = 25_000_000;

fn setup() -> Setup {
    Setup::tiny(FAST)
}

fn with_memory(fault: WordFault, seed: u64) -> VerilogBoard {
    let mut line = setup().in_verilog(seed);
    line.memory().fault = Some(fault);
    line
}

/// The boundary at which noise differs first.
fn first(setup: &Setup, line: VerilogBoard) -> Boundary {
    let raw = pattern::frame(Pattern::Noise, setup.design.frame).unwrap();
    let golden = Golden::new(setup.sets[0].clone()).unwrap().checks(&setup.display, &raw).unwrap();
    let mut board = Board::open(line, PATIENCE).unwrap();
    board.set_pattern(Some(Pattern::Noise)).unwrap();
    let checked = board.check_frames(&golden, 6, &mut |_, _| ControlFlow::Continue(())).unwrap();
    checked.difference.expect("the fault is found").boundary
}

/// Parts that a self-test finds at fault except for the chips, which a core by itself has not, and what is said of the first.
fn failing(setup: &Setup, line: VerilogBoard) -> (Vec<&'static str>, String) {
    let golden = Golden::new(setup.sets[0].clone()).unwrap();
    let test = SelfTest { design: &setup.design, golden: &golden, display: &setup.display, clocks: false };
    let mut board = Board::open(line, PATIENCE).unwrap();
    let items = board.self_test(&test, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let is_chip = |part: &str| ["receiver", "transmitter"].contains(&part);
    let failed: Vec<_> = items.into_iter().filter(|item| !item.passed && !is_chip(item.part)).collect();
    let first = failed.first().map_or(String::new(), |item| item.detail.clone());
    (failed.iter().map(|item| item.part).collect(), first)
}

/// Bytes of a word of the memory.
const WORD: u64 = KC705.memory.word_bits as u64 / 8;

const fn is_picture(word: u64) -> bool {
    word * WORD >= KC705.memory.picture_buffers[0] as u64
}

/// A cell of one of the three buffers of raw frames: row 7, column 11 of frames of 32 columns, bit 9, always 1.
fn stuck_cell(word: u64, parts: &mut [u32]) {
    let pixel = 7 * 32 + 11;
    if word == u64::from(KC705.memory.buffer_bytes) / WORD + pixel / 32 {
        parts[(pixel % 32 / 2) as usize] |= 0x0200 << (16 * (pixel % 2));
    }
}

/// A data line that is always 0, in all words of raw frames.
fn stuck_line(word: u64, parts: &mut [u32]) {
    if !is_picture(word) {
        parts[3] &= !0x0001_0000;
    }
}

fn exchanged(parts: &mut [u32]) {
    parts.iter_mut().for_each(|part| *part = (*part & 0x00ff_00ff) << 8 | *part >> 8 & 0x00ff_00ff);
}

fn exchanged_bytes_of_raw_frames(word: u64, parts: &mut [u32]) {
    if !is_picture(word) {
        exchanged(parts);
    }
}

fn exchanged_bytes_of_pictures(word: u64, parts: &mut [u32]) {
    if is_picture(word) {
        exchanged(parts);
    }
}

#[test]
fn a_cell_that_is_stuck_is_named_by_row_column_and_bit() {
    let (parts, told) = failing(&setup(), with_memory(stuck_cell, 41));
    assert_eq!(parts, ["raw memory"], "{told}");
    assert!(told.ends_with("; one bit is wrong: bit 9 of row 7, column 11"), "{told}");
}

#[test]
fn exchanged_bytes_are_found_on_the_way_to_the_calculator_and_to_the_screen() {
    assert_eq!(first(&setup(), with_memory(exchanged_bytes_of_raw_frames, 42)), Boundary::Raw);
    assert_eq!(first(&setup(), with_memory(exchanged_bytes_of_pictures, 43)), Boundary::Sent);
}

#[test]
#[ignore = "a minute: scripts/soak.sh"]
fn a_stuck_data_line_and_exchanged_bytes_are_found_by_a_self_test() {
    let (parts, told) = failing(&setup(), with_memory(stuck_line, 44));
    assert_eq!(parts, ["raw memory"], "{told}");
    assert!(!told.contains("one bit is wrong"), "{told}");
    assert_eq!(failing(&setup(), with_memory(exchanged_bytes_of_raw_frames, 45)).0, ["raw memory"]);
    assert_eq!(failing(&setup(), with_memory(exchanged_bytes_of_pictures, 46)).0, ["picture memory"]);
}

/// What an edit of a stage's part does to boards: the stage's name at the boundary, and the part that a self-test names.
fn is_named(setup: &Setup, stage: usize, name: &'static str, edit: impl Fn(Project) -> Project) {
    assert_eq!(first(setup, setup.edited(47, &edit)), Boundary::Stage(stage, name));
    let (parts, told) = failing(setup, setup.edited(48, &edit));
    assert_eq!(parts, ["multipliers"], "{told}");
    assert!(told.contains(&format!("what stage {stage} ({name}) sends differ first")), "{told}");
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn multipliers_that_ignore_a_are_named_by_their_stage() {
    let value = ".value_i(steps[bank/8][25*ROWS:1])";
    let ignores = ".value_i(bank == 1 ? {(25 * ROWS){1'b0}} : steps[bank/8][25*ROWS:1])";
    for (stage, name) in [(0, "I"), (2, "M"), (3, "F")] {
        let part = format!("core.calculator.stages_{stage}.macc");
        is_named(&setup(), stage, name, |project| replaced(project, &part, value, ignores));
    }
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_stage_that_is_a_bit_off_is_named() {
    let (round, down) = ("half_1_q <= (ONE << result_shift_i) >> 1;", "half_1_q <= 48'd0;");
    let part = "core.calculator.stages_3.results.requantize_even";
    is_named(&Setup::moderate(FAST), 3, "F", |project| replaced(project, part, round, down));
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn exchanged_halves_of_a_word_are_found_where_they_are_exchanged() {
    let setup = setup();
    let windows = |project| {
        replaced(
            project,
            "core",
            ".out_pixels_o(out_pixels)",
            ".out_pixels_o({out_pixels[15:0], out_pixels[31:16]})",
        )
    };
    assert_eq!(first(&setup, setup.edited(49, windows)), Boundary::Windows);
    let codes = |project| {
        replaced(
            project,
            "core",
            ".pixels_data_o(picture_data_o)",
            ".pixels_data_o({picture_data_o[7:0], picture_data_o[15:8]})",
        )
    };
    assert_eq!(first(&setup, setup.edited(50, codes)), Boundary::Codes);
}
