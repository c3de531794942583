//! From dark frames, flat frames and a list to a correction.
//!
//! | what | module |
//! |---|---|
//! | sums of frames | [`Frames`] |
//! | medians, spreads, and what is usual around a pixel | `statistics` |
//! | black, offsets, hot and cold pixels | `dark` |
//! | dead pixels and shading | `flat` |

mod dark;
mod flat;
mod mean;
mod statistics;
#[cfg(test)]
mod tests;

pub use dark::DarkReport;
pub use flat::FlatReport;
pub use mean::Frames;

use super::correction::{Correction, Defects, SensorError, Tables, gain_word};
use crate::levels::Black;
use crate::raw::Size;
use edof_core::{CfaPhase, Channel};
use ndarray::{Array2, Axis};
use serde::Serialize;

/// Share of the pixels of a line from which on all of it is defective.
const WHOLE_LINE: f64 = 0.5;
/// Largest black level as part of full scale; cameras have up to an eighth.
const MAX_BLACK: f64 = 0.2;
/// Largest spread of dark pixels as part of full scale, and of pixels' response to light.
const MAX_SPREAD: f64 = 0.02;
const MAX_RESPONSE: f64 = 0.1;
/// Largest share of single pixels that are defective.
const MAX_DEFECTIVE: f64 = 0.01;
/// Largest share of nodes of the grid whose gain is cut off.
const MAX_CLIPPED: f64 = 0.1;
/// Parts of full scale from which on dark frames look as if light had fallen on them: black, the difference of its four places, the spread of pixels, the
/// noise.
const DOUBTFUL_DARK: [f64; 4] = [0.13, 0.005, 0.005, 0.01];
/// Offset of a column or row below black that tells of light on the others: in noise, and as part of full scale.
const DOUBTFUL_LINE: [f64; 2] = [8.0, 0.005];
/// Part of full scale by which dark frames slope where light fell on them.
const DOUBTFUL_SLOPE: f64 = 0.002;
/// Gain of shading from which on flat frames look uneven.
const DOUBTFUL_GAIN: f64 = 2.5;

/// Limits and levels of a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Distance of a dark pixel from what is usual around it that makes it defective, in standard deviations of the noise.
    pub hot: f64,
    /// Distance of a pixel's response to light from that of those around it that makes it defective.
    pub dead: f64,
    /// Sensor values of no light, where dark frames do not state them.
    pub black: Black,
    /// Sensor value of full light; by default one more than the largest.
    pub white: Option<f64>,
}

impl Default for Limits {
    fn default() -> Self {
        Self { hot: 6.0, dead: 0.15, black: Black::default(), white: None }
    }
}

/// Holds what a sensor is measured from; size, phase and depth are those of its frames.
#[derive(Debug)]
pub struct Sensor<'a> {
    /// Columns and rows.
    pub size: Size,
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Bits of a sensor value.
    pub depth: u32,
    /// Frames without light.
    pub dark: Option<&'a Frames>,
    /// Frames of even light.
    pub flat: Option<&'a Frames>,
    /// Defects that are known.
    pub known: Defects,
}

