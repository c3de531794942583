//! PSFs of the user, measured or from another program, in place of those that follow from a camera's lens and mask.
//!
//! A camera file names a bank by `"psf_bank": { "file": "lens.npz" }`. The bank is an NPZ (compressed or not) or safetensors file with these
//! arrays, or an NPY file `…psf.npy` with `…psi.npy` beside it; numbers may be floats of 16, 32 or 64 bits, or integers:
//!
//! | array | shape | holds |
//! |---|---|---|
//! | `psi` | depths | ψ in radians at the camera's reference wavelength, ascending |
//! | `psf` | depths × 3 × rows × columns | kernels of red, green and blue on the sensor's grid, the first row on top |
//! | `pixel_pitch_um` | 1; may be missing | the grid's spacing, which must be the camera's |
//!
//! A kernel is the picture of a point that would fall on the pixel (rows/2, columns/2), counted from 0 and rounded down, if nothing blurred
//! it. It may have any shape; only its own shape counts: each is scaled to sum 1. Zeros around it cost nothing. `"centre": true` shifts all
//! kernels by one displacement ([`Kernels::centred`]).

use super::centring::{centroid, shifted};
use crate::storage::arrays::{self, ArraysError};
use crate::storage::digest::sha256;
use crate::words::{numbers, sides};
use ndarray::{Array2, ArrayD, ArrayView2, ArrayView4, Axis, Ix4};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A sum this near to 1 is 1: kernels that were scaled once are taken as they are.
const ONE: f64 = 1e-6;

/// A camera's own PSFs: where they lie, and what they are once they were read. Two are the same if they hold the same kernels.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PsfBank {
    /// The file, seen from the folder of the camera file.
    pub file: String,
    /// SHA-256 of ψ and kernels, as hexadecimal digits; a file of other content is rejected. Where a camera file leaves it out,
    /// reading the bank fills it in.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sha256: String,
    /// Whether the kernels are read [`Kernels::centred`]; the SHA-256 is then that of the shifted kernels.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub centre: bool,
    /// The kernels; none until they were read.
    #[serde(skip)]
    pub kernels: Option<Arc<Kernels>>,
}

impl PartialEq for PsfBank {
    fn eq(&self, other: &Self) -> bool {
        self.sha256 == other.sha256
    }
}

/// Kernels of red, green and blue at several depths.
#[derive(Debug, Clone)]
pub struct Kernels {
    psis: Vec<f64>,
    kernels: Vec<[Array2<f32>; 3]>,
    /// Of the array that they are from; no part of what they are.
    edges: Vec<[f64; 3]>,
    pixel_pitch_um: Option<f64>,
}

impl PartialEq for Kernels {
    fn eq(&self, other: &Self) -> bool {
        self.psis == other.psis
            && self.kernels == other.kernels
            && self.pixel_pitch_um == other.pixel_pitch_um
    }
}

/// Arrays that make no bank.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum KernelsError {
    /// Not there, or no numbers.
    #[error("contains no numeric array '{array}', only {found}")]
    Missing { array: &'static str, found: String },
    /// Another shape.
    #[error("array '{array}' is {}, expected {expected}", sides(found))]
    Shape { array: &'static str, found: Vec<usize>, expected: String },
    /// No ascending numbers.
    #[error("psi: must be finite and ascending, is {}", numbers(.0))]
    Psi(Vec<f64>),
    /// Light that cannot be.
    #[error(
        "psf at psi {psi}, {channel}: row {row}, column {column} is {value}, light is finite and never negative"
    )]
    Light { psi: f64, channel: &'static str, row: usize, column: usize, value: f64 },
    /// Kernels in a file of one array, without depths.
    #[error(
        "psi is missing: an NPY file contains one array; {0}, or write both to one NPZ file by numpy.savez"
    )]
    NoPsi(String),
    /// A kernel of zeros.
    #[error("psf at psi {psi}, {channel}: all zero, expected a kernel that can be scaled to sum 1")]
    Dark { psi: f64, channel: &'static str },
}

