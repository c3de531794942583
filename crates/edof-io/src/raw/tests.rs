use super::*;
use crate::packing::{ByteOrder, Packing};
use crate::picture;
use crate::samples::Samples;
use edof_core::CfaPhase;
use proptest::prelude::*;

fn frame(depth: u32, phase: CfaPhase) -> RawFrame {
    let values = Array2::from_shape_fn((4, 6), |(r, c)| ((r * 6 + c) * ((1 << depth) - 1) / 23) as u16);
    RawFrame::from_values(values, depth, phase).unwrap()
}

/// A file in a folder of its own, and what loading it gives.
fn loaded(name: &str, content: &[u8], options: RawOptions) -> Result<RawFrame, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, content).unwrap();
    load(&path, &options).map_err(|e| e.to_string().replace(&format!("{}/", dir.path().display()), ""))
}

const GREY: &[u8] = b"P2 2 2 65535 16 32 48 64";

#[test]
fn a_saved_frame_needs_no_option_but_its_phase() {
    let dir = tempfile::tempdir().unwrap();
    for (phase, depth) in CfaPhase::ALL.into_iter().zip([8, 10, 12, 16]) {
        for ending in ["png", "tif", "tiff", "pgm"] {
            let path = dir.path().join(format!("frame.{ending}"));
            save(&path, &frame(depth, phase)).unwrap();
            let back = load(&path, &RawOptions { phase, ..RawOptions::default() }).unwrap();
            assert_eq!((back.pixels(), back.phase()), (frame(depth, phase).pixels(), phase), "{ending}");
        }
    }
}

#[test]
fn the_first_of_several_frames_is_read_with_a_remark() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("frames.pgm");
    let [first, second] = [b"P5 2 2 255\nabcd", b"P5 2 2 255\nefgh"];
    let notes = |content: &[u8]| {
        std::fs::write(&path, content).unwrap();
        let opened = open(&path, &RawOptions::default(), &Overrides::default()).unwrap();
        assert_eq!(opened.frame.values()[(0, 0)], u16::from(b'a'));
        opened.notes
    };
    assert!(notes(first).is_empty());
    assert!(notes(&[&first[..], second].concat())[0].starts_with("has several frames; the first is read"));
}

#[test]
fn a_headerless_file_is_read_in_both_byte_orders() {
    let options =
        RawOptions { depth: Some(12), size: Some(Size { width: 2, height: 2 }), ..RawOptions::default() };
    let little = loaded("x.raw", &[1, 2, 3, 4, 5, 6, 7, 8], options).unwrap();
    let big =
        loaded("x.raw", &[2, 1, 4, 3, 6, 5, 8, 7], RawOptions { order: ByteOrder::Big, ..options }).unwrap();
    assert_eq!(little.values()[(0, 1)], 0x0403);
    assert_eq!(little, big);
}

#[test]
fn packed_pixels_have_their_own_bits() {
    let size = Some(Size { width: 2, height: 2 });
    let options = |packing, depth| RawOptions { packing, depth, size, ..RawOptions::default() };
    let packed = loaded("x.raw", &[0xab, 0x12, 0x3c, 0, 1, 0], options(Packing::Mipi12, None)).unwrap();
    assert_eq!((packed.depth(), packed.values()[(0, 0)], packed.values()[(0, 1)]), (12, 0xabc, 0x123));
    let bytes = loaded("x.raw", &[7, 8, 9, 255], options(Packing::Bytes, Some(8))).unwrap();
    assert_eq!((bytes.depth(), bytes.values()[(1, 1)]), (8, 255));
    assert_eq!(
        loaded("x.raw", &[0; 4], options(Packing::Bytes, Some(10))).unwrap_err(),
        "x.raw: holds 8-bit samples, expected 10 bits as stated"
    );
    assert_eq!(
        loaded("x.raw", &[0; 6], options(Packing::Words, Some(12))).unwrap_err(),
        "x.raw: 6 bytes, expected 8 for 2x2; as many as packed as mipi12 or 12p or 12packed"
    );
    // What begins as a picture does may be pixels.
    assert!(loaded("x.raw", b"P5 0", options(Packing::Bytes, None)).is_ok());
}

#[test]
fn values_at_the_bottom_of_a_png_are_read_where_stated() {
    let options = RawOptions { depth: Some(12), ..RawOptions::default() };
    let at_top = loaded("x", GREY, options).unwrap();
    let at_bottom = loaded("x", GREY, RawOptions { alignment: Some(Alignment::Bottom), ..options }).unwrap();
    assert_eq!((at_top.values()[(0, 1)], at_bottom.values()[(0, 1)]), (2, 32));
}

