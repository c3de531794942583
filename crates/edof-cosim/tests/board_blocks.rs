//! Blocks of the board: the same outputs in every cycle in rust-hdl's simulation, in Verilator and in Icarus; patterns are the contract's words, the host's
//! window keeps the right pixels, and a clock that stands is noticed in time.

use crate::differential::{RESET, agree, bit, ported, word};
use crate::support;
use edof_core::draw::Draw;
use edof_core::{RawFrame, Stride};
use edof_cosim::bench::{Actor, Beat, Bench, ClockId, Receiver, Sender, Throttle};
use edof_cosim::verilator::{Library, Model, Start};
use edof_cosim::{Error, Source};
use edof_device::design::FrameSize;
use edof_device::design::memory::{Space, TABLES, address};
use edof_device::design::reading::READ_REGISTER;
use edof_device::pattern::{Pattern, TILE, TILE_SIDE};
use edof_golden::video::pattern;
use edof_hdl::board::{
    ClockWatch, CycleCount, I2cMaster, PatternSource, PictureWindow, UartBus, UartReceiver,
};
use edof_hdl::video::table_reader::TableReader;
use edof_verilog::describe::Circuit;
use ndarray::Array2;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

ported!(CycleCount, I2cMaster, TableReader, UartBus, UartReceiver);

/// Two squares of the chart and a bit of a third, in both directions.
const FRAME: FrameSize = FrameSize { width: 38, height: 34, stride: Stride::PATCH };

#[test]
fn cycle_count() {
    agree(CycleCount::default(), RESET as usize, &[], |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 99) == 0;
    });
}

#[test]
fn uart_receiver() {
    // About a byte's levels, each as long as a bit or a cycle more or less, and short faults between them.
    let (mut level, mut left) = (true, 0);
    agree(UartReceiver::new(8), RESET as usize + 120, &[("byte", "valid")], |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 900) == 0;
        if left == 0 {
            left = draw.whole(1, 4) * 8 + draw.whole(-1, 1);
            level = !level;
        }
        left -= 1;
        b.line.next = level != (draw.whole(0, 60) == 0);
    });
}

/// Levels of a frame: a command of one word, an address, the word for a write; some with a byte that is not there; a pause after it.
fn levels(draw: &mut Draw) -> VecDeque<bool> {
    let command = draw.whole(1, 4);
    let rest = (0..if command % 2 == 1 { 8 } else { 4 }).map(|_| draw.whole(0, 255));
    let mut bytes = [command, 1].into_iter().chain(rest).collect::<Vec<_>>();
    if draw.whole(0, 5) == 0 {
        bytes.remove(draw.whole(0, bytes.len() as i64 - 1) as usize);
    }
    let bits =
        |byte: i64| [false].into_iter().chain((0..8).map(move |bit| byte >> bit & 1 == 1)).chain([true]);
    let bits = bytes.into_iter().flat_map(bits).flat_map(|level| [level; UART_CYCLES as usize]);
    bits.chain(vec![true; draw.whole(0, 250) as usize]).collect()
}

const UART_CYCLES: u16 = 4;

#[test]
fn uart_bus() {
    let mut line = VecDeque::new();
    let qualified =
        [("bus.aw_addr", "bus.aw_valid"), ("bus.w_data", "bus.w_valid"), ("bus.ar_addr", "bus.ar_valid")];
    agree(UartBus::new(UART_CYCLES, 150), RESET as usize, &qualified, |b, draw, last| {
        b.reset.next = last.cycle < RESET;
        if line.is_empty() {
            line = levels(draw);
        }
        b.receive.next = line.pop_front().unwrap();
        b.bus.aw_ready.next = bit(draw);
        b.bus.w_ready.next = bit(draw);
        b.bus.b_valid.next = bit(draw);
        b.bus.b_resp.next = word(draw);
        b.bus.ar_ready.next = bit(draw);
        b.bus.r_valid.next = bit(draw);
        b.bus.r_data.next = word(draw);
        b.bus.r_resp.next = word(draw);
    });
}

