//! `edof capture`.

use crate::commands::scene::{Drawing, fits};
use crate::depth_map::{DepthMap, MapOf};
use crate::error::Error;
use crate::files::Files;
use crate::lens::{self, DepthRange, Lens};
use crate::pictures::{self, Tones};
use crate::scene_file::{self, ListedScene};
use crate::ui::Ui;
use crate::{memory, said};
use edof_core::camera::Camera;
use edof_core::frame::FrameError;
use edof_core::storage::provenance::Input;
use edof_core::words::count;
use edof_core::{CfaPhase, ColourFrame, Noise, RawFrame, Tone, cable};
use edof_io::levels::{Black, Levels};
use edof_io::raw::{Alignment, Size};
use edof_io::record::{self, RawRecord};
use edof_io::{photo, raw};
use edof_optics::Scene;
use edof_optics::capture::{
    Approximation, ApproximationCost, Capture, CaptureError, Kernel, capture_told, measure_approximation_told,
};
use edof_optics::depth_map::Unit;
use edof_optics::distance_m;
use edof_optics::draw::parse_name;
use edof_optics::layers;
use edof_optics::psf::Settings;
use edof_optics::{Sensor, SensorError};
use ndarray::{Axis, s};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Simulate the raw Bayer frame that a camera gives of a photograph or a built-in scene
///
/// A photograph is at one depth (--psi), or a depth map states the depth of each pixel. With a depth map the photograph is cut into layers, and
/// the part hidden behind a near object is inpainted. A JSON file lists a scene of several layers from back to front, each a picture with
/// a matte at a depth (docs/your-own-lens.md).
///
/// ψ (--psi) is the defocus in radians: 0 in the plane of focus of a clear lens, the far end of the presets' range; 8 at the near end.
/// Cameras with nominal_m accept distances as in 1.5m, too; 'edof optics CAMERA --nominal METRES' prints the distance of each ψ.
///
/// A capture approximates: it computes the depths of the scene, kernels up to a share of the energy, and as many wavelengths
/// as a tolerance requires. --measure compares each approximation with an exact computation, and prints its error of the light on the
/// sensor and the time saved (this takes several times as long). --exact approximates nothing.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
#[command(group(clap::ArgGroup::new("map_scale").args(["range", "map_unit"]).multiple(true)))]
pub struct Args {
    /// A photograph (PNG, JPEG, WebP, TIFF, BMP, PPM), a JSON file that lists layers with mattes and depths, or chart, chart-4, leaves,
    /// leaves-4, which are synthetic scenes of linear light
    #[arg(value_name = "SCENE")]
    scene: String,

    /// Raw frame to write: .png or .tif (sensor values at the top of 16 bits), .pgm, or .raw without a header; FILE.json states
    /// how it was taken
    #[arg(long, value_name = "FILE")]
    out: PathBuf,

    /// Camera: a preset (clear, clear-mid, ring-2015, ring-2018, ring-depth-2018, ring-outer) or a JSON file
    #[arg(long, default_value = "ring-outer", value_name = "CAMERA")]
    camera: String,

    /// PSF bank in place of the camera's computed PSFs: an NPZ, NPY or safetensors file with the arrays psi and psf (docs/your-own-lens.md)
    #[arg(long, value_name = "FILE")]
    psf_bank: Option<PathBuf>,

    /// Encoding of pictures, the photograph's and those of --sharp and --light: srgb, or linear (the paper's convention: samples are
    /// linear light) [default: linear if the photograph's file states so (gAMA, cICP, ICC profile), else srgb]
    #[arg(long, value_name = "TONE")]
    tone: Option<Tone>,

    #[command(flatten)]
    drawing: Drawing,

    /// Depth map: a grey picture of the photograph's size, white nearest; or distances (--map-of, --map-unit)
    #[arg(long, value_name = "FILE", requires = "map_scale", conflicts_with = "psi")]
    depth_map: Option<PathBuf>,

    /// Depths NEAR:FAR of white and black of the depth map: two values of ψ (radians), or two distances as in 0.7m:3m. With
    /// --map-unit, limits: nearer and farther pixels are taken to be at the limits
    #[arg(long, value_name = "NEAR:FAR", requires = "depth_map", allow_hyphen_values = true)]
    range: Option<DepthRange>,

