//! `edof explore`: which foldings of which networks are worth building.

use crate::designs;
use crate::error::Error;
use crate::files::{Files, Force};
use crate::interrupt;
use crate::kind::Kind;
use crate::lens::Depth;
use crate::said;
use crate::ui::Ui;
use crate::weights;
use crate::windows::{self, Shot};
use edof_core::Noise;
use edof_core::words::{count, number};
use edof_cosim::explore::{self, Folding, Pairs, any_folding};
use edof_device::Design;
use edof_device::design::FrameSize;
use edof_golden::Golden;
use edof_golden::cycle::Cycle;
use edof_golden::cycle::explore::front;
use edof_io::raw::Size;
use edof_network::FixedNetwork;
use edof_study::metrics::{BORDER, psnr, shown};
use serde_json::json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Measure foldings of networks on pictures, and print those that are Pareto-optimal in quality, cycles, multipliers and block RAM
///
/// A folding is the number of lanes (outputs computed at once) and rows (values multiplied per cycle in each lane) of every stage.
/// Each network runs on every picture at every depth with its own camera. The number of values that each stage multiplies per patch
/// then determines the cycles of a folding. A design sets clock and picture size, unless --clock-mhz and --size do; the board of the design sets the device.
#[derive(clap::Args)]
#[group(skip)]
#[command(after_help = "Examples:
  edof explore --weights edof-t4w12-outer
  edof explore --weights edof-t4w12,edof-t4w12-outer --photo a.png --psi 0,4,8 --fps 60
  edof explore --weights mine.fixed.safetensors --fps 30 --out mine.json
  edof explore --weights mine.fixed.safetensors --size 640x480 --fps 30 --out mine.json")]
pub struct Task {
    #[command(flatten)]
    measured: Args,

    /// Design file to write: the first folding of the list, which is the best in dB and then has the fewest multipliers. It must reach --fps on the slowest picture, and the networks must be for one lens and tone
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// What is measured.
#[derive(clap::Args)]
pub struct Args {
    /// Quantized networks, by name or file
    #[arg(long, value_name = "NAME|FILE,...", value_delimiter = ',', required = true)]
    weights: Vec<String>,

    /// Design that sets clock and picture size, by name or file
    #[arg(long, value_name = "NAME|FILE", default_value = "kc705")]
    design: String,

    /// Size of a picture in pixels [default: the design's]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    size: Option<Size>,

    /// Clock of the calculator in MHz [default: the design's]
    #[arg(long, value_name = "MHZ")]
    clock_mhz: Option<f64>,

    /// Required frames per second of the slowest picture; edof explore lists slower foldings only if none is fast enough
    #[arg(long, default_value_t = 60.0)]
    fps: f64,

    /// FPGA that the folding must fit: the part of the design's board [default: that part]
    #[arg(long)]
    device: Option<String>,

    /// Picture to measure on; repeatable [default: a built-in scene of dead leaves]
    #[arg(long, value_name = "FILE")]
    photo: Vec<PathBuf>,

    /// Depths of the pictures, separated by commas: ψ, the defocus in radians (presets: 0 at the far end, 8 at the near end of an open lens), or distances as in 1.5m if the camera states nominal_m [default: the far end of the network's range]
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, value_name = "PSI,…")]
    psi: Vec<Depth>,

    /// Noise of the pictures, in the format of edof capture --noise [default: the strongest noise of the network's training]
    #[arg(long)]
    noise: Option<Noise>,

    #[command(flatten)]
    pub force: Force,
}

/// A folding of a network.
pub struct Found {
    pub network: String,
    pub camera: String,
    /// Camera and tone that the network was trained for, in words.
    pub lens: String,
    pub db: f64,
    pub folding: Folding,
}

impl Found {
    /// What is better where it is less.
    pub fn figures(&self) -> [f64; 4] {
        let Folding { cycles, used, .. } = &self.folding;
        [-self.db, *cycles, used.multipliers as f64, used.whole_memories()]
    }
}

