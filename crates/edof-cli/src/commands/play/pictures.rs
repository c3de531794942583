//! Pictures of a state, in one binary answer: the length of a JSON text in four bytes (little end first), the text, then each picture's pixels, red, green, blue
//! and 255, in the order in which the text lists them.

use super::networks::{Ready, Said};
use super::state::State;
use crate::error::Error;
use edof_core::camera::Camera;
use edof_core::{ColourFrame, Noise, RawFrame, Reconstructor, Tone};
use edof_deblur::Malvar;
use edof_optics::Sensor;
use edof_study::live::{Subject, View, mosaic};
use edof_study::report::picture::rgba;
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// A lens with its frame and its network.
pub struct Behind {
    pub view: View,
    pub noise: Noise,
    pub raw: RawFrame,
    pub network: Arc<Ready>,
}

/// A picture, and how near it comes to the sharp one.
#[derive(Serialize)]
struct Shown {
    id: &'static str,
    psnr_db: Option<f64>,
}

/// A lens as the commands take it, and what is said of its network.
#[derive(Serialize)]
struct Lens<'a> {
    camera: &'a Camera,
    psi: f64,
    noise: Noise,
    f_number: f64,
    network: Said,
}

#[derive(Serialize)]
struct Text<'a> {
    width: usize,
    height: usize,
    pictures: Vec<Shown>,
    lens: Lens<'a>,
    clear: Lens<'a>,
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

/// The sensor that takes the frames: that of `edof capture` without options.
pub fn sensor(noise: Noise, seed: u64) -> Sensor {
    Sensor { noise, seed, ..Sensor::default() }
}

/// A picture of a method and its dB.
fn judged(
    subject: &Subject,
    method: &dyn Reconstructor,
    raw: &RawFrame,
) -> Result<(ColourFrame, f64), Error> {
    let frame = method.reconstruct(raw)?.frame;
    let db = subject.psnr_db(&frame)?;
    Ok((frame, db))
}

/// The three pictures that are compared.
fn compared(subject: &Subject, coded: &Behind, clear: &Behind) -> Result<[(ColourFrame, f64); 3], Error> {
    let malvar = Malvar::default();
    let (demosaiced, (network, clear)) = rayon::join(
        || judged(subject, &malvar, &coded.raw),
        || {
            rayon::join(
                || judged(subject, &coded.network.method, &coded.raw),
                || judged(subject, &clear.network.method, &clear.raw),
            )
        },
    );
    Ok([demosaiced?, network?, clear?])
}

/// Returns dB of the state's depth.
///
/// # Errors
/// A method that rejects the frame, a picture too small to compare.
pub fn depth_db(state: &State, subject: &Subject, coded: &Behind, clear: &Behind) -> Result<DepthDb, Error> {
    let [demosaiced, network, clear] = compared(subject, coded, clear)?.map(|(_, db)| db);
    Ok(DepthDb { psi: state.psi, demosaiced, network, clear })
}

/// Returns all pictures and what is said of them.
///
/// # Errors
/// As [`depth_db`].
pub fn answer(subject: &Subject, coded: &Behind, clear: &Behind, begun: Instant) -> Result<Vec<u8>, Error> {
    let [demosaiced, network, other] = compared(subject, coded, clear)?;
    let mosaic = mosaic(&coded.raw);
    let all = [
        ("sharp", subject.light(), None),
        ("raw", &mosaic, None),
        ("demosaiced", &demosaiced.0, Some(demosaiced.1)),
        ("network", &network.0, Some(network.1)),
        ("clear", &other.0, Some(other.1)),
    ];
    let (height, width) = subject.light().size();
    let text = Text {
        width,
        height,
        pictures: all.iter().map(|(id, _, psnr_db)| Shown { id, psnr_db: *psnr_db }).collect(),
        lens: coded.told(),
        clear: clear.told(),
        seconds: begun.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_vec(&text)?;
    let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
    bytes.extend(text);
    all.iter().for_each(|(_, frame, _)| bytes.extend(rgba(frame, Tone::Srgb)));
    Ok(bytes)
}

impl Behind {
    fn told(&self) -> Lens<'_> {
        let View { camera, psi } = &self.view;
        let network = self.network.said(camera, self.noise);
        Lens { camera, psi: *psi, noise: self.noise, f_number: camera.f_number(), network }
    }
}
