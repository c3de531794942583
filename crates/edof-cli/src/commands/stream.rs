//! `edof stream`: from a stream of raw frames to a stream of pictures.

use crate::commands::reconstruct::{Gamma, of_other_phase, of_other_tone, option};
use crate::commands::sensor;
use crate::error::Error;
use crate::files::Files;
use crate::gain;
use crate::interrupt;
use crate::raw_words::{self, PixelWord, Pixels};
use crate::ui::Ui;
use crate::weights;
use clap::ValueEnum;
use edof::job::{Balance, FirstFrame, Layout, Pace, StreamError, StreamJob, VideoFormat};
use edof_core::words::{count, number};
use edof_core::{Noise, Tone};
use edof_io::levels::{Black, Levels};
use edof_io::packing::{ByteOrder, Packing};
use edof_io::raw::{self, Alignment, Size};
use edof_io::record::{self, Contradiction, Stated};
use edof_io::rendering::{ColourMatrix, WhiteBalance};
use edof_io::y4m::Rate;
use edof_network::network::Origin;
use serde_json::json;
use std::cell::Cell;
use std::fs::File;
use std::io::{self, Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Reconstruct a stream of raw Bayer frames into a stream of pictures
///
/// RAW is a pipe, a device or a file of frames without headers, one after the other; - is standard input. Every frame becomes a picture of 8-bit Y'CbCr 4:2:2
/// (BT.709, studio range), in the order of the frames. The network runs in the board's integers.
///
/// A slow reader of the pictures slows the stream down. With --live the oldest frame that waits is left out instead, and counted.
/// Once a second, a line on standard error states the frames so far, the rate, the frames left out, and the latency: the time from a frame's last byte in
/// to its last byte out. Ctrl-C ends the stream after a whole picture.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  camera | edof stream - --size 1920x1080 --packing 12p --out - | ffplay -
  edof stream frames.raw --size 1456x1088 --packing mipi10 --phase gbrg --out frames.y4m
  edof stream - --size 1920x1080 --packing 12p --white-balance auto --live --format yuyv422 --out -
  edof stream frames.raw --size 640x480 --packing bytes --gain 4 --out - | ffmpeg -i - frames.mp4")]
pub struct Args {
    /// Raw frames; - is standard input
    raw: PathBuf,

    /// Size of a frame in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Size,

    /// Packing of the pixels: words (16 bits each), bytes (8), mipi10, mipi12 (MIPI RAW10, RAW12), 10p, 12p (PFNC), 12packed (GigE Vision) or 2vuy
    /// (video for the board's cable); or a camera's name for its pixels, as in BayerRG12p, RG10 or pRCC, which states the phase, too [default: words]
    #[arg(long, value_parser = raw_words::packing)]
    packing: Option<PixelWord>,

    /// Colour filter of the first 2x2 pixels: rggb, grbg, gbrg or bggr, or a camera's name as in BayerGR [default: rggb]
    #[arg(long, value_parser = raw_words::phase, value_name = "CFA")]
    phase: Option<PixelWord>,

    /// Bits per sensor value in words of 16 bits, 8 to 16, at the bottom of each word [default: 16]
    #[arg(long = "bit-depth", value_name = "BITS")]
    depth: Option<u32>,

    /// Bytes from the beginning of one line to that of the next, where lines are padded (V4L2's bytesperline) [default: those of its pixels]
    #[arg(long, value_name = "BYTES")]
    line_bytes: Option<usize>,

    /// Byte order of words
    #[arg(long, value_parser = raw_words::byte_order(), default_value = "little")]
    order: ByteOrder,

    /// Correction of the sensor, as edof sensor writes it: offsets, shading and defects; it states darkness and full light
    #[arg(long, value_name = "FILE", conflicts_with_all = ["black_level", "white_level"])]
    sensor: Option<PathBuf>,

    /// Sensor value of darkness; or four, with commas, for the 2x2 pixels from the first on, row by row
    #[arg(long, value_name = "LEVEL", default_value = "0")]
    black_level: Black,

    /// Sensor value of full light [default: the largest value of the sensor's bits]
    #[arg(long, value_name = "LEVEL")]
    white_level: Option<f64>,

    /// White balance: gains of red, green and blue as in 2.1,1,1.6; or auto, which makes the mean of each frame grey and follows slowly [default: none]
    #[arg(long, value_name = "R,G,B|auto")]
    white_balance: Option<Balanced>,

    /// Matrix from balanced sensor colours to linear sRGB: nine numbers, row by row, each row adding up to 1 [default: none]
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true)]
    colour_matrix: Option<ColourMatrix>,

    /// Transfer curve of the pictures
    #[arg(long, value_name = "CURVE", default_value = "srgb")]
    gamma: Gamma,

    /// Network: a name such as edof-t4w12-outer-light, or a weight file [default: edof-t4w12-clear-light, for a lens without a mask]
    #[arg(long, value_name = "NAME|FILE")]
    weights: Option<String>,

    /// Gain of the sensor, up to 1000: the network of that noise is taken. It is 10000 divided by the electrons of white, and 1 where that is less
    /// [default: the network for most noises]
    #[arg(long, value_name = "GAIN")]
    gain: Option<f64>,

    /// What to write: y4m (states size and rate), yuv422p (planes) or yuyv422 (bytes Y Cb Y Cr)
    #[arg(long, value_enum, default_value = "y4m", value_name = "FORMAT", hide_possible_values = true)]
    format: Form,

    /// Frames per second that y4m states: a number, or a ratio as in 30000:1001 [default: 30]
    #[arg(long, value_name = "RATE")]
    fps: Option<Rate>,

    /// Leave out the oldest waiting frame where frames come faster than they are computed
    #[arg(long)]
    live: bool,

    /// Pictures to write: a file, a pipe or a device; - is standard output
    #[arg(long, value_name = "FILE|-")]
    out: PathBuf,
}

