//! Cable to cable: raw words leave a source, pictures are seen on a screen, and between them is the whole core with both set-ups running on
//! models of the chips that know nothing of them. If no picture arrives, the board's registers state the reason.

use crate::common::{committed, networks};
use crate::support;
use edof_board::Board;
use edof_board::chip_models::adv7511::State as Sending;
use edof_board::chip_models::adv7611::State;
use edof_board::chip_models::hdmi::{Coding, Pixel, rgb_of};
use edof_board::chip_models::source::{Picture, State as Playing};
use edof_board::chip_models::{Delays, Imageon, Kc705, LowHotPlug, Screen, Source};
use edof_board::chips::{Bus, ChipRegister};
use edof_board::link::PATIENCE;
use edof_board::simulated::chips::{cable, source};
use edof_core::{DisplayMode, RawFrame, Stride, cable};
use edof_cosim::system::cables::{self, Cables, Compiled, PACE};
use edof_cosim::system::{drawn, leisurely, picture};
use edof_device::Design;
use edof_device::board::KC705;
use edof_device::design::FrameSize;
use edof_device::i2c::{Action, depth};
use edof_device::video::VideoTiming;
use edof_golden::{Curve, Display, Golden};
use edof_hdl::project::Project;
use first_tables::{FIRST_IMAGEON, FIRST_KC705};
use std::sync::LazyLock;

#[path = "../../edof-board/tests/chips/first_tables.rs"]
mod first_tables;

/// The design's project, the one frame that its source sends, and what the screen must show.
struct Setup {
    design: Design,
    project: Project,
    raw: RawFrame,
    /// Luma low and chroma high of each pixel of the right picture.
    expected: Vec<u16>,
}

static SETUP: LazyLock<Setup> = LazyLock::new(Setup::new);

impl Setup {
    fn new() -> Self {
        let mut design = committed("tiny");
        design.frame = FrameSize { width: 32, height: 16, stride: Stride::PATCH };
        design.check().unwrap();
        let [_, network] = networks(&design, 7);
        let display = Display::new(DisplayMode::Colour, Curve::Srgb);
        let project = cables::project(&design, &network, &display).unwrap();
        let raw = drawn(design.frame, 1, 4).unwrap().remove(0);
        let golden = Golden::new(network).unwrap();
        let expected = picture(&golden, &display, &cable::carried(&raw)).unwrap();
        Self { design, project, raw, expected }
    }

    /// A source that sends the raw frame.
    fn source(&self) -> Option<Source> {
        let frame: Picture = self.raw.pixels().iter().map(|word| cable::codes(*word)).collect();
        Some(source(self.design.frame, vec![frame]))
    }

    fn start(&self, low: LowHotPlug, seed: u64) -> Cables {
        let delays = Delays::of(PACE.millisecond.into());
        let mut card = Imageon::new(delays);
        card.shorten_free_run(cable(VideoTiming::of_frame(self.design.frame)));
        let chips = (Kc705::new(delays, low), card);
        let compiled = Compiled::new(&self.project, &support::options()).unwrap();
        Cables::start(&compiled, leisurely(&self.design), chips, seed).unwrap()
    }

    /// The right picture as red, green and blue.
    fn colours(&self) -> Vec<Pixel> {
        let pairs = self.expected.chunks(2).flat_map(|pair| {
            let [cb, cr] = [pair[0], pair[1]].map(|word| (word >> 8) as u8);
            pair.iter().map(move |word| rgb_of(*word as u8, cb, cr)).collect::<Vec<_>>()
        });
        pairs.collect()
    }

    /// Whether the last frame on the screen is the right picture.
    fn is_shown(&self, cables: &Cables) -> bool {
        let board = cables.board.borrow();
        let Some(shown) = board.screen().and_then(|screen| screen.shown.last()) else { return false };
        match shown.coding {
            Coding::Ycc422 => {
                let words = shown.pixels.iter().map(|[_, y, c]| u16::from(*c) << 8 | u16::from(*y));
                words.eq(self.expected.iter().copied())
            }
            _ => {
                let near = |(a, b): (Pixel, Pixel)| (0..3).all(|i| a[i].abs_diff(b[i]) <= 2);
                shown.rgb().len() == self.expected.len()
                    && shown.rgb().into_iter().zip(self.colours()).all(near)
            }
        }
    }

    /// The picture comes, from now on.
    fn shows(&self, cables: &mut Cables) -> bool {
        if let Some(screen) = cables.board.borrow_mut().screen_mut() {
            screen.shown.clear();
        }
        cables.until(6, |cables| self.is_shown(cables)).unwrap()
    }
}

/// A field of a register, as a host reads it.
fn field(host: &mut Board<Cables>, name: &str) -> u32 {
    host.get(name.parse().unwrap()).unwrap()
}

/// Until the fields have these values.
fn comes_to(host: &mut Board<Cables>, expected: &[(&str, u32)]) -> bool {
    (0..100).any(|_| {
        host.line().steps(20_000).unwrap();
        expected.iter().all(|(name, value)| field(host, name) == *value)
    })
}

