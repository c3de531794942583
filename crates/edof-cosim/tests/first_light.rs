//! First light of the ULX3S, without a camera and with one: hosts talk to everything between its pins by the serial line alone, and every word is the
//! golden pipeline's.

use crate::common::{committed, moderate, root};
use crate::support;
use edof_board::Board;
use edof_board::chip_models::Timing;
use edof_board::diagnosis::findings;
use edof_board::link::PATIENCE;
use edof_board::load::Job;
use edof_board::self_test::SelfTest;
use edof_core::draw::Draw;
use edof_core::{CfaPhase, DisplayMode, RawFrame};
use edof_cosim::system::camera_to_screen::{Failure, Shown, Trip};
use edof_cosim::system::{self, FirstLight, Speed, first_light};
use edof_device::Design;
use edof_device::board::ULX3S;
use edof_device::design::FrameSize;
use edof_device::video::VideoTiming;
use edof_golden::{Curve, Display, Golden};
use edof_hdl::board::Pace;
use edof_hdl::project::Project;
use edof_network::FixedNetwork;
use ndarray::Array2;
use std::ops::ControlFlow;

/// Fewer cycles per bit than on the board; all else is the same.
const FAST: u32 = 6_250_000;

/// The committed design with frames of a part of the board's buffers, and a smaller network.
fn design() -> Design {
    let committed = committed("ulx3s");
    let frame = FrameSize { width: 32, height: 24, ..committed.frame };
    let small = Design::load(&root().join("tests/route/small.json")).unwrap();
    Design {
        frame,
        form: small.form,
        stages: small.stages,
        accumulator_bits: small.accumulator_bits,
        ..committed
    }
}

fn display() -> Display {
    Display::new(DisplayMode::Colour, Curve::Srgb)
}

fn pace(screen: VideoTiming) -> Pace {
    first_light::short_pace(Speed::of(&ULX3S, FAST).unwrap(), screen)
}

fn project(network: &FixedNetwork) -> Project {
    let pace = pace(first_light::small_screen(&design()));
    first_light::project(&design(), [network; 2], &display(), &pace).unwrap()
}

fn start(project: &Project, seed: u64) -> FirstLight {
    let pace = pace(first_light::small_screen(&design()));
    FirstLight::start(project, &design(), (pace, seed), &support::options()).unwrap()
}

/// The screen's own timing, as another source has it.
#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_screen_at_the_pins_shows_every_pixel_of_the_golden_picture_and_black_around_it() {
    let design = design();
    let network = moderate(&design, 5);
    let screen = design.screen();
    let project = first_light::project(&design, [&network; 2], &display(), &pace(screen)).unwrap();
    let raw = &system::drawn(design.frame, 1, 5).unwrap()[0];
    let mut simulated = start(&project, 1);
    let mut board = Board::open(&mut simulated, PATIENCE).unwrap();
    let words = Array2::from_shape_vec(raw.size(), system::sent(raw)).unwrap();
    board.put_frame(&words, &mut |_, _| ControlFlow::Continue(())).unwrap();
    simulated.connect_screen().unwrap();
    // Frames end with their vertical sync: up to one is cut at the start, and the next ones are whole.
    let mut frames = vec![];
    while frames.len() < 3 {
        simulated.steps(1_000_000).unwrap();
        frames = simulated.cable.as_ref().unwrap().receiver.frames().unwrap();
    }
    let golden = Golden::new(network).unwrap().frame(raw).unwrap().picture(&display()).0;
    let frame = &frames[2];
    assert_eq!((frame.timing.line.total(), frame.timing.frame.total()), (800, 525));
    assert_eq!(Timing { khz: Timing::VGA.khz, ..frame.timing }, Timing::VGA);
    assert_eq!(frame.negative, [true; 2]);
    assert!(frame.pixels == first_light::on_screen(&golden, screen));
}

