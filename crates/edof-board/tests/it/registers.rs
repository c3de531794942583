//! Registers by name, and what they do.

use crate::common::{BAUD, board, frames, network, open, tiny};
use edof_board::line::Line;
use edof_board::link::PATIENCE;
use edof_board::names::Place;
use edof_board::{Board, Error, Simulated, status};
use edof_device::design::memory::Set;
use edof_device::registers::map::{self, REGISTERS};
use std::io;
use std::time::Duration;

fn place(name: &str) -> Place {
    name.parse().unwrap()
}

#[test]
fn a_board_says_who_it_is() {
    let design = tiny();
    let mut simulated = board(&design, &network(&design, 1));
    let board = open(&mut simulated);
    assert_eq!((board.identity.width, board.identity.height), (32, 24));
    let large = edof_device::Design::from_json(include_str!("../../../../designs/tiny.json")).unwrap();
    // The design's frame differs from that of the file.
    assert_eq!(board.design([large]).unwrap(), design);
    let paper = edof_device::Design::from_json(include_str!("../../../../designs/paper.json")).unwrap();
    let error = board.design([paper]).unwrap_err().to_string();
    assert!(error.contains("none that this program knows"), "{error}");
}

#[test]
fn registers_are_read_and_written_by_name() {
    let design = tiny();
    let mut simulated = board(&design, &network(&design, 1));
    let mut board = open(&mut simulated);
    board.set(place("scratch"), 0x1234_5678).unwrap();
    board.set(place("control.colour"), 0).unwrap();
    let found = ["scratch", "control", "control.run", "control.colour", "id", "frame_size.height"];
    let found = found.map(|name| board.get(place(name)).unwrap());
    assert_eq!(found, [0x1234_5678, 1, 1, 0, map::ID, 24]);
    assert!(board.set(place("id"), 1).is_err() && board.get(place("weights[0]")).is_err());
    let all = board.registers().unwrap();
    assert_eq!(all.len(), REGISTERS.len());
    // The rest counts meanwhile.
    let mut standing = all.iter().filter(|(place, _)| place.address() < map::STATUS);
    assert!(standing.all(|(place, word)| *word == board.get(*place).unwrap()));
}

#[test]
fn a_reset_begins_anew_with_the_bank_that_is_in_use() {
    let design = tiny();
    let mut simulated = board(&design, &network(&design, 1));
    let mut board = open(&mut simulated);
    board.set(place("control"), 0b100).unwrap();
    board.skip(&design, false).unwrap();
    assert_eq!(board.stage_register(4, 2).unwrap(), [0; 4]);
    board.reset(&design).unwrap();
    assert_eq!(board.control().unwrap(), 0b111);
    assert_eq!(board.stage_register(4, 2).unwrap(), [1; 4]);
    board.flush().unwrap();
    assert_eq!(board.control().unwrap(), 0b111);
}

#[test]
fn counters_tell_of_frames_and_stages() {
    let design = tiny();
    let mut simulated = board(&design, &network(&design, 1));
    frames(&mut simulated, 3);
    let mut first = open(&mut simulated);
    let before = first.look(4).unwrap();
    let (start, wait) = (simulated.now(), 30);
    frames(&mut simulated, wait);
    let after = open(&mut simulated).look(4).unwrap();
    let report = status::report(&before, &after, (simulated.now() - start) as f64 * 1e-9, design.clock_mhz);
    assert!((report.frames_per_second - 60.0).abs() < 5.0, "{report:?}");
    assert!(report.stages[0].nonzeros_per_patch > 0.0 && report.grown.is_empty(), "{report:?}");
    assert_eq!((after.value("status.output_runs"), report.late_frames), (1, 0));
    let mut board = open(&mut simulated);
    board.set(place("control.run"), 0).unwrap();
    let before = board.look(4).unwrap();
    frames(&mut simulated, 10);
    let after = open(&mut simulated).look(4).unwrap();
    let report = status::report(&before, &after, 0.17, design.clock_mhz);
    assert!(report.late_frames >= 8 && report.cycles_per_patch.is_none(), "{report:?}");
}

