//! Scenes of layers: each an image with a matte, at one depth; composed back to front with occlusion.

use crate::blur::Blur;
use crate::composite::{Sheet, composite};
use crate::psf::Psf;
use crate::tiles::{Tiles, Transfer};
use edof_core::ColourFrame;
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;

/// Everything of a scene that lies at one depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Light that the layer sends, linear, already multiplied by the matte: (3, rows, columns).
    pub light: ColourFrame,
    /// Share of each pixel that the layer covers, 0…1; none for a background that covers all.
    pub matte: Option<Array2<f32>>,
    /// Depth as the defocus parameter ψ, radians at the camera's reference wavelength.
    pub psi: f64,
}

/// Layers from back to front, all of one size.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Short name, as in `chart-4`.
    pub name: String,
    /// The first covers everything.
    pub layers: Vec<Layer>,
}

/// Layers that make no scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum SceneError {
    /// Nothing to see.
    #[error("scene {0}: has no layers, expected one at least")]
    Empty(String),
    /// Layers of different sizes.
    #[error(
        "scene {scene}: layer {layer} is {width}x{height}, expected {expected_width}x{expected_height} as layer 0"
    )]
    Size {
        scene: String,
        layer: usize,
        height: usize,
        width: usize,
        expected_height: usize,
        expected_width: usize,
    },
    /// Light would fall through.
    #[error("scene {0}: its first layer has a matte, expected a background that covers the whole frame")]
    Background(String),
    /// No depth.
    #[error("scene {scene}: psi of layer {layer} is {psi}, expected a finite number")]
    Psi { scene: String, layer: usize, psi: f64 },
}

impl Scene {
    /// A picture at one depth.
    #[must_use]
    pub fn flat(name: impl Into<String>, picture: ColourFrame, psi: f64) -> Self {
        Self { name: name.into(), layers: vec![Layer { light: picture, matte: None, psi }] }
    }

    /// # Errors
    /// [`SceneError`] for the first thing that no scene can have.
    pub fn check(&self) -> Result<(), SceneError> {
        let scene = || self.name.clone();
        let Some(first) = self.layers.first() else { return Err(SceneError::Empty(scene())) };
        if first.matte.is_some() {
            return Err(SceneError::Background(scene()));
        }
        let (expected_height, expected_width) = first.light.size();
        for (layer, Layer { light, matte, psi }) in self.layers.iter().enumerate() {
            let sizes = [Some(light.size()), matte.as_ref().map(Array2::dim)];
            let odd_one = sizes.into_iter().flatten().find(|&size| size != (expected_height, expected_width));
            if let Some((height, width)) = odd_one {
                let scene = scene();
                return Err(SceneError::Size {
                    scene,
                    layer,
                    height,
                    width,
                    expected_height,
                    expected_width,
                });
            }
            if !psi.is_finite() {
                return Err(SceneError::Psi { scene: scene(), layer, psi: *psi });
            }
        }
        Ok(())
    }

