//! A design: everything that a generator, the golden model, the estimator and the board agree on.
//!
//! | what | module |
//! |---|---|
//! | one stage: sizes that follow from the design | [`stage`] |
//! | cycles that all stages have in common | [`timing`] |
//! | what lies where in weight and threshold memories, and how they are written | [`memory`] |
//! | clocks and frames of a design on its board | [`on_board`] |

pub mod frame;
pub mod memory;
pub mod on_board;
pub mod reading;
pub mod stage;
pub mod timing;

pub use frame::FrameSize;
pub use memory::Set;
pub use stage::{Kind, StagePlan};

use crate::board::Board;
use edof_core::geometry::{Geometry, GeometryError};
use edof_core::number::ACCUMULATOR_BITS;
use edof_core::storage::{json, name};
use edof_core::words::number;
use edof_network::fixed_network::FixedNetwork;
use edof_network::network::{Form, NetworkError, Recurrence};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Lanes that share one block of weight memory.
pub const BANK_LANES: usize = 4;
/// Elements of a vector that pass in one beat.
pub const BEAT: usize = 2;
/// Longest sparse code: a stage's store has room for 256 values of each vector.
const MAX_CODES: usize = 256;

/// Most pixels along a side of a picture; a board has fewer ([`Design::check_board`]).
const MAX_SIDE: usize = 1 << 14;

/// Most beats that a stage sends of a picture: a counter of 28 bits marks the end of each.
pub const MAX_FRAME_BEATS: usize = 1 << 28;

/// Most bytes of a design file.
const MAX_BYTES: u64 = 1 << 20;

/// Fastest clock of a calculator in megahertz: its longest path of logic alone takes 2.45 ns (docs/calculator.md, Clock).
pub const MAX_CLOCK_MHZ: f64 = 400.0;

/// A hardware design for one form of network.
///
/// ```
/// use edof_device::Design;
/// let paper = Design::from_json(include_str!("../../../../designs/paper.json"))?;
/// assert_eq!(paper.stages().map(|s| s.dsps()).sum::<usize>(), 704);
/// # Ok::<(), edof_device::design::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Short name, as in `kc705`: [`name::PLAIN`].
    pub name: String,
    /// Clock of the calculator in megahertz.
    pub clock_mhz: f64,
    /// The form of network it runs.
    pub form: Form,
    /// Bits of every weight, pre-activation and sparse code.
    pub code_bits: u32,
    /// Bits of a sum on its way from the DSPs to rounding.
    pub accumulator_bits: u32,
    /// Whether only non-zero values are multiplied (initial value of a register).
    pub skip_zeros: bool,
    /// Lanes and rows of I, each M, F.
    pub stages: Vec<StageSize>,
    /// The picture it is made for.
    pub frame: FrameSize,
    /// Sets of weights: two, one of which is loaded while the other is used, or one, which is loaded while the calculator stands; without the
    /// field two.
    #[serde(default = "two", skip_serializing_if = "is_two")]
    pub sets: usize,
    /// The board it is for, by name in files; without the field the KC705.
    #[serde(default, skip_serializing_if = "is_default")]
    pub board: &'static Board,
    /// The camera's module where it is another than the board states; without the field as the board states.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraModule>,
}

/// How a camera's module differs from what its board states, as measured with it (docs/ulx3s.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraModule {
    /// The byte of black, which becomes 0.
    #[serde(default)]
    pub black: u8,
    /// Pixels by which the window is moved right and down, so that its first one is red.
    #[serde(default)]
    pub corner: [i8; 2],
}

