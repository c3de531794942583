//! Integers stand for the float network: every layer's words are its values, to the LSB.

use edof_core::camera::Camera;
use edof_core::draw::Draw;
use edof_core::overlap::Overlap;
use edof_core::storage::provenance::Provenance;
use edof_core::{CfaPhase, ColourFrame, Geometry, RawFrame, Reconstructor, Stride, Tone, Window};
use edof_golden::{Golden, GoldenReconstructor, scalar};
use edof_network::Network;
use edof_network::float::parameters::flatten;
use edof_network::float::pass::Pass;
use edof_network::float::reconstruct::{FloatReconstructor, Output};
use edof_network::network::{Form, NetworkError, Origin, Recurrence, Shrinkage};
use edof_optics::{Sensor, expose};
use edof_quantize::{
    Calibration, FinetuneOptions, FinetuneProgress, QuantizeError, QuantizeOptions, finetune, fold, quantize,
};
use edof_train::dataset::{Dataset, DatasetOptions};
use edof_train::noise::Conditions;
use edof_train::recipe::Recipe;
use edof_train::train::Trainer;
use ndarray::{Array1, Array2, Array3};
use proptest::prelude::*;
use std::ops::ControlFlow;

fn forms() -> impl Strategy<Value = Form> {
    let flags = (prop::sample::select(&Shrinkage::ALL[..]), any::<bool>(), any::<bool>(), any::<bool>());
    (prop::sample::select(vec![8, 12, 16]), 2usize..=10, flags).prop_map(
        |(window, layers, (shrinkage, difference, linear_path, tied))| Form {
            window: Window::new(window).unwrap(),
            codes: 40,
            layers,
            shrinkage,
            recurrence: if difference { Recurrence::Difference } else { Recurrence::Direct },
            linear_path,
            tied,
            exposures: 1,
        },
    )
}

fn form(layers: usize, shrinkage: Shrinkage, linear_path: bool) -> Form {
    Form {
        window: Window::new(8).unwrap(),
        codes: 40,
        layers,
        shrinkage,
        recurrence: Recurrence::Direct,
        linear_path,
        tied: false,
        exposures: 1,
    }
}

/// A network with the proportions of a trained one: four means of the window, the rest differences; coefficients of very
/// different size.
fn network(form: Form, seed: u64) -> Network {
    let mut draw = Draw::new(seed);
    let mut unit = move || draw.whole(-1_000_000, 1_000_000) as f32 * 1e-6;
    let pixels = form.window.pixels();
    let sizes: Vec<f32> = (0..form.codes).map(|i| 10f32.powi(i as i32 % 4 - 2)).collect();
    let mut analysis = Array2::from_shape_fn((form.codes, pixels), |_| unit());
    for (i, mut row) in analysis.outer_iter_mut().enumerate() {
        let mean = row.sum() / pixels as f32;
        row.mapv_inplace(|w| (if i < 4 { 1.0 + 0.5 * w } else { w - mean }) * sizes[i] / pixels as f32);
    }
    let positive = !form.shrinkage.allows_negative();
    let thresholds = (0..form.shrinkages())
        .map(|_| {
            Array1::from_shape_fn(form.codes, |i| {
                let theta = if i < 4 { 0.0 } else { unit() * 0.01 * sizes[i] };
                if positive { theta.abs() } else { theta }
            })
        })
        .collect();
    let recurrent = (0..form.recurrent_matrices())
        .map(|_| {
            Array2::from_shape_fn((form.codes, form.codes), |(r, c)| unit() * 0.05 * sizes[r] / sizes[c])
        })
        .collect();
    let dictionary = Array2::from_shape_fn((192, form.codes), |(_, c)| unit() * 0.1 / sizes[c]);
    let linear_path = form.linear_path.then(|| Array2::from_elem((192, pixels), 0.5 / pixels as f32));
    let origin = Origin::untrained("drawn", Camera::resolve("clear").unwrap());
    Network { form, analysis, thresholds, recurrent, dictionary, linear_path, origin }
}

