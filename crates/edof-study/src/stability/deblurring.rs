//! Deconvolution where there is little to go by: planes of one grey, clipped ones, kernels with frequencies that are nothing, kernels larger
//! than the plane.

use crate::report::picture::{png, sheet};
use crate::stability::case::{Kernel, Promise, Scene};
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use crate::stability::scenes;
use edof_core::{ColourFrame, Tone};
use edof_deblur::blind;
use edof_deblur::hyper_laplacian::{Prior, hyper_laplacian};
use edof_deblur::known::{richardson_lucy, wiener};
use edof_optics::cosine::mirror_index;
use ndarray::{Array2, Axis};

/// Richardson and Lucy's steps: those of the studies.
const STEPS: usize = 15;

/// All methods that a kernel allows, on one plane.
pub(crate) fn deblur(
    scene: &Scene,
    kernel: Kernel,
    ratio: f32,
    [height, width]: [usize; 2],
    promise: &Promise,
) -> Result<TrialResult, Stopped> {
    let frame = scenes::picture(scene, height, width)?;
    // What a sensor gives: nothing above white.
    let sharp = frame.planes.index_axis(Axis(0), 1).mapv(|v| v.clamp(0.0, 1.0));
    let (known, found) = match kernel {
        Kernel::Point => (Array2::from_elem((1, 1), 1.0), None),
        Kernel::Box(side) => (Array2::from_elem((side, side), 1.0 / (side * side) as f32), None),
        Kernel::Blind(side) => (
            Array2::from_elem((3, 3), 1.0 / 9.0),
            Some(blind::Settings { side, ..blind::Settings::default() }),
        ),
    };
    let seen = blurred(&sharp, &known);
    let made = match &found {
        None => vec![
            ("wiener", wiener(seen.view(), known.view(), ratio)),
            ("richardson-lucy", richardson_lucy(seen.view(), known.view(), STEPS)),
            ("hyper-laplacian", hyper_laplacian(seen.view(), known.view(), Prior::default())),
        ],
        Some(settings) => {
            let blind = blind::deconvolve(seen.view(), settings);
            vec![("blind-deconvolution", blind.picture), ("blind-deconvolution kernel", blind.kernel)]
        }
    };
    let mut judged = vec![];
    for (name, plane) in &made {
        let finite = plane.iter().all(|v| v.is_finite());
        judged.push(Measurement::fact(*name, "every value is a finite number", finite));
        if plane.dim() != sharp.dim() {
            let sum = f64::from(plane.sum());
            judged.push(Measurement::new(*name, "sum off 1", (sum - 1.0).abs(), 1e-4));
        } else if let Some(limit) = promise.limit(name) {
            judged.push(compared(name, &sharp, &seen, plane, promise, limit));
        }
    }
    let grey = |plane: &Array2<f32>| {
        let mut frame = ColourFrame::zeros(plane.nrows(), plane.ncols());
        frame.planes.outer_iter_mut().for_each(|mut to| to.assign(plane));
        frame
    };
    let shown = std::iter::once(&seen).chain(made.iter().map(|(_, plane)| plane)).map(grey).collect();
    Ok(TrialResult::of(judged).shown(png(&sheet(&[shown], 2), Tone::Linear).ok()))
}

fn compared(
    name: &str,
    sharp: &Array2<f32>,
    seen: &Array2<f32>,
    plane: &Array2<f32>,
    promise: &Promise,
    limit: f64,
) -> Measurement {
    let square = |a: &Array2<f32>| {
        a.iter().zip(sharp).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum::<f64>()
            / sharp.len() as f64
    };
    if matches!(promise, Promise::Same { .. }) {
        let off = (plane - sharp).mapv(f32::abs);
        let worst = off.iter().fold(0.0f32, |worst, v| if *v <= worst { worst } else { *v });
        return Measurement::new(name, "largest error of a value", f64::from(worst), limit);
    }
    // A plane as good as half of a code of 8 bits is as good as any.
    let db = |error: f64| -10.0 * error.max(4e-6).log10();
    let (own, before) = (db(square(plane)), db(square(seen)));
    Measurement::new(name, "dB below the blurred plane", before - own, limit)
        .noted(format!("{own:.2} dB, blurred {before:.2}"))
}

fn blurred(plane: &Array2<f32>, kernel: &Array2<f32>) -> Array2<f32> {
    let ((height, width), half) = (plane.dim(), (kernel.nrows() / 2) as isize);
    Array2::from_shape_fn((height, width), |(r, c)| {
        let terms = kernel.indexed_iter().map(|((i, j), k)| {
            let row = mirror_index(r as isize - (i as isize - half), height);
            f64::from(*k) * f64::from(plane[(row, mirror_index(c as isize - (j as isize - half), width))])
        });
        terms.sum::<f64>() as f32
    })
}
