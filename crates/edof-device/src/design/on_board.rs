//! A design on its board: the clocks that it needs there, and whether frames fit.

use super::{CameraModule, Design, DesignError};
use crate::board::{Frames, MadeClock, Setup, Source, VideoIn, VideoOut};
use crate::i2c::{Entry, ov7670};
use crate::video::VideoTiming;
use edof_core::words::number;

/// Sides below which frames stand for those of a video mode, in simulations.
const SIMULATED_SIDES: (usize, usize) = (640, 480);
/// How far around a clock that cannot be made one is looked for that can, in kilohertz.
const SEARCH_KHZ: u64 = 5_000;

/// The clocks that a board's PLLs make for a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clocks {
    /// The calculator's: the design's `clock_mhz`.
    pub calculator: MadeClock,
    /// The screen's pixels, where the board has a video output.
    pub screen: Option<MadeClock>,
}

impl Design {
    /// Returns the clocks of the design on its board.
    ///
    /// # Errors
    /// [`DesignError::Field`] for a calculator's clock that no PLL makes (it names the next ones that can be made), and for frames that are larger
    /// than the screen around them.
    pub fn clocks(&self) -> Result<Clocks, DesignError> {
        let screen = |video: &VideoOut| self.screen_clock(video);
        let calculator = self.calculator_clock()?;
        Ok(Clocks { calculator, screen: self.board.video_out.as_ref().map(screen).transpose()? })
    }

    /// Returns the set-ups of the video chips, the output's first.
    ///
    /// # Errors
    /// [`DesignError::Lacks`]: the board lacks one of them.
    pub fn video_chips(&self) -> Result<[&'static Setup; 2], DesignError> {
        let board = self.board;
        let lacks = |what: &str| DesignError::Lacks { board: board.name, what: what.into() };
        let input = board.video_in.as_ref().ok_or_else(|| lacks("video input"))?;
        let output = board.video_out.as_ref().and_then(|video| video.setup.as_ref());
        Ok([output.ok_or_else(|| lacks("video output with a chip"))?, &input.setup])
    }

    /// Returns the set-up of the camera, and its byte of black: that of the design's module if it states one.
    ///
    /// # Errors
    /// [`DesignError::Lacks`]: the board has no camera.
    pub fn camera_chip(&self) -> Result<(&'static Setup, u8), DesignError> {
        match &self.board.video_in {
            Some(VideoIn { setup, source: Source::Camera { black, .. } }) => {
                Ok((setup, self.camera.map_or(*black, |module| module.black)))
            }
            _ => Err(DesignError::Lacks { board: self.board.name, what: "camera".into() }),
        }
    }

    /// Returns the timing of the screen: that of the frames, or a larger one that shows them in its middle ([`VideoTiming::around`]).
    #[must_use]
    pub fn screen(&self) -> VideoTiming {
        match self.board.video_out.as_ref().map(|video| video.frames) {
            Some(Frames::Middle(screen)) => screen,
            _ => VideoTiming::of_frame(self.frame),
        }
    }

    /// Returns the timing of incoming frames: a camera's with the frame in its middle, or a video mode's.
    #[must_use]
    pub fn incoming(&self) -> VideoTiming {
        self.frames_of_camera().unwrap_or_else(|| VideoTiming::of_frame(self.frame))
    }

    /// Returns the timing that the video chips are set up for: [`Design::incoming`] of a camera, or that of a cable ([`VideoTiming::on_the_cable`]).
    #[must_use]
    pub fn set_up_for(&self) -> VideoTiming {
        self.frames_of_camera().unwrap_or_else(|| VideoTiming::on_the_cable(self.frame))
    }

    /// Returns the program of a set-up of the board's.
    #[must_use]
    pub fn program(&self, setup: &Setup) -> Vec<Entry> {
        (setup.program)(self.set_up_for(), self.camera.unwrap_or_default().corner)
    }

