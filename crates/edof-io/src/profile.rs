//! ICC colour profiles in picture files: the fields that say what sample values are ("Specification ICC.1:2010", section 7).

use crate::picture::Format;
use crate::tiff::Tiff;
use image::ImageDecoder;
use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use std::io::Cursor;

/// An ICC profile in memory; what it says is looked up where it is asked for.
pub struct Profile(Vec<u8>);

impl Profile {
    /// Returns the profile of a picture file in memory.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let file = Cursor::new(bytes);
        let profile = match Format::of(bytes)? {
            Format::Png => PngDecoder::new(file).ok()?.icc_profile().ok()?,
            Format::Jpeg => JpegDecoder::new(file).ok()?.icc_profile().ok()?,
            Format::WebP => WebPDecoder::new(file).ok()?.icc_profile().ok()?,
            Format::Tiff => Tiff::open(bytes).ok()?.icc_profile().map(<[u8]>::to_vec),
            Format::Pnm | Format::Bmp => None,
        };
        profile.map(Self)
    }

    /// Returns the light, 0 to 1, of a sample by the first channel's curve.
    #[must_use]
    pub fn light(&self, sample: f64) -> Option<f64> {
        let curve = self.tag(b"rTRC").or_else(|| self.tag(b"kTRC"))?;
        match curve.get(..4)? {
            b"para" => parametric(curve, sample),
            b"curv" => match u32_at(curve, 8)? as usize {
                0 => Some(sample),
                1 => Some(sample.powf(f64::from(u16_at(curve, 12)?) / 256.0)),
                points => between(points, sample, |index| u16_at(curve, 12 + 2 * index)),
            },
            _ => None,
        }
    }

    /// Returns X, Y and Z of red, green and blue as columns, for the white D50, where the profile is a matrix.
    #[must_use]
    pub fn colours(&self) -> Option<[[f64; 3]; 3]> {
        let column = |name| {
            let colour = self.tag(name).filter(|tag| tag.starts_with(b"XYZ "))?;
            Some([fixed(colour, 8)?, fixed(colour, 12)?, fixed(colour, 16)?])
        };
        Some([column(b"rXYZ")?, column(b"gXYZ")?, column(b"bXYZ")?])
    }

    /// Returns what the profile is called, in printable ASCII.
    #[must_use]
    pub fn name(&self) -> Option<String> {
        let tag = self.tag(b"desc")?;
        let text: Vec<u8> = match tag.get(..4)? {
            b"desc" => tag.get(12..)?.iter().copied().take(u32_at(tag, 8)? as usize).collect(),
            // The first of its languages, in UTF-16.
            b"mluc" => {
                let [length, at] = [u32_at(tag, 20)? as usize, u32_at(tag, 24)? as usize];
                tag.get(at..at.checked_add(length)?)?.chunks_exact(2).map(|unit| unit[1]).collect()
            }
            _ => return None,
        };
        let text = text.into_iter().take_while(|byte| *byte != 0).map(char::from);
        let text: String = text.filter(|c| c.is_ascii_graphic() || *c == ' ').take(64).collect();
        (!text.is_empty()).then_some(text)
    }

    /// Contents of a tag and all that follows.
    fn tag(&self, wanted: &[u8; 4]) -> Option<&[u8]> {
        let profile = &self.0[..];
        let count = u32_at(profile, 128)?.min(256) as usize;
        let mut entries = (0..count).map(|index| 132 + 12 * index);
        let entry = entries.find(|at| profile.get(*at..*at + 4).is_some_and(|name| name == wanted))?;
        profile.get(u32_at(profile, entry + 4)? as usize..)
    }
}

/// The light of a sample by one of the formulas of a `para` curve (section 10.16); their parameters are in the order g, a, b, c, d, e, f.
fn parametric(curve: &[u8], x: f64) -> Option<f64> {
    let kind = u16_at(curve, 8)?;
    let count = *[1, 3, 4, 5, 7].get(usize::from(kind))?;
    let mut p = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for (index, value) in p.iter_mut().enumerate().take(count) {
        *value = fixed(curve, 12 + 4 * index)?;
    }
    let [g, a, b, c, d, e, f] = p;
    let power = (a * x + b).max(0.0).powf(g);
    Some(match kind {
        0 | 1 => power,
        2 => power + c,
        _ if x < d => c * x + f,
        _ => power + e,
    })
}

