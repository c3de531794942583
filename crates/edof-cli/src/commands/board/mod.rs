//! `edof board`: weights onto a board, and what the board says.

mod align;
mod bank;
mod calibrate;
mod check;
mod info;
mod load;
mod memories;
mod picture;
mod selftest;
mod sim;
mod status;

use crate::designs;
use crate::error::Error;
use crate::files::Files;
use crate::interrupt;
use crate::ui::{Ui, note};
use crate::weights;
use edof_board::contents::letter;
use edof_board::line::{self, Serial};
use edof_board::names::{Place, number};
use edof_board::{Board, link};
use edof_core::DisplayMode;
use edof_core::words::number as short;
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::registers::map;
use edof_device::registers::{c_header, csr_csv, markdown, systemrdl};
use edof_network::FixedNetwork;
use serde_json::{Value, json};
use std::time::Duration;

/// Load weights onto a board, real or simulated, and read its status
///
/// The board is at a serial port; without --port all ports of this machine are tried. docs/host.md describes the protocol, the registers,
/// and what to do when a load fails.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board find                                      lists ports and boards
  edof board info --port /dev/ttyUSB0
  edof board load edof-t4w12-outer-light               loads the idle bank, then uses it
  edof board load edof-t4w12-outer --dry-run --design kc705
  edof board load low.fixed.safetensors --bank a       a network per bank
  edof board status --watch
  edof board align                                     finds the receiver's clock phase
  edof board set control.colour 0
  edof board sim --design tiny --link /tmp/board &     simulates a board; then use --port /tmp/board")]
pub struct Args {
    #[command(subcommand)]
    command: Command,

    /// Serial port, or pseudo-terminal of a simulated board
    #[arg(long, global = true, value_name = "PATH")]
    port: Option<String>,

    /// Bits per second on the line [default: those of the board of --design; without --design those of each board, one after the other]
    #[arg(long, global = true, value_name = "BITS", value_parser = clap::value_parser!(u32).range(1..))]
    baud: Option<u32>,

    /// Extra response time in seconds, beyond the time on the line
    #[arg(long = "timeout", alias = "patience", global = true, default_value_t = link::PATIENCE.as_secs_f64(), value_name = "SECONDS")]
    patience: f64,

    /// Design of the board, by name or file [default: detected]
    #[arg(long, global = true, value_name = "NAME|FILE")]
    design: Option<String>,
}

#[derive(clap::Subcommand)]
enum Command {
    /// List the ports of this machine, and those at which a board answers
    #[command(after_help = "Examples:
  edof board find
  edof board find --json")]
    Find,
    Info(info::Info),
    Load(load::Load),
    Verify(load::Verify),
    Status(status::Args),
    Align(align::Args),
    Calibrate(calibrate::Args),
    Check(check::Args),
    Selftest(selftest::Args),
    Picture(picture::Args),
    /// Print a register or a field of one
    #[command(after_help = "Examples:
  edof board get control.run
  edof board get 'stage_counters[4]'")]
    Get {
        /// Name of the register, or of a field as in control.run; edof board map lists all
        register: String,
    },
    /// Write a register or a field of one
    #[command(after_help = "Examples:
  edof board set control.colour 0
  edof board set scratch 0x12345678")]
    Set {
        /// Name of the register, or of a field as in control.run; edof board map lists all
        register: String,
        /// Value: decimal, or hexadecimal after 0x
        value: String,
    },
    /// Print all registers
    #[command(after_help = "Examples:
  edof board dump --json registers.json")]
    Dump,
    /// Set whether only non-zero values are multiplied
    #[command(after_help = "Examples:
  edof board skip off                                  shows what skipping zeros saves")]
    Skip {
        /// on: only non-zero values; off: all values
        #[arg(value_parser = ["on", "off"])]
        what: String,
    },
    /// Set how the picture's words become 8-bit codes of the HDMI port
    #[command(after_help = "Examples:
  edof board display luma")]
    Display {
        /// colour: encodes red, green and blue; luma: encodes only luma
        mode: DisplayMode,
    },
    Bank(bank::Bank),
    /// Drop the frame in progress; preserve everything that was written
    #[command(after_help = "Examples:
  edof board flush")]
    Flush,
    /// Reset the core: control and skip as generated, video chips set up again, counters at zero; the active bank and all weights are preserved
    #[command(after_help = "Examples:
  edof board reset")]
    Reset,
    /// Print the register map
    #[command(after_help = "Examples:
  edof board map --format c > edof_registers.h
  edof board map --format csr-csv > csr.csv")]
    Map {
        /// Format of the map
        #[arg(long, value_parser = ["markdown", "c", "systemrdl", "csr-csv"], default_value = "markdown")]
        format: String,
    },
    Sim(sim::Args),
}

