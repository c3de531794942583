//! What cases are run with: the functions under trial, the networks, how long to look.

use crate::methods::Methods;
use crate::subjects::Subjects;
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

    /// The methods of whole frames, prepared when they are first asked for.
    pub(crate) const fn methods(&self) -> &Methods {
        &self.methods
    }
}
