//! The first directory of a TIFF or BigTIFF file. Nothing is read beyond the file's end, whatever it states.

use std::collections::BTreeMap;

/// A directory and the file that contains it.
#[derive(Debug, Clone)]
pub struct Directory<'a> {
    bytes: &'a [u8],
    is_big_endian: bool,
    entries: BTreeMap<u16, Entry>,
}

/// Type, count and place of a tag's values.
#[derive(Debug, Clone, Copy)]
struct Entry {
    kind: u16,
    count: usize,
    at: usize,
}

/// Sizes of the fields: BigTIFF has 64-bit counts and offsets.
struct Widths {
    entries: usize,
    field: usize,
    first: usize,
}

const CLASSIC: Widths = Widths { entries: 2, field: 4, first: 4 };
const BIG: Widths = Widths { entries: 8, field: 8, first: 8 };

impl<'a> Directory<'a> {
    /// Reads the first directory of a file; none where the file has none.
    pub fn first(bytes: &'a [u8]) -> Option<Self> {
        let (is_big_endian, widths) = match bytes.get(..4)? {
            [b'I', b'I', 42, 0] => (false, CLASSIC),
            [b'M', b'M', 0, 42] => (true, CLASSIC),
            [b'I', b'I', 43, 0] => (false, BIG),
            [b'M', b'M', 0, 43] => (true, BIG),
            _ => return None,
        };
        let file = Self { bytes, is_big_endian, entries: BTreeMap::new() };
        let at = file.number_at(widths.first, widths.field)?;
        let count = file.number_at(at, widths.entries)?;
        let size = 4 + 2 * widths.field;
        let begin = at.checked_add(widths.entries)?;
        file.part(begin, count.checked_mul(size)?)?;
        let entries = (0..count).filter_map(|index| file.entry(begin + index * size, &widths)).collect();
        Some(Self { entries, ..file })
    }

    fn entry(&self, at: usize, widths: &Widths) -> Option<(u16, Entry)> {
        let kind = self.number_at(at + 2, 2)? as u16;
        let count = self.number_at(at + 4, widths.field)?;
        let value = at + 4 + widths.field;
        let is_inside = count.checked_mul(size(kind)?)? <= widths.field;
        let at_value = if is_inside { value } else { self.number_at(value, widths.field)? };
        Some((self.number_at(at, 2)? as u16, Entry { kind, count, at: at_value }))
    }

    /// Returns whether numbers begin with their most significant byte.
    pub const fn is_big_endian(&self) -> bool {
        self.is_big_endian
    }

    /// Returns a part of the file, if the file has it.
    pub fn part(&self, at: usize, length: usize) -> Option<&'a [u8]> {
        self.bytes.get(at..at.checked_add(length)?)
    }

    /// Returns the bytes of the file from one on.
    pub fn rest(&self, at: usize) -> Option<&'a [u8]> {
        self.bytes.get(at..)
    }

    fn number_at(&self, at: usize, length: usize) -> Option<usize> {
        let bytes = self.part(at, length)?;
        let join = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        let number =
            if self.is_big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) };
        usize::try_from(number).ok()
    }

    /// Returns whether the directory has a tag.
    pub fn has(&self, tag: u16) -> bool {
        self.entries.contains_key(&tag)
    }

    /// Returns the whole numbers of a tag; none where it is missing, of another type, or beyond the file's end.
    pub fn numbers(&self, tag: u16) -> Option<Vec<usize>> {
        let Entry { kind, count, at } = *self.entries.get(&tag)?;
        let size = size(kind).filter(|_| WHOLE.contains(&kind))?;
        self.part(at, count.checked_mul(size)?)?;
        (0..count).map(|index| self.number_at(at + index * size, size)).collect()
    }

    /// Returns the first whole number of a tag.
    pub fn number(&self, tag: u16) -> Option<usize> {
        self.numbers(tag)?.first().copied()
    }

    /// Returns the bytes of a tag's values.
    pub fn bytes_of(&self, tag: u16) -> Option<&'a [u8]> {
        let Entry { kind, count, at } = *self.entries.get(&tag)?;
        self.part(at, count.checked_mul(size(kind)?)?)
    }
}

/// Types of whole numbers without sign.
const WHOLE: [u16; 6] = [1, 3, 4, 13, 16, 18];

/// Bytes of a value of a type.
const fn size(kind: u16) -> Option<usize> {
    match kind {
        1 | 2 | 6 | 7 => Some(1),
        3 | 8 => Some(2),
        4 | 9 | 11 | 13 => Some(4),
        5 | 10 | 12 | 16 | 17 | 18 => Some(8),
        _ => None,
    }
}
