//! `edof cosim --system` of a board with a camera: everything between its pins.

use crate::cosim_system::{Run, with_rtl};
use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_core::{CfaPhase, RawFrame};
use edof_cosim::system::camera_to_screen::Trip;
use edof_cosim::system::{FirstLight, first_light};
use edof_cosim::verilator::Options;
use edof_device::Design;
use edof_golden::{Display, Golden};
use edof_hdl::board::Pace;
use edof_network::FixedNetwork;
use serde_json::json;
use std::ops::ControlFlow;
use std::time::Instant;

/// Bits of a pixel at the camera's pins.
const BITS: u32 = 8;

/// Sends frames from the camera's pins to the screen's, at the board's own speeds.
///
/// # Errors
/// A frame that the camera cannot send, a folder without the circuit, a simulator that is missing, or a picture that is not the golden one.
pub fn run(
    design: &Design,
    network: FixedNetwork,
    display: &Display,
    frames: &[RawFrame],
    how: &Run<'_>,
    ui: &Ui,
) -> Result<(), Error> {
    let start = Instant::now();
    if how.icarus {
        let problem = format!(
            "--icarus: must be left out for {}, whose camera and memory are models of this program",
            design.board.name
        );
        return Err(Error::message(problem));
    }
    if design.camera.is_some() {
        return Err(Error::message(format!(
            "design {}: camera must be left out, as the camera's model is of the module that the board states",
            design.name
        )));
    }
    let frames = frames.iter().map(|raw| bytes(design, raw)).collect::<Result<Vec<_>, _>>()?;
    let pace = Pace::of(design.board);
    let project = first_light::project(design, [&network; 2], display, &pace)?;
    let project = with_rtl(project, how.rtl)?;
    ui.note(format!("compiling {} modules with Verilator", project.verilog.len()));
    let options = Options { cache: Options::user_cache(), ..Options::default() };
    let mut board = FirstLight::start(&project, design, (pace, how.seed), &options)?;
    interrupt::check()?;

    let golden = Golden::new(network)?;
    let bar = ui.progress(frames.len() as u64, "pictures shown");
    let trip = Trip { screen: design.screen(), golden: &golden, display, frames: &frames, seed: how.seed };
    let shown = trip.run(&mut board, &mut |number, seconds| {
        bar.message(format!("{:.0} ms simulated", 1e3 * seconds));
        bar.set(number as u64);
        interrupt::check().map_or(ControlFlow::Break(()), |()| ControlFlow::Continue(()))
    });
    drop(bar);
    interrupt::check()?;
    let shown = shown.map_err(|e| Error::message(e.to_string()))?;
    let [line, cycle] = shown.camera_starts_at;
    let rate = shown
        .pictures_per_second
        .map_or_else(String::new, |rate| format!("; {rate:.1} pictures a second came into the memory"));
    ui.say(format!(
        "{}: {} pictures one after the other from the camera's pins to the screen's, every pixel of {} frames of the screen as golden, and every word of \
         the last one at every boundary; the camera started in line {line}, cycle {cycle}, and its clock stood still {} times{rate}",
        design.name, frames.len(), shown.screen_frames, shown.stops
    ))?;
    ui.json(&json!({
        "design": design.name,
        "frame": design.frame,
        "display": display.mode,
        "pictures_in_a_row": frames.len(),
        "screen_frames": shown.screen_frames,
        "camera_starts_at": shown.camera_starts_at,
        "camera_stops": shown.stops,
        "pictures_per_second": shown.pictures_per_second,
        "memory_refreshes": shown.refreshes,
        "differences": 0,
        "simulated_seconds": shown.seconds,
        "seed": how.seed,
        "seconds": start.elapsed().as_secs_f64(),
    }))
}

/// A frame as the camera can send it.
fn bytes(design: &Design, raw: &RawFrame) -> Result<RawFrame, Error> {
    if raw.phase() != CfaPhase::Rggb {
        let board = design.board.name;
        let problem = format!("a raw frame of phase {}: the camera of {board} sends rggb", raw.phase());
        return Err(Error::message(problem));
    }
    let shift = raw.depth().saturating_sub(BITS);
    Ok(RawFrame::from_values(raw.values().mapv(|value| value >> shift), BITS, CfaPhase::Rggb)?)
}
