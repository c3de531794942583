//! Speed against error of everything that can be left out: for each knob a curve, the default marked, and why it stands there.
//!
//! Knobs of capturing are judged by the light on the sensor against that of an exact computation, knobs of reconstruction by the picture
//! against the photograph. Rows go to a [`Journal`] as those of other studies.

use crate::deconvolution::{Deconvolution, DeconvolutionReconstructor, Known};
use crate::dictionary::Dictionary;
use crate::journal::{Journal, JournalError, Line, Ordered, Progress, Shard};
use crate::kodak::{KodakError, sensor};
use crate::method::Family;
use crate::metrics::{BORDER, MetricError, Quality};
use crate::photos::Photo;
use crate::plot::{Axis, Mark, Plot, Series};
use crate::pursuit::{Pursuit, PursuitReconstructor};
use crate::report::Report;
use crate::spec::{Case, FISTA_PENALTY, MethodSpec, PrepareError, wiener_ratio};
use crate::tables::Table;
use crate::timing::timed;
use crate::told::{Told, ToldError};
use edof_optics::capture::{Approximation, Capture, CaptureError, capture};
use edof_optics::layers::{self, LayersError};
use edof_optics::psf::{NoPsf, Settings, channel_psfs};
use edof_optics::scene::Scene;
use edof_spec::camera::Spectrum;
use edof_spec::digest::sha256;
use edof_spec::fixed_network::FixedMatrix;
use edof_spec::overlap::Overlap;
use edof_spec::provenance::Input;
use edof_spec::{Camera, ColourFrame, FixedNetwork, Network, Noise, RawFrame, Reconstructor, Stride, Window};
use edof_train::reconstruct::{FloatReconstructor, Output};
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::sync::Arc;

/// What can be turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knob {
    /// Share of its energy that a kernel is cut to.
    KernelEnergy,
    /// Share of the energy that may lie wrong because a colour is summed over few wavelengths.
    Wavelengths,
    /// Layers that a scene of many depths is cut into.
    Depths,
    /// Pixels from one patch of the network to the next.
    Stride,
    /// Bits of a network's weights and codes.
    Bits,
    /// Bits of the words of A and R, by themselves.
    AnalysisBits,
    /// Bits of the words of every S, by themselves.
    RecurrentBits,
    /// Bits of the words of D, by themselves.
    DictionaryBits,
    /// Sparse codes that may be other than 0 in a patch, after each shrinkage.
    Budget,
    /// T, of networks before training.
    Layers,
    /// Atoms a patch of OMP, besides the colours' own.
    Atoms,
    /// Steps of FISTA.
    Steps,
    /// Side of the raw window that a pursuit sees.
    Window,
    /// σ of the noise that Wiener's filter is prepared for.
    NoiseClass,
}

/// A knob that nobody knows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("knob '{0}': must be one of {list}", list = Knob::ALL.map(Knob::name).join(", "))]
pub struct UnknownKnob(String);

impl std::str::FromStr for Knob {
    type Err = UnknownKnob;

    fn from_str(text: &str) -> Result<Self, UnknownKnob> {
        Self::ALL.into_iter().find(|knob| knob.name() == text).ok_or_else(|| UnknownKnob(text.to_owned()))
    }
}

