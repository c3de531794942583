//! `edof board load` and `verify`.

use super::memories::{Memories, Wanted};
use super::{fits, known, of};
use crate::error::Error;
use crate::interrupt;
use crate::ui::{Progress, Ui};
use crate::weights;
use edof_board::contents::{letter, parts};
use edof_board::load::{Job, Loaded, target};
use edof_board::{Board, Serial, dry_run};
use edof_core::{DisplayMode, Tone};
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::registers::identity::weights_hash;
use edof_golden::{Curve, Display};
use edof_network::FixedNetwork;
use serde_json::json;
use std::ops::ControlFlow;
use std::time::Instant;

/// Load a network into the inactive bank, check it by the circuit's CRCs, and use it from the next frame on
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board load edof-t4w12-outer-light
  edof board load edof-t4w12-outer --dry-run --design kc705")]
pub struct Load {
    /// Network, by name or file
    pub(super) weights: String,

    /// Bank to write; the active bank stays active. While the active bank is written, the other one is used
    #[arg(long, value_parser = super::bank_of)]
    bank: Option<Set>,

    /// Send all words, not only those that differ
    #[arg(long)]
    full: bool,

    /// Also read every word back
    #[arg(long)]
    read_back: bool,

    /// Also load the display's tables for this curve: linear, srgb or bt709; the picture is frozen meanwhile [default: the tables stay,
    /// unless the network's values need others]
    #[arg(long, value_parser = of_curve, value_name = "CURVE")]
    curve: Option<Curve>,

    /// Write nothing; print the words that would be sent and the time of the load. With --design and without --port, no board is contacted
    /// and all words are counted
    #[arg(long)]
    dry_run: bool,
}

impl Load {
    /// The usual load of a network.
    pub(super) const fn of(weights: String) -> Self {
        Self { weights, bank: None, full: false, read_back: false, curve: None, dry_run: false }
    }
}

/// Compare a bank with a network, and the display's tables with a curve, by the circuit's CRCs
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board verify edof-t4w12-outer-light
  edof board verify mine.fixed.safetensors --bank b --read-back")]
pub struct Verify {
    /// Network, by name or file
    pub(super) weights: String,

    /// Bank to compare [default: the active bank]
    #[arg(long, value_parser = super::bank_of)]
    bank: Option<Set>,

    /// Also read every word of the network back
    #[arg(long)]
    read_back: bool,

    /// Curve of the display's tables: linear, srgb or bt709 [default: any of them]
    #[arg(long, value_parser = of_curve, value_name = "CURVE")]
    curve: Option<Curve>,
}

/// The network, which fits the design that was named, or at least one that the program knows.
fn network(args: &super::Args, name: &str, ui: &Ui) -> Result<FixedNetwork, Error> {
    let network = weights::fixed(name)?;
    ui.used(weights::fixed_input(name)?);
    if let Some(design) = args.named_design()? {
        fits(&design, &network)?;
    }
    Ok(network)
}

/// Curves that the display's tables may be for, by their names here.
const CURVES: [(&str, Curve); 3] =
    [("linear", Curve::Linear), ("srgb", Curve::Srgb), ("bt709", Curve::Bt709)];

fn of_curve(name: &str) -> Result<Curve, String> {
    let found = CURVES.iter().find(|(known, _)| *known == name).map(|(_, curve)| *curve);
    found.ok_or_else(|| format!("must be {}", CURVES.map(|(name, _)| name).join(", ")))
}

fn name_of(curve: Curve) -> &'static str {
    CURVES.iter().find(|(_, known)| *known == curve).map_or("", |(name, _)| name)
}

fn display(curve: Curve) -> Display {
    Display::new(DisplayMode::default(), curve)
}

/// The display of a curve of [`curve_of`].
pub fn display_of(name: &str) -> Display {
    display(of_curve(name).unwrap_or_default())
}

