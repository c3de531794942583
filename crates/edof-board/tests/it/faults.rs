//! Lines that lose, double and change bytes, hosts that are killed, boards that are reset or fall silent: what was in use stays in use, or
//! the load comes to its end; and the next load succeeds.

use crate::common::{board, frames, job, load, network, picture, same_words, tiny};
use edof_board::simulated::Shown;
use edof_board::{Error, Line, Simulated};
use edof_spec::draw::Draw;
use edof_spec::registers::map::WEIGHT_SET;
use edof_spec::{Design, FixedNetwork};
use std::io;
use std::time::Duration;

/// What goes wrong, at a byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Drop,
    Double,
    Flip(u8),
    /// The host ends.
    Kill,
    /// The board is reset.
    Reset,
    /// Nothing comes through any more, both ways.
    Silence,
}

#[derive(Debug, Clone, Copy)]
struct Fault {
    kind: Kind,
    /// Of the bytes from the host, or of those from the board.
    to_board: bool,
    at: u64,
}

/// A line with a fault.
struct Faulty<'a> {
    board: &'a mut Simulated,
    fault: Fault,
    bytes: [u64; 2],
    dead: bool,
}

impl Faulty<'_> {
    /// What becomes of a byte.
    fn passed(&mut self, byte: u8, to_board: bool) -> io::Result<Vec<u8>> {
        let count = &mut self.bytes[usize::from(to_board)];
        *count += 1;
        let now = self.fault.to_board == to_board && *count == self.fault.at;
        match self.fault.kind {
            Kind::Drop if now => return Ok(vec![]),
            Kind::Double if now => return Ok(vec![byte; 2]),
            Kind::Flip(mask) if now => return Ok(vec![byte ^ mask]),
            Kind::Kill if now => return Err(io::Error::other("killed")),
            Kind::Reset if now => self.board.reset(),
            Kind::Silence if now => self.dead = true,
            _ => {}
        }
        Ok(if self.dead { vec![] } else { vec![byte] })
    }
}

impl Line for Faulty<'_> {
    fn name(&self) -> &str {
        "faulty"
    }

    fn baud(&self) -> u32 {
        self.board.baud()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        for byte in bytes {
            let passed = self.passed(*byte, true)?;
            self.board.send(&passed)?;
        }
        Ok(())
    }

    fn receive(&mut self, most: usize, patience: Duration) -> io::Result<Vec<u8>> {
        let came = self.board.receive(most, patience)?;
        let mut passed = vec![];
        for byte in came {
            passed.extend(self.passed(byte, false)?);
        }
        Ok(passed)
    }
}

/// Bytes of a load's last question and answer, and more than loads differ in length.
const LAST: i64 = 100;

fn fault(draw: &mut Draw, bytes: [u64; 2]) -> Fault {
    let kind = match draw.whole(0, 9) {
        0 | 1 => Kind::Drop,
        2 | 3 => Kind::Double,
        4..=6 => Kind::Flip(1 << draw.whole(0, 7)),
        7 => Kind::Kill,
        8 => Kind::Reset,
        _ => Kind::Silence,
    };
    let to_board = draw.whole(0, 3) > 0;
    // Half of them where the frames of few words are, at the begin and the end.
    let most = bytes[usize::from(!to_board)] as i64;
    let at = match draw.whole(0, 3) {
        0 => draw.whole(1, most.min(600)),
        1 => draw.whole((most - 1500).max(1), most),
        _ => draw.whole(1, most),
    };
    // The answer to a load's last question: a reset after it is one of another time.
    let last = if kind == Kind::Reset { LAST } else { 0 };
    Fault { kind, to_board, at: (at - last).max(1) as u64 }
}

struct Bench {
    design: Design,
    networks: [FixedNetwork; 3],
    pictures: Vec<Shown>,
    /// Bytes of a load without faults.
    bytes: [u64; 2],
}

impl Bench {
    fn new() -> Self {
        let design = tiny();
        let networks = [1, 2, 3].map(|seed| network(&design, seed));
        let mut simulated = board(&design, &networks[0]);
        load(&mut simulated, &job(&design, &networks[1])).unwrap();
        let pictures = networks.iter().map(|network| picture(&design, network)).collect();
        Self { design, networks, pictures, bytes: simulated.bytes }
    }

