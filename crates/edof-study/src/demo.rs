//! The paper's 2.5D experiment: one scene at four depths, through several lenses, before and after reconstruction.
//!
//! Synthetic scenes are light, and all pictures of them are shown encoded; the tone says which of the two is measured.

use crate::lens::in_metres;
use crate::metrics::MetricError;
use crate::pictures::{self, Names, Part, Picture, Truth};
use crate::report::picture::{caption, sheet, stacked};
use edof_core::camera::Camera;
use edof_core::{ColourFrame, Noise, RawFrame, ReconstructError, Reconstructor, Tone};
use edof_optics::Scene;
use edof_optics::Sensor;
use edof_optics::capture::{Approximation, CaptureError, capture};
use serde::Serialize;
use std::ops::ControlFlow;

/// A lens and what is done with the frames behind it.
pub struct Lens<'a> {
    /// What the lens is called in tables, as in `coded lens`.
    pub title: String,
    /// The same in a sentence.
    pub about: String,
    /// The lens.
    pub camera: Camera,
    /// Methods and what each is called in tables.
    pub methods: Vec<(String, &'a dyn Reconstructor)>,
}

/// The whole experiment.
#[derive(Debug, Clone, Serialize)]
pub struct Demo {
    /// Name of the scene.
    pub scene: String,
    /// Rows of the scene.
    pub height: usize,
    /// Columns of the scene.
    pub width: usize,
    /// Noise of the sensor.
    pub noise: Noise,
    /// What is measured: light, or its encoding.
    pub tone: Tone,
    /// Bits of the sensor.
    pub depth: u32,
    /// All pictures, lens by lens.
    pub pictures: Vec<Picture>,
    /// The light that the method of each saw.
    #[serde(skip)]
    pub frames: Vec<ColourFrame>,
    /// Title of each lens, and what it is in a sentence.
    #[serde(skip)]
    pub lenses: Vec<(String, String)>,
    /// Distance of each depth before the last lens, in a sentence.
    #[serde(skip)]
    pub metres: String,
    /// The scene without blur.
    #[serde(skip)]
    pub truth: ColourFrame,
    /// A busy part of it at each depth.
    #[serde(skip)]
    pub parts: Vec<Part>,
    /// What the sensor gave behind each lens.
    #[serde(skip)]
    pub raws: Vec<RawFrame>,
}

