//! Speed against error of everything that can be left out: for each knob a curve, the default marked, and why it stands there.
//!
//! Knobs of capturing are judged by the light on the sensor against that of an exact computation, knobs of reconstruction by the picture
//! against the photograph. Rows go to a [`Journal`] as those of other studies.

mod knob;
mod page;
#[cfg(test)]
mod tests;

pub use knob::{Knob, UnknownKnob};
pub use page::{Knobs, Point};

use crate::journal::{Journal, JournalError, Line, Ordered, Progress, Proof, Shard, settings};
use crate::kodak::{KodakError, sensor};
use edof_camera::Camera;
use edof_camera::camera::Spectrum;
use edof_image::{ColourFrame, Noise, RawFrame, Stride, Window};
use edof_io::photos::Photo;
use edof_methods::dictionary::Dictionary;
use edof_methods::settings::{
    DeconvolutionSettings, Depths, FloatSettings, PictureModel, Pursuit, PursuitSettings, UntrainedSettings,
};
use edof_methods::spec::{Case, MethodSpec, PrepareError, words_sha256};
use edof_metrics::timing::{Range, timed};
use edof_metrics::{BORDER, MetricError, Quality};
use edof_network::fixed_network::FixedMatrix;
use edof_network::{FixedNetwork, Network};
use edof_optics::capture::{Approximation, Capture, CaptureError, capture};
use edof_optics::layers::{self, LayersError};
use edof_optics::psf::{NoPsf, Settings};
use edof_optics::scene::Scene;
use edof_storage::digest::sha256;
use edof_storage::provenance::Input;
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::ControlFlow;
use std::sync::Arc;

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
    #[serde(with = "edof_metrics::number")]
    pub psnr_db: f64,
    /// Wall-clock seconds a megapixel, median of the runs.
    pub seconds_per_megapixel: f64,
    /// Least and most of the runs; none in rows of layout 1.
    #[serde(default)]
    pub seconds_range: Option<Range>,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a row is of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    knob: Knob,
    value: Ordered,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
    proof: Proof,
}

impl Line for Row {
    const STUDY: &'static str = "knobs";
    const LAYOUT: u32 = 2;
    type Key = Key;

    fn key(&self) -> Key {
        Key {
            knob: self.knob,
            value: Ordered(self.value),
            psi: Ordered(self.psi),
            noise: Ordered::of_noise(self.noise),
            image: self.image.clone(),
            proof: self.proof.clone(),
        }
    }

    fn subject(key: &Key) -> Key {
        Key { proof: Proof::default(), ..key.clone() }
    }

    fn timeless(&self) -> Self {
        Self { seconds_per_megapixel: 0.0, seconds_range: None, ..self.clone() }
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
    let own = plan.cells(photos);
    let mut captures = Captures::default();
    let (of, mut done) = (own.len(), 0);
    for (key, turned) in own {
        if !journal.holds(&key) {
            journal.push(plan.row(&turned, key.proof, &mut captures)?)?;
        }
        done += 1;
        let last = format!("{} {} on {}", turned.knob.name(), turned.value, turned.photo.name);
        if tell(Progress { done, of, last }).is_break() {
            return Err(KodakError::Stopped.into());
        }
    }
    Ok(journal.finish()?)
}

/// A knob at a value on a photograph, and what is run there.
struct Turned<'a> {
    photo: &'a Photo,
    knob: Knob,
    value: f64,
    work: Work,
}

/// What a knob at a value runs.
enum Work {
    /// A capture, held against a reference.
    Capture(Box<Shortened>),
    /// A method on the usual capture.
    Method(MethodSpec),
}

