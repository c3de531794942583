//! A camera on a board with pins: the OV7670, from light on its pixels to bytes at its pins.
//!
//! Sources: data sheet 1.4, which was not at hand (registers and their values after a reset, frames of VGA, 1 ms of settling after a reset, colour filters), Linux `ov7670.c` (bits;
//! the window's counts, of which (158, 10) has a blue pixel; reads with a stop in their middle). Where a source does not say
//! whether a function of the image processor acts on raw pixels, it does here.

use crate::chip_models::faults::Faults;
use crate::chip_models::registers::Page;
use crate::chip_models::wire::{Lines, Pulls, Tap, Target, Wires};

/// Columns and rows of pixels that have light.
pub const ARRAY: [usize; 2] = [656, 488];
/// Cycles of a line.
pub const LINE: usize = 784;
/// Lines of a frame.
pub const FRAME: usize = 510;
/// Lines of the vertical sync, and from its begin to line count 10.
const SYNC: usize = 3;
const LINES_BEFORE: usize = 20 - 10;
/// Column and row of the array at which the usual picture begins.
pub const USUAL: [usize; 2] = [8, 4];
/// Counts of pixel and line of the first pixel with light.
const FIRST: [usize; 2] = [158 - USUAL[0], 10 - USUAL[1]];
/// What the offset of black is while nothing calibrates it.
const DRIFT: u8 = 9;

/// Registers after a reset, of those that decide about the output.
const DEFAULTS: [(u8, u8); 29] = [
    (0x00, 0x00),
    (0x01, 0x80),
    (0x02, 0x80),
    (0x03, 0x00),
    (0x04, 0x00),
    (0x07, 0x00),
    (0x09, 0x01),
    (0x0c, 0x00),
    (0x0f, 0x43),
    (0x10, 0x40),
    (0x11, 0x80),
    (0x12, 0x00),
    (0x13, 0x8f),
    (0x15, 0x00),
    (0x17, 0x11),
    (0x18, 0x61),
    (0x19, 0x03),
    (0x1a, 0x7b),
    (0x32, 0x80),
    (0x3a, 0x0d),
    (0x3d, 0x88),
    (0x41, 0x08),
    (0x6b, 0x0a),
    (0x70, 0x3a),
    (0x71, 0x35),
    (0x76, 0x01),
    (0xb1, 0x00),
    (0x1c, 0x7f),
    (0x1d, 0xa2),
];

/// Pins in a cycle of the pixel clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dvp {
    /// Vertical sync.
    pub vs: bool,
    /// A pixel is on the bus.
    pub href: bool,
    /// The pixel.
    pub data: u8,
}

/// Light on its pixels: red, green and blue at column and row of the array.
pub type Scene = Box<dyn Fn(usize, usize) -> [u8; 3]>;

/// Registers, and when the chip was let out of reset.
#[derive(Debug)]
struct Chip {
    page: Page,
    /// Picoseconds of what the board counts as a millisecond, of now, and of the last change of the reset's pin.
    millisecond: u64,
    now: u64,
    since: u64,
    is_powered: bool,
    is_reset: bool,
    /// The reset's pin was low for a millisecond.
    was_reset: bool,
    pointer: Option<u8>,
    /// The transfer has brought its register.
    is_addressed: bool,
    complaints: Vec<String>,
}

impl Chip {
    fn is_automatic(&self) -> bool {
        self.page.bits(0x13, 2, 0) != 0
    }

    fn set(&mut self, register: u8, value: u8) {
        let automatic = self.is_automatic();
        self.page.write(register, value);
        if register == 0x12 && value & 0x80 != 0 {
            self.page.reset(|_| false);
        }
        if automatic && !self.is_automatic() {
            // What the automatic functions left behind.
            [(0x00, 0x1f), (0x07, 0x03), (0x10, 0x7f), (0x04, 0x02)]
                .into_iter()
                .for_each(|(register, value)| self.page.set(register, value));
        }
    }
}

impl Target for Chip {
    fn is_alive(&self) -> bool {
        self.is_powered && !self.is_reset
    }

    fn answers(&self, address: u8) -> bool {
        address == 0x21
    }

