//! `edof board check`.

use super::memories::{Memories, Wanted};
use super::{fits, known, load, of};
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use crate::weights;
use edof_board::check::{Checked, Difference};
use edof_board::contents::letter;
use edof_board::{Board, Serial};
use edof_core::DisplayMode;
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::pattern::Pattern;
use edof_device::registers::map;
use edof_golden::video::pattern;
use edof_golden::{Display, Golden};
use edof_network::FixedNetwork;
use serde_json::json;

/// Compare the board with the golden model, frame by frame, at speed, without a source or a screen
///
/// The board makes raw frames of a pattern itself. Its CRC-32 of each frame is compared with the golden model's at every boundary: raw frames from the
/// memory, windows, outputs of each stage, codes into the memory and from it. The first boundary that differs is named. Afterwards the
/// board uses the source's frames again.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board check
  edof board check --frames 1000 --pattern noise")]
pub struct Args {
    /// Network in use, by name or file [default: detected among the built-in ones]
    pub(super) weights: Option<String>,

    /// Frames to compare per pattern, 1 to 100000
    #[arg(long, default_value_t = 10, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,

    /// Pattern: ramp, chart, noise, zeros, ones or alternating [default: all six, one after the other]
    #[arg(long, value_name = "PATTERN")]
    pattern: Option<Pattern>,
}

/// # Errors
/// A board that differs, an unknown network, a line that fails, or Ctrl-C.
pub fn run(args: &super::Args, check: &Args, ui: &Ui) -> Result<(), Error> {
    let mut board = args.open()?;
    let design = args.design_of(&board)?;
    let (network, display) = in_use(&mut board, &design, check.weights.as_deref(), ui)?;
    let golden = Golden::new(network)?;
    let patterns = check.pattern.map_or_else(|| Pattern::ALL.to_vec(), |pattern| vec![pattern]);
    let mut results = vec![];
    for pattern in patterns {
        let raw = pattern::frame(pattern, design.frame)?;
        let expected = golden.checks(&display, &raw)?;
        let bar = ui.progress(u64::from(check.frames), "frames compared");
        let mut step = |done, _| {
            bar.set(u64::from(done));
            interrupt::flow()
        };
        board.set_pattern(Some(pattern)).map_err(of)?;
        let checked = board.check_frames(&expected, check.frames, &mut step);
        board.set_pattern(None).map_err(of)?;
        let checked = checked.map_err(of)?;
        drop(bar);
        tell(pattern, &checked, ui)?;
        results.push((pattern, checked));
    }
    let of_pattern =
        |(pattern, checked): &(Pattern, Checked)| json!({ "pattern": pattern.name(), "checked": checked });
    ui.json(&json!({
        "design": design.name,
        "is_exact": results.iter().all(|(_, checked)| checked.difference.is_none()),
        "patterns": results.iter().map(of_pattern).collect::<Vec<_>>(),
    }))?;
    match results.iter().find_map(|(pattern, checked)| checked.difference.map(|found| (pattern, found))) {
        None => ui.say("bit-exact on this board, at speed"),
        Some((pattern, Difference { boundary, expected, found })) => Err(Error::message(format!(
            "{}: pattern {pattern}: {boundary} differ first: CRC {found:08x}, expected {expected:08x}",
            board.port()
        ))),
    }
}

fn tell(pattern: Pattern, checked: &Checked, ui: &Ui) -> Result<(), Error> {
    let frames = checked.frames;
    ui.say(match &checked.difference {
        None => format!("{pattern}: {frames} frames, every boundary as the golden model's"),
        Some(Difference { boundary, .. }) => format!("{pattern}: {boundary} differ first, in frame {frames}"),
    })
}

/// The network and the display in use, as [`network_in_use`] and [`display_of`].
pub fn in_use(
    board: &mut Board<Serial>,
    design: &Design,
    named: Option<&str>,
    ui: &Ui,
) -> Result<(FixedNetwork, Display), Error> {
    let bank = board.bank().map_err(of)?;
    let memories = Memories::read(board, Some(design), &Wanted { banks: &[bank], tables: true }, ui)?;
    let network = network_of(board, design, &memories, (bank, named))?;
    Ok((network, display_of(board, &memories)?))
}

/// The network in the bank in use, which is the named one if one is.
pub fn network_in_use(
    board: &mut Board<Serial>,
    design: &Design,
    named: Option<&str>,
    ui: &Ui,
) -> Result<FixedNetwork, Error> {
    let bank = board.bank().map_err(of)?;
    let memories = Memories::read(board, Some(design), &Wanted { banks: &[bank], tables: false }, ui)?;
    network_of(board, design, &memories, (bank, named))
}

fn network_of(
    board: &Board<Serial>,
    design: &Design,
    memories: &Memories,
    (bank, named): (Set, Option<&str>),
) -> Result<FixedNetwork, Error> {
    let candidates = match named.map(weights::fixed).transpose()? {
        Some(network) => {
            fits(design, &network)?;
            vec![network]
        }
        None => known(design, &[]),
    };
    let found = memories.network(design, &candidates, bank);
    found.and_then(|index| candidates.into_iter().nth(index)).ok_or_else(|| {
        let why = match named {
            Some(name) => format!("does not hold {name}; load it by 'edof board load {name}'"),
            None => "holds none of the networks that come with edof; name the file of yours, as in 'edof board check FILE' and \
                     'edof board picture compare RAW --weights FILE'"
                .to_owned(),
        };
        Error::message(format!("{}: bank {} {why}", board.port(), letter(bank)))
    })
}

/// The display in use: the curve that the tables are for, and the mode.
fn display_of(board: &mut Board<Serial>, memories: &Memories) -> Result<Display, Error> {
    let curve = load::curve_in(memories);
    let curve = curve.ok_or_else(|| of(edof_board::Error::UnknownTables { port: board.port() }))?;
    let is_colour = board.control().map_err(of)? & map::COLOUR != 0;
    let mode = if is_colour { DisplayMode::Colour } else { DisplayMode::Luma };
    Ok(Display { mode, ..load::display_of(curve) })
}
