//! The set-ups of both buses on chips that know nothing of them (`edof_board::chip_models`), from a source's cable to the pins and from the pins to a screen;
//! and the same set-ups with one fault each, which the chips must show.

#[path = "first_light/grey.rs"]
mod grey;
mod player;

use edof_board::chip_models::adv7511::State as Sending;
use edof_board::chip_models::adv7611::State;
use edof_board::chip_models::edid::EdidError;
use edof_board::chip_models::hdmi::{Coding, Pixel, rgb_of};
use edof_board::chip_models::source::{Picture, Source, State as Playing};
use edof_board::chip_models::{LowHotPlug, Screen, Timing};
use edof_device::i2c::{Action, SLOTS, programs};
use edof_device::video::VideoTiming;
use player::{Board, Card, Player, SMALL, words};

/// Two halves of seven bits around the middle, as raw words cross a cable: every one of them somewhere.
fn halves() -> Picture {
    (0..128).map(|i| [64 + i, 191 - i]).collect()
}

/// Every byte, as raw words of two whole bytes would have them.
fn bytes() -> Picture {
    (0..128).map(|i| [2 * i, 255 - 2 * i]).collect()
}

fn source(picture: Picture) -> Option<Source> {
    Some(Source::new(SMALL, vec![picture]))
}

/// The program of the card's bus, changed.
fn card_program(change: impl Fn(&mut Vec<Action>)) -> Vec<Action> {
    let [_, card] = programs(VideoTiming::P1080_60);
    changed(card.iter().map(|entry| entry.action).collect(), change)
}

/// The program of the board's bus, changed.
fn board_program(change: impl Fn(&mut Vec<Action>)) -> Vec<Action> {
    let [board, _] = programs(VideoTiming::P1080_60);
    changed(board.iter().map(|entry| entry.action).collect(), change)
}

fn changed(mut program: Vec<Action>, change: impl Fn(&mut Vec<Action>)) -> Vec<Action> {
    let before = program.clone();
    change(&mut program);
    assert_eq!(program.len(), before.len(), "jumps would lead elsewhere");
    program
}

/// Nothing is done in place of each such step.
fn leave_out(program: &mut [Action], what: impl Fn(Action) -> bool) {
    let found =
        program.iter_mut().filter(|action| what(**action)).map(|action| *action = Action::Index(0)).count();
    assert!(found > 0, "there is no such step");
}

/// The set-up no longer reads back what it wrote, so that a fault is seen by what comes of it.
fn unchecked(program: &mut [Action]) {
    for i in 1..program.len() {
        if let (Action::Read { slot: SLOTS.., .. }, Action::Until { .. }) = (program[i - 1], program[i]) {
            (program[i - 1], program[i]) = (Action::Index(0), Action::Index(0));
        }
    }
}

/// Every write of a register has another value.
fn set(program: &mut [Action], at: (u8, u8), to: u8) {
    let mut found = 0;
    for action in program {
        if let Action::Write { device, register, value } = action
            && (*device, *register) == at
        {
            (*value, found) = (to, found + 1);
        }
    }
    assert!(found > 0, "{at:02x?} is not written");
}

/// The card with a source, set up and locked as far as it gets.
fn card(program: Vec<Action>, picture: Picture) -> Player<Card> {
    let mut player = Player::new(Card::new(), program);
    player.wires.card.plug(source(picture));
    player.play(30);
    player
}

#[test]
fn raw_words_reach_the_pins() {
    let mut player = card(card_program(|_| ()), halves());
    assert!(player.is_done, "{:?}", player.failure);
    assert_eq!(player.wires.card.source().unwrap().state(), Playing::Sends(Coding::Ycc422));
    assert_eq!(player.wires.card.receiver().state(), State::Runs);
    assert_eq!(player.wires.picture(), halves());
    assert_eq!(player.wires.card.receiver().complaints(), [""; 0]);
    // Cable, clock and both locks; 16 columns, 8 rows.
    assert_eq!(player.slots[..2], [0x53, 0x01]);
    assert_eq!([player.slots[4], player.slots[6]], [16, 8]);
}

