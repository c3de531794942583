//! The generated Verilog in Verilator against the cycle model: every word and every cycle, in every form of a small design.

use crate::common;
use crate::common::{Recorded, Setup, committed, expect_clean, patches};
use edof_core::draw::Draw;
use edof_core::{Stride, Window};
use edof_cosim::chain::Drive;
use edof_device::Design;
use edof_device::design::{FrameSize, StageSize};
use edof_golden::cycle::Stalls;
use edof_golden::{Counts, scalar};
use edof_network::network::Form;
use edof_network::network::Recurrence::{self, Difference, Direct};
use edof_network::network::Shrinkage::{self, Firm, OneSided, TwoSided};
use std::collections::BTreeSet;

/// A design of 16 codes whose stages are 16, 8 or 4 lanes wide, and F 128, 64 or 32.
struct Small {
    shrinkage: Shrinkage,
    recurrence: Recurrence,
    /// With R.
    linear_path: bool,
    window: usize,
    bits: u32,
    tied: bool,
    /// Lanes and rows of I, each M, F.
    stages: &'static [(usize, usize)],
}

impl Small {
    fn design(&self) -> Design {
        let form = Form {
            window: Window::new(self.window).unwrap(),
            codes: 16,
            layers: self.stages.len(),
            shrinkage: self.shrinkage,
            recurrence: self.recurrence,
            linear_path: self.linear_path,
            tied: self.tied,
            exposures: 1,
        };
        let design = design(form, self.bits, self.stages);
        design.check().unwrap();
        design
    }
}

/// A design of a form, with lanes and rows of each stage.
fn design(form: Form, code_bits: u32, stages: &[(usize, usize)]) -> Design {
    Design {
        name: "small".into(),
        clock_mhz: 100.0,
        form,
        code_bits,
        accumulator_bits: 48,
        skip_zeros: true,
        stages: stages.iter().map(|(lanes, rows)| StageSize { lanes: *lanes, rows: *rows }).collect(),
        frame: FrameSize { width: 64, height: 48, stride: Stride::PATCH },
        sets: 2,
        board: <_>::default(),
        camera: None,
    }
}

