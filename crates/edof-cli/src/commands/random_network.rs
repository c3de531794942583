//! `edof random-network`: a random network, where there is no trained one.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::form;
use crate::kind;
use crate::said;
use crate::ui::Ui;
use clap::ValueEnum;
use edof_core::Stride;
use edof_network::network::Form;
use edof_network::{FixedNetwork, weight_file};
use serde_json::json;
use std::path::PathBuf;

/// Make a random quantized network, to test hardware and other implementations
///
/// A random network restores no picture. An extreme network has weights and thresholds over their whole range, mostly at its ends; a natural
/// network has the size, sparsity and brightness of a trained one. The same seed gives the same network.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof random-network --form two-sided,w8,t3,c40,difference --bits 12 --out x.fixed.safetensors
  edof random-network --design tiny --out drawn.fixed.safetensors
  edof random-network --kind natural --form edof-t4w12 --stride 2 --out natural.fixed.safetensors")]
pub struct Args {
    /// Kind of network
    #[arg(long, value_enum, default_value = "extreme")]
    kind: Kind,

    /// Architecture of the network
    #[arg(long, value_parser = form::parse, default_value = "edof-t4w12", long_help = form::help())]
    form: Form,

    /// Make an extreme network that fits this design, by name or file
    #[arg(long, value_name = "NAME|FILE", conflicts_with_all = ["kind", "form", "bits", "stride"])]
    design: Option<String>,

    /// Bits of weights, thresholds and sparse codes, 8 to 16; natural networks have 16
    #[arg(long, default_value_t = 16)]
    bits: u32,

    /// Pixels from one patch to the next: 2, 4 or 8
    #[arg(long, default_value_t = Stride::PATCH.pixels(), value_name = "PIXELS")]
    stride: usize,

    /// Seed of all random numbers
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u64,

    /// Weight file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Kind {
    /// Legal values, mostly at the ends of their range
    Extreme,
    /// Sizes and sparsity of a trained network
    Natural,
}

/// # Errors
/// An architecture out of range, a network that no accumulator could hold, or a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    Files::new(ui).reads_all(&args.design).writes_as(kind::Kind::Weights, "--out", &args.out).check()?;
    let mut network = match &args.design {
        Some(name) => for_design(name, args.seed, ui)?,
        None => network(&args)?,
    };
    network.origin.provenance = ui.provenance().for_file();
    weight_file::save_fixed(&args.out, &network)?;
    ui.say(format!(
        "{}: a random network for tests, {}, stride {}",
        args.out.display(),
        form::words(&network.form),
        network.stride.pixels()
    ))?;
    ui.json(&json!({ "out": args.out.display().to_string(), "form": network.form, "stride": network.stride, "seed": args.seed }))
}

fn for_design(name: &str, seed: u64, ui: &Ui) -> Result<FixedNetwork, Error> {
    let design = designs::load(name)?;
    ui.used(designs::input(&design));
    let network = edof_device::random::for_design(&design, seed);
    design.check_network(&network)?;
    Ok(network)
}

fn network(args: &Args) -> Result<FixedNetwork, Error> {
    let stride = said::stride(args.stride)?;
    match args.kind {
        Kind::Extreme if !(8..=16).contains(&args.bits) => {
            Err(Error::message(format!("--bits {}: must be 8 to 16", args.bits)))
        }
        Kind::Extreme => Ok(edof_device::random::extreme(args.form, args.bits, stride, false, args.seed)),
        Kind::Natural => {
            let network = edof_device::random::natural(args.form.window.side(), stride.pixels(), args.seed);
            if network.form == args.form && network.code_bits == args.bits {
                return Ok(network);
            }
            let drawn = form::words(&network.form);
            Err(Error::message(format!(
                "--kind natural: makes {drawn} of --bits 16 only, not {} of --bits {}",
                form::words(&args.form),
                args.bits
            )))
        }
    }
}
