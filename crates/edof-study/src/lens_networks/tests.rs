use super::*;
use crate::experiment::run;
use crate::journal::{Header, Journal, Program, Shard};
use crate::made::Made;
use crate::methods::nets::Net;
use crate::study_report::StudyReport;
use edof_core::camera::Camera;
use edof_core::{ColourFrame, Stride};
use edof_network::Network;
use edof_network::network::{Condition, Form};
use edof_optics::bound::lenses::{Cubic, closed};
use ndarray::Array2;
use std::ops::ControlFlow;

fn clear() -> Camera {
    Camera::resolve("clear-mid").unwrap()
}

fn cubic() -> Camera {
    Camera { name: "cubic".into(), ..Cubic { strength: 2.3, mixed: 0.2 }.on(&clear()) }
}

/// A network that was trained for a camera, ψ of its own aperture and gains of the sensor from 1 to 10 times what a stop takes.
fn net(camera: &Camera, name: &str, [low, high]: [f64; 2], seed: u64) -> Net {
    let stops = 2.0 * (clear().aperture_radius_mm / camera.aperture_radius_mm).log2();
    let mut float: Network = edof_device::random::silent(Camera { psi_range: [low, high], ..camera.clone() });
    let [least_noise, noise] = [1.0, 10.0].map(|gain| Noise::sensor(gain * stops.exp2()));
    float.origin.conditions = vec![Condition { tone: TONE, noise, least_noise }];
    float.origin.provenance.seed = Some(seed);
    Net::new(name, float, name, None, Stride::PATCH).0
}

/// A network of exposures at these foci of the clear lens, that copies the nearest pixels of one of them, for gains from 1 to 20.
pub(crate) fn copying(foci: &[f64], exposure: usize, seed: u64) -> Net {
    let lens = Camera { focus_psi: foci[0], ..clear() };
    let mut net = net(&lens, &format!("n{seed}"), [0.0, 8.0], seed);
    let float = &mut net.float;
    float.form = Form { exposures: foci.len(), linear_path: true, ..float.form };
    float.origin.further_foci = foci[1..].to_vec();
    float.analysis = Array2::zeros((float.form.codes, float.form.inputs()));
    float.linear_path = Some(Array2::from_shape_fn((3 * 64, float.form.inputs()), |(output, input)| {
        let (plane, pixel) = (output / 64, output % 64);
        let site = |v: usize, odd: bool| v / 2 * 2 + usize::from(odd);
        let nearest = site(pixel / 8, plane == 2) * 8 + site(pixel % 8, plane > 0);
        f32::from(u8::from(input == exposure * 64 + nearest))
    }));
    let [least_noise, noise] = [1.0, 20.0].map(Noise::sensor);
    float.origin.conditions = vec![Condition { tone: TONE, noise, least_noise }];
    net
}

fn all(psis: &[f64], nets: Vec<Net>) -> Result<Vec<Peer>, String> {
    peers(&clear(), psis, nets, &Settings::default()).map_err(|error| error.to_string())
}

fn depths(peer: &Peer) -> Vec<f64> {
    peer.psis.iter().map(|psi| psi.open).collect()
}

#[test]
fn a_network_that_knows_a_depth_serves_the_depths_with_the_same_kernels() {
    let psis = [0.0, 4.0, 8.0];
    for lens in [clear(), cubic()] {
        let found =
            all(&psis, vec![net(&lens, "far", [8.0; 2], 1), net(&lens, "focus", [4.0; 2], 1)]).unwrap();
        assert_eq!(
            found.iter().map(depths).collect::<Vec<_>>(),
            [vec![0.0, 8.0], vec![4.0]],
            "{}",
            lens.name
        );
        // A network of its own goes first.
        let nets = [8.0, 4.0, 0.0].map(|psi| net(&lens, &psi.to_string(), [psi; 2], 1));
        let found = all(&psis, nets.into()).unwrap();
        assert_eq!(found.iter().map(depths).collect::<Vec<_>>(), [[8.0], [4.0], [0.0]], "{}", lens.name);
    }
    // A ring is sharp on one side of its focus.
    let ring = Camera { focus_psi: 4.0, ..Camera::resolve("ring-outer").unwrap() };
    let told =
        all(&psis, vec![net(&ring, "far", [8.0; 2], 1), net(&ring, "focus", [4.0; 2], 1)]).err().unwrap();
    assert_eq!(
        told,
        "lens ring-outer, seed 1: no network knows psi 0; give fewer --psi, or train one with --psi 0:0 --depths 1"
    );
}