    /// # Errors
    /// [`DesignError::Field`] for a camera's module where the board has no camera, and for one whose window is moved too far.
    pub(super) fn check_camera(&self) -> Result<(), DesignError> {
        let Some(CameraModule { black, corner }) = self.camera else { return Ok(()) };
        let field = |field: &str, value: String, expected: String| {
            Err(DesignError::Field { field: field.into(), value, expected })
        };
        if self.frames_of_camera().is_none() {
            let expected = format!("left out, as board {} has no camera", self.board.name);
            return field("camera", format!("with black {black}"), expected);
        }
        if corner.iter().any(|step| step.unsigned_abs() > ov7670::MAX_MOVE) {
            let most = ov7670::MAX_MOVE;
            return field(
                "camera.corner",
                format!("{corner:?}"),
                format!("two numbers from -{most} to {most}"),
            );
        }
        Ok(())
    }

    fn frames_of_camera(&self) -> Option<VideoTiming> {
        match self.board.video_in.as_ref()?.source {
            Source::Camera { timing, .. } => Some(timing.around(self.frame)),
            Source::Cable { .. } => None,
        }
    }

    /// # Errors
    /// [`DesignError::Field`] for a frame that the board's buffers cannot hold, or as [`Design::clocks`].
    pub fn check_board(&self) -> Result<(), DesignError> {
        let pixels = self.frame.width * self.frame.height;
        let memory = &self.board.memory;
        if !pixels.is_multiple_of(memory.word_pixels()) {
            let word = memory.word_pixels();
            return Err(
                self.frame_error(format!("a multiple of {word} pixels, so that it is whole words of memory"))
            );
        }
        if 2 * pixels > memory.buffer_bytes as usize {
            let most = memory.buffer_bytes / 2;
            return Err(self.frame_error(format!("at most {most} pixels, which a buffer holds")));
        }
        self.clocks().map(drop)
    }

    /// Rejects frames that no cable of the board carries. Small ones pass, since they stand for others in simulations.
    ///
    /// # Errors
    /// [`DesignError::Field`] for frames that are of no video mode and not below 640×480.
    pub fn check_video(&self) -> Result<(), DesignError> {
        let (columns, rows) = SIMULATED_SIDES;
        let is_simulated = self.frame.width < columns && self.frame.height < rows;
        match self.board.video_out.as_ref().map(|video| video.frames) {
            Some(Frames::OfModes(modes, _)) if !is_simulated && self.mode_of(modes).is_none() => {
                Err(self.no_mode(modes))
            }
            _ => Ok(()),
        }
    }

    fn calculator_clock(&self) -> Result<MadeClock, DesignError> {
        let khz = self.clock_mhz * 1e3;
        let nearest = khz.round() as u64;
        let make = |khz: u64| self.board.clock(khz);
        let exact = if (khz - nearest as f64).abs() < 1e-6 { make(nearest) } else { None };
        exact.ok_or_else(|| {
            let below = (0..SEARCH_KHZ).find_map(|i| make(nearest.saturating_sub(i)));
            let above = (1..SEARCH_KHZ).find_map(|i| make(nearest + i));
            let named = [below, above].into_iter().flatten().map(|made| (made.khz as f64 / 1e3).to_string());
            let named = named.collect::<Vec<_>>().join(" or ");
            let clocks = &self.board.clocks;
            let source = f64::from(clocks.source_khz) / 1e3;
            DesignError::Field {
                field: "clock_mhz".into(),
                value: number(self.clock_mhz),
                expected: format!(
                    "a clock that an {} makes of {source} MHz, such as {named}",
                    clocks.pll.name
                ),
            }
        })
    }

    /// Returns the pixel clock of the screen: of the video mode of the frames, the board's slowest where they have none.
    fn screen_clock(&self, video: &VideoOut) -> Result<MadeClock, DesignError> {
        let (modes, slowest) = match video.frames {
            Frames::OfModes(modes, slowest) => (modes, slowest),
            Frames::Middle(screen) => return self.clock_of_larger(screen),
        };
        let khz = self.mode_of(modes).map_or(slowest, |mode| mode.pixel_khz as u64);
        self.board.clock(khz).ok_or_else(|| self.no_mode(modes))
    }

