//! What a reconstruction is worth: PSNR and SSIM with the conventions that every number of this project follows
//! (docs/decisions/0003-metrics.md).
//!
//! Peak 1. A border of [`BORDER`] pixels is cropped first. Estimates are *not* clipped to 0…1 unless a name says so. Sums
//! run in f64 in a fixed order. What is compared is the picture ([`shown`]), under sRGB also the linear light.

use crate::metrics::comparable::{MetricError, compared};
use crate::metrics::psnr::{decibel, mean_square};
use crate::metrics::ssim::{self, ssim};
use edof_core::colour::LUMA;
use edof_core::{ColourFrame, Tone};
use ndarray::{Array2, Axis};
use serde::{Deserialize, Serialize};

/// Pixels that studies crop on each side before they measure.
pub const BORDER: usize = 8;

/// What a reconstruction is worth, in every way this project states.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// PSNR in dB over all three colours.
    #[serde(with = "crate::metrics::number")]
    pub psnr_db: f64,
    /// PSNR after the estimate was clipped to 0…1, as any display does.
    #[serde(with = "crate::metrics::number")]
    pub psnr_clipped_db: f64,
    /// PSNR of red, green and blue.
    #[serde(with = "crate::metrics::number::colours")]
    pub channel_psnr_db: [f64; 3],
    /// PSNR of BT.709 luma.
    #[serde(with = "crate::metrics::number")]
    pub luma_psnr_db: f64,
    /// Mean SSIM of the three colours.
    #[serde(with = "crate::metrics::number")]
    pub ssim: f64,
    /// SSIM of BT.709 luma.
    #[serde(with = "crate::metrics::number")]
    pub luma_ssim: f64,
}

impl Quality {
    /// Compares `estimate` with `truth` inside a border of `border` pixels.
    ///
    /// # Errors
    /// [`MetricError`] for frames of different sizes or smaller than the border and SSIM's window.
    pub fn of(truth: &ColourFrame, estimate: &ColourFrame, border: usize) -> Result<Self, MetricError> {
        let (truth, estimate) = compared(truth, estimate, border, ssim::SIDE)?;
        let planes = |f: &'_ ColourFrame| [0, 1, 2].map(|p| f.planes.index_axis(Axis(0), p).to_owned());
        let (t, e) = (planes(&truth), planes(&estimate));
        let errors = [0, 1, 2].map(|p| mean_square(t[p].view(), e[p].view()));
        let clipped = [0, 1, 2].map(|p| mean_square(t[p].view(), e[p].mapv(|v| v.clamp(0.0, 1.0)).view()));
        let colour_ssim = |p: usize| ssim(t[p].view(), e[p].view());
        let (t_luma, e_luma) = (luma(&truth), luma(&estimate));
        Ok(Self {
            psnr_db: decibel(errors.iter().sum::<f64>() / 3.0),
            psnr_clipped_db: decibel(clipped.iter().sum::<f64>() / 3.0),
            channel_psnr_db: errors.map(decibel),
            luma_psnr_db: decibel(mean_square(t_luma.view(), e_luma.view())),
            ssim: (colour_ssim(0)? + colour_ssim(1)? + colour_ssim(2)?) / 3.0,
            luma_ssim: ssim(t_luma.view(), e_luma.view())?,
        })
    }
}

/// The displayed picture of a frame of linear light: sRGB's encoding, clamped to the 0…1 of its codes. Under the
/// paper's convention light and picture are the same numbers, and stay as they are.
#[must_use]
pub fn shown(light: &ColourFrame, tone: Tone) -> ColourFrame {
    match tone {
        Tone::Linear => light.clone(),
        Tone::Srgb => ColourFrame { planes: light.planes.mapv(|v| tone.encode(v.clamp(0.0, 1.0))) },
    }
}

