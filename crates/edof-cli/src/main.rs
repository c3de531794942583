//! The `edof` command: from a scene to a coded raw frame, from a raw frame to a sharp picture.
//!
//! | what | where |
//! |---|---|
//! | one thin file a sub-command | [`commands`] |
//! | results on standard output, progress on standard error | [`ui`] |
//! | the one line that a failure prints | [`error`] |
//! | no output replaces an input or another output | [`files`] |
//! | Ctrl-C | [`interrupt`] |
//! | as many threads as the system lets start | [`threads`] |
//! | what a PSF bank does to a picture | [`psf_bank`] |
//! | photographs, of even sides | [`pictures`] |
//! | what is written about a run into its results | [`provenance`] |
//! | the whole core in simulation, and the demo's board | [`cosim_system`], [`demo_board`] |
//! | errors that name the option and the file | [`said`] |
//! | what is wrong with options, in plain words | [`usage`] |
//! | options that have an effect only beside others | [`effects`] |
//! | options of several commands | [`gain`], [`raw_words`] |
//! | screens of help: examples first, options in groups | [`help`] |
//! | windows to feed the hardware with | [`windows`] |
//!
//! Exit status: 0 done, 1 rejected or failed (one line, `edof: …`; with `--progress json` an object), 2 wrong usage, 130 stopped by Ctrl-C.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

mod advice;
mod commands;
mod cosim_camera;
mod cosim_system;
mod demo_board;
mod effects;
mod error;
mod error_bounds;
mod files;
mod gain;
mod help;
mod interrupt;
mod kind;
mod limits;
mod network;
#[cfg(test)]
mod pages;
mod pictures;
mod provenance;
mod psf_bank;
mod raw_words;
mod said;
mod threads;
mod ui;
mod usage;
mod windows;

use clap::{ArgAction, CommandFactory, FromArgMatches, Parser, Subcommand};
use edof::presets::{designs, lens, weights};
use edof_network::form;
use error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use ui::Ui;

/// Computational extended depth of field: a coded lens, a small network, a sharp picture at every depth.
///
/// A thin ring mask makes red, green and blue focus at different depths. The sensor behind it gives a raw Bayer frame;
/// an unrolled sparse-coding network turns the frame into a sharp picture, in floating point or in the integers
/// that the board computes with.
#[derive(Parser)]
#[command(name = "edof", version, max_term_width = 110, after_help = EXAMPLES, disable_help_flag = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,

    /// Write results as JSON to FILE, replacing an existing one; without FILE (or with `-`) print JSON instead of text
    #[arg(long, global = true, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,

    /// Print no progress
    #[arg(long, short, global = true)]
    quiet: bool,

    /// Format of progress on standard error: text, or json (one line per second for programs; remarks and errors are lines of JSON, too)
    #[arg(
        long,
        global = true,
        value_enum,
        default_value = "text",
        value_name = "HOW",
        hide_possible_values = true
    )]
    progress: ui::ProgressAs,

    /// Print help; -h prints a summary
    #[arg(long, short, global = true, action = ArgAction::Help)]
    help: Option<bool>,
}

const EXAMPLES: &str = "\
Examples:
  edof demo                                          runs the whole chain; see out/report.html
  edof play                                          opens a page with sliders for a lens
  edof doctor                                        lists tools, designs, networks, photographs

 A researcher: from a photograph to a reconstructed picture
  edof capture photo.png --psi 5 --noise sensor --out raw.png --sharp sharp.png
  edof reconstruct raw.png --out out.png             the raw frame's record states the lens
  edof compare sharp.png out.png                     PSNR, SSIM, and where the pictures differ
  edof optics ring-2018 --out out/optics             PSF, MTF and contrast of a camera
  edof study kodak --nets paper-t4 --psi 0,4,8 --noise 0,0.01 --json study.json

 An FPGA engineer: from a design to Verilog
  edof design new --form edof-t4w12 --size 1280x720 --out mine.json
  edof estimate --design kc705 --weights edof-t4w12-outer
  edof generate --design paper --weights paper-t4 --out build/paper
  edof cosim --design tiny                           compares the Verilog with the cycle model
  edof timing --design tiny                          prints the longest logic path of every stage

 Somebody with an open board: from a ULX3S to a picture (docs/ulx3s.md)
  edof generate --design ulx3s --weights edof-t3w12c96-clear-light --out build/ulx3s
  make -C build/ulx3s bitstream prog                 with Yosys and nextpnr, 24 to 33 minutes
  edof board selftest edof-t3w12c96-clear-light --design ulx3s

 Somebody with a KC705: from the board to a picture (docs/bring-up.md)
  edof board selftest                                tests every part that needs no cable
  edof board load edof-t4w12-outer-light             loads weights over the serial line
  edof board sim --design tiny --link /tmp/board     simulates a board
  edof reconstruct raw.png --board --out board.png   writes the codes of the HDMI port