#[test]
#[ignore = "half a minute: scripts/soak.sh"]
fn a_picture_goes_from_cable_to_cable_in_whatever_order_cables_come() {
    let setup = &*SETUP;
    for (seed, low) in [(1, LowHotPlug::HoldsDefaults), (2, LowHotPlug::ResetsOnce)] {
        let mut cables = setup.start(low, seed);
        if seed == 1 {
            cables.board.borrow_mut().attach(Some(Screen::dvi()));
        } else {
            cables.card.borrow_mut().plug(setup.source());
        }
        cables.steps(1_500_000).unwrap();
        let mut host = Board::open(cables, PATIENCE).unwrap();
        let [cable, hot_plug] = ["receiver.cable", "transmitter.hot_plug"];
        let (sees_cable, sees_screen) = if seed == 1 { (0, 1) } else { (1, 0) };
        assert!(comes_to(&mut host, &[(cable, sees_cable), (hot_plug, sees_screen), ("status.i2c_done", 1)]));
        let cables = host.line();
        cables.card.borrow_mut().plug(setup.source());
        cables.board.borrow_mut().attach(Some(Screen::hdmi()));
        assert!(setup.shows(cables), "both are there");
        assert_eq!(cables.card.borrow().receiver().complaints(), [""; 0]);
        assert_eq!(cables.board.borrow().transmitter().complaints(), [""; 0]);

        cables.board.borrow_mut().switch_screen(false);
        assert!(comes_to(&mut host, &[(hot_plug, 0)]));
        host.line().board.borrow_mut().switch_screen(true);
        assert!(setup.shows(host.line()), "the screen is on again");
        assert!(comes_to(
            &mut host,
            &[(hot_plug, 1), ("receiver_size.width", 32), ("receiver_size.height", 16)]
        ));

        host.line().card.borrow_mut().plug(None);
        assert!(comes_to(&mut host, &[(cable, 0), ("receiver.tmds_locked", 0)]));
        host.line().card.borrow_mut().plug(setup.source());
        assert!(setup.shows(host.line()), "the cable is in again");
    }
}

#[test]
fn a_receiver_held_in_reset_is_named_and_the_picture_comes_when_it_is_let_go() {
    let setup = &*SETUP;
    let cables = setup.start(LowHotPlug::HoldsDefaults, 3);
    cables.card.borrow_mut().short_reset(true);
    cables.card.borrow_mut().plug(setup.source());
    cables.board.borrow_mut().attach(Some(Screen::hdmi()));
    let mut host = Board::open(cables, PATIENCE).unwrap();
    assert!(comes_to(
        &mut host,
        &[("status.i2c_failed", 1), ("i2c_card.device", 0x4c), ("i2c_board.done", 1)]
    ));
    let cables = host.line();
    assert_eq!(cables.card.borrow().receiver().state(), State::InReset);
    cables.card.borrow_mut().short_reset(false);
    assert!(setup.shows(cables));
    assert!(comes_to(&mut host, &[("status.i2c_done", 1), ("status.i2c_failed", 0)]));
    // The lights say what the status says, and the seventh that a screen is plugged in.
    assert_eq!(field(&mut host, "transmitter.hot_plug"), 1);
    let status = field(&mut host, "status") & 0x3f;
    assert_eq!(host.line().leds().unwrap(), u64::from(status | 0x40), "{status:#x}");
    // Each bus answers for its own chips: the transmitter's and the receiver's revision.
    let [transmitter, receiver] = [(Bus::Board, 0x39, 0), (Bus::Card, 0x4c, 0xea)]
        .map(|(bus, device, register)| host.read_chip(ChipRegister { bus, device, register }).unwrap());
    assert_eq!((transmitter, receiver), (0x12, 0x20));
}

/// The image of a program that the core runs in place of its own on that bus.
fn image(bus: usize, actions: impl IntoIterator<Item = Action>) -> (String, String) {
    let setup = KC705.setups().nth(bus).unwrap();
    let words = actions.into_iter().chain([Action::Done]).map(Action::word).chain(std::iter::repeat(0));
    let program = (setup.program)(VideoTiming::P1080_60, [0, 0]);
    let text = words.take(depth(&program)).map(|word| format!("{word:08x}\n")).collect();
    (setup.image.to_owned(), text)
}

#[test]
fn the_first_tables_bring_no_picture() {
    let write = |(device, register, value): &(u8, u8, u8)| Action::Write {
        device: *device,
        register: *register,
        value: *value,
    };
    let board =
        std::iter::once(Action::Byte { device: 0x74, value: 1 << 5 }).chain(FIRST_KC705.iter().map(write));
    let images = [image(0, board), image(1, FIRST_IMAGEON.iter().map(write))];
    let mut project = SETUP.project.clone();
    project.memory.retain(|(path, _)| KC705.setups().all(|setup| setup.image != path));
    project.memory.extend(images);
    let setup = Setup {
        project,
        design: SETUP.design.clone(),
        raw: SETUP.raw.clone(),
        expected: SETUP.expected.clone(),
    };
    let cables = setup.start(LowHotPlug::HoldsDefaults, 5);
    cables.card.borrow_mut().plug(setup.source());
    let mut host = Board::open(cables, PATIENCE).unwrap();
    assert!(comes_to(&mut host, &[("i2c_card.failed", 1), ("i2c_card.device", 0x4c), ("i2c_board.done", 1)]));
    let cables = host.line();
    assert_eq!(cables.card.borrow().receiver().state(), State::InReset);
    assert_eq!(cables.card.borrow().source().unwrap().state(), Playing::NoHotPlug);
    cables.board.borrow_mut().attach(Some(Screen::hdmi()));
    cables.steps(200_000).unwrap();
    assert_eq!(cables.board.borrow().transmitter().state(), Sending::PoweredDown);
    assert!(cables.board.borrow().screen().unwrap().shown.is_empty());
}
