//! What somebody meets who follows the documents with files of his own: one tone from the photograph to the picture, sides that are odd,
//! photographs without numbers, arrays of other programs.

use crate::support::Place;
use serde_json::Value;

fn json(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(place.path(name)).unwrap()).unwrap()
}

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

const TRAIN: &str = "train --form one-sided,w8,t2,c16,r --camera clear --images photos --photos all --depths 2 --psi 0:2 --steps 200 --batch 128 \
                     --validate-every 100 --threads 2";

#[test]
fn a_photograph_is_taken_and_learned_from_under_one_tone() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    let capture = "capture photos/a.png --camera clear --psi 1 --out raw.png --sharp sharp.png";
    place.edof(capture).done();
    assert_eq!(json(&place, "raw.png.json")["tone"], "srgb");
    place.edof(&format!("{TRAIN} --out net.safetensors --json net.json")).done();
    place.edof("weights net.safetensors --json about.json").done();
    let about = std::fs::read_to_string(place.path("about.json")).unwrap();
    assert!(about.contains("\"tone\": \"srgb\"") && !about.contains("\"tone\": \"linear\""), "{about}");
    // The path to its end: nothing is printed about tones, and the picture is about as good as validation stated (4:2:2 costs these colours more).
    place.edof("quantize net.safetensors --images photos --photos all --out net.fixed.safetensors").done();
    let run = place.edof("reconstruct raw.png --weights net.fixed.safetensors --out picture.png").done();
    assert!(!run.err.contains("tone"), "{}", run.err);
    place.edof("reconstruct raw.png --weights net.safetensors --float --out picture.png").done();
    place.edof("compare sharp.png picture.png --json compared.json").done();
    let (stated, found) = (json(&place, "net.json"), json(&place, "compared.json"));
    let [stated, found] = [&stated["validation_db"], &found["psnr_db"]].map(|db| db.as_f64().unwrap());
    assert!(found > stated - 2.0, "validation stated {stated:.2} dB, the picture has {found:.2}");
    // The other tone is reported with its loss, in both directions.
    place.edof(&format!("{capture} --tone linear")).done();
    let run = place.edof("reconstruct raw.png --weights net.fixed.safetensors --out picture.png").done();
    for message in [
        "trained on pictures of tone srgb, raw.png is of linear",
        "expect about 3 dB less",
        "edof train --tone linear",
    ] {
        assert!(run.err.contains(message), "{}", run.err);
    }
    // Training from a network keeps its tone.
    place.edof(&format!("{TRAIN} --tone linear --out other.safetensors")).done();
    let on = TRAIN
        .replace("--form one-sided,w8,t2,c16,r", "--from other.safetensors")
        .replace("--steps 200", "--steps 100");
    place.edof(&format!("{on} --out third.safetensors")).done();
    let about = place.edof("weights third.safetensors --json").done().out;
    assert!(about.contains("\"tone\": \"linear\"") && !about.contains("\"tone\": \"srgb\""), "{about}");
    // Light is no start for encoded values.
    let run = place.edof(&format!("{on} --tone srgb --out fourth.safetensors"));
    run.refused(&["--from", "other takes linear values", "--tone srgb", "srgb values"]);
}

#[test]
fn a_network_for_light_is_named_where_one_for_codes_was_taken() {
    let place = Place::new();
    place.edof("capture chart --size 96x64 --camera ring-outer --psi 4 --out raw.png").done();
    let run = place.edof("reconstruct raw.png --weights edof-t4w12-outer --out picture.png").done();
    for message in [
        "--weights edof-t4w12-outer: trained on pictures of tone linear, raw.png is of srgb",
        "expect about 2 dB less",
        "docs/decisions/0041-one-tone.md",
        "use --weights edof-t4w12-outer-light",
    ] {
        assert!(run.err.contains(message), "{}", run.err);
    }
    let run = place.edof("reconstruct raw.png --out picture.png").done();
    assert!(!run.err.contains("tone"), "{}", run.err);
}

