//! What the whole board reaches, from the receiver's pins to the transmitter's, ahead of any run.
//!
//! A raw frame is complete in memory before the calculator takes it, and a picture before the screen does. A camera that is faster than the
//! calculator loses frames, a screen that is faster shows pictures again; so both pixel clocks run on, and the calculator takes the newest
//! frame whenever it is free.

use edof_core::geometry::{Geometry, PATCH};
use edof_device::design::{Design, FrameSize};
use edof_device::video::VideoTiming;

/// The clocks around a core, in picoseconds a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Periods {
    /// Memory, host.
    pub core: u64,
    /// Calculator.
    pub calculator: u64,
    /// The receiver's pixels.
    pub input: u64,
    /// The transmitter's pixels.
    pub output: u64,
}

impl Periods {
    /// A design's board's.
    #[must_use]
    pub fn of_board(design: &Design) -> Self {
        let pixel = 1_000_000_000 / VideoTiming::of_frame(design.frame).pixel_khz as u64;
        let core = 1_000_000_000 / u64::from(design.board.core_khz);
        Self { core, calculator: (1e6 / design.clock_mhz).round() as u64, input: pixel, output: pixel }
    }
}

/// Figures of a whole board.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// New pictures a second: the camera's frames, or as many as the calculator can.
    pub frames_per_second: f64,
    /// Bytes a second that are written to the memory: raw frames as they come, pictures as they are made.
    pub written: f64,
    /// Bytes a second that are read: raw frames as they are taken, pictures as they are shown.
    pub read: f64,
    /// Least and most seconds from a frame's first pixel at the receiver to its picture's first pixel at the transmitter.
    pub latency: [f64; 2],
}

/// What a core takes for a frame, in cycles of the calculator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoreCycles {
    /// From frame to frame where they come one after the other.
    pub frame: f64,
    /// From a frame's first pixel to the last one of its picture.
    pub latency: f64,
}

impl CoreCycles {
    /// Of a design whose calculator takes N cycles per patch, and N from a patch's first beat to its last: the calculator limits,
    /// a pixel is a cycle; it waits for the rows of its first window, and the last row of patches leaves after it.
    #[must_use]
    pub fn of(design: &Design, cycles_a_patch: f64, patch_latency: f64) -> Self {
        let (size, window) = (design.frame, design.form.window);
        let (rows, columns) = Geometry::new(window, size.stride).patches(size.height, size.width);
        let frame = (cycles_a_patch * (rows * columns) as f64).max((size.width * size.height) as f64);
        let rows_around = (window.side() + PATCH) / 2 + PATCH;
        Self { frame, latency: frame + patch_latency + (rows_around * size.width) as f64 }
    }
}

