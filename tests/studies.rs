//! Studies, by the real binary on small inputs: rows that are kept, resumed and shared out, and what they say.

use crate::support::{Place, network, network_of_two};
use edof_core::camera::Camera;
use edof_core::{Noise, Tone};
use edof_network::network::Condition;
use edof_network::weight_file;
use std::process::Stdio;

#[test]
fn a_study_of_one_depth_adds_rows_to_its_file_and_compares_with_the_paper() {
    let place = Place::new();
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place.edof("study dictionary --images photos --photos all --atoms 12 --patches 400 --rounds 2 --out d.safetensors").done();
    let study = |more: &str| {
        let line = "study single-depth --rows rows.jsonl --camera clear --nets net.safetensors --images photos --psi 2 --noise none \
                    --stride 8 --dictionary d.safetensors --report r.html --markdown m.md --csv rows.csv --plot p.svg --latex t.tex --methods ";
        let out = place.edof(&format!("{line}{more}")).done().out;
        let rows = std::fs::read_to_string(place.path("rows.jsonl")).unwrap();
        (out, rows)
    };
    let (_, first) = study("malvar,omp");
    let (out, rows) = study("malvar,omp,wiener");
    assert!(first.lines().all(|line| rows.lines().any(|other| other == line)), "what is there stays: {rows}");
    assert_eq!(rows.lines().count(), first.lines().count() + 1, "{rows}");
    assert!(out.contains("net.float/s8 is faster than omp/s8") && out.contains("wiener"), "{out}");
    let page = std::fs::read_to_string(place.path("m.md")).unwrap();
    assert!(page.contains("| net.float/s8 minus omp/s8 | at least 0 dB |"), "{page}");
    let report = std::fs::read_to_string(place.path("r.html")).unwrap();
    assert!(report.contains("<svg") && !report.contains("src=\"http"));
    assert!(std::fs::read_to_string(place.path("p.svg")).unwrap().starts_with("<svg"));
    let latex = std::fs::read_to_string(place.path("t.tex")).unwrap();
    assert!(
        latex.starts_with("% Made by `edof study single-depth") && latex.contains("\nomp/s8 & $"),
        "{latex}"
    );
    let csv = std::fs::read_to_string(place.path("rows.csv")).unwrap();
    assert!(csv.starts_with("method,family,") && csv.lines().count() == rows.lines().count(), "{csv}");
    let refused = |options: &str, words: &str| {
        let line = "study single-depth --rows other.jsonl --images photos";
        place.edof(&format!("{line} {options}")).refused(&[words]);
    };
    refused(
        "--camera ring-outer --nets net.safetensors",
        "net 'net.safetensors': was trained for camera clear, not ring-outer",
    );
    refused("--camera clear --nets net.safetensors --methods magic", "method 'magic': must be one of malvar");
    refused("--camera clear --nets net.safetensors --stride 3", "stride 3: must be 2, 4 or 8");
    refused("--camera clear --nets net.safetensors --psi 900", "psi 900: must lie within");
}

/// Rows of a file without their times, which no two runs agree about.
fn timeless(file: &std::path::Path) -> Vec<String> {
    let text = std::fs::read_to_string(file).unwrap();
    let line = |line: &str| {
        let mut row: serde_json::Value = serde_json::from_str(line).unwrap();
        let fields = row.as_object_mut().unwrap();
        for time in [
            "seconds_per_megapixel",
            "seconds_range",
            "cpu_seconds_range",
            "cpu_seconds_per_megapixel",
            "prepare_seconds",
            "repetitions",
            "peak_memory_bytes",
            "seconds",
            "cpu_seconds",
        ] {
            fields.remove(time);
        }
        row.to_string()
    };
    text.lines().map(line).collect()
}