/// A frame of the host's goes round: every boundary has the golden words, and the picture that comes back is the golden one.
fn goes_round(board: &mut Board<&mut FirstLight>, raw: &RawFrame, network: &FixedNetwork) {
    let mut go_on = |_, _| ControlFlow::Continue(());
    let words = Array2::from_shape_vec(raw.size(), system::sent(raw)).unwrap();
    board.put_frame(&words, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let golden = Golden::new(network.clone()).unwrap();
    let expected = golden.checks(&display(), raw).unwrap();
    assert_eq!(board.check_frames(&expected, 2, &mut go_on).unwrap().difference, None);
    let found = board.get_codes((0, 0), raw.size(), &mut |_, _| ControlFlow::Continue(())).unwrap();
    let codes: Vec<u8> = found.into_iter().flat_map(u16::to_le_bytes).collect();
    assert_eq!(codes, golden.frame(raw).unwrap().picture(&display()).0.yuyv());
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_host_tries_every_part_loads_a_network_and_gets_golden_pictures_over_the_line() {
    let design = design();
    let [first, second] = [5, 6].map(|seed| moderate(&design, seed));
    let frames = system::drawn(design.frame, 2, 5).unwrap();
    let mut simulated = start(&project(&first), 1);
    let mut board = Board::open(&mut simulated, PATIENCE).unwrap();
    let golden = Golden::new(first.clone()).unwrap();
    let test = SelfTest { design: &design, golden: &golden, display: &display(), clocks: true };
    let items = board.self_test(&test, &mut |_, _| ControlFlow::Continue(())).unwrap();
    assert!(items.iter().all(|item| item.passed), "{items:?}");
    // Edges are counted, whose phase is random.
    let clocks = &items.last().unwrap().detail;
    let screen = clocks.strip_prefix("at 50 MHz of the core: screen ").unwrap().split(' ').next().unwrap();
    assert!((screen.parse::<f64>().unwrap() - 25.0).abs() < 0.02, "{clocks}");
    assert!(clocks.ends_with("input 0.00 MHz"), "{clocks}");

    goes_round(&mut board, &frames[0], &first);
    let job = Job { design: &design, network: &second, bank: None, full: true, read_back: true, known: &[] };
    board.load(&job, &mut |_, _| ControlFlow::Continue(())).unwrap();
    goes_round(&mut board, &frames[1], &second);
    // The set-up of a camera that is not there has failed.
    assert_eq!(simulated.leds().unwrap(), 0b10_1001);

    // A reset in the midst of bursts: the memory completes them, and the network stays.
    simulated.reset().unwrap();
    let mut board = Board::open(&mut simulated, PATIENCE).unwrap();
    goes_round(&mut board, &frames[0], &second);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_memory_that_loses_a_word_is_found() {
    let design = design();
    let network = moderate(&design, 5);
    let mut project = project(&network);
    let (_, text) = project.verilog.iter_mut().find(|(name, _)| name == "axi_sdram.v").unwrap();
    let right = "write_place_q + ";
    assert_eq!(text.matches(right).count(), 1, "{text}");
    *text = text.replace(right, "write_place_q - ");
    let mut simulated = start(&project, 1);
    let mut board = Board::open(&mut simulated, PATIENCE).unwrap();
    let golden = Golden::new(network).unwrap();
    let test = SelfTest { design: &design, golden: &golden, display: &display(), clocks: true };
    let items = board.self_test(&test, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let failed: Vec<&str> = items.iter().filter(|item| !item.passed).map(|item| item.part).collect();
    assert_eq!(failed, ["raw memory"], "{items:?}");
}

/// Frames of a camera.
fn frames(count: usize) -> Vec<RawFrame> {
    frames_of(design().frame, count)
}

fn frames_of(size: FrameSize, count: usize) -> Vec<RawFrame> {
    let draw = &mut Draw::new(7);
    let frame = |_| {
        let values = Array2::from_shape_fn((size.height, size.width), |_| draw.whole(0, 255) as u16);
        RawFrame::from_values(values, 8, CfaPhase::Rggb).unwrap()
    };
    (0..count).map(frame).collect()
}

/// A camera's frames through a board to its screen.
fn shown(board: &mut FirstLight, golden: &Golden, frames: &[RawFrame], seed: u64) -> Result<Shown, Failure> {
    let screen = first_light::small_screen(&design());
    Trip { screen, golden, display: &display(), frames, seed }
        .run(board, &mut |_, _| ControlFlow::Continue(()))
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_camera_at_the_pins_makes_golden_pictures_at_the_pins_of_the_screen() {
    let network = moderate(&design(), 5);
    let mut simulated = start(&project(&network), 1);
    let found = shown(&mut simulated, &Golden::new(network).unwrap(), &frames(4), 1).unwrap();
    assert!(found.stops > 0 && found.screen_frames > 4, "{found:?}");
    assert_eq!(simulated.leds().unwrap(), 0b01_1111);
    // What a host says of the camera and its frames, and whether it is good.
    let look = Board::open(&mut simulated, PATIENCE).unwrap().look(design().stages.len()).unwrap();
    let chips = findings(&ULX3S, &look).into_iter().map(|chip| (chip.about, chip.is_good));
    assert_eq!(chips.collect::<Vec<_>>(), [("camera", true), ("input", true)]);
}

/// Two frames of the board's own size, at its own speeds, which smaller frames and faster lines do not have; through a text that was edited.
fn at_full_size(file: &str, right: &str, wrong: &str) -> Result<Shown, Failure> {
    let mut design = Design { frame: committed("ulx3s").frame, ..design() };
    // More pictures a second than the memory lets pass.
    design.stages[2].lanes = 32;
    let network = moderate(&design, 5);
    let pace = Pace::of(&ULX3S);
    let mut project = first_light::project(&design, [&network; 2], &display(), &pace).unwrap();
    let (_, text) = project.verilog.iter_mut().find(|(name, _)| name == file).unwrap();
    assert_eq!(text.matches(right).count(), 1, "{file}: {right}");
    *text = text.replace(right, wrong);
    let mut board = FirstLight::start(&project, &design, (pace, 1), &support::options()).unwrap();
    let golden = Golden::new(network).unwrap();
    let frames = frames_of(design.frame, 2);
    let (screen, display) = (design.screen(), &display());
    Trip { screen, golden: &golden, display, frames: &frames, seed: 1 }
        .run(&mut board, &mut |_, _| ControlFlow::Continue(()))
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn pictures_of_the_boards_own_size_are_whole_though_the_memory_refreshes_twice_as_often() {
    let interval = "REFRESH_INTERVAL = 12'd389";
    let shown = at_full_size("axi_sdram.v", interval, "REFRESH_INTERVAL = 12'd194").unwrap();
    // The camera sends 31 frames a second, of which the calculator takes as many as the memory lets it.
    let rate = shown.pictures_per_second.unwrap();
    println!("{rate:.1} pictures per second");
    assert!((20.0..32.0).contains(&rate), "{rate} pictures per second");
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn readers_that_take_turns_give_the_screen_too_little() {
    let first = "if (read_0_ar_valid_i && (again_q == 2'd0))";
    let turns = at_full_size("axi_pair_w128_s16.v", first, "if (read_0_ar_valid_i)").unwrap_err().to_string();
    assert!(turns.contains("golden up to the codes that come out"), "{turns}");
}

/// A file, its text, a mistake in its place, and what is said of it.
const MISTAKES: [(&str, &str, &str, &str); 6] = [
    (
        "camera_in.v",
        "if (light_q[0]) data_o",
        "if (light_q[1]) data_o",
        "raw frames that come out of the memory",
    ),
    (
        "axi_sdram.v",
        "write_place_q + 21'd1",
        "write_place_q + 21'd2",
        "raw frames that come out of the memory",
    ),
    ("axi_sdram.v", "if (until_refresh_q == 12'd0) due_q <= 1'b1;", "", "refreshes in"),
    ("requantize.v", "half_1_q <= (ONE << result_shift_i) >> 1;", "half_1_q <= 48'd0;", "what stage 0"),
    ("dvi.v", ".byte_i(colours[23:16])", ".byte_i(colours[15:8])", "golden up to the codes that come out"),
    (
        "border.v",
        "if (row_q == END_ROW) in_rows_q",
        "if (row_q == END_ROW - 13'd1) in_rows_q",
        "the screen's cable",
    ),
];

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn mistakes_anywhere_between_camera_and_screen_are_found_and_placed() {
    let network = moderate(&design(), 5);
    let golden = Golden::new(network.clone()).unwrap();
    for (file, right, wrong, place) in MISTAKES {
        let mut project = project(&network);
        let (_, text) = project.verilog.iter_mut().find(|(name, _)| name == file).unwrap();
        assert_eq!(text.matches(right).count(), 1, "{file}: {right}");
        *text = text.replace(right, wrong);
        let said = shown(&mut start(&project, 1), &golden, &frames(2), 1).unwrap_err().to_string();
        assert!(said.contains(place), "{file}: {wrong}: {said}");
    }
}
