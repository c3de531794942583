//! `edof estimate`: what a design takes, before any tool runs.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::ui::Ui;
use crate::weights;
use crate::windows;
use edof_cosim::chain::check::stage_names;
use edof_golden::cycle::estimate::{StageCycles, estimate};
use edof_golden::cycle::{Cycle, Patch, Summary};
use edof_hdl::resources::{self, Resources, XC7K325T};
use edof_spec::design::memory::Set;
use edof_spec::{Design, FixedNetwork};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Tell what a design takes: cycles a patch, frames a second, and how much of the FPGA
///
/// Without a network every value counts; with one, values that are zero on a picture are left out if the design skips zeros, and
/// the picture is run through the cycle model. The picture is captured by the network's own camera at the far end of its range.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof estimate --design paper
  edof estimate --design kc705 --weights edof-t4w12-outer --photo photo.png --json estimate.json")]
pub struct Args {
    /// Design: tiny, paper, kc705, or a JSON file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Picture to measure on; without it, a built-in scene of dead leaves
    #[arg(long, value_name = "FILE", requires = "weights")]
    photo: Option<PathBuf>,
}

/// # Errors
/// A design, network or picture that cannot be used.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files =
        Files::new(ui).reads(&args.design).reads_all(args.weights.as_deref().and_then(weights::fixed_file));
    files.reads_all(&args.photo).check()?;
    let design = designs::load(&args.design)?;
    ui.used(designs::input(&design));
    let summary = match &args.weights {
        Some(name) => {
            ui.used(weights::fixed_input(name)?);
            Some(measure(&design, &weights::fixed(name)?, &args, ui)?)
        }
        None => None,
    };
    let pairs = summary.as_ref().map(Summary::mean_pairs);
    let ahead = estimate(&design, pairs.as_deref());
    let cycles = summary.as_ref().map_or(ahead.cycles_per_patch, Summary::cycles_per_patch);
    let limiting = summary.as_ref().map_or_else(|| ahead.limiting_stage(), Summary::limiting_stage);
    let frames = design.clock_mhz * 1e6 / (cycles * ahead.patches_per_frame as f64);
    let stages = resources::stages(&design);
    let total: Resources = stages.iter().copied().sum();
    let names = stage_names(stages.len());

    ui.say("stage  lanes x rows  values  cycles  DSP48E1  RAMB36E1  RAMB18E1      LUT       FF")?;
    for (index, (plan, used)) in design.stages().zip(&stages).enumerate() {
        let values = pairs.as_ref().map_or(plan.inputs as f64, |p| p[index]);
        let own = StageCycles::largest(&ahead.stages[index]);
        let folded = format!("{} x {}", plan.lanes, plan.rows);
        ui.say(format!("{:5}  {folded:>12}  {values:6.1}  {own:6.1}  {}", names[index], row(used)))?;
    }
    ui.say(format!("{:5}  {:>12}  {:>6}  {cycles:6.1}  {}", "all", "", "", row(&total)))?;
    let (scarcest, share) = total.fullest(&XC7K325T);
    ui.say(format!(
        "{frames:.1} frames a second of {}x{} at {} MHz (planned); {} limits; {scarcest} {:.0} % of an XC7K325T",
        design.frame.width,
        design.frame.height,
        design.clock_mhz,
        names[limiting],
        100.0 * share
    ))?;
    let per_stage: Vec<Value> = stages
        .iter()
        .enumerate()
        .map(|(index, used)| {
            json!({
                "stage": names[index],
                "cycles_per_patch": ahead.stages[index].largest(),
                "pairs_per_patch": pairs.as_ref().map(|p| p[index]),
                "resources": used,
            })
        })
        .collect();
    ui.json(&json!({
        "design": design.name,
        "weights": args.weights,
        "dsp48e1": total.dsp48e1,
        "ramb36e1": total.ramb36e1,
        "ramb18e1": total.ramb18e1,
        "lut": total.lut,
        "ff": total.ff,
        "clock_mhz": design.clock_mhz,
        "cycles_per_patch": cycles,
        "most_cycles_per_patch": summary.as_ref().map(|s| s.most_cycles),
        "frames_per_second": frames,
        "limiting_stage": names[limiting],
        "scarcest": scarcest,
        "share_of_scarcest": share,
        "stages": per_stage,
    }))
}

/// A picture through the cycle model.
fn measure(design: &Design, network: &FixedNetwork, args: &Args, ui: &Ui) -> Result<Summary, Error> {
    let raw = windows::frame(network, args.photo.as_deref(), 0, ui)?;
    let patches = windows::of(network, &raw)?.map(|window| Patch { window, set: Set::First });
    let model = Cycle::new(design, [network, network])?;
    let mut summary = Summary::new(design);
    for patch in model.run(patches) {
        summary.add(&patch);
        interrupt::check()?;
    }
    Ok(summary)
}

fn row(used: &Resources) -> String {
    let Resources { dsp48e1, ramb36e1, ramb18e1, lut, ff } = used;
    format!("{dsp48e1:7}  {ramb36e1:8}  {ramb18e1:8}  {lut:7}  {ff:7}")
}