#[test]
fn a_study_in_parts_one_of_them_killed_gives_the_same_file_as_a_whole_one() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place.float_network("net.safetensors");
    let line = |rows: &str, shard: &str| {
        format!(
            "study single-depth --rows {rows} --shard {shard} --camera clear --nets net.safetensors --images photos --psi 2,3.9634806967355276,6 \
             --noise none,0.01 --stride 8 --methods malvar,wiener"
        )
    };
    place.edof(&line("whole", "1/1")).done();
    let all = timeless(&place.path("whole")).len();
    let rows = || std::fs::read_to_string(place.path("1")).map_or(0, |text| text.lines().count());
    let mut part =
        place.command(&line("1", "1/2")).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while rows() < 3 && part.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    part.kill().unwrap();
    part.wait().unwrap();
    let there = rows();
    assert!((3..all / 2).contains(&there), "{there} of {all} lines: killed too late");
    place.edof(&line("1", "1/2")).done();
    place.edof(&line("2", "2/2")).done();
    place.edof("study merge --out together 2 1 --csv together.csv").done();
    assert_eq!(timeless(&place.path("together")), timeless(&place.path("whole")));
    assert_eq!(std::fs::read_to_string(place.path("together.csv")).unwrap().lines().count(), all);
    let text = std::fs::read_to_string(place.path("2")).unwrap();
    std::fs::write(place.path("2"), text.replacen("\"psnr_db\":", "\"psnr_db\":9", 1)).unwrap();
    std::fs::copy(place.path("whole"), place.path("3")).unwrap();
    place
        .edof("study merge --out wrong 2 3")
        .refused(&["3: line ", "contradicts an earlier line with the same key"]);
    place.edof("study merge --out wrong photos/p03.png").refused(&["photos/p03.png: cannot read"]);
}

#[test]
fn the_main_experiment_keeps_rows_resumes_and_is_shared_out() {
    let place = Place::new();
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    // Nothing but black: its PSNR has no end.
    place.black_photo("photos/p06.png", 64, 48);
    let line = "study kodak --nets net.safetensors --images photos --psi 0,2 --noise none";
    place.edof(&format!("{line} --rows 1 --shard 1/2")).done();
    place.edof(&format!("{line} --rows 2 --shard 2/2")).done();
    place.edof(&format!("{line} --rows whole --markdown whole.md")).done();
    place.edof("study merge 1 2 --out merged --markdown merged.md").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    // Two photographs, two depths, demosaicing and the network in two formats.
    let whole = std::fs::read_to_string(place.path("whole")).unwrap();
    assert_eq!(whole.lines().count(), 1 + 2 * 2 * 3);
    assert!(whole.contains("\"psnr_db\":\"inf\""), "{whole}");
    for part in ["\"revision\":", "\"compiler\":\"rustc ", "\"isa\":", "\"threads\":"] {
        assert!(whole.lines().next().unwrap().contains(part), "{whole}");
    }
    place.edof(&format!("{line} --rows whole --latex whole.tex")).done();
    let latex = std::fs::read_to_string(place.path("whole.tex")).unwrap();
    assert!(
        latex.starts_with("% Made by `edof study kodak") && latex.contains("\\begin{tabular}{llrr}"),
        "{latex}"
    );
    assert!(
        latex.contains("& $\\psi = 2$ & average \\\\\n")
            && latex.contains("demosaic-malvar & ")
            && latex.contains("$\\infty$"),
        "{latex}"
    );
    assert_eq!(std::fs::read_to_string(place.path("whole")).unwrap(), whole, "nothing is measured twice");
    // The page names the very command, which makes it again.
    let page = std::fs::read_to_string(place.path("whole.md")).unwrap();
    let command = page.split("Made by `edof ").nth(1).unwrap().split('`').next().unwrap();
    assert!(command.contains("--rows whole") && command.contains("--markdown whole.md"), "{command}");
    place.edof(command).done();
    assert_eq!(std::fs::read_to_string(place.path("whole.md")).unwrap(), page);
    assert!(page.contains("NO net.fixed ROWS"), "{page}");

    // A tone that no network was trained for is named.
    for (tones, says) in [("linear", false), ("srgb", true)] {
        let run =
            place.edof(&format!("{} --tone {tones} --noise none", line.replace(" --noise none", ""))).done();
        let note = "every network was trained on pictures of tone linear; --tone linear measures them";
        assert_eq!(run.err.contains(note), says, "{tones}: {}", run.err);
    }

    // Rows of another program stay only where asked, and the page names both.
    let revision = whole.split("\"revision\":\"").nth(1).unwrap().split('"').next().unwrap();
    std::fs::write(place.path("old"), whole.replacen(revision, "0123abcd", 1)).unwrap();
    let refused = place.edof(&format!("{line} --rows old"));
    assert_eq!((refused.code, refused.out.as_str()), (Some(1), ""), "{}", refused.err);
    let words = ["old: its rows are of kodak 2 (", "by --any-revision"];
    assert!(words.iter().all(|word| refused.err.contains(word)), "{}", refused.err);
    place.edof(&format!("{line},0.01 --rows old --any-revision --markdown old.md")).done();
    let page = std::fs::read_to_string(place.path("old.md")).unwrap();
    assert!(page.contains("(rows of 2 programs: revision `0123abcd`, ") && page.contains(revision), "{page}");
    // The rest of a machine that stopped is dropped, and reported.
    std::fs::write(place.path("torn"), &whole[..whole.len() - 20]).unwrap();
    let run = place.edof(&format!("{line} --rows torn")).done();
    assert!(run.err.contains("torn: dropped the last "), "{}", run.err);
    assert_eq!(timeless(&place.path("torn")), timeless(&place.path("whole")));
}

