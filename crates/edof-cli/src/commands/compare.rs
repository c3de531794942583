//! `edof compare`.

use crate::error::Error;
use crate::files::Files;
use crate::pictures;
use crate::said;
use crate::ui::Ui;
use edof_core::storage::provenance::Input;
use edof_core::words::number;
use edof_core::{ColourFrame, Tone};
use edof_io::photo::{self, Photograph};
use edof_io::transfer::Curve;
use edof_study::metrics::mtf50::EdgeResponse;
use edof_study::metrics::quality::columns;
use edof_study::metrics::{BORDER, Better, MetricError, Quality, Score, luma};
use ndarray::{Axis, s};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Compare two pictures: PSNR, SSIM and further metrics, place of the largest difference, sharpness of an edge in each
///
/// The values of the files are compared, full scale 1. --region limits the comparison to a part. If the part contains one slanted edge
/// (1 to 30 degrees off the pixels' rows or columns), its MTF50 is printed for both: the frequency at which contrast falls to a half.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof compare sharp.png reconstructed.png
  edof compare sharp.png reconstructed.png --map errors.png --json
  edof compare sharp.png reconstructed.png --region 200,120,64x64")]
pub struct Args {
    /// Reference picture (ground truth)
    a: PathBuf,

    /// Picture to compare with the reference
    b: PathBuf,

    /// Part to compare: left column, top row, and size
    #[arg(long, value_name = "X,Y,WxH")]
    region: Option<Region>,

    /// Pixels to leave out on each side [default: 8, with --region 0]
    #[arg(long, value_name = "PIXELS")]
    border: Option<usize>,

    /// Encoding of the pictures, which metrics of light and the measurement of an edge need: srgb, or linear (linear light)
    #[arg(long, default_value_t = Tone::Srgb, value_name = "TONE")]
    tone: Tone,

    /// Also write a map of the differences; grey is no difference
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,

    /// Factor by which the map enlarges differences
    #[arg(long, default_value_t = 8.0, value_name = "FACTOR", value_parser = said::single)]
    map_gain: f32,
}

/// A part of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
struct Region {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl std::str::FromStr for Region {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<usize>> = text.split([',', 'x']).map(|word| word.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[left, top, width, height])
                if width > 0 && height > 0 && text.matches('x').count() == 1 =>
            {
                Ok(Self { left, top, width, height })
            }
            _ => Err("expected X,Y,WxH in pixels, as in 200,120,64x64".to_owned()),
        }
    }
}

#[derive(Serialize)]
struct Compared {
    a: String,
    b: String,
    width: usize,
    height: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<Region>,
    border: usize,
    identical: bool,
    #[serde(flatten)]
    quality: Quality,
    /// Mean of b − a in red, green and blue.
    mean_difference: [f64; 3],
    /// The largest |b − a| of any colour inside of the border, and where it is.
    largest: Largest,
    /// Of the edge in the region, cycles per pixel in a and b.
    #[serde(skip_serializing_if = "Option::is_none")]
    mtf50: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct Largest {
    difference: f32,
    row: usize,
    column: usize,
}

/// # Errors
/// Files that are no pictures or of different sizes, a region outside of them, a map that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let mut files = Files::new(ui).reads(&args.a).reads(&args.b);
    if let Some(map) = &args.map {
        files = files.writes_picture("--map", map)?;
    }
    files.check()?;
    if !(args.map_gain.is_finite() && args.map_gain > 0.0) {
        return Err(Error::message(format!(
            "--map-gain {}: must be a positive number",
            number(args.map_gain.into())
        )));
    }
    let [a, b] = [part(&args.a, &args, ui)?, part(&args.b, &args, ui)?];
    let (a, b) = whole_cells(a, b, &args, ui);
    let border = args.border.unwrap_or(if args.region.is_some() { 0 } else { BORDER });
    let of_files = |e| {
        let hint = match (&e, args.region) {
            (MetricError::Small { .. }, None) if border > 0 => "; or a smaller --border",
            (MetricError::Small { .. }, Some(_)) => "; give a larger --region",
            _ => "",
        };
        Error::message(format!("{}, {}: {e}{hint}", args.a.display(), args.b.display()))
    };
    let quality = Quality::of(&a, &b, border, args.tone).map_err(of_files)?;
    let compared = Compared {
        a: args.a.display().to_string(),
        b: args.b.display().to_string(),
        width: a.size().1,
        height: a.size().0,
        region: args.region,
        border,
        identical: a == b,
        quality,
        mean_difference: mean_difference(&a, &b),
        largest: largest(&a, &b, border, args.region),
        mtf50: mtf50(&a, &b, &args),
    };
    if let Some(map) = &args.map {
        photo::save(map, &difference_map(&a, &b, args.map_gain), 8)?;
    }
    tell(&compared, &args, ui)?;
    ui.json(&compared)
}