/// A bank that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum BankError {
    /// The file.
    #[error(transparent)]
    Arrays(#[from] ArraysError),
    /// The arrays of the file.
    #[error("{path}: no PSF bank: {source}", path = path.display())]
    Kernels { path: PathBuf, source: KernelsError },
    /// Not those that the camera means.
    #[error("{path}: its kernels have the SHA-256 {found}, camera {camera} states {stated}", path = path.display())]
    Changed { path: PathBuf, camera: String, found: String, stated: String },
    /// Made for another sensor.
    #[error("{path}: kernels on a grid of {found} um, the pixels of camera {camera} are {expected} um apart", path = path.display())]
    Pitch { path: PathBuf, camera: String, found: f64, expected: f64 },
}

const CHANNELS: [&str; 3] = ["red", "green", "blue"];

impl Kernels {
    /// A bank from arrays as a file holds them.
    ///
    /// # Errors
    /// [`KernelsError`].
    pub fn new(
        psis: Vec<f64>,
        psf: ArrayView4<f64>,
        pixel_pitch_um: Option<f64>,
    ) -> Result<Self, KernelsError> {
        let ascending =
            psis.windows(2).all(|pair| pair[0] < pair[1]) && psis.iter().all(|psi| psi.is_finite());
        if psis.is_empty() || !ascending {
            return Err(KernelsError::Psi(psis));
        }
        let (depths, channels, rows, columns) = psf.dim();
        if (depths, channels) != (psis.len(), 3) || rows == 0 || columns == 0 {
            let expected = format!("{} depths x 3 channels x rows x columns", psis.len());
            return Err(KernelsError::Shape { array: "psf", found: psf.shape().to_vec(), expected });
        }
        let depth =
            |(psi, planes): (&f64, ndarray::ArrayView3<f64>)| -> Result<[Array2<f32>; 3], KernelsError> {
                let kernel =
                    |channel: usize| kernel(planes.index_axis(Axis(0), channel), *psi, CHANNELS[channel]);
                Ok([kernel(0)?, kernel(1)?, kernel(2)?])
            };
        let kernels = psis.iter().zip(psf.outer_iter()).map(depth).collect::<Result<_, _>>()?;
        let edges = psf.outer_iter().map(|planes| [0, 1, 2].map(|c| edge(planes.index_axis(Axis(0), c))));
        Ok(Self { edges: edges.collect(), psis, kernels, pixel_pitch_um })
    }

