//! The whole board but for its pins: frames from an HDMI bus through DRAM, calculator and DRAM to another HDMI bus, three clocks that drift,
//! synchronisers that see changes by lot, a memory that is as hard to please as AXI allows. Every picture that is shown is, bit for bit, what
//! `edof reconstruct --board` writes for one of the frames.

mod common;
mod support;

use common::{committed, networks};
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::bench::{Actor, Behaviour, Bench, ClockId, Host, Memory, Pace};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_golden::{Curve, Display, Golden};
use edof_hdl::board::{EdofCore, Identity};
use edof_hdl::project;
use edof_hdl::video::display::TABLE_IMAGES;
use edof_spec::design::FrameSize;
use edof_spec::draw::Draw;
use edof_spec::registers::map::register;
use edof_spec::video::VideoTiming;
use edof_spec::{CfaPhase, Design, DisplayMode, FixedNetwork, RawFrame, Stride, Window};
use ndarray::Array2;
use std::collections::VecDeque;

const SIZE: (usize, usize) = (48, 64);

fn design(window: usize, stride: usize) -> Design {
    let mut design = committed("tiny");
    design.form.window = Window::new(window).unwrap();
    design.frame = FrameSize { width: SIZE.1, height: SIZE.0, stride: Stride::new(stride).unwrap() };
    design.check().unwrap();
    design
}

/// A slope with noise and an edge.
fn raw(draw: &mut Draw, (height, width): (usize, usize)) -> RawFrame {
    let (right, down) = (draw.whole(-200, 200), draw.whole(-200, 200));
    let values = Array2::from_shape_fn((height, width), |(r, c)| {
        let edge = if c > width / 2 { 9000 } else { 0 };
        (20_000 + edge + right * c as i64 + down * r as i64 + draw.whole(-400, 400)).clamp(0, 65_535) as u16
    });
    RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap()
}

/// What lies on a video bus in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Pins {
    hs: bool,
    vs: bool,
    de: bool,
    data: u16,
}

/// A frame as a receiver gives it: the most significant byte on Y, the least on C.
fn sent(raw: &RawFrame) -> Vec<Pins> {
    let (height, width) = raw.size();
    let timing = VideoTiming::of_frame(FrameSize { width, height, stride: Stride::PATCH });
    let (line, frame) = (timing.line, timing.frame);
    let pixels: Vec<u16> = raw.pixels().iter().copied().collect();
    let pin = |row: usize, column: usize| {
        let de = row < frame.active && column < line.active;
        let data = if de { pixels[row * width + column].swap_bytes() } else { 0x5a5a };
        let vertical = if column < line.active + line.front { row.wrapping_sub(1) } else { row };
        Pins { hs: line.in_sync(column), vs: frame.in_sync(vertical), de, data }
    };
    (0..frame.total())
        .flat_map(|row| (0..line.total()).map(move |column| (row, column)))
        .map(|(r, c)| pin(r, c))
        .collect()
}

/// A camera on the incoming bus: what is queued, then nothing.
struct Camera {
    clock: ClockId,
    ports: [usize; 4],
    pins: VecDeque<Pins>,
}

impl Actor for Camera {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let pins = self.pins.pop_front().unwrap_or_default();
        let values = [pins.hs.into(), pins.vs.into(), pins.de.into(), u64::from(pins.data)];
        self.ports.iter().zip(values).try_for_each(|(port, value)| model.poke(*port, value))
    }
}

/// A screen on the outgoing bus.
struct Screen {
    clock: ClockId,
    ports: [usize; 3],
    vs: bool,
    frame: Vec<u16>,
    frames: Vec<Vec<u16>>,
}

impl Actor for Screen {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let vs = model.peek(self.ports[0])? == 1;
        if vs && !self.vs && !self.frame.is_empty() {
            self.frames.push(std::mem::take(&mut self.frame));
        }
        self.vs = vs;
        if model.peek(self.ports[1])? == 1 {
            self.frame.push(model.peek(self.ports[2])? as u16);
        }
        Ok(())
    }

    fn after(&mut self, _: &mut Model) -> Result<(), Error> {
        Ok(())
    }
}

/// The core, its networks, its start.
struct Setup {
    sets: [FixedNetwork; 2],
    display: Display,
    library: Library,
    images: tempfile::TempDir,
}

