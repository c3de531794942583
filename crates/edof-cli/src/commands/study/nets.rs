//! Networks of a study, by name or weight file.

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::weights;
use edof_spec::weight_file::WeightFileError;
use edof_spec::{Camera, FixedNetwork, Network, Stride};
use edof_study::nets::Net;
use edof_study::spec::MethodSpec;
use std::sync::Arc;

/// Adds the networks' files to what a command reads.
pub fn read(files: Files, nets: &[String]) -> Files {
    let files = files.reads_all(nets.iter().filter_map(|net| weights::float_file(net)));
    files.reads_all(nets.iter().filter_map(|net| weights::fixed_file(&fixed_name(net))))
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

/// A network behind its own camera, with its fixed-point weights where it has some for the stride; a line that says so where not.
///
/// # Errors
/// Nothing of that name, or a file that is broken.
pub fn of_kodak(name: &str, stride: Stride, ui: &Ui) -> Result<(Net, Option<String>), Error> {
    let Loaded { float, name, sha256, fixed } = load(name, ui)?;
    Ok(Net::new(name, float, &sha256, fixed.map(|(fixed, _)| fixed), stride))
}

/// A network at every stride in float, and in fixed point where its weights are for one of them; a line that says so where they are not.
///
/// # Errors
/// Nothing of that name, a file that is broken, or a network of another camera.
pub fn methods(
    name: &str,
    camera: &Camera,
    strides: &[Stride],
    ui: &Ui,
) -> Result<(Vec<MethodSpec>, Option<String>), Error> {
    let Loaded { mut float, name: shown, sha256, fixed } = load(name, ui)?;
    if float.origin.camera != *camera {
        let own = &float.origin.camera.name;
        return Err(Error::message(format!(
            "net '{name}': was trained for camera {own}, not {}: all methods stand behind one camera",
            camera.name
        )));
    }
    float.origin.name.clone_from(&shown);
    let float = Arc::new(float);
    let mut methods: Vec<MethodSpec> = strides
        .iter()
        .map(|&stride| MethodSpec::Float { network: Arc::clone(&float), sha256: sha256.clone(), stride })
        .collect();
    let Some((fixed, own_sha256)) = fixed else { return Ok((methods, None)) };
    if !strides.contains(&fixed.stride) || fixed.float_hash != sha256 {
        let why = "its fixed-point weights are for another stride or other float weights";
        return Ok((methods, Some(format!("NO {shown}.fixed ROWS: {why}"))));
    }
    methods.push(MethodSpec::Fixed { network: Arc::new(fixed), name: shown, sha256: own_sha256 });
    Ok((methods, None))
}

/// The camera that a network was trained for.
///
/// # Errors
/// Nothing of that name, or a file that is broken.
pub fn camera(name: &str) -> Result<Camera, Error> {
    Ok(weights::float(name)?.origin.camera)
}

/// What reports call a net.
fn shown_name(name: &str) -> &str {
    name.strip_suffix(".safetensors").unwrap_or(name).rsplit(['/', '\\']).next().unwrap_or(name)
}

/// Name of the fixed net that goes with a float one.
fn fixed_name(name: &str) -> String {
    let stem = name.strip_suffix(".safetensors");
    stem.map_or_else(|| name.to_owned(), |stem| format!("{stem}.fixed.safetensors"))
}

/// A fixed net, where there is one of that name. One that is there but broken is an error.
fn fixed_if_any(name: &str) -> Result<Option<FixedNetwork>, Error> {
    match weights::fixed(name) {
        Ok(fixed) => Ok(Some(fixed)),
        Err(Error::Failed(error)) if !error.is::<WeightFileError>() => Ok(None),
        Err(error) => Err(error),
    }
}
