//! A phase-locked loop (PLL) of an FPGA: the settings with which it makes one clock of another, exactly.
//!
//! Clocks are in kilohertz, fractional dividers in eighths.

use std::cmp::Reverse;
use std::ops::RangeInclusive;

/// What limits a PLL.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pll {
    /// The vendor's name.
    pub name: &'static str,
    /// Frequencies of its oscillator.
    pub oscillator_khz: RangeInclusive<u64>,
    /// Frequencies at its phase detector.
    pub detector_khz: RangeInclusive<u64>,
    /// Frequencies of its outputs.
    pub output_khz: RangeInclusive<u64>,
    /// Divisions of the input.
    pub divide: RangeInclusive<u64>,
    /// Multiplications from the phase detector to the oscillator.
    pub multiply_eighths: RangeInclusive<u64>,
    /// Divisions from the oscillator to an output; 1 is always one.
    pub output_eighths: RangeInclusive<u64>,
    /// Steps of multiplication and output division: 1 where they are fractional, 8 where they are whole.
    pub step_eighths: u64,
    /// Divisions from the output to the phase detector, where the feedback is taken from the output.
    pub feedback: Option<RangeInclusive<u64>>,
}

/// How a PLL makes a clock: input / `divide` × `multiply_eighths`/8 / (`output_eighths`/8).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Division of the input.
    pub divide: u64,
    /// Multiplication up to the oscillator, in eighths.
    pub multiply_eighths: u64,
    /// Division of the oscillator, in eighths.
    pub output_eighths: u64,
}

/// A clock that a PLL makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MadeClock {
    /// Kilohertz.
    pub khz: u64,
    /// How the PLL makes it.
    pub settings: Settings,
}

impl MadeClock {
    /// Returns the period in nanoseconds.
    #[must_use]
    pub fn period_ns(self) -> f64 {
        1e6 / self.khz as f64
    }
}

impl Pll {
    /// Makes a clock of exactly `output_khz` of one of `input_khz`, if any legal settings do.
    ///
    /// Of several settings it takes those with a whole output division, then the fastest phase detector, a whole multiplication, the fastest
    /// oscillator.
    ///
    /// ```
    /// use edof_device::board::KC705;
    /// let screen = KC705.clocks.pll.make(200_000, 148_500).unwrap().settings;
    /// assert_eq!((screen.divide, screen.multiply_eighths, screen.output_eighths), (10, 297, 40));
    /// ```
    #[must_use]
    pub fn make(&self, input_khz: u64, output_khz: u64) -> Option<MadeClock> {
        let exact = self.candidates(input_khz).filter_map(|(divide, multiply_eighths)| {
            // input · multiply / (divide · output) eighths.
            let (dividend, divisor) = (input_khz * multiply_eighths, divide * output_khz);
            let output_eighths =
                (divisor > 0 && dividend.is_multiple_of(divisor)).then(|| dividend / divisor)?;
            Some(Settings { divide, multiply_eighths, output_eighths })
        });
        let whole = |eighths: u64| eighths.is_multiple_of(8);
        let best = exact.filter(|settings| self.is_legal(*settings, input_khz)).min_by_key(|settings| {
            let Settings { divide, multiply_eighths, output_eighths } = *settings;
            let oscillator = input_khz * multiply_eighths / divide;
            (!whole(output_eighths), divide, !whole(multiply_eighths), Reverse(oscillator))
        });
        best.map(|settings| MadeClock { khz: output_khz, settings })
    }

    /// Whether all settings and frequencies are in range.
    #[must_use]
    pub fn is_legal(&self, settings: Settings, input_khz: u64) -> bool {
        let Settings { divide, multiply_eighths, output_eighths } = settings;
        let oscillator = input_khz * multiply_eighths;
        let is_fed_back = self.feedback.as_ref().is_none_or(|range| {
            multiply_eighths.is_multiple_of(output_eighths)
                && range.contains(&(multiply_eighths / output_eighths))
        });
        self.divide.contains(&divide)
            && self.multiply_eighths.contains(&multiply_eighths)
            && (output_eighths == 8 || self.output_eighths.contains(&output_eighths))
            && [multiply_eighths, output_eighths].iter().all(|part| part.is_multiple_of(self.step_eighths))
            && is_fed_back
            && in_range(&self.detector_khz, input_khz, divide)
            && in_range(&self.oscillator_khz, oscillator, 8 * divide)
            && in_range(&self.output_khz, oscillator, divide * output_eighths)
    }

    /// Lists the input divisions and multiplications at which phase detector and oscillator are in range.
    fn candidates(&self, input_khz: u64) -> impl Iterator<Item = (u64, u64)> {
        let dividers =
            self.divide.clone().filter(move |divide| in_range(&self.detector_khz, input_khz, *divide));
        dividers.flat_map(move |divide| {
            let multipliers = self.multiply_eighths.clone().step_by(self.step_eighths as usize);
            let is_in_range =
                move |eighths: &u64| in_range(&self.oscillator_khz, input_khz * eighths, 8 * divide);
            multipliers.filter(is_in_range).map(move |eighths| (divide, eighths))
        })
    }
}

/// Whether a fraction is in a range.
fn in_range(range: &RangeInclusive<u64>, dividend: u64, divisor: u64) -> bool {
    range.start() * divisor <= dividend && dividend <= range.end() * divisor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::KC705;

    #[test]
    fn what_is_found_is_legal_and_makes_the_clock() {
        let mmcm = &KC705.clocks.pll;
        for khz in [10_000, 74_250, 100_000, 125_000, 148_500, 150_000, 200_000, 215_000, 333_000] {
            let found = mmcm.make(200_000, khz).unwrap().settings;
            assert!(mmcm.is_legal(found, 200_000), "{found:?}");
            assert_eq!(
                200_000 * found.multiply_eighths,
                khz * found.divide * found.output_eighths,
                "{khz}: {found:?}"
            );
        }
    }

    #[test]
    fn settings_out_of_range_are_not_legal() {
        let mmcm = &KC705.clocks.pll;
        let good = Settings { divide: 1, multiply_eighths: 48, output_eighths: 64 };
        assert!(mmcm.is_legal(good, 200_000));
        for wrong in [
            // An oscillator of 1450 and of 575 MHz, a detector of 9.5 MHz, dividers between 1 and 2 and above 128.
            Settings { multiply_eighths: 58, ..good },
            Settings { multiply_eighths: 23, ..good },
            Settings { divide: 21, multiply_eighths: 512, ..good },
            Settings { output_eighths: 12, ..good },
            Settings { output_eighths: 1025, ..good },
        ] {
            assert!(!mmcm.is_legal(wrong, 200_000), "{wrong:?}");
        }
    }

    #[test]
    fn a_clock_that_cannot_be_made_has_no_settings() {
        assert_eq!([149_999, 2_000, 1_000_000].map(|khz| KC705.clocks.pll.make(200_000, khz)), [None; 3]);
    }
}
