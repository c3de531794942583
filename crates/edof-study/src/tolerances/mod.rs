//! What must a maker hold? A camera with an error in one part, and the network that knows the camera without it.
//!
//! Every photograph is seen at the same depths and noise by the camera as designed and by cameras with errors of several amounts, either
//! way. The loss is paired: photograph, depth and noise are the same, only the kernels differ.

mod kind;
mod page;

pub use kind::Kind;
pub use page::{Curve, Loss, Tolerances};

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::methods::spec::{Case, MethodSpec};
use crate::metrics::BORDER;
use crate::tables::psi_words;
use crate::trial::{Trial, TrialError, sensor};
use edof_core::camera::Camera;
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{Noise, Reconstructor, Tone};
use edof_io::photos::Photo;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use serde::{Deserialize, Serialize};

/// What is measured.
pub struct Plan {
    /// The camera as designed.
    pub camera: Camera,
    /// The network that was trained for it.
    pub method: MethodSpec,
    /// Whether photographs are light or sRGB's encoding of it.
    pub tone: Tone,
    /// Depths.
    pub psi: Vec<f64>,
    /// Noise levels.
    pub noise: Vec<Noise>,
    /// Errors that are measured.
    pub kinds: Vec<Kind>,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// One photograph, depth and noise, seen by a camera with one error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What is wrong with the camera.
    pub kind: Kind,
    /// By how much.
    pub amount: f64,
    /// The same in micrometres, where it is a length.
    pub micrometres: Option<f64>,
    /// The network.
    pub method: String,
    /// Name of the camera.
    pub camera: String,
    /// Name of the photograph.
    pub image: String,
    /// Depth.
    pub psi: f64,
    /// Noise of the sensor.
    pub noise: Noise,
    /// PSNR in dB (peak 1).
    #[serde(with = "crate::metrics::number")]
    pub psnr_db: f64,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a page calls a row.
pub type Subject = (Kind, Ordered, Ordered, Vec<Ordered>, String);

impl Line for Row {
    const STUDY: &'static str = "tolerances";
    const LAYOUT: u32 = 1;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        let Self { kind, amount, psi, noise, image, .. } = self;
        (*kind, Ordered(*amount), Ordered(*psi), Ordered::of_noise(*noise), image.clone())
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        self.clone()
    }
}

/// A row to be measured, by places in the plan's lists. Rows of one camera, depth and photograph are measured together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    error: usize,
    psi: usize,
    photo: usize,
    noise: usize,
}

/// The experiment.
pub struct Tolerating<'a> {
    plan: &'a Plan,
    photos: &'a [Photo],
    errors: Vec<(Kind, f64)>,
    kernels: Option<((usize, usize), [Psf; 3])>,
    prepared: Vec<(Noise, Box<dyn Reconstructor>)>,
}

impl<'a> Tolerating<'a> {
    /// A plan on photographs.
    #[must_use]
    pub fn new(plan: &'a Plan, photos: &'a [Photo]) -> Self {
        let both = |kind: Kind| kind.amounts().iter().flat_map(move |&a| [(kind, -a), (kind, a)]);
        let errors = std::iter::once((Kind::None, 0.0)).chain(plan.kinds.iter().copied().flat_map(both));
        Self { plan, photos, errors: errors.collect(), kernels: None, prepared: vec![] }
    }

    fn camera(&self, error: usize) -> Camera {
        let (kind, amount) = self.errors[error];
        kind.applied(amount, &self.plan.camera)
    }

    fn kernels(&mut self, error: usize, psi: usize) -> Result<&[Psf; 3], TrialError> {
        let known = self.kernels.take().filter(|(at, _)| *at == (error, psi));
        let kernels = match known {
            Some(known) => known,
            None => {
                let psfs = channel_psfs(&self.camera(error), self.plan.psi[psi], &self.plan.optics)?;
                ((error, psi), psfs)
            }
        };
        Ok(&self.kernels.insert(kernels).1)
    }

    /// The network for a noise; it knows the camera as designed.
    fn method(&mut self, noise: Noise) -> Result<&dyn Reconstructor, TrialError> {
        let place = match self.prepared.iter().position(|(known, _)| *known == noise) {
            Some(place) => place,
            None => {
                let Plan { camera, method, optics, .. } = self.plan;
                let prepared = method.prepare(&Case { camera, psi: 0.0, noise, optics: *optics })?;
                self.prepared.push((noise, prepared));
                self.prepared.len() - 1
            }
        };
        Ok(self.prepared[place].1.as_ref())
    }
}

impl Experiment for Tolerating<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = TrialError;

    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let plan = self.plan;
        let hashes: Vec<String> =
            self.photos.iter().map(|p| Input::photograph(&p.name, &p.frame).sha256).collect();
        let mut cells = vec![];
        for (error, &(kind, amount)) in self.errors.iter().enumerate() {
            let camera = sha256(self.camera(error).to_json().as_bytes());
            for (psi, &depth) in plan.psi.iter().enumerate() {
                for (photo, of) in self.photos.iter().enumerate() {
                    for (noise, &level) in plan.noise.iter().enumerate() {
                        let sensor = sensor(&of.name, depth, level);
                        let own = &plan.method.settings();
                        let proof = Proof {
                            settings: Some(settings(&[own, &plan.optics, &plan.tone, &sensor, &BORDER])),
                            weights: plan.method.weights().map(str::to_owned),
                            photo: hashes[photo].clone(),
                            camera: Some(camera.clone()),
                            ..Proof::default()
                        };
                        let noise_key = Ordered::of_noise(level);
                        let subject = (kind, Ordered(amount), Ordered(depth), noise_key, of.name.clone());
                        cells.push((Key { subject, proof }, Cell { error, psi, photo, noise }));
                    }
                }
            }
        }
        cells
    }

    fn belongs_to(&self, a: &Cell, b: &Cell) -> bool {
        (a.error, a.psi, a.photo) == (b.error, b.psi, b.photo)
    }

    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, TrialError> {
        let (plan, Cell { error, psi, photo, .. }) = (self.plan, cells[0].0);
        let trial = Trial::new(&plan.camera, &self.photos[photo], plan.psi[psi], plan.tone);
        let shots = trial.shots(self.kernels(error, psi)?, &plan.noise)?;
        let (kind, amount) = self.errors[error];
        let method = plan.method.method().to_string();
        let mut rows = vec![];
        for (cell, proof) in cells {
            let (noise, raw) = &shots[cell.noise];
            let result = self
                .method(*noise)?
                .reconstruct(raw)
                .map_err(|source| TrialError::Reconstruct { image: trial.image(), source })?;
            rows.push(Row {
                kind,
                amount,
                micrometres: kind.micrometres(amount, &plan.camera),
                method: method.clone(),
                camera: plan.camera.name.clone(),
                image: trial.image(),
                psi: plan.psi[psi],
                noise: *noise,
                psnr_db: trial.psnr_db(&result)?,
                proof: proof.clone(),
            });
        }
        Ok(rows)
    }

    fn describe(&self, cell: &Cell) -> String {
        let ((kind, amount), psi) = (self.errors[cell.error], self.plan.psi[cell.psi]);
        format!(
            "{} {amount:+} {}, psi {}: {}",
            kind.name(),
            kind.unit(),
            psi_words(psi),
            self.photos[cell.photo].name
        )
    }
}

#[cfg(test)]
mod tests;