#[test]
fn i2c_master() {
    let mut pulled = [0; 2];
    // Before its first transfer nobody has set the value.
    agree(I2cMaster::new(4), RESET as usize, &[("value", "done"), ("cause", "done")], |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 900) == 0;
        // Lines are left alone between transfers.
        assert!(last.is("busy") || !last.is("scl_low") && !last.is("sda_low"), "a line is held");
        if !last.is("busy") {
            b.start.next = bit(draw);
            b.read.next = bit(draw);
            b.bare.next = bit(draw);
            b.device.next = word(draw);
            b.register.next = word(draw);
            b.write_value.next = word(draw);
        }
        // A chip or another master pulls a line down for a while, data for whole bits where acknowledgements are.
        for (held, rare) in pulled.iter_mut().zip([300, 20]) {
            *held = if *held > 0 { *held - 1 } else { draw.whole(0, rare) / rare * draw.whole(4, 40) };
        }
        b.scl.next = !last.is("scl_low") && pulled[0] == 0;
        b.sda.next = !last.is("sda_low") && pulled[1] == 0;
    });
}

/// The cycles from the master's first idle cycle, in which a transfer is asked for, to its start condition. Before it there was none, or one whose clock
/// line was held; `held` has the cycle of that and how long.
fn free_cycles(bench: &mut Bench, held: Option<(usize, usize)>) -> usize {
    let steps_until = |bench: &mut Bench, port: &str, level: u64| {
        (0..20_000).find(|_| {
            bench.step(&mut []).unwrap();
            bench.get(port).unwrap() == level
        })
    };
    for (port, level) in [("reset_i", 1), ("scl_i", 1), ("sda_i", 1), ("start_i", 0)] {
        bench.set(port, level).unwrap();
    }
    bench.steps(8, &mut []).unwrap();
    bench.set("reset_i", 0).unwrap();
    bench.set("start_i", 1).unwrap();
    if let Some((after, cycles)) = held {
        bench.steps(after, &mut []).unwrap();
        bench.set("scl_i", 0).unwrap();
        bench.steps(cycles, &mut []).unwrap();
        bench.set("scl_i", 1).unwrap();
        steps_until(bench, "busy_o", 0).expect("the transfer ends");
    }
    steps_until(bench, "sda_low_o", 1).expect("a start condition")
}

#[test]
fn the_bus_is_left_alone_as_long_after_a_clock_line_that_was_held_too_long() {
    let mut bench = Bench::new(model(&source(I2cMaster::new(4)), 3), 3);
    bench.clock("clock_i", 10_000).unwrap();
    let usual = free_cycles(&mut bench, None);
    for after in 1..9 {
        for cycles in 6_390..6_410 {
            let found = free_cycles(&mut bench, Some((after, cycles)));
            assert!(found >= usual, "{found} cycles and not {usual}, {cycles} cycles after {after}");
        }
    }
}

#[test]
fn table_reader() {
    read_tables(40, true);
    // Reads that come to their end.
    read_tables(500, false);
}

/// A command in one of `pause` cycles on average; with faults some have another address, or come in a reset.
fn read_tables(pause: i64, with_faults: bool) {
    let mut began = 0;
    // From the first row of weights on all is known.
    agree(TableReader::new(), RESET as usize + 300, &[], |b, draw, last| {
        b.host_write.next = draw.whole(0, 3) == 0;
        b.host_select.next = word(draw);
        b.host_address.next = word(draw);
        b.host_data.next = word(draw);
        b.table_word.next = word(draw);
        let is_first = last.cycle == RESET + 2;
        // Some come as a row before ends: 63 cycles after the command, and each 256 after that.
        let row_ends = (last.cycle - began) % 256 == 63;
        let pause = if row_ends && !with_faults { 1 } else { pause };
        let is_command = last.cycle > RESET + 300 && draw.whole(0, pause) == 0;
        if is_first || is_command {
            began = last.cycle;
        }
        b.write_valid.next = is_first || is_command;
        let is_faulty = with_faults && !is_first;
        let resets = draw.whole(0, 900) == 0 || is_command && draw.whole(0, 9) == 0;
        b.reset.next = last.cycle < RESET || is_faulty && resets;
        // Each other address differs in one bit.
        let other = if is_faulty && bit(draw) { 1 << draw.whole(0, 24) } else { 0 };
        let command = address(TABLES, Space::Register { row: READ_REGISTER });
        b.write_address.next = u64::from(command ^ other).into();
        let of_weights = if is_first || with_faults && bit(draw) { 0x3fff_ffff } else { 0xffff_ffff };
        b.write_data.next = ((draw.bits() >> 44 << 12 | draw.whole(0, 2) as u64) & of_weights).into();
        b.status_address.next = if bit(draw) {
            word(draw)
        } else {
            (64 + TABLES as u64 % 16 * 4 + draw.whole(0, 3) as u64).into()
        };
    });
}

