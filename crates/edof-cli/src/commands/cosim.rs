//! `edof cosim`: the generated Verilog against the cycle model.

use crate::cosim_system;
use crate::designs;
use crate::error::Error;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::lens::Depth;
use crate::network;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use crate::windows::Shot;
use edof_core::Noise;
use edof_core::draw::Draw;
use edof_core::words::number;
use edof_cosim::chain::check::Difference;
use edof_cosim::chain::device::{Device, Inputs};
use edof_cosim::chain::second::{Recorded, icarus};
use edof_cosim::chain::verilated::Compiled;
use edof_cosim::chain::{Drive, Outcome};
use edof_cosim::junit;
use edof_cosim::verilator::{Options, Waveform};
use edof_device::Design;
use edof_device::design::memory::{self, Set};
use edof_golden::cycle::{Cycle, Patch, Stalls};
use edof_hdl::project::{self, Project};
use edof_network::FixedNetwork;
use edof_study::stability::case::{self, Case};
use edof_study::stability::inputs;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Random windows that run through both sets after they were loaded.
const WINDOWS_OF_A_LOAD: usize = 16;
/// Memory of a patch besides its window: what is recorded of its cycles, for the second simulator.
const BYTES_A_PATCH: usize = 200 * size_of::<Inputs>();
/// Cycles that the waveform shows before a difference.
const WAVEFORM_CYCLES: u64 = 300;

/// Run the generated Verilog in Verilator and compare every word and cycle with the model
///
/// Patches are windows of a picture taken by the network's camera, or random windows with extreme values. Registers and
/// memories start with random contents. Every stage boundary is compared in every cycle, and the counters at the end. Then both banks
/// are loaded, word by word, with two random networks, and random windows run through both. The first difference ends the run with
/// exit status 1; a waveform shows it.
///
/// With --system the whole core runs, from the receiver's pins to the transmitter's, with four drifting clocks and a late
/// memory. Every picture on the screen must equal that of edof reconstruct --board, bit for bit. On a board with a camera (ulx3s) everything between
/// its pins runs, from the camera's to the screen's, with a model of its memory; the camera starts amid a frame, and its clock stands still now and then.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof cosim --design tiny --random 2000 --stalls 0.3
  edof cosim --design paper --weights paper-t4 --photo photo.png --patches 2000 --json result.json
  edof cosim --design tiny --cases all --patches 40
  edof cosim --design kc705 --weights edof-t4w12-outer --photo photo.png --psi 4 --noise 0.01
  edof cosim --design paper --weights paper-t4 --rtl build/paper
  edof cosim --design kc705 --weights edof-t4w12-outer --icarus --patches 5 --junit cosim.xml
  edof cosim --system --design tiny --window 12 --stride 4 --size 32x16 --display luma
  edof cosim --system --design tiny --size 32x16 --icarus
  edof cosim --system --design tiny --weights tiny.fixed.safetensors --rtl build/tiny/rtl
  edof cosim --system --design kc705 --weights edof-t4w12-outer --photo a.png --size 256x256
  edof cosim --system --design ulx3s --size 32x24 --frames 2")]
pub struct Args {
    /// Design, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file [default: a random one with extreme weights for the design]
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Picture whose windows are used [default: a built-in scene of dead leaves]
    #[arg(long, value_name = "FILE", conflicts_with = "random")]
    photo: Option<PathBuf>,

    /// Depth of the picture: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or a distance as in 1.5m if the camera states nominal_m [default: the far end of the network's range]
    #[arg(long, allow_hyphen_values = true, conflicts_with = "random")]
    psi: Option<Depth>,

    /// Noise of the picture, in the format of edof capture --noise [default: the strongest noise of the network's training]
    #[arg(long, conflicts_with = "random")]
    noise: Option<Noise>,

    /// Use N random windows with extreme values instead of a picture
    #[arg(long, value_name = "N")]
    random: Option<usize>,

    /// Use windows of the hard cases of edof study stability whose names contain one of these words, or all; at most --patches windows of each
    #[arg(long, value_delimiter = ',', value_name = "WORD,…|all", conflicts_with_all = ["random", "photo", "psi", "noise", "system"])]
    cases: Vec<String>,

    /// Largest number of patches of the picture to run
    #[arg(long, default_value_t = 500, value_name = "N")]
    patches: usize,

    /// Share of cycles in which source and sink stall, 0 to 0.99
    #[arg(long, default_value_t = 0.0, value_name = "SHARE")]
    stalls: f64,