impl Knob {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::KernelEnergy,
        Self::Wavelengths,
        Self::Depths,
        Self::Stride,
        Self::Bits,
        Self::AnalysisBits,
        Self::RecurrentBits,
        Self::DictionaryBits,
        Self::Budget,
        Self::Layers,
        Self::Atoms,
        Self::Steps,
        Self::Window,
        Self::NoiseClass,
    ];

    /// What users call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::KernelEnergy => "kernel-energy",
            Self::Wavelengths => "wavelengths",
            Self::Depths => "depths",
            Self::Stride => "stride",
            Self::Bits => "bits",
            Self::AnalysisBits => "analysis-bits",
            Self::RecurrentBits => "recurrent-bits",
            Self::DictionaryBits => "dictionary-bits",
            Self::Budget => "budget",
            Self::Layers => "layers",
            Self::Atoms => "atoms",
            Self::Steps => "steps",
            Self::Window => "window",
            Self::NoiseClass => "noise-class",
        }
    }

    /// Where it is tried.
    #[must_use]
    pub const fn values(self) -> &'static [f64] {
        match self {
            Self::KernelEnergy => &[0.9, 0.99, 0.999, 0.9999],
            Self::Wavelengths => &[0.3, 0.1, 0.03, 0.01, 0.003],
            Self::Depths => &[2.0, 4.0, 8.0, 16.0, 32.0],
            Self::Stride => &[8.0, 4.0, 2.0],
            Self::Bits => &[8.0, 9.0, 10.0, 12.0, 16.0],
            Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits => {
                &[4.0, 6.0, 8.0, 10.0, 12.0, 16.0]
            }
            Self::Budget => &[8.0, 16.0, 32.0, 64.0, 96.0, 192.0],
            Self::Layers => &[3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
            Self::Atoms => &[2.0, 4.0, 8.0, 16.0, 24.0],
            Self::Steps => &[3.0, 4.0, 6.0, 8.0, 10.0, 30.0, 100.0],
            Self::Window => &[8.0, 12.0, 16.0],
            Self::NoiseClass => &[0.0, 0.005, 0.01, 0.02, 0.04],
        }
    }

    /// Where it stands; the noise class stands at the noise that there is.
    fn default_value(self, noise: Noise) -> f64 {
        match self {
            Self::KernelEnergy => Settings::default().energy,
            Self::Wavelengths => Settings::default().wavelength_tolerance,
            Self::Depths | Self::Bits | Self::Atoms => 16.0,
            Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits => 16.0,
            Self::Budget => 192.0,
            Self::Layers => 4.0,
            Self::Stride | Self::Window => 8.0,
            Self::Steps => 100.0,
            Self::NoiseClass => match noise {
                Noise::Gaussian { sigma } => sigma,
                Noise::None | Noise::Sensor(_) => 0.0,
            },
        }
    }

    /// What it is, and why its default stands where it does.
    fn reason(self) -> &'static str {
        match self {
            Self::KernelEnergy => {
                "Kernels are cut to the smallest square that keeps a share of their energy. Error of the light on the sensor against whole kernels. \
                 0.999: the error is far below a sensor's noise, and a kernel is a few dozen pixels wide instead of hundreds."
            }
            Self::Wavelengths => {
                "Of a colour with a spectrum (here bands of 60 nm around the camera's lines), wavelengths are added until the kernel moves by less than a share of \
                 its energy. Error of the light against the most wavelengths. 0.01: below what the kernels' cut costs."
            }
            Self::Depths => {
                "A scene whose depth rises evenly over the camera's range, cut into so many layers of one kernel each. Error of the light against 64 layers. 16: half a \
                 radian a layer, half of the 1 rad between the depths that networks are trained for."
            }
            Self::Stride => {
                "Patches of the float network overlap at strides 4 and 2 and are averaged. 8: four and sixteen times the work for what the curve shows; 60 frames \
                 a second are within reach at stride 8 alone."
            }
            Self::Bits => {
                "Weights and codes of the fixed network, quantized for so many bits with nothing trained after. 16: what the board's multipliers take without \
                 costing more of them. Time is that of the software model, which does not depend on bits; what it saves is memory on the board."
            }
            Self::AnalysisBits => {
                "Words of A and of the linear path R of the fixed network rounded to so many bits, all else 16. 16: as for all words. Where the curve is flat the board's memory \
                 holds bits that no picture needs."
            }
            Self::RecurrentBits => {
                "Words of every S of the fixed network rounded to so many bits, all else 16. 16: as for all words. S is most of the network's memory."
            }
            Self::DictionaryBits => {
                "Words of D of the fixed network rounded to so many bits, all else 16. 16: as for all words."
            }
            Self::Budget => {
                "Sparse codes of a patch that may be other than 0 after each shrinkage of the float network, the largest; all others are dropped. 192: all, no budget. A board that \
                 skips zeros takes cycles by the non-zeros of the busiest stage, so a budget bounds its time; here time is that of a program that skips nothing."
            }
            Self::Layers => {
                "T of the paper's network before training, each colour's mean taken out: ISTA in the pursuits' dictionary, cut off. 4: what the board runs. Networks trained for \
                 other T stand in docs/results/layers.md; the curve says what a layer adds where training has not made up for it."
            }
            Self::Atoms => {
                "Atoms that orthogonal matching pursuit may use in a patch, ψ known. 16: chosen without noise (docs/decisions/0015-single-depth.md); with noise \
                 fewer may be better."
            }
            Self::Steps => {
                "Steps of FISTA in the dictionary, ψ known: what a network of so many layers would do without having been trained. 100: where it stands \
                 still. A trained network does it in four."
            }
            Self::Window => {
                "Side of the raw window that OMP sees around a patch, ψ known. 8: the paper's, which all pursuits of the studies keep. A wider window sees the light that a blur \
                 carries across a patch's border, and much that no atom of the patch explains, at which the pursuit spends its atoms: it is worse."
            }
            Self::NoiseClass => {
                "Wiener's filter, ψ known, prepared for a σ that is not always the one that there is. The default is the noise itself: networks have two banks for \
                 the same reason. Less may be better on photographs that vary more than the filter takes for granted."
            }
        }
    }

    /// What its numbers are.
    fn unit(self) -> &'static str {
        match self {
            Self::KernelEnergy => "share of the energy kept",
            Self::Wavelengths => "share of the energy that may move",
            Self::Depths => "layers",
            Self::Stride | Self::Window => "pixels",
            Self::Bits | Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits => "bits",
            Self::Budget => "non-zeros a patch",
            Self::Layers => "layers",
            Self::Atoms => "atoms",
            Self::Steps => "steps",
            Self::NoiseClass => "σ prepared for",
        }
    }

    /// Whether it takes bits from the words of one matrix.
    const fn is_of_words(self) -> bool {
        matches!(self, Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits)
    }

    /// Numbers of bits that a plan's fixed networks must have for it.
    #[must_use]
    pub fn quantized_bits(self) -> Vec<u32> {
        match self {
            Self::Bits => self.values().iter().map(|&bits| bits as u32).collect(),
            knob if knob.is_of_words() => vec![WORD_BITS],
            _ => vec![],
        }
    }

    /// Whether it cuts what is computed for a capture.
    const fn is_of_capture(self) -> bool {
        matches!(self, Self::KernelEnergy | Self::Wavelengths | Self::Depths)
    }
}

