//! `edof capture`.

use crate::advice;
use crate::commands::scene::Drawing;
use crate::error::Error;
use crate::files::Files;
use crate::lens::{self, Depth, DepthRange, Lens};
use crate::limits::all_within;
use crate::pictures;
use crate::psf_bank::{self, BankOptions};
use crate::said;
use crate::ui::Ui;
use edof::job::{
    CaptureJob, CaptureOutputs, Captured, DepthMap, JobError, ListedScene, Meaning, Scale, SceneSource,
    VideoOutput,
};
use edof_core::camera::Camera;
use edof_core::frame::FrameError;
use edof_core::words::{count, number};
use edof_core::{CfaPhase, Noise, Tone};
use edof_io::raw;
use edof_io::record;
use edof_optics::capture::{Approximation, Kernel};
use edof_optics::depth_map::Unit;
use edof_optics::distance_m;
use edof_optics::draw::parse_name;
use edof_optics::layers;
use edof_optics::psf::Settings;
use edof_optics::{Sensor, SensorError};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Simulate the raw Bayer frame that a camera gives of a photograph or a built-in scene
///
/// A photograph is at one depth (--psi), or a depth map states the depth of each pixel. With a depth map the photograph is cut into layers, and
/// the part hidden behind a near object is inpainted. A JSON file lists a scene of several layers from back to front, each a picture with
/// a matte at a depth (docs/your-own-lens.md).
///
/// ψ (--psi) is the defocus in radians: 0 in the plane of focus of a clear lens, the far end of the presets' range; 8 at the near end of an open lens.
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

    #[arg(long, value_name = "FILE", help = format!("Raw frame to write: {}; FILE.json states how it was taken", raw::written()))]
    out: PathBuf,

    /// Camera: a preset (clear, clear-mid, clear-closed, ring-2015, ring-2018, ring-depth-2018, ring-outer) or a JSON file
    #[arg(long, default_value = lens::DEFAULT, value_name = "CAMERA")]
    camera: String,

    #[command(flatten)]
    bank: BankOptions,

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

    /// Focus in ψ of each exposure, in place of the camera's: 2,6 takes two raw frames of the static scene, OUT-1 and OUT-2, each with half of
    /// the time, so with half of the electrons of --noise, and read noise of its own. A network of 'edof train --focus' makes one
    /// picture of them [default: one exposure, the camera's focus]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "PSI,…")]
    focus: Vec<f64>,

    /// Bits per pixel of the sensor, 8 to 16
    #[arg(long = "bit-depth", alias = "depth", default_value_t = 12, value_name = "BITS")]
    depth: u32,

    /// Colour filters of the first two pixels of the first two rows: rggb, grbg, gbrg or bggr
    #[arg(long, default_value = "rggb", value_name = "CFA")]
    phase: CfaPhase,

    /// Noise: none, the standard deviation of Gaussian noise in units of full scale, or sensor, the photon and read noise of
    /// a sensor (10000 electrons of full well, 2.5 of read noise, gain 1 unless said otherwise, as in
    /// sensor:full-well=6000:read-noise=1.8:gain=4). White has full-well/gain electrons; --gain of edof train, reconstruct and stream is 10000 divided by them: 6000 electrons of full
    /// well at 6 dB are sensor:full-well=6000:gain=2 here, --gain 3.33 there
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

    /// Write --video for a PC's graphics card: two frames of RGB, 8 bits per colour, without a header, in the greys of this file of 'edof board
    /// calibrate read'. Carries the upper 13 bits of a word (docs/bring-up.md)
    #[arg(long, value_name = "FILE", requires = "video")]
    grey: Option<PathBuf>,

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

/// What the values of a depth map are proportional to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum MapOf {
    /// One over the distance, white nearest.
    Nearness,
    /// The distance, white farthest.
    Distance,
}

