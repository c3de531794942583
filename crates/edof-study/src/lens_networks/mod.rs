//! Lenses in equal light, each with networks of its own: which mask a scene needs, and what knowing the depth would be worth.
//!
//! A network's camera states its lens and aperture. Closed by `s` stops a white pixel gets 2^s times fewer electrons, and every ψ is 2^s times
//! smaller. A network of a range of depths is blind: it serves every depth. One that was trained at a single depth knows it, and serves each depth with
//! the same kernels. A network of several exposures sees as many raw frames of a scene, which share the exposure time and have a focus each. Networks that
//! differ in their seed alone say what chance does.

mod page;
mod peer;

pub use page::{Lens, LensNetworks};
pub use peer::{Peer, PeerError, Psi, peers};

use crate::experiment::Experiment;
use crate::journal::{Key, Line, Ordered, Proof, settings};
use crate::methods::spec::Case;
use crate::metrics::BORDER;
use crate::tables::psi_words;
use crate::trial::{Trial, TrialError, sensor};
use edof_core::camera::Camera;
use edof_core::noise::{Noise, SensorNoise};
use edof_core::storage::digest::sha256;
use edof_core::storage::provenance::Input;
use edof_core::{RawFrame, Reconstructor, Tone};
use edof_io::photos::Photo;
use edof_optics::psf::{Psf, Settings, channel_psfs};
use serde::{Deserialize, Serialize};

/// Photographs are decoded to light.
const TONE: Tone = Tone::Srgb;

/// The lenses, lights and settings that are compared.
pub struct Plan {
    /// Networks behind their lenses.
    pub peers: Vec<Peer>,
    /// Light levels: electrons of a white pixel behind the open aperture.
    pub electrons: Vec<f64>,
    /// Read noise in electrons, standard deviation.
    pub read_noise_e: f64,
    /// How exactly kernels are computed.
    pub optics: Settings,
}

/// One photograph at one depth in one light behind one lens, reconstructed by one network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the camera.
    pub lens: String,
    /// Whether it has no mask.
    pub clear: bool,
    /// Stops by which it is closed.
    pub stops: f64,
    /// Whether the network was trained for this depth alone.
    pub known: bool,
    /// Foci of the exposures that share the exposure time, in ψ of the open aperture; empty where there is one exposure.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub foci: Vec<f64>,
    /// Seed of the training.
    pub seed: u64,
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// Depth, in ψ of the open aperture.
    pub psi: f64,
    /// Name of the photograph.
    pub image: String,
    /// PSNR in dB (peak 1) of the encoded picture.
    #[serde(with = "crate::metrics::number")]
    pub psnr_db: f64,
    /// Hashes of inputs and settings.
    #[serde(flatten)]
    pub proof: Proof,
}

/// The place of a row on a page.
pub type Subject = (String, bool, Vec<Ordered>, u64, Ordered, Ordered, String);

impl Line for Row {
    const STUDY: &'static str = "lens-networks";
    const LAYOUT: u32 = 1;
    type Subject = Subject;

    fn subject(&self) -> Subject {
        let Self { lens, known, foci, seed, electrons, psi, image, .. } = self;
        (lens.clone(), *known, ordered(foci), *seed, Ordered(*electrons), Ordered(*psi), image.clone())
    }

    fn proof(&self) -> &Proof {
        &self.proof
    }

    fn timeless(&self) -> Self {
        self.clone()
    }
}

fn ordered(foci: &[f64]) -> Vec<Ordered> {
    foci.iter().copied().map(Ordered).collect()
}

/// A row to be measured, by places in the plan's lists. Rows of one network, depth and photograph are measured together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cell {
    peer: usize,
    psi: usize,
    photo: usize,
    light: usize,
}

/// Places of a peer and a depth in the plan.
type At = (usize, usize);

/// The experiment.
pub struct Photographing<'a> {
    plan: &'a Plan,
    photos: &'a [Photo],
    kernels: Option<(At, Vec<[Psf; 3]>)>,
}

impl<'a> Photographing<'a> {
    /// A plan on photographs.
    #[must_use]
    pub const fn new(plan: &'a Plan, photos: &'a [Photo]) -> Self {
        Self { plan, photos, kernels: None }
    }

