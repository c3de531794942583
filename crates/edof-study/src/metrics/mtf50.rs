//! Sharpness from a slanted edge (ISO 12233, edge-based spatial frequency response).
//!
//! Each row's edge is located by the centroid of its derivative, a line is fitted through all rows, every pixel is projected
//! along the line into bins a quarter of a pixel wide (ESF), the derivative of that (LSF) is windowed and transformed. What
//! the derivative and the bins themselves take away is divided out. The pixel's own footprint is part of what is measured.

use edof_numerics::sinc;
use ndarray::{Array1, ArrayView2};
use std::f64::consts::PI;

/// Bins of the edge-spread function for each pixel.
const OVERSAMPLING: usize = 4;
/// Steps of the frequency axis: cycles/pixel from 0 to 1.
const FREQUENCY_STEPS: usize = 200;

/// A measured edge.
#[derive(Debug, Clone)]
pub struct EdgeResponse {
    /// Pairs of frequency in cycles/pixel and MTF, from 0 to 1 cycle/pixel.
    pub mtf: Vec<[f64; 2]>,
    /// Angle between the edge and the nearest pixel axis, in degrees.
    pub angle_degrees: f64,
}

/// A region in which no edge can be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum EdgeError {
    /// Too few pixels.
    #[error("edge region of {width}x{height} pixels: must be at least 16x16")]
    Small { height: usize, width: usize },
    /// No contrast, or an edge that leaves the region.
    #[error("edge region: contains no single straight edge from one side to the other")]
    NoEdge,
    /// An edge along the pixels, or too far from them, leaves bins empty.
    #[error("edge region: edge at {0:.2} degrees, must be 1 to 30 degrees off the pixel rows or columns")]
    Angle(f64),
}

impl EdgeResponse {
    /// Measures the one edge in `region` (linear light); it may be near vertical or near horizontal, 1 to 30 degrees off.
    ///
    /// # Errors
    /// [`EdgeError`] for small regions, no edge, or one at an angle that cannot be measured.
    pub fn measure(region: ArrayView2<'_, f32>) -> Result<Self, EdgeError> {
        let (height, width) = region.dim();
        if height < 16 || width < 16 {
            return Err(EdgeError::Small { height, width });
        }
        let upright = if change(region) >= change(region.t()) { region } else { region.reversed_axes() };
        let (offset, slope) = edge_line(upright)?;
        let angle = slope.atan();
        let degrees = angle.to_degrees().abs();
        if !(1.0..=30.0).contains(&degrees) {
            return Err(EdgeError::Angle(degrees));
        }
        let spread = edge_spread(upright, offset, slope)?;
        Ok(Self { mtf: transfer(&line_spread(&spread)), angle_degrees: degrees })
    }

    /// Frequency in cycles/pixel at which the MTF first falls to one half; 1 where it never does.
    #[must_use]
    pub fn mtf50(&self) -> f64 {
        let crossing = self.mtf.windows(2).find(|p| p[0][1] >= 0.5 && p[1][1] < 0.5);
        crossing.map_or(1.0, |p| {
            let share = (p[0][1] - 0.5) / (p[0][1] - p[1][1]);
            share.mul_add(p[1][0] - p[0][0], p[0][0])
        })
    }
}

/// Total change along the rows.
fn change(region: ArrayView2<'_, f32>) -> f64 {
    let row_change = |row: ndarray::ArrayView1<'_, f32>| f64::from((row[row.len() - 1] - row[0]).abs());
    region.outer_iter().map(row_change).sum()
}

/// Edge column = offset + slope · row, fitted twice: the second time each row looks only around the first fit.
fn edge_line(region: ArrayView2<'_, f32>) -> Result<(f64, f64), EdgeError> {
    let width = region.ncols() as f64;
    let first = fit(region, |_| (0.5 * width, 0.5 * width))?;
    let line = fit(region, |row| (first.1.mul_add(row, first.0), (0.2 * width).max(6.0)))?;
    let inside = |row: f64| (2.0..width - 3.0).contains(&line.1.mul_add(row, line.0));
    let last = region.nrows() as f64 - 1.0;
    if inside(0.0) && inside(last) { Ok(line) } else { Err(EdgeError::NoEdge) }
}

