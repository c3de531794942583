//! Every result says how it was made; frames know what they are.

use crate::support::Place;
use crate::workspace::root;
use edof_core::storage::provenance::InputKind;
use edof_network::weight_file::{load_fixed, load_network};
use serde_json::Value;

const TRAIN: &str = "train --form one-sided,w8,t3,c16 --camera clear --images photos --photos all --depths 2 --steps 4 \
                     --batch 64 --validate-every 2";

/// A folder with a photograph to learn from.
fn with_photo() -> Place {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/edges.png", 256, 256);
    place
}

#[test]
fn weights_of_two_runs_are_the_same_bytes_and_say_how_they_were_made() {
    let place = with_photo();
    for name in ["a", "b"] {
        std::fs::create_dir(place.path(name)).unwrap();
        place.edof(&format!("{TRAIN} --out {name}/net.safetensors")).done();
        place
            .edof(&format!("quantize {name}/net.safetensors --images photos --photos all --stride 4"))
            .done();
    }
    for file in ["net.safetensors", "net.fixed.safetensors"] {
        let bytes = |folder: &str| std::fs::read(place.path(folder).join(file)).unwrap();
        assert_eq!(bytes("a"), bytes("b"), "{file}");
    }
    let float = load_network(&place.path("a/net.safetensors")).unwrap();
    let made = &float.origin.provenance;
    assert!(
        made.command.contains(" --steps 4 ") && made.command.contains(" --depths 2 "),
        "{}",
        made.command
    );
    assert_eq!((made.version.as_str(), made.host.threads), (env!("CARGO_PKG_VERSION"), None));
    assert!(!made.host.cpu.is_empty() && made.seed.is_some());
    let kinds: Vec<InputKind> = made.inputs.iter().map(|i| i.kind).collect();
    assert_eq!(kinds, [InputKind::Camera, InputKind::Photograph]);
    let fixed = load_fixed(&place.path("a/net.fixed.safetensors")).unwrap();
    let quantized = fixed.quantized.unwrap();
    assert_eq!((quantized.headroom, quantized.calibration.stride.pixels()), (2.0, 2));
    let command = &quantized.provenance.command;
    assert!(command.contains("--bits 16") && command.contains("--stride 4"), "{command}");
    let [weights, photograph] = &quantized.provenance.inputs[..] else { panic!("two inputs") };
    assert_eq!((weights.kind, &weights.sha256), (InputKind::Weights, &fixed.float_hash));
    assert_eq!(photograph.sha256, made.inputs[1].sha256);
}

#[test]
fn what_is_left_out_is_not_trained_on() {
    let place = with_photo();
    place.photo("photos/held.png", 256, 256);
    place.edof(&format!("{TRAIN} --leave-out held --out net.safetensors")).done();
    let made = load_network(&place.path("net.safetensors")).unwrap().origin.provenance;
    let photographs = made.inputs.iter().filter(|input| input.kind == InputKind::Photograph);
    assert_eq!(photographs.map(|input| input.name.as_str()).collect::<Vec<_>>(), ["photos/edges"]);
    assert!(made.command.contains(" --leave-out held "), "{}", made.command);
    place
        .edof(&format!("{TRAIN} --leave-out hold --out n.safetensors"))
        .refused(&["--leave-out hold: none of the"]);
    place
        .edof(&format!("{TRAIN} --leave-out held,edges --out o.safetensors"))
        .refused(&["leaves no photograph"]);
    // Every script that trains holds the same ones back.
    for script in ["weights.sh", "results.sh"] {
        let script = std::fs::read_to_string(root().join("scripts").join(script)).unwrap();
        let script = script.replace("\\\n", " ");
        let trainings: Vec<&str> = script.lines().filter(|line| line.contains("\"$edof\" train ")).collect();
        assert!(!trainings.is_empty());
        assert!(trainings.iter().all(|line| line.contains("--leave-out \"$held_back\"")), "{trainings:?}");
    }
}

#[test]
fn json_results_hold_the_command_their_inputs_and_the_machine() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.fixed_network("net.safetensors");
    let made = |place: &Place| -> Value {
        let run = place.edof("reconstruct raw.png --weights net.safetensors --out out.png --json").done();
        serde_json::from_str::<Value>(&run.out).unwrap()["provenance"].take()
    };
    let first = made(&place);
    assert!(
        first["command"].as_str().unwrap().starts_with("edof reconstruct raw.png --weights net.safetensors")
    );
    let kinds: Vec<&str> =
        first["inputs"].as_array().unwrap().iter().map(|i| i["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["raw-frame", "weights"]);
    assert!(first["host"]["threads"].as_u64().unwrap() > 0 && first["host"]["cpu"].is_string());
    place.raw("raw.png", 48, 34);
    let second = made(&place);
    assert_eq!(first["command"], second["command"]);
    assert_ne!(first["inputs"][0], second["inputs"][0]);
    assert_eq!(first["inputs"][1], second["inputs"][1]);
}

#[test]
fn a_captured_frame_is_read_as_it_was_taken() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    let capture = "capture chart --size 128x96 --camera clear --psi 0 --no-measure --out raw.png";
    place.edof(&format!("{capture} --phase rggb")).done();
    let reconstruct = "reconstruct raw.png --weights net.safetensors --bits 16 --out out.png";
    place.edof(reconstruct).done();
    let picture = |place: &Place| edof_io::photo::load(&place.path("out.png")).unwrap();
    let red_first = picture(&place);
    place.edof(&format!("{capture} --phase bggr")).done();
    place.edof(reconstruct).done();
    // The network copies each pixel to luma: read in its own phase, the mosaic is mirrored to red-first and cropped back.
    let blue_first = picture(&place);
    assert_eq!(blue_first.size(), red_first.size());
    place.edof(&format!("{reconstruct} --phase rggb")).refused(&["--phase rggb", "raw.png.json says bggr"]);
    place.edof(&format!("{reconstruct} --bit-depth 10")).refused(&["--bit-depth 10", "raw.png.json says 12"]);
    std::fs::remove_file(place.path("raw.png.json")).unwrap();
    place.edof(&format!("{reconstruct} --phase rggb")).done();
}

