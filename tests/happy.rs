//! What the program is for, done by the real binary on small inputs.

use crate::support::{Place, network};
use edof_image::Tone;
use edof_io::photo;
use edof_io::raw::{self, RawOptions};
use edof_network::weight_file;
use serde_json::json;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

#[test]
fn a_network_that_copies_gives_the_raw_pixels_back() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    place.float_network("net.safetensors");
    let line = "reconstruct raw.png --weights net.safetensors --float --stride 4 --bits 16 --tone linear --out out.png";
    let run = place.edof(line).done();
    assert!(run.out.starts_with("out.png: 48x32 by small.float in "), "{}", run.out);
    let raw = raw::load(&place.path("raw.png"), &RawOptions::default()).unwrap();
    let picture = photo::load(&place.path("out.png")).unwrap();
    for ((_, r, c), v) in picture.planes.indexed_iter() {
        assert!((v - f32::from(raw.pixels()[(r, c)]) / 65536.0).abs() < 1e-4);
    }
}

#[test]
fn the_fixed_network_is_the_default_and_reports_as_json() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    place.fixed_network("net.safetensors");
    let run =
        place.edof("reconstruct raw.pgm --weights net.safetensors --tone linear --out out.ppm --json").done();
    let report: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(report["method"], "small.fixed");
    assert_eq!((&report["width"], &report["height"]), (&48.into(), &32.into()));
    // 4×6 patches of (I 4·64) + (M 4·4) + (F 128·4) + (R 128·64); all sparse codes are zero, so I and R alone are carried out.
    assert_eq!(report["multiplications"], json!({ "dense": 24 * 8976, "executed": 24 * 8448 }));
    let raw = raw::load(&place.path("raw.pgm"), &RawOptions::default()).unwrap();
    let picture = photo::load(&place.path("out.ppm")).unwrap();
    for ((_, r, c), v) in picture.planes.indexed_iter() {
        assert!((v - f32::from(raw.pixels()[(r, c)]) / 65536.0).abs() < 1.0 / 255.0);
    }
}

#[test]
fn a_picture_is_encoded_for_looking_at_unless_told_otherwise() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    place.fixed_network("net.safetensors");
    let picture = |more: &str| {
        place.edof(&format!("reconstruct raw.pgm --weights net.safetensors --out out.png {more}")).done();
        photo::load(&place.path("out.png")).unwrap().planes[(1, 5, 7)]
    };
    let light = picture("--tone linear");
    for encoded in [picture(""), picture("--tone srgb"), picture("--tone linear --gamma srgb")] {
        assert!((encoded - Tone::Srgb.encode(light)).abs() < 2.0 / 255.0, "{light} shows as {encoded}");
    }
    assert!((picture("--gamma linear") - light).abs() < 1e-6);
}

#[test]
fn a_frame_that_was_taken_of_codes_gives_codes_back_unless_told_otherwise() {
    let place = Place::new();
    place.photo("photo.png", 128, 96);
    place.fixed_network("net.safetensors");
    place.edof("capture photo.png --camera clear --psi 0 --tone linear --no-measure --out raw.png").done();
    let tone = |more: &str| {
        let line = format!("reconstruct raw.png --weights net.safetensors --out out.png {more} --json");
        let report: serde_json::Value = serde_json::from_str(&place.edof(&line).done().out).unwrap();
        report["tone"].clone()
    };
    assert_eq!((tone(""), tone("--tone srgb --force")), (json!("linear"), json!("srgb")));
}

#[test]
fn the_boards_own_codes_come_with_what_a_screen_shows() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    place.fixed_network("net.safetensors");
    let line = "reconstruct raw.pgm --weights net.safetensors --board --words words --out board.png --json board.json";
    for mode in ["colour", "luma"] {
        place.edof(&format!("{line} --display {mode}")).done();
        let codes = std::fs::read(place.path("board.yuyv")).unwrap();
        let shown = photo::load(&place.path("board.png")).unwrap();
        assert_eq!((codes.len(), shown.size()), (2 * 48 * 32, (32, 48)));
        for (index, pair) in codes.chunks(4).enumerate() {
            // Grey, for this network has no colour: BT.709 studio range.
            assert_eq!((pair[1], pair[3]), (128, 128));
            let grey = (f32::from(pair[2]) - 16.0) * 255.0 / 219.0;
            let pixel = shown.planes[(0, 2 * index / 48, 2 * index % 48 + 1)] * 255.0;
            assert!((pixel - grey).abs() <= 0.51, "{pixel}, expected {grey}");
        }
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(place.path("board.json")).unwrap()).unwrap();
        assert_eq!(report["display"], json!({ "mode": mode, "clamped_chroma": 0, "out_of_gamut": 0 }));
        assert_eq!(report["counters"]["saturated_sums"], 0);
        assert_eq!(report["counters"]["stages"].as_array().unwrap().len(), 3);
    }
    assert_eq!(
        place.files(),
        ["board.json", "board.png", "board.yuyv", "net.safetensors", "raw.pgm", "words"]
    );
}