    fn mode_of(&self, modes: &[VideoTiming]) -> Option<VideoTiming> {
        VideoTiming::mode(self.frame).filter(|mode| modes.contains(mode))
    }

    fn no_mode(&self, modes: &[VideoTiming]) -> DesignError {
        let (columns, rows) = SIMULATED_SIDES;
        let mut sizes: Vec<String> = modes.iter().map(|mode| mode.size()).collect();
        sizes.dedup();
        let sizes = sizes.join(", ");
        self.frame_error(format!(
            "the size of a video mode ({sizes}), or below {columns}x{rows} for simulation"
        ))
    }

    /// Returns the pixel clock of a screen in whose middle the frames are.
    fn clock_of_larger(&self, screen: VideoTiming) -> Result<MadeClock, DesignError> {
        let fits = self.frame.width <= screen.line.active && self.frame.height <= screen.frame.active;
        let made = fits.then(|| self.board.clock(screen.pixel_khz as u64)).flatten();
        made.ok_or_else(|| self.frame_error(format!("at most {}, the size of the screen", screen.size())))
    }

    fn frame_error(&self, expected: String) -> DesignError {
        let value = format!("{}x{}", self.frame.width, self.frame.height);
        DesignError::Field { field: "frame".into(), value, expected }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::KC705;
    use crate::i2c::Action;

    fn design(clock_mhz: f64, width: usize, height: usize) -> Design {
        let mut design = Design::from_json(include_str!("../../../../designs/kc705.json")).unwrap();
        design.clock_mhz = clock_mhz;
        (design.frame.width, design.frame.height) = (width, height);
        design
    }

    fn is_legal(made: MadeClock) -> bool {
        KC705.clocks.pll.is_legal(made.settings, KC705.clocks.source_khz.into())
    }

    #[test]
    fn every_video_mode_has_a_pixel_clock_that_its_board_makes() {
        for mode in VideoTiming::MODES {
            let made = KC705.clock(mode.pixel_khz as u64).unwrap();
            assert!(is_legal(made), "{made:?}");
        }
        assert_eq!(design(150.0, 1280, 720).clocks().unwrap().screen.unwrap().khz, 74_250);
    }

    #[test]
    fn clocks_and_frames_that_no_board_has_are_rejected_in_words() {
        for (design, words) in [
            (
                design(199.999, 1280, 720),
                "clock_mhz 199.999: must be a clock that an MMCM makes of 200 MHz, such as 199.6 or 200",
            ),
            (design(2.0, 1280, 720), "clock_mhz 2: must be a clock that an MMCM makes of 200 MHz, such as "),
        ] {
            let error = design.clocks().unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }

    #[test]
    fn video_alone_needs_frames_of_a_mode() {
        for (width, height) in [(640, 480), (1456, 1088), (1366, 768)] {
            let design = design(200.0, width, height);
            assert_eq!(design.clocks().unwrap().screen.unwrap().khz, 25_000);
            let error = design.check_video().unwrap_err().to_string();
            let words = format!(
                "frame {width}x{height}: must be the size of a video mode (1280x720, 1920x1080), or below"
            );
            assert!(error.starts_with(&words), "{error}");
        }
        for (width, height) in [(1280, 720), (1920, 1080), (320, 240)] {
            design(200.0, width, height).check_video().unwrap();
        }
    }

    #[test]
    fn a_frame_is_no_larger_than_its_buffer() {
        let error = design(200.0, 2048, 1032).check_board().unwrap_err().to_string();
        assert_eq!(error, "frame 2048x1032: must be at most 2097152 pixels, which a buffer holds");
    }

    #[test]
    fn a_board_with_a_larger_screen_shows_frames_in_its_middle() {
        let mut design = Design::from_json(include_str!("../../../../designs/ulx3s.json")).unwrap();
        assert_eq!(design.screen(), VideoTiming::VGA_60);
        assert_eq!(design.clocks().unwrap().screen.unwrap().khz, 25_000);
        assert_eq!(design.board.clock(5 * 25_000).unwrap().khz, 125_000);
        design.frame.width = 642;
        let error = design.clocks().unwrap_err().to_string();
        assert_eq!(error, "frame 642x480: must be at most 640x480, the size of the screen");
    }

    #[test]
    fn frames_are_in_the_middle_of_a_cameras_or_a_video_mode() {
        let design = Design::from_json(include_str!("../../../../designs/ulx3s.json")).unwrap();
        let (incoming, frame) = (design.incoming(), design.frame);
        assert_eq!((incoming.line.active, incoming.frame.active), (frame.width, frame.height));
        assert_eq!((incoming.line.total(), incoming.frame.total()), (784, 510));
        assert_eq!(design.set_up_for(), incoming);
        let cabled = self::design(200.0, 64, 48);
        assert_eq!(cabled.incoming(), VideoTiming::of_frame(cabled.frame));
        assert_eq!(cabled.set_up_for(), VideoTiming::P1080_60);
        let error = cabled.camera_chip().map(|_| ()).unwrap_err().to_string();
        assert_eq!(error, "board kc705 has no camera; use a design for another board");
    }

    #[test]
    fn a_module_that_a_design_states_moves_the_window_and_sets_black() {
        let text = include_str!("../../../../designs/ulx3s.json");
        let with = |module: &str| text.replacen('{', &format!("{{ \"camera\": {module},"), 1);
        let usual = Design::from_json(text).unwrap();
        let own = Design::from_json(&with(r#"{ "black": 16, "corner": [-1, 0] }"#)).unwrap();
        let (setup, black) = own.camera_chip().unwrap();
        assert_eq!((usual.camera_chip().unwrap().1, black), (0, 16));
        // The two writes that docs/ulx3s.md tries on a running camera.
        let written = |design: &Design| {
            let (before, after) = (usual.program(setup), design.program(setup));
            let differing = after.into_iter().zip(before).filter(|(a, b)| a.action != b.action);
            differing.map(|(entry, _)| entry.action).collect::<Vec<_>>()
        };
        let write = |register, value| Action::Write { device: ov7670::OV7670, register, value };
        assert_eq!(written(&own), [write(0x32, 0xb6)]);
        let up = Design::from_json(&with(r#"{ "corner": [0, -1] }"#)).unwrap();
        assert_eq!(written(&up), [write(0x03, 0x0a)]);
        let still = Design::from_json(&with(r#"{ "black": 16 }"#)).unwrap();
        assert_eq!(still.program(setup), usual.program(setup));
        for (text, words) in [
            (with(r#"{ "corner": [9, 0] }"#), "camera.corner [9, 0]: must be two numbers from -8 to 8"),
            (
                include_str!("../../../../designs/kc705.json").replacen('{', "{ \"camera\": {},", 1),
                "camera with black 0: must be left out, as board kc705 has no camera",
            ),
        ] {
            let error = Design::from_json(&text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn calculators_run_at_their_designs_clock() {
        for mhz in [5.0, 100.0, 125.0, 150.0, 200.0, 212.5, 215.0, 220.0, 333.0] {
            let made = design(mhz, 1920, 1080).clocks().unwrap().calculator;
            assert_eq!(made.khz as f64, mhz * 1e3);
            assert!(is_legal(made), "{made:?}");
        }
    }

    #[test]
    fn a_design_names_its_board_and_the_first_board_needs_no_name() {
        let text = include_str!("../../../../designs/kc705.json");
        let design = Design::from_json(text).unwrap();
        assert_eq!(design.board, &KC705);
        assert!(!serde_json::to_string(&design).unwrap().contains("board"));
        let with = |board: &str| text.replacen('{', &format!("{{ \"board\": \"{board}\","), 1);
        assert_eq!(Design::from_json(&with("kc705")).unwrap(), design);
        let error = Design::from_json(&with("kc706")).unwrap_err().to_string();
        assert!(error.contains("board") && error.contains("'kc706' is unknown, expected kc705"), "{error}");
    }
}
