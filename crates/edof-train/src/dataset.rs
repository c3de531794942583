//! Blurred photographs, and random windows of them with the sharp patches that belong there.
//!
//! Photographs are blurred whole, once for each ψ of a list; windows are cut at random places, flipped and turned (in all the
//! ways that leave the camera's PSFs as they are), mosaiced afterwards, and given light and noise of their own at every draw. A block of each
//! photograph is kept for validation ([`crate::holdout`]). Where asked for, a photograph comes in several looks
//! ([`crate::augment`]). Lens and sensor see light; what the sensor gives and what the patch should be is then encoded in the photographs'
//! tone ([`edof_core::Tone`]), as the network takes and gives it.

mod kept;
mod lens;

use crate::augment::Augmentation;
use crate::encoding::encode;
use crate::holdout::Holdout;
use crate::noise::{Conditions, NOISE_CLASSES, expose};
use edof_core::camera::Camera;
use edof_core::cfa::CfaPhase;
use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::PATCH;
use edof_core::{ColourFrame, Noise, Tone, Window};
use edof_network::float::pass::Examples;
use edof_numerics::random::Random;
use edof_optics::Blur;
use edof_optics::psf::{NoPsf, Psf, Settings, channel_psfs};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// What a dataset is made of, besides photographs and camera.
#[derive(Debug, Clone, PartialEq)]
pub struct DatasetOptions {
    /// Values of ψ that every photograph is blurred for.
    pub psis: Vec<f64>,
    /// How exactly PSFs are computed.
    pub settings: Settings,
    /// Side of the windows that are cut.
    pub window: Window,
    /// What the photographs' values are taken for, and what windows hold.
    pub tone: Tone,
    /// Looks of each photograph.
    pub augmentation: Augmentation,
    /// Foci in ψ of the exposures after the first, which has the camera's focus.
    pub further_foci: Vec<f64>,
}

impl DatasetOptions {
    /// The paper's: photographs as they are, their values taken for light.
    #[must_use]
    pub fn plain(psis: &[f64], window: Window) -> Self {
        Self {
            psis: psis.to_vec(),
            settings: Settings::default(),
            window,
            tone: Tone::Linear,
            augmentation: Augmentation::NONE,
            further_foci: vec![],
        }
    }
}

/// Photographs of one size or several, sharp and blurred; interleaved RGB words of 16 bits.
#[derive(Debug)]
pub struct Dataset {
    /// Photograph by photograph, look by look.
    pictures: Vec<Picture>,
    options: DatasetOptions,
    photos: usize,
    reach: usize,
    /// Flips and turns that leave every PSF unchanged.
    turns: Vec<usize>,
}

/// One look of a photograph in one tone.
#[derive(Debug)]
struct Picture {
    width: usize,
    holdout: Holdout,
    sharp: Vec<u16>,
    /// Exposure by exposure, ψ by ψ.
    blurred: Vec<Vec<u16>>,
}

/// Photographs that nothing can be learned from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum DatasetError {
    /// No photograph at all.
    #[error("training photos: none given, at least one is needed")]
    NoPhotos,
    /// One is too small.
    #[error(
        "training photo {index}: {width}x{height}, both sides should be at least {min} pixels: a quarter of each is for \
         validation, and training keeps {reach} pixels away from it, as far as the blur reaches"
    )]
    SmallPhoto { index: usize, width: usize, height: usize, min: usize, reach: usize },
    /// No defocus at all.
    #[error("psi: no value given, at least one is needed")]
    NoPsi,
    /// A depth that the camera has no PSFs for.
    #[error(transparent)]
    Psf(#[from] NoPsf),
    /// A number out of range.
    #[error("{field} {value}: must be {expected}")]
    Value { field: &'static str, value: f32, expected: &'static str },
}

/// A batch of windows: what goes in, what should come out, and where each came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// Windows × inputs ([`Dataset::inputs`]), in the dataset's tone.
    pub inputs: Vec<f32>,
    /// Windows × 192, in the dataset's tone.
    pub targets: Vec<f32>,
    /// Cell (photograph, ψ, noise class) of each window; see [`Dataset::cells`].
    pub cells: Vec<u32>,
    /// Noise class of each window; see [`Conditions::class`].
    pub classes: Vec<u8>,
}

impl Batch {
    /// Room for `windows` windows of `inputs` values each.
    #[must_use]
    pub fn new(inputs: usize, windows: usize) -> Self {
        Self {
            inputs: vec![0.0; windows * inputs],
            targets: vec![0.0; windows * RGB_OUTPUTS],
            cells: vec![0; windows],
            classes: vec![0; windows],
        }
    }

