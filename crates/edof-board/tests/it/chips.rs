//! The video chips of a board: how they are in words, their registers, and the receiver's clock where the FPGA samples well.

use crate::common::{board, network, open, tiny};
use edof_board::align::{Align, Alignment};
use edof_board::chip_models::{Eye, Screen};
use edof_board::chips::{Bus, ChipRegister};
use edof_board::diagnosis::findings;
use edof_board::{Error, Simulated};
use edof_device::Design;
use edof_device::board::KC705;
use std::ops::ControlFlow;
use std::sync::LazyLock;

const SECOND: u64 = 1_000_000_000;
static DESIGN: LazyLock<Design> = LazyLock::new(tiny);

/// Aligns at the design's clock.
fn align(simulated: &mut Simulated) -> Result<Alignment, Error> {
    let asked = Align { codes: 200, clock_of: Some(&DESIGN) };
    open(simulated).align(asked, &mut |_| ControlFlow::Continue(()))
}

fn simulated() -> Simulated {
    let design = tiny();
    let mut simulated = board(&design, &network(&design, 1));
    simulated.pass_to(3 * SECOND);
    assert_eq!(open(&mut simulated).get("i2c_card.done".parse().unwrap()).unwrap(), 1);
    simulated
}

/// What is said of a chip after some time.
fn told(simulated: &mut Simulated, about: &str) -> (bool, String) {
    simulated.pass_to(simulated.now() + 3 * SECOND);
    let look = open(simulated).look(4).unwrap();
    let finding = findings(&KC705, &look).into_iter().find(|finding| finding.about == about).unwrap();
    (finding.is_good, finding.text)
}

fn says(simulated: &mut Simulated, about: &str, words: &str) {
    let (is_good, text) = told(simulated, about);
    assert!(!is_good && text.contains(words), "{about}: {text}");
}

#[test]
fn a_board_with_source_and_screen_comes_up_and_says_so() {
    let mut simulated = simulated();
    assert_eq!(told(&mut simulated, "receiver"), (true, "32x24, Y'CbCr BT.709".into()));
    assert_eq!(told(&mut simulated, "transmitter"), (true, "screen plugged in, HDMI, RGB".into()));
    assert!(told(&mut simulated, "input").0);
    let status = open(&mut simulated).get("status".parse().unwrap()).unwrap();
    assert_eq!(status & 0x37, 0x17, "ready, present, fits, set up, nothing failed");
    for complaints in [
        simulated.chips().card().receiver().complaints(),
        simulated.chips().board().transmitter().complaints(),
    ] {
        assert!(complaints.is_empty(), "{complaints:?}");
    }
}

#[test]
fn what_is_missing_is_reported_in_words_and_taken_up_when_it_comes() {
    let mut simulated = simulated();
    simulated.chips().plug(false);
    says(&mut simulated, "receiver", "no source");
    simulated.chips().plug(true);
    assert!(told(&mut simulated, "receiver").0);

    simulated.chips().board().switch_screen(false);
    says(&mut simulated, "transmitter", "no screen");
    simulated.chips().board().attach(Some(Screen::dvi()));
    assert_eq!(told(&mut simulated, "transmitter"), (true, "screen plugged in, DVI, RGB".into()));
    simulated.chips().board().attach(Some(Screen::hdmi()));
    assert!(told(&mut simulated, "transmitter").1.contains("HDMI"));

    simulated.chips().card().faults().remove(0x4c);
    says(&mut simulated, "receiver", "chip 0x4c does not acknowledge");
    simulated.chips().card().faults().restore(0x4c);
    simulated.chips().card().faults().remove(0x70);
    says(&mut simulated, "receiver", "FMC-IMAGEON seated");
    simulated.chips().card().faults().restore(0x70);
    assert!(told(&mut simulated, "receiver").0);
}

#[test]
fn a_screen_gets_ycbcr_where_the_host_asks_for_it() {
    let mut simulated = simulated();
    let mut board = open(&mut simulated);
    board.set("video_setup.screen_422".parse().unwrap(), 1).unwrap();
    board.set("control.i2c_restart".parse().unwrap(), 1).unwrap();
    assert_eq!(told(&mut simulated, "transmitter"), (true, "screen plugged in, HDMI, Y'CbCr 4:2:2".into()));
}

