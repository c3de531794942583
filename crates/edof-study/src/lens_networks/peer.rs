//! A network behind the lens that it was trained for, and the depths that it serves.

use super::{TONE, ordered};
use crate::journal::Ordered;
use crate::methods::nets::Net;
use crate::methods::spec::MethodSpec;
use edof_core::camera::{Camera, Mask, Zernike};
use edof_core::words::number;
use edof_core::{Noise, Stride};
use edof_network::network::Condition;
use edof_optics::psf::{NoPsf, Settings, channel_psfs};
use std::collections::BTreeSet;

/// Kernels are the same if no value differs by more.
const SAME_KERNEL: f32 = 1e-5;

/// A network behind its lens.
pub struct Peer {
    /// Name of the camera.
    pub lens: String,
    /// Stops by which it is closed.
    pub stops: f64,
    /// Whether the network was trained at one depth alone.
    pub known: bool,
    /// Seed of the training.
    pub seed: u64,
    /// The camera of each exposure; they differ in their focus.
    pub cameras: Vec<Camera>,
    /// Name of the network.
    pub name: String,
    /// The network in floating point.
    pub method: MethodSpec,
    /// Depths that it serves.
    pub psis: Vec<Psi>,
    /// ψ at the lens's own aperture between which it was trained.
    trained: [f64; 2],
    conditions: Vec<Condition>,
}

/// A depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Psi {
    /// ψ at the open aperture.
    pub open: f64,
    /// ψ at the lens's own aperture.
    pub own: f64,
}

/// Networks that cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PeerError {
    /// Another lens.
    #[error(
        "network '{net}': was trained for camera {camera}, expected the lens and sensor of {clear} with any mask, focus and smaller aperture"
    )]
    Camera { net: String, camera: String, clear: String },
    /// Another kind of light.
    #[error("network '{net}': was trained without real light, expected edof train --tone srgb")]
    Tone { net: String },
    /// A depth that it has not seen.
    #[error("network '{net}': was trained for psi {} to {} of the open aperture, which leaves out psi {}; give fewer --psi, or train it for all", number(.range[0]), number(.range[1]), number(*.psi))]
    Range { net: String, range: [f64; 2], psi: f64 },
    /// A depth that no network knows.
    #[error("lens {lens}, seed {seed}: no network knows psi {}; give fewer --psi, or train one with --psi {1}:{1} --depths 1", number(.psi.open), number(.psi.own))]
    Unknown { lens: String, seed: u64, psi: Psi },
    /// Two of one kind.
    #[error("networks '{first}' and '{second}': are of one lens, depth and seed; expected another --seed")]
    Twice { first: String, second: String },
    /// A depth without PSFs.
    #[error(transparent)]
    Psf(#[from] NoPsf),
}

/// Puts networks behind their lenses, which are `clear` with any mask and focus, closed by any stops, for depths in ψ of the open aperture.
///
/// # Errors
/// [`PeerError`].
pub fn peers(
    clear: &Camera,
    psis: &[f64],
    nets: Vec<Net>,
    optics: &Settings,
) -> Result<Vec<Peer>, PeerError> {
    let mut peers = nets.into_iter().map(|net| Peer::new(clear, net)).collect::<Result<Vec<_>, _>>()?;
    for peer in peers.iter_mut().filter(|peer| !peer.known) {
        peer.psis = psis.iter().map(|psi| peer.psi(*psi)).collect();
        peer.check_range()?;
    }
    let of_known = |peer: &Peer| (peer.lens.clone(), ordered(&peer.foci()), peer.seed);
    let groups: BTreeSet<(String, Vec<Ordered>, u64)> =
        peers.iter().filter(|peer| peer.known).map(of_known).collect();
    for (lens, foci, seed) in groups {
        let mut group: Vec<&mut Peer> = peers
            .iter_mut()
            .filter(|p| p.known && of_known(p) == (lens.clone(), foci.clone(), seed))
            .collect();
        for &open in psis {
            let psi = group[0].psi(open);
            let serving = serving(&group, psi.own, optics)?;
            let place = serving.ok_or_else(|| PeerError::Unknown { lens: lens.clone(), seed, psi })?;
            group[place].psis.push(psi);
        }
    }
    for (place, peer) in peers.iter().enumerate() {
        if let Some(other) = peers[..place].iter().find(|other| other.is_twin(peer)) {
            return Err(PeerError::Twice { first: other.name.clone(), second: peer.name.clone() });
        }
    }
    Ok(peers)
}

/// Place of the network that serves a depth: the one that was trained at it, else one that was trained at the same kernels.
fn serving(group: &[&mut Peer], own: f64, optics: &Settings) -> Result<Option<usize>, NoPsf> {
    if let Some(place) = group.iter().position(|peer| peer.is_at(own)) {
        return Ok(Some(place));
    }
    for (place, peer) in group.iter().enumerate() {
        if peer.knows(own, optics)? {
            return Ok(Some(place));
        }
    }
    Ok(None)
}

