//! Demosaicing along edges instead of across them: D. Menon, S. Andriani, G. Calvagno, "Demosaicing with directional filtering and a
//! posteriori decision", IEEE Trans. Image Processing 16 (2007), with its refining step.
//!
//! Green is interpolated twice, along rows and along columns. Where the difference of red (or blue) and green varies less, that was
//! the direction of the edge; everything else follows it. Borders are mirrored about the edge pixel, which keeps the Bayer phase.

use edof_core::geometry::{GeometryError, mirror};
use edof_core::{CfaPhase, Channel, ColourFrame, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use ndarray::{Array2, Array3, Axis};
use std::time::Instant;

/// Side that what is read around a pixel needs at least.
const MIN_SIDE: usize = 4;
/// Pixels that the decision for one pixel depends on, along one axis.
const WINDOW: usize = 5;

/// The method as it enters studies.
#[derive(Debug, Clone)]
pub struct Directional {
    name: String,
}

impl Default for Directional {
    fn default() -> Self {
        Self { name: "demosaic-directional".into() }
    }
}

impl Reconstructor for Directional {
    fn name(&self) -> &str {
        &self.name
    }

    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let (height, width) = raw.size();
        if height < MIN_SIDE || width < MIN_SIDE {
            return Err(GeometryError::SmallFrame { height, width, min: MIN_SIDE, window: WINDOW }.into());
        }
        let start = Instant::now();
        let frame = demosaic(raw);
        Ok(Reconstruction {
            frame,
            seconds: start.elapsed().as_secs_f64(),
            multiplications: None,
            counters: None,
            iterations: None,
        })
    }
}

/// Rows or columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    AlongRow,
    AlongColumn,
}

/// A value some pixels further along a way, mirrored at the borders.
fn at(plane: &Array2<f32>, (r, c): (usize, usize), way: Way, steps: isize) -> f32 {
    let (height, width) = plane.dim();
    match way {
        Way::AlongRow => plane[(r, mirror(c as isize + steps, width))],
        Way::AlongColumn => plane[(mirror(r as isize + steps, height), c)],
    }
}

/// Mean of the two neighbours along a way.
fn neighbours(plane: &Array2<f32>, here: (usize, usize), way: Way) -> f32 {
    0.5 * (at(plane, here, way, -1) + at(plane, here, way, 1))
}

/// Mean of a pixel and its two neighbours along a way.
fn smooth(plane: &Array2<f32>, here: (usize, usize), way: Way) -> f32 {
    (2.0 * neighbours(plane, here, way) + plane[here]) / 3.0
}

/// All three colours at every pixel; a colour that was measured stays as it is.
fn demosaic(raw: &RawFrame) -> ColourFrame {
    let phase = raw.phase();
    let light = raw.pixels().mapv(|v| f32::from(v) / 65536.0);
    let green = [Way::AlongRow, Way::AlongColumn].map(|way| green_along(&light, phase, way));
    let ways = decision(&light, &green, phase);
    let chosen = Array2::from_shape_fn(light.dim(), |at| match ways[at] {
        Way::AlongRow => green[0][at],
        Way::AlongColumn => green[1][at],
    });
    let mut work = Work { phase, ways, planes: [light.clone(), chosen, light] };
    work.colours_at_green();
    work.colours_at_each_other(neighbours);
    work.refine();
    let mut frame = Array3::zeros((3, raw.size().0, raw.size().1));
    frame.axis_iter_mut(Axis(0)).zip(&work.planes).for_each(|(mut to, plane)| to.assign(plane));
    ColourFrame { planes: frame }
}

/// Green at every pixel by the five pixels along a way (section II-A).
fn green_along(light: &Array2<f32>, phase: CfaPhase, way: Way) -> Array2<f32> {
    Array2::from_shape_fn(light.dim(), |here| {
        if phase.channel(here.0, here.1) == Channel::Green {
            return light[here];
        }
        let other = 0.25 * (at(light, here, way, -2) + at(light, here, way, 2));
        neighbours(light, here, way) + 0.5 * light[here] - other
    })
}

