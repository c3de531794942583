//! Cameras and the methods that are measured behind each.

use crate::methods::nets::Entry;
use crate::methods::spec::MethodSpec;
use edof_core::camera::Camera;

/// A camera and the methods that stand behind it.
pub struct Setup {
    /// The camera.
    pub camera: Camera,
    /// Methods.
    pub methods: Vec<MethodSpec>,
}

/// Two nets would share their rows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("net '{0}': given twice, every net needs a name of its own")]
pub struct NetTwice(String);

/// One setup for each camera, in the nets' order, with demosaicing as its first method.
///
/// # Errors
/// A net given twice.
pub fn setups(nets: Vec<Entry>) -> Result<Vec<Setup>, NetTwice> {
    let mut names: Vec<String> = vec![];
    let mut setups: Vec<Setup> = vec![];
    for Entry { name, camera, methods } in nets {
        if names.contains(&name) {
            return Err(NetTwice(name));
        }
        names.push(name);
        let index = setups.iter().position(|s| s.camera == camera).unwrap_or_else(|| {
            setups.push(Setup { camera, methods: vec![MethodSpec::Malvar] });
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
    fn a_net_given_twice_is_rejected() {
        let net = || Net::new("a", float("clear"), "h", None, Stride::PATCH).0.entry(Stride::PATCH);
        let error = setups(vec![net(), net()]).err().unwrap().to_string();
        assert_eq!(error, "net 'a': given twice, every net needs a name of its own");
    }
}