/// Networks of two ranges of noise, their weights not the same.
fn of_class(place: &Place, name: &str, level: f32, range: [f64; 2]) {
    let mut network = network();
    let [least_noise, noise] = range.map(Noise::gaussian);
    network.origin.conditions = vec![Condition { tone: Tone::Linear, noise, least_noise }];
    network.linear_path.iter_mut().for_each(|path| *path *= level);
    weight_file::save_network(&place.path(name), &network).unwrap();
}

#[test]
fn several_networks_are_one_method_that_picks_by_the_noise() {
    let place = Place::new();
    of_class(&place, "my-low.safetensors", 1.0, [0.0, 0.005]);
    of_class(&place, "my-high.safetensors", 0.9, [0.005, 0.03]);
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    let nets = "my-low.safetensors+my-high.safetensors,my-low.safetensors,my-high.safetensors";
    let line = format!("study kodak --nets {nets} --images photos --psi 0 --noise none,0.02");
    let page = place.edof(&format!("{line} --rows rows --json s.json --markdown s.md")).done();
    assert!(page.out.contains("my-by-noise.float"), "{}", page.out);
    let db = |method: &str, noise: &str| {
        let json = std::fs::read(place.path("s.json")).unwrap();
        let study: serde_json::Value = serde_json::from_slice(&json).unwrap();
        let rows = study["rows"].as_array().unwrap();
        let row = rows.iter().find(|row| row["method"] == method && row["noise"] == noise);
        row.unwrap_or_else(|| panic!("{method} {noise}"))["psnr_db"].as_f64().unwrap()
    };
    for (noise, own, other) in [("none", "my-low", "my-high"), ("0.02", "my-high", "my-low")] {
        assert_eq!(db("my-by-noise.float", noise), db(&format!("{own}.float"), noise));
        assert_ne!(db("my-by-noise.float", noise), db(&format!("{other}.float"), noise));
    }
    // Another network of the same name makes other rows.
    let before = db("my-by-noise.float", "0.02");
    of_class(&place, "my-high.safetensors", 0.8, [0.005, 0.03]);
    let again = line.replace(",my-low.safetensors,my-high.safetensors", "");
    place.edof(&format!("{again} --rows rows --json s.json")).done();
    assert_ne!(db("my-by-noise.float", "0.02"), before);
    let clear = "study kodak --nets my-low.safetensors+edof-t4w12-outer --images photos --psi 0";
    place.edof(clear).refused(&["net 'edof-t4w12-outer': differs from 'my-low' in its camera"]);
}

