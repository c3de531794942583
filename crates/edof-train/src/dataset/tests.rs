use super::*;
use ndarray::Array3;

fn marked() -> ColourFrame {
    let planes = Array3::from_shape_fn((3, 256, 256), |(c, row, column)| {
        [row as f32 / 255.0, column as f32 / 255.0, 0.5][c]
    });
    ColourFrame { planes }
}

/// A photograph whose planes tell where each pixel lies, behind a lens that does not blur at all (in focus, wide open).
fn marked_dataset(window: usize, tone: Tone, variants: usize) -> Dataset {
    let mut camera = Camera::resolve("clear").unwrap();
    camera.aperture_radius_mm = 8.0;
    let plain = DatasetOptions::plain(&[0.0], Window::new(window).unwrap());
    let augmentation = Augmentation { variants, saturation: [1.0; 2], hue: 0.0, scale: 0.7 };
    let options = DatasetOptions { tone, augmentation, ..plain };
    Dataset::new(&[marked()], &camera, options, |_, _| ControlFlow::Continue(())).unwrap().unwrap()
}

fn silent() -> Conditions {
    Conditions { noiseless: 1, ..Conditions::plain(0.015) }
}

fn place_of(target: &[f32]) -> (f32, f32) {
    let mean = |plane: usize| target[plane * 64..][..64].iter().sum::<f32>() / 64.0 * 255.0;
    (mean(0), mean(1))
}

#[test]
fn windows_see_the_mosaic_around_their_patch() {
    for variants in [1, 3] {
        let dataset = marked_dataset(12, Tone::Linear, variants);
        let mut batch = Batch::new(dataset.inputs(), 200);
        dataset.draw(&mut Random::new(1, 2, 3), &silent(), &mut batch);
        for (input, target) in batch.inputs.chunks(144).zip(batch.targets.chunks(192)) {
            // Red and green are linear in place, so the mean of a centred window is that of its patch.
            let (row, column) = place_of(target);
            let sites =
                |r: usize, c: usize| (0..36).map(move |i| input[(i / 6 * 2 + r) * 12 + i % 6 * 2 + c]);
            let mean = |r, c| sites(r, c).sum::<f32>() / 36.0 * 255.0;
            assert!((mean(0, 0) - row).abs() < 2.0, "red sites hold rows");
            assert!((0.5 * (mean(0, 1) + mean(1, 0)) - column).abs() < 2.0, "green sites hold columns");
            assert!((mean(1, 1) / 255.0 - 0.5).abs() < 0.01, "blue sites hold a half");
        }
    }
}

#[test]
fn windows_of_a_single_colour_have_it_at_every_site_and_reach_the_ends_of_each_channel() {
    let dataset = marked_dataset(12, Tone::Srgb, 1);
    let mut batch = Batch::new(dataset.inputs(), 200);
    let conditions = Conditions { noiseless: 1, flat: 1, ..Conditions::plain(0.015) };
    dataset.draw(&mut Random::new(1, 2, 3), &conditions, &mut batch);
    let mut ends = [[0; 3]; 2];
    for (input, target) in batch.inputs.chunks(144).zip(batch.targets.chunks(192)) {
        let colour = [0, 1, 2].map(|plane| target[plane * 64]);
        assert!((0..3).all(|plane| target[plane * 64..][..64].iter().all(|v| *v == colour[plane])));
        for (i, v) in input.iter().enumerate() {
            assert_eq!(*v, colour[[[0, 1], [1, 2]][i / 12 % 2][i % 2]]);
        }
        for (plane, v) in colour.into_iter().enumerate() {
            ends[0][plane] += u32::from(v == 0.0);
            ends[1][plane] += u32::from(v > 0.9999);
        }
    }
    assert!(ends.iter().flatten().all(|count| (25..75).contains(count)), "a quarter of 200 each: {ends:?}");
}

