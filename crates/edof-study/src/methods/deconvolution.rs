//! Demosaicing, then deconvolution of each colour by itself, as the paper does with its blind reference: the PSF varies across colours.

use edof_core::{RawFrame, ReconstructError, Reconstruction, Reconstructor};
use edof_deblur::hyper_laplacian::{Prior, hyper_laplacian};
use edof_deblur::{Malvar, blind, known};
use edof_optics::psf::Psf;
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// How a colour plane is deconvolved.
#[derive(Debug, Clone, PartialEq)]
pub enum Deconvolution {
    /// With known kernels of red, green and blue.
    Known(Box<[Array2<f32>; 3]>, Known),
    /// With a kernel that it finds itself.
    Blind(blind::Settings),
}

/// What is done with a known kernel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Known {
    /// [`known::wiener`], with its ratio of noise to contrast.
    Wiener(f32),
    /// [`known::richardson_lucy`], with its steps.
    RichardsonLucy(usize),
    /// [`hyper_laplacian`](fn@hyper_laplacian).
    HyperLaplacian(Prior),
}

impl Deconvolution {
    /// With the kernels of a camera's PSFs.
    #[must_use]
    pub fn known(psfs: [Psf; 3], how: Known) -> Self {
        Self::Known(Box::new(psfs.map(Psf::into_kernel)), how)
    }

    /// A plane deconvolved, and the steps that took where the method goes in steps.
    fn plane(&self, channel: usize, plane: ArrayView2<'_, f32>) -> (Array2<f32>, Option<usize>) {
        match self {
            Self::Blind(settings) => {
                let found = blind::deconvolve(plane, settings);
                (found.picture, Some(found.steps))
            }
            Self::Known(kernels, how) => {
                let kernel = kernels[channel].view();
                match *how {
                    Known::Wiener(ratio) => (known::wiener(plane, kernel, ratio), None),
                    Known::RichardsonLucy(steps) => {
                        (known::richardson_lucy(plane, kernel, steps), Some(steps))
                    }
                    Known::HyperLaplacian(prior) => (hyper_laplacian(plane, kernel, prior), None),
                }
            }
        }
    }
}

/// Demosaicing after Malvar, He and Cutler (MATLAB's default), and a deconvolution of each plane; planes side by side.
#[derive(Debug, Clone)]
pub struct DeconvolutionReconstructor {
    name: String,
    how: Deconvolution,
}

impl DeconvolutionReconstructor {
    /// Under a name for reports.
    #[must_use]
    pub const fn new(name: String, how: Deconvolution) -> Self {
        Self { name, how }
    }
}

impl Reconstructor for DeconvolutionReconstructor {
    fn name(&self) -> &str {
        &self.name
    }

    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let start = Instant::now();
        let mut done = Malvar::default().reconstruct(raw)?;
        let (planes, steps): (Vec<Array2<f32>>, Vec<Option<usize>>) = (0..3)
            .into_par_iter()
            .map(|channel| self.how.plane(channel, done.frame.planes.index_axis(Axis(0), channel)))
            .unzip();
        done.frame.planes.axis_iter_mut(Axis(0)).zip(&planes).for_each(|(mut to, plane)| to.assign(plane));
        let steps: Option<usize> = steps.into_iter().sum();
        done.iterations = steps.map(|sum| sum as f64 / 3.0);
        done.seconds = start.elapsed().as_secs_f64();
        Ok(done)
    }
}