/// The compared part of a picture.
fn part(file: &Path, args: &Args, ui: &Ui) -> Result<ColourFrame, Error> {
    let Photograph { frame: picture, transfer, gamut, is_first_of_several } = photo::open(file)?;
    if is_first_of_several {
        ui.note(format!("{}: has several pictures; the first is compared", file.display()));
    }
    let other = transfer.filter(|stated| stated.curve != Curve::Srgb && stated.tone() != Some(args.tone));
    let gamut = gamut.map(|stated| format!("colours of {stated}"));
    for stated in other.map(|stated| stated.to_string()).into_iter().chain(gamut) {
        ui.note(format!("{}: states {stated}; its values are compared as they are", file.display()));
    }
    let name = file.file_stem().unwrap_or_default().to_string_lossy();
    ui.used(Input::photograph(&name, &picture));
    let Some(Region { left, top, width, height }) = args.region else { return Ok(picture) };
    let (rows, columns) = picture.size();
    let inside =
        |start: usize, length: usize, all: usize| start.checked_add(length).is_some_and(|end| end <= all);
    if !(inside(left, width, columns) && inside(top, height, rows)) {
        return Err(Error::message(format!(
            "--region {left},{top},{width}x{height}: reaches out of {}, {columns}x{rows}",
            file.display()
        )));
    }
    Ok(picture.crop(top, left, height, width))
}

/// A photograph of odd sides beside the picture of its frame, which has whole Bayer cells: without the last row or column, which is said.
fn whole_cells(a: ColourFrame, b: ColourFrame, args: &Args, ui: &Ui) -> (ColourFrame, ColourFrame) {
    let cropped = |larger: ColourFrame, size: (usize, usize), file: &Path| {
        let (height, width) = larger.size();
        ui.note(format!(
            "{}: {width}x{height} cropped to {}x{}, as the other",
            file.display(),
            size.1,
            size.0
        ));
        larger.crop(0, 0, size.0, size.1)
    };
    let (of_a, of_b) = (a.size(), b.size());
    if of_a != of_b && pictures::whole_cells(of_a) == of_b {
        return (cropped(a, of_b, &args.a), b);
    }
    if of_a != of_b && pictures::whole_cells(of_b) == of_a {
        return (a, cropped(b, of_a, &args.b));
    }
    (a, b)
}

fn mean_difference(a: &ColourFrame, b: &ColourFrame) -> [f64; 3] {
    let mean = |plane: usize| {
        let of = |frame: &ColourFrame| frame.planes.index_axis(Axis(0), plane).mapv(f64::from).mean();
        of(b).zip(of(a)).map_or(0.0, |(b, a)| b - a)
    };
    [0, 1, 2].map(mean)
}

