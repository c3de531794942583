//! Every block, given the same stimulus in rust-hdl's simulation, in Verilator and in Icarus: the same outputs in every cycle.

use crate::common::{committed, networks};
use crate::differential::{RESET, agree, agree_with_images, bit, ported, resets, word};
use edof_core::draw::Draw;
use edof_device::Design;
use edof_device::design::memory::{self, Shifts, Space};
use edof_device::design::{StagePlan, reading};
use edof_hdl::blocks::add::Add;
use edof_hdl::blocks::base_ring::BaseRing;
use edof_hdl::blocks::counters::Counters;
use edof_hdl::blocks::delay::Delay;
use edof_hdl::blocks::dense_operands::DenseOperands;
use edof_hdl::blocks::dense_store::DenseStore;
use edof_hdl::blocks::difference::Difference;
use edof_hdl::blocks::drain::Drain;
use edof_hdl::blocks::fifo::Fifo;
use edof_hdl::blocks::frame_check::FrameCheck;
use edof_hdl::blocks::macc_array::MaccArray;
use edof_hdl::blocks::pair_operands::PairOperands;
use edof_hdl::blocks::pair_store::PairStore;
use edof_hdl::blocks::ram::{Ram, Shape};
use edof_hdl::blocks::reader::Reader;
use edof_hdl::blocks::registers::Registers;
use edof_hdl::blocks::requantize::Requantize;
use edof_hdl::blocks::results::Results;
use edof_hdl::blocks::sequencer::Sequencer;
use edof_hdl::blocks::shrink::Shrink;
use edof_hdl::blocks::stage::Stage;
use edof_hdl::blocks::window_guard::WindowGuard;
use edof_hdl::blocks::window_ring::WindowRing;
use edof_hdl::crossing::reset_sync::RESET_CYCLES;
use edof_network::FixedNetwork;
use edof_network::network::{Recurrence, Shrinkage};
use edof_verilog::describe::Circuit;
use rust_hdl::prelude::*;

ported!(BaseRing, Counters, DenseOperands, DenseStore, Difference, Drain, PairOperands, PairStore, Registers);
ported!(Reader, Requantize, Results, Sequencer, Shrink, Stage, WindowGuard, WindowRing);
ported!(LeavesTop, RamTop, FifoTop, MaccTop, CheckTop);

/// The leaves `edof_delay` and `edof_add` in a module of their own.
#[derive(Circuit)]
#[circuit(default)]
struct LeavesTop {
    pub clock: Signal<In, Clock>,
    pub data: Signal<In, Bits<7>>,
    pub one_delayed: Signal<Out, Bits<7>>,
    pub five_delayed: Signal<Out, Bits<7>>,
    pub a: Signal<In, Bits<48>>,
    pub b: Signal<In, Bits<48>>,
    pub sum: Signal<Out, Bits<48>>,
    one: Delay<7, 1>,
    five: Delay<7, 5>,
    add: Add,
}

impl Logic for LeavesTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.one.clock.next = self.clock.val();
        self.one.data.next = self.data.val();
        self.one_delayed.next = self.one.delayed.val();
        self.five.clock.next = self.clock.val();
        self.five.data.next = self.data.val();
        self.five_delayed.next = self.five.delayed.val();
        self.add.clock.next = self.clock.val();
        self.add.a.next = self.a.val();
        self.add.b.next = self.b.val();
        self.sum.next = self.add.sum.val();
    }
}

/// Checks of frames of two widths, each in a module of its own.
#[derive(Circuit)]
struct CheckTop {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub valid: Signal<In, Bit>,
    pub data: Signal<In, Bits<32>>,
    pub snapshot: Signal<In, Bit>,
    pub narrow_crc: Signal<Out, Bits<32>>,
    pub narrow_frames: Signal<Out, Bits<8>>,
    pub wide_crc: Signal<Out, Bits<32>>,
    pub wide_frames: Signal<Out, Bits<8>>,
    narrow: FrameCheck,
    wide: FrameCheck,
}

