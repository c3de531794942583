//! A lens of the user, its PSFs, and the raw frame of a scene at four depths: `cargo run --release -p edof-optics --example lens_to_raw`

use edof_core::Noise;
use edof_core::camera::Camera;
use edof_core::camera::{Delay, Ring};
use edof_optics::Sensor;
use edof_optics::capture::{Approximation, capture};
use edof_optics::draw::{Builtin, draw, four_depths};
use edof_optics::psf::{Settings, channel_psfs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut camera = Camera::resolve("clear-mid")?;
    let delay = Delay::Phase { rad: 5.0, at_nm: 455.0 };
    (camera.name, camera.mask) =
        ("mine".into(), [Ring { inner: 0.6, outer: 0.9, delay }].into_iter().collect());
    camera.check()?;

    for psi in [0.0, 4.0, 8.0] {
        let sides = channel_psfs(&camera, psi, &Settings::default())?.map(|psf| psf.side());
        println!("psi {psi}: kernels of {sides:?} pixels");
    }

    let scene = draw(Builtin::Chart, 128, 192, &four_depths(camera.psi_range), 0)?;
    let sensor = Sensor { noise: Noise::sensor(4.0), ..Sensor::default() };
    let shot = capture(&scene, &camera, &sensor, &Approximation::default())?;
    let brightest = shot.raw.values().iter().max().copied().unwrap_or(0);
    println!("raw frame {:?}, {} bits, brightest value {brightest}", shot.raw.size(), shot.raw.depth());
    Ok(())
}
