//! Jobs: what the commands of the program do, from files to files, as typed values that any program may run.
//!
//! | job | module |
//! |---|---|
//! | from a scene to a raw frame, or to several exposures | [`CaptureJob`] |
//! | from a raw frame, or the exposures of a scene, to a picture | [`ReconstructJob`] |
//! | from a stream of raw frames to one of pictures | [`StreamJob`] |
//! | from dark and flat frames to a correction of a sensor | [`SensorJob`] |
//! | photographs, depth maps and listed scenes that jobs read | [`photograph`], [`DepthMap`], [`ListedScene`] |
//! | whether a job fits the machine | [`memory`] |
//!
//! A job is checked when it is made and when its inputs are read. It reports remarks ([`PictureNote`], [`FrameNote`]) and progress to its caller, and knows no options
//! of a command line: the program words those.

mod capture;
mod depth_map;
mod device;
mod error;
mod exposures;
mod greys;
mod listed;
pub mod memory;
mod note;
mod npz;
pub mod photograph;
mod reconstruct;
mod sensor;
mod stream;

pub use capture::{CaptureJob, CaptureOutputs, Captured, SceneSource, Synthetic, VideoOutput, check_memory};
pub use depth_map::{DepthMap, Meaning, Scale};
pub use device::Device;
pub use error::JobError;
pub use exposures::ExposuresError;
pub use greys::GreyFile;
pub use listed::ListedScene;
pub use note::{FrameNote, OtherLens, PictureNote};
pub use npz::Npz;
pub use reconstruct::{Engine, FixedOptions, FrameSource, ReconstructJob, Reconstructed, words_file};
pub use sensor::{DarkFlat, SensorJob};
pub use stream::{Balance, FirstFrame, Layout, Pace, StreamError, StreamJob, Streamed, VideoFormat};
