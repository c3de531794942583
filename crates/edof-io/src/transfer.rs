//! Transfer curves that picture files state: whether samples are linear light, sRGB codes, or codes of another curve.
//!
//! A PNG states its curve in chunks. Of these cICP precedes iCCP, iCCP precedes sRGB, and sRGB precedes gAMA, as in "Portable Network
//! Graphics (PNG) Specification (Third Edition)", section 4.3. JPEG, WebP and TIFF may have an ICC profile, TIFF a TransferFunction
//! besides. Other formats state nothing.

use crate::picture::Format;
use crate::png_chunks::{chunks, insert};
use crate::profile::{Profile, between};
use crate::tiff::Tiff;
use edof_core::Tone;
use moxcms::{
    CicpColorPrimaries, CicpProfile, CmsError, ColorProfile, LocalizableString, MatrixCoefficients,
    ProfileText, TransferCharacteristics,
};
use std::fmt::{self, Display, Formatter};
use std::ops::Range;

/// Transfer curve that a file states, and where it states it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transfer {
    /// The curve.
    pub curve: Curve,
    /// Where it is stated, as in `gAMA 1`.
    source: String,
}

/// A transfer curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// Samples are linear light.
    Linear,
    /// Samples are sRGB codes, or close to them.
    Srgb,
    /// Another curve, by its name.
    Other(&'static str),
}

/// Where a profile has its date: year, month, day, hour, minute, second (ICC.1:2010, section 7.2).
const DATE: Range<usize> = 24..36;

/// Curve that the program states in the PNGs and TIFFs that it writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Statement {
    /// Samples are linear light: gAMA 1, or a profile.
    Linear,
    /// Samples are codes of BT.709's curve: cICP 1, or a profile.
    Bt709,
}

impl Statement {
    /// States the curve in a PNG without such a statement.
    pub(crate) fn put(self, png: &mut Vec<u8>) {
        match self {
            Self::Linear => insert(png, *b"gAMA", &100_000u32.to_be_bytes()),
            Self::Bt709 => insert(png, *b"cICP", &[1, 1, 0, 1]),
        }
    }

    /// Returns an ICC profile of the curve and sRGB's primaries.
    pub(crate) fn profile(self) -> Result<Vec<u8>, CmsError> {
        let (transfer_characteristics, name) = match self {
            Self::Linear => (TransferCharacteristics::Linear, "sRGB, linear light"),
            Self::Bt709 => (TransferCharacteristics::Bt709, "sRGB, BT.709's curve"),
        };
        let mut profile = ColorProfile::new_from_cicp(CicpProfile {
            color_primaries: CicpColorPrimaries::Bt709,
            transfer_characteristics,
            matrix_coefficients: MatrixCoefficients::Identity,
            full_range: true,
        });
        let text = |text: &str| {
            Some(ProfileText::Localizable(vec![LocalizableString::new(
                "en".into(),
                "US".into(),
                text.into(),
            )]))
        };
        (profile.description, profile.copyright) = (text(name), text("Public domain"));
        let mut profile = profile.encode()?;
        // Its date is that of the run; the same picture has the same bytes.
        profile[DATE].copy_from_slice(&[2000, 1, 1, 0, 0, 0].map(u16::to_be_bytes).concat());
        Ok(profile)
    }
}

impl Display for Transfer {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let curve = match self.curve {
            Curve::Linear => "linear light",
            Curve::Srgb => "sRGB codes",
            Curve::Other(name) => name,
        };
        write!(f, "{curve} ({})", self.source)
    }
}

impl Transfer {
    /// Reads what a file in memory states; none where it states nothing that is known.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Option<Self> {
        match Format::of(bytes)? {
            Format::Png => of_png(bytes),
            // A profile decides.
            format => match Profile::of(bytes) {
                Some(profile) => of_profile(&profile),
                None if format == Format::Tiff => of_transfer_function(&Tiff::open(bytes).ok()?),
                None => None,
            },
        }
    }

    /// Returns the tone that the samples have, where the curve has one.
    #[must_use]
    pub const fn tone(&self) -> Option<Tone> {
        match self.curve {
            Curve::Linear => Some(Tone::Linear),
            Curve::Srgb => Some(Tone::Srgb),
            Curve::Other(_) => None,
        }
    }
}