    /// How many windows there are.
    #[must_use]
    pub const fn windows(&self) -> usize {
        self.cells.len()
    }

    /// The windows, with what each weighs.
    #[must_use]
    pub fn examples<'a>(&'a self, importance: &'a [f32]) -> Examples<'a> {
        Examples { inputs: &self.inputs, targets: &self.targets, importance }
    }
}

/// Where windows of one kind come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Position of the photograph in the list, from 0.
    pub photo: usize,
    /// Position of ψ among the dataset's.
    pub psi: usize,
}

impl Dataset {
    /// Blurs every look of every photograph (sRGB values of 0…1, sides even) for every ψ. `tell` hears how many photographs are
    /// done and may end the work; what is then returned is `None`.
    ///
    /// # Errors
    /// [`DatasetError`].
    pub fn new(
        photos: &[ColourFrame],
        camera: &Camera,
        options: DatasetOptions,
        mut tell: impl FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<Option<Self>, DatasetError> {
        check(photos, &options)?;
        let cameras = camera.focused_at(&options.further_foci);
        let views: Vec<(&Camera, f64)> =
            cameras.iter().flat_map(|camera| options.psis.iter().map(move |psi| (camera, *psi))).collect();
        let psfs: Vec<[Psf; 3]> = views
            .par_iter()
            .map(|(camera, psi)| channel_psfs(camera, *psi, &options.settings))
            .collect::<Result<_, _>>()?;
        let reach = psfs.iter().flatten().map(|psf| psf.side() / 2).max().unwrap_or(0);
        let mut pictures = Vec::new();
        for (index, photo) in photos.iter().enumerate() {
            if tell(index, photos.len()).is_break() {
                return Ok(None);
            }
            let (height, width) = photo.size();
            let holdout = Holdout::new(height, width, index, reach);
            let light = options.tone.decoded(photo);
            let looks: Vec<Picture> = (0..options.augmentation.variants)
                .into_par_iter()
                .map(|variant| {
                    let sharp = options.augmentation.look(index, variant).of(&light);
                    let (height, width) = sharp.size();
                    let holdout = if variant == 0 { holdout } else { holdout.reduced(height, width) };
                    Picture::new(&sharp, holdout, &psfs)
                })
                .collect();
            if looks.iter().any(|picture| !picture.holdout.fits(options.window.side())) {
                let whole = Holdout::min_side(options.window.side(), reach);
                let min = (whole as f32 / options.augmentation.scale).ceil() as usize;
                return Err(DatasetError::SmallPhoto { index, width, height, min, reach });
            }
            pictures.extend(looks);
        }
        let _ = tell(photos.len(), photos.len());
        Ok(Some(Self { pictures, photos: photos.len(), options, reach, turns: turns(&psfs) }))
    }

    /// ψ of each blur.
    #[must_use]
    pub fn psis(&self) -> &[f64] {
        &self.options.psis
    }

    /// How many photographs there are.
    #[must_use]
    pub const fn photos(&self) -> usize {
        self.photos
    }

    /// What the photographs' values are taken for, and what windows hold.
    #[must_use]
    pub const fn tone(&self) -> Tone {
        self.options.tone
    }

    /// Side of the windows that are cut.
    #[must_use]
    pub const fn window(&self) -> Window {
        self.options.window
    }

    /// Raw frames that a window is cut from.
    #[must_use]
    pub const fn exposures(&self) -> usize {
        1 + self.options.further_foci.len()
    }

    /// Values of a window: its pixels in every exposure.
    #[must_use]
    pub const fn inputs(&self) -> usize {
        self.exposures() * self.window().pixels()
    }

    /// Largest kernel radius of all PSFs in pixels: what training windows keep away from validation blocks.
    #[must_use]
    pub const fn reach(&self) -> usize {
        self.reach
    }

    /// Whether all PSFs are their own transposes, so that the picture of a transposed scene is the transposed picture.
    #[must_use]
    pub fn is_transposable(&self) -> bool {
        self.turns.contains(&TRANSPOSED)
    }

    /// Number of cells: photographs × ψ × noise classes.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.photos * self.psis().len() * NOISE_CLASSES
    }

