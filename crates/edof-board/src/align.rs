//! The receiver's output clock moved to where the FPGA samples its data well: every polarity and tap is tried, and the sync codes inside of
//! the pixels say whether it works.
//!
//! A tap is a part of the clock's period, and so is the window: what is found at one clock says nothing of another.

use crate::board::Board;
use crate::chips::{Bus, ChipRegister};
use crate::clocks::is_clock;
use crate::error::Error;
use crate::line::Line;
use edof_device::Design;
use edof_device::i2c::receiver::{CLOCK_POLARITY, CLOCK_TAP, IO, clock_polarity, clock_tap};
use edof_device::input_timing::TAPS;
use edof_device::registers::map::{INPUT_CODES, VIDEO_SETUP, register};
use edof_device::video::VideoTiming;
use serde::Serialize;
use std::ops::ControlFlow;
use std::time::Duration;

/// A setting of the clock, and what came with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Trial {
    /// The clock is inverted.
    pub is_inverted: bool,
    /// Tap of its delay.
    pub tap: u8,
    /// Whole sync codes that came.
    pub codes: u32,
    /// Words that corrupted one.
    pub malformed: u32,
}

impl Trial {
    /// Whether codes came, and none was damaged.
    #[must_use]
    pub const fn works(&self) -> bool {
        self.codes > 0 && self.malformed == 0
    }
}

/// Neighbouring taps of one polarity that all work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Window {
    /// The clock is inverted.
    pub is_inverted: bool,
    /// First tap of the run.
    pub first: u8,
    /// How many.
    pub taps: u8,
}

impl Window {
    /// The tap in the middle; of two the lower one.
    #[must_use]
    pub const fn middle(self) -> u8 {
        self.first + (self.taps - 1) / 2
    }

    /// The largest of some trials, of several the first.
    #[must_use]
    pub fn largest(trials: &[Trial]) -> Option<Self> {
        let mut windows: Vec<Self> = vec![];
        for trial in trials.iter().filter(|trial| trial.works()) {
            let follows = |window: &&mut Self| {
                (window.is_inverted, window.first + window.taps) == (trial.is_inverted, trial.tap)
            };
            match windows.last_mut().filter(follows) {
                Some(window) => window.taps += 1,
                None => windows.push(Self { is_inverted: trial.is_inverted, first: trial.tap, taps: 1 }),
            }
        }
        windows.into_iter().rev().max_by_key(|window| window.taps)
    }
}

/// What was tried and chosen.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Alignment {
    /// All settings.
    pub trials: Vec<Trial>,
    /// The largest window, whose middle is set.
    pub window: Window,
}

/// What is asked of an alignment.
#[derive(Debug, Clone, Copy)]
pub struct Align<'a> {
    /// Undamaged sync codes required of a good setting.
    pub codes: u32,
    /// The design whose pixel clock the receiver must have; `None` for a simulated circuit, which has another.
    pub clock_of: Option<&'a Design>,
}

/// Codes after a change that do not count, and for how long they are waited for.
const SETTLING: u32 = 8;
const SETTLED: Duration = Duration::from_millis(20);
/// For how long codes are waited for.
const PATIENCE: Duration = Duration::from_millis(250);

impl<L: Line> Board<L> {
    /// Tries every polarity and tap of the receiver's clock, sets the middle of the largest window that works, and keeps it for later
    /// set-ups. `report` receives each trial and may end the search.
    ///
    /// # Errors
    /// The design's frames are of no video mode, the receiver is not set up or has another clock than the design's, nothing comes, or nothing
    /// works, when the settings are as before; or the line fails.
    pub fn align(
        &mut self,
        align: Align<'_>,
        report: &mut dyn FnMut(&Trial) -> ControlFlow<()>,
    ) -> Result<Alignment, Error> {
        let done = "i2c_card.done".parse().and_then(|place| self.get(place))?;
        if done == 0 {
            return Err(Error::NoReceiver { port: self.port() });
        }
        if let Some(design) = align.clock_of {
            self.check_clock(design)?;
        }
        let before = self.link.read(VIDEO_SETUP, 1)?[0];
        let trials = self.try_all(align.codes, report);
        let chosen = trials.and_then(|trials| match Window::largest(&trials) {
            Some(window) => Ok(Alignment { trials, window }),
            None => Err(self.nothing_works(&trials)),
        });
        match chosen {
            Ok(alignment) => {
                let Window { is_inverted, .. } = alignment.window;
                self.keep_clock(before, clock_polarity(is_inverted), clock_tap(alignment.window.middle()))?;
                Ok(alignment)
            }
            Err(error) => {
                let [_, tap, polarity, _] = before.to_le_bytes();
                self.set_clock(polarity, tap)?;
                Err(error)
            }
        }
    }

