//! The KC705's core between two HDMI cables: its I2C buses, resets and pixel buses lead to models of the chips around it (`edof_board::chip_models`), at one of
//! which hangs a source, at the other a screen. As a board it has a serial line, so that any host of `edof-board` talks to it.

use super::pictures::TableWords;
use super::uart::Terminal;
use crate::bench::{Actor, Behaviour, Bench, ClockId, Memory};
use crate::chain::verilated::write_images;
use crate::verilator::{Library, Model, Options, Start};
use crate::{Error, Source, work};
use edof_board::chip_models::{Bus, Imageon, Kc705, Lines, Pulls, Wires};
use edof_board::line::Line;
use edof_core::storage::atomic::WorkFolder;
use edof_device::Design;
use edof_device::board::KC705;
use edof_golden::Display;
use edof_golden::video::figures::Periods;
use edof_hdl::board::{Identity, Kc705Core, Pace};
use edof_hdl::project::{Project, ProjectError, images, of_circuit, spacious};
use edof_network::FixedNetwork;
use std::cell::RefCell;
use std::io;
use std::rc::Rc;
use std::time::Duration;

/// What is not video goes as fast as the circuit can: a set-up takes some hundred thousand cycles, a millisecond of it is 100.
pub const PACE: Pace =
    Pace { cycles_per_bit: 8, uart_time_out: 16_000, i2c_quarter: 4, millisecond: 100, screen: None };

/// Edges of reset, and between two looks at what came.
const RESET: usize = 400;
const AT_ONCE: usize = 64;

/// `kc705_core` of a design at [`PACE`]; its sets of weights start with this network.
///
/// # Errors
/// [`ProjectError`]: what does not fit what.
pub fn project(design: &Design, network: &FixedNetwork, display: &Display) -> Result<Project, ProjectError> {
    let words = TableWords::of(display);
    let tables = words.tables();
    let identity = Identity::of(design, network);
    let sets = [network, network];
    spacious(|| {
        let mut core = Kc705Core::new(design, sets, &identity, &tables, &PACE)?;
        let files = images(design, sets).into_iter().chain(tables.images(design)).collect();
        Ok(of_circuit(&mut core, files)?)
    })
}

/// A core, compiled, its memory images on disk.
pub struct Compiled {
    library: Library,
    images: WorkFolder,
}

impl Compiled {
    /// Compiles a core, its synchronisers one edge late at random.
    ///
    /// # Errors
    /// A tool is missing or rejects the text, or a file cannot be written.
    pub fn new(project: &Project, options: &Options) -> Result<Self, Error> {
        let library = Library::build(&Source::from(project).metastable(), options)?;
        let images = work::folder()?;
        write_images(project, images.path())?;
        Ok(Self { library, images })
    }
}

/// Chips that several clocks reach.
type Shared<T> = Rc<RefCell<T>>;

/// An I2C bus, sampled by the core's clock.
struct Wiring<W> {
    clock: ClockId,
    /// `scl`, `sda`, `scl_low`, `sda_low`.
    ports: [usize; 4],
    wires: Shared<W>,
}

impl<W: Wires> Wiring<W> {
    fn new(source: &Source, clock: ClockId, bus: usize, wires: Shared<W>) -> Result<Self, Error> {
        let port = |name: &str, end: &str| source.port(&format!("{name}_{bus}_{end}"));
        let ports = [port("scl", "i")?, port("sda", "i")?, port("scl_low", "o")?, port("sda_low", "o")?];
        Ok(Self { clock, ports, wires })
    }
}

impl<W: Wires> Actor for Wiring<W> {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let [scl, sda, scl_low, sda_low] = self.ports;
        let pulls = Pulls { scl_low: model.peek(scl_low)? == 1, sda_low: model.peek(sda_low)? == 1 };
        let lines: Lines = self.wires.borrow_mut().step(pulls);
        model.poke(scl, lines.scl.into())?;
        model.poke(sda, lines.sda.into())
    }
}

/// The receiver's pins, in its own clock.
struct Inlet {
    clock: ClockId,
    data: usize,
    card: Shared<Imageon>,
}

impl Actor for Inlet {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let word = self.card.borrow_mut().pixel().unwrap_or(0);
        model.poke(self.data, word.into())
    }
}

/// The transmitter's pins, in the screen's clock.
struct Outlet {
    clock: ClockId,
    /// `hs`, `vs`, `de`, `data`.
    ports: [usize; 4],
    board: Shared<Kc705>,
}

impl Actor for Outlet {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let [hs, vs, de] = [0, 1, 2].map(|i| model.peek(self.ports[i]));
        let data = model.peek(self.ports[3])? as u16;
        self.board.borrow_mut().pixel(Bus { hs: hs? == 1, vs: vs? == 1, de: de? == 1, data });
        Ok(())
    }

    fn after(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }
}

/// A core that runs between two cables.
pub struct Cables {
    bench: Bench,
    input: ClockId,
    buses: (Wiring<Kc705>, Wiring<Imageon>),
    inlet: Inlet,
    outlet: Outlet,
    memory: Memory,
    terminal: Terminal,
    /// The board's chips, and the screen at its cable.
    pub board: Shared<Kc705>,
    /// The card's chips, and the source at its cable.
    pub card: Shared<Imageon>,
}

