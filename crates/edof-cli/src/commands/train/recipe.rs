//! Recipes of `edof train` from its options, and the command that states one in full.

use super::options::{Args, Only, Start, Weighting};
use crate::error::Error;
use crate::form;
use crate::limits::all_within;
use crate::provenance::CommandLine;
use crate::said;
use clap::ValueEnum;
use edof_core::Tone;
use edof_core::words::count;
use edof_network::float::parameters::flatten;
use edof_network::network::Network;
use edof_train::budget::Budget;
use edof_train::recipe::Recipe;
use std::path::Path;

/// One recipe for each seed.
pub(super) fn recipes(args: &Args, from: Option<&Network>) -> Result<Vec<Recipe>, Error> {
    let form = match (args.form, from.map(|from| from.form)) {
        (Some(form), Some(found)) if form != found => {
            let name = args.from.as_deref().unwrap_or_default();
            return Err(Error::message(format!(
                "--from {name}: its form is {}, that of --form {}; leave --form out, or train without --from",
                form::words(&found),
                form::words(&form)
            )));
        }
        (form, found) => form.or(found).unwrap_or_else(|| unreachable!("the options ask for one of them")),
    };
    let mut recipe = Recipe::new(form);
    recipe.further_foci = further_foci(&args.focus, form.exposures)?;
    set(&mut recipe.conditions.noise, args.noise.map(narrow));
    set(&mut recipe.conditions.gain, args.gain.map(narrow));
    set(&mut recipe.conditions.noiseless, args.noiseless);
    set(&mut recipe.conditions.flat, args.flat);
    set(&mut recipe.conditions.exposure, args.exposure.map(narrow));
    set(&mut recipe.augmentation.variants, args.variants);
    set(&mut recipe.augmentation.saturation, args.saturation.map(narrow));
    set(&mut recipe.augmentation.hue, args.hue);
    set(&mut recipe.augmentation.scale, args.scale);
    set(&mut recipe.batch, args.batch);
    set(&mut recipe.steps, args.steps);
    set(&mut recipe.rate, args.rate);
    set(&mut recipe.output_rate, args.output_rate);
    set(&mut recipe.threshold_rate, args.threshold_rate);
    set(&mut recipe.averaging, args.averaging);
    set(&mut recipe.trained, args.only.map(Into::into));
    set(&mut recipe.structure, args.structure);
    if let Some(from) = from.filter(|from| !recipe.structure.is_kept_by(&form, &flatten(from))) {
        return Err(Error::message(format!(
            "--structure {}: the network {} of --from was not trained with it; leave --from or --structure out",
            recipe.structure, from.origin.name
        )));
    }
    set(&mut recipe.validate_every, args.validate_every);
    set(&mut recipe.patience, args.patience);
    set(&mut recipe.lambda, Some(args.lambda.clone()).filter(|l| !l.is_empty()));
    set(&mut recipe.tone, from.and_then(tone_of));
    set(&mut recipe.tone, args.tone);
    if let Some(from) = from.filter(|from| from.origin.values != recipe.tone) {
        return Err(Error::message(format!(
            "--from: the network {} takes {} values, and a training with --tone {} makes one that takes {} values; leave --from out",
            from.origin.name, from.origin.values, recipe.tone, recipe.tone
        )));
    }
    set(&mut recipe.weighting, args.weighting.map(Into::into));
    set(&mut recipe.start, args.start.map(Into::into));
    recipe.budget = budget(args, recipe.budget.take())?;
    let mut seeds: Vec<u64> = args.seed.clone();
    if seeds.is_empty() {
        seeds.push(recipe.seed);
    }
    if let Some(twice) = seeds.iter().enumerate().find(|(i, s)| seeds[..*i].contains(s)) {
        return Err(Error::message(format!("--seed: {} is given twice", twice.1)));
    }
    Ok(seeds.into_iter().map(|seed| Recipe { seed, ..recipe.clone() }).collect())
}

/// The foci after the camera's own, one for each further exposure of the form.
fn further_foci(focus: &[f64], exposures: usize) -> Result<Vec<f64>, Error> {
    all_within("--focus", focus, -100.0, 100.0)?;
    let [_, further @ ..] = focus else {
        return match exposures {
            1 => Ok(vec![]),
            _ => Err(Error::message(format!(
                "--focus: is missing, expected {exposures} values, one for each exposure of the form, as in 2,6"
            ))),
        };
    };
    if focus.len() != exposures {
        let found = count(focus.len(), "value");
        return Err(Error::message(format!(
            "--focus {}: has {found}, expected {exposures}, one for each exposure of the form; keyword e{} of --form makes as many",
            joined(focus),
            focus.len()
        )));
    }
    Ok(further.to_vec())
}

/// The tone that a network was trained on.
fn tone_of(network: &Network) -> Option<Tone> {
    network.origin.conditions.first().map(|condition| condition.tone)
}