fn largest(a: &ColourFrame, b: &ColourFrame, border: usize, region: Option<Region>) -> Largest {
    let (height, width) = a.size();
    let is_inside = |(_, row, column): (usize, usize, usize)| {
        (border..height - border).contains(&row) && (border..width - border).contains(&column)
    };
    let all = a.planes.indexed_iter().zip(&b.planes).filter(|((at, _), _)| is_inside(*at));
    let differences = all.map(|((at, a), b)| (at, (b - a).abs()));
    let max = differences.max_by(|(_, x), (_, y)| x.total_cmp(y));
    let ((_, row, column), difference) = max.unwrap_or_default();
    let (top, left) = region.map_or((0, 0), |region| (region.top, region.left));
    Largest { difference, row: top + row, column: left + column }
}

/// Of the edge in the region, if it holds one in both pictures.
fn mtf50(a: &ColourFrame, b: &ColourFrame, args: &Args) -> Option<[f64; 2]> {
    args.region?;
    let of = |frame: &ColourFrame| {
        let light = luma(&args.tone.decoded(frame));
        EdgeResponse::measure(light.view()).ok().map(|edge| edge.mtf50())
    };
    Some([of(a)?, of(b)?])
}

/// b − a about the middle of the range.
fn difference_map(a: &ColourFrame, b: &ColourFrame, gain: f32) -> ColourFrame {
    ColourFrame { planes: (&b.planes - &a.planes).slice(s![.., .., ..]).mapv(|d| 0.5 + gain * d) }
}

fn tell(compared: &Compared, args: &Args, ui: &Ui) -> Result<(), Error> {
    let Compared { a, b, width, height, border, quality, .. } = compared;
    ui.say(format!("{b} against {a}: {width}x{height}, {border} pixels of border left out"))?;
    if compared.identical {
        ui.say("  identical")?;
    } else {
        scores(quality, ui)?;
        let [red, green, blue] = compared.mean_difference.map(|d| 255.0 * d);
        let Largest { difference, row, column } = compared.largest;
        ui.say(format!(
            "  mean difference {red:+.2} {green:+.2} {blue:+.2} of 255; the largest is {:.1} at row {row}, column {column}",
            255.0 * difference
        ))?;
    }
    match (compared.mtf50, args.region) {
        (Some([of_a, of_b]), _) => ui.say(format!("  MTF50 {of_a:.3} and {of_b:.3} cycles per pixel")),
        (None, Some(_)) => {
            ui.say("  no MTF50: the region does not contain a single slanted edge in both pictures")
        }
        (None, None) => Ok(()),
    }
}

/// One line for PSNR, and one for each metric that tables show.
fn scores(quality: &Quality, ui: &Ui) -> Result<(), Error> {
    let luma = |name: &str| quality.number(&format!("luma_{name}"));
    let [red, green, blue] = match quality.get("channel_psnr_db") {
        Some(Score::Colours(colours)) => colours,
        _ => [f64::NAN; 3],
    };
    ui.say(format!(
        "  PSNR {:.2} dB (red {red:.2}, green {green:.2}, blue {blue:.2}, luma {:.2})",
        quality.psnr_db(),
        luma("psnr_db").unwrap_or(f64::NAN)
    ))?;
    for metric in columns([&Quality::means(&[*quality])].into_iter()) {
        let Some(number) = quality.number(metric.name) else { continue };
        // A picture's own number has a digit more than a mean.
        let digits = |number: f64| metric.with_unit(&format!("{number:.*}", metric.decimals + 1));
        let better = if metric.better == Better::Lower { ", lower is better" } else { "" };
        let luma = luma(metric.name).map_or_else(String::new, |luma| format!(" (luma {})", digits(luma)));
        ui.say(format!("  {} {}{luma}{better}", metric.title, digits(number)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_read() {
        assert_eq!("200,120,64x48".parse(), Ok(Region { left: 200, top: 120, width: 64, height: 48 }));
        for text in ["", "1,2,3", "1,2,0x4", "1x2x3x4", "1,2,3,4", "a,2,3x4", "-1,2,3x4"] {
            assert!(text.parse::<Region>().is_err(), "{text}");
        }
    }
}
