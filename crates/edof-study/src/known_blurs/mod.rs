//! Blind deconvolution where the blur is known to anybody who judges it: photographs blurred with synthetic kernels, which the method has to
//! find. Rows go to a [`Journal`](crate::journal::Journal) as those of other studies.

mod kernels;
mod page;

pub use kernels::{Blur, drawn};
pub use page::{DIVERGED_DB, KnownBlurs};

use crate::experiment::Experiment;
use crate::journal::{self, Key, Line, Proof};
use crate::metrics::{BORDER, MetricError, cpu_time, psnr};
use edof_core::ColourFrame;
use edof_core::storage::provenance::Input;
use edof_deblur::blind::{self, Estimate, Settings};
use edof_deblur::hyper_laplacian::hyper_laplacian;
use edof_io::photos::Photo;
use edof_optics::blur_frame;
use kernels::best_shift;
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// What the method made of one photograph and kernel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The photograph.
    pub image: String,
    /// The kernel.
    pub blur: String,
    /// Side in pixels of the kernel that was looked for.
    pub side: usize,
    /// PSNR in dB of the blurred picture.
    #[serde(with = "crate::metrics::number")]
    pub blurred_db: f64,
    /// PSNR in dB of what the method made of it.
    #[serde(with = "crate::metrics::number")]
    pub restored_db: f64,
    /// PSNR in dB of the same last step with the true kernel.
    #[serde(with = "crate::metrics::number")]
    pub known_db: f64,
    /// Correlation of the kernel that was found with the true one, at the best shift of a few pixels.
    #[serde(with = "crate::metrics::number")]
    pub correlation: f64,
    /// How often the method's step was halved.
    pub halvings: usize,
    /// Shrinkage steps that the kernel took.
    pub steps: usize,
    /// Wall-clock seconds per megapixel.
    pub seconds_per_megapixel: f64,
    /// Seconds that all threads together were on a processor, a megapixel; none where the system does not tell.
    pub cpu_seconds_per_megapixel: Option<f64>,
    /// Hashes of the photograph and of all settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a page calls a row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Subject {
    side: usize,
    image: String,
    blur: String,
}

impl Line for Row {
    const STUDY: &'static str = "blind";
    const LAYOUT: u32 = 2;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        let Self { side, image, blur, .. } = self;
        Subject { side: *side, image: image.clone(), blur: blur.clone() }
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        Self { seconds_per_megapixel: 0.0, cpu_seconds_per_megapixel: None, ..self.clone() }
    }
}

/// The experiment: photographs blurred with every synthetic kernel.
pub struct DrawnBlurs<'a> {
    photos: &'a [Photo],
    settings: Settings,
    blurs: [Blur; 3],
}

impl<'a> DrawnBlurs<'a> {
    /// Photographs, and how kernels are looked for.
    #[must_use]
    pub fn new(photos: &'a [Photo], settings: Settings) -> Self {
        Self { photos, settings, blurs: drawn() }
    }
}

impl Experiment for DrawnBlurs<'_> {
    type Row = Row;
    /// Photograph and kernel.
    type Cell = (usize, usize);
    type Error = TooSmall;

    fn cells(&self) -> Vec<(Key<Row>, (usize, usize))> {
        let mut cells = vec![];
        for (place, photo) in self.photos.iter().enumerate() {
            let sha256 = Input::photograph(&photo.name, &photo.frame).sha256;
            for (number, blur) in self.blurs.iter().enumerate() {
                // The kernel to its last bit: arrays shorten themselves where they are written.
                let kernel: Vec<f32> = blur.psf.kernel().iter().copied().collect();
                let proof = Proof {
                    settings: Some(journal::settings(&[&self.settings, &kernel, &STEPS, &BORDER])),
                    photo: sha256.clone(),
                    ..Proof::default()
                };
                let (image, blur) = (photo.name.clone(), blur.name.to_owned());
                let subject = Subject { side: self.settings.side, image, blur };
                cells.push((Key { subject, proof }, (place, number)));
            }
        }
        cells
    }

    fn measure(&mut self, cells: &[((usize, usize), Proof)]) -> Result<Vec<Row>, TooSmall> {
        let row = |((photo, blur), proof): &((usize, usize), Proof)| {
            restore(&self.photos[*photo], proof.clone(), &self.blurs[*blur], &self.settings)
        };
        cells.iter().map(row).collect()
    }

    fn describe(&self, (photo, blur): &(usize, usize)) -> String {
        format!("{} of {}", self.blurs[*blur].name, self.photos[*photo].name)
    }
}