#[test]
fn packed_samples_of_a_tiff_are_read_with_their_own_depth() {
    // Two rows of two 12-bit values; tags of TIFF 6.0, and the pixels behind them.
    let mut tiff = b"II*\0\x08\0\0\0\x06\0".to_vec();
    for (tag, value) in [(256u16, 2u32), (257, 2), (258, 12), (262, 1), (273, 86), (279, 6)] {
        tiff.extend([&tag.to_le_bytes()[..], &[4, 0], &1u32.to_le_bytes(), &value.to_le_bytes()].concat());
    }
    tiff.extend([&[0; 4][..], &[0xab, 0xc1, 0x23, 0x00, 0x0f, 0xff]].concat());
    let frame = loaded("x.tif", &tiff, RawOptions::default()).unwrap();
    assert_eq!((frame.depth(), frame.values()), (12, ndarray::array![[0xabc, 0x123], [0, 0xfff]]));
}

#[test]
fn a_tiff_in_floating_point_says_how_light_becomes_sensor_values() {
    // A row of two numbers of 32 bits, in floating point.
    let mut tiff = b"II*\0\x08\0\0\0\x07\0".to_vec();
    for (tag, value) in [(256u16, 2u32), (257, 2), (258, 32), (262, 1), (273, 98), (279, 16), (339, 3)] {
        tiff.extend([&tag.to_le_bytes()[..], &[4, 0], &1u32.to_le_bytes(), &value.to_le_bytes()].concat());
    }
    tiff.extend([&[0; 4][..], &[0.25f32, 0.5, 0.75, 1.0].map(f32::to_le_bytes).concat()].concat());
    let error = loaded("x.tif", &tiff, RawOptions::default()).unwrap_err();
    let expected = "expected sensor values, whole numbers from 0 to 65535";
    assert_eq!(error, format!("x.tif: holds 32-bit floating-point samples, {expected}; {OF_LIGHT}"));
}

#[test]
fn a_colour_picture_is_no_raw_frame() {
    let error = loaded("x.ppm", b"P3 1 1 65535 1 2 3", RawOptions::default()).unwrap_err();
    assert_eq!(error, "x.ppm: holds a colour picture, expected one raw value a pixel");
}

#[test]
fn eight_bit_samples_are_rejected_unless_stated() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.png");
    let planes = ndarray::Array3::from_elem((1, 2, 2), 7);
    picture::save(&path, &Samples { planes, full_scale: 255 }).unwrap();
    let error = load(&path, &RawOptions::default()).unwrap_err().to_string();
    assert!(
        error.ends_with("x.png: holds 8-bit samples, expected 16-bit ones (or a stated depth of 8)"),
        "{error}"
    );
    assert!(load(&path, &RawOptions { depth: Some(8), ..RawOptions::default() }).is_ok());
}

#[test]
fn a_depth_that_the_file_contradicts_is_rejected() {
    let stated = |depth| RawOptions { depth: Some(depth), ..RawOptions::default() };
    assert_eq!(
        loaded("x.pgm", b"P2 2 2 4095 1 2 3 4", stated(10)).unwrap_err(),
        "x.pgm: holds 12-bit samples, expected 10 bits as stated"
    );
    assert_eq!(
        loaded("x.pgm", b"P2 2 2 65535 16 33 0 0", stated(12)).unwrap_err(),
        "x.pgm: pixel at row 0, column 1 is 33, no 12-bit code aligned to the top of 16 bits"
    );
    assert_eq!(
        loaded("x.pgm", GREY, RawOptions { alignment: Some(Alignment::Bottom), ..stated(8) })
            .map(|f| f.depth()),
        Ok(8)
    );
    assert_eq!(loaded("x.pgm", GREY, stated(7)).unwrap_err(), "x.pgm: bit depth 7: must be 8 to 16");
}

#[test]
fn a_value_wider_than_the_depth_is_rejected() {
    let size = Some(Size { width: 2, height: 2 });
    let options = RawOptions { depth: Some(10), size, ..RawOptions::default() };
    assert_eq!(
        loaded("x.raw", &[0, 0, 0, 4, 0, 0, 0, 0], options).unwrap_err(),
        "x.raw: pixel at row 0, column 1 is 1024, more than 10 bits can hold"
    );
}

