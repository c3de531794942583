//! Networks as data: architecture, float weights, integer weights with their shifts and thresholds, and the file that contains either.
//!
//! | what | module |
//! |---|---|
//! | architecture and float weights | [`network`] |
//! | how well the noise of its training suits a frame's | [`fit`] |
//! | an architecture in words, as `--form` takes it | [`form`] |
//! | the non-linearity, in numbers and in words | [`shrinkage`] |
//! | integer weights, shifts, thresholds (docs/contract.md) | [`fixed_network`] |
//! | weight files (safetensors) | [`weight_file`] |
//! | forward pass and gradient in floating point | [`float`] |
//!
//! # Stability
//!
//! Stable: weight files of this and earlier versions are read, and their words mean the same (docs/contract.md). Signatures may change between minor versions until 1.0.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod fit;
pub mod fixed_network;
pub mod float;
pub mod form;
pub mod network;
pub mod shrinkage;
pub mod weight_file;

pub use fit::Fit;
pub use fixed_network::FixedNetwork;
pub use network::Network;
