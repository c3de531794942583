//! A program of the user's as a method of a study.

use crate::support::{Place, Run};

/// A study of one small photograph behind a plain lens.
fn study(place: &Place, external: &[&str]) -> Run {
    let line = "study single-depth --rows rows.jsonl --camera clear --nets net.safetensors --images photos --psi 2 --noise none \
                --stride 8 --methods malvar --csv rows.csv --report page.html";
    let mut command = place.command(line);
    command.args(external.iter().flat_map(|external| ["--external", external]));
    command.output().unwrap().into()
}

fn place() -> Place {
    let place = Place::new();
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place
}

#[test]
#[cfg(unix)]
fn a_program_has_rows_of_its_own_and_is_measured_once() {
    let place = place();
    place.write("mine.sh", "cp $1 $2\n");
    let own = ["sh mine.sh {raw} {out}"];
    study(&place, &own).done();
    let rows = std::fs::read_to_string(place.path("rows.csv")).unwrap();
    let row =
        rows.lines().find(|row| row.starts_with("external-sh,external,")).unwrap_or_else(|| panic!("{rows}"));
    // The mosaic as a grey picture is no good one, and no CPU time of this process.
    let header: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
    let cell = |name: &str| row.split(',').nth(header.iter().position(|h| *h == name).unwrap()).unwrap();
    let db: f64 = cell("psnr_db").parse().unwrap();
    assert!((5.0..40.0).contains(&db), "{row}");
    assert_eq!(cell("cpu_seconds_per_megapixel"), "");
    assert!(std::fs::read_to_string(place.path("page.html")).unwrap().contains("external-sh"));
    // The same program is not run again, another one is.
    place.write("mine.sh", "exit 3\n");
    study(&place, &own).refused(&["external-sh: 'sh mine.sh {raw} {out}' ended with exit status: 3"]);
    place.write("mine.sh", "cp $1 $2\n");
    study(&place, &own).done();
    assert_eq!(std::fs::read_to_string(place.path("rows.csv")).unwrap(), rows);
}

#[test]
fn a_command_without_its_files_and_two_of_one_name_are_rejected_before_any_work() {
    let place = place();
    let words = "external command 'mine {raw}': contains no {out}; write it as in '[NAME=]CMD {raw} {out}";
    study(&place, &["mine {raw}"]).refused(&[words]);
    let both = ["a/mine {raw} {out}", "b/mine {raw} {out}"];
    study(&place, &both).refused(&["--external: two programs are called external-mine"]);
    assert!(!place.path("rows.jsonl").exists());
}

#[test]
#[cfg(unix)]
fn a_program_with_a_list_makes_all_pictures_in_one_process() {
    let place = place();
    place.photo("photos/p06.png", 64, 48);
    let script = "echo start >> starts; echo ready\nwhile IFS='\t' read -r raw out rest; do cp $raw $out; echo $out; done < $1\n";
    place.write("mine.sh", script);
    study(&place, &["mine=sh mine.sh {list}"]).done();
    let rows = std::fs::read_to_string(place.path("rows.csv")).unwrap();
    assert_eq!(rows.lines().filter(|row| row.starts_with("external-mine,external,")).count(), 2, "{rows}");
    assert_eq!(std::fs::read_to_string(place.path("starts")).unwrap(), "start\n");
}
