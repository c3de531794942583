//! `edof reconstruct`: from a raw frame to a picture.

use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::weights;
use crate::words;
use clap::ValueEnum;
use edof_golden::{Counts, Curve, Display, Golden};
use edof_io::doubt::{self, Doubt};
use edof_io::packing::{ByteOrder, Packing};
use edof_io::raw::{Alignment, RawOptions, Size};
use edof_io::record::{self, RawRecord};
use edof_io::{photo, raw};
use edof_spec::display::DisplayMode;
use edof_spec::fixed_network::layer_names;
use edof_spec::network::Origin;
use edof_spec::overlap::Overlap;
use edof_spec::provenance::Input;
use edof_spec::reconstructor::Multiplications;
use edof_spec::{
    Camera, CfaPhase, Channel, ColourFrame, FixedNetwork, RawFrame, Reconstructor, Stride, Tone,
};
use edof_train::reconstruct::{FloatReconstructor, Output};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;

/// Reconstruct a sharp picture from a raw Bayer frame
///
/// RAW is a 16-bit grey PNG, TIFF or PGM (values of fewer bits at the top of each word, or as a PGM's maximum says), or a
/// headerless file with --size. How the frame was taken is read from RAW.json, which 'edof capture' writes, and
/// contradictions are refused; with the optional feature camera-raw also DNG and other camera files. The network runs in the board's integers unless --float is given.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof reconstruct raw.png --out sharp.png
  edof reconstruct raw.png --weights edof-t4w12 --float --stride 4 --out sharp.tif
  edof reconstruct frame.bin --size 1920x1080 --depth 12 --phase gbrg --weights edof-t4w12 --out sharp.png
  edof reconstruct raw.png --board --out board.png     what leaves the HDMI port (board.yuyv) and what a screen shows of it
  edof reconstruct raw.png --words words --json counters.json --out sharp.png")]
pub struct Args {
    /// Raw Bayer frame
    raw: PathBuf,

    /// Network: a name such as edof-t4w12-outer, or a weight file; it must have been trained for the camera that took RAW
    /// [default: edof-t4w12-outer-light, for linear pictures edof-t4w12-outer]
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

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

    /// Colour filter of the frame's first 2x2 pixels: rggb, grbg, gbrg or bggr [default: what RAW.json says, else rggb]
    #[arg(long)]
    phase: Option<CfaPhase>,

    /// Bits that the sensor gave, 8 to 16 [default: what RAW.json or the file says, else 16]
    #[arg(long, value_name = "BITS")]
    depth: Option<u32>,

    /// Size of a headerless file in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,

    /// Where in a word values of fewer than 16 bits lie [default: bottom in headerless files, else top]
    #[arg(long, value_parser = ["top", "bottom"])]
    align: Option<String>,

    /// Byte order of a headerless file
    #[arg(long, value_parser = ["little", "big"], default_value = "little")]
    order: String,

    /// How a headerless file's pixels are packed: words (16 bits each), bytes (8), mipi12 (MIPI RAW12), 12p (PFNC) or 12packed (GigE
    /// Vision) [default: words]
    #[arg(long, requires = "size")]
    packing: Option<Packing>,

    /// What the picture's numbers mean: srgb is for looking at; linear writes the network's light as it is, for frames and networks
    /// that take a photograph's codes for light [default: what RAW.json says of the scene, else srgb: a sensor measures light]
    #[arg(long)]
    tone: Option<Tone>,

    /// Curve from light to the picture's numbers, and of the board's tables [default: the tone's]
    #[arg(long, value_name = "CURVE")]
    gamma: Option<Gamma>,

    /// Bits a sample of the picture: 8 or 16
    #[arg(long, default_value_t = 8)]
    bits: u32,

    /// Write what the board sends: the 8-bit Y'CbCr 4:2:2 codes of its HDMI port beside the picture, as .yuyv (bytes Y Cb Y Cr
    /// for each two pixels), and as picture what a screen shows of them
    #[arg(long, conflicts_with_all = ["float", "bits"])]
    board: bool,

