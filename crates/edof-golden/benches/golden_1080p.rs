//! The golden reconstruction at 1920×1080, for every network in `weights/` and random ones of the same size; and how long the
//! specification takes for a smaller frame that the fast pipeline is given, too.
//!
//! `cargo bench -p edof-golden`; `RAYON_NUM_THREADS` sets the threads. Throughput is in pixels of the frame.

use divan::{Bencher, counter::ItemsCount};
use edof_core::draw::Draw;
use edof_core::number::OutputWord;
use edof_core::{CfaPhase, DisplayMode, Frame422, RawFrame};
use edof_golden::Golden;
use edof_golden::frame::scalar_frame;
use edof_golden::{Curve, Display};
use edof_network::{FixedNetwork, weight_file};
use ndarray::Array2;
use std::fmt;
use std::path::{Path, PathBuf};

/// Rows and columns of a frame that the specification can be waited for.
const SMALL: (usize, usize) = (128, 192);

fn main() {
    divan::main();
}

#[divan::bench(args = networks(), sample_count = 5, sample_size = 1)]
fn full_hd(bencher: Bencher<'_, '_>, named: &Named) {
    fast(bencher, named, (1080, 1920));
}

#[divan::bench(args = networks(), sample_count = 5, sample_size = 1)]
fn small(bencher: Bencher<'_, '_>, named: &Named) {
    fast(bencher, named, SMALL);
}

#[divan::bench(args = networks(), sample_count = 1, sample_size = 1)]
fn small_by_the_specification(bencher: Bencher<'_, '_>, named: &Named) {
    let frame = raw_frame(SMALL);
    bencher.counter(ItemsCount::new(SMALL.0 * SMALL.1)).bench(|| scalar_frame(&named.network, &frame));
}

fn fast(bencher: Bencher<'_, '_>, named: &Named, size: (usize, usize)) {
    let frame = raw_frame(size);
    match Golden::new(named.network.clone()) {
        Ok(golden) => bencher.counter(ItemsCount::new(size.0 * size.1)).bench(|| golden.frame(&frame)),
        Err(error) => eprintln!("{named}: {error}"),
    }
}

/// The display step alone, over a frame of random words.
#[divan::bench(args = DisplayMode::ALL, sample_count = 5, sample_size = 1)]
fn display(bencher: Bencher<'_, '_>, mode: DisplayMode) {
    let draw = &mut Draw::new(3);
    let mut words = |columns| {
        Array2::from_shape_fn((1080, columns), |_| OutputWord::from_bits(draw.whole(-2_000, 18_000) as i16))
    };
    let frame = Frame422 { luma: words(1920), chroma: [words(960), words(960)] };
    let display = Display::new(mode, Curve::Srgb);
    bencher
        .counter(ItemsCount::new(1080 * 1920usize))
        .bench(|| display.picture(&frame, (0, 0), (1080, 1920)));
}

/// A network and what the results call it.
struct Named {
    name: String,
    network: FixedNetwork,
}

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, stride {}", self.name, self.network.stride.pixels())
    }
}

/// Committed networks, and a random one at two strides.
fn networks() -> Vec<Named> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../weights");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.to_string_lossy().ends_with(".fixed.safetensors"));
    files.sort();
    let mut all = Vec::new();
    for path in files {
        match weight_file::load_fixed(&path) {
            Ok(network) => all.push(Named { name: network.origin.name.clone(), network }),
            Err(error) => eprintln!("{error}"),
        }
    }
    let drawn = |(window, stride)| Named {
        name: format!("drawn, window {window}"),
        network: edof_device::random::natural(window, stride, 1),
    };
    all.extend([(8, 8), (12, 8), (12, 4)].map(drawn));
    all
}

/// Smooth shades with edges and a little noise.
fn raw_frame(size: (usize, usize)) -> RawFrame {
    let mut draw = Draw::new(3);
    let values = Array2::from_shape_fn(size, |(r, c)| {
        let shade = 1400.0 + 1000.0 * (r as f64 / 90.0).sin() * (c as f64 / 70.0).cos();
        let edge = if (r / 50 + c / 70) % 2 == 0 { 300 } else { 0 };
        (shade as i64 + edge + draw.whole(-20, 20)) as u16
    });
    match RawFrame::from_values(values, 12, CfaPhase::Rggb) {
        Ok(frame) => frame,
        Err(error) => unreachable!("{error}"),
    }
}
