//! The host against both kinds of a simulated board: the circuit in Verilator, its serial line at the pins, and the model in Rust. One body of
//! tests for both.

use crate::common::{committed, moderate, networks, root};
use crate::support;
use edof_board::align::Align;
use edof_board::chip_models::{Eye, Imageon};
use edof_board::diagnosis::findings;
use edof_board::dry_run::plan;
use edof_board::faulty::{Fault, Faulty, Resettable};
use edof_board::link::PATIENCE;
use edof_board::load::Job;
use edof_board::simulated::Shown;
use edof_board::{Board, Error, Simulated};
use edof_core::draw::Draw;
use edof_core::{DisplayMode, RawFrame, Stride, Window};
use edof_cosim::system::{self, Speed, VerilogBoard};
use edof_device::Design;
use edof_device::board::KC705;
use edof_device::design::FrameSize;
use edof_device::design::memory::Set;
use edof_device::registers::map;
use edof_golden::{Curve, Display, Golden};
use edof_hdl::project::Project;
use edof_network::{FixedNetwork, weight_file};
use std::ops::ControlFlow;

/// A simulated board of either kind.
trait Kind: Resettable {
    /// Simulates the given number of frames.
    fn show(&mut self, frames: u64);
    /// Pictures on the screen, each once where it came several times in a row; one of words of two networks is empty.
    fn shown(&self) -> Vec<Vec<u16>>;
    fn forget_shown(&mut self);
    /// From the host, and to it.
    fn bytes(&self) -> [u64; 2];
    /// Of its time.
    fn seconds(&self) -> f64;
    /// The card that its receiver is on.
    fn card(&mut self) -> &mut Imageon;
}

impl Kind for Simulated {
    fn show(&mut self, frames: u64) {
        self.pass_to(self.now() + frames * 17_000_000);
    }

    fn shown(&self) -> Vec<Vec<u16>> {
        let words = |shown: &Shown| match shown {
            Shown::Whole(pixels) => pixels.to_vec(),
            Shown::Mixed => vec![],
        };
        Self::shown(self).iter().map(words).collect()
    }

    fn forget_shown(&mut self) {
        Self::forget_shown(self);
    }

    fn bytes(&self) -> [u64; 2] {
        self.bytes
    }

    fn seconds(&self) -> f64 {
        self.now() as f64 * 1e-9
    }

    fn card(&mut self) -> &mut Imageon {
        self.chips().card()
    }
}

impl Kind for VerilogBoard {
    fn show(&mut self, frames: u64) {
        Self::show(self, frames).unwrap();
    }

    fn shown(&self) -> Vec<Vec<u16>> {
        Self::shown(self).to_vec()
    }

    fn forget_shown(&mut self) {
        Self::forget_shown(self);
    }

    fn bytes(&self) -> [u64; 2] {
        self.bytes
    }

    fn seconds(&self) -> f64 {
        Self::seconds(self)
    }

    fn card(&mut self) -> &mut Imageon {
        &mut self.chips().card
    }
}

/// A design with networks, and a frame that goes round.
pub struct Setup {
    pub design: Design,
    /// Those that the banks start with.
    pub sets: [FixedNetwork; 2],
    pub display: Display,
    pub raw: RawFrame,
    speed: Speed,
}

/// So fast a line that a load takes seconds: the circuit's cycles a bit are fewer than on the board, and all else is the same.
const FAST: u32 = 25_000_000;

impl Setup {
    /// The core that other tests of the whole core compile, too.
    pub fn tiny(baud: u32) -> Self {
        let mut design = committed("tiny");
        design.form.window = Window::new(8).unwrap();
        design.frame = FrameSize { width: 32, height: 24, stride: Stride::PATCH };
        let sets = networks(&design, 7);
        Self::new(design, sets, baud)
    }

    /// The same with networks whose results are seldom at the ends of their range, so that a result that is off by one shows.
    pub fn moderate(baud: u32) -> Self {
        let tiny = Self::tiny(baud);
        let sets = [5, 6].map(|seed| moderate(&tiny.design, seed));
        Self { sets, ..tiny }
    }

