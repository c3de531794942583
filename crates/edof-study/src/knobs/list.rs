//! All knobs.

use super::knob::{Knob, Plan, Shortened, Work};
use crate::methods::settings::{
    DeconvolutionSettings, Depths, FloatSettings, PictureModel, Pursuit, PursuitSettings, UntrainedSettings,
};
use crate::methods::spec::{MethodSpec, words_sha256};
use edof_core::camera::Camera;
use edof_core::camera::Spectrum;
use edof_core::{Noise, Stride, Window};
use edof_network::FixedNetwork;
use edof_network::fixed_network::{FixedMatrix, WORD_BITS};
use edof_optics::capture::Approximation;
use edof_optics::layers;
use edof_optics::psf::Settings;
use serde::de::{Deserialize, Deserializer, Error};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// All of them, in the order in which files and pages have them.
pub static KNOBS: [Knob; 14] = [
    Knob {
        name: "kernel-energy",
        unit: "share of the energy kept",
        values: &[0.9, 0.99, 0.999, 0.9999],
        default: |_| Settings::default().energy,
        why: "Kernels are cut to the smallest square that keeps a share of their energy. Error of the light on the sensor against whole kernels. \
                 0.999: the error is far below a sensor's noise, and kernels are still smaller than the support that they are cut from (1024 pixels at most).",
        apply: kernel_energy,
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "wavelengths",
        unit: "share of the energy that may move",
        values: &[0.3, 0.1, 0.03, 0.01, 0.003],
        default: |_| Settings::default().wavelength_tolerance,
        why: "Of a colour with a spectrum (here bands of 60 nm around the camera's lines), wavelengths are added until the kernel moves by less than a share of \
                 its energy. Error of the light against the most wavelengths. 0.01: below what the kernels' cut costs.",
        apply: wavelengths,
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "depths",
        unit: "layers",
        values: &[2.0, 4.0, 8.0, 16.0, 32.0],
        default: |_| layers::USUAL as f64,
        why: "A scene whose depth rises evenly over the camera's range, cut into so many layers of one kernel each. Error of the light against 64 layers. 16: half a \
                 radian a layer, half of the 1 rad between the depths that networks are trained for.",
        apply: depths,
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "stride",
        unit: "pixels",
        values: &[8.0, 4.0, 2.0],
        default: |_| Stride::PATCH.pixels() as f64,
        why: "Patches of the float network overlap at strides 4 and 2 and are averaged. 8: four and sixteen times the work for what the curve shows; 60 frames \
                 a second are within reach at stride 8 alone.",
        apply: |plan, value| float(plan, FloatSettings::at(stride(value))),
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "bits",
        unit: "bits",
        values: &[8.0, 9.0, 10.0, 12.0, 16.0],
        default: |_| f64::from(WORD_BITS),
        why: "Weights and codes of the fixed network, quantized for so many bits with nothing trained after. 16: what the board's multipliers take without \
                 costing more of them. Time is that of the software model, which does not depend on bits; what it saves is memory on the board.",
        apply: |plan, value| fixed("bits", plan.in_bits(value as u32).clone()),
        takes_time: false,
        bits: &[8, 9, 10, 12, WORD_BITS],
    },
    Knob {
        name: "analysis-bits",
        unit: "bits",
        values: &[4.0, 6.0, 8.0, 10.0, 12.0, 16.0],
        default: |_| f64::from(WORD_BITS),
        why: "Words of A and of the linear path R of the fixed network rounded to so many bits, all else 16. 16: as for all words. Where the curve is flat the board's memory \
                 holds bits that no picture needs.",
        apply: analysis_bits,
        takes_time: false,
        bits: &[WORD_BITS],
    },
    Knob {
        name: "recurrent-bits",
        unit: "bits",
        values: &[4.0, 6.0, 8.0, 10.0, 12.0, 16.0],
        default: |_| f64::from(WORD_BITS),
        why: "Words of every S of the fixed network rounded to so many bits, all else 16. 16: as for all words. S is most of the network's memory.",
        apply: recurrent_bits,
        takes_time: false,
        bits: &[WORD_BITS],
    },
    Knob {
        name: "dictionary-bits",
        unit: "bits",
        values: &[4.0, 6.0, 8.0, 10.0, 12.0, 16.0],
        default: |_| f64::from(WORD_BITS),
        why: "Words of D of the fixed network rounded to so many bits, all else 16. 16: as for all words.",
        apply: dictionary_bits,
        takes_time: false,
        bits: &[WORD_BITS],
    },
    Knob {
        name: "budget",
        unit: "non-zeros per patch",
        values: &[8.0, 16.0, 32.0, 64.0, 96.0, 192.0],
        default: |plan| plan.network.form.codes as f64,
        why: "Sparse codes of a patch that may be other than 0 after each shrinkage of the float network, the largest; all others are dropped. 192: all, no budget. A board that \
                 skips zeros takes cycles by the non-zeros of the busiest stage, so a budget bounds its time; here time is that of a program that skips nothing.",
        apply: budget,
        takes_time: false,
        bits: &[],
    },
    Knob {
        name: "layers",
        unit: "layers",
        values: &[3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
        default: |plan| plan.network.form.layers as f64,
        why: "T of the paper's network before training, each colour's mean taken out: ISTA in the pursuits' dictionary, cut off. 4: what the board runs. Networks trained for \
                 other T stand in docs/results/layers.md; the curve says what a layer adds where training has not made up for it.",
        apply: untrained,
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "atoms",
        unit: "atoms",
        values: &[2.0, 4.0, 8.0, 16.0, 24.0],
        default: |_| Pursuit::OMP.count() as f64,
        why: "Atoms that orthogonal matching pursuit may use in a patch, ψ known. 16: chosen without noise (docs/decisions/0015-single-depth.md); with noise \
                 fewer may be better.",
        apply: |plan, value| pursuit(plan, usual(Pursuit::Omp { atoms: value as usize })),
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "steps",
        unit: "steps",
        values: &[3.0, 4.0, 6.0, 8.0, 10.0, 30.0, 100.0],
        default: |_| Pursuit::FISTA.count() as f64,
        why: "Steps of FISTA in the dictionary, ψ known: what a network of so many layers would do without having been trained. 100: where it stands \
                 still. A trained network does it in four.",
        apply: |plan, value| pursuit(plan, usual(Pursuit::FISTA.in_steps(value as usize))),
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "window",
        unit: "pixels",
        values: &[8.0, 12.0, 16.0],
        default: |_| usual(Pursuit::OMP).window.side() as f64,
        why: "Side of the raw window that OMP sees around a patch, ψ known. 8: the paper's, which all pursuits of the studies keep. A wider window sees the light that a blur \
                 carries across a patch's border, and much that no atom of the patch explains, at which the pursuit spends its atoms: it is worse.",
        apply: |plan, value| pursuit(plan, PursuitSettings { window: window(value), ..usual(Pursuit::OMP) }),
        takes_time: true,
        bits: &[],
    },
    Knob {
        name: "noise-class",
        unit: "σ prepared for",
        values: &[0.0, 0.005, 0.01, 0.02, 0.04],
        default: |plan| sigma(plan.noise),
        why: "Wiener's filter, ψ known, prepared for a σ that is not always the one that there is. The default is the noise itself: networks have two banks for \
                 the same reason. Less may be better on photographs that vary more than the filter takes for granted.",
        apply: noise_class,
        takes_time: false,
        bits: &[],
    },
];

/// An unknown knob.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("knob '{0}': must be one of {list}", list = KNOBS.each_ref().map(|knob| knob.name).join(", "))]
pub struct UnknownKnob(String);

impl std::str::FromStr for &'static Knob {
    type Err = UnknownKnob;

    fn from_str(text: &str) -> Result<Self, UnknownKnob> {
        KNOBS.iter().find(|knob| knob.name == text).ok_or_else(|| UnknownKnob(text.to_owned()))
    }
}

