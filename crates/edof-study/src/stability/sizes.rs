//! Frames of the least sizes, of one line, and of a hundred megapixels.

use crate::metrics::memory;
use crate::stability::bench::Bench;
use crate::stability::case::{Promise, Scene};
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use crate::stability::scenes;
use edof_core::draw::Draw;
use edof_core::geometry::PATCH;
use edof_core::overlap::Overlap;
use edof_core::{CfaPhase, RawFrame, Reconstructor, Stride};
use edof_deblur::{Directional, Malvar};
use edof_golden::Golden;
use edof_golden::frame::scalar_frame;
use edof_golden::scalar;
use edof_golden::windows::window;
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_optics::{Sensor, expose};
use ndarray::{Array2, s};

/// Sides of the frame of a hundred megapixels: this wide.
const WIDE: usize = 10_000;
/// Patches of it that are compared with the specification.
const PLACES: usize = 32;

/// Every network and demosaicing on a frame of that size; rejected if no network accepts it.
pub(crate) fn size(bench: &Bench, height: usize, width: usize) -> Result<TrialResult, Stopped> {
    let scene = scenes::picture(&Scene::Stripes { period: 5.0, degrees: 30.0 }, height, width)?;
    let mut seen = vec![];
    let mut refusals = vec![];
    for phase in CfaPhase::ALL {
        let raw = expose(&scene, &Sensor { phase, ..Sensor::default() })?;
        for trained in &bench.networks {
            let golden = Golden::new(trained.fixed.clone())?;
            let name = format!("{}.fixed, {phase}", trained.name);
            match golden.frame(&raw) {
                Ok(fast) => {
                    let same =
                        scalar_frame(&trained.fixed, &raw)? == fast && fast.colour().size() == raw.size();
                    seen.push(Measurement::fact(name, "every word is the specification's", same));
                    let stride = Stride::PATCH;
                    let float = FloatReconstructor::new(
                        trained.float.clone(),
                        stride,
                        Overlap::default(),
                        Output::Rgb,
                    )?;
                    seen.push(finite(&float, &raw)?);
                }
                Err(refused) => refusals.push((name, refused)),
            }
        }
        seen.push(finite(&Malvar::default(), &raw)?);
        seen.push(finite(&Directional::default(), &raw)?);
    }
    match refusals.into_iter().next() {
        Some((_, refused)) => Err(refused.into()),
        None => Ok(TrialResult::of(seen)),
    }
}

fn finite(method: &dyn Reconstructor, raw: &RawFrame) -> Result<Measurement, Stopped> {
    let made = method.reconstruct(raw)?.frame;
    let finite = made.size() == raw.size() && made.planes.iter().all(|v| v.is_finite());
    Ok(Measurement::fact(method.name(), "the frame's size, every value finite", finite))
}

/// A large frame through the first network: bytes per pixel beside the raw frame, and words at random places.
pub(crate) fn megapixels(bench: &Bench, count: usize, promise: &Promise) -> Result<TrialResult, Stopped> {
    let Some(trained) = bench.networks.first() else { return Ok(TrialResult::default()) };
    let size = (count * 1_000_000 / WIDE / PATCH * PATCH, WIDE);
    let values = Array2::from_shape_fn(size, |(r, c)| ((r * 7919 + c * 104_729) % 4093) as u16);
    let raw = RawFrame::from_values(values, 12, CfaPhase::Rggb)?;
    let golden = Golden::new(trained.fixed.clone())?;
    // The peak so far is that of other cases; where the system does not forget it, it only makes this one look worse.
    memory::forget_peak();
    let before = memory::held_bytes();
    let made = golden.frame(&raw)?;
    let (peak, pixels) = (memory::peak_bytes(), (size.0 * size.1) as f64);
    let draw = &mut Draw::new(3);
    let geometry = golden.geometry();
    let wrong = (0..PLACES).filter(|_| {
        let at = |draw: &mut Draw, n: usize| draw.whole(0, (n / PATCH) as i64 - 1) as usize;
        let (row, column) = (at(draw, size.0), at(draw, size.1));
        let words = scalar::run(&trained.fixed, &window(&raw, geometry, row, column)).output;
        let (top, left) = (row * PATCH, column * PATCH);
        let block = made.frame.luma.slice(s![top..top + PATCH, left..left + PATCH]);
        trained.fixed.stride == Stride::PATCH && block.iter().ne(words[..PATCH * PATCH].iter())
    });
    let name = format!("{}.fixed", trained.name);
    let mut seen =
        vec![Measurement::fact(&name, "words at drawn places are the specification's", wrong.count() == 0)];
    if let (Some(before), Some(peak), Some(limit)) = (before, peak, promise.limit(&name)) {
        let bytes = peak.saturating_sub(before) as f64 / pixels;
        seen.push(Measurement::new(&name, "bytes a pixel beside the raw frame", bytes, limit));
    }
    Ok(TrialResult { saturations: made.counts.saturations(), ..TrialResult::of(seen) })
}