#[test]
fn windows_hold_values_of_the_tone_and_validation_windows_come_from_the_corner_block() {
    for tone in Tone::ALL {
        let dataset = marked_dataset(8, tone, 1);
        let mut batch = Batch::new(dataset.inputs(), 300);
        let place = Place { photo: 0, psi: 0 };
        dataset.draw_validation(&mut Random::new(1, 0, 0), place, Noise::None, &mut batch);
        // The first photograph's block is its first quarter of rows and columns; the lens hardly blurs, so both tones hold the photograph's values.
        let max = 63.0 / 255.0 + 1e-3;
        assert!(batch.targets.chunks(64).take(2).all(|plane| plane.iter().all(|v| *v <= max)), "{tone}");
        assert!((batch.targets[128] - 0.5).abs() < 1e-4, "{tone}");
        assert!((batch.inputs[9] - 0.5).abs() < 1e-3, "{tone}: blue at its site");
    }
}

#[test]
fn the_sensor_sees_light_and_its_values_are_encoded_afterwards() {
    let dataset = marked_dataset(8, Tone::Srgb, 1);
    let mut batch = Batch::new(dataset.inputs(), 4_000);
    let noise = Noise::sensor(8.0);
    dataset.draw_validation(&mut Random::new(1, 0, 0), Place { photo: 0, psi: 0 }, noise, &mut batch);
    let light = Tone::Srgb.decode(0.5);
    let errors = batch.inputs.chunks(64).map(|window| f64::from(Tone::Srgb.decode(window[9]) - light));
    let variance = errors.map(|e| e * e).sum::<f64>() / 4_000.0;
    let expected = noise.variance(light.into());
    assert!((variance / expected - 1.0).abs() < 0.1, "{variance} {expected}");
}

#[test]
fn exposure_lifts_input_and_target_alike_and_clips_at_white() {
    let dataset = marked_dataset(8, Tone::Linear, 1);
    let drawn = |factor| {
        let mut batch = Batch::new(dataset.inputs(), 50);
        let conditions = Conditions { exposure: [factor; 2], ..silent() };
        dataset.draw(&mut Random::new(4, 0, 0), &conditions, &mut batch);
        batch
    };
    let (once, twice) = (drawn(1.0), drawn(2.0));
    for (one, two) in [(&once.inputs, &twice.inputs), (&once.targets, &twice.targets)] {
        assert!(one.iter().zip(two).all(|(a, b)| ((2.0 * a).min(1.0) - b).abs() < 1e-6));
    }
}

#[test]
fn the_same_seed_draws_the_same_batch_and_each_window_its_own_noise() {
    let dataset = marked_dataset(8, Tone::Linear, 2);
    let drawn = |seed| {
        let mut batch = Batch::new(dataset.inputs(), 16);
        dataset.draw(&mut Random::new(seed, 7, 0), &Conditions::plain(0.01), &mut batch);
        batch
    };
    assert_eq!(drawn(1), drawn(1));
    assert_ne!(drawn(1), drawn(2));
    // The same place again and again: only noise differs, and the noise of one window is independent of the next.
    let mut batch = Batch::new(dataset.inputs(), 20_000);
    let noise = Noise::gaussian(0.01);
    dataset.draw_validation(&mut Random::new(1, 0, 0), Place { photo: 0, psi: 0 }, noise, &mut batch);
    let blue: Vec<f32> = batch.inputs.chunks(64).map(|window| (window[9] - 0.5) / 0.01).collect();
    let mean = |values: &mut dyn Iterator<Item = f32>| values.sum::<f32>() / 20_000.0;
    assert!(mean(&mut blue.iter().copied()).abs() < 0.03);
    assert!((mean(&mut blue.iter().map(|v| v * v)) - 1.0).abs() < 0.04);
    assert!(mean(&mut blue.windows(2).map(|w| w[0] * w[1])).abs() < 0.03);
}