    /// Kernels of each exposure.
    fn kernels(&mut self, peer: usize, psi: usize) -> Result<&[[Psf; 3]], TrialError> {
        let known = self.kernels.take().filter(|(at, _)| *at == (peer, psi));
        let kernels = match known {
            Some(known) => known,
            None => {
                let own = &self.plan.peers[peer];
                let of = |camera| channel_psfs(camera, own.psis[psi].own, &self.plan.optics);
                ((peer, psi), own.cameras.iter().map(of).collect::<Result<_, _>>()?)
            }
        };
        Ok(&self.kernels.insert(kernels).1)
    }
}

impl Plan {
    /// Noise of a frame in a light behind a lens: the gain is raised until white fills the scale again. Several exposures share the time.
    fn noise(&self, peer: &Peer, electrons: f64) -> Noise {
        let full_well_e = electrons * (-peer.stops).exp2() / peer.cameras.len() as f64;
        Noise::Sensor(SensorNoise { full_well_e, read_noise_e: self.read_noise_e, gain: 1.0 })
    }

    fn proof(&self, peer: &Peer, (name, hash): (&str, &str), psi: f64, noise: Noise) -> Proof {
        let own = &peer.method.settings();
        Proof {
            settings: Some(settings(&[own, &self.optics, &TONE, &sensor(name, psi, noise), &BORDER])),
            weights: peer.method.weights().map(str::to_owned),
            photo: hash.to_owned(),
            camera: Some(sha256(peer.cameras.iter().map(Camera::to_json).collect::<String>().as_bytes())),
            ..Proof::default()
        }
    }
}

impl Experiment for Photographing<'_> {
    type Row = Row;
    type Cell = Cell;
    type Error = TrialError;

    /// Lights whose noise a network was not trained for are left out.
    fn cells(&self) -> Vec<(Key<Row>, Cell)> {
        let plan = self.plan;
        let hashes: Vec<String> =
            self.photos.iter().map(|p| Input::photograph(&p.name, &p.frame).sha256).collect();
        let mut cells = vec![];
        for (peer, own) in plan.peers.iter().enumerate() {
            for (light, &electrons) in plan.electrons.iter().enumerate() {
                let noise = plan.noise(own, electrons);
                if !own.is_trained_for(noise) {
                    continue;
                }
                for (psi, depth) in own.psis.iter().enumerate() {
                    for (photo, of) in self.photos.iter().enumerate() {
                        let at = [electrons, depth.open].map(Ordered);
                        let (lens, foci, image) = (own.lens.clone(), ordered(&own.foci()), of.name.clone());
                        let subject = (lens, own.known, foci, own.seed, at[0], at[1], image);
                        let proof = plan.proof(own, (&of.name, &hashes[photo]), depth.own, noise);
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

    fn measure(&mut self, cells: &[(Cell, Proof)]) -> Result<Vec<Row>, TrialError> {
        let (plan, Cell { peer, psi, photo, .. }) = (self.plan, cells[0].0);
        let own = &plan.peers[peer];
        let depth = own.psis[psi];
        let trial = Trial::new(own.camera(), &self.photos[photo], depth.own, TONE);
        let electrons = |cell: &Cell| plan.electrons[cell.light];
        let noise: Vec<Noise> = cells.iter().map(|(cell, _)| plan.noise(own, electrons(cell))).collect();
        let shots = trial.exposures(self.kernels(peer, psi)?, &noise)?;
        let mut rows = vec![];
        for (((cell, proof), noise), raws) in cells.iter().zip(&noise).zip(&shots) {
            let raws: Vec<&RawFrame> = raws.iter().collect();
            let case = Case { camera: own.camera(), psi: depth.own, noise: *noise, optics: plan.optics };
            let prepared: Box<dyn Reconstructor> = own.method.prepare(&case)?;
            let result = prepared
                .reconstruct_exposures(&raws)
                .map_err(|source| TrialError::Reconstruct { image: trial.image(), source })?;
            rows.push(Row {
                lens: own.lens.clone(),
                clear: own.camera().is_clear(),
                stops: own.stops,
                known: own.known,
                foci: own.foci(),
                seed: own.seed,
                electrons: electrons(cell),
                psi: depth.open,
                image: trial.image(),
                psnr_db: trial.psnr_db(&result)?,
                proof: proof.clone(),
            });
        }
        Ok(rows)
    }

    fn describe(&self, cell: &Cell) -> String {
        let own = &self.plan.peers[cell.peer];
        format!(
            "{} at psi {}: {}",
            own.name,
            psi_words(own.psis[cell.psi].open),
            self.photos[cell.photo].name
        )
    }
}

#[cfg(test)]
pub(crate) mod tests;
