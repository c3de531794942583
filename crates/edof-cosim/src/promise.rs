//! Guaranteed speed of a design, for every network and picture: the worst case in which no value is zero.

use crate::estimate::Estimated;
use edof_device::Design;
use edof_device::board::part::Cells;
use edof_device::board::{Frames, Source};
use edof_device::design::DesignError;
use edof_device::video::VideoTiming;
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
    /// Frames per second on the screen, and its pixel clock in kilohertz; none for frames of no video mode.
    pub video: Option<(f64, usize)>,
    /// What the calculator takes.
    pub resources: Cells,
    /// What `stream_core` takes, the calculator with all that it needs without a board.
    pub stream_core: Cells,
    /// What of the calculator is scarcest on the board's part, and its share there.
    pub scarcest: (String, f64),
    /// Bytes per second that the memory must take and give, where the board has video.
    pub memory: Option<[f64; 2]>,
    /// Seconds from a pixel at the input to the same pixel at the output, least and most.
    pub latency: Option<[f64; 2]>,
}

impl Promise {
    /// Of a checked design.
    ///
    /// # Errors
    /// Frames that the board's memory does not hold, or a clock that it does not make.
    pub fn of(design: &Design) -> Result<Self, DesignError> {
        design.check_board()?;
        let estimated = Estimated::new(design, None);
        let Estimated { ahead, board, total, .. } = &estimated;
        let mode = design.board.video_out.as_ref().and_then(|video| match video.frames {
            Frames::Middle(screen) => Some(screen),
            Frames::OfModes(..) => VideoTiming::mode(design.frame),
        });
        let part = estimated.part();
        Ok(Self {
            cycles_per_patch: ahead.cycles_per_patch,
            patches_per_frame: ahead.patches_per_frame as u64,
            frames_per_second: estimated.rate(ahead.cycles_per_patch),
            video: mode.map(|mode| (mode.frames_per_second(), mode.pixel_khz)),
            resources: part.named(total),
            stream_core: part.named(&estimated.stream_core),
            scarcest: part.fullest(total),
            memory: board.as_ref().map(|board| [board.written, board.read]),
            latency: board.as_ref().map(|board| board.latency),
        })
    }

    /// Lines for people: what, how much.
    #[must_use]
    pub fn rows(&self, design: &Design) -> Vec<(&'static str, String)> {
        let (scarcest, share) = &self.scarcest;
        let (part, memory) = (design.board.part.name, &design.board.memory);
        let frame = design.frame;
        let video = match self.video {
            Some((rate, khz)) => {
                let (mhz, screen) = (khz as f64 / 1e3, design.screen());
                let around = match screen == VideoTiming::of_frame(frame) {
                    true => String::new(),
                    false => format!(", in the middle of a screen of {}", screen.size()),
                };
                let input = match design.board.video_in.as_ref().map(|video| &video.source) {
                    Some(Source::Camera { timing, .. }) => {
                        format!("; {:.0} from a camera", timing.frames_per_second())
                    }
                    Some(Source::Cable { .. }) => String::new(),
                    None => "; no input".to_owned(),
                };
                format!("{rate:.0} frames per second at a pixel clock of {mhz:.2} MHz{around}{input}")
            }
            None if design.board.video_out.is_none() => format!("none on board {}", design.board.name),
            None => "no video mode: no screen shows these frames and no source sends them; a host does (`edof board picture`)".to_owned(),
        };
        let traffic = self.memory.map(|bytes| bytes.map(|bytes| bytes / 1e6));
        let traffic = traffic.map(|[written, read]| {
            format!(
                "{written:.0} MB/s written and {read:.0} MB/s read through a port of {} bits, a burst within {} cycles",
                memory.word_bits, memory.max_burst_cycles
            )
        });
        let latency = self.latency.map(|seconds| seconds.map(|seconds| 1e3 * seconds));
        let latency = latency
            .map(|[min, max]| format!("{min:.1} to {max:.1} ms from input to output, nothing skipped"));
        let calculator = vec![
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
                format!("{}; {scarcest} is {:.0} % of an {part}", self.resources, 100.0 * share),
            ),
            ("cells of stream_core", self.stream_core.to_string()),
        ];
        let bits = (design.code_bits < 16).then(|| {
            format!(
                "{} of 16: values saturate earlier; cells and speed are those of 16 bits",
                design.code_bits
            )
        });
        let board = [("code bits", bits), ("memory", traffic), ("latency", latency)];
        let board = board.into_iter().filter_map(|(what, text)| Some((what, text?)));
        calculator.into_iter().chain(board).collect()
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
