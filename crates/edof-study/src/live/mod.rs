//! A picture before a lens that is moved while somebody looks: what a step gave is kept, so that noise is drawn again without a new blur, and a picture blurred
//! again without new PSFs.
//!
//! ```
//! use edof_core::camera::Camera;
//! use edof_optics::{Sensor, draw::{Builtin, draw}};
//! use edof_deblur::Malvar;
//! use edof_study::live::{Live, Shot, Subject, View};
//! use std::sync::Arc;
//! let mut live = Live::default();
//! let subject = Arc::new(Subject::new(draw(Builtin::Chart, 64, 96, &[0.0], 0)?.sharp()));
//! let view = View { camera: Camera::resolve("ring-outer")?, psi: 3.0 };
//! let shot = Shot { subject, view, sensor: Sensor::default() };
//! let pictures = live.developed(&[(&shot, "demosaiced", &Malvar::default())])?;
//! assert!(pictures[0].psnr_db > 15.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod recent;

pub use recent::Recent;

use crate::metrics::{BORDER, MetricError, psnr};
use edof_core::camera::Camera;
use edof_core::{ColourFrame, RawFrame, ReconstructError, Reconstructor, Tone};
use edof_optics::capture::{Approximation, CaptureError};
use edof_optics::psf::{NoPsf, Psf, channel_psfs};
use edof_optics::{Blur, Sensor, Spectrum, expose};
use ndarray::{Array3, Axis, s};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// PSFs that are kept, blurred pictures, and reconstructed ones.
const PLACES: [usize; 3] = [64, 24, 48];

/// A sharp picture: its light, and what it is compared with.
pub struct Subject {
    light: ColourFrame,
    shown: ColourFrame,
    plan: Blur,
    spectra: [Spectrum; 3],
    number: u64,
}

impl Subject {
    /// Takes the light of a picture.
    #[must_use]
    pub fn new(light: ColourFrame) -> Self {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let (height, width) = light.size();
        let plan = Blur::new(height, width);
        let spectra = [0, 1, 2].map(|plane| plan.spectrum(light.planes.index_axis(Axis(0), plane)));
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        Self { shown: shown(&light), light, plan, spectra, number }
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
        psnr(&self.shown, &shown(light), BORDER)
    }

    /// What falls on the sensor behind PSFs of red, green and blue.
    fn blurred(&self, psfs: &[Psf; 3]) -> ColourFrame {
        let plane = |plane: usize| self.plan.apply(&self.spectra[plane], &self.plan.transfer(&psfs[plane]));
        let planes: Vec<_> = (0..3usize).into_par_iter().map(plane).collect();
        let mut frame = ColourFrame::zeros(self.light.size().0, self.light.size().1);
        frame.planes.outer_iter_mut().zip(&planes).for_each(|(mut to, from)| to.assign(from));
        frame
    }
}

/// A picture of light as it is looked at.
fn shown(light: &ColourFrame) -> ColourFrame {
    let mut shown = light.clone();
    Tone::Srgb.darken(&mut shown);
    shown
}

/// A lens and the depth of what is before it.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The lens.
    pub camera: Camera,
    /// ψ in radians.
    pub psi: f64,
}

/// A picture that a lens and a sensor take.
#[derive(Clone)]
pub struct Shot {
    /// Before the lens.
    pub subject: Arc<Subject>,
    /// The lens.
    pub view: View,
    /// The sensor.
    pub sensor: Sensor,
}

impl PartialEq for Shot {
    fn eq(&self, other: &Self) -> bool {
        let key = |shot: &'_ Self| shot.subject.number;
        key(self) == key(other) && self.view == other.view && self.sensor == other.sensor
    }
}

/// What a method made of a frame.
#[derive(Debug)]
pub struct Developed {
    /// The picture's light.
    pub frame: ColourFrame,
    /// How near it comes to the sharp picture.
    pub psnr_db: f64,
}

