//! CPU seconds of a 1080p frame through the program's pipeline, as `benches/frame.py` measures `edof.reconstruct`: `scripts/bench-python.sh`.

use edof_core::{CfaPhase, RawFrame};
use edof_golden::Golden;
use edof_study::metrics::cpu_time;
use ndarray::Array2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let frames: usize = std::env::args().nth(1).map_or(Ok(10), |count| count.parse())?;
    let golden = Golden::new(edof::presets::weights::fixed("edof-t4w12-outer-light")?)?;
    // A frame is read, aligned and reconstructed, and its words become colours: what `edof reconstruct` does between its files.
    let file =
        Array2::from_shape_fn((1080, 1920), |(row, column)| ((row * 2003 + column * 331) % 4096) as u16);
    let frame = || -> Result<f32, Box<dyn std::error::Error>> {
        let raw = RawFrame::from_values(file.clone(), 12, CfaPhase::Rggb)?;
        Ok(golden.frame_of_light(&raw)?.1.planes[(0, 5, 5)])
    };
    frame()?;
    let mut seconds = vec![];
    for _ in 0..frames {
        let before = cpu_time::seconds().unwrap_or(f64::NAN);
        frame()?;
        seconds.push(cpu_time::seconds().unwrap_or(f64::NAN) - before);
    }
    seconds.sort_by(f64::total_cmp);
    println!("{:.4} {:.4}", seconds[0], seconds[frames / 2]);
    Ok(())
}