#[test]
fn a_closed_lens_sees_smaller_depths_in_less_light() {
    let half = closed(&clear(), 1.0);
    let found = all(&[0.0, 8.0], vec![net(&half, "n", [0.0, 4.0], 3)]).unwrap();
    assert_eq!((found[0].stops, found[0].known, found[0].seed), (1.0, false, 3));
    assert_eq!((found[0].psis[1].open, found[0].psis[1].own), (8.0, 4.0));
    let plan = Plan { peers: found, electrons: vec![1e3], read_noise_e: 2.5, optics: Settings::default() };
    let Noise::Sensor(noise) = plan.noise(&plan.peers[0], 1e3) else { panic!("no sensor") };
    assert!((noise.full_scale_e() - 500.0).abs() < 1e-9);
}

#[test]
fn each_exposure_is_a_frame_of_its_focus_in_its_share_of_the_light() {
    let two = [2.0, 6.0];
    let nets = vec![copying(&two, 0, 1), copying(&two, 1, 2), copying(&[2.0], 0, 3), copying(&[6.0], 0, 4)];
    let (peers, electrons) = (all(&two, nets).unwrap(), vec![1e4, 5e3]);
    assert_eq!(
        peers.iter().map(Peer::foci).collect::<Vec<_>>(),
        [vec![2.0, 6.0], vec![2.0, 6.0], vec![], vec![]]
    );
    let plan = Plan { peers, electrons, read_noise_e: 2.5, optics: Settings::default() };
    let mut journal = Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")));
    let photos = [photo("p1")];
    let mut experiment = Photographing::new(&plan, &photos);
    run(&mut experiment, Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(())).unwrap();
    let rows = journal.rows();
    let db = |seed: u64, electrons: f64, psi: f64| {
        let is_it = |row: &&Row| (row.seed, row.electrons, row.psi) == (seed, electrons, psi);
        rows.iter().find(is_it).unwrap().psnr_db
    };
    for psi in two {
        // Frames of either focus in half of the light; the noise of the second is another.
        let alone = [3, 4].map(|seed| db(seed, 5e3, psi));
        let seen = [1, 2].map(|seed| db(seed, 1e4, psi));
        assert_eq!(seen[0], alone[0], "psi {psi}");
        assert!(seen[1] != alone[1] && (seen[1] - alone[1]).abs() < 0.1, "psi {psi}: {seen:?} {alone:?}");
        // Frames that are swapped would be seen.
        assert!((alone[0] - alone[1]).abs() > 0.3, "psi {psi}: {alone:?}");
    }
}

#[test]
fn networks_that_cannot_be_compared_are_rejected() {
    let told = |psis: &[f64], nets| all(psis, nets).err().unwrap();
    let whole = [0.0, 8.0];
    let other = Camera { focal_length_mm: 17.0, ..clear() };
    assert!(
        told(&[0.0], vec![net(&other, "n", whole, 1)])
            .starts_with("network 'n': was trained for camera clear-mid, expected the lens")
    );
    let larger = closed(&clear(), -0.5);
    assert!(told(&[0.0], vec![net(&larger, "n", whole, 1)]).contains("smaller aperture"));
    let mut linear = net(&clear(), "n", whole, 1);
    linear.float.origin.conditions[0].tone = Tone::Linear;
    assert_eq!(
        told(&[0.0], vec![linear]),
        "network 'n': was trained without real light, expected edof train --tone srgb"
    );
    let half = closed(&clear(), 1.0);
    assert_eq!(
        told(&[0.0, 9.0], vec![net(&half, "n", [0.0, 4.0], 1)]),
        "network 'n': was trained for psi 0 to 8 of the open aperture, which leaves out psi 9; give fewer --psi, or train it for all"
    );
    let twice = ["a", "b"].map(|name| net(&clear(), name, whole, 1));
    assert_eq!(
        told(&[0.0], twice.into()),
        "networks 'a' and 'b': are of one lens, depth and seed; expected another --seed"
    );
}

