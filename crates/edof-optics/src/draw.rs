//! Built-in scenes, rendered by code, so that the program needs no files.
//!
//! | scene | module | shows |
//! |---|---|---|
//! | `chart` | [`chart`] | Siemens stars, slanted edges, bars and text on four cards |
//! | `leaves` | [`leaves`] | dead leaves: occluding disks of all sizes, statistics like a photograph's |
//!
//! Each can lie at one depth or at four (the paper's 2.5D experiment).

pub mod chart;
pub mod leaves;
pub mod quarter;

use crate::scene::Scene;
use edof_core::ColourFrame;

/// A scene rendered by code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Builtin {
    /// [`chart`].
    Chart,
    /// [`leaves`].
    Leaves,
}

/// A scene that cannot be rendered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum DrawError {
    /// Not a scene of ours.
    #[error("scene '{0}': must be chart, chart-4, leaves or leaves-4")]
    Unknown(String),
    /// Too small to hold its parts, or odd.
    #[error("scene {width}x{height}: both sides must be even and at least {MIN_SIDE} pixels")]
    Size { height: usize, width: usize },
    /// Neither one depth nor four.
    #[error("scene with {0} depths: must be one or four values of psi")]
    Depths(usize),
}

/// The smallest side of a built-in scene in pixels.
pub const MIN_SIDE: usize = 64;

impl std::str::FromStr for Builtin {
    type Err = DrawError;

    fn from_str(word: &str) -> Result<Self, DrawError> {
        match word {
            "chart" => Ok(Self::Chart),
            "leaves" => Ok(Self::Leaves),
            _ => Err(DrawError::Unknown(word.to_owned())),
        }
    }
}

/// A scene's name: its content, and its number of depths (`chart` at one, `chart-4` at four).
///
/// # Errors
/// [`DrawError::Unknown`].
pub fn parse_name(name: &str) -> Result<(Builtin, usize), DrawError> {
    let (kind, depths) = name.strip_suffix("-4").map_or((name, 1), |kind| (kind, 4));
    kind.parse().map(|kind| (kind, depths)).map_err(|_| DrawError::Unknown(name.to_owned()))
}

/// Draws a built-in scene of `height`×`width` pixels at one depth, or at four from back to front. Same seed, same scene; the chart
/// takes no chances and ignores it.
///
/// ```
/// use edof_optics::draw::{Builtin, draw, four_depths};
/// let scene = draw(Builtin::Leaves, 64, 96, &four_depths([0.0, 8.0]), 1)?;
/// assert_eq!((scene.layers.len(), scene.layers[3].psi), (4, 8.0));
/// # Ok::<(), edof_optics::draw::DrawError>(())
/// ```
///
/// # Errors
/// [`DrawError::Size`] or [`DrawError::Depths`].
pub fn draw(kind: Builtin, height: usize, width: usize, psis: &[f64], seed: u64) -> Result<Scene, DrawError> {
    if height.min(width) < MIN_SIDE || !height.is_multiple_of(2) || !width.is_multiple_of(2) {
        return Err(DrawError::Size { height, width });
    }
    let (name, layers) = match kind {
        Builtin::Chart => ("chart", chart::layers(height, width)),
        Builtin::Leaves => ("leaves", leaves::layers(height, width, seed)),
    };
    let scene = |psis: [f64; 4]| {
        let mut layers = layers;
        layers.iter_mut().zip(psis).for_each(|(layer, psi)| layer.psi = psi);
        Scene { name: format!("{name}-4"), layers: layers.into() }
    };
    match *psis {
        [psi] => Ok(Scene::flat(name, scene([0.0; 4]).sharp(), psi)),
        [a, b, c, d] => Ok(scene([a, b, c, d])),
        _ => Err(DrawError::Depths(psis.len())),
    }
}

/// Four depths spread evenly over a range, its ends among them.
#[must_use]
pub fn four_depths([low, high]: [f64; 2]) -> [f64; 4] {
    [0.0, 1.0, 2.0, 3.0].map(|i| low + (high - low) * i / 3.0)
}

