//! Synthetic pictures of hard cases.

use crate::stability::case::{Defects, Scene};
use edof_core::frame::FrameError;
use edof_core::{CfaPhase, ColourFrame, RawFrame};
use edof_optics::draw::{Builtin, DrawError, draw};
use edof_optics::{Layer, Scene as Layers};
use ndarray::Array2;

/// Seed of synthetic scenes.
const SEED: u64 = 1;
/// Pixels between broken ones.
const APART: usize = 17;

/// The picture of a scene that has one depth.
///
/// # Errors
/// [`DrawError`] for a built-in scene that is too small.
pub fn picture(scene: &Scene, height: usize, width: usize) -> Result<ColourFrame, DrawError> {
    let grey = |light: &dyn Fn(usize, usize) -> f32| {
        let mut frame = ColourFrame::zeros(height, width);
        frame.planes.indexed_iter_mut().for_each(|((_, r, c), v)| *v = light(r, c));
        frame
    };
    Ok(match scene {
        Scene::Flat(rgb) => {
            let mut frame = ColourFrame::zeros(height, width);
            frame.planes.indexed_iter_mut().for_each(|((plane, ..), v)| *v = rgb[plane]);
            frame
        }
        Scene::Checkerboard(side) => grey(&|r, c| ((r / side + c / side) % 2) as f32),
        Scene::Stripes { period, degrees } => {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            grey(&|r, c| {
                let along = c as f64 * cosine + r as f64 * sine;
                (0.5 + 0.5 * (std::f64::consts::TAU * along / period).cos()) as f32
            })
        }
        Scene::Sites(colour) => {
            grey(&|r, c| f32::from(u8::from(CfaPhase::Rggb.channel(r, c).plane() == *colour)))
        }
        Scene::Discs(light) => {
            let spot = |r: usize, c: usize| (r % 40).abs_diff(20).pow(2) + (c % 40).abs_diff(20).pow(2);
            grey(&|r, c| if spot(r, c) < 90 { *light } else { 0.0 })
        }
        Scene::Points(light) => grey(&|r, c| if (r * 31 + c) % 97 == 0 { *light } else { 0.0 }),
        Scene::Step(light) => grey(&|r, c| if 8 * c > 4 * width + r { *light } else { 0.0 }),
        Scene::Leaves | Scene::DepthEdge { .. } => {
            draw(Builtin::Leaves, height, width, &[0.0], SEED)?.sharp()
        }
        Scene::Chart => draw(Builtin::Chart, height, width, &[0.0], SEED)?.sharp(),
    })
}

/// A scene with its depths.
///
/// # Errors
/// As [`picture`].
pub fn layers(scene: &Scene, psi: f64, height: usize, width: usize) -> Result<Layers, DrawError> {
    let back = picture(scene, height, width)?;
    let Scene::DepthEdge { front } = scene else { return Ok(Layers::flat("case", back, psi)) };
    // Three pixels off the grid of patches, and not upright.
    let matte =
        Array2::from_shape_fn((height, width), |(r, c)| f32::from(u8::from(8 * c > 4 * width + 24 + r)));
    let mut light = draw(Builtin::Leaves, height, width, &[0.0], SEED + 1)?.sharp();
    light.planes.outer_iter_mut().for_each(|mut plane| plane *= &matte);
    let front = Layer { light, matte: Some(matte), psi: *front };
    let mut all = Layers::flat("case", back, psi);
    all.layers.push(front);
    Ok(all)
}

/// The frame of a sensor whose pixels are not all well.
///
/// # Errors
/// None that a frame would give that was one before.
pub fn broken(raw: &RawFrame, defects: Defects) -> Result<RawFrame, FrameError> {
    let mut values = raw.values();
    let (height, width) = raw.size();
    let max = ((1u32 << raw.depth()) - 1) as u16;
    let (count, value) = match defects {
        Defects::Hot(count) => (count, max),
        Defects::Dead(count) => (count, 0),
        Defects::DeadColumn => {
            values.column_mut(width / 2).fill(0);
            (0, 0)
        }
    };
    // On a grid that meets every site of the mosaic by turns.
    for i in 0..count {
        let place = i * APART;
        values[((place / width * APART + 5) % height, (place + 3) % width)] = value;
    }
    RawFrame::from_values(values, raw.depth(), raw.phase())
}
