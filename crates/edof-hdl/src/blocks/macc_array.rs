//! Leaf `edof_macc_array`: all multipliers of a stage and their weights.

use super::{Row, Sum};
use crate::describe::Circuit;
use crate::leaves::leaf;
use edof_device::design::{BANK_LANES, StagePlan, memory};
use edof_network::FixedNetwork;
use rust_hdl::prelude::*;
use std::collections::VecDeque;

/// Every bank sees the same addresses and values; everything passes from the highest group of banks to the lowest, sums too, and leaves at bank 0. See `rtl/edof_macc_array.v` and
/// `rtl/edof_macc_bank.v` for the exact cycles.
#[derive(Circuit)]
pub struct MaccArray {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// The step is the first of its pass.
    pub first: Signal<In, Bit>,
    /// Row of weights.
    pub address_a: Signal<In, Row>,
    /// Row of weights at the second port.
    pub address_b: Signal<In, Row>,
    /// Value of the first row; 0 where there is no work.
    pub value_a: Signal<In, Bits<25>>,
    /// Of the second.
    pub value_b: Signal<In, Bits<25>>,
    /// Of the third.
    pub value_c: Signal<In, Bits<25>>,
    /// Of the fourth.
    pub value_d: Signal<In, Bits<25>>,
    /// Copies the sums.
    pub copy: Signal<In, Bit>,
    /// Hands two on.
    pub shift: Signal<In, Bit>,
    /// The two that were first 7 cycles and as many as there are groups ago.
    pub sum_even: Signal<Out, Sum>,
    /// The odd one.
    pub sum_odd: Signal<Out, Sum>,
    /// Writes half a word of one bank.
    pub write_enable: Signal<In, Bit>,
    /// Which bank.
    pub write_bank: Signal<In, Bits<6>>,
    /// Which half: lanes 0 and 1, or 2 and 3.
    pub write_half: Signal<In, Bit>,
    /// Row, and which of its words in the lowest bits.
    pub write_row: Signal<In, Row>,
    /// Two weights.
    pub write_data: Signal<In, Bits<32>>,
    /// Reads that row of that bank for the host, in place of the step's; not in a cycle of a write.
    pub read_enable: Signal<In, Bit>,
    /// Row that the host read, for one cycle, 6 cycles plus one per group after the request; else 0.
    pub read_data: Signal<Out, Bits<64>>,
    _sizes: Sizes,
    _state: State,
}

#[derive(Debug, Clone)]
struct Sizes {
    banks: usize,
    depth: usize,
    rows: usize,
    dense: bool,
    part_bits: u32,
    sum_bits: u32,
    images: String,
}

/// What a step brings: rows of weights and values.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    first: bool,
    addresses: [usize; 2],
    values: [i64; 4],
}

/// A write on its way, or a row that is read back.
#[derive(Debug, Clone, Copy, Default)]
struct Write {
    enable: bool,
    read: bool,
    bank: usize,
    half: bool,
    row: usize,
    data: u64,
}

/// Registers of the model.
#[derive(Debug, Clone, Default)]
struct State {
    /// Of each bank and word of a row.
    weights: Vec<Vec<u64>>,
    /// Steps of the last six cycles, the newest first.
    steps: [Step; 6],
    /// Rows that lie in the memories' output registers, of each bank and word.
    read: [Vec<u64>; 5],
    /// The row that is read back, in its bank's register.
    back_of_bank: u64,
    /// Writes and reads of the last four cycles, the newest first.
    writes: [Write; 4],
    /// A row that is read back, on its way through the groups.
    back: VecDeque<u64>,
    /// Of each lane, its rows.
    sums: Vec<Vec<i64>>,
    hold: Vec<Vec<i64>>,
    copy: [bool; 2],
    shift: [bool; 2],
    /// Even and odd sums that leave, by way of the groups.
    leaving: VecDeque<[i64; 2]>,
}

