//! The set-up tables that the project had first: each of their faults is fixed in turn, and the next one shows.

use crate::first_tables::{FIRST_IMAGEON, FIRST_KC705};
use crate::setup::{SMALL, Write, board_with, card_with, edid, hot_plug, picture, ramp, release, run, send};
use edof_board::chip_models::adv7611::State;
use edof_board::chip_models::hdmi::Coding;
use edof_board::chip_models::master::Error;
use edof_board::chip_models::source::State as Playing;
use edof_board::chip_models::{Delays, Imageon, Kc705, LowHotPlug, Master, Screen};

fn writes(table: &[(u8, u8, u8)]) -> Vec<Write> {
    table.iter().map(|(device, register, value)| (*device, vec![*register, *value])).collect()
}

/// A table with one register's value fixed.
fn mended(table: &[(u8, u8, u8)], device: u8, register: u8, value: u8) -> Vec<Write> {
    let wrong = |write: &&mut Write| write.0 == device && write.1[0] == register;
    let mut writes = writes(table);
    writes.iter_mut().filter(wrong).for_each(|write| write.1[1] = value);
    writes
}

fn first_refusal(writes: &[Write]) -> Option<(usize, Error)> {
    let mut card = Imageon::new(Delays::NONE);
    card.set_reset(true);
    let mut master = Master::new(&mut card);
    let mut results = writes.iter().map(|(device, bytes)| master.write(*device, bytes)).enumerate();
    results.find_map(|(entry, result)| Some((entry, result.err()?)))
}

const RECEIVER_IS_DEAF: Error = Error::Refused { device: 0x4c, byte: 0 };

#[test]
fn one_the_multiplexer_is_not_selected() {
    assert_eq!(first_refusal(&writes(FIRST_IMAGEON)), Some((0, RECEIVER_IS_DEAF)));
}

#[test]
fn two_the_chip_is_held_in_reset() {
    let selected = [vec![(0x70, vec![4])], writes(FIRST_IMAGEON)].concat();
    assert_eq!(first_refusal(&selected), Some((1, RECEIVER_IS_DEAF)));
    let released = [release(), writes(FIRST_IMAGEON)].concat();
    assert_eq!(first_refusal(&released), None);
}

/// The table with the receiver released, and with hot plug by the pin that has it.
fn plugged(table: Vec<Write>, edid: &[Write]) -> Vec<Write> {
    let (addresses, rest) = table.split_at(9);
    [&release(), addresses, edid, rest, &hot_plug()].concat()
}

#[test]
fn three_there_is_no_edid() {
    let released = [release(), writes(FIRST_IMAGEON)].concat();
    assert_eq!(
        card_with(&released, |_| ()).source().unwrap().state(),
        Playing::NoHotPlug,
        "IO 20 drives nothing"
    );
    let card = card_with(&plugged(writes(FIRST_IMAGEON), &[]), |_| ());
    assert_eq!((card.source().unwrap().state(), card.receiver().state()), (Playing::NoEdid, State::NoSignal));
}

/// Luma and chroma that reach the pins.
fn received(table: Vec<Write>) -> Vec<[u8; 2]> {
    let mut card = card_with(&plugged(table, &edid()), |_| ());
    let words = picture(&mut card);
    assert_eq!(card.receiver().state(), State::Runs);
    words.into_iter().map(u16::to_be_bytes).collect()
}

fn clamped(min: u8, max: [u8; 2]) -> Vec<[u8; 2]> {
    ramp().into_iter().map(|pixel| [0, 1].map(|i| pixel[i].clamp(min, max[i]))).collect()
}

#[test]
fn four_values_are_clipped() {
    assert_eq!(received(writes(FIRST_IMAGEON)), clamped(16, [235, 240]));
}

#[test]
fn five_00_and_ff_do_not_pass() {
    let passed = received(mended(FIRST_IMAGEON, 0x4c, 0x02, 0xf5));
    assert_eq!(passed, clamped(1, [254, 254]));
    let sent = ramp();
    let mut lost = passed.iter().flatten().zip(sent.iter().flatten()).filter(|(a, b)| a != b).peekable();
    assert!(lost.peek().is_some() && lost.all(|(_, sent)| matches!(sent, 0 | 255)));
}

#[test]
fn the_settings_are_those_of_another_chip() {
    let card = card_with(&plugged(writes(FIRST_IMAGEON), &edid()), |_| ());
    let complaints = card.receiver().complaints();
    for told in
        ["HDMI C0 = 03: no register", "HDMI 57 = A3: reserved, to be DA", "Hdmi 87 is 00, recommended is 70"]
    {
        assert!(complaints.iter().any(|complaint| complaint.contains(told)), "{told}: {complaints:?}");
    }
}

fn transmitter(table: Vec<Write>) -> Vec<Write> {
    [vec![(0x74, vec![1 << 5])], table].concat()
}

/// Words {chroma, luma} as the FPGA puts them on the pins.
fn words() -> Vec<u16> {
    (0..128).map(|i| (100 + i) << 8 | (20 + i)).collect()
}

/// Luma and chroma that the screen shows of the words.
fn shown(board: &mut Kc705) -> Option<Vec<u16>> {
    send(board, &words(), 3);
    let shown = board.screen().unwrap().shown.last()?;
    assert_eq!((shown.coding, shown.width), (Coding::Ycc422, SMALL.line.active));
    Some(shown.pixels.iter().map(|pixel| u16::from(pixel[2]) << 8 | u16::from(pixel[1])).collect())
}

#[test]
fn six_bytes_are_exchanged_at_the_transmitter() {
    let mut board = board_with(Screen::hdmi(), &transmitter(writes(FIRST_KC705)));
    let exchanged: Vec<u16> = words().into_iter().map(u16::swap_bytes).collect();
    assert_eq!(shown(&mut board), Some(exchanged));
    let mut board = board_with(Screen::hdmi(), &transmitter(mended(FIRST_KC705, 0x39, 0x16, 0xb9)));
    assert_eq!(shown(&mut board), Some(words()));
}

#[test]
fn seven_the_hot_plug_override_comes_last() {
    let table = mended(FIRST_KC705, 0x39, 0x16, 0xb9);
    let (last, others) = table.split_last().unwrap();
    assert_eq!(last.1, [0xd6, 0xc0]);
    let first = [std::slice::from_ref(last), others].concat();
    for low in [LowHotPlug::HoldsDefaults, LowHotPlug::ResetsOnce] {
        for (table, shows) in [(table.clone(), false), (first.clone(), true)] {
            // The screen is switched on after the set-up.
            let mut board = Kc705::new(Delays::NONE, low);
            board.set_reset(true);
            run(&mut board, &transmitter(table));
            board.attach(Some(Screen::hdmi()));
            assert_eq!(shown(&mut board).is_some(), shows, "{low:?}");
        }
    }
}