/// A white balance as an option has it.
#[derive(Debug, Clone, Copy)]
struct Balanced(Balance);

impl FromStr for Balanced {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self(Balance::Auto)),
            _ => match text.parse::<WhiteBalance>() {
                Ok(balance) => Ok(Self(Balance::Fixed(balance))),
                Err(error) => Err(format!("{error}, or auto")),
            },
        }
    }
}

/// Part of full scale above which the least value of a frame says that darkness may not be stated: sensors have 4 to 12 %.
const GREY: f64 = 0.03;

/// Share of the values below black from which on black may be misstated: of a frame without light, half of them are.
const LOST: f64 = 0.75;

/// Bytes that show a format.
const HEAD: u64 = 16;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// YUV4MPEG2
    Y4m,
    /// Planes
    Yuv422p,
    /// Packed
    Yuyv422,
}

/// # Errors
/// Options, a network or frames that cannot be used, a cut frame, an output that cannot be written, or Ctrl-C.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let name = args.network()?;
    args.check_files(&name, ui)?;
    let job = args.job(&name, ui)?;
    job.check().map_err(|error| args.failed(&error))?;
    let input = args.input()?;
    args.check_length(&job.layout)?;
    args.check_record(&job.layout)?;
    // Said once, after what may be refused.
    let network = Cell::new(Some(trained_for(&name, &job.network.origin)));
    let name_network = |pace: &Pace| {
        network.take().into_iter().for_each(|line| {
            ui.note(line);
            args.doubts(&job, pace).into_iter().for_each(|line| ui.note(line));
        });
    };
    let tell = |pace: &Pace| {
        name_network(pace);
        ui.status(in_words(pace), &json!({ "stream": pace }));
    };
    let done =
        job.run(input, args.output()?, &tell, &interrupt::flow).map_err(|error| args.failed(&error))?;
    let pace = &done.pace;
    if pace.frames == 0 && !done.is_closed && !done.is_stopped {
        return Err(Error::message(format!("{}: ended before the first frame", args.raw_in_words())));
    }
    if done.is_closed {
        ui.note(format!(
            "{}: was closed by its reader after {}",
            args.out_in_words(),
            count(pace.frames as usize, "picture")
        ));
    }
    name_network(pace);
    ui.status(format!("in all {}", in_words(pace)), &json!({ "streamed": pace }));
    ui.json(pace)?;
    if done.is_stopped { Err(Error::Interrupted) } else { Ok(()) }
}

