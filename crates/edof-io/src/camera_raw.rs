//! Camera raw files of makers' own formats (CR2, NEF, ARW, …) as raw frames, by the crate `rawler`; only with the feature `camera-raw`. DNG
//! needs no such feature ([`crate::dng`]).
//!
//! Black levels are taken off and white becomes full scale, so that the frame is linear light of 16 bits; borders that the
//! sensor keeps dark are cut off; the Bayer phase is the file's own. Why a feature: `docs/decisions/0004-camera-raw.md`.

use crate::levels::LevelsError;
use edof_core::RawFrame;
use std::path::{Path, PathBuf};

/// Endings of files that are taken for camera raw.
pub const ENDINGS: [&str; 11] = ["cr2", "cr3", "nef", "nrw", "arw", "raf", "rw2", "orf", "pef", "srw", "3fr"];

/// A camera raw file that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum CameraRawError {
    /// The program was built without the feature.
    #[error("{path}: camera raw needs a build with --features camera-raw; or convert it to DNG, or a 16-bit PNG, TIFF or PGM", path = path.display())]
    NotBuiltIn { path: PathBuf },
    /// Damaged, or of a camera that is not known.
    #[error("{path}: cannot read camera raw: {reason}", path = path.display())]
    Decode { path: PathBuf, reason: String },
    /// Levels that exclude each other.
    #[error("{path}: {source}", path = path.display())]
    Levels { path: PathBuf, source: LevelsError },
    /// Some other mosaic, or none.
    #[error("{path}: sensor has {found}, expected a 2x2 Bayer mosaic of red, green and blue", path = path.display())]
    Mosaic { path: PathBuf, found: String },
}

/// Whether a file begins like one of a maker's formats that are no TIFF, or a CR2: CR3, RAF, ORF, RW2.
#[must_use]
pub fn is_content(head: &[u8]) -> bool {
    match head {
        [b'I', b'I', 42, 0, _, _, _, _, b'C', b'R', ..] => true,
        [_, _, _, _, b'f', b't', b'y', b'p', b'c', b'r', b'x', ..] => true,
        [b'I', b'I', b'R', b'O' | b'S', ..] | [b'I', b'I', b'U', 0, ..] => true,
        head => head.starts_with(b"FUJIFILM"),
    }
}

/// Whether the ending of a name stands for camera raw.
#[must_use]
pub fn is_name(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    ENDINGS.contains(&ending.as_str())
}

/// Reads a camera raw file.
///
/// # Errors
/// [`CameraRawError::NotBuiltIn`] always, in a build without the feature.
#[cfg(not(feature = "camera-raw"))]
pub fn load(path: &Path) -> Result<RawFrame, CameraRawError> {
    Err(CameraRawError::NotBuiltIn { path: path.to_owned() })
}

#[cfg(feature = "camera-raw")]
pub use decoder::load;

#[cfg(feature = "camera-raw")]
mod decoder {
    use super::{CameraRawError, Path, RawFrame};
    use edof_core::{CfaPhase, Channel};
    use ndarray::Array2;
    use rawler::imgop::Rect;
    use rawler::rawimage::{RawImage, RawImageData, RawPhotometricInterpretation};

    /// Reads a camera raw file.
    ///
    /// # Errors
    /// Any [`CameraRawError`] but `NotBuiltIn`, naming the file.
    pub fn load(path: &Path) -> Result<RawFrame, CameraRawError> {
        let failed = |reason: String| CameraRawError::Decode { path: path.to_owned(), reason };
        // The decoder has `todo!` and indexing on paths that damaged files reach.
        let image = std::panic::catch_unwind(|| rawler::decode_file(path))
            .map_err(|_| failed("the decoder gave up on it".to_owned()))?
            .map_err(|e| failed(e.to_string()))?;
        let area = active_area(&image);
        let phase =
            phase(&image, &area).map_err(|found| CameraRawError::Mosaic { path: path.to_owned(), found })?;
        let values =
            linear_light(&image, &area).ok_or_else(|| failed("its size is not its pixels'".to_owned()))?;
        RawFrame::from_values(values, 16, phase).map_err(|e| failed(e.to_string()))
    }

    /// The part that light falls on, whole Bayer cells.
    fn active_area(image: &RawImage) -> Rect {
        let whole = Rect::new_with_points(
            rawler::imgop::Point::new(0, 0),
            rawler::imgop::Point::new(image.width, image.height),
        );
        let mut area = image.active_area.unwrap_or(whole);
        area.d.w &= !1;
        area.d.h &= !1;
        area
    }

    fn phase(image: &RawImage, area: &Rect) -> Result<CfaPhase, String> {
        let RawPhotometricInterpretation::Cfa(config) = &image.photometric else {
            return Err("no colour filter array".to_owned());
        };
        let cfa = &config.cfa;
        if image.cpp != 1 || (cfa.width, cfa.height) != (2, 2) || !cfa.is_rgb() {
            return Err(format!("a {}x{} mosaic {}", cfa.width, cfa.height, cfa.name));
        }
        let measures = |channel: Channel, row: usize, column: usize| {
            cfa.color_at(area.p.y + row, area.p.x + column) == channel.plane()
        };
        let fits = |phase: &CfaPhase| {
            [(0, 0), (0, 1), (1, 0), (1, 1)].iter().all(|&(r, c)| measures(phase.channel(r, c), r, c))
        };
        CfaPhase::ALL.into_iter().find(fits).ok_or_else(|| format!("the mosaic {}", cfa.name))
    }

