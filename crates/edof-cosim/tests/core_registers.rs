//! What the board's other clocks and parts tell the host stands in the register that the map names: counts are the golden model's, cycles those of the clocks.

use crate::edof_core::{Setup, design};
use crate::frame_checks::FrameChecks;
use crate::planted_faults::replaced;
use edof_core::DisplayMode;
use edof_core::cable::carried;
use edof_core::draw::Draw;
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::system::{Rig, RigConfig, drawn};
use edof_device::design::memory;
use edof_device::pattern::{TILE, TILE_SIDE};
use edof_device::registers::map::{self, PICTURE_PIXELS, TILE_PIXELS, WEIGHTS};
use edof_golden::video::pattern;
use edof_golden::{Curve, Display, Golden};
use ndarray::Array2;

/// A register without fields is the whole word, else the bits of its fields.
fn mask(name: &str) -> u32 {
    let fields = map::register(name).unwrap().fields;
    if fields.is_empty() {
        return u32::MAX;
    }
    fields.iter().fold(0, |mask, field| mask | field.mask())
}

#[test]
fn words_at_the_cores_ports_stand_in_their_registers_and_those_of_registers_at_its_ports() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let mut rig = setup.start(&drawn(setup.design.frame, 2, 1).unwrap(), 1);
    let draw = &mut Draw::new(1);
    let ports = [
        ("i2c_0_i", "i2c_board"),
        ("i2c_1_i", "i2c_card"),
        ("chips_0_i", "receiver"),
        ("chips_1_i", "receiver_size"),
        ("chips_2_i", "receiver_format"),
        ("chips_3_i", "transmitter"),
        ("chip_answer_i", "chip_answer"),
        ("input_codes_i", "input_codes"),
        ("input_malformed_i", "input_malformed"),
        ("uart_broken_i", "uart_broken"),
    ];
    // Each word with its complement after it, so that no bit stands by chance.
    for inverted in [0, u32::MAX] {
        let words = [0; 10].map(|_| draw.bits() as u32 ^ inverted);
        for ((port, _), word) in ports.iter().zip(words) {
            rig.bench.set(port, word.into()).unwrap();
        }
        rig.steps(2_000).unwrap();
        for ((port, name), word) in ports.iter().zip(words) {
            assert_eq!(rig.register(name).unwrap(), word & mask(name), "{name} of {port}");
        }
    }
    for (name, port) in [("chip_access", "chip_access_o"), ("video_setup", "video_setup_o")] {
        let register = map::register(name).unwrap();
        let word = draw.bits() as u32 & mask(name);
        rig.access(Access::Write(register.address, word)).unwrap();
        assert_eq!(rig.bench.get(port).unwrap(), u64::from(word), "{port} of {name}");
    }
    for restart in [1, 0] {
        rig.access(Access::Write(map::CONTROL, map::RUN | (map::I2C_RESTART * restart))).unwrap();
        assert_eq!(rig.bench.get("i2c_restart_o").unwrap(), u64::from(restart));
    }
    assert_eq!(rig.bench.get("status_o").unwrap(), u64::from(rig.register("status").unwrap() & 0xff));
}

#[test]
fn counts_of_a_frame_are_the_models_with_either_bank() {
    let setup = Setup::new(design(8, 2, (16, 16)));
    let frame = drawn(setup.design.frame, 1, 4).unwrap().remove(0);
    let mut rig = setup.start(&vec![frame.clone(); 40], 4);
    let mut sent = 0;
    for (set, mode) in [(1, DisplayMode::Luma), (0, DisplayMode::Colour), (1, DisplayMode::Colour)] {
        let (golden, display) =
            (Golden::new(setup.sets[set].clone()).unwrap(), Display::new(mode, Curve::Srgb));
        let made = golden.frame(&carried(&frame)).unwrap();
        let shown = made.picture(&display).1;
        let names = ["patches", "saturated_sums", "clamped_chroma", "out_of_gamut"];
        let expected =
            [made.counts.patches, made.counts.saturated_sums, shown.clamped_chroma, shown.out_of_gamut];
        println!("set {set}, {mode}: {expected:?}");
        let checks = FrameChecks::new(&setup, std::slice::from_ref(&frame), set, mode);
        let counts = |rig: &mut Rig| names.map(|name| u64::from(rig.register(name).unwrap()));
        rig.control(mode, set).unwrap();
        rig.send(sent + 4).unwrap();
        assert_eq!(rig.register("status").unwrap() >> 6 & 0b11, set as u32, "the bank in use, and no fault");
        let before = counts(&mut rig);
        rig.send(sent + 10).unwrap();
        sent += 10;
        let after = counts(&mut rig);
        checks.hold(&mut rig, 0, &format!("set {set}, {mode}"));
        // Whole frames, and a part of one at each end.
        for (at, name) in names.into_iter().enumerate() {
            let [found, of_one] = [after[at] - before[at], expected[at]];
            assert!((5 * of_one..=7 * of_one).contains(&found), "{name}: {found} in six frames of {of_one}");
        }
    }
    // After a reset no patch has left yet.
    rig.reset().unwrap();
    rig.steps(1_000).unwrap();
    assert_eq!(rig.register("status").unwrap() >> 6 & 1, 0);
    assert_eq!(rig.register("patches").unwrap(), 0);
}

