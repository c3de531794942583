//! The dictionary of sharp 8×8 colour patches that pursuits reconstruct with (paper §3), learned by k-SVD, and its file.

use edof_core::colour::RGB_OUTPUTS;
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::digest::sha256;
use edof_core::storage::input;
use edof_core::storage::provenance::Provenance;
use edof_io::photos::Photo;
use edof_numerics::random::Random;
use edof_numerics::sparse::ksvd::{Settings, ksvd_with};
use ndarray::{Array2, Axis, s};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io::Read;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// The first atoms of a dictionary are one colour each, without pattern: every patch may use them.
pub const FREE: usize = 3;
/// More than the file of the largest dictionary has; what is longer is cut, and then no whole file.
const MAX_BYTES: u64 = 16 << 20;
const TENSOR: &str = "dictionary";
const METADATA: &str = "edof-dictionary";
/// The one that comes with the program.
const EMBEDDED: &[u8] = include_bytes!("../../data/dictionary-192.safetensors");
const EMBEDDED_NAME: &str = "dictionary-192.safetensors";

/// How a dictionary is learned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// Atoms, the three of one colour among them.
    pub atoms: usize,
    /// Atoms that a patch may use besides those.
    pub sparsity: usize,
    /// Patches that are learned from.
    pub patches: usize,
    /// Rounds of k-SVD.
    pub rounds: usize,
    /// Seed of which patches.
    pub seed: u64,
}

/// A dictionary and how it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Dictionary {
    /// 192 × atoms; rows are red, green and blue, each 8×8.
    pub atoms: Array2<f32>,
    /// How.
    pub recipe: Recipe,
    /// Root mean square of what is left of a value of a patch, light of 0…1, in the last round.
    pub error: f64,
    /// SHA-256 of the file.
    pub sha256: String,
}

