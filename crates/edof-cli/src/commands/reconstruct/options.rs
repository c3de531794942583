//! Options of `edof reconstruct`.

use super::Scene;
use super::exposures::Foci;
use crate::error::Error;
use crate::lens::{self, BankFile, Lens};
use crate::raw_words::{self, PixelWord, Pixels};
use crate::said;
use clap::ValueEnum;
use edof::job::{Device, Engine, FixedOptions, FrameSource, ReconstructJob};
use edof_core::camera::Camera;
use edof_core::{DisplayMode, Stride, Tone};
use edof_deblur::Demosaicing;
use edof_golden::Curve;
use edof_io::levels::Black;
use edof_io::packing::{ByteOrder, Packing};
use edof_io::raw::{Alignment, RawOptions, Size};
use edof_io::record::Stated;
use edof_io::rendering::{ColourMatrix, Rendering, WhiteBalance};
use edof_io::sensor::Correction;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reconstruct a sharp picture from a raw Bayer frame, or one from each of several
///
/// A network of several exposures ('edof train --focus') makes one picture of as many frames of a static scene, which
/// 'edof capture --focus' takes; such a network is computed in floating point.
///
/// RAW is a 16-bit grey PNG, TIFF or PGM (values of fewer bits at the top of each word, or according to a PGM's maximum), NumPy's array of
/// sensor values (NPY), or a headerless file with --size. RAW.json, which 'edof capture' writes, states how the frame was taken; options that
/// contradict it are rejected. RAW may also be a camera's DNG (a Bayer mosaic, uncompressed or as lossless JPEG): its levels, defects, lens
/// corrections, white balance, colours, crop and orientation are applied, and options take the place of its tags (docs/dng.md). With the
/// optional feature camera-raw RAW may be a file of another maker. The network runs in the
/// board's integers unless --float is given. --demosaic makes the plain picture of the same frame.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof reconstruct raw.png --out sharp.png
  edof reconstruct raw.png --weights edof-t4w12 --float --stride 4 --out sharp.tif
  edof reconstruct frame.bin --size 1920x1080 --bit-depth 12 --phase gbrg --out sharp.png
  edof reconstruct night/*.png --out night-sharp/
  edof reconstruct o-1.png o-2.png --weights two.safetensors --out o.png   two exposures
  edof reconstruct raw.pgm --black-level 64 --white-level 4000 --white-balance 2.1,1,1.6 --out a.png
  edof reconstruct raw.png --board --out board.png     codes of the HDMI port, and a picture
  edof reconstruct --video frame.2vuy --size 1920x1080 --board --out board.png
  edof reconstruct raw.png --device gpu --out sharp.png
  edof reconstruct shot.dng --gain 8 --out sharp.png         the network for noisy frames
  edof reconstruct raw.png --demosaic malvar --out plain.png   without a network, to compare
  edof reconstruct raw.png --words words --json counters.json --out sharp.png")]
pub struct Args {
    /// Raw Bayer frames
    #[arg(required = true)]
    pub(super) raw: Vec<PathBuf>,

    /// Network: a name such as edof-t4w12-outer, or a weight file; it must have been trained for the camera that took RAW
    /// [default: the one for the lens that is stated, else edof-t4w12-clear-light, for linear pictures edof-t4w12-clear]
    #[arg(long, value_name = "NAME|FILE")]
    pub(super) weights: Option<String>,

    /// Camera that took RAW, a preset or a JSON file. A camera that contradicts RAW.json is rejected, and so is a network trained for
    /// another lens or mask
    #[arg(long)]
    pub(super) camera: Option<String>,

    /// PSF bank of the capture, as given to edof capture --psf-bank
    #[arg(long, value_name = "FILE", requires = "camera")]
    pub(super) psf_bank: Option<PathBuf>,

    /// The PSF bank is shifted, as by edof capture --centre
    #[arg(long, requires = "psf_bank")]
    pub(super) centre: bool,

    /// Gain of the sensor, up to 1000, where no RAW.json states the noise: the network of that noise is taken. It is 10000 divided by the electrons of white,
    /// and 1 where that is less [default: the network for most noises]
    #[arg(long, value_name = "GAIN")]
    pub(super) gain: Option<f64>,

    /// Demosaic the frame instead of running a network: malvar (linear filters) or directional (along edges). Levels, sensor correction, colours and tone are those
    /// of a network's picture
    #[arg(long, value_name = "METHOD", conflicts_with_all = ["weights", "gain", "fixed", "float", "stride", "board", "words"])]
    pub(super) demosaic: Option<Demosaicing>,

    /// Compute in the board's integers (the default)
    #[arg(long, conflicts_with = "float")]
    pub(super) fixed: bool,

    /// Compute in floating point
    #[arg(long)]
    pub(super) float: bool,

    /// Device that runs the network: cpu, gpu (the first OpenCL device) or gpu:N (see 'edof doctor'). The
    /// integers are the same on all devices
    #[arg(long, default_value_t)]
    pub(super) device: Device,

    /// Pixels from one patch to the next: 2, 4 or 8 [default: 8, or the stride of a fixed network]
    #[arg(long)]
    pub(super) stride: Option<usize>,

    /// Colour filter of the frame's first 2x2 pixels: rggb, grbg, gbrg or bggr, or a camera's name as in BayerGR [default: that of RAW.json or a
    /// DNG, else rggb]
    #[arg(long, value_parser = raw_words::phase)]
    pub(super) phase: Option<PixelWord>,

    /// Bits per sensor value, 8 to 16 [default: that of RAW.json or the file, else 16]
    #[arg(long = "bit-depth", alias = "depth", value_name = "BITS")]
    pub(super) depth: Option<u32>,

    /// RAW is video for the board's cable (2vuy, as 'edof capture --video' writes it): bytes Cb Y Cr Y of 64 to 191, no header
    #[arg(long, conflicts_with = "packing")]
    pub(super) video: bool,

    /// Size of a headerless file in pixels [default: that of RAW.json]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub(super) size: Option<Size>,

    /// Position of values of fewer than 16 bits in a word [default: bottom in headerless files, else top]
    #[arg(long, value_parser = raw_words::alignment())]
    pub(super) align: Option<Alignment>,

    /// Byte order of a headerless file
    #[arg(long, value_parser = raw_words::byte_order(), default_value = "little")]
    pub(super) order: ByteOrder,

    /// Packing of a headerless file's pixels: words (16 bits each), bytes (8), mipi10, mipi12 (MIPI RAW10, RAW12), 10p, 12p (PFNC),
    /// 12packed (GigE Vision) or 2vuy (as --video); or a camera's name for its pixels, as in BayerRG12p, RG10 or pRCC, which states the phase,
    /// too [default: words]
    #[arg(long, requires = "size", value_parser = raw_words::packing)]
    pub(super) packing: Option<PixelWord>,

    /// Bytes from one line of a headerless file to the next, where lines are padded [default: those of its pixels]
    #[arg(long, requires = "size", value_name = "BYTES")]
    pub(super) line_bytes: Option<usize>,

    /// Correction of the sensor, as edof sensor writes it: offsets, shading and defects; it states darkness and full light
    #[arg(long, value_name = "FILE", conflicts_with_all = ["black_level", "white_level"])]
    pub(super) sensor: Option<PathBuf>,

    /// Sensor value of darkness; or four, with commas, for the 2x2 pixels from the first on, row by row [default: that of RAW.json or a
    /// DNG, else 0]
    #[arg(long, value_name = "LEVEL")]
    pub(super) black_level: Option<Black>,

    /// Sensor value of full light [default: that of RAW.json or a DNG, else the largest value of the sensor's bits]
    #[arg(long, value_name = "LEVEL")]
    pub(super) white_level: Option<f64>,

    /// White balance: gains of red, green and blue that make white neutral, as in 2.1,1,1.6; only their ratios matter
    /// [default: that of RAW.json or a DNG, else none]
    #[arg(long, value_name = "R,G,B", conflicts_with = "board")]
    pub(super) white_balance: Option<WhiteBalance>,

    /// Matrix from balanced sensor colours to linear sRGB: nine numbers, row by row, each row adding up to 1 [default: that of RAW.json
    /// or a DNG, else none]
    #[arg(long, value_name = "NUMBERS", conflicts_with = "board", allow_hyphen_values = true)]
    pub(super) colour_matrix: Option<ColourMatrix>,

    /// Encoding of the picture: srgb for viewing; linear for the network's unchanged light, for frames and networks
    /// in the paper's convention [default: that of RAW.json, else srgb]
    #[arg(long)]
    pub(super) tone: Option<Tone>,

    /// Transfer curve of the picture and of the board's tables [default: the tone's]
    #[arg(long, value_name = "CURVE")]
    pub(super) gamma: Option<Gamma>,

    /// Bits per sample of the picture: 8 or 16
    #[arg(long, default_value_t = 8)]
    pub(super) bits: u32,

    /// Compute the board's output from the upper 14 bits of each word, which the board's cable carries. Writes the 8-bit Y'CbCr 4:2:2 codes of
    /// the HDMI port as .yuyv (bytes Y Cb Y Cr per two pixels), and the screen's picture of them to --out
    #[arg(long, conflicts_with_all = ["float", "bits"])]
    pub(super) board: bool,

    /// Encoding of the board's codes: colour encodes red, green and blue; luma encodes only luma, as in the paper
    #[arg(long, default_value_t, conflicts_with = "float")]
    pub(super) display: DisplayMode,

    /// Write the words at every stage boundary of one frame to DIR/words.npz (layout: docs/contract.md, 8)
    #[arg(long, value_name = "DIR", conflicts_with = "float")]
    pub(super) words: Option<PathBuf>,

    /// Accept options that contradict RAW.json, and a network trained for another lens; prints a note for each
    #[arg(long)]
    pub(super) force: bool,

    /// Picture to write: .png, .tif, .tiff or .ppm; or a folder (no ending, or a slash) for PNG pictures with the names of their frames
    #[arg(long, value_name = "FILE|DIR")]
    pub(super) out: PathBuf,
}

/// Transfer curves by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Gamma {
    /// Numbers proportional to light
    Linear,
    /// For an sRGB screen
    Srgb,
    /// BT.709's camera curve
    Bt709,
}

impl From<Gamma> for Curve {
    fn from(gamma: Gamma) -> Self {
        match gamma {
            Gamma::Linear => Self::Linear,
            Gamma::Srgb => Self::Srgb,
            Gamma::Bt709 => Self::Bt709,
        }
    }
}

impl Args {
    /// The camera that the user states, if any.
    pub(super) fn stated_lens(&self) -> Result<Option<Lens>, Error> {
        let bank = self.psf_bank.as_deref().map(|path| BankFile { path, centre: self.centre });
        Ok(self.camera.as_deref().map(|name| lens::resolve(name, bank)).transpose()?)
    }

    /// File of the board's codes beside a picture, if they are asked for.
    pub(super) fn codes_file(&self, out: &Path) -> Option<PathBuf> {
        self.board.then(|| out.with_extension("yuyv"))
    }

    /// The job of a scene.
    pub(super) fn job(
        &self,
        scene: Scene,
        foci: &Foci,
        sensor: Option<Arc<Correction>>,
    ) -> Result<ReconstructJob, Error> {
        let stated = self.stated_lens()?.map(|lens| lens.camera);
        let pixels = self.pixels()?;
        let frames = scene.raws.into_iter().zip(foci.cameras(stated.as_ref()));
        let mut sources = frames.map(|(raw, camera)| self.source(raw, pixels, camera, sensor.clone()));
        let source = sources.next().unwrap_or_else(|| unreachable!("a scene has a frame"));
        let stride = self.stride.map(said::stride).transpose()?;
        let engine = match self.demosaic {
            Some(method) => Engine::Demosaic(method),
            None if self.float || foci.are_several() => Engine::Float(stride.unwrap_or(Stride::PATCH)),
            None => Engine::Fixed(FixedOptions {
                stride,
                display: self.display,
                codes: self.codes_file(&scene.out),
                words: self.words.clone(),
            }),
        };
        Ok(ReconstructJob {
            source,
            further: sources.collect(),
            network: self.weights.clone(),
            accepts_any_lens: self.force,
            engine,
            device: self.device,
            curve: self.gamma.map(Into::into),
            bits: self.bits,
            out: scene.out,
        })
    }

    /// What the options state of the frame's pixels.
    fn pixels(&self) -> Result<Pixels, Error> {
        raw_words::check_header(self.phase.as_ref(), self.size.is_some() && !self.video)?;
        raw_words::pixels(self.packing.as_ref(), self.phase.as_ref(), self.depth)
    }

    /// A raw frame, and what the options state of it.
    fn source(
        &self,
        path: PathBuf,
        Pixels { packing, phase, depth }: Pixels,
        camera: Option<Camera>,
        sensor: Option<Arc<Correction>>,
    ) -> FrameSource {
        let Self { align: alignment, order, size, line_bytes, black_level, white_level, tone, gain, .. } =
            *self;
        FrameSource {
            path,
            stated: Stated {
                phase,
                depth,
                alignment,
                size,
                packing,
                black_level,
                white_level,
                tone,
                camera,
                gain,
            },
            options: RawOptions {
                phase: phase.unwrap_or_default(),
                depth,
                size,
                alignment,
                order,
                packing: if self.video { Packing::Video } else { packing.unwrap_or_default() },
                line_bytes,
            },
            rendering: Rendering { white_balance: self.white_balance, matrix: self.colour_matrix },
            overrules_record: self.force,
            sensor,
        }
    }
}
