//! Frames a second of the golden reconstruction at 1920×1080, for every network in `weights/` and a drawn one of the same
//! size, and how much faster the fast pipeline is than the specification.
//!
//! `cargo bench -p edof-golden`; `RAYON_NUM_THREADS` sets the threads.

use edof_golden::frame::scalar_frame;
use edof_golden::sample::{self, Draw};
use edof_golden::{Golden, fast::isa::Isa};
use edof_spec::{CfaPhase, FixedNetwork, RawFrame, weight_file};
use ndarray::Array2;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() {
    let frame = raw_frame(1080, 1920);
    println!("1920x1080, {} threads, {:?}", rayon::current_num_threads(), Isa::best());
    println!(
        "{:24} {:>6} {:>10} {:>8} {:>14} {:>11} {:>12}",
        "network", "stride", "frames/s", "MAC/us", "nonzeros/layer", "saturations", "over scalar"
    );
    for (name, network) in networks() {
        report(&name, network, &frame);
    }
}

fn report(name: &str, network: FixedNetwork, frame: &RawFrame) {
    let small = raw_frame(128, 192);
    let golden = match Golden::new(network.clone()) {
        Ok(golden) => golden,
        Err(error) => return eprintln!("{name}: {error}"),
    };
    let seconds = best_of(5, || golden.frame(frame));
    let (slow, fast) = (best_of(1, || scalar_frame(&network, &small)), best_of(5, || golden.frame(&small)));
    let Ok(out) = golden.frame(frame) else { return eprintln!("{name}: frame too small") };
    let counts = out.counts;
    let nonzeros: Vec<String> = counts.stages[..network.form.shrinkages()]
        .iter()
        .map(|s| format!("{:.0}", s.nonzeros as f64 / counts.patches as f64))
        .collect();
    println!(
        "{name:24} {:>6} {:>10.2} {:>8.0} {:>14} {:>11} {:>11.0}x",
        network.stride.pixels(),
        1.0 / seconds,
        counts.multiply_accumulates(&network) as f64 / seconds * 1e-6,
        nonzeros.join("/"),
        counts.saturations(),
        slow / fast,
    );
}

/// Shortest of several runs, in seconds.
fn best_of<T>(runs: usize, mut run: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        std::hint::black_box(run());
        start.elapsed().as_secs_f64()
    };
    (0..runs).map(time).fold(f64::INFINITY, f64::min)
}

/// Committed networks, and a drawn one at two strides.
fn networks() -> Vec<(String, FixedNetwork)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../weights");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.to_string_lossy().ends_with(".fixed.safetensors"));
    files.sort();
    let mut all = Vec::new();
    for path in files {
        match weight_file::load_fixed(&path) {
            Ok(network) => all.push((network.origin.name.clone(), network)),
            Err(error) => eprintln!("{error}"),
        }
    }
    all.extend(
        [(8, 8), (12, 8), (12, 4)].map(|(w, s)| (format!("drawn, window {w}"), sample::natural(w, s, 1))),
    );
    all
}

/// Smooth shades with edges and a little noise.
fn raw_frame(height: usize, width: usize) -> RawFrame {
    let mut draw = Draw::new(3);
    let codes = Array2::from_shape_fn((height, width), |(r, c)| {
        let shade = 1400.0 + 1000.0 * (r as f64 / 90.0).sin() * (c as f64 / 70.0).cos();
        let edge = if (r / 50 + c / 70) % 2 == 0 { 300 } else { 0 };
        (shade as i64 + edge + draw.whole(-20, 20)) as u16
    });
    match RawFrame::from_codes(codes, 12, CfaPhase::Rggb) {
        Ok(frame) => frame,
        Err(error) => unreachable!("{error}"),
    }
}
