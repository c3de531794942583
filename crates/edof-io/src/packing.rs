//! How the pixels of a headerless raw file are packed into bytes.
//!
//! | name | bits per pixel | bytes |
//! |---|---|---|
//! | `words` | 16 | one word a pixel |
//! | `bytes` | 8 | one byte a pixel |
//! | `mipi10` | 10 | MIPI CSI-2 RAW10: the high bytes of four pixels, then their low pairs of bits, the first pixel's lowest |
//! | `10p` | 10 | PFNC `10p`: one stream of bits, lowest first |
//! | `mipi12` | 12 | MIPI CSI-2 RAW12: the high bytes of two pixels, then their low nibbles, the first pixel's below |
//! | `12p` | 12 | PFNC `12p`: one stream of bits, lowest first |
//! | `12packed` | 12 | GigE Vision `12Packed`: high byte, low nibbles of both (the first pixel's below), high byte |
//! | `2vuy` | 14, the upper ones of 16 | video for a playout card: Cb Y Cr Y, each byte seven bits plus 64 ([`edof_core::cable`]) |

use edof_core::{RawFrame, cable};

/// Which byte of a word comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ByteOrder {
    /// The low byte.
    #[default]
    Little,
    /// The high byte.
    Big,
}

/// How pixels are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Packing {
    /// 16-bit words.
    #[default]
    Words,
    /// 8-bit pixels.
    Bytes,
    /// MIPI CSI-2 RAW10.
    Mipi10,
    /// PFNC 10p.
    Bits10,
    /// MIPI CSI-2 RAW12.
    Mipi12,
    /// PFNC 12p.
    Bits12,
    /// GigE Vision 12Packed.
    Packed12,
    /// Frames on a video cable, as a playout card takes them.
    Video,
}

/// Lines that cannot be padded to a number of bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum LineError {
    /// Fewer bytes than the pixels take.
    #[error("{found} bytes for a line of {width} pixels, expected at least {expected} packed as {}", packing.name())]
    Short { found: usize, expected: usize, width: usize, packing: Packing },
    /// Pixels that share bytes with those of the next line.
    #[error("a line of {width} pixels packed as {} ends inside of a group, so that it cannot be padded", packing.name())]
    Shared { width: usize, packing: Packing },
}

/// A byte of video that carries no part of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stray {
    /// The pixel, counted along the rows.
    pub pixel: usize,
    /// The byte.
    pub code: u8,
}

