//! Networks of a study, by name or weight file.

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::{designs, interrupt, weights};
use edof::job::Device;
use edof::presets::PresetError;
use edof_core::camera::Camera;
use edof_core::storage::digest;
use edof_core::{Stride, Tone};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_network::{FixedNetwork, Network};
use edof_optics::draw::{Builtin, draw};
use edof_quantize::{Calibration, QuantizeOptions, capture, quantize};
use edof_study::methods::nets::{Entry, Net};
use edof_study::methods::nets_by_noise;
use edof_study::methods::settings::FloatSettings;
use edof_study::methods::spec::{MethodSpec, words_sha256};
use std::path::Path;
use std::sync::Arc;

/// Adds the networks' files to what a command reads.
pub fn read(files: Files, nets: &[String]) -> Files {
    let names = || nets.iter().flat_map(|net| parts(net));
    let files = files.reads_all(names().filter_map(weights::float_file));
    files.reads_all(names().filter_map(|net| weights::fixed_file(&fixed_name(net))))
}

/// Returns a line where none of some networks was trained on pictures of a tone.
///
/// # Errors
/// Nothing of that name, or a file that is broken.
pub fn of_other_tone(nets: &[String], tone: Tone) -> Result<Option<String>, Error> {
    let mut trained = vec![];
    for name in nets.iter().flat_map(|net| parts(net)) {
        trained.extend(weights::float(name)?.origin.conditions.iter().map(|condition| condition.tone));
    }
    let other = trained.first().filter(|_| !trained.contains(&tone));
    Ok(other.map(|other| {
        format!("--tone {tone}: every network was trained on pictures of tone {other}; --tone {other} measures them as they were trained")
    }))
}

/// The networks of `LOW+HIGH`; a name or file alone is one.
fn parts(nets: &str) -> Vec<&str> {
    if Path::new(nets).is_file() { vec![nets] } else { nets.split('+').collect() }
}

/// A float network, what reports call it, the hash of its weights, and the fixed one of its name with the hash of its own.
struct Loaded {
    float: Network,
    name: String,
    sha256: String,
    fixed: Option<(FixedNetwork, String)>,
}

/// Weights that are there but broken are an error.
fn load(name: &str, ui: &Ui) -> Result<Loaded, Error> {
    let float = weights::float(name)?;
    let file = weights::float_input(name)?;
    let sha256 = file.sha256.clone();
    ui.used(file);
    let fixed_name = fixed_name(name);
    let fixed = fixed_if_any(&fixed_name)?
        .map(|fixed| {
            let file = weights::fixed_input(&fixed_name)?;
            let sha256 = file.sha256.clone();
            ui.used(file);
            Ok::<_, Error>((fixed, sha256))
        })
        .transpose()?;
    Ok(Loaded { float, name: shown_name(name).to_owned(), sha256, fixed })
}

/// A network behind its own camera, or several as one method by noise, with their fixed-point weights where they have some for the stride;
/// a line for each that has none.
///
/// # Errors
/// Nothing of that name, a file that is broken, or networks that make no method by noise.
pub fn of_kodak(names: &str, stride: Stride, ui: &Ui) -> Result<(Entry, Vec<String>), Error> {
    let (mut nets, mut notes) = (vec![], vec![]);
    for part in parts(names) {
        let Loaded { float, name, sha256, fixed } = load(part, ui)?;
        let (net, note) = Net::new(name, float, &sha256, fixed, stride);
        nets.push(net);
        notes.extend(note);
    }
    let entry = match nets.len() {
        1 => nets.remove(0).entry(stride),
        _ => nets_by_noise::entry(nets, stride)?,
    };
    Ok((entry, notes))
}

/// As [`of_kodak`], of networks that take one raw frame.
///
/// # Errors
/// As there, and a network of several exposures.
pub fn of_one_frame(names: &str, stride: Stride, ui: &Ui) -> Result<(Entry, Vec<String>), Error> {
    parts(names).into_iter().try_for_each(|part| check_single(part, &weights::float(part)?))?;
    of_kodak(names, stride, ui)
}

