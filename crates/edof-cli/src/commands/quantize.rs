//! `edof quantize`: from a float network to the board's integers.

use super::train::photographs::photographs;
use crate::error::Error;
use crate::error_bounds;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::kind::Kind;
use crate::said;
use crate::ui::{Ui, span};
use crate::weights;
use edof_core::ColourFrame;
use edof_core::overlap::Overlap;
use edof_core::storage::provenance::Input;
use edof_core::words::number;
use edof_golden::Golden;
use edof_io::photos::Selection;
use edof_network::fixed_network::Quantized;
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_network::network::Origin;
use edof_network::{FixedNetwork, Network, weight_file};
use edof_optics::psf;
use edof_quantize::bounds::{self, StageError};
use edof_quantize::capture::{self, depths};
use edof_quantize::{
    Calibration, Evaluation, FinetuneOptions, LayerReport, QuantizeError, QuantizeOptions, Scene, evaluate,
    finetune, quantize,
};
use edof_train::dataset::{Dataset, DatasetOptions};
use serde_json::{Value, json};
use std::cell::Cell;
use std::path::{Path, PathBuf};

/// Pixels at the border that do not count for the dB lost.
const BORDER: usize = 8;

/// Turn a float network into the integers that the board computes with
///
/// Ranges of all codes are measured on photographs (or on built-in scenes) with the network's camera, at nine depths of
/// its range, without noise and with the strongest noise of its training; of these frames --frames takes some. On the same frames the loss of
/// the integers is measured, against the float network in the board's output format (4:2:2, 16-bit luma, 8-bit chroma).
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof quantize weights/edof-t4w12.safetensors --images photos/
  edof quantize edof-t4w12 --bits 12 --stride 4 --out w12.fixed.safetensors --json report.json
  edof quantize edof-t4w12 --bits 8 --finetune 2000 --images photos/ --out w8.fixed.safetensors")]
pub struct Args {
    /// Float network: a name such as edof-t4w12, or a file
    weights: String,

    /// Bits of every weight and code, 8 to 16
    #[arg(long, default_value_t = 16)]
    bits: u32,

    /// Pixels from one patch to the next: 2, 4 or 8
    #[arg(long, default_value_t = 8, value_name = "PIXELS")]
    stride: usize,

    /// Averaging window of overlapping patches
    #[arg(long, value_parser = ["hann", "flat"], default_value = "hann")]
    overlap: String,

    /// Headroom: factor by which a code may exceed its measured range before it saturates, 1 or more
    #[arg(long, default_value_t = 2.0, value_name = "FACTOR")]
    headroom: f64,

    /// Folder of photographs to measure on [default: built-in scenes]
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,

    /// Photographs of the folder to use: train, all, or numbers as in 1,2 [default: all except the study's test photographs]
    #[arg(long)]
    photos: Option<Selection>,

    /// Frames to measure on, spread evenly over photographs, depths and noise: a number, or all
    #[arg(long, default_value_t = capture::FRAMES, value_parser = frames, value_name = "COUNT|all")]
    frames: usize,

    /// Training steps with the rounded words; useful below 12 bits
    #[arg(long, default_value_t = 0, value_name = "STEPS")]
    finetune: u64,

    /// Largest change of a weight per fine-tuning step, for inputs of variance one, in LSB of a code
    #[arg(long, default_value_t = FinetuneOptions::default().rate, value_parser = said::single, value_name = "LSB")]
    finetune_rate: f32,

    /// Weight file to write [default: the float network's name with .fixed.safetensors]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,
}