fn of_png(png: &[u8]) -> Option<Transfer> {
    let find = |wanted: &[u8; 4]| chunks(png).find(|(name, _)| *name == wanted).map(|(_, content)| content);
    let coded = find(b"cICP").and_then(coded);
    let profile = || find(b"iCCP").map(|_| of_profile(&Profile::of(png)?));
    coded.or_else(|| match profile() {
        // A profile decides, even one whose curve is unknown.
        Some(transfer) => transfer,
        None => match find(b"sRGB") {
            Some(_) => Some(Transfer { curve: Curve::Srgb, source: "sRGB chunk".to_owned() }),
            None => find(b"gAMA").and_then(gamma),
        },
    })
}

/// Curve of cICP's transfer characteristics (ITU-T H.273, table 3); none where it is unspecified.
fn coded(content: &[u8]) -> Option<Transfer> {
    let [_, transfer, _, full_range] = content[..] else { return None };
    let curve = match transfer {
        _ if full_range == 0 => Curve::Other("codes of narrow range"),
        8 => Curve::Linear,
        13 => Curve::Srgb,
        1 | 6 | 14 | 15 => Curve::Other("BT.709's curve"),
        2 => return None,
        4 => Curve::Other("a power of 2.2"),
        5 => Curve::Other("a power of 2.8"),
        16 => Curve::Other("PQ"),
        17 => Curve::Other("a power of 2.6"),
        18 => Curve::Other("HLG"),
        _ => Curve::Other("an unknown curve"),
    };
    let range = if full_range == 0 { ", full-range flag 0" } else { "" };
    Some(Transfer { curve, source: format!("cICP {transfer}{range}") })
}

/// Largest relative difference of two exponents that are taken as equal, as by libpng.
const EQUAL: f64 = 0.05;

/// Whether two exponents are taken as equal.
fn is(exponent: f64, other: f64) -> bool {
    (exponent / other - 1.0).abs() < EQUAL
}

/// Curve of an exponent from light to samples, in 1/100000.
fn gamma(content: &[u8]) -> Option<Transfer> {
    let exponent = f64::from(u32::from_be_bytes(content.try_into().ok()?)) / 1e5;
    let curve = match exponent {
        e if e <= 0.0 => return None,
        e if is(e, 1.0) => Curve::Linear,
        e if is(e, 0.45455) => Curve::Srgb,
        _ => Curve::Other("another power"),
    };
    Some(Transfer { curve, source: format!("gAMA {exponent}") })
}

/// Curve of an ICC profile's first channel, where it is far from sRGB's and from a power of 2.2.
fn of_profile(profile: &Profile) -> Option<Transfer> {
    measured("ICC profile", |sample| profile.light(sample))
}

/// The same of a TIFF's TransferFunction.
fn of_transfer_function(tiff: &Tiff<'_>) -> Option<Transfer> {
    let curve = tiff.transfer_function()?;
    let at = |index| curve.get(index).and_then(|light| u16::try_from(*light).ok());
    measured("TransferFunction (301)", |sample| between(curve.len(), sample, at))
}

