//! What may enter a study of one depth, as data, and what each prepares before it sees a frame.

use crate::board::BoardReconstructor;
use crate::deconvolution::{Deconvolution, DeconvolutionReconstructor, Known};
use crate::dictionary::Dictionary;
use crate::method::{Family, Format, Method};
use crate::pursuit::{BLIND_DEPTHS, Pursuit, PursuitReconstructor};
use crate::untrained;
use edof_deblur::hyper_laplacian::Prior;
use edof_deblur::{Directional, Malvar, blind};
use edof_golden::GoldenReconstructor;
use edof_golden::cycle::CycleError;
use edof_gpu::{Device, GpuFloat, GpuGolden};
use edof_optics::estimator::SeenError;
use edof_optics::psf::{NoPsf, Settings, channel_psfs};
use edof_spec::fixed_network::FixedNetworkError;
use edof_spec::network::NetworkError;
use edof_spec::overlap::Overlap;
use edof_spec::{Camera, Design, FixedNetwork, Network, Noise, Reconstructor, Stride, Window};
use edof_train::reconstruct::{FloatReconstructor, Output};
use std::sync::Arc;

/// What there is to reconstruct: all that a method may know before it sees a frame. Blind ones leave ψ alone.
#[derive(Debug, Clone, Copy)]
pub struct Case<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Depth of the whole scene.
    pub psi: f64,
    /// The sensor's noise.
    pub noise: Noise,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// A method with all its settings.
#[derive(Debug, Clone)]
pub enum MethodSpec {
    /// Demosaicing after Malvar, He and Cutler.
    Malvar,
    /// Demosaicing after Menon, Andriani and Calvagno.
    Directional,
    /// Deconvolution with ψ known, or blind.
    Deconvolution(Family),
    /// A pursuit with ψ known, or blind.
    Pursuit {
        /// Which.
        family: Family,
        /// Step of the patches.
        stride: Stride,
        /// Sharp atoms.
        dictionary: Arc<Dictionary>,
    },
    /// The paper's network before training.
    Untrained {
        /// Whether DC is removed.
        family: Family,
        /// T.
        layers: usize,
        /// Step of the patches.
        stride: Stride,
        /// Sharp atoms.
        dictionary: Arc<Dictionary>,
    },
    /// A network in floating point.
    Float {
        /// Its weights.
        network: Arc<Network>,
        /// SHA-256 of their file.
        sha256: String,
        /// Step of the patches.
        stride: Stride,
    },
    /// The same on a design's calculator: its time is that of its cycles.
    Board {
        /// Its weights, made for the design's stride.
        network: Arc<FixedNetwork>,
        /// The design.
        design: Arc<Design>,
        /// Name in reports.
        name: String,
        /// SHA-256 of weights and design.
        sha256: String,
    },
    /// A network in floating point on a device behind OpenCL.
    FloatGpu {
        /// Its weights.
        network: Arc<Network>,
        /// Step of the patches.
        stride: Stride,
        /// Number of the device.
        device: usize,
        /// SHA-256 of the weights' and the device's names.
        sha256: String,
    },
    /// A network in the board's integers on a device behind OpenCL.
    FixedGpu {
        /// Its weights, made for one stride.
        network: Arc<FixedNetwork>,
        /// Name in reports.
        name: String,
        /// Number of the device.
        device: usize,
        /// SHA-256 of the weights' and the device's names.
        sha256: String,
    },
    /// A network in the board's integers.
    Fixed {
        /// Its weights, made for one stride.
        network: Arc<FixedNetwork>,
        /// Name in reports.
        name: String,
        /// SHA-256 of their file.
        sha256: String,
    },
}

/// A method that cannot be prepared.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PrepareError {
    /// Not one of ours.
    #[error("method '{0}': must be one of {list}", list = NAMES.map(|(name, _)| name).join(", "))]
    Unknown(String),
    /// A float net whose weights do not fit its form.
    #[error("net '{net}': {source}")]
    Float { net: String, source: NetworkError },
    /// A fixed net that cannot run.
    #[error("net '{net}': {source}")]
    Fixed { net: String, source: FixedNetworkError },
    /// A network that does not fit its design.
    #[error("net '{net}': {source}")]
    Board { net: String, source: CycleError },
    /// A device that is not there, or that refuses.
    #[error("net '{net}': {source}")]
    Gpu { net: String, source: edof_gpu::GpuError },
    /// A depth that the camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
    /// No dictionary of what the camera sees.
    #[error(transparent)]
    Seen(#[from] SeenError),
}

