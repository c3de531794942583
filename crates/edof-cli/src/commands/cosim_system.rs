//! `edof cosim --system`: the whole core, from the receiver's pins to the transmitter's.

use crate::error::Error;
use crate::interrupt;
use crate::ui::Ui;
use edof_cosim::bench::Behaviour;
use edof_cosim::bench::axi_lite::Access;
use edof_cosim::system::{self, Begin, Compiled, Periods, Rig};
use edof_cosim::verilator::Options;
use edof_golden::cycle::{Cycle, Patch, Summary};
use edof_golden::{Curve, Display, Golden};
use edof_hdl::board::Identity;
use edof_hdl::project::{self, Tables};
use edof_spec::design::FrameSize;
use edof_spec::design::memory::Set;
use edof_spec::registers::map;
use edof_spec::video::VideoTiming;
use edof_spec::{Design, DisplayMode, FixedNetwork, RawFrame, Stride};
use ndarray::s;
use serde_json::json;
use std::time::Instant;

/// Bits of a memory word, and its bytes: the port of the KC705's memory.
const WORD: usize = 512;
const WORD_BYTES: usize = WORD / 8;
/// Pixels by which one frame lies beside the next in the picture.
const SHIFT: usize = 2;

/// What `--system` takes besides.
#[derive(clap::Args)]
pub struct Args {
    /// Run the whole core instead: raw frames at the receiver's pins, pictures at the transmitter's, by way of a memory
    #[arg(long, conflicts_with_all = ["random", "patches", "stalls", "skip", "icarus", "junit", "waveform"])]
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

    /// Size of frames in place of the design's
    #[arg(long, requires = "system", value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<(usize, usize)>,
}

fn size(text: &str) -> Result<(usize, usize), String> {
    let sides = text.split_once('x').map(|(width, height)| (width.parse(), height.parse()));
    match sides {
        Some((Ok(width), Ok(height))) => Ok((width, height)),
        _ => Err("must be a width and a height, as in 64x48".into()),
    }
}

impl Args {
    /// The design with the stride and the size that were asked for.
    ///
    /// # Errors
    /// One that cannot be built.
    pub fn design(&self, mut design: Design) -> Result<Design, Error> {
        let stride = self.stride.map_or(Ok(design.frame.stride), Stride::new)?;
        let (width, height) = self.size.unwrap_or((design.frame.width, design.frame.height));
        design.frame = FrameSize { width, height, stride };
        design.check()?;
        Ok(design)
    }
}

/// # Errors
/// A network or picture that cannot be used, a simulator that is missing, or a picture that is not the golden one.
pub fn run(
    args: &Args,
    design: &Design,
    network: FixedNetwork,
    raw: &RawFrame,
    seed: u64,
    ui: &Ui,
) -> Result<(), Error> {
    let start = Instant::now();
    if args.frames < 1 {
        return Err(Error::message("--frames 0: must be 1 or more, or nothing is compared"));
    }
    let network = FixedNetwork { stride: design.frame.stride, ..network };
    // The first is lost while the receiver waits for its vertical sync.
    let frames = crops(raw, design.frame, args.frames + 2)?;
    let display = Display::new(args.display, Curve::default());
    let golden = Golden::new(network.clone())?;
    let pictures =
        frames.iter().map(|raw| system::picture(&golden, &display, raw)).collect::<Result<Vec<_>, _>>()?;
    let compiled = compile(design, &network, &display, ui)?;
    interrupt::check()?;

    let begin = begin(design, &network, &golden, &frames[0], seed)?;
    let mut rig = Rig::start(&compiled, &begin, frames.iter().map(system::sent).collect())?;
    let control = 1 | u32::from(args.display == DisplayMode::Colour) << 1;
    let register = map::register("control").map_or(0, |register| register.address);
    rig.host.wanted.push_back(Access::Write(register, control));
    let bar = ui.progress(frames.len() as u64, "frames sent");
    for frame in 1..frames.len() {
        rig.send(frame)?;
        bar.set(frame as u64);
        interrupt::check()?;
    }
    rig.show(4)?;
    drop(bar);

    let found = system::compare(&rig.screen.frames, &pictures, design.frame.width)?;
    let mut shown: Vec<usize> = found.into_iter().flatten().collect();
    shown.dedup();
    let run = longest(&shown);
    if run < args.frames {
        let problem = format!("{run} pictures were shown one after the other, expected {}", args.frames);
        return Err(Error::message(format!("{problem}: those of frames {shown:?}")));
    }
    let traffic = [&rig.memory.written, &rig.memory.read]
        .map(|side| side.bursts.iter().map(|(_, words)| words).sum::<u64>() * rig.memory.word_bytes());
    let seconds = rig.bench.time_ps() as f64 * 1e-12;
    ui.say(format!(
        "{}: {run} pictures one after the other from pins to pins, every code as golden; memory {:.1} MB/s written, {:.1} MB/s read",
        design.name,
        traffic[0] as f64 / seconds / 1e6,
        traffic[1] as f64 / seconds / 1e6,
    ))?;
    ui.json(&json!({
        "design": design.name,
        "frame": design.frame,
        "display": args.display,
        "frames_sent": frames.len(),
        "pictures_in_a_row": run,
        "shown": shown,
        "differences": 0,
        "memory_bytes": { "written": traffic[0], "read": traffic[1] },
        "simulated_seconds": seconds,
        "seed": seed,
        "seconds": start.elapsed().as_secs_f64(),
    }))
}

