//! Blurred training photos, and random windows of them with the sharp patches that belong there.
//!
//! Photos are blurred whole, once for each ψ of a list; windows are cut at random places, flipped and turned (the PSF has
//! all those symmetries), mosaiced afterwards, and given fresh noise at every draw. Tiles of each photo, about one in twelve,
//! are kept for validation: no training window touches them.

use edof_optics::blur::Blur;
use edof_optics::psf::{Settings, channel_psfs};
use edof_spec::cfa::CfaPhase;
use edof_spec::colour::RGB_OUTPUTS;
use edof_spec::geometry::{PATCH, PATCH_PIXELS};
use edof_spec::{Camera, ColourFrame, Window};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Side of a validation tile in pixels.
const TILE: usize = 64;
/// One tile in so many is kept for validation.
const TILES_PER_VALIDATION: usize = 12;
/// Noise levels are told apart in so many classes; class 0 is no noise at all.
pub const NOISE_CLASSES: usize = 5;
/// Numbers in the pool that noise is taken from.
const NORMALS: usize = 1 << 18;

/// Photos of one size or several, sharp and blurred; interleaved RGB words of 16 bits.
#[derive(Debug)]
pub struct Bank {
    photos: Vec<Photo>,
    psis: Vec<f64>,
    window: Window,
    sharp_offsets: Vec<Vec<u32>>,
    raw_offsets: Vec<[Vec<u32>; 8]>,
    normals: Vec<f32>,
}

#[derive(Debug)]
struct Photo {
    width: usize,
    height: usize,
    index: usize,
    sharp: Vec<u16>,
    blurred: Vec<Vec<u16>>,
}

/// Photos that nothing can be learned from.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PatchError {
    /// No photo at all.
    #[error("training photos: none given, at least one is needed")]
    NoPhotos,
    /// One is too small.
    #[error("training photo {index}: {width}x{height}, both sides must be at least {least} pixels")]
    SmallPhoto { index: usize, width: usize, height: usize, least: usize },
    /// No defocus at all.
    #[error("psi: no value given, at least one is needed")]
    NoPsi,
}

/// A batch of windows: what goes in, what should come out, and where each came from.
#[derive(Debug)]
pub struct Batch {
    /// Windows × pixels.
    pub inputs: Vec<f32>,
    /// Windows × 192.
    pub targets: Vec<f32>,
    /// Cell (photo, ψ, noise class) of each window; see [`Bank::cells`].
    pub cells: Vec<u32>,
}

impl Batch {
    /// Room for `windows` windows.
    #[must_use]
    pub fn new(window: Window, windows: usize) -> Self {
        Self {
            inputs: vec![0.0; windows * window.pixels()],
            targets: vec![0.0; windows * RGB_OUTPUTS],
            cells: vec![0; windows],
        }
    }
}

/// Which part of the photos a window is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Everything that touches no validation tile.
    Training,
    /// The validation tiles.
    Validation,
}

impl Bank {
    /// Blurs every photo for every ψ. `tell` hears how many of all blurs are done and stops the work by returning false; what
    /// is then returned is `None`.
    ///
    /// # Errors
    /// [`PatchError`].
    pub fn new(
        photos: &[ColourFrame],
        camera: &Camera,
        psis: &[f64],
        settings: &Settings,
        window: Window,
        mut tell: impl FnMut(usize, usize) -> bool,
    ) -> Result<Option<Self>, PatchError> {
        check(photos, psis)?;
        let transfers: Vec<_> = psis.par_iter().map(|&psi| channel_psfs(camera, psi, settings)).collect();
        let mut banked = Vec::with_capacity(photos.len());
        for (index, frame) in photos.iter().enumerate() {
            if !tell(index, photos.len()) {
                return Ok(None);
            }
            let (height, width) = frame.size();
            let blur = Blur::new(height, width);
            let spectra: Vec<_> = frame.planes.outer_iter().map(|plane| blur.spectrum(plane)).collect();
            let blurred = transfers
                .par_iter()
                .map(|psfs| {
                    let planes: Vec<_> =
                        (0..3).map(|c| blur.apply(&spectra[c], &blur.transfer(&psfs[c]))).collect();
                    interleave(height, width, |c, row, column| planes[c][(row, column)])
                })
                .collect();
            let sharp = interleave(height, width, |c, row, column| frame.planes[(c, row, column)]);
            banked.push(Photo { width, height, index, sharp, blurred });
        }
        tell(photos.len(), photos.len());
        let widths: Vec<usize> = banked.iter().map(|p| p.width).collect();
        Ok(Some(Self {
            photos: banked,
            psis: psis.to_vec(),
            window,
            sharp_offsets: widths
                .iter()
                .map(|&w| sharp_offsets(w, window))
                .flat_map(|t| t.into_iter())
                .collect(),
            raw_offsets: widths.iter().map(|&w| raw_offsets(w, window)).collect(),
            normals: normals(),
        }))
    }