    /// Whether to skip zeros [default: the design's setting]
    #[arg(long, value_parser = ["on", "off"])]
    skip: Option<String>,

    /// Seed of start-up contents, stalls and random windows
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Also run the same inputs in Icarus and compare all outputs, or all pictures; slow
    #[arg(long)]
    icarus: bool,

    /// Use the Verilog of this folder, written by edof generate (or rtl in it) and possibly changed since, instead of newly generated Verilog. It must be of the design; with --weights its memory images must be those of the network
    #[arg(long, value_name = "DIR")]
    rtl: Option<PathBuf>,

    /// File of the waveform of a difference, without extension
    #[arg(long, default_value = "cosim-difference", value_name = "FILE")]
    waveform: PathBuf,

    /// Also write the result as JUnit XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,

    #[command(flatten)]
    system: cosim_system::Args,

    #[command(flatten)]
    force: Force,
}

impl Args {
    /// The picture that is asked for.
    fn shot(&self) -> Shot {
        Shot { photo: self.photo.clone(), psi: self.psi, noise: self.noise, seed: self.seed }
    }
}

/// # Errors
/// A design, network or picture that cannot be used, a simulator that is missing, or a difference.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files =
        Files::new(ui).reads(&args.design).reads_all(args.weights.as_deref().and_then(weights::fixed_file));
    let files = files.reads_all(&args.photo).may_write("--junit", args.junit.as_ref());
    let files = files.keeps(args.force);
    files.writes("--waveform", waveform_file(&args, Waveform::best())).check()?;
    let start = Instant::now();
    let ran = run_either(&args, start, ui);
    let seconds = start.elapsed().as_secs_f64();
    match (&args.junit, &ran) {
        (Some(path), Err(error)) if !matches!(error, Error::Interrupted) => {
            write_junit(path, &args, Some(&error.to_string()), seconds)?;
        }
        (Some(path), Ok(())) => write_junit(path, &args, None, seconds)?,
        _ => {}
    }
    ran
}

/// Runs the calculator or the whole core.
fn run_either(args: &Args, start: Instant, ui: &Ui) -> Result<(), Error> {
    args.rtl.iter().try_for_each(|folder| args.system.check_folder(folder))?;
    let design = args.system.design(designs::load(&args.design)?)?;
    ui.used(designs::input(&design));
    let network = network::of_design(&design, &args.design, args.weights.as_deref(), args.seed, ui)?;
    if let Some(folder) = &args.rtl {
        cosim_system::check_rtl(folder, &design, args.weights.is_some().then_some(&network))?;
    }
    if args.system.system {
        let shot = args.shot();
        let raw = shot.frame(&network, ui)?;
        args.system.has_room(&design, &raw).map_err(|e| shot.failed(e))?;
        let how = cosim_system::Run { seed: args.seed, icarus: args.icarus, rtl: args.rtl.as_deref() };
        return cosim_system::run(&args.system, &design, network, &raw, &how, ui);
    }
    let patches = patches(args, &design, &network, ui)?;
    if patches.is_empty() {
        let option = if args.random == Some(0) { "random" } else { "patches" };
        return Err(Error::message(format!("--{option} 0: must be 1 or more, or nothing is compared")));
    }
    let project = project::calculator(&design, [&network, &network])?;
    let generated = Run { networks: [network.clone(), network], patches, drive: drive(args)? };
    let trial = Trial { runs: [generated, Run::loaded(&design, args.seed)], design };
    let project = cosim_system::with_rtl(project, args.rtl.as_deref())?;
    let outcomes = trial.run(&project, args, ui)?;
    let seconds = start.elapsed().as_secs_f64();
    tell(args, &trial, &outcomes, seconds, ui)?;
    let Some(difference) = first_difference(&outcomes) else { return Ok(()) };
    let driver = difference.driver(&project, trial.design.stages.len());
    let driver = driver.map_or(String::new(), |place| format!("; driven at {place}"));
    let when = if outcomes.len() > 1 { "after both banks were loaded: " } else { "" };
    let found = format!("{when}{difference}{driver}");
    // Whoever stops the run here keeps what was found.
    args.junit.iter().try_for_each(|path| write_junit(path, args, Some(&found), seconds))?;
    ui.note(format_args!("{found}; compiling once more for its waveform"));
    let waveform = trial.waveform(&project, args, &outcomes)?;
    Err(Error::message(format!("{found}; waveform {}", waveform.display())))
}

