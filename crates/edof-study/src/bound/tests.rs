//! The advisor's ranking against trained networks: the rows of the study of apertures.

use super::*;
use crate::aperture::Lens;
use edof_optics::bound::advise::{KNOWN_SHARE, NETWORK_DB, NETWORK_ERROR_DB, RANKING_ERROR_DB};
use edof_optics::bound::wiener::bayer_errors;
use std::collections::BTreeMap;

/// What the advisor is compared with, of each row of the study.
#[derive(serde::Deserialize)]
struct NetworkRow {
    lens: Lens,
    stops: f64,
    range: f64,
    electrons: f64,
    focus_psi: f64,
    psi: f64,
    psnr_db: f64,
}

/// One lens, stop, range and light: what the mixture of estimates expects, and what networks reached.
struct Pair {
    scene: [u64; 2],
    estimate: Reached,
    network: Reached,
}

fn pairs() -> Vec<Pair> {
    let text = include_str!("../../../../docs/results/aperture-networks.csv");
    let mut table = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let mut groups: BTreeMap<[u64; 4], Vec<NetworkRow>> = BTreeMap::new();
    for row in table.deserialize() {
        let row: NetworkRow = row.unwrap();
        let lens = if row.lens == Lens::Coded { 1000.0 } else { 10.0 * row.stops };
        let key = [lens, row.range, 1e3 * row.focus_psi, row.electrons].map(|v| v.round() as u64);
        groups.entry(key).or_default().push(row);
    }
    let mut seen: BTreeMap<[u64; 3], Vec<Transfer>> = BTreeMap::new();
    let pair = |(key, rows): (&[u64; 4], &Vec<NetworkRow>)| {
        let first = &rows[0];
        let open = Camera {
            psi_range: [0.0, first.range],
            focus_psi: first.focus_psi,
            ..Camera::resolve("ring-outer").unwrap()
        };
        let camera = if first.lens == Lens::Coded { open } else { closed(&without_mask(&open), first.stops) };
        let psis = edof_optics::bound::depths(camera.psi_range);
        let seen = seen
            .entry([key[0], key[1], key[2]])
            .or_insert_with(|| transfers(&camera, &psis, Sampling::Coarse));
        let light = Light { electrons: first.electrons, read_noise_e: 2.5, mean: Light::MEAN };
        let errors = bayer_errors(&camera, seen, &Statistics::natural(), light.variance(first.stops));
        let [blind, known] = [&errors.blind, &errors.known].map(|e| Reached::of_errors(e));
        let mut depths: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
        rows.iter().for_each(|r| depths.entry((100.0 * r.psi) as i64).or_default().push(r.psnr_db));
        let db: Vec<f64> = depths.values().map(|v| v.iter().sum::<f64>() / v.len() as f64).collect();
        let network = Reached {
            average_db: db.iter().sum::<f64>() / db.len() as f64,
            worst_db: db.iter().copied().fold(f64::INFINITY, f64::min),
        };
        Pair { scene: [key[1], key[3]], estimate: blind.mixed(known, KNOWN_SHARE), network }
    };
    groups.iter().map(pair).collect()
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |v: &f64| values.iter().filter(|other| *other < v).count() as f64;
    values.iter().map(rank).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let centred = |v: &[f64]| -> Vec<f64> {
        let mean = v.iter().sum::<f64>() / v.len() as f64;
        v.iter().map(|v| v - mean).collect()
    };
    let (a, b) = (centred(a), centred(b));
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt()
}

/// Each value minus the mean of its scene.
fn within_scenes<P>(pairs: &[P], scene: impl Fn(&P) -> [u64; 2], of: impl Fn(&P) -> f64) -> Vec<f64> {
    let mean = |own: &P| {
        let peers: Vec<f64> = pairs.iter().filter(|p| scene(p) == scene(own)).map(&of).collect();
        peers.iter().sum::<f64>() / peers.len() as f64
    };
    pairs.iter().map(|p| of(p) - mean(p)).collect()
}

/// A network behind a lens in a table of the page of codes.
struct Read {
    gain: f64,
    module_px: f64,
    camera: String,
    /// Mean share of codes that rxing reads, over kinds and depths.
    rate: f64,
}