    /// (value − black) / (white − black) as 16-bit sensor values.
    fn linear_light(image: &RawImage, area: &Rect) -> Option<Array2<u16>> {
        let black = image.blacklevel.as_bayer_array();
        let white = image.whitelevel.as_bayer_array();
        let value = |at: usize| match &image.data {
            RawImageData::Integer(values) => values.get(at).map(|&v| f32::from(v)),
            RawImageData::Float(values) => values.get(at).copied(),
        };
        let mut values = Array2::zeros((area.d.h, area.d.w));
        for ((r, c), value) in values.indexed_iter_mut() {
            let (row, column) = (area.p.y + r, area.p.x + c);
            let cell = 2 * (row % 2) + column % 2;
            let light = (value(row * image.width + column)? - black[cell]) / (white[cell] - black[cell]);
            *value = (light.clamp(0.0, 1.0) * 65535.0).round() as u16;
        }
        Some(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_raw_is_reported_by_its_ending() {
        assert!(is_name(Path::new("a/IMG_1.CR3")) && is_name(Path::new("x.nef")));
        assert!(!is_name(Path::new("x.png")) && !is_name(Path::new("dng")));
    }

    #[test]
    fn camera_raw_is_known_by_its_first_bytes() {
        for head in
            [&b"II*\0\x10\0\0\0CR\x02\0"[..], b"FUJIFILMCCD-RAW ", b"IIRO\x08\0\0\0", b"\0\0\0\x18ftypcrx "]
        {
            assert!(is_content(head));
        }
        assert!(!is_content(b"II*\0\x08\0\0\0\x10\0\xfe\0") && !is_content(b"II"));
    }

    #[cfg(not(feature = "camera-raw"))]
    #[test]
    fn a_build_without_the_feature_says_what_would_help() {
        let error = load(Path::new("x.nef")).unwrap_err().to_string();
        assert!(error.starts_with("x.nef: camera raw needs a build with --features camera-raw"), "{error}");
    }

    #[cfg(feature = "camera-raw")]
    mod with_decoder {
        use super::*;
        use edof_core::CfaPhase;

        /// The smallest DNG: one uncompressed strip of 16-bit values, row by row.
        fn dng(width: u16, height: u16, cfa: [u8; 4], black: u16, white: u16, values: &[u16]) -> Vec<u8> {
            let short = |tag: u16, v: u16| (tag, 3u16, 1u32, u32::from(v).to_le_bytes());
            let long = |tag: u16, v: u32| (tag, 4u16, 1u32, v.to_le_bytes());
            let bytes = |tag: u16, v: [u8; 4]| (tag, 1u16, 4u32, v);
            let text = |tag: u16, v: &[u8; 4]| (tag, 2u16, 4u32, *v);
            let start = 8 + 2 + 12 * 17 + 4;
            let tags = [
                long(254, 0),
                short(256, width),
                short(257, height),
                short(258, 16),
                short(259, 1),
                short(262, 32803),
                text(271, b"our\0"),
                text(272, b"own\0"),
                long(273, start),
                short(277, 1),
                short(278, height),
                long(279, 2 * values.len() as u32),
                (33421, 3, 2, [2, 0, 2, 0]),
                bytes(33422, cfa),
                bytes(50706, [1, 4, 0, 0]),
                short(50714, black),
                short(50717, white),
            ];
            let mut file = vec![b'I', b'I', 42, 0, 8, 0, 0, 0];
            file.extend((tags.len() as u16).to_le_bytes());
            for (tag, kind, count, value) in tags {
                file.extend(tag.to_le_bytes());
                file.extend(kind.to_le_bytes());
                file.extend(count.to_le_bytes());
                file.extend(value);
            }
            file.extend(0u32.to_le_bytes());
            file.extend(values.iter().flat_map(|v| v.to_le_bytes()));
            file
        }

        fn loaded(content: &[u8]) -> Result<RawFrame, String> {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("x.dng");
            std::fs::write(&path, content).unwrap();
            load(&path).map_err(|e| e.to_string())
        }

        #[test]
        fn a_dng_becomes_linear_light_from_black_to_white() {
            let values: Vec<u16> = (0..16 * 8).map(|i| 100 + 10 * i).collect();
            let frame = loaded(&dng(16, 8, [1, 2, 0, 1], 100, 1370, &values)).unwrap();
            assert_eq!((frame.size(), frame.phase()), ((8, 16), CfaPhase::Gbrg));
            assert_eq!((frame.pixels()[(0, 0)], frame.pixels()[(7, 15)]), (0, 65535));
            let exact = 65535.0 * 10.0 / 1270.0;
            assert!((f64::from(frame.pixels()[(0, 1)]) - exact).abs() <= 0.5);
        }

        #[test]
        fn a_damaged_dng_is_rejected_by_name() {
            let whole = dng(16, 8, [0, 1, 1, 2], 0, 4095, &[7; 128]);
            for kept in [0, 20, 150] {
                let error = loaded(&whole[..kept]).unwrap_err();
                assert!(error.contains("x.dng: cannot read camera raw"), "{error}");
            }
        }
    }
}
