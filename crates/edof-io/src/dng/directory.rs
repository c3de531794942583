//! Directories of a TIFF file and the numbers that they hold. Nothing is read beyond the file's end, whatever it says.

use std::collections::BTreeMap;

/// Most directories of a file: raw, previews, Exif.
const MAX: usize = 64;

/// A TIFF file in memory.
#[derive(Debug, Clone, Copy)]
pub struct Tiff<'a> {
    bytes: &'a [u8],
    big: bool,
}

/// Where the numbers of a tag lie.
#[derive(Debug, Clone, Copy)]
struct Entry {
    kind: u16,
    count: usize,
    at: usize,
}

/// One directory.
#[derive(Debug, Clone)]
pub struct Directory<'a> {
    tiff: Tiff<'a>,
    entries: BTreeMap<u16, Entry>,
}

impl<'a> Tiff<'a> {
    /// The file, if it begins like one.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        match bytes.get(..4)? {
            [b'I', b'I', 42, 0] => Some(Self { bytes, big: false }),
            [b'M', b'M', 0, 42] => Some(Self { bytes, big: true }),
            _ => None,
        }
    }

    /// Whether its numbers begin with their largest byte.
    #[must_use]
    pub const fn is_big_endian(self) -> bool {
        self.big
    }

    /// Bytes of the file.
    #[must_use]
    pub const fn length(self) -> usize {
        self.bytes.len()
    }

    /// A part of the file.
    #[must_use]
    pub fn part(self, at: usize, length: usize) -> Option<&'a [u8]> {
        self.bytes.get(at..at.checked_add(length)?)
    }

    fn whole(self, at: usize, length: usize) -> Option<u64> {
        let bytes = self.part(at, length)?;
        let join = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        Some(if self.big { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) })
    }

    /// All directories: the first, those after it, and those below each (SubIFDs).
    #[must_use]
    pub fn directories(self) -> Vec<Directory<'a>> {
        let mut found = vec![];
        let mut open: Vec<usize> = self.whole(4, 4).map(|at| at as usize).into_iter().collect();
        while let (Some(at), true) = (open.pop(), found.len() < MAX) {
            let Some((directory, next)) = self.directory(at) else { continue };
            open.extend(next);
            open.extend(directory.numbers(330).unwrap_or_default().into_iter().map(|at| at as usize));
            found.push(directory);
        }
        found
    }

    /// The directory that begins at a byte, and where the next one does.
    fn directory(self, at: usize) -> Option<(Directory<'a>, Option<usize>)> {
        let count = self.whole(at, 2)? as usize;
        let entry = |index: usize| {
            let at = at + 2 + 12 * index;
            let (kind, count) = (self.whole(at + 2, 2)? as u16, self.whole(at + 4, 4)? as usize);
            let bytes = count.checked_mul(size(kind)?)?;
            let at_value = if bytes <= 4 { at + 8 } else { self.whole(at + 8, 4)? as usize };
            Some((self.whole(at, 2)? as u16, Entry { kind, count, at: at_value }))
        };
        let entries = (0..count).filter_map(entry).collect();
        let next = self.whole(at + 2 + 12 * count, 4).map(|at| at as usize).filter(|at| *at > 0);
        Some((Directory { tiff: self, entries }, next))
    }
}

/// Bytes of a number of a kind.
const fn size(kind: u16) -> Option<usize> {
    match kind {
        1 | 2 | 6 | 7 => Some(1),
        3 | 8 => Some(2),
        4 | 9 | 11 | 13 => Some(4),
        5 | 10 | 12 => Some(8),
        _ => None,
    }
}

impl<'a> Directory<'a> {
    /// The file that it is of.
    #[must_use]
    pub const fn tiff(&self) -> Tiff<'a> {
        self.tiff
    }

    /// The numbers of a tag; none where it is missing or reaches beyond the file.
    #[must_use]
    pub fn numbers(&self, tag: u16) -> Option<Vec<f64>> {
        let Entry { kind, count, at } = *self.entries.get(&tag)?;
        let size = size(kind)?;
        self.tiff.part(at, count.checked_mul(size)?)?;
        (0..count).map(|index| self.number(kind, at + index * size)).collect()
    }

    fn number(&self, kind: u16, at: usize) -> Option<f64> {
        let whole = |at, bytes| self.tiff.whole(at, bytes);
        Some(match kind {
            6 => f64::from(whole(at, 1)? as u8 as i8),
            8 => f64::from(whole(at, 2)? as u16 as i16),
            9 => f64::from(whole(at, 4)? as u32 as i32),
            5 => whole(at, 4)? as f64 / whole(at + 4, 4)? as f64,
            10 => f64::from(whole(at, 4)? as u32 as i32) / f64::from(whole(at + 4, 4)? as u32 as i32),
            11 => f64::from(f32::from_bits(whole(at, 4)? as u32)),
            12 => f64::from_bits(whole(at, 8)?),
            _ => whole(at, size(kind)?)? as f64,
        })
    }

    /// Whole numbers of a tag.
    #[must_use]
    pub fn wholes(&self, tag: u16) -> Option<Vec<usize>> {
        Some(self.numbers(tag)?.into_iter().map(|v| v as usize).collect())
    }

    /// The first number of a tag.
    #[must_use]
    pub fn whole(&self, tag: u16) -> Option<usize> {
        self.wholes(tag)?.first().copied()
    }
}