/// Bits of a network's words where no knob takes any.
const WORD_BITS: u32 = 16;

/// What is measured.
pub struct Plan {
    /// The camera.
    pub camera: Camera,
    /// Depth; the knob of depths takes the camera's range.
    pub psi: f64,
    /// Noise, where something is reconstructed.
    pub noise: Noise,
    /// The float network of strides.
    pub network: Arc<Network>,
    /// SHA-256 of its file.
    pub network_sha256: String,
    /// The same network in integers, for each number of [`Knob::quantized_bits`].
    pub fixed: Vec<FixedNetwork>,
    /// Atoms of pursuits.
    pub dictionary: Arc<Dictionary>,
    /// Which knobs.
    pub knobs: Vec<Knob>,
    /// Which of the rows.
    pub shard: Shard,
}

/// A knob at one value on one photograph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Which.
    pub knob: Knob,
    /// Where it stands.
    pub value: f64,
    /// Whether that is its default.
    pub is_default: bool,
    /// The photograph.
    pub image: String,
    /// Depth of the scene.
    pub psi: f64,
    /// Noise of the sensor.
    pub noise: Noise,
    /// PSNR in dB: of the light on the sensor against an exact one for knobs of capturing, of the picture for all others.
    pub psnr_db: f64,
    /// Wall-clock seconds a megapixel.
    pub seconds_per_megapixel: f64,
    /// SHA-256 of weights or dictionary, of the photograph's values and of the camera.
    pub weights_sha256: Option<String>,
    /// See `weights_sha256`.
    pub photo_sha256: String,
    /// See `weights_sha256`.
    pub camera_sha256: String,
}

/// What a row is of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    knob: Knob,
    value: Ordered,
    weights: Option<String>,
    camera: String,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
    photo: String,
}

impl Line for Row {
    const STUDY: &'static str = "knobs";
    const LAYOUT: u32 = 1;
    type Key = Key;

    fn key(&self) -> Key {
        Key {
            knob: self.knob,
            value: Ordered(self.value),
            weights: self.weights_sha256.clone(),
            camera: self.camera_sha256.clone(),
            psi: Ordered(self.psi),
            noise: Ordered::of_noise(self.noise),
            image: self.image.clone(),
            photo: self.photo_sha256.clone(),
        }
    }

    fn timeless(&self) -> Self {
        Self { seconds_per_megapixel: 0.0, ..self.clone() }
    }
}

