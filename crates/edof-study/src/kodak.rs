//! The main experiment: every method behind its camera, on every photograph, depth and noise level.
//!
//! A photograph is light under the tone asked for: its numbers as they are (the paper's convention), or decoded from sRGB. It
//! is blurred by the camera's kernels at each ψ, exposed with 16 bits and noise, and reconstructed; the result is compared
//! with the photograph as a picture and as light. The noise depends on photograph, ψ and noise level alone, so that all
//! cameras and methods meet the same. Methods run one after the other, each on all threads, so that their times can be
//! compared; all else runs side by side.

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::methods::method::{Family, Method};
use crate::methods::spec::Ready;
use crate::metrics::BORDER;
use crate::report::picture::Encoded;
use crate::setup::Setup;
use crate::tables::psi_words;
use crate::trial::{Measured, Trial, TrialError, sensor};
use edof_core::camera::Camera;
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{Noise, Tone};
use edof_io::photos::Photo;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Settings of an experiment.
#[derive(Debug, Clone)]
pub struct Conditions {
    /// Whether photographs hold light or sRGB's encoding of it.
    pub tone: Tone,
    /// Depths.
    pub psi: Vec<f64>,
    /// Noise levels.
    pub noise: Vec<Noise>,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// The same with what it was measured from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Quality, time and work.
    #[serde(flatten)]
    pub measured: Measured,
    /// Place of camera and method among those of the command that measured it: tables keep it.
    pub place: usize,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
    /// The busiest part of the picture as it is looked at, a JPEG; at the farthest depth alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crop: Option<Encoded>,
    /// The same of the photograph; beside one method's alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub photograph_crop: Option<Encoded>,
}

/// What a page calls a row.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Subject {
    camera: String,
    method: Method,
    tone: Tone,
    psi: Ordered,
    noise: Vec<Ordered>,
    image: String,
}

impl Line for Row {
    const STUDY: &'static str = "kodak";
    const LAYOUT: u32 = 2;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        let Measured { identity, camera, tone, psi, noise, image, .. } = &self.measured;
        Subject {
            camera: camera.clone(),
            method: identity.clone(),
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
        (row.measured.seconds_per_megapixel, row.place) = (0.0, 0);
        (row.crop, row.photograph_crop) = (None, None);
        row
    }
}

/// What is measured.
pub struct Plan {
    /// Cameras and their methods, in the order of tables.
    pub setups: Vec<Setup>,
    /// Depths, noise levels, tone, kernels.
    pub conditions: Conditions,
}

/// A row to be measured, by places in the plan and the list of photographs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    setup: usize,
    psi: usize,
    photo: usize,
    noise: usize,
    method: usize,
    place: usize,
}

/// The experiment.
pub struct Kodak<'a> {
    plan: &'a Plan,
    photos: &'a [Photo],
    depth: Option<Depth<'a>>,
}

/// Kernels and methods of one depth behind one camera.
struct Depth<'a> {
    at: (usize, usize),
    /// Of each exposure.
    kernels: Vec<[Psf; 3]>,
    ready: Ready<'a>,
}

impl<'a> Kodak<'a> {
    /// A plan on photographs.
    #[must_use]
    pub const fn new(plan: &'a Plan, photos: &'a [Photo]) -> Self {
        Self { plan, photos, depth: None }
    }

    fn depth(&mut self, setup: usize, psi: usize) -> Result<&mut Depth<'a>, TrialError> {
        let fresh = self.depth.take().filter(|depth| depth.at == (setup, psi));
        let depth = match fresh {
            Some(depth) => depth,
            None => {
                let Plan { setups, conditions } = self.plan;
                let (own, psi_value) = (&setups[setup], conditions.psi[psi]);
                let of = |camera: &Camera| channel_psfs(camera, psi_value, &conditions.optics);
                let kernels = own.cameras().iter().map(of).collect::<Result<_, _>>()?;
                let ready = Ready::new(&own.camera, &own.methods, psi_value, conditions.optics);
                Depth { at: (setup, psi), kernels, ready }
            }
        };
        Ok(self.depth.insert(depth))
    }
}

