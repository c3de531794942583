//! Windows that know where their light came from, and a gradient for them carried back to the PSFs: the adjoint of mosaic and blur.

use super::{Batch, Dataset, Place, RGGB, Turn};
use crate::noise::expose;
use edof_core::Noise;
use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::{PATCH, mirror};
use edof_numerics::random::Random;

/// Where a window of [`Dataset::draw_located`] was cut: row and column of its first pixel.
pub type Corner = (usize, usize);

impl Dataset {
    /// Fills a batch with random training windows of one photograph, as it is and not turned, at one ψ, with one noise: light, whatever the tone.
    /// Returns their places.
    pub fn draw_located(
        &self,
        random: &mut Random,
        place: Place,
        noise: Noise,
        batch: &mut Batch,
    ) -> Vec<Corner> {
        let picture = self.picture(place, 0);
        let (side, pixels, unit) = (self.window().side(), self.window().pixels(), 1.0 / f32::from(u16::MAX));
        let turn = Turn::new(0, picture.width, side);
        let draw = |index: usize| {
            let (row, column) = picture.holdout.training(random, side);
            let base = (row * picture.width + column) * 3;
            let input = &mut batch.inputs[index * pixels..][..pixels];
            turn.read(&picture.blurred[place.psi][base..], 0, RGGB, unit, side, input);
            expose(noise, random, input);
            let target = &mut batch.targets[index * RGB_OUTPUTS..][..RGB_OUTPUTS];
            for (plane, values) in target.chunks_exact_mut(PATCH * PATCH).enumerate() {
                turn.read(
                    &picture.sharp[base..],
                    self.window().margin(),
                    [[plane; 2]; 2],
                    unit,
                    PATCH,
                    values,
                );
            }
            target.iter_mut().for_each(|v| *v = v.min(1.0));
            (row, column)
        };
        (0..batch.cells.len()).map(draw).collect()
    }

    /// Adds to `into` (three kernels of these odd sides) the gradient for the PSFs that `gradient`, one for the raw window at `corner`, comes to.
    pub fn psf_gradient(
        &self,
        place: Place,
        corner: Corner,
        gradient: &[f32],
        sides: [usize; 3],
        into: &mut [Vec<f32>; 3],
    ) {
        let picture = self.picture(place, 0);
        let (window, unit) = (self.window().side(), 1.0 / f32::from(u16::MAX));
        let height = picture.sharp.len() / (3 * picture.width);
        for (channel, (&side, sums)) in sides.iter().zip(into).enumerate() {
            let reach = (side / 2) as isize;
            let span = window + side - 1;
            let around = |start: usize, index: usize, length: usize| {
                mirror(start as isize + index as isize - reach, length)
            };
            let mut light = Vec::with_capacity(span * span);
            for r in 0..span {
                let row = around(corner.0, r, height) * picture.width;
                light.extend((0..span).map(|c| {
                    let word = picture.sharp[(row + around(corner.1, c, picture.width)) * 3 + channel];
                    f32::from(word) * unit
                }));
            }
            for (index, &value) in gradient.iter().enumerate() {
                let (r, c) = (index / window, index % window);
                if RGGB[r % 2][c % 2] != channel || value == 0.0 {
                    continue;
                }
                // Pixel r takes kernel[i] of the light at r + reach − i: the kernel's rows and columns run backward.
                for (i, line) in sums.chunks_exact_mut(side).rev().enumerate() {
                    let from = &light[(r + i) * span + c..][..side];
                    line.iter_mut().rev().zip(from).for_each(|(sum, l)| *sum += value * l);
                }
            }
        }
    }
}