    fn addressed(&mut self, _: u8, is_read: bool) {
        let is_early = self.now - self.since < self.millisecond;
        let broken = [
            (!self.was_reset, "a transfer to a chip that was not reset for a millisecond"),
            (is_early, "a transfer within a millisecond of the reset's end"),
            (is_read && self.is_addressed, "a read without a stop before it"),
        ];
        for (_, rule) in broken.into_iter().filter(|(is_broken, _)| *is_broken) {
            if !self.complaints.iter().any(|complaint| complaint == rule) {
                self.complaints.push(rule.into());
            }
        }
        self.is_addressed = false;
    }

    fn write(&mut self, byte: u8) -> bool {
        match self.pointer.filter(|_| self.is_addressed) {
            Some(register) => self.set(register, byte),
            None => (self.pointer, self.is_addressed) = (Some(byte), true),
        }
        true
    }

    fn read(&mut self) -> u8 {
        self.page.get(self.pointer.unwrap_or(0))
    }

    fn stopped(&mut self) {
        self.is_addressed = false;
    }
}

/// A camera module at a board: its two wires of control, its pins, and light.
pub struct Ov7670 {
    tap: Tap<Chip>,
    scene: Scene,
    /// What is taken up with the next frame.
    pub next_scene: Option<Scene>,
    /// Line since the vertical sync and cycle of the line of the next pixel clock.
    place: [usize; 2],
    /// Frames that began.
    pub frames: usize,
}

impl Ov7670 {
    /// A module without power, with light on it, in the middle of a frame once it runs. A millisecond of its rules has so many picoseconds.
    #[must_use]
    pub fn new(scene: Scene, millisecond: u64) -> Self {
        let mut defaults = [0; 256];
        DEFAULTS.iter().for_each(|(register, value)| defaults[usize::from(*register)] = *value);
        let page = Page::documented("OV7670", defaults, &[]);
        let chip = Chip {
            page,
            millisecond,
            now: 0,
            since: 0,
            is_powered: false,
            is_reset: true,
            was_reset: false,
            pointer: None,
            is_addressed: false,
            complaints: vec![],
        };
        Self { tap: Tap::new(chip), scene, next_scene: None, place: [200, 300], frames: 0 }
    }

    /// The same, but running from this line since the vertical sync and this cycle of it on.
    #[must_use]
    pub fn starting_at(self, [line, cycle]: [usize; 2]) -> Self {
        Self { place: [line % FRAME, cycle % LINE], ..self }
    }

    /// The levels of PWDN and RESET# at a moment in picoseconds.
    pub fn set_pins(&mut self, now: u64, power_down: bool, reset_n: bool) {
        let chip = &mut self.tap.chip;
        chip.now = now;
        let was_powered = std::mem::replace(&mut chip.is_powered, !power_down);
        if chip.is_reset == reset_n {
            chip.was_reset |= chip.is_reset && was_powered && now - chip.since >= chip.millisecond;
            (chip.is_reset, chip.since) = (!reset_n, now);
        } else if chip.is_reset && !was_powered {
            chip.since = now;
        }
        if chip.is_reset {
            chip.page.reset(|_| false);
            chip.pointer = None;
        }
    }

    /// What was against the rules.
    #[must_use]
    pub fn complaints(&self) -> &[String] {
        &self.tap.chip.complaints
    }

    /// Lines of exposure.
    #[must_use]
    pub const fn exposure(&self) -> usize {
        let page = &self.tap.chip.page;
        (page.bits(0x07, 5, 0) as usize) << 10
            | (page.get(0x10) as usize) << 2
            | page.bits(0x04, 1, 0) as usize
    }

    /// Picoseconds of the pixel clock made of an input of so many; none while the chip is off.
    #[must_use]
    pub fn pixel_clock(&self, input: u64) -> Option<u64> {
        let page = &self.tap.chip.page;
        let multiplied = [1, 4, 6, 8][usize::from(page.bits(0x6b, 7, 6))];
        let divided = if page.bit(0x11, 6) { 1 } else { 1 + u64::from(page.bits(0x11, 5, 0)) };
        self.tap.chip.is_alive().then_some(input * divided / multiplied)
    }

