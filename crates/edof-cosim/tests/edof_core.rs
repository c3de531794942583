//! The whole board without its pins: frames from an HDMI bus through DRAM, calculator and DRAM to another HDMI bus, four clocks that drift,
//! synchronisers that see changes late at random, a memory that is as hard to please as AXI allows. Every picture that is shown is, bit for bit, what
//! `edof reconstruct --board` writes for one of the frames.

use crate::common::{committed, networks};
use crate::support;
use edof_core::draw::Draw;
use edof_core::number::InputWord;
use edof_core::{DisplayMode, Geometry, RawFrame, Stride, Window};
use edof_cosim::bench::Behaviour;
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::chain::device::status_address;
use edof_cosim::system::{self, Compiled, Rig, RigConfig, compare, drawn, longest_run};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_device::design::memory::{self, Set, Shifts, Space, TABLES};
use edof_device::design::reading::{
    CHECK_FRAME_REGISTER, READ_BACK, READ_REGISTER, ReadBack, TABLE_ROWS, crc, read_back_address,
    read_command, table_bank, table_rows,
};
use edof_device::registers::map::{self, DISPLAY_TABLES, STAGE_COUNTERS, STAGE_READS, WEIGHTS};
use edof_device::video::VideoTiming;
use edof_golden::cycle::{Cycle, Patch, Summary};
use edof_golden::video::figures::{CoreCycles, Periods, figures};
use edof_golden::video::video_out::BLACK_PIXEL;
use edof_golden::{Curve, Display, Golden, windows};
use edof_hdl::project::Project;
use edof_network::FixedNetwork;

pub fn design(window: usize, stride: usize, (width, height): (usize, usize)) -> Design {
    let mut design = committed("tiny");
    design.form.window = Window::new(window).unwrap();
    design.frame = FrameSize { width, height, stride: Stride::new(stride).unwrap() };
    design.check().unwrap();
    design
}

/// A core, and what is expected of it.
pub struct Setup {
    pub design: Design,
    pub sets: [FixedNetwork; 2],
    compiled: Compiled,
}

impl Setup {
    pub fn new(design: Design) -> Self {
        Self::changed(design, |project| project)
    }

    /// With another text.
    pub fn changed(design: Design, change: impl FnOnce(Project) -> Project) -> Self {
        let sets = networks(&design, 7);
        let display = Display::new(DisplayMode::Colour, Curve::Srgb);
        let project = change(system::project(&design, [&sets[0], &sets[1]], &display).unwrap());
        let compiled = Compiled::new(&project, &support::options()).unwrap();
        Self { design, sets, compiled }
    }

    /// What the screen must show.
    pub fn pictures(&self, frames: &[RawFrame], set: usize, mode: DisplayMode) -> Vec<Vec<u16>> {
        let golden = Golden::new(self.sets[set].clone()).unwrap();
        let display = Display::new(mode, Curve::Srgb);
        frames.iter().map(|raw| system::picture(&golden, &display, raw).unwrap()).collect()
    }

    /// Whether the pictures of [`are_shown`] differ from one another. A network of extreme weights may make the same of two frames.
    fn tells_frames_apart(&self) -> bool {
        SHOWN.iter().all(|(mode, set, seed)| {
            let pictures = self.pictures(&drawn(self.design.frame, 7, *seed).unwrap(), *set, *mode);
            (0..pictures.len()).all(|i| !pictures[..i].contains(&pictures[i]))
        })
    }

    fn begin(&self, seed: u64) -> RigConfig {
        RigConfig::leisurely(&self.design, seed)
    }

    pub fn start(&self, frames: &[RawFrame], seed: u64) -> Rig {
        self.start_with(frames.iter().map(system::sent).collect(), seed)
    }

    /// With the words of each frame that the camera sends.
    pub fn start_with(&self, sent: Vec<Vec<u16>>, seed: u64) -> Rig {
        Rig::start(&self.compiled, &self.begin(seed), sent).unwrap()
    }

    /// The numbers of the pictures on the screen, none for a black one; every one of them whole.
    pub fn shown(&self, rig: &Rig, pictures: &[Vec<u16>]) -> Vec<Option<usize>> {
        compare(&rig.screen.frames, pictures, self.design.frame.width).unwrap_or_else(|torn| panic!("{torn}"))
    }
}

