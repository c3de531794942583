use super::page::in_words;
use super::*;
use crate::experiment::run;
use crate::journal::{Header, Journal, Program, Shard};
use crate::made::Made;
use crate::methods::nets::Net;
use crate::metrics::paired::Paired;
use crate::study_report::StudyReport;
use edof_core::camera::Camera;
use edof_core::geometry::Window;
use edof_core::{ColourFrame, Stride};
use edof_network::Network;
use edof_network::network::Condition;
use edof_optics::Statistics;
use std::ops::ControlFlow;

fn estimator() -> crate::aperture::Plan {
    crate::aperture::Plan {
        coded: Camera::resolve("ring-outer").unwrap(),
        ranges: vec![8.0],
        stops: vec![0.0, 1.0],
        electrons: vec![100.0, 1000.0],
        read_noise_e: 2.5,
        mean_light: 0.4,
        window: Window::new(8).unwrap(),
        statistics: Statistics::natural(),
    }
}

/// A network that was trained for a camera and gains of the sensor.
fn net(camera: &Camera, name: &str, [least, most]: [f64; 2]) -> Net {
    let mut float: Network = edof_device::random::silent(camera.clone());
    let [least_noise, noise] = [least, most].map(Noise::sensor);
    float.origin.conditions = vec![Condition { tone: TONE, noise, least_noise }];
    float.origin.patches = 512;
    Net::new(name, float, name, None, Stride::PATCH).0
}

fn plan() -> Plan {
    let estimator = estimator();
    let peer = |camera: &Camera| {
        // Twice the gain behind half the light.
        let light = if camera.name.starts_with("clear-1") { 2.0 } else { 1.0 };
        let bright = net(camera, &format!("{}-bright", camera.name), [1.0, 10.0].map(|g| g * light));
        let dim = net(camera, &format!("{}-dim", camera.name), [10.0, 100.0].map(|g| g * light));
        let nets = if camera.name.starts_with("coded") { vec![bright, dim] } else { vec![bright] };
        Peer::new(&estimator.coded, &estimator.stops, nets).unwrap()
    };
    let peers = estimator.cameras().unwrap().iter().map(peer).collect();
    Plan { estimator, peers, optics: Settings::default() }
}

fn photo(name: &str) -> Photo {
    let mut frame = ColourFrame::zeros(48, 64);
    frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
        *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 3) as f32).cos();
    });
    Photo { name: name.into(), frame }
}

#[test]
fn cameras_of_the_comparison_are_recognised_by_their_networks() {
    let plan = plan();
    let known: Vec<(Lens, f64, f64)> = plan.peers.iter().map(|p| (p.lens, p.stops, p.range)).collect();
    assert_eq!(known, [(Lens::Coded, 0.0, 8.0), (Lens::Clear, 0.0, 8.0), (Lens::Clear, 1.0, 8.0)]);
    assert_eq!(plan.peers[0].name, "coded-8-by-noise");
    let depths = plan.peers[2].depths();
    assert_eq!((depths.len(), depths[0], depths[4]), (DEPTHS, (0.0, 0.0), (8.0, 4.0)));
    let closed = &plan.peers[2];
    assert!(closed.camera.psi_range[1] == 4.0 && closed.camera.focus_psi < 4.0);
    let Noise::Sensor(noise) = plan.noise(closed, 1000.0) else { panic!("no sensor") };
    assert!((noise.full_scale_e() - 500.0).abs() < 1e-9);
}

#[test]
fn networks_of_other_lenses_or_light_are_rejected() {
    let plan = estimator();
    let coded = &plan.coded;
    let told = |stops: &[f64], nets| Peer::new(coded, stops, nets).err().unwrap().to_string();
    let closed = plan.cameras().unwrap().pop().unwrap();
    assert!(
        told(&[0.0], vec![net(&closed, "n", [2.0, 20.0])])
            .starts_with("network 'n': was trained for camera clear-1-8")
    );
    let other = Camera { focal_length_mm: 17.0, ..closed.clone() };
    assert!(
        told(&[1.0], vec![net(&other, "n", [2.0, 20.0])])
            .contains("expected the coded lens or its clear lens")
    );
    let mut linear = net(&closed, "n", [2.0, 20.0]);
    linear.float.origin.conditions[0].tone = Tone::Linear;
    assert_eq!(
        told(&[1.0], vec![linear]),
        "network 'n': was trained without real light, expected edof train --tone srgb"
    );
    assert!(Peer::new(coded, &[1.0], vec![net(&closed, "n", [2.0, 20.0])]).is_ok());
}

