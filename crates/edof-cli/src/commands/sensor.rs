//! `edof sensor`: from dark and flat frames to a correction of the sensor.

use crate::commands::reconstruct::of_other_phase;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::kind::Kind;
use crate::limits::all_within;
use crate::raw_words::{self, PixelWord, Pixels};
use crate::ui::Ui;
use clap::Args as Options;
use edof::job::{FrameNote, JobError, SensorJob};
use edof_core::words::{count, number};
use edof_io::levels::Black;
use edof_io::packing::ByteOrder;
use edof_io::raw::{Alignment, RawOptions, Size};
use edof_io::record::{self, Stated};
use edof_io::sensor::measure::{DarkReport, Doubt, FlatReport, Limits, Report};
use edof_io::sensor::{Correction, file};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Measure a sensor: offsets, defective pixels and shading, for --sensor of other commands
///
/// Dark frames (cap on the lens) give the black level, offsets of columns, rows and, from many frames, pixels, and hot pixels. Flat frames (even
/// light) give dead pixels and the shading of each colour. A list names defects that are known. One file is made of them, which edof
/// reconstruct --sensor and edof stream --sensor apply in integers before the network (docs/sensor.md).
///
/// Frames are of any format that edof reconstruct reads. A headerless file may hold many frames, one after the other, as edof stream reads them.
#[derive(Options)]
#[command(after_help = "Examples:
  edof sensor --dark dark/*.png --flat flat/*.png --out sensor.safetensors
  edof sensor --dark dark.raw --flat flat.raw --size 1920x1080 --packing 12p --out s.safetensors
  edof sensor --list vendor.txt --size 1920x1080 --bit-depth 12 --out sensor.safetensors
  edof reconstruct raw.png --sensor sensor.safetensors --out sharp.png")]
pub struct Args {
    /// Frames without light, at the exposure time and gain of the pictures
    #[arg(long, value_name = "FILES", num_args = 1..)]
    dark: Vec<PathBuf>,

    /// Frames of even light, neither dark nor full
    #[arg(long, value_name = "FILES", num_args = 1..)]
    flat: Vec<PathBuf>,

    /// Known defects: a text file of lines ROW,COLUMN counted from 0; *,COLUMN is a column, ROW,* a row
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,

    /// Distance of a dark pixel from the median around it that makes it defective, in standard deviations of the noise, 3 to 100
    #[arg(long, value_name = "SIGMAS", default_value_t = Limits::default().hot)]
    hot: f64,

    /// Distance of a pixel's response to light from that of those around it that makes it defective, 0.01 to 0.9
    #[arg(long, value_name = "PART", default_value_t = Limits::default().dead)]
    dead: f64,

    /// Size of headerless files in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,

    /// Packing of a headerless file's pixels, as in edof stream: words (16 bits each), bytes (8), mipi10, mipi12, 10p, 12p, 12packed or 2vuy; or a
    /// camera's name for its pixels, as in BayerRG12p, RG10 or pRCC, which states the phase, too [default: words]
    #[arg(long, requires = "size", value_parser = raw_words::packing)]
    packing: Option<PixelWord>,

    /// Bytes from one line of a headerless file to the next, where lines are padded [default: those of its pixels]
    #[arg(long, requires = "size", value_name = "BYTES")]
    line_bytes: Option<usize>,

    /// Colour filter of the first 2x2 pixels: rggb, grbg, gbrg or bggr, or a camera's name as in BayerGR [default: that of the record or a DNG, else
    /// rggb]
    #[arg(long, value_parser = raw_words::phase, value_name = "CFA")]
    phase: Option<PixelWord>,

    /// Bits per sensor value, 8 to 16 [default: that of the record or the file, else 16]
    #[arg(long = "bit-depth", value_name = "BITS")]
    depth: Option<u32>,

    /// Position of values of fewer than 16 bits in a word [default: bottom in headerless files, else top]
    #[arg(long, value_parser = raw_words::alignment())]
    align: Option<Alignment>,

    /// Byte order of a headerless file
    #[arg(long, value_parser = raw_words::byte_order(), default_value = "little")]
    order: ByteOrder,

    /// Sensor value of darkness where there are no dark frames; or four, with commas, for the 2x2 pixels from the first on
    #[arg(long, value_name = "LEVEL", default_value = "0", conflicts_with = "dark")]
    black_level: Black,

    /// Sensor value of full light [default: the largest value of the sensor's bits]
    #[arg(long, value_name = "LEVEL")]
    white_level: Option<f64>,

    /// Correction to write (safetensors)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// # Errors
/// Frames, a list or levels that cannot be used, or a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    args.check(ui)?;
    let job = args.job()?;
    raw_words::check_order(args.order, job.options.packing)?;
    let bar = ui.progress((args.dark.len() + args.flat.len()) as u64, "files");
    let done = std::cell::Cell::new(0);
    let tick = || {
        done.set(done.get() + 1);
        bar.set(done.get());
        interrupt::check()
    };
    let remark = |note: FrameNote| remark(&note).into_iter().for_each(|line| ui.note(line));
    let frames = job.read(&remark, &tick)?;
    drop(bar);
    let (correction, report) = job.measured(&frames).map_err(named)?;
    frames.inputs.into_iter().for_each(|input| ui.used(input));
    file::save(&args.out, &correction, Some(ui.provenance().for_file()))?;
    for line in in_words(&report) {
        ui.say(line)?;
    }
    report.doubts.iter().for_each(|doubt| ui.note(doubted(*doubt)));
    if args.dark.is_empty() && args.black_level == Black::default() {
        ui.note("black is 0: no dark frames, and no --black-level");
    }
    ui.say(format!("{}: written", args.out.display()))?;
    ui.json(&Written { sensor: args.out.display().to_string(), report: &report })
}

#[derive(Serialize)]
struct Written<'a> {
    sensor: String,
    #[serde(flatten)]
    report: &'a Report,
}

/// Reads the correction that `--sensor` names; notes it as an input, and pixels that stay as they are.
///
/// # Errors
/// A file that cannot be used.
pub fn opened(path: Option<&Path>, ui: &Ui) -> Result<Option<Arc<Correction>>, Error> {
    let Some(path) = path else { return Ok(None) };
    let (correction, input) = file::load(path)?;
    ui.used(input);
    let lost = correction.defects().lost().len();
    if lost > 0 {
        ui.note(format!("{}: {}", path.display(), in_words_of_lost(lost)));
    }
    Ok(Some(Arc::new(correction)))
}

fn in_words_of_lost(lost: usize) -> String {
    format!(
        "{} have no good pixel of their colour within 4 rows and columns, and stay as they are",
        count(lost, "defect")
    )
}

/// A failure by the options that it is about.
fn named(error: JobError) -> Error {
    match error {
        JobError::NoSize => Error::message(
            "--dark, --flat, --list: no frames and no size; name frames, or state --size, as in --size 1920x1080",
        ),
        error => error.into(),
    }
}

/// A remark on a file; the others are about networks.
fn remark(note: &FrameNote) -> Option<String> {
    match note {
        FrameNote::ForeignRecord { path } => {
            Some(format!("{}: is not a raw-frame record of edof; passed over", path.display()))
        }
        FrameNote::RawFile { path, text } => Some(format!("{}: {text}", path.display())),
        _ => None,
    }
}

fn in_words(report: &Report) -> Vec<String> {
    let mut lines = vec![];
    lines.extend(report.dark.as_ref().map(dark));
    lines.extend(report.flat.as_ref().map(flat));
    lines.push(format!(
        "defects: {}, {}, {}",
        count(report.defective_pixels, "pixel"),
        listed("column", &report.defective_columns),
        listed("row", &report.defective_rows)
    ));
    if let Some((row, column)) = report.lost.first() {
        let lost = in_words_of_lost(report.lost.len());
        lines.push(format!("{lost}; the first is at row {row}, column {column}"));
    }
    if report.clipped_gains > 0 {
        lines.push(format!(
            "shading: {} of the grid need a gain of 4 or more, and get 4",
            count(report.clipped_gains, "node")
        ));
    }
    lines
}

/// What is doubtful of the frames, and what to look at.
fn doubted(doubt: Doubt) -> String {
    let percent = |part: f64| number((1000.0 * part).round() / 10.0);
    let light = "did light fall on the sensor, or is --packing another?";
    match doubt {
        Doubt::Black(part) => format!("dark frames: black is {} % of full scale; {light}", percent(part)),
        Doubt::Colours(part) => {
            format!(
                "dark frames: black differs by {} % of full scale between the colours; {light}",
                percent(part)
            )
        }
        Doubt::Pattern(part) => {
            format!("dark frames: pixels differ by {} % of full scale; {light}", percent(part))
        }
        Doubt::Noise(part) => format!("dark frames: noise is {} % of full scale; {light}", percent(part)),
        Doubt::Line(part) => format!(
            "dark frames: a column or row is {} % of full scale below black; did light fall on the others?",
            percent(part)
        ),
        Doubt::Slope(part) => format!(
            "dark frames: black changes by {} % of full scale over the frame; did light fall on the sensor, or does it glow?",
            percent(part)
        ),
        Doubt::Phase(phase) => format!("flat frames: {}", of_other_phase(phase)),
        Doubt::Shading(gain) => {
            format!(
                "flat frames: the largest gain is {gain:.1}; was the light even, and the lens the one of the pictures?"
            )
        }
    }
}

fn dark(dark: &DarkReport) -> String {
    let black: Vec<String> = dark.black.iter().map(|level| format!("{level:.2}")).collect();
    let [columns, rows] = [dark.columns, dark.rows].map(|[low, high]| format!("{low:.2} to {high:.2}"));
    format!(
        "dark: {}, black {}, noise {:.2}, pattern {:.2}; offsets of columns {columns}, of rows {rows}, of pixels: {}; \
         {} hot and {} cold by more than {:.2}",
        count(dark.frames as usize, "frame"),
        black.join(", "),
        dark.noise,
        dark.pattern,
        if dark.per_pixel { "kept" } else { "none, too few frames to tell them from noise" },
        dark.hot,
        dark.cold,
        dark.threshold
    )
}

fn flat(flat: &FlatReport) -> String {
    let percent = |parts: [f64; 3]| parts.map(|part| format!("{:.0}", 100.0 * part)).join(", ");
    let shading = flat.shading.map(|gain| format!("{gain:.3}")).join(", ");
    format!(
        "flat: {}, light of red, green, blue {} % of full scale, largest gain {shading}; {} of other response by more than {} %",
        count(flat.frames as usize, "frame"),
        percent(flat.light),
        count(flat.dead, "pixel"),
        number((1000.0 * flat.threshold).round() / 10.0)
    )
}

fn listed(line: &str, lines: &[u32]) -> String {
    let names: Vec<String> = lines.iter().take(8).map(u32::to_string).collect();
    let more = if lines.len() > 8 { ", ..." } else { "" };
    let names = if lines.is_empty() { String::new() } else { format!(" ({}{more})", names.join(", ")) };
    count(lines.len(), line) + &names
}

impl Args {
    fn check(&self, ui: &Ui) -> Result<(), Error> {
        all_within("--hot", &[self.hot], 3.0, 100.0)?;
        all_within("--dead", &[self.dead], 0.01, 0.9)?;
        if self.dark.is_empty() && self.flat.is_empty() && self.list.is_none() {
            return Err(Error::message(
                "nothing to measure; name frames by --dark or --flat, or defects by --list",
            ));
        }
        let frames = || self.dark.iter().chain(&self.flat);
        Files::new(ui)
            .reads_all(frames())
            .reads_all(frames().map(|raw| record::path_of(raw)))
            .reads_all(&self.list)
            .writes_as(Kind::Sensor, "--out", &self.out)
            .check()
    }

    fn job(&self) -> Result<SensorJob, Error> {
        let Self { align: alignment, order, size, line_bytes, .. } = *self;
        raw_words::check_header(self.phase.as_ref(), size.is_some())?;
        let Pixels { packing, phase, depth } =
            raw_words::pixels(self.packing.as_ref(), self.phase.as_ref(), self.depth)?;
        Ok(SensorJob {
            dark: self.dark.clone(),
            flat: self.flat.clone(),
            list: self.list.clone(),
            stated: Stated { phase, depth, alignment, size, ..Stated::default() },
            options: RawOptions {
                phase: phase.unwrap_or_default(),
                depth,
                size,
                alignment,
                order,
                packing: packing.unwrap_or_default(),
                line_bytes,
            },
            limits: Limits {
                hot: self.hot,
                dead: self.dead,
                black: self.black_level,
                white: self.white_level,
            },
        })
    }
}