impl MaccArray {
    /// The multipliers of a stage; the model holds the weights of the sets that the design has.
    #[must_use]
    pub fn new(stage: &StagePlan, sum_bits: u32, sets: [&FixedNetwork; 2]) -> Self {
        let sets = &sets[..stage.sets];
        let words = |bank, part| sets.iter().flat_map(move |n| memory::weight_words(n, stage, bank, part));
        let parts = stage.row_words();
        let memories = (0..stage.banks()).flat_map(|bank| (0..parts).map(move |part| (bank, part)));
        let lanes = vec![vec![0; stage.rows]; stage.lanes];
        Self::from_parts(MaccArrayParts {
            _sizes: Sizes {
                banks: stage.banks(),
                depth: stage.weight_depth(),
                rows: stage.rows,
                dense: stage.is_dense(),
                part_bits: memory::row_bits(stage),
                sum_bits,
                images: memory::weight_images(stage),
            },
            _state: State {
                weights: memories.map(|(bank, part)| words(bank, part).collect()).collect(),
                read: std::array::from_fn(|_| vec![0; stage.banks() * stage.rows]),
                back: vec![0; 1 + stage.groups()].into(),
                leaving: vec![[0; 2]; 5 + stage.groups()].into(),
                sums: lanes.clone(),
                hold: lanes,
                ..State::default()
            },
        })
    }

    fn step(&mut self) {
        // Not cloned with the rest: it is large, and read before it is written.
        let mut weights = std::mem::take(&mut self._state.weights);
        let (sizes, old) = (&self._sizes, self._state.clone());
        let value = |signal: &Signal<In, Bits<25>>| extend(signal.val().to_u64(), 25);
        let step = Step {
            first: self.first.val(),
            addresses: [self.address_a.val(), self.address_b.val()].map(|row| row.to_u64() as usize),
            values: [&self.value_a, &self.value_b, &self.value_c, &self.value_d].map(value),
        };
        let new = &mut self._state;
        new.steps.rotate_right(1);
        new.steps[0] = step;
        new.copy = [self.copy.val(), old.copy[0]];
        new.shift = [self.shift.val(), old.shift[0]];
        let write_now = Write {
            enable: self.write_enable.val(),
            read: self.read_enable.val(),
            bank: self.write_bank.val().to_u64() as usize,
            half: self.write_half.val(),
            row: self.write_row.val().to_u64() as usize,
            data: self.write_data.val().to_u64(),
        };
        new.writes.rotate_right(1);
        new.writes[0] = write_now;
        new.back.pop_front();
        new.back.push_back(old.back_of_bank);
        new.back_of_bank = back_of_bank(sizes, &old);
        new.read.rotate_right(1);
        new.read[0] = read(sizes, &old, &weights);
        write(sizes, &old.writes[1], &mut weights);
        new.weights = weights;
        // Products of the step of six cycles ago, whose rows have come through memory, output and input register.
        let (step, rows) = (&old.steps[4], &old.read[3]);
        for (lane, sums) in new.sums.iter_mut().enumerate() {
            for (row, sum) in sums.iter_mut().enumerate() {
                let word = rows[(lane / BANK_LANES) * sizes.rows + row] >> (16 * (lane % BANK_LANES));
                let before = if step.first { 0 } else { *sum };
                *sum = wrap(before + extend(word & 0xffff, 16) * step.values[row], 48);
            }
        }
        if old.copy[1] {
            let copied = |sums: &Vec<i64>| sums.iter().map(|sum| wrap(*sum, sizes.sum_bits)).collect();
            new.hold = old.sums.iter().map(copied).collect();
        } else if old.shift[1] {
            new.hold.rotate_left(2);
            let end = new.hold.len() - 2;
            new.hold[end..].iter_mut().for_each(|sums| sums.fill(0));
        }
        new.leaving.pop_front();
        new.leaving.push_back([0, 1].map(|lane| wrap(old.hold[lane].iter().sum(), 48)));
    }
}

