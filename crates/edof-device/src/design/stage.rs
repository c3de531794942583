//! One stage of a design: every size that its memories, ports and counters have.

use super::memory::{MAX_BANK_WORDS, row_bits};
use super::timing::DRAIN_LATENCY;
use super::{BANK_LANES, BEAT, Design, DesignError, require};
use edof_core::colour::OUTPUTS_422;
use edof_network::network::Recurrence;

/// What a stage is configured as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// From a window to b₁.
    I,
    /// From a sparse code to the next one's pre-activation.
    M,
    /// From the last sparse code (and the window) to a patch.
    F,
}

/// The sizes of one stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StagePlan {
    /// What it is.
    pub kind: Kind,
    /// Place of the stage in the chain, 0 first.
    pub index: usize,
    /// Length of the vector that comes in.
    pub inputs: usize,
    /// Pixels of the window that come in beside it (F's linear path), or 0.
    pub linear: usize,
    /// Length of the vector that goes out.
    pub outputs: usize,
    /// Outputs computed at once.
    pub lanes: usize,
    /// Values taken per cycle.
    pub rows: usize,
    /// Whether the next stage is an M, which wants a base.
    pub feeds_m: bool,
    /// Whether the stage sends the change of z, so that it must know the z before.
    pub sends_difference: bool,
    /// Windows that F keeps for its linear path.
    pub kept_windows: usize,
    /// Sets of weights.
    pub sets: usize,
}

/// Rows of a dense stage, at most.
pub const MAX_ROWS: usize = 4;
/// Banks that share the registers of what passes through all banks (`rtl/edof_macc_array.v`).
pub const GROUP_BANKS: usize = 8;
/// Rows of two pixels that the window ring's memory has addresses for.
const RING_ROWS: usize = 4096;

/// Windows that wait for F: six for each layer, as many vectors as are in the stages before F and more. With the ring full the input waits.
/// The number is a power of two, so that a place is some bits of an address. Windows of side 12 take 128 rows each, so that 32 of them fill
/// the memory.
fn kept_windows(layers: usize, pixels: usize) -> usize {
    let rows = (pixels / BEAT).next_power_of_two();
    (6 * layers).next_power_of_two().min(RING_ROWS / rows)
}

impl StagePlan {
    /// Stage `index` of a design.
    #[must_use]
    pub fn new(design: &Design, index: usize) -> Self {
        let form = &design.form;
        let (kind, inputs, outputs) = match index {
            0 => (Kind::I, form.window.pixels(), form.codes),
            i if i + 1 == form.layers => (Kind::F, form.codes, OUTPUTS_422),
            _ => (Kind::M, form.codes, form.codes),
        };
        let linear = if kind == Kind::F && form.linear_path { form.window.pixels() } else { 0 };
        let size = design.stages[index];
        let feeds_m = index + 2 < form.layers;
        Self {
            kind,
            index,
            inputs,
            linear,
            outputs,
            lanes: size.lanes,
            rows: size.rows,
            feeds_m,
            sends_difference: form.recurrence == Recurrence::Difference && kind == Kind::M && feeds_m,
            kept_windows: if linear > 0 { kept_windows(form.layers, linear) } else { 0 },
            sets: design.sets,
        }
    }

    /// Passes over the pairs of a vector: more than one where there are fewer lanes than outputs.
    #[must_use]
    pub const fn passes(&self) -> usize {
        self.outputs / self.lanes
    }

    /// Blocks of weight memory, each shared by [`BANK_LANES`] lanes.
    #[must_use]
    pub const fn banks(&self) -> usize {
        self.lanes / BANK_LANES
    }

    /// Groups of neighbouring banks that share the registers of what passes through all banks, [`GROUP_BANKS`] each.
    #[must_use]
    pub const fn groups(&self) -> usize {
        self.banks().div_ceil(GROUP_BANKS)
    }

    /// Cycles from taking two sums to the first cycle in which their results are valid on the output: [`DRAIN_LATENCY`] and one per group.
    #[must_use]
    pub const fn drain_latency(&self) -> u64 {
        DRAIN_LATENCY + self.groups() as u64
    }

