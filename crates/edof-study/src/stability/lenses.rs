//! PSFs at the edge of what can be computed, and blur by kernels larger than the picture; `f32` against sums in `f64`.

use crate::report::picture::{png, psf_picture};
use crate::stability::case::{Lens, Promise, Scene};
use crate::stability::outcome::{Measurement, Stopped, TrialResult};
use crate::stability::scenes;
use edof_core::camera::Camera;
use edof_core::{Channel, Tone};
use edof_optics::blur;
use edof_optics::cosine::mirror_index;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use ndarray::{Array2, Axis};
use rayon::prelude::*;

/// Pixels of a kernel's picture.
const SHOWN: usize = 41;

/// One camera at one depth: PSFs and blur, or their error.
pub(crate) fn lens(lens: &Lens, promise: &Promise) -> Result<TrialResult, Stopped> {
    let mut camera = Camera::resolve(&lens.camera)?;
    camera.aperture_radius_mm = lens.aperture_radius_mm.unwrap_or(camera.aperture_radius_mm);
    camera.pixel_pitch_um = lens.pixel_pitch_um.unwrap_or(camera.pixel_pitch_um);
    camera.check()?;
    let psfs = channel_psfs(&camera, lens.psi, &Settings::default())?;
    let picture = scenes::picture(&Scene::Stripes { period: 7.3, degrees: 20.0 }, lens.plane, lens.plane)?;
    let plane = picture.planes.index_axis(Axis(0), 0).to_owned();
    let mut seen = vec![];
    for (channel, psf) in Channel::ALL.into_iter().zip(&psfs) {
        let name = format!("{channel:?}").to_lowercase();
        let kernel = psf.kernel();
        let finite = kernel.iter().all(|v| v.is_finite()) && (0.0..=1.0).contains(&psf.energy_beyond);
        seen.push(Measurement::fact(&name, "every number is finite", finite).noted(format!(
            "{} pixels wide, {:.2} % of the light beyond the support",
            psf.side(),
            100.0 * psf.energy_beyond
        )));
        let Some(limit) = promise.limit(&name) else { continue };
        let sum: f64 = kernel.iter().map(|v| f64::from(*v)).sum();
        let peak = kernel.iter().copied().fold(0.0f32, f32::max);
        let min = kernel.iter().copied().fold(0.0f32, f32::min);
        seen.push(Measurement::new(&name, "sum of the kernel, off 1", (sum - 1.0).abs(), limit));
        seen.push(Measurement::new(&name, "light below nothing, of the peak", f64::from(-min / peak), limit));
        let off = (&blur(plane.view(), psf).mapv(f64::from) - &direct(&plane, psf)).mapv(f64::abs);
        let worst = off.iter().fold(0.0, |worst: f64, v| if *v <= worst { worst } else { *v });
        seen.push(Measurement::new(&name, "blur in f32 off sums in f64", worst, limit));
    }
    let [red, green, blue] = psfs.each_ref().map(|psf| psf.kernel());
    let shown = png(&psf_picture([red, green, blue], SHOWN), Tone::Linear).ok();
    Ok(TrialResult::of(seen).shown(shown))
}

/// Blur by the definition, mirrored as often as the kernel reaches.
fn direct(plane: &Array2<f32>, psf: &Psf) -> Array2<f64> {
    let (half, (height, width)) = ((psf.side() / 2) as isize, plane.dim());
    let pixels: Vec<f64> = (0..height * width)
        .into_par_iter()
        .map(|at| {
            let (r, c) = ((at / width) as isize, (at % width) as isize);
            let columns: Vec<usize> =
                (0..psf.side() as isize).map(|j| mirror_index(c - (j - half), width)).collect();
            let line = |(i, weights): (usize, ndarray::ArrayView1<'_, f32>)| {
                let row = plane.row(mirror_index(r - (i as isize - half), height));
                weights.iter().zip(&columns).map(|(k, c)| f64::from(*k) * f64::from(row[*c])).sum::<f64>()
            };
            psf.kernel().outer_iter().enumerate().map(line).sum()
        })
        .collect();
    Array2::from_shape_fn((height, width), |(r, c)| pixels[r * width + c])
}