/// A study that cannot go on.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum KnobsError {
    /// A depth that the camera has no PSFs for, or a scene that cannot be.
    #[error("{image}: {source}")]
    Capture { image: String, source: CaptureError },
    /// A scene of many depths.
    #[error("{image}: {source}")]
    Layers { image: String, source: LayersError },
    /// A photograph too small to measure.
    #[error("{image}: {source}")]
    Metric { image: String, source: MetricError },
    /// A depth that the camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
    /// A method refused a frame, or the listener asked to stop.
    #[error(transparent)]
    Trial(#[from] KodakError),
    /// A method that cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The file of rows.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// Measures what the journal does not hold yet; `tell` hears how far it is, and may stop it.
///
/// # Errors
/// [`KnobsError`].
pub fn run(
    plan: &Plan,
    photos: &[Photo],
    journal: &mut Journal<Row>,
    mut tell: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<(), KnobsError> {
    let camera_sha256 = sha256(plan.camera.to_json().as_bytes());
    let mut cells: Vec<(Key, (usize, Row))> = vec![];
    for (index, photo) in photos.iter().enumerate() {
        let photo_sha256 = Input::photograph(&photo.name, &photo.frame).sha256;
        for &knob in &plan.knobs {
            for &value in knob.values() {
                let row = Row {
                    knob,
                    value,
                    is_default: value == knob.default_value(plan.noise),
                    image: photo.name.clone(),
                    psi: plan.psi,
                    noise: plan.noise,
                    psnr_db: f64::NAN,
                    seconds_per_megapixel: f64::NAN,
                    weights_sha256: plan.weights(knob),
                    photo_sha256: photo_sha256.clone(),
                    camera_sha256: camera_sha256.clone(),
                };
                cells.push((row.key(), (index, row)));
            }
        }
    }
    let own = plan.shard.own(cells);
    let mut captures = Captures::default();
    let (of, mut done) = (own.len(), 0);
    for (key, (index, mut row)) in own {
        if !journal.holds(&key) {
            let photo = &photos[index];
            let (db, seconds) = plan.measure(row.knob, row.value, photo, &mut captures)?;
            let (height, width) = photo.frame.size();
            row.psnr_db = db;
            row.seconds_per_megapixel = seconds / ((height * width) as f64 * 1e-6);
            journal.push(row.clone())?;
        }
        done += 1;
        let last = format!("{} {} on {}", row.knob.name(), row.value, row.image);
        if tell(Progress { done, of, last }).is_break() {
            return Err(KodakError::Stopped.into());
        }
    }
    Ok(journal.finish()?)
}

/// Layers of the scene of many depths that others are held against.
const MOST_LAYERS: usize = 64;
/// Light that is the same to the last bit counts as so far from an exact one.
const MOST_DB: f64 = 160.0;
/// Half the width of the bands in nanometres that stand for colours where wavelengths are counted.
const HALF_BAND_NM: f64 = 30.0;

/// What several values of a knob share.
#[derive(Default)]
struct Captures {
    /// Light of exact captures, which all values of a knob are held against, by knob and photograph.
    exact: BTreeMap<(Knob, String), ColourFrame>,
    /// What is reconstructed, by photograph.
    raw: BTreeMap<String, RawFrame>,
}

impl Plan {
    fn weights(&self, knob: Knob) -> Option<String> {
        match knob {
            Knob::Stride | Knob::Bits | Knob::Budget => Some(self.network_sha256.clone()),
            knob if knob.is_of_words() => Some(self.network_sha256.clone()),
            Knob::Layers | Knob::Atoms | Knob::Steps | Knob::Window => Some(self.dictionary.sha256.clone()),
            _ => None,
        }
    }

    /// PSNR in dB and seconds of a knob at a value on a photograph.
    fn measure(
        &self,
        knob: Knob,
        value: f64,
        photo: &Photo,
        captures: &mut Captures,
    ) -> Result<(f64, f64), KnobsError> {
        if knob.is_of_capture() {
            captures.exact.retain(|(of, _), _| *of == knob);
            self.captured(knob, value, photo, captures)
        } else {
            self.reconstructed(knob, value, photo, captures)
        }
    }

    fn captured(
        &self,
        knob: Knob,
        value: f64,
        photo: &Photo,
        captures: &mut Captures,
    ) -> Result<(f64, f64), KnobsError> {
        let whole = Settings { energy: 1.0, wavelength_tolerance: 0.0, exact: false };
        let flat = || Scene::flat(photo.name.clone(), photo.frame.clone(), self.psi);
        let usual = Approximation::default();
        let (camera, [cut, exact], scenes) = match knob {
            Knob::KernelEnergy => {
                let cut = Settings { energy: value, ..whole };
                (
                    self.camera.clone(),
                    [cut, whole].map(|psf| Approximation { psf, ..usual }),
                    [flat(), flat()],
                )
            }
            Knob::Wavelengths => {
                // Kernels as they usually are: only the wavelengths differ.
                let psf = |wavelength_tolerance| Settings { wavelength_tolerance, ..Settings::default() };
                let both = [psf(value), psf(0.0)].map(|psf| Approximation { psf, ..usual });
                (banded(&self.camera), both, [flat(), flat()])
            }
            _ => (
                self.camera.clone(),
                [usual, usual],
                [self.ramp(photo, value as usize)?, self.ramp(photo, MOST_LAYERS)?],
            ),
        };
        let [scene, reference] = scenes;
        let image = || photo.name.clone();
        let taken = |scene: &Scene, how: &Approximation| -> Result<Capture, KnobsError> {
            capture(scene, &camera, &sensor(&photo.name, self.psi, Noise::None), how)
                .map_err(|source| KnobsError::Capture { image: image(), source })
        };
        let exact = match captures.exact.entry((knob, image())) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(taken(&reference, &exact)?.light),
        };
        let cut = taken(&scene, &cut)?;
        let quality = Quality::of(exact, &cut.light, BORDER);
        let db = quality.map_err(|source| KnobsError::Metric { image: image(), source })?.psnr_db;
        Ok((db.min(MOST_DB), cut.seconds))
    }

    /// The photograph with depths that rise from left to right over the camera's range, in at most so many layers.
    fn ramp(&self, photo: &Photo, layers: usize) -> Result<Scene, KnobsError> {
        let (height, width) = photo.frame.size();
        let [low, high] = self.camera.psi_range;
        let psi = Array2::from_shape_fn((height, width), |(_, c)| {
            (low + (high - low) * c as f64 / (width - 1) as f64) as f32
        });
        layers::from_depths(&photo.name, &photo.frame, &psi, layers)
            .map_err(|source| KnobsError::Layers { image: photo.name.clone(), source })
    }

    fn reconstructed(
        &self,
        knob: Knob,
        value: f64,
        photo: &Photo,
        captures: &mut Captures,
    ) -> Result<(f64, f64), KnobsError> {
        let image = || photo.name.clone();
        let raw = match captures.raw.entry(image()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(self.shot(photo)?),
        };
        let method = self.prepared(knob, value)?;
        let result = timed(method.as_ref(), raw)
            .map_err(|source| KodakError::Reconstruct { image: image(), source })?
            .result;
        let quality = Quality::of(&photo.frame, &result.frame, BORDER);
        let db = quality.map_err(|source| KnobsError::Metric { image: image(), source })?.psnr_db;
        Ok((db, result.seconds))
    }

    /// The photograph at the plan's depth, behind its camera.
    fn shot(&self, photo: &Photo) -> Result<RawFrame, KnobsError> {
        let scene = Scene::flat(photo.name.clone(), photo.frame.clone(), self.psi);
        let sensor = sensor(&photo.name, self.psi, self.noise);
        let shot = capture(&scene, &self.camera, &sensor, &Approximation::default());
        Ok(shot.map_err(|source| KnobsError::Capture { image: photo.name.clone(), source })?.raw)
    }

    /// The network in so many bits.
    fn in_bits(&self, bits: u32) -> &FixedNetwork {
        let network = self.fixed.iter().find(|fixed| fixed.code_bits == bits);
        network.unwrap_or_else(|| unreachable!("a plan has a network of every number of bits"))
    }

    fn fixed(&self, knob: Knob, network: FixedNetwork) -> MethodSpec {
        let (network, sha256) = (Arc::new(network), self.network_sha256.clone());
        MethodSpec::Fixed { network, name: knob.name().into(), sha256 }
    }

    fn prepared(&self, knob: Knob, value: f64) -> Result<Box<dyn Reconstructor>, KnobsError> {
        let optics = Settings::default();
        let case = Case { camera: &self.camera, psi: self.psi, noise: self.noise, optics };
        // All values of these knobs are whole and legal.
        let stride = |pixels: f64| Stride::new(pixels as usize).unwrap_or_else(|e| unreachable!("{e}"));
        let window = |side: f64| Window::new(side as usize).unwrap_or_else(|e| unreachable!("{e}"));
        let pursuit = |side: f64, how: Pursuit| {
            let geometry = (window(side), Stride::PATCH);
            let name = knob.name().to_owned();
            PursuitReconstructor::new(name, &self.dictionary, &self.camera, &[self.psi], geometry, how)
                .map_err(PrepareError::from)
        };
        let least = Knob::Window.default_value(self.noise);
        let (atoms, penalty) = (Knob::Atoms.default_value(self.noise) as usize, FISTA_PENALTY);
        Ok(match knob {
            Knob::Atoms => Box::new(pursuit(least, Pursuit::Omp { atoms: value as usize })?),
            Knob::Steps => Box::new(pursuit(least, Pursuit::Fista { steps: value as usize, penalty })?),
            Knob::Window => Box::new(pursuit(value, Pursuit::Omp { atoms })?),
            Knob::NoiseClass => {
                let psfs = channel_psfs(&self.camera, self.psi, &optics)?;
                let how = Known::Wiener(wiener_ratio(Noise::gaussian(value)));
                Box::new(DeconvolutionReconstructor::new(knob.name().into(), Deconvolution::known(psfs, how)))
            }
            Knob::Bits => self.fixed(knob, self.in_bits(value as u32).clone()).prepare(&case)?,
            Knob::AnalysisBits | Knob::RecurrentBits | Knob::DictionaryBits => {
                let mut network = self.in_bits(WORD_BITS).clone();
                let matrices: Vec<&mut FixedMatrix> = match knob {
                    Knob::AnalysisBits => {
                        std::iter::once(&mut network.analysis).chain(network.linear_path.as_mut()).collect()
                    }
                    Knob::RecurrentBits => network.recurrent.iter_mut().collect(),
                    _ => vec![&mut network.dictionary],
                };
                matrices.into_iter().for_each(|matrix| keep_bits(matrix, value as u32));
                self.fixed(knob, network).prepare(&case)?
            }
            Knob::Budget => {
                let network = (*self.network).clone();
                let name = network.origin.name.clone();
                let float = FloatReconstructor::new(network, Stride::PATCH, Overlap::default(), Output::Rgb);
                Box::new(
                    float.map_err(|source| PrepareError::Float { net: name, source })?.within(value as usize),
                )
            }
            Knob::Layers => {
                let (dictionary, layers) = (Arc::clone(&self.dictionary), value as usize);
                let family = Family::UntrainedDcRemoved;
                MethodSpec::Untrained { family, layers, stride: Stride::PATCH, dictionary }.prepare(&case)?
            }
            _ => {
                let (network, sha256) = (Arc::clone(&self.network), self.network_sha256.clone());
                MethodSpec::Float { network, sha256, stride: stride(value) }.prepare(&case)?
            }
        })
    }
}

/// Rounds a matrix's words to their first `bits` bits.
fn keep_bits(matrix: &mut FixedMatrix, bits: u32) {
    let step = 1i32 << (WORD_BITS - bits);
    let most = i32::from(i16::MAX) / step * step;
    matrix.weights.mapv_inplace(|word| {
        let rounded = (i32::from(word) + step / 2).div_euclid(step) * step;
        rounded.min(most) as i16
    });
}

/// The camera with a band in place of each line.
fn banded(camera: &Camera) -> Camera {
    let band = |spectrum: &Spectrum| match spectrum {
        Spectrum::Line(nm) => Spectrum::Sampled(vec![[nm - HALF_BAND_NM, 1.0], [nm + HALF_BAND_NM, 1.0]]),
        sampled @ Spectrum::Sampled(_) => sampled.clone(),
    };
    Camera { spectra: camera.spectra.each_ref().map(band), ..camera.clone() }
}

/// One value of a knob, averaged over photographs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Which knob.
    pub knob: Knob,
    /// Where it stands.
    pub value: f64,
    /// Whether that is its default.
    pub is_default: bool,
    /// Photographs.
    pub photos: usize,
    /// Mean PSNR in dB.
    pub psnr_db: f64,
    /// Mean seconds a megapixel.
    pub seconds_per_megapixel: f64,
}

