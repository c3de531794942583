//! Speed against error of everything that can be left out: for each knob a curve, the default marked, and why it stands there.
//!
//! Knobs of capturing are judged by the light on the sensor against that of an exact computation, knobs of reconstruction by the picture
//! against the photograph. Rows go to a [`Journal`](crate::journal::Journal) as those of other studies.

mod knob;
mod list;
mod page;
mod verdict;

pub use knob::{Knob, Plan, Shortened, Work};
pub use list::{KNOBS, UnknownKnob};
pub use page::{Knobs, Point};

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::key::KeyText;
use crate::methods::spec::{Case, MethodSpec, PrepareError};
use crate::metrics::timing::{Range, timed};
use crate::metrics::{BORDER, MetricError, psnr};
use crate::trial::sensor;
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{ColourFrame, Noise, RawFrame, ReconstructError};
use edof_io::photos::Photo;
use edof_optics::Scene;
use edof_optics::capture::{Approximation, Capture, CaptureError, capture};
use edof_optics::layers::{self, LayersError};
use edof_optics::psf::{NoPsf, Settings};
use ndarray::Array2;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// A knob at one value on one photograph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Which.
    pub knob: &'static Knob,
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
    #[serde(with = "crate::metrics::number")]
    pub psnr_db: f64,
    /// Wall-clock seconds per megapixel, median of the runs.
    pub seconds_per_megapixel: f64,
    /// Least and most of the runs; none in rows of layout 1.
    #[serde(default)]
    pub seconds_range: Option<Range>,
    /// Sides in pixels of the smallest and the largest kernel of a capture; none where something is reconstructed, and in older rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kernel_sides: Option<[usize; 2]>,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a page calls a row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Subject {
    knob: &'static Knob,
    value: Ordered,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
}

impl Line for Row {
    const STUDY: &'static str = "knobs";
    const LAYOUT: u32 = 2;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        Subject {
            knob: self.knob,
            value: Ordered(self.value),
            psi: Ordered(self.psi),
            noise: Ordered::of_noise(self.noise),
            image: self.image.clone(),
        }
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        Self { seconds_per_megapixel: 0.0, seconds_range: None, ..self.clone() }
    }
}

/// A failed study.
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
    /// A method rejected a frame.
    #[error("{image}: {source}")]
    Reconstruct { image: String, source: ReconstructError },
    /// A method that cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
}

/// The experiment.
pub struct Turning<'a> {
    plan: &'a Plan,
    photos: &'a [Photo],
    captures: Captures,
}

/// A knob at a value on a photograph, and what is run there. Photograph by photograph, knobs and values in the order of their list.
pub struct Turned {
    photo: usize,
    place: usize,
    knob: &'static Knob,
    value: f64,
    work: Work,
}

impl Ord for Turned {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.photo, self.place).cmp(&(other.photo, other.place))
    }
}

impl PartialOrd for Turned {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Turned {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Turned {}

impl<'a> Turning<'a> {
    /// A plan's knobs on photographs.
    #[must_use]
    pub fn new(plan: &'a Plan, photos: &'a [Photo]) -> Self {
        Self { plan, photos, captures: Captures::default() }
    }
}

impl Experiment for Turning<'_> {
    type Row = Row;
    type Cell = Turned;
    type Error = KnobsError;

    fn cells(&self) -> Vec<(Key<Row>, Turned)> {
        let plan = self.plan;
        let camera_sha256 = sha256(plan.camera.to_json().as_bytes());
        let mut cells = vec![];
        for (number, photo) in self.photos.iter().enumerate() {
            let photo_sha256 = Input::photograph(&photo.name, &photo.frame).sha256;
            let values =
                plan.knobs.iter().flat_map(|&knob| knob.values(plan).into_iter().map(move |v| (knob, v)));
            for (place, (knob, value)) in values.enumerate() {
                let work = (knob.apply)(plan, value);
                let (how, weights) = match &work {
                    Work::Capture(shortened) => (shortened.key_text(), None),
                    Work::Method(spec) => (spec.settings(), spec.weights().map(str::to_owned)),
                };
                let sensor = sensor(&photo.name, plan.psi, plan.noise_of(&work));
                let subject = Subject {
                    knob,
                    value: Ordered(value),
                    psi: Ordered(plan.psi),
                    noise: Ordered::of_noise(plan.noise),
                    image: photo.name.clone(),
                };
                let proof = Proof {
                    settings: Some(settings(&[&how, &Approximation::default(), &sensor, &BORDER])),
                    weights,
                    photo: photo_sha256.clone(),
                    camera: Some(camera_sha256.clone()),
                    ..Proof::default()
                };
                cells.push((Key { subject, proof }, Turned { photo: number, place, knob, value, work }));
            }
        }
        cells
    }

    fn measure(&mut self, cells: &[(Turned, Proof)]) -> Result<Vec<Row>, KnobsError> {
        let Self { plan, photos, captures } = self;
        let row =
            |(turned, proof): &(Turned, Proof)| plan.row(turned, &photos[turned.photo], proof, captures);
        cells.iter().map(row).collect()
    }

