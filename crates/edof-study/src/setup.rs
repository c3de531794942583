//! Cameras and the methods that are measured behind each.

use crate::methods::nets::Entry;
use crate::methods::spec::MethodSpec;
use edof_core::Noise;
use edof_core::camera::Camera;

/// A camera and the methods that stand behind it.
pub struct Setup {
    /// The camera; of several exposures, that of the first.
    pub camera: Camera,
    /// Foci in ψ of the exposures after the first; all methods take as many raw frames.
    pub further_foci: Vec<f64>,
    /// Methods.
    pub methods: Vec<MethodSpec>,
}

impl Setup {
    /// Returns the camera of each exposure.
    #[must_use]
    pub fn cameras(&self) -> Vec<Camera> {
        self.camera.focused_at(&self.further_foci)
    }

    /// Returns those of the noise levels that frames can have which share the exposure time, each with the noise of one frame. Gaussian noise states
    /// no electrons to share.
    #[must_use]
    pub fn levels(&self, noise: &[Noise]) -> Vec<(Noise, Noise)> {
        let exposures = 1 + self.further_foci.len();
        noise.iter().filter_map(|level| Some((*level, level.of_share(exposures)?))).collect()
    }
}

/// Two nets would share their rows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("net '{0}': given twice, every net needs a name of its own")]
pub struct NetTwice(String);

/// One setup for each camera, in the nets' order, with demosaicing as its first method where it takes one raw frame.
///
/// # Errors
/// A net given twice.
pub fn setups(nets: Vec<Entry>) -> Result<Vec<Setup>, NetTwice> {
    let mut names: Vec<String> = vec![];
    let mut setups: Vec<Setup> = vec![];
    for Entry { name, camera, further_foci, methods } in nets {
        if names.contains(&name) {
            return Err(NetTwice(name));
        }
        names.push(name);
        let is_same = |s: &Setup| s.camera == camera && s.further_foci == further_foci;
        let index = setups.iter().position(is_same).unwrap_or_else(|| {
            let first = further_foci.is_empty().then_some(MethodSpec::Malvar);
            setups.push(Setup { camera, further_foci, methods: first.into_iter().collect() });
            setups.len() - 1
        });
        setups[index].methods.extend(methods);
    }
    Ok(setups)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::nets::Net;
    use edof_core::Stride;
    use edof_network::{FixedNetwork, Network};

    fn float(camera: &str) -> Network {
        edof_device::random::silent(Camera::resolve(camera).unwrap())
    }

    /// Fixed weights made from the float weights of hash `h`.
    fn fixed() -> (FixedNetwork, String) {
        let network = edof_device::random::natural(8, 8, 7);
        (FixedNetwork { float_hash: "h".into(), ..network }, "f".into())
    }

    #[test]
    fn each_camera_has_one_setup_and_one_demosaicing() {
        let net = |name: &str, camera, fixed| {
            Net::new(name, float(camera), "h", fixed, Stride::PATCH).0.entry(Stride::PATCH)
        };
        let nets = vec![
            net("a", "ring-2018", Some(fixed())),
            net("b", "ring-2018", None),
            net("c", "ring-outer", None),
        ];
        let setups = setups(nets).unwrap();
        // Reports use the name asked for, whatever the files say.
        let names: Vec<Vec<String>> =
            setups.iter().map(|s| s.methods.iter().map(|m| m.method().to_string()).collect()).collect();
        assert_eq!(
            names[0],
            ["demosaic-malvar", "a.float", "a.float422", "a.fixed", "b.float", "b.float422"]
        );
        assert_eq!(names[1], ["demosaic-malvar", "c.float", "c.float422"]);
    }

    #[test]
    fn a_network_of_exposures_has_a_setup_of_its_own_in_noise_that_has_electrons_to_share() {
        let two = |name: &str, further_focus: f64| {
            let mut network = float("clear-mid");
            network.form.exposures = 2;
            network.origin.further_foci = vec![further_focus];
            network.analysis = ndarray::Array2::zeros((network.form.codes, network.form.inputs()));
            Net::new(name, network, "h", None, Stride::PATCH).0.entry(Stride::PATCH)
        };
        let one = Net::new("one", float("clear-mid"), "h", None, Stride::PATCH).0.entry(Stride::PATCH);
        let setups = setups(vec![one, two("a", 6.0), two("b", 6.0), two("c", 8.0)]).unwrap();
        let told: Vec<(&str, usize)> =
            setups.iter().map(|s| (s.camera.name.as_str(), s.methods.len())).collect();
        assert_eq!(told, [("clear-mid", 3), ("clear-mid at foci 4, 6", 4), ("clear-mid at foci 4, 8", 2)]);
        let foci = |setup: &Setup| setup.cameras().iter().map(|c| c.focus_psi).collect::<Vec<_>>();
        assert_eq!([foci(&setups[0]), foci(&setups[2])], [vec![4.0], vec![4.0, 8.0]]);
        let noise = [Noise::None, Noise::gaussian(0.01), Noise::sensor(3.0)];
        assert_eq!(setups[0].levels(&noise), noise.map(|level| (level, level)));
        let shared = [(Noise::None, Noise::None), (Noise::sensor(3.0), Noise::sensor(6.0))];
        assert_eq!(setups[1].levels(&noise), shared);
    }

    #[test]
    fn a_net_given_twice_is_rejected() {
        let net = || Net::new("a", float("clear"), "h", None, Stride::PATCH).0.entry(Stride::PATCH);
        let error = setups(vec![net(), net()]).err().unwrap().to_string();
        assert_eq!(error, "net 'a': given twice, every net needs a name of its own");
    }
}
