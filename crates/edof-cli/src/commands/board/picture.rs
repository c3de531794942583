//! `edof board picture`.

use super::check::{display_in_use, network_in_use};
use super::of;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::ui::Ui;
use edof_board::{Board, Serial};
use edof_core::Tone;
use edof_device::design::FrameSize;
use edof_device::pattern::TILE_SIDE;
use edof_golden::video::pattern::tiled;
use edof_golden::{Golden, Picture};
use edof_io::{photo, raw};
use ndarray::{Array2, s};
use serde_json::json;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Send a part of a raw frame to the board over the line, and read the board's picture of it, without a source or a screen
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board picture put raw.png
  edof board picture get out.png
  edof board picture compare raw.png")]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Write 64 x 64 pixels of a raw frame to the board; its frames then repeat them
    Put {
        /// Raw frame: red first, 64 x 64 pixels or more
        raw: PathBuf,

        /// Column and row of the first pixel, both even [default: the middle]
        #[arg(long, value_name = "COLUMN,ROW", value_parser = place)]
        at: Option<(usize, usize)>,
    },
    /// Read 64 x 64 pixels of the board's picture
    Get {
        /// Picture file: .png, .tif, .ppm
        out: PathBuf,

        /// Column and row of the first pixel, the column even
        #[arg(long, value_name = "COLUMN,ROW", value_parser = place, default_value = "0,0")]
        at: (usize, usize),
    },
    /// Compare 64 x 64 pixels of the board's picture with the golden model's, code by code
    Compare {
        /// Raw frame of the last put
        raw: PathBuf,

        /// Column and row of the first pixel of the last put
        #[arg(long, value_name = "COLUMN,ROW", value_parser = place)]
        put_at: Option<(usize, usize)>,

        /// Column and row of the first pixel to compare, the column even
        #[arg(long, value_name = "COLUMN,ROW", value_parser = place, default_value = "0,0")]
        at: (usize, usize),

        /// Network in use, by name or file [default: detected among the built-in ones]
        #[arg(long, value_name = "NAME|FILE")]
        weights: Option<String>,
    },
    /// Use the source's frames again
    Off,
}

/// A pair of numbers, as in `12,34`.
fn place(text: &str) -> Result<(usize, usize), String> {
    let numbers =
        text.split_once(',').and_then(|(column, row)| Some((column.parse().ok()?, row.parse().ok()?)));
    let found: Option<(usize, usize)> = numbers;
    found
        .filter(|(column, row)| column % 2 == 0 && *column < 8192 && *row < 8192)
        .ok_or_else(|| "must be COLUMN,ROW, as in 640,360, below 8192, the column even".into())
}

impl Args {
    /// Adds what is read and written.
    ///
    /// # Errors
    /// A picture of a format that does not exist.
    pub fn files(&self, files: Files) -> Result<Files, Error> {
        match &self.what {
            What::Put { raw, .. } | What::Compare { raw, .. } => Ok(files.reads(raw)),
            What::Get { out, .. } => files.writes_picture("OUT", out),
            What::Off => Ok(files),
        }
    }
}

