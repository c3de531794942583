//! The golden pipeline as a method that experiments compare.

use crate::frame::Golden;
use edof_image::{RawFrame, ReconstructError, Reconstruction, Reconstructor};
use edof_network::FixedNetwork;
use edof_network::fixed_network::FixedNetworkError;
use std::time::Instant;

/// The fixed-point network under a name.
#[derive(Debug, Clone)]
pub struct GoldenReconstructor {
    golden: Golden,
    name: String,
}

impl GoldenReconstructor {
    /// `name` is what reports call it, as in `edof-t4w12.fixed`.
    ///
    /// # Errors
    /// [`FixedNetworkError`] for a network that could not run exactly.
    pub fn new(network: FixedNetwork, name: impl Into<String>) -> Result<Self, FixedNetworkError> {
        Ok(Self { golden: Golden::new(network)?, name: name.into() })
    }

    /// The pipeline inside, for its frames and counters.
    #[must_use]
    pub const fn golden(&self) -> &Golden {
        &self.golden
    }
}

impl Reconstructor for GoldenReconstructor {
    fn name(&self) -> &str {
        &self.name
    }

    /// The board's 4:2:2 frame, turned back into linear red, green and blue.
    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let start = Instant::now();
        let out = self.golden.frame(raw)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(Reconstruction {
            frame: out.colour(),
            seconds,
            multiplications: Some(out.counts.multiplications(self.golden.network())),
            counters: Some(out.counts.counters()),
            iterations: None,
        })
    }
}