/// All curves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Knobs {
    /// Knob by knob, values ascending.
    pub points: Vec<Point>,
    /// CPU and threads that all times are of.
    pub machine: String,
}

/// A curve of a few points, whole on a phone.
const SMALL: [f64; 2] = [400.0, 300.0];

const TITLE: &str = "What can be left out: speed against error";

impl Told for Knobs {
    type Row = Row;

    fn new(rows: &[Row], machine: String) -> Result<Self, ToldError> {
        let mut points: Vec<Point> = vec![];
        for row in rows {
            let same = |other: &&Row| other.knob == row.knob && other.value == row.value;
            if points.iter().any(|p| p.knob == row.knob && p.value == row.value) {
                continue;
            }
            let own: Vec<&Row> = rows.iter().filter(same).collect();
            let mean = |of: fn(&Row) -> f64| own.iter().map(|row| of(row)).sum::<f64>() / own.len() as f64;
            points.push(Point {
                knob: row.knob,
                value: row.value,
                is_default: row.is_default,
                photos: own.len(),
                psnr_db: mean(|row| row.psnr_db),
                seconds_per_megapixel: mean(|row| row.seconds_per_megapixel),
            });
        }
        Ok(Self { points, machine })
    }

    fn to_text(&self) -> String {
        let mut text = String::new();
        for (knob, table) in self.tables() {
            let _ = write!(text, "{}\n{}\n", knob.name(), table.to_text());
        }
        text.trim_end().to_owned()
    }

