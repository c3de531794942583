//! `edof generate`: from a design and a network to Verilog and memory images.

use crate::designs;
use crate::error::Error;
use crate::ui::Ui;
use crate::weights;
use edof_hdl::project::{self, Project};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fs;
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

    /// Folder to write; it must not exist, be empty, or hold an earlier output of this command
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// File that tells an output of this command from any other folder.
const MANIFEST: &str = "manifest.json";

/// Top of the list of files.
const LIST_HEADER: &str = "\
Files of the design, for tools that are started in this folder.
From elsewhere, tell where the memory images are: define EDOF_DIR as \"/path/to/this/folder/\".";

/// # Errors
/// A design or network that cannot be used or do not fit each other, or a folder that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let design = designs::load(&args.design)?;
    let network = weights::fixed(&args.weights)?;
    let project = project::calculator(&design, [&network, &network])?;
    let files = files(&project);
    let manifest = json!({
        "design": design,
        "weights": { "name": network.origin.name, "float_sha256": network.float_hash },
        "top": project.top,
        "files": files.iter().map(|(path, text)| json!({
            "path": path, "bytes": text.len(), "sha256": hash(text),
        })).collect::<Vec<Value>>(),
    });
    write(&args.out, &files, &(serde_json::to_string_pretty(&manifest)? + "\n"))?;
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

/// Every file and its path in the folder.
fn files(project: &Project) -> Vec<(String, String)> {
    let verilog = project.verilog.iter().map(|(name, text)| (format!("rtl/{name}"), text.clone()));
    let names = project.verilog.iter().map(|(name, _)| format!("rtl/{name}\n"));
    let list = LIST_HEADER.lines().map(|line| format!("// {line}\n")).chain(names).collect();
    let memory = project.memory.iter().cloned();
    verilog.chain(memory).chain([("files.f".to_string(), list)]).collect()
}

fn hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Writes a folder beside `out` and puts it in its place once it is whole.
fn write(out: &Path, files: &[(String, String)], manifest: &str) -> Result<(), Error> {
    let failed = |path: &Path, e: std::io::Error| Error::message(format!("{}: {e}", path.display()));
    let is_ours = out.join(MANIFEST).is_file();
    let is_empty = fs::read_dir(out).map_or(true, |mut entries| entries.next().is_none());
    if !is_ours && (out.is_file() || !is_empty) {
        let expected = "must not exist, be empty, or hold an earlier output of this command";
        return Err(Error::message(format!("--out {}: {expected}", out.display())));
    }
    let parent = out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(|e| failed(parent, e))?;
    let work = tempfile::Builder::new().prefix(".edof-generate").tempdir_in(parent);
    let work = work.map_err(|e| failed(parent, e))?;
    for (name, text) in files.iter().map(|(n, t)| (n.as_str(), t.as_str())).chain([(MANIFEST, manifest)]) {
        let path = work.path().join(name);
        let folder = path.parent().unwrap_or(work.path());
        fs::create_dir_all(folder).and_then(|()| fs::write(&path, text)).map_err(|e| failed(&path, e))?;
    }
    if out.exists() {
        fs::remove_dir_all(out).map_err(|e| failed(out, e))?;
    }
    let path = work.keep();
    set_permissions(&path)?;
    fs::rename(&path, out).map_err(|e| failed(out, e))
}

/// A temporary folder is for its owner alone; a result is for everyone who may read beside it.
fn set_permissions(path: &Path) -> Result<(), Error> {
    use std::os::unix::fs::PermissionsExt;
    Ok(fs::set_permissions(path, fs::Permissions::from_mode(0o755))?)
}
