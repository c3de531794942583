//! An FPGA: the cells that a circuit takes, by kind, and what the vendor calls them.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::fmt;
use std::iter::Sum;
use std::ops::{Add, Mul};

/// Cells of an FPGA, by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Resources {
    /// Multipliers.
    pub multipliers: usize,
    /// Block memories.
    pub memories: usize,
    /// Halves of block memories, where a part has them.
    pub half_memories: usize,
    /// LUTs, as logic, memory or shift registers.
    pub luts: usize,
    /// Flip-flops.
    pub registers: usize,
}

impl Resources {
    /// Returns LUTs and flip-flops.
    #[must_use]
    pub const fn logic(luts: usize, registers: usize) -> Self {
        Self { multipliers: 0, memories: 0, half_memories: 0, luts, registers }
    }

    /// Returns block memories in units of whole ones.
    #[must_use]
    pub fn whole_memories(&self) -> f64 {
        self.memories as f64 + self.half_memories as f64 / 2.0
    }
}

impl Add for Resources {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            multipliers: self.multipliers + other.multipliers,
            memories: self.memories + other.memories,
            half_memories: self.half_memories + other.half_memories,
            luts: self.luts + other.luts,
            registers: self.registers + other.registers,
        }
    }
}

impl Mul<usize> for Resources {
    type Output = Self;

    fn mul(self, times: usize) -> Self {
        Self {
            multipliers: self.multipliers * times,
            memories: self.memories * times,
            half_memories: self.half_memories * times,
            luts: self.luts * times,
            registers: self.registers * times,
        }
    }
}

impl Sum for Resources {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Add::add)
    }
}

/// An FPGA.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// The vendor's name.
    pub name: &'static str,
    /// How it multiplies.
    pub multiplier: Multiplier,
    /// How it stores words.
    pub memory: BlockMemory,
    /// What LUTs and flip-flops are called.
    pub logic: [&'static str; 2],
    /// LUTs and flip-flops that it takes for 100 of a 7-series part.
    pub logic_percent: [usize; 2],
    /// Cells that it has.
    pub cells: Resources,
    /// Modules of `rtl/` that are written with the part's own cells, and their text: the same words in the same cycles as the portable ones.
    pub leaves: &'static [(&'static str, &'static str)],
    /// Where multipliers and block memories are, if a floorplan can be written.
    pub columns: Option<Columns>,
}

/// The multiplier of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Multiplier {
    /// The vendor's name.
    pub name: &'static str,
    /// Bits of the wider factor: a value, shifted left.
    pub value_bits: u32,
}

/// The block memory of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockMemory {
    /// The vendor's name.
    pub name: &'static str,
    /// The vendor's name of half of one, where halves are used by themselves.
    pub half: Option<&'static str>,
    /// Widest word and rows of one, where one port reads and one writes.
    pub widest: (usize, usize),
    /// How both ports read.
    pub reads_twice: ReadsTwice,
    /// How many rows a memory has that is deeper than one block.
    pub deep_rows: DeepRows,
}

/// How many rows a memory has that is deeper than one block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeepRows {
    /// A power of two: its blocks have a part of each word, and none is chosen behind their outputs.
    PowerOfTwo,
    /// A multiple of these: no block holds rows that nobody uses, and a choice is behind their outputs.
    MultipleOf(usize),
}

/// A memory both of whose ports read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadsTwice {
    /// Blocks that have words of half the widest at both ports.
    BothPorts,
    /// Two copies.
    Copies,
}

/// Columns of cells, as a floorplan has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Columns {
    /// Columns of multipliers, and their rows.
    pub multipliers: (usize, usize),
    /// Columns of block memories; a row of them is two rows of multipliers. The last column has gaps.
    pub memories: usize,
}

impl Columns {
    /// Returns the columns of block memories without gaps.
    #[must_use]
    pub const fn full_memories(&self) -> usize {
        self.memories - 1
    }
}

impl Multiplier {
    /// Returns the largest left shift of a 16-bit value before it is multiplied.
    #[must_use]
    pub const fn max_value_shift(&self) -> u32 {
        self.value_bits - 16
    }
}

impl BlockMemory {
    /// Returns the blocks of a memory with one port that reads.
    #[must_use]
    pub fn blocks(&self, width: usize, depth: usize) -> Resources {
        let (widest, rows) = self.widest;
        let whole = fewest((width, depth), self.widest);
        match self.half.map(|_| fewest((width, depth), (widest / 2, rows))) {
            Some(halves) if halves < 2 * whole => Resources { half_memories: halves, ..Resources::default() },
            _ => Resources { memories: whole, ..Resources::default() },
        }
    }

    /// Returns the rows that a memory has for so many.
    #[must_use]
    pub const fn rows(&self, needed: usize) -> usize {
        match self.deep_rows {
            DeepRows::MultipleOf(rows) if needed > rows => needed.next_multiple_of(rows),
            _ => needed.next_power_of_two(),
        }
    }

    /// Returns the blocks of a memory both of whose ports read.
    #[must_use]
    pub fn blocks_read_twice(&self, width: usize, depth: usize) -> Resources {
        match self.reads_twice {
            ReadsTwice::BothPorts => self.blocks_of_two_ports(width, depth),
            ReadsTwice::Copies => self.blocks(width, depth) * 2,
        }
    }

