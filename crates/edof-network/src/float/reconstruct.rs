//! A whole frame through the float network: what the fixed-point pipeline approximates.

use crate::Network;
use crate::float::matmul::{Destination, Mat, product};
use crate::float::parameters::flatten;
use crate::float::pass::Pass;
use edof_core::colour::{OUTPUTS_422, RGB_OUTPUTS, chroma_word, luma_word, patch_422_from_rgb, rgb_from_422};
use edof_core::frame::Frame422;
use edof_core::geometry::{PATCH, PATCH_PIXELS, mirror};
use edof_core::overlap::Overlap;
use edof_core::reconstructor::Multiplications;
use edof_core::{ColourFrame, Geometry, RawFrame, ReconstructError, Reconstruction, Reconstructor, Stride};
use ndarray::{Array2, Array3, ArrayView2, ArrayViewMut2};
use rayon::prelude::*;
use std::borrow::Cow;
use std::time::Instant;

/// Windows that pass through the network together, about: many, since each product prepares its matrix anew; few, so that a core's cache holds their codes.
const TOGETHER: usize = 256;

/// What the reconstructed frame has been through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// RGB as the network gives it.
    Rgb,
    /// The board's format: 4:2:2 in words of 16 bits, and back to RGB.
    Ycc422,
}

/// The float network as a method of reconstruction.
#[derive(Debug)]
pub struct FloatReconstructor {
    name: String,
    network: Network,
    weights: Vec<f32>,
    geometry: Geometry,
    /// Weight of each pixel of a patch.
    averaging: Array2<f32>,
    output: Output,
    /// The most non-zeros of a patch after each shrinkage.
    budget: Option<usize>,
}

impl FloatReconstructor {
    /// The network at a stride; its name in reports is the network's with `.float` or `.float422`.
    ///
    /// # Errors
    /// [`crate::network::NetworkError`] if the matrices do not fit the form.
    pub fn new(
        network: Network,
        stride: Stride,
        overlap: Overlap,
        output: Output,
    ) -> Result<Self, crate::network::NetworkError> {
        network.check()?;
        let suffix = match output {
            Output::Rgb => "float",
            Output::Ycc422 => "float422",
        };
        Ok(Self {
            name: format!("{}.{suffix}", network.origin.name),
            weights: flatten(&network),
            geometry: Geometry::new(network.form.window, stride),
            network,
            averaging: overlap.weights(stride).mapv(|w| w as f32),
            output,
            budget: None,
        })
    }

    /// The same with at most N non-zeros per patch after each shrinkage, the largest.
    #[must_use]
    pub const fn within(mut self, budget: usize) -> Self {
        self.budget = Some(budget);
        self
    }

