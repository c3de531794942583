//! Boards as values: everything that designs, circuits, estimates and hosts ask of an FPGA board.
//!
//! | what | module |
//! |---|---|
//! | cells of an FPGA, their names and sizes | [`part`] |
//! | clocks that a PLL makes | [`pll`] |
//! | frames in memory | [`memory`] |
//! | the KC705 | [`kc705`] |
//! | the ULX3S | [`ulx3s`] |
//!
//! A board is one file with its value and one line in [`BOARDS`]. A design names its board; what a design asks of it is in
//! [`crate::design::on_board`].

pub mod kc705;
pub mod memory;
pub mod part;
pub mod pll;
pub mod ulx3s;

pub use kc705::KC705;
pub use memory::Memory;
pub use part::{BlockMemory, Part, Resources};
pub use pll::{MadeClock, Pll};
pub use ulx3s::ULX3S;

use crate::i2c::Entry;
use crate::video::VideoTiming;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// All boards; the first is that of designs which name none.
pub const BOARDS: [&Board; 2] = [&KC705, &ULX3S];

/// Milliseconds of silence after which a frame on the host's line is given up, on every board.
pub const UART_TIME_OUT_MS: u32 = 100;

/// An FPGA board.
pub struct Board {
    /// Name in design files.
    pub name: &'static str,
    /// The FPGA.
    pub part: Part,
    /// Clock of the memory's port and of the host's registers, in kilohertz.
    pub core_khz: u32,
    /// What makes the clocks of calculator and screen.
    pub clocks: ClockMaker,
    /// Memory for frames.
    pub memory: Memory,
    /// Numbers of sets of weights that a design may have: two where a host loads one while the other is used.
    pub sets: &'static [usize],
    /// Bits per second on the serial line to the host.
    pub baud: u32,
    /// Where raw frames come in.
    pub video_in: Option<VideoIn>,
    /// Where pictures leave.
    pub video_out: Option<VideoOut>,
    /// Surroundings of the core that sources can be written for, the default first.
    pub shells: &'static [Shell],
}

/// A clock and the PLL that makes others of it.
pub struct ClockMaker {
    /// Kilohertz at the PLL's input.
    pub source_khz: u32,
    /// The PLL of the part.
    pub pll: Pll,
}

/// A video input.
pub struct VideoIn {
    /// Set-up of its chip.
    pub setup: Setup,
    /// Where the frames are from.
    pub source: Source,
}

/// Where raw frames are from.
pub enum Source {
    /// A cable's receiver: 4:2:2 with raw pixel words in the codes, in a video mode.
    Cable {
        /// Least and most nanoseconds from a rising edge of its clock, of such a period, to a change of its data.
        delays_ns: fn(f64) -> [f64; 2],
    },
    /// A camera: red first, a byte per pixel.
    Camera {
        /// Its whole frames. Those of a design are in their middle.
        timing: VideoTiming,
        /// The byte of black, which becomes 0.
        black: u8,
    },
}

/// A video output: a picture in 4:2:2.
pub struct VideoOut {
    /// Set-up of its chip, if it has one.
    pub setup: Option<Setup>,
    /// How frames are shown.
    pub frames: Frames,
}

/// How a video output shows frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frames {
    /// As whole screens of these modes. Frames of other sizes are not shown, and have the slowest pixel clock in kilohertz.
    OfModes(&'static [VideoTiming], u64),
    /// In the middle of a screen, in black.
    Middle(VideoTiming),
}

/// The set-up of video chips on an I2C bus.
pub struct Setup {
    /// Memory image of the program, relative to the generated directory.
    pub image: &'static str,
    /// Makes the program for a video mode; a camera's window is moved right and down by so many pixels ([`CameraModule::corner`]).
    ///
    /// [`CameraModule::corner`]: crate::design::CameraModule::corner
    pub program: fn(VideoTiming, [i8; 2]) -> Vec<Entry>,
}

/// Surroundings of the core: a memory controller, a connection to the host, a build script.
pub struct Shell {
    /// Name as an option.
    pub name: &'static str,
    /// What it is, for the option's help.
    pub about: &'static str,
    /// Top module.
    pub top: &'static str,
    /// Lists of files: path in the generated directory, and text. Names between `@` become numbers of the design.
    pub files: &'static [&'static [(&'static str, &'static str)]],
}

impl Board {
    /// Returns the board of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        BOARDS.into_iter().find(|board| board.name == name)
    }

    /// Returns the names of all boards.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        BOARDS.map(|board| board.name).to_vec()
    }

    /// Whether it is the board of designs that name none.
    #[must_use]
    pub fn is_default(&self) -> bool {
        self == BOARDS[0]
    }

    /// Returns the clock of so many kilohertz, if the board's PLL makes it.
    #[must_use]
    pub fn clock(&self, khz: u64) -> Option<MadeClock> {
        self.clocks.pll.make(self.clocks.source_khz.into(), khz)
    }

    /// Returns the shell of a name.
    #[must_use]
    pub fn shell(&self, name: &str) -> Option<&'static Shell> {
        self.shells.iter().find(|shell| shell.name == name)
    }

    /// Whether raw frames come by cable.
    #[must_use]
    pub fn is_cabled(&self) -> bool {
        matches!(self.video_in, Some(VideoIn { source: Source::Cable { .. }, .. }))
    }

    /// Returns the set-ups of the output's and of the input's chips.
    pub fn setups(&self) -> impl Iterator<Item = &Setup> {
        let [output, input] = [
            self.video_out.as_ref().and_then(|video| video.setup.as_ref()),
            self.video_in.as_ref().map(|video| &video.setup),
        ];
        output.into_iter().chain(input)
    }
}

impl fmt::Debug for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Board({})", self.name)
    }
}

impl fmt::Debug for Shell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Shell({})", self.name)
    }
}

/// Boards of one name are one board.
impl PartialEq for Board {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Serialize for Board {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

impl<'de> Deserialize<'de> for &'static Board {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        let unknown = || format!("board '{name}' is unknown, expected {}", Board::names().join(" or "));
        Board::named(&name).ok_or_else(|| D::Error::custom(unknown()))
    }
}

impl Default for &'static Board {
    fn default() -> Self {
        BOARDS[0]
    }
}
