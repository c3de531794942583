//! What cases are run with: the functions under trial, the networks, how long to look.

use crate::stability::methods::Methods;
use crate::stability::subjects::Subjects;
use edof_core::{Noise, Tone};
use edof_network::fit::Fit;
use edof_network::{FixedNetwork, Network};

/// A trained network in both its forms.
#[derive(Debug, Clone)]
pub struct Trained {
    /// What reports call it.
    pub name: String,
    /// The float network.
    pub float: Network,
    /// The integers made from it.
    pub fixed: FixedNetwork,
}

/// What cases are run with.
pub struct Bench {
    /// The functions under trial.
    pub subjects: Subjects,
    /// The trained networks.
    pub networks: Vec<Trained>,
    /// Windows that bounds are tried on, for each network: random ones, and as many on a climb.
    pub windows: usize,
    methods: Methods,
}

impl Bench {
    /// For the product's functions.
    #[must_use]
    pub fn new(networks: Vec<Trained>, windows: usize) -> Self {
        Self { subjects: Subjects::default(), networks, windows, methods: Methods::default() }
    }

    /// Whether a network is one that the program takes for a noise: its range contains the noise, or no other network of its camera and
    /// tones comes nearer.
    pub(crate) fn is_for(&self, trained: &Trained, noise: Noise) -> bool {
        let fit = |other: &Trained| other.float.origin.fit_of_any_tone(noise);
        let own = fit(trained);
        let tones = |other: &Trained| -> Vec<Tone> {
            other.float.origin.conditions.iter().map(|condition| condition.tone).collect()
        };
        let is_peer = |other: &&Trained| {
            other.float.origin.camera == trained.float.origin.camera && tones(other) == tones(trained)
        };
        own.is_some_and(Fit::is_inside) || self.networks.iter().filter(is_peer).all(|other| fit(other) >= own)
    }

    /// The methods of whole frames, prepared when they are first asked for.
    pub(crate) const fn methods(&self) -> &Methods {
        &self.methods
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::Camera;
    use edof_network::network::Condition;

    fn network(name: &str, camera: &str, tone: Tone, [least, most]: [f64; 2]) -> Trained {
        let mut float = edof_device::random::silent(Camera::resolve(camera).unwrap());
        let [least_noise, noise] = [least, most].map(Noise::gaussian);
        float.origin.conditions = vec![Condition { tone, noise, least_noise }];
        let fixed = edof_device::random::extreme(float.form, 16, edof_core::Stride::PATCH, false, 1);
        Trained { name: name.into(), float, fixed }
    }

    #[test]
    fn a_network_is_for_a_noise_of_its_range_or_nearer_to_it_than_any_of_its_lens_and_tone() {
        let networks = vec![
            network("all", "clear", Tone::Linear, [0.0, 0.015]),
            network("low", "clear", Tone::Linear, [0.0, 0.006]),
            network("high", "clear", Tone::Linear, [0.014, 0.03]),
            network("light", "clear", Tone::Srgb, [0.0, 0.01]),
            network("other lens", "ring-outer", Tone::Linear, [0.0, 0.01]),
        ];
        let bench = Bench::new(networks, 0);
        let at = |sigma: f64| -> Vec<&str> {
            let is_for = |trained: &&Trained| bench.is_for(trained, Noise::gaussian(sigma));
            bench.networks.iter().filter(is_for).map(|trained| trained.name.as_str()).collect()
        };
        assert_eq!(at(0.0), ["all", "low", "light", "other lens"]);
        assert_eq!(at(0.01), ["all", "light", "other lens"]);
        assert_eq!(at(0.05), ["high", "light", "other lens"]);
    }
}
