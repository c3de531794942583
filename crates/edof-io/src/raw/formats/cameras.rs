//! Files of cameras, which state everything: DNG, and makers' own formats.

use crate::camera_raw::{self, CameraRawError};
use crate::dng::{self, Dng, Finish};
use crate::levels::{Levels, LevelsError};
use crate::raw::format::{RawFormat, Read, Recognised};
use crate::rendering::Rendering;
use std::path::Path;

/// DNG ([`crate::dng`]).
pub const DNG: RawFormat = RawFormat {
    name: "DNG",
    noun: "a DNG",
    endings: &["dng"],
    recognise: |bytes| in_tiff(bytes, dng::is_dng(bytes)),
    read: Read::Light(|source, overrides| {
        let path = source.path;
        Ok(dng::decode(&source.all()?, path, overrides)?)
    }),
    write: None,
};

/// Makers' own formats ([`crate::camera_raw`]).
pub const CAMERA_RAW: RawFormat = RawFormat {
    name: "camera raw",
    noun: "a camera's raw file",
    endings: &camera_raw::ENDINGS,
    recognise: |bytes| in_tiff(bytes, camera_raw::is_content(bytes)),
    read: Read::Light(|source, overrides| {
        let levels = Levels { black: overrides.black.unwrap_or_default(), white: overrides.white };
        let wrong =
            |source: LevelsError, path: &Path| CameraRawError::Levels { path: path.to_owned(), source };
        let light = levels.light(&camera_raw::load(source.path)?);
        let frame = light.map_err(|e| wrong(e, source.path))?;
        Ok(Dng { frame, rendering: Rendering::default(), finish: Finish::default(), notes: vec![] })
    }),
    write: None,
};

fn in_tiff(bytes: &[u8], is_own: bool) -> Recognised {
    match is_own {
        true => Recognised::Yes,
        false if dng::is_tiff(bytes) => Recognised::Container,
        false => Recognised::No,
    }
}