/// # Errors
/// A network, option or folder that cannot be used, or a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let out = args.out.clone().unwrap_or_else(|| default_out(&args.weights));
    let files = Files::new(ui).reads_all(weights::float_file(&args.weights));
    let files =
        args.images.iter().fold(files, Files::reads_pictures_of).writes_as(Kind::Weights, "--out", &out);
    files.keeps(args.force).check()?;
    let network = weights::float(&args.weights)?;
    network.form.check_single().map_err(|e| Error::message(format!("{}: {e}", args.weights)))?;
    let weights = weights::float_input(&args.weights)?;
    let hash = weights.sha256.clone();
    ui.used(weights);
    let options = QuantizeOptions {
        bits: args.bits,
        stride: said::stride(args.stride)?,
        overlap: if args.overlap == "flat" { Overlap::Flat } else { Overlap::Hann },
        headroom: args.headroom,
    };
    options.check().map_err(|e| of_options(&e))?;
    if !(args.finetune_rate.is_finite() && args.finetune_rate > 0.0) {
        return Err(Error::message(format!(
            "--finetune-rate {}: must be a positive number",
            number(args.finetune_rate.into())
        )));
    }
    let pictures = pictures(&args, ui)?;
    pictures.iter().for_each(|(name, frame)| ui.used(Input::photograph(name, frame)));
    let camera = &network.origin.camera;
    depths(camera.psi_range).into_iter().try_for_each(|psi| psf::check(camera, psi))?;
    let of = capture::scenes(pictures.len(), &network.origin);
    announce(&network, args.frames.min(of), of, &pictures, ui)?;
    let progress = ui.progress(pictures.len() as u64, "pictures captured");
    let scenes = capture::capture(&pictures, &network.origin, args.frames, |done| progress.set(done as u64))?;
    drop(progress);
    interrupt::check()?;
    let frames = scenes.iter().map(|scene| &scene.raw);
    let progress = ui.progress(scenes.len() as u64, "frames measured");
    let calibration = Calibration::measure_while(&network, frames, |done| {
        progress.set(done as u64);
        interrupt::flow()
    })?;
    drop(progress);
    interrupt::check()?;
    let (fixed, mut layers) = quantize(&network, &options, &calibration, &hash)?;
    let mut fixed = match args.finetune {
        0 => fixed,
        steps => tune(
            &fixed,
            &pictures,
            FinetuneOptions { steps, rate: args.finetune_rate, ..Default::default() },
            ui,
        )?,
    };
    interrupt::check()?;
    // Tuned weights have sums of their own.
    layers.iter_mut().zip(fixed.accumulator_bits()).for_each(|(layer, bits)| layer.accumulator_bits = bits);
    fixed.quantized = Some(quantized(&args, &network.origin, calibration.windows, ui));
    let golden = Golden::new(fixed)?;
    let evaluation = judge(&network, &golden, &options, &scenes, ui)?;
    weight_file::save_fixed(&out, golden.network())?;
    let errors = bounds::stage_errors(golden.network(), Some(&network));
    tell(ui, &layers, &evaluation)?;
    error_bounds::tell(&errors, ui)?;
    ui.say(format!("{}: written", out.display()))?;
    ui.json(&report(&args, &out, &layers, &errors, &evaluation, calibration.windows))
}

/// A number of frames, or all.
fn frames(text: &str) -> Result<usize, String> {
    match text {
        "all" => Ok(usize::MAX),
        _ => text
            .parse()
            .ok()
            .filter(|frames| *frames > 0)
            .ok_or_else(|| "must be 1 or more, or all".to_owned()),
    }
}

/// States before the work begins how many frames of all are measured, and how long that takes.
fn announce(
    network: &Network,
    frames: usize,
    of: usize,
    pictures: &[(String, ColourFrame)],
    ui: &Ui,
) -> Result<(), Error> {
    let size = pictures.first().map_or((0, 0), |(_, picture)| picture.size());
    let seconds = Calibration::expected_time(network, frames, size)?.as_secs_f64();
    let line = format!(
        "ranges are measured on {frames} of {of} frames (--frames): about {}, and about as long for the comparison of floats and integers",
        span(seconds)
    );
    ui.status(line, &json!({ "frames": frames, "of": of, "seconds": seconds }));
    Ok(())
}

/// A failure of the options, by their names.
fn of_options(error: &QuantizeError) -> Error {
    match error {
        QuantizeError::Headroom(headroom) => {
            Error::message(format!("--headroom {}: must be 1 or more", number(*headroom)))
        }
        QuantizeError::Fixed { bits, source } => said::instead(&format!("--bits {bits}"), source),
        error => Error::message(error.to_string()),
    }
}

