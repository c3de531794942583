//! How contrast falls with spatial frequency and with depth (the two parts of the paper's Figure 1).

use crate::psf::support::otf_support;
use crate::psf::{self, NoPsf, Psf, Settings, otf_along_row, wavefront, wavelengths};
use edof_core::Channel;
use edof_core::camera::{Camera, Spectrum, Symmetry};
use edof_numerics::fft::Complex64;
use edof_numerics::sinc;
use ndarray::{Array1, Axis};
use rayon::prelude::*;

/// Samples per cycle a pixel of an OTF that is taken from a PSF.
const SUPPORT: usize = 256;
/// Wavelengths that stand for a channel with a spectrum.
const WAVELENGTHS: usize = 9;

/// What the contrast is measured of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Footprint {
    /// The lens alone.
    Lens,
    /// The lens and the square of a pixel that collects its light.
    LensAndPixel,
}

/// The optical transfer function along a line of pixels. Behind a round pupil it is real; negative values are reversed contrast, and the MTF
/// is its magnitude. Behind others it is the magnitude itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Otf {
    /// Spacing of the samples in cycles per millimetre; the first is at zero.
    pub step_per_mm: f64,
    /// Contrast, −1…1, up to the cut-off.
    pub values: Array1<f64>,
}

impl Otf {
    /// Returns the frequency of the last sample in cycles per millimetre.
    #[must_use]
    pub fn end_per_mm(&self) -> f64 {
        self.step_per_mm * self.values.len().saturating_sub(1) as f64
    }

    /// Contrast at a frequency in cycles per millimetre, linear between samples, zero beyond the cut-off.
    #[must_use]
    pub fn at(&self, per_mm: f64) -> f64 {
        let position = per_mm / self.step_per_mm;
        let index = position.floor() as usize;
        let value = |i: usize| self.values.get(i).copied().unwrap_or(0.0);
        let part = position - index as f64;
        value(index) * (1.0 - part) + value(index + 1) * part
    }
}

/// Returns the OTF of a channel along a row of pixels, for an object at `psi`: the first of [`otfs`].
///
/// # Errors
/// [`NoPsf`].
pub fn otf(camera: &Camera, channel: Channel, psi: f64, footprint: Footprint) -> Result<Otf, NoPsf> {
    otfs(camera, channel, psi, footprint).map(|[along_row, _]| along_row)
}

/// Returns the OTF of a channel along a row of pixels and along a column, for an object at `psi`: the magnitude, where it is not real. Of a bank it is taken from the
/// PSF and ends where pixels see no farther, at half a cycle a pixel; the lens alone is then what the pixel's footprint leaves when it is divided out, with
/// all that pixels fold over.
///
/// # Errors
/// [`NoPsf`].
pub fn otfs(camera: &Camera, channel: Channel, psi: f64, footprint: Footprint) -> Result<[Otf; 2], NoPsf> {
    psf::check(camera, psi)?;
    if camera.psf_bank.is_some() {
        let psf = psf::psf(camera, channel, psi, &Settings::default())?;
        return Ok(otfs_of_psf(camera, &psf, footprint));
    }
    let spectrum = camera.spectrum(channel);
    let lines = match spectrum {
        Spectrum::Line(nm) => vec![*nm],
        Spectrum::Sampled(_) => wavelengths(spectrum, WAVELENGTHS),
    };
    if !has_one_response(camera) {
        return Ok(otfs_of_wavefront(camera, &lines, psi, footprint));
    }
    let support = otf_support(camera, psi);
    let otfs: Vec<_> = lines.iter().map(|&nm| otf_along_row(camera, nm, psi, support)).collect();
    let length = otfs.iter().map(Array1::len).max().unwrap_or(0);
    let mean = |q: usize| otfs.iter().filter_map(|o| o.get(q)).sum::<f64>() / otfs.len() as f64;
    let along_row = Otf {
        step_per_mm: step_per_mm(camera, support),
        values: (0..length).map(|q| mean(q) * of_pixel(footprint, q, support)).collect(),
    };
    Ok([along_row.clone(), along_row])
}