impl Logic for CheckTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.narrow.clock.next = self.clock.val();
        self.narrow.reset.next = self.reset.val();
        self.narrow.valid.next = self.valid.val();
        self.narrow.data.next = self.data.val();
        self.narrow.snapshot.next = self.snapshot.val();
        self.narrow_crc.next = self.narrow.crc.val();
        self.narrow_frames.next = self.narrow.frames.val();
        self.wide.clock.next = self.clock.val();
        self.wide.reset.next = self.reset.val();
        self.wide.valid.next = self.valid.val();
        self.wide.data.next = self.data.val();
        self.wide.snapshot.next = self.snapshot.val();
        self.wide_crc.next = self.wide.crc.val();
        self.wide_frames.next = self.wide.frames.val();
    }
}

#[test]
fn frame_check() {
    let top =
        CheckTop::from_parts(CheckTopParts { narrow: FrameCheck::new(16, 2), wide: FrameCheck::new(32, 7) });
    agree(top, RESET as usize, &[], |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 24) == 0;
        b.valid.next = bit(draw);
        b.data.next = word(draw);
        b.snapshot.next = draw.whole(0, 9) == 0;
    });
}

#[test]
fn delay_and_add() {
    agree(LeavesTop::default(), 9, &[], |b, draw, _| {
        b.data.next = word(draw);
        b.a.next = if bit(draw) { word(draw) } else { any_sum(draw) };
        b.b.next = if bit(draw) { word(draw) } else { any_sum(draw) };
    });
}

#[test]
fn difference() {
    for bits in [16, 11] {
        agree(Difference::new(bits), 5, &[], move |b, draw, _| {
            b.current.next = extreme(draw, bits);
            b.previous.next = extreme(draw, bits);
        });
    }
}

#[test]
fn shrink() {
    for (shrinkage, bits) in
        Shrinkage::ALL.into_iter().flat_map(|shrinkage| [(shrinkage, 16), (shrinkage, 9)])
    {
        agree(Shrink::new(shrinkage, bits), 5, &[], move |b, draw, _| {
            b.code.next = extreme(draw, bits);
            b.threshold.next = extreme(draw, bits);
        });
    }
}

#[test]
fn requantize() {
    for (bits, has_base) in [(16, true), (16, false), (10, true)] {
        agree(Requantize::new(bits, has_base), 14, &[], |b, draw, _| {
            b.sum.next = any_sum(draw);
            b.base.next = extreme(draw, 16);
            b.base_shift.next = (draw.whole(0, 31) as u64).into();
            b.result_shift.next = (draw.whole(0, 47) as u64).into();
        });
    }
}

#[test]
fn counters() {
    agree(Counters::default(), RESET as usize, &[], |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 300) == 0;
        b.enable.next = bit(draw);
        b.nonzero.next = word(draw);
        b.results.next = word(draw);
        b.codes.next = word(draw);
        b.differences.next = word(draw);
        b.select.next = word(draw);
        b.snapshot.next = draw.whole(0, 60) == 0;
    });
}

#[test]
fn reader() {
    // From the first command on all is known.
    agree(Reader::new(), RESET as usize + 5, &[], |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 400) == 0;
        b.starts.next = last.cycle == RESET + 2 || last.cycle > RESET && draw.whole(0, 300) == 0;
        b.command.next = (draw.bits() >> 44 << 12 | draw.whole(0, 2) as u64).into();
        b.grant.next = last.is("request_weights") && draw.whole(0, 3) == 0;
        b.weights.next = if draw.whole(0, 100) == 0 { word(draw) } else { 0.into() };
        b.thresholds_valid.next = last.is("request_thresholds") && draw.whole(0, 30) == 0;
        b.thresholds.next = word(draw);
        b.previous.next = word(draw);
        b.register.next = word(draw);
        b.select.next = word(draw);
    });
}

