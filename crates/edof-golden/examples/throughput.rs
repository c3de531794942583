//! Frames per second of the golden pipeline, windows in and picture out, for one network and one raw frame.
//!
//! `cargo run --release -p edof-golden --example throughput -- NETWORK.fixed.safetensors RAW.png [THREADS [FRAMES [OUT.f32]]]`: RAW.png
//! is grey, red first, 12 bits at the top of each word, as `edof capture` writes it. Prints one JSON line, and writes the frame's linear red,
//! green and blue to OUT.f32. `benches/peers/golden_float.sh` runs it beside the float network.

use edof_core::{CfaPhase, RawFrame};
use edof_golden::{Display, Golden, Picture};
use edof_network::weight_file;
use ndarray::Array2;
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [network, raw, numbers @ ..] = &args[..] else {
        return Err("usage: throughput NETWORK.fixed.safetensors RAW.png [THREADS [FRAMES [OUT.f32]]]".into());
    };
    let number = |i: usize, default| numbers.get(i).map_or(Ok(default), |n| n.parse::<usize>());
    let (threads, frames) = (number(0, 2)?, number(1, 20)?);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let golden = Golden::new(weight_file::load_fixed(Path::new(network))?)?;
    let (raw, display) = (frame(Path::new(raw))?, Display::default());

    let out = golden.frame(&raw)?;
    if let Some(path) = numbers.get(2) {
        let bytes: Vec<u8> = out.colour().planes.iter().flat_map(|light| light.to_le_bytes()).collect();
        std::fs::write(path, bytes)?;
    }
    let executed = out.counts.multiplications(golden.network()).executed;
    let (mut network_time, mut display_time) = (Duration::ZERO, Duration::ZERO);
    let (mut stream, mut picture) = (golden.stream(), Picture::empty());
    stream.frame(&raw)?.picture_into(&display, &mut picture);
    let (start, cpu) = (Instant::now(), processor_seconds()?);
    for _ in 0..frames {
        let begin = Instant::now();
        let out = stream.frame(&raw)?;
        network_time += begin.elapsed();
        let begin = Instant::now();
        std::hint::black_box(out.picture_into(&display, &mut picture));
        display_time += begin.elapsed();
    }
    let per_frame = |seconds: f64| seconds / frames as f64;
    let seconds = per_frame(start.elapsed().as_secs_f64());
    println!(
        "{{\"method\": \"edof-golden\", \"threads\": {threads}, \"frames_per_second\": {:.3}, \
         \"processor_seconds_per_frame\": {:.5}, \"network_seconds\": {:.5}, \"display_seconds\": {:.5}, \
         \"executed_multiplications\": {executed}}}",
        1.0 / seconds,
        per_frame(processor_seconds()? - cpu),
        per_frame(network_time.as_secs_f64()),
        per_frame(display_time.as_secs_f64()),
    );
    Ok(())
}

/// A raw frame as `edof capture` writes it.
fn frame(path: &Path) -> Result<RawFrame, Box<dyn Error>> {
    let picture = image::open(path)?.into_luma16();
    let (width, height) = picture.dimensions();
    let values = Array2::from_shape_fn((height as usize, width as usize), |(r, c)| {
        picture.get_pixel(c as u32, r as u32)[0] >> 4
    });
    Ok(RawFrame::from_values(values, 12, CfaPhase::Rggb)?)
}

/// Time that all threads of this process have spent computing: what a busy machine does not add to.
fn processor_seconds() -> Result<f64, Box<dyn Error>> {
    let mut nanoseconds = 0;
    for task in std::fs::read_dir("/proc/self/task")? {
        let spent = std::fs::read_to_string(task?.path().join("schedstat"))?;
        nanoseconds += spent.split_whitespace().next().unwrap_or("0").parse::<u64>()?;
    }
    Ok(nanoseconds as f64 / 1e9)
}
