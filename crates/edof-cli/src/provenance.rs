//! What the program writes about itself into its results: the command as it was understood, the revision it was built from, the
//! machine it runs on (docs/decisions/0011-provenance.md).

use crate::effects;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use edof_core::storage::provenance::{Host, Provenance};
use edof_study::journal::{Program, UNKNOWN};

/// Options that no byte of a result depends on: paths of files, amount of output, number of threads.
const NOT_IN_RESULTS: [&str; 21] = [
    "progress", "no_cache", "json", "quiet", "out", "images", "report", "sharp", "light", "resume",
    "threads", "waveform", "junit", "words", "rows", "markdown", "latex", "csv", "shard", "plot", "force",
];

/// The record of this run, as far as it is known before the work begins.
pub fn of_run(matches: &ArgMatches, root: &Command) -> Provenance {
    Provenance {
        command: command(matches, root, Places::LeftOut),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        revision: option_env!("EDOF_REVISION").map(str::to_owned),
        seed: seed(matches),
        inputs: vec![],
        host: host(),
    }
}

/// The command of this run in full, as pages state it: anybody who runs it in the same folder gets the same files.
pub fn whole_command(matches: &ArgMatches, root: &Command) -> String {
    command(matches, root, Places::AsGiven)
}

/// What measures in this run.
pub fn program() -> Program {
    Program {
        revision: option_env!("EDOF_REVISION").unwrap_or(UNKNOWN).to_owned(),
        compiler: env!("EDOF_COMPILER").to_owned(),
        host: host(),
    }
}

/// What becomes of options that no byte of a result depends on, and of folders.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Places {
    /// Of paths only the names are left: the same work in another folder is the same work.
    LeftOut,
    /// As the user gave them; none that he did not.
    AsGiven,
}

/// The command with every option that has a value, defaults written out, in the order of the help; without options that have no effect
/// there. The only place where command lines are made from a run.
fn command(mut matches: &ArgMatches, mut root: &Command, places: Places) -> String {
    let mut path = vec![];
    while let Some((name, inner)) = matches.subcommand() {
        let Some(command) = root.find_subcommand(name) else { break };
        path.push(name);
        (matches, root) = (inner, command);
    }
    let mut words = vec!["edof".to_owned()];
    words.extend(path.iter().map(|name| (*name).to_owned()));
    let is_stated = |argument: &&Arg| {
        let id = argument.get_id().as_str();
        let is_given = || {
            matches!(matches.try_contains_id(id), Ok(true))
                && matches.value_source(id) == Some(ValueSource::CommandLine)
        };
        let is_effective = effects::idle(&path, id, root, matches).is_none();
        is_effective && (!NOT_IN_RESULTS.contains(&id) || places == Places::AsGiven && is_given())
    };
    let arguments = root.get_arguments().filter(is_stated);
    // Positional arguments first: the command can be run again whatever follows.
    let (first, rest): (Vec<_>, Vec<_>) = arguments.partition(|a| a.is_positional());
    first.into_iter().chain(rest).for_each(|argument| words.extend(written(argument, matches, places)));
    words.join(" ")
}

fn written(argument: &Arg, matches: &ArgMatches, places: Places) -> Vec<String> {
    let id = argument.get_id().as_str();
    let values: Vec<String> = match matches.try_get_raw(id) {
        Ok(Some(values)) => values.map(|v| v.to_string_lossy().into_owned()).collect(),
        _ => return vec![],
    };
    let stated = |value: &str| match places {
        Places::LeftOut => file_name(value).to_owned(),
        Places::AsGiven => value.to_owned(),
    };
    let name = argument.get_long().map(|long| format!("--{long}"));
    match (argument.get_action(), name) {
        (ArgAction::SetTrue, Some(name)) => {
            if values.iter().any(|v| v == "true") {
                vec![name]
            } else {
                vec![]
            }
        }
        (_, Some(name)) if argument.get_value_delimiter().is_some() => {
            let names: Vec<String> = values.iter().map(|v| stated(v)).collect();
            vec![name, quoted(&names.join(","))]
        }
        (_, Some(name)) => values.iter().flat_map(|v| [name.clone(), quoted(&stated(v))]).collect(),
        (_, None) => values.iter().map(|v| quoted(&stated(v))).collect(),
    }
}

/// Of a path, what is not its place.
fn file_name(word: &str) -> &str {
    word.rsplit('/').next().unwrap_or(word)
}

/// A command line, put together option by option.
pub struct CommandLine(String);

impl CommandLine {
    /// The command and its sub-commands.
    pub fn new(command: &str) -> Self {
        Self(command.to_owned())
    }

    /// Adds `--name value`.
    pub fn option(&mut self, name: &str, value: impl std::fmt::Display) -> &mut Self {
        self.0 += &format!(" --{name} {}", quoted(&value.to_string()));
        self
    }

    /// Adds `--name` where it was given.
    pub fn flag_if(&mut self, name: &str, is_given: bool) -> &mut Self {
        if is_given {
            self.0 += &format!(" --{name}");
        }
        self
    }

    /// Adds `--name value` where there is a value.
    pub fn option_if(&mut self, name: &str, value: Option<impl std::fmt::Display>) -> &mut Self {
        if let Some(value) = value {
            self.option(name, value);
        }
        self
    }
}

impl std::fmt::Display for CommandLine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// A word as a shell takes it back.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

fn seed(matches: &ArgMatches) -> Option<u64> {
    let (_, inner) = matches.subcommand()?;
    let mut values = inner.try_get_raw("seed").ok()??;
    values.next()?.to_str()?.parse().ok()
}

