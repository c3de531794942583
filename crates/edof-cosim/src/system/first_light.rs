//! The ULX3S in Verilator, of which a host sees a serial line and nothing else: everything between its pins is simulated; at them are a model of its
//! SDRAM and, where one is connected, of its camera.

use super::board::Speed;
use super::camera::CameraModule;
use super::pictures::TableWords;
use super::sdram::SdramChip;
use super::uart::Terminal;
use crate::bench::{Actor, Bench, ClockId};
use crate::chain::verilated::write_images;
use crate::verilator::{Library, Model, Options, Start};
use crate::{Source, work};
use edof_board::Error;
use edof_board::chip_models::Ov7670;
use edof_board::chip_models::dvi::Receiver;
use edof_board::faulty::Resettable;
use edof_board::line::{BITS_PER_BYTE, Line, line_time};
use edof_board::terminal::Device;
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_device::video::VideoTiming;
use edof_golden::video::figures::Periods;
use edof_golden::{Display, Picture};
use edof_hdl::board::{Identity, Pace, Ulx3sCore};
use edof_hdl::project::{Project, ProjectError, images, of_circuit, spacious};
use edof_network::FixedNetwork;
use std::io;
use std::time::Duration;

/// Edges of reset, between two looks at what came, and between two looks at a pseudo-terminal.
const RESET: usize = 400;
const AT_ONCE: usize = 64;
const BETWEEN: usize = 2_000;
/// Edges between two looks at the camera's clock.
const BETWEEN_CLOCKS: usize = 500;
/// Picoseconds of the board's clock to the camera.
const BOARD_CLOCK: u64 = 40_000;

/// A screen at pins with two bits per cycle of their clock: blue, green, red, clock.
pub struct DviCable {
    clock: ClockId,
    port: usize,
    /// What the screen got.
    pub receiver: Receiver,
}

impl DviCable {
    /// A cable at a port, in the clock of its bits.
    #[must_use]
    pub fn new(port: usize, clock: ClockId) -> Self {
        Self { clock, port, receiver: Receiver::default() }
    }

    fn take(&mut self, pins: u64) {
        self.receiver.bits([0, 1, 2, 3].map(|pair| pins >> pair & 1 == 1));
    }
}

impl Actor for DviCable {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), crate::Error> {
        let pins = model.peek(self.port)?;
        self.take(pins);
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), crate::Error> {
        let pins = model.peek_high(self.port)?;
        self.take(pins);
        Ok(())
    }
}

/// Returns red, green and blue of a screen that shows a picture in its middle, line by line.
#[must_use]
pub fn on_screen(picture: &Picture, screen: VideoTiming) -> Vec<[u8; 3]> {
    let shown = picture.shown();
    let (_, height, width) = shown.dim();
    let (columns, rows) = (screen.line.active, screen.frame.active);
    let (left, top) = ((columns - width) / 2, (rows - height) / 2);
    let mut pixels = vec![[0; 3]; columns * rows];
    for ((plane, row, column), code) in shown.indexed_iter() {
        pixels[(top + row) * columns + left + column][plane] = *code;
    }
    pixels
}

/// A screen that is little larger than the frames: hosts wait for whole frames, which take a sixtieth of a second each on the design's.
#[must_use]
pub fn small_screen(design: &Design) -> VideoTiming {
    let frame = design.frame;
    VideoTiming::of_frame(FrameSize { width: frame.width + 4, height: frame.height + 2, ..frame })
}

/// A pace at which hosts wait for less: a line of this speed, a fast camera's bus with short milliseconds, a screen of this timing.
#[must_use]
pub const fn short_pace(speed: Speed, screen: VideoTiming) -> Pace {
    Pace {
        cycles_per_bit: speed.cycles_per_bit,
        uart_time_out: speed.time_out,
        i2c_quarter: 4,
        millisecond: 500,
        screen: Some(screen),
    }
}

/// `ulx3s_core` of a design at this pace; its sets of weights start with these networks.
///
/// # Errors
/// [`ProjectError`]: what does not fit what.
pub fn project(
    design: &Design,
    sets: [&FixedNetwork; 2],
    display: &Display,
    pace: &Pace,
) -> Result<Project, ProjectError> {
    let words = TableWords::of(display);
    let tables = words.tables();
    let identity = Identity::of(design, sets[0]);
    spacious(|| {
        let mut core = Ulx3sCore::new(design, sets, &identity, &tables, pace)?;
        let files = images(design, sets).into_iter().chain(tables.images(design)).collect();
        Ok(of_circuit(&mut core, files)?)
    })
}

