//! Synthetic kernels, and how near one kernel comes to another.

use edof_optics::psf::Psf;
use ndarray::{Array2, ArrayView2};

/// A kernel and what it is called.
#[derive(Debug, Clone)]
pub struct Blur {
    /// As in `disc`.
    pub name: &'static str,
    /// Odd sides, sum 1.
    pub psf: Psf,
}

/// Side of the synthetic kernels, and samples along and across a line of them.
pub(super) const SIDE: usize = 13;
const SAMPLES: usize = 400;

/// A lens out of focus (a disc of 5 pixels), a camera that moved straight (10 pixels), and one that moved in a bow (some 12).
#[must_use]
pub fn drawn() -> [Blur; 3] {
    let blur = |name, points: Vec<[f64; 2]>| {
        let psf =
            Psf::new(splatted(&points)).unwrap_or_else(|e| unreachable!("kernels are drawn to sum 1: {e}"));
        Blur { name, psf }
    };
    let line = |at: &dyn Fn(f64) -> [f64; 2]| -> Vec<[f64; 2]> {
        (0..SAMPLES).map(|i| at((i as f64 + 0.5) / SAMPLES as f64)).collect()
    };
    // Equal areas: a spiral of golden turns.
    let disc = |t: f64| {
        let (radius, turn) = (2.5 * t.sqrt(), t * SAMPLES as f64 * 2.399_963_229_728_653);
        [radius * turn.sin(), radius * turn.cos()]
    };
    let stroke = |t: f64| {
        let (sin, cos) = 0.5f64.sin_cos();
        [10.0 * (t - 0.5) * sin, 10.0 * (t - 0.5) * cos]
    };
    let bow = |t: f64| {
        let angle = -0.4 + 2.6 * t;
        [4.5 * angle.sin() - 2.6, 4.5 * angle.cos() - 1.2]
    };
    [blur("disc", line(&disc)), blur("stroke", line(&stroke)), blur("bow", line(&bow))]
}

/// Points (row and column from the middle) shared out among their four nearest pixels.
fn splatted(points: &[[f64; 2]]) -> Array2<f32> {
    let mut kernel = Array2::<f64>::zeros((SIDE, SIDE));
    for &[row, column] in points {
        let (r, c) = (row + (SIDE / 2) as f64, column + (SIDE / 2) as f64);
        let (r0, c0) = (r.floor() as usize, c.floor() as usize);
        let (fr, fc) = (r.fract(), c.fract());
        for (dr, wr) in [(0, 1.0 - fr), (1, fr)] {
            for (dc, wc) in [(0, 1.0 - fc), (1, fc)] {
                kernel[(r0 + dr, c0 + dc)] += wr * wc;
            }
        }
    }
    let sum = kernel.sum();
    kernel.mapv(|v| (v / sum) as f32)
}

/// Pixels by which kernels may be moved against each other.
const REACH: isize = 3;

/// Rows and columns by which `found` lies beside `truth`, and their correlation there: the cosine of both.
pub(super) fn best_shift(found: ArrayView2<'_, f32>, truth: ArrayView2<'_, f32>) -> ((isize, isize), f64) {
    let at = |k: &ArrayView2<'_, f32>, r: isize, c: isize| {
        let place = (r + k.nrows() as isize / 2, c + k.ncols() as isize / 2);
        let place = usize::try_from(place.0).ok().zip(usize::try_from(place.1).ok());
        place.and_then(|at| k.get(at)).map_or(0.0, |v| f64::from(*v))
    };
    let norm = |k: &ArrayView2<'_, f32>| k.iter().map(|v| f64::from(v * v)).sum::<f64>().sqrt();
    let half = (found.nrows().max(truth.nrows()) / 2) as isize + REACH;
    let cosine = |dr: isize, dc: isize| {
        let both = (-half..=half).flat_map(|r| (-half..=half).map(move |c| (r, c)));
        let product: f64 = both.map(|(r, c)| at(&found, r + dr, c + dc) * at(&truth, r, c)).sum();
        product / (norm(&found) * norm(&truth)).max(f64::MIN_POSITIVE)
    };
    let shifts = (-REACH..=REACH).flat_map(|dr| (-REACH..=REACH).map(move |dc| (dr, dc)));
    let best = shifts.map(|(dr, dc)| ((dr, dc), cosine(dr, dc))).max_by(|a, b| a.1.total_cmp(&b.1));
    best.unwrap_or(((0, 0), 0.0))
}