/// Values of a photograph's file are in steps of one 255th, and so are those of the blurred one.
const STEPS: f32 = 255.0;

/// A photograph too small to measure.
#[derive(Debug, thiserror::Error)]
#[error("{image}: {source}")]
#[allow(missing_docs, reason = "the message names the fields")]
pub struct TooSmall {
    image: String,
    source: MetricError,
}

/// Blurs a photograph, rounds it to 8 bits, finds the kernel on its grey picture, and deconvolves its colours with it.
///
/// # Errors
/// [`TooSmall`].
fn restore(photo: &Photo, proof: Proof, blur: &Blur, settings: &Settings) -> Result<Row, TooSmall> {
    let psfs = [blur.psf.clone(), blur.psf.clone(), blur.psf.clone()];
    let mut seen = blur_frame(&photo.frame, &psfs);
    seen.planes.mapv_inplace(|v| (v * STEPS).round().clamp(0.0, STEPS) / STEPS);
    let (start, cpu_start) = (Instant::now(), cpu_time::seconds());
    let grey = seen.planes.mean_axis(Axis(0)).unwrap_or_else(|| unreachable!("three colours have a mean"));
    let Estimate { kernel, halvings, steps } = blind::estimate(grey.view(), settings);
    let restored = deconvolved(&seen, kernel.view(), settings);
    let seconds = start.elapsed().as_secs_f64();
    let cpu_seconds = cpu_time::seconds().zip(cpu_start).map(|(after, before)| after - before);
    let known = deconvolved(&seen, blur.psf.kernel().view(), settings);
    let (height, width) = seen.size();
    let megapixels = (height * width) as f64 * 1e-6;
    let db = |frame: &ColourFrame| {
        psnr(&photo.frame, frame, BORDER).map_err(|source| TooSmall { image: photo.name.clone(), source })
    };
    let (shift, correlation) = best_shift(kernel.view(), blur.psf.kernel().view());
    // A kernel and a picture that are moved against each other are the same answer.
    let restored = moved(&restored, shift);
    Ok(Row {
        image: photo.name.clone(),
        blur: blur.name.into(),
        side: settings.side,
        blurred_db: db(&seen)?,
        restored_db: db(&restored)?,
        known_db: db(&known)?,
        correlation,
        halvings,
        steps,
        seconds_per_megapixel: seconds / megapixels,
        cpu_seconds_per_megapixel: cpu_seconds.map(|seconds| seconds / megapixels),
        proof,
    })
}

fn deconvolved(seen: &ColourFrame, kernel: ArrayView2<'_, f32>, settings: &Settings) -> ColourFrame {
    let planes: Vec<Array2<f32>> = (0..3)
        .into_par_iter()
        .map(|plane| hyper_laplacian(seen.planes.index_axis(Axis(0), plane), kernel, settings.prior))
        .collect();
    let mut out = seen.clone();
    out.planes.axis_iter_mut(Axis(0)).zip(&planes).for_each(|(mut to, plane)| to.assign(plane));
    out
}

/// A frame moved by whole rows and columns; its border is continued.
fn moved(frame: &ColourFrame, (rows, columns): (isize, isize)) -> ColourFrame {
    let (height, width) = frame.size();
    let at = |i: usize, by: isize, n: usize| (i as isize - by).clamp(0, n as isize - 1) as usize;
    let mut out = frame.clone();
    out.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
        *v = frame.planes[(p, at(r, rows, height), at(c, columns, width))];
    });
    out
}

#[cfg(test)]
mod tests;
