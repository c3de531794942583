//! `edof board status`.

use super::of;
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_board::diagnosis::{Finding, findings};
use edof_board::status::{NO_PICTURE, Report, StatusSnapshot, report};
use edof_core::words::number;
use edof_device::registers::map::register;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Print whether memory, calculator and pictures work, frames per second, non-zeros and clamped values of every stage, and what each video chip lacks
///
/// Words in capitals mark what is not as it should be, and what to do stands behind them. Counters are those of the time since the look before.
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

fn chip_lines(chips: &[Finding]) -> Vec<String> {
    let line = |Finding { about, is_good, text }: &Finding| {
        format!("{about}: {}{text}", if *is_good { "" } else { "NOT WORKING, " })
    };
    chips.iter().map(line).collect()
}

/// How the board is, and what to do where something is not as it should be; then what the stages did.
fn lines(now: &StatusSnapshot, report: &Report, clock_mhz: f64) -> Vec<String> {
    let mut lines = vec![memory(now), calculator(now, report, clock_mhz), pictures(now, report)];
    lines.push("stage  non-zeros per patch  clamped: results  codes  differences (0 is best)".to_owned());
    lines.extend(report.stages.iter().map(|stage| {
        format!(
            "{:<5}  {:>19.1}  {:>16}  {:>5}  {:>11}",
            stage.layer,
            stage.nonzeros_per_patch,
            stage.saturated_results,
            stage.saturated_codes,
            stage.saturated_differences
        )
    }));
    if report.wrong_windows != [0, 0] {
        lines.push(
            "windows: WRONG LENGTHS, the chip or its timing is faulty; 'edof board selftest' names the part"
                .to_owned(),
        );
    }
    if now.value("status.weights_unchecked") == 1 {
        lines.push(
            "weights: IN DOUBT, the calculator's clock was lost; 'edof board verify' checks them".to_owned(),
        );
    }
    let doc = |name: &str| register(name).map_or(String::new(), |register| register.doc.replace('`', ""));
    lines.extend(report.grown.iter().map(|(name, count)| {
        format!("{name}: GROWS, {count} more. {} (docs/bring-up.md has what to look at)", doc(name))
    }));
    lines
}

fn memory(now: &StatusSnapshot) -> String {
    match now.value("status.dram_ready") {
        1 => "memory: ready".to_owned(),
        _ => {
            "memory: NOT READY, its controller is in reset or not calibrated: LED 0 of docs/bring-up.md and docs/ulx3s.md".to_owned()
        }
    }
}

fn calculator(now: &StatusSnapshot, report: &Report, clock_mhz: f64) -> String {
    let bank = if now.value("control.weight_set") == 0 { 'a' } else { 'b' };
    if now.value("status.calculator_runs") == 0 {
        return "calculator: NO CLOCK, its PLL is not locked: LED 7 of docs/bring-up.md and docs/ulx3s.md"
            .to_owned();
    }
    if now.value("control.run") == 0 {
        return "calculator: STOPPED, the last picture is repeated; a complete load starts it, and so does 'edof board set control.run 1'"
            .to_owned();
    }
    let busy = 100.0 * report.busy_share;
    let cycles = report
        .cycles_per_patch
        .map_or("no patch was made".to_owned(), |cycles| format!("{cycles:.1} cycles per patch"));
    format!("calculator: runs at {clock_mhz} MHz with bank {bank}, busy {busy:.0} % of the time, {cycles}")
}

fn pictures(now: &StatusSnapshot, report: &Report) -> String {
    if now.value("status.output_runs") == 0 {
        return format!("pictures: NONE YET, {NO_PICTURE}");
    }
    let (made, shown) = (report.frames_per_second, report.screen_frames_per_second);
    let late = match report.late_frames {
        0 => "each a new picture".to_owned(),
        late => format!(
            "{late} of them the picture before once more, as pictures come slower than the screen's frames"
        ),
    };
    format!(
        "pictures leave the board: {made:.1} pictures per second, {shown:.1} frames per second on the screen, {late}"
    )
}
