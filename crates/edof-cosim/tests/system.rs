//! The whole core, from the receiver's pins to the transmitter's: three clocks that have nothing to do with each other, a memory that is
//! late and changes the order, synchronisers that see a change an edge late by lot; every picture bit for bit that of the golden pipeline.

mod common;
mod support;

use common::{committed, networks};
use edof_cosim::bench::Behaviour;
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::system::{self, Begin, Compiled, Periods, Rig};
use edof_golden::{Curve, Display, Golden};
use edof_hdl::board::Identity;
use edof_hdl::project::{self, Tables};
use edof_spec::design::FrameSize;
use edof_spec::draw::Draw;
use edof_spec::registers::map;
use edof_spec::video::VideoTiming;
use edof_spec::{CfaPhase, Design, DisplayMode, FixedNetwork, RawFrame, Stride, Window};
use ndarray::Array2;

fn design(window: usize, stride: usize, (height, width): (usize, usize)) -> Design {
    let mut design = committed("tiny");
    design.form.window = Window::new(window).unwrap();
    design.frame = FrameSize { width, height, stride: Stride::new(stride).unwrap() };
    design.check().unwrap();
    design
}

/// A core and what is expected of it.
struct Setup {
    design: Design,
    sets: [FixedNetwork; 2],
    compiled: Compiled,
    timing: VideoTiming,
}

impl Setup {
    fn new(window: usize, stride: usize, size: (usize, usize)) -> Self {
        let design = design(window, stride, size);
        let sets = networks(&design, 7);
        let display = Display::new(DisplayMode::Colour, Curve::Srgb);
        let tables = system::tables(&display);
        let tables = Tables { luma: &tables.0, colours: tables.1.each_ref().map(Vec::as_slice) };
        let identity = Identity {
            design_hash: 1,
            weights_hash: 2,
            frame: (design.frame.width as u16, design.frame.height as u16),
        };
        let project = project::core::<64, 8>(&design, [&sets[0], &sets[1]], &tables, identity).unwrap();
        let compiled = Compiled::new(&project, &support::options()).unwrap();
        let timing = VideoTiming::of_frame(design.frame);
        Self { design, sets, compiled, timing }
    }

    /// So many raw frames: slopes with an edge and noise.
    fn frames(&self, count: usize, seed: u64) -> Vec<RawFrame> {
        let draw = &mut Draw::new(seed);
        let (height, width) = (self.design.frame.height, self.design.frame.width);
        let frame = |_| {
            let (right, down) = (draw.whole(-900, 900), draw.whole(-900, 900));
            let values = Array2::from_shape_fn((height, width), |(r, c)| {
                let edge = if c > width / 2 { 9000 } else { 0 };
                let value = 20_000 + edge + right * c as i64 + down * r as i64 + draw.whole(-400, 400);
                value.clamp(0, 65_535) as u16
            });
            RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap()
        };
        (0..count).map(frame).collect()
    }

    /// What the screen must show for them.
    fn pictures(&self, frames: &[RawFrame], set: usize, mode: DisplayMode) -> Vec<Vec<u16>> {
        let golden = Golden::new(self.sets[set].clone()).unwrap();
        let display = Display::new(mode, Curve::Srgb);
        frames.iter().map(|raw| system::picture(&golden, &display, raw).unwrap()).collect()
    }

    /// Pixel clocks at which the core keeps up: `cycles` of it a patch.
    fn begin(&self, behaviour: Behaviour, cycles: usize, seed: u64) -> Begin {
        let frame = self.design.frame;
        let geometry = edof_spec::Geometry::new(self.design.form.window, frame.stride);
        let (rows, columns) = geometry.patches(frame.height, frame.width);
        let of_core = rows * columns * cycles + 4 * frame.width * frame.height;
        let pixels = self.timing.line.total() * self.timing.frame.total();
        let input = 5_000 * of_core as u64 / pixels as u64;
        let periods = Periods { core: 5_000, input, output: input * 97 / 100 };
        Begin { timing: self.timing, periods, behaviour, seed }
    }

    fn start(&self, begin: &Begin, frames: &[RawFrame]) -> Rig {
        Rig::start(&self.compiled, begin, frames.iter().map(system::sent).collect()).unwrap()
    }
}

/// The numbers of the pictures as they were shown, one after the other, repeats left out.
fn shown(rig: &Rig, setup: &Setup, pictures: &[Vec<u16>]) -> Vec<usize> {
    let found = system::compare(&rig.screen.frames, pictures, setup.design.frame.width);
    let mut numbers: Vec<usize> =
        found.unwrap_or_else(|torn| panic!("{torn}")).into_iter().flatten().collect();
    numbers.dedup();
    numbers
}

