//! A second network written to a running circuit.

use crate::common;
use crate::common::{Recorded, Setup, committed, expect_clean, for_set, moderate, patches};
use edof_cosim::chain::{Drive, Outcome};
use edof_device::Design;
use edof_device::design::memory::{self, Set};
use edof_device::design::reading;
use edof_golden::cycle::Stalls;
use edof_network::network::Recurrence;

/// The circuit starts with one network in both sets. A second one is written to set 1 while patches of set 0 run; patches of both
/// sets follow.
fn written_while_running(design: Design, drive: Drive) -> Outcome {
    let [first, second] = [1, 2].map(|seed| moderate(&design, seed));
    let setup = Setup::new_with(design, [first.clone(), first.clone()]);
    let mut patches = for_set(Set::First, patches(&setup.design, 150, 1));
    patches.extend(common::patches(&setup.design, 150, 2));
    let writes_while_running = memory::writes(&setup.design, &second, Set::Second);
    let mut circuit = Recorded::new(setup.start(1));
    let drive = Drive { writes_while_running, ..drive };
    let outcome = drive.run(setup.model_of([&first, &second]), patches, &mut circuit, &mut |_| ()).unwrap();
    assert!(circuit.last_write > 1000 && circuit.last_write < circuit.first_of_second_set().unwrap());
    outcome
}

fn with_rows(design: Design, rows: usize) -> Design {
    let stages = design.stages.iter().map(|size| edof_device::design::StageSize { rows, ..*size }).collect();
    Design { stages, ..design }
}

/// Windows that come so slowly that every stage is idle now and then.
fn slow() -> Drive {
    Drive { stalls: Some(Stalls::drawn(1, 220)), ..Drive::default() }
}

/// Cycles that the writes, one a cycle, take from all stages.
fn stolen(design: &Design, writes: &[(u32, u32)]) -> usize {
    let writes: Vec<_> = (0..).zip(writes).map(|(cycle, (address, word))| (cycle, *address, *word)).collect();
    (0..design.stages.len()).map(|stage| reading::stolen(design, stage, &writes).len()).sum()
}

#[test]
fn weights_that_are_read_at_one_port_take_no_cycle() {
    let design = with_rows(committed("tiny"), 1);
    assert_eq!(stolen(&design, &memory::writes(&design, &moderate(&design, 2), Set::Second)), 0);
    expect_clean(&written_while_running(design, slow()));
}

#[test]
fn weights_that_are_read_at_both_ports_take_a_cycle_each_from_their_stage() {
    let design = committed("tiny");
    let writes = memory::writes(&design, &moderate(&design, 2), Set::Second);
    assert!(2 * stolen(&design, &writes) > writes.len());
    expect_clean(&written_while_running(design, slow()));
}

#[test]
fn thresholds_of_differences_are_written_too() {
    let mut design = committed("tiny");
    design.form.recurrence = Recurrence::Difference;
    expect_clean(&written_while_running(design, slow()));
}

#[test]
fn a_circuit_that_skips_zeros_is_told_not_to() {
    let design = committed("tiny");
    assert!(design.skip_zeros);
    expect_clean(&written_while_running(design, Drive { skip_zeros: Some(false), ..slow() }));
}

#[test]
fn words_lie_at_addresses_of_their_own() {
    for name in ["tiny", "paper", "kc705"] {
        let design = committed(name);
        let network = edof_device::random::for_design(&design, 1);
        let writes = [Set::First, Set::Second].map(|set| memory::writes(&design, &network, set)).concat();
        let addresses: std::collections::BTreeSet<u32> = writes.iter().map(|(address, _)| *address).collect();
        assert_eq!(addresses.len(), writes.len());
        assert!(addresses.iter().all(|address| address >> memory::ADDRESS_BITS.iter().sum::<u32>() == 0));
    }
}
