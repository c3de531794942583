//! `edof cosim --system`: the whole core, from the receiver's pins to the transmitter's; on a board with a camera all of it, from pin to pin.

use crate::cosim_camera;
use crate::error::Error;
use crate::interrupt;
use crate::said;
use crate::ui::Ui;
use edof_board::Board;
use edof_board::check::Boundary;
use edof_board::link::PATIENCE;
use edof_core::cable::carried;
use edof_core::{DisplayMode, RawFrame, words};
use edof_cosim::chain::folder::{self, with_verilog_of};
use edof_cosim::system::{
    self, Compiled, Rig, RigConfig, Speed, TableWords, Torn, VerilogBoard, recorded, second,
};
use edof_cosim::verilator::Options;
use edof_device::Design;
use edof_device::design::{DesignError, FrameSize};
use edof_device::registers::map;
use edof_golden::{Curve, Display, Golden};
use edof_hdl::project::{Project, images};
use edof_network::FixedNetwork;
use ndarray::s;
use serde_json::json;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

/// Pixels by which one frame lies beside the next in the picture.
const SHIFT: usize = 2;
/// Frames that are sent besides those that must be shown: the first is lost while the receiver waits for its vertical sync, and the
/// last is still on its way where the screen begins a picture late.
pub const BESIDES: usize = 2;

/// Frames of the screen after the last frame was begun: when they are over, that frame was sent and shown.
const UNTIL_SHOWN: usize = 3;

/// Bits per second of a line to the core that takes few cycles.
const FAST: u32 = 25_000_000;

/// What `--system` takes besides.
#[derive(clap::Args)]
#[group(skip)]
pub struct Args {
    /// Run the whole core instead: raw frames at the receiver's pins, pictures at the transmitter's, by way of a memory
    #[arg(long, conflicts_with_all = ["random", "patches", "stalls", "skip", "waveform"])]
    pub system: bool,

    /// Pictures that must be shown one after the other, each once or more
    #[arg(long, default_value_t = 5, requires = "system", value_name = "N")]
    frames: usize,

    /// How words become codes: colour or luma
    #[arg(long, default_value_t, requires = "system", value_name = "MODE")]
    display: DisplayMode,

    /// Stride between patches in place of the design's: 2, 4 or 8
    #[arg(long, requires = "system", value_name = "PIXELS")]
    stride: Option<usize>,

    /// Window in place of the design's: 8, 12 or 16; the network is then a random one
    #[arg(long, requires = "system", conflicts_with = "weights", value_name = "PIXELS")]
    window: Option<usize>,

    /// Size of frames instead of the design's
    #[arg(long, requires = "system", value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<(usize, usize)>,
}

/// A width and a height.
pub fn size(text: &str) -> Result<(usize, usize), String> {
    let sides = text.split_once('x').map(|(width, height)| (width.parse(), height.parse()));
    match sides {
        Some((Ok(width), Ok(height))) => Ok((width, height)),
        _ => Err("must be a width and a height, as in 64x48".into()),
    }
}

impl Args {
    /// Whether the frames that are asked for can be cut out of a picture.
    ///
    /// # Errors
    /// A picture that is too small.
    pub fn has_room(&self, design: &Design, raw: &RawFrame) -> Result<(), Error> {
        check_room(raw, design.frame, self.sent(design).max(1))
    }

