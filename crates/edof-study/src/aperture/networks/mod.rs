//! The same question, answered by networks: each lens, aperture and range with a network of its own, on photographs as real light.
//!
//! A network's camera states its lens, aperture and range of depths. Behind a lens that is closed by `s` stops a white pixel gets 2^s times
//! fewer electrons, and every ψ is 2^s times smaller. Networks of one camera are one method: each light meets the network that was trained for its noise.

mod page;
mod peer;

pub use page::{ApertureNetworks, Comparison, Peers, Reached};
pub use peer::{Peer, PeerError};

use super::{Best, Lens, along};
use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::methods::spec::Case;
use crate::metrics::BORDER;
use crate::tables::psi_words;
use crate::trial::{Trial, TrialError, sensor};
use edof_core::noise::{Noise, SensorNoise};
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{Reconstructor, Tone};
use edof_io::photos::Photo;
use edof_optics::estimator::JudgeError;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use serde::{Deserialize, Serialize};

/// Photographs are decoded to light.
const TONE: Tone = Tone::Srgb;
/// Depths at which a range of ψ is sampled.
const DEPTHS: usize = 5;

/// What is compared.
pub struct Plan {
    /// Light levels, read noise, and the settings of the closed-form estimator whose numbers are next to those of the networks.
    pub estimator: super::Plan,
    /// Lenses with their networks.
    pub peers: Vec<Peer>,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// One photograph at one depth in one light behind one lens, reconstructed by its network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Which lens.
    pub lens: Lens,
    /// Stops by which it is closed.
    pub stops: f64,
    /// F-number of the lens at that aperture.
    pub f_number: f64,
    /// Far end of the range of ψ, at the open aperture.
    pub range: f64,
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// Focus of the lens, in ψ of the open aperture.
    pub focus_psi: f64,
    /// The network, or several of which each light meets its own.
    pub network: String,
    /// Windows that the network, or each of several, was trained on.
    pub windows: u64,
    /// Name of the photograph.
    pub image: String,
    /// Depth, in ψ of the open aperture.
    pub psi: f64,
    /// PSNR in dB (peak 1) of the encoded picture.
    #[serde(with = "crate::metrics::number")]
    pub psnr_db: f64,
    /// What the closed-form estimator expects in that light, averaged over the range.
    pub estimated_average_db: f64,
    /// The same at the worst depth of the range.
    pub estimated_worst_db: f64,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// What a page calls a row.
pub type Subject = (Lens, Ordered, Ordered, Ordered, String, Ordered);

impl Line for Row {
    const STUDY: &'static str = "aperture-networks";
    const LAYOUT: u32 = 1;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        let Self { lens, stops, range, electrons, image, psi, .. } = self;
        (*lens, Ordered(*stops), Ordered(*range), Ordered(*electrons), image.clone(), Ordered(*psi))
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        self.clone()
    }
}

/// A row that could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum NetworksError {
    /// The estimator.
    #[error(transparent)]
    Judge(#[from] JudgeError),
    /// The photograph, its kernels or its reconstruction.
    #[error(transparent)]
    Trial(#[from] TrialError),
}

/// A row to be measured, by places in the plan's lists. Rows of one lens, depth and photograph are measured together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    peer: usize,
    psi: usize,
    photo: usize,
    light: usize,
}

/// The experiment.
pub struct Photographing<'a> {
    plan: &'a Plan,
    photos: &'a [Photo],
    estimated: Option<(usize, Vec<Best>)>,
    kernels: Option<((usize, usize), [Psf; 3])>,
}

impl<'a> Photographing<'a> {
    /// A plan on photographs.
    #[must_use]
    pub const fn new(plan: &'a Plan, photos: &'a [Photo]) -> Self {
        Self { plan, photos, estimated: None, kernels: None }
    }

    /// What the estimator expects of a lens in every light of the plan.
    fn estimated(&mut self, peer: usize) -> Result<Vec<Best>, JudgeError> {
        if self.estimated.as_ref().is_none_or(|(known, _)| *known != peer) {
            let (plan, Peer { camera, stops, range, .. }) = (&self.plan.estimator, &self.plan.peers[peer]);
            self.estimated = Some((peer, plan.judged(camera, *stops, *range, &plan.electrons)?));
        }
        Ok(self.estimated.as_ref().map(|(_, all)| all.clone()).unwrap_or_default())
    }

