//! Patches a second that the trainer makes of `edof-t4w12`, and the data for a peer to do the same.
//!
//! `cargo run --release -p edof-train --example throughput -- DATA.safetensors [THREADS]` writes 32,768 windows, their patches, and
//! the starting weights to DATA, then trains for 10 seconds and prints one JSON line. `benches/peers/train_pytorch.sh` runs both.

use edof_core::Window;
use edof_core::camera::Camera;
use edof_network::network::{Form, Recurrence, Shrinkage};
use edof_numerics::random::Random;
use edof_optics::draw::leaves;
use edof_train::dataset::{Batch, Dataset};
use edof_train::recipe::Recipe;
use edof_train::train::Trainer;
use safetensors::tensor::{Dtype, TensorView};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

const WINDOWS: usize = 32_768;
const SECONDS: f64 = 10.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("usage: throughput DATA.safetensors [THREADS]")?;
    let threads: usize = args.next().map_or(Ok(2), |t| t.parse())?;
    let form = Form {
        window: Window::new(12)?,
        codes: 192,
        layers: 4,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    };
    let recipe = Recipe::new(form);
    let camera = Camera::resolve("ring-2018")?;
    let photo = leaves::layers(512, 768, 1)[0].light.clone();
    let options = recipe.dataset(&[0.0, 4.0, 8.0]);
    let dataset =
        Dataset::new(&[photo], &camera, options, |_, _| ControlFlow::Continue(()))?.ok_or("interrupted")?;
    export(Path::new(&path), &form, &dataset, &recipe, threads)?;
    let mut trainer = Trainer::new(recipe, &dataset, threads)?;
    for _ in 0..50 {
        trainer.step();
    }
    let (start, first) = (Instant::now(), trainer.state.step);
    while start.elapsed().as_secs_f64() < SECONDS {
        trainer.step();
    }
    let patches = (trainer.state.step - first) * trainer.recipe().batch as u64;
    let rate = patches as f64 / start.elapsed().as_secs_f64();
    println!(
        "{}",
        serde_json::json!({
            "method": "edof", "threads": threads, "batch": trainer.recipe().batch, "patches_per_second": rate
        })
    );
    Ok(())
}

/// Windows, patches and starting weights as safetensors.
fn export(
    path: &Path,
    form: &Form,
    dataset: &Dataset,
    recipe: &Recipe,
    threads: usize,
) -> Result<(), Box<dyn Error>> {
    let mut batch = Batch::new(form.inputs(), WINDOWS);
    dataset.draw(&mut Random::new(recipe.seed, 0, 0), &recipe.conditions, &mut batch);
    // Before the first validation, the best weights are those that training starts from.
    let weights = Trainer::new(recipe.clone(), dataset, threads)?.state.best_weights;
    let bytes = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let tensors = [
        ("inputs", vec![WINDOWS, form.window.pixels()], bytes(&batch.inputs)),
        ("targets", vec![WINDOWS, edof_core::colour::RGB_OUTPUTS], bytes(&batch.targets)),
        ("weights", vec![weights.len()], bytes(&weights)),
    ];
    let views = tensors
        .iter()
        .map(|(name, shape, bytes)| Ok((*name, TensorView::new(Dtype::F32, shape.clone(), bytes)?)))
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()?;
    edof_core::storage::atomic::write(path, &safetensors::serialize(views, None)?)?;
    Ok(())
}
