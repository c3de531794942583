//! What several sets of weights gain that a router chooses among patch by patch: trainings, and what `scripts/depth_aware.py` fits and counts.
//!
//! ```text
//! depth_aware train OUT [steps=8000] [seed=1] [from=NET] [depths=3,4,5] [router=FILE class=K] [lambdas=A,B,C] [rate=R] [gain=A:B]
//! depth_aware frames FOLDER            raw frames, truth and features of patches, to fit and to judge
//! depth_aware errors FOLDER NET...     squared error and non-zeros of every patch of these frames, beside each network
//! ```
//! Depths are ψ of the open aperture, 0 to 8. The lens is target/depth/clear-0.5.json (scripts/lens.py), photographs are those of scripts/results.sh.

use edof_core::camera::Camera;
use edof_core::cfa::CfaPhase;
use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::{PATCH, mirror};
use edof_core::noise::{Noise, SensorNoise};
use edof_core::storage::provenance::Provenance;
use edof_core::{ColourFrame, RawFrame, Tone, Window};
use edof_io::photo;
use edof_io::photos::Selection as Photographs;
use edof_network::float::parameters::flatten;
use edof_network::float::pass::Pass;
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_network::weight_file;
use edof_optics::psf::{Settings, channel_psfs};
use edof_optics::{Sensor, blur_frame, expose};
use edof_train::dataset::Dataset;
use edof_train::recipe::Recipe;
use edof_train::router::{FEATURES, NAMES, Router, Selection, features, noise_level};
use edof_train::train::Trainer;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::error::Error;
use std::fs;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

const LENS: &str = "target/depth/clear-0.5.json";
const STOPS: f64 = 0.5;
const READ_NOISE_E: f64 = 2.5;
const VALIDATION: [u32; 8] = [2, 5, 8, 11, 14, 17, 20, 23];
const HELD_BACK: [u32; 8] = [2, 4, 9, 10, 15, 16, 19, 21];
/// Depths and lights of frames that routers are fitted to, and of those that they are judged by; ψ and 8 − ψ have the same kernels here.
const FIT: (&[f64], &[f64]) = (&[4.0, 5.0, 6.0, 7.0, 8.0], &[10_000.0, 3162.0, 1000.0]);
const JUDGE: (&[f64], &[f64]) = (&[4.0, 6.0, 8.0], &[10_000.0, 1000.0]);
/// Rows and columns of the part of a photograph that routers are fitted to.
const PART: (usize, usize) = (256, 384);
/// Windows that pass through a network together.
const TOGETHER: usize = 256;

/// One frame of a folder.
#[derive(Debug, Serialize, Deserialize)]
struct Shot {
    judged: bool,
    photo: String,
    psi: f64,
    electrons: f64,
    noise: f32,
    height: usize,
    width: usize,
}

fn main() -> Outcome {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    match &words[..] {
        ["train", out, options @ ..] => train(Path::new(out), options),
        ["frames", folder] => frames(Path::new(folder)),
        ["errors", folder, networks @ ..] => networks.iter().try_for_each(|n| errors(Path::new(folder), n)),
        _ => Err("usage: depth_aware train | frames | errors; see the head of the file".into()),
    }
}

fn form() -> Outcome<Form> {
    Ok(Form {
        window: Window::new(12)?,
        codes: 192,
        layers: 4,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    })
}

fn open_psi(psi: f64) -> f64 {
    psi * (-STOPS).exp2()
}

/// Photographs to learn from, or to judge by.
fn photographs(judged: bool) -> Outcome<Vec<(String, ColourFrame)>> {
    let mut found = vec![];
    for (folder, left_out) in [("../shared/data/kodak", VALIDATION), ("../shared/data/more", HELD_BACK)] {
        let kodak = folder.ends_with("kodak");
        let numbers = Photographs::Numbers(left_out.to_vec());
        for (stem, frame) in photo::load_folder(Path::new(folder))?.photographs {
            let test = kodak && Photographs::Test.holds(&stem);
            if test || numbers.holds(&stem) != judged || (judged && !kodak) {
                continue;
            }
            let (height, width) = frame.size();
            found.push((stem, frame.crop(0, 0, height & !1, width & !1)));
        }
    }
    Ok(found)
}

fn recipe() -> Outcome<Recipe> {
    let mut recipe = Recipe::new(form()?);
    let least = STOPS.exp2() as f32;
    recipe.conditions.gain = [least, 10.0 * least];
    recipe.conditions.noiseless = 1_000_000;
    recipe.steps = 8000;
    Ok(recipe)
}

