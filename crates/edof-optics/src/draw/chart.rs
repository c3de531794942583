//! The resolution chart: four cards with a Siemens star, slanted edges, bars and text, each in ink of another colour.

use super::coverage;
use super::quarter::Quarter;
use crate::scene::Layer;
use edof_core::ColourFrame;
use edof_core::font;
use ndarray::Array2;

/// Linear light of paper and ink, red to blue, for each card from back to front: grey, then the three pairs that ask most of the
/// colour channels.
const COLOURS: [[[f32; 3]; 2]; 4] = [
    [[0.75, 0.75, 0.75], [0.04, 0.04, 0.04]],
    [[0.85, 0.78, 0.45], [0.05, 0.08, 0.30]],
    [[0.80, 0.55, 0.50], [0.06, 0.22, 0.08]],
    [[0.55, 0.75, 0.85], [0.42, 0.05, 0.05]],
];
/// How far each card is turned, in degrees.
const TURNS: [f64; 4] = [0.0, 3.0, -4.0, 2.0];
/// Widths of the bars in pixels.
const BARS: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
const SPOKES: f64 = 36.0;
const EDGE_DEGREES: f64 = 5.0;

/// The chart's four layers from back to front, all at ψ = 0: a wall that carries the first card's print, and three cards.
#[must_use]
pub fn layers(height: usize, width: usize) -> [Layer; 4] {
    [0, 1, 2, 3].map(|index| layer(index, height, width))
}

fn layer(index: usize, height: usize, width: usize) -> Layer {
    let card = Card::new(index, height, width);
    let [paper, ink] = COLOURS[index];
    let mut light = ColourFrame::zeros(height, width);
    let mut matte = Array2::zeros((height, width));
    for row in 0..height {
        for column in 0..width {
            let covered = match index {
                0 => 1.0,
                _ if card.place.is_far_from(row, column) => continue,
                _ => coverage(row, column, |y, x| card.covers(card.place.local(y, x))),
            };
            let printed = if card.place.is_far_from(row, column) {
                0.0
            } else {
                coverage(row, column, |y, x| card.has_ink(card.place.local(y, x)))
            };
            matte[(row, column)] = covered;
            for plane in 0..3 {
                light.planes[(plane, row, column)] =
                    paper[plane] * (covered - printed) + ink[plane] * printed;
            }
        }
    }
    Layer { light, matte: (index > 0).then_some(matte), psi: 0.0 }
}

/// A card of the chart.
struct Card {
    place: Quarter,
    text: String,
}

impl Card {
    fn new(index: usize, height: usize, width: usize) -> Self {
        let place = Quarter::new(index, (height, width), (0.21, 0.22), TURNS[index]);
        Self { place, text: format!("EDOF CARD {index} 0123456789") }
    }

    fn covers(&self, (y, x): (f64, f64)) -> bool {
        y.abs() <= self.place.half.0 && x.abs() <= self.place.half.1
    }

    fn has_ink(&self, at: (f64, f64)) -> bool {
        self.covers(at) && (self.star(at) || self.edges(at) || self.bars(at) || self.print(at))
    }

    /// Siemens star on the left.
    fn star(&self, (y, x): (f64, f64)) -> bool {
        let radius = 0.74 * self.place.half.0;
        let (dy, dx) =
            (y + 0.16 * self.place.half.0, x + self.place.half.1 - 0.12 * self.place.half.0 - radius);
        dy.hypot(dx) < radius && (SPOKES * dy.atan2(dx)).sin() > 0.0
    }

    /// A square on the upper right, turned a little, for edges of both directions.
    fn edges(&self, (y, x): (f64, f64)) -> bool {
        let half = 0.30 * self.place.half.0;
        let (dy, dx) = (y + 0.52 * self.place.half.0, x - self.place.half.1 + 1.6 * half);
        let (sine, cosine) = EDGE_DEGREES.to_radians().sin_cos();
        (cosine * dy - sine * dx).abs() < half && (sine * dy + cosine * dx).abs() < half
    }

    /// Groups of bars right of the middle, upright above and level below, finer to the right.
    fn bars(&self, (y, x): (f64, f64)) -> bool {
        let (top, side) = (-0.10 * self.place.half.0, 0.30 * self.place.half.0);
        let mut left = self.place.half.1 - 0.10 * self.place.half.0;
        for width in BARS {
            let group = 6.0 * width;
            left -= group + 4.0;
            if (left..left + group).contains(&x) {
                let is_dark = |along: f64| ((along / width) as usize).is_multiple_of(2);
                let below = y - top - side - 4.0;
                let upright = (top..top + side).contains(&y) && is_dark(x - left);
                return upright || (0.0..group.min(side)).contains(&below) && is_dark(below);
            }
        }
        false
    }

    /// A line of text along the lower edge, as large as fits, and under it the same in dots of a pixel.
    fn print(&self, (y, x): (f64, f64)) -> bool {
        let from_left = x + 0.92 * self.place.half.1;
        let letters = self.text.len() as f64;
        let dot = (1.84 * self.place.half.1 / (letters * font::ADVANCE))
            .min(0.18 * self.place.half.0 / font::HEIGHT);
        let large = font::is_ink(&self.text, from_left / dot, (y - 0.66 * self.place.half.0) / dot);
        large || font::is_ink(&self.text, from_left, y - 0.89 * self.place.half.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_background_covers_everything_and_the_cards_their_own_quarters() {
        let layers = layers(256, 384);
        assert!(layers[0].matte.is_none());
        for (layer, (row, column)) in layers[1..].iter().zip([(64, 288), (192, 96), (192, 288)]) {
            let matte = layer.matte.as_ref().unwrap();
            assert_eq!((matte[(row, column)], matte[(256 - row, 384 - column)]), (1.0, 0.0));
        }
    }

    #[test]
    fn paper_and_ink_both_show_on_every_card() {
        for (layer, [paper, ink]) in layers(256, 384).iter().zip(COLOURS) {
            let green = layer.light.planes.index_axis(ndarray::Axis(0), 1);
            let share = |level: f32| {
                green.iter().filter(|v| (**v - level).abs() < 1e-4).count() as f64 / green.len() as f64
            };
            assert!(share(paper[1]) > 0.05 && share(ink[1]) > 0.02, "{} {}", share(paper[1]), share(ink[1]));
        }
    }
}