/// A dark and a light half with a straight edge between them, `degrees` off the vertical through the centre; for measuring an MTF.
#[must_use]
pub fn slanted_edge(height: usize, width: usize, degrees: f64, dark: f32, light: f32) -> ColourFrame {
    let slope = degrees.to_radians().tan();
    let (middle_row, middle_column) = (0.5 * height as f64, 0.5 * width as f64);
    let mut frame = ColourFrame::zeros(height, width);
    for row in 0..height {
        for column in 0..width {
            let covered = coverage(row, column, |y, x| x - middle_column > slope * (y - middle_row));
            let value = dark + (light - dark) * covered;
            (0..3).for_each(|plane| frame.planes[(plane, row, column)] = value);
        }
    }
    frame
}

/// Samples along each side of a pixel.
const FINE: usize = 8;

/// Share of the pixel at `row`, `column` for which `inside(y, x)` holds; its centre is at (row + ½, column + ½).
fn coverage(row: usize, column: usize, inside: impl Fn(f64, f64) -> bool) -> f32 {
    let at = |pixel: usize, i: usize| pixel as f64 + (i as f64 + 0.5) / FINE as f64;
    let hits = (0..FINE * FINE).filter(|i| inside(at(row, i / FINE), at(column, i % FINE))).count();
    hits as f32 / (FINE * FINE) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_at_one_depth_look_like_those_at_four() {
        for kind in [Builtin::Chart, Builtin::Leaves] {
            let four = draw(kind, 96, 128, &four_depths([0.0, 8.0]), 3).unwrap();
            four.check().unwrap();
            assert_eq!(draw(kind, 96, 128, &[5.0], 3).unwrap().sharp(), four.sharp());
            let depths = four.psi_map();
            for layer in &four.layers {
                let share = depths.iter().filter(|&&psi| psi == layer.psi as f32).count() as f64
                    / depths.len() as f64;
                assert!(share > 0.08, "{kind:?}: psi {} shows on {share} of the frame", layer.psi);
            }
        }
    }

    #[test]
    fn scenes_stay_within_the_light_a_sensor_takes_and_mattes_within_one() {
        for kind in [Builtin::Chart, Builtin::Leaves] {
            let scene = draw(kind, 128, 192, &four_depths([0.0, 8.0]), 0).unwrap();
            assert!(scene.sharp().planes.iter().all(|v| (0.0..1.0).contains(v)));
            for layer in &scene.layers {
                assert!(layer.matte.iter().flatten().all(|m| (0.0..=1.0).contains(m)));
            }
        }
    }

    #[test]
    fn the_same_seed_draws_the_same_leaves() {
        let drawn = |seed| draw(Builtin::Leaves, 64, 64, &[0.0], seed).unwrap();
        assert_eq!(drawn(1), drawn(1));
        assert_ne!(drawn(1), drawn(2));
    }

    #[test]
    fn impossible_scenes_are_rejected() {
        assert_eq!(
            "sea".parse::<Builtin>().unwrap_err().to_string(),
            "scene 'sea': must be chart, chart-4, leaves or leaves-4"
        );
        assert_eq!(parse_name("leaves-4"), Ok((Builtin::Leaves, 4)));
        let refused = |h, w, psis: &[f64]| draw(Builtin::Chart, h, w, psis, 0).unwrap_err().to_string();
        assert_eq!(refused(65, 80, &[0.0]), "scene 80x65: both sides must be even and at least 64 pixels");
        assert_eq!(refused(64, 64, &[0.0, 1.0]), "scene with 2 depths: must be one or four values of psi");
    }

    #[test]
    fn the_edge_of_a_slanted_edge_is_where_it_should_be() {
        let edge = slanted_edge(64, 64, 5.0, 0.1, 0.9);
        let light: f32 = edge.planes.sum() / edge.planes.len() as f32;
        assert!((light - 0.5).abs() < 1e-3);
        let crossing = |row: usize| (0..64).find(|&c| edge.planes[(0, row, c)] > 0.5);
        assert_eq!((crossing(4), crossing(60)), (Some(30), Some(35)));
    }
}
