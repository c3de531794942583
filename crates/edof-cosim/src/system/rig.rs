//! A core that runs between a camera and a screen.

use super::fifos::{self, Fifo};
use super::pictures::TableWords;
use super::pins::{Camera, Screen};
use super::recorded::cycles;
use crate::bench::axi_lite::Access;
use crate::bench::{Actor, Behaviour, Bench, ClockId, Host, Mark, Memory, Throttle};
use crate::chain::verilated::write_images;
use crate::verilator::{Library, Options, Start};
use crate::{Error, Source, work};
use edof_core::DisplayMode;
use edof_core::storage::atomic::WorkFolder;
use edof_device::Design;
use edof_device::registers::map;
use edof_device::video::VideoTiming;
use edof_golden::Display;
use edof_golden::video::figures::Periods;
use edof_hdl::board::Identity;
use edof_hdl::boards::circuits;
use edof_hdl::project::{Project, ProjectError, images, of_circuit, spacious};
use edof_network::FixedNetwork;

/// The core of a design (`edof_hdl::board::EdofCore`) with its images: its sets of weights start with these networks, the display with
/// these tables.
///
/// # Errors
/// [`ProjectError`]: what does not fit what.
pub fn project(
    design: &Design,
    sets: [&FixedNetwork; 2],
    display: &Display,
) -> Result<Project, ProjectError> {
    let words = TableWords::of(display);
    let tables = words.tables();
    let identity = Identity::of(design, sets[0]);
    spacious(|| {
        let mut core = (circuits(design.board)?.core)(design, sets, &identity, &tables)?;
        let files = images(design, sets).into_iter().chain(tables.images(design)).collect();
        Ok(of_circuit(&mut *core, files)?)
    })
}

/// The clocks of memory and calculator as on the board; pixels so slow that both keep up with every frame, and the screen a little faster than
/// the camera, so that it shows every picture.
#[must_use]
pub fn leisurely(design: &Design) -> Periods {
    let timing = VideoTiming::of_frame(design.frame);
    let pixels = (timing.line.total() * timing.frame.total()) as u64;
    let periods = Periods::of_board(design);
    let input = periods.core.max(periods.calculator) * cycles(design) as u64 / pixels;
    Periods { input, output: input * 97 / 100, ..periods }
}

/// A core, compiled, its memory images on disk.
pub struct Compiled {
    library: Library,
    images: WorkFolder,
    marks: Vec<Mark>,
}

impl Compiled {
    /// Compiles a core, its synchronisers one edge late at random, its FIFOs watched.
    ///
    /// # Errors
    /// A tool is missing or rejects the text, or a file cannot be written.
    pub fn new(project: &Project, options: &Options) -> Result<Self, Error> {
        let marks = fifos::marks(project);
        let source = Source::from(project).metastable().watched("reset_i", &marks);
        let library = Library::build(&source, options)?;
        let images = work::folder()?;
        write_images(project, images.path())?;
        Ok(Self { library, images, marks })
    }
}

/// What a rig is started with.
#[derive(Debug, Clone)]
pub struct RigConfig {
    /// What the FIFOs are made for.
    pub buffers: edof_device::board::Memory,
    /// Timing of the receiver and the transmitter.
    pub timing: VideoTiming,
    /// The clocks.
    pub periods: Periods,
    /// The memory.
    pub behaviour: Behaviour,
    /// Start-up contents, phases, drift, stalls.
    pub seed: u64,
}

impl RigConfig {
    /// [`leisurely`] clocks, and a memory as hard to please as AXI allows.
    #[must_use]
    pub fn leisurely(design: &Design, seed: u64) -> Self {
        let (timing, periods) = (VideoTiming::of_frame(design.frame), leisurely(design));
        Self { buffers: design.board.memory, timing, periods, behaviour: Behaviour::hard(seed), seed }
    }
}

/// A core that runs, with someone behind its host's port.
pub struct Rig<H = Host> {
    /// The clocks.
    pub bench: Bench,
    /// That of memory and host.
    pub core: ClockId,
    /// The receiver's.
    pub input: ClockId,
    /// The calculator's.
    pub calculator: ClockId,
    /// The screen's.
    pub output: ClockId,
    /// What sends frames.
    pub camera: Camera,
    /// What shows them.
    pub screen: Screen,
    /// Behind the memory's port.
    pub memory: Memory,
    /// Behind the host's.
    pub host: H,
    /// When each of the camera's frames began, and each of the screen's ended, in picoseconds.
    pub sent_at: Vec<u64>,
    /// As of [`Screen::frames`].
    pub shown_at: Vec<u64>,
    /// What is watched.
    pub(super) marks: Vec<Mark>,
}

/// Edges of reset.
const RESET: usize = 400;
/// Edges within which a host is answered, a frame is sent or shown: more, and the core hangs.
const PATIENCE: usize = 100_000_000;
/// Edges between two looks.
const AT_ONCE: usize = 50;

impl Rig {
    /// A core that was reset and sees a camera with these frames, its registers at the hands of a [`Host`].
    ///
    /// # Errors
    /// The ports are not those of a core, or the simulation stops.
    pub fn start(compiled: &Compiled, begin: &RigConfig, frames: Vec<Vec<u16>>) -> Result<Self, Error> {
        Self::start_with(compiled, begin, frames, |source, clock| {
            Host::new(source, "host", clock, "reset_i", Throttle::drawn(begin.seed))
        })
    }
}