const ERRORS: [&str; 7] = [
    "input_broken",
    "input_wrong",
    "input_range",
    "input_overruns",
    "input_write_errors",
    "raw_read_errors",
    "output_underruns",
];

/// Frames one after the other, in both modes and with both sets of weights: five or more are shown in order, bit for bit, and no FIFO gets
/// fuller than the model says.
fn frames_are_shown(window: usize, stride: usize, size: (usize, usize)) {
    let setup = Setup::new(design(window, stride, size));
    assert!(setup.tells_frames_apart());
    are_shown(&setup);
}

const SHOWN: [(DisplayMode, usize, u64); 2] = [(DisplayMode::Colour, 0, 1), (DisplayMode::Luma, 1, 2)];

fn are_shown(setup: &Setup) {
    for (mode, set, seed) in SHOWN {
        let frames = drawn(setup.design.frame, 7, seed).unwrap();
        let mut rig = setup.start(&frames, seed);
        rig.control(mode, set).unwrap();
        rig.send(6).unwrap();
        rig.show(4).unwrap();
        let shown = setup.shown(&rig, &setup.pictures(&frames, set, mode));
        assert!(longest_run(&shown) >= 5, "{mode}: {shown:?}");
        assert_eq!(shown.last(), Some(&Some(6)), "{mode}: {shown:?}");
        for name in ERRORS {
            assert_eq!(rig.register(name).unwrap(), 0, "{name}");
        }
        let FrameSize { width, height, .. } = setup.design.frame;
        assert_eq!(rig.register("input_size").unwrap(), width as u32 | (height as u32) << 16);
        for fifo in rig.fifos(&setup.begin(seed)).unwrap() {
            assert!(fifo.max > 0 && fifo.max <= fifo.limit && fifo.limit <= fifo.depth, "{fifo:?}");
        }
        // The memory is ready, the signal is there and fits, and pictures leave.
        assert_eq!(rig.register("status").unwrap() & 0b1111, 0b1111);
    }
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn frames_of_random_sizes_are_shown() {
    let draw = &mut Draw::new(2026);
    let mut found = 0;
    while found < 8 {
        let mut of = |choices: &[usize]| choices[draw.whole(0, choices.len() as i64 - 1) as usize];
        let (window, stride) = (of(&[8, 12, 16]), of(&[2, 4, 8]));
        let size = (8 * of(&[2, 3, 4, 5, 6, 8]), 8 * of(&[1, 2, 3, 4]));
        let mut design = committed("tiny");
        design.form.window = Window::new(window).unwrap();
        design.frame = FrameSize { width: size.0, height: size.1, stride: Stride::new(stride).unwrap() };
        if design.check().is_ok() {
            let setup = Setup::new(design);
            if setup.tells_frames_apart() {
                println!("window {window}, stride {stride}, {size:?}");
                are_shown(&setup);
                found += 1;
            }
        }
    }
}

/// Clocks that no board has. As long as the core keeps up nothing is lost; where it does not, what is lost is counted, and what is shown is whole or black from
/// a pixel on.
#[test]
fn a_core_as_fast_as_the_pixels_or_slower_shows_no_mixed_pictures() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let frames = drawn(setup.design.frame, 9, 4).unwrap();
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let pixels = system::leisurely(&setup.design);
    for (percent, keeps_up, seed) in
        [(100, true, 1), (100, true, 2), (120, true, 3), (150, false, 4), (200, false, 5)]
    {
        let periods = Periods { core: pixels.input * percent / 100, ..pixels };
        let begin = RigConfig { periods, behaviour: Behaviour::ideal(), ..setup.begin(seed) };
        let sent = frames.iter().map(system::sent).collect();
        let mut rig = Rig::start(&setup.compiled, &begin, sent).unwrap();
        rig.send(8).unwrap();
        rig.show(4).unwrap();
        let errors: u32 = ERRORS.iter().map(|name| rig.register(name).unwrap()).sum();
        assert_eq!(errors == 0, keeps_up, "a core's cycle of {percent} % of a pixel");
        if keeps_up {
            assert!(longest_run(&setup.shown(&rig, &pictures)) >= 5);
        } else {
            assert!(rig.screen.frames.iter().all(|(_, frame)| is_whole_or_cut(frame, &pictures)));
        }
    }
}

