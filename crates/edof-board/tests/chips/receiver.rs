//! The receiver: from a source's cable to words at the FPGA's pins.

use crate::setup::{
    SMALL, Write, addresses, card, card_with, edid, frame, hot_plug, picture, ramp, release, run, video,
};
use edof_board::chip_models::adv7611::State;
use edof_board::chip_models::hdmi::Coding;
use edof_board::chip_models::source::{Source, State as Playing};
use edof_board::chip_models::{Eye, Imageon, Master};

/// The whole set-up with one register written besides, after everything else.
fn with(device: u8, register: u8, value: u8) -> Vec<Write> {
    [card(), vec![(device, vec![register, value])]].concat()
}

/// What leaves for the ramp, as luma and chroma.
fn bytes(writes: &[Write], change: impl FnOnce(&mut Source)) -> Vec<[u8; 2]> {
    let words = picture(&mut card_with(writes, change));
    words.into_iter().map(u16::to_be_bytes).collect()
}

fn clamped(min: u8, max: [u8; 2]) -> Vec<[u8; 2]> {
    ramp().into_iter().map(|pixel| [0, 1].map(|i| pixel[i].clamp(min, max[i]))).collect()
}

#[test]
fn every_byte_but_00_and_ff_passes_with_f5() {
    assert_eq!(bytes(&card(), |_| ()), clamped(1, [254, 254]));
    assert_ne!(bytes(&card(), |_| ()), ramp(), "words of 16 bits do not survive");
}

#[test]
fn f4_clips_to_nominal_range() {
    assert_eq!(bytes(&with(0x4c, 0x02, 0xf4), |_| ()), clamped(16, [235, 240]));
}

#[test]
fn two_halves_of_seven_bits_around_the_middle_pass_whatever_clamps() {
    let halves: Vec<[u8; 2]> = (0..128).map(|i| [64 + i, 191 - i]).collect();
    for setting in [0xf4, 0xf5, 0x35] {
        let mut card = card_with(&with(0x4c, 0x02, setting), |_| ());
        card.plug(Some(Source::new(SMALL, vec![halves.clone()])));
        let words: Vec<[u8; 2]> = picture(&mut card).into_iter().map(u16::to_be_bytes).collect();
        assert_eq!(words, halves, "IO 02 = {setting:02X}");
    }
}

#[test]
fn a_source_that_declares_full_range_is_scaled_unless_the_range_is_forced() {
    let full = |source: &mut Source| source.declares_full = true;
    assert_ne!(bytes(&card(), full), clamped(1, [254, 254]));
    assert_eq!(bytes(&with(0x4c, 0x02, 0x35), full), clamped(1, [254, 254]));
    // Full range out.
    assert_ne!(bytes(&with(0x4c, 0x02, 0xf1), |_| ()), clamped(1, [254, 254]));
}

#[test]
fn an_rgb_source_leaves_nothing_of_raw_bytes() {
    let rgb = bytes(&card(), |source| source.coding = Some(Coding::Rgb));
    let differ = rgb.iter().zip(ramp()).filter(|(a, b)| **a != *b).count();
    assert!(differ > 100, "{differ} of 128");
    // But 4:4:4 in YCbCr can be filtered or not.
    let unfiltered = with(0x4c, 0xe0, 0x80);
    let ycc = |writes: &[Write]| bytes(writes, |source| source.coding = Some(Coding::Ycc444));
    assert_eq!(ycc(&unfiltered), clamped(1, [254, 254]));
    assert_ne!(ycc(&card()), clamped(1, [254, 254]));
}

#[test]
fn settings_that_touch_samples_are_seen() {
    for (device, register, value, what) in [
        (0x4c, 0xe0, 0x80, "filter of 4:2:2 input"),
        (0x34, 0x1d, 0x20, "interpolated chroma"),
        (0x22, 0x3e, 0x80, "adjustment"),
        (0x4c, 0x05, 0x2d, "Cb and Cr swapped"),
        (0x4c, 0x03, 0x00, "another format"),
        (0x22, 0xbf, 0x13, "its own picture"),
    ] {
        assert_ne!(bytes(&with(device, register, value), |_| ()), clamped(1, [254, 254]), "{what}");
    }
}

