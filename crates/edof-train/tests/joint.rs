//! Lens and network together: the gradient through network, mosaic and blur, and rounds of a search.

use edof_core::camera::{Aberration, Camera, Delay, Monomial, Polynomial, Zernike};
use edof_core::{ColourFrame, Tone, Window};
use edof_network::float::parameters::{Layout, unflatten};
use edof_network::network::{Form, Network, Origin, Recurrence, Shrinkage};
use edof_numerics::random::Random;
use edof_optics::psf::{Settings, channel_psfs};
use edof_train::dataset::{Dataset, DatasetOptions};
use edof_train::initial::initial;
use edof_train::joint::{Joint, random_lens, values, with_values};
use edof_train::recipe::Recipe;
use edof_train::structure::Structure;
use ndarray::Array3;
use std::ops::ControlFlow;

fn photo(side: usize) -> ColourFrame {
    let mut random = Random::new(9, 0, 0);
    let mut leaves: Vec<([f32; 3], [f32; 3])> = vec![];
    for _ in 0..160 {
        leaves.push(([(); 3].map(|()| random.unit()), [(); 3].map(|()| 0.1 + 0.8 * random.unit())));
    }
    let planes = Array3::from_shape_fn((3, side, side), |(c, row, column)| {
        let [y, x] = [row, column].map(|i| i as f32 / side as f32);
        let on = |[r, u, v]: [f32; 3]| (y - u).abs() < 0.2 * r && (x - v).abs() < 0.2 * r;
        leaves.iter().rev().find(|(shape, _)| on(*shape)).map_or(0.5, |(_, colour)| colour[c])
    });
    ColourFrame { planes }
}

fn joint() -> Joint {
    let form = Form {
        window: Window::new(12).unwrap(),
        codes: 24,
        layers: 3,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    };
    let recipe = Recipe {
        tone: Tone::Linear,
        budget: None,
        lambda: vec![1e-5],
        batch: 64,
        steps: 20,
        ..Recipe::new(form)
    };
    Joint {
        recipe,
        psis: vec![1.0, 6.5],
        noises: vec![0.0, 0.01],
        worst_weight: 0.5,
        max_phase: 10.0,
        rounds: 3,
        windows: 64,
        threads: 2,
    }
}

/// How the search computes PSFs.
fn settings() -> Settings {
    Settings { energy: 0.99, ..Settings::default() }
}

fn dataset(joint: &Joint, camera: &Camera) -> Dataset {
    let options = DatasetOptions { settings: settings(), ..joint.recipe.dataset(&joint.psis) };
    Dataset::new(&[photo(320)], camera, options, |_, _| ControlFlow::Continue(())).unwrap().unwrap()
}

/// A network that restores a little: its output is fitted to what the rest of it makes of windows.
fn network(joint: &Joint, camera: &Camera) -> Network {
    let mut random = Random::new(4, 0, 0);
    let mut batch = edof_train::dataset::Batch::new(joint.recipe.form.inputs(), 2048);
    dataset(joint, camera).draw(&mut random, &joint.recipe.conditions, &mut batch);
    let weights =
        initial(&joint.recipe.form, (joint.recipe.start, joint.recipe.structure), &batch, &mut random);
    assert_eq!(weights.len(), Layout::new(&joint.recipe.form).len());
    let origin = Origin {
        name: "start".into(),
        further_foci: vec![],
        camera: camera.clone(),
        conditions: vec![],
        values: Tone::Linear,
        patches: 0,
        validation_db: 0.0,
        non_zeros: vec![],
        provenance: Default::default(),
    };
    unflatten(joint.recipe.form, &weights, origin)
}

/// The camera with one of its parameters moved.
fn moved(camera: &Camera, index: usize, by: f64) -> Camera {
    let mut values = values(camera);
    values[index] += by;
    with_values(camera, &values)
}

#[test]
fn the_lens_gradient_equals_differences_of_the_score() {
    let ring = with_values(&Camera::resolve("ring-outer").unwrap(), &[0.6, 0.93, -3.78, 4.44]);
    check_gradient(&ring, &[2e-3, 2e-3, 2e-2, 2e-2]);
}

