//! Options of `edof train`.

use crate::error::Error;
use crate::files::Force;
use crate::form;
use crate::lens::{Depth, DepthRange};
use crate::psf_bank::BankOptions;
use crate::said::single;
use clap::ValueEnum;
use edof_core::Tone;
use edof_io::photos::Selection;
use edof_network::network::Form;
use edof_train::recipe::Trained;
use edof_train::structure::Structure;
use edof_train::{initial, weighting};
use std::path::PathBuf;
use std::time::Duration;

/// Train a float network on photographs seen through a camera
///
/// The defaults, with --tone, are the recipe by which scripts/weights.sh makes the program's networks. A block of a quarter of
/// each side of every photograph is reserved for validation; training keeps a distance of the blur's radius from it. A
/// checkpoint is written beside OUT every minute and when Ctrl-C stops the run. --resume continues from it and ends with the
/// same bytes as an uninterrupted run. The same seed and options give the same bytes, for any --threads.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof train --form edof-t4w12 --camera ring-outer --images photos/ --out weights/mine.safetensors
  edof train --form two-sided,w8,t4 --camera ring-2018 --steps 8000 --out quick.safetensors
  edof train --form edof-t4w12 --camera clear --non-zeros 65,65,58 --seed 1,2,3 --out m.safetensors
  edof train --form edof-t4w12 --camera ring-outer --out weights/mine.safetensors --resume
  edof train --from edof-t4w12-outer --camera my-lens.json --steps 10000 --out mine.safetensors")]
pub struct Args {
    /// Architecture of the network: paper-t4, edof-t4w12, or keywords as in one-sided,w12,t4,c192,r
    #[arg(long, value_parser = form::parse, long_help = form::help(), required_unless_present = "from")]
    pub(super) form: Option<Form>,

    /// Camera: a preset such as ring-outer, or a JSON file
    #[arg(long)]
    pub(super) camera: String,

    #[command(flatten)]
    pub(super) bank: BankOptions,

    /// Folder of photographs; repeatable [default: $EDOF_KODAK and $EDOF_MORE, else the study's and those
    /// in shared/data/more beside it]
    #[arg(long, value_name = "DIR")]
    pub(super) images: Vec<PathBuf>,

    /// Photographs of each folder to use: train, all, or numbers as in 1,2 [default: all except the study's test photographs]
    #[arg(long)]
    pub(super) photos: Option<Selection>,

    /// Photographs to exclude, by file name without extension, so that networks can be tested on them
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    pub(super) leave_out: Vec<String>,

    /// Weight file to write
    #[arg(long, value_name = "FILE")]
    pub(super) out: PathBuf,

    /// Name of the network [default: OUT without its extension]
    #[arg(long)]
    pub(super) name: Option<String>,

    /// Number of depths ψ (defocus in radians), spread evenly over the camera's range
    #[arg(long, default_value_t = DEPTHS, value_name = "N")]
    pub(super) depths: usize,

    /// Range of ψ, the defocus in radians, as in 0:8, or of distances as in 0.7m:3m if the camera states nominal_m [default: the camera's]
    #[arg(long, value_name = "LOW:HIGH", value_parser = depths, allow_hyphen_values = true)]
    pub(super) psi: Option<DepthRange>,

    /// Focus in ψ of each exposure of the form, in place of the camera's: --form edof-t4w12,e2 --focus 2,6 makes a network of two raw frames.
    /// State the --gain of one frame: with half of the time each, twice that of a single one [default: one exposure, the camera's focus]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "PSI,…")]
    pub(super) focus: Vec<f64>,

    /// Meaning of a photograph's samples, and what the network takes and gives: srgb (encoded light, sensor noise; the default of edof
    /// capture) or linear (the paper's convention: linear light); with --from the default is the tone of that network
    #[arg(long)]
    pub(super) tone: Option<Tone>,

