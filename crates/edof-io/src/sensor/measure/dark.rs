//! Dark frames: black, the offsets that they support, and pixels far from what is usual around them.

use super::mean::Frames;
use super::statistics::{Centre, median, spread, usual};
use crate::sensor::correction::place;
use ndarray::{Array2, Axis};
use serde::Serialize;

/// Standard errors from which on the offset of a column or row is kept.
const SIGNIFICANT: f64 = 3.0;
/// Part of full scale; a column or row whose offset is farther off is defective.
const MAX_OFFSET: f64 = 0.125;
/// Values of noise within which of 0 a line does not answer at all.
const STUCK: f64 = 8.0;
/// Parts of a frame whose lines are compared, and how many spreads within them they differ by where that is no pattern of single lines.
const PARTS: usize = 8;
const SMOOTH: f64 = 4.0;
/// Variance of rounding to whole values.
const ROUNDING: f64 = 1.0 / 12.0;

/// Offsets in sensor values, and defects.
#[derive(Debug, Clone)]
pub struct Dark {
    pub black: [f64; 4],
    pub columns: Vec<f64>,
    pub rows: Vec<f64>,
    /// Offset of each pixel beyond black, column and row, if the frames support it.
    pub pixels: Option<Array2<f32>>,
    /// Hot and cold pixels.
    pub mask: Array2<bool>,
    pub report: DarkReport,
}

/// Holds what dark frames show, in sensor values.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DarkReport {
    /// Number of frames.
    pub frames: u32,
    /// Value of no light, of the 2×2 pixels row by row.
    pub black: [f64; 4],
    /// Standard deviation of a pixel between frames; of one frame, between pixels.
    pub noise: f64,
    /// Standard deviation between the means of pixels, without columns and rows.
    pub pattern: f64,
    /// Least and largest offset of a column.
    pub columns: [f64; 2],
    /// Least and largest offset of a row.
    pub rows: [f64; 2],
    /// Whether each pixel has an offset of its own.
    pub per_pixel: bool,
    /// Distance from what is usual around a pixel that makes it defective.
    pub threshold: f64,
    /// Pixels above it.
    pub hot: usize,
    /// Pixels below it.
    pub cold: usize,
    /// Offset of the column or row that is farthest below black, of those that are not at 0.
    pub lowest_line: f64,
    /// Difference of the brightest and the darkest eighth of columns or rows, where neighbours differ much less.
    pub slope: f64,
}

/// Measures dark frames. A pixel is defective if it is more than `hot` times the noise from what is usual around it.
pub fn measured(frames: &Frames, hot: f64) -> Dark {
    let mut rest = frames.mean();
    let floor = (ROUNDING / f64::from(frames.count)).sqrt();
    let black = [0, 1, 2, 3].map(|at| {
        let of_place = rest.indexed_iter().filter(|((r, c), _)| place(*r, *c) == at).map(|(_, v)| *v);
        Centre::of(&of_place.collect::<Vec<_>>(), floor).mean
    });
    rest.indexed_iter_mut().for_each(|((r, c), value)| *value -= black[place(r, c)] as f32);
    let columns = lines(&rest, Axis(1), floor);
    rest.indexed_iter_mut().for_each(|((_, c), value)| *value -= columns[c] as f32);
    let rows = lines(&rest, Axis(0), floor);
    rest.indexed_iter_mut().for_each(|((r, _), value)| *value -= rows[r] as f32);

    let pattern = spread(rest.iter().copied(), 0.0).max(floor);
    let around = &rest - &usual(&rest);
    let is_usual = |at: (usize, usize)| f64::from(around[at].abs()) <= 6.0 * pattern;
    let between = frames.variance(is_usual).map_or(pattern, f64::sqrt);
    let noise = between.hypot(ROUNDING.sqrt());
    let threshold = hot * noise.max(pattern);
    let mask = around.mapv(|off| f64::from(off.abs()) > threshold);
    let hot = around.iter().filter(|off| f64::from(**off) > threshold).count();
    let cold = mask.iter().filter(|is_bad| **is_bad).count() - hot;

    let per_pixel = frames.count > 1 && pattern * pattern > 2.0 * noise * noise / f64::from(frames.count);
    let ends = |lines: &[f64]| lines.iter().fold([0.0f64; 2], |[low, high], v| [low.min(*v), high.max(*v)]);
    let report = DarkReport {
        frames: frames.count,
        black,
        noise,
        pattern,
        columns: ends(&columns),
        rows: ends(&rows),
        per_pixel,
        threshold,
        hot,
        cold,
        lowest_line: lowest(&[&columns, &rows], black, noise),
        slope: slope(&columns).max(slope(&rows)),
    };
    Dark { black, columns, rows, pixels: per_pixel.then_some(rest), mask, report }
}

/// Returns the lowest offset of lines that are not stuck at 0, which says nothing of black.
fn lowest(lines: &[&[f64]; 2], black: [f64; 4], noise: f64) -> f64 {
    let darkest = black.into_iter().fold(f64::INFINITY, f64::min);
    let is_stuck = |offset: f64| darkest + offset < STUCK * noise;
    lines.iter().copied().flatten().copied().filter(|offset| !is_stuck(*offset)).fold(0.0, f64::min)
}

/// Returns the difference of the brightest and the darkest eighth of lines; 0 where lines are few or differ from their neighbours by as much.
fn slope(lines: &[f64]) -> f64 {
    let length = lines.len() / PARTS;
    if length < PARTS {
        return 0.0;
    }
    let parts = lines.chunks_exact(length).map(|part| part.iter().map(|v| *v as f32).collect::<Vec<_>>());
    let parts: Vec<(f64, f64)> = parts
        .map(|part| {
            let middle = median(part.clone());
            (middle, spread(part.into_iter(), middle))
        })
        .collect();
    let least = parts.iter().map(|part| part.0).fold(f64::INFINITY, f64::min);
    let most = parts.iter().map(|part| part.0).fold(f64::NEG_INFINITY, f64::max);
    let within = median(parts.iter().map(|part| part.1 as f32).collect());
    if most - least > SMOOTH * within { most - least } else { 0.0 }
}

/// Returns the offset of each line, 0 where it is not significant.
fn lines(rest: &Array2<f32>, axis: Axis, floor: f64) -> Vec<f64> {
    let of_line = |line: ndarray::ArrayView1<'_, f32>| {
        let Centre { mean, error } = Centre::of(&line.to_vec(), floor);
        if mean.abs() > SIGNIFICANT * error { mean } else { 0.0 }
    };
    rest.axis_iter(axis).map(of_line).collect()
}

/// Takes out and returns the lines whose offset is too far off the others'.
pub fn far_off(lines: &mut [f64], full: f64) -> Vec<u32> {
    let middle = median(lines.iter().map(|offset| *offset as f32).collect());
    let mut found = vec![];
    for (line, offset) in (0..).zip(lines) {
        if (*offset - middle).abs() > MAX_OFFSET * full {
            *offset = 0.0;
            found.push(line);
        }
    }
    found
}