    /// Meaning of the depth map's values: nearness (proportional to ψ, that is to one over the distance; white is NEAR), or
    /// distance (black is NEAR, white is FAR), as range finders and renderers give it; with --map-unit always distance
    #[arg(long, value_enum, default_value_t = MapOf::Nearness, value_name = "KIND")]
    map_of: MapOf,

    /// Unit of the depth map's values, which are distances then: mm, cm or m, or a multiple as in 0.2mm. 0 and 65535 are pixels without
    /// a reading; each takes the nearest reading. The camera must state nominal_m, or give --nominal
    #[arg(long, value_name = "UNIT", requires = "depth_map")]
    map_unit: Option<Unit>,

    /// Largest number of layers that the photograph is cut into
    #[arg(long, default_value_t = layers::USUAL, value_name = "N")]
    layers: usize,

    /// Bits per pixel of the sensor, 8 to 16
    #[arg(long = "bit-depth", alias = "depth", default_value_t = 12, value_name = "BITS")]
    depth: u32,

    /// Colour filters of the first two pixels of the first two rows: rggb, grbg, gbrg or bggr
    #[arg(long, default_value = "rggb", value_name = "CFA")]
    phase: CfaPhase,

    /// Noise: none, the standard deviation of Gaussian noise in units of full scale, or sensor, the photon and read noise of
    /// a sensor (10000 electrons of full well, 2.5 of read noise, gain 1 unless said otherwise, as in
    /// sensor:full-well=6000:read-noise=1.8:gain=4)
    #[arg(long, default_value_t = Noise::None, value_name = "NOISE", allow_hyphen_values = true)]
    noise: Noise,

    /// Sensor value of darkness
    #[arg(long, default_value_t = 0, value_name = "LEVEL")]
    black_level: u16,

    /// Share of the energy that a cut kernel keeps, more than 0 and at most 1
    #[arg(long, default_value_t = 0.999, value_name = "SHARE")]
    energy: f64,

    /// Share of the energy that may be misplaced by sampling a spectrum at few wavelengths
    #[arg(long, default_value_t = 0.01, value_name = "SHARE")]
    wavelength_tolerance: f64,

    /// Layers whose ψ differ by at most this value, in radians, share one kernel
    #[arg(long, default_value_t = 0.0, value_name = "PSI")]
    depth_tolerance: f64,

    /// No approximation
    #[arg(long, conflicts_with = "measure")]
    exact: bool,

    /// Compare each approximation with an exact computation; print its error of the light and the time saved
    #[arg(long)]
    measure: bool,

    /// Accepted for older scripts; changes nothing
    #[arg(long, hide = true, conflicts_with = "measure")]
    no_measure: bool,

    /// Also write the frame as video for a playout card, which sends it to the board: bytes Cb Y Cr Y without a header (2vuy). Each
    /// byte has seven of the upper 14 bits of a word, plus 64; the black level is subtracted first. FILE.json states how it was taken
    #[arg(long, value_name = "FILE")]
    video: Option<PathBuf>,

    /// What the words of --video stand for, as the board's network takes them: linear (light) or srgb (encoded light)
    #[arg(long, default_value_t = Tone::Linear, value_name = "TONE")]
    values: Tone,

    /// Also write the sharp ground truth, 16 bits
    #[arg(long, value_name = "FILE")]
    sharp: Option<PathBuf>,

