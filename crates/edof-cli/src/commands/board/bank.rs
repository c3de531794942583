//! `edof board bank`: which of two networks is in use.

use super::memories::{Memories, Wanted};
use super::{Own, known_by_name, load, of};
use crate::error::Error;
use crate::ui::Ui;
use edof_board::contents::letter;
use edof_board::{Board, Serial};
use edof_core::{Noise, Tone};
use edof_device::design::memory::Set;
use edof_device::registers::map;
use edof_network::FixedNetwork;
use edof_network::fit::best_fit;
use serde_json::json;

/// Use the weights of bank a or b, or the network for a noise, from the next frame on
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board bank b
  edof board bank --noise 0.02                         the bank with the network for that noise")]
pub struct Bank {
    /// Bank: a or b
    #[arg(value_parser = super::bank_of, required_unless_present = "noise", conflicts_with = "noise")]
    bank: Option<Set>,

    /// Use the network whose range of noise suits this noise: none, a standard deviation such as 0.01, or sensor:gain=8. The choice is among
    /// networks for the lens and tone of the network in use. If neither bank contains the chosen network, it is first loaded into the idle bank
    #[arg(long, value_name = "NOISE", allow_hyphen_values = true)]
    noise: Option<Noise>,

    #[command(flatten)]
    pub(super) own: Own,
}

/// # Errors
/// A line that fails; with a noise, banks with networks that the program does not have.
pub fn run(args: &super::Args, bank: &Bank, ui: &Ui) -> Result<(), Error> {
    let own = bank.own.networks(ui)?;
    let mut board = args.open()?;
    let before = board.bank()?;
    let chosen = match (bank.bank, bank.noise) {
        (Some(bank), _) => Choice::Bank(bank),
        (None, noise) => choose(args, bank, &own, &mut board, noise.unwrap_or_default(), ui)?,
    };
    match chosen {
        Choice::Bank(bank) => switch(args, &mut board, [before, bank], &own, ui),
        Choice::Load(name) => {
            drop(board);
            load::load(args, &load::Load::of(name), ui)
        }
    }
}

/// What brings a network into use.
enum Choice {
    /// The network is in this bank.
    Bank(Set),
    /// Neither bank contains the network; its name or file.
    Load(String),
}

/// The network that suits a noise best, among those for the lens and tone of the one in use.
fn choose(
    args: &super::Args,
    bank: &Bank,
    own: &[FixedNetwork],
    board: &mut Board<Serial>,
    noise: Noise,
    ui: &Ui,
) -> Result<Choice, Error> {
    let design = args.design_of(board)?;
    let in_use = board.bank()?;
    let other = edof_board::contents::other(in_use);
    let (names, networks): (Vec<String>, Vec<FixedNetwork>) =
        known_by_name(&design, &bank.own.weights, own).into_iter().unzip();
    let mut places = vec![];
    let memories =
        Memories::read(board, Some(&design), &Wanted { banks: &[in_use, other], tables: false }, ui)?;
    for bank in [in_use, other] {
        places.extend(memories.network(&design, &networks, bank).map(|index| (index, bank)));
    }
    let Some(&(first, _)) = places.first() else {
        return Err(Error::message(
            "--noise: both banks contain networks that the program does not have; name their files by --weights",
        ));
    };
    let model = &networks[first].origin;
    let tone = model.conditions.first().map_or(Tone::Linear, |condition| condition.tone);
    let fits = |index: &usize| {
        let origin = &networks[*index].origin;
        let alike = origin.camera.same_lens(&model.camera) && origin.values == model.values;
        let fit = origin.fit(tone, noise).filter(|_| alike);
        fit.map(|fit| (*index, fit))
    };
    // Of networks that suit it equally, the one that is in use, then the one in the other bank.
    let all = places.iter().map(|(index, _)| *index).chain(0..networks.len()).collect::<Vec<_>>();
    let Some((chosen, fit)) = best_fit(all.iter().filter_map(fits)) else {
        return Err(Error::message(format!("--noise {noise}: the network in use does not state its noise")));
    };
    if !fit.is_inside() {
        let name = &networks[chosen].origin.name;
        ui.note(format!("--noise {noise}: no network for this lens was trained for it; {name} is nearest"));
    }
    let place = places.iter().find(|(index, _)| *index == chosen);
    Ok(place.map_or_else(|| Choice::Load(names[chosen].clone()), |(_, bank)| Choice::Bank(*bank)))
}

fn switch(
    args: &super::Args,
    board: &mut Board<Serial>,
    [before, bank]: [Set; 2],
    own: &[FixedNetwork],
    ui: &Ui,
) -> Result<(), Error> {
    // The switch first: the scene does not wait for names.
    board.change_control(map::WEIGHT_SET, if bank == Set::First { 0 } else { map::WEIGHT_SET })?;
    let banks = if bank == before { &[bank][..] } else { &[bank, before][..] };
    let (name, hash) = match board.identity.design(args.designs()?) {
        Some(design) => {
            let memories = Memories::read(board, Some(&design), &Wanted { banks, tables: false }, ui)?;
            memories.held(board, &design, [bank, before], own)
        }
        None => (None, if bank == before { board.identity.weights_hash } else { 0 }),
    };
    board.switch(bank, hash).map_err(of)?;
    let told = name.clone();
    let told = told.unwrap_or_else(|| format!("a network that the program does not have, hash {hash:08x}"));
    ui.say(format!("bank {} is in use: {told}", letter(bank)))?;
    let hash = (hash != 0).then(|| format!("{hash:08x}"));
    ui.json(&json!({ "bank": letter(bank), "weights": name, "hash": hash }))
}
