//! A lens of the comparison with the networks that were trained for it.

use super::{DEPTHS, Lens, TONE, along};
use crate::methods::nets::Net;
use crate::methods::nets_by_noise::{self, ByNoiseError};
use crate::methods::spec::MethodSpec;
use edof_core::camera::Camera;
use edof_core::{Noise, Stride};
use edof_network::network::Condition;

/// A lens, and one network or several of which each light meets its own.
pub struct Peer {
    /// Which lens.
    pub lens: Lens,
    /// Stops by which it is closed.
    pub stops: f64,
    /// Far end of the range of ψ, at the open aperture.
    pub range: f64,
    /// The camera that the networks were trained for.
    pub camera: Camera,
    /// Name of the networks.
    pub name: String,
    /// The networks in floating point.
    pub method: MethodSpec,
    /// Windows that each was trained on; the fewest of several.
    pub windows: u64,
    conditions: Vec<Condition>,
}

/// Networks that do not belong to the comparison.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PeerError {
    /// Another lens.
    #[error(
        "network '{net}': was trained for camera {camera}, expected the coded lens or its clear lens at an aperture of the comparison, focused from ψ = 0 on; \
         edof study aperture --cameras writes them"
    )]
    Camera { net: String, camera: String },
    /// Another kind of light.
    #[error("network '{net}': was trained without real light, expected edof train --tone srgb")]
    Tone { net: String },
    /// No one method.
    #[error(transparent)]
    ByNoise(#[from] ByNoiseError),
}

impl Peer {
    /// Networks of one camera, which is the coded lens or its clear lens, closed by stops of the list.
    ///
    /// # Errors
    /// [`PeerError`].
    pub fn new(coded: &Camera, stops: &[f64], mut nets: Vec<Net>) -> Result<Self, PeerError> {
        let Some(first) = nets.first() else { return Err(ByNoiseError::None.into()) };
        let camera = first.float.origin.camera.clone();
        let lens = if camera.is_clear() { Lens::Clear } else { Lens::Coded };
        let closed = 2.0 * (coded.aperture_radius_mm / camera.aperture_radius_mm).log2();
        let allowed: &[f64] = if lens == Lens::Coded { &[0.0] } else { stops };
        let known = allowed.iter().copied().find(|stops| (stops - closed).abs() < 1e-6);
        let other = || PeerError::Camera { net: first.name.clone(), camera: camera.name.clone() };
        let stops = known.filter(|_| is_same(coded, &camera, lens)).ok_or_else(other)?;
        let is_light = |net: &&Net| net.float.origin.conditions.iter().all(|c| c.tone == TONE);
        if let Some(net) = nets.iter().find(|net| !is_light(net)) {
            return Err(PeerError::Tone { net: net.name.clone() });
        }
        // To the digits that options have.
        let range = (camera.psi_range[1] * stops.exp2() * 1e6).round() / 1e6;
        let windows = nets.iter().map(|net| net.float.origin.patches).min().unwrap_or(0);
        let conditions = nets.iter().flat_map(|net| net.float.origin.conditions.clone()).collect();
        let entry = match nets.len() {
            1 => nets.remove(0).entry(Stride::PATCH),
            _ => nets_by_noise::entry(nets, Stride::PATCH)?,
        };
        let method = entry.methods.into_iter().next().ok_or(ByNoiseError::None)?;
        Ok(Self { lens, stops, range, camera, name: entry.name, method, windows, conditions })
    }

    /// Whether one of its networks was trained for a noise.
    pub(super) fn knows(&self, noise: Noise) -> bool {
        self.conditions.iter().any(|condition| condition.fit(noise).is_inside())
    }

    /// Depths in ψ of the open aperture, and in ψ of its own.
    pub(super) fn depths(&self) -> Vec<(f64, f64)> {
        along(self.range, DEPTHS).map(|psi| (psi, psi * (-self.stops).exp2())).collect()
    }
}

/// Whether a camera is the coded lens or its clear one, except for aperture, focus and range, which begins at ψ = 0.
fn is_same(coded: &Camera, camera: &Camera, lens: Lens) -> bool {
    let expected = Camera {
        name: camera.name.clone(),
        source: camera.source.clone(),
        aperture_radius_mm: camera.aperture_radius_mm,
        focus_psi: camera.focus_psi,
        psi_range: camera.psi_range,
        ..lens.of(coded)
    };
    expected == *camera && camera.psi_range[0] == 0.0
}