impl Setup {
    fn new(design: Design) -> Self {
        let sets = networks(&design, 7);
        let display = Display::new(DisplayMode::Colour, Curve::Srgb);
        let luma: Vec<u64> = display.luma.entries().iter().map(|code| u64::from(*code)).collect();
        let colours = display
            .colours
            .each_ref()
            .map(|table| table.entries().iter().map(|entry| u64::from(*entry)).collect::<Vec<_>>());
        let mut files = project::images(&design, [&sets[0], &sets[1]]);
        let text = |words: &[u64]| words.iter().map(|word| format!("{word:x}\n")).collect::<String>();
        let contents = [&luma, &colours[0], &colours[1], &colours[2]].map(|words| text(words));
        files.extend(TABLE_IMAGES.map(String::from).into_iter().zip(contents));
        let images = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = images.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let identity = Identity { design_hash: 1, weights_hash: 2, frame: (SIZE.1 as u16, SIZE.0 as u16) };
        let colours = colours.each_ref().map(Vec::as_slice);
        let mut core = EdofCore::new(&design, [&sets[0], &sets[1]], &identity, &luma, colours).unwrap();
        let source = Source::circuit(&mut core).unwrap().metastable();
        let library = Library::build(&source, &support::options()).unwrap();
        Self { sets, display, library, images }
    }

    /// What leaves the board for a frame.
    fn expected(&self, raw: &RawFrame, set: usize, mode: DisplayMode) -> Vec<u16> {
        let display = Display { mode, ..self.display.clone() };
        let golden = Golden::new(self.sets[set].clone()).unwrap();
        let bytes = golden.frame(raw).unwrap().picture(&display).0.yuyv();
        bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect()
    }
}

/// The core with everything around it.
struct Rig {
    bench: Bench,
    input: ClockId,
    camera: Camera,
    screen: Screen,
    memory: Memory,
    host: Host,
}

impl Rig {
    /// The periods of the bus and the screen leave the calculator time for every frame.
    fn new(setup: &Setup, behaviour: Behaviour, seed: u64) -> Self {
        let source = setup.library.source();
        let start = Start { seed, memory_dir: Some(setup.images.path().into()) };
        let mut bench = Bench::new(setup.library.start(&start).unwrap(), seed);
        let clock = bench.clock("clock_i", 5_000).unwrap();
        let input = bench.clock("input_clock_i", 80_808).unwrap();
        let output = bench.clock("screen_clock_i", 80_808).unwrap();
        let port = |name: &str| source.port(name).unwrap();
        let ports = ["input_hs_i", "input_vs_i", "input_de_i", "input_data_i"].map(port);
        let camera = Camera { clock: input, ports, pins: VecDeque::new() };
        let ports = ["screen_vs_o", "screen_de_o", "screen_data_o"].map(port);
        let screen = Screen { clock: output, ports, vs: false, frame: vec![], frames: vec![] };
        let bundles = (Some("dram_write"), Some("dram_read"));
        let memory = Memory::new(source, bundles, clock, "reset_i", behaviour, seed).unwrap();
        let host = Host::new(source, "host", clock, "reset_i", Pace::drawn(seed)).unwrap();
        let mut rig = Self { bench, input, camera, screen, memory, host };
        for port in ["dram_ready_i", "i2c_done_i"] {
            rig.bench.set(port, 1).unwrap();
        }
        rig.reset();
        // What was on the bus before the first reset was no picture.
        (rig.screen.frame, rig.screen.frames) = (vec![], vec![]);
        rig
    }

    fn reset(&mut self) {
        for level in [1, 0] {
            self.bench.set("reset_i", level).unwrap();
            self.steps(400);
        }
    }

    fn steps(&mut self, count: usize) {
        let actors: &mut [&mut dyn Actor] =
            &mut [&mut self.camera, &mut self.screen, &mut self.memory, &mut self.host];
        self.bench.steps(count, actors).unwrap();
    }

    /// Until the camera has sent everything, and some frames more.
    fn finish(&mut self) {
        while !self.camera.pins.is_empty() {
            self.steps(2_000);
        }
        self.steps(350_000);
    }

    fn access(&mut self, access: Access) -> u32 {
        let before = self.host.answers.len();
        self.host.wanted.push_back(access);
        while self.host.answers.len() == before {
            self.steps(10);
        }
        assert!(self.host.answers[before].is_good, "{access:?}");
        self.host.answers[before].word
    }

    fn read(&mut self, name: &str) -> u32 {
        self.access(Access::Read(register(name).unwrap().address))
    }

    /// Which of the expected pictures the screen showed, black ones left out; every picture is one of them.
    fn shown(&self, expected: &[Vec<u16>]) -> Vec<usize> {
        let black = [0x8010u16];
        let pictures = self.screen.frames.iter().filter(|frame| frame.iter().any(|word| *word != black[0]));
        let which = |frame: &Vec<u16>| {
            let found = expected.iter().position(|picture| picture == frame);
            found.unwrap_or_else(|| {
                panic!("a picture of {} pixels is none of those that were sent", frame.len())
            })
        };
        pictures.map(which).collect()
    }
}