/// A shortened capture and the one that it is held against.
#[derive(Debug)]
struct Shortened {
    camera: Camera,
    cut: Approximation,
    reference: Approximation,
    /// Layers of the scene and of the reference, where it has many depths.
    layers: Option<[usize; 2]>,
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
    /// Its shard's rows.
    fn cells<'a>(&self, photos: &'a [Photo]) -> Vec<(Key, Turned<'a>)> {
        let camera_sha256 = sha256(self.camera.to_json().as_bytes());
        let mut cells = vec![];
        for photo in photos {
            let photo_sha256 = Input::photograph(&photo.name, &photo.frame).sha256;
            for &knob in &self.knobs {
                for &value in knob.values() {
                    let work = self.turned(knob, value);
                    let (how, weights) = match &work {
                        Work::Capture(shortened) => (format!("{shortened:?}"), None),
                        Work::Method(spec) => (spec.settings(), spec.weights().map(str::to_owned)),
                    };
                    let sensor = sensor(&photo.name, self.psi, self.noise_of(&work));
                    let key = Key {
                        knob,
                        value: Ordered(value),
                        psi: Ordered(self.psi),
                        noise: Ordered::of_noise(self.noise),
                        image: photo.name.clone(),
                        proof: Proof {
                            settings: Some(settings(&[&how, &Approximation::default(), &sensor, &BORDER])),
                            weights,
                            photo: photo_sha256.clone(),
                            camera: Some(camera_sha256.clone()),
                        },
                    };
                    cells.push((key, Turned { photo, knob, value, work }));
                }
            }
        }
        self.shard.own(cells)
    }

    fn row(&self, turned: &Turned<'_>, proof: Proof, captures: &mut Captures) -> Result<Row, KnobsError> {
        let Turned { photo, knob, value, work } = turned;
        let (psnr_db, seconds, range) = match work {
            Work::Capture(shortened) => {
                captures.exact.retain(|(of, _), _| of == knob);
                self.captured(*knob, shortened, photo, captures)?
            }
            Work::Method(spec) => self.reconstructed(spec, photo, captures)?,
        };
        let (height, width) = photo.frame.size();
        let megapixels = (height * width) as f64 * 1e-6;
        Ok(Row {
            knob: *knob,
            value: *value,
            is_default: *value == knob.default_value(self.noise),
            image: photo.name.clone(),
            psi: self.psi,
            noise: self.noise,
            psnr_db,
            seconds_per_megapixel: seconds / megapixels,
            seconds_range: Some(range.over(megapixels)),
            proof,
        })
    }

    /// Captures are judged by their light alone.
    const fn noise_of(&self, work: &Work) -> Noise {
        match work {
            Work::Capture(_) => Noise::None,
            Work::Method(_) => self.noise,
        }
    }

    /// What runs where a knob stands at a value.
    fn turned(&self, knob: Knob, value: f64) -> Work {
        match self.shortened(knob, value) {
            Some(shortened) => Work::Capture(Box::new(shortened)),
            None => Work::Method(self.method(knob, value)),
        }
    }

    /// The capture of a knob of capturing.
    fn shortened(&self, knob: Knob, value: f64) -> Option<Shortened> {
        let whole = Settings { energy: 1.0, wavelength_tolerance: 0.0, exact: false };
        let (camera, usual) = (self.camera.clone(), Approximation::default());
        let shortened = match knob {
            Knob::KernelEnergy => {
                let [cut, reference] =
                    [Settings { energy: value, ..whole }, whole].map(|psf| Approximation { psf, ..usual });
                Shortened { camera, cut, reference, layers: None }
            }
            Knob::Wavelengths => {
                // Kernels as they usually are: only the wavelengths differ.
                let [cut, reference] = [value, 0.0].map(|wavelength_tolerance| Approximation {
                    psf: Settings { wavelength_tolerance, ..usual.psf },
                    ..usual
                });
                Shortened { camera: banded(&camera), cut, reference, layers: None }
            }
            Knob::Depths => {
                let layers = Some([value as usize, MOST_LAYERS]);
                Shortened { camera, cut: usual, reference: usual, layers }
            }
            _ => return None,
        };
        Some(shortened)
    }

    /// The method of any other knob.
    fn method(&self, knob: Knob, value: f64) -> MethodSpec {
        let whole = value as usize;
        // All values of these knobs are legal.
        let stride = |pixels| Stride::new(pixels).unwrap_or_else(|e| unreachable!("{e}"));
        let window = |side| Window::new(side).unwrap_or_else(|e| unreachable!("{e}"));
        let pursuit = |how: Pursuit| PursuitSettings::usual(how, Depths::Known, Stride::PATCH);
        let of_dictionary =
            |settings| MethodSpec::Pursuit { settings, dictionary: Arc::clone(&self.dictionary) };
        let float = |settings| {
            let (network, sha256) = (Arc::clone(&self.network), self.network_sha256.clone());
            MethodSpec::Float { network, sha256, settings }
        };
        match knob {
            Knob::Atoms => of_dictionary(pursuit(Pursuit::Omp { atoms: whole })),
            Knob::Steps => of_dictionary(pursuit(Pursuit::FISTA.in_steps(whole))),
            Knob::Window => of_dictionary(PursuitSettings { window: window(whole), ..pursuit(Pursuit::OMP) }),
            Knob::NoiseClass => MethodSpec::Deconvolution(DeconvolutionSettings::Wiener {
                model: PictureModel::default(),
                noise: Some(Noise::gaussian(value)),
            }),
            Knob::Bits => fixed(knob, self.in_bits(value as u32).clone()),
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
                fixed(knob, network)
            }
            Knob::Budget => float(FloatSettings { budget: Some(whole), ..FloatSettings::at(Stride::PATCH) }),
            Knob::Layers => MethodSpec::Untrained {
                settings: UntrainedSettings::usual(whole, true, Stride::PATCH),
                dictionary: Arc::clone(&self.dictionary),
            },
            _ => float(FloatSettings::at(stride(whole))),
        }
    }

    /// PSNR in dB and seconds of a capture.
    fn captured(
        &self,
        knob: Knob,
        how: &Shortened,
        photo: &Photo,
        captures: &mut Captures,
    ) -> Result<(f64, f64, Range), KnobsError> {
        let image = || photo.name.clone();
        let scene = |layers: Option<usize>| match layers {
            Some(layers) => self.ramp(photo, layers),
            None => Ok(Scene::flat(image(), photo.frame.clone(), self.psi)),
        };
        let taken = |layers: Option<usize>, approximation: &Approximation| -> Result<Capture, KnobsError> {
            let sensor = sensor(&photo.name, self.psi, Noise::None);
            capture(&scene(layers)?, &how.camera, &sensor, approximation)
                .map_err(|source| KnobsError::Capture { image: image(), source })
        };
        let exact = match captures.exact.entry((knob, image())) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(taken(how.layers.map(|l| l[1]), &how.reference)?.light),
        };
        let cut = taken(how.layers.map(|l| l[0]), &how.cut)?;
        let quality = Quality::of(exact, &cut.light, BORDER);
        let db = quality.map_err(|source| KnobsError::Metric { image: image(), source })?.psnr_db;
        Ok((db.min(MOST_DB), cut.seconds, Range { least: cut.seconds, most: cut.seconds }))
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

    /// PSNR in dB and seconds of a method.
    fn reconstructed(
        &self,
        spec: &MethodSpec,
        photo: &Photo,
        captures: &mut Captures,
    ) -> Result<(f64, f64, Range), KnobsError> {
        let image = || photo.name.clone();
        let raw = match captures.raw.entry(image()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(self.shot(photo)?),
        };
        let case =
            Case { camera: &self.camera, psi: self.psi, noise: self.noise, optics: Settings::default() };
        let timed = timed(spec.prepare(&case)?.as_ref(), raw)
            .map_err(|source| KodakError::Reconstruct { image: image(), source })?;
        let quality = Quality::of(&photo.frame, &timed.result.frame, BORDER);
        let db = quality.map_err(|source| KnobsError::Metric { image: image(), source })?.psnr_db;
        Ok((db, timed.result.seconds, timed.range))
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
}

fn fixed(knob: Knob, network: FixedNetwork) -> MethodSpec {
    let sha256 = words_sha256(&network);
    MethodSpec::Fixed { network: Arc::new(network), name: knob.name().into(), sha256 }
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
