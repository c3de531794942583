//! A hard case, as data: what it is for, what is run, what could go wrong, and what is promised.

use edof_image::{CfaPhase, Noise};
use edof_storage::json;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// One case of the suite, as its file holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Its name: small letters, digits and dashes.
    pub id: String,
    /// Why it is there, in one line.
    pub intent: String,
    /// What could go wrong.
    pub danger: String,
    /// What is run.
    pub trial: Trial,
    /// What is promised.
    pub promise: Promise,
    /// Whether it takes more than moments: left out of the quick run.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slow: bool,
}

/// What is promised of everything that a case runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Promise {
    /// The same result as the reference, to an error in the units that the trial states.
    Same {
        /// The largest difference.
        error: f64,
        /// Why this much.
        because: String,
        /// Methods that may be further off, by the beginning of their names.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        except: Vec<Exception>,
    },
    /// The same result to an error that follows from formats and weights before anything is run.
    Bounded {
        /// From what it follows.
        because: String,
    },
    /// A loss of so many dB at most.
    Graceful {
        /// The largest loss.
        db: f64,
        /// Loss against what, and why this much.
        because: String,
        /// Methods that may lose more, by the beginning of their names.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        except: Vec<Exception>,
    },
    /// A refusal whose message holds these words.
    Refused {
        /// A part of the message.
        says: String,
    },
}

/// A method with a limit of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exception {
    /// The beginning of its name.
    pub method: String,
    /// The largest error or loss.
    pub limit: f64,
    /// Why this much.
    pub because: String,
}

impl Promise {
    /// In a few words.
    #[must_use]
    pub fn words(&self) -> String {
        match self {
            Self::Same { error, .. } => format!("same, to {}", short(*error)),
            Self::Bounded { .. } => "same, to a bound told before".to_owned(),
            Self::Graceful { db, .. } => format!("loses {db} dB at most"),
            Self::Refused { says } => format!("refused: “{says}”"),
        }
    }

    /// Why the limit is what it is.
    #[must_use]
    pub fn because(&self) -> String {
        match self {
            Self::Same { because, except, .. } | Self::Graceful { because, except, .. } => {
                let each = |e: &Exception| format!("; {}: {}, {}", e.method, short(e.limit), e.because);
                format!("{because}{}", except.iter().map(each).collect::<String>())
            }
            Self::Bounded { because } => because.clone(),
            Self::Refused { .. } => "what cannot be right is not run".to_owned(),
        }
    }

    /// The limit for one method or solver; none for bounds that the trial computes and for refusals.
    #[must_use]
    pub fn limit(&self, subject: &str) -> Option<f64> {
        let own = |limit: f64, except: &[Exception]| {
            let own = except.iter().find(|e| subject.starts_with(&e.method));
            Some(own.map_or(limit, |e| e.limit))
        };
        match self {
            Self::Same { error, except, .. } => own(*error, except),
            Self::Graceful { db, except, .. } => own(*db, except),
            Self::Bounded { .. } | Self::Refused { .. } => None,
        }
    }
}

/// A number with three digits that matter.
#[must_use]
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (0.01..1e5).contains(&size) => {
            let decimals = (2.0 - size.log10().floor()).clamp(0.0, 4.0) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.1e}"),
    }
}

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
    /// Methods on a frame of this size, or their refusal.
    Size {
        /// Rows.
        height: usize,
        /// Columns.
        width: usize,
    },
    /// A frame of so many megapixels through the golden pipeline.
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
    /// Something that must be refused.
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
    /// Its depth.
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
    /// So many, far from each other, at the sensor's largest value.
    Hot(usize),
    /// So many at 0.
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
    /// Squares of so many pixels, black and white.
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
    /// Drawn: weights and thresholds mostly at the ends of their range.
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
        /// What is put in place of what was drawn.
        #[serde(default)]
        with: Option<Instead>,
    },
}

/// What is put in place of drawn words.
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
    /// Fraction bits so many that results are shifted as far as 47 bits allow.
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
    /// Drawn ones of norm 1.
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
    /// Drawn.
    Drawn,
    /// Nothing.
    Zero,
    /// Sums of three atoms: after them only rounding is left.
    Exact,
    /// Drawn, 10¹² long.
    Huge,
    /// Drawn, 10⁻¹² long.
    Tiny,
}