fn host() -> Host {
    let threads = std::thread::available_parallelism().ok().map(usize::from);
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu = fact(&text, "model name").unwrap_or(std::env::consts::ARCH).to_owned();
    let number = |name| fact(&text, name)?.parse().ok();
    Host { cpu, family: number("cpu family"), model: number("model"), isa: isa(), threads }
}

/// What Linux states of the first CPU under a name.
fn fact<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let mut facts = text.lines().filter_map(|line| line.split_once(':'));
    facts.find(|(key, _)| key.trim() == name).map(|(_, value)| value.trim())
}

#[cfg(target_arch = "x86_64")]
fn isa() -> String {
    let found = [
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
        ("avx512bw", is_x86_feature_detected!("avx512bw")),
        ("avx512vnni", is_x86_feature_detected!("avx512vnni")),
    ];
    let names: Vec<&str> = found.iter().filter(|(_, there)| *there).map(|(name, _)| *name).collect();
    names.join(" ")
}

#[cfg(not(target_arch = "x86_64"))]
fn isa() -> String {
    std::env::consts::ARCH.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn record(words: &[&str]) -> Provenance {
        let root = crate::Cli::command();
        let matches = root.clone().try_get_matches_from(words).unwrap();
        of_run(&matches, &root)
    }

    #[test]
    fn a_command_states_its_defaults_and_not_where_its_files_lie() {
        let one = record(&[
            "edof",
            "quantize",
            "some/where/edof-t4w12",
            "--out",
            "a.safetensors",
            "--images",
            "here",
        ]);
        let words = ["quantize edof-t4w12", "--bits 16", "--stride 8", "--overlap hann", "--headroom 2"];
        words.iter().for_each(|w| assert!(one.command.contains(w), "{}", one.command));
        let two = record(&[
            "edof",
            "--quiet",
            "quantize",
            "edof-t4w12",
            "--bits",
            "16",
            "--out",
            "b",
            "--json",
            "c",
        ]);
        assert_eq!(one.command, two.command);
        assert_eq!(one.identity(), two.identity());
    }

    #[test]
    fn a_stated_command_has_no_option_without_effect_and_can_be_run() {
        for (line, says, says_not) in [
            ("capture a.png --psi 1 --out b.png", "--energy 0.999", "--layers"),
            ("capture a.png --psi 1 --out b.png --exact", "--exact", "--energy"),
            ("capture a.png --depth-map d.png --range 8:0 --out b.png", "--layers 16", "--exact"),
            ("compare a.png b.png", "--tone srgb", "--map-gain"),
            ("compare a.png b.png --map m.png", "--map-gain 8", "--json"),
            ("reconstruct a.png --board --out o.png", "--display", "--bits"),
            ("reconstruct a.png --float --out o.png", "--bits 8", "--display"),
            ("random-network --design tiny --out o", "--design tiny", "--kind"),
            ("cosim --design tiny", "--patches 500", "--frames"),
            ("cosim --design tiny --system", "--frames 5", "--patches"),
            ("study multi-depth", "--seed 1", "--external-seconds"),
        ] {
            let words: Vec<&str> = ["edof"].into_iter().chain(line.split(' ')).collect();
            let mut root = crate::Cli::command();
            let matches = root.try_get_matches_from_mut(&words).unwrap();
            let whole = whole_command(&matches, &root);
            assert!(whole.contains(says) && !whole.contains(says_not), "{whole}");
            let again = root.try_get_matches_from_mut(whole.split(' ')).unwrap();
            effects::check(&again, &root).unwrap();
            assert_eq!(whole_command(&again, &root), whole);
        }
    }

    #[test]
    fn the_command_of_a_page_has_every_path_as_it_was_given() {
        let root = crate::Cli::command();
        let line =
            "edof study single-depth --rows some/rows.jsonl --nets my/a.safetensors,b --markdown p.md -q";
        let words: Vec<&str> = line.split(' ').collect();
        let mut built = root.clone();
        let matches = built.try_get_matches_from_mut(&words).unwrap();
        let whole = whole_command(&matches, &built);
        for part in
            ["--rows some/rows.jsonl", "--nets my/a.safetensors,b", "--markdown p.md", "--psi 8", "--quiet"]
        {
            assert!(whole.contains(part), "{whole}");
        }
        assert!(!whole.contains("--report") && !whole.contains("--shard"), "{whole}");
        let again: Vec<&str> = whole.split(' ').collect();
        let matches = built.try_get_matches_from_mut(&again).unwrap();
        assert_eq!(whole_command(&matches, &built), whole);
    }

    #[test]
    fn a_cpu_is_known_by_its_numbers_and_not_by_its_name_alone() {
        let text = "processor\t: 0\ncpu family\t: 25\nmodel\t\t: 17\nmodel name\t: AMD EPYC\n";
        let all = ["cpu family", "model", "model name", "bugs"].map(|name| fact(text, name));
        assert_eq!(all, [Some("25"), Some("17"), Some("AMD EPYC"), None]);
    }

    #[test]
    fn a_stated_command_reads_back_as_itself() {
        let one = record(&[
            "edof",
            "capture",
            "my photo.png",
            "--psi",
            "8",
            "--out",
            "r.png",
            "--exact",
            "--seed",
            "7",
        ]);
        assert!(one.command.starts_with("edof capture 'my photo.png' "), "{}", one.command);
        assert_eq!(one.seed, Some(7));
        let mut again: Vec<String> = vec![];
        for (index, piece) in one.command.split('\'').enumerate() {
            if index % 2 == 1 {
                again.push(piece.into())
            } else {
                again.extend(piece.split_whitespace().map(str::to_owned))
            }
        }
        again.extend(["--out".into(), "elsewhere.png".into()]);
        let again: Vec<&str> = again.iter().map(String::as_str).collect();
        assert_eq!(record(&again).command, one.command);
    }
}
