//! Directories of a TIFF or BigTIFF file and the numbers that they hold. Nothing is read beyond the file's end, whatever it states.

use super::refusal::Refusal;
use super::tags::{self, Tag};
use std::collections::{BTreeMap, BTreeSet};

/// Most directories of a file: raw frames, previews, masks.
const MAX: usize = 64;

/// A TIFF file in memory.
#[derive(Debug, Clone, Copy)]
pub struct Tiff<'a> {
    bytes: &'a [u8],
    is_big_endian: bool,
    /// Whether offsets have eight bytes (BigTIFF).
    is_wide: bool,
}

/// Where the numbers of a tag are stored.
#[derive(Debug, Clone, Copy)]
struct Entry {
    kind: u16,
    count: u64,
    at: u64,
}

/// One directory.
#[derive(Debug, Clone)]
pub struct Directory<'a> {
    tiff: Tiff<'a>,
    entries: BTreeMap<u16, Entry>,
}

/// All directories of a file.
#[derive(Debug)]
pub struct Directories<'a> {
    /// Those that could be read: the first, those below it in their order, those after it.
    pub found: Vec<Directory<'a>>,
    /// What of the chain of directories could not be followed, first of all.
    pub lost: Option<Refusal>,
    /// Whether the file ends before a directory that another one names as the next.
    pub is_cut: bool,
}

impl<'a> Tiff<'a> {
    /// The file, if it begins like one.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let (is_big_endian, is_wide) = match bytes.get(..4)? {
            [b'I', b'I', 42, 0] => (false, false),
            [b'M', b'M', 0, 42] => (true, false),
            [b'I', b'I', 43, 0] => (false, true),
            [b'M', b'M', 0, 43] => (true, true),
            _ => return None,
        };
        Some(Self { bytes, is_big_endian, is_wide })
    }

    /// Whether its numbers begin with their most significant byte.
    #[must_use]
    pub const fn is_big_endian(self) -> bool {
        self.is_big_endian
    }

    /// Bytes of the file.
    #[must_use]
    pub const fn length(self) -> usize {
        self.bytes.len()
    }

    /// A part of the file.
    #[must_use]
    pub fn part(self, at: u64, length: u64) -> Option<&'a [u8]> {
        let range = usize::try_from(at).ok()?..usize::try_from(at.checked_add(length)?).ok()?;
        self.bytes.get(range)
    }

    fn whole(self, at: u64, length: u64) -> Option<u64> {
        let bytes = self.part(at, length)?;
        let join = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        Some(if self.is_big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) })
    }

    /// Bytes of an offset or a count.
    const fn word(self) -> u64 {
        if self.is_wide { 8 } else { 4 }
    }

    /// All directories.
    #[must_use]
    pub fn directories(self) -> Directories<'a> {
        let (mut found, mut lost, mut is_cut) = (vec![], None, false);
        let mut seen = BTreeSet::new();
        let first = if self.is_wide { self.whole(8, 8) } else { self.whole(4, 4) };
        // Where a directory begins, and whether it is below another one.
        let mut open = vec![(first.unwrap_or(u64::MAX), false)];
        while let (Some((at, is_below)), true) = (open.pop(), found.len() < MAX) {
            if at == 0 || !seen.insert(at) {
                continue;
            }
            let Some((directory, next)) = self.directory(at) else {
                is_cut = true;
                if is_below {
                    lost = lost.or(Some(Refusal::Cut(format!("a directory of {}", tags::SUB_DIRECTORIES))));
                }
                continue;
            };
            open.push((next, false));
            match directory.wholes(tags::SUB_DIRECTORIES) {
                Ok(below) => {
                    open.extend(below.unwrap_or_default().into_iter().rev().map(|at| (at as u64, true)));
                }
                Err(refusal) => lost = lost.or(Some(refusal)),
            }
            found.push(directory);
        }
        Directories { found, lost, is_cut }
    }

    /// The directory that begins at a byte, and where the next one does (0: none).
    fn directory(self, at: u64) -> Option<(Directory<'a>, u64)> {
        let (head, row) = if self.is_wide { (8, 20) } else { (2, 12) };
        let count = self.whole(at, head)?;
        let begin = at + head;
        let end = count.checked_mul(row)?.checked_add(begin)?;
        self.part(begin, end - begin)?;
        let mut entries = BTreeMap::new();
        for at in (begin..end).step_by(row as usize) {
            let [tag, kind] = [self.whole(at, 2)? as u16, self.whole(at + 2, 2)? as u16];
            let (count, value) = (self.whole(at + 4, self.word())?, at + 4 + self.word());
            let bytes = size(kind).and_then(|size| count.checked_mul(size)).unwrap_or(0);
            let at = if bytes <= self.word() { value } else { self.whole(value, self.word())? };
            // As libtiff has it, a tag that comes again is not read.
            entries.entry(tag).or_insert(Entry { kind, count, at });
        }
        Some((Directory { tiff: self, entries }, self.whole(end, self.word())?))
    }
}

/// Bytes of a number of a kind.
const fn size(kind: u16) -> Option<u64> {
    match kind {
        1 | 2 | 6 | 7 => Some(1),
        3 | 8 => Some(2),
        4 | 9 | 11 | 13 => Some(4),
        5 | 10 | 12 | 16 | 17 | 18 => Some(8),
        _ => None,
    }
}

