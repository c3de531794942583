use super::*;
use crate::picture::{self, PictureError};
use crate::transfer::Transfer;
use std::path::Path;

/// Numbers of a tag, each of 16 or 32 bits.
#[derive(Clone)]
enum Numbers {
    Short(Vec<u16>),
    Long(Vec<u32>),
}
use Numbers::{Long, Short};

/// A file of one strip, its tags in order, with little-endian or big-endian numbers.
fn file(tags: &[(u16, Numbers)], strip: &[u8], is_big_endian: bool) -> Vec<u8> {
    let short = |v: u16| if is_big_endian { v.to_be_bytes() } else { v.to_le_bytes() };
    let long = |v: u32| if is_big_endian { v.to_be_bytes() } else { v.to_le_bytes() };
    let mut tags = tags.to_vec();
    tags.push((tag::STRIP_BYTES, Long(vec![strip.len() as u32])));
    tags.push((tag::STRIP_OFFSETS, Long(vec![8])));
    tags.sort_by_key(|(tag, _)| *tag);
    let mut bytes = if is_big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
    bytes.extend(long(0));
    bytes.extend(strip);
    let mut directory = short(tags.len() as u16).to_vec();
    for (tag, numbers) in tags {
        let (kind, count, mut values) = match numbers {
            Short(v) => (3, v.len(), v.iter().flat_map(|v| short(*v)).collect::<Vec<u8>>()),
            Long(v) => (4, v.len(), v.iter().flat_map(|v| long(*v)).collect()),
        };
        if values.len() > 4 {
            let at = bytes.len() as u32;
            bytes.extend(&values);
            values = long(at).to_vec();
        }
        values.resize(4, 0);
        directory.extend([&short(tag)[..], &short(kind), &long(count as u32), &values].concat());
    }
    let at = bytes.len() as u32;
    bytes[4..8].copy_from_slice(&long(at));
    bytes.extend(directory);
    bytes.extend(long(0));
    bytes
}

fn tags(width: u16, height: u16, bits: &[u16], interpretation: u16) -> Vec<(u16, Numbers)> {
    vec![
        (tag::WIDTH, Short(vec![width])),
        (tag::HEIGHT, Short(vec![height])),
        (tag::BITS, Short(bits.to_vec())),
        (tag::SAMPLES, Short(vec![bits.len() as u16])),
        (tag::INTERPRETATION, Short(vec![interpretation])),
    ]
}

/// A grey picture of two rows of two columns, and more tags.
fn grey(more: &[(u16, Numbers)], strip: &[u8]) -> Vec<u8> {
    file(&[&tags(2, 2, &[8], 1), more].concat(), strip, false)
}

fn values(bytes: &[u8]) -> (Vec<u16>, u16) {
    let samples = picture::decode(bytes, Path::new("x.tif")).unwrap();
    (samples.planes.iter().copied().collect(), samples.full_scale)
}

fn refused(bytes: &[u8]) -> String {
    picture::decode_photograph(bytes, Path::new("x.tif"), |v, _| v).unwrap_err().to_string()
}

#[test]
fn packed_samples_have_the_full_scale_of_their_bits() {
    let read = |bits: u16, strip: &[u8]| values(&file(&tags(2, 2, &[bits], 1), strip, false));
    assert_eq!(read(12, &[0xab, 0xc1, 0x23, 0x00, 0x0f, 0xff]), (vec![0xabc, 0x123, 0, 0xfff], 4095));
    // Rows begin with a byte.
    assert_eq!(
        read(10, &[0b1000_0000, 0b0111_1111, 0b1111_0000, 0, 0, 0b0001_0000]),
        (vec![513, 1023, 0, 1], 1023)
    );
    assert_eq!(read(4, &[0x1f, 0x70]), (vec![1, 15, 7, 0], 15));
    assert_eq!(read(1, &[0b1000_0000, 0b0100_0000]), (vec![1, 0, 0, 1], 1));
}