    /// Fills a batch with random training windows.
    pub fn draw(&self, random: &mut Random, conditions: &Conditions, batch: &mut Batch) {
        for index in 0..batch.windows() {
            let place = Place { photo: random.below(self.photos), psi: random.below(self.psis().len()) };
            let picture = self.picture(place, random.below(self.options.augmentation.variants));
            let (class, noise) = conditions.draw(random, self.tone());
            let exposure = random.between(conditions.exposure);
            let corner = picture.holdout.training(random, self.window().side());
            batch.cells[index] = self.cell(place, class) as u32;
            batch.classes[index] = class as u8;
            match conditions.draw_colour(random, self.tone()) {
                Some(colour) => self.fill(random, colour, noise, batch, index),
                None => self.cut(random, picture, place, corner, exposure, noise, batch, index),
            }
        }
    }

    /// A window of a single colour.
    fn fill(&self, random: &mut Random, colour: [f32; 3], noise: Noise, batch: &mut Batch, index: usize) {
        let (side, inputs) = (self.window().side(), self.inputs());
        let input = &mut batch.inputs[index * inputs..][..inputs];
        input.iter_mut().enumerate().for_each(|(i, v)| *v = colour[RGGB[i / side % 2][i % side % 2]]);
        expose(noise, random, input);
        let target = &mut batch.targets[index * RGB_OUTPUTS..][..RGB_OUTPUTS];
        target.chunks_exact_mut(PATCH * PATCH).zip(colour).for_each(|(plane, v)| plane.fill(v));
        self.encode(batch, index);
    }

    /// Fills a batch with random validation windows of one photograph, as it is, at one ψ, with one noise.
    pub fn draw_validation(&self, random: &mut Random, place: Place, noise: Noise, batch: &mut Batch) {
        let picture = self.picture(place, 0);
        for index in 0..batch.windows() {
            let corner = picture.holdout.validation(random, self.window().side());
            self.cut(random, picture, place, corner, 1.0, noise, batch, index);
        }
    }

    fn picture(&self, place: Place, variant: usize) -> &Picture {
        &self.pictures[place.photo * self.options.augmentation.variants + variant]
    }

    fn cell(&self, place: Place, class: usize) -> usize {
        (place.photo * self.psis().len() + place.psi) * NOISE_CLASSES + class
    }

    #[expect(clippy::too_many_arguments, reason = "one draw, each of its coordinates named at the call")]
    fn cut(
        &self,
        random: &mut Random,
        picture: &Picture,
        place: Place,
        (row, column): (usize, usize),
        exposure: f32,
        noise: Noise,
        batch: &mut Batch,
        index: usize,
    ) {
        let window = self.window();
        let (side, inputs) = (window.side(), self.inputs());
        let turn = Turn::new(self.turns[random.below(self.turns.len())], picture.width, side);
        let base = (row * picture.width + column) * 3;
        let unit = exposure / f32::from(u16::MAX);
        let input = &mut batch.inputs[index * inputs..][..inputs];
        let blurs = picture.blurred.iter().skip(place.psi).step_by(self.psis().len());
        for (blurred, pixels) in blurs.zip(input.chunks_exact_mut(window.pixels())) {
            turn.read(&blurred[base..], 0, RGGB, unit, side, pixels);
        }
        expose(noise, random, input);
        let target = &mut batch.targets[index * RGB_OUTPUTS..][..RGB_OUTPUTS];
        for (plane, values) in target.chunks_exact_mut(PATCH * PATCH).enumerate() {
            turn.read(&picture.sharp[base..], window.margin(), [[plane; 2]; 2], unit, PATCH, values);
        }
        // What no sensor can tell from white, no network is asked for.
        target.iter_mut().for_each(|v| *v = v.min(1.0));
        self.encode(batch, index);
    }

    /// Light of a window becomes values of the tone.
    fn encode(&self, batch: &mut Batch, index: usize) {
        if self.tone() == Tone::Srgb {
            let inputs = self.inputs();
            let input = &mut batch.inputs[index * inputs..][..inputs];
            let target = &mut batch.targets[index * RGB_OUTPUTS..][..RGB_OUTPUTS];
            input.iter_mut().chain(target).for_each(|v| *v = encode(*v));
        }
    }
}

