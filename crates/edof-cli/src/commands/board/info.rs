//! `edof board info`.

use super::memories::{Memories, Wanted};
use super::{Own, fits, known, load};
use crate::error::Error;
use crate::ui::Ui;
use edof_board::contents::letter;
use edof_board::{Board, Line, Serial};
use edof_device::Design;
use edof_device::design::memory::Set;
use edof_device::registers::identity::weights_hash;
use edof_network::FixedNetwork;
use serde_json::{Value, json};

/// Print design, picture size and clock of the board, and the network in each bank
///
/// Networks and the curve of the display's tables are known by CRCs that the board makes of its memories: a second on a board, minutes on a board that is
/// simulated with --rtl. With --quick registers alone are read, which takes seconds there, too.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board info
  edof board info --weights mine.fixed.safetensors     names a network of your own
  edof board info --quick")]
pub struct Info {
    #[command(flatten)]
    pub(super) own: Own,

    /// Read registers alone: the network in use by the hash that its load left, no other bank, no tables
    #[arg(long)]
    quick: bool,
}

/// # Errors
/// A network that does not fit, a line that fails, or Ctrl-C.
pub fn run(args: &super::Args, info: &Info, ui: &Ui) -> Result<(), Error> {
    let own = info.own.networks(ui)?;
    let mut board = args.open()?;
    let identity = board.identity;
    let design = identity.design(args.designs()?);
    if let Some(design) = &design {
        own.iter().try_for_each(|network| fits(design, network))?;
    }
    let (major, minor) = (identity.version >> 16, identity.version & 0xffff);
    let name = design.as_ref().map_or("unknown", |design| design.name.as_str());
    ui.say(format!("{}: edof board, register map {major}.{minor}", board.port()))?;
    ui.say(format!("design {name} ({:08x}), {}x{}", identity.design_hash, identity.width, identity.height))?;
    let clock = design.as_ref().map(|design| design.clock_mhz);
    let told = clock.map_or("an unknown clock".to_owned(), |mhz| format!("{mhz} MHz"));
    let line = match board.line().is_pseudo_terminal() {
        true => "simulated line".to_owned(),
        false => format!("line {} bits per second", board.line().baud()),
    };
    ui.say(format!("calculator at {told}, {line}"))?;
    let in_use = board.bank()?;
    let sets = design.as_ref().map_or(2, |design| design.sets);
    let banks = &[Set::First, Set::Second][..sets];
    let memories = match info.quick {
        true => None,
        false => Some(Memories::read(&mut board, design.as_ref(), &Wanted { banks, tables: true }, ui)?),
    };
    let of_bank = |bank: &Set| held(&board, design.as_ref(), memories.as_ref(), [*bank, in_use], &own);
    let held: Vec<Held> = banks.iter().map(of_bank).collect();
    held.iter().try_for_each(|held| ui.say(held.line()))?;
    let curve = memories.as_ref().and_then(load::curve_in);
    if memories.is_some() {
        ui.say(format!("display tables: {}", curve.unwrap_or("of none of the program's curves")))?;
    }
    ui.json(&json!({
        "identity": identity,
        "curve": curve,
        "design": design.map(|design| design.name),
        "clock_mhz": clock,
        "banks": held.iter().map(Held::json).collect::<Vec<_>>(),
    }))
}

/// What is known of a bank.
struct Held {
    bank: Set,
    is_in_use: bool,
    /// Whether its words were read.
    is_read: bool,
    name: Option<String>,
    hash: Option<String>,
    checksum: Option<String>,
}

/// Of a bank, and of the bank in use.
fn held(
    board: &Board<Serial>,
    design: Option<&Design>,
    memories: Option<&Memories>,
    [bank, in_use]: [Set; 2],
    own: &[FixedNetwork],
) -> Held {
    let (is_in_use, of_board) = (bank == in_use, board.identity.weights_hash);
    let by_register = || if is_in_use { of_board } else { 0 };
    let (name, hash) = match (design, memories) {
        (Some(design), Some(memories)) => memories.held(board, design, [bank, in_use], own),
        (Some(design), None) => {
            let known = known(design, own);
            let is_it = |network: &&FixedNetwork| is_in_use && weights_hash(design, network) == of_board;
            (known.iter().find(is_it).map(|network| network.origin.name.clone()), by_register())
        }
        (None, _) => (None, by_register()),
    };
    let checksum = design.and(memories).map(|memories| format!("{:08x}", memories.checksum(bank)));
    let hash = (hash != 0).then(|| format!("{hash:08x}"));
    Held { bank, is_in_use, is_read: memories.is_some(), name, hash, checksum }
}

impl Held {
    fn line(&self) -> String {
        let told = match &self.name {
            Some(name) if self.is_read => name.clone(),
            Some(name) => format!("{name} by its hash"),
            None if self.is_read || self.is_in_use => {
                "a network that the program does not have; name its file by --weights".to_owned()
            }
            None => "not read".to_owned(),
        };
        let shown = match (&self.hash, &self.checksum) {
            (Some(hash), Some(sum)) => format!("hash {hash}, checksum {sum}"),
            (Some(hash), None) => format!("hash {hash}"),
            (None, Some(sum)) => format!("checksum {sum}"),
            (None, None) => "hash unknown".to_owned(),
        };
        let used = if self.is_in_use { ", in use" } else { "" };
        format!("bank {}: {shown}{used}, {told}", letter(self.bank))
    }

    fn json(&self) -> Value {
        json!({
            "bank": letter(self.bank), "weights": self.name, "hash": self.hash, "checksum": self.checksum,
            "in_use": self.is_in_use,
        })
    }
}