impl<'a> Directory<'a> {
    /// The file that contains it.
    #[must_use]
    pub const fn tiff(&self) -> Tiff<'a> {
        self.tiff
    }

    /// Whether it has a tag.
    #[must_use]
    pub fn has(&self, tag: Tag) -> bool {
        self.entries.contains_key(&tag.0)
    }

    /// The bytes of a tag; none where it is missing.
    ///
    /// # Errors
    /// [`Refusal`] where they cannot be read.
    pub fn bytes(&self, tag: Tag) -> Result<Option<&'a [u8]>, Refusal> {
        let Some(Entry { kind, count, at }) = self.entries.get(&tag.0).copied() else { return Ok(None) };
        let Some(size) = size(kind) else {
            let expected = "a type of TIFF, 1 to 13 or 16 to 18";
            return Err(Refusal::Wrong {
                tag,
                found: format!("numbers of type {kind}"),
                expected: expected.into(),
            });
        };
        let bytes = count.checked_mul(size).and_then(|length| self.tiff.part(at, length));
        bytes.map(Some).ok_or_else(|| Refusal::Cut(tag.to_string()))
    }

    /// The numbers of a tag; none where it is missing.
    ///
    /// # Errors
    /// [`Refusal`] where they cannot be read.
    pub fn numbers(&self, tag: Tag) -> Result<Option<Vec<f64>>, Refusal> {
        let (Some(bytes), Some(&Entry { kind, count, at })) = (self.bytes(tag)?, self.entries.get(&tag.0))
        else {
            return Ok(None);
        };
        let size = bytes.len() as u64 / count.max(1);
        let numbers: Option<Vec<f64>> =
            (0..count).map(|index| self.number(kind, at + index * size)).collect();
        numbers.map(Some).ok_or_else(|| Refusal::Cut(tag.to_string()))
    }

    fn number(&self, kind: u16, at: u64) -> Option<f64> {
        let whole = |at, bytes| self.tiff.whole(at, bytes);
        let signed = |at| Some(f64::from(whole(at, 4)? as u32 as i32));
        Some(match kind {
            6 => f64::from(whole(at, 1)? as u8 as i8),
            8 => f64::from(whole(at, 2)? as u16 as i16),
            9 => signed(at)?,
            5 => whole(at, 4)? as f64 / whole(at + 4, 4)? as f64,
            10 => signed(at)? / signed(at + 4)?,
            11 => f64::from(f32::from_bits(whole(at, 4)? as u32)),
            12 => f64::from_bits(whole(at, 8)?),
            17 => whole(at, 8)? as i64 as f64,
            _ => whole(at, size(kind)?)? as f64,
        })
    }

    /// Whole numbers of a tag from 0 on; none where it is missing.
    ///
    /// # Errors
    /// [`Refusal`] where they cannot be read, are fractions or negative.
    pub fn wholes(&self, tag: Tag) -> Result<Option<Vec<usize>>, Refusal> {
        let Some(numbers) = self.numbers(tag)? else { return Ok(None) };
        let whole = |v: &f64| (*v >= 0.0 && v.fract() == 0.0 && *v <= MAX_WHOLE).then_some(*v as usize);
        let wholes: Option<Vec<usize>> = numbers.iter().map(whole).collect();
        wholes.map(Some).ok_or_else(|| Refusal::wrong(tag, &numbers, "whole numbers from 0 on"))
    }

    /// The first whole number of a tag; none where it is missing.
    ///
    /// # Errors
    /// As [`Directory::wholes`], and where the tag has no number.
    pub fn whole(&self, tag: Tag) -> Result<Option<usize>, Refusal> {
        let Some(all) = self.wholes(tag)? else { return Ok(None) };
        all.first().copied().map(Some).ok_or_else(|| Refusal::wrong(tag, &[], "one number"))
    }

    /// The chromaticity x, y of a tag of the form of IlluminantData1; none where it is missing or has a spectrum.
    ///
    /// # Errors
    /// [`Refusal`] where it cannot be read.
    pub fn chromaticity(&self, tag: Tag) -> Result<Option<[f64; 2]>, Refusal> {
        let (Some(bytes), Some(&Entry { at, .. })) = (self.bytes(tag)?, self.entries.get(&tag.0)) else {
            return Ok(None);
        };
        // Type 0 is x and y, as two fractions; type 1 a spectrum.
        if self.tiff.whole(at, 2) != Some(0) {
            return Ok(None);
        }
        let number = |at: u64| self.number(5, at).filter(|v| v.is_finite() && *v > 0.0);
        match (bytes.len(), number(at + 2), number(at + 10)) {
            (18.., Some(x), Some(y)) => Ok(Some([x, y])),
            _ => Err(Refusal::wrong(tag, &[], "two fractions above 0, x and y")),
        }
    }

    /// As many numbers as there must be; none where the tag is missing.
    ///
    /// # Errors
    /// [`Refusal`] where they cannot be read, are of another count, or not finite.
    pub fn exactly<const N: usize>(&self, tag: Tag) -> Result<Option<[f64; N]>, Refusal> {
        let Some(numbers) = self.numbers(tag)? else { return Ok(None) };
        match <[f64; N]>::try_from(&numbers[..]) {
            Ok(exact) if exact.iter().all(|v| v.is_finite()) => Ok(Some(exact)),
            _ => Err(Refusal::wrong(tag, &numbers, format!("{N} numbers"))),
        }
    }
}

/// Beyond, numbers of 64 bits with a fraction are not exact.
const MAX_WHOLE: f64 = 9e15;
