//! Speed against error on scenes of one depth, the paper's figure 5: every method on every photograph, prepared for its case first.
//!
//! Rows go to a file of JSON lines as they come ([`Journal`](crate::journal::Journal)), so an interrupted study resumes; what is there already is not
//! measured again, and several machines may share a study ([`Shard`](crate::journal::Shard)). Noise depends on photograph, ψ and noise level alone, as in
//! [`kodak`](crate::kodak), and all methods see the same captures.

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::methods::method::{Family, Format, Method};
use crate::methods::spec::{MethodSpec, Ready};
use crate::metrics::BORDER;
use crate::metrics::timing::{Range, Timed, timed};
use crate::tables::psi_words;
use crate::trial::{Measured, Trial, TrialError, sensor};
use edof_core::camera::Camera;
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{Noise, RawFrame, Tone};
use edof_io::photos::Photo;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use serde::{Deserialize, Serialize};

/// What is measured.
pub struct Plan {
    /// The camera that all methods stand behind.
    pub camera: Camera,
    /// What photographs' numbers are taken for.
    pub tone: Tone,
    /// Depths.
    pub psi: Vec<f64>,
    /// Noise levels.
    pub noise: Vec<Noise>,
    /// Methods.
    pub methods: Vec<MethodSpec>,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// One method on one photograph at one depth and noise level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Quality, time and work.
    #[serde(flatten)]
    pub measured: Measured,
    /// Least and most of the runs' wall-clock seconds per megapixel; none in rows of layout 1.
    #[serde(default)]
    pub seconds_range: Option<Range>,
    /// Wall-clock seconds of preparing for the case, once for all photographs.
    pub prepare_seconds: f64,
    /// Runs whose median the time is.
    pub repetitions: usize,
    /// Seconds that all threads together were on a processor, a megapixel, median of the same runs; none where nothing was measured, and
    /// in rows from before it was.
    #[serde(default)]
    pub cpu_seconds_per_megapixel: Option<f64>,
    /// Least and most of those.
    #[serde(default)]
    pub cpu_seconds_range: Option<Range>,
    /// Steps of an iterative method, mean over patches or colours; none for methods without, and in rows from before they were counted.
    #[serde(default)]
    pub iterations: Option<f64>,
    /// Most bytes of memory that the process held while the method ran, photographs and other methods included; none where the system
    /// does not tell, and in rows from before it was asked.
    #[serde(default)]
    pub peak_memory_bytes: Option<u64>,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a page calls a row. Rows of one method follow each other, so that shards of a study get equal shares of slow and of fast ones.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Subject {
    method: Method,
    camera: String,
    tone: Tone,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
}

impl Line for Row {
    const STUDY: &'static str = "single-depth";
    const LAYOUT: u32 = 2;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        let Measured { identity, camera, tone, psi, noise, image, .. } = &self.measured;
        Subject {
            method: identity.clone(),
            camera: camera.clone(),
            tone: *tone,
            psi: Ordered(*psi),
            noise: Ordered::of_noise(*noise),
            image: image.clone(),
        }
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        let mut row = self.clone();
        (row.measured.seconds_per_megapixel, row.prepare_seconds, row.repetitions) = (0.0, 0.0, 0);
        (row.cpu_seconds_per_megapixel, row.peak_memory_bytes) = (None, None);
        (row.seconds_range, row.cpu_seconds_range) = (None, None);
        row
    }
}

/// A row to be measured, by places in the plan and the list of photographs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    psi: usize,
    photo: usize,
    noise: usize,
    method: usize,
}

/// The experiment.
pub struct SingleDepth<'a> {
    plan: &'a Plan,
    photos: &'a [Photo],
    depth: Option<Depth<'a>>,
}

/// What one depth has, and the photograph that is at it.
struct Depth<'a> {
    psi: usize,
    psfs: [Psf; 3],
    ready: Ready<'a>,
    shown: Option<Shown<'a>>,
}

/// A photograph, and what the sensor gives of it at each noise level.
struct Shown<'a> {
    photo: usize,
    trial: Trial<'a>,
    shots: Vec<(Noise, RawFrame)>,
}

impl<'a> SingleDepth<'a> {
    /// A plan on photographs.
    #[must_use]
    pub const fn new(plan: &'a Plan, photos: &'a [Photo]) -> Self {
        Self { plan, photos, depth: None }
    }

