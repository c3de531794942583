//! A whole core in simulation: a camera at the receiver's pins, a screen at the transmitter's, a memory behind AXI, four clocks that have
//! nothing to do with each other; and what the screen shows against the golden picture.
//!
//! | step | module | gives |
//! |---|---|---|
//! | expect | [`pictures`] | frames to send, and the picture that the screen must show for each |
//! | stand around | [`pins`] | the camera and the screen |
//! | run | [`rig`] | a core that runs between them, its [`Memory`](crate::bench::Memory) and its [`Host`](crate::bench::Host) |
//! | set up | [`chips`] | the engines and models of the video chips, and who counts sync codes |
//! | talk to it | [`uart`], [`board`] | a serial line at its pins, and all of it as a board that any host of `edof-board` knows |
//! | between cables | [`mod@cables`] | the KC705's core with models of the chips around it, from a source's cable to a screen |
//! | first light | [`first_light`], [`sdram`], [`camera`] | the ULX3S from pin to pin, as a board behind a serial line; its memory, its camera |
//! | from pin to pin | [`camera_to_screen`] | frames of its camera as pictures on its screen, while the camera's clock stands still now and then |
//! | measure | [`measured`], [`fifos`] | frames per second, memory traffic, latency; largest fill of each FIFO |
//! | run again | [`mod@recorded`], [`second`] | the same in a bench of Verilog alone, for Icarus and for who has no Rust |

pub mod board;
pub mod cables;
pub mod camera;
pub mod camera_to_screen;
pub mod chips;
pub mod fifos;
pub mod first_light;
pub mod measured;
pub mod pictures;
pub mod pins;
pub mod recorded;
pub mod rig;
pub mod sdram;
pub mod second;
pub mod uart;

pub use board::{Speed, VerilogBoard};
pub use camera::CameraModule;
pub use first_light::FirstLight;
pub use measured::Measured;
pub use pictures::{PictureError, TableWords, Torn, compare, drawn, longest_run, picture, sent};
pub use pins::{Camera, Screen};
pub use recorded::recorded;
pub use rig::{Compiled, Rig, RigConfig, leisurely, project};
pub use sdram::SdramChip;