#[test]
fn pins_are_chosen_by_the_output_channel() {
    let luma_low: Vec<[u8; 2]> = clamped(1, [254, 254]).into_iter().map(|[y, c]| [c, y]).collect();
    assert_eq!(bytes(&with(0x4c, 0x04, 0xa2), |_| ()), luma_low);
    assert!(bytes(&with(0x4c, 0x04, 0x02), |_| ()).iter().all(|[_, low]| *low == 0), "P7..P0 carry nothing");
}

#[test]
fn codes_stand_around_lines_and_carry_blanking_and_protection() {
    let lines = frame(&mut card_with(&card(), |_| ()));
    let (width, total) = (SMALL.line.active, SMALL.line.total());
    let code = |xy: u16| vec![0xffff, 0, 0, xy << 8 | xy];
    for (row, line) in lines.iter().enumerate() {
        let next_is_seen = (row + 1) % lines.len() < SMALL.frame.active;
        let (eav, sav) = if next_is_seen { (0x9d, 0x80) } else { (0xb6, 0xab) };
        assert_eq!(line[width..width + 4], code(eav), "row {row}");
        assert_eq!(line[total - 4..], code(sav), "row {row}");
        assert!(line[width + 4..total - 4].iter().all(|word| *word == 0x1080));
    }
    let none = frame(&mut card_with(&with(0x4c, 0x05, 0x28), |_| ()));
    assert!(none.iter().flatten().all(|word| *word != 0xffff));
    let spread = frame(&mut card_with(&with(0x4c, 0x05, 0x2e), |_| ()));
    assert_eq!(spread[0][total - 2..], [0x00ff, 0x8000]);
}

#[test]
fn a_source_without_an_edid_stays_dark() {
    let mut card = card_with(&[release(), addresses(), video(), hot_plug()].concat(), |_| ());
    assert_eq!(card.source().unwrap().state(), Playing::NoEdid);
    assert_eq!(card.receiver().state(), State::NoSignal);
    // An EDID that comes after hot plug comes too late; one more hot plug and it is read.
    run(&mut card, &edid());
    card.clock_runs();
    assert_eq!(card.source().unwrap().state(), Playing::NoEdid);
    run(&mut card, &[(0x70, vec![8]), (0x20, vec![1, 1])]);
    card.clock_runs();
    run(&mut card, &hot_plug());
    card.clock_runs();
    assert_eq!(card.source().unwrap().state(), Playing::Sends(Coding::Ycc422));
    assert_eq!(picture(&mut card).len(), 128);
}

#[test]
fn the_cables_hot_plug_is_the_expanders_and_not_the_chips_own() {
    let mut card = card_with(
        &[release(), addresses(), edid(), video(), vec![(0x4c, vec![0x20, 0xf8])]].concat(),
        |_| (),
    );
    assert_eq!(card.source().unwrap().state(), Playing::NoHotPlug);
    run(&mut card, &hot_plug());
    card.clock_runs();
    assert!(card.source().unwrap().sends());
}

#[test]
fn the_edids_checksums_are_the_chips_own_and_writes_to_an_edid_in_use_are_reported() {
    let mut card = card_with(&card(), |_| ());
    let read = Master::new(&mut card).read(0x36, &[0], 256).unwrap();
    assert_eq!(
        read.chunks(128).map(|block| block.iter().fold(0, |a: u8, b| a.wrapping_add(*b))).max(),
        Some(0)
    );
    assert_eq!(Master::new(&mut card).read(0x32, &[0x76], 1).unwrap(), [1]);
    assert_eq!(card.receiver().complaints(), [""; 0]);
    run(&mut card, &[(0x36, vec![9, 9])]);
    assert!(card.receiver().complaints()[0].contains("EDID written"));
}

#[test]
fn what_stops_a_picture_is_named() {
    let states = [
        (vec![(0x70, vec![8]), (0x20, vec![1, 4])], State::InReset),
        (vec![(0x4c, vec![0x0c, 0x62])], State::PoweredDown),
        (vec![(0x4c, vec![0x01, 0x02])], State::OtherInput),
        (vec![(0x4c, vec![0x15, 0xbe])], State::PinsOff),
        (vec![(0x34, vec![0x83, 0xff])], State::NoTermination),
        (vec![(0x22, vec![0xbf, 0x13])], State::FreeRun),
        (vec![(0x70, vec![8]), (0x20, vec![1, 1])], State::NoSignal),
        (vec![], State::Runs),
    ];
    for (writes, state) in states {
        let mut card = card_with(&[card(), writes].concat(), |_| ());
        (0..2_000).for_each(|_| _ = card.pixel());
        assert_eq!(card.receiver().state(), state);
    }
    let mut pulled = card_with(&card(), |_| ());
    pulled.plug(None);
    assert_eq!(pulled.receiver().state(), State::NoCable);
}

