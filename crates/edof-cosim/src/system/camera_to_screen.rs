//! Frames from a camera's pins to a screen's, through a whole ULX3S.

use super::first_light::{FirstLight, on_screen};
use edof_board::check::Boundary;
use edof_board::chip_models::ov7670::{self, Ov7670, Scene};
use edof_board::link::PATIENCE;
use edof_board::{Board, Error};
use edof_core::draw::Draw;
use edof_core::geometry::GeometryError;
use edof_core::{DisplayMode, RawFrame};
use edof_device::i2c::ov7670::TIMING;
use edof_device::registers::map;
use edof_device::video::VideoTiming;
use edof_golden::{Display, Golden};
use std::ops::ControlFlow;

/// Most edges between two looks at the screen. A frame of the camera takes some 17 million.
const EDGES: i64 = 1_000_000;
/// Looks of which one, before a picture, finds the camera's clock standing still; and after which the picture is given up.
const UNTIL_STOP: i64 = 40;
const LOOKS: i64 = 300;

/// Frames that a camera sees, and what becomes of them.
pub struct Trip<'a> {
    /// The timing of the screen.
    pub screen: VideoTiming,
    /// The golden pipeline of its network.
    pub golden: &'a Golden,
    /// What makes codes of words.
    pub display: &'a Display,
    /// Frames of 8 bits, red first.
    pub frames: &'a [RawFrame],
    /// Decides where in a frame the camera starts, and when its clock stands still.
    pub seed: u64,
}

/// What came of them.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Shown {
    /// Frames of the screen, each black, or one of the pictures and none before the one of the frame before.
    pub screen_frames: usize,
    /// Line since the vertical sync and cycle of the line at which the camera started.
    pub camera_starts_at: [usize; 2],
    /// How often its clock stood still.
    pub stops: usize,
    /// Pictures per second that came whole into the memory.
    pub pictures_per_second: Option<f64>,
    /// Refreshes of the memory.
    pub refreshes: usize,
    /// Simulated seconds.
    pub seconds: f64,
}

/// Why a frame did not become its picture.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "messages name the fields")]
pub enum Failure {
    #[error(transparent)]
    Board(#[from] Error),
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    #[error("the screen's cable: {0}")]
    Cable(String),
    #[error(
        "frame {frame} of the screen: {differing} of {pixels} pixels differ from picture {picture}; the first at row {row}, column {column}: \
         {got:?}, expected {expected:?}; {place}"
    )]
    Torn {
        frame: usize,
        picture: usize,
        differing: usize,
        pixels: usize,
        row: usize,
        column: usize,
        got: [u8; 3],
        expected: [u8; 3],
        place: String,
    },
    #[error("picture {picture} was not shown in {frames} frames of the screen; {place}")]
    Missing { picture: usize, frames: usize, place: String },
    #[error("every pixel as golden, but CRCs are not: the first words that differ are {0}")]
    Words(Boundary),
    #[error("register {register} is {value}, expected 0: frames were lost")]
    Lost { register: &'static str, value: u32 },
    #[error("the camera's rules: {0}")]
    Camera(String),
}

/// Returns the light under which a camera sends a raw frame. Each pixel has it in its own colour alone, and other light in the others; outside of the frame light is
/// none of the frame's.
fn light(raw: &RawFrame) -> Scene {
    let values = raw.values().mapv(|value| value as u8);
    let (height, width) = values.dim();
    let first = |usual: usize, active: usize, size: usize| usual + (active - size) / 4 * 2 + 1;
    let [left, top] = ov7670::USUAL;
    let left = first(left, TIMING.line.active, width);
    let top = first(top, TIMING.frame.active, height);
    Box::new(move |column, row| {
        let at = (row.wrapping_sub(top), column.wrapping_sub(left));
        match values.get(at) {
            Some(value) => {
                let own = (at.0 % 2) + (at.1 % 2);
                [0, 1, 2].map(|colour| if colour == own { *value } else { !*value })
            }
            None => [0, 1, 2].map(|colour: usize| (89 * column + 151 * row + 97 * colour) as u8),
        }
    })
}

