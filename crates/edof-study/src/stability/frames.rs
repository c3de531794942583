//! Frames: a scene behind a camera, and every method on what the sensor gives.
//!
//! A network is judged where the program takes it for the frame's noise; elsewhere its values must be finite and within its bounds.
//! Networks look through their own cameras (or all through the one that the case names), other methods through the paper's. Every fixed network is compared with its bound against its float network in `f64`, and so is `f32`, whatever the case's limit. The limit itself is about pictures: the largest error of a value, or the loss against demosaicing the same frame ([`Malvar`]), which is what one would have
//! without any of this.

use crate::metrics::MetricError;
use crate::report::picture::{png, sheet};
use crate::stability::bench::Bench;
use crate::stability::bounds::Compared;
use crate::stability::case::{Frame, Promise};
use crate::stability::methods::CAMERA;
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use crate::stability::scenes;
use edof_core::camera::Camera;
use edof_core::number::InputWord;
use edof_core::overlap::Overlap;
use edof_core::{CfaPhase, ColourFrame, Geometry, RawFrame, Reconstructor, Tone};
use edof_deblur::Malvar;
use edof_golden::GoldenReconstructor;
use edof_io::read_warnings::{ReadWarning, read_warnings};
use edof_network::FixedNetwork;
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_optics::capture::{Approximation, capture};
use edof_optics::{Sensor, expose};
use rayon::prelude::*;

/// Sides of the frames.
const SIZE: (usize, usize) = (80, 112);
/// Pixels at the border that do not count.
const BORDER: usize = 8;
/// A frame and what it should have been.
struct Shot {
    raw: RawFrame,
    sharp: ColourFrame,
    demosaiced: ColourFrame,
}

/// What the sensor gives of a case's scene behind a camera, and the scene without blur.
pub(crate) fn raw(frame: &Frame, camera: &Camera) -> Result<(RawFrame, ColourFrame), Stopped> {
    let scene = scenes::layers(&frame.scene, frame.psi, SIZE.0, SIZE.1)?;
    let sensor = Sensor { depth: frame.depth, noise: frame.noise, seed: 1, ..Sensor::default() };
    let raw = capture(&scene, camera, &sensor, &Approximation::default())?.raw;
    let raw = frame.defects.map_or_else(|| Ok(raw.clone()), |defects| scenes::broken(&raw, defects))?;
    Ok((raw, scene.sharp()))
}

fn shot(frame: &Frame, camera: &Camera) -> Result<Shot, Stopped> {
    let (raw, sharp) = raw(frame, camera)?;
    let demosaiced = Malvar::default().reconstruct(&raw)?.frame;
    // What is brighter than white is white on any screen.
    let sharp = ColourFrame { planes: sharp.planes.mapv(|v| v.clamp(0.0, 1.0)) };
    Ok(Shot { raw, sharp, demosaiced })
}

/// Every method on one frame.
pub(crate) fn frame(bench: &Bench, frame: &Frame, promise: &Promise) -> Result<TrialResult, Stopped> {
    let mut tried = TrialResult::default();
    let psnr = bench.subjects.psnr;
    let judge = |name: &str, shot: &Shot, picture: &ColourFrame| judged(name, shot, picture, promise, psnr);
    let judge_net = |is_for: bool, name: &str, shot: &Shot, picture: &ColourFrame| match is_for {
        true => judge(name, shot, picture),
        false => Ok(vec![is_finite(name, picture)]),
    };
    for (index, trained) in bench.networks.iter().enumerate() {
        let own = &trained.float.origin.camera;
        let is_for = bench.is_for(trained, frame.noise);
        let camera = frame.camera.as_deref().map_or_else(|| Ok(own.clone()), Camera::resolve)?;
        let shot = shot(frame, &camera)?;
        let compared = Compared::trained(bench.subjects, trained)?;
        let found = compared.look(&windows(&trained.fixed, &shot.raw));
        tried.seen.extend(compared.seen(&trained.name, &found, true));
        let fixed = GoldenReconstructor::new(trained.fixed.clone(), format!("{}.fixed", trained.name))?;
        let float = FloatReconstructor::new(
            trained.float.clone(),
            trained.fixed.stride,
            Overlap::default(),
            Output::Rgb,
        )?;
        let made = fixed.reconstruct(&shot.raw)?;
        let saturations = made.counters.as_ref().map_or(0, |counters| counters.saturations);
        tried.saturations += saturations;
        if frame.natural {
            let seen = Measurement::fact(fixed.name(), "saturates nowhere", saturations == 0);
            tried.seen.push(seen.noted(format!("{saturations} saturations")));
        }
        tried.seen.extend(judge_net(is_for, fixed.name(), &shot, &made.frame)?);
        tried.seen.extend(judge_net(is_for, float.name(), &shot, &float.reconstruct(&shot.raw)?.frame)?);
        if frame.camera.is_some() {
            let told = camera.same_lens(own) == (camera.name == own.name);
            tried.seen.push(Measurement::fact(&trained.name, "a lens that is not its own is noticed", told));
        }
        if index == 0 {
            let rows = [vec![shot.demosaiced.clone(), made.frame]];
            tried.picture = png(&sheet(&rows, 4), Tone::Linear).ok();
        }
    }
    if !frame.nets_only {
        let shot = shot(frame, &Camera::resolve(CAMERA)?)?;
        tried.seen.extend(judge("demosaic-malvar", &shot, &shot.demosaiced)?);
        let methods = bench.methods().all(frame)?;
        let methods: Vec<&dyn Reconstructor> =
            methods.iter().map(|method| method.as_ref().as_ref()).collect();
        let made: Vec<_> = methods
            .par_iter()
            .map(|method| {
                let picture = method.reconstruct(&shot.raw).map(|made| made.frame);
                (method.name().to_owned(), picture)
            })
            .collect();
        for (name, picture) in made {
            tried.seen.extend(judge(&name, &shot, &picture?)?);
        }
    }
    Ok(tried)
}

