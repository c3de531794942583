//! Pictures of a state, in one binary answer: the length of a JSON text in four bytes (little end first), the text, then each picture's pixels, red, green, blue
//! and 255, in the order in which the text lists them.

use super::networks::{Choice, Ready, Summary};
use crate::error::Error;
use edof_core::camera::Camera;
use edof_core::{Noise, Tone};
use edof_deblur::Malvar;
use edof_optics::Sensor;
use edof_study::live::{Developed, Live, Shot, Task, View, mosaic};
use edof_study::report::picture::rgba;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// A lens with its frame and its network.
pub struct Behind {
    pub shot: Shot,
    pub network: Arc<Ready>,
    pub choice: Choice,
}

/// What pictures are made by: a network, or demosaicing.
pub type Method = Option<Choice>;

/// A picture, and how near it comes to the sharp one.
#[derive(Serialize)]
struct Shown {
    id: &'static str,
    psnr_db: Option<f64>,
}

/// A lens as the commands take it, and its network.
#[derive(Serialize)]
struct Lens<'a> {
    camera: &'a Camera,
    psi: f64,
    noise: Noise,
    f_number: f64,
    network: Summary,
}

#[derive(Serialize)]
struct Text<'a> {
    width: usize,
    height: usize,
    pictures: Vec<Shown>,
    lens: Lens<'a>,
    clear: Lens<'a>,
    /// The command that trains a network for the lens, saved as [`CAMERA_FILE`].
    train: String,
    seconds: f64,
}

/// dB of a depth.
#[derive(Serialize)]
pub struct DepthDb {
    psi: f64,
    demosaiced: f64,
    network: f64,
    clear: f64,
}

/// Where commands of the page have its lens.
pub const CAMERA_FILE: &str = "page.json";

/// The sensor that takes the frames: that of `edof capture` without options.
pub fn sensor(noise: Noise, seed: u64) -> Sensor {
    Sensor { noise, seed, ..Sensor::default() }
}

/// The three pictures that are compared: of the lens, demosaiced and by its network, and of the clear lens by its own.
fn compared(live: &mut Live<Method>, coded: &Behind, clear: &Behind) -> Result<[Arc<Developed>; 3], Error> {
    let malvar = Malvar::default();
    let by_network = |behind: &'_ Behind| Some(behind.choice.clone());
    let tasks: [Task<'_, Method>; 3] = [
        (&coded.shot, None, &malvar),
        (&coded.shot, by_network(coded), &coded.network.method),
        (&clear.shot, by_network(clear), &clear.network.method),
    ];
    let pictures = live.developed(&tasks)?;
    <[_; 3]>::try_from(pictures).map_err(|_| Error::message("expected a picture of each task"))
}

/// Returns dB of the state's depth.
///
/// # Errors
/// A method that rejects the frame, a picture too small to compare.
pub fn depth_db(live: &mut Live<Method>, psi: f64, coded: &Behind, clear: &Behind) -> Result<DepthDb, Error> {
    let [demosaiced, network, clear] = compared(live, coded, clear)?.map(|picture| picture.psnr_db);
    Ok(DepthDb { psi, demosaiced, network, clear })
}

/// Returns all pictures and their figures.
///
/// # Errors
/// As [`depth_db`].
pub fn answer(
    live: &mut Live<Method>,
    coded: &Behind,
    clear: &Behind,
    train: String,
    begun: Instant,
) -> Result<Vec<u8>, Error> {
    let [demosaiced, network, other] = compared(live, coded, clear)?;
    let raw = live.raw(&coded.shot)?;
    let mosaic = mosaic(&raw);
    let subject = &coded.shot.subject;
    let all = [
        ("sharp", subject.light(), None),
        ("raw", &mosaic, None),
        ("demosaiced", &demosaiced.frame, Some(demosaiced.psnr_db)),
        ("network", &network.frame, Some(network.psnr_db)),
        ("clear", &other.frame, Some(other.psnr_db)),
    ];
    let (height, width) = subject.light().size();
    let pixels: Vec<Vec<u8>> = all.par_iter().map(|(_, frame, _)| rgba(frame, Tone::Srgb)).collect();
    let text = Text {
        width,
        height,
        pictures: all.iter().map(|(id, _, psnr_db)| Shown { id, psnr_db: *psnr_db }).collect(),
        lens: coded.lens(),
        clear: clear.lens(),
        train,
        seconds: begun.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_vec(&text)?;
    let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
    bytes.extend(text);
    pixels.iter().for_each(|pixels| bytes.extend(pixels));
    Ok(bytes)
}

impl Behind {
    fn lens(&self) -> Lens<'_> {
        let Shot { view: View { camera, psi }, sensor, .. } = &self.shot;
        let network = self.network.summary(camera, sensor.noise);
        Lens { camera, psi: *psi, noise: sensor.noise, f_number: camera.f_number(), network }
    }
}