    /// How the board makes codes: colour encodes red, green and blue; luma is the paper's and encodes luma alone
    #[arg(long, default_value_t, conflicts_with = "float")]
    display: DisplayMode,

    /// Write the words at every stage boundary to DIR/words.npz, laid out as docs/contract.md says
    #[arg(long, value_name = "DIR", conflicts_with = "float")]
    words: Option<PathBuf>,

    /// Picture to write: .png, .tif, .tiff or .ppm
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Transfer curves by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Gamma {
    /// Numbers proportional to light
    Linear,
    /// For an sRGB screen
    Srgb,
    /// BT.709's camera curve
    Bt709,
}

/// # Errors
/// A frame, network or option that cannot be used, or a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let file = if args.float { weights::float_file } else { weights::fixed_file };
    // Which default it is, the frame's record says.
    let networks =
        args.weights.as_deref().map_or(Tone::ALL.map(weights::default_for).to_vec(), |name| vec![name]);
    let networks = networks.into_iter().filter_map(file);
    let record = record::path_of(&args.raw);
    let files = Files::new(ui).reads(&args.raw).reads(record).reads_all(networks).reads_all(&args.camera);
    let words = args.words.as_deref().map(words::file);
    files
        .writes_picture("--out", &args.out)?
        .may_write("--board", codes_file(&args))
        .may_write("--words", words)
        .check()?;
    let (frame, record) = open(&args, ui)?;
    if record.is_none() {
        remark(&frame, &args, ui);
    }
    let record = record.as_ref();
    let made = if args.float { float(&args, &frame, record, ui)? } else { fixed(&args, &frame, record, ui)? };
    let (height, width) = frame.size();
    let per_megapixel = made.seconds / ((height * width) as f64 / 1e6);
    ui.say(format!(
        "{}: {width}x{height} by {} in {:.3} s ({per_megapixel:.2} s a megapixel)",
        args.out.display(),
        made.name,
        made.seconds,
    ))?;
    let mut report = json!({
        "method": made.name,
        "raw": args.raw.display().to_string(),
        "picture": args.out.display().to_string(),
        "width": width,
        "height": height,
        "tone": made.tone,
        "seconds": made.seconds,
        "seconds_per_megapixel": per_megapixel,
        "multiplications": made.multiplications,
    });
    if let (Value::Object(report), Value::Object(more)) = (&mut report, made.more) {
        report.extend(more);
    }
    ui.json(&report)
}

/// What has been made and written.
struct Made {
    name: String,
    tone: Tone,
    seconds: f64,
    multiplications: Option<Multiplications>,
    /// What else there is to report.
    more: Value,
}

fn float(args: &Args, frame: &RawFrame, record: Option<&RawRecord>, ui: &Ui) -> Result<Made, Error> {
    let stride = args.stride.map_or(Ok(Stride::PATCH), Stride::new)?;
    let tone = tone(args, record);
    let name = args.network(tone);
    let network = weights::float(name)?;
    ui.used(weights::float_input(name)?);
    fits_camera(&network.origin, args, record)?;
    let method = FloatReconstructor::new(network, stride, Overlap::Hann, Output::Rgb)?;
    let result = method.reconstruct(frame).map_err(|e| of_frame(args, e))?;
    photo::save(&args.out, &encoded(result.frame, curve(args, tone)), args.bits)?;
    let name = method.name().to_owned();
    Ok(Made {
        name,
        tone,
        seconds: result.seconds,
        multiplications: result.multiplications,
        more: Value::Null,
    })
}

