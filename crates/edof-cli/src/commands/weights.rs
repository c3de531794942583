//! `edof weights`: what a weight file holds.

use crate::designs;
use crate::error::Error;
use crate::error_bounds;
use crate::files::Files;
use crate::form;
use crate::ui::Ui;
use crate::weights;
use edof::presets::PresetError;
use edof_core::Tone;
use edof_core::number::OUTPUT_FRACTION;
use edof_core::storage::provenance::Provenance;
use edof_core::words::number;
use edof_device::design::memory;
use edof_device::registers::word_file::WordFormat;
use edof_network::fixed_network::{FixedMatrix, layer_names};
use edof_network::network::Origin;
use edof_network::weight_file::WeightFileError;
use edof_network::{FixedNetwork, Network};
use edof_quantize::bounds::{self, StageError};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Print the contents of a weight file: architecture, formats, ranges, accumulators, and how it was made
///
/// With a name, the command prints the float network and, if there is one, the fixed-point network made from it. With a file, it prints
/// that file.
///
/// With --words, the command also writes what a host must write at run time for a calculator in a design of your own to use the network: all words of a set of weights, with
/// their addresses, as edof board load sends them.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof weights edof-t4w12-outer
  edof weights mine.fixed.safetensors --json weights.json
  edof weights mine.fixed.safetensors --design mine.json --words mine.hex")]
pub struct Args {
    /// A name such as edof-t4w12, or a weight file
    weights: String,

    /// File of addresses and words to write: .hex text, .bin pairs of 32 bits (little-endian), .h an array in C
    #[arg(long, value_name = "FILE", requires = "design")]
    words: Option<PathBuf>,

    /// Design whose calculator takes the words, by name or file
    #[arg(long, value_name = "NAME|FILE", requires = "words")]
    design: Option<String>,

    /// Set of weights that the words go to, 0 or 1 [default: 1, or 0 if the design has one set; a generated design starts with 0]
    #[arg(long, value_name = "N", requires = "words")]
    set: Option<usize>,
}

/// # Errors
/// Nothing of that name, a file that is not a weight file, or words that the design does not take.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = Files::new(ui).reads_all(weights::float_file(&args.weights)).reads_all(&args.design);
    let files = files.may_write("--words", args.words.as_ref());
    files.reads_all(weights::fixed_file(&args.weights)).check()?;
    let words = args.words.as_deref().zip(args.design.as_deref());
    let words = words.map(|(file, design)| words_file(file, design, &args)).transpose()?;
    let found = Found { float: float(&args.weights)?, fixed: fixed(&args.weights)?, words };
    let origin = match (&found.float, &found.fixed) {
        (Some(float), _) => float.origin.clone(),
        (None, Some(fixed)) => fixed.origin.clone(),
        // Neither: say why it is not the first.
        (None, None) => return Ok(weights::float(&args.weights).map(|_| ())?),
    };
    tell_origin(&origin, ui)?;
    if let Some(float) = &found.float {
        tell_float(float, ui)?;
    }
    if let Some(fixed) = &found.fixed {
        tell_fixed(fixed, ui)?;
    }
    if let Some(Words { file, design, set, words }) = &found.words {
        ui.say(format!("{file}: {words} words and their addresses, for set {set} of design {design}"))?;
    }
    ui.json(&found)
}

/// A file of words.
#[derive(Serialize)]
struct Words {
    file: String,
    design: String,
    set: usize,
    words: usize,
}

/// Writes the words of a network for a set of a design.
fn words_file(file: &Path, given: &str, args: &Args) -> Result<Words, Error> {
    let told = file.display();
    let format = WordFormat::of_ending(file)
        .ok_or_else(|| Error::message(format!("--words {told}: must end in .hex, .bin or .h")))?;
    let (design, network) = (designs::load(given)?, weights::fixed(&args.weights)?);
    designs::fits_given(&design, given, &network)?;
    let sets = design.sets();
    let set = args.set.unwrap_or(sets.len() - 1);
    let wrong = || {
        let expected = if sets.len() == 1 { "0" } else { "0 or 1" };
        Error::message(format!(
            "--set {set}: must be {expected}, as design {} has sets {}",
            design.name,
            sets.len()
        ))
    };
    let words = memory::writes(&design, &network, *sets.get(set).ok_or_else(wrong)?);
    let about = format!("Words of {} for set {set} of design {}.", network.origin.name, design.name);
    edof_core::storage::atomic::write(file, &format.file(&about, &words))?;
    Ok(Words { file: told.to_string(), design: design.name, set, words: words.len() })
}

