//! Hashes of everything that a row was measured from: what makes it the row of this input and of these settings, and of no others.

use edof_core::storage::digest::sha256;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;

/// SHA-256 of a row's inputs and settings.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Proof {
    /// Of every setting that shaped it ([`settings`]); none in rows of layout 1.
    #[serde(default, rename = "settings_sha256", skip_serializing_if = "Option::is_none")]
    pub settings: Option<String>,
    /// Of weights or dictionary, where there are any.
    #[serde(default, rename = "weights_sha256", skip_serializing_if = "Option::is_none")]
    pub weights: Option<String>,
    /// Of the photograph's values, or of a scene's light and depths.
    #[serde(default, rename = "photo_sha256", alias = "scene_sha256")]
    pub photo: String,
    /// Of the camera, where there is one.
    #[serde(default, rename = "camera_sha256", skip_serializing_if = "Option::is_none")]
    pub camera: Option<String>,
}

/// SHA-256 of settings, each in the form that its own fields give (`Debug`): a field more, or another number in one, is another hash.
#[must_use]
pub fn settings(parts: &[&dyn Debug]) -> String {
    let text: Vec<String> = parts.iter().map(|part| format!("{part:?}")).collect();
    sha256(text.join("\n").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_bit_of_a_setting_makes_another_hash() {
        let nearly = 0.004f32.next_up();
        assert_eq!(settings(&[&0.004f32, &16]), settings(&[&0.004f32, &16]));
        assert_ne!(settings(&[&nearly, &16]), settings(&[&0.004f32, &16]));
        assert_ne!(settings(&[&16, &0.004f32]), settings(&[&0.004f32, &16]));
    }
}