fn budget(args: &Args, usual: Option<Budget>) -> Result<Option<Budget>, Error> {
    let mut budget = match args.non_zeros.as_deref() {
        None => usual,
        Some("none") => None,
        Some(text) => {
            let numbers = text.split(',').map(said::single).collect::<Result<Vec<f32>, _>>();
            let non_zeros = numbers.map_err(|why| {
                Error::message(format!("--non-zeros {text}: {why}; numbers as in 65,65,58, or none"))
            })?;
            Some(Budget { non_zeros, rate: usual.map_or(Budget::RATE, |b| b.rate) })
        }
    };
    match (&mut budget, args.budget_rate) {
        (Some(budget), rate) => set(&mut budget.rate, rate),
        (None, Some(_)) => {
            return Err(Error::message("--budget-rate: there is no budget; give --non-zeros too"));
        }
        (None, None) => (),
    }
    Ok(budget)
}

fn set<T>(field: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *field = value;
    }
}

fn narrow(range: [f64; 2]) -> [f32; 2] {
    range.map(|v| v as f32)
}

/// An option's value in a recipe; none for an option that sets no part of one.
fn stated(option: &str, r: &Recipe) -> Option<String> {
    let (c, a) = (&r.conditions, &r.augmentation);
    let pair = |[low, high]: [f32; 2]| format!("{low}:{high}");
    Some(match option {
        "tone" => r.tone.to_string(),
        "noise" => pair(c.noise),
        "gain" => pair(c.gain),
        "noiseless" => c.noiseless.to_string(),
        "flat" => c.flat.to_string(),
        "exposure" => pair(c.exposure),
        "variants" => a.variants.to_string(),
        "saturation" => pair(a.saturation),
        "hue" => a.hue.to_string(),
        "scale" => a.scale.to_string(),
        "weighting" => word(Weighting::from(r.weighting)),
        "steps" => r.steps.to_string(),
        "batch" => r.batch.to_string(),
        "rate" => r.rate.to_string(),
        "output-rate" => r.output_rate.to_string(),
        "threshold-rate" => r.threshold_rate.to_string(),
        "averaging" => r.averaging.to_string(),
        "only" => word(Only::from(r.trained)),
        "structure" => r.structure.to_string(),
        "lambda" => joined(&r.lambda),
        "non-zeros" => r.budget.as_ref().map_or_else(|| "none".to_owned(), |b| joined(&b.non_zeros)),
        "budget-rate" => r.budget.as_ref().map_or(Budget::RATE, |b| b.rate).to_string(),
        "start" => word(Start::from(r.start)),
        "seed" => r.seed.to_string(),
        "validate-every" => r.validate_every.to_string(),
        "patience" => r.patience.to_string(),
        _ => return None,
    })
}

/// An option's default for its help: that of [`Recipe::new`] for both forms that have a name; none for an option that sets no part
/// of a recipe.
pub fn default_of(option: &str) -> Option<String> {
    let of = |name: &str| stated(option, &Recipe::new(form::parse(name).ok()?));
    let (own, papers) = (of("edof-t4w12")?, of("paper-t4")?);
    Some(if own == papers { own } else { format!("{own} for edof-t4w12, {papers} for paper-t4") })
}

/// The command that makes this network, with everything that its bytes depend on and nothing else, so that a resumed run
/// writes the same bytes as an unbroken one. A run that `--minutes` ended states it: no command makes its bytes again.
pub(super) fn command(args: &Args, r: &Recipe, is_cut: bool) -> String {
    let mut line = CommandLine::new("edof train");
    line.option("form", form::words(&r.form)).option("camera", &args.camera);
    line.option_if(
        "psf-bank",
        args.bank.psf_bank.as_deref().and_then(Path::file_name).map(Path::new).map(Path::display),
    );
    line.flag_if("centre", args.bank.centre).option_if("psi", args.psi);
    line.option_if("focus", Some(joined(&args.focus)).filter(|foci| !foci.is_empty()));
    line.option_if("photos", args.photos.as_ref());
    line.option_if("leave-out", Some(args.leave_out.join(",")).filter(|names| !names.is_empty()));
    line.option("depths", args.depths);
    let mut of_recipe = |options: &[&str]| {
        for option in options {
            line.option_if(option, stated(option, r));
        }
    };
    of_recipe(&[
        "tone",
        "noise",
        "gain",
        "noiseless",
        "flat",
        "exposure",
        "variants",
        "saturation",
        "hue",
        "scale",
    ]);
    of_recipe(&[
        "weighting",
        "steps",
        "batch",
        "rate",
        "output-rate",
        "threshold-rate",
        "averaging",
        "only",
        "structure",
        "lambda",
        "non-zeros",
    ]);
    of_recipe(if r.budget.is_some() { &["budget-rate"] } else { &[] });
    line.option_if("minutes", args.minutes.filter(|_| is_cut).map(|limit| limit.as_secs_f64() / 60.0));
    match &args.from {
        Some(from) => line.option("from", Path::new(from).file_name().unwrap_or_default().display()),
        None => line.option_if("start", stated("start", r)),
    };
    line.option("seed", if args.seed.is_empty() { r.seed.to_string() } else { joined(&args.seed) });
    line.option_if("validate-every", stated("validate-every", r))
        .option_if("patience", stated("patience", r));
    line.option("out", format!("{}.safetensors", args.name()));
    line.to_string()
}

/// What users call a value.
fn word(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |word| word.get_name().to_owned())
}

fn joined<T: ToString>(values: &[T]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}