/// How the integers was made.
fn quantized(args: &Args, origin: &Origin, windows: u64, ui: &Ui) -> Quantized {
    Quantized {
        headroom: args.headroom,
        calibration: capture::calibrated_on(origin, windows),
        finetune_steps: args.finetune,
        provenance: ui.provenance().for_file(),
    }
}

fn pictures(args: &Args, ui: &Ui) -> Result<Vec<(String, ColourFrame)>, Error> {
    if let Some(folder) = &args.images {
        let folder = std::slice::from_ref(folder);
        let photographs = photographs(folder, args.photos.as_ref(), &|line| ui.note(line))?;
        return Ok(photographs.into_iter().map(|p| (p.stem, p.frame)).collect());
    }
    Ok(capture::drawn()?)
}

/// Trains on with the words that the board will hold; the best validated ones come out.
fn tune(
    fixed: &FixedNetwork,
    pictures: &[(String, ColourFrame)],
    tuning: FinetuneOptions,
    ui: &Ui,
) -> Result<FixedNetwork, Error> {
    let steps = tuning.steps;
    let frames: Vec<ColourFrame> = pictures.iter().map(|(_, frame)| frame.clone()).collect();
    let camera = &fixed.origin.camera;
    let psis = depths(camera.psi_range);
    let go_on = |_, _| interrupt::flow();
    let plain = DatasetOptions::plain(&psis, fixed.form.window);
    let options = DatasetOptions { tone: fixed.origin.values, ..plain };
    let dataset = Dataset::new(&frames, camera, options, go_on)?.ok_or(Error::Interrupted)?;
    let bar = ui.progress(steps, "fine-tune");
    let mut first = None;
    let mut best = 0.0;
    let tuned = finetune(fixed, &dataset, &tuning, |progress| {
        bar.set(progress.step);
        bar.message(format!("best {:.2} dB", progress.best_db));
        first.get_or_insert(progress.validation_db);
        best = progress.best_db;
        interrupt::flow()
    });
    drop(bar);
    interrupt::check()?;
    let before = first.unwrap_or(best);
    ui.say(format!("fine-tuned from {before:.2} to {best:.2} dB on validation windows in {steps} steps"))?;
    Ok(tuned)
}

