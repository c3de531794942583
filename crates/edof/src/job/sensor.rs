//! From dark frames, flat frames and a list of defects to a correction of a sensor.

use super::stream::Layout;
use super::{FrameNote, FrameSource, JobError};
use edof_core::RawFrame;
use edof_core::storage::provenance::Input;
use edof_io::levels::Levels;
use edof_io::raw::{self, Alignment, RawError, RawFormat, RawOptions, Read as Reading, Size};
use edof_io::record::Stated;
use edof_io::rendering::Rendering;
use edof_io::sensor::measure::{Frames, Limits, Report, Sensor};
use edof_io::sensor::{Correction, Defects, list};
use std::fs::File;
use std::path::{Path, PathBuf};

/// Frames of one sensor, and what makes a pixel defective.
#[derive(Debug, Clone)]
pub struct SensorJob {
    /// Files of frames without light.
    pub dark: Vec<PathBuf>,
    /// Files of frames of even light.
    pub flat: Vec<PathBuf>,
    /// A list of known defects.
    pub list: Option<PathBuf>,
    /// Statements on all frames; the records beside them must agree.
    pub stated: Stated,
    /// How files are read where no record states it.
    pub options: RawOptions,
    /// Levels and limits.
    pub limits: Limits,
}

/// Frames of both kinds, as they were read.
#[derive(Debug)]
pub struct DarkFlat {
    dark: Option<Frames>,
    flat: Option<Frames>,
    /// Whether they hold light, as DNGs do.
    is_light: Option<bool>,
    /// Frames that were read, as inputs of results.
    pub inputs: Vec<Input>,
}

/// Frames of light among frames of sensor values.
#[derive(Debug, thiserror::Error)]
#[error("DNGs hold light, other frames hold sensor values; name frames of one kind")]
struct OtherKind;

impl SensorJob {
    /// Reads all frames. A headerless file may hold several, one after the other. Calls `tick` before each file.
    ///
    /// # Errors
    /// A frame that cannot be read, or one of another size, phase, depth or kind than those before it.
    pub fn read<E: From<JobError>>(
        &self,
        note: &dyn Fn(FrameNote),
        tick: &dyn Fn() -> Result<(), E>,
    ) -> Result<DarkFlat, E> {
        let (mut inputs, mut kind) = (vec![], None);
        let mut all = |paths: &[PathBuf]| -> Result<Option<Frames>, E> {
            let mut frames = None;
            for path in paths {
                tick()?;
                let is_light = self.add(path, &mut frames, &mut inputs, note)?;
                if *kind.get_or_insert(is_light) != is_light {
                    return Err(JobError::in_file(path, OtherKind).into());
                }
            }
            Ok(frames)
        };
        let (dark, flat) = (all(&self.dark)?, all(&self.flat)?);
        Ok(DarkFlat { dark, flat, is_light: kind, inputs })
    }

    /// Makes a correction, and reports what was found.
    ///
    /// # Errors
    /// Frames that show nothing or are of several sensors, a list that cannot be used, or nothing that states the frame's size.
    pub fn measured(&self, frames: &DarkFlat) -> Result<(Correction, Report), JobError> {
        let known = self.list.as_deref().map(list::load).transpose()?.unwrap_or_else(Defects::default);
        let RawOptions { size, phase, depth, packing, .. } = self.options;
        let stated = |size| (size, phase, depth.unwrap_or(packing.bits()));
        let own = frames.dark.as_ref().or(frames.flat.as_ref()).map(Frames::sensor);
        let (size, phase, depth) = own.or(size.map(stated)).ok_or(JobError::NoSize)?;
        let (dark, flat) = (frames.dark.as_ref(), frames.flat.as_ref());
        let (correction, report) = Sensor { size, phase, depth, dark, flat, known }.measured(&self.limits)?;
        Ok((correction.of_light(frames.is_light), report))
    }

    /// Adds the frames of a file; returns whether they hold light.
    fn add(
        &self,
        path: &Path,
        frames: &mut Option<Frames>,
        inputs: &mut Vec<Input>,
        note: &dyn Fn(FrameNote),
    ) -> Result<bool, JobError> {
        let mut add = |frame: &RawFrame, input: Input| {
            inputs.push(input);
            match frames {
                None => *frames = Some(Frames::new(frame)),
                Some(frames) => frames.add(frame).map_err(|e| JobError::in_file(path, e))?,
            }
            Ok(())
        };
        match self.several(path) {
            None => {
                let (frame, is_light, input) = self.source(path).sensor_values(note)?;
                add(&frame, input).map(|()| is_light)
            }
            Some((layout, count)) => self.each_of(path, layout, count, &mut add).map(|()| false),
        }
    }

    /// Returns how the frames of a headerless file lie and how many they are, if it holds more than one.
    fn several(&self, path: &Path) -> Option<(Layout, u64)> {
        let RawOptions { phase, depth, size, order, packing, alignment, line_bytes } = self.options;
        let layout =
            Layout { size: size?, packing, order, depth, phase, levels: Levels::default(), line_bytes };
        let is_headerless = |format: &RawFormat| matches!(format.read, Reading::Headerless(_));
        let length = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?.len();
        let (count, rest) = (length / layout.bytes() as u64, length % layout.bytes() as u64);
        let is_one = count < 2
            || rest != 0
            || alignment == Some(Alignment::Top)
            || !raw::of_ending(path).is_none_or(is_headerless);
        (!is_one).then_some((layout, count))
    }

    /// Calls `add` with each frame of a headerless file.
    fn each_of(
        &self,
        path: &Path,
        layout: Layout,
        count: u64,
        add: &mut dyn FnMut(&RawFrame, Input) -> Result<(), JobError>,
    ) -> Result<(), JobError> {
        let failed = |e: &dyn std::error::Error| JobError::in_file(path, e.to_string());
        let mut file = File::open(path).map_err(|e| failed(&e))?;
        let mut bytes = vec![];
        let Size { width, height } = layout.size;
        for number in 1..=count {
            layout.read(number, &mut file, &mut bytes).map_err(|e| failed(&e))?;
            let mut memory = vec![];
            let bytes = layout.packing.without_padding(width, layout.line_bytes, &bytes, &mut memory);
            let values = layout.packing.values(bytes, layout.order).map_err(|stray| RawError::Code {
                path: path.to_owned(),
                row: stray.pixel / width,
                column: stray.pixel % width,
                code: stray.code,
            })?;
            let values = ndarray::Array2::from_shape_vec((height, width), values).map_err(|e| failed(&e))?;
            let frame =
                RawFrame::from_values(values, layout.depth(), layout.phase).map_err(|e| failed(&e))?;
            let name = format!("{} {number}", path.file_name().unwrap_or_default().to_string_lossy());
            add(&frame, Input::raw_frame(&name, &frame))?;
        }
        Ok(())
    }

    fn source(&self, path: &Path) -> FrameSource {
        FrameSource {
            path: path.to_owned(),
            stated: self.stated.clone(),
            options: self.options,
            rendering: Rendering::default(),
            overrules_record: false,
            sensor: None,
        }
    }
}
