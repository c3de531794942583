//! `edof reconstruct`: from a raw frame to a picture.

use crate::device::Device;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::lens::{self, Lens};
use crate::said;
use crate::ui::Ui;
use crate::weights;
use crate::words;
use clap::ValueEnum;
use edof_camera::Camera;
use edof_float::reconstruct::{FloatReconstructor, Output};
use edof_golden::{Counts, Curve, Display, Golden};
use edof_gpu::{GpuFloat, GpuGolden};
use edof_image::display::DisplayMode;
use edof_image::frame::FrameError;
use edof_image::overlap::Overlap;
use edof_image::reconstructor::Multiplications;
use edof_image::{CfaPhase, Channel, ColourFrame, RawFrame, Reconstructor, Stride, Tone, cable};
use edof_io::doubt::{self, Doubt};
use edof_io::levels::{Black, Levels, LevelsError};
use edof_io::packing::{ByteOrder, Packing};
use edof_io::picture::Format;
use edof_io::raw::{Alignment, RawError, RawOptions, Size};
use edof_io::record::{self, RawRecord, RecordError, Stated};
use edof_io::rendering::{ColourMatrix, Rendering, WhiteBalance};
use edof_io::{photo, raw};
use edof_network::FixedNetwork;
use edof_network::fixed_network::layer_names;
use edof_network::network::Origin;
use edof_storage::provenance::Input;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

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
    raw: Vec<PathBuf>,

    /// Network: a name such as edof-t4w12-outer, or a weight file; it must have been trained for the camera that took RAW
    /// [default: edof-t4w12-outer-light, for linear pictures edof-t4w12-outer]
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Camera that took RAW, a preset or a JSON file: another than RAW.json says, or a network trained for another lens or mask, is
    /// refused
    #[arg(long)]
    camera: Option<String>,

    /// PSFs of one's own in place of that camera's, as edof capture took them
    #[arg(long, value_name = "FILE", requires = "camera")]
    psf_bank: Option<PathBuf>,

    /// Compute in the board's integers (the default)
    #[arg(long, conflicts_with = "float")]
    fixed: bool,

    /// Compute in floating point
    #[arg(long)]
    float: bool,

    /// Where the network runs: cpu; gpu, the first device that OpenCL knows; or gpu:N, another one that 'edof doctor' lists. The
    /// integers are the same everywhere
    #[arg(long, default_value_t)]
    device: Device,

    /// Pixels from one patch to the next: 2, 4 or 8 [default: 8, or what a fixed network is made for]
    #[arg(long)]
    stride: Option<usize>,

    /// Colour filter of the frame's first 2x2 pixels: rggb, grbg, gbrg or bggr [default: what RAW.json says, else rggb]
    #[arg(long)]
    phase: Option<CfaPhase>,

    /// Bits that the sensor gave, 8 to 16 [default: what RAW.json or the file says, else 16]
    #[arg(long, value_name = "BITS")]
    depth: Option<u32>,

    /// RAW is video for the board's cable (2vuy, as 'edof capture --video' writes it): bytes Cb Y Cr Y of 64 to 191, no header
    #[arg(long, conflicts_with = "packing")]
    video: bool,

    /// Size of a headerless file in pixels [default: what RAW.json says]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,

    /// Where in a word values of fewer than 16 bits lie [default: bottom in headerless files, else top]
    #[arg(long, value_parser = ["top", "bottom"])]
    align: Option<String>,

    /// Byte order of a headerless file
    #[arg(long, value_parser = ["little", "big"], default_value = "little")]
    order: String,

    /// How a headerless file's pixels are packed: words (16 bits each), bytes (8), mipi12 (MIPI RAW12), 12p (PFNC), 12packed (GigE
    /// Vision) or 2vuy (as --video) [default: words]
    #[arg(long, requires = "size")]
    packing: Option<Packing>,

    /// Sensor value of no light; or four, with commas, for the 2x2 pixels from the first on, row by row [default: what RAW.json or a
    /// DNG says, else 0]
    #[arg(long, value_name = "LEVEL")]
    black_level: Option<Black>,

    /// Sensor value of full light [default: what RAW.json or a DNG says, else where the sensor's bits end]
    #[arg(long, value_name = "LEVEL")]
    white_level: Option<f64>,

    /// Factors of red, green and blue that make white of what the sensor sees of it, as in 2.1,1,1.6; only their proportions count
    /// [default: what RAW.json or a DNG says, else none]
    #[arg(long, value_name = "R,G,B", conflicts_with = "board")]
    white_balance: Option<WhiteBalance>,

    /// From balanced colours of the sensor to linear sRGB: nine numbers, row by row, each row adding up to 1 [default: what RAW.json
    /// or a DNG says, else none]
    #[arg(long, value_name = "NUMBERS", conflicts_with = "board", allow_hyphen_values = true)]
    colour_matrix: Option<ColourMatrix>,

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

    /// Write what the board makes of the upper 14 bits of each word, which its cable carries, and sends: the 8-bit Y'CbCr 4:2:2 codes of its HDMI port beside the picture, as .yuyv (bytes Y Cb Y Cr
    /// for each two pixels), and as picture what a screen shows of them
    #[arg(long, conflicts_with_all = ["float", "bits"])]
    board: bool,

    /// How the board makes codes: colour encodes red, green and blue; luma is the paper's and encodes luma alone
    #[arg(long, default_value_t, conflicts_with = "float")]
    display: DisplayMode,

    /// Write the words at every stage boundary to DIR/words.npz, laid out as docs/contract.md says; of one frame
    #[arg(long, value_name = "DIR", conflicts_with = "float")]
    words: Option<PathBuf>,

    /// Take what options state where RAW.json says otherwise, and a network trained for another lens; each is told
    #[arg(long)]
    force: bool,

    /// Picture to write: .png, .tif, .tiff or .ppm; or a folder, where pictures are PNG and have their frames' names
    #[arg(long, value_name = "FILE|DIR")]
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
    let jobs = jobs(&args)?;
    check_files(&args, &jobs, ui)?;
    if jobs.len() > 1 {
        // A frame that cannot be used is told before the first is computed.
        jobs.iter().try_for_each(|job| job.open(ui).map(drop))?;
    }
    let mut reports = vec![];
    for job in &jobs {
        interrupt::check()?;
        reports.push(job.run(ui)?);
    }
    match &reports[..] {
        [one] => ui.json(one),
        all => ui.json(&json!({ "frames": all })),
    }
}

