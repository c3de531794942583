//! The transmitter: from words at pins to what a viewer sees.

use crate::setup::{RGB, SMALL, Write, YCC, board, board_with, run, send};
use edof_board::chip_models::adv7511::State;
use edof_board::chip_models::hdmi::{Coding, rgb_of};
use edof_board::chip_models::screen::Shown;
use edof_board::chip_models::{Delays, Kc705, LowHotPlug, Master, Screen};

/// Words {chroma, luma} of a picture, smooth enough for any colours.
fn words() -> Vec<u16> {
    (0..128).map(|i| u16::from(60 + i as u8 % 120) << 8 | u16::from(16 + i as u8)).collect()
}

/// What a viewer should see.
fn colours() -> Vec<[u8; 3]> {
    let words = words();
    let pairs = words.chunks(2).flat_map(|pair| {
        let [cb, cr] = [pair[0], pair[1]].map(|word| (word >> 8) as u8);
        pair.iter().map(move |word| rgb_of(*word as u8, cb, cr)).collect::<Vec<_>>()
    });
    pairs.collect()
}

fn shown(board: &mut Kc705) -> Option<Shown> {
    board.screen_mut().unwrap().shown.clear();
    send(board, &words(), 3);
    board.screen().unwrap().shown.last().cloned()
}