fn raw(seed: u64) -> RawFrame {
    let mut draw = Draw::new(seed);
    let codes = Array2::from_shape_fn((40, 56), |(r, c)| {
        (2000 + (r / 7 + c / 9) as i64 % 2 * 1500 + draw.whole(-400, 400)) as u16
    });
    RawFrame::from_values(codes, 12, CfaPhase::Rggb).unwrap()
}

fn options(bits: u32) -> QuantizeOptions {
    QuantizeOptions { bits, ..QuantizeOptions::default() }
}

/// For each layer the root mean square over windows of (integer − float), codes in units of 1/scale; and what rounding its
/// weights and results to the chosen fraction bits explains.
fn errors(network: &Network, frame: &RawFrame, options: &QuantizeOptions) -> Vec<(f64, f64)> {
    let calibration = Calibration::measure(network, [frame]).unwrap();
    let (fixed, report) = quantize(network, options, &calibration, "").unwrap();
    let inputs = |layer| if layer == 0 { network.form.window.pixels() } else { network.form.codes };
    let steps = report.iter().enumerate().map(|(layer, l)| {
        let weights: f64 = l.weight_fractions.iter().map(|f| (-f64::from(*f)).exp2()).sum();
        weights * (inputs(layer) as f64).sqrt() * 0.3 + 0.3 * (-f64::from(l.result_fraction)).exp2()
    });
    let explained = steps.scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    });
    let scales = fold::scales(network, &calibration, options);
    let map = fold::output_map(options.stride, options.overlap);
    let g = Geometry::new(network.form.window, Stride::PATCH);
    let (weights, mut pass) = (flatten(network), Pass::new(network.form, 1));
    let mut squares = vec![0.0; network.form.layers];
    let (rows, columns) = g.patches(frame.size().0, frame.size().1);
    for (row, column) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
        let y = edof_golden::windows::window(frame, g, row, column);
        let inputs: Vec<f32> = y.iter().map(|w| w.to_num()).collect();
        let x: Array1<f64> = pass.forward(&weights, &inputs, 1).iter().map(|v| f64::from(*v)).collect();
        let trace = scalar::run(&fixed, &y);
        for (t, codes) in trace.layers.iter().enumerate() {
            let unit = (-f64::from(fixed.code_fractions[t])).exp2();
            for ((word, b), c) in codes.b.iter().zip(pass.b(t)).zip(&scales) {
                squares[t] +=
                    (f64::from(*word) * unit - f64::from(*b) * c).powi(2) / network.form.codes as f64;
            }
        }
        let exact = map.dot(&x);
        let outputs = squares.last_mut().unwrap();
        for (word, exact) in trace.output.iter().zip(&exact) {
            *outputs += (f64::from(*word) - exact).powi(2) / 128.0;
        }
    }
    squares.iter().map(|s| (s / (rows * columns) as f64).sqrt()).zip(explained).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn words_of_every_layer_are_the_float_values(form in forms(), seed: u64, step in prop::sample::select(vec![2, 4, 8])) {
        let network = network(form, seed);
        let stride = Stride::new(step).unwrap();
        let errors = errors(&network, &raw(seed), &QuantizeOptions { stride, ..options(16) });
        for (layer, (error, explained)) in errors.iter().enumerate() {
            prop_assert!(*error < 2.0 * explained, "layer {layer} of {}: {error:e}, {explained:e}", form.layers);
            prop_assert!(*error < 5e-3, "layer {layer} of {}: {error:e}", form.layers);
        }
    }

    #[test]
    fn nothing_saturates_where_it_was_calibrated_at_any_stride(
        form in forms(), seed: u64, bits in 12u32..=16, step in prop::sample::select(vec![2, 4, 8])
    ) {
        let (network, frame) = (network(form, seed), raw(seed));
        // Hardly any headroom: what stride 8 alone has seen would not do for stride 2.
        let stride = Stride::new(step).unwrap();
        let tight = QuantizeOptions { headroom: 1.05, stride, ..options(bits) };
        let calibration = Calibration::measure(&network, [&frame]).unwrap();
        let (fixed, _) = quantize(&network, &tight, &calibration, "hash").unwrap();
        prop_assert_eq!(Golden::new(fixed).unwrap().frame(&frame).unwrap().counts.saturations(), 0);
    }

    #[test]
    fn integers_show_what_their_float_twin_shows_at_every_stride(
        form in forms(), seed: u64, step in prop::sample::select(vec![2, 4, 8])
    ) {
        let (network, frame) = (network(form, seed), raw(seed));
        let stride = Stride::new(step).unwrap();
        let wanted = QuantizeOptions { stride, ..options(16) };
        let calibration = Calibration::measure(&network, [&frame]).unwrap();
        let (fixed, _) = quantize(&network, &wanted, &calibration, "hash").unwrap();
        let float = FloatReconstructor::new(network, stride, wanted.overlap, Output::Ycc422).unwrap();
        let float = float.reconstruct(&frame).unwrap().frame.planes;
        let fixed = GoldenReconstructor::new(fixed, "fixed").unwrap().reconstruct(&frame).unwrap().frame.planes;
        let mean_square = (float - fixed).mapv(|e| e * e).mean().unwrap();
        prop_assert!(mean_square.sqrt() < 4e-3, "{}", mean_square.sqrt());
    }

    #[test]
    fn ranges_are_used_and_accumulators_fit(form in forms(), seed: u64, bits in 10u32..=16) {
        let (network, frame) = (network(form, seed), raw(seed));
        let calibration = Calibration::measure(&network, [&frame]).unwrap();
        let (fixed, report) = quantize(&network, &options(bits), &calibration, "hash").unwrap();
        prop_assert!(report.iter().all(|l| l.accumulator_bits <= 48));
        prop_assert!(report.iter().filter_map(|l| l.range_used).all(|r| (0.1..=0.6).contains(&r)), "{report:?}");
        prop_assert_eq!(Golden::new(fixed).unwrap().frame(&frame).unwrap().counts.saturations(), 0);
    }
}