    fn new(design: Design, sets: [FixedNetwork; 2], baud: u32) -> Self {
        let raw = system::drawn(design.frame, 1, 5).unwrap().remove(0);
        let display = Display::new(DisplayMode::Colour, Curve::Srgb);
        Self { design, sets, display, raw, speed: Speed::of(&KC705, baud).unwrap() }
    }

    pub fn in_verilog(&self, seed: u64) -> VerilogBoard {
        let sets = [&self.sets[0], &self.sets[1]];
        let (with, options) = ((self.speed, seed), support::options());
        VerilogBoard::new(&self.design, sets, &self.display, &self.raw, with, &options).unwrap()
    }

    /// The circuit after its files were edited.
    pub fn edited(&self, seed: u64, edit: impl FnOnce(Project) -> Project) -> VerilogBoard {
        let project = system::project(&self.design, self.sets.each_ref(), &self.display).unwrap();
        let (with, options) = ((self.speed, seed), support::options());
        VerilogBoard::of_project(&edit(project), &self.design, &self.raw, with, &options).unwrap()
    }

    pub fn in_rust(&self) -> Simulated {
        let sets = [&self.sets[0], &self.sets[1]];
        Simulated::new(&self.design, sets, &self.display, self.raw.clone(), self.speed.baud()).unwrap()
    }

    /// A network of the same form as those at the start, and no other one's words.
    fn other(&self, seed: u64) -> FixedNetwork {
        edof_device::random::for_design(&self.design, seed)
    }

    fn job<'a>(&'a self, network: &'a FixedNetwork) -> Job<'a> {
        Job { design: &self.design, network, bank: None, full: false, read_back: false, known: &[] }
    }

    fn picture(&self, network: &FixedNetwork) -> Vec<u16> {
        system::picture(&Golden::new(network.clone()).unwrap(), &self.display, &self.raw).unwrap()
    }
}

fn open<K: Kind>(board: &mut K) -> Board<&mut K> {
    Board::open(board, PATIENCE).unwrap()
}

/// A load of all words into the bank that is not in use: takes the predicted time, and shows on the screen at a frame boundary. A reset then leaves
/// it in use.
fn a_load_is_seen_whole<K: Kind>(setup: &Setup, mut board: K, new: &FixedNetwork) {
    board.show(3);
    board.forget_shown();
    let job = Job { full: true, ..setup.job(new) };
    let ahead = plan(&job, Set::Second, None, setup.speed.baud()).unwrap();
    let mut host = open(&mut board);
    let start = host.line().seconds();
    let loaded = host.load(&job, &mut |_, _| ControlFlow::Continue(())).unwrap();
    let took = host.line().seconds() - start;
    assert_eq!((loaded.rounds, loaded.recovered, loaded.words), (1, false, ahead.words));
    println!("{} words: {:.4} s were told, {took:.4} s it took", loaded.words, ahead.seconds);
    assert!((ahead.seconds / took - 1.0).abs() < 0.1, "{} s were told, {took} s it took", ahead.seconds);
    board.show(3);
    let [old, new] = [&setup.sets[0], new].map(|network| setup.picture(network));
    assert_ne!(old, new);
    assert_eq!(board.shown(), [old, new.clone()], "one picture after the other, and nothing between");

    board.forget_shown();
    board.press_reset().unwrap();
    board.show(4);
    assert_eq!(board.shown(), [new]);
    let mut host = open(&mut board);
    assert_eq!((host.bank().unwrap(), host.get("scratch".parse().unwrap()).unwrap()), (Set::Second, 0));
}