fn worst(shown: &Shown) -> u8 {
    let differences = shown
        .rgb()
        .into_iter()
        .zip(colours())
        .map(|(a, b)| (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap());
    differences.max().unwrap()
}

#[test]
fn ycc_passes_as_it_is_and_rgb_within_two_codes() {
    let mut ycc = board_with(Screen::hdmi(), &board(YCC));
    let picture = shown(&mut ycc).unwrap();
    assert_eq!((picture.coding, picture.width, worst(&picture)), (Coding::Ycc422, SMALL.line.active, 0));
    let mut rgb = board_with(Screen::hdmi(), &board(RGB));
    let picture = shown(&mut rgb).unwrap();
    assert_eq!(picture.coding, Coding::Rgb);
    assert!(worst(&picture) <= 2, "{}", worst(&picture));
    assert_eq!(rgb.transmitter().complaints(), [""; 0]);
}

#[test]
fn style_3_takes_chroma_for_luma() {
    for (style, is_right) in [(0xb9, true), (0xb5, true), (0xbd, false)] {
        let mut board = board_with(Screen::hdmi(), &[board(YCC), vec![(0x39, vec![0x16, style])]].concat());
        assert_eq!(worst(&shown(&mut board).unwrap()) == 0, is_right, "{style:02X}");
    }
}

#[test]
fn a_dvi_screen_shows_rgb_alone_right() {
    let dvi = |output: &[(u8, u8)]| shown(&mut board_with(Screen::dvi(), &board(output))).unwrap();
    assert!(worst(&dvi(YCC)) > 50);
    assert!(worst(&dvi(RGB)) <= 2 && dvi(RGB).has_islands);
    let without = [RGB, &[(0xaf, 0x04)]].concat();
    assert!(worst(&dvi(&without)) <= 2 && !dvi(&without).has_islands);
}

#[test]
fn an_infoframe_that_says_something_else_spoils_colours() {
    let lies = [YCC, &[(0x55, 0x00)]].concat();
    assert!(worst(&shown(&mut board_with(Screen::hdmi(), &board(&lies))).unwrap()) > 50);
    let no_matrix = [RGB, &[(0x18, 0x46)]].concat();
    assert!(worst(&shown(&mut board_with(Screen::hdmi(), &board(&no_matrix))).unwrap()) > 50);
}

#[test]
fn another_bus_or_no_power_shows_nothing() {
    for (register, value, state) in [
        (0x15, 0x00, State::OtherBus),
        (0x48, 0x00, State::OtherBus),
        (0x16, 0x80, State::OtherBus),
        (0x41, 0x50, State::PoweredDown),
    ] {
        let mut board =
            board_with(Screen::hdmi(), &[board(YCC), vec![(0x39, vec![register, value])]].concat());
        assert_eq!((board.transmitter().state(), shown(&mut board)), (state, None));
    }
}

/// The same writes with the override where it is now at the end, or nowhere.
fn without_override(writes: &[Write]) -> Vec<Write> {
    writes.iter().filter(|(_, bytes)| bytes[0] != 0xd6).cloned().collect()
}

#[test]
fn a_low_hot_plug_takes_every_register_back_unless_it_is_overridden_first() {
    for low in [LowHotPlug::HoldsDefaults, LowHotPlug::ResetsOnce] {
        let first = board(YCC);
        let last = [without_override(&first), vec![(0x39, vec![0xd6, 0xc0])]].concat();
        for (writes, shows) in [(&first, true), (&last, false)] {
            // The screen is off while the chip is set up.
            let mut board = Kc705::new(Delays::NONE, low);
            board.set_reset(true);
            run(&mut board, writes);
            board.attach(Some(Screen::hdmi()));
            assert_eq!(shown(&mut board).is_some(), shows, "{low:?}");
        }
        // Off and on again: without the override everything is to be written anew.
        let mut board = Kc705::new(Delays::NONE, low);
        board.set_reset(true);
        board.attach(Some(Screen::hdmi()));
        run(&mut board, &without_override(&first));
        assert!(shown(&mut board).is_some());
        board.switch_screen(false);
        board.switch_screen(true);
        assert_eq!(board.transmitter().state(), State::PoweredDown);
        assert_eq!(board.transmitter().register(0x98), 0x03, "97 to AF stay");
        run(&mut board, &without_override(&first));
        assert!(shown(&mut board).is_some());
    }
}

#[test]
fn hot_plug_its_interrupt_and_the_screens_edid_are_read() {
    let mut kc705 = board_with(Screen::hdmi(), &board(YCC));
    let read = |kc705: &mut Kc705, register| Master::new(kc705).read(0x39, &[register], 1).unwrap()[0];
    assert_eq!(read(&mut kc705, 0x42), 0xf0);
    assert_eq!(read(&mut kc705, 0x96) & 0x84, 0x84);
    run(&mut kc705, &[(0x39, vec![0x96, 0x80])]);
    assert_eq!(read(&mut kc705, 0x96) & 0x80, 0);
    assert_eq!(Master::new(&mut kc705).read(0x3f, &[0], 2).unwrap(), [0, 0xff]);
    kc705.switch_screen(false);
    assert_eq!((read(&mut kc705, 0x42) & 0x40, read(&mut kc705, 0x96) & 0x80), (0, 0x80));
    assert_eq!(kc705.transmitter().state(), State::Runs, "the override holds");
    kc705.attach(None);
    assert_eq!(read(&mut kc705, 0x42), 0x90);
}

#[test]
fn fixed_registers_with_other_values_are_complaints() {
    let mut kc705 = board_with(Screen::hdmi(), &board(YCC));
    assert_eq!(kc705.transmitter().complaints(), [""; 0]);
    run(&mut kc705, &[(0x39, vec![0x9c, 0x31])]);
    assert_eq!(
        kc705.transmitter().complaints(),
        ["ADV7511 9C = 31: reserved, to be 30", "ADV7511 9C is 31, to be 30"]
    );
    let bare = board_with(Screen::hdmi(), &[(0x74, vec![32])]);
    assert_eq!(bare.transmitter().complaints().len(), 8);
}

#[test]
fn coefficients_change_when_the_guard_is_cleared() {
    let mut kc705 = board_with(Screen::hdmi(), &board(RGB));
    run(&mut kc705, &[(0x39, vec![0x1a, 0x24]), (0x39, vec![0x18, 0x46])]);
    assert!(worst(&shown(&mut kc705).unwrap()) <= 2);
    run(&mut kc705, &[(0x39, vec![0x1a, 0x04])]);
    assert!(worst(&shown(&mut kc705).unwrap()) > 50);
}
