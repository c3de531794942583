//! `edof board sim`: a simulated board, for users without a board.

use super::of;
use crate::cosim_system::{crop, size};
use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use edof_board::Simulated;
use edof_board::terminal::{Device, InRust, Terminal};
use edof_core::RawFrame;
use edof_cosim::system::{FirstLight, Speed, VerilogBoard};
use edof_cosim::verilator::Options;
use edof_device::Design;
use edof_device::board::Board;
use edof_device::design::FrameSize;
use edof_device::video::VideoTiming;
use edof_golden::{Display, Picture};
use edof_io::{photo, raw};
use edof_network::FixedNetwork;
use ndarray::Array2;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Simulate a board behind a pseudo-terminal until Ctrl-C, with the registers, memories and pictures of a real one
///
/// The board is a model in Rust. It receives one raw frame repeatedly, at the frame rate of the design's video mode. Each picture takes as long as in the
/// design's calculator. The board's time advances with wall-clock time and with every byte on the line. With --rtl the board is the circuit itself, in Verilator, at some
/// hundred thousand cycles per second; use a design with small frames (--size) and a fast line (--baud 12500000 is 16 cycles per bit).
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board sim --design tiny --link /tmp/board --picture out.png
  edof board sim --rtl --design tiny --size 64x64 --baud 12500000 --link /tmp/board")]
pub struct Args {
    /// Simulate the Verilog of the whole core, with a serial line at its pins, instead of the model in Rust
    #[arg(long)]
    rtl: bool,

    /// Create this symbolic link to the pseudo-terminal
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,

    /// File for the output picture, written whenever it changes: .png, .tif, .ppm, or .yuyv for the codes on the wire
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,

    /// Initial network of both banks [default: a built-in one that fits, else a random one]
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Raw frame that the board receives repeatedly, of the design's size or larger [default: a synthetic one]
    #[arg(long, value_name = "FILE")]
    frame: Option<PathBuf>,

    /// Size of frames instead of the design's
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<(usize, usize)>,
}

impl Args {
    /// Adds what the simulated board reads and writes.
    ///
    /// # Errors
    /// A picture of a format that does not exist.
    pub fn writes(&self, files: Files) -> Result<Files, Error> {
        let weights = self.weights.as_deref().and_then(weights::fixed_file);
        let files = files.reads_all(&self.frame).reads_all(weights).may_write("--link", self.new_link());
        match &self.picture {
            Some(file) if !is_codes(file) => files.writes_picture("--picture", file),
            file => Ok(files.may_write("--picture", file.as_ref())),
        }
    }
}

impl Args {
    /// Rejects what only a board has that takes video by cable.
    fn check_video(&self, board: &Board) -> Result<(), Error> {
        let given = [("--frame", self.frame.is_some()), ("--picture", self.picture.is_some())];
        let name = board.name;
        match given.into_iter().find(|(_, is_given)| *is_given) {
            _ if board.is_cabled() => Ok(()),
            _ if !self.rtl => Err(Error::message(format!(
                "board {name} takes no video by cable; add --rtl, which simulates its circuit"
            ))),
            Some((option, _)) => Err(Error::message(format!(
                "{option}: board {name} takes no video by cable; leave {option} out, and use 'edof board picture put' and 'get'"
            ))),
            None => Ok(()),
        }
    }

    /// Returns the link, unless one of that name leads nowhere: an earlier run left it behind, and it is replaced, not followed.
    fn new_link(&self) -> Option<&Path> {
        self.link.as_deref().filter(|link| link.exists() || !link.is_symlink())
    }
}

/// Whether a picture is kept as the codes on the wire.
fn is_codes(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == "yuyv")
}