pub fn source(mut block: impl Circuit) -> Source {
    Source::circuit(&mut block).unwrap()
}

pub fn model(source: &Source, seed: u64) -> Model {
    let library = Library::build(source, &support::options()).unwrap();
    library.start(&Start { seed, ..Start::default() }).unwrap()
}

/// The tile that the host wrote: a pixel comes two cycles after its address.
struct Tile {
    clock: ClockId,
    /// Address, pixel.
    ports: [usize; 2],
    pixels: Array2<u16>,
    on_the_way: VecDeque<u64>,
}

impl Actor for Tile {
    fn clock(&self) -> ClockId {
        self.clock
    }

    fn before(&mut self, model: &mut Model) -> Result<(), Error> {
        let address = model.peek(self.ports[0])? as usize;
        self.on_the_way.push_back(self.pixels[(address / TILE_SIDE, address % TILE_SIDE)].into());
        Ok(())
    }

    fn after(&mut self, model: &mut Model) -> Result<(), Error> {
        let pixel = if self.on_the_way.len() > 1 { self.on_the_way.pop_front().unwrap() } else { 0 };
        model.poke(self.ports[1], pixel)
    }
}

/// The beats of a frame, as its lines are sent.
fn beats(frame: &RawFrame) -> Vec<Beat> {
    let values = frame.values();
    let lines = values.outer_iter().enumerate();
    lines.flat_map(|(row, line)| Beat::line(line.iter().map(|&word| word.into()), row == 0)).collect()
}

#[test]
fn patterns_are_the_contracts_words_from_their_first_pixel_on_whenever_they_are_chosen() {
    let source = source(PatternSource::new(FRAME));
    let tile =
        Array2::from_shape_fn((TILE_SIDE, TILE_SIDE), |(row, column)| (row * 997 + column * 31) as u16);
    let patterns =
        [Pattern::Ramp, Pattern::Chart, Pattern::Noise, Pattern::Zeros, Pattern::Ones, Pattern::Alternating];
    let expected = patterns.iter().map(|pattern| pattern::frame(*pattern, FRAME).unwrap());
    let expected: Vec<_> =
        expected.chain([pattern::tiled(&tile, FRAME).unwrap()]).map(|frame| beats(&frame)).collect();
    for (seed, pace) in [(1, Throttle::steady()), (2, Throttle::drawn(2))] {
        let mut bench = Bench::new(model(&source, seed), seed);
        let clock = bench.clock("clock_i", 10_000).unwrap();
        let ports = ["tile_address_o", "tile_pixel_i"].map(|name| source.port(name).unwrap());
        let mut tile = Tile { clock, ports, pixels: tile.clone(), on_the_way: VecDeque::new() };
        let mut receiver = Receiver::new(&source, "pixels", clock, "reset_i", pace.clone()).unwrap();
        bench.set("reset_i", 1).unwrap();
        bench.steps(4, &mut [&mut tile, &mut receiver]).unwrap();
        bench.set("reset_i", 0).unwrap();
        for (kind, expected) in (1..=u64::from(TILE)).zip(&expected) {
            // A frame that is broken off, and one that comes twice after it.
            for count in [expected.len() / 3, 2 * expected.len()] {
                bench.set("select_i", kind).unwrap();
                receiver.beats.clear();
                let start = bench.time_ps();
                while receiver.beats.len() < count {
                    bench.step(&mut [&mut tile, &mut receiver]).unwrap();
                }
                assert!(receiver.beats.iter().eq(expected.iter().cycle().take(count)), "pattern {kind}");
                let cycles = (bench.time_ps() - start) as usize / 10_000;
                assert!(cycles >= 4 * (count - 1), "pattern {kind}: {count} pixels in {cycles} cycles");
                assert!(
                    seed != 1 || cycles <= 4 * count + 4,
                    "pattern {kind}: {count} pixels in {cycles} cycles"
                );
                // Without a pattern nothing comes, since the source offers nothing.
                bench.set("select_i", 0).unwrap();
                bench.steps(3, &mut [&mut tile, &mut receiver]).unwrap();
                receiver.beats.clear();
                bench.steps(50, &mut [&mut tile, &mut receiver]).unwrap();
                assert_eq!(receiver.beats, []);
            }
        }
    }
}

