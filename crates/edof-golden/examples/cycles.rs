//! How long the cycle model takes for a whole frame with all counters.
//!
//! `cargo run --release -p edof-golden --example cycles -- DESIGN.json NETWORK.fixed.safetensors RAW.png` (RAW.png as for `throughput`)

use edof_core::number::InputWord;
use edof_core::{CfaPhase, Geometry, RawFrame};
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_golden::cycle::{Cycle, Patch, Summary};
use edof_golden::windows::Mirrored;
use edof_network::weight_file;
use ndarray::Array2;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [design, network, raw] = &args[..] else {
        return Err("usage: cycles DESIGN.json NETWORK.fixed.safetensors RAW.png".into());
    };
    let design = Design::from_json(&std::fs::read_to_string(design)?)?;
    let network = weight_file::load_fixed(Path::new(network))?;
    let picture = image::open(raw)?.into_luma16();
    let (height, width) = (picture.height() as usize, picture.width() as usize);
    let values =
        Array2::from_shape_fn((height, width), |(r, c)| picture.get_pixel(c as u32, r as u32)[0] >> 4);
    let raw = RawFrame::from_values(values, 12, CfaPhase::Rggb)?;

    let start = Instant::now();
    let geometry = Geometry::new(network.form.window, network.stride);
    let (rows, columns) = geometry.patches(height, width);
    let mirrored = Mirrored::new(&raw, geometry);
    let windows = (0..rows * columns).map(|i| {
        let mut window = vec![InputWord::ZERO; network.form.window.pixels()];
        mirrored.copy_window(i / columns, i % columns, &mut window);
        Patch { window, set: Set::First }
    });
    let mut summary = Summary::new(&design);
    let model = Cycle::new(&design, [&network, &network])?;
    model.run(windows).for_each(|patch| summary.add(&patch));
    println!(
        "{} patches, {:.1} cycles each, in {:.2} seconds by the clock",
        summary.counts.patches,
        summary.cycles_per_patch(),
        start.elapsed().as_secs_f64()
    );
    Ok(())
}