/// Frames one after the other, in both modes and with both sets of weights: all are shown, in order, bit for bit.
fn frames_are_shown(window: usize, stride: usize) {
    let setup = Setup::new(design(window, stride));
    for (mode, set, seed) in [(DisplayMode::Colour, 0, 1), (DisplayMode::Luma, 1, 2)] {
        let draw = &mut Draw::new(seed);
        let mut rig = Rig::new(&setup, Behaviour::hard(seed), seed);
        let control = 1 | u32::from(mode == DisplayMode::Colour) << 1 | (set as u32) << 2;
        rig.access(Access::Write(register("control").unwrap().address, control));
        let frames: Vec<RawFrame> = (0..7).map(|_| raw(draw, SIZE)).collect();
        frames.iter().for_each(|frame| rig.camera.pins.extend(sent(frame)));
        rig.finish();
        let expected: Vec<Vec<u16>> = frames.iter().map(|frame| setup.expected(frame, set, mode)).collect();
        let mut shown = rig.shown(&expected);
        assert!(shown.is_sorted(), "{shown:?}");
        shown.dedup();
        // The first edge of a sync begins the first frame that counts.
        assert!(shown.len() >= 5 && shown.windows(2).all(|pair| pair[1] == pair[0] + 1), "{shown:?}");
        assert_eq!(shown.last(), Some(&6), "{shown:?}");
        for name in [
            "input_broken",
            "input_wrong",
            "input_overruns",
            "input_write_errors",
            "raw_read_errors",
            "output_underruns",
        ] {
            assert_eq!(rig.read(name), 0, "{name}");
        }
        assert_eq!(rig.read("input_size"), SIZE.1 as u32 | (SIZE.0 as u32) << 16);
        // The cable has been quiet for a while; the memory is ready, and pictures leave.
        assert_eq!(rig.read("status") & 0b1111, 0b1001);
        assert_eq!(rig.read("picture_frames"), rig.read("raw_frames"));
    }
}

#[test]
fn window_8_stride_8() {
    frames_are_shown(8, 8);
}

#[test]
fn window_12_stride_4() {
    frames_are_shown(12, 4);
}

#[test]
fn whatever_happens_no_picture_is_torn_and_the_right_counter_counts() {
    let setup = Setup::new(design(8, 8));
    let draw = &mut Draw::new(9);
    let frames: Vec<RawFrame> = (0..12).map(|_| raw(draw, SIZE)).collect();
    let expected: Vec<Vec<u16>> =
        frames.iter().map(|frame| setup.expected(frame, 0, DisplayMode::Colour)).collect();
    let mut rig = Rig::new(&setup, Behaviour::hard(9), 9);
    let send = |rig: &mut Rig, numbers: std::ops::Range<usize>| {
        numbers.for_each(|number| rig.camera.pins.extend(sent(&frames[number])));
    };
    send(&mut rig, 0..3);
    rig.finish();

    // The cable is pulled in the middle of a frame: its clock stops.
    send(&mut rig, 3..4);
    rig.steps(30_000);
    rig.bench.run_clock(rig.input, false);
    rig.camera.pins.clear();
    rig.steps(20_000);
    rig.bench.run_clock(rig.input, true);
    send(&mut rig, 4..6);
    rig.finish();
    assert_eq!(rig.shown(&expected).last(), Some(&5));

    // Frames of another size.
    let small = raw(draw, (40, 64));
    (0..2).for_each(|_| rig.camera.pins.extend(sent(&small)));
    send(&mut rig, 6..8);
    rig.finish();
    assert_eq!(rig.shown(&expected).last(), Some(&7));
    assert!(rig.read("input_wrong") > 0 && rig.read("input_broken") > 0);

    // Errors of the memory.
    rig.memory.behaviour.errors = 100;
    send(&mut rig, 8..9);
    rig.finish();
    rig.memory.behaviour.errors = 0;
    let told = ["input_write_errors", "raw_read_errors", "picture_write_errors", "output_read_errors"];
    assert!(told.iter().map(|name| rig.read(name)).sum::<u32>() > 0);
    // A word that was read with an error is the right one in this memory: pictures stay whole.
    send(&mut rig, 9..11);
    rig.finish();
    assert_eq!(rig.shown(&expected).last(), Some(&10));

    // A reset.
    send(&mut rig, 11..12);
    rig.steps(draw.whole(1, 20_000) as usize);
    rig.reset();
    rig.screen.frame.clear();
    send(&mut rig, 10..12);
    rig.finish();
    let shown = rig.shown(&expected);
    assert_eq!(shown.last(), Some(&11), "{shown:?}");
}