/// BT.709 luma of linear light.
#[must_use]
pub fn luma(frame: &ColourFrame) -> Array2<f32> {
    let plane = |p| frame.planes.index_axis(Axis(0), p);
    ndarray::Zip::from(plane(0)).and(plane(1)).and(plane(2)).map_collect(|&r, &g, &b| {
        let sum: f64 = LUMA.iter().zip([r, g, b]).map(|(w, v)| w * f64::from(v)).sum();
        sum as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::psnr;
    use ndarray::Array3;

    fn pattern(height: usize, width: usize) -> ColourFrame {
        ColourFrame {
            planes: Array3::from_shape_fn((3, height, width), |(p, r, c)| {
                0.5 + 0.4 * ((r as f32 * 0.31 + p as f32).sin() * (c as f32 * 0.17).cos())
            }),
        }
    }

    #[test]
    fn an_error_of_a_hundredth_is_40_db_in_every_colour_and_luma() {
        let truth = pattern(40, 44);
        let mut estimate = truth.clone();
        estimate.planes += 0.01;
        let q = Quality::of(&truth, &estimate, 8).unwrap();
        for value in [q.psnr_db, q.luma_psnr_db, q.channel_psnr_db[0], q.channel_psnr_db[2]] {
            assert!((value - 40.0).abs() < 1e-3, "{q:?}");
        }
    }

    #[test]
    fn what_a_screen_cannot_show_counts_on_light_alone() {
        let black = ColourFrame::zeros(40, 40);
        let mut light = black.clone();
        light.planes.fill(-0.1);
        assert_eq!(shown(&light, Tone::Srgb), black);
        assert_eq!(shown(&light, Tone::Linear), light);
        light.planes.fill(0.214_041);
        assert!(shown(&light, Tone::Srgb).planes.iter().all(|v| (v - 0.5).abs() < 1e-5));
    }

    #[test]
    fn colours_are_averaged_as_errors_not_as_decibels() {
        let truth = ColourFrame::zeros(40, 40);
        let mut estimate = truth.clone();
        estimate.planes.index_axis_mut(Axis(0), 0).fill(0.1);
        let q = Quality::of(&truth, &estimate, 8).unwrap();
        assert!((q.psnr_db - 10.0 * (300f64).log10()).abs() < 1e-4);
        assert!(q.channel_psnr_db[1].is_infinite());
    }

    #[test]
    fn what_lies_in_the_border_does_not_count() {
        let truth = pattern(40, 40);
        let mut estimate = truth.clone();
        estimate.planes[(0, 7, 20)] += 1.0;
        estimate.planes[(2, 20, 32)] += 1.0;
        assert!(psnr(&truth, &estimate, 8).unwrap().is_infinite());
        assert!(psnr(&truth, &estimate, 7).unwrap().is_finite());
    }

    #[test]
    fn clipping_forgives_what_lies_beyond_white() {
        let mut truth = ColourFrame::zeros(40, 40);
        truth.planes.fill(1.0);
        let mut estimate = truth.clone();
        estimate.planes.fill(1.1);
        let q = Quality::of(&truth, &estimate, 8).unwrap();
        assert!((q.psnr_db - 20.0).abs() < 1e-4 && q.psnr_clipped_db.is_infinite());
    }

    #[test]
    fn equal_frames_have_ssim_one_and_any_error_less() {
        let truth = pattern(40, 40);
        let same = Quality::of(&truth, &truth, 8).unwrap();
        assert!((same.ssim - 1.0).abs() < 1e-12 && (same.luma_ssim - 1.0).abs() < 1e-12);
        let mut estimate = truth.clone();
        estimate.planes.indexed_iter_mut().for_each(|((_, r, c), v)| *v += 0.1 * ((r + c) % 2) as f32);
        assert!(Quality::of(&truth, &estimate, 8).unwrap().ssim < 0.95);
    }

    #[test]
    fn metrics_of_unequal_or_small_frames_are_rejected_not_computed() {
        let psnr = |a: (usize, usize), b: (usize, usize), border: usize| {
            psnr(&ColourFrame::zeros(a.0, a.1), &ColourFrame::zeros(b.0, b.1), border)
                .map_err(|e| e.to_string())
        };
        let unequal = "frames of 40x40 and 42x40 pixels: must be equally large";
        assert_eq!(psnr((40, 40), (40, 42), 8).unwrap_err(), unequal);
        assert_eq!(psnr((40, 40), (40, 42), 0).unwrap_err(), unequal);
        let small = "frame of 20x16 pixels: must be at least 17x17 to crop 8 pixels and compare";
        assert_eq!(psnr((16, 20), (16, 20), 8).unwrap_err(), small);
        assert!(psnr((16, 20), (16, 20), usize::MAX).unwrap_err().starts_with("frame of 20x16 pixels: "));
        assert_eq!(psnr((17, 17), (17, 17), 8), Ok(f64::INFINITY));
        let ssim = |a: (usize, usize), b: (usize, usize)| {
            let planes = [Array2::<f32>::zeros(a), Array2::<f32>::zeros(b)];
            ssim(planes[0].view(), planes[1].view()).map_err(|e| e.to_string())
        };
        let small = "frame of 11x10 pixels: must be at least 11x11 to crop 0 pixels and compare";
        assert_eq!(ssim((10, 11), (10, 11)).unwrap_err(), small);
        assert_eq!(ssim((0, 0), (0, 0)).unwrap_err().split(':').next(), Some("frame of 0x0 pixels"));
        assert_eq!(
            ssim((20, 11), (11, 20)).unwrap_err(),
            "frames of 11x20 and 20x11 pixels: must be equally large"
        );
        assert_eq!(ssim((11, 11), (11, 11)), Ok(1.0));
    }

    #[test]
    fn frames_that_cannot_be_compared_are_rejected() {
        let error = |a: (usize, usize), b: (usize, usize)| {
            let frames = (ColourFrame::zeros(a.0, a.1), ColourFrame::zeros(b.0, b.1));
            Quality::of(&frames.0, &frames.1, 8).unwrap_err().to_string()
        };
        assert_eq!(error((40, 50), (40, 52)), "frames of 50x40 and 52x40 pixels: must be equally large");
        assert!(error((20, 50), (20, 50)).starts_with("frame of 50x20 pixels: must be at least 27x27"));
    }
}