#[test]
fn window_guard() {
    let stage = committed("tiny").stage(0);
    let beats = stage.beats_in() as i64;
    let qualified = [("out_data", "out_valid"), ("out_last", "out_valid"), ("out_set", "out_valid")];
    let mut left = 0;
    agree(WindowGuard::new(&stage), RESET as usize, &qualified, move |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 700) == 0;
        b.reset_counters.next = last.cycle < RESET || draw.whole(0, 700) == 0;
        b.snapshot.next = draw.whole(0, 300) == 0;
        if last.all(&["valid", "ready"]) || !last.is("valid") {
            // Half of all windows are too short or too long.
            if left == 0 {
                left = if bit(draw) { beats } else { draw.whole(1, 2 * beats) };
                b.set.next = bit(draw);
            }
            b.valid.next = last.cycle > RESET && draw.whole(0, 3) > 0;
            left -= i64::from(b.valid.next);
            b.last.next = left == 0;
            b.data.next = word(draw);
        }
        b.out_ready.next = draw.whole(0, 3) > 0;
    });
}

#[test]
fn registers() {
    let shifts = [3, 9].map(|result| Shifts { result, base: 5, code: 2, linear: 7 });
    let text = shifts.map(|shifts| format!("{:05x}\n", shifts.word())).concat();
    let (image, images) = ("mem/shifts.mem".to_owned(), [("mem/shifts.mem".to_owned(), text)]);
    agree_with_images(Registers::new(image, shifts, true), RESET as usize, &[], &images, |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 100) == 0;
        b.write_enable.next = bit(draw);
        b.write_row.next = (draw.whole(0, 4) as u64).into();
        b.write_data.next = word(draw);
    });
}

/// A vector's beats as they come and a store's slots as they are freed: for stores of M and I.
macro_rules! drive_store {
    ($b:ident, $draw:ident, $last:ident, $beats:expr) => {
        $b.reset.next = resets($last, $draw);
        let beat = $last.count(|last| last.all(&["valid", "ready"]) && !last.is("reset"));
        let freed = $last.count_too(|last| last.is("finished"));
        let whole = $last.count_of("whole", |last| last.is("arrived"));
        $b.valid.next = $last.cycle > RESET && $draw.whole(0, 3) > 0;
        $b.last.next = beat % $beats == $beats - 1;
        $b.set.next = (beat / $beats) % 3 == 0;
        $b.read_row.next =
            (128 * $draw.whole(0, 3) as u64 + $draw.whole(0, $beats as i64 / 4 - 1) as u64).into();
        // All slots fill before anything is compared.
        $b.finished.next = whole > freed && $last.cycle > 300 && $draw.whole(0, 9) == 0;
    };
}

#[test]
fn pair_store() {
    let mut single = committed("tiny");
    single.stages[1].rows = 1;
    for stage in [committed("tiny").stage(1), single.stage(1)] {
        let (beats, mut skip) = (stage.beats_in() as u64, false);
        // Zeros are left out only after every row was written.
        agree(PairStore::new(&stage), 400, &[], move |b, draw, last| {
            drive_store!(b, draw, last, beats);
            skip = if last.cycle % 100 == 0 { last.cycle > 400 && bit(draw) } else { skip };
            b.skip_zeros.next = skip;
            b.even.next = sparse(draw);
            b.odd.next = sparse(draw);
        });
    }
}

#[test]
fn dense_store() {
    for rows in [1, 2, 4] {
        let mut design = committed("tiny");
        design.stages[0].rows = rows;
        let stage = design.stage(0);
        let beats = stage.beats_in() as u64;
        agree(DenseStore::new(&stage, true), 600, &[], move |b, draw, last| {
            drive_store!(b, draw, last, beats);
            b.read_row.next = (128 * draw.whole(0, 3) as u64
                + draw.whole(0, (beats / rows as u64) as i64 - 1) as u64)
                .into();
            b.data.next = word(draw);
        });
    }
}

#[test]
fn window_ring() {
    let mut deep = committed("tiny");
    deep.form.layers = 6;
    deep.stages.insert(1, deep.stages[1]);
    deep.stages.insert(1, deep.stages[1]);
    for (stage, filled) in [(committed("tiny").stage(3), 1200), (deep.stage(5), 2500)] {
        window_ring_of(&stage, filled);
    }
}

