//! No command writes over what it reads, nor one output over another; and a generated folder replaces only what it wrote itself.

use crate::support;
use crate::support::Place;

/// One of everything that a command reads.
fn ready() -> Place {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.photo("photo.png", 64, 48);
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.float_network("net.safetensors");
    place.fixed_network("net.fixed.safetensors");
    place.write("camera.json", include_str!("../cameras/clear.json"));
    let map = "{\"height_map\": {\"file\": \"mask.png\", \"white_um\": 0.8, \"cauchy\": [1.458, 0.00354]},";
    place.write("masked.json", include_str!("../cameras/clear.json").replacen('{', map, 1));
    place.raw("mask.png", 32, 32);
    place.write("design.json", include_str!("../designs/tiny.json"));
    std::os::unix::fs::symlink("raw.png", place.path("link.png")).unwrap();
    std::os::unix::fs::symlink("new.json", place.path("new-link.json")).unwrap();
    place
}

const TRAIN: &str =
    "train --form two-sided,w8,t2,c8 --images photos --depths 1 --steps 4 --batch 64 --validate-every 2";
const GENERATE: &str = "generate --design paper --weights paper-t4 --out out --quiet";

#[test]
fn no_output_replaces_an_input() {
    let place = ready();
    let before = place.snapshot();
    let fixed = "--weights net.fixed.safetensors";
    for line in [
        format!("reconstruct raw.png {fixed} --out raw.png"),
        format!("reconstruct raw.png {fixed} --out photos/../raw.png"),
        format!("reconstruct raw.png {fixed} --out link.png"),
        format!("reconstruct link.png {fixed} --out raw.png"),
        format!("reconstruct raw.png {fixed} --out out.png --json raw.png"),
        format!("reconstruct raw.png {fixed} --out out.png --json net.fixed.safetensors"),
        format!("reconstruct raw.png {fixed} --out out.png --camera camera.json --json camera.json"),
        format!("reconstruct raw.png {fixed} --out mask.png --camera masked.json"),
        "reconstruct raw.png --float --weights net.safetensors --out out.png --json net.safetensors"
            .to_owned(),
        "capture photo.png --psi 1 --out photo.png".to_owned(),
        "capture photo.png --psi 1 --out raw2.png --sharp photo.png".to_owned(),
        "capture photo.png --psi 1 --out raw2.png --light photo.png".to_owned(),
        "capture photo.png --psi 1 --out raw2.png --camera camera.json --json camera.json".to_owned(),
        "scene chart --camera camera.json --json camera.json".to_owned(),
        "optics camera.json --json camera.json".to_owned(),
        "optics design --camera camera.json --out camera.json".to_owned(),
        "optics design --images photos --out photos/a.png".to_owned(),
        "quantize net.safetensors --out net.safetensors".to_owned(),
        "quantize net.safetensors --out x --json net.safetensors".to_owned(),
        "quantize net.safetensors --images photos --out photos/a.png".to_owned(),
        "study kodak --nets net.safetensors --images photos --report photos/a.png".to_owned(),
        "study kodak --nets net.safetensors --images photos --json net.fixed.safetensors".to_owned(),
        "study single-depth --rows photos/a.png --images photos --nets net.safetensors".to_owned(),
        "study single-depth --rows r --report net.safetensors --images photos --nets net.safetensors"
            .to_owned(),
        "study dictionary --images photos --out photos/a.png".to_owned(),
        "study multi-depth --nets net.safetensors --clear-net net.safetensors --csv net.safetensors"
            .to_owned(),
        "study merge --out photo.png photo.png".to_owned(),
        "study blind --images photos --csv photos/a.png".to_owned(),
        "study knobs --rows photos/a.png --images photos --net net.safetensors".to_owned(),
        "study design --weights net.fixed.safetensors --csv net.fixed.safetensors".to_owned(),
        format!("{TRAIN} --camera clear --out photos/a.png"),
        format!("{TRAIN} --camera camera.json --out camera.json"),
        "demo --net net.fixed.safetensors --json net.fixed.safetensors".to_owned(),
        "demo --clear-net net.fixed.safetensors --json net.fixed.safetensors".to_owned(),
        "estimate --design design.json --json design.json".to_owned(),
        "timing --design design.json --json design.json".to_owned(),
        "cosim --design design.json --json design.json".to_owned(),
        "cosim --design design.json --junit design.json".to_owned(),
        "cosim --design tiny --photo photo.png --json photo.png".to_owned(),
        "board load net.fixed.safetensors --dry-run --design tiny --json net.fixed.safetensors".to_owned(),
        "board load net.fixed.safetensors --dry-run --design design.json --json design.json".to_owned(),
        "board load edof-t4w12-outer --dry-run --design design.json --json design.json".to_owned(),
        "board verify net.fixed.safetensors --json net.fixed.safetensors".to_owned(),
        "board info --design design.json --json design.json".to_owned(),
        "board find --design design.json --json design.json".to_owned(),
        "board sim --design design.json --picture design.yuyv --json design.json".to_owned(),
        "board sim --weights net.fixed.safetensors --link net.fixed.safetensors".to_owned(),
        "board sim --frame raw.png --picture link.png".to_owned(),
        "generate --design design.json --weights net.fixed.safetensors --out out --json design.json"
            .to_owned(),
    ] {
        // Designs and networks of a form of their own may be rejected for that first; nothing may be written anyway.
        let run = place.edof(&line);
        if !line.starts_with("generate") {
            assert!(run.err.contains("would replace"), "{line}: {}", run.err);
        }
        run.refused(&[]);
        assert!(place.snapshot() == before, "{line}: files changed");
    }
}

