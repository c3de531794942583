//! Every block, given the same stimulus in rust-hdl's simulation, in Verilator and in Icarus: the same outputs in every cycle.

mod common;
mod differential;
mod support;

use common::{committed, networks};
use differential::{agree, agree_with_images, bit, ported, word};
use edof_hdl::blocks::base_ring::BaseRing;
use edof_hdl::blocks::counters::Counters;
use edof_hdl::blocks::delay::Delay;
use edof_hdl::blocks::difference::Difference;
use edof_hdl::blocks::drain::Drain;
use edof_hdl::blocks::fifo::Fifo;
use edof_hdl::blocks::macc_array::MaccArray;
use edof_hdl::blocks::macc_bank::MaccBank;
use edof_hdl::blocks::pair_buffer::PairBuffer;
use edof_hdl::blocks::ram::{Ram, Shape};
use edof_hdl::blocks::registers::Registers;
use edof_hdl::blocks::requantize::Requantize;
use edof_hdl::blocks::results::Results;
use edof_hdl::blocks::sequencer::Sequencer;
use edof_hdl::blocks::shrink::Shrink;
use edof_hdl::blocks::stage::Stage;
use edof_hdl::blocks::window_ring::WindowRing;
use edof_hdl::describe::Circuit;
use edof_spec::design::memory::{self, Shifts, Space};
use edof_spec::draw::Draw;
use edof_spec::network::{Recurrence, Shrinkage};
use edof_spec::{Design, FixedNetwork};
use rust_hdl::prelude::*;

ported!(BaseRing, Counters, Difference, Drain, MaccArray, PairBuffer, Registers, Requantize, Results);
ported!(Sequencer, Shrink, Stage, WindowRing, Delay<7, 1>, Delay<3, 5>, RamTop, FifoTop, BankTop);

/// Cycles of reset at the start of every stimulus.
const RESET: u64 = 20;

#[test]
fn delay() {
    agree(Delay::<7, 1>::default(), 5, &[], |b, draw, _| b.now.next = word(draw));
    agree(Delay::<3, 5>::default(), 9, &[], |b, draw, _| b.now.next = word(draw));
}

#[test]
fn difference() {
    for bits in [16, 11] {
        agree(Difference::new(bits), 3, &[], move |b, draw, _| {
            b.now.next = extreme(draw, bits);
            b.before.next = extreme(draw, bits);
        });
    }
}

#[test]
fn shrink() {
    for (shrinkage, bits) in [(Shrinkage::OneSided, 16), (Shrinkage::TwoSided, 16), (Shrinkage::OneSided, 9)]
    {
        agree(Shrink::new(shrinkage, bits), 3, &[], move |b, draw, _| {
            b.code.next = extreme(draw, bits);
            b.threshold.next = extreme(draw, bits);
        });
    }
}

