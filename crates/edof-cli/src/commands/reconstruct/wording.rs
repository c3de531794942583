//! Errors and remarks of a reconstruction, by the options that they are about.

use super::options::Args;
use crate::error::Error;
use crate::{lens, weights};
use edof::job::{FrameNote, JobError};
use edof_core::camera::Camera;
use edof_core::frame::FrameError;
use edof_core::words::number;
use edof_core::{CfaPhase, Channel, Tone};
use edof_io::camera_raw::CameraRawError;
use edof_io::levels::LevelsError;
use edof_io::raw::RawError;
use edof_io::record::{self, Contradiction, Field, RecordError};
use edof_network::network::Condition;
use std::path::Path;

/// Words about frames.
pub(super) struct Wording<'a> {
    pub(super) args: &'a Args,
}

impl Wording<'_> {
    /// A failure of the job.
    pub(super) fn failed(&self, error: JobError) -> Error {
        Error::message(match error {
            JobError::Raw(error) => return self.unread(error),
            JobError::Levels { path, source } => return self.level(&path, &source),
            JobError::Record(RecordError::OtherFrame { path, raw, phase, depth, alignment }) => format!(
                "{}: describes another frame than {}; move it elsewhere if the frame was replaced, else read the frame as it says: \
                 --phase {phase} --bit-depth {depth} --align {alignment}",
                path.display(),
                raw.display()
            ),
            JobError::Contradicted(Contradiction { path, field, given, recorded }) => {
                let option = option(field);
                format!(
                    "{option} {given}: {} says {recorded}; leave {option} out, or --force takes what is stated",
                    path.display()
                )
            }
            JobError::StatedByFile { path, field: Field::Order, format } => {
                format!("--order big: has no effect on {}, {format}; leave --order out", path.display())
            }
            JobError::StatedByFile { path, field, format } => {
                let (option, value) = self.given(field);
                format!(
                    "{option}{value}: has no effect on {}, {format}, which states it; leave {option} out",
                    path.display()
                )
            }
            JobError::OtherLens(other) => {
                let instead = match weights::trained_for(&other.camera, other.tone) {
                    Some(name) => format!("use --weights {name}"),
                    None => lens::how_to_train(&other.camera),
                };
                format!("--weights {}; {instead}", other.in_words("--camera"))
            }
            JobError::OtherStride { network, asked, quantized } => format!(
                "--stride {asked}: {network} is quantized for a stride of {}; make one by 'edof quantize --stride {asked}', or use --float",
                quantized.pixels(),
                asked = asked.pixels(),
            ),
            JobError::Device { device, source } => format!("--device {device}: {source}"),
            error => return error.into(),
        })
    }

    /// A frame that cannot be read, with the option that says how.
    fn unread(&self, error: RawError) -> Error {
        match (&error, self.args.depth) {
            (RawError::Frame { source: FrameError::Depth(_), .. }, Some(depth)) => {
                Error::message(format!("--bit-depth {depth}: {error}"))
            }
            (RawError::Frame { path, source: source @ FrameError::Depth(_) }, None)
                if record::is_beside(path) =>
            {
                of_record(path, &source.to_string())
            }
            (RawError::NoSize { path, .. }, _) if self.args.video => {
                of_raw(path, "--video has no header; state its size as WIDTHxHEIGHT by --size 1920x1080, say")
            }
            (RawError::NoSize { .. }, _) => Error::message(format!("{error}: --size 1920x1080, say")),
            (RawError::CameraRaw(CameraRawError::Levels { path, source }), _) => self.level(path, source),
            _ => error.into(),
        }
    }

    /// Levels that cannot be, with the option that says so, if one does.
    fn level(&self, raw: &Path, error: &LevelsError) -> Error {
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
        if !given && record::is_beside(raw) { of_record(raw, &text) } else { of_raw(raw, &text) }
    }

    /// The option of a field, and its value as it was given.
    fn given(&self, field: Field) -> (&'static str, String) {
        let args = self.args;
        let value = match field {
            Field::Size => args.size.map(|size| size.to_string()),
            Field::BitDepth => args.depth.map(|depth| depth.to_string()),
            Field::Alignment => args.align.map(|alignment| alignment.to_string()),
            Field::Packing if args.video => return ("--video", String::new()),
            Field::Packing => match (&args.packing, &args.phase) {
                (None, Some(phase)) => return ("--phase", format!(" {}", phase.word)),
                (packing, _) => packing.as_ref().map(|packing| packing.word.clone()),
            },
            _ => None,
        };
        (option(field), value.map_or_else(String::new, |value| format!(" {value}")))
    }

    /// A remark of the job.
    pub(super) fn note(&self, note: FrameNote) -> String {
        match note {
            FrameNote::Overruled(Contradiction { path, field, given, recorded }) => {
                format!("{} {given}: taken, though {} says {recorded}", option(field), path.display())
            }
            FrameNote::Dim { path, brightest, is_light } => {
                let remedy = if is_light {
                    "a dark picture, or --white-level is to state full light in the file's place"
                } else {
                    self.of_dim()
                };
                format!("{}: brightest pixel is {brightest} of 65535; {remedy}", path.display())
            }
            FrameNote::FewerBits { path, bits, black } => format!(
                "{}: every value is a multiple of {}, as of {bits} bits at the top of 16, and --black-level {} is taken as of 16 bits; if it is of {bits}, \
                 state --bit-depth {bits} --align top",
                path.display(),
                1 << (16 - bits),
                number(black)
            ),
            FrameNote::OtherPhase { path, phase } => {
                format!("{}: {}", path.display(), of_other_phase(phase))
            }
            FrameNote::OtherLens(other) => {
                format!("--weights {}; used nevertheless", other.in_words("--camera"))
            }
            FrameNote::OtherClearLens(other) => format!(
                "{}: network {} was trained for another lens without a mask, {}; the blur of {} is {:.1} times as large; one of its own may be better: {}",
                other.path.display(),
                other.network,
                other.trained.name,
                other.camera.name,
                other.blur_ratio(),
                lens::how_to_train(&other.camera)
            ),
            FrameNote::OtherTone { path, network, camera, trained, tone } => {
                format!(
                    "--weights {network}: trained on pictures of tone {trained}, {} is of {tone}: {}",
                    path.display(),
                    of_other_tone(&camera, tone),
                )
            }
            FrameNote::OtherNoise { path, network, trained, noise, better } => {
                let trained: Vec<String> = trained.iter().map(Condition::noise_in_words).collect();
                let instead = match better {
                    Some(better) => format!("use --weights {better}"),
                    None => "no network of the program for this lens is nearer".to_owned(),
                };
                format!(
                    "{}: its noise is {noise}, --weights {network} was trained for noise {}: expect noise that is left, or detail \
                     that is lost; {instead}",
                    path.display(),
                    trained.join(" or "),
                )
            }
            FrameNote::ForeignRecord { path } => {
                format!("{}: is not a raw-frame record of edof; passed over", path.display())
            }
            FrameNote::RawFile { path, text } => format!("{}: {text}", path.display()),
            FrameNote::CurveNotStated { path } => format!(
                "{}: a PPM has no place to state its curve, and other programs will take it for sRGB's; .png and .tif state it",
                path.display()
            ),
            FrameNote::NotFinished { path, left_out } => {
                format!("{}: not applied, as the board does not: {}", path.display(), left_out.join(", "))
            }
        }
    }

    /// What to do with a dark frame.
    fn of_dim(&self) -> &'static str {
        match (self.args.depth, self.args.align) {
            (None, None) if self.args.size.is_some() => {
                "if its values have fewer than 16 bits, give --bit-depth"
            }
            (None, None) => {
                "if its values have fewer than 16 bits, give --bit-depth, and --align bottom where they lie at the \
                 bottom of each word"
            }
            _ => "a dark picture, or --bit-depth and --align are not as it was taken",
        }
    }
}

