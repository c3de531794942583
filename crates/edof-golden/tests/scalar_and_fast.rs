//! The fast pipeline equals the specification at every stage boundary, word for word and count for count.

use edof_core::draw::Draw;
use edof_core::number::InputWord;
use edof_core::{CfaPhase, RawFrame, Stride, Window};
use edof_golden::fast::{Fast, Isa};
use edof_golden::frame::scalar_frame;
use edof_golden::{Golden, scalar};
use edof_network::FixedNetwork;
use edof_network::network::{Form, Recurrence, Shrinkage};
use ndarray::Array2;
use proptest::prelude::*;

/// Any form: every shrinkage, direct and difference, T = 2…10, with and without R, tied or not, every window.
fn forms() -> impl Strategy<Value = Form> {
    let codes = prop_oneof![6 => 1usize..70, 2 => 120usize..200, 1 => Just(192), 1 => 250usize..330];
    let flags = (prop::sample::select(&Shrinkage::ALL[..]), any::<bool>(), any::<bool>(), any::<bool>());
    (prop::sample::select(vec![8, 12, 16]), codes, 2usize..=10, flags).prop_map(
        |(window, codes, layers, (shrinkage, difference, linear_path, tied))| Form {
            window: Window::new(window).unwrap(),
            codes,
            layers,
            shrinkage,
            recurrence: if difference { Recurrence::Difference } else { Recurrence::Direct },
            linear_path,
            tied,
            exposures: 1,
        },
    )
}

fn networks() -> impl Strategy<Value = FixedNetwork> {
    let stride = prop::sample::select(vec![2, 4, 8]);
    (forms(), 8u32..=16, stride, prop::bool::weighted(0.2), any::<u64>()).prop_map(
        |(form, bits, stride, tight, seed)| {
            let network = edof_device::random::extreme(form, bits, Stride::new(stride).unwrap(), tight, seed);
            network.check().unwrap();
            network
        },
    )
}

fn assert_same_traces(network: &FixedNetwork, windows: &[InputWord]) {
    let pixels = network.form.window.pixels();
    let specified: Vec<_> = windows.chunks(pixels).map(|y| scalar::run(network, y)).collect();
    for isa in Isa::available() {
        let traces = Fast::with_isa(network.clone(), isa).traces(windows);
        assert_eq!(traces.len(), specified.len());
        for (patch, (fast, scalar)) in traces.iter().zip(&specified).enumerate() {
            assert_eq!(fast, scalar, "{isa:?}, patch {patch}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 160, failure_persistence: None, ..ProptestConfig::default() })]

    /// 160 networks × 65 windows on every instruction set: more than 10,000 windows at the ends of their range.
    #[test]
    fn every_boundary_of_extreme_windows_is_the_same(network in networks(), seed: u64) {
        let draw = &mut Draw::new(seed);
        let pixels = network.form.window.pixels();
        let windows: Vec<InputWord> = (0..65).flat_map(|_| edof_device::random::extreme_window(draw, pixels)).collect();
        assert_same_traces(&network, &windows);
    }

    /// Whole frames of every CFA phase, odd numbers of patches, all strides.
    #[test]
    fn every_pixel_and_count_of_small_frames_is_the_same(
        network in networks().prop_filter("small", |n| n.form.codes < 70),
        rows in 9usize..16, columns in 9usize..26, phase in 0usize..4, seed: u64,
    ) {
        let draw = &mut Draw::new(seed);
        let values = Array2::from_shape_fn((2 * rows, 2 * columns), |_| draw.extreme(16) as u16);
        let raw = RawFrame::from_values(values, 16, CfaPhase::ALL[phase]).unwrap();
        let specified = scalar_frame(&network, &raw).unwrap();
        prop_assert_eq!(Golden::new(network).unwrap().frame(&raw).unwrap(), specified);
    }
}

/// 512 of the largest products are more than a kernel's sum holds; such a network runs as the specification says it, patch by patch.
#[test]
fn words_that_are_all_at_one_end_are_the_same() {
    for (window, codes, bits) in [(8, 192, 16), (12, 192, 8), (16, 192, 16), (8, 520, 16)] {
        let form = Form {
            window: Window::new(window).unwrap(),
            codes,
            layers: 4,
            shrinkage: Shrinkage::OneSided,
            recurrence: Recurrence::Difference,
            linear_path: true,
            tied: false,
            exposures: 1,
        };
        let mut network = edof_device::random::extreme(form, bits, Stride::PATCH, false, 1);
        let min = -1i16 << (bits - 1);
        network.recurrent.iter_mut().for_each(|s| s.weights.fill(min));
        network.analysis.weights.fill(min);
        network.thresholds.iter_mut().for_each(|theta| theta.fill(min));
        network.check().unwrap();
        let pixels = form.window.pixels();
        let windows =
            [InputWord::ZERO, InputWord::MAX, InputWord::DELTA].map(|word| vec![word; pixels]).concat();
        assert_same_traces(&network, &windows);
    }
}

#[test]
fn a_network_like_a_trained_one_is_the_same_and_sparse() {
    let network = edof_device::random::natural(12, 8, 5);
    let draw = &mut Draw::new(9);
    let windows: Vec<InputWord> = (0..200)
        .flat_map(|_| {
            let level = draw.whole(500, 30_000);
            let word = |noise: i64| InputWord::from_bits((level + noise) as i16);
            (0..144).map(|_| word(draw.whole(-400, 400))).collect::<Vec<_>>()
        })
        .collect();
    assert_same_traces(&network, &windows);
    let traces = Fast::new(network).traces(&windows);
    let nonzeros: u64 = traces.iter().flat_map(|t| &t.stages).map(|s| s.nonzeros).sum();
    let a_layer = nonzeros as f64 / (200.0 * 3.0);
    assert!((5.0..120.0).contains(&a_layer), "{a_layer} non-zeros a layer");
}