#[test]
fn scenes_at_four_depths_fill_the_papers_columns() {
    let place = Place::new();
    place.float_network("net.safetensors");
    let line = "study multi-depth --scenes chart --height 64 --width 96 --nets net.safetensors --clear-net net.safetensors";
    let outputs = "--rows whole --report r.html --markdown m.md --csv c.csv --json j.json";
    let run = place.edof(&format!("{line} {outputs}")).done();
    assert!(run.out.contains("coded lens, net.float"), "{}", run.out);
    let page = std::fs::read_to_string(place.path("m.md")).unwrap();
    for column in
        ["clear lens, focused on the background, blind deconvolution | 17.95 |", "coded lens, OMP | 24.78 |"]
    {
        assert!(page.contains(column), "{page}");
    }
    assert_eq!(std::fs::read_to_string(place.path("c.csv")).unwrap().lines().count(), 1 + 2 + 3 + 4);
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("j.json")).unwrap()).unwrap();
    assert_eq!(json["scenes"][0]["pictures"].as_array().unwrap().len(), 9);

    place.edof(&format!("{line} --rows 1 --shard 1/2")).done();
    place.edof(&format!("{line} --rows 2 --shard 2/2")).done();
    place.edof("study merge 2 1 --out merged --report merged.html --csv merged.csv").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    let [from_parts, from_one] =
        ["merged.html", "r.html"].map(|f| std::fs::read_to_string(place.path(f)).unwrap());
    assert_eq!(from_parts.matches("<figure>").count(), from_one.matches("<figure>").count());
    let whole = std::fs::read_to_string(place.path("whole")).unwrap();
    place.edof(&format!("{line} --rows whole")).done();
    assert_eq!(std::fs::read_to_string(place.path("whole")).unwrap(), whole, "nothing is measured twice");
    let wrong = place.edof(&format!("{line} --shard 1/2"));
    assert!(wrong.code == Some(2) && wrong.err.contains("--rows"), "{}", wrong.err);
}

#[test]
fn studies_take_distances_before_cameras_that_know_their_focus() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place.float_network("net.safetensors");
    for nominal in [5.0, 10.0] {
        let mut network = network();
        network.origin.camera.nominal_m = Some(nominal);
        place.write(&format!("from-{nominal}m.json"), network.origin.camera.to_json());
        weight_file::save_network(&place.path(&format!("from-{nominal}m.safetensors")), &network).unwrap();
    }
    let study =
        |options: &str| place.edof(&format!("study {options} --images photos --psi 3.1109m --noise none"));
    study("kodak --nets from-10m.safetensors --csv kodak").done();
    study("single-depth --camera from-10m.json --nets from-10m.safetensors --stride 8 --methods malvar --rows r --csv single").done();
    study("knobs --net from-10m.safetensors --knobs noise-class --rows k --csv knobs").done();
    for rows in ["kodak", "single", "knobs"] {
        let text = std::fs::read_to_string(place.path(rows)).unwrap();
        let (header, row) = text.split_once('\n').unwrap();
        let column = header.split(',').position(|field| field == "psi").unwrap();
        let psi: f64 = row.split(',').nth(column).unwrap().parse().unwrap();
        assert!((psi - 8.0).abs() < 1e-3, "{rows}: {psi}");
    }
    study("kodak --nets net.safetensors").refused(&["--psi 3.1109m: camera clear does not know"]);
    study("kodak --nets from-10m.safetensors,from-5m.safetensors")
        .refused(&["--psi 3.1109m: is psi 8.001 before camera clear, ", "study their nets one by one"]);
}

#[test]
fn blind_deconvolution_is_tried_on_random_blurs() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    let run = place.edof("study blind --images photos --side 7 --csv rows.csv").done();
    assert!(run.out.contains("Over 3 synthetic blurs of 1 photograph: "), "{}", run.out);
    let csv = std::fs::read_to_string(place.path("rows.csv")).unwrap();
    assert!(csv.starts_with("image,blur,side,blurred_db,") && csv.lines().count() == 4, "{csv}");
    let line = "study blind --images photos --side 7 --rows";
    place.edof(&format!("{line} 1 --shard 1/2")).done();
    place.edof(&format!("{line} 2 --shard 2/2")).done();
    place.edof(&format!("{line} whole")).done();
    let merged = place.edof("study merge 1 2 --out merged").done();
    assert!(merged.out.contains("Over 3 synthetic blurs of 1 photograph: "), "{}", merged.out);
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    place.edof("study blind --images photos --side 4").refused(&["--side 4: must be odd"]);
}