#[test]
fn the_network_is_that_of_the_lens_that_took_the_frame_and_of_a_clear_one_where_none_is_known() {
    let place = Place::new();
    for (camera, network) in [
        ("ring-outer", "edof-t4w12-outer-light"),
        ("clear-mid", "edof-t4w12-clear-light"),
        ("ring-2018", "edof-t4w12-light"),
    ] {
        place
            .edof(&format!("capture chart --size 96x64 --camera {camera} --psi 4 --out {camera}.png"))
            .done();
        let run = place.edof(&format!("reconstruct {camera}.png --out picture-{camera}.png")).done();
        // Of its classes of noise, any.
        assert!(run.out.contains(&format!("by {network}")), "{}", run.out);
    }
    // A lens of one's own without a mask has the blur of the other one, larger or smaller; focused elsewhere it has more than that.
    let own = include_str!("../cameras/clear-mid.json").replace("clear-mid", "mine").replace("16.0", "12.0");
    place.write("mine.json", &own);
    place.write("far.json", own.replace("\"focus_psi\": 4.0", "\"focus_psi\": 0.0"));
    for camera in ["mine", "far"] {
        place
            .edof(&format!("capture chart --size 96x64 --camera {camera}.json --psi 4 --out {camera}.png"))
            .done();
    }
    let run = place.edof("reconstruct mine.png --out picture-mine.png").done();
    assert!(
        run.err.contains(
            "was trained for another lens without a mask, clear-mid; the blur of mine is 0.8 times as large"
        ),
        "{}",
        run.err
    );
    place
        .edof("reconstruct far.png --out picture-far.png")
        .refused(&["trained for the camera clear-mid", "focus_psi"]);
    std::fs::remove_file(place.path("ring-outer.png.json")).unwrap();
    for (tone, network) in [("srgb", "edof-t4w12-clear-light"), ("linear", "edof-t4w12-clear")] {
        let line = format!("reconstruct ring-outer.png --bit-depth 12 --tone {tone} --out {tone}.png");
        let run = place.edof(&line).done();
        assert!(run.out.contains(&format!("by {network}.fixed")), "{}", run.out);
    }
}

#[test]
fn the_largest_difference_lies_inside_of_the_border() {
    let place = Place::new();
    place.photo("a.png", 64, 48);
    let mut picture = edof_io::photo::load(&place.path("a.png")).unwrap();
    // A large one in the border, a smaller one inside.
    for (at, by) in [((0, 0, 0), 0.5), ((0, 10, 20), 0.1)] {
        let value = &mut picture.planes[at];
        *value += if *value < 0.5 { by } else { -by };
    }
    edof_io::photo::save(&place.path("b.png"), &picture, 8).unwrap();
    place.edof("compare a.png b.png --json found.json").done();
    let largest = json(&place, "found.json")["largest"].clone();
    assert_eq!((&largest["row"], &largest["column"]), (&10.into(), &20.into()), "{largest}");
    place.edof("compare a.png b.png --border 0 --json found.json").done();
    assert_eq!(json(&place, "found.json")["largest"]["row"], 0);
}

#[test]
fn a_capture_states_its_light_and_a_depth_outside_of_the_cameras_range() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let line = "capture photo.png --camera clear-mid --noise sensor:full-well=6000:gain=2 --out raw.png";
    let run = place.edof(&format!("{line} --psi 9")).done();
    assert!(run.out.contains("white has 3000 electrons; that is --gain 3.333 of edof train"), "{}", run.out);
    assert!(run.err.contains("psi 9.00: is outside of clear-mid's range, 0.00 to 8.00"), "{}", run.err);
    assert!(!place.edof(&format!("{line} --psi 8")).done().err.contains("is outside"));
    // Without --psi, the figures are of the whole range of a camera.
    let wide = include_str!("../cameras/clear-mid.json").replace("8.0", "12.0");
    place.write("wide.json", wide);
    let figures = json_of(&place.edof("optics wide.json --out figures --json").done().out);
    let last = figures["depths"].as_array().unwrap().last().unwrap();
    assert_eq!((figures["depths"].as_array().unwrap().len(), &last["psi"]), (9, &12.0.into()));
}

