//! `edof train`.

use crate::error::Error;
use crate::ui::Ui;

/// Not written yet.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  edof train")]
pub struct Args {}

/// # Errors
/// Always, until the sub-command exists.
pub fn run(_: Args, _: &Ui) -> Result<(), Error> {
    Err(Error::message("train: not in this build yet"))
}