#[test]
fn without_a_pattern_the_sources_pixels_pass_and_with_one_they_are_thrown_away() {
    let source = source(PatternSource::new(FRAME));
    let mut bench = Bench::new(model(&source, 6), 6);
    let clock = bench.clock("clock_i", 10_000).unwrap();
    let mut sender = Sender::new(&source, "source", clock, "reset_i", Throttle::drawn(7)).unwrap();
    let mut receiver = Receiver::new(&source, "pixels", clock, "reset_i", Throttle::drawn(8)).unwrap();
    for (name, value) in [("reset_i", 1), ("select_i", 0)] {
        bench.set(name, value).unwrap();
    }
    bench.steps(4, &mut [&mut sender, &mut receiver]).unwrap();
    bench.set("reset_i", 0).unwrap();
    let draw = &mut Draw::new(9);
    let sent: Vec<_> = (0..3000)
        .map(|_| Beat {
            data: draw.bits() & 0xffff,
            user: draw.whole(0, 9) == 0,
            last: draw.whole(0, 9) == 0,
        })
        .collect();
    sender.beats = sent.clone().into();
    bench.steps(20_000, &mut [&mut sender, &mut receiver]).unwrap();
    assert_eq!(receiver.beats, sent);
    // What the source sends during a pattern is nowhere.
    bench.set("select_i", 4).unwrap();
    bench.steps(4, &mut [&mut sender, &mut receiver]).unwrap();
    sender.beats = sent.clone().into();
    receiver.beats.clear();
    bench.steps(20_000, &mut [&mut sender, &mut receiver]).unwrap();
    assert!(sender.beats.is_empty() && receiver.beats.len() > 500);
    assert!(receiver.beats.iter().all(|beat| beat.data == 0));
}

#[test]
fn the_hosts_window_keeps_the_pixels_right_of_and_below_its_corner() {
    let source = source(PictureWindow::new());
    let (width, height) = (90, 80);
    let port = |name: &str| source.port(name).unwrap();
    let draw = &mut Draw::new(3);
    let mut model = model(&source, 3);
    model.poke(port("reset_i"), 1).unwrap();
    (0..3).for_each(|_| model.tick().unwrap());
    model.poke(port("reset_i"), 0).unwrap();
    for (row, column) in [(0, 0), (0, 7), (9, 0), (13, 21), (60, 50)] {
        model.poke(port("corner_i"), row << 16 | column).unwrap();
        let codes = Array2::from_shape_simple_fn((height, width), || draw.bits() & 0xffff);
        for ((y, x), &code) in codes.indexed_iter() {
            while draw.whole(0, 3) == 0 {
                for (name, value) in
                    [("valid_i", 0), ("data_i", draw.bits() & 0xffff), ("user_i", 1), ("last_i", 1)]
                {
                    model.poke(port(name), value).unwrap();
                }
                model.tick().unwrap();
            }
            let is_first = u64::from((y, x) == (0, 0));
            for (name, value) in [
                ("valid_i", 1),
                ("data_i", code),
                ("user_i", is_first),
                ("last_i", u64::from(x == width - 1)),
            ] {
                model.poke(port(name), value).unwrap();
            }
            model.tick().unwrap();
        }
        // Of a frame that comes in a reset nothing is kept.
        model.poke(port("data_i"), 0).unwrap();
        for (name, value) in [
            ("valid_i", 0),
            ("reset_i", 1),
            ("user_i", 1),
            ("valid_i", 1),
            ("user_i", 0),
            ("valid_i", 0),
            ("reset_i", 0),
        ] {
            model.poke(port(name), value).unwrap();
            (0..4).for_each(|_| model.tick().unwrap());
        }
        for ((y, x), &code) in codes.indexed_iter() {
            let (Some(y), Some(x)) = (y.checked_sub(row as usize), x.checked_sub(column as usize)) else {
                continue;
            };
            if y < TILE_SIDE && x < TILE_SIDE {
                model.poke(port("read_address_i"), (y * TILE_SIDE + x) as u64).unwrap();
                (0..2).for_each(|_| model.tick().unwrap());
                assert_eq!(
                    model.peek(port("read_data_o")).unwrap(),
                    code,
                    "row {y}, column {x} of the corner {row}, {column}"
                );
            }
        }
    }
}

