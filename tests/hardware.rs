//! `generate`, `estimate` and `cosim`, by the real binary.

use crate::support::{Place, Run};
use edof_device::design::memory::{self, Set};
use serde_json::Value;
use std::process::Command;

fn design(change: impl Fn(&mut Value)) -> String {
    let mut design: Value = serde_json::from_str(include_str!("../designs/tiny.json")).unwrap();
    change(&mut design);
    design.to_string()
}

#[test]
fn an_estimate_tells_cells_cycles_and_frames() {
    let report: Value =
        serde_json::from_str(&Place::new().edof("estimate --design paper --json").done().out).unwrap();
    assert_eq!((&report["dsp48e1"], &report["ramb36e1"]), (&704.into(), &178.into()));
    assert_eq!(report["cycles_per_patch"], 192.0);
    assert!(report["lut"].as_u64().unwrap() > 30_000 && report["ff"].as_u64().unwrap() > 30_000);
    let frames = report["frames_per_second"].as_f64().unwrap();
    assert!((frames - 125e6 / (192.0 * 240.0 * 135.0)).abs() < 1e-6);
    assert_eq!(report["clock_mhz"], 125.0);
    // Each pixel is kept by the windows' lines and by the picture's, and the display has tables.
    let around = report["around_the_chain"].as_array().unwrap();
    let all = around.iter().chain([&report]).map(|one| one.get("resources").unwrap_or(one));
    for cell in ["dsp48e1", "ramb36e1", "ramb18e1", "lut", "ff"] {
        let sum: u64 = all.clone().map(|used| used[cell].as_u64().unwrap()).sum();
        assert_eq!(report["stream_core"][cell], sum, "{cell}");
    }
    assert_eq!(report["stream_core"]["dsp48e1"], 714);
}

#[test]
fn an_estimate_with_a_network_counts_what_is_not_zero() {
    let line = "estimate --design kc705 --weights edof-t4w12-outer --json";
    let report: Value = serde_json::from_str(&Place::new().edof(line).done().out).unwrap();
    let pairs = report["stages"][1]["pairs_per_patch"].as_f64().unwrap();
    assert!((5.0..150.0).contains(&pairs), "{pairs}");
    let cycles = report["cycles_per_patch"].as_f64().unwrap();
    assert!((97.0..300.0).contains(&cycles), "{cycles}");
}

#[test]
fn an_estimate_of_several_pictures_tells_the_mean_and_the_slowest() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let line = "estimate --design kc705 --weights edof-t4w12-outer --photo photo.png --psi 0,8 --noise 0.01";
    let run = place.edof(&format!("{line} --json all.json")).done();
    let report: Value = serde_json::from_slice(&std::fs::read(place.path("all.json")).unwrap()).unwrap();
    let pictures = report["pictures"].as_array().unwrap();
    assert_eq!(pictures[0]["picture"], "photo.png at psi 0");
    let cycles = |picture: &Value| picture["cycles_per_patch"].as_f64().unwrap();
    let (one, other) = (cycles(&pictures[0]), cycles(&pictures[1]));
    assert_eq!(pictures.len(), 2);
    assert_ne!(one, other);
    assert!((cycles(&report) - (one + other) / 2.0).abs() < 1e-9);
    assert_eq!(cycles(&report["slowest_picture"]), one.max(other));
    assert!(run.out.contains("mean of 2 pictures; the slowest is photo.png at psi"), "{}", run.out);
}

#[test]
fn noise_and_depth_of_pictures_reach_the_hardware() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let values = |options: &str| {
        let line =
            format!("estimate --design kc705 --weights edof-t4w12-outer --photo photo.png {options} --json");
        let report: Value = serde_json::from_str(&place.edof(&line).done().out).unwrap();
        report["stages"][1]["pairs_per_patch"].as_f64().unwrap()
    };
    assert!(values("--noise 0.1") > values("--noise 0"), "noise makes more values that are not zero");
    assert_ne!(values("--noise 0 --psi 0"), values("--noise 0 --psi 8"));
    place.edof("cosim --design tiny --psi 4000 --noise 0").refused(&["psi 4000: must lie within 200"]);
}