#[test]
fn sixteen_bits_have_the_byte_order_of_the_file() {
    for is_big_endian in [false, true] {
        let bytes = [0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08];
        let (found, full_scale) = values(&file(&tags(2, 2, &[16], 1), &bytes, is_big_endian));
        let expected =
            if is_big_endian { [0x102, 0x304, 0x506, 0x708] } else { [0x201, 0x403, 0x605, 0x807] };
        assert_eq!((&found[..], full_scale), (&expected[..], u16::MAX));
    }
}

#[test]
fn colours_of_every_kind_become_grey_or_red_green_and_blue() {
    assert_eq!(values(&grey(&[], &[1, 2, 3, 4])).0, [1, 2, 3, 4]);
    assert_eq!(values(&file(&tags(2, 2, &[8], 0), &[1, 2, 3, 255], false)).0, [254, 253, 252, 0]);
    let rgb = tags(2, 1, &[8, 8, 8], 2);
    assert_eq!(values(&file(&rgb, &[1, 2, 3, 4, 5, 6], false)).0, [1, 4, 2, 5, 3, 6]);
    let alpha = tags(1, 1, &[8, 8, 8, 8], 2);
    assert_eq!(values(&file(&alpha, &[1, 2, 3, 4], false)).0, [1, 2, 3]);
    // Ink of one half on black of nothing, and on black alone.
    let cmyk = tags(2, 1, &[8, 8, 8, 8], 5);
    assert_eq!(values(&file(&cmyk, &[51, 0, 255, 0, 0, 0, 0, 255], false)).0, [204, 0, 255, 0, 0, 0]);
    let map = (tag::COLOUR_MAP, Short(vec![0, 1000, 2000, 3000, 0, 10, 20, 30, 0, 1, 2, 3]));
    let palette = [tags(2, 1, &[2], 3), vec![map]].concat();
    assert_eq!(values(&file(&palette, &[0b1101_0000], false)), (vec![3000, 1000, 30, 10, 3, 1], u16::MAX));
}

#[test]
fn colours_multiplied_by_alpha_are_read_where_that_is_full() {
    let with = |alpha: u8, kind: u16| {
        let more = [(tag::EXTRA_SAMPLES, Short(vec![kind]))];
        file(&[&tags(2, 1, &[8; 4], 2), &more[..]].concat(), &[1, 2, 3, 255, 4, 5, 6, alpha], false)
    };
    let opaque = (vec![1, 4, 2, 5, 3, 6], 255);
    assert_eq!(values(&with(255, 1)), opaque);
    // Unassociated alpha is dropped.
    assert_eq!(values(&with(7, 2)), opaque);
    assert!(refused(&with(254, 1)).contains("save it without transparency"));
}

#[test]
fn planes_predictors_and_bit_orders_are_undone() {
    let differences = grey(&[(tag::PREDICTOR, Short(vec![2]))], &[250, 10, 3, 4]);
    assert_eq!(values(&differences).0, [250, 4, 3, 7]);
    let reversed = grey(&[(tag::FILL_ORDER, Short(vec![2]))], &[0x80, 0x40, 0x01, 0xf0]);
    assert_eq!(values(&reversed).0, [1, 2, 0x80, 0x0f]);
    // One strip for each colour; `file` adds a single one.
    let strip = [1, 2, 3, 4, 5, 6];
    let planar = [tags(2, 1, &[8, 8, 8], 2), vec![(tag::PLANES, Short(vec![2]))]].concat();
    let mut bytes = file(&planar, &strip, false);
    assert!(refused(&bytes).contains("fewer strips or tiles"), "{}", refused(&bytes));
    for (tag, numbers) in [(tag::STRIP_OFFSETS, [8u8, 10, 12]), (tag::STRIP_BYTES, [2, 2, 2])] {
        let at = bytes.windows(4).rposition(|w| w == [tag.to_le_bytes(), [4, 0]].concat()).unwrap();
        let end = bytes.len() as u32;
        bytes.extend(numbers.iter().flat_map(|n| u32::from(*n).to_le_bytes()));
        bytes[at + 4..at + 8].copy_from_slice(&3u32.to_le_bytes());
        bytes[at + 8..at + 12].copy_from_slice(&end.to_le_bytes());
    }
    assert_eq!(values(&bytes).0, [1, 2, 3, 4, 5, 6]);
}

