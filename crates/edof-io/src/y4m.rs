//! YUV4MPEG2 (y4m): uncompressed 8-bit Y′CbCr, frame after frame, as ffmpeg, mpv and mjpegtools take it.

use crate::raw::Size;
use ndarray::Array2;
use std::fmt;
use std::io::{self, Write};
use std::str::FromStr;

/// Frames per second, a ratio.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    frames: u32,
    seconds: u32,
}

/// A text that is no rate.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("rate '{0}': must be frames per second, 1 to 100000, or a ratio such as 30000:1001")]
pub struct WrongRate(String);

impl FromStr for Rate {
    type Err = WrongRate;

    fn from_str(text: &str) -> Result<Self, WrongRate> {
        let (frames, seconds) = text.split_once([':', '/']).unwrap_or((text, "1"));
        let number = |word: &str| word.parse().ok().filter(|number| (1..=100_000).contains(number));
        number(frames)
            .zip(number(seconds))
            .map(|(frames, seconds)| Self { frames, seconds })
            .ok_or_else(|| WrongRate(text.to_owned()))
    }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.frames, self.seconds)
    }
}

/// Returns the line that begins a stream of progressive frames in 4:2:2 and studio range.
#[must_use]
pub fn header(Size { width, height }: Size, rate: Rate) -> String {
    format!("YUV4MPEG2 W{width} H{height} F{rate} Ip A1:1 C422 XCOLORRANGE=LIMITED\n")
}

/// Writes a frame: luma, rows × columns, then Cb and Cr, rows × columns/2.
///
/// # Errors
/// What the system says.
pub fn write_frame(out: &mut dyn Write, planes: [&Array2<u8>; 3]) -> io::Result<()> {
    out.write_all(b"FRAME\n")?;
    write_planes(out, planes)
}

/// Writes the planes of a frame alone, one after the other.
///
/// # Errors
/// What the system says.
pub fn write_planes(out: &mut dyn Write, planes: [&Array2<u8>; 3]) -> io::Result<()> {
    planes.into_iter().try_for_each(|plane| match plane.as_slice() {
        Some(codes) => out.write_all(codes),
        None => out.write_all(&plane.iter().copied().collect::<Vec<u8>>()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_is_a_line_and_planes_behind_a_word_each() {
        let rate: Rate = "30000/1001".parse().unwrap();
        let size = Size { width: 4, height: 2 };
        assert_eq!(header(size, rate), "YUV4MPEG2 W4 H2 F30000:1001 Ip A1:1 C422 XCOLORRANGE=LIMITED\n");
        let mut bytes = vec![];
        let luma = ndarray::array![[1, 2, 3, 4], [5, 6, 7, 8]];
        // Planes in another order in memory, too.
        let cb = ndarray::array![[9, 11], [10, 12]].reversed_axes();
        write_frame(&mut bytes, [&luma, &cb, &ndarray::array![[13, 14], [15, 16]]]).unwrap();
        assert_eq!(bytes, [b"FRAME\n", &(1..=16).collect::<Vec<u8>>()[..]].concat());
    }

    #[test]
    fn a_rate_is_a_number_or_a_ratio() {
        assert_eq!("25".parse::<Rate>().unwrap().to_string(), "25:1");
        for text in ["", "0", "29.97", "1:0", "-1", "30:1:1", "200000"] {
            let told = text.parse::<Rate>().unwrap_err().to_string();
            assert!(told.starts_with(&format!("rate '{text}': must be frames per second")), "{told}");
        }
    }
}