    fn describe(&self, turned: &Turned) -> String {
        format!("{} {} on {}", turned.knob.name, turned.value, self.photos[turned.photo].name)
    }
}

/// What was measured on one photograph.
struct Measurement {
    psnr_db: f64,
    seconds: f64,
    range: Range,
    kernel_sides: Option<[usize; 2]>,
}

/// Light that is the same to the last bit counts as so far from an exact one.
const MAX_DB: f64 = 160.0;
/// What several values of a knob share.
#[derive(Default)]
struct Captures {
    /// Light of exact captures, which all values of a knob are held against, by knob and photograph.
    exact: BTreeMap<(&'static Knob, String), ColourFrame>,
    /// What is reconstructed, by photograph.
    raw: BTreeMap<String, RawFrame>,
}

impl Plan {
    fn row(
        &self,
        turned: &Turned,
        photo: &Photo,
        proof: &Proof,
        captures: &mut Captures,
    ) -> Result<Row, KnobsError> {
        let Turned { knob, value, work, .. } = turned;
        let Measurement { psnr_db, seconds, range, kernel_sides } = match work {
            Work::Capture(shortened) => {
                captures.exact.retain(|(of, _), _| of == knob);
                self.captured(knob, shortened, photo, captures)?
            }
            Work::Method(spec) => self.reconstructed(spec, photo, captures)?,
        };
        let (height, width) = photo.frame.size();
        let megapixels = (height * width) as f64 * 1e-6;
        Ok(Row {
            knob,
            value: *value,
            is_default: *value == (knob.default)(self),
            image: photo.name.clone(),
            psi: self.psi,
            noise: self.noise,
            psnr_db,
            seconds_per_megapixel: seconds / megapixels,
            seconds_range: Some(range.over(megapixels)),
            kernel_sides,
            proof: proof.clone(),
        })
    }

    /// Captures are judged by their light alone.
    const fn noise_of(&self, work: &Work) -> Noise {
        match work {
            Work::Capture(_) => Noise::None,
            Work::Method(_) => self.noise,
        }
    }

    /// A capture against an exact one.
    fn captured(
        &self,
        knob: &'static Knob,
        how: &Shortened,
        photo: &Photo,
        captures: &mut Captures,
    ) -> Result<Measurement, KnobsError> {
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
        let db = psnr(exact, &cut.light, BORDER)
            .map_err(|source| KnobsError::Metric { image: image(), source })?;
        let sides = || cut.depths.iter().flat_map(|depth| &depth.channels).map(|kernel| kernel.side);
        Ok(Measurement {
            psnr_db: db.min(MAX_DB),
            seconds: cut.seconds,
            range: Range { min: cut.seconds, max: cut.seconds },
            kernel_sides: sides().min().zip(sides().max()).map(<[usize; 2]>::from),
        })
    }

    /// The photograph with depths that rise from left to right over the camera's range, in at most N layers.
    fn ramp(&self, photo: &Photo, layers: usize) -> Result<Scene, KnobsError> {
        let (height, width) = photo.frame.size();
        let [low, high] = self.camera.psi_range;
        let psi = Array2::from_shape_fn((height, width), |(_, c)| {
            (low + (high - low) * c as f64 / (width - 1) as f64) as f32
        });
        layers::from_depths(&photo.name, &photo.frame, &psi, layers)
            .map_err(|source| KnobsError::Layers { image: photo.name.clone(), source })
    }

    /// What a method gives.
    fn reconstructed(
        &self,
        spec: &MethodSpec,
        photo: &Photo,
        captures: &mut Captures,
    ) -> Result<Measurement, KnobsError> {
        let image = || photo.name.clone();
        let raw = match captures.raw.entry(image()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(self.shot(photo)?),
        };
        let case =
            Case { camera: &self.camera, psi: self.psi, noise: self.noise, optics: Settings::default() };
        let timed = timed(spec.prepare(&case)?.as_ref(), raw)
            .map_err(|source| KnobsError::Reconstruct { image: image(), source })?;
        let psnr_db = psnr(&photo.frame, &timed.result.frame, BORDER)
            .map_err(|source| KnobsError::Metric { image: image(), source })?;
        Ok(Measurement { psnr_db, seconds: timed.result.seconds, range: timed.range, kernel_sides: None })
    }

    /// The photograph at the plan's depth, behind its camera.
    fn shot(&self, photo: &Photo) -> Result<RawFrame, KnobsError> {
        let scene = Scene::flat(photo.name.clone(), photo.frame.clone(), self.psi);
        let sensor = sensor(&photo.name, self.psi, self.noise);
        let shot = capture(&scene, &self.camera, &sensor, &Approximation::default());
        Ok(shot.map_err(|source| KnobsError::Capture { image: photo.name.clone(), source })?.raw)
    }
}

#[cfg(test)]
mod tests;
