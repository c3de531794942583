//! `edof study stability`: hard cases, and whether each is within its limit.

use super::nets::fixed_name;
use super::options::Outputs;
use crate::error::Error;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::ui::Ui;
use crate::weights;
use edof_study::stability::bench::{Bench, Trained};
use edof_study::stability::case::{self, Case};
use edof_study::stability::suite::Suite;
use std::path::PathBuf;

/// Run the hard cases; print acceptance limit, worst error and result of each
///
/// Cases are data: the purpose, the possible fault, the input, and the limit (the result of a reference within an error, a largest loss, or
/// an error message). Each case runs through every method concerned, in f64, f32 and fixed point. A case fails on a panic, a NaN or
/// an exceeded limit; the exit status is then not 0.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof study stability --report hard-cases.html --markdown hard-cases.md
  edof study stability --quick
  edof study stability --only bounds- --windows 1000000 --json bounds.json
  edof study stability --cases my/cases --nets my/net.safetensors")]
pub struct Args {
    /// Folder of case files (*.json) [default: the cases inside the program]
    #[arg(long, value_name = "DIR")]
    cases: Option<PathBuf>,

    /// Run only cases whose name contains one of these words
    #[arg(long, value_delimiter = ',', value_name = "WORD,…")]
    only: Vec<String>,

    /// Run only fast cases
    #[arg(long)]
    quick: bool,

    /// Networks, each with its integers: those of NAME.safetensors are in NAME.fixed.safetensors [default: all built-in ones]
    #[arg(long, value_delimiter = ',', value_name = "NET,…")]
    nets: Vec<String>,

    /// Random windows per network for the test of error bounds; a local search towards the bounds adds about the same number
    #[arg(long, default_value_t = 20_000, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    windows: u32,

    #[command(flatten)]
    outputs: Outputs,

    #[command(flatten)]
    force: Force,
}

/// # Errors
/// Cases or networks that cannot be read, no case of that name, an exceeded limit, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = args.nets.iter().fold(Files::new(ui), |files, net| {
        files.reads_all(weights::float_file(net)).reads_all(weights::fixed_file(&fixed_name(net)))
    });
    let files = args.cases.iter().fold(files, |files, folder| files.reads_pictures_of(folder));
    args.outputs.of(files).keeps(args.force).check()?;
    let cases = args.chosen()?;
    let bench = Bench::new(args.networks(ui)?, args.windows as usize);
    let progress = ui.progress(cases.len() as u64, "cases");
    let suite = Suite::run(&bench, &cases, |done, next| {
        progress.message(&next.id);
        progress.set(done as u64);
        interrupt::flow()
    });
    drop(progress);
    let suite = suite.ok_or(Error::Interrupted)?;
    let rows: Vec<_> = suite.cases.iter().flat_map(|outcome| &outcome.seen).collect();
    let report = || Ok(suite.report(&ui.signed(&ui.provenance().command)));
    args.outputs.write(
        || suite.to_markdown(&ui.made_here()),
        report,
        || edof_study::report::csv::of(&rows),
    )?;
    ui.say(suite.to_text())?;
    ui.json(&suite)?;
    if suite.broken == 0 { Ok(()) } else { Err(Error::message(suite.verdict())) }
}

impl Args {
    fn chosen(&self) -> Result<Vec<Case>, Error> {
        let all = match &self.cases {
            Some(folder) => case::of_folder(folder)?,
            None => case::own()?,
        };
        let named = |case: &Case| self.only.is_empty() || self.only.iter().any(|word| case.id.contains(word));
        let chosen: Vec<Case> =
            all.into_iter().filter(|case| named(case) && !(self.quick && case.slow)).collect();
        if chosen.is_empty() {
            let (words, quick) = (self.only.join(","), if self.quick { " --quick" } else { "" });
            return Err(Error::message(format!("--only {words}{quick}: no case of such a name")));
        }
        Ok(chosen)
    }

    fn networks(&self, ui: &Ui) -> Result<Vec<Trained>, Error> {
        let all: Vec<String> = weights::names().into_iter().map(str::to_owned).collect();
        let names = if self.nets.is_empty() { all } else { self.nets.clone() };
        let trained = |name: String| {
            let integers = fixed_name(&name);
            let (float, fixed) = (weights::float(&name)?, weights::fixed(&integers)?);
            if weights::float_input(&name)?.sha256 != fixed.float_hash {
                return Err(Error::message(format!(
                    "--nets {name}: its integers were made of another float network"
                )));
            }
            ui.used(weights::float_input(&name)?);
            ui.used(weights::fixed_input(&integers)?);
            let name = float.origin.name.clone();
            Ok(Trained { name, float, fixed })
        };
        names.into_iter().map(trained).collect()
    }
}