impl Trip<'_> {
    /// Sends every frame until the screen shows its picture, and compares every pixel of all that it shows meanwhile; of the last one every word by its CRCs. Before each look
    /// at the screen `each` gets the number of the frame and the simulated seconds, and may stop it.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn run(
        &self,
        board: &mut FirstLight,
        each: &mut dyn FnMut(usize, f64) -> ControlFlow<()>,
    ) -> Result<Shown, Failure> {
        let draw = &mut Draw::new(self.seed);
        // At once: a set-up without a camera fails, and is tried again a second later.
        let Some(first) = self.frames.first() else { return Ok(Shown::default()) };
        let starts_at = [ov7670::FRAME, ov7670::LINE].map(|most| draw.whole(0, most as i64 - 1) as usize);
        board.connect_camera(|millisecond| Ov7670::new(light(first), millisecond).starting_at(starts_at))?;
        board.connect_screen()?;
        // The board starts with colour.
        if self.display.mode != DisplayMode::Colour {
            Board::open(&mut *board, PATIENCE)?.change_control(map::COLOUR, 0)?;
        }

        let mut shown = Shown { camera_starts_at: starts_at, ..Shown::default() };
        let screen = self.screen;
        let mut before = vec![[0; 3]; screen.line.active * screen.frame.active];
        for (number, raw) in self.frames.iter().enumerate() {
            if let Some(camera) = &board.camera {
                camera.chip.borrow_mut().next_scene = Some(light(raw));
            }
            let picture = on_screen(&self.golden.frame(raw)?.picture(self.display).0, screen);
            self.until_shown(board, (number, &picture, &before), draw, &mut shown, each)?;
            before = picture;
        }
        shown.pictures_per_second = board.pictures_per_second();
        self.check_words(board)?;
        Ok(Shown { refreshes: board.refreshes(), seconds: board.seconds(), ..shown })
    }

    /// Runs until the screen shows a picture; before that it shows the one before.
    fn until_shown(
        &self,
        board: &mut FirstLight,
        (number, picture, before): (usize, &[[u8; 3]], &[[u8; 3]]),
        draw: &mut Draw,
        shown: &mut Shown,
        each: &mut dyn FnMut(usize, f64) -> ControlFlow<()>,
    ) -> Result<(), Failure> {
        let begin = shown.screen_frames;
        let stop = draw.whole(0, UNTIL_STOP - 1);
        for look in 0..LOOKS {
            if each(number, board.seconds()).is_break() {
                return Err(Error::Interrupted.into());
            }
            shown.stops += usize::from(look == stop);
            if let Some(camera) = &mut board.camera {
                camera.is_stopped = look == stop;
            }
            board.steps(draw.whole(1, EDGES) as usize)?;
            let frames = board.cable.as_mut().map(|cable| cable.receiver.take_frames());
            for frame in frames.transpose().map_err(Failure::Cable)?.into_iter().flatten() {
                shown.screen_frames += 1;
                if frame.pixels == picture {
                    run_camera(board);
                    return Ok(());
                }
                if frame.pixels != before {
                    return Err(self.torn(board, shown.screen_frames, (number, picture), &frame.pixels));
                }
            }
        }
        let place = self.place(board, number);
        Err(Failure::Missing { picture: number, frames: shown.screen_frames - begin, place })
    }

    fn torn(
        &self,
        board: &mut FirstLight,
        frame: usize,
        (number, picture): (usize, &[[u8; 3]]),
        pixels: &[[u8; 3]],
    ) -> Failure {
        if pixels.len() != picture.len() {
            return Failure::Cable(format!("frames of {} pixels, expected {}", pixels.len(), picture.len()));
        }
        let differing: Vec<usize> = (0..pixels.len()).filter(|at| pixels[*at] != picture[*at]).collect();
        let at = differing.first().copied().unwrap_or(0);
        let width = self.screen.line.active;
        Failure::Torn {
            frame,
            picture: number,
            differing: differing.len(),
            pixels: pixels.len(),
            row: at / width,
            column: at % width,
            got: pixels[at],
            expected: picture[at],
            place: self.place(board, number),
        }
    }

    /// The first boundary at which the words of what the camera sends now are not golden.
    fn boundary(&self, board: &mut FirstLight, raw: &RawFrame) -> Result<Option<Boundary>, Failure> {
        run_camera(board);
        let expected = self.golden.checks(self.display, raw)?;
        let mut go_on = |_, _| ControlFlow::Continue(());
        let checked = Board::open(board, PATIENCE)?.check_frames(&expected, 1, &mut go_on)?;
        Ok(checked.difference.map(|difference| difference.boundary))
    }

    /// Where in the board a frame goes wrong that the camera sees.
    fn place(&self, board: &mut FirstLight, number: usize) -> String {
        match self.boundary(board, &self.frames[number]) {
            Ok(None) => "words are golden up to the codes that come out of the memory".into(),
            Ok(Some(boundary)) => format!("the first words that differ are {boundary}"),
            Err(error) => format!("the board's CRCs name no boundary: {error}"),
        }
    }

    /// Words of the last frame at every boundary, what was lost on the way, and the camera's own rules.
    fn check_words(&self, board: &mut FirstLight) -> Result<(), Failure> {
        let Some(last) = self.frames.last() else { return Ok(()) };
        if let Some(boundary) = self.boundary(board, last)? {
            return Err(Failure::Words(boundary));
        }
        for register in ["input_wrong", "input_overruns", "input_range"] {
            let value = Board::open(&mut *board, PATIENCE)?.get(register.parse()?)?;
            if value != 0 {
                return Err(Failure::Lost { register, value });
            }
        }
        let complaint =
            board.camera.as_ref().and_then(|camera| camera.chip.borrow().complaints().first().cloned());
        complaint.map_or(Ok(()), |rule| Err(Failure::Camera(rule)))
    }
}

fn run_camera(board: &mut FirstLight) {
    if let Some(camera) = &mut board.camera {
        camera.is_stopped = false;
    }
}
