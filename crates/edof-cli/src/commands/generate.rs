//! `edof generate`: from a design and a network to the sources of a bitstream.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::network;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use clap::builder::{PossibleValue, PossibleValuesParser};
use edof_core::storage::folder;
use edof_cosim::bitstream::{self, Sources};
use edof_device::board::BOARDS;
use std::path::PathBuf;

/// Write the sources of a bitstream: a design, and a network in its memories
///
/// Writes Verilog, memory images, constraints, test benches, the register map, a README, and what the tools of the design's board read: for
/// the KC705 a build.tcl for Vivado, a Makefile and a FuseSoC core, for the ULX3S a Makefile for Yosys and nextpnr. The folder is self-contained; its manifest lists the SHA-256 of
/// every file. The same design and network give the same bytes.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof generate --design paper --weights paper-t4 --out build/paper
  edof generate --design ulx3s --weights mine.fixed.safetensors --out build/ulx3s
  edof generate --design my-design.json --weights mine.fixed.safetensors --out build/mine --json
  edof generate --design kc705 --weights edof-t4w12-outer --shell litex --out build/litex")]
pub struct Args {
    /// Design, by name or file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file; all sets of weights start with it [default: the one of edof random-network, which tests a board and makes no pictures]
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Surroundings of the core: memory controller and connection to the host [default: the board's first, on the KC705 mig]
    #[arg(long, value_name = "SHELL", value_parser = shells())]
    shell: Option<String>,

    /// Folder to write; its present files must come from this command and be unchanged
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// Replace changed or foreign files of the same name; keep others
    #[arg(long)]
    force: bool,
}

/// Values of `--shell`: the shells of all boards.
fn shells() -> PossibleValuesParser {
    let mut all: Vec<_> = BOARDS.iter().flat_map(|board| board.shells).collect();
    all.dedup_by_key(|shell| shell.name);
    all.into_iter().map(|shell| PossibleValue::new(shell.name).help(shell.about)).collect::<Vec<_>>().into()
}

/// # Errors
/// A design or network that cannot be used or do not fit each other, or a folder that cannot be written or holds other things.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    folder::check(&args.out, args.force, Sources::may_have).map_err(Error::of_folder)?;
    let design = designs::load(&args.design)?;
    ui.used(designs::input(&design));
    if args.weights.is_none() {
        ui.note("without --weights the network is a random one, which tests the board and makes no pictures");
    }
    let network = network::of_design(&design, &args.design, args.weights.as_deref(), 1, ui)?;
    design.check_board().map_err(|e| said::of_file(&args.design, e))?;
    let shell =
        bitstream::shell(&design, args.shell.as_deref()).map_err(|e| said::of_file(&args.design, e))?;
    let progress = ui.progress(1, "sources");
    let sources = Sources::told(&design, &network, shell, |done, of, next| {
        progress.message(next);
        progress.of(done as u64, of as u64);
    })?;
    progress.finish();
    let files =
        Files::new(ui).reads(&args.design).reads_all(args.weights.as_deref().and_then(weights::fixed_file));
    files.writes_into("--out", &args.out, sources.names()).check()?;
    let manifest = sources.write(&args.out, args.force).map_err(Error::of_folder)?;
    ui.say(sources.summary(&args.out))?;
    ui.json(&manifest)
}
