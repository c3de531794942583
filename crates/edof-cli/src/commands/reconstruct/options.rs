//! Options of `edof reconstruct`.

use crate::device::Device;
use crate::error::Error;
use crate::lens::{self, Lens};
use crate::weights;
use clap::ValueEnum;
use edof_camera::Camera;
use edof_golden::Curve;
use edof_image::{CfaPhase, DisplayMode, Tone};
use edof_io::levels::Black;
use edof_io::packing::{ByteOrder, Packing};
use edof_io::raw::{Alignment, RawOptions, Size};
use edof_io::record::Stated;
use edof_io::rendering::{ColourMatrix, WhiteBalance};
use std::path::PathBuf;

/// Reconstruct a sharp picture from a raw Bayer frame, or one from each of several
///
/// RAW is a 16-bit grey PNG, TIFF or PGM (values of fewer bits at the top of each word, or as a PGM's maximum says), or a
/// headerless file with --size. How the frame was taken is read from RAW.json, which 'edof capture' writes, and
/// contradictions are refused. Of a camera it may be a DNG (a Bayer mosaic, uncompressed or as lossless JPEG), whose levels, white
/// balance and colour matrix are used; with the optional feature camera-raw also other makers' files. The network runs in the
/// board's integers unless --float is given.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof reconstruct raw.png --out sharp.png
  edof reconstruct raw.png --weights edof-t4w12 --float --stride 4 --out sharp.tif
  edof reconstruct frame.bin --size 1920x1080 --depth 12 --phase gbrg --weights edof-t4w12 --out sharp.png
  edof reconstruct night/*.png --out night-sharp/
  edof reconstruct frame.pgm --black-level 64 --white-level 4000 --white-balance 2.1,1,1.6 --out sharp.png
  edof reconstruct raw.png --board --out board.png     what leaves the HDMI port (board.yuyv) and what a screen shows of it
  edof reconstruct --video frame.2vuy --size 1920x1080 --board --out board.png
  edof reconstruct raw.png --device gpu --out sharp.png
  edof reconstruct raw.png --words words --json counters.json --out sharp.png")]
pub struct Args {
    /// Raw Bayer frames
    #[arg(required = true)]
    pub(super) raw: Vec<PathBuf>,

    /// Network: a name such as edof-t4w12-outer, or a weight file; it must have been trained for the camera that took RAW
    /// [default: edof-t4w12-outer-light, for linear pictures edof-t4w12-outer]
    #[arg(long, value_name = "NAME|FILE")]
    pub(super) weights: Option<String>,

    /// Camera that took RAW, a preset or a JSON file: another than RAW.json says, or a network trained for another lens or mask, is
    /// refused
    #[arg(long)]
    pub(super) camera: Option<String>,

    /// PSFs of one's own in place of that camera's, as edof capture took them
    #[arg(long, value_name = "FILE", requires = "camera")]
    pub(super) psf_bank: Option<PathBuf>,

    /// Compute in the board's integers (the default)
    #[arg(long, conflicts_with = "float")]
    pub(super) fixed: bool,

    /// Compute in floating point
    #[arg(long)]
    pub(super) float: bool,

    /// Where the network runs: cpu; gpu, the first device that OpenCL knows; or gpu:N, another one that 'edof doctor' lists. The
    /// integers are the same everywhere
    #[arg(long, default_value_t)]
    pub(super) device: Device,

    /// Pixels from one patch to the next: 2, 4 or 8 [default: 8, or what a fixed network is made for]
    #[arg(long)]
    pub(super) stride: Option<usize>,

    /// Colour filter of the frame's first 2x2 pixels: rggb, grbg, gbrg or bggr [default: what RAW.json says, else rggb]
    #[arg(long)]
    pub(super) phase: Option<CfaPhase>,

    /// Bits that the sensor gave, 8 to 16 [default: what RAW.json or the file says, else 16]
    #[arg(long, value_name = "BITS")]
    pub(super) depth: Option<u32>,

    /// RAW is video for the board's cable (2vuy, as 'edof capture --video' writes it): bytes Cb Y Cr Y of 64 to 191, no header
    #[arg(long, conflicts_with = "packing")]
    pub(super) video: bool,

    /// Size of a headerless file in pixels [default: what RAW.json says]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub(super) size: Option<Size>,

    /// Where in a word values of fewer than 16 bits lie [default: bottom in headerless files, else top]
    #[arg(long, value_parser = ["top", "bottom"])]
    pub(super) align: Option<String>,

    /// Byte order of a headerless file
    #[arg(long, value_parser = ["little", "big"], default_value = "little")]
    pub(super) order: String,

    /// How a headerless file's pixels are packed: words (16 bits each), bytes (8), mipi12 (MIPI RAW12), 12p (PFNC), 12packed (GigE
    /// Vision) or 2vuy (as --video) [default: words]
    #[arg(long, requires = "size")]
    pub(super) packing: Option<Packing>,

    /// Sensor value of no light; or four, with commas, for the 2x2 pixels from the first on, row by row [default: what RAW.json or a
    /// DNG says, else 0]
    #[arg(long, value_name = "LEVEL")]
    pub(super) black_level: Option<Black>,

    /// Sensor value of full light [default: what RAW.json or a DNG says, else where the sensor's bits end]
    #[arg(long, value_name = "LEVEL")]
    pub(super) white_level: Option<f64>,

    /// Factors of red, green and blue that make white of what the sensor sees of it, as in 2.1,1,1.6; only their proportions count
    /// [default: what RAW.json or a DNG says, else none]
    #[arg(long, value_name = "R,G,B", conflicts_with = "board")]
    pub(super) white_balance: Option<WhiteBalance>,

    /// From balanced colours of the sensor to linear sRGB: nine numbers, row by row, each row adding up to 1 [default: what RAW.json
    /// or a DNG says, else none]
    #[arg(long, value_name = "NUMBERS", conflicts_with = "board", allow_hyphen_values = true)]
    pub(super) colour_matrix: Option<ColourMatrix>,

    /// What the picture's numbers mean: srgb is for looking at; linear writes the network's light as it is, for frames and networks
    /// that take a photograph's codes for light [default: what RAW.json says of the scene, else srgb: a sensor measures light]
    #[arg(long)]
    pub(super) tone: Option<Tone>,

    /// Curve from light to the picture's numbers, and of the board's tables [default: the tone's]
    #[arg(long, value_name = "CURVE")]
    pub(super) gamma: Option<Gamma>,

    /// Bits a sample of the picture: 8 or 16
    #[arg(long, default_value_t = 8)]
    pub(super) bits: u32,

    /// Write what the board makes of the upper 14 bits of each word, which its cable carries, and sends: the 8-bit Y'CbCr 4:2:2 codes of its HDMI port beside the picture, as .yuyv (bytes Y Cb Y Cr
    /// for each two pixels), and as picture what a screen shows of them
    #[arg(long, conflicts_with_all = ["float", "bits"])]
    pub(super) board: bool,

    /// How the board makes codes: colour encodes red, green and blue; luma is the paper's and encodes luma alone
    #[arg(long, default_value_t, conflicts_with = "float")]
    pub(super) display: DisplayMode,

    /// Write the words at every stage boundary to DIR/words.npz, laid out as docs/contract.md says; of one frame
    #[arg(long, value_name = "DIR", conflicts_with = "float")]
    pub(super) words: Option<PathBuf>,

    /// Take what options state where RAW.json says otherwise, and a network trained for another lens; each is told
    #[arg(long)]
    pub(super) force: bool,

    /// Picture to write: .png, .tif, .tiff or .ppm; or a folder, where pictures are PNG and have their frames' names
    #[arg(long, value_name = "FILE|DIR")]
    pub(super) out: PathBuf,
}

/// Transfer curves by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Gamma {
    /// Numbers proportional to light
    Linear,
    /// For an sRGB screen
    Srgb,
    /// BT.709's camera curve
    Bt709,
}

impl Args {
    /// The camera that the user states, if any.
    pub(super) fn stated_lens(&self) -> Result<Option<Lens>, Error> {
        Ok(self.camera.as_deref().map(|name| lens::resolve(name, self.psf_bank.as_deref())).transpose()?)
    }

    /// All that the user states of a frame.
    pub(super) fn stated(&self, camera: Option<Camera>) -> Stated {
        let alignment = raw_options(self).alignment;
        let Self { phase, depth, size, packing, black_level, white_level, tone, .. } = *self;
        Stated { phase, depth, alignment, size, packing, black_level, white_level, tone, camera }
    }

    /// The network that is asked for, else the one for pictures of that tone.
    pub(super) fn network(&self, tone: Tone) -> &str {
        self.weights.as_deref().unwrap_or(weights::default_for(tone))
    }
}

pub(super) fn curve(args: &Args, tone: Tone) -> Curve {
    match (args.gamma, tone) {
        (Some(Gamma::Linear), _) | (None, Tone::Linear) => Curve::Linear,
        (Some(Gamma::Srgb), _) | (None, Tone::Srgb) => Curve::Srgb,
        (Some(Gamma::Bt709), _) => Curve::Bt709,
    }
}

pub(super) fn raw_options(args: &Args) -> RawOptions {
    RawOptions {
        phase: args.phase.unwrap_or_default(),
        depth: args.depth,
        size: args.size,
        alignment: args.align.as_deref().map(|a| if a == "top" { Alignment::Top } else { Alignment::Bottom }),
        order: if args.order == "big" { ByteOrder::Big } else { ByteOrder::Little },
        packing: if args.video { Packing::Video } else { args.packing.unwrap_or_default() },
    }
}