/// A demonstration that cannot be given.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// The scene, the sensor, or depths too far out of focus.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// A method rejected the frame.
    #[error(transparent)]
    Reconstruct(#[from] ReconstructError),
    /// A scene too small to measure.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// The listener asked to stop.
    #[error("stopped")]
    Stopped,
    /// A picture that cannot be encoded.
    #[error("picture: {0}")]
    Picture(#[from] image::ImageError),
}

/// Shows the scene to every lens and reconstructs each raw frame with every method of that lens. `tell` hears what comes next and may
/// stop it.
///
/// # Errors
/// [`DemoError`].
pub fn run(
    scene: &Scene,
    sensor: &Sensor,
    lenses: &[Lens<'_>],
    tone: Tone,
    mut tell: impl FnMut(&str) -> ControlFlow<()>,
) -> Result<Demo, DemoError> {
    let truth = Truth::of(scene, tone);
    let (mut pictures, mut frames, mut raws) = (vec![], vec![], vec![]);
    for lens in lenses {
        let raw = capture(scene, &lens.camera, sensor, &Approximation::default())?.raw;
        for (treatment, method) in &lens.methods {
            if tell(&format!("{}: {}, {treatment}", scene.name, lens.title)).is_break() {
                return Err(DemoError::Stopped);
            }
            let result = method.reconstruct(&raw)?;
            let (camera, method) = (lens.camera.name.as_str(), method.name());
            let names = Names { lens: &lens.title, camera, treatment, method };
            pictures.push(truth.judge(names, &result.frame, result.seconds)?);
            frames.push(result.frame);
        }
        raws.push(raw);
    }
    let ((height, width), scene) = (truth.light.size(), scene.name.clone());
    let (noise, depth) = (sensor.noise, sensor.depth);
    let (parts, truth) = (truth.parts(), truth.light);
    let psis: Vec<f64> = parts.iter().map(|part| part.psi).collect();
    let metres = lenses.last().map_or_else(String::new, |lens| in_metres(&lens.camera, &psis));
    let lenses = lenses.iter().map(|lens| (lens.title.clone(), lens.about.clone())).collect();
    Ok(Demo {
        scene,
        height,
        width,
        noise,
        tone,
        depth,
        pictures,
        frames,
        lenses,
        metres,
        truth,
        parts,
        raws,
    })
}

impl Demo {
    /// PSNRs for a terminal: of the picture, and of its light where that is measured beside it.
    #[must_use]
    pub fn to_text(&self) -> String {
        pictures::table(&self.pictures).to_text().trim_end().to_owned()
    }

    /// The scene's light and that of all pictures in one, three in a row, in the order of [`Demo::pictures`], each with its name below;
    /// to be shown encoded.
    #[must_use]
    pub fn overview(&self) -> ColourFrame {
        let named = |frame: &ColourFrame, name: &str| {
            let words = caption(name, self.width, Tone::Srgb);
            stacked(&[frame.clone(), words], Tone::Srgb)
        };
        let own =
            self.frames.iter().zip(&self.pictures).map(|(frame, picture)| named(frame, &picture.name()));
        let all: Vec<ColourFrame> = std::iter::once(named(&self.truth, "The scene")).chain(own).collect();
        sheet(&all.chunks(3).map(<[_]>::to_vec).collect::<Vec<_>>(), 4)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use edof_deblur::Malvar;
    use edof_optics::draw::{Builtin, draw};

    pub(crate) fn demo() -> Demo {
        let scene = draw(Builtin::Chart, 96, 128, &[0.0, 3.0, 5.0, 8.0], 0).unwrap();
        let malvar = Malvar::default();
        let lens = |name: &str| Lens {
            title: name.into(),
            about: "a lens.".into(),
            camera: Camera::resolve(name).unwrap(),
            methods: vec![("demosaiced".into(), &malvar as &dyn Reconstructor)],
        };
        let lenses = [lens("clear"), lens("ring-outer")];
        run(&scene, &Sensor::default(), &lenses, Tone::Srgb, |_| ControlFlow::Continue(())).unwrap()
    }

    #[test]
    fn every_lens_and_method_has_a_picture_measured_at_every_depth() {
        let demo = demo();
        assert_eq!(demo.pictures.len(), 2);
        for p in &demo.pictures {
            assert_eq!(p.psi_db.iter().map(|d| d[0]).collect::<Vec<_>>(), [0.0, 3.0, 5.0, 8.0]);
            let (low, high) =
                p.psi_db.iter().fold((f64::MAX, f64::MIN), |(l, h), d| (l.min(d[1]), h.max(d[1])));
            assert!(low <= p.picture.psnr_db() && p.picture.psnr_db() <= high, "{p:?}");
            assert_ne!(p.picture.psnr_db(), p.light.psnr_db());
        }
    }

    #[test]
    fn the_clear_lens_loses_what_lies_far_from_its_focus() {
        let psi_db = &demo().pictures[0].psi_db;
        assert!(psi_db[0][1] > psi_db[3][1] + 3.0, "{psi_db:?}");
    }

    #[test]
    fn the_overview_shows_every_picture_whole_and_its_name_below() {
        let demo = demo();
        let overview = demo.overview();
        let (height, width) = overview.size();
        assert_eq!(width, 3 * 128 + 16);
        assert!(height > 96 + 8 + 14, "{height}");
        assert_eq!(overview.crop(4, 4, 96, 128), demo.truth);
        assert_eq!(overview.crop(4, 4 + 132, 96, 128), demo.frames[0]);
        let below = overview.crop(4 + 96, 4 + 132, height - 104, 128);
        assert!(below.planes.iter().any(|v| *v < 0.05), "no ink");
    }
}