/// Networks by which a bank's words are known, besides those of the program.
#[derive(clap::Args)]
struct Own {
    /// Custom networks, by name or file, to recognise in the banks besides the built-in ones
    #[arg(long, value_name = "NAME|FILE,…", value_delimiter = ',')]
    weights: Vec<String>,
}

impl Own {
    fn networks(&self, ui: &Ui) -> Result<Vec<FixedNetwork>, Error> {
        let one = |name: &String| {
            ui.used(weights::fixed_input(name)?);
            Ok(weights::fixed(name)?)
        };
        self.weights.iter().map(one).collect()
    }
}

fn bank_of(text: &str) -> Result<Set, String> {
    match text {
        "a" => Ok(Set::First),
        "b" => Ok(Set::Second),
        _ => Err("must be a or b".into()),
    }
}

/// A failure found before the command began: a program that reads results reads why there are none, too.
pub fn reported(error: Error, ui: &Ui) -> Error {
    // A file may be one that must not be replaced.
    let printed = if ui.json_file().is_none() { ui.json(&failure(&error)) } else { Ok(()) };
    printed.err().unwrap_or(error)
}

fn failure(error: &Error) -> Value {
    json!({ "error": error.to_string() })
}

/// # Errors
/// A line that fails, something that does not fit, a register that is not there, or Ctrl-C.
pub fn run(args: &Args, ui: &Ui) -> Result<(), Error> {
    let checked = args.check(ui);
    // The file of --json may be what was rejected.
    let may_tell = checked.is_ok() || ui.json_file().is_none();
    let done = checked.and_then(|()| carry_out(args, ui));
    match &done {
        // A program that reads results reads why there are none, too.
        Err(error @ Error::Failed(_)) if may_tell && !ui.has_told() => {
            ui.json(&failure(error))?;
        }
        Ok(()) if !ui.has_told() => ui.json(&json!({ "done": true }))?,
        _ => {}
    }
    done
}

fn carry_out(args: &Args, ui: &Ui) -> Result<(), Error> {
    match &args.command {
        Command::Find => find(args, ui),
        Command::Info(info) => info::run(args, info, ui),
        Command::Load(load) => load::load(args, load, ui),
        Command::Verify(verify) => load::verify(args, verify, ui),
        Command::Status(status) => status::run(args, status, ui),
        Command::Align(align) => align::run(args, align, ui),
        Command::Calibrate(calibrate) => calibrate::run(args, calibrate, ui),
        Command::Check(check) => check::run(args, check, ui),
        Command::Selftest(test) => selftest::run(args, test, ui),
        Command::Picture(picture) => picture::run(args, picture, ui),
        Command::Get { register } => {
            let place: Place = register.parse()?;
            let value = args.open()?.get(place)?;
            ui.say(format!("0x{value:08x} {value}"))?;
            ui.json(&json!({ "register": register, "value": value }))
        }
        Command::Set { register, value } => {
            let place: Place = register.parse()?;
            let number = number(value).ok_or_else(|| {
                Error::message(format!("value '{value}': must be a number of 32 bits, as in 12 or 0x1f"))
            })?;
            let mut board = args.open()?;
            let before = place.reads_back().then(|| board.get(place)).transpose().map_err(of)?;
            board.set(place, number).map_err(of)?;
            ui.say(match before {
                Some(before) => format!("{register} is 0x{number:x} ({number}), read back; before it was 0x{before:x} ({before})"),
                None => format!("{register}: 0x{number:x} ({number}) was written; the board took it, and has no way to read it back"),
            })?;
            ui.json(&json!({ "register": register, "value": number, "before": before }))
        }
        Command::Dump => dump(args, ui),
        Command::Skip { what } => {
            let mut board = args.open()?;
            let design = args.design_of(&board)?;
            board.skip(&design, what == "on").map_err(of)?;
            ui.say(match what.as_str() {
                "on" => "every stage multiplies non-zero values alone",
                _ => "every stage multiplies all values, zeros too",
            })?;
            ui.json(&json!({ "skip": what == "on" }))
        }
        Command::Display { mode } => {
            let bits = if *mode == DisplayMode::Colour { map::COLOUR } else { 0 };
            args.open()?.change_control(map::COLOUR, bits).map_err(of)?;
            ui.say(match mode {
                DisplayMode::Colour => "pictures are encoded by red, green and blue",
                DisplayMode::Luma => "pictures are encoded by luma alone",
            })?;
            ui.json(&json!({ "display": mode }))
        }
        Command::Bank(bank) => bank::run(args, bank, ui),
        Command::Flush => {
            args.open()?.flush().map_err(of)?;
            ui.say("the frame in progress was dropped; the next one runs")
        }
        Command::Reset => {
            let mut board = args.open()?;
            let design = args.design_of(&board)?;
            board.reset(&design).map_err(of)?;
            let bank = letter(board.bank().map_err(of)?);
            ui.say(format!(
                "the core was reset: bank {bank} is in use as before, all weights are kept; the video chips are set up again, see 'edof board status'"
            ))
        }
        Command::Map { format } => {
            let text = match format.as_str() {
                "c" => c_header::header(),
                "systemrdl" => systemrdl::address_map(),
                "csr-csv" => csr_csv::csr_csv(),
                _ => markdown::page(),
            };
            // LiteX's clients take no line that is empty.
            ui.say(text.trim_end())?;
            ui.json(&json!({ "format": format, "map": text }))
        }
        Command::Sim(sim) => sim::run(args, sim, ui),
    }
}

