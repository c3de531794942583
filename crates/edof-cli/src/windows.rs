//! Windows of a picture as a network's own camera sees it: what the hardware is fed with in trials and estimates.

use crate::error::Error;
use edof_golden::windows;
use edof_io::photo;
use edof_optics::capture::{Approximation, Capture, capture};
use edof_optics::draw::{Builtin, draw};
use edof_optics::scene::Scene;
use edof_optics::sensor::Sensor;
use edof_spec::{FixedNetwork, Geometry, RawFrame, Tone};
use std::path::{Path, PathBuf};

/// Size of the built-in scene: 1536 patches at stride 8.
const SCENE_SIZE: (usize, usize) = (256, 384);

/// A photograph, or a built-in scene of dead leaves, at depth `psi` (without it at the far end of the network's range, where blur is
/// hardest), with the tone of the first condition that the network was trained for and the most noise that it was.
///
/// # Errors
/// A photograph that cannot be read or used.
pub fn shot(
    network: &FixedNetwork,
    picture: Option<&Path>,
    psi: Option<f64>,
    seed: u64,
) -> Result<Capture, Error> {
    let camera = &network.origin.camera;
    let psi = psi.unwrap_or(camera.psi_range[1]);
    let scene = match picture {
        Some(path) => {
            Scene::flat(path.display().to_string(), tone(network).decoded(&photo::load(path)?), psi)
        }
        None => draw(Builtin::Leaves, SCENE_SIZE.0, SCENE_SIZE.1, &[psi], seed)?,
    };
    let noise = network.origin.most_noise();
    let sensor = Sensor { noise, seed, ..Sensor::default() };
    Ok(capture(&scene, camera, &sensor, &Approximation::default())?)
}

/// The tone of the first condition that a network was trained for.
pub fn tone(network: &FixedNetwork) -> Tone {
    network.origin.conditions.first().map_or(Tone::Linear, |condition| condition.tone)
}

/// Every photograph (or the built-in scene, where there is none) at every depth (or the far end).
pub fn shots(photos: &[PathBuf], psis: &[f64]) -> Vec<(Option<PathBuf>, Option<f64>)> {
    let photos: Vec<Option<PathBuf>> =
        if photos.is_empty() { vec![None] } else { photos.iter().cloned().map(Some).collect() };
    let psis: Vec<Option<f64>> =
        if psis.is_empty() { vec![None] } else { psis.iter().copied().map(Some).collect() };
    photos.iter().flat_map(|photo| psis.iter().map(move |psi| (photo.clone(), *psi))).collect()
}

/// What a shot is called.
pub fn name(shot: &(Option<PathBuf>, Option<f64>)) -> String {
    let photo = shot.0.as_ref().map_or_else(|| "dead leaves".into(), |path| path.display().to_string());
    shot.1.map_or_else(|| photo.clone(), |psi| format!("{photo} at psi {psi}"))
}

/// All windows of a frame, in the order in which the hardware takes them.
///
/// # Errors
/// A frame that is too small for the network's windows.
pub fn of<'a>(
    network: &FixedNetwork,
    raw: &'a RawFrame,
) -> Result<impl Iterator<Item = Vec<i16>> + 'a, Error> {
    let geometry = Geometry::new(network.form.window, network.stride);
    let (height, width) = raw.size();
    geometry.check_frame((height, width))?;
    let (rows, columns) = geometry.patches(height, width);
    Ok((0..rows)
        .flat_map(move |row| (0..columns).map(move |column| windows::window(raw, geometry, row, column))))
}
