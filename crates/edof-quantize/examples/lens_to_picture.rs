//! Lens, capture, reconstruction: `cargo run --release -p edof-quantize --example lens_to_picture`

use edof_camera::Camera;
use edof_golden::Golden;
use edof_image::Noise;
use edof_network::weight_file;
use edof_optics::capture::{Approximation, capture};
use edof_optics::draw::{Builtin, draw, four_depths};
use edof_optics::sensor::Sensor;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let camera = Camera::resolve("ring-outer")?;
    let scene = draw(Builtin::Chart, 192, 288, &four_depths(camera.psi_range), 0)?;
    let sensor = Sensor { noise: Noise::sensor(1.0), ..Sensor::default() };
    let shot = capture(&scene, &camera, &sensor, &Approximation::default())?;

    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../weights");
    let network = weight_file::load_fixed(&folder.join("edof-t4w12-outer-light.fixed.safetensors"))?;
    assert!(network.origin.camera.same_lens(&camera));
    let (_, picture) = Golden::new(network)?.frame_of_light(&shot.raw)?;

    let errors = (&picture.planes - &scene.sharp().planes).mapv(|e| f64::from(e).powi(2));
    println!("{:.1} dB", -10.0 * errors.mean().unwrap_or(1.0).log10());
    Ok(())
}