/// The way along which the colour differences around each pixel vary less (section II-B).
fn decision(light: &Array2<f32>, green: &[Array2<f32>; 2], phase: CfaPhase) -> Array2<Way> {
    let varies = |green: &Array2<f32>, way: Way| {
        let is_green = |(r, c): (usize, usize)| phase.channel(r, c) == Channel::Green;
        let difference =
            Array2::from_shape_fn(light.dim(), |at| if is_green(at) { 0.0 } else { light[at] - green[at] });
        Array2::from_shape_fn(light.dim(), |here| (difference[here] - at(&difference, here, way, 2)).abs())
    };
    let [rows, columns] = [varies(&green[0], Way::AlongRow), varies(&green[1], Way::AlongColumn)];
    // Beyond the picture nothing varies.
    let value = |plane: &Array2<f32>, r: isize, c: isize| {
        usize::try_from(r)
            .ok()
            .zip(usize::try_from(c).ok())
            .and_then(|at| plane.get(at))
            .copied()
            .unwrap_or(0.0)
    };
    // Steps across the way, steps along it, weight: the two differences that hold the pixel count most.
    const AROUND: [(isize, isize, f32); 8] = [
        (-2, 0, 1.0),
        (-2, -2, 1.0),
        (-1, -1, 1.0),
        (0, 0, 3.0),
        (0, -2, 3.0),
        (1, -1, 1.0),
        (2, 0, 1.0),
        (2, -2, 1.0),
    ];
    Array2::from_shape_fn(light.dim(), |(r, c)| {
        let (r, c) = (r as isize, c as isize);
        let along_row: f32 =
            AROUND.iter().map(|&(across, along, w)| w * value(&rows, r + across, c + along)).sum();
        let along_column: f32 =
            AROUND.iter().map(|&(across, along, w)| w * value(&columns, r + along, c + across)).sum();
        if along_column >= along_row { Way::AlongRow } else { Way::AlongColumn }
    })
}

struct Work {
    phase: CfaPhase,
    ways: Array2<Way>,
    /// Red, green, blue; what is not known yet is arbitrary.
    planes: [Array2<f32>; 3],
}

