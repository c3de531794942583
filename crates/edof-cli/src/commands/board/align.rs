//! `edof board align`.

use super::of;
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_board::align::{Align, Alignment, Trial};
use serde_json::json;

/// Set the receiver's clock to the middle of the window of undamaged data
///
/// Tries both polarities and all 32 taps (0.21 ns each) of the receiver's clock and counts damaged sync codes at each. Needs a receiver that is
/// set up (see 'edof board status') and has the clock of the design's mode: that of a source in this mode, or without a source that of the
/// receiver's own picture. The setting is used for later set-ups, until the board is reset.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board align
  edof board align --codes 100000")]
pub struct Args {
    /// Undamaged sync codes required of a good setting; 1080p60 has 135,000 per second
    #[arg(long, default_value_t = 10_000, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(10..=10_000_000))]
    codes: u32,

    /// Do not require the design's pixel clock: a simulated circuit has another
    #[arg(long)]
    any_clocks: bool,
}

/// # Errors
/// A receiver that is not set up, no setting that works, or a line that fails.
pub fn run(args: &super::Args, align: &Args, ui: &Ui) -> Result<(), Error> {
    let mut board = args.open()?;
    let design = (!align.any_clocks).then(|| args.design_of(&board)).transpose()?;
    let asked = Align { codes: align.codes, clock_of: design.as_ref() };
    let alignment = board.align(asked, &mut |_| interrupt::flow()).map_err(of)?;
    [false, true].iter().try_for_each(|inverted| ui.say(row(&alignment.trials, *inverted)))?;
    let Alignment { trials, window } = alignment;
    let tap = window.middle();
    ui.say(format!(
        "clock {} at tap {tap}: the middle of {} taps that work, {} to {}; set, and kept for later set-ups",
        name(window.is_inverted),
        window.taps,
        window.first,
        window.first + window.taps - 1
    ))?;
    ui.json(&json!({ "inverted": window.is_inverted, "tap": tap, "window": window, "trials": trials }))
}

const fn name(is_inverted: bool) -> &'static str {
    if is_inverted { "inverted" } else { "as it is" }
}

/// Taps of a polarity: `#` where it works, `.` where codes are damaged, a space where none come.
fn row(trials: &[Trial], inverted: bool) -> String {
    let sign = |trial: &Trial| match trial {
        trial if trial.works() => '#',
        Trial { malformed: 0, .. } => ' ',
        _ => '.',
    };
    let taps: String = trials.iter().filter(|trial| trial.is_inverted == inverted).map(sign).collect();
    format!("{:<8} taps 0 to 31: {taps}", name(inverted))
}
