//! The paper's 2.5D experiment: one scene at four depths, through several lenses, before and after reconstruction.

use crate::metrics::{BORDER, MetricError, Quality, decibel};
use crate::picture::{Tone, png, sheet};
use crate::report::{Figure, Report};
use edof_optics::capture::{Approximation, CaptureError, capture};
use edof_optics::scene::Scene;
use edof_optics::sensor::Sensor;
use edof_spec::{Camera, ColourFrame, Noise, ReconstructError, Reconstructor};
use ndarray::Array2;
use serde::Serialize;

/// A lens and what is done with the frames behind it.
pub struct Lens<'a> {
    /// What the lens is called in tables, as in `coded lens`.
    pub title: String,
    /// The lens.
    pub camera: Camera,
    /// Methods and what each is called in tables.
    pub methods: Vec<(String, &'a dyn Reconstructor)>,
}

/// A picture of the experiment and how near it comes to the truth.
#[derive(Debug, Clone, Serialize)]
pub struct Picture {
    /// Which lens.
    pub lens: String,
    /// Its camera's name.
    pub camera: String,
    /// What was done.
    pub treatment: String,
    /// Name of the method.
    pub method: String,
    /// PSNR over the three colours, peak 1, border cropped.
    pub psnr_db: f64,
    /// Mean SSIM of the three colours.
    pub ssim: f64,
    /// PSNR where each depth is seen: pairs of ψ and dB.
    pub psi_db: Vec<[f64; 2]>,
    /// Seconds that the method took.
    pub seconds: f64,
    /// The picture.
    #[serde(skip)]
    pub frame: ColourFrame,
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
    /// Bits of the sensor.
    pub depth: u32,
    /// All pictures, lens by lens.
    pub pictures: Vec<Picture>,
    /// The scene without blur.
    #[serde(skip)]
    pub truth: ColourFrame,
}

