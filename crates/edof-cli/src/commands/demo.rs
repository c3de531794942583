//! `edof demo`: the whole program at once.

use crate::commands::optics::advise::stops;
use crate::demo_board::{Board, Told};
use crate::error::Error;
use crate::files::Files;
use crate::said;
use crate::ui::Ui;
use crate::{advice, designs, interrupt, weights};
use edof_core::camera::Camera;
use edof_core::{Noise, Reconstructor, Tone};
use edof_deblur::Malvar;
use edof_golden::GoldenReconstructor;
use edof_optics::Scene;
use edof_optics::Sensor;
use edof_optics::draw::{Builtin, draw, four_depths};
use edof_study::codes::{Card, Symbology};
use edof_study::demo::{self, Demo, Lens};
use edof_study::labels;
use edof_study::report::picture;
use serde_json::Value;
use std::path::PathBuf;

/// Run the whole chain: a scene at four depths through clear lenses and the coded lens, reconstructed in fixed point
///
/// Writes report.html with all pictures side by side, the pictures as PNG files, depths.png with a part of each depth, and overview.png
/// with all pictures in one: the scene, then the lenses in the order of the table, three per row. The folder board gets the sources of a bitstream with the
/// coded lens's network. If Verilator is installed, the report shows a crop computed by that Verilog.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof demo
  edof demo --scene leaves --noise sensor:gain=8 --out out/leaves
  edof demo --json out/demo.json")]
pub struct Args {
    /// Folder for report.html and the pictures
    #[arg(long, default_value = "out", value_name = "DIR")]
    out: PathBuf,

    /// Fixed-point network of the coded lens, by name or weight file
    /// [default: edof-t4w12-outer-light, with --tone linear edof-t4w12-outer]
    #[arg(long, value_name = "NET")]
    net: Option<String>,

    /// Fixed-point network of the clear lens, which states its aperture and focus, by name or weight file
    /// [default: edof-t4w12-closed-light, with --tone linear edof-t4w12-clear]
    #[arg(long, value_name = "NET")]
    clear_net: Option<String>,

    /// Scene: labels (parcels with codes and text), chart (resolution charts) or leaves (dead leaves)
    #[arg(long, default_value = "labels", value_name = "SCENE")]
    scene: String,

    /// What is measured: srgb (the encoded picture) or linear (linear light); synthetic scenes are linear light in either
    /// case and are shown encoded
    #[arg(long, default_value_t = Tone::Srgb, value_name = "TONE")]
    tone: Tone,

    /// Noise of the sensor as in edof capture: none, a standard deviation, or sensor with its gain
    /// [default: sensor:gain=4, with --tone linear 0.005]
    #[arg(long, value_name = "NOISE")]
    noise: Option<Noise>,

    /// Design to generate and simulate, by name or file, or none [default: kc705, if the network fits it]
    #[arg(long, value_name = "NAME|FILE")]
    design: Option<String>,

    /// Rows of the scene, even
    #[arg(long, default_value_t = 480, value_name = "PIXELS")]
    height: usize,

    /// Columns of the scene, even
    #[arg(long, default_value_t = 720, value_name = "PIXELS")]
    width: usize,
}

