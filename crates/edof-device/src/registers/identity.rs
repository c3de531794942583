//! Identity of a board: hashes of its design, and of the network that it computes with.

use crate::Design;
use crate::design::memory::{Set, writes};
use edof_network::FixedNetwork;
use sha2::{Digest, Sha256};

/// First 32 bits of the SHA-256 of a design's JSON: register `design_hash`.
#[must_use]
pub fn design_hash(design: &Design) -> u32 {
    first_bits(serde_json::to_string(design).unwrap_or_default().as_bytes())
}

/// First 32 bits of the SHA-256 of all that a host writes to have a network in set 0, address and word by turns, each with its lowest byte
/// first: register `weights_hash`. Two files that make the same words have the same hash.
#[must_use]
pub fn weights_hash(design: &Design, network: &FixedNetwork) -> u32 {
    let words = writes(design, network, Set::First).into_iter().flat_map(|(address, word)| [address, word]);
    first_bits(&words.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())
}

fn first_bits(bytes: &[u8]) -> u32 {
    Sha256::digest(bytes).iter().take(4).fold(0, |bits, byte| bits << 8 | u32::from(*byte))
}
