//! `edof estimate`: what a design takes, before any tool runs.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::lens::Depth;
use crate::ui::Ui;
use crate::weights;
use crate::windows::{self, Shot};
use edof_cosim::chain::check::stage_names;
use edof_device::Design;
use edof_device::board;
use edof_device::design::memory::Set;
use edof_golden::cycle::estimate::{Estimate, StageCycles, estimate};
use edof_golden::cycle::{Cycle, Patch, Summary};
use edof_golden::video::figures::{CoreCycles, Figures, Periods, figures};
use edof_hdl::resources::{self, Resources, XC7K325T};
use edof_image::Noise;
use edof_network::FixedNetwork;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Tell what a design takes: cycles a patch, frames a second, and how much of the FPGA
///
/// Without a network every value counts; with one, values that are zero on a picture are left out if the design skips zeros, and
/// pictures are run through the cycle model, each captured by the network's own camera. A scene with many values takes longer, and
/// its bits are the same: of several pictures the mean over all patches is told, and the one that takes longest.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof estimate --design paper
  edof estimate --design kc705 --weights edof-t4w12-outer --photo photo.png --json estimate.json
  edof estimate --design kc705 --weights edof-t4w12-outer --photo a.png --photo b.png --psi 0,4,8 --noise 0.01")]
pub struct Args {
    /// Design: tiny, paper, kc705, or a JSON file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Picture to measure on, may be given several times; without one, a built-in scene of dead leaves
    #[arg(long, value_name = "FILE", requires = "weights")]
    photo: Vec<PathBuf>,

    /// Depths of the pictures, commas between them: psi in radians, or distances as in 1.5m [default: the far end of the network's range]
    #[arg(
        long,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_name = "PSI,…",
        requires = "weights"
    )]
    psi: Vec<Depth>,

    /// Noise of the pictures, as edof capture takes it [default: the most that the network was trained for]
    #[arg(long, requires = "weights")]
    noise: Option<Noise>,
}

/// # Errors
/// A design, network or picture that cannot be used, a file that cannot be written, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files =
        Files::new(ui).reads(&args.design).reads_all(args.weights.as_deref().and_then(weights::fixed_file));
    files.reads_all(&args.photo).check()?;
    let design = designs::load(&args.design)?;
    board::screen_clock(&design)?;
    ui.used(designs::input(&design));
    let measured = match &args.weights {
        Some(name) => {
            ui.used(weights::fixed_input(name)?);
            Some(Measured::new(&design, &weights::fixed(name)?, &args, ui)?)
        }
        None => None,
    };
    let estimated = Estimated::new(&design, measured);
    estimated.tell(ui)?;
    ui.json(&estimated.to_json(args.weights.as_deref()))
}

/// What a design takes.
struct Estimated<'a> {
    design: &'a Design,
    measured: Option<Measured>,
    pairs: Option<Vec<f64>>,
    ahead: Estimate,
    /// Of a patch.
    cycles: f64,
    board: Figures,
    stages: Vec<Resources>,
    total: Resources,
    names: Vec<String>,
    /// The name of the stage that limits the pace.
    limiting: String,
}

impl<'a> Estimated<'a> {
    fn new(design: &'a Design, measured: Option<Measured>) -> Self {
        let pairs = measured.as_ref().map(Measured::mean_pairs);
        let ahead = estimate(design, pairs.as_deref());
        let cycles = measured.as_ref().map_or(ahead.cycles_per_patch, Measured::cycles_per_patch);
        let limiting = measured.as_ref().map_or_else(|| ahead.limiting_stage(), Measured::limiting_stage);
        let latency = measured.as_ref().map_or(ahead.latency as f64, Measured::mean_latency);
        let (board, stages) = (figures_of(design, cycles, latency), resources::stages(design));
        let (total, names) = (resources::whole(design), stage_names(stages.len()));
        let limiting = names[limiting].clone();
        Self { design, measured, pairs, ahead, cycles, board, stages, total, names, limiting }
    }

    /// Frames a second at so many cycles a patch.
    fn rate(&self, cycles: f64) -> f64 {
        self.design.clock_mhz * 1e6 / (cycles * self.ahead.patches_per_frame as f64)
    }

    fn tell(&self, ui: &Ui) -> Result<(), Error> {
        let Self { design, cycles, board, names, limiting, .. } = self;
        ui.say("stage  lanes x rows  values  cycles  DSP48E1  RAMB36E1  RAMB18E1      LUT       FF")?;
        for (index, (plan, used)) in design.stages().zip(&self.stages).enumerate() {
            let values = self.pairs.as_ref().map_or(plan.inputs as f64, |p| p[index]);
            let own = StageCycles::largest(&self.ahead.stages[index]);
            let folded = format!("{} x {}", plan.lanes, plan.rows);
            ui.say(format!("{:5}  {folded:>12}  {values:6.1}  {own:6.1}  {}", names[index], row(used)))?;
        }
        ui.say(format!("{:5}  {:>12}  {:>6}  {cycles:6.1}  {}", "all", "", "", row(&self.total)))?;
        let (scarcest, share) = self.total.fullest(&XC7K325T);
        ui.say(format!(
            "{:.1} frames a second of {}x{} at {} MHz; {limiting} limits; {scarcest} {:.0} % of an XC7K325T",
            self.rate(*cycles),
            design.frame.width,
            design.frame.height,
            design.clock_mhz,
            100.0 * share
        ))?;
        ui.say(format!(
            "from HDMI in to HDMI out: {:.1} frames a second, latency {:.1} to {:.1} ms; memory {:.0} MB/s written, {:.0} MB/s read",
            board.frames_per_second,
            1e3 * board.latency[0],
            1e3 * board.latency[1],
            board.written / 1e6,
            board.read / 1e6
        ))?;
        if let Some(Measured(pictures)) = &self.measured
            && pictures.len() > 1
            && let Some(Picture { name, summary }) = worst(pictures)
        {
            let cycles = summary.cycles_per_patch();
            ui.say(format!(
                "mean of {} pictures; the slowest is {name}: {cycles:.1} cycles a patch, {:.1} frames a second; {} limits",
                pictures.len(),
                self.rate(cycles),
                names[summary.limiting_stage()]
            ))?;
        }
        Ok(())
    }

