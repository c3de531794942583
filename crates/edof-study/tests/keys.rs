//! Rows that were written before are still recognised as theirs: a row of each study, from files that `edof study` wrote (tests/rows), has the key
//! that the same settings have now; and the text that each key is a hash of stands here in full.

use edof_core::camera::Camera;
use edof_core::storage::digest::sha256;
use edof_core::{ColourFrame, Noise, Stride, Tone, Window};
use edof_deblur::blind;
use edof_io::photos::Photo;
use edof_network::network::Condition;
use edof_network::weight_file;
use edof_optics::Statistics;
use edof_optics::psf::Settings;
use edof_study::aperture::networks::{Peer, Photographing};
use edof_study::aperture::{self, Comparing, networks};
use edof_study::experiment::Experiment;
use edof_study::journal::{Journal, Key, Line, Mixing, Proof};
use edof_study::knobs::{self, Turning};
use edof_study::known_blurs::DrawnBlurs;
use edof_study::kodak::{self, Conditions, Kodak};
use edof_study::lens_networks;
use edof_study::methods::dictionary::Dictionary;
use edof_study::methods::method::Format;
use edof_study::methods::nets::Net;
use edof_study::methods::nets_by_noise;
use edof_study::methods::spec::MethodSpec;
use edof_study::multi_depth::{self, Drawn, Lens, Scenes};
use edof_study::setup::Setup;
use edof_study::single_depth::{self, SingleDepth};
use edof_study::tolerances::{self, Kind, Tolerating};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

/// A photograph by its name alone: of its values the key holds another hash, which is left out here.
fn photos(name: &str) -> [Photo; 1] {
    [Photo { name: name.into(), frame: ColourFrame::zeros(48, 48) }]
}

fn camera(name: &str) -> Camera {
    Camera::resolve(name).unwrap()
}

/// A network that ships, in every format.
fn net(name: &str) -> Net {
    let load = |ending: &str| {
        let file = path(&format!("../../weights/{name}{ending}"));
        let hash = weight_file::parse_hash(std::fs::read(&file).unwrap(), &file).unwrap();
        (file, hash)
    };
    let ((float, float_hash), (fixed, fixed_hash)) = (load(".safetensors"), load(".fixed.safetensors"));
    let words = (weight_file::load_fixed(&fixed).unwrap(), fixed_hash);
    Net::new(name, weight_file::load_network(&float).unwrap(), &float_hash, Some(words), Stride::PATCH).0
}

/// Holds every row of a file against the key of the same cell now: all but the photograph's values, and the camera where it is another one.
/// Returns the hashes of settings in the file.
fn recognised<E: Experiment>(experiment: &E, is_same_camera: bool) -> Vec<String> {
    let file = path(&format!("tests/rows/{}.jsonl", E::Row::STUDY));
    let text = std::fs::read_to_string(&file).unwrap();
    let rows = Journal::<E::Row>::merged(Path::new("nowhere"), &[file], Mixing::default()).unwrap().rows();
    let cells = experiment.cells();
    assert!(!rows.is_empty(), "{}: no rows", E::Row::STUDY);
    for (row, line) in rows.iter().zip(text.lines().skip(1)) {
        // Fields have the names that they had; the version of the key is new.
        let mut written = serde_json::to_value(row).unwrap();
        assert_eq!(written.as_object_mut().unwrap().remove("key_version"), Some(1.into()));
        let mut line: serde_json::Value = serde_json::from_str(line).unwrap();
        line.as_object_mut().unwrap().remove("key_version");
        assert_eq!(written, line, "{}", E::Row::STUDY);
    }
    let settings = |row: &E::Row| {
        let Key { subject, proof: old } = row.key();
        let new = cells.iter().find(|(key, _)| key.subject == subject);
        let new = &new.unwrap_or_else(|| panic!("{}: no cell is {subject:?}", E::Row::STUDY)).0.proof;
        let same = |old: &Proof| Proof { photo: old.photo.clone(), ..new.clone() };
        match is_same_camera {
            true => assert_eq!(old, same(&old), "{}: {subject:?}", E::Row::STUDY),
            false => assert_eq!((&old.settings, old.version), (&new.settings, new.version), "{subject:?}"),
        }
        old.settings.unwrap()
    };
    rows.iter().map(settings).collect()
}