const fn two() -> usize {
    2
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
const fn is_two(sets: &usize) -> bool {
    *sets == 2
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_default(board: &&'static Board) -> bool {
    board.is_default()
}

/// How a stage is folded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageSize {
    /// Outputs computed at once.
    pub lanes: usize,
    /// Values multiplied per cycle in each lane: 1 or 2, in I up to 4.
    pub rows: usize,
}

/// A design that cannot be built, or a network that does not fit it.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum DesignError {
    /// The file cannot be read.
    #[error("{path}: cannot read: {source}")]
    Read { path: String, source: std::io::Error },
    /// No design in the file.
    #[error("{path}: not a design: {source}")]
    Parse { path: String, source: json::JsonError },
    /// What is wrong with the design of a file.
    #[error("{path}: {source}")]
    File { path: String, source: Box<DesignError> },
    /// A form that no network has.
    #[error(transparent)]
    Form(#[from] NetworkError),
    /// A picture that has no whole windows.
    #[error(transparent)]
    Frame(#[from] GeometryError),
    /// A field out of range.
    #[error("{field} {value}: must be {expected}")]
    Field { field: String, value: String, expected: String },
    /// Something that the design's board does not have.
    #[error("board {board} has no {what}; use a design for another board")]
    Lacks { board: &'static str, what: String },
    /// The network is another than the design computes.
    #[error("network {network} does not fit design {design}: it has {found}, the design {expected}")]
    Misfit { network: String, design: String, found: String, expected: String },
}

impl Design {
    /// A design from JSON text, checked.
    ///
    /// # Errors
    /// [`DesignError::Parse`], or the first field that is wrong.
    pub fn from_json(text: &str) -> Result<Self, DesignError> {
        Self::parse(text, "design")
    }

    /// A design from a file, checked.
    ///
    /// # Errors
    /// [`DesignError::Read`], [`DesignError::Parse`], or the first field that is wrong.
    pub fn load(path: &Path) -> Result<Self, DesignError> {
        let name = path.display().to_string();
        let text =
            json::text(path, MAX_BYTES).map_err(|source| DesignError::Read { path: name.clone(), source })?;
        Self::parse(&text, &name)
    }

    fn parse(text: &str, path: &str) -> Result<Self, DesignError> {
        let design: Self =
            json::parse(text).map_err(|source| DesignError::Parse { path: path.into(), source })?;
        design.check().map_err(|source| DesignError::File { path: path.into(), source: Box::new(source) })?;
        Ok(design)
    }

    /// The stages in order: I, each M, F.
    pub fn stages(&self) -> impl ExactSizeIterator<Item = StagePlan> + '_ {
        (0..self.stages.len()).map(|index| StagePlan::new(self, index))
    }

    /// The sets of weights that the calculator has.
    #[must_use]
    pub fn sets(&self) -> &'static [Set] {
        if self.sets == 1 { &[Set::First] } else { &[Set::First, Set::Second] }
    }

    /// One stage.
    #[must_use]
    pub fn stage(&self, index: usize) -> StagePlan {
        StagePlan::new(self, index)
    }

    /// Patches of a frame.
    #[must_use]
    pub fn patches_per_frame(&self) -> usize {
        let geometry = Geometry::new(self.form.window, self.frame.stride);
        let (rows, columns) = geometry.patches(self.frame.height, self.frame.width);
        rows * columns
    }

    /// # Errors
    /// [`DesignError::Field`] and its like for the first field that no design can have.
    pub fn check(&self) -> Result<(), DesignError> {
        require("name", name::quoted(&self.name), name::is_plain(&self.name), name::PLAIN)?;
        self.form.check()?;
        require(
            "form.exposures",
            self.form.exposures,
            self.form.exposures == 1,
            "1: hardware takes one raw frame",
        )?;
        require(
            "clock_mhz",
            number(self.clock_mhz),
            self.clock_mhz > 0.0 && self.clock_mhz <= MAX_CLOCK_MHZ,
            &format!("above 0, at most {MAX_CLOCK_MHZ}"),
        )?;
        require(
            "form.codes",
            self.form.codes,
            self.form.codes.is_multiple_of(BANK_LANES) && self.form.codes <= MAX_CODES,
            &format!("a multiple of {BANK_LANES} and at most {MAX_CODES}"),
        )?;
        let sets = self.board.sets;
        require(
            "sets",
            self.sets,
            sets.contains(&self.sets),
            &format!(
                "{} on board {}",
                sets.iter().map(usize::to_string).collect::<Vec<_>>().join(" or "),
                self.board.name
            ),
        )?;
        self.check_camera()?;
        require("code_bits", self.code_bits, (8..=16).contains(&self.code_bits), "8 to 16")?;
        let sums = 32..=ACCUMULATOR_BITS;
        require(
            "accumulator_bits",
            self.accumulator_bits,
            sums.contains(&self.accumulator_bits),
            "32 to 48",
        )?;
        let layers = self.form.layers;
        require(
            "stages",
            self.stages.len(),
            self.stages.len() == layers,
            &format!("{layers} stages, one a layer"),
        )?;
        Geometry::new(self.form.window, self.frame.stride)
            .check_frame((self.frame.height, self.frame.width))?;
        self.stages().try_for_each(|stage| stage.check())?;
        let sides = (self.frame.width, self.frame.height);
        let is_counted = |stage: StagePlan| self.patches_per_frame() * stage.beats_out() <= MAX_FRAME_BEATS;
        require(
            "frame",
            format!("{}x{}", sides.0, sides.1),
            sides.0.max(sides.1) <= MAX_SIDE && self.stages().all(is_counted),
            &format!(
                "at most {MAX_SIDE} pixels a side, and at most {MAX_FRAME_BEATS} beats from each stage; make it smaller, or the stride larger"
            ),
        )
    }

    /// # Errors
    /// [`DesignError::Misfit`] with everything of their forms in which the network and the design differ, or the first other thing.
    pub fn check_network(&self, network: &FixedNetwork) -> Result<(), DesignError> {
        let misfit = |found: String, expected: String| DesignError::Misfit {
            network: network.origin.name.clone(),
            design: self.name.clone(),
            found,
            expected,
        };
        if let Some((theirs, ours)) = differing(network.form, self.form) {
            return Err(misfit(theirs, ours));
        }
        if network.code_bits != self.code_bits {
            return Err(misfit(format!("weights of {} bits", network.code_bits), self.code_bits.to_string()));
        }
        if network.stride != self.frame.stride {
            let stride = network.stride.pixels();
            return Err(misfit(format!("a stride of {stride}"), self.frame.stride.pixels().to_string()));
        }
        let widest = network.accumulator_bits().into_iter().max().unwrap_or(0);
        if widest > self.accumulator_bits {
            return Err(misfit(
                format!("sums of {widest} bits"),
                format!("{} at most", self.accumulator_bits),
            ));
        }
        let shifts = network.final_shifts();
        let shift = shifts.dictionary.max(shifts.linear_path);
        let max_shift = self.board.part.multiplier.max_value_shift();
        if shift > max_shift {
            return Err(misfit(
                format!(
                    "products of F that are {shift} bits apart, for which its multipliers are too narrow"
                ),
                format!(
                    "{max_shift} at most; quantize it again by 'edof quantize', with another --headroom if that does not help"
                ),
            ));
        }
        Ok(())
    }
}

/// What differs between the forms of a network and of a design, in words of either. A design has a memory for each M layer's S, tied
/// or not.
fn differing(network: Form, design: Form) -> Option<(String, String)> {
    let parts = |form: Form| {
        [
            format!("windows of {0}x{0}", form.window.side()),
            format!("{} values of sparse code", form.codes),
            format!("{} layers", form.layers),
            format!("{} shrinkage", form.shrinkage),
            match form.recurrence {
                Recurrence::Direct => "direct recurrence",
                Recurrence::Difference => "recurrence of differences",
            }
            .to_owned(),
            if form.linear_path { "a linear path" } else { "no linear path" }.to_owned(),
        ]
    };
    let pairs = parts(network).into_iter().zip(parts(design));
    let (theirs, ours): (Vec<String>, Vec<String>) = pairs.filter(|(theirs, ours)| theirs != ours).unzip();
    (!theirs.is_empty()).then(|| (theirs.join(", "), ours.join(", ")))
}

fn require(field: &str, value: impl ToString, holds: bool, expected: &str) -> Result<(), DesignError> {
    let wrong =
        || DesignError::Field { field: field.into(), value: value.to_string(), expected: expected.into() };
    if holds { Ok(()) } else { Err(wrong()) }
}
