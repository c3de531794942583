//! `edof reconstruct`: from a raw frame to a picture.

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::weights;
use edof_golden::GoldenReconstructor;
use edof_io::raw::{Alignment, ByteOrder, RawOptions, Size};
use edof_io::{photo, raw};
use edof_spec::colour::srgb_encode;
use edof_spec::network::Origin;
use edof_spec::overlap::Overlap;
use edof_spec::{Camera, CfaPhase, ColourFrame, RawFrame, Reconstructor, Stride};
use edof_train::reconstruct::{FloatReconstructor, Output};
use serde_json::json;
use std::path::PathBuf;

/// Frames that use less than this share of full scale are remarked upon: their codes may lie at the bottom of the word.
const DIM: u16 = u16::MAX / 16;

/// Reconstruct a sharp picture from a raw Bayer frame
///
/// RAW is a 16-bit grey PNG, TIFF or PGM (codes of fewer bits at the top of each word, or as a PGM's maximum says), or a
/// headerless 16-bit file with --size; with the optional feature camera-raw also DNG and other camera files. The network runs in the board's integers unless --float is given.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof reconstruct raw.png --out sharp.png
  edof reconstruct raw.png --weights edof-t4w12 --float --stride 4 --out sharp.tif
  edof reconstruct frame.bin --size 1920x1080 --depth 12 --phase gbrg --weights edof-t4w12 --gamma srgb --out sharp.png")]
pub struct Args {
    /// Raw Bayer frame
    raw: PathBuf,

    /// Network: a name such as edof-t4w12-outer, or a weight file; it must have been trained for the camera that took RAW
    #[arg(long, default_value = "edof-t4w12-outer", value_name = "NAME|FILE")]
    weights: String,

    /// Camera that took RAW, a preset or a JSON file: a network trained for another lens or mask is refused
    #[arg(long)]
    camera: Option<String>,

    /// Compute in the board's integers (the default)
    #[arg(long, conflicts_with = "float")]
    fixed: bool,

    /// Compute in floating point
    #[arg(long)]
    float: bool,

    /// Pixels from one patch to the next: 2, 4 or 8 [default: 8, or what a fixed network is made for]
    #[arg(long)]
    stride: Option<usize>,

    /// Colour filter of the frame's first 2x2 pixels: rggb, grbg, gbrg or bggr
    #[arg(long, default_value_t = CfaPhase::Rggb)]
    phase: CfaPhase,

    /// Bits that the sensor gave, 8 to 16 [default: what the file says, else 16]
    #[arg(long, value_name = "BITS")]
    depth: Option<u32>,

    /// Size of a headerless file in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,

    /// Where in a word codes of fewer than 16 bits lie [default: bottom in headerless files, else top]
    #[arg(long, value_parser = ["top", "bottom"])]
    align: Option<String>,

    /// Byte order of a headerless file
    #[arg(long, value_parser = ["little", "big"], default_value = "little")]
    order: String,

    /// Tone curve of the picture: linear keeps the light's values, srgb is for looking at
    #[arg(long, value_parser = ["linear", "srgb"], default_value = "linear")]
    gamma: String,

    /// Bits a sample of the picture: 8 or 16
    #[arg(long, default_value_t = 8)]
    bits: u32,

    /// Picture to write: .png, .tif, .tiff or .ppm
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// # Errors
/// A frame, network or option that cannot be used, or a picture that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let network =
        if args.float { weights::float_file(&args.weights) } else { weights::fixed_file(&args.weights) };
    let files = Files::new(ui).reads(&args.raw).reads_all(network).reads_all(&args.camera);
    files.writes("--out", &args.out).check()?;
    let frame = raw::load(&args.raw, &raw_options(&args))?;
    remark_on_dim_frames(&frame, &args, ui);
    let method = method(&args)?;
    let result =
        method.reconstruct(&frame).map_err(|e| Error::message(format!("{}: {e}", args.raw.display())))?;
    photo::save(&args.out, &toned(result.frame, &args.gamma), args.bits)?;
    let (height, width) = frame.size();
    let megapixels = (height * width) as f64 / 1e6;
    ui.say(format!(
        "{}: {width}x{height} by {} in {:.3} s ({:.2} s a megapixel)",
        args.out.display(),
        method.name(),
        result.seconds,
        result.seconds / megapixels
    ))?;
    ui.json(&json!({
        "method": method.name(),
        "raw": args.raw.display().to_string(),
        "picture": args.out.display().to_string(),
        "width": width,
        "height": height,
        "seconds": result.seconds,
        "seconds_per_megapixel": result.seconds / megapixels,
        "multiply_accumulates": result.multiply_accumulates,
    }))
}

fn raw_options(args: &Args) -> RawOptions {
    RawOptions {
        phase: args.phase,
        depth: args.depth,
        size: args.size,
        alignment: args.align.as_deref().map(|a| if a == "top" { Alignment::Top } else { Alignment::Bottom }),
        order: if args.order == "big" { ByteOrder::Big } else { ByteOrder::Little },
    }
}

fn method(args: &Args) -> Result<Box<dyn Reconstructor>, Error> {
    if args.float {
        let stride = args.stride.map_or(Ok(Stride::PATCH), Stride::new)?;
        let network = weights::float(&args.weights)?;
        fits_camera(&network.origin, args)?;
        return Ok(Box::new(FloatReconstructor::new(network, stride, Overlap::Hann, Output::Rgb)?));
    }
    let network = weights::fixed(&args.weights)?;
    fits_camera(&network.origin, args)?;
    if let Some(stride) = args.stride.map(Stride::new).transpose()?
        && stride != network.stride
    {
        return Err(Error::message(format!(
            "--stride {}: {} is quantized for a stride of {}; make one by 'edof quantize --stride {}', or use --float",
            stride.pixels(),
            args.weights,
            network.stride.pixels(),
            stride.pixels()
        )));
    }
    let name = format!("{}.fixed", network.origin.name);
    Ok(Box::new(GoldenReconstructor::new(network, name)?))
}

/// Names, sources and ranges may differ, lenses may not.
fn fits_camera(origin: &Origin, args: &Args) -> Result<(), Error> {
    let Some(name) = &args.camera else { return Ok(()) };
    let camera = Camera::resolve(name)?;
    let same_lens = Camera {
        name: camera.name.clone(),
        source: camera.source.clone(),
        psi_range: camera.psi_range,
        ..origin.camera.clone()
    };
    if same_lens == camera {
        return Ok(());
    }
    Err(Error::message(format!(
        "--weights {}: trained for the camera {}, whose lens or mask is not that of {name}",
        args.weights, origin.camera.name
    )))
}

fn remark_on_dim_frames(frame: &RawFrame, args: &Args, ui: &Ui) {
    let brightest = frame.pixels().iter().copied().max().unwrap_or(0);
    if args.depth.is_none() && args.align.is_none() && brightest < DIM {
        ui.note(format!(
            "{}: brightest pixel is {brightest} of 65535; if its codes lie at the bottom of each word, give --depth and \
             --align bottom",
            args.raw.display()
        ));
    }
}

fn toned(mut frame: ColourFrame, gamma: &str) -> ColourFrame {
    if gamma == "srgb" {
        frame.planes.mapv_inplace(|v| srgb_encode(f64::from(v.clamp(0.0, 1.0))) as f32);
    }
    frame
}
