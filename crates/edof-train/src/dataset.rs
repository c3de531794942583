//! Blurred photographs, and random windows of them with the sharp patches that belong there.
//!
//! Photographs are blurred whole, once for each ψ of a list; windows are cut at random places, flipped and turned (in all the
//! ways that leave the camera's PSFs as they are), mosaiced afterwards, and given light and noise of their own at every draw. A block of each
//! photograph is kept for validation ([`crate::holdout`]). Where asked for, a photograph comes in several looks
//! ([`crate::augment`]) and both as light and as codes taken for light ([`edof_spec::Tone`]).

use crate::augment::Augmentation;
use crate::holdout::Holdout;
use crate::noise::{Conditions, NOISE_CLASSES, expose};
use crate::pass::Examples;
use crate::random::Random;
use edof_optics::blur::Blur;
use edof_optics::psf::{NoPsf, Psf, Settings, channel_psfs};
use edof_spec::cfa::CfaPhase;
use edof_spec::colour::RGB_OUTPUTS;
use edof_spec::geometry::PATCH;
use edof_spec::{Camera, ColourFrame, Noise, Tone, Window};
use rayon::prelude::*;

/// What a dataset is made of, besides photographs and camera.
#[derive(Debug, Clone, PartialEq)]
pub struct DatasetOptions {
    /// Values of ψ that every photograph is blurred for.
    pub psis: Vec<f64>,
    /// How exactly PSFs are computed.
    pub settings: Settings,
    /// Side of the windows that are cut.
    pub window: Window,
    /// What the photographs' values are taken for; of two, half of the windows each.
    pub tones: Vec<Tone>,
    /// Looks of each photograph.
    pub augmentation: Augmentation,
}

impl DatasetOptions {
    /// The paper's: photographs as they are, their values taken for light.
    #[must_use]
    pub fn plain(psis: &[f64], window: Window) -> Self {
        Self {
            psis: psis.to_vec(),
            settings: Settings::default(),
            window,
            tones: vec![Tone::Linear],
            augmentation: Augmentation::NONE,
        }
    }
}

/// Photographs of one size or several, sharp and blurred; interleaved RGB words of 16 bits.
#[derive(Debug)]
pub struct Dataset {
    /// Photograph by photograph, tone by tone, look by look.
    pictures: Vec<Picture>,
    options: DatasetOptions,
    photos: usize,
    reach: usize,
    /// Flips and turns that no PSF can be told from.
    turns: Vec<usize>,
}

/// One look of a photograph in one tone.
#[derive(Debug)]
struct Picture {
    width: usize,
    holdout: Holdout,
    sharp: Vec<u16>,
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
        "training photo {index}: {width}x{height}, both sides should be at least {least} pixels: a quarter of each is for \
         validation, and training keeps {reach} pixels away from it, as far as the blur reaches"
    )]
    SmallPhoto { index: usize, width: usize, height: usize, least: usize, reach: usize },
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
    /// Windows × pixels.
    pub inputs: Vec<f32>,
    /// Windows × 192, light.
    pub targets: Vec<f32>,
    /// The tone in which each window's error is measured.
    pub tones: Vec<Tone>,
    /// Cell (photograph, tone, ψ, noise class) of each window; see [`Dataset::cells`].
    pub cells: Vec<u32>,
    /// Noise class of each window; see [`Conditions::class`].
    pub classes: Vec<u8>,
}

impl Batch {
    /// Room for `windows` windows.
    #[must_use]
    pub fn new(window: Window, windows: usize) -> Self {
        Self {
            inputs: vec![0.0; windows * window.pixels()],
            targets: vec![0.0; windows * RGB_OUTPUTS],
            tones: vec![Tone::Linear; windows],
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
        Examples { inputs: &self.inputs, targets: &self.targets, tones: &self.tones, importance }
    }
}

/// Where windows of one kind come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Position of the photograph in the list, from 0.
    pub photo: usize,
    /// Position of its tone among the dataset's.
    pub tone: usize,
    /// Position of ψ among the dataset's.
    pub psi: usize,
}