    fn to_markdown(&self, command: &str) -> String {
        let mut page = format!("# {TITLE}\n\nMade by `{command}`.\n\n{}\n", self.explanation());
        for (knob, table) in self.tables() {
            let _ = write!(page, "\n## {}\n\n{}\n\n{}", knob.name(), knob.reason(), table.to_markdown());
        }
        page
    }

    fn report(&self, command: &str) -> Report {
        let mut report = Report::new(TITLE);
        report.paragraph(&self.explanation()).made_by(command);
        for (knob, table) in self.tables() {
            report.heading(knob.name()).paragraph(knob.reason()).plots(&[self.plot(knob)]);
            table.add_to(&mut report, &[]);
        }
        report
    }
}

impl Knobs {
    fn explanation(&self) -> String {
        format!(
            "Each curve turns one knob and leaves all others where they stand; its default is marked, and the text says why it is there. Photographs' numbers are \
             taken for light. PSNR over red, green and blue, peak 1, border 8 cropped: of the light on the sensor against an exact computation for knobs of \
             capturing, of the picture against the photograph for all others. Time is wall-clock on {}, for kernels and blur or for reconstruction.",
            self.machine
        )
    }

    fn tables(&self) -> Vec<(Knob, Table)> {
        let of = |knob: Knob| {
            let own = self.points.iter().filter(move |p| p.knob == knob);
            let row = |p: &Point| {
                let mark = if p.is_default { "default" } else { "" };
                let value = p.value.to_string();
                vec![
                    value,
                    mark.into(),
                    format!("{:.2}", p.psnr_db),
                    format!("{:.4}", p.seconds_per_megapixel),
                    p.photos.to_string(),
                ]
            };
            let header =
                [knob.unit(), "", "PSNR dB", "seconds a megapixel", "photos"].map(str::to_owned).to_vec();
            (knob, Table { header, rows: own.map(row).collect() })
        };
        Knob::ALL.into_iter().map(of).filter(|(_, table)| !table.rows.is_empty()).collect()
    }