#[test]
fn foldings_of_a_network_are_reported_that_nothing_beats() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let line =
        "explore --weights edof-t4w12-outer,edof-t4w12 --photo photo.png --psi 4 --fps 20 --json front.json";
    let run = place.edof(line).done();
    let report: Value = serde_json::from_slice(&std::fs::read(place.path("front.json")).unwrap()).unwrap();
    let front = report["front"].as_array().unwrap();
    assert!(run.out.starts_with("on a photograph; frames per second of 1920x1080 at 215 MHz"), "{}", run.out);
    assert_eq!(run.out.lines().count(), 2 + front.len(), "{}", run.out);
    let figures = |one: &Value| {
        let used = &one["resources"];
        let ramb = used["ramb36e1"].as_f64().unwrap() + used["ramb18e1"].as_f64().unwrap() / 2.0;
        let figure = |value: &Value| value.as_f64().unwrap();
        [-figure(&one["psnr_db"]), figure(&one["cycles_per_patch"]), figure(&used["dsp48e1"]), ramb]
    };
    let points: Vec<[f64; 4]> = front.iter().map(figures).collect();
    let beats = |a: &[f64; 4], b: &[f64; 4]| a != b && a.iter().zip(b).all(|(a, b)| a <= b);
    assert!(!points.is_empty() && points.iter().all(|one| !points.iter().any(|other| beats(other, one))));
    assert!(front.iter().all(|one| one["frames_per_second"].as_f64().unwrap() >= 20.0));
    place.edof("explore --weights edof-t4w12-outer --fps 0").refused(&["--fps 0: must be more than 0"]);
}

#[test]
fn an_explored_folding_is_written_as_a_design_that_its_network_fits() {
    let place = Place::new();
    place.photo("photo.png", 64, 48);
    let line = "explore --weights edof-t4w12-outer --photo photo.png --psi 4";
    let run = place.edof(&format!("{line} --fps 20 --out mine.json --json")).done();
    let report: Value = serde_json::from_str(&run.out).unwrap();
    let design: Value = serde_json::from_slice(&std::fs::read(place.path("mine.json")).unwrap()).unwrap();
    let stages = design["stages"].as_array().unwrap();
    let words: Vec<String> =
        stages.iter().map(|stage| format!("{}x{}", stage["lanes"], stage["rows"])).collect();
    assert_eq!(
        (design["name"].as_str(), report["front"][0]["stages"].as_str()),
        (Some("mine"), Some(&*words.join(" ")))
    );
    place.edof("design check mine.json --weights edof-t4w12-outer").done();
    // The size and the clock of a camera in place of the design's.
    let own = format!("{line} --size 640x480 --clock-mhz 100 --fps 20 --out own.json");
    assert!(place.edof(&own).done().out.contains("frames per second of 640x480 at 100 MHz"));
    let design: Value = serde_json::from_slice(&std::fs::read(place.path("own.json")).unwrap()).unwrap();
    assert_eq!((&design["frame"]["width"], &design["clock_mhz"]), (&640.into(), &100.0.into()));
    place.edof(&format!("{line} --size 7x8")).refused(&["--size 7x8: "]);
    place
        .edof(&line.replace("outer", "outer,edof-t4w12-clear-light") .replace("photo.png", "photo.png --out mixed.json"))
        .refused(&["--out mixed.json: the networks of --weights are for clear-mid, tone srgb; for ring-outer, tone linear"]);
    let fast = format!("{line} --fps 1e6 --out none.json");
    place
        .edof(&fast)
        .refused(&["--out none.json: no folding reaches --fps 1000000, so no design is written"]);
    assert!(!place.path("none.json").exists());
}

#[test]
fn a_design_for_a_rate_has_the_fewest_multipliers_that_reach_it() {
    let place = Place::new();
    let made = |options: &str| {
        let line =
            "design new --form w8,t3,c64 --size 1280x720 --clock-mhz 150 --out made.json --force --json";
        let report: Value =
            serde_json::from_str(&place.edof(&format!("{line} {options}")).done().out).unwrap();
        let promise = &report["promise"];
        let figure = |value: &Value| value.as_f64().unwrap();
        (figure(&promise["frames_per_second"]), figure(&promise["resources"]["dsp48e1"]))
    };
    let ((fastest, most), (enough, few)) = (made(""), made("--fps 30"));
    assert!(fastest > enough && enough >= 30.0 && most > few, "{fastest} {most} {enough} {few}");
    let (slower, _) = made(&format!("--multipliers {}", few - 1.0));
    assert!(slower < 30.0, "{slower} frames per second with fewer multipliers");
    let line = "design new --form w8,t3,c64 --out none.json --multipliers 200";
    place
        .edof(&format!("{line} --fps 1e6"))
        .refused(&["--fps 1000000: the fastest folding with at most 200 multipliers makes"]);
    place.edof(&format!("{line} --fps=-1")).refused(&["--fps -1: must be more than 0"]);
}

