//! A camera at the pins of a core: its bus in the core's clock, its pixels in its own.

use crate::Error;
use crate::bench::{Actor, Bench, ClockId};
use crate::verilator::Model;
use edof_board::chip_models::wire::Wires;
use edof_board::chip_models::{Ov7670, Pulls};
use std::cell::RefCell;
use std::rc::Rc;

/// A camera that its bus and its pixels share.
pub type Shared = Rc<RefCell<Ov7670>>;

/// The pins that the core drives, and the bus.
pub struct Control {
    clock: ClockId,
    period: u64,
    now: u64,
    chip: Shared,
    /// Out of power-down and reset; what is pulled down, clock line first; the lines.
    on: usize,
    low: [usize; 2],
    lines: [usize; 2],
}

impl Actor for Control {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        self.now += self.period;
        let on = model.peek(self.on)?;
        let [scl_low, sda_low] = [model.peek(self.low[0])? == 1, model.peek(self.low[1])? == 1];
        let mut chip = self.chip.borrow_mut();
        chip.set_pins(self.now, on & 1 == 0, on & 2 == 2);
        let lines = chip.step(Pulls { scl_low, sda_low });
        model.poke(self.lines[0], lines.scl.into())?;
        model.poke(self.lines[1], lines.sda.into())
    }

    fn after(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }
}

/// Syncs and bytes.
pub struct Pixels {
    clock: ClockId,
    chip: Shared,
    ports: [usize; 3],
}

impl Actor for Pixels {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let dvp = self.chip.borrow_mut().cycle();
        let values = [dvp.vs.into(), dvp.href.into(), dvp.data.into()];
        self.ports.into_iter().zip(values).try_for_each(|(port, value)| model.poke(port, value))
    }
}

/// A camera at a board.
pub struct CameraModule {
    /// The chip.
    pub chip: Shared,
    pixel_clock: ClockId,
    /// Picoseconds of the board's clock to the camera.
    input: u64,
    /// Whether its pixel clock stands still whatever the chip does.
    pub is_stopped: bool,
    /// The pins that the core drives, and the bus.
    pub control: Control,
    /// Syncs and bytes.
    pub pixels: Pixels,
}

impl CameraModule {
    /// A camera at the ports `camera_…` of a core with a clock of such a period; the board's clock to the camera has `input` picoseconds.
    ///
    /// # Errors
    /// There are no such ports.
    pub fn new(bench: &mut Bench, core: (ClockId, u64), chip: Ov7670, input: u64) -> Result<Self, Error> {
        let pixel_clock = bench.clock("camera_clock_i", input)?;
        bench.run_clock(pixel_clock, false);
        let source = bench.model().library().source().clone();
        let port = |name: &str| source.port(&format!("camera_{name}"));
        let chip = Rc::new(RefCell::new(chip));
        let control = Control {
            clock: core.0,
            period: core.1,
            now: 0,
            chip: Rc::clone(&chip),
            on: port("on_o")?,
            low: [port("scl_low_o")?, port("sda_low_o")?],
            lines: [port("scl_i")?, port("sda_i")?],
        };
        let ports = [port("vs_i")?, port("href_i")?, port("data_i")?];
        let pixels = Pixels { clock: pixel_clock, chip: Rc::clone(&chip), ports };
        Ok(Self { chip, pixel_clock, input, is_stopped: false, control, pixels })
    }

    /// Lets the pixel clock run as the chip's registers have it.
    pub fn follow(&self, bench: &mut Bench) {
        let period = self.chip.borrow().pixel_clock(self.input).filter(|_| !self.is_stopped);
        bench.run_clock(self.pixel_clock, period.is_some());
        if let Some(period) = period {
            bench.set_period(self.pixel_clock, period);
        }
    }
}
