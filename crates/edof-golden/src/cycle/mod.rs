//! The calculator cycle by cycle: for every patch, every word and the cycle of every transfer at every stage boundary, as
//! docs/calculator.md defines them. A generated circuit must show exactly these.
//!
//! | step | module | gives |
//! |---|---|---|
//! | ends | [`stall`] | in which cycles source and sink do nothing |
//! | stage | [`stage`] | when one stage multiplies and sends a vector |
//! | chain | [`chain`] | when a patch's beats pass each boundary |
//! | beats | [`transfer`] | words and cycles of a patch together |
//! | run | [`run`] | patches in, [`PatchRun`]s out, one after the other |
//! | figures | [`summary`] | cycles per patch, latency, counters, which stage limits |
//! | ahead | [`mod@estimate`] | the same from a design alone, or with mean numbers of non-zeros |
//! | search | [`explore`] | foldings of a design, from the cheapest to the fastest |
//! | proof | [`stepped`] | the same cycles from a machine that steps through every cycle: slow, for tests |
//!
//! Between stages nothing is random and nothing changes within a vector, so that the cycles follow from a few maxima a beat:
//! no register is simulated. Patches may use either of the two sets of weights.
//!
//! ```
//! use edof_golden::cycle::{Cycle, Patch, Stalls, Summary};
//! use edof_core::draw::Draw;
//! use edof_device::{Design, design::memory::Set};
//!
//! let design = Design::from_json(include_str!("../../../../designs/tiny.json"))?;
//! let network = edof_device::random::for_design(&design, 1);
//! let draw = &mut Draw::new(2);
//! let patches = (0..20).map(|_| Patch { window: edof_device::random::extreme_window(draw, 64), set: Set::First });
//!
//! let model = Cycle::new(&design, [&network, &network])?.stalls(Stalls::drawn(3, 64));
//! let mut summary = Summary::new(&design);
//! for patch in model.run(patches) {
//!     let first = patch.transfers(0).next().unwrap();
//!     assert_eq!(first.words, [0, 1].map(|at| patch.trace.input[at].to_bits()));
//!     assert!(patch.transfers(4).all(|beat| beat.cycle > first.cycle));
//!     summary.add(&patch);
//! }
//! assert_eq!(summary.counts.patches, 20);
//! assert!(summary.cycles_per_patch() >= 64.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod chain;
pub mod estimate;
pub mod explore;
pub mod run;
pub mod stage;
pub mod stall;
pub mod stepped;
pub mod summary;
pub mod transfer;

pub use chain::{Chain, PatchTimes};
pub use estimate::{Estimate, estimate};
pub use run::{Cycle, Run};
pub use stage::StageUse;
pub use stall::{StallPattern, Stalls};
pub use summary::Summary;
pub use transfer::{Patch, PatchRun, Transfer};

use edof_device::design::DesignError;
use edof_network::fixed_network::FixedNetworkError;

/// A design or network that the model cannot run.
#[derive(Debug, thiserror::Error)]
pub enum CycleError {
    /// A design that cannot be built, or a network that does not fit it.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// A network that could not run exactly.
    #[error(transparent)]
    Network(#[from] FixedNetworkError),
}
