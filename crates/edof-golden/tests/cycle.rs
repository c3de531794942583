//! The cycle model: its recurrences against a machine that steps through every cycle, its words against the specification, and
//! what the committed designs take.

use edof_core::draw::Draw;
use edof_core::number::InputWord;
use edof_core::{Stride, Window};
use edof_device::Design;
use edof_device::design::memory::{Set, Space, address};
use edof_device::design::reading::{READ_REGISTER, read_command};
use edof_device::design::{FrameSize, StageSize};
use edof_golden::cycle::{
    Cycle, Patch, PatchRun, StageUse, StallPattern, Stalls, Summary, estimate, stepped,
};
use edof_golden::{Trace, scalar};
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_network::{FixedNetwork, weight_file};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn committed(name: &str) -> Design {
    Design::load(&project().join(format!("designs/{name}.json"))).unwrap()
}

/// Lanes that a stage with N outputs can have.
fn lanes(outputs: usize) -> Vec<usize> {
    (4..=outputs).step_by(4).filter(|lanes| outputs.is_multiple_of(*lanes)).collect()
}

/// Any small design: all forms, T = 2…10, lanes folded as far as they can be, one or two rows.
fn designs() -> impl Strategy<Value = Design> {
    let codes = prop::sample::select(vec![4usize, 8, 12, 16, 24, 32]);
    let window = prop::sample::select(vec![8usize, 8, 8, 12]);
    let flags = (prop::sample::select(&Shrinkage::ALL[..]), any::<bool>(), any::<bool>(), any::<bool>());
    (codes, window, 2usize..=10, flags, 8u32..=16, any::<u64>()).prop_map(
        |(codes, window, layers, flags, bits, seed)| {
            let (shrinkage, difference, linear_path, skip_zeros) = flags;
            let draw = &mut Draw::new(seed);
            let stages = (0..layers).map(|stage| {
                let choices = if stage + 1 == layers { vec![128, 64, 64, 32] } else { lanes(codes) };
                let lanes = choices[draw.whole(0, choices.len() as i64 - 1) as usize];
                let rows = match stage {
                    // Three parts of 64 pixels would not be even.
                    0 if window == 8 => [1, 2, 4][draw.whole(0, 2) as usize],
                    0 => draw.whole(1, 4) as usize,
                    _ => draw.whole(1, 2) as usize,
                };
                StageSize { lanes, rows }
            });
            let design = Design {
                name: "drawn".into(),
                clock_mhz: 100.0,
                stages: stages.collect(),
                form: Form {
                    window: Window::new(window).unwrap(),
                    codes,
                    layers,
                    shrinkage,
                    recurrence: if difference { Recurrence::Difference } else { Recurrence::Direct },
                    linear_path,
                    tied: seed.is_multiple_of(3),
                    exposures: 1,
                },
                code_bits: bits,
                accumulator_bits: 48,
                skip_zeros,
                sets: 2,
                frame: FrameSize { width: 64, height: 48, stride: Stride::PATCH },
                board: <_>::default(),
                camera: None,
            };
            design.check().unwrap();
            design
        },
    )
}

/// None, light, heavy, at either end or both.
fn stalls() -> impl Strategy<Value = Stalls> {
    let pattern = || {
        let share = prop_oneof![3 => Just(0u8), 2 => 1u8..128, 1 => 128u8..240, 1 => 240u8..=250];
        (any::<u64>(), share).prop_map(|(seed, stalled)| StallPattern::new(seed, stalled))
    };
    (pattern(), pattern()).prop_map(|(source, sink)| Stalls { source, sink })
}

/// Windows at the ends of their range, some of them all zero, for either set.
fn patches(design: &Design, count: usize, seed: u64) -> Vec<Patch> {
    let draw = &mut Draw::new(seed);
    let pixels = design.form.window.pixels();
    (0..count)
        .map(|_| {
            let dark = draw.whole(0, 4) == 0;
            let window = if dark {
                vec![InputWord::ZERO; pixels]
            } else {
                edof_device::random::extreme_window(draw, pixels)
            };
            Patch { window, set: if draw.bits().is_multiple_of(2) { Set::First } else { Set::Second } }
        })
        .collect()
}