/// Frames that no correction can be made of.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum MeasureError {
    /// A frame that differs from those before it.
    #[error(
        "a frame of {} of phase {} with {} bits, expected one of {} of phase {} with {} bits, as the frames before it",
        found.0, found.1, found.2, expected.0, expected.1, expected.2
    )]
    OtherFrame { found: (Size, CfaPhase, u32), expected: (Size, CfaPhase, u32) },
    /// Dark frames with light, or read by another packing than theirs.
    #[error(
        "dark frames: {what} {found:.0} of {full:.0}, expected at most {most:.0}; take them with the cap on the lens, and check --packing, --bit-depth and --size"
    )]
    NotDark { what: &'static str, found: f64, most: f64, full: f64 },
    /// Flat frames of a scene, or read by another packing than theirs.
    #[error(
        "flat frames: pixels' response to light differs by {:.0} % from one to the next, expected at most {:.0} %; take them of even light, out of focus, and check --packing, --bit-depth and --size",
        100.0 * found, 100.0 * MAX_RESPONSE
    )]
    NotFlat { found: f64 },
    /// More defects than a sensor has.
    #[error(
        "{found} of {pixels} pixels would be defective, expected at most {:.0} %; take dark frames with the cap on the lens and flat ones of even light, out of focus, check --packing, --bit-depth and --size, or raise --hot and --dead",
        100.0 * MAX_DEFECTIVE
    )]
    TooManyDefects { found: usize, pixels: usize },
    /// Flat frames whose light is not even.
    #[error(
        "flat frames: {clipped} of {nodes} nodes of the grid need a gain of 4 or more, expected at most {:.0} %; take them of even light, out of focus, and check --packing, --bit-depth and --size",
        100.0 * MAX_CLIPPED
    )]
    Uneven { clipped: usize, nodes: usize },
    /// Flat frames that show no shading.
    #[error(
        "flat frames: the light of {} is {:.1} % of full scale, expected {:.0} to {:.0} %; change exposure or light",
        colour(*channel), 100.0 * light, 100.0 * flat::EXPOSURE[0], 100.0 * flat::EXPOSURE[1]
    )]
    Exposure { channel: Channel, light: f64 },
    /// White that is not above black.
    #[error("white level {white}: must be above black, {black:.1}, and at most {max}")]
    White { white: f64, black: f64, max: f64 },
    /// Gains that cannot be had.
    #[error(
        "white level {white}: is less than a quarter of full scale, {max}; state the bits of the sensor's values"
    )]
    Gain { white: f64, max: f64 },
    /// Defects outside of the frame.
    #[error(transparent)]
    Tables(#[from] SensorError),
}

const fn colour(channel: Channel) -> &'static str {
    ["red", "green", "blue"][channel.plane()]
}

/// Holds what was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Size of the frames.
    pub size: Size,
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Bits of a sensor value.
    pub bit_depth: u32,
    /// Report of the dark frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dark: Option<DarkReport>,
    /// Report of the flat frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flat: Option<FlatReport>,
    /// Pixels that are repaired one by one.
    pub defective_pixels: usize,
    /// Columns that are repaired as a whole.
    pub defective_columns: Vec<u32>,
    /// Rows that are repaired as a whole.
    pub defective_rows: Vec<u32>,
    /// Row and column of pixels without a good pixel in reach, which stay as they are.
    pub lost: Vec<(usize, usize)>,
    /// Nodes of the grid whose gain is cut off at 4.
    pub clipped_gains: usize,
    /// What makes it doubtful that the frames show what they should.
    pub doubts: Vec<Doubt>,
}

/// What of dark or flat frames says that light was where none should be, or was not even. Nothing is proved by it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Doubt {
    /// A high black level, as part of full scale.
    Black(f64),
    /// Black differs between the four places of a cell, as the colours of light do.
    Colours(f64),
    /// Pixels differ more than those of a sensor do.
    Pattern(f64),
    /// Noise that light makes.
    Noise(f64),
    /// A column or row is below black, as if light had fallen on the others, by as much of full scale.
    Line(f64),
    /// Black changes over the frame as light does, by as much of full scale.
    Slope(f64),
    /// What the phase takes for green differs as red and blue do.
    Phase(CfaPhase),
    /// Light that falls off more than behind most lenses: the largest gain.
    Shading(f64),
}

/// Returns what is doubtful of frames, by parts of full scale.
fn doubts(dark: Option<&DarkReport>, flat: Option<&FlatReport>, phase: CfaPhase, full: f64) -> Vec<Doubt> {
    let mut found = vec![];
    if let Some(dark) = dark {
        let [least, most] = dark.black.iter().fold([f64::INFINITY, 0.0], |[a, b], v| [v.min(a), v.max(b)]);
        let parts = [most, most - least, dark.pattern, dark.noise].map(|value| value / full);
        let kinds = [Doubt::Black, Doubt::Colours, Doubt::Pattern, Doubt::Noise];
        let all = kinds.into_iter().zip(parts).zip(DOUBTFUL_DARK);
        found.extend(all.filter(|((_, part), limit)| part > limit).map(|((kind, part), _)| kind(part)));
        let [noises, part] = DOUBTFUL_LINE;
        let below = -dark.lowest_line;
        let is_low = below > noises * dark.noise && below > part * full;
        found.extend(is_low.then(|| Doubt::Line(below / full)));
        let slope = dark.slope / full;
        found.extend((slope > DOUBTFUL_SLOPE).then_some(Doubt::Slope(slope)));
    }
    found.extend(flat.filter(|flat| flat.is_of_other_phase).map(|_| Doubt::Phase(phase)));
    let shading = flat.map(|flat| flat.shading.into_iter().fold(1.0, f64::max));
    found.extend(shading.filter(|gain| *gain > DOUBTFUL_GAIN).map(Doubt::Shading));
    found
}

