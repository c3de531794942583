//! Options that have an effect only beside others. Such an option is an error where it is given in vain, and a stated command leaves it
//! out there. A value that equals the default is accepted in silence: commands that older results state repeat all defaults.

use crate::error::Error;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command};

/// What an option needs to have an effect.
#[derive(Clone, Copy)]
enum Needs {
    /// Another option.
    With(&'static str),
    /// The absence of another option.
    Without(&'static str),
    /// Another command.
    Elsewhere,
}

use Needs::{Elsewhere, With, Without};

/// A command's words, with `*` for any; an option; what it needs.
type Row = (&'static [&'static str], &'static str, Needs);

const ROWS: [Row; 33] = [
    (&["capture"], "map_of", With("depth_map")),
    (&["capture"], "layers", With("depth_map")),
    (&["capture"], "values", With("video")),
    (&["capture"], "energy", Without("exact")),
    (&["capture"], "wavelength_tolerance", Without("exact")),
    (&["capture"], "depth_tolerance", Without("exact")),
    (&["optics"], "energy", Without("exact")),
    (&["compare"], "map_gain", With("map")),
    (&["quantize"], "photos", With("images")),
    (&["quantize"], "finetune_rate", With("finetune")),
    (&["reconstruct"], "order", With("size")),
    (&["reconstruct"], "bits", Without("board")),
    (&["reconstruct"], "display", Without("float")),
    (&["reconstruct"], "display", Without("demosaic")),
    (&["reconstruct"], "device", Without("demosaic")),
    (&["sensor"], "order", With("size")),
    (&["sensor"], "hot", With("dark")),
    (&["sensor"], "dead", With("flat")),
    (&["random-network"], "kind", Without("design")),
    (&["random-network"], "form", Without("design")),
    (&["random-network"], "bits", Without("design")),
    (&["random-network"], "stride", Without("design")),
    (&["cosim"], "patches", Without("system")),
    (&["cosim"], "patches", Without("random")),
    (&["cosim"], "stalls", Without("system")),
    (&["cosim"], "frames", With("system")),
    (&["cosim"], "display", With("system")),
    (&["study", "*"], "external_seconds", With("external")),
    (&["board", "sim"], "port", Elsewhere),
    (&["board", "sim"], "patience", Elsewhere),
    (&["board", "map"], "port", Elsewhere),
    (&["board", "map"], "baud", Elsewhere),
    (&["board", "map"], "patience", Elsewhere),
];

/// Why an option of a command has no effect in this run; none where it has one.
pub fn idle(words: &[&str], id: &str, command: &Command, matches: &ArgMatches) -> Option<String> {
    let is_of = |path: &[&str]| {
        path.len() == words.len() && path.iter().zip(words).all(|(part, word)| *part == "*" || part == word)
    };
    ROWS.iter().filter(|(path, option, _)| *option == id && is_of(path)).find_map(|(.., needs)| match needs {
        With(other) if !is_used(other, command, matches) => {
            Some(format!("has an effect only with {}", shown(other, command)))
        }
        Without(other) if is_used(other, command, matches) => {
            Some(format!("has no effect with {}", shown(other, command)))
        }
        Elsewhere => Some(format!("has no effect on edof {}", words.join(" "))),
        _ => None,
    })
}

/// Rejects an option that was given in vain.
///
/// # Errors
/// The first such option, with what it needs.
pub fn check(matches: &ArgMatches, root: &Command) -> Result<(), Error> {
    let (mut matches, mut command, mut words) = (matches, root, vec![]);
    while let Some((name, inner)) = matches.subcommand() {
        let Some(found) = command.find_subcommand(name) else { break };
        words.push(name);
        (matches, command) = (inner, found);
    }
    for argument in command.get_arguments() {
        let id = argument.get_id().as_str();
        if let Some(why) = idle(&words, id, command, matches)
            && is_given(id, matches)
            && is_used(id, command, matches)
        {
            let value = raw(id, matches).join(",");
            let name = shown(id, command);
            return Err(Error::message(format!("{name} {value}: {why}; leave {name} out")));
        }
    }
    Ok(())
}

fn argument<'a>(id: &str, command: &'a Command) -> Option<&'a Arg> {
    command.get_arguments().find(|argument| argument.get_id() == id)
}

