//! Random networks and windows of a small generator: for tests, benchmarks, examples and trials of hardware that has no trained
//! network yet. The same seed draws the same words.
//!
//! | what | from |
//! |---|---|
//! | [`extreme`] | a form: weights and thresholds anywhere in their range, mostly at its ends |
//! | [`for_design`] | a design: an extreme network that fits it |
//! | [`natural`] | a window and a stride: a network of the size and sparsity of a trained one |
//! | [`silent`] | a camera: a float network of the paper's size, all of its weights 0 |
//! | [`extreme_window`] | input words, often at the ends of their range |
//!
//! ```
//! let network = edof_device::random::natural(12, 8, 1);
//! assert!(network.check().is_ok());
//! ```

use crate::Design;
use edof_core::camera::Camera;
use edof_core::colour::{OUTPUTS_422, RGB_OUTPUTS};
use edof_core::draw::Draw;
use edof_core::number::{INPUT_FRACTION, InputWord, OUTPUT_FRACTION};
use edof_core::overlap::Overlap;
use edof_core::{Stride, Window};
use edof_network::fixed_network::FixedMatrix;
use edof_network::network::{Form, Origin, Recurrence, Shrinkage};
use edof_network::{FixedNetwork, Network};
use ndarray::{Array1, Array2};

/// Input words of one window: all of them 0 or more, often at the ends.
pub fn extreme_window(draw: &mut Draw, pixels: usize) -> Vec<InputWord> {
    (0..pixels).map(|_| InputWord::from_bits(draw.extreme(16).max(0))).collect()
}

/// A network of the given form whose weights and thresholds lie anywhere in their range, mostly at its ends. Its fraction bits
/// are legal for every form; `tight` makes all shifts zero.
#[must_use]
pub fn extreme(form: Form, code_bits: u32, stride: Stride, tight: bool, seed: u64) -> FixedNetwork {
    let draw = &mut Draw::new(seed);
    let pixels = form.window.pixels();
    let equal = tight || form.recurrence == Recurrence::Difference;
    let first = if tight { i64::from(OUTPUT_FRACTION) } else { draw.whole(8, 15) };
    let code_fractions: Vec<u32> =
        (0..form.shrinkages()).map(|_| if equal { first } else { draw.whole(8, 15) } as u32).collect();
    let last = i64::from(code_fractions[code_fractions.len() - 1]);
    // Down to products coarser than an output word, which are shifted up.
    let dictionary = if tight { 0 } else { draw.whole(2, 18) };
    // R's products stay within three bits of D's, so that aligning them cannot pass 48 bits.
    let linear = (last + dictionary - i64::from(INPUT_FRACTION) + draw.whole(-3, 3)).max(0);
    let mut matrix = |rows, columns, fraction: i64| FixedMatrix {
        weights: Array2::from_shape_fn((rows, columns), |_| draw.extreme(code_bits)),
        fraction: fraction as u32,
    };
    let analysis = matrix(form.codes, pixels, if tight { 0 } else { 12 });
    let recurrent = (0..form.recurrent_matrices())
        .map(|i| matrix(form.codes, form.codes, if tight { 0 } else { 9 + (seed % 7) as i64 + i as i64 }))
        .collect();
    let dictionary = matrix(OUTPUTS_422, form.codes, dictionary);
    let linear_path = form.linear_path.then(|| matrix(OUTPUTS_422, pixels, linear));
    let thresholds = (0..form.shrinkages())
        .map(|_| Array1::from_shape_fn(form.codes, |_| form.shrinkage.legal(draw.extreme(code_bits))))
        .collect();
    FixedNetwork {
        form,
        code_bits,
        stride,
        overlap: Overlap::Hann,
        analysis,
        thresholds,
        recurrent,
        dictionary,
        linear_path,
        code_fractions,
        origin: origin("random-test-network"),
        float_hash: String::new(),
        quantized: None,
    }
}

/// An [`extreme`] network that fits a design: its weights are halved until its sums have room, and where that is not enough all
/// shifts are zero.
#[must_use]
pub fn for_design(design: &Design, seed: u64) -> FixedNetwork {
    let drawn = |tight| extreme(design.form, design.code_bits, design.frame.stride, tight, seed);
    let fits = |network: &FixedNetwork| network.check().is_ok() && design.check_network(network).is_ok();
    let halvings =
        |tight| std::iter::successors(Some(drawn(tight)), |network| Some(halved(network))).take(16);
    [false, true].into_iter().flat_map(halvings).find(fits).unwrap_or_else(|| drawn(true))
}

/// The network with all weights halved.
fn halved(network: &FixedNetwork) -> FixedNetwork {
    let mut network = network.clone();
    let matrices = [&mut network.analysis, &mut network.dictionary].into_iter();
    for matrix in matrices.chain(&mut network.recurrent).chain(&mut network.linear_path) {
        matrix.weights.mapv_inplace(|weight| weight / 2);
    }
    network
}