    /// Also write the light on the sensor before its colour filters, 16 bits
    #[arg(long, value_name = "FILE")]
    light: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  edof capture photo.jpg --depth-map depth.png --range 8:0 --out raw.png
  edof capture photo.jpg --depth-map millimetres.png --map-unit mm --nominal 3 --out raw.png
  edof capture photo.png --camera ring-outer --psi 8 --out raw.png
  edof capture scene.json --out raw.png
  edof capture photo.png --psf-bank lens.npz --psi 4 --out raw.png
  edof capture chart-4 --noise sensor:gain=8 --out raw.pgm --sharp sharp.png
  edof capture photo.png --out raw.png --video frame.2vuy
  edof capture photo.png --tone linear --noise 0.01 --psi 8 --out raw.png
  edof capture leaves --psi 6 --noise sensor:gain=4 --bit-depth 10 --out raw.png --exact";

#[derive(Serialize)]
struct Captured {
    scene: String,
    camera: String,
    width: usize,
    height: usize,
    psi: Vec<f64>,
    tone: Tone,
    noise: Noise,
    depths: Vec<edof_optics::capture::Depth>,
    seconds: f64,
    approximations: Vec<ApproximationCost>,
    out: String,
}

/// # Errors
/// A photograph that cannot be read or has an odd side, depths or a sensor that cannot be, a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    raw::check_ending(&args.out)?;
    let Lens { camera, files } = lens::resolve(&args.camera, args.psf_bank.as_deref())?;
    let camera = args.drawing.before(camera)?;
    let listed = args.listed()?;
    args.files(listed.as_ref(), files, ui)?.check()?;
    let sensor = Sensor {
        depth: args.depth,
        phase: args.phase,
        noise: args.noise,
        seed: args.drawing.seed,
        black_level: args.black_level,
    };
    sensor.check().map_err(of_sensor)?;
    let (scene, tone) = match listed {
        Some(file) => file.scene(args.tone, &camera, ui)?,
        None => open(&args, &camera, ui)?,
    };
    let approximation = args.approximation()?;
    let progress = ui.progress(1, "capture");
    let told = |before: usize| {
        let progress = &progress;
        move |done: usize, of: usize, next: &str| {
            progress.message(next);
            progress.of((before + done) as u64, (before + of) as u64);
        }
    };
    let taken = capture_told(&scene, &camera, &sensor, &approximation, told(0));
    let shot = taken.map_err(|e| args.of_scene(&e))?;
    let steps = shot.depths.len() + 1;
    raw::save(&args.out, &shot.raw)?;
    let record = record_of(&args, &camera, &scene, tone, &shot.raw, ui);
    record::save(&args.out, &record)?;
    if let Some(path) = &args.video {
        save_video(path, args.values, &record, &shot.raw)?;
    }
    if let Some(path) = &args.sharp {
        photo::save(path, &tone.encoded(&scene.sharp()), 16)?;
    }
    if let Some(path) = &args.light {
        photo::save(path, &tone.encoded(&shot.light), 16)?;
    }
    // A bank's kernels are used as they are: nothing is approximated.
    let costs = if !args.measure || args.exact || args.no_measure || camera.psf_bank.is_some() {
        vec![]
    } else {
        measure_approximation_told(&scene, &camera, &approximation, told(steps))?
    };
    progress.finish();
    tell(&scene, &camera, &shot, &costs, ui)?;
    let (height, width) = scene.size();
    let psi = scene.layers.iter().map(|layer| layer.psi).collect();
    let Capture { depths, seconds, .. } = shot;
    let (scene, camera, noise, out) = (scene.name, camera.name, args.noise, args.out.display().to_string());
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

/// A failure of the sensor's options, by their names.
fn of_sensor(error: SensorError) -> Error {
    match error {
        SensorError::Frame(FrameError::Depth(bits)) => {
            Error::message(format!("--bit-depth {bits}: must be 8 to 16"))
        }
        SensorError::Black { black, full, depth } => Error::message(format!(
            "--black-level {black}: must be less than {full}, for a sensor of --bit-depth {depth} bits"
        )),
        error => error.into(),
    }
}

/// Writes a frame for a playout card, and its record: in the values of the board's network, without a black level, which no board takes off.
fn save_video(path: &Path, values: Tone, record: &RawRecord, frame: &RawFrame) -> Result<(), Error> {
    let levels = Levels { black: record.black_level, white: record.white_level };
    let sent = levels.light(frame).map(|light| cable::carried(&light.encoded(values)));
    let sent = sent.map_err(|e| Error::message(e.to_string()))?;
    raw::save_video(path, &sent)?;
    let record = RawRecord {
        depth: sent.depth(),
        alignment: Alignment::Top,
        video: Some(Size::of(&sent)),
        black_level: Black::default(),
        white_level: None,
        values,
        sha256: Input::raw_frame("", &sent).sha256,
        ..record.clone()
    };
    Ok(record::save(path, &record)?)
}

/// What the raw frame cannot say of itself.
fn record_of(
    args: &Args,
    camera: &Camera,
    scene: &Scene,
    tone: Tone,
    frame: &RawFrame,
    ui: &Ui,
) -> RawRecord {
    ui.used(camera.input());
    RawRecord {
        phase: frame.phase(),
        depth: frame.depth(),
        alignment: record::alignment_of(&args.out),
        video: None,
        black_level: args.black_level.into(),
        white_level: None,
        white_balance: None,
        colour_matrix: None,
        camera: camera.clone(),
        psi: scene.layers.iter().map(|layer| layer.psi).collect(),
        tone,
        values: Tone::Linear,
        noise: args.noise,
        sha256: Input::raw_frame(&scene.name, frame).sha256,
        provenance: ui.provenance().for_file(),
    }
}

/// A built-in scene by its name, or a photograph; and the tone of its pictures.
fn open(args: &Args, camera: &Camera, ui: &Ui) -> Result<(Scene, Tone), Error> {
    if parse_name(&args.scene).is_ok() && !Path::new(&args.scene).exists() {
        if let Some(map) = &args.depth_map {
            return Err(Error::message(format!(
                "--depth-map {}: {} is a built-in scene with its own depths; only photographs accept a depth map",
                map.display(),
                args.scene
            )));
        }
        return Ok((args.drawing.draw(&args.scene, camera)?, args.tone.unwrap_or(Tone::Srgb)));
    }
    if let Some(size) = args.drawing.size {
        return Err(Error::message(format!(
            "--size {size}: a photograph has its own size; the option is for built-in scenes"
        )));
    }
    let path = Path::new(&args.scene);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(map) = &args.depth_map {
        return layered(args, name, map, camera, ui);
    }
    if let Some(range) = args.range {
        return Err(Error::message(format!(
            "--range {range}: is of a depth map; add --depth-map, or omit --range"
        )));
    }
    if let Some(unit) = args.map_unit {
        return Err(Error::message(format!(
            "--map-unit {unit}: is of a depth map; add --depth-map, or omit --map-unit"
        )));
    }
    let [psi] = args.drawing.psis(camera)?[..] else {
        return Err(Error::message(
            "--psi: expected one value, because a photograph is at one depth; or use --depth-map",
        ));
    };
    let (photograph, tone) = pictures::load(path, args.tones(), ui)?;
    let (height, width) = photograph.size();
    fits(width, height)?;
    ui.used(Input::photograph(&name, &photograph));
    Ok((Scene::flat(name, tone.into_decoded(photograph), psi), tone))
}

/// A photograph with a depth map, and the tone of its values.
fn layered(args: &Args, name: String, map: &Path, camera: &Camera, ui: &Ui) -> Result<(Scene, Tone), Error> {
    let depths = DepthMap::load(map, args.map_of, args.map_unit, args.range)?;
    let photograph = photo::load(Path::new(&args.scene))?;
    if depths.dim() != photograph.size() {
        let ((height, width), (rows, columns)) = (depths.dim(), photograph.size());
        return Err(Error::message(format!(
            "{}: {width}x{height}, expected {columns}x{rows} as {}",
            map.display(),
            args.scene
        )));
    }
    let (height, width) = pictures::whole_cells(photograph.size());
    layers::check(args.layers).map_err(|e| Error::message(format!("--{e}")))?;
    let job = format!("{width}x{height} in --layers {}", args.layers);
    memory::check(&job, scene_file::bytes_a_pixel(args.layers) * (width * height) as f64)?;
    let (photograph, tone) = pictures::load(Path::new(&args.scene), args.tones(), ui)?;
    ui.used(Input::photograph(&name, &photograph));
    ui.used(Input::photograph("depth map", &ColourFrame { planes: depths.shares().insert_axis(Axis(0)) }));
    let psi = depths.psis(map, camera, ui)?.slice_move(s![..height, ..width]);
    let scene = layers::from_depths(&name, &tone.into_decoded(photograph), &psi, args.layers);
    Ok((scene.map_err(|e| said::of_file(map, e))?, tone))
}

impl Args {
    /// The user's tone, or sRGB where neither the user nor the file states another.
    const fn tones(&self) -> Tones {
        Tones { given: self.tone, usual: Tone::Srgb }
    }

