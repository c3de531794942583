//! Primaries that picture files state, where they are other than sRGB's.
//!
//! A PNG states them in cICP, iCCP, sRGB or cHRM, of which the first counts; JPEG, WebP and TIFF by an ICC profile, or else in Exif, as
//! cameras do that are set to Adobe RGB.

use crate::picture::Format;
use crate::png_chunks::chunks;
use crate::profile::Profile;
use crate::tiff::directory::{Directory, File};
use image::codecs::jpeg::JpegDecoder;
use image::codecs::webp::WebPDecoder;
use image::{ImageDecoder, ImageResult};
use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::io::Cursor;

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
        let format = Format::of(bytes)?;
        if format != Format::Png {
            return match Profile::of(bytes) {
                Some(profile) => of_profile(&profile),
                None => of_exif(&File::new(&exif(bytes, format)?)?.first()?),
            };
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

/// Exif of a picture file: a TIFF without pixels, or the picture file itself.
fn exif(bytes: &[u8], format: Format) -> Option<Cow<'_, [u8]>> {
    let file = Cursor::new(bytes);
    let of = |decoder: ImageResult<_>| decoder.ok().map(Cow::Owned);
    match format {
        Format::Jpeg => of(JpegDecoder::new(file)
            .and_then(|mut jpeg| jpeg.exif_metadata())
            .map(Option::unwrap_or_default)),
        Format::WebP => of(WebPDecoder::new(file)
            .and_then(|mut webp| webp.exif_metadata())
            .map(Option::unwrap_or_default)),
        Format::Tiff => Some(Cow::Borrowed(bytes)),
        Format::Png | Format::Pnm | Format::Bmp => None,
    }
}

/// Tags of "Exif Version 2.3" (CIPA DC-008): its directory, ColorSpace, the directory of interoperability and its index.
const EXIF: u16 = 34665;
const COLOUR_SPACE: u16 = 40961;
const INTEROPERABILITY: u16 = 40965;
const INDEX: u16 = 1;

/// Adobe RGB is DCF's only other colour space: index R03 of "Design rule for Camera File system" (CIPA DC-009), section 4.4. ColorSpace is
/// unspecified (65535) then; some programs write 2.
fn of_exif(tiff: &Directory<'_>) -> Option<Gamut> {
    let exif = tiff.below(EXIF)?;
    let index = exif.below(INTEROPERABILITY).and_then(|below| below.bytes(INDEX).ok()?);
    let stated = match exif.whole(COLOUR_SPACE) {
        Some(2) => "ColorSpace 2",
        _ if index?.starts_with(b"R03") => "R03",
        _ => return None,
    };
    Some(Gamut(format!("Adobe RGB (Exif, {stated})")))
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
    fn a_camera_states_adobe_rgb_in_exif_alone() {
        // Three directories of little-endian rows: number, type, count, value.
        let row = |tag: u16, kind: u16, count: u32, value: u32| {
            let head = [tag, kind].map(u16::to_le_bytes).concat();
            [head, count.to_le_bytes().to_vec(), value.to_le_bytes().to_vec()].concat()
        };
        let exif = |space: u32, index: &[u8; 4]| {
            let below = [row(COLOUR_SPACE, 3, 1, space), row(INTEROPERABILITY, 4, 1, 56)].concat();
            [
                &b"II*\0\x08\0\0\0\x01\0"[..],
                &row(EXIF, 4, 1, 26),
                &[0; 4],
                &[2, 0],
                &below,
                &[0; 4],
                &[1, 0],
                &row(INDEX, 2, 4, u32::from_le_bytes(*index)),
                &[0; 4],
            ]
            .concat()
        };
        let jpeg = |exif: &[u8]| {
            let mut jpeg = Cursor::new(vec![]);
            image::DynamicImage::new_rgb8(2, 2).write_to(&mut jpeg, image::ImageFormat::Jpeg).unwrap();
            let jpeg = jpeg.into_inner();
            let length = (exif.len() as u16 + 8).to_be_bytes();
            [&jpeg[..2], &[0xff, 0xe1], &length, b"Exif\0\0", exif, &jpeg[2..]].concat()
        };
        let stated = |exif: &[u8]| Gamut::of(&jpeg(exif)).map(|gamut| gamut.to_string());
        assert_eq!(stated(&exif(65535, b"R03\0")).as_deref(), Some("Adobe RGB (Exif, R03)"));
        assert_eq!(stated(&exif(2, b"R98\0")).as_deref(), Some("Adobe RGB (Exif, ColorSpace 2)"));
        assert_eq!(stated(&exif(1, b"R98\0")), None);
        // A cut directory, and none.
        let whole = exif(65535, b"R03\0");
        assert_eq!([&whole[..60], &whole[..30], &[]].map(stated), [None, None, None]);
        // A TIFF is its own Exif.
        assert_eq!(
            Gamut::of(&whole).map(|gamut| gamut.to_string()).as_deref(),
            Some("Adobe RGB (Exif, R03)")
        );
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
