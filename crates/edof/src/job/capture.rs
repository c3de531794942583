//! From a scene in files to a raw frame in files.

use super::depth_map::DepthMap;
use super::error::JobError;
use super::greys::GreyFile;
use super::listed::{ListedScene, bytes_a_pixel, check_size};
use super::memory;
use super::note::PictureNote;
use super::photograph::{self, Tones, whole_cells};
use edof_core::camera::Camera;
use edof_core::storage::atomic;
use edof_core::storage::provenance::{Input, Provenance};
use edof_core::{ColourFrame, Noise, RawFrame, Tone, cable};
use edof_golden::video::grey;
use edof_golden::video::greys::Greys;
use edof_io::levels::{Black, Levels};
use edof_io::photo;
use edof_io::raw::{self, Alignment, Size};
use edof_io::record::{self, Exposure, RawRecord};
use edof_optics::Scene;
use edof_optics::Sensor;
use edof_optics::capture::{
    Approximation, ApproximationCost, Capture, Depth, capture_told, measure_approximation_told,
};
use edof_optics::draw::{Builtin, draw};
use edof_optics::layers;
use ndarray::{Axis, s};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A capture: what is taken, by which camera, and which files are written.
///
/// ```
/// use edof::core::storage::provenance::Provenance;
/// use edof::io::raw::Size;
/// use edof::job::{CaptureJob, CaptureOutputs, SceneSource, Synthetic};
/// use edof::optics::{capture::Approximation, draw::Builtin, Sensor};
/// use edof::presets::lens;
/// let folder = tempfile::tempdir()?;
/// let raw = folder.path().join("raw.png");
/// let job = CaptureJob {
///     scene: SceneSource::Synthetic(Synthetic {
///         kind: Builtin::Chart,
///         size: Size { width: 96, height: 64 },
///         psi: vec![4.0],
///         seed: 0,
///     }),
///     camera: lens::resolve("ring-outer", None)?.camera,
///     tone: None,
///     sensor: Sensor::default(),
///     exposure: None,
///     approximation: Approximation::default(),
///     is_measured: false,
///     outputs: CaptureOutputs::raw(raw.clone()),
///     provenance: Provenance::default(),
/// };
/// let captured = job.run(&|note| println!("{note:?}"), |_, _, _| ())?;
/// assert_eq!((captured.width, captured.depths.len()), (96, 1));
/// assert!(raw.exists() && edof::io::record::load(&raw)?.record().is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CaptureJob {
    /// What is before the camera.
    pub scene: SceneSource,
    /// The camera.
    pub camera: Camera,
    /// Tone of pictures, read and written; by default what a photograph's file states, else sRGB.
    pub tone: Option<Tone>,
    /// The sensor.
    pub sensor: Sensor,
    /// Place among exposures that share the exposure time; [`CaptureJob::exposures`] makes them.
    pub exposure: Option<Exposure>,
    /// What is approximated.
    pub approximation: Approximation,
    /// Whether each approximation is compared with an exact computation.
    pub is_measured: bool,
    /// Files to write.
    pub outputs: CaptureOutputs,
    /// How the frame is made, but for its inputs.
    pub provenance: Provenance,
}

/// A scene, and where it comes from.
#[derive(Debug, Clone)]
pub enum SceneSource {
    /// A built-in scene.
    Synthetic(Synthetic),
    /// A photograph at one depth.
    Photograph {
        /// Its file.
        path: PathBuf,
        /// Its ψ.
        psi: f64,
    },
    /// A photograph with the depth of each pixel.
    Deep {
        /// Its file.
        path: PathBuf,
        /// Its depths.
        map: DepthMap,
        /// Largest number of layers that it is cut into.
        layers: usize,
    },
    /// Pictures with mattes and depths.
    Listed(ListedScene),
}

/// A built-in scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Synthetic {
    /// Which one.
    pub kind: Builtin,
    /// Columns and rows.
    pub size: Size,
    /// ψ of its one depth, or of four from back to front.
    pub psi: Vec<f64>,
    /// Seed of its random numbers.
    pub seed: u64,
}

impl Synthetic {
    /// Draws the scene.
    ///
    /// # Errors
    /// [`JobError::Memory`] or [`JobError::Draw`].
    pub fn draw(&self) -> Result<Scene, JobError> {
        let Size { width, height } = self.size;
        check_memory(width, height)?;
        Ok(draw(self.kind, height, width, &self.psi, self.seed)?)
    }
}

/// Files that a capture writes.
#[derive(Debug, Clone)]
pub struct CaptureOutputs {
    /// The raw frame; its record is written beside it.
    pub raw: PathBuf,
    /// The frame as video for the board, with its record.
    pub video: Option<VideoOutput>,
    /// The sharp ground truth.
    pub sharp: Option<PathBuf>,
    /// The light on the sensor.
    pub light: Option<PathBuf>,
}

