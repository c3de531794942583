//! Scalar and fast agree on every stage boundary of every window of all 24 photographs, for a network in `weights/` and an instruction
//! set each (for every one of both in `scripts/soak.sh`), and so do the frames they add up to. Photographs: `EDOF_KODAK`, else `../shared/data/kodak` beside the project.

use edof_core::number::InputWord;
use edof_core::{CfaPhase, Geometry, RawFrame};
use edof_golden::fast::{Fast, Isa};
use edof_golden::overlap_add::overlap_add;
use edof_golden::windows::window;
use edof_golden::{Counts, Golden, Trace, scalar};
use edof_network::{FixedNetwork, weight_file};
use ndarray::Array2;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> =
        entries.map(|e| e.path()).filter(|p| p.to_string_lossy().ends_with(ending)).collect();
    paths.sort();
    paths
}

fn photos() -> Vec<PathBuf> {
    let folder = std::env::var_os("EDOF_KODAK").map(PathBuf::from);
    files(&folder.unwrap_or_else(|| project().join("../shared/data/kodak")), ".png")
}

/// Each pixel's own colour of the photograph, as linear light in 16 bits.
fn mosaic(path: &Path) -> RawFrame {
    let photo = image::open(path).unwrap().to_rgb8();
    let (width, height) = photo.dimensions();
    let values = Array2::from_shape_fn((height as usize & !1, width as usize & !1), |(r, c)| {
        let channel = CfaPhase::Rggb.channel(r, c);
        u16::from(photo.get_pixel(c as u32, r as u32)[channel.plane()]) * 257
    });
    RawFrame::from_values(values, 16, CfaPhase::Rggb).unwrap()
}

fn networks() -> Vec<FixedNetwork> {
    let committed = files(&project().join("weights"), ".fixed.safetensors");
    let all: Vec<_> = committed.iter().map(|path| weight_file::load_fixed(path).unwrap()).collect();
    assert!(!all.is_empty(), "no fixed networks in weights/: nothing would be compared");
    all
}

/// Compares one photograph on some instruction sets, and the frame on the fastest.
fn compare(network: &FixedNetwork, isas: &[Isa], path: &Path) {
    let raw = mosaic(path);
    let geometry = Geometry::new(network.form.window, network.stride);
    let size = raw.size();
    let columns = geometry.patches(size.0, size.1).1;
    let kernels: Vec<Fast> = isas.iter().map(|isa| Fast::with_isa(network.clone(), *isa)).collect();
    let mut row_of: (usize, Vec<Vec<Trace>>) = (usize::MAX, vec![]);
    let mut patches = Counts::new(network.form.layers);
    let mut sums = patches.clone();
    let frame = overlap_add(
        geometry,
        size,
        |row, column| {
            if row_of.0 != row {
                let windows: Vec<InputWord> =
                    (0..columns).flat_map(|c| window(&raw, geometry, row, c)).collect();
                row_of = (row, kernels.iter().map(|fast| fast.traces(&windows)).collect());
            }
            let trace = scalar::run(network, &window(&raw, geometry, row, column));
            for (isa, traces) in isas.iter().zip(&row_of.1) {
                assert_eq!(traces[column], trace, "{isa:?}, {}, patch {row},{column}", path.display());
            }
            patches.add(&trace.stages);
            trace.output
        },
        &mut sums,
    );
    patches.merge(&sums);
    let out = Golden::new(network.clone()).unwrap().frame(&raw).unwrap();
    assert_eq!((out.frame, &out.counts), (frame, &patches), "{}", path.display());
}

/// Compares those pairs of a photograph and a network that are asked for, by their places in the lists; on one instruction set each
/// where `in_turn` says so.
fn compare_all(in_turn: bool, wanted: impl Fn(usize, usize) -> bool + Sync) {
    let photos = photos();
    assert!(
        !photos.is_empty(),
        "no photographs: EDOF_KODAK must name a folder with kodim01.png ... kodim24.png"
    );
    let isas = Isa::available();
    let isas_of = |photo: usize| if in_turn { &isas[photo % isas.len()..][..1] } else { &isas[..] };
    for (n, network) in networks().iter().enumerate() {
        photos
            .par_iter()
            .enumerate()
            .filter(|(p, _)| wanted(*p, n))
            .for_each(|(p, path)| compare(network, isas_of(p), path));
    }
}

#[test]
#[ignore = "needs photographs: scripts/test-photographs.sh"]
fn every_boundary_of_a_photo_is_the_same_for_the_networks_in_turn() {
    let networks = networks().len();
    compare_all(true, |photo, network| photo % networks == network);
}

#[test]
#[ignore = "minutes: scripts/soak.sh"]
fn every_boundary_of_every_photo_is_the_same_for_every_network() {
    compare_all(false, |_, _| true);
}