fn judge(
    network: &Network,
    golden: &Golden,
    options: &QuantizeOptions,
    scenes: &[Scene<'_>],
    ui: &Ui,
) -> Result<Evaluation, Error> {
    let progress = ui.progress(2 * scenes.len() as u64, "pictures compared");
    let compared = Cell::new(0);
    let float = FloatReconstructor::new(network.clone(), options.stride, options.overlap, Output::Ycc422)?;
    evaluate(&float, golden, scenes, |sharp, estimate| {
        interrupt::check()?;
        compared.set(compared.get() + 1);
        progress.set(compared.get());
        Ok(edof_study::metrics::psnr(sharp, estimate, BORDER)?)
    })
}

/// `x.safetensors` gives `x.fixed.safetensors` beside it; a name gives it under `weights/`.
fn default_out(weights: &str) -> PathBuf {
    match weights.strip_suffix(".safetensors") {
        Some(stem) => PathBuf::from(format!("{stem}.fixed.safetensors")),
        None => PathBuf::from(format!("weights/{weights}.fixed.safetensors")),
    }
}

fn tell(ui: &Ui, layers: &[LayerReport], evaluation: &Evaluation) -> Result<(), Error> {
    ui.say("layer  range used  fraction bits  weights' fraction bits  shift  accumulator bits  saturations  non-zeros")?;
    let patches = evaluation.counts.patches.max(1) as f64;
    for (layer, counts) in layers.iter().zip(&evaluation.counts.stages) {
        let used = layer.range_used.map_or("-".into(), |r| format!("{:.0} %", 100.0 * r));
        let weights: Vec<String> = layer.weight_fractions.iter().map(u32::to_string).collect();
        let nonzeros =
            layer.range_used.map_or("-".into(), |_| format!("{:.1}", counts.nonzeros as f64 / patches));
        ui.say(format!(
            "{:5}  {used:>10}  {:>13}  {:>22}  {:>5}  {:>16}  {:>11}  {nonzeros:>9}",
            layer.name,
            layer.result_fraction,
            weights.join(", "),
            layer.shift,
            layer.accumulator_bits,
            counts.saturations(),
        ))?;
    }
    ui.say(summary(evaluation))
}

/// What the integers cost, in a sentence. They may happen to be better.
fn summary(evaluation: &Evaluation) -> String {
    let mean = match evaluation.mean_lost_db() {
        lost if lost < 0.0 => format!("gained {:.4} dB", -lost),
        lost => format!("lost {lost:.4} dB"),
    };
    let worst = evaluation.worst().map_or_else(String::new, |w| match w.lost_db() {
        lost if lost < 0.0 => format!("; no scene lost, least gained {:.4} dB: {}", -lost, w.name),
        lost => format!(", lost at most {lost:.4} dB: {}", w.name),
    });
    format!("{mean} on average over {} scenes{worst}", evaluation.scenes.len())
}

fn report(
    args: &Args,
    out: &Path,
    layers: &[LayerReport],
    errors: &[StageError],
    evaluation: &Evaluation,
    windows: u64,
) -> Value {
    let patches = evaluation.counts.patches.max(1) as f64;
    let layers: Vec<Value> = layers
        .iter()
        .zip(&evaluation.counts.stages)
        .map(|(layer, counts)| {
            json!({
                "layer": layer.name,
                "range_used": layer.range_used,
                "fraction_bits": layer.result_fraction,
                "weight_fraction_bits": layer.weight_fractions,
                "shift": layer.shift,
                "accumulator_bits": layer.accumulator_bits,
                "saturations": counts.saturations(),
                "nonzeros_per_patch": layer.range_used.map(|_| counts.nonzeros as f64 / patches),
            })
        })
        .collect();
    let scenes: Vec<Value> = evaluation
        .scenes
        .iter()
        .map(|s| json!({ "scene": s.name, "float422_db": s.float_db, "fixed_db": s.fixed_db, "lost_db": s.lost_db() }))
        .collect();
    json!({
        "weights": args.weights,
        "out": out.display().to_string(),
        "bits": args.bits,
        "stride": args.stride,
        "overlap": args.overlap,
        "headroom": args.headroom,
        "finetune_steps": args.finetune,
        "frames": evaluation.scenes.len(),
        "calibration_windows": windows,
        "layers": layers,
        "error_bounds": errors,
        "saturated_sums": evaluation.counts.saturated_sums,
        "mean_lost_db": evaluation.mean_lost_db(),
        "worst_lost_db": evaluation.worst().map(|w| w.lost_db()),
        "scenes": scenes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_golden::Counts;
    use edof_quantize::evaluate::SceneLoss;

    fn evaluation(losses: &[f64]) -> Evaluation {
        let scene = |lost: &f64| SceneLoss { name: "a".into(), float_db: 30.0, fixed_db: 30.0 - lost };
        Evaluation { scenes: losses.iter().map(scene).collect(), counts: Counts::new(3) }
    }

    #[test]
    fn a_loss_is_said_as_a_loss_and_a_gain_as_a_gain() {
        let told = [
            (&[0.25, 0.75][..], "lost 0.5000 dB on average over 2 scenes, lost at most 0.7500 dB: a"),
            (&[-0.75, 0.25], "gained 0.2500 dB on average over 2 scenes, lost at most 0.2500 dB: a"),
            (
                &[-0.75, -0.25],
                "gained 0.5000 dB on average over 2 scenes; no scene lost, least gained 0.2500 dB: a",
            ),
        ];
        told.iter().for_each(|(losses, text)| assert_eq!(summary(&evaluation(losses)), *text));
    }
}