#[test]
fn codes_are_read_behind_each_lens_and_parts_of_the_study_are_merged() {
    let place = Place::new();
    let line = "study codes --nets paper-t4 --lenses clear --codes qr,ean-13 --module-px 3 --psi 0,8 --noise none --count 6";
    let run = place
        .edof(&format!("{line} --json codes.json --rows whole --csv codes.csv --markdown codes.md"))
        .done();
    assert!(run.out.contains("the widest is ") && run.out.contains("; without a network "), "{}", run.out);
    let found: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("codes.json")).unwrap()).unwrap();
    let reached = found["result"]["reached"].as_array().or_else(|| found["reached"].as_array()).unwrap();
    let sharp = reached.iter().find(|r| r["camera"] == "clear" && r["symbology"] == "ean-13").unwrap();
    assert_eq!(sharp["by_psi"][0], serde_json::json!([0.0, 1.0]), "{sharp}");
    for part in [1, 2] {
        place.edof(&format!("{line} --rows part-{part} --shard {part}/2")).done();
    }
    place.edof("study merge part-1 part-2 --out merged").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
}

#[test]
fn hard_cases_are_run_and_a_broken_promise_is_a_failure_that_names_them() {
    let place = Place::new();
    let run = place
        .edof("study stability --only gamma-index,refuse-psi --report r.html --markdown m.md --json j.json")
        .done();
    assert!(run.out.contains("All 2 promises hold"), "{}", run.out);
    let page = std::fs::read_to_string(place.path("r.html")).unwrap();
    assert!(page.contains("gamma-index: held") && page.contains("<dt>Danger</dt>"), "{page}");
    assert!(std::fs::read_to_string(place.path("m.md")).unwrap().contains("| `refuse-psi-nan` |"));
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("j.json")).unwrap()).unwrap();
    assert_eq!((&json["broken"], json["cases"].as_array().unwrap().len()), (&0.into(), 2));

    std::fs::create_dir(place.path("cases")).unwrap();
    let case = |id: &str, error: f64| {
        format!(
            r#"{{"id": "{id}", "intent": "i", "danger": "d", "trial": {{"numbers": "gradient-in-single"}}, "promise": {{"same": {{"error": {error}, "because": "b"}}}}}}"#
        )
    };
    place.write("cases/a.json", format!("[{}, {}]", case("fair", 1e-3), case("unfair", 1e-30)));
    let run = place.edof("study stability --cases cases");
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert!(run.err.contains("1 of 2 promises are broken: unfair."), "{}", run.err);
    assert!(run.out.lines().next().unwrap().starts_with("BROKEN  beyond  unfair"), "{}", run.out);
    place.float_network("net.safetensors");
    place.edof("study stability --only flat-red --nets net.safetensors").refused(&["net.fixed.safetensors"]);
    place.fixed_network("net.fixed.safetensors");
    place
        .edof("study stability --only flat-red --nets net.safetensors")
        .refused(&["--nets net.safetensors: its integers were made of another float network"]);
    place
        .edof("study stability --only nothing-of-the-kind")
        .refused(&["--only nothing-of-the-kind: no case"]);
}

/// Rows that are kept, of a revision that is not this one.
#[test]
fn a_report_opens_with_its_verdict_and_names_what_measured_its_rows() {
    let place = Place::new();
    for (name, rows) in [
        ("aperture", &include_bytes!("../crates/edof-study/tests/rows/aperture.jsonl")[..]),
        ("tolerances", include_bytes!("../crates/edof-study/tests/rows/tolerances.jsonl")),
        ("blind", include_bytes!("../crates/edof-study/tests/rows/blind.jsonl")),
        ("knobs", include_bytes!("../crates/edof-study/tests/rows/knobs.jsonl")),
        ("single-depth", include_bytes!("../crates/edof-study/tests/rows/single-depth.jsonl")),
    ] {
        place.write("rows.jsonl", rows);
        place.edof(&format!("study merge rows.jsonl --out {name}.jsonl --report {name}.html")).done();
        let page = std::fs::read_to_string(place.path(&format!("{name}.html"))).unwrap();
        let body = page.split_once("</h1>").unwrap().1.trim_start();
        assert!(body.starts_with("<p class=\"verdict\">"), "{name}: {}", &body[..200]);
        let header: serde_json::Value =
            serde_json::from_slice(rows.split(|byte| *byte == b'\n').next().unwrap()).unwrap();
        let told = match header["revision"].as_str() {
            Some(revision) => format!("# rows of revision {revision}, "),
            None => "# rows of an unknown revision, ".to_owned(),
        };
        assert!(page.contains(&told), "{name}: {told}");
    }
}

