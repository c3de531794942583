use super::*;

fn encode(image: &DynamicImage, format: ImageFormat) -> Result<Vec<u8>, String> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).map_err(|e| e.to_string())?;
    Ok(bytes.into_inner())
}

#[test]
fn every_format_keeps_every_sample() {
    let dir = tempfile::tempdir().unwrap();
    for (channels, full_scale) in [(1, 255u16), (3, 255), (1, u16::MAX), (3, u16::MAX)] {
        let planes = Array3::from_shape_fn((channels, 5, 7), |(p, r, c)| {
            ((p * 35 + r * 7 + c) as u32 * u32::from(full_scale) / 105) as u16
        });
        let samples = Samples { planes, full_scale };
        for ending in ["png", "tif", "tiff", "pnm"] {
            let path = dir.path().join(format!("x.{ending}"));
            save(&path, &samples).unwrap();
            assert_eq!(decode(&read(&path).unwrap(), &path).unwrap(), samples, "{ending}");
        }
    }
}

#[test]
fn photographs_of_other_programs_are_read_but_not_written() {
    let mut grey = image::RgbImage::from_pixel(24, 16, image::Rgb([90, 120, 150]));
    grey.put_pixel(3, 5, image::Rgb([91, 121, 151]));
    for (format, ending, slack) in
        [(ImageFormat::Jpeg, "jpg", 6), (ImageFormat::WebP, "webp", 0), (ImageFormat::Bmp, "bmp", 0)]
    {
        let bytes = encode(&DynamicImage::from(grey.clone()), format).unwrap();
        let path = Path::new("photo").with_extension(ending);
        let found = decode(&bytes, &path).unwrap();
        assert_eq!((found.planes.dim(), found.full_scale), ((3, 16, 24), 255));
        assert!(found.planes[(2, 2, 2)].abs_diff(150) <= slack, "{ending}: {}", found.planes[(2, 2, 2)]);
        assert_eq!(Format::of_ending(&path), Format::of(&bytes));
        assert!(save(&path, &found).unwrap_err().to_string().contains("unknown ending"));
        for kept in [14, bytes.len() / 3] {
            let error = decode(&bytes[..kept], &path).unwrap_err().to_string();
            assert!(error.contains("damaged or unsupported"), "{ending}, {kept} bytes: {error}");
        }
    }
}

#[test]
fn a_jpeg_is_turned_as_its_camera_was_held() {
    let wide = image::GrayImage::from_fn(24, 16, |x, _| image::Luma([if x < 12 { 40 } else { 200 }]));
    let plain = encode(&DynamicImage::from(wide), ImageFormat::Jpeg).unwrap();
    // After the start of the image: Exif of one entry, orientation 6 (a quarter turn clockwise).
    let exif = [
        &[0xff, 0xe1, 0, 34][..],
        b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
    ];
    let turned = [&plain[..2], &exif.concat(), &plain[2..]].concat();
    let samples = decode(&turned, Path::new("x.jpg")).unwrap();
    assert_eq!(samples.planes.dim(), (1, 24, 16));
    assert!(samples.planes[(0, 2, 8)] < 60 && samples.planes[(0, 21, 8)] > 180);
}

#[test]
fn alpha_is_dropped() {
    let image = DynamicImage::from(image::RgbaImage::from_pixel(2, 2, image::Rgba([1, 2, 3, 4])));
    let samples = decode(&encode(&image, ImageFormat::Png).unwrap(), Path::new("x")).unwrap();
    assert_eq!(samples.planes.iter().copied().collect::<Vec<_>>(), [1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]);
}

#[test]
fn a_truncated_picture_is_rejected_by_name() {
    let samples = Samples { planes: Array3::zeros((3, 40, 40)), full_scale: 255 };
    for format in [ImageFormat::Png, ImageFormat::Tiff] {
        let whole = encode(&picture(&samples).unwrap(), format).unwrap();
        for kept in [10, whole.len() / 2] {
            let error = decode(&whole[..kept], Path::new("half")).unwrap_err().to_string();
            assert!(error.starts_with("half: damaged or unsupported"), "{error}");
        }
    }
}