#[test]
fn a_big_tiff_is_read() {
    // Widths of BigTIFF: 8 bytes for the count of entries, and for each count and value.
    let mut bytes = b"II+\0\x08\0\0\0\x18\0\0\0\0\0\0\0\x07\x09\0\0\0\0\0\0".to_vec();
    let entries = [(256u16, 2u64), (257, 1), (258, 8), (262, 1), (273, 16), (277, 1), (279, 2)];
    bytes.extend((entries.len() as u64).to_le_bytes());
    for (tag, value) in entries {
        bytes.extend([&tag.to_le_bytes()[..], &[16, 0], &1u64.to_le_bytes(), &value.to_le_bytes()].concat());
    }
    assert_eq!(values(&bytes), (vec![7, 9], 255));
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), &bytes).unwrap();
    assert_eq!(picture::read(file.path()).unwrap(), bytes);
}

#[test]
fn compressed_tiles_that_reach_beyond_the_picture_are_read() {
    // Of tifffile 2026.3.3: 40 rows of 20 columns in tiles of 16x16.
    let bytes = include_bytes!("fixtures/lzw-tiles.tif");
    let samples = picture::decode(bytes, Path::new("x.tif")).unwrap();
    assert_eq!(samples.planes.dim(), (1, 40, 20));
    for ((_, y, x), value) in samples.planes.indexed_iter() {
        assert_eq!(usize::from(*value), (7 * y + 3 * x) * 191);
    }
}

#[test]
fn luma_and_chroma_of_jpeg_become_colours() {
    // Of tifffile 2026.3.3: 16x16 pixels of luma 200, differences 100 and 50: by BT.601 R is 200 - 1.402*78, and G is above 255.
    let bytes = include_bytes!("fixtures/jpeg-ycbcr.tif");
    let (found, _) = values(bytes);
    let is_near = |plane: &[u16], value: u16| plane.iter().all(|v| v.abs_diff(value) <= 2);
    assert!(is_near(&found[..256], 91) && is_near(&found[256..512], 255) && is_near(&found[512..], 150));
}

#[test]
fn a_valid_file_of_another_kind_is_named_for_what_it_is() {
    let unread = "x.tif: valid TIFF of a kind that is not read: ";
    let with = |tag: u16, number: u16| refused(&grey(&[(tag, Short(vec![number]))], &[0; 4]));
    for (number, name) in [
        (50000, "Zstandard compression (50000)"),
        (34712, "JPEG 2000 compression (34712)"),
        (9, "compression 9"),
    ] {
        let error = with(tag::COMPRESSION, number);
        assert!(error.starts_with(&format!("{unread}{name}; save it uncompressed")), "{error}");
    }
    let of =
        |bits: &[u16], interpretation: u16| refused(&file(&tags(1, 1, bits, interpretation), &[0; 8], false));
    assert!(of(&[8, 8, 8], 8).starts_with(&format!("{unread}L*a*b* colours")));
    assert!(of(&[5, 6, 5], 2).starts_with(&format!("{unread}samples of different bits ([5, 6, 5])")));
    assert!(of(&[8, 8, 8], 6).starts_with(&format!("{unread}luma and chroma (YCbCr) without JPEG")));
    for (bits, format, kind) in [
        (32, 1, "32-bit"),
        (16, 2, "16-bit signed"),
        (16, 3, "16-bit floating-point"),
        (64, 6, "64-bit complex"),
    ] {
        let tags = [tags(1, 1, &[bits], 1), vec![(tag::FORMAT, Short(vec![format]))]].concat();
        let expected = format!("x.tif: holds {kind} samples, expected 8-bit or 16-bit integers");
        assert_eq!(refused(&file(&tags, &[0; 8], false)), expected);
    }
}