/// The light of a sample between the points of a table of 16-bit numbers.
pub fn between<T: Into<f64>>(points: usize, sample: f64, at: impl Fn(usize) -> Option<T>) -> Option<f64> {
    let place = sample * points.checked_sub(1)? as f64;
    let (low, share) = (place.floor() as usize, place.fract());
    let [from, to] = [at(low)?.into(), at((low + 1).min(points - 1))?.into()];
    Some((from + share * (to - from)) / 65535.0)
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// A signed number with 16 fraction bits.
fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    Some(f64::from(u32_at(bytes, at)? as i32) / 65536.0)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A profile of these tags.
    pub(crate) fn profile(tags: &[(&[u8; 4], &[u8])]) -> Profile {
        let mut at = 132 + 12 * tags.len();
        let mut bytes = [&[0; 128][..], &(tags.len() as u32).to_be_bytes()].concat();
        for (name, content) in tags {
            bytes.extend(
                [&name[..], &(at as u32).to_be_bytes(), &(content.len() as u32).to_be_bytes()].concat(),
            );
            at += content.len();
        }
        bytes.extend(tags.iter().flat_map(|(_, content)| *content));
        Profile(bytes)
    }

    /// The tag of a colour.
    pub(crate) fn xyz(colour: [f64; 3]) -> Vec<u8> {
        let numbers = colour.iter().flat_map(|v| ((v * 65536.0).round() as i32).to_be_bytes());
        b"XYZ \0\0\0\0".iter().copied().chain(numbers).collect()
    }

    #[test]
    fn light_is_known_from_each_kind_of_curve() {
        let of = |curve: &[u8]| profile(&[(b"rTRC", curve)]).light(0.5);
        assert_eq!(of(b"curv\0\0\0\0\0\0\0\0"), Some(0.5));
        assert_eq!(of(b"curv\0\0\0\0\0\0\0\x01\x02\0"), Some(0.25));
        assert_eq!(of(b"curv\0\0\0\0\0\0\0\x02\0\0\xff\xff"), Some(0.5));
        assert_eq!(of(b"curv\0\0\0\0\0\0\0\x03\0\0\x33\x33\xff\xff"), Some(0.2));
        let para = |kind: u8, numbers: &[f64]| {
            let numbers = numbers.iter().flat_map(|v| ((v * 65536.0).round() as i32).to_be_bytes());
            let curve: Vec<u8> =
                b"para\0\0\0\0\0".iter().copied().chain([kind, 0, 0]).chain(numbers).collect();
            of(&curve)
        };
        assert_eq!(para(0, &[2.0]), Some(0.25));
        assert_eq!(para(1, &[2.0, 0.5, 0.25]), Some(0.25));
        assert_eq!(para(2, &[2.0, 0.5, 0.25, 0.125]), Some(0.375));
        assert_eq!(para(3, &[2.0, 0.5, 0.25, 0.5, 0.25]), Some(0.25));
        assert_eq!(para(3, &[2.0, 0.5, 0.25, 0.5, 0.75]), Some(0.25));
        assert_eq!(para(4, &[2.0, 0.5, 0.25, 0.5, 0.75, 0.0, 0.5]), Some(0.75));
        assert_eq!(para(4, &[2.0, 0.5, 0.25, 0.5, 0.25, 0.125, 0.0]), Some(0.375));
        assert_eq!(para(5, &[2.0; 7]), None);
        assert_eq!(of(b"curv\0\0\0\0\0\0\x04\0\0\0\0\0"), None);
        assert_eq!(of(b"curv"), None);
        assert_eq!(profile(&[(b"kTRC", b"curv\0\0\0\0\0\0\0\0")]).light(0.25), Some(0.25));
    }

    #[test]
    fn both_kinds_of_names_are_read() {
        let of = |text: &[u8]| profile(&[(b"desc", text)]).name();
        assert_eq!(of(b"desc\0\0\0\0\0\0\0\x05Wide\0\0\0").as_deref(), Some("Wide"));
        let head = b"mluc\0\0\0\0\0\0\0\x01\0\0\0\x0cenUS\0\0\0\x08\0\0\0\x1c";
        assert_eq!(of(&[&head[..], b"\0W\0i\0d\0e"].concat()).as_deref(), Some("Wide"));
        assert_eq!(of(b"desc\0\0\0\0\xff\xff\xff\xff\x1b\n"), None);
    }

    #[test]
    fn cut_profiles_state_nothing() {
        let whole = profile(&[(b"rXYZ", &xyz([0.4, 0.2, 0.0])), (b"rTRC", b"curv\0\0\0\0\0\0\0\0")]).0;
        for length in 0..whole.len() {
            let cut = Profile(whole[..length].to_vec());
            assert_eq!((cut.colours(), cut.name(), cut.light(0.5)), (None, None, None));
        }
    }
}