    /// First count and the one after the last, of pixels and of lines.
    fn window(&self) -> [[usize; 2]; 2] {
        let page = &self.tap.chip.page;
        if page.bit(0x3a, 0) {
            return [[158, 14], [10, 490]];
        }
        let count =
            |upper: u8, shift: u32, lower: u8| usize::from(page.get(upper)) << shift | usize::from(lower);
        [
            [count(0x17, 3, page.bits(0x32, 2, 0)), count(0x18, 3, page.bits(0x32, 5, 3))],
            [count(0x19, 2, page.bits(0x03, 1, 0)), count(0x1a, 2, page.bits(0x03, 3, 2))],
        ]
    }

    /// The byte of the pixel at these counts.
    fn pixel(&self, [column, row]: [usize; 2]) -> u8 {
        let page = &self.tap.chip.page;
        let at = [column.wrapping_sub(FIRST[0]), row.wrapping_sub(FIRST[1])];
        if at[0] >= ARRAY[0] || at[1] >= ARRAY[1] {
            return 0;
        }
        let [red, green, blue] = (self.scene)(at[0], at[1]);
        // Blue at even counts of both, red at odd ones.
        let (mut value, gain) = match (column % 2, row % 2) {
            (0, 0) => (blue, page.get(0x01)),
            (1, 1) => (red, page.get(0x02)),
            _ => (green, 0x80),
        };
        if !page.bit(0xb1, 2) {
            value = value.saturating_add(DRIFT);
        }
        let exposed =
            u32::from(value) * self.exposure() as u32 / 256 * (16 + u32::from(page.bits(0x00, 3, 0))) / 16;
        value = (exposed << page.bits(0x00, 6, 4).count_ones()).min(255) as u8;
        if self.tap.chip.is_automatic() {
            value ^= self.frames as u8 & 3;
        }
        if page.bit(0x41, 3) {
            value = (u32::from(value) * u32::from(gain) / 0x60).min(255) as u8;
        }
        if page.bit(0x3d, 7) {
            value = (f32::from(value) / 255.0).sqrt().mul_add(255.0, 0.5) as u8;
        }
        if page.bits(0x41, 5, 4) != 0 || page.bits(0x76, 7, 6) != 0 {
            value &= !7;
        }
        if page.bit(0x70, 7) || page.bit(0x71, 7) {
            value = (at[0] / 82 * 32) as u8;
        }
        value
    }

    /// One cycle of the pixel clock.
    pub fn cycle(&mut self) -> Dvp {
        let page = &self.tap.chip.page;
        let [line, cycle] = self.place;
        let [columns, rows] = self.window();
        // The count of lines is 10 some lines after the vertical sync; a row that is wider than what is left of a line ends in the next one.
        let row = (line + FRAME - LINES_BEFORE - usize::from(cycle < columns[0])) % FRAME;
        let wide = (columns[1] + LINE - columns[0]) % LINE;
        let after = (cycle + LINE - columns[0]) % LINE;
        // Formats without mosaic have two bytes per pixel.
        let format = page.bits(0x12, 2, 0) & 0b101;
        let bytes = if format & 1 == 1 { 1 } else { 2 };
        let smaller = page.bits(0x12, 5, 3) != 0;
        let in_rows = rows[0] <= row && row < rows[1] && !(smaller && row % 2 == 1);
        let href = in_rows && after < wide * bytes;
        let column = columns[0] + after / bytes;
        let data = match (href, format) {
            (false, _) => cycle as u8 ^ 0x5a,
            (true, 0b001) => self.pixel([column, row]),
            // A processed mosaic is between its neighbours.
            (true, 0b101) => u8::midpoint(self.pixel([column, row]), self.pixel([column + 2, row])),
            (true, _) if after % 2 == 1 => 0x80,
            (true, _) => self.pixel([column, row]),
        };
        let dvp = Dvp { vs: line < SYNC, href, data };
        self.place[1] += 1;
        if self.place[1] == LINE {
            self.place = [(line + 1) % FRAME, 0];
            if self.place[0] == 0 {
                self.frames += 1;
                if let Some(scene) = self.next_scene.take() {
                    self.scene = scene;
                }
            }
        }
        dvp
    }
}

impl Wires for Ov7670 {
    fn step(&mut self, master: Pulls) -> Lines {
        let mut faults = Faults::default();
        let lines = faults.lines(master, self.tap.sda_low());
        self.tap.see(lines, &mut faults);
        lines
    }
}
