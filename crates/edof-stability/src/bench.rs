//! What cases are run with: the functions under trial, the networks, how long to look.

use crate::methods::Methods;
use crate::subjects::Subjects;
use edof_image::{Noise, Tone};
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
