//! Which of several networks a window goes to, by few operations on its raw pixels.
//!
//! Each of [`FEATURES`] numbers is a mean of absolute differences within a Bayer window (of one colour's pixels, or of a colour and the greens around it), or the largest
//! of them. A class has a score that is linear in them; its coefficients and its constant depend on the noise, which a host knows by the sensor's gain. The largest score wins, so
//! a choice between two is one threshold.

use edof_core::Noise;
use edof_core::geometry::PATCH;
use serde::{Deserialize, Serialize};

/// Numbers that are measured of a window.
pub const FEATURES: usize = 21;
/// What each of them is.
pub const NAMES: [&str; FEATURES] = [
    "level",
    "g-step2",
    "r-step2",
    "b-step2",
    "g-second2",
    "r-second2",
    "b-second2",
    "step4",
    "g-diagonal",
    "g-diagonal-second",
    "g-laplace",
    "r-cross",
    "b-cross",
    "max-g-laplace",
    "max-g-diagonal",
    "max-g-step2",
    "max-step4",
    "step6",
    "g-range",
    "second4",
    "g-step1-mixed",
];
/// Light at which the noise of a window is stated.
const GREY: f64 = 0.2;

/// A choice between classes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Router {
    /// Side of the windows that features are measured in.
    pub side: usize,
    /// Windows a side whose features are summed: 1, or 3 for those of the eight patches around too.
    pub patches: usize,
    /// Of each class: coefficients of the features, those of noise times the features, and those of 1, noise and its square.
    pub scores: Vec<Vec<f32>>,
}

impl Router {
    /// Side of the square of pixels that a choice is made of.
    #[must_use]
    pub const fn context(&self) -> usize {
        self.side + PATCH * (self.patches - 1)
    }

    /// The class of a square of [`Router::context`] pixels whose first is red.
    #[must_use]
    pub fn class(&self, pixels: &[f32], noise: Noise) -> usize {
        let stride = self.context();
        let mut sums = [0.0; FEATURES];
        for row in 0..self.patches {
            for column in 0..self.patches {
                let own = features(&pixels[PATCH * (row * stride + column)..], stride, self.side);
                sums.iter_mut().zip(own).for_each(|(sum, f)| *sum += f);
            }
        }
        let noise = noise_level(noise);
        let score = |w: &Vec<f32>| {
            let linear: f32 = (0..FEATURES).map(|i| (w[i] + noise * w[FEATURES + i]) * sums[i]).sum();
            linear + w[2 * FEATURES] + noise * (w[2 * FEATURES + 1] + noise * w[2 * FEATURES + 2])
        };
        let scores = self.scores.iter().map(score).enumerate();
        scores.fold((0, f32::NEG_INFINITY), |best, s| if s.1 > best.1 { s } else { best }).0
    }
}

/// Noise as scores take it: 100 σ of grey light.
#[must_use]
pub fn noise_level(noise: Noise) -> f32 {
    100.0 * noise.variance(GREY).sqrt() as f32
}

/// A mean and a maximum that are being taken.
#[derive(Default, Clone, Copy)]
struct Tally {
    sum: f32,
    count: f32,
    max: f32,
}

impl Tally {
    fn add(&mut self, value: f32) {
        let value = value.abs();
        self.sum += value;
        self.count += 1.0;
        self.max = self.max.max(value);
    }

    fn mean(self) -> f32 {
        self.sum / self.count.max(1.0)
    }
}