/// A ring that is full after N cycles.
fn window_ring_of(stage: &StagePlan, filled: u64) {
    let (beats, places) = (stage.linear as u64 / 2, stage.kept_windows as u64);
    assert!(beats * places < filled);
    agree(WindowRing::new(stage), RESET as usize + filled as usize + 300, &[], move |b, draw, last| {
        b.reset.next = resets(last, draw);
        let beat = last.count(|last| last.all(&["valid", "ready"]) && !last.is("reset"));
        let freed = last.count_too(|last| last.is("finished"));
        b.valid.next = last.cycle > RESET && draw.whole(0, 9) > 0;
        b.last.next = beat % beats == beats - 1;
        b.pixels.next = word(draw);
        b.read_pair.next = (draw.whole(0, beats as i64 - 1) as u64).into();
        // The memory fills before anything is compared.
        b.finished.next = beat / beats > freed
            && (beat / beats > places / 2 || last.cycle > filled + 200)
            && last.cycle > filled
            && draw.whole(0, 30) == 0;
    });
}

#[test]
fn base_ring() {
    let stage = committed("tiny").stage(1);
    let depth = 7 * stage.beats_in() as u64;
    agree(BaseRing::new(&stage), 250, &[], move |b, draw, last| {
        b.reset.next = resets(last, draw);
        let held = last.count(|last| last.is("write")) - last.count_too(|last| last.is("read"));
        b.write.next = last.cycle > RESET && held < depth && bit(draw);
        b.words.next = word(draw);
        b.read.next = held > 2 && last.cycle > 230 && bit(draw);
    });
}

#[test]
fn drain() {
    for stage in committed("tiny").stages() {
        let (mut under_way, mut begun) = (0, 0);
        agree(Drain::new(&stage), 3 * RESET as usize, &[], move |b, draw, last| {
            b.reset.next = resets(last, draw);
            let outside =
                last.count(|last| last.is("take")) - last.count_too(|last| last.is("credit_return"));
            // A pass begins when one may, and its last step is issued some cycles later.
            let released = last.count_of("released", |last| last.is("release"));
            let begins = last.cycle > 2 * RESET && under_way == 0 && begun < released + 2 && bit(draw);
            b.pass_issued.next = under_way == 1;
            under_way = if begins { draw.whole(1, 12) } else { (under_way - 1).max(0) };
            begun += u64::from(begins);
            if b.reset.next {
                (under_way, begun) = (0, 0);
            }
            b.set.next = bit(draw);
            b.credit_return.next = outside > 0 && draw.whole(0, 3) > 0;
        });
    }
}

#[test]
fn sequencer() {
    // I and M of tiny; F with a linear path, in two rows and in one.
    let mut single = committed("tiny");
    single.stages[3].rows = 1;
    let (tiny, single) = (committed("tiny"), single);
    for stage in [tiny.stage(0), tiny.stage(1), tiny.stage(3), single.stage(3)] {
        let steps = stage.inputs as i64 / stage.rows as i64;
        agree(Sequencer::new(&stage), 3 * RESET as usize, &[], move |b, draw, last| {
            b.reset.next = resets(last, draw);
            let held = last.count(|last| last.is("arrived")) - last.count_too(|last| last.is("finished"));
            b.arrived.next = last.cycle > RESET && held < 4 && bit(draw);
            let before_last = if bit(draw) { draw.whole(0, 2) } else { draw.whole(0, steps - 1) } as u64;
            let single = u64::from(before_last == 0);
            let (empty, odd) = (single & draw.bits() & 1, draw.bits() & 1);
            let set = draw.bits() & 1;
            b.descriptor.next =
                (before_last << 4 | single << 3 | empty << 2 | (odd | empty) << 1 | set).into();
            let open = last.count_of("begun", |last| last.is("first"))
                - last.count_of("released", |last| last.is("release"));
            b.release.next = open > 0 && draw.whole(0, 3) > 0;
            b.steal_next.next = draw.whole(0, 5) == 0;
        });
    }
}

