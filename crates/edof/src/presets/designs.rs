//! Designs by name or by file: `kc705` stands for `designs/kc705.json`, which travels inside the program.

use crate::presets::{PresetError, weights};
use edof_core::storage::input;
use edof_core::storage::provenance::{Input, InputKind};
use edof_device::Design;
use edof_network::FixedNetwork;
use std::path::Path;

/// The designs inside the program.
const EMBEDDED: [(&str, &str); 5] = [
    ("tiny", include_str!("../../../../designs/tiny.json")),
    ("paper", include_str!("../../../../designs/paper.json")),
    ("kc705", include_str!("../../../../designs/kc705.json")),
    ("kc705-slow", include_str!("../../../../designs/kc705-slow.json")),
    ("ulx3s", include_str!("../../../../designs/ulx3s.json")),
];

/// Loads a design by file, or by name.
///
/// # Errors
/// Nothing of that name, or a file that holds no usable design.
pub fn load(name_or_path: &str) -> Result<Design, PresetError> {
    let path = Path::new(name_or_path);
    if input::is_file(path) {
        return Ok(Design::load(path)?);
    }
    match EMBEDDED.iter().find(|(name, _)| *name == name_or_path) {
        Some((_, text)) => Ok(Design::from_json(text)?),
        // What is there is no design, but a pipe, a folder or the like.
        None if path.exists() => Ok(Design::load(path)?),
        None => Err(PresetError::NoDesign { name: name_or_path.into(), own: names().join(", ") }),
    }
}

/// Names of the designs inside the program.
#[must_use]
pub fn names() -> Vec<&'static str> {
    EMBEDDED.map(|(name, _)| name).to_vec()
}

/// The designs inside the program.
///
/// # Errors
/// None, unless the program was built from broken ones.
pub fn all() -> Result<Vec<Design>, PresetError> {
    EMBEDDED.iter().map(|(_, text)| Ok(Design::from_json(text)?)).collect()
}

/// Whether a network fits a design, for who chose both by name.
///
/// # Errors
/// Design and network do not fit each other; the error states the difference and the expected value.
pub fn fits(design: &Design, network: &FixedNetwork) -> Result<(), PresetError> {
    fits_given(design, &design.name, network)
}

/// The same of a design that the user `given` named so: by its name, or by its file.
///
/// # Errors
/// As [`fits`].
pub fn fits_given(design: &Design, given: &str, network: &FixedNetwork) -> Result<(), PresetError> {
    let file = if input::is_file(Path::new(given)) { format!("--design {given}: ") } else { String::new() };
    let Err(misfit) = design.check_network(network) else { return Ok(()) };
    let fitting = |name: &&str| weights::fixed(name).is_ok_and(|own| design.check_network(&own).is_ok());
    let own: Vec<&str> = weights::names().into_iter().filter(fitting).collect();
    let instead = match own[..] {
        [] => format!("make one that does by 'edof random-network --design {given}'"),
        _ => format!("use --weights {}", own.join(" or ")),
    };
    Err(PresetError::Misfit { file, misfit: Box::new(misfit), instead })
}

/// A design as the input of a result, by its JSON.
#[must_use]
pub fn input(design: &Design) -> Input {
    let json = serde_json::to_string(design).unwrap_or_default();
    Input::of_bytes(InputKind::Design, &design.name, json.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_design_inside_the_program_is_usable() {
        for (name, _) in EMBEDDED {
            assert_eq!(load(name).unwrap().name, name);
        }
    }

    #[test]
    fn every_network_inside_the_program_fits_a_design_inside_it() {
        for name in crate::presets::weights::names() {
            let network = crate::presets::weights::fixed(name).unwrap();
            let designs = all().unwrap();
            assert!(designs.iter().any(|design| fits(design, &network).is_ok()), "{name}");
        }
    }
}
