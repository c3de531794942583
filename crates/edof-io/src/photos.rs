//! Which photographs an experiment runs on.
//!
//! Photographs are identified by the number in their file's name (`kodim03.png` is 3). Every third one is for tests, the rest
//! for training ([`CHOICES`]).

use crate::{photo, picture};
use edof_core::ColourFrame;
use std::path::{Path, PathBuf};

/// Every how many-th photo is for tests.
const TEST_EVERY: u32 = 3;

/// A photograph, sides even.
#[derive(Debug, Clone)]
pub struct Photo {
    /// File name without its ending.
    pub name: String,
    /// The file's values, 0…1; a [`Tone`](edof_core::Tone) says whether they are light or sRGB.
    pub frame: ColourFrame,
}

/// A choice among numbered photographs.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Selection {
    /// Numbers 3, 6, 9, …
    #[default]
    Test,
    /// All other numbers.
    Train,
    /// Every photograph, numbered or not.
    All,
    /// These numbers.
    Numbers(Vec<u32>),
}

/// Photographs that cannot be had.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PhotosError {
    /// Neither a word nor a list of numbers.
    #[error("photos '{0}': must be test, train, all or numbers such as 3,6")]
    Selection(String),
    /// The folder cannot be listed.
    #[error("{folder}: cannot list: {source}", folder = folder.display())]
    Folder { folder: PathBuf, source: std::io::Error },
    /// No folder given and none found.
    #[error("no folder of photographs: looked for {0}; name one with --images or in EDOF_KODAK")]
    Nowhere(String),
    /// Nothing to work on.
    #[error("{folder}: contains no readable photograph of '{selection}'{first}; choose by --photos, as in --photos all", folder = folder.display())]
    None { folder: PathBuf, selection: Selection, first: String },
}

/// What the test photographs were used for: the same sentence in every document and on every page that reports on them.
pub const CHOICES: &str = "Nothing was trained on the eight test photographs (Kodak 3, 6, … 24). Three choices were made with them in view: the weights of \
                           windows, the length of the second training round, and the headroom of fixed point (docs/decisions, 0005 and 0002).";

/// Photographs of `shared/data/more` that `scripts/held-back.sh` keeps out of every training.
pub const HELD_BACK: [&str; 8] =
    ["more02", "more04", "more09", "more10", "more15", "more16", "more19", "more21"];

/// What pages state that report on [`HELD_BACK`] alone.
pub const OF_HELD_BACK: &str = "These photographs are held back from training (scripts/held-back.sh).";

/// [`CHOICES`] behind a blank, where one of these photographs is for tests; [`OF_HELD_BACK`], where all are held back.
#[must_use]
pub fn choices<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let (held_back, others): (Vec<&str>, Vec<&str>) = names.partition(|name| HELD_BACK.contains(name));
    if others.iter().any(|name| Selection::Test.holds(name)) {
        format!(" {CHOICES}")
    } else if others.is_empty() && !held_back.is_empty() {
        format!(" {OF_HELD_BACK}")
    } else {
        String::new()
    }
}

impl std::str::FromStr for Selection {
    type Err = PhotosError;

    fn from_str(text: &str) -> Result<Self, PhotosError> {
        match text {
            "test" => Ok(Self::Test),
            "train" => Ok(Self::Train),
            "all" => Ok(Self::All),
            _ => {
                let numbers = text.split(',').map(|n| n.trim().parse()).collect::<Result<Vec<u32>, _>>();
                numbers.map(Self::Numbers).map_err(|_| PhotosError::Selection(text.to_owned()))
            }
        }
    }
}

impl std::fmt::Display for Selection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Test => f.write_str("test"),
            Self::Train => f.write_str("train"),
            Self::All => f.write_str("all"),
            Self::Numbers(numbers) => {
                f.write_str(&numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(","))
            }
        }
    }
}