    fn to_json(&self, weights: Option<&str>) -> Value {
        let Self { design, board, total, measured, .. } = self;
        let (scarcest, share) = total.fullest(&XC7K325T);
        let picture = |picture: &Picture| self.picture(picture);
        let stage = |(index, used): (usize, &Resources)| {
            json!({
                "stage": self.names[index],
                "cycles_per_patch": self.ahead.stages[index].largest(),
                "pairs_per_patch": self.pairs.as_ref().map(|p| p[index]),
                "resources": used,
            })
        };
        json!({
            "design": design.name,
            "weights": weights,
            "dsp48e1": total.dsp48e1,
            "ramb36e1": total.ramb36e1,
            "ramb18e1": total.ramb18e1,
            "lut": total.lut,
            "ff": total.ff,
            "clock_mhz": design.clock_mhz,
            "cycles_per_patch": self.cycles,
            "most_cycles_per_patch": measured.as_ref().map(Measured::most_cycles),
            "frames_per_second": self.rate(self.cycles),
            "limiting_stage": self.limiting,
            "board": {
                "frames_per_second": board.frames_per_second,
                "memory_written_per_second": board.written,
                "memory_read_per_second": board.read,
                "latency_seconds": board.latency,
            },
            "scarcest": scarcest,
            "share_of_scarcest": share,
            "stages": self.stages.iter().enumerate().map(stage).collect::<Vec<_>>(),
            "slowest_picture": measured.as_ref().and_then(|measured| worst(&measured.0)).map(picture),
            "pictures": measured.as_ref().map(|measured| measured.0.iter().map(picture).collect::<Vec<_>>()),
        })
    }

    fn picture(&self, Picture { name, summary }: &Picture) -> Value {
        json!({
            "picture": name,
            "patches": summary.counts.patches,
            "cycles_per_patch": summary.cycles_per_patch(),
            "most_cycles_per_patch": summary.most_cycles,
            "frames_per_second": self.rate(summary.cycles_per_patch()),
            "limiting_stage": self.names[summary.limiting_stage()],
            "pairs_per_patch": summary.mean_pairs(),
        })
    }
}

/// The whole board at the design's clock, a camera and a screen of its frames' standard timing.
fn figures_of(design: &Design, cycles_a_patch: f64, patch_latency: f64) -> Figures {
    let core = (1e6 / design.clock_mhz) as u64;
    let periods = Periods { core, ..Periods::of_board(design.frame) };
    figures(design.frame, CoreCycles::of(design, cycles_a_patch, patch_latency), periods)
}

/// A picture that went through the cycle model.
struct Picture {
    name: String,
    summary: Summary,
}

/// Pictures through the cycle model, each by itself.
struct Measured(Vec<Picture>);

impl Measured {
    fn new(design: &Design, network: &FixedNetwork, args: &Args, ui: &Ui) -> Result<Self, Error> {
        designs::fits(design, network)?;
        let model = Cycle::new(design, [network, network])?;
        let shots = Shot::all(&args.photo, &args.psi, args.noise);
        let bar = ui.progress(shots.len() as u64, "pictures measured");
        let mut pictures = vec![];
        for shot in &shots {
            let raw = shot.frame(network, ui)?;
            let patches = windows::of(network, &raw)?.map(|window| Patch { window, set: Set::First });
            let mut summary = Summary::new(design);
            for patch in model.run(patches) {
                summary.add(&patch);
                interrupt::check()?;
            }
            pictures.push(Picture { name: shot.name(network)?, summary });
            bar.set(pictures.len() as u64);
        }
        Ok(Self(pictures))
    }

    /// Mean over all patches of all pictures.
    fn mean(&self, of: impl Fn(&Summary) -> f64) -> f64 {
        let weighed = |Picture { summary, .. }: &Picture| (summary.counts.patches as f64, of(summary));
        let sums = self.0.iter().map(weighed);
        let (patches, sum) = sums.fold((0.0, 0.0), |(n, sum), (patches, x)| (n + patches, sum + patches * x));
        sum / f64::max(patches, 1.0)
    }

    fn cycles_per_patch(&self) -> f64 {
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

    fn most_cycles(&self) -> u64 {
        self.0.iter().map(|picture| picture.summary.most_cycles).max().unwrap_or(0)
    }

    /// The stage that would have needed the most cycles alone, all pictures together.
    fn limiting_stage(&self) -> usize {
        let alone = |stage: usize| -> f64 { self.0.iter().map(|p| p.summary.stages[stage].alone).sum() };
        self.stages().fold(0, |most, stage| if alone(stage) > alone(most) { stage } else { most })
    }
}

/// The picture that takes longest, the first of equal ones.
fn worst(pictures: &[Picture]) -> Option<&Picture> {
    let cycles = |picture: &Picture| picture.summary.cycles_per_patch();
    pictures.iter().reduce(|worst, next| if cycles(next) > cycles(worst) { next } else { worst })
}

fn row(used: &Resources) -> String {
    let Resources { dsp48e1, ramb36e1, ramb18e1, lut, ff } = used;
    format!("{dsp48e1:7}  {ramb36e1:8}  {ramb18e1:8}  {lut:7}  {ff:7}")
}