/// The name of the curve that a board's tables are for, none where the program knows none that has such tables.
pub fn curve_in(memories: &Memories) -> Option<&'static str> {
    memories.tables(&CURVES.map(|(_, curve)| display(curve))).map(|index| CURVES[index].0)
}

/// The same of tables that are read for it.
fn curve_of(board: &mut Board<Serial>, ui: &Ui) -> Result<Option<&'static str>, Error> {
    Ok(curve_in(&Memories::read(board, None, &Wanted { banks: &[], tables: true }, ui)?))
}

/// # Errors
/// A network that fits no board, a line that fails, or Ctrl-C: the weights that were in use then still are.
pub fn load(args: &super::Args, load: &Load, ui: &Ui) -> Result<(), Error> {
    let network = network(args, &load.weights, ui)?;
    let job = |design, known| Job {
        design,
        network: &network,
        bank: load.bank,
        full: load.full,
        read_back: load.read_back,
        known,
    };
    if load.dry_run && args.port.is_none() {
        let design = args.named_design()?;
        let design = design.ok_or_else(|| Error::message("--dry-run: without --port it needs --design"))?;
        let bank = target(&design, load.bank, Set::First);
        return plan(args, &job(&design, &[]), (bank, None), (load.curve, None), ui);
    }
    let mut board = args.open()?;
    let design: Design = args.design_of(&board)?;
    fits(&design, &network)?;
    let known = known(&design, &[]);
    let job = job(&design, &known);
    let before = values_in_use(&board, &design, &known);
    if load.dry_run {
        let in_use = board.bank()?;
        let bank = target(&design, load.bank, in_use);
        let wanted = parts(&design, &network, bank);
        let bar = ui.progress(0, ROWS);
        let held = board.crcs(&wanted.iter().collect::<Vec<_>>(), &mut watched(&bar)).map_err(of)?;
        drop(bar);
        let switches = design.sets().len() == 1 || load.bank.is_none() || bank == in_use;
        let curve = match load.curve {
            None if switches => needed(&mut board, &network, before, ui)?,
            given => given,
        };
        let of_tables = if curve.is_some() { curve_of(&mut board, ui)? } else { None };
        return plan(args, &job, (bank, Some(&held)), (curve, of_tables), ui);
    }
    let start = Instant::now();
    let (mut bar, mut words, mut begun) = (ui.progress(0, "words"), 0, false);
    let loaded = board.load(&job, &mut |done, total| {
        if done > 0 && !begun {
            // The time that CRCs took before says nothing about words.
            (bar, begun) = (ui.progress(total, "words"), true);
        }
        words = total;
        bar.of(done, total);
        interrupt::flow()
    });
    let loaded = loaded.map_err(|error| stopped(error, &design, begun, ui))?;
    bar.of(words, words);
    drop(bar);
    let in_use = loaded.in_use == loaded.bank;
    let needed = match load.curve {
        None if in_use => needed(&mut board, &network, before, ui)?,
        _ => None,
    };
    if let Some(curve) = load.curve.or(needed) {
        let bar = ui.progress(0, "words of the display's tables");
        board.load_tables(&display(curve), &mut watched(&bar)).map_err(of)?;
    }
    if let Some(curve) = needed {
        let (name, values) = (&network.origin.name, network.origin.values);
        ui.note(format!(
            "{name} gives {values} values: the display's tables are now those of {}",
            name_of(curve)
        ));
    }
    tell(&network, &loaded, (start.elapsed().as_secs_f64(), board.repeats()), ui)
}

/// Tells what a load did, in how many seconds and with how many frames sent again.
fn tell(
    network: &FixedNetwork,
    loaded: &Loaded,
    (seconds, repeats): (f64, u64),
    ui: &Ui,
) -> Result<(), Error> {
    ui.say(format!(
        "{} in bank {}: {} of {} parts written, {} words of {}, in {seconds:.2} s; bank {} is in use",
        network.origin.name,
        loaded.bank,
        loaded.written_parts,
        loaded.parts,
        loaded.words,
        loaded.words_of_network,
        loaded.in_use
    ))?;
    if loaded.rounds > 1 || loaded.recovered {
        ui.note(format!(
            "the line is not clean: {} rounds, {} frames sent again{}",
            loaded.rounds,
            repeats,
            if loaded.recovered { ", and registers or words put back" } else { "" }
        ));
    }
    ui.json(&json!({ "loaded": loaded, "seconds": seconds, "repeats": repeats }))
}