    /// Largest noise σ of linear windows, in units of full scale, or a range LOW:HIGH; a network trained without noise loses 6 to
    /// 11 dB at σ = 0.01 (docs/stability.md)
    #[arg(long, value_parser = up_to::<0>, value_name = "SIGMA", allow_hyphen_values = true)]
    pub(super) noise: Option<[f64; 2]>,

    /// Largest sensor gain of srgb windows, or a range LOW:HIGH: 10000 divided by the electrons of white, so 1 is 10000 of them and 8 is 1250
    #[arg(long, value_parser = up_to::<1>, value_name = "FACTOR", allow_hyphen_values = true)]
    pub(super) gain: Option<[f64; 2]>,

    /// One window in N has no noise, unless the range of noise begins above the least
    #[arg(long, value_name = "N")]
    pub(super) noiseless: Option<usize>,

    /// One window in N shows a single random colour, as no photograph's does; 0 for none
    #[arg(long, value_name = "N")]
    pub(super) flat: Option<usize>,

    /// Range MIN:MAX of the random factor on the light of each window; 1:1 leaves it unchanged
    #[arg(long, value_name = "LOW:HIGH", value_parser = factors, allow_hyphen_values = true)]
    pub(super) exposure: Option<[f64; 2]>,

    /// Pictures per photograph: the photograph, and copies with random saturation, hue and scale; 1 is the photograph only
    #[arg(long, value_name = "N")]
    pub(super) variants: Option<usize>,

    /// Range MIN:MAX of the copies' random saturation; 1:1 leaves it unchanged
    #[arg(long, value_name = "LOW:HIGH", value_parser = factors, allow_hyphen_values = true)]
    pub(super) saturation: Option<[f64; 2]>,

    /// Largest random hue rotation of the copies in degrees; 0 leaves the hue unchanged
    #[arg(long, value_name = "DEGREES", value_parser = single)]
    pub(super) hue: Option<f32>,

    /// Smallest random scale of the copies, relative to the photograph's sides; 1 leaves the size unchanged
    #[arg(long, value_parser = single, value_name = "FACTOR")]
    pub(super) scale: Option<f32>,

    /// Weights of easy and hard windows: psnr trains the mean PSNR, mse the mean square error, root is between both
    #[arg(long, value_name = "KIND")]
    pub(super) weighting: Option<Weighting>,

    /// Steps of the whole schedule
    #[arg(long, value_name = "N")]
    pub(super) steps: Option<u64>,

    /// Stop after N minutes of steps, at any step of the schedule; blurring the photographs before is not counted. A shorter schedule (--steps) that takes as long gives a better network
    #[arg(long, value_parser = minutes, value_name = "N")]
    pub(super) minutes: Option<Duration>,

    /// Windows per step; a multiple of 8
    #[arg(long, value_name = "N")]
    pub(super) batch: Option<usize>,

    /// Largest learning rate of Adam
    #[arg(long, value_parser = single, value_name = "RATE")]
    pub(super) rate: Option<f32>,

    /// Learning rate of the output matrices, dictionary D and linear path R, relative to --rate
    #[arg(long, value_parser = single, value_name = "FACTOR")]
    pub(super) output_rate: Option<f32>,

    /// Learning rate of the thresholds, relative to --rate
    #[arg(long, value_parser = single, value_name = "FACTOR")]
    pub(super) threshold_rate: Option<f32>,

    /// Write the running mean of the weights, of which each step keeps this share, as in 0.999; 0 writes the weights themselves
    #[arg(long, value_parser = single, value_name = "SHARE")]
    pub(super) averaging: Option<f32>,

    /// Weights that training changes: all, or the thresholds only, as for another level of noise (needs --from)
    #[arg(long, value_name = "PART", requires_if("thresholds", "from"))]
    pub(super) only: Option<Only>,

    /// What weights keep to, so that a circuit could multiply less: symmetric (codes in pairs, one the other's for a transposed window), or
    /// blocks:SHARE (so much of A and R is zero, where --from has the least)
    #[arg(long, value_name = "KIND")]
    pub(super) structure: Option<Structure>,