/// A frame and the picture that it becomes.
struct Job<'a> {
    args: &'a Args,
    raw: &'a Path,
    out: PathBuf,
}

/// One for each frame.
fn jobs(args: &Args) -> Result<Vec<Job<'_>>, Error> {
    let several = args.raw.len() > 1;
    let ends_with_slash = args.out.as_os_str().as_encoded_bytes().ends_with(b"/");
    let folder = several || ends_with_slash || args.out.is_dir();
    if several && !args.out.is_dir() && Format::of_ending(&args.out).is_some() {
        return Err(Error::message(format!(
            "--out {}: {} frames need a folder, not a picture",
            args.out.display(),
            args.raw.len()
        )));
    }
    if let Some(words) = args.words.as_ref().filter(|_| several) {
        return Err(Error::message(format!(
            "--words {}: of one frame only, not of {}",
            words.display(),
            args.raw.len()
        )));
    }
    let out = |raw: &Path| match (folder, raw.file_stem()) {
        (true, Some(stem)) => {
            let mut name = stem.to_owned();
            name.push(".png");
            args.out.join(name)
        }
        _ => args.out.clone(),
    };
    Ok(args.raw.iter().map(|raw| Job { args, raw, out: out(raw) }).collect())
}

fn check_files(args: &Args, jobs: &[Job<'_>], ui: &Ui) -> Result<(), Error> {
    let file = if args.float { weights::float_file } else { weights::fixed_file };
    // Which default it is, the frame's record says.
    let networks =
        args.weights.as_deref().map_or(Tone::ALL.map(weights::default_for).to_vec(), |name| vec![name]);
    let files = Files::new(ui).reads_all(networks.into_iter().filter_map(file));
    let lens = args.stated_lens()?;
    let files = files.reads_all(lens.into_iter().flat_map(|lens| lens.files));
    let files = files.reads_all(&args.raw).reads_all(args.raw.iter().map(|raw| record::path_of(raw)));
    let mut files = files.may_write("--words", args.words.as_deref().map(words::file));
    for job in jobs {
        files = files.writes_picture("--out", &job.out)?.may_write("--board", job.codes_file());
    }
    files.check()
}

/// What was computed, and in how many seconds.
fn timed<T, E>(compute: impl FnOnce() -> Result<T, E>) -> Result<(T, f64), E> {
    let start = Instant::now();
    compute().map(|made| (made, start.elapsed().as_secs_f64()))
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

/// A frame as the network is to see it, and what is known of it.
struct Taken {
    frame: RawFrame,
    record: Option<RawRecord>,
    /// The camera that took it, where anybody says.
    camera: Option<Camera>,
    rendering: Rendering,
}

impl Job<'_> {
    /// Reads, computes and writes; gives what there is to report.
    fn run(&self, ui: &Ui) -> Result<Value, Error> {
        let taken = self.open(ui)?;
        if taken.record.is_none() {
            self.remark(&taken.frame, ui);
        }
        let made = if self.args.float { self.float(&taken, ui)? } else { self.fixed(&taken, ui)? };
        let (height, width) = taken.frame.size();
        let per_megapixel = made.seconds / ((height * width) as f64 / 1e6);
        ui.say(format!(
            "{}: {width}x{height} by {} in {:.3} s ({per_megapixel:.2} s a megapixel)",
            self.out.display(),
            made.name,
            made.seconds,
        ))?;
        let mut report = json!({
            "method": made.name,
            "raw": self.raw.display().to_string(),
            "picture": self.out.display().to_string(),
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
        Ok(report)
    }

    fn float(&self, taken: &Taken, ui: &Ui) -> Result<Made, Error> {
        let args = self.args;
        let stride = args.stride.map_or(Ok(Stride::PATCH), said::stride)?;
        let tone = self.tone(taken);
        let name = args.network(tone);
        let network = weights::float(name)?;
        ui.used(weights::float_input(name)?);
        self.fits_camera(&network.origin, taken, ui)?;
        let method: Box<dyn Reconstructor> = match args.device.open()? {
            None => Box::new(FloatReconstructor::new(network, stride, Overlap::Hann, Output::Rgb)?),
            Some(device) => Box::new(GpuFloat::new(device, network, stride, Overlap::Hann)?),
        };
        let result = method.reconstruct(&taken.frame).map_err(|e| self.failed(e))?;
        self.save(result.frame, taken)?;
        let name = method.name().to_owned();
        Ok(Made {
            name,
            tone,
            seconds: result.seconds,
            multiplications: result.multiplications,
            more: Value::Null,
        })
    }

    fn fixed(&self, taken: &Taken, ui: &Ui) -> Result<Made, Error> {
        let args = self.args;
        let network = self.fixed_network(taken, ui)?;
        let mut name = format!("{}.fixed", network.origin.name);
        let tone = self.tone(taken);
        let golden = Golden::new(network)?;
        let (out, seconds) = match args.device.open()? {
            None => timed(|| golden.frame(&taken.frame)).map_err(|e| self.failed(e))?,
            Some(device) => {
                name += ".gpu";
                let gpu = GpuGolden::new(device, golden.network().clone(), &name)?;
                timed(|| gpu.frame(&taken.frame)).map_err(|e| self.failed(e))?
            }
        };
        let (picture, shown) = out.picture(&Display::new(args.display, curve(args, tone)));
        let board = self.codes_file();
        if let Some(codes) = &board {
            photo::save(&self.out, &picture.shown_frame(), args.bits)?;
            edof_storage::atomic::write(codes, &picture.yuyv())?;
        } else {
            self.save(out.colour(), taken)?;
        }
        if let Some(folder) = &args.words {
            let boundaries = golden.words(&taken.frame).map_err(|e| self.failed(e))?;
            words::save(folder, &boundaries, &out.frame, &picture)?;
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

    /// Writes a picture of the network's light.
    fn save(&self, mut light: ColourFrame, taken: &Taken) -> Result<(), Error> {
        taken.rendering.apply(&mut light);
        let curve = curve(self.args, self.tone(taken));
        Ok(photo::save(&self.out, &encoded(light, curve), self.args.bits)?)
    }

    /// Where the board's codes go, if they are asked for.
    fn codes_file(&self) -> Option<PathBuf> {
        self.args.board.then(|| self.out.with_extension("yuyv"))
    }

    /// An error that names the raw frame's file.
    fn failed(&self, error: impl std::fmt::Display) -> Error {
        Error::message(format!("{}: {error}", self.raw.display()))
    }

    /// A frame that cannot be read, with the option that says how.
    fn unread(&self, error: RawError) -> Error {
        match (&error, self.args.depth) {
            (RawError::Frame { source: FrameError::Depth(_), .. }, Some(depth)) => {
                Error::message(format!("--depth {depth}: {error}"))
            }
            (RawError::NoSize { .. }, _) => Error::message(format!("{error}: --size 1920x1080, say")),
            _ => error.into(),
        }
    }

    /// Levels that cannot be, with the option that says so, if one does.
    fn level(&self, error: &LevelsError) -> Error {
        let of = |option: &str, given: bool, what: &str| {
            let text = error.to_string();
            if given { text.replacen(what, option, 1) } else { text }
        };
        let text = match error {
            LevelsError::White { .. } => of("--white-level", self.args.white_level.is_some(), "white level"),
            LevelsError::Black { .. } => of("--black-level", self.args.black_level.is_some(), "black level"),
            error => error.to_string(),
        };
        self.failed(text)
    }

    /// What the user says, else what the scene's numbers were taken for, else what suits a sensor's light.
    fn tone(&self, taken: &Taken) -> Tone {
        self.args.tone.or(taken.record.as_ref().map(|r| r.tone)).unwrap_or(Tone::Srgb)
    }

    /// The frame as light, and its record where one lies beside it.
    fn open(&self, ui: &Ui) -> Result<Taken, Error> {
        let (args, raw) = (self.args, self.raw);
        let found = record::load(raw)?;
        let stated = args.stated(args.stated_lens()?.map(|lens| lens.camera));
        let overruled = found.as_ref().map_or(Ok(false), |record| self.overruled(record, &stated, ui))?;
        let record = found.map(|record| record.with(stated.clone()));
        let camera = record.as_ref().map(|record| record.camera.clone()).or(stated.camera);
        let given = raw_options(args);
        let options = record.as_ref().map_or(given, |record| record.options(given));
        let raw::Opened { frame, levels: of_file, rendering: own } =
            raw::open(raw, &options).map_err(|e| self.unread(e))?;
        if let Some(given) = args.phase.filter(|phase| *phase != frame.phase()) {
            return Err(self.failed(format!("says {}; leave --phase {given} out", frame.phase())));
        }
        if let Some(record) = record.as_ref().filter(|_| !overruled) {
            record.check(raw, &frame)?;
        }
        let levels = match &record {
            Some(record) => record.levels(),
            None => {
                let Levels { black, white } = of_file.unwrap_or_default();
                Levels { black: args.black_level.unwrap_or(black), white: args.white_level.or(white) }
            }
        };
        let own = record.as_ref().map_or(own, RawRecord::rendering);
        let rendering = Rendering {
            white_balance: args.white_balance.or(own.white_balance),
            matrix: args.colour_matrix.or(own.matrix),
        };
        let name = raw.file_name().unwrap_or_default().to_string_lossy();
        ui.used(Input::raw_frame(&name, &frame));
        let light = levels.light(&frame).map_err(|e| self.level(&e))?;
        // To the board leads a cable.
        let frame = if args.board { cable::carried(&light) } else { light };
        Ok(Taken { frame, record, camera, rendering })
    }

    /// Whether options take the place of what the record says, which only --force lets them.
    fn overruled(&self, record: &RawRecord, stated: &Stated, ui: &Ui) -> Result<bool, Error> {
        let found = record.contradictions(self.raw, stated);
        let any = !found.is_empty();
        for contradiction in found {
            match contradiction {
                RecordError::Contradicted { path, option, given, recorded } if self.args.force => {
                    ui.note(format!("--{option} {given}: taken, though {} says {recorded}", path.display()));
                }
                error => return Err(error.into()),
            }
        }
        Ok(any)
    }

    fn fixed_network(&self, taken: &Taken, ui: &Ui) -> Result<FixedNetwork, Error> {
        let args = self.args;
        let name = args.network(self.tone(taken));
        let network = weights::fixed(name)?;
        ui.used(weights::fixed_input(name)?);
        self.fits_camera(&network.origin, taken, ui)?;
        match args.stride.map(said::stride).transpose()? {
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

    /// The network must have been trained for the lens that took the frame, as its record or the user says.
    fn fits_camera(&self, origin: &Origin, taken: &Taken, ui: &Ui) -> Result<(), Error> {
        let args = self.args;
        let Some(camera) = &taken.camera else { return Ok(()) };
        if origin.camera.same_lens(camera) {
            return Ok(());
        }
        let fields = origin.camera.differences(camera).join(", ");
        let (name, trained, tone) =
            (args.network(self.tone(taken)), origin.camera.in_words(), self.tone(taken));
        let taken_by = match taken.record {
            Some(_) => format!("{} was taken by {}", self.raw.display(), camera.in_words()),
            None => format!("--camera is {}", camera.in_words()),
        };
        let problem = format!(
            "--weights {name}: trained for the camera {trained}, but {taken_by}, another lens or mask (they differ in {fields})"
        );
        if args.force {
            ui.note(format!("{problem}; used nevertheless"));
            return Ok(());
        }
        let instead = match weights::trained_for(camera, tone) {
            Some(name) => format!("use --weights {name}"),
            None => lens::how_to_train(camera),
        };
        Err(Error::message(format!("{problem}; {instead}")))
    }

    /// Of a frame without a record: what of it says that it was read otherwise than it was taken.
    fn remark(&self, frame: &RawFrame, ui: &Ui) {
        let args = self.args;
        let raw = self.raw.display();
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

impl Args {
    /// The camera that the user states, if any.
    fn stated_lens(&self) -> Result<Option<Lens>, Error> {
        self.camera.as_deref().map(|name| lens::resolve(name, self.psf_bank.as_deref())).transpose()
    }

    /// All that the user states of a frame.
    fn stated(&self, camera: Option<Camera>) -> Stated {
        let alignment = raw_options(self).alignment;
        let Self { phase, depth, size, packing, black_level, white_level, tone, .. } = *self;
        Stated { phase, depth, alignment, size, packing, black_level, white_level, tone, camera }
    }

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

fn raw_options(args: &Args) -> RawOptions {
    RawOptions {
        phase: args.phase.unwrap_or_default(),
        depth: args.depth,
        size: args.size,
        alignment: args.align.as_deref().map(|a| if a == "top" { Alignment::Top } else { Alignment::Bottom }),
        order: if args.order == "big" { ByteOrder::Big } else { ByteOrder::Little },
        packing: if args.video { Packing::Video } else { args.packing.unwrap_or_default() },
    }
}

fn green_first(phase: CfaPhase) -> bool {
    phase.channel(0, 0) == Channel::Green
}
