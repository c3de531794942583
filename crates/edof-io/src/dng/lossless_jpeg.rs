//! Lossless JPEG (ITU-T T.81, process 14) as DNG holds it: Huffman codes of differences from a prediction.

/// A stream that cannot be decoded, in a few words.
pub type Reason = &'static str;

const DAMAGED: Reason = "its lossless JPEG is damaged";

/// Lengths and symbols of Huffman codes, for each 16 bits that may come: length in the upper byte, symbol in the lower.
struct Codes(Vec<u16>);

impl Codes {
    /// From how many codes there are of each length, and their symbols.
    fn new(counts: &[u8], symbols: &[u8]) -> Result<Self, Reason> {
        let mut table = Vec::with_capacity(1 << 16);
        let mut left = symbols.iter();
        for (length, &count) in (1u16..).zip(counts) {
            for symbol in left.by_ref().take(usize::from(count)) {
                let entry = length << 8 | u16::from(*symbol);
                table.extend(std::iter::repeat_n(entry, 1 << (16 - length)));
                if table.len() > 1 << 16 {
                    return Err(DAMAGED);
                }
            }
        }
        table.resize(1 << 16, 0);
        Ok(Self(table))
    }
}

/// Bits of the entropy-coded part; after its end there are zeros.
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
    held: u64,
    count: u32,
    /// Bits that the stream did not hold.
    missing: u32,
    kind: Kind,
}

/// How a difference of category 16 is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Without further bits, as T.81 states it: it is 32768.
    Standard,
    /// With 16 further bits, as DNG before 1.1 has it.
    BeforeDng1_1,
}

impl<'a> Bits<'a> {
    const fn new(bytes: &'a [u8], at: usize, kind: Kind) -> Self {
        Self { bytes, at, held: 0, count: 0, missing: 0, kind }
    }
}

impl Bits<'_> {
    fn fill(&mut self) {
        while self.count <= 48 {
            let byte = match self.bytes.get(self.at..) {
                Some([0xff, 0, ..]) => {
                    self.at += 2;
                    0xff
                }
                // A marker ends the part.
                None | Some([] | [0xff, ..]) => {
                    self.missing += 8;
                    0
                }
                Some([byte, ..]) => {
                    self.at += 1;
                    *byte
                }
            };
            self.held = self.held << 8 | u64::from(byte);
            self.count += 8;
        }
    }

    /// Resumes behind the next marker, which must be that of a restart.
    fn restart(&mut self) -> Result<(), Reason> {
        let at = filled(self.bytes, self.at);
        match self.bytes.get(at..) {
            Some([0xff, 0xd0..=0xd7, ..]) => {
                *self = Bits::new(self.bytes, at + 2, self.kind);
                Ok(())
            }
            _ => Err(DAMAGED),
        }
    }

    fn take(&mut self, bits: u32) -> u32 {
        self.count -= bits;
        (self.held >> self.count) as u32 & ((1 << bits) - 1)
    }

    /// The next difference.
    fn difference(&mut self, Codes(table): &Codes) -> Result<i32, Reason> {
        self.fill();
        let entry = table[(self.held >> (self.count - 16)) as usize & 0xffff];
        let (length, bits) = (u32::from(entry >> 8), u32::from(entry & 0xff));
        if length == 0 || bits > 16 {
            return Err(DAMAGED);
        }
        self.take(length);
        let value = match bits {
            0 => 0,
            16 if self.kind == Kind::Standard => 32768,
            _ => {
                let value = self.take(bits) as i32;
                if value >> (bits - 1) == 0 { value - (1 << bits) + 1 } else { value }
            }
        };
        // Of what is held, the LSB are those that the stream did not hold.
        if self.missing > self.count { Err(DAMAGED) } else { Ok(value) }
    }
}

/// What a stream says before its bits.
struct Header {
    precision: u32,
    rows: usize,
    columns: usize,
    components: usize,
}

