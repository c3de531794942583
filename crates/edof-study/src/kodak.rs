//! The main experiment: every method behind its camera, on every photograph, depth and noise level.
//!
//! Photographs are blurred by the camera's kernels at each ψ, exposed with 16 bits and Gaussian noise, reconstructed, and
//! compared with themselves. The noise depends on photograph, ψ and σ alone, so that all cameras and methods meet the same.
//! Methods run one after the other, each on all threads, so that their times can be compared; all else runs side by side.

use crate::metrics::{BORDER, MetricError, Quality};
use crate::photos::Photo;
use edof_optics::blur::blur_frame;
use edof_optics::psf::{MOST_DEFOCUS, Settings, channel_psfs};
use edof_optics::sensor::{Sensor, SensorError, expose};
use edof_spec::{Camera, CfaPhase, Noise, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// Bits of the simulated sensor.
const DEPTH: u32 = 16;

/// A camera and the methods that stand behind it.
pub struct Bench {
    /// The camera.
    pub camera: Camera,
    /// Methods; names must differ over all benches of an experiment.
    pub methods: Vec<Box<dyn Reconstructor>>,
}

/// Settings of an experiment.
#[derive(Debug, Clone)]
pub struct Conditions {
    /// Depths.
    pub psi: Vec<f64>,
    /// Standard deviations of the noise, in units of full scale.
    pub noise: Vec<f64>,
    /// Step of the patch grid, as stated in each row.
    pub stride: usize,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// One method on one photograph at one depth and noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the method.
    pub method: String,
    /// Name of the camera.
    pub camera: String,
    /// Name of the photograph.
    pub image: String,
    /// Depth.
    pub psi: f64,
    /// σ of the noise.
    pub noise: f64,
    /// Step of the patch grid.
    pub stride: usize,
    /// PSNR over the three colours, peak 1, border cropped, not clipped.
    pub psnr_db: f64,
    /// Mean SSIM of the three colours.
    pub ssim: f64,
    /// Wall-clock seconds a megapixel.
    pub seconds_per_megapixel: f64,
    /// PSNR with the estimate clipped to 0…1.
    pub psnr_clipped_db: f64,
    /// PSNR of red, green and blue.
    pub channel_psnr_db: [f64; 3],
    /// PSNR of BT.709 luma.
    pub luma_psnr_db: f64,
    /// SSIM of BT.709 luma.
    pub luma_ssim: f64,
}

/// An experiment that cannot go on.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum KodakError {
    /// A method refused a frame.
    #[error("{image}: {source}")]
    Reconstruct { image: String, source: ReconstructError },
    /// The photograph cannot be exposed, or the noise is impossible.
    #[error("{image}: {source}")]
    Sensor { image: String, source: SensorError },
    /// Blur larger than any kernel computed, or no number.
    #[error("psi {psi}: must be a number within {MOST_DEFOCUS} of camera {camera}'s focus")]
    Psi { psi: f64, camera: String },
    /// The listener asked to stop.
    #[error("stopped")]
    Stopped,
    /// A photograph too small to measure.
    #[error("{image}: {source}")]
    Metric { image: String, source: MetricError },
}

/// How far an experiment is.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Photographs done, over all cameras and depths.
    pub done: usize,
    /// How many there are.
    pub of: usize,
    /// Camera at work.
    pub camera: &'a str,
    /// Depth at work.
    pub psi: f64,
    /// Photograph just done.
    pub image: &'a str,
}