/// Whether a frame is one of the pictures, or black from a pixel on.
pub fn is_whole_or_cut(frame: &[u16], pictures: &[Vec<u16>]) -> bool {
    pictures.iter().any(|picture| {
        let good = frame.iter().zip(picture).take_while(|(shown, made)| shown == made).count();
        frame[good..].iter().all(|pixel| *pixel == BLACK_PIXEL)
    })
}

#[test]
fn window_8_stride_8() {
    frames_are_shown(8, 8, (32, 24));
}

#[test]
fn window_12_stride_4() {
    frames_are_shown(12, 4, (32, 16));
}

#[test]
fn window_8_stride_2() {
    frames_are_shown(8, 2, (16, 16));
}

#[test]
fn whatever_happens_no_picture_is_torn_and_the_right_counter_counts() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let draw = &mut Draw::new(9);
    let frames = drawn(setup.design.frame, 40, 9).unwrap();
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let mut rig = setup.start(&frames, 9);
    rig.send(1).unwrap();
    rig.show(3).unwrap();
    // New pictures come again within two frames of the camera, and one on the screen.
    let recovers = |rig: &mut Rig, what: &str| {
        let sent = rig.camera.frame;
        rig.send(sent + 3).unwrap();
        rig.show(2).unwrap();
        let last = setup.shown(rig, &pictures).last().copied().flatten();
        assert!(last.is_some_and(|number| number > sent), "{what}: frame {sent} was sent, {last:?} is shown");
    };

    // The cable, pulled in the middle of a frame.
    rig.steps(draw.whole(1, 10_000) as usize).unwrap();
    rig.camera.connected = false;
    let is_noticed = (0..20).any(|_| {
        rig.steps(10_000).unwrap();
        rig.register("status").unwrap() & 0b10 == 0
    });
    assert!(is_noticed, "a cable that is not there");
    rig.camera.connected = true;
    recovers(&mut rig, "cable");

    // The camera's clock stands still, and its place in the frame with it.
    rig.steps(draw.whole(1, 10_000) as usize).unwrap();
    rig.bench.run_clock(rig.input, false);
    rig.steps(20_000).unwrap();
    assert_eq!(rig.register("status").unwrap() & 0b110, 0, "a clock that stands still is no signal");
    rig.bench.run_clock(rig.input, true);
    recovers(&mut rig, "clock");
    assert_eq!(rig.register("status").unwrap() & 0b110, 0b110);

    // Raw words that are read with an error, inverted: no picture is made of them. Bursts that are not written: no picture either.
    rig.memory.behaviour.read_errors = [100, 0];
    let sent = rig.camera.frame;
    rig.send(sent + 3).unwrap();
    assert!(rig.register("raw_read_errors").unwrap() > 0 && rig.register("picture_broken").unwrap() > 0);
    rig.memory.behaviour.read_errors = [0; 2];
    rig.memory.behaviour.errors = 600;
    let sent = rig.camera.frame;
    rig.send(sent + 2).unwrap();
    rig.memory.behaviour.errors = 0;
    let told = ["input_write_errors", "picture_write_errors"];
    assert!(told.iter().map(|name| rig.register(name).unwrap()).sum::<u32>() > 0);
    recovers(&mut rig, "errors");

    // Words of a picture that are read with an error, inverted: black from there on.
    rig.memory.behaviour.read_errors = [0, 40];
    let before = rig.screen.frames.len();
    rig.show(6).unwrap();
    assert!(rig.register("output_read_errors").unwrap() > 0);
    rig.memory.behaviour.read_errors = [0; 2];
    rig.show(2).unwrap();
    let shown = rig.screen.frames.split_off(before);
    assert!(
        shown.iter().all(|(_, frame)| is_whole_or_cut(frame, &pictures)),
        "a word with an error is shown"
    );
    rig.shown_at.truncate(before);
    recovers(&mut rig, "errors on the way to the screen");

    // Frames of another size: the last picture stays.
    let wrong = FrameSize { width: 32, height: 16, ..setup.design.frame };
    let before = rig.register("input_wrong").unwrap();
    rig.camera.change(VideoTiming::of_frame(wrong), vec![vec![0; 32 * 16]]);
    rig.show(4).unwrap();
    assert!(rig.register("input_wrong").unwrap() > before);
    assert_eq!(rig.register("status").unwrap() & 0b110, 0b010, "present, and of another size");
    assert_eq!(rig.register("input_size").unwrap() >> 16, 16);
    rig.camera.change(VideoTiming::of_frame(setup.design.frame), frames.iter().map(system::sent).collect());
    rig.send(1).unwrap();
    recovers(&mut rig, "size");

    // Each bit of what the host sees is that of its line.
    let status = rig.register("status").unwrap();
    for (line, level, bit) in [("i2c_done_i", 0, 1 << 4), ("i2c_failed_i", 1, 1 << 5)] {
        rig.bench.set(line, level).unwrap();
        assert_eq!(rig.register("status").unwrap(), status ^ bit, "{line}");
        rig.bench.set(line, 1 - level).unwrap();
    }

    // Resets at any moment, the memory alive: in the middle of bursts, and with words in flight that come thousands of cycles later.
    for behaviour in [Behaviour::hard(1), Behaviour::starving(2), Behaviour::starving(3)] {
        rig.memory.behaviour = behaviour;
        rig.steps(draw.whole(1, 10_000) as usize).unwrap();
        rig.reset().unwrap();
        rig.memory.behaviour = Behaviour::hard(4);
        recovers(&mut rig, "reset");
    }
}

