//! A generated folder replaces only files that an earlier run wrote; a result replaces an earlier result of its kind.

use crate::support;
use crate::support::Place;

const GENERATE: &str = "generate --design paper --weights paper-t4 --out out --quiet";

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
        let mut words = vec!["--out out", "--force", if foreign.is_empty() { "notes.txt" } else { edited.0 }];
        words.extend(foreign.iter().map(|(file, _)| *file));
        place.edof(GENERATE).refused(&words);
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

#[test]
fn a_result_replaces_the_result_of_an_earlier_run() {
    let place = Place::new();
    for line in [
        "doctor --json message.json",
        "estimate --design tiny --json message.json",
        "design new --weights paper-t4 --out mine.json --force",
        "random-network --design tiny --out net",
        "scene chart --size 64x64 --psi 1 --out random",
        "board map --json message.json",
    ] {
        place.edof(line).done();
        place.edof(line).done();
    }
    assert_eq!(place.files(), ["message.json", "mine.json", "net", "random"]);
}
