//! `edof board calibrate`.

use super::of;
use crate::cosim_system::size;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::ui::Ui;
use edof::job::GreyFile;
use edof_core::ColourFrame;
use edof_golden::video::greys::{SIDE, chart};
use edof_io::photo;
use ndarray::Axis;
use serde_json::json;
use std::path::PathBuf;

/// Find which grey of a PC's graphics card becomes which code at the board, for raw frames in grey
///
/// A graphics card changes colours and scales the range of grey. Show the chart of 'calibrate picture' on it, full screen, pixel by pixel, then run
/// 'calibrate read': it reads what arrives at the board, finds a grey for each of the 128 codes, and sets video_setup.grey.
/// 'edof capture --grey FILE' then draws raw frames in these greys (docs/bring-up.md).
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board calibrate picture chart.png
  edof board calibrate read card.json
  edof capture photo.png --out raw.png --video frame.rgb --grey card.json")]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Write the chart: all greys from 0 to 255 in squares of 4 x 4 pixels, repeated over the picture; needs no board
    Picture {
        /// Picture file: .png, .tif, .ppm
        out: PathBuf,

        /// Size of the video mode
        #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size, default_value = "1920x1080")]
        size: (usize, usize),
    },
    /// Read the chart as it arrives at the board; write the greys, and set the board to raw frames in grey
    Read {
        /// File of the greys, JSON
        out: PathBuf,
    },
}

impl Args {
    /// Adds what is written.
    ///
    /// # Errors
    /// A picture of a format that does not exist.
    pub fn files(&self, files: Files) -> Result<Files, Error> {
        match &self.what {
            What::Picture { out, .. } => files.writes_picture("OUT", out),
            What::Read { out } => Ok(files.writes("OUT", out)),
        }
    }
}

/// # Errors
/// A chart that does not arrive or carries too few codes, a file that cannot be written, a line that fails, or Ctrl-C.
pub fn run(args: &super::Args, calibrate: &Args, ui: &Ui) -> Result<(), Error> {
    match &calibrate.what {
        What::Picture { out, size: (width, height) } => {
            if *width.min(height) < SIDE {
                return Err(Error::message(format!(
                    "--size {width}x{height}: must be at least {SIDE}x{SIDE}, so that the picture has every grey"
                )));
            }
            let grey = chart(*height, *width).mapv(|grey| f32::from(grey) / 255.0);
            let planes = ndarray::stack![Axis(0), grey, grey, grey];
            photo::save(out, &ColourFrame { planes }, 8)?;
            ui.say(format!("{}: {width}x{height}, all greys; show it pixel by pixel", out.display()))?;
            ui.json(&json!({ "out": out, "width": width, "height": height }))
        }
        What::Read { out } => {
            let mut board = args.open()?;
            let bar = ui.progress(0, "words");
            let (path, greys) = board
                .calibrate(&mut |done, total| {
                    bar.of(done as u64, total as u64);
                    interrupt::flow()
                })
                .map_err(of)?;
            GreyFile::new(&path, &greys, ui.provenance().for_file()).save(out)?;
            let [dark, bright] = [0, 127].map(|code| greys.all()[code]);
            let [black, white] = [0, 255].map(|grey| path.luma()[grey]);
            ui.say(format!(
                "greys 0 to 255 arrive as luma {black} to {white}; greys {dark} to {bright} carry all 128 codes; the board now takes raw frames in grey"
            ))?;
            ui.json(&json!({ "out": out, "greys": greys.all(), "luma": path.luma() }))
        }
    }
}