    fn check_clock(&mut self, design: &Design) -> Result<(), Error> {
        design.check_video()?;
        let wanted = VideoTiming::on_the_cable(design.frame);
        let expected = wanted.pixel_khz as f64 / 1e3;
        let found = self.pixel_clocks(design.board)?.map_or(0.0, |clocks| clocks.input);
        if is_clock(found, expected) {
            return Ok(());
        }
        Err(Error::OtherClock { port: self.port(), found, expected, mode: wanted.name() })
    }

    fn try_all(
        &mut self,
        codes: u32,
        report: &mut dyn FnMut(&Trial) -> ControlFlow<()>,
    ) -> Result<Vec<Trial>, Error> {
        let mut trials = vec![];
        for is_inverted in [false, true] {
            for tap in 0..TAPS {
                self.set_clock(clock_polarity(is_inverted), clock_tap(tap))?;
                let [codes, malformed] = self.count_codes(codes)?;
                let trial = Trial { is_inverted, tap, codes, malformed };
                trials.push(trial);
                if report(&trial).is_break() {
                    return Err(Error::Interrupted);
                }
            }
        }
        Ok(trials)
    }

    /// Whole and damaged codes until N whole ones came, or one was damaged. Not of the first ones: what came before the clock moved may
    /// spoil them.
    fn count_codes(&mut self, wanted: u32) -> Result<[u32; 2], Error> {
        self.codes_until(SETTLING, SETTLING, SETTLED)?;
        self.codes_until(wanted, 1, PATIENCE)
    }

    /// Whole and damaged codes until N of either came, or for so long.
    fn codes_until(&mut self, wanted: u32, damaged: u32, patience: Duration) -> Result<[u32; 2], Error> {
        let start = self.link.glance(INPUT_CODES, 2)?;
        let begun = self.link.line().time();
        loop {
            let now = self.link.glance(INPUT_CODES, 2)?;
            let [codes, malformed] = [0, 1].map(|i| now[i].wrapping_sub(start[i]));
            let waited = self.link.line().time().saturating_sub(begun);
            if codes >= wanted || malformed >= damaged || waited > patience {
                return Ok([codes, malformed]);
            }
        }
    }

    fn set_clock(&mut self, polarity: u8, tap: u8) -> Result<(), Error> {
        for (register, value) in [(CLOCK_POLARITY, polarity), (CLOCK_TAP, tap)] {
            self.write_chip(ChipRegister { bus: Bus::Card, device: IO, register }, value)?;
        }
        Ok(())
    }

    fn keep_clock(&mut self, before: u32, polarity: u8, tap: u8) -> Result<(), Error> {
        self.set_clock(polarity, tap)?;
        let [options, _, _, rest] = before.to_le_bytes();
        self.link.set(VIDEO_SETUP, u32::from_le_bytes([options, tap, polarity, rest]) & mask())
    }

    fn nothing_works(&self, trials: &[Trial]) -> Error {
        let port = self.port();
        let best = trials.iter().filter(|trial| trial.codes + trial.malformed > 0);
        match best.min_by_key(|trial| trial.malformed) {
            Some(Trial { codes, malformed, .. }) => {
                Error::NoWindow { port, min: *malformed, of: codes + malformed }
            }
            None => Error::NoCodes { port },
        }
    }
}

fn mask() -> u32 {
    register("video_setup").map_or(0, edof_device::registers::Register::mask)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trials(works: impl Fn(bool, u8) -> bool) -> Vec<Trial> {
        let trial = |is_inverted, tap| {
            let malformed = u32::from(!works(is_inverted, tap));
            Trial { is_inverted, tap, codes: 9, malformed }
        };
        [false, true]
            .into_iter()
            .flat_map(|inverted| (0..TAPS).map(move |tap| (inverted, tap)))
            .map(|(i, t)| trial(i, t))
            .collect()
    }

    #[test]
    fn the_middle_of_the_largest_window_is_chosen() {
        let largest = |works: &dyn Fn(bool, u8) -> bool| Window::largest(&trials(works));
        let window = largest(&|inverted, tap| !inverted && tap < 3 || inverted && (10..18).contains(&tap));
        assert_eq!(window, Some(Window { is_inverted: true, first: 10, taps: 8 }));
        assert_eq!(window.map(Window::middle), Some(13));
        // Of two polarities each has taps of its own: the last of one is not beside the first of the other.
        let window = largest(&|inverted, tap| !inverted && tap >= 30 || inverted && tap < 2);
        assert_eq!(window, Some(Window { is_inverted: false, first: 30, taps: 2 }));
        assert_eq!(largest(&|_, tap| tap == 31).map(Window::middle), Some(31));
        assert_eq!(largest(&|_, _| false), None);
        // Silence is no success.
        let silent: Vec<Trial> =
            trials(|_, _| true).into_iter().map(|trial| Trial { codes: 0, ..trial }).collect();
        assert_eq!(Window::largest(&silent), None);
    }
}
