//! The display step's numbers (docs/contract.md, "Display"): from overlap-added 4:2:2 words to the 8-bit Y′CbCr codes on the wire.
//!
//! All products fit the 25×18-bit signed multiplier of a DSP48E1; one pixel a cycle takes four of them to red, green and blue, three
//! to luma and three that Cb and Cr of a pixel pair share: ten.

use crate::number::TableIndex;
use fixed::types::{I10F22, I12F20, I15F17, I16F16};
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
/// Address bits of a colour's table: light of 0 to 1 − 2^−14, a [`TableIndex`].
pub const COLOUR_ADDRESS_BITS: u32 = TableIndex::FRAC_NBITS;
/// Bits of an entry of a colour's table: encoded light of 0…1 as 0…4095, a code and no binary fraction. A table takes six RAMB36E1
/// (16K×2 each).
pub const COLOUR_ENTRY_BITS: u32 = 12;

/// Factor of doubled chroma in light: sixteen fraction bits and one for the doubling.
pub type ToRgb = I15F17;
/// Factor of an encoded colour in luma.
pub type ToLuma = I12F20;
/// Factor of an encoded colour in chroma: twenty fraction bits and two for the filter [1 2 1].
pub type ToChroma = I10F22;
/// Factor of a code in what a sink shows.
pub type Sink = I16F16;

/// What doubled Cb and Cr (columns) add to luma to give red, green and blue (rows).
pub const TO_RGB: [[ToRgb; 2]; 3] =
    [[ToRgb::ZERO, rgb(58_975)], [rgb(-7_015), rgb(-17_531)], [rgb(69_491), ToRgb::ZERO]];

/// Luma code above black of encoded red, green and blue.
pub const TO_LUMA: [ToLuma; 3] =
    [ToLuma::from_bits(11_922), ToLuma::from_bits(40_107), ToLuma::from_bits(4_049)];

/// Cb and Cr codes (rows) of encoded red, green and blue (columns), each filtered to four times its size. Rows add up to zero: grey has no chroma.
pub const TO_CHROMA: [[ToChroma; 3]; 2] =
    [[chroma(-6_572), chroma(-22_107), chroma(28_679)], [chroma(28_679), chroma(-26_049), chroma(-2_630)]];

/// 8-bit codes that a sink shows per luma code above black.
pub const SINK_LUMA: Sink = Sink::from_bits(76_309);
/// What a sink adds for doubled Cb and Cr codes (columns) to red, green and blue (rows).
pub const SINK_CHROMA: [[Sink; 2]; 3] =
    [[Sink::ZERO, sink(58_745)], [sink(-6_988), sink(-17_462)], [sink(69_219), Sink::ZERO]];

const fn rgb(bits: i32) -> ToRgb {
    ToRgb::from_bits(bits)
}

const fn chroma(bits: i32) -> ToChroma {
    ToChroma::from_bits(bits)
}

const fn sink(bits: i32) -> Sink {
    Sink::from_bits(bits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{rgb_from_ycbcr, ycbcr_matrix};
    use crate::number::CHROMA_GAIN;

    #[test]
    fn coefficients_are_the_nearest_to_bt709() {
        let entry = f64::from((1 << COLOUR_ENTRY_BITS) - 1);
        let [luma, cb, cr] = ycbcr_matrix();
        let from = [rgb_from_ycbcr(0.0, 1.0, 0.0), rgb_from_ycbcr(0.0, 0.0, 1.0)];
        for plane in 0..3 {
            assert_eq!(TO_LUMA[plane], ToLuma::from_num(LUMA_CODES / entry * luma[plane]));
            for which in 0..2 {
                let light = from[which][plane] / CHROMA_GAIN / 2.0;
                assert_eq!(TO_RGB[plane][which], ToRgb::from_num(light));
                let code = CHROMA_CODES / entry / 4.0 * [cb, cr][which][plane];
                assert_eq!(TO_CHROMA[which][plane], ToChroma::from_num(code));
                let shown = 255.0 / CHROMA_CODES * from[which][plane] / 2.0;
                assert_eq!(SINK_CHROMA[plane][which], Sink::from_num(shown));
            }
        }
        assert_eq!(SINK_LUMA, Sink::from_num(255.0 / LUMA_CODES));
        assert!(TO_CHROMA.iter().all(|row| row.iter().sum::<ToChroma>() == 0), "grey would have a tint");
    }

    #[test]
    fn every_product_fits_a_multiplier_of_25_by_18_bits() {
        let fits = |value: i32, bits: u32| (-(1 << (bits - 1))..1 << (bits - 1)).contains(&value);
        let doubled_chroma = [2 * i32::from(i16::MIN), 2 * i32::from(i16::MAX)];
        let filtered = 4 * ((1 << COLOUR_ENTRY_BITS) - 1);
        assert!(doubled_chroma.into_iter().chain([filtered]).all(|word| fits(word, 25)));
        let rgb = TO_RGB.iter().flatten().map(|c| c.to_bits());
        let luma = TO_LUMA.iter().map(|c| c.to_bits());
        let chroma = TO_CHROMA.iter().flatten().map(|c| c.to_bits());
        assert!(rgb.chain(luma).chain(chroma).all(|c| fits(c, 18)));
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