    /// Rows and columns.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        self.layers.first().map_or((0, 0), |layer| layer.light.size())
    }

    /// What a camera without blur would see: the truth that reconstructions are measured against.
    #[must_use]
    pub fn sharp(&self) -> ColourFrame {
        self.compose(|index, channel| {
            let Layer { light, matte, .. } = &self.layers[index];
            (light.planes.index_axis(Axis(0), channel).to_owned(), matte.clone())
        })
    }

    /// What falls on the sensor when `psfs(ψ)` are the PSFs of red, green and blue. What a layer lets through of the layers behind
    /// it is its blurred matte; `psfs` is asked once a layer.
    pub fn blurred<'a>(&self, psfs: impl Fn(f64) -> &'a [Psf; 3]) -> ColourFrame {
        let psfs: Vec<&[Psf; 3]> = self.layers.iter().map(|layer| psfs(layer.psi)).collect();
        match Tiles::of_large(self.size(), psfs.iter().copied().flatten()) {
            Some(tiles) => self.blurred_in_tiles(&tiles, &psfs),
            None => self.blurred_whole(&psfs),
        }
    }

    fn blurred_whole(&self, psfs: &[&[Psf; 3]]) -> ColourFrame {
        let (height, width) = self.size();
        let plan = Blur::new(height, width);
        self.compose(|index, channel| {
            let Layer { light, matte, .. } = &self.layers[index];
            let transfer = plan.transfer(&psfs[index][channel]);
            let blur = |plane: ArrayView2<f32>| plan.apply(&plan.spectrum(plane), &transfer);
            let light = blur(light.planes.index_axis(Axis(0), channel));
            (light, matte.as_ref().map(|matte| blur(matte.view())))
        })
    }

    fn blurred_in_tiles(&self, tiles: &Tiles, psfs: &[&[Psf; 3]]) -> ColourFrame {
        // Layers may share PSFs.
        let mut kinds = psfs.to_vec();
        kinds.sort_by_key(|kind| std::ptr::from_ref(*kind));
        kinds.dedup_by_key(|kind| std::ptr::from_ref(*kind));
        let transfers: Vec<[Transfer; 3]> =
            kinds.par_iter().map(|kind| kind.each_ref().map(|psf| tiles.transfer(psf))).collect();
        let place = |psfs: &[Psf; 3]| kinds.iter().position(|kind| std::ptr::eq(*kind, psfs)).unwrap_or(0);
        let layers = self.layers.iter().zip(psfs);
        let sheets: Vec<Sheet> = layers
            .map(|(layer, psfs)| Sheet {
                light: layer.light.planes.view(),
                matte: layer.matte.as_ref().map(|matte| matte.view()),
                transfers: &transfers[place(psfs)],
            })
            .collect();
        ColourFrame { planes: composite(tiles, &sheets) }
    }

    /// For each pixel the ψ of the frontmost layer that covers half of it at least.
    #[must_use]
    pub fn psi_map(&self) -> Array2<f32> {
        let mut map = Array2::zeros(self.size());
        for layer in &self.layers {
            match &layer.matte {
                None => map.fill(layer.psi as f32),
                Some(matte) => map.zip_mut_with(matte, |psi, &m| {
                    if m >= 0.5 {
                        *psi = layer.psi as f32;
                    }
                }),
            }
        }
        map
    }

    /// Layers over each other as `seen(layer, channel)` gives their light and mattes.
    fn compose(
        &self,
        seen: impl Fn(usize, usize) -> (Array2<f32>, Option<Array2<f32>>) + Sync,
    ) -> ColourFrame {
        let (height, width) = self.size();
        let channel = |channel: usize| {
            let mut sum = Array2::zeros((height, width));
            for layer in 0..self.layers.len() {
                let (light, matte) = seen(layer, channel);
                if let Some(matte) = matte {
                    sum.zip_mut_with(&matte, |s, &m| *s *= 1.0 - m);
                    sum += &light;
                } else {
                    sum = light;
                }
            }
            sum
        };
        let planes: Vec<_> = (0..3usize).into_par_iter().map(channel).collect();
        let mut frame = ColourFrame::zeros(height, width);
        frame.planes.axis_iter_mut(Axis(0)).zip(&planes).for_each(|(mut to, from)| to.assign(from));
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::{kernel, picture};
    use crate::psf::{Settings, channel_psfs};
    use edof_core::camera::Camera;

    fn grey(level: f32, matte: Option<Array2<f32>>, psi: f64) -> Layer {
        let mut light = ColourFrame::zeros(40, 60);
        light.planes.fill(level);
        if let Some(matte) = &matte {
            light.planes *= matte;
        }
        Layer { light, matte, psi }
    }

    fn half() -> Array2<f32> {
        Array2::from_shape_fn((40, 60), |(_, c)| f32::from(u8::from(c < 30)))
    }

    fn scene(layers: Vec<Layer>) -> Scene {
        Scene { name: "test".into(), layers }
    }

    #[test]
    fn the_front_layer_hides_what_is_behind_it() {
        let sharp = scene(vec![grey(0.8, None, 0.0), grey(0.2, Some(half()), 6.0)]).sharp();
        assert_eq!((sharp.planes[(0, 5, 10)], sharp.planes[(0, 5, 50)]), (0.2, 0.8));
    }

    #[test]
    fn equal_layers_show_no_seam_however_blurred() {
        let scene = scene(vec![grey(0.5, None, 0.0), grey(0.5, Some(half()), 8.0)]);
        let camera = Camera::resolve("ring-2018").unwrap();
        let near = channel_psfs(&camera, 8.0, &Settings::default()).unwrap();
        let far = channel_psfs(&camera, 0.0, &Settings::default()).unwrap();
        let blurred = scene.blurred(|psi| if psi > 4.0 { &near } else { &far });
        assert!(blurred.planes.iter().all(|v| (v - 0.5).abs() < 1e-5));
    }

    #[test]
    fn a_scene_at_one_depth_is_a_plain_blur() {
        let mut picture = ColourFrame::zeros(40, 60);
        picture.planes.indexed_iter_mut().for_each(|((p, r, c), v)| *v = ((p + r * c) % 7) as f32 / 7.0);
        let psfs = channel_psfs(&Camera::resolve("clear").unwrap(), 5.0, &Settings::default()).unwrap();
        let composed = Scene::flat("p", picture.clone(), 5.0).blurred(|_| &psfs);
        assert_eq!(composed, crate::blur::blur_frame(&picture, &psfs));
    }

    #[test]
    fn a_scene_in_tiles_is_that_of_whole_planes() {
        let psfs = [1, 4, 7].map(|half| [half, half + 1, half + 2].map(|half| kernel(half, half % 2 == 0)));
        let mut back = grey(0.0, None, 0.0);
        back.light.planes.outer_iter_mut().for_each(|mut plane| plane.assign(&picture(40, 60, 9)));
        let disk = Array2::from_shape_fn((40, 60), |(r, c)| if r + c > 60 { 1.0 } else { 0.02 * r as f32 });
        let scene = scene(vec![
            back,
            grey(0.2, Some(half()), 1.0),
            grey(0.9, Some(disk), 2.0),
            grey(0.4, Some(half()), 1.0),
        ]);
        let of_layers: Vec<&[Psf; 3]> = scene.layers.iter().map(|layer| &psfs[layer.psi as usize]).collect();
        let whole = scene.blurred_whole(&of_layers);
        let cut = scene.blurred_in_tiles(&Tiles::with_periods((40, 60), 9, (32, 36)), &of_layers);
        assert!(whole.planes.iter().zip(&cut.planes).all(|(a, b)| (a - b).abs() < 1e-5));
    }

    #[test]
    fn the_depth_map_shows_the_front_layer() {
        let map = scene(vec![grey(0.8, None, 1.0), grey(0.2, Some(half()), 6.0)]).psi_map();
        assert_eq!((map[(0, 0)], map[(0, 59)]), (6.0, 1.0));
    }

    #[test]
    fn layers_that_make_no_scene_are_rejected() {
        let refused = |layers| scene(layers).check().unwrap_err();
        assert_eq!(refused(vec![]), SceneError::Empty("test".into()));
        assert_eq!(refused(vec![grey(0.1, Some(half()), 0.0)]), SceneError::Background("test".into()));
        let small = Layer { light: ColourFrame::zeros(8, 10), matte: None, psi: 0.0 };
        assert_eq!(
            refused(vec![grey(0.1, None, 0.0), small]).to_string(),
            "scene test: layer 1 is 10x8, expected 60x40 as layer 0"
        );
        let nowhere = refused(vec![grey(0.1, None, f64::NAN)]).to_string();
        assert_eq!(nowhere, "scene test: psi of layer 0 is NaN, expected a finite number");
    }
}