/// The OTFs of a pupil that is not round, with equal shares of light at some wavelengths.
fn otfs_of_wavefront(camera: &Camera, lines: &[f64], psi: f64, footprint: Footprint) -> [Otf; 2] {
    let wanted = otf_support(camera, psi);
    let supports = lines.iter().map(|&nm| wavefront::support(camera, nm, psi, wanted).0);
    let support = supports.max().unwrap_or(wanted);
    let each: Vec<[Vec<Complex64>; 2]> =
        lines.iter().map(|&nm| wavefront::otf_along_axes(camera, nm, psi, support)).collect();
    [0, 1].map(|axis| {
        let length = each.iter().map(|both| both[axis].len()).max().unwrap_or(0);
        let mean = |q: usize| {
            each.iter().filter_map(|both| both[axis].get(q)).sum::<Complex64>() / each.len() as f64
        };
        let response: Vec<Complex64> = (0..length).map(mean).collect();
        let is_real = response.iter().all(|v| v.im.abs() < 1e-9);
        let contrast = |v: &Complex64| if is_real { v.re } else { v.norm() };
        let value = |(q, v): (usize, &Complex64)| contrast(v) * of_pixel(footprint, q, support);
        Otf {
            step_per_mm: step_per_mm(camera, support),
            values: response.iter().enumerate().map(value).collect(),
        }
    })
}

/// What a pixel's footprint leaves of the contrast at `q`/`support` cycles a pixel.
fn of_pixel(footprint: Footprint, q: usize, support: usize) -> f64 {
    match footprint {
        Footprint::Lens => 1.0,
        Footprint::LensAndPixel => sinc(q as f64 / support as f64),
    }
}

/// Returns the OTF along a row of pixels and along a column of a PSF that is known, as [`otfs`] does of a bank's.
#[must_use]
pub fn otfs_of_psf(camera: &Camera, psf: &Psf, footprint: Footprint) -> [Otf; 2] {
    let step_per_mm = step_per_mm(camera, SUPPORT);
    contrasts_of(psf, footprint).map(|values| Otf { step_per_mm, values })
}

fn step_per_mm(camera: &Camera, support: usize) -> f64 {
    1e3 / (support as f64 * camera.pixel_pitch_um)
}

/// Returns whether a camera's response is the same along every direction: it is computed, and its pupil is round.
#[must_use]
pub fn has_one_response(camera: &Camera) -> bool {
    camera.psf_bank.is_none() && camera.symmetry() != Symmetry::None
}

/// Contrast along a row of pixels and along a column, up to half a cycle a pixel.
fn contrasts_of(psf: &Psf, footprint: Footprint) -> [Array1<f64>; 2] {
    let [upside_down, left_right, _] = psf.symmetries();
    let frequencies: Vec<f64> = (0..=SUPPORT / 2).map(|q| q as f64 / SUPPORT as f64).collect();
    let responses = sampled_otf(psf, &frequencies);
    [0, 1].map(|direction| {
        let value = |(frequency, both): (&f64, &[Complex64; 2])| {
            let response = both[direction];
            let contrast = if upside_down && left_right { response.re } else { response.norm() };
            match footprint {
                Footprint::Lens => contrast / sinc(*frequency),
                Footprint::LensAndPixel => contrast,
            }
        };
        frequencies.iter().zip(&responses).map(value).collect()
    })
}

/// Fourier transform of a PSF as pixels sample it, about its middle, at frequencies in cycles a pixel: each along a row and along a column.
#[must_use]
pub fn sampled_otf(psf: &Psf, cycles_per_pixel: &[f64]) -> Vec<[Complex64; 2]> {
    let half = (psf.side() / 2) as f64;
    let light = psf.kernel().mapv(f64::from);
    // Sums over columns of pixels are the spread along a row.
    let spreads = [Axis(0), Axis(1)].map(|axis| light.sum_axis(axis));
    let response = |cycles: &f64| {
        spreads.each_ref().map(|spread| {
            let angle = |i: usize| -std::f64::consts::TAU * cycles * (i as f64 - half);
            spread.iter().enumerate().map(|(i, v)| Complex64::from_polar(*v, angle(i))).sum()
        })
    };
    cycles_per_pixel.iter().map(response).collect()
}

/// The diffraction limit 1/(λF#) at a wavelength, in cycles per millimetre.
#[must_use]
pub fn cutoff_per_mm(camera: &Camera, wavelength_nm: f64) -> f64 {
    1e3 / camera.wave_um(wavelength_nm)
}

/// The diffraction limit that plots refer to: that of green's middle wavelength.
#[must_use]
pub fn green_cutoff_per_mm(camera: &Camera) -> f64 {
    cutoff_per_mm(camera, wavelengths(camera.spectrum(Channel::Green), 1)[0])
}