/// A demonstration that cannot be given.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// The scene, the sensor, or depths too far out of focus.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// A method refused the frame.
    #[error(transparent)]
    Reconstruct(#[from] ReconstructError),
    /// A scene too small to measure.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// A picture that cannot be encoded.
    #[error("picture: {0}")]
    Picture(#[from] image::ImageError),
}

/// Shows the scene to every lens and reconstructs each raw frame with every method of that lens.
///
/// # Errors
/// [`DemoError`].
pub fn run(scene: &Scene, sensor: &Sensor, lenses: &[Lens<'_>]) -> Result<Demo, DemoError> {
    let truth = scene.sharp();
    let depths = scene.psi_map();
    let mut pictures = vec![];
    for lens in lenses {
        let raw = capture(scene, &lens.camera, sensor, &Approximation::default())?.raw;
        for (treatment, method) in &lens.methods {
            let result = method.reconstruct(&raw)?;
            let quality = Quality::of(&truth, &result.frame, BORDER)?;
            pictures.push(Picture {
                lens: lens.title.clone(),
                camera: lens.camera.name.clone(),
                treatment: treatment.clone(),
                method: method.name().to_owned(),
                psnr_db: quality.psnr_db,
                ssim: quality.ssim,
                psi_db: psnr_by_depth(&truth, &result.frame, &depths),
                seconds: result.seconds,
                frame: result.frame,
            });
        }
    }
    let (height, width) = truth.size();
    let (noise, depth) = (sensor.noise, sensor.depth);
    Ok(Demo { scene: scene.name.clone(), height, width, noise, depth, pictures, truth })
}

/// PSNR over the pixels of each depth inside the border, ψ ascending.
fn psnr_by_depth(truth: &ColourFrame, estimate: &ColourFrame, depths: &Array2<f32>) -> Vec<[f64; 2]> {
    let (height, width) = truth.size();
    let mut sums: Vec<(f32, f64, f64)> = vec![];
    for row in BORDER..height - BORDER {
        for column in BORDER..width - BORDER {
            let psi = depths[(row, column)];
            let error = |p| {
                (f64::from(truth.planes[(p, row, column)]) - f64::from(estimate.planes[(p, row, column)]))
                    .powi(2)
            };
            let square = error(0) + error(1) + error(2);
            match sums.iter_mut().find(|s| s.0 == psi) {
                Some(sum) => {
                    sum.1 += square;
                    sum.2 += 3.0;
                }
                None => sums.push((psi, square, 3.0)),
            }
        }
    }
    sums.sort_by(|a, b| a.0.total_cmp(&b.0));
    sums.into_iter().map(|(psi, sum, count)| [f64::from(psi), decibel(sum / count)]).collect()
}

impl Demo {
    /// PSNRs for a terminal.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut lines = vec![];
        let name = |p: &Picture| format!("{}, {}", p.lens, p.treatment);
        let width = self.pictures.iter().map(|p| name(p).chars().count()).max().unwrap_or(0);
        let header: String =
            self.psis().iter().map(|psi| format!("  {:>8}", format!("psi {psi:.1}"))).collect();
        lines.push(format!("{:width$}  {:>8}{header}  {:>6}  {:>8}", "PSNR in dB", "all", "SSIM", "seconds"));
        for p in &self.pictures {
            let depths: String = p.psi_db.iter().map(|d| format!("  {:>8.2}", d[1])).collect();
            lines.push(format!(
                "{:width$}  {:>8.2}{depths}  {:>6.4}  {:>8.3}",
                name(p),
                p.psnr_db,
                p.ssim,
                p.seconds
            ));
        }
        lines.join("\n")
    }

    /// The scene and all pictures in one, three in a row, in the order of [`Demo::pictures`].
    #[must_use]
    pub fn overview(&self) -> ColourFrame {
        let all: Vec<&ColourFrame> =
            std::iter::once(&self.truth).chain(self.pictures.iter().map(|p| &p.frame)).collect();
        let rows: Vec<Vec<ColourFrame>> =
            all.chunks(3).map(|row| row.iter().map(|&frame| frame.clone()).collect()).collect();
        sheet(&rows, 4)
    }

    /// The report, pictures inside; `command` tells how to make it again.
    ///
    /// # Errors
    /// [`DemoError::Picture`].
    pub fn report(&self, tone: Tone, command: &str) -> Result<Report, DemoError> {
        let mut report = Report::new("Extended depth of field: one scene, four depths");
        report.paragraph(&format!(
            "The scene “{}” ({}×{} pixels) has four parts, each at its own depth. Every lens sees it once; a {}-bit sensor \
             with Bayer filters and noise {} (a number: Gaussian, full scale 1) gives one raw frame. “Demosaiced” shows that frame \
             as a plain camera would; “reconstructed” is the network in fixed point, in the integers that the board \
             computes with. Made by `{command}`.",
            self.scene, self.width, self.height, self.depth, self.noise
        ));
        report.heading("Pictures");
        let truth = Figure {
            title: "The scene itself".into(),
            note: "no blur, no noise".into(),
            png: png(&self.truth, tone)?,
        };
        let shown = |p: &Picture| -> Result<Figure, DemoError> {
            Ok(Figure {
                title: format!("{}, {}", p.lens, p.treatment),
                note: format!("{:.2} dB, SSIM {:.3}; camera {}, {}", p.psnr_db, p.ssim, p.camera, p.method),
                png: png(&p.frame, tone)?,
            })
        };
        let mut figures = vec![truth];
        for picture in &self.pictures {
            figures.push(shown(picture)?);
        }
        report.figures(&figures);
        report.heading("Numbers");
        report.paragraph("PSNR in dB over red, green and blue, peak 1, 8 pixels of border cropped; by depth where it is seen.");
        let mut header = vec!["lens".to_owned(), "picture".into(), "all".into()];
        header.extend(self.psis().iter().map(|psi| format!("ψ = {psi:.1}")));
        header.extend(["SSIM".to_owned(), "seconds".into()]);
        let row = |p: &Picture| {
            let mut cells = vec![p.lens.clone(), p.treatment.clone(), format!("{:.2}", p.psnr_db)];
            cells.extend(p.psi_db.iter().map(|d| format!("{:.2}", d[1])));
            cells.extend([format!("{:.4}", p.ssim), format!("{:.3}", p.seconds)]);
            cells
        };
        let rows: Vec<Vec<String>> = self.pictures.iter().map(row).collect();
        report.table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows);
        Ok(report)
    }

    fn psis(&self) -> Vec<f64> {
        self.pictures.first().map(|p| p.psi_db.iter().map(|d| d[0]).collect()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_deblur::Malvar;
    use edof_optics::draw::{Builtin, draw};

    fn demo() -> Demo {
        let scene = draw(Builtin::Chart, 96, 128, &[0.0, 3.0, 5.0, 8.0], 0).unwrap();
        let malvar = Malvar::default();
        let lens = |name: &str| Lens {
            title: name.into(),
            camera: Camera::resolve(name).unwrap(),
            methods: vec![("demosaiced".into(), &malvar as &dyn Reconstructor)],
        };
        run(&scene, &Sensor::default(), &[lens("clear"), lens("ring-outer")]).unwrap()
    }

    #[test]
    fn every_lens_and_method_has_a_picture_measured_at_every_depth() {
        let demo = demo();
        assert_eq!(demo.pictures.len(), 2);
        for p in &demo.pictures {
            assert_eq!(p.psi_db.iter().map(|d| d[0]).collect::<Vec<_>>(), [0.0, 3.0, 5.0, 8.0]);
            let (low, high) =
                p.psi_db.iter().fold((f64::MAX, f64::MIN), |(l, h), d| (l.min(d[1]), h.max(d[1])));
            assert!(low <= p.psnr_db && p.psnr_db <= high, "{p:?}");
        }
    }

    #[test]
    fn the_clear_lens_loses_what_lies_far_from_its_focus() {
        let psi_db = &demo().pictures[0].psi_db;
        assert!(psi_db[0][1] > psi_db[3][1] + 3.0, "{psi_db:?}");
    }

    #[test]
    fn the_overview_starts_with_the_scene() {
        let demo = demo();
        let overview = demo.overview();
        assert_eq!(overview.size(), (96 + 8, 3 * 128 + 16));
        assert_eq!(overview.crop(4, 4, 96, 128), demo.truth);
    }

    #[test]
    fn the_report_shows_every_picture_and_how_to_make_it() {
        let html = demo().report(Tone::Code, "edof demo").unwrap().to_html();
        assert_eq!(html.matches("<figure>").count(), 3);
        assert!(html.contains("edof demo") && html.contains("ring-outer"));
    }
}