    /// ψ of each blur.
    #[must_use]
    pub fn psis(&self) -> &[f64] {
        &self.psis
    }

    /// How many photos there are.
    #[must_use]
    pub const fn photos(&self) -> usize {
        self.photos.len()
    }

    /// Side of the windows that are cut.
    #[must_use]
    pub const fn window(&self) -> Window {
        self.window
    }

    /// Number of cells: photos × ψ × noise classes.
    #[must_use]
    pub const fn cells(&self) -> usize {
        self.photos.len() * self.psis.len() * NOISE_CLASSES
    }

    /// Fills a batch with random training windows: one in `noiseless` without noise, the others with σ of
    /// 0…`noise`, uniformly.
    pub fn draw(&self, random: &mut Random, noise: f32, noiseless: usize, batch: &mut Batch) {
        let pixels = self.window.pixels();
        let rows = batch.inputs.chunks_exact_mut(pixels).zip(batch.targets.chunks_exact_mut(RGB_OUTPUTS));
        for ((input, target), cell) in rows.zip(&mut batch.cells) {
            let photo = random.below(self.photos.len());
            let psi = random.below(self.psis.len());
            let (class, sigma) = if noise == 0.0 || random.below(noiseless) == 0 {
                (0, 0.0)
            } else {
                let u = random.unit();
                (1 + (u * (NOISE_CLASSES - 1) as f32) as usize, u * noise)
            };
            *cell = self.cell(photo, psi, class) as u32;
            self.cut(random, photo, psi, sigma, Part::Training, input, target);
        }
    }

    /// Fills a batch with random validation windows of one photo, ψ (by its index) and σ.
    pub fn draw_validation(
        &self,
        random: &mut Random,
        photo: usize,
        psi: usize,
        sigma: f32,
        batch: &mut Batch,
    ) {
        let rows = batch
            .inputs
            .chunks_exact_mut(self.window.pixels())
            .zip(batch.targets.chunks_exact_mut(RGB_OUTPUTS));
        for (input, target) in rows {
            self.cut(random, photo, psi, sigma, Part::Validation, input, target);
        }
    }

    const fn cell(&self, photo: usize, psi: usize, class: usize) -> usize {
        (photo * self.psis.len() + psi) * NOISE_CLASSES + class
    }

    #[expect(clippy::too_many_arguments, reason = "one draw, each of its coordinates named at the call")]
    fn cut(
        &self,
        random: &mut Random,
        photo: usize,
        psi: usize,
        sigma: f32,
        part: Part,
        input: &mut [f32],
        target: &mut [f32],
    ) {
        let from = &self.photos[photo];
        let side = self.window.side();
        let (row, column) = from.place(random, side, part);
        let symmetry = random.below(8);
        let base = (row * from.width + column) * 3;
        let word = |v: u16| f32::from(v) * (1.0 / 65535.0);
        let blurred = &from.blurred[psi][base..];
        for (value, &offset) in input.iter_mut().zip(&self.raw_offsets[photo][symmetry]) {
            *value = word(blurred[offset as usize]);
        }
        let sharp = &from.sharp[base..];
        for (value, &offset) in target.iter_mut().zip(&self.sharp_offsets[photo * 8 + symmetry]) {
            *value = word(sharp[offset as usize]);
        }
        if sigma > 0.0 {
            let start = random.below(NORMALS - input.len());
            let noise = &self.normals[start..start + input.len()];
            input.iter_mut().zip(noise).for_each(|(v, n)| *v = (*v + sigma * n).clamp(0.0, 1.0));
        }
    }
}

