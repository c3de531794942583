//! How many loads a net of a mapped design leads to.

use serde::{Deserialize, Serialize};

/// One net.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FanOut {
    /// Name of the net in the source, or the mapping's where it has none.
    pub net: String,
    /// Pins that it leads to.
    pub loads: usize,
    /// Whether the net is control: a signal of one bit, or one most of whose loads it enables, resets or writes. All else are bits of words.
    pub control: bool,
}
