//! Options that would be ignored in silence: an error that names what they need. The defaults that a stated command repeats are none.

use crate::support::Place;
use serde_json::Value;

fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.photo("photo.png", 96, 64);
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/kodim03.png", 288, 256);
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place
}

const CAPTURE: &str = "capture photo.png --camera clear --psi 1 --out o.png";
const QUANTIZE: &str = "quantize net.safetensors --out o";
const RECONSTRUCT: &str = "reconstruct raw.png --weights net.fixed.safetensors --out o.png";

/// A command, an option that it ignores there, and what the option needs.
const ROWS: [(&str, &str, &str); 24] = [
    (CAPTURE, "--layers 8", "has an effect only with --depth-map"),
    (CAPTURE, "--layers 1", "has an effect only with --depth-map"),
    (CAPTURE, "--map-of distance", "has an effect only with --depth-map"),
    (CAPTURE, "--exact --energy 0.9", "has no effect with --exact"),
    (CAPTURE, "--exact --wavelength-tolerance 0.1", "has no effect with --exact"),
    (CAPTURE, "--exact --depth-tolerance 0.5", "has no effect with --exact"),
    ("optics clear --psi 0 --out o", "--exact --energy 0.9", "has no effect with --exact"),
    ("compare photo.png photo.png", "--map-gain 2", "has an effect only with --map"),
    (QUANTIZE, "--finetune-rate 0.7", "has an effect only with --finetune"),
    (QUANTIZE, "--finetune 0 --finetune-rate 0.7", "has an effect only with --finetune"),
    (RECONSTRUCT, "--order big", "has an effect only with --size"),
    ("study single-depth --rows o --images photos", "--external-seconds 5", "only with --external"),
    ("study multi-depth", "--external-seconds 5", "only with --external"),
    ("study multi-depth", "--external-seconds 601", "only with --external"),
    ("board sim --design tiny", "--port x", "has no effect on edof board sim"),
    ("board sim --design tiny", "--timeout 2", "has no effect on edof board sim"),
    ("board map", "--port x", "has no effect on edof board map"),
    ("board map", "--baud 9600", "has no effect on edof board map"),
    ("board map --format c", "--timeout 2", "has no effect on edof board map"),
    ("cosim --design tiny --random 3", "--patches 7", "has no effect with --random"),
    ("cosim --design tiny", "--frames 2", "--system"),
    ("optics design --out o", "--rounds 2", "--through"),
    ("optics design --through net.safetensors --out o", "--population 9", "--through"),
    ("cosim --design tiny", "--display luma", "--system"),
];

#[test]
fn an_option_without_effect_is_an_error_that_names_what_it_needs() {
    let place = ready();
    let before = place.snapshot();
    for (line, option, needs) in ROWS {
        let run = place.edof_within_bounds(&format!("{line} {option}"));
        assert!(matches!(run.code, Some(1 | 2)), "{line} {option}: {:?} {}", run.code, run.err);
        let name = option.split(' ').rev().nth(1).unwrap();
        assert!(run.err.contains(name) && run.err.contains(needs), "{line} {option}: {}", run.err);
        assert!(run.out.is_empty() && place.snapshot() == before, "{line} {option}: {}", run.out);
    }
}

#[test]
fn defaults_that_older_results_state_are_accepted() {
    let place = ready();
    for line in [
        format!("{CAPTURE} --layers 16 --map-of nearness"),
        format!("{CAPTURE} --exact --energy 0.999 --wavelength-tolerance 0.01 --depth-tolerance 0"),
        "compare photo.png photo.png --map-gain 8".to_owned(),
        format!("{RECONSTRUCT} --order little"),
        "board map --baud 921600".to_owned(),
    ] {
        place.edof(&line).done();
    }
}

#[test]
fn a_command_that_a_result_states_can_be_run_and_states_itself() {
    let place = ready();
    let stated = |line: &str| -> String {
        let run = place.edof(&format!("{line} --json")).done();
        let told: Value = serde_json::from_str(&run.out).unwrap();
        told["provenance"]["command"].as_str().unwrap().to_owned()
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
