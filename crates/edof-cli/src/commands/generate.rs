//! `edof generate`: from a design and a network to the sources of a bitstream.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::folder::{self, Contents};
use crate::ui::Ui;
use crate::weights;
use edof_golden::display::Display;
use edof_golden::scalar;
use edof_hdl::board::Identity;
use edof_hdl::kc705::{self, Kc705, Recorded, Tables};
use edof_spec::draw::Draw;
use edof_spec::{Design, FixedNetwork};
use serde_json::json;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Write the sources of a KC705 bitstream: a design, and a network in its memories
///
/// Verilog, memory images, constraints, and a build.tcl for Vivado; a Makefile and a FuseSoC core with a test bench that needs no more
/// than a simulator; the register map; a README. The folder needs nothing else; the manifest holds the SHA-256 of every file. The same
/// design and network give the same bytes.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof generate --design paper --weights paper-t4 --out build/paper
  edof generate --design my-design.json --weights mine.fixed.safetensors --out build/mine --json")]
pub struct Args {
    /// Design: tiny, paper, kc705, or a JSON file
    #[arg(long, value_name = "NAME|FILE")]
    design: String,

    /// Quantized network, by name or file; both sets of weights start with it
    #[arg(long, value_name = "NAME|FILE")]
    weights: String,

    /// Folder to write; what it holds already must come from this command and be as it was written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,

    /// Replace changed or foreign files that are in the way; others stay
    #[arg(long)]
    force: bool,
}

/// The design's top module.
const TOP: &str = "kc705_top";
/// Windows that the test bench tries.
const TRIED: usize = 12;

/// Top of the list of files.
const LIST_HEADER: &str = "\
Files of the design, for tools that are started in this folder.
From elsewhere, tell where the memory images are: define EDOF_DIR as \"/path/to/this/folder/\".";

/// # Errors
/// A design or network that cannot be used or do not fit each other, or a folder that cannot be written or holds other things.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let design = designs::load(&args.design)?;
    ui.used(designs::input(&design));
    let network = weights::fixed(&args.weights)?;
    ui.used(weights::fixed_input(&args.weights)?);
    let project = project(&design, &network)?;
    let contents = contents(&project);
    let names = contents.keys().map(PathBuf::as_path).chain([Path::new(folder::MANIFEST)]);
    let files = Files::new(ui).reads(&args.design).reads_all(weights::fixed_file(&args.weights));
    files.writes_into("--out", &args.out, names).check()?;
    let about = json!({
        "design": design,
        "weights": { "name": network.origin.name, "float_sha256": network.float_hash },
        "top": TOP,
    });
    let manifest = folder::manifest(about, &contents);
    folder::write(&args.out, contents, &manifest, args.force)?;
    let core = &project.core;
    let verilog: usize = core.verilog.iter().map(|(_, text)| text.len()).sum();
    ui.say(format!(
        "{}: {} modules ({} kB of Verilog, top {}), {} memory images",
        args.out.display(),
        core.verilog.len(),
        verilog / 1000,
        TOP,
        core.memory.len()
    ))?;
    ui.json(&manifest)
}

/// The sources, with the display tables that a board starts with and words that its calculator is tried with.
fn project(design: &Design, network: &FixedNetwork) -> Result<Kc705, Error> {
    let display = Display::default();
    let luma: Vec<u64> = display.luma.entries().iter().map(|code| u64::from(*code)).collect();
    let entries =
        |i: usize| display.colours[i].entries().iter().map(|entry| u64::from(*entry)).collect::<Vec<_>>();
    let colours = [entries(0), entries(1), entries(2)];
    let tables = Tables { luma: &luma, colours: [&colours[0], &colours[1], &colours[2]] };
    let (width, height) = (design.frame.width as u16, design.frame.height as u16);
    let identity = Identity {
        design_hash: first_bits(serde_json::to_string(design)?.as_bytes()),
        weights_hash: first_bits(network.float_hash.as_bytes()),
        frame: (width, height),
    };
    design.check_network(network)?;
    Ok(kc705::project(design, [network, network], &identity, &tables, &recorded(design, network))?)
}

/// First 32 bits of the SHA-256.
fn first_bits(bytes: &[u8]) -> u32 {
    let hash = Sha256::digest(bytes);
    hash.iter().take(4).fold(0, |bits, byte| bits << 8 | u32::from(*byte))
}

/// Windows for the test bench: some at the ends of their range, some of dim noise.
fn recorded(design: &Design, network: &FixedNetwork) -> Recorded {
    let (draw, pixels) = (&mut Draw::new(1), design.form.window.pixels());
    let window = |i: usize| match i % 3 {
        0 => edof_random::extreme_window(draw, pixels),
        _ => (0..pixels).map(|_| draw.whole(0, 4_000) as i16).collect(),
    };
    let windows: Vec<Vec<i16>> = (0..TRIED).map(window).collect();
    let patches = windows.iter().map(|window| scalar::run(network, window).output).collect();
    Recorded { windows, patches }
}

/// Every file by its path in the folder.
fn contents(project: &Kc705) -> Contents {
    let core = &project.core;
    let verilog = core.verilog.iter().map(|(name, text)| (format!("rtl/{name}"), text.clone()));
    let names = core.verilog.iter().map(|(name, _)| format!("rtl/{name}\n"));
    let list = LIST_HEADER.lines().map(|line| format!("// {line}\n")).chain(names).collect();
    let all = verilog.chain(core.memory.iter().chain(&project.files).cloned());
    all.chain([("files.f".to_string(), list)]).map(|(path, text)| (path.into(), text)).collect()
}