/// Networks in floating point, one behind each lens, with the smallest modules: of larger ones all lenses keep about the same.
fn codes_read() -> Vec<Read> {
    let page = include_str!("../../../../docs/results/codes.md");
    let (mut scene, mut rows) = (None, vec![]);
    for line in page.lines() {
        if let Some(heading) = line.strip_prefix("## sensor, gain ") {
            let numbers =
                heading.strip_suffix(" pixels, read by rxing").and_then(|h| h.split_once(", modules of "));
            scene = numbers.map(|(gain, px)| (gain.parse::<f64>().unwrap(), px.parse::<f64>().unwrap()));
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let Some((gain, module_px)) = scene.filter(|_| cells.len() > 6 && cells[2].ends_with(".float"))
        else {
            continue;
        };
        let rate = |cell: &&str| -> f64 {
            cell.split("; ").nth(1).unwrap().split_once(" ±").unwrap().0.parse().unwrap()
        };
        let rate = cells[3..7].iter().map(rate).sum::<f64>() / 4.0;
        rows.push(Read { gain, module_px, camera: cells[1].to_owned(), rate });
    }
    rows.retain(|row| row.module_px < 2.0);
    rows
}

/// What the advisor expects for codes behind the lens of a row.
fn expected_of_codes(row: &Read) -> f64 {
    let open = Camera::resolve("ring-outer").unwrap();
    let clear = |stops: f64| closed(&Camera { focus_psi: 4.0, ..without_mask(&open) }, stops);
    let (camera, stops) = match row.camera.as_str() {
        "ring-outer" => (open, 0.0),
        "clear-mid" => (clear(0.0), 0.0),
        "clear-closed" => (clear(0.5), 0.5),
        "clear-for-codes" => (clear(1.0), 1.0),
        other => panic!("{other}"),
    };
    let seen = transfers(&camera, &edof_optics::bound::depths(camera.psi_range), Sampling::Coarse);
    let light = Light { electrons: 1e4 / row.gain, read_noise_e: 2.5, mean: Light::MEAN };
    let errors = bayer_errors(&camera, &seen, &Statistics::print(row.module_px), light.variance(stops));
    let [blind, known] = [&errors.blind, &errors.known].map(|e| Reached::of_errors(e));
    blind.mixed(known, KNOWN_SHARE).average_db
}

#[test]
fn the_advisor_ranks_lenses_for_codes_as_codes_are_read() {
    let rows = codes_read();
    assert_eq!(rows.len(), 8, "four lenses, two lights");
    let scene = |row: &Read| [row.gain, 10.0 * row.module_px].map(|v| v as u64);
    let expected = within_scenes(&rows, scene, expected_of_codes);
    let rates = within_scenes(&rows, scene, |row| row.rate);
    let rho = correlation(&ranks(&expected), &ranks(&rates));
    assert!(rho >= 0.6, "Spearman's rho {rho:.3}");
}

#[test]
fn the_advisor_ranks_lenses_as_trained_networks_do() {
    let pairs = pairs();
    assert_eq!(pairs.len(), 60, "four lenses, three ranges, five lights");
    let score = |of: fn(&Pair) -> Reached| -> Vec<f64> { pairs.iter().map(|p| of(p).score()).collect() };
    let (estimates, networks) = (score(|p| p.estimate), score(|p| p.network));
    let all = correlation(&ranks(&estimates), &ranks(&networks));
    // Light alone ranks most of them. What is left is the choice of a lens in one scene.
    let [estimates, networks]: [fn(&Pair) -> f64; 2] = [|p| p.estimate.score(), |p| p.network.score()];
    let (estimates, networks) =
        (within_scenes(&pairs, |p| p.scene, estimates), within_scenes(&pairs, |p| p.scene, networks));
    let lenses = correlation(&ranks(&estimates), &ranks(&networks));
    assert!(all >= 0.98 && lenses >= 0.9, "Spearman's rho {all:.3}, within scenes {lenses:.3}");
    let apart = estimates.iter().zip(&networks).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 60.0;
    // The difference of two lenses has twice the variance.
    let found = (2.0 * apart).sqrt();
    assert!((found - RANKING_ERROR_DB).abs() < 0.05, "{found}");
}

#[test]
fn the_line_to_the_decibels_of_networks_is_that_of_the_rows() {
    let points: Vec<[f64; 2]> = pairs()
        .iter()
        .flat_map(|p| {
            [[p.estimate.average_db, p.network.average_db], [p.estimate.worst_db, p.network.worst_db]]
        })
        .collect();
    let n = points.len() as f64;
    let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let slope = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>()
        / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>();
    let line = [slope, y - slope * x];
    let far = |point: [f64; 2], [a, b]: [f64; 2]| point[1] - (a * point[0] + b);
    let rms = |line| (points.iter().map(|p| far(*p, line).powi(2)).sum::<f64>() / n).sqrt();
    assert!((line[0] - NETWORK_DB[0]).abs() < 0.005 && (far([x, y], NETWORK_DB)).abs() < 0.02, "{line:?}");
    assert!((rms(NETWORK_DB) - NETWORK_ERROR_DB).abs() < 0.05, "{}", rms(NETWORK_DB));
}

#[test]
fn a_lens_without_a_mask_is_its_own_clear_lens_and_verdicts_state_the_limit() {
    let camera = Camera { psi_range: [0.0, 2.0], ..Camera::resolve("clear-mid").unwrap() };
    let light = Light { electrons: 1000.0, read_noise_e: 2.5, mean: Light::MEAN };
    let found = bound(&camera, &[[0.0, 2.0]], &[light], &Statistics::natural()).unwrap();
    let row = found.rows[0];
    assert_eq!(row.clear, row.lens);
    // Behind a mosaic even a sharp lens is beaten by one that lets no frequency alias.
    for gain in [row.any_minus_clear(), row.any_minus_clear_in_planes()] {
        assert!(gain.average_db > -0.02 && gain.worst_db < 1.0, "{gain:?}");
    }
    assert!(found.verdicts()[0].starts_with("ψ 0 to 2: any mask whatever gains"));
    let plots = frequency_plots(&camera);
    assert_eq!(plots.len(), 3);
    // No point of a lens lies above the limit, but for what sampling the pupil costs.
    for plot in plots {
        let limit = &plot.series.last().unwrap().points;
        for (point, limit) in plot.series.iter().flat_map(|s| s.points.iter().zip(limit)) {
            assert!(point[1] <= limit[1] + 1e-2, "{}: {point:?} {limit:?}", plot.title);
        }
    }
}