const OPTICS: &str = "Settings { energy: 0.999, wavelength_tolerance: 0.01, exact: false }";
const APPROXIMATION: &str = "Approximation { psf: Settings { energy: 0.999, wavelength_tolerance: 0.01, exact: false }, depth_tolerance: 0.0 }";

fn sensor(noise: &str, seed: u64) -> String {
    format!("Sensor {{ depth: 16, phase: Rggb, noise: {noise}, seed: {seed}, black_level: 0 }}")
}

/// Checks that one of the hashes is that of a text, its parts on lines of their own.
fn is_of(hashes: &[String], parts: &[&str]) {
    let text = parts.join("\n");
    assert!(hashes.contains(&sha256(text.as_bytes())), "no key is of:\n{text}");
}

#[test]
fn rows_of_photographs() {
    let methods = [vec![MethodSpec::Malvar], net("edof-t4w12-outer").entry(Stride::PATCH).methods].concat();
    let conditions = Conditions {
        tone: Tone::Linear,
        psi: vec![6.0],
        noise: vec![Noise::gaussian(0.01)],
        optics: Settings::default(),
    };
    let plan = kodak::Plan {
        setups: vec![Setup { camera: camera("ring-outer"), further_foci: vec![], methods }],
        conditions,
    };
    let hashes = recognised(&Kodak::new(&plan, &photos("kodim03")), true);
    let sensor = sensor("Gaussian { sigma: 0.01 }", 4_341_630_239_353_149_263);
    let float = "\"FloatSettings { stride: Stride(8), overlap: Hann, output: Rgb, budget: None }\"";
    is_of(&hashes, &["\"\"", OPTICS, &sensor, "8"]);
    is_of(&hashes, &[float, OPTICS, &sensor, "8"]);
}

#[test]
fn rows_of_speed_against_error() {
    let dictionary = Arc::new(Dictionary::load(None).unwrap());
    let named = |name: &&str| MethodSpec::named(name, &[Stride::PATCH], &dictionary).unwrap();
    let mut methods: Vec<MethodSpec> = MethodSpec::names().iter().flat_map(named).collect();
    methods.extend(net("paper-t4").entry(Stride::PATCH).methods);
    let plan = single_depth::Plan {
        camera: camera("ring-2018"),
        tone: Tone::Linear,
        psi: vec![8.0],
        noise: vec![Noise::None],
        methods,
        optics: Settings::default(),
    };
    let hashes = recognised(&SingleDepth::new(&plan, &photos("kodim03")), true);
    let sensor = sensor("None", 8_677_991_091_651_398_730);
    for method in [
        "Wiener { model: PictureModel { contrast: 0.0036, unexplained: 2e-5, middle_light: 0.25 }, noise: None }",
        "RichardsonLucy { steps: 15 }",
        "HyperLaplacian { model: PictureModel { contrast: 0.0036, unexplained: 2e-5, middle_light: 0.25 }, share: 0.1, alpha: 0.8 }",
        "Blind(Settings { side: 15, sparsity: 0.8, kernel_weight: 4e-5, turns: 21, outer: 2, inner: 2, step: 0.3, turn_floor: 0.03, \
         floor: 0.05, min_part: 0.2, prior: Prior { lambda: 3000.0, alpha: 0.8 } })",
        "PursuitSettings { pursuit: Omp { atoms: 16 }, depths: Of([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]), window: Window(8), \
         stride: Stride(8) }",
        "PursuitSettings { pursuit: Fista { steps: 100, penalty: 0.004, tolerance: 0.0001 }, \
         depths: Of([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]), window: Window(8), stride: Stride(8) }",
        "UntrainedSettings { layers: 4, dc_removed: false, penalty: 0.004, depths: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0], \
         window: Window(8), float: FloatSettings { stride: Stride(8), overlap: Hann, output: Rgb, budget: None } }",
    ] {
        is_of(&hashes, &[&format!("\"{method}\""), OPTICS, &sensor, "8"]);
    }
}

