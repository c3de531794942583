//! The knobs: where each is tried, where it stands, and why.

use super::WORD_BITS;
use edof_image::Noise;
use edof_methods::settings::Pursuit;
use edof_optics::psf::Settings;
use serde::{Deserialize, Serialize};

/// What can be turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knob {
    /// Share of its energy that a kernel is cut to.
    KernelEnergy,
    /// Share of the energy that may lie wrong because a colour is summed over few wavelengths.
    Wavelengths,
    /// Layers that a scene of many depths is cut into.
    Depths,
    /// Pixels from one patch of the network to the next.
    Stride,
    /// Bits of a network's weights and codes.
    Bits,
    /// Bits of the words of A and R, by themselves.
    AnalysisBits,
    /// Bits of the words of every S, by themselves.
    RecurrentBits,
    /// Bits of the words of D, by themselves.
    DictionaryBits,
    /// Sparse codes that may be other than 0 in a patch, after each shrinkage.
    Budget,
    /// T, of networks before training.
    Layers,
    /// Atoms a patch of OMP, besides the colours' own.
    Atoms,
    /// Steps of FISTA.
    Steps,
    /// Side of the raw window that a pursuit sees.
    Window,
    /// σ of the noise that Wiener's filter is prepared for.
    NoiseClass,
}

/// A knob that nobody knows.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("knob '{0}': must be one of {list}", list = Knob::ALL.map(Knob::name).join(", "))]
pub struct UnknownKnob(String);

impl std::str::FromStr for Knob {
    type Err = UnknownKnob;

    fn from_str(text: &str) -> Result<Self, UnknownKnob> {
        Self::ALL.into_iter().find(|knob| knob.name() == text).ok_or_else(|| UnknownKnob(text.to_owned()))
    }
}