#[test]
fn more_bits_cost_less() {
    let (network, frame) = (network(form(4, Shrinkage::OneSided, true), 5), raw(6));
    let output = |bits| errors(&network, &frame, &options(bits)).last().unwrap().0;
    let errors = [8, 10, 12, 14].map(output);
    assert!(errors.windows(2).all(|pair| pair[1] < 0.5 * pair[0]), "{errors:?}");
}

#[test]
fn large_outputs_at_few_bits_are_shifted_up_instead_of_rejected() {
    let mut network = network(form(4, Shrinkage::TwoSided, false), 5);
    network.dictionary *= 30.0;
    let seen = Calibration::measure(&network, [&raw(6)]).unwrap();
    let (fixed, _) = quantize(&network, &options(8), &seen, "").unwrap();
    let shifts = fixed.final_shifts();
    assert!(shifts.dictionary > 0 && shifts.result == 0, "{shifts:?}");
}

#[test]
fn wrong_options_and_empty_calibrations_are_rejected() {
    let good = network(form(3, Shrinkage::TwoSided, false), 1);
    let seen = Calibration::measure(&good, [&raw(1)]).unwrap();
    let refused =
        |n: &Network, o: &QuantizeOptions, c: &Calibration| quantize(n, o, c, "").unwrap_err().to_string();
    assert_eq!(refused(&good, &options(7), &seen), "7 bits: code_bits 7: must be 8 to 16");
    let tight = QuantizeOptions { headroom: 0.5, ..options(16) };
    assert_eq!(refused(&good, &tight, &seen), "headroom 0.5: must be 1 or more");
    assert_eq!(
        refused(&good, &options(16), &Calibration::new(&good.form)),
        "calibration: no windows seen, expected at least one raw frame"
    );
    let longer = network(form(4, Shrinkage::TwoSided, false), 1);
    let other = Calibration::measure(&longer, [&raw(1)]).unwrap();
    assert_eq!(refused(&good, &options(16), &other), "calibration: measured on a network of another form");
    let mut broken = good.clone();
    broken.thresholds.pop();
    let error = quantize(&broken, &options(16), &seen, "").unwrap_err();
    assert!(matches!(error, QuantizeError::Network(NetworkError::Count { what: "thresholds", .. })));
    let mut double = good.clone();
    double.form.exposures = 2;
    let told = Calibration::measure(&double, [&raw(1)]).unwrap_err().to_string();
    assert!(told.starts_with("exposures 2: must be 1 here"), "{told}");
    let mut large = good;
    large.dictionary.fill(1e9);
    assert!(refused(&large, &options(16), &seen).starts_with("dictionary: value "));
}

