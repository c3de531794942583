use super::*;
use edof_core::colour::{chroma_word, luma_word, srgb_encode, ycbcr_matrix};
use edof_core::number::nearest;
use proptest::prelude::*;

/// A line of words.
fn plane(bits: &[i16]) -> Array2<OutputWord> {
    Array2::from_shape_fn((1, bits.len()), |(_, x)| OutputWord::from_bits(bits[x]))
}

/// A frame of one colour in linear light.
fn flat(rgb: [f64; 3]) -> Frame422 {
    let [luma, cb, cr] =
        ycbcr_matrix().map(|row| row.iter().zip(rgb).map(|(weight, light)| weight * light).sum::<f64>());
    let chroma = [cb, cr].map(|c| Array2::from_elem((2, 4), chroma_word(c)));
    Frame422 { luma: Array2::from_elem((2, 8), luma_word(luma)), chroma }
}

/// What a sink shows in the middle of a patch of linear light, as sRGB codes.
fn shown(rgb: [f64; 3], mode: DisplayMode) -> [u8; 3] {
    let picture = Display::new(mode, Curve::Srgb).picture(&flat(rgb), (0, 0), (2, 8)).0;
    let shown = picture.shown();
    std::array::from_fn(|plane| shown[(plane, 1, 3)])
}

fn farthest(rgb: [f64; 3]) -> f64 {
    let exact = rgb.map(|light| 255.0 * srgb_encode(light));
    exact
        .iter()
        .zip(shown(rgb, DisplayMode::Colour))
        .map(|(e, s)| (e - f64::from(s)).abs())
        .fold(0.0, f64::max)
}

/// Linear light of a chart of our own: skin, sky, leaves, primaries and secondaries, six greys; then dark colours.
const PATCHES: [[f64; 3]; 30] = [
    [0.17, 0.08, 0.05],
    [0.54, 0.30, 0.22],
    [0.11, 0.19, 0.34],
    [0.10, 0.15, 0.05],
    [0.22, 0.21, 0.43],
    [0.13, 0.51, 0.41],
    [0.70, 0.20, 0.025],
    [0.06, 0.10, 0.38],
    [0.55, 0.09, 0.12],
    [0.11, 0.04, 0.14],
    [0.34, 0.50, 0.04],
    [0.77, 0.36, 0.02],
    [0.03, 0.04, 0.28],
    [0.05, 0.30, 0.06],
    [0.45, 0.03, 0.04],
    [0.85, 0.57, 0.01],
    [0.51, 0.08, 0.30],
    [0.01, 0.24, 0.37],
    [0.90, 0.90, 0.88],
    [0.58, 0.58, 0.58],
    [0.36, 0.36, 0.36],
    [0.19, 0.19, 0.19],
    [0.09, 0.09, 0.09],
    [0.032, 0.032, 0.032],
    [0.05, 0.01, 0.01],
    [0.01, 0.05, 0.01],
    [0.01, 0.01, 0.05],
    [0.004, 0.002, 0.001],
    [0.0, 0.0, 0.0],
    [1.0, 1.0, 1.0],
];

#[test]
fn colour_patches_show_within_two_codes_of_their_light() {
    for rgb in PATCHES {
        assert!(farthest(rgb) <= 2.0, "{rgb:?} shows as {:?}", shown(rgb, DisplayMode::Colour));
    }
}

#[test]
fn dark_red_is_red_in_colour_and_pale_in_luma_only() {
    let dark_red = [0.05, 0.01, 0.01];
    for (shown, exact) in shown(dark_red, DisplayMode::Colour).into_iter().zip([63, 25, 25]) {
        assert!(shown.abs_diff(exact) <= 1, "{shown}, expected {exact}");
    }
    assert!(shown(dark_red, DisplayMode::Luma)[0] < 50);
}

#[test]
fn luma_only_rounds_chroma_with_ties_up_and_keeps_off_the_sync_codes() {
    let words = [63, 64, -64, -65, i16::MAX, i16::MIN];
    let frame = Frame422 { chroma: [plane(&words), plane(&[0; 6])], luma: plane(&[0; 12]) };
    let (picture, counts) = Display::new(DisplayMode::Luma, Curve::Linear).picture(&frame, (0, 0), (1, 12));
    assert_eq!(picture.chroma[0].as_slice().unwrap(), [128, 129, 128, 127, 254, 1]);
    assert_eq!(counts, DisplayCounts { clamped_chroma: 2, out_of_gamut: 0 });
}

#[test]
fn a_frame_that_starts_between_sites_takes_the_mean_of_its_neighbours() {
    let frame = Frame422 {
        luma: plane(&[0, 256, 512, 768, 1024, 1280]),
        chroma: [0, 1].map(|_| plane(&[0, 1280, 2561])),
    };
    let (picture, _) = Display::new(DisplayMode::Luma, Curve::Linear).picture(&frame, (0, 1), (1, 4));
    // (0 + 1280)/2 and (1280 + 2561)/2 in units of 128.
    assert_eq!(picture.chroma[0].as_slice().unwrap(), [133, 143]);
    assert_eq!(picture.luma[(0, 0)], LumaTable::new(Curve::Linear).code(OutputWord::from_bits(256)));
}

#[test]
fn colours_that_no_screen_has_are_counted_and_clipped() {
    let mut frame = flat([0.5, 0.5, 0.5]);
    frame.chroma[1].fill(chroma_word(0.4));
    let (picture, counts) = Display::default().picture(&frame, (0, 0), (2, 8));
    assert_eq!(counts, DisplayCounts { clamped_chroma: 0, out_of_gamut: 16 });
    assert_eq!(picture.shown()[(0, 0, 0)], 255);
}

