//! `edof board status`.

use super::of;
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_board::diagnosis::{Finding, findings};
use edof_board::status::{Report, StatusSnapshot, report};
use edof_core::words::number;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Print frames per second, late frames, share of busy cycles, non-zeros and saturations of every stage, and missing conditions of the video chips
#[derive(clap::Args)]
#[command(after_help = "Examples:
  edof board status
  edof board status --watch --seconds 5 --json")]
pub struct Args {
    /// Repeat until Ctrl-C; with --json each snapshot is a line of JSON with its time
    #[arg(long)]
    watch: bool,

    /// Seconds between snapshots
    #[arg(long, default_value_t = 1.0, value_name = "SECONDS")]
    seconds: f64,
}

/// How often a wait looks whether to stop.
const BLINK: Duration = Duration::from_millis(20);

/// # Errors
/// A line that fails.
pub fn run(args: &super::Args, status: &Args, ui: &Ui) -> Result<(), Error> {
    if !(status.seconds > 0.0 && status.seconds <= 3600.0) {
        return Err(Error::message(format!(
            "--seconds {}: must be above 0, at most 3600",
            number(status.seconds)
        )));
    }
    let mut board = args.open()?;
    let design = args.design_of(&board)?;
    let stages = design.stages.len();
    let mut before = board.look(stages).map_err(of)?;
    let mut at = Instant::now();
    loop {
        while at.elapsed().as_secs_f64() < status.seconds {
            interrupt::check()?;
            std::thread::sleep(BLINK.min(Duration::from_secs_f64(status.seconds)));
        }
        let seconds = at.elapsed().as_secs_f64();
        at = Instant::now();
        let after = board.look(stages).map_err(of)?;
        let told = report(&before, &after, seconds, design.clock_mhz);
        if status.watch && std::io::stdout().is_terminal() {
            // The screen anew, from its corner.
            ui.say("\x1b[2J\x1b[H")?;
        }
        let chips = findings(design.board, &after);
        lines(&after, &told, design.clock_mhz)
            .iter()
            .chain(&chip_lines(&chips))
            .try_for_each(|line| ui.say(line))?;
        if !status.watch {
            return ui.json(&serde_json::json!({ "now": after, "report": told, "chips": chips }));
        }
        ui.json_line(&serde_json::json!({ "now": after, "report": told, "chips": chips }))?;
        before = after;
    }
}

const FLAGS: [(&str, &str); 7] = [
    ("status.dram_ready", "memory ready"),
    ("status.calculator_runs", "calculator's clock there"),
    ("status.input_present", "signal"),
    ("status.input_fits", "of the right size"),
    ("status.output_runs", "pictures leave"),
    ("status.i2c_done", "video chips set up"),
    ("control.run", "running"),
];

fn chip_lines(chips: &[Finding]) -> Vec<String> {
    let line = |Finding { about, is_good, text }: &Finding| {
        format!("{about}: {}{text}", if *is_good { "" } else { "NOT WORKING, " })
    };
    chips.iter().map(line).collect()
}

fn lines(now: &StatusSnapshot, report: &Report, clock_mhz: f64) -> Vec<String> {
    let flag = |(name, what): &(&str, &str)| {
        if now.value(name) == 1 { (*what).to_owned() } else { format!("NOT {what}") }
    };
    let bank = if now.value("control.weight_set") == 0 { 'a' } else { 'b' };
    let cycles = report.cycles_per_patch.map_or("none".into(), |cycles| format!("{cycles:.1}"));
    let mut lines = vec![
        format!("{}; bank {bank}", FLAGS.iter().map(flag).collect::<Vec<_>>().join(", ")),
        format!(
            "{:.1} pictures per second of {:.1} frames on the screen, {} late; calculator at {clock_mhz} MHz busy {:.0} %, {cycles} cycles per patch",
            report.frames_per_second,
            report.screen_frames_per_second,
            report.late_frames,
            100.0 * report.busy_share
        ),
        "stage  non-zeros per patch  saturated: results  codes  differences".to_owned(),
    ];
    lines.extend(report.stages.iter().map(|stage| {
        format!(
            "{:<5}  {:>17.1}  {:>18}  {:>5}  {:>11}",
            stage.layer,
            stage.nonzeros_per_patch,
            stage.saturated_results,
            stage.saturated_codes,
            stage.saturated_differences
        )
    }));
    if now.value("status.weights_unchecked") == 1 {
        lines
            .push("the calculator's clock was lost: run `edof board verify` to check the weights".to_owned());
    }
    lines.extend(report.grown.iter().map(|(name, count)| format!("{name}: {count} more")));
    lines
}
