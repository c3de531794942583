//! Parts of a camera as messages have them.

use super::{Delay, Spectrum};
use crate::words::{number, numbers};

impl Spectrum {
    /// As a camera file has it.
    pub(super) fn in_words(&self) -> String {
        match self {
            Self::Line(nm) => number(*nm),
            Self::Sampled(pairs) if pairs.is_empty() => "an empty list".to_owned(),
            Self::Sampled(pairs) => {
                let shown: Vec<String> =
                    pairs.iter().take(4).map(|pair| format!("[{}]", numbers(pair))).collect();
                format!("[{}{}]", shown.join(", "), if pairs.len() > 4 { ", …" } else { "" })
            }
        }
    }
}

impl Delay {
    /// As a message has it.
    pub(super) fn in_words(self) -> String {
        match self {
            Self::Phase { rad, at_nm } => format!("a phase of {} rad at {} nm", number(rad), number(at_nm)),
            Self::Etched { height_um, cauchy } => {
                format!("etched {} um deep in glass of {}", number(height_um), numbers(&cauchy))
            }
        }
    }
}