const EXAMPLES: &str = "\
Examples:
  edof capture photo.jpg --depth-map depth.png --range 8:0 --out raw.png
  edof capture photo.jpg --depth-map millimetres.png --map-unit mm --nominal 3 --out raw.png
  edof capture photo.png --camera ring-outer --psi 8 --out raw.png
  edof capture scene.json --out raw.png
  edof capture photo.png --psi 3 --camera clear-mid --focus 2,6 --out o.png   o-1.png and o-2.png
  edof capture photo.png --psf-bank lens.npz --psi 4 --out raw.png
  edof capture chart-4 --noise sensor:gain=8 --out raw.pgm --sharp sharp.png
  edof capture photo.png --out raw.png --video frame.2vuy
  edof capture photo.png --out raw.png --video frame.rgb --grey card.json
  edof capture photo.png --tone linear --noise 0.01 --psi 5 --out raw.png
  edof capture leaves --psi 5 --noise sensor:gain=4 --bit-depth 10 --out raw.png --exact";

/// # Errors
/// A photograph that cannot be read or has an odd side, depths or a sensor that cannot be, a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let jobs = args.jobs(ui)?;
    let shots = jobs.iter().map(|job| args.shot(job, ui)).collect::<Result<Vec<_>, _>>()?;
    if let [job] = &jobs[..] {
        // A second exposure is no question of the lens.
        advice::note(&job.camera, job.sensor.noise, ui);
    }
    psf_bank::remark(&jobs[0].camera, ui);
    if let Noise::Sensor(sensor) = jobs[0].sensor.noise {
        ui.say(format!(
            "noise: white has {} electrons; that is --gain {} of edof train, reconstruct and stream",
            number(sensor.full_scale_e().round()),
            number((1e3 * sensor.reference_gain()).round() / 1e3)
        ))?;
    }
    match &shots[..] {
        [one] => ui.json(one),
        all => ui.json(&json!({ "frames": all })),
    }
}

impl Args {
    /// Takes a raw frame.
    fn shot(&self, job: &CaptureJob, ui: &Ui) -> Result<Captured, Error> {
        let progress = ui.progress(1, "capture");
        let step = |done: usize, of: usize, next: &str| {
            progress.message(next);
            progress.of(done as u64, of as u64);
        };
        // The scene is the same one in each exposure.
        let is_first = job.exposure.is_none_or(|exposure| exposure.number == 1);
        let note = |note| {
            if is_first {
                ui.note(pictures::in_words(&note));
            }
        };
        let captured = job.run(&note, step).map_err(|e| self.failed(e))?;
        progress.finish();
        captured.inputs.iter().for_each(|input| ui.used(input.clone()));
        tell(&captured, &job.camera, ui)?;
        Ok(captured)
    }

    /// A job for each exposure.
    fn jobs(&self, ui: &Ui) -> Result<Vec<CaptureJob>, Error> {
        all_within("--focus", &self.focus, -100.0, 100.0)?;
        let job = self.job(ui)?;
        if self.focus.is_empty() {
            return Ok(vec![job]);
        }
        let given: Vec<String> = self.focus.iter().map(|psi| number(*psi)).collect();
        job.exposures(&self.focus).map_err(|e| Error::message(format!("--focus {}: {e}", given.join(","))))
    }

    /// The job of these options, checked; nothing is read of it but the camera and a list of layers.
    fn job(&self, ui: &Ui) -> Result<CaptureJob, Error> {
        raw::writer(&self.out)?;
        let Lens { camera, files } = lens::resolve(&self.camera, self.bank.file())?;
        let camera = self.drawing.before(camera)?;
        let listed = self.listed()?;
        self.files(listed.as_ref(), files, ui)?.check()?;
        Ok(CaptureJob {
            sensor: self.sensor()?,
            exposure: None,
            scene: listed.map_or_else(|| self.scene(&camera), |listed| Ok(SceneSource::Listed(listed)))?,
            approximation: self.approximation()?,
            camera,
            tone: self.tone,
            is_measured: self.measure && !self.exact && !self.no_measure,
            outputs: self.outputs(),
            provenance: ui.provenance().for_file(),
        })
    }