#[test]
fn bits_of_each_stage_are_reported_and_the_fewest_that_lose_next_to_nothing() {
    let place = Place::new();
    place.fixed_network("net.fixed.safetensors");
    let run = place
        .edof("study bits --nets net.fixed.safetensors --report b.html --markdown b.md --json b.json")
        .done();
    assert!(
        run.out.starts_with("small: I ") && run.out.contains(" dB together, of 0.02 allowed"),
        "{}",
        run.out
    );
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("b.json")).unwrap()).unwrap();
    let network = &json["networks"][0];
    assert!(network["fewest_lost_db"].as_f64().unwrap() <= 0.02, "{network}");
    // Three stages and all of them, from 5 to 16 bits.
    assert_eq!(network["points"].as_array().unwrap().len(), 12 * 4);
    assert!(
        std::fs::read_to_string(place.path("b.md"))
            .unwrap()
            .contains("| 16 | 0.0000 | 0.0000 | 0.0000 | 0.0000 |")
    );
    let page = std::fs::read_to_string(place.path("b.html")).unwrap();
    let verdict = "<p class=\"verdict\">With 0.02\u{a0}dB allowed, small needs these bits: I ";
    assert!(page.contains("<svg") && page.contains(verdict), "{page}");
    assert!(page.contains("dB lost together"), "{page}");
    place.edof("study bits --allowed nan").refused(&["--allowed NaN: must be 0 or more"]);
}

#[test]
fn knobs_and_foldings_are_random_with_their_defaults_and_fronts() {
    let place = Place::new();
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    let line = "study knobs --net net.safetensors --images photos --psi 2 --knobs stride,kernel-energy";
    place.edof(&format!("{line} --rows 1 --shard 1/2")).done();
    place.edof(&format!("{line} --rows 2 --shard 2/2")).done();
    place.edof(&format!("{line} --rows whole --markdown k.md")).done();
    place.edof("study merge 1 2 --out merged --report k.html").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    let page = std::fs::read_to_string(place.path("k.md")).unwrap();
    let defaults: Vec<&str> = page.lines().filter(|line| line.contains("| default |")).collect();
    assert!(
        defaults.len() == 2 && defaults[0].starts_with("| 0.999 |") && defaults[1].starts_with("| 8 |"),
        "{page}"
    );
    let wrong = place.edof(&format!("{line} --rows other --knobs magic"));
    assert_eq!(wrong.code, Some(2));
    assert!(wrong.err.contains("knob 'magic': must be one of kernel-energy, "), "{}", wrong.err);
    place.edof("study merge 1 photos/p03.png --out wrong").refused(&["p03.png: cannot read"]);

    let run = place.edof("study design --weights paper-t4 --csv f.csv --report f.html").done();
    assert!(run.out.contains("paper-t4") && run.out.contains("ring-2018"), "{}", run.out);
    let csv = std::fs::read_to_string(place.path("f.csv")).unwrap();
    assert!(
        csv.starts_with("network,camera,psnr_db,stages,cycles_per_patch,") && csv.lines().count() > 3,
        "{csv}"
    );
}

#[test]
fn errors_of_a_lens_cost_decibels_and_are_measured_once() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    let line = "study tolerances --images photos --psi 4 --noise none --errors focus --rows";
    let run = place.edof(&format!("{line} whole --markdown t.md --report t.html")).done();
    assert!(run.out.contains("focus +0.4 ψ"), "{}", run.out);
    let page = std::fs::read_to_string(place.path("t.md")).unwrap();
    assert!(page.contains("edof-t4w12-outer.float") && page.contains("tilt of the sensor"), "{page}");
    place.edof(&format!("{line} 1 --shard 1/2")).done();
    place.edof(&format!("{line} 2 --shard 2/2")).done();
    place.edof("study merge 1 2 --out merged").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    let clear = "study tolerances --net edof-t4w12-clear --images photos";
    place.edof(clear).refused(&["edof-t4w12-clear", "which has no mask", "edof-t4w12-outer"]);
}

