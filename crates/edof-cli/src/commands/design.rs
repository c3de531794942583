//! `edof design`: design files made and checked.

use crate::designs;
use crate::error::Error;
use crate::files::{Files, Force};
use crate::form;
use crate::kind::Kind;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use clap::builder::PossibleValuesParser;
use edof_core::Stride;
use edof_core::colour::OUTPUTS_422;
use edof_core::words::number;
use edof_cosim::promise::Promise;
use edof_device::Design;
use edof_device::board::{Board, Part};
use edof_device::design::{FrameSize, StageSize};
use edof_golden::cycle::estimate::estimate;
use edof_golden::cycle::explore::foldings;
use edof_hdl::resources;
use edof_io::raw::Size;
use edof_network::network::Form;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Make a design file, or check one: its speed and resources, and whether a network fits it
///
/// A design defines the generated hardware: the network architecture, the folding of each stage (how many outputs
/// and values it computes with at once), the clock and the picture. docs/design.md lists every field with its units and legal values.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof design new --form edof-t4w12 --size 1280x720 --clock-mhz 150 --out mine.json
  edof design new --weights mine.fixed.safetensors --multipliers 400 --out small.json
  edof design new --form edof-t4w12 --fps 30 --out thrifty.json
  edof design check mine.json --weights mine.fixed.safetensors
  edof design check kc705 --json")]
pub struct Args {
    #[command(subcommand)]
    task: Task,
}

#[derive(clap::Subcommand)]
enum Task {
    New(New),
    Check(Check),
}

/// Write a design file: the folding that is fastest when no value is zero, within the multipliers and the board's FPGA; with --fps the one
/// with the fewest multipliers that is fast enough
///
/// Within the FPGA is what stream_core takes (edof estimate). The design has two sets of weights, or one where two do not fit and the board takes one.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof design new --form edof-t4w12 --size 1280x720 --clock-mhz 150 --out mine.json
  edof design new --weights mine.fixed.safetensors --multipliers 400 --out small.json
  edof design new --form edof-t4w12 --fps 30 --out thrifty.json")]
struct New {
    /// Architecture of its networks
    #[arg(long, value_parser = form::parse, long_help = form::help(), required_unless_present = "weights", conflicts_with = "weights")]
    form: Option<Form>,

    /// Network to run, by name or file: sets architecture, bits, accumulators and stride
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Design file to write, JSON
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Name of the design: letters, digits, '-', '_' and '.' [default: OUT without its extension]
    #[arg(long)]
    name: Option<String>,

    /// Board to make it for
    #[arg(long, value_parser = PossibleValuesParser::new(Board::names()), default_value = "kc705")]
    board: String,

    /// Clock of the calculator in MHz, above 0, at most 400; on the KC705 a rate that an MMCM makes of 200 MHz
    #[arg(long, default_value_t = 200.0, value_name = "MHZ")]
    clock_mhz: f64,

    /// Size of a picture in pixels
    #[arg(long, default_value = "1920x1080", value_name = "WIDTHxHEIGHT")]
    size: Size,

    /// Pixels from one patch to the next: 2, 4 or 8 [default: the network's, else 8]
    #[arg(long, value_name = "PIXELS")]
    stride: Option<usize>,

    /// Largest number of multipliers of the calculator [default: as many as fit the board, on the KC705 830 DSP48E1]
    #[arg(long, value_name = "N")]
    multipliers: Option<usize>,

    /// Frames per second to reach when no value is zero, with as few multipliers as possible [default: as many as possible]
    #[arg(long)]
    fps: Option<f64>,

    #[command(flatten)]
    force: Force,
}

/// Check a design: its fields, its frames and clock on a board, and whether a network fits it
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof design check mine.json --weights mine.fixed.safetensors")]
struct Check {
    /// Design, by name or file
    #[arg(value_name = "NAME|FILE")]
    design: String,

    /// Quantized network to run, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,
}

/// # Errors
/// A design that cannot be built or that no board takes, a network that does not fit, a file that cannot be written.
pub fn run(args: &Args, ui: &Ui) -> Result<(), Error> {
    match &args.task {
        Task::New(new) => new.run(ui),
        Task::Check(check) => check.run(ui),
    }
}

impl New {
    fn run(&self, ui: &Ui) -> Result<(), Error> {
        let files = Files::new(ui).reads_all(self.weights.as_deref().and_then(weights::fixed_file));
        files.writes_as(Kind::Design, "--out", &self.out).keeps(self.force).check()?;
        let design = self.folded(&self.base()?)?;
        let promise = Promise::of(&design).map_err(|e| self.of_options(&e))?;
        save(&self.out, &design)?;
        if design.sets == 1 {
            ui.note("two sets of weights do not fit; the design has one, which is loaded while the calculator stands");
        }
        tell(&design, &promise, ui)?;
        ui.json(&json!({ "design": design, "out": self.out.display().to_string(), "promise": promise }))
    }

