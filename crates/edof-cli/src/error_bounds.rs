//! A-priori bounds of what integers cost, in a table.

use crate::error::Error;
use crate::ui::Ui;
use edof_quantize::bounds::StageError;

/// Prints the bounds of every stage, in LSB of its result.
///
/// # Errors
/// Standard output that cannot be written.
pub fn tell(errors: &[StageError], ui: &Ui) -> Result<(), Error> {
    ui.say("  largest error of any window, both clamped to the same ranges, in LSB of the stage's result:")?;
    ui.say("  stage  by rounding on the way  its deviation  by rounding of weights, too")?;
    for error in errors {
        let weights = error.weights.as_ref().map_or_else(|| "-".into(), |w| format!("{:.1}", w.worst_bits));
        let (worst, deviation) = (error.rounding.worst_bits, error.rounding.deviation_bits);
        ui.say(format!("  {:5}  {worst:>22.1}  {deviation:>13.2}  {weights:>26}", error.stage))?;
    }
    Ok(())
}
