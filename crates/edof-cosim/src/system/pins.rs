//! Who stands at the pins of a core: a camera that sends frames, and a screen that shows them.

use crate::bench::{Actor, ClockId};
use crate::verilator::Model;
use crate::{Error, Source};
use edof_core::cable;
use edof_core::draw::Draw;
use edof_device::video::VideoTiming;

/// The ports of a bus: horizontal sync, vertical sync, data enable, data.
fn ports(source: &Source, bus: &str) -> Result<[usize; 4], Error> {
    let port = |signal| source.signal(bus, signal);
    Ok([port("hs")?, port("vs")?, port("de")?, port("data")?])
}

/// Sends frames of raw pixel words (luma low, chroma high) one after the other by the timing of a screen, each once, the last again and again.
pub struct Camera {
    clock: ClockId,
    ports: [usize; 4],
    timing: VideoTiming,
    frames: Vec<Vec<u16>>,
    /// Row and column of the pixel that is sent next, porches and syncs included.
    place: (usize, usize),
    draw: Draw,
    /// The frame that is being sent.
    pub frame: usize,
    /// Lines that were sent, of all frames.
    pub lines: usize,
    /// Whether the cable is in; without it nothing comes.
    pub connected: bool,
}

impl Camera {
    /// At the bus of that name.
    ///
    /// # Errors
    /// There is none.
    pub fn new(
        source: &Source,
        bus: &str,
        clock: ClockId,
        timing: VideoTiming,
        frames: Vec<Vec<u16>>,
    ) -> Result<Self, Error> {
        let ports = ports(source, bus)?;
        Ok(Self {
            clock,
            ports,
            timing,
            frames,
            place: (0, 0),
            draw: Draw::new(1),
            frame: 0,
            lines: 0,
            connected: true,
        })
    }

    /// Sends frames of another timing from now on, from their begin.
    pub fn change(&mut self, timing: VideoTiming, frames: Vec<Vec<u16>>) {
        (self.timing, self.frames, self.place, self.frame) = (timing, frames, (0, 0), 0);
    }

    fn advance(&mut self) {
        let (line, frame) = (self.timing.line, self.timing.frame);
        self.place.1 += 1;
        if self.place.1 == line.total() {
            self.place = (self.place.0 + 1, 0);
            self.lines += 1;
        }
        if self.place.0 == frame.total() {
            self.place.0 = 0;
            self.frame = (self.frame + 1).min(self.frames.len() - 1);
        }
    }
}

impl Actor for Camera {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let ((row, column), line, frame) = (self.place, self.timing.line, self.timing.frame);
        let seen = row < frame.active && column < line.active;
        // A vertical sync begins with a horizontal one.
        let vertical = if column < line.active + line.front { row.wrapping_sub(1) } else { row };
        let data = match self.frames.get(self.frame) {
            Some(pixels) if seen => u16::from_le_bytes(cable::codes(pixels[row * line.active + column])),
            _ => self.draw.bits() as u16,
        };
        let pins = [line.in_sync(column).into(), frame.in_sync(vertical).into(), seen.into()];
        let pins = if self.connected { pins } else { [0; 3] };
        for (port, value) in self.ports.iter().zip(pins) {
            model.poke(*port, value)?;
        }
        model.poke(self.ports[3], data.into())?;
        self.advance();
        Ok(())
    }
}

/// Collects the frames that are on a bus, and rejects what no screen would show: lines and frames of another size.
pub struct Screen {
    clock: ClockId,
    ports: [usize; 4],
    reset: usize,
    size: (usize, usize),
    open: Vec<u16>,
    line: usize,
    vs: bool,
    /// A vertical sync was seen, so that what follows is a whole frame.
    follows: bool,
    /// Edges that were seen.
    cycle: u64,
    /// Whole frames, and when each was.
    pub frames: Vec<(u64, Vec<u16>)>,
}

impl Screen {
    /// A collector at the bus of that name, for frames of the given rows and columns; while the port `reset` is high it sees nothing.
    ///
    /// # Errors
    /// There is none.
    pub fn new(
        source: &Source,
        bus: &str,
        clock: ClockId,
        reset: &str,
        size: (usize, usize),
    ) -> Result<Self, Error> {
        let (ports, reset) = (ports(source, bus)?, source.port(reset)?);
        let (open, frames) = (vec![], vec![]);
        Ok(Self { clock, ports, reset, size, open, line: 0, vs: false, follows: false, cycle: 0, frames })
    }

    /// Drops all frames so far, and the frame in progress. A vertical sync that is high at the end of a reset is none: the screen's clock may not have seen the
    /// reset yet.
    pub fn forget(&mut self) {
        (self.open, self.line, self.vs, self.follows) = (vec![], 0, true, false);
        self.frames.clear();
    }

    fn broken(&self, rule: String) -> Error {
        Error::Rule { port: "screen".into(), edge: self.cycle, rule }
    }
}

impl Actor for Screen {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        self.cycle += 1;
        if model.peek(self.reset)? == 1 {
            self.forget();
            return Ok(());
        }
        let vs = model.peek(self.ports[1])? == 1;
        let (height, width) = self.size;
        if model.peek(self.ports[2])? == 1 {
            self.open.push(model.peek(self.ports[3])? as u16);
            self.line += 1;
        } else if self.line > 0 {
            if self.follows && self.line != width {
                return Err(self.broken(format!("a line of {} pixels, not {width}", self.line)));
            }
            self.line = 0;
        }
        if vs && !self.vs {
            let frame = std::mem::take(&mut self.open);
            if self.follows && frame.len() != height * width {
                return Err(self.broken(format!("a frame of {} pixels, not {height}×{width}", frame.len())));
            }
            if self.follows {
                self.frames.push((self.cycle, frame));
            }
            self.follows = true;
        }
        self.vs = vs;
        Ok(())
    }

    fn after(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }
}
