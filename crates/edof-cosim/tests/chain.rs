//! The generated Verilog in Verilator against the cycle model: every word and every cycle.

use edof_cosim::chain::verilated::Compiled;
use edof_cosim::chain::{Drive, Outcome};
use edof_cosim::verilator::Options;
use edof_golden::cycle::{Cycle, Patch, Stalls};
use edof_golden::sample::{self, Draw};
use edof_hdl::project;
use edof_spec::Design;
use edof_spec::FixedNetwork;
use edof_spec::design::memory::Set;

fn patches(design: &Design, count: usize, seed: u64) -> Vec<Patch> {
    let draw = &mut Draw::new(seed);
    let pixels = design.form.window.pixels();
    let patch = |_| Patch {
        set: if draw.whole(0, 1) == 0 { Set::First } else { Set::Second },
        window: sample::extreme_window(draw, pixels),
    };
    (0..count).map(patch).collect()
}

fn run(design: &Design, sets: [&FixedNetwork; 2], count: usize, drive: &Drive, seed: u64) -> Outcome {
    let project = project::calculator(design, sets).unwrap();
    let compiled = Compiled::new(&project, design.stages.len(), &Options::default()).unwrap();
    let model = Cycle::new(design, sets).unwrap();
    drive.run(model, patches(design, count, seed), &mut compiled.start(seed).unwrap(), &mut |_| ()).unwrap()
}

#[test]
fn tiny_agrees_in_every_word_and_cycle() {
    let design = Design::from_json(include_str!("../../../designs/tiny.json")).unwrap();
    let networks = [1, 2].map(|seed| sample::for_design(&design, seed));
    let drive = Drive { stalls: Some(Stalls::drawn(1, 60)), ..Drive::default() };
    let start = std::time::Instant::now();
    let outcome = run(&design, [&networks[0], &networks[1]], 500, &drive, 1);
    println!("{:?} {} cycles", start.elapsed(), outcome.cycles);
    assert!(outcome.difference.is_none(), "{}", outcome.difference.unwrap());
    assert_eq!(outcome.beats, 500 * (32 + 8 + 8 + 8 + 64));
}

#[test]
fn paper_agrees_in_every_word_and_cycle() {
    let design = Design::from_json(include_str!("../../../designs/paper.json")).unwrap();
    let networks = [1, 2].map(|seed| sample::for_design(&design, seed));
    let drive = Drive { stalls: Some(Stalls::drawn(1, 0)), ..Drive::default() };
    let start = std::time::Instant::now();
    let outcome = run(&design, [&networks[0], &networks[1]], 300, &drive, 1);
    println!("{:?} {} cycles {}", start.elapsed(), outcome.cycles, outcome.summary.cycles_per_patch());
    assert!(outcome.difference.is_none(), "{}", outcome.difference.unwrap());
}
