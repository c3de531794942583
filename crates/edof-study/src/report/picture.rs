//! Frames as PNG bytes for reports, sheets of small pictures, and words below them.
//!
//! A frame that holds light is encoded ([`Tone::Srgb`]); one whose values are shown as they are, such as kernels or a photograph
//! whose sRGB codes were taken for light, is not ([`Tone::Linear`]).

use super::letters::Writing;
use base64::prelude::{BASE64_STANDARD, Engine};
use edof_core::{ColourFrame, Tone};
use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use ndarray::{Array2, s};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An 8-bit PNG of a frame, its values encoded by `tone`; what lies outside 0…1 is clipped.
///
/// # Errors
/// What the encoder says.
pub fn png(frame: &ColourFrame, tone: Tone) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    // Not `write_to`, with which the encoders of all formats would be compiled here.
    pixels(frame, tone).write_with_encoder(PngEncoder::new(&mut bytes))?;
    Ok(bytes)
}

/// The same as JPEG, of a quality that the eye takes for the picture itself; for pages that should be small.
///
/// # Errors
/// What the encoder says.
pub fn jpeg(frame: &ColourFrame, tone: Tone) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY).encode_image(&pixels(frame, tone))?;
    Ok(bytes)
}

/// A PNG or JPEG; in JSON it is text in base64.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Encoded(pub Vec<u8>);

impl Serialize for Encoded {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(&BASE64_STANDARD.encode(&self.0))
    }
}

impl<'de> Deserialize<'de> for Encoded {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = String::deserialize(from)?;
        BASE64_STANDARD.decode(text).map(Self).map_err(D::Error::custom)
    }
}

/// Of a hundred.
const JPEG_QUALITY: u8 = 90;

fn pixels(frame: &ColourFrame, tone: Tone) -> RgbImage {
    let (height, width) = frame.size();
    let code = |plane: usize, x: u32, y: u32| {
        let value = tone.encode(frame.planes[(plane, y as usize, x as usize)]).clamp(0.0, 1.0);
        (value * 255.0).round() as u8
    };
    RgbImage::from_fn(width as u32, height as u32, |x, y| {
        image::Rgb([code(0, x, y), code(1, x, y), code(2, x, y)])
    })
}

/// The same values as [`png`], to within one code, without a format: red, green, blue and 255 of each pixel, row by row. For screens that change many times
/// a second.
#[must_use]
pub fn rgba(frame: &ColourFrame, tone: Tone) -> Vec<u8> {
    let code = |value: &f32| {
        let word = tone.encode_word((value.clamp(0.0, 1.0) * 65535.0).round() as u16);
        ((u32::from(word) * 255 + 32767) / 65535) as u8
    };
    let mut bytes = vec![255; 4 * frame.planes.len() / 3];
    for (plane, values) in frame.planes.outer_iter().enumerate() {
        bytes[plane..].iter_mut().step_by(4).zip(values).for_each(|(byte, value)| *byte = code(value));
    }
    bytes
}

/// Pictures laid out in rows on grey paper with `gap` pixels between them; each cell is as large as the largest picture.
#[must_use]
pub fn sheet(rows: &[Vec<ColourFrame>], gap: usize) -> ColourFrame {
    let all = || rows.iter().flatten();
    let cell_height = all().map(|f| f.size().0).max().unwrap_or(0);
    let cell_width = all().map(|f| f.size().1).max().unwrap_or(0);
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let mut paper =
        ColourFrame::zeros(gap + rows.len() * (cell_height + gap), gap + columns * (cell_width + gap));
    paper.planes.fill(0.5);
    for (i, row) in rows.iter().enumerate() {
        for (j, picture) in row.iter().enumerate() {
            let (height, width) = picture.size();
            let (top, left) = (gap + i * (cell_height + gap), gap + j * (cell_width + gap));
            paper.planes.slice_mut(s![.., top..top + height, left..left + width]).assign(&picture.planes);
        }
    }
    paper
}

/// Blur kernels of red, green and blue as one colour picture of `side`×`side` pixels, each channel centred and scaled to its
/// own peak, then raised to 1/2.2 so that faint rings show.
#[must_use]
pub fn psf_picture(kernels: [&Array2<f32>; 3], side: usize) -> ColourFrame {
    let mut out = ColourFrame::zeros(side, side);
    for (plane, kernel) in kernels.into_iter().enumerate() {
        let peak = kernel.iter().fold(0.0f32, |m, v| m.max(*v)).max(f32::MIN_POSITIVE);
        let (height, width) = kernel.dim();
        for r in 0..side {
            for c in 0..side {
                let source =
                    (r + height / 2).checked_sub(side / 2).zip((c + width / 2).checked_sub(side / 2));
                let value = source.and_then(|at| kernel.get(at)).copied().unwrap_or(0.0);
                out.planes[(plane, r, c)] = (value.max(0.0) / peak).powf(1.0 / 2.2);
            }
        }
    }
    out
}