/// Without a source the receiver has the clock of the design's mode, and a source gets the mode that it asks the EDID for, no other.
#[test]
fn every_mode_has_its_own_free_run_and_edid() {
    let modes = [
        (VideoTiming::P720_60, Timing::P720_60),
        (VideoTiming::P1080_60, Timing::P1080_60),
        (VideoTiming::P1080_30, Timing::P1080_30),
    ];
    assert_eq!(modes.map(|(mode, _)| mode), VideoTiming::MODES);
    for (mode, timing) in modes {
        let [_, program] = programs(mode);
        let program: Vec<Action> = program.iter().map(|entry| entry.action).collect();
        let mut player = Player::new(Card::new(), program);
        player.play(30);
        assert!(player.is_done, "{:?}", player.failure);
        assert_eq!(player.wires.card.receiver().free_run(), Some(timing));
        assert_eq!(player.wires.card.clock_khz(), timing.khz);
        for asked in modes.map(|(_, asked)| asked) {
            let mut source = source(halves()).unwrap();
            source.mode = asked;
            player.wires.card.plug(Some(source));
            player.play(10);
            let expected = if asked == timing { Playing::Sends(Coding::Ycc422) } else { Playing::NoMode };
            assert_eq!(player.wires.card.source().unwrap().state(), expected, "{asked:?}");
        }
    }
}

#[test]
fn words_of_two_whole_bytes_do_not_survive() {
    let passed = card(card_program(|_| ()), bytes()).wires.picture();
    let sent = bytes();
    let lost: Vec<u8> =
        passed.iter().flatten().zip(sent.iter().flatten()).filter(|(a, b)| a != b).map(|(_, b)| *b).collect();
    assert!(
        lost.contains(&0) && lost.contains(&255) && lost.iter().all(|byte| matches!(byte, 0 | 255)),
        "{lost:?}"
    );
}

#[test]
fn a_cable_may_come_before_the_set_up_or_after_and_go_and_come() {
    let mut player = Player::new(Card::new(), card_program(|_| ()));
    player.play(30);
    assert!(player.is_done, "{:?}", player.failure);
    assert_eq!((player.wires.card.receiver().state(), player.slots[1] & 1), (State::NoCable, 0));
    for _ in 0..2 {
        player.wires.card.plug(source(halves()));
        player.play(10);
        assert_eq!((player.wires.card.receiver().state(), player.slots[1] & 1), (State::Runs, 1));
        assert_eq!(player.wires.picture(), halves());
        player.wires.card.plug(None);
        player.play(10);
        assert_eq!(
            (player.wires.card.receiver().state(), player.slots[..2].to_vec()),
            (State::NoCable, vec![0, 0])
        );
    }
}

#[test]
fn a_source_of_full_range_or_rgb_is_reported_by_the_status() {
    let mut player = Player::new(Card::new(), card_program(|_| ()));
    let mut rgb = source(halves()).unwrap();
    rgb.coding = Some(Coding::Rgb);
    player.wires.card.plug(Some(rgb));
    player.play(30);
    assert_ne!(player.wires.picture(), halves());
    assert_eq!(player.slots[8] & 15, 0, "RGB");
    player.wires.card.plug(source(halves()));
    player.play(10);
    assert_eq!(player.slots[8] & 15, 3, "YCbCr 709");
}

#[test]
fn a_receiver_that_is_held_in_reset_is_named_and_found_when_it_is_let_go() {
    let mut player = Player::new(Card::new(), card_program(|_| ()));
    player.wires.card.short_reset(true);
    player.wires.card.plug(source(halves()));
    player.play(20);
    assert!(!player.is_done);
    assert_eq!(player.failure.map(|(device, _)| device), Some(0x4c));
    player.wires.card.short_reset(false);
    player.play(40);
    assert!(player.is_done, "{:?}", player.failure);
    assert_eq!(player.wires.picture(), halves());
}

#[test]
fn a_receiver_that_is_reset_later_is_set_up_again() {
    let mut player = card(card_program(|_| ()), halves());
    player.wires.card.short_reset(true);
    player.play(10);
    player.wires.card.short_reset(false);
    player.play(60);
    assert_eq!(player.wires.card.receiver().state(), State::Runs);
    assert_eq!(player.wires.picture(), halves());
}