impl Picture {
    fn new(sharp: &ColourFrame, holdout: Holdout, psfs: &[[Psf; 3]]) -> Self {
        let (height, width) = sharp.size();
        let plan = Blur::new(height, width);
        let spectra: Vec<_> = sharp.planes.outer_iter().map(|plane| plan.spectrum(plane)).collect();
        let blurred = psfs
            .par_iter()
            .map(|psfs| {
                let planes: Vec<_> =
                    (0..3).map(|c| plan.apply(&spectra[c], &plan.transfer(&psfs[c]))).collect();
                interleave(height, width, |c, row, column| planes[c][(row, column)])
            })
            .collect();
        let sharp = interleave(height, width, |c, row, column| sharp.planes[(c, row, column)]);
        Self { width, holdout, sharp, blurred }
    }
}

/// Colour plane of each site of a Bayer cell.
const RGGB: [[usize; 2]; 2] = [[site(0, 0), site(0, 1)], [site(1, 0), site(1, 1)]];

const fn site(row: usize, column: usize) -> usize {
    CfaPhase::Rggb.channel(row, column).plane()
}

/// The turn that swaps rows and columns.
const TRANSPOSED: usize = 4;

/// Those of the eight flips and turns that leave all PSFs as they are; the first changes nothing.
fn turns(psfs: &[[Psf; 3]]) -> Vec<usize> {
    let all = psfs.iter().flatten().map(Psf::symmetries);
    let shared = all.fold([true; 3], |shared, psf| [0, 1, 2].map(|i| shared[i] && psf[i]));
    (0..8).filter(|turn| (0..3).all(|flip| turn >> flip & 1 == 0 || shared[flip])).collect()
}

/// One of the eight flips and turns of a block, as steps between the words of an interleaved picture.
#[derive(Debug, Clone, Copy)]
struct Turn {
    /// The word of the turned block's first pixel.
    first: isize,
    /// Words from one of its rows to the next.
    row: isize,
    /// Words from one of its columns to the next.
    column: isize,
}

impl Turn {
    const fn new(symmetry: usize, width: usize, side: usize) -> Self {
        let (down, across, last) = (3 * width as isize, 3, side as isize - 1);
        let mut turn = Self { first: 0, row: down, column: across };
        if symmetry & 1 != 0 {
            turn = Self { first: turn.first + last * down, row: -turn.row, ..turn };
        }
        if symmetry & 2 != 0 {
            turn = Self { first: turn.first + last * across, column: -turn.column, ..turn };
        }
        if symmetry & TRANSPOSED != 0 {
            turn = Self { row: turn.column, column: turn.row, ..turn };
        }
        turn
    }

    /// Fills `values` with a square of `side` pixels, `margin` in from the block's corner, of the plane that its site in the cell has.
    fn read(
        self,
        words: &[u16],
        margin: usize,
        planes: [[usize; 2]; 2],
        unit: f32,
        side: usize,
        values: &mut [f32],
    ) {
        let first = self.first + margin as isize * (self.row + self.column);
        for (r, line) in values.chunks_exact_mut(side).enumerate() {
            let start = first + r as isize * self.row;
            let planes = planes[r % 2];
            for (c, value) in line.iter_mut().enumerate() {
                let word = words[(start + c as isize * self.column) as usize + planes[c % 2]];
                *value = f32::from(word) * unit;
            }
        }
    }
}

fn check(photos: &[ColourFrame], options: &DatasetOptions) -> Result<(), DatasetError> {
    if photos.is_empty() {
        return Err(DatasetError::NoPhotos);
    }
    if options.psis.is_empty() {
        return Err(DatasetError::NoPsi);
    }
    let Augmentation { variants, saturation, hue, scale } = options.augmentation;
    let value = |field, value, expected| Err(DatasetError::Value { field, value, expected });
    if variants == 0 {
        return value("variants", 0.0, "1 or more");
    }
    let [least, most] = saturation;
    if !(0.0..=10.0).contains(&least) {
        return value("saturation", least, "0 to 10");
    }
    if !(least..=10.0).contains(&most) {
        return value("saturation", most, "at least its lower end, and 0 to 10");
    }
    if !(0.0..=180.0).contains(&hue) {
        return value("hue", hue, "0 to 180 degrees");
    }
    if !(scale > 0.0 && scale <= 1.0) {
        return value("scale", scale, "more than 0, 1 at most");
    }
    Ok(())
}

fn interleave(height: usize, width: usize, value: impl Fn(usize, usize, usize) -> f32) -> Vec<u16> {
    let mut words = Vec::with_capacity(height * width * 3);
    for row in 0..height {
        for column in 0..width {
            words.extend((0..3).map(|c| (value(c, row, column).clamp(0.0, 1.0) * 65535.0 + 0.5) as u16));
        }
    }
    words
}

#[cfg(test)]
mod tests;
