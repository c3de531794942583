//! Frames of a stream: bytes, sensor values, and the words that a network takes.

use super::{FirstFrame, StreamError};
use edof_core::frame::FrameError;
use edof_core::{CfaPhase, RawFrame, Tone};
use edof_io::levels::{Black, Levels};
use edof_io::packing::{ByteOrder, Packing, Stray};
use edof_io::raw::Size;
use edof_io::read_warnings::{ReadWarning, read_warnings};
use edof_io::sensor::Correction;
use ndarray::Array2;
use std::io::{ErrorKind, Read};
use std::sync::Arc;

/// How every frame of a stream lies in bytes, and what its values are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    /// Columns and rows.
    pub size: Size,
    /// Packing of the pixels.
    pub packing: Packing,
    /// Order of the bytes of words.
    pub order: ByteOrder,
    /// Bits of the sensor; by default those of the packing.
    pub depth: Option<u32>,
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Sensor values of no and of full light.
    pub levels: Levels,
    /// Bytes from the beginning of one line to that of the next, where lines are padded.
    pub line_bytes: Option<usize>,
}

impl Layout {
    /// Returns the bytes of a frame.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        self.packing.frame_bytes(self.size.width, self.size.height, self.line_bytes)
    }

    /// Returns the bits of the sensor.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.depth.unwrap_or(self.packing.bits())
    }

    /// Reads the next frame, whose number counts from 1; returns whether there is one.
    pub(in crate::job) fn read(
        &self,
        number: u64,
        input: &mut dyn Read,
        frame: &mut Vec<u8>,
    ) -> Result<bool, StreamError> {
        frame.resize(self.bytes(), 0);
        let mut found = 0;
        while found < frame.len() {
            match input.read(&mut frame[found..]) {
                Ok(0) if found == 0 => return Ok(false),
                Ok(0) => {
                    let (expected, Self { size, packing, .. }) = (frame.len(), *self);
                    return Err(StreamError::Cut { number, found, expected, size, packing });
                }
                Ok(count) => found += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(StreamError::Read { number, source }),
            }
        }
        Ok(true)
    }
}

/// Makes words of a network of bytes of frames, in memory that is kept.
pub(super) struct Words {
    layout: Layout,
    /// The word for each value of a sensor, for each of the 2×2 pixels of a cell.
    tables: [Vec<u16>; 4],
    /// The correction of the sensor, and the word of the network for each word of light.
    sensor: Option<(Arc<Correction>, Vec<u16>)>,
    memory: Vec<u16>,
    /// A frame without the padding of its lines.
    pixels: Vec<u8>,
    /// Tone of the network's words.
    tone: Tone,
    /// What the first frame shows.
    first: Option<FirstFrame>,
}

impl Words {
    /// The words of a network whose values are those of a tone. A correction of the sensor takes the place of levels.
    pub(super) fn new(
        layout: Layout,
        sensor: Option<Arc<Correction>>,
        values: Tone,
    ) -> Result<Self, StreamError> {
        layout.packing.check_line(layout.size.width, layout.line_bytes)?;
        let Layout { size, phase, levels, .. } = layout;
        let tables = match &sensor {
            Some(sensor) => {
                sensor.check_values(false)?;
                sensor.check(size, phase, layout.depth())?;
                tables(layout.depth(), phase, Levels::default(), Tone::Linear)?
            }
            None => tables(layout.depth(), phase, levels, values)?,
        };
        let encoded = || tables_of_light(phase, values);
        let sensor = sensor.map(|sensor| Ok::<_, StreamError>((sensor, encoded()?))).transpose()?;
        Ok(Self { layout, tables, sensor, memory: vec![], pixels: vec![], tone: values, first: None })
    }

