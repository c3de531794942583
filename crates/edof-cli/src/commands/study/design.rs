//! `edof study design`: which networks and foldings are worth building.

use super::options::Outputs;
use crate::commands::explore::{self, Found};
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use edof_golden::cycle::explore::front;
use edof_study::design::{Folding, Foldings};
use edof_study::report::csv;

/// Foldings of networks that fit the board: dB against cycles, multipliers and frames per second, and the Pareto-optimal ones
///
/// A folding is the number of lanes (outputs computed at once) and rows (values multiplied per cycle in each lane) of every stage.
/// The foldings and figures are those of edof explore. All foldings that are Pareto-optimal for their network are kept, however slow, and plotted.
#[derive(clap::Args)]
#[group(skip)]
#[command(after_help = "\
Examples:
  edof study design --weights paper-t4,edof-t4w12,edof-t4w12-outer --report design.html
  edof study design --weights edof-t4w12 --photo kodim01.png --psi 0,4,8 --csv foldings.csv")]
pub struct Args {
    #[command(flatten)]
    explore: explore::Args,

    #[command(flatten)]
    outputs: Outputs,
}

/// # Errors
/// A network, design or picture that cannot be used, or nothing that fits the device.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    args.outputs.of(args.explore.files(Files::new(ui))).keeps(args.explore.force).check()?;
    let (base, found) = args.explore.found(ui)?;
    let all = front(&found.iter().map(Found::figures).collect::<Vec<_>>());
    let mut foldings = vec![];
    for own in found.iter().zip(&all).collect::<Vec<_>>().chunk_by(|a, b| a.0.network == b.0.network) {
        let kept = front(&own.iter().map(|(one, _)| one.figures()).collect::<Vec<_>>());
        let kept = own.iter().zip(kept).filter(|(_, keep)| *keep);
        foldings.extend(kept.map(|((one, on_front), _)| folding(one, **on_front)));
    }
    let part = &base.board.part;
    let study = Foldings {
        foldings,
        design: base.name,
        clock_mhz: base.clock_mhz,
        required_frames_per_second: args.explore.fps(),
        device: part.name.to_owned(),
        cells: [part.multiplier.name, part.memory.name],
        pictures: args.explore.pictures(),
    };
    let report = || Ok(study.report(&ui.signed(&ui.provenance().command)));
    args.outputs.write(|| study.to_markdown(&ui.made_here()), report, || csv::of(&study.foldings))?;
    ui.say(study.to_text())?;
    ui.json(&study)
}

fn folding(one: &Found, on_front: bool) -> Folding {
    Folding {
        network: one.network.clone(),
        camera: one.camera.clone(),
        psnr_db: one.db,
        stages: one.folding.words.clone(),
        cycles_per_patch: one.folding.cycles,
        worst_picture_cycles_per_patch: one.folding.worst_cycles,
        frames_per_second: one.folding.frames,
        multipliers: one.folding.used.multipliers,
        memories: one.folding.used.whole_memories(),
        on_front,
    }
}