/// # Errors
/// A frame that does not fit, a picture that differs, a line that fails, or Ctrl-C.
pub fn run(args: &super::Args, picture: &Args, ui: &Ui) -> Result<(), Error> {
    let mut board = args.open()?;
    let bar = ui.progress(0, "words");
    let mut step = |done: usize, total: usize| {
        bar.of(done as u64, total as u64);
        interrupt::flow()
    };
    match &picture.what {
        What::Put { raw, at } => {
            let design = args.design_of(&board)?;
            // If the program does not have the network, the words are put as they are.
            let network = network_in_use(&mut board, &design, None);
            let values = network.map_or(Tone::Linear, |network| network.origin.values);
            let (tile, (column, row)) = tile(raw, *at, values)?;
            board.put_tile(&tile, &mut step).map_err(of)?;
            ui.say(format!("64x64 pixels from column {column}, row {row} fill the board's frames"))?;
            ui.json(&json!({ "put": raw, "column": column, "row": row }))
        }
        What::Get { out, at: (column, row) } => {
            let codes = board.get_codes((*row, *column), &mut step).map_err(of)?;
            photo::save(out, &of_codes(&codes).shown_frame(), 8)?;
            ui.say(format!("64x64 pixels from column {column}, row {row} in {}", out.display()))?;
            ui.json(&json!({ "out": out, "column": column, "row": row }))
        }
        What::Compare { raw, put_at, at, weights } => {
            let design = args.design_of(&board)?;
            let golden = Golden::new(network_in_use(&mut board, &design, weights.as_deref())?)?;
            let display = display_in_use(&mut board)?;
            let values = golden.network().origin.values;
            let frame = tiled(&tile(raw, *put_at, values)?.0, design.frame)?;
            let expected = golden.frame(&frame)?.picture(&display).0;
            compare(&mut board, &expected, (design.frame, *at), &mut step, ui)
        }
        What::Off => board.set_pattern(None).map_err(of),
    }
}

/// The part of a raw frame that is put, in a network's values, and where it begins: column, row.
fn tile(
    file: &Path,
    at: Option<(usize, usize)>,
    values: Tone,
) -> Result<(Array2<u16>, (usize, usize)), Error> {
    let frame = raw::load(file, &raw::RawOptions::default())?.encoded(values).into_owned();
    let (height, width) = frame.size();
    let middle = |length: usize| (length.saturating_sub(TILE_SIDE) / 2) & !1;
    let (column, row) = at.unwrap_or((middle(width), middle(height)));
    if row + TILE_SIDE > height || column + TILE_SIDE > width || row % 2 == 1 {
        return Err(Error::message(format!(
            "{}: {width}x{height} pixels have no 64x64 from column {column}, row {row}, which must be even",
            file.display()
        )));
    }
    let part = s![row..row + TILE_SIDE, column..column + TILE_SIDE];
    Ok((frame.pixels().slice(part).to_owned(), (column, row)))
}

/// A picture of codes, a word per pixel.
fn of_codes(words: &Array2<u16>) -> Picture {
    let (rows, columns) = words.dim();
    let chroma = |odd: usize| {
        Array2::from_shape_fn((rows, columns / 2), |(r, c)| (words[(r, 2 * c + odd)] >> 8) as u8)
    };
    Picture { luma: words.mapv(|word| word as u8), chroma: [chroma(0), chroma(1)] }
}

fn compare(
    board: &mut Board<Serial>,
    expected: &Picture,
    (frame, (column, row)): (FrameSize, (usize, usize)),
    step: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ui: &Ui,
) -> Result<(), Error> {
    let bytes = expected.yuyv();
    let word = |r: usize, c: usize| {
        let at = 2 * (r * frame.width + c);
        u16::from_le_bytes([bytes[at], bytes[at + 1]])
    };
    let found = board.get_codes((row, column), step).map_err(of)?;
    let is_inside = |(r, c): (usize, usize)| row + r < frame.height && column + c < frame.width;
    let inside = || found.indexed_iter().filter(|(at, _)| is_inside(*at));
    let mut wrong = inside().filter(|((r, c), code)| **code != word(row + r, column + c));
    let first = wrong.next();
    let (count, wrong) = (inside().count(), usize::from(first.is_some()) + wrong.count());
    ui.json(&json!({ "pixels": count, "differing": wrong, "column": column, "row": row }))?;
    let Some(((r, c), code)) = first else {
        return ui.say(format!(
            "{count} pixels from column {column}, row {row}: every code as the golden model's"
        ));
    };
    Err(Error::message(format!(
        "{}: {wrong} of {count} pixels differ, the first at column {}, row {}: {code:04x}, expected {:04x}",
        board.port(),
        column + c,
        row + r,
        word(row + r, column + c)
    )))
}
