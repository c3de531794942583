//! When the receiver's data are sampled: the budget from its pins to the FPGA's registers, whose lines are those of docs/hardware.md.
//!
//! The receiver delays its clock by 32nds of a period. `edof board align` finds the setting whose edge is amid the data, where a build with
//! these delays has its registers.

/// Nanoseconds before and after a falling edge of the receiver's clock in which its data change (ADV7619 data sheet B, page 6: typical).
pub const CHANGES_NS: [f64; 2] = [1.0, 0.1];
/// Nanoseconds before an edge of the clock at its pin from which, and until which, data must stand at theirs: registers in the pads of HR
/// banks behind their zero-hold delay, clocked by a global buffer, at speed grade -2 (DS189 1.10, table 44, the largest and smallest).
pub const STANDS_NS: [f64; 2] = [2.91, 0.28];
/// Nanoseconds by which an edge may lie elsewhere: connector, traces and packages; jitter; the receiver's spread, of which its sheet has
/// typical values alone. All three are assumed.
pub const ELSEWHERE_NS: [f64; 3] = [0.1, 0.1, 0.2];
/// Settings of the receiver's clock in a period.
pub const TAPS: u8 = 32;
/// The setting of the first set-up, the clock not inverted: the nearest at 148.5 MHz to what [`delay_ns`] asks.
pub const FIRST_TAP: u8 = 5;

/// The delay of the receiver's clock with which the time in which data stand and that in which they must have the same middle.
#[must_use]
pub const fn delay_ns() -> f64 {
    let [before, after] = CHANGES_NS;
    let [from, until] = STANDS_NS;
    // Middles before the clock's rising edge: what must stand, and what stands around the edge half a period after a change.
    f64::midpoint(from, until) - f64::midpoint(before, -after)
}

/// Nanoseconds by which data may change earlier or later after an alignment: half a setting, and [`ELSEWHERE_NS`].
#[must_use]
pub fn uncertainty_ns(period: f64) -> f64 {
    period / f64::from(2 * TAPS) + ELSEWHERE_NS.iter().sum::<f64>()
}

/// Least and most delay of the data after a rising edge of the receiver's clock at the FPGA's pins, once they are aligned.
#[must_use]
pub fn delays_ns(period: f64) -> [f64; 2] {
    let [before, after] = CHANGES_NS;
    let (falls, uncertainty) = (period / 2.0 - delay_ns(), uncertainty_ns(period));
    [falls - before - uncertainty, falls + after + uncertainty]
}

/// What is left of each side of a period.
#[must_use]
pub fn margins_ns(period: f64) -> [f64; 2] {
    let [earliest, latest] = delays_ns(period);
    let [from, until] = STANDS_NS;
    [period - latest - from, earliest + until]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::video::VideoTiming;

    fn period(mode: VideoTiming) -> f64 {
        1e6 / mode.pixel_khz as f64
    }

    #[test]
    fn both_sides_have_the_same_margin_in_every_mode() {
        for mode in VideoTiming::MODES {
            let [set_up, hold] = margins_ns(period(mode));
            assert!((set_up - hold).abs() < 1e-9 && set_up > 0.9, "{mode:?}: {set_up} {hold}");
        }
    }

    #[test]
    fn the_page_has_the_budget() {
        let page = include_str!("../../../docs/hardware.md");
        for mode in VideoTiming::MODES {
            let period = period(mode);
            let [earliest, latest] = delays_ns(period);
            let [margin, _] = margins_ns(period);
            let row = format!(
                "| {} | {period:.2} | {:.2} | {earliest:.2} | {latest:.2} | {margin:.2} |",
                mode.name(),
                uncertainty_ns(period)
            );
            assert!(page.contains(&row), "docs/hardware.md lacks: {row}");
        }
    }
}