impl Cables {
    /// A core that was reset, with these chips around it.
    ///
    /// # Errors
    /// The ports are not those of a core, or the simulation stops.
    pub fn start(
        compiled: &Compiled,
        periods: Periods,
        (board, card): (Kc705, Imageon),
        seed: u64,
    ) -> Result<Self, Error> {
        let source = compiled.library.source();
        let memory_dir = Some(compiled.images.path().to_path_buf());
        let model = compiled.library.start(&Start { seed, memory_dir })?;
        let mut bench = Bench::new(model, seed);
        let core = bench.clock("clock_i", periods.core)?;
        bench.clock("calculator_clock_i", periods.calculator)?;
        let input = bench.clock("input_clock_i", periods.input)?;
        let screen = bench.clock("screen_clock_i", periods.output)?;
        let (board, card) = (Rc::new(RefCell::new(board)), Rc::new(RefCell::new(card)));
        let bus = |signal| source.signal("screen", signal);
        let ports = [bus("hs")?, bus("vs")?, bus("de")?, bus("data")?];
        let bundles = (Some("dram_write"), Some("dram_read"));
        let mut cables = Self {
            input,
            buses: (
                Wiring::new(source, core, 0, Rc::clone(&board))?,
                Wiring::new(source, core, 1, Rc::clone(&card))?,
            ),
            inlet: Inlet { clock: input, data: source.port("input_data_i")?, card: Rc::clone(&card) },
            outlet: Outlet { clock: screen, ports, board: Rc::clone(&board) },
            memory: Memory::new(source, bundles, core, ("dram_ready_i", 0), Behaviour::hard(seed), seed)?,
            terminal: Terminal::new(source, core, PACE.cycles_per_bit)?,
            bench,
            board,
            card,
        };
        cables.bench.set("uart_receive_i", 1)?;
        cables.bench.set("dram_ready_i", 0)?;
        cables.reset()?;
        cables.bench.set("dram_ready_i", 1)?;
        Ok(cables)
    }

    /// Presses the board's reset, which resets the switches of both buses as `rtl/kc705_top.v` wires it.
    ///
    /// # Errors
    /// As [`Cables::steps`].
    pub fn reset(&mut self) -> Result<(), Error> {
        for (level, pin) in [(1, false), (0, true)] {
            self.bench.set("reset_i", level)?;
            self.board.borrow_mut().set_reset(pin);
            self.card.borrow_mut().set_reset(pin);
            self.steps(RESET)?;
        }
        self.terminal.serial.forget();
        Ok(())
    }

    /// Simulates the given number of clock edges; the receiver's runs as the chip gives it.
    ///
    /// # Errors
    /// A rule of a port was broken, or the simulation stops.
    pub fn steps(&mut self, count: usize) -> Result<(), Error> {
        for _ in 0..count.div_ceil(AT_ONCE) {
            let runs = self.card.borrow_mut().clock_runs();
            self.bench.run_clock(self.input, runs);
            let actors: &mut [&mut dyn Actor] = &mut [
                &mut self.buses.0,
                &mut self.buses.1,
                &mut self.inlet,
                &mut self.outlet,
                &mut self.memory,
                &mut self.terminal,
            ];
            self.bench.steps(AT_ONCE, actors)?;
        }
        Ok(())
    }

    /// The board's light-emitting diodes, the first one low.
    ///
    /// # Errors
    /// The simulation stops.
    pub fn leds(&mut self) -> Result<u64, Error> {
        self.bench.get("leds_o")
    }

    /// Simulates until a condition holds, at most the given million edges. Returns whether the condition holds.
    ///
    /// # Errors
    /// As [`Cables::steps`].
    pub fn until(&mut self, millions: usize, is_so: impl Fn(&Self) -> bool) -> Result<bool, Error> {
        for _ in 0..millions * 1_000_000 / AT_ONCE {
            if is_so(self) {
                return Ok(true);
            }
            self.steps(AT_ONCE)?;
        }
        Ok(is_so(self))
    }
}

/// A host in the same program. Time passes while it waits.
impl Line for Cables {
    fn name(&self) -> &str {
        "simulated board (Verilog, between two cables)"
    }

    fn baud(&self) -> u32 {
        1000 * KC705.core_khz / u32::from(PACE.cycles_per_bit)
    }

    fn time(&self) -> Duration {
        Duration::from_nanos(self.bench.time_ps() / 1000)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.terminal.serial.send(bytes.iter().map(|byte| (0, *byte)));
        while !self.terminal.serial.is_done() {
            self.steps(AT_ONCE).map_err(io::Error::other)?;
        }
        Ok(())
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        let rests = 2 * u64::from(PACE.uart_time_out);
        let until = self.time() + patience;
        let nothing = |cables: &Self| cables.terminal.serial.came.is_empty();
        while nothing(self) && self.time() < until && self.terminal.serial.quiet < rests {
            self.steps(AT_ONCE).map_err(io::Error::other)?;
        }
        let came = &mut self.terminal.serial.came;
        Ok(came.drain(..max.min(came.len())).collect())
    }
}
