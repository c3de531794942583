//! What may enter a study of one depth, as data, and what each prepares before it sees a frame.

use crate::key::KeyText;
use crate::methods::board::BoardReconstructor;
use crate::methods::by_noise::ByNoise;
use crate::methods::deconvolution::{Deconvolution, DeconvolutionReconstructor, Known};
use crate::methods::dictionary::Dictionary;
use crate::methods::external::{ExternalError, ExternalReconstructor, ExternalSettings, Program};
use crate::methods::method::{Family, Format, Method};
use crate::methods::pursuit::PursuitReconstructor;
use crate::methods::settings::{
    BLIND_DEPTHS, DeconvolutionSettings, Depths, FloatSettings, Pursuit, PursuitSettings, UntrainedSettings,
};
use crate::methods::untrained;
use edof_core::camera::Camera;
use edof_core::storage::digest::sha256;
use edof_core::{Noise, Reconstructor, Stride};
use edof_deblur::{Directional, Malvar};
use edof_device::Design;
use edof_golden::GoldenReconstructor;
use edof_golden::cycle::CycleError;
use edof_gpu::{Device, GpuFloat, GpuGolden};
use edof_network::fixed_network::{FixedMatrix, FixedNetworkError};
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_network::network::NetworkError;
use edof_network::{FixedNetwork, Network};
use edof_optics::estimator::SeenError;
use edof_optics::psf::{NoPsf, Settings, channel_psfs};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;
use std::time::Instant;

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
    Deconvolution(DeconvolutionSettings),
    /// A pursuit with ψ known, or blind.
    Pursuit {
        /// Which, and how.
        settings: PursuitSettings,
        /// Sharp atoms.
        dictionary: Arc<Dictionary>,
    },
    /// The paper's network before training.
    Untrained {
        /// How many layers, and how.
        settings: UntrainedSettings,
        /// Sharp atoms.
        dictionary: Arc<Dictionary>,
    },
    /// A network in floating point.
    Float {
        /// Weights of the network.
        network: Arc<Network>,
        /// SHA-256 of their file.
        sha256: String,
        /// Step of the patches and format of the picture.
        settings: FloatSettings,
    },
    /// The same on a design's calculator: its time is that of its cycles.
    Board {
        /// Weights of the network, made for the design's stride.
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
        /// Weights of the network.
        network: Arc<Network>,
        /// Step of the patches.
        settings: FloatSettings,
        /// Number of the device.
        device: usize,
        /// SHA-256 of the weights' and the device's names.
        sha256: String,
    },
    /// A network in the board's integers on a device behind OpenCL.
    FixedGpu {
        /// Weights of the network, made for one stride.
        network: Arc<FixedNetwork>,
        /// Name in reports.
        name: String,
        /// Number of the device.
        device: usize,
        /// SHA-256 of the weights' and the device's names.
        sha256: String,
    },
    /// Anybody's program.
    External {
        /// The command, and its process if there is one for all frames.
        program: Program,
        /// SHA-256 of the command and of the files that it names.
        sha256: String,
    },
    /// Several networks, one for each range of noise.
    ByNoise(Box<ByNoise<Self>>),
    /// A network in the board's integers.
    Fixed {
        /// Weights of the network, made for one stride.
        network: Arc<FixedNetwork>,
        /// Name in reports.
        name: String,
        /// SHA-256 of their file, or of their words ([`words_sha256`]).
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
    /// A device that is not there, or that rejects.
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
        let pursuit = |how: Pursuit, depths: Depths| {
            let of = |&stride: &Stride| Self::Pursuit {
                settings: PursuitSettings::usual(how, depths.clone(), stride),
                dictionary: Arc::clone(dictionary),
            };
            strides.iter().map(of).collect::<Vec<_>>()
        };
        let untrained = |dc_removed: bool| {
            let of = |stride: Stride, layers: usize| Self::Untrained {
                settings: UntrainedSettings::usual(layers, dc_removed, stride),
                dictionary: Arc::clone(dictionary),
            };
            strides
                .iter()
                .flat_map(|&stride| LAYERS.map(move |layers| (stride, layers)))
                .map(|(stride, layers)| of(stride, layers))
                .collect()
        };
        let every = || Depths::Of(BLIND_DEPTHS.to_vec());
        Ok(match family {
            Family::DemosaicMalvar => vec![Self::Malvar],
            Family::DemosaicDirectional => vec![Self::Directional],
            Family::Omp => pursuit(Pursuit::OMP, every()),
            Family::OmpKnownDepth => pursuit(Pursuit::OMP, Depths::Known),
            Family::Fista => pursuit(Pursuit::FISTA, every()),
            Family::FistaKnownDepth => pursuit(Pursuit::FISTA, Depths::Known),
            Family::Untrained => untrained(false),
            Family::UntrainedDcRemoved => untrained(true),
            Family::Wiener | Family::RichardsonLucy | Family::HyperLaplacian | Family::BlindDeconvolution => {
                let usual = DeconvolutionSettings::usual().into_iter();
                usual.filter(|settings| settings.family() == *family).map(Self::Deconvolution).collect()
            }
            Family::Network | Family::External => unreachable!("neither has a name here"),
        })
    }

    /// A user's program, written as [`FORMS`](crate::methods::external::FORMS), which may take N seconds.
    ///
    /// # Errors
    /// [`ExternalError`].
    pub fn external(command: &str, seconds: u64) -> Result<Self, ExternalError> {
        let settings = ExternalSettings::new(command, seconds)?;
        Ok(Self::External { sha256: settings.sha256(), program: Program::new(settings) })
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
            Self::Deconvolution(settings) => Method::of_frames(settings.family()),
            Self::Pursuit { settings, .. } => Method::of_patches(settings.family(), settings.stride.pixels()),
            Self::Untrained { settings, .. } => {
                Method::untrained(settings.family(), settings.float.stride.pixels(), settings.layers)
            }
            Self::Float { network, settings, .. } => {
                let format = match settings.output {
                    Output::Rgb => Format::Float,
                    Output::Ycc422 => Format::Float422,
                };
                of_float(network, format, settings)
            }
            Self::FloatGpu { network, settings, .. } => of_float(network, Format::FloatGpu, settings),
            Self::External { program, .. } => Method::external(program.settings.name()),
            Self::Fixed { network, name, .. } => of_fixed(network, Format::Fixed, name),
            Self::Board { network, name, .. } => of_fixed(network, Format::Board, name),
            Self::FixedGpu { network, name, .. } => of_fixed(network, Format::FixedGpu, name),
            Self::ByNoise(networks) => networks.method(Self::method),
        }
    }

    /// Every setting that it is prepared from, as [`KeyText`]; those of fixed networks are in their weights.
    #[must_use]
    pub fn settings(&self) -> String {
        match self {
            Self::Malvar | Self::Directional => String::new(),
            Self::Deconvolution(settings) => settings.key_text(),
            Self::Pursuit { settings, .. } => settings.key_text(),
            Self::Untrained { settings, .. } => settings.key_text(),
            Self::Float { settings, .. } | Self::FloatGpu { settings, .. } => settings.key_text(),
            Self::ByNoise(networks) => networks.settings(Self::settings),
            // How long it may take makes no other picture.
            Self::External { program, .. } => program.settings.command.clone(),
            Self::Fixed { .. } | Self::Board { .. } | Self::FixedGpu { .. } => String::new(),
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
            | Self::External { sha256, .. }
            | Self::FixedGpu { sha256, .. } => Some(sha256),
            Self::ByNoise(networks) => Some(networks.weights()),
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
            Self::Deconvolution(settings) => {
                Box::new(DeconvolutionReconstructor::new(name, deconvolution(settings, case)?))
            }
            Self::Pursuit { settings, dictionary } => {
                Box::new(PursuitReconstructor::new(name, dictionary, case.camera, case.psi, settings)?)
            }
            Self::Untrained { settings, dictionary } => {
                float(untrained::network(&name, dictionary, case.camera, settings)?, &settings.float, name)?
            }
            Self::Float { network, settings, .. } => float((**network).clone(), settings, name)?,
            Self::FloatGpu { network, settings, device, .. } => {
                let gpu = Device::open(Some(*device)).and_then(|device| {
                    GpuFloat::new(device, (**network).clone(), settings.stride, settings.overlap)
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
            Self::External { program, .. } => {
                Box::new(ExternalReconstructor::new(program.clone(), case.psi, case.noise))
            }
            Self::ByNoise(networks) => networks.at(case.noise).prepare(case)?,
            Self::Fixed { network, .. } => {
                let golden = GoldenReconstructor::new((**network).clone(), name.clone());
                Box::new(golden.map_err(|source| PrepareError::Fixed { net: name, source })?)
            }
        })
    }
}

/// Methods prepared for a camera and a depth, each for every noise that it meets.
pub struct Ready<'a> {
    camera: &'a Camera,
    specs: &'a [MethodSpec],
    psi: f64,
    optics: Settings,
    prepared: HashMap<(String, usize), (Box<dyn Reconstructor>, f64)>,
}

