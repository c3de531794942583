//! `edof board selftest`.

use super::check::in_use;
use super::of;
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_board::self_test::SelfTest;
use edof_golden::Golden;
use serde_json::json;

/// Test every part of the board that needs neither a source nor a screen
///
/// Bus, weights (CRC), memory of raw frames (each bit as 0 and as 1 in all three buffers, and noise), windows, multipliers of every stage, display,
/// memory of pictures, both video chips, clocks against each other. The result of each part is printed; the command fails if a part
/// fails. Takes a minute at 1080p, mostly for the golden model.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board selftest
  edof board selftest mine.fixed.safetensors")]
pub struct Args {
    /// Network in use, by name or file [default: detected among the built-in ones]
    pub(super) weights: Option<String>,

    /// Do not require the design's screen clock: a simulated circuit has another
    #[arg(long)]
    any_clocks: bool,
}

/// # Errors
/// A part that fails, an unknown network, a line that fails, or Ctrl-C.
pub fn run(args: &super::Args, test: &Args, ui: &Ui) -> Result<(), Error> {
    let mut board = args.open()?;
    let design = args.design_of(&board)?;
    let (network, display) = in_use(&mut board, &design, test.weights.as_deref(), ui)?;
    let golden = Golden::new(network)?;
    let bar = ui.progress(0, "steps of the test");
    let mut step = |done, total| {
        bar.of(done, total);
        interrupt::flow()
    };
    let test = SelfTest { design: &design, golden: &golden, display: &display, clocks: !test.any_clocks };
    let items = board.self_test(&test, &mut step).map_err(of)?;
    drop(bar);
    for item in &items {
        ui.say(format!("{:<15} {:<6} {}", item.part, if item.passed { "ok" } else { "FAILS" }, item.detail))?;
    }
    let failed: Vec<&str> = items.iter().filter(|item| !item.passed).map(|item| item.part).collect();
    ui.json(&json!({ "design": design.name, "passed": failed.is_empty(), "parts": items }))?;
    if failed.is_empty() {
        return ui.say("every part that was tried works");
    }
    Err(Error::message(format!(
        "{}: {} of {} parts fail: {}",
        board.port(),
        failed.len(),
        items.len(),
        failed.join(", ")
    )))
}
