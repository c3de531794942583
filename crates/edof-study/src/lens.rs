//! Figures of a camera's optics: MTF at several depths, contrast through focus (the paper's Figure 1), and a sheet of PSFs.

use crate::picture::{enlarged, psf_picture, sheet};
use crate::plot::{Axis, Mark, Plot, Series};
use edof_optics::bank;
use edof_optics::mtf::{Footprint, green_cutoff_per_mm, otf, through_focus};
use edof_optics::psf::{NoPsf, Psf, Settings, channel_psfs};
use edof_spec::{Camera, Channel, ColourFrame};

/// Points of a curve.
const POINTS: u32 = 60;
/// Colours of red, green and blue.
const CHANNELS: [(&str, &str); 3] = [("red", "#d62728"), ("green", "#2ca02c"), ("blue", "#1f77b4")];
/// Pixels of a PSF that the sheet shows along each side, and how large each is drawn.
const SHOWN: usize = 31;
const ENLARGED: usize = 4;

/// The same lens, sensor and focus without the mask; computed, whatever PSFs the camera has of its own.
#[must_use]
pub fn without_mask(camera: &Camera) -> Camera {
    let name = format!("{} without mask", camera.name);
    Camera { name, rings: vec![], profile: None, psf_bank: None, ..camera.clone() }
}

/// Figure 1(a): green's response over spatial frequency, as a share of the cut-off, at each ψ; negative where contrast is
/// reversed. The lens alone, without the pixel.
///
/// # Errors
/// [`NoPsf`].
pub fn mtf_plot(camera: &Camera, psis: &[f64]) -> Result<Plot, NoPsf> {
    let cutoff = green_cutoff_per_mm(camera);
    let series = psis.iter().map(|&psi| {
        let response = otf(camera, Channel::Green, psi, Footprint::Lens)?;
        let share = |i: u32| f64::from(i) / f64::from(POINTS);
        let points = (0..=POINTS).map(|i| [share(i), response.at(share(i) * cutoff)]);
        Ok(Series::new(format!("ψ = {psi}"), Mark::Line, points))
    });
    Ok(Plot {
        title: format!("Response to spatial frequency, green: {}", camera.name),
        x: Axis::linear("frequency / cut-off").from(0.0).to(1.0),
        y: Axis::linear("contrast").to(1.0),
        series: series.collect::<Result<_, NoPsf>>()?,
    })
}

/// Figure 1(b): contrast of red, green and blue at a quarter of green's cut-off through focus; dotted without the mask.
///
/// # Errors
/// [`NoPsf`].
pub fn contrast_plot(camera: &Camera) -> Result<Plot, NoPsf> {
    let [low, high] = depths(camera);
    let psis: Vec<f64> = (0..=32).map(|i| low + (high - low) * f64::from(i) / 32.0).collect();
    let frequency = green_cutoff_per_mm(camera) / 4.0;
    let curves = |camera: &Camera, mark: Mark, note: &str| -> Result<Vec<Series>, NoPsf> {
        let contrasts = through_focus(camera, frequency, &psis, Footprint::Lens)?;
        let curve = |(channel, (name, colour)): (usize, (&str, &str))| {
            let points = psis.iter().zip(&contrasts).map(|(&psi, c)| [psi, c[channel].abs()]);
            Series::new(format!("{name}{note}"), mark, points).coloured(colour)
        };
        Ok(CHANNELS.into_iter().enumerate().map(curve).collect())
    };
    let mut series = curves(camera, Mark::Line, "")?;
    if !camera.rings.is_empty() || camera.profile.is_some() || camera.psf_bank.is_some() {
        series.extend(curves(&without_mask(camera), Mark::Dotted, ", no mask")?);
    }
    Ok(Plot {
        title: format!("Contrast at a quarter of the cut-off: {}", camera.name),
        x: Axis::linear("ψ (radians)").from(low).to(high),
        y: Axis::linear("contrast").from(0.0),
        series,
    })
}

/// The camera's range of ψ, no wider than its bank's.
fn depths(camera: &Camera) -> [f64; 2] {
    let [low, high] = camera.psi_range;
    match camera.psf_bank.as_ref().and_then(|own| own.kernels.as_ref()).map(|kernels| bank::ends(kernels)) {
        Some([first, last]) => [low.clamp(first, last), high.clamp(first, last)],
        None => [low, high],
    }
}

/// PSFs of one camera a row, each ψ a column; every channel scaled to its own peak, brightness raised to show faint rings.
///
/// # Errors
/// [`NoPsf`].
pub fn psf_sheet(cameras: &[&Camera], psis: &[f64], settings: &Settings) -> Result<ColourFrame, NoPsf> {
    let picture = |camera: &Camera, psi: f64| -> Result<ColourFrame, NoPsf> {
        let psfs: [Psf; 3] = channel_psfs(camera, psi, settings)?;
        Ok(enlarged(&psf_picture(psfs.each_ref().map(|p| &p.kernel), SHOWN), ENLARGED))
    };
    let row =
        |camera: &&Camera| psis.iter().map(|&psi| picture(camera, psi)).collect::<Result<Vec<_>, NoPsf>>();
    Ok(sheet(&cameras.iter().map(row).collect::<Result<Vec<_>, NoPsf>>()?, ENLARGED))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contrast_is_shown_with_and_without_the_mask() {
        let plot = contrast_plot(&Camera::resolve("ring-2018").unwrap()).unwrap();
        assert_eq!(plot.series.len(), 6);
        let peak = |series: &Series| series.points.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap()[0];
        assert!(peak(&plot.series[2]) > 4.0, "blue focuses far with the mask");
        assert!(peak(&plot.series[5]) < 0.1, "and at zero without");
        assert_eq!(contrast_plot(&Camera::resolve("clear").unwrap()).unwrap().series.len(), 3);
    }

    #[test]
    fn every_response_starts_at_one() {
        let plot = mtf_plot(&Camera::resolve("clear").unwrap(), &[0.0, 5.0]).unwrap();
        assert!(plot.series.iter().all(|s| s.points[0] == [0.0, 1.0]));
        assert!(plot.series[1].points.iter().any(|p| p[1] < 0.0), "reversed contrast at 5");
    }

    #[test]
    fn a_sheet_has_a_row_a_camera_and_a_column_a_depth() {
        let camera = Camera::resolve("ring-outer").unwrap();
        let clear = without_mask(&camera);
        let settings = Settings { energy: 0.9, ..Settings::default() };
        let frame = psf_sheet(&[&camera, &clear], &[0.0, 4.0, 8.0], &settings).unwrap();
        let cell = SHOWN * ENLARGED + ENLARGED;
        assert_eq!(frame.size(), (2 * cell + ENLARGED, 3 * cell + ENLARGED));
    }
}