/// Five frames or more one after the other, in both modes.
fn frames_pass(window: usize, stride: usize, size: (usize, usize)) {
    let setup = Setup::new(window, stride, size);
    for (mode, set, seed) in [(DisplayMode::Colour, 0, 1), (DisplayMode::Luma, 1, 2)] {
        let frames = setup.frames(8, seed);
        let pictures = setup.pictures(&frames, set, mode);
        let mut rig = setup
            .start(&setup.begin(Behaviour::hard(seed), if window == 8 { 260 } else { 450 }, seed), &frames);
        let control = 1 | u32::from(mode == DisplayMode::Colour) << 1 | (set as u32) << 2;
        rig.host.wanted.push_back(Access::Write(map::register("control").unwrap().address, control));
        rig.send(7).unwrap();
        rig.show(4).unwrap();
        let numbers = shown(&rig, &setup, &pictures);
        let longest = numbers.windows(2).filter(|two| two[1] == two[0] + 1).count() + 1;
        assert!(longest >= 5, "{mode}: pictures {numbers:?} of those sent");
        assert!(numbers.is_sorted(), "{numbers:?}");
    }
}

#[test]
fn window_8_stride_8() {
    frames_pass(8, 8, (24, 32));
}

#[test]
fn window_8_stride_2() {
    frames_pass(8, 2, (12, 16));
}

#[test]
fn window_12_stride_4() {
    frames_pass(12, 4, (16, 20));
}

/// Runs on and compares what is shown from the second picture after now on.
fn recovers(rig: &mut Rig, setup: &Setup, pictures: &[Vec<u16>]) {
    rig.show(3).unwrap();
    rig.screen.forget();
    rig.show(3).unwrap();
    let numbers = shown(rig, setup, pictures);
    assert!(!numbers.is_empty(), "no picture came back");
}

fn counter(rig: &mut Rig, name: &str) -> u32 {
    let address = map::register(name).unwrap().address;
    rig.host.wanted.push_back(Access::Read(address));
    let before = rig.host.answers.len();
    while rig.host.answers.len() == before {
        rig.steps(50).unwrap();
    }
    rig.host.answers[before].word
}

#[test]
fn a_pulled_cable_a_stopped_clock_another_resolution_and_a_reset_leave_no_torn_frame() {
    let setup = Setup::new(8, 8, (24, 32));
    let frames = setup.frames(30, 3);
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let draw = &mut Draw::new(4);
    let mut rig = setup.start(&setup.begin(Behaviour::hard(5), 260, 5), &frames);
    rig.send(2).unwrap();
    rig.show(2).unwrap();
    for round in 0..3 {
        // The cable.
        rig.steps(draw.whole(1, 20_000) as usize).unwrap();
        rig.camera.connected = false;
        rig.steps(draw.whole(20_000, 60_000) as usize).unwrap();
        rig.camera.connected = true;
        recovers(&mut rig, &setup, &pictures);
        // The clock: the camera's place in the frame stands still with it.
        rig.steps(draw.whole(1, 20_000) as usize).unwrap();
        rig.bench.run_clock(rig.input, false);
        rig.steps(draw.whole(2_000, 60_000) as usize).unwrap();
        rig.bench.run_clock(rig.input, true);
        recovers(&mut rig, &setup, &pictures);
        // A reset.
        rig.steps(draw.whole(1, 20_000) as usize).unwrap();
        rig.reset().unwrap();
        recovers(&mut rig, &setup, &pictures);
        assert_eq!(counter(&mut rig, "input_write_errors"), 0, "round {round}");
    }
    // Another resolution: the picture stands still, and it is told.
    let before = counter(&mut rig, "input_broken");
    let wrong = FrameSize { width: 30, height: 24, stride: Stride::PATCH };
    rig.camera.change(VideoTiming::of_frame(wrong), vec![vec![0; 30 * 24]]);
    rig.show(6).unwrap();
    assert!(counter(&mut rig, "input_broken") > before);
    assert_eq!(counter(&mut rig, "status") & 0b110, 0b010, "present, and of another size");
    assert_eq!(counter(&mut rig, "input_size") & 0xffff, 30);
    rig.camera.change(setup.timing, frames.iter().map(system::sent).collect());
    recovers(&mut rig, &setup, &pictures);
    assert_eq!(counter(&mut rig, "status") & 0b110, 0b110);
}

#[test]
fn errors_of_the_memory_are_counted_and_never_seen_in_a_written_frame() {
    let setup = Setup::new(8, 8, (24, 32));
    let frames = setup.frames(12, 6);
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let mut rig = setup.start(&setup.begin(Behaviour::hard(7), 260, 7), &frames);
    rig.send(2).unwrap();
    rig.memory.behaviour.errors = 20;
    rig.send(6).unwrap();
    rig.memory.behaviour.errors = 0;
    recovers(&mut rig, &setup, &pictures);
    let told = ["input_write_errors", "picture_write_errors"]
        .map(|name| counter(&mut rig, name))
        .iter()
        .sum::<u32>();
    assert_eq!(told as usize, rig.memory.written.errors);
    assert!(told > 0);
}
