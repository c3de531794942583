//! `edof board picture`.

use super::check::{in_use, network_in_use};
use super::of;
use crate::cosim_system::size;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::ui::Ui;
use edof_board::check::Difference;
use edof_board::host_frame::line_time_of;
use edof_board::{Board, Line, Serial};
use edof_core::{CfaPhase, RawFrame, Tone};
use edof_device::design::FrameSize;
use edof_device::pattern::TILE_SIDE;
use edof_golden::video::pattern::tiled;
use edof_golden::{Golden, Picture};
use edof_io::{photo, raw};
use ndarray::{Array2, s};
use serde_json::json;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Send a raw frame or a part of it to the board over the line, and read the board's picture of it, without a source or a screen
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board picture put raw.png
  edof board picture get out.png
  edof board picture compare raw.png
  edof board picture put raw.png --size 1920x1080      the whole frame: about 50 s
  edof board picture compare raw.png --size 1920x1080")]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Write pixels of a raw frame to the board, which then uses them in place of its source's frames
    ///
    /// With --size, a put that was interrupted resumes if the same one is started again.
    Put {
        /// Raw frame: red first, 64 x 64 pixels or more
        raw: PathBuf,

        /// Pixels to write to the top left of a black frame, both sides even, up to the board's frame [default: 64x64, repeated over the frame]
        #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
        size: Option<(usize, usize)>,

        /// Column and row of the first pixel, both even [default: the middle]
        #[arg(long, value_name = "COLUMN,ROW", value_parser = place)]
        at: Option<(usize, usize)>,
    },
    /// Read pixels of the board's picture
    Get {
        /// Picture file: .png, .tif, .ppm
        out: PathBuf,

        /// Pixels to read, the width even: 0.2 s per 64 x 64 [default: 64x64, or what the frame has of them]
        #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
        size: Option<(usize, usize)>,

        /// Column and row of the first pixel, the column even
        #[arg(long, value_name = "COLUMN,ROW", value_parser = place, default_value = "0,0")]
        at: (usize, usize),
    },
    /// Compare 64 x 64 pixels of the board's picture with the golden model's, code by code; with --size the whole picture by its CRCs
    Compare {
        /// Raw frame of the last put
        raw: PathBuf,

        /// Pixels of the last put
        #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size, conflicts_with = "at")]
        size: Option<(usize, usize)>,

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
        What::Put { raw, at, size } => {
            let design = args.design_of(&board)?;
            // If the program does not have the network, the words are put as they are.
            let network = network_in_use(&mut board, &design, None, ui);
            let values = network.map_or(Tone::Linear, |network| network.origin.values);
            let put = Part { file: raw, at: *at, size: *size, values, frame: design.frame };
            match size {
                None => put_tile(&mut board, &put, &mut step, ui),
                Some(_) => put_frame(&mut board, &put, &mut step, ui),
            }
        }
        What::Get { out, at: (column, row), size } => {
            let (whole_width, whole_height) = (board.identity.width as usize, board.identity.height as usize);
            let rest = |whole: usize, from: usize| whole.saturating_sub(from).clamp(1, TILE_SIDE);
            let (width, height) =
                size.unwrap_or((rest(whole_width, *column).max(2), rest(whole_height, *row)));
            if width % 2 == 1 || width == 0 || height == 0 {
                return Err(Error::message(format!(
                    "--size {width}x{height}: must be an even width and a height, 2x1 at least"
                )));
            }
            if column + width > whole_width || row + height > whole_height {
                return Err(Error::message(format!(
                    "--size {width}x{height}: reaches out of the board's frame of {whole_width}x{whole_height}; state a smaller --size, or another --at"
                )));
            }
            board.check_picture().map_err(of)?;
            let codes = board.get_codes((*row, *column), (height, width), &mut step).map_err(of)?;
            photo::save(out, &of_codes(&codes).shown_frame(), 8)?;
            ui.say(format!("{width}x{height} pixels from column {column}, row {row} in {}", out.display()))?;
            ui.json(&json!({ "out": out, "column": column, "row": row }))
        }
        What::Compare { raw, size, put_at, at, weights } => {
            board.check_picture().map_err(of)?;
            let design = args.design_of(&board)?;
            let (network, display) = in_use(&mut board, &design, weights.as_deref(), ui)?;
            let golden = Golden::new(network)?;
            let values = golden.network().origin.values;
            let put = Part { file: raw, at: *put_at, size: *size, values, frame: design.frame };
            let Some((width, height)) = size else {
                let frame = tiled(&put.pixels()?.0, design.frame)?;
                let expected = golden.frame(&frame)?.picture(&display).0;
                return compare(&mut board, &expected, (design.frame, *at), &mut step, ui);
            };
            let frame = RawFrame::from_values(put.whole()?.0, 16, CfaPhase::Rggb)?;
            let expected = golden.checks(&display, &frame)?;
            let mut frames = |done: u32, total: u32| step(done as usize, total as usize);
            let checked = board.check_frames(&expected, FRAMES, &mut frames).map_err(of)?;
            ui.json(&json!({ "size": [width, height], "checked": checked }))?;
            match checked.difference {
                None => ui.say(format!("{width}x{height} pixels: every boundary as the golden model's")),
                Some(Difference { boundary, expected, found }) => Err(Error::message(format!(
                    "{}: {boundary} differ first: CRC {found:08x}, expected {expected:08x}",
                    board.port()
                ))),
            }
        }
        What::Off => {
            board.set_pattern(None).map_err(of)?;
            ui.say("the source's frames are used again")
        }
    }
}

