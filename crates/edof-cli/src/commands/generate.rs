//! `edof generate`: from a design and a network to Verilog and memory images.

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::folder::{self, Contents};
use crate::ui::Ui;
use crate::weights;
use edof_hdl::project::{self, Project};
use edof_spec::provenance::Input;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Write the Verilog of a design, with the memory images of a network
///
/// For now the calculator: the chain of stages from windows to patches. Paths inside are relative to the folder, which needs
/// nothing else; the manifest holds the SHA-256 of every file. The same design and network give the same bytes.
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

/// Top of the list of files.
const LIST_HEADER: &str = "\
Files of the design, for tools that are started in this folder.
From elsewhere, tell where the memory images are: define EDOF_DIR as \"/path/to/this/folder/\".";

/// # Errors
/// A design or network that cannot be used or do not fit each other, or a folder that cannot be written or holds other things.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let design = designs::load(&args.design)?;
    ui.used(Input::design(&design));
    let network = weights::fixed(&args.weights)?;
    ui.used(weights::fixed_input(&args.weights)?);
    let project = project::calculator(&design, [&network, &network])?;
    let contents = contents(&project);
    let names = contents.keys().map(PathBuf::as_path).chain([Path::new(folder::MANIFEST)]);
    let files = Files::new(ui).reads(&args.design).reads_all(weights::fixed_file(&args.weights));
    files.writes_into("--out", &args.out, names).check()?;
    let about = json!({
        "design": design,
        "weights": { "name": network.origin.name, "float_sha256": network.float_hash },
        "top": project.top,
    });
    let manifest = folder::manifest(about, &contents);
    folder::write(&args.out, contents, &manifest, args.force)?;
    let verilog: usize = project.verilog.iter().map(|(_, text)| text.len()).sum();
    ui.say(format!(
        "{}: {} modules ({} kB of Verilog, top {}), {} memory images",
        args.out.display(),
        project.verilog.len(),
        verilog / 1000,
        project.top,
        project.memory.len()
    ))?;
    ui.json(&manifest)
}

/// Every file by its path in the folder.
fn contents(project: &Project) -> Contents {
    let verilog = project.verilog.iter().map(|(name, text)| (format!("rtl/{name}"), text.clone()));
    let names = project.verilog.iter().map(|(name, _)| format!("rtl/{name}\n"));
    let list = LIST_HEADER.lines().map(|line| format!("// {line}\n")).chain(names).collect();
    let memory = project.memory.iter().cloned();
    let all = verilog.chain(memory).chain([("files.f".to_string(), list)]);
    all.map(|(path, text)| (path.into(), text)).collect()
}