/// Returns where the marker is that begins at a byte or after fill bytes (T.81, B.1.1.2).
fn filled(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or_default();
    at + rest.windows(2).take_while(|two| **two == [0xff; 2]).count()
}

/// Samples of a stream row by row, components interleaved; `expected` is how many there must be.
///
/// # Errors
/// A stream that is damaged, of another kind, or of another size.
pub fn decode(bytes: &[u8], expected: usize, kind: Kind) -> Result<Vec<u16>, Reason> {
    let mut at = 2;
    let (mut codes, mut header): ([Option<Codes>; 4], Option<Header>) = ([const { None }; 4], None);
    let mut restart = 0u16;
    if bytes.get(..2) != Some(&[0xff, 0xd8]) {
        return Err("its tiles are no JPEG");
    }
    loop {
        at = filled(bytes, at);
        let Some(&[0xff, marker, high, low]) = bytes.get(at..at + 4) else { return Err(DAMAGED) };
        let length = usize::from(high) << 8 | usize::from(low);
        let part = bytes.get(at + 4..at + 2 + length).ok_or(DAMAGED)?;
        at += 2 + length;
        match marker {
            0xc4 => tables(part, &mut codes)?,
            0xc3 => header = Some(frame(part, expected)?),
            0xc0..=0xc2 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf => return Err("its JPEG is lossy"),
            0xdd => restart = part.try_into().map(u16::from_be_bytes).map_err(|_| DAMAGED)?,
            0xda => {
                let header = header.ok_or(DAMAGED)?;
                let rows = rows_between_restarts(usize::from(restart), header.columns)?;
                let bits = Bits::new(bytes, at, kind);
                return scan(&header, part, &codes, bits, rows);
            }
            _ => (),
        }
    }
}

fn tables(mut part: &[u8], codes: &mut [Option<Codes>; 4]) -> Result<(), Reason> {
    while let [place, rest @ ..] = part {
        let counts = rest.get(..16).ok_or(DAMAGED)?;
        let total: usize = counts.iter().map(|c| usize::from(*c)).sum();
        let symbols = rest.get(16..16 + total).ok_or(DAMAGED)?;
        // Tables of class 1 are for lossy streams.
        if !(0x10..0x14).contains(place) {
            *codes.get_mut(usize::from(*place)).ok_or(DAMAGED)? = Some(Codes::new(counts, symbols)?);
        }
        part = &rest[16 + total..];
    }
    Ok(())
}

fn frame(part: &[u8], expected: usize) -> Result<Header, Reason> {
    let &[precision, rows_high, rows_low, columns_high, columns_low, components, ref more @ ..] = part else {
        return Err(DAMAGED);
    };
    let header = Header {
        precision: u32::from(precision),
        rows: usize::from(rows_high) << 8 | usize::from(rows_low),
        columns: usize::from(columns_high) << 8 | usize::from(columns_low),
        components: usize::from(components),
    };
    let sampled_alike = more.chunks(3).all(|component| component.get(1) == Some(&0x11));
    if !(2..=16).contains(&header.precision) || !(1..=4).contains(&components) || !sampled_alike {
        return Err("its lossless JPEG is of a kind that cameras do not write");
    }
    if header.rows * header.columns * header.components != expected {
        return Err("its lossless JPEG is of another size than its tiles");
    }
    Ok(header)
}

/// Rows from one restart to the next, none without restarts. An interval ends with a row (T.81, H.1.1).
fn rows_between_restarts(interval: usize, columns: usize) -> Result<Option<usize>, Reason> {
    match (interval, columns) {
        (0, _) => Ok(None),
        (_, 1..) if interval.is_multiple_of(columns) => Ok(Some(interval / columns)),
        _ => Err("its lossless JPEG has a restart interval that ends within a row"),
    }
}