/// Contrast of red, green and blue at one frequency (cycles per millimetre) for each ψ: through focus.
///
/// # Errors
/// [`NoPsf`].
pub fn through_focus(
    camera: &Camera,
    per_mm: f64,
    psis: &[f64],
    footprint: Footprint,
) -> Result<Vec<[f64; 3]>, NoPsf> {
    let contrast = |&psi: &f64| -> Result<[f64; 3], NoPsf> {
        let [red, green, blue] = Channel::ALL.map(|channel| otf(camera, channel, psi, footprint));
        Ok([red?.at(per_mm), green?.at(per_mm), blue?.at(per_mm)])
    };
    psis.par_iter().map(contrast).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bank;
    use crate::bound::lenses::Cubic;
    use crate::psf::channel_psfs;
    use edof_core::camera::{Kernels, Mask, PsfBank};

    const PSIS: [f64; 9] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];

    fn contrast(name: &str, footprint: Footprint) -> Vec<[f64; 3]> {
        let camera = Camera::resolve(name).unwrap();
        through_focus(&camera, green_cutoff_per_mm(&camera) / 4.0, &PSIS, footprint).unwrap()
    }

    #[test]
    fn ring_2018_focuses_red_green_and_blue_at_different_depths() {
        for footprint in [Footprint::Lens, Footprint::LensAndPixel] {
            let curves = contrast("ring-2018", footprint);
            let peak =
                |channel: usize| (0..9).max_by(|&a, &b| curves[a][channel].total_cmp(&curves[b][channel]));
            assert_eq!([0, 1, 2].map(peak), [Some(1), Some(3), Some(5)]);
        }
    }

    #[test]
    fn a_clear_aperture_loses_contrast_beyond_one_and_all_of_it_by_six() {
        let curves = contrast("clear", Footprint::Lens);
        let green = |psi: usize| curves[psi][1];
        assert!(green(1) > 0.9 * green(0), "little is lost up to 1");
        assert!(green(2) < 0.85 * green(0) && green(4) < 0.5 * green(0), "contrast loss beyond 1");
        assert!(green(6).abs() < 0.02, "gone by 6: {}", green(6));
    }

    #[test]
    fn a_clear_aperture_reverses_contrast_at_some_frequency_beyond_four() {
        let camera = Camera::resolve("clear").unwrap();
        let lowest = |psi: f64| {
            let values = otf(&camera, Channel::Green, psi, Footprint::Lens).unwrap().values;
            values.iter().copied().fold(f64::INFINITY, f64::min)
        };
        assert!(lowest(4.0) > -1e-3, "no reversal up to 4");
        assert!(lowest(5.0) < -0.01, "reversal at 5");
        assert!(lowest(6.0) < 2.0 * lowest(5.0), "more of it at 6");
    }

    #[test]
    fn the_pixel_takes_its_share_of_the_contrast() {
        let camera = Camera::resolve("clear").unwrap();
        let nyquist = 500.0 / camera.pixel_pitch_um;
        let lens = otf(&camera, Channel::Green, 0.0, Footprint::Lens).unwrap().at(nyquist);
        let both = otf(&camera, Channel::Green, 0.0, Footprint::LensAndPixel).unwrap().at(nyquist);
        assert!((both / lens - std::f64::consts::FRAC_2_PI).abs() < 1e-3);
    }

    #[test]
    fn a_narrow_spectrum_sees_what_its_line_sees() {
        let line = Camera::resolve("ring-2018").unwrap();
        let mut narrow = line.clone();
        narrow.spectra[1] = Spectrum::Sampled(vec![[534.9, 1.0], [535.1, 1.0]]);
        let [a, b] =
            [&line, &narrow].map(|c| otf(c, Channel::Green, 3.0, Footprint::Lens).unwrap().at(100.0));
        assert!((a - b).abs() < 1e-3);
    }

    /// The autocorrelation of the pupil by its definition, point by point: a peer that shares nothing with the transforms but the phase.
    #[test]
    fn a_cubic_lens_has_the_contrast_of_its_pupils_autocorrelation() {
        let camera = Cubic { strength: 6.0, mixed: 0.0 }.on(&Camera::resolve("clear-mid").unwrap());
        let nm = camera.reference_wavelength_nm;
        let per_mm = green_cutoff_per_mm(&camera) / 4.0;
        // A shift of the pupil by twice the share of the cut-off, in radii.
        let shift = 2.0 * per_mm / cutoff_per_mm(&camera, nm);
        const POINTS: i32 = 400;
        for psi in [0.0, 4.0, 7.0] {
            let phase = |x: f64, y: f64| {
                let cubic = 6.0 * (x.powi(3) + y.powi(3));
                (x * x + y * y <= 1.0).then_some((psi - camera.focus_psi) * (x * x + y * y) + cubic)
            };
            let (mut sum, mut light) = (Complex64::new(0.0, 0.0), 0.0);
            for i in -POINTS..=POINTS {
                for j in -POINTS..=POINTS {
                    let [x, y] = [i, j].map(|i| 1.2 * f64::from(i) / f64::from(POINTS));
                    light += f64::from(u8::from(phase(x, y).is_some()));
                    if let (Some(a), Some(b)) = (phase(x + shift / 2.0, y), phase(x - shift / 2.0, y)) {
                        sum += Complex64::from_polar(1.0, a - b);
                    }
                }
            }
            let expected = sum.norm() / light;
            let both = otfs(&camera, Channel::Blue, psi, Footprint::Lens).unwrap();
            for otf in both {
                let found = otf.at(per_mm);
                assert!((found - expected).abs() < 0.01, "psi {psi}: {found}, expected {expected}");
                assert!(otf.at(0.98 * cutoff_per_mm(&camera, nm)) < 0.01);
                assert!((otf.end_per_mm() / cutoff_per_mm(&camera, nm) - 1.0).abs() < 0.05);
            }
        }
    }

    #[test]
    fn a_blur_along_columns_costs_contrast_along_columns_alone() {
        let camera = Camera::resolve("clear").unwrap();
        // Two equal points, one above the other: the response is |cos(πf)| at f cycles a pixel.
        let points =
            ndarray::Array4::from_shape_fn(
                (1, 3, 3, 3),
                |(_, _, row, column)| {
                    if column == 1 && row < 2 { 0.5 } else { 0.0 }
                },
            );
        let kernels = Kernels::new(vec![0.0], points.view(), None).unwrap();
        let bank =
            PsfBank { file: "x".into(), sha256: String::new(), centre: false, kernels: Some(kernels.into()) };
        let camera = Camera { psf_bank: Some(bank), ..camera };
        let per_mm = 1e3 / camera.pixel_pitch_um / 4.0;
        let both = otfs(&camera, Channel::Green, 0.0, Footprint::LensAndPixel).unwrap();
        let [row, column] = both.map(|otf| {
            assert!((otf.end_per_mm() - 2.0 * per_mm).abs() < 1e-9);
            otf.at(per_mm)
        });
        assert!((row - 1.0).abs() < 1e-6, "{row}");
        assert!((column - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-6, "{column}");
        assert!(has_one_response(&Camera::resolve("ring-outer").unwrap()) && !has_one_response(&camera));
    }

    #[test]
    fn a_bank_of_a_lenss_own_psfs_has_the_lenss_contrast() {
        let lens = Camera::resolve("ring-2018").unwrap();
        let camera_pitch_um = lens.pixel_pitch_um;
        let psfs = channel_psfs(&lens, 3.0, &Settings::default()).unwrap();
        let stack = bank::stacked(&[psfs.each_ref().map(|psf| psf.kernel())]).mapv(f64::from);
        let kernels = Kernels::new(vec![3.0], stack.view(), None).unwrap();
        let own =
            PsfBank { file: "x".into(), sha256: String::new(), centre: false, kernels: Some(kernels.into()) };
        let banked = Camera { psf_bank: Some(own), mask: Mask::default(), ..lens.clone() };
        for (channel, per_mm) in [(Channel::Red, 40.0), (Channel::Green, 90.0), (Channel::Blue, 120.0)] {
            let [lens, banked] =
                [&lens, &banked].map(|c| otf(c, channel, 3.0, Footprint::LensAndPixel).unwrap());
            // What pixels sample holds the frequencies that they fold over, too.
            let pitch = 1e3 / camera_pitch_um;
            let expected = lens.at(per_mm) + lens.at(pitch - per_mm) + lens.at(pitch + per_mm);
            let found = banked.at(per_mm);
            assert!((found - expected).abs() < 1e-2, "{channel:?} at {per_mm}: {found}, expected {expected}");
        }
        assert!(otf(&banked, Channel::Green, 4.0, Footprint::Lens).is_err(), "the bank ends at 3");
    }
}
