//! Trained nets as methods, each behind the camera it was trained for. Several as one method: `nets_by_noise`.

use crate::methods::settings::FloatSettings;
use crate::methods::spec::MethodSpec;
use edof_core::Stride;
use edof_core::camera::Camera;
use edof_core::overlap::Overlap;
use edof_network::float::reconstruct::Output;
use edof_network::network::Origin;
use edof_network::{FixedNetwork, Network};
use std::sync::Arc;

/// A net in both its forms.
#[derive(Debug, Clone)]
pub struct Net {
    /// Name in reports.
    pub name: String,
    /// The float network.
    pub float: Network,
    /// SHA-256 of its weights.
    pub float_sha256: String,
    /// The fixed network, where there is one that fits, and the SHA-256 of its own.
    pub fixed: Option<(FixedNetwork, String)>,
}

/// What stands in tables under one name, behind one camera.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Name in reports.
    pub name: String,
    /// The camera that it was trained for; of several exposures, that of the first, its name with all foci.
    pub camera: Camera,
    /// Foci in ψ of the exposures after the first.
    pub further_foci: Vec<f64>,
    /// The network in every format that it has.
    pub methods: Vec<MethodSpec>,
}

impl Net {
    /// Puts a float network and the fixed one made from it together. A fixed network for another stride, or made from other
    /// weights than those of `float_sha256`, is left out; the second value then says why.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        float: Network,
        float_sha256: &str,
        fixed: Option<(FixedNetwork, String)>,
        stride: Stride,
    ) -> (Self, Option<String>) {
        let name = name.into();
        let obstacle = match &fixed {
            None => Some("has no fixed-point weights".to_owned()),
            Some((f, _)) if f.stride != stride => Some(format!(
                "its fixed-point weights are made for stride {}, not {}",
                f.stride.pixels(),
                stride.pixels()
            )),
            Some((f, _)) if f.float_hash != float_sha256 => {
                Some("its fixed-point weights were made from other float weights".to_owned())
            }
            Some(_) => None,
        };
        let note = obstacle.as_ref().map(|why| format!("NO {name}.fixed ROWS: {name} {why}"));
        let fixed = fixed.filter(|_| obstacle.is_none());
        (Self { name, float, float_sha256: float_sha256.to_owned(), fixed }, note)
    }

    /// The network in every format. All formats average overlapping patches in the same way.
    #[must_use]
    pub fn entry(self, stride: Stride) -> Entry {
        let Self { name, mut float, float_sha256, fixed } = self;
        let (camera, further_foci) = (camera(&float.origin), float.origin.further_foci.clone());
        float.origin.name.clone_from(&name);
        let network = Arc::new(float);
        let overlap = fixed.as_ref().map_or_else(Overlap::default, |(fixed, _)| fixed.overlap);
        let float = |output| MethodSpec::Float {
            network: Arc::clone(&network),
            sha256: float_sha256.clone(),
            settings: FloatSettings { overlap, output, ..FloatSettings::at(stride) },
        };
        let mut methods = vec![float(Output::Rgb), float(Output::Ycc422)];
        methods.extend(fixed.map(|(fixed, sha256)| MethodSpec::Fixed {
            network: Arc::new(fixed),
            name: name.clone(),
            sha256,
        }));
        Entry { name, camera, further_foci, methods }
    }
}

/// The camera of a network, in whose name tables state the foci where there are several.
pub(super) fn camera(origin: &Origin) -> Camera {
    let foci: Vec<String> = origin.cameras().iter().map(|camera| camera.focus_psi.to_string()).collect();
    let camera = origin.camera.clone();
    match foci.len() {
        1 => camera,
        _ => Camera { name: format!("{} at foci {}", camera.name, foci.join(", ")), ..camera },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn float(camera: &str) -> Network {
        edof_device::random::silent(Camera::resolve(camera).unwrap())
    }

    /// Fixed weights for stride 8 made from the float weights of hash `h`.
    fn fixed() -> (FixedNetwork, String) {
        let mut network = edof_device::random::natural(8, 8, 7);
        network.stride = Stride::PATCH;
        network.float_hash = "h".into();
        (network, "f".into())
    }

    #[test]
    fn fixed_weights_that_do_not_fit_are_left_out_loudly() {
        let note =
            |fixed, hash, stride| Net::new("n", float("clear"), hash, fixed, Stride::new(stride).unwrap()).1;
        assert_eq!(note(Some(fixed()), "h", 8), None);
        assert_eq!(note(None, "h", 8).unwrap(), "NO n.fixed ROWS: n has no fixed-point weights");
        assert!(note(Some(fixed()), "h", 4).unwrap().contains("made for stride 8, not 4"));
        assert!(note(Some(fixed()), "other", 8).unwrap().contains("other float weights"));
    }
}