    /// Cost λ of a unit of |z|, one number or one per shrinkage as in 3e-4,3e-4,1e-3; a larger cost gives fewer non-zeros
    #[arg(long, value_delimiter = ',', value_parser = single)]
    pub(super) lambda: Vec<f32>,

    /// Target mean non-zeros after each shrinkage on busy windows, as in 65,65,58; training adapts λ to reach it, and --lambda sets
    /// only the start. none: λ is constant
    #[arg(long, value_name = "N,N,…|none")]
    pub(super) non_zeros: Option<String>,

    /// Speed at which λ adapts to --non-zeros: its largest relative change per step
    #[arg(long, value_parser = single, value_name = "RATE")]
    pub(super) budget_rate: Option<f32>,

    /// Start from a trained network's weights, by name or file, with a new schedule; without --form its architecture is used
    #[arg(long, value_name = "NETWORK", conflicts_with = "start")]
    pub(super) from: Option<String>,

    /// Initial weights: whitened inputs, or the paper's ISTA with a learned dictionary
    #[arg(long, value_name = "KIND")]
    pub(super) start: Option<Start>,

    /// Seed of all random numbers; with several, as in 1,2,3, the network with the best validation is written
    #[arg(long, value_delimiter = ',', value_name = "N,…")]
    pub(super) seed: Vec<u64>,

    /// Ignore and do not fill the cache of blurred photographs (~/.cache/edof/blurs, the last three data sets of at most 4 GiB each),
    /// which the next training on the same photographs and camera reuses
    #[arg(long)]
    pub(super) no_cache: bool,

    /// Number of threads; more than 8 give no gain [default: one per core, at most 8]
    #[arg(long, value_name = "N")]
    pub(super) threads: Option<usize>,

    /// Steps between validations
    #[arg(long, value_name = "N")]
    pub(super) validate_every: Option<u64>,

    /// Stop after N validations without improvement
    #[arg(long, value_name = "N")]
    pub(super) patience: Option<u32>,

    /// Resume from the checkpoints beside OUT; fails without a checkpoint
    #[arg(long)]
    pub(super) resume: bool,

    #[command(flatten)]
    pub(super) force: Force,
}

/// What windows weigh, by the names that users give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Weighting {
    Psnr,
    Root,
    Mse,
}

impl From<Weighting> for weighting::Weighting {
    fn from(by_name: Weighting) -> Self {
        match by_name {
            Weighting::Psnr => Self::Psnr,
            Weighting::Root => Self::Root,
            Weighting::Mse => Self::Mse,
        }
    }
}

impl From<weighting::Weighting> for Weighting {
    fn from(weighting: weighting::Weighting) -> Self {
        match weighting {
            weighting::Weighting::Psnr => Self::Psnr,
            weighting::Weighting::Root => Self::Root,
            weighting::Weighting::Mse => Self::Mse,
        }
    }
}

/// What training changes, by the names that users give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Only {
    All,
    Thresholds,
}

impl From<Only> for Trained {
    fn from(by_name: Only) -> Self {
        match by_name {
            Only::All => Self::All,
            Only::Thresholds => Self::Thresholds,
        }
    }
}

impl From<Trained> for Only {
    fn from(trained: Trained) -> Self {
        match trained {
            Trained::All => Self::All,
            Trained::Thresholds => Self::Thresholds,
        }
    }
}

/// Where training starts, by the names that users give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Start {
    Whitened,
    Dictionary,
}

impl From<Start> for initial::Start {
    fn from(by_name: Start) -> Self {
        match by_name {
            Start::Whitened => Self::Whitened,
            Start::Dictionary => Self::Dictionary,
        }
    }
}

impl From<initial::Start> for Start {
    fn from(start: initial::Start) -> Self {
        match start {
            initial::Start::Whitened => Self::Whitened,
            initial::Start::Dictionary => Self::Dictionary,
        }
    }
}

