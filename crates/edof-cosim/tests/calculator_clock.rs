//! The core while one of its clocks stands still or is lost: pictures are whole, the host is answered, rejected words are not written later, and the other domains continue.

use crate::edof_core::{Setup, design};
use crate::frame_checks::FrameChecks;
use edof_core::draw::Draw;
use edof_core::{DisplayMode, RawFrame};
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::system::{Rig, drawn};
use edof_device::design::memory::{self, Set, Space};
use edof_device::design::reading::{
    READ_BACK, READ_REGISTER, ReadBack, bank_rows, crc, read_back_address, read_command,
};
use edof_device::registers::map::{self, DISPLAY_TABLES, STAGE_READS, WEIGHTS};

/// Edges after which a clock that stands still is known to: 4096 cycles of the memory's, and those of the other clocks meanwhile.
const NOTICED: usize = 20_000;

struct Trial {
    setup: Setup,
    frames: Vec<RawFrame>,
    pictures: Vec<Vec<u16>>,
    checks: FrameChecks,
    rig: Rig,
}

impl Trial {
    fn new(seed: u64) -> Self {
        let setup = Setup::new(design(8, 8, (32, 24)));
        let frames = drawn(setup.design.frame, 60, seed).unwrap();
        let pictures = setup.pictures(&frames, 0, DisplayMode::Colour);
        let checks = FrameChecks::new(&setup, &frames, 0, DisplayMode::Colour);
        let mut rig = setup.start(&frames, seed);
        rig.send(1).unwrap();
        rig.show(2).unwrap();
        Self { setup, frames, pictures, checks, rig }
    }

    /// New pictures come again, and all that were shown are whole.
    fn recovers(&mut self, what: &str) {
        let sent = self.rig.camera.frame;
        self.rig.send(sent + 3).unwrap();
        self.rig.show(2).unwrap();
        let last = self.setup.shown(&self.rig, &self.pictures).last().copied().flatten();
        assert!(last.is_some_and(|number| number > sent), "{what}: frame {sent} was sent, {last:?} is shown");
    }

    /// The same, and CRCs are of whole frames again.
    fn recovers_whole(&mut self, what: &str) {
        let sent = self.rig.camera.frame;
        self.recovers(what);
        self.checks.hold(&mut self.rig, sent, what);
    }

    /// Whether the calculator's clock runs, and whether its memories are in doubt.
    fn told(&mut self) -> [u32; 2] {
        let status = self.rig.register("status").unwrap();
        [status >> 8 & 1, status >> 9 & 1]
    }

    /// The CRC of the first bank of stage 1 of the second set, by the circuit and as it should be.
    fn crcs(&mut self) -> [u32; 2] {
        let stage = self.setup.design.stage(1);
        let rows = bank_rows(&self.setup.sets[1], &stage, 0);
        let command = read_command(Space::Weights { bank: 0, row: rows.len(), half: 0 }, rows.len());
        let register = memory::address(1, Space::Register { row: READ_REGISTER });
        self.rig.access(Access::Write(WEIGHTS.word(register), command)).unwrap();
        let shown = |part| Access::Read(STAGE_READS.word(read_back_address(1, part) & !READ_BACK));
        while self.rig.access(shown(ReadBack::Busy)).unwrap() == 1 {}
        [self.rig.access(shown(ReadBack::Crc)).unwrap(), crc(rows)]
    }
}

/// A weight of the bank that is not in use, with a word that it does not have.
fn weight(trial: &Trial) -> (u32, u32) {
    let writes = memory::writes(&trial.setup.design, &trial.setup.sets[1], Set::Second);
    let stage_1 = |address: u32| address >> 21 == 1 && address >> 19 & 3 == 0;
    let (address, word) = writes.into_iter().find(|(address, _)| stage_1(*address)).unwrap();
    (WEIGHTS.word(address), word ^ 0x0f0f_3c3c)
}

#[test]
fn a_calculator_whose_clock_stands_is_reported_and_begins_anew_when_it_comes_back() {
    let mut trial = Trial::new(21);
    let draw = &mut Draw::new(21);
    let [found, expected] = trial.crcs();
    assert_eq!((found, trial.told()), (expected, [1, 0]));
    for round in 0..3 {
        trial.rig.steps(draw.whole(1, 10_000) as usize).unwrap();
        trial.rig.bench.run_clock(trial.rig.calculator, false);
        // An access in progress when the clock stops, and some after it.
        let (address, word) = weight(&trial);
        let table = DISPLAY_TABLES.word(0x8000 + 5);
        let shown = STAGE_READS.word(read_back_address(1, ReadBack::Crc) & !READ_BACK);
        let all = [Access::Write(address, word), Access::Write(table, 7), Access::Read(shown)];
        for access in all {
            let refused = trial.rig.access(access).unwrap_err();
            assert!(refused.to_string().contains("was refused"), "{refused}");
        }
        assert_eq!(trial.told(), [0, 1], "round {round}");
        // The screen keeps showing the last picture.
        trial.rig.show(2).unwrap();
        let before = trial.rig.screen.frames.len();
        trial.rig.show(2).unwrap();
        assert_eq!(trial.rig.screen.frames[before + 1].1, trial.rig.screen.frames[before].1);
        if round == 1 {
            trial.rig.reset().unwrap();
        }
        trial.rig.steps(draw.whole(1, 5_000) as usize).unwrap();
        trial.rig.bench.run_clock(trial.rig.calculator, true);
        trial.recovers_whole("clock of the calculator");
        assert_eq!(trial.told(), [1, 1], "in doubt until the host says that it has looked");
        // The rejected words are absent.
        let [found, expected] = trial.crcs();
        assert_eq!(found, expected, "round {round}: a word that was refused was written");
        trial.rig.access(Access::Write(map::WEIGHTS_HASH, 5)).unwrap();
        assert_eq!(trial.told(), [1, 0]);
    }
}