#[test]
fn no_output_replaces_another() {
    let place = ready();
    let before = place.snapshot();
    for line in [
        "reconstruct raw.png --weights net.fixed.safetensors --out out.png --json photos/../out.png"
            .to_owned(),
        "capture photo.png --psi 1 --out x.png --sharp x.png".to_owned(),
        "capture photo.png --psi 1 --out x.png --light ./x.png".to_owned(),
        "scene chart --out drawn --json drawn/sharp.png".to_owned(),
        "optics --out figures --json figures/mtf.svg".to_owned(),
        "optics design --out x.json --json x.json".to_owned(),
        "optics design --out new-link.json --json new.json".to_owned(),
        "quantize net.safetensors --out x --json x".to_owned(),
        "study kodak --nets net.safetensors --images photos --report x --json x".to_owned(),
        "study single-depth --rows x --markdown x --images photos --nets net.safetensors".to_owned(),
        "study dictionary --images photos --out x --json x".to_owned(),
        "study multi-depth --nets net.safetensors --clear-net net.safetensors --report x --csv x".to_owned(),
        "study merge photo.png --out x --markdown x".to_owned(),
        "study knobs --rows x --csv x --images photos --net net.safetensors".to_owned(),
        format!("{TRAIN} --camera clear --out x --json x.checkpoint"),
        "demo --net net.fixed.safetensors --out shown --json shown/report.html".to_owned(),
        "demo --net net.fixed.safetensors --out shown --json shown/coded-lens-reconstructed.png".to_owned(),
        "cosim --design tiny --junit x --json x".to_owned(),
        "cosim --design tiny --waveform x --json x.fst".to_owned(),
        format!("{GENERATE} --json out/manifest.json"),
        format!("{GENERATE} --json out/rtl/edof_ram.v"),
    ] {
        place.edof(&line).refused(&["each output needs a file of its own"]);
        assert!(place.snapshot() == before, "{line}: files changed");
    }
}

#[test]
fn generating_again_leaves_a_folder_as_new() {
    let place = Place::new();
    place.edof(GENERATE).done();
    let first = place.snapshot();
    // Another network has other images and other names among them; none of the old ones stays.
    place.edof("generate --design kc705 --weights edof-t4w12-outer --out out").done();
    place.edof(GENERATE).done();
    assert!(place.snapshot() == first);
}

#[test]
fn what_stands_in_a_generated_folder_and_is_not_its_own_is_named_and_kept() {
    let place = Place::new();
    place.edof(GENERATE).done();
    let mut expected = place.snapshot();
    for (foreign, edited) in [
        (&[("notes.txt", "a week's work"), ("mem/mine.mem", "00")][..], ("rtl/chain.v", "an edited module")),
        // The notes are still there.
        (&[], ("manifest.json", "{}")),
    ] {
        for (file, text) in foreign.iter().chain([&edited]) {
            place.write(&format!("out/{file}"), text);
        }
        let before = place.snapshot();
        let mut told = vec!["--out out", "--force", if foreign.is_empty() { "notes.txt" } else { edited.0 }];
        told.extend(foreign.iter().map(|(file, _)| *file));
        place.edof(GENERATE).refused(&told);
        assert!(place.snapshot() == before, "{edited:?}");
        place.edof(&format!("{GENERATE} --force")).done();
        for (file, text) in foreign {
            expected.insert(place.path("out").join(file), (*text).into());
        }
        assert!(place.snapshot() == expected, "{edited:?}: --force replaces what is in the way and no more");
    }
}

#[test]
fn a_manifest_of_someone_else_gives_nothing_away() {
    let place = Place::new();
    std::fs::create_dir(place.path("out")).unwrap();
    place.write("out/thesis.txt", "words");
    place.write("thesis.txt", "words");
    let hash = "4c9d1f5e7c0a56e8"; // Whatever it says, it is not sealed.
    for path in ["thesis.txt", "../thesis.txt"] {
        let manifest = format!("{{\"files\":[{{\"path\":\"{path}\",\"sha256\":\"{hash}\"}}]}}");
        place.write("out/manifest.json", manifest);
        let before = place.snapshot();
        place.edof(GENERATE).refused(&["changed since: thesis.txt"]);
        assert!(place.snapshot() == before);
    }
}

#[test]
fn a_link_in_a_generated_folder_leads_nowhere() {
    let place = Place::new();
    std::fs::create_dir(place.path("elsewhere")).unwrap();
    place.write("elsewhere/chain.v", "an original");
    std::fs::create_dir(place.path("out")).unwrap();
    std::os::unix::fs::symlink("../elsewhere", place.path("out/rtl")).unwrap();
    let before = place.snapshot();
    place.edof(GENERATE).refused(&["rtl", "--force"]);
    place.edof(&format!("{GENERATE} --force")).refused(&["in its way"]);
    assert!(place.snapshot() == before);
}

#[test]
fn of_two_that_write_one_folder_the_second_is_rejected_as_such() {
    let place = Place::new();
    place.edof(GENERATE).done();
    let before = place.snapshot();
    let folder = std::fs::File::open(place.path("out")).unwrap();
    folder.lock().unwrap();
    place.edof(GENERATE).refused(&["--out out: another edof is writing into it"]);
    assert!(place.snapshot() == before);
    drop(folder);
    place.edof(GENERATE).done();
}

#[test]
fn a_folder_that_cannot_be_written_is_left_as_it_was() {
    let place = Place::new();
    place.edof(GENERATE).done();
    let before = place.snapshot();
    let binary = env!("CARGO_BIN_EXE_edof");
    let script = format!("ulimit -f 1; exec {binary} {GENERATE}");
    let mut shell = std::process::Command::new("sh");
    let run: support::Run = shell.args(["-c", &script]).current_dir(place.path("")).output().unwrap().into();
    run.refused(&["cannot write"]);
    assert!(place.snapshot() == before);
}