#[test]
fn the_gradient_by_coefficients_of_a_polynomial_equals_differences_of_the_score() {
    let terms = [(3, 0, 3.0), (0, 3, -2.0), (2, 1, 0.5)].map(|(x, y, rad)| Monomial { x, y, rad }).to_vec();
    let mask = [Polynomial { at_nm: 500.0, cauchy: Some([1.458, 0.00354]), terms }].into_iter().collect();
    check_gradient(&Camera { mask, ..Camera::resolve("clear-mid").unwrap() }, &[2e-2; 4]);
}

/// Compares the derivatives with differences of at most these steps.
fn check_gradient(camera: &Camera, steps: &[f64]) {
    let joint = joint();
    let state = joint.begin(camera, &network(&joint, camera)).unwrap();
    let judge = |camera: &Camera| joint.judge(&dataset(&joint, camera), camera, &state.weights).unwrap();
    let judged = judge(camera);
    assert_eq!(judged.lens, values(camera));
    let sides = |camera: &Camera| -> Vec<[usize; 3]> {
        let of = |&psi: &f64| channel_psfs(camera, psi, &settings()).unwrap().map(|psf| psf.side());
        joint.psis.iter().map(of).collect()
    };
    assert_eq!(judged.gradient.len(), steps.len());
    for (index, &largest) in steps.iter().enumerate() {
        // Words of 16 bits carry the blurred light, so steps are not small; but no kernel may change its side, and so the windows.
        let mut steps = (0..6).map(|halving| largest / f64::from(1 << halving));
        let same =
            |step: f64| [-step, step].iter().all(|by| sides(&moved(camera, index, *by)) == sides(camera));
        let step = steps.find(|step| same(*step)).expect("kernels whose sides stay");
        let score = |by: f64| judge(&moved(camera, index, by)).score_db;
        let measured = (score(step) - score(-step)) / (2.0 * step);
        let found = judged.gradient[index];
        assert!(
            (found - measured).abs() < 0.05 * measured.abs() + 0.02,
            "parameter {index}: {found}, by differences of {step} {measured}"
        );
    }
}

#[test]
fn rounds_repeat_themselves_and_a_stopped_round_changes_nothing() {
    let joint = joint();
    let camera = random_lens(&Camera::resolve("ring-outer").unwrap(), 2, joint.max_phase, 5);
    camera.check().unwrap();
    let begun = joint.begin(&camera, &network(&joint, &camera)).unwrap();
    let [first, again] = [1, 2].map(|threads| {
        let joint = Joint { threads, ..joint.clone() };
        let mut state = begun.clone();
        for _ in 0..2 {
            assert!(joint.round(&[photo(320)], &mut state, || ControlFlow::Continue(())).unwrap());
        }
        state
    });
    assert_eq!(first, again);
    assert_eq!((first.round, first.history.len()), (2, 2));
    assert!(first.camera != camera && first.camera.check().is_ok());
    let mut stopped = first.clone();
    assert!(!joint.round(&[photo(320)], &mut stopped, || ControlFlow::Break(())).unwrap());
    assert_eq!(stopped, first);
}

#[test]
fn random_lenses_of_any_number_of_rings_are_in_order_and_apart() {
    let base = Camera::resolve("ring-outer").unwrap();
    for (rings, seed) in (0..=25).flat_map(|rings| (0..200).map(move |seed| (rings, seed))) {
        let camera = random_lens(&base, rings, 10.0, seed);
        camera.check().unwrap_or_else(|e| panic!("{rings} rings, seed {seed}: {e}"));
        let edges: Vec<f64> = camera.mask.rings().flat_map(|ring| [ring.inner, ring.outer]).collect();
        assert!(edges.windows(2).all(|pair| pair[1] - pair[0] > 0.02 - 1e-12), "{rings} rings, seed {seed}");
    }
    drop(random_lens(&base, 64, 10.0, 1));
}

