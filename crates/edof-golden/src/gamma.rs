//! Light to codes by look-up tables that the host can load: one for luma, one for each colour.

use edof_core::colour::{srgb_decode, srgb_encode};
use edof_core::display::{BLACK, CODES, COLOUR_ADDRESS_BITS, COLOUR_ENTRY_BITS, LUMA_CODES, LUMA_ENTRIES};
use edof_core::number::{OutputSum, OutputWord, TableIndex, bits_of_mut};
use edof_core::{ColourFrame, Tone};

/// Entries of a colour's table.
pub(crate) const COLOUR_ENTRIES: usize = 1 << COLOUR_ADDRESS_BITS;
/// Returns the first words from 0 on.
fn words(count: usize) -> impl Iterator<Item = OutputWord> {
    (0..count).map(|word| OutputWord::from_bits(word as i16))
}

/// Largest entry of a colour's table: light of 1.
const COLOUR_MAX: u16 = (1 << COLOUR_ENTRY_BITS) - 1;

/// A transfer curve: encoded light (0…1) for linear light (0…1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Curve {
    /// Codes proportional to light.
    Linear,
    /// sRGB's curve, for people who look at an sRGB screen.
    #[default]
    Srgb,
    /// BT.709's camera curve.
    Bt709,
}

impl Curve {
    /// Encoded light for light of 0…1.
    #[must_use]
    pub fn encode(self, light: f64) -> f64 {
        match self {
            Self::Linear => light,
            Self::Srgb => srgb_encode(light),
            Self::Bt709 if light < 0.018 => 4.5 * light,
            Self::Bt709 => 1.099 * light.powf(0.45) - 0.099,
        }
    }

    /// A frame of light as the numbers of a picture; all but the linear curve hold them to 0…1.
    #[must_use]
    pub fn encoded(self, mut light: ColourFrame) -> ColourFrame {
        if self != Self::Linear {
            light.planes.mapv_inplace(|v| self.encode(f64::from(v.clamp(0.0, 1.0))) as f32);
        }
        light
    }

    /// Returns the curve at a word, times `scale`, plus `zero`; rounded, ties up. Words of 1 and above are white.
    fn entry(self, values: Tone, word: OutputWord, scale: f64, zero: f64) -> f64 {
        let value = f64::from(word).min(1.0);
        let encoded = match (values, self) {
            (Tone::Srgb, Self::Srgb) => value,
            _ => self.encode(light(values, value)),
        };
        (zero + scale * encoded + 0.5).floor()
    }
}

/// Returns the light of a value.
pub(crate) fn light(values: Tone, value: f64) -> f64 {
    match values {
        Tone::Srgb => srgb_decode(value),
        Tone::Linear => value,
    }
}

