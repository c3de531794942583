//! The blocks of the core, where they are in it, and how long their paths of logic may be.

use edof_core::Stride;
use edof_device::Design;

/// A clock of the core.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// Memory, host.
    Core,
    /// The calculator, with its clock period in picoseconds.
    Calculator(u64),
    /// Incoming pixels, or the screen's.
    Pixel,
}

impl Domain {
    /// Picoseconds of logic alone that a path may have: half of the period, the other half is for wires; at 200 MHz, or what the calculator
    /// needs if that is faster, and at 148.5 MHz.
    #[must_use]
    pub const fn limit_ps(self) -> u64 {
        match self {
            Self::Calculator(period) if period < 5000 => period / 2,
            Self::Core | Self::Calculator(_) => 2500,
            Self::Pixel => 3300,
        }
    }
}

/// A block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// The names of instances from [`super::EdofCore`] down to it, with `/` between them.
    pub path: String,
    /// Clock of the instance; with two clocks the faster one, and the calculator's clock if it is one of them.
    pub domain: Domain,
}

/// Stands for the calculator's clock of any design.
const CALCULATOR: Domain = Domain::Calculator(0);

const BLOCKS: [(&str, Domain); 38] = [
    ("video_in", Domain::Pixel),
    ("carrier", Domain::Pixel),
    ("grey_join", Domain::Pixel),
    ("input_fifo", Domain::Core),
    ("input_status", Domain::Core),
    ("watch", Domain::Core),
    ("calculator_watch", CALCULATOR),
    ("raw_writer", Domain::Core),
    ("raw_reader", Domain::Core),
    ("raw_cut", Domain::Core),
    ("raw_fifo", CALCULATOR),
    ("choices", CALCULATOR),
    ("access", CALCULATOR),
    ("core/windows", CALCULATOR),
    ("core/lines/pairs", CALCULATOR),
    ("core/lines/raster", CALCULATOR),
    ("core/display", CALCULATOR),
    ("core/tables", CALCULATOR),
    ("calculator_status", CALCULATOR),
    ("picture_fifo", CALCULATOR),
    ("picture_writer", Domain::Core),
    ("picture_reader", Domain::Core),
    ("output_cut", Domain::Core),
    ("memory", Domain::Core),
    ("registers", Domain::Core),
    ("output_fifo", Domain::Core),
    ("video_out", Domain::Pixel),
    ("screen_status", Domain::Core),
    ("patterns", Domain::Core),
    ("host_frame", Domain::Core),
    ("window", Domain::Core),
    ("core/check", CALCULATOR),
    ("checks_0", Domain::Core),
    ("checks_1", Domain::Core),
    ("checks_2", Domain::Core),
    ("cycles_0", Domain::Core),
    ("cycles_1", Domain::Pixel),
    ("cycles_2", Domain::Pixel),
];
/// Only where patches overlap.
const OVERLAP: (&str, Domain) = ("core/lines/overlap", CALCULATOR);

/// The clock of a design's calculator.
#[must_use]
pub fn calculator(design: &Design) -> Domain {
    Domain::Calculator((1e6 / design.clock_mhz) as u64)
}

/// The blocks of a design's core around the calculator's stages; its reset synchronisers have no logic.
#[must_use]
pub fn around_the_calculator(design: &Design) -> Vec<Block> {
    let overlap = (design.frame.stride != Stride::PATCH).then_some(OVERLAP);
    let block = |(path, domain): (&str, Domain)| {
        let domain = if domain == CALCULATOR { calculator(design) } else { domain };
        Block { path: path.into(), domain }
    };
    BLOCKS.into_iter().chain(overlap).map(block).collect()
}

/// The stages of its calculator.
#[must_use]
pub fn stages(design: &Design) -> Vec<Block> {
    let domain = calculator(design);
    let stage = |i: usize| Block { path: format!("core/calculator/stages_{i}"), domain };
    (0..design.stages.len()).map(stage).collect()
}