/// A failure of a load; of one that broke off, perhaps before it had begun, it is said how the board is now.
fn stopped(error: edof_board::Error, design: &Design, begun: bool, ui: &Ui) -> Error {
    use edof_board::Error::{Interrupted, Noisy, Port, Silent};
    if matches!(error, Interrupted) && !begun {
        ui.note(if design.sets == 1 {
            "no word of the network was written, but the board makes no frames until a load is complete; load again"
        } else {
            "no word of the network was written: both banks hold what they held"
        });
    } else if matches!(error, Interrupted | Noisy { .. } | Port { .. } | Silent { .. }) {
        ui.note(if design.sets == 1 {
            "the load is not complete, and the board has one set of weights: it makes no frames until a load is complete; load again"
        } else {
            "the load is not complete: the weights in use are still used, the other bank is half written; load again"
        });
    }
    of(error)
}

/// Shows progress, and stops at Ctrl-C.
fn watched(bar: &Progress) -> impl FnMut(u64, u64) -> ControlFlow<()> + '_ {
    |done, total| {
        bar.of(done, total);
        interrupt::flow()
    }
}

const ROWS: &str = "rows read back";

/// The values of the network in use, where the program has it.
fn values_in_use(board: &Board<Serial>, design: &Design, known: &[FixedNetwork]) -> Option<Tone> {
    let is_in_use = |network: &&FixedNetwork| weights_hash(design, network) == board.identity.weights_hash;
    known.iter().find(is_in_use).map(|network| network.origin.values)
}

/// The curve of the tables that a network's picture needs and the board does not have, where the network of before had, or may have had, values of
/// another kind.
fn needed(
    board: &mut Board<Serial>,
    network: &FixedNetwork,
    before: Option<Tone>,
    ui: &Ui,
) -> Result<Option<Curve>, Error> {
    // Reading the tables' CRCs takes as long as loading a small network.
    if before != Some(Tone::Srgb) && network.origin.values == Tone::Linear {
        return Ok(None);
    }
    let found = curve_of(board, ui)?;
    let wanted = shown_by(network);
    let straight = |curve: &Curve| *curve == Curve::Linear;
    let found = found.and_then(|name| of_curve(name).ok());
    Ok(found.filter(|found| straight(found) != straight(&wanted)).map(|_| wanted))
}

/// The curve of the tables that show a network's values.
const fn shown_by(network: &FixedNetwork) -> Curve {
    match network.origin.values {
        Tone::Linear => Curve::Srgb,
        // Such values are sRGB's codes already.
        Tone::Srgb => Curve::Linear,
    }
}

/// Rates of lines that a bridge may have, and what a load takes on them.
const RATES: [u32; 3] = [115_200, 460_800, 921_600];

