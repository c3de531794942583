//! Settings of the methods that have any, as values. A method is prepared from the very value that its rows' hash is taken of
//! ([`MethodSpec::settings`](crate::methods::spec::MethodSpec::settings)), so no number can change without it.
//!
//! The usual ones were chosen on training photographs at ψ = 8 (docs/decisions/0015-single-depth.md).

use crate::methods::method::Family;
use edof_core::overlap::Overlap;
use edof_core::{Noise, Stride, Window};
use edof_deblur::blind;
use edof_deblur::hyper_laplacian::Prior;
use edof_network::float::reconstruct::Output;

/// How codes are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pursuit {
    /// N atoms by orthogonal matching pursuit.
    Omp {
        /// Atoms besides the colours' own.
        atoms: usize,
    },
    /// The minimum of ½‖y − B·D·z‖² + μ‖z‖₁ by FISTA.
    Fista {
        /// The most steps.
        steps: usize,
        /// μ, for light of 0…1.
        penalty: f32,
        /// Codes of light of 0…1 that move by less than this stand still.
        tolerance: f32,
    },
}

impl Pursuit {
    /// The usual matching pursuit.
    pub const OMP: Self = Self::Omp { atoms: 16 };
    /// The usual FISTA.
    pub const FISTA: Self = Self::Fista { steps: 100, penalty: PENALTY, tolerance: 1e-4 };

    /// Atoms or steps at most.
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::Omp { atoms } => atoms,
            Self::Fista { steps, .. } => steps,
        }
    }

    /// The same in at most N steps, where it goes in steps.
    #[must_use]
    pub const fn in_steps(self, steps: usize) -> Self {
        match self {
            Self::Fista { penalty, tolerance, .. } => Self::Fista { steps, penalty, tolerance },
            omp @ Self::Omp { .. } => omp,
        }
    }
}

/// μ of FISTA, and of the networks that nobody trained.
const PENALTY: f32 = 0.004;
/// Side of the raw window: the paper's.
const WINDOW: usize = 8;
/// The depths of the paper's D_Ψ.
pub const BLIND_DEPTHS: [f64; 8] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];

/// Depths that a dictionary holds its atoms at.
#[derive(Debug, Clone, PartialEq)]
pub enum Depths {
    /// That of the scene, which the method knows.
    Known,
    /// These, whatever the scene's.
    Of(Vec<f64>),
}

/// Settings of a pursuit.
#[derive(Debug, Clone, PartialEq)]
pub struct PursuitSettings {
    /// How codes are found.
    pub pursuit: Pursuit,
    /// Depths of the dictionary.
    pub depths: Depths,
    /// Side of the raw window.
    pub window: Window,
    /// Step of the patches.
    pub stride: Stride,
}

impl PursuitSettings {
    /// The usual ones of a pursuit.
    #[must_use]
    pub fn usual(pursuit: Pursuit, depths: Depths, stride: Stride) -> Self {
        Self { pursuit, depths, window: window(), stride }
    }

    /// Which family of methods it belongs to.
    #[must_use]
    pub const fn family(&self) -> Family {
        match (self.pursuit, &self.depths) {
            (Pursuit::Omp { .. }, Depths::Known) => Family::OmpKnownDepth,
            (Pursuit::Omp { .. }, Depths::Of(_)) => Family::Omp,
            (Pursuit::Fista { .. }, Depths::Known) => Family::FistaKnownDepth,
            (Pursuit::Fista { .. }, Depths::Of(_)) => Family::Fista,
        }
    }
}

/// Settings of a float network besides its weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FloatSettings {
    /// Step of the patches.
    pub stride: Stride,
    /// How overlapping patches are averaged.
    pub overlap: Overlap,
    /// Format of the picture.
    pub output: Output,
    /// The most non-zeros of a patch after each shrinkage.
    pub budget: Option<usize>,
}

impl FloatSettings {
    /// RGB at a stride, no budget.
    #[must_use]
    pub fn at(stride: Stride) -> Self {
        Self { stride, overlap: Overlap::default(), output: Output::Rgb, budget: None }
    }
}