/// # Errors
/// No weights, settings out of range, a folder that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    // What is quick to reject comes before what takes its time.
    if args.out.is_file() {
        return Err(Error::message(format!("--out {}: is a file, expected a folder", args.out.display())));
    }
    let (camera, coded) = method(args.net(), ui)?;
    let (clear_camera, clear) = method(args.clear_net(), ui)?;
    said::clear(args.clear_net(), &clear_camera)?;
    let sides = format!("--width {} --height {}", args.width, args.height);
    edof::job::check_memory(args.width, args.height).map_err(|e| Error::message(format!("{sides}: {e}")))?;
    let (board, misfit) = board(&args, ui)?.map_or_else(|misfit| (None, Some(misfit)), |board| (board, None));
    let sensor = Sensor { depth: 12, noise: args.noise(), seed: SEED, ..Sensor::default() };

    let malvar = Malvar::default();
    let lenses = lenses(&malvar, (camera, &coded), (clear_camera, &clear))?;
    args.check_files(&lenses, board.as_ref(), ui)?;
    // The last lens is the coded one.
    let coded = &lenses[lenses.len() - 1].camera;
    let (scene, codes) = args.scene(coded)?;
    let remark = advice::better(coded, sensor.noise);
    remark.iter().for_each(|line| ui.note(line));
    misfit.iter().for_each(|misfit| ui.note(format_args!("no board: {misfit}")));
    let progress = ui.progress(1, "demo");
    progress.message("capture and reconstruction");
    let go_on = |_: &str| interrupt::flow();
    let result = demo::run(&scene, &codes, &sensor, &lenses, args.tone, go_on);
    interrupt::check()?;
    let result = result?;
    drop(progress);
    let coded = result.raws.last().zip(board);
    let told = coded.map(|(raw, board)| board.tell(raw, &args.out, ui)).transpose()?;

    save(&result, (told.as_ref(), remark.as_deref()), &args, ui)?;
    ui.say(result.to_text())?;
    ui.say(result.verdict())?;
    told.iter().try_for_each(|told| ui.say(told.to_text()))?;
    ui.say(format_args!("pictures side by side: {}", args.out.join("report.html").display()))?;
    ui.say("move the lens yourself, on a page of this computer: edof play")?;
    let mut data = serde_json::to_value(&result)?;
    data["board"] = told.map_or(Value::Null, |told| told.to_json());
    ui.json(&data)
}

/// The board that is asked for, or why there is none: the usual one is made only where the network fits it.
fn board(args: &Args, ui: &Ui) -> Result<Result<Option<Board>, String>, Error> {
    if args.design.as_deref() == Some(NO_DESIGN) {
        return Ok(Ok(None));
    }
    let given = args.design.as_deref().unwrap_or(DESIGN);
    let design = designs::load(given)?;
    let network = weights::fixed(args.net())?;
    if let (None, Err(misfit)) = (&args.design, design.check_network(&network)) {
        return Ok(Err(misfit.to_string()));
    }
    ui.used(designs::input(&design));
    Ok(Ok(Some(Board::of(design, given, network)?)))
}

/// The usual design.
const DESIGN: &str = "kc705";
/// Parcels with codes.
const LABELS: &str = "labels";
/// Of scenes and of the sensor.
const SEED: u64 = 1;
/// In place of a design's name.
const NO_DESIGN: &str = "none";

/// What is written besides a picture for each treatment behind each lens.
const FILES: [&str; 4] = ["report.html", "overview.png", "depths.png", "scene.png"];

/// File of a lens's picture.
fn file_name(lens: &str, treatment: &str) -> String {
    format!("{lens} {treatment}").replace(',', "").replace(' ', "-") + ".png"
}

/// The clear lens as it is and at the stop of its network, and the coded lens.
fn lenses<'a>(
    malvar: &'a Malvar,
    (camera, coded): (Camera, &'a GoldenReconstructor),
    (clear_camera, clear): (Camera, &'a GoldenReconstructor),
) -> Result<Vec<Lens<'a>>, Error> {
    let plain = || ("demosaiced".to_owned(), malvar as &dyn Reconstructor);
    let restored =
        |method: &'a GoldenReconstructor| ("reconstructed".to_owned(), method as &dyn Reconstructor);
    let open = Camera::resolve("clear-mid")?;
    let closed_by = 2.0 * (open.aperture_radius_mm / clear_camera.aperture_radius_mm).log2();
    let is_open = closed_by.abs() < 0.05;
    let title = if is_open {
        "clear lens, open".to_owned()
    } else {
        format!("clear lens, closed by {}", stops((10.0 * closed_by).round() / 10.0))
    };
    let about = if is_open {
        "a lens without a mask, sharp half-way, and a network of its own."
    } else {
        "the same lens with a smaller aperture, which has less blur and less light, and a network of its own."
    };
    let ordinary = Lens {
        title: "clear lens, open".into(),
        about: "a lens without a mask, sharp half-way: an ordinary camera.".into(),
        camera: open,
        methods: vec![plain()],
    };
    let coded = Lens {
        title: "coded lens, open".into(),
        about: "a thin ring in the lens makes red, green and blue focus at different depths, so that one of them is nearly sharp at each.".into(),
        camera,
        methods: vec![plain(), restored(coded)],
    };
    let clear =
        Lens { title, about: about.into(), camera: clear_camera, methods: vec![plain(), restored(clear)] };
    Ok((!is_open).then_some(ordinary).into_iter().chain([clear, coded]).collect())
}

