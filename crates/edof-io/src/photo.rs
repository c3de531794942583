//! Photographs: files to linear light and back. Sample values are taken as linear light, as the study does.

use crate::gamut::Gamut;
use crate::picture::{self, PictureError};
use crate::samples::Samples;
use crate::transfer::{Curve, Statement, Transfer};
use edof_core::ColourFrame;
use edof_core::storage::atomic;
use ndarray::{Array2, Array3, Axis};
use std::path::{Path, PathBuf};

/// A photograph that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PhotoError {
    /// The file itself.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Colours where there should be none.
    #[error("{path}: holds a colour picture, expected a grey one", path = path.display())]
    Colour { path: PathBuf },
    /// Neither 8 nor 16 bits.
    #[error("{path}: {bits} bits a sample: must be 8 or 16", path = path.display())]
    Bits { path: PathBuf, bits: u32 },
}

/// A folder without a single photograph that can be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum FolderError {
    /// The folder cannot be listed.
    #[error("{folder}: cannot list: {source}", folder = folder.display())]
    List { folder: PathBuf, source: std::io::Error },
    /// No file with the ending of a photograph.
    #[error("{folder}: contains no photographs, expected .png, .jpg, .webp, .tif, .bmp, .ppm or .pgm files", folder = folder.display())]
    Empty { folder: PathBuf },
    /// Photographs, none of which can be read.
    #[error("{folder}: {}, none of which can be read; the first: {first}", edof_core::words::count(*count, "photograph"), folder = folder.display())]
    NoneReadable { folder: PathBuf, count: usize, first: PhotoError },
}

/// A photograph and the name of its file without the ending.
pub type Named = (String, ColourFrame);

/// Photographs of a folder in alphabetical order, those that were skipped, and remarks on those that were not.
#[derive(Debug)]
pub struct Folder {
    /// Photographs by name.
    pub photographs: Vec<Named>,
    /// What was wrong with each that had to be skipped.
    pub skipped: Vec<PhotoError>,
    /// Remarks of all photographs ([`Photograph::remarks`]).
    pub remarks: Vec<String>,
}

/// A photograph, and what its file states of its values.
#[derive(Debug, Clone)]
pub struct Photograph {
    /// Values of the file, 0…1.
    pub frame: ColourFrame,
    /// What its values are, where the file states it.
    pub transfer: Option<Transfer>,
    /// Its primaries, where the file states others than sRGB's.
    pub gamut: Option<Gamut>,
    /// Whether the file has further pictures.
    pub is_first_of_several: bool,
}

impl Photograph {
    /// Returns a line for each statement of a photograph of a folder that it is not sRGB, or not one picture.
    pub fn remarks(&self, path: &Path) -> impl Iterator<Item = String> {
        let path = path.display();
        let curve = self.transfer.as_ref().filter(|transfer| transfer.curve != Curve::Srgb).map(|stated| {
            format!(
                "{path}: states {stated}; the photographs of a folder are all read by one --tone, convert it if it is of another"
            )
        });
        let gamut = self.gamut.as_ref().map(|stated| {
            format!("{path}: states colours of {stated}; its values are taken as sRGB's, convert it if colours matter")
        });
        let first =
            self.is_first_of_several.then(|| format!("{path}: has several pictures; the first is read"));
        [curve, gamut, first].into_iter().flatten()
    }
}

/// Reads a PNG, JPEG, WebP, TIFF, BMP, PPM or PGM of at most 16 bits. Grey gives three equal planes, alpha is dropped, full scale becomes 1.
/// The photograph is turned as its camera was held.
///
/// # Errors
/// [`PhotoError::Picture`] naming the file.
pub fn open(path: &Path) -> Result<Photograph, PhotoError> {
    of_bytes(&picture::read(path)?, path)
}

/// Reads a photograph from the bytes of its file, as [`open`]; `path` names it in errors.
///
/// # Errors
/// As [`open`].
pub fn of_bytes(bytes: &[u8], path: &Path) -> Result<Photograph, PhotoError> {
    let planes = light(bytes, path)?;
    let (_, height, width) = planes.dim();
    let frame = if planes.dim().0 == 3 {
        ColourFrame { planes }
    } else {
        let mut frame = ColourFrame::zeros(height, width);
        frame.planes.assign(&planes);
        frame
    };
    let (transfer, gamut) = (Transfer::of(bytes), Gamut::of(bytes));
    Ok(Photograph { frame, transfer, gamut, is_first_of_several: picture::is_first_of_several(bytes) })
}

/// Reads a photograph without what its file states, as [`open`].
///
/// # Errors
/// As [`open`].
pub fn load(path: &Path) -> Result<ColourFrame, PhotoError> {
    Ok(open(path)?.frame)
}

