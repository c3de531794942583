use super::colour::{D65_FROM_SRGB, product};
use super::finish::Crop;
use super::tags::Tag;
use super::*;
use crate::orientation::Orientation;
use proptest::prelude::*;

const WIDTH: usize = 20;
const HEIGHT: usize = 14;

/// A directory to be: tags with the kind and the bytes of their numbers, little-endian.
type Tags = Vec<(u16, u16, Vec<u8>)>;

fn shorts(Tag(tag, _): Tag, values: &[u16]) -> (u16, u16, Vec<u8>) {
    (tag, 3, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

fn longs(Tag(tag, _): Tag, values: &[u32]) -> (u16, u16, Vec<u8>) {
    (tag, 4, values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

/// Signed fractions of 10,000.
fn fractions(Tag(tag, _): Tag, values: &[f64]) -> (u16, u16, Vec<u8>) {
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
    if raw.iter().all(|(tag, ..)| *tag != tags::WIDTH.0) {
        raw.push(shorts(tags::WIDTH, &[WIDTH as u16]));
    }
    raw.push(shorts(tags::HEIGHT, &[HEIGHT as u16]));
    raw.push(shorts(tags::INTERPRETATION, &[32803]));
    match tiles {
        Some([rows, columns]) => {
            raw.push(shorts(tags::TILE_HEIGHT, &[rows]));
            raw.push(shorts(tags::TILE_WIDTH, &[columns]));
            raw.push(longs(tags::TILE_OFFSETS, &offsets));
            raw.push(longs(tags::TILE_BYTES, &lengths));
        }
        None => {
            raw.push(longs(tags::STRIP_OFFSETS, &offsets));
            raw.push(longs(tags::STRIP_BYTES, &lengths));
        }
    }
    let below = directory(bytes.len(), raw);
    let at_raw = bytes.len() as u32;
    bytes.extend(below);
    let first = bytes.len();
    bytes[4..8].copy_from_slice(&(first as u32).to_le_bytes());
    let about =
        [about, vec![longs(tags::SUB_DIRECTORIES, &[at_raw]), shorts(tags::INTERPRETATION, &[2])]].concat();
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
    vec![shorts(tags::CFA_SIZE, &[2, 2]), (tags::CFA.0, 1, phase.to_vec())]
}

/// A DNG with everything that can be said: two strips, an active area at an odd corner.
fn whole() -> Vec<u8> {
    let values = values();
    let strips = [words(&values.slice(s![..8, ..]).to_owned()), words(&values.slice(s![8.., ..]).to_owned())];
    let mut raw = pattern([2, 1, 1, 0]);
    raw.push(shorts(tags::BITS, &[16]));
    raw.push(shorts(tags::STRIP_ROWS, &[8]));
    raw.push(shorts(tags::BLACK_SIZE, &[2, 2]));
    raw.push(shorts(tags::BLACK_LEVEL, &[60, 61, 62, 63]));
    raw.push(shorts(tags::WHITE_LEVEL, &[3900]));
    raw.push(longs(tags::ACTIVE_AREA, &[1, 3, 13, 20]));
    let about = vec![
        fractions(tags::NEUTRAL, &[0.5, 1.0, 0.625]),
        fractions(tags::COLOUR_MATRIX_1, &[0.9, -0.3, -0.1, -0.4, 1.2, 0.2, -0.1, 0.2, 0.7]),
    ];
    file(&strips, about, raw, None)
}

fn decoded(bytes: &[u8]) -> Result<Dng, String> {
    decode(bytes, Path::new("shot.dng"), &Overrides::default()).map_err(|e| e.to_string())
}

/// Words of light where darkness and full light are equal at all pixels.
fn light(values: &Array2<u16>, black: f64, white: f64) -> Array2<u16> {
    values.mapv(|v| {
        let share = ((f64::from(v) - black) / (white - black)).clamp(0.0, 1.0);
        (65536.0 * share).round().min(65535.0) as u16
    })
}

/// The largest difference of words.
fn difference(a: &Array2<u16>, b: &Array2<u16>) -> u16 {
    assert_eq!(a.dim(), b.dim());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn strips_levels_pattern_and_colours_are_read() {
    let Dng { frame, rendering, finish, notes } = decoded(&whole()).unwrap();
    // Each pixel's own darkness is subtracted; the scale is that of the largest.
    let of_cell = |r: usize, c: usize| [60.0, 61.0, 62.0, 63.0][2 * (r % 2) + c % 2];
    let expected = Array2::from_shape_fn((12, 16), |(r, c)| {
        let share = (f64::from(values()[(r + 1, c + 3)]) - of_cell(r, c)) / (3900.0 - 63.0);
        (65536.0 * share.clamp(0.0, 1.0)).round().min(65535.0) as u16
    });
    assert_eq!(frame.values(), expected);
    assert_eq!((frame.phase(), frame.depth()), (CfaPhase::Bggr, 16));
    assert_eq!((finish, notes), (Finish::default(), vec![]));
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
    raw.push(shorts(tags::COMPRESSION, &[7]));
    raw.push(shorts(tags::BITS, &[12]));
    let bytes = file(&parts, vec![], raw, Some([8, 8]));
    let Dng { frame, rendering, .. } = decoded(&bytes).unwrap();
    assert_eq!((frame.values(), frame.phase()), (light(&values, 0.0, 4095.0), CfaPhase::Rggb));
    assert_eq!(rendering, Rendering::default());
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
    raw.push(shorts(tags::BITS, &[10]));
    let table: Vec<u16> = (0..1000).map(|v| v * 60).collect();
    let plain = file(std::slice::from_ref(&bytes), vec![], raw.clone(), None);
    let found = decoded(&plain).unwrap().frame.values();
    assert!(difference(&found, &light(&values, 0.0, 1023.0)) <= 1);
    raw.push(shorts(tags::LINEARIZATION, &table));
    let without = decoded(&file(std::slice::from_ref(&bytes), vec![], raw.clone(), None)).unwrap_err();
    assert!(without.contains("WhiteLevel (50717) is missing"), "{without}");
    raw.push(longs(tags::WHITE_LEVEL, &[65535]));
    let Dng { frame, .. } = decoded(&file(&[bytes], vec![], raw, None)).unwrap();
    let expected = light(&values.mapv(|v| v.min(999) * 60), 0.0, 65535.0);
    assert!(difference(&frame.values(), &expected) <= 1 && frame.phase() == CfaPhase::Grbg);
}

#[test]
fn what_is_no_bayer_mosaic_or_compressed_otherwise_is_reported() {
    let told = |mut more: Tags, cfa: [u8; 4]| {
        more.extend(pattern(cfa));
        decoded(&file(&[words(&values())], vec![], more, None)).unwrap_err()
    };
    assert!(told(vec![], [0, 1, 2, 3]).contains("sensor has a 2x2 mosaic [0, 1, 2, 3]"));
    let lossy = told(vec![shorts(tags::COMPRESSION, &[34892])], [0, 1, 1, 2]);
    let expected = "Compression (259) is 34892 (lossy JPEG), expected 1 (none) or 7 (lossless JPEG); convert";
    assert!(lossy.starts_with("shot.dng: ") && lossy.contains(expected), "{lossy}");
    let bayer = [0, 1, 1, 2];
    assert!(
        told(vec![shorts(tags::SAMPLES, &[3])], bayer).contains("SamplesPerPixel (277) is 3, expected 1")
    );
    assert!(
        told(vec![longs(tags::ACTIVE_AREA, &[0, 0, 99, 4])], bayer)
            .contains("ActiveArea (50829) has 0, 0, 99, 4")
    );
    assert!(
        told(vec![shorts(tags::BLACK_LEVEL, &[1, 2, 3])], bayer)
            .contains("BlackLevel (50714) has 1, 2, 3, expected 1")
    );
    assert!(decoded(b"hello").unwrap_err().contains("does not begin like a TIFF or a DNG"));
    let picture = directory(8, vec![shorts(tags::INTERPRETATION, &[2])]);
    let picture = [&b"II*\0\x08\0\0\0"[..], &picture].concat();
    assert!(decoded(&picture).unwrap_err().contains("no directory of the file has a colour filter array"));
}

#[test]
fn directories_that_lead_in_circles_end() {
    let mut bytes = directory(8, vec![longs(tags::SUB_DIRECTORIES, &[8])]);
    let end = bytes.len();
    bytes[end - 4..].copy_from_slice(&8u32.to_le_bytes());
    assert!(decoded(&[&b"II*\0\x08\0\0\0"[..], &bytes].concat()).is_err());
}

#[test]
fn tiles_that_share_their_bytes_make_no_large_frame_of_a_small_file() {
    const TILES: usize = 60_000 / 16;
    let mut raw = pattern([0, 1, 1, 2]);
    raw.extend([
        shorts(tags::WIDTH, &[60_000]),
        shorts(tags::TILE_HEIGHT, &[16]),
        shorts(tags::TILE_WIDTH, &[16]),
    ]);
    raw.extend([longs(tags::TILE_OFFSETS, &[8; TILES]), longs(tags::TILE_BYTES, &[512; TILES])]);
    let bytes = file(&[vec![0; 512]], vec![], raw, None);
    assert!(decoded(&bytes).unwrap_err().contains("the file is cut: it ends before its pixels do"));
}

/// A frame of 16-bit words in one strip, with these tags beside it.
fn plain(about: Tags, mut raw: Tags) -> Vec<u8> {
    raw.extend(pattern([0, 1, 1, 2]));
    file(&[words(&values())], about, raw, None)
}

#[test]
fn black_differs_by_row_and_column_as_stated() {
    let rows: Vec<f64> = (0..HEIGHT).map(|r| (r % 3) as f64).collect();
    let columns: Vec<f64> = (0..WIDTH).map(|c| -(c as f64) / 2.0).collect();
    let raw = vec![
        longs(tags::WHITE_LEVEL, &[4000]),
        longs(tags::BLACK_LEVEL, &[50]),
        fractions(tags::BLACK_DELTA_V, &rows),
        fractions(tags::BLACK_DELTA_H, &columns),
    ];
    let Dng { frame, .. } = decoded(&plain(vec![], raw)).unwrap();
    let expected = Array2::from_shape_fn((HEIGHT, WIDTH), |(r, c)| {
        let share = (f64::from(values()[(r, c)]) - (50.0 + rows[r] + columns[c])) / (4000.0 - 52.0);
        (65536.0 * share.clamp(0.0, 1.0)).round().min(65535.0) as u16
    });
    assert!(difference(&frame.values(), &expected) <= 1);
}

#[test]
fn the_calibration_for_the_light_nearest_to_daylight_is_taken_whatever_its_place() {
    let (near, far) = (
        [0.8, -0.1, -0.1, -0.4, 1.2, 0.2, -0.1, 0.2, 0.7],
        [1.2, -0.3, -0.05, -0.2, 1.1, 0.1, 0.0, 0.1, 0.4],
    );
    let matrix = |about: Tags| decoded(&plain(about, vec![])).unwrap().rendering.matrix.unwrap();
    let alone = matrix(vec![fractions(tags::COLOUR_MATRIX_1, &near)]);
    let both = |first: (&[f64], u16), second: (&[f64], u16)| {
        matrix(vec![
            fractions(tags::COLOUR_MATRIX_1, first.0),
            shorts(tags::ILLUMINANT_1, &[first.1]),
            fractions(tags::COLOUR_MATRIX_2, second.0),
            shorts(tags::ILLUMINANT_2, &[second.1]),
        ])
    };
    assert_eq!(both((&near, 21), (&far, 17)), alone);
    assert_eq!(both((&far, 17), (&near, 21)), alone);
    assert_eq!(both((&near, 23), (&far, 17)), alone);
}

#[test]
fn stated_values_take_the_place_of_damaged_ones() {
    let about = vec![fractions(tags::NEUTRAL, &[0.0; 3])];
    let raw = vec![longs(tags::BLACK_LEVEL, &[1, 2, 3])];
    let bytes = plain(about, raw);
    assert!(decoded(&bytes).unwrap_err().contains("BlackLevel (50714)"));
    let white_balance = WhiteBalance::try_from([2.0, 1.0, 1.5]).ok();
    let overrides = Overrides {
        phase: Some(CfaPhase::Gbrg),
        black: Some(Black::from(64)),
        white: Some(4095.0),
        white_balance,
        matrix: None,
    };
    let Dng { frame, rendering, notes, .. } = decode(&bytes, Path::new("shot.dng"), &overrides).unwrap();
    assert_eq!((frame.values(), frame.phase()), (light(&values(), 64.0, 4095.0), CfaPhase::Gbrg));
    assert_eq!(rendering.white_balance, white_balance);
    assert_eq!(notes[0], "CFAPattern (33422) states rggb; gbrg is used as stated");
    assert_eq!(notes[1], "BlackLevel (50714) states 1, 2, 3; 64 is used as stated");
    assert_eq!(
        notes[2..],
        ["AsShotNeutral (50728) states 0, 0, 0; a white balance of 2, 1, 1.5 is used as stated"]
    );
}

#[test]
fn crop_and_orientation_are_those_of_the_file() {
    let about = vec![shorts(tags::ORIENTATION, &[6])];
    let raw = vec![
        longs(tags::ACTIVE_AREA, &[2, 2, 14, 20]),
        longs(tags::CROP_ORIGIN, &[4, 2]),
        longs(tags::CROP_SIZE, &[10, 8]),
    ];
    let Dng { frame, finish, .. } = decoded(&plain(about.clone(), raw.clone())).unwrap();
    assert_eq!(frame.size(), (12, 18));
    assert_eq!(finish.crop, Some(Crop { top: 2, left: 4, height: 8, width: 10 }));
    assert_eq!(finish.orientation, Orientation::Rotate90);
    let half = fractions(tags::USER_CROP, &[0.5, 0.0, 1.0, 0.5]);
    let finish = decoded(&plain(about, [raw, vec![half]].concat())).unwrap().finish;
    assert_eq!(finish.crop, Some(Crop { top: 6, left: 4, height: 4, width: 5 }));
    let outside = vec![longs(tags::CROP_SIZE, &[21, 4])];
    assert!(decoded(&plain(vec![], outside)).unwrap_err().contains("DefaultCropSize (50720) has 21, 4"));
}

/// A list of one opcode, big-endian.
fn opcode(Tag(tag, _): Tag, id: u32, flags: u32, parameters: &[u8]) -> (u16, u16, Vec<u8>) {
    let mut bytes = [1u32.to_be_bytes(), id.to_be_bytes(), [1, 3, 0, 0], flags.to_be_bytes()].concat();
    bytes.extend((parameters.len() as u32).to_be_bytes());
    bytes.extend(parameters);
    (tag, 7, bytes)
}

fn big_endian(values: &[u32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_be_bytes()).collect()
}

#[test]
fn listed_defects_are_repaired_and_gains_of_rows_applied() {
    let mut damaged = values();
    damaged[(6, 8)] = 60_000;
    let list = opcode(tags::OPCODES_1, 5, 0, &big_endian(&[0, 1, 0, 6, 8]));
    let raw = [pattern([0, 1, 1, 2]), vec![list, longs(tags::WHITE_LEVEL, &[4095])]].concat();
    let Dng { frame, .. } = decoded(&file(&[words(&damaged)], vec![], raw, None)).unwrap();
    // Values rise evenly, so the mean of the four neighbours is the value that was there.
    assert_eq!(frame.values(), light(&values(), 0.0, 4095.0));

    let mut scale = big_endian(&[0, 0, HEIGHT as u32, WIDTH as u32, 0, 1, 1, 1, HEIGHT as u32]);
    scale.extend((0..HEIGHT).flat_map(|row| (1.0 - row as f32 / 32.0).to_be_bytes()));
    let raw = vec![opcode(tags::OPCODES_2, 12, 0, &scale), longs(tags::WHITE_LEVEL, &[4095])];
    let Dng { frame, .. } = decoded(&plain(vec![], raw)).unwrap();
    let expected = Array2::from_shape_fn((HEIGHT, WIDTH), |(r, c)| {
        let share = f64::from(values()[(r, c)]) / 4095.0 * (1.0 - r as f64 / 32.0);
        (65536.0 * share).round() as u16
    });
    assert!(difference(&frame.values(), &expected) <= 1);
}

#[test]
fn an_opcode_that_is_needed_and_unknown_is_rejected_and_an_optional_one_noted() {
    for (id, list) in [(99, tags::OPCODES_1), (14, tags::OPCODES_3), (1, tags::OPCODES_2)] {
        let needed = decoded(&plain(vec![], vec![opcode(list, id, 0, &[0; 8])])).unwrap_err();
        assert!(needed.contains(&list.to_string()) && needed.contains(&format!("{id}")), "{needed}");
        let optional = decoded(&plain(vec![], vec![opcode(list, id, 1, &[0; 8])])).unwrap();
        assert!(optional.notes[0].contains("is optional and left out"), "{:?}", optional.notes);
        assert_eq!(optional.finish, Finish::default());
    }
    let wrong = decoded(&plain(vec![], vec![opcode(tags::OPCODES_1, 4, 1, &[0; 7])])).unwrap_err();
    assert!(wrong.contains("wrong parameters of FixBadPixelsConstant (4)"), "{wrong}");
    let (tag, kind, mut bytes) = opcode(tags::OPCODES_1, 4, 0, &[0; 8]);
    bytes.truncate(20);
    assert!(
        decoded(&plain(vec![], vec![(tag, kind, bytes)])).unwrap_err().contains("that ends within an opcode")
    );
}

#[test]
fn tags_with_another_value_than_the_one_that_is_read_are_rejected_by_name() {
    for (tag, value) in [
        (tags::FILL_ORDER, 2),
        (tags::PREDICTOR, 2),
        (tags::CFA_LAYOUT, 2),
        (tags::ROW_INTERLEAVE, 2),
        (tags::COLUMN_INTERLEAVE, 2),
        (tags::COLORIMETRIC_REFERENCE, 1),
        (tags::JPEG_TABLES, 0),
        (tags::SAMPLE_FORMAT, 2),
        (tags::NEW_SUBFILE_TYPE, 1),
    ] {
        let error = decoded(&plain(vec![], vec![shorts(tag, &[value])])).unwrap_err();
        assert!(error.contains(&format!("{tag} is ")) && error.contains("; convert it"), "{error}");
    }
}

#[test]
fn a_tag_that_cannot_be_read_is_no_missing_tag() {
    let (tag, _, bytes) = shorts(tags::BLACK_LEVEL, &[64]);
    let error = decoded(&plain(vec![], vec![(tag, 3, bytes.repeat(500))])).unwrap_err();
    assert!(error.contains("BlackLevel (50714) has 64, 64"), "{error}");
    let mut whole = plain(vec![], vec![longs(tags::BLACK_LEVEL, &[1; 3])]);
    // The tag's numbers are behind its directory; move them past the end.
    let entry = [tag.to_le_bytes().as_slice(), &4u16.to_le_bytes(), &3u32.to_le_bytes()].concat();
    let at = whole.windows(8).position(|window| window == entry).unwrap();
    whole[at + 8..at + 12].copy_from_slice(&0x00ff_0000u32.to_le_bytes());
    let error = decoded(&whole).unwrap_err();
    assert!(error.contains("the file is cut: it ends before BlackLevel (50714); copy it again"), "{error}");
}

#[test]
fn every_tag_has_one_name_and_one_number() {
    let numbers: std::collections::BTreeSet<u16> = tags::ALL.iter().map(|tag| tag.0).collect();
    let names: std::collections::BTreeSet<&str> = tags::ALL.iter().map(|tag| tag.1).collect();
    assert_eq!((numbers.len(), names.len()), (tags::ALL.len(), tags::ALL.len()));
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

#[test]
fn a_tiff_with_a_mosaic_is_read_by_its_tags_whatever_its_name() {
    let dir = tempfile::tempdir().unwrap();
    for name in ["shot.tif", "shot.dng", "shot"] {
        let path = dir.path().join(name);
        std::fs::write(&path, whole()).unwrap();
        let opened = crate::raw::open(&path, &crate::raw::RawOptions::default(), &Overrides::default());
        assert_eq!(opened.unwrap().frame, decoded(&whole()).unwrap().frame, "{name}");
    }
}

#[test]
fn bad_pixels_are_repaired_by_the_colours_of_the_pattern_whatever_the_opcode_numbers_them() {
    let numbers = |all: &[u32]| -> Vec<u8> { all.iter().flat_map(|v| v.to_be_bytes()).collect() };
    // Of the area; green begins the file's first row, where a number of 0 has red.
    let value = |r: usize, c: usize| [1000, 2000, 3000][CfaPhase::Bggr.channel(r + 1, c).plane()];
    let points = [[4, 4], [5, 4], [5, 5], [8, 9]];
    for number in 0..5 {
        let list = [&[number, 4, 0][..], points.as_flattened()].concat();
        let head = [numbers(&[1, 5]), vec![1, 3, 0, 0], numbers(&[0, 4 * list.len() as u32])].concat();
        let mut stored = Array2::from_shape_fn((HEIGHT, WIDTH), |(r, c)| value(r, c));
        points.iter().for_each(|[r, c]| stored[(*r as usize, *c as usize)] = 0);
        let mut raw = pattern([2, 1, 1, 0]);
        raw.push(shorts(tags::BITS, &[16]));
        raw.push(longs(tags::ACTIVE_AREA, &[1, 2, 13, 18]));
        raw.push((tags::OPCODES_1.0, 7, [head, numbers(&list)].concat()));
        let frame = decoded(&file(&[words(&stored)], vec![], raw, None)).unwrap().frame;
        let whole = Array2::from_shape_fn((12, 16), |(r, c)| value(r + 1, c + 2));
        assert_eq!(difference(frame.pixels(), &light(&whole, 0.0, 65535.0)), 0, "phase {number}");
    }
}

/// A DNG of colours alone.
fn coloured(about: Tags) -> Result<Dng, String> {
    let mut raw = pattern([0, 1, 1, 2]);
    raw.push(shorts(tags::BITS, &[16]));
    decoded(&file(&[words(&values())], about, raw, None))
}

/// ColorMatrix of a sensor whose colours are those of linear sRGB.
const OF_SRGB: [f64; 9] = [3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570];

#[test]
fn a_shot_nearer_to_another_calibrations_light_than_to_daylight_has_a_note() {
    let shot = |neutral: [f64; 3], lights: [u16; 2]| {
        let about = vec![
            fractions(tags::COLOUR_MATRIX_1, &OF_SRGB),
            fractions(tags::COLOUR_MATRIX_2, &OF_SRGB),
            shorts(tags::ILLUMINANT_1, &lights[..1]),
            shorts(tags::ILLUMINANT_2, &lights[1..]),
            fractions(tags::NEUTRAL, &neutral),
        ];
        coloured(about).unwrap().notes
    };
    // What such a sensor sees of standard illuminant A, whose temperature is 2856 K.
    let tungsten = [1.8452, 0.8263, 0.2333];
    let notes = shot(tungsten, [17, 21]);
    assert!(
        notes.len() == 1 && notes[0].contains("light of about 2900 K, nearer to its calibration for 2850 K"),
        "{notes:?}"
    );
    assert_eq!(shot([1.0; 3], [17, 21]), [""; 0]);
    assert_eq!(shot(tungsten, [21, 21]), [""; 0]);
}

#[test]
fn colours_that_cannot_be_are_rejected_by_their_own_tag_and_what_helps() {
    let with = |tag: (u16, u16, Vec<u8>)| {
        coloured(vec![
            fractions(tags::COLOUR_MATRIX_1, &OF_SRGB),
            fractions(tags::NEUTRAL, &[0.5, 1.0, 0.5]),
            tag,
        ])
    };
    for (tag, words) in [
        (
            fractions(tags::ANALOG_BALANCE, &[0.0, 1.0, 1.0]),
            "AnalogBalance (50727) has 0, 1, 1, expected three numbers above 0; or state",
        ),
        (fractions(tags::CALIBRATION_1, &[0.0; 9]), "CameraCalibration1 (50723) has 0, 0"),
    ] {
        let error = with(tag).unwrap_err();
        assert!(
            error.contains(words) && error.contains("or state the white balance and the colour matrix"),
            "{error}"
        );
    }
    let about = vec![fractions(tags::COLOUR_MATRIX_1, &OF_SRGB), fractions(tags::WHITE_XY, &[0.0, 0.0])];
    let error = coloured(about).unwrap_err();
    let words = "AsShotWhiteXY (50729) has 0, 0, expected x and y of a white that the sensor sees; or state the white balance";
    assert!(error.contains(words), "{error}");
}

#[test]
fn signatures_are_equal_whatever_number_of_zeros_ends_them() {
    let with = |signature: &[u8]| {
        let calibration = [1.1, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.8];
        let about = vec![
            fractions(tags::COLOUR_MATRIX_1, &OF_SRGB),
            fractions(tags::CALIBRATION_1, &calibration),
            fractions(tags::WHITE_XY, &[0.3127, 0.3290]),
            (tags::CALIBRATION_SIGNATURE.0, 2, signature.to_vec()),
            (tags::PROFILE_SIGNATURE.0, 2, b"a\0".to_vec()),
        ];
        coloured(about).unwrap().rendering
    };
    assert_eq!(with(b"a\0\0\0"), with(b"a\0"));
    assert_ne!(with(b"b\0"), with(b"a\0"));
}

#[test]
fn an_infinite_white_level_is_rejected() {
    let mut raw = pattern([0, 1, 1, 2]);
    raw.push(shorts(tags::BITS, &[16]));
    raw.push((tags::WHITE_LEVEL.0, 5, [1u32, 0].iter().flat_map(|v| v.to_le_bytes()).collect()));
    let error = decoded(&file(&[words(&values())], vec![], raw, None)).unwrap_err();
    assert!(
        error.contains("WhiteLevel (50717) has inf") && error.contains("state the white level"),
        "{error}"
    );
}

#[test]
fn a_list_that_ends_within_an_opcode_is_not_called_a_cut_file() {
    let mut raw = pattern([0, 1, 1, 2]);
    raw.push(shorts(tags::BITS, &[16]));
    raw.push((tags::OPCODES_2.0, 7, vec![0, 0]));
    let error = decoded(&file(&[words(&values())], vec![], raw, None)).unwrap_err();
    assert!(error.contains("OpcodeList2 (51009) has a list of 2 bytes"), "{error}");
}
