//! A raw frame over a line that loses, doubles and changes bytes, by hosts that end, to a board that is reset: what the calculator reads is that frame,
//! and the next put resumes.

use crate::common::{BAUD, board, frames, network, open, small, tiny};
use edof_board::faulty::{Fault, Faulty, Kind};
use edof_board::host_frame::{Put, line_time_of};
use edof_board::link::PATIENCE;
use edof_board::simulated::Shown;
use edof_board::simulated::faults::Faults;
use edof_board::{Board, Error, Line, Simulated};
use edof_core::draw::Draw;
use edof_core::{CfaPhase, RawFrame};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_device::host_frame::block_lines;
use edof_device::registers::map::{ID, VERSION};
use edof_golden::{Display, Golden};
use edof_network::FixedNetwork;
use ndarray::Array2;
use std::ops::ControlFlow;
use std::time::Duration;

/// Four blocks of 23 lines.
const WIDTH: usize = 96;
const HEIGHT: usize = 92;

struct Bench {
    design: Design,
    network: FixedNetwork,
    pixels: Array2<u16>,
}

impl Bench {
    fn new() -> Self {
        let design = small(tiny());
        let design = Design { frame: FrameSize { width: WIDTH, height: HEIGHT, ..design.frame }, ..design };
        let draw = &mut Draw::new(9);
        let pixels = Array2::from_shape_simple_fn((HEIGHT, WIDTH), || draw.bits() as u16);
        Self { network: network(&design, 1), design, pixels }
    }

    fn board(&self) -> Simulated {
        board(&self.design, &self.network)
    }

    /// The golden model's picture of the pixels.
    fn picture(&self, pixels: &Array2<u16>) -> Vec<u16> {
        let raw = RawFrame::from_values(pixels.clone(), 16, CfaPhase::Rggb).unwrap();
        let frame = Golden::new(self.network.clone()).unwrap().frame(&raw).unwrap();
        let bytes = frame.picture(&Display::default()).0.yuyv();
        bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect()
    }

    #[track_caller]
    fn shows(&self, board: &mut Simulated, pixels: &Array2<u16>) {
        frames(board, 4);
        let Some(Shown::Whole(shown)) = board.shown().last() else { panic!("no picture") };
        assert!(**shown == self.picture(pixels), "another picture is shown");
    }
}

fn put<L: Line>(line: L, pixels: &Array2<u16>) -> Result<Put, Error> {
    Board::open(line, PATIENCE)?.put_frame(pixels, &mut |_, _| ControlFlow::Continue(()))
}

const ALL: u64 = (WIDTH * HEIGHT / 2) as u64;

#[test]
fn a_frame_that_was_put_comes_back_as_the_golden_models_picture() {
    let bench = Bench::new();
    assert_eq!((block_lines(WIDTH, HEIGHT), block_lines(1920, 1080)), (23, 2));
    let mut board = bench.board();
    let put_all = put(&mut board, &bench.pixels).unwrap();
    assert_eq!(put_all, Put { blocks: 4, resumed: 0, words: ALL, repeated: 0 });
    bench.shows(&mut board, &bench.pixels);
    let codes = open(&mut board).get_codes((0, 0), (HEIGHT, WIDTH), &mut |_, _| ControlFlow::Continue(()));
    assert!(codes.unwrap().iter().eq(&bench.picture(&bench.pixels)), "the codes that come back differ");
    // What is there is not sent again; another frame is, as far as its blocks differ from those before them.
    assert_eq!(put(&mut board, &bench.pixels).unwrap().words, 0);
    let mut other = Array2::zeros((HEIGHT, WIDTH));
    other[(60, 8)] = 0xabcd;
    assert_eq!(
        put(&mut board, &other).unwrap(),
        Put { blocks: 4, resumed: 0, words: ALL / 4 + 2, repeated: 0 }
    );
    bench.shows(&mut board, &other);
    // And the source's frames again.
    open(&mut board).set_pattern(None).unwrap();
    frames(&mut board, 4);
    assert_eq!(board.shown().last(), Some(&crate::common::picture(&bench.design, &bench.network)));
}