#[test]
fn a_generated_design_is_whole_and_the_same_every_time() {
    let place = Place::new();
    place.edof("generate --design paper --weights paper-t4 --out one").done();
    place.edof("generate --design paper --weights paper-t4 --out two").done();
    let same = Command::new("diff").args(["-r", "one", "two"]).current_dir(place.path("")).status().unwrap();
    assert!(same.success());
    let manifest: Value =
        serde_json::from_slice(&std::fs::read(place.path("one/manifest.json")).unwrap()).unwrap();
    let files = manifest["files"].as_array().unwrap();
    assert!(files.iter().all(|file| place.path("one").join(file["path"].as_str().unwrap()).is_file()));
    assert_eq!(files.iter().filter(|f| f["path"].as_str().unwrap().starts_with("mem/")).count(), 190);
    assert_eq!(manifest["weights"]["words"], "linear");
    let page = std::fs::read_to_string(place.path("one/README.md")).unwrap();
    assert!(page.contains("The network of this directory takes linear raw words (`weights.words`"), "{page}");
}

#[test]
fn without_weights_a_design_is_generated_with_a_random_network() {
    let place = Place::new();
    place.edof("random-network --design tiny --out random.fixed.safetensors").done();
    place.edof("generate --design tiny --weights random.fixed.safetensors --out one").done();
    let said = place.edof("generate --design tiny --out two").done();
    assert!(said.err.contains("makes no pictures"), "{}", said.err);
    let same = Command::new("diff").args(["-r", "one", "two"]).current_dir(place.path("")).status().unwrap();
    assert!(same.success());
}

/// That these are the words of `edof board load` is a test of `edof_board::contents`.
#[test]
fn the_words_that_a_host_writes_are_a_file_in_each_format() {
    let place = Place::new();
    place.edof("random-network --design tiny --out drawn.fixed.safetensors").done();
    let read = |options: &str, file: &str| {
        let line = format!("weights drawn.fixed.safetensors --design tiny {options} --words {file}");
        let said = place.edof(&line).done().out;
        (said, std::fs::read(place.path(file)).unwrap())
    };
    let network = edof_network::weight_file::load_fixed(&place.path("drawn.fixed.safetensors")).unwrap();
    let design = edof_device::Design::from_json(include_str!("../designs/tiny.json")).unwrap();
    for (set, options) in [(Set::Second, ""), (Set::First, "--set 0")] {
        let words = memory::writes(&design, &network, set);
        let (said, hex) = read(options, "words.hex");
        assert!(
            said.contains(&format!("words.hex: {} words and their addresses, for set", words.len())),
            "{said}"
        );
        let number = |text: &str| u32::from_str_radix(text, 16).unwrap();
        let pair = |line: &str| line.split_once(' ').map(|(address, word)| (number(address), number(word)));
        let found: Vec<(u32, u32)> =
            String::from_utf8(hex).unwrap().lines().map(|line| pair(line).unwrap()).collect();
        assert_eq!(found, words);
        let (_, bytes) = read(options, "words.bin");
        let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap());
        let found: Vec<(u32, u32)> =
            bytes.chunks(8).map(|pair| (word(&pair[..4]), word(&pair[4..]))).collect();
        assert_eq!(found, words);
    }
    let (_, header) = read("", "words.h");
    place.write(
        "host.c",
        "#include \"words.h\"\nint main(void) { return EDOF_WORDS[EDOF_WORDS_COUNT - 1][0] == 0; }\n",
    );
    let mut compile = Command::new("cc");
    compile.args(["-Wall", "-Werror", "-o", "host", "host.c"]).current_dir(place.path(""));
    assert!(compile.status().unwrap().success(), "{}", String::from_utf8_lossy(&header));
    assert!(Command::new(place.path("host")).status().unwrap().success());
}