impl Photo {
    /// Corner of a random block of `side`×`side` pixels that lies in the part asked for.
    fn place(&self, random: &mut Random, side: usize, part: Part) -> (usize, usize) {
        loop {
            let (row, column) = (random.below(self.height - side + 1), random.below(self.width - side + 1));
            let corners = [
                (row, column),
                (row, column + side - 1),
                (row + side - 1, column),
                (row + side - 1, column + side - 1),
            ];
            let kept = corners.map(|(r, c)| self.is_validation(r / TILE, c / TILE));
            let good = match part {
                Part::Training => kept.iter().all(|v| !v),
                Part::Validation => kept.iter().all(|v| *v),
            };
            if good {
                return (row, column);
            }
        }
    }

    const fn is_validation(&self, tile_row: usize, tile_column: usize) -> bool {
        (tile_row * 5 + tile_column * 3 + self.index * 7).is_multiple_of(TILES_PER_VALIDATION)
    }
}

/// A stream of random numbers that its seed, step and worker decide alone, so that a resumed run draws the same ones.
#[derive(Debug)]
pub struct Random(Pcg64Mcg);

impl Random {
    /// The stream of one worker at one step.
    #[must_use]
    pub fn new(seed: u64, step: u64, worker: u64) -> Self {
        let mixed = (u128::from(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15)) << 64)
            | u128::from(
                step.wrapping_mul(0xD134_2543_DE82_EF95) ^ worker.wrapping_mul(0xA24B_AED4_963E_E407),
            );
        let mut stream = Self(Pcg64Mcg::new(mixed));
        for _ in 0..4 {
            stream.word();
        }
        stream
    }

    fn word(&mut self) -> u64 {
        use rand::Rng;
        self.0.next_u64()
    }

    /// A whole number below `bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.word()) * bound as u128) >> 64) as usize
    }

    /// A number in 0…1, 1 excluded.
    pub fn unit(&mut self) -> f32 {
        (self.word() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A normal number (Box and Muller).
    pub fn normal(&mut self) -> f32 {
        let radius = (-2.0 * (1.0 - f64::from(self.unit())).ln()).sqrt();
        (radius * (std::f64::consts::TAU * f64::from(self.unit())).cos()) as f32
    }
}

fn check(photos: &[ColourFrame], psis: &[f64]) -> Result<(), PatchError> {
    if photos.is_empty() {
        return Err(PatchError::NoPhotos);
    }
    if psis.is_empty() {
        return Err(PatchError::NoPsi);
    }
    // With this many tiles each way, every photo has tiles of both parts.
    let least = TILE * 4;
    for (index, photo) in photos.iter().enumerate() {
        let (height, width) = photo.size();
        if height < least || width < least {
            return Err(PatchError::SmallPhoto { index, width, height, least });
        }
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

/// Where in the photo the pixel at `row`, `column` of a flipped and turned block lies, relative to the block's corner.
const fn turned(symmetry: usize, side: usize, row: usize, column: usize) -> (usize, usize) {
    let (mut r, mut c) = if symmetry & 4 == 0 { (row, column) } else { (column, row) };
    if symmetry & 1 != 0 {
        r = side - 1 - r;
    }
    if symmetry & 2 != 0 {
        c = side - 1 - c;
    }
    (r, c)
}

fn raw_offsets(width: usize, window: Window) -> [Vec<u32>; 8] {
    let side = window.side();
    std::array::from_fn(|symmetry| {
        (0..side * side)
            .map(|i| {
                let (row, column) = (i / side, i % side);
                let (r, c) = turned(symmetry, side, row, column);
                ((r * width + c) * 3 + CfaPhase::Rggb.channel(row, column).plane()) as u32
            })
            .collect()
    })
}

fn sharp_offsets(width: usize, window: Window) -> [Vec<u32>; 8] {
    let (side, margin) = (window.side(), window.margin());
    std::array::from_fn(|symmetry| {
        (0..RGB_OUTPUTS)
            .map(|i| {
                let (plane, pixel) = (i / PATCH_PIXELS, i % PATCH_PIXELS);
                let (r, c) = turned(symmetry, side, margin + pixel / PATCH, margin + pixel % PATCH);
                ((r * width + c) * 3 + plane) as u32
            })
            .collect()
    })
}

fn normals() -> Vec<f32> {
    let mut random = Random::new(0, 0, u64::MAX);
    (0..NORMALS).map(|_| random.normal()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array3;

    /// A photo whose planes tell where each pixel lies, behind a lens that does not blur at all (in focus, wide open).
    fn marked_bank(window: usize) -> Bank {
        let planes = Array3::from_shape_fn((3, 256, 256), |(c, row, column)| {
            [row as f32 / 255.0, column as f32 / 255.0, 0.5][c]
        });
        let mut camera = Camera::resolve("clear").unwrap();
        camera.aperture_radius_mm = 8.0;
        let frame = ColourFrame { planes };
        Bank::new(&[frame], &camera, &[0.0], &Settings::default(), Window::new(window).unwrap(), |_, _| true)
            .unwrap()
            .unwrap()
    }

    fn place_of(target: &[f32]) -> (f32, f32) {
        let mean = |plane: usize| target[plane * 64..][..64].iter().sum::<f32>() / 64.0 * 255.0;
        (mean(0), mean(1))
    }

    #[test]
    fn windows_see_the_mosaic_around_their_patch() {
        let bank = marked_bank(12);
        let mut batch = Batch::new(bank.window(), 200);
        bank.draw(&mut Random::new(1, 2, 3), 0.0, 1, &mut batch);
        for (input, target) in batch.inputs.chunks(144).zip(batch.targets.chunks(192)) {
            // Red and green are linear in place, so the mean of a centred window is that of its patch.
            let (row, column) = place_of(target);
            let sites =
                |r: usize, c: usize| (0..36).map(move |i| input[(i / 6 * 2 + r) * 12 + i % 6 * 2 + c]);
            let mean = |r, c| sites(r, c).sum::<f32>() / 36.0 * 255.0;
            assert!((mean(0, 0) - row).abs() < 1.5, "red sites hold rows");
            assert!((0.5 * (mean(0, 1) + mean(1, 0)) - column).abs() < 1.5, "green sites hold columns");
            assert!((mean(1, 1) / 255.0 - 0.5).abs() < 0.01, "blue sites hold a half");
        }
    }

    #[test]
    fn no_training_window_touches_a_validation_tile() {
        let bank = marked_bank(16);
        let photo = &bank.photos[0];
        let mut random = Random::new(5, 0, 0);
        for _ in 0..2000 {
            let (r, c) = photo.place(&mut random, 16, Part::Training);
            let touched = (r..r + 16).flat_map(|y| (c..c + 16).map(move |x| (y / TILE, x / TILE)));
            assert!(touched.clone().all(|(y, x)| !photo.is_validation(y, x)));
            let (r, c) = photo.place(&mut random, 16, Part::Validation);
            assert!(
                photo.is_validation(r / TILE, c / TILE)
                    && photo.is_validation((r + 15) / TILE, (c + 15) / TILE)
            );
        }
    }

    #[test]
    fn every_place_for_tiles_has_both_parts() {
        for index in 0..24 {
            let photo = Photo { width: 256, height: 256, index, sharp: vec![], blurred: vec![] };
            let kept = (0..16).filter(|i| photo.is_validation(i / 4, i % 4)).count();
            assert!((1..8).contains(&kept), "photo {index}: {kept} of 16 tiles");
        }
    }

    #[test]
    fn the_same_seed_draws_the_same_batch() {
        let bank = marked_bank(8);
        let draw = |seed| {
            let mut batch = Batch::new(bank.window(), 16);
            bank.draw(&mut Random::new(seed, 7, 0), 0.01, 8, &mut batch);
            batch.inputs
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
    }

    #[test]
    fn no_photos_and_small_photos_are_refused() {
        let camera = Camera::resolve("clear").unwrap();
        let make = |photos: &[ColourFrame]| {
            Bank::new(photos, &camera, &[0.0], &Settings::default(), Window::new(8).unwrap(), |_, _| true)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(make(&[]), "training photos: none given, at least one is needed");
        assert!(make(&[ColourFrame::zeros(100, 300)]).starts_with("training photo 0: 300x100"));
    }
}
