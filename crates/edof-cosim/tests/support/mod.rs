//! Small hand-written designs, and one cache for all tests.
use edof_cosim::verilator::{Library, Options, Waveform};
use edof_cosim::{Port, Source};
use std::path::{Path, PathBuf};

/// Keeps compiled models between runs of the tests.
pub fn options() -> Options {
    let cache = Path::new(env!("CARGO_TARGET_TMPDIR")).join("edof/models");
    Options { cache: Some(cache), precompile: true, ..Options::default() }
}

/// A cache of its own, which has Verilator's library already and no model.
pub fn fresh_cache() -> (tempfile::TempDir, Options) {
    build(&ticks());
    let (cache, shared) = (tempfile::tempdir().unwrap(), options().cache.unwrap());
    for file in std::fs::read_dir(shared).unwrap().map(Result::unwrap) {
        if file.path().extension().is_some_and(|end| end == "o") {
            std::fs::copy(file.path(), cache.path().join(file.file_name())).unwrap();
        }
    }
    let options = Options { cache: Some(cache.path().into()), optimize: 0, ..Options::default() };
    (cache, options)
}

/// Compiled without waveforms.
pub fn build(source: &Source) -> Library {
    Library::build(source, &options()).unwrap()
}

/// Compiled with waveforms of that kind.
pub fn build_traced(source: &Source, waveform: Waveform) -> Library {
    Library::build(source, &Options { waveform, ..options() }).unwrap()
}

fn design(top: &str, text: &str, ports: Vec<Port>) -> Source {
    Source { top: top.into(), files: vec![(format!("{top}.v"), text.into())], ports }
}

/// Ports: clock, reset, enable; count, last, free.
pub fn ticks() -> Source {
    let inputs = [Port::clock("clock_i"), Port::input("reset_i", 1), Port::input("enable_i", 1)];
    let outputs = [Port::output("count_o", 8), Port::output("last_o", 1), Port::output("free_o", 32)];
    design(
        "ticks",
        include_str!("../../../../sim/modules/ticks.v"),
        inputs.into_iter().chain(outputs).collect(),
    )
}

/// Ports: clock; inputs of 1, 33, 64, 100 bits; as many outputs, which are their complements.
pub fn wide() -> Source {
    let names = ["a__bit", "half", "full", "wide"].into_iter().zip([1, 33, 64, 100]);
    let inputs = names.clone().map(|(name, bits)| Port::input(&format!("{name}_i"), bits));
    let outputs = names.map(|(name, bits)| Port::output(&format!("{name}_o"), bits));
    let ports = std::iter::once(Port::clock("clock_i")).chain(inputs).chain(outputs);
    design("wide", include_str!("../../../../sim/modules/wide.v"), ports.collect())
}

/// Ports: clock, reset, go, data (16); busy, data (16), trail (72). Reads `images/machine.hex`.
pub fn machine() -> Source {
    let inputs = [Port::clock("clock_i"), Port::input("reset_i", 1), Port::input("go_i", 1)];
    let data = [Port::input("data_i", 16), Port::output("busy_o", 1), Port::output("data_o", 16)];
    let ports = inputs.into_iter().chain(data).chain([Port::output("trail_o", 72)]);
    design("machine", include_str!("../../../../sim/modules/machine.v"), ports.collect())
}

/// Ports: clock, first, a (16), b (16); sum (48).
pub fn macc() -> Source {
    let inputs = [Port::clock("clock_i"), Port::input("first_i", 1), Port::input("a_i", 16)];
    let rest = [Port::input("b_i", 16), Port::output("sum_o", 48)];
    design("macc", include_str!("../../../../sim/modules/macc.v"), inputs.into_iter().chain(rest).collect())
}

/// A directory with the memory image of [`machine`], whose words are `start`, `start` + 1, …
pub fn images(start: u16) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("images")).unwrap();
    let words: String = (0..16).map(|i| format!("{:04x}\n", start + i)).collect();
    std::fs::write(dir.path().join("images/machine.hex"), words).unwrap();
    let path = dir.path().to_owned();
    (dir, path)
}

/// Instances in the text of a module, with their modules: `module name (` or `module #(parameters) name (`.
pub fn instances<'a>(text: &'a str) -> Vec<(String, String)> {
    // The module of an instance whose name stands below its parameters.
    let mut open = "";
    let instance = |line: &'a str| {
        let (module, rest) = line.trim().split_once(' ')?;
        if rest == "#(" || (rest.starts_with("#(") && rest.ends_with(')')) {
            open = module;
            return None;
        }
        if rest.starts_with("(.") {
            return Some((module.to_string(), open.to_string()));
        }
        let module = if module == ")" { open } else { module };
        let rest = match rest.strip_prefix("#(") {
            Some(parameters) => parameters.split_once(")) ")?.1,
            None => rest,
        };
        let (name, _) = rest.split_once(" (")?;
        let words = ["module", "always", "if", "else", "assign", "case", "for", "//"];
        (!words.contains(&module) && !name.contains(' ')).then(|| (name.to_string(), module.to_string()))
    };
    text.lines().filter_map(instance).collect()
}
