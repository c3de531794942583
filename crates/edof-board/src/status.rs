//! What a board's counters say: as they are, and what they became from one look to the next.

use crate::board::Board;
use crate::error::Error;
use crate::line::Line;
use crate::names::Place;
use edof_device::design::memory::WHOLE_CHAIN;
use edof_device::registers::map::{REGISTERS, STAGE_COUNTERS, register};
use edof_network::fixed_network::layer_names;
use serde::Serialize;
use std::collections::BTreeMap;

/// What a board without a picture shows, and what it needs.
pub const NO_PICTURE: &str =
    "the screen is black; a frame must come first, from the source or by 'edof board picture put'";

/// All registers at a moment, and the counters of the stages since the look before.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StatusSnapshot {
    /// Registers by name.
    pub registers: BTreeMap<&'static str, u32>,
    /// Of each stage: non-zero words, saturated results, codes, differences.
    pub stages: Vec<[u32; 4]>,
    /// Windows that were too short, and too long.
    pub wrong_windows: [u32; 2],
}

impl StatusSnapshot {
    /// A field of a register, or a register as a whole.
    #[must_use]
    pub fn value(&self, name: &str) -> u32 {
        let (whole, field) = name.split_once('.').map_or((name, None), |(whole, field)| (whole, Some(field)));
        let word = self.registers.get(whole).copied().unwrap_or(0);
        match field.and_then(|field| register(whole)?.field(field)) {
            Some(field) => (word & field.mask()) >> field.low,
            None => word,
        }
    }
}

impl<L: Line> Board<L> {
    /// All registers by name, in the order of their addresses.
    ///
    /// # Errors
    /// The line fails.
    pub fn registers(&mut self) -> Result<Vec<(Place, u32)>, Error> {
        let (first, last) = (REGISTERS[0].address, REGISTERS[REGISTERS.len() - 1].address);
        let words = self.link.glance(first, ((last - first) / 4 + 1) as usize)?;
        Ok(Place::registers().map(|place| (place, words[((place.address() - first) / 4) as usize])).collect())
    }

    /// Everything that changes, the stages' counters since the look before.
    ///
    /// # Errors
    /// The line fails.
    pub fn look(&mut self, stages: usize) -> Result<StatusSnapshot, Error> {
        self.snapshot()?;
        let words = self.link.read(STAGE_COUNTERS.address, (STAGE_COUNTERS.bytes / 4) as usize)?;
        let of = |stage: usize| [0, 1, 2, 3].map(|counter| words[4 * stage + counter]);
        let [short, long, ..] = of(WHOLE_CHAIN);
        let registers = self.registers()?.into_iter().filter_map(|(place, word)| match place {
            Place::Register(register) => Some((register.name, word)),
            _ => None,
        });
        Ok(StatusSnapshot {
            registers: registers.collect(),
            stages: (0..stages).map(of).collect(),
            wrong_windows: [short, long],
        })
    }
}

/// What happened between two looks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Seconds between them.
    pub seconds: f64,
    /// New pictures a second.
    pub frames_per_second: f64,
    /// Frames on the screen a second.
    pub screen_frames_per_second: f64,
    /// Frames on the screen that showed the picture before once more.
    pub late_frames: u32,
    /// Share of the cycles in which a window or a patch stood at the calculator.
    pub busy_share: f64,
    /// Cycles per patch, none where there was no patch.
    pub cycles_per_patch: Option<f64>,
    /// I, each M, F.
    pub stages: Vec<StageReport>,
    /// Counters of errors that grew, and by how much.
    pub grown: BTreeMap<&'static str, u32>,
    /// Windows that were too short, and too long.
    pub wrong_windows: [u32; 2],
}

/// What a stage did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageReport {
    /// `I`, `M` or `F`.
    pub layer: &'static str,
    /// Words that were not zero, of each patch.
    pub nonzeros_per_patch: f64,
    /// Results that did not fit.
    pub saturated_results: u32,
    /// Thresholded codes that did not fit.
    pub saturated_codes: u32,
    /// Differences that did not fit.
    pub saturated_differences: u32,
}

/// Counters of what should not happen.
const ERRORS: [&str; 12] = [
    "input_broken",
    "input_wrong",
    "input_range",
    "input_overruns",
    "input_write_errors",
    "raw_read_errors",
    "saturated_sums",
    "picture_broken",
    "picture_write_errors",
    "output_read_errors",
    "output_underruns",
    "uart_broken",
];

/// Rates between two snapshots that are N seconds apart, with a calculator of that clock.
#[must_use]
pub fn report(before: &StatusSnapshot, after: &StatusSnapshot, seconds: f64, clock_mhz: f64) -> Report {
    let more = |name: &str| after.value(name).wrapping_sub(before.value(name));
    let rate = |name: &str| f64::from(more(name)) / seconds;
    let patches = more("patches");
    let busy = f64::from(more("busy_cycles"));
    let stage = |(layer, counts): (&'static str, &[u32; 4])| StageReport {
        layer,
        nonzeros_per_patch: f64::from(counts[0]) / f64::from(patches.max(1)),
        saturated_results: counts[1],
        saturated_codes: counts[2],
        saturated_differences: counts[3],
    };
    let grown = ERRORS.into_iter().map(|name| (name, more(name))).filter(|(_, count)| *count > 0);
    Report {
        seconds,
        frames_per_second: rate("picture_frames"),
        screen_frames_per_second: rate("output_frames"),
        late_frames: more("output_late"),
        busy_share: busy / (seconds * 1e6 * clock_mhz),
        cycles_per_patch: (patches > 0).then(|| busy / f64::from(patches)),
        stages: layer_names(after.stages.len()).zip(&after.stages).map(stage).collect(),
        grown: grown.collect(),
        wrong_windows: after.wrong_windows,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_that_went_round_are_reported_right() {
        let look = |patches: u32, frames: u32| StatusSnapshot {
            registers: [("patches", patches), ("picture_frames", frames), ("status", 0b1001)].into(),
            stages: vec![[40, 1, 2, 3]; 3],
            wrong_windows: [0, 0],
        };
        let found = report(&look(u32::MAX - 3, 5), &look(4, 11), 2.0, 200.0);
        assert_eq!((found.frames_per_second, found.stages[2].nonzeros_per_patch), (3.0, 5.0));
        assert_eq!(found.stages[1].layer, "M");
        assert_eq!((look(0, 0).value("status.output_runs"), look(0, 0).value("status.i2c_done")), (1, 0));
    }
}
