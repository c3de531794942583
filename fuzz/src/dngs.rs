//! DNGs built from the tags of docs/dng.md: each input is a frame that is legal but for the tags that it chooses, so that most get as far as
//! the picture.

use edof_core::ColourFrame;
use edof_io::dng::{Dng, Overrides, decode};
use std::path::Path;

/// Longest side of a frame.
const SIDE: u8 = 24;
/// Bytes of a number of each type of TIFF, 1 to 12.
const SIZES: [usize; 12] = [1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8];
/// Tags of opcode lists.
const OPCODE_LISTS: [u16; 3] = [51008, 51009, 51022];

/// Numbers of the page's tags.
fn tags() -> impl Iterator<Item = u16> {
    let rows = include_str!("../../docs/dng.md").lines().skip_while(|line| !line.starts_with("| tag |"));
    rows.filter_map(|row| row.split('|').nth(1)?.trim().parse().ok())
}

/// What is left of an input; zeros behind its end.
struct Input<'a>(&'a [u8]);

impl Input<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    fn word(&mut self) -> u16 {
        u16::from_be_bytes([self.byte(), self.byte()])
    }

    fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.byte()).collect()
    }
}

/// A TIFF in writing: its byte order, and whether its offsets have 64 bits.
#[derive(Clone, Copy)]
struct Form {
    is_big_endian: bool,
    is_wide: bool,
}

impl Form {
    fn whole(self, value: u64, bytes: usize) -> Vec<u8> {
        if self.is_big_endian {
            value.to_be_bytes()[8 - bytes..].to_vec()
        } else {
            value.to_le_bytes()[..bytes].to_vec()
        }
    }

    const fn word(self) -> usize {
        if self.is_wide { 8 } else { 4 }
    }
}

/// A tag's number, its type and the bytes of its numbers.
type Entry = (u16, u16, Vec<u8>);

/// The file: header, pixels, one directory, what does not fit into it.
fn file(form: Form, pixels: &[u8], mut entries: Vec<Entry>) -> Vec<u8> {
    let (begin, head, row) = if form.is_wide { (16, 8, 20) } else { (8, 2, 12) };
    let mark = if form.is_big_endian { b"MM" } else { b"II" };
    let mut bytes = mark.to_vec();
    bytes.extend(form.whole(if form.is_wide { 43 } else { 42 }, 2));
    if form.is_wide {
        bytes.extend([form.whole(8, 2), vec![0; 2]].concat());
    }
    let at = begin + pixels.len();
    bytes.extend(form.whole(at as u64, form.word()));
    bytes.extend(pixels);
    entries.sort_by_key(|(tag, ..)| *tag);
    bytes.extend(form.whole(entries.len() as u64, head));
    let (mut behind, mut more) = (at + head + row * entries.len() + form.word(), vec![]);
    for (tag, kind, mut value) in entries {
        let count = value.len() / SIZES[usize::from(kind) - 1];
        bytes.extend([form.whole(u64::from(tag), 2), form.whole(u64::from(kind), 2)].concat());
        bytes.extend(form.whole(count as u64, form.word()));
        if value.len() <= form.word() {
            value.resize(form.word(), 0);
            bytes.extend(value);
        } else {
            bytes.extend(form.whole(behind as u64, form.word()));
            behind += value.len();
            more.extend(value);
        }
    }
    bytes.extend(vec![0; form.word()]);
    bytes.extend(more);
    bytes
}

/// Opcodes with parameters of the input, some with those of the right length.
fn opcodes(input: &mut Input<'_>) -> Vec<u8> {
    let count = input.byte() % 4;
    let mut list = u32::from(count).to_be_bytes().to_vec();
    for _ in 0..count {
        let (id, flags) = (u32::from(input.byte() % 16), u32::from(input.byte() & 3));
        let parameters = parameters(id, input);
        list.extend([id.to_be_bytes(), [1, 3, 0, 0], flags.to_be_bytes()].concat());
        list.extend((parameters.len() as u32).to_be_bytes());
        list.extend(parameters);
    }
    list
}