#[test]
fn the_averaging_window_is_stated_in_the_integers() {
    let network = network(form(3, Shrinkage::TwoSided, true), 1);
    let seen = Calibration::measure(&network, [&raw(1)]).unwrap();
    let stride = Stride::new(4).unwrap();
    let wanted = QuantizeOptions { stride, overlap: Overlap::Flat, ..options(12) };
    let (fixed, _) = quantize(&network, &wanted, &seen, "abc").unwrap();
    assert_eq!((fixed.stride, fixed.overlap, fixed.code_bits), (stride, Overlap::Flat, 12));
    assert_eq!(fixed.float_hash, "abc");
}

/// Four synthetic pictures with edges and shades, large enough to hold validation tiles.
fn pictures() -> Vec<ColourFrame> {
    (0..4u64)
        .map(|seed| {
            let mut draw = Draw::new(seed);
            let levels: Vec<f32> = (0..3 * 16 * 16).map(|_| draw.whole(50, 950) as f32 * 1e-3).collect();
            ColourFrame {
                planes: Array3::from_shape_fn((3, 256, 256), |(plane, r, c)| {
                    let shade = 0.1 * ((r as f32 / 9.0).sin() + (c as f32 / 7.0).cos());
                    (levels[plane * 256 + r / 16 * 16 + c / 16] + shade).clamp(0.0, 1.0)
                }),
            }
        })
        .collect()
}

#[test]
fn fine_tuning_wins_back_what_eight_bits_cost_and_repeats() {
    let camera = Camera::resolve("clear").unwrap();
    let window = Window::new(8).unwrap();
    let plain = DatasetOptions::plain(&[0.0, 2.0], window);
    let dataset =
        Dataset::new(&pictures(), &camera, plain, |_, _| ControlFlow::Continue(())).unwrap().unwrap();
    let form = Form { codes: 32, ..form(4, Shrinkage::OneSided, true) };
    let recipe = Recipe {
        steps: 300,
        batch: 128,
        validate_every: 100,
        conditions: Conditions::plain(0.01),
        budget: None,
        tone: Tone::Linear,
        ..Recipe::new(form)
    };
    let mut trainer = Trainer::new(recipe, &dataset, 2).unwrap();
    trainer.run(|_, _| ControlFlow::Continue(())).unwrap();
    let network = trainer.best("small", &camera, Provenance::default());
    let scenes: Vec<RawFrame> = pictures().iter().map(|p| expose(p, &Sensor::default()).unwrap()).collect();
    let calibration = Calibration::measure(&network, &scenes).unwrap();
    let (fixed, _) = quantize(&network, &options(8), &calibration, "").unwrap();
    let tuning = FinetuneOptions { steps: 200, batch: 128, ..FinetuneOptions::default() };
    let tune = || {
        let mut seen = vec![];
        let tell = |p: &FinetuneProgress| {
            seen.push(p.validation_db);
            ControlFlow::Continue(())
        };
        (finetune(&fixed, &dataset, &tuning, tell), seen)
    };
    let (tuned, db) = tune();
    assert_eq!(db.len(), 3);
    assert!(db[2] > db[0] + 0.1, "{db:?}");
    assert_eq!(tuned.code_fractions, fixed.code_fractions);
    assert_ne!(tuned.dictionary, fixed.dictionary);
    assert_eq!(tune(), (tuned, db));
}
