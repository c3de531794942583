//! What a case runs, as data: each kind of trial with its parameters.

use edof_core::{CfaPhase, Noise};
use serde::{Deserialize, Serialize};

/// What is run. The module of each kind says what its parameters mean and what is compared with what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Trial {
    /// A scene behind a camera, and every method on its frame.
    Frame(Frame),
    /// A frame that is read with another phase than it was taken with.
    Phase {
        /// As it was taken.
        taken: CfaPhase,
        /// As it is read.
        read: CfaPhase,
    },
    /// Methods on a frame of this size, or their error.
    Size {
        /// Rows.
        height: usize,
        /// Columns.
        width: usize,
    },
    /// A frame of N megapixels through the golden pipeline.
    Megapixels(usize),
    /// A network of words driven to its ends.
    Words(Words),
    /// A network's bounds of error.
    Bounds {
        /// Name of the network, or `drawn-WINDOW-STRIDE`.
        network: String,
    },
    /// OMP, ISTA and FISTA.
    Pursuit {
        /// The dictionary.
        dictionary: Atoms,
        /// The signals.
        signals: Signals,
        /// What a penalty is, of the largest correlation with an atom.
        #[serde(default = "a_tenth")]
        penalty: f64,
        /// Steps of ISTA and FISTA.
        #[serde(default = "two_thousand")]
        steps: usize,
    },
    /// k-SVD from this dictionary.
    Learning {
        /// Where it starts.
        dictionary: Atoms,
    },
    /// A system of equations.
    Solve(System),
    /// A map fitted for noise of one σ that meets noise of another.
    Fitted {
        /// σ that it is fitted for.
        trained: f64,
        /// σ that it meets.
        met: f64,
    },
    /// A lens's PSFs and blur.
    Lens(Lens),
    /// A plane, blurred and deconvolved.
    Deblur {
        /// The picture.
        picture: Scene,
        /// The kernel that blurs it, and that the methods are given.
        kernel: Kernel,
        /// Wiener's ratio of noise to contrast.
        #[serde(default = "a_thousandth")]
        ratio: f64,
        /// Rows and columns.
        #[serde(default = "a_small_plane")]
        size: [usize; 2],
    },
    /// Sums, tables and steps.
    Numbers(Numbers),
    /// Something that must be rejected.
    Refusal(Refusal),
}

const fn a_tenth() -> f64 {
    0.1
}

const fn a_thousandth() -> f64 {
    0.001
}

const fn two_thousand() -> usize {
    2000
}

const fn a_small_plane() -> [usize; 2] {
    [40, 56]
}

/// A raw frame, and which methods see it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// What is before the camera.
    pub scene: Scene,
    /// Depth of the scene.
    #[serde(default)]
    pub psi: f64,
    /// The sensor's noise.
    #[serde(default)]
    pub noise: Noise,
    /// The sensor's bits.
    #[serde(default = "twelve")]
    pub depth: u32,
    /// Pixels of the sensor that are broken.
    #[serde(default)]
    pub defects: Option<Defects>,
    /// The camera that takes the frame, where it is not each network's own.
    #[serde(default)]
    pub camera: Option<String>,
    /// Whether the fixed networks must not saturate.
    #[serde(default)]
    pub natural: bool,
    /// Networks alone, where other methods have said all in another case.
    #[serde(default)]
    pub nets_only: bool,
}

const fn twelve() -> u32 {
    12
}

/// Broken pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Defects {
    /// N, far from each other, at the sensor's largest value.
    Hot(usize),
    /// N at 0.
    Dead(usize),
    /// A whole column at 0.
    DeadColumn,
}

/// A scene, light of 0…1 unless it says otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Scene {
    /// One colour.
    Flat([f32; 3]),
    /// Squares of N pixels, black and white.
    Checkerboard(usize),
    /// A cosine of a period in pixels, turned by degrees from upright.
    Stripes {
        /// Pixels from crest to crest.
        period: f64,
        /// Degrees.
        degrees: f64,
    },
    /// Light at the sites of one colour's filter alone: 0 red, 1 green, 2 blue.
    Sites(usize),
    /// Discs of this light on black.
    Discs(f32),
    /// Single pixels of this light on black.
    Points(f32),
    /// A step from 0 to this light, a little turned.
    Step(f32),
    /// The built-in dead leaves.
    Leaves,
    /// The built-in chart.
    Chart,
    /// Leaves at one depth before leaves at another, with an edge through patches.
    DepthEdge {
        /// Depth of what is in front.
        front: f64,
    },
}

/// A network of words and what goes through it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Words {
    /// Which network.
    pub network: WordNetwork,
    /// Which windows.
    pub windows: Windows,
}

/// Networks of words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum WordNetwork {
    /// A trained one by its name.
    Trained(String),
    /// Random: weights and thresholds mostly at the ends of their range.
    Drawn {
        /// Window side.
        window: usize,
        /// T.
        layers: usize,
        /// Bits of weights and codes.
        bits: u32,
        /// One-sided shrinkage, difference form, linear path, tied.
        flags: [bool; 4],
        /// All shifts zero.
        tight: bool,
        /// Replacement of the random words.
        #[serde(default)]
        with: Option<Instead>,
    },
}