/// A frame as video for the board.
#[derive(Debug, Clone)]
pub struct VideoOutput {
    /// Its file.
    pub path: PathBuf,
    /// What its words stand for.
    pub values: Tone,
    /// The greys of a PC's graphics card ([`GreyFile`]); none is a playout card, which sends every byte as it is.
    pub greys: Option<PathBuf>,
}

impl CaptureOutputs {
    /// Returns the raw frame as the only output.
    #[must_use]
    pub const fn raw(raw: PathBuf) -> Self {
        Self { raw, video: None, sharp: None, light: None }
    }
}

/// What was captured.
#[derive(Debug, Clone, Serialize)]
pub struct Captured {
    /// Name of the scene.
    pub scene: String,
    /// Name of the camera.
    pub camera: String,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// ψ of each layer.
    pub psi: Vec<f64>,
    /// Tone of the pictures.
    pub tone: Tone,
    /// The sensor's noise.
    pub noise: Noise,
    /// Place among exposures that share the exposure time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<Exposure>,
    /// Depths that were computed.
    pub depths: Vec<Depth>,
    /// Wall-clock seconds for PSFs and blur.
    pub seconds: f64,
    /// What approximations cost, if they were measured.
    pub approximations: Vec<ApproximationCost>,
    /// File of the raw frame.
    pub out: String,
    /// What was read.
    #[serde(skip)]
    pub inputs: Vec<Input>,
}

impl CaptureJob {
    /// Reads the scene, captures it and writes the files. `progress` is called before each step: how many are done, of how many, and which
    /// is next.
    ///
    /// # Errors
    /// A scene that cannot be read or taken, a file that cannot be written.
    pub fn run(
        &self,
        note: &(dyn Fn(PictureNote) + Sync),
        mut progress: impl FnMut(usize, usize, &str),
    ) -> Result<Captured, JobError> {
        let alignment = raw::writer(&self.outputs.raw).map_err(raw::RawError::from)?.alignment;
        let greys = self.outputs.video.as_ref().and_then(|video| video.greys.as_deref());
        let greys = greys.map(GreyFile::load).transpose()?;
        let (scene, tone, mut inputs) = self.open(note)?;
        inputs.push(self.camera.input());
        let shot = capture_told(&scene, &self.camera, &self.sensor, &self.approximation, &mut progress)?;
        let record = self.record(&scene, tone, &shot.raw, alignment, &inputs);
        self.save(&scene, tone, &shot, &record, greys.as_ref())?;
        let before = shot.depths.len() + 1;
        // A bank's kernels are used as they are: nothing is approximated.
        let approximations = if self.is_measured && self.camera.psf_bank.is_none() {
            measure_approximation_told(&scene, &self.camera, &self.approximation, |done, of, next| {
                progress(before + done, before + of, next);
            })?
        } else {
            vec![]
        };
        let (height, width) = scene.size();
        let psi = scene.layers.iter().map(|layer| layer.psi).collect();
        Ok(Captured {
            scene: scene.name,
            camera: self.camera.name.clone(),
            width,
            height,
            psi,
            tone,
            noise: self.sensor.noise,
            exposure: self.exposure,
            depths: shot.depths,
            seconds: shot.seconds,
            approximations,
            out: self.outputs.raw.display().to_string(),
            inputs,
        })
    }

    /// Returns the scene, the tone of its pictures, and what was read.
    fn open(&self, note: &(dyn Fn(PictureNote) + Sync)) -> Result<(Scene, Tone, Vec<Input>), JobError> {
        let tones = Tones { given: self.tone, usual: Tone::Srgb };
        match &self.scene {
            SceneSource::Synthetic(scene) => Ok((scene.draw()?, self.tone.unwrap_or(Tone::Srgb), vec![])),
            SceneSource::Photograph { path, psi } => {
                let (photograph, tone) = photograph::load(path, tones, note)?;
                let (height, width) = photograph.size();
                check_memory(width, height)?;
                let inputs = vec![Input::photograph(&stem(path), &photograph)];
                Ok((Scene::flat(stem(path), tone.into_decoded(photograph), *psi), tone, inputs))
            }
            SceneSource::Deep { path, map, layers } => self.layered(path, map, *layers, note),
            SceneSource::Listed(listed) => listed.scene(self.tone, &self.camera, note),
        }
    }

