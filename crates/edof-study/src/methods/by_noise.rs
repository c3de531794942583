//! One method out of several: each frame is reconstructed by the network that was trained for its noise.
//!
//! The networks have one form and stand behind one lens, so on the board the method costs what one of them costs: it is a bank that changes
//! with the sensor's gain.

use crate::key::KeyText;
use crate::methods::method::Method;
use edof_core::Noise;
use edof_core::storage::digest::sha256;
use edof_network::fit::best_fit;
use edof_network::network::Origin;

/// Networks as methods `M`, of which each frame meets the one that suits its noise best ([`edof_network::Fit`]).
#[derive(Debug, Clone)]
pub struct ByNoise<M> {
    name: String,
    first: (Origin, M),
    others: Vec<(Origin, M)>,
    sha256: String,
}

impl<M> ByNoise<M> {
    /// Networks, each with the noise that it was trained for, under one name; `hashes` are those of their weights.
    pub fn new(name: String, first: (Origin, M), others: Vec<(Origin, M)>, hashes: &[&str]) -> Self {
        Self { name, first, others, sha256: sha256(hashes.join("\n").as_bytes()) }
    }

    fn all(&self) -> impl Iterator<Item = &(Origin, M)> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// The network for a noise.
    #[must_use]
    pub fn at(&self, noise: Noise) -> &M {
        let fits = self.all().filter_map(|(origin, own)| Some((own, origin.fit_of_any_tone(noise)?)));
        best_fit(fits).map_or(&self.first.1, |(own, _)| own)
    }

    /// Identity in rows and tables: that of its networks, under its own name.
    pub fn method(&self, of: impl Fn(&M) -> Method) -> Method {
        Method { network: Some(self.name.clone()), ..of(&self.first.1) }
    }

    /// Returns the key text of every network's settings, and which noise each is for.
    pub fn settings(&self, of: impl Fn(&M) -> String) -> String {
        let each = |(origin, own): &(Origin, M)| {
            let ranges: Vec<String> = origin.conditions.iter().map(KeyText::key_text).collect();
            format!("{}: {}", ranges.join(" or "), of(own))
        };
        format!("by noise: {}", self.all().map(each).collect::<Vec<_>>().join("; "))
    }

    /// SHA-256 of the SHA-256 of every network's weights.
    #[must_use]
    pub fn weights(&self) -> &str {
        &self.sha256
    }
}
