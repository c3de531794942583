//! Writes the calculator of a design, of the leaves of its board's part, and its memory images:
//! `cargo run -p edof-hdl --example chain -- DESIGN WEIGHTS FOLDER`. `scripts/route.sh` places and routes it.

use edof_device::Design;
use edof_hdl::project;
use edof_network::weight_file;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(Into::into).collect();
    let [design, weights, folder] = &arguments[..] else {
        return Err("expected a design, weights and a folder".into());
    };
    let design = Design::load(design)?;
    let network = weight_file::load_fixed(weights)?;
    design.check_network(&network)?;
    let calculator = project::calculator(&design, [&network, &network])?.on_part(&design.board.part);
    let modules = calculator.verilog.into_iter().map(|(name, text)| (Path::new("rtl").join(name), text));
    let images = calculator.memory.into_iter().map(|(path, text)| (path.into(), text));
    for (path, text) in modules.chain(images) {
        let path = folder.join(path);
        fs::create_dir_all(path.parent().unwrap_or(folder))?;
        fs::write(path, text)?;
    }
    Ok(())
}
