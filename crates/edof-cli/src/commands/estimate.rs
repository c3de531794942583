//! `edof estimate`: what a design takes, before any tool runs.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::lens::Depth;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use crate::windows::Shot;
use edof_core::Noise;
use edof_cosim::chain::check::stage_names;
use edof_cosim::estimate::{Estimated, Measured, Picture};
use edof_device::Design;
use edof_device::board::part::Cells;
use edof_golden::cycle::estimate::StageCycles;
use edof_network::FixedNetwork;
use std::path::PathBuf;

/// Estimate a design's cycles per patch, frames per second and FPGA resources
///
/// Stages and chain are the calculator; stream_core is the calculator with all that it needs in a design of your own, from raw pixels to codes. What a board has
/// around it is not counted. Without a network, all values are assumed to be non-zero. With a network, each picture is captured by the network's camera and run through the
/// cycle model, which leaves out zero values if the design skips zeros. For several pictures, the mean over all patches and the slowest
/// picture are printed. The picture affects the cycles, not the resources.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof estimate --design paper
  edof estimate --design kc705 --weights edof-t4w12-outer --photo photo.png --json estimate.json
  edof estimate --design kc705 --weights edof-t4w12-outer --photo a.png --psi 0,4,8 --noise 0.01")]
pub struct Args {
    /// Design, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Picture to measure on; repeatable [default: a built-in scene of dead leaves]
    #[arg(long, value_name = "FILE", requires = "weights")]
    photo: Vec<PathBuf>,

    /// Depths of the pictures, separated by commas: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or distances as in 1.5m if the camera states nominal_m [default: the far end of the network's range]
    #[arg(
        long,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_name = "PSI,…",
        requires = "weights"
    )]
    psi: Vec<Depth>,

    /// Noise of the pictures, in the format of edof capture --noise [default: the strongest noise of the network's training]
    #[arg(long, requires = "weights")]
    noise: Option<Noise>,
}

/// # Errors
/// A design, network or picture that cannot be used.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files =
        Files::new(ui).reads(&args.design).reads_all(args.weights.as_deref().and_then(weights::fixed_file));
    files.reads_all(&args.photo).check()?;
    let design = designs::load(&args.design)?;
    design.clocks().map_err(|e| said::of_file(&args.design, e))?;
    ui.used(designs::input(&design));
    let measured = match &args.weights {
        Some(name) => {
            ui.used(weights::fixed_input(name)?);
            Some(self::measured(&design, &weights::fixed(name)?, &args, ui)?)
        }
        None => None,
    };
    let estimated = Estimated::new(&design, measured.as_ref());
    tell(&design, &estimated, ui)?;
    ui.json(&estimated.json(args.weights.as_deref()))
}

fn tell(design: &Design, estimated: &Estimated<'_>, ui: &Ui) -> Result<(), Error> {
    let Estimated { pairs, ahead, cycles, limiting, stages, total, .. } = estimated;
    let (cycles, frames) = (*cycles, estimated.rate(*cycles));
    let (names, part) = (stage_names(stages.len()), estimated.part());
    let cells = part.named(total);
    ui.say(format!("stage  lanes x rows  values  cycles{}", row(&cells, |(name, _)| (*name).to_owned())))?;
    for (index, (plan, used)) in design.stages().zip(stages).enumerate() {
        let values = pairs.as_ref().map_or(plan.inputs as f64, |p| p[index]);
        let own = StageCycles::largest(&ahead.stages[index]);
        let folded = format!("{} x {}", plan.lanes, plan.rows);
        ui.say(format!(
            "{:5}  {folded:>12}  {values:6.1}  {own:6.1}{}",
            names[index],
            counts(&part.named(used))
        ))?;
    }
    ui.say(format!("{:5}  {:>12}  {:>6}  {cycles:6.1}{}", "chain", "", "", counts(&cells)))?;
    let modules = estimated.around.iter().map(|(module, used)| (*module, *used));
    for (module, used) in modules.chain([("stream_core", estimated.stream_core)]) {
        ui.say(format!("{module:35}{}", counts(&part.named(&used))))?;
    }
    let (scarcest, share) = part.fullest(total);
    ui.say(format!(
        "{frames:.1} frames per second of {}x{} at {} MHz; {} limits; {scarcest} {:.0} % of an {}",
        design.frame.width,
        design.frame.height,
        design.clock_mhz,
        names[*limiting],
        100.0 * share,
        part.name
    ))?;
    ui.say(match estimated.on_cables() {
        Some(board) => format!(
            "from HDMI in to HDMI out: {:.1} frames per second, latency {:.1} to {:.1} ms; memory {:.0} MB/s written, {:.0} MB/s read",
            board.frames_per_second,
            1e3 * board.latency[0],
            1e3 * board.latency[1],
            board.written / 1e6,
            board.read / 1e6
        ),
        None if design.board.is_cabled() => format!(
            "{}x{} is no video mode of board {}: frames per second are the calculator's, for a source of your own (docs/own-design.md)",
            design.frame.width, design.frame.height, design.board.name
        ),
        None => format!("board {} takes no video by cable: frames per second are the calculator's", design.board.name),
    })?;
    if let Some(Measured(pictures)) = estimated.measured
        && pictures.len() > 1
        && let Some(Picture { name, summary }) = estimated.measured.and_then(Measured::worst)
    {
        let cycles = summary.cycles_per_patch();
        ui.say(format!(
            "mean of {} pictures; the slowest is {name}: {cycles:.1} cycles per patch, {:.1} frames per second; {} limits",
            pictures.len(),
            estimated.rate(cycles),
            names[summary.limiting_stage()]
        ))?;
    }
    Ok(())
}

/// Every picture through the cycle model.
fn measured(design: &Design, network: &FixedNetwork, args: &Args, ui: &Ui) -> Result<Measured, Error> {
    designs::fits_given(design, &args.design, network)?;
    let shots = Shot::all(&args.photo, &args.psi, args.noise);
    let bar = ui.progress(shots.len() as u64, "pictures measured");
    let mut pictures = vec![];
    for shot in &shots {
        let raw = shot.frame(network, ui)?;
        let picture = Picture::measure(shot.name(network)?, design, network, &raw, interrupt::flow);
        interrupt::check()?;
        pictures.push(picture.map_err(|e| shot.failed(e))?);
        bar.set(pictures.len() as u64);
    }
    Ok(Measured(pictures))
}

/// A column for each kind of cell, as wide as its name and seven digits.
fn row(cells: &Cells, text: impl Fn(&(&'static str, usize)) -> String) -> String {
    cells.0.iter().map(|cell| format!("  {:>width$}", text(cell), width = cell.0.len().max(7))).collect()
}

fn counts(cells: &Cells) -> String {
    row(cells, |(_, count)| count.to_string())
}
