//! A directory of a DNG: numbers of its tags, or a rejection that names the tag.

use super::rejection::Rejection;
use super::tags::{self, Tag};
use crate::tiff::directory::{self, Unreadable};

/// One directory.
#[derive(Debug, Clone)]
pub struct Directory<'a>(directory::Directory<'a>);

/// All directories of a file: those that could be read, and whether it ends before another one.
pub struct Directories<'a> {
    pub found: Vec<Directory<'a>>,
    pub is_cut: bool,
}

/// The rejection of a tag that cannot be read.
fn unreadable(tag: Tag) -> impl Fn(Unreadable) -> Rejection {
    move |why| match why {
        Unreadable::Cut => Rejection::Cut(tag.to_string()),
        Unreadable::Type(kind) => Rejection::Wrong {
            tag,
            found: format!("numbers of type {kind}"),
            expected: "a type of TIFF, 1 to 13 or 16 to 18".to_owned(),
        },
    }
}

impl<'a> Directories<'a> {
    /// Those of a file.
    ///
    /// # Errors
    /// [`Rejection`] for directories below another one that cannot be found: one of them may have the frame.
    pub fn of(file: directory::File<'a>) -> Result<Self, Rejection> {
        let directory::Directories { found, lost, is_cut } = file.directories();
        match lost {
            Some(why) => Err(unreadable(tags::SUB_DIRECTORIES)(why)),
            None => Ok(Self { found: found.into_iter().map(Directory).collect(), is_cut }),
        }
    }
}

impl<'a> Directory<'a> {
    /// The file that contains the directory.
    pub const fn file(&self) -> directory::File<'a> {
        self.0.file()
    }

    /// Whether the directory has a tag.
    pub fn has(&self, tag: Tag) -> bool {
        self.0.has(tag.0)
    }

    /// The bytes of a tag; none where it is missing.
    ///
    /// # Errors
    /// [`Rejection`] where they cannot be read.
    pub fn bytes(&self, tag: Tag) -> Result<Option<&'a [u8]>, Rejection> {
        self.0.bytes(tag.0).map_err(unreadable(tag))
    }

    /// The numbers of a tag; none where it is missing.
    ///
    /// # Errors
    /// [`Rejection`] where they cannot be read.
    pub fn numbers(&self, tag: Tag) -> Result<Option<Vec<f64>>, Rejection> {
        self.0.numbers(tag.0).map_err(unreadable(tag))
    }

    /// Whole numbers of a tag from 0 on; none where it is missing.
    ///
    /// # Errors
    /// [`Rejection`] where they cannot be read, are fractions or negative.
    pub fn wholes(&self, tag: Tag) -> Result<Option<Vec<usize>>, Rejection> {
        let Some(numbers) = self.numbers(tag)? else { return Ok(None) };
        self.0
            .wholes(tag.0)
            .map(Some)
            .ok_or_else(|| Rejection::wrong(tag, &numbers, "whole numbers from 0 on"))
    }

    /// The first whole number of a tag; none where it is missing.
    ///
    /// # Errors
    /// As [`Directory::wholes`], and where the tag has no number.
    pub fn whole(&self, tag: Tag) -> Result<Option<usize>, Rejection> {
        let Some(all) = self.wholes(tag)? else { return Ok(None) };
        all.first().copied().map(Some).ok_or_else(|| Rejection::wrong(tag, &[], "one number"))
    }

    /// As many numbers as there must be; none where the tag is missing.
    ///
    /// # Errors
    /// [`Rejection`] where they cannot be read, are of another count, or not finite.
    pub fn exactly<const N: usize>(&self, tag: Tag) -> Result<Option<[f64; N]>, Rejection> {
        let Some(numbers) = self.numbers(tag)? else { return Ok(None) };
        match <[f64; N]>::try_from(&numbers[..]) {
            Ok(exact) if exact.iter().all(|v| v.is_finite()) => Ok(Some(exact)),
            _ => Err(Rejection::wrong(tag, &numbers, format!("{N} numbers"))),
        }
    }

    /// The chromaticity x, y of a tag of the form of IlluminantData1; none where it is missing or has a spectrum.
    ///
    /// # Errors
    /// [`Rejection`] where it cannot be read.
    pub fn chromaticity(&self, tag: Tag) -> Result<Option<[f64; 2]>, Rejection> {
        let Some(bytes) = self.bytes(tag)? else { return Ok(None) };
        // Type 0 is x and y, as two fractions; type 1 a spectrum.
        if bytes.get(..2) != Some(&[0, 0]) {
            return Ok(None);
        }
        let found = self.0.fractions(tag.0, 2).filter(|xy| xy.iter().all(|v| v.is_finite() && *v > 0.0));
        found.map(Some).ok_or_else(|| Rejection::wrong(tag, &[], "two fractions above 0, x and y"))
    }
}