/// The third of the agents: the writers of raw frames and pictures, the readers of both.
const RAW_READER: usize = 2;

/// Until an agent asks for a burst.
pub fn burst_begins(rig: &mut Rig, agent: usize) {
    let write = ["dram_write_aw_valid_o", "dram_write_aw_id_o"];
    let [valid, id] = [write, ["dram_read_ar_valid_o", "dram_read_ar_id_o"]][agent / 2];
    for _ in 0..1_000_000 {
        if rig.bench.get(valid).unwrap() == 1 && rig.bench.get(id).unwrap() == agent as u64 % 2 {
            return;
        }
        rig.steps(1).unwrap();
    }
    panic!("agent {agent} asks for no burst");
}

/// What stage 1 reads back of its shifts, as the host sees them.
pub fn shifts(rig: &mut Rig, set: usize) -> u32 {
    stage_register(rig, 1, set)
}

/// What a stage reads back of a register.
fn stage_register(rig: &mut Rig, stage: usize, row: usize) -> u32 {
    let command = read_command(Space::Register { row }, 1);
    let register = memory::address(stage, Space::Register { row: READ_REGISTER });
    rig.access(Access::Write(WEIGHTS.word(register), command)).unwrap();
    let shown = |part| Access::Read(STAGE_READS.word(read_back_address(stage, part) & !READ_BACK));
    while rig.access(shown(ReadBack::Busy)).unwrap() == 1 {}
    let word = rig.access(shown(ReadBack::Low)).unwrap();
    assert_eq!(rig.access(shown(ReadBack::Crc)).unwrap(), crc([word.into()]));
    word
}