#[test]
fn a_lost_clock_puts_weights_in_doubt_until_they_are_confirmed() {
    let design = tiny();
    let net = network(&design, 1);
    let mut simulated = board(&design, &net);
    let doubt = |simulated: &mut Simulated| {
        let look = open(simulated).look(4).unwrap();
        [look.value("status.calculator_runs"), look.value("status.weights_unchecked")]
    };
    assert_eq!(doubt(&mut simulated), [1, 0]);
    simulated.lose_calculator_clock();
    assert_eq!(doubt(&mut simulated), [1, 1]);
    // A correct idle bank proves nothing about the bank in use.
    open(&mut simulated).confirm(&design, &net, Set::Second).unwrap();
    assert_eq!(doubt(&mut simulated), [1, 1]);
    let mut host = open(&mut simulated);
    assert_eq!(
        host.verify(&design, &net, Set::First, false, &mut |_, _| std::ops::ControlFlow::Continue(()))
            .unwrap(),
        []
    );
    host.confirm(&design, &net, Set::First).unwrap();
    assert_eq!(doubt(&mut simulated), [1, 0]);
    frames(&mut simulated, 3);
}

/// Says the same whatever is asked.
struct Parrot(Vec<u8>, Vec<u8>);

impl Line for Parrot {
    fn name(&self) -> &str {
        "/dev/parrot"
    }

    fn baud(&self) -> u32 {
        BAUD
    }

    fn time(&self) -> Duration {
        Duration::ZERO
    }

    fn send(&mut self, _: &[u8]) -> io::Result<()> {
        self.1.clone_from(&self.0);
        Ok(())
    }

    fn receive(&mut self, max: usize, _: Duration) -> io::Result<Vec<u8>> {
        Ok(self.1.drain(..max.min(self.1.len())).collect())
    }
}

#[test]
fn who_is_no_board_is_distinguished_from_silence() {
    let said = |words: &[u32]| {
        let bytes = words.iter().flat_map(|word| word.to_be_bytes()).collect();
        Board::open(Parrot(bytes, vec![]), PATIENCE).map(|_| ()).unwrap_err()
    };
    assert!(matches!(said(&[]), Error::Silent { .. }));
    let error = said(&[7, 0, 0, 0, 0]).to_string();
    assert!(error.starts_with("/dev/parrot: reads 0x00000007 as id"), "{error}");
    let error = said(&[map::ID, 0x0003_0000, 0, 0, 0]).to_string();
    assert!(error.contains("version 3.0"), "{error}");
    // The map before raw frames in grey.
    let error = said(&[map::ID, 0x0002_0004, 0, 0, 0]).to_string();
    assert!(error.contains("has version 2.4") && error.contains("expected 2.5 or a later 2.x"), "{error}");
}

#[test]
fn answers_that_a_host_before_did_not_take_are_not_taken_for_ones_own() {
    let design = tiny();
    let mut simulated = board(&design, &network(&design, 1));
    simulated.send(&edof_board::protocol::read(map::STATUS + 0x1000, 60)).unwrap();
    assert_eq!(open(&mut simulated).get(place("id")).unwrap(), map::ID);
}

#[test]
fn a_frame_that_was_cut_off_by_a_host_before_does_not_disturb_the_next() {
    let design = tiny();
    let network = network(&design, 1);
    for cut in 1..12 {
        let mut simulated: Simulated = board(&design, &network);
        let frame = edof_board::protocol::write(map::SCRATCH, &[5, 6]);
        simulated.send(&frame[..cut]).unwrap();
        let mut board = open(&mut simulated);
        assert_eq!(board.get(place("id")).unwrap(), map::ID, "cut after {cut} bytes");
    }
}