/// A design with that number of layers and otherwise random sizes, of those that its check accepts.
fn random_design(draw: &mut Draw, layers: usize) -> Design {
    let one_of =
        |draw: &mut Draw, choices: &[usize]| choices[draw.whole(0, choices.len() as i64 - 1) as usize];
    loop {
        let form = Form {
            window: Window::new(one_of(draw, &[8, 12, 16])).unwrap(),
            codes: one_of(draw, &[8, 12, 16, 20, 24, 32, 36, 48]),
            layers,
            shrinkage: Shrinkage::ALL[draw.whole(0, 2) as usize],
            recurrence: [Direct, Difference][draw.whole(0, 1) as usize],
            linear_path: draw.whole(0, 1) == 1,
            tied: draw.whole(0, 3) == 0,
            exposures: 1,
        };
        let last = form.layers - 1;
        let stages: Vec<_> = (0..=last)
            .map(|i| {
                let outputs = if i == last { 128 } else { form.codes };
                (outputs / one_of(draw, &[1, 2, 3, 4]), one_of(draw, &[1, 2, 3, 4]))
            })
            .collect();
        let found = design(form, draw.whole(6, 16) as u32, &stages);
        if found.check().is_ok() {
            return found;
        }
    }
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn designs_of_random_sizes_agree_in_every_word_and_cycle() {
    let draw = &mut Draw::new(2026);
    for seed in 0..20 {
        let setup = Setup::new(random_design(draw, 2 + seed as usize % 5), seed);
        let stalls = Some(Stalls::drawn(seed, [0, 40, 190][seed as usize % 3]));
        let drive = Drive { skip_zeros: Some(draw.whole(0, 1) == 1), stalls, ..Drive::default() };
        println!("{:?}", setup.design);
        expect_clean(&setup.run(&drive, patches(&setup.design, 250, seed), seed));
    }
}

/// 2,000 patches: without stalls, with few, with many; zeros skipped and not.
fn agrees_in_every_word_and_cycle(design: Design) {
    let setup = Setup::new(design, 1);
    for (seed, skip, stalled, count) in [
        (1, true, 0, 600),
        (2, true, 40, 400),
        (3, true, 190, 200),
        (4, false, 0, 400),
        (5, false, 40, 300),
        (6, false, 190, 100),
    ] {
        let stalls = Some(Stalls::drawn(seed, stalled));
        let drive = Drive { skip_zeros: Some(skip), stalls, ..Drive::default() };
        expect_clean(&setup.run(&drive, patches(&setup.design, count, seed), seed));
    }
}

/// One test for each form, and the list of all. Those of many layers take minutes each.
macro_rules! forms {
    ($($(#[$soak:meta])? $name:ident: $shrinkage:ident $recurrence:ident, R $r:literal, window $window:literal, bits $bits:literal, tied $tied:literal, $stages:expr;)*) => {
        $(#[test]
        $(#[$soak])?
        fn $name() {
            agrees_in_every_word_and_cycle(forms()[stringify!($name)].design());
        })*

        fn forms() -> std::collections::BTreeMap<&'static str, Small> {
            [$((
                stringify!($name),
                Small {
                    shrinkage: $shrinkage,
                    recurrence: $recurrence,
                    linear_path: $r,
                    window: $window,
                    bits: $bits,
                    tied: $tied,
                    stages: &$stages,
                },
            )),*].into()
        }
    };
}

#[rustfmt::skip]
forms! {
    two_layers: TwoSided Direct, R false, window 8, bits 16, tied false, [(16, 1), (128, 1)];
    two_layers_with_linear_path: OneSided Direct, R true, window 8, bits 16, tied false, [(8, 2), (64, 2)];
    three_layers_of_differences: OneSided Difference, R true, window 8, bits 16, tied false, [(16, 2), (8, 1), (64, 1)];
    #[ignore = "four_layers_of_twelve_bits has these windows: scripts/soak.sh"]
    three_layers_of_large_windows: TwoSided Direct, R false, window 12, bits 16, tied false, [(8, 1), (16, 2), (128, 2)];
    four_layers_of_twelve_bits: OneSided Direct, R true, window 12, bits 12, tied false, [(16, 2), (16, 1), (8, 2), (64, 2)];
    three_layers_of_firm_differences: Firm Difference, R true, window 8, bits 12, tied false, [(16, 1), (8, 2), (64, 1)];
    #[ignore = "three_layers_of_differences has them: scripts/soak.sh"]
    four_layers_of_differences: TwoSided Difference, R false, window 8, bits 16, tied false, [(16, 1), (8, 2), (16, 1), (128, 1)];
    five_layers_tied: TwoSided Difference, R true, window 8, bits 16, tied true, [(8, 1), (8, 1), (8, 2), (16, 2), (128, 2)];
    #[ignore = "minutes: scripts/soak.sh"]
    six_layers_of_eight_bits: OneSided Direct, R false, window 8, bits 8, tied true, [(16, 1), (16, 2), (16, 1), (8, 1), (8, 2), (64, 1)];
    #[ignore = "minutes: scripts/soak.sh"]
    seven_layers: TwoSided Direct, R true, window 8, bits 16, tied false, [(8, 2), (16, 1), (8, 1), (16, 2), (8, 2), (16, 1), (32, 2)];
    #[ignore = "minutes: scripts/soak.sh"]
    eight_layers_folded_four_times: OneSided Difference, R false, window 8, bits 16, tied false,
        [(4, 2), (4, 1), (8, 2), (4, 2), (16, 1), (4, 1), (4, 2), (32, 1)];
    #[ignore = "minutes: scripts/soak.sh"]
    nine_layers_of_large_windows: OneSided Difference, R true, window 12, bits 14, tied true,
        [(8, 2), (8, 2), (16, 2), (8, 2), (16, 2), (16, 1), (8, 1), (8, 1), (64, 2)];
    #[ignore = "minutes: scripts/soak.sh"]
    ten_layers: TwoSided Direct, R false, window 8, bits 16, tied false,
        [(8, 1), (16, 1), (8, 1), (16, 1), (8, 1), (8, 2), (16, 2), (8, 2), (16, 2), (64, 1)];
    #[ignore = "minutes: scripts/soak.sh"]
    ten_layers_of_differences: TwoSided Difference, R true, window 8, bits 16, tied false,
        [(16, 2), (8, 1), (8, 2), (8, 1), (8, 2), (16, 1), (16, 2), (8, 1), (8, 2), (64, 2)];
}

#[test]
fn the_forms_cover_every_choice() {
    let forms = forms();
    let seen = |of: fn(&Small) -> usize| forms.values().map(of).collect::<BTreeSet<usize>>();
    assert_eq!(seen(|f| f.stages.len()), (2..=10).collect());
    assert_eq!(seen(|f| f.window), [8, 12].into());
    assert!(seen(|f| f.bits as usize).is_superset(&[8, 16].into()));
    assert_eq!(seen(|f| f.shrinkage as usize).len(), Shrinkage::ALL.len());
    let soft = forms.values().filter(|f| f.shrinkage != Firm);
    let pairs: BTreeSet<_> =
        soft.map(|f| (f.shrinkage as usize, f.recurrence == Direct, f.linear_path)).collect();
    assert_eq!(pairs.len(), 8, "each kind of soft threshold, recurrence and F");
    let shape = |f: &Small| {
        let last = f.stages.len() - 1;
        let fold = |i: usize| if i == last { 128 } else { 16 } / f.stages[i].0;
        (0..=last)
            .map(|i| {
                (
                    if i == 0 {
                        'I'
                    } else if i == last {
                        'F'
                    } else {
                        'M'
                    },
                    fold(i),
                    f.stages[i].1,
                )
            })
            .collect::<Vec<_>>()
    };
    let shapes: BTreeSet<_> = forms.values().flat_map(shape).collect();
    for kind in ['I', 'M', 'F'] {
        for (fold, rows) in [(1, 1), (1, 2), (2, 1), (2, 2)] {
            assert!(shapes.contains(&(kind, fold, rows)), "{kind} folded {fold}, {rows} rows");
        }
        assert!(shapes.iter().any(|(k, fold, _)| *k == kind && *fold == 4), "{kind} folded 4");
    }
}

#[test]
fn tiny_agrees_in_every_word_and_cycle() {
    agrees_in_every_word_and_cycle(committed("tiny"));
}

#[test]
fn one_set_of_weights_agrees_in_every_word_and_cycle() {
    let design = Design::from_json(include_str!("../../../tests/route/small.json")).unwrap();
    let setup = Setup::new(design, 1);
    let drive = Drive { stalls: Some(Stalls::drawn(1, 40)), ..Drive::default() };
    expect_clean(&setup.run(&drive, patches(&setup.design, 200, 1), 1));
}

#[test]
fn skipping_zeros_changes_cycles_and_no_bit() {
    let setup = Setup::new(committed("tiny"), 3);
    let run = |skip| {
        let drive = Drive { skip_zeros: Some(skip), ..Drive::default() };
        let mut device = Recorded::new(setup.start(1));
        let outcome =
            drive.run(setup.model(), patches(&setup.design, 200, 1), &mut device, &mut |_| ()).unwrap();
        expect_clean(&outcome);
        (device.words, outcome.cycles)
    };
    let (skipped, kept) = (run(true), run(false));
    assert_eq!(skipped.0, kept.0);
    assert_eq!(kept.0.len(), 200 * 128);
    assert!(skipped.1 < kept.1, "{} and {} cycles", skipped.1, kept.1);
}

#[test]
fn the_second_set_neither_saturates_nor_falls_silent() {
    for (name, form) in forms() {
        let design = form.design();
        let network = common::moderate(&design, 2);
        let draw = &mut Draw::new(1);
        let mut counts = Counts::new(design.form.layers);
        for _ in 0..100 {
            counts.add(&scalar::run(&network, &common::natural_window(draw, form.window, 15)).stages);
        }
        let last = design.form.layers - 1;
        for (stage, counts) in counts.stages.iter().enumerate() {
            let results = if stage == last { 12_800 } else { 1_600 };
            assert!(4 * counts.saturated_results < results, "{name}, stage {stage}: {counts:?}");
            assert!(stage == last || 8 * counts.nonzeros > results, "{name}, stage {stage}: {counts:?}");
        }
    }
}