fn in_words(pace: &Pace) -> String {
    format!(
        "{}, {:.1} frames/s, {} left out, latency {:.0} ms, at most {:.0} ms",
        count(pace.frames as usize, "frame"),
        pace.per_second,
        pace.dropped,
        pace.latency_ms,
        pace.most_latency_ms,
    )
}

/// Returns what a network was trained for, which a stream does not state: its lens, and its tone where it is not that of light.
fn trained_for(network: &str, origin: &Origin) -> String {
    let lens = format!("network {network}, trained for the lens {}", origin.camera.name);
    let tones: Vec<Tone> = origin.conditions.iter().map(|condition| condition.tone).collect();
    match tones.first().filter(|_| !tones.contains(&Tone::Srgb)) {
        None => lens,
        Some(tone) => {
            format!("{lens} on pictures of tone {tone}: {}", of_other_tone(&origin.camera, Tone::Srgb))
        }
    }
}

/// Whether a path is a pipe or a device, which takes pictures as they come.
#[cfg(unix)]
fn is_live_place(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = std::fs::metadata(path).map(|what| what.file_type());
    kind.is_ok_and(|kind| kind.is_fifo() || kind.is_char_device())
}

/// Whether a path is a pipe or a device, which takes pictures as they come.
#[cfg(not(unix))]
const fn is_live_place(_: &Path) -> bool {
    false
}

/// Largest sensor value.
fn full(layout: &Layout) -> u32 {
    (1 << layout.depth()) - 1
}

fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

impl Args {
    /// Name or file of the network.
    fn network(&self) -> Result<String, Error> {
        let usual = self.weights.as_deref().unwrap_or_else(|| weights::clear_for(Tone::Srgb));
        gain::check(self.gain, self.weights.as_deref())?;
        let class = |gain| weights::for_noise(usual, Tone::Srgb, Noise::of_gain(gain));
        Ok(self.gain.map_or(usual, class).to_owned())
    }

    fn check_files(&self, network: &str, ui: &Ui) -> Result<(), Error> {
        if is_standard(&self.out) && ui.json_has_stdout() {
            return Err(Error::message(
                "--json: standard output has the pictures; name a file, as in --json pace.json",
            ));
        }
        let mut files = Files::new(ui).reads_all(weights::fixed_file(network)).reads_all(&self.sensor);
        if !is_standard(&self.raw) {
            files = files.reads(&self.raw);
        }
        if !is_standard(&self.out) && !is_live_place(&self.out) {
            files = files.writes("--out", &self.out);
        }
        files.check()
    }

    fn job(&self, network: &str, ui: &Ui) -> Result<StreamJob, Error> {
        if self.fps.is_some() && self.format != Form::Y4m {
            return Err(Error::message(
                "--fps: only y4m states a rate; leave --fps out, or use --format y4m",
            ));
        }
        let Pixels { packing, phase, depth } =
            raw_words::pixels(self.packing.as_ref(), self.phase.as_ref(), self.depth)?;
        let packing = packing.unwrap_or_default();
        if let Some(depth) = depth.filter(|_| packing != Packing::Words) {
            return Err(Error::message(format!(
                "--bit-depth {depth}: {} states the bits; leave --bit-depth out, or use --packing words",
                packing.name()
            )));
        }
        let rate = match self.fps {
            Some(rate) => rate,
            None => "30".parse()?,
        };
        raw_words::check_order(self.order, packing)?;
        let fixed = weights::fixed(network)?;
        ui.used(weights::fixed_input(network)?);
        Ok(StreamJob {
            layout: Layout {
                size: self.size,
                packing,
                order: self.order,
                depth,
                phase: phase.unwrap_or_default(),
                levels: Levels { black: self.black_level, white: self.white_level },
                line_bytes: self.line_bytes,
            },
            sensor: sensor::opened(self.sensor.as_deref(), ui)?,
            network: fixed,
            balance: self.white_balance.map_or(Balance::None, |Balanced(balance)| balance),
            matrix: self.colour_matrix,
            curve: self.gamma.into(),
            format: match self.format {
                Form::Y4m => VideoFormat::Y4m(rate),
                Form::Yuv422p => VideoFormat::Planar,
                Form::Yuyv422 => VideoFormat::Packed,
            },
            is_live: self.live,
        })
    }

