//! Raw frames in grey through a PC's graphics card and the receiver as this project sets it up: what is lost, as docs/bring-up.md has it.

use super::{card, card_program, halves as codes_of_words, set};
use edof_board::chip_models::graphics_card::{GraphicsCard, Scaling};
use edof_board::chip_models::hdmi::{Axis, Coding, Pixel, Timing, rgb_of};
use edof_board::chip_models::{Imageon, Timing as Cable};
use edof_core::draw::Draw;
use edof_core::{CfaPhase, RawFrame, cable};
use edof_golden::video::grey::{carried, halves, word};
use edof_golden::video::greys::{self, Path, SIDE};
use ndarray::Array2;

const EXPANDED: Scaling = Scaling { gain: 255.0 / 219.0, offset: -16.0 / 219.0, cuts: false };

/// Values of the receiver's IO 02: of this project, which takes every source for Y'CbCr; and one that converts RGB, as an infoframe says.
const OURS: u8 = 0x35;
const BY_INFOFRAME: u8 = 0xf5;

/// Ways of a grey, by the names that the page has for them.
const WAYS: [(&str, u8, &[Scaling], Coding); 10] = [
    ("RGB, full range", OURS, &[Scaling::NONE], Coding::Rgb),
    ("RGB, limited range", OURS, &[Scaling::LIMITED], Coding::Rgb),
    ("RGB, limited range, i915's older coefficients", OURS, &[Scaling::I915_OLD], Coding::Rgb),
    ("RGB, limited range, i915's newer coefficients", OURS, &[Scaling::I915], Coding::Rgb),
    ("Y'CbCr 4:4:4", OURS, &[Scaling::LIMITED], Coding::Ycc444),
    ("Y'CbCr 4:2:2", OURS, &[Scaling::LIMITED], Coding::Ycc422),
    ("RGB, full range; the receiver converts", BY_INFOFRAME, &[Scaling::NONE], Coding::Rgb),
    ("RGB, limited range; the receiver converts", BY_INFOFRAME, &[Scaling::LIMITED], Coding::Rgb),
    (
        "RGB, limited by player and card; the receiver converts",
        BY_INFOFRAME,
        &[Scaling::LIMITED; 2],
        Coding::Rgb,
    ),
    ("RGB, expanded by the player from 16…235 to 0…255", OURS, &[EXPANDED], Coding::Rgb),
];

/// What the receiver sends to the pins for a line: luma, chroma.
fn received(receiver: &Imageon, coding: Coding, pixels: &[Pixel]) -> Vec<[u8; 2]> {
    let link = GraphicsCard { scalings: &[], coding }.link();
    let line = Axis { active: pixels.len(), ..Cable::P1080_60.line };
    let words = receiver.receiver().line(Timing { line, ..Cable::P1080_60 }, link, pixels, true);
    words[..pixels.len()].iter().map(|word| word.to_be_bytes()).collect()
}

/// A picture of greys at the pins, a word per pixel: luma above chroma.
fn shown(receiver: &Imageon, way: GraphicsCard, greys: &Array2<u8>) -> Array2<u16> {
    let lines =
        greys.rows().into_iter().flat_map(|row| received(receiver, way.coding, &way.line(&row.to_vec())));
    Array2::from_shape_vec(greys.dim(), lines.map(u16::from_be_bytes).collect()).unwrap()
}

/// How many words come wrong or not at all. A frame of which a code is outside of 64 to 191 is dropped by the board.
fn loss(sent: &[u16], came: &[Option<u16>]) -> String {
    let share = |count: usize| format!("{:.1} %", 100.0 * count as f64 / sent.len() as f64);
    let errors = sent.iter().zip(came).map(|(sent, came)| came.map(|came| came.abs_diff(*sent)));
    let errors: Vec<u16> = errors.flatten().filter(|error| *error > 0).collect();
    let wrong = match errors.iter().max() {
        None => "none".to_owned(),
        Some(max) => format!("{} wrong, by up to {max}", share(errors.len())),
    };
    match came.iter().filter(|word| word.is_none()).count() {
        0 => wrong,
        stray => format!("dropped: {} without codes, {wrong}", share(stray)),
    }
}

fn raw(size: (usize, usize)) -> RawFrame {
    let draw = &mut Draw::new(1);
    let words = Array2::from_shape_simple_fn(size, || draw.bits() as u16);
    RawFrame::from_values(words, 16, CfaPhase::Rggb).unwrap()
}

/// Loss of a frame in grey, whose codes are drawn as these greys.
fn grey_loss(receiver: &Imageon, way: GraphicsCard, draw: impl Fn(&Array2<u8>) -> Array2<u8>) -> String {
    let frame = raw((64, 96));
    let came = halves(&frame).map(|half| shown(receiver, way, &draw(&half)));
    let luma = |word: &u16| word.to_be_bytes()[0];
    let words = came.iter().flat_map(|half| half.iter().map(luma).collect::<Vec<u8>>());
    let codes: Vec<u8> = words.collect();
    let came = codes.chunks_exact(2).map(|pair| word([pair[0], pair[1]]).map(|(word, _)| word));
    loss(&carried(&frame).pixels().iter().copied().collect::<Vec<_>>(), &came.collect::<Vec<_>>())
}

/// Loss of words on luma and chroma through a card that composes in RGB.
fn loss_of_words(receiver: &Imageon) -> String {
    let words = cable::carried(&raw((64, 96))).pixels().iter().copied().collect::<Vec<u16>>();
    let pair = |pair: &[u16]| {
        let [[y0, cb], [y1, cr]] = [0, 1].map(|i| cable::codes(pair[i]));
        [y0, y1].map(|y| rgb_of(y, cb, cr)).map(|[r, g, b]| [b, g, r])
    };
    let pixels: Vec<Pixel> = words.chunks_exact(2).flat_map(pair).collect();
    let came = received(receiver, Coding::Rgb, &pixels);
    loss(&words, &came.into_iter().map(cable::word).collect::<Vec<_>>())
}

#[test]
fn what_a_graphics_card_loses_is_what_the_page_says() {
    let receiver = |io_02: u8| {
        let player = card(card_program(|program| set(program, (0x4c, 0x02), io_02)), codes_of_words());
        assert!(player.is_done);
        player.wires.card
    };
    let [ours, by_infoframe] = [OURS, BY_INFOFRAME].map(receiver);
    let mut rows = vec![format!("| words on luma and chroma (1.1), RGB | | {} | |", loss_of_words(&ours))];
    for (name, io_02, scalings, coding) in WAYS {
        let (receiver, way) =
            (if io_02 == OURS { &ours } else { &by_infoframe }, GraphicsCard { scalings, coding });
        let path = Path::of_chart(&shown(receiver, way, &greys::chart(SIDE, SIDE))).unwrap();
        let ends = format!("{} to {}", path.luma()[0], path.luma()[255]);
        let uncalibrated = grey_loss(receiver, way, Clone::clone);
        let calibrated = match path.greys() {
            Ok(greys) => grey_loss(receiver, way, |codes| greys.picture(codes)),
            Err(greys::GreyError::Missing { found, .. }) => format!("refused: {found} of 128 codes"),
            Err(error) => panic!("{error}"),
        };
        rows.push(format!("| {name} | {ends} | {uncalibrated} | {calibrated} |"));
    }
    let page =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/bring-up.md")).unwrap();
    let missing: Vec<&String> = rows.iter().filter(|row| !page.contains(*row)).collect();
    assert!(missing.is_empty(), "docs/bring-up.md lacks:\n{}", rows.join("\n"));
}