impl Dataset {
    /// Blurs every look of every photograph (sRGB values of 0…1, sides even) for every ψ. `tell` hears how many photographs are
    /// done and stops the work by returning false; what is then returned is `None`.
    ///
    /// # Errors
    /// [`DatasetError`].
    pub fn new(
        photos: &[ColourFrame],
        camera: &Camera,
        options: DatasetOptions,
        mut tell: impl FnMut(usize, usize) -> bool,
    ) -> Result<Option<Self>, DatasetError> {
        check(photos, &options)?;
        let psfs: Vec<[Psf; 3]> = options
            .psis
            .par_iter()
            .map(|&psi| channel_psfs(camera, psi, &options.settings))
            .collect::<Result<_, _>>()?;
        let reach = psfs.iter().flatten().map(|psf| psf.side() / 2).max().unwrap_or(0);
        let mut pictures = Vec::new();
        for (index, photo) in photos.iter().enumerate() {
            if !tell(index, photos.len()) {
                return Ok(None);
            }
            let (height, width) = photo.size();
            let holdout = Holdout::new(height, width, index, reach);
            let looks: Vec<Picture> = (0..options.tones.len() * options.augmentation.variants)
                .into_par_iter()
                .map(|i| {
                    let (tone, variant) =
                        (i / options.augmentation.variants, i % options.augmentation.variants);
                    let light = options.tones[tone].decoded(photo);
                    let sharp = options.augmentation.look(index, variant).of(&light);
                    let (height, width) = sharp.size();
                    let holdout = if variant == 0 { holdout } else { holdout.reduced(height, width) };
                    Picture::new(&sharp, holdout, &psfs)
                })
                .collect();
            if looks.iter().any(|picture| !picture.holdout.fits(options.window.side())) {
                let whole = Holdout::least(options.window.side(), reach);
                let least = (whole as f32 / options.augmentation.scale).ceil() as usize;
                return Err(DatasetError::SmallPhoto { index, width, height, least, reach });
            }
            pictures.extend(looks);
        }
        tell(photos.len(), photos.len());
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

    /// What the photographs' values are taken for.
    #[must_use]
    pub fn tones(&self) -> &[Tone] {
        &self.options.tones
    }

    /// Side of the windows that are cut.
    #[must_use]
    pub const fn window(&self) -> Window {
        self.options.window
    }

    /// Largest kernel radius of all PSFs in pixels: what training windows keep away from validation blocks.
    #[must_use]
    pub const fn reach(&self) -> usize {
        self.reach
    }

    /// Number of cells: photographs × tones × ψ × noise classes.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.photos * self.tones().len() * self.psis().len() * NOISE_CLASSES
    }

    /// Fills a batch with random training windows.
    pub fn draw(&self, random: &mut Random, conditions: &Conditions, batch: &mut Batch) {
        for index in 0..batch.windows() {
            let place = Place {
                photo: random.below(self.photos),
                tone: random.below(self.tones().len()),
                psi: random.below(self.psis().len()),
            };
            let picture = self.picture(place, random.below(self.options.augmentation.variants));
            let (class, noise) = conditions.draw(random, self.tones()[place.tone]);
            let exposure = random.between(conditions.exposure);
            let corner = picture.holdout.training(random, self.window().side());
            batch.cells[index] = self.cell(place, class) as u32;
            batch.classes[index] = class as u8;
            self.cut(random, picture, place, corner, exposure, noise, batch, index);
        }
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
        let tones = self.tones().len();
        &self.pictures[(place.photo * tones + place.tone) * self.options.augmentation.variants + variant]
    }