/// Frames that are compared after a whole frame was put.
const FRAMES: u32 = 3;

/// The part of a raw frame that is put.
struct Part<'a> {
    file: &'a Path,
    /// Column and row of its first pixel; none is the middle.
    at: Option<(usize, usize)>,
    /// Columns and rows; none is a tile.
    size: Option<(usize, usize)>,
    /// A network's values.
    values: Tone,
    /// The board's frame.
    frame: FrameSize,
}

impl Part<'_> {
    /// The pixels, and where they begin: column, row.
    fn pixels(&self) -> Result<(Array2<u16>, (usize, usize)), Error> {
        let frame = raw::load(self.file, &raw::RawOptions::default())?.encoded(self.values).into_owned();
        let (height, width) = frame.size();
        let (columns, rows) = self.size.unwrap_or((TILE_SIDE, TILE_SIDE));
        let middle = |length: usize, part: usize| (length.saturating_sub(part) / 2) & !1;
        let (column, row) = self.at.unwrap_or((middle(width, columns), middle(height, rows)));
        if row + rows > height || column + columns > width || row % 2 == 1 {
            return Err(Error::message(format!(
                "{}: {width}x{height} pixels have no {columns}x{rows} from column {column}, row {row}, which must be even",
                self.file.display()
            )));
        }
        let part = s![row..row + rows, column..column + columns];
        Ok((frame.pixels().slice(part).to_owned(), (column, row)))
    }

    /// A whole black frame with the pixels at its top left, and where they begin in the file.
    fn whole(&self) -> Result<(Array2<u16>, (usize, usize)), Error> {
        let FrameSize { width, height, .. } = self.frame;
        let (columns, rows) = self.size.unwrap_or((TILE_SIDE, TILE_SIDE));
        let is_right = |side: usize, max: usize| (2..=max).contains(&side) && side.is_multiple_of(2);
        if !(is_right(columns, width) && is_right(rows, height)) {
            return Err(Error::message(format!(
                "--size {columns}x{rows}: must be two even numbers, at most {width}x{height}, the board's frame"
            )));
        }
        let (pixels, from) = self.pixels()?;
        let mut whole = Array2::zeros((height, width));
        whole.slice_mut(s![..rows, ..columns]).assign(&pixels);
        Ok((whole, from))
    }
}

/// Steps done, of how many; whether to go on.
type Step<'a> = &'a mut dyn FnMut(usize, usize) -> ControlFlow<()>;

fn put_tile(board: &mut Board<Serial>, part: &Part<'_>, step: Step<'_>, ui: &Ui) -> Result<(), Error> {
    let (tile, (column, row)) = part.pixels()?;
    board.put_tile(&tile, step).map_err(of)?;
    ui.say(format!("64x64 pixels from column {column}, row {row} fill the board's frames"))?;
    ui.json(&json!({ "put": part.file, "column": column, "row": row }))
}

fn put_frame(board: &mut Board<Serial>, part: &Part<'_>, step: Step<'_>, ui: &Ui) -> Result<(), Error> {
    let (pixels, (column, row)) = part.whole()?;
    let (time, turns) = line_time_of(&pixels, board.line().baud());
    let time = time.as_secs_f64();
    ui.note(format!("{time:.1} s on the line, and {turns} times until its bridge has turned round"));
    let begun = Instant::now();
    let put = board.put_frame(&pixels, &mut |done, of| step(done as usize, of as usize));
    if matches!(put, Err(edof_board::Error::Interrupted)) {
        ui.note("the same command resumes; until then the board repeats its last frame, or uses its source's after 'edof board picture off'");
    }
    let put = put.map_err(of)?;
    let seconds = begun.elapsed().as_secs_f64();
    let (columns, rows) = part.size.unwrap_or_default();
    let resumed = match put.resumed {
        0 => String::new(),
        blocks => format!("; {blocks} of {} blocks were there", put.blocks),
    };
    ui.say(format!(
        "{columns}x{rows} pixels from column {column}, row {row} are the board's frame, after {seconds:.1} s{resumed}"
    ))?;
    ui.json(&json!({ "put": part.file, "column": column, "row": row, "size": [columns, rows], "sent": put, "seconds": seconds }))
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
    let found = board.get_codes((row, column), (TILE_SIDE, TILE_SIDE), step).map_err(of)?;
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