#[test]
fn pair_operands() {
    let mut single = committed("tiny");
    single.stages[3].rows = 1;
    for stage in [committed("tiny").stage(1), committed("tiny").stage(3), single.stage(3)] {
        agree(PairOperands::new(&stage), 8, &[], |b, draw, _| {
            b.valid_a.next = draw.whole(0, 3) > 0;
            b.valid_b.next = draw.whole(0, 3) > 0;
            b.first.next = bit(draw);
            b.linear.next = bit(draw);
            b.odd.next = bit(draw);
            b.set.next = bit(draw);
            b.base.next = word(draw);
            b.offset.next = word(draw);
            b.even_pair.next = word(draw);
            b.odd_pair.next = word(draw);
            b.pixels.next = word(draw);
            let shifts = |draw: &mut Draw| (draw.whole(0, 9) | draw.whole(0, 9) << 4) as u64;
            b.shifts_0.next = shifts(draw).into();
            b.shifts_1.next = shifts(draw).into();
        });
    }
}

#[test]
fn dense_operands() {
    agree(DenseOperands::new(true), 8, &[], |b, draw, _| {
        b.valid.next = draw.whole(0, 3) > 0;
        b.first.next = bit(draw);
        b.odd.next = bit(draw);
        b.base.next = word(draw);
        b.offset.next = word(draw);
        b.pair_a.next = word(draw);
        b.pair_b.next = word(draw);
        b.pair_c.next = word(draw);
        b.pair_d.next = word(draw);
    });
}

#[test]
fn results() {
    let mut difference = committed("tiny");
    difference.form.recurrence = Recurrence::Difference;
    for (design, stage) in
        [(committed("tiny"), 0), (committed("tiny"), 1), (difference, 1), (committed("tiny"), 3)]
    {
        let plan = design.stage(stage);
        let sets = networks(&design, 1);
        let images = images(&design, &sets);
        let (beats, depth) = (plan.beats_out() as u64, 7 * plan.beats_in() as u64);
        let block = Results::new(&design, &plan, [&sets[0], &sets[1]]);
        agree_with_images(block, 300, &[], &images, move |b, draw, last| {
            b.reset.next = resets(last, draw);
            let held = last.count(|last| last.is("base_write")) - last.count_too(|last| last.is("take"));
            let taken = last.count_of("taken", |last| last.is("take"));
            b.base_write.next = last.cycle > RESET && held < depth && draw.whole(0, 3) > 0;
            b.base_words.next = word(draw);
            b.take.next = held > 8 && last.cycle > 230 && draw.whole(0, 3) > 0;
            b.beat.next = (taken % beats).into();
            b.last.next = taken % beats == beats - 1;
            b.set.next = taken / beats % 2 == 1;
            b.sum_even.next = any_sum(draw);
            b.sum_odd.next = any_sum(draw);
            if last.cycle % 64 == 0 {
                b.shifts_0.next = shifts(draw);
                b.shifts_1.next = shifts(draw);
            }
            b.write_thresholds.next = draw.whole(0, 20) == 0;
            b.write_previous.next = draw.whole(0, 20) == 0;
            b.write_row.next = (draw.whole(0, 2 * beats as i64 - 1) as u64).into();
            b.write_data.next = word(draw);
            b.read_wanted.next = bit(draw);
            b.read_row.next = row(draw, 2 * beats as i64);
        });
    }
}

/// The leaf `edof_ram` in a module of its own.
#[derive(Circuit)]
struct RamTop {
    pub clock: Signal<In, Clock>,
    pub read_address: Signal<In, Bits<12>>,
    pub read_data: Signal<Out, Bits<25>>,
    pub write_enable: Signal<In, Bit>,
    pub write_address: Signal<In, Bits<12>>,
    pub write_data: Signal<In, Bits<25>>,
    ram: Ram<25>,
}