/// A dictionary that cannot be had.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum DictionaryError {
    /// A number out of range.
    #[error("{option} {value}: must be {min} to {max}")]
    Recipe { option: &'static str, value: usize, min: usize, max: usize },
    /// A photograph without a patch.
    #[error("{0}: smaller than a patch of 8x8 pixels")]
    Small(String),
    /// Cannot be opened.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// Something else than a dictionary.
    #[error("{path}: not a dictionary of edof study dictionary: {reason}", path = path.display())]
    Foreign { path: PathBuf, reason: String },
    /// Cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

#[derive(Serialize, Deserialize)]
struct Metadata {
    recipe: Recipe,
    error: f64,
    provenance: Provenance,
}

impl Recipe {
    fn check(&self) -> Result<(), DictionaryError> {
        let within = |option, value, min, max| {
            if (min..=max).contains(&value) {
                Ok(())
            } else {
                Err(DictionaryError::Recipe { option, value, min, max })
            }
        };
        within("--atoms", self.atoms, FREE + 1, 4096)?;
        within("--sparsity", self.sparsity, 1, 64)?;
        within("--patches", self.patches, self.atoms, 1_000_000)?;
        within("--rounds", self.rounds, 1, 1000)
    }
}

/// Learns a dictionary from photographs whose values are taken for light. The same photographs and recipe give the same one.
///
/// # Errors
/// [`DictionaryError::Recipe`] or [`DictionaryError::Small`].
pub fn learn(photos: &[Photo], recipe: Recipe) -> Result<(Array2<f32>, f64), DictionaryError> {
    learn_with(photos, recipe, |_, _| ControlFlow::Continue(()))
}

/// The same with a call after each round, which gets its number and error and may end the work: then the dictionary of the rounds until then.
///
/// # Errors
/// As [`learn`].
pub fn learn_with(
    photos: &[Photo],
    recipe: Recipe,
    each: impl FnMut(usize, f64) -> ControlFlow<()>,
) -> Result<(Array2<f32>, f64), DictionaryError> {
    recipe.check()?;
    let patches = patches(photos, recipe)?;
    let mut start = Array2::zeros((RGB_OUTPUTS, recipe.atoms));
    for (plane, mut atom) in start.axis_iter_mut(Axis(1)).take(FREE).enumerate() {
        atom.slice_mut(s![plane * PATCH_PIXELS..(plane + 1) * PATCH_PIXELS]).fill(1.0 / PATCH as f32);
    }
    start
        .axis_iter_mut(Axis(1))
        .skip(FREE)
        .zip(patches.outer_iter())
        .for_each(|(mut atom, patch)| atom.assign(&patch));
    let settings = Settings { atoms: recipe.sparsity, rounds: recipe.rounds, free: FREE };
    let fitted = ksvd_with(patches.view(), start, settings, each);
    let error = fitted.errors.last().copied().unwrap_or(f64::NAN);
    Ok((fitted.dictionary, error))
}

/// Random patches (rows of 192), as many of each photograph.
fn patches(photos: &[Photo], recipe: Recipe) -> Result<Array2<f32>, DictionaryError> {
    let mut random = Random::new(recipe.seed, 0, 0);
    let mut all = Array2::zeros((recipe.patches, RGB_OUTPUTS));
    for (i, mut patch) in all.outer_iter_mut().enumerate() {
        let photo = &photos[i % photos.len()];
        let (height, width) = photo.frame.size();
        if height < PATCH || width < PATCH {
            return Err(DictionaryError::Small(photo.name.clone()));
        }
        let (top, left) = (random.below(height - PATCH + 1), random.below(width - PATCH + 1));
        let block = photo.frame.planes.slice(s![.., top..top + PATCH, left..left + PATCH]);
        patch.iter_mut().zip(block).for_each(|(to, &value)| *to = value);
    }
    Ok(all)
}

/// Writes a dictionary as safetensors: the tensor `dictionary` (192 × atoms, F32), and how it was made in the metadata.
///
/// # Errors
/// [`DictionaryError::Write`].
pub fn save(
    path: &Path,
    atoms: &Array2<f32>,
    recipe: Recipe,
    error: f64,
    provenance: Provenance,
) -> Result<(), DictionaryError> {
    let foreign = |reason: String| DictionaryError::Foreign { path: path.to_owned(), reason };
    let metadata = Metadata { recipe, error, provenance: provenance.for_file() };
    let text = serde_json::to_string(&metadata).map_err(|e| foreign(e.to_string()))?;
    let bytes: Vec<u8> = atoms.iter().flat_map(|v| v.to_le_bytes()).collect();
    let view = TensorView::new(Dtype::F32, vec![atoms.nrows(), atoms.ncols()], &bytes)
        .map_err(|e| foreign(e.to_string()))?;
    let file = safetensors::serialize([(TENSOR, view)], Some(HashMap::from([(METADATA.to_owned(), text)])))
        .map_err(|e| foreign(e.to_string()))?;
    Ok(atomic::write(path, &file)?)
}

impl Dictionary {
    /// A dictionary from a file of [`save`]; by default the built-in one.
    ///
    /// # Errors
    /// [`DictionaryError::Read`] or [`DictionaryError::Foreign`].
    pub fn load(path: Option<&Path>) -> Result<Self, DictionaryError> {
        match path {
            None => Self::parse(EMBEDDED, Path::new(EMBEDDED_NAME)),
            Some(path) => {
                let mut bytes = vec![];
                let read = input::open(path).and_then(|file| file.take(MAX_BYTES).read_to_end(&mut bytes));
                read.map_err(|source| DictionaryError::Read { path: path.to_owned(), source })?;
                Self::parse(&bytes, path)
            }
        }
    }

    fn parse(bytes: &[u8], path: &Path) -> Result<Self, DictionaryError> {
        let foreign =
            |reason: &str| DictionaryError::Foreign { path: path.to_owned(), reason: reason.to_owned() };
        let (_, header) =
            SafeTensors::read_metadata(bytes).map_err(|_| foreign("no whole safetensors file"))?;
        let text = header.metadata().as_ref().and_then(|all| all.get(METADATA));
        let text = text.ok_or_else(|| foreign("its metadata contains no entry 'edof-dictionary'"))?;
        let metadata: Metadata = serde_json::from_str(text).map_err(|e| foreign(&e.to_string()))?;
        let tensors = SafeTensors::deserialize(bytes).map_err(|_| foreign("no whole safetensors file"))?;
        let tensor = tensors.tensor(TENSOR).map_err(|_| foreign("it contains no tensor 'dictionary'"))?;
        let atoms = metadata.recipe.atoms;
        if tensor.dtype() != Dtype::F32 || tensor.shape() != [RGB_OUTPUTS, atoms] || atoms <= FREE {
            return Err(foreign(&format!("its tensor must be F32 of {RGB_OUTPUTS}x{atoms}")));
        }
        let values: Vec<f32> =
            tensor.data().as_chunks::<4>().0.iter().map(|&word| f32::from_le_bytes(word)).collect();
        if !values.iter().all(|v| v.is_finite()) {
            return Err(foreign("it holds values that are no numbers"));
        }
        let values =
            Array2::from_shape_vec((RGB_OUTPUTS, atoms), values).map_err(|e| foreign(&e.to_string()))?;
        Ok(Self { atoms: values, recipe: metadata.recipe, error: metadata.error, sha256: sha256(bytes) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::ColourFrame;

    const RECIPE: Recipe = Recipe { atoms: 12, sparsity: 2, patches: 300, rounds: 3, seed: 1 };

    fn photo() -> Photo {
        let mut frame = ColourFrame::zeros(40, 48);
        frame
            .planes
            .indexed_iter_mut()
            .for_each(|((p, r, c), v)| *v = 0.5 + 0.4 * ((r * (p + 2) + c * c / 9) as f32 * 0.3).sin());
        Photo { name: "drawn".into(), frame }
    }

    #[test]
    fn a_dictionary_comes_back_from_its_file_and_is_made_again_alike() {
        let path = tempfile::tempdir().unwrap().keep().join("d.safetensors");
        let (atoms, error) = learn(&[photo()], RECIPE).unwrap();
        save(&path, &atoms, RECIPE, error, Provenance::default()).unwrap();
        let loaded = Dictionary::load(Some(&path)).unwrap();
        assert_eq!((&loaded.atoms, loaded.recipe, loaded.error), (&atoms, RECIPE, error));
        assert_eq!(learn(&[photo()], RECIPE).unwrap().0, atoms);
        assert_ne!(learn(&[photo()], Recipe { seed: 2, ..RECIPE }).unwrap().0, atoms);
        std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
    }

    #[test]
    fn the_first_atoms_are_the_colours_and_no_other_has_any_of_them() {
        let (atoms, _) = learn(&[photo()], RECIPE).unwrap();
        for (i, atom) in atoms.axis_iter(Axis(1)).enumerate() {
            for (plane, values) in atom.exact_chunks(PATCH_PIXELS).into_iter().enumerate() {
                let mean = values.sum() / 8.0;
                let wanted = if i == plane { 1.0 } else { 0.0 };
                assert!((mean - wanted).abs() < 1e-3, "atom {i}, plane {plane}: {mean}");
            }
        }
    }

    #[test]
    fn the_one_that_comes_with_the_program_is_the_papers_size() {
        let dictionary = Dictionary::load(None).unwrap();
        assert_eq!(dictionary.atoms.dim(), (192, 192));
    }

    #[test]
    fn what_is_no_dictionary_or_recipe_is_rejected() {
        let refused =
            |bytes: &[u8]| Dictionary::parse(bytes, Path::new("x.safetensors")).unwrap_err().to_string();
        assert!(
            refused(b"nothing").starts_with("x.safetensors: not a dictionary of edof study dictionary: ")
        );
        assert!(refused(&EMBEDDED[..EMBEDDED.len() - 1]).contains("no whole safetensors file"));
        let error = learn(&[photo()], Recipe { atoms: 3, ..RECIPE }).unwrap_err().to_string();
        assert_eq!(error, "--atoms 3: must be 4 to 4096");
        assert!(matches!(Dictionary::load(Some(Path::new("/nowhere"))), Err(DictionaryError::Read { .. })));
    }
}
