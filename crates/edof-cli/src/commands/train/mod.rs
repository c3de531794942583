//! `edof train`: a float network from photographs.

mod blurs;
mod checkpoints;
mod length;
mod options;
pub mod photographs;
mod progress;
mod recipe;
mod seed;
mod tell;

pub use blurs::blurred_bytes;
pub use options::{Args, DEPTHS, usual_threads};
pub use recipe::default_of;

use crate::error::Error;
use crate::files::Files;
use crate::kind::Kind;
use crate::lens::{self, Lens};
use crate::ui::Ui;
use crate::{advice, interrupt, psf_bank, said, weights};
use edof_core::storage::name;
use edof_core::storage::provenance::{Input, Provenance};
use edof_core::{Noise, Tone};
use edof_network::network::{Form, Network};
use edof_network::weight_file;
use edof_train::checkpoint::Run;
use edof_train::recipe::Recipe;
use edof_train::threads::check_threads;
use seed::one_seed;
use std::path::PathBuf;

/// # Errors
/// Photographs, options or a checkpoint that cannot be used, a file that cannot be written, or Ctrl-C.
pub fn run(args: &Args, ui: &Ui) -> Result<(), Error> {
    if !name::is_title(&args.name()) {
        let found = name::quoted(&args.name());
        return Err(Error::message(format!("--name: is {found}, expected {}", name::TITLE)));
    }
    args.check_budget()?;
    let from = args.from.as_deref().map(Beginning::load).transpose()?;
    let recipes = recipe::recipes(args, from.as_ref().map(|from| &from.network))?;
    let seeds: Vec<(Recipe, PathBuf)> =
        recipes.into_iter().map(|recipe| (recipe.clone(), args.checkpoint_file(recipe.seed))).collect();
    let Lens { mut camera, files } = lens::resolve(&args.camera, args.bank.file())?;
    let files = Files::new(ui).reads_all(files).reads_all(args.from.as_deref().and_then(weights::float_file));
    let files =
        args.images.iter().fold(files, Files::reads_pictures_of).writes_as(Kind::Weights, "--out", &args.out);
    let _lock = checkpoints::lock(&args.out)?;
    checkpoints::check(args, &seeds)?;
    let files = files.keeps(args.force);
    seeds.iter().fold(files, |files, (_, file)| files.writes("checkpoint", file)).check()?;
    camera.psi_range = args
        .psi
        .map_or(Ok(camera.psi_range), |range| range.psi(&camera))
        .map_err(|e| Error::message(format!("--psi {e}")))?;
    camera.focus_psi = *args.focus.first().unwrap_or(&camera.focus_psi);
    if camera.psf_bank.is_some() && !args.focus.is_empty() {
        return Err(Error::message(
            "--focus: the camera's PSFs are those of a bank, which has one focus; leave --focus or the bank out",
        ));
    }
    ui.used(camera.input());
    from.iter().for_each(|from| ui.used(from.input.clone()));
    let recipe = &seeds[0].0;
    recipe.check().map_err(said::recipe)?;
    check_threads(args.threads()).map_err(said::recipe)?;
    said::memory(&format!("--batch {}", recipe.batch), recipe.batch as f64 * bytes_a_window(&recipe.form))?;
    let psis = spread(camera.psi_range, args.depths)?;
    let [least, most] = recipe.conditions.gain;
    // A second exposure is no question of the lens.
    if recipe.tone == Tone::Srgb && args.focus.is_empty() {
        advice::note(&camera, Noise::sensor((least * most).sqrt().into()), ui);
    }
    let mut photographs =
        photographs::photographs(&args.images, args.photos.as_ref(), &|line| ui.note(line))?;
    photographs::leave_out(&mut photographs, &args.leave_out)?;
    let photos: Vec<Input> = photographs.iter().map(|p| Input::photograph(&p.name(), &p.frame)).collect();
    photos.iter().for_each(|photo| ui.used(photo.clone()));
    psf_bank::list(&camera, ui)?;
    let dataset = blurs::dataset(&photographs, &camera, recipe.dataset(&psis), &photos, !args.no_cache, ui)?;
    if from.is_none() && !args.resume {
        length::short(recipe).into_iter().for_each(|line| ui.note(line));
    }
    let mut results = Vec::new();
    for (recipe, file) in &seeds {
        let run = Run {
            recipe: recipe.clone(),
            camera: camera.to_json(),
            photos: photos.clone(),
            psis: psis.clone(),
            from: from.as_ref().map(|from| from.input.clone()),
        };
        results.push(one_seed(&dataset, &run, from.as_ref().map(|from| &from.network), file, args, ui)?);
    }
    let [first, others @ ..] = &mut results[..] else { unreachable!("one seed at least") };
    let chosen = others
        .iter_mut()
        .fold(first, |best, other| if other.best().score > best.best().score { other } else { best });
    let recipe = chosen.trainer.recipe();
    let state = &chosen.trainer.state;
    let is_cut = state.step < recipe.steps && state.stale < recipe.patience;
    let command = recipe::command(args, recipe, is_cut);
    let made = Provenance { command, seed: Some(recipe.seed), ..ui.provenance().for_file() };
    let network = chosen.trainer.best(&args.name(), &camera, made);
    weight_file::save_network(&args.out, &network)?;
    for (_, file) in &seeds {
        let _ = std::fs::remove_file(file);
    }
    interrupt::keeps(None);
    let seed = chosen.trainer.recipe().seed;
    tell::tell(&network, &results, seed, &photographs, args, ui)
}

/// A trained network to continue from.
struct Beginning {
    network: Network,
    input: Input,
}

impl Beginning {
    fn load(name: &str) -> Result<Self, Error> {
        Ok(Self { network: weights::float(name)?, input: weights::float_input(name)? })
    }
}

/// Memory that a step takes for each of its windows: inputs, targets, and what the gradient needs of every layer.
fn bytes_a_window(form: &Form) -> f64 {
    let words = form.inputs() + 3 * 192 + 4 * form.codes * form.layers;
    (words * size_of::<f32>()) as f64
}

/// Depths that are trained, evenly over a range.
///
/// # Errors
/// No depth, or too many.
pub fn spread([low, high]: [f64; 2], count: usize) -> Result<Vec<f64>, Error> {
    match count {
        0 | 1001.. => Err(Error::message(format!("--depths {count}: must be 1 to 1000"))),
        1 => Ok(vec![0.5 * (low + high)]),
        _ => Ok((0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_spread_over_the_whole_range() {
        assert_eq!(spread([0.0, 8.0], 5).unwrap(), [0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!(spread([0.0, 8.0], 1).unwrap(), [4.0]);
        assert!(spread([0.0, 8.0], 0).is_err());
    }
}