/// A shot, what is done with its frame, and the name under which that is known.
pub type Task<'a, K> = (&'a Shot, K, &'a dyn Reconstructor);

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// The lens or the sensor.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    /// A method rejected the frame.
    #[error(transparent)]
    Reconstruct(#[from] ReconstructError),
    /// A picture too small to measure.
    #[error(transparent)]
    Metric(#[from] MetricError),
}

/// What was computed last; methods are known by values of `K`.
pub struct Live<K> {
    psfs: Recent<View, [Psf; 3]>,
    lights: Recent<(u64, View), ColourFrame>,
    raws: Recent<Shot, RawFrame>,
    pictures: Recent<(Shot, K), Developed>,
}

impl<K: PartialEq> Default for Live<K> {
    fn default() -> Self {
        let [psfs, lights, pictures] = PLACES;
        Self {
            psfs: Recent::new(psfs),
            lights: Recent::new(lights),
            raws: Recent::new(pictures),
            pictures: Recent::new(pictures),
        }
    }
}

impl<K: PartialEq + Clone + Send> Live<K> {
    /// PSFs of red, green and blue, as a capture computes them.
    ///
    /// # Errors
    /// [`NoPsf`].
    pub fn psfs(&mut self, view: &View) -> Result<Arc<[Psf; 3]>, NoPsf> {
        self.psfs.get(view.clone(), psfs_of)
    }

    /// The raw frame that [`edof_optics::capture::capture`] gives of the picture at one depth, to the last bit.
    ///
    /// # Errors
    /// [`CaptureError`].
    pub fn raw(&mut self, shot: &Shot) -> Result<Arc<RawFrame>, CaptureError> {
        self.take(&[shot])?;
        let missing = || unreachable!("a frame that was just taken is kept");
        Ok(self.raws.find(shot).unwrap_or_else(missing))
    }

    /// Takes the frames that are not kept, side by side.
    fn take(&mut self, shots: &[&Shot]) -> Result<(), CaptureError> {
        let mut missing: Vec<&Shot> = vec![];
        for shot in shots {
            if self.raws.find(shot).is_none() && !missing.contains(shot) {
                missing.push(shot);
            }
        }
        let mut lit = |shot: &&Shot| {
            let key = (shot.subject.number, shot.view.clone());
            (self.lights.find(&key), self.psfs.find(&shot.view))
        };
        let kept: Vec<_> = missing.iter().map(&mut lit).collect();
        let taken = missing.par_iter().zip(kept).map(|(shot, (light, psfs))| Taken::new(shot, light, psfs));
        for (shot, taken) in missing.iter().zip(taken.collect::<Result<Vec<_>, _>>()?) {
            let Shot { subject, view, .. } = shot;
            if let Some(psfs) = taken.psfs {
                self.psfs.keep(view.clone(), psfs);
            }
            if let Some(light) = taken.light {
                self.lights.keep((subject.number, view.clone()), light);
            }
            self.raws.keep((*shot).clone(), taken.raw);
        }
        Ok(())
    }

    /// What methods make of shots; those that are not kept are computed side by side.
    ///
    /// # Errors
    /// The first [`LiveError`].
    pub fn developed(&mut self, tasks: &[Task<'_, K>]) -> Result<Vec<Arc<Developed>>, LiveError> {
        let kept = tasks.iter().map(|(shot, name, _)| self.pictures.find(&((*shot).clone(), name.clone())));
        let kept: Vec<_> = kept.collect();
        self.take(&tasks.iter().map(|(shot, ..)| *shot).collect::<Vec<_>>())?;
        let raws = tasks.iter().map(|(shot, ..)| self.raw(shot)).collect::<Result<Vec<_>, _>>()?;
        let missing = |at: &usize| kept[*at].is_none();
        let made = (0..tasks.len()).filter(missing).map(|at| (tasks[at].0, tasks[at].2, &raws[at]));
        let made: Vec<(&Shot, &dyn Reconstructor, &Arc<RawFrame>)> = made.collect();
        let made = made.into_par_iter().map(|(shot, method, raw)| develop(shot, method, raw));
        let mut made = made.collect::<Result<Vec<_>, _>>()?.into_iter();
        let all = tasks.iter().zip(kept).map(|((shot, name, _), kept)| {
            let made = if kept.is_some() { None } else { made.next() };
            kept.or_else(|| made.map(|made| self.pictures.keep(((*shot).clone(), name.clone()), made)))
        });
        Ok(all.flatten().collect())
    }
}

/// A frame, and what had to be computed for it.
struct Taken {
    psfs: Option<[Psf; 3]>,
    light: Option<ColourFrame>,
    raw: RawFrame,
}

impl Taken {
    /// Takes a frame of light that is kept, or behind PSFs that are.
    fn new(
        Shot { subject, view, sensor }: &Shot,
        light: Option<Arc<ColourFrame>>,
        psfs: Option<Arc<[Psf; 3]>>,
    ) -> Result<Self, CaptureError> {
        if let Some(light) = light {
            return Ok(Self { psfs: None, light: None, raw: expose(&light, sensor)? });
        }
        let made = if psfs.is_some() { None } else { Some(psfs_of(view)?) };
        let light = psfs.as_deref().or(made.as_ref()).map(|psfs| subject.blurred(psfs));
        let light = light.unwrap_or_else(|| unreachable!("PSFs are kept or made"));
        Ok(Self { psfs: made, raw: expose(&light, sensor)?, light: Some(light) })
    }
}

fn psfs_of(view: &View) -> Result<[Psf; 3], NoPsf> {
    channel_psfs(&view.camera, view.psi, &Approximation::default().psf)
}

fn develop(shot: &Shot, method: &dyn Reconstructor, raw: &RawFrame) -> Result<Developed, LiveError> {
    let frame = method.reconstruct(raw)?.frame;
    Ok(Developed { psnr_db: shot.subject.psnr_db(&frame)?, frame })
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
    use edof_core::{Noise, Reconstruction};
    use edof_optics::Scene;
    use edof_optics::capture::capture;
    use edof_optics::draw::{Builtin, draw};

    fn shot(subject: &Arc<Subject>, camera: &str, seed: u64) -> Shot {
        let view = View { camera: Camera::resolve(camera).unwrap(), psi: 2.0 };
        let sensor = Sensor { noise: Noise::sensor(4.0), seed, ..Sensor::default() };
        Shot { subject: Arc::clone(subject), view, sensor }
    }

    #[test]
    fn a_moved_lens_gives_what_a_capture_gives_to_the_last_bit() {
        let mut live = Live::<u8>::default();
        let picture = draw(Builtin::Leaves, 64, 96, &[0.0], 3).unwrap().sharp();
        let subject = Arc::new(Subject::new(picture.clone()));
        for (name, seed) in [("ring-outer", 1), ("ring-outer", 2), ("clear-mid", 1), ("ring-outer", 1)] {
            let shot = shot(&subject, name, seed);
            let scene = Scene::flat("", picture.clone(), 2.0);
            let whole = capture(&scene, &shot.view.camera, &shot.sensor, &Approximation::default()).unwrap();
            assert_eq!(*live.raw(&shot).unwrap(), whole.raw, "{name} {seed}");
        }
        // Another picture of the same size is another one.
        let black = shot(&Arc::new(Subject::new(ColourFrame::zeros(64, 96))), "ring-outer", 1);
        let black = Shot { sensor: Sensor::default(), ..black };
        assert!(live.raw(&black).unwrap().pixels().iter().all(|word| *word == 0));
    }

    #[test]
    fn only_what_is_not_kept_is_computed_and_each_task_has_its_picture() {
        struct Counted(AtomicU64, f32);
        impl Reconstructor for Counted {
            fn name(&self) -> &'static str {
                "counted"
            }
            fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
                self.0.fetch_add(1, Ordering::Relaxed);
                let mut frame = ColourFrame::zeros(raw.size().0, raw.size().1);
                frame.planes.fill(self.1);
                let (multiplications, counters, iterations) = (None, None, None);
                Ok(Reconstruction { frame, seconds: 0.0, multiplications, counters, iterations })
            }
        }
        let (dark, light) = (Counted(AtomicU64::new(0), 0.25), Counted(AtomicU64::new(0), 0.75));
        let subject = Arc::new(Subject::new(draw(Builtin::Chart, 64, 96, &[0.0], 0).unwrap().sharp()));
        let shots = [1, 2].map(|seed| shot(&subject, "clear-mid", seed));
        let mut live = Live::default();
        let mut levels = |tasks: &[(usize, u8)]| -> Vec<f32> {
            let method = |name: u8| if name == 0 { &dark } else { &light };
            let tasks: Vec<Task<'_, u8>> = tasks
                .iter()
                .map(|(at, name)| (&shots[*at], *name, method(*name) as &dyn Reconstructor))
                .collect();
            let pictures = live.developed(&tasks).unwrap();
            pictures.iter().map(|picture| picture.frame.planes[(0, 0, 0)]).collect()
        };
        assert_eq!(levels(&[(0, 0), (0, 1)]), [0.25, 0.75]);
        assert_eq!(levels(&[(0, 1), (1, 1), (0, 0)]), [0.75, 0.75, 0.25]);
        assert_eq!([&dark, &light].map(|method| method.0.load(Ordering::Relaxed)), [1, 2]);
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
