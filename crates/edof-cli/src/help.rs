//! Screens of help: examples first, then arguments, then options in groups.

use crate::commands::train;
use clap::{Arg, Command};

/// What a screen shows, and in which order.
const TEMPLATE: &str = "{about}{after-help}\n\n{usage-heading} {usage}\n\n{all-args}";

/// Options of every command, by what they are about. An option that no group names is about the command itself.
const EVERYWHERE: [Group; 5] = [
    ("Connection to the board", "port baud timeout design"),
    ("Photographs", "images photos"),
    ("Rows of the study", "rows shard any-revision"),
    ("Files to write", "markdown latex report csv plot junit waveform cameras out force"),
    ("Results and progress", "json quiet progress help"),
];

/// Options of the commands that have many, by command; the first group that names an option has it.
const COMMANDS: [(&str, &[Group]); 16] = [
    (
        "capture",
        &[
            ("Scene", "size seed tone depth-map range map-of map-unit layers"),
            ("Lens and depth", "camera psf-bank centre psi nominal focus"),
            ("Sensor", "bit-depth phase noise black-level"),
            ("Files to write", "out video grey values sharp light"),
            ("Accuracy", "energy wavelength-tolerance depth-tolerance exact measure"),
        ],
    ),
    (
        "reconstruct",
        &[
            ("Network", "weights gain fixed float device stride demosaic"),
            ("Lens of the frame", "camera psf-bank centre"),
            ("Format of the frame", "phase bit-depth video size align order packing line-bytes"),
            ("Levels and colours", "sensor black-level white-level white-balance colour-matrix"),
            ("Picture", "out tone gamma bits board display words force"),
        ],
    ),
    (
        "stream",
        &[
            ("Format of the frames", "size packing line-bytes phase bit-depth order"),
            ("Levels and colours", "sensor black-level white-level white-balance colour-matrix"),
            ("Network", "weights gain"),
            ("Pictures", "out format fps gamma live"),
        ],
    ),
    (
        "sensor",
        &[
            ("Frames and defects", "dark flat list"),
            ("Limits", "hot dead"),
            ("Format of the frames", "size packing line-bytes phase bit-depth align order"),
            ("Levels", "black-level white-level"),
        ],
    ),
    (
        "train",
        &[
            ("Network", "form from only structure start out name force"),
            ("Lens and depth", "camera psf-bank centre depths psi focus"),
            ("Photographs", "images photos leave-out variants saturation hue scale"),
            ("Light and noise", "tone noise gain noiseless flat exposure"),
            ("Sparsity", "lambda non-zeros budget-rate"),
            ("Steps", "steps minutes batch rate output-rate threshold-rate averaging weighting seed"),
            ("Run", "threads validate-every patience resume no-cache"),
        ],
    ),
    (
        "cosim",
        &[
            ("Hardware", "design weights rtl skip stride window size"),
            ("Windows", "photo psi noise random cases patches stalls seed"),
            ("Whole core", "system frames display"),
            ("Simulators and results", "icarus waveform junit force"),
        ],
    ),
    (
        "optics design",
        &[
            ("Mask and focus", "camera rings focus max-phase"),
            ("Score", "psi-range noise worst-weight window images"),
            ("Search", "population generations seed"),
        ],
    ),
    ("study codes", &[("Codes", "codes module-px count zbarimg"), ("Lenses", "lenses")]),
    (
        "optics",
        &[
            ("Lens", "camera aperture-mm f-number focal-mm pixel-um wavelengths range"),
            ("Scene and light", "task module-px electrons read-noise mean-light images"),
        ],
    ),
    (
        "explore",
        &[
            ("Networks and board", "weights design size clock-mhz device fps"),
            ("Pictures", "photo psi noise"),
            ("Files to write", "out"),
        ],
    ),
    (
        "design new",
        &[
            ("Network", "form weights"),
            ("Board and frame", "board clock-mhz size stride multipliers fps"),
            ("Files to write", "name out"),
        ],
    ),
    (
        "quantize",
        &[
            ("Integers", "bits headroom stride overlap"),
            ("Photographs", "images photos frames"),
            ("Fine-tuning", "finetune finetune-rate"),
        ],
    ),
    (
        "demo",
        &[
            ("Scene and sensor", "scene tone noise height width"),
            ("Networks and board", "net clear-net design"),
        ],
    ),
    ("board load", &[("Load", "bank full curve"), ("Checks", "read-back dry-run")]),
    (
        "board sim",
        &[("Simulated board", "rtl design weights frame size"), ("Files to write", "link picture")],
    ),
    (
        "study",
        &[
            ("Lens and depth", "camera psi psi-ranges stops exact"),
            (
                "Networks and methods",
                "nets net networks clear-net methods device stride dictionary external external-seconds knobs \
                 allowed only cases quick windows weights design size clock-mhz fps atoms errors sparsity patches rounds window",
            ),
            (
                "Scene, light and noise",
                "scenes tone noise height width side seed photo electrons read-noise mean-light",
            ),
        ],
    ),
];

/// A heading, and the names of its options with blanks between them.
type Group = (&'static str, &'static str);

/// A command and all below it with examples first and options in groups.
pub fn arranged(command: Command) -> Command {
    below(command, "")
}

