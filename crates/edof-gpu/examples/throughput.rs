//! Frames per second on a device, raw frame in the processor's memory to picture there.
//!
//! `cargo run --release -p edof-gpu --example throughput -- STEM RAW.u16 WIDTH FRAMES OUT.f32`: STEM.safetensors is the float network,
//! STEM.fixed.safetensors the fixed one; stride 8. RAW.u16 has the words of a frame, red first, little end first, without a header. Prints one JSON
//! line, and writes the float picture's linear red, green and blue to OUT.f32. `benches/peers/gpu_pytorch.py` runs it beside PyTorch.

use edof_core::overlap::Overlap;
use edof_core::{CfaPhase, RawFrame, Stride};
use edof_gpu::{Device, GpuFloat, GpuGolden};
use edof_network::weight_file;
use ndarray::Array2;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [stem, raw, width, frames, out] = &args[..] else {
        return Err("usage: throughput STEM RAW.u16 WIDTH FRAMES OUT.f32".into());
    };
    let words: Vec<u16> =
        std::fs::read(raw)?.chunks_exact(2).map(|word| u16::from_le_bytes([word[0], word[1]])).collect();
    let width = width.parse()?;
    let height = words.len().checked_div(width).ok_or("WIDTH 0: expected a frame's")?;
    let values = Array2::from_shape_vec((height, width), words)?;
    let raw = RawFrame::from_values(values, 16, CfaPhase::Rggb)?;
    let frames = frames.parse()?;
    let float = weight_file::load_network(Path::new(&format!("{stem}.safetensors")))?;
    let float = GpuFloat::new(Device::open(None)?, float, Stride::PATCH, Overlap::Hann)?;
    let fixed = weight_file::load_fixed(Path::new(&format!("{stem}.fixed.safetensors")))?;
    let fixed = GpuGolden::new(Device::open(None)?, fixed, stem)?;

    let picture = float.frame(&raw)?;
    let bytes: Vec<u8> = picture.planes.iter().flat_map(|light| light.to_le_bytes()).collect();
    std::fs::write(out, bytes)?;
    fixed.frame(&raw)?;
    let float_rate = rate(frames, || float.frame(&raw).map(drop))?;
    let fixed_rate = rate(frames, || fixed.frame(&raw).map(drop))?;
    println!(
        "{{\"device\": {:?}, \"float_frames_per_second\": {float_rate:.2}, \"fixed_frames_per_second\": {fixed_rate:.2}}}",
        float.device().name()
    );
    Ok(())
}

/// How many times a second it runs.
fn rate<E>(frames: u32, mut run: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let start = Instant::now();
    (0..frames).try_for_each(|_| run())?;
    Ok(f64::from(frames) / start.elapsed().as_secs_f64())
}