/// The same as [`load`] of a file that was found in a folder.
///
/// # Errors
/// As [`load`]; also for what is no file.
pub fn load_found(path: &Path) -> Result<ColourFrame, PhotoError> {
    Ok(open_found(path)?.frame)
}

/// The same as [`open`] of a file that was found in a folder.
///
/// # Errors
/// As [`open`]; also for what is no file.
pub fn open_found(path: &Path) -> Result<Photograph, PhotoError> {
    picture::check_found(path)?;
    open(path)
}

/// One plane or three, full scale 1.
fn light(bytes: &[u8], path: &Path) -> Result<Array3<f32>, PictureError> {
    let light = |sample: u16, full_scale: u16| f32::from(sample) / f32::from(full_scale);
    Ok(picture::decode_photograph(bytes, path, light)?.0)
}

/// The first of planes that are equal, as those of a grey picture saved in colour.
fn grey<T: PartialEq>(planes: Array3<T>, path: &Path) -> Result<Array2<T>, PhotoError> {
    let first = planes.index_axis(Axis(0), 0);
    if planes.outer_iter().skip(1).any(|plane| plane != first) {
        return Err(PhotoError::Colour { path: path.to_owned() });
    }
    Ok(planes.index_axis_move(Axis(0), 0))
}

/// Reads a grey picture, 0…1, such as a depth map; equal red, green and blue are grey, too.
///
/// # Errors
/// [`PhotoError::Picture`] or [`PhotoError::Colour`].
pub fn load_grey(path: &Path) -> Result<Array2<f32>, PhotoError> {
    grey(light(&picture::read(path)?, path)?, path)
}

/// Reads the integers of a grey picture, such as distances in millimetres; turned as [`load_grey`] does.
///
/// # Errors
/// As [`load_grey`].
pub fn load_integers(path: &Path) -> Result<Array2<u16>, PhotoError> {
    grey(picture::decode_integers(&picture::read(path)?, path)?, path)
}

/// Writes linear light as sample values of 8 or 16 bits, in the format that the ending of `path` stands for. Values are
/// rounded and clipped to 0…1.
///
/// # Errors
/// [`PhotoError`]; no file is left half written.
pub fn save(path: &Path, frame: &ColourFrame, bits: u32) -> Result<(), PhotoError> {
    save_stated(path, frame, bits, None)
}

/// Writes sample values as [`save`] does. A PNG or TIFF states their curve; a PPM has no place for it.
///
/// # Errors
/// As [`save`].
pub fn save_stated(
    path: &Path,
    frame: &ColourFrame,
    bits: u32,
    curve: Option<Statement>,
) -> Result<(), PhotoError> {
    let full_scale = match bits {
        8 => u16::from(u8::MAX),
        16 => u16::MAX,
        _ => return Err(PhotoError::Bits { path: path.to_owned(), bits }),
    };
    let planes = frame.planes.mapv(|v| (v.clamp(0.0, 1.0) * f32::from(full_scale)).round() as u16);
    let bytes =
        picture::encode_stated(&Samples { planes, full_scale }, picture::format_of(path)?, curve, path)?;
    Ok(atomic::write(path, &bytes).map_err(PictureError::from)?)
}