/// What users call the methods that need no weights.
const NAMES: [(&str, Family); 12] = [
    ("malvar", Family::DemosaicMalvar),
    ("directional", Family::DemosaicDirectional),
    ("wiener", Family::Wiener),
    ("richardson-lucy", Family::RichardsonLucy),
    ("hyper-laplacian", Family::HyperLaplacian),
    ("blind", Family::BlindDeconvolution),
    ("omp", Family::Omp),
    ("omp-known", Family::OmpKnownDepth),
    ("fista", Family::Fista),
    ("fista-known", Family::FistaKnownDepth),
    ("untrained", Family::Untrained),
    ("untrained-dc-removed", Family::UntrainedDcRemoved),
];

/// T of networks before training: the paper's.
const LAYERS: std::ops::RangeInclusive<usize> = 3..=10;

/// The pursuits' window: the paper's.
const WINDOW: usize = 8;
/// Settings chosen on training photographs at ψ = 8 (docs/decisions/0015-single-depth.md).
const OMP_ATOMS: usize = 16;
const FISTA_STEPS: usize = 100;
pub(crate) const FISTA_PENALTY: f32 = 0.004;
/// Variance of a difference of neighbouring pixels of photographs, and of what blur, mosaic and rounding leave unexplained: what
/// Wiener's ratio and the weight of the data are made from, with the noise's own variance.
const CONTRAST: f64 = 0.0036;
const UNEXPLAINED: f64 = 2e-5;
const RICHARDSON_LUCY_STEPS: usize = 15;
/// Side of the kernel that the blind method looks for: twice the geometric blur at ψ = 8, which is 7 pixels wide.
const BLIND_SIDE: usize = 15;
const HYPER_LAPLACIAN_ALPHA: f32 = 0.8;
const HYPER_LAPLACIAN_SHARE: f64 = 0.1;

impl MethodSpec {
    /// Methods that need no weights, by the names that users give them; pursuits at every stride.
    ///
    /// # Errors
    /// [`PrepareError::Unknown`].
    pub fn named(
        name: &str,
        strides: &[Stride],
        dictionary: &Arc<Dictionary>,
    ) -> Result<Vec<Self>, PrepareError> {
        let known = NAMES.iter().find(|(known, _)| *known == name);
        let (_, family) = known.ok_or_else(|| PrepareError::Unknown(name.to_owned()))?;
        let pursuit =
            |&stride: &Stride| Self::Pursuit { family: *family, stride, dictionary: Arc::clone(dictionary) };
        let untrained = |&stride: &Stride| {
            let (family, dictionary) = (*family, Arc::clone(dictionary));
            LAYERS.map(move |layers| Self::Untrained {
                family,
                layers,
                stride,
                dictionary: Arc::clone(&dictionary),
            })
        };
        Ok(match family {
            Family::Untrained | Family::UntrainedDcRemoved => strides.iter().flat_map(untrained).collect(),
            Family::DemosaicMalvar => vec![Self::Malvar],
            Family::DemosaicDirectional => vec![Self::Directional],
            Family::Omp | Family::OmpKnownDepth | Family::Fista | Family::FistaKnownDepth => {
                strides.iter().map(pursuit).collect()
            }
            _ => vec![Self::Deconvolution(*family)],
        })
    }

    /// All names that [`MethodSpec::named`] knows.
    #[must_use]
    pub fn names() -> [&'static str; NAMES.len()] {
        NAMES.map(|(name, _)| name)
    }

    /// Identity in rows and tables.
    #[must_use]
    pub fn method(&self) -> Method {
        match self {
            Self::Malvar => Method::demosaic(),
            Self::Directional => Method::of_frames(Family::DemosaicDirectional),
            Self::Deconvolution(family) => Method::of_frames(*family),
            Self::Pursuit { family, stride, .. } => Method::of_patches(*family, stride.pixels()),
            Self::Untrained { family, layers, stride, .. } => {
                Method::untrained(*family, stride.pixels(), *layers)
            }
            Self::Float { network, stride, .. } => {
                Method::network(&network.origin.name, Format::Float, stride.pixels(), network.form.layers)
            }
            Self::Fixed { network, name, .. } => {
                Method::network(name, Format::Fixed, network.stride.pixels(), network.form.layers)
            }
            Self::Board { network, name, .. } => {
                Method::network(name, Format::Board, network.stride.pixels(), network.form.layers)
            }
            Self::FloatGpu { network, stride, .. } => {
                Method::network(&network.origin.name, Format::FloatGpu, stride.pixels(), network.form.layers)
            }
            Self::FixedGpu { network, name, .. } => {
                Method::network(name, Format::FixedGpu, network.stride.pixels(), network.form.layers)
            }
        }
    }

    /// SHA-256 of the weights or dictionary that it reconstructs with.
    #[must_use]
    pub fn weights(&self) -> Option<&str> {
        match self {
            Self::Pursuit { dictionary, .. } | Self::Untrained { dictionary, .. } => Some(&dictionary.sha256),
            Self::Float { sha256, .. }
            | Self::Fixed { sha256, .. }
            | Self::Board { sha256, .. }
            | Self::FloatGpu { sha256, .. }
            | Self::FixedGpu { sha256, .. } => Some(sha256),
            Self::Malvar | Self::Directional | Self::Deconvolution(_) => None,
        }
    }

