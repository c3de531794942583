//! Foldings of a network that fit a device, and what each takes on raw frames.

use crate::estimate::MeasureError;
use edof_core::colour::OUTPUTS_422;
use edof_core::{Geometry, RawFrame};
use edof_device::Design;
use edof_device::board::Resources;
use edof_device::design::memory::Set;
use edof_device::design::{DesignError, FrameSize, StageSize};
use edof_golden::cycle::estimate::estimate;
use edof_golden::cycle::explore::{cycles_per_patch, foldings};
use edof_golden::cycle::{Cycle, Patch};
use edof_golden::windows;
use edof_hdl::resources;
use edof_network::FixedNetwork;
use std::ops::ControlFlow;

/// Of each patch of a picture, the pairs that every stage multiplies.
pub type Pairs = Vec<Vec<usize>>;

/// A folding of a network, and what it takes.
#[derive(Debug, Clone)]
pub struct Folding {
    /// The design that has it.
    pub design: Design,
    /// Lanes and rows of each stage, as in `48x4 24x8`.
    pub words: String,
    /// Cycles per patch, mean over all patches of all pictures.
    pub cycles: f64,
    /// Cycles per patch of the slowest picture.
    pub worst_cycles: f64,
    /// Frames per second at the design's clock.
    pub frames: f64,
    /// The same of the slowest picture.
    pub worst_frames: f64,
    /// The same where no value is zero: what every picture reaches.
    pub least_frames: f64,
    /// Cells.
    pub used: Resources,
}

/// A design for a network, of any folding, with clock and picture of another.
///
/// # Errors
/// A network that no design computes.
pub fn any_folding(base: &Design, network: &FixedNetwork) -> Result<Design, DesignError> {
    let last = network.form.layers - 1;
    let lanes = |stage: usize| if stage == last { OUTPUTS_422 } else { network.form.codes };
    let stages = (0..=last).map(|stage| StageSize { lanes: lanes(stage), rows: 1 });
    let design = Design {
        name: network.origin.name.clone(),
        form: network.form,
        code_bits: network.code_bits,
        skip_zeros: true,
        stages: stages.collect(),
        frame: FrameSize { stride: network.stride, ..base.frame },
        ..base.clone()
    };
    design.check()?;
    Ok(design)
}

/// The pairs of every patch of a raw frame; `go_on` is asked at each.
///
/// # Errors
/// [`MeasureError`].
pub fn pairs(
    model: &Cycle,
    network: &FixedNetwork,
    raw: &RawFrame,
    mut go_on: impl FnMut() -> ControlFlow<()>,
) -> Result<Pairs, MeasureError> {
    let patches = windows::all(network, raw)?.map(|window| Patch { window, set: Set::First });
    let mut pairs = vec![];
    for patch in model.run(patches) {
        pairs.push(patch.times.stages.iter().map(|used| used.pairs as usize).collect());
        if go_on().is_break() {
            return Err(MeasureError::Interrupted);
        }
    }
    Ok(pairs)
}

/// All foldings of a network that fit the device, on pictures whose [`pairs`] were measured, until `go_on` says to break.
///
/// # Errors
/// As [`any_folding`].
pub fn found(
    base: &Design,
    network: &FixedNetwork,
    pictures: &[Pairs],
    mut go_on: impl FnMut() -> ControlFlow<()>,
) -> Result<Vec<Folding>, DesignError> {
    let patches: usize = pictures.iter().map(Vec::len).sum();
    let mean = |stage: usize| {
        pictures.iter().flatten().map(|pairs| pairs[stage]).sum::<usize>() as f64 / patches.max(1) as f64
    };
    let pairs: Vec<f64> = (0..network.form.layers).map(mean).collect();
    let mut found = vec![];
    for design in foldings(&any_folding(base, network)?, &pairs) {
        if go_on().is_break() {
            break;
        }
        let used = resources::whole(&design);
        if !design.board.part.has(&used) {
            continue;
        }
        let each: Vec<f64> = pictures.iter().map(|patches| cycles_per_patch(&design, patches)).collect();
        let weighted = each.iter().zip(pictures).map(|(cycles, patches)| cycles * patches.len() as f64);
        let cycles = weighted.sum::<f64>() / patches.max(1) as f64;
        let geometry = Geometry::new(design.form.window, design.frame.stride);
        let (rows, columns) = geometry.patches(design.frame.height, design.frame.width);
        let rate = |cycles: f64| design.clock_mhz * 1e6 / (cycles * (rows * columns) as f64);
        let worst_cycles = each.iter().copied().fold(0.0, f64::max);
        let sizes = design.stages.iter().map(|size| format!("{}x{}", size.lanes, size.rows));
        found.push(Folding {
            words: sizes.collect::<Vec<_>>().join(" "),
            cycles,
            worst_cycles,
            frames: rate(cycles),
            worst_frames: rate(worst_cycles),
            least_frames: estimate(&design, None).frames_per_second,
            used,
            design,
        });
    }
    Ok(found)
}
