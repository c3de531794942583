//! Jobs: what the commands of the program do, from files to files, as typed values that any program may run.
//!
//! | job | module |
//! |---|---|
//! | from a scene to a raw frame | [`CaptureJob`] |
//! | photographs, depth maps and listed scenes that jobs read | [`photograph`], [`DepthMap`], [`ListedScene`] |
//! | whether a job fits the machine | [`memory`] |
//!
//! A job is checked when it is made and when its inputs are read. It reports remarks ([`Note`]) and progress to its caller, and knows no options
//! of a command line: the program words those.

mod capture;
mod depth_map;
mod error;
mod listed;
pub mod memory;
pub mod photograph;

pub use capture::{CaptureJob, CaptureOutputs, Captured, SceneSource, Synthetic, check_memory};
pub use depth_map::{DepthMap, Meaning, Scale};
pub use error::JobError;
pub use listed::ListedScene;
pub use photograph::Note;