#[test]
fn a_lock_that_is_lost_resets_the_calculator_alone() {
    let mut trial = Trial::new(22);
    let draw = &mut Draw::new(22);
    for stands in [0, 40, 1_000] {
        trial.rig.steps(draw.whole(1, 10_000) as usize).unwrap();
        let pictures = trial.rig.register("output_frames").unwrap();
        trial.rig.bench.run_clock(trial.rig.calculator, stands == 0);
        trial.rig.bench.set("calculator_reset_i", 1).unwrap();
        trial.rig.steps(stands + 12).unwrap();
        trial.rig.bench.set("calculator_reset_i", 0).unwrap();
        trial.rig.bench.run_clock(trial.rig.calculator, true);
        trial.recovers_whole("lock of the calculator's clock");
        assert_eq!(trial.told(), [1, 1]);
        // Counters of the memory's domain went on: it was not reset.
        assert!(trial.rig.register("output_frames").unwrap() > pictures);
        trial.rig.access(Access::Write(map::WEIGHTS_HASH, 5)).unwrap();
    }
    let [found, expected] = trial.crcs();
    assert_eq!(found, expected);
}

#[test]
fn a_short_pause_of_either_clock_resets_nothing() {
    let mut trial = Trial::new(23);
    let draw = &mut Draw::new(23);
    for clock in [trial.rig.calculator, trial.rig.core, trial.rig.calculator, trial.rig.core] {
        trial.rig.steps(draw.whole(1, 10_000) as usize).unwrap();
        trial.rig.bench.run_clock(clock, false);
        trial.rig.steps(draw.whole(1, 900) as usize).unwrap();
        trial.rig.bench.run_clock(clock, true);
        if clock == trial.rig.core {
            // Without the memory's clock the screen is black from somewhere in the frame on, and the camera's frame is lost.
            trial.rig.show(2).unwrap();
            trial.rig.screen.forget();
            trial.rig.shown_at.clear();
        }
        trial.recovers("a pause");
        assert_eq!(trial.told(), [1, 0]);
    }
    assert_eq!(trial.rig.register("picture_broken").unwrap(), 0);
    let [found, expected] = trial.crcs();
    assert_eq!(found, expected);
}

#[test]
fn a_lock_of_the_screens_clock_that_is_lost_stops_the_screen_alone() {
    let mut trial = Trial::new(25);
    trial.rig.bench.set("screen_reset_i", 1).unwrap();
    trial.rig.steps(1_000).unwrap();
    let (shown, made) = (trial.rig.screen.frames.len(), trial.rig.register("picture_frames").unwrap());
    let sent = trial.rig.camera.frame;
    trial.rig.send(sent + 3).unwrap();
    assert_eq!(trial.rig.screen.frames.len(), shown, "a screen in reset");
    assert_eq!(trial.rig.register("status").unwrap() >> 3 & 1, 0, "pictures that leave");
    assert!(trial.rig.register("picture_frames").unwrap() > made);
    trial.rig.bench.set("screen_reset_i", 0).unwrap();
    trial.rig.screen.forget();
    trial.rig.shown_at.clear();
    trial.recovers_whole("lock of the screen's clock");
    assert_eq!((trial.told(), trial.rig.register("status").unwrap() >> 3 & 1), ([1, 0], 1));
}

#[test]
fn while_the_screens_clock_stands_weights_are_loaded_and_pictures_made() {
    let mut trial = Trial::new(24);
    trial.rig.steps(5_003).unwrap();
    trial.rig.bench.run_clock(trial.rig.output, false);
    trial.rig.bench.set("screen_reset_i", 1).unwrap();
    trial.rig.steps(NOTICED).unwrap();
    let made = trial.rig.register("picture_frames").unwrap();
    // A whole network that the board has not seen, into the bank that is not in use.
    let network = edof_device::random::for_design(&trial.setup.design, 24);
    assert_ne!(trial.setup.sets[1], network);
    for (address, word) in memory::writes(&trial.setup.design, &network, Set::Second) {
        trial.rig.access(Access::Write(WEIGHTS.word(address), word)).unwrap();
    }
    trial.setup.sets[1] = network;
    let [found, expected] = trial.crcs();
    assert_eq!(found, expected);
    let sent = trial.rig.camera.frame;
    trial.rig.send(sent + 3).unwrap();
    assert!(trial.rig.register("picture_frames").unwrap() > made, "pictures are made without a screen");
    trial.rig.bench.run_clock(trial.rig.output, true);
    trial.rig.bench.set("screen_reset_i", 0).unwrap();
    // The picture on the screen was cut off; what comes after it is whole.
    trial.rig.screen.forget();
    trial.rig.shown_at.clear();
    trial.recovers("clock of the screen");
    assert_eq!(trial.told(), [1, 0]);
    // What was loaded meanwhile makes the right pictures.
    trial.rig.control(DisplayMode::Colour, 1).unwrap();
    let sent = trial.rig.camera.frame;
    trial.rig.send(sent + 2).unwrap();
    trial.rig.screen.forget();
    trial.rig.shown_at.clear();
    trial.pictures = trial.setup.pictures(&trial.frames, 1, DisplayMode::Colour);
    trial.recovers("other weights");
}