/// The report, every picture, and all of them in one.
fn save(
    result: &Demo,
    (board, remark): (Option<&Told>, Option<&str>),
    args: &Args,
    ui: &Ui,
) -> Result<(), Error> {
    let [file, overview, depths, scene] = FILES.map(|name| args.out.join(name));
    let mut report = result.report(&ui.signed(&ui.provenance().command), remark)?;
    board.map_or(Ok(()), |board| board.add_to(&mut report))?;
    report.save(&file)?;
    let shots =
        result.pictures.iter().map(|p| args.out.join(file_name(&p.lens, &p.treatment))).zip(&result.frames);
    let sheets = [(scene, &result.truth), (overview, &result.overview()), (depths, &result.by_depth())];
    for (file, light) in sheets.into_iter().chain(shots) {
        edof_core::storage::atomic::write(&file, &picture::png(light, Tone::Srgb)?)?;
    }
    Ok(())
}

/// A fixed net as a method, with the camera it was trained for.
fn method(net: &str, ui: &Ui) -> Result<(Camera, GoldenReconstructor), Error> {
    let network = weights::fixed(net)?;
    ui.used(weights::fixed_input(net)?);
    let (camera, name) = (network.origin.camera.clone(), format!("{}.fixed", network.origin.name));
    Ok((camera, GoldenReconstructor::new(network, name)?))
}

impl Args {
    /// The scene at four depths of a camera's range, and the codes that are printed in it.
    fn scene(&self, camera: &Camera) -> Result<(Scene, Vec<(Symbology, Card)>), Error> {
        let Self { height, width, .. } = *self;
        let sides =
            |e: &dyn std::fmt::Display| Error::message(format!("--width {width} --height {height}: {e}"));
        let depths = four_depths(camera.psi_range);
        if self.scene == LABELS {
            let labels = labels::draw(height, width, depths, SEED).map_err(|e| sides(&e))?;
            return Ok((labels.scene, labels.codes));
        }
        let unknown =
            |_| Error::message(format!("--scene {}: must be {LABELS}, chart or leaves", self.scene));
        let kind = self.scene.parse::<Builtin>().map_err(unknown)?;
        let scene = draw(kind, height, width, &depths, SEED).map_err(|e| sides(&e))?;
        Ok((scene, vec![]))
    }

    /// Rejects before the work what could not be written after it.
    fn check_files(&self, lenses: &[Lens<'_>], board: Option<&Board>, ui: &Ui) -> Result<(), Error> {
        let names =
            lenses.iter().flat_map(|l| l.methods.iter().map(|(treatment, _)| file_name(&l.title, treatment)));
        let files = Files::new(ui).reads_all(weights::fixed_file(self.net()));
        let files = files.reads_all(weights::fixed_file(self.clear_net()));
        let files = files.reads_all(&self.design);
        let files = files.writes_into("--out", &self.out, board.iter().flat_map(|board| board.names()));
        files.writes_into("--out", &self.out, FILES.map(String::from).into_iter().chain(names)).check()
    }

    fn net(&self) -> &str {
        self.net.as_deref().unwrap_or(weights::default_for(self.tone))
    }

    fn clear_net(&self) -> &str {
        self.clear_net.as_deref().unwrap_or(weights::best_clear_for(self.tone))
    }

    fn noise(&self) -> Noise {
        self.noise.unwrap_or(match self.tone {
            Tone::Linear => Noise::Gaussian { sigma: 0.005 },
            Tone::Srgb => Noise::sensor(4.0),
        })
    }
}