/// A table that the board cannot load.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum TableError {
    /// Wrong length.
    #[error("{what} table: {found} entries, expected {expected}")]
    Length { what: &'static str, found: usize, expected: usize },
    /// An entry that cannot be sent.
    #[error("{what} table: entry {index} is {value}, expected {min} to {max}")]
    Entry { what: &'static str, index: usize, value: u16, min: u16, max: u16 },
}

/// An 8-bit code for each luma word of 0 or more; negative words read entry 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LumaTable(Vec<u8>);

impl LumaTable {
    /// From black at light 0 to white at light 1 and above.
    #[must_use]
    pub fn new(curve: Curve) -> Self {
        Self::of_values(Tone::Linear, curve)
    }

    /// The same for words that are values of a tone.
    #[must_use]
    pub fn of_values(values: Tone, curve: Curve) -> Self {
        let entry = |word| curve.entry(values, word, LUMA_CODES, f64::from(BLACK)) as u8;
        Self(words(LUMA_ENTRIES).map(entry).collect())
    }

    /// A table of the user.
    ///
    /// # Errors
    /// [`TableError`] for a wrong length or a sync code.
    pub fn from_entries(entries: Vec<u8>) -> Result<Self, TableError> {
        let [min, max] = CODES.map(u16::from);
        check("luma", entries.iter().map(|code| u16::from(*code)), LUMA_ENTRIES, min, max)?;
        Ok(Self(entries))
    }

    /// The entries, that of word 0 first.
    #[must_use]
    pub fn entries(&self) -> &[u8] {
        &self.0
    }

    /// The code of a luma word.
    #[must_use]
    pub fn code(&self, word: OutputWord) -> u8 {
        self.0[word.max(OutputWord::ZERO).to_bits() as usize]
    }
}

/// A 12-bit encoded value for each light of 0…1; what lies outside reads the first or last entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColourTable(Vec<u16>);

impl ColourTable {
    /// From 0 at no light to 4095 at light 1.
    #[must_use]
    pub fn new(curve: Curve) -> Self {
        Self::of_values(Tone::Linear, curve)
    }

    /// The same for words that are values of a tone.
    #[must_use]
    pub fn of_values(values: Tone, curve: Curve) -> Self {
        let entry = |word| curve.entry(values, word, f64::from(COLOUR_MAX), 0.0) as u16;
        Self(words(COLOUR_ENTRIES).map(entry).collect())
    }

    /// The same with `gain` times the light: white from light of 1/`gain` on.
    #[must_use]
    pub fn amplified(values: Tone, curve: Curve, gain: f64) -> Self {
        let entry = |word: OutputWord| {
            let amplified = (gain * light(values, f64::from(word).min(1.0))).min(1.0);
            (f64::from(COLOUR_MAX) * curve.encode(amplified) + 0.5).floor() as u16
        };
        Self(words(COLOUR_ENTRIES).map(entry).collect())
    }

    /// A table of the user.
    ///
    /// # Errors
    /// [`TableError`] for a wrong length or an entry of more than 12 bits.
    pub fn from_entries(entries: Vec<u16>) -> Result<Self, TableError> {
        check("colour", entries.iter().copied(), COLOUR_ENTRIES, 0, COLOUR_MAX)?;
        Ok(Self(entries))
    }

    /// The entries, that of no light first.
    #[must_use]
    pub fn entries(&self) -> &[u16] {
        &self.0
    }

    /// Returns the encoded value of light.
    #[must_use]
    pub fn encoded(&self, light: OutputSum) -> u16 {
        self.0[usize::from(index(light).to_bits())]
    }

    /// Puts the entries in the place of their indices.
    pub fn encode(&self, light: &mut [TableIndex]) {
        if let Some(entries) = self.0.first_chunk::<COLOUR_ENTRIES>() {
            let words = bits_of_mut(light).iter_mut();
            words.for_each(|word| *word = entries[usize::from(*word) % COLOUR_ENTRIES]);
        }
    }
}

/// Returns the index of light: what is below 0 or above the last entry reads the first or the last.
#[inline(always)]
pub(crate) fn index(light: OutputSum) -> TableIndex {
    const LAST: OutputSum = OutputSum::from_bits(COLOUR_ENTRIES as i32 - 1);
    TableIndex::from_bits(light.clamp(OutputSum::ZERO, LAST).to_bits() as u16)
}

fn check(
    what: &'static str,
    mut entries: impl ExactSizeIterator<Item = u16>,
    expected: usize,
    min: u16,
    max: u16,
) -> Result<(), TableError> {
    let found = entries.len();
    if found != expected {
        return Err(TableError::Length { what, found, expected });
    }
    let wrong = |(index, value)| TableError::Entry { what, index, value, min, max };
    let outside = |(_, value): &(usize, u16)| !(min..=max).contains(value);
    match entries.by_ref().enumerate().find(outside) {
        Some(entry) => Err(wrong(entry)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::display::WHITE;
    use edof_core::number::bits_of;

    const CURVES: [Curve; 3] = [Curve::Linear, Curve::Srgb, Curve::Bt709];

    #[test]
    fn black_white_and_what_lies_beyond() {
        for curve in CURVES {
            let luma = LumaTable::new(curve);
            let code = |word| luma.code(OutputWord::from_bits(word));
            assert_eq!([i16::MIN, -1, 0].map(code), [BLACK; 3]);
            assert_eq!([1 << 14, i16::MAX].map(code), [WHITE; 2]);
            assert!(luma.entries().is_sorted());
            let colour = ColourTable::new(curve);
            let encoded = |light| colour.encoded(OutputSum::from_bits(light));
            assert_eq!([-40_000, -1, 0].map(encoded), [0; 3]);
            assert_eq!([(1 << 14) - 1, 1 << 14, 80_000].map(encoded), [4095; 3]);
            assert!(colour.entries().is_sorted());
        }
        assert_eq!(LumaTable::new(Curve::Linear).code(OutputWord::lit("0.5")), 126);
        assert_eq!(LumaTable::new(Curve::Srgb).code(OutputWord::from_bits(3506)), 125);
        assert_eq!(ColourTable::new(Curve::Linear).encoded(OutputSum::lit("0.5")), 2048);
    }

    #[test]
    fn amplified_light_is_shown_as_that_much_light() {
        for (values, curve) in Tone::ALL.into_iter().flat_map(|tone| CURVES.map(|curve| (tone, curve))) {
            let usual = ColourTable::of_values(values, curve);
            let same = ColourTable::amplified(values, curve, 1.0);
            assert!(usual.entries().iter().zip(same.entries()).all(|(a, b)| a.abs_diff(*b) <= 1));
        }
        for curve in CURVES {
            let (usual, doubled) =
                (ColourTable::new(curve), ColourTable::amplified(Tone::Linear, curve, 2.0));
            let encoded = |table: &ColourTable, light| table.encoded(OutputSum::from_bits(light));
            assert!((0..1 << 13).all(|light| encoded(&doubled, light) == encoded(&usual, 2 * light)));
            assert!((1 << 13..1 << 14).all(|light| encoded(&doubled, light) == 4095));
        }
    }

    #[test]
    fn words_that_are_srgbs_values_are_shown_as_their_light_is() {
        assert_eq!(ColourTable::of_values(Tone::Srgb, Curve::Srgb), ColourTable::new(Curve::Linear));
        assert_eq!(LumaTable::of_values(Tone::Srgb, Curve::Srgb), LumaTable::new(Curve::Linear));
        for curve in CURVES {
            let (of_values, of_light) = (ColourTable::of_values(Tone::Srgb, curve), ColourTable::new(curve));
            for light in (0..1 << 14).step_by(97) {
                let value = srgb_encode(f64::from(light) / f64::from(1 << 14));
                let word = OutputSum::from_bits((value * f64::from(1 << 14)).round() as i32);
                let (found, expected) =
                    (of_values.encoded(word), of_light.encoded(OutputSum::from_bits(light)));
                assert!(found.abs_diff(expected) <= 2, "{curve:?} {light}: {found}, {expected}");
            }
        }
    }

    #[test]
    fn curves_are_those_of_their_standards() {
        let near =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found}, {expected}");
        for light in [-0.5, 0.0, 0.3, 1.0, 1.5] {
            near(Curve::Linear.encode(light), light);
        }
        for (light, encoded) in [(0.0, 0.0), (0.01, 0.045), (0.018, 0.081248), (0.5, 0.705515), (1.0, 1.0)] {
            near(Curve::Bt709.encode(light), encoded);
        }
        for (light, encoded) in [(0.0, 0.0), (0.002, 0.02584), (0.214041, 0.5), (1.0, 1.0)] {
            near(Curve::Srgb.encode(light), encoded);
        }
    }

    #[test]
    fn a_frame_of_light_is_held_to_what_a_screen_has_but_by_the_linear_curve() {
        let light = [-0.5, 0.01, 0.5, 1.25];
        let planes = ndarray::Array3::from_shape_fn((3, 2, 4), |(.., column)| light[column]);
        for curve in CURVES {
            let encoded = curve.encoded(ColourFrame { planes: planes.clone() });
            for ((.., column), found) in encoded.planes.indexed_iter() {
                let held = if curve == Curve::Linear { light[column] } else { light[column].clamp(0.0, 1.0) };
                assert_eq!(*found, curve.encode(f64::from(held)) as f32);
            }
        }
    }

    #[test]
    fn addresses_are_replaced_by_their_entries() {
        let table = ColourTable::new(Curve::Srgb);
        let mut light: Vec<TableIndex> = (0..1 << 14).rev().map(TableIndex::from_bits).collect();
        table.encode(&mut light);
        assert!(bits_of(&light).iter().rev().eq(table.entries()));
        let encoded = |light| table.encoded(OutputSum::from_bits(light));
        assert!((0..1 << 14).all(|light| encoded(light) == table.entries()[light as usize]));
    }

    #[test]
    fn a_table_comes_back_and_wrong_ones_are_rejected() {
        let table = LumaTable::new(Curve::Srgb).entries().to_vec();
        assert_eq!(LumaTable::from_entries(table.clone()), Ok(LumaTable::new(Curve::Srgb)));
        let error = LumaTable::from_entries(vec![16; 256]).unwrap_err();
        assert_eq!(error.to_string(), "luma table: 256 entries, expected 32768");
        let mut sync = table;
        sync[7] = 255;
        let error = LumaTable::from_entries(sync).unwrap_err();
        assert_eq!(error.to_string(), "luma table: entry 7 is 255, expected 1 to 254");
        let mut table = ColourTable::new(Curve::Bt709).entries().to_vec();
        assert_eq!(ColourTable::from_entries(table.clone()), Ok(ColourTable::new(Curve::Bt709)));
        table[9] = 4096;
        let error = ColourTable::from_entries(table).unwrap_err();
        assert_eq!(error.to_string(), "colour table: entry 9 is 4096, expected 0 to 4095");
    }
}
