//! The board in a study, as far as it is known without one: the golden picture, which it gives to the last bit, and its cycles at the
//! clock that is planned for it. Its time is computed, not measured, and reports say so.

use edof_core::{Geometry, RawFrame, ReconstructError, Reconstruction, Reconstructor};
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_golden::cycle::explore::cycles_per_patch;
use edof_golden::cycle::{Cycle, CycleError, Patch};
use edof_golden::{GoldenReconstructor, windows};
use edof_network::FixedNetwork;

/// A network on the calculator of a design.
pub struct BoardReconstructor {
    golden: GoldenReconstructor,
    model: Cycle,
    design: Design,
    geometry: Geometry,
}

impl BoardReconstructor {
    /// A network on a design, under a name for reports.
    ///
    /// # Errors
    /// [`CycleError`] for a network that cannot run on the design.
    pub fn new(network: &FixedNetwork, design: &Design, name: String) -> Result<Self, CycleError> {
        let model = Cycle::new(design, [network, network])?;
        let golden = GoldenReconstructor::new(network.clone(), name)?;
        let geometry = Geometry::new(network.form.window, network.stride);
        Ok(Self { golden, model, design: design.clone(), geometry })
    }
}

impl Reconstructor for BoardReconstructor {
    fn name(&self) -> &str {
        self.golden.name()
    }

    /// As the golden pipeline; `seconds` are the cycles of this frame's patches at the design's clock.
    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        let mut result = self.golden.reconstruct(raw)?;
        let raw = &*raw.encoded(self.golden.golden().network().origin.values);
        let (height, width) = raw.size();
        let (rows, columns) = self.geometry.patches(height, width);
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let patches = places.map(|(row, column)| Patch {
            window: windows::window(raw, self.geometry, row, column),
            set: Set::First,
        });
        let pairs: Vec<Vec<usize>> = self
            .model
            .run(patches)
            .map(|patch| patch.times.stages.iter().map(|used| used.pairs as usize).collect())
            .collect();
        let cycles = cycles_per_patch(&self.design, &pairs) * (rows * columns) as f64;
        result.seconds = cycles / (self.design.clock_mhz * 1e6);
        Ok(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::CfaPhase;
    use ndarray::Array2;

    #[test]
    fn the_boards_time_is_its_cycles_at_its_clock_and_its_picture_the_golden_one() {
        let design = Design::from_json(include_str!("../../../../designs/tiny.json")).unwrap();
        let network = edof_device::random::for_design(&design, 3);
        let values = Array2::from_shape_fn((32, 48), |(r, c)| ((r * 977 + c * 3571) % 65_536) as u16);
        let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap();
        let golden = GoldenReconstructor::new(network.clone(), "g").unwrap();
        let seconds = |design: &Design| {
            let board = BoardReconstructor::new(&network, design, "b".into()).unwrap();
            let result = board.reconstruct(&raw).unwrap();
            assert_eq!(result.frame, golden.reconstruct(&raw).unwrap().frame);
            result.seconds
        };
        let cycles = seconds(&design) * design.clock_mhz * 1e6 / f64::from((32 / 8) * (48 / 8));
        assert!(cycles > 1.0 && cycles < 4096.0, "{cycles} cycles a patch");
        let twice = Design { clock_mhz: 2.0 * design.clock_mhz, ..design.clone() };
        assert!((seconds(&design) / seconds(&twice) - 2.0).abs() < 1e-9);
    }
}