impl Serialize for Knob {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.name)
    }
}

impl<'de> Deserialize<'de> for &'static Knob {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        String::deserialize(from)?.parse().map_err(D::Error::custom)
    }
}

impl Ord for Knob {
    /// As in [`KNOBS`].
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let place = |knob: &Self| KNOBS.iter().position(|known| known.name == knob.name);
        place(self).cmp(&place(other))
    }
}

impl PartialOrd for Knob {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Knob {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Knob {}

impl std::fmt::Debug for Knob {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// Layers of the scene of many depths that others are held against.
const MAX_LAYERS: usize = 64;
/// Half the width of the bands in nanometres that stand for colours where wavelengths are counted.
const HALF_BAND_NM: f64 = 30.0;

fn capture(camera: Camera, cut: Approximation, reference: Approximation, layers: Option<[usize; 2]>) -> Work {
    Work::Capture(Box::new(Shortened { camera, cut, reference, layers }))
}

fn kernel_energy(plan: &Plan, energy: f64) -> Work {
    let whole = Settings { energy: 1.0, wavelength_tolerance: 0.0, exact: false };
    let usual = Approximation::default();
    let [cut, reference] = [Settings { energy, ..whole }, whole].map(|psf| Approximation { psf, ..usual });
    capture(plan.camera.clone(), cut, reference, None)
}

/// Kernels as they usually are: only the wavelengths differ.
fn wavelengths(plan: &Plan, tolerance: f64) -> Work {
    let usual = Approximation::default();
    let [cut, reference] = [tolerance, 0.0].map(|wavelength_tolerance| Approximation {
        psf: Settings { wavelength_tolerance, ..usual.psf },
        ..usual
    });
    capture(banded(&plan.camera), cut, reference, None)
}

fn depths(plan: &Plan, layers: f64) -> Work {
    let usual = Approximation::default();
    capture(plan.camera.clone(), usual, usual, Some([layers as usize, MAX_LAYERS]))
}

/// The camera with a band in place of each line.
fn banded(camera: &Camera) -> Camera {
    let band = |spectrum: &Spectrum| match spectrum {
        Spectrum::Line(nm) => Spectrum::Sampled(vec![[nm - HALF_BAND_NM, 1.0], [nm + HALF_BAND_NM, 1.0]]),
        sampled @ Spectrum::Sampled(_) => sampled.clone(),
    };
    Camera { spectra: camera.spectra.each_ref().map(band), ..camera.clone() }
}

/// All values of strides and windows are legal.
fn stride(pixels: f64) -> Stride {
    Stride::new(pixels as usize).unwrap_or_else(|e| unreachable!("{e}"))
}

fn window(side: f64) -> Window {
    Window::new(side as usize).unwrap_or_else(|e| unreachable!("{e}"))
}

fn float(plan: &Plan, settings: FloatSettings) -> Work {
    let (network, sha256) = (Arc::clone(&plan.network), plan.network_sha256.clone());
    Work::Method(MethodSpec::Float { network, sha256, settings })
}

fn budget(plan: &Plan, codes: f64) -> Work {
    float(plan, FloatSettings { budget: Some(codes as usize), ..FloatSettings::at(Stride::PATCH) })
}

fn untrained(plan: &Plan, layers: f64) -> Work {
    Work::Method(MethodSpec::Untrained {
        settings: UntrainedSettings::usual(layers as usize, true, Stride::PATCH),
        dictionary: Arc::clone(&plan.dictionary),
    })
}

/// A pursuit with ψ known.
fn usual(how: Pursuit) -> PursuitSettings {
    PursuitSettings::usual(how, Depths::Known, Stride::PATCH)
}

fn pursuit(plan: &Plan, settings: PursuitSettings) -> Work {
    Work::Method(MethodSpec::Pursuit { settings, dictionary: Arc::clone(&plan.dictionary) })
}

fn sigma(noise: Noise) -> f64 {
    match noise {
        Noise::Gaussian { sigma } => sigma,
        Noise::None | Noise::Sensor(_) => 0.0,
    }
}

fn noise_class(_: &Plan, sigma: f64) -> Work {
    Work::Method(MethodSpec::Deconvolution(DeconvolutionSettings::Wiener {
        model: PictureModel::default(),
        noise: Some(Noise::gaussian(sigma)),
    }))
}

fn fixed(name: &str, network: FixedNetwork) -> Work {
    let sha256 = words_sha256(&network);
    Work::Method(MethodSpec::Fixed { network: Arc::new(network), name: name.into(), sha256 })
}

fn analysis_bits(plan: &Plan, bits: f64) -> Work {
    let mut network = plan.in_bits(WORD_BITS).clone();
    let matrices = std::iter::once(&mut network.analysis).chain(network.linear_path.as_mut());
    matrices.for_each(|matrix| keep_bits(matrix, bits as u32));
    fixed("analysis-bits", network)
}

fn recurrent_bits(plan: &Plan, bits: f64) -> Work {
    let mut network = plan.in_bits(WORD_BITS).clone();
    network.recurrent.iter_mut().for_each(|matrix| keep_bits(matrix, bits as u32));
    fixed("recurrent-bits", network)
}

fn dictionary_bits(plan: &Plan, bits: f64) -> Work {
    let mut network = plan.in_bits(WORD_BITS).clone();
    keep_bits(&mut network.dictionary, bits as u32);
    fixed("dictionary-bits", network)
}

/// Rounds a matrix's words to their first `bits` bits.
pub(super) fn keep_bits(matrix: &mut FixedMatrix, bits: u32) {
    let step = 1i32 << (WORD_BITS - bits);
    let max = i32::from(i16::MAX) / step * step;
    matrix.weights.mapv_inplace(|word| {
        let rounded = (i32::from(word) + step / 2).div_euclid(step) * step;
        rounded.min(max) as i16
    });
}
