//! The CRCs that a board makes of every frame at its boundaries (docs/contract.md, 9), from the words of the golden pipeline.

use crate::display::Display;
use crate::frame::Golden;
use edof_device::crc::of_words;
use edof_image::RawFrame;
use edof_image::geometry::GeometryError;

/// CRC-32 of one frame at each boundary, in the order in which data pass.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameChecks {
    /// Raw pixel words that the calculator takes, row by row.
    pub raw: u32,
    /// Input words of the windows, one window after the other.
    pub windows: u32,
    /// What each stage sends: z, or its change in the difference form; of F its results.
    pub stages: Vec<u32>,
    /// Codes of the picture, a word of 16 bits per pixel: Y' low, Cb' or Cr' high.
    pub codes: u32,
}

impl Golden {
    /// The CRCs of a red-first frame that is taken as it is; `carried` frames are those that came over a cable.
    ///
    /// # Errors
    /// [`GeometryError`] for a frame too small for a window.
    pub fn checks(&self, display: &Display, raw: &RawFrame) -> Result<FrameChecks, GeometryError> {
        let of = |words: &ndarray::Array3<i16>| of_words(words.iter().map(|word| word.cast_unsigned()));
        let boundaries = self.words(raw)?;
        let crc =
            |name: &str| boundaries.iter().find(|found| found.name == name).map(|found| of(&found.words));
        let shrinkages = self.network().form.shrinkages();
        let sent = |t: usize| crc(&format!("v{t}")).or_else(|| crc(&format!("z{t}")));
        let stages = (1..=shrinkages).map(sent).chain([crc("f")]);
        let picture = self.frame(raw)?.picture(display).0.yuyv();
        let codes = picture.chunks_exact(2).map(|two| u16::from_le_bytes([two[0], two[1]]));
        Ok(FrameChecks {
            raw: of_words(raw.pixels().iter().copied()),
            windows: crc("y").unwrap_or(0),
            stages: stages.map(Option::unwrap_or_default).collect(),
            codes: of_words(codes),
        })
    }
}