/// A failure of the link; being stopped is none.
fn of(error: edof_board::Error) -> Error {
    match error {
        edof_board::Error::Interrupted => Error::Interrupted,
        error => error.into(),
    }
}

impl Args {
    /// What can be rejected before a board is asked.
    fn check(&self, ui: &Ui) -> Result<(), Error> {
        if !(self.patience > 0.0 && self.patience <= 3600.0) {
            let given = short(self.patience);
            return Err(Error::message(format!("--timeout {given}: must be above 0, at most 3600")));
        }
        self.named_design()?;
        let files = self.files(ui);
        match &self.command {
            Command::Sim(sim) => sim.writes(files)?,
            Command::Picture(picture) => picture.files(files)?,
            Command::Calibrate(calibrate) => calibrate.files(files)?,
            _ => files,
        }
        .check()
    }

    fn patience(&self) -> Duration {
        Duration::from_secs_f64(self.patience)
    }

    /// Opens the board at a port, at the first speed at which it answers.
    fn open_at(&self, port: &str) -> Result<Board<Serial>, Error> {
        let bauds = self.bauds()?;
        let mut why = None;
        for baud in bauds.iter().copied() {
            interrupt::check()?;
            match Board::open(Serial::open(port, baud)?, self.patience()) {
                Ok(board) => return Ok(board),
                // Another speed may be the right one.
                Err(
                    error @ (edof_board::Error::Silent { .. }
                    | edof_board::Error::Stranger { .. }
                    | edof_board::Error::Noisy { .. }),
                ) => {
                    why.get_or_insert(error);
                }
                Err(error) => return Err(of(why.unwrap_or(error))),
            }
        }
        Err(why.map_or_else(|| Error::message("--baud: no speed to try"), |why| no_answer(why, &bauds)))
    }

    /// Returns the speeds that the board's line may have.
    fn bauds(&self) -> Result<Vec<u32>, Error> {
        match (self.baud, self.named_design()?) {
            (Some(baud), _) => Ok(vec![baud]),
            (None, Some(design)) => Ok(vec![design.board.baud]),
            (None, None) => Ok(line::bauds()),
        }
    }

    /// Returns the speed of the line of a design's board, unless another one is stated.
    fn baud_of(&self, design: &Design) -> u32 {
        self.baud.unwrap_or(design.board.baud)
    }

    /// What is read, whatever the command, and what is written by `--json`.
    fn files(&self, ui: &Ui) -> Files {
        let weights = match &self.command {
            Command::Load(load) => std::slice::from_ref(&load.weights),
            Command::Verify(verify) => std::slice::from_ref(&verify.weights),
            Command::Info(info::Info { own, .. }) | Command::Bank(bank::Bank { own, .. }) => &own.weights[..],
            Command::Check(check) => check.weights.as_slice(),
            Command::Selftest(test) => test.weights.as_slice(),
            _ => &[],
        };
        let weights = weights.iter().filter_map(|name| weights::fixed_file(name));
        Files::new(ui).reads_all(&self.design).reads_all(weights)
    }

    /// The board at the port, or at the first of all ports where one answers.
    fn open(&self) -> Result<Board<Serial>, Error> {
        if let Some(port) = &self.port {
            return self.open_at(port);
        }
        let ports = line::ports();
        for port in &ports {
            interrupt::check()?;
            if let Ok(board) = self.open_at(&port.name) {
                return Ok(board);
            }
        }
        Err(no_board(&ports))
    }

    /// The design that was named, if one was.
    fn named_design(&self) -> Result<Option<Design>, Error> {
        Ok(self.design.as_deref().map(designs::load).transpose()?)
    }

    /// Designs that the board may have.
    fn designs(&self) -> Result<Vec<Design>, Error> {
        Ok(self.named_design()?.into_iter().chain(designs::all()?).collect())
    }

    /// The board's design; it is remarked where another one was named.
    fn design_of(&self, board: &Board<Serial>) -> Result<Design, Error> {
        let design = board.design(self.designs()?).map_err(of)?;
        if let Some(named) = self.named_design()?.filter(|named| named.name != design.name) {
            note(&format!(
                "{}: the board has the design {}, not {}: --design is ignored",
                board.port(),
                design.name,
                named.name
            ));
        }
        Ok(design)
    }
}