impl Knob {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::KernelEnergy,
        Self::Wavelengths,
        Self::Depths,
        Self::Stride,
        Self::Bits,
        Self::AnalysisBits,
        Self::RecurrentBits,
        Self::DictionaryBits,
        Self::Budget,
        Self::Layers,
        Self::Atoms,
        Self::Steps,
        Self::Window,
        Self::NoiseClass,
    ];

    /// What users call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::KernelEnergy => "kernel-energy",
            Self::Wavelengths => "wavelengths",
            Self::Depths => "depths",
            Self::Stride => "stride",
            Self::Bits => "bits",
            Self::AnalysisBits => "analysis-bits",
            Self::RecurrentBits => "recurrent-bits",
            Self::DictionaryBits => "dictionary-bits",
            Self::Budget => "budget",
            Self::Layers => "layers",
            Self::Atoms => "atoms",
            Self::Steps => "steps",
            Self::Window => "window",
            Self::NoiseClass => "noise-class",
        }
    }

    /// Where it is tried.
    #[must_use]
    pub const fn values(self) -> &'static [f64] {
        match self {
            Self::KernelEnergy => &[0.9, 0.99, 0.999, 0.9999],
            Self::Wavelengths => &[0.3, 0.1, 0.03, 0.01, 0.003],
            Self::Depths => &[2.0, 4.0, 8.0, 16.0, 32.0],
            Self::Stride => &[8.0, 4.0, 2.0],
            Self::Bits => &[8.0, 9.0, 10.0, 12.0, 16.0],
            Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits => {
                &[4.0, 6.0, 8.0, 10.0, 12.0, 16.0]
            }
            Self::Budget => &[8.0, 16.0, 32.0, 64.0, 96.0, 192.0],
            Self::Layers => &[3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
            Self::Atoms => &[2.0, 4.0, 8.0, 16.0, 24.0],
            Self::Steps => &[3.0, 4.0, 6.0, 8.0, 10.0, 30.0, 100.0],
            Self::Window => &[8.0, 12.0, 16.0],
            Self::NoiseClass => &[0.0, 0.005, 0.01, 0.02, 0.04],
        }
    }

    /// Where it stands; the noise class stands at the noise that there is.
    pub(super) fn default_value(self, noise: Noise) -> f64 {
        match self {
            Self::KernelEnergy => Settings::default().energy,
            Self::Wavelengths => Settings::default().wavelength_tolerance,
            Self::Depths | Self::Bits => 16.0,
            Self::Atoms => match Pursuit::OMP {
                Pursuit::Omp { atoms } => atoms as f64,
                Pursuit::Fista { .. } => unreachable!("matching pursuit is none"),
            },
            Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits => 16.0,
            Self::Budget => 192.0,
            Self::Layers => 4.0,
            Self::Stride | Self::Window => 8.0,
            Self::Steps => match Pursuit::FISTA {
                Pursuit::Fista { steps, .. } => steps as f64,
                Pursuit::Omp { .. } => unreachable!("FISTA is none"),
            },
            Self::NoiseClass => match noise {
                Noise::Gaussian { sigma } => sigma,
                Noise::None | Noise::Sensor(_) => 0.0,
            },
        }
    }

    /// What it is, and why its default stands where it does.
    pub(super) fn reason(self) -> &'static str {
        match self {
            Self::KernelEnergy => {
                "Kernels are cut to the smallest square that keeps a share of their energy. Error of the light on the sensor against whole kernels. \
                 0.999: the error is far below a sensor's noise, and a kernel is a few dozen pixels wide instead of hundreds."
            }
            Self::Wavelengths => {
                "Of a colour with a spectrum (here bands of 60 nm around the camera's lines), wavelengths are added until the kernel moves by less than a share of \
                 its energy. Error of the light against the most wavelengths. 0.01: below what the kernels' cut costs."
            }
            Self::Depths => {
                "A scene whose depth rises evenly over the camera's range, cut into so many layers of one kernel each. Error of the light against 64 layers. 16: half a \
                 radian a layer, half of the 1 rad between the depths that networks are trained for."
            }
            Self::Stride => {
                "Patches of the float network overlap at strides 4 and 2 and are averaged. 8: four and sixteen times the work for what the curve shows; 60 frames \
                 a second are within reach at stride 8 alone."
            }
            Self::Bits => {
                "Weights and codes of the fixed network, quantized for so many bits with nothing trained after. 16: what the board's multipliers take without \
                 costing more of them. Time is that of the software model, which does not depend on bits; what it saves is memory on the board."
            }
            Self::AnalysisBits => {
                "Words of A and of the linear path R of the fixed network rounded to so many bits, all else 16. 16: as for all words. Where the curve is flat the board's memory \
                 holds bits that no picture needs."
            }
            Self::RecurrentBits => {
                "Words of every S of the fixed network rounded to so many bits, all else 16. 16: as for all words. S is most of the network's memory."
            }
            Self::DictionaryBits => {
                "Words of D of the fixed network rounded to so many bits, all else 16. 16: as for all words."
            }
            Self::Budget => {
                "Sparse codes of a patch that may be other than 0 after each shrinkage of the float network, the largest; all others are dropped. 192: all, no budget. A board that \
                 skips zeros takes cycles by the non-zeros of the busiest stage, so a budget bounds its time; here time is that of a program that skips nothing."
            }
            Self::Layers => {
                "T of the paper's network before training, each colour's mean taken out: ISTA in the pursuits' dictionary, cut off. 4: what the board runs. Networks trained for \
                 other T stand in docs/results/layers.md; the curve says what a layer adds where training has not made up for it."
            }
            Self::Atoms => {
                "Atoms that orthogonal matching pursuit may use in a patch, ψ known. 16: chosen without noise (docs/decisions/0015-single-depth.md); with noise \
                 fewer may be better."
            }
            Self::Steps => {
                "Steps of FISTA in the dictionary, ψ known: what a network of so many layers would do without having been trained. 100: where it stands \
                 still. A trained network does it in four."
            }
            Self::Window => {
                "Side of the raw window that OMP sees around a patch, ψ known. 8: the paper's, which all pursuits of the studies keep. A wider window sees the light that a blur \
                 carries across a patch's border, and much that no atom of the patch explains, at which the pursuit spends its atoms: it is worse."
            }
            Self::NoiseClass => {
                "Wiener's filter, ψ known, prepared for a σ that is not always the one that there is. The default is the noise itself: networks have two banks for \
                 the same reason. Less may be better on photographs that vary more than the filter takes for granted."
            }
        }
    }

    /// What its numbers are.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Self::KernelEnergy => "share of the energy kept",
            Self::Wavelengths => "share of the energy that may move",
            Self::Depths => "layers",
            Self::Stride | Self::Window => "pixels",
            Self::Bits | Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits => "bits",
            Self::Budget => "non-zeros a patch",
            Self::Layers => "layers",
            Self::Atoms => "atoms",
            Self::Steps => "steps",
            Self::NoiseClass => "σ prepared for",
        }
    }

    /// Whether it takes bits from the words of one matrix.
    pub(super) const fn is_of_words(self) -> bool {
        matches!(self, Self::AnalysisBits | Self::RecurrentBits | Self::DictionaryBits)
    }

    /// Numbers of bits that a plan's fixed networks must have for it.
    #[must_use]
    pub fn quantized_bits(self) -> Vec<u32> {
        match self {
            Self::Bits => self.values().iter().map(|&bits| bits as u32).collect(),
            knob if knob.is_of_words() => vec![WORD_BITS],
            _ => vec![],
        }
    }
}