/// A tile that the host writes is the raw frame, and the host reads its codes at any corner of the picture.
#[test]
fn a_tile_goes_in_at_the_hosts_port_and_its_codes_come_out() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let (height, width) = (setup.design.frame.height, setup.design.frame.width);
    let mut rig = setup.start(&drawn(setup.design.frame, 2, 1).unwrap(), 1);
    let draw = &mut Draw::new(9);
    let tile = Array2::from_shape_simple_fn((TILE_SIDE, TILE_SIDE), || draw.bits() as u16);
    for (row, column) in (0..height).flat_map(|row| (0..width).map(move |column| (row, column))) {
        let address = TILE_PIXELS.word((row * TILE_SIDE + column) as u32);
        rig.access(Access::Write(address, tile[(row, column)].into())).unwrap();
    }
    rig.access(Access::Write(map::PATTERN, TILE)).unwrap();
    let frame = pattern::tiled(&tile, setup.design.frame).unwrap();
    let (golden, display) = (Golden::new(setup.sets[0].clone()).unwrap(), Display::default());
    let bytes = golden.frame(&frame).unwrap().picture(&display).0.yuyv();
    for (row, column) in [(0, 0), (height - 5, width - 6)] {
        rig.access(Access::Write(map::PICTURE_CORNER, (row << 16 | column) as u32)).unwrap();
        let before = rig.register("picture_frames").unwrap();
        while rig.register("picture_frames").unwrap() < before + 4 {
            rig.steps(10_000).unwrap();
        }
        for (r, c) in (row..height).flat_map(|r| (column..width).map(move |c| (r, c))) {
            let at = 2 * (r * width + c);
            let address = PICTURE_PIXELS.word(((r - row) * TILE_SIDE + c - column) as u32);
            let code = u16::from_le_bytes([bytes[at], bytes[at + 1]]);
            assert_eq!(rig.access(Access::Read(address)).unwrap(), u32::from(code), "row {r}, column {c}");
        }
    }
    let raw = golden.checks(&display, &frame).unwrap().raw;
    rig.access(Access::Write(WEIGHTS.word(memory::SNAPSHOT), 0)).unwrap();
    assert_eq!(rig.register("check_raw").unwrap(), raw);
}

#[test]
fn cycles_are_those_of_the_clocks_and_frames_those_that_passed() {
    let setup = Setup::new(design(8, 8, (32, 24)));
    let frames = drawn(setup.design.frame, 20, 6).unwrap();
    let mut rig = setup.start(&frames, 6);
    rig.send(4).unwrap();
    let clocks = ["core_cycles", "input_cycles", "screen_cycles"];
    let passed = ["input_frames", "raw_frames", "picture_frames"];
    let counts = |rig: &mut Rig, names: [&str; 3]| names.map(|name| rig.register(name).unwrap());
    let (begin, cycles, seen) = (rig.bench.time_ps(), counts(&mut rig, clocks), counts(&mut rig, passed));
    rig.send(14).unwrap();
    let elapsed = (rig.bench.time_ps() - begin) as f64;
    let periods = RigConfig::leisurely(&setup.design, 6).periods;
    let (later, frames) = (counts(&mut rig, clocks), counts(&mut rig, passed));
    for (at, period) in [periods.core, periods.input, periods.output].into_iter().enumerate() {
        let found = f64::from(later[at].wrapping_sub(cycles[at])) * period as f64;
        assert!((found / elapsed - 1.0).abs() < 0.01, "{}: {found} ps of {elapsed}", clocks[at]);
    }
    for at in 0..3 {
        assert!(
            (9..=11).contains(&(frames[at] - seen[at])),
            "{}: {} of 10",
            passed[at],
            frames[at] - seen[at]
        );
    }
}

#[test]
fn a_window_without_an_end_is_told() {
    let (last, never) = ("out_last_o = front_data[32]", "out_last_o = 1'b0");
    let change = |project| replaced(project, "core.windows", last, never);
    let setup = Setup::changed(design(8, 8, (16, 16)), change);
    let mut rig = setup.start(&drawn(setup.design.frame, 3, 1).unwrap(), 1);
    rig.send(2).unwrap();
    // Alone: the bits of memory, chips and bank are not set with it.
    for line in ["dram_ready_i", "i2c_done_i"] {
        rig.bench.set(line, 0).unwrap();
    }
    assert_eq!(rig.register("status").unwrap() & 0b1111_0001, 1 << 7);
}