    /// Rejects what the Verilog of a folder fixes.
    ///
    /// # Errors
    /// An option that would change the design.
    pub fn check_folder(&self, folder: &Path) -> Result<(), Error> {
        let given = [
            ("--size", self.size.is_some()),
            ("--stride", self.stride.is_some()),
            ("--window", self.window.is_some()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((option, _)) => Err(Error::message(format!(
                "{option}: the Verilog of --rtl {} is of its own design; leave {option} out, or generate a folder from a design that has it",
                folder.display()
            ))),
        }
    }

    /// How many frames are sent.
    fn sent(&self, design: &Design) -> usize {
        // A camera stays on a frame until it is shown.
        self.frames + if design.camera_chip().is_ok() { 0 } else { BESIDES }
    }

    /// The design with what was asked for in place of its own.
    ///
    /// # Errors
    /// One that cannot be built.
    pub fn design(&self, mut design: Design) -> Result<Design, Error> {
        let stride = self.stride.map_or(Ok(design.frame.stride), said::stride)?;
        let (width, height) = self.size.unwrap_or((design.frame.width, design.frame.height));
        design.form.window = self.window.map_or(Ok(design.form.window), said::window)?;
        design.frame = FrameSize { width, height, stride };
        design.check().map_err(|e| match (self.size, e) {
            (Some((width, height)), e @ (DesignError::Frame(_) | DesignError::Field { .. })) => {
                said::instead(&format!("--size {width}x{height}"), &e)
            }
            (_, e) => e.into(),
        })?;
        Ok(design)
    }
}

/// How a core is run.
pub struct Run<'a> {
    /// Of everything random.
    pub seed: u64,
    /// Whether Icarus runs the same frames.
    pub icarus: bool,
    /// The folder of its Verilog, where that is not made afresh.
    pub rtl: Option<&'a Path>,
}

/// # Errors
/// A network or picture that cannot be used, a folder without a core, a simulator that is missing, or a picture that is not the golden one.
pub fn run(
    args: &Args,
    design: &Design,
    network: FixedNetwork,
    raw: &RawFrame,
    how: &Run<'_>,
    ui: &Ui,
) -> Result<(), Error> {
    let Run { seed, icarus, rtl } = *how;
    let start = Instant::now();
    if args.frames < 1 {
        return Err(Error::message("--frames 0: must be 1 or more, or nothing is compared"));
    }
    let network = FixedNetwork { stride: design.frame.stride, ..network };
    let display = Display::of_values(network.origin.values, args.display, Curve::default());
    let frames = crops(raw, design.frame, args.sent(design))?;
    if design.camera_chip().is_ok() {
        return cosim_camera::run(design, network, &display, &frames, how, ui);
    }
    let project = system::project(design, [&network; 2], &display)?;
    let project = with_rtl(project, rtl)?;
    let golden = Golden::new(network)?;
    let passed = through_core(project, (design, &golden, &display), &frames, seed, ui)?;
    let (run, shown) = (passed.in_a_row(), &passed.shown);
    if run < args.frames {
        let problem = format!("{run} pictures were shown one after the other, expected {}", args.frames);
        return Err(Error::message(format!("{problem}: those of frames {}", list(shown))));
    }
    if let (Some(_), Some(frame)) = (rtl, frames.last()) {
        // Of a word the screen shows eight bits: a wrong lowest one is seen by the CRCs alone.
        ui.note("comparing CRCs at every boundary of the core");
        if let Some(boundary) = place(&passed.project, (design, &golden, &display), frame, seed)? {
            let problem = "every code as golden, but the core's CRCs are not";
            return Err(Error::message(format!("{problem}: the first words that differ are {boundary}")));
        }
    }
    let [written, read] = passed.traffic.map(|bytes| bytes as f64 / passed.seconds / 1e6);
    ui.say(format!(
        "{}: {run} pictures one after the other from pins to pins, every code as golden; memory {written:.1} MB/s written, {read:.1} MB/s read",
        design.name
    ))?;
    if icarus {
        ui.note("running the same frames in Icarus");
        let recorded = recorded::video(design, &frames, passed.pictures, args.display);
        ui.say(format!("Icarus: {}", second::icarus(&passed.project, &recorded)?))?;
    }
    ui.json(&json!({
        "design": design.name,
        "frame": design.frame,
        "window": design.form.window,
        "display": args.display,
        "frames_sent": frames.len(),
        "pictures_in_a_row": run,
        "shown": shown,
        "differences": 0,
        "icarus": icarus,
        "memory_bytes": { "written": passed.traffic[0], "read": passed.traffic[1] },
        "simulated_seconds": passed.seconds,
        "seed": seed,
        "seconds": start.elapsed().as_secs_f64(),
    }))
}