    /// Rejects a file that does not hold whole frames, before the first is computed.
    fn check_length(&self, layout: &Layout) -> Result<(), Error> {
        let length =
            std::fs::metadata(&self.raw).ok().filter(std::fs::Metadata::is_file).map(|what| what.len());
        let frame = layout.bytes() as u64;
        match length.filter(|_| !is_standard(&self.raw)).filter(|length| *length == 0 || length % frame != 0)
        {
            None => Ok(()),
            Some(found) => Err(Error::message(format!(
                "{}: {found} bytes, expected whole frames of {frame} ({} packed as {}){}; give the right --size, --packing and --line-bytes",
                self.raw.display(),
                self.size,
                layout.packing.name(),
                raw::padded(self.size, layout.packing, self.line_bytes, found).unwrap_or_default()
            ))),
        }
    }

    /// Returns what of the first frame says that it is read otherwise than it was taken; nothing is proved by it.
    fn doubts(&self, job: &StreamJob, pace: &Pace) -> Vec<String> {
        if pace.frames == 0 {
            return vec![];
        }
        let first = &pace.first;
        let phase =
            first.is_of_other_phase.then(|| format!("the first frame: {}", of_other_phase(job.layout.phase)));
        let [dark, lost] = match job.sensor {
            None => [self.dark(&job.layout, first), self.lost(&job.layout, first)],
            Some(_) => [None, None],
        };
        [dark, self.pale(job, first), lost, phase].into_iter().flatten().collect()
    }

    /// Words that look as if they had fewer bits.
    fn dark(&self, layout: &Layout, first: &FirstFrame) -> Option<String> {
        let (depth, [_, largest]) = (layout.depth(), first.values);
        let full = full(layout);
        let is_dark =
            layout.packing == Packing::Words && self.white_level.is_none() && u32::from(largest) < full / 4;
        is_dark.then(|| {
            let bits = (u16::BITS - largest.leading_zeros()).clamp(8, 16);
            format!(
                "the largest value of the first frame is {largest} of {full}, so pictures are dark; if the sensor has fewer than {depth} bits, state them, \
                 as in --bit-depth {bits}"
            )
        })
    }

    /// Darkness that nobody stated.
    fn pale(&self, job: &StreamJob, first: &FirstFrame) -> Option<String> {
        let ([least, _], full) = (first.values, full(&job.layout));
        let (is_zero, black, remedy) = match (&job.sensor, &self.sensor) {
            (Some(sensor), Some(file)) => {
                let black = format!("black of --sensor {} is 0", file.display());
                (sensor.tables().black == [0; 4], black, "measure it by 'edof sensor --dark'")
            }
            _ => (self.black_level == Black::default(), "--black-level is 0".to_owned(), "state it"),
        };
        let is_pale = is_zero && f64::from(least) > GREY * f64::from(full);
        is_pale.then(|| {
            format!(
                "the least value of the first frame is {least} of {full}, and {black}: if the sensor's darkness is that bright, {remedy}, or pictures are pale"
            )
        })
    }

    /// Darkness that was stated too high.
    fn lost(&self, layout: &Layout, first: &FirstFrame) -> Option<String> {
        let (full, largest, bits) = (full(layout), first.values[1], 16 - layout.depth());
        (first.below_black > LOST).then(|| {
            let black = self.black_level.values().into_iter().fold(f64::INFINITY, f64::min);
            let remedy = match bits {
                0 => String::new(),
                bits => format!("; if it is of words of 16 bits, divide it by {}", 1 << bits),
            };
            format!(
                "--black-level {}: {:.0} % of the first frame's values are below it, the largest is {largest} of {full}{remedy}",
                number(black),
                100.0 * first.below_black
            )
        })
    }

    /// Rejects options that contradict the record beside a file of frames.
    fn check_record(&self, layout: &Layout) -> Result<(), Error> {
        if is_standard(&self.raw) || !self.raw.is_file() {
            return Ok(());
        }
        let Some(record) = record::load(&self.raw)?.record() else { return Ok(()) };
        // Values at the top of their words are words of 16 bits to a stream.
        let is_top = record.alignment == Alignment::Top;
        let levels = |level| Some(level).filter(|_| self.sensor.is_none());
        let stated = Stated {
            phase: Some(layout.phase),
            depth: Some(layout.depth()).filter(|_| !is_top),
            size: Some(self.size),
            packing: Some(layout.packing),
            black_level: levels(self.black_level).filter(|_| !is_top),
            ..Stated::default()
        };
        match record.contradictions(&self.raw, &stated).into_iter().next() {
            None => Ok(()),
            Some(Contradiction { path, field, given, recorded }) => {
                let option = option(field);
                Err(Error::message(format!(
                    "{option} {given}: {} says {recorded}; state {option} {recorded}, or move that file elsewhere",
                    path.display()
                )))
            }
        }
    }