impl Peer {
    fn new(clear: &Camera, net: Net) -> Result<Self, PeerError> {
        let origin = net.float.origin.clone();
        let cameras = origin.cameras();
        let camera = origin.camera;
        if !is_same(clear, &camera) {
            let (net, camera) = (net.name, camera.name);
            return Err(PeerError::Camera { net, camera, clear: clear.name.clone() });
        }
        if origin.conditions.iter().any(|condition| condition.tone != TONE) {
            return Err(PeerError::Tone { net: net.name });
        }
        // To the digits that options have.
        let stops = (2e3 * (clear.aperture_radius_mm / camera.aperture_radius_mm).log2()).round() / 1e3;
        let (name, mut methods) = (net.name.clone(), net.entry(Stride::PATCH).methods);
        Ok(Self {
            lens: camera.name.clone(),
            // Positive zero.
            stops: stops + 0.0,
            known: camera.psi_range[0] == camera.psi_range[1],
            seed: origin.provenance.seed.unwrap_or(0),
            trained: camera.psi_range,
            cameras,
            name,
            method: methods.swap_remove(0),
            psis: vec![],
            conditions: origin.conditions,
        })
    }

    /// Returns the camera of the first exposure.
    pub(super) fn camera(&self) -> &Camera {
        &self.cameras[0]
    }

    /// Returns the foci of several exposures in ψ of the open aperture; nothing of one exposure.
    pub(super) fn foci(&self) -> Vec<f64> {
        let foci = self.cameras.iter().map(|camera| camera.focus_psi * self.stops.exp2());
        if self.cameras.len() > 1 { foci.collect() } else { vec![] }
    }

    /// Whether it was trained for a noise.
    pub(super) fn is_trained_for(&self, noise: Noise) -> bool {
        self.conditions.iter().any(|condition| condition.fit(noise).is_inside())
    }

    fn psi(&self, open: f64) -> Psi {
        Psi { open, own: open * (-self.stops).exp2() }
    }

    /// Whether it was trained at a depth alone.
    fn is_at(&self, own: f64) -> bool {
        (self.trained[0] - own).abs() < 1e-6
    }

    /// Rejects depths beyond those that a blind network was trained for.
    fn check_range(&self) -> Result<(), PeerError> {
        let [low, high] = self.trained;
        let is_missed = |psi: &&Psi| psi.own < low - 1e-6 || psi.own > high + 1e-6;
        let Some(&Psi { open, .. }) = self.psis.iter().find(is_missed) else { return Ok(()) };
        let range = self.trained.map(|psi| psi * self.stops.exp2());
        Err(PeerError::Range { net: self.name.clone(), range, psi: open })
    }

    /// Whether another network was trained for the same, so that a page could not tell them apart.
    fn is_twin(&self, other: &Self) -> bool {
        let of =
            |peer: &Self| (peer.lens.clone(), peer.foci(), peer.seed, peer.trained, peer.conditions.clone());
        of(self) == of(other)
    }

    /// Whether a depth, as far from focus as the one that it was trained at, has the same kernels in every exposure.
    fn knows(&self, own: f64, optics: &Settings) -> Result<bool, NoPsf> {
        self.cameras.iter().try_fold(true, |knows, camera| {
            Ok(knows && has_same_kernels(camera, [own, self.trained[0]], optics)?)
        })
    }
}

/// Whether two depths, equally far from focus, have the same kernels.
fn has_same_kernels(camera: &Camera, psis: [f64; 2], optics: &Settings) -> Result<bool, NoPsf> {
    let [a, b] = psis.map(|psi| (psi - camera.focus_psi).abs());
    if (a - b).abs() > 1e-6 {
        return Ok(false);
    }
    let [a, b] = psis.map(|psi| channel_psfs(camera, psi, optics));
    let (a, b) = (a?, b?);
    Ok(a.iter().zip(&b).all(|(a, b)| {
        let (a, b) = (a.kernel(), b.kernel());
        a.dim() == b.dim() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME_KERNEL)
    }))
}

/// Whether a camera is a clear lens except for mask, aberrations, focus, range, and an aperture that is no larger.
fn is_same(clear: &Camera, camera: &Camera) -> bool {
    let bare = |camera: &Camera| Camera {
        aperture_radius_mm: clear.aperture_radius_mm,
        focus_psi: clear.focus_psi,
        mask: Mask::default(),
        aberrations: Zernike::default(),
        defocus_sign: clear.defocus_sign,
        ..camera.clone()
    };
    bare(clear).same_lens(&bare(camera))
        && camera.aperture_radius_mm <= clear.aperture_radius_mm * (1.0 + 1e-6)
}