fn shown(id: &str, command: &Command) -> String {
    let long = argument(id, command).and_then(Arg::get_long).unwrap_or(id);
    format!("--{long}")
}

fn is_given(id: &str, matches: &ArgMatches) -> bool {
    matches!(matches.try_contains_id(id), Ok(true))
        && matches.value_source(id) == Some(ValueSource::CommandLine)
}

fn raw(id: &str, matches: &ArgMatches) -> Vec<String> {
    let values = matches.try_get_raw(id).ok().flatten().into_iter().flatten();
    values.map(|value| value.to_string_lossy().into_owned()).collect()
}

/// Whether an option has another value than its default, which for a flag is false.
fn is_used(id: &str, command: &Command, matches: &ArgMatches) -> bool {
    let (values, usual) = (raw(id, matches), argument(id, command).map(Arg::get_default_values));
    let usual: Vec<_> = usual.unwrap_or_default().iter().map(|value| value.to_string_lossy()).collect();
    let is_same = |value: &str, usual: &str| match (value.parse::<f64>(), usual.parse::<f64>()) {
        (Ok(value), Ok(usual)) => value == usual,
        _ => value == usual,
    };
    match usual.is_empty() {
        true => values.iter().any(|value| value != "false"),
        false => {
            values.len() != usual.len()
                || values.iter().zip(&usual).any(|(value, usual)| !is_same(value, usual))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn of(line: &str) -> Result<(), String> {
        let mut root = crate::Cli::command();
        let matches = root.try_get_matches_from_mut(line.split(' ')).unwrap();
        check(&matches, &root).map_err(|error| error.to_string())
    }

    #[test]
    fn every_row_names_options_of_its_command() {
        let root = {
            let mut root = crate::Cli::command();
            root.build();
            root
        };
        for (path, option, needs) in ROWS {
            let mut commands = vec![&root];
            for part in path {
                commands = commands
                    .iter()
                    .flat_map(|command| command.get_subcommands())
                    .filter(|inner| *part == "*" || inner.get_name() == *part)
                    .collect();
            }
            let names = |command: &Command, id: &str| argument(id, command).is_some();
            let whole = |command: &&Command| {
                names(command, option)
                    && match needs {
                        With(other) | Without(other) => names(command, other),
                        Elsewhere => true,
                    }
            };
            assert!(commands.iter().any(whole), "{path:?} {option}");
        }
    }

    #[test]
    fn an_option_in_vain_is_rejected_and_its_default_is_not() {
        let capture = "edof capture a.png --psi 1 --out b.png";
        assert_eq!(
            of(&format!("{capture} --layers 8")).unwrap_err(),
            "--layers 8: has an effect only with --depth-map; leave --layers out"
        );
        assert_eq!(
            of(&format!("{capture} --exact --energy 0.9")).unwrap_err(),
            "--energy 0.9: has no effect with --exact; leave --energy out"
        );
        for more in ["", " --layers 16 --map-of nearness", " --exact --energy 0.9990", " --energy 0.9"] {
            assert_eq!(of(&format!("{capture}{more}")), Ok(()), "{more}");
        }
        assert_eq!(of("edof quantize x --finetune 0"), Ok(()));
        assert_eq!(of("edof quantize x --finetune 9 --finetune-rate 0.7"), Ok(()));
        assert!(of("edof quantize x --finetune 0 --finetune-rate 0.7").is_err());
        assert_eq!(of("edof board sim --design tiny"), Ok(()));
        assert_eq!(
            of("edof board --port x sim --design tiny").unwrap_err(),
            "--port x: has no effect on edof board sim; leave --port out"
        );
    }
}
