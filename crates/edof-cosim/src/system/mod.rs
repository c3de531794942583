//! A whole core in simulation: a camera at the receiver's pins, a screen at the transmitter's, a memory behind AXI, three clocks that have
//! nothing to do with each other; and what the screen shows against the golden picture.
//!
//! | who | module | stands at |
//! |---|---|---|
//! | [`Camera`], [`Screen`] | [`pins`] | the pins |
//! | [`Memory`](crate::bench::Memory), [`Host`] | [`bench`](crate::bench) | the memory's port, the host's |

pub mod pins;

pub use pins::{Camera, Screen};

use crate::bench::{Behaviour, Bench, ClockId, Host, Memory, Pace};
use crate::chain::verilated::write_images;
use crate::verilator::{Library, Options, Start};
use crate::{Error, Source, work};
use edof_golden::video::video_out::BLACK_PIXEL;
use edof_golden::{Display, Golden};
use edof_hdl::project::Project;
use edof_spec::RawFrame;
use edof_spec::atomic::WorkFolder;
use edof_spec::geometry::GeometryError;
use edof_spec::video::VideoTiming;

/// Periods of the clocks in picoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Periods {
    /// Core, memory, host.
    pub core: u64,
    /// The receiver's pixels.
    pub input: u64,
    /// The transmitter's pixels.
    pub output: u64,
}

/// A core, compiled, its memory images on disk.
pub struct Compiled {
    library: Library,
    source: Source,
    images: WorkFolder,
}

impl Compiled {
    /// Compiles a core (`edof_hdl::board::EdofCore`), its synchronisers by lot an edge late.
    ///
    /// # Errors
    /// A tool is missing or refuses the text, or a file cannot be written.
    pub fn new(project: &Project, options: &Options) -> Result<Self, Error> {
        let source = Source::from(project).metastable();
        let images = work::folder()?;
        write_images(project, images.path())?;
        Ok(Self { library: Library::build(&source, options)?, source, images })
    }
}

/// A core that runs.
pub struct Rig {
    /// The clocks.
    pub bench: Bench,
    /// The receiver's.
    pub input: ClockId,
    /// What sends frames.
    pub camera: Camera,
    /// What shows them.
    pub screen: Screen,
    /// Behind the memory's port.
    pub memory: Memory,
    /// Behind the host's.
    pub host: Host,
}

/// What a rig is started with.
#[derive(Debug, Clone)]
pub struct Begin {
    /// Timing of the receiver and the transmitter.
    pub timing: VideoTiming,
    /// The clocks.
    pub periods: Periods,
    /// The memory.
    pub behaviour: Behaviour,
    /// Start-up contents, phases, drift, stalls.
    pub seed: u64,
}

/// Edges of reset.
const RESET: usize = 400;

impl Rig {
    /// A core that was reset and sees a camera with these frames.
    ///
    /// # Errors
    /// The ports are not those of a core, or the simulation stops.
    pub fn start(compiled: &Compiled, begin: &Begin, frames: Vec<Vec<u16>>) -> Result<Self, Error> {
        let source = &compiled.source;
        let memory_dir = Some(compiled.images.path().to_path_buf());
        let model = compiled.library.start(&Start { seed: begin.seed, memory_dir })?;
        let mut bench = Bench::new(model, begin.seed);
        let core = bench.clock("clock_i", begin.periods.core)?;
        let input = bench.clock("input_clock_i", begin.periods.input)?;
        let output = bench.clock("output_clock_i", begin.periods.output)?;
        let size = (begin.timing.frame.active, begin.timing.line.active);
        let bundles = (Some("dram_write"), Some("dram_read"));
        let mut rig = Self {
            camera: Camera::new(source, "input", input, begin.timing, frames)?,
            screen: Screen::new(source, "output", output, "reset_i", size)?,
            memory: Memory::new(source, bundles, core, "reset_i", begin.behaviour.clone(), begin.seed)?,
            host: Host::new(source, "bus", core, "reset_i", Pace::steady())?,
            bench,
            input,
        };
        rig.bench.set("dram_ready_i", 1)?;
        rig.reset()?;
        Ok(rig)
    }

