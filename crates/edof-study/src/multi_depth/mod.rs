//! The paper's figure 7: scenes at four depths through several lenses, and every method on what their sensors gave, depth by depth.
//!
//! The paper holds blind deconvolution behind a clear lens that is focused at the end of the range against blind deconvolution, OMP and
//! the network behind the coded one. The clear lens focused mid-range, with a network of its own, is the fairer peer, and is measured next to them. Rows go to a [`Journal`](crate::journal::Journal) with their pictures, so that a report can be made from the file alone.

mod page;

pub use page::{MultiDepth, Shown};

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::methods::method::Method;
use crate::methods::spec::{Case, MethodSpec, PrepareError};
use crate::metrics::timing::{Range, Timed, timed};
use crate::metrics::{BORDER, MetricError};
use crate::pictures::{Names, Part, Picture, Truth};
use crate::report::picture::{Encoded, jpeg, png};
use edof_core::camera::Camera;
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{Noise, RawFrame, ReconstructError, Reconstructor, Tone};
use edof_optics::Scene;
use edof_optics::Sensor;
use edof_optics::capture::{Approximation, CaptureError, capture};
use edof_optics::draw::{DrawError, draw, parse_name};
use edof_optics::psf::Settings;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// What tables call the clear lens focused at the end of the range.
pub const BEHIND: &str = "clear lens, focused on the background";
/// The clear lens focused mid-range.
pub const MIDDLE: &str = "clear lens, focused mid-range";
/// The coded lens.
pub const CODED: &str = "coded lens";
/// What tables call demosaicing alone, blind deconvolution and OMP.
pub const DEMOSAICED: &str = "demosaiced";
/// See [`DEMOSAICED`].
pub const BLIND: &str = "blind deconvolution";
/// See [`DEMOSAICED`].
pub const OMP: &str = "OMP";

/// A synthetic scene, by its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Name of the scene, as in `chart-4`.
    pub scene: String,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// ψ of its parts, from back to front.
    pub psi: Vec<f64>,
    /// Of the scene and of the sensor's noise.
    pub seed: u64,
}

impl Drawn {
    /// The scene.
    ///
    /// # Errors
    /// [`DrawError`]: a name without a picture, sides out of range.
    pub fn draw(&self) -> Result<Scene, DrawError> {
        draw(parse_name(&self.scene)?.0, self.height, self.width, &self.psi, self.seed)
    }
}

/// A lens and what is done with the frames behind it.
pub struct Lens {
    /// What it is called in tables.
    pub title: &'static str,
    /// The lens.
    pub camera: Camera,
    /// Methods, and what each is called in tables.
    pub methods: Vec<(String, MethodSpec)>,
}

/// What is measured.
pub struct Plan {
    /// Scenes.
    pub scenes: Vec<Drawn>,
    /// Bits of the sensor.
    pub depth: u32,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What is measured: light, or its encoding.
    pub tone: Tone,
    /// Lenses; ours, the coded one, last, and its best method last of all.
    pub lenses: Vec<Lens>,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// One picture: what a method made of a scene behind a lens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The scene.
    #[serde(flatten)]
    pub drawn: Drawn,
    /// What is measured: light, or its encoding.
    pub tone: Tone,
    /// Noise of the sensor.
    pub noise: Noise,
    /// Bits of the sensor.
    pub depth: u32,
    /// Lens, method, quality and wall-clock seconds.
    #[serde(flatten)]
    pub picture: Picture,
    /// The method.
    pub identity: Method,
    /// Least and most of the runs' wall-clock seconds; none in rows of layout 1.
    #[serde(default)]
    pub seconds_range: Option<Range>,
    /// Seconds that all threads together were on a processor.
    pub cpu_seconds: Option<f64>,
    /// Least and most of those.
    #[serde(default)]
    pub cpu_seconds_range: Option<Range>,
    /// Runs whose median the times are.
    pub repetitions: usize,
    /// Steps of an iterative method, mean over patches or colours.
    pub iterations: Option<f64>,
    /// Most bytes of memory that the process held while the method ran.
    pub peak_memory_bytes: Option<u64>,
    /// Place among the rows of the command that measured it: tables keep it.
    pub place: usize,
    /// Hashes of inputs and settings; its photograph is the scene's light and depths.
    #[serde(flatten)]
    pub proof: Proof,
    /// The picture as it is looked at, a JPEG.
    pub shown: Encoded,
    /// A busy part of it at each depth, PNGs in the order of [`Truth::parts`].
    pub parts: Vec<Encoded>,
}

