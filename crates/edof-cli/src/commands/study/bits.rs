//! `edof study bits`: which layer's bits matter.

use super::options::Outputs;
use crate::error::Error;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::ui::Ui;
use crate::weights;
use edof_study::stability::bits;

/// Effect of each layer's bits: dB lost against the bits of one stage or of all, and the fewest bits that lose next to nothing
///
/// A stage of N bits has weights that are multiples of a power of two, and results with equally fewer bits in their former range.
/// The golden pipeline computes both, on synthetic scenes with the network's camera.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study bits --report bits.html
  edof study bits --nets edof-t4w12-outer --allowed 0.05 --json bits.json")]
pub struct Args {
    /// Fixed networks of the direct form [default: all built-in ones]
    #[arg(long, value_delimiter = ',', value_name = "NET,…")]
    nets: Vec<String>,

    /// Largest loss in dB of the fewest bits together
    #[arg(long, default_value_t = 0.02, value_name = "DB")]
    allowed: f64,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    force: Force,
}

/// # Errors
/// A network that cannot be read or judged, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    if !(args.allowed.is_finite() && args.allowed >= 0.0) {
        return Err(Error::message(format!("--allowed {}: must be 0 or more", args.allowed)));
    }
    let files = args.nets.iter().fold(Files::new(ui), |files, net| files.reads_all(weights::fixed_file(net)));
    args.outputs.of(files).keeps(args.force).check()?;
    let own: Vec<String> = weights::names().into_iter().map(str::to_owned).collect();
    let names = if args.nets.is_empty() { own } else { args.nets.clone() };
    let networks =
        names.iter().map(|name| Ok((name, weights::fixed(name)?))).collect::<Result<Vec<_>, Error>>()?;
    let progress = ui.progress(networks.len() as u64, "networks");
    let mut all = vec![];
    for (name, network) in networks {
        interrupt::check()?;
        ui.used(weights::fixed_input(name)?);
        all.push(bits::of(&network.origin.name, &network, args.allowed)?);
        progress.set(all.len() as u64);
    }
    drop(progress);
    let report = || Ok(bits::report(&all, &ui.signed(&ui.provenance().command)));
    args.outputs.write(
        || bits::to_markdown(&all, &ui.made_here()),
        report,
        || edof_study::report::csv::of(&all),
    )?;
    for bits in &all {
        ui.say(bits.verdict())?;
    }
    ui.json(&serde_json::json!({ "networks": all }))
}