#[test]
fn floating_point_samples_are_rejected() {
    let image = DynamicImage::ImageRgb32F(image::Rgb32FImage::new(2, 2));
    let error = decode(&encode(&image, ImageFormat::Tiff).unwrap(), Path::new("x")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "x: holds 32-bit floating-point samples, expected 8-bit or 16-bit integers"
    );
}

#[test]
fn an_unknown_ending_is_told_the_known_ones() {
    let samples = Samples { planes: Array3::zeros((1, 2, 2)), full_scale: 255 };
    let error = save(Path::new("/nowhere/x.bmp"), &samples).unwrap_err().to_string();
    assert_eq!(error, "/nowhere/x.bmp: unknown ending, expected .png, .tif, .tiff, .ppm or .pgm");
}

#[test]
fn an_endless_device_is_not_read_to_its_end() {
    let error = read(Path::new("/dev/zero")).unwrap_err().to_string();
    assert_eq!(
        error,
        "/dev/zero: cannot read: a device, expected a regular file; save its content to a file and name that one"
    );
}

#[test]
fn text_is_no_picture() {
    assert_eq!(
        decode(b"hello", Path::new("notes.png")).unwrap_err().to_string(),
        "notes.png: not a PNG, JPEG, WebP, TIFF, BMP, PPM or PGM file"
    );
}

#[test]
fn integers_of_a_png_of_few_bits_are_those_of_the_file() {
    // One row of the values 0, 3, 6 and the largest, of 2 or 4 bits, in a stored block of zlib.
    for (bits, row, expected) in
        [(4u8, vec![0x03, 0x6f], [0, 3, 6, 15]), (2, vec![0b0001_1011], [0, 1, 2, 3])]
    {
        let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
        let data = [&[0][..], &row].concat();
        let (mut a, mut b) = (1u32, 0u32);
        for byte in &data {
            a += u32::from(*byte);
            b += a;
        }
        let length = data.len() as u8;
        let stored =
            [&[0x78, 1, 1, length, 0, !length, 0xff][..], &data, &(b << 16 | a).to_be_bytes()].concat();
        let mut chunks = Vec::new();
        // The last chunk first, for each is inserted behind a header of as many bytes as this one's.
        let header = [0, 0, 0, 4, 0, 0, 0, 1, bits, 0, 0, 0, 0];
        chunks.resize(33, 0);
        crate::png_chunks::insert(&mut chunks, *b"IEND", &[]);
        crate::png_chunks::insert(&mut chunks, *b"IDAT", &stored);
        crate::png_chunks::insert(&mut chunks, *b"IHDR", &header);
        png.extend(&chunks[33..]);
        let found = decode_integers(&png, Path::new("x.png")).unwrap();
        assert_eq!(found.into_raw_vec_and_offset().0, expected, "{bits} bits");
    }
}

#[test]
fn animations_and_multi_picture_files_are_the_first_of_several() {
    let png = |frames: u32| {
        let mut png = encode(&DynamicImage::new_rgb8(2, 2), ImageFormat::Png).unwrap();
        crate::png_chunks::insert(&mut png, *b"acTL", &[frames.to_be_bytes(), [0; 4]].concat());
        png
    };
    assert!(is_first_of_several(&png(2)) && !is_first_of_several(&png(1)));
    let webp = |flags: u8| [&b"RIFF\0\0\0\0WEBPVP8X\x0a\0\0\0"[..], &[flags, 0, 0, 0]].concat();
    assert!(is_first_of_several(&webp(0x12)) && !is_first_of_several(&webp(0x10)));
    // An index of one entry, NumberOfImages, behind a segment of Exif.
    let jpeg = |images: u8| {
        let index = [&b"MPF\0MM\0*\0\0\0\x08\0\x01\xb0\x01\0\x04\0\0\0\x01\0\0\0"[..], &[images, 0, 0, 0, 0]]
            .concat();
        let length = [0, 2 + index.len() as u8];
        [&b"\xff\xd8\xff\xe1\0\x04ab\xff\xe2"[..], &length, &index, b"\xff\xda\0\x02"].concat()
    };
    assert!(is_first_of_several(&jpeg(2)) && !is_first_of_several(&jpeg(1)));
    assert!(!is_first_of_several(b"\xff\xd8\xff\xe1\0\0") && !is_first_of_several(&webp(2)[..18]));
}