#[test]
fn rows_of_knobs() {
    let network = weight_file::load_network(&path("../../weights/paper-t4.safetensors")).unwrap();
    let knobs = ["kernel-energy", "wavelengths", "depths", "noise-class"];
    let plan = knobs::Plan {
        camera: camera("ring-2018"),
        psi: 8.0,
        noise: Noise::gaussian(0.01),
        network: Arc::new(network),
        network_sha256: String::new(),
        fixed: vec![],
        dictionary: Arc::new(Dictionary::load(None).unwrap()),
        knobs: knobs.map(|knob| knob.parse().unwrap()).to_vec(),
    };
    let hashes = recognised(&Turning::new(&plan, &photos("kodim01")), true);
    let shortened = "\"Shortened { camera: Camera { name: \\\"ring-2018\\\", focal_length_mm: 16.0, aperture_radius_mm: 2.3, \
        pixel_pitch_um: 3.0, spectra: [Line(610.0), Line(535.0), Line(460.0)], reference_wavelength_nm: 460.0, defocus_sign: Minus, \
        focus_psi: 0.0, nominal_m: None, psi_range: [0.0, 8.0], rings: [Ring { inner: 0.68, outer: 1.0, delay: Phase { rad: 9.079203, \
        at_nm: 455.0 } }], profile: None, height_map: None, aberrations: [], psf_bank: None, source: \\\"Mask as recalled from Elmalem, \
        Giryes, Marom 2018 (2.89 pi at 455 nm); unverified. Lens, sensor and focus are ours. The camera of every comparison with the \
        paper.\\\" }, cut: Approximation { psf: Settings { energy: 0.9, wavelength_tolerance: 0.0, exact: false }, depth_tolerance: 0.0 \
        }, reference: Approximation { psf: Settings { energy: 1.0, wavelength_tolerance: 0.0, exact: false }, depth_tolerance: 0.0 }, \
        layers: None }\"";
    is_of(&hashes, &[shortened, APPROXIMATION, &sensor("None", 7_429_660_564_891_291_380), "8"]);
    let wiener = "\"Wiener { model: PictureModel { contrast: 0.0036, unexplained: 2e-5, middle_light: 0.25 }, \
        noise: Some(Gaussian { sigma: 0.02 }) }\"";
    is_of(
        &hashes,
        &[wiener, APPROXIMATION, &sensor("Gaussian { sigma: 0.01 }", 11_637_846_464_940_506_533), "8"],
    );
}

/// The text holds every value of a kernel.
#[test]
fn rows_of_blind_deconvolution() {
    let settings = blind::Settings { side: 15, ..blind::Settings::default() };
    recognised(&DrawnBlurs::new(&photos("kodim03"), settings), true);
}

fn estimator() -> aperture::Plan {
    aperture::Plan {
        coded: camera("ring-outer"),
        ranges: vec![4.0],
        stops: vec![0.0, 0.5, 1.0, 1.5, 2.0, 3.0],
        electrons: vec![100.0, 300.0, 1000.0, 3000.0, 10_000.0],
        read_noise_e: 2.5,
        mean_light: 0.4,
        window: Window::new(12).unwrap(),
        statistics: Statistics::natural(),
    }
}

const ESTIMATOR: &str = "(2.5, 0.4, 12, 9, 13)";

#[test]
fn rows_of_smaller_apertures() {
    is_of(&recognised(&Comparing::new(&estimator()), true), &[ESTIMATOR]);
}

/// The networks of the rows are not here: others that were trained for the same noise stand for them.
#[test]
fn rows_of_smaller_apertures_with_networks() {
    let camera = Camera { psi_range: [0.0, 4.0], ..camera("ring-outer") };
    let net = |name: &str, least_noise: Noise, gain: f64| {
        let mut float = edof_device::random::silent(camera.clone());
        let noise = Noise::sensor(gain);
        float.origin.conditions = vec![Condition { tone: Tone::Srgb, noise, least_noise }];
        Net::new(name, float, name, None, Stride::PATCH).0
    };
    let peer = Peer::new(
        &camera,
        &[0.0],
        vec![net("n-1", Noise::None, 10.0), net("n-2", Noise::sensor(10.5), 105.0)],
    )
    .unwrap();
    let plan = networks::Plan { estimator: estimator(), peers: vec![peer], optics: Settings::default() };
    let hashes = recognised(&Photographing::new(&plan, &photos("kodim03")), false);
    let float = "FloatSettings { stride: Stride(8), overlap: Hann, output: Rgb, budget: None }";
    let by_noise = format!(
        "\"by noise: up to sensor:gain=10: {float}; from sensor:gain=10.5 up to sensor:gain=105: {float}\""
    );
    let sensor = sensor(
        "Sensor(SensorNoise { full_well_e: 1000.0, read_noise_e: 2.5, gain: 1.0 })",
        3_131_312_482_850_461_146,
    );
    let estimator = format!("Some(\"{}\")", sha256(ESTIMATOR.as_bytes()));
    is_of(&hashes, &[&by_noise, OPTICS, "Srgb", &sensor, "8", &estimator]);
}

