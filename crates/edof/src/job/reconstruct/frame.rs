//! A raw frame as light, with what its record, its file and the user state of it.

use crate::job::{FrameNote, JobError};
use edof_core::camera::Camera;
use edof_core::storage::provenance::Input;
use edof_core::{RawFrame, Tone};
use edof_io::dng::{Finish, Overrides};
use edof_io::levels::Levels;
use edof_io::raw::{self, RawFormat, RawOptions};
use edof_io::read_warnings::{ReadWarning, read_warnings};
use edof_io::record::{self, Field, RawRecord, Sidecar, Stated};
use edof_io::rendering::Rendering;
use edof_io::sensor::Correction;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

/// A raw frame in a file, and what a user states of it.
#[derive(Debug, Clone)]
pub struct FrameSource {
    /// The file.
    pub path: PathBuf,
    /// What is stated of the frame; the record beside it must agree.
    pub stated: Stated,
    /// How the file is read where no record states it.
    pub options: RawOptions,
    /// White balance and colour matrix in place of those of the record and the file.
    pub rendering: Rendering,
    /// Whether what is stated takes the place of what the record states.
    pub overrules_record: bool,
    /// Correction of the sensor, in place of all levels.
    pub sensor: Option<Arc<Correction>>,
}

/// A frame as its file holds it, and what is known of it.
struct Found {
    frame: RawFrame,
    /// What its words stand for.
    values: Tone,
    record: Option<RawRecord>,
    rendering: Rendering,
    finish: Finish,
    /// Levels of its values; none where the file's values are light.
    levels: Option<Levels>,
    input: Input,
}

/// A frame as the network is to see it, and what is known of it.
pub(super) struct Taken {
    pub(super) path: PathBuf,
    /// The frame as light.
    pub(super) frame: RawFrame,
    /// Bits of the sensor's values.
    pub(super) depth: u32,
    /// What its words stand for.
    pub(super) values: Tone,
    pub(super) record: Option<RawRecord>,
    /// The camera that took it, if it is known.
    pub(super) camera: Option<Camera>,
    pub(super) rendering: Rendering,
    /// What its file asks to be done with the picture.
    pub(super) finish: Finish,
    /// Whether its file states the levels of its light.
    is_light: bool,
    /// The frame as an input of results.
    pub(super) input: Input,
}

impl Taken {
    /// Returns the frame in values of a network.
    pub(super) fn in_values(&self, values: Tone) -> Cow<'_, RawFrame> {
        match (self.values, values) {
            (Tone::Linear, to) => self.frame.encoded(to),
            (from, Tone::Linear) => self.frame.decoded(from),
            _ => Cow::Borrowed(&self.frame),
        }
    }
}

impl FrameSource {
    /// Returns the frame as light, and its record if there is one.
    pub(super) fn open(&self, note: &dyn Fn(FrameNote)) -> Result<Taken, JobError> {
        let Found { frame, values, record, rendering, finish, levels, input } = self.find(note)?;
        let (depth, is_light) = (frame.depth(), levels.is_none());
        let is_stated = record.is_some() || self.options.depth.is_some();
        if let Some((bits, black)) =
            levels.filter(|_| !is_stated).and_then(|levels| fewer_bits(&frame, levels))
        {
            note(FrameNote::FewerBits { path: self.path.clone(), bits, black });
        }
        let frame = match (&self.sensor, levels) {
            (Some(sensor), _) => {
                self.check_values(values)?;
                sensor.check_values(is_light).map_err(|e| JobError::in_file(&self.path, e))?;
                sensor.light(&frame).map_err(|e| JobError::in_file(&self.path, e))?
            }
            (None, Some(levels)) => {
                levels.light(&frame).map_err(|source| JobError::Levels { path: self.path.clone(), source })?
            }
            (None, None) => frame,
        };
        let camera = record.as_ref().map(|record| &record.camera).or(self.stated.camera.as_ref()).cloned();
        let path = self.path.clone();
        Ok(Taken { path, frame, depth, values, camera, rendering, record, finish, is_light, input })
    }

    /// Returns the sensor's values or a DNG's light, whether it is light, and the frame as an input of results.
    pub(in crate::job) fn sensor_values(
        &self,
        note: &dyn Fn(FrameNote),
    ) -> Result<(RawFrame, bool, Input), JobError> {
        let Found { frame, values, levels, input, .. } = self.find(note)?;
        self.check_values(values)?;
        Ok((frame, levels.is_none(), input))
    }

    /// Rejects words that are not the sensor's.
    fn check_values(&self, values: Tone) -> Result<(), JobError> {
        if values.is_light() { Ok(()) } else { Err(JobError::in_file(&self.path, Encoded(values))) }
    }

