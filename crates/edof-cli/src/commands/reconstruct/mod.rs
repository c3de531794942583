//! `edof reconstruct`: from a raw frame, or the exposures of a scene, to a picture.

mod exposures;
mod options;
mod wording;

pub use options::{Args, Gamma};
pub(in crate::commands) use wording::{of_other_phase, of_other_tone, option};

use crate::commands::sensor;
use crate::error::Error;
use crate::files::Files;
use crate::gain;
use crate::interrupt;
use crate::ui::Ui;
use crate::weights;
use edof::job::{Engine, ReconstructJob, Reconstructed, words_file};
use edof_golden::Counts;
use edof_io::record;
use edof_network::fixed_network::layer_names;
use exposures::Foci;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use wording::Wording;

/// # Errors
/// A frame, network or option that cannot be used, or a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    if ![8, 16].contains(&args.bits) {
        return Err(Error::message(format!("--bits {}: must be 8 or 16", args.bits)));
    }
    gain::check(args.gain, args.weights.as_deref())?;
    let foci = Foci::of(&args)?;
    let scenes = scenes(&args, &foci)?;
    check_files(&args, &foci, &scenes, ui)?;
    let sensor = sensor::opened(args.sensor.as_deref(), ui)?;
    let jobs = scenes
        .into_iter()
        .map(|scene| args.job(scene, &foci, sensor.clone()))
        .collect::<Result<Vec<_>, _>>()?;
    let words = Wording { args: &args };
    if jobs.len() > 1 {
        // An unusable frame is reported before the first is computed.
        for job in &jobs {
            let read = job.check(&|note| ui.note(words.note(note))).map_err(|e| words.failed(e))?;
            read.into_iter().for_each(|input| ui.used(input));
        }
    }
    let mut reports = vec![];
    let bar = (jobs.len() > 1).then(|| ui.progress(jobs.len() as u64, "frames"));
    for job in &jobs {
        interrupt::check()?;
        let made = job.run(&|note| ui.note(words.note(note))).map_err(|e| words.failed(e))?;
        reports.push(report(job, made, ui)?);
        bar.iter().for_each(|bar| bar.set(reports.len() as u64));
    }
    drop(bar);
    match &reports[..] {
        [one] => ui.json(one),
        all => ui.json(&json!({ "frames": all })),
    }
}

/// The raw frames of a scene, and the picture that they become.
struct Scene {
    raws: Vec<PathBuf>,
    out: PathBuf,
}

/// One for each frame, or for all exposures of a scene.
fn scenes(args: &Args, foci: &Foci) -> Result<Vec<Scene>, Error> {
    let scenes = foci.scenes(args)?;
    let several = scenes.len() > 1;
    let ends_with_slash = args.out.as_os_str().as_encoded_bytes().ends_with(b"/");
    let folder = ends_with_slash || args.out.is_dir() || args.out.extension().is_none();
    if several && !folder {
        return Err(Error::message(format!(
            "--out {}: {} frames need a folder, not a picture; name one, as in --out sharp/, or give --weights of a network that takes so many exposures",
            args.out.display(),
            args.raw.len()
        )));
    }
    if let Some(words) = args.words.as_ref().filter(|_| several) {
        return Err(Error::message(format!(
            "--words {}: of one frame only, not of {}",
            words.display(),
            args.raw.len()
        )));
    }
    let out = |raw: &Path| match (folder, raw.file_stem()) {
        (true, Some(stem)) => {
            let mut name = stem.to_owned();
            name.push(".png");
            args.out.join(name)
        }
        _ => args.out.clone(),
    };
    Ok(scenes.into_iter().map(|raws| Scene { out: out(&raws[0]), raws }).collect())
}

fn check_files(args: &Args, foci: &Foci, scenes: &[Scene], ui: &Ui) -> Result<(), Error> {
    let file = if args.float || foci.are_several() { weights::float_file } else { weights::fixed_file };
    // Which network it is without --weights, the frame's record says.
    let networks: Vec<&str> = match args.weights.as_deref() {
        Some(name) => vec![name],
        None => weights::names(),
    };
    let files = Files::new(ui).reads_all(networks.into_iter().filter_map(file));
    let lens = args.stated_lens()?;
    let files = files.reads_all(lens.into_iter().flat_map(|lens| lens.files));
    let files = files
        .reads_all(&args.raw)
        .reads_all(&args.sensor)
        .reads_all(args.raw.iter().map(|raw| record::path_of(raw)));
    let mut files = files.may_write("--words", args.words.as_deref().map(words_file));
    for Scene { out, .. } in scenes {
        files = files.writes_picture("--out", out)?.may_write("--board", args.codes_file(out));
    }
    files.check()
}

/// Prints what was made, and returns it as data.
fn report(job: &ReconstructJob, made: Reconstructed, ui: &Ui) -> Result<Value, Error> {
    made.inputs.into_iter().for_each(|input| ui.used(input));
    let (height, width) = made.size;
    let per_megapixel = made.seconds / ((height * width) as f64 / 1e6);
    ui.say(format!(
        "{}: {width}x{height} by {} in {:.3} s ({per_megapixel:.2} s per megapixel)",
        job.out.display(),
        made.method,
        made.seconds,
    ))?;
    let mut report = json!({
        "method": made.method,
        "raw": job.source.path.display().to_string(),
        "picture": job.out.display().to_string(),
        "width": width,
        "height": height,
        "tone": made.tone,
        "seconds": made.seconds,
        "seconds_per_megapixel": per_megapixel,
        "multiplications": made.multiplications,
    });
    if !job.further.is_empty() {
        let further = job.further.iter().map(|source| &source.path);
        report["exposures"] = further.map(|path| path.display().to_string()).collect();
    }
    if let (Engine::Fixed(options), Some((counts, shown))) = (&job.engine, &made.counts) {
        report["counters"] = counters(counts);
        report["display"] = json!({
            "mode": options.display, "clamped_chroma": shown.clamped_chroma, "out_of_gamut": shown.out_of_gamut
        });
        report["board"] = json!(options.codes.as_ref().map(|file| file.display().to_string()));
        report["words"] =
            json!(options.words.as_deref().map(|folder| words_file(folder).display().to_string()));
    }
    Ok(report)
}

/// Saturations and non-zeros of every stage.
fn counters(counts: &Counts) -> Value {
    let stages: Vec<Value> = layer_names(counts.stages.len())
        .zip(&counts.stages)
        .map(|(layer, stage)| {
            json!({
                "layer": layer,
                "saturated_results": stage.saturated_results,
                "saturated_codes": stage.saturated_codes,
                "saturated_differences": stage.saturated_differences,
                "nonzeros": stage.nonzeros,
            })
        })
        .collect();
    json!({ "patches": counts.patches, "stages": stages, "saturated_sums": counts.saturated_sums })
}
