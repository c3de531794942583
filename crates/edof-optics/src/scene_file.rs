//! Scenes that a file lists: pictures with mattes, each at a depth.
//!
//! ```json
//! {"layers": [{"picture": "wall.png", "depth": 0}, {"picture": "vase.png", "matte": "vase-matte.png", "depth": "1.5m"}]}
//! ```

use crate::layers::MAX_LAYERS;
use edof_core::storage::json;
use edof_core::words::count;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Most bytes of a scene file.
const MAX_BYTES: u64 = 1 << 20;

/// Why a file lists no scene.
#[derive(Debug, Error)]
pub enum SceneFileError {
    /// The file is not there, too large or no text.
    #[error("cannot read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// The text is not the JSON of a scene.
    #[error("no scene of layers: {0}")]
    NoScene(String),
    /// None, or more than a scene may have.
    #[error("{}, expected 1 to {MAX_LAYERS}", count(*.0, "layer"))]
    Layers(usize),
    /// The background would not cover everything.
    #[error("its first layer has a matte, expected a background that covers everything")]
    MatteInFront,
    /// A layer that hides all behind it.
    #[error("layer {0} has no matte, so it hides all behind it; only layer 0 has none")]
    NoMatte(usize),
}

/// A scene file that has been read, its pictures not yet.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// From back to front; each but the first has a matte.
    pub layers: Vec<LayerFile>,
}

/// What the file says of a layer.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayerFile {
    /// Relative to the scene file.
    pub picture: PathBuf,
    /// Grey: white where the layer covers, black where it is not; none covers all.
    #[serde(default)]
    pub matte: Option<PathBuf>,
    /// Where the layer is.
    pub depth: WrittenDepth,
}

/// A depth as a file says it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a depth is a psi as a number, or a text such as \"1.5m\"")]
pub enum WrittenDepth {
    /// ψ in radians.
    Psi(f64),
    /// As `edof capture --psi` takes it.
    Text(String),
}

impl SceneFile {
    /// # Errors
    /// A file that cannot be read or lists no scene.
    pub fn load(path: &Path) -> Result<Self, SceneFileError> {
        Self::parse(&json::text(path, MAX_BYTES)?)
    }

    /// ```
    /// use edof_optics::SceneFile;
    /// let scene = SceneFile::parse(r#"{"layers": [{"picture": "wall.png", "depth": "3m"}]}"#)?;
    /// assert_eq!(scene.layers.len(), 1);
    /// # Ok::<(), edof_optics::SceneFileError>(())
    /// ```
    ///
    /// # Errors
    /// A text that lists no scene.
    pub fn parse(text: &str) -> Result<Self, SceneFileError> {
        let file: Self = json::parse(text).map_err(|e| SceneFileError::NoScene(e.to_string()))?;
        let layers = &file.layers;
        if !(1..=MAX_LAYERS).contains(&layers.len()) {
            return Err(SceneFileError::Layers(layers.len()));
        }
        if layers[0].matte.is_some() {
            return Err(SceneFileError::MatteInFront);
        }
        match layers.iter().skip(1).position(|layer| layer.matte.is_none()) {
            Some(at) => Err(SceneFileError::NoMatte(at + 1)),
            None => Ok(file),
        }
    }

    /// Every picture and matte that the file names, as it names them.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.layers.iter().flat_map(|layer| [Some(&layer.picture), layer.matte.as_ref()]).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_lists_no_scene_says_why() {
        let (wall, vase) =
            (r#"{"picture": "a", "depth": 0}"#, r#"{"picture": "b", "matte": "m", "depth": "1m"}"#);
        for (layers, reason) in [
            (String::new(), "0 layers, expected 1 to 64"),
            ([wall].repeat(65).join(","), "65 layers, expected 1 to 64"),
            (vase.into(), "its first layer has a matte, expected a background that covers everything"),
            (
                format!("{wall},{vase},{wall}"),
                "layer 2 has no matte, so it hides all behind it; only layer 0 has none",
            ),
            (
                r#"{"picture": "a", "depth": true}"#.into(),
                "no scene of layers: layers[0].depth: a depth is a psi as a number",
            ),
        ] {
            let said = SceneFile::parse(&format!(r#"{{"layers": [{layers}]}}"#)).unwrap_err().to_string();
            assert!(said.starts_with(reason), "{said}");
        }
        let scene = SceneFile::parse(&format!(r#"{{"layers": [{wall},{vase}]}}"#)).unwrap();
        assert_eq!(scene.files().map(|file| file.to_str().unwrap()).collect::<Vec<_>>(), ["a", "b", "m"]);
    }
}