    /// The folding that is asked for.
    fn folded(&self, base: &Design) -> Result<Design, Error> {
        if let Some(fps) = self.fps.filter(|fps| !(fps.is_finite() && *fps > 0.0)) {
            return Err(Error::message(format!("--fps {}: must be more than 0", number(fps))));
        }
        let pairs: Vec<f64> = base.stages().map(|stage| stage.inputs as f64).collect();
        let part = &base.board.part;
        let multipliers = self.multipliers.unwrap_or(part.cells.multipliers);
        let fits = |design: &Design| {
            resources::whole(design).multipliers <= multipliers && part.has(&resources::stream_core(design))
        };
        // Two sets of weights, or one where two do not fit.
        let mut all = vec![];
        for sets in base.board.sets.iter().copied().rev() {
            all.extend(foldings(&Design { sets, ..base.clone() }, &pairs));
            if all.iter().any(fits) {
                break;
            }
        }
        let fitting: Vec<&Design> = all.iter().filter(|design| fits(design)).collect();
        let cycles = |design: &Design| estimate(design, None).cycles_per_patch;
        let fastest = fitting.iter().min_by(|a, b| cycles(a).total_cmp(&cycles(b)));
        let fastest = *fastest.ok_or_else(|| self.none_fits(&all, part, multipliers))?;
        let Some(fps) = self.fps else { return Ok(fastest.clone()) };
        let frames = |design: &Design| estimate(design, None).frames_per_second;
        // The cheapest come first.
        fitting.into_iter().find(|design| frames(design) >= fps).cloned().ok_or_else(|| {
            Error::message(format!(
                "--fps {}: the fastest folding with at most {multipliers} multipliers makes {:.1} frames per second at {} MHz; \
                 choose a smaller --form or --size, a higher --clock-mhz, or a larger --stride",
                number(fps),
                frames(fastest),
                base.clock_mhz
            ))
        })
    }

    /// What to change where no folding fits.
    fn none_fits(&self, foldings: &[Design], part: &Part, multipliers: usize) -> Error {
        let fitting = foldings.iter().filter(|design| part.has(&resources::stream_core(design)));
        if let Some(fewest) = fitting.map(|design| resources::whole(design).multipliers).min() {
            return Error::message(format!(
                "--multipliers {multipliers}: must be at least {fewest}, with which a folding of this form fits an {}",
                part.name
            ));
        }
        let network = self.weights.as_ref().map_or("--form".to_owned(), |name| format!("--weights {name}"));
        let shares = foldings.iter().map(|design| part.fullest(&resources::stream_core(design)));
        let (cell, share) = shares.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        Error::message(format!(
            "{network}: no folding fits an {}, as the smallest needs {:.0} % of its {cell}; use a smaller network, or another --board",
            part.name,
            100.0 * share
        ))
    }

    /// The design with one lane for as many outputs as may be, before it is folded.
    fn base(&self) -> Result<Design, Error> {
        let network = self.weights.as_deref().map(weights::fixed).transpose()?;
        let form = self.form.or(network.as_ref().map(|network| network.form));
        let form = form.unwrap_or_else(|| unreachable!("the options ask for one of them"));
        let own = network.as_ref().map_or(Stride::PATCH, |network| network.stride);
        let stride = self.stride.map_or(Ok(own), said::stride)?;
        let last = form.layers - 1;
        let lanes = |stage: usize| if stage == last { OUTPUTS_422 } else { form.codes };
        let stem = self.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let design = Design {
            name: self.name.clone().unwrap_or(stem),
            clock_mhz: self.clock_mhz,
            form,
            code_bits: network.as_ref().map_or(16, |network| network.code_bits),
            accumulator_bits: network
                .as_ref()
                .map_or(40, |n| n.accumulator_bits().into_iter().max().unwrap_or(0).max(32)),
            skip_zeros: true,
            stages: (0..=last).map(|stage| StageSize { lanes: lanes(stage), rows: 1 }).collect(),
            frame: FrameSize { width: self.size.width, height: self.size.height, stride },
            sets: 2,
            board: Board::named(&self.board).unwrap_or_default(),
            camera: None,
        };
        design.check().map_err(|e| self.of_options(&e))?;
        if let Some(network) = &network {
            design.check_network(network).map_err(|e| self.of_options(&e))?;
        }
        Ok(design)
    }

    /// What is wrong, by the option that says so.
    fn of_options(&self, error: &edof_device::design::DesignError) -> Error {
        let text = error.to_string();
        let clock = number(self.clock_mhz);
        match text.split([' ', ':']).next().unwrap_or_default() {
            "clock_mhz" => said::instead(&format!("--clock-mhz {clock}"), error),
            "frame" => said::instead(&format!("--size {}", self.size), error),
            "name" => Error::message(format!("--{text}")),
            "form.codes" | "form.exposures" | "stages" | "layers" => {
                Error::message(format!("--form: {text}"))
            }
            _ => Error::message(text),
        }
    }
}

impl Check {
    fn run(&self, ui: &Ui) -> Result<(), Error> {
        let files = Files::new(ui).reads(&self.design);
        files.reads_all(self.weights.as_deref().and_then(weights::fixed_file)).check()?;
        let design = designs::load(&self.design)?;
        ui.used(designs::input(&design));
        if let Some(name) = &self.weights {
            ui.used(weights::fixed_input(name)?);
            designs::fits_given(&design, &self.design, &weights::fixed(name)?)?;
        }
        let promise = Promise::of(&design).map_err(|e| said::of_file(&self.design, e))?;
        tell(&design, &promise, ui)?;
        if let Some(name) = &self.weights {
            ui.say(format!("{name} fits it"))?;
        }
        ui.json(&json!({ "design": design, "weights": self.weights, "promise": promise }))
    }
}

/// Writes a design file.
pub fn save(path: &Path, design: &Design) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(design)? + "\n";
    Ok(edof_core::storage::atomic::write(path, text.as_bytes())?)
}

fn tell(design: &Design, promise: &Promise, ui: &Ui) -> Result<(), Error> {
    let stages = design.stages.iter().map(|stage| format!("{}x{}", stage.lanes, stage.rows));
    let stages = stages.collect::<Vec<_>>().join(" ");
    ui.say(format!("{}: {}, lanes x rows {stages}", design.name, form::words(&design.form)))?;
    promise.rows(design).iter().try_for_each(|(what, text)| ui.say(format!("  {what}: {text}")))
}
