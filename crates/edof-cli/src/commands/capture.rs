//! `edof capture`.

use crate::commands::scene::{Drawing, fits};
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use edof_io::record::{self, RawRecord};
use edof_io::{photo, raw};
use edof_optics::capture::{
    Approximation, ApproximationCost, Capture, Depth, capture, measure_approximation,
};
use edof_optics::draw::parse_name;
use edof_optics::psf::Settings;
use edof_optics::scene::Scene;
use edof_optics::sensor::Sensor;
use edof_spec::provenance::Input;
use edof_spec::{Camera, CfaPhase, Noise, RawFrame, Tone};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Simulate the raw Bayer frame that a camera gives of a photograph or a built-in scene
///
/// Only what the scene needs is computed: the depths it has, kernels up to an asked share of the energy, as many wavelengths
/// as a tolerance asks for. What each of these approximations changes of the light on the sensor, and the time it saves, is
/// measured against an exact computation and printed (--no-measure leaves that out; --exact approximates nothing).
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// A photograph (PNG, TIFF, PPM), or chart, chart-4, leaves, leaves-4, which are drawn as light
    #[arg(value_name = "SCENE")]
    scene: String,

    /// Raw frame: .png or .tif (sensor values at the top of 16 bits), .pgm, or .raw without a header; beside it FILE.json says
    /// how it was taken
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Camera: a preset (clear, clear-mid, ring-2015, ring-2018, ring-depth-2018, ring-outer) or a JSON file
    #[arg(long, default_value = "ring-outer", value_name = "CAMERA")]
    camera: String,

    /// What pictures hold: srgb, encoded light, which a photograph is decoded from and --sharp and --light are encoded to; or
    /// linear, light itself, the paper's convention
    #[arg(long, default_value_t = Tone::Srgb, value_name = "TONE")]
    tone: Tone,

    #[command(flatten)]
    drawing: Drawing,

    /// Bits a pixel of the sensor, 8 to 16
    #[arg(long, default_value_t = 12, value_name = "BITS")]
    depth: u32,

    /// Colour filters of the first two pixels of the first two rows: rggb, grbg, gbrg or bggr
    #[arg(long, default_value = "rggb", value_name = "CFA")]
    phase: CfaPhase,

    /// Noise: none, the standard deviation of Gaussian noise in units of full scale, or sensor, the photon and read noise of
    /// a sensor (10000 electrons of full well, 2.5 of read noise, gain 1 unless said otherwise, as in
    /// sensor:full-well=6000:read-noise=1.8:gain=4)
    #[arg(long, default_value_t = Noise::None, value_name = "NOISE", allow_hyphen_values = true)]
    noise: Noise,

    /// Share of the energy that a cut kernel keeps, more than 0 and at most 1
    #[arg(long, default_value_t = 0.999, value_name = "SHARE")]
    energy: f64,

    /// Share of the energy that may lie wrong because a spectrum is sampled at few wavelengths
    #[arg(long, default_value_t = 0.01, value_name = "SHARE")]
    wavelength_tolerance: f64,

    /// Layers whose psi differ by no more than this share one kernel (radians)
    #[arg(long, default_value_t = 0.0, value_name = "PSI")]
    depth_tolerance: f64,

    /// No approximation
    #[arg(long)]
    exact: bool,

    /// Do not measure what the approximations change and save
    #[arg(long)]
    no_measure: bool,

    /// Also write the sharp truth, 16 bits
    #[arg(long, value_name = "FILE")]
    sharp: Option<PathBuf>,

    /// Also write the light on the sensor before its colour filters, 16 bits
    #[arg(long, value_name = "FILE")]
    light: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  edof capture photo.png --camera ring-outer --psi 8 --out raw.png
  edof capture chart-4 --noise sensor:gain=8 --out raw.pgm --sharp sharp.png
  edof capture photo.png --tone linear --noise 0.01 --psi 8 --out raw.png
  edof capture leaves --psi 6 --noise sensor:gain=4 --depth 10 --phase bggr --out raw.png --exact";

#[derive(Serialize)]
struct Captured {
    scene: String,
    camera: String,
    width: usize,
    height: usize,
    psi: Vec<f64>,
    tone: Tone,
    noise: Noise,
    depths: Vec<Depth>,
    seconds: f64,
    approximations: Vec<ApproximationCost>,
    out: String,
}