    /// Makes a frame of its bytes.
    pub(super) fn frame(&mut self, number: u64, bytes: &[u8]) -> Result<RawFrame, StreamError> {
        let Layout { size: Size { width, height }, packing, order, phase, .. } = self.layout;
        let mut values = std::mem::take(&mut self.memory);
        let bytes = packing.without_padding(width, self.layout.line_bytes, bytes, &mut self.pixels);
        packing.values_into(bytes, order, &mut values).map_err(|Stray { pixel, code }| {
            StreamError::Code { number, row: pixel / width, column: pixel % width, code }
        })?;
        let is_first = self.first.is_none();
        let mut first = *self.first.get_or_insert_with(|| shown(&values, width, self.layout.levels.black));
        for (row, line) in values.chunks_exact_mut(width).enumerate() {
            let [even, odd] = [0, 1].map(|column| self.tables[2 * (row % 2) + column].as_slice());
            for (pair, [left, right]) in line.as_chunks_mut().0.iter_mut().enumerate() {
                let words = even.get(usize::from(*left)).zip(odd.get(usize::from(*right)));
                let Some((a, b)) = words else {
                    let (side, value) =
                        if usize::from(*left) < even.len() { (1, *right) } else { (0, *left) };
                    let (column, depth) = (2 * pair + side, self.layout.depth());
                    return Err(StreamError::Value { number, row, column, value, depth });
                };
                (*left, *right) = (*a, *b);
            }
        }
        let mut words = Array2::from_shape_vec((height, width), values).map_err(|_| {
            let (found, expected) = (bytes.len(), self.layout.bytes());
            StreamError::Cut { number, found, expected, size: self.layout.size, packing }
        })?;
        if let Some((sensor, encoded)) = &self.sensor {
            sensor.correct(words.view_mut());
            words.mapv_inplace(|word| encoded[usize::from(word)]);
        }
        let frame = RawFrame::from_values(words, 16, phase)?;
        if is_first {
            first.is_of_other_phase = is_of_other_phase(&frame, self.tone);
            self.first = Some(first);
        }
        Ok(frame)
    }

    /// Returns what the first frame shows, once there was one.
    pub(super) const fn first(&self) -> Option<FirstFrame> {
        self.first
    }

    /// Takes a frame's memory for the next one.
    pub(super) fn keep(&mut self, frame: RawFrame) {
        self.memory = frame.into_pixels().into_raw_vec_and_offset().0;
    }
}

/// Returns what the sensor values of a frame show.
fn shown(values: &[u16], width: usize, black: Black) -> FirstFrame {
    let black = black.values();
    let is_below =
        |(i, value): &(usize, &u16)| f64::from(**value) < black[2 * (i / width % 2) + i % width % 2];
    let below = values.iter().enumerate().filter(is_below).count();
    FirstFrame {
        values: values.iter().fold([u16::MAX, 0], |[least, most], v| [least.min(*v), most.max(*v)]),
        below_black: below as f64 / values.len() as f64,
        is_of_other_phase: false,
    }
}

/// Whether the light of a frame, whose words are of a tone, looks as if its phase were another.
fn is_of_other_phase(frame: &RawFrame, tone: Tone) -> bool {
    read_warnings(&frame.decoded(tone)).contains(&ReadWarning::Phase)
}

/// Returns the word for each value of a sensor, for each of the 2×2 pixels of a cell.
fn tables(depth: u32, phase: CfaPhase, levels: Levels, values: Tone) -> Result<[Vec<u16>; 4], StreamError> {
    if !(8..=16).contains(&depth) {
        return Err(FrameError::Depth(depth).into());
    }
    // A frame that has every value at each place of a cell.
    let all = Array2::from_shape_fn((2, 2 << depth), |(_, column)| (column / 2) as u16);
    let frame = levels.light(&RawFrame::from_values(all, depth, phase)?)?;
    let words = frame.encoded(values).into_owned().into_pixels();
    let of_place = |place: usize| words.row(place / 2).iter().skip(place % 2).step_by(2).copied().collect();
    Ok([0, 1, 2, 3].map(of_place))
}

