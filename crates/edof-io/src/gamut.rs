//! Primaries that picture files state, where they are other than sRGB's.
//!
//! A PNG states them in cICP, iCCP, sRGB or cHRM, of which the first counts; JPEG, WebP and TIFF by an ICC profile.

use crate::picture::Format;
use crate::png_chunks::chunks;
use crate::profile::Profile;
use std::fmt::{self, Display, Formatter};

/// Primaries other than sRGB's, by their name and where they are stated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Gamut(String);

impl Display for Gamut {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Gamut {
    /// Reads what a file in memory states; none where it states nothing, or sRGB's primaries.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if Format::of(bytes)? != Format::Png {
            return of_profile(&Profile::of(bytes)?);
        }
        let find =
            |wanted: &[u8; 4]| chunks(bytes).find(|(name, _)| *name == wanted).map(|(_, content)| content);
        // Unspecified primaries (2) leave the word to what follows.
        if let Some([primaries, ..]) = find(b"cICP").filter(|content| content.first() != Some(&2)) {
            return coded(*primaries);
        }
        if find(b"iCCP").is_some() {
            return of_profile(&Profile::of(bytes)?);
        }
        if find(b"sRGB").is_some() { None } else { chromaticities(find(b"cHRM")?) }
    }
}

/// Primaries of cICP (ITU-T H.273, table 2).
fn coded(primaries: u8) -> Option<Gamut> {
    let name = match primaries {
        1 => return None,
        4 => "BT.470M",
        5 => "BT.601 (625 lines)",
        6 | 7 => "BT.601 (525 lines)",
        8 => "film",
        9 => "BT.2020",
        10 => "XYZ",
        11 => "DCI-P3",
        12 => "Display P3",
        22 => "EBU Tech. 3213",
        _ => "unknown primaries",
    };
    Some(Gamut(format!("{name} (cICP {primaries})")))
}

/// X, Y and Z of sRGB's red, green and blue for the white D50.
const SRGB: [[f64; 3]; 3] = [[0.4361, 0.2225, 0.0139], [0.3851, 0.7169, 0.0971], [0.1431, 0.0606, 0.7141]];
/// Largest difference of a coordinate from sRGB's that is taken for rounding or another adaptation of the white.
const EQUAL: f64 = 0.01;

fn of_profile(profile: &Profile) -> Option<Gamut> {
    let colours = profile.colours()?;
    let pairs = colours.as_flattened().iter().zip(SRGB.as_flattened());
    if pairs.into_iter().all(|(own, srgb)| (own - srgb).abs() <= EQUAL) {
        return None;
    }
    let name = profile.name().map_or_else(|| "unnamed primaries".to_owned(), |name| format!("'{name}'"));
    Some(Gamut(format!("{name} (ICC profile)")))
}

/// x and y of BT.709's white, red, green and blue, which are sRGB's.
const CHROMATICITIES: [f64; 8] = [0.3127, 0.3290, 0.64, 0.33, 0.30, 0.60, 0.15, 0.06];

fn chromaticities(content: &[u8]) -> Option<Gamut> {
    let (numbers, _) = content.as_chunks::<4>();
    let own = numbers.iter().map(|bytes| f64::from(u32::from_be_bytes(*bytes)) / 1e5);
    let is_srgb = own.zip(CHROMATICITIES).all(|(own, srgb)| (own - srgb).abs() <= EQUAL);
    (numbers.len() == CHROMATICITIES.len() && !is_srgb).then(|| Gamut("unnamed primaries (cHRM)".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::tests::{profile, xyz};
    use crate::transfer::tests::png;

    fn stated(more: &[(&[u8; 4], &[u8])]) -> String {
        Gamut::of(&png(more)).map_or("nothing".to_owned(), |gamut| gamut.to_string())
    }

    fn chrm(values: [u32; 8]) -> Vec<u8> {
        values.iter().flat_map(|value| value.to_be_bytes()).collect()
    }

    const P3: [u32; 8] = [31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000];
    const BT709: [u32; 8] = [31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000];

    #[test]
    fn each_chunk_states_its_primaries() {
        assert_eq!(stated(&[]), "nothing");
        assert_eq!(stated(&[(b"cICP", &[1, 13, 0, 1])]), "nothing");
        assert_eq!(stated(&[(b"cICP", &[12, 13, 0, 1])]), "Display P3 (cICP 12)");
        assert_eq!(stated(&[(b"cHRM", &chrm(P3))]), "unnamed primaries (cHRM)");
        assert_eq!(stated(&[(b"cHRM", &chrm(BT709))]), "nothing");
        assert_eq!(stated(&[(b"cHRM", b"cut")]), "nothing");
    }

    #[test]
    fn chunks_have_the_precedence_of_the_specification() {
        let wide = chrm(P3);
        assert_eq!(stated(&[(b"cHRM", &wide), (b"sRGB", &[0])]), "nothing");
        assert_eq!(stated(&[(b"cHRM", &wide), (b"cICP", &[1, 13, 0, 1])]), "nothing");
        assert_eq!(stated(&[(b"cHRM", &wide), (b"cICP", &[2, 13, 0, 1])]), "unnamed primaries (cHRM)");
    }

    #[test]
    fn a_profile_is_wide_by_its_colours_and_called_by_its_name() {
        let of = |colours: [[f64; 3]; 3]| {
            let [red, green, blue] = colours.map(xyz);
            let name = b"desc\0\0\0\0\0\0\0\x05Wide\0\0\0";
            let tags: [(&[u8; 4], &[u8]); 4] =
                [(b"desc", name), (b"rXYZ", &red), (b"gXYZ", &green), (b"bXYZ", &blue)];
            of_profile(&profile(&tags)).map(|gamut| gamut.to_string())
        };
        assert_eq!(of(SRGB), None);
        // Adobe RGB (1998), annex of its specification, for D50.
        let adobe = [[0.6097, 0.3111, 0.0195], [0.2053, 0.6257, 0.0609], [0.1492, 0.0632, 0.7446]];
        assert_eq!(of(adobe).as_deref(), Some("'Wide' (ICC profile)"));
    }
}