impl Args {
    /// Rejects a rate of what does not change. (Options of copies that are none may be stated: commands that networks carry state all.)
    ///
    /// # Errors
    /// `--budget-rate` without a budget.
    pub(super) fn check_budget(&self) -> Result<(), Error> {
        if self.budget_rate.is_some() && self.non_zeros.as_deref() == Some("none") {
            let told = "--budget-rate: has no effect, since --non-zeros none keeps λ constant; leave one of the two out";
            return Err(Error::message(told));
        }
        Ok(())
    }

    /// Threads that training runs on.
    pub(super) fn threads(&self) -> usize {
        self.threads.unwrap_or_else(usual_threads)
    }

    /// Name of the network.
    pub(super) fn name(&self) -> String {
        let stem = || self.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.name.clone().unwrap_or_else(stem)
    }

    /// Where a seed's unfinished run is kept.
    pub(super) fn checkpoint_file(&self, seed: u64) -> PathBuf {
        let mut name = self.out.as_os_str().to_owned();
        if self.seed.len() > 1 {
            name.push(format!(".{seed}"));
        }
        name.push(".checkpoint");
        name.into()
    }
}

/// Depths of a training.
pub const DEPTHS: usize = 9;
/// Threads that training is divided among at most.
const MAX_THREADS: usize = 8;

/// Threads that training runs on where none are stated.
pub fn usual_threads() -> usize {
    std::thread::available_parallelism().map_or(1, |cores| cores.get().min(MAX_THREADS))
}

fn minutes(text: &str) -> Result<Duration, String> {
    let minutes = text.parse::<f64>().ok().filter(|minutes| *minutes > 0.0);
    let time = minutes.and_then(|minutes| Duration::try_from_secs_f64(60.0 * minutes).ok());
    time.ok_or_else(|| "expected a number of minutes above 0".to_owned())
}

/// A range, or its upper end, where the lower is LEAST.
fn up_to<const LEAST: u8>(text: &str) -> Result<[f64; 2], String> {
    let example = if LEAST == 0 { "0.01:0.03" } else { "4:16" };
    if text.contains(':') { singles(text, example) } else { Ok([LEAST.into(), single(text)?.into()]) }
}

/// Factors that are computed with in single precision.
fn factors(text: &str) -> Result<[f64; 2], String> {
    singles(text, "0.5:2")
}

/// Two numbers that single precision has.
fn singles(text: &str, example: &str) -> Result<[f64; 2], String> {
    let ends = range(text, example)?;
    text.split(':').try_for_each(|word| single(word).map(drop))?;
    Ok(ends)
}

/// Two numbers; `example` is what the user sees of a good range.
fn range(text: &str, example: &str) -> Result<[f64; 2], String> {
    let number = |word: &str| word.parse::<f64>().ok().filter(|v| v.is_finite());
    let ends = text.split_once(':').and_then(|(low, high)| Some([number(low)?, number(high)?]));
    ends.filter(|[low, high]| low <= high)
        .ok_or_else(|| format!("expected LOW:HIGH, as in {example}, the smaller number first"))
}

/// A range of ψ from its lower end on, or of distances.
fn depths(text: &str) -> Result<DepthRange, String> {
    let depths: DepthRange = text.parse()?;
    match (depths.near, depths.far) {
        (Depth::Psi(_), Depth::Psi(_)) => range(text, "0:8").map(|_| depths),
        _ => Ok(depths),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_two_ends_in_order() {
        assert_eq!(range("-4:4.5", "0:8"), Ok([-4.0, 4.5]));
        assert!(depths("0.7m:3m").is_ok() && depths("-4:4.5").is_ok() && depths("8:0").is_err());
        assert!(range("4", "0:8").is_err() && range("8:0", "0:8").is_err() && range("a:b", "0:8").is_err());
    }
}