/// A method that is prepared.
pub struct Prepared<'a> {
    /// What reconstructs.
    pub reconstructor: &'a dyn Reconstructor,
    /// Wall-clock seconds that it took.
    pub seconds: f64,
}

impl<'a> Ready<'a> {
    /// Methods behind a camera at a depth, none of them prepared yet.
    #[must_use]
    pub fn new(camera: &'a Camera, specs: &'a [MethodSpec], psi: f64, optics: Settings) -> Self {
        Self { camera, specs, psi, optics, prepared: HashMap::new() }
    }

    /// What a method is.
    pub fn identity(&self, method: usize) -> Method {
        self.specs[method].method()
    }

    /// A method for a noise level, prepared where it is not yet.
    pub fn method(&mut self, noise: Noise, method: usize) -> Result<Prepared<'_>, PrepareError> {
        let (reconstructor, seconds) = &*match self.prepared.entry((noise.to_string(), method)) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                let start = Instant::now();
                let case = Case { camera: self.camera, psi: self.psi, noise, optics: self.optics };
                let prepared = self.specs[method].prepare(&case)?;
                entry.insert((prepared, start.elapsed().as_secs_f64()))
            }
        };
        Ok(Prepared { reconstructor: reconstructor.as_ref(), seconds: *seconds })
    }
}