impl Logic for RamTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.ram.clock.next = self.clock.val();
        self.ram.read_address.next = self.read_address.val();
        self.ram.write_enable.next = self.write_enable.val();
        self.ram.write_address.next = self.write_address.val();
        self.ram.write_data.next = self.write_data.val();
        self.read_data.next = self.ram.read_data.val();
    }
}

#[test]
fn ram() {
    let contents: Vec<u64> = (0..24).map(|row| row * 0x01_2345 % 0x1ff_ffff).collect();
    let image: String = contents.iter().map(|word| format!("{word:07x}\n")).collect();
    for shape in [Shape::distributed(24), Shape::block(24), Shape::registered(24)] {
        let shape = Shape { image: Some("mem/ram.mem".into()), ..shape };
        let top = RamTop::from_parts(RamTopParts { ram: Ram::new(shape, &contents) });
        let images = [("mem/ram.mem".to_string(), image.clone())];
        agree_with_images(top, 3, &[], &images, |b, draw, _| {
            b.read_address.next = (draw.whole(0, 23) as u64).into();
            b.write_address.next = (draw.whole(0, 23) as u64).into();
            b.write_enable.next = bit(draw);
            b.write_data.next = word(draw);
        });
    }
}

/// The leaf `edof_fifo` in a module of its own.
#[derive(Circuit)]
#[circuit(default)]
struct FifoTop {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub push: Signal<In, Bit>,
    pub data: Signal<In, Bits<34>>,
    pub valid: Signal<Out, Bit>,
    pub ready: Signal<In, Bit>,
    pub front: Signal<Out, Bits<34>>,
    fifo: Fifo<34>,
}

impl Logic for FifoTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.fifo.clock.next = self.clock.val();
        self.fifo.reset.next = self.reset.val();
        self.fifo.push.next = self.push.val();
        self.fifo.data.next = self.data.val();
        self.fifo.front_ready.next = self.ready.val();
        self.valid.next = self.fifo.front_valid.val();
        self.front.next = self.fifo.front_data.val();
    }
}

#[test]
fn fifo() {
    agree(FifoTop::default(), RESET as usize, &[("front", "valid")], |b, draw, last| {
        b.reset.next = resets(last, draw);
        let pushed = last.count(|last| last.is("push"));
        let taken = last.count_too(|last| last.all(&["valid", "ready"]) && !last.is("reset"));
        // Who pushes knows that there is room; for a while nobody takes, for a while nobody pushes.
        let full = last.cycle / 300 % 3;
        b.push.next = last.cycle > RESET && pushed - taken < 128 && (full != 2 && bit(draw) || full == 1);
        b.ready.next = last.cycle > RESET && full != 1 && bit(draw);
        b.data.next = word(draw);
    });
}

/// The leaf `edof_macc_array` in a module of its own.
#[derive(Circuit)]
struct MaccTop {
    pub clock: Signal<In, Clock>,
    pub first: Signal<In, Bit>,
    pub address_a: Signal<In, Bits<12>>,
    pub address_b: Signal<In, Bits<12>>,
    pub value_a: Signal<In, Bits<25>>,
    pub value_b: Signal<In, Bits<25>>,
    pub value_c: Signal<In, Bits<25>>,
    pub value_d: Signal<In, Bits<25>>,
    pub copy: Signal<In, Bit>,
    pub shift: Signal<In, Bit>,
    pub sum_even: Signal<Out, Bits<48>>,
    pub sum_odd: Signal<Out, Bits<48>>,
    pub write_enable: Signal<In, Bit>,
    pub write_bank: Signal<In, Bits<6>>,
    pub write_half: Signal<In, Bit>,
    pub write_row: Signal<In, Bits<12>>,
    pub write_data: Signal<In, Bits<32>>,
    pub read_enable: Signal<In, Bit>,
    pub read_data: Signal<Out, Bits<64>>,
    macc: MaccArray,
}