impl Selection {
    /// Whether a file of that stem belongs to the choice.
    #[must_use]
    pub fn holds(&self, stem: &str) -> bool {
        match (self, number(stem)) {
            (Self::All, _) => true,
            (Self::Test, Some(n)) => n % TEST_EVERY == 0,
            (Self::Train, Some(n)) => n % TEST_EVERY != 0,
            (Self::Numbers(numbers), Some(n)) => numbers.contains(&n),
            (_, None) => false,
        }
    }
}

/// The number at the end of a file's stem, modulo [`TEST_EVERY`]·10⁹ where it has more digits than nine: cameras put dates there, and
/// every third must stay every third.
fn number(stem: &str) -> Option<u32> {
    let digits = &stem[stem.trim_end_matches(|c: char| c.is_ascii_digit()).len()..];
    let add = |sum: u64, digit: char| (sum * 10 + u64::from(digit.to_digit(10).unwrap_or(0))) % WRAP;
    (!digits.is_empty()).then(|| digits.chars().fold(0, add) as u32)
}

/// Numbers are known up to this: a multiple of [`TEST_EVERY`] that 32 bits hold.
const WRAP: u64 = 1_000_000_000 * TEST_EVERY as u64;

/// The folder of test and training photographs: `EDOF_KODAK`, else `shared/data/kodak` beside the working folder, beside one
/// above it, or beside the folder the program was built in.
///
/// # Errors
/// [`PhotosError::Nowhere`].
pub fn default_folder() -> Result<PathBuf, PhotosError> {
    if let Some(folder) = std::env::var_os("EDOF_KODAK") {
        return Ok(folder.into());
    }
    let candidates = candidates("shared/data/kodak");
    let found = candidates.iter().find(|folder| folder.is_dir()).cloned();
    found.ok_or_else(|| {
        let list: Vec<String> = candidates.iter().map(|f| f.display().to_string()).collect();
        PhotosError::Nowhere(list.join(", "))
    })
}

/// The folder of further photographs to train on, where there is one: `EDOF_MORE` (none where that is empty), else
/// `shared/data/more`, looked for as [`default_folder`] looks for its own.
#[must_use]
pub fn more_folder() -> Option<PathBuf> {
    match std::env::var_os("EDOF_MORE") {
        Some(folder) => Some(folder.into()).filter(|folder: &PathBuf| !folder.as_os_str().is_empty()),
        None => candidates("shared/data/more").into_iter().find(|folder| folder.is_dir()),
    }
}

/// Where a folder that comes beside the project may lie.
fn candidates(folder: &str) -> Vec<PathBuf> {
    let working = std::env::current_dir().unwrap_or_default();
    let built = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    working.ancestors().skip(1).chain([built.join("..").as_path()]).map(|f| f.join(folder)).collect()
}

/// Whether a folder has photographs and none of them a number.
#[must_use]
pub fn has_no_numbers(folder: &Path) -> bool {
    let files = picture::of_folder(folder).unwrap_or_default();
    !files.is_empty() && files.iter().all(|file| number(&stem(file)).is_none())
}

/// Photographs of a folder.
#[derive(Debug)]
pub struct Chosen {
    /// Those that were chosen, in the order of their names.
    pub photos: Vec<Photo>,
    /// A line for each that could not be read.
    pub skipped: Vec<String>,
    /// A line for each that states another transfer curve than sRGB's.
    pub remarks: Vec<String>,
}