/// The rows that the step of a cycle ago reads; a write takes its place at a port of two that read, a row that is read back at any.
fn read(sizes: &Sizes, old: &State, weights: &[Vec<u64>]) -> Vec<u64> {
    let word = |memory: usize, row: usize| weights[memory].get(row).copied().unwrap_or(0);
    let [a, b] = old.steps[0].addresses;
    (0..sizes.banks)
        .flat_map(|bank| {
            let write = &old.writes[1];
            let takes_port = write.read || (write.enable && !sizes.dense && sizes.rows == 2);
            let a = if takes_port && write.bank == bank { write.row >> sizes.part_bits } else { a };
            (0..sizes.rows).map(move |row| match (sizes.dense, row) {
                (true, part) => (bank * sizes.rows + part, a),
                (false, 0) => (bank, a),
                (false, _) => (bank, b),
            })
        })
        .map(|(memory, row)| word(memory, row))
        .collect()
}

/// What a bank takes of its rows to be read back.
fn back_of_bank(sizes: &Sizes, old: &State) -> u64 {
    let Write { read, bank, row, .. } = old.writes[3];
    let part = row & ((1 << sizes.part_bits) - 1);
    let parts = if sizes.dense { sizes.rows } else { 1 };
    if read && bank < sizes.banks && part < parts { old.read[1][bank * sizes.rows + part] } else { 0 }
}

fn write(sizes: &Sizes, write: &Write, weights: &mut [Vec<u64>]) {
    let parts = if sizes.dense { sizes.rows } else { 1 };
    let part = write.row & ((1 << sizes.part_bits) - 1);
    if !write.enable || write.bank >= sizes.banks || part >= parts {
        return;
    }
    let row = write.row >> sizes.part_bits;
    let shift = if write.half { 32 } else { 0 };
    if let Some(word) = weights[write.bank * parts + part].get_mut(row) {
        *word = (*word & !(0xffff_ffff << shift)) | (write.data << shift);
    }
}

/// The low `bits` bits as two's complement.
const fn extend(word: u64, bits: u32) -> i64 {
    ((word << (64 - bits)) as i64) >> (64 - bits)
}

/// A sum that has `bits` bits.
const fn wrap(sum: i64, bits: u32) -> i64 {
    extend(sum as u64, bits)
}

impl Logic for MaccArray {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self.step();
        }
        let low = |sum: i64| (sum as u64 & ((1 << 48) - 1)).into();
        self.sum_even.next = low(self._state.leaving.front().map_or(0, |sums| sums[0]));
        self.sum_odd.next = low(self._state.leaving.front().map_or(0, |sums| sums[1]));
        self.read_data.next = self._state.back.front().copied().unwrap_or(0).into();
    }

    fn connect(&mut self) {
        self.sum_even.connect();
        self.sum_odd.connect();
        self.read_data.connect();
    }

    fn hdl(&self) -> Verilog {
        leaf("edof_macc_array")
            .parameter("BANKS", self._sizes.banks)
            .parameter("DEPTH", self._sizes.depth)
            .parameter("ROWS", self._sizes.rows)
            .parameter("DENSE", usize::from(self._sizes.dense))
            .parameter("SUM", self._sizes.sum_bits as usize)
            .text("INIT", memory::image_name(&self._sizes.images))
            .port("clock_i", "clock")
            .port("first_i", "first")
            .port("address_a_i", "address_a")
            .port("address_b_i", "address_b")
            .port("value_a_i", "value_a")
            .port("value_b_i", "value_b")
            .port("value_c_i", "value_c")
            .port("value_d_i", "value_d")
            .port("copy_i", "copy")
            .port("shift_i", "shift")
            .port("sum_even_o", "sum_even")
            .port("sum_odd_o", "sum_odd")
            .port("write_enable_i", "write_enable")
            .port("write_bank_i", "write_bank")
            .port("write_half_i", "write_half")
            .port("write_row_i", "write_row")
            .port("write_data_i", "write_data")
            .port("read_enable_i", "read_enable")
            .port("read_data_o", "read_data")
            .verilog()
    }
}
