//! PGM and PPM (P2, P3, P5, P6) with any maximum value, so that raw frames keep their values: sensors of 10 to 14 bits state
//! 1023 to 16383 there.

use crate::samples::Samples;
use ndarray::{Array3, ArrayView3};

/// Bytes that are no PGM or PPM.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum PnmError {
    /// The header ends early or holds no number where one belongs.
    #[error("{field} in the header is missing or no number")]
    Header { field: &'static str },
    /// Width, height or maximum value out of range.
    #[error("{field} is {value}, expected 1 to 65535")]
    Range { field: &'static str, value: usize },
    /// Fewer samples than the header states.
    #[error("{found} samples, {expected} expected")]
    Truncated { found: usize, expected: usize },
    /// A sample above the maximum value.
    #[error("a sample is {value}, more than the stated maximum of {full_scale}")]
    Sample { value: u32, full_scale: u16 },
}

/// Samples of a PGM or PPM file.
///
/// # Errors
/// Any [`PnmError`].
pub fn decode(bytes: &[u8]) -> Result<Samples, PnmError> {
    let Header { kind, width, height, full_scale, mut words } = Header::of(bytes)?;
    let channels = channels(kind);
    let expected = width * height * channels;
    let body = words.body();
    let samples: Vec<u32> = match (kind, full_scale) {
        (b'2' | b'3', _) => {
            std::iter::from_fn(|| words.number().map(|v| v.min(1 << 16) as u32)).take(expected).collect()
        }
        (_, ..256) => body.iter().take(expected).map(|&b| u32::from(b)).collect(),
        _ => {
            let pairs = body.chunks_exact(2).take(expected);
            pairs.map(|p| u32::from(u16::from_be_bytes([p[0], p[1]]))).collect()
        }
    };
    if let Some(&value) = samples.iter().find(|v| **v > u32::from(full_scale)) {
        return Err(PnmError::Sample { value, full_scale });
    }
    let truncated = PnmError::Truncated { found: samples.len(), expected };
    let whole = ArrayView3::from_shape((height, width, channels), &samples).map_err(|_| truncated)?;
    let planes = Array3::from_shape_fn((channels, height, width), |(p, r, c)| whole[(r, c, p)] as u16);
    Ok(Samples { planes, full_scale })
}

/// Returns whether another picture follows the first one, as in a stream of binary ones.
#[must_use]
pub fn is_first_of_several(bytes: &[u8]) -> bool {
    let Ok(Header { kind: kind @ (b'5' | b'6'), width, height, full_scale, words }) = Header::of(bytes)
    else {
        return false;
    };
    let length = width * height * channels(kind) * if full_scale < 256 { 1 } else { 2 };
    let rest = words.body().get(length..).unwrap_or(&[]).trim_ascii_start();
    Header::of(rest).is_ok() && rest.starts_with(b"P")
}

/// What stands before the samples.
struct Header<'a> {
    kind: u8,
    width: usize,
    height: usize,
    full_scale: u16,
    words: Words<'a>,
}

impl<'a> Header<'a> {
    fn of(bytes: &'a [u8]) -> Result<Self, PnmError> {
        let kind = bytes.get(1).copied().unwrap_or(0);
        let mut words = Words { rest: bytes.get(2..).unwrap_or(&[]) };
        let mut number = |field| match words.number() {
            None => Err(PnmError::Header { field }),
            Some(value @ 1..=65535) => Ok(value),
            Some(value) => Err(PnmError::Range { field, value }),
        };
        let (width, height) = (number("width")?, number("height")?);
        let full_scale = number("maximum value")? as u16;
        Ok(Self { kind, width, height, full_scale, words })
    }
}

/// Samples of a pixel.
const fn channels(kind: u8) -> usize {
    if matches!(kind, b'3' | b'6') { 3 } else { 1 }
}

