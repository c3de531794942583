use super::*;
use edof_core::camera::Camera;
use edof_core::draw::Draw;
use edof_core::{ColourFrame, Stride, Tone, Window};
use edof_network::network::{Recurrence, Shrinkage};
use edof_train::dataset::DatasetOptions;
use ndarray::Array3;

const CODES: usize = 4;

/// Four pictures of soft shades at two depths.
fn dataset() -> Dataset {
    let pictures: Vec<ColourFrame> = (0..4)
        .map(|i| ColourFrame {
            planes: Array3::from_shape_fn((3, 256, 256), |(plane, r, c)| {
                let shade = (r as f32 / (9 + i) as f32).sin() + (c as f32 / 7.0).cos();
                0.5 + 0.2 * shade * (1.0 + plane as f32 * 0.1)
            }),
        })
        .collect();
    let plain = DatasetOptions::plain(&[0.0, 1.0], Window::new(8).unwrap());
    let options = DatasetOptions { tone: Tone::Srgb, ..plain };
    let camera = Camera::resolve("clear").unwrap();
    Dataset::new(&pictures, &camera, options, |_, _| ControlFlow::Continue(())).unwrap().unwrap()
}

/// A network whose luma is the mean of its window, and whose codes add a little to it.
fn start(shrinkage: Shrinkage) -> FixedNetwork {
    let form = Form {
        window: Window::new(8).unwrap(),
        codes: CODES,
        layers: 5,
        shrinkage,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    };
    let mut fixed = edof_device::random::extreme(form, 8, Stride::PATCH, false, 3);
    let mut draw = Draw::new(4);
    fixed.code_fractions = vec![6; 4];
    let mut small = |matrix: &mut edof_network::fixed_network::FixedMatrix, fraction: u32, most: i64| {
        matrix.fraction = fraction;
        matrix.weights.mapv_inplace(|_| draw.whole(-most, most) as i16);
    };
    small(&mut fixed.analysis, 9, 60);
    fixed.recurrent.iter_mut().for_each(|s| small(s, 7, 60));
    small(&mut fixed.dictionary, 8, 20);
    fixed.thresholds.iter_mut().for_each(|theta| theta.fill(2));
    let r = fixed.linear_path.as_mut().unwrap();
    r.fraction = 10;
    for (row, mut weights) in r.weights.outer_iter_mut().enumerate() {
        weights.fill(if row < 64 { 16 } else { 0 });
    }
    fixed.check().unwrap();
    fixed
}

fn tuning(steps: u64, rate: f32) -> FinetuneOptions {
    FinetuneOptions { steps, batch: 30, rate, seed: 11 }
}

/// The gradient of one step's windows by one plain pass after the other, in trained coordinates.
fn plain_gradient(tuner: &Tuner<'_>, step: u64) -> Vec<f32> {
    let to_rgb = rgb_map(&fold::output_weights(tuner.words.stride, tuner.words.overlap));
    let mut pass = Simulated::new(tuner.words.form, &code_formats(&tuner.words), &to_rgb, 8);
    let mut gradient = vec![0.0; tuner.values.len()];
    for part in 0..4 {
        let mut batch = Batch::new(tuner.dataset.inputs(), 8);
        tuner.dataset.draw(&mut Random::new(11, step, part), &tuner.conditions, &mut batch);
        let error = |cell: &u32| Some(tuner.cell_errors[*cell as usize]).filter(|error| *error != 0.0);
        let importance: Vec<f32> =
            batch.cells.iter().map(|cell| error(cell).unwrap_or(0.192).recip()).collect();
        pass.gradient(&tuner.values, &batch.examples(&importance), &mut [0.0; 8], &mut gradient);
    }
    let mut scratch = gradient.clone();
    tuner.condition.pull_back(&mut gradient, &mut scratch);
    gradient
}

#[test]
fn a_step_moves_weights_down_the_gradient_by_the_rate_of_its_share_of_the_steps() {
    let (dataset, fixed, tuning) = (dataset(), start(Shrinkage::OneSided), tuning(8, 0.5));
    let mut tuner = Tuner::new(&fixed, &dataset, &tuning);
    assert_eq!(tuner.rates, vec![0.5f32.powi(7); tuner.values.len()]);
    for step in 1..=8u32 {
        // Adam's first step has the length of the rate.
        tuner.adam = Adam::new(tuner.values.len());
        let expected = plain_gradient(&tuner, step.into());
        let (before, words, cells) = (tuner.weights.clone(), tuner.words.clone(), tuner.cell_errors.clone());
        tuner.step(step.into());
        let gradient = &tuner.parts[0].gradient;
        let most = expected.iter().fold(0.0, |most: f32, g| most.max(g.abs()));
        assert!(gradient.iter().zip(&expected).all(|(g, e)| (g - e).abs() <= 1e-4 * most), "step {step}");
        // A, three S and F: five shares.
        let progress = 0.625 * (step - 1) as f32;
        let rate = 0.25 * (1.0 + (std::f32::consts::PI * progress.fract()).cos()) / 128.0;
        for ((after, before), g) in tuner.weights.iter().zip(&before).zip(gradient) {
            if g.abs() > 1e-2 * most {
                let wanted = -rate * g.signum();
                assert!((after - before - wanted).abs() <= 1e-3 * rate + 2e-6 * before.abs(), "step {step}");
            }
        }
        assert!(step > 1 || tuner.words.analysis != words.analysis);
        assert!(step < 3 || tuner.words.analysis == words.analysis);
        for (index, settled) in [5, 6, 8].into_iter().enumerate() {
            assert!(step < settled || tuner.words.recurrent[index] == words.recurrent[index]);
        }
        assert_eq!(tuner.values, Folded::of(&tuner.words).flatten());
        let mut remembered = cells;
        for part in &tuner.parts {
            remember(&mut remembered, &part.batch.cells, &part.errors);
        }
        assert!(remembered == tuner.cell_errors && remembered.iter().any(|error| *error > 0.0));
    }
}

