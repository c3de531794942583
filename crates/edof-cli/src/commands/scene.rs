//! `edof scene`.

use crate::error::Error;
use crate::files::Files;
use crate::lens::{self, Depth, Lens};
use crate::said;
use crate::ui::Ui;
use edof::job::{JobError, Synthetic};
use edof_core::Tone;
use edof_core::camera::Camera;
use edof_core::words::{count, number};
use edof_io::raw::Size;
use edof_optics::draw::{self, DrawError, four_depths};
use edof_study::report::picture::png;
use ndarray::Array2;
use serde::Serialize;
use std::path::PathBuf;

/// Make a built-in scene: the sharp ground truth, its picture for a screen, and its depths
///
/// Writes sharp.png (16 bits, encoded according to --tone; edof capture of the same scene and tone starts from it),
/// screen.png (8 bits, sRGB) and depth.png (8 bits, the smallest ψ of the range black, the largest white).
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// chart (Siemens stars, slanted edges, bars, text) or leaves (dead leaves: statistics like a photograph's) at one depth;
    /// chart-4 or leaves-4 at four
    #[arg(value_name = "SCENE")]
    scene: String,

    /// Folder for the pictures
    #[arg(long, value_name = "DIR", default_value = "out/scene")]
    out: PathBuf,

    #[command(flatten)]
    drawing: Drawing,

    /// Encoding of sharp.png: srgb, or linear (linear light)
    #[arg(long, default_value_t = Tone::Srgb, value_name = "TONE")]
    tone: Tone,

    /// Camera whose range of ψ sets the depths: a preset or a JSON file
    #[arg(long, default_value = lens::DEFAULT, value_name = "CAMERA")]
    camera: String,
}

/// Size of a built-in scene where none was given.
const SIZE: Size = Size { width: 768, height: 512 };
/// How a built-in scene is made.
#[derive(clap::Args)]
pub struct Drawing {
    /// Width and height of a built-in scene in pixels, even and at least 64 [default: 768x512]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,

    /// Depths: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or distances as in 1.5m if the camera
    /// states nominal_m. One value; four, from back to front, for a scene at four depths [default of built-in scenes: the middle
    /// of the range, or four values spread over the range]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "PSI,…")]
    pub psi: Vec<Depth>,

    /// Distance in metres of ψ = 0 (inf for infinity) [default: the camera's nominal_m]
    #[arg(long, value_name = "METRES")]
    pub nominal: Option<f64>,

    /// Seed of all random numbers: the leaves, and the sensor's noise
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
}

const EXAMPLES: &str = "\
Examples:
  edof scene chart --out out/chart
  edof scene leaves-4 --size 1920x1080 --seed 3 --psi 0,2,5,8";

/// What is written.
const FILES: [&str; 3] = ["sharp.png", "screen.png", "depth.png"];

#[derive(Serialize)]
struct Drawn {
    scene: String,
    width: usize,
    height: usize,
    psi: Vec<f64>,
    tone: Tone,
    files: [String; 3],
}

/// # Errors
/// An unknown scene, an impossible size or number of depths, or a folder that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let Lens { camera, files } = lens::resolve(&args.camera, None)?;
    Files::new(ui).reads_all(files).writes_into("--out", &args.out, FILES).check()?;
    ui.used(camera.input());
    let camera = args.drawing.before(camera)?;
    let scene = args.drawing.scene(&args.scene, &camera)?;
    let scene = scene.draw().map_err(|e| args.drawing.failed(e))?;
    scene.check()?;
    let files = FILES.map(|name| args.out.join(name));
    let sharp = scene.sharp();
    edof_io::photo::save(&files[0], &args.tone.encoded(&sharp), 16)?;
    edof_core::storage::atomic::write(&files[1], &png(&sharp, Tone::Srgb)?)?;
    edof_io::photo::save(&files[2], &depth_picture(&scene.psi_map(), camera.psi_range), 8)?;
    let (height, width) = scene.size();
    let psi: Vec<f64> = scene.layers.iter().map(|layer| layer.psi).collect();
    ui.say(format!("{}: {width}x{height}, psi {psi:.2?}, in {}", scene.name, args.out.display()))?;
    let files = files.map(|file| file.display().to_string());
    ui.json(&Drawn { scene: scene.name, width, height, psi, tone: args.tone, files })
}

impl Drawing {
    /// The camera, and where ψ is zero before it.
    ///
    /// # Errors
    /// No distance.
    pub fn before(&self, camera: Camera) -> Result<Camera, Error> {
        if let Some(metres) = self.nominal.filter(|m| m.is_nan() || *m <= 0.0) {
            return Err(Error::message(format!(
                "--nominal {}: must be a distance of more than 0 m",
                number(metres)
            )));
        }
        Ok(Camera { nominal_m: self.nominal.or(camera.nominal_m), ..camera })
    }

    /// The depths that are asked for.
    ///
    /// # Errors
    /// A distance before a camera that does not know where ψ is zero.
    pub fn psis(&self, camera: &Camera) -> Result<Vec<f64>, Error> {
        said::psis(&self.psi, camera)
    }

    /// The built-in scene of that name, its depths spread over the camera's range where none were given.
    ///
    /// # Errors
    /// An unknown scene, or another number of depths than it has.
    pub fn scene(&self, name: &str, camera: &Camera) -> Result<Synthetic, Error> {
        let (kind, depths) = draw::parse_name(name)?;
        let range = camera.psi_range;
        let psi = match (&self.psis(camera)?[..], depths) {
            ([], 1) => vec![0.5 * (range[0] + range[1])],
            ([], _) => four_depths(range).to_vec(),
            (given, _) if given.len() == depths => given.to_vec(),
            (given, _) => {
                return Err(Error::message(format!(
                    "--psi: {} for {name}, expected {depths}",
                    count(given.len(), "value")
                )));
            }
        };
        Ok(Synthetic { kind, size: self.size.unwrap_or(SIZE), psi, seed: self.seed })
    }

    /// A failure of the scene, by the option that it is about.
    pub fn failed(&self, error: JobError) -> Error {
        match (error, self.size) {
            (JobError::Draw(e @ DrawError::Size { .. }), Some(size)) => {
                said::instead(&format!("--size {size}"), &e)
            }
            (e, _) => e.into(),
        }
    }
}

fn depth_picture(psi: &Array2<f32>, [low, high]: [f64; 2]) -> edof_core::ColourFrame {
    let (height, width) = psi.dim();
    let mut frame = edof_core::ColourFrame::zeros(height, width);
    let span = (high - low).max(f64::MIN_POSITIVE);
    let grey = psi.mapv(|v| ((f64::from(v) - low) / span) as f32);
    frame.planes.outer_iter_mut().for_each(|mut plane| plane.assign(&grey));
    frame
}