    /// Opens the frames. Rejects what begins as a file of a format with headers does.
    fn input(&self) -> Result<Box<dyn Read + Send>, Error> {
        let failed = |error| Error::message(format!("{}: cannot read: {error}", self.raw_in_words()));
        let input = match is_standard(&self.raw) {
            true => standard(io::stdin()).map_err(failed)?,
            false => File::open(&self.raw).map_err(failed)?,
        };
        widen(&input);
        let mut head = vec![];
        (&input).take(HEAD).read_to_end(&mut head).map_err(failed)?;
        match raw::of_content(&head) {
            Some(format) => Err(Error::message(format!(
                "{}: is {}, expected frames without headers, one after the other; 'edof reconstruct' reads {}",
                self.raw_in_words(),
                format.noun,
                format.noun
            ))),
            None => Ok(Box::new(Cursor::new(head).chain(input))),
        }
    }

    fn output(&self) -> Result<Box<dyn Write + Send>, Error> {
        let failed = |error| Error::message(format!("{}: cannot write: {error}", self.out_in_words()));
        let output = match is_standard(&self.out) {
            true => standard(io::stdout()).map_err(failed)?,
            false => File::create(&self.out).map_err(failed)?,
        };
        widen(&output);
        Ok(Box::new(output))
    }

    fn raw_in_words(&self) -> String {
        if is_standard(&self.raw) { "standard input".to_owned() } else { self.raw.display().to_string() }
    }

    fn out_in_words(&self) -> String {
        if is_standard(&self.out) { "standard output".to_owned() } else { self.out.display().to_string() }
    }

    /// A failure by the option or the place that it is about.
    fn failed(&self, error: &StreamError) -> Error {
        let raw = self.raw_in_words();
        Error::message(match error {
            StreamError::Write { .. } => format!("{}: {error}", self.out_in_words()),
            StreamError::Sensor(_) | StreamError::SensorValues(_) => match &self.sensor {
                Some(file) => format!("--sensor {}: {error}", file.display()),
                None => error.to_string(),
            },
            StreamError::Levels(_) => format!("--black-level, --white-level: {error}"),
            StreamError::Frame(_) if self.depth.is_some() => format!("--bit-depth, --size: {error}"),
            StreamError::Frame(_) | StreamError::Geometry(_) => format!("--size {}: {error}", self.size),
            StreamError::Network(_) | StreamError::Thread(_) => error.to_string(),
            StreamError::LineBytes(_) => format!("--line-bytes: {error}"),
            StreamError::Cut { .. }
            | StreamError::Read { .. }
            | StreamError::Value { .. }
            | StreamError::Code { .. } => {
                format!("{raw}: {error}")
            }
        })
    }
}

/// Returns standard input or output past the buffer of the standard library.
#[cfg(unix)]
fn standard(stream: impl std::os::fd::AsFd) -> io::Result<File> {
    Ok(File::from(stream.as_fd().try_clone_to_owned()?))
}

/// Returns standard input or output past the buffer of the standard library.
#[cfg(not(unix))]
fn standard(stream: impl std::os::windows::io::AsHandle) -> io::Result<File> {
    Ok(File::from(stream.as_handle().try_clone_to_owned()?))
}

/// Bytes that a pipe is asked to hold: as many as Linux gives to anybody, so that programs wait for each other a few times a frame.
#[cfg(target_os = "linux")]
const PIPE: usize = 1 << 20;

/// Makes room in a pipe. What is none, or has its room from elsewhere, stays as it is.
fn widen(file: &File) {
    #[cfg(target_os = "linux")]
    let _ = rustix::pipe::fcntl_setpipe_size(file, PIPE);
    #[cfg(not(target_os = "linux"))]
    let _ = file;
}