fn below(command: Command, path: &str) -> Command {
    let command = command.help_template(TEMPLATE).mut_args(|arg| in_its_group(arg, path));
    command.mut_subcommands(|sub| {
        let path = format!("{path} {}", sub.get_name());
        below(sub, path.trim())
    })
}

fn in_its_group(arg: Arg, path: &str) -> Arg {
    let Some(name) = arg.get_long().map(str::to_owned) else { return arg };
    let arg = if path == "train" { with_default(arg, &name) } else { arg };
    let own =
        COMMANDS.iter().filter(|(command, _)| is_below(path, command)).flat_map(|(_, groups)| groups.iter());
    let everywhere = EVERYWHERE
        .iter()
        .filter(|(heading, _)| !heading.starts_with("Connection") || is_below(path, "board"));
    match own.chain(everywhere).find(|(_, names)| names.split(' ').any(|one| one == name)) {
        Some((heading, _)) => arg.help_heading(*heading),
        None => arg,
    }
}

/// An option of `edof train` with the default that it has in the usual recipe.
fn with_default(arg: Arg, name: &str) -> Arg {
    let (Some(default), Some(help)) = (train::default_of(name), arg.get_help()) else { return arg };
    let help = format!("{help} [default: {default}]");
    arg.help(help)
}

/// Whether a command is another one or below it.
fn is_below(path: &str, command: &str) -> bool {
    path.strip_prefix(command).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cli;
    use clap::CommandFactory;
    use edof_train::recipe::Recipe;

    fn each(command: &Command, path: &str, visit: &mut impl FnMut(&Command, &str)) {
        visit(command, path);
        for sub in command.get_subcommands() {
            each(sub, format!("{path} {}", sub.get_name()).trim(), visit);
        }
    }

    #[test]
    fn commands_with_many_options_have_all_of_them_in_groups() {
        let (mut many, mut loose) = (0, vec![]);
        each(&arranged(Cli::command()), "", &mut |command, path| {
            let options =
                || command.get_arguments().filter(|arg| arg.get_long().is_some() && !arg.is_hide_set());
            if options().count() > 8 {
                many += 1;
                let alone = options().filter(|arg| arg.get_help_heading().is_none());
                loose.extend(alone.map(|arg| format!("edof {path} --{}", arg.get_long().unwrap())));
            }
        });
        assert!(many > 12 && loose.is_empty(), "{many} commands, not in a group: {loose:?}");
    }

    #[test]
    fn training_shows_the_defaults_of_its_recipe() {
        let command = arranged(Cli::command());
        let train = command.find_subcommand("train").unwrap();
        let help = |name: &str| {
            let arg = train.get_arguments().find(|arg| arg.get_long() == Some(name)).unwrap();
            arg.get_help().unwrap().to_string()
        };
        let recipe = |form: &str| Recipe::new(crate::form::parse(form).unwrap());
        let (own, papers) = (recipe("edof-t4w12"), recipe("paper-t4"));
        assert_eq!((own.conditions.noise, own.conditions.gain), ([0.0, 0.03], [1.0, 16.0]));
        for (name, default) in [
            ("steps", own.steps.to_string()),
            ("batch", own.batch.to_string()),
            ("noise", "0:0.03".to_owned()),
            ("gain", "1:16".to_owned()),
            ("patience", own.patience.to_string()),
            ("rate", format!("{} for edof-t4w12, {} for paper-t4", own.rate, papers.rate)),
        ] {
            assert!(help(name).ends_with(&format!(" [default: {default}]")), "--{name}: {}", help(name));
        }
        let silent =
            ["from", "form", "camera", "psf-bank", "images", "photos", "leave-out", "out", "name", "depths"];
        for arg in train.get_arguments().filter(|arg| arg.get_action().takes_values()) {
            let (Some(name), Some(help)) = (arg.get_long(), arg.get_help()) else { continue };
            let known =
                ["minutes", "psi", "threads", "json", "progress"].contains(&name) || silent.contains(&name);
            assert!(known || help.to_string().contains("[default: "), "--{name} shows no default");
        }
    }

    #[test]
    fn examples_fit_a_terminal_of_100_columns() {
        let mut long = vec![];
        each(&Cli::command(), "", &mut |command, _| {
            let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            long.extend(text.lines().filter(|line| line.chars().count() > 100).map(str::to_owned));
        });
        assert_eq!(long, [""; 0]);
    }

    #[test]
    fn groups_name_options_that_exist() {
        let mut found = vec![];
        each(&Cli::command(), "", &mut |command, path| {
            let names = command.get_arguments().filter_map(Arg::get_long);
            found.extend(names.map(|name| (path.to_owned(), name.to_owned())));
        });
        for (command, groups) in COMMANDS.iter().copied().chain([("", EVERYWHERE.as_slice())]) {
            for name in groups.iter().flat_map(|(_, names)| names.split(' ')) {
                let exists = |(path, option): &(String, String)| {
                    option == name && (command.is_empty() || is_below(path, command))
                };
                let is_global = command == "board sim" && name == "design";
                assert!(is_global || found.iter().any(exists), "edof {command} has no --{name}");
            }
        }
    }
}
