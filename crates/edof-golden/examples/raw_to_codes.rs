//! A raw frame through the board's integers, to the codes at its HDMI port: `cargo run --release -p edof-golden --example raw_to_codes`

use edof_core::{CfaPhase, RawFrame, cable};
use edof_golden::{Display, Golden};
use edof_network::weight_file;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let weights =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../weights/edof-t4w12-outer-light.fixed.safetensors");
    let golden = Golden::new(weight_file::load_fixed(&weights)?)?;

    // A grey ramp, as a sensor of 12 bits gives it; the cable carries the upper 14 bits of each word.
    let values = ndarray::Array2::from_shape_fn((96, 128), |(_, column)| 32 * column as u16);
    let light = RawFrame::from_values(values, 12, CfaPhase::Rggb)?;
    let raw = cable::carried(&light.encoded(golden.network().origin.values));

    let frame = golden.frame(&raw)?;
    println!("{} patches, {} saturated words", frame.counts.patches, frame.counts.saturations());
    let (picture, _) = frame.picture(&Display::of_network(golden.network()));
    println!(
        "luma codes of the middle row: {:?}",
        picture.luma.row(48).iter().step_by(16).collect::<Vec<_>>()
    );

    // Every word between the stages, by the names of docs/contract.md.
    for boundary in golden.words(&raw)? {
        println!("{}: {:?}", boundary.name, boundary.words.dim());
    }
    Ok(())
}