impl Work {
    /// Every pixel of one colour.
    fn sites(&self, wanted: Channel) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (height, width) = self.ways.dim();
        let phase = self.phase;
        let all = (0..height).flat_map(move |r| (0..width).map(move |c| (r, c)));
        all.filter(move |&(r, c)| phase.channel(r, c) == wanted)
    }

    /// Red and blue at green pixels: green, and the mean difference to it of the two neighbours that measured the colour.
    fn colours_at_green(&mut self) {
        for here in self.sites(Channel::Green) {
            for channel in [Channel::Red, Channel::Blue] {
                let in_row = self.phase.channel(here.0, here.1 + 1) == channel;
                let way = if in_row { Way::AlongRow } else { Way::AlongColumn };
                let [own, green] =
                    [channel.plane(), Channel::Green.plane()].map(|p| neighbours(&self.planes[p], here, way));
                self.planes[channel.plane()][here] = self.planes[Channel::Green.plane()][here] + own - green;
            }
        }
    }

    /// Red at blue pixels and blue at red ones, by their difference along the pixel's way.
    fn colours_at_each_other(&mut self, mean: fn(&Array2<f32>, (usize, usize), Way) -> f32) {
        let difference = &self.planes[0] - &self.planes[2];
        for (site, sign) in [(Channel::Blue, 1.0), (Channel::Red, -1.0)] {
            let (known, wanted) = (site.plane(), 2 - site.plane());
            for here in self.sites(site) {
                self.planes[wanted][here] =
                    self.planes[known][here] + sign * mean(&difference, here, self.ways[here]);
            }
        }
    }

    /// Smoother colour differences along each pixel's way (section III).
    fn refine(&mut self) {
        for site in [Channel::Red, Channel::Blue] {
            let difference = &self.planes[site.plane()] - &self.planes[Channel::Green.plane()];
            for here in self.sites(site) {
                let smoothed = smooth(&difference, here, self.ways[here]);
                self.planes[Channel::Green.plane()][here] = self.planes[site.plane()][here] - smoothed;
            }
        }
        self.colours_at_green();
        self.colours_at_each_other(smooth);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Malvar;

    fn mosaic(
        size: (usize, usize),
        phase: CfaPhase,
        light: impl Fn(Channel, usize, usize) -> f32,
    ) -> RawFrame {
        let values =
            Array2::from_shape_fn(size, |(r, c)| (65535.0 * light(phase.channel(r, c), r, c)).round() as u16);
        RawFrame::from_values(values, 16, phase).unwrap()
    }

    fn out(raw: &RawFrame) -> ColourFrame {
        Directional::default().reconstruct(raw).unwrap().frame
    }

    #[test]
    fn ramps_of_grey_are_exact_and_measured_colours_stay() {
        for phase in CfaPhase::ALL {
            let raw = mosaic((26, 28), phase, |_, r, c| 0.1 + 0.01 * r as f32 + 0.02 * c as f32);
            let frame = out(&raw);
            for ((p, r, c), &v) in frame.planes.indexed_iter() {
                let inside = (8..18).contains(&r) && (8..20).contains(&c);
                assert!(
                    !inside || (v - f32::from(raw.pixels()[(r, c)]) / 65536.0).abs() < 1e-4,
                    "{phase} {p} {r} {c}"
                );
                if phase.channel(r, c).plane() == p {
                    assert_eq!(v, f32::from(raw.pixels()[(r, c)]) / 65536.0);
                }
            }
        }
    }

    /// Fine stripes are what linear filters break at; along them nothing varies.
    #[test]
    fn fine_stripes_keep_their_colour_where_linear_filters_do_not() {
        for upright in [false, true] {
            let stripe = |r: usize, c: usize| 0.5 + 0.3 * (2.3 * if upright { c } else { r } as f32).sin();
            let raw = mosaic((32, 32), CfaPhase::Rggb, |_, r, c| stripe(r, c));
            let error = |frame: &ColourFrame| {
                let inside = frame
                    .planes
                    .indexed_iter()
                    .filter(|((_, r, c), _)| (6..26).contains(r) && (6..26).contains(c));
                inside.map(|((_, r, c), v)| (v - stripe(r, c)).abs()).fold(0.0, f32::max)
            };
            let linear = Malvar::default().reconstruct(&raw).unwrap().frame;
            let (along, across) = (error(&out(&raw)), error(&linear));
            assert!(along < 0.01 && across > 0.05, "{upright}: {along} {across}");
        }
    }

    #[test]
    fn turning_the_frame_turns_the_picture() {
        let light = |r: usize, c: usize| 0.5 + 0.4 * ((r * r) as f32 * 0.05 + c as f32 * 0.7).sin();
        let direct = out(&mosaic((20, 20), CfaPhase::Rggb, |_, r, c| light(r, c)));
        let turned = out(&mosaic((20, 20), CfaPhase::Rggb, |_, r, c| light(c, r)));
        // Where both directions vary equally the decision is for rows, which turning does not keep: few pixels.
        let differing = direct
            .planes
            .indexed_iter()
            .filter(|((p, r, c), v)| (**v - turned.planes[(*p, *c, *r)]).abs() > 1e-4);
        assert!(differing.count() < 12, "a turned frame gives another picture");
    }

    #[test]
    fn a_frame_smaller_than_the_decision_is_rejected() {
        let raw = mosaic((2, 8), CfaPhase::Rggb, |_, _, _| 0.0);
        let error = Directional::default().reconstruct(&raw).unwrap_err().to_string();
        assert_eq!(error, "frame 8x2: both sides must be at least 4 pixels for a window of 5");
    }
}