    /// Does everything that can be done before a frame is seen: kernels, dictionaries and what follows from them.
    ///
    /// # Errors
    /// [`PrepareError`] for a network that cannot run.
    pub fn prepare(&self, case: &Case<'_>) -> Result<Box<dyn Reconstructor>, PrepareError> {
        let name = self.method().to_string();
        Ok(match self {
            Self::Malvar => Box::new(Malvar::default()),
            Self::Directional => Box::new(Directional::default()),
            Self::Deconvolution(family) => {
                Box::new(DeconvolutionReconstructor::new(name, deconvolution(*family, case)?))
            }
            Self::Pursuit { family, stride, dictionary } => {
                let one = [case.psi];
                let psis: &[f64] = match family {
                    Family::OmpKnownDepth | Family::FistaKnownDepth => &one,
                    _ => &BLIND_DEPTHS,
                };
                let pursuit = match family {
                    Family::Omp | Family::OmpKnownDepth => Pursuit::Omp { atoms: OMP_ATOMS },
                    _ => Pursuit::Fista { steps: FISTA_STEPS, penalty: FISTA_PENALTY },
                };
                let geometry = (window(), *stride);
                Box::new(PursuitReconstructor::new(name, dictionary, case.camera, psis, geometry, pursuit)?)
            }
            Self::Untrained { family, layers, stride, dictionary } => {
                let dc_removed = *family == Family::UntrainedDcRemoved;
                let (camera, penalty) = (case.camera, FISTA_PENALTY);
                let network =
                    untrained::network(&name, dictionary, camera, window(), *layers, dc_removed, penalty)?;
                float(network, *stride, name)?
            }
            Self::Float { network, stride, .. } => float((**network).clone(), *stride, name)?,
            Self::FloatGpu { network, stride, device, .. } => {
                let gpu = Device::open(Some(*device)).and_then(|device| {
                    GpuFloat::new(device, (**network).clone(), *stride, Overlap::default())
                });
                Box::new(gpu.map_err(|source| PrepareError::Gpu { net: name, source })?)
            }
            Self::FixedGpu { network, device, .. } => {
                let gpu = Device::open(Some(*device))
                    .and_then(|device| GpuGolden::new(device, (**network).clone(), &name));
                Box::new(gpu.map_err(|source| PrepareError::Gpu { net: name, source })?)
            }
            Self::Board { network, design, .. } => {
                let board = BoardReconstructor::new(network, design, name.clone());
                Box::new(board.map_err(|source| PrepareError::Board { net: name, source })?)
            }
            Self::Fixed { network, .. } => {
                let golden = GoldenReconstructor::new((**network).clone(), name.clone());
                Box::new(golden.map_err(|source| PrepareError::Fixed { net: name, source })?)
            }
        })
    }
}

fn window() -> Window {
    Window::new(WINDOW).unwrap_or_else(|e| unreachable!("{e}"))
}

fn float(network: Network, stride: Stride, net: String) -> Result<Box<dyn Reconstructor>, PrepareError> {
    let float = FloatReconstructor::new(network, stride, Overlap::default(), Output::Rgb);
    Ok(Box::new(float.map_err(|source| PrepareError::Float { net, source })?))
}

/// What a picture of middle light is: there the noise of photons is judged.
const MIDDLE_LIGHT: f64 = 0.25;

/// Wiener's ratio of noise to contrast.
pub(crate) fn wiener_ratio(noise: Noise) -> f32 {
    ((noise.variance(MIDDLE_LIGHT) + UNEXPLAINED) / CONTRAST) as f32
}

/// A deconvolution for a case; the blind one takes nothing from it.
fn deconvolution(family: Family, case: &Case<'_>) -> Result<Deconvolution, NoPsf> {
    let variance = case.noise.variance(MIDDLE_LIGHT) + UNEXPLAINED;
    let how = match family {
        Family::Wiener => Known::Wiener(wiener_ratio(case.noise)),
        Family::RichardsonLucy => Known::RichardsonLucy(RICHARDSON_LUCY_STEPS),
        Family::HyperLaplacian => Known::HyperLaplacian(Prior {
            lambda: (HYPER_LAPLACIAN_SHARE / variance) as f32,
            alpha: HYPER_LAPLACIAN_ALPHA,
        }),
        _ => {
            return Ok(Deconvolution::Blind(blind::Settings {
                side: BLIND_SIDE,
                ..blind::Settings::default()
            }));
        }
    };
    Ok(Deconvolution::known(channel_psfs(case.camera, case.psi, &case.optics)?, how))
}
