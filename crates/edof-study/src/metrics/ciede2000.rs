//! Differences of colour as people see them: CIEDE2000, after Sharma, Wu and Dalal, "The CIEDE2000 color-difference formula:
//! implementation notes, supplementary test data, and mathematical observations", Color Research and Application 30, 2005.

use crate::metrics::comparable::Pair;
use crate::metrics::metric::{Better, Metric, Place, Score};
use edof_core::ColourFrame;
use rayon::prelude::*;

/// CIEDE2000, mean over the pixels; 1 is about the smallest difference that is seen.
pub(super) const ALL: Metric = Metric {
    name: "ciede2000",
    title: "CIEDE2000",
    unit: "",
    better: Better::Lower,
    min_side: 1,
    decimals: 2,
    place: Place::Further,
    measure: |pair| Score::One(mean(pair)),
};

/// CIE XYZ under D65 from linear sRGB (IEC 61966-2-1); light of 1 in all colours is white.
const XYZ: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// Sums of rows, added in the rows' order.
fn mean(pair: &Pair) -> f64 {
    let [truth, estimate] = [&pair.truth, &pair.estimate].map(|frame| pair.tone.decoded(frame));
    let (height, width) = truth.size();
    let row = |row: usize| {
        let of = |column: usize| difference(lab(&truth, row, column), lab(&estimate, row, column));
        (0..width).map(of).sum::<f64>()
    };
    let rows: Vec<f64> = (0..height).into_par_iter().map(row).collect();
    rows.iter().sum::<f64>() / (height * width) as f64
}

