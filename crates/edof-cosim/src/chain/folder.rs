//! The Verilog of a folder in place of what was just generated: as `edof generate` wrote it, or as somebody changed it.

use crate::error::{Error, at};
use edof_core::Tone;
use edof_core::storage::folder::MANIFEST;
use edof_device::Design;
use edof_hdl::project::Project;
use serde::Deserialize;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// Field of `weights` in the manifest: the tone of the words that the network takes.
pub const WORDS: &str = "words";

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

/// What a network makes of a folder of `edof generate`.
pub struct Stated {
    /// The tone of the words that it takes.
    pub words: Tone,
    /// The memory images, by their paths.
    pub images: Vec<(String, String)>,
}

/// Checks that a folder of `edof generate` is of a design and, if it is stated, of a network. A folder without a manifest states no design;
/// images that it does not have are no difference.
///
/// # Errors
/// The first field or word that differs.
pub fn check(folder: &Path, design: &Design, network: Option<&Stated>) -> Result<(), Error> {
    let places = [folder.to_owned(), folder.join("..")];
    let Some(whole) = places.into_iter().find(|place| place.join(MANIFEST).is_file()) else { return Ok(()) };
    let manifest = whole.join(MANIFEST);
    let text = fs::read_to_string(&manifest).map_err(at(&manifest))?;
    let about = serde_json::from_str::<Value>(&text).unwrap_or_default();
    let (other, own) = (about.get("design"), serde_json::to_value(design).unwrap_or_default());
    if let Some(field) = other.and_then(|other| first_difference(&own, other)) {
        let value = |of: &Value| of.get(&field).map_or("nothing".to_owned(), Value::to_string);
        return Err(Error::Port(format!(
            "{}: is of another design, {field} is {}, expected {}; name the design that it was generated from by --design",
            folder.display(),
            other.map_or_else(String::new, value),
            value(&own)
        )));
    }
    let Some(Stated { words, images }) = network else { return Ok(()) };
    let stated = about.get("weights").and_then(|weights| Tone::deserialize(weights.get(WORDS)?).ok());
    if let Some(stated) = stated.filter(|stated| stated != words) {
        return Err(Error::Port(format!(
            "{}: its network takes {stated} words, expected {words} ones as the network of --weights; name the folder's network by --weights",
            folder.display()
        )));
    }
    images.iter().try_for_each(|(path, expected)| same_words(&whole.join(path), expected))
}

/// Returns the first field but the name that two designs have otherwise.
fn first_difference(own: &Value, other: &Value) -> Option<String> {
    let fields = |value: &Value| value.as_object().map(|fields| fields.keys().cloned().collect::<Vec<_>>());
    let all = [own, other].into_iter().filter_map(fields).flatten();
    all.filter(|field| field != "name").find(|field| own.get(field) != other.get(field))
}

/// Checks that a memory image has the words that are expected.
fn same_words(path: &Path, expected: &str) -> Result<(), Error> {
    let Ok(found) = fs::read_to_string(path) else { return Ok(()) };
    let words = |text: &str| text.lines().map(str::trim).map(str::to_lowercase).collect::<Vec<_>>();
    let (found, expected) = (words(&found), words(expected));
    let differs = (0..found.len().max(expected.len())).find(|line| found.get(*line) != expected.get(*line));
    let Some(line) = differs else { return Ok(()) };
    let word = |of: &[String]| of.get(line).cloned().unwrap_or_else(|| "nothing".to_owned());
    Err(Error::Port(format!(
        "{}, line {}: {}, expected {} of the network of --weights; generate the folder again, or name its network by --weights",
        path.display(),
        line + 1,
        word(&found),
        word(&expected)
    )))
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
    fn a_folder_is_of_a_design_and_of_the_words_of_a_network() {
        let folder = tempfile::tempdir().unwrap();
        let rtl = folder.path().join("rtl");
        fs::create_dir(&rtl).unwrap();
        let design = Design::from_json(include_str!("../../../../designs/tiny.json")).unwrap();
        let images = vec![("word.mem".to_owned(), "0a\nff\n".to_owned())];
        let network = Stated { words: Tone::Linear, images };
        let told = |design: &Design| check(&rtl, design, Some(&network)).map_err(|e| e.to_string());
        // Nothing states anything.
        assert_eq!(told(&design), Ok(()));
        let manifest = serde_json::json!({ "design": design }).to_string();
        fs::write(folder.path().join(MANIFEST), manifest).unwrap();
        fs::write(folder.path().join("word.mem"), "0A\nff\n").unwrap();
        assert_eq!(told(&Design { name: "other".into(), ..design.clone() }), Ok(()));
        let faster = Design { clock_mhz: 1.5, ..design.clone() };
        assert!(told(&faster).unwrap_err().contains("another design, clock_mhz is "), "{:?}", told(&faster));
        fs::write(folder.path().join("word.mem"), "0a\nfe\n").unwrap();
        assert!(
            told(&design).unwrap_err().contains("word.mem, line 2: fe, expected ff of"),
            "{:?}",
            told(&design)
        );
        assert_eq!(check(&rtl, &design, None).map_err(|e| e.to_string()), Ok(()));
        for (tone, expected) in [
            (Tone::Linear, "word.mem, line 2"),
            (Tone::Srgb, "its network takes srgb words, expected linear ones"),
        ] {
            let manifest = serde_json::json!({ "design": design, "weights": { WORDS: tone } }).to_string();
            fs::write(folder.path().join(MANIFEST), manifest).unwrap();
            assert!(told(&design).unwrap_err().contains(expected), "{:?}", told(&design));
        }
    }

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