impl Packing {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Words,
        Self::Bytes,
        Self::Mipi10,
        Self::Bits10,
        Self::Mipi12,
        Self::Bits12,
        Self::Packed12,
        Self::Video,
    ];

    /// As options name it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Words => "words",
            Self::Bytes => "bytes",
            Self::Mipi10 => "mipi10",
            Self::Bits10 => "10p",
            Self::Mipi12 => "mipi12",
            Self::Bits12 => "12p",
            Self::Packed12 => "12packed",
            Self::Video => "2vuy",
        }
    }

    /// Whether a pixel is a word of 16 bits, which may hold fewer.
    #[must_use]
    pub const fn is_words(self) -> bool {
        matches!(self, Self::Words | Self::Video)
    }

    /// Bits of a pixel in the file; 16-bit words may hold fewer.
    #[must_use]
    pub const fn bits(self) -> u32 {
        match self {
            Self::Words | Self::Video => 16,
            Self::Bytes => 8,
            Self::Mipi10 | Self::Bits10 => 10,
            Self::Mipi12 | Self::Bits12 | Self::Packed12 => 12,
        }
    }

    /// Bytes of whole Bayer cells, whose pixels are a multiple of four.
    #[must_use]
    pub const fn bytes(self, pixels: usize) -> usize {
        (pixels * self.bits() as usize).div_ceil(8)
    }

    /// Returns the bytes of a frame, whose lines may be longer than their pixels.
    #[must_use]
    pub const fn frame_bytes(self, width: usize, height: usize, line: Option<usize>) -> usize {
        match line {
            Some(line) => line * height,
            None => self.bytes(width * height),
        }
    }

    /// Checks that a line's pixels end with a byte and a group, and fit the bytes of a line.
    ///
    /// # Errors
    /// [`LineError`].
    pub fn check_line(self, width: usize, line: Option<usize>) -> Result<(), LineError> {
        let Some(found) = line else { return Ok(()) };
        let group = if self.bits() == 10 { 4 } else { 2 };
        if !width.is_multiple_of(group) {
            return Err(LineError::Shared { width, packing: self });
        }
        let expected = self.bytes(width);
        if found < expected {
            return Err(LineError::Short { found, expected, width, packing: self });
        }
        Ok(())
    }

    /// Returns a frame's bytes without what fills up its lines; `memory` is kept.
    ///
    /// ```
    /// use edof_io::packing::Packing;
    /// let (bytes, mut memory) = ([1, 2, 0, 3, 4, 0], vec![]);
    /// assert_eq!(Packing::Bytes.without_padding(2, Some(3), &bytes, &mut memory), [1, 2, 3, 4]);
    /// ```
    pub fn without_padding<'a>(
        self,
        width: usize,
        line: Option<usize>,
        bytes: &'a [u8],
        memory: &'a mut Vec<u8>,
    ) -> &'a [u8] {
        let pixels = self.bytes(width);
        match line.filter(|line| *line > pixels) {
            None => bytes,
            Some(line) => {
                memory.clear();
                bytes.chunks_exact(line).for_each(|whole| memory.extend_from_slice(&whole[..pixels]));
                memory
            }
        }
    }

    /// The pixels' values; what is left over at the end of `bytes` is dropped. Only video is aligned to the top.
    ///
    /// # Errors
    /// [`Stray`]: the first byte of video that carries nothing.
    pub fn values(self, bytes: &[u8], order: ByteOrder) -> Result<Vec<u16>, Stray> {
        let mut values = vec![];
        self.values_into(bytes, order, &mut values)?;
        Ok(values)
    }

    /// Puts the pixels' values in the place of others, whose memory is kept.
    ///
    /// # Errors
    /// As [`Packing::values`].
    pub fn values_into(self, bytes: &[u8], order: ByteOrder, values: &mut Vec<u16>) -> Result<(), Stray> {
        let [high, low] = [|byte: u8| u16::from(byte) << 4, |byte: u8| u16::from(byte >> 4)];
        let nibble = |byte: u8| u16::from(byte & 15);
        match self {
            Self::Video => *values = words_of_video(bytes)?,
            Self::Words => unpack(bytes, values, |b: [u8; 2]| {
                [if order == ByteOrder::Little { u16::from_le_bytes(b) } else { u16::from_be_bytes(b) }]
            }),
            Self::Bytes => unpack(bytes, values, |[b]: [u8; 1]| [u16::from(b)]),
            Self::Mipi10 => unpack(bytes, values, |[a, b, c, d, low]: [u8; 5]| {
                let word = |high: u8, place: u32| u16::from(high) << 2 | u16::from(low >> (2 * place) & 3);
                [word(a, 0), word(b, 1), word(c, 2), word(d, 3)]
            }),
            Self::Bits10 => unpack(bytes, values, |b: [u8; 5]| {
                let word = |i: usize| u16::from_le_bytes([b[i], b[i + 1]]) >> (2 * i) & 1023;
                [word(0), word(1), word(2), word(3)]
            }),
            Self::Mipi12 => {
                unpack(bytes, values, |[a, b, both]: [u8; 3]| [high(a) | nibble(both), high(b) | low(both)])
            }
            Self::Bits12 => unpack(bytes, values, |[a, both, b]: [u8; 3]| {
                [u16::from(a) | nibble(both) << 8, low(both) | high(b)]
            }),
            Self::Packed12 => {
                unpack(bytes, values, |[a, both, b]: [u8; 3]| [high(a) | nibble(both), high(b) | low(both)])
            }
        }
        Ok(())
    }
}

/// Unpacks groups of N bytes, each into P values.
fn unpack<const N: usize, const P: usize>(
    bytes: &[u8],
    values: &mut Vec<u16>,
    group: impl Fn([u8; N]) -> [u16; P],
) {
    let (groups, _) = bytes.as_chunks::<N>();
    values.resize(P * groups.len(), 0);
    for (to, from) in values.as_chunks_mut::<P>().0.iter_mut().zip(groups) {
        *to = group(*from);
    }
}

