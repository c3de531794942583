//! Windows of a picture as a network's own camera sees it: what the hardware is fed with in trials and estimates.

use crate::error::Error;
use crate::ui::Ui;
use edof_golden::windows;
use edof_io::photo;
use edof_optics::capture::{Approximation, capture};
use edof_optics::draw::{Builtin, draw};
use edof_optics::scene::Scene;
use edof_optics::sensor::Sensor;
use edof_spec::provenance::Input;
use edof_spec::{FixedNetwork, Geometry, RawFrame, Tone};
use std::path::Path;

/// Size of the built-in scene: 1536 patches at stride 8.
const SCENE_SIZE: (usize, usize) = (256, 384);

/// The raw frame of a photograph, or of a built-in scene of dead leaves, at the far end of the network's range, where blur is
/// hardest, with the tone and the most noise of the first condition that the network was trained for.
///
/// # Errors
/// A photograph that cannot be read or used.
pub fn frame(network: &FixedNetwork, picture: Option<&Path>, seed: u64, ui: &Ui) -> Result<RawFrame, Error> {
    let camera = &network.origin.camera;
    let psi = camera.psi_range[1];
    let scene = match picture {
        Some(path) => {
            let tone = network.origin.conditions.first().map_or(Tone::Linear, |condition| condition.tone);
            let (name, photograph) = (path.display().to_string(), photo::load(path)?);
            ui.used(Input::photograph(&name, &photograph));
            Scene::flat(name, tone.decoded(&photograph), psi)
        }
        None => draw(Builtin::Leaves, SCENE_SIZE.0, SCENE_SIZE.1, &[psi], seed)?,
    };
    let noise = network.origin.most_noise();
    let sensor = Sensor { noise, seed, ..Sensor::default() };
    Ok(capture(&scene, camera, &sensor, &Approximation::default())?.raw)
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