#[test]
fn a_coded_lens_is_held_against_smaller_apertures() {
    let place = Place::new();
    let line = "study aperture --psi-ranges 8 --stops 0,1 --electrons 10000,100 --window 8";
    place.edof(&format!("{line} --rows 1 --shard 1/2")).done();
    place.edof(&format!("{line} --rows 2 --shard 2/2")).done();
    let whole =
        place.edof(&format!("{line} --rows whole --markdown a.md --report a.html --csv a.csv")).done();
    assert!(whole.out.contains("ψ 0 to 8: at the worst depth the coded lens "), "{}", whole.out);
    place.edof("study merge 1 2 --out merged").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    let page = std::fs::read_to_string(place.path("a.md")).unwrap();
    assert!(page.contains("## Verdict") && page.contains("| clear, F/4.9 | "), "{page}");
    for (options, words) in [
        ("--camera clear", "--camera clear: has no mask, expected a coded lens such as ring-outer"),
        ("--stops=-1", "--stops -1: must be from 0 to 8"),
        ("--electrons 0", "--electrons 0: must be from 1 to 1000000000"),
        ("--mean-light nan", "--mean-light NaN: must be from 0 to 1"),
        ("--psi-ranges 0", "--psi-ranges 0: must be from 0.1 to 100"),
        ("--window 9", "--window 9: must be"),
    ] {
        place.edof(&format!("study aperture {options}")).refused(&[words]);
    }
}

#[test]
fn networks_of_smaller_apertures_are_compared_on_photographs() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place.photo("photos/p06.png", 64, 48);
    place
        .edof("study aperture --psi-ranges 4 --stops 0,1 --electrons 1000 --window 8 --cameras cameras")
        .done();
    std::fs::create_dir(place.path("nets")).unwrap();
    for (name, light) in [("coded-4", 1.0), ("clear-0-4", 1.0), ("clear-1-4", 2.0)] {
        let mut network = network();
        network.origin.camera =
            Camera::resolve(place.path(&format!("cameras/{name}.json")).to_str().unwrap()).unwrap();
        let [least_noise, noise] = [1.0, 10.0].map(|gain| Noise::sensor(gain * light));
        network.origin.conditions = vec![Condition { tone: Tone::Srgb, noise, least_noise }];
        weight_file::save_network(&place.path(&format!("nets/{name}.safetensors")), &network).unwrap();
    }
    let line = "study aperture-networks --networks nets --images photos --photos all --electrons 1000,100";
    let run = place.edof(&format!("{line} --rows whole --markdown n.md --report n.html --csv n.csv")).done();
    assert!(run.out.contains("ψ 0 to 4: at the worst depth the coded lens is "), "{}", run.out);
    assert!(run.out.contains("Of 1 pair of range and light"), "no network is for 100 electrons: {}", run.out);
    let report = std::fs::read_to_string(place.path("n.html")).unwrap();
    assert!(report.contains("<p class=\"verdict\">Of 1 pair"), "{report}");
    let page = std::fs::read_to_string(place.path("n.md")).unwrap();
    assert!(page.contains("## Verdict") && page.contains("| clear, F/4.9 | "), "{page}");
    place.edof(&format!("{line} --rows 1 --shard 1/2")).done();
    place.edof(&format!("{line} --rows 2 --shard 2/2")).done();
    place.edof("study merge 1 2 --out merged").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    for (options, words) in [
        (
            "--networks photos",
            "--networks photos: has no weight files, expected a folder with NAME.safetensors of edof train",
        ),
        (
            "--networks nowhere",
            "--networks nowhere: cannot be read: No such file or directory, expected a folder with",
        ),
        ("--networks nets --stops 0", "network 'clear-1-4': was trained for camera clear-1-4, expected"),
        ("--networks nets --electrons 0", "--electrons 0: must be from 1 to 1000000000"),
    ] {
        place
            .edof(&format!("study aperture-networks --images photos --photos all {options}"))
            .refused(&[words]);
    }
}

