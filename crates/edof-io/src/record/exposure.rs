//! The place of a raw frame among the exposures of its scene.

use serde::{Deserialize, Serialize};

/// Place among exposures that share the exposure time in equal parts. Each has its own focus, which its camera states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exposure {
    /// Number of this exposure, 1 first.
    pub number: usize,
    /// How many share the time.
    pub of: usize,
}

impl std::fmt::Display for Exposure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "exposure {} of {}", self.number, self.of)
    }
}