/// A ULX3S that runs.
pub struct FirstLight {
    bench: Bench,
    terminal: Terminal,
    sdram: SdramChip,
    /// The core's clock, and its period.
    core: (ClockId, u64),
    screen_clock: ClockId,
    /// The camera, once there is one.
    pub camera: Option<CameraModule>,
    /// The screen, once there is one.
    pub cable: Option<DviCable>,
    pace: Pace,
    /// Bytes from the host, and to it.
    pub bytes: [u64; 2],
    /// Seconds that a host waited where nothing could come any more: they count, but are not simulated.
    waited: f64,
}

fn stopped(error: impl std::error::Error + Send + Sync + 'static) -> Error {
    Error::Simulation(Box::new(error))
}

impl FirstLight {
    /// The board of a design whose sets start with these networks; the seed decides everything random.
    ///
    /// # Errors
    /// What does not fit, or as [`FirstLight::start`].
    pub fn new(
        design: &Design,
        sets: [&FixedNetwork; 2],
        display: &Display,
        (speed, seed): (Speed, u64),
        options: &Options,
    ) -> Result<Self, Error> {
        let pace = short_pace(speed, small_screen(design));
        let project = project(design, sets, display, &pace).map_err(stopped)?;
        Self::start(&project, design, (pace, seed), options)
    }

    /// Compiles the files of [`project`] at this pace, its synchronisers one edge late at random, and starts them.
    ///
    /// # Errors
    /// A tool is missing or rejects the text, or a file cannot be written.
    pub fn start(
        project: &Project,
        design: &Design,
        (pace, seed): (Pace, u64),
        options: &Options,
    ) -> Result<Self, Error> {
        let library = Library::build(&Source::from(project).metastable(), options).map_err(stopped)?;
        let images = work::folder().map_err(stopped)?;
        write_images(project, images.path()).map_err(stopped)?;
        let of_images = Some(images.path().to_path_buf());
        let model = library.start(&Start { seed, memory_dir: of_images }).map_err(stopped)?;
        let mut bench = Bench::new(model, seed);
        let periods = Periods::of_board(design);
        let screen = 1_000_000_000 / design.screen().pixel_khz as u64;
        let mut clock = |port, period| bench.clock(port, period).map_err(stopped);
        let core = clock("clock_i", periods.core)?;
        clock("calculator_clock_i", periods.calculator)?;
        let screen_clock = clock("screen_clock_i", screen)?;
        let terminal = Terminal::new(library.source(), core, pace.cycles_per_bit).map_err(stopped)?;
        let sdram = SdramChip::new(library.source(), "sdram_", core, periods.core).map_err(stopped)?;
        let last_word = 2 * (design.frame.width * design.frame.height - 1) as u32;
        let sdram = sdram.watching(design.board.memory.picture_buffers.map(|buffer| buffer + last_word));
        // Lines that nobody drives.
        for port in ["uart_receive_i", "camera_scl_i", "camera_sda_i"] {
            bench.set(port, 1).map_err(stopped)?;
        }
        let mut board = Self {
            bench,
            terminal,
            sdram,
            core: (core, periods.core),
            screen_clock,
            camera: None,
            cable: None,
            pace,
            bytes: [0; 2],
            waited: 0.0,
        };
        board.reset()?;
        Ok(board)
    }

    /// Simulates the given number of clock edges.
    ///
    /// # Errors
    /// The simulation stops.
    pub fn steps(&mut self, edges: usize) -> Result<(), Error> {
        let Self { bench, terminal, sdram, camera, cable, .. } = self;
        for begin in (0..edges).step_by(BETWEEN_CLOCKS) {
            // The cable is the first to look: where clocks rise together, the others let them fall again.
            let mut actors: Vec<&mut dyn Actor> =
                cable.iter_mut().map(|cable| cable as &mut dyn Actor).collect();
            actors.extend([&mut *terminal as &mut dyn Actor, &mut *sdram]);
            if let Some(CameraModule { control, pixels, .. }) = camera {
                actors.extend([control as &mut dyn Actor, pixels]);
            }
            bench.steps(BETWEEN_CLOCKS.min(edges - begin), &mut actors).map_err(stopped)?;
            if let Some(camera) = camera {
                camera.follow(bench);
            }
        }
        Ok(())
    }

    /// Connects a camera, which is made for a millisecond of so many picoseconds.
    ///
    /// # Errors
    /// The circuit has no such pins.
    pub fn connect_camera(&mut self, chip: impl FnOnce(u64) -> Ov7670) -> Result<(), Error> {
        let chip = chip(u64::from(self.pace.millisecond) * self.core.1);
        let camera = CameraModule::new(&mut self.bench, self.core, chip, BOARD_CLOCK).map_err(stopped)?;
        self.camera = Some(camera);
        Ok(())
    }