#[test]
fn an_odd_photograph_is_compared_with_the_picture_of_its_whole_cells() {
    let place = Place::new();
    place.photo("odd.png", 65, 49);
    place.edof("capture odd.png --psi 0 --out raw.png --sharp sharp.png").done();
    for line in ["odd.png sharp.png", "sharp.png odd.png"] {
        let run = place.edof(&format!("compare {line}")).done();
        assert!(run.err.contains("odd.png: 65x49 cropped to 64x48, as the other"), "{}", run.err);
        assert!(run.out.contains("64x48"), "{}", run.out);
    }
    place.photo("other.png", 80, 48);
    place
        .edof("compare odd.png other.png")
        .refused(&["odd.png, other.png: frames of 65x49 and 80x48 pixels"]);
}

#[test]
fn a_study_of_photographs_without_numbers_takes_all_and_says_so() {
    let place = Place::new();
    place.float_network("net.safetensors");
    std::fs::create_dir(place.path("photos")).unwrap();
    for name in ["beach", "forest"] {
        place.photo(&format!("photos/{name}.png"), 64, 48);
    }
    let study =
        "study kodak --nets net.safetensors --images photos --psi 0 --noise none --json s.json --force";
    let run = place.edof(study).done();
    let message = [run.out.as_str(), run.err.as_str()].concat();
    assert!(
        message.contains("photos: no file has a number") && message.contains("--photos all"),
        "{message}"
    );
    let rows = json(&place, "s.json").to_string();
    assert!(rows.contains("beach") && rows.contains("forest"), "{rows}");
    // One number is a choice.
    place.photo("photos/p04.png", 64, 48);
    place.edof(study).refused(&["photos: contains no readable photograph of 'test'"]);
}

/// NumPy's own files: stored, compressed, of halves, and one array a file.
#[test]
#[ignore = "needs NumPy: scripts/test-oracle.sh"]
fn a_bank_of_any_of_numpys_kinds_gives_the_same_frame() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let script = "import numpy as np\n\
                  psi = np.arange(3.0); y, x = np.mgrid[-2:3, -2:3]\n\
                  psf = np.array([[np.exp2(-abs(x) - abs(y) - p) for c in range(3)] for p in psi])\n\
                  np.savez('stored.npz', psi=psi, psf=psf)\n\
                  np.savez_compressed('compressed.npz', psi=psi, psf=psf)\n\
                  np.savez_compressed('halves.npz', psi=psi.astype('f2'), psf=psf.astype('f2'))\n\
                  np.save('lens-psf.npy', psf.astype('>f4')); np.save('lens-psi.npy', psi)\n";
    let python = std::env::var_os("EDOF_PYTHON").expect("EDOF_PYTHON must name a Python that has NumPy");
    let run = std::process::Command::new(python).args(["-c", script]).current_dir(place.path("")).status();
    assert!(run.unwrap().success(), "no NumPy");
    let frame = |bank: &str| {
        place.edof(&format!("capture photo.png --psi 1 --psf-bank {bank} --out {bank}.png")).done();
        std::fs::read(place.path(&format!("{bank}.png"))).unwrap()
    };
    let stored = frame("stored.npz");
    for bank in ["compressed.npz", "halves.npz", "lens-psf.npy"] {
        assert!(frame(bank) == stored, "{bank}");
    }
}