fn scan(
    header: &Header,
    part: &[u8],
    codes: &[Option<Codes>; 4],
    mut bits: Bits<'_>,
    restart: Option<usize>,
) -> Result<Vec<u16>, Reason> {
    let &Header { precision, rows, columns, components } = header;
    let chosen = part.get(1..1 + 2 * components).ok_or(DAMAGED)?;
    let table = |component: &[u8]| codes.get(usize::from(component[1] >> 4))?.as_ref();
    let tables: Vec<&Codes> = chosen.chunks_exact(2).map(table).collect::<Option<_>>().ok_or(DAMAGED)?;
    let &[predictor, _, shift, ..] = part.get(1 + 2 * components..).unwrap_or_default() else {
        return Err(DAMAGED);
    };
    let shift = u32::from(shift & 15);
    if !(1..=7).contains(&predictor) || shift >= precision {
        return Err(DAMAGED);
    }
    let width = columns * components;
    let mut samples = vec![0u16; rows * width];
    for row in 0..rows {
        let is_first = restart.map_or(row == 0, |rows| row.is_multiple_of(rows));
        if is_first && row > 0 {
            bits.restart()?;
        }
        let (before, rest) = samples.split_at_mut(row * width);
        let above = &before[row.saturating_sub(1) * width..];
        let own = &mut rest[..width];
        for at in 0..width {
            let left = at.checked_sub(components).map(|at| i32::from(own[at]));
            let up = above.get(at).filter(|_| !is_first).map(|v| i32::from(*v));
            let prediction = match (left, up) {
                (None, None) => 1 << (precision - shift - 1),
                (Some(left), None) => left,
                (None, Some(up)) => up,
                (Some(left), Some(up)) => predicted(predictor, left, up, i32::from(above[at - components])),
            };
            own[at] = (prediction + bits.difference(tables[at % components])?) as u16;
        }
    }
    samples.iter_mut().for_each(|sample| *sample <<= shift);
    Ok(samples)
}