/// Why no board answers at a port: of silence at several speeds all of them are named.
fn no_answer(why: edof_board::Error, bauds: &[u32]) -> Error {
    match why {
        edof_board::Error::Silent { port, .. } if bauds.len() > 1 => {
            let tried = bauds.iter().map(u32::to_string).collect::<Vec<_>>().join(" or ");
            Error::message(format!(
                "{port}: no answer at {tried} bits per second: check cable and power, that a bitstream of edof is loaded, and name another speed by --baud"
            ))
        }
        why => of(why),
    }
}

/// No board at any of the ports.
fn no_board(ports: &[line::Port]) -> Error {
    let names: Vec<&str> = ports.iter().map(|port| port.name.as_str()).collect();
    let tried = if names.is_empty() { "this machine has none".into() } else { names.join(", ") };
    Error::message(format!(
        "no board answers at any serial port ({tried}); name one by --port, or simulate a board by 'edof board sim'"
    ))
}

/// Networks that come with the program and fit a design, after those of the user that do; last the random one of 'edof board sim'.
fn known(design: &Design, named: &[FixedNetwork]) -> Vec<FixedNetwork> {
    let names = vec![String::new(); named.len()];
    let known = known_by_name(design, &names, named).into_iter().map(|(_, network)| network);
    known.chain([edof_device::random::for_design(design, 1)]).collect()
}

/// Those of the user and of the program alone, with the name or file of each.
fn known_by_name(design: &Design, names: &[String], named: &[FixedNetwork]) -> Vec<(String, FixedNetwork)> {
    let named = names.iter().cloned().zip(named.iter().cloned());
    let own = weights::names().into_iter();
    let own = own.filter_map(|name| Some((name.to_owned(), weights::fixed(name).ok()?)));
    named.chain(own).filter(|(_, network)| design.check_network(network).is_ok()).collect()
}

/// # Errors
/// A network that does not fit a design, with what to load instead.
fn fits(design: &Design, network: &FixedNetwork) -> Result<(), Error> {
    let Err(misfit) = design.check_network(network) else { return Ok(()) };
    let own: Vec<String> = known_by_name(design, &[], &[]).into_iter().map(|(name, _)| name).collect();
    let name = &design.name;
    let instead = match own[..] {
        [] => format!(
            "none that comes with edof does; 'edof random-network --design {name}' makes one for tests"
        ),
        _ => format!("these that come with edof do: {}", own.join(", ")),
    };
    Err(Error::message(format!("{misfit}; {instead}")))
}

fn find(args: &Args, ui: &Ui) -> Result<(), Error> {
    let (mut found, mut boards) = (vec![], 0);
    let mut why = None;
    let named = args.port.iter().map(|name| line::Port { name: name.clone(), about: String::new() });
    let ports: Vec<line::Port> = if args.port.is_some() { named.collect() } else { line::ports() };
    for port in &ports {
        interrupt::check()?;
        let board = args.open_at(&port.name);
        let said = match &board {
            Ok(board) => match board.identity.design(args.designs()?) {
                Some(design) => format!("a board with the design {}", design.name),
                None => format!("a board with the design {:08x}", board.identity.design_hash),
            },
            // What the error says of the port comes after its name.
            Err(error) => match error.to_string().strip_prefix(&format!("{}: ", port.name)) {
                Some(reason) if reason.contains("ermission") => reason.to_owned(),
                _ => "no board answers".to_owned(),
            },
        };
        boards += usize::from(board.is_ok());
        let about = if port.about.is_empty() { String::new() } else { format!(" ({})", port.about) };
        ui.say(format!("{}{about}: {said}", port.name))?;
        let error = board.as_ref().err().map(ToString::to_string);
        let identity = board.as_ref().ok().map(|board| board.identity);
        found.push(json!({ "port": port.name, "about": port.about, "board": identity, "error": error }));
        why = why.or(board.err());
    }
    if ports.is_empty() {
        ui.say("this machine has no serial ports")?;
    }
    ui.json(&json!({ "ports": found, "boards": boards }))?;
    match (boards, why) {
        (0, Some(why)) if args.port.is_some() => Err(why),
        (0, _) => Err(no_board(&ports)),
        _ => Ok(()),
    }
}

fn dump(args: &Args, ui: &Ui) -> Result<(), Error> {
    let words = args.open()?.registers()?;
    for (place, word) in &words {
        ui.say(format!("0x{:03x} {:<22} 0x{word:08x} {word}", place.address(), place.to_string()))?;
    }
    let named: serde_json::Map<String, serde_json::Value> =
        words.iter().map(|(place, word)| (place.to_string(), (*word).into())).collect();
    ui.json(&json!({ "registers": named }))
}