#[test]
fn a_drawn_network_reconstructs_and_is_the_same_for_the_same_seed() {
    let place = Place::new();
    place.raw("raw.pgm", 48, 32);
    let draw = |name: &str, seed: u32| {
        let form = "two-sided,w8,t3,c12,difference";
        place
            .edof(&format!("random-network --form {form} --bits 10 --stride 4 --seed {seed} --out {name}"))
            .done();
        std::fs::read(place.path(name)).unwrap()
    };
    assert_eq!(draw("a.fixed.safetensors", 7), draw("b.fixed.safetensors", 7));
    assert_ne!(draw("a.fixed.safetensors", 7), draw("c.fixed.safetensors", 8));
    place.edof("reconstruct raw.pgm --weights a.fixed.safetensors --out out.png").done();
}

#[test]
fn a_network_by_name_is_found_under_weights() {
    let place = Place::new();
    place.raw("raw.png", 48, 32);
    std::fs::create_dir(place.path("weights")).unwrap();
    place.float_network("weights/mine.safetensors");
    place.fixed_network("weights/mine.fixed.safetensors");
    place.edof("reconstruct raw.png --weights mine --out fixed.png").done();
    place.edof("reconstruct raw.png --weights mine --float --out float.png").done();
}

#[test]
fn a_drawn_scene_is_captured_and_reconstructed() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    place.edof("scene chart --size 128x96 --out scene").done();
    place
        .edof(
            "capture chart --size 128x96 --camera clear --psi 0 --no-measure --out raw.png --sharp sharp.png",
        )
        .done();
    place.edof("reconstruct raw.png --weights net.safetensors --camera clear --out out.png").done();
    let (sharp, out) =
        (photo::load(&place.path("sharp.png")).unwrap(), photo::load(&place.path("out.png")).unwrap());
    assert_eq!((sharp.size(), out.size()), ((96, 128), (96, 128)));
    let brightness = |frame: &edof_image::ColourFrame| frame.planes.mean().unwrap();
    assert!((brightness(&sharp) - brightness(&out)).abs() < 0.02);
}

#[test]
fn the_demo_leaves_a_report_with_its_pictures() {
    let place = Place::new();
    place.fixed_network("net.safetensors");
    let line = "demo --net net.safetensors --clear-net net.safetensors --height 96 --width 128 --out out --json demo.json";
    let run = place.edof(line).done();
    assert!(run.out.contains("dB"), "{}", run.out);
    let report = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(report.contains("<img") && report.trim_end().ends_with("</html>"));
    let data: serde_json::Value =
        serde_json::from_slice(&std::fs::read(place.path("demo.json")).unwrap()).unwrap();
    assert!(data["pictures"].as_array().is_some_and(|pictures| !pictures.is_empty()), "{data}");
}

const TRAIN: &str = "train --form one-sided,w8,t3,c32,r --camera ring-2018 --images photos --depths 2 --steps 600 \
                     --batch 128 --validate-every 200 --out net.safetensors";

fn with_photos() -> Place {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    place.photo("photos/kodim03.png", 288, 256);
    place
}

#[cfg(unix)]
#[test]
fn a_training_stopped_by_ctrl_c_goes_on_to_the_same_bytes() {
    let whole = with_photos();
    whole.edof(TRAIN).done();

    let broken = with_photos();
    let mut child = broken.command(TRAIN).stderr(Stdio::piped()).spawn().unwrap();
    // It ends by itself: 600 steps, then this fails.
    while !broken.path("net.safetensors.checkpoint").exists() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let interrupt =
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(interrupt.success());
    let last = BufReader::new(child.stderr.take().unwrap()).lines().last().unwrap().unwrap();
    assert_eq!((child.wait().unwrap().code(), last.as_str()), (Some(130), "edof: interrupted"));
    assert_eq!(broken.files(), ["net.safetensors.checkpoint", "photos"]);

    broken.edof(&format!("{TRAIN} --resume")).done();
    assert_eq!(broken.files(), ["net.safetensors", "photos"]);
    let bytes = |place: &Place| std::fs::read(place.path("net.safetensors")).unwrap();
    assert!(bytes(&whole) == bytes(&broken), "the resumed run gave other bytes");
}

