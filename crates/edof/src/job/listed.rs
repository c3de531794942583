//! A scene that a file lists, with its pictures.

use super::error::JobError;
use super::memory;
use super::note::PictureNote;
use super::photograph::{self, Tones, whole_cells};
use crate::presets::lens::Depth;
use edof_core::camera::Camera;
use edof_core::storage::provenance::Input;
use edof_core::{ColourFrame, Tone};
use edof_io::photo;
use edof_io::raw::Size;
use edof_optics::{Layer, Scene};
use edof_optics::{LayerFile, SceneFile, WrittenDepth};
use ndarray::{Axis, s};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Bytes per pixel that layers take, colours, mattes and what is made of them. Four take 99 to 164, sixteen 320 to 444: a quarter more is wanted.
pub(super) const fn bytes_a_pixel(layers: usize) -> f64 {
    24.0 * (layers + 6) as f64
}

/// A scene file that has been read, its pictures not yet.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedScene {
    path: PathBuf,
    file: SceneFile,
}

impl ListedScene {
    /// Returns whether a scene is in such a file, by its ending.
    #[must_use]
    pub fn is_named(scene: &Path) -> bool {
        scene.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
    }

    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read or lists no scene.
    pub fn load(path: &Path) -> Result<Self, JobError> {
        let file = SceneFile::load(path).map_err(|e| JobError::in_file(path, e))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Returns every picture that the file names.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> + '_ {
        self.file.files().map(|file| self.beside(file))
    }

    fn beside(&self, file: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(file)
    }

    /// Returns the scene before a camera, the tone of its pictures and what was read: `given`, else linear if all of them state linear light,
    /// else sRGB.
    ///
    /// # Errors
    /// A picture, matte or depth that cannot be used.
    pub fn scene(
        &self,
        given: Option<Tone>,
        camera: &Camera,
        note: &(dyn Fn(PictureNote) + Sync),
    ) -> Result<(Scene, Tone, Vec<Input>), JobError> {
        let name = self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let read = |(index, layer): (usize, &LayerFile)| {
            let (light, tone, inputs) = self.light(index, layer, given, note)?;
            let psi = psi(&layer.depth, camera).map_err(|e| self.in_layer(index, e))?;
            Ok::<_, JobError>((Layer { psi, ..light }, tone, inputs))
        };
        let read: Vec<_> = self.file.layers.par_iter().enumerate().map(read).collect();
        let (mut layers, mut is_linear, mut inputs) = (vec![], true, vec![]);
        for layer in read {
            let (layer, tone, own) = layer?;
            is_linear &= tone.is_light();
            inputs.extend(own);
            layers.push(layer);
        }
        let scene = Scene { name, layers };
        scene.check().map_err(|e| JobError::in_file(&self.path, e))?;
        Ok((scene, if is_linear { Tone::Linear } else { Tone::Srgb }, inputs))
    }

    /// Returns a layer with its light, already behind its matte, at no depth yet; the tone of its picture; and what it was read from.
    fn light(
        &self,
        index: usize,
        layer: &LayerFile,
        given: Option<Tone>,
        note: &dyn Fn(PictureNote),
    ) -> Result<(Layer, Tone, Vec<Input>), JobError> {
        let file = self.beside(&layer.picture);
        if layer.picture.as_os_str().is_empty() {
            return Err(self.in_layer(index, "picture: is empty, expected the name of a file"));
        }
        let (values, tone) = photograph::load(&file, Tones { given, usual: Tone::Srgb }, note)
            .map_err(|e| self.in_layer(index, e))?;
        let mut light = tone.into_decoded(values);
        let (height, width) = light.size();
        let layers = self.file.layers.len();
        memory::check(bytes_a_pixel(layers - index) * (width * height) as f64).map_err(|e| {
            JobError::in_file(&self.path, format!("{layers} layers of {width}x{height}: {e}"))
        })?;
        let picture = Input::photograph(&layer.picture.display().to_string(), &light);
        let Some(matte) = &layer.matte else {
            return Ok((Layer { light, matte: None, psi: 0.0 }, tone, vec![picture]));
        };
        let whole = self.matte(matte, &file, (height, width)).map_err(|e| self.in_layer(index, e))?;
        let planes = whole.slice_move(s![..height, ..width]).insert_axis(Axis(0));
        let grey = ColourFrame { planes };
        let inputs = vec![picture, Input::photograph(&matte.display().to_string(), &grey)];
        light.planes *= &grey.planes;
        let matte = Some(grey.planes.index_axis_move(Axis(0), 0));
        Ok((Layer { light, matte, psi: 0.0 }, tone, inputs))
    }

    /// Reads a matte of the size of its picture.
    fn matte(
        &self,
        matte: &Path,
        picture: &Path,
        size: (usize, usize),
    ) -> Result<ndarray::Array2<f32>, JobError> {
        let path = self.beside(matte);
        let whole = photo::load_grey(&path)?;
        check_size(&path, whole.dim(), whole_cells(whole.dim()), picture, size)?;
        Ok(whole)
    }

    fn in_layer(
        &self,
        index: usize,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> JobError {
        JobError::Layer { path: self.path.clone(), index, source: source.into() }
    }
}

/// Rejects a picture of another size than `other` has.
pub(super) fn check_size(
    path: &Path,
    found: (usize, usize),
    used: (usize, usize),
    other: &Path,
    expected: (usize, usize),
) -> Result<(), JobError> {
    if used == expected {
        return Ok(());
    }
    let [found, expected] = [found, expected].map(|(height, width)| Size { width, height });
    Err(JobError::OtherSize { path: path.to_owned(), found, expected, other: other.to_owned() })
}

fn psi(depth: &WrittenDepth, camera: &Camera) -> Result<f64, Box<dyn std::error::Error + Send + Sync>> {
    let depth = match depth {
        WrittenDepth::Psi(psi) => Depth::Psi(*psi),
        WrittenDepth::Text(text) => text.parse()?,
    };
    Ok(depth.psi(camera)?)
}