#[test]
fn every_light_that_a_network_knows_is_measured_once_and_the_page_compares_by_photograph() {
    let (plan, photos) = (plan(), [photo("p1"), photo("p2")]);
    let mut journal = Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")));
    let mut all = Photographing::new(&plan, &photos);
    run(&mut all, Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(())).unwrap();
    // Two lights behind the coded lens, one behind the clear ones: of each, all depths of both photographs.
    assert_eq!(journal.rows().len(), (2 + 1 + 1) * DEPTHS * 2);
    run(&mut all, Shard::WHOLE, &mut journal, |_| panic!("nothing is measured twice")).unwrap();
    let study = ApertureNetworks::new(&journal.rows(), String::new()).unwrap();
    assert_eq!(study.peers.len(), 1, "the clear lens has no network for little light");
    assert_eq!((study.peers[0].electrons, study.peers[0].clear.len()), (1000.0, 2));
}

/// A row with a level of its own.
fn row(lens: Lens, stops: f64, psi: f64, image: &str, psnr_db: f64) -> Row {
    Row {
        lens,
        stops,
        f_number: 3.5 * (0.5 * stops).exp2(),
        range: 8.0,
        electrons: 1000.0,
        focus_psi: 4.0,
        network: "n".into(),
        windows: 512,
        image: image.into(),
        psi,
        psnr_db,
        // The estimator prefers one stop.
        estimated_average_db: 30.0 + stops,
        estimated_worst_db: 29.0,
        proof: Proof::default(),
    }
}

#[test]
fn a_verdict_names_the_lights_of_each_answer() {
    let gain = |electrons: f64, mean: f64| (electrons, Paired { mean, standard_error: Some(0.1), photos: 8 });
    let gains = [gain(3000.0, 0.3), gain(1000.0, 0.4), gain(300.0, -0.1), gain(100.0, -0.25)];
    assert_eq!(
        in_words(&gains),
        "better by up to 0.40 dB at 3000, 1000 electrons, worse by up to 0.25 dB at 100 electrons, \
         equally good within the error at 300 electrons"
    );
    assert_eq!(in_words(&gains[2..3]), "equally good within the error at every light");
}

#[test]
fn the_verdict_is_paired_and_against_the_aperture_of_the_estimate() {
    let mut rows = vec![];
    for (image, own) in [("p1", 0.0), ("p2", 4.0)] {
        for psi in [0.0, 8.0] {
            rows.push(row(Lens::Coded, 0.0, psi, image, 30.0 + own));
            rows.push(row(Lens::Clear, 0.0, psi, image, 20.0 + own));
            // 33 and 28.5: 30.75 on average.
            rows.push(row(Lens::Clear, 1.0, psi, image, if psi == 0.0 { 33.0 } else { 28.5 } + own));
        }
    }
    let study = ApertureNetworks::new(&rows, String::new()).unwrap();
    assert!(
        study.to_text().contains(
            "ψ 0 to 8: at the worst depth the coded lens is better by up to 1.50 dB at every light. \
             On average it is worse by up to 0.75 dB at every light."
        ),
        "{}",
        study.to_text()
    );
    let page = study.to_markdown(&Made::by("edof study aperture-networks"));
    for line in [
        "the coded lens is at the worst depth better in 1, worse in 0, equal within the error in 0. On average over depths it is better in 0, worse in 1,",
        "| 0 to 8 | 1000 | 32.00 | 32.00 | F/4.9 | 32.75 | 30.50 | -0.75 ± 0.00 | +1.50 ± 0.00 |",
        "| clear, F/3.5 | +10.00 ± 0.00 / +10.00 ± 0.00 |",
        "| clear, F/4.9 | 31.00 / 29.00 |",
    ] {
        assert!(page.contains(line), "{line}\n{page}");
    }
    assert_eq!(study.report("edof study aperture-networks").to_html().matches("class=\"plot\"").count(), 1);
}