    fn layered(
        &self,
        path: &Path,
        map: &DepthMap,
        count: usize,
        note: &(dyn Fn(PictureNote) + Sync),
    ) -> Result<(Scene, Tone, Vec<Input>), JobError> {
        let depths = map.read()?;
        let size = photo::load(path)?.size();
        check_size(&map.file, depths.size(), depths.size(), path, size)?;
        let (height, width) = whole_cells(size);
        memory::check(bytes_a_pixel(count) * (width * height) as f64).map_err(|source| JobError::Layers {
            size: Size { width, height },
            layers: count,
            source,
        })?;
        let tones = Tones { given: self.tone, usual: Tone::Srgb };
        let (photograph, tone) = photograph::load(path, tones, note)?;
        let grey = ColourFrame { planes: depths.shares().insert_axis(Axis(0)) };
        let inputs = vec![Input::photograph(&stem(path), &photograph), Input::photograph("depth map", &grey)];
        let psi = depths.psis(&map.file, &self.camera, note)?.slice_move(s![..height, ..width]);
        let scene = layers::from_depths(&stem(path), &tone.into_decoded(photograph), &psi, count);
        Ok((scene.map_err(|e| JobError::in_file(&map.file, e))?, tone, inputs))
    }

    fn save(
        &self,
        scene: &Scene,
        tone: Tone,
        shot: &Capture,
        record: &RawRecord,
        greys: Option<&Greys>,
    ) -> Result<(), JobError> {
        let CaptureOutputs { raw, video, sharp, light } = &self.outputs;
        raw::save(raw, &shot.raw)?;
        record::save(raw, record)?;
        if let Some(video) = video {
            save_video(video, greys, record, &shot.raw)?;
        }
        if let Some(path) = sharp {
            photo::save(path, &tone.encoded(&scene.sharp()), 16)?;
        }
        if let Some(path) = light {
            photo::save(path, &tone.encoded(&shot.light), 16)?;
        }
        Ok(())
    }

    /// Returns what the raw frame cannot state of itself.
    fn record(
        &self,
        scene: &Scene,
        tone: Tone,
        frame: &RawFrame,
        alignment: Alignment,
        inputs: &[Input],
    ) -> RawRecord {
        let mut provenance = self.provenance.clone();
        provenance.inputs.extend_from_slice(inputs);
        RawRecord {
            phase: frame.phase(),
            depth: frame.depth(),
            alignment,
            video: None,
            size: raw::of_ending(&self.outputs.raw).filter(|f| f.is_headerless()).map(|_| Size::of(frame)),
            black_level: self.sensor.black_level.into(),
            white_level: None,
            white_balance: None,
            colour_matrix: None,
            camera: self.camera.clone(),
            psi: scene.layers.iter().map(|layer| layer.psi).collect(),
            tone,
            values: Tone::Linear,
            noise: self.sensor.noise,
            exposure: self.exposure,
            sha256: Input::raw_frame(&scene.name, frame).sha256,
            provenance,
        }
    }
}

/// Bytes per pixel that drawing, blurring and reconstructing a scene at four depths take: a generous guess, not a measurement.
const BYTES_A_PIXEL: f64 = 200.0;

/// Rejects a scene that this machine has no memory for.
///
/// # Errors
/// [`JobError::Memory`].
pub fn check_memory(width: usize, height: usize) -> Result<(), JobError> {
    memory::check(BYTES_A_PIXEL * width as f64 * height as f64)
        .map_err(|source| JobError::Memory { size: Size { width, height }, source })
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Writes a frame as video, and its record: in the values of the board's network, without a black level, which no board subtracts.
fn save_video(
    video: &VideoOutput,
    greys: Option<&Greys>,
    record: &RawRecord,
    frame: &RawFrame,
) -> Result<(), JobError> {
    let levels = Levels { black: record.black_level, white: record.white_level };
    let (path, values) = (&video.path, video.values);
    let light = levels.light(frame).map_err(|source| JobError::Levels { path: path.clone(), source })?;
    let words = light.encoded(values);
    let sent = greys.map_or_else(|| cable::carried(&words), |_| grey::carried(&words));
    match greys {
        None => raw::save_video(path, &sent)?,
        Some(greys) => atomic::write(path, &rgb(&sent, greys))?,
    }
    let record = RawRecord {
        depth: sent.depth(),
        alignment: Alignment::Top,
        // No program reads a frame back from its greys.
        video: greys.is_none().then(|| Size::of(&sent)),
        size: None,
        black_level: Black::default(),
        white_level: None,
        values,
        sha256: Input::raw_frame("", &sent).sha256,
        ..record.clone()
    };
    Ok(record::save(path, &record)?)
}

/// The two frames of video of a raw frame in grey: red, green and blue of each pixel.
fn rgb(frame: &RawFrame, greys: &Greys) -> Vec<u8> {
    let pictures = grey::halves(frame).map(|half| greys.picture(&half));
    pictures.iter().flatten().flat_map(|grey| [*grey; 3]).collect()
}