/// A binary PGM (one plane) or PPM (three planes).
#[must_use]
pub fn encode(samples: &Samples) -> Vec<u8> {
    let (channels, height, width) = samples.planes.dim();
    let kind = if channels == 1 { 5 } else { 6 };
    let mut bytes = format!("P{kind}\n{width} {height}\n{}\n", samples.full_scale).into_bytes();
    for &sample in samples.planes.view().permuted_axes([1, 2, 0]) {
        if samples.full_scale < 256 {
            bytes.push(sample.min(255) as u8);
        } else {
            bytes.extend(sample.to_be_bytes());
        }
    }
    bytes
}

/// Numbers in text, white space and `#` comments between them.
struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Words<'a> {
    /// What follows the header of a binary kind, which one byte of white space ends.
    fn body(&self) -> &'a [u8] {
        self.rest.get(1..).unwrap_or(&[])
    }

    fn number(&mut self) -> Option<usize> {
        loop {
            match self.rest {
                [b'#', ..] => {
                    let end = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
                    self.rest = &self.rest[end..];
                }
                [space, tail @ ..] if space.is_ascii_whitespace() => self.rest = tail,
                _ => break,
            }
        }
        let digits = self.rest.iter().take_while(|b| b.is_ascii_digit()).count();
        let (word, rest) = self.rest.split_at(digits);
        self.rest = rest;
        std::str::from_utf8(word).ok()?.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn text_with_comments_is_read() {
        let samples = decode(b"P2\n# a comment\n3 1 # another\n4095\n0 17 4095\n").unwrap();
        assert_eq!(
            (samples.full_scale, samples.planes.into_raw_vec_and_offset().0),
            (4095, vec![0, 17, 4095])
        );
    }

    #[test]
    fn a_stream_of_pictures_is_known_by_its_second_header() {
        let one = b"P5 2 2 255\nabcd";
        let with = |rest: &[u8]| is_first_of_several(&[&one[..], rest].concat());
        assert!(with(one) && with(b"\nP6 1 1 1023\n"));
        assert!(!with(b"") && !with(b"\n") && !with(b"P5") && !with(b"Q5 2 2 255\n"));
        assert!(is_first_of_several(b"P6 1 1 1023\nabcdefP6 1 1 1023\nabcdef"));
        assert!(!is_first_of_several(b"P5 2 2 255\nab"), "cut");
    }

    #[test]
    fn wrong_headers_and_bodies_are_told_apart() {
        let refused = |text: &[u8]| decode(text).unwrap_err().to_string();
        assert_eq!(refused(b"P5 4"), "height in the header is missing or no number");
        assert_eq!(refused(b"P5 4 4 70000\n"), "maximum value is 70000, expected 1 to 65535");
        assert_eq!(refused(b"P5 0 4 255\n"), "width is 0, expected 1 to 65535");
        assert_eq!(refused(b"P5 2 2 255\nabc"), "3 samples, 4 expected");
        assert_eq!(refused(b"P2 1 1 15\n16"), "a sample is 16, more than the stated maximum of 15");
    }

    proptest! {
        #[test]
        fn every_picture_comes_back(
            height in 1usize..6, width in 1usize..6, colour: bool, full_scale in 1u16..=65535, seed: u64
        ) {
            let planes = Array3::from_shape_fn((if colour { 3 } else { 1 }, height, width), |(p, r, c)| {
                let mixed = seed.wrapping_mul(6_364_136_223_846_793_005).rotate_left((p * 36 + r * 6 + c) as u32 % 64);
                (mixed % (u64::from(full_scale) + 1)) as u16
            });
            let samples = Samples { planes, full_scale };
            prop_assert_eq!(decode(&encode(&samples)), Ok(samples));
        }

        #[test]
        fn no_bytes_make_it_panic(kind in prop::sample::select(vec![b'2', b'3', b'5', b'6']), tail: Vec<u8>) {
            let _ = decode(&[vec![b'P', kind, b' '], tail].concat());
        }
    }
}