/// Here, too, others stand for the networks of the rows.
#[test]
fn rows_of_lenses_with_networks_of_their_own() {
    let clear = camera("clear-mid");
    let smaller = Camera {
        name: "clear-0.5".into(),
        aperture_radius_mm: clear.aperture_radius_mm * 0.5f64.powf(0.25),
        focus_psi: 4.0 * 0.5f64.sqrt(),
        ..clear.clone()
    };
    let net = |name: &str, psi_range: [f64; 2]| {
        let mut float = edof_device::random::silent(Camera { psi_range, ..smaller.clone() });
        let [least_noise, noise] = [1.0, 14.2].map(Noise::sensor);
        float.origin.conditions = vec![Condition { tone: Tone::Srgb, noise, least_noise }];
        float.origin.provenance.seed = Some(1);
        Net::new(name, float, name, None, Stride::PATCH).0
    };
    let far = 8.0 * 0.5f64.sqrt();
    let nets = vec![net("blind", [0.0, far]), net("known", [far; 2])];
    let optics = Settings::default();
    let peers = lens_networks::peers(&clear, &[8.0], nets, &optics).unwrap();
    let plan = lens_networks::Plan { peers, electrons: vec![1000.0], read_noise_e: 2.5, optics };
    let hashes = recognised(&lens_networks::Photographing::new(&plan, &photos("kodim02")), false);
    let float = "\"FloatSettings { stride: Stride(8), overlap: Hann, output: Rgb, budget: None }\"";
    let sensor = |seed| {
        sensor("Sensor(SensorNoise { full_well_e: 707.1067811865476, read_noise_e: 2.5, gain: 1.0 })", seed)
    };
    is_of(&hashes, &[float, OPTICS, "Srgb", &sensor(8_361_165_509_730_766_594), "8"]);
}

#[test]
fn rows_of_tolerances() {
    let nets = ["low", "mid", "high"].map(|noise| net(&format!("edof-t4w12-outer-{noise}"))).into();
    let methods = nets_by_noise::entry(nets, Stride::PATCH).unwrap().methods;
    let method = methods.into_iter().find(|m| m.method().format == Some(Format::Float)).unwrap();
    let plan = tolerances::Plan {
        camera: camera("ring-outer"),
        method,
        tone: Tone::Linear,
        psi: vec![8.0],
        noise: vec![Noise::None],
        kinds: vec![Kind::Radius, Kind::Focus],
        optics: Settings::default(),
    };
    let hashes = recognised(&Tolerating::new(&plan, &photos("kodim03")), true);
    let float = "FloatSettings { stride: Stride(8), overlap: Hann, output: Rgb, budget: None }";
    let by_noise = format!(
        "\"by noise: up to 0.006: {float}; from 0.006 up to 0.014: {float}; from 0.014 up to 0.03: {float}\""
    );
    is_of(&hashes, &[&by_noise, OPTICS, "Linear", &sensor("None", 8_677_991_091_651_398_730), "8"]);
}

/// Files of these rows hold pictures and were never kept: the text alone stands here.
#[test]
fn rows_of_scenes_at_four_depths() {
    let lens =
        Lens { title: "lens", camera: camera("clear"), methods: vec![("shown".into(), MethodSpec::Malvar)] };
    let scene =
        Drawn { scene: "chart-4".into(), height: 64, width: 64, psi: vec![0.0, 2.0, 4.0, 8.0], seed: 7 };
    let plan = multi_depth::Plan {
        scenes: vec![scene],
        depth: 12,
        noise: Noise::sensor(8.0),
        tone: Tone::Srgb,
        lenses: vec![lens],
        optics: Settings::default(),
    };
    let cells = Scenes::new(&plan).unwrap().cells();
    let settings = cells[0].0.proof.settings.clone().unwrap();
    let sensor = "Sensor { depth: 12, phase: Rggb, noise: Sensor(SensorNoise { full_well_e: 10000.0, read_noise_e: 2.5, gain: 8.0 }), \
        seed: 7, black_level: 0 }";
    is_of(&[settings], &["\"\"", APPROXIMATION, sensor, "8"]);
}
