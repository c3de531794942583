//! The paper's 2.5D experiment: one scene at four depths, through several lenses, before and after reconstruction.
//!
//! Synthetic scenes are light, and all pictures of them are shown encoded; the tone says which of the two is measured.

use crate::codes::{Card, Reader, ReaderError, Symbology, codes_of_luma};
use crate::lens::in_metres;
use crate::metrics::MetricError;
use crate::opening::Opening;
use crate::pictures::{self, Names, Part, Picture, Truth};
use crate::report::Table;
use crate::report::picture::{caption, enlarged, sheet, stacked};
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
    /// How many codes of the scene are read in each picture, where it has codes.
    pub codes: Option<CodesRead>,
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
    /// A larger one.
    #[serde(skip)]
    pub large_parts: Vec<Part>,
    /// What the sensor gave behind each lens.
    #[serde(skip)]
    pub raws: Vec<RawFrame>,
}

/// Codes that rxing reads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CodesRead {
    /// Codes that are read in the scene itself.
    pub of: usize,
    /// Codes that are read, picture by picture.
    pub read: Vec<usize>,
}

impl CodesRead {
    /// Reads in pictures of a scene those codes that are read in the scene itself; none where it has none.
    fn of(
        codes: &[(Symbology, Card)],
        scene: &ColourFrame,
        frames: &[ColourFrame],
    ) -> Result<Option<Self>, ReaderError> {
        let is_read = |frame: &ColourFrame, codes: &[(Symbology, Card)]| -> Result<Vec<bool>, ReaderError> {
            let luma = codes_of_luma(frame);
            let count = |(kind, card): &(Symbology, Card)| {
                Reader::Rxing.count(&luma, *kind, std::slice::from_ref(card))
            };
            codes.iter().map(|code| Ok(count(code)? == 1)).collect()
        };
        let left = codes.iter().zip(is_read(scene, codes)?).filter(|(_, is_read)| *is_read);
        let left: Vec<_> = left.map(|(code, _)| code.clone()).collect();
        let count = |frame| Ok(is_read(frame, &left)?.into_iter().filter(|is_read| *is_read).count());
        let read = frames.iter().map(count).collect::<Result<_, ReaderError>>()?;
        Ok((!left.is_empty()).then_some(Self { of: left.len(), read }))
    }
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
    /// A program that reads codes cannot be run.
    #[error(transparent)]
    Reader(#[from] ReaderError),
    /// A picture that cannot be encoded.
    #[error("picture: {0}")]
    Picture(#[from] image::ImageError),
}

/// Shows the scene, in which `codes` are printed, to every lens and reconstructs each raw frame with every method of that lens. Depths and noise are those of
/// the widest lens; all see the scene for the same time. `tell` hears what comes next and may stop it.
///
/// # Errors
/// [`DemoError`].
pub fn run(
    scene: &Scene,
    codes: &[(Symbology, Card)],
    sensor: &Sensor,
    lenses: &[Lens<'_>],
    tone: Tone,
    mut tell: impl FnMut(&str) -> ControlFlow<()>,
) -> Result<Demo, DemoError> {
    let truth = Truth::of(scene, tone);
    let (mut pictures, mut frames, mut raws) = (vec![], vec![], vec![]);
    for lens in lenses {
        let opening = Opening::among(&lens.camera, lenses.iter().map(|lens| &lens.camera));
        let behind = Sensor { noise: opening.noise(sensor.noise), ..sensor.clone() };
        let raw = capture(&opening.scene(scene), &lens.camera, &behind, &Approximation::default())?.raw;
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
    let (parts, large_parts, truth) = (truth.parts(), truth.large_parts(), truth.light);
    let psis: Vec<f64> = parts.iter().map(|part| part.psi).collect();
    let metres = lenses.last().map_or_else(String::new, |lens| in_metres(&lens.camera, &psis));
    let lenses = lenses.iter().map(|lens| (lens.title.clone(), lens.about.clone())).collect();
    let codes = CodesRead::of(codes, &truth, &frames)?;
    Ok(Demo {
        scene,
        height,
        width,
        noise,
        tone,
        depth,
        pictures,
        codes,
        frames,
        lenses,
        metres,
        truth,
        parts,
        large_parts,
        raws,
    })
}

impl Demo {
    /// PSNRs for a terminal: of the picture, and of its light where that is measured beside it.
    #[must_use]
    pub fn to_text(&self) -> String {
        self.table().to_text().trim_end().to_owned()
    }

    /// Numbers of every picture, the codes read in the last column.
    pub(crate) fn table(&self) -> Table {
        let mut table = pictures::table(&self.pictures);
        if let Some(codes) = &self.codes {
            table.header.push(format!("codes of {}", codes.of));
            table.rows.iter_mut().zip(&codes.read).for_each(|(row, read)| row.push(read.to_string()));
        }
        table
    }

    /// Row and column of the best number of each column of [`Demo::table`], times left out.
    pub(crate) fn best(&self) -> Vec<(usize, usize)> {
        let mut best = pictures::best(&self.pictures);
        let most = self.codes.iter().flat_map(|codes| {
            let most = codes.read.iter().max();
            codes.read.iter().enumerate().filter(move |(_, read)| Some(*read) == most).map(|(row, _)| row)
        });
        let column = self.table().header.len() - 1;
        best.extend(most.map(|row| (row, column)));
        best
    }

    /// A part of each depth, from left to right: in the best picture without a network, then in those of the networks.
    #[must_use]
    pub fn by_depth(&self) -> ColourFrame {
        let is_network = |picture: &Picture| picture.method.contains('.');
        let psnr = |index: &usize| self.pictures[*index].picture.psnr_db();
        let plain = (0..self.pictures.len()).filter(|index| !is_network(&self.pictures[*index]));
        let ordinary = plain.max_by(|a, b| psnr(a).total_cmp(&psnr(b)));
        let is_shown = |index: &usize| Some(*index) == ordinary || is_network(&self.pictures[*index]);
        let strip = |index: usize| {
            let parts =
                self.large_parts.iter().map(|part| enlarged(&part.of(&self.frames[index]), 2)).collect();
            let parts = sheet(&[parts], 4);
            let read =
                self.codes.iter().map(|codes| format!(": {} of {} codes", codes.read[index], codes.of));
            let name = self.pictures[index].name() + &read.collect::<String>();
            let words = caption(&name, parts.size().1, Tone::Srgb);
            stacked(&[words, parts], Tone::Srgb)
        };
        let strips: Vec<ColourFrame> = (0..self.pictures.len()).filter(is_shown).map(strip).collect();
        stacked(&strips, Tone::Srgb)
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
        run(&scene, &[], &Sensor::default(), &lenses, Tone::Srgb, |_| ControlFlow::Continue(())).unwrap()
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
    fn codes_are_counted_that_can_be_read_in_the_scene() {
        let labels = crate::labels::draw(480, 720, [0.0, 2.0, 5.0, 8.0], 1).unwrap();
        let scene = labels.scene.sharp();
        let grey = ColourFrame::zeros(480, 720);
        let codes = CodesRead::of(&labels.codes, &scene, &[scene.clone(), grey]).unwrap().unwrap();
        // Some are too fine even there.
        assert!((18..labels.codes.len()).contains(&codes.of), "{codes:?}");
        assert_eq!(codes.read, [codes.of, 0]);
        assert_eq!(CodesRead::of(&[], &scene, &[]).unwrap(), None);
    }

    #[test]
    fn the_clear_lens_loses_what_lies_far_from_its_focus() {
        let psi_db = &demo().pictures[0].psi_db;
        assert!(psi_db[0][1] > psi_db[3][1] + 3.0, "{psi_db:?}");
    }

    #[test]
    fn a_closed_lens_sees_the_same_scene_with_less_defocus_and_more_noise() {
        let open = Camera::resolve("clear-mid").unwrap();
        let closed = edof_optics::bound::lenses::closed(&open, 2.0);
        let malvar = Malvar::default();
        let lens = |camera: &Camera| Lens {
            title: "lens".into(),
            about: "a lens.".into(),
            camera: camera.clone(),
            methods: vec![("demosaiced".into(), &malvar as &dyn Reconstructor)],
        };
        let of = |scene: &Scene, noise: Noise| {
            let sensor = Sensor { noise, ..Sensor::default() };
            let lenses = [lens(&open), lens(&closed)];
            run(scene, &[], &sensor, &lenses, Tone::Srgb, |_| ControlFlow::Continue(())).unwrap()
        };
        let chart = draw(Builtin::Chart, 96, 128, &[0.0, 3.0, 5.0, 8.0], 0).unwrap();
        let demo = of(&chart, Noise::None);
        for end in [0.0, 8.0] {
            let [open, closed] = [0, 1].map(|lens| demo.pictures[lens].db_at(end).unwrap());
            assert!(closed > open, "psi {end}: {open} open, {closed} closed");
        }
        let mut grey = ColourFrame::zeros(64, 64);
        grey.planes.fill(0.5);
        let spread = |raw: &RawFrame| raw.pixels().mapv(f64::from).std(0.0);
        let raws = of(&Scene::flat("grey", grey, 4.0), Noise::gaussian(0.01)).raws;
        let ratio = spread(&raws[1]) / spread(&raws[0]);
        assert!((ratio - 4.0).abs() < 0.3, "{ratio}");
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