fn of_raw(raw: &Path, why: &str) -> Error {
    Error::message(format!("{}: {why}", raw.display()))
}

/// What the record beside a frame says wrongly.
fn of_record(raw: &Path, why: &str) -> Error {
    let path = record::path_of(raw);
    Error::message(format!("{}: {why}; correct the file, or move it elsewhere", path.display()))
}

/// The option that states a field.
pub(in crate::commands) const fn option(field: Field) -> &'static str {
    match field {
        Field::Phase => "--phase",
        Field::BitDepth => "--bit-depth",
        Field::Alignment => "--align",
        Field::Size => "--size",
        Field::Packing => "--packing",
        Field::Order => "--order",
        Field::BlackLevel => "--black-level",
        Field::WhiteLevel => "--white-level",
        Field::Tone => "--tone",
        Field::Camera => "--camera",
        Field::Gain => "--gain",
    }
}

/// Returns what to expect of a network for a camera on frames of a tone that it was not trained on, and what to do.
pub(in crate::commands) fn of_other_tone(camera: &Camera, tone: Tone) -> String {
    let instead = match weights::trained_on(camera, tone) {
        Some(name) => format!("use --weights {name}"),
        None => format!("train one by 'edof train --tone {tone}'"),
    };
    format!("expect {} (docs/decisions/0041-one-tone.md); {instead}", loss_of(tone))
}

/// What a network loses on frames of a tone where it was trained on the other one, as measured with the program's own.
const fn loss_of(tone: Tone) -> &'static str {
    match tone {
        Tone::Srgb => "about 2 dB less than of one that was, at any noise",
        Tone::Linear => "about 3 dB less than of one that was, 1 dB where noise is 0.01",
    }
}

/// Says that frames look as if they were of another phase.
pub(in crate::commands) fn of_other_phase(phase: CfaPhase) -> String {
    let others = CfaPhase::ALL.into_iter().filter(|p| green_first(*p) != green_first(phase));
    let others: Vec<String> = others.map(|p| format!("--phase {p}")).collect();
    format!(
        "what --phase {phase} takes for green differs as red and blue do; it may have been taken with {}",
        others.join(" or ")
    )
}

fn green_first(phase: CfaPhase) -> bool {
    phase.channel(0, 0) == Channel::Green
}