/// Replacement of random words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Instead {
    /// Every weight 32767 or −32768 (of its width), by turns.
    WeightsAtBothEnds,
    /// Every weight the largest.
    LargestWeights,
    /// No weight but 0.
    NoWeights,
    /// Every threshold 0.
    ThresholdsZero,
    /// Every threshold the largest word.
    ThresholdsHuge,
    /// Every threshold the least word.
    ThresholdsLeast,
    /// Enough fraction bits that results are shifted by up to 47 bits.
    LongestShifts,
}

/// Windows of input words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Windows {
    /// Anywhere in their range, mostly at its ends.
    Extreme,
    /// For each row of A, and of R, the two that make its sum largest and least.
    BySignsOfRows,
    /// Climbing: words changed one by one as long as a sum of the last stages grows.
    Climbing,
}

/// Dictionaries that pursuits do not like; 16 long, 24 atoms unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Atoms {
    /// Random atoms of norm 1.
    Drawn,
    /// All within 10⁻³ of one direction.
    Coherent,
    /// Every atom twice.
    Duplicates,
    /// A third of them nothing.
    Zeros,
    /// A third of them 10⁻³⁰ long.
    NearZeros,
    /// All in a space of 5 dimensions.
    RankDeficient,
    /// Lengths from 10⁻⁶ to 10⁶.
    Scales,
    /// An eigenvector of DᵀD that the power iteration's start is at right angles to has the largest eigenvalue.
    HiddenEigenvalue,
}

/// Signals for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Signals {
    /// Random.
    Drawn,
    /// Nothing.
    Zero,
    /// Sums of three atoms: after them only rounding is left.
    Exact,
    /// Random, of norm 10¹².
    Huge,
    /// Random, of norm 10⁻¹².
    Tiny,
}

/// A system of equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum System {
    /// Hilbert's matrix of N rows, for the Cholesky factor.
    Hilbert(usize),
    /// Moments of rank 1, for the factor that lifts pivots.
    RankOneMoments(usize),
    /// Least squares where each input stands twice.
    TwinInputs,
    /// Least squares where an input is always 0.
    DeadInput,
    /// Least squares of fewer samples than inputs.
    FewSamples,
}

/// A lens at the edge of what can be computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lens {
    /// The camera that it starts from.
    pub camera: String,
    /// Depth.
    pub psi: f64,
    /// Another radius of the aperture, millimetres.
    #[serde(default)]
    pub aperture_radius_mm: Option<f64>,
    /// Another distance between pixels, micrometres.
    #[serde(default)]
    pub pixel_pitch_um: Option<f64>,
    /// Sides of the plane that is blurred.
    #[serde(default = "sixteen")]
    pub plane: usize,
}

const fn sixteen() -> usize {
    16
}

/// A blur kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kernel {
    /// One pixel.
    Point,
    /// A square of N pixels: frequencies of it are exactly nothing.
    Box(usize),
    /// Nothing is known: the blind method looks for one of N pixels.
    Blind(usize),
}

/// Sums, tables and steps at the ends of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Numbers {
    /// PSNR over a frame of N megapixels whose error is known.
    PsnrOfMegapixels(usize),
    /// SSIM of frames of one grey.
    SsimOfFlat,
    /// Every 32-bit light through a colour's table, thinned out, and every end.
    GammaIndex,
    /// Frames of every pair of extreme words through the display step, in both modes.
    DisplayOfExtremes,
    /// Overlap sums at their largest and least.
    OverlapSums,
    /// A gradient in `f32` against `f64`.
    GradientInSingle,
    /// Adam where the gradient is nothing, and where it is enormous.
    Adam,
    /// A sensor in no light, in light of 10³⁰, in light below nothing.
    SensorOfAnyLight,
    /// Rounding and saturation at every shift and width, against integers of 128 bits.
    Requantize,
}

/// Something that cannot be right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Refusal {
    /// Weights and shifts whose sums may need more than 48 bits.
    WideSums,
    /// A shift beyond 47.
    LongShift,
    /// Fraction bits that would need a shift to the left.
    NegativeShift,
    /// A weight that its width does not hold.
    WideWeight,
    /// A negative threshold where shrinkage is two-sided.
    NegativeThreshold,
    /// Formats that differ in the difference form.
    UnequalFractions,
    /// A float weight that is NaN.
    WeightNoNumber,
    /// An infinite threshold.
    InfiniteThreshold,
    /// One layer.
    FewLayers,
    /// Seven bits.
    FewBits,
    /// Headroom that is NaN.
    Headroom,
    /// A sensor of seven bits.
    SensorBits,
    /// A value that the sensor's bits do not hold.
    WideValue,
    /// Noise of more than full scale.
    MuchNoise,
    /// A full scale of less than an electron.
    LessThanAnElectron,
    /// A camera with a NaN.
    CameraNoNumber,
    /// Depth that is NaN.
    PsiNoNumber,
    /// A scene's depth that is NaN.
    ScenePsiNoNumber,
    /// A kernel that makes light.
    KernelSum,
    /// A kernel without a middle pixel.
    KernelSide,
    /// A table that is too short.
    ShortTable,
    /// A table's entry of more than 12 bits.
    WideEntry,
    /// Pictures of two sizes compared.
    TwoSizes,
    /// Pictures too small for a border.
    SmallPicture,
}