#[test]
fn the_hosts_tile_gives_what_was_written_two_cycles_after_its_address() {
    let source = source(PictureWindow::new());
    let port = |name: &str| source.port(name).unwrap();
    let (draw, model) = (&mut Draw::new(4), &mut model(&source, 4));
    let mut tile = vec![None; TILE_SIDE * TILE_SIDE];
    for _ in 0..20_000 {
        let (address, word) = (draw.whole(0, 4095) as usize, draw.bits() & 0xffff);
        let writes = draw.whole(0, 2) > 0;
        let fields =
            [("write_i", writes.into()), ("write_address_i", address as u64), ("write_data_i", word)];
        fields.iter().for_each(|(name, value)| model.poke(port(name), *value).unwrap());
        model.tick().unwrap();
        if writes {
            tile[address] = Some(word);
        }
        let read = draw.whole(0, 4095) as usize;
        model.poke(port("write_i"), 0).unwrap();
        model.poke(port("tile_address_i"), read as u64).unwrap();
        (0..2).for_each(|_| model.tick().unwrap());
        if let Some(word) = tile[read] {
            assert_eq!(model.peek(port("tile_pixel_o")).unwrap(), word);
        }
    }
}

/// Edges of both clocks until `stopped` is `level`, at most `limit` cycles of the one that watches.
fn cycles_until(bench: &mut Bench, level: u64, period: u64, limit: u64) -> u64 {
    let start = bench.time_ps();
    let cycles = |bench: &Bench| (bench.time_ps() - start) / period;
    while bench.get("stopped_o").unwrap() != level && cycles(bench) < limit {
        bench.step(&mut []).unwrap();
    }
    cycles(bench)
}

#[test]
fn a_clock_that_stands_is_noticed_after_4096_cycles_and_one_that_runs_never() {
    for (stands_at_first, watched_period) in
        [(false, 1_000), (true, 10_100), (false, 200_000), (true, 4_000_000)]
    {
        let source = source(ClockWatch::new(stands_at_first)).metastable();
        let mut bench = Bench::new(model(&source, 5), 5);
        bench.clock("clock_i", 10_000).unwrap();
        let watched = bench.clock("watched_i", watched_period).unwrap();
        for reset in [1, 0] {
            bench.set("reset_i", reset).unwrap();
            bench.set("watched_reset_i", reset).unwrap();
            bench.steps(10, &mut []).unwrap();
        }
        assert_eq!(bench.get("stopped_o").unwrap(), u64::from(stands_at_first));
        // The eighth edge is the first that is seen.
        let edges = 8 * watched_period / 10_000;
        assert!(cycles_until(&mut bench, 0, 10_000, 20_000) <= edges + 8);
        for _ in 0..2 {
            assert!(
                cycles_until(&mut bench, 1, 10_000, 20_000) >= 20_000,
                "it runs, one edge in {watched_period} ps"
            );
            bench.run_clock(watched, false);
            let cycles = cycles_until(&mut bench, 1, 10_000, 20_000);
            assert!(cycles + edges >= 4_090 && cycles <= 4_110, "noticed after {cycles} cycles");
            bench.run_clock(watched, true);
            let cycles = cycles_until(&mut bench, 0, 10_000, 20_000);
            assert!(cycles <= edges + 8, "noticed after {cycles} cycles");
        }
    }
}
