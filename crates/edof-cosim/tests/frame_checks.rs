//! The CRCs by which the host knows that a frame passed the core, and those that it must find.

use crate::edof_core::Setup;
use edof_core::cable::carried;
use edof_core::{DisplayMode, RawFrame};
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::system::Rig;
use edof_device::design::memory;
use edof_device::registers::map::WEIGHTS;
use edof_golden::{Curve, Display, Golden};

/// Where a frame is taken, cut into windows, made into codes and sent.
const NAMES: [&str; 4] = ["check_raw", "check_windows", "check_codes", "check_sent"];

/// Of each frame, with one set of weights and one mode.
pub struct FrameChecks(Vec<[u32; 4]>);

impl FrameChecks {
    pub fn new(setup: &Setup, frames: &[RawFrame], set: usize, mode: DisplayMode) -> Self {
        let golden = Golden::new(setup.sets[set].clone()).unwrap();
        let display = Display::new(mode, Curve::Srgb);
        let of_frame = |frame| {
            let checks = golden.checks(&display, &carried(frame)).unwrap();
            [checks.raw, checks.windows, checks.codes, checks.codes]
        };
        Self(frames.iter().map(of_frame).collect())
    }

    /// What the core says of its latest frames is true of some from `first` on.
    pub fn hold(&self, rig: &mut Rig, first: usize, what: &str) {
        rig.access(Access::Write(WEIGHTS.word(memory::SNAPSHOT), 0)).unwrap();
        for (at, name) in NAMES.iter().enumerate() {
            let found = rig.register(name).unwrap();
            assert!(self.0[first..].iter().any(|of_frame| of_frame[at] == found), "{what}: {name}");
        }
    }
}