#[test]
fn a_flush_and_a_reset_drop_the_frame_under_way_and_nothing_that_was_written() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let frames = drawn(setup.design.frame, 30, 5).unwrap();
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let mut rig = setup.start(&frames, 5);
    let generated = Shifts::of(&setup.sets[1], &setup.design.stage(1)).word();
    assert_eq!(shifts(&mut rig, 1), generated);
    let written = generated ^ 0x5_30c3;
    let address = memory::address(1, Space::Register { row: 1 });
    rig.access(Access::Write(WEIGHTS.word(address), written)).unwrap();
    let control = map::register("control").unwrap();
    for held in [10, 3_000, 10] {
        rig.steps(7_001).unwrap();
        // In the midst of a frame on its way to the calculator.
        burst_begins(&mut rig, RAW_READER);
        rig.steps(600).unwrap();
        rig.access(Access::Write(control.address, control.reset | 1 << 4)).unwrap();
        rig.steps(400 + held).unwrap();
        rig.access(Access::Write(control.address, control.reset)).unwrap();
        let sent = rig.camera.frame;
        rig.send(sent + 3).unwrap();
        rig.show(2).unwrap();
        let last = setup.shown(&rig, &pictures).last().copied().flatten();
        assert!(last.is_some_and(|number| number > sent), "frame {sent} was sent, {last:?} is shown");
        assert_eq!(shifts(&mut rig, 1), written);
    }
    // The counters are those of a calculator that works, with no window of the wrong length.
    rig.access(Access::Write(WEIGHTS.word(memory::SNAPSHOT), 0)).unwrap();
    let count = |stage: usize, counter| Access::Read(STAGE_COUNTERS.word(status_address(stage, counter)));
    assert!(rig.access(count(1, 0)).unwrap() > 0);
    assert_eq!([0, 1].map(|kind| rig.access(count(memory::WHOLE_CHAIN, kind)).unwrap()), [0; 2]);
    // Each stage has checked as many frames as came to it: all that were cut into windows, less those that are on their way.
    let cut = rig.register("check_frames").unwrap() >> 8 & 0xff;
    for stage in 0..setup.design.stages().count() {
        let checked = stage_register(&mut rig, stage, CHECK_FRAME_REGISTER);
        assert!(
            checked > 0 && (cut.saturating_sub(3)..=cut).contains(&checked),
            "{stage}: {checked}, {cut} cut"
        );
    }
    assert_eq!(rig.register("status").unwrap() >> 7 & 1, 0);
    // After a reset too; and the bank in use stays in use, whichever it is.
    for (set, control) in [(map::WEIGHT_SET, 0b111), (0, 0b011)] {
        rig.access(Access::Write(map::CONTROL, set)).unwrap();
        rig.reset().unwrap();
        assert_eq!(rig.register("control").unwrap(), control);
        assert_eq!(shifts(&mut rig, 1), written);
    }
    // A rig that starts is a board that was configured.
    assert_eq!(shifts(&mut setup.start(&frames, 6), 1), generated);
}

/// What the tables' reader says of rows of a bank: CRC, and the last row.
fn table_rows_read(rig: &mut Rig, bank: usize, row: usize, rows: usize) -> (u32, u64) {
    let command = read_command(Space::Weights { bank, row, half: 0 }, rows);
    let register = memory::address(TABLES, Space::Register { row: READ_REGISTER });
    rig.access(Access::Write(WEIGHTS.word(register), command)).unwrap();
    let mut shown = |part| {
        rig.access(Access::Read(STAGE_READS.word(read_back_address(TABLES, part) & !READ_BACK))).unwrap()
    };
    while shown(ReadBack::Busy) == 1 {}
    (shown(ReadBack::Crc), u64::from(shown(ReadBack::Low)) | u64::from(shown(ReadBack::High)) << 32)
}

#[test]
fn tables_are_read_back_while_pictures_are_made() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let frames = drawn(setup.design.frame, 30, 5).unwrap();
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let mut rig = setup.start(&frames, 8);
    let display = Display::new(DisplayMode::Colour, Curve::Srgb);
    let luma = display.luma.entries().iter().map(|code| u16::from(*code)).collect::<Vec<_>>();
    let tables: Vec<Vec<u64>> = std::iter::once(&luma[..])
        .chain(display.colours.iter().map(|table| table.entries()))
        .map(table_rows)
        .collect();
    let draw = &mut Draw::new(8);
    for _ in 0..12 {
        let table = draw.whole(0, 3) as usize;
        let half = if table == 0 { draw.whole(0, 1) as usize } else { 0 };
        let count = draw.whole(1, 5) as usize;
        let row = draw.whole(0, (TABLE_ROWS - count) as i64) as usize;
        let expected = &tables[table][half * TABLE_ROWS + row..][..count];
        let found = table_rows_read(&mut rig, table_bank(table) + half, row, count);
        assert_eq!(found, (crc(expected.iter().copied()), expected[count - 1]), "table {table}, row {row}");
    }
    rig.show(2).unwrap();
    assert!(setup.shown(&rig, &pictures).last().is_some_and(Option::is_some));
    // Tables in use take no words; others do, and in the midst of reading.
    let entry = |table: u32, entry: u32| DISPLAY_TABLES.word(0x8000 * table + entry);
    let refused = rig.access(Access::Write(entry(2, 4 * 77 + 1), 0xabc)).unwrap_err();
    assert!(refused.to_string().contains("was refused"), "{refused}");
    rig.access(Access::Write(map::CONTROL, map::COLOUR)).unwrap();
    let command = read_command(Space::Weights { bank: table_bank(2), row: 70, half: 0 }, 8);
    let register = memory::address(TABLES, Space::Register { row: READ_REGISTER });
    rig.access(Access::Write(WEIGHTS.word(register), command)).unwrap();
    for i in 0..60 {
        rig.access(Access::Write(entry(2, 4 * 77 + 1), 0xa00 + i)).unwrap();
    }
    let mut row = tables[2][77];
    row = row & !0xffff_0000 | (0xa00 + 59) << 16;
    assert_eq!(table_rows_read(&mut rig, table_bank(2), 77, 1), (crc([row]), row));
    let before = &tables[2][70..77];
    assert_eq!(table_rows_read(&mut rig, table_bank(2), 70, 7).0, crc(before.iter().copied()));
}