/// Least squares through the rows' derivative centroids, seen through a Hann window of the given centre and half width.
fn fit(region: ArrayView2<'_, f32>, window: impl Fn(f64) -> (f64, f64)) -> Result<(f64, f64), EdgeError> {
    let (mut n, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (row, values) in region.outer_iter().enumerate() {
        let (centre, half_width) = window(row as f64);
        let (mut weight, mut moment) = (0.0, 0.0);
        for column in 1..values.len() {
            let at = column as f64 - 0.5;
            let distance = (at - centre) / half_width;
            if distance.abs() < 1.0 {
                let derivative =
                    f64::from(values[column] - values[column - 1]) * (0.5 * PI * distance).cos().powi(2);
                weight += derivative;
                moment += derivative * at;
            }
        }
        if weight.abs() < 1e-3 {
            return Err(EdgeError::NoEdge);
        }
        let (x, y) = (row as f64, moment / weight);
        n += 1.0;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    let slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    Ok(((sy - slope * sx) / n, slope))
}

/// Mean value in each quarter-pixel bin of distance from the edge, edge in the middle. An odd number of bins.
fn edge_spread(region: ArrayView2<'_, f32>, offset: f64, slope: f64) -> Result<Array1<f64>, EdgeError> {
    let cosine = slope.atan().cos();
    let last_row = region.nrows() as f64 - 1.0;
    // Distances that every row contains, so that all bins are means over the whole edge.
    let ends = [offset, slope.mul_add(last_row, offset)];
    let left = ends[0].min(ends[1]);
    let right = region.ncols() as f64 - 1.0 - ends[0].max(ends[1]);
    let half = ((left.min(right) * cosine) * OVERSAMPLING as f64).floor() as usize;
    if half < 4 * OVERSAMPLING {
        return Err(EdgeError::NoEdge);
    }
    let mut sums = Array1::<f64>::zeros(2 * half + 1);
    let mut counts = Array1::<f64>::zeros(2 * half + 1);
    for ((row, column), &value) in region.indexed_iter() {
        let distance = (column as f64 - slope.mul_add(row as f64, offset)) * cosine;
        let bin = (distance * OVERSAMPLING as f64).round() as isize + half as isize;
        if (0..sums.len() as isize).contains(&bin) {
            sums[bin as usize] += f64::from(value);
            counts[bin as usize] += 1.0;
        }
    }
    if counts.iter().any(|&n| n == 0.0) {
        return Err(EdgeError::Angle(slope.atan().to_degrees().abs()));
    }
    Ok(sums / counts)
}

/// Central difference of the edge-spread function under a Hamming window.
fn line_spread(spread: &Array1<f64>) -> Array1<f64> {
    let bins = spread.len();
    Array1::from_shape_fn(bins - 2, |i| {
        let window = 0.46f64.mul_add(-(2.0 * PI * (i as f64 + 0.5) / (bins as f64 - 2.0)).cos(), 0.54);
        0.5 * (spread[i + 2] - spread[i]) * window
    })
}

/// |Fourier transform| of the line-spread function over its value at 0, freed of what bins and differences take away.
fn transfer(line: &Array1<f64>) -> Vec<[f64; 2]> {
    let total: f64 = line.sum();
    (0..=FREQUENCY_STEPS)
        .map(|step| {
            let frequency = step as f64 / FREQUENCY_STEPS as f64;
            let radians = 2.0 * PI * frequency / OVERSAMPLING as f64;
            let (re, im) = line.iter().enumerate().fold((0.0, 0.0), |(re, im), (i, v)| {
                let (sine, cosine) = (radians * i as f64).sin_cos();
                (v.mul_add(cosine, re), v.mul_add(sine, im))
            });
            let bin = sinc(frequency / OVERSAMPLING as f64);
            let difference = sinc(2.0 * frequency / OVERSAMPLING as f64);
            [frequency, re.hypot(im) / total.abs() / (bin * difference)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    /// Normal distribution function by Simpson's rule.
    fn normal(x: f64) -> f64 {
        let (n, x) = (200, x.clamp(-8.0, 8.0));
        let h = x / f64::from(n);
        let density = |t: f64| (-0.5 * t * t).exp() / (2.0 * PI).sqrt();
        let sum: f64 = (0..=n)
            .map(|i| {
                f64::from(if i == 0 || i == n {
                    1
                } else if i % 2 == 1 {
                    4
                } else {
                    2
                }) * density(h * f64::from(i))
            })
            .sum();
        0.5 + sum * h / 3.0
    }

    /// An edge of the given slant, blurred by a Gaussian of σ pixels, sampled at points.
    fn edge(sigma: f64, degrees: f64, size: usize) -> Array2<f32> {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let middle = 0.5 * (size as f64 - 1.0) + 0.13;
        Array2::from_shape_fn((size, size), |(r, c)| {
            let distance = (c as f64 - middle) * cosine - (r as f64 - middle) * sine;
            (0.1 + 0.8 * normal(distance / sigma)) as f32
        })
    }

    fn gaussian_mtf50(sigma: f64) -> f64 {
        (2f64.ln() / 2.0).sqrt() / (PI * sigma)
    }

    #[test]
    fn a_gaussian_edge_has_the_mtf50_of_its_sigma() {
        for sigma in [0.6, 1.0, 1.7] {
            for degrees in [5.0, -8.0] {
                let found = EdgeResponse::measure(edge(sigma, degrees, 64).view()).unwrap();
                let (mtf50, expected) = (found.mtf50(), gaussian_mtf50(sigma));
                assert!(
                    (mtf50 / expected - 1.0).abs() < 0.02,
                    "σ {sigma}, {degrees}°: {mtf50} not {expected}"
                );
                assert!((found.angle_degrees - degrees.abs()).abs() < 0.1);
            }
        }
    }

    #[test]
    fn the_whole_curve_is_gaussian() {
        let found = EdgeResponse::measure(edge(1.0, 6.0, 80).view()).unwrap();
        for [f, m] in found.mtf.into_iter().take_while(|p| p[0] <= 0.4) {
            let expected = (-2.0 * (PI * f).powi(2)).exp();
            assert!((m - expected).abs() < 0.01, "{f}: {m} not {expected}");
        }
    }

    #[test]
    fn orientation_and_polarity_do_not_matter() {
        let upright = edge(1.2, 7.0, 64);
        let expected = EdgeResponse::measure(upright.view()).unwrap().mtf50();
        let lying = upright.t().to_owned();
        let inverted = upright.mapv(|v| 1.0 - v);
        for other in [lying, inverted] {
            let found = EdgeResponse::measure(other.view()).unwrap().mtf50();
            assert!((found - expected).abs() < 1e-3, "{found} not {expected}");
        }
    }

    #[test]
    fn regions_without_a_usable_edge_are_rejected() {
        let even = Array2::from_elem((32, 32), 0.5f32);
        assert_eq!(EdgeResponse::measure(even.view()).unwrap_err(), EdgeError::NoEdge);
        let straight = edge(1.0, 0.0, 32);
        assert!(matches!(EdgeResponse::measure(straight.view()), Err(EdgeError::Angle(_))));
        let small = Array2::from_elem((8, 32), 0.5f32);
        assert_eq!(
            EdgeResponse::measure(small.view()).unwrap_err().to_string(),
            "edge region of 32x8 pixels: must be at least 16x16"
        );
    }
}