    fn kernels(&mut self, peer: usize, psi: usize) -> Result<&[Psf; 3], TrialError> {
        let known = self.kernels.take().filter(|(at, _)| *at == (peer, psi));
        let kernels = match known {
            Some(known) => known,
            None => {
                let own = &self.plan.peers[peer];
                ((peer, psi), channel_psfs(&own.camera, own.depths()[psi].1, &self.plan.optics)?)
            }
        };
        Ok(&self.kernels.insert(kernels).1)
    }
}

impl Plan {
    /// Noise of a light behind a lens: the gain is raised until white fills the scale again.
    fn noise(&self, peer: &Peer, electrons: f64) -> Noise {
        let full_well_e = electrons * (-peer.stops).exp2();
        Noise::Sensor(SensorNoise { full_well_e, read_noise_e: self.estimator.read_noise_e, gain: 1.0 })
    }

    fn proof(&self, peer: &Peer, photo: (&str, &str), psi: f64, electrons: f64) -> Proof {
        let sensor = sensor(photo.0, psi, self.noise(peer, electrons));
        let estimator = self.estimator.proof().settings;
        let own = &peer.method.settings();
        Proof {
            settings: Some(settings(&[own, &self.optics, &TONE, &sensor, &BORDER, &estimator])),
            weights: peer.method.weights().map(str::to_owned),
            photo: photo.1.to_owned(),
            camera: Some(sha256(peer.camera.to_json().as_bytes())),
            ..Proof::default()
        }
    }
}

impl Experiment for Photographing<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = NetworksError;

    /// Lights whose noise no network of the lens was trained for are left out.
    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let plan = self.plan;
        let hashes: Vec<String> =
            self.photos.iter().map(|p| Input::photograph(&p.name, &p.frame).sha256).collect();
        let mut cells = vec![];
        for (peer, own) in plan.peers.iter().enumerate() {
            let lights = plan.estimator.electrons.iter().enumerate();
            let lights: Vec<_> = lights.filter(|(_, e)| own.knows(plan.noise(own, **e))).collect();
            for (psi, (open, depth)) in own.depths().into_iter().enumerate() {
                for (photo, of) in self.photos.iter().enumerate() {
                    for &(light, &electrons) in &lights {
                        let subject = (
                            own.lens,
                            Ordered(own.stops),
                            Ordered(own.range),
                            Ordered(electrons),
                            of.name.clone(),
                            Ordered(open),
                        );
                        let proof = plan.proof(own, (&of.name, &hashes[photo]), depth, electrons);
                        cells.push((Key { subject, proof }, Cell { peer, psi, photo, light }));
                    }
                }
            }
        }
        cells
    }

    fn belongs_to(&self, a: &Cell, b: &Cell) -> bool {
        (a.peer, a.psi, a.photo) == (b.peer, b.psi, b.photo)
    }

    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, NetworksError> {
        let (plan, Cell { peer, psi, photo, .. }) = (self.plan, cells[0].0);
        let (own, estimated) = (&plan.peers[peer], self.estimated(peer)?);
        let (open, depth) = own.depths()[psi];
        let trial = Trial::new(&own.camera, &self.photos[photo], depth, TONE);
        let electrons = |cell: &Cell| plan.estimator.electrons[cell.light];
        let noise: Vec<Noise> = cells.iter().map(|(cell, _)| plan.noise(own, electrons(cell))).collect();
        let shots = trial.shots(self.kernels(peer, psi)?, &noise)?;
        let mut rows = vec![];
        for ((cell, proof), (noise, raw)) in cells.iter().zip(&shots) {
            let case = Case { camera: &own.camera, psi: depth, noise: *noise, optics: plan.optics };
            let prepared: Box<dyn Reconstructor> = own.method.prepare(&case).map_err(TrialError::from)?;
            let result = prepared
                .reconstruct(raw)
                .map_err(|source| TrialError::Reconstruct { image: trial.image(), source })?;
            rows.push(Row {
                lens: own.lens,
                stops: own.stops,
                f_number: own.camera.f_number(),
                range: own.range,
                electrons: electrons(cell),
                focus_psi: own.camera.focus_psi * own.stops.exp2(),
                network: own.name.clone(),
                windows: own.windows,
                image: trial.image(),
                psi: open,
                psnr_db: trial.psnr_db(&result)?,
                estimated_average_db: estimated[cell.light].average_db,
                estimated_worst_db: estimated[cell.light].worst_db,
                proof: proof.clone(),
            });
        }
        Ok(rows)
    }

    fn describe(&self, cell: &Cell) -> String {
        let own = &self.plan.peers[cell.peer];
        format!(
            "{} at psi {}: {}",
            own.camera.name,
            psi_words(own.depths()[cell.psi].0),
            self.photos[cell.photo].name
        )
    }
}

#[cfg(test)]
mod tests;