    /// Methods, a photograph and its shots; what the last cell left is taken where it is of the same.
    fn ready(&mut self, cell: Cell) -> Result<(&mut Ready<'a>, &Shown<'a>), TrialError> {
        let Self { plan, photos, depth } = self;
        let psi = plan.psi[cell.psi];
        let Depth { psfs, ready, shown, .. } = match depth.take().filter(|depth| depth.psi == cell.psi) {
            Some(same) => depth.insert(same),
            None => depth.insert(Depth {
                psi: cell.psi,
                psfs: channel_psfs(&plan.camera, psi, &plan.optics)?,
                ready: Ready::new(&plan.camera, &plan.methods, psi, plan.optics),
                shown: None,
            }),
        };
        let shown = match shown.take().filter(|shown| shown.photo == cell.photo) {
            Some(same) => shown.insert(same),
            None => {
                let trial = Trial::new(&plan.camera, &photos[cell.photo], psi, plan.tone);
                let shots = trial.shots(psfs, &plan.noise)?;
                shown.insert(Shown { photo: cell.photo, trial, shots })
            }
        };
        Ok((ready, &*shown))
    }
}

impl Experiment for SingleDepth<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = TrialError;

    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let Plan { camera, tone, psi: depths, noise: levels, methods, optics } = self.plan;
        let mut cells = vec![];
        let camera_sha256 = sha256(camera.to_json().as_bytes());
        for (photo, of) in self.photos.iter().enumerate() {
            let photo_sha256 = Input::photograph(&of.name, &of.frame).sha256;
            let depths = depths.iter().enumerate();
            let places = depths.flat_map(|depth| levels.iter().enumerate().map(move |noise| (depth, noise)));
            for ((psi, &depth), (noise, &level)) in places {
                let sensor = sensor(&of.name, depth, level);
                for (method, spec) in methods.iter().enumerate() {
                    let subject = Subject {
                        method: spec.method(),
                        camera: camera.name.clone(),
                        tone: *tone,
                        psi: Ordered(depth),
                        noise: Ordered::of_noise(level),
                        image: of.name.clone(),
                    };
                    let proof = Proof {
                        settings: Some(settings(&[&spec.settings(), optics, &sensor, &BORDER])),
                        weights: spec.weights().map(str::to_owned),
                        photo: photo_sha256.clone(),
                        camera: Some(camera_sha256.clone()),
                        ..Proof::default()
                    };
                    cells.push((Key { subject, proof }, Cell { psi, photo, noise, method }));
                }
            }
        }
        cells
    }

    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, TrialError> {
        let row = |(cell, proof): &(Cell, Proof)| {
            let (ready, Shown { trial, shots, .. }) = self.ready(*cell)?;
            trial.timed_row(&shots[cell.noise], cell.method, proof, ready)
        };
        cells.iter().map(row).collect()
    }

    fn describe(&self, cell: &Cell) -> String {
        let (method, photo) = (self.plan.methods[cell.method].method(), &self.photos[cell.photo].name);
        format!("{method} on {photo} at psi {}", psi_words(self.plan.psi[cell.psi]))
    }
}

impl Trial<'_> {
    /// What a method makes of a shot, and its times.
    fn timed_row(
        &self,
        (noise, raw): &(Noise, RawFrame),
        method: usize,
        proof: &Proof,
        ready: &mut Ready<'_>,
    ) -> Result<Row, TrialError> {
        let identity = ready.identity(method);
        let prepared = ready.method(*noise, method)?;
        // A computed time does not vary.
        let is_measured = identity.format != Some(Format::Board);
        let is_elsewhere = identity.family == Family::External;
        let run = prepared.reconstructor;
        let Timed { result, range, cpu_seconds, cpu_range, peak_memory_bytes, repetitions } =
            match is_measured {
                true if is_elsewhere => timed(run, raw).map(Timed::elsewhere),
                true => timed(run, raw),
                false => run.reconstruct(raw).map(Timed::not),
            }
            .map_err(|source| TrialError::Reconstruct { image: self.image(), source })?;
        let (height, width) = raw.size();
        let megapixels = (height * width) as f64 * 1e-6;
        Ok(Row {
            measured: self.row(*noise, &identity, &result)?,
            seconds_range: Some(range.over(megapixels)),
            prepare_seconds: prepared.seconds,
            repetitions,
            iterations: result.iterations,
            peak_memory_bytes,
            cpu_seconds_per_megapixel: cpu_seconds.map(|seconds| seconds / megapixels),
            cpu_seconds_range: cpu_range.map(|range| range.over(megapixels)),
            proof: proof.clone(),
        })
    }
}

#[cfg(test)]
mod tests;