fn all_windows(raw: &RawFrame, geometry: Geometry) -> impl Iterator<Item = Vec<InputWord>> {
    let (rows, columns) = geometry.patches(raw.size().0, raw.size().1);
    (0..rows * columns).map(move |i| windows::window(raw, geometry, i / columns, i % columns))
}

/// The figures ahead of a run and those of the run: with a calculator that waits for the camera, and one that the camera waits for.
#[test]
fn the_figures_stated_ahead_are_those_of_the_run() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let frames = drawn(setup.design.frame, 14, 3).unwrap();
    let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
    let model = Cycle::new(&setup.design, [&setup.sets[0], &setup.sets[0]]).unwrap();
    let geometry = Geometry::new(setup.design.form.window, setup.design.frame.stride);
    let mut summary = Summary::new(&setup.design);
    let windows = all_windows(&frames[1], geometry);
    let patches = windows.map(|window| Patch { window, set: Set::First });
    model.run(patches).for_each(|run| summary.add(&run));
    let cycles = CoreCycles::of(&setup.design, summary.cycles_per_patch(), summary.mean_latency());
    let leisurely = system::leisurely(&setup.design);
    // A little faster than the calculator: of a much faster camera the reader would hold several of these small frames ahead.
    let hurried = Periods { input: leisurely.calculator, output: leisurely.calculator, ..leisurely };
    for periods in [leisurely, hurried] {
        let begin =
            RigConfig { periods, behaviour: Behaviour::ideal(), ..RigConfig::leisurely(&setup.design, 3) };
        let sent = frames.iter().map(system::sent).collect();
        let mut rig = Rig::start(&setup.compiled, &begin, sent).unwrap();
        rig.send(2).unwrap();
        let since = rig.moment().unwrap();
        let counts = |rig: &mut Rig| ["patches", "busy_cycles"].map(|name| rig.register(name).unwrap());
        let (begun, [patches, busy]) = (rig.bench.time_ps(), counts(&mut rig));
        rig.send(12).unwrap();
        let [patches, busy] = [counts(&mut rig)[0] - patches, counts(&mut rig)[1] - busy].map(u64::from);
        let elapsed = (rig.bench.time_ps() - begun) / periods.calculator;
        assert!(patches < busy && busy < elapsed, "{patches} patches, {busy} of {elapsed} cycles");
        let shown = setup.shown(&rig, &pictures);
        let found = rig.measured(&since, &begin, &shown).unwrap();
        let ahead = figures(setup.design.frame, cycles, periods);
        let near = |found: f64, ahead: f64| (found / ahead - 1.0).abs() < 0.1;
        assert!(near(found.frames_per_second, ahead.frames_per_second), "{found:?} {ahead:?}");
        assert!(near(found.written, ahead.written) && near(found.read, ahead.read), "{found:?} {ahead:?}");
        let [min, max] = ahead.latency;
        let within = |seconds: &f64| (0.95 * min..1.05 * max).contains(seconds);
        assert!(!found.latency.is_empty() && found.latency.iter().all(within), "{found:?} {ahead:?}");
    }
}
