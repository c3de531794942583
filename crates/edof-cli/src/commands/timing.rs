//! `edof timing`: the worst path of logic of every stage and of every block around them, by Yosys.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::network;
use crate::ui::Ui;
use crate::weights;
use edof_cosim::chain::check::stage_names;
use edof_cosim::system;
use edof_cosim::yosys::fan_out::FanOut;
use edof_cosim::yosys::route::{self, Fabric, Routed, RoutedStep, Router};
use edof_cosim::yosys::timing::{self, Kind, MAX_CROSSED, PartTiming};
use edof_device::Design;
use edof_golden::Display;
use edof_hdl::board::blocks::{self, Block};
use edof_hdl::floorplan::{self, Fill, MAX_FILL};
use serde_json::json;
use std::path::PathBuf;

/// Print the longest logic path of every stage of a design and of every other block of its core, and the nets with the highest fan-out
///
/// Yosys maps each part flat for 7-series, from the generated files, and times it with the delays of its
/// Xilinx library. A large stage takes minutes; results are cached. Wire delays are not included, so logic may take only half of the
/// period of its clock domain. The result shows paths that are too long, not the clock rate of a board.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof timing --design tiny
  edof timing --design kc705 --weights edof-t4w12-outer --json timing.json
  edof timing --design tiny --route ecp5 --stages M1")]
pub struct Args {
    /// Design, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file [default: a random one for the design]
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Ignore cached results and map every stage again
    #[arg(long = "no-cache", alias = "again")]
    again: bool,

    /// Place and route every stage as well, with a nextpnr that is in PATH: xc7k325t (nextpnr-xilinx; EDOF_NEXTPNR_CHIPDB names its chip
    /// database) or ecp5, another fabric, for a test of the tools
    #[arg(long, value_name = "FABRIC", num_args = 0..=1, default_missing_value = "xc7k325t")]
    route: Option<Fabric>,

    /// Map (and route) these stages alone, separated by commas: I, M1, ..., F [default: all stages, and all other blocks]
    #[arg(long = "stages", value_name = "STAGE,…", value_delimiter = ',')]
    wanted: Vec<String>,
}

/// What is mapped.
struct Selection {
    /// Names of the stages.
    names: Vec<String>,
    /// Block of each stage.
    stages: Vec<Block>,
    /// The other blocks: none where only some stages are wanted.
    others: Vec<Block>,
}

fn selected(design: &Design, wanted: &[String]) -> Result<Selection, Error> {
    let stages = blocks::stages(design);
    let names = stage_names(stages.len());
    if let Some(unknown) = wanted.iter().find(|name| !names.contains(name)) {
        let expected = names.join(", ");
        return Err(Error::message(format!("--stages {unknown}: no such stage, expected {expected}")));
    }
    let is_wanted = |name: &String| wanted.is_empty() || wanted.contains(name);
    let (names, stages) = names.into_iter().zip(stages).filter(|(name, _)| is_wanted(name)).unzip();
    let others = if wanted.is_empty() { blocks::around_the_calculator(design) } else { vec![] };
    Ok(Selection { names, stages, others })
}

