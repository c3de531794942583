//! A board in Rust: the same registers, memories and answers as the circuit's, byte by byte, and pictures of the golden pipeline. Not its
//! cycles: a picture takes as long as the calculator of the design does on average, at the design's clock.
//!
//! | what | module |
//! |---|---|
//! | what lies behind it, and the picture in progress | `inside` |
//! | its end of the line | [`uart`] |
//! | what the stages hold | [`memory`] |
//! | set-up of the video chips | [`setup`] |
//! | the chips themselves, and the ends of their cables | [`chips`] |
//! | a raw frame that the host writes | [`host_frame`] |
//! | frames, tables, pictures | [`video`] |
//! | faults that a test gives it | [`faults`] |
//!
//! Time is simulated: it advances with every byte on the line, and on request.

pub mod chips;
pub mod faults;
pub mod host_frame;
mod inside;
pub mod memory;
pub mod setup;
pub mod uart;
pub mod video;

pub use inside::Shown;

use crate::error::Error;
use crate::faulty::Resettable;
use crate::line::{BITS_PER_BYTE, Line};
use chips::Chips;
use edof_core::RawFrame;
use edof_device::Design;
use edof_device::board::UART_TIME_OUT_MS;
use edof_device::pattern::TILE_PIXELS;
use edof_device::registers::identity::weights_hash;
use edof_device::video::VideoTiming;
use edof_golden::{Display, Golden};
use edof_network::FixedNetwork;
use faults::Faults;
use host_frame::HostFrame;
use inside::{Checks, Inside, Load, Source, Time};
use memory::Stage;
use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::time::Duration;
use uart::Uart;
use video::Tables;

/// A simulated board.
pub struct Simulated {
    inside: Inside,
    uart: Uart,
    baud: u32,
    now: Time,
    last_byte: Time,
    /// Bytes on their way to the host, and when each has arrived.
    leaving: VecDeque<(Time, u8)>,
    /// Until then bytes of the host are not heard.
    deaf_until: Time,
    frame_time: Time,
    next_frame: Time,
    /// Bytes from the host, and to it.
    pub bytes: [u64; 2],
}

impl Simulated {
    /// The board of a design whose sets start with these networks, with a camera that sends a raw frame again and again.
    ///
    /// # Errors
    /// Networks or a frame that do not fit.
    pub fn new(
        design: &Design,
        sets: [&FixedNetwork; 2],
        display: &Display,
        raw: RawFrame,
        baud: u32,
    ) -> Result<Self, Error> {
        design.check()?;
        for network in sets {
            design.check_network(network)?;
            Golden::new(network.clone())?;
        }
        let frame_time = (1e9 / VideoTiming::of_frame(design.frame).frames_per_second()) as Time;
        let stages: Vec<Stage> = design.stages().map(|plan| Stage::new(design, plan, sets)).collect();
        let mut inside = Inside {
            design: design.clone(),
            like: sets[0].clone(),
            start_hash: weights_hash(design, sets[0]),
            reads_until: vec![0; stages.len() + 1],
            table_read: (0, 0),
            refused: 0,
            stage_counts: [vec![[0; 4]; stages.len()], vec![[0; 4]; stages.len()]],
            stages,
            tables: Tables::of(display),
            controls: BTreeMap::new(),
            counts: BTreeMap::new(),
            now: 0,
            chips: Chips::new(design.frame),
            raw,
            versions: [0; 3],
            cached: None,
            begun: None,
            load: Load::new(design, None),
            frame_waits: false,
            picture_waits: false,
            last_set: 0,
            weights_unchecked: false,
            uart_broken: 0,
            shown: vec![],
            mixed: 0,
            checks: Checks::default(),
            tile: vec![0; TILE_PIXELS],
            tile_version: 0,
            host: HostFrame::new(design.frame),
            host_frame: vec![],
            kept: Source::Camera,
            faults: Faults::default(),
        };
        inside.power_on();
        Ok(Self {
            inside,
            uart: Uart::default(),
            baud,
            now: 0,
            last_byte: 0,
            leaving: VecDeque::new(),
            deaf_until: 0,
            frame_time,
            next_frame: frame_time,
            bytes: [0; 2],
        })
    }