/// A network that fits the design; half of them have thresholds that leave few codes.
fn network(design: &Design, seed: u64) -> FixedNetwork {
    let mut network = edof_device::random::for_design(design, seed);
    if seed.is_multiple_of(2) {
        let max = ((1 << (design.code_bits - 1)) - 1) as i16;
        network.thresholds.iter_mut().for_each(|theta| theta.mapv_inplace(|t| t.max(max - max / 8)));
    }
    network
}

/// Weights that are written while patches run, and now and then read back, in a third of all cases none, else in a tenth to a half of
/// all cycles.
fn writes(design: &Design, seed: u64) -> Vec<(u64, u32, u32)> {
    let draw = &mut Draw::new(seed);
    let between = [i64::MAX, 2, 10][draw.whole(0, 2) as usize];
    if between == i64::MAX {
        return vec![];
    }
    let mut cycle = 0;
    let write = |_| {
        cycle += draw.whole(1, 2 * between - 1) as u64;
        let stage = draw.whole(0, design.stages.len() as i64 - 1) as usize;
        let weights = Space::Weights { bank: 0, row: 0, half: 0 };
        if draw.whole(0, 20) == 0 {
            let register = Space::Register { row: READ_REGISTER };
            return (cycle, address(stage, register), read_command(weights, draw.whole(1, 5) as usize));
        }
        (cycle, address(stage, weights), 0)
    };
    (0..3000).map(write).collect()
}

/// What the specification makes of patches whose windows may be too short or too long.
fn specified(networks: [&FixedNetwork; 2], patches: &[Patch]) -> Vec<Trace> {
    let whole = |patch: &Patch, pixels: usize| {
        let mut window = patch.window.clone();
        window.resize(pixels, InputWord::ZERO);
        window
    };
    let trace = |patch: &Patch| {
        let network = networks[patch.set as usize];
        scalar::run(network, &whole(patch, network.form.window.pixels()))
    };
    patches.iter().map(trace).collect()
}

/// In a third of all cases one window in three is too short or too long.
fn misfits(mut patches: Vec<Patch>, seed: u64) -> Vec<Patch> {
    let draw = &mut Draw::new(seed);
    if draw.whole(0, 2) == 0 {
        for patch in &mut patches {
            let beats = draw.whole(1, patch.window.len() as i64) as usize;
            if draw.whole(0, 2) == 0 {
                patch.window.resize(2 * beats, InputWord::from_bits(77));
            }
        }
    }
    patches
}

/// The cycles of all transfers at each boundary.
fn cycles(design: &Design, runs: &[PatchRun]) -> Vec<Vec<u64>> {
    let boundary = |b: usize| runs.iter().flat_map(|run| run.times.boundaries[b].clone()).collect();
    (0..=design.form.layers).map(boundary).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_transfer_happens_in_the_cycle_in_which_the_stepped_machine_makes_it(
        design in designs(), stalls in stalls(), count in 1usize..30, skip: bool, seed: u64,
    ) {
        let networks = [seed, seed.wrapping_add(1)].map(|seed| network(&design, seed));
        let networks = [&networks[0], &networks[1]];
        let patches = misfits(patches(&design, count, seed), seed);
        let windows: Vec<usize> = patches.iter().map(|patch| patch.window.len() / 2).collect();
        let writes = writes(&design, seed);
        let model = Cycle::new(&design, networks).unwrap().skip_zeros(skip).stalls(stalls).writes(writes.clone());
        let runs: Vec<PatchRun> = model.run(patches.clone()).collect();
        let traces = specified(networks, &patches);
        prop_assert!(runs.iter().map(|run| &run.trace).eq(&traces));
        let stepped = stepped::run(&design, skip, stalls, &writes, &windows, &traces);
        for (boundary, (ours, theirs)) in cycles(&design, &runs).iter().zip(&stepped).enumerate() {
            let differs = ours.iter().zip(theirs).position(|(a, b)| a != b);
            prop_assert_eq!(differs, None, "boundary {}", boundary);
            prop_assert_eq!(ours.len(), theirs.len());
        }
    }

    #[test]
    fn a_chain_of_equal_patches_takes_what_the_slowest_stage_would_take_alone(design in designs()) {
        let estimate = estimate(&design, None);
        let alone = estimate.stages[estimate.limiting_stage()].largest();
        prop_assert_eq!(estimate.cycles_per_patch, alone);
    }
}