impl<H: Actor> Rig<H> {
    /// A core that was reset and sees a camera with these frames, and what lives behind its host's port, in the clock that it is given.
    ///
    /// # Errors
    /// As [`Rig::start`].
    pub fn start_with(
        compiled: &Compiled,
        begin: &RigConfig,
        frames: Vec<Vec<u16>>,
        host: impl FnOnce(&Source, ClockId) -> Result<H, Error>,
    ) -> Result<Self, Error> {
        let source = compiled.library.source();
        let memory_dir = Some(compiled.images.path().to_path_buf());
        let model = compiled.library.start(&Start { seed: begin.seed, memory_dir })?;
        let mut bench = Bench::new(model, begin.seed);
        let core = bench.clock("clock_i", begin.periods.core)?;
        let calculator = bench.clock("calculator_clock_i", begin.periods.calculator)?;
        let input = bench.clock("input_clock_i", begin.periods.input)?;
        let output = bench.clock("screen_clock_i", begin.periods.output)?;
        let size = (begin.timing.frame.active, begin.timing.line.active);
        let bundles = (Some("dram_write"), Some("dram_read"));
        let mut rig = Self {
            camera: Camera::new(source, "input", input, begin.timing, frames)?,
            screen: Screen::new(source, "screen", output, "reset_i", size)?,
            memory: Memory::new(
                source,
                bundles,
                core,
                ("dram_ready_i", 0),
                begin.behaviour.clone(),
                begin.seed,
            )?,
            host: host(source, core)?,
            bench,
            core,
            input,
            calculator,
            output,
            sent_at: vec![],
            shown_at: vec![],
            marks: compiled.marks.clone(),
        };
        rig.bench.set("i2c_done_i", 1)?;
        rig.bench.set("dram_ready_i", 0)?;
        rig.reset()?;
        rig.bench.set("dram_ready_i", 1)?;
        Ok(rig)
    }

    /// Resets the core; camera, screen and memory continue.
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

    /// Simulates the given number of clock edges.
    ///
    /// # Errors
    /// A rule of a port was broken, or the simulation stops.
    pub fn steps(&mut self, count: usize) -> Result<(), Error> {
        let actors: &mut [&mut dyn Actor] =
            &mut [&mut self.camera, &mut self.screen, &mut self.memory, &mut self.host];
        self.bench.steps(count, actors)?;
        let now = self.bench.time_ps();
        self.sent_at.resize(self.camera.frame + 1, now);
        self.shown_at.resize(self.screen.frames.len(), now);
        Ok(())
    }

    /// Until something is so.
    ///
    /// # Errors
    /// As [`Rig::steps`]; or it does not come to be.
    pub fn until(&mut self, what: &str, is_so: impl Fn(&Self) -> bool) -> Result<(), Error> {
        for _ in 0..PATIENCE / AT_ONCE {
            if is_so(self) {
                return Ok(());
            }
            self.steps(AT_ONCE)?;
        }
        Err(Error::Stopped(format!("{what}: not within {PATIENCE} edges")))
    }

    /// Simulates until the given number of further frames was shown.
    ///
    /// # Errors
    /// As [`Rig::until`].
    pub fn show(&mut self, frames: usize) -> Result<(), Error> {
        let wanted = self.screen.frames.len() + frames;
        self.until("a frame on the screen", |rig| rig.screen.frames.len() >= wanted)
    }

    /// Until the camera sends the frame of that number.
    ///
    /// # Errors
    /// As [`Rig::until`].
    pub fn send(&mut self, frame: usize) -> Result<(), Error> {
        self.until("a frame of the camera", |rig| rig.camera.frame >= frame)
    }

    /// Every FIFO, as full as it was since the last reset, beside what the model says for these clocks and for how late the memory was.
    ///
    /// # Errors
    /// The simulation stops.
    pub fn fifos(&mut self, begin: &RigConfig) -> Result<Vec<Fifo>, Error> {
        let late = self.memory.written.max_late.max(self.memory.read.max_late);
        let mut found = vec![];
        for mark in self.marks.clone() {
            let max = self.bench.get(&mark.port())? as usize;
            let (limit, depth) = fifos::limit(&mark.name, &begin.buffers, begin.periods, late);
            found.push(Fifo { name: mark.name, max, limit, depth });
        }
        Ok(found)
    }
}

impl Rig {
    /// The host writes the display's mode and the set of weights, and lets the calculator run.
    ///
    /// # Errors
    /// As [`Rig::register`].
    pub fn control(&mut self, mode: DisplayMode, set: usize) -> Result<(), Error> {
        self.access(Access::Write(map::CONTROL, map::running(mode, set))).map(drop)
    }

    /// The host reads the register of that name.
    ///
    /// # Errors
    /// There is none, or as [`Rig::until`].
    pub fn register(&mut self, name: &str) -> Result<u32, Error> {
        self.access(Access::Read(address(name)?))
    }

    /// The host reads or writes; what it reads, or 0.
    ///
    /// # Errors
    /// The board rejects the access, or as [`Rig::until`].
    pub fn access(&mut self, access: Access) -> Result<u32, Error> {
        let before = self.host.answers.len();
        self.host.wanted.push_back(access);
        self.until("an answer to the host", |rig| rig.host.answers.len() > before)?;
        let answer = self.host.answers[before];
        let refused = || Error::Stopped(format!("the host's {access:?} was refused"));
        answer.is_good.then_some(answer.word).ok_or_else(refused)
    }
}

fn address(name: &str) -> Result<u32, Error> {
    let found = map::register(name).map(|register| register.address);
    found.ok_or_else(|| Error::Port(format!("no register is called {name}")))
}