/// What a page calls a row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Subject {
    scene: String,
    sides: (usize, usize),
    seed: u64,
    tone: Tone,
    noise: Vec<Ordered>,
    depth: u32,
    lens: String,
    method: Method,
}

impl Line for Row {
    const STUDY: &'static str = "multi-depth";
    const LAYOUT: u32 = 2;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        Subject {
            scene: self.drawn.scene.clone(),
            sides: (self.drawn.height, self.drawn.width),
            seed: self.drawn.seed,
            tone: self.tone,
            noise: Ordered::of_noise(self.noise),
            depth: self.depth,
            lens: self.picture.lens.clone(),
            method: self.identity.clone(),
        }
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        let mut row = self.clone();
        (row.picture.seconds, row.cpu_seconds, row.repetitions) = (0.0, None, 0);
        (row.peak_memory_bytes, row.place) = (None, 0);
        (row.seconds_range, row.cpu_seconds_range) = (None, None);
        row
    }
}

/// A failed study.
#[derive(Debug, thiserror::Error)]
pub enum MultiDepthError {
    /// A scene that nothing draws.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// The scene, the sensor, or depths too far out of focus.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// A method that cannot be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// A method rejected the frame.
    #[error(transparent)]
    Reconstruct(#[from] ReconstructError),
    /// A scene too small to measure.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// A picture that cannot be encoded.
    #[error("picture: {0}")]
    Picture(#[from] image::ImageError),
}

/// A row to be measured, by places in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    scene: usize,
    lens: usize,
    method: usize,
    place: usize,
}

/// The experiment.
pub struct Scenes<'a> {
    plan: &'a Plan,
    /// Each with its hash.
    scenes: Vec<(Scene, String)>,
    /// Methods behind lenses.
    ready: HashMap<(usize, usize), Box<dyn Reconstructor>>,
    /// The scene and lens of the last cell: the truth, and what the sensor gave.
    shot: Option<((usize, usize), Truth, RawFrame)>,
}

impl<'a> Scenes<'a> {
    /// The plan's scenes.
    ///
    /// # Errors
    /// [`DrawError`].
    pub fn new(plan: &'a Plan) -> Result<Self, DrawError> {
        let drawn =
            |of: &Drawn| of.draw().map(|scene| (hash(&scene), scene)).map(|(hash, scene)| (scene, hash));
        let scenes = plan.scenes.iter().map(drawn).collect::<Result<_, _>>()?;
        Ok(Self { plan, scenes, ready: HashMap::new(), shot: None })
    }
}

