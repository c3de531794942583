//! The bus: switches, resets, and what goes wrong on wires.

use crate::setup::{addresses, release, run};
use edof_board::chip_models::master::Error;
use edof_board::chip_models::{Delays, Hold, Imageon, Kc705, LowHotPlug, Master, Pulls, Wires};

fn card() -> Imageon {
    let mut card = Imageon::new(Delays::NONE);
    card.set_reset(true);
    card
}

fn refused(device: u8) -> Error {
    Error::Refused { device, byte: 0 }
}

#[test]
fn chips_answer_behind_the_channel_that_is_open_and_nowhere_else() {
    let mut board = Kc705::new(Delays::NONE, LowHotPlug::HoldsDefaults);
    board.set_reset(true);
    let there = [&[0x5d][..], &[], &[0x50], &[0x54], &[], &[0x39], &[0x50, 0x18], &[0x68]];
    let mut master = Master::new(&mut board);
    let all = [0x5d, 0x50, 0x54, 0x39, 0x18, 0x68, 0x70, 0x4c];
    for (channel, answer) in there.into_iter().enumerate() {
        master.write(0x74, &[1 << channel]).unwrap();
        assert_eq!(master.read(0x74, &[], 1).unwrap(), [1 << channel]);
        let found: Vec<u8> = all.into_iter().filter(|device| master.read(*device, &[0], 1).is_ok()).collect();
        let mut expected = answer.to_vec();
        expected.sort_by_key(|device| all.iter().position(|d| d == device));
        assert_eq!(found, expected, "channel {channel}");
    }
    master.write(0x74, &[1 << 3 | 1 << 5]).unwrap();
    assert!(master.read(0x39, &[0], 1).is_ok() && master.read(0x54, &[0], 1).is_ok());
}

#[test]
fn the_cards_channels_hold_what_avnet_says() {
    let mut card = card();
    let mut master = Master::new(&mut card);
    let all = [0x50, 0x39, 0x4c, 0x20, 0x65];
    for (channel, expected) in [&[0x50][..], &[0x39], &[], &[0x20, 0x65]].into_iter().enumerate() {
        master.write(0x70, &[1 << channel]).unwrap();
        let found: Vec<u8> = all.into_iter().filter(|device| master.read(*device, &[0], 1).is_ok()).collect();
        assert_eq!(found, expected, "channel {channel}: the receiver is still in reset");
    }
    // Four channels: bits above are not there.
    master.write(0x70, &[0xf0]).unwrap();
    assert_eq!(master.read(0x70, &[], 1).unwrap(), [0]);
}

#[test]
fn a_channel_opens_after_the_stop() {
    let mut card = card();
    // A read after a repeated start: no stop came since the write.
    let mut master = Master::new(&mut card);
    master.write(0x70, &[8]).unwrap();
    assert_eq!(master.read(0x70, &[0], 1).unwrap(), [0]);
    assert_eq!(master.read(0x20, &[3], 1), Err(refused(0x20)), "it is closed by the stop");
}

#[test]
fn a_switch_in_reset_is_deaf_and_forgets_its_channels() {
    let mut card = card();
    Master::new(&mut card).write(0x70, &[8]).unwrap();
    card.set_reset(false);
    assert_eq!(Master::new(&mut card).write(0x70, &[8]), Err(refused(0x70)));
    card.set_reset(true);
    assert_eq!(Master::new(&mut card).read(0x20, &[3], 1), Err(refused(0x20)));
}

#[test]
fn the_expander_drives_what_is_configured_as_output() {
    let mut card = card();
    run(&mut card, &[(0x70, vec![8])]);
    assert_eq!(card.expander().drives(0), None, "inputs after power-up");
    run(&mut card, &[(0x20, vec![3, 0xea]), (0x20, vec![1, 5])]);
    assert_eq!(
        [0, 1, 2, 4].map(|pin| card.expander().drives(pin)),
        [Some(true), None, Some(true), Some(false)]
    );
    let mut master = Master::new(&mut card);
    assert_eq!(master.read(0x20, &[0], 1).unwrap(), [5]);
    // The command stays.
    assert_eq!(master.read(0x20, &[3], 3).unwrap(), [0xea; 3]);
}

#[test]
fn the_receiver_answers_out_of_reset_and_each_map_once_it_has_an_address() {
    let mut card = card();
    run(&mut card, &release());
    let maps = [0x40, 0x3e, 0x26, 0x32, 0x36, 0x34, 0x22];
    let answer = |card: &mut Imageon| maps.map(|map| Master::new(&mut *card).read(map, &[0], 1).is_ok());
    assert_eq!(answer(&mut card), [false; 7]);
    run(&mut card, &addresses());
    assert_eq!(answer(&mut card), [true; 7]);
    // Reset of the chip, by the pin and by the register.
    for reset in [
        &[(0x70, vec![8]), (0x20, vec![1, 0]), (0x20, vec![1, 1]), (0x70, vec![4])][..],
        &[(0x4c, vec![0xff, 0x80])],
    ] {
        run(&mut card, &addresses());
        run(&mut card, reset);
        assert_eq!(answer(&mut card), [false; 7]);
    }
    run(&mut card, &[(0x70, vec![8]), (0x20, vec![1, 0]), (0x70, vec![4])]);
    assert_eq!(Master::new(&mut card).read(0x4c, &[0], 1), Err(refused(0x4c)));
}

