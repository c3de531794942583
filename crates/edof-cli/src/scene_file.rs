//! A scene that a file of the user lists, with its pictures.

use crate::error::Error;
use crate::lens::Depth;
use crate::memory;
use crate::pictures::{self, Tones};
use crate::ui::Ui;
use edof_core::camera::Camera;
use edof_core::storage::provenance::Input;
use edof_core::{ColourFrame, Tone};
use edof_io::photo;
use edof_optics::{Layer, Scene};
use edof_optics::{LayerFile, SceneFile, WrittenDepth};
use ndarray::{Axis, s};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Bytes per pixel that layers take, colours, mattes and what is made of them. Four take 99 to 164, sixteen 320 to 444: a quarter more is wanted.
pub const fn bytes_a_pixel(layers: usize) -> f64 {
    24.0 * (layers + 6) as f64
}

/// A scene file that has been read, its pictures not yet.
#[derive(Debug)]
pub struct ListedScene {
    path: PathBuf,
    file: SceneFile,
}

/// Whether a scene is one of these.
pub fn is_scene_file(scene: &str) -> bool {
    Path::new(scene).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

impl ListedScene {
    /// # Errors
    /// A file that cannot be read or lists no scene.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let file = SceneFile::load(path).map_err(|e| Error::message(format!("{}: {e}", path.display())))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Every picture that it names.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> + '_ {
        self.file.files().map(|file| self.beside(file))
    }

    fn beside(&self, file: &Path) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(file)
    }

    /// The scene before a camera, and the tone of its pictures: `given`, else linear if all of them state linear light, else sRGB.
    ///
    /// # Errors
    /// A picture, matte or depth that cannot be used.
    pub fn scene(&self, given: Option<Tone>, camera: &Camera, ui: &Ui) -> Result<(Scene, Tone), Error> {
        let name = self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let read = |(index, layer): (usize, &LayerFile)| {
            let (light, tone, inputs) = self.light(index, layer, given, ui)?;
            Ok::<_, Error>((Layer { psi: self.psi(index, layer, camera)?, ..light }, tone, inputs))
        };
        let read: Vec<_> = self.file.layers.par_iter().enumerate().map(read).collect();
        let (mut layers, mut is_linear) = (vec![], true);
        for layer in read {
            let (layer, tone, inputs) = layer?;
            is_linear &= tone.is_light();
            inputs.into_iter().for_each(|input| ui.used(input));
            layers.push(layer);
        }
        let scene = Scene { name, layers };
        scene.check().map_err(|e| Error::message(format!("{}: {e}", self.path.display())))?;
        Ok((scene, if is_linear { Tone::Linear } else { Tone::Srgb }))
    }

    /// A layer with its light, already behind its matte, at no depth yet; the tone of its picture; and what it was read from.
    fn light(
        &self,
        index: usize,
        layer: &LayerFile,
        given: Option<Tone>,
        ui: &Ui,
    ) -> Result<(Layer, Tone, Vec<Input>), Error> {
        let file = self.beside(&layer.picture);
        let of_layer = |e: Error| Error::message(format!("{}: layer {index}: {e}", self.path.display()));
        if layer.picture.as_os_str().is_empty() {
            return Err(of_layer(Error::message("picture: is empty, expected the name of a file")));
        }
        let tones = Tones { given, usual: Tone::Srgb };
        let (values, tone) = pictures::load(&file, tones, ui).map_err(of_layer)?;
        let mut light = tone.into_decoded(values);
        let (height, width) = light.size();
        let job = format!("{}: {} layers of {width}x{height}", self.path.display(), self.file.layers.len());
        memory::check(&job, bytes_a_pixel(self.file.layers.len() - index) * (width * height) as f64)?;
        let picture = Input::photograph(&layer.picture.display().to_string(), &light);
        let Some(matte) = &layer.matte else {
            return Ok((Layer { light, matte: None, psi: 0.0 }, tone, vec![picture]));
        };
        let path = self.beside(matte);
        let whole = photo::load_grey(&path).map_err(|e| of_layer(e.into()))?;
        let (rows, columns) = whole.dim();
        if pictures::whole_cells((rows, columns)) != (height, width) {
            return Err(of_layer(Error::message(format!(
                "{}: {columns}x{rows}, expected {width}x{height} as {}",
                path.display(),
                file.display()
            ))));
        }
        let planes = whole.slice_move(s![..height, ..width]).insert_axis(Axis(0));
        let grey = ColourFrame { planes };
        let inputs = vec![picture, Input::photograph(&matte.display().to_string(), &grey)];
        light.planes *= &grey.planes;
        let matte = Some(grey.planes.index_axis_move(Axis(0), 0));
        Ok((Layer { light, matte, psi: 0.0 }, tone, inputs))
    }

    fn psi(&self, index: usize, layer: &LayerFile, camera: &Camera) -> Result<f64, Error> {
        let depth = match &layer.depth {
            WrittenDepth::Psi(psi) => Ok(Depth::Psi(*psi)),
            WrittenDepth::Text(text) => text.parse(),
        };
        depth
            .map_err(Error::message)
            .and_then(|depth| Ok(depth.psi(camera)?))
            .map_err(|e| Error::message(format!("{}: layer {index}: {e}", self.path.display())))
    }
}
