//! The CRCs that a board makes of every frame at its boundaries (docs/contract.md, 9), from the words of the golden pipeline.

use crate::display::Display;
use crate::frame::Golden;
use edof_core::RawFrame;
use edof_core::geometry::GeometryError;
use edof_device::crc::of_words;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{scalar, windows};
    use edof_core::number::bits_of;
    use edof_core::{CfaPhase, Stride, Window};
    use edof_network::network::{Form, Recurrence, Shrinkage};
    use ndarray::Array2;

    #[test]
    fn checks_are_those_of_the_words_that_the_specification_gives() {
        for recurrence in [Recurrence::Direct, Recurrence::Difference] {
            let form = Form {
                window: Window::new(8).unwrap(),
                codes: 6,
                layers: 4,
                shrinkage: Shrinkage::OneSided,
                recurrence,
                linear_path: true,
                tied: false,
                exposures: 1,
            };
            let network = edof_device::random::extreme(form, 12, Stride::new(4).unwrap(), false, 4);
            let values = Array2::from_shape_fn((14, 18), |(r, c)| (r * 2003 + c * 331) as u16);
            let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap();
            let golden = Golden::new(network.clone()).unwrap();
            let traces: Vec<_> =
                windows::all(&network, &raw).unwrap().map(|window| scalar::run(&network, &window)).collect();
            let crc = |words: &dyn Fn(&crate::Trace) -> Vec<i16>| {
                of_words(traces.iter().flat_map(words).map(|word| word as u16))
            };
            let sent = (0..3).map(|layer| crc(&|trace| trace.layers[layer].sent.clone()));
            let picture = golden.frame(&raw).unwrap().picture(&Display::default()).0;
            let chroma = |row: usize, column: usize| picture.chroma[column % 2][(row, column / 2)];
            let codes = picture
                .luma
                .indexed_iter()
                .map(|((row, column), luma)| u16::from(chroma(row, column)) * 256 + u16::from(*luma));
            let expected = FrameChecks {
                raw: of_words(raw.pixels().iter().copied()),
                windows: crc(&|trace| bits_of(&trace.input).to_vec()),
                stages: sent.chain([crc(&|trace| bits_of(&trace.output).to_vec())]).collect(),
                codes: of_words(codes),
            };
            assert_eq!(golden.checks(&Display::default(), &raw).unwrap(), expected);
        }
    }
}