/// The figures of a board whose core takes so long for its frames.
#[must_use]
pub fn figures(size: FrameSize, cycles: CoreCycles, periods: Periods) -> Figures {
    let timing = VideoTiming::of_frame(size);
    let pixels = (timing.line.total() * timing.frame.total()) as f64;
    let seconds = |period: u64, cycles: f64| period as f64 * 1e-12 * cycles;
    let (camera, screen) = (seconds(periods.input, pixels), seconds(periods.output, pixels));
    let core = seconds(periods.calculator, cycles.frame);
    let made = 1.0 / camera.max(core);
    let bytes = (2 * size.width * size.height) as f64;
    let received = seconds(periods.input, (timing.line.total() * timing.frame.active) as f64);
    // A frame may wait for the one before it, and a picture for the screen.
    let waits = if core > camera { core } else { 0.0 } + screen;
    let min = received + seconds(periods.calculator, cycles.latency);
    Figures {
        frames_per_second: made,
        written: bytes * (1.0 / camera + made),
        read: bytes * (made + 1.0 / screen),
        latency: [min, min + waits],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Stride;

    const SIZE: FrameSize = FrameSize { width: 1920, height: 1080, stride: Stride::PATCH };

    /// The board's, its calculator at 200 MHz.
    fn periods() -> Periods {
        let design = include_str!("../../../../designs/kc705.json");
        Periods::of_board(&Design { clock_mhz: 200.0, ..Design::from_json(design).unwrap() })
    }

    #[test]
    fn a_board_has_the_clocks_of_its_design_and_video_mode() {
        // 148.5 MHz pixels; whole picoseconds.
        assert_eq!(periods(), Periods { core: 5000, calculator: 5000, input: 6734, output: 6734 });
        let design = Design::from_json(include_str!("../../../../designs/kc705.json")).unwrap();
        assert_eq!(Periods::of_board(&Design { clock_mhz: 150.0, ..design }).calculator, 6667);
    }

    #[test]
    fn a_core_takes_its_patches_or_its_pixels_and_waits_for_the_rows_of_a_window() {
        let design = Design::from_json(include_str!("../../../../designs/kc705.json")).unwrap();
        // Windows of 12 reach 10 rows down from a patch's first, whose last row leaves 8 later; 135 rows of 240 patches.
        let rows = 18.0 * 1920.0;
        let found = CoreCycles::of(&design, 100.0, 777.0);
        assert_eq!(found, CoreCycles { frame: 3_240_000.0, latency: 3_240_000.0 + 777.0 + rows });
        let found = CoreCycles::of(&design, 10.0, 777.0);
        assert_eq!(found, CoreCycles { frame: 2_073_600.0, latency: 2_073_600.0 + 777.0 + rows });
    }

    /// 80 × 56 cycles with 64 × 48 pixels, one of the camera's a nanosecond, of the screen's every other; half a nanosecond for the calculator's.
    #[test]
    fn figures_of_a_small_board_are_those_worked_out_by_hand() {
        let size = FrameSize { width: 64, height: 48, stride: Stride::PATCH };
        let periods = Periods { core: 1, calculator: 500, input: 1000, output: 2000 };
        let (camera, screen, bytes) = (4480e-9_f64, 8960e-9, 6144.0);
        // The last one takes as long as the camera: no frame waits.
        for (cycles, core, waits) in
            [(20_000.0, 10_000e-9, 18_960e-9), (100.0, 50e-9, screen), (8960.0, camera, screen)]
        {
            let found = figures(size, CoreCycles { frame: cycles, latency: 600.0 }, periods);
            let made = 1.0 / camera.max(core);
            let least = 3840e-9 + 300e-9;
            let expected =
                [made, bytes / camera + bytes * made, bytes * made + bytes / screen, least, least + waits];
            let found =
                [found.frames_per_second, found.written, found.read, found.latency[0], found.latency[1]];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(
                    (found / expected - 1.0).abs() < 1e-9,
                    "{cycles} cycles: {found}, expected {expected}"
                );
            }
        }
    }

    #[test]
    fn a_calculator_that_is_fast_enough_makes_a_picture_of_every_frame() {
        let found = figures(SIZE, CoreCycles { frame: 3e6, latency: 3.1e6 }, periods());
        assert!((found.frames_per_second - 60.0).abs() < 0.1, "{found:?}");
        // Two frames of 4 MB each way.
        assert!(
            (found.written / found.read - 1.0).abs() < 1e-9 && (found.written / 497.7e6 - 1.0).abs() < 0.01
        );
        assert!(found.latency[0] > 0.030 && found.latency[1] < 0.049, "{found:?}");
    }

    #[test]
    fn a_slow_calculator_sets_the_rate_and_a_frame_waits_for_it() {
        let found = figures(SIZE, CoreCycles { frame: 4e6, latency: 4.1e6 }, periods());
        assert!((found.frames_per_second - 50.0).abs() < 1e-9);
        assert!((found.latency[1] - found.latency[0] - 0.020 - 1.0 / 60.0).abs() < 1e-4);
    }
}