#[test]
fn odd_sides_are_rejected() {
    let error = loaded("x.pgm", b"P2 3 2 65535 1 2 3 4 5 6", RawOptions::default()).unwrap_err();
    assert_eq!(error, "x.pgm: frame 3x2: both sides must be even, so that it holds whole 2x2 Bayer cells");
}

#[test]
fn a_device_is_rejected_whatever_size_is_stated() {
    let size = Some("4x2".parse().unwrap());
    for size in [size, None] {
        let error = load(Path::new("/dev/zero"), &RawOptions { size, ..RawOptions::default() }).unwrap_err();
        assert!(error.to_string().starts_with("/dev/zero: cannot read: a device, expected a regular file"));
    }
}

#[test]
fn sizes_are_checked_against_the_file() {
    let size = Some("4x2".parse().unwrap());
    let options = RawOptions { size, ..RawOptions::default() };
    assert_eq!(loaded("x.raw", &[0; 15], options).unwrap_err(), "x.raw: 15 bytes, expected 16 for 4x2");
    assert_eq!(
        loaded("x.pgm", GREY, options).unwrap_err(),
        "x.pgm: 2x2 pixels, expected as many as stated for 4x2"
    );
    assert!(loaded("x.raw", &[0; 16], RawOptions::default()).unwrap_err().contains("state its size"));
}

#[test]
fn text_that_is_no_size_is_rejected() {
    for text in ["", "4", "4x", "0x4", "4x-1", "70000x2", "4 x 2"] {
        assert_eq!(text.parse::<Size>(), Err(WrongSize(text.to_owned())));
    }
}

#[test]
fn every_ending_is_of_one_format_and_what_is_written_is_recognised() {
    let endings: Vec<&str> = FORMATS.iter().flat_map(|format| format.endings).copied().collect();
    for ending in &endings {
        let path = Path::new("x").with_extension(ending.to_uppercase());
        assert_eq!(FORMATS.iter().filter(|format| format.is_named(&path)).count(), 1, "{ending}");
    }
    for format in FORMATS {
        let Some(write) = &format.write else { continue };
        let path = Path::new("x").with_extension(format.endings[0]);
        let bytes = (write.encode)(&frame(12, CfaPhase::Rggb), &path).unwrap();
        let found = of_content(&bytes).map(|found| found.name);
        let headerless = matches!(format.read, Read::Headerless(_));
        assert_eq!(found, (!headerless).then_some(format.name), "{}", format.name);
    }
}

#[test]
fn in_a_container_of_several_formats_the_ending_decides() {
    let tiff =
        (writer(Path::new("x.tif")).unwrap().encode)(&frame(12, CfaPhase::Rggb), Path::new("")).unwrap();
    let format = |name: &str, bytes: &[u8], size: bool| {
        let size = size.then_some(Size { width: 2, height: 2 });
        formats::recognised(Path::new(name), bytes, &RawOptions { size, ..RawOptions::default() }).name
    };
    let named = ["x.tif", "x", "x.png", "x.dng", "x.NEF"].map(|name| format(name, &tiff, true));
    assert_eq!(named, ["TIFF", "TIFF", "TIFF", "DNG", "camera raw"]);
    // What no format claims is a camera's where its name states so and no size does.
    assert_eq!(
        ["x.dng", "x.raw", "x.png"].map(|name| format(name, b"pixels", false)),
        ["DNG", "headerless", "headerless"]
    );
    assert_eq!(format("x.dng", b"pixels", true), "headerless");
    assert_eq!(format("x.dng", GREY, false), "PGM");
}

#[test]
fn the_help_has_every_ending_that_is_written() {
    assert_eq!(
        written(),
        ".png or .tif (sensor values at the top of 16 bits), .pgm, .npy (an array of sensor values), or .raw without a header"
    );
}

#[test]
fn an_unknown_ending_is_rejected_with_the_known_ones() {
    let error = save(Path::new("x.dng"), &frame(12, CfaPhase::Rggb)).unwrap_err().to_string();
    assert_eq!(error, "x.dng: unknown ending, expected .png, .tif, .tiff, .pgm, .npy, .raw or .bin");
}

/// An array as `numpy.save` of NumPy 2.4.6 writes it.
fn array(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}");
    [b"\x93NUMPY\x01\0v\0", format!("{header:117}\n").as_bytes(), data].concat()
}