#[derive(Serialize)]
struct Found {
    #[serde(skip_serializing_if = "Option::is_none")]
    words: Option<Words>,
    #[serde(skip_serializing_if = "Option::is_none")]
    float: Option<Float>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fixed: Option<Fixed>,
}

#[derive(Serialize)]
struct Float {
    form: String,
    sha256: String,
    parameters: usize,
    matrices: Vec<Matrix>,
    origin: Origin,
}

#[derive(Serialize)]
struct Matrix {
    name: String,
    rows: usize,
    columns: usize,
    #[serde(rename = "least")]
    min: f32,
    #[serde(rename = "most")]
    max: f32,
}

#[derive(Serialize)]
struct Fixed {
    form: String,
    sha256: String,
    code_bits: u32,
    stride: usize,
    overlap: edof_core::overlap::Overlap,
    float_sha256: String,
    layers: Vec<Layer>,
    error_bounds: Vec<StageError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    quantized: Option<edof_network::fixed_network::Quantized>,
    origin: Origin,
}

/// One layer of integers.
#[derive(Serialize)]
struct Layer {
    layer: String,
    weight_fraction_bits: Vec<u32>,
    /// Largest |weight| as a share of what its width can hold.
    range_used: Vec<f64>,
    result_fraction_bits: u32,
    shift: u32,
    accumulator_bits: u32,
}

/// A float network of that name; none if the file holds a fixed one.
fn float(name: &str) -> Result<Option<Float>, Error> {
    let Some(network) = of_kind(weights::float(name))? else { return Ok(None) };
    let matrices = matrices(&network);
    Ok(Some(Float {
        form: form::words(&network.form),
        sha256: weights::float_input(name)?.sha256,
        parameters: matrices.iter().map(|m| m.rows * m.columns).sum(),
        matrices,
        origin: network.origin,
    }))
}

fn fixed(name: &str) -> Result<Option<Fixed>, Error> {
    let Some(network) = of_kind(weights::fixed(name))? else { return Ok(None) };
    // Only the very float network that the words were made from says what they cost.
    let float = of_kind(weights::float(name))?;
    let own = |_: &Network| weights::float_input(name).is_ok_and(|input| input.sha256 == network.float_hash);
    let float = float.filter(own);
    Ok(Some(Fixed {
        form: form::words(&network.form),
        sha256: weights::fixed_input(name)?.sha256,
        code_bits: network.code_bits,
        stride: network.stride.pixels(),
        overlap: network.overlap,
        float_sha256: network.float_hash.clone(),
        layers: layers(&network),
        error_bounds: bounds::stage_errors(&network, float.as_ref()),
        quantized: network.quantized,
        origin: network.origin,
    }))
}

/// None where nothing of that name is there, or it is of the other kind; what is there and broken is an error.
fn of_kind<T>(found: Result<T, PresetError>) -> Result<Option<T>, Error> {
    match found {
        Ok(network) => Ok(Some(network)),
        Err(PresetError::WeightFile(WeightFileError::Kind { .. } | WeightFileError::Exposures { .. })) => {
            Ok(None)
        }
        Err(PresetError::WeightFile(error)) => Err(error.into()),
        Err(_) => Ok(None),
    }
}

fn matrices(network: &Network) -> Vec<Matrix> {
    let of = |name: String, (rows, columns): (usize, usize), values: &mut dyn Iterator<Item = &f32>| {
        let (min, max) = values.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, m), v| (l.min(*v), m.max(*v)));
        Matrix { name, rows, columns, min, max }
    };
    let mut found = vec![of("A".into(), network.analysis.dim(), &mut network.analysis.iter())];
    for (t, theta) in network.thresholds.iter().enumerate() {
        found.push(of(format!("theta{}", t + 1), (theta.len(), 1), &mut theta.iter()));
    }
    for (t, s) in network.recurrent.iter().enumerate() {
        found.push(of(format!("S{}", t + 1), s.dim(), &mut s.iter()));
    }
    found.push(of("D".into(), network.dictionary.dim(), &mut network.dictionary.iter()));
    found.extend(network.linear_path.iter().map(|r| of("R".into(), r.dim(), &mut r.iter())));
    found
}

