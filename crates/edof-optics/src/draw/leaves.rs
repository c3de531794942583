//! Dead leaves: disks that hide one another, radii distributed as r⁻³, so that the picture looks the same at every scale and has the
//! edges, the 1/f spectrum and the correlated colours of a photograph (Ruderman 1997; Lee, Mumford, Huang 2001).

use crate::scene::Layer;
use edof_core::ColourFrame;
use ndarray::Array2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const MIN_RADIUS: f64 = 2.5;
/// How many times the leaves of the background would cover it, laid side by side.
const COVERS: f64 = 8.0;
/// Share of the frame that the objects of each nearer depth would cover, laid side by side.
const OBJECTS: f64 = 0.35;

struct Leaf {
    row: f64,
    column: f64,
    radius: f64,
    colour: [f64; 3],
    /// Change of brightness across the leaf, down and to the right.
    shade: [f64; 2],
}

/// Four layers from back to front, all at ψ = 0: a background of leaves, and three times objects in front of it, themselves
/// covered with leaves.
#[must_use]
pub fn layers(height: usize, width: usize, seed: u64) -> [Layer; 4] {
    let mut generator = Pcg64::seed_from_u64(seed);
    [0, 1, 2, 3].map(|depth| {
        if depth == 0 {
            background(height, width, &mut generator)
        } else {
            objects(height, width, &mut generator)
        }
    })
}

fn background(height: usize, width: usize, generator: &mut Pcg64) -> Layer {
    let mut light = ColourFrame::zeros(height, width);
    light.planes.fill(0.2);
    let everywhere = Array2::ones((height, width));
    let max = 0.35 * height.min(width) as f64;
    scatter(generator, (height, width), [MIN_RADIUS, max], COVERS, |leaf| {
        paint(&mut light, &everywhere, leaf)
    });
    Layer { light, matte: None, psi: 0.0 }
}

fn objects(height: usize, width: usize, generator: &mut Pcg64) -> Layer {
    let mut light = ColourFrame::zeros(height, width);
    let mut matte = Array2::zeros((height, width));
    let side = height.min(width) as f64;
    scatter(generator, (height, width), [side / 10.0, side / 4.0], OBJECTS, |leaf| {
        for_covered(leaf, (height, width), |row, column, covered| {
            let m: &mut f32 = &mut matte[(row, column)];
            *m += covered * (1.0 - *m);
        });
        paint(&mut light, &Array2::ones((height, width)), leaf);
    });
    // Light outside the objects' union is none, and the leaves upon them stay within it.
    scatter(generator, (height, width), [MIN_RADIUS, side / 12.0], 0.5 * COVERS, |leaf| {
        paint(&mut light, &matte, leaf)
    });
    Layer { light, matte: Some(matte), psi: 0.0 }
}

/// Draws leaves until their areas add up to `covers` frames.
fn scatter(
    generator: &mut Pcg64,
    (height, width): (usize, usize),
    [min, max]: [f64; 2],
    covers: f64,
    mut draw: impl FnMut(&Leaf),
) {
    let mut left = covers * (height * width) as f64;
    while left > 0.0 {
        let mut uniform = || generator.random::<f64>();
        // Inverse of the cumulative distribution of r⁻³ between the two radii.
        let (a, b) = (min.powi(-2), max.powi(-2));
        let radius = (a - uniform() * (a - b)).powf(-0.5);
        let brightness = 0.03 * (0.8f64 / 0.03).powf(uniform());
        let (warm, green) = (uniform() - 0.5, uniform() - 0.5);
        let tint = [1.0 + 0.5 * warm, 1.0 + 0.25 * green, 1.0 - 0.6 * warm];
        let leaf = Leaf {
            row: uniform() * height as f64,
            column: uniform() * width as f64,
            radius,
            colour: tint.map(|t| brightness * t),
            shade: [0.4 * (uniform() - 0.5), 0.4 * (uniform() - 0.5)],
        };
        draw(&leaf);
        left -= std::f64::consts::PI * radius * radius;
    }
}

/// Lays a leaf over `light` (multiplied by its matte) wherever `within` is more than zero.
fn paint(light: &mut ColourFrame, within: &Array2<f32>, leaf: &Leaf) {
    for_covered(leaf, light.size(), |row, column, covered| {
        let m = within[(row, column)];
        let (dy, dx) = ((row as f64 - leaf.row) / leaf.radius, (column as f64 - leaf.column) / leaf.radius);
        let shade = 1.0 + leaf.shade[0] * dy + leaf.shade[1] * dx;
        for plane in 0..3 {
            let value = &mut light.planes[(plane, row, column)];
            *value += covered * (m * (leaf.colour[plane] * shade).clamp(0.0, 0.98) as f32 - *value);
        }
    });
}

/// Calls `visit(row, column, share)` for each pixel that the leaf covers in part.
fn for_covered(leaf: &Leaf, (height, width): (usize, usize), mut visit: impl FnMut(usize, usize, f32)) {
    let span = |centre: f64, n: usize| {
        let low = (centre - leaf.radius - 1.0).max(0.0) as usize;
        low..((centre + leaf.radius + 2.0).max(0.0) as usize).min(n)
    };
    for row in span(leaf.row, height) {
        for column in span(leaf.column, width) {
            let distance = (row as f64 + 0.5 - leaf.row).hypot(column as f64 + 0.5 - leaf.column);
            let covered = (leaf.radius - distance + 0.5).clamp(0.0, 1.0) as f32;
            if covered > 0.0 {
                visit(row, column, covered);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Axis;

    #[test]
    fn neighbours_are_alike_and_colours_go_together_as_in_photographs() {
        let [background, ..] = layers(256, 256, 5);
        let plane = |p: usize| background.light.planes.index_axis(Axis(0), p).to_owned();
        let correlation = |a: &Array2<f32>, b: &Array2<f32>| {
            let (a, b) = (a - a.mean().unwrap(), b - b.mean().unwrap());
            (&a * &b).sum() / ((&a * &a).sum() * (&b * &b).sum()).sqrt()
        };
        let green = plane(1);
        let shifted = |by: usize| green.slice(ndarray::s![.., by..]).to_owned();
        let kept = |by: usize| green.slice(ndarray::s![.., ..256 - by]).to_owned();
        let at = |by| correlation(&shifted(by), &kept(by));
        assert!(at(1) > 0.85 && at(1) > at(4) && at(4) > at(32), "{} {} {}", at(1), at(4), at(32));
        assert!(correlation(&plane(0), &plane(2)) > 0.7);
    }

    #[test]
    fn objects_send_no_light_from_where_they_are_not() {
        let [_, object, ..] = layers(128, 128, 5);
        let matte = object.matte.unwrap();
        for plane in object.light.planes.axis_iter(Axis(0)) {
            assert!(plane.iter().zip(&matte).all(|(l, m)| l <= m));
        }
    }
}