fn drive(args: &Args) -> Result<Drive, Error> {
    if !(0.0..=0.99).contains(&args.stalls) {
        return Err(Error::message(format!("--stalls {}: must be 0 to 0.99", number(args.stalls))));
    }
    let stalls = Stalls::drawn(args.seed, (256.0 * args.stalls) as u8);
    Ok(Drive { skip_zeros: args.skip.as_ref().map(|s| s == "on"), stalls: Some(stalls), ..Drive::default() })
}

/// The patches to run; random ones use all sets of weights.
fn patches(args: &Args, design: &Design, network: &FixedNetwork, ui: &Ui) -> Result<Vec<Patch>, Error> {
    let draw = &mut Draw::new(args.seed);
    if let Some(count) = args.random {
        let bytes = BYTES_A_PATCH + size_of::<i16>() * design.form.window.pixels();
        said::memory(&format!("--random {count}"), count as f64 * bytes as f64)?;
        let pixels = design.form.window.pixels();
        let patch = |_| Patch {
            set: design.sets()[draw.whole(0, design.sets as i64 - 1) as usize],
            window: edof_device::random::extreme_window(draw, pixels),
        };
        return Ok((0..count).map(patch).collect());
    }
    if !args.cases.is_empty() {
        return hard(args, design, network);
    }
    let shot = args.shot();
    let raw = shot.frame(network, ui)?;
    let windows = edof_golden::windows::all(network, &raw).map_err(|e| shot.failed(e))?.take(args.patches);
    Ok(windows.map(|window| Patch { window, set: Set::First }).collect())
}

/// Windows of hard cases, through all sets of weights by turns.
fn hard(args: &Args, design: &Design, network: &FixedNetwork) -> Result<Vec<Patch>, Error> {
    let named = |case: &Case| args.cases.iter().any(|word| word == "all" || case.id.contains(word));
    let mut patches = vec![];
    for case in case::own()?.into_iter().filter(named) {
        interrupt::check()?;
        let windows = inputs::windows(&case, network, args.patches)
            .map_err(|why| Error::message(format!("--cases {}: {why}", case.id)))?;
        let sets = design.sets().iter().cycle().copied();
        patches.extend(windows.into_iter().zip(sets).map(|(window, set)| Patch { set, window }));
    }
    if patches.is_empty() {
        let words = args.cases.join(",");
        return Err(Error::message(format!("--cases {words}: no case of such a name has windows")));
    }
    Ok(patches)
}

fn waveform_file(args: &Args, waveform: Waveform) -> PathBuf {
    args.waveform.with_extension(waveform.extension())
}

/// Networks in both sets, and patches through them.
struct Run {
    networks: [FixedNetwork; 2],
    patches: Vec<Patch>,
    drive: Drive,
}

impl Run {
    /// Random networks, written to all sets after whatever ran before, and windows through each by turns. Nothing is skipped, so that
    /// every word of the memories is multiplied.
    fn loaded(design: &Design, seed: u64) -> Self {
        let networks = [1, 2].map(|more| edof_device::random::for_design(design, seed.wrapping_add(more)));
        let sets = design.sets();
        let words = |(set, network): (&Set, &FixedNetwork)| memory::writes(design, network, *set);
        let writes = sets.iter().zip(&networks).flat_map(words).collect();
        let draw = &mut Draw::new(seed);
        let pixels = design.form.window.pixels();
        let patch = |i: usize| Patch {
            set: sets[i % sets.len()],
            window: edof_device::random::extreme_window(draw, pixels),
        };
        let patches = (0..WINDOWS_OF_A_LOAD).map(patch).collect();
        let drive = Drive { flush: true, skip_zeros: Some(false), writes, ..Drive::default() };
        Self { networks, patches, drive }
    }

    /// Runs the patches and compares every boundary in every cycle.
    fn through(&self, design: &Design, device: &mut impl Device, ui: Option<&Ui>) -> Result<Outcome, Error> {
        let [first, second] = &self.networks;
        let model = Cycle::new(design, [first, second])?;
        let bar = ui.map(|ui| ui.progress(self.patches.len() as u64, "patches compared"));
        let patches = self.patches.iter().take_while(|_| interrupt::check().is_ok()).cloned();
        let outcome = self.drive.run(model, patches, device, &mut |done| {
            if let Some(bar) = &bar {
                bar.set(done);
            }
        })?;
        drop(bar);
        interrupt::check()?;
        Ok(outcome)
    }
}

/// What is run on one circuit: the network that its memories start with, then two that are loaded.
struct Trial {
    design: Design,
    runs: [Run; 2],
}

/// The difference that ended the last of some runs.
fn first_difference(outcomes: &[Outcome]) -> Option<&Difference> {
    outcomes.last().and_then(|outcome| outcome.difference.as_ref())
}

