//! The chart of greys that a graphics card shows, read over the line.

use crate::common::{BAUD, network, open, tiny};
use edof_board::{Error, Simulated};
use edof_core::{CfaPhase, RawFrame};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_golden::Display;
use edof_golden::video::greys::{GreyError, chart};
use std::ops::ControlFlow;

/// A board whose source shows the chart, after a card that makes this luma of a grey.
fn board(luma: impl Fn(u8) -> u8) -> Simulated {
    let design = Design { frame: FrameSize { width: 96, height: 72, ..tiny().frame }, ..tiny() };
    let words = chart(72, 96).mapv(|grey| u16::from_be_bytes([luma(grey), 128]));
    let raw = RawFrame::from_values(words, 16, CfaPhase::Rggb).unwrap();
    let network = network(&design, 1);
    Simulated::new(&design, [&network; 2], &Display::default(), raw, BAUD).unwrap()
}

#[test]
fn greys_are_found_and_the_board_takes_frames_in_grey() {
    let limited = |grey: u8| (16.0 + f64::from(grey) * 219.0 / 255.0).round() as u8;
    let mut board = open(board(limited));
    let setup = "video_setup".parse().unwrap();
    let before = board.get(setup).unwrap();
    let (path, greys) = board.calibrate(&mut |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(path.luma(), (0..=255).map(limited).collect::<Vec<u8>>());
    for (code, grey) in (64..=191).zip(greys.all()) {
        assert_eq!(limited(*grey), code);
    }
    assert_eq!(board.get(setup).unwrap(), before | 2, "grey, and nothing else, is new");
}

#[test]
fn a_card_that_carries_too_few_codes_is_rejected_and_the_input_is_as_before() {
    let mut board = open(board(|grey| 64 + grey / 4));
    let before = board.get("video_setup".parse().unwrap()).unwrap();
    let error = board.calibrate(&mut |_, _| ControlFlow::Continue(())).unwrap_err();
    assert!(matches!(&error, Error::Grey { source: GreyError::Missing { found: 64, .. }, .. }), "{error}");
    assert_eq!(board.get("video_setup".parse().unwrap()).unwrap(), before);
    let stopped = board.calibrate(&mut |_, _| ControlFlow::Break(())).unwrap_err();
    assert!(matches!(stopped, Error::Interrupted));
    assert_eq!(board.get("video_setup".parse().unwrap()).unwrap(), before);
    let mut small = open(crate::common::board(&tiny(), &network(&tiny(), 1)));
    let error = small.calibrate(&mut |_, _| ControlFlow::Continue(())).unwrap_err();
    assert!(matches!(error, Error::NoRoom { width: 32, height: 24, .. }), "{error}");
}