#[test]
fn rings_that_a_search_has_no_room_for_are_rejected_before_training() {
    let joint = joint();
    let camera = |rings| random_lens(&Camera::resolve("ring-outer").unwrap(), rings, joint.max_phase, 5);
    let begin = |camera: &Camera| joint.begin(camera, &network(&joint, camera)).map(drop);
    begin(&camera(25)).unwrap();
    assert_eq!(
        begin(&camera(26)).unwrap_err().to_string(),
        "camera ring-outer: has 26 rings, a search takes 25 at most: it keeps rings and gaps 0.02 of the radius wide or wider"
    );
    // Glass of the air's index delays no light, so that no height gives a phase.
    let mut air = camera(2);
    air.mask.rings_mut().nth(1).unwrap().delay = Delay::Etched { height_um: 1.0, cauchy: [1.0, 0.0] };
    let refused = begin(&air).unwrap_err().to_string();
    assert!(refused.starts_with("camera ring-outer: has an etched ring of index 1"), "{refused}");
}

/// Rings of a mask in another order are the same mask: phases add.
#[test]
fn a_search_does_not_depend_on_the_order_of_rings_and_keeps_etched_ones() {
    let joint = joint();
    let mut camera = random_lens(&Camera::resolve("ring-outer").unwrap(), 2, joint.max_phase, 5);
    camera.mask.rings_mut().next().unwrap().delay = Delay::Etched { height_um: 0.7, cauchy: [1.5, 0.004] };
    let mut turned = camera.clone();
    turned.mask.terms_mut().reverse();
    let [first, other] = [&camera, &turned].map(|camera| {
        let mut state = joint.begin(camera, &network(&joint, camera)).unwrap();
        for _ in 0..2 {
            assert!(joint.round(&[photo(320)], &mut state, || ControlFlow::Continue(())).unwrap());
        }
        state
    });
    assert_eq!(first, other);
    let delays: Vec<Delay> = first.camera.mask.rings().map(|ring| ring.delay).collect();
    let Delay::Etched { height_um, cauchy } = delays[0] else {
        panic!("an etched ring became {:?}", delays[0])
    };
    assert!(cauchy == [1.5, 0.004] && height_um != 0.7 && (height_um - 0.7).abs() < 0.2, "{height_um}");
    assert!(matches!(delays[1], Delay::Phase { .. }));
    // The step of the phase is that of the parameter.
    let moved = values(&first.camera)[2] - values(&first.best)[2];
    assert!((moved - first.length * first.direction[2]).abs() < 1e-9, "{moved}");
}

#[test]
fn symmetric_codes_are_rejected_behind_psfs_that_are_not_their_own_transposes() {
    let joint = joint();
    let recipe = Recipe { structure: Structure::Symmetric, ..joint.recipe.clone() };
    let check = |camera: &Camera| recipe.check_with(&dataset(&joint, camera)).map_err(|e| e.to_string());
    let round = Camera::resolve("ring-outer").unwrap();
    assert_eq!(check(&round), Ok(()));
    let coma = Camera { aberrations: Zernike(vec![Aberration { noll: 8, rms_nm: 60.0 }]), ..round };
    assert_eq!(
        check(&coma).unwrap_err(),
        "structure symmetric: must be free or blocks:SHARE behind a lens whose PSFs are not their own transposes"
    );
}

#[test]
fn searches_out_of_range_are_rejected() {
    let wrong = |joint: Joint| joint.check().unwrap_err().to_string();
    assert_eq!(wrong(Joint { rounds: 0, ..joint() }), "rounds 0: must be 1 to 10000");
    assert_eq!(wrong(Joint { windows: 0, ..joint() }), "windows 0: must be 1 to 10000");
    assert_eq!(wrong(Joint { worst_weight: 1.5, ..joint() }), "worst weight 1.5: must be 0 to 1");
    assert_eq!(
        wrong(Joint { max_phase: 0.0, ..joint() }),
        "max phase 0: must be a positive number of radians"
    );
    assert_eq!(wrong(Joint { noises: vec![2.0], ..joint() }), "noise 2: must be 0 to 1");
}
