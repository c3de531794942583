//! A board with a network, and others to load.

use edof_board::link::PATIENCE;
use edof_board::load::{Job, Loaded};
use edof_board::simulated::Shown;
use edof_board::{Board, Error, Line, Simulated};
use edof_core::cable::carried;
use edof_core::draw::Draw;
use edof_core::{CfaPhase, RawFrame};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_golden::{Display, Golden};
use edof_network::FixedNetwork;
use ndarray::Array2;
use std::ops::ControlFlow;

pub const BAUD: u32 = 921_600;

/// The design `tiny` with small frames.
pub fn tiny() -> Design {
    let design = Design::from_json(include_str!("../../../../designs/tiny.json")).unwrap();
    small(design)
}

/// A design with frames of a few patches.
pub fn small(design: Design) -> Design {
    Design { frame: FrameSize { width: 32, height: 24, ..design.frame }, ..design }
}

pub fn raw(design: &Design) -> RawFrame {
    let draw = &mut Draw::new(5);
    let size = (design.frame.height, design.frame.width);
    RawFrame::from_values(Array2::from_shape_fn(size, |_| draw.bits() as u16), 16, CfaPhase::Rggb).unwrap()
}

/// A random network whose pictures are not like those of another seed.
pub fn network(design: &Design, seed: u64) -> FixedNetwork {
    edof_device::random::for_design(design, seed)
}

/// A network that differs in a few thresholds alone.
pub fn retrained(network: &FixedNetwork) -> FixedNetwork {
    let mut network = network.clone();
    for threshold in network.thresholds.iter_mut().flat_map(|theta| theta.iter_mut().take(3)) {
        *threshold ^= 0x155;
    }
    network
}

pub fn board(design: &Design, network: &FixedNetwork) -> Simulated {
    Simulated::new(design, [network, network], &Display::default(), raw(design), BAUD).unwrap()
}

/// What the screen shows with a network.
pub fn picture(design: &Design, network: &FixedNetwork) -> Shown {
    let frame = Golden::new(network.clone()).unwrap().frame(&carried(&raw(design))).unwrap();
    let bytes = frame.picture(&Display::default()).0.yuyv();
    let words = bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect::<Vec<u16>>();
    Shown::Whole(words.into())
}

pub fn job<'a>(design: &'a Design, network: &'a FixedNetwork) -> Job<'a> {
    Job { design, network, bank: None, full: false, read_back: false, known: &[] }
}

pub fn open<L: Line>(line: L) -> Board<L> {
    Board::open(line, PATIENCE).unwrap()
}

pub fn load<L: Line>(line: L, job: &Job<'_>) -> Result<Loaded, Error> {
    Board::open(line, PATIENCE)?.load(job, &mut |_, _| ControlFlow::Continue(()))
}

/// Some frames' time.
pub fn frames(board: &mut Simulated, count: u64) {
    board.pass_to(board.now() + count * 17_000_000);
}

/// The words of two networks are the same, whatever their files say besides.
pub fn same_words(design: &Design, one: &FixedNetwork, other: &FixedNetwork) -> bool {
    use edof_device::design::memory::{Set, writes};
    writes(design, one, Set::First) == writes(design, other, Set::First)
}
