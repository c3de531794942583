//! The golden pipeline as a method that experiments compare.

use crate::frame::Golden;
use edof_core::{RawFrame, ReconstructError, Reconstruction, Reconstructor};
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
        Reconstruction::through(self.golden.network().origin.values, raw, |raw| self.values(raw))
    }
}

impl GoldenReconstructor {
    fn values(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::CfaPhase;
    use ndarray::Array2;

    #[test]
    fn a_network_as_a_method_has_its_name_and_gives_what_the_pipeline_gives() {
        let network = edof_device::random::natural(8, 8, 5);
        let values = Array2::from_shape_fn((32, 32), |(row, column)| (row * 700 + column * 300) as u16);
        let raw = RawFrame::from_values(values, 16, CfaPhase::ALL[0]).unwrap();
        let method = GoldenReconstructor::new(network, "net").unwrap();
        let (given, frame) = (method.reconstruct(&raw).unwrap(), method.golden().frame(&raw).unwrap());
        assert_eq!(method.name(), "net");
        assert_eq!(given.frame, frame.colour());
        assert_eq!(given.counters, Some(frame.counts.counters()));
        assert_eq!(given.multiplications, Some(frame.counts.multiplications(method.golden().network())));
    }
}