    /// Resets the core; the camera goes on.
    ///
    /// # Errors
    /// As [`Rig::steps`].
    pub fn reset(&mut self) -> Result<(), Error> {
        self.bench.set("reset_i", 1)?;
        self.steps(RESET)?;
        self.bench.set("reset_i", 0)?;
        // Each domain's reset lasts longer than the request.
        self.steps(RESET)
    }

    /// So many edges of the clocks.
    ///
    /// # Errors
    /// A rule of a port was broken, or the simulation stops.
    pub fn steps(&mut self, count: usize) -> Result<(), Error> {
        self.bench.steps(count, &mut [&mut self.camera, &mut self.screen, &mut self.memory, &mut self.host])
    }

    /// Until so many more frames were shown.
    ///
    /// # Errors
    /// As [`Rig::steps`].
    pub fn show(&mut self, frames: usize) -> Result<(), Error> {
        let wanted = self.screen.frames.len() + frames;
        while self.screen.frames.len() < wanted {
            self.steps(100)?;
        }
        Ok(())
    }

    /// Until the camera sends the frame of that number.
    ///
    /// # Errors
    /// As [`Rig::steps`].
    pub fn send(&mut self, frame: usize) -> Result<(), Error> {
        while self.camera.frame < frame {
            self.steps(100)?;
        }
        Ok(())
    }
}

/// The pixel words of a raw frame, as a camera sends them.
#[must_use]
pub fn sent(raw: &RawFrame) -> Vec<u16> {
    raw.pixels().iter().copied().collect()
}

/// What the screen must show for a frame: what `edof reconstruct --board` writes, a word a pixel.
///
/// # Errors
/// The frame is too small for the network.
pub fn picture(golden: &Golden, display: &Display, raw: &RawFrame) -> Result<Vec<u16>, GeometryError> {
    let bytes = golden.frame(raw)?.picture(display).0.yuyv();
    Ok(bytes.chunks_exact(2).map(|bytes| u16::from_le_bytes([bytes[0], bytes[1]])).collect())
}

/// A frame that is not what was sent.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "shown frame {shown}: {differing} of {pixels} pixels differ from picture {nearest}, the nearest; \
     the first at row {row}, column {column}: {got:04x}, expected {expected:04x}"
)]
#[allow(missing_docs, reason = "the message names the fields")]
pub struct Torn {
    pub shown: usize,
    pub nearest: usize,
    pub differing: usize,
    pub pixels: usize,
    pub row: usize,
    pub column: usize,
    pub got: u16,
    pub expected: u16,
}

/// Which picture each shown frame is, none where it is black.
///
/// # Errors
/// [`Torn`]: the first frame that is neither.
pub fn compare(
    shown: &[(u64, Vec<u16>)],
    pictures: &[Vec<u16>],
    width: usize,
) -> Result<Vec<Option<usize>>, Torn> {
    let which = |(number, (_, frame)): (usize, &(u64, Vec<u16>))| {
        if frame.iter().all(|pixel| *pixel == BLACK_PIXEL) {
            return Ok(None);
        }
        if let Some(found) = pictures.iter().position(|picture| picture == frame) {
            return Ok(Some(found));
        }
        let differing = |picture: &Vec<u16>| picture.iter().zip(frame).filter(|(a, b)| a != b).count();
        let nearest = (0..pictures.len()).min_by_key(|i| differing(&pictures[*i])).unwrap_or(0);
        let expected = pictures.get(nearest).cloned().unwrap_or_default();
        let at = expected.iter().zip(frame).position(|(a, b)| a != b).unwrap_or(0);
        Err(Torn {
            shown: number,
            nearest,
            differing: differing(&expected),
            pixels: frame.len(),
            row: at / width,
            column: at % width,
            got: frame.get(at).copied().unwrap_or(0),
            expected: expected.get(at).copied().unwrap_or(0),
        })
    };
    shown.iter().enumerate().map(which).collect()
}

/// The entries of a display's tables as memory words: luma; red, green and blue.
#[must_use]
pub fn tables(display: &Display) -> (Vec<u64>, [Vec<u64>; 3]) {
    let luma = display.luma.entries().iter().map(|code| u64::from(*code)).collect();
    let colours = display.colours.each_ref();
    (luma, colours.map(|table| table.entries().iter().map(|entry| u64::from(*entry)).collect()))
}
