//! The sensor as it is: what its frames need before a network sees them (docs/sensor.md).
//!
//! | what | module |
//! |---|---|
//! | offsets, gains and defects of a sensor, and their use in integers | [`Correction`] |
//! | the one repair of defective pixels | [`defects`] |
//! | the file of a correction | [`file`](mod@file) |
//! | a list of defects that a person wrote | [`list`] |
//! | from dark and flat frames to a correction | [`measure`] |

mod correction;
pub mod defects;
pub mod file;
pub mod list;
pub mod measure;

pub use correction::{Correction, Defects, NODE_SPACING, OtherSensor, OtherValues, SensorError, Tables};