/// # Errors
/// A network, design or picture that cannot be used, or nothing that fits the device.
pub fn run(task: Task, ui: &Ui) -> Result<(), Error> {
    let Task { measured: args, out } = task;
    let files = args.files(Files::new(ui));
    let files = out.iter().fold(files, |files, out| files.writes_as(Kind::Design, "--out", out));
    files.keeps(args.force).check()?;
    let (base, mut found) = args.found(ui)?;
    if let Some(out) = &out {
        args.check_alike(out, &found)?;
    }
    let reaches = |one: &Found| one.folding.worst_frames >= args.fps;
    let fast = found.iter().any(reaches);
    if let Some(out) = out.as_ref().filter(|_| !fast) {
        return Err(Error::message(format!(
            "--out {}: no folding reaches --fps {}, so no design is written; state a lower --fps",
            out.display(),
            number(args.fps)
        )));
    }
    found.retain(|one| !fast || reaches(one));
    let kept = front(&found.iter().map(Found::figures).collect::<Vec<_>>());
    let mut kept: Vec<Found> =
        found.into_iter().zip(kept).filter_map(|(one, keep)| keep.then_some(one)).collect();
    kept.sort_by(|a, b| {
        b.db.total_cmp(&a.db).then(a.folding.used.multipliers.cmp(&b.folding.used.multipliers))
    });

    let part = &base.board.part;
    let names = [part.multiplier.name, part.memory.name];
    let widths = names.map(|name| name.len().max(7));
    ui.say(format!(
        "on {}; frames per second of {}x{} at {} MHz: mean, of the slowest picture, and if no value were zero (what every picture reaches)",
        args.pictures(),
        base.frame.width,
        base.frame.height,
        number(base.clock_mhz)
    ))?;
    ui.say(format!(
        "   dB  cycles   worst  frames/s   worst   least  {:>2$}  {:>3$}  network, lanes x rows, lens",
        names[0], names[1], widths[0], widths[1]
    ))?;
    for one in &kept {
        let Found { network, lens, db, folding, .. } = one;
        let Folding { words, cycles, worst_cycles, frames, worst_frames, least_frames, used, .. } = folding;
        let (multipliers, memories) = (used.multipliers, used.whole_memories());
        let [multipliers_width, memories_width] = widths;
        ui.say(format!(
            "{db:5.2}  {cycles:6.1}  {worst_cycles:6.1}  {frames:8.1}  {worst_frames:6.1}  {least_frames:6.1}  {multipliers:multipliers_width$}  \
             {memories:memories_width$.1}  {network}, {words}, {lens}"
        ))?;
    }
    if !fast {
        ui.say(format!(
            "none of them reaches {} frames per second at {} MHz (planned)",
            number(args.fps),
            base.clock_mhz
        ))?;
    }
    if let (Some(out), Some(first)) = (&out, kept.first()) {
        save(out, &first.folding, ui)?;
    }
    let told = |one: &Found| {
        json!({
            "weights": one.network,
            "psnr_db": one.db,
            "stages": one.folding.words,
            "cycles_per_patch": one.folding.cycles,
            "worst_picture_cycles_per_patch": one.folding.worst_cycles,
            "frames_per_second": one.folding.frames,
            "worst_picture_frames_per_second": one.folding.worst_frames,
            "frames_per_second_nothing_skipped": one.folding.least_frames,
            "lens": one.lens,
            "resources": part.named(&one.folding.used),
        })
    };
    ui.json(&json!({
        "design": base.name,
        "device": part.name.to_lowercase(),
        "fps": args.fps,
        "reached": fast,
        "front": kept.iter().map(told).collect::<Vec<_>>(),
    }))
}

impl Args {
    /// Adds what is read to the files of a command.
    pub fn files(&self, files: Files) -> Files {
        let read = |files: Files, name: &String| files.reads_all(weights::fixed_file(name));
        self.weights.iter().fold(files.reads(&self.design), read).reads_all(&self.photo)
    }

    /// The design, and all foldings of all networks that fit the device.
    ///
    /// # Errors
    /// A network, design or picture that cannot be used, or nothing that fits.
    pub fn found(&self, ui: &Ui) -> Result<(Design, Vec<Found>), Error> {
        if !(self.fps > 0.0 && self.fps.is_finite()) {
            return Err(Error::message(format!("--fps {}: must be more than 0", number(self.fps))));
        }
        if self.weights.iter().any(String::is_empty) {
            return Err(Error::message(
                "--weights: an empty name, expected names or files with commas between them",
            ));
        }
        let mut names = BTreeSet::new();
        if let Some(twice) = self.weights.iter().find(|name| !names.insert(*name)) {
            return Err(Error::message(format!("--weights: {twice} is given twice")));
        }
        let base = self.base()?;
        let part = base.board.part.name.to_lowercase();
        if let Some(device) = self.device.as_ref().filter(|device| !device.eq_ignore_ascii_case(&part)) {
            let name = &base.name;
            return Err(Error::message(format!(
                "--device {device}: design {name} is for board {}, which has an {part}; omit --device",
                base.board.name
            )));
        }
        ui.used(designs::input(&base));
        let mut found = vec![];
        for name in &self.weights {
            ui.used(weights::fixed_input(name)?);
            found.extend(of_network(self, &base, name, &weights::fixed(name)?, ui)?);
        }
        if found.is_empty() {
            let names = self.weights.join(", ");
            return Err(Error::message(format!(
                "no folding of {names} fits {}; choose a smaller network, or a design of smaller frames",
                part
            )));
        }
        Ok((base, found))
    }