#[test]
fn a_cameras_raw_frame_or_thumbnail_is_no_photograph() {
    let dng = grey(&[(tag::DNG_VERSION, Short(vec![1]))], &[0; 4]);
    let mosaic = file(&tags(2, 2, &[8], 32803), &[1, 2, 3, 4], false);
    for bytes in [&dng, &mosaic] {
        assert!(
            refused(bytes).starts_with("x.tif: contains a camera's raw frame (DNG"),
            "{}",
            refused(bytes)
        );
    }
    // As a mosaic it is read, as other values of one plane are.
    assert_eq!(values(&mosaic).0, [1, 2, 3, 4]);
    let plain = grey(&[], &[0; 4]);
    let error = picture::decode_photograph(&plain, Path::new("x.NEF"), |v, _| v).unwrap_err();
    assert!(matches!(error, PictureError::CameraRaw { .. }));
    let thumbnail = grey(&[(tag::SUBFILE, Long(vec![1]))], &[0; 4]);
    let as_frame = picture::decode(&thumbnail, Path::new("x.tif")).unwrap_err().to_string();
    for error in [refused(&thumbnail), as_frame] {
        assert!(error.starts_with("x.tif: begins with a thumbnail"), "{error}");
    }
}

#[test]
fn integers_of_grey_whose_0_is_white_are_those_of_the_file() {
    let bytes = file(&tags(2, 2, &[16], 0), &[1, 0, 2, 0, 0, 1, 0xff, 0xff], false);
    let found = picture::decode_integers(&bytes, Path::new("x.tif")).unwrap();
    assert_eq!(found.into_raw_vec_and_offset().0, [1, 2, 256, 65535]);
    assert_eq!(values(&bytes).0, [65534, 65533, 65279, 0]);
}

#[test]
fn inks_other_than_those_of_cmyk_are_rejected() {
    let inks = |set: u16| {
        file(
            &[tags(1, 1, &[8; 4], 5), vec![(tag::INK_SET, Short(vec![set]))]].concat(),
            &[0, 255, 0, 0],
            false,
        )
    };
    assert_eq!(values(&inks(1)).0, [255, 0, 255]);
    assert!(
        refused(&inks(2)).contains("inks other than cyan, magenta, yellow and black (InkSet 2)"),
        "{}",
        refused(&inks(2))
    );
}

#[test]
fn a_transfer_function_states_the_curve_where_no_profile_does() {
    let stated = |curve: &dyn Fn(f64) -> f64, channels: usize| {
        let one =
            (0..256).map(|i| (65535.0 * curve(f64::from(i) / 255.0)).round() as u16).collect::<Vec<_>>();
        let bytes = grey(&[(tag::TRANSFER_FUNCTION, Short(one.repeat(channels)))], &[0; 4]);
        Transfer::of(&bytes).map(|transfer| transfer.to_string())
    };
    for channels in [1, 3] {
        assert_eq!(stated(&|v| v, channels).as_deref(), Some("linear light (TransferFunction (301))"));
    }
    assert_eq!(stated(&|v| v.powf(2.2), 1), None);
    assert_eq!(
        stated(&|v| v.powf(1.8), 1).as_deref(),
        Some("another power (TransferFunction (301), exponent 1.80)")
    );
}

#[test]
fn pages_of_one_size_are_a_stack_and_smaller_copies_are_not() {
    let with = |kind: u32| {
        let directory = |bytes: &[u8]| u32::from_le_bytes(bytes[4..8].try_into().unwrap()) as usize;
        let second = grey(&[(tag::SUBFILE, Long(vec![kind]))], &[0; 4]);
        let mut bytes = grey(&[], &[0; 4]);
        let end = bytes.len();
        bytes[end - 4..].copy_from_slice(&(end as u32).to_le_bytes());
        bytes.extend(&second[directory(&second)..]);
        picture::is_first_of_several(&bytes)
    };
    assert!(with(0) && with(2));
    assert!(!with(1) && !with(4), "a thumbnail, a mask");
    assert!(!picture::is_first_of_several(&grey(&[], &[0; 4])));
}

