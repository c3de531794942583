//! A scene of four parcels, one at each depth, whose labels carry codes and text: what a long depth of field is bought for.

use crate::codes::{Card, Symbology};
use crate::report::letters::Writing;
use edof_core::ColourFrame;
use edof_core::draw::Draw;
use edof_optics::draw::quarter::Quarter;
use edof_optics::draw::{DrawError, MIN_SIDE};
use edof_optics::{Layer, Scene};
use ndarray::{Array2, Axis};
use rayon::prelude::*;

/// Linear light of each parcel, from back to front.
const PARCELS: [[f32; 3]; 4] =
    [[0.46, 0.30, 0.16], [0.12, 0.24, 0.46], [0.14, 0.34, 0.18], [0.52, 0.14, 0.10]];
const WALL: [f32; 3] = [0.30, 0.32, 0.34];
const SHELF: [f32; 3] = [0.36, 0.25, 0.14];
const PAPER: [f32; 3] = [0.80; 3];
/// Of codes.
const INK: [f32; 3] = [0.04; 3];
/// How far each parcel is turned, in degrees.
const TURNS: [f64; 4] = [0.0, 2.0, -3.0, 1.5];
/// Sides of the modules of a label's QR codes, in pixels.
const QR_PX: [f64; 3] = [2.5, 2.0, 1.5];
/// Side of the modules of its bars.
const BAR_PX: f64 = 1.5;
/// Heights of the capitals of its lines in pixels, and their ink.
const LINES: [(f64, [f32; 3]); 4] =
    [(20.0, [0.45, 0.03, 0.03]), (13.0, [0.03, 0.08, 0.40]), (9.0, INK), (6.0, [0.02, 0.20, 0.06])];
/// Pixels from a parcel's edge to its label, and on the label around all print.
const MARGIN: f64 = 7.0;
/// Pixels from one row of print to the next.
const GAP: f64 = 4.0;
/// Samples along each side of a pixel.
const FINE: usize = 4;

/// The scene, and the codes that are seen in it.
#[derive(Debug, Clone)]
pub struct Labels {
    /// Four layers from back to front: a wall with the first parcel, and three parcels.
    pub scene: Scene,
    /// Codes that are whole on their labels.
    pub codes: Vec<(Symbology, Card)>,
}

/// A scene that cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum LabelsError {
    /// Too small, or odd.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A text that rxing does not encode.
    #[error("a label's code: {0}")]
    Code(#[from] rxing::Exceptions),
}

/// Draws four parcels at depths from back to front. Same seed, same codes.
///
/// # Errors
/// [`LabelsError::Draw`] for sides that no scene may have.
pub fn draw(height: usize, width: usize, psis: [f64; 4], seed: u64) -> Result<Labels, LabelsError> {
    if height.min(width) < MIN_SIDE || !height.is_multiple_of(2) || !width.is_multiple_of(2) {
        return Err(DrawError::Size { height, width }.into());
    }
    let draw = &mut Draw::new(seed);
    let parcels: Vec<Parcel> =
        (0..4).map(|index| Parcel::new(index, height, width, draw)).collect::<Result<_, _>>()?;
    let layer = |(parcel, psi): (&Parcel, f64)| parcel.layer(height, width, psi);
    let layers = parcels.iter().zip(psis).map(layer).collect();
    let codes = parcels.iter().flat_map(|parcel| parcel.cards(height, width)).collect();
    Ok(Labels { scene: Scene { name: "labels-4".into(), layers }, codes })
}

/// A parcel with its label.
struct Parcel {
    index: usize,
    place: Quarter,
    codes: Vec<Print<Code>>,
    lines: Vec<Print<Line>>,
}

/// Something on a label: its upper left corner, from the parcel's centre.
struct Print<T> {
    top: f64,
    left: f64,
    what: T,
}

/// A line of text, the height of its capitals, and its ink.
struct Line {
    text: Writing,
    height: f64,
    ink: [f32; 3],
}

/// A code with its quiet zone.
struct Code {
    symbology: Symbology,
    text: String,
    modules: Vec<Vec<bool>>,
    module_px: f64,
}

impl Code {
    fn new(symbology: Symbology, module_px: f64, draw: &mut Draw) -> Result<Self, rxing::Exceptions> {
        let text = symbology.text(draw);
        let modules = symbology.modules(&text)?;
        Ok(Self { symbology, text, modules, module_px })
    }