/// The bytes of a frame for a playout card, row by row: Cb Y Cr Y.
#[must_use]
pub fn video(frame: &RawFrame) -> Vec<u8> {
    let bytes = |word: &u16| {
        let [luma, chroma] = cable::codes(*word);
        [chroma, luma]
    };
    frame.pixels().iter().flat_map(bytes).collect()
}

fn words_of_video(bytes: &[u8]) -> Result<Vec<u16>, Stray> {
    let word = |(pixel, pair): (usize, &[u8])| {
        let stray = || Stray { pixel, code: if cable::CODES.contains(&pair[0]) { pair[1] } else { pair[0] } };
        cable::word([pair[1], pair[0]]).ok_or_else(stray)
    };
    bytes.chunks_exact(2).enumerate().map(word).collect()
}

/// A name that stands for no packing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("packing '{0}': must be words, bytes, mipi10, 10p, mipi12, 12p, 12packed or 2vuy")]
pub struct WrongPacking(String);

impl std::str::FromStr for Packing {
    type Err = WrongPacking;

    fn from_str(name: &str) -> Result<Self, WrongPacking> {
        Self::ALL
            .into_iter()
            .find(|packing| packing.name() == name)
            .ok_or_else(|| WrongPacking(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_pixels_lie_in_three_bytes_as_each_standard_has_it() {
        // 0xABC and 0x123.
        for (packing, bytes) in [
            (Packing::Mipi12, [0xab, 0x12, 0x3c]),
            (Packing::Bits12, [0xbc, 0x3a, 0x12]),
            (Packing::Packed12, [0xab, 0x3c, 0x12]),
        ] {
            assert_eq!(
                packing.values(&bytes, ByteOrder::Little).unwrap(),
                [0xabc, 0x123],
                "{}",
                packing.name()
            );
            assert_eq!(packing.bytes(2), 3);
        }
        assert_eq!(Packing::Bytes.values(&[7, 255], ByteOrder::Big), Ok(vec![7, 255]));
        assert_eq!(Packing::Words.values(&[1, 2], ByteOrder::Big), Ok(vec![0x102]));
    }

    #[test]
    fn four_pixels_lie_in_five_bytes_as_each_standard_has_it() {
        let pixels = [0x3a5, 0x001, 0x200, 0x15a];
        let high = pixels.map(|pixel| (pixel >> 2) as u8);
        // MIPI CSI-2: the low bits of the first pixel are the lowest of the fifth byte. PFNC: pixel i begins at bit 10·i of the stream.
        let mipi = [&high[..], &[0b10_00_01_01]].concat();
        let stream = pixels.iter().zip(0..).map(|(pixel, i)| u64::from(*pixel) << (10 * i)).sum::<u64>();
        for (packing, bytes) in [(Packing::Mipi10, &mipi[..]), (Packing::Bits10, &stream.to_le_bytes()[..5])]
        {
            assert_eq!(packing.values(bytes, ByteOrder::Little).unwrap(), pixels, "{}", packing.name());
            assert_eq!(packing.bytes(4), 5);
        }
    }

    #[test]
    fn video_has_chroma_before_luma_and_carries_fourteen_bits() {
        let frame =
            RawFrame::from_values(ndarray::array![[0x9e37, 0], [0xffff, 3]], 16, edof_core::CfaPhase::Rggb)
                .unwrap();
        let bytes = video(&frame);
        assert_eq!(bytes, [77, 143, 64, 64, 191, 191, 64, 64]);
        let read = |bytes: &[u8]| Packing::Video.values(bytes, ByteOrder::Little);
        assert_eq!(read(&bytes), Ok(vec![0x9e34, 0, 0xfffc, 0]));
        assert_eq!(read(&[77, 143, 63, 64]), Err(Stray { pixel: 1, code: 63 }));
        assert_eq!(read(&[77, 192]), Err(Stray { pixel: 0, code: 192 }));
    }

    #[test]
    fn packings_are_known_by_name() {
        assert!(Packing::ALL.into_iter().all(|packing| packing.name().parse() == Ok(packing)));
        assert_eq!(
            "raw10".parse::<Packing>().unwrap_err().to_string(),
            "packing 'raw10': must be words, bytes, mipi10, 10p, mipi12, 12p, 12packed or 2vuy"
        );
    }
}