    /// What is read and written.
    fn files(&self, listed: Option<&ListedScene>, lens: Vec<PathBuf>, ui: &Ui) -> Result<Files, Error> {
        let mut files = Files::new(ui)
            .reads(&self.scene)
            .reads_all(listed.into_iter().flat_map(ListedScene::files))
            .reads_all(&self.depth_map)
            .reads_all(lens)
            .writes("--out", &self.out);
        files = files.writes("the record beside --out", record::path_of(&self.out));
        files = files
            .may_write("--video", self.video.as_ref())
            .may_write("the record beside --video", self.video.as_deref().map(record::path_of));
        for (option, file) in [("--sharp", &self.sharp), ("--light", &self.light)] {
            if let Some(file) = file {
                files = files.writes_picture(option, file)?;
            }
        }
        Ok(files)
    }

    /// A failure of a scene that is in a file, by the file's name.
    fn of_scene(&self, error: &CaptureError) -> Error {
        if Path::new(&self.scene).exists() {
            return said::of_file(&self.scene, error);
        }
        Error::message(error.to_string())
    }

    /// The layers of a scene that a file lists; what only photographs and synthetic scenes have is rejected.
    fn listed(&self) -> Result<Option<ListedScene>, Error> {
        if !scene_file::is_scene_file(&self.scene) {
            return Ok(None);
        }
        let given = [
            ("--psi", !self.drawing.psi.is_empty()),
            ("--depth-map", self.depth_map.is_some()),
            ("--size", self.drawing.size.is_some()),
        ];
        if let Some((option, _)) = given.into_iter().find(|(_, given)| *given) {
            return Err(Error::message(format!("{option}: {} says it for each of its layers", self.scene)));
        }
        ListedScene::load(Path::new(&self.scene)).map(Some)
    }