fn layers(network: &FixedNetwork) -> Vec<Layer> {
    let last = network.form.layers - 1;
    let full = f64::from((1u32 << (network.code_bits - 1)) - 1);
    let used =
        |m: &&FixedMatrix| f64::from(m.weights.iter().map(|w| w.unsigned_abs()).max().unwrap_or(0)) / full;
    layer_names(network.form.layers)
        .zip(network.accumulator_bits())
        .enumerate()
        .map(|(index, (name, accumulator_bits))| {
            let (matrices, shift): (Vec<&FixedMatrix>, u32) = match index {
                0 => (vec![&network.analysis], network.analysis_shift()),
                _ if index == last => {
                    let both = std::iter::once(&network.dictionary).chain(&network.linear_path);
                    (both.collect(), network.final_shifts().result)
                }
                _ => (vec![network.recurrent_matrix(index - 1)], network.middle_shifts(index - 1).result),
            };
            Layer {
                layer: if name == "M" { format!("M{index}") } else { name.to_owned() },
                weight_fraction_bits: matrices.iter().map(|m| m.fraction).collect(),
                range_used: matrices.iter().map(used).collect(),
                result_fraction_bits: network.code_fractions.get(index).copied().unwrap_or(OUTPUT_FRACTION),
                shift,
                accumulator_bits,
            }
        })
        .collect()
}

fn tell_origin(origin: &Origin, ui: &Ui) -> Result<(), Error> {
    let camera = &origin.camera;
    let [low, high] = camera.psi_range.map(number);
    ui.say(format!("{}: trained for the camera {}, psi {low} to {high}", origin.name, camera.name))?;
    for condition in &origin.conditions {
        ui.say(format!("  light: {}, noise {}", condition.tone, condition.noise_in_words()))?;
    }
    if !origin.further_foci.is_empty() {
        let foci: Vec<String> = origin.cameras().iter().map(|camera| camera.focus_psi.to_string()).collect();
        ui.say(format!("  takes {} raw frames of a scene, at foci {}", foci.len(), foci.join(", ")))?;
    }
    if origin.values == Tone::Srgb {
        ui.say("  takes and gives light encoded as sRGB")?;
    }
    ui.say(format!(
        "  {:.2} dB on validation windows, {} windows seen",
        origin.validation_db, origin.patches
    ))?;
    if !origin.non_zeros.is_empty() {
        let counts: Vec<String> = origin.non_zeros.iter().map(|n| format!("{n:.1}")).collect();
        ui.say(format!("  non-zeros after each shrinkage: {}", counts.join(", ")))?;
    }
    tell_provenance(&origin.provenance, ui)
}

fn tell_provenance(made: &Provenance, ui: &Ui) -> Result<(), Error> {
    let revision = made.revision.as_deref().unwrap_or("revision unknown");
    let cpu = if made.host.cpu.is_empty() { "an unknown CPU" } else { &made.host.cpu };
    ui.say(format!("  made by: {}", made.command))?;
    ui.say(format!("  edof {} ({revision}), {} inputs, on {cpu}", made.version, made.inputs.len()))
}

fn tell_float(float: &Float, ui: &Ui) -> Result<(), Error> {
    ui.say(format!("float: {}, {} parameters, SHA-256 {}", float.form, float.parameters, float.sha256))?;
    for m in &float.matrices {
        let size = format!("{}x{}", m.rows, m.columns);
        ui.say(format!("  {:7} {size:>8}  {:>9.4} to {:.4}", m.name, m.min, m.max))?;
    }
    Ok(())
}

fn tell_fixed(fixed: &Fixed, ui: &Ui) -> Result<(), Error> {
    ui.say(format!(
        "fixed: {}, {} bits, stride {}, SHA-256 {}, of the float network {}",
        fixed.form, fixed.code_bits, fixed.stride, fixed.sha256, fixed.float_sha256
    ))?;
    ui.say("  layer  weights' fraction bits  range used  result's fraction bits  shift  accumulator bits")?;
    for l in &fixed.layers {
        let fractions: Vec<String> = l.weight_fraction_bits.iter().map(u32::to_string).collect();
        let used: Vec<String> = l.range_used.iter().map(|r| format!("{:.0} %", 100.0 * r)).collect();
        ui.say(format!(
            "  {:5}  {:>22}  {:>10}  {:>22}  {:>5}  {:>16}",
            l.layer,
            fractions.join(", "),
            used.join(", "),
            l.result_fraction_bits,
            l.shift,
            l.accumulator_bits
        ))?;
    }
    error_bounds::tell(&fixed.error_bounds, ui)?;
    let Some(quantized) = &fixed.quantized else { return Ok(()) };
    let seen = &quantized.calibration;
    ui.say(format!(
        "  calibrated on {} windows, {} depths, headroom {}, {} steps of fine-tuning",
        seen.windows,
        seen.psis.len(),
        quantized.headroom,
        quantized.finetune_steps
    ))?;
    tell_provenance(&quantized.provenance, ui)
}