fn of_float(network: &Network, format: Format, settings: &FloatSettings) -> Method {
    Method::network(&network.origin.name, format, settings.stride.pixels(), network.form.layers)
}

fn of_fixed(network: &FixedNetwork, format: Format, name: &str) -> Method {
    Method::network(name, format, network.stride.pixels(), network.form.layers)
}

fn float(
    network: Network,
    settings: &FloatSettings,
    net: String,
) -> Result<Box<dyn Reconstructor>, PrepareError> {
    let FloatSettings { stride, overlap, output, budget } = *settings;
    let float = FloatReconstructor::new(network, stride, overlap, output)
        .map_err(|source| PrepareError::Float { net, source })?;
    Ok(Box::new(match budget {
        Some(budget) => float.within(budget),
        None => float,
    }))
}

/// A deconvolution for a case; the blind one takes nothing from it.
fn deconvolution(settings: &DeconvolutionSettings, case: &Case<'_>) -> Result<Deconvolution, NoPsf> {
    let how = match *settings {
        DeconvolutionSettings::Blind(settings) => return Ok(Deconvolution::Blind(settings)),
        DeconvolutionSettings::RichardsonLucy { steps } => Known::RichardsonLucy(steps),
        DeconvolutionSettings::Wiener { model, noise } => {
            Known::Wiener(DeconvolutionSettings::wiener_ratio(&model, noise.unwrap_or(case.noise)))
        }
        DeconvolutionSettings::HyperLaplacian { model, share, alpha } => {
            Known::HyperLaplacian(DeconvolutionSettings::prior(&model, share, alpha, case.noise))
        }
    };
    Ok(Deconvolution::known(channel_psfs(case.camera, case.psi, &case.optics)?, how))
}

/// SHA-256 of the words and formats of a fixed network that lies in no file.
#[must_use]
pub fn words_sha256(network: &FixedNetwork) -> String {
    let FixedNetwork { form, analysis, thresholds, recurrent, dictionary, linear_path, .. } = network;
    let FixedNetwork { stride, overlap, code_bits, code_fractions, .. } = network;
    let [form, stride, overlap] = [form as &dyn KeyText, stride, overlap].map(|part| part.key_text());
    let mut bytes = format!("{form} {stride} {overlap} {code_bits} {code_fractions:?}").into_bytes();
    let matrices = [analysis, dictionary].into_iter().chain(recurrent).chain(linear_path);
    for FixedMatrix { weights, fraction } in matrices {
        bytes.extend(format!("{:?} {fraction}", weights.dim()).into_bytes());
        bytes.extend(weights.iter().flat_map(|word| word.to_le_bytes()));
    }
    bytes.extend(thresholds.iter().flatten().flat_map(|word| word.to_le_bytes()));
    sha256(&bytes)
}