/// Windows of a clear lens at these foci.
fn focused_at(foci: &[f64], noise: Noise) -> Batch {
    let camera = Camera { focus_psi: foci[0], ..Camera::resolve("clear").unwrap() };
    let plain = DatasetOptions::plain(&[0.0, 1.0, 8.0], Window::PATCH);
    let options = DatasetOptions { further_foci: foci[1..].to_vec(), ..plain };
    let photo = marked();
    let dataset =
        Dataset::new(&[photo], &camera, options, |_, _| ControlFlow::Continue(())).unwrap().unwrap();
    let mut batch = Batch::new(dataset.inputs(), 300);
    let place = Place { photo: 0, psi: 1 };
    dataset.draw_validation(&mut Random::new(1, 2, 3), place, noise, &mut batch);
    batch
}

#[test]
fn a_window_of_two_exposures_is_the_same_place_seen_at_either_focus() {
    // Both foci are equally far from an end of the range, so that blurs reach equally far.
    let [near, far] = [[2.0], [6.0]].map(|foci| focused_at(&foci, Noise::None));
    assert_eq!(near.targets, far.targets);
    assert_ne!(near.inputs, far.inputs);
    for (foci, halves) in [([2.0, 6.0], [&near, &far]), ([6.0, 2.0], [&far, &near])] {
        let both = focused_at(&foci, Noise::None);
        assert_eq!(both.targets, near.targets);
        for (index, window) in both.inputs.chunks(128).enumerate() {
            let alone = halves.map(|half| &half.inputs[index * 64..][..64]);
            assert_eq!(window, alone.concat(), "window {index} at foci {foci:?}");
        }
    }
}

#[test]
fn every_exposure_has_noise_of_its_own() {
    let noise = Noise::gaussian(0.01);
    let noisy = focused_at(&[2.0, 6.0], noise);
    // Blue is a half everywhere.
    let blue = |at: usize| noisy.inputs.chunks(128).map(move |window| (window[at] - 0.5) / 0.01);
    let mean = |values: &mut dyn Iterator<Item = f32>| values.sum::<f32>() / 300.0;
    assert!((mean(&mut blue(64 + 9).map(|v| v * v)) - 1.0).abs() < 0.3);
    assert!(mean(&mut blue(9).zip(blue(64 + 9)).map(|(a, b)| a * b)).abs() < 0.2);
}

#[test]
fn windows_are_turned_only_as_the_blur_allows() {
    let camera = Camera::resolve("ring-outer").unwrap();
    let lens = channel_psfs(&camera, 3.0, &Settings::default()).unwrap();
    assert_eq!(turns(std::slice::from_ref(&lens)), [0, 1, 2, 3, 4, 5, 6, 7]);
    let leaning = |kernel: [[f32; 3]; 3]| {
        let kernel = ndarray::Array2::from_shape_fn((3, 3), |(r, c)| kernel[r][c]);
        [lens[0].clone(), Psf::new(kernel).unwrap(), lens[2].clone()]
    };
    let up = leaning([[0.0, 0.3, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.0]]);
    assert_eq!(turns(&[lens.clone(), up]), [0, 2]);
    let flat = leaning([[0.0, 0.0, 0.0], [0.2, 0.6, 0.2], [0.0, 0.0, 0.0]]);
    assert_eq!(turns(&[flat]), [0, 1, 2, 3]);
    let slanted = leaning([[0.3, 0.0, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, 0.0]]);
    assert_eq!(turns(&[slanted]), [0, 4]);
}

#[test]
fn no_photos_and_small_photos_are_rejected() {
    let camera = Camera::resolve("clear").unwrap();
    let make = |photos: &[ColourFrame], variants: usize| {
        let plain = DatasetOptions::plain(&[0.0], Window::new(8).unwrap());
        let augmentation = Augmentation { variants, ..Augmentation::NONE };
        let options = DatasetOptions { augmentation, ..plain };
        Dataset::new(photos, &camera, options, |_, _| ControlFlow::Continue(())).unwrap_err().to_string()
    };
    assert_eq!(make(&[], 1), "training photos: none given, at least one is needed");
    assert!(
        make(&[ColourFrame::zeros(30, 30)], 1)
            .starts_with("training photo 0: 30x30, both sides should be at least ")
    );
    assert_eq!(make(&[marked()], 0), "variants 0: must be 1 or more");
}