fn photo(name: &str) -> Photo {
    let mut frame = ColourFrame::zeros(48, 64);
    frame.planes.indexed_iter_mut().for_each(|((p, r, c), v)| {
        *v = 0.5 + 0.3 * ((r / (3 + p)) as f32).sin() * ((c / 3) as f32).cos();
    });
    Photo { name: name.into(), frame }
}

#[test]
fn every_light_that_a_network_knows_is_measured_once() {
    let nets = vec![
        net(&clear(), "blind-1", [0.0, 8.0], 1),
        net(&clear(), "blind-2", [0.0, 8.0], 2),
        net(&clear(), "known", [8.0; 2], 1),
    ];
    let (peers, electrons) = (all(&[0.0, 8.0], nets).unwrap(), vec![1e4, 1e3, 100.0]);
    let plan = Plan { peers, electrons, read_noise_e: 2.5, optics: Settings::default() };
    let photos = [photo("p1"), photo("p2")];
    let mut journal = Journal::in_memory(Header::of::<Row>(Program::stub("r", "m")));
    let mut experiment = Photographing::new(&plan, &photos);
    run(&mut experiment, Shard::WHOLE, &mut journal, |_| ControlFlow::Continue(())).unwrap();
    // Three networks, two lights of three, two depths, two photographs.
    assert_eq!(journal.rows().len(), 3 * 2 * 2 * 2);
    run(&mut experiment, Shard::WHOLE, &mut journal, |_| panic!("nothing is measured twice")).unwrap();
    let study = LensNetworks::new(&journal.rows(), String::new()).unwrap();
    assert_eq!(study.lenses.iter().map(|lens| lens.seeds).collect::<Vec<_>>(), [2, 1, 2, 1]);
}

/// Rows of one lens: two photographs, two depths, each with a level of its own.
fn rows(lens: &str, known: bool, seed: u64, levels: [f64; 2]) -> Vec<Row> {
    let mut rows = vec![];
    for (image, own) in [("p1", 0.0), ("p2", 4.0)] {
        for (psi, level) in [0.0, 8.0].into_iter().zip(levels) {
            rows.push(Row {
                lens: lens.into(),
                clear: lens.starts_with("clear"),
                stops: if lens == "clear-1" { 1.0 } else { 0.0 },
                known,
                foci: vec![],
                seed,
                electrons: 1000.0,
                psi,
                image: image.into(),
                psnr_db: level + own,
                proof: Proof::default(),
            });
        }
    }
    rows
}

fn told(rows: &[Vec<Row>]) -> LensNetworks {
    LensNetworks::new(&rows.concat(), String::new()).unwrap()
}

