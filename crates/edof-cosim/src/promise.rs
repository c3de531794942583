//! Guaranteed speed of a design, for every network and picture: the worst case in which no value is zero.

use crate::estimate::Estimated;
use edof_device::Design;
use edof_device::board::{self, MEMORY_LATE, WORD_BITS};
use edof_device::design::DesignError;
use edof_device::video::VideoTiming;
use edof_hdl::resources::{Resources, XC7K325T};
use serde::Serialize;

/// Figures of a design, at the clock that it states.
#[derive(Debug, Clone, Serialize)]
pub struct Promise {
    /// Cycles per patch where nothing is skipped.
    pub cycles_per_patch: f64,
    /// Patches of a frame.
    pub patches_per_frame: u64,
    /// Frames per second of the calculator where nothing is skipped.
    pub frames_per_second: f64,
    /// Frames per second on the screen, and its pixel clock in kilohertz; none for frames that only simulation takes.
    pub video: Option<(f64, usize)>,
    /// What the calculator takes.
    pub resources: Resources,
    /// What of it is scarcest on an XC7K325T, and its share there.
    pub scarcest: (&'static str, f64),
    /// Bytes per second that the memory must take and give.
    pub memory: [f64; 2],
    /// Seconds from a pixel at the input to the same pixel at the output, least and most.
    pub latency: [f64; 2],
}

impl Promise {
    /// Of a checked design.
    ///
    /// # Errors
    /// Frames or a clock that no board of ours has.
    pub fn of(design: &Design) -> Result<Self, DesignError> {
        board::check(design)?;
        let estimated = Estimated::new(design, None);
        let Estimated { ahead, board, total: resources, .. } = &estimated;
        let mode = VideoTiming::mode(design.frame);
        let resources = *resources;
        Ok(Self {
            cycles_per_patch: ahead.cycles_per_patch,
            patches_per_frame: ahead.patches_per_frame as u64,
            frames_per_second: estimated.rate(ahead.cycles_per_patch),
            video: mode.map(|mode| (mode.frames_per_second(), mode.pixel_khz)),
            resources,
            scarcest: resources.fullest(&XC7K325T),
            memory: [board.written, board.read],
            latency: board.latency,
        })
    }

    /// Lines for people: what, how much.
    #[must_use]
    pub fn rows(&self, design: &Design) -> Vec<(&'static str, String)> {
        let Resources { dsp48e1, ramb36e1, ramb18e1, lut, ff } = self.resources;
        let (scarcest, share) = self.scarcest;
        let frame = design.frame;
        let video = match self.video {
            Some((rate, khz)) => {
                format!("{rate:.0} frames per second at a pixel clock of {:.2} MHz", khz as f64 / 1e3)
            }
            None => "no video mode: for simulation alone".to_owned(),
        };
        let [written, read] = self.memory.map(|bytes| bytes / 1e6);
        let [min, max] = self.latency.map(|seconds| 1e3 * seconds);
        vec![
            (
                "frame",
                format!("{}x{}, a patch each {} pixels", frame.width, frame.height, frame.stride.pixels()),
            ),
            ("screen and input", video),
            (
                "calculator, nothing skipped",
                format!(
                    "{:.1} cycles per patch, {:.1} frames per second at {} MHz; zeros that are skipped make it faster \
                 (`edof estimate --weights …`)",
                    self.cycles_per_patch, self.frames_per_second, design.clock_mhz
                ),
            ),
            (
                "calculator's cells",
                format!(
                    "{dsp48e1} DSP48E1, {ramb36e1} RAMB36E1, {ramb18e1} RAMB18E1, about {lut} LUT and {ff} FF; {scarcest} is {:.0} % of an XC7K325T",
                    100.0 * share
                ),
            ),
            (
                "memory",
                format!(
                    "{written:.0} MB/s written and {read:.0} MB/s read through a port of {WORD_BITS} bits, a burst within {MEMORY_LATE} cycles"
                ),
            ),
            ("latency", format!("{min:.1} to {max:.1} ms from input to output, nothing skipped")),
        ]
    }
}

/// The lines as a section of a page in Markdown.
///
/// # Errors
/// As [`Promise::of`].
pub fn section(design: &Design) -> Result<String, DesignError> {
    let rows = Promise::of(design)?.rows(design);
    let rows: String = rows.iter().map(|(what, text)| format!("| {what} | {text} |\n")).collect();
    Ok(format!(
        "\n## What this design promises\n\nThe design `{}`, computed (`edof design check`), not measured on a board; its clock is planned.\n\n| what | how much |\n|---|---|\n{rows}",
        design.name
    ))
}