#[test]
fn an_array_of_numpy_is_read_in_every_type_and_order_and_written_as_numpy_does() {
    let values = ndarray::array![[1, 2], [770, 255]];
    let little = array("<u2", "False", "(2, 2)", &[1, 0, 2, 0, 2, 3, 255, 0]);
    for bytes in [
        &little,
        &array(">u2", "True", "(2, 2)", &[0, 1, 3, 2, 0, 2, 0, 255]),
        &array("<f4", "False", "(2, 2)", &[1.0f32, 2.0, 770.0, 255.0].map(f32::to_le_bytes).concat()),
        &array("<i8", "False", "(2, 2)", &[1i64, 2, 770, 255].map(i64::to_le_bytes).concat()),
    ] {
        let frame = loaded("x.npy", bytes, RawOptions { depth: Some(10), ..RawOptions::default() }).unwrap();
        assert_eq!((frame.values(), frame.depth()), (values.clone(), 10));
        assert_eq!((writer(Path::new("x.npy")).unwrap().encode)(&frame, Path::new("")).unwrap(), little);
    }
    let bytes =
        loaded("x", &array("|u1", "False", "(2, 2)", &[1, 2, 3, 255]), RawOptions::default()).unwrap();
    assert_eq!((bytes.depth(), bytes.values()[(1, 1)]), (8, 255));
}

#[test]
fn an_array_that_is_no_frame_is_rejected() {
    let float =
        |value: f32| array("<f4", "False", "(2, 2)", &[0.0, value, 0.0, 0.0].map(f32::to_le_bytes).concat());
    let expected = "expected a sensor value, a whole number from 0 to 65535";
    for (bytes, value, hint) in [
        (float(0.5), "0.5", format!("; {OF_LIGHT}")),
        (float(-1.0), "-1", String::new()),
        (float(f32::NAN), "NaN", String::new()),
        (array("<u4", "False", "(1, 2)", &[0, 0, 0, 0, 0, 0, 1, 0]), "65536", String::new()),
    ] {
        let error = loaded("x.npy", &bytes, RawOptions::default()).unwrap_err();
        assert_eq!(error, format!("x.npy: pixel at row 0, column 1 is {value}, {expected}{hint}"));
    }
    for (bytes, reason) in [
        (array("|u1", "False", "(4,)", &[0; 4]), "an array of 4, expected rows x columns of sensor values"),
        (array("<c8", "False", "(2, 2)", &[0; 32]), "its elements are not real numbers"),
        (array("|u1", "False", "(2, 2)", &[0; 3]), "3 bytes of data do not make 2 x 2 numbers of 1 bytes"),
        (b"\x93NUMPY\x01".to_vec(), "no whole NPY array"),
    ] {
        let error = loaded("x.npy", &bytes, RawOptions::default()).unwrap_err();
        assert_eq!(error, format!("x.npy: damaged or unsupported: {reason}"));
    }
    let size = Some(Size { width: 4, height: 2 });
    let error = loaded(
        "x.npy",
        &array("|u1", "False", "(2, 2)", &[0; 4]),
        RawOptions { size, ..RawOptions::default() },
    );
    assert_eq!(error.unwrap_err(), "x.npy: 2x2 pixels, expected as many as stated for 4x2");
}

proptest! {
    #[test]
    fn a_frame_of_any_depth_comes_back(
        depth in 8u32..=16, ending in prop::sample::select(vec!["png", "tif", "pgm", "npy", "raw"])
    ) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(format!("frame.{ending}"));
        let original = frame(depth, CfaPhase::Gbrg);
        save(&path, &original).unwrap();
        let size = Some(Size { width: 6, height: 4 });
        let options = RawOptions { phase: CfaPhase::Gbrg, depth: Some(depth), size, ..RawOptions::default() };
        prop_assert_eq!(load(&path, &options).unwrap(), original);
    }
}

#[test]
fn a_pgm_whose_maximum_is_of_no_bits_has_a_note_of_what_full_light_is() {
    let notes = |maximum: u16| {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("x.pgm");
        std::fs::write(&path, format!("P2 2 2 {maximum} 0 1 2 {maximum}")).unwrap();
        open(&path, &RawOptions::default(), &Overrides::default()).unwrap().notes
    };
    assert_eq!(
        notes(1000),
        ["states a maximum of 1000; full light is taken for 1024, unless a white level is stated"]
    );
    assert_eq!([notes(1023), notes(255), notes(65535)].concat(), [""; 0]);
}
