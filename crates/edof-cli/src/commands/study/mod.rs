//! `edof study`: experiments on photographs.

mod aperture;
mod aperture_networks;
mod bits;
mod blind;
mod codes;
mod design;
mod dictionary;
mod knobs;
mod kodak;
mod lens_networks;
mod merge;
mod multi_depth;
mod nets;
mod options;
mod single_depth;
mod stability;
mod tolerances;

use crate::error::Error;
use crate::ui::Ui;
use clap::Subcommand;

/// Measure methods on photographs, depths and noise levels
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(subcommand)]
    experiment: Experiment,
}

const EXAMPLES: &str = "\
Examples:
  edof study kodak --nets edof-t4w12-outer --json study.json
  edof study kodak --tone srgb --nets edof-t4w12-outer --noise sensor,sensor:gain=8 --markdown s.md
  edof study kodak --nets my/net.safetensors --photos train --psi 8
  edof study single-depth --rows rows.jsonl --report speed.html
  edof study multi-depth --report four-depths.html
  edof study stability --report hard-cases.html";

#[derive(Subcommand)]
enum Experiment {
    Kodak(kodak::Args),
    SingleDepth(single_depth::Args),
    MultiDepth(multi_depth::Args),
    Blind(blind::Args),
    Codes(codes::Args),
    Knobs(knobs::Args),
    Design(design::Args),
    Merge(merge::Args),
    Dictionary(dictionary::Args),
    Stability(stability::Args),
    Bits(bits::Args),
    Aperture(aperture::Args),
    ApertureNetworks(aperture_networks::Args),
    LensNetworks(lens_networks::Args),
    Tolerances(tolerances::Args),
}

/// # Errors
/// Nothing found, a file that is broken, settings out of range, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    match args.experiment {
        Experiment::Kodak(args) => kodak::run(args, ui),
        Experiment::SingleDepth(args) => single_depth::run(args, ui),
        Experiment::MultiDepth(args) => multi_depth::run(args, ui),
        Experiment::Blind(args) => blind::run(args, ui),
        Experiment::Codes(args) => codes::run(args, ui),
        Experiment::Knobs(args) => knobs::run(args, ui),
        Experiment::Design(args) => design::run(args, ui),
        Experiment::Merge(args) => merge::run(args, ui),
        Experiment::Dictionary(args) => dictionary::run(args, ui),
        Experiment::Stability(args) => stability::run(args, ui),
        Experiment::Bits(args) => bits::run(args, ui),
        Experiment::Aperture(args) => aperture::run(args, ui),
        Experiment::ApertureNetworks(args) => aperture_networks::run(args, ui),
        Experiment::LensNetworks(args) => lens_networks::run(args, ui),
        Experiment::Tolerances(args) => tolerances::run(args, ui),
    }
}
