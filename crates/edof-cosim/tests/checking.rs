//! The check of frames, the self-test and the window to pictures, on both kinds of a simulated board: the circuit in Verilator, and the model in Rust.

use crate::common::networks;
use crate::edof_core::design;
use crate::simulated_board::Setup;
use edof_board::faulty::{Fault, Faulty, Kind, Resettable};
use edof_board::link::PATIENCE;
use edof_board::self_test::SelfTest;
use edof_board::{Board, Line};
use edof_core::cable::carried;
use edof_core::draw::Draw;
use edof_core::{CfaPhase, DisplayMode, RawFrame};
use edof_cosim::system::second::{Step, host_in_icarus};
use edof_cosim::system::{self, drawn, recorded};
use edof_device::design::FrameSize;
use edof_device::design::memory::{self, Space};
use edof_device::design::reading::{CHECK_REGISTER, READ_REGISTER, ReadBack, read_command};
use edof_device::pattern::{Pattern, TILE_SIDE};
use edof_device::registers::map::{self, STAGE_READS, WEIGHTS};
use edof_golden::video::pattern;
use edof_golden::{Curve, Display, FrameChecks, Golden};
use ndarray::{Array2, s};
use std::ops::ControlFlow;

/// A line so fast that the circuit's cycles between two looks are few.
const FAST: u32 = 25_000_000;
/// Frames of each kind that are compared at each run, and in the soak.
const FRAMES: [u32; 2] = [2, 100];

/// A crop of a photograph as a camera captures it: tests/photograph.
const PHOTOGRAPH: &str = include_str!("../../../tests/photograph/crop.pgm");

/// The photograph's first rows and columns.
fn photograph(size: FrameSize) -> RawFrame {
    let mut words = PHOTOGRAPH.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace);
    assert_eq!(words.next(), Some("P2"));
    let numbers: Vec<u16> = words.map(|word| word.parse().unwrap()).collect();
    let [width, height, max] = [0, 1, 2].map(|i| usize::from(numbers[i]));
    assert_eq!(max, (1 << 14) - 1);
    let values = Array2::from_shape_vec((height, width), numbers[3..].to_vec()).unwrap();
    let crop = values.slice(s![..size.height, ..size.width]).to_owned();
    RawFrame::from_values(crop, 14, CfaPhase::Rggb).unwrap()
}

/// The setup with the photograph at its receiver.
fn with_photograph() -> Setup {
    let mut setup = Setup::tiny(FAST);
    setup.raw = photograph(setup.design.frame);
    setup
}

/// Every pattern, and the frame at the receiver.
fn frames_are_exact<L: Line>(setup: &Setup, line: L, frames: u32) {
    let patterns = Pattern::ALL.map(|one| (Some(one), pattern::frame(one, setup.design.frame).unwrap()));
    sources_are_exact(setup, line, frames, patterns.into_iter().chain([(None, carried(&setup.raw))]));
}

/// The frame at the receiver.
fn received_frames_are_exact<L: Line>(setup: &Setup, line: L, frames: u32) {
    sources_are_exact(setup, line, frames, [(None, carried(&setup.raw))]);
}

