//! A network onto a board in memory, and what its screen shows: `cargo run --release -p edof-board --example load_a_network`

use edof_board::load::Job;
use edof_board::simulated::Shown;
use edof_board::{Board, Simulated, link};
use edof_core::{CfaPhase, RawFrame};
use edof_device::Design;
use edof_golden::{Display, Golden};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let design = Design::from_json(include_str!("../../../designs/tiny.json"))?;
    let [old, new] = [1, 2].map(|seed| edof_device::random::for_design(&design, seed));
    let raw = RawFrame::from_values(ndarray::Array2::from_elem((48, 64), 700), 12, CfaPhase::Rggb)?;

    // On a bench: edof_board::line::Serial::open("/dev/ttyUSB0", 921_600)?
    let line = Simulated::new(&design, [&old, &old], &Display::default(), raw.clone(), 921_600)?;
    let mut board = Board::open(line, link::PATIENCE)?;
    let job = Job { design: &design, network: &new, bank: None, full: false, read_back: false, known: &[] };
    let loaded = board.load(&job, &mut |_, _| std::ops::ControlFlow::Continue(()))?;
    println!("{} words into bank {}, which is in use", loaded.words, loaded.bank);

    // Two tenths of a second later its screen shows the golden picture.
    let later = board.line().now() + 200_000_000;
    board.line().pass_to(later);
    let golden = Golden::new(new)?.frame(&raw)?.picture(&Display::default()).0.yuyv();
    let Some(Shown::Whole(words)) = board.line().shown().last() else { return Err("no picture".into()) };
    assert!(words.iter().flat_map(|word| word.to_le_bytes()).eq(golden));
    println!("the screen shows the golden picture");
    Ok(())
}