#[test]
fn a_byte_order_mark_before_json_is_passed_over() {
    let place = Place::new();
    let marked = |text: &str| format!("\u{feff}{text}");
    place.write("camera.json", marked(include_str!("../cameras/clear.json")));
    place.write("design.json", marked(include_str!("../designs/tiny.json")));
    place.photo("photo.png", 64, 48);
    place.write("scene.json", marked(r#"{"layers": [{"picture": "photo.png", "depth": 1}]}"#));
    place.edof("capture scene.json --camera camera.json --out raw.png").done();
    place.edof("estimate --design design.json").done();
    let record = std::fs::read_to_string(place.path("raw.png.json")).unwrap();
    place.write("raw.png.json", marked(&record));
    place
        .edof("reconstruct raw.png --camera camera.json --weights edof-t4w12-clear --force --out o.png")
        .done();
}

#[test]
fn a_design_of_ones_own_is_made_checked_and_taken_by_every_command() {
    let place = Place::new();
    let made = place
        .edof("design new --form two-sided,w8,t3,c64 --size 64x48 --clock-mhz 150 --multipliers 200 --out mine.json --json made.json")
        .done();
    assert!(
        made.out.contains("calculator, nothing skipped") && made.out.contains("memory: "),
        "{}",
        made.out
    );
    let (design, promise) = (json(&place, "mine.json"), &json(&place, "made.json")["promise"]);
    assert_eq!((&design["clock_mhz"], &design["name"]), (&Value::from(150.0), &Value::from("mine")));
    assert!(promise["resources"]["dsp48e1"].as_u64().unwrap() <= 200, "{promise}");
    let printed = place.edof("design check mine.json").done().out;
    assert_eq!(printed, made.out);
    place.edof("random-network --design mine.json --out random.fixed.safetensors").done();
    assert!(
        place
            .edof("design check mine.json --weights random.fixed.safetensors")
            .done()
            .out
            .contains("fits it")
    );
    place.edof("estimate --design mine.json").done();
    // The README of a generated directory states the same.
    place.edof("generate --design mine.json --weights random.fixed.safetensors --out board").done();
    let page = std::fs::read_to_string(place.path("board/README.md")).unwrap();
    let cycles = promise["cycles_per_patch"].as_f64().unwrap();
    assert!(
        page.contains("## What this design promises")
            && page.contains(&format!("{cycles:.1} cycles per patch")),
        "{page}"
    );
    place
        .edof("design check mine.json --weights paper-t4")
        .refused(&["paper-t4 does not fit design mine", "edof random-network"]);
}

#[test]
fn a_design_for_another_board_is_estimated_and_what_the_board_lacks_is_named() {
    let place = Place::new();
    let line = "design new --board ulx3s --form w8,t3,c32 --size 128x80 --clock-mhz 100 --out open.json";
    let promise = &json_of(&place.edof(&format!("{line} --json")).done().out)["promise"];
    assert!(promise["resources"]["mult18x18d"].as_u64().unwrap() <= 156, "{promise}");
    assert!(promise["resources"]["dp16kd"].as_u64().unwrap() <= 208, "{promise}");
    assert_eq!(json(&place, "open.json")["board"], "ulx3s");
    let check = place.edof("design check open.json").done().out;
    assert!(check.contains(" MULT18X18D, ") && check.contains("of an LFE5U-85F"), "{check}");
    let screen = "60 frames per second at a pixel clock of 25.00 MHz, in the middle of a screen of 640x480; 31 from a camera";
    assert!(check.contains(screen), "{check}");
    let estimate = place.edof("estimate --design open.json").done().out;
    assert!(
        estimate.contains("DP16KD") && estimate.contains("board ulx3s takes no video by cable"),
        "{estimate}"
    );
    place.edof(line).refused(&["open.json: is there already", "--force"]);
    // Of this network two sets of weights and the lines of such frames do not fit; one set does.
    let large = "design new --board ulx3s --weights paper-t4 --size 640x480 --clock-mhz 50 --out large.json";
    let made = place.edof(&format!("{large} --json")).done();
    assert!(made.err.contains("two sets of weights do not fit"), "{}", made.err);
    assert_eq!(json(&place, "large.json")["sets"], 1);
    let used = &json_of(&made.out)["promise"]["stream_core"]["dp16kd"];
    assert!(used.as_u64().unwrap() <= 208, "{used}");
    place.edof("design new --form w8,t3,c32 --size 640x480 --out camera.json").done();
    let estimate = place.edof("estimate --design camera.json").done().out;
    assert!(estimate.contains("640x480 is no video mode of board kc705"), "{estimate}");
    place.edof("random-network --design open.json --out random.fixed.safetensors").done();
    // The line's speed is that of the design's board.
    let load = place.edof("board load random.fixed.safetensors --dry-run --design open.json").done().out;
    assert!(load.contains(" s at 2000000 bits per second"), "{load}");
    let network = "--design open.json --weights random.fixed.safetensors";
    for (line, message) in [
        (
            line.replace("128x80", "2048x1040").replace("open.json", "none.json"),
            "--size 2048x1040: must be at most 2097152 pixels, which a buffer holds",
        ),
        (format!("generate {network} --out out --shell litex"), "board ulx3s has no shell 'litex'"),
        ("board sim --design open.json".to_owned(), "board ulx3s takes no video by cable; add --rtl"),
        (
            "board sim --rtl --design open.json --picture p.png".to_owned(),
            "--picture: board ulx3s takes no video by cable",
        ),
        (
            "explore --design open.json --weights random.fixed.safetensors --device xc7k325t".to_owned(),
            "--device xc7k325t: design open is for board ulx3s, which has an lfe5u-85f",
        ),
        (
            format!("{line}2 --clock-mhz 99.999").replace("--clock-mhz 100 ", ""),
            "--clock-mhz 99.999: must be a clock that an EHXPLLL makes of 25 MHz",
        ),
    ] {
        place.edof(&line).refused(&[message]);
    }
    place
        .write("other.json", include_str!("../designs/tiny.json").replacen('{', "{ \"board\": \"none\",", 1));
    place.edof("estimate --design other.json").refused(&["board 'none' is unknown, expected kc705 or ulx3s"]);
}

/// The example of docs/design.md is none of ours, and is a design.
#[test]
fn the_example_of_the_page_on_designs_is_one() {
    let page = include_str!("../docs/design.md");
    let text = page.split_once("```json\n").unwrap().1.split_once("```").unwrap().0;
    let place = Place::new();
    place.write("mine.json", text);
    let printed = place.edof("design check mine.json").done().out;
    assert!(printed.contains("60 frames per second at a pixel clock of 74.25 MHz"), "{printed}");
    let design: Value = serde_json::from_str(text).unwrap();
    // Every field of a design stands in the table.
    for (field, of) in [("", &design), ("form.", &design["form"]), ("stages[].", &design["stages"][0])] {
        for name in of.as_object().unwrap().keys().filter(|name| !["form", "frame"].contains(&name.as_str()))
        {
            assert!(page.contains(&format!("| `{field}{name}`")), "{field}{name}");
        }
    }
}

#[test]
fn photographs_are_blurred_once_for_trainings_on_the_same_ones() {
    let place = Place::new();
    std::fs::create_dir(place.path("photos")).unwrap();
    place.photo("photos/a.png", 288, 256);
    let cache = place.path("cache");
    let train = |options: &str, out: &str| {
        let (psi, options) =
            options.split_once(' ').filter(|_| options.starts_with("0")).unwrap_or(("0:2", options));
        let line = format!("{TRAIN} {options} --out {out} --name net").replace("--steps 200", "--steps 100");
        let line = line.replace("--psi 0:2", &format!("--psi {psi}"));
        let output = place.command(&line).env("XDG_CACHE_HOME", &cache).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{message}");
        (message.contains("blurred photographs: as kept"), std::fs::read(place.path(out)).unwrap())
    };
    let kept = || std::fs::read_dir(cache.join("edof/blurs")).map_or(0, Iterator::count);
    let (first, fresh) = train("--no-cache", "fresh.safetensors");
    assert!(!first && kept() == 0);
    let (second, made) = train("", "made.safetensors");
    assert!(!second && kept() == 1);
    let (third, taken) = train("", "taken.safetensors");
    assert!(third && fresh == made && made == taken, "the same bytes, wherever the blurs come from");
    // Another seed learns from the same blurs, another range from others.
    assert!(train("--seed 9", "seed.safetensors").0);
    assert!(!train("0:1 ", "range.safetensors").0);
    // What is damaged is made again.
    for entry in std::fs::read_dir(cache.join("edof/blurs")).unwrap() {
        let path = entry.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    }
    assert_eq!(train("", "again.safetensors"), (false, fresh));
    for low in [0.1, 0.2, 0.3, 0.4] {
        train(&format!("{low}:1 "), &format!("{low}.safetensors"));
    }
    assert_eq!(kept(), 3, "the last used ones");
}