impl Sensor<'_> {
    /// Measures the sensor.
    ///
    /// # Errors
    /// [`MeasureError`].
    pub fn measured(&self, limits: &Limits) -> Result<(Correction, Report), MeasureError> {
        let own = (self.size, self.phase, self.depth);
        for frames in self.dark.iter().chain(&self.flat) {
            frames.check(own)?;
        }
        let full = f64::from(1u32 << self.depth);
        let mut dark = self.dark.map(|frames| dark::measured(frames, limits.hot));
        if let Some(dark) = &dark {
            Self::check_dark(&dark.report, full)?;
        }
        let black = dark.as_ref().map_or(limits.black.values(), |dark| dark.black);
        let white = white(limits.white, black, full)?;
        let mut known = self.known.clone();
        let known_pixels = known.pixels.len();
        if let Some(dark) = &mut dark {
            known.columns.extend(dark::far_off(&mut dark.columns, full));
            known.rows.extend(dark::far_off(&mut dark.rows, full));
        }
        let word = 65536.0 / full;
        let mut tables =
            Tables::plain(self.size, self.phase, self.depth, black.map(|v| v * word), white * word);
        if let Some(dark) = &dark {
            self.add_offsets(&mut tables, dark, word);
        }
        let flat = self.flat.map(|frames| {
            let mut light = frames.mean();
            ndarray::Zip::from(&mut light).and(&tables.offsets()).for_each(|value, offset| {
                *value -= f32::from(*offset) / word as f32;
            });
            flat::measured(&light, frames.count, self.phase, white - black[0], limits.dead)
        });
        let flat = flat.transpose()?;
        if let Some(flat) = &flat {
            Self::check_flat(&flat.report)?;
        }
        let mut clipped_gains = 0;
        if let Some(flat) = &flat {
            tables.gains.indexed_iter_mut().for_each(|((at, i, j), gain)| {
                let wanted = flat.gains[(at, i, j)] * full / (white - black[at]);
                clipped_gains += usize::from(wanted >= 4.0);
                *gain = gain_word(wanted);
            });
        }
        if clipped_gains as f64 > MAX_CLIPPED * tables.gains.len() as f64 {
            return Err(MeasureError::Uneven { clipped: clipped_gains, nodes: tables.gains.len() });
        }
        tables.defects = defects(
            known,
            self.size,
            &[dark.as_ref().map(|dark| &dark.mask), flat.as_ref().map(|flat| &flat.mask)],
        );
        let correction = Correction::new(tables)?;
        let Defects { pixels, columns, rows } = &correction.tables().defects;
        let reports = (dark.as_ref().map(|dark| &dark.report), flat.as_ref().map(|flat| &flat.report));
        let doubts = doubts(reports.0, reports.1, self.phase, full);
        let report = Report {
            size: self.size,
            phase: self.phase,
            bit_depth: self.depth,
            dark: dark.map(|dark| dark.report),
            flat: flat.map(|flat| flat.report),
            defective_pixels: pixels.len(),
            defective_columns: columns.clone(),
            defective_rows: rows.clone(),
            lost: correction.defects().lost(),
            clipped_gains,
            doubts,
        };
        self.check_count(&report, known_pixels)?;
        Ok((correction, report))
    }

    /// Rejects dark frames that no sensor makes without light.
    fn check_dark(dark: &DarkReport, full: f64) -> Result<(), MeasureError> {
        let black = dark.black.into_iter().fold(0.0, f64::max);
        let limits = [("black is", black, MAX_BLACK), ("pixels spread by", dark.pattern, MAX_SPREAD)];
        match limits.into_iter().find(|(_, found, part)| *found > part * full) {
            Some((what, found, part)) => Err(MeasureError::NotDark { what, found, most: part * full, full }),
            None => Ok(()),
        }
    }

    /// Rejects flat frames that do not show even light.
    fn check_flat(flat: &FlatReport) -> Result<(), MeasureError> {
        match flat.response > MAX_RESPONSE {
            true => Err(MeasureError::NotFlat { found: flat.response }),
            false => Ok(()),
        }
    }

    /// Rejects more single defects, besides those that were named, than a sensor has.
    fn check_count(&self, report: &Report, known: usize) -> Result<(), MeasureError> {
        let pixels = self.size.width * self.size.height;
        let found = report.defective_pixels.saturating_sub(known);
        match found as f64 > MAX_DEFECTIVE * pixels as f64 {
            true => Err(MeasureError::TooManyDefects { found, pixels }),
            false => Ok(()),
        }
    }

    /// Adds the offsets of dark frames, in words.
    fn add_offsets(&self, tables: &mut Tables, dark: &dark::Dark, word: f64) {
        let offset = |value: f64| (value * word).round().clamp(-32768.0, 32767.0) as i16;
        tables.columns = dark.columns.iter().map(|v| offset(*v)).collect();
        tables.rows = dark.rows.iter().map(|v| offset(*v)).collect();
        tables.pixels = dark.pixels.as_ref().map(|pixels| {
            let value = |at: (usize, usize)| if dark.mask[at] { 0 } else { offset(f64::from(pixels[at])) };
            Array2::from_shape_fn(pixels.dim(), value)
        });
    }
}