    /// Windows × inputs of one row of patches, mirrored at the borders; 0…1.
    fn windows(&self, exposures: &[ArrayView2<'_, u16>], patch_row: usize, columns: usize) -> Vec<f32> {
        let side = self.geometry.window.side();
        let mut windows = Vec::with_capacity(columns * self.network.form.inputs());
        let top = self.geometry.window_start(patch_row);
        for patch_column in 0..columns {
            let left = self.geometry.window_start(patch_column);
            for (pixels, r) in
                exposures.iter().flat_map(|pixels| (0..side as isize).map(move |r| (pixels, r)))
            {
                let (height, width) = pixels.dim();
                let line = pixels.row(mirror(top + r, height));
                windows
                    .extend((0..side as isize).map(|c| f32::from(line[mirror(left + c, width)]) / 65536.0));
            }
        }
        windows
    }

    /// Patches that the network gives, one row of them after the other; each window's outputs by `output`.
    fn patches(
        &self,
        exposures: &[ArrayView2<'_, u16>],
        output: impl Fn(&[f32]) -> Vec<f32> + Sync,
    ) -> Vec<Vec<f32>> {
        let (height, width) = exposures[0].dim();
        let (rows, columns) = self.geometry.patches(height, width);
        let together = (TOGETHER / columns).max(1);
        let firsts: Vec<usize> = (0..rows).step_by(together).collect();
        let passed = firsts.into_par_iter().map_init(
            || Pass::new(self.network.form, together * columns).within(self.budget),
            |pass, first| {
                let here = first..rows.min(first + together);
                let windows = here.len() * columns;
                let inputs: Vec<f32> = here.flat_map(|row| self.windows(exposures, row, columns)).collect();
                let patches = pass.forward(&self.weights, &inputs, windows);
                patches.chunks_exact(columns * RGB_OUTPUTS).map(&output).collect::<Vec<_>>()
            },
        );
        passed.flatten_iter().collect()
    }

    /// Weighted sum of all overlapping patches; RGB.
    fn rgb(&self, exposures: &[ArrayView2<'_, u16>]) -> ColourFrame {
        let (height, width) = exposures[0].dim();
        let mut planes = Array3::zeros((3, height, width));
        let lines = self.patches(exposures, <[f32]>::to_vec);
        let colours: Vec<_> = planes.outer_iter_mut().enumerate().collect();
        colours.into_par_iter().for_each(|(colour, mut plane)| {
            for (patch_row, line) in lines.iter().enumerate() {
                for (patch_column, patch) in line.chunks_exact(RGB_OUTPUTS).enumerate() {
                    let block = &patch[colour * PATCH_PIXELS..][..PATCH_PIXELS];
                    self.add(plane.view_mut(), block, (patch_row, patch_column), 1);
                }
            }
        });
        ColourFrame { planes }
    }

    /// The board's 4:2:2 frame. As on the board each patch is brought to 4:2:2 before it is added, so that at a stride below 8,
    /// too, only rounding distinguishes the integers from this.
    fn ycc422(&self, exposures: &[ArrayView2<'_, u16>]) -> Frame422 {
        let (height, width) = exposures[0].dim();
        let map: Vec<f32> = patch_422_from_rgb().iter().map(|v| *v as f32).collect();
        let to_422 = |rgb: &[f32]| {
            let windows = rgb.len() / RGB_OUTPUTS;
            let mut out = vec![0.0; windows * OUTPUTS_422];
            let map = Mat::new(&map, OUTPUTS_422, RGB_OUTPUTS);
            product(&mut out, Destination::Replace, Mat::new(rgb, windows, RGB_OUTPUTS), map.t());
            out
        };
        let mut luma = Array2::zeros((height, width));
        let mut chroma = [Array2::zeros((height, width / 2)), Array2::zeros((height, width / 2))];
        for (patch_row, line) in self.patches(exposures, to_422).iter().enumerate() {
            for (patch_column, patch) in line.chunks_exact(OUTPUTS_422).enumerate() {
                let (y, differences) = patch.split_at(PATCH_PIXELS);
                self.add(luma.view_mut(), y, (patch_row, patch_column), 1);
                for (plane, block) in chroma.iter_mut().zip(differences.chunks_exact(PATCH_PIXELS / 2)) {
                    self.add(plane.view_mut(), block, (patch_row, patch_column), 2);
                }
            }
        }
        Frame422 {
            luma: luma.mapv(|v| luma_word(f64::from(v))),
            chroma: chroma.map(|plane| plane.mapv(|v| chroma_word(f64::from(v)))),
        }
    }

    /// Adds a block of one plane of a patch, weighted for the overlap. Planes may have a sample at each pixel or at every
    /// `every`-th of a row only.
    fn add(&self, mut plane: ArrayViewMut2<'_, f32>, block: &[f32], patch: (usize, usize), every: usize) {
        let (height, width) = plane.dim();
        let weights = &self.averaging;
        let top = self.geometry.patch_start(patch.0);
        let left = self.geometry.patch_start(patch.1) / every as isize;
        let columns = PATCH / every;
        for (r, values) in block.chunks_exact(columns).enumerate() {
            let row = top + r as isize;
            if !(0..height as isize).contains(&row) {
                continue;
            }
            let mut line = plane.row_mut(row as usize);
            for (c, value) in values.iter().enumerate() {
                let column = left + c as isize;
                if (0..width as isize).contains(&column) {
                    line[column as usize] += value * weights[(r, c * every)];
                }
            }
        }
    }

    /// No zero is skipped here.
    fn multiplications(&self, height: usize, width: usize) -> Multiplications {
        let (rows, columns) = self.geometry.patches(height, width);
        let dense = (rows * columns) as u64 * self.network.form.dense_multiplications(RGB_OUTPUTS);
        Multiplications { dense, executed: dense }
    }
}

impl Reconstructor for FloatReconstructor {
    fn name(&self) -> &str {
        &self.name
    }

    fn reconstruct(&self, raw: &RawFrame) -> Result<Reconstruction, ReconstructError> {
        self.reconstruct_exposures(&[raw])
    }

    fn reconstruct_exposures(&self, raws: &[&RawFrame]) -> Result<Reconstruction, ReconstructError> {
        let expected = self.network.form.exposures;
        if raws.len() != expected {
            return Err(ReconstructError::exposures(&self.name, raws.len(), expected));
        }
        Reconstruction::through_exposures(self.network.origin.values, raws, |raws| self.values(raws))
    }
}

impl FloatReconstructor {
    fn values(&self, raws: &[Cow<'_, RawFrame>]) -> Result<Reconstruction, ReconstructError> {
        let start = Instant::now();
        let (height, width) = raws[0].size();
        self.geometry.check_frame((height, width))?;
        self.check_alike(raws)?;
        let aligned: Vec<_> = raws.iter().map(|raw| raw.to_rggb()).collect();
        let (row, column) = aligned[0].1;
        let (rows, columns) = aligned[0].0.size();
        let pixels: Vec<_> = aligned.iter().map(|(raw, _)| raw.pixels().view()).collect();
        let frame = match self.output {
            Output::Rgb => self.rgb(&pixels),
            Output::Ycc422 => rgb_from_422(&self.ycc422(&pixels)),
        };
        Ok(Reconstruction {
            frame: frame.crop(row, column, height, width),
            seconds: start.elapsed().as_secs_f64(),
            multiplications: Some(self.multiplications(rows, columns)),
            counters: None,
            iterations: None,
        })
    }

    /// Rejects exposures of different sizes or CFA phases.
    fn check_alike(&self, raws: &[Cow<'_, RawFrame>]) -> Result<(), ReconstructError> {
        let kind = |raw: &Cow<'_, RawFrame>| {
            let (height, width) = raw.size();
            format!("{width}x{height} {}", raw.phase())
        };
        let first = kind(&raws[0]);
        match raws.iter().map(kind).find(|other| *other != first) {
            Some(other) => Err(ReconstructError::Method {
                method: self.name.clone(),
                reason: format!("exposures are {first} and {other}, expected the same size and CFA phase"),
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Form, Origin, Recurrence, Shrinkage};
    use edof_core::camera::Camera;
    use edof_core::{CfaPhase, Tone, Window};
    use ndarray::{Array1, Axis, concatenate};
    use proptest::prelude::*;

    /// A network without codes whose linear path takes each output's colour from the nearest site of that colour.
    fn nearest_site_network(window: usize) -> Network {
        let window = Window::new(window).unwrap();
        let form = Form {
            window,
            codes: 1,
            layers: 2,
            shrinkage: Shrinkage::OneSided,
            recurrence: Recurrence::Direct,
            linear_path: true,
            tied: false,
            exposures: 1,
        };
        let mut r = Array2::zeros((RGB_OUTPUTS, window.pixels()));
        for output in 0..RGB_OUTPUTS {
            let (plane, pixel) = (output / 64, output % 64);
            let cell = |v: usize, odd: bool| v / 2 * 2 + usize::from(odd) + window.margin();
            let (row, column) = (cell(pixel / 8, plane == 2), cell(pixel % 8, plane > 0));
            r[(output, row * window.side() + column)] = 1.0;
        }
        Network {
            form,
            analysis: Array2::zeros((1, window.pixels())),
            thresholds: vec![Array1::zeros(1)],
            recurrent: vec![],
            dictionary: Array2::zeros((RGB_OUTPUTS, 1)),
            linear_path: Some(r),
            origin: Origin::untrained("nearest", Camera::resolve("clear").unwrap()),
        }
    }

    /// The same network of two exposures, which looks at one of them.
    fn looking_at(exposure: usize) -> Network {
        let mut network = nearest_site_network(12);
        let doubled = |matrix: &Array2<f32>| {
            let nothing = Array2::zeros(matrix.dim());
            let halves = if exposure == 0 { [matrix, &nothing] } else { [&nothing, matrix] };
            concatenate(Axis(1), &halves.map(|half| half.view())).unwrap()
        };
        let [analysis, linear_path] =
            [Some(&network.analysis), network.linear_path.as_ref()].map(|m| m.map(doubled));
        network.analysis = analysis.unwrap();
        network.linear_path = linear_path;
        network.form.exposures = 2;
        network.origin.further_foci = vec![6.0];
        network
    }

    fn of(network: Network, output: Output) -> FloatReconstructor {
        FloatReconstructor::new(network, Stride::PATCH, Overlap::Hann, output).unwrap()
    }

    #[test]
    fn a_network_with_fewer_layers_is_the_one_whose_other_layers_change_nothing() {
        let mut network = nearest_site_network(8);
        network.form.layers = 4;
        network.analysis.fill(0.01);
        network.dictionary.fill(0.3);
        network.thresholds = [0.02, 0.05, 0.07].map(|theta| Array1::from_elem(1, theta)).into();
        network.recurrent = [0.4, -0.2].map(|s| Array2::from_elem((1, 1), s)).into();
        let raw = RawFrame::from_values(
            Array2::from_shape_fn((16, 24), |(r, c)| (r * 40 + c) as u16),
            10,
            CfaPhase::Rggb,
        );
        let picture =
            |network: Network| of(network, Output::Rgb).reconstruct(raw.as_ref().unwrap()).unwrap().frame;
        // b_t = b_1 with S = 0, and all thresholds those of the first layers.
        let mut still = network.clone();
        still.recurrent.iter_mut().for_each(|s| s.fill(0.0));
        still.thresholds = vec![network.thresholds[0].clone(); 3];
        assert_eq!(picture(network.clone().with_layers(2).unwrap()), picture(still.clone()));
        assert_ne!(
            picture(network.clone().with_layers(3).unwrap()),
            picture(network.clone().with_layers(2).unwrap())
        );
        assert_eq!(network.clone().with_layers(4), Ok(network.clone()));
        for layers in [1, 5] {
            let error = network.clone().with_layers(layers).unwrap_err().to_string();
            assert_eq!(error, format!("layers {layers}: must be 2 to 4, the layers of this network"));
        }
    }

    #[test]
    fn a_network_of_two_exposures_with_nothing_in_one_half_is_the_network_of_the_other() {
        let noisy = |seed: usize| {
            let codes = Array2::from_shape_fn((20, 28), |(r, c)| {
                u16::try_from((r * 7919 + c * 104_729 + seed * 613) % 65_536).unwrap()
            });
            RawFrame::from_values(codes, 16, CfaPhase::Grbg).unwrap()
        };
        let frames = [noisy(1), noisy(2)];
        for output in [Output::Rgb, Output::Ycc422] {
            let single = of(nearest_site_network(12), output);
            let alone = frames.each_ref().map(|raw| single.reconstruct(raw).unwrap().frame);
            assert!(alone[0] != alone[1]);
            for exposure in 0..2 {
                let double = of(looking_at(exposure), output);
                let picture = |raws: [&RawFrame; 2]| double.reconstruct_exposures(&raws).unwrap().frame;
                assert_eq!(picture([&frames[0], &frames[1]]), alone[exposure], "{output:?}");
                // Frames that are swapped are seen.
                assert_eq!(picture([&frames[1], &frames[0]]), alone[1 - exposure], "{output:?}");
            }
        }
    }

    /// A network with random weights, and the same of two exposures with half of each weight for either.
    fn random_and_halved(seed: u64) -> [Network; 2] {
        let mut state = seed;
        let mut weight = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f32 / (1 << 24) as f32 - 0.5
        };
        let mut network = nearest_site_network(8);
        network.analysis = network.analysis.mapv(&mut weight);
        network.dictionary = network.dictionary.mapv(&mut weight);
        network.linear_path = network.linear_path.map(|r| r.mapv(&mut weight));
        let halved = |matrix: &Array2<f32>| 0.5 * concatenate![Axis(1), *matrix, *matrix];
        let mut double = network.clone();
        double.analysis = halved(&network.analysis);
        double.linear_path = network.linear_path.as_ref().map(halved);
        double.form.exposures = 2;
        double.origin.further_foci = vec![double.origin.camera.focus_psi];
        [network, double]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        #[test]
        fn a_network_that_weighs_both_exposures_alike_makes_of_one_frame_twice_what_its_whole_makes_of_it(
            seed in any::<u64>(), phase in 0usize..4, (a, b) in (1u16..5000, 1u16..5000)
        ) {
            let codes = Array2::from_shape_fn((16, 24), |(r, c)| (r as u16).wrapping_mul(a) ^ (c as u16).wrapping_mul(b));
            let raw = RawFrame::from_values(codes, 16, CfaPhase::ALL[phase]).unwrap();
            let other = RawFrame::from_values(raw.values().mapv(|v| v / 3), 16, raw.phase()).unwrap();
            let [single, double] = random_and_halved(seed).map(|network| of(network, Output::Rgb));
            let alike = |a: &ColourFrame, b: &ColourFrame| {
                a.planes.iter().zip(&b.planes).all(|(a, b)| (a - b).abs() < 1e-4)
            };
            let both = |a, b| double.reconstruct_exposures(&[a, b]).unwrap().frame;
            prop_assert!(alike(&both(&raw, &raw), &single.reconstruct(&raw).unwrap().frame));
            prop_assert!(alike(&both(&raw, &other), &both(&other, &raw)));
            prop_assert!(!alike(&both(&raw, &other), &both(&raw, &raw)));
        }
    }

    #[test]
    fn a_scene_needs_as_many_like_frames_as_its_network_has_exposures() {
        let double = of(looking_at(0), Output::Rgb);
        let told = |method: &dyn Reconstructor, raws: &[&RawFrame]| {
            method.reconstruct_exposures(raws).unwrap_err().to_string()
        };
        let raw = flat_raw(CfaPhase::Rggb);
        assert_eq!(told(&double, &[&raw]), "nearest.float: got 1 raw frame of one scene, expected 2");
        assert_eq!(double.reconstruct(&raw).unwrap_err().to_string(), told(&double, &[&raw]));
        let single = of(nearest_site_network(12), Output::Rgb);
        assert_eq!(told(&single, &[&raw, &raw]), "nearest.float: got 2 raw frames of one scene, expected 1");
        assert_eq!(
            told(&double, &[&raw, &flat_raw(CfaPhase::Bggr)]),
            "nearest.float: exposures are 28x20 rggb and 28x20 bggr, expected the same size and CFA phase"
        );
    }

    fn flat_raw(phase: CfaPhase) -> RawFrame {
        let codes =
            Array2::from_shape_fn((20, 28), |(r, c)| [60000, 30000, 10000][phase.channel(r, c).plane()]);
        RawFrame::from_values(codes, 16, phase).unwrap()
    }

    #[test]
    fn every_patch_is_where_its_window_was_however_many_pass_together() {
        // Ten rows of 33 patches, and four times as many: no whole number of passes.
        let codes =
            Array2::from_shape_fn((80, 264), |(r, c)| (r * 7919 + c * 104_729) as u16 ^ (r as u16) << 8);
        let raw = RawFrame::from_values(codes, 16, CfaPhase::Rggb).unwrap();
        for stride in [8, 4] {
            let method = FloatReconstructor::new(
                nearest_site_network(12),
                Stride::new(stride).unwrap(),
                Overlap::Hann,
                Output::Rgb,
            );
            let out = method.unwrap().reconstruct(&raw).unwrap().frame;
            for ((plane, row, column), v) in out.planes.indexed_iter() {
                let site = (row & !1 | usize::from(plane == 2), column & !1 | usize::from(plane > 0));
                let expected = f32::from(raw.pixels()[site]) / 65536.0;
                assert!((v - expected).abs() < 1e-5, "{stride} {plane} {row} {column}: {v} for {expected}");
            }
        }
    }

    #[test]
    fn every_phase_window_and_stride_gives_a_flat_colour_back() {
        for phase in CfaPhase::ALL {
            for (window, stride) in [(8, 8), (12, 4), (16, 2)] {
                let method = FloatReconstructor::new(
                    nearest_site_network(window),
                    Stride::new(stride).unwrap(),
                    Overlap::Hann,
                    Output::Rgb,
                )
                .unwrap();
                let out = method.reconstruct(&flat_raw(phase)).unwrap().frame;
                assert_eq!(out.size(), (20, 28));
                for ((plane, ..), v) in out.planes.indexed_iter() {
                    let exact = [60000.0, 30000.0, 10000.0][plane] / 65536.0;
                    assert!((v - exact).abs() < 1e-5, "{phase} {window} {stride}: {v} for {exact}");
                }
            }
        }
    }

    #[test]
    fn a_network_of_encoded_values_gives_a_flat_colour_of_light_back() {
        let mut network = nearest_site_network(12);
        network.origin.values = Tone::Srgb;
        let method = FloatReconstructor::new(network, Stride::PATCH, Overlap::Hann, Output::Rgb).unwrap();
        let raw = flat_raw(CfaPhase::Grbg);
        for ((plane, ..), v) in method.reconstruct(&raw).unwrap().frame.planes.indexed_iter() {
            let exact = [60000.0, 30000.0, 10000.0][plane] / 65536.0;
            assert!((v - exact).abs() < 3e-5, "{v} for {exact}");
        }
        let window = method.windows(&[raw.encoded(Tone::Srgb).pixels().view()], 0, 3);
        assert!((window[0] - Tone::Srgb.encode(30000.0 / 65536.0)).abs() < 1e-5);
    }

    #[test]
    fn the_boards_format_costs_a_flat_colour_less_than_two_words() {
        let method =
            FloatReconstructor::new(nearest_site_network(8), Stride::PATCH, Overlap::Flat, Output::Ycc422)
                .unwrap();
        assert_eq!(method.name(), "nearest.float422");
        let out = method.reconstruct(&flat_raw(CfaPhase::Rggb)).unwrap().frame;
        for ((plane, ..), v) in out.planes.indexed_iter() {
            assert!((v - [60000.0, 30000.0, 10000.0][plane] / 65536.0).abs() < 2.0 / 16384.0);
        }
    }
}