    fn cell(&self, place: Place, class: usize) -> usize {
        ((place.photo * self.tones().len() + place.tone) * self.psis().len() + place.psi) * NOISE_CLASSES
            + class
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
        let (side, pixels) = (window.side(), window.pixels());
        batch.tones[index] = self.tones()[place.tone];
        let turn = Turn::new(self.turns[random.below(self.turns.len())], picture.width, side);
        let base = (row * picture.width + column) * 3;
        let unit = exposure / f32::from(u16::MAX);
        let input = &mut batch.inputs[index * pixels..][..pixels];
        turn.read(&picture.blurred[place.psi][base..], 0, RGGB, unit, side, input);
        expose(noise, random, input);
        let target = &mut batch.targets[index * RGB_OUTPUTS..][..RGB_OUTPUTS];
        for (plane, values) in target.chunks_exact_mut(PATCH * PATCH).enumerate() {
            turn.read(&picture.sharp[base..], window.margin(), [[plane; 2]; 2], unit, PATCH, values);
        }
        // What no sensor can tell from white, no network is asked for.
        target.iter_mut().for_each(|v| *v = v.min(1.0));
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
        if symmetry & 4 != 0 {
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
    if !(saturation[0] >= 0.0 && saturation[0] <= saturation[1] && saturation[1] <= 10.0) {
        return value("saturation", saturation[1], "at least its lower end, and 0 to 10");
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
mod tests {
    use super::*;
    use ndarray::Array3;

    fn marked() -> ColourFrame {
        let planes = Array3::from_shape_fn((3, 256, 256), |(c, row, column)| {
            [row as f32 / 255.0, column as f32 / 255.0, 0.5][c]
        });
        ColourFrame { planes }
    }

    /// A photograph whose planes tell where each pixel lies, behind a lens that does not blur at all (in focus, wide open).
    fn marked_dataset(window: usize, tones: &[Tone], variants: usize) -> Dataset {
        let mut camera = Camera::resolve("clear").unwrap();
        camera.aperture_radius_mm = 8.0;
        let plain = DatasetOptions::plain(&[0.0], Window::new(window).unwrap());
        let augmentation = Augmentation { variants, saturation: [1.0; 2], hue: 0.0, scale: 0.7 };
        let options = DatasetOptions { tones: tones.to_vec(), augmentation, ..plain };
        Dataset::new(&[marked()], &camera, options, |_, _| true).unwrap().unwrap()
    }

    fn silent() -> Conditions {
        Conditions { noiseless: 1, ..Conditions::plain(0.015) }
    }

    fn place_of(target: &[f32]) -> (f32, f32) {
        let mean = |plane: usize| target[plane * 64..][..64].iter().sum::<f32>() / 64.0 * 255.0;
        (mean(0), mean(1))
    }

    #[test]
    fn windows_see_the_mosaic_around_their_patch() {
        for variants in [1, 3] {
            let dataset = marked_dataset(12, &[Tone::Linear], variants);
            let mut batch = Batch::new(dataset.window(), 200);
            dataset.draw(&mut Random::new(1, 2, 3), &silent(), &mut batch);
            for (input, target) in batch.inputs.chunks(144).zip(batch.targets.chunks(192)) {
                // Red and green are linear in place, so the mean of a centred window is that of its patch.
                let (row, column) = place_of(target);
                let sites =
                    |r: usize, c: usize| (0..36).map(move |i| input[(i / 6 * 2 + r) * 12 + i % 6 * 2 + c]);
                let mean = |r, c| sites(r, c).sum::<f32>() / 36.0 * 255.0;
                assert!((mean(0, 0) - row).abs() < 2.0, "red sites hold rows");
                assert!((0.5 * (mean(0, 1) + mean(1, 0)) - column).abs() < 2.0, "green sites hold columns");
                assert!((mean(1, 1) / 255.0 - 0.5).abs() < 0.01, "blue sites hold a half");
            }
        }
    }

    #[test]
    fn targets_are_light_and_validation_windows_come_from_the_corner_block() {
        let dataset = marked_dataset(8, &Tone::ALL, 1);
        let mut batch = Batch::new(dataset.window(), 300);
        for (index, tone) in Tone::ALL.into_iter().enumerate() {
            let place = Place { photo: 0, tone: index, psi: 0 };
            dataset.draw_validation(&mut Random::new(1, 0, 0), place, Noise::None, &mut batch);
            assert!(batch.tones.iter().all(|t| *t == tone));
            // The first photograph's block is its first quarter of rows and columns.
            let most = tone.decode(63.0 / 255.0) + 1e-4;
            assert!(batch.targets.chunks(64).take(2).all(|plane| plane.iter().all(|v| *v <= most)));
            assert!((batch.targets[128] - tone.decode(0.5)).abs() < 1e-4);
        }
        let mut batch = Batch::new(dataset.window(), 400);
        dataset.draw(&mut Random::new(1, 0, 0), &silent(), &mut batch);
        let linear = batch.tones.iter().filter(|t| **t == Tone::Linear).count();
        assert!((150..250).contains(&linear), "{linear} of 400");
    }

    #[test]
    fn exposure_lifts_input_and_target_alike_and_clips_at_white() {
        let dataset = marked_dataset(8, &[Tone::Linear], 1);
        let drawn = |factor| {
            let mut batch = Batch::new(dataset.window(), 50);
            let conditions = Conditions { exposure: [factor; 2], ..silent() };
            dataset.draw(&mut Random::new(4, 0, 0), &conditions, &mut batch);
            batch
        };
        let (once, twice) = (drawn(1.0), drawn(2.0));
        for (one, two) in [(&once.inputs, &twice.inputs), (&once.targets, &twice.targets)] {
            assert!(one.iter().zip(two).all(|(a, b)| ((2.0 * a).min(1.0) - b).abs() < 1e-6));
        }
    }

    #[test]
    fn the_same_seed_draws_the_same_batch_and_each_window_its_own_noise() {
        let dataset = marked_dataset(8, &Tone::ALL, 2);
        let drawn = |seed| {
            let mut batch = Batch::new(dataset.window(), 16);
            dataset.draw(&mut Random::new(seed, 7, 0), &Conditions::plain(0.01), &mut batch);
            batch
        };
        assert_eq!(drawn(1), drawn(1));
        assert_ne!(drawn(1), drawn(2));
        // The same place again and again: what differs is noise alone, and one window's tells nothing of the next one's.
        let mut batch = Batch::new(dataset.window(), 20_000);
        let noise = Noise::gaussian(0.01);
        dataset.draw_validation(
            &mut Random::new(1, 0, 0),
            Place { photo: 0, tone: 0, psi: 0 },
            noise,
            &mut batch,
        );
        let blue: Vec<f32> = batch.inputs.chunks(64).map(|window| (window[9] - 0.5) / 0.01).collect();
        let mean = |values: &mut dyn Iterator<Item = f32>| values.sum::<f32>() / 20_000.0;
        assert!(mean(&mut blue.iter().copied()).abs() < 0.03);
        assert!((mean(&mut blue.iter().map(|v| v * v)) - 1.0).abs() < 0.04);
        assert!(mean(&mut blue.windows(2).map(|w| w[0] * w[1])).abs() < 0.03);
    }

    #[test]
    fn windows_are_turned_only_as_the_blur_allows() {
        let camera = Camera::resolve("ring-outer").unwrap();
        let lens = channel_psfs(&camera, 3.0, &Settings::default()).unwrap();
        assert_eq!(turns(std::slice::from_ref(&lens)), [0, 1, 2, 3, 4, 5, 6, 7]);
        let leaning = |kernel: [[f32; 3]; 3]| {
            let kernel = ndarray::Array2::from_shape_fn((3, 3), |(r, c)| kernel[r][c]);
            [lens[0].clone(), Psf::new(kernel).unwrap(), lens[2].clone()]
        };
        let up = leaning([[0.0, 0.3, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.0]]);
        assert_eq!(turns(&[lens.clone(), up]), [0, 2]);
        let flat = leaning([[0.0, 0.0, 0.0], [0.2, 0.6, 0.2], [0.0, 0.0, 0.0]]);
        assert_eq!(turns(&[flat]), [0, 1, 2, 3]);
        let slanted = leaning([[0.3, 0.0, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.0]]);
        assert_eq!(turns(&[slanted]), [0, 4]);
    }

    #[test]
    fn no_photos_and_small_photos_are_refused() {
        let camera = Camera::resolve("clear").unwrap();
        let make = |photos: &[ColourFrame], variants: usize| {
            let plain = DatasetOptions::plain(&[0.0], Window::new(8).unwrap());
            let augmentation = Augmentation { variants, ..Augmentation::NONE };
            let options = DatasetOptions { augmentation, ..plain };
            Dataset::new(photos, &camera, options, |_, _| true).unwrap_err().to_string()
        };
        assert_eq!(make(&[], 1), "training photos: none given, at least one is needed");
        assert!(
            make(&[ColourFrame::zeros(30, 30)], 1)
                .starts_with("training photo 0: 30x30, both sides should be at least ")
        );
        assert_eq!(make(&[marked()], 0), "variants 0: must be 1 or more");
    }
}
