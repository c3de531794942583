//! One thin file a sub-command: open, check, compute, write, tell. No algorithm lives here.

pub mod board;
pub mod capture;
pub mod compare;
pub mod cosim;
pub mod demo;
pub mod design;
pub mod doctor;
pub mod estimate;
pub mod explore;
pub mod generate;
pub mod optics;
pub mod play;
pub mod quantize;
pub mod random_network;
pub mod reconstruct;
pub mod scene;
pub mod sensor;
pub mod stream;
pub mod study;
pub mod timing;
pub mod train;
pub mod weights;
