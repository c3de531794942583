//! The committed designs at full width, with a trained network in one set and an extreme one in the other.

mod common;
mod support;

use common::{Setup, committed, expect_clean, patches, root};
use edof_cosim::chain::Drive;
use edof_golden::cycle::Stalls;
use edof_spec::weight_file;

/// 2,000 patches, natural and extreme, zeros skipped and not, with and without stalls.
fn agrees_in_every_word_and_cycle(name: &str, weights: &str) {
    let design = committed(name);
    let trained =
        weight_file::load_fixed(&root().join(format!("weights/{weights}.fixed.safetensors"))).unwrap();
    let extreme = edof_random::for_design(&design, 1);
    let setup = Setup::new_with(design, [trained, extreme]);
    for (seed, skip, stalled, count) in
        [(1, true, 0, 800), (2, false, 0, 600), (3, true, 60, 400), (4, false, 160, 200)]
    {
        let stalls = Some(Stalls::drawn(seed, stalled));
        let drive = Drive { skip_zeros: Some(skip), stalls, ..Drive::default() };
        let outcome = setup.run(&drive, patches(&setup.design, count, seed), seed);
        expect_clean(&outcome);
        assert_eq!(outcome.summary.counts.patches, count as u64);
        if name == "paper" && !skip && stalled == 0 {
            assert!(outcome.summary.most_cycles <= 200, "{}", outcome.summary.most_cycles);
            assert_eq!(outcome.summary.most_cycles, outcome.summary.fewest_cycles, "constant");
        }
    }
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn paper_agrees_in_every_word_and_cycle() {
    agrees_in_every_word_and_cycle("paper", "paper-t4");
}

#[test]
fn kc705_agrees_in_every_word_and_cycle() {
    agrees_in_every_word_and_cycle("kc705", "edof-t4w12-outer");
}