/// CIE L*a*b* of a pixel of linear light.
fn lab(light: &ColourFrame, row: usize, column: usize) -> [f64; 3] {
    let rgb = [0, 1, 2].map(|colour| f64::from(light.planes[(colour, row, column)]));
    let [x, y, z] = XYZ.map(|weights| {
        let of =
            |light: [f64; 3]| weights.iter().zip(light).map(|(weight, light)| weight * light).sum::<f64>();
        let share = of(rgb) / of([1.0; 3]);
        if share > (6.0f64 / 29.0).powi(3) {
            share.cbrt()
        } else {
            share * (29.0f64 / 6.0).powi(2) / 3.0 + 4.0 / 29.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Difference of two colours in L*a*b*, all parametric factors 1. Numbers in brackets are the paper's equations.
fn difference(first: [f64; 3], second: [f64; 3]) -> f64 {
    let share = |chroma: f64| (chroma.powi(7) / (chroma.powi(7) + 25f64.powi(7))).sqrt();
    // (2) to (7): chroma and hue; a is stretched near grey.
    let stretch = 1.0 + 0.5 * (1.0 - share(0.5 * (first[1].hypot(first[2]) + second[1].hypot(second[2]))));
    let [(c1, h1), (c2, h2)] = [first, second].map(|[_, a, b]| {
        let a = stretch * a;
        (a.hypot(b), b.atan2(a).to_degrees().rem_euclid(360.0))
    });
    // (8) to (14): differences and means; a grey has no hue, and hues that are opposite have their plain mean.
    let is_grey = c1 * c2 == 0.0;
    let is_across = (h2 - h1).abs() > 180.0 + 1e-9;
    let turn = if !is_across {
        0.0
    } else if h2 > h1 {
        -360.0
    } else {
        360.0
    };
    let hue_step = if is_grey { 0.0 } else { h2 - h1 + turn };
    let hue = match (is_grey, is_across) {
        (true, _) => h1 + h2,
        (false, false) => 0.5 * (h1 + h2),
        (false, true) => 0.5 * (h1 + h2 + if h1 + h2 < 360.0 { 360.0 } else { -360.0 }),
    };
    let (lightness, chroma) = (0.5 * (first[0] + second[0]), 0.5 * (c1 + c2));
    // (15) to (21): weights.
    let cosine = |degrees: f64| degrees.to_radians().cos();
    let t = 1.0 - 0.17 * cosine(hue - 30.0) + 0.24 * cosine(2.0 * hue) + 0.32 * cosine(3.0 * hue + 6.0)
        - 0.20 * cosine(4.0 * hue - 63.0);
    let squared = (lightness - 50.0).powi(2);
    let l = (second[0] - first[0]) / (1.0 + 0.015 * squared / (20.0 + squared).sqrt());
    let c = (c2 - c1) / (1.0 + 0.045 * chroma);
    let h = 2.0 * (c1 * c2).sqrt() * (0.5 * hue_step).to_radians().sin() / (1.0 + 0.015 * chroma * t);
    let rotation = -2.0 * share(chroma) * (60.0 * (-((hue - 275.0) / 25.0).powi(2)).exp()).to_radians().sin();
    (l * l + c * c + h * h + rotation * c * h).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Tone;

    /// The paper's table 1: two colours in L*a*b*, and their difference to four decimals.
    const PUBLISHED: [[f64; 7]; 34] = [
        [50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485, 2.0425],
        [50.0, 3.1571, -77.2803, 50.0, 0.0, -82.7485, 2.8615],
        [50.0, 2.8361, -74.02, 50.0, 0.0, -82.7485, 3.4412],
        [50.0, -1.3802, -84.2814, 50.0, 0.0, -82.7485, 1.0],
        [50.0, -1.1848, -84.8006, 50.0, 0.0, -82.7485, 1.0],
        [50.0, -0.9009, -85.5211, 50.0, 0.0, -82.7485, 1.0],
        [50.0, 0.0, 0.0, 50.0, -1.0, 2.0, 2.3669],
        [50.0, -1.0, 2.0, 50.0, 0.0, 0.0, 2.3669],
        [50.0, 2.49, -0.001, 50.0, -2.49, 0.0009, 7.1792],
        [50.0, 2.49, -0.001, 50.0, -2.49, 0.001, 7.1792],
        [50.0, 2.49, -0.001, 50.0, -2.49, 0.0011, 7.2195],
        [50.0, 2.49, -0.001, 50.0, -2.49, 0.0012, 7.2195],
        [50.0, -0.001, 2.49, 50.0, 0.0009, -2.49, 4.8045],
        [50.0, -0.001, 2.49, 50.0, 0.001, -2.49, 4.8045],
        [50.0, -0.001, 2.49, 50.0, 0.0011, -2.49, 4.7461],
        [50.0, 2.5, 0.0, 50.0, 0.0, -2.5, 4.3065],
        [50.0, 2.5, 0.0, 73.0, 25.0, -18.0, 27.1492],
        [50.0, 2.5, 0.0, 61.0, -5.0, 29.0, 22.8977],
        [50.0, 2.5, 0.0, 56.0, -27.0, -3.0, 31.903],
        [50.0, 2.5, 0.0, 58.0, 24.0, 15.0, 19.4535],
        [50.0, 2.5, 0.0, 50.0, 3.1736, 0.5854, 1.0],
        [50.0, 2.5, 0.0, 50.0, 3.2972, 0.0, 1.0],
        [50.0, 2.5, 0.0, 50.0, 1.8634, 0.5757, 1.0],
        [50.0, 2.5, 0.0, 50.0, 3.2592, 0.335, 1.0],
        [60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644],
        [63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.263],
        [61.2901, 3.7196, -5.3901, 61.4292, 2.248, -4.962, 1.8731],
        [35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645],
        [22.7233, 20.0904, -46.694, 23.0331, 14.973, -42.5619, 2.0373],
        [36.4612, 47.858, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146],
        [90.8027, -2.0831, 1.441, 91.1528, -1.6435, 0.0447, 1.4441],
        [90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381],
        [6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377],
        [2.0776, 0.0795, -1.135, 0.9033, -0.0636, -0.5514, 0.9082],
    ];

    #[test]
    fn differences_are_those_of_the_published_pairs_in_either_order() {
        for [l1, a1, b1, l2, a2, b2, expected] in PUBLISHED {
            let (first, second) = ([l1, a1, b1], [l2, a2, b2]);
            for found in [difference(first, second), difference(second, first)] {
                assert!((found - expected).abs() < 5.001e-5, "{first:?} {second:?}: {found}, not {expected}");
            }
        }
    }

    fn measured(truth: [f32; 3], estimate: [f32; 3], tone: Tone) -> f64 {
        let frame = |colour: [f32; 3]| {
            let mut frame = ColourFrame::zeros(2, 2);
            frame.planes.indexed_iter_mut().for_each(|((plane, _, _), value)| *value = colour[plane]);
            frame
        };
        mean(&Pair { truth: frame(truth), estimate: frame(estimate), tone })
    }

    #[test]
    fn black_and_white_are_a_hundred_apart_and_equal_colours_nothing() {
        for tone in Tone::ALL {
            assert!((measured([0.0; 3], [1.0; 3], tone) - 100.0).abs() < 1e-6);
            assert_eq!(measured([0.2, 0.4, 0.6], [0.2, 0.4, 0.6], tone), 0.0);
        }
    }

    #[test]
    fn encoded_values_are_decoded_and_light_is_not() {
        let (truth, estimate) = ([0.2, 0.4, 0.6], [0.3, 0.4, 0.5]);
        let decoded = |colour: [f32; 3]| colour.map(|value| Tone::Srgb.decode(value));
        let of_light = measured(decoded(truth), decoded(estimate), Tone::Linear);
        assert!((measured(truth, estimate, Tone::Srgb) - of_light).abs() < 1e-9);
        assert!((measured(truth, estimate, Tone::Linear) - of_light).abs() > 0.1);
    }

    #[test]
    fn values_beyond_black_and_white_have_a_difference_too() {
        assert!(measured([-0.1, 0.0, 1.2], [0.0; 3], Tone::Srgb).is_finite());
    }
}
