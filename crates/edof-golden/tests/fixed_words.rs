//! The words of the golden pipeline never change unintentionally: hashes of vectors from fixed seeds, committed before crates were moved.
//! A changed hash means a changed contract (docs/contract.md), never a refactoring.

use edof_core::draw::Draw;
use edof_core::number::bits_of;
use edof_core::storage::digest::sha256;
use edof_core::{CfaPhase, RawFrame, Stride, Window};
use edof_golden::{Display, Golden, Trace, scalar};
use edof_network::network::{Form, Recurrence, Shrinkage};
use ndarray::Array2;

/// A form by its numbers: window, codes, layers, one-sided, difference, with R.
const fn form(
    window: Window,
    codes: usize,
    layers: usize,
    [one_sided, difference, linear_path]: [bool; 3],
) -> Form {
    Form {
        window,
        codes,
        layers,
        shrinkage: if one_sided { Shrinkage::OneSided } else { Shrinkage::TwoSided },
        recurrence: if difference { Recurrence::Difference } else { Recurrence::Direct },
        linear_path,
        tied: false,
        exposures: 1,
    }
}

fn forms() -> [Form; 4] {
    let window = |side| Window::new(side).unwrap();
    [
        form(window(8), 192, 4, [true, true, false]),
        form(window(12), 192, 4, [false, false, true]),
        form(window(16), 70, 10, [false, true, true]),
        form(window(8), 33, 2, [true, false, true]),
    ]
}

/// Every word at every boundary and every count, in the order of the stages.
fn bytes(trace: &Trace) -> Vec<u8> {
    let words = |words: &[i16]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let mut all = words(bits_of(&trace.input));
    for layer in &trace.layers {
        all.extend([&layer.b, &layer.z, &layer.sent].into_iter().flat_map(|plane| words(plane)));
    }
    all.extend(words(bits_of(&trace.output)));
    for stage in &trace.stages {
        all.extend([stage.saturations(), stage.nonzeros].into_iter().flat_map(u64::to_le_bytes));
    }
    all
}

#[test]
fn words_at_every_boundary_of_fixed_seeds_keep_their_hash() {
    let mut all = Vec::new();
    for (seed, form) in (1..).zip(forms()) {
        let network = edof_device::random::extreme(form, 16, Stride::PATCH, false, seed);
        let draw = &mut Draw::new(seed);
        for _ in 0..8 {
            let window = edof_device::random::extreme_window(draw, form.window.pixels());
            all.extend(bytes(&scalar::run(&network, &window)));
        }
    }
    assert_eq!(sha256(&all), "2dfc6bc51e8d945b0002da6959b39738d19a6a0d26f3ecdfbc261889fd7a5b68");
}

#[test]
fn codes_on_the_wire_of_fixed_seeds_keep_their_hash() {
    let mut all = Vec::new();
    for (seed, stride) in [(5, 8), (6, 4), (7, 2)] {
        let network = edof_device::random::natural(12, stride, seed);
        let draw = &mut Draw::new(seed);
        let values =
            Array2::from_shape_fn((40, 56), |(i, j)| (draw.whole(0, 900) + 60 * (i + j) as i64) as u16);
        for phase in CfaPhase::ALL {
            let raw = RawFrame::from_values(values.clone(), 14, phase).unwrap();
            let frame = Golden::new(network.clone()).unwrap().frame(&raw).unwrap();
            all.extend(frame.picture(&Display::default()).0.yuyv());
        }
    }
    assert_eq!(sha256(&all), "cdeb151754844d622c599e322cede180f06dbe0cf4de5a121d0820ae19c1cffc");
}