/// Runs the experiment; rows come by bench, ψ, photograph, noise, method. `tell` hears of every photograph and may stop it.
///
/// # Errors
/// [`KodakError`] naming the first photograph that a method or metric cannot take, or `Stopped`.
pub fn run(
    benches: &[Bench],
    photos: &[Photo],
    conditions: &Conditions,
    mut tell: impl FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Vec<Row>, KodakError> {
    let of = benches.len() * conditions.psi.len() * photos.len();
    let (mut rows, mut done) = (vec![], 0);
    for bench in benches {
        for &psi in &conditions.psi {
            let defocus = (psi - bench.camera.focus_psi).abs();
            if defocus.is_nan() || defocus > MOST_DEFOCUS {
                return Err(KodakError::Psi { psi, camera: bench.camera.name.clone() });
            }
            let psfs = channel_psfs(&bench.camera, psi, &conditions.optics);
            for photo in photos {
                let light = blur_frame(&photo.frame, &psfs);
                let shots = conditions
                    .noise
                    .par_iter()
                    .map(|&noise| Ok((noise, expose(&light, &sensor(&photo.name, psi, noise))?)))
                    .collect::<Result<Vec<_>, _>>()
                    .map_err(|source| KodakError::Sensor { image: photo.name.clone(), source })?;
                rows.extend(measure(bench, photo, psi, &shots, conditions.stride)?);
                done += 1;
                let progress = Progress { done, of, camera: &bench.camera.name, psi, image: &photo.name };
                if tell(progress).is_break() {
                    return Err(KodakError::Stopped);
                }
            }
        }
    }
    Ok(rows)
}

/// All methods of a bench on one photograph's raw frames: reconstructed in turn, compared side by side.
fn measure(
    bench: &Bench,
    photo: &Photo,
    psi: f64,
    shots: &[(f64, RawFrame)],
    stride: usize,
) -> Result<Vec<Row>, KodakError> {
    let image = || photo.name.clone();
    let mut done: Vec<(f64, &str, Reconstruction)> = vec![];
    for (noise, raw) in shots {
        for method in &bench.methods {
            let result = method
                .reconstruct(raw)
                .map_err(|source| KodakError::Reconstruct { image: image(), source })?;
            done.push((*noise, method.name(), result));
        }
    }
    let (height, width) = photo.frame.size();
    let megapixels = (height * width) as f64 * 1e-6;
    done.into_par_iter()
        .map(|(noise, method, result)| {
            let quality = Quality::of(&photo.frame, &result.frame, BORDER)
                .map_err(|source| KodakError::Metric { image: image(), source })?;
            Ok(Row {
                method: method.to_owned(),
                camera: bench.camera.name.clone(),
                image: image(),
                psi,
                noise,
                stride,
                psnr_db: quality.psnr_db,
                ssim: quality.ssim,
                seconds_per_megapixel: result.seconds / megapixels,
                psnr_clipped_db: quality.psnr_clipped_db,
                channel_psnr_db: quality.channel_psnr_db,
                luma_psnr_db: quality.luma_psnr_db,
                luma_ssim: quality.luma_ssim,
            })
        })
        .collect()
}

/// The sensor for one photograph, ψ and σ: its seed depends on these three and nothing else.
#[must_use]
pub fn sensor(image: &str, psi: f64, noise: f64) -> Sensor {
    let words = image.bytes().map(u64::from).chain([psi.to_bits(), noise.to_bits()]);
    // FNV-1a over whole words.
    let seed = words
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, word| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3));
    Sensor { depth: DEPTH, phase: CfaPhase::Rggb, noise: Noise::gaussian(noise), seed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_deblur::Malvar;
    use edof_spec::ColourFrame;

    fn bench(camera: &str, method: &str) -> Bench {
        Bench { camera: Camera::resolve(camera).unwrap(), methods: vec![Box::new(Malvar::named(method))] }
    }

    fn photo(name: &str) -> Photo {
        let mut frame = ColourFrame::zeros(64, 80);
        frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
            *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 4) as f32).cos()
        });
        Photo { name: name.into(), frame }
    }

    fn conditions(psi: &[f64], noise: &[f64]) -> Conditions {
        Conditions { psi: psi.to_vec(), noise: noise.to_vec(), stride: 8, optics: Settings::default() }
    }

    #[test]
    fn every_photo_depth_noise_and_method_has_one_row_in_order() {
        let benches = [bench("ring-outer", "a"), bench("clear", "b")];
        let photos = [photo("p1"), photo("p2")];
        let mut told = vec![];
        let rows = run(&benches, &photos, &conditions(&[0.0, 8.0], &[0.0, 0.01]), |p| {
            told.push((p.done, p.of));
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(rows.len(), 2 * 2 * 2 * 2);
        assert_eq!(told.last(), Some(&(8, 8)));
        let key = |r: &Row| (r.method.clone(), r.psi as u32, r.image.clone(), (r.noise * 100.0) as u32);
        assert!(rows.iter().map(key).collect::<Vec<_>>().is_sorted());
    }

    #[test]
    fn the_same_experiment_gives_the_same_numbers() {
        let go = || {
            let rows = run(&[bench("ring-2018", "a")], &[photo("p")], &conditions(&[3.0], &[0.02]), |_| {
                ControlFlow::Continue(())
            })
            .unwrap();
            (rows[0].psnr_db, rows[0].ssim)
        };
        assert_eq!(go(), go());
    }

    #[test]
    fn noise_and_defocus_cost_quality() {
        let rows = run(&[bench("clear", "a")], &[photo("p")], &conditions(&[0.0, 8.0], &[0.0, 0.05]), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
        let db: Vec<f64> = rows.iter().map(|r| r.psnr_db).collect();
        assert!(db[0] > db[1] + 1.0 && db[0] > db[2] + 1.0, "{db:?}");
    }

    #[test]
    fn other_photos_depths_and_noises_have_other_noise() {
        let seeds = [("a", 0.0, 0.01), ("b", 0.0, 0.01), ("a", 2.0, 0.01), ("a", 0.0, 0.02)]
            .map(|(image, psi, noise)| sensor(image, psi, noise).seed);
        for (i, seed) in seeds.iter().enumerate() {
            assert!(!seeds[..i].contains(seed));
        }
    }

    #[test]
    fn an_experiment_stops_when_asked() {
        let photos = [photo("p1"), photo("p2")];
        let stopped =
            run(&[bench("clear", "a")], &photos, &conditions(&[0.0], &[0.0]), |_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(KodakError::Stopped)));
    }

    #[test]
    fn depths_and_noises_that_cannot_be_are_refused() {
        let refused = |psi, noise| {
            let go = |_: Progress<'_>| ControlFlow::Continue(());
            run(&[bench("clear", "a")], &[photo("p")], &conditions(&[psi], &[noise]), go)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(refused(f64::NAN, 0.0), "psi NaN: must be a number within 200 of camera clear's focus");
        assert_eq!(
            refused(0.0, -1.0),
            "p: noise: the standard deviation is -1, expected 0 to 1, where full scale is 1"
        );
    }

    #[test]
    fn a_photo_too_small_to_measure_is_named() {
        let small = Photo { name: "tiny".into(), frame: ColourFrame::zeros(20, 20) };
        let error =
            run(&[bench("clear", "a")], &[small], &conditions(&[0.0], &[0.0]), |_| ControlFlow::Continue(()))
                .unwrap_err();
        assert!(
            error.to_string().starts_with("tiny: frame of 20x20 pixels: must be at least 27x27"),
            "{error}"
        );
    }
}