/// Every pixel repeated `factor` times in both directions.
#[must_use]
pub fn enlarged(frame: &ColourFrame, factor: usize) -> ColourFrame {
    let (height, width) = frame.size();
    let mut out = ColourFrame::zeros(height * factor, width * factor);
    out.planes.indexed_iter_mut().for_each(|((p, r, c), v)| *v = frame.planes[(p, r / factor, c / factor)]);
    out
}

/// How bright captions' paper and ink are shown.
const PAPER: f32 = 0.94;
const INK: f32 = 0.1;
/// Height in pixels of a caption's capitals, and from line to line.
const CAPITAL: f64 = 13.0;
const PITCH: usize = 19;
/// Pixels around a caption.
const MARGIN: usize = 6;
/// Samples along each side of a caption's pixel.
const FINE: usize = 4;

/// A strip of `width` pixels with a text in capitals, wrapped between words: what stands below a picture and covers nothing of it.
/// `tone` is that of the picture, as for [`png`].
#[must_use]
pub fn caption(text: &str, width: usize, tone: Tone) -> ColourFrame {
    // There are no Greek letters.
    let text = text.replace('ψ', "psi").replace('µ', "u").to_uppercase();
    let lines = wrapped(&text, width.saturating_sub(2 * MARGIN) as f64);
    let lines: Vec<Writing> = lines.iter().map(|line| Writing::new(line)).collect();
    let mut strip = ColourFrame::zeros(MARGIN + PITCH * lines.len() + MARGIN, width);
    let inked = |line: &Writing, y: usize, x: usize| {
        let at = |pixel: usize, i: usize| pixel as f64 + (i as f64 + 0.5) / FINE as f64;
        let hits = (0..FINE * FINE).filter(|i| line.is_ink(CAPITAL, at(x, i % FINE), at(y, i / FINE)));
        hits.count() as f32 / (FINE * FINE) as f32
    };
    for ((_, row, column), value) in strip.planes.indexed_iter_mut() {
        let at = row.checked_sub(MARGIN).zip(column.checked_sub(MARGIN));
        let ink = at.and_then(|(y, x)| Some(inked(lines.get(y / PITCH)?, y % PITCH, x))).unwrap_or(0.0);
        *value = tone.decode(PAPER + (INK - PAPER) * ink);
    }
    strip
}

/// Lines that have room in a width; a longer word is cut.
fn wrapped(text: &str, room: f64) -> Vec<String> {
    let fits = |text: &str| Writing::new(text).width(CAPITAL) <= room;
    let mut lines: Vec<String> = vec![];
    for word in text.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}")).filter(|longer| fits(longer));
        match (lines.last_mut(), longer) {
            (Some(line), Some(longer)) => *line = longer,
            _ => {
                let ends = word.char_indices().map(|(at, letter)| at + letter.len_utf8());
                let end = ends.take_while(|end| fits(&word[..*end])).last().unwrap_or(0);
                lines.push(word[..end].to_owned());
            }
        }
    }
    lines
}