    /// From a file.
    ///
    /// # Errors
    /// [`BankError::Arrays`] or [`BankError::Kernels`].
    pub fn load(path: &Path) -> Result<Self, BankError> {
        let mut arrays = of_file_or_files(path)?;
        let found = arrays.keys().cloned().collect::<Vec<_>>().join(", ");
        let mut take = |array: &'static str| {
            arrays.remove(array).ok_or_else(|| KernelsError::Missing { array, found: found.clone() })
        };
        let mut made = || {
            let (psi, psf, pitch) = (take("psi")?, take("psf")?, take("pixel_pitch_um").ok());
            let shape = |array, of: &ArrayD<f64>, expected: &str| KernelsError::Shape {
                array,
                found: of.shape().to_vec(),
                expected: expected.to_owned(),
            };
            if psi.ndim() > 1 {
                return Err(shape("psi", &psi, "one number a depth"));
            }
            let psf = psf
                .view()
                .into_dimensionality::<Ix4>()
                .map_err(|_| shape("psf", &psf, "depths x 3 channels x rows x columns"))?;
            Self::new(psi.iter().copied().collect(), psf, pitch.and_then(|p| p.first().copied()))
        };
        made().map_err(|source| BankError::Kernels { path: path.to_owned(), source })
    }

    /// Depths, ascending.
    #[must_use]
    pub fn psis(&self) -> &[f64] {
        &self.psis
    }

    /// Red, green and blue at the depth of that index: square, an odd number of pixels a side, sum 1.
    #[must_use]
    pub fn at(&self, depth: usize) -> &[Array2<f32>; 3] {
        &self.kernels[depth]
    }

    /// Shares of the light of [`Kernels::at`] in the first and last rows and columns of the file's array: what a larger array would add.
    #[must_use]
    pub fn edges(&self, depth: usize) -> [f64; 3] {
        self.edges[depth]
    }

    /// Mean of the centroids of all kernels: pixels to the right of the middle pixel, and down from it.
    #[must_use]
    pub fn mean_centroid(&self) -> [f64; 2] {
        let all: Vec<[f64; 2]> =
            self.kernels.iter().flatten().map(|kernel| centroid(kernel.view())).collect();
        [0, 1].map(|axis| all.iter().map(|at| at[axis]).sum::<f64>() / all.len() as f64)
    }

    /// Shifts all kernels by one displacement, so that [`Kernels::mean_centroid`] is the middle pixel to a thousandth of a pixel.
    /// Differences between depths and colours stay. Parts of a pixel are interpolated linearly, which blurs by at most half a pixel.
    #[must_use]
    pub fn centred(&self) -> Self {
        let back = self.mean_centroid().map(|pixels| -(pixels * 1000.0).round() / 1000.0);
        let moved = |kernel: &Array2<f32>| cut(shifted(kernel.view(), back).view(), 1.0);
        let kernels = self.kernels.iter().map(|depth| depth.each_ref().map(moved)).collect();
        Self { kernels, ..self.clone() }
    }

    /// SHA-256 of ψ and kernels.
    #[must_use]
    pub fn sha256(&self) -> String {
        let mut bytes: Vec<u8> = self.psis.iter().flat_map(|psi| psi.to_le_bytes()).collect();
        for kernel in self.kernels.iter().flatten() {
            bytes.extend((kernel.nrows() as u64).to_le_bytes());
            bytes.extend(kernel.iter().flat_map(|v| v.to_le_bytes()));
        }
        sha256(&bytes)
    }
}

/// One kernel without the zeros around it, about its middle.
fn kernel(plane: ArrayView2<f64>, psi: f64, channel: &'static str) -> Result<Array2<f32>, KernelsError> {
    if let Some(((row, column), &value)) = plane.indexed_iter().find(|(_, v)| !(v.is_finite() && **v >= 0.0))
    {
        return Err(KernelsError::Light { psi, channel, row, column, value });
    }
    let sum = plane.sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return Err(KernelsError::Dark { psi, channel });
    }
    Ok(cut(plane, if (sum - 1.0).abs() <= ONE { 1.0 } else { 1.0 / sum }))
}

/// Share of the light in the first and last rows and columns.
fn edge(plane: ArrayView2<f64>) -> f64 {
    let (rows, columns) = plane.dim();
    let is_outer = |(r, c): (usize, usize)| r == 0 || c == 0 || r + 1 == rows || c + 1 == columns;
    plane.indexed_iter().filter(|(at, _)| is_outer(*at)).map(|(_, v)| v).sum::<f64>() / plane.sum()
}

/// A scaled plane without the zeros around it: the smallest square about its middle pixel.
fn cut(plane: ArrayView2<f64>, scale: f64) -> Array2<f32> {
    let (middle_row, middle_column) = (plane.nrows() / 2, plane.ncols() / 2);
    let reach = |(r, c): (usize, usize)| r.abs_diff(middle_row).max(c.abs_diff(middle_column));
    let half = plane.indexed_iter().filter(|(_, v)| **v > 0.0).map(|(at, _)| reach(at)).max().unwrap_or(0);
    let side = 2 * half + 1;
    let source = |index: usize, middle: usize| (index + middle).checked_sub(half);
    Array2::from_shape_fn((side, side), |(r, c)| {
        let at = source(r, middle_row).zip(source(c, middle_column));
        at.and_then(|at| plane.get(at)).map_or(0.0, |v| (v * scale) as f32)
    })
}

