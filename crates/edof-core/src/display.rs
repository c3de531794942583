//! The display step's numbers (docs/contract.md, "Display"): from overlap-added 4:2:2 words to the 8-bit Y′CbCr codes on the wire.
//!
//! All products fit the 25×18-bit signed multiplier of a DSP48E1; one pixel a cycle takes four of them to red, green and blue, three
//! to luma and three that Cb and Cr of a pixel pair share: ten.

use serde::{Deserialize, Serialize};

/// How words become codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DisplayMode {
    /// The paper's: a table for luma, chroma rounds to 8 bits. Colours of dark light show too pale.
    Luma,
    /// To red, green and blue light, a table each, and back: every colour shows as the table's curve encodes it.
    #[default]
    Colour,
}

impl DisplayMode {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Luma, Self::Colour];
}

impl std::fmt::Display for DisplayMode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Luma => "luma",
            Self::Colour => "colour",
        })
    }
}

/// A word that names no mode.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("display '{0}': must be luma or colour")]
pub struct UnknownMode(String);

impl std::str::FromStr for DisplayMode {
    type Err = UnknownMode;

    fn from_str(word: &str) -> Result<Self, UnknownMode> {
        Self::ALL.into_iter().find(|m| m.to_string() == word).ok_or_else(|| UnknownMode(word.to_owned()))
    }
}

/// Luma code of black (BT.709, studio range).
pub const BLACK: u8 = 16;
/// Luma code of white.
pub const WHITE: u8 = 235;
/// Luma codes from black to white.
pub const LUMA_CODES: f64 = (WHITE - BLACK) as f64;
/// Chroma code of grey.
pub const CHROMA_ZERO: i32 = 128;
/// A black pixel of the 16-bit bus: chroma in the upper byte, luma in the lower.
pub const BLACK_PIXEL: u16 = (CHROMA_ZERO as u16) << 8 | BLACK as u16;
/// Chroma codes for a colour difference of 1 (BT.709, studio range).
pub const CHROMA_CODES: f64 = 224.0;
/// Least and most code on the wire: 0 and 255 mark syncs.
pub const CODES: [u8; 2] = [1, 254];

/// Entries of the luma table: one for each luma word of 0 or more.
pub const LUMA_ENTRIES: usize = 1 << 15;
/// Address bits of a colour's table: light of 0…1 with [`crate::number::OUTPUT_FRACTION`] fraction bits.
pub const COLOUR_ADDRESS_BITS: u32 = 14;
/// Bits of an entry of a colour's table: encoded light of 0…1 as 0…4095. A table takes six RAMB36E1 (16K×2 each).
pub const COLOUR_ENTRY_BITS: u32 = 12;

/// What Cb and Cr (columns; doubled words) add to luma to give red, green and blue (rows), in units of 2^−[`TO_RGB_SHIFT`].
pub const TO_RGB: [[i32; 2]; 3] = [[0, 58_975], [-7_015, -17_531], [69_491, 0]];
/// Sixteen fraction bits and one for the doubling of chroma.
pub const TO_RGB_SHIFT: u32 = 17;

/// Luma code above black of encoded red, green and blue, in units of 2^−[`TO_LUMA_SHIFT`].
pub const TO_LUMA: [i32; 3] = [11_922, 40_107, 4_049];
/// Fraction bits of [`TO_LUMA`].
pub const TO_LUMA_SHIFT: u32 = 20;

/// Cb and Cr codes (rows) of encoded red, green and blue (columns), each filtered to four times its size, in units of
/// 2^−[`TO_CHROMA_SHIFT`]. Rows add up to zero: grey has no chroma.
pub const TO_CHROMA: [[i32; 3]; 2] = [[-6_572, -22_107, 28_679], [28_679, -26_049, -2_630]];
/// Twenty fraction bits and two for the filter [1 2 1].
pub const TO_CHROMA_SHIFT: u32 = 22;

/// What a sink shows of luma above black, in units of 2^−[`SINK_SHIFT`] of an 8-bit code.
pub const SINK_LUMA: i32 = 76_309;
/// What a sink adds for Cb and Cr (columns; doubled) to red, green and blue (rows).
pub const SINK_CHROMA: [[i32; 2]; 3] = [[0, 58_745], [-6_988, -17_462], [69_219, 0]];
/// Fraction bits of [`SINK_LUMA`]; those of [`SINK_CHROMA`] are one more, for the doubling.
pub const SINK_SHIFT: u32 = 16;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{rgb_from_ycbcr, ycbcr_matrix};
    use crate::number::CHROMA_GAIN;

    fn nearest(exact: f64) -> i32 {
        exact.round() as i32
    }

    #[test]
    fn coefficients_are_the_nearest_to_bt709() {
        let entry = f64::from((1 << COLOUR_ENTRY_BITS) - 1);
        let [luma, cb, cr] = ycbcr_matrix();
        let from = [rgb_from_ycbcr(0.0, 1.0, 0.0), rgb_from_ycbcr(0.0, 0.0, 1.0)];
        let unit = |shift: u32| f64::from(1 << shift);
        for plane in 0..3 {
            assert_eq!(TO_LUMA[plane], nearest(LUMA_CODES / entry * luma[plane] * unit(TO_LUMA_SHIFT)));
            for which in 0..2 {
                let light = from[which][plane] / CHROMA_GAIN / 2.0;
                assert_eq!(TO_RGB[plane][which], nearest(light * unit(TO_RGB_SHIFT)));
                let code = CHROMA_CODES / entry / 4.0 * [cb, cr][which][plane];
                assert_eq!(TO_CHROMA[which][plane], nearest(code * unit(TO_CHROMA_SHIFT)));
                let shown = 255.0 / CHROMA_CODES * from[which][plane] / 2.0;
                assert_eq!(SINK_CHROMA[plane][which], nearest(shown * unit(SINK_SHIFT)));
            }
        }
        assert_eq!(SINK_LUMA, nearest(255.0 / LUMA_CODES * unit(SINK_SHIFT)));
        assert!(TO_CHROMA.iter().all(|row| row.iter().sum::<i32>() == 0), "grey would have a tint");
    }

    #[test]
    fn every_product_fits_a_multiplier_of_25_by_18_bits() {
        let fits = |value: i32, bits: u32| (-(1 << (bits - 1))..1 << (bits - 1)).contains(&value);
        let doubled_chroma = [2 * i32::from(i16::MIN), 2 * i32::from(i16::MAX)];
        let filtered = 4 * ((1 << COLOUR_ENTRY_BITS) - 1);
        assert!(doubled_chroma.into_iter().chain([filtered]).all(|word| fits(word, 25)));
        let coefficients = TO_RGB.iter().flatten().chain(&TO_LUMA).chain(TO_CHROMA.iter().flatten());
        assert!(coefficients.into_iter().all(|c| fits(*c, 18)));
    }

    #[test]
    fn modes_are_known_by_name() {
        assert_eq!("colour".parse(), Ok(DisplayMode::default()));
        assert_eq!("luma".parse(), Ok(DisplayMode::Luma));
        assert_eq!(
            "grey".parse::<DisplayMode>().unwrap_err().to_string(),
            "display 'grey': must be luma or colour"
        );
    }
}