impl Experiment for Scenes<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = MultiDepthError;

    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let plan = self.plan;
        let mut cells = vec![];
        for (scene, drawn) in plan.scenes.iter().enumerate() {
            for (lens, Lens { title, camera, methods }) in plan.lenses.iter().enumerate() {
                let camera = sha256(camera.to_json().as_bytes());
                for (method, (_, spec)) in methods.iter().enumerate() {
                    let (sensor, approximation) = plan.sensor(drawn);
                    let subject = Subject {
                        scene: drawn.scene.clone(),
                        sides: (drawn.height, drawn.width),
                        seed: drawn.seed,
                        tone: plan.tone,
                        noise: Ordered::of_noise(plan.noise),
                        depth: plan.depth,
                        lens: (*title).to_owned(),
                        method: spec.method(),
                    };
                    let proof = Proof {
                        settings: Some(settings(&[&spec.settings(), &approximation, &sensor, &BORDER])),
                        weights: spec.weights().map(str::to_owned),
                        photo: self.scenes[scene].1.clone(),
                        camera: Some(camera.clone()),
                        ..Proof::default()
                    };
                    let cell = Cell { scene, lens, method, place: cells.len() };
                    cells.push((Key { subject, proof }, cell));
                }
            }
        }
        cells
    }

    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, MultiDepthError> {
        let Self { plan, scenes, ready, shot } = self;
        let row = |(cell, proof): &(Cell, Proof)| {
            let (lens, at) = (&plan.lenses[cell.lens], (cell.scene, cell.lens));
            let (_, truth, raw) = match shot.take().filter(|(of, ..)| *of == at) {
                Some(same) => shot.insert(same),
                None => {
                    let (scene, drawn) = (&scenes[cell.scene].0, &plan.scenes[cell.scene]);
                    shot.insert((at, Truth::of(scene, plan.tone), plan.shot(drawn, scene, lens)?))
                }
            };
            let method = match ready.entry((cell.lens, cell.method)) {
                Entry::Occupied(entry) => entry.into_mut(),
                Entry::Vacant(entry) => entry.insert(lens.methods[cell.method].1.prepare(&plan.case(lens))?),
            };
            plan.row(*cell, truth, proof, timed(method.as_ref(), raw)?)
        };
        cells.iter().map(row).collect()
    }

    fn describe(&self, cell: &Cell) -> String {
        let lens = &self.plan.lenses[cell.lens];
        format!("{}: {}, {}", self.plan.scenes[cell.scene].scene, lens.title, lens.methods[cell.method].0)
    }
}

/// SHA-256 of a scene's light and depths.
fn hash(scene: &Scene) -> String {
    let light = Input::photograph(&scene.name, &scene.sharp()).sha256;
    let depths: Vec<u8> = scene.psi_map().iter().flat_map(|psi| psi.to_le_bytes()).collect();
    sha256(format!("{light}\n{}", sha256(&depths)).as_bytes())
}

impl Plan {
    /// The sensor, and how exactly its light is computed.
    fn sensor(&self, drawn: &Drawn) -> (Sensor, Approximation) {
        let sensor = Sensor { depth: self.depth, noise: self.noise, seed: drawn.seed, ..Sensor::default() };
        (sensor, Approximation { psf: self.optics, ..Approximation::default() })
    }

    /// What a sensor behind a lens gives.
    fn shot(&self, drawn: &Drawn, scene: &Scene, lens: &Lens) -> Result<RawFrame, CaptureError> {
        let (sensor, approximation) = self.sensor(drawn);
        Ok(capture(scene, &lens.camera, &sensor, &approximation)?.raw)
    }

    /// Blind methods take no depth from their case, and there is no one depth here.
    const fn case<'a>(&self, lens: &'a Lens) -> Case<'a> {
        Case { camera: &lens.camera, psi: 0.0, noise: self.noise, optics: self.optics }
    }

    fn row(&self, cell: Cell, truth: &Truth, proof: &Proof, timed: Timed) -> Result<Row, MultiDepthError> {
        let lens = &self.lenses[cell.lens];
        let (treatment, spec) = &lens.methods[cell.method];
        let Timed { result, range, cpu_seconds, cpu_range, peak_memory_bytes, repetitions } = timed;
        let identity = spec.method();
        let names =
            Names { lens: lens.title, camera: &lens.camera.name, treatment, method: &identity.to_string() };
        let part = |part: &Part| png(&part.of(&result.frame), Tone::Srgb).map(Encoded);
        Ok(Row {
            drawn: self.scenes[cell.scene].clone(),
            tone: self.tone,
            noise: self.noise,
            depth: self.depth,
            picture: truth.judge(names, &result.frame, result.seconds)?,
            identity,
            seconds_range: Some(range),
            cpu_seconds,
            cpu_seconds_range: cpu_range,
            repetitions,
            iterations: result.iterations,
            peak_memory_bytes,
            place: cell.place,
            proof: proof.clone(),
            shown: Encoded(jpeg(&result.frame, Tone::Srgb)?),
            parts: truth.parts().iter().map(part).collect::<Result<_, _>>()?,
        })
    }
}

#[cfg(test)]
mod tests;
