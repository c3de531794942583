//! The Verilog of a folder in place of what was just generated: as `edof generate` wrote it, or as somebody changed it.

use crate::error::{Error, at};
use edof_hdl::project::Project;
use std::fs;
use std::path::Path;

/// The same project with the files of `folder`: its top module's, and those of the modules that it stands on. Memory images stay.
///
/// # Errors
/// The folder has no file of the top module, that module has not the ports of the project's, or a file cannot be read.
pub fn with_verilog_of(project: Project, folder: &Path) -> Result<Project, Error> {
    check(&project.top, folder)?;
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

/// Rejects a folder without the top module; most likely the user meant the folder that `edof generate` puts Verilog into.
fn check(top: &str, folder: &Path) -> Result<(), Error> {
    let file = format!("{top}.v");
    if folder.join(&file).is_file() {
        return Ok(());
    }
    let shown = folder.display();
    let problem = if !folder.is_dir() {
        "is no folder; expected the folder rtl of what 'edof generate' wrote".to_owned()
    } else if folder.join("rtl").join(&file).is_file() {
        format!("has no {file}; expected the folder rtl in it: give {shown}/rtl")
    } else {
        format!("has no {file}; expected the folder rtl of what 'edof generate' wrote for this design")
    };
    Err(Error::Port(format!("{shown}: {problem}")))
}

fn is_module(folder: &Path, word: &str) -> bool {
    let is_name = word.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    is_name && folder.join(format!("{word}.v")).is_file()
}
