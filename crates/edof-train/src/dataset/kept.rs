//! Blurred photographs kept in a file, for the next training on the same ones: blurring takes longer than reading.
//!
//! A line of JSON says what the file is of; behind it stand all words, lowest byte first: of each picture the sharp ones, then those of each blur.

use super::{Dataset, DatasetOptions, Picture};
use crate::holdout::Holdout;
use edof_core::ColourFrame;
use edof_core::storage::atomic::{self, WriteError};
use edof_core::storage::input;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Most bytes of the first line.
const MAX_HEAD: u64 = 1 << 20;
/// Words that are read and written at once.
const AT_ONCE: usize = 1 << 16;

/// The first line.
#[derive(Debug, Serialize, Deserialize)]
struct Head {
    /// Key of these blurs.
    key: String,
    reach: usize,
    turns: Vec<usize>,
    /// Rows and columns of each picture.
    sizes: Vec<(usize, usize)>,
}

impl Dataset {
    /// Bytes that [`Dataset::keep`] writes, except for the first line.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let words = |picture: &Picture| picture.sharp.len() * (1 + picture.blurred.len());
        self.pictures.iter().map(|picture| 2 * words(picture) as u64).sum()
    }

    /// Writes the blurred photographs to a file; `key` must tell apart everything that they depend on: photographs, camera, options, program.
    ///
    /// # Errors
    /// A file that cannot be written; none is then left.
    pub fn keep(&self, path: &Path, key: &str) -> Result<(), WriteError> {
        let head = Head {
            key: key.to_owned(),
            reach: self.reach,
            turns: self.turns.clone(),
            sizes: self.pictures.iter().map(|p| (p.sharp.len() / 3 / p.width.max(1), p.width)).collect(),
        };
        atomic::write_with(path, |file| {
            writeln!(file, "{}", serde_json::to_string(&head)?)?;
            for picture in &self.pictures {
                for words in std::iter::once(&picture.sharp).chain(&picture.blurred) {
                    for some in words.chunks(AT_ONCE) {
                        file.write_all(
                            &some.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>(),
                        )?;
                    }
                }
            }
            Ok(())
        })
    }

    /// The photographs that [`Dataset::keep`] wrote under the same key; none where there is no such file, another key, or not all of it.
    #[must_use]
    pub fn kept(path: &Path, key: &str, photos: &[ColourFrame], options: DatasetOptions) -> Option<Self> {
        let mut file = BufReader::new(input::open(path).ok()?);
        let mut line = String::new();
        file.by_ref().take(MAX_HEAD).read_line(&mut line).ok()?;
        let head: Head = serde_json::from_str(&line).ok()?;
        let looks = options.augmentation.variants;
        let blurs = options.psis.len() * (1 + options.further_foci.len());
        if head.key != key || head.sizes.len() != photos.len() * looks {
            return None;
        }
        let mut pictures = vec![];
        for (index, &(height, width)) in head.sizes.iter().enumerate() {
            let (photo, variant) = (index / looks, index % looks);
            let (rows, columns) = photos[photo].size();
            let whole = Holdout::new(rows, columns, photo, head.reach);
            let holdout = if variant == 0 { whole } else { whole.reduced(height, width) };
            let count = (height <= rows && width <= columns).then_some(3 * height * width)?;
            let sharp = words(&mut file, count)?;
            let blurred = (0..blurs).map(|_| words(&mut file, count)).collect::<Option<_>>()?;
            pictures.push(Picture { width, holdout, sharp, blurred });
        }
        let is_whole = file.read(&mut [0]).ok()? == 0;
        is_whole.then_some(Self {
            pictures,
            options,
            photos: photos.len(),
            reach: head.reach,
            turns: head.turns,
        })
    }
}

fn words(file: &mut impl Read, count: usize) -> Option<Vec<u16>> {
    let mut words = Vec::with_capacity(count);
    let mut bytes = vec![0; 2 * AT_ONCE];
    while words.len() < count {
        let some = &mut bytes[..2 * AT_ONCE.min(count - words.len())];
        file.read_exact(some).ok()?;
        words.extend(some.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])));
    }
    Some(words)
}