/// The blurred photographs, from the file where they were kept.
fn dataset(recipe: &Recipe, camera: &Camera) -> Outcome<Dataset> {
    let psis: Vec<f64> = (0..=8).map(|psi| open_psi(psi.into())).collect();
    let photos: Vec<ColourFrame> = photographs(false)?.into_iter().map(|(_, frame)| frame).collect();
    eprintln!("{} photographs", photos.len());
    let file = PathBuf::from("target/depth/blurs");
    if let Some(kept) = Dataset::kept(&file, "depth", &photos, recipe.dataset(&psis)) {
        return Ok(kept);
    }
    let made = Dataset::new(&photos, camera, recipe.dataset(&psis), |_, _| ControlFlow::Continue(()))?;
    let made = made.ok_or("interrupted")?;
    made.keep(&file, "depth")?;
    Ok(made)
}

fn train(out: &Path, options: &[&str]) -> Outcome {
    let options: HashMap<&str, &str> = options.iter().filter_map(|o| o.split_once('=')).collect();
    let camera = Camera::resolve(LENS)?;
    let mut recipe = recipe()?;
    if let Some(steps) = options.get("steps") {
        recipe.steps = steps.parse()?;
    }
    if let Some(seed) = options.get("seed") {
        recipe.seed = seed.parse()?;
    }
    if let Some((low, high)) = options.get("gain").and_then(|g| g.split_once(':')) {
        recipe.conditions.gain = [low.parse()?, high.parse()?];
    }
    if let Some(rate) = options.get("rate") {
        recipe.rate = rate.parse()?;
    }
    if let Some(lambdas) = options.get("lambdas") {
        recipe.lambda = lambdas.split(',').map(str::parse).collect::<Result<_, _>>()?;
        recipe.budget = None;
    }
    let mut data = dataset(&recipe, &camera)?;
    if let Some(depths) = options.get("depths") {
        let depths = depths.split(',').map(str::parse).collect::<Result<_, _>>()?;
        data.select(Some(Selection::Depths(depths)));
    }
    if let Some(router) = options.get("router") {
        let router: Router = serde_json::from_slice(&fs::read(router)?)?;
        let class = options.get("class").ok_or("router without class")?.parse()?;
        data.select(Some(Selection::Class(router, class)));
    }
    let start = Instant::now();
    let mut trainer = match options.get("from") {
        Some(from) => Trainer::from_network(recipe, &data, 1, &weight_file::load_network(Path::new(from))?)?,
        None => Trainer::new(recipe, &data, 1)?,
    };
    trainer.run(|_, progress| {
        if let Some(validation) = &progress.validation {
            eprintln!(
                "{} of {}: {:.0} s, {:.3} dB, best {:.3}, loss {:.4}, busy non-zeros {:.1?}",
                progress.step,
                progress.steps,
                start.elapsed().as_secs_f64(),
                validation.db(),
                progress.best.db,
                progress.loss,
                validation.busy_non_zeros()
            );
        }
        ControlFlow::Continue(())
    })?;
    let name = out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    weight_file::save_network(out, &trainer.best(&name, &camera, Provenance::default()))?;
    println!(
        "{}",
        serde_json::json!({
            "network": name, "seconds": start.elapsed().as_secs_f64(), "db": trainer.state.best.db,
            "lambdas": trainer.state.steering.lambdas, "options": options
        })
    );
    Ok(())
}

/// Writes frames, truth, and features of each patch in windows of 12 and of 16 pixels.
fn frames(folder: &Path) -> Outcome {
    fs::create_dir_all(folder)?;
    let camera = Camera::resolve(LENS)?;
    let mut shots = vec![];
    let mut raws = std::io::BufWriter::new(fs::File::create(folder.join("raws.u16"))?);
    let mut truths = std::io::BufWriter::new(fs::File::create(folder.join("truths.u8"))?);
    let mut measured = std::io::BufWriter::new(fs::File::create(folder.join("features.f32"))?);
    for (judged, (psis, lights)) in [(false, FIT), (true, JUDGE)] {
        for (name, frame) in photographs(judged)? {
            let light = Tone::Srgb.decoded(&frame);
            let (height, width) = frame.size();
            for &psi in psis {
                let kernels = channel_psfs(&camera, open_psi(psi), &Settings::default())?;
                let blurred = blur_frame(&light, &kernels);
                let cropped = |frame: &ColourFrame| match judged {
                    true => frame.clone(),
                    false => {
                        let (rows, columns) = PART;
                        frame.crop((height - rows) / 4 * 2, (width - columns) / 4 * 2, rows, columns)
                    }
                };
                let (blurred, sharp) = (cropped(&blurred), cropped(&frame));
                for &electrons in lights {
                    let full_well_e = electrons * (-STOPS).exp2();
                    let noise =
                        Noise::Sensor(SensorNoise { full_well_e, read_noise_e: READ_NOISE_E, gain: 1.0 });
                    let sensor = Sensor { depth: 16, noise, seed: shots.len() as u64, ..Sensor::default() };
                    let raw = expose(&blurred, &sensor)?;
                    let encoded = raw.encoded(Tone::Srgb);
                    let (height, width) = raw.size();
                    for pixel in encoded.pixels() {
                        raws.write_all(&pixel.to_le_bytes())?;
                    }
                    for value in &sharp.planes {
                        truths.write_all(&[(value * 255.0).round() as u8])?;
                    }
                    for side in [12, 16] {
                        each_window(&encoded, side, |window| {
                            let found = features(window, side, side);
                            found.iter().try_for_each(|f| measured.write_all(&f.to_le_bytes()))?;
                            Ok(())
                        })?;
                    }
                    let (photo, noise) = (name.clone(), noise_level(noise));
                    shots.push(Shot { judged, photo, psi, electrons, noise, height, width });
                }
            }
        }
    }
    let index = serde_json::json!({ "features": FEATURES, "names": NAMES, "shots": shots });
    fs::write(folder.join("index.json"), index.to_string())?;
    eprintln!("{} frames", shots.len());
    Ok(())
}