#[test]
fn masks_and_known_depths_are_compared_on_photographs_by_networks_of_their_own() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place.photo("photos/p06.png", 64, 48);
    for folder in ["masks", "depth", "two"] {
        std::fs::create_dir(place.path(folder)).unwrap();
    }
    let save = |file: &str, camera: &str, psi_range: [f64; 2]| {
        let mut network = if file.contains("exposures") { network_of_two([4.0, 6.0]) } else { network() };
        network.origin.camera = Camera { psi_range, ..Camera::resolve(camera).unwrap() };
        // Two exposures have half of the light each.
        let frames = network.form.exposures as f64;
        let [least_noise, noise] = [frames, 10.0 * frames].map(Noise::sensor);
        network.origin.conditions = vec![Condition { tone: Tone::Srgb, noise, least_noise }];
        network.origin.provenance.seed = Some(1);
        weight_file::save_network(&place.path(file), &network).unwrap();
    };
    for (folder, name, camera, range) in [
        ("masks", "clear", "clear-mid", [0.0, 8.0]),
        ("masks", "ring", "ring-outer", [0.0, 8.0]),
        ("depth", "clear", "clear-mid", [0.0, 8.0]),
        ("depth", "clear-8", "clear-mid", [8.0, 8.0]),
        ("two", "clear", "clear-mid", [0.0, 8.0]),
        ("two", "exposures", "clear-mid", [0.0, 8.0]),
    ] {
        save(&format!("{folder}/{name}.safetensors"), camera, range);
    }
    let line = "study lens-networks --images photos --photos all --electrons 1000,100 --psi 0,8 --networks";
    let run = place.edof(&format!("{line} masks --rows whole --markdown m.md --report m.html --json")).done();
    let told: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let lenses = told["lenses"].as_array().unwrap();
    let names: Vec<&str> = lenses.iter().map(|lens| lens["lens"].as_str().unwrap()).collect();
    assert_eq!(names, ["clear-mid", "ring-outer"], "no network is for 100 electrons: {told}");
    let page = std::fs::read_to_string(place.path("m.md")).unwrap();
    assert!(
        page.starts_with("# Masks against the clear lens") && page.contains("The rule: in no light"),
        "{page}"
    );
    let report = std::fs::read_to_string(place.path("m.html")).unwrap();
    assert!(report.contains("<p class=\"verdict\">"), "{report}");
    place.edof(&format!("{line} masks --rows 1 --shard 1/2")).done();
    place.edof(&format!("{line} masks --rows 2 --shard 2/2")).done();
    place.edof("study merge 1 2 --out merged").done();
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    // The depths 0 and 8 have the same kernels behind a clear lens that is focused at 4. The networks have the same weights.
    let run = place.edof(&format!("{line} depth")).done();
    assert!(run.out.contains("Knowing the depth gains +0.00 ± 0.00 dB at most (clear-mid, "), "{}", run.out);
    let run = place.edof(&format!("{line} two --markdown two.md")).done();
    assert!(run.out.contains("clear-mid, open, 2 exposures at foci 4, 6 minus one exposure"), "{}", run.out);
    place.edof("quantize two/exposures.safetensors --out q").refused(&["exposures 2: must be 1 here"]);
    for (options, words) in [
        ("--networks photos", "--networks photos: has no weight files"),
        (
            "--networks masks --psi 9",
            "network 'clear': was trained for psi 0 to 8 of the open aperture, which leaves out psi 9",
        ),
        ("--networks depth --psi 2", "lens clear-mid, seed 1: no network knows psi 2"),
        ("--networks masks --psi 101", "--psi 101: must be from -100 to 100"),
        ("--networks masks --electrons 0", "--electrons 0: must be from 1 to 1000000000"),
        ("--networks masks --read-noise nan", "--read-noise NaN: must be from 0 to"),
    ] {
        place.edof(&format!("study lens-networks --images photos --photos all {options}")).refused(&[words]);
    }
}