    /// The number of the network in use, by its words.
    fn in_use(&self, simulated: &mut Simulated) -> Option<usize> {
        let control = crate::common::open(&mut *simulated).control().unwrap();
        let found = simulated.network(usize::from(control & WEIGHT_SET != 0))?;
        self.networks.iter().position(|network| same_words(&self.design, network, &found))
    }

    /// A load from a network to the next that a fault meets, and one without. What is said of the first.
    fn survives(&self, seed: u64) -> Result<String, String> {
        let draw = &mut Draw::new(seed);
        let mut simulated = board(&self.design, &self.networks[0]);
        // Half of the boards have had a load before, so that the bank in use is not that of a reset.
        let old = draw.whole(0, 1) as usize;
        if old == 1 {
            load(&mut simulated, &job(&self.design, &self.networks[1])).unwrap();
        }
        frames(&mut simulated, 2);
        simulated.forget_shown();
        let fault = fault(draw, self.bytes);
        let line = Faulty { board: &mut simulated, fault, bytes: [0; 2], dead: false };
        let outcome = load(line, &job(&self.design, &self.networks[2]));
        let told = format!("seed {seed}, {fault:?}, from network {old}: {outcome:?}");
        let expect = |is_so: bool, what: &str| if is_so { Ok(()) } else { Err(format!("{told}: {what}")) };
        let in_use = self.in_use(&mut simulated);
        match &outcome {
            Ok(_) => expect(in_use == Some(2), "the new network is not in use")?,
            Err(error) => {
                expect(error.to_string().lines().count() == 1, "not one line")?;
                let may_end = matches!(fault.kind, Kind::Kill | Kind::Silence);
                expect(may_end, "the host does not recover")?;
                // The last bytes of a load come when the new network is in use already.
                let done = simulated
                    .network(1 - old)
                    .is_some_and(|n| same_words(&self.design, &n, &self.networks[2]));
                expect(in_use == Some(old) || (in_use == Some(2) && done), "the old network is not in use")?;
            }
        }
        frames(&mut simulated, 3);
        let right = |shown: &Shown| self.pictures.contains(shown);
        expect(simulated.shown().iter().all(right), "a frame of neither network was shown")?;
        let again = load(&mut simulated, &job(&self.design, &self.networks[1]));
        expect(again.is_ok(), "the next load fails")?;
        expect(self.in_use(&mut simulated) == Some(1), "the next load is not in use")?;
        frames(&mut simulated, 3);
        expect(simulated.shown().last() == Some(&self.pictures[1]), "the next load is not shown")?;
        Ok(told)
    }
}

fn survive_all(seeds: std::ops::Range<u64>) {
    let bench = Bench::new();
    let outcomes: Vec<Result<String, String>> = seeds.clone().map(|seed| bench.survives(seed)).collect();
    let lost: Vec<&String> = outcomes.iter().filter_map(|outcome| outcome.as_ref().err()).collect();
    let ended = outcomes.iter().flatten().filter(|told| told.contains("Err(")).count();
    println!(
        "seeds {seeds:?}: {} faults, {ended} ended the host, {} lost or with a frame of neither network",
        outcomes.len(),
        lost.len()
    );
    assert!(lost.is_empty(), "{} lost: {lost:#?}", lost.len());
}

#[test]
fn no_fault_of_200_is_lost() {
    survive_all(0..200);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn no_fault_of_20000_is_lost() {
    survive_all(1000..21_000);
}

#[test]
fn a_board_that_falls_silent_ends_the_host_with_one_line() {
    let bench = Bench::new();
    let mut simulated = board(&bench.design, &bench.networks[0]);
    let fault = Fault { kind: Kind::Silence, to_board: true, at: 9_000 };
    let line = Faulty { board: &mut simulated, fault, bytes: [0; 2], dead: false };
    let error = load(line, &job(&bench.design, &bench.networks[1])).unwrap_err();
    assert!(matches!(error, Error::Silent { .. }), "{error}");
    assert!(error.to_string().starts_with("faulty: no answer, asked 6 times"), "{error}");
    assert_eq!(bench.in_use(&mut simulated), Some(0));
}