fn fixed(args: &Args, frame: &RawFrame, record: Option<&RawRecord>, ui: &Ui) -> Result<Made, Error> {
    let network = fixed_network(args, record, ui)?;
    let name = format!("{}.fixed", network.origin.name);
    let tone = tone(args, record);
    let golden = Golden::new(network)?;
    let start = Instant::now();
    let out = golden.frame(frame).map_err(|e| of_frame(args, e))?;
    let seconds = start.elapsed().as_secs_f64();
    let (picture, shown) = out.picture(&Display::new(args.display, curve(args, tone)));
    let board = codes_file(args);
    if let Some(codes) = &board {
        photo::save(&args.out, &picture.shown_frame(), args.bits)?;
        edof_spec::atomic::write(codes, &picture.yuyv())?;
    } else {
        photo::save(&args.out, &encoded(out.colour(), curve(args, tone)), args.bits)?;
    }
    if let Some(folder) = &args.words {
        words::save(folder, &golden.words(frame).map_err(|e| of_frame(args, e))?, &out.frame, &picture)?;
    }
    let more = json!({
        "counters": counters(&out.counts),
        "display": { "mode": args.display, "clamped_chroma": shown.clamped_chroma, "out_of_gamut": shown.out_of_gamut },
        "board": board.map(|file| file.display().to_string()),
        "words": args.words.as_deref().map(|folder| words::file(folder).display().to_string()),
    });
    let multiplications = Some(out.counts.multiplications(golden.network()));
    Ok(Made { name, tone, seconds, multiplications, more })
}

/// Where the board's codes go, if they are asked for.
fn codes_file(args: &Args) -> Option<PathBuf> {
    args.board.then(|| args.out.with_extension("yuyv"))
}

/// Saturations and non-zeros of every stage.
fn counters(counts: &Counts) -> Value {
    let stages: Vec<Value> = layer_names(counts.stages.len())
        .zip(&counts.stages)
        .map(|(layer, stage)| {
            json!({
                "layer": layer,
                "saturated_results": stage.saturated_results,
                "saturated_codes": stage.saturated_codes,
                "saturated_differences": stage.saturated_differences,
                "nonzeros": stage.nonzeros,
            })
        })
        .collect();
    json!({ "patches": counts.patches, "stages": stages, "saturated_sums": counts.saturated_sums })
}

/// An error that names the raw frame's file.
fn of_frame(args: &Args, error: impl std::fmt::Display) -> Error {
    Error::message(format!("{}: {error}", args.raw.display()))
}

/// What the user says, else what the scene's numbers were taken for, else what suits a sensor's light.
fn tone(args: &Args, record: Option<&RawRecord>) -> Tone {
    args.tone.or(record.map(|r| r.tone)).unwrap_or(Tone::Srgb)
}

impl Args {
    /// The network that is asked for, else the one for pictures of that tone.
    fn network(&self, tone: Tone) -> &str {
        self.weights.as_deref().unwrap_or(weights::default_for(tone))
    }
}

fn curve(args: &Args, tone: Tone) -> Curve {
    match (args.gamma, tone) {
        (Some(Gamma::Linear), _) | (None, Tone::Linear) => Curve::Linear,
        (Some(Gamma::Srgb), _) | (None, Tone::Srgb) => Curve::Srgb,
        (Some(Gamma::Bt709), _) => Curve::Bt709,
    }
}

/// Light as the numbers of a picture file.
fn encoded(mut light: ColourFrame, curve: Curve) -> ColourFrame {
    if curve != Curve::Linear {
        light.planes.mapv_inplace(|v| curve.encode(f64::from(v.clamp(0.0, 1.0))) as f32);
    }
    light
}

/// The frame, and its record where one lies beside it.
fn open(args: &Args, ui: &Ui) -> Result<(RawFrame, Option<RawRecord>), Error> {
    let record = record::load(&args.raw)?;
    let stated = raw_options(args);
    let options = match &record {
        Some(record) => record.options(&args.raw, stated, args.phase)?,
        None => stated,
    };
    let frame = raw::load(&args.raw, &options)?;
    if let Some(record) = &record {
        record.check(&args.raw, &frame)?;
    }
    let name = args.raw.file_name().unwrap_or_default().to_string_lossy();
    ui.used(Input::raw_frame(&name, &frame));
    Ok((frame, record))
}