/// Hears the window of every patch of a frame, row by row, mirrored at the borders.
fn each_window(raw: &RawFrame, side: usize, mut hear: impl FnMut(&[f32]) -> Outcome) -> Outcome {
    assert_eq!(raw.phase(), CfaPhase::Rggb);
    let pixels = raw.pixels();
    let (height, width) = raw.size();
    let margin = (side - PATCH) / 2;
    let mut window = vec![0.0; side * side];
    for row in 0..height / PATCH {
        for column in 0..width / PATCH {
            for (i, value) in window.iter_mut().enumerate() {
                let at = |patch: usize, offset: usize, length: usize| {
                    mirror((PATCH * patch + offset) as isize - margin as isize, length)
                };
                let site = (at(row, i / side, height), at(column, i % side, width));
                *value = f32::from(pixels[site]) / 65536.0;
            }
            hear(&window)?;
        }
    }
    Ok(())
}

/// Writes NETWORK.errors: of every patch the squared error of the encoded picture, and non-zeros of each shrinkage.
fn errors(folder: &Path, network: &str) -> Outcome {
    #[derive(Deserialize)]
    struct Index {
        shots: Vec<Shot>,
    }
    let index: Index = serde_json::from_slice(&fs::read(folder.join("index.json"))?)?;
    let network_file = Path::new(network);
    let weights = flatten(&weight_file::load_network(network_file)?);
    let form = form()?;
    let (raws, truths) = (fs::read(folder.join("raws.u16"))?, fs::read(folder.join("truths.u8"))?);
    let (mut raws, mut truths) = (&raws[..], &truths[..]);
    let mut pass = Pass::new(form, TOGETHER);
    let mut out = std::io::BufWriter::new(fs::File::create(network_file.with_extension("errors"))?);
    for shot in &index.shots {
        let (height, width) = (shot.height, shot.width);
        let (raw, truth);
        (raw, raws) = raws.split_at(2 * height * width);
        (truth, truths) = truths.split_at(3 * height * width);
        let words: Vec<u16> = raw.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        let values = ndarray::Array2::from_shape_vec((height, width), words)?;
        let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb)?;
        let mut inputs = vec![];
        each_window(&raw, 12, |window| {
            inputs.extend_from_slice(window);
            Ok(())
        })?;
        let columns = width / PATCH;
        for (batch, inputs) in inputs.chunks(TOGETHER * form.inputs()).enumerate() {
            let windows = inputs.len() / form.inputs();
            let outputs = pass.forward(&weights, inputs, windows).to_vec();
            for (index, output) in outputs.chunks_exact(RGB_OUTPUTS).enumerate() {
                let patch = batch * TOGETHER + index;
                let (top, left) = (patch / columns * PATCH, patch % columns * PATCH);
                let error = |(i, value): (usize, &f32)| {
                    let (plane, pixel) = (i / (PATCH * PATCH), i % (PATCH * PATCH));
                    let (row, column) = (top + pixel / PATCH, left + pixel % PATCH);
                    let truth = f32::from(truth[(plane * height + row) * width + column]) / 255.0;
                    (value.clamp(0.0, 1.0) - truth).powi(2)
                };
                let squared: f32 = output.iter().enumerate().map(error).sum();
                let count = |t: usize| {
                    let codes = &pass.z(t)[index * form.codes..][..form.codes];
                    codes.iter().filter(|z| **z != 0.0).count() as f32
                };
                let row = [squared, count(0), count(1), count(2)];
                row.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))?;
            }
        }
    }
    Ok(())
}