fn parameters(id: u32, input: &mut Input<'_>) -> Vec<u8> {
    let small = |input: &mut Input<'_>| u32::from(input.byte()).to_be_bytes().to_vec();
    let wholes =
        |input: &mut Input<'_>, count: usize| -> Vec<u8> { (0..count).flat_map(|_| small(input)).collect() };
    let doubles = |input: &mut Input<'_>, count: usize| -> Vec<u8> {
        (0..count).flat_map(|_| (f64::from(input.byte() as i8) / 64.0).to_be_bytes()).collect()
    };
    let area = |input: &mut Input<'_>| {
        let place: Vec<u8> = (0..2).flat_map(|_| u32::from(input.byte() % SIDE).to_be_bytes()).collect();
        let end: Vec<u8> = (0..2).flat_map(|_| u32::from(input.byte()).to_be_bytes()).collect();
        [place, end, wholes(input, 2), [1u32.to_be_bytes(), 1u32.to_be_bytes()].concat()].concat()
    };
    match (input.byte() % 8, id) {
        (0, _) => {
            let count = usize::from(input.byte());
            input.bytes(count)
        }
        (_, 1) => [vec![0, 0, 0, 1], doubles(input, 8)].concat(),
        (_, 2) => [vec![0, 0, 0, 1], doubles(input, 6)].concat(),
        (_, 3) => doubles(input, 7),
        (_, 4) => wholes(input, 2),
        (_, 5) => {
            let points = input.byte() % 8;
            let counts = [vec![0, 0, 0, input.byte() % 5], vec![0, 0, 0, points], vec![0, 0, 0, 1]].concat();
            [counts, wholes(input, 2 * usize::from(points) + 4)].concat()
        }
        (_, 6) => wholes(input, 4),
        (_, 7) => {
            let count = usize::from(input.byte() % 16);
            [area(input), (count as u32).to_be_bytes().to_vec(), input.bytes(2 * count)].concat()
        }
        (_, 8) => {
            let degree = usize::from(input.byte() % 10);
            [area(input), (degree as u32).to_be_bytes().to_vec(), doubles(input, degree + 1)].concat()
        }
        (_, 9) => {
            let [rows, columns] = [input.byte() % 4, input.byte() % 4].map(u32::from);
            let count = (rows * columns) as usize;
            let points = [rows.to_be_bytes(), columns.to_be_bytes()].concat();
            let grid = [points, doubles(input, 4), vec![0, 0, 0, 1]].concat();
            let gains = (0..count).flat_map(|_| (f32::from(input.byte()) / 64.0).to_be_bytes()).collect();
            [area(input), grid, gains].concat()
        }
        _ => {
            let count = usize::from(input.byte());
            let values = (0..count).flat_map(|_| (f32::from(input.byte()) / 64.0).to_be_bytes()).collect();
            [area(input), (count as u32).to_be_bytes().to_vec(), values].concat()
        }
    }
}

/// A legal frame with the tags of the input in place of its own.
fn built(bytes: &[u8]) -> Vec<u8> {
    let mut input = Input(bytes);
    let choice = input.byte();
    let form = Form { is_big_endian: choice & 1 == 1, is_wide: choice & 2 == 2 };
    let [width, height] = [0; 2].map(|_| u16::from(2 + input.byte() % SIDE));
    let bits = [8u16, 10, 12, 14, 16, 16, 24, 32][usize::from(input.byte() % 8)];
    let length = usize::from(height) * (usize::from(width) * usize::from(bits)).div_ceil(8);
    let begin = if form.is_wide { 16 } else { 8 };
    let short = |tag: u16, values: &[u16]| -> Entry {
        (tag, 3, values.iter().flat_map(|v| form.whole(u64::from(*v), 2)).collect())
    };
    let mut entries = vec![
        short(256, &[width]),
        short(257, &[height]),
        short(258, &[bits]),
        short(262, &[32803]),
        (273, 4, form.whole(begin, 4)),
        (279, 4, form.whole(length as u64, 4)),
        short(33421, &[2, 2]),
        (33422, 1, vec![0, 1, 1, 2]),
        (50706, 1, vec![1, 7, 1, 0]),
    ];
    if choice & 4 == 4 {
        // Floating-point numbers, where there are as many bits.
        entries.push(short(339, &[3]));
    }
    let tags: Vec<u16> = tags().collect();
    for _ in 0..input.byte() % 12 {
        let tag = tags[usize::from(input.word()) % tags.len()];
        entries.retain(|(other, ..)| *other != tag);
        entries.push(if OPCODE_LISTS.contains(&tag) {
            (tag, 7, opcodes(&mut input))
        } else {
            let kind = 1 + u16::from(input.byte()) % 12;
            let count = usize::from(
                [0u8, 1, 1, 2, 3, 4, 9, width as u8, height as u8][usize::from(input.byte() % 9)],
            );
            let number = |input: &mut Input<'_>| match kind {
                5 | 10 => {
                    [form.whole(u64::from(input.byte()), 4), form.whole(u64::from(input.byte()), 4)].concat()
                }
                3 | 4 | 8 | 9 => form.whole(u64::from(input.byte()), SIZES[usize::from(kind) - 1]),
                _ => input.bytes(SIZES[usize::from(kind) - 1]),
            };
            (tag, kind, (0..count).flat_map(|_| number(&mut input)).collect())
        });
    }
    let pixels: Vec<u8> = if input.0.is_empty() {
        vec![9; length]
    } else {
        input.0.iter().copied().cycle().take(length).collect()
    };
    file(form, &pixels, entries)
}

/// Builds a file, reads it, and finishes the picture of its frame.
pub fn run(bytes: &[u8]) {
    let Ok(Dng { frame, rendering, finish, .. }) =
        decode(&built(bytes), Path::new("shot.dng"), &Overrides::default())
    else {
        return;
    };
    let (height, width) = frame.size();
    let mut picture = ColourFrame::zeros(height, width);
    picture.planes.outer_iter_mut().for_each(|mut plane| {
        plane.zip_mut_with(frame.pixels(), |light, word| *light = f32::from(*word) / 65536.0);
    });
    finish.correct(&mut picture);
    rendering.apply(&mut picture);
    let (rows, columns) = finish.frame(picture).size();
    assert!(rows > 0 && columns > 0 && rows.max(columns) <= height.max(width), "{rows}x{columns}");
}

/// Inputs that choose each tag once, and one of plain zeros.
pub fn seeds() -> Vec<Vec<u8>> {
    let chosen = (0..tags().count() as u16).map(|index| {
        let [high, low] = index.to_be_bytes();
        vec![0, 10, 8, 4, 1, high, low, 2, 1, 1, 5, 7, 9, 11, 13, 15]
    });
    std::iter::once(vec![0; 16]).chain(chosen).collect()
}