#[test]
fn requantize() {
    for (bits, has_base) in [(16, true), (16, false), (10, true)] {
        agree(Requantize::new(bits, has_base), 8, &[], |b, draw, _| {
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
    });
}

#[test]
fn registers() {
    let shifts = [3, 9].map(|result| Shifts { result, base: 5, code: 2, linear: 7 });
    agree(Registers::new(shifts, true), RESET as usize, &[], |b, draw, last| {
        b.reset.next = last.cycle < RESET || draw.whole(0, 100) == 0;
        b.write_enable.next = bit(draw);
        b.write_row.next = (draw.whole(0, 4) as u64).into();
        b.write_data.next = word(draw);
    });
}

#[test]
fn pair_buffer() {
    // A stage of 16 inputs. Both slots are filled once before anything is compared.
    agree(PairBuffer::new(&committed("tiny").stage(1)), 300, &[], |b, draw, last| {
        b.reset.next = last.cycle < RESET;
        b.skip_zeros.next = last.cycle > 300 && draw.whole(0, 200) > 100;
        let beat = last.count(|last| last.all(&["valid", "ready"]) && !last.is("reset"));
        b.valid.next = last.cycle > RESET && draw.whole(0, 3) > 0;
        b.last.next = beat % 8 == 7;
        b.set.next = (beat / 8) % 3 == 0;
        b.even.next = sparse(draw);
        b.odd.next = sparse(draw);
        b.read_pair.next = (draw.whole(0, 7) as u64).into();
        b.finished.next = last.cycle > RESET && b.available.val() && draw.whole(0, 9) == 0;
    });
}

#[test]
fn window_ring() {
    let stage = committed("tiny").stage(3);
    let beats = stage.linear as u64 / 2;
    agree(WindowRing::new(&stage), 900, &[], move |b, draw, last| {
        b.reset.next = last.cycle < RESET;
        let beat = last.count(|last| last.all(&["valid", "ready"]) && !last.is("reset"));
        let freed = last.count_too(|last| last.is("finished"));
        b.valid.next = last.cycle > RESET && draw.whole(0, 9) > 0;
        b.last.next = beat % beats == beats - 1;
        b.pixels.next = word(draw);
        b.read_pair.next = (draw.whole(0, beats as i64 - 1) as u64).into();
        b.finished.next = beat / beats > freed && last.cycle > 600 && draw.whole(0, 30) == 0;
    });
}

#[test]
fn base_ring() {
    let stage = committed("tiny").stage(1);
    let depth = 4 * stage.beats_in() as u64;
    agree(BaseRing::new(&stage), 200, &[], move |b, draw, last| {
        b.reset.next = last.cycle < RESET;
        let held = last.count(|last| last.is("write")) - last.count_too(|last| last.is("read"));
        b.write.next = last.cycle > RESET && held < depth && bit(draw);
        b.words.next = word(draw);
        b.read.next = held > 0 && last.cycle > 150 && bit(draw);
    });
}

#[test]
fn drain() {
    for stage in committed("tiny").stages() {
        agree(Drain::new(&stage), 60, &[], |b, draw, last| {
            b.reset.next = last.cycle < RESET;
            let outside = last.count(|last| last.is("take")) - last.count_too(|last| last.is("returned"));
            // A pass is issued in a cycle in which one may start.
            b.pass_issued.next = last.cycle > 2 * RESET && b.may_start.val() && draw.whole(0, 5) == 0;
            b.set.next = bit(draw);
            b.returned.next = outside > 0 && draw.whole(0, 3) > 0;
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
        let inputs = stage.inputs as i64;
        let (mut count, mut set) = (0, false);
        agree(Sequencer::new(&stage), 2 * RESET as usize, &[], move |b, draw, last| {
            b.reset.next = last.cycle < RESET;
            // Each vector keeps its count and set until it is finished.
            if last.is("finished") || last.cycle < RESET {
                count = if bit(draw) { draw.whole(0, 3) } else { draw.whole(0, inputs) };
                set = bit(draw);
                b.available.next = false;
            }
            b.available.next = last.cycle > RESET && (b.available.val() && !last.is("finished") || bit(draw));
            b.count.next = (count as u64).into();
            b.set.next = set;
            b.may_start.next = draw.whole(0, 3) > 0;
            b.code_shift.next = (draw.whole(0, 9) as u64).into();
            b.linear_shift.next = (draw.whole(0, 9) as u64).into();
            b.even_pair.next = word(draw);
            b.odd_pair.next = word(draw);
            b.pixels.next = word(draw);
        });
    }
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
        let (beats, depth) = (plan.beats_out() as u64, 4 * plan.beats_in() as u64);
        let block = Results::new(&design, &plan, [&sets[0], &sets[1]]);
        agree_with_images(block, 250, &[], &images, move |b, draw, last| {
            b.reset.next = last.cycle < RESET;
            let held = last.count(|last| last.is("base_write")) - last.count_too(|last| last.is("take"));
            let taken = last.count_of("taken", |last| last.is("take"));
            b.base_write.next = last.cycle > RESET && held < depth && draw.whole(0, 3) > 0;
            b.base_words.next = word(draw);
            b.take.next = held > 0 && last.cycle > 200 && draw.whole(0, 3) > 0;
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
    for block in [false, true] {
        let shape = Shape { depth: 24, block, image: Some("mem/ram.hex".into()) };
        let top = RamTop::from_parts(RamTopParts { ram: Ram::new(shape, &contents) });
        let images = [("mem/ram.hex".to_string(), image.clone())];
        agree_with_images(top, 1, &[], &images, |b, draw, _| {
            b.read_address.next = (draw.whole(0, 23) as u64).into();
            b.write_address.next = (draw.whole(0, 23) as u64).into();
            b.write_enable.next = bit(draw);
            b.write_data.next = word(draw);
        });
    }
}

/// The leaf `edof_fifo` in a module of its own.
#[derive(Circuit)]
struct FifoTop {
    pub clock: Signal<In, Clock>,
    pub reset: Signal<In, Bit>,
    pub push: Signal<In, Bit>,
    pub data: Signal<In, Bits<32>>,
    pub base: Signal<In, Bits<32>>,
    pub last: Signal<In, Bit>,
    pub set: Signal<In, Bit>,
    pub valid: Signal<Out, Bit>,
    pub ready: Signal<In, Bit>,
    pub front_data: Signal<Out, Bits<32>>,
    pub front_base: Signal<Out, Bits<32>>,
    pub front_last: Signal<Out, Bit>,
    pub front_set: Signal<Out, Bit>,
    fifo: Fifo,
}

impl Logic for FifoTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.fifo.clock.next = self.clock.val();
        self.fifo.reset.next = self.reset.val();
        self.fifo.push.next = self.push.val();
        self.fifo.data.next = self.data.val();
        self.fifo.base.next = self.base.val();
        self.fifo.last.next = self.last.val();
        self.fifo.set.next = self.set.val();
        self.fifo.front_ready.next = self.ready.val();
        self.valid.next = self.fifo.front_valid.val();
        self.front_data.next = self.fifo.front_data.val();
        self.front_base.next = self.fifo.front_base.val();
        self.front_last.next = self.fifo.front_last.val();
        self.front_set.next = self.fifo.front_set.val();
    }
}

#[test]
fn fifo() {
    for base in [false, true] {
        let top = FifoTop::from_parts(FifoTopParts { fifo: Fifo::new(base) });
        let qualified = ["front_data", "front_base", "front_last", "front_set"].map(|port| (port, "valid"));
        agree(top, RESET as usize, &qualified, |b, draw, last| {
            b.reset.next = last.cycle < RESET;
            let pushed = last.count(|last| last.is("push"));
            let taken = last.count_too(|last| last.all(&["valid", "ready"]) && !last.is("reset"));
            // Who pushes knows that there is room; for a while nobody takes, for a while nobody pushes.
            let full = last.cycle / 50 % 3;
            b.push.next = last.cycle > RESET && pushed - taken < 16 && (full != 2 && bit(draw) || full == 1);
            b.ready.next = last.cycle > RESET && full != 1 && bit(draw);
            b.data.next = word(draw);
            b.base.next = word(draw);
            b.last.next = bit(draw);
            b.set.next = bit(draw);
        });
    }
}

/// The leaf `edof_macc_bank` in a module of its own.
#[derive(Circuit)]
struct BankTop {
    pub clock: Signal<In, Clock>,
    pub first: Signal<In, Bit>,
    pub address_a: Signal<In, Bits<12>>,
    pub value_a: Signal<In, Bits<25>>,
    pub address_b: Signal<In, Bits<12>>,
    pub value_b: Signal<In, Bits<25>>,
    pub copy: Signal<In, Bit>,
    pub shift: Signal<In, Bit>,
    pub drain_even_in: Signal<In, Bits<48>>,
    pub drain_odd_in: Signal<In, Bits<48>>,
    pub drain_even: Signal<Out, Bits<48>>,
    pub drain_odd: Signal<Out, Bits<48>>,
    pub write_enable: Signal<In, Bit>,
    pub bank: Signal<In, Bits<6>>,
    pub write_bank: Signal<In, Bits<6>>,
    pub write_half: Signal<In, Bit>,
    pub write_row: Signal<In, Bits<12>>,
    pub write_data: Signal<In, Bits<32>>,
    macc: MaccBank,
}

impl Logic for BankTop {
    #[hdl_gen]
    fn update(&mut self) {
        self.macc.clock.next = self.clock.val();
        self.macc.first.next = self.first.val();
        self.macc.address_a.next = self.address_a.val();
        self.macc.value_a.next = self.value_a.val();
        self.macc.address_b.next = self.address_b.val();
        self.macc.value_b.next = self.value_b.val();
        self.macc.copy.next = self.copy.val();
        self.macc.shift.next = self.shift.val();
        self.macc.drain_even_in.next = self.drain_even_in.val();
        self.macc.drain_odd_in.next = self.drain_odd_in.val();
        self.drain_even.next = self.macc.drain_even.val();
        self.drain_odd.next = self.macc.drain_odd.val();
        self.macc.write_enable.next = self.write_enable.val();
        self.macc.bank.next = self.bank.val();
        self.macc.write_bank.next = self.write_bank.val();
        self.macc.write_half.next = self.write_half.val();
        self.macc.write_row.next = self.write_row.val();
        self.macc.write_data.next = self.write_data.val();
    }
}

#[test]
fn macc_bank() {
    for (index, sum_bits) in [(0, 48), (1, 48), (2, 40)] {
        let design = committed("tiny");
        let (stage, sets) = (design.stage(index), networks(&design, 1));
        let words = sets.iter().flat_map(|network| memory::weight_words(network, &stage, 1)).collect();
        let top = BankTop::from_parts(BankTopParts { macc: MaccBank::new(&stage, 1, sum_bits, words) });
        let rows = stage.weight_depth() as i64;
        agree_with_images(top, 120, &[], &images(&design, &sets), move |b, draw, last| {
            // Work, with a sum that starts anew now and then; in a cycle without work a row may be written.
            let works = draw.whole(0, 3) > 0;
            let value = |draw: &mut Draw| if works { word(draw) } else { 0.into() };
            b.first.next = draw.whole(0, 7) == 0;
            b.address_a.next = row(draw, rows);
            b.address_b.next = row(draw, rows);
            b.value_a.next = value(draw);
            b.value_b.next = value(draw);
            b.copy.next = draw.whole(0, 5) == 0;
            b.shift.next = bit(draw);
            b.drain_even_in.next = any_sum(draw);
            b.drain_odd_in.next = any_sum(draw);
            b.bank.next = 5.into();
            b.write_enable.next = last.cycle > 20 && !works && bit(draw);
            b.write_bank.next = (draw.whole(4, 5) as u64).into();
            b.write_half.next = bit(draw);
            b.write_row.next = row(draw, rows);
            b.write_data.next = word(draw);
        });
    }
}

#[test]
fn macc_array() {
    let design = committed("tiny");
    for (index, sum_bits) in [(0, 48), (1, 40)] {
        let (stage, sets) = (design.stage(index), networks(&design, 1));
        let rows = stage.weight_depth() as i64;
        let block = MaccArray::new(&stage, sum_bits, [&sets[0], &sets[1]]);
        agree_with_images(block, 120, &[], &images(&design, &sets), move |b, draw, _| {
            let works = draw.whole(0, 3) > 0;
            let value = |draw: &mut Draw| if works { word(draw) } else { 0.into() };
            b.first.next = draw.whole(0, 7) == 0;
            b.address_a.next = row(draw, rows);
            b.address_b.next = row(draw, rows);
            b.value_a.next = value(draw);
            b.value_b.next = value(draw);
            b.copy.next = draw.whole(0, 9) == 0;
            b.shift.next = bit(draw);
            b.write_enable.next = !works && bit(draw);
            b.write_bank.next = (draw.whole(0, stage.banks() as i64) as u64).into();
            b.write_half.next = bit(draw);
            b.write_row.next = row(draw, rows);
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
        agree_with_images(block, RESET as usize, &qualified, &images(design, &sets), move |b, draw, last| {
            b.reset.next = last.cycle < RESET;
            let busy = last.cycle > RESET;
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
            if !last.is("write_valid") || last.is("write_ready") {
                b.write_valid.next = busy && draw.whole(0, 9) == 0;
                let stage = draw.whole(plan.index as i64 - 1, plan.index as i64).max(0) as usize;
                let space = Space::Weights {
                    bank: draw.whole(0, plan.banks() as i64 - 1) as usize,
                    row: draw.whole(0, plan.weight_depth() as i64 - 1) as usize,
                    half: draw.whole(0, 1) as usize,
                };
                b.write_address.next = u64::from(memory::address(stage, space)).into();
                b.write_data.next = word(draw);
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
