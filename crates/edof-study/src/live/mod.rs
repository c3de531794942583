//! A picture before a lens that is moved while somebody looks: what a step gave is kept, so that noise is drawn again without a new blur, and a picture blurred
//! again without new PSFs.
//!
//! ```
//! use edof_core::camera::Camera;
//! use edof_optics::{Sensor, draw::{Builtin, draw}};
//! use edof_study::live::{Live, Subject, View};
//! let mut live = Live::default();
//! let subject = Subject::new(draw(Builtin::Chart, 64, 96, &[0.0], 0)?.sharp());
//! let view = View { camera: Camera::resolve("ring-outer")?, psi: 3.0 };
//! let raw = live.raw(&subject, &view, &Sensor::default())?;
//! assert_eq!(raw.size(), (64, 96));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod recent;

pub use recent::Recent;

use crate::metrics::{BORDER, MetricError, psnr, shown};
use edof_core::camera::Camera;
use edof_core::{ColourFrame, RawFrame, Tone};
use edof_optics::capture::{Approximation, CaptureError};
use edof_optics::psf::{NoPsf, Psf, channel_psfs};
use edof_optics::{Scene, Sensor, expose};
use ndarray::{Array3, s};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// PSFs that are kept, and blurred pictures.
const PLACES: [usize; 2] = [64, 24];

/// A sharp picture: its light, and what it is compared with.
#[derive(Debug)]
pub struct Subject {
    light: ColourFrame,
    shown: ColourFrame,
    number: u64,
}

impl Subject {
    /// Takes the light of a picture.
    #[must_use]
    pub fn new(light: ColourFrame) -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        Self { shown: shown(&light, Tone::Srgb), light, number: NUMBER.fetch_add(1, Ordering::Relaxed) }
    }

    /// The light.
    #[must_use]
    pub const fn light(&self) -> &ColourFrame {
        &self.light
    }

    /// PSNR in dB of the light of a picture of it, both as they are looked at.
    ///
    /// # Errors
    /// [`MetricError`] for pictures of another size, or too small to compare.
    pub fn psnr_db(&self, light: &ColourFrame) -> Result<f64, MetricError> {
        psnr(&self.shown, &shown(light, Tone::Srgb), BORDER)
    }
}

/// A lens and the depth of what is before it.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The lens.
    pub camera: Camera,
    /// ψ in radians.
    pub psi: f64,
}

/// What was computed last.
#[derive(Debug)]
pub struct Live {
    psfs: Recent<View, [Psf; 3]>,
    lights: Recent<(u64, View), ColourFrame>,
}

impl Default for Live {
    fn default() -> Self {
        let [psfs, lights] = PLACES;
        Self { psfs: Recent::new(psfs), lights: Recent::new(lights) }
    }
}

impl Live {
    /// PSFs of red, green and blue, as a capture computes them.
    ///
    /// # Errors
    /// [`NoPsf`].
    pub fn psfs(&mut self, view: &View) -> Result<Arc<[Psf; 3]>, NoPsf> {
        let settings = Approximation::default().psf;
        self.psfs.get(view.clone(), |view| channel_psfs(&view.camera, view.psi, &settings))
    }

    /// The raw frame that [`edof_optics::capture::capture`] gives of the picture at one depth, to the last bit.
    ///
    /// # Errors
    /// [`CaptureError`].
    pub fn raw(&mut self, subject: &Subject, view: &View, sensor: &Sensor) -> Result<RawFrame, CaptureError> {
        let psfs = self.psfs(view)?;
        let light = self.lights.get((subject.number, view.clone()), |_| {
            let scene = Scene::flat("", subject.light.clone(), view.psi);
            Ok::<_, CaptureError>(scene.blurred(|_| &psfs))
        })?;
        Ok(expose(&light, sensor)?)
    }
}

/// The colours behind the filters of a raw frame: each pixel has one, the others are black.
#[must_use]
pub fn mosaic(raw: &RawFrame) -> ColourFrame {
    let (height, width) = raw.size();
    let mut frame = ColourFrame::zeros(height, width);
    for ((row, column), word) in raw.pixels().indexed_iter() {
        frame.planes[(raw.phase().channel(row, column).plane(), row, column)] = f32::from(*word) / 65536.0;
    }
    frame
}

/// A picture made small enough for a room of rows and columns: means of squares of pixels, as large as needed, then its middle, with even sides.
#[must_use]
pub fn fitted(frame: &ColourFrame, (rows, columns): (usize, usize)) -> ColourFrame {
    let (height, width) = frame.size();
    // One side fits, the other is cut.
    let square = (height / rows).min(width / columns).max(1);
    let (small_height, small_width) = (height / square, width / square);
    let mut planes = Array3::zeros((3, small_height, small_width));
    for row in 0..square {
        for column in 0..square {
            let step = square as isize;
            let part = frame.planes.slice(s![.., row..;step, column..;step]);
            planes += &part.slice(s![.., ..small_height, ..small_width]);
        }
    }
    planes /= (square * square) as f32;
    let kept = |side: usize, room: usize| side.min(room) & !1;
    let (height, width) = (kept(small_height, rows), kept(small_width, columns));
    let (top, left) = ((small_height - height) / 2, (small_width - width) / 2);
    ColourFrame { planes }.crop(top, left, height, width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Noise;
    use edof_optics::capture::capture;
    use edof_optics::draw::{Builtin, draw};

    #[test]
    fn a_moved_lens_gives_what_a_capture_gives_to_the_last_bit() {
        let mut live = Live::default();
        let picture = draw(Builtin::Leaves, 64, 96, &[0.0], 3).unwrap().sharp();
        let subject = Subject::new(picture.clone());
        for (name, psi, seed) in [("ring-outer", 2.0, 1), ("ring-outer", 2.0, 2), ("clear-mid", 2.0, 1)] {
            let camera = Camera::resolve(name).unwrap();
            let sensor = Sensor { noise: Noise::sensor(4.0), seed, ..Sensor::default() };
            let scene = Scene::flat("", picture.clone(), psi);
            let whole = capture(&scene, &camera, &sensor, &Approximation::default()).unwrap().raw;
            assert_eq!(live.raw(&subject, &View { camera, psi }, &sensor).unwrap(), whole, "{name} {seed}");
        }
        // Another picture of the same size is another one.
        let other = Subject::new(ColourFrame::zeros(64, 96));
        let view = View { camera: Camera::resolve("ring-outer").unwrap(), psi: 2.0 };
        let raw = live.raw(&other, &view, &Sensor::default()).unwrap();
        assert!(raw.pixels().iter().all(|word| *word == 0));
    }

    #[test]
    fn pixels_keep_the_colour_of_their_filter() {
        let mut light = ColourFrame::zeros(4, 4);
        light.planes.fill(0.5);
        let coloured = mosaic(&expose(&light, &Sensor::default()).unwrap());
        assert_eq!(coloured.planes.sum(), 0.5 * 16.0);
        assert_eq!([0, 1, 2].map(|plane| coloured.planes[(plane, 0, 0)]), [0.5, 0.0, 0.0]);
    }

    #[test]
    fn a_large_picture_is_averaged_and_its_middle_kept() {
        let mut large = ColourFrame::zeros(100, 210);
        large.planes.indexed_iter_mut().for_each(|((_, _, column), v)| *v = column as f32);
        let small = fitted(&large, (32, 48));
        assert_eq!(small.size(), (32, 48));
        // Squares of three pixels: 70 columns of means, 11 of them cut at the left.
        assert_eq!(small.planes[(1, 5, 0)], 34.0);
        assert_eq!(fitted(&large, (300, 300)).size(), (100, 210));
    }
}