/// What stands by the bank in use takes no words, and a host that is cut off in the midst of a frame leaves a board that answers.
fn what_goes_astray_does_no_harm<K: Kind>(setup: &Setup, mut board: K) {
    let mut host = open(&mut board);
    for name in ["weights[0]", "weights[0x280000]", "weights[0x380000]", "display_tables[9]"] {
        let refused = host.set(name.parse().unwrap(), 0x1234_5678).unwrap_err();
        assert!(matches!(refused, Error::Refused { .. }), "{name}: {refused}");
    }
    host.set("protection.control".parse().unwrap(), 1).unwrap();
    for cut in [3, 9] {
        let frame = edof_board::protocol::write(map::SCRATCH, &[1, 2, 3]);
        host.line().send(&frame[..cut]).unwrap();
        assert_eq!(open(*host.line()).get("id".parse().unwrap()).unwrap(), map::ID);
    }
    // Neither without its complement nor with a byte doubled.
    for word in [0u32, map::checked(0) << 8] {
        host.line().send(&edof_board::protocol::write(map::CONTROL, &[word])).unwrap();
    }
    let mut host = open(*host.line());
    assert_eq!(host.get("control".parse().unwrap()).unwrap(), map::running(DisplayMode::Colour, 0));
    let (kept_out, broken) =
        ["writes_refused", "uart_broken"].map(|name| host.get(name.parse().unwrap()).unwrap()).into();
    assert_eq!((kept_out, broken), (4 * 6 + 2, 2));
    board.show(2);
    assert_eq!(board.shown().last(), Some(&setup.picture(&setup.sets[0])));
}

/// A load that meets a fault, and one that does not. Every picture is of one network, what was in use stays or the new network is, and the
/// next load succeeds.
fn a_fault_does_no_harm<K: Kind>(setup: &Setup, mut board: K, fault: Fault) {
    let [first, second] = [&setup.other(9), &setup.other(10)];
    let pictures = [&setup.sets[0], first, second].map(|network| setup.picture(network));
    board.show(3);
    board.forget_shown();
    let faulty = Faulty::new(&mut board, fault);
    let outcome = Board::open(faulty, PATIENCE)
        .and_then(|mut host| host.load(&setup.job(first), &mut |_, _| ControlFlow::Continue(())));
    assert!(outcome.is_ok() || fault.may_end_the_host(), "{fault:?}: {outcome:?}");
    board.show(3);
    let last = if outcome.is_ok() { &pictures[1..2] } else { &pictures[..2] };
    assert!(board.shown().last().is_some_and(|shown| last.contains(shown)), "{fault:?}: {outcome:?}");
    let again = open(&mut board).load(&setup.job(second), &mut |_, _| ControlFlow::Continue(()));
    assert!(again.is_ok(), "{fault:?}: {again:?}");
    board.show(3);
    assert_eq!(board.shown().last(), Some(&pictures[2]), "{fault:?}");
    assert!(board.shown().iter().all(|shown| pictures.contains(shown)), "{fault:?}: a mixed picture");
}

fn faults_do_no_harm<K: Kind>(setup: &Setup, start: impl Fn(u64) -> K, seeds: std::ops::Range<u64>) {
    let mut board = start(seeds.start);
    let mut host = open(&mut board);
    let before = host.line().bytes();
    host.load(&setup.job(&setup.other(9)), &mut |_, _| ControlFlow::Continue(())).unwrap();
    let after = board.bytes();
    let bytes = [0, 1].map(|way| after[way] - before[way]);
    for seed in seeds.clone() {
        a_fault_does_no_harm(setup, start(seed), Fault::drawn(&mut Draw::new(seed), bytes));
    }
    println!("seeds {seeds:?}: no fault was lost, no picture mixed");
}

/// The host waits until a register is so.
fn wait<K: Kind>(board: &mut K, name: &str, value: u32) {
    for _ in 0..2_000 {
        if open(board).get(name.parse().unwrap()).unwrap() == value {
            return;
        }
        board.show(1);
    }
    panic!("{name} never is {value}");
}