    /// Nanoseconds of its time.
    #[must_use]
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// The calculator's clock is lost and comes back: the frame in progress is dropped, and its memories are in doubt.
    pub fn lose_calculator_clock(&mut self) {
        self.inside.begun = None;
        self.inside.weights_unchecked = true;
    }

    fn byte_time(&self) -> Time {
        1_000_000_000 * u64::from(BITS_PER_BYTE) / u64::from(self.baud.max(1))
    }

    /// Lets time pass up to a moment, if that is still to come.
    pub fn pass_to(&mut self, moment: u64) {
        loop {
            // A picture is done before the camera's next frame begins.
            let done = self.inside.done_at().filter(|done| *done <= self.next_frame);
            let next = done.unwrap_or(self.next_frame);
            if next > moment {
                break;
            }
            self.now = self.now.max(next);
            self.inside.now = self.now;
            if done.is_some() {
                self.inside.end();
            } else {
                self.inside.frame();
                self.next_frame += self.frame_time;
            }
        }
        self.now = self.now.max(moment);
        self.inside.now = self.now;
        let time_out = u64::from(UART_TIME_OUT_MS) * 1_000_000;
        if self.uart.waits() && self.now.saturating_sub(self.last_byte) >= time_out {
            self.uart.time_out();
        }
    }

    /// A byte of the host arrives.
    pub fn byte(&mut self, byte: u8) {
        self.pass_to(self.now + self.byte_time());
        self.bytes[0] += 1;
        self.last_byte = self.now;
        if self.now < self.deaf_until {
            return;
        }
        self.inside.uart_broken = self.uart.broken;
        let answer = self.uart.byte(byte, &mut self.inside);
        let mut at = self.now;
        for byte in answer {
            // While the last byte leaves the next frame may begin.
            self.deaf_until = at;
            at += self.byte_time();
            self.leaving.push_back((at, byte));
        }
    }

    /// Bytes that have arrived at the host, `max` at most.
    pub fn take(&mut self, max: usize) -> Vec<u8> {
        let mut taken = vec![];
        while taken.len() < max && self.leaving.front().is_some_and(|(at, _)| *at <= self.now) {
            taken.extend(self.leaving.pop_front().map(|(_, byte)| byte));
        }
        self.bytes[1] += taken.len() as u64;
        taken
    }

    /// Lets time pass until all answers have arrived at the host, and gives them.
    pub fn take_all(&mut self) -> Vec<u8> {
        if let Some((at, _)) = self.leaving.back() {
            self.pass_to(*at);
        }
        self.take(usize::MAX)
    }

    /// What its reset does.
    pub fn reset(&mut self) {
        self.uart = Uart::default();
        self.leaving.clear();
        self.deaf_until = 0;
        self.inside.reset();
    }

    /// The video chips, and who is at the other ends of their cables.
    pub const fn chips(&mut self) -> &mut Chips {
        &mut self.inside.chips
    }

    /// Pictures that came out, each once where it came several times in a row.
    #[must_use]
    pub fn shown(&self) -> &[Shown] {
        &self.inside.shown
    }

    /// Pictures that came out and were of words of two networks, or of none that could run.
    #[must_use]
    pub const fn mixed(&self) -> u64 {
        self.inside.mixed
    }

    /// Forgets the pictures that came out.
    pub fn forget_shown(&mut self) {
        self.inside.shown.clear();
    }

    /// The network that a set holds, if its words make one.
    #[must_use]
    pub fn network(&self, set: usize) -> Option<FixedNetwork> {
        self.inside.network(set)
    }
}

/// A host in the same program; time passes while it waits.
impl Line for Simulated {
    fn name(&self) -> &str {
        "simulated board"
    }

    fn baud(&self) -> u32 {
        self.baud
    }

    fn time(&self) -> Duration {
        Duration::from_nanos(self.now)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        bytes.iter().for_each(|byte| self.byte(*byte));
        Ok(())
    }

    fn receive(&mut self, max: usize, patience: Duration) -> io::Result<Vec<u8>> {
        let until = self.now + patience.as_nanos() as Time;
        let first = self.leaving.front().map_or(until, |(at, _)| (*at).min(until));
        self.pass_to(first);
        Ok(self.take(max))
    }
}

impl Resettable for Simulated {
    fn press_reset(&mut self) -> io::Result<()> {
        self.reset();
        Ok(())
    }
}