#[test]
fn codes_are_written_luma_first() {
    let row = |values: [u8; 4]| Array2::from_shape_vec((2, 2), values.to_vec()).unwrap();
    let one = |values: [u8; 2]| Array2::from_shape_vec((2, 1), values.to_vec()).unwrap();
    let picture = Picture { luma: row([1, 2, 3, 4]), chroma: [one([11, 12]), one([21, 22])] };
    assert_eq!(picture.yuyv(), [1, 11, 2, 21, 3, 12, 4, 22]);
}

proptest! {
    #[test]
    fn light_in_32_bits_is_the_contracts(luma: i16, cb in -65_536..=65_534, cr in -65_536..=65_534) {
        let luma = OutputWord::from_bits(luma);
        let [cb, cr] = [cb, cr].map(OutputSum::from_bits);
        // Exact products of the types: 17 + 14 fraction bits.
        let contract: [OutputSum; 3] = TO_RGB.map(|[of_cb, of_cr]| {
            nearest(ToRgb::ONE.wide_mul(OutputSum::from(luma)) + of_cb.wide_mul(cb) + of_cr.wide_mul(cr))
        });
        prop_assert_eq!(light_of(luma, [cb, cr]), contract);
        for isa in Isa::available() {
            let mut light = [0; 3].map(|_| vec![TableIndex::ZERO; 40]);
            let outside = light_line(isa, &[luma; 40], [&[cb; 40], &[cr; 40]], &mut light);
            prop_assert_eq!(outside == 40, contract.iter().any(|light| *light < 0 || *light > 1));
            for (plane, expected) in light.iter().zip(contract) {
                let address = expected.to_bits().clamp(0, (1 << 14) - 1);
                prop_assert!(plane.iter().all(|light| i32::from(light.to_bits()) == address), "{isa:?}");
            }
        }
    }

    #[test]
    fn grey_stays_grey_and_every_colour_shows_within_two_and_a_half_codes(rgb in prop::array::uniform3(0.0f64..1.0)) {
        prop_assert!(farthest(rgb) <= 2.5, "{:?}", shown(rgb, DisplayMode::Colour));
        let [r, g, b] = shown([rgb[0]; 3], DisplayMode::Colour);
        prop_assert!(r == g && g == b);
    }

    #[test]
    fn no_word_gives_a_sync_code(luma: i16, cb: i16, cr: i16) {
        let frame = Frame422 {
            luma: plane(&[luma; 4]),
            chroma: [cb, cr].map(|word| plane(&[word; 2])),
        };
        for mode in DisplayMode::ALL {
            let picture = Display::new(mode, Curve::Srgb).picture(&frame, (0, 0), (1, 4)).0;
            prop_assert!(picture.yuyv().iter().all(|code| (1..=254).contains(code)));
        }
    }
}

#[test]
fn each_colour_goes_through_its_own_table() {
    let light = [0.3, 0.2, 0.1];
    for linear in 0..3 {
        let curve = |colour| if colour == linear { Curve::Linear } else { Curve::Srgb };
        let colours = std::array::from_fn(|colour| ColourTable::new(curve(colour)));
        let shown = Display { colours, ..Display::default() }.picture(&flat(light), (0, 0), (2, 8)).0.shown();
        for (colour, light) in light.into_iter().enumerate() {
            let exact = 255.0 * if colour == linear { light } else { srgb_encode(light) };
            let shown = f64::from(shown[(colour, 1, 3)]);
            assert!(
                (shown - exact).abs() <= 2.5,
                "{colour} where {linear} is linear: {shown}, expected {exact}"
            );
        }
    }
}

#[test]
fn a_picture_may_take_the_memory_of_another_of_any_size() {
    let frame = flat([0.3, 0.2, 0.1]);
    for mode in DisplayMode::ALL {
        let display = Display::new(mode, Curve::Srgb);
        let (expected, counts) = display.picture(&frame, (0, 0), (2, 8));
        assert_eq!(expected.luma.dim(), (2, 8));
        let mut sizes = [(0, 0), (2, 8), (2, 4), (5, 8)].into_iter();
        let memory = |(height, width)| Picture {
            luma: Array2::from_elem((height, width), 7),
            chroma: [9, 11].map(|code| Array2::from_elem((height, width / 2), code)),
        };
        assert!(sizes.all(|size| {
            let mut picture = memory(size);
            display.picture_into(&frame, (0, 0), (2, 8), &mut picture) == counts && picture == expected
        }));
    }
}

#[test]
fn counts_of_lines_add_up() {
    let count = |clamped_chroma, out_of_gamut| DisplayCounts { clamped_chroma, out_of_gamut };
    assert_eq!(count(3, 5) + count(20, 40), count(23, 45));
}

#[test]
fn a_shown_frame_is_what_a_sink_shows_from_none_to_full_light() {
    let picture = Display::default().picture(&flat([0.0, 0.5, 1.0]), (0, 0), (2, 8)).0;
    let (frame, codes) = (picture.shown_frame().planes, picture.shown());
    assert_eq!(frame.dim(), (3, 2, 8));
    assert!(frame.iter().zip(&codes).all(|(light, code)| (light * 255.0 - f32::from(*code)).abs() < 1e-3));
    assert!(codes[(2, 1, 3)] > 250 && frame[(2, 1, 3)] <= 1.0);
}