/// Set-up, missing signals in words, and the receiver's clock where it samples well.
fn the_receiver_is_set_up_and_aligned<K: Kind>(mut board: K, seeds: std::ops::Range<u64>) {
    wait(&mut board, "status.i2c_done", 1);
    for seed in seeds {
        let eye = Eye::drawn(seed);
        board.card().set_eye(eye.clone());
        let alignment = open(&mut board)
            .align(Align { codes: 30, clock_of: None }, &mut |_| ControlFlow::Continue(()))
            .unwrap();
        let chosen = (alignment.window.is_inverted, usize::from(alignment.window.middle()));
        assert!(eye.is_open(chosen.0, chosen.1), "{eye:?}: {chosen:?}");
        assert_eq!(board.card().receiver().clock_phase(), chosen);
    }
    board.card().faults().remove(0x4c);
    wait(&mut board, "status.i2c_failed", 1);
    let look = open(&mut board).look(2).unwrap();
    let of_receiver =
        findings(&KC705, &look).into_iter().find(|finding| finding.about == "receiver").unwrap();
    assert!(
        !of_receiver.is_good && of_receiver.text.contains("chip 0x4c does not acknowledge"),
        "{of_receiver:?}"
    );
    board.card().faults().restore(0x4c);
    wait(&mut board, "status.i2c_failed", 0);
}

#[test]
#[ignore = "a minute: scripts/soak.sh"]
fn the_receiver_of_the_circuit_is_set_up_and_aligned() {
    the_receiver_is_set_up_and_aligned(Setup::tiny(FAST).in_verilog(5), 1..2);
}

#[test]
fn the_receiver_of_the_model_is_set_up_and_aligned() {
    the_receiver_is_set_up_and_aligned(Setup::tiny(FAST).in_rust(), 1..9);
}

#[test]
fn faults_do_no_harm_in_the_model() {
    let setup = Setup::tiny(FAST);
    faults_do_no_harm(&setup, |_| setup.in_rust(), 0..20);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn faults_do_no_harm_in_the_circuit() {
    let setup = Setup::tiny(FAST);
    faults_do_no_harm(&setup, |seed| setup.in_verilog(seed), 0..20);
}

#[test]
fn a_load_into_the_circuit_is_seen_whole() {
    let setup = Setup::tiny(FAST);
    a_load_is_seen_whole(&setup, setup.in_verilog(1), &setup.other(9));
}

#[test]
fn a_load_into_the_model_is_seen_whole() {
    let setup = Setup::tiny(FAST);
    a_load_is_seen_whole(&setup, setup.in_rust(), &setup.other(9));
}

#[test]
fn what_goes_astray_does_no_harm_in_the_circuit() {
    let setup = Setup::tiny(FAST);
    what_goes_astray_does_no_harm(&setup, setup.in_verilog(2));
}

#[test]
fn what_goes_astray_does_no_harm_in_the_model() {
    let setup = Setup::tiny(FAST);
    what_goes_astray_does_no_harm(&setup, setup.in_rust());
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_load_at_the_boards_own_speed_takes_what_was_told() {
    let setup = Setup::tiny(KC705.baud);
    a_load_is_seen_whole(&setup, setup.in_verilog(3), &setup.other(9));
}

/// Both kinds, loads at random moments.
#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn whenever_a_load_comes_every_frame_of_the_circuit_is_of_one_network() {
    let setup = Setup::tiny(FAST);
    for seed in 0..10 {
        let mut board = setup.in_verilog(seed);
        board.steps(Draw::new(seed).whole(1, 60_000) as usize).unwrap();
        a_load_is_seen_whole(&setup, board, &setup.other(20 + seed));
    }
}

/// The networks that come with the program, in the default design's circuit with small frames: all 70,000 words.
#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn a_trained_set_of_the_default_design_is_loaded_into_the_circuit() {
    let design = committed("kc705");
    let design = Design { frame: FrameSize { width: 32, height: 24, ..design.frame }, ..design };
    let [old, new] = ["edof-t4w12-outer", "edof-t4w12-outer-light"].map(|name| {
        weight_file::load_fixed(&root().join(format!("weights/{name}.fixed.safetensors"))).unwrap()
    });
    let setup = Setup::new(design, [old.clone(), old], FAST);
    a_load_is_seen_whole(&setup, setup.in_verilog(4), &new);
}