/// # Errors
/// What does not fit, or no pseudo-terminal.
pub fn run(args: &super::Args, sim: &Args, ui: &Ui) -> Result<(), Error> {
    let given = args.design.as_deref().unwrap_or("tiny");
    let design = sized(designs::load(given)?, sim.size)?;
    design.check_board().and_then(|()| design.check_video()).map_err(|e| said::of_file(given, e))?;
    sim.check_video(design.board)?;
    let baud = args.baud_of(&design);
    let network = network(&design, given, sim.weights.as_deref())?;
    let (raw, display) = (frame(&design, sim)?, Display::of_network(&network));
    let raw = raw.encoded(network.origin.values).into_owned();
    let mut device: Box<dyn Device> = if sim.rtl {
        let with = (Speed::of(design.board, baud)?, 1);
        ui.note("compiling the design with Verilator");
        let options = Options { cache: Options::user_cache(), ..Options::default() };
        if !design.board.is_cabled() {
            Box::new(FirstLight::new(&design, [&network; 2], &display, with, &options)?)
        } else {
            Box::new(VerilogBoard::new(&design, [&network; 2], &display, &raw, with, &options)?)
        }
    } else {
        let board = Simulated::new(&design, [&network; 2], &display, raw, baud)?;
        Box::new(InRust::new(board, baud))
    };
    interrupt::check()?;
    let mut terminal = Terminal::open(sim.link.as_deref())?;
    ui.say(format!(
        "{}: {} with {}, {}x{} at {:.0} frames per second, calculator at {} MHz{}; Ctrl-C ends it",
        terminal.path().display(),
        design.name,
        network.origin.name,
        design.frame.width,
        design.frame.height,
        VideoTiming::of_frame(design.frame).frames_per_second(),
        design.clock_mhz,
        if sim.rtl { ", in Verilog" } else { "" }
    ))?;
    if sim.rtl {
        ui.note("the circuit is simulated hundreds of times slower than a board: commands take minutes and show how far they are; 'edof board info --quick' answers first");
    }
    let mut shown = None;
    while interrupt::check().is_ok() {
        terminal.serve(&mut *device).map_err(of)?;
        let Some(file) = &sim.picture else { continue };
        let now = device.picture();
        if now != shown {
            if let Some(words) = &now {
                write(file, words, design.frame, is_codes(file))?;
            }
            shown = now;
        }
    }
    let ([from, to], seconds) = device.carried();
    ui.say(format!(
        "{from} bytes from the host, {to} to it: {seconds:.3} s on a line of {} bits per second",
        baud
    ))?;
    ui.json(&json!({
        "kind": if sim.rtl { "rtl" } else { "rust" },
        "bytes_from_host": from,
        "bytes_to_host": to,
        "line_seconds": seconds,
        "baud": baud,
        "mixed_pictures": device.mixed(),
    }))
}

fn sized(mut design: Design, size: Option<(usize, usize)>) -> Result<Design, Error> {
    if let Some((width, height)) = size {
        design.frame = FrameSize { width, height, ..design.frame };
    }
    design.check().map_err(|e| match size {
        Some((width, height)) => said::instead(&format!("--size {width}x{height}"), &e),
        None => e.into(),
    })?;
    Ok(design)
}

fn network(design: &Design, given: &str, named: Option<&str>) -> Result<FixedNetwork, Error> {
    if let Some(name) = named {
        let network = weights::fixed(name)?;
        designs::fits_given(design, given, &network)?;
        return Ok(network);
    }
    let own = super::known(design, &[]).into_iter().next();
    Ok(own.unwrap_or_else(|| edof_device::random::for_design(design, 1)))
}

fn frame(design: &Design, sim: &Args) -> Result<RawFrame, Error> {
    let size = design.frame;
    let Some(file) = &sim.frame else {
        let drawn = edof_cosim::system::drawn(size, 1, 1)?;
        return drawn.into_iter().next().ok_or_else(|| Error::message("no frame"));
    };
    let large = raw::load(file, &raw::RawOptions::default())?;
    let (height, width) = large.size();
    if height < size.height || width < size.width {
        let problem = format!(
            "--frame {}: {width}x{height}, must be at least {}x{}, the design's frame; or give --size",
            file.display(),
            size.width,
            size.height
        );
        return Err(Error::message(problem));
    }
    crop(&large, (0, 0), size)
}

fn write(file: &Path, words: &[u16], size: FrameSize, codes: bool) -> Result<(), Error> {
    if codes {
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        edof_core::storage::atomic::write(file, &bytes)?;
        return Ok(());
    }
    let at = |row: usize, column: usize| words[row * size.width + column].to_le_bytes();
    let chroma = |odd: usize| {
        Array2::from_shape_fn((size.height, size.width / 2), |(row, pair)| at(row, 2 * pair + odd)[1])
    };
    let picture = Picture {
        luma: Array2::from_shape_fn((size.height, size.width), |(row, column)| at(row, column)[0]),
        chroma: [chroma(0), chroma(1)],
    };
    photo::save(file, &picture.shown_frame(), 8)?;
    Ok(())
}
