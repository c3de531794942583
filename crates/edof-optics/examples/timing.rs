//! Times of PSFs, blur and the design's judge on this machine: `cargo run --release -p edof-optics --example timing`.

use edof_camera::Camera;
use edof_image::{Channel, ColourFrame};
use edof_optics::blur::{Blur, blur_frame};
use edof_optics::design::default_task;
use edof_optics::estimator::judge;
use edof_optics::psf::{Settings, channel_psfs, psf};
use edof_optics::statistics::Statistics;
use std::hint::black_box;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let camera = Camera::resolve("ring-outer")?;
    let tell = |what: &str, repeats: u32, work: &mut dyn FnMut()| {
        let start = Instant::now();
        (0..repeats).for_each(|_| work());
        println!("{what:48} {:9.2} ms", 1e3 * start.elapsed().as_secs_f64() / f64::from(repeats));
    };
    for (name, settings) in [("99.9 % of the energy", Settings::default()), ("exact", Settings::exact())] {
        tell(&format!("PSF of one channel, {name}"), 4, &mut || {
            black_box(psf(&camera, Channel::Green, 6.0, &settings).unwrap());
        });
    }
    let psfs = channel_psfs(&camera, 6.0, &Settings::default())?;
    for (height, width) in [(512, 768), (1080, 1920)] {
        let frame = ColourFrame::zeros(height, width);
        let plane = frame.planes.index_axis(ndarray::Axis(0), 1);
        let plan = Blur::new(height, width);
        let (spectrum, transfer) = (plan.spectrum(plane), plan.transfer(&psfs[1]));
        let size = format!("{width}x{height}");
        tell(&format!("{size}: spectrum of a plane"), 4, &mut || drop(black_box(plan.spectrum(plane))));
        tell(&format!("{size}: transfer of a PSF"), 4, &mut || drop(black_box(plan.transfer(&psfs[1]))));
        tell(&format!("{size}: one more plane blurred"), 4, &mut || {
            drop(black_box(plan.apply(&spectrum, &transfer)))
        });
        tell(&format!("{size}: three planes from nothing"), 2, &mut || {
            drop(black_box(blur_frame(&frame, &psfs)))
        });
    }
    let (statistics, task) = (Statistics::natural(), default_task(&camera));
    tell("a camera judged (nine depths, window 12)", 4, &mut || {
        drop(black_box(judge(&camera, &statistics, &task)))
    });
    Ok(())
}
