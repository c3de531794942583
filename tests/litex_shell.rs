//! `generate --shell`, by the real binary.

use crate::support::Place;
use serde_json::Value;

/// Path and digest of each file of a generated folder.
fn manifest(place: &Place, folder: &str) -> Vec<(String, String)> {
    let text = std::fs::read(place.path(folder).join("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_slice(&text).unwrap();
    let word = |file: &Value, field: &str| file[field].as_str().unwrap().to_owned();
    manifest["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|file| (word(file, "path"), word(file, "sha256")))
        .collect()
}

#[test]
fn the_litex_shell_adds_a_folder_and_changes_no_other_file() {
    let place = Place::new();
    place.edof("random-network --design tiny --out net.fixed.safetensors").done();
    let line = "generate --design tiny --weights net.fixed.safetensors";
    place.edof(&format!("{line} --out mig")).done();
    place.edof(&format!("{line} --shell litex --out litex")).done();
    let (mig, litex) = (manifest(&place, "mig"), manifest(&place, "litex"));
    assert!(mig.iter().all(|file| litex.contains(file)), "every file of the default shell, unchanged");
    let added: Vec<&str> =
        litex.iter().filter(|file| !mig.contains(file)).map(|(path, _)| path.as_str()).collect();
    let names = [
        "README.md",
        "bench.sv",
        "dram.py",
        "edof_soc.py",
        "kc705.py",
        "line.cpp",
        "requirements.txt",
        "sim.py",
    ];
    assert_eq!(added, names.map(|name| format!("litex/{name}")));
    let read = |path: &&str| std::fs::read_to_string(place.path("litex").join(path)).unwrap();
    let all: String = added.iter().map(read).collect();
    for words in [
        "CALCULATOR = (1, 7.000, 14.000)",
        "SCREEN = (1, 7.000, 56.000)",
        "BAUD = 921600",
        "BURST_WORDS = 64",
        "CORE_HZ = 200e6",
        "CORE = 1000 * 5.000;",
    ] {
        assert!(all.contains(words), "{words}");
    }
    let unfilled = all.split_whitespace().find(|word| word.matches('@').count() > 1);
    assert_eq!(unfilled, None, "a number of the design is missing");
}