    /// Connects a screen. Without one the clock of its bits stands still, which makes the simulation faster.
    ///
    /// # Errors
    /// The circuit has no such pins.
    pub fn connect_screen(&mut self) -> Result<(), Error> {
        let clock = self.bench.multiple("bit_clock_i", 5, self.screen_clock).map_err(stopped)?;
        let port = self.bench.model().library().source().port("dvi_o").map_err(stopped)?;
        self.cable = Some(DviCable::new(port, clock));
        Ok(())
    }

    /// Presses FIRE1.
    ///
    /// # Errors
    /// As [`FirstLight::steps`].
    pub fn reset(&mut self) -> Result<(), Error> {
        for level in [1, 0] {
            self.bench.set("reset_i", level).map_err(stopped)?;
            self.steps(RESET)?;
        }
        self.terminal.serial.forget();
        Ok(())
    }

    /// The LEDs that the core has, the first one low.
    ///
    /// # Errors
    /// As [`FirstLight::steps`].
    pub fn leds(&mut self) -> Result<u64, Error> {
        self.bench.get("leds_o").map_err(stopped)
    }

    /// Pictures per second that came whole into the memory, if there are two.
    #[must_use]
    pub fn pictures_per_second(&self) -> Option<f64> {
        match self.sdram.moments() {
            [first, .., last] => {
                Some((self.sdram.moments().len() - 1) as f64 / ((last - first) as f64 * 1e-12))
            }
            _ => None,
        }
    }

    /// Refreshes of the memory so far.
    #[must_use]
    pub fn refreshes(&self) -> usize {
        self.sdram.refreshes()
    }

    /// Simulated seconds so far.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.bench.time_ps() as f64 * 1e-12 + self.waited
    }

    fn put(&mut self, bytes: &[u8]) {
        self.bytes[0] += bytes.len() as u64;
        self.terminal.serial.send(bytes.iter().map(|byte| (0, *byte)));
    }

    fn take(&mut self, max: usize) -> Vec<u8> {
        let came = &mut self.terminal.serial.came;
        let bytes: Vec<u8> = came.drain(..max.min(came.len())).collect();
        self.bytes[1] += bytes.len() as u64;
        bytes
    }

    /// Whether nothing comes any more, however long one waits.
    fn rests(&self) -> bool {
        let byte = u64::from(self.pace.cycles_per_bit) * u64::from(BITS_PER_BYTE);
        self.terminal.serial.quiet > u64::from(self.pace.uart_time_out) + 2 * byte
    }
}

/// A host in the same program. Its waiting is simulated for as long as anything can still come, and only counted after that.
impl Line for FirstLight {
    fn name(&self) -> &str {
        "simulated board (Verilog, from pin to pin)"
    }

    fn baud(&self) -> u32 {
        (1_000_000_000_000 / (self.core.1 * u64::from(self.pace.cycles_per_bit))) as u32
    }

    fn time(&self) -> Duration {
        Duration::from_secs_f64(self.seconds())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.put(bytes);
        while !self.terminal.serial.is_done() {
            self.steps(AT_ONCE).map_err(io::Error::other)?;
        }
        Ok(())
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        let until = self.seconds() + patience.as_secs_f64();
        while self.terminal.serial.came.is_empty() && self.seconds() < until && !self.rests() {
            self.steps(AT_ONCE).map_err(io::Error::other)?;
        }
        if self.terminal.serial.came.is_empty() {
            self.waited += (until - self.seconds()).max(0.0);
        }
        Ok(self.take(max))
    }
}

impl Resettable for FirstLight {
    fn press_reset(&mut self) -> io::Result<()> {
        self.reset().map_err(io::Error::other)
    }
}

impl Device for FirstLight {
    fn exchange(&mut self, came: &[u8]) -> Result<Vec<u8>, Error> {
        self.put(came);
        self.steps(BETWEEN)?;
        Ok(self.take(usize::MAX))
    }

    fn picture(&self) -> Option<Vec<u16>> {
        None
    }

    fn mixed(&self) -> Option<u64> {
        None
    }

    fn carried(&self) -> ([u64; 2], f64) {
        let bytes = self.bytes;
        (bytes, line_time((bytes[0] + bytes[1]) as usize, self.baud()).as_secs_f64())
    }

    fn is_busy(&self) -> bool {
        true
    }
}