#[test]
fn chips_are_deaf_for_a_while_after_power_up_and_reset() {
    let delays = Delays { adv7511: 3_000, adv7611: 2_000, edid_clear: 20_000 };
    let mut card = Imageon::new(delays);
    card.set_reset(true);
    run(&mut card, &release());
    assert_eq!(Master::new(&mut card).read(0x4c, &[0], 1), Err(refused(0x4c)));
    (0..2_000).for_each(|_| _ = card.step(Pulls::default()));
    let wait = |card: &mut Imageon| (0..20_000).for_each(|_| _ = card.step(Pulls::default()));
    run(&mut card, &addresses());
    // What is written to the EDID's memory before it is cleared is lost.
    run(&mut card, &[(0x36, vec![7, 77])]);
    wait(&mut card);
    assert_eq!(Master::new(&mut card).read(0x36, &[7], 1).unwrap(), [0]);
    let mut board = Kc705::new(delays, LowHotPlug::HoldsDefaults);
    board.set_reset(true);
    run(&mut board, &[(0x74, vec![32])]);
    assert_eq!(Master::new(&mut board).read(0x39, &[0], 1), Err(refused(0x39)));
}

#[test]
fn reads_and_writes_move_on_to_the_next_register() {
    let mut card = card();
    run(&mut card, &release());
    let mut master = Master::new(&mut card);
    master.write(0x4c, &[0xf4, 0x80, 0x7c]).unwrap();
    assert_eq!(master.read(0x4c, &[0xf4], 2).unwrap(), [0x80, 0x7c]);
    // The pointer stays over a stop.
    master.write(0x4c, &[0xea]).unwrap();
    assert_eq!(master.read(0x4c, &[], 2).unwrap(), [0x20, 0x51]);
}

#[test]
fn a_data_line_that_is_stuck_is_freed_by_nine_clocks_or_not_at_all() {
    let mut card = card();
    card.faults().hold_sda(Hold::Clocks(7));
    let mut master = Master::new(&mut card);
    assert_eq!(master.write(0x70, &[8]), Err(Error::SdaLow));
    assert!(master.free());
    master.write(0x70, &[8]).unwrap();
    card.faults().hold_sda(Hold::Forever);
    assert!(!Master::new(&mut card).free());
    card.faults().free_sda();
    Master::new(&mut card).write(0x70, &[8]).unwrap();
}

#[test]
fn a_read_that_is_cut_off_holds_the_data_line_until_it_gets_its_clocks() {
    let mut card = card();
    let low = |scl_low, sda_low| Pulls { scl_low, sda_low };
    // A start, the switch's address for a read, its acknowledge; then the master forgets the transfer.
    let mut step = |pulls| (0..4).map(|_| card.step(pulls)).last().unwrap();
    step(low(false, true));
    for place in (0..8).rev() {
        let sda_low = 0x70 << 1 >> place & 1 == 0 && place != 0;
        for scl_low in [true, false] {
            step(low(scl_low, sda_low));
        }
    }
    for _ in 0..2 {
        step(low(true, false));
        step(low(false, false));
    }
    assert!(!step(low(false, false)).sda, "the first bit of 0 is on the line");
    let mut master = Master::new(&mut card);
    assert_eq!(master.write(0x70, &[8]), Err(Error::SdaLow));
    assert!(master.free());
    master.write(0x70, &[8]).unwrap();
}

#[test]
fn clocks_are_stretched_as_long_as_the_master_waits() {
    let mut card = card();
    card.faults().stretch(50);
    Master::new(&mut card).write(0x70, &[8]).unwrap();
    assert_eq!(Master::new(&mut card).read(0x20, &[3], 1).unwrap(), [0xff]);
    card.faults().stretch(u32::MAX);
    assert_eq!(Master::new(&mut card).write(0x70, &[8]), Err(Error::SclLow));
}

#[test]
fn chips_that_are_missing_or_reject_are_reported() {
    let mut card = card();
    card.faults().remove(0x70);
    assert_eq!(Master::new(&mut card).write(0x70, &[8]), Err(refused(0x70)));
    card.faults().restore(0x70);
    card.faults().refuse(2);
    let tries = [0; 3].map(|_| Master::new(&mut card).write(0x70, &[8]).is_ok());
    assert_eq!(tries, [false, false, true]);
}

#[test]
fn another_master_wins_a_bit_that_was_left_high() {
    let mut card = card();
    // 0x70 with a write: bits 1110 0000.
    card.faults().steal(2);
    assert_eq!(Master::new(&mut card).write(0x70, &[8]), Err(Error::Arbitration { device: 0x70 }));
    Master::new(&mut card).write(0x70, &[8]).unwrap();
}