    /// Height and width in pixels.
    fn size(&self) -> (f64, f64) {
        let side = |modules: usize| (modules + 2 * self.symbology.quiet_zone()) as f64 * self.module_px;
        // Bars need no white above and below.
        let height = match self.symbology {
            Symbology::Ean13 | Symbology::Code128 => self.modules.len() as f64 * self.module_px,
            Symbology::Qr | Symbology::DataMatrix => side(self.modules.len()),
        };
        (height, side(self.modules[0].len()))
    }

    /// Returns whether a point is dark, from the upper left corner.
    fn is_ink(&self, y: f64, x: f64) -> bool {
        let (height, width) = self.size();
        let module = |at: f64, side: f64, modules: usize| {
            let index = at / self.module_px - (side / self.module_px - modules as f64) / 2.0;
            (index >= 0.0).then_some(index as usize)
        };
        let row = module(y, height, self.modules.len()).and_then(|row| self.modules.get(row));
        let column = module(x, width, self.modules[0].len());
        row.zip(column).and_then(|(row, column)| row.get(column)).is_some_and(|dark| *dark)
    }
}

impl Parcel {
    fn new(index: usize, height: usize, width: usize, draw: &mut Draw) -> Result<Self, rxing::Exceptions> {
        let place = Quarter::new(index, (height, width), (0.222, 0.232), TURNS[index]);
        let mut parcel = Self { index, place, codes: vec![], lines: vec![] };
        parcel.print(draw)?;
        Ok(parcel)
    }

    /// Lays out the label: QR codes from coarse to fine, bars, and lines of text; what has no room is left out.
    fn print(&mut self, draw: &mut Draw) -> Result<(), rxing::Exceptions> {
        let (bottom, right) = (self.place.half.0 - 2.0 * MARGIN, self.place.half.1 - 2.0 * MARGIN);
        let (mut top, start) = (-bottom, -right);
        let (mut left, mut next) = (start, top);
        let codes = QR_PX
            .map(|px| (Symbology::Qr, px))
            .into_iter()
            .chain([Symbology::Ean13, Symbology::Code128].map(|bars| (bars, BAR_PX)));
        for (symbology, px) in codes {
            let code = Code::new(symbology, px, draw)?;
            let (height, width) = code.size();
            if symbology != Symbology::Qr {
                (left, top) = (start, next);
            }
            if left + width <= right && top + height <= bottom {
                self.codes.push(Print { top, left, what: code });
                (left, next) = (left + width, next.max(top + height + GAP));
            }
        }
        top = next;
        let place = ["SHELF", "RACK", "AISLE", "DOCK"][self.index];
        let number = draw.whole(1000, 9999);
        let texts = [
            format!("{place} {number} / {}", self.index + 1),
            format!("NET 12.5 KG   LOT {}-{}", draw.whole(100, 999), draw.whole(10, 99)),
            "HANDLE WITH CARE".to_owned(),
            format!("KEEP DRY, THIS SIDE UP. EDOF PARCEL {} OF 4", self.index + 1),
        ];
        for (text, (height, ink)) in texts.iter().zip(LINES) {
            let text = Writing::new(text);
            if top + height <= bottom && start + text.width(height) <= right {
                self.lines.push(Print { top, left: start, what: Line { text, height, ink } });
                top += height + GAP + 1.0;
            }
        }
        Ok(())
    }

    /// Light of the parcel at a point; none beside it.
    fn light(&self, (y, x): (f64, f64)) -> Option<[f32; 3]> {
        let is_within =
            |margin: f64| y.abs() <= self.place.half.0 - margin && x.abs() <= self.place.half.1 - margin;
        let is_dark = |code: &Print<Code>| code.what.is_ink(y - code.top, x - code.left);
        let is_written = |line: &&Print<Line>| {
            let (Line { text, height, .. }, down) = (&line.what, y - line.top);
            (0.0..*height).contains(&down) && text.is_ink(*height, x - line.left, down)
        };
        let print = || {
            let code = self.codes.iter().any(is_dark).then_some(INK);
            code.or_else(|| self.lines.iter().find(is_written).map(|line| line.what.ink))
        };
        match (is_within(0.0), is_within(MARGIN)) {
            (false, _) => None,
            (true, false) => Some(PARCELS[self.index]),
            (true, true) => Some(print().unwrap_or(PAPER)),
        }
    }