    /// Multipliers.
    #[must_use]
    pub const fn dsps(&self) -> usize {
        self.lanes * self.rows
    }

    /// Whether the stage takes all of its inputs, zero or not, `rows` of them from one wide word: I.
    #[must_use]
    pub fn is_dense(&self) -> bool {
        self.kind == Kind::I
    }

    /// Inputs of one of the `rows` parts into which a dense stage divides its vector, each read in step with the others.
    #[must_use]
    pub const fn segment(&self) -> usize {
        self.inputs / self.rows
    }

    /// Words of [`BANK_LANES`] weights in a row of a bank.
    #[must_use]
    pub fn row_words(&self) -> usize {
        if self.is_dense() { self.rows } else { 1 }
    }

    /// Whether both ports of a bank's memory read, so that a write takes a cycle from the multipliers.
    #[must_use]
    pub fn reads_both_ports(&self) -> bool {
        !self.is_dense() && self.rows == 2
    }

    /// Rows of weights in one pass: one for each input, in a dense stage one for each step.
    #[must_use]
    pub fn pass_rows(&self) -> usize {
        if self.is_dense() { self.segment() } else { self.inputs + self.linear }
    }

    /// Rows of one set of weights.
    #[must_use]
    pub fn weight_rows(&self) -> usize {
        self.passes() * self.pass_rows()
    }

    /// Depth of each block of weight memory: all sets.
    #[must_use]
    pub fn weight_depth(&self) -> usize {
        self.sets * self.weight_rows()
    }

    /// Numbers that the words of one block of weight memory take in the host's addresses: all sets. Where a row has three words, a
    /// fourth number has none.
    #[must_use]
    pub fn bank_words(&self) -> usize {
        self.weight_depth() << row_bits(self)
    }

    /// Beats in which a vector comes in.
    #[must_use]
    pub const fn beats_in(&self) -> usize {
        self.inputs / BEAT
    }

    /// Beats in which a vector goes out.
    #[must_use]
    pub const fn beats_out(&self) -> usize {
        self.outputs / BEAT
    }

    /// Beats in which the sums of one pass are drained.
    #[must_use]
    pub const fn drain_beats(&self) -> usize {
        self.lanes / BEAT
    }

    /// Whether the stage has thresholds: I and M.
    #[must_use]
    pub fn shrinks(&self) -> bool {
        self.kind != Kind::F
    }

    /// Whether a base is added to its sums: M.
    #[must_use]
    pub fn has_base(&self) -> bool {
        self.kind == Kind::M
    }

    /// Cycles in which the multipliers take one vector of which `pairs` pairs are sent.
    #[must_use]
    pub const fn cycles(&self, pairs: usize) -> usize {
        let codes = if pairs == 0 { 1 } else { pairs.div_ceil(self.rows) };
        self.passes() * (codes + self.linear.div_ceil(self.rows))
    }

    /// # Errors
    /// [`DesignError::Field`] for lanes or rows that cannot be built.
    pub fn check(&self) -> Result<(), DesignError> {
        let (lanes, outputs) = (self.lanes, self.outputs);
        let fits = lanes > 0 && lanes.is_multiple_of(BANK_LANES) && outputs.is_multiple_of(lanes);
        let field = |name| format!("stages[{}].{name}", self.index);
        let expected = format!("a multiple of {BANK_LANES} that divides {outputs}");
        require(&field("lanes"), lanes, fits, &expected)?;
        if self.is_dense() {
            let even = self.rows > 0 && self.rows <= MAX_ROWS && self.inputs.is_multiple_of(BEAT * self.rows);
            let expected = format!("1 to {MAX_ROWS}, and divide {} into even parts", self.inputs);
            require(&field("rows"), self.rows, even, &expected)?;
        } else {
            require(&field("rows"), self.rows, self.rows == 1 || self.rows == 2, "1 or 2")?;
        }
        let words = self.bank_words();
        let sets = if self.sets == 1 { "one set" } else { "two sets" };
        require(
            &field("lanes"),
            lanes,
            words <= MAX_BANK_WORDS,
            &format!(
                "more: four lanes have {sets} of weights in {words} words with {} rows, and addresses for {MAX_BANK_WORDS}",
                self.rows
            ),
        )
    }
}