/// Settings of a network that nobody trained.
#[derive(Debug, Clone, PartialEq)]
pub struct UntrainedSettings {
    /// T.
    pub layers: usize,
    /// Whether each colour's mean is taken out.
    pub dc_removed: bool,
    /// μ, for light of 0…1.
    pub penalty: f32,
    /// Depths whose views of an atom are averaged.
    pub depths: Vec<f64>,
    /// Side of the raw window.
    pub window: Window,
    /// How the network runs.
    pub float: FloatSettings,
}

impl UntrainedSettings {
    /// The usual ones for T layers.
    #[must_use]
    pub fn usual(layers: usize, dc_removed: bool, stride: Stride) -> Self {
        let (depths, float) = (BLIND_DEPTHS.to_vec(), FloatSettings::at(stride));
        Self { layers, dc_removed, penalty: PENALTY, depths, window: window(), float }
    }

    /// Which family of methods it belongs to.
    #[must_use]
    pub const fn family(&self) -> Family {
        if self.dc_removed { Family::UntrainedDcRemoved } else { Family::Untrained }
    }
}

/// What a filter takes a picture and its noise for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureModel {
    /// Variance of a difference of neighbouring pixels of photographs.
    pub contrast: f64,
    /// Variance that blur, mosaic and rounding leave unexplained.
    pub unexplained: f64,
    /// What a picture of middle light is: there the noise of photons is judged.
    pub middle_light: f64,
}

impl Default for PictureModel {
    fn default() -> Self {
        Self { contrast: 0.0036, unexplained: 2e-5, middle_light: 0.25 }
    }
}

impl PictureModel {
    /// Variance of everything except the picture.
    fn variance(&self, noise: Noise) -> f64 {
        noise.variance(self.middle_light) + self.unexplained
    }
}

/// Settings of a deconvolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DeconvolutionSettings {
    /// Wiener's filter with the PSF known.
    Wiener {
        /// What its ratio of noise to contrast is made from.
        model: PictureModel,
        /// The noise that it is prepared for, where that is not the sensor's.
        noise: Option<Noise>,
    },
    /// Richardson and Lucy's steps with the PSF known.
    RichardsonLucy {
        /// How many.
        steps: usize,
    },
    /// The prior of Krishnan and Fergus with the PSF known.
    HyperLaplacian {
        /// What the weight of the data is made from.
        model: PictureModel,
        /// λ times the variance of the noise.
        share: f64,
        /// α of the prior.
        alpha: f32,
    },
    /// Blind deconvolution of each colour.
    Blind(blind::Settings),
}

impl DeconvolutionSettings {
    /// The usual ones: Wiener, Richardson and Lucy, hyper-Laplacian, blind.
    #[must_use]
    pub fn usual() -> [Self; 4] {
        let model = PictureModel::default();
        // Side of the kernel: twice the geometric blur at ψ = 8, which is 7 pixels wide.
        let blind = blind::Settings { side: 15, ..blind::Settings::default() };
        [
            Self::Wiener { model, noise: None },
            Self::RichardsonLucy { steps: 15 },
            Self::HyperLaplacian { model, share: 0.1, alpha: 0.8 },
            Self::Blind(blind),
        ]
    }

    /// Which family of methods it belongs to.
    #[must_use]
    pub const fn family(&self) -> Family {
        match self {
            Self::Wiener { .. } => Family::Wiener,
            Self::RichardsonLucy { .. } => Family::RichardsonLucy,
            Self::HyperLaplacian { .. } => Family::HyperLaplacian,
            Self::Blind(_) => Family::BlindDeconvolution,
        }
    }

    /// Wiener's ratio of noise to contrast.
    pub fn wiener_ratio(model: &PictureModel, noise: Noise) -> f32 {
        (model.variance(noise) / model.contrast) as f32
    }

    /// Weights of the hyper-Laplacian prior.
    pub fn prior(model: &PictureModel, share: f64, alpha: f32, noise: Noise) -> Prior {
        Prior { lambda: (share / model.variance(noise)) as f32, alpha }
    }
}

fn window() -> Window {
    Window::new(WINDOW).unwrap_or_else(|e| unreachable!("{e}"))
}