#[test]
fn a_network_for_another_camera_is_rejected_with_the_right_command() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    place.edof("capture chart --size 128x96 --camera ring-outer --psi 4 --no-measure --out raw.png").done();
    let line = "reconstruct raw.png --weights net.safetensors --out out.png";
    place.edof(line).refused(&[
        "trained for the camera clear",
        "taken by ring-outer",
        "use --weights edof-t4w12-outer",
    ]);
    place.edof("reconstruct raw.png --out out.png").done();
    // What the user states counts more than the record where both state it.
    place.edof(&format!("{line} --camera clear")).refused(&["raw.png.json says ring-outer"]);
    place.edof(&format!("{line} --camera clear --force")).done();
}

#[test]
fn a_record_of_another_frame_is_rejected() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    place.edof("capture chart --size 128x96 --camera clear --psi 0 --no-measure --out raw.png").done();
    place.raw("raw.png", 128, 96);
    let line = "reconstruct raw.png --weights net.safetensors --out out.png";
    place.edof(line).refused(&["raw.png.json", "describes another frame"]);
    place.write("raw.png.json", "{\"phase\": \"rggb\", \"sha256\": \"0\"}");
    place.edof(line).refused(&["raw.png.json", "invalid raw-frame record"]);
}

#[test]
fn a_weight_file_can_be_looked_into() {
    let place = Place::new();
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    let float = place.edof("weights net.safetensors").done().out;
    assert!(float.contains("small: trained for the camera clear") && float.contains("192x64"), "{float}");
    let fixed = place.edof("weights net.fixed.safetensors --json").done().out;
    let fixed: Value = serde_json::from_str(&fixed).unwrap();
    assert_eq!(fixed["fixed"]["layers"][2]["weight_fraction_bits"], serde_json::json!([14, 13]));
    assert_eq!(fixed["fixed"]["float_sha256"], "0");
    let both = place.edof("weights edof-t4w12").done().out;
    assert!(both.contains("noise up to 0.015\n"), "{both}");
    assert!(
        both.contains("float: ") && both.contains("fixed: ") && both.contains("made by: edof train"),
        "{both}"
    );
    place.edof("weights nothing").refused(&["nothing", "no such file"]);
    place.write("broken.safetensors", "no");
    place.edof("weights broken.safetensors").refused(&["broken.safetensors"]);
}

#[test]
fn results_about_lenses_and_hardware_name_what_they_were_made_of() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let kinds = |line: &str| -> Vec<String> {
        let run = place.edof(line).done();
        let result: Value = serde_json::from_str(&run.out).unwrap();
        let inputs = result["provenance"]["inputs"].as_array().unwrap();
        inputs.iter().map(|i| i["kind"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(kinds("scene chart --size 96x64 --out random --json"), ["camera"]);
    assert_eq!(kinds("optics clear --out lens --json"), ["camera"]);
    assert_eq!(kinds("estimate --design tiny --json"), ["design"]);
    assert_eq!(
        kinds("estimate --design paper --weights paper-t4 --photo photo.png --json"),
        ["design", "weights", "photograph"]
    );
}

/// A place with a frame, a photograph and a network.
fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.photo("photo.png", 96, 64);
    place.fixed_network("net.fixed.safetensors");
    place
}

#[test]
fn defaults_that_older_results_state_are_accepted() {
    let place = ready();
    for line in [
        "capture photo.png --camera clear --psi 1 --out o.png --layers 16 --map-of nearness",
        "capture photo.png --camera clear --psi 1 --out o.png --exact --energy 0.999 --wavelength-tolerance 0.01 --depth-tolerance 0",
        "compare photo.png photo.png --map-gain 8",
        "reconstruct raw.png --weights net.fixed.safetensors --out o.png --order little",
    ] {
        place.edof(line).done();
    }
}

#[test]
fn a_command_that_a_result_states_can_be_run_and_states_itself() {
    let place = ready();
    let stated = |line: &str| -> String {
        let run = place.edof(&format!("{line} --json")).done();
        let result: Value = serde_json::from_str(&run.out).unwrap();
        result["provenance"]["command"].as_str().unwrap().to_owned()
    };
    for (line, more, without) in [
        ("capture photo.png --camera clear --psi 1 --out o.png", "--out o.png", "--layers"),
        ("capture photo.png --camera clear --psi 1 --out o.png --exact", "--out o.png", "--energy"),
        ("compare photo.png photo.png", "", "--map-gain"),
        ("random-network --design tiny --out o", "--out o", "--kind"),
        ("cosim --design tiny --random 3", "", "--frames"),
        ("reconstruct raw.png --board --weights net.fixed.safetensors --out o.png", "--out o.png", "--bits"),
    ] {
        let first = stated(line);
        assert!(!first.contains(without), "{first}");
        assert_eq!(stated(&format!("{} {more}", first.strip_prefix("edof ").unwrap())), first);
    }
}
