use super::*;
use proptest::prelude::*;

const WIDTH: usize = 20;
const HEIGHT: usize = 14;

/// A directory to be: tags with the kind and the bytes of their numbers, little-endian.
type Tags = Vec<(u16, u16, Vec<u8>)>;

fn shorts(tag: u16, values: &[u16]) -> (u16, u16, Vec<u8>) {
    (tag, 3, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn longs(tag: u16, values: &[u32]) -> (u16, u16, Vec<u8>) {
    (tag, 4, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

/// Signed fractions of 10,000.
fn fractions(tag: u16, values: &[f64]) -> (u16, u16, Vec<u8>) {
    let pair = |v: &f64| [((v * 1e4).round() as i32).to_le_bytes(), 10_000i32.to_le_bytes()].concat();
    (tag, 10, values.iter().flat_map(pair).collect())
}

/// Bytes of a directory that begins at `at`, numbers that do not fit in it behind it.
fn directory(at: usize, mut tags: Tags) -> Vec<u8> {
    tags.sort_by_key(|(tag, ..)| *tag);
    let mut behind = at + 2 + 12 * tags.len() + 4;
    let (mut bytes, mut more) = ((tags.len() as u16).to_le_bytes().to_vec(), vec![]);
    for (tag, kind, mut value) in tags {
        let size = [1, 1, 2, 4, 8, 1, 1, 2, 4, 8][usize::from(kind) - 1];
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(((value.len() / size) as u32).to_le_bytes());
        if value.len() <= 4 {
            value.resize(4, 0);
            bytes.extend(value);
        } else {
            bytes.extend((behind as u32).to_le_bytes());
            behind += value.len();
            more.extend(value);
        }
    }
    bytes.extend([0; 4]);
    bytes.extend(more);
    bytes
}

/// A file with the parts of a picture first, a directory with `about` and one below it with `raw`.
fn file(parts: &[Vec<u8>], about: Tags, mut raw: Tags, tiles: Option<[u16; 2]>) -> Vec<u8> {
    let mut bytes = b"II*\0\0\0\0\0".to_vec();
    let offsets: Vec<u32> = parts
        .iter()
        .map(|part| {
            let at = bytes.len() as u32;
            bytes.extend(part);
            at
        })
        .collect();
    let lengths: Vec<u32> = parts.iter().map(|part| part.len() as u32).collect();
    if raw.iter().all(|(tag, ..)| *tag != tag::WIDTH) {
        raw.push(shorts(tag::WIDTH, &[WIDTH as u16]));
    }
    raw.push(shorts(tag::HEIGHT, &[HEIGHT as u16]));
    raw.push(shorts(tag::INTERPRETATION, &[32803]));
    match tiles {
        Some([rows, columns]) => {
            raw.push(shorts(tag::TILE_HEIGHT, &[rows]));
            raw.push(shorts(tag::TILE_WIDTH, &[columns]));
            raw.push(longs(tag::TILE_OFFSETS, &offsets));
            raw.push(longs(tag::TILE_BYTES, &lengths));
        }
        None => {
            raw.push(longs(tag::STRIP_OFFSETS, &offsets));
            raw.push(longs(tag::STRIP_BYTES, &lengths));
        }
    }
    let below = directory(bytes.len(), raw);
    let at_raw = bytes.len() as u32;
    bytes.extend(below);
    let first = bytes.len();
    bytes[4..8].copy_from_slice(&(first as u32).to_le_bytes());
    let about = [about, vec![longs(330, &[at_raw]), shorts(tag::INTERPRETATION, &[2])]].concat();
    bytes.extend(directory(first, about));
    bytes
}

fn values() -> Array2<u16> {
    Array2::from_shape_fn((HEIGHT, WIDTH), |(r, c)| (100 + 37 * r + 151 * c) as u16)
}

fn words(values: &Array2<u16>) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn pattern(phase: [u8; 4]) -> Tags {
    vec![shorts(tag::CFA_SIZE, &[2, 2]), (tag::CFA, 1, phase.to_vec())]
}

/// A DNG with everything that can be said: two strips, an active area at an odd corner.
fn whole() -> Vec<u8> {
    let values = values();
    let strips = [words(&values.slice(s![..8, ..]).to_owned()), words(&values.slice(s![8.., ..]).to_owned())];
    let mut raw = pattern([2, 1, 1, 0]);
    raw.push(shorts(tag::BITS, &[16]));
    raw.push(shorts(tag::STRIP_ROWS, &[8]));
    raw.push(shorts(tag::BLACK_SIZE, &[2, 2]));
    raw.push(shorts(tag::BLACK_LEVEL, &[60, 61, 62, 63]));
    raw.push(shorts(tag::WHITE_LEVEL, &[3900]));
    raw.push(longs(tag::ACTIVE_AREA, &[1, 3, 13, 20]));
    let about = vec![
        fractions(tag::NEUTRAL, &[0.5, 1.0, 0.625]),
        fractions(tag::COLOUR_MATRICES[1], &[0.9, -0.3, -0.1, -0.4, 1.2, 0.2, -0.1, 0.2, 0.7]),
    ];
    file(&strips, about, raw, None)
}

fn decoded(bytes: &[u8]) -> Result<Dng, String> {
    decode(bytes, Path::new("shot.dng")).map_err(|e| e.to_string())
}

#[test]
fn strips_levels_pattern_and_colours_are_read() {
    let Dng { frame, levels, rendering } = decoded(&whole()).unwrap();
    assert_eq!(frame.values(), values().slice(s![1..13, 3..19]));
    assert_eq!((frame.phase(), frame.depth()), (CfaPhase::Bggr, 16));
    assert_eq!((levels.black.values(), levels.white), ([60.0, 61.0, 62.0, 63.0], Some(3900.0)));
    assert_eq!(<[f64; 3]>::from(rendering.white_balance.unwrap()), [2.0, 1.0, 1.6]);
    // A camera sees a colour by way of XYZ; the matrix leads back to it.
    let camera = product([[0.9, -0.3, -0.1], [-0.4, 1.2, 0.2], [-0.1, 0.2, 0.7]], D65_FROM_SRGB);
    let white = camera.map(|row| row.iter().sum::<f64>());
    for colour in [[1.0, 0.0, 0.0], [0.2, 0.7, 0.1], [0.5; 3]] {
        let seen: Vec<f64> =
            (0..3).map(|i| (0..3).map(|j| camera[i][j] * colour[j]).sum::<f64>() / white[i]).collect();
        let matrix: [[f64; 3]; 3] = rendering.matrix.unwrap().into();
        for (row, expected) in matrix.iter().zip(colour) {
            let found: f64 = row.iter().zip(&seen).map(|(a, b)| a * b).sum();
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }
}

#[test]
fn lossless_tiles_reach_over_the_edge_and_may_hold_two_columns_a_sample() {
    let values = values();
    let padded = Array2::from_shape_fn((16, 24), |(r, c)| values[(r.min(HEIGHT - 1), c.min(WIDTH - 1))]);
    let tile = |index: usize| {
        let (top, left) = (8 * (index / 3), 8 * (index % 3));
        let part: Vec<u16> = padded.slice(s![top..top + 8, left..left + 8]).iter().copied().collect();
        lossless_jpeg::tests::encode(&part, 4, 2, 12, 1 + index as u8)
    };
    let parts: Vec<Vec<u8>> = (0..6).map(tile).collect();
    let mut raw = pattern([0, 1, 1, 2]);
    raw.push(shorts(tag::COMPRESSION, &[7]));
    raw.push(shorts(tag::BITS, &[12]));
    let bytes = file(&parts, vec![], raw, Some([8, 8]));
    let Dng { frame, levels, rendering } = decoded(&bytes).unwrap();
    assert_eq!((frame.values(), frame.depth(), frame.phase()), (values, 12, CfaPhase::Rggb));
    assert_eq!((levels, rendering.matrix), (Levels { black: Black::default(), white: Some(4095.0) }, None));
}

#[test]
fn packed_pixels_and_a_linearization_table_are_read() {
    let values = values().mapv(|v| v % 1024);
    let pack = |row: ndarray::ArrayView1<'_, u16>| {
        let bits = row.iter().fold(String::new(), |text, v| format!("{text}{v:010b}"));
        (0..25).map(|i| u8::from_str_radix(&bits[8 * i..8 * i + 8], 2).unwrap()).collect::<Vec<u8>>()
    };
    let bytes: Vec<u8> = values.outer_iter().flat_map(pack).collect();
    let mut raw = pattern([1, 0, 2, 1]);
    raw.push(shorts(tag::BITS, &[10]));
    let table: Vec<u16> = (0..1000).map(|v| v * 60).collect();
    let plain = file(std::slice::from_ref(&bytes), vec![], raw.clone(), None);
    assert_eq!(decoded(&plain).unwrap().frame.values(), values);
    raw.push(shorts(tag::LINEARIZATION, &table));
    let Dng { frame, levels, .. } = decoded(&file(&[bytes], vec![], raw, None)).unwrap();
    assert_eq!((frame.values(), frame.phase()), (values.mapv(|v| v.min(999) * 60), CfaPhase::Grbg));
    assert_eq!(levels.white, Some(65535.0));
}

#[test]
fn what_is_no_bayer_mosaic_or_compressed_otherwise_is_reported() {
    let told = |mut more: Tags, cfa: [u8; 4]| {
        more.extend(pattern(cfa));
        decoded(&file(&[words(&values())], vec![], more, None)).unwrap_err()
    };
    assert!(told(vec![], [0, 1, 2, 3]).contains("sensor has a 2x2 mosaic [0, 1, 2, 3]"));
    let lossy = told(vec![shorts(tag::COMPRESSION, &[34892])], [0, 1, 1, 2]);
    assert!(lossy.starts_with("shot.dng: ") && lossy.contains("compression 34892, expected 1"), "{lossy}");
    assert!(told(vec![shorts(tag::SAMPLES, &[3])], [0, 1, 1, 2]).contains("not one value"));
    assert!(told(vec![longs(tag::ACTIVE_AREA, &[0, 0, 99, 4])], [0, 1, 1, 2]).contains("active area"));
    assert!(told(vec![shorts(tag::BLACK_LEVEL, &[1, 2, 3])], [0, 1, 1, 2]).contains("black levels"));
    assert!(decoded(b"hello").unwrap_err().contains("does not begin like a DNG"));
    let picture = directory(8, vec![shorts(tag::INTERPRETATION, &[2])]);
    let picture = [&b"II*\0\x08\0\0\0"[..], &picture].concat();
    assert!(decoded(&picture).unwrap_err().contains("no directory of it holds a colour filter array"));
}

#[test]
fn directories_that_lead_in_circles_end() {
    let mut bytes = directory(8, vec![longs(330, &[8])]);
    let end = bytes.len();
    bytes[end - 4..].copy_from_slice(&8u32.to_le_bytes());
    assert!(decoded(&[&b"II*\0\x08\0\0\0"[..], &bytes].concat()).is_err());
}

#[test]
fn tiles_that_share_their_bytes_make_no_large_frame_of_a_small_file() {
    const TILES: usize = 60_000 / 16;
    let mut raw = pattern([0, 1, 1, 2]);
    raw.extend([
        shorts(tag::WIDTH, &[60_000]),
        shorts(tag::TILE_HEIGHT, &[16]),
        shorts(tag::TILE_WIDTH, &[16]),
    ]);
    raw.extend([longs(tag::TILE_OFFSETS, &[8; TILES]), longs(tag::TILE_BYTES, &[512; TILES])]);
    let bytes = file(&[vec![0; 512]], vec![], raw, None);
    assert!(decoded(&bytes).unwrap_err().contains("it ends before its pixels do"));
}

proptest! {
    #[test]
    fn no_damage_makes_it_panic_or_hungry(at in 0usize..1000, byte in any::<u8>(), kept in 0usize..1200) {
        let mut bytes = whole();
        let index = at % bytes.len();
        bytes[index] = byte;
        bytes.truncate(kept);
        if let Ok(dng) = decoded(&bytes) {
            prop_assert!(dng.frame.pixels().len() <= 2 * 8 * 1200);
        }
    }
}