fn raw_options(args: &Args) -> RawOptions {
    RawOptions {
        phase: args.phase.unwrap_or_default(),
        depth: args.depth,
        size: args.size,
        alignment: args.align.as_deref().map(|a| if a == "top" { Alignment::Top } else { Alignment::Bottom }),
        order: if args.order == "big" { ByteOrder::Big } else { ByteOrder::Little },
        packing: args.packing.unwrap_or_default(),
    }
}

fn fixed_network(args: &Args, record: Option<&RawRecord>, ui: &Ui) -> Result<FixedNetwork, Error> {
    let name = args.network(tone(args, record));
    let network = weights::fixed(name)?;
    ui.used(weights::fixed_input(name)?);
    fits_camera(&network.origin, args, record)?;
    match args.stride.map(Stride::new).transpose()? {
        Some(stride) if stride != network.stride => Err(Error::message(format!(
            "--stride {}: {} is quantized for a stride of {}; make one by 'edof quantize --stride {}', or use --float",
            stride.pixels(),
            name,
            network.stride.pixels(),
            stride.pixels()
        ))),
        _ => Ok(network),
    }
}

/// The network must have been trained for the lens that the user states, and for the one that took the frame.
fn fits_camera(origin: &Origin, args: &Args, record: Option<&RawRecord>) -> Result<(), Error> {
    let stated = args.camera.as_deref().map(Camera::resolve).transpose()?;
    let tone = tone(args, record);
    let Some(camera) = stated.as_ref().or(record.map(|r| &r.camera)) else { return Ok(()) };
    if origin.camera.same_lens(camera) {
        return Ok(());
    }
    let trained = &origin.camera.name;
    if stated.is_some() {
        return Err(Error::message(format!(
            "--weights {}: trained for the camera {trained}, whose lens or mask is not that of {}",
            args.network(tone),
            camera.name
        )));
    }
    let instead = match weights::trained_for(camera, tone) {
        Some(name) => format!("use --weights {name}"),
        None => format!("train one by 'edof train --camera {}'", camera.name),
    };
    Err(Error::message(format!(
        "--weights {}: trained for the camera {trained}, but {} was taken by {} ({}); {instead}",
        args.network(tone),
        args.raw.display(),
        camera.name,
        record::path_of(&args.raw).display()
    )))
}

/// Of a frame without a record: what of it says that it was read otherwise than it was taken.
fn remark(frame: &RawFrame, args: &Args, ui: &Ui) {
    let raw = args.raw.display();
    for doubt in doubt::doubts(frame) {
        match doubt {
            Doubt::Dim(brightest) => {
                let advice = match (args.depth, args.align.as_deref()) {
                    (None, None) if args.size.is_some() => {
                        "if its values have fewer than 16 bits, give --depth"
                    }
                    (None, None) => {
                        "if its values have fewer than 16 bits, give --depth, and --align bottom where they lie at the \
                         bottom of each word"
                    }
                    _ => "a dark picture, or --depth and --align are not as it was taken",
                };
                ui.note(format!("{raw}: brightest pixel is {brightest} of 65535; {advice}"));
            }
            Doubt::Phase => {
                let phase = frame.phase();
                let others = CfaPhase::ALL.into_iter().filter(|p| green_first(*p) != green_first(phase));
                let others: Vec<String> = others.map(|p| format!("--phase {p}")).collect();
                ui.note(format!(
                    "{raw}: what --phase {phase} takes for green differs as red and blue do; it may have been taken with {}",
                    others.join(" or ")
                ));
            }
        }
    }
}

fn green_first(phase: CfaPhase) -> bool {
    phase.channel(0, 0) == Channel::Green
}