#[test]
fn registers_of_chips_are_read_and_written() {
    let mut simulated = simulated();
    let mut board = open(&mut simulated);
    let style = ChipRegister { bus: Bus::Board, device: 0x39, register: 0x16 };
    assert_eq!(board.read_chip(style).unwrap(), 0x38);
    let tap = ChipRegister { bus: Bus::Card, device: 0x4c, register: 0x19 };
    for value in [0x85, 0x9f] {
        board.write_chip(tap, value).unwrap();
        assert_eq!(board.read_chip(tap).unwrap(), value);
    }
    let nobody = ChipRegister { device: 0x11, ..tap };
    let error = board.read_chip(nobody).unwrap_err().to_string();
    assert!(error.contains("chip 0x11: does not acknowledge"), "{error}");
}

#[test]
fn alignment_lands_inside_of_the_window() {
    for seed in 0..12 {
        let mut simulated = simulated();
        let eye = Eye::drawn(seed);
        simulated.chips().card().set_eye(eye.clone());
        let alignment = align(&mut simulated).unwrap();
        let (window, middle) = (alignment.window, alignment.window.middle());
        assert!(eye.is_open(window.is_inverted, middle.into()), "{eye:?}: {window:?}");
        let open_taps = (0..32).filter(|tap| eye.is_open(window.is_inverted, *tap)).count();
        assert!(usize::from(window.taps) <= open_taps && window.taps >= 3, "{eye:?}: {window:?}");
        assert!(
            alignment
                .trials
                .iter()
                .all(|trial| trial.works() == eye.is_open(trial.is_inverted, trial.tap.into()))
        );
        assert_eq!(simulated.chips().card().receiver().clock_phase(), (window.is_inverted, middle.into()));
        // A later set-up keeps it.
        let mut board = open(&mut simulated);
        board.set("control.i2c_restart".parse().unwrap(), 1).unwrap();
        simulated.pass_to(simulated.now() + 3 * SECOND);
        assert!(told(&mut simulated, "receiver").0);
        assert_eq!(simulated.chips().card().receiver().clock_phase(), (window.is_inverted, middle.into()));
    }
}

#[test]
fn without_a_source_the_receiver_is_aligned_at_the_designs_clock() {
    let mut simulated = simulated();
    simulated.chips().plug(false);
    let eye = Eye::drawn(3);
    simulated.chips().card().set_eye(eye.clone());
    let alignment = align(&mut simulated).unwrap();
    assert!(eye.is_open(alignment.window.is_inverted, alignment.window.middle().into()), "{alignment:?}");
    assert_eq!(simulated.chips().card().clock_khz(), 148_500);
}

/// The receiver's own defaults, with which its free run is 640x480: every setting works, and its middle is wrong at the design's clock.
#[test]
fn at_another_clock_nothing_is_aligned() {
    let mut simulated = simulated();
    simulated.chips().plug(false);
    let mut board = open(&mut simulated);
    let mut set = |register, value| {
        board.write_chip(ChipRegister { bus: Bus::Card, device: 0x4c, register }, value).unwrap();
    };
    set(0x00, 0x08);
    set(0x01, 0x06);
    let error = align(&mut simulated).unwrap_err();
    let Error::OtherClock { found, expected, .. } = &error else { panic!("{error}") };
    assert!((found - 25.175).abs() < 0.01 && *expected == 148.5, "{error}");
    assert!(error.to_string().contains("let the source send 1920x1080 at 60 Hz"), "{error}");
    open(&mut simulated)
        .align(Align { codes: 200, clock_of: None }, &mut |_| ControlFlow::Continue(()))
        .unwrap();
}

#[test]
fn without_a_window_or_a_receiver_alignment_says_so_and_changes_nothing() {
    let mut simulated = simulated();
    let mut closed = Eye::wide();
    closed.taps = 0;
    simulated.chips().card().set_eye(closed);
    let before = simulated.chips().card().receiver().clock_phase();
    let error = align(&mut simulated).unwrap_err();
    assert!(matches!(error, Error::NoWindow { .. }), "{error}");
    assert_eq!(simulated.chips().card().receiver().clock_phase(), before);
    simulated.chips().card().faults().remove(0x70);
    simulated.pass_to(simulated.now() + 2 * SECOND);
    let error = align(&mut simulated).unwrap_err();
    assert!(matches!(error, Error::NoReceiver { .. }), "{error}");
}