    /// Files of one exposure, or those of which each exposure has its own.
    fn outputs(&self) -> CaptureOutputs {
        CaptureOutputs {
            raw: self.out.clone(),
            video: self.video_output(),
            sharp: self.sharp.clone(),
            light: self.light.clone(),
        }
    }

    fn video_output(&self) -> Option<VideoOutput> {
        let (path, greys) = (self.video.clone()?, self.grey.clone());
        Some(VideoOutput { path, values: self.values, greys })
    }

    fn sensor(&self) -> Result<Sensor, Error> {
        let sensor = Sensor {
            depth: self.depth,
            phase: self.phase,
            noise: self.noise,
            seed: self.drawing.seed,
            black_level: self.black_level,
        };
        sensor.check().map_err(|error| match error {
            SensorError::Frame(FrameError::Depth(bits)) => {
                Error::message(format!("--bit-depth {bits}: must be 8 to 16"))
            }
            SensorError::Black { black, full, depth } => Error::message(format!(
                "--black-level {black}: must be less than {full}, for a sensor of --bit-depth {depth} bits"
            )),
            error => error.into(),
        })?;
        Ok(sensor)
    }

    /// A built-in scene by its name, or a photograph.
    fn scene(&self, camera: &Camera) -> Result<SceneSource, Error> {
        let path = PathBuf::from(&self.scene);
        if parse_name(&self.scene).is_ok() && !path.exists() {
            if let Some(map) = &self.depth_map {
                return Err(Error::message(format!(
                    "--depth-map {}: {} is a built-in scene with its own depths; only photographs accept a depth map",
                    map.display(),
                    self.scene
                )));
            }
            return Ok(SceneSource::Synthetic(self.drawing.scene(&self.scene, camera)?));
        }
        if let Some(size) = self.drawing.size {
            return Err(Error::message(format!(
                "--size {size}: a photograph has its own size; the option is for built-in scenes"
            )));
        }
        if let Some(file) = &self.depth_map {
            layers::check(self.layers).map_err(|e| Error::message(format!("--{e}")))?;
            let map = DepthMap { file: file.clone(), meaning: self.meaning(camera)? };
            return Ok(SceneSource::Deep { path, map, layers: self.layers });
        }
        let of_map = |option: &str, value: &dyn std::fmt::Display| {
            Error::message(format!(
                "--{option} {value}: is of a depth map; add --depth-map, or omit --{option}"
            ))
        };
        if let Some(range) = self.range {
            return Err(of_map("range", &range));
        }
        if let Some(unit) = self.map_unit {
            return Err(of_map("map-unit", &unit));
        }
        match self.drawing.psis(camera)?[..] {
            [psi] => Ok(SceneSource::Photograph { path, psi }),
            _ => Err(Error::message(
                "--psi: expected one value, because a photograph is at one depth; or use --depth-map",
            )),
        }
    }

    /// What the values of the depth map stand for.
    fn meaning(&self, camera: &Camera) -> Result<Meaning, Error> {
        let of_range = |e| Error::message(format!("--range {e}"));
        match (self.map_unit, self.range) {
            // Without a nominal distance no distance is known; the map's own are named then.
            (Some(unit), limits) => {
                let known = limits.filter(|_| camera.nominal_m.is_some());
                known.map_or(Ok([0.0; 2]), |range| range.psi(camera)).map_err(of_range)?;
                Ok(Meaning::Steps { unit, limits })
            }
            (None, Some(range)) => {
                let [near, far] = range.ends(camera).map_err(of_range)?;
                match (self.map_of, range.near, range.far) {
                    (MapOf::Nearness, ..) => Ok(Meaning::Shares(Scale::Nearness { near, far })),
                    (MapOf::Distance, Depth::Metres(near), Depth::Metres(far)) if far.is_finite() => {
                        Ok(Meaning::Shares(Scale::Distance { near, far }))
                    }
                    _ => {
                        Err(Error::message("--map-of distance: --range must be two distances, as in 0.7m:3m"))
                    }
                }
            }
            (None, None) => Err(Error::message("--depth-map: add --range or --map-unit")),
        }
    }

