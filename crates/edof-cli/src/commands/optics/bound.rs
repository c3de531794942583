//! `edof optics bound`: what no lens passes, and how near to it a lens comes.

use super::scene::{Scene, with_range};
use crate::error::Error;
use crate::files::Files;
use crate::lens::DepthRange;
use crate::ui::Ui;
use edof_study::bound::{Bound, bound, frequency_plots, light_plots};
use edof_study::report::plot::side_by_side;
use std::path::{Path, PathBuf};

/// Compute what no lens passes over a range of depths, and how near to it a lens and its clear lens come
///
/// For each range and light: average / worst PSNR of the best linear estimate behind the clear lens and behind the camera's, each at its best
/// stop and focus, blind and with the depth known, and the limit for any pupil whatever. The limit is proven for three full planes of
/// colour, and a relaxed problem solved numerically for a Bayer mosaic. Writes frequency.svg (contrast over spatial frequency) and light.svg (dB
/// over light) for the first range. Seconds, no training, no pictures.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  edof optics bound ring-outer
  edof optics bound mine.json --range 8:0,16:0 --electrons 300,3000
  edof optics bound clear --range 0.5m:2m --aperture-mm 2 --pixel-um 1.5 --read-noise 10 --json")]
pub struct Args {
    #[command(flatten)]
    scene: Scene,

    /// Ranges of depth: ψ at the open aperture as in 8:0, or distances as in 0.4m:10m [default: the camera's]
    #[arg(long, value_delimiter = ',', num_args = 1, allow_hyphen_values = true, value_name = "NEAR:FAR,…")]
    range: Vec<DepthRange>,

    /// Light levels: electrons of a white pixel behind the open aperture
    #[arg(long, value_delimiter = ',', default_values = ["100", "1000", "10000"], value_name = "E,…")]
    electrons: Vec<f64>,

    /// Folder for the figures
    #[arg(long, value_name = "DIR", default_value = "out/bound")]
    out: PathBuf,

    /// Also write the tables as Markdown
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,

    /// Also write an HTML report with plots
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

/// What is written.
const FILES: [&str; 2] = ["frequency.svg", "light.svg"];
/// What the figures show.
const NAMES: [&str; 2] = ["contrast over spatial frequency", "PSNR over light"];

/// # Errors
/// An unknown camera, numbers out of range, a range wider than can be judged, a file that cannot be written.
pub fn run(args: Args, ui: &Ui) -> Result<(), Error> {
    let files = args.scene.reads(Files::new(ui)).writes_into("--out", &args.out, FILES);
    let files = files.may_write("--markdown", args.markdown.as_ref());
    files.may_write("--report", args.report.as_ref()).check()?;
    let camera = args.scene.camera(ui)?;
    let ranges = match &args.range[..] {
        [] => vec![camera.clone()],
        ranges => ranges.iter().map(|r| with_range(&camera, Some(*r))).collect::<Result<Vec<_>, _>>()?,
    };
    let lights = args.electrons.iter().map(|e| args.scene.light(*e)).collect::<Result<Vec<_>, _>>()?;
    let statistics = args.scene.statistics(ui)?;
    let psi_ranges: Vec<[f64; 2]> = ranges.iter().map(|camera| camera.psi_range).collect();
    let found = bound(&camera, &psi_ranges, &lights, &statistics)?;
    let frequency = frequency_plots(&ranges[0]);
    let light = light_plots(&ranges[0], lights[0], &statistics)?;
    for (name, plots) in FILES.into_iter().zip([&frequency, &light]) {
        edof_core::storage::atomic::write(&args.out.join(name), side_by_side(plots).as_bytes())?;
    }
    if let Some(path) = &args.markdown {
        let folder = path.parent().unwrap_or(Path::new(""));
        let figure = |(file, name)| (name, relative(folder, &args.out.join(file)));
        let figures: Vec<(&str, String)> = FILES.into_iter().zip(NAMES).map(figure).collect();
        edof_core::storage::atomic::write(path, found.to_markdown(&ui.made_here(), &figures).as_bytes())?;
    }
    if let Some(path) = &args.report {
        let plots = [frequency, light].concat();
        found.report(&ui.signed(&ui.provenance().command), &plots).save(path)?;
    }
    tell(&found, &args, ui)
}

/// A file as seen from a folder; both are seen from the same place.
fn relative(folder: &Path, file: &Path) -> String {
    let shared = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(shared).map(|_| "..".to_owned());
    let down = file.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

fn tell(found: &Bound, args: &Args, ui: &Ui) -> Result<(), Error> {
    ui.say(found.to_text())?;
    ui.say(format!("figures in {}", args.out.display()))?;
    ui.json(found)
}
