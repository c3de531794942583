//! Trained nets as methods, each behind the camera it was trained for.

use crate::kodak::Setup;
use crate::method::{Entry, Format, Method};
use edof_deblur::Malvar;
use edof_golden::GoldenReconstructor;
use edof_spec::fixed_network::FixedNetworkError;
use edof_spec::network::NetworkError;
use edof_spec::overlap::Overlap;
use edof_spec::{FixedNetwork, Network, Stride};
use edof_train::reconstruct::{FloatReconstructor, Output};

/// A net in both its forms.
#[derive(Debug, Clone)]
pub struct Net {
    /// Name in reports.
    pub name: String,
    /// The float network.
    pub float: Network,
    /// The fixed network, where there is one that fits.
    pub fixed: Option<FixedNetwork>,
}

/// A net that cannot enter an experiment.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum NetError {
    /// A float net whose weights do not fit its form.
    #[error("net '{net}': {source}")]
    Float { net: String, source: NetworkError },
    /// A fixed net that cannot run.
    #[error("net '{net}': {source}")]
    Fixed { net: String, source: FixedNetworkError },
    /// Two nets would share their rows.
    #[error("net '{0}': given twice, every net needs a name of its own")]
    Twice(String),
}

impl Net {
    /// Puts a float network and the fixed one made from it together. A fixed network for another stride, or made from other
    /// weights than those whose tensors have `float_hash`, is left out; the second value then says why.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        float: Network,
        float_hash: &str,
        fixed: Option<FixedNetwork>,
        stride: Stride,
    ) -> (Self, Option<String>) {
        let name = name.into();
        let obstacle = match &fixed {
            None => Some("has no fixed-point weights".to_owned()),
            Some(f) if f.stride != stride => Some(format!(
                "its fixed-point weights are made for stride {}, not {}",
                f.stride.pixels(),
                stride.pixels()
            )),
            Some(f) if f.float_hash != float_hash => {
                Some("its fixed-point weights were made from other float weights".to_owned())
            }
            Some(_) => None,
        };
        let note = obstacle.as_ref().map(|why| format!("NO {name}.fixed ROWS: {name} {why}"));
        (Self { name, float, fixed: fixed.filter(|_| obstacle.is_none()) }, note)
    }

    /// The net in every format that there is. All average overlapping patches alike.
    fn entries(self, stride: Stride) -> Result<Vec<Entry>, NetError> {
        let Self { name, mut float, fixed } = self;
        float.origin.name.clone_from(&name);
        let overlap = fixed.as_ref().map_or_else(Overlap::default, |f| f.overlap);
        let layers = float.form.layers;
        let method = |format| Method::network(&name, format, stride.pixels(), layers);
        let mut entries = vec![];
        for (format, output) in [(Format::Float, Output::Rgb), (Format::Float422, Output::Ycc422)] {
            let reconstructor = FloatReconstructor::new(float.clone(), stride, overlap, output)
                .map_err(|source| NetError::Float { net: name.clone(), source })?;
            entries.push(Entry { method: method(format), reconstructor: Box::new(reconstructor) });
        }
        if let Some(fixed) = fixed {
            let method = method(Format::Fixed);
            let golden = GoldenReconstructor::new(fixed, method.to_string())
                .map_err(|source| NetError::Fixed { net: name.clone(), source })?;
            entries.push(Entry { method, reconstructor: Box::new(golden) });
        }
        Ok(entries)
    }
}

/// One setup for each camera, in the nets' order, with demosaicing as its first method.
///
/// # Errors
/// [`NetError`]: a net given twice, or one that cannot run.
pub fn setups(nets: Vec<Net>, stride: Stride) -> Result<Vec<Setup>, NetError> {
    let mut names: Vec<String> = vec![];
    let mut setups: Vec<Setup> = vec![];
    for net in nets {
        if names.contains(&net.name) {
            return Err(NetError::Twice(net.name));
        }
        names.push(net.name.clone());
        let camera = net.float.origin.camera.clone();
        let index = setups.iter().position(|s| s.camera == camera).unwrap_or_else(|| {
            let demosaic = Entry { method: Method::demosaic(), reconstructor: Box::new(Malvar::default()) };
            setups.push(Setup { camera, entries: vec![demosaic] });
            setups.len() - 1
        });
        setups[index].entries.extend(net.entries(stride)?);
    }
    Ok(setups)
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_spec::network::{Form, Origin, Recurrence, Shrinkage};
    use edof_spec::{Camera, Window};
    use ndarray::{Array1, Array2};

    fn float(camera: &str) -> Network {
        Network {
            form: Form {
                window: Window::new(8).unwrap(),
                codes: 2,
                layers: 2,
                shrinkage: Shrinkage::OneSided,
                recurrence: Recurrence::Direct,
                linear_path: false,
                tied: false,
            },
            analysis: Array2::zeros((2, 64)),
            thresholds: vec![Array1::zeros(2)],
            recurrent: vec![],
            dictionary: Array2::zeros((192, 2)),
            linear_path: None,
            origin: Origin::untrained("n", Camera::resolve(camera).unwrap()),
        }
    }

    /// Fixed weights for stride 8 made from the float weights of hash `h`.
    fn fixed() -> FixedNetwork {
        let mut network = edof_random::natural(8, 8, 7);
        network.stride = Stride::PATCH;
        network.float_hash = "h".into();
        network
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

    #[test]
    fn each_camera_has_one_setup_and_one_demosaicing() {
        let net = |name: &str, camera, fixed| Net::new(name, float(camera), "h", fixed, Stride::PATCH).0;
        let nets = vec![
            net("a", "ring-2018", Some(fixed())),
            net("b", "ring-2018", None),
            net("c", "ring-outer", None),
        ];
        let setups = setups(nets, Stride::PATCH).unwrap();
        // Reports use the name asked for, whatever the files say.
        let names: Vec<Vec<String>> =
            setups.iter().map(|s| s.entries.iter().map(|e| e.method.to_string()).collect()).collect();
        assert_eq!(
            names[0],
            ["demosaic-malvar", "a.float", "a.float422", "a.fixed", "b.float", "b.float422"]
        );
        assert_eq!(names[1], ["demosaic-malvar", "c.float", "c.float422"]);
    }

    #[test]
    fn a_net_given_twice_is_refused() {
        let net = || Net::new("a", float("clear"), "h", None, Stride::PATCH).0;
        let error = setups(vec![net(), net()], Stride::PATCH).err().unwrap().to_string();
        assert_eq!(error, "net 'a': given twice, every net needs a name of its own");
    }
}