impl Logic for MaccTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.macc.clock.next = self.clock.val();
        self.macc.first.next = self.first.val();
        self.macc.address_a.next = self.address_a.val();
        self.macc.address_b.next = self.address_b.val();
        self.macc.value_a.next = self.value_a.val();
        self.macc.value_b.next = self.value_b.val();
        self.macc.value_c.next = self.value_c.val();
        self.macc.value_d.next = self.value_d.val();
        self.macc.copy.next = self.copy.val();
        self.macc.shift.next = self.shift.val();
        self.sum_even.next = self.macc.sum_even.val();
        self.sum_odd.next = self.macc.sum_odd.val();
        self.macc.write_enable.next = self.write_enable.val();
        self.macc.write_bank.next = self.write_bank.val();
        self.macc.write_half.next = self.write_half.val();
        self.macc.write_row.next = self.write_row.val();
        self.macc.write_data.next = self.write_data.val();
        self.macc.read_enable.next = self.read_enable.val();
        self.read_data.next = self.macc.read_data.val();
    }
}

#[test]
fn macc_array() {
    // Dense rows of four, two and one words, of which one more bit of the row says which; both ports; one port; three groups of banks, one of
    // which is not full. Two widths of sums.
    let forms = [
        (0, 16, 4, 48),
        (0, 16, 2, 40),
        (0, 16, 1, 48),
        (1, 8, 2, 40),
        (2, 8, 1, 48),
        (3, 80, 2, 40),
        (3, 80, 1, 48),
    ];
    for (index, lanes, rows, sum_bits) in forms {
        let mut design = committed("tiny");
        design.stages[index].rows = rows;
        design.stages[index].lanes = lanes;
        let (stage, sets) = (design.stage(index), networks(&design, 1));
        let (depth, parts) = (stage.weight_depth() as i64, stage.row_words() as i64);
        let top = MaccTop::from_parts(MaccTopParts {
            macc: MaccArray::new(&stage, sum_bits, [&sets[0], &sets[1]]),
        });
        agree_with_images(top, 160, &[], &images(&design, &sets), move |b, draw, last| {
            // Work, with a sum that starts anew now and then; in a cycle without work a row may be written.
            let works = draw.whole(0, 3) > 0;
            let value = |draw: &mut Draw| if works { word(draw) } else { 0.into() };
            b.first.next = draw.whole(0, 7) == 0;
            b.address_a.next = row(draw, depth);
            b.address_b.next = row(draw, depth);
            b.value_a.next = value(draw);
            b.value_b.next = value(draw);
            b.value_c.next = value(draw);
            b.value_d.next = value(draw);
            b.copy.next = draw.whole(0, 9) == 0;
            b.shift.next = bit(draw);
            b.write_enable.next = last.cycle > 20 && !works && bit(draw);
            b.read_enable.next = last.cycle > 20 && !b.write_enable.next && draw.whole(0, 4) == 0;
            b.write_bank.next = (draw.whole(0, stage.banks() as i64) as u64).into();
            b.write_half.next = bit(draw);
            let part = draw.whole(0, parts - 1) as u64;
            b.write_row.next = ((draw.whole(0, depth - 1) as u64) << memory::row_bits(&stage) | part).into();
            b.write_data.next = word(draw);
        });
    }
}