    /// The design, with the size and the clock that are stated.
    fn base(&self) -> Result<Design, Error> {
        let mut base = designs::load(&self.design)?;
        if let Some(Size { width, height }) = self.size {
            base.frame = FrameSize { width, height, ..base.frame };
            base.check().map_err(|e| said::instead(&format!("--size {width}x{height}"), &e))?;
        }
        if let Some(clock) = self.clock_mhz {
            base.clock_mhz = clock;
            base.check().map_err(|e| said::instead(&format!("--clock-mhz {}", number(clock)), &e))?;
        }
        Ok(base)
    }

    /// Rejects a choice between networks for several lenses or tones, whose dB are of different frames.
    fn check_alike(&self, out: &Path, found: &[Found]) -> Result<(), Error> {
        let lenses: BTreeSet<&str> = found.iter().map(|one| one.lens.as_str()).collect();
        if lenses.len() < 2 {
            return Ok(());
        }
        Err(Error::message(format!(
            "--out {}: the networks of --weights are {}, so their dB do not compare; name networks for one lens and tone",
            out.display(),
            lenses.into_iter().collect::<Vec<_>>().join("; ")
        )))
    }

    /// Frames per second that are required.
    pub const fn fps(&self) -> f64 {
        self.fps
    }

    /// What they are measured on, in words.
    pub fn pictures(&self) -> String {
        match self.photo.len() {
            0 => "a synthetic scene of dead leaves".into(),
            1 => "a photograph".into(),
            several => count(several, "photograph"),
        }
    }
}

/// Writes the design of a folding under the name of its file.
fn save(out: &Path, folding: &Folding, ui: &Ui) -> Result<(), Error> {
    let name = out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let design = Design { name, ..folding.design.clone() };
    design.check().map_err(|e| said::of_file(out, e))?;
    super::design::save(out, &design)?;
    ui.say(format!("{}: written, {}", out.display(), folding.words))
}

/// All foldings of a network that fit the device.
fn of_network(
    args: &Args,
    base: &Design,
    name: &str,
    network: &FixedNetwork,
    ui: &Ui,
) -> Result<Vec<Found>, Error> {
    let (db, pictures) = measure(args, network, &any_folding(base, network)?, ui)?;
    let found = explore::found(base, network, &pictures, interrupt::flow)?;
    interrupt::check()?;
    let (camera, tone) = (&network.origin.camera.name, windows::tone(network));
    let lens = format!("for {camera}, tone {tone}");
    let one =
        |folding| Found { network: name.into(), camera: camera.clone(), lens: lens.clone(), db, folding };
    let found = found.into_iter().map(one);
    Ok(found.collect())
}

/// Mean PSNR over the pictures, and of each patch of each picture the pairs that every stage multiplies.
fn measure(
    args: &Args,
    network: &FixedNetwork,
    design: &Design,
    ui: &Ui,
) -> Result<(f64, Vec<Pairs>), Error> {
    let golden = Golden::new(network.clone())?;
    let model = Cycle::new(design, [network, network])?;
    let shots = Shot::all(&args.photo, &args.psi, args.noise);
    let bar = ui.progress(shots.len() as u64, "pictures measured");
    let tone = windows::tone(network);
    let (mut db, mut pictures) = (0.0, vec![]);
    for shot in &shots {
        let (scene, raw) = shot.taken(network, ui)?;
        let (_, frame) = golden.frame_of_light(&raw).map_err(|e| shot.failed(e))?;
        db += psnr(&shown(&scene.sharp(), tone), &shown(&frame, tone), BORDER)? / shots.len() as f64;
        let pairs = explore::pairs(&model, network, &raw.encoded(network.origin.values), interrupt::flow);
        interrupt::check()?;
        pictures.push(pairs.map_err(|e| shot.failed(e))?);
        bar.set(pictures.len() as u64);
    }
    Ok((db, pictures))
}