/// The arrays of a file; of an NPY file, which holds one, the others from beside it: `lens-psi.npy` of `lens-psf.npy`.
fn of_file_or_files(path: &Path) -> Result<BTreeMap<String, ArrayD<f64>>, BankError> {
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npy")) {
        return Ok(arrays::read(path)?);
    }
    let no_psi = |how| BankError::Kernels { path: path.to_owned(), source: KernelsError::NoPsi(how) };
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let Some((before, after)) = stem.rsplit_once("psf") else {
        arrays::read(path)?;
        return Err(no_psi(format!(
            "name it {stem}-psf.npy and put the depths into {stem}-psi.npy beside it"
        )));
    };
    let mut all = BTreeMap::new();
    for array in ["psf", "psi", "pixel_pitch_um"] {
        let file = path.with_file_name(format!("{before}{array}{after}.npy"));
        if array != "psf" && !file.exists() {
            match array {
                "psi" => {
                    return Err(no_psi(format!(
                        "put the depths into {} beside it",
                        file.file_name().unwrap_or_default().to_string_lossy()
                    )));
                }
                _ => continue,
            }
        }
        all.extend(arrays::read(&file)?.into_values().map(|values| (array.to_owned(), values)));
    }
    Ok(all)
}

impl PsfBank {
    /// Reads the bank from `folder`, for the camera of that name and pixel pitch.
    ///
    /// # Errors
    /// [`BankError`].
    pub fn read(&mut self, folder: &Path, camera: &str, pixel_pitch_um: f64) -> Result<(), BankError> {
        let path = folder.join(&self.file);
        let kernels = Kernels::load(&path)?;
        let kernels = if self.centre { kernels.centred() } else { kernels };
        let (found, camera) = (kernels.sha256(), camera.to_owned());
        if !self.sha256.is_empty() && self.sha256 != found {
            return Err(BankError::Changed { path, camera, found, stated: self.sha256.clone() });
        }
        let same = |pitch: f64| (pitch / pixel_pitch_um - 1.0).abs() <= 1e-3;
        if let Some(pitch) = kernels.pixel_pitch_um.filter(|pitch| !same(*pitch)) {
            return Err(BankError::Pitch { path, camera, found: pitch, expected: pixel_pitch_um });
        }
        (self.sha256, self.kernels) = (found, Some(Arc::new(kernels)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array4;

    /// Two depths; each kernel a bright middle and a spot to the right of it, in a frame of zeros.
    fn arrays(rows: usize, columns: usize) -> Array4<f64> {
        Array4::from_shape_fn((2, 3, rows, columns), |(d, c, row, column)| {
            let at = (row, column);
            if at == (rows / 2, columns / 2) {
                0.75
            } else if at == (rows / 2, columns / 2 + 1) {
                0.25 * (1 + d + c) as f64
            } else {
                0.0
            }
        })
    }

    fn kernels(psis: &[f64], psf: &Array4<f64>) -> Result<Kernels, String> {
        Kernels::new(psis.to_vec(), psf.view(), None).map_err(|e| e.to_string())
    }

    #[test]
    fn kernels_of_any_sides_are_cut_about_their_middle_and_sum_to_one() {
        for (rows, columns) in [(3, 3), (7, 9), (8, 8), (1, 4)] {
            let bank = kernels(&[0.0, 4.0], &arrays(rows, columns)).unwrap();
            let [red, _, blue] = bank.at(0);
            assert_eq!(
                (red.dim(), red[(1, 1)], red[(1, 2)], red[(1, 0)]),
                ((3, 3), 0.75, 0.25, 0.0),
                "{rows}x{columns}"
            );
            assert!((blue.sum() - 1.0).abs() < 1e-6 && (blue[(1, 2)] - 0.5).abs() < 1e-6);
        }
    }

    #[test]
    fn a_bank_is_known_by_its_kernels_and_depths() {
        let hash = |psis: &[f64], psf: &Array4<f64>| kernels(psis, psf).unwrap().sha256();
        let (one, mut other) = (arrays(5, 5), arrays(5, 5));
        assert_eq!(hash(&[0.0, 4.0], &one), hash(&[0.0, 4.0], &arrays(9, 7)));
        assert_ne!(hash(&[0.0, 4.0], &one), hash(&[0.0, 5.0], &one));
        other[(1, 1, 2, 1)] = 0.1;
        assert_ne!(hash(&[0.0, 4.0], &one), hash(&[0.0, 4.0], &other));
    }

    #[test]
    fn a_bank_is_centred_by_one_displacement_of_whole_and_part_pixels() {
        let bank = kernels(&[0.0, 4.0], &arrays(7, 9)).unwrap();
        // Of a kernel of 3 : n beside each other the centroid is n / (3 + n) pixels right of the first.
        let expected = |n: f64| n / (3.0 + n);
        let of = |kernel: &Array2<f32>| centroid(kernel.view());
        assert!((of(&bank.at(1)[2])[0] - expected(4.0)).abs() < 1e-6);
        let mean = [1.0, 2.0, 3.0, 2.0, 3.0, 4.0].map(expected).iter().sum::<f64>() / 6.0;
        assert!((bank.mean_centroid()[0] - mean).abs() < 1e-6 && bank.mean_centroid()[1].abs() < 1e-9);
        let centred = bank.centred();
        assert!(centred.mean_centroid().iter().all(|pixels| pixels.abs() < 0.0006));
        assert!(centred.kernels.iter().flatten().all(|kernel| (kernel.sum() - 1.0).abs() < 1e-6));
        for (kernel, moved) in bank.kernels.iter().flatten().zip(centred.kernels.iter().flatten()) {
            assert!(
                (of(kernel)[0] - of(moved)[0] - mean).abs() < 0.0006,
                "colours and depths keep their distances"
            );
        }
        assert_ne!(bank.sha256(), centred.sha256());
        assert_eq!(centred.centred().sha256(), centred.sha256(), "a centred bank stays");
        // By whole pixels: the same kernels elsewhere in the array.
        let mut moved = Array4::zeros((2, 3, 15, 17));
        moved.slice_mut(ndarray::s![.., .., 1..8, 7..16]).assign(&arrays(7, 9));
        let away = kernels(&[0.0, 4.0], &moved).unwrap();
        assert!(
            (away.mean_centroid()[0] - mean - 3.0).abs() < 1e-6
                && (away.mean_centroid()[1] + 3.0).abs() < 1e-6
        );
        assert_eq!(away.centred().sha256(), centred.sha256());
    }

    #[test]
    fn light_on_the_edge_of_an_array_is_known() {
        let bank = kernels(&[0.0, 4.0], &arrays(3, 3)).unwrap();
        assert!((bank.edges(1)[2] - 4.0 / 7.0).abs() < 1e-9 && (bank.edges(0)[0] - 0.25).abs() < 1e-9);
        assert_eq!(kernels(&[0.0, 4.0], &arrays(5, 5)).unwrap().edges(1), [0.0; 3]);
    }

    #[test]
    fn what_is_no_bank_is_rejected() {
        let refused = |psis: &[f64], psf: &Array4<f64>| kernels(psis, psf).unwrap_err();
        assert_eq!(refused(&[4.0, 0.0], &arrays(3, 3)), "psi: must be finite and ascending, is 4, 0");
        assert!(refused(&[0.0, f64::NAN], &arrays(3, 3)).starts_with("psi: must be finite"));
        assert!(
            refused(&[0.0], &arrays(3, 3))
                .contains("array 'psf' is 2 x 3 x 3 x 3, expected 1 depths x 3 channels")
        );
        let with = |value| {
            let mut psf = arrays(3, 3);
            psf[(1, 2, 0, 1)] = value;
            refused(&[0.0, 4.0], &psf)
        };
        assert_eq!(
            with(-0.5),
            "psf at psi 4, blue: row 0, column 1 is -0.5, light is finite and never negative"
        );
        assert!(with(f64::NAN).contains("is NaN"));
        let dark = Array4::zeros((2, 3, 3, 3));
        assert!(refused(&[0.0, 4.0], &dark).starts_with("psf at psi 0, red: all zero"));
    }
}