#[test]
fn without_a_signal_the_clock_continues_by_free_run_alone() {
    let mut card = card_with(&card(), |_| ());
    picture(&mut card);
    card.plug(None);
    assert!(card.clock_runs());
    assert!(picture(&mut card).iter().all(|word| word >> 8 == 0x23), "its own colour");
    run(&mut card, &[(0x22, vec![0xba, 0])]);
    assert!(!card.clock_runs() && card.pixel().is_none());
    card.plug(Some(Source::new(SMALL, vec![ramp()])));
    assert!(card.clock_runs());
}

fn status(card: &mut Imageon, device: u8, register: u8) -> u8 {
    Master::new(card).read(device, &[register], 1).unwrap()[0]
}

#[test]
fn status_registers_tell_cable_lock_size_and_colour() {
    let mut card = card_with(&card(), |_| ());
    picture(&mut card);
    assert_eq!(status(&mut card, 0x4c, 0x6f) & 1, 1);
    assert_eq!(status(&mut card, 0x4c, 0x6a), 0x53);
    assert_eq!(status(&mut card, 0x4c, 0x12) & 1, 0);
    assert_eq!([0x07, 0x08, 0x09, 0x0a].map(|register| status(&mut card, 0x34, register)), [0xa0, 16, 0, 8]);
    assert_eq!(status(&mut card, 0x34, 0x05) >> 7, 1);
    assert_eq!([0x51, 0x52].map(|register| status(&mut card, 0x34, register)), [148 / 2, 64]);
    assert_eq!(
        [(0x22, 0xb1), (0x22, 0xff)].map(|(map, register)| status(&mut card, map, register)),
        [0x80, 0]
    );
    card.plug(None);
    assert_eq!([0x6f, 0x6a, 0x12].map(|register| status(&mut card, 0x4c, register)), [0, 0, 1]);
    assert_eq!(status(&mut card, 0x34, 0x08), 0);
}

#[test]
fn settings_of_another_chip_and_values_of_reserved_registers_are_complaints() {
    let mut card = card_with(&card(), |_| ());
    assert_eq!(card.receiver().complaints(), [""; 0]);
    for (register, value) in [(0xc0, 0x03), (0x3d, 0x10), (0x57, 0xa3), (0x85, 0x10), (0x86, 0x9b), (0x07, 1)]
    {
        let before = card.receiver().complaints().len();
        run(&mut card, &[(0x34, vec![register, value])]);
        assert!(card.receiver().complaints().len() > before, "HDMI {register:02X} = {value:02X}");
    }
    let unset = card_with(&[release(), addresses(), edid(), hot_plug()].concat(), |_| ());
    assert!(unset.receiver().complaints().iter().any(|complaint| complaint.contains("recommended is 70")));
}

/// Words of the picture that differ from the right ones, with this polarity and tap.
fn errors(card: &mut Imageon, inverted: bool, tap: u8) -> usize {
    run(&mut *card, &[(0x4c, vec![0x06, 0xa6 | u8::from(inverted)]), (0x4c, vec![0x19, 0x80 | tap])]);
    let right = clamped(1, [254, 254]);
    picture(card).into_iter().map(u16::to_be_bytes).zip(right).filter(|(a, b)| a != b).count()
}

#[test]
fn words_are_right_inside_of_the_window_and_codes_broken_outside() {
    let mut card = card_with(&card(), |_| ());
    let eye = Eye::drawn(3);
    card.set_eye(eye.clone());
    for (inverted, tap) in (0..32).flat_map(|tap| [(false, tap), (true, tap)]) {
        let found = errors(&mut card, inverted, tap);
        assert_eq!(
            found == 0,
            eye.is_open(inverted, tap.into()),
            "{inverted} {tap}: {found} words are wrong"
        );
    }
    // With the delay line off there is one tap.
    run(&mut card, &[(0x4c, vec![0x33, 0])]);
    assert_eq!(card.receiver().clock_phase().1, 0);
}
