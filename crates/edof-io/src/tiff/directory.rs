//! Directories of a TIFF or BigTIFF file and the numbers that they hold. Nothing is read beyond the file's end, whatever it states.

use std::collections::{BTreeMap, BTreeSet};

/// Most directories of a file: raw frames, previews, masks.
const MAX: usize = 64;
/// Largest whole number; beyond, numbers of 64 bits with a fraction are not exact.
const MAX_WHOLE: f64 = 9e15;
/// Tag of the directories below one.
const SUB_DIRECTORIES: u16 = 330;

/// A TIFF file in memory.
#[derive(Debug, Clone, Copy)]
pub struct File<'a> {
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
    file: File<'a>,
    entries: BTreeMap<u16, Entry>,
}

/// Why the numbers of a tag cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unreadable {
    /// The numbers are beyond the end of the file.
    Cut,
    /// TIFF has no such type.
    Type(u16),
}

/// All directories of a file.
#[derive(Debug)]
pub struct Directories<'a> {
    /// Those that could be read: the first, those below it in their order, those after it.
    pub found: Vec<Directory<'a>>,
    /// Why directories below another one could not be found, if any could not.
    pub lost: Option<Unreadable>,
    /// Whether the file ends before a directory that another one names.
    pub is_cut: bool,
}

impl<'a> File<'a> {
    /// Returns the file, if it begins like one.
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

    /// Returns whether numbers begin with their most significant byte.
    #[must_use]
    pub const fn is_big_endian(self) -> bool {
        self.is_big_endian
    }

    /// Returns all bytes of the file.
    #[must_use]
    pub const fn bytes(self) -> &'a [u8] {
        self.bytes
    }

    /// Returns a part of the file, if the file has it.
    #[must_use]
    pub fn part(self, at: u64, length: u64) -> Option<&'a [u8]> {
        let range = usize::try_from(at).ok()?..usize::try_from(at.checked_add(length)?).ok()?;
        self.bytes.get(range)
    }

    /// Returns the unsigned number of `length` bytes at a byte.
    #[must_use]
    pub fn whole(self, at: u64, length: u64) -> Option<u64> {
        let bytes = self.part(at, length)?;
        let join = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        Some(if self.is_big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) })
    }

    /// Bytes of an offset or a count.
    const fn word(self) -> u64 {
        if self.is_wide { 8 } else { 4 }
    }

    fn begin(self) -> u64 {
        self.whole(self.word(), self.word()).unwrap_or(u64::MAX)
    }

    /// Returns the first directory; none where the file ends before it does.
    #[must_use]
    pub fn first(self) -> Option<Directory<'a>> {
        self.directory(self.begin()).map(|(first, _)| first)
    }

    /// Returns all directories.
    #[must_use]
    pub fn directories(self) -> Directories<'a> {
        let (mut found, mut lost, mut is_cut) = (vec![], None, false);
        let mut seen = BTreeSet::new();
        // Where a directory begins, and whether it is below another one.
        let mut open = vec![(self.begin(), false)];
        while let (Some((at, is_below)), true) = (open.pop(), found.len() < MAX) {
            if at == 0 || !seen.insert(at) {
                continue;
            }
            let Some((directory, Some(next))) = self.directory(at) else {
                is_cut = true;
                lost = lost.or(is_below.then_some(Unreadable::Cut));
                continue;
            };
            open.push((next, false));
            match directory.numbers(SUB_DIRECTORIES) {
                Ok(below) => {
                    open.extend(below.unwrap_or_default().into_iter().rev().map(|at| (at as u64, true)));
                }
                Err(why) => lost = lost.or(Some(why)),
            }
            found.push(directory);
        }
        Directories { found, lost, is_cut }
    }

    /// The directory that begins at a byte, and where the next one does (0: there is none), unless the file ends before it says so.
    fn directory(self, at: u64) -> Option<(Directory<'a>, Option<u64>)> {
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
        Some((Directory { file: self, entries }, self.whole(end, self.word())))
    }
}

/// Bytes of a number of a type.
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
    /// Returns the file that contains the directory.
    #[must_use]
    pub const fn file(&self) -> File<'a> {
        self.file
    }

    /// Returns whether the directory has a tag.
    #[must_use]
    pub fn has(&self, tag: u16) -> bool {
        self.entries.contains_key(&tag)
    }

    /// Returns the bytes of a tag's values; none where the tag is missing.
    ///
    /// # Errors
    /// [`Unreadable`].
    pub fn bytes(&self, tag: u16) -> Result<Option<&'a [u8]>, Unreadable> {
        let Some(Entry { kind, count, at }) = self.entries.get(&tag).copied() else { return Ok(None) };
        let size = size(kind).ok_or(Unreadable::Type(kind))?;
        let bytes = count.checked_mul(size).and_then(|length| self.file.part(at, length));
        bytes.map(Some).ok_or(Unreadable::Cut)
    }

    /// Returns the numbers of a tag; none where the tag is missing.
    ///
    /// # Errors
    /// [`Unreadable`].
    pub fn numbers(&self, tag: u16) -> Result<Option<Vec<f64>>, Unreadable> {
        let (Some(bytes), Some(&Entry { kind, count, at })) = (self.bytes(tag)?, self.entries.get(&tag))
        else {
            return Ok(None);
        };
        let size = bytes.len() as u64 / count.max(1);
        let numbers: Option<Vec<f64>> =
            (0..count).map(|index| self.number(kind, at + index * size)).collect();
        numbers.map(Some).ok_or(Unreadable::Cut)
    }

    /// Returns the whole numbers of a tag; none where it is missing, cannot be read, or has a fraction or a negative number.
    #[must_use]
    pub fn wholes(&self, tag: u16) -> Option<Vec<usize>> {
        let whole = |v: f64| (v >= 0.0 && v.fract() == 0.0 && v <= MAX_WHOLE).then_some(v as usize);
        self.numbers(tag).ok()??.into_iter().map(whole).collect()
    }

    /// Returns the first of them.
    #[must_use]
    pub fn whole(&self, tag: u16) -> Option<usize> {
        self.wholes(tag)?.first().copied()
    }

    /// Returns the directory that begins where a tag says.
    #[must_use]
    pub fn below(&self, tag: u16) -> Option<Self> {
        self.file.directory(self.whole(tag)? as u64).map(|(directory, _)| directory)
    }

    /// Returns two unsigned fractions that begin at a byte of a tag's values.
    #[must_use]
    pub fn fractions(&self, tag: u16, offset: u64) -> Option<[f64; 2]> {
        let &Entry { at, .. } = self.entries.get(&tag)?;
        let inside = (self.bytes(tag).ok()??.len() as u64).checked_sub(16)? >= offset;
        inside.then_some(())?;
        Some([self.number(5, at + offset)?, self.number(5, at + offset + 8)?])
    }

    fn number(&self, kind: u16, at: u64) -> Option<f64> {
        let whole = |at, bytes| self.file.whole(at, bytes);
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
}