#[test]
fn help_has_examples_and_a_closed_pipe_is_no_error() {
    let place = Place::new();
    let run = place.edof("--help").done();
    assert!(run.out.contains("Examples:") && run.out.contains("edof reconstruct raw.png"));
    let mut child = place.command("--help").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn wrong_usage_is_told_from_failure() {
    assert_eq!(Place::new().edof("reconstruct").code, Some(2));
    assert_eq!(Place::new().edof("reconstructt").code, Some(2));
}

#[test]
fn a_study_of_one_depth_adds_rows_to_its_file_and_compares_with_the_paper() {
    let place = Place::new();
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    place.edof("study dictionary --images photos --photos all --atoms 12 --patches 400 --rounds 2 --out d.safetensors").done();
    let study = |more: &str| {
        let line = "study single-depth --rows rows.jsonl --camera clear --nets net.safetensors --images photos --psi 2 --noise none \
                    --stride 8 --dictionary d.safetensors --report r.html --markdown m.md --csv rows.csv --plot p.svg --methods ";
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
    assert!(page.contains("| net.float/s8 less omp/s8 | at least 0 dB |"), "{page}");
    let report = std::fs::read_to_string(place.path("r.html")).unwrap();
    assert!(report.contains("<svg") && !report.contains("src=\"http"));
    assert!(std::fs::read_to_string(place.path("p.svg")).unwrap().starts_with("<svg"));
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
    place.edof(&format!("{line} --rows whole")).done();
    assert_eq!(std::fs::read_to_string(place.path("whole")).unwrap(), whole, "nothing is measured twice");
    // The page names the very command, which makes it again.
    let page = std::fs::read_to_string(place.path("whole.md")).unwrap();
    let command = page.split("Made by `edof ").nth(1).unwrap().split('`').next().unwrap();
    assert!(command.contains("--rows whole") && command.contains("--markdown whole.md"), "{command}");
    place.edof(command).done();
    assert_eq!(std::fs::read_to_string(place.path("whole.md")).unwrap(), page);
    assert!(page.contains("NO net.fixed ROWS"), "{page}");

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
    // What a machine left that stopped is dropped, and told.
    std::fs::write(place.path("torn"), &whole[..whole.len() - 20]).unwrap();
    let run = place.edof(&format!("{line} --rows torn")).done();
    assert!(run.err.contains("torn: dropped the last "), "{}", run.err);
    assert_eq!(timeless(&place.path("torn")), timeless(&place.path("whole")));
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
fn blind_deconvolution_is_tried_on_drawn_blurs() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/p03.png", 64, 48);
    let run = place.edof("study blind --images photos --side 7 --csv rows.csv").done();
    assert!(run.out.contains("Over 3 blurred photographs: "), "{}", run.out);
    let csv = std::fs::read_to_string(place.path("rows.csv")).unwrap();
    assert!(csv.starts_with("image,blur,side,blurred_db,") && csv.lines().count() == 4, "{csv}");
    let line = "study blind --images photos --side 7 --rows";
    place.edof(&format!("{line} 1 --shard 1/2")).done();
    place.edof(&format!("{line} 2 --shard 2/2")).done();
    place.edof(&format!("{line} whole")).done();
    let merged = place.edof("study merge 1 2 --out merged").done();
    assert!(merged.out.contains("Over 3 blurred photographs: "), "{}", merged.out);
    assert_eq!(timeless(&place.path("merged")), timeless(&place.path("whole")));
    place.edof("study blind --images photos --side 4").refused(&["--side 4: must be odd"]);
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
    place
        .edof("study stability --only nothing-of-the-kind")
        .refused(&["--only nothing-of-the-kind: no case"]);
}

#[test]
fn bits_of_each_stage_are_told_and_the_fewest_that_lose_next_to_nothing() {
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
    assert!(std::fs::read_to_string(place.path("b.html")).unwrap().contains("<svg"));
    place.edof("study bits --allowed nan").refused(&["--allowed NaN: must be 0 or more"]);
}

#[test]
fn knobs_and_foldings_are_drawn_with_their_defaults_and_fronts() {
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