/// Returns the word of a network for each word of light.
fn tables_of_light(phase: CfaPhase, values: Tone) -> Result<Vec<u16>, StreamError> {
    let [all, ..] = tables(16, phase, Levels::default(), values)?;
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_io::sensor::Tables;

    fn layout(packing: Packing) -> Layout {
        let size = Size { width: 8, height: 4 };
        let levels = Levels { black: Black::new([64.0, 65.0, 66.0, 67.0]).unwrap(), white: Some(3900.0) };
        let (order, phase) = (ByteOrder::Little, CfaPhase::Gbrg);
        Layout { size, packing, order, depth: None, phase, levels, line_bytes: None }
    }

    #[test]
    fn words_are_those_of_the_same_frame_from_a_file() {
        let layout = layout(Packing::Bits12);
        let bytes: Vec<u8> = (0..48).map(|i| (i * 37 % 251) as u8).collect();
        let values = Packing::Bits12.values(&bytes, ByteOrder::Little).unwrap();
        let values = Array2::from_shape_vec((4, 8), values).unwrap();
        let frame = RawFrame::from_values(values, 12, CfaPhase::Gbrg).unwrap();
        for tone in Tone::ALL {
            let mut words = Words::new(layout, None, tone).unwrap();
            let expected = layout.levels.light(&frame).unwrap().encoded(tone).into_owned();
            let found = words.frame(1, &bytes).unwrap();
            assert_eq!(found.pixels(), expected.pixels(), "{tone:?}");
            assert_eq!(found.phase(), CfaPhase::Gbrg);
            // In the same memory.
            words.keep(found);
            assert_eq!(words.frame(2, &bytes).unwrap().pixels(), expected.pixels());
        }
    }

    #[test]
    fn a_sensor_is_corrected_as_in_a_frame_from_a_file() {
        let layout = layout(Packing::Bits12);
        let mut tables = Tables::plain(layout.size, CfaPhase::Gbrg, 12, [1000.0; 4], 60_000.0);
        tables.columns[3] = 250;
        tables.defects.pixels = vec![[1, 2], [2, 5]];
        let sensor = Arc::new(Correction::new(tables).unwrap());
        let bytes: Vec<u8> = (0..48).map(|i| (i * 37 % 251) as u8).collect();
        let values = Packing::Bits12.values(&bytes, ByteOrder::Little).unwrap();
        let values = Array2::from_shape_vec((4, 8), values).unwrap();
        let frame = RawFrame::from_values(values, 12, CfaPhase::Gbrg).unwrap();
        for tone in Tone::ALL {
            let expected = sensor.light(&frame).unwrap().encoded(tone).into_owned();
            let mut words = Words::new(layout, Some(Arc::clone(&sensor)), tone).unwrap();
            assert_eq!(words.frame(1, &bytes).unwrap().pixels(), expected.pixels(), "{tone:?}");
        }
        let other = Layout { depth: Some(10), packing: Packing::Words, ..layout };
        let told = Words::new(other, Some(sensor), Tone::Linear).err().map(|e| e.to_string());
        assert!(
            told.as_ref().is_some_and(|told| told.contains("with 10 bits, expected one of 8x4")),
            "{told:?}"
        );
    }

    #[test]
    fn a_frame_is_whole_or_an_error() {
        let layout = layout(Packing::Bytes);
        let bytes: Vec<u8> = (0..70).collect();
        let (mut input, mut frame) = (&bytes[..], vec![]);
        assert!(layout.read(1, &mut input, &mut frame).unwrap() && frame == bytes[..32]);
        assert!(layout.read(2, &mut input, &mut frame).unwrap() && frame == bytes[32..64]);
        let told = layout.read(3, &mut input, &mut frame).unwrap_err().to_string();
        assert_eq!(
            told,
            "frame 3: ends after 6 of 32 bytes, expected whole frames of 8x4 packed as bytes; 2 frames before it are whole, and their pictures are kept"
        );
        assert!(!layout.read(3, &mut &[][..], &mut frame).unwrap());
    }

    #[test]
    fn padding_at_the_ends_of_lines_changes_no_word() {
        for packing in [Packing::Words, Packing::Bytes, Packing::Mipi10, Packing::Bits12] {
            let plain = Layout { levels: Levels::default(), ..layout(packing) };
            let bytes: Vec<u8> = (0..plain.bytes()).map(|i| (i * 37 % 251) as u8).collect();
            let line = packing.bytes(plain.size.width);
            let padded = Layout { line_bytes: Some(line + 5), ..plain };
            let longer: Vec<u8> = bytes.chunks(line).flat_map(|line| [line, &[9; 5]].concat()).collect();
            assert_eq!(padded.bytes(), longer.len());
            let words = |layout, bytes: &[u8]| {
                Words::new(layout, None, Tone::Linear).unwrap().frame(1, bytes).unwrap().into_pixels()
            };
            assert_eq!(words(padded, &longer), words(plain, &bytes), "{packing:?}");
        }
        let refused = |line_bytes, width, packing| {
            let size = Size { width, height: 4 };
            let layout = Layout { line_bytes: Some(line_bytes), size, ..layout(packing) };
            Words::new(layout, None, Tone::Linear).err().map(|e| e.to_string()).unwrap_or_default()
        };
        assert!(
            refused(11, 8, Packing::Bits12)
                .starts_with("11 bytes for a line of 8 pixels, expected at least 12")
        );
        assert!(refused(20, 10, Packing::Mipi10).contains("ends inside of a group"));
    }

    #[test]
    fn a_value_of_too_many_bits_is_named_by_its_place() {
        let layout = Layout { depth: Some(12), ..layout(Packing::Words) };
        let mut bytes = vec![0; 64];
        bytes[2 * 19 + 1] = 0x10;
        let told = Words::new(layout, None, Tone::Linear).unwrap().frame(5, &bytes).unwrap_err().to_string();
        assert_eq!(told, "frame 5: pixel at row 2, column 3 is 4096, more than 12 bits can hold");
    }
}