/// # Errors
/// A photograph that cannot be read or has an odd side, depths or a sensor that cannot be, a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    raw::check_ending(&args.out)?;
    let mut files = Files::new(ui).reads(&args.scene).reads(&args.camera).writes("--out", &args.out);
    files = files.writes("the record beside --out", record::path_of(&args.out));
    for (option, file) in [("--sharp", &args.sharp), ("--light", &args.light)] {
        if let Some(file) = file {
            files = files.writes_picture(option, file)?;
        }
    }
    files.check()?;
    let camera = Camera::resolve(&args.camera)?;
    let scene = open(&args, camera.psi_range, ui)?;
    let approximation = args.approximation()?;
    let sensor = Sensor { depth: args.depth, phase: args.phase, noise: args.noise, seed: args.drawing.seed };
    let shot = capture(&scene, &camera, &sensor, &approximation)?;
    raw::save(&args.out, &shot.raw)?;
    record::save(&args.out, &record_of(&args, &camera, &scene, &shot.raw, ui))?;
    if let Some(path) = &args.sharp {
        photo::save(path, &args.tone.encoded(&shot.sharp), 16)?;
    }
    if let Some(path) = &args.light {
        photo::save(path, &args.tone.encoded(&shot.light), 16)?;
    }
    let costs = if args.exact || args.no_measure {
        vec![]
    } else {
        measure_approximation(&scene, &camera, &approximation)?
    };
    tell(&scene, &shot, &costs, ui)?;
    let (height, width) = scene.size();
    let psi = scene.layers.iter().map(|layer| layer.psi).collect();
    let Capture { depths, seconds, .. } = shot;
    let (scene, camera, tone, noise, out) =
        (scene.name, camera.name, args.tone, args.noise, args.out.display().to_string());
    ui.json(&Captured {
        scene,
        camera,
        width,
        height,
        psi,
        tone,
        noise,
        depths,
        seconds,
        approximations: costs,
        out,
    })
}

/// What the raw frame cannot say of itself.
fn record_of(args: &Args, camera: &Camera, scene: &Scene, frame: &RawFrame, ui: &Ui) -> RawRecord {
    ui.used(Input::camera(camera));
    RawRecord {
        phase: frame.phase(),
        depth: frame.depth(),
        alignment: record::alignment_of(&args.out),
        black_level: 0,
        camera: camera.clone(),
        psi: scene.layers.iter().map(|layer| layer.psi).collect(),
        tone: args.tone,
        noise: args.noise,
        sha256: Input::raw_frame(&scene.name, frame).sha256,
        provenance: ui.provenance().for_file(),
    }
}

/// A built-in scene by its name, or a photograph at one depth.
fn open(args: &Args, range: [f64; 2], ui: &Ui) -> Result<Scene, Error> {
    if parse_name(&args.scene).is_ok() && !Path::new(&args.scene).exists() {
        return args.drawing.draw(&args.scene, range);
    }
    let [psi] = args.drawing.psi[..] else {
        return Err(Error::message("--psi: one value, a photograph lies at one depth"));
    };
    if let Some(size) = args.drawing.size {
        return Err(Error::message(format!(
            "--size {size}: a photograph has its own; only built-in scenes are drawn"
        )));
    }
    let name = Path::new(&args.scene).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let photograph = photo::load(Path::new(&args.scene))?;
    let (height, width) = photograph.size();
    fits(width, height)?;
    ui.used(Input::photograph(&name, &photograph));
    Ok(Scene::flat(name, args.tone.decoded(&photograph), psi))
}

impl Args {
    fn approximation(&self) -> Result<Approximation, Error> {
        if self.exact {
            return Ok(Approximation::exact());
        }
        if !(self.energy > 0.0 && self.energy <= 1.0) {
            return Err(Error::message(format!(
                "--energy {}: must be more than 0 and at most 1",
                self.energy
            )));
        }
        let shares = [("wavelength", self.wavelength_tolerance), ("depth", self.depth_tolerance)];
        if let Some((name, value)) = shares.into_iter().find(|(_, v)| !(v.is_finite() && *v >= 0.0)) {
            return Err(Error::message(format!("--{name}-tolerance {value}: must be 0 or more")));
        }
        if self.wavelength_tolerance > 1.0 {
            return Err(Error::message(format!(
                "--wavelength-tolerance {}: a share, must be 0 to 1",
                self.wavelength_tolerance
            )));
        }
        let wavelength_tolerance = self.wavelength_tolerance;
        let psf = Settings { energy: self.energy, wavelength_tolerance, exact: false };
        Ok(Approximation { psf, depth_tolerance: self.depth_tolerance })
    }
}

fn tell(scene: &Scene, shot: &Capture, costs: &[ApproximationCost], ui: &Ui) -> Result<(), Error> {
    let (height, width) = scene.size();
    ui.say(format!("{}: {width}x{height}, {} depths, {:.2} s", scene.name, shot.depths.len(), shot.seconds))?;
    for depth in &shot.depths {
        for (channel, kernel) in ["red", "green", "blue"].into_iter().zip(&depth.channels) {
            ui.say(format!(
                "  psi {:5.2} {channel:5}: kernel {side}x{side} of {support}x{support} keeps {:.2} % of the energy \
                 (about {:.2} % falls farther), {} wavelengths (last step moved {:.2} %)",
                depth.psi,
                100.0 * kernel.energy_kept,
                100.0 * kernel.energy_beyond,
                kernel.wavelengths,
                100.0 * kernel.wavelength_error,
                side = kernel.side,
                support = kernel.support,
            ))?;
        }
    }
    for cost in costs {
        ui.say(format!(
            "  approximated {:11}: rms error {:.1e}, largest {:.1e} of full scale; {:.2} s instead of {:.2} s",
            cost.approximation, cost.rms_error, cost.max_error, cost.seconds, cost.exact_seconds
        ))?;
    }
    Ok(())
}