fn plan(
    args: &super::Args,
    job: &Job<'_>,
    (bank, held): (Set, Option<&[u32]>),
    (curve, of_tables): (Option<Curve>, Option<&str>),
    ui: &Ui,
) -> Result<(), Error> {
    let own = args.baud_of(job.design);
    let plan = dry_run::plan(job, bank, held, own).map_err(of)?;
    ui.say(format!(
        "{} into bank {}: {} of {} parts, {} words, {} bytes there and {} back in {} turns",
        job.network.origin.name,
        plan.bank,
        plan.written_parts,
        plan.parts,
        plan.words,
        plan.bytes[0],
        plan.bytes[1],
        plan.turns
    ))?;
    ui.say(format!(
        "{:.2} s at {} bits per second, and what the line's bridge takes for each turn",
        plan.seconds, plan.baud
    ))?;
    let mut rates = vec![];
    for baud in RATES.into_iter().filter(|baud| *baud != own) {
        let seconds = dry_run::plan(job, bank, held, baud).map_err(of)?.seconds;
        ui.say(format!("{seconds:.2} s at {baud}"))?;
        rates.push(json!({ "baud": baud, "seconds": seconds }));
    }
    let besides = |curve, held: Option<&str>| {
        dry_run::tables(&display(curve), held.map(display_of).as_ref(), job.design.clock_mhz, own)
    };
    let tables = curve.map(|curve| besides(curve, of_tables));
    if let Some((words, seconds)) = tables {
        let all = plan.seconds + seconds;
        ui.say(format!("display tables besides: {words} words, {seconds:.2} s; {all:.2} s in all at {own}"))?;
    } else if held.is_none() {
        // Nobody knows what the board's tables are for.
        let other = if shown_by(job.network) == Curve::Linear { Curve::Srgb } else { Curve::Linear };
        let (words, seconds) = besides(shown_by(job.network), Some(name_of(other)));
        ui.say(format!(
            "if the display's tables change, as from linear to encoded values: {words} words and {seconds:.2} s more at {own}"
        ))?;
    }
    ui.json(&json!({ "plan": plan, "other_rates": rates, "tables": tables }))
}

/// # Errors
/// What is not the same is a failure, too.
pub fn verify(args: &super::Args, verify: &Verify, ui: &Ui) -> Result<(), Error> {
    let network = network(args, &verify.weights, ui)?;
    let mut board = args.open()?;
    let design = args.design_of(&board)?;
    let bank = verify.bank.map_or_else(|| board.bank(), Ok).map_err(of)?;
    let bar = ui.progress(0, ROWS);
    let differences =
        board.verify(&design, &network, bank, verify.read_back, &mut watched(&bar)).map_err(of)?;
    drop(bar);
    let pieces = parts(&design, &network, bank).len();
    if let Some(first) = differences.first() {
        let told: Vec<String> = differences.iter().map(ToString::to_string).collect();
        let error = of(edof_board::Error::Differs {
            port: board.port(),
            bank: letter(bank),
            weights: network.origin.name,
            wrong: differences.len(),
            pieces,
            first: first.to_string(),
        });
        ui.json(&json!({
            "bank": letter(bank), "weights": verify.weights, "parts": pieces, "differences": differences, "differ": told,
            "error": error.to_string(),
        }))?;
        return Err(error);
    }
    let curve = tables(&mut board, verify.curve, ui)?;
    board.confirm(&design, &network, bank).map_err(of)?;
    ui.say(format!("bank {} holds {}: {pieces} parts, every CRC right", letter(bank), network.origin.name))?;
    ui.say(format!("the display's tables are those of {curve}: every CRC right"))?;
    ui.json(&json!({ "bank": letter(bank), "parts": pieces, "differences": differences, "curve": curve }))
}

/// The name of the curve that a board's tables are for, which is the wanted one if one is.
fn tables(board: &mut Board<Serial>, wanted: Option<Curve>, ui: &Ui) -> Result<&'static str, Error> {
    let Some(curve) = wanted else {
        let found = curve_of(board, ui)?;
        return found.ok_or_else(|| of(edof_board::Error::UnknownTables { port: board.port() }));
    };
    let name = name_of(curve);
    let bar = ui.progress(0, ROWS);
    let differences = board.verify_tables(&display(curve), &mut watched(&bar)).map_err(of)?;
    drop(bar);
    let Some(first) = differences.first() else { return Ok(name) };
    let error = of(edof_board::Error::TablesDiffer {
        port: board.port(),
        curve: name.into(),
        wrong: differences.len(),
        first: first.to_string(),
    });
    let told: Vec<String> = differences.iter().map(ToString::to_string).collect();
    ui.json(&json!({ "curve": name, "tables_differ": told, "error": error.to_string() }))?;
    Err(error)
}
