//! A whole core in Verilator as a board: a serial line at its pins, a frame that goes round, and what the screen shows.

use super::chips::Chips;
use super::pictures::sent;
use super::rig::{Compiled, Rig, RigConfig, project};
use super::uart::Uart;
use crate::Source;
use crate::bench::{Actor, ClockId, Memory};
use crate::verilator::{Model, Options};
use edof_board::Error;
use edof_board::faulty::Resettable;
use edof_board::line::{BITS_PER_BYTE, Line, line_time};
use edof_board::terminal::Device;
use edof_core::RawFrame;
use edof_device::Design;
use edof_device::board::Board;
use edof_golden::video::video_out::BLACK_PIXEL;
use edof_golden::{Display, Golden};
use edof_hdl::project::Project;
use edof_network::FixedNetwork;
use std::io;
use std::time::Duration;

/// How fast a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Speed {
    /// The core's clock in kilohertz.
    core_khz: u32,
    /// Cycles of the core's clock that a bit takes.
    pub cycles_per_bit: u16,
    /// Cycles of a pause after which a frame is given up. On the board 100 ms; a simulation takes a minute for that.
    pub time_out: u32,
}

impl Speed {
    /// Returns a board's line with the given bits per second. Its time-out fits a host on the other side of a pseudo-terminal: the pause that such a host makes is some ten thousand cycles of a simulation.
    ///
    /// # Errors
    /// A speed that the core's clock cannot make.
    pub fn of(board: &Board, baud: u32) -> Result<Self, Error> {
        let clock = 1000 * board.core_khz;
        let cycles = clock.checked_div(baud).unwrap_or(0);
        if !(MIN_CYCLES..=MAX_CYCLES).contains(&cycles) {
            return Err(Error::Speed { baud, min: clock.div_ceil(MAX_CYCLES), max: clock / MIN_CYCLES });
        }
        let time_out = TIME_OUT.max(BYTES_OF_TIME_OUT * BITS_PER_BYTE * cycles);
        Ok(Self { core_khz: board.core_khz, cycles_per_bit: cycles as u16, time_out })
    }

    /// Bits per second.
    #[must_use]
    pub fn baud(self) -> u32 {
        1000 * self.core_khz / u32::from(self.cycles_per_bit)
    }
}

/// Fewer, and the receiver does not find the middle of a bit.
const MIN_CYCLES: u32 = 8;
const MAX_CYCLES: u32 = 1 << 14;
/// Least cycles of the time-out, and least bytes in it.
const TIME_OUT: u32 = 16_000;
const BYTES_OF_TIME_OUT: u32 = 4;
/// Edges between two looks at what came.
const AT_ONCE: usize = 64;
/// Edges that pass while a pseudo-terminal is not looked at.
const BETWEEN: usize = 2_000;
/// Pictures that are remembered.
const REMEMBERED: usize = 64;

/// What stands at a core's ports besides its video and its memory.
struct Around {
    uart: Uart,
    chips: Chips,
}

impl Actor for Around {
    fn clock(&self) -> ClockId {
        self.uart.clock()
    }

    fn before(&mut self, core: &mut Model) -> Result<(), crate::Error> {
        self.uart.before(core)?;
        self.chips.before(core)
    }

    fn after(&mut self, core: &mut Model) -> Result<(), crate::Error> {
        self.uart.after(core)?;
        self.chips.after(core)
    }
}

/// A core that runs in Verilator, between a camera that sends a frame again and again, a screen, a memory, and a serial line.
pub struct VerilogBoard {
    rig: Rig<Around>,
    speed: Speed,
    shown: Vec<Vec<u16>>,
    /// Frames on the screen so far, black ones too.
    pub frames: u64,
    /// Bytes from the host, and to it.
    pub bytes: [u64; 2],
    /// Seconds that a host waited where nothing could come any more: they count, but are not simulated.
    waited: f64,
}

fn stopped(error: impl std::error::Error + Send + Sync + 'static) -> Error {
    Error::Simulation(Box::new(error))
}

impl VerilogBoard {
    /// The core of a design whose sets start with these networks; the seed decides everything random.
    ///
    /// # Errors
    /// What does not fit, or a simulator that is missing.
    pub fn new(
        design: &Design,
        sets: [&FixedNetwork; 2],
        display: &Display,
        raw: &RawFrame,
        (speed, seed): (Speed, u64),
        options: &Options,
    ) -> Result<Self, Error> {
        sets.iter().try_for_each(|network| Golden::new((*network).clone()).map(drop))?;
        let project = project(design, sets, display).map_err(stopped)?;
        Self::of_project(&project, design, raw, (speed, seed), options)
    }

    /// The same from the files of a core, which may have been edited.
    ///
    /// # Errors
    /// As [`VerilogBoard::new`].
    pub fn of_project(
        project: &Project,
        design: &Design,
        raw: &RawFrame,
        (speed, seed): (Speed, u64),
        options: &Options,
    ) -> Result<Self, Error> {
        let compiled = Compiled::new(project, options).map_err(stopped)?;
        let line = (speed.cycles_per_bit, speed.time_out);
        let begin = RigConfig::leisurely(design, seed);
        let around = |source: &Source, clock| {
            Ok(Around {
                uart: Uart::new(source, clock, line, seed, options)?,
                chips: Chips::new(source, clock, design.frame, seed, options)?,
            })
        };
        let rig = Rig::start_with(&compiled, &begin, vec![sent(raw)], around).map_err(stopped)?;
        Ok(Self { rig, speed, shown: vec![], frames: 0, bytes: [0; 2], waited: 0.0 })
    }