impl Trial {
    /// The outcomes of all runs up to the first with a difference.
    fn run(&self, project: &Project, args: &Args, ui: &Ui) -> Result<Vec<Outcome>, Error> {
        let options = Options { cache: Options::user_cache(), ..Options::default() };
        ui.note(format!("compiling {} modules with Verilator", project.verilog.len()));
        let compiled = Compiled::new(project, self.design.stages.len(), &options)?;
        interrupt::check()?;
        let mut device = Recorded::new(compiled.start(args.seed)?);
        let [generated, loaded] = &self.runs;
        let mut outcomes = vec![generated.through(&self.design, &mut device, Some(ui))?];
        if args.icarus && first_difference(&outcomes).is_none() {
            ui.note("running the same inputs in Icarus");
            if let Some(difference) = icarus(project, &compiled, device.inputs(), args.seed)? {
                return Err(Error::message(format!("Icarus differs from Verilator: {difference}")));
            }
        }
        if first_difference(&outcomes).is_none() {
            ui.note("loading both banks, word by word");
            outcomes.push(loaded.through(&self.design, &mut device, Some(ui))?);
        }
        Ok(outcomes)
    }

    /// Runs once more, with the last cycles before the difference in a waveform.
    fn waveform(&self, project: &Project, args: &Args, outcomes: &[Outcome]) -> Result<PathBuf, Error> {
        let waveform = Waveform::best();
        let path = waveform_file(args, waveform);
        let options = Options { waveform, cache: Options::user_cache(), ..Options::default() };
        let mut device =
            Recorded::new(Compiled::new(project, self.design.stages.len(), &options)?.start(args.seed)?);
        for (run, outcome) in self.runs.iter().zip(outcomes) {
            if outcome.difference.is_some() {
                let end = device.inputs().len() as u64 + outcome.lead + outcome.cycles;
                device.device().model().trace_window(&path, end.saturating_sub(WAVEFORM_CYCLES), end + 1)?;
            }
            run.through(&self.design, &mut device, None)?;
        }
        Ok(path)
    }
}

fn tell(args: &Args, trial: &Trial, outcomes: &[Outcome], seconds: f64, ui: &Ui) -> Result<(), Error> {
    let Some(outcome) = outcomes.first() else { return Ok(()) };
    let (design, summary) = (&trial.design, &outcome.summary);
    let boundaries = design.stages.len() + 1;
    let difference = first_difference(outcomes);
    let patches = summary.counts.patches;
    if outcome.difference.is_none() {
        ui.say(format!(
            "{}: {patches} patches, {} beats at {boundaries} boundaries, {} cycles: no difference; {:.1} cycles per patch, at most {}",
            design.name, outcome.beats, outcome.cycles, summary.cycles_per_patch(), summary.max_cycles
        ))?;
    }
    if args.rtl.is_some() && args.weights.is_none() {
        ui.note(
            "the network was a random one, as --weights names none: memory images of --rtl were not compared",
        );
    }
    let words = trial.runs[1].drive.writes.len();
    let loaded = outcomes.get(1).map(|outcome| (outcome.summary.counts.patches, outcome));
    if let Some((patches, Outcome { difference: None, beats, .. })) = loaded {
        ui.say(format!(
            "{}: both banks loaded with {words} words; {patches} patches, {beats} beats: no difference",
            design.name
        ))?;
    }
    ui.json(&json!({
        "design": design.name,
        "weights": args.weights,
        "patches": patches,
        "boundaries": boundaries,
        "beats": outcome.beats,
        "differences": usize::from(difference.is_some()),
        "first_difference": difference,
        "loaded": loaded.map(|(patches, outcome)| json!({ "words": words, "patches": patches, "beats": outcome.beats })),
        "cycles": outcome.cycles,
        "cycles_per_patch": { "mean": summary.cycles_per_patch(), "max": summary.max_cycles },
        "stalls": args.stalls,
        "seed": args.seed,
        "icarus": args.icarus,
        "seconds": seconds,
    }))
}

fn write_junit(path: &Path, args: &Args, failure: Option<&str>, seconds: f64) -> Result<(), Error> {
    // No count: a name that changes with the options has no history in a CI.
    let name = if args.system.system {
        "every picture on the screen, from pins to pins"
    } else {
        "every word at every boundary, and every cycle"
    };
    let xml = junit::report(&format!("cosim {}", args.design), name, seconds, failure);
    edof_core::storage::atomic::write(path, xml.as_bytes())?;
    Ok(())
}