/// A network at every stride in float, in fixed point, and on a design that it fits; lines that tell where its integers come from. Its own
/// are for one stride; for the others it is quantized here. One without integers has none at any stride.
///
/// # Errors
/// Nothing of that name, a file that is broken, or a network of another camera.
pub fn methods(
    name: &str,
    camera: &Camera,
    strides: &[Stride],
    ui: &Ui,
) -> Result<(Vec<MethodSpec>, Vec<String>), Error> {
    let Loaded { mut float, name: shown, sha256, fixed } = load(name, ui)?;
    check_single(name, &float)?;
    if float.origin.camera != *camera {
        let own = &float.origin.camera.name;
        return Err(Error::message(format!(
            "net '{name}': was trained for camera {own}, not {}: all methods stand behind one camera; add --camera {own}",
            camera.name
        )));
    }
    float.origin.name.clone_from(&shown);
    let float = Arc::new(float);
    let mut methods: Vec<MethodSpec> = strides
        .iter()
        .map(|&stride| {
            let settings = FloatSettings::at(stride);
            MethodSpec::Float { network: Arc::clone(&float), sha256: sha256.clone(), settings }
        })
        .collect();
    let Some((fixed, own_sha256)) = fixed else { return Ok((methods, vec![])) };
    if fixed.float_hash != sha256 {
        let why = "its fixed-point weights were made from other float weights";
        return Ok((methods, vec![format!("NO {shown}.fixed ROWS: {why}")]));
    }
    let mut notes = vec![];
    let mut add = |fixed: FixedNetwork, sha256: String| -> Result<(), Error> {
        let (network, name) = (Arc::new(fixed), shown.clone());
        if let Some(design) = design_of(&network)? {
            let json = serde_json::to_string(&design)?;
            let sha256 = digest::sha256(format!("{sha256}\n{json}").as_bytes());
            let (network, design, name) = (Arc::clone(&network), Arc::new(design), name.clone());
            methods.push(MethodSpec::Board { network, design, name, sha256 });
        }
        methods.push(MethodSpec::Fixed { network, name, sha256 });
        Ok(())
    };
    let missing: Vec<Stride> = strides.iter().copied().filter(|stride| *stride != fixed.stride).collect();
    let bits = fixed.code_bits;
    if strides.contains(&fixed.stride) {
        add(fixed, own_sha256)?;
    }
    for fixed in quantized(&float, &sha256, &[bits], &missing, ui)? {
        let stride = fixed.stride.pixels();
        notes.push(format!("{shown}.fixed at stride {stride}: quantized here, on synthetic scenes"));
        let own = words_sha256(&fixed);
        add(fixed, own)?;
    }
    Ok((methods, notes))
}

/// The same networks on a device behind OpenCL; a line that names it. None on the processor.
///
/// # Errors
/// No such device.
pub fn on_device(device: Device, methods: &[MethodSpec]) -> Result<(Vec<MethodSpec>, Vec<String>), Error> {
    let Some(gpu) = device.open()? else { return Ok((vec![], vec![])) };
    let device = device.number();
    let hash = |sha256: &str| digest::sha256(format!("{sha256}\n{}", gpu.name()).as_bytes());
    let twin = |method: &MethodSpec| match method {
        MethodSpec::Float { network, settings, sha256 } => Some(MethodSpec::FloatGpu {
            network: Arc::clone(network),
            settings: *settings,
            device,
            sha256: hash(sha256),
        }),
        MethodSpec::Fixed { network, name, sha256 } => Some(MethodSpec::FixedGpu {
            network: Arc::clone(network),
            name: name.clone(),
            device,
            sha256: hash(sha256),
        }),
        _ => None,
    };
    let note = format!("rows of .gpu: on {}; their processor time is the host's", gpu.name());
    Ok((methods.iter().filter_map(twin).collect(), vec![note]))
}

