//! The Verilog of a folder in place of what was just generated: as `edof generate` wrote it, or as somebody changed it.

use crate::error::{Error, at};
use edof_hdl::project::Project;
use std::fs;
use std::path::{Path, PathBuf};

/// Returns the same project with the files of `folder`: its top module's, those of the modules that it stands on, and the models of the part's cells that its
/// own benches take. Memory images stay. The folder may also be the one that `edof generate` wrote, whose Verilog is in `rtl`.
///
/// # Errors
/// The folder has no file of the top module, that module has not the ports of the project's, or a file cannot be read.
pub fn with_verilog_of(project: Project, folder: &Path) -> Result<Project, Error> {
    let folder = &verilog_folder(&project.top, folder)?;
    let mut verilog: Vec<(String, String)> = vec![];
    let mut wanted = vec![project.top.clone()];
    while let Some(module) = wanted.pop() {
        let name = format!("{module}.v");
        if verilog.iter().any(|(known, _)| *known == name) {
            continue;
        }
        let path = folder.join(&name);
        let text = fs::read_to_string(&path).map_err(at(&path))?;
        // An instance's line begins with the name of its module.
        let words = text.lines().filter_map(|line| line.split_whitespace().next());
        wanted.extend(words.filter(|word| is_module(folder, word)).map(String::from));
        verilog.push((name, text));
    }
    let head = verilog.first().map_or("", |(_, text)| text.as_str());
    if let Some(port) = project.ports.iter().find(|port| !head.contains(&port.name)) {
        let path = folder.join(format!("{}.v", project.top));
        return Err(Error::Port(format!("{}: has no port {}", path.display(), port.name)));
    }
    verilog.reverse();
    verilog.extend(models_of_cells(folder)?);
    // The map knows the places of a file that has as many lines: a value may differ, as that of a parameter which only a whole board needs.
    let is_kept = |name: &String| {
        let lines = |files: &[(String, String)]| {
            files.iter().find(|(file, _)| file == name).map(|(_, text)| text.lines().count())
        };
        lines(&verilog) == lines(&project.verilog)
    };
    let sources = project.sources.iter().filter(|(name, _)| is_kept(name));
    let sources = sources.map(|(name, map)| (name.clone(), map.clone())).collect();
    Ok(Project { verilog, sources, ..project })
}

/// Finds the folder of the top module: this one, or `rtl` in it.
fn verilog_folder(top: &str, folder: &Path) -> Result<PathBuf, Error> {
    let file = format!("{top}.v");
    let found = [folder.to_owned(), folder.join("rtl")].into_iter().find(|place| place.join(&file).is_file());
    found.ok_or_else(|| {
        let problem = if folder.is_dir() { format!("has no {file}") } else { "is no folder".to_owned() };
        Error::Port(format!(
            "{}: {problem}; expected the folder that 'edof generate' wrote for this design, or rtl in it",
            folder.display()
        ))
    })
}

/// Reads the files `sim/*_cells.v` beside the Verilog, with their names, sorted.
fn models_of_cells(folder: &Path) -> Result<Vec<(String, String)>, Error> {
    let Ok(files) = folder.join("../sim").read_dir() else { return Ok(vec![]) };
    let mut models = vec![];
    for path in files.flatten().map(|file| file.path()) {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        if name.ends_with("_cells.v") {
            models.push((name, fs::read_to_string(&path).map_err(at(&path))?));
        }
    }
    models.sort();
    Ok(models)
}

fn is_module(folder: &Path, word: &str) -> bool {
    let is_name = word.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    is_name && folder.join(format!("{word}.v")).is_file()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_of_cells_are_those_beside_the_verilog() {
        let folder = tempfile::tempdir().unwrap();
        let rtl = folder.path().join("rtl");
        fs::create_dir(&rtl).unwrap();
        assert_eq!(models_of_cells(&rtl).unwrap(), []);
        fs::create_dir(folder.path().join("sim")).unwrap();
        for name in ["carry_cells.v", "bench.sv", "other.v", "block_cells.v"] {
            fs::write(folder.path().join("sim").join(name), name).unwrap();
        }
        let names = ["block_cells.v", "carry_cells.v"];
        assert_eq!(models_of_cells(&rtl).unwrap(), names.map(|name| (name.to_owned(), name.to_owned())));
    }
}