#[test]
fn stage() {
    let mut difference = committed("tiny");
    difference.form.recurrence = Recurrence::Difference;
    let (tiny, twice) = (committed("tiny"), difference);
    for (design, index) in [(&tiny, 0), (&tiny, 1), (&twice, 1), (&twice, 2), (&tiny, 3)] {
        let (plan, sets) = (design.stage(index), networks(design, 1));
        let (beats, pixels) = (plan.beats_in() as u64, plan.linear as u64 / 2);
        let block = Stage::new(design, &plan, [&sets[0], &sets[1]]);
        let qualified = ["out_data", "out_base", "out_last", "out_set"].map(|port| (port, "out_valid"));
        let mut rests = 0;
        agree_with_images(block, RESET as usize, &qualified, &images(design, &sets), move |b, draw, last| {
            // A reset lasts until all words in flight have come.
            rests =
                if last.cycle > RESET && resets(last, draw) { RESET_CYCLES } else { rests.saturating_sub(1) };
            b.reset.next = last.cycle < RESET || rests > 0;
            b.flush.next = false;
            let busy = last.cycle > RESET + 2 && rests == 0;
            let beat = last.count(|last| last.all(&["valid", "ready"]) && !last.is("reset"));
            let pixel =
                last.count_too(|last| last.all(&["window_valid", "window_ready"]) && !last.is("reset"));
            // Valid never falls without a transfer; F gets a window before its codes.
            let stands = last.is("valid") && !last.is("ready");
            let has_window = pixels == 0 || pixel / pixels > beat / beats;
            if !stands {
                b.valid.next = busy && has_window && draw.whole(0, 3) > 0;
                b.data.next = if bit(draw) { word(draw) } else { (draw.bits() & 0xffff).into() };
                b.base.next = word(draw);
                b.last.next = beat % beats == beats - 1;
                b.set.next = beat / beats % 3 == 0;
            }
            if pixels > 0 && (last.is("window_ready") || !last.is("window_valid")) {
                b.window_valid.next = busy && draw.whole(0, 3) > 0;
                b.window_data.next = (draw.bits() & 0x7fff_7fff).into();
                b.window_last.next = pixel % pixels == pixels - 1;
            }
            b.out_ready.next = draw.whole(0, 9) > (last.cycle as i64 / 200) % 10;
            // A write never waits; those of M's weights take a cycle each.
            b.write_valid.next = busy && draw.whole(0, 9) == 0;
            let stage = draw.whole(plan.index as i64 - 1, plan.index as i64).max(0) as usize;
            let space = Space::Weights {
                bank: draw.whole(0, plan.banks() as i64 - 1) as usize,
                row: draw.whole(0, ((plan.weight_depth() as i64) << memory::row_bits(&plan)) - 1) as usize,
                half: draw.whole(0, 1) as usize,
            };
            b.write_address.next = u64::from(memory::address(stage, space)).into();
            b.write_data.next = word(draw);
            // Now and then something is read back: weights, thresholds or a register, of rows that there are.
            if draw.whole(0, 49) == 0 {
                let register = Space::Register { row: reading::READ_REGISTER };
                let from = match draw.whole(0, 2) {
                    0 => space,
                    1 => Space::Thresholds { row: draw.whole(0, plan.beats_out() as i64) as usize },
                    _ => Space::Register { row: draw.whole(0, 2) as usize },
                };
                b.write_address.next = u64::from(memory::address(plan.index, register)).into();
                b.write_data.next = u64::from(reading::read_command(from, 1)).into();
            }
            b.status_address.next = word(draw);
        });
    }
}

/// The memory images of a design.
fn images(design: &Design, sets: &[FixedNetwork; 2]) -> Vec<(String, String)> {
    edof_hdl::project::images(design, [&sets[0], &sets[1]])
}

/// A word of `bits` bits in 16, often at the ends of its range.
fn extreme(draw: &mut Draw, bits: u32) -> Bits<16> {
    u64::from(draw.extreme(bits) as u16).into()
}

/// A word that is often 0.
fn sparse(draw: &mut Draw) -> Bits<16> {
    if bit(draw) { 0.into() } else { word(draw) }
}

/// A sum of any magnitude.
fn any_sum(draw: &mut Draw) -> Bits<48> {
    let shift = draw.whole(16, 63);
    (((draw.bits() as i64 >> shift) as u64) & 0xffff_ffff_ffff).into()
}

/// Shifts of a stage that adds a base.
fn shifts(draw: &mut Draw) -> Bits<20> {
    let shifts =
        Shifts { result: draw.whole(0, 40) as u32, base: draw.whole(0, 20) as u32, code: 3, linear: 1 };
    u64::from(shifts.word()).into()
}

fn row(draw: &mut Draw, rows: i64) -> Bits<12> {
    (draw.whole(0, rows - 1) as u64).into()
}