/// Reads the chosen photographs of a folder.
///
/// # Errors
/// [`PhotosError::Folder`], or [`PhotosError::None`] where no photograph is left.
pub fn load(folder: &Path, selection: &Selection) -> Result<Chosen, PhotosError> {
    let cannot = |source| PhotosError::Folder { folder: folder.to_owned(), source };
    let mut files = picture::of_folder(folder).map_err(cannot)?;
    files.retain(|path| selection.holds(&stem(path)));
    let (mut photos, mut skipped, mut remarks) = (vec![], vec![], vec![]);
    for path in files {
        match photo::open_found(&path) {
            Ok(photograph) => {
                remarks.extend(photograph.remarks(&path));
                photos.push(Photo { name: stem(&path), frame: even(photograph.frame) });
            }
            Err(error) => skipped.push(error.to_string()),
        }
    }
    if photos.is_empty() {
        let first = skipped.first().map(|s| format!(" ({s})")).unwrap_or_default();
        return Err(PhotosError::None { folder: folder.to_owned(), selection: selection.clone(), first });
    }
    Ok(Chosen { photos, skipped, remarks })
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Without the last row or column where a side is odd: a Bayer sensor has whole 2×2 cells.
fn even(frame: ColourFrame) -> ColourFrame {
    let (height, width) = frame.size();
    if height % 2 == 0 && width % 2 == 0 { frame } else { frame.crop(0, 0, height & !1, width & !1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_state_what_their_photographs_were_used_for() {
        let said = |names: &[&str]| choices(names.iter().copied());
        assert_eq!(said(&["kodim03", "kodim01"]), format!(" {CHOICES}"));
        assert_eq!(said(&["more09", "more15"]), format!(" {OF_HELD_BACK}"));
        assert_eq!(said(&["more09", "mine01"]), "");
        assert_eq!(said(&[]), "");
    }

    #[test]
    fn test_and_train_photos_share_none() {
        let stems: Vec<String> = (1..=24).map(|n| format!("kodim{n:02}")).collect();
        let test: Vec<_> = stems.iter().filter(|s| Selection::Test.holds(s)).collect();
        assert_eq!(test.len(), 8);
        assert!(stems.iter().all(|s| Selection::Test.holds(s) != Selection::Train.holds(s)));
        assert!(!Selection::Train.holds("portrait"));
    }

    #[test]
    fn a_name_that_ends_in_a_long_number_belongs_to_one_set() {
        let stems = [
            "IMG_20231107153012",
            "20231107153013",
            "dsc_00000000000000000000000000000000000004",
            "4294967296",
        ];
        for stem in stems {
            assert!(Selection::Test.holds(stem) != Selection::Train.holds(stem), "{stem}");
        }
        // Digits add up to a multiple of three, and so does the number.
        assert!(Selection::Test.holds("20231107153014") && !Selection::Test.holds("20231107153013"));
        assert!(Selection::Numbers(vec![4]).holds(stems[2]));
    }

    #[test]
    fn selections_read_as_they_print() {
        for text in ["test", "train", "all", "3,6"] {
            assert_eq!(text.parse::<Selection>().unwrap().to_string(), text);
        }
        assert_eq!(
            "3,x".parse::<Selection>().unwrap_err().to_string(),
            "photos '3,x': must be test, train, all or numbers such as 3,6"
        );
    }

    #[test]
    fn an_unreadable_photo_is_named_and_the_good_ones_stay() {
        let dir = tempfile::tempdir().unwrap();
        let image = image::RgbImage::from_pixel(21, 16, image::Rgb([51, 102, 255]));
        image.save(dir.path().join("p03.png")).unwrap();
        std::fs::write(dir.path().join("p06.png"), b"no picture").unwrap();
        std::fs::write(dir.path().join("p09.txt"), b"no picture either").unwrap();
        let Chosen { photos, skipped, .. } = load(dir.path(), &Selection::Test).unwrap();
        assert_eq!(photos.len(), 1);
        assert_eq!((photos[0].name.as_str(), photos[0].frame.size()), ("p03", (16, 20)));
        assert!((photos[0].frame.planes[(0, 3, 3)] - 0.2).abs() < 1e-6);
        assert!(skipped.len() == 1 && skipped[0].contains("p06.png"), "{skipped:?}");
    }

    #[test]
    fn a_folder_without_photos_is_rejected() {
        let dir = tempfile::tempdir().unwrap();
        let error = load(dir.path(), &Selection::Test).unwrap_err().to_string();
        assert!(error.contains("contains no readable photograph of 'test'; choose by --photos"), "{error}");
        assert!(matches!(load(Path::new("/nonexistent"), &Selection::All), Err(PhotosError::Folder { .. })));
    }
}