#[test]
fn a_mask_must_win_against_the_best_stop_of_the_clear_lens() {
    let mut all = vec![
        rows("clear-0", false, 1, [34.0, 28.0]),
        rows("clear-1", false, 1, [31.0, 31.0]),
        rows("mask", false, 1, [30.6, 31.4]),
    ];
    let study = told(&all);
    let text = study.to_text();
    assert!(
        text.contains("mask: on average +0.00 ± 0.00 dB at least (1000 electrons), at the worst depth -0.40 ± 0.00 dB at least (1000 electrons): the rule is not met."),
        "{text}"
    );
    assert!(
        text.contains("No mask becomes the default. The rule: in no light more than 0.05 dB below"),
        "{text}"
    );
    all[2] = rows("mask", false, 1, [31.5, 31.4]);
    let text = told(&all).to_text();
    assert!(
        text.contains("mask may become the default.") && text.contains("+0.40 ± 0.00 dB at least"),
        "{text}"
    );
    // Seeds apart by 2 dB: the mean's error is 1 dB, though photographs agree.
    all.push(rows("mask", false, 2, [29.5, 29.4]));
    let study = told(&all);
    let page = study.to_markdown(&Made::by("edof study lens-networks"));
    assert!(page.starts_with("# Masks against the clear lens at its best stop\n"), "{page}");
    assert!(page.contains("| mask, open | 2 seeds | -0.55 ± 1.00 / -0.60 ± 1.00 |"), "{page}");
    assert!(page.contains("| clear-1, closed by 1 stops | 1 seed | 33.00 / 33.00 |"), "{page}");
    assert_eq!(study.report("edof").to_html().matches("class=\"plot\"").count(), 1);
}

#[test]
fn several_exposures_pay_from_half_a_decibel_on_average_and_at_the_worst_depth_on() {
    let one = [rows("clear-0", false, 1, [34.0, 28.0]), rows("clear-1", false, 1, [31.0, 31.0])].concat();
    let page = |levels: [f64; 2]| {
        let mut two = rows("clear-0", false, 1, levels);
        two.iter_mut().for_each(|row| row.foci = vec![2.0, 6.0]);
        told(&[one.clone(), two]).to_markdown(&Made::by("edof study lens-networks"))
    };
    let much = page([31.6, 31.8]);
    assert!(much.starts_with("# What several exposures are worth\n"), "{much}");
    assert!(much.contains("1000 electrons: clear-0, open, 2 exposures at foci 2, 6 minus one exposure of the whole time, clear-1, closed by 1 stops: +0.70 ± 0.00 dB on average, +0.60 ± 0.00 at the worst depth: at least 0.5 dB both ways, so they pay."), "{much}");
    assert!(much.contains("| clear-0, open, 2 exposures at foci 2, 6 | 1 seed | 33.70 / 33.60 |"), "{much}");
    assert!(much.contains("## Minus the blind clear lens at its best stop, one exposure\n"), "{much}");
    assert!(page([31.6, 31.4]).contains(
        "+0.40 ± 0.00 at the worst depth: a gain below 0.5 dB in one of them, so they pay little."
    ));
    assert!(
        page([31.6, 30.8])
            .contains("-0.20 ± 0.00 at the worst depth: not a gain both ways, so they do not pay.")
    );
}

#[test]
fn knowing_the_depth_is_worth_building_from_half_a_decibel_on() {
    let blind = rows("clear-0", false, 1, [34.0, 28.0]);
    let page = |known: [f64; 2]| {
        told(&[blind.clone(), rows("clear-0", true, 1, known)])
            .to_markdown(&Made::by("edof study lens-networks"))
    };
    let little = page([34.1, 28.4]);
    assert!(little.starts_with("# What knowing the depth is worth\n"), "{little}");
    assert!(little.contains("Knowing the depth gains +0.40 ± 0.00 dB at most (clear-0, at the worst depth, 1000 electrons): less than 0.5 dB, so a network that estimates the depth is not worth trying."), "{little}");
    let much = page([35.4, 28.0]);
    assert!(
        much.contains("gains +0.70 ± 0.00 dB at most (clear-0, on average, 1000 electrons): at least 0.5 dB"),
        "{much}"
    );
    assert!(much.contains("| clear-0, open, depth known | 1 seed | +0.70 ± 0.00 / +0.00 ± 0.00 |"), "{much}");
    assert!(much.contains("the best lens with the depth known, clear-0, minus the best blind one, clear-0: +0.70 ± 0.00 dB on average, +0.00 ± 0.00 at the worst depth."), "{much}");
}