    /// Everything at this parcel's depth; behind the first one is a wall with two shelves.
    fn layer(&self, height: usize, width: usize, psi: f64) -> Layer {
        let is_first = self.index == 0;
        let behind = |y: f64| {
            let shelf = 0.5 * height as f64;
            is_first.then_some(if (y % shelf) / shelf > 0.965 { SHELF } else { WALL })
        };
        let mut light = ColourFrame::zeros(height, width);
        let mut matte = Array2::zeros((height, width));
        let at = |pixel: usize, i: usize| pixel as f64 + (i as f64 + 0.5) / FINE as f64;
        let pixel = |row: usize, column: usize| {
            let (mut sum, mut covered) = ([0.0; 3], 0);
            if !is_first && self.place.is_far_from(row, column) {
                return (sum, covered);
            }
            for i in 0..FINE * FINE {
                let (y, x) = (at(row, i / FINE), at(column, i % FINE));
                let Some(colour) = self.light(self.place.local(y, x)).or_else(|| behind(y)) else { continue };
                (0..3).for_each(|plane| sum[plane] += colour[plane]);
                covered += 1;
            }
            (sum, covered)
        };
        let rows: Vec<Vec<_>> = (0..height)
            .into_par_iter()
            .map(|row| (0..width).map(|column| pixel(row, column)).collect())
            .collect();
        let samples = (FINE * FINE) as f32;
        for (row, pixels) in rows.iter().enumerate() {
            for (column, (sum, covered)) in pixels.iter().enumerate() {
                matte[(row, column)] = *covered as f32 / samples;
                let mut own = light.planes.index_axis_mut(Axis(1), row);
                (0..3).for_each(|plane| own[(plane, column)] = sum[plane] / samples);
            }
        }
        Layer { light, matte: (!is_first).then_some(matte), psi }
    }

    /// Codes of the label, each with the pixels of the frame that hold it.
    fn cards(&self, height: usize, width: usize) -> impl Iterator<Item = (Symbology, Card)> {
        self.codes.iter().map(move |Print { top, left, what }| {
            let (down, along) = what.size();
            let corners = [(0.0, 0.0), (0.0, along), (down, 0.0), (down, along)];
            let corners = corners.map(|(y, x)| self.place.global(top + y, left + x));
            let range = |of: fn((f64, f64)) -> f64, most: usize| {
                let (low, high) = corners.iter().fold((f64::MAX, f64::MIN), |(low, high), corner| {
                    (low.min(of(*corner)), high.max(of(*corner)))
                });
                let [low, high] = [low.floor(), high.ceil()].map(|v| (v.max(0.0) as usize).min(most));
                (low, high - low)
            };
            let ((row, rows), (column, columns)) =
                (range(|corner| corner.0, height), range(|corner| corner.1, width));
            let card = Card { text: what.text.clone(), at: (row, column), size: (rows, columns) };
            (what.symbology, card)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codes::{Reader, codes_of_luma};
    use edof_optics::draw::four_depths;

    fn labels() -> Labels {
        draw(480, 720, four_depths([0.0, 8.0]), 1).unwrap()
    }

    #[test]
    fn codes_of_the_sharp_scene_are_read_by_a_program_that_is_not_ours() {
        let labels = labels();
        assert_eq!(labels.codes.len(), 4 * 5);
        let luma = codes_of_luma(&labels.scene.sharp());
        let read = |(symbology, card): &(Symbology, Card)| {
            Reader::Rxing.count(&luma, *symbology, std::slice::from_ref(card)).unwrap()
        };
        // One and a half pixels a module, without blur, are at the limit.
        assert!(labels.codes.iter().map(read).sum::<usize>() >= 18);
    }

    #[test]
    fn each_depth_shows_its_own_parcel() {
        let labels = labels();
        labels.scene.check().unwrap();
        let depths = labels.scene.psi_map();
        for layer in &labels.scene.layers {
            let share =
                depths.iter().filter(|&&psi| psi == layer.psi as f32).count() as f64 / depths.len() as f64;
            assert!(share > 0.2, "psi {} shows on {share} of the frame", layer.psi);
        }
        assert!(labels.scene.sharp().planes.iter().all(|v| (0.0..1.0).contains(v)));
    }

    #[test]
    fn a_small_frame_has_the_codes_that_fit_and_another_seed_other_codes() {
        let texts = |height, width, seed| -> Vec<String> {
            let labels = draw(height, width, four_depths([0.0, 8.0]), seed).unwrap();
            labels.codes.into_iter().map(|(_, card)| card.text).collect()
        };
        assert!(texts(64, 64, 1).is_empty());
        assert_eq!(texts(240, 360, 1), texts(240, 360, 1));
        assert_ne!(texts(240, 360, 1), texts(240, 360, 2));
        assert!(matches!(draw(65, 64, [0.0; 4], 1), Err(LabelsError::Draw(DrawError::Size { .. }))));
    }
}