#[test]
fn fault_one_the_multiplexer_is_not_selected() {
    let select = |action| matches!(action, Action::Byte { device: 0x70, .. });
    let player = card(card_program(|program| leave_out(program, select)), halves());
    assert!(!player.is_done && player.failure.is_some());
    assert_eq!(player.wires.card.receiver().state(), State::InReset);
}

#[test]
fn fault_two_the_chip_is_held_in_reset() {
    let release = |action| matches!(action, Action::Write { device: 0x20, .. });
    let fault = |program: &mut Vec<Action>| leave_out(program, release);
    assert!(
        card(card_program(fault), halves()).failure.is_some(),
        "the set-up sees that the expander has not kept it"
    );
    let player = card(card_program(|program| (unchecked(program), fault(program)).1), halves());
    assert_eq!((player.is_done, player.failure.map(|(device, _)| device)), (false, Some(0x4c)));
    assert_eq!(player.wires.card.receiver().state(), State::InReset);
}

#[test]
fn fault_three_there_is_no_edid() {
    let bytes = |action| matches!(action, Action::Write { device: 0x36, .. });
    let enable =
        |action| matches!(action, Action::Write { device: 0x32, register: 0x74, value } if value & 1 == 1);
    let faults: [(&dyn Fn(Action) -> bool, Playing); 2] =
        [(&bytes, Playing::BadEdid(EdidError::Header)), (&enable, Playing::NoEdid)];
    for (what, state) in faults {
        let fault = |program: &mut Vec<Action>| leave_out(program, what);
        assert!(
            card(card_program(fault), halves()).failure.is_some(),
            "the set-up sees that nothing was kept"
        );
        let player = card(card_program(|program| (unchecked(program), fault(program)).1), halves());
        assert_eq!(player.wires.card.source().unwrap().state(), state);
        assert_eq!(player.wires.card.receiver().state(), State::NoSignal);
    }
}

#[test]
fn fault_four_values_are_clipped() {
    let clipped =
        |picture| card(card_program(|program| set(program, (0x4c, 0x02), 0xf4)), picture).wires.picture();
    let expected: Picture = bytes().into_iter().map(|[y, c]| [y.clamp(16, 235), c.clamp(16, 240)]).collect();
    assert_eq!(clipped(bytes()), expected);
    assert_eq!(clipped(halves()), halves(), "raw words are out of its reach");
}

#[test]
fn fault_five_is_the_chips_own_and_no_setting_mends_it() {
    for value in [0xf0, 0xf1, 0xf4, 0xf5, 0x34, 0x35] {
        let passed = card(card_program(|program| set(program, (0x4c, 0x02), value)), bytes()).wires.picture();
        assert!(passed.iter().flatten().all(|byte| !matches!(byte, 0 | 255)), "IO 02 = {value:02X}");
    }
}

/// The board with a screen, set up.
fn board(program: Vec<Action>, screen: Screen, low: LowHotPlug) -> Player<Board> {
    let mut player = Player::new(Board::new(low), program);
    player.wires.board.attach(Some(screen));
    player.play(30);
    player
}

/// The colours that the words at the pins mean.
fn colours() -> Vec<Pixel> {
    let words = words();
    let pairs = words.chunks(2).flat_map(|pair| {
        let [cb, cr] = [pair[0], pair[1]].map(|word| (word >> 8) as u8);
        pair.iter().map(move |word| rgb_of(*word as u8, cb, cr)).collect::<Vec<_>>()
    });
    pairs.collect()
}

/// Worst difference of a colour on the screen; none without a picture.
fn worst(player: &mut Player<Board>) -> Option<u8> {
    let shown = player.wires.shown()?;
    let far = |(a, b): (Pixel, Pixel)| (0..3).map(|i| a[i].abs_diff(b[i])).max();
    shown.rgb().into_iter().zip(colours()).filter_map(far).max()
}

const LOW: [LowHotPlug; 2] = [LowHotPlug::HoldsDefaults, LowHotPlug::ResetsOnce];

#[test]
fn pictures_reach_any_screen_within_two_codes() {
    for low in LOW {
        for screen in [Screen::hdmi(), Screen::dvi()] {
            let mut player = board(board_program(|_| ()), screen, low);
            assert!(player.is_done, "{:?}", player.failure);
            assert_eq!(player.wires.board.transmitter().complaints(), [""; 0]);
            let worst = worst(&mut player);
            assert!(worst.is_some_and(|worst| worst <= 2), "{worst:?}");
        }
    }
}