#[test]
fn memory_images_are_found_from_any_directory() {
    let place = Place::new();
    place.edof("generate --design paper --weights paper-t4 --out here").done();
    let folder = place.path("here");
    let list = std::fs::read_to_string(folder.join("files.f")).unwrap();
    let files = list.lines().filter(|line| !line.starts_with("//")).map(|line| folder.join(line));
    let define = format!("-DEDOF_DIR=\"{}/\"", folder.display());
    let compiled = place.path("chain.vvp");
    let mut compile = Command::new("iverilog");
    compile.args(["-g2005", "-s", "chain", &define, "-o"]).arg(&compiled).args(files).current_dir("/");
    assert!(compile.status().unwrap().success());
    let run = Command::new("vvp").arg("-n").arg(&compiled).current_dir("/").output().unwrap();
    let said = String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success() && !said.contains("Unable to open"), "{said}");
}

#[test]
fn a_missing_memory_image_is_reported_before_anything_is_built() {
    let place = Place::new();
    place.edof("random-network --design tiny --out drawn.fixed.safetensors").done();
    place.edof("generate --design tiny --weights drawn.fixed.safetensors --out here").done();
    let folder = place.path("here");
    let told = |program: &str, words: &[&str]| {
        let output = Command::new(program).args(words).current_dir(&folder).output().unwrap();
        assert!(!output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    std::fs::remove_file(folder.join("mem/stage1_thresholds.mem")).unwrap();
    for target in ["sim", "synth"] {
        let said = told("make", &[target, "SIM=icarus"]);
        assert!(said.contains("mem/stage1_thresholds.mem: this memory image is missing"), "{said}");
    }
    let said = told("tclsh", &["build.tcl"]);
    assert!(said.starts_with("build.tcl: mem/stage1_thresholds.mem: this memory image is missing"), "{said}");
    assert!(!folder.join("build/icarus").exists());
}

#[test]
fn the_words_of_a_bank_are_counted_not_its_rows() {
    let place = Place::new();
    // 1,152 rows of 4 words each, then 2,048 of 4.
    for (form, size, multipliers, stages) in [
        ("edof-t4w12", "1280x720", 250, "[[12, 4], [32, 2], [32, 2], [32, 2]]"),
        ("two-sided,w8,t2,c256", "64x64", 60, "[[4, 4], [16, 2]]"),
    ] {
        let line =
            format!("design new --form {form} --size {size} --clock-mhz 100 --multipliers {multipliers}");
        place.edof(&format!("{line} --out new.json --force")).done();
        let mut design: Value =
            serde_json::from_slice(&std::fs::read(place.path("new.json")).unwrap()).unwrap();
        let old: Vec<[u64; 2]> = serde_json::from_str(stages).unwrap();
        for (stage, [lanes, rows]) in design["stages"].as_array_mut().unwrap().iter_mut().zip(old) {
            (stage["lanes"], stage["rows"]) = (lanes.into(), rows.into());
        }
        place.write("old.json", design.to_string());
        for line in ["design check old.json", "cosim --design old.json", "estimate --design old.json"] {
            place.edof(line).refused(&[
                "old.json: stages[0].lanes ",
                "two sets of weights in",
                "addresses for 4096",
            ]);
        }
    }
}

#[test]
fn pictures_beyond_the_counters_of_a_circuit_are_rejected() {
    let place = Place::new();
    for (width, height) in [(u64::MAX - 1, 48), (16386, 48), (16384, 16384)] {
        place.write(
            "large.json",
            design(|d| {
                (d["frame"]["width"], d["frame"]["height"]) = (width.into(), height.into());
                d["frame"]["stride"] = 2.into();
            }),
        );
        for line in ["cosim --design large.json --random 1", "estimate --design large.json"] {
            place
                .edof(line)
                .refused(&[&format!("frame {width}x{height}: must be at most 16384 pixels a side")]);
        }
    }
    // Words of memory have 32 pixels; clocks are made of 200 MHz.
    place.write("slow.json", design(|d| d["clock_mhz"] = 1e-300.into()));
    place.edof("cosim --system --design slow.json --size 32x32").refused(&["clock_mhz"]);
    place.edof("cosim --system --design tiny --size 30x22").refused(&["a multiple of 32 pixels"]);
}

/// A design of 1280x720, or so, and of that clock.
fn clocked(clock_mhz: f64, (width, height): (u64, u64)) -> String {
    design(|d| {
        d["clock_mhz"] = clock_mhz.into();
        d["frame"]["width"] = width.into();
        d["frame"]["height"] = height.into();
    })
}

#[test]
fn frames_of_no_video_mode_are_calculated_and_a_board_of_video_rejects_them() {
    let place = Place::new();
    place.edof("random-network --form one-sided,w8,t4,c16,r --out net.fixed.safetensors").done();
    for (width, height) in [(640, 480), (1456, 1088)] {
        place.write("mine.json", clocked(100.0, (width, height)));
        let no_mode = "no video mode: no screen shows these frames";
        assert!(place.edof("design check mine.json").done().out.contains(no_mode));
        assert!(place.edof("estimate --design mine.json").done().out.contains("frames per second"));
        place.edof("generate --design mine.json --weights net.fixed.safetensors --out built").done();
        assert!(std::fs::read_to_string(place.path("built/README.md")).unwrap().contains(no_mode));
        place.edof("board sim --design mine.json --link link").refused(&[&format!(
            "frame {width}x{height}: must be the size of a video mode (1280x720, 1920x1080)"
        )]);
    }
    place.edof("design new --form two-sided,w8,t3,c16 --size 640x480 --out new.json").done();
}

#[test]
fn clocks_that_no_board_makes_are_rejected_by_every_command_that_promises_them() {
    let place = Place::new();
    place.edof("random-network --form one-sided,w8,t4,c16,r --out net.fixed.safetensors").done();
    for (text, words) in [
        (clocked(1000.0, (1280, 720)), "clock_mhz 1000: must be above 0, at most 400"),
        (
            clocked(199.999, (1280, 720)),
            "clock_mhz 199.999: must be a clock that an MMCM makes of 200 MHz, such as 199.6 or 200",
        ),
    ] {
        place.write("bad.json", text);
        for line in [
            "estimate --design bad.json",
            "generate --design bad.json --weights net.fixed.safetensors --out built",
            "board sim --design bad.json --link link",
        ] {
            place.edof(line).refused(&[words]);
        }
    }
    assert!(!place.path("built").exists() && !place.path("link").exists());
}

#[test]
fn clocks_of_a_generated_design_follow_from_it() {
    let place = Place::new();
    place.edof("random-network --form one-sided,w8,t4,c16,r --out net.fixed.safetensors").done();
    place.write("hd.json", clocked(150.0, (1280, 720)));
    place.edof("generate --design hd.json --weights net.fixed.safetensors --out built").done();
    let read = |path: &str| std::fs::read_to_string(place.path("built").join(path)).unwrap();
    let top = read("rtl/kc705_top.v");
    for words in [
        "200 MHz / 10 * 37.125 / 10.000 = 74.25 MHz",
        "200 MHz / 1 * 6.000 / 8.000 = 150 MHz",
        ".CLKOUT0_DIVIDE_F(10.000)",
        ".CLKIN1(core_clock)",
    ] {
        assert!(top.contains(words), "{words}");
    }
    assert!(read("constraints/kc705.xdc").contains("create_clock -name hdmi_rx -period 13.468"));
    assert!(
        read("README.md").contains("| screen | 74.25 |")
            && read("README.md").contains("| calculator | 150 |")
    );
    let files: Vec<String> = ["rtl/kc705_top.v", "constraints/kc705.xdc", "README.md"].map(read).into();
    assert!(files.iter().all(|text| !text.contains("_mhz@") && !text.contains("_period@")));
}

#[test]
fn co_simulation_of_tiny_finds_no_difference_and_reports_it() {
    let place = Place::new();
    let line = "cosim --design tiny --random 60 --stalls 0.2 --icarus --junit cosim.xml --json cosim.json";
    let run = place.edof(line).done();
    assert!(run.out.contains("no difference"), "{}", run.out);
    let report: Value = serde_json::from_slice(&std::fs::read(place.path("cosim.json")).unwrap()).unwrap();
    assert_eq!((&report["design"], &report["patches"]), (&"tiny".into(), &60.into()));
    assert_eq!((&report["boundaries"], &report["differences"]), (&5.into(), &0.into()));
    assert!(report["cycles_per_patch"]["max"].as_f64() >= report["cycles_per_patch"]["mean"].as_f64());
    assert!(report["seconds"].as_f64().unwrap() > 0.0);
    let xml = std::fs::read_to_string(place.path("cosim.xml")).unwrap();
    assert!(xml.contains("tests=\"1\" failures=\"0\""), "{xml}");
}

#[test]
fn co_simulation_finds_a_fault_in_the_files_of_a_folder() {
    let place = Place::new();
    place.edof("random-network --form one-sided,w8,t4,c16,r --out drawn.fixed.safetensors").done();
    place.edof("generate --design tiny --weights drawn.fixed.safetensors --out built").done();
    let line =
        "cosim --design tiny --weights drawn.fixed.safetensors --random 20 --rtl built/rtl --junit cosim.xml";
    place.edof(line).done();

    // Results that do not fit end one too low.
    let file = place.path("built/rtl/requantize.v");
    let text = std::fs::read_to_string(&file).unwrap();
    assert_eq!(text.matches("16'h7fff").count(), 1, "{text}");
    std::fs::write(&file, text.replace("16'h7fff", "16'h7ffe")).unwrap();
    let run = place.edof(&format!("{line} --json cosim.json --waveform fault --force"));

    assert_eq!((run.code, run.out.as_str()), (Some(1), ""), "{}", run.err);
    let told = run.err.lines().last().unwrap();
    // What differs is named in Verilog and in Rust.
    let driver = ["driven at stage.v:", ", from crates/edof-hdl/src/blocks/stage.rs"];
    let words = ["edof: stage I (I to M1), patch ", "expected 32767, got 32766", "waveform fault."];
    let words: Vec<&str> = words.into_iter().chain(driver).collect();
    assert!(words.iter().all(|word| told.contains(word)), "{told}");
    assert!(run.err.contains("; compiling once more for its waveform"), "{}", run.err);
    let xml = std::fs::read_to_string(place.path("cosim.xml")).unwrap();
    assert!(xml.contains("tests=\"1\" failures=\"1\"") && xml.contains("stage I"), "{xml}");
    let json: Value = serde_json::from_slice(&std::fs::read(place.path("cosim.json")).unwrap()).unwrap();
    assert_eq!((&json["differences"], &json["first_difference"]["stage"]), (&1.into(), &"I".into()));
    let waveform = ["fst", "vcd"].map(|ending| place.path(&format!("fault.{ending}")));
    let bytes = waveform.iter().filter_map(|file| std::fs::metadata(file).ok()).map(|file| file.len());
    assert!(bytes.sum::<u64>() > 1_000);
}

#[test]
fn co_simulation_loads_both_banks() {
    let place = Place::new();
    place.edof("random-network --design tiny --out drawn.fixed.safetensors").done();
    place.edof("generate --design tiny --weights drawn.fixed.safetensors --out built").done();
    let line = "cosim --design tiny --weights drawn.fixed.safetensors --random 20 --rtl built --waveform fault --force";
    let out = place.edof(line).done().out;
    assert!(out.contains("tiny: both banks loaded with ") && out.contains(" patches, "), "{out}");

    // The upper half of each bank's rows is not reached by words of the host: set 1 is that of the images for ever.
    let file = place.path("built/rtl/edof_macc_bank.v");
    let text = std::fs::read_to_string(&file).unwrap();
    let (from, to) =
        ("= write_address_i[PART_BITS +: BITS];", "= {1'b0, write_address_i[PART_BITS +: BITS-1]};");
    assert_eq!(text.matches(from).count(), 1, "{text}");
    std::fs::write(&file, text.replace(from, to)).unwrap();
    let run = place.edof(line);
    let told = run.err.lines().last().unwrap();
    assert!(run.code == Some(1) && told.contains("after both banks were loaded: stage I"), "{told}");
    assert!(run.out.contains("20 patches") && !run.out.contains("both banks loaded"), "{}", run.out);
    let waveform = ["fst", "vcd"].map(|ending| place.path(&format!("fault.{ending}")));
    assert!(waveform.iter().any(|file| file.is_file()));
}

#[test]
fn a_folder_of_another_design_or_network_is_no_folder_of_this_one() {
    let place = Place::new();
    let random = "random-network --design tiny";
    place.edof(&format!("{random} --out one.fixed.safetensors")).done();
    place.edof(&format!("{random} --seed 7 --out two.fixed.safetensors")).done();
    place.edof("generate --design tiny --weights one.fixed.safetensors --out built").done();
    let words = std::fs::read_to_string(place.path("built/mem/sensor_words.mem")).unwrap();
    assert_eq!(
        (words.lines().count(), words.lines().nth(2048)),
        (4096, Some("8000")),
        "light of this network is linear"
    );
    let junit = "cosim --design paper --random 5 --rtl built --junit cosim.xml";
    place.edof(junit).refused(&["is of another design"]);
    let xml = std::fs::read_to_string(place.path("cosim.xml")).unwrap();
    assert!(xml.contains("failures=\"1\"") && xml.contains("is of another design"), "{xml}");
    let line = "cosim --design tiny --random 5 --rtl built --weights";
    place
        .edof(&format!("{line} two.fixed.safetensors"))
        .refused(&["--rtl built/mem/", " of the network of --weights"]);
    // A word of a display table, which no window of the calculator needs.
    let table = place.path("built/mem/display_luma.mem");
    let words = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, words.replacen("10\n", "11\n", 1)).unwrap();
    place
        .edof(&format!("{line} one.fixed.safetensors"))
        .refused(&["mem/display_luma.mem, line 1: 11, expected 10"]);
    std::fs::write(&table, words).unwrap();
    place
        .edof("cosim --design paper --random 5 --rtl built")
        .refused(&["--rtl built: is of another design, accumulator_bits is 48, expected 40"]);
    place
        .edof("cosim --system --design tiny --rtl built --size 32x16")
        .refused(&["--size: the Verilog of --rtl built is of its own design; leave --size out"]);
}

#[test]
fn a_folder_without_the_calculator_is_rejected() {
    let place = Place::new();
    std::fs::create_dir(place.path("empty")).unwrap();
    place
        .edof("cosim --design tiny --random 5 --rtl empty")
        .refused(&["--rtl empty: has no chain.v", "or rtl in it"]);
    place.write("empty/chain.v", "module chain (input wire clock_i);\nendmodule\n");
    place.edof("cosim --design tiny --random 5 --rtl empty").refused(&["empty/chain.v: has no port reset_i"]);
    place
        .edof("cosim --system --design tiny --rtl empty --junit cosim.xml")
        .refused(&["--rtl empty: has no edof_core.v"]);
    let xml = std::fs::read_to_string(place.path("cosim.xml")).unwrap();
    assert!(xml.contains("failures=\"1\"") && xml.contains("empty: has no edof_core.v"), "{xml}");
}

/// A run that failed says where in the core.
#[track_caller]
fn is_named(run: &Run, place: &str) {
    assert!(run.code == Some(1) && run.err.contains(place), "{}", run.err);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_whole_core_of_a_folder_is_run_as_it_was_edited() {
    let place = Place::new();
    place.edof("random-network --design tiny --out drawn.fixed.safetensors").done();
    place.edof("generate --design tiny --weights drawn.fixed.safetensors --out built").done();
    let line = "cosim --system --design tiny --weights drawn.fixed.safetensors --rtl built/rtl --frames 1";
    assert!(place.edof(line).done().out.contains("every code as golden"));
    assert!(place.edof(&format!("{line} --display luma")).done().out.contains("every code as golden"));

    // A pixel on its way to the memory of pictures loses a bit.
    let file = place.path("built/rtl/stream_core.v");
    let unedited = std::fs::read_to_string(&file).unwrap();
    let text = unedited.clone();
    let (from, to) = (".pixels_data_o(picture_data_o)", ".pixels_data_o({picture_data_o[15:1], lost})");
    assert_eq!(text.matches(from).count(), 1);
    let text = text.replace(from, to).replace(
        "  display display (",
        "  wire lost;\n  assign picture_data_o[0] = 1'b0;\n  display display (",
    );
    std::fs::write(&file, text).unwrap();
    let differs = "the first words that differ are codes that go into the memory";
    is_named(&place.edof(&format!("{line} --junit cosim.xml")), differs);
    let xml = std::fs::read_to_string(place.path("cosim.xml")).unwrap();
    assert!(xml.contains("failures=\"1\"") && xml.contains(differs), "{xml}");
    std::fs::write(&file, unedited).unwrap();

    // A stage clamps to another word, whose lowest bit is on no screen.
    let file = place.path("built/rtl/requantize.v");
    let text = std::fs::read_to_string(&file).unwrap();
    let (from, to) = ("MAX = 16'h7fff", "MAX = 16'h7ffe");
    assert_eq!(text.matches(from).count(), 1);
    std::fs::write(&file, text.replace(from, to)).unwrap();
    let told = place.edof(line);
    is_named(
        &told,
        "every code as golden, but the core's CRCs are not: the first words that differ are what stage 0 ",
    );
}

/// What is stable on paper is so in the circuit: windows of the suite's hard cases, every word and cycle.
fn hard_cases_through_the_circuit(words: &str, patches: usize, min: u64) {
    let place = Place::new();
    let line =
        format!("cosim --design tiny --cases {words} --patches {patches} --stalls 0.1 --json cosim.json");
    let run = place.edof(&line).done();
    assert!(run.out.contains("no difference"), "{}", run.out);
    let json: Value = serde_json::from_slice(&std::fs::read(place.path("cosim.json")).unwrap()).unwrap();
    assert!(json["patches"].as_u64().unwrap() >= min && json["differences"] == 0, "{json}");
}

#[test]
fn hard_cases_of_each_kind_go_through_the_circuit_bit_for_bit() {
    hard_cases_through_the_circuit(
        "words-extreme,words-signs-of-rows,words-climbing,flat-white,noise-5-photons-read",
        16,
        60,
    );
    let place = Place::new();
    place.edof("cosim --design tiny --cases nothing-like-it").refused(&["--cases nothing-like-it: no case"]);
}

#[test]
#[ignore = "minutes, every frame and every network of words: scripts/soak.sh"]
fn every_hard_case_goes_through_the_circuit_bit_for_bit() {
    hard_cases_through_the_circuit("all", 192, 8000);
}

#[test]
fn stalls_without_end_are_rejected() {
    Place::new().edof("cosim --design tiny --stalls 1").refused(&["--stalls 1", "0 to 0.99"]);
}

#[test]
fn a_co_simulation_of_nothing_is_rejected() {
    for line in ["cosim --design tiny --random 0", "cosim --design tiny --patches 0"] {
        Place::new().edof(line).refused(&["must be 1 or more"]);
    }
}

/// A demo of the design tiny with a random network.
fn demo_of_tiny(place: &Place) -> Command {
    place.edof("random-network --form one-sided,w8,t4,c16,r --out drawn.fixed.safetensors").done();
    place.command(
        "demo --design tiny --net drawn.fixed.safetensors --clear-net drawn.fixed.safetensors --height 96 --width 128 --json demo.json",
    )
}

fn board_of_the_demo(place: &Place) -> (Value, String) {
    let data: Value = serde_json::from_slice(&std::fs::read(place.path("demo.json")).unwrap()).unwrap();
    (data["board"].clone(), std::fs::read_to_string(place.path("out/report.html")).unwrap())
}

#[test]
fn a_demo_without_a_simulator_generates_its_board_and_shows_what_the_model_shows() {
    let place = Place::new();
    let run = demo_of_tiny(&place).env("PATH", "").output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let (board, report) = board_of_the_demo(&place);
    let told = board["not_simulated"].as_str().unwrap();
    assert!(told.contains("verilator is not installed") && report.contains(told), "{told}");
    assert!(board["modelled"] == true && report.contains("What the Rust model of tiny shows"), "{board}");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(!said.contains("compiling"), "nothing is compiled: {said}");
    assert!(
        place.path("out/board/rtl/kc705_top.v").is_file() && place.path("out/board/manifest.json").is_file()
    );
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn the_demo_and_the_system_show_what_the_board_would() {
    let place = Place::new();
    let run = demo_of_tiny(&place).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let (board, report) = board_of_the_demo(&place);
    assert_eq!((&board["design"], &board["differences"]), (&"tiny".into(), &0.into()));
    assert!(report.contains("every code as golden"));
    // The core of the demo's crop, which is compiled by now, once more in Icarus.
    let line = "cosim --system --design tiny --weights drawn.fixed.safetensors --size 64x64 --frames 1 --icarus --display luma";
    assert!(place.edof(line).done().out.contains("Icarus: PASS: 3 pictures"));
}