    fn approximation(&self) -> Result<Approximation, Error> {
        if self.exact {
            return Ok(Approximation::exact());
        }
        let wavelength_tolerance = self.wavelength_tolerance;
        let psf = Settings { energy: self.energy, wavelength_tolerance, exact: false };
        let approximation = Approximation { psf, depth_tolerance: self.depth_tolerance };
        approximation.check().map_err(|e| Error::message(format!("--{e}")))?;
        Ok(approximation)
    }
}

fn tell(
    scene: &Scene,
    camera: &Camera,
    shot: &Capture,
    costs: &[ApproximationCost],
    ui: &Ui,
) -> Result<(), Error> {
    let (height, width) = scene.size();
    let depths = count(shot.depths.len(), "depth");
    ui.say(format!("{}: {width}x{height}, {depths}, {:.2} s", scene.name, shot.seconds))?;
    for depth in &shot.depths {
        let metres = camera.nominal_m.and_then(|nominal| distance_m(camera, depth.psi, nominal));
        let metres = metres.map_or(String::new(), |metres| format!(", {metres:.2} m"));
        for (channel, kernel) in ["red", "green", "blue"].into_iter().zip(&depth.channels) {
            ui.say(format!("  psi {:5.2}{metres} {channel:5}: {}", depth.psi, blur_in_words(kernel)))?;
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

/// How large a blur is, and what was left out of it.
fn blur_in_words(kernel: &Kernel) -> String {
    let side = kernel.side;
    if kernel.wavelengths == 0 {
        return format!("blur of {side}x{side} pixels from the PSF bank");
    }
    let wavelengths = match kernel.wavelengths {
        1 => "one wavelength".to_owned(),
        count => format!(
            "{count} wavelengths (with a third of them {:.2} % of the light would fall elsewhere)",
            100.0 * kernel.wavelength_error
        ),
    };
    format!(
        "blur of {side}x{side} pixels has {:.2} % of the light (about {:.2} % falls outside of the computed radius of {} pixels); {wavelengths}",
        100.0 * kernel.energy_kept,
        100.0 * kernel.energy_beyond,
        kernel.support / 2
    )
}