#[test]
fn a_screen_may_come_late_be_off_and_on_and_be_pulled() {
    for low in LOW {
        let mut player = Player::new(Board::new(low), board_program(|_| ()));
        player.play(30);
        assert!(player.is_done, "{:?}", player.failure);
        player.wires.board.attach(Some(Screen::hdmi()));
        player.play(10);
        assert!(worst(&mut player).is_some_and(|worst| worst <= 2), "{low:?}: it came late");
        player.wires.board.switch_screen(false);
        player.play(10);
        player.wires.board.switch_screen(true);
        player.play(10);
        assert!(worst(&mut player).is_some_and(|worst| worst <= 2), "{low:?}: off and on");
        player.wires.board.attach(None);
        player.play(10);
        player.wires.board.attach(Some(Screen::dvi()));
        player.play(10);
        assert!(worst(&mut player).is_some_and(|worst| worst <= 2), "{low:?}: another screen");
    }
}

#[test]
fn words_of_luma_and_chroma_go_to_the_screen_where_asked() {
    let mut player = Player::new(Board::new(LowHotPlug::HoldsDefaults), board_program(|_| ()));
    player.settings |= 1;
    player.wires.board.attach(Some(Screen::hdmi()));
    player.play(30);
    assert_eq!(player.wires.shown().unwrap().coding, Coding::Ycc422);
    assert_eq!(worst(&mut player), Some(0));
}

#[test]
fn fault_six_bytes_are_exchanged_at_the_transmitter() {
    let exchanged = |program: &mut Vec<Action>| {
        for action in program {
            if let Action::Write { device: 0x39, register: 0x16, value } = action {
                *value |= 0b1100;
            }
        }
    };
    let mut player = board(board_program(exchanged), Screen::hdmi(), LowHotPlug::HoldsDefaults);
    assert!(worst(&mut player).is_some_and(|worst| worst > 50));
}

#[test]
fn fault_seven_the_override_of_hot_plug_comes_last() {
    let is_override = |action: &Action| matches!(action, Action::Write { device: 0x39, register: 0xd6, .. });
    // Further lines of defence are left out in both: reading back, and a new set-up with each hot plug.
    let once = |program: &mut Vec<Action>| {
        unchecked(program);
        let done = program.iter().position(|action| *action == Action::Done).unwrap();
        program[done + 1] = Action::End;
    };
    let last = |program: &mut Vec<Action>| {
        once(program);
        let first = program.iter().position(is_override).unwrap();
        let done = program.iter().position(|action| *action == Action::Done).unwrap();
        let moved = std::mem::replace(&mut program[first], Action::Index(0));
        program[done - 1..=done].copy_from_slice(&[moved, Action::Done]);
    };
    for low in LOW {
        for (program, state) in
            [(board_program(once), Sending::Runs), (board_program(last), Sending::PoweredDown)]
        {
            let mut player = Player::new(Board::new(low), program);
            player.play(30);
            player.wires.board.attach(Some(Screen::hdmi()));
            player.play(10);
            assert_eq!(player.wires.board.transmitter().state(), state, "{low:?}");
            assert_eq!(worst(&mut player).is_some(), state == Sending::Runs);
        }
    }
}

#[test]
fn faults_of_the_bus_are_lived_through() {
    let mut player = Player::new(Card::new(), card_program(|_| ()));
    player.wires.card.faults().refuse(5);
    player.wires.card.faults().stretch(20);
    player.wires.card.plug(source(halves()));
    player.play(30);
    assert!(player.is_done, "{:?}", player.failure);
    assert_eq!(player.wires.picture(), halves());
    player.wires.card.faults().stretch(0);
    player.wires.card.faults().remove(0x70);
    player.play(10);
    assert_eq!(player.failure.map(|(device, _)| device), Some(0x70));
    player.wires.card.faults().restore(0x70);
    player.play(60);
    assert!(player.is_done, "{:?}", player.failure);
    assert_eq!(player.wires.picture(), halves());
}