/// Pictures one below the other, each at the left; what is narrower is continued on paper.
#[must_use]
pub fn stacked(frames: &[ColourFrame], tone: Tone) -> ColourFrame {
    let width = frames.iter().map(|f| f.size().1).max().unwrap_or(0);
    let mut all = ColourFrame::zeros(frames.iter().map(|f| f.size().0).sum(), width);
    all.planes.fill(tone.decode(PAPER));
    let mut top = 0;
    for frame in frames {
        let (height, width) = frame.size();
        all.planes.slice_mut(s![.., top..top + height, ..width]).assign(&frame.planes);
        top += height;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_holds_the_values_and_clips_the_rest() {
        let mut frame = ColourFrame::zeros(2, 3);
        frame.planes[(0, 0, 0)] = 100.0 / 255.0;
        frame.planes[(1, 1, 2)] = 1.7;
        frame.planes[(2, 1, 0)] = -0.2;
        let decoded = image::load_from_memory(&png(&frame, Tone::Linear).unwrap()).unwrap().to_rgb8();
        assert_eq!(decoded.dimensions(), (3, 2));
        assert_eq!(decoded.get_pixel(0, 0).0, [100, 0, 0]);
        assert_eq!(decoded.get_pixel(2, 1).0, [0, 255, 0]);
        assert_eq!(decoded.get_pixel(0, 1).0, [0, 0, 0]);
    }

    #[test]
    fn bytes_for_a_screen_are_those_of_the_png() {
        let mut frame = ColourFrame::zeros(64, 97);
        let count = frame.planes.len() as f32;
        frame.planes.iter_mut().enumerate().for_each(|(i, v)| *v = 1.2 * i as f32 / count - 0.1);
        for tone in Tone::ALL {
            let decoded = image::load_from_memory(&png(&frame, tone).unwrap()).unwrap().to_rgba8();
            let bytes = rgba(&frame, tone);
            assert_eq!(bytes.len(), 4 * 64 * 97);
            assert!(decoded.iter().zip(&bytes).all(|(a, b)| a.abs_diff(*b) <= 1));
        }
    }

    #[test]
    fn a_jpeg_is_nearly_the_picture() {
        let mut frame = ColourFrame::zeros(16, 24);
        frame
            .planes
            .indexed_iter_mut()
            .for_each(|((p, r, c), v)| *v = (p * 40 + r * 5 + c * 3) as f32 / 255.0);
        let decoded = image::load_from_memory(&jpeg(&frame, Tone::Linear).unwrap()).unwrap().to_rgb8();
        let exact = image::load_from_memory(&png(&frame, Tone::Linear).unwrap()).unwrap().to_rgb8();
        assert!(decoded.iter().zip(exact.iter()).all(|(a, b)| a.abs_diff(*b) <= 6));
    }

    #[test]
    fn linear_light_goes_through_the_srgb_curve() {
        let mut frame = ColourFrame::zeros(1, 1);
        frame.planes.fill(0.5);
        let decoded = image::load_from_memory(&png(&frame, Tone::Srgb).unwrap()).unwrap().to_rgb8();
        assert_eq!(decoded.get_pixel(0, 0).0, [188; 3]);
    }

    #[test]
    fn a_sheet_places_pictures_on_a_grid() {
        let mut white = ColourFrame::zeros(2, 2);
        white.planes.fill(1.0);
        let paper = sheet(&[vec![white.clone(), white.clone()], vec![white]], 1);
        assert_eq!(paper.size(), (7, 7));
        assert_eq!(
            [paper.planes[(0, 1, 4)], paper.planes[(0, 4, 4)], paper.planes[(0, 0, 0)]],
            [1.0, 0.5, 0.5]
        );
    }

    #[test]
    fn a_caption_is_wrapped_and_has_ink_where_letters_are() {
        let room = Writing::new("PSI = 4,").width(CAPITAL).ceil();
        let width = 2 * MARGIN + room as usize;
        let strip = caption("ψ = 4, clear lens", width, Tone::Linear);
        assert_eq!(wrapped("PSI = 4, CLEAR LENS", room), ["PSI = 4,", "CLEAR", "LENS"]);
        assert_eq!(strip.size(), (2 * MARGIN + 3 * PITCH, width));
        let ink = |columns: std::ops::Range<usize>| {
            strip
                .planes
                .slice(s![0, MARGIN..MARGIN + PITCH, columns])
                .iter()
                .filter(|v| **v < INK + 1e-3)
                .count()
        };
        assert!(ink(MARGIN..MARGIN + 10) > 0, "a P");
        assert_eq!(ink(width - MARGIN..width), 0, "nothing in the margin");
        assert_eq!(wrapped("TOOLONG", Writing::new("TOO").width(CAPITAL)), ["TOO"]);
    }

    #[test]
    fn what_is_stacked_keeps_every_pixel() {
        let (mut first, second) = (ColourFrame::zeros(2, 3), ColourFrame::zeros(1, 5));
        first.planes.fill(0.5);
        let all = stacked(&[first.clone(), second.clone()], Tone::Linear);
        assert_eq!((all.size(), all.crop(0, 0, 2, 3), all.crop(2, 0, 1, 5)), ((3, 5), first, second));
        assert_eq!(all.planes[(0, 1, 4)], PAPER);
    }

    #[test]
    fn kernels_of_any_size_are_centred() {
        let mut small = Array2::zeros((3, 3));
        small[(1, 1)] = 0.2;
        let mut large = Array2::zeros((9, 9));
        large[(4, 4)] = 0.9;
        let picture = psf_picture([&small, &large, &large], 5);
        assert_eq!([0, 1, 2].map(|p| picture.planes[(p, 2, 2)]), [1.0; 3]);
        assert_eq!(picture.planes.sum(), 3.0);
    }
}