/// A design that a network fits at its own stride, if there is one.
fn design_of(network: &FixedNetwork) -> Result<Option<Design>, Error> {
    let at_stride = |design: Design| {
        let frame = FrameSize { stride: network.stride, ..design.frame };
        Design { frame, ..design }
    };
    let fits = |design: &Design| design.check().is_ok() && design.check_network(network).is_ok();
    Ok(designs::all()?.into_iter().map(at_stride).find(fits))
}

/// The camera that a network was trained for.
///
/// # Errors
/// Nothing of that name, or a file that is broken.
pub fn camera(name: &str) -> Result<Camera, Error> {
    Ok(weights::float(name)?.origin.camera)
}

/// A float network of any number of exposures, and the hash of its weights.
///
/// # Errors
/// Nothing of that name, or a file that is broken.
pub fn of_exposures(name: &str, ui: &Ui) -> Result<(Network, String), Error> {
    let Loaded { float, sha256, .. } = load(name, ui)?;
    Ok((float, sha256))
}

/// A float network of one raw frame, and the hash of its weights.
///
/// # Errors
/// Nothing of that name, a file that is broken, or a network of several exposures.
pub fn float(name: &str, ui: &Ui) -> Result<(Network, String), Error> {
    let (float, sha256) = of_exposures(name, ui)?;
    check_single(name, &float)?;
    Ok((float, sha256))
}

/// Rejects a network of several exposures where a study takes one raw frame.
fn check_single(name: &str, network: &Network) -> Result<(), Error> {
    match network.form.exposures {
        1 => Ok(()),
        exposures => Err(Error::message(format!(
            "net '{name}': takes {exposures} raw frames of a scene, this study one; edof study kodak and edof study lens-networks take both"
        ))),
    }
}

/// Built-in scenes that networks are quantized on here, and their size. Committed networks
/// saw photographs; these do without.
const SCENES: u64 = 2;
const SCENE_SIZE: (usize, usize) = (192, 256);

/// A float network in integers for each number of bits and each stride, with nothing trained after.
///
/// # Errors
/// A network that cannot be quantized so, or Ctrl-C.
pub fn quantized(
    network: &Network,
    sha256: &str,
    bits: &[u32],
    strides: &[Stride],
    ui: &Ui,
) -> Result<Vec<FixedNetwork>, Error> {
    let mut all = vec![];
    if bits.is_empty() || strides.is_empty() {
        return Ok(all);
    }
    let (height, width) = SCENE_SIZE;
    let pictures = (0..SCENES)
        .map(|seed| {
            Ok((format!("leaves-{seed}"), draw(Builtin::Leaves, height, width, &[0.0], seed)?.sharp()))
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let progress = ui.progress(SCENES, "scenes captured to quantize with");
    let scenes = capture(&pictures, &network.origin, usize::MAX, |done| progress.set(done as u64))?;
    drop(progress);
    let frames = scenes.iter().map(|scene| &scene.raw);
    let calibration = Calibration::measure_while(network, frames, |_| interrupt::flow())?;
    interrupt::check()?;
    for &stride in strides {
        for &bits in bits {
            let options = QuantizeOptions { bits, stride, ..QuantizeOptions::default() };
            all.push(quantize(network, &options, &calibration, sha256)?.0);
        }
    }
    Ok(all)
}

/// What reports call a net.
fn shown_name(name: &str) -> &str {
    name.strip_suffix(".safetensors").unwrap_or(name).rsplit(['/', '\\']).next().unwrap_or(name)
}

/// Name of the fixed net that goes with a float one.
pub fn fixed_name(name: &str) -> String {
    let stem = name.strip_suffix(".safetensors");
    stem.map_or_else(|| name.to_owned(), |stem| format!("{stem}.fixed.safetensors"))
}

/// A fixed net, where there is one of that name. One that is there but broken is an error.
fn fixed_if_any(name: &str) -> Result<Option<FixedNetwork>, Error> {
    match weights::fixed(name) {
        Ok(fixed) => Ok(Some(fixed)),
        Err(PresetError::WeightFile(error)) => Err(error.into()),
        Err(_) => Ok(None),
    }
}