    /// Returns the frame as its file holds it, with what its record and its file state.
    fn find(&self, note: &dyn Fn(FrameNote)) -> Result<Found, JobError> {
        let path = &self.path;
        let found = match record::load(path)? {
            Sidecar::Record(record) => Some(*record),
            Sidecar::Foreign(path) => {
                note(FrameNote::ForeignRecord { path });
                None
            }
            Sidecar::Absent => None,
        };
        let is_overruled = found.as_ref().map_or(Ok(false), |record| self.overrules(record, note))?;
        let record = found.map(|record| record.with(self.stated.clone()));
        let options = record.as_ref().map_or(self.options, |record| record.options(self.options));
        let overrides = self.overrides(record.as_ref());
        let opened = raw::open(path, &options, &overrides)?;
        self.check_effect(opened.format)?;
        for text in opened.notes {
            note(FrameNote::RawFile { path: path.clone(), text });
        }
        let frame = opened.frame;
        if let Some(record) = record.as_ref().filter(|_| !is_overruled) {
            record.check(path, &frame)?;
        }
        // Levels are those of the file already, or the stated ones.
        let levels = Levels { black: overrides.black.unwrap_or_default(), white: overrides.white };
        Ok(Found {
            input: Input::raw_frame(&path.file_name().unwrap_or_default().to_string_lossy(), &frame),
            frame,
            values: record.as_ref().map_or(Tone::Linear, |record| record.values),
            rendering: Rendering {
                white_balance: overrides.white_balance.or(opened.rendering.white_balance),
                matrix: overrides.matrix.or(opened.rendering.matrix),
            },
            record,
            finish: opened.finish,
            levels: (!opened.format.states_everything()).then_some(levels),
        })
    }

    /// Returns what takes the place of a camera's file: the record beside it, else what is stated.
    fn overrides(&self, record: Option<&RawRecord>) -> Overrides {
        let own = record.map(RawRecord::rendering).unwrap_or_default();
        Overrides {
            phase: record.map(|record| record.phase).or(self.stated.phase),
            black: record.map(|record| record.black_level).or(self.stated.black_level),
            white: record.map_or(self.stated.white_level, |record| record.white_level),
            white_balance: self.rendering.white_balance.or(own.white_balance),
            matrix: self.rendering.matrix.or(own.matrix),
        }
    }

    /// Rejects what only files without a description of their values need, beside a camera's file; and an order of bytes without effect.
    fn check_effect(&self, format: &'static RawFormat) -> Result<(), JobError> {
        let given = [
            (Field::Size, self.options.size.is_some()),
            (Field::BitDepth, self.options.depth.is_some()),
            (Field::Alignment, self.options.alignment.is_some()),
            (Field::Packing, self.options.packing != Default::default()),
        ];
        // Only words have an order of bytes, and only without a header it is not known.
        let has_order = format.is_headerless() && self.options.packing == Default::default();
        let order = (Field::Order, self.options.order != Default::default() && !has_order);
        let given = given.map(|(field, is_given)| (field, is_given && format.states_everything()));
        match given.into_iter().chain([order]).find(|(_, is_given)| *is_given) {
            Some((field, _)) => {
                let is_packed = field == Field::Order && format.is_headerless();
                let format = if is_packed { "pixels that are no words" } else { format.noun };
                Err(JobError::StatedByFile { path: self.path.clone(), field, format })
            }
            None => Ok(()),
        }
    }

    /// Returns whether what is stated takes the place of what the record states.
    fn overrules(&self, record: &RawRecord, note: &dyn Fn(FrameNote)) -> Result<bool, JobError> {
        let found = record.contradictions(&self.path, &self.stated);
        let any = !found.is_empty();
        for contradiction in found {
            if !self.overrules_record {
                return Err(JobError::Contradicted(contradiction));
            }
            note(FrameNote::Overruled(contradiction));
        }
        Ok(any)
    }
}

/// Part of full scale below which a black level of 16 bits is lower than sensors have.
const LOW_BLACK: f64 = 0.01;

/// Returns the bits of a frame whose values of 16 bits end with zeros, and black, if it seems to be stated in those fewer bits.
fn fewer_bits(frame: &RawFrame, levels: Levels) -> Option<(u32, f64)> {
    let black = levels.black.values().into_iter().fold(0.0, f64::max);
    let zeros = frame.pixels().iter().fold(0, |all, value| all | value).trailing_zeros();
    let is_low = black > 0.0 && black < LOW_BLACK * f64::from(u16::MAX);
    (frame.depth() == 16 && is_low && (2..=8).contains(&zeros)).then_some((16 - zeros, black))
}

/// A frame whose words are not the sensor's.
#[derive(Debug, thiserror::Error)]
#[error("its words encode light ({0}), a sensor file needs the sensor's values")]
struct Encoded(Tone);

impl Taken {
    /// Returns what is to be done with the picture and is not done by the board.
    pub(super) fn left_out(&self) -> Vec<&'static str> {
        let Finish { corrections, crop, orientation } = &self.finish;
        let all = [
            ("lens corrections", corrections.is_some()),
            ("crop", crop.is_some()),
            ("white balance", self.rendering.white_balance.is_some()),
            ("colour matrix", self.rendering.matrix.is_some()),
            ("orientation", *orientation != Finish::default().orientation),
        ];
        all.into_iter().filter(|(_, is_asked)| *is_asked).map(|(name, _)| name).collect()
    }

    /// Remarks on a frame without a record that was perhaps read otherwise than it was taken.
    pub(super) fn remark(&self, note: &dyn Fn(FrameNote)) {
        if self.record.is_some() {
            return;
        }
        for warning in read_warnings(&self.frame) {
            let path = self.path.clone();
            note(match warning {
                ReadWarning::Dim(brightest) => FrameNote::Dim { path, brightest, is_light: self.is_light },
                ReadWarning::Phase => FrameNote::OtherPhase { path, phase: self.frame.phase() },
            });
        }
    }
}