/// A curve by the exponents that it has at a quarter, half and three quarters of full scale.
fn measured(source: &str, light: impl Fn(f64) -> Option<f64>) -> Option<Transfer> {
    let exponent = |sample: f64| Some(light(sample)?.ln() / sample.ln());
    let all = [exponent(0.25)?, exponent(0.5)?, exponent(0.75)?];
    let are = |other: f64| all.iter().all(|exponent| is(*exponent, other));
    if are(1.0) {
        return Some(Transfer { curve: Curve::Linear, source: source.to_owned() });
    }
    let name = if are(all[1]) { "another power" } else { "another curve" };
    let source = format!("{source}, exponent {:.2}", all[1]);
    (!are(2.2)).then_some(Transfer { curve: Curve::Other(name), source })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::profile::tests::profile;

    /// A PNG of one grey pixel with chunks before its pixels; their checksums are 0.
    pub(crate) fn png(more: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        let header: (&[u8; 4], &[u8]) = (b"IHDR", &[0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0]);
        for (name, content) in [&[header], more, &[(b"IDAT", &[]), (b"IEND", &[])]].concat() {
            bytes.extend((content.len() as u32).to_be_bytes());
            bytes.extend([&name[..], content, &[0; 4]].concat());
        }
        bytes
    }

    fn stated(more: &[(&[u8; 4], &[u8])]) -> String {
        Transfer::of(&png(more)).map_or("nothing".to_owned(), |transfer| transfer.to_string())
    }

    #[test]
    fn profiles_have_a_date_of_no_run() {
        for curve in [Statement::Linear, Statement::Bt709] {
            assert_eq!(curve.profile().unwrap()[24..36], *b"\x07\xd0\0\x01\0\x01\0\0\0\0\0\0");
        }
    }

    #[test]
    fn each_chunk_states_its_curve() {
        let gamma = |value: u32| stated(&[(b"gAMA", &value.to_be_bytes())]);
        assert_eq!(gamma(100_000), "linear light (gAMA 1)");
        assert_eq!(gamma(45_455), "sRGB codes (gAMA 0.45455)");
        assert_eq!(gamma(45_000), "sRGB codes (gAMA 0.45)");
        assert_eq!(gamma(55_556), "another power (gAMA 0.55556)");
        assert_eq!(gamma(0), "nothing");
        assert_eq!(stated(&[(b"sRGB", &[0])]), "sRGB codes (sRGB chunk)");
        for (code, name) in [
            (1, "BT.709's curve"),
            (8, "linear light"),
            (13, "sRGB codes"),
            (16, "PQ"),
            (18, "HLG"),
            (99, "an unknown curve"),
        ] {
            assert_eq!(stated(&[(b"cICP", &[1, code, 0, 1])]), format!("{name} (cICP {code})"));
        }
        assert_eq!(
            stated(&[(b"cICP", &[1, 13, 0, 0])]),
            "codes of narrow range (cICP 13, full-range flag 0)"
        );
        assert_eq!(stated(&[]), "nothing");
    }

    #[test]
    fn chunks_have_the_precedence_of_the_specification() {
        let linear = (b"gAMA", &100_000u32.to_be_bytes()[..]);
        let srgb = (b"sRGB", &[0][..]);
        assert_eq!(stated(&[linear, srgb]), "sRGB codes (sRGB chunk)");
        // A profile that cannot be read still precedes gAMA.
        assert_eq!(stated(&[linear, (b"iCCP", b"x\0\0")]), "nothing");
        assert_eq!(stated(&[linear, srgb, (b"cICP", &[9, 16, 0, 1])]), "PQ (cICP 16)");
        assert_eq!(stated(&[linear, (b"cICP", &[9, 2, 0, 1])]), "linear light (gAMA 1)");
    }

    #[test]
    fn a_linear_profile_and_another_power_are_known_by_their_curves() {
        let with =
            |curve: &[u8]| of_profile(&profile(&[(b"rTRC", curve)])).map(|transfer| transfer.to_string());
        assert_eq!(with(b"curv\0\0\0\0\0\0\0\0").as_deref(), Some("linear light (ICC profile)"));
        // Adobe RGB's 2.2, and ProPhoto RGB's 1.8.
        assert_eq!(with(b"curv\0\0\0\0\0\0\0\x01\x02\x33"), None);
        let power = with(b"curv\0\0\0\0\0\0\0\x01\x01\xcd");
        assert_eq!(power.as_deref(), Some("another power (ICC profile, exponent 1.80)"));
        assert_eq!(with(b"curv"), None);
        // Linear by two points, and by the formula of sRGB with an exponent of 1; sRGB's own; 16 points of CIE L*.
        assert_eq!(
            with(b"curv\0\0\0\0\0\0\0\x02\0\0\xff\xff").as_deref(),
            Some("linear light (ICC profile)")
        );
        let para = |numbers: [f64; 5]| {
            let numbers = numbers.iter().flat_map(|v| ((v * 65536.0).round() as i32).to_be_bytes());
            with(&b"para\0\0\0\0\0\x03\0\0".iter().copied().chain(numbers).collect::<Vec<_>>())
        };
        assert_eq!(para([1.0, 1.0, 0.0, 1.0, 0.0]).as_deref(), Some("linear light (ICC profile)"));
        assert_eq!(para([2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045]), None);
        let lightness = (0..16).map(|i| (65535.0 * ((f64::from(i) / 0.15 + 16.0) / 116.0).powi(3)) as u16);
        let lightness = lightness.flat_map(u16::to_be_bytes);
        let table: Vec<u8> = b"curv\0\0\0\0\0\0\0\x10".iter().copied().chain(lightness).collect();
        assert_eq!(with(&table).as_deref(), Some("another curve (ICC profile, exponent 2.43)"));
    }
}
