//! Flat frames: pixels that answer to light otherwise than those around them, and shading of each colour.

use super::MeasureError;
use super::statistics::{median, spread, usual};
use crate::read_warnings::greens_differ;
use crate::sensor::correction::{NODE_SPACING, grid, place};
use edof_core::{CfaPhase, Channel};
use ndarray::{Array2, Array3, s};
use serde::Serialize;

/// Pixels either way of a node that its shading is taken from.
const WINDOW: isize = 48;
/// Standard deviations of pixels' response that are usual.
const USUAL: f64 = 6.0;
/// Least and largest mean light of flat frames, as part of full scale.
pub const EXPOSURE: [f64; 2] = [0.05, 0.9];

/// Shading as what a gain must make up for, and defects.
#[derive(Debug, Clone)]
pub struct Flat {
    /// Gains of at least 1 at the nodes of the grid, for the four places of a cell.
    pub gains: Array3<f64>,
    pub mask: Array2<bool>,
    pub report: FlatReport,
}

/// Holds what flat frames show.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlatReport {
    /// Number of frames.
    pub frames: u32,
    /// Mean light of red, green and blue, as part of full scale.
    pub light: [f64; 3],
    /// Standard deviation of a pixel's response to light, as part of what is usual around it.
    pub response: f64,
    /// Distance of the response from 1 that makes a pixel defective.
    pub threshold: f64,
    /// Pixels of other response.
    pub dead: usize,
    /// Largest gain of red, green and blue.
    pub shading: [f64; 3],
    /// Whether what the phase takes for green differs as red and blue do.
    pub is_of_other_phase: bool,
}

/// Measures light (sensor values above black) whose full scale is `full`. A pixel is defective if its response is more than `limit` off.
///
/// # Errors
/// [`MeasureError::Exposure`] for frames that are too dark or too bright.
pub fn measured(
    light: &Array2<f32>,
    frames: u32,
    phase: CfaPhase,
    full: f64,
    limit: f64,
) -> Result<Flat, MeasureError> {
    let of = |channel: Channel| {
        let values = light.indexed_iter().filter(|((r, c), _)| phase.channel(*r, *c) == channel);
        median(values.map(|(_, value)| *value).collect()) / full
    };
    let means = Channel::ALL.map(of);
    let [least, most] = EXPOSURE;
    if let Some(channel) = Channel::ALL.into_iter().find(|c| !(least..=most).contains(&means[c.plane()])) {
        return Err(MeasureError::Exposure { channel, light: means[channel.plane()] });
    }
    let around = usual(light);
    let mut response = light.clone();
    ndarray::Zip::from(&mut response).and(&around).for_each(|value, usual| {
        *value = if *usual > 0.0 { *value / usual } else { 1.0 };
    });
    let width = spread(response.iter().copied(), 1.0);
    let threshold = limit.max(USUAL * width);
    let mask = response.mapv(|response| (f64::from(response) - 1.0).abs() > threshold);
    let gains = gains(&shades(light, &mask), phase);
    let most = |channel: Channel| {
        let of_colour = gains.indexed_iter().filter(|((at, ..), _)| phase.channel(at / 2, at % 2) == channel);
        of_colour.fold(1.0, |most: f64, (_, gain)| most.max(*gain))
    };
    let report = FlatReport {
        frames,
        light: means,
        response: width,
        threshold,
        dead: mask.iter().filter(|is_bad| **is_bad).count(),
        shading: Channel::ALL.map(most),
        is_of_other_phase: greens_differ(means_of_places(light, &mask), phase),
    };
    Ok(Flat { gains, mask, report })
}

/// Returns the mean light of the good pixels of each place of a cell.
fn means_of_places(light: &Array2<f32>, mask: &Array2<bool>) -> [[f64; 2]; 2] {
    let mut sums = [[(0.0, 0.0); 2]; 2];
    for (((r, c), value), _) in light.indexed_iter().zip(mask).filter(|(_, is_bad)| !**is_bad) {
        let (count, sum) = &mut sums[r % 2][c % 2];
        *count += 1.0;
        *sum += f64::from(*value);
    }
    sums.map(|row| row.map(|(count, sum)| sum / f64::max(count, 1.0)))
}

/// Returns the light at each node of the grid, for the four places of a cell.
fn shades(light: &Array2<f32>, mask: &Array2<bool>) -> Array3<f64> {
    let (height, width) = light.dim();
    let (rows, columns) = grid(crate::raw::Size { width, height });
    Array3::from_shape_fn((4, rows, columns), |(at, i, j)| {
        shade(light, mask, at, [i, j].map(|n| n * NODE_SPACING))
    })
}

/// Returns the light at a node: that of the plane through the good pixels of a place around it.
fn shade(light: &Array2<f32>, mask: &Array2<bool>, at: usize, node: [usize; 2]) -> f64 {
    let (height, width) = light.dim();
    let window = |middle: usize, end: usize| {
        let reach = |by: isize| middle.saturating_add_signed(by).min(end);
        reach(-WINDOW)..reach(WINDOW)
    };
    // Sums of 1, y, x, yy, yx, xx, and of the light times 1, y, x.
    let (mut n, mut sums, mut right) = (0.0, [0.0; 5], [0.0; 3]);
    for r in window(node[0], height) {
        for c in window(node[1], width) {
            if place(r, c) != at || mask[(r, c)] {
                continue;
            }
            let scale = WINDOW as f64;
            let (y, x) = ((r as f64 - node[0] as f64) / scale, (c as f64 - node[1] as f64) / scale);
            let value = f64::from(light[(r, c)]);
            n += 1.0;
            sums = [sums[0] + y, sums[1] + x, sums[2] + y * y, sums[3] + y * x, sums[4] + x * x];
            right = [right[0] + value, right[1] + y * value, right[2] + x * value];
        }
    }
    let [y, x, yy, yx, xx] = sums;
    let det = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let whole = det([[n, y, x], [y, yy, yx], [x, yx, xx]]);
    if whole.abs() > 1e-9 * n.powi(3) {
        // Cramer's rule for the plane's height at the node.
        det([[right[0], y, x], [right[1], yy, yx], [right[2], yx, xx]]) / whole
    } else {
        right[0] / f64::max(n, 1.0)
    }
}

/// Returns gains that make each colour as bright everywhere as at its brightest node inside of the frame.
fn gains(shades: &Array3<f64>, phase: CfaPhase) -> Array3<f64> {
    let (_, rows, columns) = shades.dim();
    let inside = shades.slice(s![.., ..(rows - 1).max(1), ..(columns - 1).max(1)]);
    let brightest = Channel::ALL.map(|channel| {
        let of_colour =
            inside.indexed_iter().filter(|((at, ..), _)| phase.channel(at / 2, at % 2) == channel);
        of_colour.fold(0.0, |most: f64, (_, shade)| most.max(*shade))
    });
    Array3::from_shape_fn(shades.dim(), |(at, i, j)| {
        let brightest = brightest[phase.channel(at / 2, at % 2).plane()];
        let shade = shades[(at, i, j)];
        if shade > 0.0 { (brightest / shade).max(1.0) } else { f64::INFINITY }
    })
}