    /// Simulates the given number of clock edges.
    ///
    /// # Errors
    /// A rule of a port was broken, or the simulation stops.
    pub fn steps(&mut self, edges: usize) -> Result<(), Error> {
        self.rig.steps(edges).map_err(stopped)?;
        for (_, frame) in self.rig.screen.frames.drain(..) {
            self.frames += 1;
            if self.shown.last() != Some(&frame) && frame.iter().any(|pixel| *pixel != BLACK_PIXEL) {
                self.shown.push(frame);
            }
        }
        if self.shown.len() > REMEMBERED {
            self.shown.drain(..self.shown.len() - REMEMBERED);
        }
        // Nobody asks for them here, and a board runs for long.
        self.rig.memory.written.bursts.clear();
        self.rig.memory.read.bursts.clear();
        Ok(())
    }

    /// Simulates until the given number of further frames was on the screen.
    ///
    /// # Errors
    /// As [`VerilogBoard::steps`].
    pub fn show(&mut self, frames: u64) -> Result<(), Error> {
        let wanted = self.frames + frames;
        while self.frames < wanted {
            self.steps(AT_ONCE)?;
        }
        Ok(())
    }

    /// The memory of frames.
    pub const fn memory(&mut self) -> &mut Memory {
        &mut self.rig.memory
    }

    /// The video chips.
    pub const fn chips(&mut self) -> &mut Chips {
        &mut self.rig.host.chips
    }

    /// Pictures that were on the screen, each once where it came several times in a row; black ones are none.
    #[must_use]
    pub fn shown(&self) -> &[Vec<u16>] {
        &self.shown
    }

    /// Forgets the pictures that were on the screen.
    pub fn forget_shown(&mut self) {
        self.shown.clear();
    }

    /// Presses its reset.
    ///
    /// # Errors
    /// As [`VerilogBoard::steps`].
    pub fn reset(&mut self) -> Result<(), Error> {
        self.rig.reset().map_err(stopped)
    }

    /// Seconds of its time.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.rig.bench.time_ps() as f64 * 1e-12 + self.waited
    }

    fn put(&mut self, bytes: &[u8]) {
        self.bytes[0] += bytes.len() as u64;
        self.rig.host.uart.terminal.send(bytes.iter().map(|byte| (0, *byte)));
    }

    fn take(&mut self, max: usize) -> Vec<u8> {
        let came = &mut self.rig.host.uart.terminal.came;
        let bytes: Vec<u8> = came.drain(..max.min(came.len())).collect();
        self.bytes[1] += bytes.len() as u64;
        bytes
    }

    /// Whether nothing comes any more, however long one waits: the line is at rest, and a frame that was cut off is given up.
    fn rests(&self) -> bool {
        let byte = u64::from(self.speed.cycles_per_bit) * u64::from(BITS_PER_BYTE);
        self.rig.host.uart.terminal.quiet > u64::from(self.speed.time_out) + 2 * byte
    }
}

/// A host in the same program. Its waiting is simulated for as long as anything can still come, and only counted after that.
impl Line for VerilogBoard {
    fn name(&self) -> &str {
        "simulated board (Verilog)"
    }

    fn baud(&self) -> u32 {
        self.speed.baud()
    }

    fn time(&self) -> Duration {
        Duration::from_secs_f64(self.seconds())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.put(bytes);
        while !self.rig.host.uart.terminal.is_done() {
            self.steps(AT_ONCE).map_err(io::Error::other)?;
        }
        Ok(())
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        let until = self.seconds() + patience.as_secs_f64();
        while self.rig.host.uart.terminal.came.is_empty() && self.seconds() < until && !self.rests() {
            self.steps(AT_ONCE).map_err(io::Error::other)?;
        }
        if self.rig.host.uart.terminal.came.is_empty() {
            self.waited += (until - self.seconds()).max(0.0);
        }
        Ok(self.take(max))
    }
}

impl Resettable for VerilogBoard {
    fn press_reset(&mut self) -> io::Result<()> {
        self.reset().map_err(io::Error::other)
    }
}

impl Device for VerilogBoard {
    fn exchange(&mut self, came: &[u8]) -> Result<Vec<u8>, Error> {
        self.put(came);
        self.steps(BETWEEN)?;
        Ok(self.take(usize::MAX))
    }

    fn picture(&self) -> Option<Vec<u16>> {
        self.shown.last().cloned()
    }

    fn mixed(&self) -> Option<u64> {
        None
    }

    fn carried(&self) -> ([u64; 2], f64) {
        let bytes = self.bytes;
        (bytes, line_time((bytes[0] + bytes[1]) as usize, self.speed.baud()).as_secs_f64())
    }

    fn is_busy(&self) -> bool {
        true
    }
}