/// Returns the sensor value of full light.
fn white(stated: Option<f64>, black: [f64; 4], full: f64) -> Result<f64, MeasureError> {
    let white = stated.unwrap_or(full);
    let darkest = black.into_iter().fold(0.0, f64::max);
    if !(white > darkest && white <= full) {
        return Err(MeasureError::White { white, black: darkest, max: full });
    }
    if full / (white - darkest) >= 4.0 {
        return Err(MeasureError::Gain { white, max: full });
    }
    Ok(white)
}

/// Returns all defects: lines of which at least half is defective as lines, the others as pixels, each once and in order.
fn defects(known: Defects, Size { width, height }: Size, masks: &[Option<&Array2<bool>>]) -> Defects {
    let Defects { pixels, mut columns, mut rows } = known;
    let mut mask = Array2::from_elem((height, width), false);
    for at in pixels.iter().map(|[r, c]| (*r as usize, *c as usize)) {
        // One outside of the frame is rejected with the tables.
        if let Some(is_bad) = mask.get_mut(at) {
            *is_bad = true;
        }
    }
    for found in masks.iter().flatten() {
        mask.zip_mut_with(found, |is_bad, found| *is_bad |= found);
    }
    let whole = |axis: Axis| {
        let lines = (0..).zip(mask.axis_iter(axis));
        let is_whole = |line: &ndarray::ArrayView1<'_, bool>| {
            line.iter().filter(|is_bad| **is_bad).count() as f64 >= WHOLE_LINE * line.len() as f64
        };
        lines.filter(|(_, line)| is_whole(line)).map(|(index, _)| index).collect::<Vec<u32>>()
    };
    columns.extend(whole(Axis(1)));
    rows.extend(whole(Axis(0)));
    for lines in [&mut columns, &mut rows] {
        lines.sort_unstable();
        lines.dedup();
    }
    let outside = pixels.into_iter().filter(|[r, c]| *r as usize >= height || *c as usize >= width);
    let inside = mask.indexed_iter().filter(|(_, is_bad)| **is_bad).map(|((r, c), _)| [r as u32, c as u32]);
    let is_single = |[r, c]: &[u32; 2]| rows.binary_search(r).is_err() && columns.binary_search(c).is_err();
    let pixels = outside.chain(inside.filter(is_single)).collect();
    Defects { pixels, columns, rows }
}
