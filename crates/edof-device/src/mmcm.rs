//! Figures of an MMCM (MMCME2) of a 7-series FPGA of speed grade -2: what it makes of one clock.
//!
//! Limits: DS182 (Kintex-7), table of the MMCM; steps of the dividers: UG472. Clocks are in kilohertz, fractional dividers in eighths.

use std::cmp::Reverse;
use std::ops::RangeInclusive;

/// Frequencies of its oscillator.
pub const VCO_KHZ: RangeInclusive<u64> = 600_000..=1_440_000;
/// Frequencies at its phase detector.
pub const DETECTOR_KHZ: RangeInclusive<u64> = 10_000..=500_000;
/// Frequencies of its outputs: from the oscillator's lowest by the largest divider to what a global buffer carries.
pub const OUTPUT_KHZ: RangeInclusive<u64> = 4_688..=710_000;

/// How an MMCM makes one clock of another: input / `divide` × `multiply_eighths`/8 / (`output_eighths`/8).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mmcm {
    /// `DIVCLK_DIVIDE`.
    pub divide: u64,
    /// `CLKFBOUT_MULT_F` in eighths.
    pub multiply_eighths: u64,
    /// `CLKOUT0_DIVIDE_F` in eighths.
    pub output_eighths: u64,
}

impl Mmcm {
    /// The figures that make exactly `output_khz` of `input_khz`; `None` where no legal ones do.
    ///
    /// Of several, those with a whole output divider, then the fastest phase detector, a whole multiplier, the fastest oscillator.
    ///
    /// ```
    /// use edof_device::mmcm::Mmcm;
    /// let screen = Mmcm::of(200_000, 148_500).unwrap();
    /// assert_eq!((screen.divide, screen.multiply_eighths, screen.output_eighths), (10, 297, 40));
    /// ```
    #[must_use]
    pub fn of(input_khz: u64, output_khz: u64) -> Option<Self> {
        let exact = candidates(input_khz)
            .filter_map(|(divide, multiply_eighths)| {
                // input · multiply / (divide · output) eighths.
                let (dividend, divisor) = (input_khz * multiply_eighths, divide * output_khz);
                let output_eighths =
                    (divisor > 0 && dividend.is_multiple_of(divisor)).then(|| dividend / divisor)?;
                Some(Self { divide, multiply_eighths, output_eighths })
            })
            .filter(|mmcm| mmcm.is_legal(input_khz));
        let whole = |eighths: u64| eighths.is_multiple_of(8);
        exact.min_by_key(|mmcm| {
            let vco = input_khz * mmcm.multiply_eighths / mmcm.divide;
            (!whole(mmcm.output_eighths), mmcm.divide, !whole(mmcm.multiply_eighths), Reverse(vco))
        })
    }

    /// Whether all its figures and frequencies are in range.
    #[must_use]
    pub fn is_legal(self, input_khz: u64) -> bool {
        let Self { divide, multiply_eighths, output_eighths } = self;
        let vco = input_khz * multiply_eighths;
        (1..=106).contains(&divide)
            && (16..=512).contains(&multiply_eighths)
            // 1, or 2 to 128 in eighths.
            && (output_eighths == 8 || (16..=1024).contains(&output_eighths))
            && in_range(&DETECTOR_KHZ, input_khz, divide)
            && in_range(&VCO_KHZ, vco, 8 * divide)
            && in_range(&OUTPUT_KHZ, vco, divide * output_eighths)
    }
}

/// Dividers and multipliers at which the phase detector and the oscillator are in range.
fn candidates(input_khz: u64) -> impl Iterator<Item = (u64, u64)> {
    let dividers = (1..=106).filter(move |divide| in_range(&DETECTOR_KHZ, input_khz, *divide));
    dividers.flat_map(move |divide| {
        let multipliers =
            (16..=512).filter(move |eighths| in_range(&VCO_KHZ, input_khz * eighths, 8 * divide));
        multipliers.map(move |eighths| (divide, eighths))
    })
}

/// Whether a fraction lies in a range.
fn in_range(range: &RangeInclusive<u64>, dividend: u64, divisor: u64) -> bool {
    range.start() * divisor <= dividend && dividend <= range.end() * divisor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_found_is_legal_and_makes_the_clock() {
        for khz in [10_000, 74_250, 100_000, 125_000, 148_500, 150_000, 200_000, 215_000, 333_000] {
            let found = Mmcm::of(200_000, khz).unwrap();
            assert!(found.is_legal(200_000), "{found:?}");
            assert_eq!(
                200_000 * found.multiply_eighths,
                khz * found.divide * found.output_eighths,
                "{khz}: {found:?}"
            );
        }
    }

    #[test]
    fn figures_out_of_range_are_not_legal() {
        let good = Mmcm { divide: 1, multiply_eighths: 48, output_eighths: 64 };
        assert!(good.is_legal(200_000));
        for wrong in [
            // An oscillator of 1450 and of 575 MHz, a detector of 9.5 MHz, dividers between 1 and 2 and above 128.
            Mmcm { multiply_eighths: 58, ..good },
            Mmcm { multiply_eighths: 23, ..good },
            Mmcm { divide: 21, multiply_eighths: 512, ..good },
            Mmcm { output_eighths: 12, ..good },
            Mmcm { output_eighths: 1025, ..good },
        ] {
            assert!(!wrong.is_legal(200_000), "{wrong:?}");
        }
    }

    #[test]
    fn a_clock_that_cannot_be_made_has_no_figures() {
        assert_eq!([149_999, 2_000, 1_000_000].map(|khz| Mmcm::of(200_000, khz)), [None; 3]);
    }
}