#[test]
fn beats_carry_what_the_receiver_needs() {
    for recurrence in [Recurrence::Direct, Recurrence::Difference] {
        let mut design = committed("tiny");
        design.form.recurrence = recurrence;
        let network = edof_device::random::for_design(&design, 3);
        let model = Cycle::new(&design, [&network, &network]).unwrap();
        let run = model.run(patches(&design, 1, 1)).next().unwrap();
        let beat = |boundary: usize, i: usize| run.transfers(boundary).nth(i).unwrap();
        let codes = &run.trace.layers;
        let base = if recurrence == Recurrence::Direct { &codes[0].b } else { &codes[1].b };
        assert_eq!(beat(1, 2).base, Some([codes[0].b[4], codes[0].b[5]]));
        assert_eq!(beat(2, 2).base, Some([base[4], base[5]]));
        assert_eq!([beat(0, 2).base, beat(3, 2).base, beat(4, 2).base], [None; 3]);
        assert_eq!(beat(0, 2).words, [4, 5].map(|at| run.trace.input[at].to_bits()));
        assert_eq!(beat(2, 2).words, [codes[1].sent[4], codes[1].sent[5]]);
        assert_eq!(beat(3, 2).words, [codes[2].z[4], codes[2].z[5]]);
        assert_eq!(beat(4, 2).words, [4, 5].map(|at| run.trace.output[at].to_bits()));
        assert_eq!(run.boundaries(), design.form.layers + 1);
        assert_eq!(beat(2, 7).words, [codes[1].sent[14], codes[1].sent[15]]);
        for boundary in 0..run.boundaries() {
            let lasts: Vec<bool> = run.transfers(boundary).map(|beat| beat.last).collect();
            assert_eq!(lasts.iter().position(|last| *last), Some(run.words(boundary).len() / 2 - 1));
        }
    }
}

fn summary(model: &Cycle, patches: Vec<Patch>) -> Summary {
    let mut summary = Summary::new(model.design());
    model.run(patches).for_each(|run| summary.add(&run));
    summary
}

#[test]
fn paper_takes_the_same_number_of_cycles_for_any_patch_and_at_most_200() {
    let design = committed("paper");
    let networks = [1, 2].map(|seed| network(&design, seed));
    let model = Cycle::new(&design, [&networks[0], &networks[1]]).unwrap();
    let summary = summary(&model, patches(&design, 500, 4));
    assert_eq!((summary.min_cycles, summary.max_cycles), (192, 192));
    let estimate = estimate(&design, None);
    assert_eq!((estimate.cycles_per_patch, estimate.patches_per_frame), (192.0, 240 * 135));
    assert!((20.0..20.2).contains(&estimate.frames_per_second));
}

#[test]
fn skipping_zeros_changes_cycles_and_not_one_word() {
    for name in ["tiny", "paper", "kc705"] {
        let design = committed(name);
        let network = network(&design, 2);
        let model = Cycle::new(&design, [&network, &network]).unwrap();
        let run = |skip| model.clone().skip_zeros(skip).run(patches(&design, 100, 7)).collect::<Vec<_>>();
        let (on, off) = (run(true), run(false));
        assert!(on.iter().map(|run| &run.trace).eq(off.iter().map(|run| &run.trace)), "{name}");
        let end = |runs: &[PatchRun]| runs.last().unwrap().times.end();
        assert!(end(&on) < end(&off), "{name}");
    }
}

#[test]
fn counters_are_those_of_the_specification() {
    let design = committed("tiny");
    let network = network(&design, 5);
    let patches = patches(&design, 60, 8);
    let traces = specified([&network; 2], &patches);
    let summary = summary(&Cycle::new(&design, [&network; 2]).unwrap(), patches);
    for (stage, counts) in summary.counts.stages.iter().enumerate() {
        let nonzeros: u64 = traces.iter().map(|trace| trace.stages[stage].nonzeros).sum();
        let saturations: u64 = traces.iter().map(|trace| trace.stages[stage].saturations()).sum();
        assert_eq!((counts.nonzeros, counts.saturations()), (nonzeros, saturations));
    }
}