    /// What is read and written.
    fn files(&self, listed: Option<&ListedScene>, lens: Vec<PathBuf>, ui: &Ui) -> Result<Files, Error> {
        let mut files = Files::new(ui)
            .reads(&self.scene)
            .reads_all(listed.into_iter().flat_map(ListedScene::files))
            .reads_all(&self.depth_map)
            .reads_all(&self.grey)
            .reads_all(lens);
        let of = self.focus.len().max(1);
        let exposures: Vec<_> = (1..=of).map(|number| self.outputs().of_exposure(number, of)).collect();
        for CaptureOutputs { raw, .. } in &exposures {
            files = files.writes("--out", raw).writes("the record beside --out", record::path_of(raw));
        }
        files = files
            .may_write("--video", self.video.as_ref())
            .may_write("the record beside --video", self.video.as_deref().map(record::path_of));
        for (option, file) in
            exposures.iter().flat_map(|own| [("--sharp", &own.sharp), ("--light", &own.light)])
        {
            if let Some(file) = file {
                files = files.writes_picture(option, file)?;
            }
        }
        Ok(files)
    }

    /// A failure of the job, by the option or the file that it is about.
    fn failed(&self, error: JobError) -> Error {
        match error {
            JobError::Capture(error) if Path::new(&self.scene).exists() => said::of_file(&self.scene, error),
            JobError::Layers { size, layers, source } => {
                Error::message(format!("{size} in --layers {layers}: {source}"))
            }
            error => self.drawing.failed(error),
        }
    }

    /// The layers of a scene that a file lists; what only photographs and synthetic scenes have is rejected.
    fn listed(&self) -> Result<Option<ListedScene>, Error> {
        if !ListedScene::is_named(Path::new(&self.scene)) {
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
        Ok(Some(ListedScene::load(Path::new(&self.scene))?))
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

/// Depths whose blurs are printed; of more, the first and the last are.
const SHOWN_DEPTHS: usize = 4;

fn tell(captured: &Captured, camera: &Camera, ui: &Ui) -> Result<(), Error> {
    let Captured { scene, width, height, seconds, .. } = captured;
    if let Some(exposure) = captured.exposure {
        ui.say(format!("{}: {exposure}, focus at psi {}", captured.out, number(camera.focus_psi)))?;
    }
    let depths = count(captured.depths.len(), "depth");
    ui.say(format!("{scene}: {width}x{height}, {depths}, {seconds:.2} s"))?;
    let [low, high] = camera.psi_range;
    let outside = captured.depths.iter().filter(|depth| !(low - 1e-6..=high + 1e-6).contains(&depth.psi));
    if let Some(depth) = outside.map(|depth| depth.psi).max_by(|a, b| a.abs().total_cmp(&b.abs())) {
        ui.note(format!(
            "psi {depth:.2}: is outside of {}'s range, {low:.2} to {high:.2}, which networks for it are trained for",
            camera.name
        ));
    }
    let (first, last) = (captured.depths.first(), captured.depths.last());
    let ends = [first, last.filter(|_| captured.depths.len() > 1)].into_iter().flatten();
    let left_out = captured.depths.len().saturating_sub(SHOWN_DEPTHS);
    let shown: Vec<_> = if left_out == 0 { captured.depths.iter().collect() } else { ends.collect() };
    for depth in shown {
        let metres = camera.nominal_m.and_then(|nominal| distance_m(camera, depth.psi, nominal));
        let metres = metres.map_or(String::new(), |metres| format!(", {metres:.2} m"));
        for (channel, kernel) in ["red", "green", "blue"].into_iter().zip(&depth.channels) {
            ui.say(format!("  psi {:5.2}{metres} {channel:5}: {}", depth.psi, blur_in_words(kernel)))?;
        }
    }
    if left_out > 0 {
        ui.say(format!(
            "  and {} between them; --json has the blur of each",
            count(captured.depths.len() - 2, "depth")
        ))?;
    }
    for cost in &captured.approximations {
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
        let offset = psf_bank::offset(kernel.centroid);
        return format!("blur of {side}x{side} pixels from the PSF bank, centroid {offset}");
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