#[test]
fn the_time_that_was_predicted_is_the_time_that_a_put_takes() {
    let bench = Bench::new();
    let mut board = bench.board();
    let before = open(&mut board).line().now();
    let mut host = open(&mut board);
    let start = host.line().now();
    host.put_frame(&bench.pixels, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let took = (host.line().now() - start) as f64 * 1e-9;
    let (ahead, turns) = line_time_of(&bench.pixels, 921_600);
    assert!(before <= start && turns == 4 * 7, "{turns}");
    // The choice of the frame and the check of it come besides.
    let rest = took - ahead.as_secs_f64();
    assert!((0.0..0.2).contains(&rest), "{took} s, {ahead:?} were predicted");
}

#[test]
fn a_whole_frame_of_the_default_design_takes_46_seconds_of_the_line() {
    let draw = &mut Draw::new(1);
    let pixels = Array2::from_shape_simple_fn((1080, 1920), || draw.bits() as u16);
    let (time, turns) = line_time_of(&pixels, 921_600);
    assert!((46.0..46.5).contains(&time.as_secs_f64()), "{time:?}");
    assert_eq!(turns, 540 * 10);
    // Of a smaller picture the black around it takes no words.
    let mut small = Array2::zeros((1080, 1920));
    small.slice_mut(ndarray::s![..480, ..640]).assign(&pixels.slice(ndarray::s![..480, ..640]));
    let (time, _) = line_time_of(&small, 921_600);
    assert!((6.5..8.5).contains(&time.as_secs_f64()), "{time:?}");
}

#[test]
fn a_put_that_was_interrupted_resumes_behind_the_last_block_that_is_the_same() {
    let bench = Bench::new();
    let mut board = bench.board();
    frames(&mut board, 2);
    let stop = |done: u64, _| {
        if done > 2 * ALL / 4 + 300 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut stop = stop;
    let error = open(&mut board).put_frame(&bench.pixels, &mut stop).unwrap_err();
    assert!(matches!(error, Error::Interrupted));
    // Until the frame is whole the board repeats the last one.
    frames(&mut board, 4);
    assert_eq!(board.shown().last(), Some(&crate::common::picture(&bench.design, &bench.network)));
    let resumed = put(&mut board, &bench.pixels).unwrap();
    assert_eq!(resumed, Put { blocks: 4, resumed: 2, words: ALL / 2, repeated: 0 });
    bench.shows(&mut board, &bench.pixels);
    // A frame that differs in a block that is there begins anew.
    open(&mut board).set_pattern(None).unwrap();
    let error = open(&mut board).put_frame(&bench.pixels, &mut stop).unwrap_err();
    assert!(matches!(error, Error::Interrupted));
    let mut other = bench.pixels.clone();
    other[(23, 0)] ^= 4;
    assert_eq!(put(&mut board, &other).unwrap().resumed, 0);
    bench.shows(&mut board, &other);
}

#[test]
fn a_frame_of_another_size_and_a_memory_that_changes_it_are_rejected_in_one_line() {
    let bench = Bench::new();
    let mut board = bench.board();
    let error = put(&mut board, &Array2::zeros((HEIGHT, WIDTH - 2))).unwrap_err().to_string();
    assert_eq!(error, "simulated board: a raw frame of 94x92 pixels, expected 96x92, the board's");
    let stuck = |raw: RawFrame| {
        RawFrame::from_values(raw.pixels().mapv(|word| word | 0x0100), 16, raw.phase()).unwrap()
    };
    board.plant(Faults { raw: Some(stuck), ..Faults::default() });
    let error = put(&mut board, &bench.pixels).unwrap_err();
    assert!(matches!(error, Error::FrameDiffers { .. }), "{error}");
    let mut board = bench.board();
    put(&mut board, &bench.pixels).unwrap();
    open(&mut board).change_control(edof_device::registers::map::RUN, 0).unwrap();
    let error = put(&mut board, &Array2::zeros((HEIGHT, WIDTH))).unwrap_err();
    assert!(matches!(error, Error::NoFrame { .. }), "{error}");
}

/// A put that meets a fault, and one that does not.
fn survives(bench: &Bench, bytes: [u64; 2], seed: u64) {
    let draw = &mut Draw::new(seed);
    let mut board = bench.board();
    let fault = Fault::drawn(draw, bytes);
    let outcome = put(Faulty::new(&mut board, fault), &bench.pixels);
    match &outcome {
        Ok(_) if fault.kind != Kind::Reset => bench.shows(&mut board, &bench.pixels),
        Ok(_) => {}
        Err(error) => assert!(fault.may_end_the_host(), "seed {seed}, {fault:?}: {error}"),
    }
    let again = put(&mut board, &bench.pixels);
    assert!(again.is_ok(), "seed {seed}, {fault:?}: {again:?}");
    bench.shows(&mut board, &bench.pixels);
}

fn survive_all(seeds: std::ops::Range<u64>) {
    let bench = Bench::new();
    let mut board = bench.board();
    put(&mut board, &bench.pixels).unwrap();
    for seed in seeds {
        survives(&bench, board.bytes, seed);
    }
}

#[test]
fn no_fault_of_100_on_the_line_is_lost() {
    survive_all(0..100);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn no_fault_of_5000_on_the_line_is_lost() {
    survive_all(1_000..6_000);
}

/// A board that no frame has reached: every register but those of its identity reads 0.
struct Black {
    answer: Vec<u8>,
    time: Duration,
}

impl Line for Black {
    fn name(&self) -> &str {
        "black"
    }

    fn baud(&self) -> u32 {
        BAUD
    }

    fn time(&self) -> Duration {
        self.time
    }

    fn send(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.time += Duration::from_millis(1);
        if let [2, count, rest @ ..] = bytes {
            let identity = if rest == [0; 4] { vec![ID, VERSION] } else { vec![] };
            let words = identity.into_iter().chain(std::iter::repeat(0)).take((*count).into());
            self.answer.extend(words.flat_map(u32::to_be_bytes));
        }
        Ok(())
    }

    fn receive(&mut self, max: usize, patience: Duration) -> std::io::Result<Vec<u8>> {
        if self.answer.is_empty() {
            self.time += patience;
        }
        Ok(self.answer.drain(..max.min(self.answer.len())).collect())
    }
}

#[test]
fn a_board_that_no_frame_reached_has_no_picture_after_a_second() {
    let mut board = open(Black { answer: vec![], time: Duration::ZERO });
    let error = board.check_picture().unwrap_err().to_string();
    assert!(error.contains("no picture yet, the screen is black; a frame must come first"), "{error}");
    assert!(board.line().time() < Duration::from_secs(5), "{:?}", board.line().time());
}

#[test]
fn a_board_with_frames_has_a_picture() {
    let design = small(tiny());
    let mut simulated = board(&design, &network(&design, 1));
    open(&mut simulated).check_picture().unwrap();
}
