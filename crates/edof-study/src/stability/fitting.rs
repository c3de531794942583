//! What a map that was fitted without noise does where there is some.
//!
//! The linear map from windows to patches is fitted to dead leaves behind the paper's lens at ψ = 8, by least squares: with nothing added, or
//! with the noise's variance on the diagonal, which is what training with noise comes to. Other leaves then tell what it loses to noise.

use crate::stability::case::Promise;
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use crate::stability::subjects::Subjects;
use edof_core::Noise;
use edof_core::camera::Camera;
use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_optics::blur_frame;
use edof_optics::draw::{Builtin, draw};
use edof_optics::psf::{Settings, channel_psfs};
use edof_optics::{Sensor, expose};
use ndarray::Array2;

const CAMERA: &str = "ring-2018";
const PSI: f64 = 8.0;
const SIZE: (usize, usize) = (160, 240);
/// Pixels of the border that no window is taken from: mirrored light is no scene's.
const BORDER: usize = 16;
/// What keeps the solution apart from rounding where there is no noise.
const MIN_RIDGE: f64 = 1e-9;

/// Fits a map for noise of σ `trained` and shows it noise of σ `met`.
pub(crate) fn fitted(
    subjects: &Subjects,
    trained: f64,
    met: f64,
    promise: &Promise,
) -> Result<TrialResult, Stopped> {
    let (inputs, truth) = windows(1, 0.0)?;
    let mean = inputs.iter().map(|v| f64::from(*v).powi(2)).sum::<f64>() / inputs.len() as f64;
    let ridge = MIN_RIDGE.max(trained * trained / mean);
    let map = (subjects.least_squares)(inputs.view(), truth.view(), ridge);
    let db = |noise: f64| -> Result<f64, Stopped> {
        let (inputs, truth) = windows(2, noise)?;
        let error = &inputs.dot(&map.t()) - &truth;
        let square = error.iter().map(|e| f64::from(*e).powi(2)).sum::<f64>() / error.len() as f64;
        Ok(-10.0 * square.log10())
    };
    let (without, with) = (db(0.0)?, db(met)?);
    let name = format!("linear map fitted at noise {trained}");
    let mut seen =
        vec![Measurement::fact(&name, "every weight is a finite number", map.iter().all(|v| v.is_finite()))];
    seen.extend(promise.limit(&name).map(|limit| {
        let one = Measurement::new(&name, format!("dB lost to noise of {met}"), without - with, limit);
        one.noted(format!("{without:.2} dB without noise, {with:.2} with"))
    }));
    Ok(TrialResult::of(seen))
}

/// Windows of 8×8 raw values and the sharp patches at their places, as rows.
fn windows(seed: u64, sigma: f64) -> Result<(Array2<f32>, Array2<f32>), Stopped> {
    let sharp = draw(Builtin::Leaves, SIZE.0, SIZE.1, &[0.0], seed)?.sharp();
    let psfs = channel_psfs(&Camera::resolve(CAMERA)?, PSI, &Settings::default())?;
    let sensor = Sensor { depth: 16, noise: Noise::gaussian(sigma), seed, ..Sensor::default() };
    let raw = expose(&blur_frame(&sharp, &psfs), &sensor)?;
    let places: Vec<(usize, usize)> = (BORDER..SIZE.0 - BORDER - PATCH)
        .step_by(2)
        .flat_map(|r| (BORDER..SIZE.1 - BORDER - PATCH).step_by(2).map(move |c| (r, c)))
        .collect();
    let at = |place: usize, pixel: usize| {
        let (top, left) = places[place];
        (top + pixel / PATCH, left + pixel % PATCH)
    };
    let inputs = Array2::from_shape_fn((places.len(), PATCH_PIXELS), |(place, pixel)| {
        f32::from(raw.pixels()[at(place, pixel)]) / 65536.0
    });
    let truth = Array2::from_shape_fn((places.len(), RGB_OUTPUTS), |(place, output)| {
        let (r, c) = at(place, output % PATCH_PIXELS);
        sharp.planes[(output / PATCH_PIXELS, r, c)]
    });
    Ok((inputs, truth))
}