/// Features of the square of `side` pixels at the beginning of lines `stride` apart; its first is red.
#[must_use]
pub fn features(pixels: &[f32], stride: usize, side: usize) -> [f32; FEATURES] {
    let at = |r: usize, c: usize| pixels[r * stride + c];
    let mut level = Tally::default();
    // By colour: green, red, blue.
    let (mut step2, mut second2) = ([Tally::default(); 3], [Tally::default(); 3]);
    let [mut step4, mut step6, mut second4] = [Tally::default(); 3];
    let [mut diagonal, mut diagonal_second, mut laplace] = [Tally::default(); 3];
    let mut cross = [Tally::default(); 3];
    let mut mixed = Tally::default();
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for r in 0..side {
        for c in 0..side {
            let v = at(r, c);
            level.add(v);
            let colour = match (r % 2, c % 2) {
                (0, 0) => 1,
                (1, 1) => 2,
                _ => 0,
            };
            let (right, down) = (c + 2 < side, r + 2 < side);
            if right {
                step2[colour].add(v - at(r, c + 2));
            }
            if down {
                step2[colour].add(v - at(r + 2, c));
            }
            if right && c >= 2 {
                second2[colour].add(at(r, c - 2) - 2.0 * v + at(r, c + 2));
            }
            if down && r >= 2 {
                second2[colour].add(at(r - 2, c) - 2.0 * v + at(r + 2, c));
            }
            for (reach, tally) in [(4, &mut step4), (6, &mut step6)] {
                if c + reach < side {
                    tally.add(v - at(r, c + reach));
                }
                if r + reach < side {
                    tally.add(v - at(r + reach, c));
                }
            }
            if c >= 4 && c + 4 < side {
                second4.add(at(r, c - 4) - 2.0 * v + at(r, c + 4));
            }
            if r >= 4 && r + 4 < side {
                second4.add(at(r - 4, c) - 2.0 * v + at(r + 4, c));
            }
            let inner = r > 0 && c > 0 && r + 1 < side && c + 1 < side;
            if colour == 0 {
                (low, high) = (low.min(v), high.max(v));
                if r + 1 < side && c + 1 < side {
                    diagonal.add(v - at(r + 1, c + 1));
                }
                if r + 1 < side && c > 0 {
                    diagonal.add(v - at(r + 1, c - 1));
                }
                if inner {
                    let falling = at(r - 1, c - 1) + at(r + 1, c + 1);
                    let rising = at(r - 1, c + 1) + at(r + 1, c - 1);
                    diagonal_second.add(2.0 * v - falling);
                    diagonal_second.add(2.0 * v - rising);
                    laplace.add(4.0 * v - falling - rising);
                }
            } else {
                let difference = |r: usize, c: usize| {
                    4.0 * at(r, c) - at(r - 1, c) - at(r + 1, c) - at(r, c - 1) - at(r, c + 1)
                };
                if inner && c + 3 < side {
                    cross[colour].add(difference(r, c) - difference(r, c + 2));
                }
                if inner && r + 3 < side {
                    cross[colour].add(difference(r, c) - difference(r + 2, c));
                }
                if inner {
                    // The greens around a red or blue pixel: left and right against above and below.
                    mixed.add(at(r - 1, c) + at(r + 1, c) - at(r, c - 1) - at(r, c + 1));
                }
            }
        }
    }
    [
        level.mean(),
        step2[0].mean(),
        step2[1].mean(),
        step2[2].mean(),
        second2[0].mean(),
        second2[1].mean(),
        second2[2].mean(),
        step4.mean(),
        diagonal.mean(),
        diagonal_second.mean(),
        laplace.mean(),
        cross[1].mean(),
        cross[2].mean(),
        laplace.max,
        diagonal.max,
        step2[0].max,
        step4.max,
        step6.mean(),
        high - low,
        second4.mean(),
        mixed.mean(),
    ]
}

/// The windows that one network of several is trained on.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// Those of these depths, by position among the dataset's.
    Depths(Vec<usize>),
    /// Those that a router sends to a class.
    Class(Router, usize),
}

impl Selection {
    /// Pixels a side that the choice needs, for networks of windows of `side`.
    #[must_use]
    pub fn context(&self, side: usize) -> usize {
        match self {
            Self::Depths(_) => side,
            Self::Class(router, _) => router.context(),
        }
    }

    /// Whether a window belongs to it.
    #[must_use]
    pub fn takes(&self, pixels: &[f32], noise: Noise) -> bool {
        match self {
            Self::Depths(_) => true,
            Self::Class(router, class) => router.class(pixels, noise) == *class,
        }
    }

    /// Depths of `psis` at which it has windows.
    #[must_use]
    pub fn depths(&self, psis: usize) -> Vec<usize> {
        match self {
            Self::Depths(depths) => depths.clone(),
            Self::Class(..) => (0..psis).collect(),
        }
    }
}
