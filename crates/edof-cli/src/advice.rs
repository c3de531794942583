//! A line for whoever uses a lens although a clear one is expected to do better.

use crate::commands::optics::advise::stops;
use crate::ui::Ui;
use edof_core::Noise;
use edof_core::camera::Camera;
use edof_core::words::number;
use edof_optics::Statistics;
use edof_optics::bound::Light;
use edof_optics::bound::advise::{Choice, better_clear};

/// Notes that a clear lens is ahead of a camera in the light of a sensor's noise, where it is. No other noise states a light, a PSF bank has no
/// other stop, and a single depth needs no depth of field.
pub fn note(camera: &Camera, noise: Noise, ui: &Ui) {
    better(camera, noise).into_iter().for_each(|line| ui.note(line));
}

/// Returns what [`note`] says.
pub fn better(camera: &Camera, noise: Noise) -> Option<String> {
    let Noise::Sensor(sensor) = noise else { return None };
    if camera.psi_range[1] - camera.psi_range[0] < 0.01 {
        return None;
    }
    let electrons = sensor.full_well_e / sensor.gain;
    let light = Light { electrons, read_noise_e: sensor.read_noise_e, mean: Light::MEAN };
    let (better, by) = better_clear(camera, light, &Statistics::natural()).ok()??;
    let [low, high] = camera.psi_range.map(|psi| number((10.0 * psi).round() / 10.0));
    let name = &camera.name;
    Some(format!(
        "lens {name}: for psi {low} to {high} and {} electrons a clear lens, {}, is expected to be ahead by {:.1} dB on average and {:.1} dB at \
         the worst depth with a network of its own; edof optics advise compares more lenses",
        number(electrons.round()),
        opening(&better),
        by.average_db,
        by.worst_db
    ))
}

fn opening(lens: &Choice) -> String {
    if lens.stops == 0.0 { "open".to_owned() } else { format!("closed by {}", stops(lens.stops)) }
}
