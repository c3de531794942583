//! The chain in rust-hdl's own simulator against the cycle model: every word and every cycle.

use crate::common::{committed, expect_clean, misfits, networks, patches};
use edof_cosim::chain::simulated::Simulated;
use edof_cosim::chain::{Beat, Device, Drive, Inputs, Outputs};
use edof_device::design::memory::{self, Set, Space};
use edof_device::design::reading;
use edof_golden::cycle::{Cycle, Stalls};
use edof_hdl::blocks::chain::Chain;

#[test]
fn tiny_agrees_in_every_word_and_cycle() {
    let design = committed("tiny");
    for (seed, skip, stalled) in [(1, true, 0), (2, false, 90), (3, true, 200)] {
        let networks = networks(&design, seed);
        let sets = networks.each_ref();
        let stalls = Some(Stalls::drawn(seed, stalled));
        let drive = Drive { skip_zeros: Some(skip), stalls, ..Drive::default() };
        let mut device = Simulated::new(Chain::checked(&design, sets).unwrap());
        let model = Cycle::new(&design, sets).unwrap();
        let outcome = drive.run(model, patches(&design, 3, seed), &mut device, &mut |_| ()).unwrap();
        expect_clean(&outcome);
        assert_eq!(outcome.beats, 3 * (32 + 8 + 8 + 8 + 64));
    }
}

#[test]
fn after_a_flush_windows_of_any_length_give_what_the_model_says() {
    let design = committed("tiny");
    let networks = networks(&design, 5);
    let sets = networks.each_ref();
    let mut device = Simulated::new(Chain::checked(&design, sets).unwrap());
    for (seed, cycles) in [(1, 0), (2, 250)] {
        // In every cycle a beat that is not the last of a window; at first registers hold anything.
        let beat = Beat { words: [seed as i16, 9], base: [0; 2], last: false, set: Set::Second };
        let inputs = Inputs { window: Some(beat), ..Inputs::default() };
        (0..cycles).for_each(|_| device.cycle(&inputs, &mut Outputs::default()).unwrap());
        // A row of weights of every stage is read back meanwhile.
        let from = Space::Weights { bank: 0, row: 3, half: 0 };
        let command = |stage| {
            let register = Space::Register { row: reading::READ_REGISTER };
            (memory::address(stage, register), reading::read_command(from, 2))
        };
        let drive = Drive {
            flush: seed > 1,
            stalls: Some(Stalls::drawn(seed, 60)),
            writes_while_running: (0..4).map(command).collect(),
            ..Drive::default()
        };
        let patches = misfits(patches(&design, 5, seed), seed);
        let model = Cycle::new(&design, sets).unwrap();
        expect_clean(&drive.run(model, patches, &mut device, &mut |_| ()).unwrap());
    }
}