    /// Returns the blocks of a memory with two ports, each of which may use every row.
    #[must_use]
    pub fn blocks_of_two_ports(&self, width: usize, depth: usize) -> Resources {
        let (widest, rows) = self.widest;
        let memories = fewest((width, depth), (widest / 2, 2 * rows));
        Resources { memories, ..Resources::default() }
    }
}

/// The fewest blocks for words of a width in so many rows, of blocks with words of at most `widest` bits; with words of half the bits a block has twice the
/// rows.
fn fewest((width, depth): (usize, usize), (widest, rows): (usize, usize)) -> usize {
    let bits = (0..).map(|fold| widest >> fold).take_while(|bits| *bits > 0);
    let blocks = bits.enumerate().map(|(fold, bits)| width.div_ceil(bits) * depth.div_ceil(rows << fold));
    blocks.min().unwrap_or(0)
}

impl Part {
    /// Returns the kinds of cells by the vendor's names, and how many of each are taken.
    #[must_use]
    pub fn named(&self, used: &Resources) -> Cells {
        let [lut, register] = self.logic;
        let half = self.memory.half.map(|name| (name, used.half_memories));
        let first = [(self.multiplier.name, used.multipliers), (self.memory.name, used.memories)];
        let last = [(lut, used.luts), (register, used.registers)];
        Cells(first.into_iter().chain(half).chain(last).collect())
    }

    /// Returns the kind of cell that is scarcest, by the vendor's name in small letters, and its share that is taken.
    #[must_use]
    pub fn fullest(&self, used: &Resources) -> (String, f64) {
        let share = |count: fn(&Resources) -> f64| count(used) / count(&self.cells);
        let [lut, register] = self.logic;
        let kinds = [
            (self.multiplier.name, share(|cells| cells.multipliers as f64)),
            (self.memory.name, share(Resources::whole_memories)),
            (lut, share(|cells| cells.luts as f64)),
            (register, share(|cells| cells.registers as f64)),
        ];
        let (name, share) =
            kinds.into_iter().fold(kinds[0], |max, kind| if kind.1 > max.1 { kind } else { max });
        (name.to_lowercase(), share)
    }

    /// Whether the part has all cells that are used.
    #[must_use]
    pub fn has(&self, used: &Resources) -> bool {
        self.fullest(used).1 <= 1.0
    }
}

/// Kinds of cells by the vendor's names, and how many; in JSON the names are in small letters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cells(pub Vec<(&'static str, usize)>);

/// As in `800 DSP48E1, 270 RAMB36E1, 9 RAMB18E1, about 45872 LUT and 69499 FF`: logic is estimated, the rest counted.
impl fmt::Display for Cells {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((blocks, [luts, registers])) = self.0.split_last_chunk() else { return Ok(()) };
        blocks.iter().try_for_each(|(name, count)| write!(f, "{count} {name}, "))?;
        write!(f, "about {} {} and {} {}", luts.1, luts.0, registers.1, registers.0)
    }
}

impl Serialize for Cells {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, count) in &self.0 {
            map.serialize_entry(&name.to_lowercase(), count)?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use crate::board::{KC705, Resources, ULX3S};

    /// Yosys 0.23 mapped these memories, and for the ULX3S the scripts of `project/ecp5`.
    #[test]
    fn a_memory_takes_the_blocks_that_yosys_makes_of_it() {
        let halves = |half_memories| Resources { half_memories, ..Resources::default() };
        let whole = |memories| Resources { memories, ..Resources::default() };
        let kintex = &KC705.part.memory;
        for (width, depth, expected) in [
            (15, 512, halves(1)),
            (15, 1024, halves(1)),
            (15, 2048, whole(1)),
            (15, 8192, whole(4)),
            (15, 16384, halves(15)),
            (15, 32768, whole(15)),
            (32, 1024, whole(1)),
            (32, 16384, whole(16)),
            (40, 1024, halves(3)),
            (40, 2048, halves(5)),
            (40, 8192, whole(10)),
        ] {
            assert_eq!(kintex.blocks(width, depth), expected, "{width} bits, {depth} rows");
        }
        let ecp5 = &ULX3S.part.memory;
        assert_eq!((ecp5.blocks(15, 10_240), ecp5.blocks(32, 5120)), (whole(10), whole(10)));
        for (memory, blocks) in [(kintex, [8, 6]), (ecp5, [16, 12])] {
            let tables =
                [(8, 32_768), (12, 16_384)].map(|(width, rows)| memory.blocks_of_two_ports(width, rows));
            assert_eq!(tables, blocks.map(whole));
        }
    }

    #[test]
    fn a_deep_memory_has_no_rows_for_nobody_where_blocks_may_lie_under_each_other() {
        let rows = [1, 600, 1024, 1025, 5120, 5121];
        assert_eq!(rows.map(|rows| ULX3S.part.memory.rows(rows)), [1, 1024, 1024, 2048, 5120, 6144]);
        assert_eq!(rows.map(|rows| KC705.part.memory.rows(rows)), [1, 1024, 1024, 2048, 8192, 8192]);
    }
}