/// A system of equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum System {
    /// Hilbert's matrix of so many rows, for the Cholesky factor.
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
    /// A square of so many pixels: frequencies of it are exactly nothing.
    Box(usize),
    /// Nothing is known: the blind method looks for one of so many pixels.
    Blind(usize),
}

/// Sums, tables and steps at the ends of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Numbers {
    /// PSNR over a frame of so many megapixels whose error is known.
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
    /// A float weight that is no number.
    WeightNoNumber,
    /// An infinite threshold.
    InfiniteThreshold,
    /// One layer.
    FewLayers,
    /// Seven bits.
    FewBits,
    /// Headroom that is no number.
    Headroom,
    /// A sensor of seven bits.
    SensorBits,
    /// A value that the sensor's bits do not hold.
    WideValue,
    /// Noise of more than full scale.
    MuchNoise,
    /// A full scale of less than an electron.
    LessThanAnElectron,
    /// A camera with a number that is none.
    CameraNoNumber,
    /// Depth that is no number.
    PsiNoNumber,
    /// A scene's depth that is no number.
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

/// Cases that cannot be read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum CasesError {
    /// A folder or file.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Text that holds no cases.
    #[error("{file}: not a list of cases: {}", json::words(source))]
    Parse { file: String, source: serde_json::Error },
    /// Two of one name, or a name that is none.
    #[error("{file}: case id '{id}': {why}")]
    Id { file: String, id: String, why: &'static str },
    /// Nothing.
    #[error("{0}: no case files (*.json) there")]
    None(String),
}

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../cases/", $name)))),*]
    };
}

/// Most bytes of a file of cases.
const MOST_BYTES: u64 = 1 << 24;

/// The files that come with the program.
const FILES: &[(&str, &str)] = files!(
    "bounds.json",
    "deblurring.json",
    "frames.json",
    "lenses.json",
    "numbers.json",
    "pursuits.json",
    "refusals.json",
    "sizes.json",
    "solves.json",
    "words.json",
);

/// The cases that come with the program.
///
/// # Errors
/// [`CasesError`] where they are broken, which a test would have found.
pub fn own() -> Result<Vec<Case>, CasesError> {
    read(FILES.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())))
}

/// The cases of all JSON files of a folder.
///
/// # Errors
/// [`CasesError`].
pub fn of_folder(folder: &Path) -> Result<Vec<Case>, CasesError> {
    let unreadable = |source| CasesError::Read { path: folder.to_owned(), source };
    let mut paths = vec![];
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        // Whoever opens a pipe may wait for ever.
        if path.extension().is_some_and(|extension| extension == "json") && path.is_file() {
            paths.push(path);
        }
    }
    paths.sort();
    if paths.is_empty() {
        return Err(CasesError::None(folder.display().to_string()));
    }
    let text = |path: PathBuf| match json::text(&path, MOST_BYTES) {
        Ok(text) => Ok((path.display().to_string(), text)),
        Err(source) => Err(CasesError::Read { path, source }),
    };
    read(paths.into_iter().map(text).collect::<Result<Vec<_>, _>>()?)
}

fn read(files: impl IntoIterator<Item = (String, String)>) -> Result<Vec<Case>, CasesError> {
    let mut all: Vec<Case> = vec![];
    let mut ids = BTreeSet::new();
    for (file, text) in files {
        let cases: Vec<Case> =
            json::parse(&text).map_err(|source| CasesError::Parse { file: file.clone(), source })?;
        for case in cases {
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
            let why = if case.id.is_empty() || !case.id.chars().all(plain) {
                Some("must be of small letters, digits and dashes")
            } else if !ids.insert(case.id.clone()) {
                Some("is there twice")
            } else {
                None
            };
            if let Some(why) = why {
                return Err(CasesError::Id { file, id: case.id, why });
            }
            all.push(case);
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_of_one_name_or_of_a_name_that_is_none_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |text: &str| {
            std::fs::write(folder.path().join("a.json"), text).unwrap();
            of_folder(folder.path()).unwrap_err().to_string()
        };
        let one = |id: &str| {
            format!(
                r#"{{"id": "{id}", "intent": "i", "danger": "d", "trial": {{"solve": "twin-inputs"}}, "promise": {{"bounded": {{"because": "b"}}}}}}"#
            )
        };
        assert!(refused(&format!("[{}, {}]", one("a"), one("a"))).ends_with("case id 'a': is there twice"));
        assert!(refused(&format!("[{}]", one("A b"))).contains("must be of small letters"));
        assert!(refused("[{}]").contains("not a list of cases: missing field"));
    }
}