#[test]
fn what_a_damaged_file_states_is_not_believed() {
    let large = file(
        &[
            (tag::WIDTH, Long(vec![u32::MAX])),
            (tag::HEIGHT, Long(vec![u32::MAX])),
            (tag::BITS, Short(vec![8])),
            (tag::INTERPRETATION, Short(vec![1])),
        ],
        &[0; 4],
        false,
    );
    assert!(refused(&large).contains("more than the 512 MiB"), "{}", refused(&large));
    for (bytes, reason) in [
        (b"II*\0\xff\xff\xff\xff".to_vec(), "its directory is missing"),
        (grey(&[], &[0; 3]), "strip or tile 0 is cut off"),
        (grey(&[(tag::COMPRESSION, Short(vec![5]))], &[0xff; 4]), ""),
        (grey(&[(tag::COMPRESSION, Short(vec![8]))], &[0xff; 4]), ""),
        (grey(&[(tag::COMPRESSION, Short(vec![7]))], &[0xff; 4]), ""),
        (file(&tags(2, 2, &[8], 3), &[0; 4], false), "no colour map"),
        (file(&tags(2, 2, &[8], 2), &[0; 4], false), "fewer samples per pixel"),
        (file(&tags(0, 2, &[8], 1), &[0; 4], false), "states no size"),
    ] {
        let error = refused(&bytes);
        assert!(error.starts_with("x.tif: damaged or unsupported: ") && error.contains(reason), "{error}");
    }
}

#[test]
fn a_photograph_is_turned_as_its_camera_was_held_and_a_mosaic_is_not() {
    // The rows 1 2 3 and 4 5 6 by Exif's orientations, as Pillow's ImageOps.exif_transpose gives them.
    let turned: [&[&[u16]]; 8] = [
        &[&[1, 2, 3], &[4, 5, 6]],
        &[&[3, 2, 1], &[6, 5, 4]],
        &[&[6, 5, 4], &[3, 2, 1]],
        &[&[4, 5, 6], &[1, 2, 3]],
        &[&[1, 4], &[2, 5], &[3, 6]],
        &[&[4, 1], &[5, 2], &[6, 3]],
        &[&[6, 3], &[5, 2], &[4, 1]],
        &[&[3, 6], &[2, 5], &[1, 4]],
    ];
    let path = Path::new("x");
    for (orientation, expected) in (1..).zip(turned) {
        let tags = [tags(3, 2, &[8], 1), vec![(tag::ORIENTATION, Short(vec![orientation]))]].concat();
        let tiff = file(&tags, &[1, 2, 3, 4, 5, 6], false);
        let plain = image::GrayImage::from_raw(3, 2, vec![1, 2, 3, 4, 5, 6]).unwrap();
        let mut png = vec![];
        plain.write_with_encoder(image::codecs::png::PngEncoder::new(&mut png)).unwrap();
        // Exif of one entry, behind the header.
        let exif = [
            b"eXIfII*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0",
            &[orientation as u8, 0, 0, 0, 0, 0, 0, 0][..],
        ];
        let exif = exif.concat();
        let chunk = [&(exif.len() as u32 - 4).to_be_bytes()[..], &exif, &crc(&exif).to_be_bytes()].concat();
        let png = [&png[..33], &chunk, &png[33..]].concat();
        for bytes in [&tiff, &png] {
            let (planes, _) = picture::decode_photograph(bytes, path, |v, _| v).unwrap();
            let rows: Vec<Vec<u16>> =
                planes.index_axis(Axis(0), 0).outer_iter().map(|r| r.to_vec()).collect();
            assert_eq!(rows, expected, "{orientation}");
            assert!(planes.is_standard_layout());
            let stored = picture::decode(bytes, path).unwrap().planes;
            assert_eq!(stored.dim(), (1, 2, 3));
            assert_eq!(stored.into_iter().collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6]);
        }
    }
}

/// Checksum of a PNG's chunk.
fn crc(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| bit(crc)))
}