/// A network of the size and habits of a trained one (T = 4, 192 codes, one-sided, with R): sparse codes, small gains, and
/// output near the mean of its window. It restores nothing, but costs what a trained one costs.
#[must_use]
pub fn natural(window: usize, stride: usize, seed: u64) -> FixedNetwork {
    let draw = &mut Draw::new(seed);
    let window = Window::new(window).unwrap_or(EIGHT);
    let form = Form {
        window,
        codes: 192,
        layers: 4,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    };
    let pixels = window.pixels();
    let analysis = Array2::from_shape_fn((form.codes, pixels), |(row, column)| {
        // Neighbouring rows share a random pattern with opposite signs; alternating signs keep the mean small.
        let sign = if (row + column) % 2 == 0 { 1 } else { -1 };
        (sign * draw.whole(2_000, 12_000)) as i16
    });
    let recurrent = (0..2)
        .map(|_| FixedMatrix {
            weights: Array2::from_shape_fn((form.codes, form.codes), |_| draw.whole(-6_000, 6_000) as i16),
            fraction: 16,
        })
        .collect();
    let thresholds = (0..3)
        .map(|_| {
            Array1::from_shape_fn(form.codes, |row| (600 + draw.whole(0, 900) * (row as i64 % 4)) as i16)
        })
        .collect();
    let dictionary = FixedMatrix {
        weights: Array2::from_shape_fn((OUTPUTS_422, form.codes), |_| draw.whole(-900, 900) as i16),
        fraction: 15,
    };
    let linear_path = FixedMatrix {
        weights: Array2::from_shape_fn((OUTPUTS_422, pixels), |(row, _)| {
            if row < 64 { mean_weight(pixels, stride) } else { 0 }
        }),
        fraction: 20,
    };
    FixedNetwork {
        form,
        code_bits: 16,
        stride: Stride::new(stride).unwrap_or(Stride::PATCH),
        overlap: Overlap::Flat,
        analysis: FixedMatrix { weights: analysis, fraction: 17 },
        thresholds,
        recurrent,
        dictionary,
        linear_path: Some(linear_path),
        code_fractions: vec![15, 14, 14],
        origin: origin("random-natural-network"),
        float_hash: String::new(),
        quantized: None,
    }
}

const EIGHT: Window = match Window::new(8) {
    Ok(window) => window,
    Err(_) => unreachable!(),
};

/// Weight of each pixel in the mean of a window, for patches of which (8/stride)² lie over a pixel; 20 fraction bits.
fn mean_weight(pixels: usize, stride: usize) -> i16 {
    let patches = (8 / stride.clamp(2, 8)).pow(2);
    ((1 << 20) / (pixels * patches)) as i16
}

fn origin(name: &str) -> Origin {
    let spectra = [610.0, 535.0, 460.0].map(edof_core::camera::Spectrum::Line);
    let camera = Camera {
        name: "none".into(),
        focal_length_mm: 16.0,
        aperture_radius_mm: 2.3,
        pixel_pitch_um: 3.0,
        spectra,
        reference_wavelength_nm: 460.0,
        defocus_sign: edof_core::camera::Sign::Plus,
        focus_psi: 0.0,
        nominal_m: None,
        psi_range: [0.0, 8.0],
        mask: Default::default(),
        aberrations: Default::default(),
        psf_bank: None,
        source: "drawn".into(),
    };
    Origin::untrained(name, camera)
}

/// A float network of the paper's size behind a camera, named `silent`: four layers, 192 codes, a window of 8 pixels, and all weights 0.
#[must_use]
pub fn silent(camera: Camera) -> Network {
    let form = Form {
        window: Window::PATCH,
        codes: 192,
        layers: 4,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: false,
        tied: false,
        exposures: 1,
    };
    Network {
        form,
        analysis: Array2::zeros((form.codes, form.window.pixels())),
        thresholds: vec![Array1::zeros(form.codes); form.shrinkages()],
        recurrent: vec![Array2::zeros((form.codes, form.codes)); form.recurrent_matrices()],
        dictionary: Array2::zeros((RGB_OUTPUTS, form.codes)),
        linear_path: None,
        origin: Origin::untrained("silent", camera),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_networks_are_legal() {
        for (window, stride) in [(8, 8), (12, 4), (16, 2)] {
            natural(window, stride, 3).check().unwrap();
        }
    }

    #[test]
    fn networks_random_for_a_design_fit_it() {
        let designs = ["tiny", "paper", "kc705"].map(|name| {
            let path = format!("{}/../../designs/{name}.json", env!("CARGO_MANIFEST_DIR"));
            Design::load(path.as_ref()).unwrap()
        });
        for (mut design, seed) in designs.into_iter().flat_map(|d| (0..8).map(move |seed| (d.clone(), seed)))
        {
            design.check_network(&for_design(&design, seed)).unwrap();
            design.accumulator_bits = 32;
            design.check_network(&for_design(&design, seed)).unwrap();
        }
    }
}