fn sources_are_exact<L: Line>(
    setup: &Setup,
    line: L,
    frames: u32,
    sources: impl IntoIterator<Item = (Option<Pattern>, RawFrame)>,
) {
    let golden = Golden::new(setup.sets[0].clone()).unwrap();
    let mut board = Board::open(line, PATIENCE).unwrap();
    for (pattern, raw) in sources {
        let expected = golden.checks(&setup.display, &raw).unwrap();
        board.set_pattern(pattern).unwrap();
        let checked = board.check_frames(&expected, frames, &mut |_, _| ControlFlow::Continue(())).unwrap();
        assert_eq!((checked.frames, checked.difference), (frames, None), "{pattern:?}");
    }
    // What is another picture is seen, so that the circuit's CRCs are of what passes.
    let other = golden.checks(&setup.display, &pattern::frame(Pattern::Chart, setup.design.frame).unwrap());
    let checked = board.check_frames(&other.unwrap(), 1, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(checked.difference.unwrap().boundary.to_string(), "raw frames that come out of the memory");
}

#[test]
fn frames_are_exact_in_verilog() {
    let setup = Setup::tiny(FAST);
    frames_are_exact(&setup, setup.in_verilog(31), FRAMES[0]);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_hundred_frames_are_exact_in_verilog() {
    let setup = Setup::tiny(FAST);
    frames_are_exact(&setup, setup.in_verilog(32), FRAMES[1]);
}

#[test]
fn frames_are_exact_in_rust() {
    let setup = Setup::tiny(FAST);
    frames_are_exact(&setup, setup.in_rust(), FRAMES[1]);
}

#[test]
fn frames_of_a_photograph_are_exact_in_verilog() {
    let setup = with_photograph();
    received_frames_are_exact(&setup, setup.in_verilog(35), FRAMES[0]);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_hundred_frames_of_a_photograph_are_exact_in_verilog() {
    let setup = with_photograph();
    received_frames_are_exact(&setup, setup.in_verilog(36), FRAMES[1]);
}

#[test]
fn frames_of_a_photograph_are_exact_in_rust() {
    let setup = with_photograph();
    received_frames_are_exact(&setup, setup.in_rust(), FRAMES[1]);
}

/// Pictures after a source was chosen until every boundary but the last has seen it, frames on the slower screen until that has, and the
/// cycles that a copy of all CRCs takes.
const SETTLE: usize = 5;
const SHOWN: usize = 2;
const COPY: u32 = 120;
/// Frames on the screen after another source was chosen, until nothing of the one before is in the memory or on its way.
const EMPTY: usize = 6;

/// A host that compares N frames: each with a copy of its own of all CRCs.
fn comparison(golden: &FrameChecks, frames: usize) -> Vec<Step> {
    let status = |name: &str| map::register(name).unwrap().address;
    let mut steps = vec![Step::Changed(status("picture_frames")); SETTLE];
    steps.extend([Step::Changed(status("output_frames")); SHOWN]);
    for _ in 0..frames {
        let of_all = [
            ("raw", golden.raw),
            ("windows", golden.windows),
            ("codes", golden.codes),
            ("sent", golden.codes),
        ];
        steps.extend([
            Step::Changed(status("picture_frames")),
            Step::Write(WEIGHTS.word(memory::SNAPSHOT), 0),
        ]);
        steps.push(Step::Wait(COPY));
        steps.extend(of_all.map(|(name, crc)| Step::Expect(status(&format!("check_{name}")), crc)));
        // All stages read at the same time.
        for stage in 0..golden.stages.len() {
            let register = memory::address(stage, Space::Register { row: READ_REGISTER });
            let command = read_command(Space::Register { row: CHECK_REGISTER }, 1);
            steps.push(Step::Write(WEIGHTS.word(register), command));
        }
        steps.push(Step::Wait(COPY));
        for (stage, crc) in golden.stages.iter().enumerate() {
            let part = |part: ReadBack| STAGE_READS.word(4 * stage as u32 + part as u32);
            steps.extend([Step::Until(part(ReadBack::Busy), 0), Step::Expect(part(ReadBack::Low), *crc)]);
        }
    }
    steps
}

/// What the camera sends in Icarus.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sent {
    Drawn,
    Photograph,
}

/// Share of the recorded bench's time for a frame. That bench shows every picture once; here a frame that is dropped or computed again is as
/// good, so the camera may be faster than the calculator.
const HASTE: usize = 3;

/// N frames of each pattern, or of the source, through a core in Icarus: all CRCs as the golden pipeline's.
fn frames_are_exact_in_icarus(sent: Sent, sources: &[(Option<Pattern>, usize)]) {
    let design = design(8, 8, (16, 16));
    let sets = networks(&design, 7);
    let golden = Golden::new(sets[0].clone()).unwrap();
    let display = Display::new(DisplayMode::Colour, Curve::Srgb);
    let raw = match sent {
        Sent::Drawn => drawn(design.frame, 1, 5).unwrap().remove(0),
        Sent::Photograph => photograph(design.frame),
    };
    let id = map::register("id").unwrap();
    let run = map::running(display.mode, 0);
    let mut steps = vec![Step::Expect(id.address, id.reset), Step::Write(map::CONTROL, run)];
    for (pattern, frames) in sources {
        let made = pattern.map_or_else(|| carried(&raw), |one| pattern::frame(one, design.frame).unwrap());
        steps.push(Step::Write(map::PATTERN, pattern.map_or(0, Pattern::code)));
        if steps.len() > 3 {
            // FIFOs made for frames of 1080p hold many of these small ones.
            let flush = [
                Step::Write(map::CONTROL, run | map::FLUSH),
                Step::Wait(COPY),
                Step::Write(map::CONTROL, run),
            ];
            steps.extend(flush);
            steps.extend([Step::Changed(map::register("output_frames").unwrap().address); EMPTY]);
        }
        steps.extend(comparison(&golden.checks(&display, &made).unwrap(), *frames));
    }
    let project = system::project(&design, sets.each_ref(), &display).unwrap();
    // As many as the camera sends in this time, and more.
    let count: usize = sources.iter().map(|(_, frames)| 2 * (frames + SETTLE + SHOWN + EMPTY)).sum();
    let sent = vec![raw; count + 20];
    let pictures = vec![vec![0; design.frame.width * design.frame.height]; sent.len()];
    let mut video = recorded::video(&design, &sent, pictures, display.mode);
    video.cycles /= HASTE;
    println!("{}", host_in_icarus(&project, &video, &steps).unwrap());
    let wrong = [steps[0], Step::Expect(map::SCRATCH, 1)];
    let error = host_in_icarus(&project, &video, &wrong).unwrap_err().to_string();
    assert!(error.contains("step 1: address 00000018 is 00000000, expected 00000001"), "{error}");
}

#[test]
fn frames_are_exact_in_icarus_as_well() {
    frames_are_exact_in_icarus(Sent::Drawn, &[(Some(Pattern::Noise), 2)]);
}

#[test]
fn frames_of_a_photograph_are_exact_in_icarus_as_well() {
    frames_are_exact_in_icarus(Sent::Photograph, &[(None, 2)]);
}

#[test]
#[ignore = "a quarter of an hour: scripts/soak.sh"]
fn a_hundred_frames_are_exact_in_icarus() {
    let sources: Vec<_> =
        Pattern::ALL.into_iter().map(Some).chain([None]).map(|source| (source, 100)).collect();
    frames_are_exact_in_icarus(Sent::Drawn, &sources);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_hundred_frames_of_a_photograph_are_exact_in_icarus() {
    frames_are_exact_in_icarus(Sent::Photograph, &[(None, 100)]);
}

/// Every part passes but the chips and the clocks, which a simulated circuit has otherwise.
fn parts_pass<L: Line>(setup: &Setup, line: L) {
    let golden = Golden::new(setup.sets[0].clone()).unwrap();
    let test = SelfTest { design: &setup.design, golden: &golden, display: &setup.display, clocks: false };
    let items =
        Board::open(line, PATIENCE).unwrap().self_test(&test, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let parts: Vec<&str> = items.iter().map(|item| item.part).collect();
    let expected = [
        "bus",
        "weights",
        "raw memory",
        "windows",
        "multipliers",
        "display",
        "picture memory",
        "receiver",
        "transmitter",
        "clocks",
    ];
    assert_eq!(parts, expected);
    let is_chip = |part: &str| ["receiver", "transmitter"].contains(&part);
    assert!(items.iter().all(|item| item.passed || is_chip(item.part)), "{items:#?}");
}

#[test]
fn every_part_passes_in_verilog() {
    let setup = Setup::tiny(FAST);
    parts_pass(&setup, setup.in_verilog(33));
}

#[test]
fn every_part_passes_in_rust() {
    let setup = Setup::tiny(FAST);
    parts_pass(&setup, setup.in_rust());
}

/// A tile goes in, and the codes that come out are the golden model's, at both ends of the picture.
fn a_tile_comes_back<L: Line>(setup: &Setup, line: L) {
    let mut board = Board::open(line, PATIENCE).unwrap();
    let draw = &mut Draw::new(9);
    let tile = Array2::from_shape_simple_fn((TILE_SIDE, TILE_SIDE), || draw.bits() as u16);
    board.put_tile(&tile, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let frame = pattern::tiled(&tile, setup.design.frame).unwrap();
    let golden = Golden::new(setup.sets[0].clone()).unwrap();
    let expected = golden.checks(&setup.display, &frame).unwrap();
    assert_eq!(
        board.check_frames(&expected, 1, &mut |_, _| ControlFlow::Continue(())).unwrap().difference,
        None
    );
    let bytes = golden.frame(&frame).unwrap().picture(&setup.display).0.yuyv();
    let (height, width) = (setup.design.frame.height, setup.design.frame.width);
    for (row, column) in [(0, 0), (height - 5, width - 6)] {
        let codes = board
            .get_codes((row, column), (TILE_SIDE, TILE_SIDE), &mut |_, _| ControlFlow::Continue(()))
            .unwrap();
        for ((r, c), code) in
            codes.indexed_iter().filter(|((r, c), _)| row + r < height && column + c < width)
        {
            let at = 2 * ((row + r) * width + column + c);
            assert_eq!(
                *code,
                u16::from_le_bytes([bytes[at], bytes[at + 1]]),
                "row {r}, column {c} from {row}"
            );
        }
    }
}

#[test]
#[ignore = "half a minute, core_registers does it without the serial line: scripts/soak.sh"]
fn a_tile_comes_back_in_verilog() {
    let setup = Setup::tiny(FAST);
    a_tile_comes_back(&setup, setup.in_verilog(34));
}

#[test]
fn a_tile_comes_back_in_rust() {
    let setup = Setup::tiny(FAST);
    a_tile_comes_back(&setup, setup.in_rust());
}

/// A whole frame goes in and is used again and again, also after a byte on the line was lost; then the source's frames are used once more.
fn a_frame_goes_round<K: Resettable>(setup: &Setup, mut board: K) {
    let draw = &mut Draw::new(9);
    let size = (setup.design.frame.height, setup.design.frame.width);
    let golden = Golden::new(setup.sets[0].clone()).unwrap();
    let mut go_on = |_, _| ControlFlow::Continue(());
    for lost in [None, Some(1_000)] {
        let pixels = Array2::from_shape_simple_fn(size, || draw.bits() as u16);
        let fault = Fault { kind: Kind::Drop, to_board: true, at: lost.unwrap_or(u64::MAX) };
        let mut host = Board::open(Faulty::new(&mut board, fault), PATIENCE).unwrap();
        let put = host.put_frame(&pixels, &mut |_, _| ControlFlow::Continue(())).unwrap();
        assert_eq!((put.blocks, put.words >= pixels.len() as u64 / 2), (1, true));
        assert_eq!(host.repeats() > 0, lost.is_some());
        let frame = RawFrame::from_values(pixels, 16, CfaPhase::Rggb).unwrap();
        let expected = golden.checks(&setup.display, &frame).unwrap();
        assert_eq!(host.check_frames(&expected, 2, &mut go_on).unwrap().difference, None);
    }
    let mut host = Board::open(&mut board, PATIENCE).unwrap();
    host.set_pattern(None).unwrap();
    let expected = golden.checks(&setup.display, &carried(&setup.raw)).unwrap();
    assert_eq!(host.check_frames(&expected, 1, &mut go_on).unwrap().difference, None);
}

#[test]
fn a_frame_goes_round_in_verilog() {
    let setup = Setup::tiny(FAST);
    a_frame_goes_round(&setup, setup.in_verilog(35));
}

#[test]
fn a_frame_goes_round_in_rust() {
    let setup = Setup::tiny(FAST);
    a_frame_goes_round(&setup, setup.in_rust());
}