/// # Errors
/// A design or network that cannot be used, or Yosys is missing.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = Files::new(ui).reads(&args.design);
    files.reads_all(args.weights.as_deref().and_then(weights::fixed_file)).check()?;
    let design = designs::load(&args.design)?;
    let router = args.route.map(Router::find).transpose()?;
    ui.used(designs::input(&design));
    let network = network::of_design(&design, &args.design, args.weights.as_deref(), 1, ui)?;
    let project = system::project(&design, [&network, &network], &Display::default())?;
    let Selection { names, stages, others } = selected(&design, &args.wanted)?;
    let paths: Vec<String> = stages.iter().chain(&others).map(|block| block.path.clone()).collect();
    let bar = ui.progress(paths.len() as u64, "blocks mapped");
    let cache: Option<PathBuf> = timing::user_cache().filter(|_| !args.again);
    let found = timing::parts(&project, &paths, cache.as_deref(), &|done, _| bar.set(done as u64))?;
    drop(bar);

    let (of_stages, of_others) = found.split_at(stages.len());
    for (name, stage) in names.iter().zip(of_stages) {
        tell(name, stage, ui)?;
    }
    for (block, timing) in others.iter().zip(of_others) {
        tell(&format!("{} (at most {} ps)", block.path, block.domain.limit_ps()), timing, ui)?;
    }
    let period = 1e3 / design.clock_mhz;
    let worst = of_stages.iter().map(|stage| stage.delay_ps).max().unwrap_or(0) as f64 / 1e3;
    ui.say(format!(
        "worst stage {worst:.2} ns of logic, {:.0} % of the {period:.2} ns at {} MHz (planned); wires are not in it",
        100.0 * worst / period,
        design.clock_mhz
    ))?;
    let fills = floorplan::fills(&design);
    tell_fills(&fills, ui)?;
    let mut routed = vec![];
    if let Some(router) = &router {
        for (name, block) in names.iter().zip(&stages) {
            let found = route::part(&project, &block.path, router, design.clock_mhz)?;
            tell_routed(name, &found, router, ui)?;
            routed.push(json!({ "stage": name, "routed": found }));
        }
    }
    let long = |(block, timing): &(&Block, &PartTiming)| timing.delay_ps > block.domain.limit_ps();
    let long: Vec<&str> =
        others.iter().zip(of_others).filter(long).map(|(block, _)| block.path.as_str()).collect();
    if !others.is_empty() {
        ui.say(match long[..] {
            [] => "no other block has a path longer than half of the period of its clock".into(),
            _ => format!("longer than half of the period of their clocks: {}", long.join(", ")),
        })?;
    }
    let stage = |(name, stage): (&String, &PartTiming)| json!({ "stage": name, "timing": stage });
    let other = |(block, timing): (&Block, &PartTiming)| json!({ "block": block.path, "limit_ps": block.domain.limit_ps(), "timing": timing });
    let fill = |Fill { block, multipliers, memories }: &Fill| json!({ "block": block, "dsp48e1": multipliers, "ramb36e1": memories });
    ui.json(&json!({
        "design": design.name,
        "weights": args.weights,
        "clock_mhz": design.clock_mhz,
        "worst_ns": worst,
        "stages": names.iter().zip(of_stages).map(stage).collect::<Vec<_>>(),
        "router": router.as_ref().map(Router::name),
        "routed": routed,
        "blocks": others.iter().zip(of_others).map(other).collect::<Vec<_>>(),
        "floorplan": fills.iter().map(fill).collect::<Vec<_>>(),
    }))
}

fn tell(name: &str, stage: &PartTiming, ui: &Ui) -> Result<(), Error> {
    let PartTiming { delay_ps, levels, dsps, registered_dsps, cells, .. } = stage;
    ui.say(format!(
        "{name}: {:.3} ns, {levels} levels; {registered_dsps} of {dsps} multipliers with all registers; {} LUT, {} FF",
        *delay_ps as f64 / 1e3,
        cells.luts(),
        cells.flip_flops()
    ))?;
    for step in &stage.path {
        ui.say(format!("  {:6} ps  {:28} {}", step.arrival_ps, step.cell, step.net))?;
    }
    ui.say(format!("  longest kinds of paths (the same registers but for their numbers), {} registers that lead to two groups of banks", stage.strays.len()))?;
    let (crossed, from) = &stage.crossed;
    if *crossed > 0 {
        ui.say(format!(
            "  the widest path crosses {crossed} borders between blocks of the floorplan, of at most {MAX_CROSSED}, from {from}"
        ))?;
    }
    for Kind { delay_ps, from, to, pin } in &stage.kinds {
        ui.say(format!("  {delay_ps:6} ps  {pin:28} {from} to {to}"))?;
    }
    for (kind, control) in [("control", true), ("data", false)] {
        let nets = stage.nets.iter().filter(|net| net.control == control);
        let told: Vec<String> = nets.map(|FanOut { net, loads, .. }| format!("{net} {loads}")).collect();
        ui.say(format!("  loads, {kind}: {}", told.join(", ")))?;
    }
    Ok(())
}

/// How full the fullest blocks of the floorplan are.
fn tell_fills(fills: &[Fill], ui: &Ui) -> Result<(), Error> {
    for (kind, of) in ["DSP48E1", "RAMB36E1"].into_iter().zip(0..) {
        if let Some(fullest) = fills.iter().max_by_key(|fill| fill.percent()[of]) {
            let (percent, block) = (fullest.percent()[of], &fullest.block);
            ui.say(format!(
                "floorplan: {block} has most of its {kind} used, {percent} % of at most {MAX_FILL} %"
            ))?;
        }
    }
    Ok(())
}

fn tell_routed(name: &str, routed: &Routed, router: &Router, ui: &Ui) -> Result<(), Error> {
    let Routed { mhz, logic_ns, wires_ns, path, .. } = routed;
    ui.say(format!(
        "{name}, routed: {mhz:.1} MHz; worst path {logic_ns:.2} ns of cells, {wires_ns:.2} ns of wires ({}, one seed)",
        router.name()
    ))?;
    for RoutedStep { kind, delay_ns, name, span } in path {
        let far = span.map_or(String::new(), |(columns, rows)| format!("  ({columns} columns, {rows} rows)"));
        ui.say(format!("  {delay_ns:6.2} ns  {kind:10} {name}{far}"))?;
    }
    Ok(())
}
