//! Networks that take several raw frames of a scene.

use super::options::Args;
use crate::error::Error;
use crate::weights;
use edof_core::DisplayMode;
use edof_core::camera::Camera;
use std::path::PathBuf;

/// Foci in ψ of the exposures that the network of `--weights` takes; one focus where it takes one raw frame, whose focus its camera states.
pub(super) struct Foci(Vec<f64>);

impl Foci {
    /// Reads the network, and rejects options of integers, which a network of several exposures has not.
    pub(super) fn of(args: &Args) -> Result<Self, Error> {
        // What is no float network takes one frame; its own loader says whether it is any other.
        let network = args.weights.as_deref().and_then(|name| weights::float(name).ok());
        let Some(network) = network.filter(|network| network.form.exposures > 1) else {
            return Ok(Self(vec![0.0]));
        };
        let foci = Self(network.origin.cameras().iter().map(|camera| camera.focus_psi).collect());
        let given = [
            ("--fixed", args.fixed),
            ("--board", args.board),
            ("--display", args.display != DisplayMode::default()),
            ("--words", args.words.is_some()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => Err(Error::message(format!(
                "{option}: is of the board's integers, which {} has not: {}; leave {option} out",
                args.weights.as_deref().unwrap_or_default(),
                foci.in_words()
            ))),
            None => Ok(foci),
        }
    }

    pub(super) const fn are_several(&self) -> bool {
        self.0.len() > 1
    }

    fn in_words(&self) -> String {
        let foci: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        format!("it takes {} raw frames of a scene, at foci {}", self.0.len(), foci.join(", "))
    }

    /// Returns the frames of each scene.
    pub(super) fn scenes(&self, args: &Args) -> Result<Vec<Vec<PathBuf>>, Error> {
        if !args.raw.len().is_multiple_of(self.0.len()) {
            return Err(Error::message(format!(
                "--weights {}: {}; found {} in all; give those of each scene one after the other, in the order of the foci",
                args.weights.as_deref().unwrap_or_default(),
                self.in_words(),
                args.raw.len()
            )));
        }
        Ok(args.raw.chunks(self.0.len()).map(<[PathBuf]>::to_vec).collect())
    }

    /// Returns the camera of each exposure of a scene. A camera that the user states has the network's foci where there are several.
    pub(super) fn cameras(&self, stated: Option<&Camera>) -> Vec<Option<Camera>> {
        match &self.0[..] {
            [_] => vec![stated.cloned()],
            foci => foci
                .iter()
                .map(|&focus_psi| stated.map(|stated| Camera { focus_psi, ..stated.clone() }))
                .collect(),
        }
    }
}
