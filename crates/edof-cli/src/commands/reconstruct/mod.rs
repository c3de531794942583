//! `edof reconstruct`: from a raw frame to a picture.

mod options;
mod suits;

pub use options::Args;

use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use crate::words;
use edof_core::camera::Camera;
use edof_core::frame::FrameError;
use edof_core::overlap::Overlap;
use edof_core::reconstructor::Multiplications;
use edof_core::storage::provenance::Input;
use edof_core::{CfaPhase, Channel, ColourFrame, RawFrame, Reconstructor, Stride, Tone, cable};
use edof_golden::{Counts, Display, Golden};
use edof_gpu::{GpuFloat, GpuGolden};
use edof_io::camera_raw::CameraRawError;
use edof_io::dng::Finish;
use edof_io::levels::{Levels, LevelsError};
use edof_io::picture::Format;
use edof_io::raw::{RawError, RawFormat};
use edof_io::read_warnings::{ReadWarning, read_warnings};
use edof_io::record::{self, RawRecord, RecordError, Stated};
use edof_io::rendering::Rendering;
use edof_io::{photo, raw};
use edof_network::FixedNetwork;
use edof_network::fixed_network::layer_names;
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use options::{curve, overrides, raw_options};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// # Errors
/// A frame, network or option that cannot be used, or a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    if ![8, 16].contains(&args.bits) {
        return Err(Error::message(format!("--bits {}: must be 8 or 16", args.bits)));
    }
    let jobs = jobs(&args)?;
    check_files(&args, &jobs, ui)?;
    if jobs.len() > 1 {
        // An unusable frame is reported before the first is computed.
        jobs.iter().try_for_each(|job| job.open(ui).map(drop))?;
    }
    let mut reports = vec![];
    let bar = (jobs.len() > 1).then(|| ui.progress(jobs.len() as u64, "frames"));
    for job in &jobs {
        interrupt::check()?;
        reports.push(job.run(ui)?);
        bar.iter().for_each(|bar| bar.set(reports.len() as u64));
    }
    drop(bar);
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
            "--out {}: {} frames need a folder, not a picture; name one, as in --out sharp/",
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
    // Which network it is without --weights, the frame's record says.
    let networks: Vec<&str> = match args.weights.as_deref() {
        Some(name) => vec![name],
        None => weights::names(),
    };
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
    /// Rows and columns of the picture.
    size: (usize, usize),
    tone: Tone,
    seconds: f64,
    multiplications: Option<Multiplications>,
    /// What else there is to report.
    more: Value,
}

/// A frame as the network is to see it, and what is known of it.
struct Taken {
    frame: RawFrame,
    /// What its words stand for.
    values: Tone,
    record: Option<RawRecord>,
    /// The camera that took it, where anybody says.
    camera: Option<Camera>,
    rendering: Rendering,
    /// What its file asks to be done with the picture.
    finish: Finish,
}

impl Taken {
    /// The frame in values of a network.
    fn sent(&self, values: Tone) -> Cow<'_, RawFrame> {
        match (self.values, values) {
            (Tone::Linear, to) => self.frame.encoded(to),
            (from, Tone::Linear) => self.frame.decoded(from),
            _ => Cow::Borrowed(&self.frame),
        }
    }
}