/// From the samples to the left, above, and above the left.
const fn predicted(predictor: u8, left: i32, up: i32, corner: i32) -> i32 {
    match predictor {
        1 => left,
        2 => up,
        3 => corner,
        4 => left + up - corner,
        5 => left + ((up - corner) >> 1),
        6 => up + ((left - corner) >> 1),
        _ => (left + up) >> 1,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A stream with one table, in which the code of every length of a difference has five bits.
    pub fn encode(
        samples: &[u16],
        columns: usize,
        components: usize,
        precision: u32,
        predictor: u8,
    ) -> Vec<u8> {
        let width = columns * components;
        let rows = samples.len() / width;
        let mut stream =
            vec![0xff, 0xd8, 0xff, 0xc4, 0, 36, 0, 0, 0, 0, 0, 17, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        stream.extend(0..=16);
        stream.extend([0xff, 0xc3, 0, 8 + 3 * components as u8, precision as u8]);
        stream.extend((rows as u16).to_be_bytes());
        stream.extend((columns as u16).to_be_bytes());
        stream.push(components as u8);
        (0..components as u8).for_each(|component| stream.extend([component, 0x11, 0]));
        stream.extend([0xff, 0xda, 0, 6 + 2 * components as u8, components as u8]);
        (0..components as u8).for_each(|component| stream.extend([component, 0]));
        stream.extend([predictor, 0, 0]);
        let (mut held, mut count) = (0u64, 0);
        let mut put = |value: u64, bits: u32, stream: &mut Vec<u8>| {
            held = held << bits | value;
            count += bits;
            while count >= 8 {
                count -= 8;
                let byte = (held >> count) as u8;
                stream.push(byte);
                if byte == 0xff {
                    stream.push(0);
                }
            }
        };
        for (index, &sample) in samples.iter().enumerate() {
            let (row, at) = (index / width, index % width);
            let value = |row: usize, at: usize| i32::from(samples[row * width + at]);
            let prediction = match (at.checked_sub(components), row.checked_sub(1)) {
                (None, None) => 1 << (precision - 1),
                (Some(left), None) => value(0, left),
                (None, Some(up)) => value(up, at),
                (Some(left), Some(up)) => {
                    predicted(predictor, value(row, left), value(up, at), value(up, left))
                }
            };
            let difference = i32::from((i32::from(sample) - prediction) as i16);
            let bits = 32 - difference.unsigned_abs().leading_zeros();
            put(u64::from(bits), 5, &mut stream);
            let low = if difference < 0 { difference - 1 } else { difference };
            if bits < 16 {
                put(low as u64 & ((1 << bits) - 1), bits, &mut stream);
            }
        }
        put(0x7f, 7, &mut stream);
        stream.extend([0xff, 0xd9]);
        stream
    }

    proptest! {
        #[test]
        fn samples_come_back_by_every_predictor(
            predictor in 1u8..=7, components in 1usize..=3, columns in 1usize..9, rows in 1usize..7,
            precision in 8u32..=16, seed in any::<u32>()
        ) {
            let draw = |i: usize| (seed.wrapping_mul(2_654_435_761).wrapping_add(i as u32 * 40_503) >> 7) as u16;
            let samples: Vec<u16> =
                (0..rows * columns * components).map(|i| draw(i) & ((1u32 << precision) - 1) as u16).collect();
            let stream = encode(&samples, columns, components, precision, predictor);
            prop_assert_eq!(decode(&stream, samples.len(), Kind::Standard), Ok(samples));
        }

        #[test]
        fn damaged_streams_are_rejected_or_decoded_but_never_panic(
            at in 0usize..200, byte in any::<u8>(), kept in 0usize..300
        ) {
            let samples: Vec<u16> = (0..96).map(|i| i * 37 % 4096).collect();
            let mut stream = encode(&samples, 12, 2, 12, 1);
            let index = at % stream.len();
            stream[index] = byte;
            stream.truncate(kept);
            if let Ok(found) = decode(&stream, 96, Kind::Standard) {
                prop_assert_eq!(found.len(), 96);
            }
        }
    }

    #[test]
    fn a_stream_that_ends_early_is_rejected() {
        let samples: Vec<u16> = (0..960).map(|i| (i * 977 % 4096) as u16).collect();
        let stream = encode(&samples, 24, 1, 12, 6);
        let decode = |bytes: &[u8], expected| decode(bytes, expected, Kind::Standard);
        assert_eq!(decode(&stream[..stream.len() / 2], 960), Err(DAMAGED));
        assert_eq!(decode(&stream, 961), Err("its lossless JPEG is of another size than its tiles"));
        assert_eq!(decode(b"II*\0", 1), Err("its tiles are no JPEG"));
    }

    #[test]
    fn a_difference_of_category_16_has_16_more_bits_before_dng_1_1() {
        let samples = [32768, 0, 7];
        let stream = encode(&samples, 3, 1, 16, 1);
        // Categories 0, 16 and 3, of five bits each, and 111 are 6 bytes with the end; here -32768 follows the second.
        let old = [&stream[..stream.len() - 6], &[0x04, 0x1f, 0xff, 0, 0xc7, 0xff, 0, 0xff, 0xd9]].concat();
        assert_eq!(decode(&old, 3, Kind::BeforeDng1_1), Ok(samples.to_vec()));
        assert_eq!(decode(&stream, 3, Kind::Standard), Ok(samples.to_vec()));
    }

    #[test]
    fn fill_bytes_before_markers_and_tables_of_lossy_streams_are_passed_over() {
        let samples: Vec<u16> = (0..96).map(|i| i * 37 % 4096).collect();
        let stream = encode(&samples, 12, 2, 12, 1);
        // The first table again, as one of class 1.
        let mut table = stream[2..40].to_vec();
        table[4] = 0x10;
        let filled = [&stream[..2], &table, &[0xff; 3], &stream[2..40], &[0xff], &stream[40..]].concat();
        assert_eq!(decode(&filled, 96, Kind::Standard), Ok(samples));
    }
}