ψ (psi) is the defocus in radians: 0 at the far end of the cameras' range, 8 at the near end, 5.7
behind clear-closed, whose aperture is smaller.
A camera with nominal_m also accepts distances such as 1.5m. σ is the standard deviation of the
noise, with white at 1. Each command has its own --help with examples. Exit status: 0 done,
1 failed (one line on standard error), 2 wrong usage, 130 stopped by Ctrl-C.";

#[derive(Subcommand)]
enum Command {
    Optics(commands::optics::Args),
    Scene(commands::scene::Args),
    Capture(commands::capture::Args),
    Train(Box<commands::train::Args>),
    Weights(commands::weights::Args),
    Quantize(commands::quantize::Args),
    Reconstruct(commands::reconstruct::Args),
    Stream(Box<commands::stream::Args>),
    Sensor(Box<commands::sensor::Args>),
    Study(commands::study::Args),
    Demo(commands::demo::Args),
    Play(commands::play::Args),
    Compare(commands::compare::Args),
    Doctor(commands::doctor::Args),
    Cosim(commands::cosim::Args),
    Design(commands::design::Args),
    Estimate(commands::estimate::Args),
    Explore(commands::explore::Task),
    Generate(commands::generate::Args),
    RandomNetwork(commands::random_network::Args),
    Timing(commands::timing::Args),
    Board(commands::board::Args),
}

fn main() -> ExitCode {
    threads::with_stack(report)
}

/// Runs the command, prints the line of a failure, and returns the exit status.
fn report() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is_broken_pipe() => ExitCode::SUCCESS,
        Err(error) => {
            if matches!(error, Error::Interrupted) {
                interrupt::tell_kept();
            }
            ui::failure(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

/// A number below 0 after an option is its value, which the option may reject, and no option of its own.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command.allow_negative_numbers(true).mut_subcommands(with_negative_numbers)
}

fn run() -> Result<(), Error> {
    let mut command = help::arranged(with_negative_numbers(Cli::command()));
    let matches = command.try_get_matches_from_mut(std::env::args_os()).unwrap_or_else(|e| usage::exit(&e));
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|e| usage::exit(&e.format(&mut command)));
    interrupt::install()?;
    let made = (provenance::of_run(&matches, &command), provenance::whole_command(&matches, &command));
    let ui = Ui::new(cli.json, cli.quiet, cli.progress, made.0, made.1);
    threads::install();
    effects::check(&matches, &command).map_err(|error| match cli.command {
        Command::Board(_) => commands::board::reported(error, &ui),
        _ => error,
    })?;
    match cli.command {
        Command::Optics(args) => commands::optics::run(args, &ui),
        Command::Scene(args) => commands::scene::run(args, &ui),
        Command::Capture(args) => commands::capture::run(args, &ui),
        Command::Train(args) => commands::train::run(&args, &ui),
        Command::Weights(args) => commands::weights::run(args, &ui),
        Command::Quantize(args) => commands::quantize::run(args, &ui),
        Command::Reconstruct(args) => commands::reconstruct::run(args, &ui),
        Command::Stream(args) => commands::stream::run(*args, &ui),
        Command::Sensor(args) => commands::sensor::run(*args, &ui),
        Command::Study(args) => commands::study::run(args, &ui),
        Command::Demo(args) => commands::demo::run(args, &ui),
        Command::Play(args) => commands::play::run(args, &ui),
        Command::Compare(args) => commands::compare::run(args, &ui),
        Command::Doctor(args) => commands::doctor::run(args, &ui),
        Command::Cosim(args) => commands::cosim::run(args, &ui),
        Command::Design(args) => commands::design::run(&args, &ui),
        Command::Estimate(args) => commands::estimate::run(args, &ui),
        Command::Explore(args) => commands::explore::run(args, &ui),
        Command::Generate(args) => commands::generate::run(args, &ui),
        Command::RandomNetwork(args) => commands::random_network::run(args, &ui),
        Command::Timing(args) => commands::timing::run(args, &ui),
        Command::Board(args) => commands::board::run(&args, &ui),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_sub_command_shows_an_example() {
        for sub in Cli::command().get_subcommands_mut() {
            let help = sub.render_long_help().to_string();
            assert!(help.contains("Example"), "{} has no example:\n{help}", sub.get_name());
        }
    }
}