/// Returns a project with the Verilog of a folder of `--rtl`, if there is one.
///
/// # Errors
/// A folder without the circuit.
pub fn with_rtl(project: Project, rtl: Option<&Path>) -> Result<Project, Error> {
    let Some(folder) = rtl else { return Ok(project) };
    with_verilog_of(project, folder).map_err(|e| Error::message(format!("--rtl {e}")))
}

/// Checks that a folder of `--rtl` is of a design and, if one was named, of a network.
///
/// # Errors
/// The field or the word that differs.
pub fn check_rtl(folder: &Path, design: &Design, network: Option<&FixedNetwork>) -> Result<(), Error> {
    let stated = network.map(|network| {
        let tables = TableWords::of(&Display::of_network(network));
        let tables = if design.board.is_cabled() { tables.tables().images(design) } else { vec![] };
        let tables = tables.into_iter().filter(|(path, _)| path.contains("display"));
        let images = images(design, [network; 2]).into_iter().chain(tables).collect();
        folder::Stated { words: network.origin.values, images }
    });
    folder::check(folder, design, stated.as_ref()).map_err(|e| Error::message(format!("--rtl {e}")))
}

/// Frames by their numbers; those that were black have none.
fn list(shown: &[Option<usize>]) -> String {
    let name = |frame: &Option<usize>| frame.map_or("black".to_owned(), |frame| frame.to_string());
    shown.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// What came of frames that passed through a core.
pub struct Passed {
    /// The core.
    project: Project,
    /// What each frame must become.
    pictures: Vec<Vec<u16>>,
    /// Which picture each frame on the screen was, none where it was black.
    pub shown: Vec<Option<usize>>,
    /// Bytes that were written to the memory, and read.
    traffic: [u64; 2],
    /// Simulated time.
    seconds: f64,
}

impl Passed {
    /// Most pictures that were shown one after the other.
    pub fn in_a_row(&self) -> usize {
        system::longest_run(&self.shown)
    }
}

/// Sends frames through the core of a design in Verilator, each once, and compares every code on the screen.
///
/// # Errors
/// A network that cannot run, a simulator that is missing, or a picture that differs from all golden ones.
pub fn through(
    design: &Design,
    network: &FixedNetwork,
    display: &Display,
    frames: &[RawFrame],
    seed: u64,
    ui: &Ui,
) -> Result<Passed, Error> {
    let project = system::project(design, [network, network], display)?;
    let golden = Golden::new(network.clone())?;
    through_core(project, (design, &golden, display), frames, seed, ui)
}

/// The same through the core of a project.
fn through_core(
    project: Project,
    (design, golden, display): (&Design, &Golden, &Display),
    frames: &[RawFrame],
    seed: u64,
    ui: &Ui,
) -> Result<Passed, Error> {
    let pictures =
        frames.iter().map(|raw| system::picture(golden, display, raw)).collect::<Result<Vec<_>, _>>()?;
    ui.note(format!("compiling {} modules with Verilator", project.verilog.len()));
    let options = Options { cache: Options::user_cache(), ..Options::default() };
    let compiled = Compiled::new(&project, &options)?;
    interrupt::check()?;

    let sent = frames.iter().map(system::sent).collect();
    let config = RigConfig::leisurely(design, seed);
    let mut rig = Rig::start(&compiled, &config, sent)?;
    rig.control(display.mode, 0)?;
    // In lines, since a large frame takes minutes.
    let lines = config.timing.frame.total() * (frames.len() + UNTIL_SHOWN - 1);
    let bar = ui.progress(lines as u64, "lines sent");
    let goes_on = |rig: &Rig| {
        bar.set(rig.camera.lines as u64);
        interrupt::check().is_ok()
    };
    for frame in 1..frames.len() {
        rig.until("a frame of the camera", |rig| !goes_on(rig) || rig.camera.frame >= frame)?;
        interrupt::check()?;
    }
    // The last one is sent and shown.
    let wanted = rig.screen.frames.len() + UNTIL_SHOWN;
    rig.until("a frame on the screen", |rig| !goes_on(rig) || rig.screen.frames.len() >= wanted)?;
    interrupt::check()?;
    drop(bar);

    let shown = system::compare(&rig.screen.frames, &pictures, design.frame.width).map_err(|torn| {
        ui.note("comparing CRCs at every boundary of the core");
        let frame = &frames[torn.nearest];
        torn_at(&torn, place(&project, (design, golden, display), frame, seed))
    })?;
    let traffic = [&rig.memory.written, &rig.memory.read]
        .map(|side| side.bursts.iter().map(|(_, words)| words).sum::<u64>() * rig.memory.word_bytes());
    Ok(Passed { project, pictures, shown, traffic, seconds: rig.bench.time_ps() as f64 * 1e-12 })
}

/// The first boundary of a core whose words are not golden, by the core's own CRCs.
fn place(
    project: &Project,
    (design, golden, display): (&Design, &Golden, &Display),
    frame: &RawFrame,
    seed: u64,
) -> Result<Option<Boundary>, Error> {
    let options = Options { cache: Options::user_cache(), ..Options::default() };
    let board =
        VerilogBoard::of_project(project, design, frame, (Speed::of(design.board, FAST)?, seed), &options)?;
    let expected = golden.checks(display, &carried(frame))?;
    let mut step = |_, _| match interrupt::check() {
        Ok(()) => ControlFlow::Continue(()),
        Err(_) => ControlFlow::Break(()),
    };
    let mut board = Board::open(board, PATIENCE)?;
    board.change_control(map::COLOUR, if display.mode == DisplayMode::Colour { map::COLOUR } else { 0 })?;
    let checked = board.check_frames(&expected, 1, &mut step)?;
    Ok(checked.difference.map(|difference| difference.boundary))
}

/// A torn picture, and where in the core it was torn.
fn torn_at(torn: &Torn, place: Result<Option<Boundary>, Error>) -> Error {
    let place = match place {
        Ok(Some(boundary)) => format!("the first words that differ are {boundary}"),
        Ok(None) => "words are golden up to the codes that come out of the memory".into(),
        Err(error) => format!("the core's CRCs name no boundary: {error}"),
    };
    Error::message(format!("{torn}; {place}"))
}

/// Whether N frames can be cut out of a larger one.
fn check_room(raw: &RawFrame, frame: FrameSize, count: usize) -> Result<(), Error> {
    let (height, width) = raw.size();
    let reach = SHIFT * (count - 1);
    let needed = (frame.width + reach, frame.height + reach);
    let frames = words::count(count, "frame");
    if width >= needed.0 && height >= needed.1 {
        return Ok(());
    }
    Err(Error::message(format!(
        "{width}x{height}, must be at least {}x{} for the {frames} of {}x{} that are sent; give a larger --photo, fewer --frames, or, without --rtl, a smaller --size",
        needed.0, needed.1, frame.width, frame.height
    )))
}

/// Frames of the design's size out of a larger one, each a bit beside the one before.
fn crops(raw: &RawFrame, frame: FrameSize, count: usize) -> Result<Vec<RawFrame>, Error> {
    check_room(raw, frame, count)?;
    (0..count).map(|i| crop(raw, (SHIFT * i, SHIFT * i), frame)).collect()
}

/// A frame of that size out of a larger one, its first pixel in that even row and column.
///
/// # Errors
/// A size that no raw frame has.
pub fn crop(raw: &RawFrame, (row, column): (usize, usize), size: FrameSize) -> Result<RawFrame, Error> {
    let part = raw.values().slice(s![row..row + size.height, column..column + size.width]).to_owned();
    Ok(RawFrame::from_values(part, raw.depth(), raw.phase())?)
}