/// Reads all photographs of a folder.
///
/// # Errors
/// [`FolderError`] when there is no folder, no photograph, or none that can be read.
pub fn load_folder(folder: &Path) -> Result<Folder, FolderError> {
    let cannot = |source| FolderError::List { folder: folder.to_owned(), source };
    let files = picture::of_folder(folder).map_err(cannot)?;
    let count = files.len();
    let mut found = Folder { photographs: vec![], skipped: vec![], remarks: vec![] };
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        match open_found(&file) {
            Ok(photograph) => {
                found.remarks.extend(photograph.remarks(&file));
                found.photographs.push((name, photograph.frame));
            }
            Err(error) => found.skipped.push(error),
        }
    }
    if found.photographs.is_empty() {
        let folder = folder.to_owned();
        return Err(match found.skipped.into_iter().next() {
            Some(first) => FolderError::NoneReadable { folder, count, first },
            None => FolderError::Empty { folder },
        });
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> ColourFrame {
        ColourFrame {
            planes: Array3::from_shape_fn((3, 4, 6), |(p, r, c)| (p * 24 + r * 6 + c) as f32 / 71.0),
        }
    }

    #[test]
    fn a_photograph_comes_back_to_half_a_code() {
        let dir = tempfile::tempdir().unwrap();
        for (ending, bits) in [("png", 8), ("png", 16), ("tif", 8), ("tif", 16), ("ppm", 8), ("ppm", 16)] {
            let path = dir.path().join(format!("photo.{ending}"));
            save(&path, &ramp(), bits).unwrap();
            let half_a_code = 0.5 / ((1 << bits) - 1) as f32;
            let back = load(&path).unwrap();
            for (a, b) in back.planes.iter().zip(&ramp().planes) {
                assert!((a - b).abs() <= half_a_code * 1.01, "{ending} {bits}");
            }
        }
    }

    #[test]
    fn pngs_and_tiffs_state_their_curve_and_are_the_same_bytes_each_time() {
        let dir = tempfile::tempdir().unwrap();
        let written = |name: &str, curve| {
            save_stated(&dir.path().join(name), &ramp(), 16, Some(curve)).unwrap();
            std::fs::read(dir.path().join(name)).unwrap()
        };
        for name in ["a.png", "a.tif"] {
            let linear = written(name, Statement::Linear);
            assert_eq!(Transfer::of(&linear).map(|stated| stated.curve), Some(Curve::Linear), "{name}");
            assert_eq!(linear, written(name, Statement::Linear));
            let bt709 = Transfer::of(&written(name, Statement::Bt709)).map(|stated| stated.curve);
            assert!(matches!(bt709, Some(Curve::Other(_))), "{name}: {bt709:?}");
        }
    }

    #[test]
    fn grey_gives_three_equal_planes() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("grey.pgm");
        std::fs::write(&path, "P2 2 1 100\n25 100").unwrap();
        assert_eq!(load(&path).unwrap().planes.iter().copied().collect::<Vec<_>>(), [0.25, 1.0].repeat(3));
    }

    #[test]
    fn light_outside_the_range_is_clipped_and_nan_is_black() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("x.ppm");
        let mut frame = ColourFrame::zeros(1, 3);
        for (c, v) in [-0.5, 1.5, f32::NAN].into_iter().enumerate() {
            frame.planes[(0, 0, c)] = v;
        }
        save(&path, &frame, 8).unwrap();
        assert_eq!(load(&path).unwrap().planes.slice(ndarray::s![0, 0, ..]).to_vec(), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn other_depths_are_rejected() {
        let error = save(Path::new("x.png"), &ramp(), 12).unwrap_err().to_string();
        assert_eq!(error, "x.png: 12 bits a sample: must be 8 or 16");
    }

    #[test]
    fn a_missing_photograph_is_named() {
        assert!(
            load(Path::new("no/such.png")).unwrap_err().to_string().starts_with("no/such.png: cannot read")
        );
    }

    #[test]
    fn unreadable_photographs_among_good_ones_are_named_and_skipped() {
        let dir = tempfile::tempdir().unwrap();
        save(&dir.path().join("b.png"), &ramp(), 8).unwrap();
        std::fs::write(dir.path().join("a.png"), "not a picture").unwrap();
        std::fs::write(dir.path().join("notes.txt"), "no photograph at all").unwrap();
        let Folder { photographs: photos, skipped, .. } = load_folder(dir.path()).unwrap();
        assert_eq!(photos.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["b"]);
        assert_eq!(skipped.len(), 1);
        assert!(skipped[0].to_string().contains("a.png: not a PNG"));
    }

    #[test]
    fn a_photograph_of_a_folder_that_states_another_curve_is_remarked_on() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        save(&at("a1.png"), &ramp(), 8).unwrap();
        let png = std::fs::read(at("a1.png")).unwrap();
        // gAMA 1, with its checksum.
        let gamma = b"\0\0\0\x04gAMA\0\x01\x86\xa0\x31\xe8\x96\x5f";
        std::fs::write(at("b2.png"), [&png[..33], gamma, &png[33..]].concat()).unwrap();
        let found = load_folder(dir.path()).unwrap();
        assert_eq!((found.photographs.len(), found.skipped.len(), found.remarks.len()), (2, 0, 1));
        let words =
            "b2.png: states linear light (gAMA 1); the photographs of a folder are all read by one --tone";
        assert!(found.remarks[0].contains(words), "{}", found.remarks[0]);
        let chosen = crate::photos::load(dir.path(), &crate::photos::Selection::All).unwrap();
        assert_eq!(chosen.remarks, found.remarks);
    }

    #[test]
    fn a_folder_without_a_usable_photograph_is_rejected() {
        let dir = tempfile::tempdir().unwrap();
        assert!(load_folder(dir.path()).unwrap_err().to_string().contains("contains no photographs"));
        std::fs::write(dir.path().join("a.png"), "not a picture").unwrap();
        let error = load_folder(dir.path()).unwrap_err().to_string();
        assert!(error.contains("1 photograph, none of which can be read; the first: "), "{error}");
        assert!(
            load_folder(Path::new("/nowhere")).unwrap_err().to_string().starts_with("/nowhere: cannot list")
        );
    }
}