    /// PSNR against time: the curve, and its default.
    fn plot(&self, knob: Knob) -> Plot {
        let own = || self.points.iter().filter(move |p| p.knob == knob);
        let at = |p: &Point| [p.seconds_per_megapixel, p.psnr_db];
        let each = own().map(|p| {
            let label = format!("{} {}", p.value, if p.is_default { "(default)" } else { "" });
            let series = Series::new(label.trim(), Mark::Points, [at(p)]).named_at_points();
            if p.is_default { series.coloured("#d55e00") } else { series.coloured("#0072b2") }
        });
        let curve = Series::new("", Mark::Line, own().map(at)).coloured("#999999");
        Plot {
            title: knob.unit().into(),
            x: Axis::log("seconds a megapixel"),
            y: Axis::linear("PSNR (dB)"),
            size: SMALL,
            series: std::iter::once(curve).chain(each).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::Header;

    fn photo() -> Photo {
        let mut frame = ColourFrame::zeros(32, 32);
        frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
            *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 4) as f32).cos();
        });
        Photo { name: "p".into(), frame }
    }

    fn plan(knobs: &[Knob], fixed: &FixedNetwork) -> Plan {
        Plan {
            camera: Camera::resolve("ring-2018").unwrap(),
            psi: 4.0,
            noise: Noise::gaussian(0.01),
            network: Arc::new(float()),
            network_sha256: "n".into(),
            fixed: vec![fixed.clone()],
            dictionary: Arc::new(Dictionary::load(None).unwrap()),
            knobs: knobs.to_vec(),
            shard: Shard::WHOLE,
        }
    }

    fn float() -> Network {
        use edof_spec::network::{Form, Origin, Recurrence, Shrinkage};
        use ndarray::Array1;
        Network {
            form: Form {
                window: Window::new(8).unwrap(),
                codes: 2,
                layers: 2,
                shrinkage: Shrinkage::OneSided,
                recurrence: Recurrence::Direct,
                linear_path: false,
                tied: false,
            },
            analysis: Array2::zeros((2, 64)),
            thresholds: vec![Array1::zeros(2)],
            recurrent: vec![],
            dictionary: Array2::zeros((192, 2)),
            linear_path: None,
            origin: Origin::untrained("n", Camera::resolve("ring-2018").unwrap()),
        }
    }

    fn rows(knobs: &[Knob]) -> Vec<Row> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows");
        let header = || Header::of::<Row>(false, "m".into());
        let mut journal = Journal::open(&path, header()).unwrap();
        let plan = plan(knobs, &edof_random::natural(8, 8, 7));
        run(&plan, &[photo()], &mut journal, |_| ControlFlow::Continue(())).unwrap();
        // What was written is read again: nothing in it is no number.
        let keys = |journal: &Journal<Row>| journal.rows().iter().map(Line::key).collect::<Vec<_>>();
        assert_eq!(keys(&Journal::open(&path, header()).unwrap()), keys(&journal));
        journal.rows().to_vec()
    }

    #[test]
    fn cutting_less_of_a_capture_is_nearer_to_the_exact_one() {
        let plan = plan(&[], &edof_random::natural(8, 8, 7));
        let mut captures = Captures::default();
        let mut db = |knob, value| plan.measure(knob, value, &photo(), &mut captures).unwrap().0;
        // The coarsest and a fine value, and what lies between them at least.
        for (knob, coarse, fine, least) in [
            (Knob::KernelEnergy, 0.9, 0.9999, 5.0),
            (Knob::Wavelengths, 0.3, 0.003, -0.1),
            (Knob::Depths, 2.0, 16.0, 2.0),
        ] {
            let (coarse, fine) = (db(knob, coarse), db(knob, fine));
            assert!(coarse + least < fine, "{}: {coarse} dB, {fine} dB", knob.name());
        }
    }

    #[test]
    fn every_knob_of_reconstruction_has_a_row_for_each_value_and_one_default() {
        let knobs: Vec<Knob> =
            Knob::ALL.into_iter().filter(|knob| !knob.is_of_capture() && *knob != Knob::Bits).collect();
        let rows = rows(&knobs);
        for &knob in &knobs {
            let own: Vec<&Row> = rows.iter().filter(|row| row.knob == knob).collect();
            assert_eq!(own.len(), knob.values().len());
            assert_eq!(own.iter().filter(|row| row.is_default).count(), 1, "{}", knob.name());
        }
        let study = Knobs::new(&rows, "m".into()).unwrap();
        assert_eq!(study.points.len(), rows.len());
        let html = study.report("edof study knobs").to_html();
        // Where the pointer rests on the dot.
        assert_eq!(html.matches("<title>").count() - 1, rows.len());
        assert_eq!(html.matches("(default): ").count(), knobs.len());
    }

    #[test]
    fn words_keep_their_first_bits_and_their_sign() {
        let weights = ndarray::array![[0x7fff, 0x1234, -0x1234, -0x8000]];
        let mut matrix = FixedMatrix { weights, fraction: 15 };
        keep_bits(&mut matrix, 8);
        assert_eq!(matrix.weights, ndarray::array![[0x7f00, 0x1200, -0x1200, -0x8000]]);
        let before = matrix.clone();
        keep_bits(&mut matrix, 16);
        assert_eq!(matrix, before);
    }

    #[test]
    fn knobs_are_known_by_name() {
        assert_eq!(Knob::ALL.map(|knob| knob.name().parse::<Knob>().unwrap()), Knob::ALL);
        let error = "gain".parse::<Knob>().unwrap_err().to_string();
        assert!(error.starts_with("knob 'gain': must be one of kernel-energy, wavelengths, "), "{error}");
    }
}