#[test]
fn a_summary_is_what_its_runs_add_up_to() {
    let design = committed("tiny");
    let network = network(&design, 5);
    let model = Cycle::new(&design, [&network; 2]).unwrap();
    let pixels = design.form.window.pixels();
    let misfits = (0..).map(|seed| misfits(patches(&design, 60, 8), seed));
    let mut uneven = misfits.filter(|patches| patches.iter().any(|patch| patch.window.len() != pixels));
    let patches = uneven.next().unwrap();
    let runs: Vec<PatchRun> = model.run(patches.clone()).collect();
    let summary = summary(&model, patches.clone());
    let ends: Vec<u64> =
        runs.iter().map(|run| *run.times.boundaries[design.form.layers].last().unwrap()).collect();
    let between: Vec<u64> = ends.windows(2).map(|two| two[1] - two[0]).collect();
    assert_eq!(
        (summary.min_cycles, summary.max_cycles),
        (*between.iter().min().unwrap(), *between.iter().max().unwrap())
    );
    assert_eq!(summary.cycles_per_patch(), between.iter().sum::<u64>() as f64 / 59.0);
    assert_eq!(summary.cycles(), ends[59] + 1);
    let latencies: Vec<u64> =
        runs.iter().zip(&ends).map(|(run, end)| end - run.times.boundaries[0][0]).collect();
    assert_eq!(summary.mean_latency(), latencies.iter().sum::<u64>() as f64 / 60.0);
    assert_eq!(summary.max_latency, *latencies.iter().max().unwrap());
    let misfit = |is: fn(&usize, &usize) -> bool| {
        patches.iter().filter(|patch| is(&patch.window.len(), &pixels)).count() as u64
    };
    assert!(misfit(usize::lt) > 1 && misfit(usize::gt) > 1);
    assert_eq!((summary.too_short, summary.too_long), (misfit(usize::lt), misfit(usize::gt)));
    for (index, stage) in summary.stages.iter().enumerate() {
        let sum = |of: fn(&StageUse) -> u64| runs.iter().map(|run| of(&run.times.stages[index])).sum::<u64>();
        let found = (stage.pairs, stage.steps, stage.waited_for_input, stage.waited_for_drain);
        let used =
            (sum(|u| u.pairs), sum(|u| u.steps), sum(|u| u.waited_for_input), sum(|u| u.waited_for_drain));
        assert_eq!(found, used);
        // A stage multiplies the words sent to it that are not zero; I multiplies all.
        let sent = |run: &PatchRun| run.words(index).iter().filter(|word| **word != 0).count() as u64;
        let pairs = if index == 0 { 60 * pixels as u64 } else { runs.iter().map(sent).sum() };
        assert_eq!(stage.pairs, pairs, "stage {index}");
        assert_eq!(summary.mean_pairs()[index], pairs as f64 / 60.0);
    }
}

#[test]
fn a_network_of_another_form_is_rejected() {
    let (tiny, paper) = (committed("tiny"), committed("paper"));
    let network = edof_device::random::for_design(&paper, 1);
    let error = Cycle::new(&tiny, [&network, &network]).unwrap_err().to_string();
    assert!(error.contains("does not fit design tiny: it has 192 values of sparse code, "), "{error}");
    assert!(!error.contains('{'), "{error}");
}

/// Windows with a level and some texture, as photographs have them.
fn natural_patches(design: &Design, count: usize) -> Vec<Patch> {
    let draw = &mut Draw::new(5);
    let side = design.form.window.side() as i64;
    (0..count)
        .map(|_| {
            let (level, slope, noise) = (draw.whole(500, 25_000), draw.whole(-150, 150), draw.whole(1, 300));
            let pixel = |i: i64| {
                let bits = (level + slope * (i % side) + draw.whole(-noise, noise)).clamp(0, 32_767);
                InputWord::from_bits(bits as i16)
            };
            Patch { window: (0..side * side).map(pixel).collect(), set: Set::First }
        })
        .collect()
}

#[test]
fn kc705_with_trained_weights_takes_little_more_than_its_mean_patch_would() {
    let design = committed("kc705");
    let path = project().join("weights/edof-t4w12-outer.fixed.safetensors");
    let network = weight_file::load_fixed(&path).unwrap();
    let summary = summary(&Cycle::new(&design, [&network; 2]).unwrap(), natural_patches(&design, 1000));
    let mean = estimate(&design, Some(&summary.mean_pairs()));
    let cycles = summary.cycles_per_patch();
    assert!((mean.cycles_per_patch..1.15 * mean.cycles_per_patch).contains(&cycles), "{cycles}, {mean:?}");
    assert!(cycles < estimate(&design, None).cycles_per_patch);
    // M2 and F need about as much: which of them limits is decided by few patches.
    let max = mean.stages[mean.limiting_stage()].largest();
    assert!(mean.stages[summary.limiting_stage()].largest() > 0.95 * max, "{mean:?}");
}
