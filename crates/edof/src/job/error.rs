//! Reasons for which a job cannot be done.

use super::device::Device;
use super::memory::MemoryError;
use super::note::OtherLens;
use crate::presets::PresetError;
use edof_core::Stride;
use edof_core::storage::atomic::WriteError;
use edof_gpu::GpuError;
use edof_io::levels::LevelsError;
use edof_io::photo::PhotoError;
use edof_io::raw::{RawError, Size};
use edof_io::record::{Contradiction, Exposure, Field, RecordError};
use edof_io::sensor::file::SensorFileError;
use edof_io::sensor::list::ListError;
use edof_io::sensor::measure::MeasureError;
use edof_network::fixed_network::FixedNetworkError;
use edof_network::network::NetworkError;
use edof_optics::capture::CaptureError;
use edof_optics::draw::DrawError;
use ndarray_npy::WriteNpzError;
use std::path::{Path, PathBuf};

/// Inputs that cannot be used, or outputs that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum JobError {
    /// A photograph.
    #[error(transparent)]
    Photo(#[from] PhotoError),
    /// A raw frame.
    #[error(transparent)]
    Raw(#[from] RawError),
    /// The record beside a raw frame.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// Levels of a raw frame.
    #[error("{path}: {source}", path = path.display())]
    Levels { path: PathBuf, source: LevelsError },
    /// A camera or a depth before it.
    #[error(transparent)]
    Preset(#[from] PresetError),
    /// The file of a sensor's correction.
    #[error(transparent)]
    SensorFile(#[from] SensorFileError),
    /// A list of a sensor's defects.
    #[error(transparent)]
    DefectList(#[from] ListError),
    /// Frames that no correction can be made of.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// Neither frames nor an option state the size of a sensor's frames.
    #[error("no frames and no size; name dark or flat frames, or state the size of the sensor's frames")]
    NoSize,
    /// A synthetic scene.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A scene that the camera cannot take.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Arrays that cannot be written.
    #[error(transparent)]
    Npz(#[from] WriteNpzError),
    /// A float network whose matrices do not fit its form.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// A network in integers that cannot be computed.
    #[error(transparent)]
    FixedNetwork(#[from] FixedNetworkError),
    /// No such device.
    #[error("device {device}: {source}")]
    Device { device: Device, source: GpuError },
    /// A device that fails.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// What is stated of a frame contradicts its record.
    #[error(transparent)]
    Contradicted(Contradiction),
    /// Something is stated of a file that states it by itself.
    #[error("{path}: {field} has no effect on {format}, which states it", path = path.display())]
    StatedByFile { path: PathBuf, field: Field, format: &'static str },
    /// The network was trained for another lens than took the frame.
    #[error("network {}", .0.in_words("camera"))]
    OtherLens(Box<OtherLens>),
    /// The network was quantized for another stride.
    #[error("stride {}: the network {network} is quantized for a stride of {}", asked.pixels(), quantized.pixels())]
    OtherStride { network: String, asked: Stride, quantized: Stride },
    /// A frame is another exposure than its place says.
    #[error(
        "{path}: its record states {recorded}, it is given as {given}; give all exposures of a scene in their order, to a network of as many",
        path = path.display()
    )]
    OtherExposure { path: PathBuf, recorded: Exposure, given: Exposure },
    /// Exposures of one scene that differ in more than focus and noise.
    #[error(
        "{path}: {field} {found}, expected {expected} as {first}; exposures of one scene differ in nothing but focus and noise",
        path = path.display(), first = first.display()
    )]
    UnlikeExposures { path: PathBuf, field: &'static str, found: String, expected: String, first: PathBuf },
    /// A file that is not what it should be.
    #[error("{path}: {source}", path = path.display())]
    File { path: PathBuf, source: Box<dyn std::error::Error + Send + Sync> },
    /// A picture whose size differs from that of another one.
    #[error("{path}: {found}, expected {expected} as {other}", path = path.display(), other = other.display())]
    OtherSize { path: PathBuf, found: Size, expected: Size, other: PathBuf },
    /// A layer of a scene file.
    #[error("{path}: layer {index}: {source}", path = path.display())]
    Layer { path: PathBuf, index: usize, source: Box<dyn std::error::Error + Send + Sync> },
    /// A scene that is too large for the machine.
    #[error("scene {size}: {source}")]
    Memory { size: Size, source: MemoryError },
    /// A photograph with too many layers for the machine.
    #[error("{size} in {layers} layers: {source}")]
    Layers { size: Size, layers: usize, source: MemoryError },
}

impl JobError {
    /// Names the file of an error.
    pub(super) fn in_file(path: &Path, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::File { path: path.to_owned(), source: source.into() }
    }
}
