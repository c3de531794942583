//! A whole core in simulation: a camera at the receiver's pins, a screen at the transmitter's, a memory behind AXI, three clocks that have
//! nothing to do with each other; and what the screen shows against the golden picture.
//!
//! | step | module | gives |
//! |---|---|---|
//! | expect | [`pictures`] | frames to send, and the picture that the screen must show for each |
//! | stand around | [`pins`] | the camera and the screen |
//! | run | [`rig`] | a core that runs between them, its [`Memory`](crate::bench::Memory) and its [`Host`](crate::bench::Host) |
//! | measure | [`measured`] | frames a second, what passed through the memory, latency |

pub mod measured;
pub mod pictures;
pub mod pins;
pub mod rig;

pub use measured::Measured;
pub use pictures::{TableWords, Torn, compare, drawn, longest_run, picture, sent};
pub use pins::{Camera, Screen};
pub use rig::{Begin, Compiled, Rig, leisurely, project};