impl Experiment for Kodak<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = TrialError;

    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let Conditions { tone, psi: depths, noise: levels, optics } = &self.plan.conditions;
        let hashes: Vec<String> =
            self.photos.iter().map(|p| Input::photograph(&p.name, &p.frame).sha256).collect();
        let (mut cells, mut first) = (vec![], 0);
        for (setup, own) in self.plan.setups.iter().enumerate() {
            let Setup { camera, methods, .. } = own;
            let cameras: String = own.cameras().iter().map(Camera::to_json).collect();
            let (camera_sha256, levels) = (sha256(cameras.as_bytes()), own.levels(levels));
            let depths = depths.iter().enumerate();
            let places =
                depths.flat_map(|depth| self.photos.iter().enumerate().map(move |photo| (depth, photo)));
            let places = places.flat_map(|place| levels.iter().enumerate().map(move |noise| (place, noise)));
            for (((psi, &depth), (photo, of)), (noise, &(level, share))) in places {
                let sensor = sensor(&of.name, depth, share);
                for (method, spec) in methods.iter().enumerate() {
                    let subject = Subject {
                        camera: camera.name.clone(),
                        method: spec.method(),
                        tone: *tone,
                        psi: Ordered(depth),
                        noise: Ordered::of_noise(level),
                        image: of.name.clone(),
                    };
                    let proof = Proof {
                        settings: Some(settings(&[&spec.settings(), optics, &sensor, &BORDER])),
                        weights: spec.weights().map(str::to_owned),
                        photo: hashes[photo].clone(),
                        camera: Some(camera_sha256.clone()),
                        ..Proof::default()
                    };
                    let cell = Cell { setup, psi, photo, noise, method, place: first + method };
                    cells.push((Key { subject, proof }, cell));
                }
            }
            first += methods.len();
        }
        cells
    }

    fn belongs_to(&self, a: &Cell, b: &Cell) -> bool {
        (a.setup, a.psi, a.photo) == (b.setup, b.psi, b.photo)
    }

    /// Rows of one photograph: reconstructed in turn, compared side by side.
    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, TrialError> {
        let Cell { setup, psi, photo, .. } = cells[0].0;
        let conditions = &self.plan.conditions;
        let (own, photo) = (&self.plan.setups[setup], &self.photos[photo]);
        let trial = Trial::new(&own.camera, photo, conditions.psi[psi], conditions.tone);
        let (levels, shares): (Vec<Noise>, Vec<Noise>) = own.levels(&conditions.noise).into_iter().unzip();
        let Depth { kernels, ready, .. } = self.depth(setup, psi)?;
        let shots = trial.exposures(kernels, &shares)?;
        let mut done = vec![];
        for (cell, proof) in cells {
            let (noise, raws) = (&levels[cell.noise], shots[cell.noise].iter().collect::<Vec<_>>());
            let method = ready.method(shares[cell.noise], cell.method)?.reconstructor;
            let result = method
                .reconstruct_exposures(&raws)
                .map_err(|source| TrialError::Reconstruct { image: trial.image(), source })?;
            done.push((*noise, ready.identity(cell.method), result, cell.place, proof.clone()));
        }
        // What the far end of the range looks like.
        let farthest = conditions.psi.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let part = Some(()).filter(|()| conditions.psi[psi] == farthest).and_then(|()| trial.busiest_part());
        done.into_par_iter()
            .map(|(noise, method, result, place, proof)| {
                let measured = trial.row(noise, &method, &result)?;
                let crop = part.map(|at| trial.crop(&result.frame, at)).transpose()?;
                let is_first = method.family == Family::DemosaicMalvar;
                let photograph_crop =
                    part.filter(|_| is_first).map(|at| trial.crop_of_photograph(at)).transpose()?;
                Ok(Row { measured, place, proof, crop, photograph_crop })
            })
            .collect()
    }

    fn describe(&self, cell: &Cell) -> String {
        let (camera, psi) = (&self.plan.setups[cell.setup].camera.name, self.plan.conditions.psi[cell.psi]);
        format!("{camera} at psi {}: {}", psi_words(psi), self.photos[cell.photo].name)
    }
}

#[cfg(test)]
mod tests;
