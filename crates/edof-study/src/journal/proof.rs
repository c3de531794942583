//! Hashes of everything that a row was measured from: what makes it the row of this input and of these settings, and of no others.

use crate::key::{KeyText, VERSION};
use edof_core::storage::digest::sha256;
use serde::{Deserialize, Serialize};

/// SHA-256 of a row's inputs and settings.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Proof {
    /// Version of the text that settings are hashed from ([`VERSION`]); the first one in rows that do not state it.
    #[serde(default = "first", rename = "key_version")]
    pub version: u32,
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

const fn first() -> u32 {
    1
}

/// Holds no hash, in the present version.
impl Default for Proof {
    fn default() -> Self {
        Self { version: VERSION, settings: None, weights: None, photo: String::new(), camera: None }
    }
}

/// Returns the SHA-256 of settings: another number in one of them is another hash.
#[must_use]
pub fn settings(parts: &[&dyn KeyText]) -> String {
    let text: Vec<String> = parts.iter().map(|part| part.key_text()).collect();
    sha256(text.join("\n").as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_bit_of_a_setting_makes_another_hash() {
        let nearly = 0.004f32.next_up();
        assert_eq!(settings(&[&0.004f32, &16u32]), settings(&[&0.004f32, &16u32]));
        assert_ne!(settings(&[&nearly, &16u32]), settings(&[&0.004f32, &16u32]));
        assert_ne!(settings(&[&16u32, &0.004f32]), settings(&[&0.004f32, &16u32]));
    }
}
