//! Lines that lose, double and change bytes, hosts that are killed, boards that are reset or fall silent: what was in use stays in use, or
//! the load comes to its end; and the next load succeeds.

use crate::common::{board, frames, job, load, network, picture, same_words, tiny};
use edof_board::faulty::{Fault, Faulty, Kind};
use edof_board::simulated::Shown;
use edof_board::{Error, Simulated};
use edof_core::draw::Draw;
use edof_device::Design;
use edof_device::registers::map::WEIGHT_SET;
use edof_network::FixedNetwork;

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
        let fault = Fault::drawn(draw, self.bytes);
        let outcome = load(Faulty::new(&mut simulated, fault), &job(&self.design, &self.networks[2]));
        let told = format!("seed {seed}, {fault:?}, from network {old}: {outcome:?}");
        let expect = |is_so: bool, what: &str| if is_so { Ok(()) } else { Err(format!("{told}: {what}")) };
        let in_use = self.in_use(&mut simulated);
        match &outcome {
            Ok(_) => expect(in_use == Some(2), "the new network is not in use")?,
            Err(error) => {
                expect(error.to_string().lines().count() == 1, "not one line")?;
                expect(fault.may_end_the_host(), "the host does not recover")?;
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

fn survive_all(seeds: impl Iterator<Item = u64>) {
    let bench = Bench::new();
    let outcomes: Vec<Result<String, String>> = seeds.map(|seed| bench.survives(seed)).collect();
    let lost: Vec<&String> = outcomes.iter().filter_map(|outcome| outcome.as_ref().err()).collect();
    let ended = outcomes.iter().flatten().filter(|told| told.contains("Err(")).count();
    println!(
        "{} faults, {ended} ended the host, {} lost or with a frame of neither network",
        outcomes.len(),
        lost.len()
    );
    assert!(lost.is_empty(), "{} lost: {lost:#?}", lost.len());
}

#[test]
fn no_fault_of_200_is_lost() {
    survive_all(0..200);
}

/// A byte that came twice stood before each later answer. Such answers agreed with each other, were kept as what the stages skip, and restored without
/// an end.
#[test]
fn a_byte_that_comes_twice_does_not_change_what_a_load_keeps() {
    survive_all([4312, 12_040].into_iter());
}

/// After a reset the rest of a frame was taken for a question after 255 words; the host waited for a hundred bytes of their answer.
#[test]
fn a_long_answer_after_a_reset_is_waited_out() {
    survive_all([11_351, 12_158].into_iter());
}

/// A question of the last check became a word for the new bank, which nothing protected between its CRCs and its use.
#[test]
fn no_question_of_a_check_changes_what_was_checked() {
    survive_all([9714].into_iter());
}

/// A byte that came twice in the last question before the switch stood before the answer of what `control` was, which then no longer ran.
#[test]
fn a_switch_keeps_the_rest_of_control() {
    survive_all([15_042].into_iter());
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
    let line = Faulty::new(&mut simulated, fault);
    let error = load(line, &job(&bench.design, &bench.networks[1])).unwrap_err();
    assert!(matches!(error, Error::Silent { .. }), "{error}");
    assert!(
        error.to_string().starts_with("faulty: no answer at 921600 bits per second, asked 6 times"),
        "{error}"
    );
    assert_eq!(bench.in_use(&mut simulated), Some(0));
}
