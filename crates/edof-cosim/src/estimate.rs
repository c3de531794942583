//! What a design takes: cycles from the cycle model on raw frames, cells from counting them.

use crate::chain::check::stage_names;
use edof_core::RawFrame;
use edof_core::geometry::GeometryError;
use edof_device::Design;
use edof_device::board::{Part, Resources};
use edof_device::design::memory::Set;
use edof_device::video::VideoTiming;
use edof_golden::cycle::estimate::{Estimate, estimate};
use edof_golden::cycle::{Cycle, CycleError, Patch, Summary};
use edof_golden::video::figures::{CoreCycles, Figures, Periods, figures};
use edof_golden::windows;
use edof_hdl::resources;
use edof_network::FixedNetwork;
use serde_json::{Value, json};
use std::ops::ControlFlow;

/// A frame that cannot be measured.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// Design and network do not fit each other.
    #[error(transparent)]
    Cycle(#[from] CycleError),
    /// The frame is too small.
    #[error(transparent)]
    Frame(#[from] GeometryError),
    /// Somebody wanted the work to end.
    #[error("interrupted")]
    Interrupted,
}

/// A picture that went through the cycle model.
#[derive(Debug, Clone)]
pub struct Picture {
    /// What results call it.
    pub name: String,
    /// Cycles and values of the picture.
    pub summary: Summary,
}

impl Picture {
    /// A raw frame through the model of a design; `go_on` is asked at every patch.
    ///
    /// # Errors
    /// [`MeasureError`].
    pub fn measure(
        name: String,
        design: &Design,
        network: &FixedNetwork,
        raw: &RawFrame,
        mut go_on: impl FnMut() -> ControlFlow<()>,
    ) -> Result<Self, MeasureError> {
        let model = Cycle::new(design, [network, network])?;
        let patches = windows::all(network, raw)?.map(|window| Patch { window, set: Set::First });
        let mut summary = Summary::new(design);
        for patch in model.run(patches) {
            summary.add(&patch);
            if go_on().is_break() {
                return Err(MeasureError::Interrupted);
            }
        }
        Ok(Self { name, summary })
    }
}

/// Pictures through the cycle model, each by itself.
#[derive(Debug, Clone)]
pub struct Measured(pub Vec<Picture>);

impl Measured {
    /// Mean over all patches of all pictures.
    fn mean(&self, of: impl Fn(&Summary) -> f64) -> f64 {
        let weighed = |Picture { summary, .. }: &Picture| (summary.counts.patches as f64, of(summary));
        let sums = self.0.iter().map(weighed);
        let (patches, sum) = sums.fold((0.0, 0.0), |(n, sum), (patches, x)| (n + patches, sum + patches * x));
        sum / f64::max(patches, 1.0)
    }

    /// Cycles per patch, mean over all.
    #[must_use]
    pub fn cycles_per_patch(&self) -> f64 {
        self.mean(Summary::cycles_per_patch)
    }

    fn mean_latency(&self) -> f64 {
        self.mean(Summary::mean_latency)
    }

    fn stages(&self) -> std::ops::Range<usize> {
        0..self.0.first().map_or(0, |picture| picture.summary.stages.len())
    }

    fn mean_pairs(&self) -> Vec<f64> {
        self.stages().map(|stage| self.mean(|summary| summary.mean_pairs()[stage])).collect()
    }

    fn max_cycles(&self) -> u64 {
        self.0.iter().map(|picture| picture.summary.max_cycles).max().unwrap_or(0)
    }

    /// The stage that would have needed the most cycles alone, all pictures together.
    fn limiting_stage(&self) -> usize {
        let alone = |stage: usize| -> f64 { self.0.iter().map(|p| p.summary.stages[stage].alone).sum() };
        self.stages().fold(0, |max, stage| if alone(stage) > alone(max) { stage } else { max })
    }

    /// The picture that takes longest, the first of equal ones.
    #[must_use]
    pub fn worst(&self) -> Option<&Picture> {
        let cycles = |picture: &Picture| picture.summary.cycles_per_patch();
        self.0.iter().reduce(|worst, next| if cycles(next) > cycles(worst) { next } else { worst })
    }
}

/// What a design takes, on pictures or, without them, at most.
#[derive(Debug, Clone)]
pub struct Estimated<'a> {
    design: &'a Design,
    /// The pictures.
    pub measured: Option<&'a Measured>,
    /// Pairs that each stage multiplies of a patch, where measured.
    pub pairs: Option<Vec<f64>>,
    /// By formula.
    pub ahead: Estimate,
    /// Cycles per patch.
    pub cycles: f64,
    /// The stage that limits.
    pub limiting: usize,
    /// Cells of each stage.
    pub stages: Vec<Resources>,
    /// Cells of all stages, the module `chain`.
    pub total: Resources,
    /// Cells of the modules that `stream_core` has around it, by their names.
    pub around: Vec<(&'static str, Resources)>,
    /// Cells of `stream_core`.
    pub stream_core: Resources,
    /// From video input to output at the design's clock, with standard timing, where the board has both by cable.
    pub board: Option<Figures>,
}

impl<'a> Estimated<'a> {
    /// Of a checked design.
    #[must_use]
    pub fn new(design: &'a Design, measured: Option<&'a Measured>) -> Self {
        let pairs = measured.map(Measured::mean_pairs);
        let ahead = estimate(design, pairs.as_deref());
        let cycles = measured.map_or(ahead.cycles_per_patch, Measured::cycles_per_patch);
        let latency = measured.map_or(ahead.latency as f64, Measured::mean_latency);
        let periods = Periods::of_board(design);
        Self {
            limiting: measured.map_or_else(|| ahead.limiting_stage(), Measured::limiting_stage),
            stages: resources::stages(design),
            total: resources::whole(design),
            around: resources::around_the_chain(design),
            stream_core: resources::stream_core(design),
            board: design
                .video_chips()
                .ok()
                .map(|_| figures(design.frame, CoreCycles::of(design, cycles, latency), periods)),
            design,
            measured,
            pairs,
            ahead,
            cycles,
        }
    }

    /// Returns the FPGA that the cells are those of.
    #[must_use]
    pub const fn part(&self) -> &'static Part {
        &self.design.board.part
    }

    /// Returns what passes from cable to cable, where frames are of a video mode's size.
    #[must_use]
    pub fn on_cables(&self) -> Option<&Figures> {
        self.board.as_ref().filter(|_| VideoTiming::mode(self.design.frame).is_some())
    }

    /// Frames per second at the given cycles per patch.
    #[must_use]
    pub fn rate(&self, cycles: f64) -> f64 {
        self.design.clock_mhz * 1e6 / (cycles * self.ahead.patches_per_frame as f64)
    }

    /// All of it as `edof estimate --json` writes it.
    #[must_use]
    pub fn json(&self, weights: Option<&str>) -> Value {
        let Self { design, measured, pairs, ahead, cycles, stages, total, around, stream_core, .. } = self;
        let (names, part) = (stage_names(stages.len()), self.part());
        let picture = |Picture { name, summary }: &Picture| {
            json!({
                "picture": name,
                "patches": summary.counts.patches,
                "cycles_per_patch": summary.cycles_per_patch(),
                "most_cycles_per_patch": summary.max_cycles,
                "frames_per_second": self.rate(summary.cycles_per_patch()),
                "limiting_stage": names[summary.limiting_stage()],
                "pairs_per_patch": summary.mean_pairs(),
            })
        };
        let stage = |(index, used): (usize, &Resources)| {
            json!({
                "stage": names[index],
                "cycles_per_patch": ahead.stages[index].largest(),
                "pairs_per_patch": pairs.as_ref().map(|p| p[index]),
                "resources": part.named(used),
            })
        };
        let (scarcest, share) = part.fullest(total);
        let mut told = json!({
            "design": design.name,
            "weights": weights,
            "clock_mhz": design.clock_mhz,
            "cycles_per_patch": cycles,
            "most_cycles_per_patch": measured.map(Measured::max_cycles),
            "frames_per_second": self.rate(*cycles),
            "limiting_stage": names[self.limiting],
            "board": self.on_cables().map(|board| json!({
                "frames_per_second": board.frames_per_second,
                "memory_written_per_second": board.written,
                "memory_read_per_second": board.read,
                "latency_seconds": board.latency,
            })),
            "scarcest": scarcest,
            "share_of_scarcest": share,
            "stages": stages.iter().enumerate().map(stage).collect::<Vec<_>>(),
            "around_the_chain": around.iter().map(|(module, used)| json!({ "module": module, "resources": part.named(used) })).collect::<Vec<_>>(),
            "stream_core": part.named(stream_core),
            "slowest_picture": measured.and_then(Measured::worst).map(picture),
            "pictures": measured.map(|measured| measured.0.iter().map(picture).collect::<Vec<_>>()),
        });
        for (name, count) in part.named(total).0 {
            told[name.to_lowercase()] = count.into();
        }
        told
    }
}
