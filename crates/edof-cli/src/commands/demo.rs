//! `edof demo`: the whole program at once.

use super::study::fixed_if_any;
use crate::error::Error;
use crate::files::Files;
use crate::ui::Ui;
use crate::{interrupt, weights};
use edof_deblur::Malvar;
use edof_golden::GoldenReconstructor;
use edof_optics::draw::{Builtin, draw, four_depths};
use edof_optics::sensor::Sensor;
use edof_spec::{Camera, FixedNetwork, Noise, Reconstructor};
use edof_study::demo::{self, Lens};
use edof_study::picture::{self, Tone};
use std::path::PathBuf;

/// Net behind the clear lens where none is named.
const CLEAR_NET: &str = "edof-t4w12-clear";

/// A scene at four depths through the clear and the coded lens, reconstructed in fixed point
///
/// Writes report.html with all pictures side by side, the pictures themselves as PNG files, and overview.png with all of
/// them in one: the scene, then the lenses in the order of the table, three in a row.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof demo
  edof demo --scene leaves --noise 0.01 --out out/leaves
  edof demo --json out/demo.json")]
pub struct Args {
    /// Folder for report.html and the pictures
    #[arg(long, default_value = "out", value_name = "DIR")]
    out: PathBuf,

    /// Fixed-point net behind the coded lens, by name or weight file
    #[arg(long, default_value = "edof-t4w12-outer", value_name = "NET")]
    net: String,

    /// Fixed-point net behind the clear lens [default: edof-t4w12-clear where there is one]
    #[arg(long, value_name = "NET")]
    clear_net: Option<String>,

    /// chart or leaves
    #[arg(long, default_value = "chart", value_name = "SCENE")]
    scene: String,

    /// Noise of the sensor: none, a standard deviation in units of full scale, or sensor[:gain=G] as in edof capture
    #[arg(long, default_value = "0.005", value_name = "NOISE")]
    noise: Noise,

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
    let (coded_camera, coded) = method(weights::fixed(&args.net)?)?;
    let clear = match &args.clear_net {
        Some(name) => Some(weights::fixed(name)?),
        None => fixed_if_any(CLEAR_NET)?,
    };
    let clear = clear.map(method).transpose()?;
    super::scene::fits(args.width, args.height)?;
    let scene = draw(
        args.scene.parse::<Builtin>()?,
        args.height,
        args.width,
        &four_depths(coded_camera.psi_range),
        1,
    )?;
    let sensor = Sensor { depth: 12, noise: args.noise, seed: 1, ..Sensor::default() };

    let malvar = Malvar::default();
    let plain = || ("demosaiced".to_owned(), &malvar as &dyn Reconstructor);
    let restored = |method| ("reconstructed".to_owned(), method as &dyn Reconstructor);
    let lens = |title: &str, camera, methods| Lens { title: title.into(), camera, methods };
    let mut middle = lens("clear lens, focused mid-range", Camera::resolve("clear-mid")?, vec![plain()]);
    if let Some((camera, method)) = &clear {
        middle.camera = camera.clone();
        middle.methods.push(restored(method));
    }
    let lenses = [
        lens("clear lens, focused on the background", Camera::resolve("clear")?, vec![plain()]),
        middle,
        lens("coded lens", coded_camera, vec![plain(), restored(&coded)]),
    ];
    let names =
        lenses.iter().flat_map(|l| l.methods.iter().map(|(treatment, _)| file_name(&l.title, treatment)));
    let files = Files::new(ui).reads_all(weights::fixed_file(&args.net));
    let files = files.reads_all(args.clear_net.as_deref().and_then(weights::fixed_file));
    files.writes_into("--out", &args.out, FILES.map(String::from).into_iter().chain(names)).check()?;

    let progress = ui.progress(1, "demo");
    progress.message("capture and reconstruction");
    let result = demo::run(&scene, &sensor, &lenses)?;
    interrupt::check()?;
    drop(progress);

    let [report, overview, scene] = FILES.map(|name| args.out.join(name));
    result.report(Tone::Code, &command_line(&args))?.save(&report)?;
    let shots = result.pictures.iter().map(|p| (args.out.join(file_name(&p.lens, &p.treatment)), &p.frame));
    for (file, frame) in [(scene, &result.truth), (overview, &result.overview())].into_iter().chain(shots) {
        edof_spec::atomic::write(&file, &picture::png(frame, Tone::Code)?)?;
    }
    ui.say(result.to_text())?;
    ui.say(format_args!("pictures side by side: {}", report.display()))?;
    ui.json(&result)
}

/// What is written besides a picture for each treatment behind each lens.
const FILES: [&str; 3] = ["report.html", "overview.png", "scene.png"];

/// File of a lens's picture.
fn file_name(lens: &str, treatment: &str) -> String {
    format!("{lens} {treatment}").replace(',', "").replace(' ', "-") + ".png"
}

/// A fixed net as a method, with the camera it was trained for.
fn method(net: FixedNetwork) -> Result<(Camera, GoldenReconstructor), Error> {
    let (camera, name) = (net.origin.camera.clone(), format!("{}.fixed", net.origin.name));
    Ok((camera, GoldenReconstructor::new(net, name)?))
}

/// What was run, as the report states it.
fn command_line(args: &Args) -> String {
    let Args { scene, noise, height, width, net, .. } = args;
    format!("edof demo --scene {scene} --noise {noise} --height {height} --width {width} --net {net}")
}
