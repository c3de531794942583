//! The formulas that the golden pipeline and the circuits both take from `edof-core`, `edof-network` and `edof-device`, compared with values worked out by hand. If one of the formulas were wrong, the two would still agree.

use edof_device::Design;
use edof_device::design::memory::Shifts;
use edof_network::FixedNetwork;
use edof_network::network::Recurrence;

fn committed(name: &str) -> Design {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    Design::load(&root.join(format!("designs/{name}.json"))).unwrap()
}

/// Codes of 11, 10 and 12 fraction bits; A of 12, S of 13 and 14, D of 9, R of 8.
fn network(recurrence: Recurrence) -> (Design, FixedNetwork) {
    let mut design = committed("tiny");
    design.form.recurrence = recurrence;
    let mut network = edof_device::random::for_design(&design, 1);
    network.code_fractions = vec![11, 10, 12];
    network.analysis.fraction = 12;
    network.recurrent[0].fraction = 13;
    network.recurrent[1].fraction = 14;
    network.dictionary.fraction = 9;
    if let Some(r) = &mut network.linear_path {
        r.fraction = 8;
    }
    (design, network)
}

#[test]
fn shifts_of_the_direct_form_are_those_worked_out_by_hand() {
    let (design, network) = network(Recurrence::Direct);
    let shifts: Vec<Shifts> = design.stages().map(|stage| Shifts::of(&network, &stage)).collect();
    let none = Shifts::default();
    // I: pixels 15 + A 12 = 27 bits in the sum, b₁ has 11.
    assert_eq!(shifts[0], Shifts { result: 16, ..none });
    // M1: z 11 + S 13 = 24; b₁ has 11, b₂ 10. M2: z 10 + S 14 = 24; b₁ has 11, b₃ 12.
    assert_eq!(shifts[1], Shifts { result: 14, base: 13, ..none });
    assert_eq!(shifts[2], Shifts { result: 12, base: 13, ..none });
    // F: z 12 + D 9 = 21, pixels 15 + R 8 = 23; outputs have 14.
    assert_eq!(shifts[3], Shifts { result: 9, base: 0, code: 2, linear: 0 });
    assert_eq!(shifts[3].word(), 9 | 2 << 12);
}

#[test]
fn the_difference_form_adds_to_the_layer_before() {
    let (design, network) = network(Recurrence::Difference);
    let base = |stage: usize| Shifts::of(&network, &design.stage(stage)).base;
    // M1: z 11 + S 13 = 24, b₁ has 11. M2: z 10 + S 14 = 24, b₂ has 10.
    assert_eq!([base(1), base(2)], [13, 14]);
}

#[test]
fn sums_of_few_bits_are_shifted_up_to_the_outputs() {
    let (design, mut network) = network(Recurrence::Direct);
    network.dictionary.fraction = 0;
    network.linear_path = None;
    // z 12 + D 0 = 12 bits, outputs have 14: two up, none down.
    assert_eq!(Shifts::of(&network, &design.stage(3)), Shifts { result: 0, base: 0, code: 2, linear: 2 });
}

#[test]
fn windows_wait_for_the_linear_path_alone() {
    let kept = |name: &str| committed(name).stages().map(|stage| stage.kept_windows).collect::<Vec<_>>();
    assert_eq!(kept("tiny"), [0, 0, 0, 32]);
    assert_eq!(kept("kc705"), [0, 0, 0, 32]);
    assert_eq!(kept("paper"), [0; 4]);
    // Six vectors a layer; windows of side 12 have memory for 32.
    let deep = |layers, side| deeper(layers, side).stages().last().map(|stage| stage.kept_windows);
    for (layers, windows) in [(2, 16), (3, 32), (5, 32), (6, 64), (7, 64), (8, 64), (10, 64)] {
        assert_eq!(deep(layers, 8), Some(windows), "{layers} layers");
        assert!(windows >= 6 * layers, "{layers} layers");
        assert_eq!(deep(layers, 12), Some(windows.min(32)), "{layers} layers");
    }
}

/// The small design with another number of layers and another window.
fn deeper(layers: usize, side: usize) -> Design {
    let mut design = committed("tiny");
    (design.form.layers, design.form.window) = (layers, edof_core::Window::new(side).unwrap());
    let (first, middle, last) = (design.stages[0], design.stages[1], design.stages[3]);
    design.stages = std::iter::once(first).chain(vec![middle; layers - 2]).chain([last]).collect();
    design
}