#[test]
fn thresholds_stay_at_zero_or_above_where_the_shrinkage_has_no_negative_ones() {
    let (dataset, tuning) = (dataset(), tuning(1, 0.0));
    for shrinkage in Shrinkage::ALL {
        let fixed = start(shrinkage);
        let mut tuner = Tuner::new(&fixed, &dataset, &tuning);
        let theta = tuner.layout.thresholds[1].clone();
        tuner.weights[theta].fill(-0.5);
        tuner.round(0);
        let word = if shrinkage.allows_negative() { -32 } else { 0 };
        assert!(tuner.words.thresholds[1].iter().all(|t| *t == word), "{shrinkage:?}");
        assert_eq!(tuner.words.thresholds[0], fixed.thresholds[0]);
    }
}

#[test]
fn validation_is_the_mean_over_photos_depths_and_noise() {
    let (dataset, fixed, tuning) = (dataset(), start(Shrinkage::OneSided), tuning(1, 0.1));
    let mut tuner = Tuner::new(&fixed, &dataset, &tuning);
    assert_eq!(tuner.validation.len(), 16);
    let to_rgb = rgb_map(&fold::output_weights(fixed.stride, fixed.overlap));
    let mut pass = Simulated::new(fixed.form, &code_formats(&fixed), &to_rgb, 64);
    let each = tuner.validation.iter().map(|set| psnr_db(pass.forward(&tuner.values, &set.inputs, 64), set));
    let mean = each.sum::<f64>() / 16.0;
    let found = tuner.validate();
    assert!((found - mean).abs() < 1e-9, "{found} {mean}");
    let mut inputs: Vec<&Vec<f32>> = tuner.validation.iter().map(|set| &set.inputs).collect();
    inputs.sort_by(|a, b| a.partial_cmp(b).unwrap());
    inputs.dedup();
    assert_eq!(inputs.len(), 16);
}

#[test]
fn steps_that_only_make_it_worse_leave_the_start_and_every_hundredth_and_the_last_are_told() {
    let (dataset, fixed) = (dataset(), start(Shrinkage::OneSided));
    let mut told = vec![];
    let tuned = finetune(&fixed, &dataset, &tuning(101, 1e4), |progress| {
        told.push(*progress);
        ControlFlow::Continue(())
    });
    assert_eq!(told.iter().map(|p| p.step).collect::<Vec<_>>(), [0, 100, 101]);
    assert!(told[1..].iter().all(|p| p.validation_db < told[0].validation_db), "{told:?}");
    assert!(told.iter().all(|p| p.best_db == told[0].validation_db));
    assert_eq!(tuned, fixed);
}

#[test]
fn steps_that_help_come_out_and_a_break_ends_the_work() {
    let (dataset, fixed) = (dataset(), start(Shrinkage::OneSided));
    let mut told = vec![];
    let tuned = finetune(&fixed, &dataset, &tuning(40, 0.5), |progress| {
        told.push(*progress);
        ControlFlow::Continue(())
    });
    assert!(told[1].validation_db > told[0].validation_db, "{told:?}");
    assert_eq!(told[1].best_db, told[1].validation_db);
    assert_ne!(tuned, fixed);
    let mut calls = 0;
    let stopped = finetune(&fixed, &dataset, &tuning(40, 0.5), |_| {
        calls += 1;
        ControlFlow::Break(())
    });
    assert_eq!((calls, stopped), (1, fixed));
}

#[test]
fn of_two_networks_that_are_equally_good_the_earlier_comes_out() {
    let (dataset, mut fixed) = (dataset(), start(Shrinkage::TwoSided));
    // A code that is always zero, so that its threshold, which any step lifts to 0, makes no difference.
    fixed.analysis.weights.row_mut(0).fill(0);
    fixed.thresholds[0][0] = -5;
    let mut told = vec![];
    let tuned = finetune(&fixed, &dataset, &tuning(1, 0.0), |progress| {
        told.push(progress.validation_db);
        ControlFlow::Continue(())
    });
    assert_eq!((told[0], tuned), (told[1], fixed));
}
