//! The chain in rust-hdl's own simulator against the cycle model: every word and every cycle.

use edof_cosim::chain::simulated::Simulated;
use edof_cosim::chain::{Drive, Outcome};
use edof_golden::cycle::{Cycle, Patch, Stalls};
use edof_hdl::blocks::chain::Chain;
use edof_spec::Design;
use edof_spec::design::memory::Set;
use edof_spec::draw::Draw;

fn run(design: &Design, count: usize, drive: &Drive, seed: u64) -> Outcome {
    let networks = [1, 2].map(|set| edof_random::for_design(design, seed + set));
    let sets = [&networks[0], &networks[1]];
    let draw = &mut Draw::new(seed);
    let pixels = design.form.window.pixels();
    let patches = (0..count).map(|_| Patch {
        set: if draw.whole(0, 1) == 0 { Set::First } else { Set::Second },
        window: edof_random::extreme_window(draw, pixels),
    });
    let patches: Vec<Patch> = patches.collect();
    let mut device = Simulated::new(Chain::checked(design, sets).unwrap());
    drive.run(Cycle::new(design, sets).unwrap(), patches, &mut device, &mut |_| ()).unwrap()
}

#[test]
fn tiny_agrees_in_every_word_and_cycle() {
    let design = Design::from_json(include_str!("../../../designs/tiny.json")).unwrap();
    for (seed, skip, stalled) in [(1, true, 0), (2, false, 0), (3, true, 90), (4, false, 200)] {
        let stalls = Some(Stalls::drawn(seed, stalled));
        let drive = Drive { skip_zeros: Some(skip), stalls, ..Drive::default() };
        let outcome = run(&design, 6, &drive, seed);
        assert!(outcome.difference.is_none(), "{}", outcome.difference.unwrap());
        assert_eq!(outcome.beats, 6 * (32 + 8 + 8 + 8 + 64));
    }
}
