//! Networks as data: architecture, float weights, integer weights with their shifts and thresholds, and the file that contains either.
//!
//! | what | module |
//! |---|---|
//! | architecture and float weights | [`network`] |
//! | integer weights, shifts, thresholds (docs/contract.md) | [`fixed_network`] |
//! | weight files (safetensors) | [`weight_file`] |

pub mod fixed_network;
pub mod network;
pub mod weight_file;

pub use fixed_network::FixedNetwork;
pub use network::Network;