/// All windows of a frame of light, as input words of the network.
pub(crate) fn windows(network: &FixedNetwork, raw: &RawFrame) -> Vec<InputWord> {
    let geometry = Geometry::new(network.form.window, network.stride);
    let raw = raw.encoded(network.origin.values);
    let (raw, _) = raw.to_rggb();
    let (rows, columns) = geometry.patches(raw.size().0, raw.size().1);
    let places = (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c)));
    places.flat_map(|(r, c)| edof_golden::windows::window(&raw, geometry, r, c)).collect()
}

fn is_finite(name: &str, picture: &ColourFrame) -> Measurement {
    let finite = picture.planes.iter().all(|v| v.is_finite());
    Measurement::fact(name, "every value is a finite number", finite)
}

fn judged(
    name: &str,
    shot: &Shot,
    picture: &ColourFrame,
    promise: &Promise,
    psnr: fn(&ColourFrame, &ColourFrame, usize) -> Result<f64, MetricError>,
) -> Result<Vec<Measurement>, MetricError> {
    let mut seen = vec![is_finite(name, picture)];
    let limit = promise.limit(name);
    match (promise, limit) {
        (Promise::Same { .. }, Some(limit)) => {
            let (height, width) = picture.size();
            let inside =
                |frame: &ColourFrame| frame.crop(BORDER, BORDER, height - 2 * BORDER, width - 2 * BORDER);
            let off = (&inside(picture).planes - &inside(&shot.sharp).planes).mapv(f32::abs);
            let worst = off.iter().fold(0.0f32, |worst, v| if *v <= worst { worst } else { *v });
            seen.push(Measurement::new(name, "largest error of a value", f64::from(worst), limit));
        }
        (Promise::Graceful { .. }, Some(limit)) => {
            let (own, plain) =
                (psnr(&shot.sharp, picture, BORDER)?, psnr(&shot.sharp, &shot.demosaiced, BORDER)?);
            // A plain picture without any error has no loss in dB.
            let (own, plain) = (own.min(EXACT_DB), plain.min(EXACT_DB));
            let one = Measurement::new(name, "dB below demosaicing", plain - own, limit);
            seen.push(one.noted(format!("{own:.2} dB, demosaiced {plain:.2}")));
        }
        _ => {}
    }
    Ok(seen)
}

/// Above this a picture is as good as any: half of a code of 8 bits.
const EXACT_DB: f64 = 54.0;

/// A frame read with another phase than it was taken with: whether there is a warning.
pub(crate) fn phase(taken: CfaPhase, read: CfaPhase) -> Result<TrialResult, Stopped> {
    let scene = scenes::layers(&crate::stability::case::Scene::Leaves, 4.0, SIZE.0, SIZE.1)?;
    let sensor = Sensor { phase: taken, ..Sensor::default() };
    let shot = capture(&scene, &Camera::resolve(CAMERA)?, &sensor, &Approximation::default())?;
    let warm = tinted(&shot.light);
    let raw = expose(&warm, &sensor)?;
    let raw = RawFrame::from_values(raw.values(), raw.depth(), read)?;
    let told = read_warnings(&raw).contains(&ReadWarning::Phase);
    Ok(TrialResult::of(vec![Measurement::fact(format!("{taken} read as {read}"), "told as doubtful", told)]))
}

/// Under a warm lamp, as most light is not white.
fn tinted(light: &ColourFrame) -> ColourFrame {
    let mut warm = light.clone();
    for (mut plane, share) in warm.planes.outer_iter_mut().zip([0.9, 0.7, 0.45]) {
        plane *= share;
    }
    warm
}