/// Most numbers that follow one another.
fn longest(shown: &[usize]) -> usize {
    let mut best = usize::from(!shown.is_empty());
    let mut run = best;
    for two in shown.windows(2) {
        run = if two[1] == two[0] + 1 { run + 1 } else { 1 };
        best = best.max(run);
    }
    best
}

/// Frames of the design's size out of a larger one, each a bit beside the one before.
fn crops(raw: &RawFrame, frame: FrameSize, count: usize) -> Result<Vec<RawFrame>, Error> {
    let (height, width) = raw.size();
    let reach = SHIFT * (count - 1);
    let needed = (frame.width + reach, frame.height + reach);
    if width < needed.0 || height < needed.1 {
        return Err(Error::message(format!(
            "picture {width}x{height}: must be at least {}x{} for {count} frames of {}x{}; give a larger --photo, or --size",
            needed.0, needed.1, frame.width, frame.height
        )));
    }
    let values = raw.values();
    let crop = |i: usize| {
        let at = SHIFT * i;
        let part = values.slice(s![at..at + frame.height, at..at + frame.width]).to_owned();
        RawFrame::from_values(part, raw.depth(), raw.phase())
    };
    Ok((0..count).map(crop).collect::<Result<_, _>>()?)
}

fn compile(design: &Design, network: &FixedNetwork, display: &Display, ui: &Ui) -> Result<Compiled, Error> {
    let (luma, colours) = system::tables(display);
    let tables = Tables { luma: &luma, colours: colours.each_ref().map(Vec::as_slice) };
    let side = |pixels: usize| u16::try_from(pixels).unwrap_or(u16::MAX);
    let frame = (side(design.frame.width), side(design.frame.height));
    let identity = Identity { design_hash: 0, weights_hash: 0, frame };
    let project = project::core::<WORD, WORD_BYTES>(design, [network, network], &tables, identity)?;
    ui.note(format!("compiling {} modules with Verilator", project.verilog.len()));
    Ok(Compiled::new(&project, &Options { cache: Options::user_cache(), ..Options::default() })?)
}

/// Pixel clocks at which the core just keeps up, where the real ones are not slower.
fn begin(
    design: &Design,
    network: &FixedNetwork,
    golden: &Golden,
    raw: &RawFrame,
    seed: u64,
) -> Result<Begin, Error> {
    let windows = crate::windows::of(network, raw)?;
    let patches = windows.map(|window| Patch { window, set: Set::First });
    let model = Cycle::new(design, [network, network])?;
    let mut summary = Summary::new(design);
    model.run(patches).for_each(|run| summary.add(&run));
    let (rows, columns) = golden.geometry().patches(design.frame.height, design.frame.width);
    let of_core = 1.2 * (rows * columns) as f64 * summary.cycles_per_patch()
        + (6 * design.frame.width * design.frame.height) as f64;
    let timing = VideoTiming::of_frame(design.frame);
    let core = 1e6 / design.clock_mhz;
    let pixels = (timing.line.total() * timing.frame.total()) as f64;
    let input = (core * of_core / pixels).max(1e9 / timing.pixel_khz as f64 / 1000.0) as u64;
    let periods = Periods { core: core as u64, input, output: input * 97 / 100 };
    Ok(Begin { timing, periods, behaviour: Behaviour::hard(seed), seed })
}