impl Job<'_> {
    /// Reads, computes and writes; gives what there is to report.
    fn run(&self, ui: &Ui) -> Result<Value, Error> {
        let taken = self.open(ui)?;
        if taken.record.is_none() {
            self.remark(&taken.frame, ui);
        }
        let made = if self.args.float { self.float(&taken, ui)? } else { self.fixed(&taken, ui)? };
        let (height, width) = made.size;
        let per_megapixel = made.seconds / ((height * width) as f64 / 1e6);
        ui.say(format!(
            "{}: {width}x{height} by {} in {:.3} s ({per_megapixel:.2} s per megapixel)",
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
        let name = self.network(taken);
        let network = weights::float(name)?;
        ui.used(weights::float_input(name)?);
        self.suits(&network.origin, taken, ui)?;
        let method: Box<dyn Reconstructor> = match args.device.open()? {
            None => Box::new(FloatReconstructor::new(network, stride, Overlap::Hann, Output::Rgb)?),
            Some(device) => Box::new(GpuFloat::new(device, network, stride, Overlap::Hann)?),
        };
        let result = method.reconstruct(&taken.sent(Tone::Linear)).map_err(|e| self.failed(e))?;
        let size = self.save(result.frame, taken)?;
        let name = method.name().to_owned();
        Ok(Made {
            name,
            size,
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
        let values = network.origin.values;
        let (golden, raw) = (Golden::new(network)?, taken.sent(values));
        // To the board leads a cable.
        let raw = if args.board { Cow::Owned(cable::carried(&raw)) } else { raw };
        let (out, seconds) = match args.device.open()? {
            None => timed(|| golden.frame(&raw)).map_err(|e| self.failed(e))?,
            Some(device) => {
                name += ".gpu";
                let gpu = GpuGolden::new(device, golden.network().clone(), &name)?;
                timed(|| gpu.frame(&raw)).map_err(|e| self.failed(e))?
            }
        };
        let (picture, shown) = out.picture(&Display::of_values(values, args.display, curve(args, tone)));
        let board = self.codes_file();
        let size = if let Some(codes) = &board {
            if !taken.finish.is_identity() {
                let raw = self.raw.display();
                ui.note(format!("{raw}: the board neither corrects the lens nor crops or turns the picture"));
            }
            photo::save(&self.out, &picture.shown_frame(), args.bits)?;
            edof_core::storage::atomic::write(codes, &picture.yuyv())?;
            taken.frame.size()
        } else {
            let mut light = out.colour();
            values.lighten(&mut light);
            self.save(light, taken)?
        };
        if let Some(folder) = &args.words {
            let boundaries = golden.words(&raw).map_err(|e| self.failed(e))?;
            words::save(folder, &boundaries, &out.frame, &picture)?;
        }
        let more = json!({
            "counters": counters(&out.counts),
            "display": { "mode": args.display, "clamped_chroma": shown.clamped_chroma, "out_of_gamut": shown.out_of_gamut },
            "board": board.map(|file| file.display().to_string()),
            "words": args.words.as_deref().map(|folder| words::file(folder).display().to_string()),
        });
        let multiplications = Some(out.counts.multiplications(golden.network()));
        Ok(Made { name, size, tone, seconds, multiplications, more })
    }

    /// Writes a picture of the network's light; gives its rows and columns.
    fn save(&self, mut light: ColourFrame, taken: &Taken) -> Result<(usize, usize), Error> {
        taken.finish.correct(&mut light);
        taken.rendering.apply(&mut light);
        let curve = curve(self.args, self.tone(taken));
        let picture = curve.encoded(taken.finish.frame(light));
        photo::save(&self.out, &picture, self.args.bits)?;
        Ok(picture.size())
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
                Error::message(format!("--bit-depth {depth}: {error}"))
            }
            (RawError::Frame { source: source @ FrameError::Depth(_), .. }, None)
                if record::is_beside(self.raw) =>
            {
                self.of_record(&source.to_string())
            }
            (RawError::NoSize { .. }, _) if self.args.video => {
                self.failed("--video has no header; state its size as WIDTHxHEIGHT by --size 1920x1080, say")
            }
            (RawError::NoSize { .. }, _) => Error::message(format!("{error}: --size 1920x1080, say")),
            (RawError::CameraRaw(CameraRawError::Levels { source, .. }), _) => self.level(source),
            _ => error.into(),
        }
    }

    /// Levels that cannot be, with the option that says so, if one does.
    fn level(&self, error: &LevelsError) -> Error {
        let of = |option: &str, given: bool, what: &str| {
            let text = error.to_string();
            if given { text.replacen(what, option, 1) } else { text }
        };
        let (given, text) = match error {
            LevelsError::White { .. } => {
                let given = self.args.white_level.is_some();
                (given, of("--white-level", given, "white level"))
            }
            LevelsError::Black { .. } => {
                let given = self.args.black_level.is_some();
                (given, of("--black-level", given, "black level"))
            }
            error => (true, error.to_string()),
        };
        if !given && record::is_beside(self.raw) {
            return self.of_record(&text);
        }
        self.failed(text)
    }

    /// What the record beside the frame says wrongly.
    fn of_record(&self, why: &str) -> Error {
        let path = record::path_of(self.raw);
        Error::message(format!("{}: {why}; correct the file, or move it elsewhere", path.display()))
    }

    /// What the user says, else what the scene's numbers were taken for, else what suits a sensor's light.
    fn tone(&self, taken: &Taken) -> Tone {
        self.args.tone.or(taken.record.as_ref().map(|r| r.tone)).unwrap_or(Tone::Srgb)
    }

    /// The frame as light, and its record where one lies beside it.
    fn open(&self, ui: &Ui) -> Result<Taken, Error> {
        let (args, raw) = (self.args, self.raw);
        let sidecar = record::load(raw)?;
        sidecar.remark().into_iter().for_each(|line| ui.note(line));
        let found = sidecar.record();
        let stated = args.stated(args.stated_lens()?.map(|lens| lens.camera));
        let overruled = found.as_ref().map_or(Ok(false), |record| self.overruled(record, &stated, ui))?;
        let record = found.map(|record| record.with(stated.clone()));
        let camera = record.as_ref().map(|record| record.camera.clone()).or(stated.camera);
        let given = raw_options(args);
        let options = record.as_ref().map_or(given, |record| record.options(given));
        let overrides = overrides(args, record.as_ref());
        let opened = raw::open(raw, &options, &overrides).map_err(|e| self.unread(e))?;
        self.check_options(opened.format)?;
        for note in &opened.notes {
            ui.note(format!("{}: {note}", raw.display()));
        }
        let frame = opened.frame;
        if let Some(record) = record.as_ref().filter(|_| !overruled) {
            record.check(raw, &frame)?;
        }
        let name = raw.file_name().unwrap_or_default().to_string_lossy();
        ui.used(Input::raw_frame(&name, &frame));
        let frame = if opened.format.states_everything() {
            frame
        } else {
            let levels = Levels { black: overrides.black.unwrap_or_default(), white: overrides.white };
            levels.light(&frame).map_err(|e| self.level(&e))?
        };
        let rendering = Rendering {
            white_balance: overrides.white_balance.or(opened.rendering.white_balance),
            matrix: overrides.matrix.or(opened.rendering.matrix),
        };
        let values = record.as_ref().map_or(Tone::Linear, |record| record.values);
        Ok(Taken { frame, values, record, camera, rendering, finish: opened.finish })
    }

    /// Rejects options that only files without a description of their values need, beside a camera's file.
    fn check_options(&self, format: &RawFormat) -> Result<(), Error> {
        if !format.states_everything() {
            return Ok(());
        }
        let args = self.args;
        let given = [
            ("--size", args.size.map(|size| format!(" {size}"))),
            ("--bit-depth", args.depth.map(|depth| format!(" {depth}"))),
            ("--align", args.align.as_ref().map(|align| format!(" {align}"))),
            ("--packing", args.packing.map(|packing| format!(" {}", packing.name()))),
            ("--video", args.video.then(String::new)),
        ];
        match given.into_iter().find_map(|(name, value)| Some((name, value?))) {
            None => Ok(()),
            Some((name, value)) => Err(Error::message(format!(
                "{name}{value}: has no effect on {}, {}, which states it; leave {name} out",
                self.raw.display(),
                format.noun
            ))),
        }
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

    /// The network's name or file: the user's, else the one for this tone and for the noise that the frame's record states.
    fn network(&self, taken: &Taken) -> &str {
        self.args.network(self.tone(taken), taken.record.as_ref().map(|record| record.noise))
    }

    fn fixed_network(&self, taken: &Taken, ui: &Ui) -> Result<FixedNetwork, Error> {
        let args = self.args;
        let name = self.network(taken);
        let network = weights::fixed(name)?;
        ui.used(weights::fixed_input(name)?);
        self.suits(&network.origin, taken, ui)?;
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

    /// Of a frame without a record: what of it says that it was read otherwise than it was taken.
    fn remark(&self, frame: &RawFrame, ui: &Ui) {
        let args = self.args;
        let raw = self.raw.display();
        for warning in read_warnings(frame) {
            match warning {
                ReadWarning::Dim(brightest) => {
                    let advice = match (args.depth, args.align.as_deref()) {
                        (None, None) if args.size.is_some() => {
                            "if its values have fewer than 16 bits, give --bit-depth"
                        }
                        (None, None) => {
                            "if its values have fewer than 16 bits, give --bit-depth, and --align bottom where they lie at the \
                             bottom of each word"
                        }
                        _ => "a dark picture, or --bit-depth and --align are not as it was taken",
                    };
                    ui.note(format!("{raw}: brightest pixel is {brightest} of 65535; {advice}"));
                }
                ReadWarning::Phase => {
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

fn green_first(phase: CfaPhase) -> bool {
    phase.channel(0, 0) == Channel::Green
}
