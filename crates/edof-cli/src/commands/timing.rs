//! `edof timing`: the worst path of logic of every stage, by Yosys.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::weights;
use edof_cosim::chain::check::stage_names;
use edof_cosim::yosys::fan_out::FanOut;
use edof_cosim::yosys::timing::{self, StageTiming};
use edof_hdl::project;
use serde_json::json;
use std::path::PathBuf;

/// Tell the longest path of logic of every stage of a design, and the nets that lead to the most loads
///
/// Each stage is mapped flat for 7-series by Yosys, from the generated files as they are, and timed by Yosys with the delays of its
/// Xilinx library. A big stage takes minutes; results are kept. Wires take no time in it, so that half of the period must be left to
/// them: it tells which paths are too long, not at which clock a board will run.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof timing --design tiny
  edof timing --design kc705 --weights edof-t4w12-outer --json timing.json")]
pub struct Args {
    /// Design: tiny, paper, kc705, or a JSON file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file; without it, one is drawn for the design
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Map every stage again, whatever was kept
    #[arg(long)]
    again: bool,
}

/// # Errors
/// A design or network that cannot be used, or Yosys is missing.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = Files::new(ui).reads(&args.design);
    files.reads_all(args.weights.as_deref().and_then(weights::fixed_file)).check()?;
    let design = designs::load(&args.design)?;
    ui.used(designs::input(&design));
    let network = match &args.weights {
        Some(name) => {
            ui.used(weights::fixed_input(name)?);
            weights::fixed(name)?
        }
        None => edof_random::for_design(&design, 1),
    };
    let project = project::calculator(&design, [&network, &network])?;
    let count = design.stages.len();
    let bar = ui.progress(count as u64, "stages mapped");
    let cache: Option<PathBuf> = timing::user_cache().filter(|_| !args.again);
    let stages = timing::stages(&project, count, cache.as_deref(), &|done, _| bar.set(done as u64))?;
    drop(bar);

    let names = stage_names(count);
    let period = 1e3 / design.clock_mhz;
    for (name, stage) in names.iter().zip(&stages) {
        tell(name, stage, ui)?;
    }
    let worst = stages.iter().map(|stage| stage.delay_ps).max().unwrap_or(0) as f64 / 1e3;
    ui.say(format!(
        "worst {worst:.2} ns of logic, {:.0} % of the {period:.2} ns at {} MHz (planned); wires are not in it",
        100.0 * worst / period,
        design.clock_mhz
    ))?;
    let stage = |(name, stage): (&String, &StageTiming)| json!({ "stage": name, "timing": stage });
    ui.json(&json!({
        "design": design.name,
        "weights": args.weights,
        "clock_mhz": design.clock_mhz,
        "worst_ns": worst,
        "stages": names.iter().zip(&stages).map(stage).collect::<Vec<_>>(),
    }))
}

fn tell(name: &str, stage: &StageTiming, ui: &Ui) -> Result<(), Error> {
    let StageTiming { delay_ps, levels, dsps, registered_dsps, .. } = stage;
    ui.say(format!(
        "{name}: {:.3} ns, {levels} levels; {registered_dsps} of {dsps} multipliers with all registers",
        *delay_ps as f64 / 1e3
    ))?;
    for step in &stage.path {
        ui.say(format!("  {:6} ps  {:28} {}", step.arrival_ps, step.cell, step.net))?;
    }
    for (kind, control) in [("control", true), ("data", false)] {
        let nets = stage.nets.iter().filter(|net| net.control == control);
        let told: Vec<String> = nets.map(|FanOut { net, loads, .. }| format!("{net} {loads}")).collect();
        ui.say(format!("  loads, {kind}: {}", told.join(", ")))?;
    }
    Ok(())
}
